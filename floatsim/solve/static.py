"""Static equilibrium of the whole system from a crude shape.

Damped implicit steps with growing size: each solves

    (M/h^2 + K) dq + G^T dlam = -r,     G dq = -g

from rest, so that h small follows the path a body in thick oil would take and h large is Newton's
method (pseudo-transient continuation, Kelley & Keyes 1998). Steps are limited in length; h grows while
the residual falls and shrinks when a step would fold or explode something. Minutes of explicit
relaxation become some hundred factorisations.

Two things make the way from a crude shape hard. Lines are so stiff that swinging by a tenth of an element
length strains them by more than their weight ever will: they start with EA capped at 25 times all loads on points,
strains of some 2 %, and get it back in steps. And compression along a straight line *is* an equilibrium,
only an unstable one: until the shape has settled they push with a small share of EA. That keeps slack lines from it,
not a vertical line a little longer than its span; `natural_modes` refuses an unstable equilibrium, this solve does not.
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
SETTLED = 1e-3  # the same for a softened law
MAX_ITERATIONS = 3000  # for each of PUSHES
H_START, H_SMALLEST, H_LARGEST, H_SWITCH = 0.05, 1e-4, 1e6, 1.0  # s; the last: largest when the law changes
WORSE = 30.0  # growth of the unbalance at which a step is taken back
STALLED = 60  # iterations without a better balance after which h starts small again
PUSHES = (1e-3, 1e-1)  # share of EA in compression until the shape has settled; the second if the first fails
CAP, CAP_GROWTH, CAP_STEPS = 25.0, 30.0, 6  # of EA, over all loads on points; its growth from step to step


@dataclass(frozen=True)
class StaticReport:
    """How statics went. residual_force [N] and residual_moment [N m] are the largest unbalanced ones,
    recomputed without the solver's scaling; worst names where; balance is residual_force over the largest force
    at a point. Equilibria may be unstable, like a pendulum on its head: `natural_modes` tells."""

    converged: bool
    iterations: int
    residual_force: float
    residual_moment: float
    worst: str
    balance: float
    reason: str = ""


def solve_static(
    system: System, state: State | None = None, hold: Sequence[str] = (), friction: bool = False
) -> tuple[State, StaticReport]:
    """Equilibrium at t = state.t without waves, from `state` or the drawing position.

    hold: names of parts that stay where they are while everything else finds its equilibrium. friction: the seabed
    holds lines back from where `state` has them stick (from an equilibrium: a slow offset); without, nothing does.
    Returns the state at rest and the report. Raises SolveFailed naming the worst unknown and the
    likely cause if it does not converge.
    """
    start = system.initial_state() if state is None else state.copy()
    for push in PUSHES:
        relax = _Relaxation(system, start, hold, push, friction)
        for iteration in range(1, MAX_ITERATIONS + 1):
            relax.evaluate()
            if relax.balanced(iteration):
                if relax.true_law and relax.polished():
                    return relax.result(), relax.report(iteration, True)
                if not relax.true_law:
                    relax.stiffen()
            elif relax.worse():
                relax.back()
            elif not relax.forward():
                return relax.fail(iteration, "the stiffness matrix is singular: something is free to drift")
    return relax.fail(MAX_ITERATIONS * len(PUSHES), relax.work.trouble or "no convergence")


class _Relaxation:
    """The state of a static solve: configuration, step size h, and the law that lines follow for the moment."""

    def __init__(self, system: System, start: State, hold: Sequence[str], push: float, friction: bool) -> None:
        self.system, self.start = system, start
        self.linear = LinearSolver(system.layout)
        self.work = w = system.work()
        system.load(w, start)
        w.v[:] = 0.0
        w.a[:] = 0.0
        w.still = True
        self._friction = friction
        w.c[7] = float(friction)
        system.begin(w, start, start.t)
        lay, n_dof = system.layout, system.n_dof
        self._held = system.unknowns_of(hold)
        self._held_slots = lay.slots(self._held[:, None])[:, 0]
        self._diagonal = lay.slot[(lay.rows == lay.cols) & (lay.rows < n_dof)]
        self._points, self._turns = slice(0, 3 * system.n_point), slice(3 * system.n_point + 3, n_dof - 3)
        self._d, self._norms, self._zero = np.zeros(system.n), np.zeros(4), np.zeros(n_dof)
        self._entries = np.zeros(len(self._diagonal))
        self._last = (w.x.copy(), w.q.copy(), w.lam.copy())
        self._unbalance = self._before = self._best = np.inf  # now, at the last configuration, and the least
        self._stalled = 0
        self.h, self._reach = H_START, 0.02 * system.length
        self._size = 1.0  # of the constraint rows: that of the matrix they border
        self._polished = False
        w.c[:6] = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0)  # loads alone: no axial force yet
        system.evaluate(w)
        w.c[4:6] = push, CAP * max(float(w.s[system.free_points()].sum()), 1e-9)
        self._caps = CAP_STEPS

    @property
    def true_law(self) -> bool:
        """Whether lines follow their own law by now."""
        return bool(self.work.c[4] == 1.0)

    def evaluate(self) -> None:
        """Residual and matrix here."""
        w, sys = self.work, self.system
        w.c[:4] = (1.0 / self.h**2, 0.0, 1.0, self._size)
        sys.flow(w, w.x, w.t)  # a current may change with depth
        sys.evaluate(w)
        w.r[self._held] = 0.0
        self._entries = np.abs(w.A[self._diagonal])
        w.A[self._held_slots] += 1e12 * self._entries.max(initial=1.0)
        norms(w.r, w.s, sys.n_point, sys.n_dof, self._size, self._norms)
        # the root mean square of unbalanced forces, moments over the model's length; not relative to the forces that
        # meet at a point, because those grow as fast as the residual when a step goes wrong
        force, moment = w.r[self._points], w.r[self._turns] / sys.length
        self._unbalance = float(np.sqrt((force @ force + moment @ moment) / max(len(force), 1)))

    def balanced(self, iteration: int) -> bool:
        """Whether this is the equilibrium of the present law, closely enough."""
        final = TOLERANCE if iteration < PATIENCE else LOOSE
        e = self._norms
        closed = e[2] <= 1e-10 * self.system.length
        return bool(e[0] <= (final if self.true_law else SETTLED) and closed and self.work.trouble is None)

    def stiffen(self) -> None:
        """One step from the softened law towards the true one."""
        c = self.work.c
        if self._caps > 0:
            self._caps -= 1
            c[5] *= CAP_GROWTH
        else:
            c[4:6] = 1.0, np.inf
        self._before = self._best = np.inf
        self.h = min(self.h, H_SWITCH)

    def polished(self) -> bool:
        """Whether one full Newton step was made after balance was reached; makes it if not.

        Where lines hang loosely, small forces move them far.
        """
        if not self._polished:
            self._polished, self.h = True, H_LARGEST
            self.evaluate()
            self.forward()
            return False
        return True

    def worse(self) -> bool:
        """Whether the last step went wrong."""
        return not self._unbalance < WORSE * self._before and self.h > H_SMALLEST

    def back(self) -> None:
        """Take the last step back and go on more slowly."""
        x, q, lam = self._last
        self._configure(self._zero, x, q)
        np.copyto(self.work.lam, lam)
        self.h, self._before = 0.2 * self.h, np.inf

    def forward(self) -> bool:
        """One limited step; h grows as the residual falls (switched evolution relaxation). False if singular."""
        w, d, n_dof = self.work, self._d, self.system.n_dof
        if not np.isfinite(self._unbalance) or not self.linear.solve(w.A, w.r, d):
            return False
        move = float(np.abs(d[self._points]).max(initial=0.0))
        turn = float(np.abs(d[self._turns]).max(initial=0.0))
        part = min(1.0, self._reach / max(move, 1e-300), 0.1 / max(turn, 1e-300))
        for kept, value in zip(self._last, (w.x, w.q, w.lam), strict=True):
            np.copyto(kept, value)
        self._configure(part * d[:n_dof], self._last[0], self._last[1])
        w.lam += part * self._size * d[n_dof:]
        fall = self._before / max(self._unbalance, 1e-300)
        fall = min(max(fall, 0.5), 2.0) if np.isfinite(fall) else 1.2
        self.h = min(max(self.h * 1.1 * fall * part, H_SMALLEST), H_LARGEST)
        self._before = self._unbalance
        self._stalled += 1
        if self._unbalance < self._best:
            self._best, self._stalled = self._unbalance, 0
        elif self._stalled > STALLED:
            self.h, self._best, self._stalled = H_START, np.inf, 0
        positive = self._entries[self._entries > 0.0]
        self._size = float(np.median(positive)) if len(positive) else 1.0
        return True

    def _configure(self, y: Array, x: Array, q: Array) -> None:
        w, zero = self.work, self._zero
        kinematics(y, np.array([1.0, 0.25, 0.5, 0.0, 0.0]), x, q, zero, zero, zero, w.x, w.q, w.R, w.v, w.a, w.aux)
        w.v[:] = 0.0
        w.a[:] = 0.0

    def result(self) -> State:
        """The equilibrium as a state at rest, with fresh memories but for what friction holds."""
        w, state = self.work, self.start
        for name in ("x", "q", "lam"):
            np.copyto(getattr(state, name), getattr(w, name))
        for name in ("v", "a", "aux"):
            getattr(state, name)[:] = 0.0
        state.step = 0.0
        before = state.history
        self.system.forget(state)
        if self._friction:
            self.system.hold_back(w, before, state.history)
        return state

    def report(self, iterations: int, converged: bool, reason: str = "") -> StaticReport:
        """Unbalanced forces in newtons, from the raw residual of a fresh evaluation without any scaling."""
        w, sys = self.work, self.system
        w.c[:6] = (0.0, 0.0, 0.0, 1.0, 1.0, np.inf)
        sys.evaluate(w)
        w.r[self._held] = 0.0
        force, moment = np.abs(w.r[self._points]), np.abs(w.r[self._turns])
        worst = int(np.argmax(force)) if len(force) else 0
        largest, weight = float(force.max(initial=0.0)), float(w.s.max(initial=0.0))
        return StaticReport(
            converged, iterations, largest, float(moment.max(initial=0.0)), sys.unknown_name(worst),
            largest / weight if weight > 0.0 else 0.0, reason,
        )  # fmt: skip

    def fail(self, iterations: int, reason: str) -> tuple[State, StaticReport]:
        """Raise SolveFailed with the worst unknown."""
        report = self.report(iterations, False, reason)
        loose = self.system.model.loose()
        cause = f"; nothing holds {', '.join(repr(name) for name in loose)}" if loose else ""
        raise SolveFailed(
            f"no static equilibrium after {iterations} iterations: {reason}; largest unbalanced force "
            f"{report.residual_force:.3g} N at {report.worst}{cause}",
            report,
        )
