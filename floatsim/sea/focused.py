"""Focused wave groups (NewWave): the most probable elevation around a high crest of a given sea.

Around a crest of height A, high against the standard deviation, a Gaussian sea looks on average like A times its own
autocorrelation, and varies about that by its own standard deviation only (Lindgren 1970; Boccotti 1983; for design
waves Tromans, Anaturk & Hagemeijer 1991):

    eta(s, t) = A/m0 int S(w) cos(w (t - t0) - k (s - s0)) dw,      m0 = int S(w) dw,

s along the heading, s0 and t0 the place and time of the focus, k(w) by the dispersion relation. Linear, long-crested.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from pydantic import model_validator

from floatsim.description import Description, Finite, Name, Positive, numbers
from floatsim.errors import ModelError
from floatsim.sea.dispersion import wave_number
from floatsim.sea.waves import Realisation, SpectrumField, cumulative_energy

_LOW, _HIGH = 1e-4, 1e-3  # shares of the energy left out below and above
_TOO_LONG = 0.01  # share of the energy below half a step
_MOST = 20000  # components


class FocusedWave(Description):
    """Focused NewWave group; its form is printed at the top of this module.

    spectrum     one of floatsim.sea.SPECTRA or any object with density(omega); only its shape counts, not its hs
    crest        m, elevation at the focus: exactly this in linear theory; negative for a trough
    time         s, of the focus. Not before the end of Sea.wave_ramp, which would lower the crest; Sea refuses that
    position     (x, y), m, world, of the focus
    heading_deg  degrees, towards which the waves travel
    duration     s, of the run; twice `time` unless given
    omega_max    rad/s: the spectrum is cut here, for instance at the end of a hydrodynamic database

    The frequencies are multiples of one step, the waves' heights the energy in the steps around them. A sum like that
    repeats, after 2 pi/step: here twice the longer of the times from the focus to either end of the run. So every
    instant of the run is nearer to the focus than to its repetition, and the number of waves follows. 1e-4 of
    the energy in the longest and 1e-3 in the shortest waves are left out before the crest is set.
    """

    spectrum: SpectrumField
    crest: Finite
    time: Positive
    position: Annotated[tuple[float, float], numbers("two finite numbers (x, y)", 2)] = (0.0, 0.0)
    heading_deg: Finite = 0.0
    duration: Positive | None = None
    omega_max: Positive | None = None
    name: Name | None = None

    @model_validator(mode="after")
    def _consistent(self) -> FocusedWave:
        if self.crest == 0.0:
            raise ValueError("crest is 0 m; there is no wave without height")
        if self.duration is not None and self.duration <= self.time:
            raise ValueError(f"duration ({self.duration:g} s) must be longer than the time of focus ({self.time:g} s)")
        return self

    @property
    def focus_time(self) -> float:
        """Time, s, by which a ramp of the waves must be over."""
        return self.time

    @property
    def repeats_after(self) -> float:
        """Time, s, after which the group comes again at the place of focus."""
        return 2.0 * max(self.time, self._end - self.time)

    @property
    def _end(self) -> float:
        return 2.0 * self.time if self.duration is None else self.duration

    def realise(self, depth: float, gravity: float) -> Realisation:
        """The group in `depth` (m, inf for deep water) under `gravity` (m/s2).

        Raises ModelError if the spectrum has no energy or a density that is negative or not finite, if the duration
        needs more than 20 000 waves, or if the run is too short for the longest waves.
        """
        label = "FocusedWave" + (f" '{self.name}'" if self.name else "")
        grid, energy = cumulative_energy(self.spectrum, self.omega_max, label)
        step = 2.0 * math.pi / self.repeats_after
        ends = np.interp(np.array([_LOW, 1.0 - _HIGH]) * energy[-1], energy, grid)
        longer = float(np.interp(0.5 * step, grid, energy) / energy[-1])
        if longer > _TOO_LONG:
            raise ModelError(
                f"{label}: {100.0 * longer:.0f} % of the energy is in waves longer than {4.0 * math.pi / step:.0f} s, "
                "which cannot be told apart in so short a run; give a later time of focus"
            )
        first, last = max(round(ends[0] / step), 1), max(round(ends[1] / step), 1)
        if self.omega_max is not None and first < last and last * step > self.omega_max:
            last -= 1
        if last - first >= _MOST:
            raise ModelError(
                f"{label}: a group that does not repeat within {self.repeats_after:.0f} s, with waves up to "
                f"{ends[1]:.3g} rad/s, is made of {last - first + 1} waves ({_MOST} allowed); shorten the duration or "
                "cut the spectrum by omega_max"
            )
        j = np.arange(first, last + 1)
        share = np.diff(np.interp(np.append(j - 0.5, last + 0.5) * step, grid, energy))
        j, share = j[share > 0.0], share[share > 0.0]
        omega = step * j
        k, b = wave_number(omega, depth, gravity), math.radians(self.heading_deg)
        along = self.position[0] * math.cos(b) + self.position[1] * math.sin(b)
        phase = k * along - omega * self.time + (math.pi if self.crest < 0.0 else 0.0)
        a = abs(self.crest) * share / share.sum()
        return Realisation(a, omega, k, np.full(a.shape, b), phase, depth, self._end)
