"""The linear solver that knows the structure: eliminate every line as a band, then a small dense border.

With chain c's banded block B = L U, its couplings E (to the border) and F^T (from it),

    Y = L^-1 E,   Z = U^-T F,   S = D - sum Z^T Y,   S x_b = r_b - sum Z^T L^-1 r_c,
    x_c = U^-1 (L^-1 r_c - Y x_b)

The band is factored without pivoting (mass over dt^2 and axial stiffness dominate it), the border
with partial pivoting, because multipliers make it indefinite; its rows stay unscaled. A vanishing
pivot or an unstructured layout goes to SciPy's SuperLU, which tests also hold against this path.
CHOLMOD was rejected here: the multiplier system is not positive definite.
"""

from __future__ import annotations

import logging

import numpy as np

from floatsim.frames import Array
from floatsim.jit import kernel
from floatsim.system.layout import Layout

log = logging.getLogger("floatsim")

SMALL_PIVOT = 1e-5  # of its row: below this a band without pivoting loses too many digits


@kernel
def _factor_band(A, o, n, b):  # type: ignore[no-untyped-def]
    """LU of a band in place: entry (i, j) at o + i (2b+1) + j - i + b. Returns 1 on a vanishing pivot."""
    w = 2 * b + 1
    for k in range(n):
        row = o + k * w + b
        pivot = A[row]
        size = 0.0
        last = min(b, n - 1 - k)
        for j in range(1, last + 1):
            size = max(size, abs(A[row + j]))
        if not abs(pivot) > SMALL_PIVOT * size:
            return 1
        inv = 1.0 / pivot
        for i in range(1, last + 1):
            at = row + i * w - i  # entry (k + i, k)
            m = A[at] * inv
            A[at] = m
            if m != 0.0:
                for j in range(1, last + 1):
                    A[at + j] -= m * A[row + j]
    return 0


@kernel
def _forward(A, o, n, b, y, first, m):  # type: ignore[no-untyped-def]
    """y = L^-1 y for the first m columns of y, whose rows before `first` are zero."""
    w = 2 * b + 1
    for i in range(first + 1, n):
        for k in range(max(first, i - b), i):
            f = A[o + i * w + k - i + b]
            for c in range(m):
                y[i, c] -= f * y[k, c]


@kernel
def _forward_transposed(A, o, n, b, z, first, m):  # type: ignore[no-untyped-def]
    """z = U^-T z."""
    w = 2 * b + 1
    for i in range(first, n):
        for k in range(max(first, i - b), i):
            f = A[o + k * w + i - k + b]
            for c in range(m):
                z[i, c] -= f * z[k, c]
        inv = 1.0 / A[o + i * w + b]
        for c in range(m):
            z[i, c] *= inv


@kernel
def _solve_dense(D, o, n, x):  # type: ignore[no-untyped-def]
    """Gaussian elimination with partial pivoting of the n x n matrix at o, solution in x. 1 if singular."""
    for k in range(n):
        p = k
        best = abs(D[o + k * n + k])
        for i in range(k + 1, n):
            if abs(D[o + i * n + k]) > best:
                best, p = abs(D[o + i * n + k]), i
        if not best > 0.0:
            return 1
        if p != k:
            for j in range(k, n):
                D[o + k * n + j], D[o + p * n + j] = D[o + p * n + j], D[o + k * n + j]
            x[k], x[p] = x[p], x[k]
        inv = 1.0 / D[o + k * n + k]
        for i in range(k + 1, n):
            m = D[o + i * n + k] * inv
            if m != 0.0:
                for j in range(k + 1, n):
                    D[o + i * n + j] -= m * D[o + k * n + j]
                x[i] -= m * x[k]
    for i in range(n - 1, -1, -1):
        y = x[i]
        for j in range(i + 1, n):
            y -= D[o + i * n + j] * x[j]
        x[i] = y / D[o + i * n + i]
    return 0


