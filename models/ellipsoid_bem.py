"""Hydrodynamic database of the half submerged ellipsoid of WEC-Sim's nonlinear-hydrodynamics example.

    python models/ellipsoid_bem.py

Needs the extra `bem` (Capytaine >= 3.0); half a minute. Semi-axes 5, 5 and 2.5 m, 70 m of water, rho 1000 kg/m3;
reference point: the centre of mass of the example, 2 m below the water.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np

from floatsim.hydro.compute import Symmetry, WetBody, compute_database, write_checked
from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.meshing import Hydrostatics, hydrostatics, images, revolve

RADIUS, DRAUGHT, DEPTH = 5.0, 2.5, 70.0
REFERENCE = (0.0, 0.0, -2.0)
AROUND, RINGS = 72, 28
OMEGA = 0.1 * np.arange(3, 61)
HEADINGS = np.radians(np.arange(-180.0, 180.0, 10.0))


def exact_hydrostatics() -> Hydrostatics:
    volume, area, z = 2.0 / 3.0 * math.pi * RADIUS**2 * DRAUGHT, math.pi * RADIUS**2, -0.375 * DRAUGHT
    tilt = 0.25 * area * RADIUS**2 + volume * (z - REFERENCE[2])
    return Hydrostatics(volume, np.array([0.0, 0.0, z]), area, np.diag([0.0, 0.0, area, tilt, tilt, 0.0]))


def body(symmetry: Symmetry) -> WetBody:
    """One sector, scaled evenly so that the panels have the volume of the ellipsoid."""
    theta = 0.5 * np.pi * np.arange(RINGS + 1) / RINGS
    rim = np.column_stack([RADIUS * np.sin(theta), -DRAUGHT * np.cos(theta)])
    exact = exact_hydrostatics()
    panels = hydrostatics(images(revolve(rim, AROUND, images=1), symmetry.operations()))
    rim *= (exact.volume / panels.volume) ** (1.0 / 3.0)
    lid = np.column_stack([np.linspace(0.0, rim[-1, 0], 24), np.full(24, -0.1)])
    return WetBody("ellipsoid", revolve(rim, AROUND, images=1), REFERENCE, revolve(lid, AROUND, images=1), exact)


def database() -> HydroDatabase:
    symmetry = Symmetry(turns=AROUND)
    return compute_database(
        "ellipsoid",
        [body(symmetry)],
        OMEGA,
        HEADINGS,
        depth=DEPTH,
        density=1000.0,
        gravity=9.81,
        symmetry=symmetry,
        source={"geometry": "half of an ellipsoid of semi-axes 5, 5, 2.5 m", "script": Path(__file__).name},
        report=print,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--output", type=Path, default=Path(__file__).with_name("ellipsoid_hydro.nc"))
    write_checked(database(), parser.parse_args().output)


if __name__ == "__main__":
    main()
