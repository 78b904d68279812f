"""Massless taut line between two points: T = T0 + (EA/L) s, never negative, F = -T.

Its damper acts as that of a tension-only spring: while the line is tight, at most as strong as its tension.
"""

from __future__ import annotations

import math
from typing import Any

from floatsim.description import Description, NonNegative, Positive
from floatsim.pto_laws.law import Contacts
from floatsim.pto_laws.one_sided import one_sided, one_sided_potential


class TautMooring(Description):
    """Massless taut mooring line or tendon.

    pretension T0 [N] where the PTO's displacement is zero, that is at the drawing position unless the PTO has a `zero`;
    EA [N], length [m] of the line (its stiffness is EA/length); damping [N s/m].
    """

    pretension: NonNegative
    EA: Positive
    length: Positive
    damping: NonNegative = 0.0

    @staticmethod
    def group() -> type[Any]:
        return Contacts

    @staticmethod
    def kernel() -> Any:
        return one_sided

    def begins(self) -> tuple[float, float]:
        """Where it begins to act, below and above."""
        return -math.inf, -self.pretension * self.length / self.EA

    def row(self) -> tuple[float, ...]:
        k = self.EA / self.length
        return k, self.damping, -self.pretension / k, 1.0

    def potential(self, s: float) -> tuple[float, float]:
        """(energy [J], force [N]) of the line."""
        return one_sided_potential(self.row(), s)
