"""Polynomial spring and damper of any order: F = -(k1 s + k2 s^2 + ...) - (c1 + c2 |v| + c3 |v|^2 + ...) v.

The damper's even orders are odd functions too (quadratic damping is c2 |v| v), so that it always takes out energy.
"""

from __future__ import annotations

from typing import Any

from pydantic import model_validator

from floatsim.description import Description, Finite, Series
from floatsim.jit import kernel
from floatsim.pto_laws.law import Plain


@kernel
def polynomial(P, which, s, v, F):  # type: ignore[no-untyped-def]
    """P (n, 3 + ..): number of k, of c, s0, then the k, then the c."""
    for j in range(which.shape[0]):
        e = which[j]
        n, m = int(P[j, 0]), int(P[j, 1])
        x, u = s[e] - P[j, 2], abs(v[e])
        f, slope = 0.0, 0.0  # Horner's rule with derivative, from the highest order
        for i in range(n - 1, -1, -1):
            slope = slope * x + f
            f = f * x + P[j, 3 + i]
        F[0, e] -= f * x
        F[1, e] -= slope * x + f
        f, slope = 0.0, 0.0
        for i in range(m - 1, -1, -1):
            slope = slope * u + f
            f = f * u + P[j, 3 + n + i]
        F[0, e] -= f * v[e]
        F[2, e] -= slope * u + f


class Polynomial(Description):
    """Polynomial spring and damper.

    stiffness: (k1, k2, ...) [N/m, N/m2, ...]; damping: (c1, c2, ...) [N s/m, N s2/m2, ...], none negative;
    free_position s0 [m]: the spring is a polynomial of s - s0. Along a turn: N m and rad.
    """

    stiffness: Series = ()
    damping: Series = ()
    free_position: Finite = 0.0

    @model_validator(mode="after")
    def _dissipates(self) -> Polynomial:
        for n, c in enumerate(self.damping, 1):
            if c < 0.0:
                raise ValueError(f"damping: its coefficient of order {n} is {c:g}; none may be negative")
        if not self.stiffness and not self.damping:
            raise ValueError("it has no coefficients; give stiffness=(k1, k2, ...) or damping=(c1, c2, ...)")
        return self

    @staticmethod
    def group() -> type[Any]:
        return Plain

    @staticmethod
    def kernel() -> Any:
        return polynomial

    def row(self) -> tuple[float, ...]:
        return float(len(self.stiffness)), float(len(self.damping)), self.free_position, *self.stiffness, *self.damping

    def potential(self, s: float) -> tuple[float, float]:
        """(energy [J], force [N]) of the spring."""
        y, orders = s - self.free_position, range(1, len(self.stiffness) + 1)
        terms = list(zip(self.stiffness, orders, strict=True))
        return sum(k * y ** (n + 1) / (n + 1) for k, n in terms), -sum(k * y**n for k, n in terms)
