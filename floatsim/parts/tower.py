"""Drag of the wind on a tower, in strips.

Per unit length, with d the diameter, t the tower's direction, u the wind at the strip less the strip's velocity and
u_n = u - (u . t) t:

    f = 1/2 rho d C_D |u_n| u_n

The mean wind with its shear at the heights of the drawing position; turbulence is left out, a strip's share of the
rotor's thrust being small.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from floatsim.description import Description, NonNegative, PositiveInt, Vector3, numbers
from floatsim.frames import at, cross, dot, minus, plus, rotate, times, unit
from floatsim.jit import kernel
from floatsim.parts.part import Part

Index = NDArray[np.int64]


class Tower(Description):
    """A tapered round tower from `base` to `top` [m, in the axes and from the point that its rotor is given in].

    diameter [m]: at the base and at the top. drag [-]: 0.5 is usual for smooth towers at large Reynolds numbers.
    strips: into how many equal lengths it is cut.
    """

    base: Vector3
    top: Vector3
    diameter: Annotated[tuple[float, float], numbers("two numbers (at the base, at the top)", 2)]
    drag: NonNegative = 0.5
    strips: PositiveInt = 10

    @model_validator(mode="after")
    def _has_length(self) -> Tower:
        if self.base == self.top:
            raise ValueError(f"base and top are the same place, {self.base}")
        if min(self.diameter) <= 0.0:
            raise ValueError(f"diameter: got {self.diameter}; both must be positive")
        return self


class TowerDrag(Part):
    """The drag of a rotor's tower; comes with the rotor."""

    name: str
    rotor: Any
    tower: Tower

    needs_wind: ClassVar[bool] = True

    @staticmethod
    def batch() -> type[TowerBatch]:
        return TowerBatch


@kernel
def tower_drag(x, R, v, c, where, strips, slots, K, A, r, s):  # type: ignore[no-untyped-def]
    """where (n, 2): point and rotation; strips (n, 10): arm, rho d C_D l/2, wind, axis; slots (n, 36). Returns the
    power that the drag brings in [W]."""
    base = 3 * x.shape[0]
    power = 0.0
    for e in range(where.shape[0]):
        p, k = where[e, 0], where[e, 1]
        arm, t = rotate(R, k, at(strips[e], 0)), rotate(R, k, at(strips[e], 7))
        w = at(v, base + 3 * k)
        own = plus(at(v, 3 * p), cross(w, arm))
        u = minus(at(strips[e], 4), own)
        un = minus(u, times(dot(u, t), t))
        size, b = math.sqrt(dot(un, un)), strips[e, 3]
        F = times(b * size, un)
        M = cross(arm, F)
        power += dot(F, own)
        for m in range(3):
            r[3 * p + m] -= F[m]
            r[base + 3 * k + m] -= M[m]
        s[p] += b * size * size
        s[x.shape[0] + k] += b * size * size * math.sqrt(dot(arm, arm))
        if c[6] == 0.0 or size == 0.0:
            continue
        for column in range(6):
            j = unit(column % 3)
            if column < 3:
                du, dt, darm = times(-c[1], j), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
            else:
                dt, darm = times(c[2], cross(j, t)), times(c[2], cross(j, arm))
                du = times(-1.0, plus(times(c[1], cross(j, arm)), cross(w, darm)))
            dun = minus(du, plus(times(dot(du, t) + dot(u, dt), t), times(dot(u, t), dt)))
            dF = times(b, plus(times(size, dun), times(dot(un, dun) / size, un)))
            dM = plus(cross(darm, F), cross(arm, dF))
            for m in range(3):
                K[m, column], K[3 + m, column] = -dF[m], -dM[m]
        for i in range(6):
            for j in range(6):
                A[slots[e, 6 * i + j]] += K[i, j]
    return power


class TowerBatch:
    """Strips of all towers."""

    runs: ClassVar[list[tuple[int, int]]] = []
    remembers: ClassVar[bool] = False

    def __init__(self, parts: Sequence[TowerDrag], first_point: Sequence[int], first_rotation: Sequence[int],
                 sea: Any, gravity: float) -> None:  # fmt: skip
        self.parts = tuple(parts)
        self._K = np.zeros((6, 6))

    def connect(self, numbering: Any) -> None:
        """Cut the towers, and find the wind at the strips."""
        wind = numbering.wind
        where, rows = [], []
        for part in self.parts:
            tower, place = part.tower, numbering.place(part.rotor.body)
            hub = part.rotor.mount(numbering).hub
            a, b = np.array(tower.base), np.array(tower.top)
            length = float(np.linalg.norm(b - a))
            for q in (np.arange(tower.strips) + 0.5) / tower.strips:
                arm = a + q * (b - a) + place.arm
                z = float(numbering.x0[place.point, 2] + (numbering.R0[place.rotation] @ arm)[2])
                d = tower.diameter[0] + q * (tower.diameter[1] - tower.diameter[0])
                half = 0.5 * wind.density * d * tower.drag * length / tower.strips
                where.append([place.point, place.rotation])
                rows.append([*arm, half, *(wind.mean(z, hub) * wind.direction), *((b - a) / length)])
        self.where = np.array(where, dtype=np.int64)
        self.strips = np.array(rows)

    def dofs(self, n_point: int) -> list[Index]:
        xyz, base = np.arange(3), 3 * (n_point + 1)
        return [np.concatenate([3 * self.where[:, :1] + xyz, base + 3 * self.where[:, 1:] + xyz], axis=1)]

    def bind(self, slots: list[Index]) -> None:
        (self._slots,) = slots

    def add(self, w: Any) -> None:
        self._power = tower_drag(w.x, w.R, w.v, w.c, self.where, self.strips, self._slots, self._K, w.A, w.r, w.s)

    def ledger(self, w: Any, book: Any) -> None:
        """Power of the drag."""
        book.work("wind", self._power)
