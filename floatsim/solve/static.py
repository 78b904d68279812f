"""Static equilibrium of the whole system from a crude shape.

Damped implicit steps with growing size: each solves

    (M/h^2 + K) dq + G^T dlam = -r,     G dq = -g

from rest, so that h small follows the path a body in thick oil would take and h large is Newton's
method (pseudo-transient continuation, Kelley & Keyes 1998). Steps are limited in length; h grows while
the residual falls and shrinks when a step would fold or explode something. Minutes of explicit
relaxation become some hundred factorisations.

A slack line drawn straight is compressed by far more than its weight, and straight compression *is* an
equilibrium, only an unstable one. So lines first push with a thousandth of EA; once that has settled
the full law takes over. An equilibrium without compression is the same for both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from floatsim.errors import SolveFailed
from floatsim.solve.linear import LinearSolver
from floatsim.solve.step import kinematics, norms
from floatsim.system.state import State
from floatsim.system.system import System

TOLERANCE = 1e-8  # residual over the sum of forces at the same point
MAX_ITERATIONS = 3000
PUSH = 1e-3  # share of EA in compression until the shape has settled


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
    d, out = np.zeros(system.n), np.zeros(4)
    zero = np.zeros(n_dof)
    k = np.array([1.0, 0.25, 0.5, 0.0, 0.0])
    x0, q0 = np.empty_like(w.x), np.empty_like(w.q)
    points = slice(0, 3 * system.n_point)
    h, reach = 0.05, 0.02 * system.length
    w.c[:4] = (1.0 / h**2, 0.0, 1.0, 1.0)
    system.evaluate(w)
    lay = system.layout
    diagonal = lay.slot[(lay.rows == lay.cols) & (lay.rows < n_dof)]
    held = system.unknowns_of(hold)
    held_slots = lay.slots(held[:, None])[:, 0]
    best = np.inf
    w.c[4] = PUSH
    stalled = 0
    for iteration in range(1, MAX_ITERATIONS + 1):
        size = np.abs(w.A[diagonal])
        w.c[:4] = (1.0 / h**2, 0.0, 1.0, float(np.median(size[size > 0.0])) if size.any() else 1.0)
        system.evaluate(w)
        w.r[held] = 0.0
        w.A[held_slots] += 1e12 * w.c[3]
        norms(w.r, w.s, system.n_point, n_dof, w.c[3], out)
        if out[0] <= (TOLERANCE if w.c[4] == 1.0 else 1e-3) and out[2] <= 1e-10 * system.length and w.trouble is None:
            if w.c[4] == 1.0:
                break
            w.c[4] = 1.0
            continue
        if not np.isfinite(out[0]) or not linear.solve(w.A, w.r, d):
            return _failed(system, w, iteration, "the stiffness matrix is singular: something is free to drift", held)
        move = float(np.abs(d[points]).max(initial=0.0))
        turn = float(np.abs(d[3 * system.n_point + 3 : n_dof]).max(initial=0.0))
        part = min(1.0, reach / move if move > 0.0 else 1.0, 0.1 / turn if turn > 0.0 else 1.0)
        np.copyto(x0, w.x)
        np.copyto(q0, w.q)
        y = part * d[:n_dof]
        kinematics(y, k, x0, q0, zero, zero, zero, w.x, w.q, w.R, w.v, w.a, w.aux)
        w.v[:] = 0.0
        w.a[:] = 0.0
        w.lam += part * w.c[3] * d[n_dof:]
        merit = out[0] + out[2] / system.length
        h = h * 1.5 if part == 1.0 else max(h * 0.7, 1e-3)
        if merit < best:
            best, stalled = merit, 0
        else:
            stalled += 1
            if stalled > 60:
                h, stalled, best = 0.05, 0, np.inf
        h = min(h, 1e8)
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
