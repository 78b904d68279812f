"""A wind turbine's rotor on a body: thrust, torque and gyroscopic moment from a performance surface.

n is the shaft's direction, downwind, fixed in the body, r the arm of the hub, W the wind averaged over the rotor, w and
alpha the body's angular velocity and acceleration. The wind along the shaft relative to the hub

    u = n . (W - v - w x r)

gives thrust T and torque by the surface (rotor/surface.py); tilt, yaw misalignment and the platform's attitude enter by
this projection alone, the part of the wind in the rotor's plane does nothing. On the body act

    F = T n at the hub,        M = Q_g n + J (n . alpha) n - J O w x n :

the generator's reaction and the change of the spin's angular momentum J O n, in which the body's own inertia already
contains the rotor turning with it, so that the shaft's inertia J is taken out again about n. With J (O' + n . alpha) =
Q - Q_g (rotor/operation.py) the moment about the shaft of body and rotor together is the aerodynamic one. The rotor
turns clockwise seen from upwind: right-handed about n.

W is the mean wind at the hub (shear across the disc does nothing to its mean that matters: 0.2 % for an exponent of
0.14) and its turbulence averaged over the disc (wind/turbulence.py), which rises with the ramp of the waves. The
nacelle faces the mean wind, and does not turn. Rotor speed is a state: thrust never follows the curve of steady winds.

Statics take the steady operating point for the relative wind, and what turns starts there.

Another model of a rotor is another part with these outputs; the system asks for nothing beyond the protocol of parts.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from floatsim.description import Finite, Name, NonNegative, Positive, Vector3
from floatsim.errors import ModelError
from floatsim.frames import Array, at, cross, dot, minus, plus, rotate, set_matrix, times, unit
from floatsim.jit import kernel
from floatsim.parts.part import Output, Part
from floatsim.parts.tower import Tower, TowerDrag
from floatsim.rotor.control import INERTIA, LARGEST, PRESSURE, RADIUS, RATED, TORQUE, Controller, generator_torque
from floatsim.rotor.operation import FILTER, INTEGRATOR, PITCH, SPEED, STATES, advance, rates, steady
from floatsim.rotor.surface import PerformanceSurface, loads

Index = NDArray[np.int64]

# rows of what a rotor is told at every step, and of what it tells
STEP, STILL, STANDING, DRAG, WIND, ARM, AXIS, GIVEN = 0, 1, 2, 3, 4, 7, 10, 13
OUT_SPEED, OUT_PITCH, OUT_THRUST, OUT_TORQUE, OUT_RELATIVE, TOLD = range(6)
BLOWN = STATES  # column of the memory
_TEXT = (  # suffix, what, units
    ("speed", "speed of rotor {}, relative to its nacelle", "rad/s"),
    ("pitch", "blade pitch of rotor {}", "rad"),
    ("thrust", "thrust of rotor {} along its shaft, downwind positive", "N"),
    ("torque", "generator torque of rotor {}", "N m"),
    ("power", "electrical power of rotor {}: generator torque times speed times efficiency", "W"),
    ("wind_speed", "undisturbed wind, averaged over the disc of rotor {}", "m/s"),
    ("relative_wind", "wind along the shaft relative to the hub of rotor {}", "m/s"),
)


class Mounted(NamedTuple):
    """Point, rotation, arm of the hub and direction of the shaft in body axes, height of the hub as drawn [m]."""

    point: int
    rotation: int
    arm: Array
    axis: Array
    hub: float


class Rotor(Part):
    """A rotor with its generator and controller on the body (or connection point) `body`.

    surface: PerformanceSurface. controller: Controller. inertia [kg m2]: of all that turns, about the shaft, which the
    body's own inertia contains too. generator_efficiency: electrical over mechanical power.
    tower_top [m]: the yaw axis at the tower's top, from the body's reference point, body axes; shaft_height [m]: from
    there up to the shaft at the yaw axis; overhang [m]: from there upwind along the shaft to the hub; tilt_deg: by
    which the shaft rises upwind. yaw_misalignment_deg: nacelle's heading less the mean wind's, counter-clockwise.
    The body is drawn upright, its yaw counts. cut_in, cut_out [m/s]: with a mean wind at the hub outside of these the
    rotor stands still, feathered, with `parked_drag_area` [m2] (C_D A of rotor and nacelle) at the hub. tower: None or
    the Tower it stands on, for drag.
    """

    name: Name
    body: str
    surface: PerformanceSurface
    controller: Controller
    inertia: Positive
    tower_top: Vector3
    shaft_height: NonNegative = 0.0
    overhang: Finite = 0.0
    tilt_deg: Finite = 0.0
    yaw_misalignment_deg: Finite = 0.0
    generator_efficiency: Positive = 1.0
    cut_in: NonNegative = 3.0
    cut_out: Positive = 25.0
    parked_drag_area: NonNegative = 0.0
    tower: Tower | None = None

    needs_wind: ClassVar[bool] = True

    @model_validator(mode="after")
    def _sensible(self) -> Rotor:
        if self.cut_in >= self.cut_out:
            raise ValueError(f"cut_in is {self.cut_in:g} m/s, cut_out {self.cut_out:g} m/s; the first must be smaller")
        if self.generator_efficiency > 1.0:
            raise ValueError(f"generator_efficiency: got {self.generator_efficiency:g}; must not exceed 1")
        for key, most in (("tilt_deg", 45.0), ("yaw_misalignment_deg", 90.0)):
            if abs(getattr(self, key)) >= most:
                raise ValueError(f"{key}: got {getattr(self, key):g}; must be less than {most:g} either way")
        return self

    @staticmethod
    def batch() -> type[RotorBatch]:
        return RotorBatch

    @property
    def between(self) -> tuple[Any, ...]:
        return (self.body,)

    def children(self) -> list[Any]:
        """The drag of its tower."""
        return [] if self.tower is None else [TowerDrag(name=f"{self.name}_tower", rotor=self, tower=self.tower)]

    def shaft(self, heading: float) -> tuple[Array, Array]:
        """(arm of the hub from the connection point [m], direction of the shaft), (3,) each, in the axes that `heading`
        [rad] counts in: towards which the nacelle's downwind side points."""
        tilt = math.radians(self.tilt_deg)
        b = heading + math.radians(self.yaw_misalignment_deg)
        n = np.array([math.cos(tilt) * math.cos(b), math.cos(tilt) * math.sin(b), -math.sin(tilt)])
        return np.array(self.tower_top) + (0.0, 0.0, self.shaft_height) - self.overhang * n, n

    def mount(self, numbering: Any) -> Mounted:
        """Where its hub stands as drawn. Raises ModelError if it is on nothing that can turn."""
        place = numbering.place(self.body)
        if place.rotation >= numbering.n_rotation:
            raise ModelError(f"Rotor '{self.name}': body: '{self.body}' has no attitude; a body is needed")
        R = numbering.R0[place.rotation]
        arm, axis = self.shaft(math.radians(numbering.wind.heading_deg) - math.atan2(R[1, 0], R[0, 0]))
        arm = arm + place.arm
        return Mounted(place.point, place.rotation, arm, axis, float((numbering.x0[place.point] + R @ arm)[2]))


