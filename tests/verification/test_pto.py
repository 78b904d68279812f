"""PTOs against closed forms and fine integrations by SciPy, their tangents, energy and symmetries.

A mass on a slide is integrated twice: by floatsim, and as m dv/dt = F(s, v) with solve_ivp (rtol 1e-10) from a law that
is written down here once more. Bars: 0.5 % of the range of the reference.
"""

from __future__ import annotations

import pickle

import numpy as np
import pytest
import test_tangents
from mechanics import DRY, observed_order
from pto_joints import Loose, Pin
from scipy.integrate import solve_ivp
from scipy.interpolate import RegularGridInterpolator

import floatsim as fs
from floatsim.parts.pto import PTO
from floatsim.pto_laws.coulomb import Coulomb
from floatsim.pto_laws.end_stop import EndStop
from floatsim.pto_laws.force_table import ForceTable
from floatsim.pto_laws.hydraulic import Hydraulic
from floatsim.pto_laws.linear import Linear
from floatsim.pto_laws.one_sided import CompressionOnly, TensionOnly
from floatsim.pto_laws.polynomial import Polynomial
from floatsim.pto_laws.taut_mooring import TautMooring
from floatsim.pto_laws.user_law import UserLaw

BAR = 0.005
AXIS = np.array([0.6, 0.0, 0.8])


def rig(laws, mass=1.0, s=0.0, v=0.0, **more):
    """A mass on a slide along AXIS, its weight balanced, displaced by s and moving with v: (system, state)."""
    slide = Loose(a="bob", b=(0, 0, 5), axis=tuple(AXIS), turns=False, name="slide")
    pto = PTO(name="pto", joint="slide", laws=laws, **more)
    system = fs.assemble(balanced(fs.PointMass(name="bob", mass=mass, position=(0, 0, 5)), [slide], pto))
    state = system.initial_state()
    state.x[0] += s * AXIS
    state.v[:3] = v * AXIS
    return system, state


def balanced(bob, joints, *parts):
    """A model whose mass `bob` is held up by a constant force, its weight: residuals are judged by what forces there
    are, and in free flight there would be none."""
    up = Loose(a="bob", b=(0, 0, 0), turns=False, name="up")
    lift = PTO(name="lift", joint="up", laws=[Linear(preload=9.81 * bob.mass)])
    return fs.Model(parts=[bob, lift, *parts], joints=[up, *joints], sea=DRY)


def run(system, state, duration, dt, tolerance=1e-6, **more):
    result = fs.simulate(system, duration, dt, state=state, tolerance=tolerance, **more)
    assert result.status == "done", result.failure
    return result


def reference(rates, start, times, max_step=np.inf, method="DOP853", rtol=1e-10, atol=1e-12):
    """States (n, times) of dy/dt = rates(t, y)."""
    found = solve_ivp(rates, (0.0, times[-1]), start, t_eval=times, rtol=rtol, atol=atol, max_step=max_step,
                      method=method)  # fmt: skip
    assert found.success
    return found.y


def error(mine, exact):
    """Largest difference over the range of the reference."""
    return float(np.abs(mine - exact).max() / np.ptp(exact))


def table_law(kind):
    s, v = np.linspace(-1.2, 1.2, 25), np.linspace(-3.0, 3.0, 31)
    F = force_of_table(s[:, None], v[None, :])
    return ForceTable(displacement=s, velocity=v, force=F, interpolation=kind)


def force_of_table(s, v):
    return -4.0 * s - 3.0 * s**3 - 0.4 * v * (1.0 + s * s) - 0.1 * np.abs(v) * v


