"""Hydrodynamic database of the UMaine VolturnUS-S platform from its published dimensions.

    python models/volturnus_s_bem.py                                  the shipped file, about 8 minutes
    python models/volturnus_s_bem.py --size 2.6 --output coarse.nc    a coarse one, about 2 minutes

Needs the extra `bem` (Capytaine >= 3.0). Dimensions: Allen et al., Definition of the UMaine
VolturnUS-S Reference Platform, NREL/TP-5000-76773 (2020): draught 20 m, centre column 10 m and three
outer columns 12.5 m in diameter at 51.75 m from the axis (one on -x), joined to the centre by pontoons
12.5 m wide and 7 m high with their bottoms at the keel.

The hull is two stacked prisms, pontoon level and column level, so that its union needs no booleans: the
plan of half a pontoon arm (a sector of 60 degrees) is meshed in structured blocks, walls are extruded
edges, and the six images of the sector are the hull (dihedral symmetry D3, which the solver uses).

Its mean drift is that of platform and turbine afloat without moorings (volturnus_s.py), without drag.

Accuracy: the sharp edges make convergence slow. From 1.55 m (4698 panels, shipped) to 1.2 m (7968 panels)
A_inf falls by 0.5 %, and another 1 to 1.5 % may be left. The coefficients published with the OpenFAST
model (WAMIT, about 5000 flat panels) are at the same stage.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np

from floatsim.hydro.compute import Symmetry, WetBody, compute_database, write_checked
from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.far_field import FreeFloating
from floatsim.hydro.meshing import Hydrostatics, Mesh, grid, hydrostatics, join, mesh_problems

CENTRE_RADIUS, OUTER_RADIUS, OUTER_DISTANCE = 5.0, 6.25, 51.75
HALF_WIDTH = OUTER_RADIUS  # of a pontoon: as wide as the outer columns
KEEL, PONTOON_TOP = -20.0, -13.0
DENSITY, GRAVITY = 1025.0, 9.81
REFERENCE_POINT = (0.0, 0.0, 0.0)
OMEGA = np.array([0.05 * k for k in range(1, 61)])
HEADINGS = np.radians(np.arange(-180.0, 180.0, 5.0))

Plan = tuple[np.ndarray, np.ndarray]  # vertices (p, 2) or (p, 3), faces (q, 4)


def exact_geometry() -> tuple[float, float, float, float]:
    """Volume m3, waterplane area m2 and second moment m4 about x or y, height of the centre of buoyancy m."""
    outer, centre = math.pi * OUTER_RADIUS**2, math.pi * CENTRE_RADIUS**2
    half_arm = HALF_WIDTH * OUTER_DISTANCE - HALF_WIDTH**2 / (2.0 * math.sqrt(3.0)) + outer / 4.0
    waterplane = centre + 3.0 * outer
    lower, upper = 6.0 * half_arm * (PONTOON_TOP - KEEL), -waterplane * PONTOON_TOP
    moment = math.pi / 4.0 * (CENTRE_RADIUS**4 + 3.0 * OUTER_RADIUS**4) + 1.5 * outer * OUTER_DISTANCE**2
    height = (lower * 0.5 * (KEEL + PONTOON_TOP) + upper * 0.5 * PONTOON_TOP) / (lower + upper)
    return lower + upper, waterplane, moment, height


def between(start: np.ndarray, end: np.ndarray, count: int) -> np.ndarray:
    """(count + 1, k, 2) points on straight lines from each start point to its end point."""
    s = np.linspace(0.0, 1.0, count + 1)[:, None, None]
    return (1.0 - s) * start + s * end


def fan(centre: tuple[float, float], arc: np.ndarray, size: float) -> Plan:
    """Polar mesh of a disc's sector; the innermost cells are triangles (a vertex twice)."""
    middle = np.broadcast_to(centre, arc.shape)
    count = max(2, round(float(np.linalg.norm(arc[0] - middle[0])) / size))
    return grid(between(middle, arc, count))


