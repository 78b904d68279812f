"""The energy ledger: every account against closed forms, books that balance in any state, runs whose ledger closes.

Three things are told apart. What a batch books must be all that its forces do (`test_books_hold_all_that_forces_do`,
against the residual times the velocities). What it calls stored must be the energy that belongs to its forces
(`test_stored_energies_belong_to_their_forces`, against differences along the motion). And every account of a run must
be the work it says (all others, against closed forms or SciPy).
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from mechanics import DRY, displace, free_unknowns, observed_order
from scipy.integrate import solve_ivp
from test_tangents import SYSTEMS, bodies, keep_alone, random_state

import floatsim as fs
from floatsim.parts.body import BodyBatch
from floatsim.study.energy import Ledger

ROW_BOOKS = "energy ledger: books of every part"
ROW_WORK = "energy ledger: accounts against closed forms"
ROW_CLOSE = "energy ledger: closure"
G = 9.81

# -- books ---------------------------------------------------------------------------------------------------------

LAWS = {
    "linear": fs.Linear(stiffness=400.0, damping=30.0, preload=50.0, free_position=0.1),
    "polynomial": fs.Polynomial(stiffness=(100.0, -20.0, 300.0), damping=(20.0, 40.0), free_position=0.2),
    "Coulomb": fs.Coulomb(friction=70.0, speed=0.3),
    "tension only": fs.TensionOnly(stiffness=400.0, damping=30.0, free_position=-9.0),
    "compression only": fs.CompressionOnly(stiffness=400.0, damping=30.0, free_position=9.0),
    "taut mooring": fs.TautMooring(pretension=2e3, EA=4e3, length=10.0, damping=30.0),
    "end-stop": fs.EndStop(lower=2.5, upper=9.0, stiffness=300.0, damping=50.0),
}


def system_of_laws(law):
    return lambda: bodies(parts=[fs.PTO(name="pto", a="one.p", b=(1, 2, 3), laws=[law])])


BOOKS = SYSTEMS | {f"PTO, {name}": (system_of_laws(law), None, {}) for name, law in LAWS.items()}


def looked(name, seed):
    """A system in a random state, its ledger and its scratch."""
    model, what, how = BOOKS[name]
    system = fs.assemble(model())
    if what is not None:
        keep_alone(system, what)
    ledger = Ledger(system)
    w = random_state(system, np.random.default_rng(seed), **how)
    w.c[3], w.c[6] = 1.0, 1.0
    system.evaluate(w)
    return system, ledger, w


@pytest.mark.parametrize("name", BOOKS)
def test_books_hold_all_that_forces_do(name, record):
    """Sum of rates less sum of powers is residual times velocities, joints included, in states drawn at random."""
    worst = 0.0
    for seed in range(4):
        system, ledger, w = looked(name, seed)
        power = w.r[: system.n_dof] @ w.v
        ledger.look(w)
        rates, powers = list(ledger.book.rate.values()), [*ledger.book.power.values(), ledger.slip]
        size = sum(map(abs, rates + powers)) + 1e-300
        worst = max(worst, abs(sum(rates) - sum(powers) - power) / size)
    record(ROW_BOOKS, f"{name}: rates and powers against residual times velocities", worst, 1e-12)


STENCIL = ((1.0, 4.0 / 5.0), (2.0, -1.0 / 5.0), (3.0, 4.0 / 105.0), (4.0, -1.0 / 280.0))


@pytest.mark.parametrize("name", [name for name in BOOKS if name != "polyester"])  # its energy has a past
def test_stored_energies_belong_to_their_forces(name, record):
    """dE/dt along the motion, by differences of eighth order, is what the forces take from it."""
    worst = 0.0
    for seed in range(4):
        system, ledger, w = looked(name, seed)
        ledger.look(w)
        rates, start = dict(ledger.book.rate), [y.copy() for y in (w.x, w.q, w.R, w.v, w.a)]
        moving = [i for i in free_unknowns(system) if i < system.n_dof]
        size, found = max(map(abs, rates.values())) + 1e-300, []
        for h in (1e-2, 1e-3, 1e-4):
            slope = dict.fromkeys(rates, 0.0)
            for factor, weight in STENCIL:
                for s in (factor * h, -factor * h):
                    for k in range(0, len(moving), 3):  # points and rotations have three unknowns each
                        turn_or_move(system, w, moving[k : k + 3], s)
                    w.v += s * start[4]
                    system.evaluate(w)
                    ledger.look(w)
                    for store, E in ledger.book.stored.items():
                        slope[store] += math.copysign(weight, weight * s) * E / h
                    for y, old in zip((w.x, w.q, w.R, w.v, w.a), start, strict=True):
                        np.copyto(y, old)
            found.append(max(abs(slope[k] - rates[k]) for k in rates) / size)
        worst = max(worst, min(found))
    record(ROW_BOOKS, f"{name}: stored energy against differences along the motion", worst, 1e-7)


def turn_or_move(system, w, unknowns, s):
    """Move a point by s v, turn a rotation by the spatial vector s w."""
    from floatsim.frames import set_matrix, turn_quaternion

    i = unknowns[0]
    if i < 3 * system.n_point:
        for j in unknowns:
            displace(system, w, j, s * w.v[j])
        return
    k = i // 3 - system.n_point - 1
    w.q[k] = turn_quaternion(tuple(s * w.v[j] for j in unknowns), tuple(w.q[k]))
    set_matrix(w.R, k, tuple(w.q[k]))


def test_rope_stores_and_loses_what_it_is_given(record):
    """T de = dU + D dt along a random way, first loading beyond the old maximum, working curve and slack included."""
    law = fs.StaticDynamic(strain=(0.0, 0.1, 0.3), tension=(0.0, 1e4, 5e4), dynamic_stiffness=6e5, per_tension=2.0,
                           relaxation_time=3.0, permanent_share=0.4)  # fmt: skip
    move, memory, new, out = law.bind(np.zeros(1)), law.start(np.ones(1)), np.zeros((3, 1)), np.zeros((3, 1))
    h, t = 1e-3, np.arange(0.0, 60.0, 1e-3)
    e = 0.1 * (1.0 - np.cos(0.3 * t)) * (1.0 + 0.3 * np.sin(1.1 * t)) - 0.03 * np.sin(0.05 * t)
    work, lost, stored = np.zeros(len(t)), np.zeros(len(t)), np.zeros(len(t))
    before = None
    for i, y in enumerate(e):
        s = np.array([1.0 + y])
        move(s, np.zeros(1), memory, new, h if i else 0.0, out)
        memory[:] = new
        U, D = law.energy(s, new)
        stored[i] = U[0]
        if before is not None:
            work[i] = work[i - 1] + 0.5 * (out[0, 0] + before[0]) * (y - before[1])
            lost[i] = lost[i - 1] + 0.5 * h * (D[0] + before[2])
            assert D[0] >= 0.0
        before = out[0, 0], y, D[0]
    gap = np.abs(work - lost - (stored - stored[0])).max() / lost[-1]
    record(ROW_WORK, "polyester with a permanent share: work against stored and lost", gap, 2e-3)


# -- accounts ------------------------------------------------------------------------------------------------------


def ledger_of(model, duration, dt, state=None, **more):
    """A run with its ledger; it must be done and close."""
    run = fs.simulate(model, duration, dt, state=state, energy=True, tolerance=1e-9, **more)
    assert run.status == "done", run.failure
    print(run.energy.summary())
    assert run.energy.closes
    return run


def off(value, exact):
    return abs(value / exact - 1.0)


def block(*parts, axis=(1.0, 0.0, 0.0), gravity=0.0, mass=3.0):
    """A body that slides along an axis, and a state in which it moves along it with speed v0."""
    body = fs.Body(name="block", mass=mass, inertia=(1.0, 1.0, 1.0), position=(0, 0, 10))
    joint = fs.Slider(a="block", b=(0, 0, 10), axis=axis, name="rail")
    return fs.assemble(fs.Model(parts=[body, *parts], joints=[joint], sea=DRY, gravity=gravity))


def damper(k, c, x0):
    """Spring and damper on the block's rail, stretched by x0 to begin with."""
    return fs.PTO(name="pto", joint="rail", laws=[fs.Linear(stiffness=k, damping=c, free_position=-x0)])


