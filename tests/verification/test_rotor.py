"""The rotor against closed forms: operating points, rotor speed in time, gyroscopic moments, conservation, order."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest
from made_up_rotor import AREA, BEST, C0, GAIN, INERTIA, RADIUS, RATED_SPEED, RATED_TORQUE, SLOPE, power, rotor, thrust
from mechanics import observed_order, run
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import floatsim as fs
from floatsim.parts.rotor import RotorBatch
from floatsim.rotor.operation import FILTER, INTEGRATOR, PITCH, SPEED
from floatsim.rotor.surface import coefficients

SEA = fs.Sea(depth=200.0, wave_ramp=0.0)
CHECK = "rotor against closed forms"


def body(**more):
    return fs.Body(**{**dict(name="nacelle", mass=1e6, inertia=(2e9, 2e9, 2e9), position=(0, 0, 90)), **more})


def held(wind, **more):
    """A rotor whose hub cannot move."""
    weld = fs.Weld(a="nacelle", b=(0, 0, 90))
    return fs.Model(parts=[body(), rotor("nacelle", **more)], joints=[weld], sea=SEA, wind=wind)


def rotors(system):
    """(number of the batch of rotors, the batch)."""
    return next((k, batch) for k, batch in enumerate(system.batches) if isinstance(batch, RotorBatch))


def operating_point(u):
    """speed, pitch, thrust, generator torque of the made-up rotor in the wind u along its shaft, above the smallest
    speed."""
    if BEST * u / RADIUS < 0.96 * RATED_SPEED:
        speed, pitch = BEST * u / RADIUS, 0.0
        return speed, pitch, AREA * u * u * thrust(BEST, 0.0), GAIN * speed**2
    ratio = RATED_SPEED * RADIUS / u
    needed = RATED_TORQUE * ratio / (AREA * RADIUS * u * u)
    pitch = (C0 * (1.0 - (ratio / BEST - 1.0) ** 2) - needed) / (SLOPE * ratio / BEST)
    return RATED_SPEED, pitch, AREA * u * u * thrust(ratio, pitch), RATED_TORQUE


def test_surface_is_exact_for_cubics_and_smooth():
    table = rotor("nacelle").surface.packed()
    rng = np.random.default_rng(1)
    for l, p in zip(rng.uniform(2, 16, 50), np.radians(rng.uniform(-5, 30, 50)), strict=True):
        CQ, by_l, by_p, CT, *_ = coefficients(*table, l, p)
        assert pytest.approx((power(l, p) / l, thrust(l, p)), rel=1e-11, abs=1e-13) == (CQ, CT)
        h = 1e-5
        step = [(coefficients(*table, l + h, p)[0] - coefficients(*table, l - h, p)[0]) / (2 * h),
                (coefficients(*table, l, p + h)[0] - coefficients(*table, l, p - h)[0]) / (2 * h)]  # fmt: skip
        assert step == pytest.approx([by_l, by_p], rel=1e-6, abs=1e-8)


def test_operating_points(record):
    """Statics hold the fixed points of the laws; a run from there does not move."""
    worst = still = 0.0
    for U in (5.0, 7.0, 10.0, 12.0, 18.0, 24.0):
        for tilt, yaw in ((0.0, 0.0), (6.0, 20.0)):
            u = U * math.cos(math.radians(tilt)) * math.cos(math.radians(yaw))
            system = fs.assemble(held(fs.Wind(speed=U, heading_deg=25.0), tilt_deg=tilt, yaw_misalignment_deg=yaw))
            found = fs.simulate(system, 5.0, 0.5)
            rows = np.array([found.series(f"rotor_{name}") for name in ("speed", "pitch", "thrust", "torque")])
            expected = np.array(operating_point(u))
            size = np.maximum(np.abs(expected), (1, 1, 1, 1))
            worst = max(worst, np.max(np.abs(rows[:, 0] - expected) / size))
            still = max(still, np.max(np.abs(rows.T - rows[:, 0]) / size))
    record(CHECK, "operating points, tilted and yawed too: speed, pitch, thrust, torque", worst, 1e-9)
    record(CHECK, "how far a run departs from its operating point in 5 s", still, 1e-9)


def test_forces_on_the_body():
    """Thrust at the hub along the shaft, and the generator's reaction."""
    U, tilt = 8.0, math.radians(5.0)
    system = fs.assemble(held(fs.Wind(speed=U), tilt_deg=5.0, tower_top=(0.0, 0.0, 4.0), shaft_height=1.0,
                              overhang=3.0))  # fmt: skip
    state, _ = fs.solve_static(system)
    _, _, T, Q = operating_point(U * math.cos(tilt))
    n = np.array([math.cos(tilt), 0.0, -math.sin(tilt)])
    w = system.work()
    system.load(w, state)
    w.lam[:] = 0.0
    w.still = True
    system.begin(w, state, 0.0)
    system.evaluate(w)
    hub = np.array([0.0, 0.0, 5.0]) - 3.0 * n
    turn = slice(3 * (system.n_point + 1), 3 * (system.n_point + 1) + 3)
    assert -w.r[turn] == pytest.approx(np.cross(hub, T * n) + Q * n, rel=1e-9, abs=1e-3)
    assert -w.r[0] == pytest.approx(T * n[0], rel=1e-9)


