"""Joints: the two forms of the ball joint, prescribed motion, welds."""

from __future__ import annotations

import numpy as np
import pytest
from mechanics import DRY, end_force, run

import floatsim as fs
from floatsim.frames import matrix_from_angles

G = 9.81


def held_line(form, EI, top=None):
    """A sagging line from the ground to a fixed or a moving upper end."""
    sec = fs.Section(name="cable", mass_per_length=20.0, diameter=0.1, EA=1e7, EI=EI, bending_damping=0.1 * EI,
                     axial_damping=1e4, drag_normal=1.2, drag_tangential=0.1, added_mass_normal=1.0)  # fmt: skip
    line = fs.Line(name="line", section=sec, length=60.0, elements=12, form=form)
    upper = fs.Ball(a="line.end_b", b=(40.0, 0.0, -10.0), name="top") if top is None else fs.Prescribed(
        a="line.end_b", motion=top, name="top")  # fmt: skip
    joints = [fs.Ball(a="line.end_a", b=(0.0, 0.0, -40.0), name="low"), upper]
    system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=fs.Sea(depth=45.0), gravity=G))
    return system, line


def tensions(system, state):
    w = system.work()
    system.load(w, state)
    return system.batches[0].tension(w)


@pytest.mark.parametrize("EI", [0.0, 5e4])
def test_two_forms_of_the_ball_joint_statically(EI, record):
    results = {}
    for form in ("shared", "ball_joints"):
        system, line = held_line(form, EI)
        state, _ = fs.solve_static(system)
        results[form] = state.x[line.nodes], tensions(system, state), end_force(system, state, "top")
    one, two = results["shared"], results["ball_joints"]
    check, name = "ball joints: shared nodes against multipliers", f"static, EI {EI:g}"
    record(check, f"{name}: positions over the length", np.abs(one[0] - two[0]).max() / 60.0, 1e-8)
    record(check, f"{name}: tensions", np.abs(one[1] - two[1]).max() / np.abs(one[1]).max(), 1e-6)
    record(check, f"{name}: end force", np.abs(one[2] - two[2]).max() / np.linalg.norm(one[2]), 1e-6)


@pytest.mark.parametrize("EI", [0.0, 5e4])
def test_two_forms_of_the_ball_joint_dynamically(EI, record):
    """Upper end on an ellipse for 6 s."""
    w, a = 2.0 * np.pi / 4.0, np.array([1.5, 0.4, 0.8])
    start = np.array([40.0, 0.0, -10.0])
    motion = fs.Motion(
        lambda t: start + a * np.array([1 - np.cos(w * t), np.sin(w * t) - w * t * np.exp(-t), 1 - np.cos(w * t)]),
        lambda t: a * w * np.array([np.sin(w * t), np.cos(w * t) - (1 - t) * np.exp(-t), np.sin(w * t)]),
        lambda t: a * w * np.array([w * np.cos(w * t), -w * np.sin(w * t) + (2 - t) * np.exp(-t), w * np.cos(w * t)]),
    )
    results = {}
    for form in ("shared", "ball_joints"):
        system, line = held_line(form, EI, motion)
        state, _ = fs.solve_static(system)

        def watch(s, system=system, line=line):
            return s.x[line.nodes].copy(), tensions(system, s), end_force(system, s, "top")

        seen = run(system, state, fs.generalised_alpha(0.6), 0.05, 120, watch, tolerance=1e-9)
        results[form] = [np.array([row[k] for row in seen]) for k in range(3)]
    one, two = results["shared"], results["ball_joints"]
    check, name = "ball joints: shared nodes against multipliers", f"dynamic, EI {EI:g}"
    record(check, f"{name}: positions over the length", np.abs(one[0] - two[0]).max() / 60.0, 1e-8)
    record(check, f"{name}: tensions", np.abs(one[1] - two[1]).max() / np.abs(one[1]).max(), 1e-6)
    record(check, f"{name}: end force", np.abs(one[2] - two[2]).max() / np.linalg.norm(one[2], axis=-1).max(), 1e-6)


# --- prescribed motion -------------------------------------------------------------------------------------------

