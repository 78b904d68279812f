"""The structured linear solver against SuperLU, and the convergence of Newton's iteration."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from mechanics import displace, free_unknowns

import floatsim as fs
from floatsim.solve.linear import LinearSolver

SEC = dict(name="cable", mass_per_length=60.0, diameter=0.15, EA=1e8, drag_normal=1.2, added_mass_normal=1.0)
SEA = fs.Sea(depth=200.0)


def line(name, elements, EI=0.0, form="shared", length=300.0):
    return fs.Line(name=name, section=fs.Section(**SEC, EI=EI), length=length, elements=elements, form=form)


def moored_body(EI=0.0, form="shared", elements=20):
    """A body on three lines, one of them hung from another's end."""
    points = {f"p{k}": (5.0 * np.cos(2.1 * k), 5.0 * np.sin(2.1 * k), -1.0) for k in range(3)}
    body = fs.Body(name="buoy", mass=5e4, inertia=(1e5, 1.2e5, 2e5), position=(0, 0, -5), points=points)
    spring = fs.Spring(name="spring", a="buoy", b=(0, 0, 50), stiffness=1e4, free_length=10.0)
    anchors = [(250 * np.cos(2.1 * k), 250 * np.sin(2.1 * k), -100.0) for k in range(3)]
    lines = [line(f"m{k}", elements, EI, form) for k in range(3)]
    joints = [fs.Ball(a=f"m{k}.end_a", b=f"buoy.p{k}") for k in range(3)]
    joints += [fs.Ball(a=f"m{k}.end_b", b=anchors[k]) for k in range(3)]
    return fs.Model(parts=[body, spring, *lines], joints=joints, sea=SEA)


def chain_of_lines():
    """Lines tied end to end, a clamp, a mass in the middle, a one-element and a two-element line."""
    parts = [line("a", 7, 1e4, length=100.0), line("b", 1, length=40.0), line("c", 2, 1e4, length=40.0),
             line("d", 12, length=150.0),
             fs.PointMass(name="clump", mass=500.0, position=(120.0, 0.0, -20.0))]  # fmt: skip
    joints = [fs.Clamp(a="a.end_a", b=(0, 0, -20), direction=(1, 0, -1)), fs.Ball(a="a.end_b", b=(90, 0, -20)),
              fs.Ball(a="b.end_a", b="a.end_b", name="ab"), fs.Ball(a="b.end_b", b="clump"),
              fs.Ball(a="c.end_a", b="clump"),
              fs.Ball(a="c.end_b", b=(150, 0, -30)), fs.Ball(a="d.end_a", b="clump", name="down"),
              fs.Ball(a="d.end_b", b=(200, 30, -100))]  # fmt: skip
    return fs.Model(parts=parts, joints=joints, sea=SEA)


SYSTEMS = {
    "body on three lines": moored_body,
    "body on three bending lines": lambda: moored_body(1e5),
    "body on three lines of ball_joints": lambda: moored_body(0.0, "ball_joints", 6),
    "lines in a row, clamp, clump": chain_of_lines,
    "short lines": lambda: moored_body(1e4, "shared", 2),
}


@pytest.mark.parametrize("name", SYSTEMS)
def test_structured_solver_against_superlu(name, record):
    """The same Newton matrices (mass and joints at two steps, random shapes) by both paths."""
    system = fs.assemble(SYSTEMS[name]())
    assert system.layout.structured
    solver = LinearSolver(system.layout)
    free = free_unknowns(system)
    worst = 0.0
    for seed, h in enumerate((0.1, 0.01, 0.1)):
        rng = np.random.default_rng(seed)
        w = system.work()
        system.load(w, system.initial_state())
        for i in free:
            displace(system, w, i, 0.02 * rng.uniform(-1, 1))
        w.c[:4] = (1.4 / h**2, 2.0 / h, 1.0, 60.0 / h**2)
        system.evaluate(w)
        r = np.zeros(system.n)
        r[free] = rng.uniform(-1, 1, len(free))
        one, two = np.zeros(system.n), np.zeros(system.n)
        assert solver.solve_sparse(w.A, r, two)
        assert solver.solve(w.A.copy(), r, one)
        for part in (free[free < system.n_dof], free[free >= system.n_dof]):
            worst = max(worst, np.abs(one - two)[part].max() / np.abs(two[part]).max())
    assert solver.fallbacks == 0
    record("structured solver against SuperLU", name, worst, 1e-9)


def test_newton_converges_quadratically(record):
    """Increments of one large step of a sagging line: each is about the square of the one before."""
    sec = fs.Section(name="cable", mass_per_length=20.0, diameter=0.1, EA=1e5, EI=1e3, added_mass_normal=1.0)
    part = fs.Line(name="line", section=sec, length=60.0, elements=12)
    joints = [fs.Ball(a="line.end_a", b=(0, 0, -40)), fs.Ball(a="line.end_b", b=(40, 0, -10))]
    system = fs.assemble(fs.Model(parts=[part], joints=joints, sea=fs.Sea(depth=200.0)))
    state, _ = fs.solve_static(system)
    state.v[3:36] = 5.0 * np.random.default_rng(0).uniform(-1, 1, 33)
    stepper = fs.Stepper(system, tolerance=1e-13)
    stepper.start(state, 0.05)
    seen = []
    inner = stepper.linear.solve

    def watched(A, r, x):
        done = inner(A, r, x)
        seen.append(np.abs(x[: 3 * system.n_point]).max())
        return done

    stepper.linear.solve = watched
    stepper.step(state, 0.05)
    seen = [y for y in seen if y > 1e-11]  # above rounding
    orders = [np.log(seen[k + 1] / seen[k]) / np.log(seen[k] / seen[k - 1]) for k in range(1, len(seen) - 1)]
    print(seen, orders)
    record("Newton iteration", "order from the last increments above rounding", orders[-1], (1.8, 3.0))


def test_a_long_line_is_assembled_in_little_memory():
    """4000 elements have 12000 unknowns: a dense matrix of them alone would take 1.2 GB."""
    ends = [fs.Ball(a="long.end_a", b=(0, 0, -100)), fs.Ball(a="long.end_b", b=(3000, 0, 0))]
    model = fs.Model(parts=[line("long", 4000, length=4000.0)], joints=ends, sea=SEA)
    tracemalloc.start()
    fs.assemble(model)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 3e8
