"""Hydrostatic and Froude-Krylov force on the instantaneous wet surface of a hull, a mesh of triangles.

The pressure of still water and of the incident waves, as they would be without the body,

    p = - rho g z + rho g sum a cosh k(z' + d)/cosh(k d) cos(w t - k(x cos b + y sin b) + phase),
    z' = d (z - eta)/(d + eta),

Airy's with Wheeler's (1970) stretching, so that p = 0 on the waves' surface z = eta, integrated over what is below it:

    F = - int p n dA          M = - int p r x n dA,      r from the reference point.

p is taken at the vertices. Between them p and the height s = z - eta over the surface are linear: a triangle across
the surface is cut where s = 0, and p = 0 there. On a flat (cut) triangle int p dA and int p r dA are then exact, so in
still water the force is rho g V of the polyhedron to the last digit, has a potential, and its moment too; in waves the
error falls with the square of the triangles' size. (A piece with four corners is the mean of its two divisions, which
keeps symmetric hulls symmetric.)

In body axes the triangles never change: F and M are sums of vertex pressures with constant weights W, but for the
triangles that are cut. The tangent, with dp = grad p . (dx + dtheta x r) at each vertex and the cuts moving with s, is
exact for these sums. During the Newton iterations of a step the waves stand still, eta and c in

    p = - rho g s (1 - c)

as linear functions of place: value and gradient at each vertex, taken where it will be if the body's acceleration
stays, which is off by less than h^3. In this form p vanishes where s does, wherever the iterations lead, and a vertex
that gets wet brings no jump. In still water c = 0, and nothing is approximate.

No current, no diffraction and no radiation here: those are linear (hydro/floater.py) or left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from floatsim.frames import Array, cross, minus, plus, rotate, set_matrix, times, turn_quaternion, unit, unrotate, vec
from floatsim.jit import kernel
from floatsim.parts.part import Output, Part
from floatsim.sea.kinematics import _circle, _decay
from floatsim.sea.waves import Realisation, ramp_factor

Index = NDArray[np.int64]

# rows of the waves, the longest first, and of their scratch
K, KX, KY, AMPLITUDE, SHARE, OMEGA, PHASE = range(7)
THETA, COS, SIN = range(3)
# columns of the field at a vertex: c = C + CX x + CY y + CZ z, eta = E + EX x + EY y
C, CX, CY, CZ, E, EX, EY = range(7)
# columns of the state of a vertex: height over the surface, pressure, - dp/ds
HEIGHT, PRESSURE, FALL = range(3)
_NEAR, _AT = 1e-3, 1e-6  # of the highest crest: heights below which the gradient of c, c itself are lost in rounding
_FADED = 14.0  # k z' below which a wave is left out: e^-14 = 8e-7
_FAST = {"reassoc", "contract"}


class HullLoads(Part):
    """The loads on the wet surface of one body's hull."""

    name: str
    body: Any
    hull: Any

    @staticmethod
    def batch() -> type[HullBatch]:
        return HullBatch


# --- the waves ----------------------------------------------------------------------------------


@kernel(fastmath=_FAST)
def _elevation(wave, x, y, scratch):  # type: ignore[no-untyped-def]
    """eta and its slopes; leaves cos and sin of all phases in the scratch."""
    e = ex = ey = 0.0
    for n in range(wave.shape[1]):
        c, s = _circle(scratch[THETA, n] - wave[KX, n] * x - wave[KY, n] * y)
        scratch[COS, n], scratch[SIN, n] = c, s
        a = wave[AMPLITUDE, n]
        e += a * c
        ex += a * wave[KX, n] * s
        ey += a * wave[KY, n] * s
    return e, ex, ey