CURVES = {  # laws, m, s, v at the start, dt, duration, F(s, v) written once more
    "linear": ([Linear(stiffness=9.0, damping=0.3, preload=2.0, free_position=0.1)], 1.0, 0.5, 0.0, 0.02, 10.0,
               lambda s, v: 2.0 - 9.0 * (s - 0.1) - 0.3 * v),
    "polynomial": ([Polynomial(stiffness=(4.0, -1.0, 8.0), damping=(0.05, 0.1, 0.02))], 1.0, 1.0, 0.0, 0.02, 10.0,
                   lambda s, v: -4 * s + s**2 - 8 * s**3 - (0.05 + 0.1 * abs(v) + 0.02 * v**2) * v),
    "tension and compression only": ([TensionOnly(stiffness=9.0, damping=0.2, free_position=0.1),
                                      CompressionOnly(stiffness=25.0, free_position=-0.1)], 1.0, 0.0, 2.0, 0.01, 6.0,
                                     lambda s, v: -(max(s - 0.1, 0) * 9 + np.clip(0.2 * v, -9 * max(s - 0.1, 0),
                                                                                   9 * max(s - 0.1, 0)))
                                     + 25 * max(-0.1 - s, 0)),
    "end-stops": ([EndStop(lower=-0.5, upper=0.4, stiffness=1e4, damping=2e3)], 2.0, 0.0, 1.5, 0.002, 4.0,
                  lambda s, v: -max(s - 0.4, 0) * max(1e4 + 2e3 * v, 0) + max(-0.5 - s, 0) * max(1e4 - 2e3 * v, 0)),
    "several laws": ([Linear(damping=0.2), Polynomial(stiffness=(4.0,)), EndStop(upper=0.5, stiffness=400.0)], 1.0,
                     -1.0, 0.0, 0.004, 8.0, lambda s, v: -0.2 * v - 4 * s - 400 * max(s - 0.5, 0)),
    "table, smooth": ([table_law("smooth")], 1.0, 1.0, 0.0, 0.02, 8.0, force_of_table),
    "table, linear": ([table_law("linear")], 1.0, 1.0, 0.0, 0.02, 8.0, None),
}  # fmt: skip


@pytest.mark.parametrize("name", CURVES)
def test_motion_under_laws(name, record):
    laws, m, s, v, dt, duration, force = CURVES[name]
    if force is None:
        t = laws[0]
        grid = RegularGridInterpolator((t.displacement, t.velocity), np.array(t.force))

        def force(s, v):
            return float(grid((s, v)))

    system, state = rig(laws, m, s, v)
    found = run(system, state, duration, dt)
    ode = reference(lambda t, y: [y[1], force(y[0], y[1]) / m], [s, v], found.time, max_step=0.01)
    pull = np.array([force(*y) for y in ode.T])
    record("PTO laws against SciPy", f"{name}: displacement", error(found.series("pto_displacement"), ode[0]), BAR)
    if "end-stop" not in name:  # there the force is a spike, and a late bounce shifts it
        record("PTO laws against SciPy", f"{name}: force", error(found.series("pto_force"), pull), BAR)


def test_end_stop_bounce_closed_form(record):
    """Undamped: in contact for pi sqrt(m/k), away with the speed it came with. Damped: Hunt & Crossley, energy by
    y - ln(1 + y) with y = b v/k before, and y + ln(1 - y) after the bounce."""
    m, k, v, gap = 3.0, 3e4, 1.2, 0.3
    system, state = rig([EndStop(upper=gap, stiffness=k)], m, 0.0, v)
    found = run(system, state, 1.0, 2.5e-4)
    contact = np.pi * np.sqrt(m / k)
    exact = gap - v * (1.0 - gap / v - contact)  # came back from the stop at t = gap/v + contact
    record("end-stop bounce, closed form", "place after the bounce",
           abs(found.series("pto_displacement")[-1] - exact) / gap, BAR)  # fmt: skip
    from scipy.optimize import brentq

    b = 0.5 * k
    system, state = rig([EndStop(upper=gap, stiffness=k, damping=b)], m, 0.0, v)
    found = run(system, state, 1.0, 2.5e-4)
    before = b * v / k
    after = brentq(lambda y: -np.log(1.0 - y) - y - (before - np.log(1.0 + before)), 1e-9, 1.0 - 1e-9)
    record("end-stop bounce, closed form", "speed after a damped bounce",
           abs(-found.series("pto_velocity")[-1] / (after * k / b) - 1.0), BAR)  # fmt: skip


