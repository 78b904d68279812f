"""Order and energy of the integrator: pendulums, a swinging cable, a free body, the heavy top."""

from __future__ import annotations

import numpy as np
import pytest
from closed_forms import physical_pendulum
from mechanics import DRY, end_force, natural_frequencies, observed_order, run
from scipy.integrate import solve_ivp

import floatsim as fs

G = 9.81
SCHEMES = {"generalised_alpha(0.6)": fs.generalised_alpha(0.6), "hht(0.05)": fs.hht(0.05)}


def last_half_errors(runs, exact):
    """Largest error over the second half of the interval, of each column group, relative to its size."""
    half = len(exact) // 2
    size = np.abs(exact[half:]).max(axis=0).max()
    return np.abs(np.asarray(runs)[half:] - exact[half:]).max() / size


# --- order ---------------------------------------------------------------------------------------------------


def pendulum(arm=1.0, angle=1.0, mass=2.0, inertia=0.6):
    """Body whose centre of mass hangs `arm` below a ball joint at (0, 0, 10), turned by `angle` about y."""
    position = (-arm * np.sin(angle), 0.0, 10.0 - arm * np.cos(angle))
    body = fs.Body(name="bob", mass=mass, inertia=(0.9 * inertia, inertia, 0.8 * inertia), position=position,
                   attitude_deg=(0.0, float(np.degrees(angle)), 0.0), points={"pivot": (0.0, 0.0, arm)})  # fmt: skip
    return fs.assemble(
        fs.Model(parts=[body], joints=[fs.Ball(a="bob.pivot", b=(0, 0, 10), name="pivot")], sea=DRY, gravity=G)
    )


def pendulum_motion(times, arm=1.0, angle=1.0, mass=2.0, inertia=0.6):
    """Closed form: position (n, 3), velocity and the force on the ground."""
    theta, rate, acc = physical_pendulum(mass * G * arm / (inertia + mass * arm**2), angle, times)
    s, c, o = np.sin(theta), np.cos(theta), np.zeros_like(theta)
    x = np.stack([-arm * s, o, 10.0 - arm * c], axis=1)
    v = np.stack([-arm * c * rate, o, arm * s * rate], axis=1)
    a = np.stack([-arm * (c * acc - s * rate**2), o, arm * (s * acc + c * rate**2)], axis=1)
    return x, v, -mass * (a + np.array([0.0, 0.0, G]))


def watch_pendulum(state):
    return np.concatenate([state.x[0], state.v[:3], state.lam])


@pytest.mark.parametrize("scheme", [*SCHEMES, "newmark(gamma=0.6)"])
def test_order_on_a_pendulum(scheme, record):
    """Body on a ball joint, 3 s from 1 rad, against the closed form."""
    first = scheme.startswith("newmark")
    member = fs.newmark(0.3025, 0.6) if first else SCHEMES[scheme]
    errors = {"position": [], "velocity": [], "multipliers": []}
    for n in (150, 300, 600, 1200):
        system = pendulum()
        seen = np.array(run(system, system.initial_state(), member, 3.0 / n, n, watch_pendulum))
        exact = pendulum_motion(np.linspace(0.0, 3.0, n + 1))
        for k, name in enumerate(errors):
            errors[name].append(last_half_errors(seen[:, 3 * k : 3 * k + 3], exact[k]))
    print(scheme, errors)
    for name, e in errors.items():
        bar = (0.9, 1.1) if first else (1.9, 2.1)
        record("order of the integrator", f"pendulum, {name}, {scheme}", observed_order(e), bar)


def one_element():
    """A mass on a line of one element: the pendulum that stretches."""
    cable = fs.Section(name="rope", mass_per_length=0.5, diameter=0.01, EA=500.0)
    rope = fs.Line(name="rope", section=cable, length=2.0, elements=1, end_b_position=(1.2, 0.5, 8.6), taut=True)
    bob = fs.PointMass(name="bob", mass=1.5, position=(1.2, 0.5, 8.6))
    joints = [fs.Ball(a="rope.end_a", b=(0, 0, 10), name="top"), fs.Ball(a="rope.end_b", b="bob", name="low")]
    return fs.assemble(fs.Model(parts=[rope, bob], joints=joints, sea=DRY, gravity=G))