def in_time(system, start, h, duration):
    """States after `duration` in steps of h from the operating point with speed and pitch changed by `start`."""
    k, _ = rotors(system)
    state, _ = fs.solve_static(system)
    state.history[k][0, SPEED] += start[0]
    state.history[k][0, PITCH] += start[1]
    run(system, state, fs.generalised_alpha(0.6), h, round(duration / h))
    return state.history[k][0].copy()


@pytest.mark.parametrize(("U", "start"), [(8.0, (-0.2, 0.0)), (16.0, (0.004, 0.001))])
def test_speed_in_time(U, start, record):
    """Rotor speed, pitch and integrator from off the operating point, hub held, against the differential equations
    integrated by DOP853; second order in time."""
    system = fs.assemble(held(fs.Wind(speed=U)))
    _, batch = rotors(system)
    part, gains = batch.parts[0].controller, batch.data[0][4]
    speed, pitch, *_ = operating_point(U)

    def rates(t, y):
        O, p, I = y
        l = O * RADIUS / U
        Q = AREA * RADIUS * U * U * power(l, p) / l
        G = GAIN * O * O if O < 0.96 * RATED_SPEED else RATED_TORQUE
        if U < 10.0:
            return (Q - G) / INERTIA, 0.0, 0.0
        low = 0.96 * RATED_SPEED
        if O < RATED_SPEED:
            G = RATED_TORQUE - (RATED_TORQUE - GAIN * low**2) / (RATED_SPEED - low) * (RATED_SPEED - O)
        Kp, Ki = (np.interp(p, gains[:, 0], gains[:, k]) for k in (1, 2))
        command = Kp * (O - RATED_SPEED) + I
        return (Q - G) / INERTIA, (command - p) / part.pitch_lag, Ki * (O - RATED_SPEED)

    exact = solve_ivp(rates, (0.0, 1.6), (speed + start[0], pitch + start[1], pitch), method="DOP853", rtol=1e-12,
                      atol=1e-13, max_step=0.01).y[:, -1]  # fmt: skip
    errors = []
    for h in (0.2, 0.1, 0.05):
        y = in_time(system, start, h, 1.6)
        errors.append(np.abs(y[[SPEED, PITCH, INTEGRATOR]] - exact).max())
    record(CHECK, f"rotor speed and pitch in time at {U:g} m/s, order", observed_order(errors), (1.8, 2.3))
    record(CHECK, f"rotor speed and pitch in time at {U:g} m/s, error at 0.05 s", errors[-1], 2e-5, "rad/s, rad")
    assert y[FILTER] == pytest.approx(0.0, abs=1e-12)


