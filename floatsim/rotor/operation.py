"""Operating points and the step of a rotor's states.

States: rotor speed O relative to the nacelle [rad/s], blade pitch [rad], integrator I [rad], filtered hub velocity f
[m/s]. With a the nacelle's angular acceleration about the shaft and J the inertia of all that turns,

    J (O' + a) = Q(u, O, pitch) - Q_g(O),

pitch and f as in control.py. They move with the system's step by the trapezoidal rule, y1 = y0 + h/2 (y'(0) + y'(1)),
I then brought between its limits; O and pitch follow by Newton iterations of their own from u, hub velocity and a at
the step's end, which the system's Newton iteration tries. Their derivatives go into its tangent, as those of the states
of PTOs do (pto_laws/runge_kutta.py): nothing lags. The rule is enough: none of these states is stiff against steps of
0.1 s.
"""

from __future__ import annotations

import math

from floatsim.jit import kernel
from floatsim.rotor.control import (
    CORNER,
    FEEDBACK,
    INERTIA,
    LAG,
    LARGEST,
    PRESSURE,
    RADIUS,
    RATE,
    RATED,
    TORQUE,
    fine_pitch,
    generator_torque,
    table_at,
)
from floatsim.rotor.surface import loads

SPEED, PITCH, INTEGRATOR, FILTER, STATES = range(5)
ITERATIONS, CLOSE = 60, 1e-13  # of Newton; change that ends it, rad/s and rad
_HALVINGS = 60


@kernel
def clamp(x, low, high):  # type: ignore[no-untyped-def]
    """(x between the limits, its derivative)."""
    if x <= low:
        return low, 0.0
    if x >= high:
        return high, 0.0
    return x, 1.0


@kernel
def excess(P, S, gx, gy, fine, u, speed):  # type: ignore[no-untyped-def]
    """Aerodynamic less generator torque at the fine pitch; its derivatives by u and by speed; the fine pitch and its
    slope."""
    pitch, slope = fine_pitch(P, fine, speed)
    Q, Qu, Qo, Qp, _, _, _, _ = loads(S, gx, gy, P[PRESSURE], P[RADIUS], u, speed, pitch)
    G, Go = generator_torque(P, speed)
    return Q - G, Qu, Qo + Qp * slope - Go, pitch, slope


@kernel
def steady(P, S, gx, gy, fine, u):  # type: ignore[no-untyped-def]
    """(speed, pitch, thrust, generator torque; derivatives of thrust, torque and speed by u) in the steady wind u.

    Rated speed with the pitch that balances rated torque if the rotor has more of it at the fine pitch; else the speed
    that balances the torque at the fine pitch. By bisection, so that no start is needed.
    """
    if u <= 0.0:
        return 0.0, fine[0, 1], 0.0, 0.0, 0.0, 0.0, 0.0
    over, _, _, pitch, _ = excess(P, S, gx, gy, fine, u, P[RATED])
    if over > 0.0:
        low, high = pitch, P[LARGEST]
        for _ in range(_HALVINGS):
            pitch = 0.5 * (low + high)
            Q, Qu, _, Qp, T, Tu, _, Tp = loads(S, gx, gy, P[PRESSURE], P[RADIUS], u, P[RATED], pitch)
            if P[TORQUE] < Q:
                low = pitch
            else:
                high = pitch
        return P[RATED], pitch, T, P[TORQUE], Tu - Tp * Qu / Qp, 0.0, 0.0
    low, high = 0.0, P[RATED]  # a rotor that stands still is driven, one at rated speed is braked
    for _ in range(_HALVINGS):
        speed = 0.5 * (low + high)
        over, Qu, by_speed, pitch, slope = excess(P, S, gx, gy, fine, u, speed)
        if over > 0.0:
            low = speed
        else:
            high = speed
    _, _, _, _, T, Tu, To, Tp = loads(S, gx, gy, P[PRESSURE], P[RADIUS], u, speed, pitch)
    G, Go = generator_torque(P, speed)
    change = -Qu / by_speed
    return speed, pitch, T, G, Tu + (To + Tp * slope) * change, Go * change, change


