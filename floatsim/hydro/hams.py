"""A folder of HAMS as a `HydroDatabase` of one body.

HAMS (github.com/YingyiLiu/HAMS; HAMS-MREL adds bodies, whose WAMIT-style files do not tell them apart) is run in a
folder with

- `Input/ControlFile.in`     water depth (negative: deep), point that moments refer to,
- `Input/Hydrostatic.in`     mass and restoring matrices in SI units; restoring contains the weight of that mass,
- `Output/Wamit_format/`     `Buoy.1` and `Buoy.3` (earlier versions `AmssDamp.1`, `ExcForce.3`), as WAMIT writes them
                             with ULEN = 1 whatever the reference length.

The first column is what `Output_frequency_type` says, a period where it says nothing. The phases of `.3` are WAMIT's,
e^{+i w t}, in some versions and their conjugates in others (issue 26 there); the push of long waves tells which.
Headings are those towards which waves travel. Density and gravity are constants of the program; `Settings.ctrl`, the
input of its mesh translator, holds them in its first two lines.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from floatsim.errors import ModelError
from floatsim.hydro.conventions import (
    ESTIMATED,
    Array,
    Force,
    body_names,
    in_folder,
    infinite_added_mass,
    numbers,
    per_body,
    text_lines,
)
from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.wamit import forces, radiation
from floatsim.sea.dispersion import wave_number


def read_hams(
    folder: str | Path,
    *,
    volume: float,
    centre_of_buoyancy: ArrayLike,
    density: float | None = None,
    gravity: float | None = None,
    conjugate: bool | None = None,
    bodies: tuple[str, ...] = (),
    estimate_added_mass_inf: bool = False,
) -> HydroDatabase:
    """Database from a HAMS folder, or from its `ControlFile.in`.

    volume, centre_of_buoyancy  m3 displaced and m, world frame; the files do not contain them
    density, gravity            kg/m3, m/s2 that the program was built with; default those of Settings.ctrl
    conjugate                   phases are those of e^{-i w t}; by default found out from the longest waves
    bodies                      name of the body
    estimate_added_mass_inf     take what A(w) and B(w) imply where infinite frequency was not computed

    Raises ModelError naming the file for what is missing, cannot be read, of several bodies, or if waves are too short
    to tell the sign of the phases.
    """
    folder = Path(folder)
    folder = folder.parent if folder.suffix.lower() == ".in" else folder
    folder = folder.parent if folder.name.lower() == "input" else folder
    label = f"HAMS folder '{folder}'"
    control = _control(_inner(label, folder, "Input", "ControlFile.in"))
    settings = in_folder(folder, "Settings.ctrl")
    if settings is not None:
        built_in = [*(numbers(line)[:1] for line in text_lines(settings)[:2]), [], []]
        gravity, density = gravity or next(iter(built_in[0]), None), density or next(iter(built_in[1]), None)
    lacking = [name for name, value in (("density", density), ("gravity", gravity)) if value is None]
    if lacking or density is None or gravity is None:
        raise ModelError(f"{label}: there is no Settings.ctrl; give {' and '.join(f'{name}=...' for name in lacking)}")
    if not (density > 0.0 and gravity > 0.0):
        raise ModelError(f"{label}: density and gravity must be positive, got {density:g} and {gravity:g}")
    V, B = per_body(label, "volume", volume, 1), per_body(label, "centre_of_buoyancy", centre_of_buoyancy, 1, 3)
    output = in_folder(in_folder(folder, "Output") or folder, "Wamit_format") or folder / "Output" / "Wamit_format"
    kind, g = control["output"], gravity

    def as_omega(column: Array) -> Array:
        return _as_omega(kind, column, control["depth"], g)

    omega, mass, damping, mass_inf, mass_zero = radiation(
        _inner(label, output, "", "Buoy.1", "AmssDamp.1"), 6, as_omega, kind in (1, 2, 3)
    )
    headings, force = forces(_inner(label, output, "", "Buoy.3", "ExcForce.3"), omega, 6, as_omega)
    if conjugate is None:
        conjugate = _backwards(label, force, omega, headings, control["depth"], gravity, B[0])
    force = force.conj() if conjugate else force
    mass, damping = density * mass, density * omega[:, None, None] * damping
    source: dict[str, Any] = {"solver": "HAMS", "file": folder.name, "phases_conjugated": int(conjugate)}
    if mass_inf is None:
        mass_inf = infinite_added_mass(label, omega, mass, damping, estimate_added_mass_inf) / density
        source["added_mass_inf"] = ESTIMATED
    return HydroDatabase(
        name=folder.resolve().name,
        bodies=body_names(label, bodies, 1, folder.resolve().name),
        omega=omega,
        added_mass=mass,
        radiation_damping=damping,
        added_mass_inf=density * mass_inf,
        added_mass_zero=None if mass_zero is None else density * mass_zero,
        headings=headings,
        excitation=density * gravity * force,
        hydrostatic_stiffness=_stiffness(_inner(label, folder, "Input", "Hydrostatic.in"), gravity),
        volume=V,
        centre_of_buoyancy=B,
        reference_point=np.array(control["point"]),
        depth=control["depth"],
        density=density,
        gravity=gravity,
        source=source,
    )


def _inner(label: str, folder: Path, inner: str, *names: str) -> Path:
    """The first of `names` in folder/inner."""
    within = (in_folder(folder, inner) if inner else folder) or folder
    path = in_folder(within, *names)
    if path is None:
        raise ModelError(f"{label}: there is no '{names[0]}' in '{within}'")
    return path


def _control(path: Path) -> dict[str, Any]:
    found: dict[str, list[float]] = {}
    for line in text_lines(path):
        words = line.split()
        if words:
            found.setdefault(words[0].lower(), numbers(" ".join(words[1:])))
    if found.get("number_of_bodies", [1.0])[0] > 1:
        raise ModelError(f"'{path}': several bodies; the WAMIT-style files of HAMS-MREL do not tell them apart")
    depth = found.get("waterdepth", [])
    point = found.get("reference_body_center") or found.get("reference_body_centre") or []
    if not depth or len(point) < 3:
        raise ModelError(f"'{path}': must have lines Waterdepth and Reference_body_center")
    kind = int(next(iter(found.get("output_frequency_type", [])), 4))
    if kind not in range(1, 6):
        raise ModelError(f"'{path}': Output_frequency_type is {kind}, must be 1 to 5")
    return {"depth": depth[0] if depth[0] > 0.0 else np.inf, "point": point[:3], "output": kind}


def _as_omega(kind: int, column: Array, depth: float, gravity: float) -> Array:
    """rad/s from wave numbers of deep water (1) and of this depth (2), from rad/s (3), periods (4), lengths (5)."""
    if kind == 3:
        return column
    if kind == 4:
        return 2.0 * np.pi / column
    k = 2.0 * np.pi / column if kind == 5 else column
    return np.sqrt(gravity * k * (1.0 if kind == 1 else np.tanh(k * depth)))


def _stiffness(path: Path, gravity: float) -> Array:
    """The restoring matrix without the weight of the mass matrix, whose entries 15, 24, 26, 16 are m z_G and so on."""
    lines = text_lines(path)
    blocks = {}
    for name in ("Body Mass Matrix", "Hydrostatic Restoring Matrix"):
        start = next((k for k, line in enumerate(lines) if line.strip().lower().startswith(name.lower())), None)
        rows = [] if start is None else [numbers(line) for line in lines[start + 1 : start + 7]]
        if [len(row) for row in rows] != [6] * 6:
            raise ModelError(f"'{path}': must have six rows of six numbers below '{name}:'")
        blocks[name] = np.array(rows)
    mass, stiffness = blocks["Body Mass Matrix"], blocks["Hydrostatic Restoring Matrix"].copy()
    # m z_G = M15, m x_G = M26, m y_G = - M16
    stiffness[3, 3] += gravity * mass[0, 4]
    stiffness[4, 4] += gravity * mass[0, 4]
    stiffness[3, 5] -= gravity * mass[1, 5]
    stiffness[4, 5] += gravity * mass[0, 5]
    return np.asarray(stiffness)


def _backwards(
    label: str, force: Force, omega: Array, headings: Array, depth: float, gravity: float, at: Array
) -> bool:
    """Whether phases are those of e^{-i w t}. In long waves a body is pushed where the water accelerates: a quarter
    period before the crest."""
    k = wave_number(omega[:1], depth, gravity)[0]
    along = np.stack([np.cos(headings), np.sin(headings)])
    push = force[0, :, 0] * along[0] + force[0, :, 1] * along[1]
    lag = np.exp(1j * k * (at[:2] @ along))
    forwards, backwards = (push * lag).sum().imag, -(push * lag.conj()).sum().imag
    if max(forwards, backwards) < 0.7 * np.abs(push).sum():
        raise ModelError(
            f"{label}: whether phases are those of e^(+i w t) or e^(-i w t) differs between versions and cannot be "
            f"told at {omega[0]:.3g} rad/s; compute longer waves, or say it with conjugate=True or False"
        )
    return bool(backwards > forwards)
