"""Generator torque and blade pitch of a variable-speed turbine.

Torque over rotor speed O, with O_r, Q_r at rated and k the gain that holds the best tip-speed ratio:

    0 below 0.98 O_min, linear to k (1.01 O_min)^2, then k O^2, from 0.96 O_r linear to Q_r at O_r, constant above.

Constant torque above rated, not constant power, whose falling torque would take damping from rotor and platform.

Pitch: e = O - O_r,

    command = K_p(pitch) e + I + K_f f,    dI/dt = K_i(pitch) e,    f' = w_f (hub velocity along the shaft - f)
    d pitch/dt = (command - pitch)/tau, limited in rate

command and I stay between the fine pitch and the largest. The fine pitch is that of a table over the generator torque:
below the wind where the smallest speed is left it is not zero. Gains (Hansen et al. 2005, Risoe-R-1500, with the
rotor's own damping counted): linearised about every operating point above rated,

    J O'' + (-dQ/dO - dQ/dpitch K_p) O' - dQ/dpitch K_i O = 0

gets the chosen natural frequency w and damping ratio z, K_i = -J w^2/(dQ/dpitch), K_p = (2 z w J + dQ/dO)/(-dQ/dpitch),
not negative, in a table over pitch; below `least_gain_pitch`, where dQ/dpitch goes to zero, those of that angle.

A fast controller keeps the power and with it lets thrust *fall* when the wind rises: the platform's pitch is then
driven (Larsen & Hanson 2007, J. Physics: Conf. Series 75). So w must lie below the platform's pitch frequency, and
nacelle-velocity feedback K_f > 0 turns the blades out of the wind while the hub moves with it, which damps the platform
at the cost of rotor speed (ROSCO's floating feedback, Abbas et al. 2022, Wind Energy Science 7).
"""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
from pydantic import Field, model_validator

from floatsim.description import Description, NonNegative, Positive, Series
from floatsim.errors import ModelError
from floatsim.frames import Array
from floatsim.jit import kernel
from floatsim.rotor.surface import loads

# parameters of the kernels, which stand in one array
(PRESSURE, RADIUS, INERTIA, RATED, TORQUE, GAIN, LEAST, LAG, RATE, LARGEST, FEEDBACK, CORNER, WIDTH) = range(13)
_CUT_IN, _TRACK, _RISE = 0.98, 1.01, 0.96  # of the smallest speed, likewise, of the rated one
_LEVELS = 40  # of the table of gains


