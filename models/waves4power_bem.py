"""Hydrodynamic database of a self-reacting point absorber like Waves4Power's WaveEL, in 90 m of water.

    python models/waves4power_bem.py

Needs the extra `bem` (Capytaine >= 3.0); about two minutes.

Public (waves4power.com, 2016): a buoy of 8 m diameter with a vertical tube, open at both ends, that reaches 30 to 35 m
below it. Assumed, because it is not: draught of the buoy 4 m, a cone of 45 degrees between buoy and tube, outer
diameter of the tube 3 m, its lower end at z -35 m. The tube is closed here: the water in it is taken to move with it,
and its mass belongs to the body. Reference point: the axis at the waterline.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from floatsim.hydro.compute import Symmetry, WetBody, compute_database, write_checked
from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.meshing import profile, revolve

BUOY_RADIUS, BUOY_DRAUGHT = 4.0, 4.0
TUBE_RADIUS, TUBE_END = 1.5, -35.0
DEPTH = 90.0
REFERENCE = (0.0, 0.0, 0.0)
AROUND, SIZE, LID = 72, 0.6, -0.1
OMEGA = 0.05 * np.arange(1, 101)
HEADINGS = np.radians(np.arange(-180.0, 180.0, 10.0))


def body() -> WetBody:
    """One sector of 5 degrees."""
    knee = -BUOY_DRAUGHT - (BUOY_RADIUS - TUBE_RADIUS)
    tube = [(0.0, TUBE_END), (TUBE_RADIUS, TUBE_END), (TUBE_RADIUS, knee)]
    corners = [*tube, (BUOY_RADIUS, -BUOY_DRAUGHT), (BUOY_RADIUS, 0.0)]
    hull = profile(corners, SIZE, sharp=[1, 3, 4])
    lid = profile([(0.0, LID), (BUOY_RADIUS, LID)], 0.4 * SIZE)
    return WetBody("buoy", revolve(hull, AROUND, images=1), REFERENCE, revolve(lid, AROUND, images=1))


def database() -> HydroDatabase:
    return compute_database(
        "waves4power",
        [body()],
        OMEGA,
        HEADINGS,
        depth=DEPTH,
        density=1025.0,
        gravity=9.81,
        symmetry=Symmetry(turns=AROUND),
        source={
            "geometry": "point absorber of 8 m with a closed tube down to 35 m, assumptions in the script",
            "script": Path(__file__).name,
        },
        report=print,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--output", type=Path, default=Path(__file__).with_name("waves4power_hydro.nc"))
    write_checked(database(), parser.parse_args().output)


if __name__ == "__main__":
    main()
