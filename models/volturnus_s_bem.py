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

Accuracy: the sharp edges make convergence slow. From 1.55 m (4698 panels, shipped) to 1.2 m (7968 panels)
A_inf falls by 0.5 %, and another 1 to 1.5 % may be left. The coefficients published with the OpenFAST
model (WAMIT, about 5000 flat panels) are at the same stage.
"""

from __future__ import annotations

import argparse
import hashlib
import logging
import math
import time
from pathlib import Path

import numpy as np

from floatsim.hydro.database import DOF_NAMES, HydroDatabase, check_database

CENTRE_RADIUS, OUTER_RADIUS, OUTER_DISTANCE = 5.0, 6.25, 51.75
HALF_WIDTH = OUTER_RADIUS  # of a pontoon: as wide as the outer columns
KEEL, PONTOON_TOP = -20.0, -13.0
DENSITY, GRAVITY = 1025.0, 9.81
REFERENCE_POINT = (0.0, 0.0, 0.0)
OMEGA = np.array([0.05 * k for k in range(1, 61)])
SOLVED_HEADINGS = np.radians(np.arange(0.0, 61.0, 5.0))

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


def grid(points: np.ndarray) -> Plan:
    """Cells of a structured block of points (a, b, dim), counter-clockwise if b turns left of a."""
    a, b = points.shape[:2]
    index = np.arange(a * b).reshape(a, b)
    faces = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1)
    return points.reshape(a * b, -1), faces.reshape(-1, 4)


def join(*parts: Plan) -> Plan:
    """One mesh with coincident vertices merged."""
    offset = np.cumsum([0] + [len(vertices) for vertices, _ in parts])
    vertices = np.concatenate([vertices for vertices, _ in parts])
    faces = np.concatenate([faces + shift for (_, faces), shift in zip(parts, offset[:-1], strict=True)])
    _, first, inverse = np.unique(np.round(vertices, 6), axis=0, return_index=True, return_inverse=True)
    return vertices[first], inverse.reshape(-1)[faces]


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


def triangles(mesh: Plan) -> np.ndarray:
    vertices, faces = mesh
    return np.concatenate([vertices[faces[:, [0, 1, 2]]], vertices[faces[:, [0, 2, 3]]]])


def mesh_geometry(mesh: Plan) -> tuple[float, float, float]:
    """Volume, waterplane area and height of the centre of buoyancy of an open hull (closed by z = 0)."""
    tri = triangles(mesh)
    area = 0.5 * np.cross(tri[:, 1] - tri[:, 0], tri[:, 2] - tri[:, 0])
    z = tri[..., 2]
    mean = z.mean(axis=1)
    mean_square = (np.sum(z * z, axis=1) + np.sum(z, axis=1) ** 2) / 12.0
    volume = float(area[:, 2] @ mean)
    return volume, float(-np.sum(area[:, 2])), float(0.5 * area[:, 2] @ mean_square) / volume


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
    edges: dict[tuple[int, int], int] = {}
    for face in faces:
        for a, b in zip(face, np.roll(face, -1), strict=True):
            if a != b:
                assert (int(a), int(b)) not in edges, "two panels use an edge in the same direction"
                edges[int(a), int(b)] = 1
    free = [a for a, b in edges if (b, a) not in edges and min(vertices[a, 2], vertices[b, 2]) < -1e-6]
    assert not free, f"{len(free)} free edges below the waterline"
    print(f"panels {len(faces)}, vertices {len(vertices)}, watertight below the waterline")


def solve(hull: Plan, lid: Plan, depth: float, omegas: np.ndarray) -> dict[str, np.ndarray]:
    """Capytaine's numbers, in its own time factor e^{-i w t}: A, B (n, 6, 6), A_inf (6, 6), X (n, 13, 6)."""
    import capytaine as cpt
    from capytaine.tools.block_circulant_matrices import NestedBlockCirculantMatrix

    logging.getLogger("capytaine").setLevel(logging.ERROR)

    def symmetric(sector: Plan) -> cpt.RotationSymmetricMesh:
        half = cpt.Mesh(vertices=sector[0], faces=sector[1])
        return cpt.RotationSymmetricMesh(cpt.ReflectionSymmetricMesh(half, plane="xOz"), n=3)

    body = cpt.FloatingBody(
        mesh=symmetric(hull),
        lid_mesh=symmetric(lid),
        dofs=cpt.rigid_body_dofs(rotation_center=REFERENCE_POINT),
        name="volturnus_s",
    )
    solver = cpt.BEMSolver(method="direct")
    sea = {"body": body, "water_depth": depth, "rho": DENSITY, "g": GRAVITY}

    def radiation(omega: float) -> tuple[np.ndarray, np.ndarray]:
        mass, damping = np.zeros((6, 6)), np.zeros((6, 6))
        for j, dof in enumerate(DOF_NAMES):
            result = solver.solve(
                cpt.RadiationProblem(radiating_dof=dof, omega=omega, **sea), keep_details=False
            )
            for i, other in enumerate(DOF_NAMES):
                mass[i, j] = result.added_masses[other]
                damping[i, j] = result.radiation_dampings[other]
        return mass, damping

    def excitation(omega: float, heading: float) -> list[complex]:
        problem = cpt.DiffractionProblem(wave_direction=heading, omega=omega, **sea)
        diffraction = solver.solve(problem, keep_details=False).forces
        froude_krylov = cpt.bem.airy_waves.froude_krylov_force(problem)
        return [diffraction[dof] + froude_krylov[dof] for dof in DOF_NAMES]

    mass, damping, force = [], [], []
    start = time.monotonic()
    mass_inf, _ = radiation(math.inf)
    for count, omega in enumerate(omegas, 1):
        a, b = radiation(float(omega))
        mass.append(a)
        damping.append(b)
        force.append([excitation(float(omega), float(heading)) for heading in SOLVED_HEADINGS])
        # this cache of Capytaine 3.0.0 keeps every matrix it has ever seen
        NestedBlockCirculantMatrix.to_BlockCirculantMatrix.cache_clear()
        print(f"\r{count}/{len(omegas)} frequencies, {time.monotonic() - start:.0f} s", end="", flush=True)
    print()
    return {
        "added_mass": np.array(mass),
        "radiation_damping": np.array(damping),
        "added_mass_inf": mass_inf,
        "excitation": np.array(force),
    }