@pytest.mark.parametrize("scheme", SCHEMES)
def test_order_on_a_stretching_pendulum(scheme, record):
    """Point mass on a one-element line against its own ordinary differential equation."""
    mass, l0, EA = 1.5 + 0.5, 2.0, 500.0
    anchor = np.array([0.0, 0.0, 10.0])

    def pull(x):
        d = x - anchor
        return EA * 0.5 * (d @ d / l0**2 - 1.0) * d / l0

    sol = solve_ivp(
        lambda t, y: np.concatenate([y[3:], -pull(y[:3]) / mass - [0.0, 0.0, G]]), (0.0, 4.0),
        np.array([1.2, 0.5, 8.6, 0.4, -0.3, 0.2]), method="DOP853", rtol=1e-13, atol=1e-13, dense_output=True,
    )  # fmt: skip
    errors = {"position": [], "velocity": [], "multipliers": []}
    for n in (400, 800, 1600):
        system = one_element()
        state = system.initial_state()
        state.v[3:6] = state.v[6:9] = (0.4, -0.3, 0.2)
        seen = np.array(run(system, state, SCHEMES[scheme], 4.0 / n, n,
                            lambda s: np.concatenate([s.x[1], s.v[3:6], s.lam[:3]])))  # fmt: skip
        y = sol.sol(np.linspace(0.0, 4.0, n + 1)).T
        # force on the ground: the element's pull and the weight of the half element at the end
        force = np.array([pull(x) for x in y[:, :3]]) - [0.0, 0.0, 0.5 * G]
        for k, exact in enumerate((y[:, :3], y[:, 3:], force)):
            errors[list(errors)[k]].append(last_half_errors(seen[:, 3 * k : 3 * k + 3], exact))
    print(scheme, errors)
    for name, e in errors.items():
        record(
            "order of the integrator", f"mass on a one-element line, {name}, {scheme}", observed_order(e), (1.9, 2.1)
        )


