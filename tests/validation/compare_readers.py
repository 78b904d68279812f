"""The same body from two codes, by two readers: they must agree within what their meshes differ. Run by hand:

    python tests/validation/compare_readers.py FOLDER

FOLDER holds, unpacked, any of these public files (github.com/WEC-Sim/WEC-Sim_Applications and
github.com/WEC-Sim/WEC-Sim, both Apache-2.0; what is missing is left out):

    oes_task10_sphere/sphere.h5 (WAMIT, by BEMIO), oes_task10_sphere/capytaine_sphere_hydrodynamics.nc
    wecsim_ellipsoid/wamit_ellipsoid.1 .3 .3fk .hst, capytaine_ellipsoid_hydrodynamics.nc, Hydrostatics.dat, KH.dat
    rm3/capytaine_rm3_hydrodynamics.nc, Hydrostatics_0.dat, KH_0.dat ...    and rm3_hydro.nc of floatsim's models
    volturnus_s/IEA-15-240-RWT-UMaineSemi.1 .3 .hst    and volturnus_s_hydro.nc of floatsim's models

Figures are rms differences over the frequencies both have, as a share of the largest value of the first; those of X are
of the complex numbers, so that a wrong phase shows. Exit status 1 if one is beyond its bar. Phases of the sphere are
compared above 0.35 rad/s: its WAMIT run was in deep water (so says its output file), Capytaine's in 50 m.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.read import read_hydro

MODELS = Path(__file__).parents[2] / "models"
ESTIMATE = {"estimate_added_mass_inf": True}
DOFS = ("surge", "sway", "heave", "roll", "pitch", "yaw")


def sphere(folder: Path) -> tuple[HydroDatabase, HydroDatabase]:
    folder = folder / "oes_task10_sphere"
    centre = (0.0, 0.0, -2.0)
    capytaine = read_hydro(
        folder / "capytaine_sphere_hydrodynamics.nc", volume=261.36, centre_of_buoyancy=(0.0, 0.0, -1.875),
        centre_of_gravity=centre, reference_point=centre, drop_incomplete=True, **ESTIMATE,
    )  # fmt: skip
    return read_hydro(folder / "sphere.h5"), capytaine


def ellipsoid(folder: Path) -> tuple[HydroDatabase, HydroDatabase]:
    folder = folder / "wecsim_ellipsoid"
    wamit = read_hydro(
        folder / "wamit_ellipsoid", volume=76.214, centre_of_buoyancy=(0.0, 0.0, -0.6745), depth=math.inf,
        density=1000.0, gravity=9.81,
    )  # fmt: skip
    path = folder / "capytaine_ellipsoid_hydrodynamics.nc"
    return wamit, read_hydro(path, hydrostatics=folder, reference_point=(0.0, 0.0, 0.0), **ESTIMATE)


def rm3(folder: Path) -> tuple[HydroDatabase, HydroDatabase]:
    folder, centres = folder / "rm3", [(0.0, 0.0, -0.72), (0.0, 0.0, -21.29)]
    path = folder / "capytaine_rm3_hydrodynamics.nc"
    public = read_hydro(path, hydrostatics=folder, reference_point=centres, **ESTIMATE)
    return public, read_hydro(MODELS / "rm3_hydro.nc")


def volturnus(folder: Path) -> tuple[HydroDatabase, HydroDatabase]:
    wamit = read_hydro(
        folder / "volturnus_s" / "IEA-15-240-RWT-UMaineSemi", volume=20206.35, centre_of_buoyancy=(0.0, 0.0, -13.6261),
        depth=200.0, density=1025.0, gravity=9.80665,
    )  # fmt: skip
    return wamit, read_hydro(MODELS / "volturnus_s_hydro.nc")


CASES: dict[str, tuple[Callable[[Path], Any], tuple[int, ...], tuple[float, float], float]] = {
    # quantities of these motions, frequencies from, to [rad/s], largest share
    "sphere": (sphere, (0, 2, 4), (0.35, 5.0), 0.03),
    "ellipsoid": (ellipsoid, (0, 2, 4), (0.03, 5.0), 0.03),
    "rm3": (rm3, (2,), (0.1, 2.5), 0.05),  # the public file's thin plate fails its own symmetry check by 20 %
    "volturnus_s": (volturnus, (0, 2, 4), (0.05, 1.5), 0.03),
}


def rows(
    a: HydroDatabase, b: HydroDatabase, motions: tuple[int, ...], span: tuple[float, float]
) -> list[tuple[str, float]]:
    """(quantity, rms difference) of b, interpolated to the frequencies of a."""
    low, high = max(span[0], a.omega[0], b.omega[0]), min(span[1], a.omega[-1], b.omega[-1])
    w = a.omega[(a.omega >= low) & (a.omega <= high)]
    ahead = [int(np.argmin(np.abs(db.headings))) for db in (a, b)]

    def at(db: HydroDatabase, values: np.ndarray) -> np.ndarray:
        return np.interp(w, db.omega, values.real) + 1j * np.interp(w, db.omega, values.imag)

    def difference(p: np.ndarray, q: np.ndarray) -> float:
        return float(np.sqrt(np.mean(np.abs(q - p) ** 2)) / np.abs(p).max())

    out = []
    for i in motions:
        name = (f"{a.bodies[i // 6]} " if len(a.bodies) > 1 else "") + DOFS[i % 6]
        pairs = {"A": [db.added_mass[:, i, i] for db in (a, b)], "B": [db.radiation_damping[:, i, i] for db in (a, b)],
                 "X": [db.excitation[:, k, i] for db, k in zip((a, b), ahead)]}  # fmt: skip
        if a.froude_krylov is not None and b.froude_krylov is not None:
            pairs["X_FK"] = [db.froude_krylov[:, k, i] for db, k in zip((a, b), ahead)]  # type: ignore[index]
        out += [(f"{symbol} {name}", difference(at(a, p), at(b, q))) for symbol, (p, q) in pairs.items()]
        inf = a.added_mass_inf[i, i], b.added_mass_inf[i, i]
        out.append((f"A_inf {name}", abs(inf[1] - inf[0]) / abs(inf[0])))
        if a.hydrostatic_stiffness[i, i] > 0.0:
            C = a.hydrostatic_stiffness[i, i], b.hydrostatic_stiffness[i, i]
            out.append((f"C {name}", abs(C[1] - C[0]) / C[0]))
    return out


def main(folder: str) -> int:
    missed = 0
    for case, (make, motions, span, bar) in CASES.items():
        try:
            a, b = make(Path(folder))
        except Exception as error:  # a file is missing, most likely: the others are still worth comparing
            print(f"{case}: left out: {error}")
            continue
        print(f"{case}: {a.source.get('solver', a.name)} and {b.source.get('solver', b.name)}")
        for name, size in rows(a, b, motions, span):
            missed += size > bar
            print(f"  {name:28s} {100 * size:8.2f} %  (bar {100 * bar:g} %){'   MISSED' if size > bar else ''}")
    return 1 if missed else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