def sinker():
    bed = fs.Seabed(stiffness=2e4, damping=6e2, damping_penetration=0.05)
    buoy = fs.PointBuoy(name="sinker", mass=90.0, volume=0.02, bed_area=0.5, position=(0, 0, -19.5))
    return fs.assemble(fs.Model(parts=[buoy], sea=fs.Sea(depth=20.0, seabed=bed), gravity=G))


def stretched(**more):
    """A mass on a line of one element, stretched by 0.05 m to begin with."""
    mass = fs.PointMass(name="block", mass=3.0, position=(0, 0, 7.95))
    rope = fs.Section(name="rope", mass_per_length=1e-9, diameter=0.01, EA=600.0, axial_damping=24.0, **more)
    parts = [mass, fs.Line(name="line", section=rope, length=2.0, elements=1, taut=True)]
    joints = [fs.Ball(a="line.end_a", b=(0, 0, 10)), fs.Ball(a="line.end_b", b="block")]
    return fs.assemble(fs.Model(parts=parts, joints=joints, sea=DRY, gravity=0.0))


def bent(**more):
    """A clamped line let go straight and level: it falls and bends, damped."""
    stiff = dict(EI=2e3, bending_damping=1e2) | more
    rod = fs.Section(name="rod", mass_per_length=5.0, diameter=0.05, EA=1e7, **stiff)
    line = fs.Line(name="rod", section=rod, length=4.0, elements=16, end_b_position=(4, 0, 10))
    clamp = fs.Clamp(a="rod.end_a", b=(0, 0, 10), direction=(1, 0, 0))
    return fs.assemble(fs.Model(parts=[line], joints=[clamp], sea=DRY, gravity=G))


def pushed(system, v0):
    state = system.initial_state()
    state.v[0] = v0
    return state


def test_pendulum_conserves(record):
    """No work at all; kinetic energy as in the closed form; what the steps dissipate falls with their square."""
    from test_integrator import pendulum, pendulum_motion

    lost = []
    for n in (150, 300, 600):
        system = pendulum()
        run = ledger_of(system, 3.0, 3.0 / n, system.initial_state())
        assert max(map(abs, run.energy.work.values())) == 0.0
        lost.append(abs(run.energy.integrator) / run.energy.peak_kinetic)
        record(ROW_CLOSE, f"pendulum, {n} steps, of the largest kinetic energy", run.energy.closure, 1e-6)
    _, v, _ = pendulum_motion(run.time)
    exact = 0.5 * (2.0 * 1.0 + 0.6) * (v**2).sum(axis=1)  # the reference point is 1 m from the pivot, as the mass
    gap = np.abs(run.series("energy_stored_kinetic") - exact).max() / exact.max()
    record(ROW_WORK, "pendulum: kinetic energy against the closed form", gap, 1e-3)
    record(ROW_WORK, "pendulum: order of what the steps dissipate", observed_order(lost), (1.8, 3.2))


