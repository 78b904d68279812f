"""First guesses of a line's shape, from which statics start."""

from __future__ import annotations

import math

import numpy as np

from floatsim.frames import Array


def hanging_arc(a: Array, b: Array, arc_length: Array, depth: float) -> Array:
    """Points (n, 3) at unstretched arc lengths (n,) on a circular arc from a to b of the line's length, above the bed.

    Straight if the length does not exceed the span. A slack line drawn straight would be compressed by far more than
    its weight and start by folding; an arc has no strain at all. It hangs in the vertical plane of its ends; a line so
    slack that it could not stay above the bed even as an L is turned about its chord until it does.
    """
    length = float(arc_length[-1])
    s = (arc_length / length)[:, None]
    chord = b - a
    span = float(np.linalg.norm(chord))
    if length <= span * (1.0 + 1e-9) or span == 0.0:
        return (1.0 - s) * a + s * b
    from scipy.optimize import brentq

    half = brentq(lambda y: math.sin(y) / y - span / length, 1e-6, math.pi)  # half the angle of the arc
    radius = span / (2.0 * math.sin(half))
    along = chord / span
    across = np.cross(along, (0.0, 0.0, -1.0))
    across = np.array([0.0, 1.0, 0.0]) if np.linalg.norm(across) < 1e-6 else across / np.linalg.norm(across)
    down = np.cross(across, along)
    phi = half * (2.0 * s - 1.0)

    def turned(tilt: float) -> Array:
        sag = math.cos(tilt) * down + math.sin(tilt) * across
        return 0.5 * (a + b) + radius * (np.sin(phi) * along + (np.cos(phi) - math.cos(half)) * sag)

    slack = length > 0.99 * (abs(chord[2]) + math.hypot(chord[0], chord[1]))
    # a hair out of the vertical plane, because slack on the bed has to leave it
    tilts = np.radians(np.concatenate([[0.01], np.arange(5.0, 91.0, 5.0)])) if slack else np.array([0.0])
    shape = next((x for x in map(turned, tilts) if x[:, 2].min() >= -depth), turned(tilts[-1]))
    shape[1:-1, 2] = np.maximum(shape[1:-1, 2], -depth)  # an end below the bed is for `problems` to report
    return shape
