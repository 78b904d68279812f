"""Linear springs and dampers between two connection points.

Force along the line between the points, pulling when longer than the free length:

    F = k (l - l_free) + c dl/dt

A point on a body stands at x + R r and moves with v + w x (R r). A tension-only spring gives
nothing below its free length (damper included) and its damper never makes it push.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from floatsim.description import Name, NonNegative, Target
from floatsim.frames import Array, at, cross, dot, minus, plus, rotate, times, unit, vec
from floatsim.jit import kernel
from floatsim.parts.part import Output, Part

Index = NDArray[np.int64]


class Spring(Part):
    """Spring and damper from `a` to `b`: names of connection points, or fixed points (x, y, z) [m].

    stiffness [N/m], damping [N s/m], free_length [m], tension_only.
    """

    name: Name
    a: Target
    b: Target
    stiffness: NonNegative
    free_length: NonNegative
    damping: NonNegative = 0.0
    tension_only: bool = False

    @staticmethod
    def batch() -> type[SpringBatch]:
        return SpringBatch

    @property
    def between(self) -> tuple[Any, ...]:
        return self.a, self.b

    def problems(self, ends: dict[str, Array], sea: Any) -> list[str]:
        """What only shows once the ends are known."""
        a, b = ends.get("a"), ends.get("b")
        if a is None or b is None or np.linalg.norm(b - a) > 0.0:
            return []
        return [f"Spring '{self.name}': its two ends start at the same place; its direction would be undefined"]


@kernel
def springs(x, R, v, c, where, arms, P, slots, K, A, r, s, force):  # type: ignore[no-untyped-def]
    """where (n, 4): point and rotation of a, of b; arms (n, 6); P (4, n): k, c, free length, tension only."""
    base = 3 * x.shape[0]
    for e in range(where.shape[0]):
        pa, ra, pb, rb = where[e, 0], where[e, 1], where[e, 2], where[e, 3]
        aa = rotate(R, ra, (arms[e, 0], arms[e, 1], arms[e, 2]))
        ab = rotate(R, rb, (arms[e, 3], arms[e, 4], arms[e, 5]))
        wa, wb = at(v, base + 3 * ra), at(v, base + 3 * rb)
        d = minus(plus(vec(x, pb), ab), plus(vec(x, pa), aa))
        dv = minus(plus(at(v, 3 * pb), cross(wb, ab)), plus(at(v, 3 * pa), cross(wa, aa)))
        l = math.sqrt(dot(d, d))
        t = times(1.0 / l if l > 0.0 else 0.0, d)
        k, cd, l0 = P[0, e], P[1, e], P[2, e]
        rate = dot(t, dv)
        F = k * (l - l0) + cd * rate
        if P[3, e] > 0.0 and (l < l0 or F < 0.0):
            F, k, cd = 0.0, 0.0, 0.0
        across = F / l if l > 0.0 else k  # stiffness across the spring; a spring of no length at all has no direction
        force[e] = F
        f = times(F, t)  # on a; -f on b
        ma, mb = cross(aa, f), cross(ab, f)
        dofs = (3 * pa, base + 3 * ra, 3 * pb, base + 3 * rb)
        for m in range(3):
            r[dofs[0] + m] -= f[m]
            r[dofs[1] + m] -= ma[m]
            r[dofs[2] + m] += f[m]
            r[dofs[3] + m] += mb[m]
        s[pa] += abs(F)
        s[pb] += abs(F)
        s[x.shape[0] + ra] += abs(F) * math.sqrt(dot(aa, aa))
        s[x.shape[0] + rb] += abs(F) * math.sqrt(dot(ab, ab))
        for block in range(4):
            for n in range(3):
                u = unit(n)
                zero = (0.0, 0.0, 0.0)
                # change of d, dv and of the two arms under a unit change of this coordinate / its rate
                da, db, dd, ddv, rate_v = zero, zero, zero, zero, zero
                if block == 0:
                    dd, rate_v = times(-1.0, u), times(-1.0, u)
                elif block == 1:
                    da = cross(u, aa)
                    dd, ddv, rate_v = times(-1.0, da), times(-1.0, cross(wa, da)), times(-1.0, da)
                elif block == 2:
                    dd, rate_v = u, u
                else:
                    db = cross(u, ab)
                    dd, ddv, rate_v = db, cross(wb, db), db
                dl = dot(t, dd)
                turn = minus(dd, times(dl, t))  # l dt
                turning = dot(turn, dv) / l if l > 0.0 else 0.0
                dF = c[2] * (k * dl + cd * (turning + dot(t, ddv))) + c[1] * cd * dot(t, rate_v)
                df = plus(times(dF, t), times(c[2] * across, turn))
                dma = plus(cross(aa, df), times(c[2], cross(da, f)))
                dmb = plus(cross(ab, df), times(c[2], cross(db, f)))
                col = 3 * block + n
                for m in range(3):
                    K[m, col] = -df[m]
                    K[3 + m, col] = -dma[m]
                    K[6 + m, col] = df[m]
                    K[9 + m, col] = dmb[m]
        for p in range(12):
            for q in range(12):
                A[slots[e, 12 * p + q]] += K[p, q]


class SpringBatch:
    """All springs of a system."""

    runs: ClassVar[list[tuple[int, int]]] = []
    remembers: ClassVar[bool] = True

    def __init__(self, parts: Sequence[Spring], first_point: Sequence[int], first_rotation: Sequence[int],
                 sea: Any, gravity: float) -> None:  # fmt: skip
        self.parts = tuple(parts)
        self.P = np.array(
            [[p.stiffness, p.damping, p.free_length, float(p.tension_only)] for p in parts], dtype=float
        ).T.copy()
        self.force = np.zeros(len(self.parts))
        self._K = np.zeros((12, 12))

    def connect(self, numbering: Any) -> None:
        """Resolve the connection points."""
        ends = [(numbering.place(p.a), numbering.place(p.b)) for p in self.parts]
        self.where = np.array([[a.point, a.rotation, b.point, b.rotation] for a, b in ends], dtype=np.int64)
        self.arms = np.array([[*a.arm, *b.arm] for a, b in ends], dtype=float)

    def dofs(self, n_point: int) -> list[Index]:
        xyz, base = np.arange(3), 3 * (n_point + 1)
        w = self.where
        return [np.concatenate([3 * w[:, :1] + xyz, base + 3 * w[:, 1:2] + xyz,
                                3 * w[:, 2:3] + xyz, base + 3 * w[:, 3:4] + xyz], axis=1)]  # fmt: skip

    def bind(self, slots: list[Index]) -> None:
        (self._slots,) = slots

    def outputs(self) -> list[Output]:
        """Forces of the springs."""
        return [Output(f"{p.name}_force", f"force in {p.name}, pulling positive", "N") for p in self.parts]

    def measure(self, w: Any, out: Array) -> None:
        """Of the state last evaluated."""
        out[:] = self.force

    def add(self, w: Any) -> None:
        springs(w.x, w.R, w.v, w.c, self.where, self.arms, self.P, self._slots, self._K, w.A, w.r, w.s, self.force)

    def ledger(self, w: Any, book: Any) -> None:
        """U = k (l - l_free)^2/2, nothing for a slack one that only pulls; the rest of the force is the damper's."""
        n = len(w.x)
        springs = zip(self.where, self.arms, self.P.T, self.force, strict=True)
        for (pa, ra, pb, rb), arms, (k, _, free, pulls), F in springs:
            aa, ab = w.R[ra] @ arms[:3], w.R[rb] @ arms[3:]
            va, vb = (w.v[3 * p : 3 * p + 3] + np.cross(w.v[3 * (n + r) : 3 * (n + r) + 3], y)
                      for p, r, y in ((pa, ra, aa), (pb, rb, ab)))  # fmt: skip
            d = w.x[pb] + ab - w.x[pa] - aa
            l = float(np.linalg.norm(d))
            rate = d @ (vb - va) / l if l > 0.0 else 0.0
            e = 0.0 if pulls and l < free else l - free
            book.store("spring", 0.5 * k * e * e, k * e * rate)
            book.work("pto", (k * e - F) * rate)
