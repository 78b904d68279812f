"""Where a floater is on average: its horizontal position and heading behind a low-pass filter.

First-order excitation and drift belong to a floater that stays where it is. One that drifts meets the waves
elsewhere, earlier or later, and at another heading; following its motion at the waves' own frequencies as well
would add forces that second-order theory holds already. So the loads may be taken at the pose y that is left of the
motion u behind the second-order Butterworth filter

    y'' + sqrt(2) c y' + c^2 y = c^2 u,     c = 0.2 times the peak frequency of the sea

which keeps 0.04 of a motion at the peak and delays a slow one by sqrt(2)/c. A step of any length is exact for a
motion that is linear during it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from floatsim.jit import kernel
from floatsim.sea.waves import Realisation

Array = NDArray[np.float64]

CORNER = 0.2  # of the peak frequency
_WIDTH = 0.05  # of ln w: components closer than this make one peak
_GRID = 500  # frequencies that are looked at


def peak_frequency(sea: Realisation) -> float:
    """Frequency, rad/s, at which the variance density of the sea, smoothed over 5 %, is largest."""
    wet = (sea.amplitude > 0.0) & (sea.omega > 0.0)
    if not wet.any():
        return 1.0  # a flat sea exerts no force anywhere
    a, w = sea.amplitude[wet], sea.omega[wet]
    grid = np.geomspace(w.min(), w.max(), _GRID)
    nearness = np.exp(-0.5 * (np.log(grid[:, None] / w) / _WIDTH) ** 2)
    return float(grid[(nearness @ a**2 / grid).argmax()])


@dataclass
class SlowPosition:
    """Low-passed (x, y, yaw) of one body, m and rad: part of a run's state.

    corner  rad/s
    t       s, time of the last commit
    y, dy   (3,) filtered pose and its rate at t
    u       (3,) the body's own pose at t
    """

    corner: float
    t: float
    y: Array
    dy: Array
    u: Array

    @classmethod
    def at_rest(cls, corner: float, t: float, pose: Array) -> SlowPosition:
        """Filter of a body that has always been at `pose` (3,): x, y in m, yaw in rad."""
        pose = np.array(pose, dtype=np.float64)
        return cls(corner, t, pose, np.zeros(3), pose.copy())

    def prepare(self, t: float, pose: Array) -> Array:
        """Filtered pose (3,) at time t if the body goes linearly to `pose` (3,) by then. Changes nothing."""
        return self._step(t, self._near(pose))[0]

    def commit(self, t: float, pose: Array) -> None:
        """The body has gone to `pose` (3,) by time t."""
        pose = self._near(pose)
        self.y, self.dy = self._step(t, pose)
        self.t, self.u = t, pose

    def arrays(self) -> dict[str, Array]:
        """All that it remembers."""
        return {"t": np.array([self.t]), "y": self.y, "dy": self.dy, "u": self.u}

    def _near(self, pose: Array) -> Array:
        """The pose with its yaw taken by whole turns next to the last one: a body may turn round and round."""
        turns = round((pose[2] - self.u[2]) / (2.0 * math.pi))
        if turns == 0:
            return pose.copy()
        return np.array([pose[0], pose[1], pose[2] - 2.0 * math.pi * turns])

    def _step(self, t: float, pose: Array) -> tuple[Array, Array]:
        out = np.empty((2, 3))
        _follow(self.y, self.dy, self.u, pose, t - self.t, self.corner / math.sqrt(2.0), out)
        return out[0], out[1]


@kernel
def _follow(y, dy, u, pose, h, a, out):  # type: ignore[no-untyped-def]
    """Pose and rate, out (2, 3), after h of a linear way from u to pose: y = u - sqrt(2)/c u' + what is left of the
    start, which oscillates and decays, both at a = c/sqrt(2)."""
    still = h < 1e-9  # s: clocks that were rounded another way
    decay, co, si = math.exp(-a * h), math.cos(a * h), math.sin(a * h)
    for i in range(3):
        rate = 0.0 if still else (pose[i] - u[i]) / h
        lag = rate / a
        e, de = y[i] - u[i] + lag, dy[i] - rate
        out[0, i] = y[i] if still else pose[i] - lag + decay * ((co + si) * e + si / a * de)
        out[1, i] = dy[i] if still else rate + decay * ((co - si) * de - 2.0 * a * si * e)
