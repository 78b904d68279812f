"""Waves4Power's absorber: equilibrium against a free body in closed form, modes, power, a run in irregular waves."""

from __future__ import annotations

import math
import sys
from functools import lru_cache

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import fsolve
from shipped import MODELS

import floatsim as fs

sys.path.insert(0, str(MODELS))  # model scripts import their neighbours, as when they are run
import waves4power as model  # noqa: E402

CHECK = "Waves4Power, three hybrid legs"


@lru_cache(maxsize=1)
def equilibrium() -> tuple[fs.System, fs.State]:
    system = fs.assemble(model.build())
    return system, fs.solve_static(system)[0]


@lru_cache(maxsize=1)
def irregular() -> fs.Run:
    return fs.simulate(model.build(waves=model.sea_state(hs=3.0, tp=9.0)), 300.0, 0.1)


def span(H: float, V: float, length: float) -> tuple[float, float, float]:
    """Width, height [m] and upper vertical force of an elastic catenary (Irvine 1981, section 2.1) with H and, at its
    lower end, V [N]; the ropes' slow stiffness, their weight in water."""
    EA = model.SHARE[1] * model.BREAKING_LOAD / model.STRAIN[1]
    w = model.ROPE_MASS * (1.0 - model.DENSITY / model.POLYESTER) * model.GRAVITY
    top = V + w * length
    x = H * length / EA + H / w * (math.asinh(top / H) - math.asinh(V / H))
    z = (V + top) * length / (2.0 * EA) + (math.hypot(H, top) - math.hypot(H, V)) / w
    return x, z, top


def free_body() -> dict[str, float]:
    """One leg in its plane, the absorber's heave from the sum of vertical forces: H, V at the anchor and tilt of the
    buoy (its top outwards) such that both ropes reach and the moments about the buoy's bottom vanish."""
    volume = math.pi / 4.0 * model.D**2 * model.L
    lift = (model.DENSITY * volume - model.BUOY_MASS) * model.GRAVITY  # buoyancy and weight both act at the middle
    stiffness = model.DENSITY * model.GRAVITY * math.pi * model.bem.BUOY_RADIUS**2

    def solve(y: np.ndarray) -> tuple[list[float], dict[str, float]]:
        H, V, tilt, heave = y[0] * 1e5, y[1] * 1e5, y[2], y[3]
        x1, z1, top = span(H, V, model.LOWER)
        low = top - lift  # at the lower end of the upper rope: what it pulls the buoy up with
        x2, z2, pull = span(H, low, model.UPPER)
        # inner edge from the centre of the bottom: inwards and upwards when the top leans outwards
        x, z = 0.5 * model.D * math.cos(tilt), 0.5 * model.D * math.sin(tilt)
        radius, fairlead = model.FAIRLEAD
        moment = low * x - H * z - lift * 0.5 * model.L * math.sin(tilt)  # tilts the top outwards
        wanted = [
            (x1 + x2 + x - (model.ANCHOR_RADIUS - radius)) / 10.0,
            (z1 + z2 + z - (model.DEPTH + fairlead + heave)) / 10.0,
            moment / 1e5,
            (model.PULL - 3.0 * pull - stiffness * heave) / 1e5,
        ]
        return wanted, {
            "H": H, "lower": math.hypot(H, top), "upper": math.hypot(H, low), "pull": pull, "tilt": tilt,
            "heave": heave, "buoy_x": model.ANCHOR_RADIUS - x1 + 0.5 * model.L * math.sin(tilt),
            "buoy_z": -model.DEPTH + z1 + 0.5 * model.L * math.cos(tilt),
        }  # fmt: skip

    y, _, good, message = fsolve(lambda y: solve(y)[0], [0.7, 0.8, 0.2, 0.0], full_output=True, xtol=1e-12)
    assert good == 1, message
    return solve(y)[1]


def test_static_equilibrium_is_the_free_body_in_closed_form(record):
    system, state = equilibrium()
    want = free_body()
    run = fs.simulate(system, 0.2, 0.1, state=state)  # for the forces at the ropes' ends
    errors = []
    for k in (1, 2, 3):
        # ends pull on what they are attached to
        lower, upper, fairlead = (
            np.linalg.norm(run.series(name)[0]) for name in
            (f"lower_{k}_end_b_force", f"upper_{k}_end_a_force", f"upper_{k}_end_b_force")
        )  # fmt: skip
        across = np.hypot(*run.series(f"upper_{k}_end_b_force")[0, :2])
        errors += [lower / want["lower"] - 1.0, upper / want["upper"] - 1.0, across / want["H"] - 1.0,
                   fairlead / math.hypot(want["H"], want["pull"]) - 1.0]  # fmt: skip
    record(CHECK, "static forces at the buoys and the absorber against catenaries, largest error",
           float(np.abs(errors).max()), 1e-4)  # fmt: skip
    off, tilts = [run.series("absorber_position")[0, 2] - want["heave"]], []
    for k in (1, 2, 3):
        body = next(part for part in system.model.parts if part.name == f"buoy_{k}")
        q = run.series(f"buoy_{k}_position")[0]  # from the drawing; the buoy turns, then tilts about its own y
        place = np.add(body.position, q[:3])
        off += [math.hypot(place[0], place[1]) - want["buoy_x"], place[2] - want["buoy_z"]]
        tilts.append(math.degrees(q[4] - want["tilt"]))
    record(CHECK, "place of a leg's buoy, heave of the absorber: largest error [m]", float(np.abs(off).max()), 1e-3)
    record(CHECK, "tilt of a leg's buoy, error [deg]", float(np.abs(tilts).max()), 1e-3)


