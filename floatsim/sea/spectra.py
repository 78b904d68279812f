"""Wave spectra: variance density of the elevation over the frequency.

A spectrum is any object with `density(omega)`: omega (n,) in rad/s to S(omega) (n,) in m2 s/rad, one-sided,
its integral being the variance of the elevation. A class of a user's own script does as well as one of these.
"""

from __future__ import annotations

from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from floatsim.description import Description, Positive

Array = NDArray[np.float64]


class Spectrum(Protocol):
    """What a spectrum must have: S(omega) (n,), m2 s/rad, for omega (n,), rad/s."""

    def density(self, omega: Array, /) -> Array: ...


def _bretschneider(x: Array) -> Array:
    """5 x^-5 exp(-5/4 x^-4), x = w/w_p: the integral over x is one."""
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        return np.where(x > 0.05, 5.0 * x**-5 * np.exp(-1.25 * x**-4), 0.0)  # exp(-2e5) is zero


class PiersonMoskowitz(Description):
    """Two-parameter Pierson-Moskowitz spectrum, also called Bretschneider or ISSC: a fully developed sea.

    S(w) = 5/16 hs^2 w_p^4 w^-5 exp(-5/4 (w_p/w)^4). hs: significant height, 4 times the standard deviation of the
    elevation, m; tp: period of the peak, s. Source: IEC 61400-3-1:2019 annex C; DNV-RP-C205 3.5.5.
    """

    hs: Positive
    tp: Positive

    def density(self, omega: Array) -> Array:
        """S (n,), m2 s/rad, at omega (n,), rad/s; its integral is hs^2/16."""
        peak = 2.0 * np.pi / self.tp
        return self.hs**2 / 16.0 / peak * _bretschneider(np.asarray(omega, dtype=np.float64) / peak)


class Jonswap(Description):
    """JONSWAP spectrum: a growing sea, Pierson-Moskowitz times a peak enhancement (Hasselmann et al. 1973).

    S(w) = C 5/16 hs^2 w_p^4 w^-5 exp(-5/4 (w_p/w)^4) gamma^b, b = exp(-(w/w_p - 1)^2/(2 sigma^2)), sigma = 0.07
    below the peak and 0.09 above. hs in m, tp in s, gamma the peak enhancement. The form is that of IEC 61400-3-1:2019
    annex C, whose C = 1 - 0.287 ln(gamma) keeps hs within 1 % for gamma up to 7; here C is found numerically, so
    that hs is kept whatever gamma.
    """

    hs: Positive
    tp: Positive
    gamma: Positive = 3.3

    @cached_property
    def normalisation(self) -> float:
        """C: one over the integral of the enhanced shape, by trapezoids in ln x (1e-7)."""
        x = np.geomspace(0.1, 1e3, 40001)
        return float(1.0 / np.trapezoid(x * self._shape(x), np.log(x)))

    def _shape(self, x: Array) -> Array:
        sigma = np.where(x <= 1.0, 0.07, 0.09)
        return _bretschneider(x) * self.gamma ** np.exp(-0.5 * ((x - 1.0) / sigma) ** 2)

    def density(self, omega: Array) -> Array:
        """S (n,), m2 s/rad, at omega (n,), rad/s; its integral is hs^2/16."""
        peak = 2.0 * np.pi / self.tp
        x = np.asarray(omega, dtype=np.float64) / peak
        return self.hs**2 / 16.0 / peak * self.normalisation * self._shape(x)
