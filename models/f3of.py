"""Floating three-body oscillating flap device (F3OF) of the WEC3 code comparison: a base and two hinged flaps.

Sources: [C] Combourieu et al. 2015, "WEC3: Wave Energy Converters modelling Code Comparison project", EWTEC, and the
case files of its test DT1 in HydroChrono (MIT): masses, inertias, hinges, spring; [B] f3of_bem.py: shape and
hydrodynamics. The flaps are lighter than the water they displace and stand on the base by their buoyancy.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

import floatsim as fs

DENSITY, GRAVITY = 1025.0, 9.81  # kg/m3, m/s2
DEPTH = 300.0  # m: any, deep
BASE_MASS, BASE_PITCH_INERTIA = 1_089_825.0, 76.3e6  # kg; kg m2 about the centre of mass [C]
FLAP_MASS, FLAP_PITCH_INERTIA = 179_250.0, 1.3e6  # kg; kg m2 about the centre of mass [C]
OTHER_INERTIA = 1e8  # kg m2, roll and yaw, of each: not public; that of the case files, which never roll or yaw [C]
BASE_CENTRE, FLAP_CENTRE, HINGE, LEG = -9.0, -5.5, -9.0, 12.5  # m: z of centres of mass and hinges; their x [C]
SURGE_STIFFNESS = 1e5  # N/m, spring of test DT1 [C]
YAW_STIFFNESS = SURGE_STIFFNESS * LEG**2  # N m/rad: ours, for the device that is not guided

MEMORY = 240.0  # s: the water between the flaps sloshes (1.31, 1.70, ... rad/s) for long; with 60 s surge grows

HYDRO = Path(__file__).with_name("f3of_hydro.nc")  # made by f3of_bem.py


def build(
    guided: bool = True,
    locked: bool = True,
    damping: float = 0.0,
    laws: Sequence[object] = (),
    memory: float = MEMORY,
    hydro: str | Path | object = HYDRO,
    waves: object = None,
    wave_ramp: float = 100.0,
) -> fs.Model:
    """The device as in test DT1, on a spring in surge.

    guided: on a slider in surge; otherwise it floats, the same spring in sway, and one in yaw. locked: flaps locked
    upright; otherwise they swing. damping [N m s/rad]: of a linear PTO on each hinge; laws: more for each.
    memory [s]: of the radiated waves. hydro: database or its path. waves, wave_ramp: see floatsim.Sea.
    """
    spring = np.diag([SURGE_STIFFNESS, SURGE_STIFFNESS, 0.0, 0.0, 0.0, YAW_STIFFNESS])
    base = fs.Body(
        name="base", mass=BASE_MASS, inertia=(OTHER_INERTIA, BASE_PITCH_INERTIA, OTHER_INERTIA),
        position=(0.0, 0.0, BASE_CENTRE),
        points={"fore": (-LEG, 0.0, HINGE - BASE_CENTRE), "aft": (LEG, 0.0, HINGE - BASE_CENTRE)},
        hydro=fs.PotentialFlow(database=hydro, body="base", memory=memory, linear_stiffness=spring),
    )  # fmt: skip
    parts: list[object] = [base]
    joints: list[object] = []
    if guided:
        joints.append(fs.Slider(a="base", b=(0.0, 0.0, BASE_CENTRE), axis=(1.0, 0.0, 0.0), name="guide"))
    every = ([fs.Linear(damping=damping)] if damping else []) + list(laws)
    for name, x in (("fore", -LEG), ("aft", LEG)):
        hinge = f"{name}_hinge"
        flap = fs.Body(
            name=name, mass=FLAP_MASS, inertia=(OTHER_INERTIA, FLAP_PITCH_INERTIA, OTHER_INERTIA),
            position=(x, 0.0, FLAP_CENTRE), points={"hinge": (0.0, 0.0, HINGE - FLAP_CENTRE)},
            hydro=fs.PotentialFlow(database=hydro, body=name, memory=memory),
        )  # fmt: skip
        parts.append(flap)
        joints.append(fs.Hinge(a=f"{name}.hinge", b=f"base.{name}", axis=(0.0, 1.0, 0.0), name=hinge))
        if locked:
            parts.append(fs.Lock(name=f"{name}_lock", joint=hinge, engaged=True))
        if every:
            parts.append(fs.PTO(name=f"{name}_pto", joint=hinge, laws=every))
    return fs.Model(
        name="f3of", parts=parts, joints=joints, gravity=GRAVITY,
        sea=fs.Sea(depth=DEPTH, density=DENSITY, waves=waves, wave_ramp=wave_ramp),
    )  # fmt: skip
