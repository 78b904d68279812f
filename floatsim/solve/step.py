"""One implicit step with Newton iterations.

The unknown is the increment dq of the step (for rotations a spatial rotation vector), so that the
Newton matrix is S = cM M + cC C + cK K with cM = (1 - am)/((1 - af) beta h^2), cC = gamma/(beta h),
cK = 1, bordered by the constraints. Left out of it on purpose: the tangent of the exponential map, a
relative error |dq|/2 of the rotations' columns in K and G. It costs iterations only in steps that turn a body
far: 4 in all at 0.1 rad, 6 at 0.3, 8 at 0.5; beyond that steps are cut.

A step is converged when three things hold: at every point and rotation the residual is below `tolerance` times
the sum of the forces that meet there, every constraint is closed to 1e-9 of the model's length, and the last
increment's largest translation and rotation were small against the step's. The last residual is foreseen
instead of evaluated where Newton's quadratic convergence leaves no doubt, ten times r_k^2 max(1, C) below the
tolerance, and no part keeps something from the last evaluation (`remembers`); C = r_k/r_{k-1}^2 is the last that was
seen, in this step or in one of the TRUSTED steps before. A step that does not get there
is a value with a reason, never a result.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from floatsim.description import is_number
from floatsim.errors import CaseError, SolveFailed
from floatsim.frames import Array, set_matrix, turn_quaternion
from floatsim.jit import kernel
from floatsim.solve.linear import LinearSolver
from floatsim.solve.scheme import Scheme, generalised_alpha
from floatsim.system.state import State, Work
from floatsim.system.system import System

MAX_ITERATIONS = 12
TOLERANCE = 2.5e-5  # of the forces that meet at a point; what implicit line codes stop at, too
FINEST = 1e-8  # the tolerance that rounding errors allow, `Work.c[8]`
TRUSTED = 10  # steps that may go by without a look at Newton's convergence
UNDAMPED = 0.95  # spectral radius above which position-level multipliers blow up sooner or later


@dataclass(frozen=True)
class StepReport:
    """How a step went: converged, Newton iterations (factorisations), size [s], and why not."""

    converged: bool
    iterations: int
    step: float
    residual: float
    reason: str = ""
    error: float = 0.0  # local error over what is allowed, if it is controlled


@kernel
def kinematics(y, k, x0, q0, v0, a0, aux0, x, q, R, v, a, aux):  # type: ignore[no-untyped-def]
    """Configuration, velocities and accelerations from the increment y. k: h, beta, gamma, am, af."""
    h, beta, gamma, am, af = k[0], k[1], k[2], k[3], k[4]
    for i in range(v.shape[0]):
        an = aux0[i]
        new = (y[i] - h * v0[i]) / (h * h * beta) - (0.5 / beta - 1.0) * an
        aux[i] = new
        v[i] = v0[i] + h * ((1.0 - gamma) * an + gamma * new)
        a[i] = ((1.0 - am) * new + am * an - af * a0[i]) / (1.0 - af)
    n = x.shape[0]
    for p in range(n - 1):
        for m in range(3):
            x[p, m] = x0[p, m] + y[3 * p + m]
    for r in range(q.shape[0] - 1):
        b = 3 * n + 3 * r
        turned = turn_quaternion((y[b], y[b + 1], y[b + 2]), (q0[r, 0], q0[r, 1], q0[r, 2], q0[r, 3]))
        for m in range(4):
            q[r, m] = turned[m]
        set_matrix(R, r, turned)


@kernel
def predict(y, k, v0, a0, aux0):  # type: ignore[no-untyped-def]
    """Increment for an unchanged true acceleration."""
    h, beta, am = k[0], k[1], k[3]
    for i in range(v0.shape[0]):
        new = (a0[i] - am * aux0[i]) / (1.0 - am)
        y[i] = h * v0[i] + h * h * ((0.5 - beta) * aux0[i] + beta * new)


@kernel
def norms(r, s, n_point, n_dof, cG, out):  # type: ignore[no-untyped-def]
    """out: largest residual over its forces' sum, its index, largest constraint gap, its index. Without the
    ground, which is the last point and the last rotation."""
    top = 0.0
    for i in range(s.shape[0]):
        top = max(top, s[i])
    floor = 1e-9 * top + 1e-300
    out[0] = out[1] = out[2] = out[3] = 0.0
    for i in range(s.shape[0] - 1):
        if i == n_point:
            continue
        for m in range(3):
            e = abs(r[3 * i + m]) / (s[i] + floor)
            if not e <= out[0]:
                out[0], out[1] = e, 3 * i + m
    for i in range(n_dof, r.shape[0]):
        e = abs(r[i]) / cG
        if not e <= out[2]:
            out[2], out[3] = e, i


@kernel
def advance(d, y, lam, cG, n_point, out):  # type: ignore[no-untyped-def]
    """Take d into the increment y and the multipliers; out: largest |d| and |y| of points, of rotations."""
    for m in range(4):
        out[m] = 0.0
    n = y.shape[0]
    for i in range(n):
        y[i] += d[i]
        k = 0 if i < 3 * n_point else 2
        out[k] = max(out[k], abs(d[i]))
        out[k + 1] = max(out[k + 1], abs(y[i]))
    for i in range(lam.shape[0]):
        lam[i] += cG * d[n + i]


class Stepper:
    """Steps a state in place; everything is allocated once. Histories are two-phase."""

    def __init__(self, system: System, scheme: Scheme | None = None, tolerance: float = TOLERANCE) -> None:
        self.system = system
        self.scheme = scheme or generalised_alpha()
        self.tolerance = tolerance
        if system.n_con and self.scheme.rho_inf > UNDAMPED:
            raise CaseError(
                f"scheme {self.scheme.name} has a spectral radius of {self.scheme.rho_inf:g} at high frequency and the "
                f"model has joints: multipliers would oscillate and diverge; use rho_inf of at most {UNDAMPED:g}, "
                "e.g. generalised_alpha(0.9)"
            )
        self.work: Work = system.work()
        self.work.c[8] = min(1.0, FINEST / max(tolerance, 1e-300))
        self.linear = LinearSolver(system.layout)
        self._y = np.zeros(system.n_dof)
        self._d = np.zeros(system.n)
        self._k = np.zeros(5)
        self._norms = np.zeros(4)
        self._largest = np.zeros(4)
        self._expected = 2  # iterations of a step
        self._curve, self._unseen = 1.0, TRUSTED  # C = r_k/r_{k-1}^2 as last seen, and steps since
        self._scaled_for = 0.0
        self.watch: Any = None  # looks at every accepted step before it is committed: study/energy.py

    # -- checkpoints --------------------------------------------------------------------------

    def arrays(self) -> dict[str, Any]:
        """What the next step depends on besides the state: what was seen of Newton's convergence, and the weights with
        the scale of the constraint rows."""
        return {"expected": self._expected, "curve": float(self._curve), "unseen": self._unseen,
                "scaled_for": self._scaled_for, "weights": self.work.c.copy()}  # fmt: skip

    def restore(self, arrays: dict[str, Any]) -> None:
        """Go on as the stepper that gave `arrays` would have."""
        self._expected, self._curve, self._unseen = arrays["expected"], arrays["curve"], arrays["unseen"]
        self._scaled_for = arrays["scaled_for"]
        self.work.c[:] = arrays["weights"]

    # -- one step -----------------------------------------------------------------------------

    def step(self, state: State, h: float, control: float | None = None) -> StepReport:
        """Advance `state` by h in place if the step converges; leave it where it is if not.

        A state never stepped, or one in which a line just broke (step 0) or a lock engages or releases, gets consistent
        velocities and accelerations first.
        control: the local error that is allowed, over what batches think right (1; inf only measures it); None: not
        looked at.
        """
        w, sys, sch = self.work, self.system, self.scheme
        if sys.switch(state) or state.step == 0.0:
            self.start(state, h)
            if self.watch is not None:
                self.watch.afresh(w, state)
        if state.step != h:
            # aux belongs to t + (am - af) h: move it along the true acceleration's slope. What velocities
            # leave open of the constraints goes with h^2 (see `start`); left alone, a multiplier errs by O(h)
            aux0 = state.a + (h / state.step) * (state.aux - state.a)
            v0 = state.v - (1.0 - (h / state.step) ** 2) * self._normal_part(state, state.v, 1.0)[0]
        else:
            aux0, v0 = state.aux, state.v
        k = self._k
        k[:] = (h, sch.beta, sch.gamma, sch.alpha_m, sch.alpha_f)
        y = self._y
        predict(y, k, v0, state.a, aux0)
        np.copyto(w.lam, state.lam)
        w.still = False
        self._weights(h)
        sys.begin(w, state, state.t + h)
        report = self._newton(state, h, v0, aux0)
        if report.converged and control is not None:
            error = sys.error(w, state)
            good = error <= control
            why = "" if good else f"the step is too long to follow the tension: local error {error:.2g} of the allowed"
            report = StepReport(good, report.iterations, h, report.residual, why, error)
        w.controlled = control is not None
        if report.converged:
            if self.watch is not None:
                self.watch.step(w)
            sys.commit(w, state)
            state.t += h
            for name in ("x", "q", "v", "a", "aux", "lam"):
                np.copyto(getattr(state, name), getattr(w, name))
            state.step = h
            if w.event:  # something broke: accelerations jump, and the next step starts afresh
                w.event, state.step = False, 0.0
        return report

    def _newton(self, state: State, h: float, v0: Array, aux0: Array) -> StepReport:
        w, sys, n, big = self.work, self.system, self._norms, self._largest
        y, d = self._y, self._d
        n_dof, length = sys.n_dof, sys.length
        increment_ok, before, foresee = False, np.inf, not sys.remembers
        for iteration in range(MAX_ITERATIONS + 1):
            kinematics(y, self._k, state.x, state.q, v0, state.a, aux0, w.x, w.q, w.R, w.v, w.a, w.aux)
            # where the last step was done this one will be, too: the residual alone is half the work
            w.c[6] = 0.0 if iteration == self._expected and iteration > 0 else 1.0
            sys.evaluate(w)
            if self._scaled_for != h:
                self._scale_constraints(h)
                sys.evaluate(w)
            norms(w.r, w.s, sys.n_point, n_dof, w.c[3], n)
            if iteration > 0 and n[0] < 1e15:
                self._curve, self._unseen = n[0] / max(before, 1e-30) ** 2, 0
            if n[0] <= self.tolerance and n[2] <= 1e-9 * length and increment_ok and w.trouble is None:
                self._expected = max(iteration, 1)
                return StepReport(True, iteration, h, float(n[0]))
            if w.c[6] == 0.0:
                w.c[6] = 1.0
                sys.evaluate(w)
            if not n[0] < 1e15:
                return StepReport(False, iteration, h, float(n[0]), f"diverged at {sys.unknown_name(int(n[1]))}")
            if iteration == MAX_ITERATIONS:
                break
            if not self.linear.solve(w.A, w.r, d):
                return StepReport(False, iteration, h, float(n[0]), "singular Newton matrix")
            advance(d, y, w.lam, w.c[3], sys.n_point + 1, big)
            increment_ok = big[0] <= 0.02 * big[1] + 1e-7 * length and big[2] <= 0.02 * big[3] + 1e-7
            # Newton squares the residual: where that is certain to be enough, looking again costs more than it tells
            square = 10.0 * n[0] ** 2 * max(1.0, self._curve)
            sure = square <= self.tolerance and n[2] <= 1e-9 * length and self._unseen < TRUSTED
            if foresee and sure and increment_ok and w.trouble is None:
                kinematics(y, self._k, state.x, state.q, v0, state.a, aux0, w.x, w.q, w.R, w.v, w.a, w.aux)
                self._expected = 0
                self._unseen += 1
                return StepReport(True, iteration + 1, h, float(square))
            before = n[0]
        worst = int(n[1]) if n[0] > self.tolerance else int(n[3])
        reason = w.trouble or (
            f"no convergence in {MAX_ITERATIONS} Newton iterations: residual {n[0]:.1e} of the forces, joints open by "
            f"{n[2]:.1e} m; worst: {sys.unknown_name(worst)}"
        )
        return StepReport(False, MAX_ITERATIONS, h, float(n[0]), reason)

    def _weights(self, h: float) -> None:
        s, c = self.scheme, self.work.c
        c[0] = (1.0 - s.alpha_m) / ((1.0 - s.alpha_f) * s.beta * h * h)
        c[1] = s.gamma / (s.beta * h)
        c[2] = 1.0
        if c[3] == 0.0:
            c[3] = 1.0

    def _scale_constraints(self, h: float) -> None:
        """Give constraint rows the size of the matrix they border (cG)."""
        lay, w = self.system.layout, self.work
        diagonal = np.abs(w.A[lay.slot[(lay.rows == lay.cols) & (lay.rows < self.system.n_dof)]])
        diagonal = diagonal[diagonal > 0.0]
        w.c[3] = float(np.median(diagonal)) if len(diagonal) else 1.0
        self._scaled_for = h

    # -- start --------------------------------------------------------------------------------

    def start(self, state: State, h: float) -> None:
        """Consistent velocities, accelerations and multipliers at state.t, and aux for step h.

        aux is the acceleration at t + (am - af) h; it is extrapolated from the consistent ones at t
        and at t - (am - af) h, because before t driven motions may not exist.

        Positions fulfil the constraint, so stepping with h leaves G v + dg/dt = C h^2 G v'' with
        C = 1/6 - (am - af)/2 - beta. Velocities start with that; from exact ones the multipliers would be
        off by O(h) until that has died away (Arnold, Bruls & Cardona 2015, Numerische Mathematik 129).

        Raises CaseError for joints that are open in the state: the first step would slam them shut.
        """
        self._require_closed(state)
        normal, lost = self._normal_part(state, state.v, 1.0)
        state.v -= normal
        self.system.struck(state, lost)
        state.a[:], state.lam[:] = self._acceleration(state, 0.0)
        shift = (self.scheme.alpha_f - self.scheme.alpha_m) * h
        state.aux[:] = state.a
        ahead = state.a if shift == 0.0 else self._acceleration(state, shift)[0]
        # moving on by velocity and acceleration is an explicit step: where elements are so stiff that h does not
        # resolve them (they need not be, the scheme damps them) it explodes and tells nothing
        size = max(np.abs(state.a).max(), self.system.model.gravity)
        if shift != 0.0 and np.abs(ahead - state.a).max() <= 2.0 * size:
            state.aux[:] = 2.0 * state.a - ahead
            sch = self.scheme
            share = 1.0 / 6.0 - 0.5 * (sch.alpha_m - sch.alpha_f) - sch.beta
            state.v += share * h * h * self._normal_part(state, (ahead - state.a) / shift, 0.0)[0]
        state.step = h

    def _require_closed(self, state: State) -> None:
        w, sys = self.work, self.system
        self._at(state, 0.0)
        w.lam[:] = 0.0  # what a lock held before it released is no gap
        w.c[:4] = (0.0, 0.0, 0.0, 1.0)
        w.c[6] = 1.0
        sys.evaluate(w)
        gap = np.abs(w.r[sys.n_dof :])
        if gap.max(initial=0.0) > 1e-6 * sys.length:
            worst = int(gap.argmax())
            raise CaseError(
                f"state: joint '{sys.row_name(worst)}' is open by {gap[worst]:.6g} m (or rad) at t = {state.t:g} s; "
                "bring its two sides together, e.g. by solve_static(system, state, hold=[...])"
            )

    def _at(self, state: State, s: float) -> None:
        """Load the state moved on by the time s with its velocity and acceleration."""
        w, sys = self.work, self.system
        sys.load(w, state)
        y = s * state.v + 0.5 * s * s * state.a
        w.v += s * state.a
        k = np.array([1.0, 0.25, 0.5, 0.0, 0.0])
        v = w.v.copy()
        kinematics(y, k, state.x, state.q, state.v, state.a, state.aux, w.x, w.q, w.R, w.v, w.a, w.aux)
        w.v[:] = v
        w.still = False
        sys.begin(w, state, state.t + s)

    def _acceleration(self, state: State, s: float) -> tuple[Array, Array]:
        """Consistent acceleration and multipliers at time t + s: [M G^T; G 0][a; lam] = [f; -gamma]."""
        w, sys = self.work, self.system
        self._at(state, s)
        w.a[:] = 0.0
        w.lam[:] = 0.0
        w.c[:4] = (1.0, 0.0, 0.0, 1.0)
        w.c[6] = 1.0
        sys.evaluate(w)
        self._scale_constraints(-1.0)
        sys.evaluate(w)
        _, gamma = sys.constraints.rates(w)
        w.r[sys.n_dof :] = w.c[3] * gamma
        d = np.zeros(sys.n)
        if not self.linear.solve(w.A, w.r, d):
            raise SolveFailed("no consistent accelerations: the mass matrix is singular (a part without mass?)")
        return d[: sys.n_dof].copy(), w.c[3] * d[sys.n_dof :]

    def _normal_part(self, state: State, y: Array, driven: float) -> tuple[Array, Array]:
        """The smallest d (in the mass norm) with G d = G y + driven dg/dt: what the constraints see of y; and
        1/2 d^T M d by constraint row, the energy [J] that taking d out of velocities takes."""
        w, sys = self.work, self.system
        if sys.n_con == 0:
            return np.zeros(sys.n_dof), np.zeros(0)
        sys.load(w, state)
        w.a[:] = 0.0
        w.lam[:] = 0.0
        sys.begin(w, state, state.t)
        w.c[:4] = (1.0, 0.0, 0.0, 1.0)
        w.c[6] = 1.0
        sys.evaluate(w)
        self._scale_constraints(-1.0)
        sys.evaluate(w)
        rate, _ = sys.constraints.rates(w)
        G = self.linear.matrix(w.A)[sys.n_dof :, : sys.n_dof]
        w.r[: sys.n_dof] = 0.0
        w.r[sys.n_dof :] = -(G @ y + driven * w.c[3] * rate)
        d = np.zeros(sys.n)
        if not self.linear.solve(w.A, w.r, d):
            raise SolveFailed("no consistent velocities: the mass matrix is singular (a part without mass?)")
        return d[: sys.n_dof], 0.5 * w.r[sys.n_dof :] * d[sys.n_dof :]


def step(
    system: System, state: State, dt: float, scheme: Scheme | None = None, tolerance: float = TOLERANCE
) -> tuple[State, StepReport]:
    """One step of size dt [s] by hand: the new state and how it went. `state` is not changed.

    The first step of a state that was never stepped finds consistent accelerations first. If the step
    does not converge the state comes back unchanged with `report.converged` False and a reason.
    Raises CaseError for a step that is not positive.
    """
    if not (is_number(dt) and dt > 0.0):
        raise CaseError(f"step: dt is {dt!r}; a positive number of seconds is allowed")
    stepper = Stepper(system, scheme, tolerance)
    new = state.copy()
    if new.step == 0.0:
        stepper.start(new, dt)
    report = stepper.step(new, dt)
    return (new if report.converged else state), report