@kernel(fastmath=_FAST)
def _pressure(wave, count, z, depth, scratch):  # type: ignore[no-untyped-def]
    """p/(rho g) and its gradient at z <= 0 of the `count` longest waves, from their cos and sin in the scratch."""
    p = px = py = pz = 0.0
    for n in range(count):
        k = wave[K, n]
        e = wave[SHARE, n] * _decay(k * z)
        g = _decay(-2.0 * k * (z + depth))
        cosh, sinh = e + e * g, e - e * g
        c, s = cosh * scratch[COS, n], cosh * scratch[SIN, n]
        p += c
        px += wave[KX, n] * s
        py += wave[KY, n] * s
        pz += k * sinh * scratch[COS, n]
    return p, px, py, pz


@kernel
def _lasting(wave, z):  # type: ignore[no-untyped-def]
    """How many of the waves have not died away at z <= 0; they stand in the order of k."""
    low, high = 0, wave.shape[1]
    while low < high:
        mid = (low + high) // 2
        if wave[K, mid] * z > -_FADED:
            low = mid + 1
        else:
            high = mid
    return low


@kernel
def wave_field(x, q, v, a, p, k, h, t, V, reach, wave, site, scratch, R, D):  # type: ignore[no-untyped-def]
    """Field D at the vertices V at time t, where point p and rotation k will be after h if their accelerations stay.

    x (n + 1, 3), q: state; v, a: velocities, angular ones from 3 len(x) on. reach (m,): longest side at each vertex.
    site: depth, ramp, highest crest. R (1, 3, 3): scratch.

    Only the vertices of triangles that are above every crest are left out: a dry vertex needs eta as well, or the
    sides that lead up to it are cut in the wrong place, an error of the waves' own order.
    """
    depth = site[0]
    ramp = ramp_factor(t, site[1])
    o, w = 3 * p, 3 * x.shape[0] + 3 * k
    turn = (
        h * (v[w] + 0.5 * h * a[w]), h * (v[w + 1] + 0.5 * h * a[w + 1]), h * (v[w + 2] + 0.5 * h * a[w + 2])
    )  # fmt: skip
    set_matrix(R, 0, turn_quaternion(turn, (q[k, 0], q[k, 1], q[k, 2], q[k, 3])))
    place = (
        x[p, 0] + h * (v[o] + 0.5 * h * a[o]), x[p, 1] + h * (v[o + 1] + 0.5 * h * a[o + 1]),
        x[p, 2] + h * (v[o + 2] + 0.5 * h * a[o + 2]),
    )  # fmt: skip
    for n in range(wave.shape[1]):
        scratch[THETA, n] = wave[OMEGA, n] * t + wave[PHASE, n]
    for i in range(V.shape[0]):
        X, Y, Z = plus(place, rotate(R, 0, vec(V, i)))
        for j in range(7):
            D[i, j] = 0.0
        if ramp == 0.0 or site[2] + reach[i] < Z:
            continue
        e, ex, ey = _elevation(wave, X, Y, scratch)
        e, ex, ey = ramp * e, ramp * ex, ramp * ey
        D[i, E], D[i, EX], D[i, EY] = e - ex * X - ey * Y, ex, ey
        s = Z - e
        if s >= -_AT * site[2]:
            continue
        stretch = 1.0 / (1.0 + e / depth)
        z = max(s * stretch, -depth)
        f, fx, fy, fz = _pressure(wave, _lasting(wave, z), z, depth, scratch)
        c = (ramp * f - e) / s
        D[i, C] = c
        if s < -_NEAR * site[2]:
            fz *= ramp
            lift = -fz * (1.0 + Z / depth) * stretch * stretch  # dp/deta; dz'/dz is the stretch
            cx = (ramp * fx + lift * ex - ex + c * ex) / s
            cy = (ramp * fy + lift * ey - ey + c * ey) / s
            cz = (fz * stretch - c) / s
            D[i, C] = c - cx * X - cy * Y - cz * Z
            D[i, CX], D[i, CY], D[i, CZ] = cx, cy, cz


# --- the integrals ------------------------------------------------------------------------------


