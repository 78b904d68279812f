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
def table_slopes(tables, row, co, y):  # type: ignore[no-untyped-def]
    """(dU/dcos, d2U/dcos2) from a row of the moment tables; y: squared sine."""
    f1, f2 = half_angle_squared(co, y)
    sine = math.sqrt(y)
    theta = math.atan2(sine, co)
    M, slope = from_table(tables, row, theta)
    if theta <= tables[row, 0, 1]:  # on the first stretch M is proportional to theta
        return slope * f1, slope * f2
    return -M / sine, (slope * sine - M * co) / (sine * y)


@kernel
def bend(h1, h2, cb, co, ta, ia, tb, ib, va, vb, cK, cC):  # type: ignore[no-untyped-def]
    """Bending between element a of direction t_a and length 1/i_a and element b, rates v_a and v_b of d_a and d_b.

    h1, h2: first and second derivative of the energy by the cosine co; cb [N m s]. Returns g_a, g_b (the gradient by
    d_a and d_b is h g_a, h g_b), h, and the coefficients of `blocks`. Numbers only: an array handed to a function that
    is not inlined costs as much as the bending.
    """
    ga = times(ia, (tb[0] - co * ta[0], tb[1] - co * ta[1], tb[2] - co * ta[2]))  # dcos/dd_a
    gb = times(ib, (ta[0] - co * tb[0], ta[1] - co * tb[1], ta[2] - co * tb[2]))
    y2, yc = cK * h2, 0.0
    ha, hb = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    if cb > 0.0:
        rate = dot(ga, va) + dot(gb, vb)
        D = 1.0 - co * co + _STRAIGHT * _STRAIGHT
        q = cb * rate / D
        h1 += q
        y2 += 2.0 * cK * q * co / D + cC * cb / D
        yc = cK * cb / D
        ha, hb = _rate_turns(ia, ib, co, ta, tb, ga, gb, va, vb)
    za, zb = cK * h1 * ia, cK * h1 * ib
    return h1, ga, gb, (y2, yc, za, zb, za * ib, za * co * ia, zb * co * ib), ha, hb


@kernel
def _rate_turns(ia, ib, co, ta, tb, ga, gb, va, vb):  # type: ignore[no-untyped-def]
    """(H v)_a and (H v)_b with the Hessian H of the cosine: how its rate changes with d_a and d_b."""
    av, bv, tav, tbv = dot(ga, va), dot(gb, vb), dot(ta, va), dot(tb, vb)
    abv = dot(tb, va)
    ha0 = -ia * (ta[0] * av + ga[0] * tav + co * ia * (va[0] - ta[0] * tav))
    ha1 = -ia * (ta[1] * av + ga[1] * tav + co * ia * (va[1] - ta[1] * tav))
    ha2 = -ia * (ta[2] * av + ga[2] * tav + co * ia * (va[2] - ta[2] * tav))
    hb0 = -ib * (tb[0] * bv + gb[0] * tbv + co * ib * (vb[0] - tb[0] * tbv))
    hb1 = -ib * (tb[1] * bv + gb[1] * tbv + co * ib * (vb[1] - tb[1] * tbv))
    hb2 = -ib * (tb[2] * bv + gb[2] * tbv + co * ib * (vb[2] - tb[2] * tbv))
    # mixed block ia (ib (I - t_b t_b^T) - t_a g_b^T) on v_b, and its transpose on v_a
    ha = (
        ha0 + ia * (ib * (vb[0] - tb[0] * tbv) - ta[0] * bv),
        ha1 + ia * (ib * (vb[1] - tb[1] * tbv) - ta[1] * bv),
        ha2 + ia * (ib * (vb[2] - tb[2] * tbv) - ta[2] * bv),
    )
    hb = (
        hb0 + ia * (ib * (va[0] - tb[0] * abv) - gb[0] * tav),
        hb1 + ia * (ib * (va[1] - tb[1] * abv) - gb[1] * tav),
        hb2 + ia * (ib * (va[2] - tb[2] * abv) - gb[2] * tav),
    )
    return ha, hb


@kernel
def blocks(m, n, z, ta, tb, ga, gb, ha, hb):  # type: ignore[no-untyped-def]
    """Entries (m, n) of c_K K + c_C C by (d_a, d_a), (d_a, d_b), (d_b, d_a), (d_b, d_b); the rest from `bend`."""
    y2, yc, za, zb, zab, ca, cb = z
    e = 1.0 if m == n else 0.0
    aa = y2 * ga[m] * ga[n] - za * (ta[m] * ga[n] + ga[m] * ta[n]) + ca * (ta[m] * ta[n] - e) + yc * ga[m] * ha[n]
    bb = y2 * gb[m] * gb[n] - zb * (tb[m] * gb[n] + gb[m] * tb[n]) + cb * (tb[m] * tb[n] - e) + yc * gb[m] * hb[n]
    mixed = zab * (e - tb[m] * tb[n])
    ab = y2 * ga[m] * gb[n] + mixed - za * ta[m] * gb[n] + yc * ga[m] * hb[n]
    ba = y2 * gb[m] * ga[n] + mixed - za * gb[m] * ta[n] + yc * gb[m] * ha[n]
    return aa, ab, ba, bb


@kernel
def from_table_energy(tables, row, theta):  # type: ignore[no-untyped-def]
    """Integral of the moment from 0 to theta."""
    U = 0.0
    last = tables.shape[2] - 2
    for i in range(last + 1):
        a, b = tables[row, 0, i], tables[row, 0, i + 1]
        end = theta if theta <= b or i == last else b
        M, _ = from_table(tables, row, end)
        U += 0.5 * (tables[row, 1, i] + M) * (end - a)
        if theta <= b:
            break
    return U


