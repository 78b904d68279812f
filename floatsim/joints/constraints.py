"""The four primitives every joint is made of, g(q, t) = 0 with multipliers lam.

    coincide     g = x_A + R_A r_A - x_B - R_B r_B       three rows
    align        g = (R_A a) . (R_B b)                   one row: two axes stay normal
    inline       g = (R_B e) . d - offset                one row: A's point stays in a plane of B
    separation   g = (d . d - L^2)/(2 L)                 one row: the points keep their distance

with d = x_A + R_A r_A - x_B - R_B r_B. All are polynomials in positions and rotation matrices, so G = dg/dq and the
stiffness of G^T lam are short and exact (logarithms of relative rotations were rejected: their second derivative is
not).

What A exerts on B: lam of `coincide` is the force, in world axes; mu of `align` the moment mu (a x b); lam of `inline`
the force lam e at A's point (on B it has the arm R_B r_B + d); lam of `separation` the force lam d/L, so that lam is
the tension of a rod.

Rows of `align` and `inline` can be switched off: the row then says lam = 0, by a diagonal entry that the pattern
always holds (locks). Side B of `coincide` and `align` may be the ground, standing still or driven: its arm or axis is
then a function of time with known velocity and acceleration (`Drive`). Source: Haug, Computer Aided Kinematics and
Dynamics of Mechanical Systems (1989), chapter 9: dot-1, dot-2, spherical and distance constraints.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from floatsim.frames import Array, at, cross, dot, minus, plus, rotate, times, unit, vec
from floatsim.jit import kernel

Index = NDArray[np.int64]
Triple = tuple[float, float, float]


class Place(NamedTuple):
    """A resolved connection point: point, rotation (the ground has its own of both), arm in that frame."""

    point: int
    rotation: int
    arm: Triple


class Coincide(NamedTuple):
    """Points A and B coincide. drive: moves B, which must then be on the ground."""

    a: Place
    b: Place
    drive: Any = None


class Align(NamedTuple):
    """Axis a of A stays normal to axis b of B (each given in its own frame)."""

    a: int
    axis_a: Triple
    b: int
    axis_b: Triple
    drive: Any = None


class Inline(NamedTuple):
    """The coordinate of point A along `axis` of B (unit length, B's frame) stays at `offset` [m] from point B."""

    a: Place
    b: Place
    axis: Triple
    offset: float = 0.0


class Separation(NamedTuple):
    """Points A and B keep the distance `length` [m]."""

    a: Place
    b: Place
    length: float


Row = Coincide | Align | Inline | Separation


class Drawing:
    """The drawing position: x0 (n_point + 1, 3), R0 (n_rotation + 1, 3, 3), both ending with the ground.

    Called with a rotation it gives its matrix (3, 3), None for the ground's.
    """

    def __init__(self, x0: Array, R0: Array) -> None:
        self._x0, self._R0 = x0, R0

    def __call__(self, rotation: int) -> Array | None:
        return self._R0[rotation] if rotation < len(self._R0) - 1 else None

    def attitude(self, place: Place) -> Array:
        """Rotation matrix of what a connection point is on, (3, 3); unity for the ground."""
        return self._R0[place.rotation]

    def position(self, place: Place) -> Array:
        """Where a connection point is drawn, (3,) world."""
        return np.asarray(self._x0[place.point] + self._R0[place.rotation] @ np.asarray(place.arm))


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
def align(R, n_point, c, where, axes, on, lam, first, slots, K, A, r, s):  # type: ignore[no-untyped-def]
    """where (n, 2): rotations of A and B; axes (n, 6); on (n,); n_point counts the ground; K (7, 7) scratch."""
    base = 3 * n_point
    rows = r.shape[0] - lam.shape[0]
    cK, cG = c[2], c[3]
    for e in range(where.shape[0]):
        if on[e] == 0.0:
            r[rows + first + e] += lam[first + e]
            A[slots[e, 48]] += cG
            continue
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
def inline(x, R, c, where, P, on, lam, first, slots, K, A, r, s):  # type: ignore[no-untyped-def]
    """where (n, 4): point and rotation of A, of B; P (n, 10): arms, axis, offset; on (n,); K (13, 13) scratch."""
    base = 3 * x.shape[0]
    rows = r.shape[0] - lam.shape[0]
    cK, cG = c[2], c[3]
    for e in range(where.shape[0]):
        k = first + e
        mu = lam[k]
        if on[e] == 0.0:
            r[rows + k] += mu
            A[slots[e, 168]] += cG
            continue
        pa, ra, pb, rb = where[e, 0], where[e, 1], where[e, 2], where[e, 3]
        aa = rotate(R, ra, (P[e, 0], P[e, 1], P[e, 2]))
        ab = rotate(R, rb, (P[e, 3], P[e, 4], P[e, 5]))
        t = rotate(R, rb, (P[e, 6], P[e, 7], P[e, 8]))
        p = minus(plus(vec(x, pa), aa), vec(x, pb))  # arm of the force on B
        ma, mb = cross(aa, t), cross(p, t)
        s[pa] += abs(mu)
        s[pb] += abs(mu)
        s[x.shape[0] + ra] += abs(mu) * math.sqrt(dot(aa, aa))
        s[x.shape[0] + rb] += abs(mu) * math.sqrt(dot(p, p))
        r[rows + k] += cG * (dot(t, minus(p, ab)) - P[e, 9])
        for m in range(3):
            r[3 * pa + m] += mu * t[m]
            r[base + 3 * ra + m] += mu * ma[m]
            r[3 * pb + m] -= mu * t[m]
            r[base + 3 * rb + m] -= mu * mb[m]
            K[12, m] = K[m, 12] = cG * t[m]
            K[12, 3 + m] = K[3 + m, 12] = cG * ma[m]
            K[12, 6 + m] = K[6 + m, 12] = -cG * t[m]
            K[12, 9 + m] = K[9 + m, 12] = -cG * mb[m]
            u = unit(m)
            dt = cross(u, t)
            dat, adt, pdt = cross(cross(u, aa), t), cross(aa, dt), cross(p, dt)
            for n in range(3):
                K[9 + n, m] = -cK * mu * dt[n]
                K[9 + n, 6 + m] = cK * mu * dt[n]
                K[3 + n, 3 + m] = cK * mu * dat[n]
                K[9 + n, 3 + m] = -cK * mu * dat[n]
                K[n, 9 + m] = cK * mu * dt[n]
                K[6 + n, 9 + m] = -cK * mu * dt[n]
                K[3 + n, 9 + m] = cK * mu * adt[n]
                K[9 + n, 9 + m] = -cK * mu * pdt[n]
        for i in range(13):
            for j in range(13):
                A[slots[e, 13 * i + j]] += K[i, j]


@kernel
def separation(x, R, c, where, P, lam, first, slots, K, A, r, s):  # type: ignore[no-untyped-def]
    """where (n, 4): point and rotation of A, of B; P (n, 7): arms, length; K (13, 13) scratch."""
    base = 3 * x.shape[0]
    rows = r.shape[0] - lam.shape[0]
    cK, cG = c[2], c[3]
    for e in range(where.shape[0]):
        k = first + e
        mu, L = lam[k], P[e, 6]
        pa, ra, pb, rb = where[e, 0], where[e, 1], where[e, 2], where[e, 3]
        aa = rotate(R, ra, (P[e, 0], P[e, 1], P[e, 2]))
        ab = rotate(R, rb, (P[e, 3], P[e, 4], P[e, 5]))
        d = minus(plus(vec(x, pa), aa), plus(vec(x, pb), ab))
        t = times(1.0 / L, d)
        ma, mb = cross(aa, t), cross(ab, t)
        s[pa] += abs(mu)
        s[pb] += abs(mu)
        s[x.shape[0] + ra] += abs(mu) * math.sqrt(dot(aa, aa))
        s[x.shape[0] + rb] += abs(mu) * math.sqrt(dot(ab, ab))
        r[rows + k] += 0.5 * cG * (dot(d, d) / L - L)
        f = cK * mu / L
        for m in range(3):
            r[3 * pa + m] += mu * t[m]
            r[base + 3 * ra + m] += mu * ma[m]
            r[3 * pb + m] -= mu * t[m]
            r[base + 3 * rb + m] -= mu * mb[m]
            K[12, m] = K[m, 12] = cG * t[m]
            K[12, 3 + m] = K[3 + m, 12] = cG * ma[m]
            K[12, 6 + m] = K[6 + m, 12] = -cG * t[m]
            K[12, 9 + m] = K[9 + m, 12] = -cG * mb[m]
            u = unit(m)
            da, db = cross(u, aa), cross(u, ab)
            au, bu = cross(aa, u), cross(ab, u)
            ka, kb = plus(cross(aa, da), cross(da, d)), minus(cross(ab, db), cross(db, d))
            ba, ab_ = cross(ab, da), cross(aa, db)
            for n in range(3):
                K[n, m] = K[6 + n, 6 + m] = f * u[n]
                K[n, 6 + m] = K[6 + n, m] = -f * u[n]
                K[n, 3 + m] = f * da[n]
                K[6 + n, 3 + m] = -f * da[n]
                K[n, 9 + m] = -f * db[n]
                K[6 + n, 9 + m] = f * db[n]
                K[3 + n, m] = f * au[n]
                K[3 + n, 6 + m] = -f * au[n]
                K[9 + n, m] = -f * bu[n]
                K[9 + n, 6 + m] = f * bu[n]
                K[3 + n, 3 + m] = f * ka[n]
                K[3 + n, 9 + m] = -f * ab_[n]
                K[9 + n, 3 + m] = -f * ba[n]
                K[9 + n, 9 + m] = f * kb[n]
        for i in range(13):
            for j in range(13):
                A[slots[e, 13 * i + j]] += K[i, j]


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
def align_rates(R, n_point, v, where, axes, on, moving, out_rate, out_gamma):  # type: ignore[no-untyped-def]
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
        out_rate[e] = -on[e] * dot(wd, n)
        out_gamma[e] = on[e] * (dot(minus(wa, wb), dn) - dot(ad, n))


@kernel
def _motion(x, R, v, where, P, e):  # type: ignore[no-untyped-def]
    """Of the points A and B of row e: d, its rate, and the part of its second derivative without accelerations."""
    base = 3 * x.shape[0]
    pa, ra, pb, rb = where[e, 0], where[e, 1], where[e, 2], where[e, 3]
    aa = rotate(R, ra, (P[e, 0], P[e, 1], P[e, 2]))
    ab = rotate(R, rb, (P[e, 3], P[e, 4], P[e, 5]))
    wa, wb = at(v, base + 3 * ra), at(v, base + 3 * rb)
    da, db = cross(wa, aa), cross(wb, ab)
    d = minus(plus(vec(x, pa), aa), plus(vec(x, pb), ab))
    rate = minus(plus(at(v, 3 * pa), da), plus(at(v, 3 * pb), db))
    return d, rate, minus(cross(wa, da), cross(wb, db))


@kernel
def inline_rates(x, R, v, where, P, on, out_gamma):  # type: ignore[no-untyped-def]
    """The part of d2g/dt2 without accelerations."""
    for e in range(where.shape[0]):
        d, rate, rest = _motion(x, R, v, where, P, e)
        t = rotate(R, where[e, 3], (P[e, 6], P[e, 7], P[e, 8]))
        w = at(v, 3 * (x.shape[0] + where[e, 3]))
        dt = cross(w, t)
        out_gamma[e] = on[e] * (dot(cross(w, dt), d) + 2.0 * dot(dt, rate) + dot(t, rest))


@kernel
def separation_rates(x, R, v, where, P, out_gamma):  # type: ignore[no-untyped-def]
    """The part of d2g/dt2 without accelerations."""
    for e in range(where.shape[0]):
        d, rate, rest = _motion(x, R, v, where, P, e)
        out_gamma[e] = (dot(rate, rate) + dot(d, rest)) / P[e, 6]


@kernel
def align_loads(R, where, axes, mu, out):  # type: ignore[no-untyped-def]
    """out (3 n): mu (a x b), the moment that A exerts on B, world axes. where (n, 2), axes (n, 6)."""
    for e in range(where.shape[0]):
        a = rotate(R, where[e, 0], (axes[e, 0], axes[e, 1], axes[e, 2]))
        n = cross(a, rotate(R, where[e, 1], (axes[e, 3], axes[e, 4], axes[e, 5])))
        for m in range(3):
            out[3 * e + m] = mu[e] * n[m]


@kernel
def inline_loads(R, where, P, mu, out):  # type: ignore[no-untyped-def]
    """out (3 n): mu e, the force that A exerts on B, world axes."""
    for e in range(where.shape[0]):
        t = rotate(R, where[e, 3], (P[e, 6], P[e, 7], P[e, 8]))
        for m in range(3):
            out[3 * e + m] = mu[e] * t[m]


@kernel
def separation_loads(x, R, where, P, mu, out):  # type: ignore[no-untyped-def]
    """out (3 n): mu d/L, the force that A exerts on B, world axes."""
    for e in range(where.shape[0]):
        aa = rotate(R, where[e, 1], (P[e, 0], P[e, 1], P[e, 2]))
        ab = rotate(R, where[e, 3], (P[e, 3], P[e, 4], P[e, 5]))
        d = minus(plus(vec(x, where[e, 0]), aa), plus(vec(x, where[e, 2]), ab))
        for m in range(3):
            out[3 * e + m] = mu[e] * d[m] / P[e, 6]


class Kind(ABC):
    """All rows of one primitive, with the multipliers `first` to `first + n`.

    where: points and rotations of A and B of every row; numbers: what else a row knows; `own` picks this kind's
    multipliers out of all.
    """

    each: ClassVar[int] = 1  # multipliers of a row

    def __init__(self, rows: Sequence[Any], first: int) -> None:
        self.rows, self.first, self.n = tuple(rows), first, self.each * len(rows)
        self.own = slice(first, first + self.n)
        where, numbers = [self._where(g) for g in rows], [self.numbers_of(g) for g in rows]
        width = (len(where[0]), len(numbers[0])) if where else (4, 10)
        self.where = np.array(where, dtype=np.int64).reshape(len(rows), width[0])
        self.numbers = np.array(numbers, dtype=float).reshape(len(rows), width[1])
        self.on = np.ones(len(rows))
        self._K = np.zeros((0, 0))
        self._slots = np.zeros((0, 0), dtype=np.int64)

    @staticmethod
    def _where(g: Any) -> list[int]:
        return [g.a.point, g.a.rotation, g.b.point, g.b.rotation]

    @staticmethod
    @abstractmethod
    def numbers_of(g: Any) -> list[float]:
        """What a row knows besides its places."""

    def dofs(self, n_point: int, n_dof: int) -> Index:
        """Unknowns coupled by each row: x_A, turns of A, x_B, turns of B, multipliers, which start at n_dof."""
        xyz, base, w = np.arange(3), 3 * (n_point + 1), self.where
        rows = n_dof + self.first + self.each * np.arange(len(w))[:, None] + np.arange(self.each)
        table = np.concatenate([3 * w[:, :1] + xyz, base + 3 * w[:, 1:2] + xyz, 3 * w[:, 2:3] + xyz,
                                base + 3 * w[:, 3:4] + xyz, rows], axis=1)  # fmt: skip
        return np.asarray(table, dtype=np.int64)

    def bind(self, slots: Index) -> None:
        self._slots = slots
        m = math.isqrt(slots.shape[1])
        self._K = np.zeros((m, m))

    def move(self, t: float) -> None:  # noqa: B027 - most kinds drive nothing
        """Bring what is driven to time t."""


class Coincidences(Kind):
    """Rows of `Coincide`."""

    each = 3

    def __init__(self, rows: Sequence[Coincide], first: int) -> None:
        super().__init__(rows, first)
        self._moving = np.zeros((len(rows), 6))
        self.driven = [e for e, g in enumerate(rows) if g.drive is not None]

    @staticmethod
    def numbers_of(g: Coincide) -> list[float]:
        return [*g.a.arm, *g.b.arm]

    def move(self, t: float) -> None:
        for e in self.driven:
            p, v, a = self.rows[e].drive.translation(t)
            self.numbers[e, 3:] = p
            self._moving[e, :3], self._moving[e, 3:] = v, a

    def add(self, w: Any) -> None:
        coincide(w.x, w.R, w.c, self.where, self.numbers, w.lam, self.first, self._slots, self._K, w.A, w.r, w.s)

    def rates(self, w: Any, rate: Array, gamma: Array) -> None:
        coincide_rates(w.x, w.R, w.v, self.where, self.numbers, self._moving, rate, gamma)


class Alignments(Kind):
    """Rows of `Align`; they know rotations only."""

    def __init__(self, rows: Sequence[Align], first: int) -> None:
        super().__init__(rows, first)
        self._drawn = self.numbers[:, 3:].copy()
        self._turning = np.zeros((len(rows), 6))
        self.driven = [e for e, g in enumerate(rows) if g.drive is not None]

    @staticmethod
    def _where(g: Align) -> list[int]:
        return [g.a, g.b]

    @staticmethod
    def numbers_of(g: Align) -> list[float]:
        return [*g.axis_a, *g.axis_b]

    def dofs(self, n_point: int, n_dof: int) -> Index:
        xyz, base, w = np.arange(3), 3 * (n_point + 1), self.where
        rows = n_dof + self.first + np.arange(len(w))[:, None]
        table = np.concatenate([base + 3 * w[:, :1] + xyz, base + 3 * w[:, 1:2] + xyz, rows], axis=1)
        return np.asarray(table, dtype=np.int64)

    def move(self, t: float) -> None:
        for e in self.driven:
            R, w, alpha = self.rows[e].drive.rotation(t)
            self.numbers[e, 3:] = R @ self._drawn[e]
            self._turning[e, :3], self._turning[e, 3:] = w, alpha

    def add(self, w: Any) -> None:
        align(w.R, len(w.x), w.c, self.where, self.numbers, self.on, w.lam, self.first, self._slots, self._K, w.A,
              w.r, w.s)  # fmt: skip

    def rates(self, w: Any, rate: Array, gamma: Array) -> None:
        align_rates(w.R, len(w.x), w.v, self.where, self.numbers, self.on, self._turning, rate, gamma)

    def loads(self, w: Any, out: Array) -> None:
        """Moments that A exerts on B, three numbers a row, world axes."""
        align_loads(w.R, self.where, self.numbers, w.lam[self.own], out)


class Inlines(Kind):
    """Rows of `Inline`."""

    @staticmethod
    def numbers_of(g: Inline) -> list[float]:
        return [*g.a.arm, *g.b.arm, *g.axis, g.offset]

    def add(self, w: Any) -> None:
        inline(w.x, w.R, w.c, self.where, self.numbers, self.on, w.lam, self.first, self._slots, self._K, w.A, w.r,
               w.s)  # fmt: skip

    def rates(self, w: Any, rate: Array, gamma: Array) -> None:
        inline_rates(w.x, w.R, w.v, self.where, self.numbers, self.on, gamma)

    def loads(self, w: Any, out: Array) -> None:
        """Forces that A exerts on B, three numbers a row, world axes."""
        inline_loads(w.R, self.where, self.numbers, w.lam[self.own], out)


class Separations(Kind):
    """Rows of `Separation`."""

    @staticmethod
    def numbers_of(g: Separation) -> list[float]:
        return [*g.a.arm, *g.b.arm, g.length]

    def add(self, w: Any) -> None:
        separation(w.x, w.R, w.c, self.where, self.numbers, w.lam, self.first, self._slots, self._K, w.A, w.r, w.s)

    def rates(self, w: Any, rate: Array, gamma: Array) -> None:
        separation_rates(w.x, w.R, w.v, self.where, self.numbers, gamma)

    def loads(self, w: Any, out: Array) -> None:
        """Forces that A exerts on B, three numbers a row, world axes."""
        separation_loads(w.x, w.R, self.where, self.numbers, w.lam[self.own], out)


class JointRows(NamedTuple):
    """Which rows of each primitive belong to a joint."""

    points: list[int]
    axes: list[int]
    planes: list[int]
    lengths: list[int]

    @property
    def n(self) -> int:
        """How many multipliers."""
        return 3 * len(self.points) + len(self.axes) + len(self.planes) + len(self.lengths)


class Constraints:
    """All rows of all joints: multipliers in the order of the primitives, `points`, `axes`, `planes`, `lengths`.

    Filled by `append`, then `close`d.
    """

    TYPES: ClassVar[tuple[type, ...]] = (Coincide, Align, Inline, Separation)

    def __init__(self) -> None:
        self._rows: tuple[list[Any], ...] = ([], [], [], [])
        self._names: tuple[list[str], ...] = ([], [], [], [])

    def append(self, name: str, rows: Sequence[Row]) -> JointRows:
        """Take in the rows of the joint `name`; which they are."""
        mine = JointRows([], [], [], [])
        for row in rows:
            k = self.TYPES.index(type(row))
            mine[k].append(len(self._rows[k]))
            self._rows[k].append(row)
            self._names[k].append(name)
        return mine

    def close(self) -> None:
        """Number the multipliers."""
        first = np.cumsum([0, *(kind.each * len(rows) for kind, rows in zip(_KINDS, self._rows, strict=True))])
        self.coincide = Coincidences(self._rows[0], 0)
        self.align = Alignments(self._rows[1], int(first[1]))
        self.inline = Inlines(self._rows[2], int(first[2]))
        self.separation = Separations(self._rows[3], int(first[3]))
        self.points, self.axes = self.coincide.rows, self.align.rows
        self.n = int(first[4])
        kinds = (self.coincide, self.align, self.inline, self.separation)
        self.names = [name for kind, names in zip(kinds, self._names, strict=True) for name in names
                      for _ in range(kind.each)]  # fmt: skip
        self.kinds = tuple(kind for kind in kinds if kind.n)

    def move(self, t: float) -> None:
        """Bring driven points and axes to time t."""
        for kind in self.kinds:
            kind.move(t)

    @property
    def driven(self) -> bool:
        return bool(self.coincide.driven or self.align.driven)

    @property
    def arms(self) -> Array:
        """Arms and offsets [m] of all rows, for the size of the model."""
        own = [self.coincide.numbers, self.inline.numbers[:, :6], self.separation.numbers[:, :6]]
        return np.concatenate([a.ravel() for a in own] + [np.abs(self.inline.numbers[:, 9:]).ravel()])

    def dofs(self, n_point: int, n_dof: int) -> list[Index]:
        """Unknowns coupled by each row; n_dof: where multipliers start."""
        return [kind.dofs(n_point, n_dof) for kind in self.kinds]

    def bind(self, slots: list[Index]) -> None:
        for kind, own in zip(self.kinds, slots, strict=True):
            kind.bind(own)

    def add(self, w: Any) -> None:
        for kind in self.kinds:
            kind.add(w)

    def rates(self, w: Any) -> tuple[Array, Array]:
        """(dg/dt at fixed q, d2g/dt2 without the system's accelerations), each (n,)."""
        rate, gamma = np.zeros(self.n), np.zeros(self.n)
        for kind in self.kinds:
            kind.rates(w, rate[kind.own], gamma[kind.own])
        return rate, gamma

    def loads(self, w: Any, out: Array) -> None:
        """out (3 each): moments of `axes`, forces of `planes`, then of `lengths`: what A exerts on B, world axes."""
        first = 0
        for kind in (self.align, self.inline, self.separation):
            if kind.n:
                kind.loads(w, out[first : first + 3 * kind.n])
            first += 3 * kind.n


_KINDS: tuple[type[Kind], ...] = (Coincidences, Alignments, Inlines, Separations)