@pytest.mark.slow
@pytest.mark.parametrize("scheme", SCHEMES)
def test_order_on_a_swinging_cable(scheme, record):
    """Ten elements released straight and oblique, against the same scheme at a sixteenth of the finest step."""
    cable = fs.Section(name="rope", mass_per_length=5.0, diameter=0.02, EA=1e4, axial_damping=200.0, EI=20.0)
    rope = fs.Line(name="rope", section=cable, length=10.0, elements=10, end_b_position=(6.0, 3.0, 42.6))
    model = fs.Model(parts=[rope], joints=[fs.Ball(a="rope.end_a", b=(0, 0, 50), name="top")], sea=DRY, gravity=G)
    system = fs.assemble(model)
    duration, base = 2.0, 200

    def samples(n):
        seen = run(system, system.initial_state(), SCHEMES[scheme], duration / n, n,
                   lambda s: (s.x[1:11].ravel().copy(), s.v[3:33].copy(), s.lam.copy()))  # fmt: skip
        return [np.array([row[k] for row in seen[:: n // base]]) for k in range(3)]

    exact = samples(16 * 4 * base)
    errors = {"position": [], "velocity": [], "multipliers": []}
    for n in (2 * base, 4 * base):
        for name, seen, ref in zip(errors, samples(n), exact, strict=True):
            errors[name].append(last_half_errors(seen, ref))
    print(scheme, errors)
    for name, e in errors.items():
        record("order of the integrator", f"swinging cable, {name}, {scheme}", observed_order(e), (1.9, 2.1))


@pytest.mark.slow
def test_heavy_top(record):
    """Displacement of the centre of mass after 1 s, second order.

    Data: Geradin & Cardona (2001), as in Bruls, Cardona & Arnold (2012); reference from a fine solution of
    Euler's equations below, which gives (0.17334404, -0.35991130, -0.74849068) m.
    """
    m, J, r, w0, g = (
        15.0,
        np.array([0.234375, 0.46875, 0.234375]),
        np.array([0.0, 1.0, 0.0]),
        (0.0, 150.0, -4.61538),
        9.81,
    )
    about = np.diag(J) + m * (r @ r * np.eye(3) - np.outer(r, r))

    def rate(t, y):  # body-fixed angular velocity and the rotation matrix
        R, w = y[3:].reshape(3, 3), y[:3]
        moment = np.cross(r, R.T @ [0.0, 0.0, -m * g])
        W = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
        return np.concatenate([np.linalg.solve(about, moment - np.cross(w, about @ w)), (R @ W).ravel()])

    sol = solve_ivp(rate, (0.0, 1.0), np.concatenate([w0, np.eye(3).ravel()]), method="DOP853", rtol=1e-12, atol=1e-12,
                    t_eval=np.linspace(0.0, 1.0, 101))  # fmt: skip
    exact = np.array([y[3:].reshape(3, 3) @ r - r for y in sol.y.T])
    published = np.array([0.17334404, -0.35991130, -0.74849068])
    record("heavy top", "own reference against the published one", np.abs(exact[-1] - published).max(), 1e-6, "m")
    errors = []
    top = fs.Body(name="top", mass=m, inertia=tuple(J), position=(0, 1, 50), points={"tip": (0.0, -1.0, 0.0)})
    system = fs.assemble(fs.Model(parts=[top], joints=[fs.Ball(a="top.tip", b=(0, 0, 50))], sea=DRY, gravity=g))
    for h in (1e-3, 5e-4, 2.5e-4):
        state = system.initial_state()
        state.v[6:9] = w0
        state.v[:3] = np.cross(w0, r)
        n = round(1.0 / h)
        seen = np.array(run(system, state, fs.generalised_alpha(0.6), h, n, lambda s: s.x[0] - [0.0, 1.0, 50.0]))
        errors.append(np.abs(seen[:: n // 100] - exact).max())
        end = np.abs(seen[-1] - published).max()
        record(
            "heavy top", f"displacement error at 1 s, dt {h:g} s", end, {1e-3: 1e-2, 5e-4: 2.4e-3, 2.5e-4: 6e-4}[h], "m"
        )
    print(errors)
    record("heavy top", "order", observed_order(errors), (1.9, 2.1))


def test_change_of_step_keeps_the_order(record):
    """Steps that alternate between h and h/2 (aux moved along, see Stepper.step) stay second order."""
    errors = []
    for n in (100, 200, 400):
        system = pendulum()
        state = system.initial_state()
        stepper = fs.Stepper(system, fs.generalised_alpha(0.6), 1e-11)
        h = 3.0 / n / 0.75
        stepper.start(state, h)
        times, seen = [0.0], [watch_pendulum(state)]
        for k in range(n):
            assert stepper.step(state, h if k % 2 == 0 else 0.5 * h).converged
            times.append(state.t)
            seen.append(watch_pendulum(state))
        exact = np.concatenate(pendulum_motion(np.array(times)), axis=1)
        errors.append(
            [last_half_errors(np.array(seen)[:, c], exact[:, c]) for c in (slice(0, 3), slice(3, 6), slice(6, 9))]
        )
    print(errors)
    for k, name in enumerate(("position", "velocity", "multipliers")):
        order = observed_order([e[k] for e in errors])
        record("order of the integrator", f"pendulum, steps alternating h and h/2, {name}", order, (1.9, 2.1))


def test_start_in_motion_keeps_the_order(record):
    """Multipliers from the first step on: without the start's share of the velocity they err by O(h)."""
    errors = []
    for n in (50, 100, 200):
        system = pendulum()
        state = system.initial_state()
        state.v[6:9] = (0.0, 3.0, 0.0)
        state.v[:3] = np.cross(state.v[6:9], state.x[0] - [0.0, 0.0, 10.0])
        seen = np.array(run(system, state, fs.generalised_alpha(0.6), 0.2 / n, n, lambda s: s.lam.copy()))
        k = 2.0 * G / 2.6
        sol = solve_ivp(lambda t, y: (y[1], -2.0 * G / 2.6 * np.sin(y[0])), (0.0, 0.2), (1.0, 3.0), method="DOP853",
                        rtol=1e-12, atol=1e-12, t_eval=np.linspace(0.0, 0.2, n + 1))  # fmt: skip
        theta, rate = sol.y
        c, s, acc = np.cos(theta), np.sin(theta), -k * np.sin(theta)
        exact = -2.0 * np.stack([-(c * acc - s * rate**2), 0 * s, s * acc + c * rate**2 + G], axis=1)
        errors.append(np.abs(seen - exact).max() / np.abs(exact).max())
    print(errors)
    record(
        "order of the integrator",
        "pendulum started in motion, multipliers from the first step",
        observed_order(errors),
        (1.9, 2.1),
    )


# --- energy ----------------------------------------------------------------------------------------------------


def line_energy(line, x, v):
    """Kinetic, strain and weight energy of a line without bending, lumped masses, from its definition."""
    l0, sec = line.length / line.elements, line.pieces[0].section
    half = np.full(line.elements + 1, sec.mass_per_length * l0)
    half[[0, -1]] *= 0.5
    l2 = np.sum(np.diff(x, axis=0) ** 2, axis=1)
    strain = 0.5 * (l2 / l0**2 - 1.0)
    return np.sum(half * (0.5 * np.sum(v**2, axis=1) + G * x[:, 2])) + 0.5 * sec.EA * l0 * np.sum(strain**2)


def drift(energy, lowest):
    """(largest deviation, change of the mean from the first to the last tenth) over E0 - lowest."""
    e = (np.array(energy) - energy[0]) / (energy[0] - lowest)
    tenth = len(e) // 10
    return np.abs(e).max(), abs(e[-tenth:].mean() - e[:tenth].mean())


def check_energy(record, name, energy, lowest):
    largest, growth = drift(energy, lowest)
    check = "energy without multipliers, newmark(1/4, 1/2), 1000 periods at T/100"
    record(check, f"{name}: largest deviation over E0 - E_min", largest, 1e-3)
    record(check, f"{name}: drift of the mean over the run", growth, 1e-4)


@pytest.mark.slow
def test_energy_of_a_spring_pendulum(record):
    m, k, l0 = 2.0, 60.0, 1.0
    bob = fs.PointMass(name="bob", mass=m, position=(0.8, 0.3, 9.0))
    spring = fs.Spring(name="spring", a="bob", b=(0, 0, 10), stiffness=k, free_length=l0)
    system = fs.assemble(fs.Model(parts=[bob, spring], sea=DRY, gravity=G))
    state = system.initial_state()
    state.v[:3] = (0.1, 0.4, 0.0)

    def energy(s):
        stretch = np.linalg.norm(s.x[0] - [0, 0, 10]) - l0
        return 0.5 * m * s.v[:3] @ s.v[:3] + m * G * s.x[0, 2] + 0.5 * k * stretch**2

    sag = m * G / k
    lowest = m * G * (10 - l0 - sag) + 0.5 * k * sag**2
    period = 2 * np.pi * np.sqrt(m / k)  # the fastest: stretching
    seen = run(system, state, fs.newmark(), period / 100, 100_000, energy, tolerance=1e-10)
    check_energy(record, "spring pendulum", seen, lowest)


@pytest.mark.slow
def test_energy_of_a_free_body(record):
    """Free asymmetric body, turning near its middle axis: it tumbles. E_min is that of the same momentum."""
    J = np.array([2.0, 3.0, 4.5])
    body = fs.Body(name="body", mass=5.0, inertia=tuple(J), position=(0, 0, 50))
    system = fs.assemble(fs.Model(parts=[body], sea=DRY, gravity=0.0))
    state = system.initial_state()
    state.v[6:9] = (0.3, 2.0, 0.2)
    L0 = J * state.v[6:9]

    def energy(s):
        R = system_matrix(s)
        w = R.T @ s.v[6:9]
        return 0.5 * w @ (J * w)

    def system_matrix(s):
        from scipy.spatial.transform import Rotation

        return Rotation.from_quat(s.q[0, [1, 2, 3, 0]]).as_matrix()

    period = 2 * np.pi / np.linalg.norm(state.v[6:9])
    momentum = []

    def watch(s):
        R = system_matrix(s)
        momentum.append(R @ (J * (R.T @ s.v[6:9])) - L0)
        return energy(s)

    seen = run(system, state, fs.newmark(), period / 100, 100_000, watch, tolerance=1e-10)
    check_energy(record, "free rigid body", seen, L0 @ L0 / (2 * J.max()))
    error = np.linalg.norm(momentum, axis=1).max() / np.linalg.norm(L0)  # of second order: (2 pi/100)^2
    check = "energy without multipliers, newmark(1/4, 1/2), 1000 periods at T/100"
    record(check, "free rigid body: angular momentum, largest deviation", error, 4e-3)


@pytest.mark.slow
def test_energy_of_a_cable(record):
    """Eight elements with shared nodes, hung by a spring, swinging from 0.5 rad; T is the shortest period.

    At T/100 of the first *swing* the axial waves are not resolved (omega h = 2.2), and the trapezoidal rule
    keeps the energy of unresolved nonlinear oscillations only within tens of per cent: it conserves quadratic
    energies (Simo & Tarnow 1992, ZAMP 43). That is a property of the scheme, not of the elements.
    """
    sec = fs.Section(name="rope", mass_per_length=2.0, diameter=0.02, EA=500.0)
    low = (4 * np.sin(0.5), 0.0, 49 - 4 * np.cos(0.5))
    rope = fs.Line(
        name="rope", section=sec, length=4.0, elements=8, end_a_position=(0, 0, 49), end_b_position=low, taut=True
    )
    spring = fs.Spring(name="hook", a="rope.end_a", b=(0, 0, 50), stiffness=2e3, free_length=1.0)
    system = fs.assemble(fs.Model(parts=[rope, spring], sea=DRY, gravity=G))

    def energy(s):
        stretch = np.linalg.norm(s.x[0] - [0, 0, 50]) - 1.0
        return line_energy(rope, s.x[:9], s.v[:27].reshape(9, 3)) + 0.5 * 2e3 * stretch**2

    rest, _ = fs.solve_static(system)
    lowest = energy(rest)
    period = 2 * np.pi / natural_frequencies(system, rest)[-1]
    seen = run(system, system.initial_state(), fs.newmark(), period / 100, 100_000, energy, tolerance=1e-10)
    check_energy(record, "cable with shared nodes", seen, lowest)


@pytest.mark.slow
def test_energy_with_a_joint(record):
    """Pendulum of 1 m from 0.5 rad, rho_inf 0.9, 100 s."""
    losses = {}
    for h in (0.02, 0.01, 0.005):
        system = pendulum(1.0, 0.5, 1.0, 1e-6 + 0.1)

        def energy(s):
            return 0.5 * s.v[:3] @ s.v[:3] + 0.5 * 0.100001 * s.v[7] ** 2 + G * s.x[0, 2]

        seen = run(system, system.initial_state(), fs.generalised_alpha(0.9), h, round(100.0 / h), energy)
        losses[h] = (seen[0] - np.mean(seen[-round(2.0 / h) :])) / (seen[0] - G * 9.0)
    print(losses)
    check = "energy with joints, rho_inf 0.9, pendulum of 1 m from 0.5 rad, 100 s"
    record(check, "loss at dt 0.01 s over E0 - E_min", abs(losses[0.01]), 1e-3)
    record(check, "order of the loss, dt 0.02 to 0.01 s", observed_order([losses[0.02], losses[0.01]]), (1.8, 3.2))


def test_end_force_is_the_joint_force(record):
    """At rest the multiplier is the weight, sign and all: what the bob exerts on the ground."""
    system = pendulum(1.0, 0.0)
    state, _ = fs.solve_static(system)
    assert end_force(system, state, "pivot") == pytest.approx((0.0, 0.0, -2.0 * G), abs=1e-9)


# --- corner cases ----------------------------------------------------------------------------------------------


def test_free_steady_spin():
    """No forces and no moments at all: a spin about a principal axis goes on as it is."""
    body = fs.Body(name="body", mass=3.0, inertia=(2.0, 3.0, 4.0), position=(0, 0, 50), attitude_deg=(20, 30, 40))
    system = fs.assemble(fs.Model(parts=[body], sea=DRY, gravity=0.0))
    state = system.initial_state()
    axis = system.R0[0] @ [0.0, 0.0, 1.0]
    state.v[:3], state.v[6:9] = (1.0, 2.0, 3.0), 5.0 * axis
    run(system, state, fs.generalised_alpha(0.6), 0.05, 200, tolerance=1e-6)
    assert state.v[6:9] == pytest.approx(5.0 * axis, abs=1e-9)
    assert state.x[0] == pytest.approx((10.0, 20.0, 80.0), abs=1e-9)


def test_spring_without_free_length():
    """With no free length the force is k d, also through the point of no length: omega = sqrt(k/m) about the sag."""
    m, k, start = 2.0, 50.0, 0.3
    mass = fs.PointMass(name="m", mass=m, position=(0, 0, 5.0 + start))
    system = fs.assemble(
        fs.Model(parts=[mass, fs.Spring(name="s", a="m", b=(0, 0, 5), stiffness=k, free_length=0.0)], sea=DRY)
    )
    period = 2.0 * np.pi * np.sqrt(m / k)
    z = run(system, system.initial_state(), fs.generalised_alpha(0.9), period / 200, 100, lambda s: s.x[0, 2] - 5.0)
    assert z[-1] == pytest.approx(-start - 2.0 * m * G / k, rel=1e-3)


def test_rope_never_pushes():
    """A tension-only spring with a damper, closing fast while still long: the damper alone would push."""
    mass = fs.PointMass(name="m", mass=2.0, position=(0, 0, 5))
    rope = fs.Spring(name="s", a="m", b=(0, 0, 7), stiffness=10.0, damping=100.0, free_length=1.9, tension_only=True)
    system = fs.assemble(fs.Model(parts=[mass, rope], sea=DRY, gravity=0.0))
    state = system.initial_state()
    state.v[2] = 1.0
    run(system, state, fs.generalised_alpha(0.6), 0.01, 5, tolerance=1e-6)
    assert state.v[2] == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("scheme", [fs.newmark(), fs.generalised_alpha(1.0), fs.generalised_alpha(0.99), fs.hht(0.0)])
def test_undamped_schemes_are_refused_with_joints(scheme):
    """Newmark(1/4, 1/2) and rho_inf near 1 oscillate and diverge in the multipliers."""
    with pytest.raises(fs.CaseError, match="joints"):
        fs.Stepper(pendulum(), scheme)
