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
def bend(k, cb, tables, row, da, db, va, vb, c, f, K):  # type: ignore[no-untyped-def]
    """Bending between element a with d_a and element b with d_b (3-tuples), rates va and vb.

    k [N m], cb [N m s]; row >= 0: a row of the moment tables instead of k. f (6): gradient by (d_a, d_b);
    K (6, 6): c[2] times its derivative by (d_a, d_b) plus c[1] times that by their rates. Returns the cosine.
    """
    la, lb = math.sqrt(dot(da, da)), math.sqrt(dot(db, db))
    ia, ib = 1.0 / la, 1.0 / lb
    ta, tb = times(ia, da), times(ib, db)
    co = dot(ta, tb)
    sx = cross(ta, tb)
    sine = math.sqrt(dot(sx, sx))
    theta, f1, f2 = half_angle_squared(co, sine)
    h1, h2 = k * f1, k * f2  # dU/dcos, d2U/dcos2
    if row >= 0:
        M, slope = from_table(tables, row, theta)
        h1, h2 = slope * f1, slope * f2
        if theta > tables[row, 0, 1]:  # beyond the first stretch M is not proportional to theta
            h1 = -M / sine
            h2 = (slope * sine - M * co) / (sine * sine * sine)
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
    for m in range(3):
        for n in range(m + 1):
            e = 1.0 if m == n else 0.0
            aa = -ia * (ta[m] * ga[n] + ga[m] * ta[n] + co * ia * (e - ta[m] * ta[n]))
            bb = -ib * (tb[m] * gb[n] + gb[m] * tb[n] + co * ib * (e - tb[m] * tb[n]))
            K[m, n] = K[n, m] = y2 * ga[m] * ga[n] + y1 * aa
            K[m + 3, n + 3] = K[n + 3, m + 3] = y2 * gb[m] * gb[n] + y1 * bb
        for n in range(3):
            e = 1.0 if m == n else 0.0
            ab = ia * (ib * (e - tb[m] * tb[n]) - ta[m] * gb[n])
            K[m, n + 3] = K[n + 3, m] = y2 * ga[m] * gb[n] + y1 * ab
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
def line_bending(x, v, c, pairs, B, tables, slots, direct, step, f, K, N, A, r, s):  # type: ignore[no-untyped-def]
    """Bending at every node between two elements; returns the index of a folded pair, or -1.

    pairs (n, 5): points of element a and of element b, row of the moment tables or -1; B (2, n): k [N m], damping
    [N m s]. slots (n, 144) into A; where direct >= 0, the nine unknowns of the three points stand in a band: entry
    (m, n) at direct + m step + n. Scratch: f (6), K (6, 6), N (9, 9).
    """
    folded = -1
    for e in range(pairs.shape[0]):
        if B[0, e] == 0.0 and B[1, e] == 0.0:
            continue
        i0, i1, j0, j1 = pairs[e, 0], pairs[e, 1], pairs[e, 2], pairs[e, 3]
        da, db = minus(vec(x, i1), vec(x, i0)), minus(vec(x, j1), vec(x, j0))
        va, vb = minus(at(v, 3 * i1), at(v, 3 * i0)), minus(at(v, 3 * j1), at(v, 3 * j0))
        co = bend(B[0, e], B[1, e], tables, pairs[e, 4], da, db, va, vb, c, f, K)
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
        if direct[e] >= 0:
            _three_nodes(K, N)
            o = direct[e]
            for m in range(9):
                for n in range(9):
                    A[o + m * step + n] += N[m, n]
        else:
            for bm in range(4):
                for bn in range(4):
                    sign = 1.0 if (bm + bn) % 2 == 0 else -1.0
                    for m in range(3):
                        for n in range(3):
                            y = K[3 * (bm // 2) + m, 3 * (bn // 2) + n]
                            A[slots[e, 12 * (3 * bm + m) + 3 * bn + n]] += sign * y
    return folded


@kernel
def _three_nodes(K, N):  # type: ignore[no-untyped-def]
    """From derivatives by d_a = x1 - x0 and d_b = x2 - x1 to those by x0, x1, x2."""
    for m in range(3):
        for n in range(3):
            aa, ab, ba, bb = K[m, n], K[m, n + 3], K[m + 3, n], K[m + 3, n + 3]
            N[m, n] = aa
            N[m, n + 3] = ab - aa
            N[m, n + 6] = -ab
            N[m + 3, n] = ba - aa
            N[m + 3, n + 3] = aa - ab - ba + bb
            N[m + 3, n + 6] = ab - bb
            N[m + 6, n] = -ba
            N[m + 6, n + 3] = ba - bb
            N[m + 6, n + 6] = bb


@kernel
def line_angles(x, pairs, angle):  # type: ignore[no-untyped-def]
    """Angle [rad] between the two elements of every pair."""
    for e in range(pairs.shape[0]):
        da = minus(vec(x, pairs[e, 1]), vec(x, pairs[e, 0]))
        db = minus(vec(x, pairs[e, 3]), vec(x, pairs[e, 2]))
        n = cross(da, db)
        angle[e] = math.atan2(math.sqrt(dot(n, n)), dot(da, db))


@kernel
def line_moments(angle, pairs, k, tables, moment):  # type: ignore[no-untyped-def]
    """Bending moment [N m] from the angles of all pairs; k (n)."""
    for e in range(pairs.shape[0]):
        moment[e] = k[e] * angle[e]
        if pairs[e, 4] >= 0 and k[e] > 0.0:
            moment[e], _ = from_table(tables, pairs[e, 4], angle[e])
