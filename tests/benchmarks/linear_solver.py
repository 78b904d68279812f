"""One linear solve: cables and moorings by bands, nets with a sparse border, each beside SuperLU on the whole matrix.

    python tests/benchmarks/linear_solver.py

Medians in microseconds of ten calls and one of SuperLU in turn, with the matrix of a displaced shape; the largest
difference between the two solutions, relative to the largest unknown of its kind. Exit status 1 if a bar is missed.
With the extra `cholmod` a net's border is solved by CHOLMOD, otherwise by SuperLU; the table says by which.
"""

from __future__ import annotations

import os
import sys
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np  # noqa: E402

import floatsim as fs  # noqa: E402
from floatsim.solve.linear import LinearSolver  # noqa: E402

SEA = fs.Sea(depth=200.0)
STEP = 0.05  # s
SAME = 1e-9


def section(EI: float) -> fs.Section:
    return fs.Section(name="cable", mass_per_length=60.0, diameter=0.15, EA=1e8, EI=EI, added_mass_normal=1.0)


def cable(EI: float) -> fs.Model:
    """137 elements between two fixed points."""
    part = fs.Line(name="cable", section=section(EI), length=300.0, elements=137)
    joints = [fs.Ball(a="cable.end_a", b=(0, 0, -150)), fs.Ball(a="cable.end_b", b=(200, 0, -20))]
    return fs.Model(parts=[part], joints=joints, sea=SEA)


def moored(EI: float, lines: int, elements: int) -> fs.Model:
    """A body on lines."""
    angles = 2.0 * np.pi * np.arange(lines) / lines
    points = {f"p{k}": (5.0 * np.cos(a), 5.0 * np.sin(a), -1.0) for k, a in enumerate(angles)}
    body = fs.Body(name="buoy", mass=5e4, inertia=(1e5, 1.2e5, 2e5), position=(0, 0, -5), points=points)
    parts: list = [body]
    joints = []
    for k, a in enumerate(angles):
        parts.append(fs.Line(name=f"m{k}", section=section(EI), length=300.0, elements=elements))
        joints += [fs.Ball(a=f"m{k}.end_a", b=f"buoy.p{k}"),
                   fs.Ball(a=f"m{k}.end_b", b=(250.0 * np.cos(a), 250.0 * np.sin(a), -100.0))]  # fmt: skip
    return fs.Model(parts=parts, joints=joints, sea=SEA)


def net(side: int) -> fs.Model:
    """side x side junctions joined by lines of three elements."""
    names = {(i, j): f"k{i}_{j}" for i in range(side) for j in range(side)}
    parts: list = [fs.PointMass(name=name, mass=5.0, position=(4.0 * i, 4.0 * j, -20.0 - i))
                   for (i, j), name in names.items()]  # fmt: skip
    joints = []
    for (i, j), name in names.items():
        for other, length in ((names.get((i + 1, j)), np.hypot(4.0, 1.0)), (names.get((i, j + 1)), 4.0)):
            if other is not None:
                line = f"{name}_{other}"
                parts.append(fs.Line(name=line, section=section(0.0), length=1.02 * length, elements=3))
                joints += [fs.Ball(a=f"{line}.end_a", b=name), fs.Ball(a=f"{line}.end_b", b=other)]
    return fs.Model(parts=parts, joints=joints, sea=SEA)


CASES = (  # bars in microseconds
    ("cable, 137 elements", lambda: cable(0.0), 15.0),
    ("cable, 137 elements, bending", lambda: cable(1e5), 15.0),
    ("body on 3 x 50 elements", lambda: moored(0.0, 3, 50), 20.0),
    ("body on 3 x 50 elements, bending", lambda: moored(1e5, 3, 50), 20.0),
    ("body on 12 x 20 elements", lambda: moored(0.0, 12, 20), 50.0),
    ("net, 8 x 8 junctions", lambda: net(8), 2e3),
    ("net, 12 x 12 junctions", lambda: net(12), 5e3),
)


def measure(model: fs.Model) -> tuple[LinearSolver, float, float, float]:
    """Solver, microseconds of one solve, of SuperLU on the whole matrix, largest relative difference."""
    system = fs.assemble(model)
    w = system.work()
    system.load(w, system.initial_state())
    rng = np.random.default_rng(0)
    w.x[:-1] += 0.02 * rng.uniform(-1, 1, (system.n_point, 3))
    w.v[: 3 * system.n_point] = rng.uniform(-0.5, 0.5, 3 * system.n_point)
    w.c[:4] = (1.4 / STEP**2, 2.0 / STEP, 1.0, 1e5)
    system.evaluate(w)
    layout = system.layout
    free = np.unique(layout.rows)
    r, one, two = np.zeros(system.n), np.zeros(system.n), np.zeros(system.n)
    r[free] = rng.uniform(-1, 1, len(free))
    solver, A = LinearSolver(layout), w.A.copy()
    solver.solve(A, r, one)
    times: tuple[list[float], list[float]] = ([], [])
    for _ in range(200 if len(layout.rows) < 20000 else 15):
        for _ in range(10):
            np.copyto(A, w.A)
            start = time.perf_counter()
            solver.solve(A, r, one)
            times[0].append(time.perf_counter() - start)
        start = time.perf_counter()
        solver.solve_sparse(w.A, r, two)
        times[1].append(time.perf_counter() - start)
    worst = 0.0
    for kind in (free[free < system.n_dof], free[free >= system.n_dof]):
        worst = max(worst, np.abs(one - two)[kind].max() / np.abs(two[kind]).max())
    assert solver.fallbacks == 0
    return solver, 1e6 * float(np.median(times[0])), 1e6 * float(np.median(times[1])), worst


def main() -> int:
    good = True
    print(f"{'':34s} unknowns  border               us   SuperLU  ratio  difference")
    for name, make, bar in CASES:
        solver, ours, whole, worst = measure(make())
        by = solver.border_solver
        held = ours < bar and worst < SAME
        good &= held
        print(f"{name:34s} {solver.layout.n:8d}  {len(solver.layout.border):4d} {by:8s} {ours:9.1f} {whole:9.0f} "
              f"{whole / ours:6.1f}     {worst:.0e}{'' if held else f'  MISSED: {bar:g} us, {SAME:g}'}")  # fmt: skip
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
