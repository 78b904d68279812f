"""Polyester rope: soft when loaded slowly, stiff under waves, longer once it has been pulled hard.

    T = T_s(z) + (A + B T_s(z)) (e - z) + c de/dt,        dz/dt = (e - z)/tau,        e = l/l0 - 1

e is the strain, z its slow part. Loaded slowly (against tau) z follows and T is the static curve T_s; at wave
frequencies z stands still and the rope has its dynamic stiffness A + B T_mean, which grows with the mean tension
(Francois & Davies 2008, OMAE2008-57136; the form with A and B is the field's, e.g. DNV-RP-E305).
With `permanent_share` p > 0 the static curve has the history of the Syrope model (Falkenberg, Lian & Ahjem 2017,
OMAE2017-61469): first loading follows the curve itself; after the largest slow strain z_max so far, the rope works on

    T_s(z) = T_max ((z - p z_max)/((1 - p) z_max))^m   between p z_max and z_max, nothing below,

so that a share p of the largest stretch stays. The exact step of the filter over h for a strain that
changes evenly is used; z and z_max are committed with the step. In statics z = e.

What the rope stores, U = int_0^z T_s + T_s (e - z) + (A + B T_s)(e - z)^2/2, has T (without the damper) as its
derivative by e; what it gives by z is lost, - dU/dz dz/dt = ((A + B T_s - T_s')(e - z) - B T_s'(e - z)^2/2) dz/dt. So
is, on first loading of a rope with a permanent share, what the working curve does not hold of the curve's own work.
"""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np
from pydantic import model_validator

from floatsim.description import Description, NonNegative, Positive, Series
from floatsim.frames import Array
from floatsim.jit import kernel
from floatsim.laws.tension_table import LEFT, integral, rising, table


@kernel
def static_curve(x, y, p, m, z, top):  # type: ignore[no-untyped-def]
    """(T_s, dT_s/dz) at slow strain z after a largest slow strain `top`."""
    if p <= 0.0 or z >= top or top <= 0.0:
        return table(x, y, z)
    T, _ = table(x, y, top)
    share = (z - p * top) / ((1.0 - p) * top)
    if share <= 0.0:
        return LEFT * T / top * (z - p * top), LEFT * T / top
    return T * share**m, m * T * share ** (m - 1.0) / ((1.0 - p) * top)


@kernel
def static_dynamic(x, y, k, c, s, rate, old, new, h, out):  # type: ignore[no-untyped-def]
    """k: A, B, tau, p, m. old, new (3, n): e, z, z_max before and after the step of h (below 0: statics)."""
    A, B, tau, p, m = k[0], k[1], k[2], k[3], k[4]
    # with y = e - z and e even over the step: y1 = f y0 + g (e1 - e0)
    f = math.exp(-h / tau)
    g = (1.0 - f) * tau / h if h > 0.0 else 1.0
    for j in range(s.shape[0]):
        e = s[j] - 1.0
        z, dz = e, 1.0
        if h >= 0.0:
            z = e - g * (e - old[0, j]) - f * (old[0, j] - old[1, j])
            dz = 1.0 - g
        top = old[2, j]
        Ts, ks = static_curve(x, y, p, m, z, top)
        stiff = A + B * max(Ts, 0.0)
        out[0, j] = Ts + stiff * (e - z) + c[j] * rate[j]
        slope = ks * dz
        out[1, j] = slope + stiff * (1.0 - dz) + (B * slope * (e - z) if Ts > 0.0 else 0.0)
        out[2, j] = c[j]
        new[0, j], new[1, j], new[2, j] = e, z, max(top, z)


