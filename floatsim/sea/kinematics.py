"""Velocity and acceleration of the water under linear waves, at many points at once.

Airy waves in water of depth d (Newman 1977, Marine Hydrodynamics, sections 6.2 and 6.3): with phi = w t - k s + phase,
s = x cos b + y sin b, and a wave's speed factor a w/sinh(k d),

    eta = a cos phi
    u_s = a w cosh k(z + d)/sinh(k d) cos phi        du_s/dt = - w a w cosh k(z + d)/sinh(k d) sin phi
    w   = - a w sinh k(z + d)/sinh(k d) sin phi       dw/dt  = - w a w sinh k(z + d)/sinh(k d) cos phi

The accelerations are local, the convective terms are of second order. With E = e^(kz)/(1 - e^(-2kd)) and
g = e^(-2k(z+d)) the two ratios are E (1 + g) and E (1 - g), which do not overflow in deep water.

Linear theory ends at z = 0. Towards the instantaneous surface it is continued by one of STRETCHING:

    vertical       above z = 0 as at z = 0
    wheeler        as at z' = d (z - eta)/(d + eta), which is 0 at the surface and -d at the bed (Wheeler 1970)
    extrapolation  above z = 0 along the tangent at z = 0: f(0) + z df/dz(0)

Below the bed the water moves as at the bed; above the surface as at the surface for `wheeler`, else as said. A ramp
multiplies elevation, velocity and acceleration alike, as it does the loads on floaters.

**Many points, many waves.** In a long-crested sea u_s - i w is an analytic function of s + i z (its real and
imaginary parts satisfy Laplace's equation), and so is its rate. So the waves are summed at the middle of a run of
neighbouring points only, with the derivatives there, and a Taylor polynomial of degree ORDERS - 1 serves the points of
the run; the elevation is done alike along s. How far a run may reach follows from the truncated term in the r.m.s. of
the acceleration at the depth of its highest point (_TRUNCATED); waves that have died away there (_FADED) are left out.
In a short-crested sea each point has its own sum. Nothing is remembered from one time to the next: any jump of the
points or of the time, backwards too, gives the same as if it were the first call.
"""

from __future__ import annotations

import math
from typing import get_args

import numpy as np
from numpy.typing import ArrayLike

from floatsim.frames import Array
from floatsim.jit import kernel
from floatsim.sea.site import Current, Stretching, current_at
from floatsim.sea.waves import Realisation, ramp_factor

STRETCHING: tuple[str, ...] = get_args(Stretching)

ORDERS = 8  # terms of the Taylor series; even
_TRUNCATED = 1e-4  # of the r.m.s. acceleration, at the ends of a run of points
_FADED = 1e-4  # of the r.m.s. acceleration, in all waves left out
_LEVELS = 48  # of depth, at which reach and number of waves are tabulated

# rows of the waves; row SERIES + j is k^j/j!
K, OMEGA, PHASE, AMPLITUDE, SPEED, COS, SIN, SERIES = range(8)
# entries of the site
DEPTH, RAMP, METHOD, EXPONENT, DEEPEST, REACH, LONG_CRESTED = range(7)
# rows of the scratch: phase at the origin; sums' terms
THETA, CC, SS, CS, SC = range(5)

_FAST = {"reassoc", "contract"}


class Kinematics:
    """Water motion at chosen points, with the scratch for it: one per solver scratch.

    waves        realisation, or None in still water
    current      added to the velocity of the waves
    depth        m, that of the waves
    ramp         s, length of the cosine ramp at the start, none if 0
    stretching   one of STRETCHING
    points       rows of the arrays given to `move` at which the water is wanted; neighbours along a line in order
    """

    def __init__(
        self,
        waves: Realisation | None,
        current: Current,
        depth: float,
        ramp: float,
        stretching: Stretching,
        points: ArrayLike,
    ) -> None:
        self._points = np.ascontiguousarray(points, dtype=np.int64)
        self._current, exponent = current.packed()
        self._wave, long_crested = _packed(waves, depth)
        k = self._wave[K]
        deepest = min(depth, 20.0 / k.min()) if k.size else depth  # e^-40 below
        self._reach, elevation_reach = _reaches(self._wave, depth, deepest)
        method = STRETCHING.index(stretching)
        self._site = np.array([depth, ramp, method, exponent, deepest, elevation_reach, long_crested], dtype=np.float64)
        self._scratch = np.zeros((5, k.size))
        self._taylor = np.zeros((ORDERS, 2), dtype=np.complex128)

    def move(self, x: Array, t: float, u: Array, du: Array, eta: Array) -> None:
        """Water at the points at time t, s.

        x (n, 3): positions, m, world. Written in the rows of `points`, others are left alone: u (n, 3) velocity, m/s,
        current included; du (n, 3) its local rate, m/s2; eta (n,) surface elevation above the point, m.
        """
        _move(
            x, float(t), self._points, self._wave, self._current, self._site, self._reach, self._scratch, self._taylor,
            u, du, eta,
        )  # fmt: skip