AMPLITUDE = np.array([0.5, -0.3, 0.4, 0.7, 0.5, 1.2])
PHASE = np.array([0.0, 0.3, 0.6, 0.1, 0.8, 0.4])
OFFSET = np.array([1.0, 2.0, 30.0, 0.2, -0.3, 0.4])
RATE = 1.7


def columns(t, order):
    """Six columns of a smooth motion, or their derivatives."""
    wave = (np.sin, np.cos, lambda y: -np.sin(y))[order](RATE * t + PHASE)
    return (OFFSET if order == 0 else 0.0) + AMPLITUDE * RATE**order * wave


def rotation(t):
    return matrix_from_angles(*columns(t, 0)[3:])


def prescribed(motion):
    start = motion.translation(0.0)[0]
    body = fs.Body(name="body", mass=4.0, inertia=(2.0, 3.0, 4.0, 0.2, -0.3, 0.1), center_of_mass=(0.3, -0.2, 0.5),
                   position=tuple(start), attitude_deg=tuple(np.degrees(columns(0.0, 0)[3:])))  # fmt: skip
    joint = fs.Prescribed(a="body", motion=motion, name="drive")
    return fs.assemble(fs.Model(parts=[body], joints=[joint], sea=DRY, gravity=G)), body


def analytic():
    return fs.Motion(lambda t: columns(t, 0), lambda t: columns(t, 1), lambda t: columns(t, 2))


def newton_euler(body, t):
    """Force and moment on the body at its reference point, from differences of its momentum."""
    e = 1e-4

    def momentum(s):
        R = rotation(s)
        dR = (-rotation(s + 2 * e) + 8 * rotation(s + e) - 8 * rotation(s - e) + rotation(s - 2 * e)) / (12 * e)
        W = dR @ R.T
        w = np.array([W[2, 1], W[0, 2], W[1, 0]])
        rc = R @ np.array(body.center_of_mass)
        v = columns(s, 1)[:3] + np.cross(w, rc)
        p = body.mass * v
        return p, R @ body.inertia_tensor @ R.T @ w, rc, v

    d = [momentum(t + k * e) for k in (-2, -1, 1, 2)]
    rate = [(d[0][k] - 8 * d[1][k] + 8 * d[2][k] - d[3][k]) / (12 * e) for k in (0, 1)]
    weight = np.array([0.0, 0.0, -body.mass * G])
    force = rate[0] - weight
    return force, rate[1] + np.cross(momentum(t)[2], force)


def test_prescribed_motion_of_a_body(record):
    """Reaction force and moment against Newton and Euler, by differences of momenta of the given motion."""
    system, body = prescribed(analytic())
    errors = []
    for n in (100, 200):
        state = system.initial_state()
        stepper = fs.Stepper(system, fs.generalised_alpha(0.6), 1e-10)
        stepper.start(state, 3.0 / n)
        worst = np.zeros(2)
        for k in range(n):
            assert stepper.step(state, 3.0 / n).converged
            force, moment = newton_euler(body, state.t)
            # the multipliers of the axes give the moment: generalised forces of all rows on the rotation
            w = stepper.work
            system.load(w, state)
            system.constraints.move(state.t)
            w.r[:] = w.s[:] = w.A[:] = 0.0
            system.constraints.add(w)
            if k >= n // 2:
                worst[0] = max(worst[0], np.abs(-w.r[:3] - force).max() / np.abs(force).max())
                worst[1] = max(worst[1], np.abs(-w.r[6:9] - moment).max() / np.abs(moment).max())
        errors.append(worst)
        R = rotation(state.t)
        assert stepper.work.R[0] == pytest.approx(R, abs=1e-8)
        assert state.x[0] == pytest.approx(columns(state.t, 0)[:3], abs=1e-8)
    print(errors)
    order = np.log2(errors[0] / errors[1])
    for k, name in enumerate(("force", "moment")):
        record("prescribed motion of a body", f"reaction {name}, dt 0.015 s", errors[1][k], 0.02)
        record("prescribed motion of a body", f"reaction {name}, order", order[k], (1.8, 2.2))


