"""Motions and reactions of joints against closed forms; what turns, mirrors and swaps with the model."""

from __future__ import annotations

import numpy as np
import pytest
from closed_forms import physical_pendulum
from mechanics import DRY, observed_order
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import floatsim as fs
from floatsim.joints.cylindrical import Cylindrical
from floatsim.joints.hinge import Hinge
from floatsim.joints.lock import value
from floatsim.joints.point_on_line import PointOnLine
from floatsim.joints.rod import Rod
from floatsim.joints.slider import Slider
from floatsim.joints.universal import Universal

G = 9.81
CHECK = "joints against closed forms"
Y = (0.0, 1.0, 0.0)


def simulate(parts, joints, duration, dt, start=None, gravity=G):
    """A run from the drawing position with velocities as `start` sets them; tight tolerance."""
    system = fs.assemble(fs.Model(parts=parts, joints=joints, sea=DRY, gravity=gravity))
    state = system.initial_state()
    if start is not None:
        start(system, state)
    run = fs.simulate(system, duration, dt, state=state, tolerance=1e-10)
    assert run.status == "done", run.failure
    return run


def spin(system, state, body, v, w):
    """Velocities of a body's reference point and its angular velocity."""
    k = system.numbering.index(body)
    p, r = system.numbering.first_point[k], 3 * (system.n_point + 1 + system.numbering.first_rotation[k])
    state.v[3 * p : 3 * p + 3], state.v[r : r + 3] = v, w


def turning(rate, at=(0.0, 0.0, 0.0)):
    """Prescribed rotation about z at a constant rate [rad/s] about the fixed point `at`."""
    p = np.array([*at, 0.0, 0.0, 0.0])
    e = np.array([0, 0, 0, 0, 0, 1.0])
    return fs.Motion(lambda t: p + e * rate * t, lambda t: e * rate, lambda t: 0.0 * e)


def shaft(name, position=(0.0, 0.0, 50.0), **points):
    return fs.Body(name=name, mass=2.0, inertia=(1, 1, 1), position=position, points=points)


# --- hinge -------------------------------------------------------------------------------------------------------

ARM, ANGLE, MASS, J = 1.2, 1.0, 3.0, np.array([[2.0, 0.1, -0.2], [0.1, 1.5, 0.3], [-0.2, 0.3, 1.2]])
ASIDE = 0.4  # of the centre of mass along the axis


def hinged():
    """Physical pendulum about y; its centre of mass is not in the plane of the pivot, so that the hinge carries a
    moment."""
    body = fs.Body(name="bob", mass=MASS, inertia=(2.0, 1.5, 1.2, 0.1, -0.2, 0.3), center_of_mass=(0, ASIDE, -ARM),
                   position=(0, 0, 10), attitude_deg=(0, np.degrees(ANGLE), 0))  # fmt: skip
    return [body], [Hinge(a="bob", b=(0, 0, 10), axis=Y, name="hinge", zero=ANGLE)]


def hinged_exactly(times):
    """Angle, and force and moment about the pivot that the pendulum exerts on the ground."""
    about = J[1, 1] + MASS * ARM**2
    theta, rate, acc = physical_pendulum(MASS * G * ARM / about, ANGLE, times)
    c = np.array([0.0, ASIDE, -ARM])
    pivot = J + MASS * (c @ c * np.eye(3) - np.outer(c, c))
    force, moment = [], []
    for th, w, al in zip(theta, rate, acc, strict=True):
        R, e = Rotation.from_euler("y", th).as_matrix(), np.array(Y)
        r = R @ c
        a = al * np.cross(e, r) + w * w * np.cross(e, np.cross(e, r))
        weight = np.array([0, 0, -MASS * G])
        L = R @ pivot @ R.T @ e
        force.append(-(MASS * a - weight))
        moment.append(-(al * L + w * w * np.cross(e, L) - np.cross(r, weight)))
    return theta, rate, np.array(force), np.array(moment)


