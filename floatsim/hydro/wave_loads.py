"""All loads of the waves on one floater: first order, drift, and where the floater is thought to be.

Either the floater stays at its drawing position (first-order theory; `slow` is None), or the waves meet it at its
slow pose, (x, y, yaw) behind the low-pass filter of slow_position.py: their phases are those at the slow position and
their headings those relative to the slow heading, and the loads act along its axes (a pose may keep yaw zero). As
functions of the slow yaw the loads are known at whole degrees and linear in between (they have no jumps), each degree
being made when it is first needed. A full QTF that knows one heading only is not turned: its force keeps size and
direction relative to the waves.

Statics contain the mean drift, and a run starts from there: so the ramp at the start, r(t), works on what
oscillates about the mean. The force is r X y + F_mean + r^2 (F_2 - F_mean).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from floatsim.errors import ModelError
from floatsim.hydro.drift import Drift, PairSum, SecondOrder, mean_drifts, newman
from floatsim.hydro.excitation import Excitation, at_headings, origin, transfer_functions
from floatsim.hydro.qtf import QTF
from floatsim.hydro.slow_position import CORNER, SlowPosition, peak_frequency
from floatsim.jit import kernel
from floatsim.sea.waves import Realisation, ramp_factor

if TYPE_CHECKING:
    from floatsim.hydro.database import HydroDatabase

Array = NDArray[np.float64]
T = TypeVar("T")

_ROUND = 360  # steps of the slow yaw in a turn
_STEP = math.radians(1.0)  # of the slow yaw, between headings at which the loads are made
_SAID = 1e-3  # of the waves' energy products: below, what a QTF leaves out is not worth a message


class WaveLoads:
    """First- and second-order wave loads of one floater in one sea.

    excitation  Excitation at the drawing position
    linear      whether that is all: first order, at the drawing position
    messages    what a user should hear: the share of the sea that a QTF does not know, forces counted twice
    """

    def __init__(
        self,
        db: HydroDatabase,
        sea: Realisation,
        position: ArrayLike = (0.0, 0.0),
        heading: float = 0.0,
        ramp: float = 0.0,
        *,
        body: int = 0,
        froude_krylov: bool = True,
        drift: Drift | tuple[Drift, ...] | None = None,
        slow_position: bool = False,
        turns: bool = True,
    ) -> None:
        """The reference point of `body` of `db` is drawn at `position` (x, y), m, and `heading`, rad.

        ramp           s, of the cosine ramp at the start
        froude_krylov  False: without the Froude-Krylov part of the excitation
        drift          "newman" (from the database's mean drift), a QTF, or several: difference and sum
        slow_position  whether `force` is to be asked at slow poses
        turns          whether these have a yaw: headings that lack for it are refused at once

        Raises ModelError for headings, frequencies and parts that the database or the QTF lack, for a full QTF in a
        short-crested sea, and for two drifts of one kind.
        """
        drifts = drift if isinstance(drift, tuple) else () if drift is None else (drift,)
        self.db, self.sea, self.body, self.heading, self.ramp = db, sea, body, heading, float(ramp)
        self.position = np.array(position, dtype=np.float64)[:2]
        self.slow_position = slow_position
        self.messages: tuple[str, ...] = ()
        _check(db, drifts, body)
        if drifts and not froude_krylov:
            self.messages += (
                "drift together with a hull counts part of the second-order force twice: the pressure on the hull in "
                "its instantaneous place, up to the instantaneous surface, has quadratic terms of its own",
            )
        place = (float(self.position[0]), float(self.position[1]))
        self.excitation = Excitation.from_database(
            db, sea, place, heading, ramp, body=body, froude_krylov=froude_krylov
        )
        self.linear = not drifts and not slow_position
        X, _ = transfer_functions(db, sea, body, froude_krylov)
        self._first = Turning(lambda psi: _packed(at_headings(db, X, sea.heading - heading - psi, sea.amplitude)))
        self._second: list[Turning[Any]] = [self._turning(item) for item in drifts]
        for item in self._second:
            left_out = item.at(0.0)[0].left_out
            if left_out > _SAID:
                self.messages += (item.label.format(100.0 * left_out),)
        k = sea.wave_number
        waves = [sea.amplitude, sea.omega, k * np.cos(sea.heading), k * np.sin(sea.heading), sea.phase]
        self._waves = np.ascontiguousarray(np.stack(waves, axis=1))
        self._y = np.empty((2, sea.omega.size))
        if slow_position and turns:
            for side in (-0.5 * _STEP, 0.5 * _STEP):  # headings that lack are said now
                for turning in (self._first, *self._second):
                    turning.at(side)

    def _turning(self, item: Drift) -> Turning[Any]:
        sea, heading = self.sea, self.heading
        if isinstance(item, QTF):
            text = (
                f"QTF '{item.name}' is known from {item.omega[0]:.3g} to {item.omega[-1]:.3g} rad/s: {{:.2g}} % of the "
                "products of the waves' energies lie outside, and their second-order force is taken as zero"
            )
            fixed = item.headings.size == 1
            return Turning(lambda psi: PairSum(item, sea, heading + psi), fixed, text)
        known = mean_drifts(self.db, sea, self.body)
        return Turning(lambda psi: newman(self.db, known, sea, heading + psi))

    def filter(self, t: float, pose: ArrayLike) -> SlowPosition:
        """Filter of a floater that has always been at `pose`: x, y [m], yaw from the drawing heading [rad]."""
        return SlowPosition.at_rest(CORNER * peak_frequency(self.sea), t, np.array(pose, dtype=np.float64))

    def mean_force(self, yaw: float = 0.0) -> Array:
        """Mean drift force and moment (6,), N and N m, in the horizontal frame at the drawing heading, of the floater
        turned by `yaw`, rad."""
        out = np.zeros(6)
        for item in self._second:
            out += item.turned(yaw, lambda force: force.mean)
        return out

    def force(self, t: float, slow: Array | None = None) -> Array:
        """Force and moment (6,), N and N m, at t (s), in the horizontal frame at the drawing heading; slow: pose (3,),
        x, y and yaw from the drawing heading, or None for the drawing position."""
        if self.linear and slow is None:
            return self.excitation.force(t)
        first, second = self.forces(t, slow)
        return first + second

    def forces(self, t: float, slow: Array | None = None) -> tuple[Array, Array]:
        """First- and second-order part of `force`, (6,) each."""
        yaw = 0.0 if slow is None else float(slow[2])
        x, y = origin(self.db, self.position if slow is None else slow, self.heading + yaw, self.body)
        _waves_at(self._waves, t, x, y, self._y)
        r = ramp_factor(t, self.ramp)
        first = r * self._first.turned(yaw, self._linear)
        mean = np.zeros(6)
        second = np.zeros(6)
        for item in self._second:
            mean += item.turned(yaw, lambda force: force.mean)
            second += item.turned(yaw, self._quadratic)
        return first, mean + r * r * (second - mean)

    def _linear(self, packed: Array) -> Array:
        out = np.zeros(6)
        _first_order(self._y, packed, out)
        return out

    def _quadratic(self, force: SecondOrder) -> Array:
        out = np.zeros(6)
        force.add(self._y, out)
        return out


class Turning(Generic[T]):
    """Something that depends on the slow yaw: made at whole steps of it where needed, kept, linear in between.

    fixed: it does not turn, its force stays in the frame of the drawing heading.
    """

    def __init__(self, make: Callable[[float], T], fixed: bool = False, label: str = "") -> None:
        self._make, self._fixed, self.label = make, fixed, label
        self._made: dict[int, T] = {}

    def at(self, yaw: float) -> tuple[T, T | None, float]:
        """What belongs to the step below, to the one above (None if not needed) and the share of the latter."""
        j = 0 if self._fixed else math.floor(yaw / _STEP)
        share = 0.0 if self._fixed else yaw / _STEP - j
        low, high = j % _ROUND, (j + 1) % _ROUND  # a body may turn round and round
        for i in (low, high) if share > 0.0 else (low,):
            if i not in self._made:
                self._made[i] = self._make(i * _STEP)
        return self._made[low], self._made[high] if share > 0.0 else None, share

    def turned(self, yaw: float, force: Callable[[T], Array]) -> Array:
        """force (6,) of what belongs to the yaw, brought from the turned frame into that of the drawing heading."""
        below, above, share = self.at(yaw)
        f = force(below)
        if above is not None:
            f = (1.0 - share) * f + share * force(above)
        if yaw == 0.0 or self._fixed:
            return f
        c, s = math.cos(yaw), math.sin(yaw)
        (x, y, z), (p, q, r) = f[:3], f[3:]
        return np.array([c * x - s * y, s * x + c * y, z, c * p - s * q, s * p + c * q, r])


def _check(db: HydroDatabase, drifts: tuple[Any, ...], body: int) -> None:
    kinds = []
    for item in drifts:
        if isinstance(item, QTF):
            kinds.append(item.kind)
            if np.abs(item.reference_point - db.reference_point[body]).max() > 1e-3:
                raise ModelError(
                    f"QTF '{item.name}': its moments are about {item.reference_point.tolist()} m, those of the "
                    f"hydrodynamic database '{db.name}' about {db.reference_point[body].tolist()} m; they must agree"
                )
        elif isinstance(item, str) and item == "newman":
            kinds.append("difference")
        else:
            raise ModelError(f"drift: got {item!r}; must be 'newman', a QTF (read_wamit_qtf), a tuple of them, or None")
    if len(set(kinds)) != len(kinds):
        raise ModelError(f"drift: got {len(kinds)} forces of kinds {', '.join(kinds)}; at most one of each is possible")


def _packed(X: NDArray[np.complex128]) -> Array:
    """(12, n): Re X and -Im X of the six degrees of freedom."""
    return np.ascontiguousarray(np.concatenate([X.real.T, -X.imag.T]))


@kernel
def _waves_at(waves, t, x, y, out):  # type: ignore[no-untyped-def]
    """out (2, n): real and imaginary part of a e^{i(w t - kx x - ky y + phase)}; waves (n, 5): a, w, kx, ky, phase."""
    for n in range(waves.shape[0]):
        angle = waves[n, 1] * t - waves[n, 2] * x - waves[n, 3] * y + waves[n, 4]
        out[0, n] = waves[n, 0] * math.cos(angle)
        out[1, n] = waves[n, 0] * math.sin(angle)


@kernel(fastmath={"reassoc", "contract"})
def _first_order(y, packed, out):  # type: ignore[no-untyped-def]
    """out += Re sum X y; packed (12, n): Re X, -Im X."""
    for d in range(6):
        total = 0.0
        for n in range(y.shape[1]):
            total += packed[d, n] * y[0, n] + packed[6 + d, n] * y[1, n]
        out[d] += total
