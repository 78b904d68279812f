"""Static shapes and forces of lines: elastica, elastic catenary, the VolturnUS-S chain."""

from __future__ import annotations

import numpy as np
import pytest
from closed_forms import elastic_catenary, elastica
from mechanics import end_force, observed_order

import floatsim as fs

RHO, G = 1025.0, 9.81
EI = 2e6  # N m2


# --- elastica --------------------------------------------------------------------------------------------------


def cantilever(elements, mass, length=10.0):
    """Weightless clamped beam with a tip mass: tip (x, z) relative to the root and the root's curvature."""
    beam = fs.Section(name="beam", mass_per_length=1e-6, diameter=1e-3, EA=1e10, EI=EI)
    line = fs.Line(name="beam", section=beam, length=length, elements=elements)
    tip = fs.PointMass(name="tip", mass=mass, position=(length, 0.0, 100.0))
    joints = [
        fs.Clamp(a="beam.end_a", b=(0.0, 0.0, 100.0), direction=(1, 0, 0), name="root"),
        fs.Ball(a="beam.end_b", b="tip"),
    ]
    system = fs.assemble(fs.Model(parts=[line, tip], joints=joints, sea=fs.Sea(depth=50.0), gravity=9.80665))
    state, _ = fs.solve_static(system)
    x = state.x[elements]
    # moment at the clamp: the joint's vertical force times the lever
    curvature = abs(end_force(system, state, "root")[2]) * x[0] / EI
    return x[0], 100.0 - x[2], curvature


# drop, x of the tip [m], curvature at the root [1/m] for EI 2e6 N m2, L 10 m, g 9.80665: elliptic integrals
ELASTICA = {1000.0: (1.591703, 9.846647, 0.0482813), 2000.0: (2.968854, 9.454203, 0.0927141)}


@pytest.mark.parametrize("mass", ELASTICA)
def test_elastica(mass, record):
    drop, x_tip, curvature = ELASTICA[mass]
    own = elastica(EI, 10.0, mass * 9.80665)
    assert own == pytest.approx((drop, x_tip, curvature), rel=1e-6)
    drops = {n: cantilever(n, mass) for n in (5, 10, 20, 40)}
    errors = [abs(drops[n][1] - drop) / drop for n in drops]
    name = f"{mass:g} kg at 10 m"
    record("elastica, clamped", f"{name}: drop, 10 elements", 100.0 * errors[1], 0.6, "%")
    record("elastica, clamped", f"{name}: x of the tip, 10 elements", 100.0 * abs(drops[10][0] / x_tip - 1.0), 0.6, "%")
    record(
        "elastica, clamped",
        f"{name}: root curvature, 10 elements",
        100.0 * abs(drops[10][2] / curvature - 1.0),
        0.6,
        "%",
    )
    for k, n in enumerate((10, 20, 40)):
        record(
            "elastica, clamped", f"{name}: order, {n // 2} to {n} elements", observed_order(errors[: k + 2]), (1.9, 2.1)
        )


@pytest.mark.parametrize(("mass", "drop", "x_tip"), [(1000, 9.757688, 16.866944), (2000, 13.315921, 13.523996),
                                                       (4000, 15.650434, 9.995065)])  # fmt: skip
def test_elastica_of_20_m(mass, drop, x_tip, record):
    """Large deflection, 20 elements; elliptic integrals."""
    x, z, _ = cantilever(20, float(mass), 20.0)
    record("elastica, clamped", f"{mass} kg at 20 m, 20 elements: drop", 100.0 * abs(z / drop - 1.0), 0.6, "%")
    record("elastica, clamped", f"{mass} kg at 20 m, 20 elements: x of the tip", 100.0 * abs(x / x_tip - 1.0), 0.6, "%")


# --- catenary --------------------------------------------------------------------------------------------------

