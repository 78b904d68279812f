"""Hinges: one free rotation (revolute joints)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from floatsim.joints.axis import AxisJoint, parallel, require_rotation, turn
from floatsim.joints.constraints import Coincide, Drawing, Place, Row
from floatsim.joints.coordinates import Turn


class Hinge(AxisJoint):
    """Hinge between body connection point `a` and `b` (a body's connection point or a fixed point) about `axis`.

    axis: in the axes of b's body (the world's if b is fixed), any length. Coordinate: the angle of a against b,
    right-handed about the axis; zero [rad]: its value at the drawing position. name: of the joint in outputs.
    """

    def rows(self, place: Callable[[Any], Place], drawing: Drawing) -> list[Row]:
        a, b = place(self.a), place(self.b)
        require_rotation(self, drawing, a, self.a)
        require_rotation(self, drawing, b, self.b)
        return [Coincide(a, b), *parallel(drawing, a, b, self.axis)]

    def coordinates(self, place: Callable[[Any], Place], drawing: Drawing) -> dict[str, Turn]:
        """The angle."""
        return {"": turn(drawing, place(self.a), place(self.b), self.axis, self.zero)}
