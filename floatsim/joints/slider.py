"""Sliders: one free displacement (prismatic joints)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from floatsim.joints.axis import AxisJoint, on_line, require_rotation, slide
from floatsim.joints.constraints import Drawing, Place, Row
from floatsim.joints.coordinates import Slide
from floatsim.joints.weld import weld_axes


class Slider(AxisJoint):
    """Body connection point `a` slides along `axis` through `b` (a body's connection point or a fixed point).

    The bodies do not turn against each other: their relative attitude is that of the drawing. axis: in the axes of
    b's body (the world's if b is fixed), any length; a is drawn somewhere on it. Coordinate: displacement of a along
    the axis; zero [m]: its value at the drawing position. name: of the joint in outputs, where the moment is that
    about a.
    """

    def rows(self, place: Callable[[Any], Place], drawing: Drawing) -> list[Row]:
        a, b = place(self.a), place(self.b)
        require_rotation(self, drawing, a, self.a)
        require_rotation(self, drawing, b, self.b)
        return [*on_line(a, b, self.axis), *weld_axes(a, b, drawing.attitude(a), drawing.attitude(b))]

    def coordinates(self, place: Callable[[Any], Place], drawing: Drawing) -> dict[str, Slide]:
        """The displacement."""
        return {"": slide(drawing, place(self.a), place(self.b), self.axis, self.zero)}
