"""Coulomb friction, regularised: F = -F_c tanh(v / v0).

Sticking is a slow creep: under a load F the rate is v0 artanh(F/F_c).
"""

from __future__ import annotations

import math
from typing import Any

from floatsim.description import Description, NonNegative, Positive
from floatsim.jit import kernel
from floatsim.pto_laws.law import Plain


@kernel
def coulomb(P, which, s, v, F):  # type: ignore[no-untyped-def]
    """P (n, 2): F_c, v0."""
    for j in range(which.shape[0]):
        e = which[j]
        y = math.tanh(v[e] / P[j, 1])
        F[0, e] -= P[j, 0] * y
        F[2, e] -= P[j, 0] * (1.0 - y * y) / P[j, 1]


class Coulomb(Description):
    """Dry friction of constant size.

    friction F_c [N] (N m along a turn); speed v0 [m/s] (rad/s): at 2.65 v0 it has 99 % of F_c. Choose v0 small against
    the speeds of interest, but not below F_c dt/m: a step that friction alone could reverse needs to be cut.
    """

    friction: NonNegative
    speed: Positive

    @staticmethod
    def group() -> type[Any]:
        return Plain

    @staticmethod
    def kernel() -> Any:
        return coulomb

    def row(self) -> tuple[float, ...]:
        return self.friction, self.speed

    def dry(self, v: float) -> float:
        """Force of friction [N]."""
        return -self.friction * math.tanh(v / self.speed)
