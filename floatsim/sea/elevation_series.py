"""Waves from a measured elevation: a record at one point, taken apart into linear waves by Fourier transform.

With N samples eta_i at i dt, m their mean and X_j = sum (eta_i - m) exp(-2 pi i j n/N), n the sample's number,

    a_j = 2 abs(X_j)/N (half of that at the highest frequency, if N is even),   w_j = 2 pi j/(N dt),   j = 1 ... N/2,

so the sum of the waves, with the phases of X_j, goes through all the samples at the gauge. No window is applied.
Between the samples the series is continued trigonometrically; a jump from its last to its first value makes ripples
between the samples at its two ends. Away from the gauge, waves that have passed it before the record began or pass it
after its end are not known: at a distance s downstream the first s/c_g seconds are those of the record's end.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field, model_validator

from floatsim.description import Description, Finite, Name, NonNegative, Positive, Series, numbers
from floatsim.errors import ModelError
from floatsim.sea.dispersion import wave_number
from floatsim.sea.waves import Realisation

Array = NDArray[np.float64]

_UNEVEN = 0.01  # of the step, by which a sample's time may be off


class ElevationSeries(Description):
    """Long-crested waves that reproduce a measured elevation at a gauge, sample by sample.

    dt           s, between samples; the first is at t = 0 of the run
    elevation    m, upward; the mean is removed (`mean` tells it)
    position     (x, y), m, world, of the gauge
    heading_deg  degrees, towards which the waves travel: all of them
    omega_min    rad/s: waves below are left out (tide, drift of the gauge)
    omega_max    rad/s: waves above are left out (noise; `left_out` tells the share of variance of both)
    file         what it was read from, which then belongs to the inputs of a run; `read` sets it

    The record is as long as its samples: a run beyond the last one is refused, where the sum would start again.
    `ElevationSeries.from_times` takes measured times, `ElevationSeries.read` a file.
    """

    dt: Positive
    elevation: Annotated[Series, Field(min_length=4)]
    position: Annotated[tuple[float, float], numbers("two finite numbers (x, y)", 2)] = (0.0, 0.0)
    heading_deg: Finite = 0.0
    omega_min: NonNegative = 0.0
    omega_max: Positive | None = None
    file: str | None = None
    name: Name | None = None

    @model_validator(mode="after")
    def _consistent(self) -> ElevationSeries:
        if max(self.elevation) - min(self.elevation) == 0.0:
            raise ValueError(f"the elevation is {self.elevation[0]:g} m all the time; there are no waves")
        if not np.any(self._kept):
            w = self._omega
            raise ValueError(
                f"no wave of the record, {w[0]:.3g} to {w[-1]:.3g} rad/s in steps of {w[0]:.3g}, is between "
                f"omega_min {self.omega_min:g} and omega_max {self.omega_max:g} rad/s"
            )
        return self

    @classmethod
    def from_times(cls, time: ArrayLike, elevation: ArrayLike, **more: Any) -> ElevationSeries:
        """The series from times (s) and elevations (m); the first time becomes t = 0. `more`: the other arguments.

        Raises ModelError if the times are not evenly spaced within 1 % of a step.
        """
        given: dict[str, Any] = {"time": time, "elevation": elevation}
        rows = _Record(**given)
        t = np.array(rows.time)
        dt = (t[-1] - t[0]) / (t.size - 1)
        off = np.abs(t - t[0] - dt * np.arange(t.size))
        if not dt > 0.0 or off.max() > _UNEVEN * dt:
            i = int(off.argmax())
            raise ModelError(
                f"ElevationSeries: the times must be evenly spaced; {t.size} samples from {t[0]:g} to {t[-1]:g} s are "
                f"{dt:g} s apart on average, sample {i} is at {t[i]:g} s and not at {t[0] + i * dt:g} s. Interpolate "
                "the record to even steps"
            )
        return cls(dt=dt, elevation=rows.elevation, **more)

    @classmethod
    def read(
        cls, path: str | Path, *, time_column: int = 0, elevation_column: int = 1, time_unit: float = 1.0,
        elevation_unit: float = 1.0, **more: Any,
    ) -> ElevationSeries:  # fmt: skip
        """The series from a text file: rows of numbers, between blanks or commas.

        Columns count from 0. time_unit: seconds per unit of the file's times; elevation_unit: metres per unit of its
        elevations (0.001 for millimetres). Lines before the first that starts with a number are headings; lines that
        start with # are left out. `more`: the other arguments. Raises ModelError for a file that cannot be read so.
        """
        t, eta = _columns(Path(path), time_column, elevation_column)
        return cls.from_times(time_unit * t, elevation_unit * eta, file=str(path), **more)

    def __repr__(self) -> str:
        return f"ElevationSeries({len(self.elevation)} samples, {self.dt:g} s apart)"

    @property
    def mean(self) -> float:
        """Mean of the record, m, which is removed."""
        return float(np.mean(self.elevation))

    @property
    def left_out(self) -> float:
        """Share of the record's variance below omega_min and above omega_max."""
        a, _ = self._waves
        energy = a**2 * self._weight
        return float(1.0 - energy[self._kept].sum() / energy.sum())

    @property
    def duration(self) -> float:
        """Time of the last sample, s."""
        return self.dt * (len(self.elevation) - 1)

    @property
    def _omega(self) -> Array:
        n = len(self.elevation)
        return np.asarray(2.0 * np.pi / (n * self.dt) * np.arange(1, n // 2 + 1))

    @property
    def _weight(self) -> Array:
        """Twice the variance at the samples over the amplitude squared: 1, and 2 at the highest frequency."""
        n = len(self.elevation)
        return np.where(2 * np.arange(1, n // 2 + 1) == n, 2.0, 1.0)

    @property
    def _kept(self) -> NDArray[np.bool_]:
        w = self._omega
        return np.asarray((w >= self.omega_min) & (w <= (self.omega_max or math.inf)))

    @property
    def _waves(self) -> tuple[Array, Array]:
        """Amplitudes, m, and phases, rad, at the gauge, of all the waves of the record."""
        eta = np.array(self.elevation)
        X = np.fft.rfft(eta - eta.mean())[1:]
        return 2.0 / eta.size / self._weight * np.abs(X), np.angle(X)

    def realise(self, depth: float, gravity: float) -> Realisation:
        """The waves in `depth` (m, inf for deep water) under `gravity` (m/s2)."""
        kept, (a, phase) = self._kept, self._waves
        omega, b = self._omega[kept], math.radians(self.heading_deg)
        k = wave_number(omega, depth, gravity)
        along = self.position[0] * math.cos(b) + self.position[1] * math.sin(b)
        heading = np.full(omega.shape, b)
        return Realisation(a[kept], omega, k, heading, phase[kept] + k * along, depth, self.duration)


class _Record(Description):
    """The arguments of `ElevationSeries.from_times`."""

    time: Annotated[Series, Field(min_length=4)]
    elevation: Series

    @model_validator(mode="after")
    def _consistent(self) -> _Record:
        if len(self.time) != len(self.elevation):
            raise ValueError(f"elevation has {len(self.elevation)} values, time has {len(self.time)}")
        return self


_Record.__name__ = "ElevationSeries.from_times"  # the name its problems are reported under


def _columns(path: Path, *columns: int) -> tuple[Array, ...]:
    """Columns of a text file of numbers."""
    try:
        lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError as error:
        raise ModelError(f"ElevationSeries: {path} cannot be read: {error.strerror or error}") from None
    rows: list[list[float]] = []
    for number, line in enumerate(lines, 1):
        words = line.replace(",", " ").replace(";", " ").split()
        if not words or words[0].startswith("#"):
            continue
        try:
            rows.append([float(words[c]) for c in columns])
        except (ValueError, IndexError):
            if rows or _number(words[0]):
                wanted = " and ".join(str(c) for c in columns)
                raise ModelError(
                    f"ElevationSeries: {path}, line {number}: no numbers in columns {wanted} (counted from 0): {line!r}"
                ) from None
    if not rows:
        raise ModelError(f"ElevationSeries: {path} has no rows of numbers")
    return tuple(np.array(rows).T)


def _number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