@pytest.mark.parametrize("kind", ["spring", "PTO", "line"])
def test_damped_oscillator(kind, record):
    """Work of the damper is the loss of energy of the closed form."""
    m, k, c, x0, t = 3.0, 300.0, 12.0, 0.05, 2.0
    if kind == "PTO":
        system = block(damper(k, c, x0), mass=m)
    elif kind == "line":  # l0 = 2: k = EA/l0, c = CA/l0
        system = stretched(axial_law=fs.Engineering())
    else:
        mass = fs.PointMass(name="block", mass=m, position=(0, 0, 8 - x0))
        spring = fs.Spring(name="s", a="block", b=(0, 0, 10), stiffness=k, damping=c, free_length=2.0)
        system = fs.assemble(fs.Model(parts=[mass, spring], sea=DRY, gravity=0.0))
    run = ledger_of(system, t, 2e-3, system.initial_state())
    d, w = 0.5 * c / m, math.sqrt(k / m - (0.5 * c / m) ** 2)
    x = x0 * math.exp(-d * t) * (math.cos(w * t) + d / w * math.sin(w * t))
    v = -x0 * math.exp(-d * t) * k / m / w * math.sin(w * t)
    exact = 0.5 * (m * v * v + k * x * x) - 0.5 * k * x0 * x0
    account = "structural" if kind == "line" else "pto"
    record(ROW_WORK, f"damped oscillator, {kind}: work of the damper", off(run.energy.work[account], exact), 1e-3)
    if kind == "PTO":
        store = run.energy.stored["spring"]
        record(ROW_WORK, "damped oscillator, PTO: spring at the start", off(store[0], 0.5 * k * x0**2), 1e-9)


def test_falling_in_water(record):
    """v = v_t tanh(t/tau): works of drag and added mass, heights."""
    m, V, Ca, CdA, t = 50.0, 0.02, 0.5, 0.1, 6.0
    buoy = fs.PointBuoy(name="weight", mass=m, volume=V, drag_area=CdA, added_mass=Ca, position=(0, 0, -50))
    system = fs.assemble(fs.Model(parts=[buoy], sea=fs.Sea(depth=500.0), gravity=G))
    run = ledger_of(system, t, 0.01, system.initial_state())
    rho = 1025.0
    W, c, mass = (m - rho * V) * G, 0.5 * rho * CdA, m + rho * V * Ca
    vt = math.sqrt(W / c)
    tau = mass * vt / W
    v, way = vt * math.tanh(t / tau), vt * tau * math.log(math.cosh(t / tau))
    drag = -c * vt**3 * tau * (math.log(math.cosh(t / tau)) - 0.5 * math.tanh(t / tau) ** 2)
    work, change = run.energy.work, {name: b - a for name, (a, b) in run.energy.stored.items()}
    record(ROW_WORK, "falling in water: drag", off(work["drag"], drag), 1e-3)
    record(ROW_WORK, "falling in water: added mass", off(work["added_mass"], -0.5 * rho * V * Ca * v * v), 1e-3)
    record(ROW_WORK, "falling in water: weight", off(change["gravity"], -m * G * way), 1e-3)
    record(ROW_WORK, "falling in water: buoyancy", off(change["hydrostatic"], rho * V * G * way), 1e-3)
    record(ROW_CLOSE, "falling in water", run.energy.closure, 1e-4)


def test_dragged_by_the_current(record):
    """w = U/(1 + c U t/m): the current gives U m v, of which drag takes m (U^2 - w^2)/2."""
    U, m, t = 1.5, 20.5, 8.0
    buoy = fs.PointBuoy(name="float", mass=m, volume=0.02, drag_area=0.1, position=(0, 0, -50))
    sea = fs.Sea(depth=100.0, current=fs.Current(speed=U))
    system = fs.assemble(fs.Model(parts=[buoy], sea=sea, gravity=G))
    run = ledger_of(system, t, 0.01, system.initial_state())
    w = U / (1.0 + 0.5 * 1025.0 * 0.1 * U * t / m)
    record(ROW_WORK, "dragged by the current: current", off(run.energy.work["current"], U * m * (U - w)), 1e-3)
    record(ROW_WORK, "dragged by the current: drag", off(run.energy.work["drag"], -0.5 * m * (U**2 - w**2)), 1e-3)


def test_water_moves_a_body_that_is_led(record):
    """Inertia of the water on a submerged buoy that is led to and fro under a wave, over ten cycles."""
    H, T, z, X, V, Ca = 1.0, 8.0, -8.0, 0.4, 2.0, 0.6
    w = 2.0 * math.pi / T
    k = w * w / G
    motion = fs.Motion(lambda t: np.array([X * math.cos(w * t), 0, z]),
                       lambda t: np.array([-X * w * math.sin(w * t), 0, 0]),
                       lambda t: np.array([-X * w * w * math.cos(w * t), 0, 0]))  # fmt: skip
    buoy = fs.PointBuoy(name="buoy", mass=900.0, volume=V, added_mass=Ca, position=(X, 0, z))
    sea = fs.Sea(depth=500.0, waves=fs.RegularWave(height=H, period=T), wave_ramp=0.0)
    system = fs.assemble(fs.Model(parts=[buoy], joints=[fs.Prescribed(a="buoy", motion=motion)], sea=sea, gravity=G))
    run = ledger_of(system, 80.0, 0.05, system.initial_state())
    # u = a w e^{kz} cos(w t), its acceleration -a w^2 e^{kz} sin(w t), times -X w sin(w t): half of the product
    cycle = 1025.0 * V * (1.0 + Ca) * 0.5 * H * w * w * math.exp(k * z) * X * w * 0.5 * T
    record(ROW_WORK, "led under a wave: wave", off(run.energy.work["wave"], 10 * cycle), 2e-3)
    record(ROW_WORK, "led under a wave: prescribed motion", off(run.energy.work["prescribed"], -10 * cycle), 5e-3)


