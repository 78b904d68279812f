"""Rigid rods: two points keep their distance."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from floatsim.description import Positive
from floatsim.errors import ModelError
from floatsim.joints.ball import Ball
from floatsim.joints.constraints import Drawing, Place, Row, Separation


class Rod(Ball):
    """Massless rigid rod with a ball joint at either end, between connection point `a` and `b` (a connection point or a
    fixed point).

    length [m]: default as drawn; if given, the drawing must agree. name: of the joint in outputs; its force is what a
    exerts on b, towards a while the rod is in tension.
    """

    length: Positive | None = None

    def ties(self) -> list[tuple[Any, Any]]:
        """None: its ends start apart."""
        return []

    def rows(self, place: Callable[[Any], Place], drawing: Drawing) -> list[Row]:
        a, b = place(self.a), place(self.b)
        drawn = float(np.linalg.norm(drawing.position(a) - drawing.position(b)))
        if drawn == 0.0:
            raise ModelError(
                f"Rod '{self.label}': its two ends start at the same place; give them a distance, or use Ball"
            )
        if self.length is not None and abs(self.length - drawn) > 1e-6 * drawn:
            raise ModelError(
                f"Rod '{self.label}': length is {self.length:g} m, but its ends are drawn {drawn:.9g} m apart; move "
                "one of them, or leave the length out"
            )
        return [Separation(a, b, self.length or drawn)]
