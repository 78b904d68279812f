"""A net of short lines between knots, held at its rim: a border of knots too large for a dense solver.

The stretched net has two references. Knots at height w under tensions T per cable and a weight Q each obey
T (w_left + w_right + w_below + w_above - 4 w)/mesh = Q, the five-point Poisson equation; with ever more meshes that is
the membrane, 0.0737 q a^2/T in the middle (Timoshenko & Goodier, Theory of Elasticity, art. on the membrane analogy:
series in the test). Both hold for sags small enough not to stretch the cables.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest
from shipped import load

import floatsim as fs

net = load("net")
ROW = "net of {n} x {n} knots"
SPEED = 0.5  # m/s


def knots(system: fs.System, state: fs.State, n: int) -> np.ndarray:
    """Positions (n, n, 3) of the knots."""
    first = [system.numbering.first_point[system.numbering.index(f"knot_{i}_{j}")]
             for i in range(1, n + 1) for j in range(1, n + 1)]  # fmt: skip
    return state.x[first].reshape(n, n, 3)


def rim_force(system: fs.System, state: fs.State) -> np.ndarray:
    """Force (3,) of the net on its rim."""
    rows = [system.joint_rows[joint.label][0][0] for joint in system.model.joints if not isinstance(joint.b, str)]
    return state.lam.reshape(-1, 3)[rows].sum(axis=0)


def weight(system: fs.System) -> float:
    """In water [N]: twine as a cylinder of its length, knots without volume."""
    twine = sum(line.length for line in system.model.parts if isinstance(line, fs.Line))
    section = next(part for part in system.model.parts if isinstance(part, fs.Line)).pieces[0].section
    mass = sum(part.mass for part in system.model.parts if isinstance(part, fs.PointMass))
    area = 0.25 * np.pi * section.diameter**2
    return float(net.GRAVITY * (mass + twine * (section.mass_per_length - net.DENSITY * area)))


def drag(system: fs.System, state: fs.State, velocity: np.ndarray) -> np.ndarray:
    """Morison drag (3,) [N] of all elements at rest, from their directions alone."""
    total = np.zeros(3)
    num = system.numbering
    for line, p in zip(num.parts, num.first_point, strict=True):
        if not isinstance(line, fs.Line):
            continue
        section = line.pieces[0].section
        step = np.diff(state.x[p : p + line.n_points], axis=0)
        t = step / np.linalg.norm(step, axis=1)[:, None]
        along = t @ velocity
        across = velocity - along[:, None] * t
        pressure = 0.5 * net.DENSITY * section.diameter * line.element_lengths
        total += (pressure * section.drag_normal * np.linalg.norm(across, axis=1)) @ across
        total += (pressure * np.pi * section.drag_tangential * np.abs(along) * along) @ t
    return total


def solved(**parameters: Any) -> tuple[fs.System, fs.State, fs.StaticReport]:
    system = fs.assemble(net.build(**parameters))
    assert parameters["n"] < 20 or not system.layout.structured  # the path this test is about
    return system, *fs.solve_static(system)


def check_symmetry(record, row: str, w: np.ndarray) -> None:
    """w (n, n) under the reflections and the diagonal of the square."""
    worst = max(np.abs(w - image).max() for image in (w[::-1], w[:, ::-1], w.T))
    record(row, "heights under the symmetries of the square: largest difference over the sag",
           worst / np.ptp(w), 1e-6, "")  # fmt: skip


@pytest.mark.parametrize("n", [6, pytest.param(20, marks=pytest.mark.slow)])
def test_hung_in_still_water(n, record):
    row = f"{ROW.format(n=n)}, slack, still water"
    system, state, report = solved(n=n)
    W = weight(system)
    force = rim_force(system, state)
    record(row, "vertical force on the rim against the weight: error", abs(force[2] / -W - 1.0), 1e-9)
    record(row, "horizontal force on the rim over the weight", np.hypot(force[0], force[1]) / W, 1e-9)
    record(row, "largest unbalanced force over the weight", report.residual_force / W, 1e-6)
    check_symmetry(record, row, knots(system, state, n)[..., 2])


@pytest.mark.parametrize("n", [6, pytest.param(20, marks=pytest.mark.slow)])
def test_hung_in_a_current(n, record):
    """The bag leans downstream: its rim carries drag along the current, weight upwards, nothing across."""
    row = f"{ROW.format(n=n)}, slack, current {SPEED} m/s"
    system, state, report = solved(n=n, current=fs.Current(speed=SPEED))
    W, force = weight(system), rim_force(system, state)
    expected = drag(system, state, np.array([SPEED, 0.0, 0.0])) - [0.0, 0.0, W]
    assert expected[0] > 0.1 * W
    record(row, "force on the rim against drag and weight: error", np.abs(force - expected).max() / W, 1e-7)
    record(row, "largest unbalanced force over the weight", report.residual_force / W, 1e-6)
    w = knots(system, state, n)
    across = np.abs(w[..., 2] - w[:, ::-1, 2]).max() / np.ptp(w[..., 2])
    record(row, "heights left and right of the current: largest difference over the sag", across, 1e-6)


@pytest.mark.parametrize("n", [6, pytest.param(20, marks=pytest.mark.slow)])
def test_stretched_upright_in_a_current(n, record):
    """Nearly flat, every twine lies across the current: 0.5 rho Cd d U^2 of it per length. The net bulges by
    0.14 % of its side, which takes off less than the square of that slope."""
    row = f"{ROW.format(n=n)}, stretched upright, current {SPEED} m/s"
    system, state, _ = solved(n=n, slack=-0.02, upright=True, current=fs.Current(speed=SPEED))
    lines = [part for part in system.model.parts if isinstance(part, fs.Line)]
    section, length = lines[0].pieces[0].section, sum(line.length for line in lines)
    flat = 0.5 * net.DENSITY * section.drag_normal * section.diameter * SPEED**2 * length
    force = rim_force(system, state)
    record(row, "drag on the rim against the flat net's: error", 100.0 * abs(force[0] / flat - 1.0), 0.01, "%")
    record(row, "vertical force on the rim against the weight: error", abs(force[2] / -weight(system) - 1.0), 1e-6)


def poisson(n: int, load: float) -> np.ndarray:
    """w (n, n) of sum of neighbours - 4 w = load, zero on the rim, by the sine vectors that diagonalise it."""
    k = np.arange(1, n + 1)
    S = np.sqrt(2.0 / (n + 1)) * np.sin(np.pi * np.outer(k, k) / (n + 1))
    e = 2.0 * np.cos(np.pi * k / (n + 1)) - 2.0
    return S @ (S @ np.full((n, n), load) @ S / (e[:, None] + e[None, :])) @ S


def membrane(x: float, y: float) -> float:
    """Deflection over q a^2/T of a square membrane at (x, y), in sides from a corner: double sine series."""
    m = np.arange(1, 400, 2)
    s = np.sin(np.pi * m * x)[:, None] * np.sin(np.pi * m * y)[None, :]
    return float(16.0 / np.pi**4 * np.sum(s / (m[:, None] * m[None, :] * (m[:, None] ** 2 + m[None, :] ** 2))))


@pytest.mark.parametrize("n", [6, pytest.param(20, marks=pytest.mark.slow)])
def test_stretched_net_is_a_membrane(n, record):
    """Weight at the knots only (one element a line: half the twine goes to each end), 2 % stretch, Green's N."""
    row = f"{ROW.format(n=n)}, stretched"
    assert abs(membrane(0.5, 0.5) - 0.0737) < 5e-5
    mesh, slack = 0.5, -0.02
    system, state, _ = solved(n=n, mesh=mesh, slack=slack, elements=1, knot_mass=0.02)
    section = next(part for part in system.model.parts if isinstance(part, fs.Line)).pieces[0].section
    stretch = 1.0 / (1.0 + slack)
    T = section.EA * 0.5 * (stretch**2 - 1.0) * stretch
    twine = mesh * (1.0 + slack) * net.GRAVITY * (
        section.mass_per_length - net.DENSITY * 0.25 * np.pi * section.diameter**2
    )  # fmt: skip
    Q = 0.02 * net.GRAVITY + 2.0 * twine  # of a knot and the halves of its four lines
    sag = -25.0 - knots(system, state, n)[..., 2]
    discrete = poisson(n, -Q * mesh / T)
    record(row, "sag of all knots against the five-point Poisson equation: error",
           100.0 * np.abs(sag / discrete - 1.0).max(), 0.1, "%")  # fmt: skip
    side, middle = (n + 1) * mesh, (n // 2) / (n + 1)
    expected = membrane(middle, middle) * (Q / mesh**2) * side**2 / (T / mesh)
    bar = 100.0 / (n + 1) ** 2 + 0.1  # the five-point equation is second order
    record(row, "sag in the middle against the membrane: error", 100.0 * abs(sag.max() / expected - 1.0), bar, "%")


@pytest.mark.slow
def test_time_of_statics(record):
    """What a general net costs, in processor time; 840 lines, 400 knots, 5040 constraint rows."""
    row = ROW.format(n=20)
    began = time.process_time()
    model = net.build()
    system = fs.assemble(model)
    built = time.process_time()
    _, report = fs.solve_static(system)
    done = time.process_time()
    record(row, "description and assembly", built - began, "reported, no bar", "s", holds=True)
    each = 1e3 * (done - built) / report.iterations
    record(row, "static iteration", each, "reported, no bar", "ms", holds=True)
    record(row, "static iterations", report.iterations, 400.0)