def test_chain_dragged_over_the_bed(record):
    """mu w (L - l/2) (d - s/2): the led end's half element is carried by what leads it; s: the slip length."""
    mu, s, L, n, way = 0.6, 0.01, 10.0, 20, 3.0
    chain = fs.Section(name="chain", mass_per_length=20.0, diameter=0.02, EA=1e8, drag_normal=0.0, drag_tangential=0.0,
                       added_mass_normal=0.0, added_mass_tangential=0.0)  # fmt: skip
    line = fs.Line(name="chain", section=chain, length=L, elements=n, end_a_position=(0, 0, -20),
                   end_b_position=(L, 0, -20))  # fmt: skip
    bed = fs.Seabed(stiffness=3e9, damping=3e6, friction=mu, slip_length=s)
    pull = fs.Prescribed(a="chain.end_b", motion=fs.Motion.at_speed((L, 0, -20), (L + way, 0, -20), 0.5, ramp=2.0))
    system = fs.assemble(fs.Model(parts=[line], joints=[pull], sea=fs.Sea(depth=20.0, seabed=bed), gravity=G))
    state = system.initial_state()
    w = (20.0 - 1025.0 * math.pi / 4 * 0.02**2) * G
    state.x[:n, 2] -= w / (3e9 * 0.02)
    run = ledger_of(system, 10.0, 0.01, state)
    exact = -mu * w * (L - 0.5 * L / n) * (way - 0.5 * s)
    record(ROW_WORK, "chain dragged over the bed: friction", off(run.energy.work["friction"], exact), 5e-3)
    record(ROW_WORK, "chain dragged over the bed: prescribed motion", off(run.energy.work["prescribed"], -exact), 1e-2)
    record(ROW_CLOSE, "chain dragged over the bed", run.energy.closure, 1e-3)


def test_block_stops_by_dry_friction(record):
    system = block(fs.PTO(name="brake", joint="rail", laws=[fs.Coulomb(friction=6.0, speed=0.005)]))
    run = ledger_of(system, 2.0, 0.002, pushed(system, 2.0))  # it stops after 1 s
    record(ROW_WORK, "block with dry friction", off(run.energy.work["friction"], -0.5 * 3.0 * 2.0**2), 1e-3)


def test_sinker_hits_the_bed(record):
    """Damper and spring of the bed against SciPy."""
    m, V, area, k, c, z0, t = 90.0, 0.02, 0.5, 2e4, 6e2, -19.5, 1.2
    system = sinker()
    run = ledger_of(system, t, 5e-4, system.initial_state())

    def rates(_, y):
        pen = max(-20.0 - y[0], 0.0)
        lift = max(area * pen * (k - c / 0.05 * y[1]), 0.0)
        return [y[1], (lift - (m - 1025.0 * V) * G) / m, (lift - area * pen * k) * y[1]]

    y = solve_ivp(rates, (0.0, t), [z0, 0.0, 0.0], rtol=1e-10, atol=1e-12, max_step=1e-3).y[:, -1]
    record(ROW_WORK, "sinker on the bed: contact", off(run.energy.work["contact"], y[2]), 5e-3)
    pen = max(-20.0 - y[0], 0.0)
    left = run.energy.stored["seabed"][1]
    record(ROW_WORK, "sinker on the bed: compressed bed", off(left, 0.5 * area * k * pen**2), 1e-2)


def test_rope_in_a_cycle(record):
    """A standard linear solid loses pi e^2 l0 (A - k) w tau/(1 + w^2 tau^2) a cycle."""
    k, A, tau, w, X, L = 1e5, 3e5, 2.0, 2.0 * math.pi / 4.0, 0.1, 10.0
    law = fs.StaticDynamic(strain=(0.0, 0.2), tension=(0.0, 0.2 * k), dynamic_stiffness=A, relaxation_time=tau)
    rope = fs.Section(name="rope", mass_per_length=1.0, diameter=0.05, EA=A, axial_law=law)
    line = fs.Line(name="rope", section=rope, length=L, elements=1, taut=True)
    motion = fs.Motion(lambda t: np.array([L + 0.5 + X * math.sin(w * t), 0, 10]),
                       lambda t: np.array([X * w * math.cos(w * t), 0, 0]),
                       lambda t: np.array([-X * w * w * math.sin(w * t), 0, 0]))  # fmt: skip
    joints = [fs.Ball(a="rope.end_a", b=(0, 0, 10)), fs.Prescribed(a="rope.end_b", motion=motion)]
    system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=DRY, gravity=0.0))
    run = ledger_of(system, 40.0, 0.01, system.initial_state())
    lost = run.series("energy_structural")
    cycle = -math.pi * (X / L) ** 2 * L * (A - k) * w * tau / (1.0 + (w * tau) ** 2)
    record(ROW_WORK, "polyester rope in a cycle", off(lost[-1] - lost[-1 - 2000], 5 * cycle), 2e-3)


def test_broken_line_gives_its_element_up(record):
    """The strain energy of the element that parts is an event."""
    EA, l0, m = 1e5, 2.0, 100.0
    rope = fs.Section(name="rope", mass_per_length=1e-6, diameter=0.01, EA=EA)
    line = fs.Line(name="line", section=rope, length=4 * l0, elements=4, breaks=[fs.Break(at=3.0, time=0.5)])
    parts = [line, fs.PointMass(name="bob", mass=m, position=(0, 0, 20 - 4 * l0))]
    joints = [fs.Ball(a="line.end_a", b=(0, 0, 20)), fs.Ball(a="line.end_b", b="bob")]
    run = ledger_of(fs.assemble(fs.Model(parts=parts, joints=joints, sea=DRY, gravity=G)), 0.6, 0.01)
    from scipy.optimize import brentq

    e = brentq(lambda e: EA * e * math.sqrt(1.0 + 2.0 * e) - m * G, 0.0, 1.0)
    record(ROW_WORK, "broken line: strain energy given up", off(run.energy.events, -0.5 * EA * e * e * l0), 1e-3)