def test_floats_as_drawn_and_has_its_pretension():
    _, state = equilibrium()
    assert np.abs(state.x[0]).max() < 0.005
    want = free_body()
    assert 0.05 < want["upper"] / model.BREAKING_LOAD < want["lower"] / model.BREAKING_LOAD < model.SHARE[1]


def test_modes(record):
    system, state = equilibrium()
    modes = fs.natural_modes(system, state, count=40)
    assert all(np.isfinite(mode.period) for mode in modes)
    surge = [mode for mode in modes if mode.label.startswith(("absorber surge", "absorber sway"))]
    record(CHECK, "surge and sway periods of three legs, relative difference",
           abs(surge[0].period / surge[1].period - 1.0), 1e-3)  # fmt: skip
    assert 30.0 < surge[0].period < 150.0  # far above the waves, as a soft mooring must be
    heave = next(mode for mode in modes if mode.shares.get("absorber heave", 0.0) > 0.9)
    db = fs.HydroDatabase.read(model.HYDRO)
    w = 2.0 * math.pi / heave.period
    body = system.model.parts[0]
    alone = 2.0 * math.pi * math.sqrt((body.mass + db.at(w)[0][2, 2]) / db.hydrostatic_stiffness[2, 2])
    # the ropes add a few kN/m to the waterplane's 505
    record(CHECK, "heave period against that without ropes", heave.period / alone, (0.97, 1.0))


def test_power_in_a_regular_wave_is_that_of_the_frequency_domain(record):
    """T 8 s, the absorber alone, without legs and drag. Nothing is coupled to the heave of a body of revolution."""
    db, amplitude, period = fs.HydroDatabase.read(model.HYDRO), 0.1, 8.0
    w = 2.0 * math.pi / period
    body, pto = model.absorber(model.PTO_DAMPING, False, model.HYDRO)
    body = fs.Body(**{**dict(body), "mass": model.DENSITY * float(db.volume[0])})
    sea = fs.Sea(depth=model.DEPTH, waves=fs.RegularWave(height=2.0 * amplitude, period=period), wave_ramp=40.0)
    run = fs.simulate(fs.Model(parts=[body, pto], sea=sea), 160.0, 0.05)
    A, B = db.at(w)
    X = CubicSpline(db.omega, db.excitation[:, np.argmin(np.abs(db.headings)), 2])(w)
    stiffness = db.hydrostatic_stiffness[2, 2] - w**2 * (body.mass + A[2, 2])
    heave = amplitude * abs(X / (stiffness + 1j * w * (B[2, 2] + model.PTO_DAMPING)))
    got = fs.mean_power(run, "pto", since=160.0 - 10.0 * period)
    record(CHECK, "mean power in a regular wave over that of the frequency domain",
           got / (0.5 * model.PTO_DAMPING * (w * heave) ** 2), (0.99, 1.01))  # fmt: skip


def test_irregular_waves(record):
    run = irregular()
    assert run.status == "done", run.failure
    least, most = math.inf, 0.0
    for k in (1, 2, 3):
        for name in (f"lower_{k}", f"upper_{k}"):
            T = run.series(f"{name}_tension")
            least, most = min(least, T.min()), max(most, T.max())
    record(CHECK, "Hs 3 m, Tp 9 s: smallest tension [kN]", least / 1e3, (0.0, 50.0))
    record(CHECK, "Hs 3 m, Tp 9 s: largest tension over the breaking load", most / model.BREAKING_LOAD, 0.5)
    velocity, power = run.series("absorber_velocity")[:, 2], run.series("pto_power")
    assert power.min() >= 0.0 and np.all(np.diff(run.series("pto_energy")) >= -1e-6)
    off = power - model.PTO_DAMPING * velocity**2
    record(CHECK, "PTO power against damping times heave speed squared, largest error over the peak",
           float(np.abs(off).max() / power.max()), 5e-3)  # fmt: skip


def test_power_is_positive_and_below_the_limit_of_point_absorbers(record):
    """A body of revolution in heave takes at most what passes a width of wave length/2 pi (Budal & Falnes 1975)."""
    run = irregular()
    width = fs.capture_width(run, "pto", since=60.0)
    limit = 9.81 * 9.0**2 / (2.0 * math.pi) / (2.0 * math.pi)
    record(CHECK, "Hs 3 m, Tp 9 s: capture width [m], limit in heave at Tp as bar", width, (0.1, limit))