def test_slamming_end_stop(record):
    """100 t at 3 m/s into 1e8 N/m with steps of 0.05 s: survives, and comes back no faster than it came."""
    m, k, v = 1e5, 1e8, 3.0
    stop = EndStop(lower=-2.0, upper=2.0, stiffness=k, damping=0.2 * k)
    system, state = rig([stop], m, 0.0, v)
    found = run(system, state, 20.0, 0.05, tolerance=fs.Stepper(system).tolerance)
    speed = np.abs(found.series("pto_velocity"))
    record("slamming end-stop", "largest speed over that of the start", speed.max() / v, 1.01)
    record("slamming end-stop", "largest penetration over v sqrt(m/k)",
           (np.abs(found.series("pto_displacement")).max() - 2.0) / (v * np.sqrt(m / k)), 1.05)  # fmt: skip
    elastic = rig([EndStop(lower=-2.0, upper=2.0, stiffness=k)], m, 0.0, v)
    found = run(*elastic, 20.0, 0.05, tolerance=fs.Stepper(system).tolerance)
    speed = np.abs(found.series("pto_velocity"))
    record("slamming end-stop", "elastic: largest speed over that of the start", speed.max() / v, 1.01)
    free = np.abs(found.series("pto_displacement")) < 2.0
    last = speed[free][-1] / v
    record("slamming end-stop", "elastic: speed over that of the start after 14 bounces", last, (0.95, 1.01))
    record("slamming end-stop", "elastic: steps, of 400 without cuts", found.steps, 1500)


def test_coulomb_oscillator(record):
    """Exact piecewise: every half cycle is a cosine about -+ F_c/k, the amplitude falls by 2 F_c/k, then it sticks."""
    m, k, Fc, s0 = 1.0, 4.0, 0.3, 1.0
    w = np.sqrt(k / m)
    system, state = rig([Linear(stiffness=k), Coulomb(friction=Fc, speed=1e-3)], m, s0)
    found = run(system, state, 14.0, 0.005)
    exact = np.empty_like(found.time)
    for i, t in enumerate(found.time):
        half = int(t * w / np.pi)
        top = (-1) ** half * (s0 - 2.0 * half * Fc / k)
        if abs(top) <= Fc / k:
            exact[i] = top
            continue
        centre = np.sign(top) * Fc / k
        exact[i] = centre + (top - centre) * np.cos(w * t - half * np.pi)
    # the last turning point that still slides; after it, the mass sticks
    stops = [(-1) ** n * (s0 - 2.0 * n * Fc / k) for n in range(20)]
    rest = next(n for n, y in enumerate(stops) if abs(y) <= Fc / k)
    exact[found.time >= rest * np.pi / w] = stops[rest]
    record("Coulomb oscillator, piecewise exact", "displacement", error(found.series("pto_displacement"), exact), BAR)


def test_taut_mooring(record):
    """A mass on a taut tendon swings across: m x'' = -T x/l with T = T0 + (EA/L)(l - l0); and one that goes slack."""
    T0, EA, L, m = 50.0, 2e3, 10.0, 4.0
    tendon = PTO(name="tendon", a="bob", b=(0, 0, 5), laws=[TautMooring(pretension=T0, EA=EA, length=L)])
    for name, start in (("swinging", (2.0, 0.0, 0.0)), ("slack and snap", (0.0, 0.0, -1.0))):
        bob = fs.PointMass(name="bob", mass=m, position=(0, 0, 5 + L))
        system = fs.assemble(balanced(bob, [], tendon))
        state = system.initial_state()
        state.v[:3] = start
        found = run(system, state, 6.0, 0.005)

        def rates(t, y):
            r = np.array([y[0], L + y[1]])
            l = np.hypot(*r)
            T = max(T0 + EA / L * (l - L), 0.0)
            return [y[2], y[3], *(-T / m * r / l)]

        ode = reference(rates, [0.0, 0.0, start[0], start[2]], found.time, max_step=0.01)
        place = found.series("bob_position")
        k = 0 if name == "swinging" else 1
        mine = place[:, 0] if k == 0 else found.series("tendon_displacement")
        exact = ode[0] if k == 0 else np.hypot(ode[0], L + ode[1]) - L
        record("taut mooring against SciPy", name, error(mine, exact), BAR)


HYDRAULIC = dict(area=0.02, stroke=6.0, high_pressure=9e6, low_pressure=1e6, high_gas_volume=0.5, low_gas_volume=1.0,
                 motor_displacement=2e-5, generator_damping=1.6, motor_inertia=2.0, valve_area=1e-3)  # fmt: skip


