"""Static equilibrium of the whole system from a crude shape.

Damped implicit steps with growing size: each solves

    (M/h^2 + K) dq + G^T dlam = -r,     G dq = -g

from rest, so that h small follows the path a body in thick oil would take and h large is Newton's
method (pseudo-transient continuation, Kelley & Keyes 1998). Steps are limited in length; h grows while
the residual falls and shrinks when a step would fold or explode something. Minutes of explicit
relaxation become some hundred factorisations.

Two things make the way from a crude shape hard. Lines are so stiff that swinging by a tenth of an element
length strains them by more than their weight ever will: they start softened, with strains of some 2 % under their
own weight, and get their EA back in steps. And compression along a straight line *is* an equilibrium,
only an unstable one: until the shape has settled they push with a thousandth of EA.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from floatsim.errors import SolveFailed
from floatsim.frames import Array
from floatsim.solve.linear import LinearSolver
from floatsim.solve.step import kinematics, norms
from floatsim.system.state import State
from floatsim.system.system import System

TOLERANCE = 1e-8  # residual over the sum of forces at the same point
LOOSE, PATIENCE = 1e-6, 300  # what is enough after so many iterations: slack on the bed, barely in balance at all
MAX_ITERATIONS = 3000
H_START, H_SMALLEST, H_SWITCH = 0.05, 1e-4, 1.0  # s; first step, smallest, largest when the full law sets in
WORSE = 30.0  # growth of the unbalance at which a step is taken back
PUSH = 1e-3  # share of EA in compression until the shape has settled
SOFT_STEP = 0.5  # softening is taken back in steps of this


@dataclass(frozen=True)
class StaticReport:
    """How statics went. residual_force [N] and residual_moment [N m] are the largest unbalanced ones,
    recomputed without the solver's scaling; worst names where; balance is residual_force over the weight."""

    converged: bool
    iterations: int
    residual_force: float
    residual_moment: float
    worst: str
    balance: float
    reason: str = ""


