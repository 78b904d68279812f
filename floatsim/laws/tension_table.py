"""Nonlinear elastic axial law: tension over engineering strain as a table, straight between its points.

    T = T(e) + c de/dt,        e = l/l0 - 1

Beyond the last point the last slope goes on. Below the first point the tension keeps its first value: a rope
whose table starts at (0, 0) carries no compression (a stiffness of a hundred-thousandth of the first slope is left,
so that statics of a slack rope are not singular).
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any, ClassVar

import numpy as np
from pydantic import model_validator

from floatsim.description import Description, Series
from floatsim.frames import Array
from floatsim.jit import kernel

LEFT = 1e-5  # of the first slope, below the table


@kernel
def table(x, y, value):  # type: ignore[no-untyped-def]
    """(y, dy/dx) of a table at `value`, straight between the points; the ends as said at the top of this file."""
    n = x.shape[0]
    if value < x[0]:
        k = LEFT * (y[1] - y[0]) / (x[1] - x[0])
        return y[0] + k * (value - x[0]), k
    i = 0
    while i < n - 2 and value > x[i + 1]:
        i += 1
    k = (y[i + 1] - y[i]) / (x[i + 1] - x[i])
    return y[i] + k * (value - x[i]), k


def integral(x: Array, y: Array, value: Array) -> Array:
    """Integral of `table` from its first point to each value."""
    steps = np.concatenate([[0.0], np.cumsum(0.5 * (y[1:] + y[:-1]) * np.diff(x))])
    i = np.clip(np.searchsorted(x, value) - 1, 0, len(x) - 2)
    slope = np.where(value < x[0], LEFT, 1.0) * (y[i + 1] - y[i]) / (x[i + 1] - x[i])
    e = value - x[i]
    return np.asarray(steps[i] + e * (y[i] + 0.5 * slope * e))


@kernel
def tension_table(x, y, c, s, rate, out):  # type: ignore[no-untyped-def]
    """out (3, n): T, dT/ds, dT/drate of elements at stretches s and rates with damping c, each (n,)."""
    for e in range(s.shape[0]):
        T, k = table(x, y, s[e] - 1.0)
        out[0, e], out[1, e], out[2, e] = T + c[e] * rate[e], k, c[e]


def rising(name: str, x: tuple[float, ...], y_name: str, y: tuple[float, ...]) -> None:
    """Raises ValueError unless x rises, y does not fall, and both have the same length of at least two."""
    if len(x) != len(y) or len(x) < 2:
        raise ValueError(f"{name} has {len(x)} values and {y_name} {len(y)}; both need the same number, at least two")
    for a, b in pairwise(x):
        if not a < b:
            raise ValueError(f"{name}: {a:g} is followed by {b:g}; the values must rise")
    for a, b in pairwise(y):
        if a > b:
            raise ValueError(
                f"{y_name}: {a:g} is followed by {b:g}; the values must not fall, a rope that pulls less the longer "
                "it is has no balance"
            )
    if y[0] == y[-1]:
        raise ValueError(f"{y_name}: all values are {y[0]:g}; they must rise somewhere")


class TensionTable(Description):
    """strain [-] (engineering, rising) and tension [N] (not falling), as many values of each, at least two; damping
    is the section's."""

    strain: Series
    tension: Series

    memory: ClassVar[int] = 0

    @model_validator(mode="after")
    def _usable(self) -> TensionTable:
        rising("strain", self.strain, "tension", self.tension)
        return self

    @property
    def stiffness(self) -> float:
        """Largest slope [N]."""
        return float(np.max(np.diff(self.tension) / np.diff(self.strain)))

    def bind(self, damping: Array) -> Any:
        """The law for elements with these dampings [N s]: a function (s, rate, old, new, h, out)."""
        x, y = np.array(self.strain), np.array(self.tension)

        def evaluate(s: Array, rate: Array, old: Array, new: Array, h: float, out: Array) -> None:
            tension_table(x, y, damping, s, rate, out)

        return evaluate

    def start(self, s: Array) -> Array:
        """No memory."""
        return np.zeros((0, len(s)))

    def energy(self, s: Array, new: Array) -> tuple[Array, Array]:
        """(energy stored [J/m], power lost besides the damper's [W/m]) per unstretched length, at the stretches s."""
        return integral(np.array(self.strain), np.array(self.tension), s - 1.0), np.zeros(len(s))