def expand(force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Headings every 5 degrees in [-180, 180) and their excitation (n, 72, 6) from those in 0..60 (n, 13, 6).

    A mirrored wave gives the mirrored force, a wave turned by 120 degrees the turned one (D3 symmetry).
    """
    mirror = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    degrees = np.arange(-180, 180, 5)
    full = np.empty((force.shape[0], degrees.size, 6), dtype=np.complex128)
    for k, heading in enumerate(degrees):
        turns = round(heading / 120.0)
        rest = heading - 120 * turns  # in -60..60
        solved = force[:, abs(rest) // 5] * (1.0 if rest >= 0 else mirror)
        cos, sin = math.cos(2.0 * math.pi * turns / 3.0), math.sin(2.0 * math.pi * turns / 3.0)
        turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
        full[:, k] = (solved.reshape(-1, 2, 3) @ turn.T).reshape(-1, 6)
    return np.radians(degrees), full


def symmetry_errors(raw: dict[str, np.ndarray]) -> dict[str, float]:
    """What the panels leave of the exact symmetries, as a share of the diagonal (of the force's peak)."""
    a, b, x = raw["added_mass"], raw["radiation_damping"], raw["excitation"]
    peaks = [np.sqrt(np.abs(np.diagonal(c, axis1=1, axis2=2)).max(axis=0)) for c in (a, b)]
    x_peak = np.abs(x).max(axis=(0, 1))
    sideways = np.abs(x[:, 0]).max(axis=0) / x_peak  # sway, roll and yaw vanish at heading 0
    reciprocity = [
        np.abs(c - c.transpose(0, 2, 1)) / np.outer(p, p) for c, p in zip((a, b), peaks, strict=True)
    ]
    return {
        "symmetry_error_added_mass": float(reciprocity[0].max()),
        "symmetry_error_radiation_damping": float(reciprocity[1].max()),
        "symmetry_error_d3_added_mass": float(np.abs(a[:, 1, 1] / a[:, 0, 0] - 1.0).max()),
        "symmetry_error_d3_excitation": float(sideways[[1, 3, 5]].max()),
    }


def mesh_hash(mesh: Plan) -> str:
    """SHA-256 of vertices (rounded to a micrometre) and faces."""
    vertices, faces = mesh
    rounded = np.round(np.asarray(vertices, dtype="<f8"), 6) + 0.0  # no negative zeros
    return (
        "sha256:" + hashlib.sha256(rounded.tobytes() + np.asarray(faces, dtype="<i8").tobytes()).hexdigest()
    )


def hydrostatic_stiffness() -> np.ndarray:
    """Waterplane + rho g V z_B without weight, about the reference point (axis, z = 0). Exact circles."""
    volume, waterplane, moment, height = exact_geometry()
    tilt = DENSITY * GRAVITY * (moment + volume * height)
    return np.diag([0.0, 0.0, DENSITY * GRAVITY * waterplane, tilt, tilt, 0.0])


def database(size: float, depth: float) -> HydroDatabase:
    """Mesh, solve and put into floatsim's conventions. Raises AssertionError if a check of the mesh fails."""
    import capytaine

    hull, lid = sector_mesh(size)
    vertices, faces = mesh = six_images(hull)
    check_mesh(mesh)
    raw = solve(hull, lid, depth, OMEGA)
    errors = symmetry_errors(raw)
    for key, error in errors.items():
        assert error < 0.02, f"{key} is {error:.3g}: the mesh is too coarse"
    # reciprocity is exact in the continuum; what the panels leave of it is averaged out and reported
    for key in ("added_mass", "radiation_damping", "added_mass_inf"):
        raw[key] = 0.5 * (raw[key] + np.swapaxes(raw[key], -1, -2))
    headings, force = expand(raw["excitation"])
    volume, _, _, height = exact_geometry()

    return HydroDatabase(
        name="volturnus_s",
        omega=OMEGA,
        added_mass=raw["added_mass"],
        radiation_damping=raw["radiation_damping"],
        added_mass_inf=raw["added_mass_inf"],
        headings=headings,
        excitation=np.conj(force),  # Capytaine has e^{-i w t}; both measure phase from the origin
        hydrostatic_stiffness=hydrostatic_stiffness(),
        volume=np.array(volume),
        centre_of_buoyancy=np.array([0.0, 0.0, height]),
        reference_point=np.array(REFERENCE_POINT),
        depth=depth,
        density=DENSITY,
        gravity=GRAVITY,
        hull_vertices=vertices,
        hull_faces=faces,
        source={
            "title": "UMaine VolturnUS-S, first-order potential flow",
            "geometry": "published dimensions, Allen et al., NREL/TP-5000-76773 (2020)",
            "script": Path(__file__).name,
            "solver": f"Capytaine {capytaine.__version__}",
            "method": "direct (potential formulation), lid below the waterline, dihedral symmetry D3",
            "panel_size": size,
            "panels_hull": len(faces),
            "panels_lid": 6 * len(lid[1]),
            "lid_height": float(lid[0][0, 2]),
            "mesh_hash": mesh_hash(mesh),
            "headings_solved": "0 to 60 deg by 5 deg, the others by symmetry",
            **errors,
        },
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--size", type=float, default=1.55, help="panel size in m (1.55: 4698 panels)")
    parser.add_argument("--depth", type=float, default=200.0, help="water depth in m")
    parser.add_argument("--output", type=Path, default=Path(__file__).with_name("volturnus_s_hydro.nc"))
    options = parser.parse_args()
    db = database(options.size, options.depth)
    for key, value in db.source.items():
        print(f"{key:34s} {value}")
    findings = check_database(db)
    for finding in findings:
        print(f"{finding.severity:8s} {finding.message}")
    if any(finding.severity == "error" for finding in findings):
        raise SystemExit("not written: the coefficients are not consistent")
    db.write(options.output)
    print(f"{options.output}: {options.output.stat().st_size / 1e6:.3f} MB")


if __name__ == "__main__":
    main()
