"""Bending of lines: an energy of the angle between neighbouring elements.

    U = k theta^2/2,  M = k theta,   k = 1/(l_a/(2 EI_a) + l_b/(2 EI_b)),   c_b thetadot^2/2 dissipated,

with unstretched lengths: each of the two half elements bends with its own stiffness, so a change of section needs
nothing else. Tables of the moment: laws/moment_table.py. Angle without a singular case: laws/angle.py.

The damper of a bent pair acts on the rate of the angle: two directions have no other objective rate.
Its direction is undefined in a straight line, so it fades out below 1e-4 rad.
"""

from __future__ import annotations

import math

from floatsim.frames import at, cross, dot, minus, times, vec
from floatsim.jit import kernel
from floatsim.laws.angle import half_angle_squared

_STRAIGHT = 1e-4  # rad; below this the bending damper fades out
_FOLDED = -0.9998  # cosine of 178.9 degrees: the pair is folded back on itself


@kernel
def from_table(tables, row, theta):  # type: ignore[no-untyped-def]
    """(M, dM/dtheta) from row `row` of tables (n, 2, m), angles and moments from 0 on; the last slope goes on."""
    i = 0
    last = tables.shape[2] - 2
    while i < last and theta > tables[row, 0, i + 1]:
        i += 1
    k = (tables[row, 1, i + 1] - tables[row, 1, i]) / (tables[row, 0, i + 1] - tables[row, 0, i])
    return tables[row, 1, i] + k * (theta - tables[row, 0, i]), k


@kernel
def bend(k, cb, tables, row, ta, ia, tb, ib, va, vb, c, f, K):  # type: ignore[no-untyped-def]
    """Bending between element a of direction t_a and length 1/i_a and element b, rates v_a and v_b of d_a and d_b.

    k [N m], cb [N m s]; row >= 0: a row of the moment tables instead of k. f (6): gradient by (d_a, d_b);
    K (6, 6): c[2] times its derivative by (d_a, d_b) plus c[1] times that by their rates. Returns the cosine.
    """
    co = dot(ta, tb)
    sx = cross(ta, tb)
    y = dot(sx, sx)  # squared sine
    f1, f2 = half_angle_squared(co, y)
    h1, h2 = k * f1, k * f2  # dU/dcos, d2U/dcos2
    if row >= 0:
        sine = math.sqrt(y)
        theta = math.atan2(sine, co)
        M, slope = from_table(tables, row, theta)
        h1, h2 = slope * f1, slope * f2
        if theta > tables[row, 0, 1]:  # beyond the first stretch M is not proportional to theta
            h1 = -M / sine
            h2 = (slope * sine - M * co) / (sine * y)
    ga = times(ia, (tb[0] - co * ta[0], tb[1] - co * ta[1], tb[2] - co * ta[2]))  # dcos/dd_a
    gb = times(ib, (ta[0] - co * tb[0], ta[1] - co * tb[1], ta[2] - co * tb[2]))
    cK, y2 = c[2], c[2] * h2
    D = rate = 1.0
    if cb > 0.0:
        rate = dot(ga, va) + dot(gb, vb)
        D = 1.0 - co * co + _STRAIGHT * _STRAIGHT
        q = cb * rate / D
        h1 += q
        y2 += 2.0 * cK * q * co / D + c[1] * cb / D
    for m in range(3):
        f[m] = h1 * ga[m]
        f[m + 3] = h1 * gb[m]
    if c[6] == 0.0:
        return co
    y1 = cK * h1
    za, zb, zab = y1 * ia, y1 * ib, y1 * ia * ib
    ca, cb2 = za * co * ia, zb * co * ib
    for m in range(3):
        for n in range(m + 1):
            aa = y2 * ga[m] * ga[n] - za * (ta[m] * ga[n] + ga[m] * ta[n]) + ca * ta[m] * ta[n]
            bb = y2 * gb[m] * gb[n] - zb * (tb[m] * gb[n] + gb[m] * tb[n]) + cb2 * tb[m] * tb[n]
            if m == n:
                aa -= ca
                bb -= cb2
            K[m, n] = K[n, m] = aa
            K[m + 3, n + 3] = K[n + 3, m + 3] = bb
        for n in range(3):
            ab = y2 * ga[m] * gb[n] - zab * tb[m] * tb[n] - za * ta[m] * gb[n]
            if m == n:
                ab += zab
            K[m, n + 3] = K[n + 3, m] = ab
    if cb > 0.0:  # the rate of the cosine depends on the configuration: g (H v)^T
        _rate_tangent(cK * cb / D, ia, ib, co, ta, tb, ga, gb, va, vb, K)
    return co


