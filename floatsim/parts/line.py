"""Lines: chains, ropes and power cables as two-node elements between points.

Element of unstretched length l0 between x1 and x2, d = x2 - x1, l = |d|, t = d/l:

    axial     N from a law of the Green strain (laws/green.py); force N d/l0 on the two ends
    bending   at the node between elements a and b: U = k theta^2/2, k = 1/(l_a/(2 EI_a) + l_b/(2 EI_b))
              with unstretched lengths, M = k theta (laws/angle.py); a dissipation c_b thetadot^2/2
    weight    m g, buoyancy phi rho A g; phi is the wet share of the element, A = pi d^2/4
    inertia   m a + phi rho A [Ca_n a_n + Ca_t a_t]                      (per unit length, own motion)
    drag      phi [0.5 rho d Cd_n |w_n| w_n + 0.5 rho pi d Cd_t |w_t| w_t],   w = fluid - line velocity
    seabed    normal pressure pen (k - c/pen_c vz) on the area d l0, pen = z_bed - z, never pulling

Everything but bending is lumped in equal halves to the element's two ends, with the element's own
direction. *Lumped* mass rather than consistent: the added mass turns with the element and would make
the consistent matrix configuration-dependent off the diagonal blocks, for the same second order of
convergence; MoorDyn and OrcaFlex lump as well, so element counts compare one to one.

The damper of a bent pair acts on the rate of the angle: two directions have no other objective rate.
Its direction is undefined in a straight line, so it fades out below 1e-4 rad.
Sources: Morison et al. (1950); Hall & Goupee (2015), Ocean Engineering 104, for lumping;
Hunt & Crossley (1975), Journal of Applied Mechanics 42, for a contact damper that grows with penetration.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import field_validator, model_validator

from floatsim.description import Description, Name, NonNegative, Positive, PositiveInt, Vector3
from floatsim.frames import Array, at, cross, dot, minus, plus, times, vec
from floatsim.jit import kernel
from floatsim.laws.angle import half_angle_squared
from floatsim.laws.green import green_linear
from floatsim.parts.part import Anchor, Part

Index = NDArray[np.int64]

# rows of the element parameter array
L0, EA, CA, MASS, AREA, CDN, CDT, CAN, CAT, DIA = range(10)
# entries of the surroundings array
RHO, GRAVITY, BED, BED_K, BED_C, BED_PEN = range(6)

MAX_ELEMENTS = 100_000  # decimetres of the longest cables; more is a slip of the pen

_STRAIGHT = 1e-4  # rad; below this the bending damper fades out
_FOLDED = -0.9998  # cosine of 178.9 degrees: the pair is folded back on itself


class Section(Description):
    """Cross-section of a line, per unit length.

    name: name. mass_per_length [kg/m]: dry. diameter [m]: volume-equivalent outer diameter, of the
    displaced volume and of drag. EA [N], EI [N m2]. axial_damping [N s]: force per strain rate, or
    axial_damping_ratio [-]: share of l0 sqrt(EA m) per element (MoorDyn's -zeta); not both.
    bending_damping [N m2 s]: moment times length per angle rate, EI-proportional damping is EI tau.
    drag_normal, drag_tangential [-]: 0.5 rho d Cd and 0.5 rho pi d Cd. added_mass_normal,
    added_mass_tangential [-]: shares of rho A.
    """

    name: Name
    mass_per_length: Positive
    diameter: Positive
    EA: Positive
    EI: NonNegative = 0.0
    axial_damping: NonNegative | None = None
    axial_damping_ratio: NonNegative | None = None
    bending_damping: NonNegative = 0.0
    drag_normal: NonNegative = 0.0
    drag_tangential: NonNegative = 0.0
    added_mass_normal: NonNegative = 0.0
    added_mass_tangential: NonNegative = 0.0

    @model_validator(mode="after")
    def _one_damping(self) -> Section:
        if self.axial_damping is not None and self.axial_damping_ratio is not None:
            raise ValueError("give axial_damping [N s] or axial_damping_ratio [-], not both")
        if self.bending_damping > 0.0 and self.EI == 0.0:
            raise ValueError(f"bending_damping is {self.bending_damping:g} N m2 s but EI is 0: nothing would bend")
        return self

    @property
    def area(self) -> float:
        """Displaced cross-section pi d^2/4 [m2]."""
        return 0.25 * math.pi * self.diameter**2

    def damping(self, element_length: float) -> float:
        """Axial damping of an element, resolved [N s]."""
        if self.axial_damping_ratio is not None:
            return self.axial_damping_ratio * element_length * math.sqrt(self.EA * self.mass_per_length)
        return self.axial_damping or 0.0


class Line(Part):
    """A line of equal elements from end_a to end_b.

    length [m]: unstretched. elements: their number. end_a_position, end_b_position [m]: where an end
    starts if no joint says so. form: 'shared' (elements share their nodes: the node *is* the ball
    joint between them) or 'ball_joints' (each element owns its two end nodes, tied by multipliers).
    taut: set True for a line that is meant to be shorter than the distance it spans (pretension).
    Connection points: `NAME.end_a`, `NAME.end_b`.
    """

    name: Name
    section: Section
    length: Positive
    elements: PositiveInt
    end_a_position: Vector3 | None = None
    end_b_position: Vector3 | None = None
    form: Literal["shared", "ball_joints"] = "shared"
    taut: bool = False

    @field_validator("elements")
    @classmethod
    def _countable(cls, value: int) -> int:
        if value > MAX_ELEMENTS:
            raise ValueError(f"got {value}; at most {MAX_ELEMENTS} are allowed")
        return value

    @staticmethod
    def batch() -> type[LineBatch]:
        return LineBatch

    @property
    def n_points(self) -> int:
        return self.elements + 1 if self.form == "shared" else 2 * self.elements

    def anchors(self) -> dict[str, Anchor]:
        """Connection points: name -> (local point, local rotation or -1, arm in the body frame)."""
        zero = (0.0, 0.0, 0.0)
        return {"end_a": (0, -1, zero), "end_b": (self.n_points - 1, -1, zero)}

    @property
    def nodes(self) -> Index:
        """Local points that stand for the line's nodes 0..elements (one per shared position)."""
        if self.form == "shared":
            return np.arange(self.elements + 1)
        return np.concatenate([[0], 2 * np.arange(self.elements) + 1])

    def internal_balls(self) -> list[tuple[int, int]]:
        """Pairs of local points that ball joints tie together (form 'ball_joints')."""
        if self.form == "shared":
            return []
        return [(2 * e + 1, 2 * e + 2) for e in range(self.elements - 1)]

    def place(self, ends: dict[str, Array], depth: float) -> tuple[Array, Array] | None:
        """The crude shape statics start from: straight, or an arc of the line's length if it is slack.

        None while an end is unknown.
        """
        a = self.end_a_position if self.end_a_position is not None else ends.get("end_a")
        b = self.end_b_position if self.end_b_position is not None else ends.get("end_b")
        if a is None or b is None:
            return None
        x = hanging_arc(np.asarray(a, dtype=float), np.asarray(b, dtype=float), self.length, self.elements + 1, depth)
        if self.form == "ball_joints":
            x = np.repeat(x, 2, axis=0)[1:-1]
        return x, np.empty((0, 3, 3))

    def problems(self, ends: dict[str, Array], depth: float) -> list[str]:
        """What only shows once the ends are known."""
        placed = self.place(ends, depth)
        if placed is None:
            return []
        a, b = placed[0][0], placed[0][-1]
        span = float(np.linalg.norm(b - a))
        found = []
        if span == 0.0:
            found.append(f"Line '{self.name}': its two ends start at the same place; give them a distance")
        if span > self.length and not self.taut:
            short = span - self.length
            pull = self.section.EA * ((span / self.length) ** 2 - 1.0) / 2.0
            found.append(
                f"Line '{self.name}': length is {self.length:g} m but its ends are {span:.6g} m apart, "
                f"{short:.6g} m too short ({100.0 * short / self.length:.3g} %, {pull / 1e3:.4g} kN if it could); "
                "lengthen it, move an end, or set taut=True if it is meant to be pretensioned"
            )
        for end, point in (("end_a", a), ("end_b", b)):
            if point[2] < -depth - 1e-6 * depth:
                found.append(
                    f"Line '{self.name}': {end} is at z = {point[2]:.6g} m, below the seabed at {-depth:g} m"
                )
        return found


def hanging_arc(a: Array, b: Array, length: float, n: int, depth: float) -> Array:
    """n points (n, 3), evenly spaced on a circular arc of the given length from a to b, above the seabed.

    Straight if the length does not exceed the span. A slack line drawn straight would be compressed by far more than
    its weight and start by folding; an arc has no strain at all. It hangs in the vertical plane of its ends; a line so
    slack that it could not stay above the bed even as an L is turned about its chord until it does.
    """
    s = np.linspace(0.0, 1.0, n)[:, None]
    chord = b - a
    span = float(np.linalg.norm(chord))
    if length <= span * (1.0 + 1e-9) or span == 0.0:
        return (1.0 - s) * a + s * b
    from scipy.optimize import brentq

    half = brentq(lambda y: math.sin(y) / y - span / length, 1e-6, math.pi)  # half the angle of the arc
    radius = span / (2.0 * math.sin(half))
    along = chord / span
    across = np.cross(along, (0.0, 0.0, -1.0))
    across = np.array([0.0, 1.0, 0.0]) if np.linalg.norm(across) < 1e-6 else across / np.linalg.norm(across)
    down = np.cross(across, along)
    phi = half * (2.0 * s - 1.0)

    def turned(tilt: float) -> Array:
        sag = math.cos(tilt) * down + math.sin(tilt) * across
        return 0.5 * (a + b) + radius * (np.sin(phi) * along + (np.cos(phi) - math.cos(half)) * sag)

    slack = length > 0.99 * (abs(chord[2]) + math.hypot(chord[0], chord[1]))
    # a hair out of the vertical plane, because slack on the bed has to leave it
    tilts = np.radians(np.concatenate([[0.01], np.arange(5.0, 91.0, 5.0)])) if slack else np.array([0.0])
    shape = next((x for x in map(turned, tilts) if x[:, 2].min() >= -depth), turned(tilts[-1]))
    shape[1:-1, 2] = np.maximum(shape[1:-1, 2], -depth)  # an end below the bed is for `problems` to report
    return shape


@kernel
def _ramp(z, h):  # type: ignore[no-untyped-def]
    """Wet share of a section whose centre is at z: linear over the diameter h. (value, antiderivative)."""
    if z >= 0.5 * h:
        return 0.0, 0.0
    if z <= -0.5 * h:
        return 1.0, z
    y = 0.5 * h - z
    return y / h, -0.5 * y * y / h


@kernel
def wet_share(z1, z2, h):  # type: ignore[no-untyped-def]
    """Mean wet share phi of an element and its derivatives by z1 and z2.

    phi = integral of the section's wet share along the straight element: smooth when a node leaves
    the water, also for a horizontal element.
    """
    if z1 < -0.5 * h and z2 < -0.5 * h:
        return 1.0, 0.0, 0.0
    r1, p1 = _ramp(z1, h)
    r2, p2 = _ramp(z2, h)
    dz = z2 - z1
    if abs(dz) < 1e-6 * h:
        r, _ = _ramp(0.5 * (z1 + z2), h)
        slope = -0.5 / h if 0.0 < r < 1.0 else 0.0
        return r, slope, slope
    phi = (p2 - p1) / dz
    return phi, (phi - r1) / dz, (r2 - phi) / dz


@kernel
def line_elements(x, v, a, u, c, nodes, P, env, slots, Ke, A, r, s):  # type: ignore[no-untyped-def]
    """Axial force, weight, buoyancy, inertia, drag and seabed of every element.

    x (n_point, 3), v and a (flat), u (n_point, 3) fluid velocity; c: see `Work`; nodes
    (n_el, 2); P (n_param, n_el); slots (n_el, 36) into A; Ke (6, 6) scratch. Adds to A, residual r
    and force scale s.
    """
    cM, cC, cK = c[0], c[1], c[2]
    rho, g = env[RHO], env[GRAVITY]
    for e in range(nodes.shape[0]):
        i, j = nodes[e, 0], nodes[e, 1]
        x1, x2 = vec(x, i), vec(x, j)
        d = minus(x2, x1)
        l2 = dot(d, d)
        l = math.sqrt(l2)
        t = times(1.0 / l, d)
        l0 = P[L0, e]
        half = 0.5 * l0
        dv = minus(at(v, 3 * j), at(v, 3 * i))
        strain, rate = 0.5 * (l2 / (l0 * l0) - 1.0), dot(d, dv) / (l0 * l0)
        N, dN, dR = green_linear(min(P[EA, e], c[5]), P[CA, e], strain, rate, c[4])

        # axial: f = N d/l0;  df/dx = dN d d^T/l0^3 + dR d dv^T/l0^3 + N/l0 I;  df/dv = dR d d^T/l0^3
        w0 = N / l0
        k3 = 1.0 / (l0 * l0 * l0)
        for m in range(3):
            for n in range(3):
                k = (cK * dN + cC * dR) * k3 * d[m] * d[n] + cK * dR * k3 * d[m] * dv[n]
                if m == n:
                    k += cK * w0
                Ke[m, n] = k
                Ke[m, n + 3] = -k
                Ke[m + 3, n] = -k
                Ke[m + 3, n + 3] = k
            r[3 * i + m] -= w0 * d[m]
            r[3 * j + m] += w0 * d[m]

        phi, phi1, phi2 = wet_share(x1[2], x2[2], P[DIA, e])
        ma = rho * P[AREA, e] * half  # mass of water displaced by half an element
        dry = P[MASS, e] * half
        weight = dry * g
        # rounding of the coordinates, seen through EA: no residual gets below 1e-8 of this
        noise = P[EA, e] * 1e-7 * (abs(x2[0]) + abs(x2[1]) + abs(x2[2])) / l0
        s[i] += abs(w0) * l + weight + noise
        s[j] += abs(w0) * l + weight + noise
        for k in range(2):
            p = i if k == 0 else j
            b = 3 * k
            acc = at(a, 3 * p)
            w = minus(vec(u, p), at(v, 3 * p))
            at_ = dot(acc, t)
            wt = dot(w, t)
            wn = minus(w, times(wt, t))
            wnl = math.sqrt(dot(wn, wn))
            mn, mt = ma * P[CAN, e], ma * P[CAT, e]  # added mass of half a fully wet element
            cn = 0.5 * rho * P[DIA, e] * P[CDN, e] * half
            ct = 0.5 * rho * math.pi * P[DIA, e] * P[CDT, e] * half
            inv = 1.0 / wnl if wnl > 0.0 else 0.0
            # fluid force per phi (without weight), minus what the inertia needs
            q = plus(times(mn, acc), times((mt - mn) * at_, t))
            f = plus(times(cn * wnl, wn), times(ct * abs(wt) * wt, t))
            y = minus(q, f)
            for m in range(3):
                res = dry * acc[m] + phi * y[m]
                ykt = y[m]
                if m == 2:
                    res += (dry - phi * ma) * g
                    ykt -= ma * g
                r[3 * p + m] += res
                Ke[b + m, b + m] += cM * (dry + phi * mn)
                Ke[b + m, 2] += cK * ykt * phi1
                Ke[b + m, 5] += cK * ykt * phi2
            if phi > 0.0:
                _turning(Ke, b, cM, cC, cK, phi, l, t, acc, w, at_, wt, wn, wnl, inv, mn, mt, cn, ct)
                # seabed under this half: p = pen (k - c/pen_c vz); convex in the penetration, so Newton does not cycle
            pen = env[BED] - x[p, 2]
            if pen > 0.0:
                area = P[DIA, e] * half
                cd = env[BED_C] / env[BED_PEN]
                vz = v[3 * p + 2]
                lift = area * pen * (env[BED_K] - cd * vz)
                if lift > 0.0:  # the bed pushes, it does not pull
                    r[3 * p + 2] -= lift
                    s[p] += lift
                    Ke[b + 2, b + 2] += area * (cK * (env[BED_K] - cd * vz) + cC * cd * pen)
        for m in range(6):
            for n in range(6):
                A[slots[e, 6 * m + n]] += Ke[m, n]


@kernel
def _turning(Ke, b, cM, cC, cK, phi, l, t, acc, w, at_, wt, wn, wnl, inv, mn, mt, cn, ct):  # type: ignore[no-untyped-def]
    """Added-mass and drag tangents of one node, with the turning of the element's direction.

    With y = added-mass force - drag: dy/dt = (mt - mn)[(t.a) I + t a^T] - df/dt,
    df/dt = cn (|wn| I + wn wn^T/|wn|)(-t w^T - wt I) + ct (2 |wt| t w^T + |wt| wt I),
    and dt/dx2 = -dt/dx1 = (I - t t^T)/l.
    """
    dm = mt - mn
    for m in range(3):
        # row m of dy/dt as a 3-tuple, then times (I - t t^T)/l
        # E = |wn| I + wn wn^T/|wn|; E t = |wn| t (wn is normal to t)
        y0 = _dydt(m, 0, dm, at_, t, acc, w, wt, wn, wnl, inv, cn, ct)
        y1 = _dydt(m, 1, dm, at_, t, acc, w, wt, wn, wnl, inv, cn, ct)
        y2 = _dydt(m, 2, dm, at_, t, acc, w, wt, wn, wnl, inv, cn, ct)
        yt = y0 * t[0] + y1 * t[1] + y2 * t[2]
        row = (y0 - yt * t[0], y1 - yt * t[1], y2 - yt * t[2])
        for n in range(3):
            turn = cK * phi * row[n] / l
            Ke[b + m, n] -= turn
            Ke[b + m, n + 3] += turn
            drag = cn * (wn[m] * wn[n] * inv - wnl * t[m] * t[n]) + 2.0 * ct * abs(wt) * t[m] * t[n]
            if m == n:
                drag += cn * wnl
            Ke[b + m, b + n] += phi * (cC * drag + cM * dm * t[m] * t[n])


@kernel
def _dydt(m, n, dm, at_, t, acc, w, wt, wn, wnl, inv, cn, ct):  # type: ignore[no-untyped-def]
    e_mn = 1.0 if m == n else 0.0
    E = wnl * e_mn + wn[m] * wn[n] * inv
    drag = -cn * (wnl * t[m] * w[n] + wt * E) + ct * abs(wt) * (2.0 * t[m] * w[n] + wt * e_mn)
    return dm * (at_ * e_mn + t[m] * acc[n]) - drag


@kernel
def bend(k, cb, xa, xb, ya, yb, va, vb, out_f, out_K, out_C):  # type: ignore[no-untyped-def]
    """Bending between element a (xa -> xb) and element b (ya -> yb), in terms of d_a and d_b.

    out_f (6): gradient by (d_a, d_b); out_K, out_C (6, 6): derivatives by (d_a, d_b) and their rates.
    va, vb: rates of d_a and d_b. Returns (theta, cosine).
    """
    da, db = minus(xb, xa), minus(yb, ya)
    la, lb = math.sqrt(dot(da, da)), math.sqrt(dot(db, db))
    ta, tb = times(1.0 / la, da), times(1.0 / lb, db)
    co = dot(ta, tb)
    sx = cross(ta, tb)
    theta, f1, f2 = half_angle_squared(co, math.sqrt(dot(sx, sx)))
    ga = times(1.0 / la, minus(tb, times(co, ta)))  # dc/dd_a
    gb = times(1.0 / lb, minus(ta, times(co, tb)))
    rate = dot(ga, va) + dot(gb, vb)  # dc/dt
    D = 1.0 - co * co + _STRAIGHT * _STRAIGHT
    q = cb * rate / D
    h1 = k * f1 + q  # coefficient of the Hessian of c
    h2 = k * f2 + 2.0 * q * co / D
    for m in range(3):
        out_f[m] = h1 * ga[m]
        out_f[m + 3] = h1 * gb[m]
        for n in range(3):
            e = 1.0 if m == n else 0.0
            haa = -(ta[m] * ga[n] + ga[m] * ta[n] + co * (e - ta[m] * ta[n]) / la) / la
            hbb = -(tb[m] * gb[n] + gb[m] * tb[n] + co * (e - tb[m] * tb[n]) / lb) / lb
            hab = ((e - tb[m] * tb[n]) / lb - ta[m] * gb[n]) / la
            hba = ((e - ta[m] * ta[n]) / la - tb[m] * ga[n]) / lb
            out_K[m, n] = h2 * ga[m] * ga[n] + h1 * haa
            out_K[m, n + 3] = h2 * ga[m] * gb[n] + h1 * hab
            out_K[m + 3, n] = h2 * gb[m] * ga[n] + h1 * hba
            out_K[m + 3, n + 3] = h2 * gb[m] * gb[n] + h1 * hbb
            out_C[m, n] = cb / D * ga[m] * ga[n]
            out_C[m, n + 3] = cb / D * ga[m] * gb[n]
            out_C[m + 3, n] = cb / D * gb[m] * ga[n]
            out_C[m + 3, n + 3] = cb / D * gb[m] * gb[n]
    if cb > 0.0:  # the rate of c depends on the configuration: g (H v)^T
        for n in range(3):
            hv_a = 0.0
            hv_b = 0.0
            for m in range(3):
                e = 1.0 if m == n else 0.0
                haa = -(ta[m] * ga[n] + ga[m] * ta[n] + co * (e - ta[m] * ta[n]) / la) / la
                hbb = -(tb[m] * gb[n] + gb[m] * tb[n] + co * (e - tb[m] * tb[n]) / lb) / lb
                hab = ((e - tb[m] * tb[n]) / lb - ta[m] * gb[n]) / la
                hba = ((e - ta[m] * ta[n]) / la - tb[m] * ga[n]) / lb
                hv_a += haa * va[m] + hba * vb[m]
                hv_b += hab * va[m] + hbb * vb[m]
            for m in range(3):
                out_K[m, n] += cb / D * ga[m] * hv_a
                out_K[m, n + 3] += cb / D * ga[m] * hv_b
                out_K[m + 3, n] += cb / D * gb[m] * hv_a
                out_K[m + 3, n + 3] += cb / D * gb[m] * hv_b
    return theta, co


@kernel
def line_bending(x, v, c, pairs, B, slots, f, K, C, A, r, s):  # type: ignore[no-untyped-def]
    """Bending at every node between two elements; returns the index of a folded pair, or -1.

    pairs (n, 4): points of element a and of element b; B (2, n): k [N m], damping [N m s]; slots
    (n, 144). Scratch: f (6), K, C (6, 6).
    """
    folded = -1
    for e in range(pairs.shape[0]):
        i0, i1, j0, j1 = pairs[e, 0], pairs[e, 1], pairs[e, 2], pairs[e, 3]
        va = minus(at(v, 3 * i1), at(v, 3 * i0))
        vb = minus(at(v, 3 * j1), at(v, 3 * j0))
        theta, co = bend(B[0, e], B[1, e], vec(x, i0), vec(x, i1), vec(x, j0), vec(x, j1), va, vb, f, K, C)
        if co < _FOLDED:
            folded = e
        for m in range(3):
            r[3 * i0 + m] -= f[m]
            r[3 * i1 + m] += f[m]
            r[3 * j0 + m] -= f[m + 3]
            r[3 * j1 + m] += f[m + 3]
        size = abs(f[0]) + abs(f[1]) + abs(f[2]) + abs(f[3]) + abs(f[4]) + abs(f[5])
        s[i0] += size
        s[i1] += size
        s[j0] += size
        s[j1] += size
        for bm in range(4):
            sm = -1.0 if bm % 2 == 0 else 1.0
            for bn in range(4):
                sn = -1.0 if bn % 2 == 0 else 1.0
                om, on = 3 * (bm // 2), 3 * (bn // 2)
                for m in range(3):
                    for n in range(3):
                        y = c[2] * K[om + m, on + n] + c[1] * C[om + m, on + n]
                        A[slots[e, 12 * (3 * bm + m) + 3 * bn + n]] += sm * sn * y
    return folded


@kernel
def line_results(x, v, nodes, P, tension):  # type: ignore[no-untyped-def]
    """Effective tension N l/l0 [N] of every element."""
    for e in range(nodes.shape[0]):
        i, j = nodes[e, 0], nodes[e, 1]
        d = minus(vec(x, j), vec(x, i))
        l2 = dot(d, d)
        l0 = P[L0, e]
        rate = dot(d, minus(at(v, 3 * j), at(v, 3 * i))) / (l0 * l0)
        N, _, _ = green_linear(P[EA, e], P[CA, e], 0.5 * (l2 / (l0 * l0) - 1.0), rate, 1.0)
        tension[e] = N * math.sqrt(l2) / l0


@kernel
def line_angles(x, pairs, angle):  # type: ignore[no-untyped-def]
    """Angle [rad] between the two elements of every pair."""
    for e in range(pairs.shape[0]):
        da = minus(vec(x, pairs[e, 1]), vec(x, pairs[e, 0]))
        db = minus(vec(x, pairs[e, 3]), vec(x, pairs[e, 2]))
        n = cross(da, db)
        angle[e] = math.atan2(math.sqrt(dot(n, n)), dot(da, db))


class LineBatch:
    """All lines of a system in one batch: one compiled call evaluates every element of every line."""

    def __init__(self, parts: Sequence[Line], first_point: Sequence[int], first_rotation: Sequence[int],
                 sea: Any, gravity: float) -> None:  # fmt: skip
        self.parts = tuple(parts)
        nodes: list[Index] = []
        pairs: list[Index] = []
        columns, bending = [], []
        self.elements_of: list[slice] = []
        self.pairs_of: list[slice] = []
        self.nodes_of: list[Index] = []
        for line, p0 in zip(parts, first_point, strict=True):
            n, sec, l0 = line.elements, line.section, line.length / line.elements
            step = 1 if line.form == "shared" else 2
            start = p0 + step * np.arange(n)
            own = np.stack([start, start + 1], axis=1)
            first = sum(len(item) for item in nodes)
            self.elements_of.append(slice(first, first + n))
            nodes.append(own)
            column = (l0, sec.EA, sec.damping(l0), sec.mass_per_length, sec.area, sec.drag_normal,
                      sec.drag_tangential, sec.added_mass_normal, sec.added_mass_tangential, sec.diameter)  # fmt: skip
            columns.append(np.repeat(np.array(column)[:, None], n, axis=1))
            both = np.concatenate([own[:-1], own[1:]], axis=1)
            first = sum(len(item) for item in pairs)
            self.pairs_of.append(slice(first, first + n - 1))
            pairs.append(both)
            bending.append(np.repeat([[sec.EI / l0], [sec.bending_damping / l0]], n - 1, axis=1))
            self.nodes_of.append(p0 + line.nodes)
        self.nodes = np.ascontiguousarray(np.concatenate(nodes), dtype=np.int64)
        self.P = np.ascontiguousarray(np.concatenate(columns, axis=1))
        self.all_pairs = np.ascontiguousarray(np.concatenate(pairs), dtype=np.int64)
        B = np.concatenate(bending, axis=1)
        stiff = np.flatnonzero(B[0] > 0.0)
        self.pairs = np.ascontiguousarray(self.all_pairs[stiff])
        self.B = np.ascontiguousarray(B[:, stiff])
        self.pair_index = stiff
        bed = sea.seabed
        self.env = np.array([sea.density, gravity, -sea.depth, bed.stiffness, bed.damping, bed.damping_penetration])
        self.runs = [(p0 + 1, line.elements - 1) for line, p0 in zip(parts, first_point, strict=True)
                     if line.form == "shared" and line.elements > 1]  # fmt: skip
        self._Ke, self._K, self._C, self._f = np.zeros((6, 6)), np.zeros((6, 6)), np.zeros((6, 6)), np.zeros(6)

    def dofs(self, n_point: int) -> list[Index]:
        """Unknowns that each element couples, one table per kind of element."""
        xyz = np.arange(3)
        tables = [(3 * self.nodes[:, :, None] + xyz).reshape(len(self.nodes), 6)]
        tables.append((3 * self.pairs[:, :, None] + xyz).reshape(len(self.pairs), 12))
        return tables

    def bind(self, slots: list[Index]) -> None:
        self._slots, self._bend_slots = slots

    def add(self, w: Any) -> None:
        line_elements(w.x, w.v, w.a, w.u, w.c, self.nodes, self.P, self.env, self._slots, self._Ke, w.A, w.r, w.s)
        if len(self.pairs):
            folded = line_bending(w.x, w.v, w.c, self.pairs, self.B, self._bend_slots, self._f, self._K, self._C,
                                  w.A, w.r, w.s)  # fmt: skip
            if folded >= 0:
                w.trouble = f"line '{self.name_at(folded)}' is folded back on itself"

    def name_at(self, pair: int) -> str:
        """`line, node k` of a bending pair."""
        k = int(self.pair_index[pair])
        for line, where in zip(self.parts, self.pairs_of, strict=True):
            if where.start <= k < where.stop:
                return f"{line.name}', node '{k - where.start + 1}"
        return "?"

    def tension(self, w: Any) -> Array:
        """Effective tension of all elements [N], shape (n_elements of all lines,)."""
        out = np.empty(len(self.nodes))
        line_results(w.x, w.v, self.nodes, self.P, out)
        return out

    def angles(self, w: Any) -> Array:
        """Angles at all inner nodes [rad], shape (n_pairs of all lines,)."""
        out = np.empty(len(self.all_pairs))
        line_angles(w.x, self.all_pairs, out)
        return out
