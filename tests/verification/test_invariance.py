"""Internal forces and joints under rigid motion, exchange of ends and reflection."""

from __future__ import annotations

import numpy as np
import pytest
from mechanics import DRY, displace, free_unknowns, residual
from scipy.spatial.transform import Rotation

import floatsim as fs
from floatsim.frames import set_matrix

Q = Rotation.from_rotvec((0.9, -1.7, 1.1)).as_matrix()
SHIFT, DRIFT, SPIN = np.array([13.0, -7.0, 31.0]), np.array([1.5, -0.4, 0.8]), np.array([0.6, -1.1, 0.9])
REFLECTION = np.diag([1.0, -1.0, 1.0])


def moved(system, w, turn, shift, drift, spin):
    """A copy of the scratch after the rigid motion x -> turn x + shift, v -> turn v + drift + spin x (turn x)."""
    new = system.work()
    p, k = system.n_point, system.n_rotation
    new.x[:p] = w.x[:p] @ turn.T + shift
    new.v[: 3 * p] = (w.v[: 3 * p].reshape(-1, 3) @ turn.T + drift + np.cross(spin, w.x[:p] @ turn.T)).ravel()
    a, b = 3 * p + 3, 3 * p + 3 + 3 * k
    new.v[a:b] = (w.v[a:b].reshape(-1, 3) @ turn.T + spin).ravel()
    for r in range(k):
        q = Rotation.from_matrix(turn @ w.R[r]).as_quat()
        new.q[r] = q[[3, 0, 1, 2]]
        set_matrix(new.R, r, tuple(new.q[r]))
    new.lam[:] = w.lam
    if system.constraints.points:
        n = 3 * len(system.constraints.points)
        new.lam[:n] = (w.lam[:n].reshape(-1, 3) @ turn.T).ravel()
    return new


def two_bodies(*parts, joints=()):
    points = {"p": (0.4, -0.3, 0.6), "o": (0.0, 0.0, 0.0)}
    common = dict(mass=3.0, inertia=(4.0, 6.0, 7.0), points=points)
    one = fs.Body(name="one", position=(0, 0, 5), **common)
    two = fs.Body(name="two", position=(0.4, -0.3, 5.6), **common)
    return fs.Model(parts=[one, two, *parts], joints=joints, sea=DRY, gravity=0.0)


def line(**more):
    values = dict(name="cable", mass_per_length=20.0, diameter=0.15, EA=1e6) | more
    part = fs.Line(name="line", section=fs.Section(**values), length=8.0, elements=6, taut=True,
                   end_a_position=(0.0, 0.0, 5.0), end_b_position=(6.0, 1.0, 9.0))  # fmt: skip
    return fs.Model(parts=[part], sea=DRY, gravity=0.0)


def cantilever():
    sec = fs.Section(
        name="cable", mass_per_length=20.0, diameter=0.15, EA=1e6, EI=1e4, bending_damping=1e3, axial_damping=1e4
    )
    part = fs.Line(name="line", section=sec, length=4.0, elements=3, end_b_position=(4.0, 0.0, 6.0), taut=True)
    return two_bodies(part, joints=[fs.Clamp(a="line.end_a", b="one.p", direction=(1.0, 0.2, -0.3))])


MODELS = {
    "axial": line,
    "axial and its damping": lambda: line(axial_damping=1e5),
    "bending": lambda: line(EA=1.0, EI=1e5),
    "bending and its damping": lambda: line(EA=1.0, EI=1.0, bending_damping=1e5),
    "spring between bodies": lambda: two_bodies(fs.Spring(name="s", a="one.p", b="two.p", stiffness=400.0, damping=50.0,
                                                          free_length=0.7)),
    "clamp on a body": cantilever,
    "ball between bodies": lambda: two_bodies(joints=[fs.Ball(a="one.p", b="two.o")]),
    "weld of bodies": lambda: two_bodies(joints=[fs.Weld(a="one.p", b="two.o")]),
}  # fmt: skip


def random_work(system, seed):
    rng = np.random.default_rng(seed)
    w = system.work()
    system.load(w, system.initial_state())
    for i in free_unknowns(system):
        displace(system, w, i, 0.6 * rng.uniform(-1, 1))
        if i < system.n_dof:
            w.v[i] = rng.uniform(-1, 1)
    w.lam[:] = 100.0 * rng.uniform(-1, 1, system.n_con)
    return w


def forces(system, w):
    """Residual by points, by rotations (n, 3) without the ground's, and constraint rows; bodies without inertia."""
    for batch in system.batches:
        if hasattr(batch, "P") and type(batch).__name__ == "BodyBatch":
            batch.P[:, 0] = batch.P[:, 4:13] = 0.0
    r = residual(system, w)
    a, b = 3 * system.n_point, system.n_dof
    return r[:a].reshape(-1, 3), r[a + 3 : b - 3].reshape(-1, 3), r[b:]