@kernel
def _rate_tangent(y, ia, ib, co, ta, tb, ga, gb, va, vb, K):  # type: ignore[no-untyped-def]
    for n in range(3):
        hv_a = hv_b = 0.0
        for m in range(3):
            e = 1.0 if m == n else 0.0
            aa = -ia * (ta[m] * ga[n] + ga[m] * ta[n] + co * ia * (e - ta[m] * ta[n]))
            bb = -ib * (tb[m] * gb[n] + gb[m] * tb[n] + co * ib * (e - tb[m] * tb[n]))
            ab = ia * (ib * (e - tb[m] * tb[n]) - ta[m] * gb[n])
            ba = ia * (ib * (e - tb[n] * tb[m]) - ta[n] * gb[m])
            hv_a += aa * va[m] + ba * vb[m]
            hv_b += ab * va[m] + bb * vb[m]
        for m in range(3):
            K[m, n] += y * ga[m] * hv_a
            K[m, n + 3] += y * ga[m] * hv_b
            K[m + 3, n] += y * gb[m] * hv_a
            K[m + 3, n + 3] += y * gb[m] * hv_b


@kernel
def line_bending(x, v, c, pairs, B, tables, slots, direct, step, f, K, A, r, s):  # type: ignore[no-untyped-def]
    """Bending at every node between two elements; returns the index of a folded pair, or -1.

    pairs (n, 5): points of element a and of element b, row of the moment tables or -1; B (n, 2): k [N m], damping
    [N m s]. slots (n, 144) into A; where direct >= 0, the nine unknowns of the three points stand in a band: entry
    (m, n) at direct + m step + n. Scratch: f (6), K (6, 6).
    """
    folded = last0 = last1 = -1
    tb, ib, vb = (0.0, 0.0, 0.0), 0.0, (0.0, 0.0, 0.0)
    for e in range(pairs.shape[0]):
        k, damping = B[e, 0], B[e, 1]
        if k == 0.0 and damping == 0.0:
            continue
        i0, i1, j0, j1 = pairs[e, 0], pairs[e, 1], pairs[e, 2], pairs[e, 3]
        ta, ia, va = tb, ib, vb  # along a line the second element of a pair is the first of the next
        if i0 != last0 or i1 != last1:
            d = minus(vec(x, i1), vec(x, i0))
            ia = 1.0 / math.sqrt(dot(d, d))
            ta, va = times(ia, d), minus(at(v, 3 * i1), at(v, 3 * i0))
        d = minus(vec(x, j1), vec(x, j0))
        ib = 1.0 / math.sqrt(dot(d, d))
        tb, vb = times(ib, d), minus(at(v, 3 * j1), at(v, 3 * j0))
        last0, last1 = j0, j1
        co = bend(k, damping, tables, pairs[e, 4], ta, ia, tb, ib, va, vb, c, f, K)
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
        if c[6] == 0.0:
            continue
        o = direct[e]
        if o >= 0:  # from derivatives by d_a = x1 - x0 and d_b = x2 - x1 to those by x0, x1, x2
            for m in range(3):
                p0 = o + m * step
                p1, p2 = p0 + 3 * step, p0 + 6 * step
                for n in range(3):
                    aa, ab, ba, bb = K[m, n], K[m, n + 3], K[m + 3, n], K[m + 3, n + 3]
                    A[p0 + n] += aa
                    A[p0 + n + 3] += ab - aa
                    A[p0 + n + 6] -= ab
                    A[p1 + n] += ba - aa
                    A[p1 + n + 3] += aa - ab - ba + bb
                    A[p1 + n + 6] += ab - bb
                    A[p2 + n] -= ba
                    A[p2 + n + 3] += ba - bb
                    A[p2 + n + 6] += bb
        else:
            for bm in range(4):
                for bn in range(4):
                    sign = 1.0 if (bm + bn) % 2 == 0 else -1.0
                    for m in range(3):
                        for n in range(3):
                            y = K[3 * (bm // 2) + m, 3 * (bn // 2) + n]
                            A[slots[e, 12 * (3 * bm + m) + 3 * bn + n]] += sign * y
    return folded