@kernel
def heights_and_pressures(x, R, p, k, rho_g, V, D, S):  # type: ignore[no-untyped-def]
    """S (n, 3) at the vertices."""
    for i in range(V.shape[0]):
        r = rotate(R, k, vec(V, i))
        X, Y, Z = x[p, 0] + r[0], x[p, 1] + r[1], x[p, 2] + r[2]
        s = Z - (D[i, E] + D[i, EX] * X + D[i, EY] * Y)
        S[i, HEIGHT] = s
        S[i, FALL] = rho_g * (1.0 - (D[i, C] + D[i, CX] * X + D[i, CY] * Y + D[i, CZ] * Z))
        S[i, PRESSURE] = -S[i, FALL] * s


@kernel
def _odd_one(S, T, t):  # type: ignore[no-untyped-def]
    """How many corners of triangle t are wet, and its corners from the one that is not like the two others on."""
    i, j, k = T[t, 0], T[t, 1], T[t, 2]
    a, b, c = S[i, 0] < 0.0, S[j, 0] < 0.0, S[k, 0] < 0.0
    if b == c:
        return int(a) + int(b) + int(c), i, j, k
    if a == c:
        return int(a) + int(b) + int(c), j, k, i
    return int(a) + int(b) + int(c), k, i, j


@kernel
def _area(a, b, c):  # type: ignore[no-untyped-def]
    """Area times outward normal."""
    return times(0.5, cross(minus(b, a), minus(c, a)))


@kernel
def _alone(a, b, c, y, z):  # type: ignore[no-untyped-def]
    """Weights of the pressure at a, the only wet corner: the sides to b and c are wet over their shares y and z.

    (f, m): int p dA = f p A and int p r dA = m p A; then their derivatives by y and by z.
    """
    eb, ec = minus(b, a), minus(c, a)
    l = plus(times(4.0, a), plus(times(y, eb), times(z, ec)))
    return (
        y * z / 3.0, times(y * z / 12.0, l),
        z / 3.0, times(z / 12.0, plus(l, times(y, eb))),
        y / 3.0, times(y / 12.0, plus(l, times(z, ec))),
    )  # fmt: skip


@kernel
def _one_of_two(a, b, c, y, z):  # type: ignore[no-untyped-def]
    """The same for b, wet as c is: the sides from b to a and from c to a are wet over their shares y and z.

    The mean of the divisions (b, c, c'), (b, c', b') and (b, c, b'), (c, c', b').
    """
    eb, ec = minus(a, b), minus(a, c)
    b2, c2 = plus(b, times(y, eb)), plus(c, times(z, ec))
    bb = plus(b, b)
    near_c, both, near_b = plus(bb, plus(c, c2)), plus(bb, plus(b2, c2)), plus(bb, plus(c, b2))
    m = plus(times(z, near_c), plus(times(y * (1.0 - z), both), times(y, near_b)))
    my = plus(plus(times(1.0 - z, both), near_b), times(y * (2.0 - z), eb))
    mz = plus(minus(near_c, times(y, both)), times(z + y * (1.0 - z), ec))
    return (
        (z + 2.0 * y - y * z) / 6.0, times(1.0 / 24.0, m),
        (2.0 - z) / 6.0, times(1.0 / 24.0, my),
        (1.0 - y) / 6.0, times(1.0 / 24.0, mz),
    )  # fmt: skip


@kernel
def _all_wet(a, b, c):  # type: ignore[no-untyped-def]
    """int p r dA of a wet triangle for the pressure at a, over p A; int p dA is 1/3 of it."""
    return times(1.0 / 12.0, plus(plus(a, a), plus(b, c)))


@kernel
def _wet_share(S, wet, dry):  # type: ignore[no-untyped-def]
    return S[wet, 0] / (S[wet, 0] - S[dry, 0])


@kernel
def _add(f, p, n, share, arm):  # type: ignore[no-untyped-def]
    """Add the wrench of a pressure p: int p dA = share p A, int p r dA = arm p A, n the area vector."""
    m = cross(arm, n)
    for j in range(3):
        f[j] -= p * share * n[j]
        f[3 + j] -= p * m[j]


