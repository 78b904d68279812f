"""One step of states of a PTO's own, dy/dt = f(y, s, v), within the step of the system.

Two implicit stages with the same diagonal g = 1 - 1/sqrt(2): second order, L-stable (stiff pressures settle at once),
and the second stage is the end of the step (Alexander 1977, SIAM J. Numerical Analysis 14):

    Y1 = y0 + h g f(Y1, u(g h)),       Y2 = y0 + (1 - g)/g (Y1 - y0) + h g f(Y2, u(h)),       y(h) = Y2

s and v run linearly from their values at the step's start to those at its end, which the system's Newton iteration
tries; Y2 follows by Newton iterations of its own, and its derivatives by s and v at the end go into the tangent: the
states are condensed out, and are as implicit as the rest.
"""

from __future__ import annotations

import math

from floatsim.jit import kernel

GAMMA = 1.0 - 1.0 / math.sqrt(2.0)


@kernel
def solve(A, b):  # type: ignore[no-untyped-def]
    """Solve A x = b (n, n), (n, m) in place by elimination with scaled pivots; False if A is singular."""
    n, m = b.shape
    for k in range(n):
        best, pivot = 0.0, -1
        for i in range(k, n):
            top = 0.0
            for j in range(k, n):
                top = max(top, abs(A[i, j]))
            if top > 0.0 and abs(A[i, k]) / top > best:
                best, pivot = abs(A[i, k]) / top, i
        if pivot < 0 or not best > 0.0:
            return False
        if pivot != k:
            for j in range(n):
                A[k, j], A[pivot, j] = A[pivot, j], A[k, j]
            for j in range(m):
                b[k, j], b[pivot, j] = b[pivot, j], b[k, j]
        for i in range(k + 1, n):
            f = A[i, k] / A[k, k]
            for j in range(k, n):
                A[i, j] -= f * A[k, j]
            for j in range(m):
                b[i, j] -= f * b[k, j]
    for j in range(m):
        for i in range(n - 1, -1, -1):
            for q in range(i + 1, n):
                b[i, j] -= A[i, q] * b[q, j]
            b[i, j] /= A[i, i]
    return True
