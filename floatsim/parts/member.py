"""Morison loads: slender members and discs fixed in a rigid body, partly wet, in waves and current.

Of a strip of a member, volume V (that of its frustum), wet share phi, moving with v, a in water with u, a_f (w = u - v,
n: normal to the axis e, t: along it):

    F = phi { 1/2 rho D dl Cd |w_n| w_n + 1/2 rho pi D dl Cd_t |w_t| w_t        drag, normal and of the skin
              + rho V Ca (a_f - a)_n + rho V Ca_t (a_f - a)_t                   added mass
              + rho V a_f }  +  rho g V phi e_z                                 pressure of the undisturbed water

(Morison et al. 1950; DNV-RP-C205 (2019) sections 6.2 and 6.3 for relative motion.) `decoupled` drag takes |w_1| w_1 and
|w_2| w_2 along the member's own two transverse axes instead of |w_n| w_n: the body's x axis (its y axis for a member
along x), made normal to the member, and the one normal to both.

Undisturbed pressure p acts on a closed surface, ends included, and on the waterplane p = 0, so that it adds up to the
volume integral of - grad p = rho (a_f + g e_z): Froude-Krylov forces on the ends are in it, p A at the foot of a
vertical column as well as the heave of one that is all under water. Ends that two members share cancel.

Hydrostatics of a strip are exact for a circular cylinder under a level surface, at any attitude: at the distance s from
its middle, z + s e_z above the surface, a disc of radius r, whose half height is h = r sqrt(1 - e_z^2), is wet by
f(y) of its area, y = (z + s e_z)/h, and the wet part's centre lies r g(y)/f(y) below its own:

    f = (acos y - y sqrt(1 - y^2))/pi,        g = 2/(3 pi) (1 - y^2)^(3/2),        f' = -2/pi sqrt(1 - y^2),   g' = y f'

Integrated along the strip in closed form these give force, moment (that of the waterplane included) and a symmetric
tangent; so a column has its exact draught and heel, a level one sinks in smoothly. h never falls below r/1000.

Discs, which ends of members are too, have 1/2 rho A Cd |w_t| w_t and Ca (8/3) rho r^3 (a_f - a)_t along their axis,
8/3 rho r^3 being the added mass of a thin disc (Lamb, Hydrodynamics, section 102); they are taken to be no thinner
than r, so that they enter the water gradually.

Simplifications that are named: wave and current at the middle of the strip, kept during the Newton iterations of a step
(taken where the strip will be if its acceleration stays); the surface level over a strip; local accelerations of the
water; no velocity products of the added mass (Rainey's); a tapered member is a stack of cylinders.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, model_validator

from floatsim.description import LARGEST, Description, NonNegative, Positive, PositiveInt, Target, Vector3, is_number
from floatsim.errors import ModelError, nearest
from floatsim.frames import (
    Array,
    at,
    cross,
    dot,
    minus,
    plus,
    rotate,
    set_matrix,
    times,
    turn_quaternion,
    unit,
    vec,
)
from floatsim.jit import kernel
from floatsim.parts.part import Output, Part
from floatsim.sea.kinematics import Kinematics

Index = NDArray[np.int64]

# rows of the strips' parameters
ARM, AXIS, SIDE = 0, 3, 6  # three rows each, body axes: middle, direction, first transverse axis
RADIUS, HALF, SOFT, PRESSED, DRAG_N, DRAG_T, ADDED_N, ADDED_T, SPLIT = range(9, 18)
ROWS = 18

THIN = 1e-3  # least half height of a section, over its radius
DISC = 0.5  # of a disc
FLAT = 5e-3  # change of y over half a strip below which the closed forms cancel too much: Gauss-Legendre then
_NODES, _WEIGHTS = (tuple(map(float, row)) for row in np.polynomial.legendre.leggauss(5))


def _pair(value: Any, least: float, strict: bool) -> tuple[float, float]:
    several = isinstance(value, list | tuple) or (isinstance(value, np.ndarray) and value.ndim > 0)
    row = tuple(value) if several else (value, value)
    good = len(row) == 2 and all(is_number(y) and abs(float(y)) <= LARGEST for y in row)
    if not good or any(y < least or (strict and y == least) for y in row):
        kind = "positive number" if strict else "number that is not negative"
        raise ValueError(f"got {value!r:.60}; must be a {kind} or two of them (at a, at b)")
    return float(row[0]), float(row[1])


Diameters = Annotated[tuple[float, float], BeforeValidator(lambda value: _pair(value, 0.0, True))]
AtEnds = Annotated[tuple[float, float], BeforeValidator(lambda value: _pair(value, 0.0, False))]


class Member(Description):
    """A slender circular cylinder fixed in a body, a water load of it: `Body(hydro=[Member(...), ...])`.

    a, b: its ends, body axes [m] or names of the body's points. diameter [m]: one, or (at a, at b) for a taper.
    drag_normal, drag_tangential [-]: 1/2 rho D Cd and 1/2 rho pi D Cd per length. added_mass_normal,
    added_mass_tangential [-]: Ca, shares of the displaced mass (CM = 1 + Ca). end_drag, end_added_mass [-]: of the
    ends as discs of their diameter, one or (at a, at b); added mass as a share of 8/3 rho r^3, 0.5 for one face.
    buoyancy: whether the pressure of the undisturbed water acts, hydrostatic and Froude-Krylov. On a body with
    potential flow it must be said: False where the member is in its database (drag alone is left then, Ca must be 0),
    True for a brace that is not. drag_form: `coupled` |w_n| w_n or `decoupled`, by component. strips: how many, equally
    long.
    """

    a: Target
    b: Target
    diameter: Diameters
    drag_normal: NonNegative = 0.0
    drag_tangential: NonNegative = 0.0
    added_mass_normal: NonNegative = 0.0
    added_mass_tangential: NonNegative = 0.0
    end_drag: AtEnds = (0.0, 0.0)
    end_added_mass: AtEnds = (0.0, 0.0)
    buoyancy: bool | None = None
    drag_form: Literal["coupled", "decoupled"] = "coupled"
    strips: Annotated[PositiveInt, Field(le=10_000)] = 20

    @model_validator(mode="after")
    def _has_length(self) -> Member:
        if self.a == self.b:
            raise ValueError(f"its two ends are the same, {self.a}")
        return self

    def files(self) -> list[str]:
        """Files its numbers come from: none."""
        return []

    def attached_to(self, body: Any) -> list[Part]:
        """The part that carries these loads. Raises ModelError for points the body does not have, and where it
        would take twice what potential flow has already."""
        where = _label(body, self)
        ends = [_point(body, y, where) for y in (self.a, self.b)]
        if ends[0] == ends[1]:
            raise ModelError(f"{where}: its two ends {self.a!r} and {self.b!r} are at the same place")
        if any(hasattr(load, "database") for load in body.water_loads):
            if self.buoyancy is None:
                raise ModelError(
                    f"{where}: the body has potential flow, too; say buoyancy=False if the member is part of its "
                    "database (drag alone then), buoyancy=True if it is not"
                )
            if not self.buoyancy and (self.added_mass_normal or self.added_mass_tangential):
                raise ModelError(
                    f"{where}: got added mass with buoyancy=False; the added mass of a member in the potential-flow "
                    "database is there already: leave it 0, or say buoyancy=True if the member is not in it"
                )
        return [MemberLoad(name=_name(body, self), body=body, load=self)]

    def rows(self, body: Any, rho: float) -> Array:
        """Strips and ends as columns of parameters (ROWS, n)."""
        where = _label(body, self)
        a, b = (np.array(_point(body, y, where)) for y in (self.a, self.b))
        n, length = self.strips, float(np.linalg.norm(b - a))
        e, h = (b - a) / length, 0.5 * length / n
        d = np.linspace(*self.diameter, n + 1)
        mean = 0.5 * (d[:-1] + d[1:])
        volume = math.pi / 12.0 * (d[:-1] ** 2 + d[:-1] * d[1:] + d[1:] ** 2) * 2.0 * h
        out = np.zeros((ROWS, n))
        middle = (np.arange(n) + 0.5) / n
        out[ARM : ARM + 3] = a[:, None] + np.outer(b - a, middle)
        out[AXIS : AXIS + 3], out[SIDE : SIDE + 3] = e[:, None], _transverse(e)[:, None]
        out[RADIUS], out[HALF], out[SOFT] = np.sqrt(volume / (2.0 * math.pi * h)), h, THIN
        out[PRESSED] = rho * volume * (self.buoyancy is not False)
        out[DRAG_N] = 0.5 * rho * self.drag_normal * mean * 2.0 * h
        out[DRAG_T] = 0.5 * rho * math.pi * self.drag_tangential * mean * 2.0 * h
        out[ADDED_N], out[ADDED_T] = (rho * volume * y for y in (self.added_mass_normal, self.added_mass_tangential))
        out[SPLIT] = self.drag_form == "decoupled"
        ends = [_disc(x, e, D, Cd, Ca, rho) for x, D, Cd, Ca in zip((a, b), self.diameter, self.end_drag,
                                                                    self.end_added_mass) if Cd or Ca]  # fmt: skip
        return np.column_stack([out, *ends])


class Disc(Description):
    """A drag disc or heave plate fixed in a body, a water load of it: loads along its axis only.

    at: its middle, body axes [m] or the name of one of the body's points. axis: its normal, body axes. diameter [m].
    drag [-]: Cd of the area. added_mass [-]: share of 8/3 rho r^3 (1: a thin disc with water on both sides). It has
    no volume.
    """

    at: Target
    axis: Vector3 = (0.0, 0.0, 1.0)
    diameter: Positive
    drag: NonNegative = 0.0
    added_mass: NonNegative = 0.0

    @model_validator(mode="after")
    def _acts(self) -> Disc:
        if not any(self.axis):
            raise ValueError("axis: got (0, 0, 0); a direction is needed")
        if self.drag == 0.0 and self.added_mass == 0.0:
            raise ValueError("drag and added_mass are both 0: it would do nothing")
        return self

    def files(self) -> list[str]:
        """Files its numbers come from: none."""
        return []

    def attached_to(self, body: Any) -> list[Part]:
        """The part that carries these loads. Raises ModelError for a point the body does not have."""
        _point(body, self.at, _label(body, self))
        return [MemberLoad(name=_name(body, self), body=body, load=self)]

    def rows(self, body: Any, rho: float) -> Array:
        """Its column of parameters (ROWS, 1)."""
        e = np.array(self.axis) / np.linalg.norm(self.axis)
        x = np.array(_point(body, self.at, _label(body, self)))
        return _disc(x, e, self.diameter, self.drag, self.added_mass, rho)[:, None]


def _disc(x: Array, e: Array, diameter: float, drag: float, added: float, rho: float) -> Array:
    out, r = np.zeros(ROWS), 0.5 * diameter
    out[ARM : ARM + 3], out[AXIS : AXIS + 3], out[SIDE : SIDE + 3] = x, e, _transverse(e)
    out[RADIUS], out[SOFT] = r, DISC
    out[DRAG_T], out[ADDED_T] = 0.5 * rho * drag * math.pi * r**2, added * 8.0 / 3.0 * rho * r**3
    return out


def _transverse(e: Array) -> Array:
    """The body's x axis made normal to e; its y axis if e lies within 10 degrees of x."""
    x = np.array([1.0, 0.0, 0.0] if abs(e[0]) < math.cos(math.radians(10.0)) else [0.0, 1.0, 0.0])
    n = x - (x @ e) * e
    return np.asarray(n / np.linalg.norm(n))