def extrude(edge: np.ndarray, heights: np.ndarray) -> Plan:
    """Wall over a polyline (k, 2) that has the water on its right."""
    points = np.empty((len(edge), len(heights), 3))
    points[..., :2] = edge[:, None, :]
    points[..., 2] = heights
    return grid(points)


def at_height(plan: Plan, z: float, *, up: bool) -> Plan:
    vertices, faces = plan
    return np.column_stack([vertices, np.full(len(vertices), z)]), faces if up else faces[:, ::-1]


def sector_mesh(size: float) -> tuple[Plan, Plan]:
    """Hull and lid of the sector of half an arm, panels about `size` metres; outward normals (lid downward).

    Worked out for an arm on +x, half of it at y >= 0, then turned by 180 degrees. Polygon radii keep the
    areas of the circles; of the outer polygon the vertex where the pontoon's side arrives stays on it.
    """
    rows = max(3, round(0.5 * math.pi * OUTER_RADIUS / size))  # panels on a quarter of an outer column
    box_rows = rows + math.ceil(rows / 2)  # panels on the centre column's 60 degrees
    turn = 0.5 * math.pi / rows
    # (rows - 1) r^2 + R r = rows R^2 turn / sin(turn): quarter polygon with one vertex at R, area pi R^2 / 4
    c = rows * turn / math.sin(turn) * OUTER_RADIUS**2
    r = (math.sqrt(OUTER_RADIUS**2 + 4.0 * (rows - 1) * c) - OUTER_RADIUS) / (2.0 * (rows - 1))
    phi = turn * np.arange(2 * rows + 1)
    radius = np.full(phi.size, r)
    radius[rows] = OUTER_RADIUS
    outer = np.column_stack([OUTER_DISTANCE + radius * np.cos(phi), radius * np.sin(phi)])

    step = math.pi / 3.0 / box_rows
    psi = step * np.arange(box_rows + 1)
    centre = CENTRE_RADIUS * math.sqrt(step / math.sin(step)) * np.column_stack([np.cos(psi), np.sin(psi)])
    box_x = HALF_WIDTH / math.tan(psi[rows])
    reach = np.minimum(box_x / np.cos(psi), HALF_WIDTH / np.maximum(np.sin(psi), 1e-12))
    box = reach[:, None] * np.column_stack([np.cos(psi), np.sin(psi)])

    ring = grid(between(centre, box, max(2, round((np.mean(reach) - CENTRE_RADIUS) / size))))
    left, right = box[: rows + 1], outer[: rows - 1 : -1]
    strip_points = between(left, right, round((OUTER_DISTANCE - OUTER_RADIUS - box_x) / size))
    strip = grid(strip_points)
    centre_disc, outer_disc = fan((0.0, 0.0), centre, size), fan((OUTER_DISTANCE, 0.0), outer, size)

    side = np.concatenate([outer[:rows], strip_points[::-1, -1], box[rows + 1 :]])
    # finer towards the pontoons' sharp edges, where the flow is singular: 0.4 % of the added mass
    layers = round((PONTOON_TOP - KEEL) / size) + 1
    share = 0.5 - 0.5 * np.cos(np.pi * np.arange(layers + 1) / layers)
    pontoon_heights = KEEL + (PONTOON_TOP - KEEL) * share
    column_heights = np.linspace(PONTOON_TOP, 0.0, round(-PONTOON_TOP / size) + 1)
    hull = join(
        *(at_height(part, KEEL, up=False) for part in (centre_disc, ring, strip, outer_disc)),
        *(at_height(part, PONTOON_TOP, up=True) for part in (ring, strip)),
        extrude(side, pontoon_heights),
        extrude(centre, column_heights),
        extrude(outer, column_heights),
    )
    lid = join(*(at_height(part, -0.125 * size, up=False) for part in (centre_disc, outer_disc)))
    half_turn = np.array([-1.0, -1.0, 1.0])
    return (hull[0] * half_turn, hull[1]), (lid[0] * half_turn, lid[1])


