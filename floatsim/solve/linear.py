"""The linear solver that knows the structure: line ends, then every line as a band, then a small dense border.

An end of a line with the multipliers that hold it is eliminated first, with partial pivoting among its few rows
(a *front*); what remains couples the line's first or last nodes to whatever the end was tied to. With chain c's
banded block B = L U and its couplings E (to the border) and F^T (from it),

    Y = L^-1 E,   Z = U^-T F,   S = D - sum Z^T Y,   S x_b = r_b - sum Z^T L^-1 r_c,
    x_c = U^-1 (L^-1 r_c - Y x_b)

The band is factored without pivoting (mass over dt^2 and axial stiffness dominate it), the border
with partial pivoting, because multipliers make it indefinite; its rows stay unscaled. A border too large for a
dense matrix (nets) goes to CHOLMOD or to SciPy's SuperLU; after a vanishing pivot the whole matrix goes to SuperLU,
which tests also hold against this path.
"""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import numpy as np

from floatsim.frames import Array
from floatsim.jit import kernel
from floatsim.solve.band import ROW, B, backward, factor, forward, forward_transposed, product, spread, subtract
from floatsim.system.layout import Index, Layout

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix
    from scipy.sparse.linalg import SuperLU

    from floatsim.solve.cholesky import CholeskySolver

log = logging.getLogger("floatsim")

LARGEST_RATIO = 100_000  # of a row's entries to its pivot: above this a band without pivoting loses too many digits
CHAIN, FRONT = 16, 7  # offsets of a chain, of a front, see `_plan`
SINGULAR = 1e-14  # of its column: a pivot of a line's end below this is zero


@kernel
def _factor_dense(D, o, n, swaps, first):  # type: ignore[no-untyped-def]
    """LU with partial pivoting of the n x n matrix at o; rows swapped go to swaps[first:]. 1 if singular."""
    for k in range(n):
        p = k
        best = abs(D[o + k * n + k])
        for i in range(k + 1, n):
            if abs(D[o + i * n + k]) > best:
                best, p = abs(D[o + i * n + k]), i
        if not best > 0.0:
            return 1
        swaps[first + k] = p
        if p != k:
            for j in range(n):
                D[o + k * n + j], D[o + p * n + j] = D[o + p * n + j], D[o + k * n + j]
        inv = 1.0 / D[o + k * n + k]
        for i in range(k + 1, n):
            at = o + i * n + k
            if D[at] != 0.0:
                D[at] *= inv
                subtract(D, at + 1, o + k * n + k + 1, at, n - k - 1)
    return 0


@kernel
def _solve_dense(D, o, n, swaps, first, x):  # type: ignore[no-untyped-def]
    """Solution of the factored n x n system at o, for the right-hand side x[:n] in place."""
    for k in range(n):
        p = swaps[first + k]
        x[k], x[p] = x[p], x[k]
    for i in range(n):
        y = x[i]
        for j in range(i):
            y -= D[o + i * n + j] * x[j]
        x[i] = y
    for i in range(n - 1, -1, -1):
        y = x[i]
        for j in range(i + 1, n):
            y -= D[o + i * n + j] * x[j]
        x[i] = y / D[o + i * n + i]


