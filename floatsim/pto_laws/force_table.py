"""Force from a table over displacement and velocity, F(s, v).

linear: bilinear in each cell, tangent exact per cell. smooth: bicubic Hermite with slopes that do not overshoot
(Fritsch & Carlson 1980, SIAM J. Numerical Analysis 17, along either axis), so that the tangent is continuous. Outside
its range there is no force that anybody gave: a step that ends there is refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from pydantic import field_validator, model_validator

from floatsim.description import Description, Series, is_number
from floatsim.frames import Array
from floatsim.jit import kernel
from floatsim.pto_laws.law import Index, Now


@kernel
def _cell(x, at):  # type: ignore[no-untyped-def]
    """Index of the interval of x (n) that `at` is in, or the outermost."""
    low, high = 0, x.shape[0] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if x[middle] <= at:
            low = middle
        else:
            high = middle
    return low


@kernel
def _weights(y, width, smooth):  # type: ignore[no-untyped-def]
    """Weights of (value left, value right, slope left, slope right) at y in 0..1, then their derivatives."""
    if not smooth:
        return 1.0 - y, y, 0.0, 0.0, -1.0 / width, 1.0 / width, 0.0, 0.0
    z = 1.0 - y
    steep = 6.0 * y * z / width
    return (z * z * (1.0 + 2.0 * y), y * y * (1.0 + 2.0 * z), width * y * z * z, -width * y * y * z,
            -steep, steep, z * (1.0 - 3.0 * y), y * (3.0 * y - 2.0))  # fmt: skip


@kernel
def interpolate(x, y, T, smooth, s, v, out):  # type: ignore[no-untyped-def]
    """out: F and its derivatives by s and v. x (n), y (m): axes; T (4 n, m): F, F_s, F_v, F_sv at the nodes."""
    n = x.shape[0]
    i, j = _cell(x, s), _cell(y, v)
    a = _weights((s - x[i]) / (x[i + 1] - x[i]), x[i + 1] - x[i], smooth)
    b = _weights((v - y[j]) / (y[j + 1] - y[j]), y[j + 1] - y[j], smooth)
    out[0] = out[1] = out[2] = 0.0
    for p in range(4):
        for q in range(4):
            slopes = (1 if p > 1 else 0) + (2 if q > 1 else 0)
            f = T[slopes * n + i + p % 2, j + q % 2]
            out[0] += a[p] * b[q] * f
            out[1] += a[4 + p] * b[q] * f
            out[2] += a[p] * b[4 + q] * f


class ForceTable(Description):
    """Force from a table.

    displacement (n,) [m] and velocity (m,) [m/s], both increasing; force (n, m) [N]: force[i][j] on a, in the positive
    sense of the coordinate, at displacement[i] and velocity[j] (a damper's is negative at positive velocities).
    interpolation: "smooth" (continuous derivatives) or "linear". Along a turn: rad, rad/s, N m.
    A run that leaves the table's range fails with a message.
    """

    displacement: Series
    velocity: Series
    force: Any
    interpolation: Literal["smooth", "linear"] = "smooth"

    @field_validator("force")
    @classmethod
    def _of_numbers(cls, value: Any) -> tuple[tuple[float, ...], ...]:
        try:
            rows = tuple(tuple(row) for row in value)
        except TypeError:
            raise ValueError(f"got {value!r:.60}; rows of numbers are allowed, one row per displacement") from None
        for i, row in enumerate(rows):
            for j, y in enumerate(row):
                if not is_number(y):
                    raise ValueError(f"row {i}, column {j} is {y!r}; finite numbers are allowed")
        return tuple(tuple(float(y) for y in row) for row in rows)

    @model_validator(mode="after")
    def _fits(self) -> ForceTable:
        for name, axis in (("displacement", self.displacement), ("velocity", self.velocity)):
            if len(axis) < 2:
                raise ValueError(f"{name} has {len(axis)} values; at least 2 are needed")
            for k, (low, high) in enumerate(zip(axis, axis[1:])):
                if not low < high:
                    raise ValueError(f"{name} does not increase from value {k} ({low:g}) to value {k + 1} ({high:g})")
        n, m = len(self.displacement), len(self.velocity)
        widths = sorted({len(row) for row in self.force})
        if len(self.force) != n or widths != [m]:
            raise ValueError(f"force has {len(self.force)} rows of {widths} values; {n} rows (displacements) of {m} "
                             "(velocities) are needed")  # fmt: skip
        return self

    @staticmethod
    def group() -> type[Any]:
        return Tables

    def nodes(self) -> Array:
        """F, F_s, F_v, F_sv at the nodes (4 n, m)."""
        F = np.array(self.force)
        if self.interpolation == "linear":
            return np.concatenate([F, np.zeros_like(F), np.zeros_like(F), np.zeros_like(F)])
        from scipy.interpolate import PchipInterpolator

        x, y = np.array(self.displacement), np.array(self.velocity)
        Fs = PchipInterpolator(x, F, axis=0)(x, 1)
        Fv = PchipInterpolator(y, F, axis=1)(y, 1)
        return np.concatenate([F, Fs, Fv, PchipInterpolator(y, Fs, axis=1)(y, 1)])


class Tables:
    """All tables: few, each with axes of its own."""

    def __init__(self, laws: Sequence[ForceTable], which: Index, labels: Sequence[str]) -> None:
        self.laws, self.which, self.labels = tuple(laws), which, tuple(labels)
        self._tables = [
            (np.array(t.displacement), np.array(t.velocity), t.nodes(), t.interpolation == "smooth") for t in laws
        ]
        self._out = np.zeros(3)

    def add(self, now: Now, F: Array) -> str | None:
        """Add forces and derivatives to F (3, n)."""
        trouble = None
        for (x, y, T, smooth), e, label in zip(self._tables, self.which, self.labels, strict=True):
            s, v = float(now.s[e]), float(now.v[e])
            for name, axis, value in (("displacement", x, s), ("velocity", y, v)):
                if not axis[0] <= value <= axis[-1]:
                    trouble = (f"PTO '{label}': its {name} is {value:.6g}, outside its table from {axis[0]:g} to "
                               f"{axis[-1]:g}")  # fmt: skip
            # inside, Newton may look a little beyond the edge on its way: the edge's force, and its slopes
            s_in, v_in = min(max(s, x[0]), x[-1]), min(max(v, y[0]), y[-1])
            interpolate(x, y, T, smooth, s_in, v_in, self._out)
            f, fs, fv = self._out
            F[0, e] += f + fs * (s - s_in) + fv * (v - v_in)
            F[1, e] += fs
            F[2, e] += fv
        return trouble