@kernel
def wet_weights(V, T, W):  # type: ignore[no-untyped-def]
    """W (n, 6): force and moment of a unit of pressure at each vertex, all triangles wet."""
    for t in range(T.shape[0]):
        for j in range(3):
            i = T[t, j]
            a, b, c = vec(V, i), vec(V, T[t, (j + 1) % 3]), vec(V, T[t, (j + 2) % 3])
            _add(W[i], 1.0, _area(a, b, c), 1.0 / 3.0, _all_wet(a, b, c))


@kernel
def wrench(S, V, T, W, f):  # type: ignore[no-untyped-def]
    """f (6,): force and moment of the pressures where heights are negative, body axes."""
    for j in range(6):
        f[j] = 0.0
    for i in range(V.shape[0]):
        if S[i, 0] < 0.0:
            for j in range(6):
                f[j] += W[i, j] * S[i, PRESSURE]
    for t in range(T.shape[0]):
        count, i, j, k = _odd_one(S, T, t)
        if count == 0 or count == 3:
            continue
        a, b, c = vec(V, i), vec(V, j), vec(V, k)
        n = _area(a, b, c)
        if count == 1:
            share, arm, _, _, _, _ = _alone(a, b, c, _wet_share(S, i, j), _wet_share(S, i, k))
            _add(f, S[i, PRESSURE], n, share - 1.0 / 3.0, minus(arm, _all_wet(a, b, c)))
        else:
            y, z = _wet_share(S, j, i), _wet_share(S, k, i)
            share, arm, _, _, _, _ = _one_of_two(a, b, c, y, z)
            _add(f, S[j, PRESSURE], n, share - 1.0 / 3.0, minus(arm, _all_wet(b, c, a)))
            share, arm, _, _, _, _ = _one_of_two(a, c, b, z, y)
            _add(f, S[k, PRESSURE], n, share - 1.0 / 3.0, minus(arm, _all_wet(c, a, b)))


@kernel
def _spread(K6, p, n, share, arm, g, l):  # type: ignore[no-untyped-def]
    """Add the change of the wrench of `_add` if p changes by g . dx + l . dtheta per unit (body axes)."""
    m = cross(arm, n)
    for i in range(3):
        for j in range(3):
            K6[i, j] -= p * share * n[i] * g[j]
            K6[i, 3 + j] -= p * share * n[i] * l[j]
            K6[3 + i, j] -= p * m[i] * g[j]
            K6[3 + i, 3 + j] -= p * m[i] * l[j]


@kernel
def _height_rates(R, k, V, D, i):  # type: ignore[no-untyped-def]
    """Change of the height s of vertex i by translation and by turning, body axes."""
    g = unrotate(R, k, (-D[i, EX], -D[i, EY], 1.0))
    return g, cross(vec(V, i), g)


@kernel
def _pressure_rates(R, k, rho_g, S, V, D, i):  # type: ignore[no-untyped-def]
    """The same of its pressure: grad p = - rho g (1 - c) grad s + rho g s grad c."""
    fall, q = S[i, FALL], rho_g * S[i, HEIGHT]
    g = unrotate(R, k, (fall * D[i, EX] + q * D[i, CX], fall * D[i, EY] + q * D[i, CY], q * D[i, CZ] - fall))
    return g, cross(vec(V, i), g)


@kernel
def _share_rates(R, k, S, V, D, wet, dry):  # type: ignore[no-untyped-def]
    """Change of the wet share of a side."""
    g, l = _height_rates(R, k, V, D, wet)
    g2, l2 = _height_rates(R, k, V, D, dry)
    s, s2 = S[wet, 0], S[dry, 0]
    f = 1.0 / ((s - s2) * (s - s2))
    return minus(times(s * f, g2), times(s2 * f, g)), minus(times(s * f, l2), times(s2 * f, l))


