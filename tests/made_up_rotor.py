"""A rotor whose surface is a formula, so that its operating points are closed forms.

Both coefficients are of third degree or less along each axis, so that the tensor-product cubic spline is exact.
"""

from __future__ import annotations

import numpy as np

import floatsim as fs

RADIUS, INERTIA, DENSITY = 60.0, 4e7, 1.225
RATIOS, PITCHES = np.linspace(2.0, 16.0, 15), np.linspace(-5.0, 30.0, 15)
RATED_SPEED, MINIMUM = 1.2, 0.5
BEST, C0, SLOPE = 8.0, 0.48, 2.0  # tip-speed ratio and C_P at zero pitch; fall of C_P with the pitch


def power(l, p):
    """C_P: a parabola over the tip-speed ratio, 0.48 at 8 and zero pitch; falls with the pitch p [rad]."""
    return C0 * (1.0 - (l / BEST - 1.0) ** 2) - SLOPE * (l / BEST) * p


def thrust(l, p):
    """C_T."""
    return 0.78 + 0.02 * (l - BEST) - 1.5 * p * (l / BEST)


AREA = 0.5 * DENSITY * np.pi * RADIUS**2
GAIN = AREA * RADIUS**3 * C0 / BEST**3
RATED_TORQUE = 1.05 * GAIN * RATED_SPEED**2


def surface():
    """The performance surface."""
    l, p = np.meshgrid(RATIOS, np.radians(PITCHES), indexing="ij")
    return fs.PerformanceSurface(radius=RADIUS, tip_speed_ratio=RATIOS, pitch_deg=PITCHES, power=power(l, p),
                                 thrust=thrust(l, p))  # fmt: skip


def rotor(body, control=None, **more):
    """The rotor on `body`."""
    law = dict(rated_speed=RATED_SPEED, rated_torque=RATED_TORQUE, torque_gain=GAIN, minimum_speed=MINIMUM,
               natural_frequency=0.3, least_gain_pitch_deg=2.0, maximum_pitch_deg=25.0)  # fmt: skip
    values = dict(name="rotor", body=body, surface=surface(), controller=fs.Controller(**{**law, **(control or {})}),
                  inertia=INERTIA, tower_top=(0.0, 0.0, 0.0))  # fmt: skip
    return fs.Rotor(**{**values, **more})