def exact(
    waves: Realisation, x: ArrayLike, t: float, ramp: float = 0.0, stretching: Stretching = "vertical"
) -> tuple[Array, Array, Array]:
    """Velocity (n, 3), m/s, its local rate (n, 3), m/s2, and elevation (n,), m, at x (n, 3), m, and t, s.

    Wave by wave as printed at the top of this module, for single values and as the reference of `Kinematics`.
    """
    x = np.ascontiguousarray(x, dtype=np.float64)
    u, du, eta = np.zeros(x.shape), np.zeros(x.shape), np.zeros(len(x))
    wave, _ = _packed(waves, waves.depth)
    _exact(x, float(t), wave, waves.depth, float(ramp), STRETCHING.index(stretching), u, du, eta)
    return u, du, eta


def _packed(waves: Realisation | None, depth: float) -> tuple[Array, bool]:
    """Rows of the waves that have an amplitude, longest first, and whether all run the same way."""
    if waves is None:
        return np.zeros((SERIES + ORDERS, 0)), True
    order = np.argsort(waves.wave_number, kind="stable")
    order = order[waves.amplitude[order] > 0.0]
    k, w, a = waves.wave_number[order], waves.omega[order], waves.amplitude[order]
    b, phase = waves.heading[order], waves.phase[order]
    speed = a * w / -np.expm1(-2.0 * k * depth)
    series = [k**j / math.factorial(j) for j in range(ORDERS)]
    return np.stack([k, w, phase, a, speed, np.cos(b), np.sin(b), *series]), bool(np.all(b == b[:1]))


def _reaches(wave: Array, depth: float, deepest: float) -> tuple[Array, float]:
    """Reach, m, of a Taylor series and number of waves at each level of depth, (n, 2); and the elevation's reach."""
    k = wave[K]
    table = np.zeros((_LEVELS + 1, 2))
    if k.size == 0:
        return table, 0.0

    def reach(weight: Array) -> float:
        """r for which the first term left out, weight (k r)^n/n!, is _TRUNCATED of the total in the r.m.s."""
        share = np.linalg.norm(weight) / np.linalg.norm(weight * (k / k[-1]) ** ORDERS)
        return float((_TRUNCATED * share * math.factorial(ORDERS)) ** (1.0 / ORDERS) / k[-1])

    for i in range(_LEVELS + 1):
        z = _level(i, deepest)
        weight = wave[OMEGA] * wave[SPEED] * np.exp((k - k[0]) * z)  # relative to the longest, which decays least
        weight *= 1.0 + np.exp(-2.0 * k * (z + depth))
        rest = np.sqrt(np.cumsum(weight[::-1] ** 2)[::-1])
        table[i] = reach(weight), np.count_nonzero(rest > _FADED * rest[0])
    return table, reach(wave[AMPLITUDE])


def _level(i: int, deepest: float) -> float:
    """Depths of the table, closer together near the surface."""
    return -deepest * (i / _LEVELS) ** 2


@kernel
def _row(z, deepest):  # type: ignore[no-untyped-def]
    """Row of the table of reaches for z: that of the next level above it."""
    y = _LEVELS * math.sqrt(-z / deepest) if z < 0.0 else 0.0
    return int(y) if y < _LEVELS else _LEVELS


@kernel
def _stretched(z, eta, method, depth):  # type: ignore[no-untyped-def]
    """Height (z', at most 0) at which linear theory is asked, and how far above it the tangent is followed."""
    if method == 1:
        z = (z - eta) / (1.0 + eta / depth)
    low = min(max(z, -depth), 0.0)
    return low, (z if method == 2 and z > 0.0 else 0.0)


