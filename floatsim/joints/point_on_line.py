"""A point that moves on a straight line: a bead on a wire, a line's end on a rail."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from floatsim.joints.axis import AxisJoint, on_line, require_rotation, slide
from floatsim.joints.constraints import Drawing, Place, Row
from floatsim.joints.coordinates import Slide


class PointOnLine(AxisJoint):
    """Connection point `a` stays on the line through `b` along `axis`; rotations are free.

    a: any connection point; b: a body's connection point or a fixed point. axis: in the axes of b's body (the world's
    if b is fixed), any length; a is drawn somewhere on it. Coordinate: displacement of a along the axis; zero [m]: its
    value at the drawing position. name: of the joint in outputs.
    """

    def rows(self, place: Callable[[Any], Place], drawing: Drawing) -> list[Row]:
        a, b = place(self.a), place(self.b)
        require_rotation(self, drawing, b, self.b)
        return [*on_line(a, b, self.axis)]

    def coordinates(self, place: Callable[[Any], Place], drawing: Drawing) -> dict[str, Slide]:
        """The displacement."""
        return {"": slide(drawing, place(self.a), place(self.b), self.axis, self.zero)}