def _number(body: Any, load: Any) -> int:
    return next((k for k, other in enumerate(body.water_loads) if other is load), 0)


def _name(body: Any, load: Any) -> str:
    return f"{body.name}.{type(load).__name__.lower()}_{_number(body, load)}"


def _label(body: Any, load: Any) -> str:
    return f"Body '{body.name}': hydro[{_number(body, load)}], {type(load).__name__}"


def _point(body: Any, target: Any, where: str) -> tuple[float, float, float]:
    """Body coordinates [m] of a point of the body or of coordinates."""
    if not isinstance(target, str):
        return (float(target[0]), float(target[1]), float(target[2]))
    if target not in body.points:
        raise ModelError(f"{where}: the body has no point '{target}'{nearest(target, body.points)}")
    return tuple(body.points[target])  # type: ignore[return-value]


class MemberLoad(Part):
    """The Morison loads of one member or disc of a body."""

    name: str
    body: Any
    load: Any

    @staticmethod
    def batch() -> type[MemberBatch]:
        return MemberBatch


@kernel
def _segment(y):  # type: ignore[no-untyped-def]
    """f, g, k = integral of y^2 f', and f' of a disc y of its half height above the surface."""
    if y >= 1.0:
        return 0.0, 0.0, -0.125, 0.0
    if y <= -1.0:
        return 1.0, 0.0, 0.125, 0.0
    c = math.sqrt(1.0 - y * y)
    f = (math.acos(y) - y * c) / math.pi
    g = 2.0 / (3.0 * math.pi) * c * c * c
    k = -(math.asin(y) - y * c * (1.0 - 2.0 * y * y)) / (4.0 * math.pi)
    return f, g, k, -2.0 / math.pi * c


