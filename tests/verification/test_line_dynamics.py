"""Strings, chains and lines in water against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from mechanics import DRY, end_force, natural_frequencies, residual, run
from scipy.special import jn_zeros

import floatsim as fs

RHO, G = 1025.0, 9.81
D = 0.2
AREA = 0.25 * np.pi * D**2
WET = fs.Sea(depth=500.0, density=RHO)


def free_line(z, elements=4, sea=WET, direction=(1.0, 0.0, 0.0), gravity=G, **more):
    """A line of 8 m that nothing holds, its middle at z."""
    sec = fs.Section(name="line", **(dict(mass_per_length=60.0, diameter=D, EA=1e6) | more))
    e = 4.0 * np.array(direction) / np.linalg.norm(direction)
    line = fs.Line(name="line", section=sec, length=8.0, elements=elements,
                   end_a_position=tuple(-e + (0, 0, z)), end_b_position=tuple(e + (0, 0, z)), taut=True)  # fmt: skip
    return fs.assemble(fs.Model(parts=[line], sea=sea, gravity=gravity))


def accelerations(system, state=None):
    state = system.initial_state() if state is None else state
    fs.Stepper(system).start(state, 0.01)
    return state.a[: 3 * system.n_point].reshape(-1, 3)


# --- frequencies -------------------------------------------------------------------------------------------------


def test_taut_string(record):
    """f_n = n/(2 L) sqrt(T/m), T and m per stretched length; each frequency twice, in y and in z."""
    L, n = 50.0, 100
    sec = fs.Section(name="string", mass_per_length=2.0, diameter=0.01, EA=1e7)
    line = fs.Line(name="string", section=sec, length=L / 1.01, elements=n, taut=True)
    ends = [fs.Ball(a="string.end_a", b=(0, 0, 20), name="a"), fs.Ball(a="string.end_b", b=(L, 0, 20), name="b")]
    system = fs.assemble(fs.Model(parts=[line], joints=ends, sea=DRY, gravity=0.0))
    state, _ = fs.solve_static(system)
    tension = end_force(system, state, "a")[0]
    strain = 0.5 * (1.01**2 - 1.0)
    record("strings and chains", "taut string: tension EA eps l/l0", abs(tension / (1e7 * strain * 1.01) - 1.0), 1e-9)
    f = natural_frequencies(system, state) / (2.0 * np.pi)
    for k in (1, 2, 3):
        exact = 0.5 * k / L * np.sqrt(tension / (2.0 / 1.01))
        error = np.abs(f[2 * k - 2 : 2 * k] / exact - 1.0).max()
        record("strings and chains", f"taut string, mode {k}, 100 elements", 100.0 * error, 0.1, "%")


def test_hanging_chain(record):
    """omega_n = j_0n/2 sqrt(g/L), Bernoulli 1732; two hundred elements."""
    L = 30.0
    sec = fs.Section(name="chain", mass_per_length=40.0, diameter=0.05, EA=1e10)
    line = fs.Line(name="chain", section=sec, length=L, elements=200, end_b_position=(0.5, 0, 70.01))
    system = fs.assemble(fs.Model(parts=[line], joints=[fs.Ball(a="chain.end_a", b=(0, 0, 100))], sea=DRY, gravity=G))
    state, _ = fs.solve_static(system)
    omega = natural_frequencies(system, state)
    for k, zero in enumerate(jn_zeros(0, 4)):
        error = np.abs(omega[2 * k : 2 * k + 2] / (0.5 * zero * np.sqrt(G / L)) - 1.0).max()
        record("strings and chains", f"hanging chain, mode {k + 1}, 200 elements", 100.0 * error, 0.1, "%")


@pytest.mark.parametrize("ends", ["clamped", "hinged"])
def test_beam_under_tension(ends, record):
    """Hinged: omega_n^2 = (n pi/L)^2 (T + EI (n pi/L)^2)/m. Clamped: root of the beam-string's own equation."""
    from scipy.optimize import brentq

    L, m, EI, T = 20.0, 30.0, 4e5, 2e4
    sec = fs.Section(name="beam", mass_per_length=m, diameter=0.1, EA=2e9, EI=EI)
    line = fs.Line(name="beam", section=sec, length=L / (1.0 + T / 2e9), elements=160, taut=True)
    a, b = (0, 0, 20), (L, 0, 20)
    if ends == "clamped":
        joints = [
            fs.Clamp(a="beam.end_a", b=a, direction=(1, 0, 0)),
            fs.Clamp(a="beam.end_b", b=b, direction=(-1, 0, 0)),
        ]
    else:
        joints = [fs.Ball(a="beam.end_a", b=a), fs.Ball(a="beam.end_b", b=b)]
    system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=DRY, gravity=0.0))
    state, _ = fs.solve_static(system)
    omega = natural_frequencies(system, state)[0:6:2]

    def characteristic(w):  # clamped-clamped: 2 (1 - cos b cosh a) + (a/b - b/a) sin b sinh a = 0, over cosh a
        root = np.sqrt((T / (2 * EI)) ** 2 + m * w**2 / EI)
        p, q = L * np.sqrt(root + T / (2 * EI)), L * np.sqrt(root - T / (2 * EI))
        return 2 * (1 / np.cosh(p) - np.cos(q)) + (p / q - q / p) * np.sin(q) * np.tanh(p)

    if ends == "hinged":
        k = np.pi * np.arange(1, 4) / L
        exact = np.sqrt(k**2 * (T + EI * k**2) / m)
    else:
        grid = np.linspace(1.0, 60.0, 4000)
        f = np.array([characteristic(w) for w in grid])
        at = np.flatnonzero(f[:-1] * f[1:] < 0.0)[:3]
        exact = np.array([brentq(characteristic, grid[i], grid[i + 1]) for i in at])
    for k in range(3):
        record("strings and chains", f"{ends} beam under tension, mode {k + 1}, 160 elements",
               100.0 * abs(omega[k] / exact[k] - 1.0), 0.2, "%")  # fmt: skip