def test_lock_takes_the_motion(record):
    system = block(fs.Lock(name="latch", joint="rail", engage=(0.5,)))
    run = ledger_of(system, 1.0, 0.01, pushed(system, 2.0))
    record(ROW_WORK, "lock: energy lost by engaging", off(run.energy.events, -0.5 * 3.0 * 2.0**2), 1e-6)


# -- floaters ------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def db():
    from shipped import HYDRO

    return fs.HydroDatabase.read(HYDRO)


def heaving(db, *parts, waves=None, joints=None, **flow):
    from test_floater import floater

    sea = fs.Sea(depth=200.0, waves=waves, wave_ramp=50.0)
    joints = [fs.Slider(a="floater", b=(0, 0, 0), axis=(0, 0, 1), name="guide")] if joints is None else joints
    return fs.assemble(fs.Model(parts=[floater(db, **flow), *parts], joints=joints, sea=sea, gravity=G))


def only(i, value):
    out = np.zeros((6, 6))
    out[i, i] = value
    return out


def test_heave_decay_of_a_floater(db, record):
    """Radiation and quadratic damping take what the closed form of the stored energy loses."""
    B = 2.3e6
    system = heaving(db, quadratic_damping=only(2, B))
    state = system.initial_state()
    state.x[0, 2] += 2.0
    run = ledger_of(system, 60.0, 0.05, state)
    z, v = run.series("floater_position")[:, 2], run.series("floater_velocity")[:, 2]
    m, C = 1025.0 * db.volume[0] + db.added_mass_inf[2, 2], db.hydrostatic_stiffness[2, 2]
    E = 0.5 * m * v**2 + 0.5 * C * z**2
    drag = -np.trapezoid(B * np.abs(v) * v * v, run.time)
    record(ROW_WORK, "heave decay: drag", off(run.energy.work["drag"], drag), 1e-3)
    record(ROW_WORK, "heave decay: stored energy", off(run.energy.change, E[-1] - E[0]), 1e-3)
    record(ROW_WORK, "heave decay: radiation", off(run.energy.work["radiation"], E[-1] - E[0] - drag), 1e-2)
    record(ROW_CLOSE, "heave decay of a floater", run.energy.closure, 1e-3)


def test_floater_that_is_led(db, record):
    """A cycle of led heave radiates pi w B(w) X^2 and loses 8/3 B X^3 w^2 by quadratic damping; the joint brings it."""
    X, T, Bq = 1.5, 12.0, 2.3e6
    w = 2.0 * math.pi / T
    row = np.array([0, 0, X, 0, 0, 0])
    motion = fs.Motion(lambda t: row * math.sin(w * t), lambda t: row * w * math.cos(w * t),
                       lambda t: -row * w * w * math.sin(w * t))  # fmt: skip
    system = heaving(db, joints=[fs.Prescribed(a="floater", motion=motion)], quadratic_damping=only(2, Bq))
    run = ledger_of(system, 180.0, 0.1, system.initial_state())
    last = slice(len(run.time) - 1 - 600, len(run.time), 600)  # five cycles
    done = {name: float(np.diff(run.series(f"energy_{name}")[last])[0]) for name in ("radiation", "drag", "prescribed")}
    radiated, dragged = -5 * math.pi * w * db.at(w)[1][2, 2] * X**2, -5 * 8.0 / 3.0 * Bq * X**3 * w**2
    record(ROW_WORK, "led floater: radiation", off(done["radiation"], radiated), 5e-3)
    record(ROW_WORK, "led floater: drag", off(done["drag"], dragged), 1e-3)
    record(ROW_WORK, "led floater: prescribed motion", off(done["prescribed"], -radiated - dragged), 5e-3)


def test_floater_in_a_regular_wave(db, record):
    """Wave in = radiation + PTO a cycle, each against the frequency domain's."""
    c, a, j = 3e6, 1.0, int(np.argmin(np.abs(db.omega - 0.6)))
    w, head = float(db.omega[j]), int(np.argmin(np.abs(db.headings)))
    T = 2.0 * math.pi / w
    steps = 100
    waves = fs.RegularWave(height=2 * a, period=T)
    system = heaving(db, fs.PTO(name="pto", joint="guide", laws=[fs.Linear(damping=c)]), waves=waves)
    run = ledger_of(system, 40 * T, T / steps, system.initial_state())
    last = slice(len(run.time) - 1 - 10 * steps, len(run.time), 10 * steps)
    done = {name: float(np.diff(run.series(f"energy_{name}")[last])[0]) / 10 for name in ("wave", "radiation", "pto")}
    A, B = db.added_mass[j, 2, 2], db.radiation_damping[j, 2, 2]
    F = a * db.excitation[j, head, 2]
    X = F / (db.hydrostatic_stiffness[2, 2] - w * w * (1025.0 * db.volume[0] + A) + 1j * w * (B + c))
    exact = {"wave": 0.5 * (F * np.conj(1j * w * X)).real * T, "radiation": -0.5 * B * w * w * abs(X) ** 2 * T,
             "pto": -0.5 * c * w * w * abs(X) ** 2 * T}  # fmt: skip
    for name in done:
        gap = abs(done[name] - exact[name]) / exact["wave"]
        record(ROW_WORK, f"floater in a regular wave: {name}, of the wave's", gap, 1e-2)
    record(ROW_CLOSE, "floater in a regular wave: wave, radiation and PTO add up in a cycle",
           abs(sum(done.values())) / done["wave"], 1e-2)  # fmt: skip
    record(ROW_CLOSE, "floater in a regular wave", run.energy.closure, 1e-3)


