"""Hydrodynamic databases of the two spheres of models/sphere.py, floating half submerged.

    python models/sphere_bem.py oes          radius 5 m, deep water, rho 1000 kg/m3
    python models/sphere_bem.py kramer       diameter 0.3 m, deep water, rho 998.2 kg/m3, g 9.82 m/s2

Needs the extra `bem` (Capytaine >= 3.0); half a minute each.

OES: sphere of the OES Wave Energy Systems Task 10, Wendt et al., EWTEC 2017. Kramer: Kramer et al., Energies 14
(2021) 269, a sphere of D 300 mm dropped in a basin of 900 mm depth, which is deep for its natural period (wave number
times depth 6.3). It is computed as deep, because Capytaine's Green function of finite depth, fitted by exponentials,
makes the heave added mass jump by 0.7 % of A_inf at wave numbers times depth of 11 and 20, and A_inf 0.6 % too small.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np

from floatsim.hydro.compute import Symmetry, WetBody, compute_database, write_checked
from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.meshing import Hydrostatics, hydrostatics, images, revolve

SPHERES = {  # radius m, depth m, density kg/m3, gravity m/s2, frequency step rad/s
    "oes": (5.0, math.inf, 1000.0, 9.81, 0.075),
    "kramer": (0.15, math.inf, 998.2, 9.82, 0.5),
}
AROUND, RINGS = 72, 30
HEADINGS = np.radians(np.arange(-180.0, 180.0, 10.0))


def exact_hydrostatics(radius: float) -> Hydrostatics:
    """Hemisphere; about its centre the water turns no moment on it, so no C44."""
    volume, area = 2.0 / 3.0 * math.pi * radius**3, math.pi * radius**2
    return Hydrostatics(volume, np.array([0.0, 0.0, -0.375 * radius]), area, np.diag([0.0, 0.0, area, 0.0, 0.0, 0.0]))


def database(name: str) -> HydroDatabase:
    radius, depth, density, gravity, step = SPHERES[name]
    symmetry = Symmetry(turns=AROUND)
    theta = 0.5 * np.pi * np.arange(RINGS + 1) / RINGS
    rim = radius * np.column_stack([np.sin(theta), -np.cos(theta)])
    exact = exact_hydrostatics(radius)
    panels = hydrostatics(images(revolve(rim, AROUND, images=1), symmetry.operations()))
    rim *= (exact.volume / panels.volume) ** (1.0 / 3.0)  # the panels have the volume of the hemisphere
    lid = np.column_stack([np.linspace(0.0, rim[-1, 0], 24), np.full(24, -0.02 * radius)])
    sphere = WetBody(
        "sphere",
        revolve(rim, AROUND, images=1),
        (0.0, 0.0, 0.0),
        revolve(lid, AROUND, images=1),
        exact,
    )
    return compute_database(
        f"sphere_{name}",
        [sphere],
        step * np.arange(1, 81),
        HEADINGS,
        depth=depth,
        density=density,
        gravity=gravity,
        symmetry=symmetry,
        source={
            "geometry": f"half submerged sphere of radius {radius:g} m",
            "script": Path(__file__).name,
        },
        report=print,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("name", choices=list(SPHERES))
    parser.add_argument("--output", type=Path)
    options = parser.parse_args()
    output = options.output or Path(__file__).with_name(f"sphere_{options.name}_hydro.nc")
    write_checked(database(options.name), output)


if __name__ == "__main__":
    main()
