"""Reference Model 3 (RM3): a point absorber of two bodies, a float that slides along a spar with a heave plate.

Sources: [RM3] Neary et al., Methodology for Design and Economic Analysis of Marine Energy Conversion Technologies,
SAND2014-9040 (2014): dimensions; [WS] the RM3 example of WEC-Sim (Apache-2.0): masses, centres of mass, inertias,
density and damper; [H] Hall et al. 2020: umbilical and depth, see umbilical_rm3.py.

Both bodies float where they are drawn, mass equal to displaced mass as with WEC-Sim's mass 'equilibrium': displaced
volume is mass over density. (The volumes of the database, made from the dimensions of [RM3], are 0.13 % larger.)
WEC-Sim's example has neither mooring nor drag, and so has this model unless they are asked for. Next to nothing damps
its pitch then, and waves of about half its period of 15.5 s excite it parametrically: in waves of 8 s and 2.5 m it
grows to 0.4 rad within 600 s with a damper of 2.7e6 N s/m, hardly at all with 1.2e6. A mooring stops that, drag alone
does not.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import umbilical_rm3

import floatsim as fs

DEPTH, DENSITY, GRAVITY = 70.0, 1000.0, 9.81  # m [H], kg/m3, m/s2 [WS]

MASS = {"float": 725_834.0, "spar": 886_691.0}  # kg [WS]
CENTRE_OF_MASS = {"float": (0.0, 0.0, -0.72), "spar": (0.0, 0.0, -21.29)}  # m, origin on the still-water line [WS]
INERTIA = {
    "float": (20_907_301.0, 21_306_090.66, 37_085_481.11),
    "spar": (94_419_614.57, 94_407_091.24, 28_542_224.82),
}  # kg m2 about the centres of mass [WS]
SHAPE = {
    "float": (-3.0, 2.0, 20.0, math.sqrt(20.0**2 - 6.0**2)), "spar": (-29.0, 8.0, 6.0, 30.0),
}  # m: bottom, top, diameter, that of a disc of the area seen from below [RM3]; for drag alone  # fmt: skip

PTO_DAMPING = 1.2e6  # N s/m [WS]
MOORING_STIFFNESS = 1e5  # N/m, our assumption: surge period of half a minute; taken where something pulls sideways
STOP_STIFFNESS, STOP_DAMPING = 2e7, 2e7  # N/m, N s/m2, our assumption: 1 m/s is stopped within half a metre

HANG_OFF = (10.0, 0.0, -1.0)  # m, of the umbilical, our assumption: on the side of the float, clear of the plate below

HYDRO = Path(__file__).with_name("rm3_hydro.nc")  # made by rm3_bem.py


def body(name: str, hydro: Any, mooring: float, drag: tuple[float, float], **flow: Any) -> fs.Body:
    """Float or spar. mooring [N/m]: surge and sway stiffness at the centre of mass; drag: see `build`."""
    x, y, z = CENTRE_OF_MASS[name]
    points = {"hang_off": (HANG_OFF[0] - x, HANG_OFF[1] - y, HANG_OFF[2] - z)} if name == "float" else {}
    loads: list[Any] = [
        fs.PotentialFlow(
            database=hydro, body=name, displaced_volume=MASS[name] / DENSITY,
            linear_stiffness=np.diag([mooring, mooring, 0.0, 0.0, 0.0, 0.0]), **flow,
        )
    ]  # fmt: skip
    across, along = drag
    bottom, top, diameter, flat = SHAPE[name]
    if across > 0.0:
        loads.append(fs.Member(a=(0.0, 0.0, bottom - z), b=(0.0, 0.0, top - z), diameter=diameter, drag_normal=across,
                               added_mass_normal=0.0, buoyancy=False))  # fmt: skip
    if along > 0.0:
        loads.append(fs.Disc(at=(0.0, 0.0, bottom - z), axis=(0.0, 0.0, 1.0), diameter=flat, drag=along))
    return fs.Body(name=name, mass=MASS[name], inertia=INERTIA[name], position=(x, y, z), points=points, hydro=loads)


def build(
    pto_damping: float = PTO_DAMPING,
    laws: Sequence[Any] = (),
    stops: tuple[float, float] | None = None,
    latch_for: float | None = None,
    mooring: float | None = None,
    drag: tuple[float, float] = (0.0, 0.0),
    umbilical: bool = False,
    waves: object = None,
    wave_ramp: float = 100.0,
    radiation: str = "convolution",
    memory: float = 60.0,
    hydro: str | Path | object = HYDRO,
) -> fs.Model:
    """RM3, floating. Its joint is `slider`, its PTO `pto`; displacements of the float along the spar, up.

    pto_damping [N s/m]: linear damper; laws: more laws of the PTO beside it. stops (lower, upper) [m]: end-stops of
    the slider. latch_for [s]: hold the slider so long whenever its speed changes sign. mooring [N/m]: horizontal
    stiffness on the spar, default none, with the umbilical MOORING_STIFFNESS. drag: CD of both bodies, across their
    axis and of float bottom and plate along it.
    umbilical: hang the cable of umbilical_rm3.py from the float. waves, wave_ramp: see floatsim.Sea. radiation, memory:
    see floatsim.PotentialFlow. hydro: database or its path.
    """
    if mooring is None:
        mooring = MOORING_STIFFNESS if umbilical else 0.0
    flow: dict[str, Any] = {"radiation": radiation}
    if radiation == "convolution":
        flow["memory"] = memory
    all_laws = [fs.Linear(damping=pto_damping), *laws]
    if stops is not None:
        all_laws.append(
            fs.EndStop(lower=stops[0], upper=stops[1], stiffness=STOP_STIFFNESS, damping=STOP_DAMPING)
        )
    parts: list[Any] = [
        body("float", hydro, 0.0, drag, **flow),
        body("spar", hydro, mooring, drag, **flow),
        fs.PTO(name="pto", joint="slider", laws=all_laws),
    ]
    joints: list[Any] = [fs.Slider(a="float", b="spar", axis=(0.0, 0.0, 1.0), name="slider")]
    if latch_for is not None:
        parts.append(fs.Lock(name="latch", joint="slider", latch_for=latch_for))
    if umbilical:
        parts.append(umbilical_rm3.build().parts[0])
        joints.append(fs.Ball(a="umbilical.end_a", b="float.hang_off", name="hang_off"))
        joints.append(fs.Ball(a="umbilical.end_b", b=umbilical_rm3.ANCHOR, name="anchor"))
    stiffness, damping = umbilical_rm3.SEABED
    return fs.Model(
        name="rm3",
        parts=parts,
        joints=joints,
        sea=fs.Sea(
            depth=DEPTH, density=DENSITY, waves=waves, wave_ramp=wave_ramp,
            seabed=fs.Seabed(stiffness=stiffness, damping=damping),
        ),
        gravity=GRAVITY,
    )  # fmt: skip