@kernel(fastmath={"contract"})
def _circle(phi):  # type: ignore[no-untyped-def]
    """cos and sin to 1e-8 in plain arithmetic, which LLVM vectorises: series for a quarter of the angle, doubled."""
    r = 0.25 * (phi - 2.0 * math.pi * np.floor(phi / (2.0 * math.pi) + 0.5))
    q = r * r
    s = r * (1.0 + q * (-1 / 6 + q * (1 / 120 + q * (-1 / 5040 + q * (1 / 362880)))))
    c = 1.0 + q * (-1 / 2 + q * (1 / 24 + q * (-1 / 720 + q * (1 / 40320 + q * (-1 / 3628800)))))
    s, c = 2.0 * s * c, c * c - s * s
    return c * c - s * s, 2.0 * s * c


@kernel(fastmath={"contract"})
def _decay(x):  # type: ignore[no-untyped-def]
    """e^x for x <= 0, to 1e-7 where it is above 1e-4: series for x/128, squared seven times; e^-40 is zero."""
    y = (x if x > -40.0 else -40.0) / 128
    y = 1.0 + y * (1.0 + y * (1 / 2 + y * (1 / 6 + y * (1 / 24 + y * (1 / 120)))))
    y = y * y
    y = y * y
    y = y * y
    y = y * y
    y = y * y
    y = y * y
    return y * y


@kernel(fastmath={"contract"})
def _elevation_terms(wave, s, scratch):  # type: ignore[no-untyped-def]
    for n in range(wave.shape[1]):
        c, sn = _circle(scratch[THETA, n] - wave[K, n] * s)
        scratch[CC, n], scratch[CS, n] = wave[AMPLITUDE, n] * c, wave[AMPLITUDE, n] * sn


@kernel(fastmath=_FAST)
def _elevation_pair(wave, scratch, j):  # type: ignore[no-untyped-def]
    """Sums for the orders j and j + 1, j even: a cos phi, then a sin phi."""
    even = odd = 0.0
    for n in range(wave.shape[1]):
        even += wave[SERIES + j, n] * scratch[CC, n]
        odd += wave[SERIES + j + 1, n] * scratch[CS, n]
    return even, odd


@kernel(fastmath={"contract"})
def _terms(wave, count, s, z, depth, scratch):  # type: ignore[no-untyped-def]
    """C cos, S sin, C sin and S cos of phi for the longest waves, C and S their horizontal and vertical speeds."""
    for n in range(count):
        k = wave[K, n]
        c, sn = _circle(scratch[THETA, n] - k * s)
        e = wave[SPEED, n] * _decay(k * z)
        g = _decay(-2.0 * k * (z + depth))
        C, S = e + e * g, e - e * g
        scratch[CC, n], scratch[SS, n], scratch[CS, n], scratch[SC, n] = C * c, S * sn, C * sn, S * c


@kernel(fastmath=_FAST)
def _pair(wave, scratch, count, j, taylor):  # type: ignore[no-untyped-def]
    """Coefficients of the orders j and j + 1, j even, of f = sum of cos(phi - i Y) and of df/dt, Y = k(z + d).

    cos(phi - i Y) = C cos + i S sin and sin(phi - i Y) = C sin - i S cos; by s + i z their derivatives are k sin and
    - k cos, by t - w sin and w cos.
    """
    a0 = a1 = a2 = a3 = b0 = b1 = b2 = b3 = 0.0
    for n in range(count):
        p, q, w = wave[SERIES + j, n], wave[SERIES + j + 1, n], wave[OMEGA, n]
        Cc, Ss, Cs, Sc = scratch[CC, n], scratch[SS, n], scratch[CS, n], scratch[SC, n]
        a0 += p * Cc
        a1 += p * Ss
        b0 += q * Cs
        b1 += q * Sc
        a2 += p * w * Cs
        a3 += p * w * Sc
        b2 += q * w * Cc
        b3 += q * w * Ss
    sign = 1.0 if j % 4 == 0 else -1.0
    taylor[j, 0] = sign * complex(a0, a1)
    taylor[j, 1] = sign * complex(-a2, a3)
    taylor[j + 1, 0] = sign * complex(b0, -b1)
    taylor[j + 1, 1] = sign * complex(b2, b3)


