"""Prescribed motion of a connection point or of a whole body.

Position, velocity and acceleration must belong together: they come from three functions, or from a
recorded series through C2 cubic splines (accelerations recovered from the integrator's own formula
are wrong by O(1)). Attitude as roll, pitch, yaw with R_WB = Rz(yaw) Ry(pitch) Rx(roll):

    w = yaw' e_z + Rz (pitch' e_y) + Rz Ry (roll' e_x)
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from floatsim.description import Description, Name, is_number
from floatsim.errors import ModelError
from floatsim.frames import Array, matrix_from_angles
from floatsim.joints.ball import default_label
from floatsim.joints.constraints import Coincide, Drawing, Place, Row
from floatsim.joints.weld import weld_axes

Function = Callable[[float], ArrayLike]


class Motion:
    """Motion of a point (3 columns) or of a body (6: x, y, z [m], roll, pitch, yaw [rad]) over time [s].

    position, velocity, acceleration: functions of time, each giving all columns; velocity and
    acceleration are the time derivatives of the columns. ModelError if they do not belong together.
    """

    def __init__(self, position: Function, velocity: Function, acceleration: Function) -> None:
        for name, function in zip(("position", "velocity", "acceleration"), (position, velocity, acceleration)):
            if not callable(function):
                raise ModelError(f"Motion: {name}: got {function!r}; must be a function of time (or use from_series)")
        self._functions = (position, velocity, acceleration)
        self._last: tuple[float, Any] = (math.nan, None)  # a body's joint asks four times for the same instant
        self._ends = np.inf  # end of a recording that ends in motion
        first = _values(position, "position", 0.0)
        if first.shape not in ((3,), (6,)):
            raise ModelError(f"Motion: position(0) has shape {first.shape}; 3 (point) or 6 (body) numbers are allowed")
        self.columns, self.start = len(first), first
        self._check()

    @classmethod
    def from_series(cls, time: Sequence[float] | Array, values: ArrayLike) -> Motion:
        """Through samples: time (n,) increasing [s], values (n, 3) or (n, 6), angles continuous [rad].

        C2 cubic spline; held at the first and last sample outside the recording. A run that goes beyond a recording
        that ends in motion fails with a message: stopping dead would be an impact that nobody recorded.
        """
        from scipy.interpolate import CubicSpline

        try:
            t, y = np.asarray(time, dtype=float), np.asarray(values, dtype=float)
        except (TypeError, ValueError) as error:
            raise ModelError(f"Motion.from_series: time and values must be arrays of numbers: {error}") from None
        if t.ndim != 1 or len(t) < 4 or y.shape not in ((len(t), 3), (len(t), 6)):
            raise ModelError(
                f"Motion.from_series: got time {t.shape} and values {y.shape}; (n,) and (n, 3) or (n, 6), n >= 4"
            )
        if not (np.isfinite(t).all() and np.isfinite(y).all()):
            raise ModelError("Motion.from_series: the recording contains NaN or infinity")
        if not (np.diff(t) > 0.0).all():
            k = int(np.argmin(np.diff(t) > 0.0))
            raise ModelError(f"Motion.from_series: time does not increase after sample {k} (t = {t[k]:g} s)")
        spline = CubicSpline(t, y)

        def held(order: int) -> Function:
            def value(now: float) -> Array:
                if not t[0] <= now <= t[-1] and order > 0:
                    return np.zeros(y.shape[1])
                return np.asarray(spline(min(max(now, t[0]), t[-1]), order))

            return value

        motion = cls(held(0), held(1), held(2))
        rate = np.abs(spline(t, 1))
        if np.any(rate[-1] > 1e-3 * rate.max()):
            motion._ends = float(t[-1])
        return motion

    @classmethod
    def at_speed(cls, start: Sequence[float], end: Sequence[float], speed: float, ramp: float = 10.0) -> Motion:
        """Straight from `start` to `end` (x, y, z) [m] at a constant speed [m/s], then at rest.

        The speed grows and falls as u = v (t/T - sin(2 pi t/T)/(2 pi)) over T = ramp [s], so that accelerations are
        continuous; a way too short for two ramps takes shorter ones. The way to let a line find its shape dynamically,
        by leading its end from where it hangs simply to where it belongs, and to pay out slow offsets.
        """
        try:
            a, b = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
        except (TypeError, ValueError):
            a = b = np.zeros(0)
        good = a.shape == b.shape == (3,) and bool(np.isfinite([a, b]).all())
        if not good or not is_number(speed) or not speed > 0.0 or not is_number(ramp) or not ramp > 0.0:
            raise ModelError(
                f"Motion.at_speed: got start {start!r}, end {end!r}, speed {speed!r}, ramp {ramp!r}; two points "
                "(x, y, z) and positive numbers are allowed"
            )
        way = float(np.linalg.norm(b - a))
        T = min(ramp, way / speed)
        along = (b - a) / way if way > 0.0 else np.zeros(3)
        lasts = way / speed + T  # two ramps cover speed T together
        w = 2.0 * math.pi / T if T > 0.0 else 1.0

        def grown(t: float) -> tuple[float, float, float]:  # on the first ramp
            return (
                speed * (0.5 * t * t / T + (math.cos(w * t) - 1.0) / (w * w * T)),
                speed * (t / T - math.sin(w * t) / (w * T)), speed * (1.0 - math.cos(w * t)) / T,
            )  # fmt: skip

        def path(t: float) -> tuple[float, float, float]:
            if t <= 0.0 or way == 0.0:
                return 0.0, 0.0, 0.0
            if t >= lasts:
                return way, 0.0, 0.0
            if t < T:
                return grown(t)
            if t <= lasts - T:
                return speed * (t - 0.5 * T), speed, 0.0
            s, u, rate = grown(lasts - t)
            return way - s, u, -rate

        return cls(lambda t: a + path(t)[0] * along, lambda t: path(t)[1] * along, lambda t: path(t)[2] * along)

    def _check(self) -> None:
        h = 1e-4
        for order, name in ((0, "velocity"), (1, "acceleration")):
            low, high = self._functions[order], self._functions[order + 1]
            for t in (0.37, 1.73, 7.91):
                before = "position" if order == 0 else "velocity"
                slope = (_values(low, before, t + h) - _values(low, before, t - h)) / (2.0 * h)
                given = _values(high, name, t)
                if given.shape != (self.columns,):
                    raise ModelError(f"Motion: {name} gives shape {given.shape}, position has {self.columns} columns")
                if not np.all(np.abs(slope - given) <= 1e-3 * np.max(np.abs(given)) + 1e-4):
                    raise ModelError(
                        f"Motion: {name}({t:g}) is {given.tolist()} but differences of {before} give "
                        f"{slope.round(6).tolist()}; the three functions must belong together"
                    )

    def identity(self) -> Any:
        """What a checkpoint knows it by."""
        return self._functions, self._ends

    def _columns(self, t: float) -> Array:
        if t > self._ends + 1e-6:
            raise ModelError(
                f"Motion.from_series: the recording ends at {self._ends:g} s while still moving, but the run goes on; "
                "end the run earlier, or let the recording come to rest"
            )
        if t != self._last[0]:
            try:
                rows = np.array([f(t) for f in self._functions], dtype=float)
                good = rows.shape == (3, self.columns) and math.isfinite(float(rows.sum()))
            except Exception:  # said below, with the name of the function
                good = False
            if not good:
                names = ("position", "velocity", "acceleration")
                rows = np.array([_values(f, name, t) for f, name in zip(self._functions, names, strict=True)])
            self._last = (t, rows)
        return self._last[1]

    def translation(self, t: float) -> tuple[Array, Array, Array]:
        """Position [m], velocity and acceleration of the point, world axes."""
        p, v, a = self._columns(t)
        return p[:3], v[:3], a[:3]

    def rotation(self, t: float) -> tuple[Array, Array, Array]:
        """Rotation matrix, angular velocity [rad/s] and angular acceleration, world axes."""
        p, v, a = self._columns(t)
        _, pitch, yaw = p[3:]
        cy, sy, cp, sp = math.cos(yaw), math.sin(yaw), math.cos(pitch), math.sin(pitch)
        ez, ey, ex = np.array([0.0, 0.0, 1.0]), np.array([-sy, cy, 0.0]), np.array([cy * cp, sy * cp, -sp])
        rr, pp, yy = v[3:]
        w_z = yy * ez
        w_zy = w_z + pp * ey
        w = w_zy + rr * ex
        alpha = a[5] * ez + a[4] * ey + a[3] * ex + np.cross(w_z, pp * ey) + np.cross(w_zy, rr * ex)
        return matrix_from_angles(*p[3:]), w, alpha


def _values(function: Function, name: str, t: float) -> Array:
    """function(t) as an array. ModelError if it raises or gives anything but finite numbers."""
    try:
        values = np.asarray(function(t), dtype=float)
    except Exception as error:  # the user's own code
        raise ModelError(f"Motion: {name}({t:g}) fails: {type(error).__name__}: {error}") from None
    if not np.isfinite(values).all():
        raise ModelError(f"Motion: {name}({t:g}) is {values.tolist()}; must be finite numbers")
    return values


class Prescribed(Description):
    """Prescribed motion of connection point `a`; with a 6-column motion, of the whole body `a`.

    name: of the joint in outputs. Its force is what a exerts on whatever moves it.
    """

    a: str
    motion: Motion
    name: Name | None = None

    @property
    def label(self) -> str:
        return self.name or default_label(self.a)

    def targets(self) -> tuple[str | tuple[float, float, float], ...]:
        return (self.a,)

    def ties(self) -> list[tuple[Any, Any]]:
        start = self.motion.translation(0.0)[0]
        return [(self.a, tuple(float(y) for y in start))]

    def rows(self, place: Callable[[Any], Place], drawing: Drawing) -> list[Row]:
        a = place(self.a)
        ground = place((0.0, 0.0, 0.0))
        rows: list[Row] = [Coincide(a, ground, self.motion)]
        if self.motion.columns == 6:
            drawn = drawing(a.rotation)
            if drawn is None:
                raise ModelError(
                    f"Prescribed '{self.label}': the motion has 6 columns but '{self.a}' has no rotation; "
                    "give 3 columns"
                )
            apart = np.linalg.norm(drawn - self.motion.rotation(0.0)[0]) / math.sqrt(2.0)  # angle, while it is small
            if apart > 1e-6:  # axes that stay normal do so half a turn away, too: the rows would not notice
                at = "roll, pitch, yaw {:.6g}, {:.6g}, {:.6g} rad".format(*self.motion.start[3:])
                raise ModelError(
                    f"Prescribed '{self.label}': the motion starts at {at}, which is not how '{self.a}' is drawn; give "
                    "the body the same attitude_deg"
                )
            rows += weld_axes(a, ground, np.eye(3), np.eye(3), self.motion)
        return rows

    def children(self) -> list[Any]:
        return []
