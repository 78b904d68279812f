"""The two-node line element: axial force, weight, buoyancy, inertia, drag, fluid acceleration and seabed.

Unstretched length l0 between x1 and x2, d = x2 - x1, l = |d|, t = d/l, stretch s = l/l0:

    axial     T(s, ds/dt) along t from the element's law (floatsim.laws)
    weight    m g, buoyancy phi rho A g; phi is the wet share of the element, A = pi d^2/4
    inertia   m a - phi rho A [(1 + Ca_n) a_fn + (1 + Ca_t) a_ft - Ca_n a_n - Ca_t a_t]       (per unit length)
    drag      phi [0.5 rho d Cd_n |w_n| w_n + 0.5 rho pi d Cd_t |w_t| w_t],   w = fluid - line velocity
    seabed    sea/seabed.py

a_f is the fluid's acceleration: its 1 is the Froude-Krylov force. All of it is lumped in equal halves to the element's
two ends, with the element's own direction and the fluid's motion there. *Lumped* mass rather than consistent: the
added mass turns with the element and would make
the consistent matrix configuration-dependent off the diagonal blocks, for the same second order of
convergence; MoorDyn and OrcaFlex lump as well, so element counts compare one to one.

The exact tangent of the normal and tangential loads, y = m_n a_r + (m_t - m_n)(a_r . t) t - m_f a_f - drag with
a_r = a - a_f, by the element's direction is short once the terms are sorted:

    dy/dt (I - t t^T) = alpha (I - t t^T) + t b_n^T + gamma w_n w_n^T,
    alpha = dm (a_r . t) + c_n |w_n| w_t - c_t |w_t| w_t,   gamma = c_n w_t/|w_n|,
    b_n = dm a_rn + (c_n |w_n| - 2 c_t |w_t|) w_n

Sources: Morison et al. (1950); Hall & Goupee (2015), Ocean Engineering 104, for lumping.
"""

from __future__ import annotations

import math

from floatsim.frames import at, dot, minus, times, vec
from floatsim.jit import kernel
from floatsim.laws.engineering import engineering
from floatsim.laws.green import green
from floatsim.sea.seabed import bed_height, friction, in_plane, touch

# columns of the element parameters; masses, drag and bed area are those of half an element in full contact with water
L0, EA, CA, DRY, WATER, ADDED_N, ADDED_T, DRAG_N, DRAG_T, DIA, BED, NOISE, LAW, LIVE, MU_A, MU_N = range(16)
COLUMNS = 16
GREEN, ENGINEERING, SPECIAL = range(3)  # values of LAW
RHO, GRAVITY = range(2)  # entries of the surroundings


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
    """Mean wet share phi of an element and its derivatives by z1 and z2, heights over the water surface.

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
def linear(law, EA, c, s, rate):  # type: ignore[no-untyped-def]
    """(T, dT/ds, dT/drate) of the laws that need nothing but numbers."""
    if law == GREEN:
        return green(EA, c, s, rate)
    return engineering(EA, c, s, rate)


@kernel
def share(s, EA, live, cap, push):  # type: ignore[no-untyped-def]
    """What of an element's tension counts: nothing where it has parted, in statics less (cap, push: see `Work`)."""
    if cap < EA:
        live *= cap / EA
    return live * push if s < 1.0 else live


@kernel
def axial(P, special, e, s, rate, cap, push):  # type: ignore[no-untyped-def]
    """(T, dT/ds, dT/drate) of element e. special (3, n): results of laws that ran before."""
    part = share(s, P[e, EA], P[e, LIVE], cap, push)
    if P[e, LAW] == SPECIAL:
        return part * special[0, e], part * special[1, e], part * special[2, e]
    T, Ts, Tr = linear(P[e, LAW], P[e, EA], P[e, CA], s, rate)
    return part * T, part * Ts, part * Tr


@kernel
def stretches(x, v, nodes, P, s, rate):  # type: ignore[no-untyped-def]
    """Stretch l/l0 and its rate [1/s] of every element."""
    for e in range(nodes.shape[0]):
        i, j = nodes[e, 0], nodes[e, 1]
        d = minus(vec(x, j), vec(x, i))
        l = math.sqrt(dot(d, d))
        s[e] = l / P[e, L0]
        rate[e] = dot(d, minus(at(v, 3 * j), at(v, 3 * i))) / (l * P[e, L0])


@kernel
def tensions(nodes, P, special, stretch, rate, tension):  # type: ignore[no-untyped-def]
    """Effective tension [N] of every element."""
    for e in range(nodes.shape[0]):
        tension[e], _, _ = axial(P, special, e, stretch[e], rate[e], math.inf, 1.0)


