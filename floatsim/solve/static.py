"""Static equilibrium of the whole system from a crude shape.

Damped implicit steps with growing size: each solves

    (M/h^2 + K) dq + G^T dlam = -r,     G dq = -g

from rest, so that h small follows the path a body in thick oil would take and h large is Newton's
method (pseudo-transient continuation, Kelley & Keyes 1998). Steps are limited in length; h grows while
the residual falls and shrinks when a step would fold or explode something. Minutes of explicit
relaxation become some hundred factorisations.

Lines are so stiff that a step which turns an element by a tenth of a radian strains it by more than its weight ever
will. That strain is of second order and the next step takes it away, but the tension it makes for the moment would hold
the line sideways as if it were a rod. So the lateral stiffness T/l is taken with the tension that the linear step
expects instead of the one at its end (the mixed iteration of Magisano, Leonetti & Garcea 2017, Computer Methods in
Applied Mechanics and Engineering 313, which converges to the same equilibrium); and because the residual right after a
step says little, a step is taken back only if that explodes, and h is never made smaller after a step that hardly
turned anything.

From a crude shape lines start with EA capped at 25 times all loads on points, strains of some 2 %, and get it back in
steps. Compression along a straight line, and a line folded back on itself, *are* equilibria, only unstable ones: until
the shape has settled lines push with a small share of EA, and where a balance is folded they are shaken a little. That
does not find every unstable equilibrium (a vertical line a little longer than its span); `natural_modes` refuses
those, this solve does not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from floatsim.errors import CaseError, SolveFailed
from floatsim.frames import Array
from floatsim.solve.linear import LinearSolver
from floatsim.solve.step import kinematics, norms
from floatsim.system.state import State
from floatsim.system.system import System

TOLERANCE = 1e-8  # residual over the sum of forces at the same point
LOOSE, PATIENCE = 1e-6, 300  # what is enough after so many iterations: slack on the bed, barely in balance at all
OF_WEIGHT = 1e-7  # and then no more than this of all lines' weight: residuals are relative to rounding as well
SETTLED = 1e-3  # the same for a softened law
MAX_ITERATIONS = 1200  # for each of PUSHES
H_START, H_SMALLEST, H_LARGEST, H_SWITCH = 0.05, 1e-4, 1e6, 1.0  # s; the last: largest when the law changes
WORSE = 1e4  # growth of the unbalance at which a step is taken back
STALLED = 60  # iterations without a better balance after which h starts small again
PUSHES = (1e-3, 1e-1, 1e-2)  # share of EA in compression until the shape has settled; the next if one fails
CAP, CAP_GROWTH, CAP_STEPS = 25.0, 30.0, 6  # of EA, over all loads on points; its growth from step to step
BENT = 10.0  # of the cap, over the force at which an element bends by itself
TURN, CALM = 1.0, 0.1  # rad; most a step may turn an element of a line, and a step that is linear to all intents
NEAR, TRUST = 1e-2, 200  # residual (as TOLERANCE) at which the start is the equilibrium, nearly; iterations it is given
KICKS, KICK = 3, 0.02  # how often a folded balance is left; by this share of the elements' length


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
    Returns the state at rest and the report. Raises CaseError for bad input and SolveFailed naming the worst unknown
    and the likely cause if it does not converge.
    """
    _check_request(system, state, hold, friction)
    if state is not None:
        start = state.copy()
    else:
        start = system.initial_state()
        for batch in _slender(system):
            batch.let_out(start)
        system.forget(start)
        for k, batch in enumerate(system.batches):
            if hasattr(batch, "unused"):
                batch.unused(start.history[k])
    iterations = 0
    for push in (None, *PUSHES):
        singular = ""  # or why this attempt ended early; crushed lines make it singular, too
        relax = _Relaxation(system, start, hold, push, friction)
        if push is None and not friction and not relax.near():
            continue  # with friction there is a way from the old equilibrium, which a softer law would leave
        for _ in range(TRUST if push is None else MAX_ITERATIONS):
            iterations += 1
            relax.evaluate()
            if relax.balanced(iterations):
                if not relax.true_law and relax.work.trouble is None:
                    relax.stiffen()
                elif not relax.true_law or relax.polished():
                    if relax.work.trouble is None:
                        return relax.result(), relax.report(iterations, True)
                    if not relax.kick():
                        break
            elif relax.worse():
                relax.back()
            elif not relax.forward():
                singular = "the stiffness matrix is singular: something is free to drift"
                break
    return relax.fail(iterations, singular or relax.why())


def _check_request(system: Any, state: Any, hold: Any, friction: Any) -> None:
    """Raises CaseError for what is not of its kind."""
    wrong = None
    if not isinstance(system, System):
        wrong = f"system: got {system!r:.60}; must be a System made by assemble(model)"
    elif state is not None and not isinstance(state, State):
        wrong = f"state: got {state!r:.60}; must be a State, e.g. of solve_static, or None"
    elif not isinstance(hold, list | tuple | set):
        wrong = f"hold: got {hold!r:.60}; must be a list of names of parts"
    elif not isinstance(friction, bool | np.bool_):
        wrong = f"friction: got {friction!r:.60}; must be True or False"
    if wrong is not None:
        raise CaseError(f"solve_static: {wrong}")


def _slender(system: System) -> list[Any]:
    """Batches of lines (protocol: system/system.py)."""
    return [batch for batch in system.batches if hasattr(batch, "exchange_tension")]


