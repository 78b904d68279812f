"""Runs that a checkpoint has something to remember of, and the program that resumes them in a process of its own.

    python restart_scenarios.py resume NAME FOLDER     every checkpoint FOLDER/K.ckpt, with the output file beside it
    python restart_scenarios.py run NAME FOLDER        a run with checkpoints, to be killed
    python restart_scenarios.py go_on NAME FOLDER
"""

from __future__ import annotations

import dataclasses
import sys
from pathlib import Path
from typing import Any

import numpy as np
from shipped import HYDRO, MODELS, load

import floatsim as fs
from floatsim.study.simulate import resume

sys.path.insert(0, str(MODELS))  # models import their neighbours

RHO, G = 1025.0, 9.81
HYDRAULIC = dict(area=0.02, stroke=14.0, high_pressure=9e6, low_pressure=1e6, high_gas_volume=0.5, low_gas_volume=1.0,
                 motor_displacement=2e-5, generator_damping=1.6, motor_inertia=2.0, valve_area=1e-3)  # fmt: skip


def sea_state(**more: Any) -> fs.IrregularWaves:
    return fs.IrregularWaves(
        **({"spectrum": fs.Jonswap(hs=5.0, tp=10.0), "seed": 3, "omega_max": 1.6, "duration": 600.0} | more)
    )


def drifting() -> Any:
    """VolturnUS-S in a short-crested sea that drifts it: radiation by convolution, slow position, Newman's forces from
    a made-up mean drift, three chains on the bed."""
    db = fs.read_hydro(HYDRO)
    drift = np.zeros(db.excitation.shape)
    drift[..., 0], drift[..., 1] = 4e4 * np.cos(db.headings), 4e4 * np.sin(db.headings)
    model = load("volturnus_s").build(waves=sea_state(), elements=15)
    platform = model.parts[0]
    flow = platform.hydro.model_copy(
        update={"database": dataclasses.replace(db, mean_drift=drift), "drift": "newman", "slow_position": True}
    )
    platform = platform.model_copy(update={"hydro": flow})
    return model.model_copy(update={"parts": [platform, *model.parts[1:]]})


def lag(t: float, s: float, v: float, y: Any) -> Any:
    """A spring that lags behind and hardens."""
    return -2e4 * y[0] - 1e3 * v, [(s - y[0] - 2.0 * y[0] ** 3) / 0.8]


def sampled(t: float, s: float, v: float, y: Any) -> Any:
    """A digital controller with an integrator."""
    total = y[0] + s * 0.35
    return -5e3 * s - 2e3 * v - 1e2 * total, [total]


def converter() -> Any:
    """RM3 with all that a PTO can remember: oil, a user's states, a sampled controller, end-stops; state space."""
    laws = [fs.Hydraulic(**HYDRAULIC), fs.UserLaw(function=lag, states=(0.0,), names=["lag"]),
            fs.UserLaw(function=sampled, states=(0.0,), sample_time=0.35, names=["total"])]  # fmt: skip
    return load("rm3").build(
        laws=laws, stops=(-1.0, 1.0), radiation="state_space", mooring=1e5, drag=(1.0, 1.0),
        waves=sea_state(spectrum=fs.Jonswap(hs=2.5, tp=8.0)), wave_ramp=10.0,
    )  # fmt: skip


def latched() -> Any:
    """RM3 that is held whenever its slider turns round."""
    waves = fs.RegularWave(height=2.0, period=8.0)
    return load("rm3").build(latch_for=1.0, waves=waves, wave_ramp=10.0, mooring=1e5)


def snapping() -> Any:
    """A chain that snaps under cut steps, on a bed with friction, and parts."""
    chain = fs.Section(name="chain", mass_per_length=685.0, diameter=0.333, EA=3.27e9, drag_normal=1.1,
                       added_mass_normal=0.82, axial_damping_ratio=0.3)  # fmt: skip
    line = fs.Line(name="chain", section=chain, length=850.0, elements=30, breaks=[fs.Break(at=600.0, time=6.5)])
    a, w = 12.0, 0.8
    motion = fs.Motion(lambda t: (760.0 + a * (1.0 - np.cos(w * t)), 0, -14.0 + a * (1.0 - np.cos(w * t))),
                       lambda t: (a * w * np.sin(w * t), 0, a * w * np.sin(w * t)),
                       lambda t: (a * w * w * np.cos(w * t), 0, a * w * w * np.cos(w * t)))  # fmt: skip
    joints = [fs.Ball(a="chain.end_a", b=(0, 0, -200.0)), fs.Prescribed(a="chain.end_b", motion=motion)]
    sea = fs.Sea(depth=200.0, density=RHO, seabed=fs.Seabed(friction=0.6, slip_length=0.02))
    return fs.Model(name="snap", parts=[line], joints=joints, sea=sea, gravity=G)


