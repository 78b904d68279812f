"""Wave spectra: variance density of the elevation over the frequency.

A spectrum is any object with `density(omega)`: omega (n,) in rad/s to S(omega) (n,) in m2 s/rad, one-sided,
its integral being the variance of the elevation. A class of a user's own script does as well as one of these; where
its density has corners or jumps, an attribute `corners` with their frequencies (rad/s) makes realisations exact there.

All the parametric ones are made of one or two peaks of one shape (`Peak`), with x = w/w_p, w_p = 2 pi/tp:

    S(w) = hs^2/(16 w_p) G x^-N exp(-(N/M) x^-M) gamma^b,     b = exp(-(x - 1)^2/(2 sigma^2)),

sigma = 0.07 for x <= 1 and 0.09 above. N is the slope of the tail, M that of the front, gamma enhances the peak, which
is at x = 1 whatever they are. G makes the integral hs^2/16. N = 5, M = 4 is Pierson-Moskowitz.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Annotated, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, Field, model_validator

from floatsim.description import Description, NonNegative, Positive, Series, numbers

Array = NDArray[np.float64]

_SIGMA = (0.07, 0.09)  # widths of the enhancement below and above the peak (Hasselmann et al. 1973)


class Spectrum(Protocol):
    """What a spectrum must have: S(omega) (n,), m2 s/rad, for omega (n,), rad/s."""

    def density(self, omega: Array, /) -> Array: ...


def _shape(x: Array, N: float, M: float, gamma: float) -> Array:
    """x^-N exp(-(N/M) x^-M) gamma^b, as one exponential: nothing overflows."""
    y = np.maximum(x, 1e-3)  # where the exponential has long been zero
    b = np.exp(-0.5 * ((y - 1.0) / np.where(y <= 1.0, *_SIGMA)) ** 2)
    return np.asarray(np.exp(-N * np.log(y) - N / M * y**-M + b * math.log(gamma)))


@lru_cache
def _area(N: float, M: float, gamma: float) -> float:
    """Integral of `_shape` over x: a gamma function, and what the enhancement adds by Gauss-Legendre (rounding)."""
    n = (N - 1.0) / M
    area = math.exp(math.lgamma(n) - n * math.log(N / M)) / M
    if gamma != 1.0:
        s, weight = np.polynomial.legendre.leggauss(100)
        for a, b in ((1.0 - 9.0 * _SIGMA[0], 1.0), (1.0, 1.0 + 9.0 * _SIGMA[1])):  # beyond, gamma^b is 1
            x = 0.5 * (a + b) + 0.5 * (b - a) * s
            area += 0.5 * (b - a) * float(weight @ (_shape(x, N, M, gamma) - _shape(x, N, M, 1.0)))
    return area


@dataclass(frozen=True)
class Peak:
    """One peak; the form is printed at the top of this module. hs in m, tp in s; N > 1, M > 0, gamma > 0."""

    hs: float
    tp: float
    N: float = 5.0
    M: float = 4.0
    gamma: float = 1.0

    @property
    def G(self) -> float:
        """What makes the integral hs^2/16."""
        return 1.0 / _area(self.N, self.M, self.gamma)

    def density(self, omega: Array) -> Array:
        """S (n,), m2 s/rad, at omega (n,), rad/s; its integral is hs^2/16."""
        peak = 2.0 * np.pi / self.tp
        x = np.asarray(omega, dtype=np.float64) / peak
        return self.hs**2 / 16.0 / peak * self.G * _shape(x, self.N, self.M, self.gamma)


class PiersonMoskowitz(Description):
    """Two-parameter Pierson-Moskowitz spectrum, also called Bretschneider or ISSC: a fully developed sea.

    S(w) = 5/16 hs^2 w_p^4 w^-5 exp(-5/4 (w_p/w)^4). hs: significant height, 4 times the standard deviation of the
    elevation, m; tp: period of the peak, s. Source: IEC 61400-3-1:2019 annex C; DNV-RP-C205 3.5.5.
    """

    hs: Positive
    tp: Positive

    def density(self, omega: Array) -> Array:
        """S (n,), m2 s/rad, at omega (n,), rad/s; its integral is hs^2/16."""
        return Peak(self.hs, self.tp).density(omega)


class Bretschneider(PiersonMoskowitz):
    """Bretschneider spectrum (Bretschneider 1959; ITTC 1978): another name of PiersonMoskowitz(hs, tp).

    The ITTC writes A w^-5 exp(-B w^-4) with A = 487 hs^2/tp^4 and B = 1949/tp^4, which are 5/16 hs^2 w_p^4 and
    5/4 w_p^4. For the mean period t1 or the zero-crossing period tz give tp = 1.296 t1 or tp = 1.408 tz.
    """


class Jonswap(Description):
    """JONSWAP spectrum: a growing sea, Pierson-Moskowitz times a peak enhancement (Hasselmann et al. 1973).

    S(w) = C 5/16 hs^2 w_p^4 w^-5 exp(-5/4 (w_p/w)^4) gamma^b, b = exp(-(w/w_p - 1)^2/(2 sigma^2)), sigma = 0.07
    below the peak and 0.09 above. hs in m, tp in s, gamma the peak enhancement. The form is that of IEC 61400-3-1:2019
    annex C, whose C = 1 - 0.287 ln(gamma) keeps hs within 1 % for gamma up to 7; here C is found by quadrature, so
    that hs is kept whatever gamma.
    """

    hs: Positive
    tp: Positive
    gamma: Positive = 3.3

    @property
    def normalisation(self) -> float:
        """C: how much the enhancement must be taken back for hs to stay."""
        return _area(5.0, 4.0, 1.0) / _area(5.0, 4.0, self.gamma)

    def density(self, omega: Array) -> Array:
        """S (n,), m2 s/rad, at omega (n,), rad/s; its integral is hs^2/16."""
        return Peak(self.hs, self.tp, gamma=self.gamma).density(omega)


def _positive(pair: tuple[float, ...]) -> tuple[float, ...]:
    if min(pair) <= 0.0:
        raise ValueError(f"got {pair}; both must be positive")
    return pair


_Pair = Annotated[
    tuple[float, float], AfterValidator(_positive), numbers("two numbers, of the first and the second peak", 2)
]


class OchiHubble(Description):
    """Ochi-Hubble spectrum: swell and wind sea, three parameters each (Ochi & Hubble 1976, eq. 5).

    S(w) = 1/4 sum ((4 lam + 1)/4 w_p^4)^lam/Gamma(lam) hs^2 w^-(4 lam + 1) exp(-(4 lam + 1)/4 (w_p/w)^4)

    over two peaks. hs: significant heights, m; tp: periods of the peaks, s; lam: shapes, the higher the narrower, 1
    being Pierson-Moskowitz. The significant height of the sea is the root of the sum of squares.
    """

    hs: _Pair
    tp: _Pair
    lam: _Pair

    @classmethod
    def most_probable(cls, hs: float) -> OchiHubble:
        """The most probable spectrum of a North Atlantic sea of significant height `hs`, m.

        Table 2b of Ochi & Hubble 1976: 0.84 hs and 0.54 hs, w_p = 0.70 exp(-0.046 hs) and 1.15 exp(-0.039 hs) rad/s,
        lam = 3.00 and 1.54 exp(-0.062 hs). Their two heights, as printed, leave 0.14 % of hs out; here they are divided
        by 0.9986, so that hs is kept. Raises ModelError if hs is not positive.
        """
        h = _Height(hs=hs).hs
        part = h / math.hypot(0.84, 0.54)
        return cls(
            hs=(0.84 * part, 0.54 * part),
            tp=(2.0 * math.pi / 0.70 * math.exp(0.046 * h), 2.0 * math.pi / 1.15 * math.exp(0.039 * h)),
            lam=(3.0, 1.54 * math.exp(-0.062 * h)),
        )

    @cached_property
    def peaks(self) -> tuple[Peak, ...]:
        """The two peaks, each a spectrum."""
        each = zip(self.hs, self.tp, self.lam, strict=True)
        return tuple(Peak(hs, tp, N=4.0 * lam + 1.0) for hs, tp, lam in each)

    def density(self, omega: Array) -> Array:
        """S (n,), m2 s/rad, at omega (n,), rad/s; its integral is the sum of hs^2/16."""
        return np.asarray(sum(peak.density(omega) for peak in self.peaks))


class _Height(Description):
    """The argument of `OchiHubble.most_probable`."""

    hs: Annotated[Positive, Field(le=30.0)]


_Height.__name__ = "OchiHubble.most_probable"  # the name its problems are reported under


class Torsethaugen(Description):
    """Torsethaugen spectrum: wind sea and swell of the Norwegian shelf from hs (m) and tp (s) of the whole sea.

    `fetch_factor` [s m^-1/3]: a sea of hs is fully developed at the period tf = fetch_factor hs^(1/3); 6.6 for a fetch
    of 370 km, 5.3 for 100 km. Up to tf wind sea dominates and has the peak at tp, beyond it swell does. The share of
    the primary peak is hs1 = r hs and that of the secondary hs2 = sqrt(1 - r^2) hs, with

        wind   r = 0.7 + 0.3 exp(-(2 (tf - tp)/(tf - 2 sqrt(hs)))^2)     tp2 = tf + 2
        swell  r = 0.6 + 0.4 exp(-((tp - tf)/(0.3 (25 - tf)))^2)

    the fractions of periods taken between 0 and 1. N = 0.5 sqrt(hs) + 3.2, M = 4 and the primary peak's

        wind   gamma = c (2 pi hs1/(g tp^2))^0.857                       c = 35 (1 + 3.5 exp(-hs))
        swell  gamma = c (2 pi hs/(g tf^2))^0.857 (1 + 6 (tp - tf)/(25 - tf))

    but not below 1; the secondary peak has gamma = 1 and, beside swell, M = 4 (1 - 0.7 exp(-hs/3)) and
    tp2 = (G hs2^2/(16 s 0.4^N))^(1/(N-1)), at least 2.5 s, s = 0.08 (1 - exp(-hs/3)), at least 0.01. This is the full
    model (Torsethaugen 1996; DNV-RP-C205 appendix A). `simplified` is that of Torsethaugen & Haver 2004: N = M = 4,
    c = 35, and tp2 = fetch_factor hs2^(1/3) beside swell. G is found by quadrature (the papers fit it), so that hs is
    kept. Measured were hs 0.5 to 11 m and tp 3.5 to 19 s; seas whose tf is 25 s or more are refused.
    """

    hs: Positive
    tp: Positive
    fetch_factor: Positive = 6.6
    simplified: bool = False

    @model_validator(mode="after")
    def _measured(self) -> Torsethaugen:
        if not 2.0 * math.sqrt(self.hs) < self._tf < 25.0:
            raise ValueError(
                f"hs {self.hs:g} m is far beyond the seas the spectrum was made from (up to 11 m); use Jonswap"
            )
        return self

    @property
    def _tf(self) -> float:
        return self.fetch_factor * self.hs ** (1.0 / 3.0)

    @cached_property
    def peaks(self) -> tuple[Peak, ...]:
        """The primary and the secondary peak, each a spectrum; the primary alone where it has all the energy."""
        hs, tp, tf, g = self.hs, self.tp, self._tf, 9.81
        c, N = (35.0, 4.0) if self.simplified else (35.0 * (1.0 + 3.5 * math.exp(-hs)), 0.5 * math.sqrt(hs) + 3.2)
        wind = tp <= tf
        if wind:
            young = min((tf - tp) / (tf - 2.0 * math.sqrt(hs)), 1.0)
            r = 0.7 + 0.3 * math.exp(-((2.0 * young) ** 2))
            gamma = c * (2.0 * math.pi * r * hs / (g * tp**2)) ** 0.857
        else:
            old = min((tp - tf) / (25.0 - tf), 1.0)
            r = 0.6 + 0.4 * math.exp(-((old / 0.3) ** 2))
            gamma = c * (2.0 * math.pi * hs / (g * tf**2)) ** 0.857 * (1.0 + 6.0 * old)
        primary = Peak(r * hs, tp, N, 4.0, max(gamma, 1.0))
        hs2 = math.sqrt(max(1.0 - r * r, 0.0)) * hs
        if hs2 == 0.0:
            return (primary,)
        if wind:
            return primary, Peak(hs2, tf + 2.0, N)
        if self.simplified:
            return primary, Peak(hs2, self.fetch_factor * hs2 ** (1.0 / 3.0), N)
        M = 4.0 * (1.0 - 0.7 * math.exp(-hs / 3.0))
        s = max(0.08 * (1.0 - math.exp(-hs / 3.0)), 0.01)
        tp2 = (hs2**2 / (16.0 * s * 0.4**N * _area(N, M, 1.0))) ** (1.0 / (N - 1.0))
        return primary, Peak(hs2, max(tp2, 2.5), N, M)

    def density(self, omega: Array) -> Array:
        """S (n,), m2 s/rad, at omega (n,), rad/s; its integral is hs^2/16."""
        return np.asarray(sum(peak.density(omega) for peak in self.peaks))


class SpectrumTable(Description):
    """The user's own spectrum by rows: omega, rad/s, ascending, and S there, m2 s/rad.

    Linear between, nothing outside. From a table over f in Hz: omega = 2 pi f and S(omega) = S(f)/(2 pi).
    """

    omega: Annotated[Series, Field(min_length=2)]
    S: Series

    @model_validator(mode="after")
    def _consistent(self) -> SpectrumTable:
        if len(self.S) != len(self.omega):
            raise ValueError(f"S has {len(self.S)} values, omega has {len(self.omega)}")
        if self.omega[0] < 0.0 or min(np.diff(self.omega)) <= 0.0:
            raise ValueError("omega must ascend from zero or above, no value twice")
        if min(self.S) < 0.0 or max(self.S) == 0.0:
            raise ValueError(f"S must not be negative, nor all zero; its values are {min(self.S):g} to {max(self.S):g}")
        return self

    def __repr__(self) -> str:
        return f"SpectrumTable({len(self.omega)} rows, {self.omega[0]:g} to {self.omega[-1]:g} rad/s)"

    @property
    def corners(self) -> tuple[float, ...]:
        """Frequencies, rad/s, at which the density is not smooth."""
        return self.omega

    @property
    def hs(self) -> float:
        """Significant height, m: 4 times the standard deviation."""
        return 4.0 * math.sqrt(float(np.trapezoid(self.S, self.omega)))

    def density(self, omega: Array) -> Array:
        """S (n,), m2 s/rad, at omega (n,), rad/s."""
        return np.interp(omega, self.omega, self.S, left=0.0, right=0.0)


class WhiteNoise(Description):
    """Band-limited white noise: hs^2/16/(omega_max - omega_min) between the two frequencies (rad/s), nothing outside.

    hs in m. For transfer functions from one run. Its waves are evenly spaced, so that n of them repeat after
    2 pi n/(omega_max - omega_min): IrregularWaves needs that many components for its duration, and says so.
    """

    hs: Positive
    omega_min: NonNegative
    omega_max: Positive

    @model_validator(mode="after")
    def _consistent(self) -> WhiteNoise:
        if self.omega_max <= self.omega_min:
            raise ValueError(f"omega_max ({self.omega_max:g} rad/s) must be above omega_min ({self.omega_min:g} rad/s)")
        return self

    @property
    def corners(self) -> tuple[float, ...]:
        """Frequencies, rad/s, at which the density jumps."""
        return self.omega_min, self.omega_max

    def density(self, omega: Array) -> Array:
        """S (n,), m2 s/rad, at omega (n,), rad/s; its integral is hs^2/16."""
        w = np.asarray(omega, dtype=np.float64)
        level = self.hs**2 / 16.0 / (self.omega_max - self.omega_min)
        return np.where((w >= self.omega_min) & (w <= self.omega_max), level, 0.0)
