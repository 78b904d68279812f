"""Radiation memory: the force of the waves that the floater itself has made.

    F(t) = - int_0^T K(tau) v(t - tau) dtau,        K(tau) = 2/pi int B(w) cos(w tau) dw

(Cummins 1962, "The impulse response function and ship motions"; Ogilvie 1964 for the integrals of A(w)
and B(w)). v is the velocity of the reference point and the angular velocity, in the horizontal frame at
the body's mean heading; F is the force and the moment about the reference point in the same frame. The
term of the added mass at infinite frequency is not part of F.

The integral is exact for a velocity that is linear between knots. With H'' = K, H(0) = H'(0) = 0,

    H(tau) = 2/pi int B(w) (1 - cos w tau)/w^2 dw,

integrating by parts twice leaves a sum over the knots at lags 0 = tau_0 < tau_1 < ...: the weight of the
velocity at knot i is (H_{i+1} - H_i)/(tau_{i+1} - tau_i) - (H_i - H_{i-1})/(tau_i - tau_{i-1}), and that of
the newest one is H(h)/h, h being the step. The knots are the trial velocity at t_n + h, the accepted one at
t_n, and the velocities on a uniform grid of spacing D, which has nothing to do with the step. Motion at w is
underestimated by (w D)^2/12, or (w h)^2/12 where the step is the longer: 0.05 % at 8 s with the default 0.1 s.

Truncation: at the end of the memory H' (the response to a unit displacement) is faded out by a cosine over
the last sixth, K following as its derivative. So int K = 0 stays exact and a steady drift is not damped;
cutting K itself leaves a spurious B(0), of either sign, that a slow surge decay would show.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from floatsim.errors import ModelError
from floatsim.jit import kernel

if TYPE_CHECKING:
    from floatsim.hydro.database import HydroDatabase

Array = NDArray[np.float64]

_FADE = 1.0 / 6.0  # share of the memory over which H' is faded out
_BLOCK = 10_000_000  # products of lags and frequencies worked on at a time
_CUT = 0.1  # share of the frequency range over which B is faded out at its upper end
_SNAP = 1e-5  # times this close to a knot, in kernel intervals, are on it (sums of steps are inexact)
_T0, _KNOT, _HEAD, _TN, _VN = 0, 1, 2, 3, 4  # positions in RadiationHistory.last
_DOFS = ("surge", "sway", "heave", "roll", "pitch", "yaw")


@dataclass(frozen=True, eq=False)
class RadiationResidual:
    """What the kernel gives back of the database it was made from, at the database's frequencies.

    added_mass          (d, d) largest |A_inf - 1/w int K sin(w tau) dtau - A(w)|
    damping             (d, d) largest |int K cos(w tau) dtau - B(w)|
    added_mass_inf      (d, d) mean over w of A(w) + 1/w int K sin(w tau) dtau, minus A_inf (signed)

    All relative: entry (i, j) divided by the geometric mean of the largest |A_ii| and |A_jj| (B likewise),
    and at least 1e-4 of the largest of its kind (of rotations also 1 % of the largest of translations times
    V^(2/3)), so that the noise of entries that vanish by symmetry does not count. Frequencies in the upper taper are
    left out. bodies: their names, for the summary.
    """

    added_mass: Array
    damping: Array
    added_mass_inf: Array
    bodies: tuple[str, ...] = ()

    def summary(self) -> str:
        """One line with the worst entry of each, in per cent."""
        parts = []
        for label, value in (
            ("A(w)", self.added_mass),
            ("B(w)", self.damping),
            ("A_inf", self.added_mass_inf),
        ):
            i, j = np.unravel_index(int(np.argmax(np.abs(value))), value.shape)
            parts.append(f"{label} {100.0 * abs(value[i, j]):.2g} % ({self._dof(i)}-{self._dof(j)})")
        return "radiation memory against the database: " + ", ".join(parts)

    def _dof(self, i: int | np.integer) -> str:
        return f"{self.bodies[i // 6]} {_DOFS[i % 6]}" if len(self.bodies) > 1 else _DOFS[i % 6]


@dataclass(frozen=True, eq=False)
class RadiationKernel:
    """Tabulated kernel of the radiation memory. Frozen, arrays read-only; d = 6 per body.

    grid        kernel interval D, s
    K           (N + 1, d, d) retardation function at lags 0, D, .., N D, N/m (N, N m)
    H           (N + 1, d, d) its double integral, N s2/m (..); constant beyond the memory N D
    near        (N + 1, 2, d, d) H and H' side by side, for the few lags off the grid
    weights     (d/6, (N + 1) d, 6) second differences of H over D, the weights of the knots on the grid
    residual    RadiationResidual
    """

    grid: float
    K: Array
    H: Array
    near: Array
    weights: Array
    residual: RadiationResidual

    @property
    def memory(self) -> float:
        """Length of the memory N D, s."""
        return self.grid * (self.K.shape[0] - 1)

    def history(self, t0: float = 0.0) -> RadiationHistory:
        """A memory of the body at rest until t0."""
        return RadiationHistory(self, t0)

    def summary(self) -> str:
        """One line: what the memory gives back, and its length."""
        return f"{self.residual.summary()} ({self.memory:g} s of memory)"

    @classmethod
    def from_database(cls, db: HydroDatabase, memory: float = 60.0, grid: float = 0.1) -> RadiationKernel:
        """Kernel of `db` with `memory` s of history (rounded up to whole intervals) and interval `grid` s.

        Between the database's frequencies B is a cubic spline, through B(0) = 0, and a cosine takes it to zero over
        the last tenth of the range. Look at `residual` for what this and the truncation cost.
        Raises ModelError if memory or grid is not positive or the memory is shorter than twelve intervals.
        """
        if not (0.0 < grid < np.inf and 12.0 * grid <= memory < np.inf):
            raise ModelError(
                f"radiation memory of '{db.name}': memory = {memory} s with grid = {grid} s; both must be positive and "
                "finite, the memory at least 12 intervals (60 s and 0.1 to 0.2 s are usual)"
            )
        n = int(np.ceil(memory / grid - _SNAP))
        d = db.added_mass_inf.shape[0]
        fine = grid / 4.0
        tau = fine * np.arange(4 * n + 1, dtype=np.float64)
        K, dH, H = _transforms(db.omega, db.radiation_damping, tau)

        start = (1.0 - _FADE) * n * grid
        phase = np.pi * np.clip((tau - start) / (n * grid - start), 0.0, 1.0)
        window = (0.5 * (1.0 + np.cos(phase)))[:, None, None]
        slope = (-0.5 * np.pi / (n * grid - start) * np.sin(phase))[:, None, None]
        K = K * window + dH * slope
        dH = dH * window
        # Simpson over each kernel interval carries H on through the faded part
        pieces = fine / 3.0 * (dH[:-1:4] + 4.0 * dH[1::4] + 2.0 * dH[2::4] + 4.0 * dH[3::4] + dH[4::4])
        first = int(start / grid)
        on_grid = H[::4].copy()
        on_grid[first + 1 :] = on_grid[first] + np.cumsum(pieces[first:], axis=0)
        residual = _residual(db, tau, K)

        extended = np.concatenate([on_grid[1:2], on_grid, on_grid[-1:]])  # even at zero, constant at the end
        second = (extended[2:] - 2.0 * extended[1:-1] + extended[:-2]) / grid
        # (lag, i, j) -> (block of six rows, lag and j, row in the block): six sums run side by side
        weights = second.transpose(0, 2, 1).reshape((n + 1) * d, d // 6, 6).transpose(1, 0, 2)
        near = np.stack([on_grid, dH[::4]], axis=1)
        tables = [np.ascontiguousarray(item) for item in (K[::4], on_grid, near, weights)]
        for table in tables:
            table.flags.writeable = False
        return cls(float(grid), tables[0], tables[1], tables[2], tables[3], residual)


def entry_scales(db: HydroDatabase) -> tuple[Array, Array]:
    """What the errors of entries (i, j) of A and of B are measured by, (d, d) each."""
    size = np.ravel(getattr(db, "volume", 0.0)).max() ** (1.0 / 3.0)  # rotations about the centre of a sphere are none
    scales = []
    for values in (db.added_mass, db.radiation_damping):
        largest = np.sqrt(np.abs(np.diagonal(values, axis1=1, axis2=2)).max(axis=0))
        turning = (np.arange(largest.size) // 3 % 2).astype(bool)
        floor = 0.01 * largest[~turning].max(), max(0.01 * largest[turning].max(), 0.1 * size * largest[~turning].max())
        largest = np.maximum(largest, np.where(turning, floor[1], floor[0]) + np.finfo(float).tiny ** 0.25)
        scales.append(np.outer(largest, largest))
    return scales[0], scales[1]


def _transforms(omega: Array, B: Array, tau: Array) -> tuple[Array, Array, Array]:
    """K, H' and H at the lags tau, each (len(tau), d, d), from B (n, d, d) at omega (n,)."""
    from scipy.interpolate import CubicSpline

    cut = omega[-1]
    # the trapezoidal sum repeats K after 2 pi / d_omega: eight memories away, or 600 s
    count = int(np.ceil(cut / min(0.01, 2.0 * np.pi / (8.0 * tau[-1])))) + 1
    w = np.linspace(0.0, cut, count)
    zero = np.zeros((1,) + B.shape[1:])
    fine = CubicSpline(np.concatenate([[0.0], omega]), np.concatenate([zero, B]))(w)
    fade = 0.5 * (1.0 + np.cos(np.pi * np.clip((w / cut - 1.0 + _CUT) / _CUT, 0.0, 1.0)))
    weighted = (2.0 / np.pi * w[1] * fade)[1:, None] * fine.reshape(count, -1)[1:]  # B(0) = 0: no end term
    w = w[1:]
    parts = []
    for lags in np.array_split(tau, 1 + tau.size * w.size // _BLOCK):
        phase = np.outer(lags, w)
        parts.append((np.cos(phase) @ weighted, np.sin(phase) @ (weighted / w[:, None]),
                      2.0 * np.sin(0.5 * phase) ** 2 @ (weighted / w[:, None] ** 2)))  # fmt: skip
    K, dH, H = (np.concatenate(part).reshape((tau.size,) + B.shape[1:]) for part in zip(*parts, strict=True))
    return K, dH, H


def _residual(db: HydroDatabase, tau: Array, K: Array) -> RadiationResidual:
    """Compare the transforms of K (Simpson on the fine lags, an even number of intervals) with the database."""
    w = db.omega[db.omega <= (1.0 - _CUT) * db.omega[-1]]
    A, B = db.added_mass[: w.size], db.radiation_damping[: w.size]
    simpson = np.full(tau.size, 2.0)
    simpson[1::2] = 4.0
    simpson[[0, -1]] = 1.0
    simpson *= tau[1] / 3.0
    phase = np.outer(w, tau)
    flat = K.reshape(tau.size, -1)
    memory = ((np.sin(phase) * simpson / w[:, None]) @ flat).reshape(A.shape)
    damping = ((np.cos(phase) * simpson) @ flat).reshape(B.shape)

    scale_A, scale_B = entry_scales(db)
    figures = (
        np.abs(db.added_mass_inf - memory - A).max(axis=0) / scale_A,
        np.abs(damping - B).max(axis=0) / scale_B,
        ((A + memory).mean(axis=0) - db.added_mass_inf) / scale_A,
    )
    for figure in figures:
        figure.flags.writeable = False
    return RadiationResidual(*figures, bodies=tuple(getattr(db, "bodies", ())))


class RadiationHistory:
    """Velocity history of one floater and the memory force it makes, in two phases.

    `prepare(t_new)` works out what the past contributes to the force at t_new; then `force(v_trial)` is
    `constant - tangent @ v_trial` for every Newton iteration, and only `commit(t_new, v_new)` writes what is saved.
    A step that is rejected leaves the history bit-identical.

    Before t0 the floater is at rest (a velocity at t0 other than zero has risen over one kernel interval).

    kernel      RadiationKernel
    t0          s, start of the history and origin of its grid
    v0          (d,) velocity at t0, default zero
    constant    (d,) N, N m: set by `prepare`, the same array every time
    tangent     (d, d) N s/m ..: -dF/dv_trial, set by `prepare`, the same array every time
    """

    def __init__(self, kernel: RadiationKernel, t0: float = 0.0, v0: Array | None = None) -> None:
        n, d = kernel.K.shape[:2]  # n knots on the grid have a weight, one more is looked at between lags
        self.kernel = kernel
        self._near = kernel.near
        self._weights = kernel.weights
        self._grid = kernel.grid
        # all that is saved: knot velocities, newest first from the head on, kept twice so that
        # every window of knots is contiguous; and t0, knot number, head, t_n, v_n
        self.ring: Array = np.zeros((2 * (n + 1), d))
        self._flat = self.ring.reshape(-1)
        self.last: Array = np.zeros(_VN + d)
        self.last[_T0] = self.last[_TN] = t0
        self.constant: Array = np.zeros(d)
        self.tangent: Array = np.zeros((d, d))
        self._blend: Array = np.zeros(n * d)
        if v0 is not None:
            self.commit(t0, np.array(v0, dtype=np.float64))

    @property
    def time(self) -> float:
        """Time t_n of the last accepted velocity, s."""
        return float(self.last[_TN])

    def prepare(self, t_new: float) -> Array:
        """Constant part (d,) of the force at t_new >= t_n, a view; also sets `tangent`. Changes nothing that is saved.

        t_new = t_n gives the force at t_n itself, with a zero tangent. Raises ValueError if t_new < t_n.
        """
        t_new = self._not_before(t_new, "asked for")
        _prepare(
            self._weights,
            self._near,
            self._flat,
            self.last,
            self._blend,
            self.constant,
            self.tangent,
            self._grid,
            t_new,
        )
        return self.constant

    def _not_before(self, t_new: float, what: str) -> float:
        """t_new, or t_n where t_new is earlier by the round-off of a time that was summed up another way."""
        if t_new < self.time - _SNAP * self._grid:
            raise ValueError(f"radiation memory: {what} t = {t_new} s, the history already ends at {self.time} s")
        return max(t_new, self.time)

    def force(self, v_trial: Array) -> Array:
        """Memory force (d,) at the time last prepared, for the velocity v_trial (d,) there; N, N m."""
        return self.constant - self.tangent @ v_trial

    def commit(self, t_new: float, v_new: Array) -> None:
        """Accept the velocity v_new (d,) at t_new, after t_n or (replacing v_n) at it. ValueError if before."""
        t_new = self._not_before(t_new, "commit at")
        _commit(self.ring, self.last, self._grid, t_new, np.ascontiguousarray(v_new, dtype=np.float64))

    def arrays(self) -> dict[str, Array]:
        """Copies of all that must be saved to go on from here: `ring` and `last`."""
        return {"ring": self.ring.copy(), "last": self.last.copy()}

    def restore(self, arrays: dict[str, Array]) -> None:
        """Take over what `arrays()` gave, in place. Raises ValueError if it belongs to another kernel's size."""
        for name, mine in (("ring", self.ring), ("last", self.last)):
            if arrays[name].shape != mine.shape:
                raise ValueError(
                    f"radiation memory: saved '{name}' has shape {arrays[name].shape}, this kernel needs {mine.shape}"
                )
            mine[...] = arrays[name]

    def copy(self) -> RadiationHistory:
        """Independent history with the same past (the kernel is shared)."""
        other = RadiationHistory(self.kernel)
        other.restore({"ring": self.ring, "last": self.last})
        return other

    def __deepcopy__(self, memo: object) -> RadiationHistory:
        """As `copy`: copying attribute by attribute would part the ring from its flat view."""
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickling, for the same reason: kernel and saved arrays, put together again."""
        return _restored, (self.kernel, self.arrays())


def _restored(kernel: RadiationKernel, arrays: dict[str, Array]) -> RadiationHistory:
    history = RadiationHistory(kernel)
    history.restore(arrays)
    return history


@kernel
def _near_value(near, grid, lag, i, j):  # type: ignore[no-untyped-def]
    """H_ij at any lag: cubic Hermite between grid lags, constant beyond the memory."""
    n = near.shape[0] - 1
    x = lag / grid
    k = int(x)
    if k >= n:
        return near[n, 0, i, j]
    x -= k
    y = 1.0 - x
    return (
        y * y * (1.0 + 2.0 * x) * near[k, 0, i, j]
        + x * x * (1.0 + 2.0 * y) * near[k + 1, 0, i, j]
        + grid * x * y * (y * near[k, 1, i, j] - x * near[k + 1, 1, i, j])
    )


@kernel
def _prepare(weights, near, ring, last, blend, constant, tangent, grid, t_new):  # type: ignore[no-untyped-def]
    """Constant part and tangent of the force at t_new; lags and knots as in the module's docstring."""
    d = constant.size
    n = near.shape[0] - 1
    head = int(last[2])
    h = t_new - last[3]
    s = t_new - (last[0] + grid * last[1])  # lag of the newest knot on the grid
    p = int(s / grid + 1e-5)
    shift = s / grid - p
    if abs(shift) < 1e-5:
        shift = 0.0
        s = p * grid
    on_knot = abs(s - h) < 1e-5 * grid  # t_n is that knot
    if on_knot:
        h = s
    at_end = h < 1e-9 * grid  # no trial interval: the force at t_n itself

    # knots 1, 2, .. of the grid, where the weight is a second difference at lag s + k D
    if shift == 0.0:
        _product(weights, ring, (head + 1) * d, (p + 1) * d, (n - p) * d, constant)
    else:
        _blended(ring, head * d, d, n - p, shift, blend)
        _product(weights, blend, 0, p * d, (n - p + 1) * d, constant)

    # the three newest: trial velocity (tangent), v_n, and knot 0 of the grid
    for i in range(d):
        total = constant[i]
        for j in range(d):
            H_s = _near_value(near, grid, s, i, j)
            H_h = H_s if on_knot else _near_value(near, grid, h, i, j)
            g1 = 0.0 if at_end else H_h / h
            g3 = (_near_value(near, grid, s + grid, i, j) - H_s) / grid
            v_n = last[4 + j]
            if on_knot:
                total += (g3 - g1) * v_n
            else:
                g2 = (H_s - H_h) / (s - h)
                total += (g2 - g1) * v_n + (g3 - g2) * ring[head * d + j]
            tangent[i, j] = g1
        constant[i] = -total


@kernel
def _product(weights, u, at, first, count, out):  # type: ignore[no-untyped-def]
    """out = sum over `count` entries of weights[.., first + k, :] u[at + k]: six independent sums per block."""
    for block in range(weights.shape[0]):
        f0 = f1 = f2 = f3 = f4 = f5 = 0.0
        for k in range(count):
            x = u[at + k]
            f0 += weights[block, first + k, 0] * x
            f1 += weights[block, first + k, 1] * x
            f2 += weights[block, first + k, 2] * x
            f3 += weights[block, first + k, 3] * x
            f4 += weights[block, first + k, 4] * x
            f5 += weights[block, first + k, 5] * x
        out[6 * block] = f0
        out[6 * block + 1] = f1
        out[6 * block + 2] = f2
        out[6 * block + 3] = f3
        out[6 * block + 4] = f4
        out[6 * block + 5] = f5


@kernel
def _blended(u, at, d, lags, shift, out):  # type: ignore[no-untyped-def]
    """History seen from between two grid lags: 4-point Lagrange in the shift (0..1), knot 0 left out.

    Interpolating the weights at a shifted lag is the same as spreading every velocity over four lags of the grid,
    which makes one product of four. out[m d + j], m = 0 .. lags, sums knots m + 1, m, m - 1, m - 2.
    """
    x = shift
    b0 = -x * (x - 1.0) * (x - 2.0) / 6.0
    b1 = (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0
    b2 = -(x + 1.0) * x * (x - 2.0) / 2.0
    b3 = (x + 1.0) * x * (x - 1.0) / 6.0
    for m in range(min(3, lags + 1)):
        for j in range(d):
            k = at + m * d + j
            value = b0 * u[k + d]
            if m >= 1:
                value += b1 * u[k]
            if m >= 2:
                value += b2 * u[k - d]
            out[m * d + j] = value
    start = at + 3 * d
    for k in range((lags - 2) * d):
        out[3 * d + k] = b0 * u[start + k + d] + b1 * u[start + k] + b2 * u[start + k - d] + b3 * u[start + k - 2 * d]


@kernel
def _commit(ring, last, grid, t_new, v_new):  # type: ignore[no-untyped-def]
    """Write the knots passed between t_n and t_new (linear between), then t_n and v_n."""
    d = ring.shape[1]
    length = ring.shape[0] // 2
    head = int(last[2])
    h = t_new - last[3]
    if h < 1e-9 * grid and abs(last[3] - (last[0] + grid * last[1])) < 1e-5 * grid:
        for j in range(d):  # a new velocity at t_n, which is a knot
            ring[head, j] = v_new[j]
            ring[head + length, j] = v_new[j]
    knot = last[1] + 1.0
    while last[0] + grid * knot <= t_new + 1e-5 * grid:
        x = min((last[0] + grid * knot - last[3]) / h, 1.0)
        head = head - 1 if head > 0 else length - 1
        for j in range(d):
            value = last[4 + j] + x * (v_new[j] - last[4 + j])
            ring[head, j] = value
            ring[head + length, j] = value
        knot += 1.0
    last[1] = knot - 1.0
    last[2] = head
    last[3] = t_new
    for j in range(d):
        last[4 + j] = v_new[j]