@kernel
def relative(x, R, v, a, point, turn, g):  # type: ignore[no-untyped-def]
    """(r, n, wind relative to the hub, hub velocity, u, hub velocity along n, acceleration about n), world axes."""
    base = 3 * x.shape[0]
    r, n = rotate(R, turn, at(g, ARM)), rotate(R, turn, at(g, AXIS))
    hub = plus(at(v, 3 * point), cross(at(v, base + 3 * turn), r))
    wind = minus(at(g, WIND), hub)
    return r, n, wind, hub, dot(wind, n), dot(hub, n), dot(at(a, base + 3 * turn), n)


@kernel
def begin_rotor(x, R, v, a, point, turn, g, P, S, gx, gy, gains, fine, y, before):  # type: ignore[no-untyped-def]
    """Rates of the states at the start of a step."""
    _, _, _, _, u, along, turning = relative(x, R, v, a, point, turn, g)
    rates(P, S, gx, gy, gains, fine, y, u, along, turning, before)


@kernel
def rotor_loads(x, R, v, a, c, point, turn, g, P, S, gx, gy, gains, fine, y, before, slots, new, D, K, A, r, s, told):  # type: ignore[no-untyped-def]
    """Residual and matrix of one rotor; its states at the step's end into `new`, what it tells into `told`. False if
    the states are not found. g (GIVEN,): see the rows above; slots (36,)."""
    base = 3 * x.shape[0]
    arm, n, wind, hub, u, along, turning = relative(x, R, v, a, point, turn, g)
    w, al = at(v, base + 3 * turn), at(a, base + 3 * turn)
    J = P[INERTIA]
    Tc = Ta = Gc = Ga = Ou = Oc = Oa = 0.0
    good, standing = True, g[STANDING] > 0.0
    drag = size = 0.0
    if standing:
        T = G = Tu = Gu = speed = 0.0
        pitch, J = P[LARGEST], 0.0
        size = math.sqrt(dot(wind, wind))
        drag = g[DRAG] * size
    elif g[STILL] > 0.0:
        speed, pitch, T, G, Tu, Gu, Ou = steady(P, S, gx, gy, fine, u)
    else:
        h = g[STEP]
        if h == 0.0:
            for k in range(STATES):
                new[k] = y[k]
            D[0, 0] = D[0, 1] = D[0, 2] = D[1, 0] = D[1, 1] = D[1, 2] = 0.0
        else:
            good = advance(P, S, gx, gy, gains, fine, y, before, h, u, along, turning, new, D)
        speed, pitch = new[SPEED], new[PITCH]
        _, _, _, _, T, Tu, To, Tp = loads(S, gx, gy, P[PRESSURE], P[RADIUS], u, speed, pitch)
        G, Go = generator_torque(P, speed)
        Tu, Tc, Ta = Tu + To * D[0, 0] + Tp * D[1, 0], To * D[0, 1] + Tp * D[1, 1], To * D[0, 2] + Tp * D[1, 2]
        Gu, Gc, Ga = Go * D[0, 0], Go * D[0, 1], Go * D[0, 2]
        Ou, Oc, Oa = D[0, 0], D[0, 1], D[0, 2]
    told[0], told[1], told[2], told[3], told[4] = speed, pitch, T, G, u
    F = plus(times(T, n), times(drag, wind))
    wn = cross(w, n)
    M = plus(cross(arm, F), minus(times(G + J * turning, n), times(J * speed, wn)))
    for m in range(3):
        r[3 * point + m] -= F[m]
        r[base + 3 * turn + m] -= M[m]
    s[point] += abs(T) + drag * size
    s[x.shape[0] + turn] += (abs(T) + drag * size) * math.sqrt(dot(arm, arm)) + abs(G)
    s[x.shape[0] + turn] += J * (abs(turning) + abs(speed) * math.sqrt(dot(w, w)))
    if c[6] == 0.0:
        return good
    zero = (0.0, 0.0, 0.0)
    for column in range(6):
        e = unit(column % 3)
        moves = column < 3
        # changes of the hub's velocity by the velocity, and of everything by the turn of this column
        dv = times(c[1], e if moves else cross(e, arm))
        dw = zero if moves else times(c[1], e)
        da = zero if moves else times(c[0], e)
        dn, darm = zero, zero
        if not moves:
            dn, darm = times(c[2], cross(e, n)), times(c[2], cross(e, arm))
            dv = plus(dv, cross(w, darm))
        du = dot(wind, dn) - dot(dv, n)
        dalong = dot(hub, dn) + dot(dv, n)
        dturning = dot(da, n) + dot(al, dn)
        dT = Tu * du + Tc * dalong + Ta * dturning
        dG = Gu * du + Gc * dalong + Ga * dturning
        dO = Ou * du + Oc * dalong + Oa * dturning
        dF = plus(times(dT, n), times(T, dn))
        if drag > 0.0:
            dF = minus(dF, plus(times(drag, dv), times(drag * dot(wind, dv) / (size * size), wind)))
        dM = plus(cross(darm, F), cross(arm, dF))
        dM = plus(dM, plus(times(dG + J * dturning, n), times(G + J * turning, dn)))
        dM = minus(dM, plus(times(J * dO, wn), times(J * speed, plus(cross(dw, n), cross(w, dn)))))
        for m in range(3):
            K[m, column], K[3 + m, column] = -dF[m], -dM[m]
    for p in range(6):
        for q in range(6):
            A[slots[6 * p + q]] += K[p, q]
    return good