def hydraulic_rates(P):
    """The equations of the hydraulic PTO once more, in SciPy's form: rates(y, s, v) of (p1, p2, qh, ql, w)."""

    def valve(d):
        return P["valve_area"] * np.sqrt(2 / 850) * d / (d * d + 1e8) ** 0.25 if d > 0 else 0.0

    def rates(y, s, v):
        p1, p2, qh, ql, w = y
        A, beta, S, D = P["area"], 1.4e9, P["stroke"], P["motor_displacement"]
        ph = P["high_pressure"] * (1 - qh / P["high_gas_volume"]) ** -1.4
        pl = P["low_pressure"] * (1 - ql / P["low_gas_volume"]) ** -1.4
        o1, o2, b1, b2 = valve(p1 - ph), valve(p2 - ph), valve(pl - p1), valve(pl - p2)
        V = A * S / 2 + 0.05 * A * S
        return [beta / (V - A * s) * (A * v - o1 + b1), beta / (V + A * s) * (-A * v - o2 + b2), o1 + o2 - D * w,
                D * w - b1 - b2, (D * (ph - pl) - P["generator_damping"] * w) / P["motor_inertia"]]  # fmt: skip

    return rates


def test_hydraulic(record):
    m, k = 2e5, 2e5
    pto = Hydraulic(**HYDRAULIC)
    system, state = rig([Linear(stiffness=k), pto], m, 2.0)
    found = run(system, state, 20.0, 0.005, interval=0.02)
    own = hydraulic_rates(HYDRAULIC)
    A = HYDRAULIC["area"]

    def rates(t, y):
        return [y[1], (-k * y[0] - A * (y[2] - y[3])) / m, *own(y[2:], y[0], y[1])]

    start = [2.0, 0.0, *pto.at_rest()]
    scale = np.array([1.0, 1.0, 1e6, 1e6, 1e-2, 1e-2, 1e2])
    ode = reference(rates, start, found.time, max_step=0.01, method="Radau", rtol=1e-8, atol=1e-9 * scale)
    high = HYDRAULIC["high_pressure"] * (1 - ode[4] / HYDRAULIC["high_gas_volume"]) ** -1.4
    low = HYDRAULIC["low_pressure"] * (1 - ode[5] / HYDRAULIC["low_gas_volume"]) ** -1.4
    check = "hydraulic PTO against SciPy"
    record(check, "displacement", error(found.series("pto_displacement"), ode[0]), BAR)
    record(check, "high pressure", error(found.series("pto_high_pressure"), high), BAR)
    record(check, "low pressure", error(found.series("pto_low_pressure"), low), BAR)
    record(check, "motor speed", error(found.series("pto_motor_speed"), ode[6]), BAR)
    force = -k * ode[0] - A * (ode[2] - ode[3])
    gap = found.series("pto_force") - force
    record(check, "force, rms", float(np.sqrt(np.mean(gap**2)) / np.ptp(force)), BAR)


def test_hydraulic_books(record):
    """Oil is conserved, and what the cylinder absorbs is found again: in gas, motor and generator, the rest is lost in
    valves. Over 60 s of forced motion; the chambers' own compression, 2 V p/beta and V p^2/beta, is what stays open."""
    P = Hydraulic(**HYDRAULIC)
    drive = UserLaw(function=lambda t, s, v: 2e5 * np.sin(0.9 * t))
    system, state = rig([Linear(stiffness=1.6e5), drive, P], 2e5)
    spring = PTO(name="drive", joint="slide", laws=[Linear(stiffness=1.6e5), drive])
    parts = [part for part in system.model.parts if part.name != "pto"]
    system = fs.assemble(system.model.model_copy(update={"parts": [*parts, spring, PTO(name="pto", joint="slide",
                                                                                         laws=[P])]}))  # fmt: skip
    found = run(system, system.initial_state(), 60.0, 0.02)

    def taken_in(pressure, start, volume):
        return volume * (1.0 - (pressure / start) ** (-1.0 / 1.4))

    def gas_energy(q, start, volume):  # integral of p dq
        return start * volume / 0.4 * ((1.0 - q / volume) ** -0.4 - 1.0)

    qh = taken_in(found.series("pto_high_pressure"), P.high_pressure, P.high_gas_volume)
    ql = taken_in(found.series("pto_low_pressure"), P.low_pressure, P.low_gas_volume)
    pumped = P.area * float(np.abs(np.diff(found.series("pto_displacement"))).sum())
    open_oil = 2.0 * 0.55 * P.area * P.stroke * found.series("pto_high_pressure").max() / P.bulk_modulus
    record("books of the hydraulic PTO", "oil lost over oil pumped", float(np.abs(qh + ql).max() / pumped),
           open_oil / pumped)  # fmt: skip
    w = found.series("pto_motor_speed")
    made = np.trapezoid(found.series("pto_generator_power"), found.time)
    stored = gas_energy(qh, P.high_pressure, P.high_gas_volume) + gas_energy(ql, P.low_pressure, P.low_gas_volume)
    stored += 0.5 * P.motor_inertia * (w**2 - w[0] ** 2)
    absorbed = found.series("pto_energy")[-1]
    record("books of the hydraulic PTO", "share of the absorbed energy lost in valves",
           float((absorbed - made - stored[-1]) / absorbed), (0.0, 0.1))  # fmt: skip