@kernel
def wetness(z, e_z, r, half, soft):  # type: ignore[no-untyped-def]
    """Means over a strip of 2 half (0: a disc) whose middle is z above the surface and whose axis rises by e_z.

    phi: wet share; G: lever [m] of its buoyancy about the middle, the moment being rho g V G e x e_z; and the
    derivatives phi_z [1/m], phi_e = G_z, G_e [m] by z and e_z: they are the first and second derivatives of - U, the
    potential energy over rho g V.
    """
    c2 = 1.0 + soft * soft - e_z * e_z
    c = math.sqrt(c2)
    h = r * c
    q = r * e_z / c  # - dh/de_z
    q_e = r * (1.0 + soft * soft) / (c2 * c)
    kappa = e_z / h
    y0 = z / h
    y1, y2 = y0 - kappa * half, y0 + kappa * half
    if y1 <= -1.0 and y2 <= -1.0:
        return 1.0, 0.0, 0.0, 0.0, 0.0
    if y1 >= 1.0 and y2 >= 1.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    # means of f, s f, g, and of f', f' m, f' m^2 with m = s + q y, which is h dy/de_z
    F = S = G = D0 = D1 = D2 = 0.0
    if abs(kappa * half) < FLAT:
        for i in range(5):
            s = _NODES[i] * half
            f, g, _, d = _segment(y0 + kappa * s)
            m, weight = s + q * (y0 + kappa * s), 0.5 * _WEIGHTS[i]
            F += weight * f
            S += weight * s * f
            G += weight * g
            D0 += weight * d
            D1 += weight * d * m
            D2 += weight * d * m * m
    else:
        f1, g1, k1, _ = _segment(y1)
        f2, g2, k2, _ = _segment(y2)
        w = 0.5 / (kappa * half)
        df, dg, dk = f2 - f1, g2 - g1, k2 - k1
        first = (y2 * f2 - g2) - (y1 * f1 - g1)  # of f
        second = 0.5 * ((y2 * y2 * f2 - k2) - (y1 * y1 * f1 - k1))  # of y f
        F = w * first
        S = w * (second - y0 * first) / kappa
        G = w * ((y2 * g2 - k2) - (y1 * g1 - k1))
        alpha, beta = 1.0 / kappa + q, -y0 / kappa  # m = alpha y + beta
        D0 = w * df
        D1 = w * (alpha * dg + beta * df)
        D2 = w * (alpha * alpha * dk + 2.0 * alpha * beta * dg + beta * beta * df)
    return F, S + q * G, D0 / h, D1 / h, D2 / h + q_e * G


