"""Radiation memory as a state space: every entry of the kernel a sum of decaying exponentials.

    K_ij(tau) = sum_k Re r_k exp(p_k tau),    F_i = - sum_j sum_k Re y_k,    y_k' = p_k y_k + r_k v_j

Each state is advanced in closed form for a velocity that is linear over the step, whatever the step is:

    y(t + h) = e^x y + h (phi_1(x) - phi_2(x)) r v(t) + h phi_2(x) r v(t + h),      x = p h,
    phi_1 = (e^x - 1)/x,   phi_2 = (e^x - 1 - x)/x^2.

The exponentials are fitted to the database, not to the convolution's kernel, so that neither truncation nor
interpolation stands in between, by vector fitting (Gustavsen and Semlyen 1999, "Rational approximation of frequency
domain responses by vector fitting"; relaxed after Gustavsen 2006). It needs linear least squares only, keeps poles
stable by reflecting them, and the least squares of the residues take a linear constraint. What is fitted is the
transform of H', K = dH'/dtau (see radiation.py),

    G(i w) = A(w) - A_inf - i B(w)/w = sum_k rho_k/(i w - p_k),     sum_k rho_k = H'(0) = 0,     r_k = rho_k p_k.

The constraint makes int K = -sum rho_k = 0 exactly: a steady drift is not damped, and B(w) vanishes at w = 0.
Beyond the database's frequencies a fit is held against B of the diagonal falling below zero and of the others growing
above twice what they end with: a wrong A_inf would otherwise hide in a fast pole that feeds in energy.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from floatsim.errors import ModelError
from floatsim.hydro.radiation import RadiationResidual, entry_scales
from floatsim.jit import kernel

if TYPE_CHECKING:
    from floatsim.hydro.database import HydroDatabase

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

_ROUNDS = 8  # relocations of the poles
_MOST = 24  # entries that may miss the database: more would neither be good nor fast
_NOTHING = 0.1  # entries below this share of the error bar are zero
_CARE = 10.0  # how much closer than at its peak B is followed where it is small
_FAST = 3.0  # no pole is faster than this times the highest frequency
_BEYOND = np.geomspace(1.0, 30.0, 60)  # times the highest frequency: where the fit may not make up damping
_SNAP = 1e-9  # s: times this close are the same (sums of steps are inexact)


@dataclass(frozen=True, eq=False)
class StateSpace:
    """Exponentials of the radiation memory, fitted per entry. Frozen, arrays read-only; d = 6 per body, m exponentials.

    dofs        d
    entries     (e, 4) int: row i, column j, first exponential, one past the last
    poles       (m,) complex, rad/s, real parts negative; of a conjugate pair only the one above the axis
    residues    (m,) complex, r of K = sum Re r exp(p tau), N/m (N, N m)
    order       (d, d) int, real states of every entry, 0 where it vanishes
    residual    RadiationResidual: what the fit leaves of the database
    """

    dofs: int
    entries: NDArray[np.int64]
    poles: Complex
    residues: Complex
    order: NDArray[np.int64]
    residual: RadiationResidual

    @classmethod
    def from_database(cls, db: HydroDatabase, error: float = 0.003, order: int = 32) -> StateSpace:
        """Fit every entry of `db` with the fewest states whose largest error in A(w) and in B(w) is below `error`,
        relative as in RadiationResidual, and closer where B is small: at 1 % of its peak and below a tenth of that.
        Where `order` real states do not get there, the best of those tried is taken.

        Entries (i, j) and (j, i) that are equal within a tenth of the error share one fit of their mean, so that the
        memory is as symmetric as the physics. Raises ModelError if error is not positive or order below 2, or if the
        database is too rugged to be fitted.
        """
        if not (0.0 < error < np.inf and 2 <= order <= 100):
            raise ModelError(
                f"radiation state space of '{db.name}': error = {error}, order = {order}; the error must be positive "
                "(0.003 is usual) and the order 2 to 100"
            )
        w = db.omega
        A, B = db.added_mass - db.added_mass_inf, db.radiation_damping
        d = A.shape[1]
        scale_A, scale_B = entry_scales(db)
        entries, poles, residues = [], [], []
        count = missed = 0
        orders = np.zeros((d, d), dtype=np.int64)
        fits: dict[tuple[int, int], tuple[Complex, Complex]] = {}
        for i, j in np.ndindex(d, d):
            scales = float(scale_A[i, j]), float(scale_B[i, j])
            if _size(A[:, i, j], B[:, i, j], *scales) < _NOTHING * error:
                continue
            alike = _size(A[:, i, j] - A[:, j, i], B[:, i, j] - B[:, j, i], *scales) < _NOTHING * error
            if alike and (j, i) in fits:
                p, r = fits[j, i]
            elif alike:
                mean = 0.5 * (A[:, i, j] + A[:, j, i]), 0.5 * (B[:, i, j] + B[:, j, i])
                p, r = _fit(w, *mean, *scales, error, order, i == j)
            else:
                p, r = _fit(w, A[:, i, j], B[:, i, j], *scales, error, order, False)
            fits[i, j] = p, r
            entries.append((i, j, count, count + p.size))
            poles.append(p)
            residues.append(r)
            count += p.size
            orders[i, j] = p.size + np.count_nonzero(p.imag)
            G = 0.5 * _sum(1j * w, p, r / p)
            missed += _size(G.real - A[:, i, j], w * G.imag + B[:, i, j], *scales) > 3.0 * error
            if missed > _MOST:
                raise ModelError(
                    f"radiation state space of '{db.name}': with {order} states more than {_MOST} entries miss the "
                    f"database by more than {300.0 * error:.2g} % (sharp resonances of water between bodies, noise); "
                    "use radiation=\"convolution\" with a memory that lasts as long as they ring"
                )
        table = np.array(entries, dtype=np.int64).reshape(-1, 4)
        p = np.concatenate([np.zeros(0, dtype=complex), *poles])
        r = np.concatenate([np.zeros(0, dtype=complex), *residues])
        for item in (table, p, r, orders):
            item.flags.writeable = False
        transform = _transform(w, d, table, p, r)
        figures = (
            np.abs(transform.real - A).max(axis=0) / scale_A,
            np.abs(-w[:, None, None] * transform.imag - B).max(axis=0) / scale_B,
            (A - transform.real).mean(axis=0) / scale_A,
        )
        for figure in figures:
            figure.flags.writeable = False
        return cls(d, table, p, r, orders, RadiationResidual(*figures, bodies=tuple(getattr(db, "bodies", ()))))

    def added_mass_and_damping(self, omega: Array) -> tuple[Array, Array]:
        """A(w) - A_inf and B(w) of the fit, each (n, d, d), at omega (n,) rad/s, positive."""
        omega = np.asarray(omega, dtype=np.float64)
        G = _transform(omega, self.dofs, self.entries, self.poles, self.residues)
        return G.real, -omega[:, None, None] * G.imag

    def retardation(self, tau: Array) -> Array:
        """K (n, d, d) at lags tau (n,) s."""
        K = np.zeros((len(tau), self.dofs, self.dofs))
        for i, j, a, b in self.entries:
            K[:, i, j] = (np.exp(np.outer(tau, self.poles[a:b])) @ self.residues[a:b]).real
        return K

    def history(self, t0: float = 0.0) -> StateSpaceHistory:
        """A memory of the body at rest until t0."""
        return StateSpaceHistory(self, t0)

    def summary(self) -> str:
        """One line: what the fit leaves, and its size."""
        return f"{self.residual.summary()} (state space, {int(self.order.sum())} states)"


def _size(A: Array, B: Array, scale_A: float, scale_B: float) -> float:
    return float(max(np.abs(A).max() / scale_A, np.abs(B).max() / scale_B))


def _transform(w: Array, d: int, entries: NDArray[np.int64], p: Complex, r: Complex) -> Complex:
    """G (n, d, d) at the frequencies w, from the poles above the axis and residues r of K = sum Re r exp(p tau)."""
    G = np.zeros((w.size, d, d), dtype=np.complex128)
    for i, j, a, b in entries:
        G[:, i, j] = 0.5 * _sum(1j * w, p[a:b], r[a:b] / p[a:b])
    return G


def _sum(s: Any, p: Complex, rho: Complex) -> Complex:
    """sum rho/(s - p) + conj(rho)/(s - conj(p)), (len(s),)."""
    at = s[:, None]
    return np.asarray((rho / (at - p) + rho.conj() / (at - p.conj())).sum(axis=1))


# --- vector fitting of one entry ----------------------------------------------------------------


def _fit(w: Array, A: Array, B: Array, scale_A: float, scale_B: float, error: float, order: int,
         own: bool) -> tuple[Complex, Complex]:  # fmt: skip
    """Poles and residues (r of K, real poles once, pairs by their upper pole) of A(w) - A_inf and B(w), each (n,);
    own: of the diagonal, where B is not negative."""
    s = 1j * w / w[-1]
    g = A - 1j * B / w
    # slow floaters have their natural periods where B is a thousandth of its peak
    care = np.sqrt(np.abs(B).max() / np.maximum(np.abs(B), np.abs(B).max() / _CARE**2 + np.finfo(float).tiny))
    weight = np.concatenate([np.full(w.size, 1.0 / scale_A), care * w / scale_B])
    step = np.diff(w, prepend=0.0).max() / w[-1]
    end = np.abs(B[w > 0.9 * w[-1]]).max()
    best = (np.inf, np.zeros(0, dtype=complex), np.zeros(0, dtype=complex))
    for n in (*range(2, 13, 2), *range(16, order + 1, 4)):
        if n > min(order, w.size):
            break
        p = _first_poles(w, B, n)
        for _ in range(_ROUNDS):
            p = _relocated(s, g, weight, p, step)
            rho, size = _residues(s, g, weight, p)
            # G(i w) = sum rho/(i w - p): pairs twice, through their real coefficients
            tail = 0.5 * _sum(1j * _BEYOND, p, np.where(p.imag > 0.0, 2.0, 1.0) * rho)
            damping = -w[-1] * _BEYOND * tail.imag
            excess = -damping.min() if own else np.abs(damping).max() - 2.0 * end
            size = max(size, float(excess) / scale_B)
            if size < best[0]:
                best = (size, p, rho)
            if best[0] < error:
                break
        if best[0] < error:
            break
    _, p, rho = best
    half = np.where(p.imag > 0.0, 2.0, 1.0)  # a pair counts twice
    return p * w[-1], half * rho * p * w[-1] ** 2


def _first_poles(w: Array, B: Array, n: int) -> Complex:
    """n/2 lightly damped pairs spread over the frequencies that radiate (in units of the highest)."""
    loud = w[np.abs(B) > 0.02 * max(np.abs(B).max(), np.finfo(float).tiny)]
    low, high = (loud[0], loud[-1]) if loud.size else (w[0], w[-1])
    beta = np.linspace(low, max(high, 1.5 * low), n // 2) / w[-1]
    return np.asarray(beta * (-0.2 + 1.0j))


def _basis(s: Complex, p: Complex) -> Complex:
    """Partial fractions (len(s), n) with real coefficients: 1/(s - p) of real poles, two columns for a pair."""
    columns = []
    for pole in p:
        one, other = 1.0 / (s - pole), 1.0 / (s - pole.conjugate())
        columns += [one] if pole.imag == 0.0 else [one + other, 1j * (one - other)]
    return np.stack(columns, axis=1)


def _sum_free(p: Complex) -> Array:
    """Basis (n, n - 1) of the coefficients whose residues sum to zero."""
    total = np.array([value for pole in p for value in ((1.0,) if pole.imag == 0.0 else (2.0, 0.0))])
    return np.linalg.qr(total[:, None], mode="complete")[0][:, 1:]


def _split(values: Complex, weight: Array) -> Array:
    """Real and imaginary parts one under the other, weighted."""
    parts = np.concatenate([values.real, values.imag])
    return parts * (weight[:, None] if parts.ndim == 2 else weight)


def _least_squares(matrix: Array, right: Array) -> Array:
    from scipy.linalg import lstsq

    size = np.linalg.norm(matrix, axis=0)
    size[size == 0.0] = 1.0
    return np.asarray(lstsq(matrix / size, right, lapack_driver="gelsy", check_finite=False)[0] / size)


def _relocated(s: Complex, g: Complex, weight: Array, p: Complex, step: float) -> Complex:
    """New poles: the zeros of sigma = d + sum c/(s - p) in sum rho/(s - p) = sigma g, reflected if unstable."""
    basis = _basis(s, p)
    n = basis.shape[1]
    left = _split(basis @ _sum_free(p), weight)
    right = _split(-g[:, None] * np.column_stack([basis, np.ones(s.size)]), weight)
    # sigma must not vanish: its real part has the mean 1
    level = np.linalg.norm(_split(g, weight)) / s.size
    mean = level * np.concatenate([np.zeros(n - 1), basis.real.sum(axis=0), [s.size]])
    wanted = np.append(np.zeros(2 * s.size), level * s.size)
    answer = _least_squares(np.vstack([np.hstack([left, right]), mean]), wanted)
    c, d = answer[n - 1 : -1], answer[-1]
    if abs(d) < 1e-8:
        d = math.copysign(1e-8, d)
    matrix, k = np.zeros((n, n)), 0
    load = np.zeros(n)
    for pole in p:
        if pole.imag == 0.0:
            matrix[k, k], load[k], k = pole.real, 1.0, k + 1
        else:
            a, b = pole.real, pole.imag
            matrix[k : k + 2, k : k + 2], load[k], k = [[a, b], [-b, a]], 2.0, k + 2
    found = np.linalg.eigvals(matrix - np.outer(load, c / d))
    size = np.abs(found)
    real = np.abs(found.imag) < 1e-9 * size
    found = np.where(size > _FAST, found * (_FAST / np.maximum(size, _FAST)), found)
    # what decays more slowly than the spacing of the frequencies can show is not in the data
    found = -np.maximum(np.abs(found.real), 0.25 * step) + 1j * np.where(real, 0.0, found.imag)
    pairs = found[~real & (found.imag > 0.0)]
    return np.asarray(np.concatenate([np.sort(found[real].real) + 0.0j, np.sort_complex(pairs)]))


def _residues(s: Complex, g: Complex, weight: Array, p: Complex) -> tuple[Complex, float]:
    """Residues rho of sum zero at given poles (of a pair the upper one's) and the largest weighted error."""
    Z = _sum_free(p)
    basis = _basis(s, p)
    matrix = _split(basis @ Z, weight)
    c = Z @ _least_squares(matrix, _split(g, weight))
    error = float(np.abs(_split(basis @ c - g, weight)).max())
    rho, k = np.zeros(p.size, dtype=complex), 0
    for m, pole in enumerate(p):
        if pole.imag == 0.0:
            rho[m], k = c[k], k + 1
        else:
            rho[m], k = c[k] + 1j * c[k + 1], k + 2
    return rho, error


# --- in time --------------------------------------------------------------------------------------


class StateSpaceHistory:
    """States of the exponentials and the memory force they make, in two phases, as RadiationHistory does it.

    `prepare(t_new)` works out what the past contributes to the force at t_new; then `force(v_trial)` is
    `constant - tangent @ v_trial` for every Newton iteration, and only `commit(t_new, v_new)` writes what is saved.
    Before t0 the floater is at rest; a velocity at t0 other than zero is a jump.

    kernel      StateSpace
    t0, v0      s and (d,), time and velocity at the start
    constant    (d,) N, N m: set by `prepare`, the same array every time
    tangent     (d, d) N s/m ..: -dF/dv_trial, set by `prepare`, the same array every time
    """

    def __init__(self, kernel: StateSpace, t0: float = 0.0, v0: Array | None = None) -> None:
        d, m = kernel.dofs, kernel.poles.size
        self.kernel = kernel
        # all that is saved: real and imaginary parts of the states; t_n and v_n
        self.states: Array = np.zeros((2, m))
        self.last: Array = np.zeros(1 + d)
        self.last[0] = t0
        self.constant: Array = np.zeros(d)
        self.tangent: Array = np.zeros((d, d))
        self._modes = np.ascontiguousarray(
            [kernel.poles.real, kernel.poles.imag, kernel.residues.real, kernel.residues.imag], dtype=np.float64
        )
        self._entries = kernel.entries.copy()
        self._step = np.zeros((6, m))  # e^x, weights of v(t) and v(t + h): real and imaginary parts
        self._h = -1.0
        if v0 is not None:
            self.commit(t0, np.array(v0, dtype=np.float64))

    @property
    def time(self) -> float:
        """Time t_n of the last accepted velocity, s."""
        return float(self.last[0])

    def prepare(self, t_new: float) -> Array:
        """Constant part (d,) of the force at t_new >= t_n, a view; also sets `tangent`. Changes nothing that is saved.

        t_new = t_n gives the force at t_n itself, with a zero tangent. Raises ValueError if t_new < t_n.
        """
        h = self._lasting(t_new, "asked for")
        _prepare(self._entries, self._step, self.states, self.last, self.constant, self.tangent, h > 0.0)
        return self.constant

    def force(self, v_trial: Array) -> Array:
        """Memory force (d,) at the time last prepared, for the velocity v_trial (d,) there; N, N m."""
        return self.constant - self.tangent @ v_trial

    def commit(self, t_new: float, v_new: Array) -> None:
        """Accept the velocity v_new (d,) at t_new, after t_n or (replacing v_n) at it. ValueError if before."""
        h = self._lasting(t_new, "commit at")
        v = np.ascontiguousarray(v_new, dtype=np.float64)
        _commit(self._entries, self._step, self.states, self.last, max(t_new, self.time), v, h > 0.0)

    def _lasting(self, t_new: float, what: str) -> float:
        """Length of the step to t_new, its weights ready; 0 where t_new is t_n but for the round-off of a time."""
        h = t_new - self.time
        if h < -1e3 * _SNAP:
            raise ValueError(f"radiation memory: {what} t = {t_new} s, the history already ends at {self.time} s")
        if h <= _SNAP:
            return 0.0
        # steps that differ by round-off share their weights: 30 bits, whatever was prepared before
        mantissa, exponent = math.frexp(h)
        h = math.ldexp(round(math.ldexp(mantissa, 30)), exponent - 30)
        if h != self._h:
            _weights(self._modes, h, self._step)
            self._h = h
        return h

    def arrays(self) -> dict[str, Array]:
        """Copies of all that must be saved to go on from here: `states` and `last`."""
        return {"states": self.states.copy(), "last": self.last.copy()}

    def restore(self, arrays: dict[str, Array]) -> None:
        """Take over what `arrays()` gave, in place. Raises ValueError if it belongs to another state space's size."""
        for name, mine in (("states", self.states), ("last", self.last)):
            if arrays[name].shape != mine.shape:
                raise ValueError(
                    f"radiation memory: saved '{name}' has shape {arrays[name].shape}, this one needs {mine.shape}"
                )
            mine[...] = arrays[name]

    def copy(self) -> StateSpaceHistory:
        """Independent history with the same past (the fit is shared)."""
        other = StateSpaceHistory(self.kernel)
        other.restore({"states": self.states, "last": self.last})
        return other

    def __deepcopy__(self, memo: object) -> StateSpaceHistory:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self.kernel, self.arrays())