def solve_static(
    system: System, state: State | None = None, hold: Sequence[str] = ()
) -> tuple[State, StaticReport]:
    """Equilibrium at t = state.t without waves, from `state` or the drawing position.

    hold: names of parts that stay where they are while everything else finds its equilibrium.
    Returns the state at rest and the report. Raises SolveFailed naming the worst unknown and the
    likely cause if it does not converge.
    """
    start = system.initial_state() if state is None else state.copy()
    w = system.work()
    linear = LinearSolver(system.layout)
    system.load(w, start)
    w.v[:] = 0.0
    w.a[:] = 0.0
    w.still = True
    system.begin(w, start, start.t)
    n_dof = system.n_dof
    d, out, zero = np.zeros(system.n), np.zeros(4), np.zeros(n_dof)
    once = np.array([1.0, 0.25, 0.5, 0.0, 0.0])  # kinematics of a plain increment
    x0, q0, lam0 = w.x.copy(), w.q.copy(), w.lam.copy()
    points, turns = slice(0, 3 * system.n_point), slice(3 * system.n_point + 3, n_dof)
    held = system.unknowns_of(hold)
    lay = system.layout
    held_slots = lay.slots(held[:, None])[:, 0]
    diagonal = lay.slot[(lay.rows == lay.cols) & (lay.rows < n_dof)]
    h, reach = H_START, 0.02 * system.length
    size, last = 1.0, np.inf
    w.c[4:] = PUSH, 1.0
    for iteration in range(1, MAX_ITERATIONS + 1):
        w.c[:4] = (1.0 / h**2, 0.0, 1.0, size)
        system.evaluate(w)
        w.r[held] = 0.0
        entries = np.abs(w.A[diagonal])
        w.A[held_slots] += 1e12 * entries.max(initial=1.0)
        norms(w.r, w.s, system.n_point, n_dof, size, out)
        true_law = w.c[4] == 1.0 and w.c[5] == 0.0
        enough = (TOLERANCE if iteration < PATIENCE else LOOSE) if true_law else 1e-3
        if out[0] <= enough and out[2] <= 1e-10 * system.length and w.trouble is None:
            if true_law:
                break
            if w.c[5] > 0.0:
                w.c[5] = max(0.0, w.c[5] - SOFT_STEP)
            else:
                w.c[4] = 1.0
            last, h = np.inf, min(h, H_SWITCH)
            continue
        merit = _unbalance(w.r, system.n_point, n_dof, system.length)
        if not merit < WORSE * last and h > H_SMALLEST:  # back, and more slowly
            np.copyto(w.x, x0)
            np.copyto(w.q, q0)
            np.copyto(w.lam, lam0)
            kinematics(zero, once, x0, q0, zero, zero, zero, w.x, w.q, w.R, w.v, w.a, w.aux)
            h, last = h * 0.2, np.inf
            continue
        if not np.isfinite(merit) or not linear.solve(w.A, w.r, d):
            return _failed(system, w, iteration, "the stiffness matrix is singular: something is free to drift", held)
        move, turn = float(np.abs(d[points]).max(initial=0.0)), float(np.abs(d[turns]).max(initial=0.0))
        part = min(1.0, reach / max(move, 1e-300), 0.1 / max(turn, 1e-300))
        np.copyto(x0, w.x)
        np.copyto(q0, w.q)
        np.copyto(lam0, w.lam)
        kinematics(part * d[:n_dof], once, x0, q0, zero, zero, zero, w.x, w.q, w.R, w.v, w.a, w.aux)
        w.v[:] = 0.0
        w.a[:] = 0.0
        w.lam += part * size * d[n_dof:]
        # switched evolution relaxation: the step grows as the residual falls
        h = min(max(h * (min(max(last / merit, 0.5), 2.0) if np.isfinite(last) else 1.2) * 1.1 * part, H_SMALLEST), 1e6)
        last = merit
        positive = entries[entries > 0.0]
        size = float(np.median(positive)) if len(positive) else 1.0
    else:
        return _failed(system, w, MAX_ITERATIONS, w.trouble or "no convergence", held)
    result = start
    for name in ("x", "q", "lam"):
        np.copyto(getattr(result, name), getattr(w, name))
    for name in ("v", "a", "aux"):
        getattr(result, name)[:] = 0.0
    result.step = 0.0
    system.forget(result)
    return result, _report(system, w, iteration, True, "", held)


def _unbalance(r: Array, n_point: int, n_dof: int, length: float) -> float:
    """Root mean square of the unbalanced forces [N], moments over the model's length.

    Not relative to the forces that meet at a point: those grow as fast as the residual when a step goes wrong.
    """
    n = 3 * n_point
    turns = r[n + 3 : n_dof - 3] / length
    return float(np.sqrt((r[:n] @ r[:n] + turns @ turns) / max(n, 1)))


def _report(system: System, w, iterations: int, converged: bool, reason: str, held) -> StaticReport:  # type: ignore[no-untyped-def]
    """Unbalanced forces in newtons, from the raw residual of a fresh evaluation."""
    w.c[:4] = (0.0, 0.0, 0.0, 1.0)
    system.evaluate(w)
    w.r[held] = 0.0
    n = 3 * system.n_point
    force = np.abs(w.r[:n])
    moment = np.abs(w.r[n + 3 : system.n_dof - 3])
    worst = int(np.argmax(force)) if len(force) else 0
    weight = float(w.s.max(initial=0.0))
    return StaticReport(
        converged, iterations, float(force.max(initial=0.0)), float(moment.max(initial=0.0)),
        system.unknown_name(worst), float(force.max(initial=0.0)) / weight if weight > 0.0 else 0.0, reason,
    )  # fmt: skip


def _failed(system: System, w, iterations: int, reason: str, held) -> tuple[State, StaticReport]:  # type: ignore[no-untyped-def]
    report = _report(system, w, iterations, False, reason, held)
    raise SolveFailed(
        f"no static equilibrium after {iterations} iterations: {reason}; largest unbalanced force "
        f"{report.residual_force:.3g} N at {report.worst}",
        report,
    )
