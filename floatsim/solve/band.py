"""LU of a band of half-bandwidth 8, eight numbers at a time.

A line's nodes couple to two neighbours on either side at most, so that eight columns left and right of the
diagonal hold every chain and fit one 512-bit register (two or four smaller ones on other processors). Scalar loops
are not recognised as such by the compiler; these few routines are therefore written in its intermediate language.

Row i of the band is stored as (i, i - 8) ... (i, i + 8). With D the pivots and U of unit diagonal,

    B = L U,  L_ii = D_i,   row i:  w = B_i;  for p = i - 8 ... i - 1:  w -= w_p U_p;   U_i = w / w_i

(Crout's variant, Golub & Van Loan, Matrix Computations, 4th ed., 3.2 and 4.3.) The multipliers w_p are L's row.
A factor's row is [ L: i - 8 ... i - 1 | U: i + 1 ... i + 8 ]; 1 / D_i is kept apart. Eight zero rows stand before
every factor and every block of columns, so that the first rows need no case of their own.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import extending
from numba.core import cgutils, types
from numba.np.arrayobj import make_array

intrinsic: Any = extending.intrinsic  # numba's own annotation counts the typing context as an argument of the caller

B = 8  # half-bandwidth
STRIDE = 2 * B + 1  # of the band's rows
ROW = 2 * B  # of the factor's rows

_DOUBLE, _I64, _I32 = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
_VECTOR = ir.VectorType(_DOUBLE, B)
_ZERO = ir.Constant(_VECTOR, [0.0] * B)


class _Emitter:
    """The few operations needed, on a builder."""

    def __init__(self, context: Any, builder: Any, signature: Any, args: Any) -> None:
        self.builder = builder
        self.args = [
            make_array(t)(context, builder, a).data if isinstance(t, types.Array) else a
            for t, a in zip(signature.args, args, strict=True)
        ]

    def add(self, *terms: Any) -> Any:
        total = None
        for t in terms:
            value = ir.Constant(_I64, t) if isinstance(t, int) else t
            total = value if total is None else self.builder.add(total, value)
        return total

    def times(self, i: Any, k: int) -> Any:
        return self.builder.mul(i, ir.Constant(_I64, k))

    def at(self, array: Any, i: Any, vector: bool = False) -> Any:
        pointer = self.builder.gep(array, [i])
        return self.builder.bitcast(pointer, _VECTOR.as_pointer()) if vector else pointer

    def load(self, array: Any, i: Any) -> Any:
        value = self.builder.load(self.at(array, i, True))
        value.align = 8
        return value

    def store(self, value: Any, array: Any, i: Any) -> None:
        self.builder.store(value, self.at(array, i, True)).align = 8

    def scalar(self, array: Any, i: Any) -> Any:
        return self.builder.load(self.at(array, i))

    def splat(self, x: Any) -> Any:
        one = self.builder.insert_element(ir.Constant(_VECTOR, ir.Undefined), x, ir.Constant(_I32, 0))
        return self.builder.shuffle_vector(one, _ZERO, ir.Constant(ir.VectorType(_I32, B), [0] * B))

    def lanes(self, a: Any, b: Any, first: int) -> Any:
        """Eight lanes of the sixteen of a and b, from `first` on."""
        mask = ir.Constant(ir.VectorType(_I32, B), list(range(first, first + B)))
        return self.builder.shuffle_vector(a, b, mask)

    def lane(self, a: Any, k: int) -> Any:
        return self.builder.extract_element(a, ir.Constant(_I32, k))

    def minus(self, w: Any, a: Any, b: Any) -> Any:
        """w - a b, fused where the processor can."""
        name, kind = ("llvm.fmuladd.v8f64", _VECTOR) if w.type == _VECTOR else ("llvm.fmuladd.f64", _DOUBLE)
        signature = ir.FunctionType(kind, [kind] * 3)
        function = cgutils.get_or_insert_function(self.builder.module, signature, name)
        return self.builder.call(function, [self.builder.fneg(a), b, w])

    def variables(self, kind: Any, count: int) -> list[Any]:
        out = []
        for _ in range(count):
            place = cgutils.alloca_once(self.builder, kind)
            self.builder.store(ir.Constant(kind, [0.0] * B) if kind == _VECTOR else ir.Constant(kind, 0.0), place)
            out.append(place)
        return out

    def get(self, places: list[Any]) -> list[Any]:
        return [self.builder.load(p) for p in places]

    def push(self, places: list[Any], old: list[Any], new: Any) -> None:
        """Move every variable down by one and put `new` last."""
        for place, value in zip(places, [*old[1:], new], strict=True):
            self.builder.store(value, place)


def _typed(emit: Callable[[_Emitter], Any], result: Any, *given: Any) -> Any:
    """Signature (arrays of float64 and integers) and body of an intrinsic."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        value = emit(_Emitter(context, builder, signature, args))
        return context.get_dummy_value() if value is None else value

    return result(*[a if isinstance(a, types.Array) else types.int64 for a in given]), codegen


