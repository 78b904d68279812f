"""The sea around a model: depth, density, seabed, current, waves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field, model_validator

from floatsim.description import Description, Finite, NonNegative, Positive, Series
from floatsim.frames import Array
from floatsim.jit import kernel
from floatsim.sea.seabed import Seabed

Stretching = Literal["vertical", "wheeler", "extrapolation"]


class PowerLaw(Description):
    """Speed falling with depth as (1 + z/d)^exponent, z from the surface (0) to the bed (-d); above as at z = 0.

    exponent [-]: 1/7 is usual for tidal currents (DNV-RP-C205 4.1.4).
    """

    exponent: Positive = 1.0 / 7.0


class CurrentTable(Description):
    """Current against depth, relative to a reference, which is the `Current` it belongs to.

    depths [m]: below mean sea level, downwards. factors [-]: of the reference speed. turns_deg: added to its heading,
    counter-clockwise seen from above, zero if left out. Both are linear between the rows, the turn by the shorter way
    round, and constant above the first and below the last.
    """

    depths: Annotated[Series, Field(min_length=1)]
    factors: Series
    turns_deg: Series | None = None

    @model_validator(mode="after")
    def _consistent(self) -> CurrentTable:
        for key in ("factors", "turns_deg"):
            row = getattr(self, key)
            if row is not None and len(row) != len(self.depths):
                raise ValueError(f"{key} has {len(row)} values, depths has {len(self.depths)}")
        if min(self.depths) < 0.0:
            raise ValueError(f"depths has {min(self.depths):g} m; depths are positive, downwards from mean sea level")
        if any(b <= a for a, b in pairwise(self.depths)):
            raise ValueError(f"depths {self.depths} must increase")
        if min(self.factors) < 0.0:
            raise ValueError(f"factors has {min(self.factors):g}; turn the current by turns_deg = 180 instead")
        return self


class Current(Description):
    """Steady horizontal current. speed [m/s], heading_deg: towards, from +x to +y, both at the surface (with a table:
    the reference of its factors and turns).

    profile: None (the same at all depths), PowerLaw() or a CurrentTable; `Current.table` takes measured speeds and
    headings as they are.
    """

    speed: NonNegative
    heading_deg: Finite = 0.0
    profile: PowerLaw | CurrentTable | None = None

    @classmethod
    def table(
        cls, *, depths: Sequence[float], speeds: Sequence[float], headings_deg: Sequence[float] | float = 0.0
    ) -> Current:
        """Current of `speeds` [m/s] towards `headings_deg` (one for all, or one each) at `depths` [m] below mean sea
        level. See CurrentTable for what is between. Raises ModelError for rows that do not fit together."""
        given: dict[str, Any] = {"depths": depths, "speeds": speeds, "headings_deg": headings_deg}
        rows = _Measured(**given)
        h = rows.headings_deg
        headings = h if isinstance(h, tuple) else (h,) * len(rows.speeds)
        fastest = max(rows.speeds)
        return cls(
            speed=fastest,
            heading_deg=headings[0],
            profile=CurrentTable(
                depths=rows.depths,
                factors=tuple(y / fastest if fastest else 0.0 for y in rows.speeds),
                turns_deg=tuple(y - headings[0] for y in headings),
            ),
        )

    @property
    def velocity(self) -> Array:
        """World components (3,) [m/s] at the surface."""
        return self.at([0.0], math.inf)[0]

    def at(self, z: ArrayLike, depth: float) -> Array:
        """World components (n, 3) [m/s] at the heights z (n,) [m, up from mean sea level] in water of `depth` [m]."""
        heights = np.asarray(z, dtype=np.float64)
        table, exponent = self.packed()
        out = np.zeros((heights.size, 3))
        for i, y in enumerate(heights):
            out[i, :2] = current_at(y, depth, table, exponent)
        return out

    def packed(self) -> tuple[Array, float]:
        """What `current_at` needs: rows of height [m], speed [m/s] and heading [rad], downwards, and the exponent."""
        b = math.radians(self.heading_deg)
        if isinstance(self.profile, CurrentTable):
            turns = np.unwrap(np.radians(self.profile.turns_deg or [0.0] * len(self.profile.depths)))
            rows = [-np.array(self.profile.depths), self.speed * np.array(self.profile.factors), b + turns]
            return np.ascontiguousarray(np.transpose(rows)), 0.0
        return np.array([[0.0, self.speed, b]]), self.profile.exponent if self.profile else 0.0


class _Measured(Description):
    """The arguments of `Current.table`."""

    depths: Annotated[Series, Field(min_length=1)]
    speeds: Series
    headings_deg: Finite | Series

    @model_validator(mode="after")
    def _consistent(self) -> _Measured:
        for key in ("speeds", "headings_deg"):
            row = getattr(self, key)
            if isinstance(row, tuple) and len(row) != len(self.depths):
                raise ValueError(f"{key} has {len(row)} values, depths has {len(self.depths)}")
        if min(self.speeds) < 0.0:
            raise ValueError(f"speeds has {min(self.speeds):g} m/s; turn the current by its heading instead")
        return self


_Measured.__name__ = "Current.table"  # the name its problems are reported under


@kernel
def current_at(z, depth, table, exponent):  # type: ignore[no-untyped-def]
    """Horizontal components of the current at height z, from `Current.packed`."""
    speed, heading = table[0, 1], table[0, 2]
    if table.shape[0] > 1 and z < table[0, 0]:
        i = 1
        while i < table.shape[0] - 1 and z < table[i, 0]:
            i += 1
        share = min((table[i - 1, 0] - z) / (table[i - 1, 0] - table[i, 0]), 1.0)
        speed += share * (table[i, 1] - table[i - 1, 1]) + table[i - 1, 1] - table[0, 1]
        heading += share * (table[i, 2] - table[i - 1, 2]) + table[i - 1, 2] - table[0, 2]
    if exponent > 0.0 and z < 0.0:
        speed *= max(1.0 + z / depth, 0.0) ** exponent
    return speed * math.cos(heading), speed * math.sin(heading)


class Sea(Description):
    """Water of `depth` [m] and `density` [kg/m3] with a seabed, a current and waves.

    waves: None (still water) or a description from `floatsim.sea` (RegularWave, IrregularWaves, WaveComponents,
    FocusedWave, ElevationSeries, CombinedWaves). wave_ramp [s]: cosine ramp of the wave loads at the start of a run;
    refused if it is not over when a group focuses. stretching: how the waves' motion is continued to the instantaneous
    surface, `vertical`, `wheeler` or `extrapolation`; see sea/kinematics.py.
    """

    depth: Positive
    density: Positive = 1025.0
    seabed: Seabed = Seabed()
    current: Current = Current(speed=0.0)
    waves: Any = None
    wave_ramp: NonNegative = 100.0
    stretching: Stretching = "vertical"

    @model_validator(mode="after")
    def _ramp_over(self) -> Sea:
        focus = getattr(self.waves, "focus_time", math.inf)
        if focus < self.wave_ramp:
            raise ValueError(
                f"wave_ramp is {self.wave_ramp:g} s, but the waves focus at {focus:g} s; the ramp would lower the "
                "crest. Give a shorter wave_ramp or a later time of focus"
            )
        return self
