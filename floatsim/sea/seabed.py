"""The seabed under lines: flat, sloping or from a grid of heights; a normal spring-damper and Coulomb friction.

    normal     p = pen (k - c/pen_c v_n) on the area d l0, pen = (z_bed - z) cos(slope), never pulling
    friction   F = - N (mu_a u_a e_a + mu_n u_n e_n)/s,   u = x - x_stick in the bed's plane, |u| <= s

Friction is elastic-plastic in displacement: linear up to mu N over the slip length s; when |u| would exceed s the
stick point is dragged along. The stick point is history and moves only when a step is accepted. e_a is the line's
direction at the start of the step; with one slip length for both directions the sliding force lies on the
ellipse with half axes mu_a N and mu_n N. In statics there is no friction unless asked for.

Sources: Hunt & Crossley (1975), Journal of Applied Mechanics 42, for the damper that grows with penetration; Simo &
Hughes, Computational Inelasticity (1998), chapter 2, for the return to the yield surface.
"""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, model_validator

from floatsim.description import LARGEST, Description, NonNegative, Positive, Series, is_number, numbers
from floatsim.frames import Array, cross, dot, minus, times
from floatsim.jit import kernel

# entries of the bed's parameters
Z0, SLOPE_X, SLOPE_Y, STIFFNESS, DAMPING, SLIP, GRID_X, GRID_DX, GRID_Y, GRID_DY = range(10)


def _heights(value: Any) -> Any:
    allowed = "must be rows of finite numbers, at least 2 x 2, all of one length"
    try:
        rows = np.asarray(value)
    except ValueError:
        raise ValueError(f"its rows differ in length; {allowed}") from None
    if rows.ndim != 2 or min(rows.shape) < 2:
        raise ValueError(f"got an array of shape {rows.shape}; {allowed}")
    if rows.dtype.kind not in "iuf" or not np.all(np.abs(rows) <= LARGEST):
        raise ValueError(f"not all are finite numbers; {allowed}")
    return tuple(tuple(float(z) for z in row) for row in rows)


class Bathymetry(Description):
    """Heights of the bed on a grid; beyond its edges the bed goes on level, at the height of the nearest edge.

    x, y [m]: evenly spaced, rising. z [m]: one row for every x, heights above mean sea level (negative).
    Between the points a cubic convolution (Keys 1981) runs through them with a continuous slope.
    """

    x: Series
    y: Series
    z: Annotated[tuple[tuple[float, ...], ...], BeforeValidator(_heights)]

    @model_validator(mode="after")
    def _regular(self) -> Bathymetry:
        for name, row, n in (("x", self.x, len(self.z)), ("y", self.y, len(self.z[0]))):
            steps = np.diff(row)
            if len(row) != n:
                raise ValueError(f"{name} has {len(row)} values, z has {n}; they must be as many")
            if not np.all(steps > 0.0) or np.ptp(steps) > 1e-6 * steps[0]:
                raise ValueError(
                    f"{name}: got steps of {steps.min():g} to {steps.max():g} m; the values must rise in even steps"
                )
        return self


class Seabed(Description):
    """Seabed under lines.

    stiffness [Pa/m]: pressure per penetration, acting on diameter times length; damping [Pa s/m]: the
    same for the velocity, reached at a penetration of damping_penetration [m] and proportional to it, so that
    touching down and lifting off are continuous. The bed never pulls. friction [-]: Coulomb's coefficient across
    the line, friction_axial [-]: along it (default: the same); slip_length [m]: see above. slope [-]: (dz/dx, dz/dy)
    of a plane bed that is at z = -depth at the origin; bathymetry: a grid of heights instead.
    Stiffness and damping default to those of the public VolturnUS-S mooring deck.
    """

    stiffness: Positive = 3.0e6
    damping: NonNegative = 3.0e5
    damping_penetration: Positive = 0.05
    friction: NonNegative = 0.0
    friction_axial: NonNegative | None = None
    slip_length: Positive = 0.1
    slope: Annotated[tuple[float, float], numbers("two finite numbers (dz/dx, dz/dy)", 2)] = (0.0, 0.0)
    bathymetry: Bathymetry | None = None

    @model_validator(mode="after")
    def _one_shape(self) -> Seabed:
        if self.bathymetry is not None and any(self.slope):
            raise ValueError("give slope or bathymetry, not both")
        return self

    def coefficients(self) -> tuple[float, float]:
        """Friction (along, across)."""
        return (self.friction if self.friction_axial is None else self.friction_axial, self.friction)

    def parameters(self, depth: float) -> tuple[Array, Array]:
        """What kernels read: parameters (10,) and heights (n_x, n_y) (empty without a grid)."""
        grid, cells = np.zeros((0, 0)), (0.0, 1.0, 0.0, 1.0)
        if self.bathymetry is not None:
            b = self.bathymetry
            grid = np.array(b.z)
            cells = (b.x[0], (b.x[-1] - b.x[0]) / (len(b.x) - 1), b.y[0], (b.y[-1] - b.y[0]) / (len(b.y) - 1))
        own = (-depth, *self.slope, self.stiffness, self.damping / self.damping_penetration, self.slip_length)
        return np.array([*own, *cells]), grid

    def height(self, x: float, y: float, depth: float) -> float:
        """z of the bed [m] at (x, y) in water of `depth`."""
        bed, grid = self.parameters(depth)
        return float(bed_height(bed, grid, float(x), float(y))[0])


