"""Clamped line ends: the end point is held by a ball joint, its direction by bending stiffness."""

from __future__ import annotations

from typing import Any

from pydantic import field_validator

from floatsim.description import Vector3
from floatsim.joints.ball import Ball
from floatsim.parts.end_bending import EndBending


class Clamp(Ball):
    """Line end `a` clamped at `b` (a body's connection point or a fixed point) along `direction`.

    direction: the way the line leaves the end, in the axes of b's body (or the world's), any length.
    """

    direction: Vector3

    @field_validator("direction")
    @classmethod
    def _has_length(cls, value: tuple[float, float, float]) -> tuple[float, float, float]:
        if max(abs(y) for y in value) == 0.0:
            raise ValueError("got (0, 0, 0); a direction needs a length")
        return value

    def children(self) -> list[Any]:
        return [EndBending(name=self.label, end=self.a, to=self.b, direction=self.direction)]
