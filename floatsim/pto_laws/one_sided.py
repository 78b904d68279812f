"""Springs that only pull or only push, with a damper that works while the spring does.

    T = k e + min(max(c de/dt, -k e), k e)     for a stretch e > 0, else nothing

The damper never outdoes the spring, so that the force begins at zero and the spring never changes its sign.
"""

from __future__ import annotations

import math
from typing import Any

from floatsim.description import Description, Finite, NonNegative, Positive
from floatsim.jit import kernel
from floatsim.pto_laws.law import Contacts


@kernel
def one_sided(P, which, s, v, F):  # type: ignore[no-untyped-def]
    """P (n, 4): k, c, s0, sign (1: pulls beyond s0, -1: pushes below it)."""
    for j in range(which.shape[0]):
        e = which[j]
        k, c, sign = P[j, 0], P[j, 1], P[j, 3]
        T, f = k * sign * (s[e] - P[j, 2]), c * sign * v[e]
        if not T > 0.0 or f <= -T:
            continue
        if f >= T:
            f, k, c = T, 2.0 * k, 0.0
        F[0, e] -= sign * (T + f)
        F[1, e] -= k
        F[2, e] -= c


def one_sided_potential(row: tuple[float, ...], s: float) -> tuple[float, float]:
    """(energy, force) of the spring with these parameters."""
    k, _, s0, sign = row
    e = max(sign * (s - s0), 0.0)
    return 0.5 * k * e * e, -sign * k * e


class _OneSided(Description):
    stiffness: Positive
    damping: NonNegative = 0.0
    free_position: Finite = 0.0

    @staticmethod
    def group() -> type[Any]:
        return Contacts

    @staticmethod
    def kernel() -> Any:
        return one_sided

    def row(self) -> tuple[float, ...]:
        raise TypeError("a law names its parameters")

    def potential(self, s: float) -> tuple[float, float]:
        """(energy [J], force [N]) of the spring."""
        return one_sided_potential(self.row(), s)


class TensionOnly(_OneSided):
    """Spring that pulls where the displacement is above free_position [m], nothing below.

    stiffness [N/m]; damping [N s/m]: the damper's force is at most the spring's.
    """

    def row(self) -> tuple[float, ...]:
        return self.stiffness, self.damping, self.free_position, 1.0

    def begins(self) -> tuple[float, float]:
        """Where it begins to act, below and above."""
        return -math.inf, self.free_position


class CompressionOnly(_OneSided):
    """Spring that pushes where the displacement is below free_position [m], nothing above.

    stiffness [N/m]; damping [N s/m]: the damper's force is at most the spring's.
    """

    def row(self) -> tuple[float, ...]:
        return self.stiffness, self.damping, self.free_position, -1.0

    def begins(self) -> tuple[float, float]:
        """Where it begins to act, below and above."""
        return self.free_position, math.inf