@kernel
def _weights(f):  # type: ignore[no-untyped-def]
    """Keys's cubic convolution at 0 <= f <= 1 between the middle two of four points: weights and their slopes."""
    a, b, c = f, f * f, f * f * f
    return (
        (-0.5 * a + b - 0.5 * c, 1.0 - 2.5 * b + 1.5 * c, 0.5 * a + 2.0 * b - 1.5 * c, -0.5 * b + 0.5 * c),
        (-0.5 + 2.0 * a - 1.5 * b, -5.0 * a + 4.5 * b, 0.5 + 4.0 * a - 4.5 * b, -a + 1.5 * b),
    )


@kernel
def bed_height(bed, grid, x, y):  # type: ignore[no-untyped-def]
    """(z, dz/dx, dz/dy) of the bed at (x, y)."""
    nx, ny = grid.shape
    if nx == 0:
        return bed[Z0] + bed[SLOPE_X] * x + bed[SLOPE_Y] * y, bed[SLOPE_X], bed[SLOPE_Y]
    p, q = (x - bed[GRID_X]) / bed[GRID_DX], (y - bed[GRID_Y]) / bed[GRID_DY]
    inside_x, inside_y = 0.0 < p < nx - 1, 0.0 < q < ny - 1
    p, q = min(max(p, 0.0), nx - 1.0), min(max(q, 0.0), ny - 1.0)
    i, j = min(int(p), nx - 2), min(int(q), ny - 2)
    wx, sx = _weights(p - i)
    wy, sy = _weights(q - j)
    z = zx = zy = 0.0
    for m in range(4):
        for n in range(4):
            h = _beyond(grid, i + m - 1, j + n - 1)
            z += wx[m] * wy[n] * h
            zx += sx[m] * wy[n] * h
            zy += wx[m] * sy[n] * h
    return z, (zx / bed[GRID_DX] if inside_x else 0.0), (zy / bed[GRID_DY] if inside_y else 0.0)


@kernel
def _beyond(grid, i, j):  # type: ignore[no-untyped-def]
    """Height at (i, j); one cell outside the grid it is continued straight, so that planes stay planes."""
    nx, ny = grid.shape
    if i < 0:
        return 2.0 * _beyond_y(grid, 0, j) - _beyond_y(grid, 1, j)
    if i > nx - 1:
        return 2.0 * _beyond_y(grid, nx - 1, j) - _beyond_y(grid, nx - 2, j)
    return _beyond_y(grid, i, j)


@kernel
def _beyond_y(grid, i, j):  # type: ignore[no-untyped-def]
    ny = grid.shape[1]
    if j < 0:
        return 2.0 * grid[i, 0] - grid[i, 1]
    if j > ny - 1:
        return 2.0 * grid[i, ny - 1] - grid[i, ny - 2]
    return grid[i, j]


@kernel
def in_plane(n, a):  # type: ignore[no-untyped-def]
    """The part of a normal to n."""
    return minus(a, times(dot(a, n), n))


@kernel
def touch(z, zx, zy, stiffness, damping, x, v, area):  # type: ignore[no-untyped-def]
    """(lift [N], normal n, dlift/dpen, -dlift/dv_n) of an area of line at x moving with v; lift 0: no contact.

    z, zx, zy: height and slopes of the bed there; damping per penetration. Numbers instead of the arrays they come
    from: an array handed to a function that is not inlined costs more than the contact itself.
    """
    slant = 1.0 / math.sqrt(1.0 + zx * zx + zy * zy)
    n = (-zx * slant, -zy * slant, slant)
    pen = (z - x[2]) * slant
    if pen <= 0.0:
        return 0.0, n, 0.0, 0.0
    k = stiffness - damping * dot(v, n)
    return max(area * pen * k, 0.0), n, area * k, area * pen * damping


@kernel
def friction(x, n, stick, direction, slip, mu_a, mu_n):  # type: ignore[no-untyped-def]
    """(g, u, e_a, e_n, |u|/s) with friction = -lift g, g = D u q/s, D = mu_a e_a e_a^T + mu_n e_n e_n^T,
    q = min(1, s/|u|). stick, direction: 3-tuples, the stick point and the line's direction."""
    u = in_plane(n, minus(x, stick))
    ea = in_plane(n, direction)
    size = math.sqrt(dot(ea, ea))
    if size <= 1e-6:  # the line stands upright on the bed: any direction will do
        ea = in_plane(n, (1.0, 0.0, 0.0))
        size = math.sqrt(dot(ea, ea))
    ea = times(1.0 / size, ea)
    en = cross(n, ea)
    r = math.sqrt(dot(u, u)) / slip
    q = 1.0 / (max(r, 1.0) * slip)
    ua, un = mu_a * dot(u, ea) * q, mu_n * dot(u, en) * q
    return (ua * ea[0] + un * en[0], ua * ea[1] + un * en[1], ua * ea[2] + un * en[2]), u, ea, en, r


def check_friction(value: Any) -> Any:
    """A section's own friction: None, a number or (along, across)."""
    if value is None:
        return None
    pair = isinstance(value, list | tuple) or (isinstance(value, np.ndarray) and value.ndim > 0)
    row = tuple(value) if pair else (value, value)
    if len(row) != 2 or not all(is_number(y) and 0.0 <= y <= LARGEST for y in row):
        raise ValueError(f"got {value!r:.60}; must be a number that is not negative or two of them, (along, across)")
    return (float(row[0]), float(row[1]))
