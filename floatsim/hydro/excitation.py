"""First-order wave excitation of a floater at its drawing position.

    F(t) = Re sum X(w, b) a exp(i(w t - k (x cos b + y sin b) + phase))

X from the hydrodynamic database (Froude-Krylov and diffraction), about the body's reference point, at the drawing
position: the floater's motion changes neither phase nor heading, which is what first order means. The force is in
the horizontal frame at the body's drawing heading; the database is read at the wave heading relative to it.

Over the frequency X is a cubic spline that starts at w = 0 from the long-wave limit: a wave far longer than the
floater lifts the water evenly, which is the hydrostatic force of sinking by the same height, X(0) = C e_heave.
(VolturnUS-S by WAMIT with every second of 0.05 rad/s left out: rms error 0.6 to 2.9 % of each peak, linear
interpolation 1.5 to 3.8 %.) Over the headings it is the Fourier series through the database's headings, which must
cover the circle evenly and finely enough for the waves, unless every wave runs along one of them: the harmonics
needed grow with the wave number times the floater's radius.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from floatsim.errors import ModelError
from floatsim.jit import kernel
from floatsim.sea.waves import Realisation, ramp_factor

if TYPE_CHECKING:
    from floatsim.hydro.database import HydroDatabase

Array = NDArray[np.float64]

_LEFT_OUT = 0.01  # share of the sea's energy that may lie above the database's frequencies
_COARSE = 0.05  # share of the force (rms over the sea) in the highest fifth of the harmonics over headings
_SAME = 1e-6  # rad: headings closer than this are the same


@dataclass(frozen=True, eq=False)
class Excitation:
    """Excitation of one floater in one sea. Arrays read-only.

    omega         (n,) rad/s
    coefficients  (n, 6) complex: amplitude of force (N) and moment (N m) of each wave, phase at t = 0
    ramp          s, length of the cosine ramp at the start, none if 0
    left_out      share of the sea's energy above the database's frequencies, for which X is taken as zero
    """

    omega: Array
    coefficients: NDArray[np.complex128]
    ramp: float
    left_out: float
    _packed: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        packed = np.concatenate([self.omega[:, None], self.coefficients.real, -self.coefficients.imag], axis=1)
        for table in (self.omega, self.coefficients, packed):
            table.flags.writeable = False
        object.__setattr__(self, "_packed", packed)

    @classmethod
    def from_database(
        cls,
        db: HydroDatabase,
        sea: Realisation,
        position: tuple[float, float] = (0.0, 0.0),
        heading: float = 0.0,
        ramp: float = 0.0,
        *,
        body: int = 0,
        froude_krylov: bool = True,
    ) -> Excitation:
        """Excitation by `sea` of the floater of `db`, its reference point drawn at `position` (x, y), m, with
        `heading`, rad. body: its index in a database of several; froude_krylov: False leaves that part out
        (diffraction alone).

        Raises ModelError if the headings do not cover the circle (with those missing) or are too coarse for the sea,
        if more than 1 % of the sea's energy is above the database's frequencies (with its range), or if the
        Froude-Krylov part is to be left out and not known.
        """
        X, left_out = transfer_functions(db, sea, body, froude_krylov)
        table = at_headings(db, X, sea.heading - heading, sea.amplitude)
        x0, y0 = origin(db, position, heading, body)
        phase = sea.phase - sea.wave_number * (x0 * np.cos(sea.heading) + y0 * np.sin(sea.heading))
        coefficients = table * (sea.amplitude * np.exp(1j * phase))[:, None]
        return cls(sea.omega.copy(), coefficients, float(ramp), left_out)

    def force(self, t: float) -> Array:
        """Force and moment (6,), N and N m, at time t (s), in the horizontal frame at the drawing heading."""
        out = np.empty(6)
        _force(self._packed, t, ramp_factor(t, self.ramp), out)
        return out


def origin(db: HydroDatabase, position: ArrayLike, heading: float, body: int = 0) -> tuple[float, float]:
    """World x, y [m] of the origin of the database's frame, which its phases refer to, for the reference point of
    `body` at `position` (x, y) and `heading`, rad."""
    c, s = math.cos(heading), math.sin(heading)
    x, y = db.reference_point[body, :2]
    px, py = np.asarray(position, dtype=np.float64)[:2]
    return float(px - c * x + s * y), float(py - s * x - c * y)


def transfer_functions(
    db: HydroDatabase, sea: Realisation, body: int = 0, froude_krylov: bool = True
) -> tuple[NDArray[np.complex128], float]:
    """X (n, m, 6) of `body` for each of the sea's n waves at each of the database's m headings, zero above its
    frequencies, and the share of the sea's energy there. Raises ModelError as `Excitation.from_database`."""
    from scipy.interpolate import CubicSpline

    above = sea.omega > db.omega[-1]
    left_out = float(0.5 * np.sum(sea.amplitude[above] ** 2) / max(sea.variance, np.finfo(float).tiny))
    if left_out > _LEFT_OUT:
        raise ModelError(
            f"hydrodynamic database '{db.name}': its frequencies {db.omega[0]:.3g} to {db.omega[-1]:.3g} rad/s "
            f"leave out {100.0 * left_out:.3g} % of the waves' energy, which reaches {sea.omega[above].max():.3g} "
            f"rad/s (1 % is allowed); extend the database, or cut the waves at {db.omega[-1]:.3g} rad/s "
            "(IrregularWaves: omega_max)"
        )
    mine = slice(6 * body, 6 * body + 6)
    long_wave = np.broadcast_to(db.hydrostatic_stiffness[mine, 6 * body + 2], (1, db.headings.size, 6))
    X = db.excitation[:, :, mine]
    if not froude_krylov:
        if db.froude_krylov is None:
            raise ModelError(
                f"hydrodynamic database '{db.name}': it does not say which part of the excitation is Froude-Krylov, "
                "which a hull of its own replaces; give froude_krylov (WAMIT: the .3sc file, Capytaine: both parts)"
            )
        X = X - db.froude_krylov[:, :, mine]
        long_wave = np.zeros_like(long_wave)  # waves far longer than the hull are not disturbed by it
    known = CubicSpline(np.concatenate([[0.0], db.omega]), np.concatenate([long_wave, X]))(
        np.minimum(sea.omega, db.omega[-1])
    )
    known[above] = 0.0
    return np.asarray(known), left_out


