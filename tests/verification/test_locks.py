"""Locks (latching): held and released oscillators against closed forms, impacts, restarts, statics."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from closed_forms import physical_pendulum
from mechanics import DRY, observed_order

import floatsim as fs
from floatsim.joints.hinge import Hinge
from floatsim.joints.lock import Lock
from floatsim.joints.slider import Slider
from floatsim.joints.universal import Universal

G = 9.81
CHECK = "locks"
K, M, X0 = 200.0, 3.0, 0.7  # N/m, kg, m
W = np.sqrt(K / M)
T = 2.0 * np.pi / W


def oscillator(v=0.0, x=X0, **lock):
    """Cart on a rail along x with a spring, from x with speed v; no gravity."""
    cart = fs.Body(name="cart", mass=M, inertia=(1, 1, 1), position=(10.0 + x, 0, 5))
    spring = fs.Spring(name="spring", a="cart", b=(0, 0, 5), stiffness=K, free_length=10.0)
    parts = [cart, spring, Lock(name="lock", joint="rail", **lock)]
    rail = Slider(a="cart", b=(10.0, 0, 5), axis=(1, 0, 0), zero=x, name="rail")
    system = fs.assemble(fs.Model(parts=parts, joints=[rail], sea=DRY, gravity=0.0))
    state = system.initial_state()
    state.v[0] = v
    return system, state


def held_at_turn(t, start=0.5 * T, lasts=0.8 * T):
    """Free from X0 at rest, held at the turning point for a while, then free again."""
    later = np.maximum(t - start - lasts, 0.0)
    return np.where(t < start, X0 * np.cos(W * t), -X0 * np.cos(W * later))


@pytest.mark.parametrize("rule", ["times", "controller", "latch_for"])
def test_latched_oscillator(rule, record):
    """Locked at its turning point and released: displacement within 0.5 % of the closed form (the issue's bar)."""
    how = {
        "times": dict(engage=(0.5 * T,), release=(1.3 * T,)),
        "controller": dict(controller=lambda t, s, ds: 0.5 * T - 1e-9 <= t < 1.3 * T - 1e-9),
        "latch_for": dict(latch_for=0.8 * T),
    }[rule]
    duration = 1.75 * T  # before it would latch for the second time
    errors = []
    for n in (100, 200):
        system, state = oscillator(**how)
        dt = T / n
        run = fs.simulate(system, duration, dt, state=state, tolerance=1e-9)
        assert run.status == "done", run.failure
        x = run.series("cart_position")[:, 0] + X0
        engaged = run.series("lock_engaged")
        start = run.time[np.argmax(engaged) - 1]
        assert abs(start - 0.5 * T) <= (dt if rule == "latch_for" else 0.0) + 1e-9  # by the samples
        errors.append(np.abs(x - held_at_turn(run.time, start)).max() / X0)
        assert engaged[int(0.9 * n)] == 1.0 and engaged[int(0.4 * n)] == 0.0 and engaged[int(1.5 * n)] == 0.0
        during = (run.time > 0.55 * T) & (run.time < 1.25 * T)
        force = run.series("lock_force")[:, 0]
        # the spring pushes the cart with K X0 towards +x, the lock holds it: so much of the cart on the ground
        assert np.abs(force[during] - K * X0).max() < 5e-3 * K * X0
        assert np.abs(force[~during & (run.time < 0.5 * T)]).max() == 0.0
    record(CHECK, f"latched oscillator ({rule}), 200 steps a period: displacement", errors[-1], 5e-3)
    if rule == "times":
        record(CHECK, "latched oscillator: order, release included", observed_order(errors), (1.8, 2.2))
        record(CHECK, "latched oscillator: energy lost at the turning point, of all",
               run.series("lock_energy_lost")[-1] / (0.5 * K * X0**2), 1e-5)  # fmt: skip


def latched(t, lasts):
    """Free from X0 at rest, held for `lasts` at every turning point."""
    cycle = 0.5 * T + lasts
    k, s = np.divmod(t, cycle)
    return (-1.0) ** k * X0 * np.where(s < 0.5 * T, np.cos(W * np.minimum(s, 0.5 * T)), -1.0)


def test_events_within_steps(record):
    """Neither the turning points nor the releases are on the grid of steps: steps are divided there, and after 28 of
    them the displacement is still of second order (met at ends of steps, each would cost up to half a step)."""
    errors = []
    for dt in (0.01, 0.005, 0.0025):
        system, state = oscillator(latch_for=0.3137)
        run = fs.simulate(system, 20.0, dt, state=state, tolerance=1e-9)
        assert run.status == "done" and run.series("step_size").min() < 0.99 * dt
        errors.append(np.abs(run.series("cart_position")[:, 0] + X0 - latched(run.time, 0.3137)).max() / X0)
    record(CHECK, "latched 28 times off the grid, 300 steps a period: displacement", errors[-1], 5e-3)
    record(CHECK, "latched 28 times off the grid: order", observed_order(errors), (1.8, 2.3))


def test_times_within_steps(record):
    """Held from 0.4321 T on, released 0.7 T later, in steps of T/200 that meet neither."""
    start, lasts = 0.4321 * T, 0.7003 * T
    system, state = oscillator(engage=(start,), release=(start + lasts,))
    run = fs.simulate(system, 1.75 * T, T / 200.0, state=state, tolerance=1e-9)
    held = X0 * np.cos(W * start)
    later = np.maximum(run.time - start - lasts, 0.0)
    exact = np.where(run.time < start, X0 * np.cos(W * run.time), held * np.cos(W * later))
    error = np.abs(run.series("cart_position")[:, 0] + X0 - exact).max() / X0
    record(CHECK, "held and released off the grid, 200 steps a period: displacement", error, 1e-3)


def test_rounding_errors_of_a_rest_do_not_latch():
    """In gravity the cart of a vertical spring rests but for rounding; pushed later it latches at its first turn."""
    cart = fs.Body(name="cart", mass=M, inertia=(1, 1, 1), position=(0, 0, 20 - M * G / K))
    spring = fs.Spring(name="spring", a="cart", b=(0, 0, 30), stiffness=K, free_length=10.0)
    rail = Slider(a="cart", b=(0, 0, 0), axis=(0, 0, 1), name="rail")
    lock = Lock(name="lock", joint="rail", latch_for=0.1)
    run = fs.simulate(fs.Model(parts=[cart, spring, lock], joints=[rail], sea=DRY, gravity=G), 5.0, 0.01)
    assert np.abs(run.series("cart_position")).max() < 1e-6
    state = run.state.copy()
    state.v[2], state.step = 1.0, 0.0
    run = fs.simulate(run.sampler.system, 0.5 * T, T / 200, state=state)
    first = run.time[np.argmax(run.series("lock_engaged"))] - 5.0
    assert first == pytest.approx(0.25 * T, abs=2.0 * T / 200)


def test_speed_and_force_are_of_second_order_after_release(record):
    errors = {"speed": [], "spring force": [], "acceleration": []}
    for n in (100, 200, 400):
        system, state = oscillator(engaged=True, release=(0.3 * T,))
        run = fs.simulate(system, 1.3 * T, T / n, state=state, tolerance=1e-10)
        free = run.time > 0.3 * T + 0.5 * T / n
        t = (run.time - 0.3 * T)[free]
        exact = {"speed": -W * X0 * np.sin(W * t), "spring force": K * X0 * np.cos(W * t),
                 "acceleration": -W**2 * X0 * np.cos(W * t)}  # fmt: skip
        got = {"speed": run.series("cart_velocity")[free, 0], "spring force": run.series("spring_force")[free],
               "acceleration": run.series("cart_acceleration")[free, 0]}  # fmt: skip
        for name, e in errors.items():
            e.append(np.abs(got[name] - exact[name]).max() / np.abs(exact[name]).max())
    for name, e in errors.items():
        record(CHECK, f"released oscillator, 400 steps a period: {name}", e[-1], 1e-3)
        record(CHECK, f"released oscillator: order of {name}", observed_order(e), (1.8, 2.2))


def test_engaging_in_motion_takes_the_kinetic_energy(record):
    """Locked at full speed: stops at once, loses m v^2/2; released it starts from rest where it was held."""
    v = W * X0
    system, state = oscillator(v=v, x=0.0, engage=(0.125 * T,), release=(0.5 * T,))
    run = fs.simulate(system, T, T / 400, state=state, tolerance=1e-9)
    at = X0 * np.sin(0.25 * np.pi)
    lost = 0.5 * M * (v * np.cos(0.25 * np.pi)) ** 2
    record(CHECK, "engaging in motion: energy lost", abs(run.series("lock_energy_lost")[-1] / lost - 1.0), 1e-3)
    during = (run.time > 0.13 * T) & (run.time < 0.5 * T)
    x = run.series("cart_position")[:, 0]
    assert np.abs(run.series("cart_velocity")[during, 0]).max() < 1e-4 * v
    assert np.ptp(x[during]) < 1e-8
    after = run.time > 0.5 * T
    exact = at * np.cos(W * (run.time[after] - 0.5 * T))
    record(CHECK, "engaging in motion: displacement after the release", np.abs(x[after] - exact).max() / X0, 1e-3)


def test_plastic_impact_of_two_free_bodies(record):
    """The lock of a slider between free bodies: momentum stays, speeds become one, 1/2 mu v^2 is lost."""
    m1, m2, v1, v2 = 2.0, 5.0, 1.3, -0.4
    parts = [fs.Body(name=name, mass=m, inertia=(1, 1, 1), position=(x, 0, 50)) for name, m, x in
             (("one", m1, 0.0), ("two", m2, 3.0))] + [Lock(name="lock", joint="tube", engage=(0.5,))]  # fmt: skip
    joint = Slider(a="two", b="one", axis=(1, 0, 0), name="tube")
    system = fs.assemble(fs.Model(parts=parts, joints=[joint], sea=DRY, gravity=0.0))
    state = system.initial_state()
    state.v[0], state.v[3] = v1, v2
    run = fs.simulate(system, 1.0, 0.01, state=state, tolerance=1e-10)
    common = (m1 * v1 + m2 * v2) / (m1 + m2)
    v = [run.series(f"{name}_velocity")[-1, 0] for name in ("one", "two")]
    record(CHECK, "plastic impact: speeds", np.abs(np.array(v) - common).max(), 1e-8, "m/s")
    lost = 0.5 * m1 * m2 / (m1 + m2) * (v1 - v2) ** 2
    record(CHECK, "plastic impact: energy lost", abs(run.series("lock_energy_lost")[-1] / lost - 1.0), 1e-8)


def pendulum(**lock):
    R = np.array([-np.sin(1.0), 0, -np.cos(1.0)])
    bob = fs.Body(name="bob", mass=2.0, inertia=(0.3, 0.4, 0.3), position=tuple(np.array([0, 0, 10.0]) + R),
                  attitude_deg=(0, np.degrees(1.0), 0), points={"top": (0, 0, 1.0)})  # fmt: skip
    parts = [bob, Lock(name="lock", joint="hinge", **lock)]
    joint = Hinge(a="bob.top", b=(0, 0, 10), axis=(0, 1, 0), name="hinge", zero=1.0)
    return fs.assemble(fs.Model(parts=parts, joints=[joint], sea=DRY, gravity=G))


def test_locked_hinge(record):
    """A pendulum held at 1 rad until 0.4 s, its moment m g sin(1); free afterwards as the closed form."""
    errors = []
    for n in (200, 400):
        system = pendulum(engaged=True, release=(0.4,))
        run = fs.simulate(system, 2.4, 2.4 / (1.2 * n), tolerance=1e-10)  # statics start from the held position
        assert run.status == "done", run.failure
        held = (run.time > 0.0) & (run.time < 0.4 + 1e-9)
        # the lock holds the bob up: moment of the weight about y is -m g sin(1) on it; on the ground, through the
        # lock, the same
        moment = run.series("lock_moment")[held, 1]
        worst = np.abs(moment + 2.0 * G * np.sin(1.0)).max() / (2.0 * G)
        theta, *_ = physical_pendulum(2.0 * G / 2.4, 1.0, np.concatenate([[0.0], run.time[~held][1:] - 0.4]))
        angle = run.series("bob_position")[~held, 4]
        errors.append(np.abs(angle[1:] - theta[1:]).max())
        assert np.abs(run.series("bob_position")[held, 4] - 1.0).max() < 1e-9
    record(CHECK, "locked hinge: moment of the weight", worst, 1e-6)
    record(CHECK, "locked hinge, released, dt 5 ms: angle", errors[-1], 1e-3, "rad")
    record(CHECK, "locked hinge, released: order", observed_order(errors), (1.8, 2.2))


@pytest.mark.parametrize(("coordinate", "axis"), [("first", (1, 0, 0)), ("second", (0, 1, 0))])
def test_locked_universal_joint(coordinate, axis, record):
    """An arm at 45 degrees between the axes: each lock carries its share of the weight's moment, a on b."""
    bob = fs.Body(name="bob", mass=2.0, inertia=(1, 1, 1), center_of_mass=(0.7, 0.7, 0), position=(0, 0, 10))
    parts = [bob, *(Lock(name=name, joint="cross", coordinate=name, engaged=True) for name in ("first", "second"))]
    joint = Universal(a="bob", b=(0, 0, 10), first=(1, 0, 0), second=(0, 1, 0), name="cross")
    run = fs.simulate(fs.Model(parts=parts, joints=[joint], sea=DRY, gravity=G), 0.1, 0.01)
    exact = np.dot(np.cross((0.7, 0.7, 0), (0, 0, -2.0 * G)), axis) * np.array(axis)
    error = np.abs(run.series(f"{coordinate}_moment") - exact).max() / np.abs(exact).max()
    record(CHECK, f"locked universal joint: moment of the {coordinate} lock", error, 1e-7)


def test_statics_respect_locks():
    held, _ = fs.solve_static(pendulum(engaged=True))
    assert held.x[0] == pytest.approx((-np.sin(1.0), 0, 10 - np.cos(1.0)), abs=1e-9)
    free, _ = fs.solve_static(pendulum())
    assert free.x[0] == pytest.approx((0, 0, 9), abs=1e-6)
    # a state whose lock was released meanwhile finds the free equilibrium, one still engaged the held one
    for release, z in ((0.1, 9.0), (5.0, 10 - np.cos(1.0))):
        system = pendulum(engaged=True, release=(release,))
        run = fs.simulate(system, 0.5, 0.01)
        rest, _ = fs.solve_static(system, run.state)
        assert rest.x[0, 2] == pytest.approx(z, abs=1e-6)


@pytest.mark.parametrize("copy", [lambda s: s.copy(), lambda s: pickle.loads(pickle.dumps(s))])
@pytest.mark.parametrize("part", [0.4, 0.8, 1.5])
def test_restart(copy, part):
    """Stopped before, during and after the lock and taken up again: the same run."""
    dt = T / 100
    system, state = oscillator(latch_for=0.8 * T)
    whole = fs.simulate(system, 2.5 * T, dt, state=state)
    first = fs.simulate(system, part * T, dt, state=state)
    second = fs.simulate(system, (2.5 - part) * T, dt, state=copy(first.state))
    assert second.state.x == pytest.approx(whole.state.x, abs=1e-12)
    assert second.state.lam == pytest.approx(whole.state.lam, abs=1e-6)
    assert whole.series("lock_engaged").max() == 1.0
    assert second.series("lock_energy_lost")[-1] == pytest.approx(whole.series("lock_energy_lost")[-1], rel=1e-6)


def test_stable_for_long(record):
    """Engaged 10000 steps with the default scheme: multiplier and position do not drift or blow up."""
    system, state = oscillator(engaged=True)
    stepper = fs.Stepper(system)
    for _ in range(10000):
        assert stepper.step(state, 0.01).converged
    record(CHECK, "engaged for 10000 steps: displacement", abs(state.x[0, 0] - 10.0 - X0), 1e-9, "m")
    record(CHECK, "engaged for 10000 steps: force", abs(abs(state.lam[-1]) / (K * X0) - 1.0), 1e-4)


def test_modes_with_a_lock():
    """Released, the cart has its own mode."""
    system, _ = oscillator()
    assert fs.natural_modes(system, count=1)[0].period == pytest.approx(T, rel=1e-6)


def test_bad_controller():
    system, state = oscillator(controller=lambda t, s, ds: 1.0)
    run = fs.simulate(system, 0.1, 0.01, state=state)
    assert run.status == "failed" and "controller(0, ...) is 1.0; must be True or False" in run.failure
    system, state = oscillator(controller=lambda t, s, ds: 1 / 0)
    run = fs.simulate(system, 0.1, 0.01, state=state)
    assert run.status == "failed" and "Lock 'lock': controller fails: ZeroDivisionError" in run.failure
