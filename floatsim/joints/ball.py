"""Ball joints: two connection points coincide, rotations are free."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from floatsim.description import Description, Name, Target
from floatsim.joints.constraints import Coincide, Drawing, Place, Row


def default_label(target: str) -> str:
    """Name of a joint that was given none; never the name of the part itself."""
    return target.replace(".", "_") if "." in target else f"{target}_joint"


class Ball(Description):
    """Ball joint between `a` and `b`: names of connection points, or b a fixed point (x, y, z) [m].

    name: of the joint in outputs; default: `a` with dots as underscores, PART_joint for a part's own
    point. The joint's force is what a exerts on b.
    """

    a: str
    b: Target
    name: Name | None = None

    @property
    def label(self) -> str:
        return self.name or default_label(self.a)

    def targets(self) -> tuple[str | tuple[float, float, float], ...]:
        """Connection points that must resolve."""
        return (self.a, self.b)

    def ties(self) -> list[tuple[Any, Any]]:
        """Pairs that start at the same place."""
        return [(self.a, self.b)]

    def rows(self, place: Callable[[Any], Place], drawing: Drawing) -> list[Row]:
        """The constraint rows, declared."""
        return [Coincide(place(self.a), place(self.b))]

    def children(self) -> list[Any]:
        """Parts that belong to the joint."""
        return []
