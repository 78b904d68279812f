"""End-stops: nothing within the gap, beyond it a spring whose damping grows with the penetration d.

    F = d max(0, k + b dd/dt)      against the penetration

The damper in proportion to the penetration (Hunt & Crossley 1975, J. Applied Mechanics 42) makes the force begin and
end at zero, and never pull.
"""

from __future__ import annotations

import math
from typing import Any

from pydantic import model_validator

from floatsim.description import Description, Finite, NonNegative, Positive
from floatsim.jit import kernel
from floatsim.pto_laws.law import Contacts


@kernel
def end_stop(P, which, s, v, F):  # type: ignore[no-untyped-def]
    """P (n, 4): lower and upper end, k, b."""
    for j in range(which.shape[0]):
        e = which[j]
        for side in range(2):
            sign = -1.0 if side == 0 else 1.0
            d = sign * (s[e] - P[j, side])
            if not d > 0.0:
                continue
            k = P[j, 2] + P[j, 3] * sign * v[e]
            if k > 0.0:
                F[0, e] -= sign * k * d
                F[1, e] -= k
                F[2, e] -= P[j, 3] * d


class EndStop(Description):
    """End-stops at `lower` and `upper` displacement [m] (either may be None).

    stiffness k [N/m]; damping b [N s/m2], per metre of penetration: b = 1.5 a k gives a coefficient of restitution of
    about 1 - a v at an approach speed v. Along a turn: rad, N m/rad, N m s/rad2.
    """

    lower: Finite | None = None
    upper: Finite | None = None
    stiffness: Positive
    damping: NonNegative = 0.0

    @model_validator(mode="after")
    def _has_a_gap(self) -> EndStop:
        if self.lower is None and self.upper is None:
            raise ValueError("it has neither lower nor upper; give one or both")
        if self.lower is not None and self.upper is not None and self.lower >= self.upper:
            raise ValueError(f"lower is {self.lower:g} and upper {self.upper:g}; lower must be below upper")
        return self

    @staticmethod
    def group() -> type[Any]:
        return Contacts

    @staticmethod
    def kernel() -> Any:
        return end_stop

    def begins(self) -> tuple[float, float]:
        """Where contact begins, below and above."""
        return (-math.inf if self.lower is None else self.lower), (math.inf if self.upper is None else self.upper)

    def row(self) -> tuple[float, ...]:
        return *self.begins(), self.stiffness, self.damping

    def potential(self, s: float) -> tuple[float, float]:
        """(energy [J], force [N]) of the spring."""
        low = min(s - self.lower, 0.0) if self.lower is not None else 0.0
        high = max(s - self.upper, 0.0) if self.upper is not None else 0.0
        return 0.5 * self.stiffness * (low * low + high * high), -self.stiffness * (low + high)
