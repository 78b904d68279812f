"""The two primitives every joint is made of, g(q, t) = 0 with multipliers lam.

    coincide   g = x_A + R_A r_A - x_B - R_B r_B            three rows
    align      g = (R_A a) . (R_B b)                        one row: two axes stay normal

Both are polynomials in positions and rotation matrices, so G = dg/dq and the stiffness of G^T lam are
short and exact (logarithms of relative rotations were rejected: their second derivative is not).
lam of `coincide` is the force that A exerts on B, in world axes.

Side B may be the ground, standing still or driven: its arm or axis is then a function of time with
known velocity and acceleration (`Drive`). Source: Haug, Computer Aided Kinematics and Dynamics of
Mechanical Systems (1989), chapter 9: dot-1 and spherical constraints.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from floatsim.frames import Array, at, cross, dot, minus, plus, rotate, unit, vec
from floatsim.jit import kernel

Index = NDArray[np.int64]


class Place(NamedTuple):
    """A resolved connection point: point, rotation (the ground has its own of both), arm in that frame."""

    point: int
    rotation: int
    arm: tuple[float, float, float]


class Coincide(NamedTuple):
    """Points A and B coincide. drive: moves B, which must then be on the ground."""

    a: Place
    b: Place
    drive: Any = None


class Align(NamedTuple):
    """Axis a of A stays normal to axis b of B (each given in its own frame)."""

    a: int
    axis_a: tuple[float, float, float]
    b: int
    axis_b: tuple[float, float, float]
    drive: Any = None


@kernel
def coincide(x, R, c, where, arms, lam, first, slots, K, A, r, s):  # type: ignore[no-untyped-def]
    """where (n, 4): point and rotation of A, of B; arms (n, 6); lam from `first`; K (15, 15) scratch."""
    base = 3 * x.shape[0]
    rows = r.shape[0] - lam.shape[0]
    cK, cG = c[2], c[3]
    for e in range(where.shape[0]):
        pa, ra, pb, rb = where[e, 0], where[e, 1], where[e, 2], where[e, 3]
        aa = rotate(R, ra, (arms[e, 0], arms[e, 1], arms[e, 2]))
        ab = rotate(R, rb, (arms[e, 3], arms[e, 4], arms[e, 5]))
        k = first + 3 * e
        f = at(lam, k)
        g = minus(plus(vec(x, pa), aa), plus(vec(x, pb), ab))
        ma, mb = cross(aa, f), cross(ab, f)
        size = abs(f[0]) + abs(f[1]) + abs(f[2])
        s[pa] += size
        s[pb] += size
        s[x.shape[0] + ra] += size * math.sqrt(dot(aa, aa))
        s[x.shape[0] + rb] += size * math.sqrt(dot(ab, ab))
        for m in range(3):
            r[3 * pa + m] += f[m]
            r[base + 3 * ra + m] += ma[m]
            r[3 * pb + m] -= f[m]
            r[base + 3 * rb + m] -= mb[m]
            r[rows + k + m] += cG * g[m]
            u = unit(m)
            ua, ub = cross(u, aa), cross(u, ab)
            ka, kb = cross(ua, f), cross(ub, f)
            K[m, 12 + m] = K[12 + m, m] = cG
            K[6 + m, 12 + m] = K[12 + m, 6 + m] = -cG
            for n in range(3):
                K[3 + n, 3 + m] = cK * ka[n]
                K[9 + n, 9 + m] = -cK * kb[n]
                K[12 + n, 3 + m] = K[3 + m, 12 + n] = cG * ua[n]
                K[12 + n, 9 + m] = K[9 + m, 12 + n] = -cG * ub[n]
        for p in range(15):
            for q in range(15):
                A[slots[e, 15 * p + q]] += K[p, q]


@kernel
def align(R, n_point, c, where, axes, lam, first, slots, K, A, r, s):  # type: ignore[no-untyped-def]
    """where (n, 2): rotations of A and B; axes (n, 6); n_point counts the ground; K (7, 7) scratch."""
    base = 3 * n_point
    rows = r.shape[0] - lam.shape[0]
    cK, cG = c[2], c[3]
    for e in range(where.shape[0]):
        ra, rb = where[e, 0], where[e, 1]
        a = rotate(R, ra, (axes[e, 0], axes[e, 1], axes[e, 2]))
        b = rotate(R, rb, (axes[e, 3], axes[e, 4], axes[e, 5]))
        n = cross(a, b)
        k = first + e
        mu = lam[k]
        r[rows + k] += cG * dot(a, b)
        s[n_point + ra] += abs(mu)
        s[n_point + rb] += abs(mu)
        for m in range(3):
            r[base + 3 * ra + m] += mu * n[m]
            r[base + 3 * rb + m] -= mu * n[m]
            u = unit(m)
            na = cross(cross(u, a), b)  # change of n when A turns about axis m
            nb = cross(a, cross(u, b))
            K[6, m] = K[m, 6] = cG * n[m]
            K[6, 3 + m] = K[3 + m, 6] = -cG * n[m]
            for q in range(3):
                K[q, m] = cK * mu * na[q]
                K[q, 3 + m] = cK * mu * nb[q]
                K[3 + q, m] = -cK * mu * na[q]
                K[3 + q, 3 + m] = -cK * mu * nb[q]
        for p in range(7):
            for q in range(7):
                A[slots[e, 7 * p + q]] += K[p, q]


@kernel
def coincide_rates(x, R, v, where, arms, moving, out_rate, out_gamma):  # type: ignore[no-untyped-def]
    """dg/dt at fixed q, and the part of d2g/dt2 without accelerations of the system. moving (n, 6)."""
    base = 3 * x.shape[0]
    for e in range(where.shape[0]):
        ra, rb = where[e, 1], where[e, 3]
        aa = rotate(R, ra, (arms[e, 0], arms[e, 1], arms[e, 2]))
        ab = rotate(R, rb, (arms[e, 3], arms[e, 4], arms[e, 5]))
        wa, wb = at(v, base + 3 * ra), at(v, base + 3 * rb)
        centripetal = minus(cross(wa, cross(wa, aa)), cross(wb, cross(wb, ab)))
        for m in range(3):
            out_rate[3 * e + m] = -moving[e, m]
            out_gamma[3 * e + m] = centripetal[m] - moving[e, 3 + m]


@kernel
def align_rates(R, n_point, v, where, axes, moving, out_rate, out_gamma):  # type: ignore[no-untyped-def]
    """The same for `align`; moving (n, 6): angular velocity and acceleration of a driven axis b."""
    base = 3 * n_point
    for e in range(where.shape[0]):
        ra, rb = where[e, 0], where[e, 1]
        a = rotate(R, ra, (axes[e, 0], axes[e, 1], axes[e, 2]))
        b = rotate(R, rb, (axes[e, 3], axes[e, 4], axes[e, 5]))
        n = cross(a, b)
        wd, ad = (moving[e, 0], moving[e, 1], moving[e, 2]), (moving[e, 3], moving[e, 4], moving[e, 5])
        wa, wb = at(v, base + 3 * ra), plus(at(v, base + 3 * rb), wd)
        dn = plus(cross(cross(wa, a), b), cross(a, cross(wb, b)))
        out_rate[e] = -dot(wd, n)
        out_gamma[e] = dot(minus(wa, wb), dn) - dot(ad, n)


class Constraints:
    """All rows of all joints: multipliers first those of `coincide`, then those of `align`."""

    def __init__(self, points: Sequence[Coincide], axes: Sequence[Align]) -> None:
        self.points, self.axes = tuple(points), tuple(axes)
        self.n_point_rows = 3 * len(self.points)
        self.n = self.n_point_rows + len(self.axes)
        ends = self.points
        self.where = np.array([[g.a.point, g.a.rotation, g.b.point, g.b.rotation] for g in ends], dtype=np.int64)
        self.where = self.where.reshape(len(ends), 4)
        self.arms = np.array([[*g.a.arm, *g.b.arm] for g in ends], dtype=float).reshape(len(ends), 6)
        self.turns = np.array([[g.a, g.b] for g in axes], dtype=np.int64).reshape(len(axes), 2)
        self.vectors = np.array([[*g.axis_a, *g.axis_b] for g in axes], dtype=float).reshape(len(axes), 6)
        self._moving = np.zeros((len(ends), 6))
        self._turning = np.zeros((len(axes), 6))
        self._K15, self._K7 = np.zeros((15, 15)), np.zeros((7, 7))
        self._base_axes = self.vectors[:, 3:].copy()
        self._driven = [e for e, g in enumerate(ends) if g.drive is not None]
        self._driven_axes = [e for e, g in enumerate(axes) if g.drive is not None]

    def move(self, t: float) -> None:
        """Bring driven points and axes to time t."""
        for e in self._driven:
            p, v, a = self.points[e].drive.translation(t)
            self.arms[e, 3:] = p
            self._moving[e, :3], self._moving[e, 3:] = v, a
        for e in self._driven_axes:
            R, w, alpha = self.axes[e].drive.rotation(t)
            self.vectors[e, 3:] = R @ self._base_axes[e]
            self._turning[e, :3], self._turning[e, 3:] = w, alpha

    @property
    def driven(self) -> bool:
        return bool(self._driven or self._driven_axes)

    def dofs(self, n_point: int, n_dof: int) -> list[Index]:
        """Unknowns coupled by each row; n_dof: where multipliers start."""
        xyz, base = np.arange(3), 3 * (n_point + 1)
        w, n = self.where, len(self.where)
        rows = n_dof + 3 * np.arange(n)[:, None] + xyz
        tables = [np.concatenate([3 * w[:, :1] + xyz, base + 3 * w[:, 1:2] + xyz, 3 * w[:, 2:3] + xyz,
                                  base + 3 * w[:, 3:4] + xyz, rows], axis=1)]  # fmt: skip
        rows = n_dof + self.n_point_rows + np.arange(len(self.turns))[:, None]
        tables.append(np.concatenate([base + 3 * self.turns[:, :1] + xyz, base + 3 * self.turns[:, 1:] + xyz, rows],
                                     axis=1))  # fmt: skip
        return tables

    def bind(self, slots: list[Index]) -> None:
        self._slots, self._align_slots = slots

    def add(self, w: Any) -> None:
        if len(self.where):
            coincide(w.x, w.R, w.c, self.where, self.arms, w.lam, 0, self._slots, self._K15, w.A, w.r, w.s)
        if len(self.turns):
            align(w.R, len(w.x), w.c, self.turns, self.vectors, w.lam, self.n_point_rows, self._align_slots,
                  self._K7, w.A, w.r, w.s)  # fmt: skip

    def rates(self, w: Any) -> tuple[Array, Array]:
        """(dg/dt at fixed q, d2g/dt2 without the system's accelerations), each (n,)."""
        rate, gamma = np.zeros(self.n), np.zeros(self.n)
        m = self.n_point_rows
        coincide_rates(w.x, w.R, w.v, self.where, self.arms, self._moving, rate[:m], gamma[:m])
        align_rates(w.R, len(w.x), w.v, self.turns, self.vectors, self._turning, rate[m:], gamma[m:])
        return rate, gamma
