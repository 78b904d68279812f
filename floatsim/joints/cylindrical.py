"""Cylindrical joints: a displacement along an axis and a rotation about it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from floatsim.joints.axis import Axis, CoordinateJoint, Pair, on_line, parallel, require_rotation, slide, turn
from floatsim.joints.constraints import Drawing, Place, Row
from floatsim.joints.coordinates import Slide, Turn


class Cylindrical(CoordinateJoint):
    """Body connection point `a` slides along `axis` through `b` and a's body turns about it.

    b: a body's connection point or a fixed point. axis: in the axes of b's body (the world's if b is fixed), any
    length; a is drawn somewhere on it. Coordinates: `slide` [m] and `turn` [rad] of a against b; zero: their values
    at the drawing position. name: of the joint in outputs, where the moment is that about a.
    """

    axis: Axis
    zero: Pair = (0.0, 0.0)

    def rows(self, place: Callable[[Any], Place], drawing: Drawing) -> list[Row]:
        a, b = place(self.a), place(self.b)
        require_rotation(self, drawing, a, self.a)
        require_rotation(self, drawing, b, self.b)
        return [*on_line(a, b, self.axis), *parallel(drawing, a, b, self.axis)]

    def coordinates(self, place: Callable[[Any], Place], drawing: Drawing) -> dict[str, Slide | Turn]:
        """The displacement and the angle."""
        a, b = place(self.a), place(self.b)
        return {"slide": slide(drawing, a, b, self.axis, self.zero[0]),
                "turn": turn(drawing, a, b, self.axis, self.zero[1])}  # fmt: skip