# -- whole runs ----------------------------------------------------------------------------------------------------


def umbilical():
    from models.umbilical_rm3 import build

    return fs.assemble(build(waves="storm", wave_ramp=10.0, current=fs.Current(speed=0.4)))


def volturnus():
    from models.volturnus_s import build

    waves = fs.IrregularWaves(spectrum=fs.Jonswap(hs=4.0, tp=10.0), duration=200.0, seed=3)
    return fs.assemble(build(elements=25, waves=waves))


RUNS = {"umbilical in waves and current": (umbilical, 60.0, 0.1),
        "VolturnUS-S with moorings, irregular waves": (volturnus, 100.0, 0.1)}  # fmt: skip


@pytest.fixture(scope="module", params=RUNS)
def whole(request):
    """(name, system, run without the ledger, run with it)."""
    build, duration, dt = RUNS[request.param]
    system = build()
    plain = fs.simulate(system, duration, dt)
    run = fs.simulate(system, duration, dt, energy=True)
    assert run.status == "done", run.failure
    return request.param, system, plain, run


def test_ledger_of_a_whole_run_closes(whole, record):
    """At the run's usual tolerance; what the time steps dissipate is told beside."""
    name, _, _, run = whole
    print(run.energy.summary())
    record(ROW_CLOSE, f"{name}: error over the total positive work", run.energy.closure, 0.01)
    steps = abs(run.energy.integrator) / run.energy.scale
    record(ROW_CLOSE, f"{name}: what the time steps dissipate, likewise", steps, 0.05)


def test_ledger_looks_and_does_not_touch(whole):
    """With it and without, a run is the same to the last digit."""
    _, _, plain, run = whole
    assert np.array_equal(plain.state.x, run.state.x) and np.array_equal(plain.state.lam, run.state.lam)
    assert plain.newton_iterations == run.newton_iterations
    assert plain.energy is None and not [c.name for c in plain.sampler.channels if c.name.startswith("energy")]


def test_hull_decay_closes(record):
    """Nonlinear hydrostatics: a floating ellipsoid falls from 1 m; the drag of a disc takes the energy, all of it."""
    from hulls import ellipsoid

    a, b, c = 6.0, 5.0, 4.0
    mass = 0.5 * 1025.0 * 4.0 / 3.0 * math.pi * a * b * c
    loads = [fs.Hull(mesh=ellipsoid(a, b, c, 12)), fs.Disc(at=(0, 0, -3.9), diameter=6.0, drag=4.0)]
    body = fs.Body(name="hull", mass=mass, inertia=(0.2 * mass * 30,) * 3, position=(0, 0, 0),
                   center_of_mass=(0, 0, -1), hydro=loads)  # fmt: skip
    system = fs.assemble(fs.Model(parts=[body], sea=fs.Sea(depth=100.0), gravity=G))
    state, _ = fs.solve_static(system)
    state.x[0, 2] += 1.0
    run = ledger_of(system, 30.0, 0.02, state)
    record(ROW_CLOSE, "hull decay: error over the total positive work", run.energy.closure, 0.01)
    record(ROW_CLOSE, "hull decay: drag against stored energy", off(run.energy.work["drag"], run.energy.change), 1e-2)


def test_hull_stores_what_its_displacement_says(record):
    """- rho g int z dV of a box of draught d: rho g A d^2/2, upright and whole."""
    from hulls import box

    from floatsim.hydro.froude_krylov import HullBatch
    from floatsim.study.energy import Book

    mesh = fs.Hull(mesh=box(6, 4, 2, (3, 2, 3)))
    body = fs.Body(name="box", mass=1e5, inertia=(1e6, 1e6, 1e6), position=(0, 0, 0.3), hydro=mesh)
    system = fs.assemble(fs.Model(parts=[body], sea=fs.Sea(depth=100.0), gravity=G))
    w, state = system.work(), system.initial_state()
    system.load(w, state)
    system.begin(w, state, 0.0)
    book = Book()
    next(b for b in system.batches if isinstance(b, HullBatch)).ledger(w, book)
    exact = 0.5 * 1025 * G * 24 * 0.7**2
    record(ROW_WORK, "box: energy of its buoyancy", off(book.stored["hydrostatic"], exact), 1e-12)


def two_bodies_in_waves(radiation):
    """Two interacting bodies in heave against each other with a damper between them, soft moorings, RM3's database."""
    from pathlib import Path

    db = fs.HydroDatabase.read(Path(__file__).parents[2] / "models" / "rm3_hydro.nc")
    bodies, places = [], db.reference_point
    for k, name in enumerate(db.bodies):
        m, low = db.density * db.volume[k], db.centre_of_buoyancy[k, 2] - places[k, 2] - 1.0
        flow = fs.PotentialFlow(database=db, body=name, radiation=radiation, quadratic_damping=only(2, 2e5 * k))
        bodies.append(fs.Body(name=name, mass=m, inertia=(40 * m,) * 3, position=places[k], center_of_mass=(0, 0, low),
                              hydro=flow))  # fmt: skip
    pto = fs.PTO(name="pto", joint="slide", laws=[fs.Linear(damping=1.2e6)])
    lines = [fs.Spring(name=f"mooring_{k}", a=db.bodies[1], b=(*ends, places[1, 2]), stiffness=5e4, free_length=90.0)
             for k, ends in enumerate([(100, 0), (-50, 86.6), (-50, -86.6)])]  # fmt: skip
    sea = fs.Sea(depth=300.0, density=1000.0, waves=fs.RegularWave(height=2.5, period=8.0), wave_ramp=50.0)
    slide = fs.Slider(a=db.bodies[0], b=db.bodies[1], axis=(0, 0, 1), name="slide")
    return fs.assemble(fs.Model(parts=[*bodies, pto, *lines], joints=[slide], sea=sea))


