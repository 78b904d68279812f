"""The bending at a clamped line end: the angle between a direction fixed in a body and the first element.

The angle is spread over *half* an element, k = EI/(l0/2). Spreading it over a full element is only
first order: 15 % too soft for a 10 m cantilever of 1 m elements. Formulas: parts/bending.py, `bend`, with
the fixed direction in place of element a, d_a = R e, which turns with the body.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from floatsim.description import Vector3
from floatsim.errors import ModelError
from floatsim.frames import Array, at, cross, dot, minus, plus, rotate, times, unit, vec
from floatsim.jit import kernel
from floatsim.laws.angle import half_angle_squared
from floatsim.laws.moment_table import pad_tables, pair_table
from floatsim.parts.bending import bend, blocks, pair_powers, table_slopes
from floatsim.parts.line import Line
from floatsim.parts.part import Part

Index = NDArray[np.int64]


class EndBending(Part):
    """Bending at line end `end` against `direction` (pointing into the line) in the frame of `to`."""

    name: str
    end: str
    to: str | Vector3
    direction: Vector3

    @staticmethod
    def batch() -> type[EndBendingBatch]:
        return EndBendingBatch


@kernel
def end_bending(x, R, v, c, where, E, tables, slots, Kb, Cb, K, A, r, s, moment):  # type: ignore[no-untyped-def]
    """where (n, 4): rotation, end point, next point, row of the moment tables or -1; E (n, 5): k, damping, direction.
    moment (n, 3): on the body."""
    base = 3 * x.shape[0]
    zero = (0.0, 0.0, 0.0)
    for e in range(where.shape[0]):
        if E[e, 0] == 0.0 and E[e, 1] == 0.0:  # the line has parted there
            moment[e, 0] = moment[e, 1] = moment[e, 2] = 0.0
            continue
        k, p0, p1 = where[e, 0], where[e, 1], where[e, 2]
        da = rotate(R, k, (E[e, 2], E[e, 3], E[e, 4]))
        w = at(v, base + 3 * k)
        va = cross(w, da)
        vb = minus(at(v, 3 * p1), at(v, 3 * p0))
        db = minus(vec(x, p1), vec(x, p0))
        ib = 1.0 / math.sqrt(dot(db, db))
        tb = times(ib, db)
        co = dot(da, tb)
        sx = cross(da, tb)
        y = dot(sx, sx)
        h1, h2 = half_angle_squared(co, y)
        h1, h2 = E[e, 0] * h1, E[e, 0] * h2
        if where[e, 3] >= 0:
            h1, h2 = table_slopes(tables, where[e, 3], co, y)
        h, ga, gb, z, ha, hb = bend(h1, h2, E[e, 1], co, da, 1.0, tb, ib, va, vb, c[2], c[1])
        _, _, _, zr, _, _ = bend(0.0, 0.0, E[e, 1], co, da, 1.0, tb, ib, va, vb, 0.0, 1.0)  # by the rates alone
        for i in range(3):
            for n in range(3):
                Kb[i, n], Kb[i, n + 3], Kb[i + 3, n], Kb[i + 3, n + 3] = blocks(i, n, z, da, tb, ga, gb, ha, hb)
                Cb[i, n], _, Cb[i + 3, n], _ = blocks(i, n, zr, da, tb, ga, gb, zero, zero)
        fa, fb = times(h, ga), times(h, gb)
        m = cross(da, fa)
        for i in range(3):
            r[base + 3 * k + i] += m[i]
            r[3 * p0 + i] -= fb[i]
            r[3 * p1 + i] += fb[i]
            s[x.shape[0] + k] += abs(m[i])
            s[p0] += abs(fb[i])
            s[p1] += abs(fb[i])
            moment[e, i] = -m[i]
        if c[6] == 0.0:
            continue
        for block in range(3):
            for n in range(3):
                u = unit(n)
                # change of (d_a, d_b) and of their rates; of d_a' = w x d_a under a turn: w x (u x d_a)
                dda, ddb, dva = zero, zero, zero
                if block == 0:
                    dda = cross(u, da)
                    dva = times(c[2], cross(w, dda)) if E[e, 1] > 0.0 else zero
                elif block == 1:
                    ddb = times(-1.0, u)
                else:
                    ddb = u
                dfa, dfb = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
                g = _apply(Kb, Cb, dda, ddb, dva)
                dfa, dfb = (g[0], g[1], g[2]), (g[3], g[4], g[5])
                dm = plus(cross(da, dfa), times(c[2], cross(dda, fa)))
                for i in range(3):
                    K[i, 3 * block + n] = dm[i]
                    K[3 + i, 3 * block + n] = -dfb[i]
                    K[6 + i, 3 * block + n] = dfb[i]
        for p in range(9):
            for q in range(9):
                A[slots[e, 9 * p + q]] += K[p, q]


@kernel
def _apply(Kb, Cb, dda, ddb, dva):  # type: ignore[no-untyped-def]
    """Kb (dd_a, dd_b) + Cb (dv_a, 0): change of the gradient by (d_a, d_b)."""
    y0 = y1 = y2 = y3 = y4 = y5 = 0.0
    for j in range(3):
        a, b, v = dda[j], ddb[j], dva[j]
        y0 += Kb[0, j] * a + Kb[0, 3 + j] * b + Cb[0, j] * v
        y1 += Kb[1, j] * a + Kb[1, 3 + j] * b + Cb[1, j] * v
        y2 += Kb[2, j] * a + Kb[2, 3 + j] * b + Cb[2, j] * v
        y3 += Kb[3, j] * a + Kb[3, 3 + j] * b + Cb[3, j] * v
        y4 += Kb[4, j] * a + Kb[4, 3 + j] * b + Cb[4, j] * v
        y5 += Kb[5, j] * a + Kb[5, 3 + j] * b + Cb[5, j] * v
    return (y0, y1, y2, y3, y4, y5)


@kernel
def end_powers(x, R, v, where, E, tables, out):  # type: ignore[no-untyped-def]
    """out: energy of all clamped ends, its rate, power of the dampers."""
    out[0] = out[1] = out[2] = 0.0
    for e in range(where.shape[0]):
        if E[e, 0] == 0.0 and E[e, 1] == 0.0:
            continue
        k, p0, p1 = where[e, 0], where[e, 1], where[e, 2]
        ta = rotate(R, k, (E[e, 2], E[e, 3], E[e, 4]))
        va = cross(at(v, 3 * (x.shape[0] + k)), ta)
        db, vb = minus(vec(x, p1), vec(x, p0)), minus(at(v, 3 * p1), at(v, 3 * p0))
        ib = 1.0 / math.sqrt(dot(db, db))
        U, rate, P = pair_powers(E[e, 0], E[e, 1], tables, where[e, 3], ta, 1.0, times(ib, db), ib, va, vb)
        out[0] += U
        out[1] += rate
        out[2] += P


class EndBendingBatch:
    """All clamped line ends of a system."""

    runs: ClassVar[list[tuple[int, int]]] = []
    remembers: ClassVar[bool] = True

    def __init__(self, parts: Sequence[EndBending], first_point: Sequence[int], first_rotation: Sequence[int],
                 sea: Any, gravity: float) -> None:  # fmt: skip
        self.parts = tuple(parts)
        self.moment = np.zeros((len(self.parts), 3))
        self._Kb, self._Cb, self._K = np.zeros((6, 6)), np.zeros((6, 6)), np.zeros((9, 9))

    def connect(self, numbering: Any) -> None:
        """Resolve the line ends; ModelError if an end is not a line's, its section has no EI or `to` no rotation."""
        where, E = [], []
        tables: list[Array] = []
        for part in self.parts:
            line, first = numbering.part(part.end)
            if not isinstance(line, Line):
                raise ModelError(f"Clamp '{part.name}': '{part.end}' is not the end of a line")
            n, at_a = line.n_points, part.end.endswith("end_a")
            element = 0 if at_a else line.elements - 1
            section, l0 = line.element_sections[element], line.element_lengths[element]
            EI = line.half_stiffness[element, 0 if at_a else 1]
            if EI == 0.0:
                raise ModelError(
                    f"Clamp '{part.name}': section '{section.name}' of line '{line.name}' has EI = 0; "
                    "a clamped end needs bending stiffness, use Ball for a hinged one"
                )
            p0, p1 = (first, first + 1) if at_a else (first + n - 1, first + n - 2)
            frame = numbering.place(part.to)
            if isinstance(part.to, str) and frame.rotation == numbering.place((0.0, 0.0, 0.0)).rotation:
                raise ModelError(
                    f"Clamp '{part.name}': '{part.to}' has no rotation that could hold a direction; clamp to a body's "
                    "connection point or to a fixed point (x, y, z), or use Ball"
                )
            row = -1
            if section.bending_law is not None:  # the direction is rigid: half an element bends
                row = len(tables)
                law = section.bending_law
                tables.append(pair_table((l0, 0.0), (law, law)))
            where.append((frame.rotation, p0, p1, row))
            e = np.asarray(part.direction) / np.linalg.norm(part.direction)
            E.append((EI / (0.5 * l0), section.bending_damping / (0.5 * l0), *e))
        self.where = np.array(where, dtype=np.int64)
        self.E = np.array(E, dtype=float)
        self._whole = self.E[:, :2].copy()
        self._may_part = any(numbering.part(part.end)[0].breaks for part in self.parts)
        self.tables = pad_tables(tables)

    def dofs(self, n_point: int) -> list[Index]:
        xyz, base, w = np.arange(3), 3 * (n_point + 1), self.where
        return [np.concatenate([base + 3 * w[:, :1] + xyz, 3 * w[:, 1:2] + xyz, 3 * w[:, 2:3] + xyz], axis=1)]

    def bind(self, slots: list[Index]) -> None:
        (self._slots,) = slots

    def add(self, w: Any) -> None:
        if self._may_part:
            self.E[:, :2] = np.where(w.cut[self.where[:, 1], None], 0.0, self._whole)
        end_bending(w.x, w.R, w.v, w.c, self.where, self.E, self.tables, self._slots, self._Kb,
                    self._Cb, self._K, w.A, w.r, w.s, self.moment)  # fmt: skip

    def ledger(self, w: Any, book: Any) -> None:
        """Energy of the bent ends and work of their dampers."""
        y = np.zeros(3)
        end_powers(w.x, w.R, w.v, self.where, self.E, self.tables, y)
        book.store("bending", y[0], y[1])
        book.work("structural", y[2])
