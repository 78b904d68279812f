"""Coordinates of joints and between points: scalars s(q) that outputs, springs, dampers and locks refer to.

    Slide      s = (R_B e) . (p_A - p_B)                        displacement of A along an axis of B
    Turn       s = angle of A about an axis of B, from n_B to n_A, both normal to the axis when the joint is closed
    Distance   s = |p_B - p_A|
"""

from __future__ import annotations

from typing import NamedTuple

from floatsim.joints.constraints import Place


class Slide(NamedTuple):
    """Displacement of point A along `axis`, which is fixed in B (B's frame, unit length)."""

    a: Place
    b: Place
    axis: tuple[float, float, float]


class Turn(NamedTuple):
    """Angle of A about `axis` of B: from `normal_b` (B's frame) to `normal_a` (A's frame), right-handed about axis."""

    a: Place
    b: Place
    axis: tuple[float, float, float]
    normal_a: tuple[float, float, float]
    normal_b: tuple[float, float, float]


class Distance(NamedTuple):
    """Distance between the points A and B."""

    a: Place
    b: Place