def test_hinge_is_a_physical_pendulum(record):
    errors = {"angle": [], "rate": [], "force": [], "moment": []}
    for n in (150, 300, 600):
        run = simulate(*hinged(), 3.0, 3.0 / n)
        theta, rate, force, moment = hinged_exactly(run.time)
        got = {"angle": run.series("bob_position")[:, 4], "rate": run.series("bob_velocity")[:, 4],
               "force": run.series("hinge_force"), "moment": run.series("hinge_moment")}  # fmt: skip
        for name, exact in (("angle", theta), ("rate", rate), ("force", force), ("moment", moment)):
            errors[name].append(np.abs(got[name] - exact)[n // 3 :].max() / np.abs(exact).max())
        assert np.abs(moment[:, 1]).max() < 1e-9 * np.abs(moment).max()  # none about a free axis
    for name, e in errors.items():
        record(CHECK, f"hinge, pendulum from 1 rad, dt 5 ms: {name}", e[-1], 1e-4)
        record(CHECK, f"hinge, pendulum: order of {name}", observed_order(e), (1.8, 2.2))


def test_double_pendulum(record):
    """Two hinges against Lagrange's equations of point masses on rods, integrated by SciPy."""
    m1, m2, l1, l2, small = 2.0, 1.5, 1.0, 0.8, 1e-7

    def bob(name, m, l, angle, top):
        x = np.array(top) - l * np.array([np.sin(angle), 0, np.cos(angle)])
        return fs.Body(name=name, mass=m, inertia=(small,) * 3, position=tuple(x), points={"top": (0, 0, l)},
                       attitude_deg=(0, np.degrees(angle), 0)), tuple(x)  # fmt: skip

    one, at = bob("one", m1, l1, 1.0, (0, 0, 10))
    two, low = bob("two", m2, l2, 0.3, at)
    joints = [Hinge(a="one.top", b=(0, 0, 10), axis=Y, name="upper"),
              Hinge(a="two.top", b="one", axis=(0, 2, 0), name="lower")]  # fmt: skip

    def lagrange(t, y):
        a, b, wa, wb = y
        c, s = np.cos(a - b), np.sin(a - b)
        M = np.array([[(m1 + m2) * l1, m2 * l2 * c], [l1 * c, l2]])
        f = np.array([-m2 * l2 * wb**2 * s - (m1 + m2) * G * np.sin(a), l1 * wa**2 * s - G * np.sin(b)])
        return (wa, wb, *np.linalg.solve(M, f))

    errors = []
    for n in (300, 600):
        run = simulate([one, two], joints, 3.0, 3.0 / n)
        exact = solve_ivp(lagrange, (0, 3), (1.0, 0.3, 0, 0), rtol=1e-11, atol=1e-12, t_eval=run.time).y
        elbow = -l1 * np.array([np.sin(exact[0]), np.cos(exact[0])])
        tip = elbow - l2 * np.array([np.sin(exact[1]), np.cos(exact[1])])
        errors.append(max(np.abs((run.series(f"{name}_position")[:, [0, 2]] + start).T - want).max()
                          for name, start, want in (("one", np.array(at)[[0, 2]] - (0, 10), elbow),
                                                    ("two", np.array(low)[[0, 2]] - (0, 10), tip))))  # fmt: skip
    record(CHECK, "two hinges, double pendulum over 3 s, dt 5 ms: positions over the length", errors[-1] / 1.8, 2e-3)
    record(CHECK, "two hinges, double pendulum: order", observed_order(errors), (1.8, 2.2))


def four_bar(last):
    """Parallelogram: two cranks of length L below the ground, a coupler between them."""
    L, B = 1.0, 2.0
    a = 0.6
    d = np.array([-np.sin(a), 0, -np.cos(a)])
    deg = (0, np.degrees(a), 0)
    cranks = [
        fs.Body(name=name, mass=0.5, inertia=(0.05, 0.04, 0.05), position=tuple(np.array([x, 0, 10]) + 0.5 * L * d),
                attitude_deg=deg, points={"top": (0, 0, 0.5 * L), "end": (0, 0, -0.5 * L)})
        for name, x in (("left", 0.0), ("right", B))
    ]  # fmt: skip
    coupler = fs.Body(name="coupler", mass=4.0, inertia=(1, 1, 1), position=tuple(np.array([B / 2, 0, 10]) + L * d),
                      points={"p": (-B / 2, 0, 0), "q": (B / 2, 0, 0)})  # fmt: skip
    joints = [Hinge(a="left.top", b=(0, 0, 10), axis=Y, name="one"),
              Hinge(a="coupler.p", b="left.end", axis=Y, name="two"), *last]  # fmt: skip
    return [*cranks, coupler], joints


def test_four_bar(record):
    """With a ball and a universal joint it is a pendulum; with four hinges three rows too many are named."""
    good = [fs.Ball(a="right.top", b=(2.0, 0, 10), name="three"),
            Universal(a="coupler.q", b="right.end", first=(1, 0, 0), second=Y, name="four")]  # fmt: skip
    errors = []
    for n in (200, 400):
        run = simulate(*four_bar(good), 2.0, 2.0 / n)
        # 2 (J + m L^2/4) + M L^2 and (M + m) g L
        theta, *_ = physical_pendulum(4.5 * G / (2 * (0.04 + 0.125) + 4.0), 0.6, run.time)
        errors.append(np.abs(run.series("left_position")[:, 4] - theta).max())
    assert np.abs(run.series("coupler_position")[:, 3:]).max() < 1e-8
    record(CHECK, "four-bar linkage as a pendulum, dt 5 ms: angle", errors[-1], 3e-4, "rad")
    record(CHECK, "four-bar linkage: order", observed_order(errors), (1.8, 2.2))
    bad = [Hinge(a="right.top", b=(2.0, 0, 10), axis=Y, name="three"),
           Hinge(a="coupler.q", b="right.end", axis=Y, name="four")]  # fmt: skip
    with pytest.raises(fs.ModelError, match="20 constraint rows, of which only 17 .*(one|two|three|four)"):
        fs.assemble(fs.Model(parts=four_bar(bad)[0], joints=four_bar(bad)[1], sea=DRY))


# --- slider ------------------------------------------------------------------------------------------------------


def test_slider_on_an_incline(record):
    """s = g sin(a) t^2/2, normal force m g cos(a); the moment about a of a weight off the axis."""
    a, m = 0.4, 3.0
    e = (np.cos(a), 0.0, -np.sin(a))
    body = fs.Body(name="cart", mass=m, inertia=(1, 2, 3), center_of_mass=(0.0, 0.3, 0.2), position=(0, 0, 50),
                   attitude_deg=(5, 10, 20))  # fmt: skip
    foot = tuple(np.array([0, 0, 50]) + 4.0 * np.array(e))
    run = simulate([body], [Slider(a="cart", b=foot, axis=tuple(7.0 * y for y in e), zero=2.5, name="rail")], 2.0, 0.02)
    s = 0.5 * G * np.sin(a) * run.time**2
    n = -m * G * np.cos(a) * np.array([np.sin(a), 0.0, np.cos(a)])  # of the cart on the rail
    c = Rotation.from_euler("ZYX", (20, 10, 5), degrees=True).as_matrix() @ (0.0, 0.3, 0.2)
    moment = np.cross(c, m * (np.array([0, 0, -G]) - G * np.sin(a) * np.array(e)))
    x = run.series("cart_position")
    record(CHECK, "slider on an incline: displacement", np.abs(x[:, :3] - np.outer(s, e)).max() / s[-1], 1e-9)
    record(CHECK, "slider on an incline: force", np.abs(run.series("rail_force") - n).max() / (m * G), 1e-8)
    record(CHECK, "slider on an incline: moment", np.abs(run.series("rail_moment") - moment).max() / (m * G), 1e-8)
    assert np.abs(x[:, 3:] - x[0, 3:]).max() < 1e-10
    geometry = fs.assemble(run.sampler.system.model).numbering.coordinates("rail")[""]
    at_start = value(geometry, run.sampler.system.initial_state())
    assert at_start == pytest.approx((2.5, 0.0), abs=1e-12)
    at_end = value(geometry, run.state)
    assert at_end == pytest.approx((2.5 + s[-1], G * np.sin(a) * 2.0), rel=1e-6)


@pytest.mark.parametrize("kind", ["slider", "point on line", "cylindrical"])
def test_bead_on_a_rotating_wire(kind, record):
    """s = s0 cosh(W t): Coriolis force 2 m W s' across, weight down; the arm is driven."""
    W, m, s0 = 1.3, 2.0, 0.5
    arm = shaft("arm", hub=(0, 0, 0.4))
    x0 = (s0, 0.0, 50.4)
    J0 = 0.7
    bead = (fs.PointMass(name="bead", mass=m, position=x0) if kind == "point on line" else
            fs.Body(name="bead", mass=m, inertia=(J0,) * 3, position=x0))  # fmt: skip
    cls = {"slider": Slider, "point on line": PointOnLine, "cylindrical": Cylindrical}[kind]
    errors = {"distance": [], "force": [], "moment": []}
    for n in (100, 200):
        parts = [arm, bead]
        joints = [fs.Prescribed(a="arm", motion=turning(W, (0, 0, 50)), name="drive"),
                  cls(a="bead", b="arm.hub", axis=(1, 0, 0), name="wire")]  # fmt: skip

        def start(system, state):
            spin(system, state, "arm", (0, 0, 0), (0, 0, W))
            if kind == "point on line":
                state.v[3:6] = (0, W * s0, 0)
            else:
                spin(system, state, "bead", (0, W * s0, 0), (0, 0, W))

        run = simulate(parts, joints, 2.0, 2.0 / n, start)
        t = run.time
        s, ds = s0 * np.cosh(W * t), s0 * W * np.sinh(W * t)
        x = run.series("bead_position")[:, :3] + (np.array(x0) if kind != "point on line" else 0.0)
        across = np.stack([-np.sin(W * t), np.cos(W * t), 0 * t], axis=1)
        force = -2.0 * m * W * ds[:, None] * across - np.array([0, 0, m * G])
        late = n // 3
        errors["distance"].append(np.abs(np.hypot(x[:, 0], x[:, 1]) - s).max() / s[-1])
        errors["force"].append(np.abs(run.series("wire_force") - force)[late:].max() / np.abs(force).max())
        # what drives the arm feels the force at the bead's place: 2 m W s' s about z
        turn = run.series("drive_moment")[:, 2] + 2.0 * m * W * ds * s
        errors["moment"].append(np.abs(turn)[late:].max() / (2.0 * m * W * ds * s).max())
    for name, e in errors.items():
        record(CHECK, f"bead on a rotating wire ({kind}), dt 10 ms: {name}", e[-1], 1e-3)
        record(CHECK, f"bead on a rotating wire ({kind}): order of {name}", observed_order(e), (1.8, 2.2))


def test_line_end_on_a_rail(record):
    """A line's end on an inclined frictionless rail, its weight balanced by a spring along the rail: the rail carries
    the part of its weight across."""
    a, w, L = 0.5, 30.0, 4.0
    e = np.array([np.cos(a), 0.0, np.sin(a)])
    section = fs.Section(name="rope", mass_per_length=w, diameter=0.02, EA=1e6)
    top = np.array([0.0, 0.0, 50.0])
    line = fs.Line(name="rope", section=section, length=L, elements=4, taut=True, end_a_position=tuple(top),
                   end_b_position=(0, 0, 50.0 - L))  # fmt: skip
    spring = fs.Spring(name="spring", a="rope.end_a", b=tuple(top + 3.0 * e), stiffness=2e4, free_length=3.0)
    joint = PointOnLine(a="rope.end_a", b=tuple(top + e), axis=tuple(e), name="rail")
    system = fs.assemble(fs.Model(parts=[line, spring], joints=[joint], sea=DRY, gravity=G))
    state, _ = fs.solve_static(system)
    sample = fs.study.channels.Sampler(system)
    row = sample.sample_state(state)[None]
    weight = np.array([0, 0, -w * L * G])
    across = weight - (weight @ e) * e
    force = sample.column(row, "rail_force")[0]
    record(CHECK, "line's end on a rail: force on the rail", np.abs(force - across).max() / (w * L * G), 1e-7)
    end = sample.column(row, "rope_end_a_force")[0]
    assert end == pytest.approx(across, abs=1e-5 * w * L * G)
    stretch = -(weight @ e) / 2e4  # of the spring, down the rail
    assert state.x[0] == pytest.approx(top - stretch * e, abs=1e-8)


# --- cylindrical, universal, rod -----------------------------------------------------------------------------------


def test_cylindrical_joint_does_not_screw(record):
    """Falls freely along its axis and turns steadily; an eccentric mass pulls with m e W^2."""
    W, m, e = 2.0, 3.0, 0.4
    body = fs.Body(name="drum", mass=m, inertia=(1, 2, 3), center_of_mass=(e, 0, 0), position=(0, 0, 50))
    run = simulate([body], [Cylindrical(a="drum", b=(0, 0, 40), axis=(0, 0, 1), name="post")], 2.0, 0.005,
                   lambda system, state: spin(system, state, "drum", (0, 0, 0), (0, 0, W)))  # fmt: skip
    t, x = run.time, run.series("drum_position")
    record(CHECK, "cylindrical joint: fall", np.abs(x[:, 2] + 0.5 * G * t**2).max() / (0.5 * G * 4), 1e-9)
    turn = np.abs(np.unwrap(x[:, 5]) - W * t).max() / (W * 2.0)
    record(CHECK, "cylindrical joint: turn", turn, 1e-9)
    force = m * e * W**2 * np.stack([np.cos(W * t), np.sin(W * t), 0 * t], axis=1)
    record(CHECK, "cylindrical joint: centrifugal force", np.abs(run.series("post_force") - force)[50:].max()
           / (m * e * W**2), 1e-4)  # fmt: skip
    moment = run.series("post_moment")  # about the drum's point on the axis: of the weight, which falls freely: none
    assert np.abs(moment).max() < 1e-4 * m * e * W**2


def test_universal_joint_is_hookes(record):
    """Shafts at an angle b: tan(out) = tan(in)/cos(b); the moment along the output shaft is J out''."""
    b, W, Jx = 0.5, 2.0, 0.6
    u = np.array([np.cos(b), np.sin(b), 0.0])
    p = np.array([0, 0, 50.0, 0, 0, 0])
    roll = np.array([0, 0, 0, 1.0, 0, 0])
    motion = fs.Motion(lambda t: p + roll * W * t, lambda t: roll * W, lambda t: 0 * roll)
    drive, out = shaft("drive"), fs.Body(name="out", mass=1.0, inertia=(Jx,) * 3, position=(0, 0, 50),
                                         points={"tip": tuple(2.0 * u)})  # fmt: skip
    joints = [
        fs.Prescribed(a="drive", motion=motion, name="motor"),
        Universal(a="out", b="drive", first=Y, second=(0, 0, 1), name="cardan", zero=(0.3, -0.2)),
        PointOnLine(a="out.tip", b=(0, 0, 50), axis=tuple(u), name="bearing"),
    ]

    def start(system, state):
        spin(system, state, "drive", (0, 0, 0), (W, 0, 0))
        spin(system, state, "out", (0, 0, 0), W / np.cos(b) * u)

    system = fs.assemble(fs.Model(parts=[drive, out], joints=joints, sea=DRY, gravity=0.0))
    state = system.initial_state()
    start(system, state)
    stepper = fs.Stepper(system, tolerance=1e-10)
    n, T = 600, 3.0
    first, second = (system.numbering.coordinates("cardan")[name] for name in ("first", "second"))
    assert (value(first, state)[0], value(second, state)[0]) == pytest.approx((0.3, -0.2), abs=1e-12)
    sampler = fs.study.channels.Sampler(system)
    rows, worst = [], np.zeros(3)
    for k in range(n):
        assert stepper.step(state, T / n).converged
        rows.append(sampler.sample(stepper.work))
        th = W * state.t
        out_angle = np.arctan2(np.sin(th) / np.cos(b), np.cos(th))
        R = Rotation.from_quat(state.q[1][[1, 2, 3, 0]]).as_matrix()
        exact = Rotation.from_rotvec(out_angle * u).as_matrix()
        worst[0] = max(worst[0], np.abs(R - exact).max())
        q1, q2 = value(first, state)[0] - 0.3, value(second, state)[0] + 0.2
        D = Rotation.from_rotvec((th, 0, 0)).as_matrix()
        A = Rotation.from_rotvec(q1 * np.array(Y)).as_matrix() @ Rotation.from_rotvec((0, 0, q2)).as_matrix()
        worst[1] = max(worst[1], np.abs(D @ A - R).max())
        den = 1.0 - np.sin(b) ** 2 * np.cos(th) ** 2
        # out' = W cos b/den with tan(out) = tan(in)/cos(b)
        acc = -(W**2) * np.cos(b) * np.sin(b) ** 2 * np.sin(2 * th) / den**2
        if k > n // 4:
            moment = sampler.column(rows[-1][None], "cardan_moment")[0]
            worst[2] = max(worst[2], abs(-(moment @ u) - Jx * acc) / (Jx * W**2))
    record(CHECK, "universal joint, Hooke's law at 0.5 rad, dt 5 ms: attitude", worst[0], 1e-4, "rad")
    record(CHECK, "universal joint: attitude from its two coordinates", worst[1], 1e-8, "rad")
    record(CHECK, "universal joint: moment on the output shaft", worst[2], 1e-3)


def test_universal_transmits_spin_and_a_ball_does_not():
    """A body hung on either, turned about the vertical through the joint: only the universal joint stops it."""
    body = fs.Body(name="bob", mass=2.0, inertia=(1, 1, 1), position=(0, 0, 9), points={"top": (0, 0, 1)})
    universal = Universal(a="bob.top", b=(0, 0, 10), first=(1, 0, 0), second=Y, name="top")
    for joint, expected in ((fs.Ball(a="bob.top", b=(0, 0, 10), name="top"), 0.5), (universal, 0.0)):
        run = simulate([body], [joint], 1.0, 0.01, lambda *of: spin(*of, "bob", (0, 0, 0), (0, 0, 0.5)))
        assert run.state.v[8] == pytest.approx(expected, abs=1e-9)


def test_rod_is_a_pendulum(record):
    """Point mass on a rod from 1 rad: tension m (g cos(th) + L th'^2)."""
    L, m, a = 1.5, 2.0, 1.0
    errors = {"position": [], "velocity": [], "tension": []}
    for n in (150, 300, 600):
        mass = fs.PointMass(name="bob", mass=m, position=(L * np.sin(a), 0, 10 - L * np.cos(a)))
        run = simulate([mass], [Rod(a="bob", b=(0, 0, 10), name="rod")], 3.0, 3.0 / n)
        th, w, _ = physical_pendulum(G / L, a, run.time)
        s, c = np.sin(th), np.cos(th)
        x = np.stack([L * s, 0 * s, 10 - L * c], axis=1)
        v = L * w[:, None] * np.stack([c, 0 * s, s], axis=1)
        tension = m * (G * c + L * w**2)
        force = tension[:, None] * np.stack([s, 0 * s, -c], axis=1)  # pulls the support towards the bob
        errors["position"].append(np.abs(run.series("bob_position") - x).max() / L)
        errors["velocity"].append(np.abs(run.series("bob_velocity") - v)[n // 3 :].max() / np.abs(v).max())
        errors["tension"].append(np.abs(run.series("rod_force") - force)[n // 3 :].max() / tension.max())
    for name, e in errors.items():
        record(CHECK, f"rod as a pendulum, dt 5 ms: {name}", e[-1], 5e-4)
        record(CHECK, f"rod as a pendulum: order of {name}", observed_order(e), (1.8, 2.2))


def test_two_masses_on_a_rod_in_free_flight(record):
    """Dumbbell: its centre moves straight on, its tension is mu L W^2."""
    m1, m2, L, W = 2.0, 3.0, 1.4, 1.7
    one = fs.PointMass(name="one", mass=m1, position=(0, 0, 50))
    two = fs.PointMass(name="two", mass=m2, position=(L, 0, 50))

    def start(system, state):
        state.v[:6] = (0.3, -m2 / (m1 + m2) * L * W, 0.1, 0.3, m1 / (m1 + m2) * L * W, 0.1)

    run = simulate([one, two], [Rod(a="one", b="two", length=L, name="rod")], 3.0, 0.005, start, gravity=0.0)
    x1, x2 = run.series("one_position"), run.series("two_position")
    centre = (m1 * x1 + m2 * x2) / (m1 + m2) - (m2 * L / (m1 + m2), 0, 50)
    record(CHECK, "dumbbell on a rod: its centre", np.abs(centre - np.outer(run.time, (0.3, 0, 0.1))).max(), 1e-8, "m")
    mu = m1 * m2 / (m1 + m2) * L * W**2
    tension = np.linalg.norm(run.series("rod_force"), axis=1)[100:]
    record(CHECK, "dumbbell on a rod, dt 5 ms: tension", np.abs(tension - mu).max() / mu, 1e-4)
    towards = run.series("rod_force")[-1] @ (x1[-1] - x2[-1])
    assert towards > 0.0  # b is pulled towards a


# --- invariance ----------------------------------------------------------------------------------------------------


def pair(kind, swap=False, mirror=False, shift=(0.0, 0.0, 0.0)):
    """Two free bodies joined, one of them spinning; mirrored at y = 0, shifted, or with the joint's sides swapped."""
    f = np.array([1.0, -1.0, 1.0]) if mirror else np.ones(3)
    s = np.array(shift)
    axis = f * (0.3, -0.5, 0.9)
    far = np.array([0.4, -0.3, 50.6]) + (0.0 if kind in ("hinge", "universal") else 1.2) * np.array([0.3, -0.5, 0.9])
    arm, back = np.array([0.4, -0.3, 0.6]), np.array([-0.2, 0.5, 0.1])
    Jxy = -0.3 if mirror else 0.3
    one = fs.Body(name="one", mass=3.0, inertia=(4, 6, 7, Jxy, 0.2, 0), position=tuple(f * (0, 0, 50) + s),
                  points={"p": tuple(f * arm)})  # fmt: skip
    two = fs.Body(name="two", mass=2.0, inertia=(2, 3, 4, 0, 0.1, 0), position=tuple(f * (far - back) + s),
                  points={"o": tuple(f * back)})  # fmt: skip
    a, b = ("one.p", "two.o") if swap else ("two.o", "one.p")
    second = f * (0.9, 0.0, -0.3)
    ends = dict(a=a, b=b, name="joint")
    if kind == "universal":
        e1, e2 = (second, axis) if swap else (axis, second)
        return [one, two], Universal(first=tuple(e1), second=tuple(e2), **ends)
    if kind == "rod":
        return [one, two], Rod(**ends)
    cls = {"hinge": Hinge, "slider": Slider, "cylindrical": Cylindrical}[kind]
    return [one, two], cls(axis=tuple(axis), **ends)


@pytest.mark.parametrize("kind", ["hinge", "slider", "cylindrical", "universal", "rod"])
def test_shift_mirror_and_swap(kind, record):
    f, wf = np.array([1.0, -1.0, 1.0]), np.array([-1.0, 1.0, -1.0])

    def motion(mirror=False, **how):
        parts, joint = pair(kind, mirror=mirror, **how)

        def start(system, state):
            for body, v, w in (("one", (0.2, 0.1, 0.3), (0.5, -0.4, 0.7)), ("two", (0.1, -0.2, 0.0), (0.3, 0.9, -0.2))):
                spin(system, state, body, (f if mirror else 1) * np.array(v), (wf if mirror else 1) * np.array(w))

        run = simulate(parts, [joint], 1.0, 0.01, start)
        names = ["joint_force"] + (["joint_moment"] if kind != "rod" else [])
        return run.state.x[:2].copy(), [run.series(name) for name in names], run.series("two_position")

    x, loads, _ = motion()
    scale = np.abs(np.concatenate(loads)).max()
    moved = motion(shift=(30.0, -20.0, 7.0))
    worst = np.abs(moved[0] - x - (30.0, -20.0, 7.0)).max()
    worst = max(worst, max(np.abs(p - q).max() for p, q in zip(loads, moved[1], strict=True)) / scale)
    record("invariance", f"{kind}, motion and reactions: shifted", worst, 1e-6)
    mirrored = motion(mirror=True)
    worst = np.abs(mirrored[0] - f * x).max()
    for p, q, sign in zip(loads, mirrored[1], (f, wf), strict=False):
        worst = max(worst, np.abs(q - sign * p).max() / scale)
    record("invariance", f"{kind}, motion and reactions: mirrored", worst, 1e-6)
    swapped = motion(swap=True)
    record("invariance", f"{kind}, motion: sides swapped", np.abs(swapped[0] - x).max(), 1e-9, "m")
    # a joint closed to 1e-9 of the length leaves m 1e-9 L/h^2 of its force open
    worst = max(0.0, np.abs(swapped[1][0] + loads[0]).max() / scale)
    if kind in ("hinge", "universal"):  # elsewhere the moment is about another point
        worst = max(worst, np.abs(swapped[1][1] + loads[1]).max() / scale)
    record("invariance", f"{kind}, reactions: sides swapped", worst, 1e-3)