@pytest.mark.parametrize("radiation", ["convolution", "state_space"])
def test_two_bodies_in_a_regular_wave(radiation, record):
    """H 2.5 m, T 8 s, damper 1.2e6 N s/m: the ledger closes, and in a cycle the waves bring what leaves."""
    run = ledger_of(two_bodies_in_waves(radiation), 240.0, 0.1)
    last = slice(len(run.time) - 1 - 400, len(run.time), 400)
    names = ("wave", "pto", "radiation", "drag")
    done = {name: float(np.diff(run.series(f"energy_{name}")[last])[0]) for name in names}
    record(ROW_CLOSE, f"two bodies in a regular wave, {radiation}", run.energy.closure, 0.01)
    left = abs(sum(done.values())) / done["wave"]
    record(ROW_CLOSE, f"two bodies in a regular wave, {radiation}: all that enters leaves in five cycles", left, 2e-3)


def test_hull_and_members_in_irregular_waves(record):
    """Nonlinear Froude-Krylov forces, Morison loads and a current together."""
    from hulls import ellipsoid

    mass = 0.5 * 1025.0 * 4.0 / 3.0 * math.pi * 6 * 5 * 4
    loads = [fs.Hull(mesh=ellipsoid(6.0, 5.0, 4.0, 8)), fs.Disc(at=(0, 0, -8), diameter=6.0, drag=4.0, added_mass=1.0),
             fs.Member(a=(0, 0, -8), b=(0, 0, -4), diameter=1.0, strips=6, drag_normal=1.0, added_mass_normal=1.0,
                       buoyancy=True)]  # fmt: skip
    body = fs.Body(name="hull", mass=mass, inertia=(6 * mass,) * 3, center_of_mass=(0, 0, -2), hydro=loads)
    spring = fs.Spring(name="mooring", a="hull", b=(-60, 0, 0), stiffness=2e4, free_length=55.0, damping=1e3)
    waves = fs.IrregularWaves(spectrum=fs.Jonswap(hs=1.5, tp=7.0), duration=100.0, seed=2)
    sea = fs.Sea(depth=100.0, waves=waves, wave_ramp=5.0, current=fs.Current(speed=0.5))
    run = fs.simulate(fs.Model(parts=[body, spring], sea=sea), 40.0, 0.05, energy=True)
    print(run.energy.summary())
    record(ROW_CLOSE, "hull and members in irregular waves", run.energy.closure, 0.01)
    steps = abs(run.energy.integrator) / run.energy.scale
    record(ROW_CLOSE, "hull and members in irregular waves: what the time steps dissipate, likewise", steps, 0.05)


def test_force_that_jumps(record):
    """A sampled brake: F = -c v held over T, v falls by 1 - c T/m each time; forces jump, energy does not."""
    m, c, T, v0 = 3.0, 2.0, 0.5, 2.0
    brake = fs.UserLaw(function=lambda t, s, v, y: (-c * v, y), sample_time=T)
    system = block(fs.PTO(name="pto", joint="rail", laws=[brake]), mass=m)
    run = fs.simulate(system, 2.0, 0.05, state=pushed(system, v0), energy=True)
    v = [v0, v0]  # the memory starts at rest: no force in the first interval
    for _ in range(3):
        v.append(v[-1] * (1.0 - c * T / m))
    exact = 0.5 * m * (v[-1] ** 2 - v0**2)
    record(ROW_WORK, "sampled brake: work of the PTO", off(run.energy.work["pto"], exact), 1e-3)
    record(ROW_CLOSE, "sampled brake", run.energy.closure, 1e-3)
    assert abs(run.energy.events) < 1e-6 * abs(exact)


# -- mutants -------------------------------------------------------------------------------------------------------


def forgetful(monkeypatch, *forgotten):
    """Let the book forget accounts and stores."""
    from floatsim.study.energy import Book

    store, work = Book.store, Book.work
    monkeypatch.setattr(Book, "store", lambda self, name, E, R: store(self, name, E, R * (name not in forgotten)))
    monkeypatch.setattr(Book, "work", lambda self, name, P: work(self, name, P * (name not in forgotten)))


OF_A_LINE = ["wave", "current", "drag", "added_mass", "prescribed", "kinetic", "gravity", "hydrostatic"]


@pytest.mark.parametrize("account", OF_A_LINE)
def test_a_forgotten_account_of_the_umbilical_shows(account, monkeypatch):
    forgetful(monkeypatch, account)
    run = fs.simulate(umbilical(), 20.0, 0.1, energy=True)
    assert not run.energy.closes and "DOES NOT CLOSE" in run.energy.verdict


@pytest.mark.parametrize("account", ["wave", "radiation", "drag", "kinetic", "hydrostatic", "gravity"])
def test_a_forgotten_account_of_the_floater_shows(account, monkeypatch):
    forgetful(monkeypatch, account)
    run = fs.simulate(volturnus(), 40.0, 0.1, energy=True)
    assert not run.energy.closes