@intrinsic
def factor(typing, A, o, n, W, w, V, v, limit):  # type: ignore[no-untyped-def]
    """LU of the band at A[o] into W[w] and 1/D into V[v]. Returns whether all of U is below `limit`.

    U is the row over its pivot, so that large entries tell a vanishing pivot.
    """

    def emit(e: _Emitter) -> Any:
        A, o, n, W, w, V, v, limit = e.args
        b = e.builder
        rows = e.variables(_VECTOR, B)
        (bad,) = e.variables(_VECTOR, 1)
        highest, one = e.splat(b.sitofp(limit, _DOUBLE)), ir.Constant(_VECTOR, [1.0] * B)
        absolute = cgutils.get_or_insert_function(b.module, ir.FunctionType(_VECTOR, [_VECTOR]), "llvm.fabs.v8f64")
        with cgutils.for_range(b, n) as loop:
            i = loop.index
            at = e.add(o, e.times(i, STRIDE))
            low, high = e.load(A, at), e.load(A, e.add(at, B))
            last = b.insert_element(_ZERO, e.scalar(A, e.add(at, 2 * B)), ir.Constant(_I32, 0))
            U = e.get(rows)
            for k in range(B):
                m = e.splat(e.lane(low, k))
                if k < B - 1:
                    low = e.minus(low, m, e.lanes(_ZERO, U[k], B - 1 - k))
                high = e.minus(high, m, e.lanes(U[k], _ZERO, B - 1 - k))
            inverse = b.fdiv(ir.Constant(_DOUBLE, 1.0), e.lane(high, 0))
            new = b.fmul(e.lanes(high, last, 1), e.splat(inverse))
            too_large = b.fcmp_unordered(">", b.call(absolute, [new]), highest)
            b.store(b.select(too_large, one, b.load(bad)), bad)
            e.push(rows, U, new)
            to = e.add(w, e.times(i, ROW))
            e.store(low, W, to)
            e.store(new, W, e.add(to, B))
            b.store(inverse, e.at(V, e.add(v, i)))
        flags = b.load(bad)
        total = e.lane(flags, 0)
        for k in range(1, B):
            total = b.fadd(total, e.lane(flags, k))
        return b.fcmp_ordered("==", total, ir.Constant(_DOUBLE, 0.0))

    return _typed(emit, types.boolean, A, o, n, W, w, V, v, limit)


@intrinsic
def spread(typing, R, r, E, e, n):  # type: ignore[no-untyped-def]
    """n rows of eight columns at E[e]: zeros, and R[r:] in the last."""

    def emit(m: _Emitter) -> None:
        R, r, E, e, n = m.args
        with cgutils.for_range(m.builder, n) as loop:
            value = m.scalar(R, m.add(r, loop.index))
            row = m.builder.insert_element(_ZERO, value, ir.Constant(_I32, B - 1))
            m.store(row, E, m.add(e, m.times(loop.index, B)))

    return _typed(emit, types.void, R, r, E, e, n)


@intrinsic
def forward(typing, W, w, V, v, E, e, first, n):  # type: ignore[no-untyped-def]
    """E = L^-1 E in place for eight columns at E[e], whose rows before `first` are zero."""

    def emit(m: _Emitter) -> None:
        W, w, V, v, E, e, first, n = m.args
        b = m.builder
        before = m.variables(_VECTOR, B)
        with cgutils.for_range_slice(b, first, n, ir.Constant(_I64, 1), intp=_I64) as (i, _):
            at, to = m.add(w, m.times(i, ROW)), m.add(e, m.times(i, B))
            y, seen = m.load(E, to), m.get(before)
            for k in range(B):
                y = m.minus(y, m.splat(m.scalar(W, m.add(at, k))), seen[k])
            y = b.fmul(y, m.splat(m.scalar(V, m.add(v, i))))
            m.store(y, E, to)
            m.push(before, seen, y)

    return _typed(emit, types.void, W, w, V, v, E, e, first, n)


