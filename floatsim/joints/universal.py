"""Universal joints (Cardan, Hooke): two free rotations about axes normal to each other."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from pydantic import model_validator

from floatsim.joints.axis import Axis, CoordinateJoint, Pair, directions, relative, require_rotation, triple, turn
from floatsim.joints.constraints import Align, Coincide, Drawing, Place, Row
from floatsim.joints.coordinates import Turn


class Universal(CoordinateJoint):
    """Universal joint between body connection point `a` and `b` (a body's connection point or a fixed point).

    first: axis that stays fixed in b; second: axis that stays fixed in a; both as drawn, in the axes of b's body (the
    world's if b is fixed), any length, normal to each other. a is turned against b by R(first, q1) R(second, q2):
    coordinates `first` q1 and `second` q2 [rad]; zero: their values at the drawing position.
    """

    first: Axis
    second: Axis
    zero: Pair = (0.0, 0.0)

    @model_validator(mode="after")
    def _normal(self) -> Universal:
        lean = float(np.dot(self.first, self.second)) / (math.hypot(*self.first) * math.hypot(*self.second))
        if abs(lean) > 1e-6:
            angle = math.degrees(math.acos(min(1.0, abs(lean))))
            raise ValueError(f"first and second are {angle:.6g} deg apart; the two axes must be normal to each other")
        return self

    def _axes(self) -> tuple[Any, Any]:
        e1 = directions(self.first)[0]
        e2 = np.asarray(self.second) - e1 * (e1 @ np.asarray(self.second))
        return e1, e2 / np.linalg.norm(e2)

    def rows(self, place: Callable[[Any], Place], drawing: Drawing) -> list[Row]:
        a, b = place(self.a), place(self.b)
        require_rotation(self, drawing, a, self.a)
        require_rotation(self, drawing, b, self.b)
        e1, e2 = self._axes()
        return [Coincide(a, b), Align(a.rotation, triple(relative(drawing, a, b) @ e2), b.rotation, triple(e1))]

    def coordinates(self, place: Callable[[Any], Place], drawing: Drawing) -> dict[str, Turn]:
        """The two angles. The second is that of b against a about the opposite axis, which is fixed in a."""
        a, b = place(self.a), place(self.b)
        e1, e2 = self._axes()
        to_a = relative(drawing, a, b)
        return {"first": turn(drawing, a, b, e1, self.zero[0], e2),
                "second": turn(drawing, b, a, -(to_a @ e2), self.zero[1], to_a @ e1)}  # fmt: skip
