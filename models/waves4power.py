"""A point absorber like Waves4Power's self-reacting WaveEL on three hybrid legs in 90 m of water.

    python models/waves4power.py        equilibrium, natural periods, and five minutes in Hs 3 m, Tp 9 s

Each leg is a lower polyester rope from the anchor to a submerged buoy and an upper one from there to the absorber. The
buoys are free cylinders with six degrees of freedom. The power take-off is a linear damper on the absorber's heave.

Public: buoy of 8 m diameter on a tube, 42 m long in all, 250 kW, three legs whose ropes have a breaking load of 120 t
(waves4power.com; reNews, November 2017; marineenergy.biz, November 2017). Hull: waves4power_bem.py. Of the legs' buoys:
coefficients 0.66 of added mass and 0.73 of drag across the axis. 0.66 is taken as a share of the displaced mass, what a
short cylinder has (DNV-RP-C205, table D-2: 0.62 at 1.2 diameters, 0.78 at 2.5); as 1 + share it would mean a negative
one. Assumptions, because the rest is not public:

- the absorber's mass makes it float at the draught of its database under the pull of the legs; it holds the water in
  the tube, which moves with it. Centre of mass and radius of gyration are those of a uniform rod of the whole length;
- the damper acts between heave and the ground. What it reacts on in the machine, the water in the tube, is no body of
  its own here: power is that of a machine whose water stands still. It is drawn to a point 100 km down on the axis, so
  that it is vertical whatever the drift;
- anchors 110 m out; buoys of 1.9 m x 2.85 m and 2 t, drawn 60 m out, 25 m down; lower rope to the centre of a buoy's
  bottom, upper rope to the inner edge of its bottom; upper ropes to the absorber's side, 4 m down;
- rope: 4.7 kg/m of polyester (1380 kg/m3), drag 1.6; slowly loaded it takes 15 % of its breaking load at a strain of
  3 % and all of it at 12 %, its dynamic stiffness is 18.5 breaking loads and 33 mean tensions (form: DNV-RP-E305);
- drag of the absorber 0.8 across its axis; of the ends of buoys 0.43 each, added mass one face of a disc.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import waves4power_bem as bem

import floatsim as fs

DEPTH, DENSITY, GRAVITY = bem.DEPTH, 1025.0, 9.81  # m, kg/m3, m/s2
HYDRO = Path(__file__).with_name("waves4power_hydro.nc")  # made by waves4power_bem.py
LENGTH = 42.0  # m, of the absorber
PULL = 67.8e3  # N, of the three legs downwards in calm water
DRAG = 0.8
PTO_DAMPING = 1.0e5  # N s/m

ANGLES = (math.pi, math.pi / 3.0, -math.pi / 3.0)  # of the legs
ANCHOR_RADIUS, BUOY_RADIUS, BUOY_Z = 110.0, 60.0, -25.0  # m, drawn
FAIRLEAD = (bem.BUOY_RADIUS, -bem.BUOY_DRAUGHT)  # m, radius and height
LOWER, UPPER = 80.5, 59.0  # m, unstretched
D, L, BUOY_MASS = 1.9, 2.85, 2000.0  # m, m, kg
BUOY_CA, BUOY_CD, END_CD, END_CA = 0.66, 0.73, 0.43, 0.5

BREAKING_LOAD = 120e3 * GRAVITY  # N
ROPE_MASS, POLYESTER = 4.7, 1380.0  # kg/m, kg/m3
STRAIN, SHARE = (0.0, 0.03, 0.12), (0.0, 0.15, 1.0)  # static curve, tension over the breaking load


def rope() -> fs.Section:
    """Polyester of both ropes."""
    law = fs.StaticDynamic(
        strain=STRAIN, tension=[share * BREAKING_LOAD for share in SHARE],
        dynamic_stiffness=18.5 * BREAKING_LOAD, per_tension=33.0, relaxation_time=600.0,
    )  # fmt: skip
    return fs.Section(
        name="polyester", mass_per_length=ROPE_MASS, diameter=math.sqrt(4.0 * ROPE_MASS / (math.pi * POLYESTER)),
        EA=law.stiffness, axial_law=law, axial_damping_ratio=0.05, drag_normal=1.6, drag_tangential=0.03,
        added_mass_normal=1.0, breaking_load=BREAKING_LOAD,
    )  # fmt: skip


def leg_buoy(k: int, angle: float) -> fs.Body:
    """Buoy of leg number k; its x axis points away from the absorber. Reference point: its middle."""
    across, along = BUOY_MASS * (D**2 / 8.0 + L**2 / 12.0), BUOY_MASS * D**2 / 4.0  # of a thin shell
    return fs.Body(
        name=f"buoy_{k}", mass=BUOY_MASS, inertia=(across, across, along),
        position=(BUOY_RADIUS * math.cos(angle), BUOY_RADIUS * math.sin(angle), BUOY_Z),
        attitude_deg=(0.0, 0.0, math.degrees(angle)),
        points={"bottom": (0.0, 0.0, -0.5 * L), "edge": (-0.5 * D, 0.0, -0.5 * L)},
        hydro=fs.Member(a=(0.0, 0.0, -0.5 * L), b=(0.0, 0.0, 0.5 * L), diameter=D, drag_normal=BUOY_CD, strips=4,
                        added_mass_normal=BUOY_CA, end_drag=END_CD, end_added_mass=END_CA),
    )  # fmt: skip


def absorber(damping: float, drag: bool, hydro: str | Path | fs.HydroDatabase) -> tuple[fs.Body, fs.PTO]:
    """The absorber and its power take-off."""
    flow = fs.PotentialFlow(database=hydro)
    mass = DENSITY * flow.volume - PULL / GRAVITY
    gyration, spin = LENGTH / math.sqrt(12.0), 2.0
    knee = -bem.BUOY_DRAUGHT - (bem.BUOY_RADIUS - bem.TUBE_RADIUS)
    top, narrow, wide = bem.TUBE_END + LENGTH, 2.0 * bem.TUBE_RADIUS, 2.0 * bem.BUOY_RADIUS
    loads = [
        fs.Member(a=(0, 0, low), b=(0, 0, high), diameter=diameter, drag_normal=DRAG, buoyancy=False, strips=strips)
        for low, high, diameter, strips in (
            (-bem.BUOY_DRAUGHT, top, wide, 20), (knee, -bem.BUOY_DRAUGHT, (narrow, wide), 4),
            (bem.TUBE_END, knee, narrow, 20),
        )
    ]  # fmt: skip
    radius, z = FAIRLEAD
    body = fs.Body(
        name="absorber", mass=mass, center_of_mass=(0.0, 0.0, top - 0.5 * LENGTH),
        inertia=(mass * gyration**2, mass * gyration**2, mass * spin**2),
        points={f"fairlead_{k}": (radius * math.cos(b), radius * math.sin(b), z) for k, b in enumerate(ANGLES, 1)},
        hydro=[flow, *(loads if drag else [])],
    )  # fmt: skip
    return body, fs.PTO(name="pto", a="absorber", b=(0.0, 0.0, -1e5), laws=[fs.Linear(damping=damping)])


def build(
    damping: float = PTO_DAMPING,
    elements: tuple[int, int] = (12, 10),
    waves: Any = None,
    wave_ramp: float = 50.0,
    current: fs.Current | None = None,
    drag: bool = True,
    hydro: str | Path | fs.HydroDatabase = HYDRO,
) -> fs.Model:
    """Absorber, three buoys, six ropes.

    damping [N s/m]: of the power take-off. elements: of the lower and the upper rope of a leg. waves, wave_ramp,
    current: see floatsim.Sea. drag: of the absorber. hydro: database or its path.
    """
    body, pto = absorber(damping, drag, hydro)
    parts: list[Any] = [body, pto]
    joints = []
    for k, angle in enumerate(ANGLES, 1):
        anchor = (ANCHOR_RADIUS * math.cos(angle), ANCHOR_RADIUS * math.sin(angle), -DEPTH)
        for name, length, count, a, b in (
            (f"lower_{k}", LOWER, elements[0], anchor, f"buoy_{k}.bottom"),
            (f"upper_{k}", UPPER, elements[1], f"buoy_{k}.edge", f"absorber.fairlead_{k}"),
        ):
            parts.append(fs.Line(name=name, section=rope(), length=length, elements=count, taut=True))
            joints += [fs.Ball(a=f"{name}.end_a", b=a), fs.Ball(a=f"{name}.end_b", b=b)]
        parts.append(leg_buoy(k, angle))
    return fs.Model(
        name="waves4power",
        parts=parts,
        joints=joints,
        sea=fs.Sea(depth=DEPTH, density=DENSITY, waves=waves, wave_ramp=wave_ramp, stretching="wheeler",
                   current=current or fs.Current(speed=0.0)),
        gravity=GRAVITY,
    )  # fmt: skip


def sea_state(hs: float = 3.0, tp: float = 9.0, seed: int = 1, heading_deg: float = 0.0) -> fs.IrregularWaves:
    """A wind sea that both the database and the ropes can follow."""
    return fs.IrregularWaves(spectrum=fs.Jonswap(hs=hs, tp=tp), seed=seed, heading_deg=heading_deg, components=100,
                             duration=600.0, omega_max=4.0)  # fmt: skip


def main() -> None:
    system = fs.assemble(build())
    state, _ = fs.solve_static(system)
    print("calm water:", np.round(state.x[0], 3), "m, absorber;", np.round(state.x[1:], 2)[:3].tolist())
    for mode in fs.natural_modes(system, state):
        print(f"{mode.period:8.2f} s  {mode.label}")
    run = fs.simulate(build(waves=sea_state()), 300.0, 0.1)
    print(run.status, run.failure, f"{run.wall_time:.0f} s")
    power, width = fs.mean_power(run, "pto", since=60.0), fs.capture_width(run, "pto", since=60.0)
    print(f"mean power {power / 1e3:.1f} kW, capture width {width:.2f} m")
    for k in (1, 2, 3):
        for rope_name in (f"lower_{k}", f"upper_{k}"):
            T = run.series(f"{rope_name}_tension") / 1e3
            print(f"{rope_name}: {T.min():.1f} to {T.max():.1f} kN")


if __name__ == "__main__":
    main()