def test_angular_velocity_belongs_to_the_rotation(record):
    """w and alpha of a motion against differences of its rotation matrix."""
    motion = analytic()
    e, worst = 1e-4, 0.0
    for t in np.linspace(0.0, 3.0, 7):
        R, w, alpha = motion.rotation(t)
        dR = (rotation(t + e) - rotation(t - e)) / (2 * e)
        W = dR @ R.T
        dw = (motion.rotation(t + e)[1] - motion.rotation(t - e)[1]) / (2 * e)
        worst = max(worst, np.abs([W[2, 1], W[0, 2], W[1, 0]] - w).max(), np.abs(dw - alpha).max())
    record("prescribed motion of a body", "angular velocity and acceleration against differences", worst, 1e-6, "rad/s")


def test_recorded_motion_drives_like_the_function(record):
    """Through a C2 spline of 50 Hz samples: the same reaction as with the functions, after the spline's ends."""
    time = np.arange(-1.0, 5.0, 0.02)
    series = fs.Motion.from_series(time, np.array([columns(t, 0) for t in time]))
    results = []
    for motion in (analytic(), series):
        system, _ = prescribed(motion)
        results.append(np.array(run(system, system.initial_state(), fs.generalised_alpha(0.6), 0.02, 100,
                                    lambda s: s.lam.copy(), tolerance=1e-9)))  # fmt: skip
    error = np.abs(results[0] - results[1]).max() / np.abs(results[0]).max()
    record("prescribed motion of a body", "recorded at 50 Hz against functions: reactions", error, 1e-3)


# --- welds -------------------------------------------------------------------------------------------------------


def test_two_welded_bodies_are_one(record):
    """Two bodies welded together fly and turn like the one body they make."""
    J1, J2 = np.diag([2.0, 3.0, 4.0]), np.diag([1.0, 1.5, 0.8])
    m1, m2, d = 5.0, 3.0, np.array([0.8, 0.3, -0.4])
    c = m2 * d / (m1 + m2)

    def moved(J, m, r):
        return J + m * (r @ r * np.eye(3) - np.outer(r, r))

    J = moved(J1, m1, -c) + moved(J2, m2, d - c)
    six = (J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2])
    one = fs.Body(name="one", mass=m1, inertia=(2.0, 3.0, 4.0), position=(0, 0, 50), points={"p": tuple(d)})
    two = fs.Body(name="two", mass=m2, inertia=(1.0, 1.5, 0.8), position=tuple(d + [0, 0, 50]))
    pair = fs.assemble(fs.Model(parts=[one, two], joints=[fs.Weld(a="one.p", b="two")], sea=DRY, gravity=G))
    whole = fs.Body(name="one", mass=m1 + m2, inertia=six, center_of_mass=tuple(c), position=(0, 0, 50))
    single = fs.assemble(fs.Model(parts=[whole], sea=DRY, gravity=G))
    w = np.array([1.0, 2.0, -1.5])
    ends = []
    for system in (pair, single):
        state = system.initial_state()
        n = system.n_point
        state.v[3 * n + 3 : 3 * n + 6] = w
        if n == 2:
            state.v[3:6] = np.cross(w, d)
            state.v[12:15] = w
        run(system, state, fs.generalised_alpha(0.6), 2e-3, 1000)
        ends.append(np.concatenate([state.x[0], state.q[0]]))
    record("welds", "two welded bodies against one, after 2 s", np.abs(ends[0] - ends[1]).max(), 2e-5)


def test_weld_carries_a_cantilevered_weight(record):
    """Body welded to the ground: force and moment are its weight and its weight's moment."""
    body = fs.Body(name="arm", mass=7.0, inertia=(1, 1, 1), center_of_mass=(2.0, 0.5, 0.0), position=(0, 0, 10))
    system = fs.assemble(
        fs.Model(parts=[body], joints=[fs.Weld(a="arm", b=(0, 0, 10), name="root")], sea=DRY, gravity=G)
    )
    state, _ = fs.solve_static(system)
    w = system.work()
    system.load(w, state)
    system.constraints.add(w)
    assert end_force(system, state, "root") == pytest.approx((0, 0, -7.0 * G), abs=1e-8)
    exact = np.cross((2.0, 0.5, 0.0), (0.0, 0.0, -7.0 * G))  # of the weight, held by the joint
    record("welds", "moment of a cantilevered weight", np.abs(-w.r[6:9] + exact).max() / np.abs(exact).max(), 1e-9)
