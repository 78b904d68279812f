"""Power and thrust coefficients of a rotor over tip-speed ratio and blade pitch.

With u the wind along the shaft relative to the hub, O the rotor's speed, R its radius, l = O R/u:

    T = 1/2 rho pi R^2 u^2 C_T(l, pitch),        Q = 1/2 rho pi R^3 u^2 C_P(l, pitch)/l

Between the given points the surface is the tensor-product cubic spline, evaluated cell by cell from values, both slopes
and the cross derivative at the corners: smooth, and with exact derivatives for Newton. Beyond the last tip-speed ratios
and pitch angles it goes on in a straight line; below the smallest ratio (a rotor being started) with the torque
coefficient C_P/l of the edge. There are no loads without wind from ahead (u <= 0).
"""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from pydantic import Field, field_validator, model_validator

from floatsim.description import Description, Items, Positive, Series, is_number
from floatsim.frames import Array
from floatsim.jit import kernel

# layout of the array of a surface: rows of tip-speed ratios, columns of pitch angles
_DEPTH = 8  # C_P, its slopes along both axes and cross derivative, then the same of C_T


class PerformanceSurface(Description):
    """C_P and C_T of a rotor of `radius` [m].

    tip_speed_ratio (n,) and pitch_deg (m,): increasing, at least four of each. power, thrust: n rows of m values.
    """

    radius: Positive
    tip_speed_ratio: Annotated[Series, Field(min_length=4)]
    pitch_deg: Annotated[Series, Field(min_length=4)]
    power: Items
    thrust: Items

    @field_validator("power", "thrust")
    @classmethod
    def _rows(cls, value: Any) -> Any:
        rows = tuple(tuple(row) if isinstance(row, list | tuple | np.ndarray) else () for row in value)
        if not all(all(map(is_number, row)) for row in rows):
            raise ValueError("got something that is no finite number; rows of finite numbers are allowed")
        return tuple(tuple(float(y) for y in row) for row in rows)

    @model_validator(mode="after")
    def _consistent(self) -> PerformanceSurface:
        for name in ("tip_speed_ratio", "pitch_deg"):
            if not np.all(np.diff(getattr(self, name)) > 0.0):
                raise ValueError(f"{name} must increase")
        if self.tip_speed_ratio[0] <= 0.0:
            raise ValueError(f"tip_speed_ratio begins at {self.tip_speed_ratio[0]:g}; it must be positive")
        n, m = len(self.tip_speed_ratio), len(self.pitch_deg)
        for name in ("power", "thrust"):
            table = getattr(self, name)
            if len(table) != n or any(len(row) != m for row in table):
                got = f"{len(table)} rows of {sorted({len(row) for row in table})} values"
                raise ValueError(f"{name} has {got}; {n} rows (tip-speed ratios) of {m} (pitch angles) are needed")
        return self

    def packed(self) -> tuple[Array, Array, Array]:
        """(table (n, m, 8), tip-speed ratios (n,), pitch angles (m,) [rad]) for `coefficients`."""
        from scipy.interpolate import CubicSpline

        x, y = np.array(self.tip_speed_ratio), np.radians(self.pitch_deg)
        table = np.zeros((len(x), len(y), _DEPTH))
        for k, values in enumerate((self.power, self.thrust)):
            f = np.array(values)
            across = CubicSpline(y, f, axis=1)(y, 1)
            table[:, :, 4 * k] = f
            table[:, :, 4 * k + 1] = CubicSpline(x, f, axis=0)(x, 1)
            table[:, :, 4 * k + 2] = across
            table[:, :, 4 * k + 3] = CubicSpline(x, across, axis=0)(x, 1)
        return table, x, y


@kernel
def _cell(grid, x):  # type: ignore[no-untyped-def]
    """Index of the interval of `grid` that holds x."""
    low, high = 0, grid.shape[0] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if grid[middle] <= x:
            low = middle
        else:
            high = middle
    return low


@kernel
def _hermite(s):  # type: ignore[no-untyped-def]
    """Cubic Hermite basis at the share s of an interval: of both values, of both slopes; then the derivatives."""
    q = 1.0 - s
    return ((1.0 + 2.0 * s) * q * q, s * s * (3.0 - 2.0 * s), s * q * q, -s * s * q,
            -6.0 * s * q, 6.0 * s * q, q * (1.0 - 3.0 * s), s * (3.0 * s - 2.0))  # fmt: skip


@kernel
def _bicubic(table, i, j, k, hx, hy, p, q):  # type: ignore[no-untyped-def]
    """Value and derivatives along both axes in the cell (i, j); p, q: `_hermite` of both shares."""
    f = fx = fy = 0.0
    for m in range(2):
        for n in range(2):
            v, vx, vy, vxy = (table[i + m, j + n, k], hx * table[i + m, j + n, k + 1],
                              hy * table[i + m, j + n, k + 2], hx * hy * table[i + m, j + n, k + 3])  # fmt: skip
            a, da, b, db = p[m], p[4 + m], p[2 + m], p[6 + m]
            c, dc, d, dd = q[n], q[4 + n], q[2 + n], q[6 + n]
            f += c * (a * v + b * vx) + d * (a * vy + b * vxy)
            fx += c * (da * v + db * vx) + d * (da * vy + db * vxy)
            fy += dc * (a * v + b * vx) + dd * (a * vy + b * vxy)
    return f, fx / hx, fy / hy


@kernel
def coefficients(table, x, y, ratio, pitch):  # type: ignore[no-untyped-def]
    """(C_Q, its derivative by tip-speed ratio, by pitch; the same of C_T), C_Q = C_P/ratio."""
    inside, level = min(max(ratio, x[0]), x[-1]), min(max(pitch, y[0]), y[-1])
    i, j = _cell(x, inside), _cell(y, level)
    hx, hy = x[i + 1] - x[i], y[j + 1] - y[j]
    p, q = _hermite((inside - x[i]) / hx), _hermite((level - y[j]) / hy)
    P, Px, Py = _bicubic(table, i, j, 0, hx, hy, p, q)
    T, Tx, Ty = _bicubic(table, i, j, 4, hx, hy, p, q)
    T += Tx * (ratio - inside) + Ty * (pitch - level)
    if ratio < x[0]:
        return (P + Py * (pitch - level)) / x[0], 0.0, Py / x[0], T, Tx, Ty
    P += Px * (ratio - inside) + Py * (pitch - level)
    return P / ratio, (Px - P / ratio) / ratio, Py / ratio, T, Tx, Ty


@kernel
def loads(table, x, y, pressure_area, radius, u, speed, pitch):  # type: ignore[no-untyped-def]
    """(Q, dQ/du, dQ/dspeed, dQ/dpitch, T, dT/du, dT/dspeed, dT/dpitch); pressure_area: rho pi R^2/2."""
    if u <= 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    ratio = speed * radius / u
    C, Cx, Cy, D, Dx, Dy = coefficients(table, x, y, ratio, pitch)
    a, b = pressure_area * u, pressure_area * u * radius
    return (b * u * C, b * (2.0 * C - ratio * Cx), b * radius * Cx, b * u * Cy,
            a * u * D, a * (2.0 * D - ratio * Dx), b * Dx, a * u * Dy)  # fmt: skip