@intrinsic
def forward_transposed(typing, W, w, Z, z, first, n):  # type: ignore[no-untyped-def]
    """Z = U^-T Z in place for eight columns at Z[z], whose rows before `first` are zero."""

    def emit(m: _Emitter) -> None:
        W, w, Z, z, first, n = m.args
        before = m.variables(_VECTOR, B)
        with cgutils.for_range_slice(m.builder, first, n, ir.Constant(_I64, 1), intp=_I64) as (i, _):
            at, to = m.add(w, m.times(i, ROW)), m.add(z, m.times(i, B))
            y, seen = m.load(Z, to), m.get(before)
            for k in range(B):  # U of row i - 8 + k in column i
                u = m.scalar(W, m.add(at, (k - B) * ROW + 2 * B - 1 - k))
                y = m.minus(y, m.splat(u), seen[k])
            m.store(y, Z, to)
            m.push(before, seen, y)

    return _typed(emit, types.void, W, w, Z, z, first, n)


@intrinsic
def product(typing, Z, z, E, e, first, n, S, s):  # type: ignore[no-untyped-def]
    """S = -Z^T E (8 x 8, at S[s]) of the rows from `first` on."""

    def emit(m: _Emitter) -> None:
        Z, z, E, e, first, n, S, s = m.args
        sums = m.variables(_VECTOR, B)
        with cgutils.for_range_slice(m.builder, first, n, ir.Constant(_I64, 1), intp=_I64) as (i, _):
            y = m.load(E, m.add(e, m.times(i, B)))
            at = m.add(z, m.times(i, B))
            for c in range(B):
                factor = m.splat(m.scalar(Z, m.add(at, c)))
                m.builder.store(m.minus(m.builder.load(sums[c]), factor, y), sums[c])
        for c in range(B):
            m.store(m.builder.load(sums[c]), S, m.add(s, c * B))

    return _typed(emit, types.void, Z, z, E, e, first, n, S, s)


@intrinsic
def backward(typing, W, w, E, e, g, n, x, start):  # type: ignore[no-untyped-def]
    """x[start:] = U^-1 (E g) with the eight factors E[g] of the eight columns at E[e]."""

    def emit(m: _Emitter) -> None:
        W, w, E, e, g, n, x, start = m.args
        b = m.builder
        after = m.variables(_DOUBLE, B)
        factors = m.load(E, g)
        with cgutils.for_range(b, n) as loop:
            i = b.sub(b.sub(n, loop.index), ir.Constant(_I64, 1))
            y = b.fmul(m.load(E, m.add(e, m.times(i, B))), factors)
            for half in (4, 2, 1):
                y = b.fadd(y, m.lanes(y, _ZERO, half))
            value, seen = m.lane(y, 0), m.get(after)
            at = m.add(w, m.times(i, ROW))
            for k in range(B):  # x of row i + 8 - k
                value = m.minus(value, m.scalar(W, m.add(at, 2 * B - 1 - k)), seen[k])
            b.store(value, m.at(x, m.add(start, i)))
            m.push(after, seen, value)

    return _typed(emit, types.void, W, w, E, e, g, n, x, start)


@intrinsic
def subtract(typing, D, to, source, factor, count):  # type: ignore[no-untyped-def]
    """D[to:] -= D[factor] D[source:] for `count` numbers, eight at a time and the rest one by one."""

    def emit(m: _Emitter) -> None:
        D, to, source, factor, count = m.args
        b = m.builder
        f = m.scalar(D, factor)
        many = m.splat(f)
        whole = b.and_(count, ir.Constant(_I64, -B))
        with cgutils.for_range_slice(b, ir.Constant(_I64, 0), whole, ir.Constant(_I64, B), intp=_I64) as (i, _):
            here = m.add(to, i)
            m.store(m.minus(m.load(D, here), many, m.load(D, m.add(source, i))), D, here)
        with cgutils.for_range_slice(b, whole, count, ir.Constant(_I64, 1), intp=_I64) as (i, _):
            here = m.add(to, i)
            b.store(m.minus(m.scalar(D, here), f, m.scalar(D, m.add(source, i))), m.at(D, here))

    return _typed(emit, types.void, D, to, source, factor, count)