# --- water -------------------------------------------------------------------------------------------------------


def test_free_fall(record):
    """In air a line falls like a stone, without tension."""
    system = free_line(50.0, sea=DRY)
    state = system.initial_state()
    run(system, state, fs.generalised_alpha(0.6), 0.05, 20)
    record(
        "lines in water and air",
        "free fall for 1 s: error of the height",
        np.abs(state.x[:5, 2] - 50.0 + 0.5 * G).max(),
        1e-9,
        "m",
    )


@pytest.mark.parametrize("angle", [0.0, 90.0, 35.0])
def test_released_line(angle, record):
    """At the first moment: (m + rho A Ca) a = (m - rho A) g along and across the line."""
    t = np.array([np.cos(np.radians(angle)), 0.0, -np.sin(np.radians(angle))])
    system = free_line(-50.0, direction=t, added_mass_normal=1.1, added_mass_tangential=0.15)
    f = (60.0 - RHO * AREA) * np.array([0.0, 0.0, -G])
    ft = (f @ t) * t
    exact = ft / (60.0 + 0.15 * RHO * AREA) + (f - ft) / (60.0 + 1.1 * RHO * AREA)
    error = np.abs(accelerations(system) - exact).max() / G
    record("lines in water and air", f"released line at {angle:g} deg: acceleration over g", error, 1e-12)