@kernel
def solve_structured(A, table, columns, border, offset, r, x, Y, Z, y, xb):  # type: ignore[no-untyped-def]
    """x = -A^-1 r, destroying A. columns: border positions of every chain's left and right columns, in
    a row; Y, Z (n_chain rows in a row, max columns), y (rows, 1), xb (n_border) scratch. 1 if singular.
    """
    nb = border.shape[0]
    for i in range(nb):
        xb[i] = -r[border[i]]
    row = 0
    col = 0
    for k in range(table.shape[0]):
        start, n, b, reach, ml, mr = table[k, 0], table[k, 1], table[k, 2], table[k, 3], table[k, 4], table[k, 5]
        o, ol, olt, orr, ort = table[k, 6], table[k, 7], table[k, 8], table[k, 9], table[k, 10]
        if _factor_band(A, o, n, b) != 0:
            return 1
        m = ml + mr
        Yk, Zk, yk = Y[row : row + n], Z[row : row + n], y[row : row + n]
        for i in range(n):
            yk[i, 0] = -r[start + i]
            for c in range(m):
                Yk[i, c] = 0.0
                Zk[i, c] = 0.0
        for i in range(reach):
            for c in range(ml):
                Yk[i, c] = A[ol + i * ml + c]
                Zk[i, c] = A[olt + i * ml + c]
            for c in range(mr):
                Yk[n - reach + i, ml + c] += A[orr + i * mr + c]
                Zk[n - reach + i, ml + c] += A[ort + i * mr + c]
        _forward(A, o, n, b, yk, 0, 1)
        first = 0 if ml > 0 else n - reach
        _forward(A, o, n, b, Yk, first, m)
        _forward_transposed(A, o, n, b, Zk, first, m)
        for p in range(m):
            bp = columns[col + p]
            sy = 0.0
            for i in range(first, n):
                sy += Zk[i, p] * yk[i, 0]
            xb[bp] -= sy
            for q in range(m):
                s = 0.0
                for i in range(first, n):
                    s += Zk[i, p] * Yk[i, q]
                A[offset + bp * nb + columns[col + q]] -= s
        row += n
        col += m
    if _solve_dense(A, offset, nb, xb) != 0:
        return 1
    for i in range(nb):
        x[border[i]] = xb[i]
    row = 0
    col = 0
    for k in range(table.shape[0]):
        start, n, b, o = table[k, 0], table[k, 1], table[k, 2], table[k, 6]
        m = table[k, 4] + table[k, 5]
        w = 2 * b + 1
        for i in range(n - 1, -1, -1):
            s = y[row + i, 0]
            for c in range(m):
                s -= Y[row + i, c] * xb[columns[col + c]]
            for j in range(1, min(b, n - 1 - i) + 1):
                s -= A[o + i * w + b + j] * x[start + i + j]
            x[start + i] = s / A[o + i * w + b]
        row += n
        col += m
    return 0


class LinearSolver:
    """x = -A^-1 r for the entries of a layout; structured where the layout allows, else SuperLU."""

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        self.fallbacks = 0
        if not layout.structured:
            log.info("%d border unknowns: the system is solved as a general sparse matrix", len(layout.border))
        keep = np.zeros(layout.n, dtype=bool)
        keep[layout.rows] = True
        self._free = np.flatnonzero(keep)
        if layout.structured:
            place = np.full(layout.n, -1)
            place[layout.border] = np.arange(len(layout.border))
            lists = [place[np.concatenate([c.left, c.right])] for c in layout.chains]
            self._columns = np.concatenate([np.zeros(0, np.int64), *lists]).astype(np.int64)
            n = sum(c.n for c in layout.chains)
            m = max((len(c.left) + len(c.right) for c in layout.chains), default=0)
            self._scratch = (np.zeros((n, m)), np.zeros((n, m)), np.zeros((n, 1)), np.zeros(len(layout.border)))
            self._backup = np.zeros(layout.size + 1)

    def solve(self, A: Array, r: Array, x: Array) -> bool:
        """Solution into x; A is destroyed. False if the matrix is singular."""
        if not self.layout.structured:
            return self.solve_sparse(A, r, x)
        np.copyto(self._backup, A)
        lay = self.layout
        if solve_structured(A, lay.table, self._columns, lay.border, lay.border_offset, r, x, *self._scratch) == 0:
            return True
        self.fallbacks += 1
        log.info("vanishing pivot in the structured factorisation: this iteration is solved by SuperLU")
        return self.solve_sparse(self._backup, r, x)

    def matrix(self, A: Array):  # type: ignore[no-untyped-def]
        """The entries as a scipy CSC matrix of all unknowns."""
        from scipy.sparse import csc_matrix

        lay = self.layout
        return csc_matrix((A[lay.slot], (lay.rows, lay.cols)), shape=(lay.n, lay.n))

    def solve_sparse(self, A: Array, r: Array, x: Array) -> bool:
        """The same by SuperLU on the whole matrix."""
        from scipy.sparse.linalg import splu

        free = self._free
        matrix = self.matrix(A)[free][:, free].tocsc()
        try:
            x[free] = splu(matrix).solve(-r[free])
        except RuntimeError:
            return False
        return bool(np.isfinite(x[free]).all())