class _Relaxation:
    """The state of a static solve: configuration, step size h, and the law that lines follow for the moment."""

    def __init__(self, system: System, start: State, hold: Sequence[str], push: float | None, friction: bool) -> None:
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
        self._lines = [(batch, np.zeros(len(batch.nodes))) for batch in _slender(system)]  # with expected tensions
        self._free = np.flatnonzero(np.repeat(system.free_points()[: system.n_point], 3))
        self._weight = float(sum(batch.weight_in_water() for batch, _ in self._lines))  # or what floats them [N]
        self._expected = False  # whether they are those of the last step
        self._kicks = 0
        w.c[:6] = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0)  # loads alone: no axial force yet
        w.lam[:] = 0.0
        system.evaluate(w)
        bends = max((batch.bending_force() for batch, _ in self._lines), default=0.0)
        self._soft = (push, max(CAP * max(float(np.abs(w.r[self._free]).sum()), 1e-9), BENT * bends))
        np.copyto(w.lam, start.lam)
        self._caps = 0
        w.c[4:6] = 1.0, np.inf
        if push is not None:
            self._soften()

    @property
    def true_law(self) -> bool:
        """Whether lines follow their own law by now."""
        return bool(self.work.c[4] == 1.0)

    def _soften(self) -> None:
        self.work.c[4:6] = self._soft
        self._caps, self._polished = CAP_STEPS, False

    def near(self) -> bool:
        """Whether the start is the equilibrium of the true law, nearly: a restart, or a good drawing."""
        self.evaluate()
        self.h = H_SWITCH
        balanced = self._norms[0] <= NEAR and self._largest() <= NEAR**2 * self._weight
        return bool(balanced and self._norms[2] <= 1e-6 * self.system.length)

    def evaluate(self) -> None:
        """Residual and matrix here."""
        w, sys = self.work, self.system
        w.c[:4] = (1.0 / self.h**2, 0.0, 1.0, self._size)
        sys.flow(w, w.x, w.t)  # a current may change with depth
        sys.evaluate(w)
        w.r[self._held] = 0.0
        for batch, T in self._lines if self._expected else ():
            batch.exchange_tension(w, T)
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
        if final == LOOSE and self.true_law and e[0] > TOLERANCE and self._largest() > OF_WEIGHT * self._weight:
            return False
        return bool(e[0] <= (final if self.true_law else SETTLED) and closed)

    def _largest(self) -> float:
        """Largest unbalanced force [N] at a point of a line or a point mass."""
        return float(np.abs(self.work.r[self._free]).max(initial=0.0))

    def stiffen(self) -> None:
        """One step from the softened law towards the true one."""
        c, self._expected = self.work.c, False
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
        self.h, self._before, self._expected = 0.2 * self.h, np.inf, False

    def forward(self) -> bool:
        """One limited step; h grows as the residual falls (switched evolution relaxation). False if singular.

        A step that hardly turns any element never makes h smaller: what it leaves unbalanced is axial, from lengths
        changed in second order, and gone with the next.
        """
        w, d, n_dof = self.work, self._d, self.system.n_dof
        if not np.isfinite(self._unbalance) or not self.linear.solve(w.A, w.r, d):
            if self.h <= H_SMALLEST:
                return False
            self.back()
            return True
        move = float(np.abs(d[self._points]).max(initial=0.0))
        turn = float(np.abs(d[self._turns]).max(initial=0.0))
        part = min(1.0, self._reach / max(move, 1e-300), 0.1 / max(turn, 1e-300))
        swing = max((batch.largest_turn(w, d) for batch, _ in self._lines), default=1.0)
        part = min(part, TURN / max(swing, 1e-300))
        for batch, T in self._lines:
            batch.expected_tension(w, d, part, T)
        self._expected = True
        for kept, value in zip(self._last, (w.x, w.q, w.lam), strict=True):
            np.copyto(kept, value)
        self._configure(part * d[:n_dof], self._last[0], self._last[1])
        w.lam += part * self._size * d[n_dof:]
        fall = self._before / max(self._unbalance, 1e-300)
        fall = min(max(fall, 0.5 if part * swing > CALM else 1.0), 2.0) if np.isfinite(fall) else 1.2
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

    def kick(self) -> bool:
        """Leave an unstable balance of lines: soft again, all nodes displaced a little; False if that was done enough.

        The displacements are drawn from a fixed seed: the same model gives the same result.
        """
        if self._kicks >= KICKS:
            return False
        self._kicks += 1
        draw = np.random.default_rng(self._kicks)
        size = np.zeros(self.system.n_point + 1)
        for batch, _ in self._lines:
            size[batch.nodes] = KICK * batch.lengths[:, None]
        y = np.zeros(self.system.n_dof)
        y[: 3 * len(size) - 3] = (size[:-1, None] * draw.standard_normal((len(size) - 1, 3))).ravel()
        y[self._held] = 0.0
        self._configure(y, self.work.x.copy(), self.work.q.copy())
        self._soften()
        self._before = self._best = np.inf
        self._stalled, self._expected, self.h = 0, False, H_START
        return True

    def why(self) -> str:
        """What kept it from its equilibrium, as far as that is known."""
        folded = self.work.trouble
        if folded is None:
            return "no convergence"
        if "folded" not in folded:
            return folded
        return f"{folded}: elements there are too long for the bend, shorten them (or set EI = 0 for a limp line)"

    def result(self) -> State:
        """The equilibrium as a state at rest; memories are fresh but for what cannot be undone and friction holds."""
        w, state = self.work, self.start
        for name in ("x", "q", "lam"):
            np.copyto(getattr(state, name), getattr(w, name))
        for name in ("v", "a", "aux"):
            getattr(state, name)[:] = 0.0
        state.step, state.pace = 0.0, (0.0, 0)
        before = state.history
        self.system.forget(state, before)
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
