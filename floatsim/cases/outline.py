"""Outlines of bodies in plan, for drawings: closed loops about the reference point.

Of the surface mesh of a body (its hull, or the panels of its hydrodynamic database) the faces that look down cover all
of it in plan; what borders on no other such face is the rim. A cylinder covers two circles and what lies between. A
body with neither gives nothing; its connection points then show where it is.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from typing import Any

import numpy as np

from floatsim.frames import Array, matrix_from_angles

_SAME = 1e-6  # of the size: corners closer than this in plan are one
_CIRCLE = 24  # corners of a circle


def outlines(model: Any) -> dict[str, dict[str, Any]]:
    """Name of every body -> {"loops": lists of [x, y], "points": name -> [x, y]}, m, for JSON.

    Relative to the reference point, axes of the world at the drawing position.
    """
    found = {}
    for body in model.parts:
        if hasattr(body, "water_loads") and hasattr(body, "attitude_deg"):
            R = matrix_from_angles(*np.radians(body.attitude_deg))
            found[str(body.name)] = {
                "loops": [np.round(loop, 2).tolist() for loop in plan_outline(body)],
                "points": {name: np.round(R @ p, 2)[:2].tolist() for name, p in body.points.items()},
            }
    return found


def plan_outline(body: Any) -> list[Array]:
    """Closed loops (n, 2) [m] that together cover the body in plan, about its reference point."""
    R = matrix_from_angles(*np.radians(body.attitude_deg))
    loops: list[Array] = []
    for load in body.water_loads:
        for vertices, faces in _surfaces(load):
            loops += _rim(vertices @ R.T, faces)
        if hasattr(load, "diameter") and hasattr(load, "a"):
            loops.append(_shadow(body, load, R))
    return loops


def _surfaces(load: Any) -> Iterator[tuple[Array, Array]]:
    """Meshes of a water load: vertices (n, 3) from the reference point, faces (m, 3 or 4)."""
    if hasattr(load, "surface"):
        yield load.surface.vertices, load.surface.faces
    elif getattr(load, "hull", None) is not None:
        yield from _surfaces(load.hull)
    elif hasattr(load, "database") and load.data.hull_faces is not None:
        own = load.data.hull_body == load.index if load.data.hull_body is not None else slice(None)
        yield load.data.hull_vertices - load.data.reference_point[load.index], load.data.hull_faces[own]


def _rim(vertices: Array, faces: Array) -> list[Array]:
    """Loops around the faces that look down."""
    corners = vertices[faces]
    up = 0.5 * np.cross(corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1])[:, 2]
    if faces.shape[1] == 3:
        up = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2]
    size = float(np.ptp(vertices[:, :2], axis=0).max())
    down = up * (np.sign(up.sum()) or -1.0) > 1e-9 * size**2  # an open hull has more of them, whichever way it is wound
    plan = np.round(vertices[:, :2] / (_SAME * size)).astype(np.int64)
    _, name = np.unique(plan, axis=0, return_inverse=True)
    place = {int(n): v[:2] for n, v in zip(name.ravel(), vertices)}
    count: dict[tuple[int, int], int] = defaultdict(int)
    for face in name.ravel()[faces[down]].tolist():
        for a, b in zip(face, face[1:] + face[:1]):
            if a != b:
                count[a, b] += 1
                count[b, a] -= 1
    leads: dict[int, list[int]] = defaultdict(list)
    for (a, b), n in count.items():
        if n > 0:
            leads[a].extend([b] * n)
    loops = []
    while leads:
        first = here = next(iter(leads))
        loop = []
        while True:
            loop.append(place[here])
            there = leads[here].pop()
            if not leads[here]:
                del leads[here]
            here = there
            if here == first or here not in leads:
                break
        loops.append(_corners(np.array(loop), 1e-4 * size))
    return [loop for loop in loops if len(loop) > 2]


def _corners(loop: Array, tolerance: float) -> Array:
    """The loop without the points that lie between their neighbours."""
    before, after = np.roll(loop, 1, axis=0), np.roll(loop, -1, axis=0)
    e = after - before
    length = np.maximum(np.hypot(*e.T), 1e-30)
    off = np.abs(e[:, 0] * (loop - before)[:, 1] - e[:, 1] * (loop - before)[:, 0]) / length
    return loop[off > tolerance]


def _shadow(body: Any, member: Any, R: Array) -> Array:
    """A cylinder in plan: the convex hull of the circles at its ends."""
    from scipy.spatial import ConvexHull

    turn = np.linspace(0.0, 2.0 * math.pi, _CIRCLE, endpoint=False)
    ends = [body.points[str(y).rsplit(".", 1)[-1]] if isinstance(y, str) else y for y in (member.a, member.b)]
    wide = np.broadcast_to(np.asarray(member.diameter, dtype=float), 2)
    axis = R @ (np.asarray(ends[1], dtype=float) - np.asarray(ends[0], dtype=float))
    lean = abs(axis[2]) / float(np.linalg.norm(axis))  # a circle looks this narrow along the cylinder
    along = axis[:2] / (np.hypot(*axis[:2]) or 1.0)
    circle = np.outer(lean * np.cos(turn), along) + np.outer(np.sin(turn), (-along[1], along[0]))
    if not np.any(along):
        circle = np.column_stack([np.cos(turn), np.sin(turn)])
    points = np.vstack([(R @ np.asarray(end, dtype=float))[:2] + 0.5 * d * circle for end, d in zip(ends, wide)])
    return np.asarray(points[ConvexHull(points).vertices])