@kernel
def line_elements(x, v, a, u, du, eta, c, nodes, P, env, bed, grid, stick, special, slots, direct, step, Ke, A, r, s):  # type: ignore[no-untyped-def]
    """Everything but bending of every element.

    x (n_point, 3), v and a (flat), u and du (n_point, 3) velocity and acceleration of the fluid, eta (n_point) height
    of the surface; c: see `Work`; nodes (n_el, 2); P (n_el, COLUMNS); bed, grid: sea/seabed.py; stick (2 n_el, 6);
    slots (n_el, 36) into A; where direct >= 0 the six unknowns stand in a band: entry (m, n) at direct + m step + n;
    Ke (9, 6) scratch. Adds to A, residual r and force scale s.
    """
    cM, cC, cK, push, cap, tangent = c[0], c[1], c[2], c[4], c[5], c[6] != 0.0
    g = env[GRAVITY]
    plane, slope_x, slope_y, stiffness, damping, slip = bed[0], bed[1], bed[2], bed[3], bed[4], bed[5]
    uneven, rough = grid.shape[0] > 0, c[7] != 0.0
    for e in range(nodes.shape[0]):
        i, j = nodes[e, 0], nodes[e, 1]
        x1, x2 = vec(x, i), vec(x, j)
        d = minus(x2, x1)
        l = math.sqrt(dot(d, d))
        t = times(1.0 / l, d)
        l0 = P[e, L0]
        dv = minus(at(v, 3 * j), at(v, 3 * i))
        along = dot(t, dv)
        stretch = l / l0
        if P[e, LAW] == SPECIAL:  # `axial`, without handing its arrays on
            T, Ts, Tr = special[0, e], special[1, e], special[2, e]
        else:
            T, Ts, Tr = linear(P[e, LAW], P[e, EA], P[e, CA], stretch, along / l0)
        part = share(stretch, P[e, EA], P[e, LIVE], cap, push)
        T, Ts, Tr = part * T, part * Ts, part * Tr
        for m in range(3):
            r[3 * i + m] -= T * t[m]
            r[3 * j + m] += T * t[m]
        if tangent:
            # df/dx = dT/ds t t^T/l0 + T/l (I - t t^T) + dT/drate t dv_n^T/(l l0),   df/dv = dT/drate t t^T/l0
            side = cK * T / l
            main = (cK * Ts + cC * Tr) / l0 - side
            turn = cK * Tr / (l * l0)
            for m in range(3):
                for n in range(3):
                    k = main * t[m] * t[n] + turn * t[m] * (dv[n] - along * t[n])
                    if m == n:
                        k += side
                    Ke[m + 6, n] = k  # each half takes it from here
        phi, phi1, phi2 = wet_share(x1[2] - eta[i], x2[2] - eta[j], P[e, DIA])
        dry, mf, mn, cn, ct = P[e, DRY], P[e, WATER], P[e, ADDED_N], P[e, DRAG_N], P[e, DRAG_T]
        dm = P[e, ADDED_T] - mn
        # rounding of the coordinates, seen through EA: no residual gets below 1e-8 of this at c[8] = 1
        size = abs(T) + dry * g + c[8] * P[e, NOISE] * (abs(x2[0]) + abs(x2[1]) + abs(x2[2]))
        s[i] += size
        s[j] += size
        for k in range(2):
            p = i if k == 0 else j
            b, other, sign = 3 * k, 3 - 3 * k, 2.0 * k - 1.0
            acc, vel, flow = at(a, 3 * p), at(v, 3 * p), vec(du, p)
            if phi > 0.0:
                w, ar = minus(vec(u, p), vel), minus(acc, flow)
                at_, wt = dot(ar, t), dot(w, t)
                wn = minus(w, times(wt, t))
                wnl = math.sqrt(dot(wn, wn))
                wta = abs(wt)
                drag_n, drag_t = cn * wnl, ct * wta
                axis = dm * at_ - drag_t * wt
                y0 = mn * ar[0] + axis * t[0] - mf * flow[0] - drag_n * wn[0]
                y1 = mn * ar[1] + axis * t[1] - mf * flow[1] - drag_n * wn[1]
                y2 = mn * ar[2] + axis * t[2] - mf * flow[2] - drag_n * wn[2] - mf * g
                r[3 * p] += dry * acc[0] + phi * y0
                r[3 * p + 1] += dry * acc[1] + phi * y1
                r[3 * p + 2] += dry * (acc[2] + g) + phi * y2
                if tangent:
                    inv = 1.0 / wnl if wnl > 0.0 else 0.0
                    turn = cK * phi / l
                    alpha = turn * (dm * at_ + drag_n * wt - drag_t * wt)
                    gamma = turn * cn * wt * inv
                    bw = turn * (drag_n - 2.0 * drag_t)
                    ba = turn * dm
                    own = cM * (dry + phi * mn) + cC * phi * drag_n
                    tt = phi * (cM * dm + cC * (2.0 * drag_t - drag_n))
                    ww = cC * phi * cn * inv
                    for m in range(3):
                        for n in range(3):
                            E = 1.0 if m == n else 0.0
                            bn = ba * (ar[n] - at_ * t[n]) + bw * wn[n]
                            q = alpha * (E - t[m] * t[n]) + t[m] * bn + gamma * wn[m] * wn[n]
                            q = sign * q + Ke[m + 6, n]
                            Ke[b + m, other + n] = -q
                            Ke[b + m, b + n] = q + own * E + tt * t[m] * t[n] + ww * wn[m] * wn[n]
                    if phi1 != 0.0 or phi2 != 0.0:
                        for m in range(3):
                            y = cK * (y0 if m == 0 else (y1 if m == 1 else y2))
                            Ke[b + m, 2] += y * phi1
                            Ke[b + m, 5] += y * phi2
            else:
                for m in range(3):
                    r[3 * p + m] += dry * (acc[m] + (g if m == 2 else 0.0))
                    for n in range(3):
                        Ke[b + m, other + n] = -Ke[m + 6, n]
                        Ke[b + m, b + n] = Ke[m + 6, n] + (cM * dry if m == n else 0.0)
            # the seabed under this half
            here = x1 if k == 0 else x2
            z, zx, zy = plane + slope_x * here[0] + slope_y * here[1], slope_x, slope_y
            if uneven:
                z, zx, zy = bed_height(bed, grid, here[0], here[1])
            if here[2] >= z:
                continue
            lift, up, stiff, damp = touch(z, zx, zy, stiffness, damping, here, vel, P[e, BED])
            if lift == 0.0:  # a bed that would pull lets go
                continue
            kn = cK * stiff + cC * damp
            s[p] += lift
            for m in range(3):
                r[3 * p + m] -= lift * up[m]
                for n in range(3):
                    Ke[b + m, b + n] += kn * up[m] * up[n]
            mu_a, mu_n = P[e, MU_A], P[e, MU_N]
            if not rough or mu_a + mu_n == 0.0:
                continue
            h = 2 * e + k
            at_rest, way = (stick[h, 0], stick[h, 1], stick[h, 2]), (stick[h, 3], stick[h, 4], stick[h, 5])
            q, off, ea, en, ratio = friction(here, up, at_rest, way, slip, mu_a, mu_n)
            s[p] += lift * max(mu_a, mu_n)
            # residual + lift q;  q = D u/slip while sticking, D u/|u| while sliding
            pull = cK * lift / (slip * max(ratio, 1.0))
            sliding = 1.0 / dot(off, off) if ratio > 1.0 else 0.0
            oa, on = mu_a * dot(ea, off), mu_n * dot(en, off)
            for m in range(3):
                r[3 * p + m] += lift * q[m]
                Du = (oa * ea[m] + on * en[m]) * sliding
                for n in range(3):
                    D = mu_a * ea[m] * ea[n] + mu_n * en[m] * en[n]
                    Ke[b + m, b + n] += pull * (D - Du * off[n]) - q[m] * kn * up[n]
        if tangent:
            o = direct[e]
            if o >= 0:
                for m in range(6):
                    for n in range(6):
                        A[o + m * step + n] += Ke[m, n]
            else:
                for m in range(6):
                    for n in range(6):
                        A[slots[e, 6 * m + n]] += Ke[m, n]


