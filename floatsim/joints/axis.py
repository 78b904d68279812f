"""What joints with an axis share: directions at the drawing position, and where their coordinates are zero."""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator

from floatsim.description import Finite, Target, Vector3, numbers
from floatsim.errors import ModelError
from floatsim.frames import Array
from floatsim.joints.ball import Ball
from floatsim.joints.constraints import Align, Drawing, Inline, Place, Triple
from floatsim.joints.coordinates import JointCoordinates, Slide, Turn


def _has_length(value: Triple) -> Triple:
    if max(abs(y) for y in value) == 0.0:
        raise ValueError("got (0, 0, 0); an axis needs a length")
    return value


Axis = Annotated[Vector3, AfterValidator(_has_length)]
Pair = Annotated[tuple[float, float], numbers("two finite numbers", 2)]


class CoordinateJoint(Ball):
    """Base of joints that have coordinates; these are outputs."""

    def children(self) -> list[Any]:
        return [JointCoordinates(name=f"{self.label}.coordinates", joint=self.label)]


class AxisJoint(CoordinateJoint):
    """Base of joints about or along an axis, given in the axes of b's body (the world's if b is a fixed point), any
    length. zero: the coordinate's value at the drawing position [m or rad]."""

    axis: Axis
    zero: Finite = 0.0


def triple(vector: Array) -> Triple:
    return float(vector[0]), float(vector[1]), float(vector[2])


def directions(axis: Triple) -> Array:
    """Rows: the axis as a unit vector and two normals, right-handed. (3, 3)"""
    e = np.asarray(axis) / math.hypot(*axis)
    n = np.cross(e, np.eye(3)[int(np.argmin(np.abs(e)))])
    n /= np.linalg.norm(n)
    return np.array([e, n, np.cross(e, n)])


def turned(vector: Array, axis: Array, angle: float) -> Array:
    """A vector normal to the unit `axis`, turned about it."""
    return np.asarray(math.cos(angle) * vector + math.sin(angle) * np.cross(axis, vector))


def require_rotation(joint: Ball, drawing: Drawing, place: Place, target: Target) -> None:
    """Raises ModelError for a line's end or a point mass, which has no attitude that the joint could hold."""
    if isinstance(target, str) and drawing(place.rotation) is None:
        raise ModelError(
            f"{type(joint).__name__} '{joint.label}': '{target}' has no rotation, it is not on a body; use Ball, Rod "
            "or PointOnLine, or Clamp for the end of a line"
        )


def relative(drawing: Drawing, a: Place, b: Place) -> Array:
    """R_A^T R_B at the drawing position: from B's frame to A's. (3, 3)"""
    return np.asarray(drawing.attitude(a).T @ drawing.attitude(b))


def parallel(drawing: Drawing, a: Place, b: Place, axis: Triple) -> list[Align]:
    """Two rows that keep the axis of A parallel to that of B."""
    e, n1, n2 = directions(axis)
    e_a = triple(relative(drawing, a, b) @ e)
    return [Align(a.rotation, e_a, b.rotation, triple(n)) for n in (n1, n2)]


def on_line(a: Place, b: Place, axis: Triple) -> list[Inline]:
    """Two rows that keep point A on the line of B."""
    _, n1, n2 = directions(axis)
    return [Inline(a, b, triple(n)) for n in (n1, n2)]


def slide(drawing: Drawing, a: Place, b: Place, axis: Triple, zero: float) -> Slide:
    """Coordinate along the axis; its value at the drawing position is `zero`."""
    e = directions(axis)[0]
    drawn = float((drawing.attitude(b) @ e) @ (drawing.position(a) - drawing.position(b)))
    return Slide(a, Place(b.point, b.rotation, triple(np.asarray(b.arm) + (drawn - zero) * e)), triple(e))


def turn(drawing: Drawing, a: Place, b: Place, axis: Any, zero: float, normal: Any = None) -> Turn:
    """Angle about the axis; `zero` at the drawing position. normal: of the two sides there, B's frame."""
    e, n, _ = directions(axis)
    n = n if normal is None else np.asarray(normal)
    return Turn(a, b, triple(e), triple(relative(drawing, a, b) @ n), triple(turned(n, e, -zero)))