class RotorBatch:
    """All rotors of a system. Memory (n, 5): their states after the last accepted step, and its wind (nan before)."""

    runs: ClassVar[list[tuple[int, int]]] = []
    remembers: ClassVar[bool] = True

    def __init__(self, parts: Sequence[Rotor], first_point: Sequence[int], first_rotation: Sequence[int],
                 sea: Any, gravity: float) -> None:  # fmt: skip
        self.parts = tuple(parts)
        n = len(self.parts)
        self._ramp = sea.wave_ramp
        self.given, self.told = np.zeros((n, GIVEN)), np.zeros((n, TOLD))
        self.new, self._before = np.zeros((n, STATES)), np.zeros((n, STATES))
        self.wind_speed = np.zeros(n)
        self._D, self._K = np.zeros((2, 3)), np.zeros((6, 6))

    def connect(self, numbering: Any) -> None:
        """Where the hubs are, what wind they stand in, and what follows from both."""
        wind = numbering.wind
        self.mounted = [part.mount(numbering) for part in self.parts]
        self.direction = wind.direction
        self.mean = np.array([wind.mean(place.hub, place.hub) for place in self.mounted])
        self.fluctuation = []
        self.data: list[tuple[Array, ...]] = []
        for part, place, mean, g in zip(self.parts, self.mounted, self.mean, self.given, strict=True):
            runs = part.cut_in <= mean <= part.cut_out
            turbulent = wind.turbulence is not None and mean > 0.0
            self.fluctuation.append(wind.turbulence.realise(mean, part.surface.radius) if turbulent else None)
            area = 0.5 * wind.density * math.pi * part.surface.radius**2
            P = part.controller.packed(area, part.surface.radius, part.inertia)
            surface = part.surface.packed()
            self.data.append((P, *surface, part.controller.gains(surface, P), part.controller.fine()))
            g[STANDING], g[DRAG] = float(not runs), 0.5 * wind.density * part.parked_drag_area
            g[ARM : ARM + 3], g[AXIS : AXIS + 3] = place.arm, place.axis
            most = loads(*surface, area, part.surface.radius, mean, P[RATED], P[LARGEST])[0]
            if runs and most > P[TORQUE]:
                raise ModelError(
                    f"Rotor '{part.name}': at {mean:g} m/s it has {most:.4g} N m at rated speed and maximum_pitch_deg "
                    f"{part.controller.maximum_pitch_deg:g}, more than rated_torque; give a lower cut_out or more pitch"
                )
        self._R = np.zeros_like(numbering.R0)

    def dofs(self, n_point: int) -> list[Index]:
        xyz, base = np.arange(3), 3 * (n_point + 1)
        rows = [np.concatenate([3 * m.point + xyz, base + 3 * m.rotation + xyz]) for m in self.mounted]
        return [np.array(rows, dtype=np.int64)]

    def bind(self, slots: list[Index]) -> None:
        (self._slots,) = slots

    # -- evaluation ---------------------------------------------------------------------------

    def blow(self, t: float, still: bool) -> None:
        """Set the wind of time t."""
        for k, (g, turbulence) in enumerate(zip(self.given, self.fluctuation, strict=True)):
            speed = self.mean[k]
            if turbulence is not None and not still:
                speed += turbulence.at(t, self._ramp)
            self._set(k, g, speed)

    def _set(self, k: int, g: Array, speed: float) -> None:
        self.wind_speed[k] = speed
        g[WIND : WIND + 3] = speed * self.direction

    def begin(self, w: Any, history: Array, t: float, state: Any) -> None:
        """Rates of the states at the step's start, and the wind at its end."""
        self._old = history
        self.given[:, STEP], self.given[:, STILL] = t - state.t, float(w.still)
        if not w.still and t != state.t:
            if np.isnan(history[:, BLOWN]).any():
                self.blow(state.t, False)
            else:  # a step begins in the wind the last one ended in
                for k, g in enumerate(self.given):
                    self._set(k, g, history[k, BLOWN])
            for k, q in enumerate(state.q):
                set_matrix(self._R, k, tuple(q))
            for k, m in enumerate(self.mounted):
                begin_rotor(state.x, self._R, state.v, state.a, m.point, m.rotation, self.given[k], *self.data[k],
                            history[k], self._before[k])  # fmt: skip
        self.blow(t, w.still)

    def add(self, w: Any) -> None:
        for k, m in enumerate(self.mounted):
            if not rotor_loads(w.x, w.R, w.v, w.a, w.c, m.point, m.rotation, self.given[k], *self.data[k],
                               self._old[k], self._before[k], self._slots[k], self.new[k], self._D, self._K, w.A, w.r,
                               w.s, self.told[k]):  # fmt: skip
                w.trouble = f"Rotor '{self.parts[k].name}': no rotor speed and pitch fit the step"

    # -- memory -------------------------------------------------------------------------------

    def start(self, state: Any) -> Array:
        """States of the steady operating points in the mean wind, at the attitude of `state`."""
        y = np.zeros((len(self.parts), STATES + 1))
        y[:, BLOWN] = math.nan
        self.blow(state.t, True)
        for k, q in enumerate(state.q):
            set_matrix(self._R, k, tuple(q))
        rest = np.zeros_like(state.v)
        for k, m in enumerate(self.mounted):
            P, S, gx, gy, _, fine = self.data[k]
            if self.given[k, STANDING] > 0.0:
                y[k, PITCH] = y[k, INTEGRATOR] = P[LARGEST]
                continue
            u = relative(state.x, self._R, rest, rest, m.point, m.rotation, self.given[k])[4]
            speed, pitch, *_ = steady(P, S, gx, gy, fine, u)
            y[k, SPEED], y[k, PITCH], y[k, INTEGRATOR], y[k, FILTER] = speed, pitch, pitch, 0.0
        return y

    def commit(self, history: Array, w: Any) -> None:
        for k, row in enumerate(history):
            if self.given[k, STANDING] == 0.0:
                row[:STATES] = self.new[k]
            row[BLOWN] = self.wind_speed[k]
        self.given[:, STEP] = 0.0  # what is evaluated from here on is of the committed state

    # -- outputs ------------------------------------------------------------------------------

    def outputs(self) -> list[Output]:
        """Seven channels of every rotor."""
        return [
            Output(f"{part.name}_{end}", text.format(part.name), unit)
            for part in self.parts
            for end, text, unit in _TEXT
        ]

    def measure(self, w: Any, out: Array) -> None:
        """Of the state last evaluated."""
        for k, (part, told) in enumerate(zip(self.parts, self.told, strict=True)):
            speed, torque = told[OUT_SPEED], told[OUT_TORQUE]
            out[7 * k : 7 * k + 7] = (*told[:OUT_RELATIVE], part.generator_efficiency * speed * torque,
                                      self.wind_speed[k], told[OUT_RELATIVE])  # fmt: skip

    def ledger(self, w: Any, book: Any) -> None:
        """Power of the rotor's force and moment on its body; what its own speed holds stays inside."""
        for k, m in enumerate(self.mounted):
            r, n, wind, _, u, along, turning = relative(w.x, w.R, w.v, w.a, m.point, m.rotation, self.given[k])
            base = 3 * len(w.x) + 3 * m.rotation
            spin = float(np.dot(n, w.v[base : base + 3]))
            if self.given[k, STANDING] > 0.0:
                hub = np.array(self.given[k, WIND : WIND + 3]) - wind
                book.work("wind", self.given[k, DRAG] * float(np.linalg.norm(wind) * np.dot(wind, hub)))
                continue
            J = self.parts[k].inertia
            book.work("wind", self.told[k, OUT_THRUST] * along + (self.told[k, OUT_TORQUE] + J * turning) * spin)
