"""Large sparse borders by CHOLMOD (extra `cholmod`).

CHOLMOD needs a symmetric positive definite matrix. A border without multipliers is one, but for what drag that turns
with a line and damping along a turning element leave of its symmetry. CHOLMOD therefore factors the symmetric part H
of M, and y <- y + H^-1 (b - M y) is repeated until y no longer changes.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from sksparse.cholmod import CholmodError, analyze

from floatsim.frames import Array

CORRECTIONS = 12
UNCHANGED = 1e-12  # of the solution: the last correction; the error left is smaller by the share that is not symmetric


class CholeskySolver:
    """Factors and solves matrices of one symmetric pattern, that of `M` (CSC, sorted)."""

    def __init__(self, M: Any) -> None:
        cols = np.repeat(np.arange(M.shape[0]), np.diff(M.indptr))
        self._turned = np.lexsort((cols, M.indices))
        self._H = M.copy()
        self._H.data[:] = 1.0
        self._factor = analyze(self._H)

    def factor(self, M: Any) -> bool:
        """False if the symmetric part of M is not positive definite."""
        self._H.data[:] = 0.5 * (M.data + M.data[self._turned])
        try:
            self._factor.cholesky_inplace(self._H)
        except CholmodError:
            return False
        return True

    def solve(self, M: Any, b: Array) -> Array | None:
        """Solution of M y = b; None if the corrections do not vanish: M is too far from symmetric."""
        y: Array = self._factor.solve_A(b)
        for _ in range(CORRECTIONS):
            d = self._factor.solve_A(b - M @ y)
            y += d
            if np.abs(d).max() <= UNCHANGED * np.abs(y).max():
                return y
        return None
