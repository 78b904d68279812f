"""Nonlinear elastic bending: moment over curvature as a table, straight between its points.

Between two elements each half bends with its own section, so at a moment M the angle of the pair is

    theta(M) = l_a/2 kappa_a(M) + l_b/2 kappa_b(M),

again a table. The section's EI is not used where a table is given.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from pydantic import model_validator

from floatsim.description import Description, Series
from floatsim.frames import Array


class MomentTable(Description):
    """curvature [1/m] and moment [N m], both from 0 and rising; the last slope goes on beyond the table."""

    curvature: Series
    moment: Series

    @model_validator(mode="after")
    def _usable(self) -> MomentTable:
        x, y = self.curvature, self.moment
        if len(x) != len(y) or len(x) < 2:
            raise ValueError(f"curvature has {len(x)} values and moment {len(y)}; both need the same, at least two")
        for name, row in (("curvature", x), ("moment", y)):
            if row[0] != 0.0:
                raise ValueError(f"{name}: the first value is {row[0]:g}; the values must start at 0 and rise")
            for a, b in pairwise(row):
                if not a < b:
                    raise ValueError(f"{name}: {a:g} is followed by {b:g}; the values must start at 0 and rise")
        return self

    @property
    def stiffness(self) -> float:
        """First slope EI [N m2]."""
        return self.moment[1] / self.curvature[1]


def pair_table(lengths: tuple[float, float], bending: tuple[MomentTable | float, MomentTable | float]) -> Array:
    """(2, n) angle [rad] and moment [N m] of two half elements in a row, each with a table or a constant EI."""
    moments = sorted({m for law in bending if isinstance(law, MomentTable) for m in law.moment})
    M = np.array([*moments, 2.0 * moments[-1]])
    theta = np.zeros(len(M))
    for length, law in zip(lengths, bending, strict=True):
        if isinstance(law, MomentTable):
            x, y = np.array(law.curvature), np.array(law.moment)
            slope = (y[-1] - y[-2]) / (x[-1] - x[-2])
            theta += 0.5 * length * np.where(y[-1] >= M, np.interp(M, y, x), x[-1] + (M - y[-1]) / slope)
        else:
            theta += 0.5 * length * M / law
    return np.array([theta, M])


def pad_tables(tables: list[Array]) -> Array:
    """Tables (2, m_k) as one array (n, 2, m); shorter ones go on straight."""
    width = max((t.shape[1] for t in tables), default=2)
    out = np.zeros((len(tables), 2, width))
    for row, t in enumerate(tables):
        more = np.arange(1, width - t.shape[1] + 1)
        out[row] = np.hstack([t, t[:, -1:] + (t[:, -1:] - t[:, -2:-1]) * more])
    return out