@pytest.mark.parametrize("case", ["across", "along"])
def test_terminal_velocity(case, record):
    """(m - rho A) g = 0.5 rho d Cd v^2 across, 0.5 rho pi d Cd v^2 along the line."""
    direction = (1.0, 0.0, 0.0) if case == "across" else (0.0, 0.0, 1.0)
    system = free_line(-50.0, direction=direction, drag_normal=1.2, drag_tangential=0.1, added_mass_normal=1.0)
    state = system.initial_state()
    run(system, state, fs.generalised_alpha(0.6), 0.2, 100)
    c = 0.5 * RHO * D * 1.2 if case == "across" else 0.5 * RHO * np.pi * D * 0.1
    exact = np.sqrt((60.0 - RHO * AREA) * G / c)
    error = np.abs(-state.v[2:15:3] / exact - 1.0).max()
    record("lines in water and air", f"terminal velocity {case} the line", error, 1e-6)


def test_start_of_the_fall(record):
    """v = v_oo tanh(g' t/v_oo) across the line, with g' = (m - rho A) g/(m + rho A Ca): second order."""
    errors = []
    for n in (50, 100):
        system = free_line(-50.0, drag_normal=1.2, added_mass_normal=1.0)
        state = system.initial_state()
        run(system, state, fs.generalised_alpha(0.6), 1.0 / n, n)
        end = np.sqrt((60.0 - RHO * AREA) * G / (0.5 * RHO * D * 1.2))
        rate = (60.0 - RHO * AREA) * G / (60.0 + RHO * AREA)
        errors.append(abs(-state.v[2] - end * np.tanh(rate / end)) / end)
    record("lines in water and air", "fall in water for 1 s, dt 0.01 s: error of the velocity", errors[1], 1e-4)
    assert errors[0] / errors[1] > 3.5


def test_oblique_current(record):
    """Force on a held line: normal and tangential drag of the current's components, each quadratic in its own."""
    sea = fs.Sea(depth=500.0, density=RHO, current=fs.Current(speed=1.3, heading_deg=40.0))
    t = np.array([2.0, -1.0, 0.5]) / np.linalg.norm([2.0, -1.0, 0.5])
    system = free_line(-50.0, sea=sea, direction=t, drag_normal=1.2, drag_tangential=0.1, gravity=0.0)
    w = system.work()
    system.load(w, system.initial_state())
    u = 1.3 * np.array([np.cos(np.radians(40.0)), np.sin(np.radians(40.0)), 0.0])
    ut = (u @ t) * t
    un = u - ut
    exact = 8.0 * (
        0.5 * RHO * D * 1.2 * np.linalg.norm(un) * un + 0.5 * RHO * np.pi * D * 0.1 * np.linalg.norm(ut) * ut
    )
    total = -residual(system, w)[:15].reshape(5, 3).sum(axis=0)
    record(
        "lines in water and air", "drag of an oblique current", np.abs(total - exact).max() / np.abs(exact).max(), 1e-12
    )


@pytest.mark.parametrize("elements", [1, 3, 8])
@pytest.mark.parametrize("angle", [90.0, 40.0, 0.0])
def test_buoyancy_of_a_half_wet_line(elements, angle, record):
    """Total vertical force: weight less rho g A times the wet length, whatever the elements."""
    t = (np.cos(np.radians(angle)), 0.0, np.sin(np.radians(angle)))
    middle = 0.7 if angle > 0.0 else 0.03
    system = free_line(middle, elements=elements, direction=t)
    w = system.work()
    system.load(w, system.initial_state())
    # length below the surface; the section's linear ramp over its diameter leaves it as it is
    wet = 4.0 - middle / np.sin(np.radians(angle)) if angle > 0.0 else 8.0 * (0.5 - middle / D)
    exact = 60.0 * 8.0 * G - RHO * G * AREA * wet
    force = residual(system, w)[2 : 3 * system.n_point : 3].sum()
    record("lines in water and air", f"half-wet line at {angle:g} deg, {elements} elements: vertical force",
           abs(force / exact - 1.0), 1e-12)  # fmt: skip


