"""Hydrodynamic database of the Reference Model 3 point absorber: float and spar, interacting, in deep water.

    python models/rm3_bem.py

Needs the extra `bem` (Capytaine >= 3.0); about five minutes.

Dimensions: Neary et al., Methodology for Design and Economic Analysis of Marine Energy Conversion Technologies,
SAND2014-9040 (2014): float 20 m across, spar 6 m, heave plate 30 m; draughts 3 m and 29 m. The float's bottom is flat
to a radius of 5 m and rises by 1 m to its side. The float closes on the spar: a gap as in the drawings (0.25 m) holds a
column of water that resonates without loss in potential flow, so both coincident walls are left out.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np

from floatsim.hydro.compute import Symmetry, WetBody, compute_database, write_checked
from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.meshing import profile, revolve

FLOAT_RADIUS, FLAT_RADIUS, FLOAT_DRAUGHT, CONE = 10.0, 5.0, 3.0, 1.0
SPAR_RADIUS, SPAR_DRAUGHT = 3.0, 29.0
PLATE_RADIUS, PLATE_THICKNESS = 15.0, 0.1
FLOAT_REFERENCE, SPAR_REFERENCE = (0.0, 0.0, -0.72), (0.0, 0.0, -21.29)  # centres of mass, WEC-Sim's RM3
AROUND, SIZE, PLATE_SIZE, LID = 72, 0.55, 0.7, -0.2
OMEGA = 0.05 * np.arange(1, 81)
HEADINGS = np.radians(np.arange(-180.0, 180.0, 10.0))


def bodies() -> list[WetBody]:
    """One sector of 5 degrees of each."""
    hull = profile(
        [
            (SPAR_RADIUS, -FLOAT_DRAUGHT),
            (FLAT_RADIUS, -FLOAT_DRAUGHT),
            (FLOAT_RADIUS, CONE - FLOAT_DRAUGHT),
            (FLOAT_RADIUS, 0.0),
        ],
        SIZE,
        sharp=[2, 3],
    )
    top = -SPAR_DRAUGHT + PLATE_THICKNESS
    # finer towards the plate's rim, where the flow is singular; the same rings above and below the thin plate
    spar = profile(
        [(0.0, -SPAR_DRAUGHT), (SPAR_RADIUS, -SPAR_DRAUGHT), (PLATE_RADIUS, -SPAR_DRAUGHT), (PLATE_RADIUS, top),
         (SPAR_RADIUS, top), (SPAR_RADIUS, -FLOAT_DRAUGHT)],
        PLATE_SIZE,
        sharp=[2, 3],
    )  # fmt: skip
    lids = [
        profile([(a, LID), (b, LID)], SIZE) for a, b in ((SPAR_RADIUS, FLOAT_RADIUS), (0.0, SPAR_RADIUS))
    ]
    return [
        WetBody("float", revolve(hull, AROUND, images=1), FLOAT_REFERENCE, revolve(lids[0], AROUND, images=1)),
        WetBody("spar", revolve(spar, AROUND, images=1), SPAR_REFERENCE, revolve(lids[1], AROUND, images=1)),
    ]


def database() -> HydroDatabase:
    return compute_database(
        "rm3",
        bodies(),
        OMEGA,
        HEADINGS,
        depth=math.inf,
        density=1000.0,
        gravity=9.81,
        symmetry=Symmetry(turns=AROUND),
        source={
            "geometry": "Reference Model 3, SAND2014-9040, no gap between float and spar",
            "script": Path(__file__).name,
        },
        report=print,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--output", type=Path, default=Path(__file__).with_name("rm3_hydro.nc"))
    write_checked(database(), parser.parse_args().output)


if __name__ == "__main__":
    main()
