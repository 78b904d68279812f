"""The cantilever of models/cantilever.py: elements that bending needs, vibration, settling.

Statics with 5 to 40 elements and their order stand in test_statics.py; here beams are cut by elements per metre, as in
Fig. 3 of Verelst et al. (2024).
"""

from __future__ import annotations

import numpy as np
import pytest
from closed_forms import elastica
from mechanics import observed_order
from scipy.integrate import solve_bvp
from scipy.optimize import brentq
from scipy.special import ellipeinc, ellipkinc
from shipped import load

import floatsim as fs
from floatsim.study.channels import Sampler

cantilever = load("cantilever")
EI, G = cantilever.EI, cantilever.GRAVITY
LOADS = [(10.0, 1000.0), (10.0, 2000.0), (20.0, 1000.0), (20.0, 2000.0), (20.0, 4000.0)]
# allowed error of the drop at so many elements per metre [%]; that of 10 is that of 1, divided by 10^2
BARS = {1.0: 0.6, 4.0: 0.04, 10.0: 0.006}


def elliptic_elastica(length, mass):
    """(drop, x of the tip, root curvature) by incomplete elliptic integrals (Bisshopp & Drucker 1945).

    With alpha^2 = P/EI, k^2 = (1 + sin phi_tip)/2 and sin(b) = 1/(k sqrt 2): alpha L = K(k) - F(b, k),
    drop = L - 2 (E(k) - E(b, k))/alpha, x_tip = sqrt(2 sin(phi_tip))/alpha, curvature at the root alpha^2 x_tip.
    """
    alpha = np.sqrt(mass * G / EI)

    def parts(sine):
        k2 = 0.5 * (1.0 + sine)
        b = np.arcsin(1.0 / np.sqrt(2.0 * k2))
        return k2, b

    def too_long(sine):
        k2, b = parts(sine)
        return ellipkinc(0.5 * np.pi, k2) - ellipkinc(b, k2) - alpha * length

    sine = brentq(too_long, 1e-9, 1.0 - 1e-12, xtol=1e-15)
    k2, b = parts(sine)
    drop = length - 2.0 * (ellipeinc(0.5 * np.pi, k2) - ellipeinc(b, k2)) / alpha
    x_tip = np.sqrt(2.0 * sine) / alpha
    return drop, x_tip, alpha**2 * x_tip


def static_tip(**parameters):
    """(drop, x of the tip, moment at the root) of the model."""
    model = cantilever.build(**parameters)
    system = fs.assemble(model)
    state, _ = fs.solve_static(system)
    sampler = Sampler(system, ["beam_position", "beam_bending_moment"])
    row = sampler.sample_state(state)[None]
    x = sampler.column(row, "beam_position")[0, -1]
    return cantilever.HEIGHT - x[2], x[0], sampler.column(row, "beam_bending_moment")[0, 0]


@pytest.mark.parametrize(("length", "mass"), LOADS)
def test_elements_per_metre(length, mass, record):
    """Drop of the tip and moment at the root against the elastica with 1, 4 and 10 elements per metre."""
    drop, x_tip, curvature = elliptic_elastica(length, mass)
    assert elastica(EI, length, mass * G) == pytest.approx((drop, x_tip, curvature), rel=1e-7)
    check, case = "elastica, elements per metre", f"{mass:g} kg at {length:g} m"
    errors = []
    for density, bar in BARS.items():
        z, x, moment = static_tip(length=length, tip_mass=mass, elements_per_metre=density)
        errors.append(abs(z / drop - 1.0))
        record(check, f"{case}, {density:g} per metre: drop", 100.0 * errors[-1], bar, "%")
        record(check, f"{case}, {density:g} per metre: moment at the root",
               100.0 * abs(moment / (EI * curvature) - 1.0), 0.5, "%")  # fmt: skip
        assert abs(x / x_tip - 1.0) < 0.01 * bar
    record(check, f"{case}: order, 1 to 4 per metre", observed_order(errors[:2], 4.0), (1.9, 2.1))