# The frictionless cases of MoorPy's test suite (BSD-3, tests/test_catenary.py): x, z, L, EA, w, then H, V_A, V_B [N]
# (V_A: the line pulls A up with it; V_B: B is pulled down with it) and the length on the bed. Case 7 of that
# list does not close; its forces here are those of the closed form.
CASES = {
    1: (400.0, 200.0, 500.0, 7.51e12, 800.0, 96643.42815934008, 0.0, 237751.75535996316, 202.81030580004602),
    3: (400.0, 200.0, 500.0, 7.51e12, 200.0, 43694.580989249596, -22365.599350216216, 77634.40064978378, 0.0),
    4: (89.9, 59.2, 130.0, 7.51e8, 881.05, 31373.229006023103, -26650.341270116318, 87886.15872988368, 0.0),
    5: (37.96888656874307, 20.49078283711694, 100.0, 7.51e8, -881.0549577007893, 6428.437434537766, 53178.729367882406,
        -34926.76640219652, 0.0),
    6: (246.22420940032947, 263.55766330843164, 360.6256626239693, 7e8, 3.08735, 71116.8, 75567.3, 76680.6, 0.0),
    7: (246.22420940032947, 263.55766330843164, 360.63566262396927, 7e8, 3.08735, 58377.24, 61931.00, 63044.41, 0.0),
    8: (246.22420940032947, 263.55766330843164, 360.64566262396926, 7e8, 3.08735, 46077.1, 48765.2, 49878.6, 0.0),
    9: (119.3237383002058, 52.49668849178113, 130.36140355177318, 7e8, 34.91060469991227, 72694.145,
        29715.173, 34266.168,
        0.0),
}  # fmt: skip


def hung(x, z, length, EA, w, bed, elements=200):
    """A line of wet weight w, its lower end on a bed or far above it: system, state, report."""
    depth, low = (300.0, -300.0) if bed else (1000.0, -500.0)
    diameter = 0.1 if w > 0.0 else 0.4
    area = 0.25 * np.pi * diameter**2
    sec = fs.Section(name="line", mass_per_length=w / G + RHO * area, diameter=diameter, EA=EA)
    line = fs.Line(name="line", section=sec, length=length, elements=elements, taut=True)
    joints = [
        fs.Ball(a="line.end_a", b=(0.0, 0.0, low), name="low"),
        fs.Ball(a="line.end_b", b=(x, 0.0, z + low), name="top"),
    ]
    # so stiff that the line does not sink in: 1 mm would count as 1 mm of span
    sea = fs.Sea(depth=depth, density=RHO, seabed=fs.Seabed(stiffness=1e8))
    system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=sea, gravity=G))
    state, report = fs.solve_static(system)
    return system, state, report


@pytest.mark.parametrize("case", CASES)
def test_elastic_catenary(case, record):
    x, z, length, EA, w, H, VA, VB, bed = CASES[case]
    if w > 0.0:
        own = elastic_catenary(x, z, length, EA, w, seabed=bed > 0.0)
        assert own[:3] == pytest.approx((H, VA, VB), rel=2e-5, abs=0.1)
        assert own[3] == pytest.approx(bed, abs=1e-3)
    system, state, report = hung(x, z, length, EA, w, bed > 0.0)
    low, top = end_force(system, state, "low"), end_force(system, state, "top")
    check = "elastic catenary, 200 elements"
    size = np.hypot(H, VB)
    error = np.hypot(-top[0] - H, -top[2] - VB) / size
    record(check, f"case {case}: force at the upper end", 100.0 * error, 0.2, "%")
    if bed == 0.0:
        error = np.hypot(low[0] - H, low[2] - VA) / np.hypot(H, VA)
        record(check, f"case {case}: force at the lower end", 100.0 * error, 0.2, "%")
    else:
        record(check, f"case {case}: horizontal force at the lower end", 100.0 * abs(low[0] / H - 1.0), 0.2, "%")
        record(check, f"case {case}: length on the bed", abs(length + top[2] / w - bed), 0.5, "m")
    assert report.residual_force < 1e-8 * EA


SHAPES = [
    (700.0, 180.0, 800.0, True),
    (400.0, 10.0, 410.0, False),
    (20.0, 200.0, 260.0, False),
    (250.0, 0.0, 300.0, False),
]


@pytest.mark.parametrize(("x", "z", "length", "bed"), SHAPES)
def test_catenary_shapes_of_our_own(x, z, length, bed, record):
    """Long on the bed, nearly flat, nearly vertical, U: against our own closed form."""
    H, _, VB, _ = elastic_catenary(x, z, length, 1e8, 900.0, seabed=bed)
    system, state, _ = hung(x, z, length, 1e8, 900.0, bed)
    top = end_force(system, state, "top")
    record("elastic catenary, 200 elements", f"span {x:g} x {z:g} m, length {length:g} m: force at the upper end",
           100.0 * np.hypot(-top[0] - H, -top[2] - VB) / np.hypot(H, VB), 0.2, "%")  # fmt: skip


# --- VolturnUS-S -----------------------------------------------------------------------------------------------

CHAIN = fs.Section(name="chain", mass_per_length=685.0, diameter=0.333, EA=3.27e9, axial_damping_ratio=1.0,
                   drag_normal=2.0, drag_tangential=0.4, added_mass_normal=0.82,
                   added_mass_tangential=0.27)  # fmt: skip