@kernel
def tangent(R, k, rho_g, S, V, T, W, D, K6):  # type: ignore[no-untyped-def]
    """K6 (6, 6): derivative of `wrench` by translations and turns of the body, all in body axes, n and r fixed."""
    for i in range(6):
        for j in range(6):
            K6[i, j] = 0.0
    for i in range(V.shape[0]):
        if S[i, 0] < 0.0:
            g, l = _pressure_rates(R, k, rho_g, S, V, D, i)
            for m in range(6):
                w = W[i, m]
                for n in range(3):
                    K6[m, n] += w * g[n]
                    K6[m, 3 + n] += w * l[n]
    for t in range(T.shape[0]):
        count, i, j, k2 = _odd_one(S, T, t)
        if count == 0 or count == 3:
            continue
        a, b, c = vec(V, i), vec(V, j), vec(V, k2)
        area = _area(a, b, c)
        if count == 1:
            y, z = _wet_share(S, i, j), _wet_share(S, i, k2)
            dy, dz = _share_rates(R, k, S, V, D, i, j), _share_rates(R, k, S, V, D, i, k2)
            _cut(K6, R, k, rho_g, S, V, D, i, area, _alone(a, b, c, y, z), _all_wet(a, b, c), dy, dz)
        else:
            y, z = _wet_share(S, j, i), _wet_share(S, k2, i)
            dy, dz = _share_rates(R, k, S, V, D, j, i), _share_rates(R, k, S, V, D, k2, i)
            _cut(K6, R, k, rho_g, S, V, D, j, area, _one_of_two(a, b, c, y, z), _all_wet(b, c, a), dy, dz)
            _cut(K6, R, k, rho_g, S, V, D, k2, area, _one_of_two(a, c, b, z, y), _all_wet(c, a, b), dz, dy)


@kernel
def _cut(K6, R, k, rho_g, S, V, D, i, area, weights, full, dy, dz):  # type: ignore[no-untyped-def]
    """Tangent of a cut triangle's share of the pressure at its wet corner i, less what is in W of it."""
    share, arm, share_y, arm_y, share_z, arm_z = weights
    g, l = _pressure_rates(R, k, rho_g, S, V, D, i)
    _spread(K6, 1.0, area, share - 1.0 / 3.0, minus(arm, full), g, l)
    _spread(K6, S[i, PRESSURE], area, share_y, arm_y, dy[0], dy[1])
    _spread(K6, S[i, PRESSURE], area, share_z, arm_z, dz[0], dz[1])


