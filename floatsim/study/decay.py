"""Free decay: natural period, linear and quadratic damping from the extrema of a record.

For x'' + 2 zeta w x' + b |x'| x' + w^2 x = 0 and a half cycle of amplitude A, x = A cos(w t), the energy (per mass)
lost to the damping is

    int 2 zeta w x'^2 dt + int b |x'|^3 dt = pi zeta w^2 A^2 + (4/3) b w^2 A^3

and equals the change of w^2 x^2/2 from one extremum to the next, w^2 A dA. So the logarithmic decrement of a half
cycle is

    delta(A) = ln(A_i/A_(i+1)) = p + q A,      p = pi zeta/sqrt(1 - zeta^2),      q = 4 b/3

(the root makes the linear part exact), a straight line over the amplitude; p/(4/3 b) are Faltinsen's p1, p2 per half
cycle (Sea Loads on Ships and Offshore Structures, 1990, decay tests; Froude's a and b before him). At amplitude
A the damping ratio is zeta + 4 b A/(3 pi).

Amplitudes are halves of the way between successive extrema, A_i = |x_i - x_(i+1)|/2: an error of the equilibrium and a
restoring force that is stiffer on one side would make decrements about the equilibrium zigzag; these do not see it.
The straight line is the first term of an expansion in delta: with a first decrement of 0.5 the quadratic part comes out
3 % high and zeta 0.001 low, with 0.2 it is 1 % and 0.0002 (integrated numerically).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from floatsim.errors import CaseError
from floatsim.frames import Array

SMALLEST = 0.02  # extrema below this share of the largest are left out: the equilibrium is not known better


@dataclass(frozen=True, eq=False)
class DecayFit:
    """What a decay shows; units of x are the record's (m or rad).

    time [s], value (n,): extrema, value measured from `equilibrium`.
    periods [s] (cycles,): between successive extrema on the side of the first. period: mean of the first three (or of
    as many as there are). amplitude, decrement (n - 2,): mean amplitude and logarithmic decrement of each half cycle.
    damping_ratio: zeta of the linear part. quadratic_damping: b [1/unit of x], None from a single decrement, where
    damping_ratio is then all there is. residual: root mean square of the decrement's distance from the line.
    """

    equilibrium: float
    time: Array
    value: Array
    periods: Array
    period: float
    amplitude: Array
    decrement: Array
    damping_ratio: float
    quadratic_damping: float | None
    residual: float

    @property
    def amplitudes(self) -> tuple[float, float]:
        """Smallest and largest amplitude the damping was fitted over."""
        return float(self.amplitude.min()), float(self.amplitude.max())

    def equivalent_ratio(self, amplitude: float) -> float:
        """Damping ratio at an amplitude [unit of x]: zeta + 4 b A/(3 pi)."""
        return self.damping_ratio + 4.0 * (self.quadratic_damping or 0.0) * amplitude / (3.0 * math.pi)


def extrema(time: ArrayLike, value: ArrayLike, equilibrium: float) -> tuple[Array, Array]:
    """Times (n,) and values (n,) of the extrema, one for each half cycle between crossings of the equilibrium.

    Each is the top of the parabola through three samples; where the record starts at rest its first
    sample is the first extremum. Values are measured from the equilibrium. A last half cycle counts once the record
    has come back half way. Raises CaseError for records that are not two equally long finite rows.
    """
    t, x = np.asarray(time, dtype=float), np.asarray(value, dtype=float) - equilibrium
    if t.ndim != 1 or t.shape != x.shape or len(t) < 5:
        raise CaseError(f"decay: got time {t.shape} and value {x.shape}; two rows of at least 5 samples are allowed")
    if not (np.isfinite(t).all() and np.isfinite(x).all() and (np.diff(t) > 0.0).all()):
        raise CaseError("decay: the record contains NaN or infinity, or its time does not increase")
    side = x > 0.0
    ends = [*np.flatnonzero(side[1:] != side[:-1]) + 1, len(x)]
    found = []
    start = 0
    for end in ends:
        k = start + int(np.argmax(np.abs(x[start:end])))
        whole = end < len(x) or abs(x[-1]) < 0.5 * abs(x[k])
        if k == 0:
            top, _ = _parabola(t[:3], x[:3])
            if whole and abs(top - t[0]) < 0.5 * (t[1] - t[0]):  # at rest
                found.append((t[0], x[0]))
        elif whole and k < len(x) - 1:
            found.append(_parabola(t[k - 1 : k + 2], x[k - 1 : k + 2]))
        start = end
    points = np.array(found).reshape(-1, 2)
    small = np.flatnonzero(np.abs(points[:, 1]) < SMALLEST * np.abs(points[:, 1]).max(initial=0.0))
    points = points[: small[0]] if len(small) else points
    return points[:, 0].copy(), points[:, 1].copy()


def _parabola(t: Array, x: Array) -> tuple[float, float]:
    """Time and value of the extremum of the parabola through three samples."""
    s1, s2 = (x[1] - x[0]) / (t[1] - t[0]), (x[2] - x[1]) / (t[2] - t[1])
    bend = (s2 - s1) / (t[2] - t[0])
    if bend == 0.0:
        return float(t[1]), float(x[1])
    top = 0.5 * (t[0] + t[1]) - 0.5 * s1 / bend
    return float(top), float(x[0] + s1 * (top - t[0]) + bend * (top - t[0]) * (top - t[1]))


def fit_decay(time: ArrayLike, value: ArrayLike, equilibrium: float) -> DecayFit:
    """Period and damping of a free decay. time [s] (n,), value (n,) and equilibrium [m or rad].

    Raises CaseError if the record has fewer than three extrema.
    """
    t, x = extrema(time, value, equilibrium)
    if len(t) < 3:
        length = float(np.ptp(np.asarray(time, dtype=float)))
        raise CaseError(
            f"decay: {len(t)} extrema about {equilibrium:g} in {length:g} s; a period needs three: make the duration "
            "longer, or look whether the motion decays about another equilibrium or is overdamped"
        )
    half = 0.5 * np.abs(np.diff(x))
    decrement = np.log(half[:-1] / half[1:])
    amplitude = 0.5 * (half[:-1] + half[1:])
    periods = np.diff(t[::2])
    if len(decrement) > 1:
        # an error of the extrema is the same in metres for all: in the decrement it goes with 1/amplitude
        q, p = np.polyfit(amplitude, decrement, 1, w=amplitude)
        b = float(0.75 * q)
    else:
        q, p, b = 0.0, decrement[0], None
    return DecayFit(
        equilibrium=float(equilibrium),
        time=t,
        value=x,
        periods=periods,
        period=float(np.mean(periods[:3])),
        amplitude=amplitude,
        decrement=decrement,
        damping_ratio=float(p / math.hypot(math.pi, p)),
        quadratic_damping=b,
        residual=float(np.sqrt(np.mean((decrement - p - q * amplitude) ** 2))),
    )
