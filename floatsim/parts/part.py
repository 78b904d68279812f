"""What a part tells the model and the system; the defaults are those of a part without points of its own."""

from __future__ import annotations

from typing import Any, ClassVar, NamedTuple

import numpy as np

from floatsim.description import Description
from floatsim.frames import Array

Anchor = tuple[int, int, tuple[float, float, float]]


class Output(NamedTuple):
    """A channel that a batch fills: one number, or a vector in world axes if dims is ("xyz",)."""

    name: str
    long_name: str
    units: str
    dims: tuple[str, ...] = ()

    @property
    def size(self) -> int:
        """How many numbers it is."""
        return 3 if self.dims else 1


class Part(Description):
    """Base of parts. n_rotations: how many rotations it brings; `batch()` names the class that computes it."""

    name: Any

    n_rotations: ClassVar[int] = 0

    @property
    def n_points(self) -> int:
        """How many points it brings."""
        return 0

    @staticmethod
    def batch() -> type[Any]:
        """The class that evaluates all parts of this kind (protocol: system/system.py)."""
        raise TypeError("a part names its batch")

    def anchors(self) -> dict[str, Anchor]:
        """Connection points: name -> (local point, local rotation or -1, arm in the body frame); '' is the part."""
        return {}

    @property
    def between(self) -> tuple[Any, ...]:
        """The two connection points or fixed points that it acts between, `a` and `b`, or the one that it acts on."""
        return ()

    def children(self) -> list[Any]:
        """Parts that come with this one."""
        return []

    def internal_balls(self) -> list[tuple[int, int]]:
        """Pairs of its own points that ball joints tie together."""
        return []

    def place(self, ends: dict[str, Array], sea: Any) -> tuple[Array, Array] | None:
        """Points (n, 3) and rotation matrices (m, 3, 3) at the drawing position; None while unknown.

        ends: where the anchors stand that joints tie to something already placed.
        """
        return np.empty((0, 3)), np.empty((0, 3, 3))

    def held_wrongly(self, joints: Any) -> list[str]:
        """What its joints do not give it that it needs: a list of sentences."""
        return []

    def problems(self, ends: dict[str, Array], sea: Any) -> list[str]:
        """What only shows in the model: ends as placed, the sea."""
        return []