@kernel
def hull_loads(x, R, c, where, sizes, V, T, W, D, S, f, K6, slots, A, r, s):  # type: ignore[no-untyped-def]
    """Loads of one hull into residual and matrix. where: point, rotation; sizes: a small lever of its
    moments, m; rho g."""
    p, k = where[0], where[1]
    heights_and_pressures(x, R, p, k, sizes[1], V, D, S)
    wrench(S, V, T, W, f)
    F, M = rotate(R, k, (f[0], f[1], f[2])), rotate(R, k, (f[3], f[4], f[5]))
    o, w = 3 * p, 3 * x.shape[0] + 3 * k
    total = 0.0
    for j in range(3):
        r[o + j] -= F[j]
        r[w + j] -= M[j]
        total += abs(F[j])
        s[x.shape[0] + k] += abs(M[j])
    s[p] += total
    s[x.shape[0] + k] += sizes[0] * total
    if c[6] == 0.0:
        return
    tangent(R, k, sizes[1], S, V, T, W, D, K6)
    for j in range(6):
        e = unit(j % 3)
        b, h = unrotate(R, k, e), 3 * (j // 3)
        for half in range(2):
            o = 3 * half
            d = rotate(R, k, (
                K6[o, h] * b[0] + K6[o, h + 1] * b[1] + K6[o, h + 2] * b[2],
                K6[o + 1, h] * b[0] + K6[o + 1, h + 1] * b[1] + K6[o + 1, h + 2] * b[2],
                K6[o + 2, h] * b[0] + K6[o + 2, h + 1] * b[1] + K6[o + 2, h + 2] * b[2],
            ))  # fmt: skip
            if j > 2:  # the wrench turns with the body
                d = plus(d, cross(e, F if half == 0 else M))
            for i in range(3):
                A[slots[6 * (o + i) + j]] -= c[2] * d[i]


@kernel
def buoyancy_energy(S, V, T, R, k):  # type: ignore[no-untyped-def]
    """- int z dV of what is below the surface of still water, from the heights S over it: - int z^2/2 n_z dA.

    Exact: of a triangle the mean of z^2 is (a^2 + b^2 + c^2 + ab + bc + ca)/6, and what is left of one with two wet
    corners when the dry one is cut off is the whole less the dry piece.
    """
    U = 0.0
    for t in range(T.shape[0]):
        count, i, j, m = _odd_one(S, T, t)
        if count == 0:
            continue
        a, b, c = S[i, 0], S[j, 0], S[m, 0]
        if count == 1:
            mean = _wet_share(S, i, j) * _wet_share(S, i, m) * a * a / 6.0
        else:
            mean = (a * a + b * b + c * c + a * b + b * c + c * a) / 6.0
            if count == 2:
                mean -= (1.0 - _wet_share(S, j, i)) * (1.0 - _wet_share(S, m, i)) * a * a / 6.0
        n = rotate(R, k, _area(vec(V, i), vec(V, j), vec(V, m)))
        U -= 0.5 * mean * n[2]
    return U


# --- the batch ----------------------------------------------------------------------------------


class _Wet:
    """Arrays of one hull: vertices V, triangles T, longest sides at V, weights W, field D, heights and pressures S."""

    def __init__(self, hull: Any, rho_g: float) -> None:
        self.V = np.ascontiguousarray(hull.surface.vertices)
        self.T = np.ascontiguousarray(hull.surface.faces)
        n = len(self.V)
        self.reach = np.zeros(n)
        for j in range(3):
            a, b = self.T[:, j], self.T[:, (j + 1) % 3]
            side = np.linalg.norm(self.V[a] - self.V[b], axis=1)
            np.maximum.at(self.reach, a, side)
            np.maximum.at(self.reach, b, side)
        self.W, self.D, self.S = np.zeros((n, 6)), np.zeros((n, 7)), np.zeros((n, 3))
        wet_weights(self.V, self.T, self.W)
        self.sizes = np.array([1e-3 * float(np.linalg.norm(np.ptp(self.V, axis=0))), rho_g])


class HullBatch:
    """Loads on the wet surfaces of all hulls."""

    runs: ClassVar[list[tuple[int, int]]] = []
    remembers: ClassVar[bool] = False

    def __init__(self, parts: Sequence[HullLoads], first_point: Sequence[int], first_rotation: Sequence[int],
                 sea: Any, gravity: float) -> None:  # fmt: skip
        self.parts = tuple(parts)
        self.hulls = [_Wet(part.hull, sea.density * gravity) for part in parts]
        self._bodies = list(dict.fromkeys(part.body.name for part in parts))
        self._depth = sea.depth
        self.set_waves(None if sea.waves is None else sea.waves.realise(sea.depth, gravity), sea.wave_ramp)
        self._f, self._K, self._R = np.zeros(6), np.zeros((6, 6)), np.zeros((1, 3, 3))

    def set_waves(self, waves: Realisation | None, ramp: float = 0.0) -> None:
        """Take these waves from now on, with a ramp [s]."""
        self._wave = _packed(waves, self._depth)
        crest = float(self._wave[AMPLITUDE].sum())
        self._site = np.array([self._depth, ramp, crest])
        self._scratch = np.zeros((3, self._wave.shape[1]))

    def connect(self, numbering: Any) -> None:
        """Find the bodies' points and rotations."""
        places = [numbering.place(part.body.name) for part in self.parts]
        self.where = np.array([[p.point, p.rotation] for p in places], dtype=np.int64)

    def dofs(self, n_point: int) -> list[Index]:
        xyz, w = np.arange(3), self.where
        return [np.concatenate([3 * w[:, :1] + xyz, 3 * (n_point + 1) + 3 * w[:, 1:] + xyz], axis=1)]

    def bind(self, slots: list[Index]) -> None:
        self._slots = [np.ascontiguousarray(row) for row in slots[0]]

    def begin(self, w: Any, history: Any, t: float, state: Any) -> None:
        """The field that stays during the step: still water, or waves where the vertices will be."""
        for hull, (p, k) in zip(self.hulls, self.where, strict=True):
            if w.still or self._wave.shape[1] == 0:
                hull.D.fill(0.0)
            else:
                wave_field(state.x, state.q, state.v, state.a, p, k, t - state.t, t, hull.V, hull.reach, self._wave,
                           self._site, self._scratch, self._R, hull.D)  # fmt: skip

    def add(self, w: Any) -> None:
        for hull, where, slots in zip(self.hulls, self.where, self._slots, strict=True):
            hull_loads(w.x, w.R, w.c, where, hull.sizes, hull.V, hull.T, hull.W, hull.D, hull.S, self._f, self._K,
                       slots, w.A, w.r, w.s)  # fmt: skip

    def outputs(self) -> list[Output]:
        """Force on each body's hull and the volume it displaces."""
        out = []
        for name in self._bodies:
            text = "hydrostatic and Froude-Krylov force on the wet surface of"
            out += [Output(f"{name}_hull_force", f"{text} {name}", "N", ("xyz",)),
                    Output(f"{name}_displaced_volume", f"volume of {name} below the waves' surface", "m3")]  # fmt: skip
        return out

    def measure(self, w: Any, out: Array) -> None:
        """Fill the outputs. The volume is the integral of s n_z over the wet surface: s is zero on the water's."""
        out[:] = 0.0
        for part, hull, (p, k) in zip(self.parts, self.hulls, self.where, strict=True):
            mine = out[4 * self._bodies.index(part.body.name) :]
            heights_and_pressures(w.x, w.R, p, k, hull.sizes[1], hull.V, hull.D, hull.S)
            wrench(hull.S, hull.V, hull.T, hull.W, self._f)
            mine[:3] += w.R[k] @ self._f[:3]
            hull.S[:, PRESSURE] = hull.S[:, HEIGHT]
            wrench(hull.S, hull.V, hull.T, hull.W, self._f)
            mine[3] -= w.R[k, 2] @ self._f[:3]

    def ledger(self, w: Any, book: Any) -> None:
        """U = - rho g int z dV in still water; all that the waves change is their work."""
        n = len(w.x)
        for hull, (p, k) in zip(self.hulls, self.where, strict=True):
            v = np.concatenate([w.v[3 * p : 3 * p + 3] @ w.R[k], w.v[3 * (n + k) : 3 * (n + k) + 3] @ w.R[k]])
            power = []
            for D in (hull.D, np.zeros_like(hull.D)):
                heights_and_pressures(w.x, w.R, p, k, hull.sizes[1], hull.V, D, hull.S)
                wrench(hull.S, hull.V, hull.T, hull.W, self._f)
                power.append(self._f @ v)
            U = hull.sizes[1] * buoyancy_energy(hull.S, hull.V, hull.T, w.R, k)
            book.store("hydrostatic", U, -power[1])
            book.work("wave", power[0] - power[1])


def _packed(waves: Realisation | None, depth: float) -> Array:
    """Rows of the waves that have an amplitude, longest first."""
    if waves is None:
        return np.zeros((7, 0))
    order = np.argsort(waves.wave_number, kind="stable")
    order = order[waves.amplitude[order] > 0.0]
    k, a, b = waves.wave_number[order], waves.amplitude[order], waves.heading[order]
    share = a / (1.0 + np.exp(-2.0 * k * depth))
    return np.stack([k, k * np.cos(b), k * np.sin(b), a, share, waves.omega[order], waves.phase[order]])