def test_user_law_with_states(record):
    """A spring that lags behind, dz/dt = (s - z)/T, F = -k z - c v, in time a push: three ways agree with SciPy."""
    k, c, T = 9.0, 0.4, 0.8

    def law(t, s, v, y):
        return -k * y[0] - c * v + np.sin(t), [(s - y[0]) / T]

    system, state = rig([UserLaw(function=law, states=(0.0,), names=["z"]), Linear(stiffness=2.0)], 1.0, 1.0)
    found = run(system, state, 10.0, 0.02)
    ode = reference(lambda t, y: [y[1], -k * y[2] - c * y[1] + np.sin(t) - 2.0 * y[0], (y[0] - y[2]) / T],
                    [1.0, 0.0, 0.0], found.time)  # fmt: skip
    record("user law against SciPy", "displacement", error(found.series("pto_displacement"), ode[0]), BAR)
    record("user law against SciPy", "state", error(found.series("pto_z"), ode[2]), BAR)


def test_user_law_without_states(record):
    system, state = rig([UserLaw(function=lambda t, s, v: -9.0 * s - 0.3 * abs(v) * v)], 1.0, 1.0)
    found = run(system, state, 10.0, 0.02)
    ode = reference(lambda t, y: [y[1], -9.0 * y[0] - 0.3 * abs(y[1]) * y[1]], [1.0, 0.0], found.time)
    record("user law against SciPy", "without states", error(found.series("pto_displacement"), ode[0]), BAR)


