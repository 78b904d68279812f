"""Turbulence of the wind as a rotor feels it: the longitudinal fluctuation averaged over the disc.

Spectrum at a point (Kaimal et al. 1972 in the form of IEC 61400-1:2019, annex C), f in Hz, U the mean wind, L the
integral scale, 8.1 times 42 m for hubs above 60 m, s the standard deviation:

    f S(f)/s^2 = (4 f L/U)/(1 + 6 f L/U)^(5/3),        int_0^f S/s^2 = 1 - (1 + 6 f L/U)^(-2/3)

Coherence of two points at the distance r (Davenport's exponential form, same annex): S_12/S = exp(-q r) with
q = 12 sqrt((f/U)^2 + (0.12/L)^2). The mean over a disc of radius R then has the spectrum chi^2 S with

    chi^2(f) = 1/A^2 int int exp(-q |x - x'|) dA dA' = int_0^2R p(r) exp(-q r) dr,

p(r) = 4 r/(pi R^2) (arccos(r/2R) - r/2R sqrt(1 - (r/2R)^2)), the density of the distance of two points drawn from a
disc. With r = 2 R cos(y):

    chi^2 = 16/pi int_0^(pi/2) cos y sin y (y - sin y cos y) exp(-2 q R cos y) dy,

1 for small discs and 8/(2 q R)^2 for large ones.

Harmonics as in sea/waves.py: the spectrum of the point is cut into bins of equal energy, each with one harmonic at the
frequency that halves it; phases from the raw integers of PCG64, far on in its stream, because a sea of the same seed
takes the first. Each is lowered by chi of its frequency. Below 1/`longest_period` a fluctuation is a change of the
mean, which the load case has stated, above `highest_frequency` there is hardly anything left on a rotor: both are cut
off, and the amplitudes are raised so that the standard deviation at a point is `intensity` times the mean wind.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike
from pydantic import BeforeValidator, Field, field_validator, model_validator

from floatsim.description import Description, NonNegative, Positive, PositiveInt
from floatsim.errors import ModelError
from floatsim.frames import Array
from floatsim.jit import kernel
from floatsim.sea.waves import ramp_factor, repeat_period

DECAY, SCALE = 12.0, 0.12  # of the coherence
_NODES = 200  # of Gauss-Legendre over y: exact to 1e-12 up to 2 q R = 200


def _integer(value: Any) -> Any:
    return int(value) if isinstance(value, np.integer) else value


@dataclass(frozen=True, eq=False)
class Fluctuation:
    """A sum of harmonics, (n, 3) rows of amplitude [m/s], omega [rad/s], phase [rad]; duration [s]: until which it
    does not repeat."""

    packed: Array
    duration: float

    @property
    def variance(self) -> float:
        """Sum of amplitude^2/2 [m2/s2]."""
        return float(0.5 * np.sum(self.packed[:, 0] ** 2))

    def at(self, t: float, ramp: float = 0.0) -> float:
        """Fluctuation [m/s] at time t [s]; ramp [s]: length of the cosine ramp at the start."""
        return float(harmonics(self.packed, t) * ramp_factor(t, ramp))


@kernel
def harmonics(packed, t):  # type: ignore[no-untyped-def]
    """Sum of amplitude cos(omega t + phase)."""
    y = 0.0
    for k in range(packed.shape[0]):
        y += packed[k, 0] * math.cos(packed[k, 1] * t + packed[k, 2])
    return y


def disc_admittance(decay_radius: ArrayLike) -> Array:
    """chi^2 [-] of the mean over a disc for coherence exp(-q r); decay_radius: q R [-], any shape."""
    y, weight = np.polynomial.legendre.leggauss(_NODES)
    y = 0.25 * math.pi * (y + 1.0)
    density = np.cos(y) * np.sin(y) * (y - np.sin(y) * np.cos(y)) * weight * 4.0  # 16/pi times pi/4
    b = 2.0 * np.asarray(decay_radius, dtype=float)
    return np.asarray(np.exp(-b[..., None] * np.cos(y)) @ density)


class Kaimal(Description):
    """Kaimal turbulence; the spectrum and how a realisation is made stand at the top of this file.

    intensity [-]: standard deviation of the wind at a point over its mean. seed: integer, not negative; same seed,
    same wind. length_scale L [m]. components: number of harmonics. duration [s]: within which it must not repeat.
    longest_period [s], highest_frequency [Hz]: what is beyond is left out.
    """

    intensity: NonNegative
    seed: Annotated[int, BeforeValidator(_integer), Field(ge=0)]
    length_scale: Positive = 340.2
    components: PositiveInt = 400
    duration: Positive = 3600.0
    longest_period: Positive = 600.0
    highest_frequency: Positive = 0.5

    @field_validator("intensity")
    @classmethod
    def _share(cls, value: float) -> float:
        if value > 1.0:
            raise ValueError(f"got {value:g}; a share of the mean wind, 0.14 for 14 %, at most 1")
        return value

    @model_validator(mode="after")
    def _band(self) -> Kaimal:
        if self.highest_frequency * self.longest_period <= 1.0:
            raise ValueError(
                f"highest_frequency is {self.highest_frequency:g} Hz and longest_period {self.longest_period:g} s; "
                "nothing is left between them"
            )
        return self

    def density(self, frequency: ArrayLike, speed: float) -> Array:
        """S/s^2 [1/Hz] of the uncut spectrum at `frequency` [Hz] in a mean wind of `speed` [m/s]."""
        n = np.asarray(frequency, dtype=float) * self.length_scale / speed
        return np.asarray(4.0 * self.length_scale / speed / (1.0 + 6.0 * n) ** (5.0 / 3.0))

    def decay(self, frequency: ArrayLike, speed: float) -> Array:
        """q [1/m] of the coherence."""
        f = np.asarray(frequency, dtype=float)
        return np.asarray(DECAY * np.hypot(f / speed, SCALE / self.length_scale))

    def realise(self, speed: float, radius: float) -> Fluctuation:
        """The fluctuation averaged over a disc of `radius` [m] (0: at a point) in a mean wind of `speed` [m/s].

        Raises ModelError for a mean wind of zero, or if the sum repeats within `duration`.
        """
        if not speed > 0.0:
            raise ModelError(f"Kaimal: the mean wind is {speed:g} m/s; turbulence needs a wind")
        slope = 6.0 * self.length_scale / speed
        low, high = (1.0 - (1.0 + slope * f) ** (-2.0 / 3.0) for f in (1.0 / self.longest_period,
                                                                       self.highest_frequency))  # fmt: skip
        share = low + (np.arange(self.components) + 0.5) / self.components * (high - low)
        f = ((1.0 - share) ** -1.5 - 1.0) / slope
        omega = 2.0 * math.pi * f
        repeat = repeat_period(omega, self.duration)
        if repeat < self.duration:
            enough = math.ceil(self.components * self.duration / repeat)
            raise ModelError(
                f"Kaimal: {self.components} components repeat after {repeat:.0f} s, the wind must last "
                f"{self.duration:g} s; about {enough} components do"
            )
        sigma = self.intensity * speed
        chi = np.sqrt(disc_admittance(radius * self.decay(f, speed)))
        raw = np.random.PCG64(self.seed).jumped().random_raw(self.components)  # else a sea of this seed had its phases
        phase = (raw >> np.uint64(11)) * (2.0 * np.pi / 2.0**53)
        packed = np.stack([sigma * math.sqrt(2.0 / self.components) * chi, omega, phase], axis=1)
        packed = np.ascontiguousarray(packed, dtype=np.float64)
        return Fluctuation(packed, self.duration)
