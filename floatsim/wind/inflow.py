"""The wind: a steady mean with a power-law profile, and turbulence on it.

    U(z) = U_ref (z/z_ref)^shear        for z > 0, else 0        (IEC 61400-1:2019, 6.3.2.2)

horizontal, towards one heading at all heights. z are the heights of the drawing position: what a platform heaves
changes the wind by less than anybody knows it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import field_validator

from floatsim.description import Description, Finite, NonNegative, Positive
from floatsim.frames import Array
from floatsim.wind.turbulence import Fluctuation


class Wind(Description):
    """Mean wind and turbulence.

    speed [m/s]: mean at `height` [m, above mean sea level; None: the rotor's hub]. heading_deg: towards which it
    blows, counter-clockwise from +x seen from above, as of waves and current. shear [-]: exponent of the power law;
    0.14 is usual offshore, 0 a uniform wind. turbulence: None or Kaimal(intensity=..., seed=...). density [kg/m3].
    """

    speed: NonNegative
    heading_deg: Finite = 0.0
    height: Positive | None = None
    shear: NonNegative = 0.0
    turbulence: Any = None
    density: Positive = 1.225

    @field_validator("turbulence")
    @classmethod
    def _is_turbulence(cls, value: Any) -> Any:
        if value is not None and (isinstance(value, type) or not callable(getattr(value, "realise", None))):
            raise ValueError(f"got {value!r:.60}; Kaimal(intensity=..., seed=...) or None is allowed")
        return value

    @property
    def duration(self) -> float:
        """Time [s] until which its turbulence does not repeat; inf without."""
        return math.inf if self.turbulence is None else float(self.turbulence.duration)

    @property
    def direction(self) -> Array:
        """Unit vector (3,), world, towards which it blows."""
        b = math.radians(self.heading_deg)
        return np.array([math.cos(b), math.sin(b), 0.0])

    def mean(self, z: float, hub: float) -> float:
        """Mean speed [m/s] at the height z [m]; hub [m]: height of the rotor's hub."""
        if z <= 0.0:
            return 0.0
        return float(self.speed * (z / (self.height or hub)) ** self.shear)

    def at_a_point(self) -> Inflow:
        """The wind at a point at the reference height."""
        still = self.turbulence is None or self.speed == 0.0
        return Inflow(self.speed, None if still else self.turbulence.realise(self.speed, 0.0))


@dataclass(frozen=True)
class Inflow:
    """Mean [m/s] and fluctuation (None: none) at one place."""

    mean: float
    fluctuation: Fluctuation | None

    def at(self, t: float, ramp: float = 0.0) -> float:
        """Wind speed [m/s] at time t [s]; ramp [s]: of the fluctuation at the start."""
        return self.mean if self.fluctuation is None else self.mean + self.fluctuation.at(t, ramp)