@kernel
def expected_tension(x, d, part, nodes, P, special, c, T):  # type: ignore[no-untyped-def]
    """Tensions T (n_el) that the linear step `part` d from x (n_point, 3) leads to if nothing turns."""
    for e in range(nodes.shape[0]):
        i, j = nodes[e, 0], nodes[e, 1]
        y = minus(vec(x, j), vec(x, i))
        l = math.sqrt(dot(y, y))
        T0, Ts, _ = axial(P, special, e, l / P[e, L0], 0.0, c[5], c[4])
        T[e] = T0 + part * Ts * dot(y, minus(at(d, 3 * j), at(d, 3 * i))) / (l * P[e, L0])


@kernel
def largest_turn(x, d, nodes):  # type: ignore[no-untyped-def]
    """Largest angle [rad] by which the linear step d turns an element, for small ones."""
    top = 0.0
    for e in range(nodes.shape[0]):
        i, j = nodes[e, 0], nodes[e, 1]
        y, dy = minus(vec(x, j), vec(x, i)), minus(at(d, 3 * j), at(d, 3 * i))
        square = dot(y, y)
        across = minus(dy, times(dot(y, dy) / square, y))
        top = max(top, dot(across, across) / square)
    return math.sqrt(top)


@kernel
def exchange_tension(x, nodes, P, special, c, T, slots, A):  # type: ignore[no-untyped-def]
    """Let the lateral stiffness in A be that of the tensions T instead of those at x."""
    for e in range(nodes.shape[0]):
        i, j = nodes[e, 0], nodes[e, 1]
        y = minus(vec(x, j), vec(x, i))
        l = math.sqrt(dot(y, y))
        t = times(1.0 / l, y)
        own, _, _ = axial(P, special, e, l / P[e, L0], 0.0, c[5], c[4])
        k = (T[e] - own) / l
        for m in range(3):
            for n in range(3):
                q = k * ((1.0 if m == n else 0.0) - t[m] * t[n])
                A[slots[e, 6 * m + n]] += q
                A[slots[e, 6 * m + n + 3]] -= q
                A[slots[e, 6 * m + n + 18]] -= q
                A[slots[e, 6 * m + n + 21]] += q