def test_sampled_controller(record):
    """Force held over every 0.5 s, with the sum of errors as a state: exact from parabola to parabola."""
    T, kp, ki, kd = 0.5, 1.0, 0.1, 0.8

    def controller(t, s, v, y):
        total = y[0] + s * T
        return -kp * s - kd * v - ki * total, [total]

    system, state = rig([UserLaw(function=controller, states=(0.0,), sample_time=T)], 1.0, 1.0, 0.0)
    system.forget(state)  # the first sample is taken where it starts
    found = run(system, state, 10.0, 0.05)
    s, v, total, exact = 1.0, 0.0, 0.0, []
    F = 0.0
    for k, t in enumerate(found.time):
        if k % 10 == 0:
            if k:
                s, v = s + v * T + 0.5 * F * T**2, v + F * T
            total += s * T
            F = -kp * s - kd * v - ki * total
        d = t - (k // 10) * T
        exact.append(s + v * d + 0.5 * F * d * d)
    record("sampled controller, closed form", "displacement",
           error(found.series("pto_displacement"), np.array(exact)), BAR)  # fmt: skip


def spring_energy(found, m, k):
    s, v = found.series("pto_displacement"), found.series("pto_velocity")
    return 0.5 * m * v**2 + 0.5 * k * s**2


@pytest.mark.parametrize("law", ["damper", "hydraulic"])
def test_energy(law, record):
    """Integral of power equals the loss of mechanical energy, with second order in the step."""
    m, k = 2e5, 2e5
    laws = {"damper": Polynomial(damping=(1e4, 2e4)), "hydraulic": Hydraulic(**HYDRAULIC)}
    gaps = []
    for dt in (0.04, 0.02, 0.01):
        spring = PTO(name="spring", joint="slide", laws=[Linear(stiffness=k)])
        bob = fs.PointMass(name="bob", mass=m, position=(0, 0, 5))
        pto = PTO(name="pto", joint="slide", laws=[laws[law]])
        slide = Loose(a="bob", b=(0, 0, 5), axis=(0, 0, 1), turns=False, name="slide")
        system = fs.assemble(balanced(bob, [slide], spring, pto))
        state = system.initial_state()
        state.x[0, 2] += 2.0
        found = run(system, state, 12.0, dt)
        mechanical = spring_energy(found, m, k)
        absorbed = found.series("pto_energy")
        assert absorbed[-1] > 0.2 * mechanical[0]
        gaps.append(float(np.abs(mechanical[0] - mechanical - absorbed).max() / mechanical[0]))
        power = found.series("pto_power")
        assert np.allclose(power, -found.series("pto_force") * found.series("pto_velocity"))
    record("energy of a PTO", f"{law}: power integral against loss of energy, dt 0.01 s", gaps[-1], 1e-3)
    record("energy of a PTO", f"{law}: order in the step", observed_order(gaps), (1.7, 2.6))


# -- tangents, memory, symmetries -------------------------------------------------------------

LAWS = {
    "linear": lambda: Linear(stiffness=300.0, damping=20.0, preload=5.0),
    "polynomial": lambda: Polynomial(stiffness=(300.0, -50.0, 70.0), damping=(20.0, 30.0, 5.0)),
    "table, smooth": lambda: ForceTable(displacement=np.linspace(-9, 9, 7), velocity=np.linspace(-9, 9, 6),
                                   force=np.random.default_rng(1).uniform(-50, 50, (7, 6))),
    "table, linear": lambda: ForceTable(displacement=np.linspace(-9, 9, 7), velocity=np.linspace(-9, 9, 6),
                                   force=np.random.default_rng(1).uniform(-50, 50, (7, 6)), interpolation="linear"),
    "Coulomb": lambda: Coulomb(friction=40.0, speed=0.7),
    "end-stop": lambda: EndStop(lower=-0.05, upper=0.05, stiffness=300.0, damping=100.0),
    "tension only": lambda: TensionOnly(stiffness=300.0, damping=40.0, free_position=-0.1),
    "compression only": lambda: CompressionOnly(stiffness=300.0, damping=40.0, free_position=0.6),
    "taut mooring": lambda: TautMooring(pretension=60.0, EA=3e3, length=10.0, damping=4.0),
    "user": lambda: UserLaw(function=lambda t, s, v: -30.0 * np.sin(s) - 4.0 * v * abs(v)),
}  # fmt: skip


def everywhere(law):
    """Two free bodies with the law on a slide, a turn and a distance between them."""
    laws = [law]
    parts = [*test_tangents.two_bodies(), PTO(name="slide", joint="j", coordinate="slide", laws=laws),
             PTO(name="turn", joint="j", coordinate="turn", laws=laws),
             PTO(name="apart", a="one.p", b="two.p", laws=laws)]  # fmt: skip
    joint = Loose(a="one.p", b="two.p", axis=(1.0, 2.0, 0.5), name="j")
    return fs.Model(parts=parts, joints=[joint], sea=DRY)


@pytest.mark.parametrize("name", LAWS)
def test_tangent(name, record, monkeypatch):
    monkeypatch.setitem(test_tangents.SYSTEMS, f"PTO, {name}", (lambda: everywhere(LAWS[name]()), None, {}))
    test_tangents.test_matrix_is_derivative_of_residual(f"PTO, {name}", True, record)


@pytest.mark.parametrize("which", ["hydraulic", "user"])
def test_tangent_of_condensed_states(which, record):
    """dF/ds and dF/dv at the end of a step, states condensed out, by differences over the whole local step."""
    def lag(t, s, v, y):
        return -40.0 * y[0] ** 3 - 3.0 * v * y[1], [s - 2.0 * y[0] + v**2, -5.0 * y[1] + s * y[0]]

    law = Hydraulic(**HYDRAULIC) if which == "hydraulic" else UserLaw(function=lag, states=(0.4, -0.2))
    system, state = rig([law], 1e5, 0.5, 0.7)
    batch = next(b for b in system.batches if hasattr(b, "groups"))
    w = system.work()
    system.begin(w, state, 0.05)
    worst = 0.0
    for s, v in ((0.52, 0.8), (0.56, -0.3), (0.5, 0.1)):
        F = np.zeros((3, 2))
        columns = []
        for ds, dv in ((0, 0), (1e-5, 0), (-1e-5, 0), (0, 1e-5), (0, -1e-5)):
            batch.now.s[1], batch.now.v[1] = s + ds, v + dv
            assert batch._forces(F) is None
            columns.append(F[:, 1].copy())
        by = (columns[1][0] - columns[2][0]) / 2e-5, (columns[3][0] - columns[4][0]) / 2e-5
        worst = max(worst, abs(by[0] - columns[0][1]) / max(abs(by[0]), 1e-3 * abs(by[1])),
                    abs(by[1] - columns[0][2]) / abs(by[1]))  # fmt: skip
    record("tangent of a PTO's condensed states", which, worst, 1e-5)


def pinned(a="arm.pin", b=(0.0, 0.0, 5.0), laws=None, turn=0.0):
    """An arm on a hinge about y, without weight."""
    arm = fs.Body(name="arm", mass=2.0, inertia=(1.0, 1.5, 0.7), position=(0, 0, 5), points={"pin": (0, 0, 0)})
    laws = laws or [Linear(stiffness=3.0)]
    pto = PTO(name="pto", joint="hinge", laws=laws)
    hinge = Pin(a=a, b=b, axis=(0, 1, 0), name="hinge")
    return fs.assemble(fs.Model(parts=[arm, pto], joints=[hinge], sea=DRY, gravity=0.0))


def test_angle_counts_turns(record):
    """A wheel at 2 rad/s for 20 s: 40 rad, in pieces, through a restart from a pickled state; its spring follows."""
    system = pinned(laws=[Polynomial(damping=(1e-12,))])
    state = system.initial_state()
    state.v[7] = 2.0
    first = run(system, state, 10.0, 0.1)
    again = pickle.loads(pickle.dumps(first.state)).copy()
    second = run(pinned(laws=[Polynomial(damping=(1e-12,))]), again, 10.0, 0.1)
    angle = np.concatenate([first.series("pto_displacement"), second.series("pto_displacement")[1:]])
    time = np.concatenate([first.time, second.time[1:]])
    record("angle of a hinge", "after 6 turns", float(np.abs(angle - 2.0 * time).max()), 1e-3, "rad")
    assert np.allclose(second.series("hinge_angle"), second.series("pto_displacement"))
    assert np.allclose(second.series("hinge_rate"), 2.0, atol=1e-4)
    kept, _ = fs.solve_static(pinned(), second.state, hold=["arm"])
    assert kept.history and np.isclose(_angle(pinned(), kept), 40.0, atol=1e-3)


def _angle(system, state):
    k = next(k for k, b in enumerate(system.batches) if hasattr(b, "groups"))
    return state.history[k].s[0]


def test_torsion_spring_period(record):
    """J theta'' = -k theta, from 2.5 turns."""
    system = pinned(laws=[Linear(stiffness=3.0)])
    state = system.initial_state()
    rate = 5.0 * np.pi * np.sqrt(3.0 / 1.5)
    state.v[7] = rate
    found = run(system, state, 8.0, 0.005)
    w = np.sqrt(3.0 / 1.5)
    record("angle of a hinge", "torsion spring over 2.5 turns",
           error(found.series("pto_displacement"), 5.0 * np.pi * np.sin(w * found.time)), BAR)  # fmt: skip


def test_moment_of_a_hinge_is_pure(record):
    """About the axis, on a and the opposite on b, wherever the hinge stands; no force at all."""
    parts = test_tangents.two_bodies()
    c = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c[0], 0, c[1]], [0, 1, 0], [-c[1], 0, c[0]]])
    hinge = Pin(a="two.o", b="one.p", axis=(0, 1, 0), name="hinge")
    pto = PTO(name="pto", joint="hinge", laws=[Linear(preload=3.0)])
    system = fs.assemble(fs.Model(parts=[*parts, pto], joints=[hinge], sea=DRY))
    w = system.work()
    state = system.initial_state()
    system.load(w, state)
    system.begin(w, state, 0.0)
    w.R[1] = turn @ w.R[1]
    w.r.fill(0.0)
    next(b for b in system.batches if hasattr(b, "groups")).add(w)
    n = 3 * (system.n_point + 1)
    exact = np.zeros(system.n)
    exact[n + 1], exact[n + 4] = 3.0, -3.0  # residual: load with the sign turned
    record("angle of a hinge", "moment and forces against a pure moment", float(np.abs(w.r - exact).max()) / 3.0, 1e-12)