@kernel
def _column(P, row, e):  # type: ignore[no-untyped-def]
    return (P[row, e], P[row + 1, e], P[row + 2, e])


@kernel
def _split(n, t, axis, y):  # type: ignore[no-untyped-def]
    """n times the part of y normal to the axis plus t times the part along it."""
    return plus(times(n, y), times((t - n) * dot(axis, y), axis))


@kernel
def member_loads(x, R, v, a, u, du, eta, c, where, first, P, gravity, slots, K, A, r, s, out):  # type: ignore[no-untyped-def]
    """Loads of all strips of all bodies.

    where (n, 2): point and rotation of each body; first (n + 1): its strips; P (ROWS, strips); u, du, eta: water at the
    strips; slots (n, 36); out (n, 8): force and moment about the reference point on each body, power of the drag
    on it [W], buoyancy [N]. Scratch: K (6, 6).
    """
    base = 3 * x.shape[0]
    zero, up = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)
    for b in range(where.shape[0]):
        p, k = where[b, 0], where[b, 1]
        dp, dr = 3 * p, base + 3 * k
        vel, omega, acc, alpha = at(v, dp), at(v, dr), at(a, dp), at(a, dr)
        force, moment = zero, zero
        size = turning = power = lift = 0.0
        for m in range(6):
            for n in range(6):
                K[m, n] = 0.0
        for e in range(first[b], first[b + 1]):
            arm = rotate(R, k, _column(P, ARM, e))
            axis = rotate(R, k, _column(P, AXIS, e))
            z = x[p, 2] + arm[2] - eta[e]
            phi, lever, phi_z, phi_e, lever_e = wetness(z, axis[2], P[RADIUS, e], P[HALF, e], P[SOFT, e])
            if phi <= 0.0:
                continue
            V, mn, mt = P[PRESSED, e], P[ADDED_N, e], P[ADDED_T, e]
            weight = gravity * V
            spin = cross(omega, arm)
            w = minus(vec(u, e), plus(vel, spin))
            here = plus(acc, plus(cross(alpha, arm), cross(omega, spin)))
            flow = vec(du, e)
            rel = minus(flow, here)
            # drag; its derivative by w is bn (I - e e) + b1 d1 d1 + b2 d2 d2 + bt e e
            cn, ct = P[DRAG_N, e], P[DRAG_T, e]
            wt = dot(w, axis)
            wn = minus(w, times(wt, axis))
            bt, d2, b2 = 2.0 * ct * abs(wt), zero, 0.0
            if P[SPLIT, e] > 0.0:
                d1 = rotate(R, k, _column(P, SIDE, e))
                d2 = cross(axis, d1)
                w1, w2 = dot(w, d1), dot(w, d2)
                bn, b1, b2 = 0.0, 2.0 * cn * abs(w1), 2.0 * cn * abs(w2)
                drag = plus(times(0.5 * b1 * w1, d1), times(0.5 * b2 * w2, d2))
            else:
                speed = math.sqrt(dot(wn, wn))
                bn = b1 = cn * speed
                d1 = times(1.0 / speed if speed > 0.0 else 0.0, wn)
                drag = times(bn, wn)
            drag = plus(drag, times(0.5 * bt * wt, axis))
            wet = plus(drag, plus(_split(mn, mt, axis, rel), times(V, flow)))  # of the whole strip, but for buoyancy
            f = plus(times(phi, wet), times(phi * weight, up))
            level = cross(axis, up)
            M = plus(cross(arm, f), times(weight * lever, level))
            force, moment = plus(force, f), plus(moment, M)
            power += phi * dot(drag, plus(vel, spin))
            lift += phi * weight
            load = phi * (
                weight + math.sqrt(dot(drag, drag)) + (mn + mt) * math.sqrt(dot(here, here))
                + (V + mn + mt) * math.sqrt(dot(flow, flow))
            )  # fmt: skip
            size += load
            turning += load * math.sqrt(dot(arm, arm)) + weight * abs(lever)
            if c[6] == 0.0:
                continue
            for col in range(6):
                y = unit(col % 3)
                if col < 3:
                    # changes by position, velocity and acceleration: of the arm, of - w, of the acceleration
                    dz, de = y[2], 0.0
                    darm, daxis, turned = zero, zero, zero
                    dw = times(c[1], y)
                    dacc = times(c[0], y)
                else:
                    darm, daxis = cross(y, arm), cross(y, axis)
                    dz, de = darm[2], daxis[2]
                    dspin = cross(omega, darm)
                    dw = plus(times(c[1], darm), times(c[2], plus(dspin, cross(y, w))))
                    dacc = plus(
                        plus(times(c[0], darm), times(c[1], plus(cross(y, spin), dspin))),
                        times(c[2], plus(plus(cross(alpha, darm), cross(omega, dspin)), cross(y, rel))),
                    )
                    turned = times(c[2], minus(cross(y, wet), times(V, cross(y, flow))))
                dt = dot(axis, dw)
                ddrag = plus(times(bn, minus(dw, times(dt, axis))), times(bt * dt, axis))
                ddrag = plus(ddrag, plus(times(b1 * dot(d1, dw), d1), times(b2 * dot(d2, dw), d2)))
                df = times(phi, minus(turned, plus(ddrag, _split(mn, mt, axis, dacc))))
                dphi = c[2] * (phi_z * dz + phi_e * de)
                df = plus(df, times(dphi, plus(wet, times(weight, up))))
                dM = plus(cross(arm, df), times(c[2], cross(darm, f)))
                dM = plus(dM, times(c[2] * weight * (phi_e * dz + lever_e * de), level))
                dM = plus(dM, times(c[2] * weight * lever, cross(daxis, up)))
                for m in range(3):
                    K[m, col] -= df[m]
                    K[3 + m, col] -= dM[m]
        for m in range(3):
            r[dp + m] -= force[m]
            r[dr + m] -= moment[m]
            out[b, m], out[b, 3 + m] = force[m], moment[m]
        out[b, 6], out[b, 7] = power, lift
        s[p] += size
        s[x.shape[0] + k] += turning
        if c[6] != 0.0:
            for m in range(6):
                for n in range(6):
                    A[slots[b, 6 * m + n]] += K[m, n]