@kernel
def step_error(x, v, nodes, P, special, old, limit, line_of, h, scale, largest, tension):  # type: ignore[no-untyped-def]
    """Largest |T - T_extrapolated| over `limit` times the line's largest tension so far; tension (n): T.

    old (3, n): tension before the step, at the step before, and the size of that step; scale (n_line): largest tension
    before the step, largest (n_line): with it.
    """
    for k in range(scale.shape[0]):
        largest[k] = scale[k]
    for e in range(nodes.shape[0]):
        i, j = nodes[e, 0], nodes[e, 1]
        d = minus(vec(x, j), vec(x, i))
        l, l0 = math.sqrt(dot(d, d)), P[e, L0]
        if P[e, LAW] == SPECIAL:
            T = special[0, e]
        else:
            rate = dot(d, minus(at(v, 3 * j), at(v, 3 * i))) / (l * l0)
            T, _, _ = linear(P[e, LAW], P[e, EA], P[e, CA], l / l0, rate)
        T *= P[e, LIVE]
        tension[e] = T
        k = line_of[e]
        largest[k] = max(largest[k], abs(T))
    worst = 0.0
    for e in range(nodes.shape[0]):
        ahead = old[0, e] + (old[0, e] - old[1, e]) * h / old[2, e]
        worst = max(worst, abs(tension[e] - ahead) / max(limit * largest[line_of[e]], 1e-300))
    return worst


@kernel
def drag_stick_points(x, v, nodes, P, bed, grid, stick):  # type: ignore[no-untyped-def]
    """Commit a step: stick points of sliding halves follow, those in the water go with the line."""
    for e in range(nodes.shape[0]):
        d = minus(vec(x, nodes[e, 1]), vec(x, nodes[e, 0]))
        t = times(1.0 / math.sqrt(dot(d, d)), d)
        for k in range(2):
            p, o = nodes[e, k], 2 * e + k
            here = vec(x, p)
            z, zx, zy = bed_height(bed, grid, here[0], here[1])
            lift, normal, _, _ = touch(z, zx, zy, bed[3], bed[4], here, at(v, 3 * p), P[e, BED])
            u = in_plane(normal, (here[0] - stick[o, 0], here[1] - stick[o, 1], here[2] - stick[o, 2]))
            size = math.sqrt(dot(u, u))
            left = 0.0
            if lift > 0.0:
                left = min(1.0, bed[5] / size) if size > 0.0 else 1.0
            for m in range(3):
                stick[o, m] = here[m] - left * u[m]
                stick[o, 3 + m] = t[m]


# entries of `line_powers`: energies and their rates, then powers
E_KINETIC, E_GRAVITY, E_HYDROSTATIC, E_AXIAL, E_SEABED = range(0, 10, 2)
P_STRUCTURAL, P_WAVE, P_CURRENT, P_DRAG, P_ADDED, P_SURFACE, P_CONTACT, P_FRICTION = range(10, 18)
POWERS = 18


