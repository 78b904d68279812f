"""Point floaters and sinkers: a point with mass, volume and drag, no rotation. Loads as of a line's attachment
(parts/attachment.py), wet over its own height:

    F = - m g + phi rho V g + phi 1/2 rho CdA |w| w + phi rho V (1 + Ca) a_f - (m + phi rho V Ca) a,   w = u - v

and the seabed under it as under a line (sea/seabed.py), on a given area, with the same friction in all directions.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from floatsim.description import NonNegative, Positive
from floatsim.frames import Array, at, dot, minus, vec
from floatsim.jit import kernel
from floatsim.parts.attachment import book_points, point_loads, sphere_height
from floatsim.parts.point_mass import PointMass
from floatsim.sea.seabed import DAMPING, SLIP, STIFFNESS, bed_height, friction, in_plane, touch

Index = NDArray[np.int64]

_ANY = (1.0, 0.0, 0.0)  # the bed's friction is the same in all directions


class PointBuoy(PointMass):
    """A floater or a sinker with three degrees of freedom. Connection point: `NAME`.

    mass [kg]; position [m]: drawing position. volume [m3]; drag_area [m2]: Cd times area, in any direction;
    added_mass [-]: share of rho volume (0.5 for a sphere). height [m], over which it goes under with a waterplane of
    volume/height; the diameter of the sphere of its volume if it is left out. bed_area [m2]: on which the seabed's
    pressure acts when its point goes below the bed, with the seabed's `friction`; 0: it does not touch the bed.
    """

    volume: Positive
    drag_area: NonNegative = 0.0
    added_mass: NonNegative = 0.0
    height: Positive | None = None
    bed_area: NonNegative = 0.0

    @staticmethod
    def batch() -> type[PointBuoyBatch]:  # type: ignore[override]
        return PointBuoyBatch

    @property
    def extent(self) -> float:
        """A length of it [m], for tolerances: over which it goes under."""
        return self.height or sphere_height(self.volume)

    def held_by_water(self, density: float) -> bool:
        """Whether it floats or lies on the bed, in water of this density [kg/m3]."""
        return self.mass < density * self.volume or self.bed_area > 0.0


@kernel
def point_contacts(x, v, c, points, area, bed, grid, mu, stick, slots, A, r, s):  # type: ignore[no-untyped-def]
    """Seabed under points: area (n) [m2]; bed, grid: sea/seabed.py; stick (n, 3): stick points; slots (n, 9)."""
    for e in range(points.shape[0]):
        p = points[e]
        here = vec(x, p)
        z, zx, zy = bed_height(bed, grid, here[0], here[1])
        lift, up, stiff, damp = touch(z, zx, zy, bed[STIFFNESS], bed[DAMPING], here, at(v, 3 * p), area[e])
        if lift == 0.0:
            continue
        kn = c[2] * stiff + c[1] * damp
        s[p] += lift
        rough = mu > 0.0 and c[7] != 0.0
        q, off, _, _, ratio = friction(here, up, vec(stick, e), _ANY, bed[SLIP], mu, mu)
        pull = c[2] * lift * mu / (bed[SLIP] * max(ratio, 1.0))
        sliding = 1.0 / dot(off, off) if ratio > 1.0 else 0.0
        for m in range(3):
            r[3 * p + m] -= lift * (up[m] - (q[m] if rough else 0.0))
            for n in range(3):
                k = kn * up[m] * up[n]
                if rough:
                    plane = (1.0 if m == n else 0.0) - up[m] * up[n]
                    k += pull * (plane - off[m] * off[n] * sliding) - q[m] * kn * up[n]
                A[slots[e, 3 * m + n]] += k


@kernel
def drag_points(x, v, points, area, bed, grid, stick):  # type: ignore[no-untyped-def]
    """Commit a step: stick points of what slides follow, those of what swims go with it."""
    for e in range(points.shape[0]):
        p = points[e]
        here = vec(x, p)
        z, zx, zy = bed_height(bed, grid, here[0], here[1])
        lift, normal, _, _ = touch(z, zx, zy, bed[STIFFNESS], bed[DAMPING], here, at(v, 3 * p), area[e])
        u = in_plane(normal, minus(here, vec(stick, e)))
        size = math.sqrt(dot(u, u))
        left = 0.0
        if lift > 0.0:
            left = min(1.0, bed[SLIP] / size) if size > 0.0 else 1.0
        for m in range(3):
            stick[e, m] = here[m] - left * u[m]


@kernel
def contact_powers(x, v, points, area, bed, grid, mu, stick, out):  # type: ignore[no-untyped-def]
    """out: energy of the bed and its rate, powers of its damper and of friction."""
    out[0] = out[1] = out[2] = out[3] = 0.0
    for e in range(points.shape[0]):
        p = points[e]
        here, vel = vec(x, p), at(v, 3 * p)
        z, zx, zy = bed_height(bed, grid, here[0], here[1])
        pressed, up, stiff, _ = touch(z, zx, zy, bed[STIFFNESS], 0.0, here, vel, area[e])
        lift, _, _, _ = touch(z, zx, zy, bed[STIFFNESS], bed[DAMPING], here, vel, area[e])
        if stiff > 0.0:
            out[0] += 0.5 * pressed * pressed / stiff
        out[1] -= pressed * dot(up, vel)
        out[2] += (lift - pressed) * dot(up, vel)
        if mu > 0.0 and lift > 0.0:
            q, _, _, _, _ = friction(here, up, vec(stick, e), _ANY, bed[SLIP], mu, mu)
            out[3] -= lift * dot(q, vel)


class PointBuoyBatch:
    """All point floaters and sinkers of a system. Memory: the points (n, 3) where the bed holds them."""

    runs: ClassVar[list[tuple[int, int]]] = []
    remembers: ClassVar[bool] = False

    def __init__(self, parts: Sequence[PointBuoy], first_point: Sequence[int], first_rotation: Sequence[int],
                 sea: Any, gravity: float) -> None:  # fmt: skip
        self.parts = tuple(parts)
        self.points = self.wet_points = np.array(first_point, dtype=np.int64)
        self.P = np.array([[p.mass, p.volume, p.drag_area, p.added_mass, p.extent]
                           for p in parts], dtype=float).T.copy()  # fmt: skip
        self.rho, self.gravity = float(sea.density), float(gravity)
        self.area = np.array([p.bed_area for p in parts])
        self.bed, self.grid = sea.seabed.parameters(sea.depth)
        self.mu = float(sea.seabed.friction)
        self.stick = np.zeros((len(parts), 3))

    def dofs(self, n_point: int) -> list[Index]:
        return [3 * self.points[:, None] + np.arange(3)]

    def bind(self, slots: list[Index]) -> None:
        (self._slots,) = slots

    def start(self, state: Any) -> Array:
        """Stick points where the points are now."""
        return np.array(state.x[self.points])

    def begin(self, w: Any, history: Array, t: float, state: Any) -> None:
        """The stick points of this step."""
        np.copyto(self.stick, history)

    def hold_back(self, w: Any, before: Array, after: Array) -> None:
        """Stick points of an equilibrium with friction: the old ones, dragged along where it slid."""
        np.copyto(after, before)
        self.commit(after, w)

    def commit(self, history: Array, w: Any) -> None:
        """Take in the accepted step."""
        drag_points(w.x, w.v, self.points, self.area, self.bed, self.grid, history)

    def add(self, w: Any) -> None:
        point_loads(w.x, w.v, w.a, w.u, w.du, w.eta, w.c, self.points, self.P, self.rho, self.gravity, self._slots,
                    w.A, w.r, w.s)  # fmt: skip
        point_contacts(w.x, w.v, w.c, self.points, self.area, self.bed, self.grid, self.mu, self.stick, self._slots,
                       w.A, w.r, w.s)  # fmt: skip

    def ledger(self, w: Any, book: Any) -> None:
        """As of points, and the bed under them."""
        book_points(w, book, self.points, self.P, self.rho, self.gravity)
        y = np.zeros(4)
        contact_powers(w.x, w.v, self.points, self.area, self.bed, self.grid, self.mu, self.stick, y)
        book.store("seabed", y[0], y[1])
        book.work("contact", y[2])
        book.work("friction", y[3])