@kernel
def pair_powers(k, damping, tables, row, ta, ia, tb, ib, va, vb):  # type: ignore[no-untyped-def]
    """(U, dU/dt, power of the damper) of a bent pair; numbers as in `bend`."""
    co = dot(ta, tb)
    sx = cross(ta, tb)
    y = dot(sx, sx)
    theta = math.atan2(math.sqrt(y), co)
    h1, _ = half_angle_squared(co, y)
    U, h1 = 0.5 * k * theta * theta, k * h1
    if row >= 0:
        U = from_table_energy(tables, row, theta)
        h1, _ = table_slopes(tables, row, co, y)
    rate = ia * (dot(tb, va) - co * dot(ta, va)) + ib * (dot(ta, vb) - co * dot(tb, vb))  # of the cosine
    return U, h1 * rate, -damping * rate * rate / (1.0 - co * co + _STRAIGHT * _STRAIGHT)


@kernel
def bending_powers(x, v, pairs, B, tables, out):  # type: ignore[no-untyped-def]
    """out: energy of all pairs, its rate, power of the dampers."""
    out[0] = out[1] = out[2] = 0.0
    for e in range(pairs.shape[0]):
        if B[e, 0] == 0.0 and B[e, 1] == 0.0:
            continue
        da, db = minus(vec(x, pairs[e, 1]), vec(x, pairs[e, 0])), minus(vec(x, pairs[e, 3]), vec(x, pairs[e, 2]))
        ia, ib = 1.0 / math.sqrt(dot(da, da)), 1.0 / math.sqrt(dot(db, db))
        va = minus(at(v, 3 * pairs[e, 1]), at(v, 3 * pairs[e, 0]))
        vb = minus(at(v, 3 * pairs[e, 3]), at(v, 3 * pairs[e, 2]))
        U, R, P = pair_powers(B[e, 0], B[e, 1], tables, pairs[e, 4], times(ia, da), ia, times(ib, db), ib, va, vb)
        out[0] += U
        out[1] += R
        out[2] += P


@kernel
def line_bending(x, v, c, pairs, B, tables, slots, direct, step, K, A, r, s):  # type: ignore[no-untyped-def]
    """Bending at every node between two elements; returns the index of a folded pair, or -1.

    pairs (n, 5): points of element a and of element b, row of the moment tables or -1; B (n, 2): k [N m], damping
    [N m s]. slots (n, 144) into A; where direct >= 0, the nine unknowns of the three points stand in a band: entry
    (m, n) at direct + m step + n. K (6, 6) scratch.
    """
    cC, cK, tangent = c[1], c[2], c[6] != 0.0
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
        co = dot(ta, tb)
        sx = cross(ta, tb)
        y = dot(sx, sx)
        h1, h2 = half_angle_squared(co, y)
        h1, h2 = k * h1, k * h2
        if pairs[e, 4] >= 0:
            h1, h2 = table_slopes(tables, pairs[e, 4], co, y)
        h, ga, gb, z, ha, hb = bend(h1, h2, damping, co, ta, ia, tb, ib, va, vb, cK, cC)
        if co < _FOLDED:
            folded = e
        size = 0.0
        for m in range(3):
            fa, fb = h * ga[m], h * gb[m]
            r[3 * i0 + m] -= fa
            r[3 * i1 + m] += fa
            r[3 * j0 + m] -= fb
            r[3 * j1 + m] += fb
            size += abs(fa) + abs(fb)
        s[i0] += size
        s[i1] += size
        s[j0] += size
        s[j1] += size
        if not tangent:
            continue
        o = direct[e]
        if o >= 0:  # from derivatives by d_a = x1 - x0 and d_b = x2 - x1 to those by x0, x1, x2
            # `blocks`, written out: a call with all its numbers costs three times what it does
            y2, yc, za, zb, zab, ca, cb = z
            for m in range(3):
                for n in range(3):
                    e1 = 1.0 if m == n else 0.0
                    own_a = za * (ta[m] * ga[n] + ga[m] * ta[n]) - ca * (ta[m] * ta[n] - e1)
                    own_b = zb * (tb[m] * gb[n] + gb[m] * tb[n]) - cb * (tb[m] * tb[n] - e1)
                    mixed = zab * (e1 - tb[m] * tb[n])
                    K[m, n] = y2 * ga[m] * ga[n] - own_a
                    K[m, n + 3] = y2 * ga[m] * gb[n] + mixed - za * ta[m] * gb[n]
                    K[m + 3, n] = y2 * gb[m] * ga[n] + mixed - za * gb[m] * ta[n]
                    K[m + 3, n + 3] = y2 * gb[m] * gb[n] - own_b
            if yc != 0.0:
                for m in range(3):
                    for n in range(3):
                        K[m, n] += yc * ga[m] * ha[n]
                        K[m, n + 3] += yc * ga[m] * hb[n]
                        K[m + 3, n] += yc * gb[m] * ha[n]
                        K[m + 3, n + 3] += yc * gb[m] * hb[n]
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
            for m in range(3):
                for n in range(3):
                    q = blocks(m, n, z, ta, tb, ga, gb, ha, hb)
                    for bm in range(4):
                        for bn in range(4):
                            sign = 1.0 if (bm + bn) % 2 == 0 else -1.0
                            A[slots[e, 12 * (3 * bm + m) + 3 * bn + n]] += sign * q[2 * (bm // 2) + bn // 2]
    return folded
