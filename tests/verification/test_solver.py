"""The structured linear solver against SuperLU, and the convergence of Newton's iteration."""

from __future__ import annotations

import sys
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mechanics import displace, free_unknowns

import floatsim as fs
from floatsim.solve.linear import LinearSolver
from floatsim.system import layout as layouts
from floatsim.system.layout import build_layout

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


ENDS = ("ground", "free", "body 0", "body 1", "line before", "body rows")


def random_system(rng, lines):
    """Layout and entries of lines (inner nodes, bending, what each end is tied to) between two bodies.

    Lines and bodies have nonsymmetric, diagonally dominant blocks, ties are rows [1, -1, arm] with a zero diagonal:
    such a system is regular whatever is tied to what.
    """
    first, nodes, runs = [], 0, []
    for inner, _, _, _ in lines:
        first.append(nodes)
        nodes += inner + 2
        runs.append((3 * (first[-1] + 1), 3 * inner))
    bodies = [nodes, nodes + 1]  # a point each, and a rotation each
    ground, rotation = nodes + 2, nodes + 3
    n_dof = 3 * (rotation + 3)
    xyz = np.arange(3)
    dofs = lambda *points: np.concatenate([3 * p + xyz for p in points])  # noqa: E731
    elements, ties = [dofs(b, rotation + k) for k, b in enumerate(bodies)], []
    for k, (inner, bending, a, b) in enumerate(lines):
        reach = 3 if bending and inner else 2
        last = first[k] + inner + 1
        elements += [dofs(*range(p, p + reach)) for p in range(first[k], last + 2 - reach)]
        for end, node, near in ((a, first[k], first[k] + 1), (b, last, last - 1)):
            if end == "body rows":  # bending against a body: element of the end, its neighbour and the body
                elements.append(dofs(node, near, bodies[0], rotation))
            elif end == "line before" and k > 0:
                ties.append((node, [first[k - 1] + lines[k - 1][0] + 1]))
            elif end == "ground":
                ties.append((node, []))
            elif end.startswith("body"):
                which = int(end[-1])
                ties.append((node, [bodies[which], rotation + which]))
    n = n_dof + 3 * len(ties)
    rows = [n_dof + 3 * k + xyz for k in range(len(ties))]
    tables = [d[None, :] for d in elements] + [np.arange(n)[:, None]]
    tables += [np.concatenate([i, dofs(node, *others)])[None, :] for i, (node, others) in zip(rows, ties, strict=True)]
    layout = build_layout(tables, runs, [*(3 * ground + xyz), *(3 * (rotation + 2) + xyz)], n)
    M = np.zeros((n, n))
    for d in elements:
        M[np.ix_(d, d)] += rng.uniform(-1, 1, (len(d), len(d))) + 1.2 * len(d) * np.eye(len(d))
    for i, (node, others) in zip(rows, ties, strict=True):
        arms = [-np.eye(3), -rng.uniform(0.2, 1, (3, 3))]  # of a point, of a rotation
        for d, value in ((dofs(node), np.eye(3)), *((dofs(o), arms[k]) for k, o in enumerate(others))):
            M[np.ix_(i, d)] += value
            M[np.ix_(d, i)] += value.T
    A = np.zeros(layout.size + 1)
    A[layout.slot] = M[layout.rows, layout.cols]
    return layout, A, M


LINES = st.lists(
    st.tuples(st.integers(0, 11), st.booleans(), st.sampled_from(ENDS), st.sampled_from(ENDS)), min_size=1, max_size=4
)


@settings(max_examples=150, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), lines=LINES, dense=st.booleans())
def test_any_lines_tied_to_anything(seed, lines, dense):
    """Structured solver, a second right-hand side with its factors, and SuperLU against LAPACK on the dense matrix.

    With the border as a dense matrix and, as in large models, as a sparse one.
    """
    rng = np.random.default_rng(seed)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(layouts, "MAX_BORDER", layouts.MAX_BORDER if dense else 0)
        layout, A, M = random_system(rng, lines)
    used = np.unique(layout.rows)
    matrix = M[np.ix_(used, used)]
    solver = LinearSolver(layout)
    assert layout.structured == dense
    assert np.array_equal(solver.matrix(A).toarray()[np.ix_(used, used)], matrix)
    x = np.zeros(layout.n)
    for solve in ("sparse", "structured", "again"):
        r = np.zeros(layout.n)
        r[used] = rng.uniform(-1, 1, len(used))
        if solve == "again":
            solver.solve_again(r, x)
        else:
            assert solver.solve_sparse(A, r, x) if solve == "sparse" else solver.solve(A, r, x)
        expected = np.linalg.solve(matrix, -r[used])
        assert np.abs(x[used] - expected).max() < 1e-10 * np.abs(expected).max(), solve
    assert solver.fallbacks == 0


