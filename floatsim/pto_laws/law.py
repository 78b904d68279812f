"""What laws are evaluated with, and the group of laws without memory."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from floatsim.frames import Array

Index = NDArray[np.int64]


class Now:
    """t [s] at the end of the step, h its length (0: no time passes), still: statics; s, v (n): displacements and
    rates of all PTOs, s0, v0 those at the step's start; a, a0: accelerations of the coordinates (J times those of the
    system) for local errors; memory: what the group committed last."""

    def __init__(self, n: int) -> None:
        self.t = self.h = 0.0
        self.still = False
        self.s, self.v, self.s0, self.v0, self.a, self.a0 = np.zeros((6, n))
        self.memory: Any = None


class Plain:
    """All laws of one kind without memory: rows of parameters, and a `kernel(P, which, s, v, F)` that adds forces."""

    def __init__(self, laws: Sequence[Any], which: Index, labels: Sequence[str]) -> None:
        rows = [law.row() for law in laws]
        self.P = np.zeros((len(rows), max(map(len, rows))))
        for P, row in zip(self.P, rows):
            P[: len(row)] = row
        self.which = which
        self.kernel = laws[0].kernel()

    def add(self, now: Now, F: Array) -> str | None:
        """Add forces and derivatives to F (3, n)."""
        self.kernel(self.P, self.which, now.s, now.v, F)
        return None


RESOLVED = 0.2  # radians of a contact's own oscillation that a step may be long: 16 steps for a bounce


class Contacts(Plain):
    """Laws that begin and end stiffly. A step too long for a bounce would find the body deep in the stop without having
    done work on the way: energy from nothing. The frequency w^2 = |change of acceleration| / |change of depth| of a
    contact shows in the step that enters or leaves it, whatever mass is behind, and (h w)^2 is the local error."""

    def __init__(self, laws: Sequence[Any], which: Index, labels: Sequence[str]) -> None:
        super().__init__(laws, which, labels)
        ends = np.array([law.begins() for law in laws])
        self._low, self._high = ends.T.copy()

    def depth(self, s: Array) -> Array:
        """Penetration (n_law,) at the displacements s, 0 out of contact."""
        own = s[self.which]
        return np.maximum(np.maximum(self._low - own, own - self._high), 0.0)

    def error(self, now: Now) -> float:
        """Local error of the step over what is allowed."""
        d0, d = self.depth(now.s0), self.depth(now.s)
        deeper = np.abs(d - d0) + 0.1 * np.maximum(d, d0)  # at the turning point the acceleration is others' business
        if not deeper.any():
            return 0.0
        change = np.abs(now.a - now.a0)[self.which]
        share = np.divide(change, deeper, out=np.zeros_like(change), where=deeper > 0.0)
        return float(now.h**2 * share.max() / RESOLVED**2)