FAIRLEADS = np.array([(-58.0, 0.0, -14.0), (29.0, 50.229, -14.0), (29.0, -50.229, -14.0)])
ANCHORS = np.array([(-837.6, 0.0, -200.0), (418.8, 725.383, -200.0), (418.8, -725.383, -200.0)])


def mooring(surge):
    """The three chains with their fairleads moved by `surge`: system and static state."""
    lines = [fs.Line(name=f"m{k}", section=CHAIN, length=850.0, elements=50) for k in range(3)]
    joints = []
    for k in range(3):
        joints += [fs.Ball(a=f"m{k}.end_a", b=tuple(ANCHORS[k])),
                   fs.Ball(a=f"m{k}.end_b", b=tuple(FAIRLEADS[k] + (surge, 0.0, 0.0)))]  # fmt: skip
    system = fs.assemble(fs.Model(parts=lines, joints=joints, sea=fs.Sea(depth=200.0), gravity=9.81))
    return system, fs.solve_static(system)[0]


def test_static_mooring(record):
    """Chains of VolturnUS-S (Allen et al. 2020, the public MoorDyn deck); expected values: MoorPy 2.435 MN at the
    fairlead (MoorDyn 2.439, OrcaFlex 2.427), and a restoring of 1.9898 MN at -30 m, vertical -6.554 MN."""
    system, state = mooring(0.0)
    for k in range(3):
        force = np.linalg.norm(end_force(system, state, f"m{k}_end_b")) / 1e6
        record("static mooring", f"force at fairlead {k + 1}", force, (2.435 * 0.99, 2.435 * 1.01), "MN")
    total = sum(end_force(system, state, f"m{k}_end_b") for k in range(3))
    record("static mooring", "horizontal force of all three at rest", np.hypot(*total[:2]), 200.0, "N")
    system, state = mooring(-30.0)
    force = sum(end_force(system, state, f"m{k}_end_b") for k in range(3)) / 1e6
    record("static mooring", "surge restoring at -30 m", force[0], (1.990 * 0.995, 1.990 * 1.005), "MN")
    record("static mooring", "vertical force at -30 m", force[2], (-6.554 * 1.005, -6.554 * 0.995), "MN")


# --- lines as they come ----------------------------------------------------------------------------------------


def random_line(rng):
    """A chain, cable or rope between the seabed and a point above it: taut to lying in heaps."""
    depth = rng.uniform(30.0, 400.0)
    low = np.array([rng.uniform(0.05, 4.0) * depth, 0.0, -depth])
    top = np.array([0.0, 0.0, -rng.uniform(0.0, 0.3) * depth])
    slack = rng.choice([rng.uniform(1.0005, 1.01), rng.uniform(1.01, 1.3), rng.uniform(1.3, 2.0)])
    sections = (
        {"mass_per_length": rng.uniform(50.0, 700.0), "diameter": 0.2, "EA": 10.0 ** rng.uniform(8.0, 9.5)},
        {"mass_per_length": rng.uniform(30.0, 100.0), "diameter": 0.15, "EA": 5e8, "EI": 10.0 ** rng.uniform(3.5, 5.0)},
        {"mass_per_length": 25.0, "diameter": 0.15, "EA": 3e7},
    )
    section = fs.Section(name="section", **sections[rng.integers(3)])
    line = fs.Line(name="line", section=section, length=slack * np.linalg.norm(top - low),
                   elements=int(rng.integers(10, 250)))  # fmt: skip
    joints = [fs.Ball(a="line.end_a", b=low), fs.Ball(a="line.end_b", b=top)]
    return fs.Model(parts=[line], joints=joints, sea=fs.Sea(depth=depth))


@pytest.mark.slow
def test_random_lines_find_their_equilibrium(record):
    """From the crude shape; a solve that does not arrive raises."""
    rng = np.random.default_rng(20261122)
    worst, failed = 0.0, 0
    for _ in range(200):
        model = random_line(rng)
        line = model.parts[0]
        try:
            _, report = fs.solve_static(fs.assemble(model))
        except fs.SolveFailed:
            failed += 1
            continue
        weight = line.pieces[0].section.mass_per_length * G * line.length
        worst = max(worst, report.residual_force / weight)
    record("statics of 200 random lines, taut to slack", "that did not converge", failed, 0)
    record("statics of 200 random lines, taut to slack", "largest unbalanced force over the weight", worst, 1e-6)
