"""Point masses: a weight at the end of a line, a bob. M = m I, weight -m g, no rotation, no volume, no seabed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from floatsim.description import Name, Positive, Vector3
from floatsim.frames import Array
from floatsim.jit import kernel
from floatsim.parts.part import Anchor, Part

Index = NDArray[np.int64]


class PointMass(Part):
    """A point with mass [kg] at a drawing position [m]. Connection point: `NAME`."""

    name: Name
    mass: Positive
    position: Vector3


    @property
    def n_points(self) -> int:
        return 1

    @staticmethod
    def batch() -> type[PointMassBatch]:
        return PointMassBatch

    def anchors(self) -> dict[str, Anchor]:
        """Connection points: name -> (local point, local rotation or -1, arm)."""
        return {"": (0, -1, (0.0, 0.0, 0.0))}

    def place(self, ends: dict[str, Array], sea: Any) -> tuple[Array, Array]:
        return np.array([self.position]), np.empty((0, 3, 3))


@kernel
def point_masses(a, c, points, P, slots, A, r, s):  # type: ignore[no-untyped-def]
    """Inertia and weight. P (n, 2): mass, g."""
    for b in range(points.shape[0]):
        m, g, i = P[b, 0], P[b, 1], points[b]
        for q in range(3):
            r[3 * i + q] += m * (a[3 * i + q] + (g if q == 2 else 0.0))
            A[slots[b, 4 * q]] += c[0] * m
            s[i] += m * abs(a[3 * i + q])
        s[i] += m * abs(g)


class PointMassBatch:
    """All point masses of a system."""

    runs: ClassVar[list[tuple[int, int]]] = []
    remembers: ClassVar[bool] = False

    def __init__(self, parts: Sequence[PointMass], first_point: Sequence[int], first_rotation: Sequence[int],
                 sea: Any, gravity: float) -> None:  # fmt: skip
        self.parts = tuple(parts)
        self.points = np.array(first_point, dtype=np.int64)
        self.P = np.array([[p.mass, gravity] for p in parts], dtype=float)

    def dofs(self, n_point: int) -> list[Index]:
        return [3 * self.points[:, None] + np.arange(3)]

    def bind(self, slots: list[Index]) -> None:
        (self._slots,) = slots

    def add(self, w: Any) -> None:
        point_masses(w.a, w.c, self.points, self.P, self._slots, w.A, w.r, w.s)

    def ledger(self, w: Any, book: Any) -> None:
        """T = m v^2/2, U = m g z."""
        m, g = self.P.T
        v, a = (y[: 3 * len(w.x)].reshape(-1, 3)[self.points] for y in (w.v, w.a))
        book.store("kinetic", 0.5 * m @ (v * v).sum(axis=1), m @ (v * a).sum(axis=1))
        book.store("gravity", (m * g) @ w.x[self.points, 2], (m * g) @ v[:, 2])