def test_swapping_a_and_b():
    """Bodies swapped: same motion; a distance is the same both ways, its force too."""
    def motion(swap):
        ends = dict(a="two.p", b="one.p") if swap else dict(a="one.p", b="two.p")
        pto = PTO(name="p", **ends, laws=[Linear(stiffness=50.0, damping=3.0)], zero=0.3)
        system = fs.assemble(fs.Model(parts=[*test_tangents.two_bodies(), pto], sea=DRY, gravity=0.0))
        state = system.initial_state()
        state.v[:6] = (0.1, 0.2, -0.3, 0.0, -0.1, 0.2)
        return run(system, start(system, state), 2.0, 0.02)

    def start(system, state):
        state.x[0] += (-0.5, 0.1, 0.2)
        return state

    one, two = motion(False), motion(True)
    for name in ("p_force", "p_displacement", "p_energy", "one_position", "two_position"):
        assert np.allclose(one.series(name), two.series(name), rtol=1e-9, atol=1e-9)


def test_translated_and_rotated():
    """The same system elsewhere, turned about the vertical: the same displacements and forces."""
    def motion(move, yaw):
        c, s = np.cos(yaw), np.sin(yaw)
        turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        parts = []
        for body, x in (("one", (0, 0, 5)), ("two", (1.0, 0.4, 5.5))):
            parts.append(fs.Body(name=body, mass=3.0, inertia=(4, 6, 7), position=turn @ x + move,
                                 attitude_deg=(0, 0, np.degrees(yaw)), points={"p": (0.2, 0.1, 0.3)}))  # fmt: skip
        law = [Polynomial(stiffness=(40.0, 0.0, 30.0), damping=(2.0, 1.0))]
        joint = Loose(a="one.p", b="two.p", axis=(1.0, 2.0, 0.5), name="j")
        ptos = [PTO(name="s", joint="j", coordinate="slide", laws=law),
                PTO(name="t", joint="j", coordinate="turn", laws=law), PTO(name="d", a="one.p", b="two", laws=law)]
        system = fs.assemble(fs.Model(parts=[*parts, *ptos], joints=[joint], sea=DRY))
        state = system.initial_state()
        n = 3 * (system.n_point + 1)
        state.v[:3], state.v[3:6] = turn @ (0.3, 0.1, -0.2), turn @ (-0.2, 0.3, 0.1)
        state.v[n : n + 3] = turn @ (0.2, 0.3, -0.1)
        return run(system, state, 2.0, 0.02)

    here, there = motion(np.zeros(3), 0.0), motion(np.array([30.0, -20.0, 4.0]), 1.1)
    for p in "std":
        for channel in ("displacement", "velocity", "force", "power", "energy"):
            assert np.allclose(here.series(f"{p}_{channel}"), there.series(f"{p}_{channel}"), atol=1e-6), (p, channel)
    assert np.allclose(here.series("j_displacement"), here.series("s_displacement"))
    assert np.allclose(here.series("j_rate"), here.series("t_velocity"))