def test_velocity_feedback():
    """A hub that is driven at constant speed: the feedback rises to K_f v as 1 - exp(-w_f t). Downwind it turns the
    blades out of the wind: at rated speed the integrator ends up K_f v below the pitch that the relative wind needs."""
    U, v, corner, gain = 16.0, 0.5, 0.4, 0.01
    motion = fs.Motion(lambda t: np.array([v * t, 0, 90.0, 0, 0, 0]), lambda t: np.array([v, 0, 0, 0, 0, 0.0]),
                       lambda t: np.zeros(6))  # fmt: skip
    part = rotor("nacelle", control=dict(velocity_feedback=gain, feedback_corner=corner))
    system = fs.assemble(fs.Model(parts=[body(), part], joints=[fs.Prescribed(a="nacelle", motion=motion)], sea=SEA,
                                  wind=fs.Wind(speed=U)))  # fmt: skip
    k, _ = rotors(system)
    first = fs.simulate(system, 5.0, 0.05).state
    assert first.history[k][0, FILTER] == pytest.approx(v * (1.0 - math.exp(-corner * 5.0)), rel=1e-4)
    last = fs.simulate(system, 150.0, 0.1, state=first).state.history[k][0]
    _, pitch, *_ = operating_point(U - v)
    assert last[[SPEED, PITCH]] == pytest.approx([RATED_SPEED, pitch], rel=1e-6)
    assert pitch - last[INTEGRATOR] == pytest.approx(gain * v, rel=1e-4)


def test_gains_give_frequency_and_damping(record):
    """J O'' + (-Q_O - Q_p K_p) O' - Q_p K_i O = 0 with the chosen w and z at every pitch of the table, slopes of the
    closed form by differences; where the rotor's own damping is more than that, K_p = 0."""
    w, z, h = 0.3, 0.2, 1e-6
    _, batch = rotors(fs.assemble(held(fs.Wind(speed=16.0), control=dict(natural_frequency=w, damping_ratio=z))))
    table = batch.data[0][4]

    def torque(U, O, p):
        l = O * RADIUS / U
        return AREA * RADIUS * U * U * power(l, p) / l

    own, worst = [], 0.0
    for p, Kp, Ki in table:
        U = brentq(lambda U, p=p: operating_point(U)[1] - p, 9.5, 40.0)
        by_speed = (torque(U, RATED_SPEED + h, p) - torque(U, RATED_SPEED - h, p)) / (2 * h)
        by_pitch = (torque(U, RATED_SPEED, p + h) - torque(U, RATED_SPEED, p - h)) / (2 * h)
        own.append(-by_speed / (2 * w * INERTIA))
        worst = max(worst, abs(math.sqrt(-by_pitch * Ki / INERTIA) / w - 1.0),
                    abs(own[-1] - by_pitch * Kp / (2 * w * INERTIA) - max(z, own[-1])))  # fmt: skip
    assert min(own) < z < max(own)
    record(CHECK, "gains of the speed loop: its frequency (relative) and damping ratio", worst, 1e-6)


HALF_TURN = (0.0, 0.0, 0.0, 1.0)  # about the vertical: wind from behind does nothing to a rotor


def test_momentum_is_conserved(record):
    """Angular momentum of a falling body and its rotor while the generator brakes the rotor and the body tumbles."""
    hull = dict(inertia=(3e8, 5e8, 6e8), center_of_mass=(1.0, 0.5, -2.0))
    part = rotor("nacelle", tower_top=(2.0, 0.0, 3.0), tilt_deg=6.0)
    model = fs.Model(parts=[body(**hull, position=(0, 0, 190)), part], sea=SEA, wind=fs.Wind(speed=10.0))
    errors = []
    for h in (0.04, 0.02, 0.01):
        system = fs.assemble(model)
        k, batch = rotors(system)
        state = system.initial_state()
        state.q[0] = HALF_TURN
        state.history[k][0, SPEED] = 1.1
        state.v[6:9] = (0.02, -0.03, 0.04)
        axis = batch.mounted[0].axis
        seen = run(system, state, fs.generalised_alpha(0.9), h, round(4.0 / h),  # fmt: skip
                   lambda s, k=k, axis=axis: momentum(s, axis, s.history[k][0, SPEED], hull), tolerance=1e-10)
        assert state.history[k][0, SPEED] < 1.0
        seen = np.array(seen)
        errors.append(np.abs(seen - seen[0]).max() / np.linalg.norm(seen[0]))
    record(CHECK, "angular momentum of a free body and its braked rotor, change in 4 s at 0.01 s", errors[-1], 1e-5)
    record(CHECK, "angular momentum of a free body and its braked rotor, order", observed_order(errors), (1.7, 2.4))


