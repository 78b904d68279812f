"""Welds: two bodies, or a body and the ground, keep their relative pose of the drawing.

Three coinciding coordinates and three pairs of axes that stay normal. The end of a *line* has no
rotation of its own: clamping its direction is `floatsim.Clamp`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from floatsim.errors import ModelError
from floatsim.frames import Array
from floatsim.joints.ball import Ball
from floatsim.joints.constraints import Align, Coincide, Drawing, Place, Row

_PAIRS = ((1, 2), (2, 0), (0, 1))  # e_y . e_z, e_z . e_x, e_x . e_y


def weld_axes(a: Place, b: Place, R_a: Array, R_b: Array, drive: Any = None) -> list[Align]:
    """Three rows that keep the relative attitude of rotations a and b as it is in R_a, R_b."""
    rows = []
    for i, j in _PAIRS:
        axis_a = tuple(float(y) for y in R_a.T @ np.eye(3)[i])
        axis_b = tuple(float(y) for y in R_b.T @ np.eye(3)[j])
        rows.append(Align(a.rotation, axis_a, b.rotation, axis_b, drive))  # type: ignore[arg-type]
    return rows


class Weld(Ball):
    """Weld of body connection point `a` to `b` (a body's connection point) or to the ground (`b` a point).

    The relative attitude is that of the drawing. name: of the joint in outputs.
    """

    def rows(self, place: Callable[[Any], Place], drawing: Drawing) -> list[Row]:
        a, b = place(self.a), place(self.b)
        for target in (self.a, self.b):
            if isinstance(target, str) and drawing(place(target).rotation) is None:
                raise ModelError(
                    f"Weld '{self.label}': '{target}' has no rotation that could be welded; use Ball, or Clamp for "
                    "the end of a line"
                )
        return [Coincide(a, b), *weld_axes(a, b, drawing.attitude(a), drawing.attitude(b))]
