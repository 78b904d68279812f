"""Waves as sums of linear components: regular, irregular from a spectrum and a seed, or a user's own.

    eta(x, y, t) = Re sum a exp(i(w t - k (x cos b + y sin b) + phase)),

b the direction towards which the wave travels, counter-clockwise from +x seen from above; origin at mean sea
level at the world's origin. A description (degrees, periods) becomes a `Realisation` (arrays, radians) by
`realise(depth, gravity)`.

Irregular seas have deterministic amplitudes and random phases: the spectrum is cut into bins of equal energy, each
with one wave at the frequency that halves the bin's energy. These frequencies have no common period; that the sum
does not come near to repeating either is checked, not assumed (`IrregularWaves.duration`). The phases come from the
raw integers of NumPy's PCG64 bit generator, whose stream for a seed is guaranteed to stay (distributions are not):
phase = 2 pi (raw >> 11) / 2^53, in the order of the frequencies. Same seed, same sea, whatever else a model contains.

A short-crested sea has as many waves, and the same frequencies and phases; each has its own heading b. Directions are
spread about the mean b0 by D(b) proportional to cos^(2s)((b - b0)/2), all round, the same at all frequencies
(Longuet-Higgins, Cartwright & Smith 1963; the alternative cos^n(b - b0) over half the circle is about as wide for
s = 2n + 1, DNV-RP-C205 3.5.8). n directions halve the energy of n sectors of equal energy; they are dealt to the
frequencies in the order of the next n raw integers of the seed's stream.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import AfterValidator, BeforeValidator, Field, SkipValidation, model_validator

from floatsim.description import Description, Finite, Items, Name, Positive, PositiveInt, Series
from floatsim.errors import ModelError
from floatsim.jit import kernel
from floatsim.sea.dispersion import wave_number
from floatsim.sea.spectra import Spectrum

Array = NDArray[np.float64]

_MOST_CUT = 0.2  # share of the energy that omega_max may leave out
_FORGOTTEN, _REPEATED = (
    0.3,
    0.5,
)  # of the envelope of the autocorrelation; chance alone reaches 0.25 with 100 components


@dataclass(frozen=True, eq=False)
class Realisation:
    """One sea: n linear waves. Arrays (n,), read-only.

    amplitude    m
    omega        rad/s
    wave_number  1/m, from the dispersion relation in `depth`
    heading      rad, towards which the wave travels
    phase        rad
    depth        m, inf for deep water
    duration     s, until which the waves are good: shown not to repeat, or measured; inf: left to the user
    """

    amplitude: Array
    omega: Array
    wave_number: Array
    heading: Array
    phase: Array
    depth: float
    duration: float
    _packed: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        for name in ("amplitude", "omega", "wave_number", "heading", "phase"):
            value = np.array(getattr(self, name), dtype=np.float64, order="C")
            value.flags.writeable = False
            object.__setattr__(self, name, value)
        kx, ky = self.wave_number * np.cos(self.heading), self.wave_number * np.sin(self.heading)
        packed = np.stack([self.amplitude, self.omega, kx, ky, self.phase], axis=1)
        packed.flags.writeable = False
        object.__setattr__(self, "_packed", packed)

    @property
    def variance(self) -> float:
        """Variance of the elevation, sum of a^2/2, m2."""
        return float(0.5 * np.sum(self.amplitude**2))

    def elevation(self, x: ArrayLike, y: ArrayLike, t: ArrayLike, ramp: float = 0.0) -> Any:
        """Elevation, m, at world x, y (m) and t (s), broadcast against each other; a float for scalars.

        `ramp`: length of the cosine ramp at the start, s (see `ramp_factor`).
        """
        points = np.stack(np.broadcast_arrays(x, y, t), axis=-1).astype(np.float64)
        shape = points.shape[:-1]
        out = np.empty(math.prod(shape))
        _elevation(self._packed, points.reshape(-1, 3), float(ramp), out)
        return out.reshape(shape) if shape else float(out[0])


@kernel
def ramp_factor(t, duration):  # type: ignore[no-untyped-def]
    """Cosine ramp (1 - cos(pi t/duration))/2: 0 before t = 0, 1 from `duration` (s) on; always 1 if that is 0."""
    if t >= duration or duration <= 0.0:
        return 1.0
    return 0.5 - 0.5 * math.cos(math.pi * t / duration) if t > 0.0 else 0.0


class RegularWave(Description):
    """One linear wave. height: crest to trough, m; period: s; the crest passes the world's origin at
    t = - phase/(2 pi) period. heading_deg, phase_deg: degrees. Linear whatever its steepness."""

    height: Positive
    period: Positive
    heading_deg: Finite = 0.0
    phase_deg: Finite = 0.0
    name: Name | None = None

    def realise(self, depth: float, gravity: float) -> Realisation:
        """The wave in `depth` (m, inf for deep water) under `gravity` (m/s2)."""
        omega = 2.0 * np.pi / self.period
        return _realisation([0.5 * self.height], [omega], self.heading_deg, self.phase_deg, depth, gravity)


class WaveComponents(Description):
    """The user's own linear waves, n of each. amplitude: m; either period (s) or omega (rad/s); heading_deg and
    phase_deg: degrees, n of them or one for all."""

    amplitude: Annotated[Series, Field(min_length=1)]
    period: Series | None = None
    omega: Series | None = None
    heading_deg: Finite | Series = 0.0
    phase_deg: Finite | Series = 0.0
    name: Name | None = None

    @model_validator(mode="after")
    def _consistent(self) -> WaveComponents:
        if (self.period is None) == (self.omega is None):
            raise ValueError("give either period or omega, one and not both")
        for key in ("period", "omega", "heading_deg", "phase_deg"):
            value = getattr(self, key)
            if isinstance(value, tuple) and len(value) != len(self.amplitude):
                raise ValueError(f"{key} has {len(value)} values, amplitude has {len(self.amplitude)}")
        if min(self.amplitude) < 0.0:
            raise ValueError(f"amplitude {min(self.amplitude)} m is negative; use phase_deg = 180")
        if min(self.period or self.omega or ()) <= 0.0:
            raise ValueError("periods and frequencies must be positive")
        return self

    def realise(self, depth: float, gravity: float) -> Realisation:
        """The waves in `depth` (m, inf for deep water) under `gravity` (m/s2)."""
        omega = 2.0 * np.pi / np.array(self.period) if self.omega is None else np.array(self.omega)
        return _realisation(self.amplitude, omega, self.heading_deg, self.phase_deg, depth, gravity)


def _integer(value: Any) -> Any:
    return int(value) if isinstance(value, np.integer) else value


def _has_density(value: Any) -> Any:
    if isinstance(value, type) or not callable(getattr(value, "density", None)):
        raise ValueError(
            f"got {value!r}; a spectrum is an object with density(omega): Jonswap(hs=.., tp=..), "
            "PiersonMoskowitz(hs=.., tp=..), another of floatsim.sea.SPECTRA or one of your own"
        )
    return value


SpectrumField = Annotated[SkipValidation[Spectrum], AfterValidator(_has_density)]


def cumulative_energy(spectrum: Spectrum, omega_max: float | None, label: str) -> tuple[Array, Array]:
    """Frequencies (n,), rad/s, up to `omega_max`, and the variance below each of them (n,), m2, by trapezoids.

    The density is asked for at 40001 frequencies, evenly in their logarithm (1e-7 of hs in smooth spectra), and at
    those of the spectrum's `corners` and right beside them, so that tables and jumps are integrated exactly. Raises
    ModelError, starting with `label`, for no energy or a density that is negative or not finite.
    """
    grid = np.geomspace(1e-3, 1e3, 40001)
    corners = np.asarray(getattr(spectrum, "corners", ()), dtype=np.float64)
    if corners.size:
        beside = (corners, np.nextafter(corners, np.inf), np.maximum(np.nextafter(corners, -np.inf), 0.0))
        grid = np.unique(np.concatenate([grid, *beside]))
    if omega_max is not None:
        grid = np.append(grid[grid < omega_max], omega_max)
    density = np.asarray(spectrum.density(grid), dtype=np.float64)
    if density.shape != grid.shape or not np.all(density >= 0.0) or not np.all(np.isfinite(density)):
        raise ModelError(
            f"{label}: density(omega) of the spectrum {spectrum!r} must give one finite value, not "
            "negative, for each of the frequencies 0.001 to 1000 rad/s it is asked for"
        )
    energy = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(grid))])
    if not energy[-1] > 0.0:
        raise ModelError(f"{label}: the spectrum {spectrum!r} has no energy up to {grid[-1]:g} rad/s")
    return grid, energy


class IrregularWaves(Description):
    """Irregular sea from a spectrum and a seed; how it is made is said at the top of this module.

    spectrum     one of floatsim.sea.SPECTRA or any object with density(omega)
    seed         integer, not negative; same seed, same sea
    heading_deg  degrees, towards which the waves travel, their mean if they are spread
    spreading    s of cos^(2s)((b - b0)/2), waves of all headings b about the mean; None: a long-crested sea.
                 About 5 to 10 for wind seas and more for swell; the r.m.s. spread is near sqrt(2/(s + 1)) rad
    components   number of waves
    duration     s, within which the sea must not repeat; `realise` refuses it otherwise
    omega_max    rad/s: the spectrum is cut here and its energy above, a fifth at most, left out (not spread)
    """

    spectrum: SpectrumField
    seed: Annotated[int, BeforeValidator(_integer), Field(ge=0)]
    heading_deg: Finite = 0.0
    spreading: Positive | None = None
    components: PositiveInt = 200
    duration: Positive = 3600.0
    omega_max: Positive | None = None
    name: Name | None = None

    def realise(self, depth: float, gravity: float) -> Realisation:
        """The sea in `depth` (m, inf for deep water) under `gravity` (m/s2).

        Raises ModelError if the spectrum has no energy or a density that is negative or not finite, or if the sum
        repeats within `duration`: if the envelope of its autocorrelation, having fallen below 0.3, is above 0.5 again.
        """
        omega, variance = self._equal_energy()
        repeat = repeat_period(omega, self.duration)
        if repeat < self.duration:
            enough = math.ceil(self.components * self.duration / repeat)
            raise ModelError(
                f"{self._label()}: {self.components} components repeat after {repeat:.0f} s, the sea must last "
                f"{self.duration:g} s; about {enough} components do"
            )
        amplitude = np.full(self.components, math.sqrt(2.0 * variance / self.components))
        stream = np.random.PCG64(self.seed)
        raw = stream.random_raw(self.components)
        phase = np.asarray((raw >> np.uint64(11)) * (2.0 * np.pi / 2.0**53), dtype=np.float64)
        sea = _realisation(amplitude, omega, self.heading_deg, 0.0, depth, gravity)
        heading = sea.heading
        if self.spreading is not None:
            place = np.argsort(stream.random_raw(self.components), kind="stable")
            heading = heading + _equal_energy_directions(self.spreading, self.components)[place]
        return Realisation(sea.amplitude, omega, sea.wave_number, heading, phase, depth, self.duration)

    def _label(self) -> str:
        return "IrregularWaves" + (f" '{self.name}'" if self.name else "")

    def _equal_energy(self) -> tuple[Array, float]:
        """Frequencies (n,) that halve the energy of n bins of equal energy, and the variance in all of them, m2."""
        grid, energy = cumulative_energy(self.spectrum, self.omega_max, self._label())
        if self.omega_max is not None:
            whole = cumulative_energy(self.spectrum, None, self._label())[1][-1]
            if energy[-1] < (1.0 - _MOST_CUT) * whole:
                lost = 100.0 * (1.0 - energy[-1] / whole)
                raise ModelError(
                    f"{self._label()}: omega_max {self.omega_max:g} rad/s cuts off {lost:.3g} % of the sea's energy, "
                    f"{100.0 * _MOST_CUT:g} % is allowed (is it in Hz?)"
                )
        middle = (np.arange(self.components) + 0.5) / self.components * energy[-1]
        return np.interp(middle, energy, grid), float(energy[-1])


def _equal_energy_directions(s: float, n: int) -> Array:
    """Directions (n,), rad from the mean, that halve the energy of n sectors of equal energy of cos^(2s)(b/2).

    sin^2(b/2) has a beta distribution of parameters 1/2 and s + 1/2.
    """
    from scipy.special import betaincinv

    share = (2.0 * np.arange(n) + 1.0 - n) / n  # of the energy within b of the mean, signed
    return np.asarray(2.0 * np.sign(share) * np.arcsin(np.sqrt(betaincinv(0.5, s + 0.5, np.abs(share)))))


def repeat_period(omega: Array, duration: float) -> float:
    """Time, s, after which waves of equal amplitude come back to their pattern; inf if not within `duration`.

    The envelope of the autocorrelation is |mean exp(i w tau)|; it is looked at every quarter of a mean period.
    """
    step = 0.5 * np.pi / omega.mean()
    tau = np.arange(0.0, duration, step)
    envelope = np.abs(sum(np.exp(1j * w * tau) for w in omega)) / omega.size
    if omega.size == 1:
        return float(2.0 * np.pi / omega[0])
    forgotten = np.flatnonzero(envelope < _FORGOTTEN)
    if forgotten.size == 0:
        return math.inf
    again = np.flatnonzero(envelope[forgotten[0] :] > _REPEATED)
    return float(tau[forgotten[0] + again[0]]) if again.size else math.inf


def _realisation(
    amplitude: ArrayLike, omega: ArrayLike, heading_deg: ArrayLike, phase_deg: ArrayLike, depth: float, gravity: float
) -> Realisation:
    a = np.asarray(amplitude, dtype=np.float64)
    b, phase = (np.broadcast_to(np.radians(item), a.shape) for item in (heading_deg, phase_deg))
    w = np.asarray(omega, dtype=np.float64)
    return Realisation(a, w, wave_number(w, depth, gravity), b, phase, depth, math.inf)


class CombinedWaves(Description):
    """Several waves at once, each with its own heading: wind sea and swell, a group in a background sea.

    waves: descriptions of waves, their components taken together. They last as long as the shortest of them. Irregular
    ones must have different seeds: equal phases are no independent seas.
    """

    waves: Annotated[Items, Field(min_length=1)]
    name: Name | None = None

    @model_validator(mode="after")
    def _independent(self) -> CombinedWaves:
        for item in self.waves:
            if isinstance(item, type) or not callable(getattr(item, "realise", None)):
                raise ValueError(f"waves: got {item!r}; RegularWave, IrregularWaves or another description of waves")
        used = sorted(seed for item in self.waves for seed in seeds(item))
        twice = [seed for seed, following in pairwise(used) if seed == following]
        if twice:
            raise ValueError(f"waves: the seed {twice[0]} is used twice; independent seas need different seeds")
        return self

    @property
    def focus_time(self) -> float:
        """Earliest time of focus, s, of the groups among them; inf if there are none."""
        return min(getattr(item, "focus_time", math.inf) for item in self.waves)

    def realise(self, depth: float, gravity: float) -> Realisation:
        """All the waves in `depth` (m, inf for deep water) under `gravity` (m/s2). Raises ModelError as they do."""
        each = [item.realise(depth, gravity) for item in self.waves]

        def row(name: str) -> Array:
            return np.concatenate([getattr(sea, name) for sea in each])

        return Realisation(
            row("amplitude"), row("omega"), row("wave_number"), row("heading"), row("phase"), depth,
            min(sea.duration for sea in each),
        )  # fmt: skip


def wave_files(waves: Any) -> tuple[str, ...]:
    """Files that a description of waves was read from."""
    if isinstance(waves, CombinedWaves):
        return tuple(file for item in waves.waves for file in wave_files(item))
    file = getattr(waves, "file", None)
    return () if file is None else (str(file),)


def seeds(waves: Any) -> tuple[int, ...]:
    """Seeds in a description of waves, in its order."""
    if isinstance(waves, CombinedWaves):
        return tuple(seed for item in waves.waves for seed in seeds(item))
    seed = getattr(waves, "seed", None)
    return () if seed is None else (int(seed),)


@kernel
def _elevation(waves, points, ramp, out):  # type: ignore[no-untyped-def]
    """out[p] = ramp factor times the sum of a cos(w t - kx x - ky y + phase); waves (n, 5), points (p, 3): x, y, t."""
    for p in range(points.shape[0]):
        total = 0.0
        for n in range(waves.shape[0]):
            total += waves[n, 0] * math.cos(
                waves[n, 1] * points[p, 2] - waves[n, 2] * points[p, 0] - waves[n, 3] * points[p, 1] + waves[n, 4]
            )
        out[p] = ramp_factor(points[p, 2], ramp) * total