def at_headings(db: HydroDatabase, known: NDArray[Any], heading: Array, amplitude: Array) -> NDArray[Any]:
    """known (n, m, 6), of n waves at the database's m headings, at their own heading (n,) relative to the body.

    Raises ModelError if the headings do not cover the circle or are too coarse for waves of this amplitude (n,).
    """
    apart = np.abs((heading[:, None] - db.headings + np.pi) % (2.0 * np.pi) - np.pi)
    at, each = apart.argmin(axis=1), np.arange(heading.size)
    worst = apart[each, at].argmax()
    if apart[worst, at[worst]] < _SAME:
        return np.asarray(known[each, at])
    name = f"hydrodynamic database '{db.name}'"
    if not _even(db.headings):
        raise ModelError(
            f"{name}: a wave at {_degrees(heading[worst])} deg relative to the body needs headings spread evenly over "
            f"the full circle to interpolate; {_missing(db.headings)}"
        )
    m = db.headings.size
    harmonics = np.fft.fft(known, axis=1) / m
    order = np.fft.fftfreq(m, 1.0 / m)
    energy = np.einsum("n,nmi->mi", amplitude**2, np.abs(harmonics) ** 2)
    high = energy[np.abs(order) >= 0.4 * m].sum(axis=0)
    total = energy.sum(axis=0).reshape(2, 3).max(axis=1).repeat(3)  # forces together, moments together
    share = math.sqrt(np.max(high / np.where(total > 0.0, total, 1.0)))
    if share > _COARSE:
        raise ModelError(
            f"{name}: its headings, {360.0 / m:g} deg apart, are too coarse for these waves: {100.0 * share:.0f} % of "
            f"the force is in the highest harmonics over the heading ({100.0 * _COARSE:g} % allowed); use a database "
            "with finer headings, waves along its headings, or longer waves"
        )
    turn = np.exp(1j * np.outer(heading - db.headings[0], order))
    if m % 2 == 0:  # the highest harmonic is known as a cosine only
        turn[:, m // 2] = turn[:, m // 2].real
    return np.asarray(np.einsum("nm,nmi->ni", turn, harmonics))


def _even(headings: Array) -> bool:
    """Whether the headings cover the circle evenly."""
    return headings.size > 2 and bool(np.all(np.abs(np.diff(headings) - 2.0 * np.pi / headings.size) < 1e3 * _SAME))


def _missing(headings: Array) -> str:
    """What keeps the headings from covering the circle evenly."""
    if headings.size < 2:
        return f"it has only {_degrees(headings[0])} deg"
    step = np.diff(headings).min()
    count = round(2.0 * np.pi / step)
    circle = headings[0] + 2.0 * np.pi / count * np.arange(count)
    apart = np.abs((circle[:, None] - headings + np.pi) % (2.0 * np.pi) - np.pi).min(axis=1)
    missing = sorted((circle[apart > 1e3 * _SAME] + np.pi) % (2.0 * np.pi) - np.pi)
    if count - len(missing) != headings.size:
        listed = ", ".join(_degrees(item) for item in headings)
        return f"it has {listed} deg, which are not multiples of one step"
    return f"missing are {', '.join(_degrees(item) for item in missing)} deg"


def _degrees(angle: float) -> str:
    return f"{round(math.degrees((angle + math.pi) % (2.0 * math.pi) - math.pi), 3) + 0.0:g}"


@kernel
def _force(packed, t, factor, out):  # type: ignore[no-untyped-def]
    """out (6,) = factor * sum of Re C cos(w t) - Im C sin(w t); packed (n, 13): w, Re C, -Im C."""
    f0 = f1 = f2 = f3 = f4 = f5 = 0.0
    for n in range(packed.shape[0]):
        c = math.cos(packed[n, 0] * t)
        s = math.sin(packed[n, 0] * t)
        f0 += packed[n, 1] * c + packed[n, 7] * s
        f1 += packed[n, 2] * c + packed[n, 8] * s
        f2 += packed[n, 3] * c + packed[n, 9] * s
        f3 += packed[n, 4] * c + packed[n, 10] * s
        f4 += packed[n, 5] * c + packed[n, 11] * s
        f5 += packed[n, 6] * c + packed[n, 12] * s
    out[0] = factor * f0
    out[1] = factor * f1
    out[2] = factor * f2
    out[3] = factor * f3
    out[4] = factor * f4
    out[5] = factor * f5