def rope() -> Any:
    """A polyester rope with a memory between bending cables with a table of moments, pulled to and fro in waves."""
    law = fs.StaticDynamic(strain=(0.0, 0.02, 0.1), tension=(0.0, 4e5, 5e6), dynamic_stiffness=6e7, per_tension=10.0,
                           relaxation_time=3.0, permanent_share=0.3)  # fmt: skip
    polyester = fs.Section(name="polyester", mass_per_length=25.0, diameter=0.18, EA=6e7, axial_law=law,
                           drag_normal=1.6, added_mass_normal=1.0)  # fmt: skip
    table = fs.MomentTable(curvature=[0.0, 0.02, 0.05, 0.1], moment=[0.0, 8e3, 1.1e4, 1.3e4])
    cable = fs.Section(name="cable", mass_per_length=40.0, diameter=0.15, EA=3e8, bending_law=table,
                       axial_damping_ratio=0.05, drag_normal=1.2, added_mass_normal=1.0)  # fmt: skip
    tether = fs.Line(name="tether", section=polyester, length=100.0, elements=12, taut=True)
    hanging = fs.Line(name="hanging", section=cable, length=140.0, elements=20)
    buoy = fs.PointBuoy(name="buoy", mass=2e4, volume=60.0, drag_area=12.0, added_mass=1e4, position=(0.0, 0.0, -18.0))
    joints = [fs.Ball(a="tether.end_a", b=(0, 0, -120.0)), fs.Ball(a="tether.end_b", b="buoy"),
              fs.Ball(a="hanging.end_a", b="buoy"),
              fs.Clamp(name="clamp", a="hanging.end_b", b=(90.0, 0, -10.0), direction=(0, 0, 1))]  # fmt: skip
    sea = fs.Sea(depth=120.0, density=RHO, waves=sea_state(), wave_ramp=5.0, current=fs.Current(speed=0.4))
    return fs.Model(name="rope", parts=[buoy, tether, hanging], joints=joints, sea=sea)


SCENARIOS: dict[str, tuple[Any, dict[str, Any]]] = {
    # checkpoints on outputs and between them, where an interval has several steps
    "drifting": (drifting, dict(duration=40.0, dt=0.1, checkpoint_every=7.0)),
    "drifting, its energies, samples far apart": (
        drifting, dict(duration=24.0, dt=0.1, interval=1.0, checkpoint_every=3.7, energy=True)
    ),
    "converter": (converter, dict(duration=24.0, dt=0.05, interval=0.2, checkpoint_every=4.15)),
    "latched, float32, few channels": (
        latched, dict(duration=40.0, dt=0.05, interval=0.5, checkpoint_every=4.3, precision="float32",
                      channels=["float_position", "latch_engaged", "newton_iterations"])
    ),
    "snapping": (snapping, dict(duration=8.0, dt=0.1, checkpoint_every=0.7)),
    "snapping, energy, uneven": (
        snapping, dict(duration=8.0, dt=0.1, interval=0.4, checkpoint_every=0.9, energy=True)
    ),
    "rope": (rope, dict(duration=20.0, dt=0.1, interval=0.3, checkpoint_every=1.7, energy=True)),
}  # fmt: skip


def used(model: Any) -> Any:
    """A system with another run behind it: its scratch is full of other things."""
    system = fs.assemble(model)
    fs.simulate(system, 3.0, 0.25, step_control=False)
    return system


def main(what: str, name: str, folder: str) -> None:
    build, how = SCENARIOS[name]
    if what == "run":
        fs.simulate(build(), **how, output=f"{folder}/run.nc", checkpoint=f"{folder}/run.ckpt")
    elif what == "go_on":
        resume(f"{folder}/run.ckpt", build())
    else:
        model = build()
        for k, path in enumerate(sorted(Path(folder).glob("*.ckpt"))):
            run = resume(path, used(model) if k == 1 else model, output=path.with_suffix(".nc"))
            assert run.status == "done", run.failure


if __name__ == "__main__":
    main(*sys.argv[1:])
