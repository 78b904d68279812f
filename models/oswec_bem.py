"""Hydrodynamic database of a bottom-hinged flap (oscillating surge converter) and its base, in 10.9 m of water.

    python models/oswec_bem.py

Needs the extra `bem` (Capytaine >= 3.0); about three minutes.

WEC-Sim's OSWEC example: a flap 18 m wide and 1.8 m thick from the surface down to -9.4 m, its lower edge a half
cylinder, over a base of 1.8 x 18.04 x 1.5 m that stands on the seabed and is touched by the flap along a line.
Reference points: the flap's centre of mass at z -3.9 m, the middle of the base at z -10.15 m.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np

from floatsim.hydro.compute import Symmetry, WetBody, compute_database, write_checked
from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.meshing import Hydrostatics, Mesh, graded, grid, join, rectangle

DEPTH = 10.9
WIDTH, THICKNESS, ROUND_CENTRE = 18.0, 1.8, -8.5  # flap: m, m, z of the axis of its rounded edge
BASE_WIDTH, BASE_HEIGHT = 18.04, 1.5
FLAP_REFERENCE, BASE_REFERENCE = (0.0, 0.0, -3.9), (0.0, 0.0, -10.15)
SIZE = 0.5
OMEGA = 0.15 + 0.1 * np.arange(60)
HEADINGS = np.radians(np.arange(-180.0, 180.0, 10.0))


def flap() -> WetBody:
    """The quarter x > 0, y > 0."""
    r, half = 0.5 * THICKNESS, 0.5 * WIDTH
    angle = 0.5 * np.pi * np.linspace(0.0, 1.0, 4)
    arc = np.column_stack([r * np.sin(angle), ROUND_CENTRE - r * np.cos(angle)])
    z = graded(ROUND_CENTRE, 0.0, SIZE, fine_end=True)[1:]
    edge = np.concatenate([arc, np.column_stack([np.full(z.size, r), z])])  # (k, 2) x, z from the lowest point up
    y, s = graded(0.0, half, SIZE, fine_end=True), np.linspace(0.0, 1.0, 4)
    wall = np.empty((y.size, len(edge), 3))
    wall[..., 0], wall[..., 1], wall[..., 2] = edge[:, 0], y[:, None], edge[:, 1]
    end = np.empty((len(edge), s.size, 3))
    end[..., 0], end[..., 1], end[..., 2] = s * edge[:, :1], half, edge[:, 1:]
    lid = rectangle(r * s, y, -0.1)
    return WetBody("flap", join(grid(wall), grid(end)), FLAP_REFERENCE, lid, flap_hydrostatics())


def flap_hydrostatics() -> Hydrostatics:
    """Exact: a box down to the axis of the half cylinder below it."""
    r, height = 0.5 * THICKNESS, -ROUND_CENTRE
    box, bottom = THICKNESS * WIDTH * height, 0.5 * math.pi * r**2 * WIDTH
    volume, area = box + bottom, THICKNESS * WIDTH
    z = (-0.5 * box * height + bottom * (ROUND_CENTRE - 4.0 * r / (3.0 * math.pi))) / volume
    lever = volume * (z - FLAP_REFERENCE[2])
    roll, pitch = area * WIDTH**2 / 12.0 + lever, area * THICKNESS**2 / 12.0 + lever
    return Hydrostatics(volume, np.array([0.0, 0.0, z]), area, np.diag([0.0, 0.0, area, roll, pitch, 0.0]))


def base() -> WetBody:
    """The quarter x > 0, y > 0; its bottom is on the seabed, where the water does not lift it."""
    r, half, top = 0.5 * THICKNESS, 0.5 * BASE_WIDTH, BASE_HEIGHT - DEPTH
    x, y, z = np.linspace(0.0, r, 3), graded(0.0, half, SIZE, fine_end=True), np.linspace(-DEPTH, top, 3)
    roof = rectangle(x, y, top)
    front = np.stack(np.broadcast_arrays(r, y[:, None], z[None, :]), axis=-1)
    end = np.stack(np.broadcast_arrays(x[None, :], half, z[:, None]), axis=-1)
    hull = join(Mesh(roof.vertices, roof.faces[:, ::-1]), grid(front), grid(end))
    volume = THICKNESS * BASE_WIDTH * BASE_HEIGHT
    nothing = Hydrostatics(volume, np.array(BASE_REFERENCE), 0.0, np.zeros((6, 6)))
    return WetBody("base", hull, BASE_REFERENCE, None, nothing)


def database() -> HydroDatabase:
    return compute_database(
        "oswec",
        [flap(), base()],
        OMEGA,
        HEADINGS,
        depth=DEPTH,
        density=1000.0,
        gravity=9.81,
        symmetry=Symmetry(mirrors=("xOz", "yOz")),
        source={"geometry": "flap and base of WEC-Sim's OSWEC example, as boxes", "script": Path(__file__).name},
        report=print,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--output", type=Path, default=Path(__file__).with_name("oswec_hydro.nc"))
    write_checked(database(), parser.parse_args().output)


if __name__ == "__main__":
    main()