SMALL = {
    "friction": (lambda: block(fs.PTO(name="brake", joint="rail", laws=[fs.Coulomb(friction=6.0, speed=0.005)])), 0.5),
    "pto": (lambda: block(damper(300.0, 12.0, 0.5)), 0.5),
    "spring": (lambda: block(damper(300.0, 12.0, 0.5)), 0.5),
    "contact": (sinker, 1.0), "seabed": (sinker, 0.5),
    "structural": (stretched, 0.5), "axial": (stretched, 0.13), "bending": (bent, 0.4),
}  # fmt: skip


@pytest.mark.parametrize("account", SMALL)
def test_any_forgotten_account_shows(account, monkeypatch):
    """The same run closes with it."""
    build, duration = SMALL[account]
    system = build()
    state = pushed(system, 2.0) if account == "friction" else system.initial_state()
    whole = fs.simulate(system, duration, 2e-3, state=state, energy=True)
    assert whole.energy.closes, whole.energy.summary()
    forgetful(monkeypatch, account)
    assert not fs.simulate(system, duration, 2e-3, state=state, energy=True).energy.closes


def test_rod_that_bends_under_its_weight(record):
    """Let go straight: its weight gives w^2 L^5/(20 EI), half of it is bent in, half goes to the bending damper."""
    w, L, EI = 5.0 * G, 4.0, 2e5
    run = ledger_of(bent(EI=EI, bending_damping=1e3), 4.0, 2e-3, bent(EI=EI, bending_damping=1e3).initial_state())
    half = w * w * L**5 / (40.0 * EI)
    record(ROW_WORK, "rod under its weight: structural damping", off(run.energy.work["structural"], -half), 2e-2)
    record(ROW_WORK, "rod under its weight: bent in", off(run.energy.stored["bending"][1], half), 1e-2)


def test_a_wrong_stored_energy_shows(monkeypatch, record):
    """An energy that does not belong to its force is no closure error: it shows in what the time steps 'dissipate'."""
    from floatsim.study.energy import Book

    store = Book.store
    shares = []
    for wrong in (1.0, 1.05):

        def put(self, name, E, R, wrong=wrong):
            store(self, name, E * wrong if name == "kinetic" else E, R)

        monkeypatch.setattr(Book, "store", put)
        system = block(damper(300.0, 12.0, 0.5))
        shares.append([])
        for dt in (0.02, 0.01):
            energy = fs.simulate(system, 0.22, dt, state=system.initial_state(), energy=True).energy
            shares[-1].append(abs(energy.integrator) / energy.scale)
    record(ROW_CLOSE, "time steps' share at half the step: right energies", shares[0][1] / shares[0][0], 0.35)
    record(ROW_CLOSE, "time steps' share at half the step: wrong energies", shares[1][1] / shares[1][0], (0.6, 1.6))


# -- files and messages --------------------------------------------------------------------------------------------


def test_channels_and_attributes(tmp_path):
    """The file holds every account over time, and says how the ledger closes; accounts add up."""
    import xarray

    system = block(damper(300.0, 12.0, 0.5))
    path = tmp_path / "run.nc"
    run = fs.simulate(system, 1.0, 0.01, state=system.initial_state(), energy=True, output=path)
    with xarray.open_dataset(path) as file:
        assert "closes within 1 %" in file.attrs["energy_ledger"]
        assert file.attrs["energy_closure_error"] == run.energy.closure
        assert file.energy_pto.attrs["units"] == "J"
        stored = file.energy_stored_kinetic + file.energy_stored_gravity + file.energy_stored_spring
        assert np.allclose(file.energy_stored, stored)
        change = file.energy_stored - file.energy_stored[0]
        names = ("pto", "prescribed", "events", "integrator", "error")
        parts = sum(file[f"energy_{name}"] for name in names)
        assert np.allclose(change, parts, atol=1e-9 * float(file.energy_stored[0]))
        # the PTO's own account holds what its spring took, by the trapezoidal rule
        assert np.allclose(-file.energy_pto, file.pto_energy + 37.5 - file.energy_stored_spring, atol=0.1)
    text = run.energy.summary()
    assert "work: pto" in text and "sum of all stores" in text and "closes" in text


def test_part_that_does_not_tell_is_named(monkeypatch):
    system = block()
    monkeypatch.delattr(BodyBatch, "ledger")
    with pytest.raises(fs.CaseError, match="energy: 'block': these parts do not tell their energies"):
        fs.simulate(system, 1.0, 0.1, energy=True)
    assert fs.simulate(system, 1.0, 0.1).status == "done"


def test_energy_is_true_or_false():
    with pytest.raises(fs.CaseError, match="energy: got 'yes'; must be True or False"):
        fs.simulate(block(), 1.0, 0.1, energy="yes")


def test_run_at_rest_closes():
    """Nothing moves: only rounding is left."""
    mass = fs.PointMass(name="bob", mass=3.0, position=(0, 0, 8))
    spring = fs.Spring(name="s", a="bob", b=(0, 0, 10), stiffness=1e3, free_length=1.5)
    run = fs.simulate(fs.Model(parts=[mass, spring], sea=DRY), 1.0, 0.1, energy=True)
    assert run.energy.closes


def test_restart_opens_a_new_ledger():
    system = block(damper(300.0, 12.0, 0.5))
    first = fs.simulate(system, 0.5, 0.01, state=system.initial_state(), energy=True)
    second = fs.simulate(system, 0.5, 0.01, state=first.state, energy=True)
    both = fs.simulate(system, 1.0, 0.01, state=system.initial_state(), energy=True)
    for name in ("pto", "prescribed"):
        total = first.energy.work[name] + second.energy.work[name]
        assert total == pytest.approx(both.energy.work[name], rel=1e-9, abs=1e-9)
    assert second.energy.closes