@kernel
def _eliminate_front(A, W, I, f):  # type: ignore[no-untyped-def]
    """Eliminate a line's end from A: W = [1 | P_kk^-1 | T = P_kk^-1 P_kN], A_NN -= Q T. 1 if singular.

    What A_NN was is kept for the other solver.
    """
    k, m, P, Q, T, kept, w = I[f], I[f + 1], I[f + 2], I[f + 3], I[f + 4], I[f + 5], I[f + 6]
    for i in range(k):
        for j in range(k):
            W[T + i * w + j] = A[P + i * (k + m) + j]
            W[T + i * w + k + j] = 0.0
        W[T + i * w + k + i] = 1.0
        for j in range(m):
            W[T + i * w + 2 * k + j] = A[P + i * (k + m) + k + j]
    for c in range(k):
        p = c
        best = 0.0
        size = 0.0
        for i in range(k):
            size = max(size, abs(A[P + i * (k + m) + c]))
            if i >= c and abs(W[T + i * w + c]) > best:
                best, p = abs(W[T + i * w + c]), i
        if not best > SINGULAR * size:
            return 1
        here = T + c * w
        inv = 1.0 / W[T + p * w + c]
        for j in range(w):
            new = W[T + p * w + j] * inv
            W[T + p * w + j] = W[here + j]
            W[here + j] = new
        for i in range(k):
            if i != c and W[T + i * w + c] != 0.0:
                subtract(W, T + i * w, here, T + i * w + c, w)
    slots, q = f + FRONT + k + m, kept + m * m + k
    row = q + m * k  # one row of Q T, with room to the next eight
    for i in range(m * k):
        W[q + i] = A[Q + i]
    for i in range(m):
        for j in range(m):
            W[row + j] = 0.0
        for c in range(k):
            if W[q + i * k + c] != 0.0:
                subtract(W, row, T + c * w + 2 * k, q + i * k + c, (m + B - 1) // B * B)
        for j in range(m):
            s = I[slots + i * m + j]
            W[kept + i * m + j] = A[s]
            A[s] += W[row + j]
    return 0


@kernel
def restore(A, W, I, done):  # type: ignore[no-untyped-def]
    """Undo what the first `done` fronts have changed in A."""
    for l in range(done - 1, -1, -1):
        f = I[I[4] + l]
        k, m, kept = I[f], I[f + 1], I[f + 5]
        for i in range(m * m):
            A[I[f + FRONT + k + m + i]] = W[kept + i]


@kernel
def _reduce_front(W, I, f, R):  # type: ignore[no-untyped-def]
    """R_k = P_kk^-1 R_k, R_N -= Q R_k, for the right-hand side at W[R:]."""
    k, m, T = I[f], I[f + 1], I[f + 4]
    w, dofs, y = I[f + 6], f + FRONT, I[f + 5] + m * m
    q = y + k
    for i in range(k):
        v = 0.0
        for c in range(k):
            v += W[T + i * w + k + c] * W[R + I[dofs + c]]
        W[y + i] = v
    for i in range(k):
        W[R + I[dofs + i]] = W[y + i]
    for i in range(m):
        v = 0.0
        for c in range(k):
            v += W[q + i * k + c] * W[y + c]
        W[R + I[dofs + k + i]] -= v


@kernel
def _columns(A, W, I, c):  # type: ignore[no-untyped-def]
    """A chain's couplings to the border as columns of E and Z."""
    n, reach, ml, mr = I[c + 1], I[c + 2], I[c + 3], I[c + 4]
    ol, olt, orr, ort, e, z = I[c + 6], I[c + 7], I[c + 8], I[c + 9], I[c + 12], I[c + 13]
    for p in range(ml + mr):
        block, lane = p // B * n * B, p % B
        shift, o1, o2, q, m = (0, ol, olt, p, ml) if p < ml else (n - reach, orr, ort, p - ml, mr)
        for i in range(reach):
            at = block + (i + shift) * B + lane
            W[e + at] = A[o1 + i * m + q]
            W[z + at] = A[o2 + i * m + q]


@kernel
def _eliminate_chain(A, W, I, c):  # type: ignore[no-untyped-def]
    """Factor a chain and take its share off the dense border. 1 on a vanishing pivot."""
    R, D, xb, S = I[7], I[8], I[9], I[11]
    n, reach, ml, m = I[c + 1], I[c + 2], I[c + 3], I[c + 3] + I[c + 4]
    w, v, e, z, blocks, columns = I[c + 10], I[c + 11], I[c + 12], I[c + 13], I[c + 14], I[c + 15]
    if not factor(A, I[c + 5], n, W, w, W, v, LARGEST_RATIO):
        return 1
    first = 0 if ml > 0 else n - reach
    for k in range(blocks - 1):
        for i in range(e + (k * n + first) * B, e + (k + 1) * n * B):
            W[i] = 0.0
    spread(W, R + I[c], W, e + (blocks - 1) * n * B, n)
    for k in range((m + B - 1) // B):
        for i in range(z + (k * n + first) * B, z + (k + 1) * n * B):
            W[i] = 0.0
    if m > 0:
        _columns(A, W, I, c)
    for k in range(blocks):
        forward(W, w, W, v, W, e + k * n * B, 0 if k == blocks - 1 else first, n)
    for k in range((m + B - 1) // B):
        zk = z + k * n * B
        forward_transposed(W, w, W, zk, first, n)
        for l in range(blocks):
            product(W, zk, W, e + l * n * B, first, n, W, S)
            for p in range(min(B, m - k * B)):
                places = columns + m + (k * B + p) * m + l * B
                for q in range(min(B, m - l * B)):
                    W[D + I[places + q]] += W[S + p * B + q]
                if l == blocks - 1:
                    W[xb + I[columns + k * B + p]] += W[S + p * B + B - 1]
    return 0


@kernel
def _solve_chain(W, I, c, x, xb, g):  # type: ignore[no-untyped-def]
    """x of a chain from its right-hand side, forward substituted, and the border's solution at W[xb:]."""
    n, m = I[c + 1], I[c + 3] + I[c + 4]
    e, blocks, columns = I[c + 12], I[c + 14], I[c + 15]
    last = e + (blocks - 1) * n * B
    for k in range(blocks - 1):
        for i in range(n):
            s = 0.0
            for q in range(B):
                s += W[e + (k * n + i) * B + q] * W[xb + I[columns + k * B + q]]
            W[last + i * B + B - 1] -= s
    for q in range(B - 1):
        p = (blocks - 1) * B + q
        W[g + q] = -W[xb + I[columns + p]] if p < m else 0.0
    W[g + B - 1] = 1.0
    backward(W, I[c + 10], W, last, g, n, x, I[c])


@kernel
def substitute(W, I, x):  # type: ignore[no-untyped-def]
    """Chains and fronts from the border's solution."""
    n_front, n_chain, nb, fronts, chains, border, xb = I[0], I[1], I[2], I[4], I[5], I[6], I[9]
    for i in range(nb):
        x[I[border + i]] = W[xb + i]
    for k in range(n_chain):
        _solve_chain(W, I, chains + CHAIN * k, x, xb, I[10])
    for l in range(n_front - 1, -1, -1):
        f = I[fronts + l]
        k, m, T, w, y = I[f], I[f + 1], I[f + 4], I[f + 6], I[f + 5] + I[f + 1] * I[f + 1]
        dofs = f + FRONT
        for i in range(k):
            v = W[y + i]
            for j in range(m):
                v -= W[T + i * w + 2 * k + j] * x[I[dofs + k + j]]
            x[I[dofs + i]] = v


@kernel
def solve_structured(A, r, x, W, I):  # type: ignore[no-untyped-def]
    """x = -A^-1 r. W: scratch, keeps the factors; I: offsets, see `_plan`. 1 if A cannot be factored so.

    Then A is as it was; otherwise a few of its entries have changed. A sparse border is left to the caller, together
    with its right-hand side, before `substitute`.
    """
    n_front, n_chain, nb, entries, fronts, chains, border = I[0], I[1], I[2], I[3], I[4], I[5], I[6]
    R, D, xb = I[7], I[8], I[9]
    for i in range(r.shape[0]):
        W[R + i] = -r[i]
    done = 0
    bad = 0
    while done < n_front and bad == 0:
        f = I[fronts + done]
        bad = _eliminate_front(A, W, I, f)
        if bad == 0:
            _reduce_front(W, I, f, R)
            done += 1
    if bad == 0:
        for i in range(I[14]):
            W[D + i] = A[entries + i]
        for i in range(nb):
            W[xb + i] = W[R + I[border + i]]
    k = 0
    while k < n_chain and bad == 0:
        bad = _eliminate_chain(A, W, I, chains + CHAIN * k)
        k += 1
    if bad == 0 and I[15] == 1:
        bad = _factor_dense(W, D, nb, I, I[12])
        if bad == 0:
            _solve_dense(W, D, nb, I, I[12], W[xb : xb + nb])
            substitute(W, I, x)
    if bad != 0:
        restore(A, W, I, done)
    return bad


@kernel
def solve_again(r, x, W, I):  # type: ignore[no-untyped-def]
    """x = -A^-1 r with the factors of the last `solve_structured`, a sparse border again left to the caller."""
    n_front, n_chain, nb, fronts, chains, border = I[0], I[1], I[2], I[4], I[5], I[6]
    R, xb, S, once = I[7], I[9], I[11], I[13]
    for i in range(r.shape[0]):
        W[R + i] = -r[i]
    for k in range(n_front):
        _reduce_front(W, I, I[fronts + k], R)
    for i in range(nb):
        W[xb + i] = W[R + I[border + i]]
    for k in range(n_chain):
        c = chains + CHAIN * k
        n, m, w, v, columns = I[c + 1], I[c + 3] + I[c + 4], I[c + 10], I[c + 11], I[c + 15]
        first = 0 if I[c + 3] > 0 else n - I[c + 2]
        spread(W, R + I[c], W, once, n)
        forward(W, w, W, v, W, once, 0, n)
        for l in range((m + B - 1) // B):
            product(W, I[c + 13] + l * n * B, W, once, first, n, W, S)
            for p in range(min(B, m - l * B)):
                W[xb + I[columns + l * B + p]] += W[S + p * B + B - 1]
        last = I[c + 12] + (I[c + 14] - 1) * n * B
        for i in range(n):
            W[last + i * B + B - 1] = W[once + i * B + B - 1]
    if I[15] == 1:
        _solve_dense(W, I[8], nb, I, I[12], W[xb : xb + nb])
        substitute(W, I, x)


def _plan(layout: Layout) -> tuple[Array, Index]:
    """Scratch W and offsets I of the structured solver.

    I: n_front, n_chain, n_border; then where things are: the border's entries in A; fronts, chains and border in I;
    in W the right-hand side R, the border D, its solution, eight factors g, an 8 x 8 block S; row swaps in I;
    in W a block of columns; the number of the border's entries; 1 if it is dense.
    A chain: start, n, reach, m_left, m_right; band, left, left^T, right, right^T in A; factor, 1/D, E, Z in W;
    blocks of E; in I the m places of its columns in the border and the m x m of their entries.
    A front: k own unknowns, m others; its rows and its columns in A; T and what is kept of A in W; T's row length;
    k + m unknowns, m x m slots.
    """
    n, nb, size = layout.n, len(layout.border), 0

    def room(count: int) -> int:
        nonlocal size
        size += -(-count // B) * B
        return size - -(-count // B) * B

    room(B * ROW)  # rows before the first factor's
    longest = max((c.n for c in layout.chains), default=0)
    entries = layout.border_keys
    head = [len(layout.fronts), len(layout.chains), nb, layout.border_offset, 0, 0, 0,
            room(n), room(len(entries)), room(nb), room(B), room(B * B), 0, room(longest * B),
            len(entries), int(layout.structured)]  # fmt: skip
    place = np.full(n, -1)
    place[layout.border] = np.arange(nb)
    parts: list[Index] = [np.array(head), layout.border, np.zeros(nb, np.int64)]
    parts[0][6], parts[0][12] = len(head), len(head) + nb
    end = len(head) + 2 * nb
    columns, where = [], []
    for c in layout.chains:
        where.append(end)
        u = place[np.concatenate([c.left, c.right])]
        columns.append(np.concatenate([u, np.searchsorted(entries, np.repeat(u, len(u)) * nb + np.tile(u, len(u)))]))
        end += len(columns[-1])
    parts += columns
    parts[0][5] = end
    for c, row, at in zip(layout.chains, layout.table, where, strict=True):
        m = len(c.left) + len(c.right)
        blocks = m // B + 1
        parts.append(np.array([c.start, c.n, c.reach, *row[4:11], room(c.n * ROW), room(c.n), room(blocks * c.n * B),
                               room(-(-m // B) * c.n * B), blocks, at]))  # fmt: skip
        end += CHAIN
    starts = []
    for f in layout.fronts:
        k, m = len(f.own), len(f.others)
        starts.append(end)
        w = -(-(2 * k + m) // B) * B
        here = [k, m, f.rows, f.columns, room(k * w + B), room(m * m + k + m * k + m + B), w]
        parts += [np.array(here), f.own, f.others, layout.slots(f.others[None, :])[0]]
        end += sum(len(p) for p in parts[-4:])
    parts[0][4] = end
    parts.append(np.array(starts, dtype=np.int64))
    return np.zeros(size), np.concatenate(parts).astype(np.int64)


class _SparseBorder:
    """A large border as a sparse matrix: CHOLMOD if it is installed and no multipliers are left, else SuperLU."""

    def __init__(self, layout: Layout, W: Array, I: Index) -> None:
        from scipy.sparse import csc_matrix

        nb, keys = len(layout.border), layout.border_keys
        rows, cols = keys // nb, keys % nb
        self._order = np.lexsort((rows, cols))
        ends = np.concatenate([[0], np.cumsum(np.bincount(cols, minlength=nb))]).astype(np.int32)
        self._M = csc_matrix((np.zeros(len(keys)), rows[self._order].astype(np.int32), ends), shape=(nb, nb))
        self._M.has_canonical_format = True
        self._entries, self._x = W[I[8] : I[8] + len(keys)], W[I[9] : I[9] + nb]
        self._cholesky: CholeskySolver | None = None
        self._lu: SuperLU | None = None
        if (layout.border < layout.multiplier).all():
            try:
                from floatsim.solve.cholesky import CholeskySolver  # needs the optional package

                self._cholesky = CholeskySolver(self._M)
            except ImportError:
                log.info("scikit-sparse is not installed (extra `cholmod`): SuperLU is used")

    @property
    def by_lu(self) -> bool:
        """Whether SuperLU was needed."""
        return self._cholesky is None or self._lu is not None

    def factor(self) -> bool:
        """Take the matrix from the scratch. False if it is singular."""
        from scipy.sparse.linalg import splu

        np.take(self._entries, self._order, out=self._M.data)
        if self._cholesky is not None and self._cholesky.factor(self._M):
            self._lu = None
            return True
        try:
            self._lu = splu(self._M)
        except RuntimeError:
            return False
        return True

    def solve(self) -> bool:
        """Right-hand side in the scratch to solution. False if it is not finite."""
        y = None
        if self._lu is None and self._cholesky is not None:
            y = self._cholesky.solve(self._M, self._x)
        if y is None:
            from scipy.sparse.linalg import splu

            if self._lu is None:
                self._lu = splu(self._M)
            y = self._lu.solve(self._x)
        self._x[:] = y
        return bool(np.isfinite(y).all())


class LinearSolver:
    """x = -A^-1 r for the entries of a layout; SuperLU for the whole where a pivot vanishes."""

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        self.fallbacks = 0
        self._W, self._I = _plan(layout)
        self._border: _SparseBorder | None = None
        if not layout.structured:
            log.info("%d border unknowns: they are solved as a general sparse matrix", len(layout.border))
            self._border = _SparseBorder(layout, self._W, self._I)
        self._sparse: tuple[Index, csc_matrix] | None = None
        self._factored: SuperLU | None = None

    def solve(self, A: Array, r: Array, x: Array) -> bool:
        """Solution into x; A is destroyed. False if the matrix is singular."""
        self._factored = None
        border = self._border
        if solve_structured(A, r, x, self._W, self._I) == 0:
            if border is None:
                return True
            if border.factor() and border.solve():
                substitute(self._W, self._I, x)
                return True
            restore(A, self._W, self._I, len(self.layout.fronts))
        self.fallbacks += 1
        log.info("vanishing pivot in the structured factorisation: this iteration is solved by SuperLU")
        return self.solve_sparse(A, r, x)

    @property
    def border_solver(self) -> str:
        """What solved the border last: dense, CHOLMOD or SuperLU."""
        if self._border is None:
            return "dense"
        return "SuperLU" if self._border.by_lu else "CHOLMOD"

    def solve_again(self, r: Array, x: Array) -> None:
        """The same for another right-hand side and the matrix of the last `solve` that returned True."""
        if self._factored is not None:
            x[self._free] = self._factored.solve(-r[self._free])
            return
        solve_again(r, x, self._W, self._I)
        if self._border is not None:
            self._border.solve()
            substitute(self._W, self._I, x)

    def matrix(self, A: Array) -> csc_matrix:
        """The entries as a scipy CSC matrix of all unknowns."""
        from scipy.sparse import csc_matrix

        lay = self.layout
        return csc_matrix((A[lay.slot], (lay.rows, lay.cols)), shape=(lay.n, lay.n))

    def _pattern(self) -> tuple[Index, csc_matrix]:
        """Slots in the order of a CSC matrix of the unknowns that are free, and that matrix."""
        if self._sparse is None:
            from scipy.sparse import csc_matrix

            lay = self.layout
            self._free = np.unique(lay.rows)
            place = np.zeros(lay.n, dtype=np.int32)
            place[self._free] = np.arange(len(self._free))
            order = np.lexsort((lay.rows, lay.cols))
            n = len(self._free)
            ends = np.concatenate([[0], np.cumsum(np.bincount(place[lay.cols], minlength=n))]).astype(np.int32)
            M = csc_matrix((np.zeros(len(order)), place[lay.rows[order]], ends), shape=(n, n))
            M.has_canonical_format = True
            self._sparse = lay.slot[order], M
        return self._sparse

    def solve_sparse(self, A: Array, r: Array, x: Array) -> bool:
        """The same by SuperLU on the whole matrix."""
        from scipy.sparse.linalg import splu

        slots, M = self._pattern()
        np.take(A, slots, out=M.data)
        try:
            self._factored = splu(M)
        except RuntimeError:
            return False
        x[self._free] = self._factored.solve(-r[self._free])
        return bool(np.isfinite(x[self._free]).all())