def test_momentum_is_conserved(record):
    """Forces and moments on both sides cancel: linear and angular momentum of two free bodies stay."""
    system = fs.assemble(everywhere(LAWS["polynomial"]()).model_copy(update={"gravity": 0.0}))
    state = system.initial_state()
    n = 3 * (system.n_point + 1)
    state.v[n : n + 6] = (0.5, 1.0, -0.7, -0.3, 0.2, 0.6)
    w = system.work()
    system.load(w, state)
    system.begin(w, state, 0.0)
    batch = next(b for b in system.batches if hasattr(b, "groups"))
    w.x[0] += (0.3, -0.2, 0.4)
    w.r.fill(0.0)
    batch.add(w)
    f = w.r[: 3 * system.n_point].reshape(-1, 3)
    m = w.r[n : n + 6].reshape(-1, 3)
    moment = m.sum(axis=0) + np.cross(w.x[: system.n_point], f).sum(axis=0)
    assert np.abs(f).max() > 1.0
    record("PTO between two free bodies", "sum of forces and moments over the largest",
           float(max(np.abs(f.sum(axis=0)).max(), np.abs(moment).max()) / np.abs(w.r).max()), 1e-12)  # fmt: skip


def test_rejected_steps_leave_no_trace():
    """A step that fails leaves memory as it was; the states of laws are in it."""
    law = UserLaw(function=lambda t, s, v, y: (-y[0], [s - y[0]]), states=(0.3,))
    table = ForceTable(displacement=(-1, 1), velocity=(-1, 1), force=((0, 0), (0, 0)))
    system, state = rig([law, table], 1.0, 0.0, 0.9)
    stepper = fs.Stepper(system)
    stepper.step(state, 0.1)
    before = pickle.dumps(state.history)
    state.v[:3] = 2.0 * AXIS
    report = stepper.step(state, 0.1)
    assert not report.converged and "PTO 'pto': its velocity is" in report.reason
    assert pickle.dumps(state.history) == before
