"""Rotor, generator and controller of the IEA 15 MW reference turbine.

Sources: [TAB] tabular workbook of the repository IEAWindTask37/IEA-15-240-RWT (Apache-2.0), sheet "Rotor Performance",
ideal steady states of WISDEM without peak shaving; [DECK] the OpenFAST and ROSCO decks IEA-15-240-RWT-UMaineSemi of the
same repository; [SURFACE] the head of iea15_rotor.csv.

[SURFACE] and [TAB] are two calculations of one turbine and differ: for a wind along the shaft the surface has 2.2 %
more torque and 2.7 % more thrust at the best tip-speed ratio. Projecting the wind on the shaft, which is tilted by
6 deg, takes 1.7 % and 0.6 % of that away. What is left is taken from the coefficients: POWER, so that rated power is
reached at the wind of [TAB], and THRUST, so that all steady states of 6 to 20 m/s are within 2 % of [TAB]. Peak shaving
is left out, as in [TAB].
"""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np

import floatsim as fs

RADIUS = 120.97  # m [DECK]
INERTIA = 3.507996e8 + 1_836_784.0  # kg m2 about the shaft: blades and hub, generator's rotor [DECK, ElastoDyn]
EFFICIENCY = 0.95756  # of the generator [TAB]
TILT_DEG, OVERHANG, SHAFT_HEIGHT = 6.0, 12.098, 4.3495  # deg, m, m [DECK]
CUT_IN, CUT_OUT = 3.0, 25.0  # m/s [TAB]
POWER, THRUST = 0.9946, 0.992  # of the coefficients, see above

RPM = math.pi / 30.0
RATED_SPEED, RATED_TORQUE = 7.49924 * RPM, 19.947e6  # rad/s, N m [TAB]
MINIMUM_SPEED = 5.0 * RPM  # rad/s [TAB]
TORQUE_GAIN = 13.1739e6 / (6.18513 * RPM) ** 2  # N m s2, torque over speed squared at 8.706 m/s [TAB]
# fine pitch where the smallest speed is kept, 3 to 7 m/s [TAB]
FINE_TORQUE = tuple(1e6 * y for y in (0.0848295, 0.583372, 1.21293, 1.95771, 2.79758, 3.70873, 4.66425, 5.63516,
                                      6.59125, 7.50232, 8.3395))  # fmt: skip
FINE_PITCH_DEG = (3.92029, 3.91302, 3.70954, 3.34785, 2.90527, 2.41074, 1.89789, 1.38709, 0.891713, 0.425207, 0.0)

TABLE = Path(__file__).with_name("iea15_rotor.csv")


def surface() -> fs.PerformanceSurface:
    """The performance surface."""
    lines = [line for line in TABLE.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    (_, *ratios), *rows = csv.reader(lines)
    pairs = np.array([[[float(y) for y in pair.split()] for pair in row[1:]] for row in rows])
    return fs.PerformanceSurface(
        radius=RADIUS,
        tip_speed_ratio=[float(y) for y in ratios],
        pitch_deg=[float(row[0]) for row in rows],
        power=POWER * pairs[:, :, 0].T,
        thrust=THRUST * pairs[:, :, 1].T,
    )


def controller(**changes: float) -> fs.Controller:
    """The controller. The pitch rate limit is ROSCO's [DECK]; speed loop and velocity feedback are our own, tuned for
    the VolturnUS-S, whose pitch has 0.22 rad/s."""
    values = dict(
        rated_speed=RATED_SPEED, rated_torque=RATED_TORQUE, torque_gain=TORQUE_GAIN, minimum_speed=MINIMUM_SPEED,
        natural_frequency=0.1, damping_ratio=1.0, velocity_feedback=0.01, feedback_corner=0.5,
        pitch_rate_limit_deg=2.0, pitch_lag=0.3, maximum_pitch_deg=30.0,
        fine_pitch_torque=FINE_TORQUE, fine_pitch_deg=FINE_PITCH_DEG,
    )  # fmt: skip
    return fs.Controller(**{**values, **changes})


def rotor(
    body: str,
    tower_top: tuple[float, float, float],
    tower: fs.Tower | None = None,
    yaw_misalignment_deg: float = 0.0,
    name: str = "rotor",
    **control: float,
) -> fs.Rotor:
    """The rotor on `body`, whose tower ends at tower_top [m, body axes]; control: changes of the controller.

    Parked (wind beyond cut-out) the blades are feathered; their drag and the nacelle's are left out.
    """
    return fs.Rotor(
        name=name, body=body, surface=surface(), controller=controller(**control), inertia=INERTIA,
        tower_top=tower_top, shaft_height=SHAFT_HEIGHT, overhang=OVERHANG, tilt_deg=TILT_DEG,
        yaw_misalignment_deg=yaw_misalignment_deg, generator_efficiency=EFFICIENCY, cut_in=CUT_IN, cut_out=CUT_OUT,
        tower=tower,
    )  # fmt: skip