# --- vibration ---------------------------------------------------------------------------------------------------

# k L of a clamped-free beam: 1 + cos cosh = 0. At 10 m, 100 kg/m: (k L)^2/(2 pi) sqrt(EI/(m L^4)) = 0.7914, 4.9594 Hz
WAVE_NUMBERS = (1.8751040687, 4.6940911330)


def own_frequency(n):
    return WAVE_NUMBERS[n] ** 2 / (2.0 * np.pi) * np.sqrt(EI / (100.0 * 10.0**4))


def swing(mode, elements=20, periods=8, amplitude=0.05):
    """Frequency [Hz] of the tip after a release in the shape of a mode, from its upward zero crossings."""
    model = cantilever.build(tip_mass=0.0, mass_per_length=100.0, gravity=0.0, elements=elements)
    system = fs.assemble(model)
    state = system.initial_state()
    b = WAVE_NUMBERS[mode]
    y = b * model.parts[0].arc_length / 10.0
    share = (np.cosh(b) + np.cos(b)) / (np.sinh(b) + np.sin(b))
    shape = np.cosh(y) - np.cos(y) - share * (np.sinh(y) - np.sin(y))
    lift = amplitude * shape / abs(shape[-1])
    slope = np.diff(lift) / np.diff(model.parts[0].arc_length)
    state.x[: elements + 1, 2] += lift
    state.x[1 : elements + 1, 0] = np.cumsum(0.5 * np.sqrt(1.0 - slope**2))  # inextensible
    system.forget(state)
    T = 1.0 / own_frequency(mode)
    run = fs.simulate(system, (periods + 0.5) * T, T / 100.0, state=state, scheme=fs.generalised_alpha(0.9),
                      step_control=False, channels=["beam_position"])  # fmt: skip
    assert run.status == "done", run.failure
    z = run.series("beam_position")[:, -1, 2] - cantilever.HEIGHT
    up = np.flatnonzero((z[:-1] < 0.0) & (z[1:] >= 0.0))
    crossings = run.time[up] - z[up] * (run.time[up + 1] - run.time[up]) / (z[up + 1] - z[up])
    return (len(crossings) - 1) / (crossings[-1] - crossings[0])


def test_vibration(record):
    """In vacuum, 20 elements, tip amplitude 0.5 % of the length (second mode: 0.1 %)."""
    check = "clamped beam swinging in vacuum, 20 elements"
    assert own_frequency(0) == pytest.approx(0.7914, abs=5e-5)
    record(check, "first mode: frequency", swing(0), (0.7914 * 0.997, 0.7914 * 1.003), "Hz")
    exact = own_frequency(1)
    record(check, "second mode: frequency", swing(1, amplitude=0.01), (exact * 0.985, exact * 1.015), "Hz")


def test_natural_modes(record):
    """The same by the eigenvalues; second order in the element length."""
    errors = []
    for elements in (10, 20, 40):
        model = cantilever.build(tip_mass=0.0, mass_per_length=100.0, gravity=0.0, elements=elements)
        system = fs.assemble(model)
        modes = fs.natural_modes(system, system.initial_state(), 4)
        found = [1.0 / modes[0].period, 1.0 / modes[2].period]  # each comes twice, in y and in z
        errors.append([abs(f / own_frequency(n) - 1.0) for n, f in enumerate(found)])
    check = "clamped beam swinging in vacuum, 20 elements"
    record(check, "first mode by eigenvalues", 100.0 * errors[1][0], 0.3, "%")
    record(check, "second mode by eigenvalues", 100.0 * errors[1][1], 1.5, "%")
    for n, name in enumerate(("first", "second")):
        order = observed_order([e[n] for e in errors])
        record(check, f"{name} mode: order, 20 to 40 elements", order, (1.9, 2.1))


# --- settling ----------------------------------------------------------------------------------------------------