class Controller(Description):
    """Torque and pitch controller; laws at the top of this file.

    rated_speed [rad/s], rated_torque [N m], torque_gain k [N m s2], minimum_speed [rad/s]. natural_frequency [rad/s]
    and damping_ratio of the speed loop above rated. velocity_feedback K_f [rad s/m], 0: none; feedback_corner w_f
    [rad/s]. pitch_rate_limit_deg [deg/s], pitch_lag tau [s], maximum_pitch_deg, least_gain_pitch_deg.
    fine_pitch_torque [N m] and fine_pitch_deg: the table of the fine pitch, constant beyond its ends.
    """

    rated_speed: Positive
    rated_torque: Positive
    torque_gain: Positive
    minimum_speed: NonNegative = 0.0
    natural_frequency: Positive = 0.1
    damping_ratio: Positive = 1.0
    velocity_feedback: NonNegative = 0.0
    feedback_corner: Positive = 0.5
    pitch_rate_limit_deg: Positive = 2.0
    pitch_lag: Positive = 0.3
    maximum_pitch_deg: Positive = 30.0
    least_gain_pitch_deg: Positive = 5.0
    fine_pitch_torque: Annotated[Series, Field(min_length=1)] = (0.0,)
    fine_pitch_deg: Annotated[Series, Field(min_length=1)] = (0.0,)

    @model_validator(mode="after")
    def _consistent(self) -> Controller:
        if _TRACK * self.minimum_speed >= _RISE * self.rated_speed:
            raise ValueError(
                f"minimum_speed is {self.minimum_speed:g} rad/s; it must be well below rated_speed, "
                f"{self.rated_speed:g} rad/s"
            )
        most = self.torque_gain * (_RISE * self.rated_speed) ** 2
        if most > self.rated_torque:
            raise ValueError(
                f"torque_gain {self.torque_gain:g} N m s2 makes {most:.4g} N m at {_RISE:g} rated_speed, more than "
                f"rated_torque, {self.rated_torque:g} N m"
            )
        if len(self.fine_pitch_torque) != len(self.fine_pitch_deg):
            raise ValueError(
                f"fine_pitch_torque has {len(self.fine_pitch_torque)} values, fine_pitch_deg {len(self.fine_pitch_deg)}"
            )
        if not np.all(np.diff(self.fine_pitch_torque) > 0.0):
            raise ValueError("fine_pitch_torque must increase")
        if not self.least_gain_pitch_deg < self.maximum_pitch_deg > max(self.fine_pitch_deg):
            raise ValueError(
                f"maximum_pitch_deg is {self.maximum_pitch_deg:g}; it must exceed least_gain_pitch_deg and "
                "fine_pitch_deg"
            )
        return self

    def packed(self, pressure_area: float, radius: float, inertia: float) -> Array:
        """Parameters of the kernels (WIDTH,), with rho pi R^2/2, R and the inertia about the shaft."""
        P = np.zeros(WIDTH)
        P[PRESSURE], P[RADIUS], P[INERTIA] = pressure_area, radius, inertia
        P[RATED], P[TORQUE], P[GAIN], P[LEAST] = (
            self.rated_speed, self.rated_torque, self.torque_gain, self.minimum_speed
        )  # fmt: skip
        P[LAG], P[RATE] = self.pitch_lag, math.radians(self.pitch_rate_limit_deg)
        P[LARGEST] = math.radians(self.maximum_pitch_deg)
        P[FEEDBACK], P[CORNER] = self.velocity_feedback, self.feedback_corner
        return P

    def fine(self) -> Array:
        """Table (n, 2) of the fine pitch: torque [N m], pitch [rad]."""
        return np.ascontiguousarray(np.transpose([self.fine_pitch_torque, np.radians(self.fine_pitch_deg)]))

    def gains(self, surface: tuple[Array, Array, Array], P: Array) -> Array:
        """Table (n, 3) of pitch [rad], K_p [s] and K_i [-], from the least pitch to the largest.

        Raises ModelError if the rotor does not make rated torque at any of them.
        """
        from scipy.optimize import brentq

        rows = []
        J, w, z = P[INERTIA], self.natural_frequency, self.damping_ratio
        winds = P[RATED] * P[RADIUS] / surface[1][::-1]  # those that the surface knows at rated speed
        for pitch in np.linspace(math.radians(self.least_gain_pitch_deg), P[LARGEST], _LEVELS):

            def of(u: float, pitch: float = float(pitch)) -> Any:
                return loads(*surface, P[PRESSURE], P[RADIUS], u, P[RATED], pitch)

            excess = [of(u)[0] - P[TORQUE] for u in winds]
            k = next((k for k in range(1, len(winds)) if excess[k - 1] < 0.0 <= excess[k]), None)
            if k is None:
                continue  # no wind that makes rated power at this pitch
            _, _, by_speed, by_pitch, *_ = of(brentq(lambda u: of(u)[0] - P[TORQUE], winds[k - 1], winds[k]))
            if by_pitch < 0.0:
                rows.append((pitch, max(2.0 * z * w * J + by_speed, 0.0) / -by_pitch, J * w * w / -by_pitch))
        if not rows:
            raise ModelError(
                "Controller: with this surface the rotor makes rated_torque at rated_speed at no pitch between "
                f"least_gain_pitch_deg {self.least_gain_pitch_deg:g} and maximum_pitch_deg {self.maximum_pitch_deg:g}"
            )
        return np.array(rows)


@kernel
def generator_torque(P, speed):  # type: ignore[no-untyped-def]
    """(torque, its derivative by rotor speed)."""
    k, low, high = P[GAIN], _TRACK * P[LEAST], _RISE * P[RATED]
    if speed >= P[RATED]:
        return P[TORQUE], 0.0
    if speed >= high:
        slope = (P[TORQUE] - k * high * high) / (P[RATED] - high)
        return P[TORQUE] - slope * (P[RATED] - speed), slope
    if speed >= low:
        return k * speed * speed, 2.0 * k * speed
    start = _CUT_IN * P[LEAST]
    if speed <= start:
        return 0.0, 0.0
    slope = k * low * low / (low - start)
    return slope * (speed - start), slope


@kernel
def table_at(table, x, column):  # type: ignore[no-untyped-def]
    """(value, slope) of a column of a table over its first, linear between rows, constant beyond."""
    n = table.shape[0]
    if n == 1 or x <= table[0, 0]:
        return table[0, column], 0.0
    if x >= table[n - 1, 0]:
        return table[n - 1, column], 0.0
    i = 1
    while table[i, 0] < x:
        i += 1
    slope = (table[i, column] - table[i - 1, column]) / (table[i, 0] - table[i - 1, 0])
    return table[i - 1, column] + slope * (x - table[i - 1, 0]), slope


@kernel
def fine_pitch(P, fine, speed):  # type: ignore[no-untyped-def]
    """(fine pitch, its derivative by rotor speed)."""
    torque, slope = generator_torque(P, speed)
    pitch, by_torque = table_at(fine, torque, 1)
    return pitch, by_torque * slope