def test_line_resting_on_the_bed(record):
    """A line lying on the bed sinks in by its wet weight over stiffness times diameter, and carries no tension."""
    bed = fs.Seabed(stiffness=1e5, damping=1e4)
    system = free_line(-500.0, sea=fs.Sea(depth=500.0, density=RHO, seabed=bed))
    state = system.initial_state()
    run(system, state, fs.generalised_alpha(0.6), 0.05, 400)
    exact = (60.0 - RHO * AREA) * G / (1e5 * D)
    record(
        "lines in water and air",
        "penetration of a resting line",
        np.abs((-500.0 - state.x[:5, 2]) / exact - 1.0).max(),
        1e-6,
    )


def test_rigid_damping_does_not_brake(record):
    """A line in rigid rotation feels no axial and no bending damping."""
    system = free_line(50.0, sea=DRY, gravity=0.0, EI=1e3, bending_damping=1e5, axial_damping=1e5)
    w = system.work()
    system.load(w, system.initial_state())
    w.x[1:4] += np.random.default_rng(1).uniform(-0.3, 0.3, (3, 3))
    still = residual(system, w)
    w.v[:15] = np.cross((0.3, -0.7, 0.5), w.x[:5]).ravel()
    error = np.abs(residual(system, w) - still).max() / np.abs(still).max()
    record("invariance", "damping of a line in rigid rotation", error, 1e-10)


def test_axial_damping_ratio(record):
    """A ratio of 1 is critical for the element as MoorDyn defines it: c = l0 sqrt(EA m), a free element of two
    half masses does not swing: m l0/4 x'' + c/l0 x' + EA/l0 x = 0 has zeta = c/(l0 sqrt(EA m))."""
    system = free_line(50.0, elements=1, sea=DRY, gravity=0.0, axial_damping_ratio=0.3)
    state = system.initial_state()
    state.x[1, 0] += 1e-4
    w0 = 2.0 / 8.0 * np.sqrt(1e6 / 60.0)  # both halves move: reduced mass m l0/4
    zeta = 0.3
    period = 2.0 * np.pi / (w0 * np.sqrt(1.0 - zeta**2))
    seen = np.array(
        run(system, state, fs.generalised_alpha(0.9), period / 400, 400, lambda s: s.x[1, 0] - s.x[0, 0] - 8.0)
    )
    decay = -np.log(seen[-1] / seen[0]) / (w0 * period)
    record("strings and chains", "axial damping ratio 0.3 of one element, from its decay", decay, (0.299, 0.301))


def test_bending_damping_at_a_clamp(record):
    """A mass on one clamped element: zeta = (c/EI) omega/2, omega^2 = 2 EI/(l0 m l^2), from the decay at 0.05 rad."""
    EI, l0, m = 1e4, 2.0, 10.0
    omega = np.sqrt(2.0 * EI / l0 / (m * l0**2))
    zeta = 0.02
    rod = fs.Section(
        name="rod", mass_per_length=1e-6, diameter=1e-3, EA=1e9, EI=EI, bending_damping=2.0 * zeta / omega * EI
    )
    start = (l0 * np.cos(0.05), 0.0, 10.0 + l0 * np.sin(0.05))
    line = fs.Line(name="rod", section=rod, length=l0, elements=1, taut=True)
    bob = fs.PointMass(name="bob", mass=m, position=start)
    joints = [fs.Clamp(a="rod.end_a", b=(0, 0, 10), direction=(1, 0, 0)), fs.Ball(a="rod.end_b", b="bob")]
    system = fs.assemble(fs.Model(parts=[line, bob], joints=joints, sea=DRY, gravity=0.0))
    period = 2.0 * np.pi / (omega * np.sqrt(1.0 - zeta**2))
    state, scheme = system.initial_state(), fs.generalised_alpha(0.9)
    seen = run(system, state, scheme, period / 400, 2000, lambda s: s.x[1, 2] - 10.0, tolerance=1e-8)
    decay = -np.log(seen[2000] / seen[0]) / (5.0 * omega * period)
    record("strings and chains", "bending damping of 2 % at a clamp, from the decay", decay, (0.0198, 0.0202))