@kernel
def _along(x, p, wave):  # type: ignore[no-untyped-def]
    return x[p, 0] * wave[COS, 0] + x[p, 1] * wave[SIN, 0]


@kernel
def _elevations(x, points, wave, reach, scratch, taylor, ramp, eta):  # type: ignore[no-untyped-def]
    """eta at the points in a long-crested sea, run by run."""
    first = 0
    while first < points.size:
        low = high = _along(x, points[first], wave)
        last = first + 1
        while last < points.size:
            s = _along(x, points[last], wave)
            if not max(high, s) - min(low, s) <= 2.0 * reach:
                break
            low, high = min(low, s), max(high, s)
            last += 1
        middle = 0.5 * (low + high)
        orders = ORDERS if high > low else 2
        _elevation_terms(wave, middle, scratch)
        for j in range(0, orders, 2):
            even, odd = _elevation_pair(wave, scratch, j)
            sign = 1.0 if j % 4 == 0 else -1.0
            taylor[j, 0], taylor[j + 1, 0] = sign * even, sign * odd
        for i in range(first, last):
            d = _along(x, points[i], wave) - middle
            e = 0.0
            for j in range(orders - 1, -1, -1):
                e = taylor[j, 0].real + d * e
            eta[points[i]] = ramp * e
        first = last


@kernel
def _motions(x, points, wave, site, reach, scratch, taylor, ramp, u, du, eta):  # type: ignore[no-untyped-def]
    """u and du of the waves at the points in a long-crested sea, run by run, added to what is there."""
    depth, method, deepest = site[DEPTH], site[METHOD], site[DEEPEST]
    first = 0
    while first < points.size:
        p = points[first]
        s0 = s1 = _along(x, p, wave)
        z0, _ = _stretched(x[p, 2], eta[p], method, depth)
        z1 = z0
        row = _row(z1, deepest)
        last = first + 1
        while last < points.size:
            p = points[last]
            s = _along(x, p, wave)
            z, _ = _stretched(x[p, 2], eta[p], method, depth)
            top = _row(max(z1, z), deepest)
            ds, dz = max(s1, s) - min(s0, s), max(z1, z) - min(z0, z)
            if not ds * ds + dz * dz <= 4.0 * reach[top, 0] ** 2:
                break
            s0, s1, z0, z1, row = min(s0, s), max(s1, s), min(z0, z), max(z1, z), top
            last += 1
        count = int(reach[row, 1])
        s, z = 0.5 * (s0 + s1), 0.5 * (z0 + z1)
        orders = ORDERS if last > first + 1 else 2
        _terms(wave, count, s, z, depth, scratch)
        for j in range(0, orders, 2):
            _pair(wave, scratch, count, j, taylor)
        for i in range(first, last):
            p = points[i]
            low, above = _stretched(x[p, 2], eta[p], method, depth)
            d = complex(_along(x, p, wave) - s, low - z)
            f, rate = taylor[orders - 1, 0], taylor[orders - 1, 1]
            for j in range(orders - 2, -1, -1):
                f = taylor[j, 0] + d * f
                rate = taylor[j, 1] + d * rate
            if above > 0.0:
                slope, bend = 0.0j, 0.0j
                for j in range(orders - 1, 0, -1):
                    slope = j * taylor[j, 0] + d * slope
                    bend = j * taylor[j, 1] + d * bend
                f += 1j * above * slope
                rate += 1j * above * bend
            _add(u, p, wave, ramp * f)
            _add(du, p, wave, ramp * rate)
        first = last


@kernel
def _add(u, p, wave, f):  # type: ignore[no-untyped-def]
    """Add f = u_s - i w to the vector u[p]."""
    u[p, 0] += wave[COS, 0] * f.real
    u[p, 1] += wave[SIN, 0] * f.real
    u[p, 2] -= f.imag


