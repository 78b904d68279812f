"""Clump weights, buoyancy modules and clamps on a line: point loads between two nodes.

    F = - m g + phi rho V g + phi 1/2 rho CdA |w| w + phi rho V (1 + Ca) a_f - (m + phi rho V Ca) a,   w = u - v

in equal axes (a sphere's), phi the wet share of a body as high as a sphere of its volume. Both nodes of the element
carry their share of every term with their own motion, as of a load on a simply supported beam: weight and its
moment stay exact wherever the attachment sits between the nodes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from floatsim.description import Name
from floatsim.frames import at, dot, minus, vec
from floatsim.jit import kernel
from floatsim.parts.part import Part
from floatsim.parts.section import Attachment

Index = NDArray[np.int64]

MASS, VOLUME, DRAG, ADDED, HEIGHT = range(5)  # rows of the parameters


class LineLoad(Part):
    """The attachment `load` of line `line`; comes with the line."""

    name: Name
    line: str
    load: Attachment

    @staticmethod
    def batch() -> type[LineLoadBatch]:
        return LineLoadBatch


def sphere_height(volume: float) -> float:
    """Diameter of the sphere of a volume [m]."""
    return (6.0 * volume / math.pi) ** (1.0 / 3.0)


@kernel
def point_loads(x, v, a, u, du, eta, c, points, P, rho, g, slots, A, r, s):  # type: ignore[no-untyped-def]
    """Loads at points (n); P (5, n): mass, volume, Cd A, Ca, height; slots (n, 9)."""
    for e in range(points.shape[0]):
        p = points[e]
        m, V, h = P[MASS, e], rho * P[VOLUME, e], max(P[HEIGHT, e], 1e-3)
        acc, flow = at(a, 3 * p), vec(du, p)
        w = minus(vec(u, p), at(v, 3 * p))
        size = math.sqrt(dot(w, w))
        phi = min(max(0.5 - (x[p, 2] - eta[p]) / h, 0.0), 1.0)
        slope = -1.0 / h if 0.0 < phi < 1.0 else 0.0
        cd = 0.5 * rho * P[DRAG, e]
        ma = V * P[ADDED, e]
        s[p] += (m + V) * g + cd * size * size
        for i in range(3):
            wet = ma * (acc[i] - flow[i]) - V * flow[i] - cd * size * w[i] - (V * g if i == 2 else 0.0)
            r[3 * p + i] += m * (acc[i] + (g if i == 2 else 0.0)) + phi * wet
            A[slots[e, 3 * i + 2]] += c[2] * slope * wet
            for j in range(3):
                D = w[i] * w[j] / size if size > 0.0 else 0.0
                k = c[1] * phi * cd * (D + (size if i == j else 0.0))
                if i == j:
                    k += c[0] * (m + phi * ma)
                A[slots[e, 3 * i + j]] += k


class LineLoadBatch:
    """All attachments of all lines."""

    runs: ClassVar[list[tuple[int, int]]] = []
    remembers: ClassVar[bool] = False

    def __init__(self, parts: Sequence[LineLoad], first_point: Sequence[int], first_rotation: Sequence[int],
                 sea: Any, gravity: float) -> None:  # fmt: skip
        self.parts = tuple(parts)
        self.rho, self.gravity = float(sea.density), float(gravity)

    def connect(self, numbering: Any) -> None:
        """Find the nodes and their shares."""
        points, columns = [], []
        for part in self.parts:
            line, first = numbering.part(f"{part.line}.end_a")
            load, e = part.load, line.element_at(part.load.at)
            share = (load.at - line.arc_length[e]) / line.element_lengths[e]
            for p, y in zip(line.element_points(e), (1.0 - share, share), strict=True):
                points.append(first + p)
                columns.append((y * load.mass, y * load.volume, y * load.drag_area, load.added_mass,
                                sphere_height(load.volume)))  # fmt: skip
        self.points = np.array(points, dtype=np.int64)
        self.P = np.array(columns, dtype=float).T.copy()
        self.wet_points = np.unique(self.points)

    def dofs(self, n_point: int) -> list[Index]:
        return [3 * self.points[:, None] + np.arange(3)]

    def bind(self, slots: list[Index]) -> None:
        (self._slots,) = slots

    def add(self, w: Any) -> None:
        point_loads(w.x, w.v, w.a, w.u, w.du, w.eta, w.c, self.points, self.P, self.rho, self.gravity, self._slots,
                    w.A, w.r, w.s)  # fmt: skip
