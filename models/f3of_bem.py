"""Hydrodynamic database of the Floating Three-body Oscillating Flap (F3OF): a base and two hinged flaps, in deep water.

    python models/f3of_bem.py

Needs the extra `bem` (Capytaine >= 3.0); about seven minutes.

The device of the WEC3 code comparison (Combourieu et al., EWTEC 2015). Dimensions measured from the public surface of
the comparison's model: four columns on pontoons at z -9 m, 25 m apart, two flaps of two plates each. Its round
members are octagons there; here they are boxes of the same section, so that the whole is a union of boxes
of the same volume.
Flaps are drawn upright; where they touch the base, there is neither water nor panel.
Reference points: base (0, 0, -9), flaps (-12.5, 0, -5.5) fore and (12.5, 0, -5.5) aft (centres of mass).
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np

from floatsim.hydro.compute import Symmetry, WetBody, compute_database, write_checked
from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.meshing import Box, Mesh, boxes, graded, join, planes, rectangle

LEG = 12.5  # of columns and hinges from the middle, along x and y
TOP, BOTTOM, FOOT, FLAP_BOTTOM = -8.0, -10.0, -12.0, -9.707  # pontoons, footings under the columns, flaps
COLUMN, TUBE = 1.2615, 0.7071  # half widths; an octagon of radius 1.5 has 6.364 m2, one of radius 1 has 2.828
# the water between the flaps sloshes across: peaks of damping at 1.31, 1.70, 2.04, 2.34, 2.62 rad/s, some 0.04 wide
OMEGA = np.concatenate([
    0.05 * np.arange(1, 24), 1.1625 + 0.0125 * np.arange(26), 1.5 + 0.05 * np.arange(3),
    1.6375 + 0.0125 * np.arange(12), 1.8 + 0.025 * np.arange(38), 0.05 * np.arange(55, 101),
])  # fmt: skip
HEADINGS = np.radians([-180.0, -90.0, 0.0, 90.0])
SIZE = 1.4
NAMES = ("base", "fore", "aft")
REFERENCES = ((0.0, 0.0, -9.0), (-LEG, 0.0, -5.5), (LEG, 0.0, -5.5))


def around(centre: float, half: float) -> tuple[float, float]:
    return centre - half, centre + half


def base() -> list[Box]:
    """The half y > 0."""
    level, parts = (BOTTOM, TOP), []
    for side in (-1.0, 1.0):
        x = side * LEG
        parts += [
            (around(x, COLUMN), around(LEG, COLUMN), (FOOT, BOTTOM)),
            (around(x, 1.5), around(LEG, 1.5), level),
            (around(x, COLUMN), around(LEG, COLUMN), (TOP, 0.0)),
            (around(x, 1.0), (0.0, 1.0), level),  # hinge blocks, between which the plates of a flap turn
            (around(x, 1.0), (10.5, 11.0), level),
            (around(4.0 * side, 1.0), (0.0, 1.0), level),  # joints of the pontoons
            (around(4.0 * side, 1.0), around(LEG, 1.0), level),
            (around(4.0 * side, TUBE), (1.0, LEG - 1.0), level),
        ]
    parts.append(((1.0 - LEG, LEG - 1.0), (0.0, TUBE), level))
    parts.append(((1.5 - LEG, LEG - 1.5), around(LEG, TUBE), level))
    return parts


def bodies() -> list[WetBody]:
    flaps: list[list[Box]] = [[(around(x, 1.0), (1.0, 10.5), (FLAP_BOTTOM, 0.0))] for x in (-LEG, LEG)]
    every = [base(), *flaps]
    lines = tuple(planes((v for body in every for box in body for v in box[k]), SIZE) for k in range(3))
    hulls = boxes(every, (lines[0], lines[1], lines[2]))
    hulls[0] = open_middle(hulls[0])
    column = np.linspace(-COLUMN, COLUMN, 5)
    lids = [join(*(rectangle(leg + column, LEG + column, -0.15) for leg in (-LEG, LEG)))]
    lids += [rectangle(leg + np.linspace(-1.0, 1.0, 5), graded(1.0, 10.5, 0.7), -0.15) for leg in (-LEG, LEG)]
    return [WetBody(name, hull, point, lid) for name, hull, point, lid in zip(NAMES, hulls, REFERENCES, lids)]


def open_middle(mesh: Mesh) -> Mesh:
    """Without the panels on the plane of symmetry."""
    inside = np.abs(mesh.vertices[mesh.faces, 1]).max(axis=1) < 1e-9
    return Mesh(mesh.vertices, mesh.faces[~inside])


def database() -> HydroDatabase:
    return compute_database(
        "f3of",
        bodies(),
        OMEGA,
        HEADINGS,
        depth=math.inf,
        density=1025.0,
        gravity=9.81,
        symmetry=Symmetry(mirrors=("xOz",)),
        source={
            "geometry": "F3OF of the WEC3 comparison, round members as boxes of the same section",
            "script": Path(__file__).name,
        },
        report=print,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--output", type=Path, default=Path(__file__).with_name("f3of_hydro.nc"))
    write_checked(database(), parser.parse_args().output)


if __name__ == "__main__":
    main()
