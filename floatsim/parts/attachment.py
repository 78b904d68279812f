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


@kernel
def point_powers(x, v, a, u, du, eta, current, points, P, rho, g, out):  # type: ignore[no-untyped-def]
    """out: kinetic energy and its rate, weight's, buoyancy's in still water, powers of wave, current, drag and added
    mass. current (n_point, 3): the part of u that is no wave's."""
    for i in range(10):
        out[i] = 0.0
    for e in range(points.shape[0]):
        p = points[e]
        m, V, h = P[MASS, e], rho * P[VOLUME, e], max(P[HEIGHT, e], 1e-3)
        vel, acc, flow, stream = at(v, 3 * p), at(a, 3 * p), vec(du, p), vec(current, p)
        w = minus(vec(u, p), vel)
        phi = min(max(0.5 - (x[p, 2] - eta[p]) / h, 0.0), 1.0)
        depth = min(0.5 - x[p, 2] / h, 1.0)  # wet part of the height in still water, and what is above it
        still = max(depth, 0.0)
        drag = phi * 0.5 * rho * P[DRAG, e] * math.sqrt(dot(w, w))
        ma = V * P[ADDED, e]
        out[0] += 0.5 * m * dot(vel, vel)
        out[1] += m * dot(vel, acc)
        out[2] += m * g * x[p, 2]
        out[3] += m * g * vel[2]
        out[4] += V * g * (0.5 * still * still * h if depth < 1.0 else -x[p, 2])
        out[5] -= V * g * still * vel[2]
        moved = dot(w, vec(u, p)), dot(w, stream)
        out[6] += phi * (V + ma) * dot(flow, vel) + V * g * (phi - still) * vel[2] + drag * (moved[0] - moved[1])
        out[7] += drag * moved[1]
        out[8] -= drag * dot(w, w)
        out[9] -= phi * ma * dot(acc, vel)


def book_points(w: Any, book: Any, points: Any, P: Any, rho: float, g: float) -> None:
    """Enter the energies of point loads into the ledger."""
    y = np.zeros(10)
    point_powers(w.x, w.v, w.a, w.u, w.du, w.eta, book.current, points, P, rho, g, y)
    for k, name in enumerate(("kinetic", "gravity", "hydrostatic")):
        book.store(name, y[2 * k], y[2 * k + 1])
    for k, name in enumerate(("wave", "current", "drag", "added_mass")):
        book.work(name, y[6 + k])


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

    def ledger(self, w: Any, book: Any) -> None:
        """As of points."""
        book_points(w, book, self.points, self.P, self.rho, self.gravity)