@kernel(fastmath=_FAST)
def _short_crested_elevation(wave, x, y, scratch):  # type: ignore[no-untyped-def]
    """Elevation; leaves cos phi and sin phi of all waves in the scratch."""
    total = 0.0
    for n in range(wave.shape[1]):
        c, s = _circle(scratch[THETA, n] - wave[K, n] * (x * wave[COS, n] + y * wave[SIN, n]))
        scratch[CC, n], scratch[SS, n] = c, s
        total += wave[AMPLITUDE, n] * c
    return total


@kernel(fastmath=_FAST)
def _short_crested_motion(wave, count, z, above, depth, ramp, scratch, u, du, p):  # type: ignore[no-untyped-def]
    """Add u and du at one point, from the longest waves' cos phi and sin phi in the scratch."""
    ux = uy = uz = dux = duy = duz = 0.0
    for n in range(count):
        k, w, c, s = wave[K, n], wave[OMEGA, n], scratch[CC, n], scratch[SS, n]
        e = wave[SPEED, n] * _decay(k * z)
        g = _decay(-2.0 * k * (z + depth))
        C, S = e + e * g, e - e * g
        C, S = C + k * above * S, S + k * above * C
        ux += C * c * wave[COS, n]
        uy += C * c * wave[SIN, n]
        uz -= S * s
        dux -= w * C * s * wave[COS, n]
        duy -= w * C * s * wave[SIN, n]
        duz -= w * S * c
    u[p, 0] += ramp * ux
    u[p, 1] += ramp * uy
    u[p, 2] += ramp * uz
    du[p, 0] += ramp * dux
    du[p, 1] += ramp * duy
    du[p, 2] += ramp * duz


@kernel
def _move(x, t, points, wave, current, site, reach, scratch, taylor, u, du, eta):  # type: ignore[no-untyped-def]
    for i in range(points.size):
        p = points[i]
        u[p, 0], u[p, 1] = current_at(x[p, 2], site[DEPTH], current, site[EXPONENT])
        u[p, 2] = du[p, 0] = du[p, 1] = du[p, 2] = eta[p] = 0.0
    ramp = ramp_factor(t, site[RAMP])
    if wave.shape[1] == 0 or ramp == 0.0:
        return
    for n in range(wave.shape[1]):
        scratch[THETA, n] = wave[OMEGA, n] * t + wave[PHASE, n]
    if site[LONG_CRESTED] == 1.0:
        _elevations(x, points, wave, site[REACH], scratch, taylor, ramp, eta)
        _motions(x, points, wave, site, reach, scratch, taylor, ramp, u, du, eta)
        return
    for i in range(points.size):
        p = points[i]
        eta[p] = ramp * _short_crested_elevation(wave, x[p, 0], x[p, 1], scratch)
        z, above = _stretched(x[p, 2], eta[p], site[METHOD], site[DEPTH])
        count = int(reach[_row(z, site[DEEPEST]), 1])
        _short_crested_motion(wave, count, z, above, site[DEPTH], ramp, scratch, u, du, p)


@kernel
def _exact(x, t, wave, depth, ramp, method, u, du, eta):  # type: ignore[no-untyped-def]
    r = ramp_factor(t, ramp)
    for p in range(x.shape[0]):
        for n in range(wave.shape[1]):
            s = x[p, 0] * wave[COS, n] + x[p, 1] * wave[SIN, n]
            eta[p] += r * wave[AMPLITUDE, n] * math.cos(wave[OMEGA, n] * t - wave[K, n] * s + wave[PHASE, n])
        z, above = _stretched(x[p, 2], eta[p], method, depth)
        for n in range(wave.shape[1]):
            k, w = wave[K, n], wave[OMEGA, n]
            phi = w * t - k * (x[p, 0] * wave[COS, n] + x[p, 1] * wave[SIN, n]) + wave[PHASE, n]
            c, s = r * math.cos(phi), r * math.sin(phi)
            e, g = wave[SPEED, n] * math.exp(k * z), math.exp(-2.0 * k * (z + depth))
            C, S = e * (1.0 + g), e * (1.0 - g)
            C, S = C + k * above * S, S + k * above * C
            u[p, 0] += C * c * wave[COS, n]
            u[p, 1] += C * c * wave[SIN, n]
            u[p, 2] -= S * s
            du[p, 0] -= w * C * s * wave[COS, n]
            du[p, 1] -= w * C * s * wave[SIN, n]
            du[p, 2] -= w * S * c