def heavy_elastica(length, load, weight):
    """Drop of an inextensible clamped beam under a tip load [N] and its own weight [N/m]:
    EI phi'' = -(load + weight (L - s)) cos(phi)."""
    P, w = load * length**2 / EI, weight * length**3 / EI
    s = np.linspace(0.0, 1.0, 101)
    sol = solve_bvp(lambda s, y: np.array([y[1], -(P + w * (1.0 - s)) * np.cos(y[0]), np.sin(y[0])]),
                    lambda a, b: np.array([a[0], b[1], a[2]]), s, np.zeros((3, 101)), tol=1e-10,
                    max_nodes=100000)  # fmt: skip
    assert sol.success
    return length * sol.sol(1.0)[2]


def test_settling(record):
    """Let go undeflected with 1 t at its tip (MoorDyn paper, Fig. 6): every beam comes to rest in its own static shape,
    and these approach the elastica with second order."""
    exact = heavy_elastica(10.0, 1000.0 * G, cantilever.SETTLING_MASS * G)
    assert heavy_elastica(10.0, 1000.0 * G, 0.0) == pytest.approx(elliptic_elastica(10.0, 1000.0)[0], rel=1e-7)
    check = "settling of an undeflected cantilever"
    errors = []
    for elements in (2, 4, 6, 8):
        run = cantilever.settling(elements)
        assert run.status == "done", run.failure
        drop = cantilever.HEIGHT - run.series("tip_position")[-1, 2]
        rest = static_tip(elements=elements, mass_per_length=cantilever.SETTLING_MASS)[0]
        record(check, f"{elements} elements: drop after 20 s against statics", abs(drop - rest), 1e-4, "m")
        errors.append(abs(drop / exact - 1.0))
    # a clamped end and a pair of halves: e = c/N^2, so that N^2 e is the same for all
    record(check, "8 elements: drop against the elastica", 100.0 * errors[3], 0.9, "%")
    record(check, "order, 2 to 4 elements", np.log2(errors[0] / errors[1]), (1.9, 2.1))
    record(check, "order, 4 to 8 elements", np.log2(errors[1] / errors[3]), (1.9, 2.1))


def test_two_halves_clamped_to_a_connector(record):
    """A beam in two halves that are clamped to a massless body in the middle bends like one beam."""
    sec = fs.Section(name="beam", mass_per_length=1e-3, diameter=1e-3, EA=1e10, EI=2e6)
    halves = [fs.Line(name="inner", section=sec, length=5.0, elements=10, end_a_position=(0.0, 0.0, 50.0)),
              fs.Line(name="outer", section=sec, length=5.0, elements=10)]  # fmt: skip
    middle = fs.Body(name="middle", mass=1e-3, inertia=(1e-3, 1e-3, 1e-3), position=(5.0, 0.0, 50.0),
                     points={"in": (0.0, 0.0, 0.0), "out": (0.0, 0.0, 0.0)})  # fmt: skip
    tip = fs.PointMass(name="tip", mass=1000.0, position=(10.0, 0.0, 50.0))
    joints = [
        fs.Clamp(a="inner.end_a", b=(0.0, 0.0, 50.0), direction=(1.0, 0.0, 0.0)),
        fs.Clamp(a="inner.end_b", b="middle.in", direction=(-1.0, 0.0, 0.0)),
        fs.Clamp(a="outer.end_a", b="middle.out", direction=(1.0, 0.0, 0.0)),
        fs.Ball(a="outer.end_b", b="tip"),
    ]
    model = fs.Model(parts=[*halves, middle, tip], joints=joints, sea=fs.Sea(depth=10.0), gravity=G)
    system = fs.assemble(model)
    state, _ = fs.solve_static(system)
    x, _, z = state.x[system.numbering.first_point[system.numbering.index("tip")]]
    error = max(abs((50.0 - z) / 1.591703 - 1.0), abs(x / 9.846647 - 1.0))
    record("elastica, clamped", "1000 kg at 10 m, two halves of 10 elements clamped to a body", 100.0 * error, 0.6, "%")
