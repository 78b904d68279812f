"""The sea around a model: depth, density, seabed, current, waves."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from floatsim.description import Description, Finite, NonNegative, Positive
from floatsim.frames import Array
from floatsim.sea.seabed import Seabed


class Current(Description):
    """Steady current, the same at all depths. speed [m/s], heading_deg: towards, from +x to +y."""

    speed: NonNegative
    heading_deg: Finite = 0.0

    @property
    def velocity(self) -> Array:
        """World components (3,) [m/s]."""
        b = math.radians(self.heading_deg)
        return self.speed * np.array([math.cos(b), math.sin(b), 0.0])


class Sea(Description):
    """Water of `depth` [m] and `density` [kg/m3] with a seabed, a current and waves.

    waves: None (still water) or a description from `floatsim.sea` (RegularWave, IrregularWaves,
    WaveComponents). wave_ramp [s]: cosine ramp of the wave loads at the start of a run.
    """

    depth: Positive
    density: Positive = 1025.0
    seabed: Seabed = Seabed()
    current: Current = Current(speed=0.0)
    waves: Any = None
    wave_ramp: NonNegative = 100.0