def six_images(sector: Plan) -> Plan:
    """The whole hull; mirror images have their faces reversed."""
    vertices, faces = sector
    parts = []
    for k in range(3):
        cos, sin = math.cos(2.0 * math.pi * k / 3.0), math.sin(2.0 * math.pi * k / 3.0)
        turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
        parts.append((vertices @ turn.T, faces))
        parts.append((vertices * (1.0, -1.0, 1.0) @ turn.T, faces[:, ::-1]))
    return join(*parts)


def mesh_geometry(mesh: Plan) -> tuple[float, float, float]:
    """Volume, waterplane area and height of the centre of buoyancy of an open hull (closed by z = 0)."""
    whole = hydrostatics(mesh)
    return whole.volume, whole.waterplane, float(whole.centre[2])


def check_mesh(mesh: Plan) -> None:
    """Exact volume, waterplane, centre of buoyancy; watertight below the waterline. Raises AssertionError."""
    volume, waterplane, _, height = exact_geometry()
    got = mesh_geometry(mesh)
    for label, value, exact in zip(
        ("volume [m3]", "waterplane [m2]", "centre of buoyancy [m]"),
        got,
        (volume, waterplane, height),
        strict=True,
    ):
        print(f"{label:24s} mesh {value:12.5f}   exact {exact:12.5f}")
        assert abs(value - exact) < 1e-8 * abs(exact), label
    vertices, faces = mesh
    problems = mesh_problems(Mesh(vertices, faces))
    assert not problems, "; ".join(problems)
    print(f"panels {len(faces)}, vertices {len(vertices)}, watertight below the waterline")


def exact_hydrostatics() -> Hydrostatics:
    """About the reference point (axis, z = 0), with exact circles."""
    volume, waterplane, moment, height = exact_geometry()
    tilt = moment + volume * height
    stiffness = np.diag([0.0, 0.0, waterplane, tilt, tilt, 0.0])
    return Hydrostatics(volume, np.array([0.0, 0.0, height]), waterplane, stiffness)


def afloat() -> FreeFloating:
    """Platform, tower, rotor and nacelle of volturnus_s.py as they float without moorings, for the mean drift."""
    import volturnus_s  # beside this script

    mass, center, inertia = volturnus_s.rigid_sum(-14.94)
    return FreeFloating(mass, center - REFERENCE_POINT, inertia)


def database(size: float, depth: float) -> HydroDatabase:
    """Mesh and solve. Raises AssertionError if a check of the mesh fails or if it is too coarse."""
    hull, lid = sector_mesh(size)
    check_mesh(six_images(hull))
    platform = WetBody("volturnus_s", Mesh(*hull), REFERENCE_POINT, Mesh(*lid), exact_hydrostatics())
    db = compute_database(
        "volturnus_s",
        [platform],
        OMEGA,
        HEADINGS,
        depth=depth,
        density=DENSITY,
        gravity=GRAVITY,
        symmetry=Symmetry(mirrors=("xOz",), turns=3),
        drift=afloat(),
        source={
            "geometry": "published dimensions, Allen et al., NREL/TP-5000-76773 (2020)",
            "script": Path(__file__).name,
            "panel_size": size,
            "lid_height": float(lid[0][0, 2]),
        },
        report=print,
    )
    for key in ("symmetry_error_added_mass", "symmetry_error_radiation_damping"):
        assert db.source[key] < 0.02, f"{key} is {db.source[key]:.3g}: the mesh is too coarse"
    return db


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--size", type=float, default=1.55, help="panel size in m (1.55: 4698 panels)")
    parser.add_argument("--depth", type=float, default=200.0, help="water depth in m")
    parser.add_argument("--output", type=Path, default=Path(__file__).with_name("volturnus_s_hydro.nc"))
    options = parser.parse_args()
    write_checked(database(options.size, options.depth), options.output)


if __name__ == "__main__":
    main()