class StaticDynamic(Description):
    """strain [-], tension [N]: the static curve (at least two points). dynamic_stiffness [N]: A; per_tension [-]: B;
    relaxation_time [s]: tau. permanent_share [-]: p, 0 for a rope without memory of its largest load;
    working_exponent [-]: m."""

    strain: Series
    tension: Series
    dynamic_stiffness: Positive
    per_tension: NonNegative = 0.0
    relaxation_time: Positive = 600.0
    permanent_share: NonNegative = 0.0
    working_exponent: Positive = 1.5

    memory: ClassVar[int] = 3

    @model_validator(mode="after")
    def _usable(self) -> StaticDynamic:
        rising("strain", self.strain, "tension", self.tension)
        if self.permanent_share >= 1.0:
            raise ValueError(f"permanent_share is {self.permanent_share:g}; below 1 is allowed")
        if self.working_exponent < 1.0:
            raise ValueError(f"working_exponent is {self.working_exponent:g}; at least 1 is allowed, below it a slack "
                             "rope would be stiffest")  # fmt: skip
        for T, slope in zip(self.tension[:-1], np.diff(self.tension) / np.diff(self.strain), strict=True):
            if self.dynamic_stiffness + self.per_tension * max(T, 0.0) < slope * (1.0 - 1e-9):
                raise ValueError(
                    f"the dynamic stiffness is {self.dynamic_stiffness + self.per_tension * max(T, 0.0):g} N at "
                    f"{T:g} N, the static curve's slope there {slope:g} N; the dynamic one must not be less, the rope "
                    "would give out energy"
                )
        return self

    @property
    def stiffness(self) -> float:
        """Dynamic stiffness at the largest tension of the table [N]."""
        return max(self.dynamic_stiffness + self.per_tension * self.tension[-1],
                   float(np.max(np.diff(self.tension) / np.diff(self.strain))))  # fmt: skip

    def bind(self, damping: Array) -> Any:
        """The law for elements with these dampings [N s]: a function (s, rate, old, new, h, out)."""
        x, y = np.array(self.strain), np.array(self.tension)
        k = np.array([self.dynamic_stiffness, self.per_tension, self.relaxation_time, self.permanent_share,
                      self.working_exponent])  # fmt: skip

        def evaluate(s: Array, rate: Array, old: Array, new: Array, h: float, out: Array) -> None:
            static_dynamic(x, y, k, damping, s, rate, old, new, h, out)

        return evaluate

    def start(self, s: Array) -> Array:
        """Memory (3, n) of a rope that has long been at these stretches and never longer."""
        e = s - 1.0
        return np.array([e, e, np.maximum(e, 0.0)])

    def energy(self, s: Array, new: Array) -> tuple[Array, Array]:
        """(energy stored [J/m], power lost besides the damper's [W/m]) per unstretched length; new (3, n): memory."""
        x, y = np.array(self.strain), np.array(self.tension)
        A, B, p, m = self.dynamic_stiffness, self.per_tension, self.permanent_share, self.working_exponent
        e, z, top = s - 1.0, new[1], new[2]
        lag, dz = e - z, (e - z) / self.relaxation_time
        T, slope = np.array([static_curve(x, y, p, m, *pair) for pair in zip(z, top, strict=True)]).T
        U, plastic = integral(x, y, z), np.zeros(len(z))
        if p > 0.0:
            T_top, k_top = np.array([table(x, y, value) for value in top]).T
            room = np.where(top > 0.0, (1.0 - p) * top, 1.0)
            share = (z - p * top) / room
            work = T_top * room / (m + 1.0) * np.maximum(share, 0.0) ** (m + 1.0)
            slack = 0.5 * LEFT * T_top / np.where(top > 0.0, top, 1.0) * (z - p * top) ** 2
            U = np.where(top > 0.0, np.where(share > 0.0, work, slack), U)
            first = (z >= top) & (top > 0.0) & (dz > 0.0)
            plastic = np.where(first, T_top - (1.0 - p) / (m + 1.0) * (k_top * top + T_top), 0.0)
        up = np.where(T > 0.0, B * slope, 0.0)
        K = A + B * np.maximum(T, 0.0)
        return U + T * lag + 0.5 * K * lag**2, (plastic + (K - slope) * lag - 0.5 * up * lag**2) * dz