@kernel
def strip_energy(z, e_z, r, half, soft):  # type: ignore[no-untyped-def]
    """U/(rho g V) [m] of a strip, arguments as of `wetness`: the mean of - h (y f - g)."""
    h = r * math.sqrt(1.0 + soft * soft - e_z * e_z)
    kappa = e_z / h
    y1, y2 = z / h - kappa * half, z / h + kappa * half
    if abs(kappa * half) < FLAT:
        mean = 0.0
        for i in range(5):
            y = z / h + kappa * _NODES[i] * half
            f, g, _, _ = _segment(y)
            mean += 0.5 * _WEIGHTS[i] * (y * f - g)
        return -h * mean
    f1, g1, k1, _ = _segment(y1)
    f2, g2, k2, _ = _segment(y2)
    return -h * (0.5 * (y2 * y2 * f2 + k2 - y1 * y1 * f1 - k1) - y2 * g2 + y1 * g1) / (2.0 * kappa * half)


@kernel
def member_powers(x, R, v, a, u, du, eta, current, where, first, P, gravity, out):  # type: ignore[no-untyped-def]
    """out (6): energy of buoyancy in still water and its rate, powers of wave, current, drag and added mass.

    current (strips, 3): the part of u that is no wave's; the rest as in `member_loads`.
    """
    base = 3 * x.shape[0]
    for i in range(6):
        out[i] = 0.0
    for b in range(where.shape[0]):
        p, k = where[b, 0], where[b, 1]
        vel, omega, acc, alpha = at(v, 3 * p), at(v, base + 3 * k), at(a, 3 * p), at(a, base + 3 * k)
        for e in range(first[b], first[b + 1]):
            arm, axis = rotate(R, k, _column(P, ARM, e)), rotate(R, k, _column(P, AXIS, e))
            r, half, soft, V = P[RADIUS, e], P[HALF, e], P[SOFT, e], P[PRESSED, e]
            spin = cross(omega, arm)
            own = plus(vel, spin)
            z, turn = x[p, 2] + arm[2], dot(omega, cross(axis, (0.0, 0.0, 1.0)))
            phi, lever, _, _, _ = wetness(z - eta[e], axis[2], r, half, soft)
            still, still_lever, _, _, _ = wetness(z, axis[2], r, half, soft)
            level = gravity * V * (still * own[2] + still_lever * turn)
            out[0] += gravity * V * strip_energy(z, axis[2], r, half, soft)
            out[1] -= level
            out[2] += gravity * V * (phi * own[2] + lever * turn) - level
            if phi <= 0.0:
                continue
            here = plus(acc, plus(cross(alpha, arm), cross(omega, spin)))
            flow, w = vec(du, e), minus(vec(u, e), own)
            cn, ct, mn, mt = phi * P[DRAG_N, e], phi * P[DRAG_T, e], phi * P[ADDED_N, e], phi * P[ADDED_T, e]
            wt = dot(w, axis)
            wn = minus(w, times(wt, axis))
            if P[SPLIT, e] > 0.0:
                d1 = rotate(R, k, _column(P, SIDE, e))
                d2 = cross(axis, d1)
                w1, w2 = dot(w, d1), dot(w, d2)
                drag = plus(times(cn * abs(w1) * w1, d1), times(cn * abs(w2) * w2, d2))
            else:
                drag = times(cn * math.sqrt(dot(wn, wn)), wn)
            drag = plus(drag, times(ct * abs(wt) * wt, axis))
            moved = dot(drag, vec(current, e))
            out[2] += dot(drag, vec(u, e)) - moved
            out[2] += dot(plus(_split(mn, mt, axis, flow), times(phi * V, flow)), own)
            out[3] += moved
            out[4] -= dot(drag, w)
            out[5] -= dot(_split(mn, mt, axis, here), own)