@kernel
def command(P, gains, fine, y, h, integrated, speed, pitch, wanted):  # type: ignore[no-untyped-def]
    """(pitch rate, its derivatives by speed, pitch and feedback `wanted` [rad]; integrator; its rate before limits).

    integrated: rate of the integrator at the step's start; h = 0: at the states y themselves.
    """
    Kp, Kp_pitch = table_at(gains, pitch, 1)
    Ki, Ki_pitch = table_at(gains, pitch, 2)
    least, least_speed = fine_pitch(P, fine, speed)
    e = speed - P[RATED]
    free = y[INTEGRATOR] + 0.5 * h * (integrated + Ki * e)
    I, inside = clamp(free, least, P[LARGEST])
    below = 1.0 if free <= least else 0.0
    I_speed, I_pitch = inside * 0.5 * h * Ki + below * least_speed, inside * 0.5 * h * Ki_pitch * e
    asked, inside = clamp(Kp * e + I + wanted, least, P[LARGEST])
    below = 1.0 if asked <= least else 0.0
    a_speed, a_pitch = inside * (Kp + I_speed) + below * least_speed, inside * (Kp_pitch * e + I_pitch)
    rate, free_rate = clamp((asked - pitch) / P[LAG], -P[RATE], P[RATE])
    s = free_rate / P[LAG]
    return rate, s * a_speed, s * (a_pitch - 1.0), s * inside, I, Ki * e


@kernel
def rates(P, S, gx, gy, gains, fine, y, u, hub, turning, out):  # type: ignore[no-untyped-def]
    """out: rates of speed, pitch, integrator (before limits) and filter at the states y."""
    Q, _, _, _, _, _, _, _ = loads(S, gx, gy, P[PRESSURE], P[RADIUS], u, y[SPEED], y[PITCH])
    G, _ = generator_torque(P, y[SPEED])
    out[SPEED] = (Q - G) / P[INERTIA] - turning
    rate, _, _, _, _, integrated = command(P, gains, fine, y, 0.0, 0.0, y[SPEED], y[PITCH], P[FEEDBACK] * y[FILTER])
    out[PITCH], out[INTEGRATOR], out[FILTER] = rate, integrated, P[CORNER] * (hub - y[FILTER])


@kernel
def advance(P, S, gx, gy, gains, fine, y, before, h, u, hub, turning, new, D):  # type: ignore[no-untyped-def]
    """Move the states y over h into `new`; D (2, 3): derivatives of speed and pitch by u, hub velocity and
    acceleration about the shaft. False if that does not converge. before: rates at the step's start."""
    half = 0.5 * h
    new[FILTER] = (y[FILTER] + half * (before[FILTER] + P[CORNER] * hub)) / (1.0 + half * P[CORNER])
    wanted, wanted_hub = P[FEEDBACK] * new[FILTER], P[FEEDBACK] * half * P[CORNER] / (1.0 + half * P[CORNER])
    speed, pitch = y[SPEED] + h * before[SPEED], y[PITCH] + h * before[PITCH]
    J = P[INERTIA]
    for _ in range(ITERATIONS):
        Q, Qu, Qo, Qp, _, _, _, _ = loads(S, gx, gy, P[PRESSURE], P[RADIUS], u, speed, pitch)
        G, Go = generator_torque(P, speed)
        rate, r_speed, r_pitch, r_wanted, I, _ = command(P, gains, fine, y, h, before[INTEGRATOR], speed, pitch, wanted)
        e0 = y[SPEED] + half * (before[SPEED] + (Q - G) / J - turning) - speed
        e1 = y[PITCH] + half * (before[PITCH] + rate) - pitch
        a, b = 1.0 - half * (Qo - Go) / J, -half * Qp / J
        c, d = -half * r_speed, 1.0 - half * r_pitch
        det = a * d - b * c
        s, p = (d * e0 - b * e1) / det, (a * e1 - c * e0) / det
        speed, pitch = speed + s, pitch + p
        if not math.isfinite(speed + pitch):
            return False
        if abs(s) <= CLOSE and abs(p) <= CLOSE:
            new[SPEED], new[PITCH], new[INTEGRATOR] = speed, pitch, I
            by = (half * Qu / J, 0.0, -half)
            for k in range(3):
                f1 = half * r_wanted * wanted_hub if k == 1 else 0.0
                D[0, k], D[1, k] = (d * by[k] - b * f1) / det, (a * f1 - c * by[k]) / det
            return True
    return False
