"""Closed meshes by formula that several tests share: (vertices, faces), corners counter-clockwise from outside."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

Mesh = tuple[np.ndarray, np.ndarray]


def box(x: float, y: float, z: float, n: Sequence[int] = (1, 1, 1)) -> Mesh:
    """Box of these sides centred at the origin, its sides divided by n."""
    size, vertices, faces = np.array([x, y, z]), [], []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (-1, 1):
            first, m = len(vertices), n[v] + 1
            for i in range(n[u] + 1):
                for j in range(m):
                    p = np.zeros(3)
                    p[[axis, u, v]] = side, 2.0 * i / n[u] - 1.0, 2.0 * j / n[v] - 1.0
                    vertices.append(0.5 * size * p)
            for i in range(n[u]):
                for j in range(n[v]):
                    k = first + m * i + j
                    quad = [k, k + m, k + m + 1, k + 1][::side]
                    faces += [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]
    return np.array(vertices), np.array(faces)


def ellipsoid(a: float, b: float, c: float, n: int) -> Mesh:
    """Ellipsoid about the origin: an octahedron of sides divided by n, blown up; 8 n^2 triangles inside the surface."""
    index, vertices, faces = {}, [], []

    def vertex(i: int, j: int, k: int, signs: tuple[int, int, int]) -> int:
        p = np.array([i, j, k]) * signs
        if tuple(p) not in index:
            index[tuple(p)] = len(vertices)
            angle = 0.5 * np.pi * np.abs(p) / n
            q = np.sign(p) * np.sin(angle)  # equal angles along the octahedron's edges
            vertices.append(q / np.linalg.norm(q) * (a, b, c))
        return index[tuple(p)]

    for signs in [(x, y, z) for x in (1, -1) for y in (1, -1) for z in (1, -1)]:
        turn = slice(None, None, int(np.prod(signs)))
        for i in range(n):
            for j in range(n - i):
                k = n - i - j
                corner = [vertex(*t, signs) for t in ((i, j, k), (i + 1, j, k - 1), (i, j + 1, k - 1))]
                faces.append(corner[turn])
                if k > 1:
                    corner = [vertex(*t, signs) for t in ((i + 1, j, k - 1), (i + 1, j + 1, k - 2), (i, j + 1, k - 1))]
                    faces.append(corner[turn])
    return np.array(vertices), np.array(faces)


def cylinder(r: float, low: float, high: float, n: int, rings: int = 1, tip: float | None = None) -> Mesh:
    """Vertical prism of n sides from z = low to high, in rings; the bottom runs to a tip at this z (flat if None)."""
    phi = 2.0 * np.pi * np.arange(n) / n
    levels = np.linspace(low, high, rings + 1)
    vertices = [[r * np.cos(p), r * np.sin(p), z] for z in levels for p in phi]
    vertices += [[0.0, 0.0, low if tip is None else tip], [0.0, 0.0, high]]
    faces = []
    for i in range(n):
        j = (i + 1) % n
        for k in range(rings):
            faces += [[k * n + i, k * n + j, (k + 1) * n + j], [k * n + i, (k + 1) * n + j, (k + 1) * n + i]]
        faces += [[len(vertices) - 2, j, i], [len(vertices) - 1, rings * n + i, rings * n + j]]
    return np.array(vertices), np.array(faces)
