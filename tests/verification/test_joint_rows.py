"""Rows of every joint: tangents and rates by differences, rigid motion, balance of forces."""

from __future__ import annotations

import numpy as np
import pytest
from mechanics import DRY, displace, free_unknowns, matrix, residual
from test_invariance import DRIFT, SHIFT, SPIN, Q, forces, moved
from test_tangents import differences

import floatsim as fs
from floatsim.joints.cylindrical import Cylindrical
from floatsim.joints.hinge import Hinge
from floatsim.joints.lock import Lock
from floatsim.joints.point_on_line import PointOnLine
from floatsim.joints.rod import Rod
from floatsim.joints.slider import Slider
from floatsim.joints.universal import Universal
from floatsim.solve.linear import LinearSolver

AXIS = (0.3, -0.5, 0.9)
FAR = tuple(np.array([0.4, -0.3, 5.6]) + 1.7 * np.array(AXIS))  # on the axis through one.p
ENDS = {"a": "two.o", "b": "one.p", "name": "joint"}


def bodies(joint, *parts, two=FAR):
    points = {"p": (0.4, -0.3, 0.6), "o": (0.1, 0.2, -0.3)}
    common = dict(mass=3.0, inertia=(4.0, 6.0, 7.0, 0.3, -0.2, 0.4), center_of_mass=(0.1, -0.2, 0.3), points=points)
    one = fs.Body(name="one", position=(0, 0, 5), **common)
    second = fs.Body(name="two", position=tuple(np.array(two) - points["o"]), **common)
    return fs.assemble(fs.Model(parts=[one, second, *parts], joints=[joint], sea=DRY, gravity=0.0))


def locked(joint, two=FAR, **more):
    return bodies(joint, Lock(name="lock", joint="joint", **more), two=two)


def bead():
    """A point mass on a line of a turning body."""
    one = fs.Body(name="one", mass=3.0, inertia=(4, 6, 7), position=(0, 0, 5), points={"p": (0.4, -0.3, 0.6)})
    two = fs.PointMass(name="bead", mass=2.0, position=FAR)
    joint = PointOnLine(a="bead", b="one.p", axis=AXIS, name="joint")
    return fs.assemble(fs.Model(parts=[one, two], joints=[joint], sea=DRY, gravity=0.0))


P = (0.4, -0.3, 5.6)  # where one.p is
SYSTEMS = {
    "hinge": lambda: bodies(Hinge(axis=AXIS, **ENDS), two=P),
    "slider": lambda: bodies(Slider(axis=AXIS, **ENDS)),
    "cylindrical": lambda: bodies(Cylindrical(axis=AXIS, **ENDS)),
    "universal": lambda: bodies(Universal(first=AXIS, second=(0.9, 0.0, -0.3), **ENDS), two=P),
    "rod": lambda: bodies(Rod(**ENDS)),
    "point on line": lambda: bodies(PointOnLine(axis=AXIS, **ENDS)),
    "bead on a body": bead,
    "lock of a slide": lambda: locked(PointOnLine(axis=AXIS, **ENDS), engaged=True),
    "lock of a turn": lambda: locked(Hinge(axis=AXIS, **ENDS), P, engaged=True),
    "lock of a slide, off": lambda: locked(PointOnLine(axis=AXIS, **ENDS)),
    "lock of a turn, off": lambda: locked(Hinge(axis=AXIS, **ENDS), P),
}
GROUND = {
    "hinge to the ground": Hinge(a="one.p", b=P, axis=AXIS, name="joint"),
    "slider to the ground": Slider(a="one.p", b=FAR, axis=AXIS, name="joint"),
    "cylindrical to the ground": Cylindrical(a="one.p", b=FAR, axis=AXIS, name="joint"),
    "rod to the ground": Rod(a="one.p", b=FAR, name="joint"),
}


def grounded(joint):
    body = fs.Body(name="one", mass=3.0, inertia=(4, 6, 7), position=(0, 0, 5), points={"p": (0.4, -0.3, 0.6)})
    return fs.assemble(fs.Model(parts=[body], joints=[joint], sea=DRY))


ALL = {**SYSTEMS, **{name: (lambda joint=joint: grounded(joint)) for name, joint in GROUND.items()}}


def random_work(system, seed):
    rng = np.random.default_rng(seed)
    w, state = system.work(), system.initial_state()
    system.load(w, state)
    w.still = True
    system.begin(w, state, 0.0)
    for i in free_unknowns(system):
        displace(system, w, i, (0.8 if i >= 3 * system.n_point else 0.5) * rng.uniform(-1, 1))
        if i < system.n_dof:
            w.v[i], w.a[i] = rng.uniform(-1, 1, 2)
    w.lam[:] = 10.0 * rng.uniform(-1, 1, system.n_con)
    return w


@pytest.mark.parametrize("name", ALL)
def test_tangents(name, record):
    """Stiffness of G^T lam and G itself, entry by entry."""
    system = ALL[name]()
    free = free_unknowns(system)
    worst = 0.0
    for seed in range(3):
        w = random_work(system, seed)
        exact = matrix(system, w, (0.0, 0.0, 1.0, 1.0))
        near = differences(system, w, 2, 4e-3)
        gap = np.abs(exact - near)[np.ix_(free, free)]
        worst = max(worst, gap.max() / np.abs(exact).max())
        assert np.array_equal(exact[system.n_dof :, : system.n_dof], exact[: system.n_dof, system.n_dof :].T)
    record("tangents against central differences", f"joints: {name}", worst, 1e-8)