@pytest.mark.parametrize("name", MODELS)
def test_rigid_motion(name, record):
    """Forces turn with the motion; its velocity adds nothing; constraints stay as open as they were."""
    system = fs.assemble(MODELS[name]())
    worst = 0.0
    for seed in range(3):
        w = random_work(system, seed)
        before = forces(system, w)
        after = forces(system, moved(system, w, Q, SHIFT, DRIFT, SPIN))
        size = max(np.abs(before[0]).max(), np.abs(before[1]).max(initial=0.0))
        worst = max(worst, np.abs(after[0] - before[0] @ Q.T).max() / size)
        worst = max(worst, np.abs(after[1] - before[1] @ Q.T).max(initial=0.0) / size)
        n = 3 * len(system.constraints.points)
        turned = np.concatenate([(before[2][:n].reshape(-1, 3) @ Q.T).ravel(), before[2][n:]])
        worst = max(worst, np.abs(after[2] - turned).max(initial=0.0))
    record("invariance", f"{name} under rigid motion", worst, 1e-10)


@pytest.mark.parametrize("name", MODELS)
def test_balance(name, record):
    """Internal forces and joints add up to no force and no moment about any point."""
    system = fs.assemble(MODELS[name]())
    w = random_work(system, 1)
    f, m, _ = forces(system, w)
    arms = w.x[: system.n_point] - SHIFT
    total = f.sum(axis=0)
    # an open ball joint would carry a moment: its rows are closed here by taking the gap's moment out
    moment = np.cross(arms, f).sum(axis=0) + m.sum(axis=0)
    for k, row in enumerate(system.constraints.points):
        gap = w.x[row.a.point] + w.R[row.a.rotation] @ row.a.arm - w.x[row.b.point] - w.R[row.b.rotation] @ row.b.arm
        moment -= np.cross(gap, w.lam[3 * k : 3 * k + 3])
    size = np.abs(f).max() if np.abs(f).max() > 0.0 else np.abs(m).max()
    record(
        "invariance", f"{name}: sum of forces and moments", max(np.abs(total).max(), np.abs(moment).max()) / size, 1e-10
    )


FULL = dict(EI=1e4, bending_damping=1e3, axial_damping=1e4, drag_normal=1.2, drag_tangential=0.1, added_mass_normal=1.0,
            added_mass_tangential=0.3)  # fmt: skip


def wet_line():
    sea = fs.Sea(depth=9.0, current=fs.Current(speed=0.0))
    sec = fs.Section(name="cable", mass_per_length=20.0, diameter=0.15, EA=1e6, **FULL)
    part = fs.Line(
        name="line",
        section=sec,
        length=8.0,
        elements=6,
        taut=True,
        end_a_position=(0, 0, 0),
        end_b_position=(6, 0, -8.5),
    )
    return fs.assemble(fs.Model(parts=[part], sea=sea))


def test_swapped_ends(record):
    """The line numbered from the other end feels the same forces: weight, water, bed and all."""
    system = wet_line()
    w = random_work(system, 2)
    w.x[4:7, 2] = (-8.9, -9.05, -9.1)
    w.a[:21] = np.random.default_rng(0).uniform(-1, 1, 21)
    one = residual(system, w)[:21].reshape(7, 3)
    w.x[:7] = w.x[:7][::-1].copy()
    w.v[:21] = w.v[:21].reshape(7, 3)[::-1].ravel()
    w.a[:21] = w.a[:21].reshape(7, 3)[::-1].ravel()
    two = residual(system, w)[:21].reshape(7, 3)[::-1]
    record("invariance", "line with its ends exchanged", np.abs(one - two).max() / np.abs(one).max(), 1e-12)


def test_mirrored(record):
    """Reflected at the xz plane, everything is reflected."""
    system = wet_line()
    w = random_work(system, 3)
    w.x[4:7, 2] = (-8.9, -9.05, -9.1)
    one = residual(system, w)[:21].reshape(7, 3)
    w.x[:7] = w.x[:7] @ REFLECTION
    w.v[:21] = (w.v[:21].reshape(7, 3) @ REFLECTION).ravel()
    two = residual(system, w)[:21].reshape(7, 3) @ REFLECTION
    record("invariance", "line in a mirror", np.abs(one - two).max() / np.abs(one).max(), 1e-12)


def test_mirrored_body(record):
    """A tumbling body and its mirror image (axial vectors change sign otherwise) move alike."""
    ends = []
    for side in (1.0, -1.0):
        body = fs.Body(name="b", mass=2.0, inertia=(1.0, 1.6, 2.1, 0.1 * side, 0.2, -0.3 * side), position=(0, 0, 50),
                       center_of_mass=(0.1, 0.2 * side, 0.3), points={"p": (0.3, -0.2 * side, 0.5)})  # fmt: skip
        spring = fs.Spring(name="s", a="b.p", b=(1.0, 2.0 * side, 52.0), stiffness=50.0, damping=1.0, free_length=1.0)
        system = fs.assemble(fs.Model(parts=[body, spring], sea=DRY))
        state = system.initial_state()
        state.v[:3] = (0.3, 0.5 * side, -0.1)
        state.v[6:9] = (1.0 * side, 2.0, -0.7 * side)
        stepper = fs.Stepper(system, tolerance=1e-10)
        stepper.start(state, 0.01)
        for _ in range(200):
            assert stepper.step(state, 0.01).converged
        ends.append(np.concatenate([state.x[0] * (1, side, 1), state.v[6:9] * (side, 1, side)]))
    record("invariance", "tumbling body in a mirror, after 2 s", np.abs(ends[0] - ends[1]).max(), 1e-10)
