"""Hydraulic PTO: double-acting cylinder, four check valves, two accumulators, motor with generator.

Five states: pressures p1, p2 of the chambers, volumes q_h, q_l of oil taken in by the accumulators, motor speed w.

    F        = -A (p1 - p2)                                             chamber 1 shrinks as s grows
    p1'      = beta/(V + A (S/2 - s)) ( A v - Q(p1 - p_h) + Q(p_l - p1))
    p2'      = beta/(V + A (S/2 + s)) (-A v - Q(p2 - p_h) + Q(p_l - p2))
    q_h'     = Q(p1 - p_h) + Q(p2 - p_h) - D w,      p_h = P_h (G_h/(G_h - q_h))^n     and the same for
    q_l'     = D w - Q(p_l - p1) - Q(p_l - p2),      p_l = P_l (G_l/(G_l - q_l))^n
    J w'     = D (p_h - p_l) - c w

Q(d) = a sqrt(2/rho) d/(d^2 + d0^2)^(1/4) for d > 0, else 0: an orifice that only opens forwards, laminar below d0. D is
the motor's displacement per radian, G and P the accumulators' gas volumes and absolute pressures at the start, S the
stroke, V the oil in a chamber at the end of its stroke. The generator's torque is c w, its power c w^2; oil and motor
have no other losses. Oil is conserved but for its compression. Structure and equations: So, Casey, Kanner, Simmons &
Brekken 2015, PTO-Sim (IEEE PES General Meeting), compressible-fluid PTO; gas law: Falcao 2007, Ocean Engineering 34.
The states move with the step (runge_kutta.py).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from floatsim.description import Description, NonNegative, Positive
from floatsim.errors import ModelError
from floatsim.frames import Array
from floatsim.jit import kernel
from floatsim.pto_laws.law import Index, Now
from floatsim.pto_laws.runge_kutta import GAMMA, solve

# rows of the parameters
AREA, BETA, STROKE, DEAD, VALVE, LAMINAR, PH, GH, PL, GL, EXPONENT, DISPLACEMENT, INERTIA, GENERATOR = range(14)
P1, P2, QH, QL, W = range(5)
STATES = 5
ITERATIONS = 40


@kernel
def _valve(P, j, d):  # type: ignore[no-untyped-def]
    """Flow through a check valve and its derivative."""
    if d <= 0.0:
        return 0.0, 0.0
    y = d * d + P[j, LAMINAR] ** 2
    root = math.sqrt(math.sqrt(y))
    return P[j, VALVE] * d / root, P[j, VALVE] / root * (1.0 - 0.5 * d * d / y)


@kernel
def _gas(p0, V0, n, q):  # type: ignore[no-untyped-def]
    """Pressure of an accumulator that took in q, and its derivative; nan when it is full."""
    if not q < V0:
        return math.nan, math.nan
    p = p0 * (V0 / (V0 - q)) ** n
    return p, n * p / (V0 - q)


@kernel
def rates(P, j, y, s, v, f, J, B):  # type: ignore[no-untyped-def]
    """f (5): dy/dt; J (5, 5): its derivatives by y; B (5, 2): by s and v."""
    A, beta, half = P[j, AREA], P[j, BETA], 0.5 * P[j, STROKE]
    D, c, I = P[j, DISPLACEMENT], P[j, GENERATOR], P[j, INERTIA]
    ph, dph = _gas(P[j, PH], P[j, GH], P[j, EXPONENT], y[QH])
    pl, dpl = _gas(P[j, PL], P[j, GL], P[j, EXPONENT], y[QL])
    for i in range(STATES):
        B[i, 0] = B[i, 1] = f[i] = 0.0
        for k in range(STATES):
            J[i, k] = 0.0
    for chamber in range(2):
        sign = 1.0 if chamber == 0 else -1.0
        out, dout = _valve(P, j, y[chamber] - ph)
        back, dback = _valve(P, j, pl - y[chamber])
        stiff = beta / (P[j, DEAD] + A * (half - sign * s))
        flow = sign * A * v - out + back
        f[chamber] = stiff * flow
        J[chamber, chamber] = -stiff * (dout + dback)
        J[chamber, QH], J[chamber, QL] = stiff * dout * dph, stiff * dback * dpl
        B[chamber, 0] = sign * A / beta * stiff * stiff * flow
        B[chamber, 1] = stiff * sign * A
        f[QH] += out
        J[QH, chamber] += dout
        J[QH, QH] -= dout * dph
        f[QL] -= back
        J[QL, chamber] += dback
        J[QL, QL] -= dback * dpl
    f[QH] -= D * y[W]
    f[QL] += D * y[W]
    J[QH, W], J[QL, W] = -D, D
    f[W] = (D * (ph - pl) - c * y[W]) / I
    J[W, QH], J[W, QL], J[W, W] = D * dph / I, -D * dpl / I, -c / I


@kernel
def _stage(P, j, base, h, s, v, scale, y, f, J, M, B, b, old, step):  # type: ignore[no-untyped-def]
    """Newton for y = base + h g f(y, s, v), from y; leaves I - h g J in M and df/d(s, v) in B. Whether it converged."""
    rates(P, j, y, s, v, f, J, B)
    gap = _gap(base, h, scale, y, f, b)
    for _ in range(ITERATIONS):
        _newton_matrix(h, J, M)
        if not solve(M, b):
            return False
        worst = 0.0
        for i in range(STATES):
            worst = max(worst, abs(b[i, 0]) / scale[i])
            old[i], step[i] = y[i], b[i, 0]
        # a valve that opens makes Newton jump to and fro over its kink: go only as far as it gets better
        share = 1.0
        while True:
            for i in range(STATES):
                y[i] = old[i] + share * step[i]
            rates(P, j, y, s, v, f, J, B)
            now = _gap(base, h, scale, y, f, b)
            if now <= gap or worst <= 1e-11 or share < 1e-3:
                break
            share *= 0.5
        if not math.isfinite(now):
            return False
        gap = now
        if worst <= 1e-11:
            _newton_matrix(h, J, M)
            return True
    return False


@kernel
def _gap(base, h, scale, y, f, b):  # type: ignore[no-untyped-def]
    """b = base + h g f - y, and its largest entry against the scale."""
    top = 0.0
    for i in range(STATES):
        b[i, 0] = base[i] + h * GAMMA * f[i] - y[i]
        top = max(top, abs(b[i, 0]) / scale[i])
        if not math.isfinite(b[i, 0]):
            return math.inf
    return top


@kernel
def _newton_matrix(h, J, M):  # type: ignore[no-untyped-def]
    """M = I - h g J."""
    for i in range(STATES):
        for k in range(STATES):
            M[i, k] = (1.0 if i == k else 0.0) - h * GAMMA * J[i, k]


@kernel
def hydraulic(P, which, s0, v0, s, v, h, old, new, scale, F, scratch):  # type: ignore[no-untyped-def]
    """Move the states old (n, 5) to new over h, from s0, v0 to s, v, and add forces. Returns what went wrong: 0, or
    1 + law (its states have no solution), or -1 - law (its piston leaves the cylinder). scratch (15, 5)."""
    f, y, base = scratch[12], scratch[13], scratch[14]
    before, step = scratch[10], scratch[11]
    J, M = scratch[0:5], scratch[5:10]
    B, b, D = np.zeros((STATES, 2)), np.zeros((STATES, 1)), np.zeros((STATES, 2))
    wrong = 0
    for j in range(which.shape[0]):
        e = which[j]
        A = P[j, AREA]
        for i in range(STATES):
            y[i] = base[i] = old[j, i]
            D[i, 0] = D[i, 1] = 0.0
        if h > 0.0:
            if abs(s[e]) >= 0.5 * P[j, STROKE]:
                wrong = -1 - j
                continue
            s1, v1 = s0[e] + GAMMA * (s[e] - s0[e]), v0[e] + GAMMA * (v[e] - v0[e])
            good = _stage(P, j, base, h, s1, v1, scale[j], y, f, J, M, B, b, before, step)
            for i in range(STATES):
                for k in range(2):
                    D[i, k] = h * GAMMA * GAMMA * B[i, k]
            good = good and solve(M, D)
            share = (1.0 - GAMMA) / GAMMA
            for i in range(STATES):
                base[i] += share * (y[i] - old[j, i])
            good = good and _stage(P, j, base, h, s[e], v[e], scale[j], y, f, J, M, B, b, before, step)
            for i in range(STATES):
                for k in range(2):
                    D[i, k] = share * D[i, k] + h * GAMMA * B[i, k]
            if not (good and solve(M, D)):
                wrong = 1 + j
                continue
        for i in range(STATES):
            new[j, i] = y[i]
        F[0, e] -= A * (y[P1] - y[P2])
        F[1, e] -= A * (D[P1, 0] - D[P2, 0])
        F[2, e] -= A * (D[P1, 1] - D[P2, 1])
    return wrong


class Hydraulic(Description):
    """Hydraulic PTO; equations at the top of the file.

    area A [m2] of the piston, both sides; stroke S [m], end to end, displacement 0 in its middle; dead_volume V [m3],
    default 5 % of the stroke's. high_pressure, low_pressure [Pa, absolute] and high_gas_volume, low_gas_volume [m3] of
    the accumulators at the start; gas_exponent n. valve_area a [m2] of a check valve times its discharge coefficient,
    laminar_pressure d0 [Pa].
    motor_displacement D [m3/rad], motor_inertia J [kg m2], generator_damping c [N m s/rad].
    bulk_modulus beta [Pa] and density rho [kg/m3] of the oil. At the start the motor runs at its steady speed; during
    statics no oil flows. Along a turn: a rotary actuator, area in m3/rad, stroke in rad.
    """

    area: Positive
    stroke: Positive
    high_pressure: Positive
    low_pressure: Positive
    high_gas_volume: Positive
    low_gas_volume: Positive
    motor_displacement: Positive
    generator_damping: Positive
    motor_inertia: Positive
    valve_area: Positive
    dead_volume: NonNegative | None = None
    gas_exponent: Positive = 1.4
    laminar_pressure: Positive = 1e4
    bulk_modulus: Positive = 1.4e9
    density: Positive = 850.0

    def model_post_init(self, context: Any) -> None:
        if self.high_pressure <= self.low_pressure:
            raise ModelError(
                f"Hydraulic: high_pressure is {self.high_pressure:g} Pa, low_pressure {self.low_pressure:g} Pa; the "
                "first must be larger"
            )

    @staticmethod
    def group() -> type[Any]:
        return Hydraulics

    def row(self) -> tuple[float, ...]:
        dead = 0.05 * self.area * self.stroke if self.dead_volume is None else self.dead_volume
        return (self.area, self.bulk_modulus, self.stroke, dead, self.valve_area * math.sqrt(2.0 / self.density),
                self.laminar_pressure, self.high_pressure, self.high_gas_volume, self.low_pressure,
                self.low_gas_volume, self.gas_exponent, self.motor_displacement, self.motor_inertia,
                self.generator_damping)  # fmt: skip

    def at_rest(self) -> tuple[float, ...]:
        """States at the start: both chambers half way between the accumulators, so that no valve is open."""
        half = 0.5 * (self.high_pressure + self.low_pressure)
        speed = self.motor_displacement * (self.high_pressure - self.low_pressure) / self.generator_damping
        return half, half, 0.0, 0.0, speed


class Hydraulics:
    """All hydraulic laws. Memory (n, 5): states after the last accepted step."""

    def __init__(self, laws: Sequence[Hydraulic], which: Index, labels: Sequence[str]) -> None:
        self.laws, self.which, self.labels = tuple(laws), which, tuple(labels)
        self.P = np.array([law.row() for law in laws])
        self.scale = np.array([[law.high_pressure, law.high_pressure, law.high_gas_volume, law.low_gas_volume,
                                law.at_rest()[W]] for law in laws])  # fmt: skip
        self.new = np.zeros((len(self.laws), STATES))
        self._scratch = np.zeros((15, STATES))

    def start(self, t: float, s: Array) -> Array:
        """Memory at rest."""
        self.new[:] = [law.at_rest() for law in self.laws]
        return self.new.copy()

    def add(self, now: Now, F: Array) -> str | None:
        """Move the states and add forces."""
        h = 0.0 if now.still else now.h
        wrong = hydraulic(self.P, self.which, now.s0, now.v0, now.s, now.v, h, now.memory, self.new,
                          self.scale, F, self._scratch)  # fmt: skip
        if wrong < 0:
            j = -1 - wrong
            return (f"PTO '{self.labels[j]}': its piston leaves the cylinder: displacement "
                    f"{now.s[self.which[j]]:.6g} of half a stroke of {0.5 * self.laws[j].stroke:g}; give it a longer "
                    "stroke or end-stops")  # fmt: skip
        if wrong > 0:
            return f"PTO '{self.labels[wrong - 1]}': its hydraulics find no pressures (an accumulator is full?)"
        low = self.new[:, P1 : P2 + 1]
        if low.min() < 0.0:
            j = int(low.min(axis=1).argmin())
            return (f"PTO '{self.labels[j]}': a chamber of its cylinder falls to {low[j].min():.3g} Pa: the oil would "
                    "cavitate; give it a larger valve_area or low_pressure")  # fmt: skip
        return None

    def commit(self, now: Now) -> bool:
        now.memory[:] = self.new
        return False

    def signals(self) -> list[tuple[int, str, str, str]]:
        """(law, suffix, long name, units)."""
        return [(j, *item) for j in range(len(self.laws)) for item in (
            ("high_pressure", "pressure of the high-pressure accumulator", "Pa"),
            ("low_pressure", "pressure of the low-pressure accumulator", "Pa"),
            ("motor_speed", "speed of the motor", "rad/s"),
            ("generator_power", "power into the generator", "W"))]  # fmt: skip

    def tell(self, now: Now) -> list[float]:
        """Values of the signals."""
        out = []
        for P, y in zip(self.P, self.new, strict=True):
            out += [_gas(P[PH], P[GH], P[EXPONENT], y[QH])[0], _gas(P[PL], P[GL], P[EXPONENT], y[QL])[0], y[W],
                    P[GENERATOR] * y[W] ** 2]  # fmt: skip
        return out
