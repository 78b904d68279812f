"""Linear spring and damper: F = F0 - k (s - s0) - c v."""

from __future__ import annotations

from typing import Any

from floatsim.description import Description, Finite, NonNegative
from floatsim.jit import kernel
from floatsim.pto_laws.law import Plain


@kernel
def linear(P, which, s, v, F):  # type: ignore[no-untyped-def]
    """P (n, 4): k, c, F0, s0."""
    for j in range(which.shape[0]):
        e = which[j]
        F[0, e] += P[j, 2] - P[j, 0] * (s[e] - P[j, 3]) - P[j, 1] * v[e]
        F[1, e] -= P[j, 0]
        F[2, e] -= P[j, 1]


class Linear(Description):
    """Linear spring and damper.

    stiffness k [N/m], damping c [N s/m], preload F0 [N] (acts on a in the positive sense), free_position s0 [m]: where
    the spring has no force. Along a turn: N m/rad, N m s/rad, N m, rad.
    """

    stiffness: NonNegative = 0.0
    damping: NonNegative = 0.0
    preload: Finite = 0.0
    free_position: Finite = 0.0

    @staticmethod
    def group() -> type[Any]:
        return Plain

    @staticmethod
    def kernel() -> Any:
        return linear

    def row(self) -> tuple[float, ...]:
        return self.stiffness, self.damping, self.preload, self.free_position

    def potential(self, s: float) -> tuple[float, float]:
        """(energy [J], force [N]) of the spring."""
        y = s - self.free_position
        return 0.5 * self.stiffness * y * y - self.preload * y, self.preload - self.stiffness * y