def momentum(state, axis, speed, hull):
    """Angular momentum (3,) about the body's centre of mass, world axes, of body and rotor."""
    from floatsim.frames import set_matrix

    R = np.zeros((1, 3, 3))
    set_matrix(R, 0, tuple(state.q[0]))
    J = R[0] @ np.diag(hull["inertia"]) @ R[0].T
    return J @ state.v[6:9] + INERTIA * speed * (R[0] @ axis)


def test_precession(record):
    """A heavy body on a pivot with a fast rotor and a horizontal shaft precesses steadily at m g l/(J O)."""
    m, l = 1e5, 5.0
    hull = body(mass=m, inertia=(4e8, 4e8, 4e8), center_of_mass=(l, 0.0, 0.0))
    part = rotor("nacelle", control=dict(torque_gain=1e-6, minimum_speed=0.0))
    model = fs.Model(parts=[hull, part], joints=[fs.Ball(a="nacelle", b=(0, 0, 90))], sea=SEA, wind=fs.Wind(speed=10.0))
    system = fs.assemble(model)
    k, _ = rotors(system)
    state = system.initial_state()
    state.q[0] = HALF_TURN
    O = 1.0
    state.history[k][0, SPEED] = O
    rate = m * 9.81 * l / (INERTIA * O)
    state.v[6:9] = (0.0, 0.0, rate)
    rates = np.array(run(system, state, fs.generalised_alpha(0.6), 0.05, 200, lambda s: s.v[6:9].copy()))
    worst = np.abs(rates - (0.0, 0.0, rate)).max() / rate
    record(CHECK, "steady precession of a heavy body with a rotor, rate over m g l/(J O), less 1", worst, 1e-9)


def sprung(heading_deg=0.0, turbulence=None, ramp=0.0):
    """A body on springs that a rotor shakes, everything turned by heading_deg."""
    b = math.radians(heading_deg)
    turn = np.array([[math.cos(b), -math.sin(b), 0], [math.sin(b), math.cos(b), 0], [0, 0, 1.0]])
    anchors = [(60, 10, 60), (60, -10, 60), (-60, 12, 62), (-60, -10, 60), (5, 60, 60), (0, -60, 60)]
    arms = [(8, 6, -8), (8, -6, -8), (-8, 6, -8), (-8, -6, -8), (6, 8, 5), (-6, -8, 5)]
    hull = body(inertia=(1e9, 1.2e9, 9e8), attitude_deg=(0, 0, heading_deg), center_of_mass=(1.0, 0.0, -12.0),
                points={f"p{k}": arm for k, arm in enumerate(arms)})  # fmt: skip
    parts = [hull, rotor("nacelle", tower_top=(0, 0, 20), overhang=5.0, tilt_deg=5.0,
                         control=dict(velocity_feedback=0.005),
                         tower=fs.Tower(base=(0, 0, -10), top=(0, 0, 20), diameter=(6, 4)))]  # fmt: skip
    for k, p in enumerate(anchors):
        place = tuple(turn @ np.array(p, dtype=float))
        parts.append(fs.Spring(name=f"s{k}", a=f"nacelle.p{k}", b=place, stiffness=2e6, free_length=50.0, damping=1e4))
    wind = fs.Wind(speed=14.0, heading_deg=heading_deg, shear=0.14, turbulence=turbulence)
    return fs.Model(parts=parts, sea=fs.Sea(depth=200.0, wave_ramp=ramp), wind=wind, gravity=0.0)


GUSTS = fs.Kaimal(intensity=0.2, seed=4, components=200, duration=600.0)


def test_second_order(record):
    """Body, springs and rotor together: differences between steps of h, h/2 and h/4."""
    ends = []
    for h in (0.04, 0.02, 0.01):
        system = fs.assemble(sprung(turbulence=GUSTS))
        found = fs.simulate(system, 4.0, h, interval=4.0, tolerance=1e-11)
        k, _ = rotors(system)
        ends.append(np.concatenate([found.series("nacelle_position")[-1], found.state.history[k][0]]))
    order = np.log2(np.linalg.norm(ends[0] - ends[1]) / np.linalg.norm(ends[1] - ends[2]))
    record(CHECK, "body on springs with a rotor in gusts, order", order, (1.8, 2.3))