def test_ends_of_lines_leave_the_border():
    """What the ends of moored lines are tied with is eliminated line by line: the body alone is left."""
    system = fs.assemble(moored_body(1e5))
    assert len(system.layout.border) == 6
    assert len(system.layout.fronts) == 6


def test_vanishing_pivot_goes_to_superlu():
    """A pivot of zero in the middle of a band that is regular as a whole: the entries survive for SuperLU."""
    rng = np.random.default_rng(3)
    layout, _, M = random_system(rng, [(9, True, "ground", "body 0"), (6, False, "body 1", "ground")])
    start = layout.chains[0].start
    used = np.unique(layout.rows)
    M[start : start + 3, start : start + 3] = [[0.0, 9.0, 0.0], [9.0, 0.0, 0.0], [0.0, 0.0, 9.0]]
    for k in range(3):  # nothing else touches the first pivot
        M[start + k, used[used != start + k]] *= 1.0 if k else 1e-9
    M[start, start + 1] = 9.0
    A = np.zeros(layout.size + 1)
    A[layout.slot] = M[layout.rows, layout.cols]
    solver = LinearSolver(layout)
    for fallbacks in (1, 2):
        r, x = np.zeros(layout.n), np.zeros(layout.n)
        r[used] = rng.uniform(-1, 1, len(used))
        before = A.copy()
        assert solver.solve(A, r, x)
        assert solver.fallbacks == fallbacks
        assert np.array_equal(A, before)
        expected = np.linalg.solve(M[np.ix_(used, used)], -r[used])
        assert np.abs(x[used] - expected).max() < 1e-10 * np.abs(expected).max()
    solver.solve_again(2.0 * r, x)
    assert np.abs(x[used] - 2.0 * expected).max() < 1e-10 * np.abs(expected).max()


def net(side):
    """side x side junctions joined by short lines."""
    sec = fs.Section(name="twine", mass_per_length=2.0, diameter=0.03, EA=1e6)
    names, parts, joints = {}, [], []
    for i, j in np.ndindex(side, side):
        names[i, j] = f"knot_{i}_{j}"
        parts.append(fs.PointMass(name=names[i, j], mass=5.0, position=(2.0 * i, 2.0 * j, -20.0)))
    for (i, j), name in names.items():
        for other in (names.get((i + 1, j)), names.get((i, j + 1))):
            if other is not None:
                parts.append(fs.Line(name=f"{name}_{other}", section=sec, length=2.02, elements=4))
                joints += [fs.Ball(a=f"{parts[-1].name}.end_a", b=name), fs.Ball(a=f"{parts[-1].name}.end_b", b=other)]
    return fs.Model(parts=parts, joints=joints, sea=SEA)


@pytest.mark.parametrize("package", ["SuperLU", "CHOLMOD"])
def test_net_against_superlu(package, monkeypatch, record):
    """A net whose border is sparse: by either package and by SuperLU on the whole matrix."""
    if package == "CHOLMOD":
        pytest.importorskip("sksparse.cholmod")
    else:
        monkeypatch.setitem(sys.modules, "sksparse.cholmod", None)
        monkeypatch.delitem(sys.modules, "floatsim.solve.cholesky", raising=False)
    monkeypatch.setattr(layouts, "MAX_BORDER", 50)
    system = fs.assemble(net(5))
    assert not system.layout.structured
    w = system.work()
    system.load(w, system.initial_state())
    for i in free_unknowns(system):
        displace(system, w, i, 0.02 * np.sin(i))
    w.v[: 3 * system.n_point] = np.cos(np.arange(3 * system.n_point))
    w.c[:4] = (1.4 / 0.05**2, 2.0 / 0.05, 1.0, 6e4)
    system.evaluate(w)
    solver = LinearSolver(system.layout)
    r, one, two = np.zeros(system.n), np.zeros(system.n), np.zeros(system.n)
    free = free_unknowns(system)
    r[free] = np.cos(np.arange(len(free)))
    assert solver.solve_sparse(w.A, r, two)
    assert solver.solve(w.A, r, one)
    assert solver.fallbacks == 0
    assert solver.border_solver == package
    parts = (free[free < system.n_dof], free[free >= system.n_dof])
    worst = max(np.abs(one - two)[part].max() / np.abs(two[part]).max() for part in parts)
    record("structured solver against SuperLU", f"net, border by {package}", worst, 1e-9)


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