@kernel
def line_powers(x, v, a, u, du, eta, current, nodes, P, env, bed, grid, rough, stick, out):  # type: ignore[no-untyped-def]
    """Energies and powers of all elements into out (POWERS); not the axial ones of laws that run by themselves.

    current (n_point, 3): the part of u that is no wave's; the rest as in `line_elements`.
    """
    g = env[GRAVITY]
    for i in range(POWERS):
        out[i] = 0.0
    for e in range(nodes.shape[0]):
        i, j = nodes[e, 0], nodes[e, 1]
        x1, x2 = vec(x, i), vec(x, j)
        d = minus(x2, x1)
        l, l0 = math.sqrt(dot(d, d)), P[e, L0]
        t = times(1.0 / l, d)
        along = dot(t, minus(at(v, 3 * j), at(v, 3 * i)))
        if P[e, LAW] != SPECIAL:
            s = l / l0
            T, _, _ = linear(P[e, LAW], P[e, EA], P[e, CA], s, along / l0)
            Te, _, _ = linear(P[e, LAW], P[e, EA], P[e, CA], s, 0.0)
            strain = 0.5 * (s * s - 1.0) if P[e, LAW] == GREEN else s - 1.0
            out[E_AXIAL] += P[e, LIVE] * 0.5 * P[e, EA] * strain * strain * l0
            out[E_AXIAL + 1] += P[e, LIVE] * Te * along
            out[P_STRUCTURAL] -= P[e, LIVE] * (T - Te) * along
        dry, mf, mn, dm = P[e, DRY], P[e, WATER], P[e, ADDED_N], P[e, ADDED_T] - P[e, ADDED_N]
        phi, _, _ = wet_share(x1[2] - eta[i], x2[2] - eta[j], P[e, DIA])
        level, _, _ = wet_share(x1[2], x2[2], P[e, DIA])
        for k in range(2):
            p = i if k == 0 else j
            here, vel, acc, flow, stream = vec(x, p), at(v, 3 * p), at(a, 3 * p), vec(du, p), vec(current, p)
            out[E_KINETIC] += 0.5 * dry * dot(vel, vel)
            out[E_KINETIC + 1] += dry * dot(vel, acc)
            out[E_GRAVITY] += dry * g * here[2]
            out[E_GRAVITY + 1] += dry * g * vel[2]
            wet, way = _ramp(here[2], P[e, DIA])
            out[E_HYDROSTATIC] -= mf * g * way
            out[E_HYDROSTATIC + 1] -= mf * g * wet * vel[2]
            out[P_SURFACE] += mf * g * (level - wet) * vel[2]
            out[P_WAVE] += mf * g * (phi - level) * vel[2]
            if phi > 0.0:
                w = minus(vec(u, p), vel)
                wt, vt = dot(w, t), dot(vel, t)
                wn = minus(w, times(wt, t))
                cn, ct = phi * P[e, DRAG_N] * math.sqrt(dot(wn, wn)), phi * P[e, DRAG_T] * abs(wt)
                drag = (cn * wn[0] + ct * wt * t[0], cn * wn[1] + ct * wt * t[1], cn * wn[2] + ct * wt * t[2])
                moved = dot(drag, stream)
                out[P_CURRENT] += moved
                out[P_WAVE] += dot(drag, vec(u, p)) - moved
                out[P_DRAG] -= dot(drag, w)
                out[P_WAVE] += phi * ((mf + mn) * dot(flow, vel) + dm * dot(flow, t) * vt)
                out[P_ADDED] -= phi * (mn * dot(acc, vel) + dm * dot(acc, t) * vt)
            z, zx, zy = bed_height(bed, grid, here[0], here[1])
            if here[2] >= z:
                continue
            pressed, up, stiff, _ = touch(z, zx, zy, bed[3], 0.0, here, vel, P[e, BED])
            lift, _, _, _ = touch(z, zx, zy, bed[3], bed[4], here, vel, P[e, BED])
            if stiff > 0.0:
                out[E_SEABED] += 0.5 * pressed * pressed / stiff
            out[E_SEABED + 1] -= pressed * dot(up, vel)
            out[P_CONTACT] += (lift - pressed) * dot(up, vel)
            if rough and lift > 0.0 and P[e, MU_A] + P[e, MU_N] > 0.0:
                h = 2 * e + k
                q, _, _, _, _ = friction(here, up, vec(stick, h), (stick[h, 3], stick[h, 4], stick[h, 5]), bed[5],
                                         P[e, MU_A], P[e, MU_N])  # fmt: skip
                out[P_FRICTION] -= lift * dot(q, vel)