@pytest.mark.parametrize("engaged", [False, True])
def test_line_ends_are_eliminated_with_their_rows(engaged, record):
    """Lines whose ends run on a rail, locked or not, and hang from a rod: structured solution against dense."""
    section = fs.Section(name="rope", mass_per_length=30.0, diameter=0.05, EA=1e6, EI=1e3)
    ends = dict(section=section, length=9.0, elements=8)
    lines = [fs.Line(name=f"l{k}", end_a_position=(0, 0, 50), end_b_position=(x, 0, 46), **ends)
             for k, x in enumerate((-6.0, 6.0))]  # fmt: skip
    joints = [fs.Ball(a="l0.end_a", b=(0, 0, 50)), fs.Ball(a="l1.end_a", b=(0, 0, 50)),
              PointOnLine(a="l0.end_b", b=(-6, 0, 45), axis=(0, 0, 1), name="rail"),
              Rod(a="l1.end_b", b=(6, 0, 47), name="rod")]  # fmt: skip
    lock = Lock(name="lock", joint="rail", engaged=engaged)
    system = fs.assemble(fs.Model(parts=[*lines, lock], joints=joints, sea=DRY))
    assert len(system.layout.chains) == 2 and len(system.layout.fronts) == 4
    w = random_work(system, 3)
    w.c[:4] = (1e4, 50.0, 1.0, 1e5)
    system.evaluate(w)
    linear, free = LinearSolver(system.layout), free_unknowns(system)
    A = linear.matrix(w.A).toarray()[np.ix_(free, free)]
    r, d = np.zeros(system.n), np.zeros(system.n)
    r[free] = np.random.default_rng(1).uniform(-1, 1, len(free))
    assert linear.solve(w.A, r, d)
    exact = np.linalg.solve(A, -r[free])
    state = "engaged" if engaged else "released"
    record("linear solver", f"line ends on a rail and a rod, lock {state}: against dense",
           np.abs(d[free] - exact).max() / np.abs(exact).max(), 1e-10)  # fmt: skip


@pytest.mark.parametrize("name", ALL)
def test_rates(name, record):
    """G v and the part of d2g/dt2 without accelerations, along a motion with constant velocities."""
    system = ALL[name]()
    w = random_work(system, 5)
    w.lam[:] = 0.0
    w.c[3] = 1.0
    n = system.n_dof
    G = matrix(system, w, (0.0, 0.0, 0.0, 1.0))[n:, :n]
    rate, gamma = system.constraints.rates(w)
    assert not rate.any()
    free = [i for i in free_unknowns(system) if i < n]

    def after(h):
        saved = w.x.copy(), w.q.copy(), w.R.copy()
        for i in free[::3]:
            turn = i > 3 * system.n_point
            if not turn:
                w.x[i // 3] += h * w.v[i : i + 3]
            else:
                from floatsim.frames import set_matrix, turn_quaternion

                k = i // 3 - system.n_point - 1
                w.q[k] = turn_quaternion(tuple(h * w.v[i : i + 3]), tuple(w.q[k]))
                set_matrix(w.R, k, tuple(w.q[k]))
        g = residual(system, w)[n:]
        for old, y in zip(saved, (w.x, w.q, w.R), strict=True):
            np.copyto(y, old)
        return g

    h = 1e-2
    g = {k: after(k * h) for k in (-3, -2, -1, 0, 1, 2, 3)}
    first = ((g[1] - g[-1]) * 45 - (g[2] - g[-2]) * 9 + (g[3] - g[-3])) / (60 * h)
    second = ((g[1] + g[-1]) * 270 - (g[2] + g[-2]) * 27 + (g[3] + g[-3]) * 2 - 490 * g[0]) / (180 * h * h)
    size = max(np.abs(first).max(), np.abs(second).max())
    worst = max(np.abs(first - G @ w.v).max(), np.abs(second - gamma).max()) / size
    record("tangents against central differences", f"joints: {name}, rates of the rows", worst, 1e-7)


@pytest.mark.parametrize("name", SYSTEMS)
def test_rigid_motion_and_balance(name, record):
    """Forces turn with the motion, rows stay as open as they were; forces add up to none, moments neither."""
    system = SYSTEMS[name]()
    worst = 0.0
    for seed in range(3):
        w = random_work(system, seed)
        w.v[:] = w.a[:] = 0.0
        before = forces(system, w)
        after = forces(system, moved(system, w, Q, SHIFT, 0.0 * DRIFT, 0.0 * SPIN))
        size = max(np.abs(before[0]).max(), np.abs(before[1]).max(initial=0.0))
        n = system.constraints.coincide.n
        turned = np.concatenate([(before[2][:n].reshape(-1, 3) @ Q.T).ravel(), before[2][n:]])
        f, m = before[:2]
        if "bead" in name:  # its mass has no residual at rest
            assert m.shape == (1, 3)
        moment = np.cross(w.x[: system.n_point], f).sum(axis=0) + m.sum(axis=0)
        for k, row in enumerate(system.constraints.points):  # an open ball joint carries a moment
            a, b = row.a, row.b
            gap = w.x[a.point] + w.R[a.rotation] @ a.arm - w.x[b.point] - w.R[b.rotation] @ b.arm
            moment -= np.cross(gap, w.lam[3 * k : 3 * k + 3])
        worst = max(
            worst, np.abs(after[0] - before[0] @ Q.T).max() / size, np.abs(after[1] - before[1] @ Q.T).max() / size,
            np.abs(after[2] - turned).max() / max(1.0, np.abs(turned).max()), np.abs(f.sum(axis=0)).max() / size,
            np.abs(moment).max() / size,
        )  # fmt: skip
    record("invariance", f"{name}: rigid motion, sums of forces and moments", worst, 1e-10)