def _restored(kernel: StateSpace, arrays: dict[str, Array]) -> StateSpaceHistory:
    history = StateSpaceHistory(kernel)
    history.restore(arrays)
    return history


@kernel
def _weights(modes, h, step):  # type: ignore[no-untyped-def]
    """Per exponential e^x, h (phi_1 - phi_2) r and h phi_2 r; modes (4, m): p and r, real and imaginary parts."""
    for m in range(modes.shape[1]):
        x = complex(modes[0, m] * h, modes[1, m] * h)
        r = complex(modes[2, m] * h, modes[3, m] * h)
        e = cmath.exp(x)
        if abs(x) > 0.3:
            one = (e - 1.0) / x
            two = (one - 1.0) / x
        else:  # 13 terms of sum x^n/(n + 2)!, by Horner: exact in floating point
            two = complex(1.0, 0.0)
            for n in range(14, 2, -1):
                two = 1.0 + two * x / n
            two = 0.5 * two
            one = 1.0 + x * two
        a = (one - two) * r
        b = two * r
        step[0, m], step[1, m] = e.real, e.imag
        step[2, m], step[3, m] = a.real, a.imag
        step[4, m], step[5, m] = b.real, b.imag


@kernel
def _prepare(entries, step, y, last, constant, tangent, moving):  # type: ignore[no-untyped-def]
    """Constant part and tangent of the force after the step whose weights are `step`; at t_n itself if not moving."""
    for i in range(constant.shape[0]):
        constant[i] = 0.0
        for j in range(constant.shape[0]):
            tangent[i, j] = 0.0
    for e in range(entries.shape[0]):
        i, j = entries[e, 0], entries[e, 1]
        past = now = new = 0.0
        if moving:
            for m in range(entries[e, 2], entries[e, 3]):
                past += step[0, m] * y[0, m] - step[1, m] * y[1, m]
                now += step[2, m]
                new += step[4, m]
        else:
            for m in range(entries[e, 2], entries[e, 3]):
                past += y[0, m]
        constant[i] -= past + now * last[1 + j]
        tangent[i, j] = new


@kernel
def _commit(entries, step, y, last, t_new, v_new, moving):  # type: ignore[no-untyped-def]
    """Advance the states with the velocity linear from v_n to v_new; then t_n and v_n."""
    if moving:
        for e in range(entries.shape[0]):
            j = entries[e, 1]
            v, u = last[1 + j], v_new[j]
            for m in range(entries[e, 2], entries[e, 3]):
                re, im = y[0, m], y[1, m]
                y[0, m] = step[0, m] * re - step[1, m] * im + step[2, m] * v + step[4, m] * u
                y[1, m] = step[0, m] * im + step[1, m] * re + step[3, m] * v + step[5, m] * u
    last[0] = t_new
    for j in range(v_new.shape[0]):
        last[1 + j] = v_new[j]
