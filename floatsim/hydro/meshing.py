"""Panel meshes of hulls for potential flow, numpy only: bodies of revolution, unions of boxes, extruded plans.

A mesh holds the *wetted* surface alone: it is open at the waterline (z = 0, where the lid closes it), has no panels
inside the body, and its faces turn counter-clockwise seen from the water (normals outward, into the water). World
frame, z = 0 at mean sea level, metres. A triangle is a face with one vertex twice.

Unions are made by construction, never by booleans: a body of revolution is the outline of its section, and boxes are
merged on a grid that contains all their planes, whose cells are either water or body.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Mesh(NamedTuple):
    """vertices (p, 3) m, faces (q, 4) indices."""

    vertices: Array
    faces: NDArray[np.int64]


def grid(points: Array) -> Mesh:
    """Cells of a structured block of points (a, b, dim); the normal is (along a) x (along b)."""
    a, b = points.shape[:2]
    index = np.arange(a * b).reshape(a, b)
    faces = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1)
    return Mesh(points.reshape(a * b, -1), faces.reshape(-1, 4))


def join(*parts: tuple[Array, NDArray[np.int64]]) -> Mesh:
    """One mesh of several, vertices closer than a micrometre merged; the order of the faces is kept."""
    offset = np.cumsum([0] + [len(vertices) for vertices, _ in parts])
    vertices = np.concatenate([vertices for vertices, _ in parts])
    faces = np.concatenate([faces + shift for (_, faces), shift in zip(parts, offset[:-1])])
    _, first, inverse = np.unique(np.round(vertices, 6) + 0.0, axis=0, return_index=True, return_inverse=True)
    return Mesh(vertices[first], inverse.reshape(-1)[faces])


def graded(start: float, end: float, size: float, fine_start: bool = False, fine_end: bool = False) -> Array:
    """Points from start to end about `size` apart on average, closer together (cosine) at the ends said to be fine.

    Sharp edges are where the flow is singular: finer panels there are worth more than many elsewhere.
    """
    length = abs(end - start)
    n = max(1, math.ceil(length / size - 1e-9))
    s = np.linspace(0.0, 1.0, n + 1)
    if fine_start and fine_end:
        s = 0.5 - 0.5 * np.cos(np.pi * s)
    elif fine_start:
        s = 1.0 - np.cos(0.5 * np.pi * s)
    elif fine_end:
        s = np.sin(0.5 * np.pi * s)
    return start + (end - start) * s


def profile(corners: Sequence[tuple[float, float]], size: float, sharp: Iterable[int] = ()) -> Array:
    """Points (k, 2) on the polyline through corners (r, z), about `size` apart, closer at corners numbered `sharp`."""
    edges = set(sharp)
    points = [np.array([corners[0]])]
    for i, (a, b) in enumerate(zip(corners, corners[1:])):
        length = math.dist(a, b)
        s = graded(0.0, length, size, i in edges, i + 1 in edges)[1:, None] / length
        points.append((1.0 - s) * np.array(a) + s * np.array(b))
    return np.concatenate(points)


def revolve(points: Array, n: int, images: int | None = None) -> Mesh:
    """Mesh of revolution about the z axis from profile points (k, 2), r and z, with n panels around.

    The profile runs with the body on its left and the water on its right in the (r, z) plane: from the keel outwards
    and up (a lid, whose normal points down, from the axis outwards). The polygons' radii keep the areas of the circles,
    and so the volume of the body with the given profile. `images` = 1 gives one sector of 2 pi / n.
    """
    turn = 2.0 * math.pi / n
    radius = points[:, 0] * math.sqrt(turn / math.sin(turn))
    phi = turn * np.arange((n if images is None else images) + 1)
    ring = np.empty((len(points), len(phi), 3))
    ring[..., 0] = radius[:, None] * np.cos(phi)
    ring[..., 1] = radius[:, None] * np.sin(phi)
    ring[..., 2] = points[:, 1, None]
    mesh = grid(ring)
    return join((mesh.vertices, mesh.faces[:, ::-1]))


Box = tuple[tuple[float, float], tuple[float, float], tuple[float, float]]


def boxes(bodies: Sequence[Sequence[Box]], lines: tuple[Array, Array, Array]) -> list[Mesh]:
    """Surface of each body, a union of boxes ((x0, x1), (y0, y1), (z0, z1)), on the grid of sorted planes `lines`.

    Every face of a box must lie on a plane of the grid (`planes` makes such grids). Panels are the faces between a cell
    of a body and one of water: where two bodies touch there are none, and at z = 0 the hull is open.
    Raises ValueError for a box that is off the grid, or two bodies in one place.
    """
    owner = np.full([len(line) + 1 for line in lines], -1)  # with a layer of water around
    for number, body in enumerate(bodies):
        for box in body:
            cells = tuple(_cells(low, high, line) for (low, high), line in zip(box, lines))
            if np.any((owner[cells] != -1) & (owner[cells] != number)):
                raise ValueError(f"box {box} of body {number} is in another body")
            owner[cells] = number
    return [join(*_walls(owner, number, lines)) for number in range(len(bodies))]


def _cells(low: float, high: float, line: Array) -> slice:
    i, j = (int(np.argmin(np.abs(line - value))) for value in (low, high))
    if abs(line[i] - low) > 1e-9 or abs(line[j] - high) > 1e-9 or i >= j:
        raise ValueError(f"{low:g} to {high:g} is not between planes of the grid")
    return slice(i + 1, j + 1)


def _walls(owner: NDArray[np.int64], number: int, lines: tuple[Array, Array, Array]) -> list[Mesh]:
    """Faces between the cells of body `number` and water (-1), plane by plane."""
    parts = []
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    for axis in range(3):
        u, v = (k for k in range(3) if k != axis)
        cells = np.moveaxis(owner, axis, 0)
        for plane, height in enumerate(lines[axis]):
            if axis == 2 and abs(height) < 1e-9:
                continue
            below, above = cells[plane][1:-1, 1:-1], cells[plane + 1][1:-1, 1:-1]
            for inside, outside, up in ((below, above, True), (above, below, False)):
                i, j = np.nonzero((inside == number) & (outside == -1))
                corner = np.full((i.size, 4, 3), height)
                corner[..., u] = lines[u][i[:, None] + square[:, 0]]
                corner[..., v] = lines[v][j[:, None] + square[:, 1]]
                faces = np.arange(4 * i.size).reshape(-1, 4)
                # x cross y = z and y cross z = x, but x cross z = -y
                parts.append(Mesh(corner.reshape(-1, 3), faces if up == (axis != 1) else faces[:, ::-1]))
    return [part for part in parts if len(part.faces)]


def planes(corners: Iterable[float], size: float, fine: Iterable[float] = ()) -> Array:
    """Sorted planes of a grid through all the corners, about `size` apart, closer at the corners named `fine`."""
    values = sorted(set(corners))
    edges = [any(abs(v - f) < 1e-9 for f in fine) for v in values]
    parts = [graded(a, b, size, p, q)[:-1] for a, b, p, q in zip(values, values[1:], edges, edges[1:])]
    return np.concatenate([*parts, values[-1:]])


def rectangle(x: Array, y: Array, z: float) -> Mesh:
    """Lid of a rectangular waterplane at height z, on the grid of x and y; normal down."""
    points = np.stack([*np.meshgrid(x, y, indexing="ij"), np.full((len(x), len(y)), z)], axis=-1)
    mesh = grid(points)
    return Mesh(mesh.vertices, mesh.faces[:, ::-1])


def images(mesh: Mesh, operations: Sequence[Array]) -> Mesh:
    """The mesh under each of the orthogonal matrices (3, 3), one after the other; mirrored faces are reversed."""
    parts = []
    for q in operations:
        mirrored = np.linalg.det(q) < 0.0
        parts.append((mesh.vertices @ q.T, mesh.faces[:, ::-1] if mirrored else mesh.faces))
    return join(*parts)


def wetted(mesh: tuple[Array, NDArray[np.int64]]) -> Mesh:
    """The part below z = 0 of a mesh that also has faces above: faces across the waterline are cut, those in it go."""
    vertices, faces = np.array(mesh[0]), mesh[1]
    vertices[np.abs(vertices[:, 2]) < 1e-9, 2] = 0.0
    low, high = vertices[faces, 2].min(axis=1), vertices[faces, 2].max(axis=1)
    points, panels = list(vertices), list(faces[(low < 0.0) & (high <= 0.0)])
    for face in faces[(low < 0.0) & (high > 0.0)]:
        polygon: list[int] = []
        for a, b in zip(face, np.roll(face, -1)):
            if vertices[a, 2] <= 0.0 and a != b:
                polygon.append(int(a))
            if vertices[a, 2] * vertices[b, 2] < 0.0:
                p, q = vertices[min(a, b)], vertices[max(a, b)]  # the same from either side
                polygon.append(len(points))
                points.append(np.append((p + (q - p) * p[2] / (p[2] - q[2]))[:2], 0.0))
        for k in range(1, len(polygon) - 1, 2):
            fourth = polygon[k + 2] if k + 2 < len(polygon) else polygon[k + 1]
            panels.append(np.array([polygon[0], polygon[k], polygon[k + 1], fourth]))
    joined = join((np.array(points), np.array(panels)))
    used, where = np.unique(joined.faces, return_inverse=True)
    return Mesh(joined.vertices[used], where.reshape(-1, 4))


def to_waterline(mesh: tuple[Array, NDArray[np.int64]], near: float = 0.1) -> Mesh:
    """The mesh with vertices that would leave slivers where `wetted` cuts slid into z = 0: along their steepest edge
    that crosses it, if that takes less than the share `near` of the edge. On flat walls the shape stays."""
    vertices, faces = np.array(mesh[0]), np.asarray(mesh[1])
    a, b = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
    a, b = np.concatenate([a, b]), np.concatenate([b, a])
    p, q = vertices[a], vertices[b]
    crossing = p[:, 2] * q[:, 2] < 0.0
    a, p, q = a[crossing], p[crossing], q[crossing]
    share = p[:, 2] / (p[:, 2] - q[:, 2])
    steep = np.abs(p[:, 2] - q[:, 2]) / np.linalg.norm(q - p, axis=1)
    order = np.flatnonzero(share < near)[np.argsort(steep[share < near], kind="stable")]
    place = p[order] + share[order, None] * (q - p)[order]
    place[:, 2] = 0.0
    vertices[a[order]] = place  # the steepest last
    return Mesh(vertices, faces)


def lid(hull: tuple[Array, NDArray[np.int64]], size: float, height: float) -> Mesh:
    """Lid at z = `height` of any waterplane: the cells of a square grid of `size` whose middle is inside the waterline.

    For plain shapes a lid that follows the waterline (`revolve`, `rectangle`) needs fewer panels.
    """
    vertices, faces = hull
    a, b = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
    on = (vertices[a, 2] > -1e-9) & (vertices[b, 2] > -1e-9) & (a != b)
    p, q = vertices[a[on], :2], vertices[b[on], :2]
    if not len(p):
        raise ValueError("the mesh does not reach z = 0: a body under water needs no lid")
    lines = [planes((min(p[:, k].min(), q[:, k].min()), max(p[:, k].max(), q[:, k].max())), size) for k in (0, 1)]
    whole = rectangle(lines[0], lines[1], height)
    x, y = whole.vertices[whole.faces].mean(axis=1)[:, :2].T[:, :, None]
    across = (p[:, 1] > y) != (q[:, 1] > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        right = x < p[:, 0] + (y - p[:, 1]) / (q[:, 1] - p[:, 1]) * (q[:, 0] - p[:, 0])
    inside = np.sum(across & right, axis=1) % 2 == 1
    return Mesh(whole.vertices, whole.faces[inside])


# --- what a mesh holds ------------------------------------------------------------------------------


class Hydrostatics(NamedTuple):
    """Of an open hull closed by z = 0: volume m3, centre of buoyancy (3,) m, waterplane area m2, and stiffness (6, 6)
    per rho g about a point: waterplane + V z_B, without weight (m2, m3, m4)."""

    volume: float
    centre: Array
    waterplane: float
    stiffness: Array


def triangles(mesh: tuple[Array, NDArray[np.int64]]) -> Array:
    """(2 q, 3, 3) corners; each face is cut along its first diagonal."""
    vertices, faces = mesh
    return np.concatenate([vertices[faces[:, [0, 1, 2]]], vertices[faces[:, [0, 2, 3]]]])


def hydrostatics(mesh: tuple[Array, NDArray[np.int64]], point: Sequence[float] = (0.0, 0.0, 0.0)) -> Hydrostatics:
    """Volume, centre of buoyancy, waterplane and stiffness about `point`, exact for the flat triangles of the mesh."""
    return hydrostatics_of(triangles(mesh), point)


def hydrostatics_of(tri: Array, point: Sequence[float] = (0.0, 0.0, 0.0)) -> Hydrostatics:
    """The same of triangles (n, 3, 3) below z = 0, closed by it; their order is free.

    Gauss: integrals of the normal's vertical part over the hull stand for those over the waterplane.
    """
    area = 0.5 * np.cross(tri[:, 1] - tri[:, 0], tri[:, 2] - tri[:, 0])[:, 2]
    x, y, z = (0.5 * (tri + np.roll(tri, -1, axis=1))).transpose(2, 0, 1)  # mid-edges: exact for quadratics
    total = lambda f: float(area @ f.mean(axis=1))  # noqa: E731
    volume = total(z)
    centre = np.array([total(x * z), total(y * z), 0.5 * total(z * z)]) / (volume or 1e-300)
    dx, dy = x - point[0], y - point[1]
    s, sx, sy = -total(np.ones_like(x)), -total(dx), -total(dy)
    arm = centre - np.array(point)
    C = np.zeros((6, 6))
    C[2, 2] = s
    C[2, 3] = C[3, 2] = sy
    C[2, 4] = C[4, 2] = -sx
    C[3, 3] = -total(dy * dy) + volume * arm[2]
    C[4, 4] = -total(dx * dx) + volume * arm[2]
    C[3, 4] = C[4, 3] = total(dx * dy)
    C[3, 5], C[4, 5] = -volume * arm[0], -volume * arm[1]
    return Hydrostatics(volume, centre, s, C)


def mesh_problems(mesh: Mesh, depth: float = math.inf) -> list[str]:
    """What is wrong with a hull mesh, in words: empty if nothing. It may be open at z = 0 and on the seabed z = -depth.

    Looked for: vertices above z = 0 or below the seabed, panels there twice, edges below the waterline that are free or
    between panels turned opposite ways, panels without area, normals that point inwards. Bodies that touch are looked
    at as one mesh.
    """
    vertices, faces = mesh
    problems = []
    if vertices[:, 2].max() > 1e-6:
        above = int(np.sum(vertices[:, 2] > 1e-6))
        problems.append(f"{above} vertices above z = 0, up to {vertices[:, 2].max():.3g} m")
    _, doubled = np.unique(np.sort(faces, axis=1), axis=0, return_counts=True)
    if doubled.max() > 1:
        problems.append(f"{int(np.sum(doubled > 1))} panels are there twice")
    if vertices[:, 2].min() < -depth - 1e-6:
        problems.append(f"vertices below the seabed, down to {-vertices[:, 2].min():.4g} m in {depth:g} m of water")
    if faces_on := int(np.sum(vertices[faces, 2].max(axis=1) < -depth + 1e-6)):
        problems.append(f"{faces_on} panels on the seabed: leave them out")
    # each edge must be used as often one way as the other; at the waterline it need not be
    a, b = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
    a, b = a[a != b], b[a != b]
    edge, which = np.unique(np.column_stack([np.minimum(a, b), np.maximum(a, b)]), axis=0, return_inverse=True)
    balance = np.bincount(which.reshape(-1), weights=np.where(a < b, 1.0, -1.0), minlength=len(edge))
    low, high = vertices[edge, 2].min(axis=1), vertices[edge, 2].max(axis=1)
    free = edge[(balance != 0.0) & (low < -1e-6) & (high > -depth + 1e-6)]
    if len(free):
        problems.append(f"{len(free)} edges below the waterline are free or between panels turned opposite ways, "
                        f"the first at {_place(vertices[free[0, 0]])}")  # fmt: skip
    quad = vertices[faces]
    area = 0.5 * np.linalg.norm(np.cross(quad[:, 2] - quad[:, 0], quad[:, 3] - quad[:, 1]), axis=1)
    if area.min() < 1e-9 * area.mean():
        problems.append(f"panel {int(area.argmin())} has no area")
    volume = hydrostatics(mesh).volume
    if volume <= 0.0 and vertices[:, 2].min() > -depth + 1e-6:
        problems.append(f"the volume is {volume:.4g} m3: faces must turn counter-clockwise seen from the water")
    return problems


def mesh_hash(mesh: tuple[Array, NDArray[np.int64]]) -> str:
    """SHA-256 of vertices (rounded to a micrometre) and faces."""
    vertices, faces = mesh
    rounded = np.round(np.asarray(vertices, dtype="<f8"), 6) + 0.0  # no negative zeros
    return "sha256:" + hashlib.sha256(rounded.tobytes() + np.asarray(faces, dtype="<i8").tobytes()).hexdigest()


def _place(p: Array) -> str:
    return f"({p[0]:.4g}, {p[1]:.4g}, {p[2]:.4g}) m"