def test_turned_by_an_angle(record):
    """Wind, body and springs turned by 37 degrees: the same."""
    runs = [fs.simulate(sprung(angle, GUSTS), 8.0, 0.1, tolerance=1e-11) for angle in (0.0, 37.0)]
    worst = 0.0
    for name in ("speed", "pitch", "thrust", "torque", "relative_wind"):
        a, b = (found.series(f"rotor_{name}") for found in runs)
        assert np.abs(a).max() > 0.0
        worst = max(worst, np.abs(a - b).max() / np.abs(a).max())
    record(CHECK, "everything turned by 37 degrees, largest change", worst, 1e-8)


def test_repeats_bit_for_bit_and_restarts():
    model = sprung(turbulence=GUSTS)  # with a step whose multiples are exact
    whole = fs.simulate(model, 6.0, 0.125)
    again = fs.simulate(model, 6.0, 0.125)
    assert whole.rows.tobytes() == again.rows.tobytes()
    first = fs.simulate(model, 3.0, 0.125)
    rest = fs.simulate(model, 3.0, 0.125, state=pickle.loads(pickle.dumps(first.state)))
    assert rest.series("rotor_speed")[-1] == whole.series("rotor_speed")[-1]
    assert rest.series("nacelle_position")[-1].tobytes() == whole.series("nacelle_position")[-1].tobytes()


def test_ledger_closes(record):
    found = fs.simulate(sprung(turbulence=GUSTS), 10.0, 0.02, energy=True)
    assert found.energy.work["wind"] != 0.0
    record(CHECK, "energy ledger of a body on springs with rotor and tower, error", found.energy.closure, 1e-3)


def test_gusts_rise_with_the_ramp():
    found = fs.simulate(sprung(turbulence=GUSTS, ramp=5.0), 6.0, 0.1)
    wind, point = found.series("rotor_wind_speed"), found.series("wind_speed")
    assert wind[0] == pytest.approx(14.0) and point[0] == 14.0
    disc = GUSTS.realise(14.0, RADIUS)
    assert wind[25] == pytest.approx(14.0 + 0.5 * disc.at(2.5)) and wind[-1] == pytest.approx(14.0 + disc.at(6.0))
    # nothing happens before: statics and the run's start are the same operating point
    assert abs(found.series("rotor_speed")[1] / found.series("rotor_speed")[0] - 1.0) < 1e-4


def test_tower_drag():
    """On a held tower, against the integral of 1/2 rho C_D d U(z)^2."""
    wind = fs.Wind(speed=20.0, shear=0.14, height=90.0)
    tower = fs.Tower(base=(0, 0, -80), top=(0, 0, 0), diameter=(8.0, 4.0), drag=0.6, strips=200)
    forces = []
    for standing in (None, tower):
        system = fs.assemble(held(wind, tower=standing))
        w, state = system.work(), system.initial_state()
        system.load(w, state)
        w.still = True
        system.begin(w, state, 0.0)
        system.evaluate(w)
        forces.append(-w.r[0])
    z = np.linspace(10.0, 90.0, 2001)
    d = 8.0 - 4.0 * (z - 10.0) / 80.0
    exact = np.trapezoid(0.5 * 1.225 * 0.6 * d * (20.0 * (z / 90.0) ** 0.14) ** 2, z)
    assert forces[1] - forces[0] == pytest.approx(exact, rel=1e-4)


def test_parked_rotor():
    """Beyond cut-out it stands, and only drag is left."""
    found = fs.simulate(held(fs.Wind(speed=40.0), parked_drag_area=100.0), 1.0, 0.1)
    assert np.all(found.series("rotor_speed") == 0.0) and np.all(found.series("rotor_thrust") == 0.0)
    system = fs.assemble(held(fs.Wind(speed=40.0), parked_drag_area=100.0))
    w, state = system.work(), system.initial_state()
    system.load(w, state)
    system.begin(w, state, 0.0)
    system.evaluate(w)
    assert -w.r[0] == pytest.approx(0.5 * 1.225 * 100.0 * 40.0**2)