@kernel
def strips_ahead(x, q, v, a, t, where, first, P, R, out):  # type: ignore[no-untyped-def]
    """out (strips, 3): where the strips will be after t if accelerations stay. Scratch: R (1, 3, 3)."""
    base = 3 * x.shape[0]
    for b in range(where.shape[0]):
        p, k = where[b, 0], where[b, 1]
        move = plus(times(t, at(v, 3 * p)), times(0.5 * t * t, at(a, 3 * p)))
        turn = plus(times(t, at(v, base + 3 * k)), times(0.5 * t * t, at(a, base + 3 * k)))
        set_matrix(R, 0, turn_quaternion(turn, (q[k, 0], q[k, 1], q[k, 2], q[k, 3])))
        here = plus(vec(x, p), move)
        for e in range(first[b], first[b + 1]):
            y = plus(here, rotate(R, 0, _column(P, ARM, e)))
            for m in range(3):
                out[e, m] = y[m]


class MemberBatch:
    """Morison loads of all members and discs of all bodies."""

    runs: ClassVar[list[tuple[int, int]]] = []
    remembers: ClassVar[bool] = True

    def __init__(self, parts: Sequence[MemberLoad], first_point: Sequence[int], first_rotation: Sequence[int],
                 sea: Any, gravity: float) -> None:  # fmt: skip
        self.parts = tuple(parts)
        self.gravity = float(gravity)
        self.bodies = {part.body.name: part.body for part in parts}
        own = [[part.load.rows(part.body, sea.density) for part in parts if part.body.name == name]
               for name in self.bodies]  # fmt: skip
        self.P = np.ascontiguousarray(np.column_stack([column for rows in own for column in rows]))
        self.first = np.cumsum([0, *(sum(rows.shape[1] for rows in body) for body in own)]).astype(np.int64)
        n = self.P.shape[1]
        self.arms = np.ascontiguousarray(self.P[ARM : ARM + 3].T)  # the size of the model is taken from them, too
        points = np.arange(n)
        self._still = Kinematics(None, sea.current, sea.depth, 0.0, sea.stretching, points)
        self._waves = self._still
        if sea.waves is not None:
            self._waves = Kinematics(sea.waves.realise(sea.depth, gravity), sea.current, sea.depth, sea.wave_ramp,
                                     sea.stretching, points)  # fmt: skip
        self._profile = sea.current.profile is not None
        self.x, self.u, self.du, self.eta = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((n, 3)), np.zeros(n)
        self.load = np.zeros((len(self.bodies), 8))
        self._K, self._R = np.zeros((6, 6)), np.zeros((1, 3, 3))

    @property
    def water(self) -> tuple[Array, Array, Array, Array]:
        """Places (n, 3), and the velocity, acceleration (n, 3) and surface (n,) of the water there, kept in a step."""
        return self.x, self.u, self.du, self.eta

    def connect(self, numbering: Any) -> None:
        """Find the bodies' points and rotations."""
        places = [numbering.place(name) for name in self.bodies]
        self.where = np.array([[p.point, p.rotation] for p in places], dtype=np.int64)

    def dofs(self, n_point: int) -> list[Index]:
        xyz, w = np.arange(3), self.where
        return [np.concatenate([3 * w[:, :1] + xyz, 3 * (n_point + 1) + 3 * w[:, 1:] + xyz], axis=1)]

    def bind(self, slots: list[Index]) -> None:
        (self._slots,) = slots

    def begin(self, w: Any, history: Any, t: float, state: Any) -> None:
        """The water where the strips will be at t."""
        strips_ahead(state.x, state.q, state.v, state.a, t - state.t, self.where, self.first, self.P, self._R, self.x)
        (self._still if w.still else self._waves).move(self.x, t, self.u, self.du, self.eta)

    def add(self, w: Any) -> None:
        if w.still and self._profile:  # statics move far without beginning anew
            strips_ahead(w.x, w.q, w.v, w.a, 0.0, self.where, self.first, self.P, self._R, self.x)
            self._still.move(self.x, w.t, self.u, self.du, self.eta)
        member_loads(w.x, w.R, w.v, w.a, self.u, self.du, self.eta, w.c, self.where, self.first, self.P, self.gravity,
                     self._slots, self._K, w.A, w.r, w.s, self.load)  # fmt: skip

    def outputs(self) -> list[Output]:
        """Total Morison loads of every body that has any."""
        what = "of the water on the members and discs of"
        return [
            Output(f"{name}_member_{kind}", f"{kind} {what} {name}{about}, world axes", unit, ("xyz",))
            for name in self.bodies
            for kind, about, unit in (("force", "", "N"), ("moment", " about its reference point", "N m"))
        ]

    def measure(self, w: Any, out: Array) -> None:
        """Of the state last evaluated."""
        out[:] = self.load[:, :6].ravel()

    def ledger(self, w: Any, book: Any) -> None:
        """Buoyancy in still water is a store; all that the waves change is their work."""
        n = self.P.shape[1]
        current, y = np.zeros((n, 3)), np.zeros(6)
        self._still.move(self.x, w.t, current, np.zeros((n, 3)), np.zeros(n))
        member_powers(w.x, w.R, w.v, w.a, self.u, self.du, self.eta, current, self.where, self.first, self.P,
                      self.gravity, y)  # fmt: skip
        book.store("hydrostatic", y[0], y[1])
        for k, name in enumerate(("wave", "current", "drag", "added_mass")):
            book.work(name, y[2 + k])

    def buoyancy(self, name: str) -> float:
        """Hydrostatic lift [N] of the members of body `name` where they were last evaluated; 0 if it has none."""
        return float(self.load[list(self.bodies).index(name), 7]) if name in self.bodies else 0.0
