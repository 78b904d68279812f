"""Coordinates of joints and between points: scalars s(q) that outputs, springs, dampers and locks refer to.

    Slide      s = (R_B e) . (p_A - p_B)                        displacement of A along an axis of B
    Turn       s = angle of A about an axis of B, from n_B to n_A, both normal to the axis when the joint is closed
    Distance   s = |p_B - p_A|

With J = ds/dq for the twelve unknowns (point and rotation of A, of B; spatial turns) and V their velocities, the rate
is J V, and a generalised force F(s, ds/dt) loads the system with J^T F: its power is F ds/dt whatever the joint does
(virtual work). Hence a slide pushes A at its point and B along the same line, and a closed turn puts a pure moment
about its axis on A and the opposite on B. With H = dJ/dq the tangents of the residual -J^T F are exact:

    K = -[J^T (F_s J + F_v V^T H) + F H],        C = -F_v J^T J

A turn is the angle atan2(n_A . (e x n_B), n_A . n_B), continued from the last accepted step, so that turns count.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from floatsim.frames import Array, at, cross, dot, minus, plus, rotate, set_matrix, times, unit, vec
from floatsim.jit import kernel
from floatsim.joints.constraints import Place
from floatsim.parts.part import Output, Part

Index = NDArray[np.int64]

SLIDE, TURN, DISTANCE = range(3)
ZERO = (0.0, 0.0, 0.0)


class Slide(NamedTuple):
    """Displacement of point A along `axis`, which is fixed in B (B's frame, unit length)."""

    a: Place
    b: Place
    axis: tuple[float, float, float]


class Turn(NamedTuple):
    """Angle of A about `axis` of B: from `normal_b` (B's frame) to `normal_a` (A's frame), right-handed about axis."""

    a: Place
    b: Place
    axis: tuple[float, float, float]
    normal_a: tuple[float, float, float]
    normal_b: tuple[float, float, float]


class Distance(NamedTuple):
    """Distance between the points A and B."""

    a: Place
    b: Place


@kernel
def _frame(x, R, kind, where, G, e):  # type: ignore[no-untyped-def]
    """(arm of A, arm of B, d, unit vector or first row, n_a, p) of coordinate e, world axes.

    Slide: d = p_A - p_B and the axis; distance: d = p_B - p_A and its direction; turn: axis, n_a = R_A n_A, and n_b in
    place of d, m = e x n_b in place of p.
    """
    ra, rb = where[e, 1], where[e, 3]
    if kind[e] == TURN:
        axis, nb = rotate(R, rb, vec(G, 5 * e + 2)), rotate(R, rb, vec(G, 5 * e + 4))
        return ZERO, ZERO, nb, axis, rotate(R, ra, vec(G, 5 * e + 3)), cross(axis, nb)
    aa, ab = rotate(R, ra, vec(G, 5 * e)), rotate(R, rb, vec(G, 5 * e + 1))
    d = minus(plus(vec(x, where[e, 0]), aa), plus(vec(x, where[e, 2]), ab))
    if kind[e] == SLIDE:
        return aa, ab, d, rotate(R, rb, vec(G, 5 * e + 2)), ZERO, ZERO
    d = times(-1.0, d)
    l = math.sqrt(dot(d, d))
    return aa, ab, d, times(1.0 / l if l > 0.0 else 0.0, d), ZERO, ZERO


@kernel
def _row(kind, aa, ab, d, t, na, m):  # type: ignore[no-untyped-def]
    """J as four 3-tuples: point and rotation of A, of B; arguments as `_frame` gives them."""
    if kind == TURN:
        X, Y = dot(na, d), dot(na, m)
        g = times(1.0 / (X * X + Y * Y), cross(na, minus(times(X, m), times(Y, d))))
        return ZERO, g, ZERO, times(-1.0, g)
    if kind == SLIDE:
        return t, cross(aa, t), times(-1.0, t), times(-1.0, cross(plus(ab, d), t))
    return times(-1.0, t), times(-1.0, cross(aa, t)), t, cross(ab, t)


@kernel
def _row_change(kind, aa, ab, d, t, na, m, block, u):  # type: ignore[no-untyped-def]
    """Change of J under the unit change u of one of the four blocks of unknowns."""
    if kind == TURN:
        if block == 0 or block == 2:
            return ZERO, ZERO, ZERO, ZERO
        X, Y = dot(na, d), dot(na, m)
        D, p = X * X + Y * Y, minus(times(X, m), times(Y, d))
        dX, dY, dna = dot(u, cross(na, d)), dot(u, cross(na, m)), cross(u, na)
        dp = minus(times(dX, m), times(dY, d))
        if block == 3:
            dp = plus(times(-1.0, dp), minus(times(X, cross(u, m)), times(Y, cross(u, d))))
            dX, dY, dna = -dX, -dY, ZERO
        part = plus(cross(dna, p), cross(na, dp))
        g = times(1.0 / D, minus(part, times(2.0 * (X * dX + Y * dY) / D, cross(na, p))))
        return ZERO, g, ZERO, times(-1.0, g)
    da = cross(u, aa) if block == 1 else ZERO
    db = cross(u, ab) if block == 3 else ZERO
    dd = u if block == 0 else (da if block == 1 else times(-1.0, u if block == 2 else db))  # of p_A - p_B
    if kind == SLIDE:
        dt = cross(u, t) if block == 3 else ZERO
        c, dc = plus(ab, d), plus(db, dd)
        return (dt, plus(cross(da, t), cross(aa, dt)), times(-1.0, dt),
                times(-1.0, plus(cross(dc, t), cross(c, dt))))  # fmt: skip
    dd = times(-1.0, dd)
    l = math.sqrt(dot(d, d))
    dt = times(1.0 / l if l > 0.0 else 0.0, minus(dd, times(dot(t, dd), t)))
    return (times(-1.0, dt), times(-1.0, plus(cross(da, t), cross(aa, dt))), dt,
            plus(cross(db, t), cross(ab, dt)))  # fmt: skip


@kernel
def _work(row, v, where, e, base):  # type: ignore[no-untyped-def]
    """J V."""
    first = dot(row[0], at(v, 3 * where[e, 0])) + dot(row[1], at(v, base + 3 * where[e, 1]))
    return first + dot(row[2], at(v, 3 * where[e, 2])) + dot(row[3], at(v, base + 3 * where[e, 3]))


@kernel
def measure(x, R, v, kind, where, G, last, s, rate):  # type: ignore[no-untyped-def]
    """s, rate (n) of every coordinate. where (n, 4): point and rotation of A, of B; G (5 n, 3): arm of A and of B,
    axis, normal on A, normal on B; last (n): angles the turns are continued from."""
    base = 3 * x.shape[0]
    for e in range(where.shape[0]):
        aa, ab, d, t, na, m = _frame(x, R, kind, where, G, e)
        if kind[e] == TURN:
            angle = math.atan2(dot(na, m), dot(na, d))
            s[e] = angle + 2.0 * math.pi * math.floor((last[e] - angle) / (2.0 * math.pi) + 0.5)
        else:
            s[e] = dot(t, d)
        rate[e] = _work(_row(kind[e], aa, ab, d, t, na, m), v, where, e, base)


@kernel
def push(x, R, v, c, kind, where, G, F, slots, A, r, s):  # type: ignore[no-untyped-def]
    """Load the system with J^T F. F (3, n): generalised force, its derivatives by s and by ds/dt; slots (n, 144)."""
    base = 3 * x.shape[0]
    for e in range(where.shape[0]):
        f, fs, fv = F[0, e], F[1, e], F[2, e]
        if f == 0.0 and fs == 0.0 and fv == 0.0:
            continue
        aa, ab, d, t, na, m = _frame(x, R, kind, where, G, e)
        J = _row(kind[e], aa, ab, d, t, na, m)
        dofs = (3 * where[e, 0], base + 3 * where[e, 1], 3 * where[e, 2], base + 3 * where[e, 3])
        for p in range(4):
            size = abs(f) * math.sqrt(dot(J[p], J[p]))
            s[dofs[p] // 3] += size
            for i in range(3):
                r[dofs[p] + i] -= f * J[p][i]
        for q in range(4):
            for j in range(3):
                H = _row_change(kind[e], aa, ab, d, t, na, m, q, unit(j))
                by_rate = c[2] * fv * _work(H, v, where, e, base) + (c[2] * fs + c[1] * fv) * J[q][j]
                for p in range(4):
                    for i in range(3):
                        A[slots[e, 12 * (3 * p + i) + 3 * q + j]] -= J[p][i] * by_rate + c[2] * f * H[p][i]


class Coordinates:
    """A table of coordinates of any kinds. s, rate (n): as last measured; last (n): angles turns are continued from."""

    def __init__(self, items: Sequence[Slide | Turn | Distance]) -> None:
        n = len(items)
        kinds = {Slide: SLIDE, Turn: TURN, Distance: DISTANCE}
        self.kind = np.array([kinds[type(item)] for item in items], dtype=np.int64)
        self.where = np.array(
            [[item.a.point, item.a.rotation, item.b.point, item.b.rotation] for item in items], dtype=np.int64
        ).reshape(n, 4)
        rows: list[Any] = []
        for item in items:
            more = [item.axis] if isinstance(item, Slide | Turn) else [ZERO]
            more += [item.normal_a, item.normal_b] if isinstance(item, Turn) else [ZERO, ZERO]
            rows += [item.a.arm, item.b.arm, *more]
        self.G = np.array(rows, dtype=float).reshape(5 * n, 3)
        self.turning = self.kind == TURN
        self.s, self.rate, self.last = np.zeros(n), np.zeros(n), np.zeros(n)

    def move(self, x: Array, R: Array, v: Array) -> None:
        """Measure s and rate at positions x, attitudes R and velocities v."""
        measure(x, R, v, self.kind, self.where, self.G, self.last, self.s, self.rate)

    def at(self, x: Array, R: Array, near: Array | None = None) -> Array:
        """The coordinates (n,) at rest in another configuration, turns within pi of `near` (default 0)."""
        s = np.zeros(len(self.s))
        last = s.copy() if near is None else near
        measure(x, R, np.zeros(3 * (len(x) + len(R))), self.kind, self.where, self.G, last, s, s.copy())
        return s

    def of_state(self, state: Any, near: Array | None = None) -> Array:
        """The coordinates (n,) of a state."""
        R = np.zeros((len(state.q), 3, 3))
        for k, q in enumerate(state.q):
            set_matrix(R, k, tuple(q))
        return self.at(state.x, R, near)

    def dofs(self, n_point: int) -> Index:
        """Unknowns of every coordinate (n, 12)."""
        xyz, base, w = np.arange(3), 3 * (n_point + 1), self.where
        return np.concatenate([3 * w[:, :1] + xyz, base + 3 * w[:, 1:2] + xyz,
                               3 * w[:, 2:3] + xyz, base + 3 * w[:, 3:4] + xyz], axis=1)  # fmt: skip


class JointCoordinates(Part):
    """The coordinates of joint `joint` as outputs; comes with the joint (its `children()`)."""

    name: str
    joint: str

    @staticmethod
    def batch() -> type[JointCoordinatesBatch]:
        return JointCoordinatesBatch


class JointCoordinatesBatch:
    """Displacements and angles of all joints, and their rates. Its memory: the angles of the last accepted step."""

    runs: ClassVar[list[tuple[int, int]]] = []
    remembers: ClassVar[bool] = False

    def __init__(self, parts: Sequence[JointCoordinates], first_point: Sequence[int], first_rotation: Sequence[int],
                 sea: Any, gravity: float) -> None:  # fmt: skip
        self.parts = tuple(parts)

    def connect(self, numbering: Any) -> None:
        """Ask the joints."""
        found = {part.joint: numbering.coordinates(part.joint) for part in self.parts}
        self._names = [(joint, own) for joint, there in found.items() for own in there]
        self.table = Coordinates([item for there in found.values() for item in there.values()])

    def dofs(self, n_point: int) -> list[Index]:
        return []

    def bind(self, slots: list[Index]) -> None:
        """It loads nothing."""

    def outputs(self) -> list[Output]:
        """Position and speed of every coordinate."""
        out = []
        for (joint, own), turns in zip(self._names, self.table.turning, strict=True):
            what, rate, unit = ("angle", "rate", "rad") if turns else ("displacement", "speed", "m")
            # "slide" of a joint says no more than "displacement" does
            end = "" if own in ("", "slide", "turn") else f"_{own}"
            of = f"of joint {joint}" + (f", {own}" if end else "")
            out.append(Output(f"{joint}_{what}{end}", f"{what} {of}", unit))
            out.append(Output(f"{joint}_{rate}{end}", f"{rate} {of}", f"{unit}/s"))
        return out

    def start(self, state: Any) -> Array:
        """Angles of a state, within half a turn."""
        return self.table.of_state(state)

    def keep(self, state: Any, before: Array, after: Array) -> None:
        """Turns already made still count."""
        after[:] = self.table.of_state(state, before)

    def begin(self, w: Any, history: Array, t: float, state: Any) -> None:
        self.table.last[:] = history

    def add(self, w: Any) -> None:
        """It loads nothing."""

    def ledger(self, w: Any, book: Any) -> None:
        """It has no energy."""

    def commit(self, history: Array, w: Any) -> None:
        self.table.move(w.x, w.R, w.v)
        history[:] = self.table.s
        self.table.last[:] = history

    def measure(self, w: Any, out: Array) -> None:
        """Of the state in w."""
        self.table.move(w.x, w.R, w.v)
        out[0::2], out[1::2] = self.table.s, self.table.rate
