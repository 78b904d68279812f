"""Lines on the bed, cut, leaving the water, at half their strength, with other laws, loads and sections: numbers that
physics gives."""

from __future__ import annotations

import numpy as np
import pytest
from mechanics import end_force, observed_order, run
from scipy.integrate import quad
from scipy.optimize import brentq, fsolve

import floatsim as fs
from floatsim.sea.seabed import bed_height
from floatsim.study.channels import Sampler

RHO, G = 1025.0, 9.81
AIR = fs.Sea(depth=500.0, density=RHO)  # what hangs above the water


def sample(system, state, name):
    """Channel `name` of one state."""
    sampler = Sampler(system, [name])
    return sampler.column(sampler.sample_state(state)[None], name)[0]


def done(run):
    assert run.status == "done", run.failure
    return run


# --- (a) a chain lying on the bed --------------------------------------------------------------------------------

CHAIN = {"mass_per_length": 100.0, "diameter": 0.15, "EA": 5e8}
DISPLACED = RHO * 0.25 * np.pi * 0.15**2  # kg/m
WET = (100.0 - DISPLACED) * G  # N/m, of CHAIN
STIFFNESS, DEPTH, LENGTH, COUNT = 1e6, 50.0, 100.0, 20
SINK = WET / (STIFFNESS * 0.15)  # m, depth of a resting chain in the bed


def bed(**more):
    return fs.Seabed(stiffness=STIFFNESS, damping=1e5, **more)


def lying_chain(pull, friction, current=0.0, **section):
    """A free chain along x on a rough bed, `pull` [N] at its end b by a long, soft spring, a current along y."""
    chain = fs.Section(name="chain", **(CHAIN | section))
    line = fs.Line(name="chain", section=chain, length=LENGTH, elements=COUNT, taut=True,
                   end_a_position=(0, 0, -DEPTH), end_b_position=(LENGTH, 0, -DEPTH))  # fmt: skip
    parts = [line]
    if pull:
        far = 1e6
        parts.append(fs.Spring(name="pull", a="chain.end_b", b=(LENGTH + far, 0, -DEPTH - SINK),
                               stiffness=2.0 * pull / far, free_length=0.5 * far))  # fmt: skip
    sea = fs.Sea(depth=DEPTH, density=RHO, seabed=bed(**friction), current=fs.Current(speed=current, heading_deg=90.0))
    system = fs.assemble(fs.Model(parts=parts, sea=sea, gravity=G))
    state = system.initial_state()
    state.x[: COUNT + 1, 2] -= SINK
    system.forget(state)
    return system, state


def test_chain_held_by_friction(record):
    """Pulled along with 0.5 and 0.99 of mu w L for an hour: it does not move. Statics with friction stretch the
    stick springs: by mu w L share x slip/(mu w L), 0.1 m at most."""
    check = "chain on a rough bed under a constant pull"
    for share in (0.5, 0.99):
        system, state = lying_chain(share * 0.5 * WET * LENGTH, {"friction": 0.5})
        state, _ = fs.solve_static(system, state, friction=True)
        moved = np.mean(state.x[: COUNT + 1, 0] - np.linspace(0.0, LENGTH, COUNT + 1))
        record(check, f"{share:g} of the friction: give of the bed over the slip length", moved / 0.1,
               (0.98 * share, 1.02 * share))  # fmt: skip
        start = state.x.copy()
        now = done(fs.simulate(system, 3600.0, 10.0, state=state, channels=["chain_position"], interval=600.0))
        drift = np.abs(now.series("chain_position") - start[: COUNT + 1]).max()
        record(check, f"{share:g} of the friction: drift in 1 h", 1e3 * drift, 1.0, "mm")


@pytest.mark.parametrize("friction", [{"friction": 0.5}, {"friction": 0.9, "friction_axial": 0.4}])
def test_pull_at_which_a_chain_slides(friction, record):
    """Dragged along at 1 cm/s, and carried sideways by a current: resistance mu_a w L and mu_n w L."""
    along = friction.get("friction_axial", friction["friction"])
    system, state = lying_chain(0.0, friction)
    chain = system.model.parts[0]
    slow = 0.01

    def ramp(t):  # smooth start over 10 s
        f = min(t / 10.0, 1.0)
        return slow * 10.0 * f**3 * (1.0 - 0.5 * f) + slow * max(t - 10.0, 0.0)

    def rate(t):
        f = min(t / 10.0, 1.0)
        return slow * (3.0 * f**2 - 2.0 * f**3)

    def acceleration(t):
        f = min(t / 10.0, 1.0)
        return slow / 10.0 * 6.0 * f * (1.0 - f)

    motion = fs.Motion(lambda t: (LENGTH + ramp(t), 0.0, -DEPTH), lambda t: (rate(t), 0.0, 0.0),
                       lambda t: (acceleration(t), 0.0, 0.0))  # fmt: skip
    pulled = fs.assemble(fs.Model(parts=[chain], joints=[fs.Prescribed(name="winch", a="chain.end_b", motion=motion)],
                                  sea=system.model.sea, gravity=G))  # fmt: skip
    state = pulled.initial_state()
    state.x[:COUNT, 2] -= SINK
    pulled.forget(state)
    now = done(fs.simulate(pulled, 60.0, 0.1, state=state, channels=["winch_force", "chain_position"]))
    force = -np.mean(now.series("winch_force")[400:, 0])
    check = "pull at which a chain slides over mu w L"
    name = "isotropic" if len(friction) == 1 else "anisotropic"
    # the held end node does not press on the bed: half an element less
    record(check, f"{name}, along", force / (along * WET * (LENGTH - 0.5 * LENGTH / COUNT)), (0.99, 1.01))

    drag = 1.2
    speed = np.sqrt(friction["friction"] * WET / (0.5 * RHO * 0.15 * drag))
    gone = []
    for share in (0.99, 1.01):
        system, state = lying_chain(0.0, friction, current=np.sqrt(share) * speed, drag_normal=drag)
        state, _ = fs.solve_static(lying_chain(0.0, friction)[0], state, friction=True)
        now = done(fs.simulate(system, 120.0, 0.1, state=state, channels=["chain_position"], interval=1.0))
        y = now.series("chain_position")[:, :, 1]
        gone.append(np.abs(y[-1] - y[60]).max())
    record(check, f"{name}, sideways: drift at 0.99 of it, second minute", 1e3 * gone[0], 1.0, "mm")
    record(check, f"{name}, sideways: way at 1.01 of it, second minute", gone[1], (0.5, 5.0), "m")


# --- (b) a cut line ----------------------------------------------------------------------------------------------


def hanging_line(elements=40, **cut):
    """100 m of chain in air, cut in its middle (element 20)."""
    chain = fs.Section(name="chain", mass_per_length=50.0, diameter=0.05, EA=1e8, axial_damping_ratio=1.0)
    line = fs.Line(name="chain", section=chain, length=100.0, elements=elements, taut=True,
                   end_b_position=(0.0, 0.0, 300.0), breaks=[fs.Break(at=51.0, **cut)])  # fmt: skip
    return fs.assemble(fs.Model(parts=[line], joints=[fs.Ball(name="top", a="chain.end_a", b=(0, 0, 400.0))], sea=AIR,
                                gravity=G))  # fmt: skip


def test_cut_line(record):
    """Cut at 1 s: the centre of mass of what is below falls by g t^2/2, the rest hangs on with its own weight."""
    system = hanging_line(time=1.0)
    now = done(fs.simulate(system, 6.0, 0.02, channels=["chain_position", "chain_tension", "top_force"]))
    z, mass = now.series("chain_position")[:, :, 2], np.full(41, 125.0)
    mass[-1] = 62.5
    centre = z[:, 21:] @ mass[21:] / mass[21:].sum()
    fall = 0.5 * G * np.maximum(now.time - 1.0, 0.0) ** 2
    check = "line cut in its middle"
    record(check, "fall of the lower part in 5 s: error", np.abs(centre[0] - centre - fall).max(), 1e-6, "m")
    weight = -now.series("top_force")[-1, 2] / (50.0 * G * 20.5 * 2.5)  # 20 elements and half of the cut one
    record(check, "pull of the upper part over its weight, 5 s after", weight, (0.999, 1.001))
    record(check, "tension of the cut element", np.abs(now.series("chain_tension")[51:, 20]).max(), 0.0, "N")
    below = np.abs(now.series("chain_tension")[-1, 21:]).max() / (50.0 * G * 48.75)
    record(check, "tension in the falling part over its tension before", below, 1e-3)


def test_line_breaks_at_its_tension(record):
    """A weightless line pulled at 1 cm/s: it carries EA e up to the tension it breaks at, then nothing."""
    EA, limit = 1e6, 3e4
    rope = fs.Section(name="rope", mass_per_length=1.0, diameter=0.05, EA=EA, axial_law=fs.Engineering(),
                      axial_damping_ratio=0.5)  # fmt: skip
    line = fs.Line(name="rope", section=rope, length=10.0, elements=4, taut=True,
                   breaks=[fs.Break(at=6.0, tension=limit)])  # fmt: skip
    motion = fs.Motion(lambda t: (10.1 + 0.01 * t, 0, 20.0), lambda t: (0.01, 0, 0), lambda t: (0.0, 0, 0))
    joints = [fs.Ball(a="rope.end_a", b=(0, 0, 20.0)), fs.Prescribed(a="rope.end_b", motion=motion)]
    system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=AIR, gravity=0.0))
    now = done(fs.simulate(system, 30.0, 0.1, channels=["rope_tension"]))
    tension = now.series("rope_tension")
    at = int(np.flatnonzero(tension[:, 2] == 0.0)[0])
    check = "line that breaks at a tension"
    # (limit/EA 10 m - 0.1 m)/0.01 m/s = 20 s; a step of 0.1 s pulls by 100 N
    record(check, "time of breaking", now.time[at - 1], (19.9, 20.2), "s")
    record(check, "largest tension over the limit", tension[:, 2].max() / limit, (0.999, 1.005))
    record(check, "tension left in the loose parts over the limit", np.abs(tension[-1]).max() / limit, 0.01)


@pytest.mark.parametrize("form", ["shared", "ball_joints"])
def test_cut_at_a_clamp(form, record):
    """A clamped cable that parts in its first element: what is left of it falls freely, the clamp carries no moment."""
    cable = fs.Section(name="cable", mass_per_length=50.0, diameter=0.05, EA=1e8, EI=1e5, axial_damping_ratio=1.0,
                       bending_damping=1e3)  # fmt: skip
    line = fs.Line(name="cable", section=cable, length=20.0, elements=20, form=form, end_b_position=(20.0, 0.0, 100.0),
                   breaks=[fs.Break(at=0.5, time=1.0), fs.Break(at=0.5, tension=1e9)])  # fmt: skip
    root = fs.Clamp(name="root", a="cable.end_a", b=(0.0, 0.0, 100.0), direction=(1.0, 0.0, 0.0))
    system = fs.assemble(fs.Model(parts=[line], joints=[root], sea=AIR, gravity=G))
    now = done(fs.simulate(system, 2.5, 0.05, channels=["cable_position", "root_moment"]))
    z, mass = now.series("cable_position")[:, 1:, 2], np.full(20, 50.0)
    mass[-1] = 25.0
    fall = (z[0] - z[-1]) @ mass / mass.sum()
    check = f"clamped cable cut in its first element, {form}"
    record(check, "fall of the rest in 1.5 s over g t^2/2", fall / (0.5 * G * 1.5**2), (1 - 1e-6, 1 + 1e-6))
    record(check, "moment left at the clamp", np.abs(now.series("root_moment")[-1]).max(), 0.0, "N m")


# --- (c) slack on the bed ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("excess", [1.001, 1.05, 1.3])
def test_slack_line_on_the_bed(excess, record):
    """Longer than the distance between its anchors on a smooth bed: the bed and the anchors carry its wet weight,
    and it stays at rest."""
    line = fs.Line(name="chain", section=fs.Section(name="chain", **CHAIN), length=excess * LENGTH, elements=50)
    joints = [fs.Ball(name="a", a="chain.end_a", b=(0, 0, -DEPTH)),
              fs.Ball(name="b", a="chain.end_b", b=(LENGTH, 0, -DEPTH))]  # fmt: skip
    sea = fs.Sea(depth=DEPTH, density=RHO, seabed=bed())
    system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=sea, gravity=G))
    state, _ = fs.solve_static(system)
    start = state.x.copy()
    lift = STIFFNESS * 0.15 * (line.length / 50) * np.maximum(-DEPTH - state.x[1:50, 2], 0.0).sum()
    held_up = -(end_force(system, state, "a") + end_force(system, state, "b"))[2]
    check, name = "slack line on the bed", f"{100.0 * (excess - 1.0):.3g} % longer than its span"
    record(check, f"{name}: reaction over the wet weight", (lift + held_up) / (WET * line.length), (1 - 1e-5, 1 + 1e-5))
    now = done(fs.simulate(system, 10.0, 0.1, state=state, channels=["chain_position", "chain_tension"]))
    moved = np.abs(now.series("chain_position") - start[:51]).max()
    record(check, f"{name}: movement in 10 s", 1e3 * moved, 1.0, "mm")
    record(check, f"{name}: largest tension over its wet weight",
           np.abs(now.series("chain_tension")).max() / (WET * line.length), 0.01)  # fmt: skip


# --- (d) leaving the water ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("elements", [1, 7])
def test_work_of_lifting_a_line_out_of_the_water(elements, record):
    """10 m of line hanging vertically, its top lifted from -1 to +11 m: work = m g L 12 m - rho g A L (6 m), 6 m the
    mean depth it starts from; no force jumps on the way."""
    pipe = fs.Section(name="pipe", mass_per_length=60.0, diameter=0.2, EA=1e8, axial_damping_ratio=0.5)
    line = fs.Line(name="pipe", section=pipe, length=10.0, elements=elements, taut=True,
                   end_a_position=(0, 0, -11.0), end_b_position=(0, 0, -1.0))  # fmt: skip
    w = np.pi / 200.0
    lift = fs.Motion(lambda t: (0, 0, -1.0 + 6.0 * (1.0 - np.cos(w * t))), lambda t: (0, 0, 6.0 * w * np.sin(w * t)),
                     lambda t: (0, 0, 6.0 * w * w * np.cos(w * t)))  # fmt: skip
    system = fs.assemble(fs.Model(parts=[line], joints=[fs.Prescribed(name="hook", a="pipe.end_b", motion=lift)],
                                  sea=fs.Sea(depth=50.0, density=RHO), gravity=G))  # fmt: skip
    now = done(fs.simulate(system, 200.0, 0.1, channels=["hook_force", "pipe_position"]))
    force, z = -now.series("hook_force")[:, 2], now.series("pipe_position")[:, -1, 2]
    work = np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(z))
    exact = 10.0 * G * (60.0 * 12.0 - RHO * 0.01 * np.pi * 6.0)
    check = f"line lifted out of the water, {elements} element{'s' if elements > 1 else ''}"
    record(check, "work over weight x height - buoyancy x depth", work / exact, (0.999, 1.001))
    buoyancy = RHO * 0.01 * np.pi * np.clip(-(z - 10.0), 0.0, 10.0)  # of the wet length
    inertia = 600.0 * 6.0 * w * w * np.cos(w * now.time)
    apart = np.abs(force - G * (600.0 - buoyancy) - inertia).max() / (600.0 * G)
    record(check, "force against the weight less the buoyancy of the wet length, over the weight", apart, 0.002)


# --- (e) at half its strength ------------------------------------------------------------------------------------

EA, BREAKING = 4e6, 4e5
TABLE = fs.TensionTable(strain=[0.0, 0.02, 0.05, 0.1], tension=[0.0, 5e4, 2.3e5, 6e5])
# strain at 200 kN: EA e; EA (s^2 - 1) s/2 with s = 1 + e; third stretch of the table
STRAINS = {
    "Green": (None, brentq(lambda e: 0.5 * EA * ((1.0 + e) ** 2 - 1.0) * (1.0 + e) - 2e5, 0.0, 1.0)),
    "engineering": (fs.Engineering(), 0.05),
    "table": (TABLE, 0.02 + 0.03 * (2e5 - 5e4) / (2.3e5 - 5e4)),
}


@pytest.mark.parametrize("law", STRAINS)
def test_taut_line_at_half_its_breaking_load(law, record):
    """A weight of half the breaking load on a line without weight: tension, utilisation and stretch."""
    axial_law, strain = STRAINS[law]
    rope = fs.Section(name="rope", mass_per_length=1e-6, diameter=1e-3, EA=EA, axial_law=axial_law,
                      breaking_load=BREAKING)  # fmt: skip
    line = fs.Line(name="rope", section=rope, length=50.0, elements=10, end_b_position=(0.0, 0.0, 50.0), taut=True)
    load = fs.PointMass(name="load", mass=0.5 * BREAKING / G, position=(0.0, 0.0, 50.0))
    joints = [fs.Ball(a="rope.end_a", b=(0, 0, 100.0)), fs.Ball(a="rope.end_b", b="load")]
    system = fs.assemble(fs.Model(parts=[line, load], joints=joints, sea=AIR, gravity=G))
    state, _ = fs.solve_static(system)
    check = "taut line at half its breaking load"
    for name, value in (("tension over the breaking load", sample(system, state, "rope_tension") / BREAKING),
                        ("utilisation", sample(system, state, "rope_tension_utilisation"))):  # fmt: skip
        record(check, f"{law}: {name}", value.max(), (0.5 - 1e-6, 0.5 + 1e-6))
        assert np.ptp(value) < 1e-6
    stretch = (50.0 - state.x[10, 2]) / 50.0
    record(check, f"{law}: strain over the closed form", stretch / strain, (1.0 - 1e-5, 1.0 + 1e-5))


# --- (f) a rope with static and dynamic stiffness ----------------------------------------------------------------

SLOW, FAST, TAU = 1e7, 3e7, 20.0  # N, N, s


def rope_run(law, strain, duration, dt):
    """Time and tension of 10 m of rope under strain(t), with rates; it starts at its equilibrium."""
    rope = fs.Section(name="rope", mass_per_length=10.0, diameter=0.1, EA=1e7, axial_law=law)
    line = fs.Line(name="rope", section=rope, length=10.0, elements=1, taut=True)
    motion = fs.Motion(*[lambda t, f=f, n=n: (10.0 * (f(t) + (n == 0)), 0, 20.0 * (n == 0))
                         for n, f in enumerate(strain)])  # fmt: skip
    joints = [fs.Ball(a="rope.end_a", b=(0, 0, 20.0)), fs.Prescribed(a="rope.end_b", motion=motion)]
    system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=AIR, gravity=0.0))
    now = done(fs.simulate(system, duration, dt, channels=["rope_tension"]))
    return now.time, now.series("rope_tension")[:, 0]


def rope_law(**more):
    return fs.StaticDynamic(**({"strain": [0.0, 0.04], "tension": [0.0, 0.04 * SLOW], "dynamic_stiffness": FAST,
                                "relaxation_time": TAU} | more))  # fmt: skip


@pytest.mark.parametrize("product", [0.01, 1.0, 100.0])
def test_modulus_of_a_rope(product, record):
    """Harmonic strain about 1 %: E* = (K + i w tau A)/(1 + i w tau), the standard solid. At w tau = 1 storage
    (K + A)/2 and loss (A - K)/2; fast it is A, slow the slope K of the static curve."""
    w = product / TAU
    period = 2.0 * np.pi / w
    lasts = max(3.0 * period, 6.0 * TAU + period)
    strain = (lambda t: 0.01 + 0.002 * (1.0 - np.cos(w * t)), lambda t: 0.002 * w * np.sin(w * t),
              lambda t: 0.002 * w * w * np.cos(w * t))  # fmt: skip
    t, tension = rope_run(rope_law(), strain, lasts, period / 100.0)
    last = t > t[-1] - period * (1.0 + 1e-9)
    A = np.stack([np.ones(last.sum()), -np.cos(w * t[last]), np.sin(w * t[last])], axis=1)
    _, storage, loss = np.linalg.lstsq(A, tension[last], rcond=None)[0] / 0.002
    exact = (SLOW + 1j * product * FAST) / (1.0 + 1j * product)
    check, name = "polyester rope, harmonic strain", f"w tau = {product:g}"
    record(check, f"{name}: storage modulus over the closed form", storage / exact.real, (0.999, 1.001))
    record(check, f"{name}: error of the loss modulus over the storage modulus",
           abs(loss - exact.imag) / exact.real, 1e-3)  # fmt: skip
    if product > 1.0:
        record(check, f"{name}: stiffness over the dynamic stiffness", storage / FAST, (0.999, 1.001))


def test_slow_loading_of_a_rope(record):
    """Strained at a constant rate r: T = T_s(e) + (A - K) r tau (1 - e^(-t/tau)); slow against tau it is T_s."""
    rate = 0.02 / (2000.0 * TAU)
    t, tension = rope_run(rope_law(), (lambda t: 0.005 + rate * t, lambda t: rate, lambda t: 0.0), 2000.0 * TAU, 5.0)
    static = SLOW * (0.005 + rate * t)
    lag = (FAST - SLOW) * rate * TAU * (1.0 - np.exp(-t / TAU))
    check = "polyester rope loaded slowly"
    record(check, "tension over the closed form", np.abs(tension / (static + lag) - 1.0).max(), 1e-6)
    record(check, "tension over the static curve, at most", np.max(tension / static) - 1.0, 0.01)


def test_permanent_stretch_of_a_rope(record):
    """Slowly to 3 % and back: the working curve T_max ((e - p e_max)/((1 - p) e_max))^m; a share p stays."""
    p, m, top, period = 0.4, 1.5, 0.03, 400.0
    w = 2.0 * np.pi / period
    strain = (lambda t: 0.5 * top * (1.0 - np.cos(w * t)), lambda t: 0.5 * top * w * np.sin(w * t),
              lambda t: 0.5 * top * w * w * np.cos(w * t))  # fmt: skip
    law = rope_law(relaxation_time=0.001, permanent_share=p, working_exponent=m)
    t, tension = rope_run(law, strain, 1.5 * period, 0.2)
    e = 0.5 * top * (1.0 - np.cos(w * t))
    worked = SLOW * top * (np.maximum(e - p * top, 0.0) / ((1.0 - p) * top)) ** m
    exact = np.where(t < 0.5 * period, SLOW * e, worked)
    check = "polyester rope pulled hard once"
    record(check, "error of the tension over its largest", np.abs(tension - exact).max() / (SLOW * top), 1e-3)
    back = (t > 0.5 * period) & (t < period)
    scaled = np.maximum(tension[back] / (SLOW * top), 0.0) ** (1.0 / m)  # straight in the strain
    gone = np.interp(-(0.001 ** (1.0 / m)), -scaled, e[back])
    record(check, "strain at a thousandth of the largest tension over the closed form",
           gone / (top * (p + (1.0 - p) * 0.001 ** (1.0 / m))), (0.999, 1.001))  # fmt: skip


# --- (g) moment over curvature -----------------------------------------------------------------------------------


@pytest.mark.parametrize("curvature", [0.01, 0.03, 0.08, 0.15])
def test_pure_moment(curvature, record):
    """Both ends clamped where a circle leaves them: the moment is the table's everywhere, no force is needed.

    Of a polygon of n sides with kinks k l0 and half kinks at the clamps, so that it is exact for any n.
    """
    law = fs.MomentTable(curvature=[0.0, 0.02, 0.05, 0.1], moment=[0.0, 8e3, 1.1e4, 1.3e4])
    exact = float(np.interp(curvature, law.curvature, law.moment)) if curvature <= 0.1 else (
        1.3e4 + (curvature - 0.1) * (1.3e4 - 1.1e4) / 0.05)  # the last slope goes on
    n, length = 12, 18.0
    l0 = length / n
    angles = curvature * l0 * (np.arange(n) + 0.5)
    end = (l0 * np.cos(angles).sum(), 0.0, 20.0 + l0 * np.sin(angles).sum())
    turn = curvature * length
    cable = fs.Section(name="cable", mass_per_length=1.0, diameter=0.1, EA=1e8, bending_law=law)
    line = fs.Line(name="cable", section=cable, length=length, elements=n)
    joints = [fs.Clamp(name="a", a="cable.end_a", b=(0, 0, 20.0), direction=(1, 0, 0)),
              fs.Clamp(name="b", a="cable.end_b", b=end, direction=(-np.cos(turn), 0, -np.sin(turn)))]  # fmt: skip
    system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=AIR, gravity=0.0))
    state = system.initial_state()
    state.x[1 : n + 1, 0], state.x[1 : n + 1, 2] = np.cumsum(l0 * np.cos(angles)), 20.0 + np.cumsum(l0 * np.sin(angles))
    state, _ = fs.solve_static(system, state)
    moment, bent = sample(system, state, "cable_bending_moment"), sample(system, state, "cable_curvature")
    check, name = "circle under a pure moment, table of moments", f"curvature {curvature:g} 1/m"
    record(check, f"{name}: error of the moment", np.abs(moment / exact - 1.0).max(), 1e-6)
    record(check, f"{name}: error of the curvature", np.abs(bent / curvature - 1.0).max(), 1e-6)
    record(check, f"{name}: force at the clamp times the length over the moment",
           np.linalg.norm(end_force(system, state, "a")) * length / exact, 1e-4)  # fmt: skip


# --- (h, k) tapered and stepped beams ----------------------------------------------------------------------------


def tip_load(line, P=0.3):
    """Weightless cantilever with a small tip load P [N]: system and state."""
    load = fs.PointMass(name="load", mass=P / G, position=(line.length, 0.0, 10.0))
    joints = [fs.Clamp(name="root", a="beam.end_a", b=(0, 0, 10.0), direction=(1, 0, 0)),
              fs.Ball(a="beam.end_b", b="load")]  # fmt: skip
    system = fs.assemble(fs.Model(parts=[line, load], joints=joints, sea=fs.Sea(depth=20.0), gravity=G))
    return system, fs.solve_static(system)[0]


def beam_section(EI, name="beam"):
    return fs.Section(name=name, mass_per_length=1e-7, diameter=1e-3, EA=1e6, EI=EI)


@pytest.mark.parametrize("root", ["end_a", "end_b"])
def test_bend_stiffener(root, record):
    """Tip deflection = integral of P (L - s)^2/EI(s), EI from 60 kN m2 more at the root to nothing at 4 m."""
    L, EI, P = 10.0, 1e4, 0.3

    def stiffness(s):
        return EI + 6e4 * max(1.0 - s / 4.0, 0.0)

    exact = quad(lambda s: P * (L - s) ** 2 / stiffness(s), 0.0, L, points=[4.0])[0]
    errors = []
    for n in (10, 20, 40):
        stiffener = fs.BendStiffener(length=4.0, EI=(6e4, 0.0))
        ends = {"stiffener_a" if root == "end_a" else "stiffener_b": stiffener}
        line = fs.Line(name="beam", section=beam_section(EI), length=L, elements=n, **ends)
        tip = "end_b" if root == "end_a" else "end_a"
        load = fs.PointMass(name="load", mass=P / G, position=(L, 0.0, 10.0))
        joints = [fs.Clamp(name="root", a=f"beam.{root}", b=(0, 0, 10.0), direction=(1, 0, 0)),
                  fs.Ball(a=f"beam.{tip}", b="load")]  # fmt: skip
        system = fs.assemble(fs.Model(parts=[line, load], joints=joints, sea=fs.Sea(depth=20.0), gravity=G))
        state, _ = fs.solve_static(system)
        errors.append(abs((10.0 - state.x[n if root == "end_a" else 0, 2]) / exact - 1.0))
    check = f"bend stiffener at {root.replace('_', ' ')}: cantilever against Euler-Bernoulli"
    record(check, "40 elements: tip deflection", 100.0 * errors[2], 0.1, "%")
    record(check, "order, 20 to 40 elements", observed_order(errors), (1.8, 2.3))
    moment = sample(system, state, "beam_bending_moment")[0 if root == "end_a" else -1]
    record(check, "moment at the clamp over P L", moment / (P * L), (1.0 - 1e-4, 1.0 + 1e-4))


def test_change_of_bending_stiffness(record):
    """Cantilever of 4 m of 50 kN m2 and 6 m of 5 kN m2 in elements of different lengths: deflection, and a moment that
    runs on linearly where EI jumps."""
    P, a, L, stiff, soft = 0.3, 4.0, 10.0, 5e4, 5e3
    exact = P * (L**3 - (L - a) ** 3) / (3.0 * stiff) + P * (L - a) ** 3 / (3.0 * soft)
    pieces = [fs.Piece(section=beam_section(stiff, "stiff"), length=a, elements=40),
              fs.Piece(section=beam_section(soft, "soft"), length=L - a, elements=40)]  # fmt: skip
    system, state = tip_load(fs.Line(name="beam", pieces=pieces), P)
    check = "cantilever of two pieces"
    record(check, "tip deflection", 100.0 * abs((10.0 - state.x[80, 2]) / exact - 1.0), 0.05, "%")
    moment, s = sample(system, state, "beam_bending_moment"), system.model.parts[0].arc_length
    record(check, "moment against P (L - s), also at the joint of the pieces, over P L",
           np.abs(moment[:-1] - P * (L - s[:-1])).max() / (P * L), 1e-4)  # fmt: skip


def test_tension_along_pieces(record):
    """Hung in water from its upper end, heavy, buoyant and heavy piece: the tension of every element is the wet weight
    below its middle, so nothing jumps at a change of section."""
    sections = [fs.Section(name="cable", mass_per_length=70.0, diameter=0.2, EA=7e8),
                fs.Section(name="float", mass_per_length=110.0, diameter=0.42, EA=7e8)]  # fmt: skip
    line = fs.Line(name="line", pieces=[fs.Piece(section=sections[0], length=30.0, elements=12),
                                        fs.Piece(section=sections[1], length=10.0, elements=8),
                                        fs.Piece(section=sections[0], length=60.0, elements=20)],
                   end_b_position=(0, 0, -101.0), taut=True)  # fmt: skip
    system = fs.assemble(fs.Model(parts=[line], joints=[fs.Ball(name="top", a="line.end_a", b=(0, 0, -1.0))],
                                  sea=fs.Sea(depth=200.0, density=RHO), gravity=G))  # fmt: skip
    state, _ = fs.solve_static(system)
    w = np.concatenate([np.full(12, 70 - RHO * 0.01 * np.pi), np.full(8, 110 - RHO * 0.0441 * np.pi),
                        np.full(20, 70 - RHO * 0.01 * np.pi)]) * G * line.element_lengths  # fmt: skip
    exact = np.cumsum(w[::-1])[::-1] - 0.5 * w
    tension = sample(system, state, "line_tension")
    record("line of heavy and buoyant pieces", "tension against the wet weight below, over the largest",
           np.abs(tension - exact).max() / exact.max(), 1e-6)  # fmt: skip


# --- (i) attachments ---------------------------------------------------------------------------------------------


def string(at, sea=AIR, height=100.0, **load):
    """A light string of 104 m between points 100 m apart with an attachment: system and equilibrium."""
    light = fs.Section(name="string", mass_per_length=RHO * 0.25 * np.pi * 1e-8, diameter=1e-4, EA=1e10)
    line = fs.Line(name="string", section=light, length=104.0, elements=13,
                   attachments=[fs.Attachment(name="clump", at=at, **load)])  # fmt: skip
    joints = [fs.Ball(name="a", a="string.end_a", b=(0, 0, height)),
              fs.Ball(name="b", a="string.end_b", b=(100.0, 0, height))]  # fmt: skip
    system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=sea, gravity=G))
    return system, fs.solve_static(system)[0]


def polygon(sides, loads):
    """(H, V) of the pull of the left end on its support for an inextensible string of `sides` between points 100 m
    apart at equal height with `loads` [N] downwards at its kinks."""

    def gap(y):
        V = y[1] - np.concatenate([[0.0], np.cumsum(loads)])
        T = np.hypot(y[0], V)
        return np.sum(sides * y[0] / T) - 100.0, np.sum(sides * V / T)

    total = float(np.sum(loads))
    return fsolve(gap, (1.7 * total, 0.5 * total), xtol=1e-13)


@pytest.mark.parametrize("at", [40.0, 42.0, 52.0])
def test_clump_weight_on_a_string(at, record):
    """String polygon: one kink if the clump is at a node, two if it is between nodes (8 m apart)."""
    W = 500.0 * G
    system, state = string(at, mass=500.0)
    k, share = divmod(at, 8.0)
    sides, loads = np.array([at, 104.0 - at]), np.array([W])
    if share:
        sides, loads = np.array([8 * k, 8.0, 96.0 - 8 * k]), W * np.array([1.0 - share / 8.0, share / 8.0])
    H, V = polygon(sides, loads)
    force = end_force(system, state, "a")
    record("string with a clump weight", f"at {at:g} m: force at the end",
           np.hypot(force[0] - H, -force[2] - V) / np.hypot(H, V), 1e-4)  # fmt: skip


def test_buoyancy_module_on_a_string(record):
    """0.8 m3 and 320 kg in water lift by 500 kg x g: the same polygon upside down."""
    lift = 0.8 * RHO - 320.0
    system, state = string(40.0, fs.Sea(depth=200.0, density=RHO), -100.0, mass=320.0, volume=0.8)
    H, V = polygon(np.array([40.0, 64.0]), np.array([lift * G]))
    force = end_force(system, state, "a")
    record("string with a buoyancy module", "force at the end",
           np.hypot(force[0] - H, force[2] - V) / np.hypot(H, V), 1e-4)  # fmt: skip


def test_attachment_moves_over_a_node(record):
    """From 1 mm before to 1 mm after a node no force jumps: it changes like that of the polygon."""
    forces = [end_force(*string(at, mass=500.0), "a") for at in (40.0 - 1e-3, 40.0, 40.0 + 1e-3)]
    change = max(np.linalg.norm(np.diff(forces, axis=0), axis=1)) / np.linalg.norm(forces[1])
    record("string with a clump weight", "moved by 1 mm over a node: change of the force", change, 1e-4)


# --- (j) sloping and uneven beds ---------------------------------------------------------------------------------


def chain_on_slope(angle, friction, hung=False, bathymetry=False):
    """A chain lying straight down a slope [deg], free or held at its upper end: system and drawing state."""
    slope = np.tan(np.radians(angle))
    up = np.array([np.cos(np.radians(angle)), 0.0, np.sin(np.radians(angle))])
    if bathymetry:
        x, y = np.linspace(-200.0, 300.0, 51), np.linspace(-100.0, 100.0, 21)
        shape = {"bathymetry": fs.Bathymetry(x=x, y=y, z=np.repeat((-DEPTH + slope * x)[:, None], 21, axis=1))}
    else:
        shape = {"slope": (slope, 0.0)}
    line = fs.Line(name="chain", section=fs.Section(name="chain", **CHAIN), length=LENGTH, elements=COUNT, taut=True,
                   end_a_position=(0, 0, -DEPTH), end_b_position=tuple((0, 0, -DEPTH) + LENGTH * up))  # fmt: skip
    joints = [fs.Ball(name="top", a="chain.end_b", b=tuple((0, 0, -DEPTH) + LENGTH * up))] if hung else []
    sea = fs.Sea(depth=DEPTH, density=RHO, seabed=bed(friction=friction, **shape))
    system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=sea, gravity=G))
    state = system.initial_state()
    state.x[: COUNT + (not hung)] += SINK * up[0] * np.array([up[2], 0.0, -up[0]])  # pen = w cos/(k d), normal
    system.forget(state)
    return system, state, up


def test_chain_on_a_slope_below_friction(record):
    """tan 20 deg = 0.36 < 0.5: it stays for ten minutes."""
    system, state, _ = chain_on_slope(20.0, 0.5)
    state, _ = fs.solve_static(system, state, friction=True)
    start = state.x.copy()
    now = done(fs.simulate(system, 600.0, 5.0, state=state, channels=["chain_position"], interval=60.0))
    drift = np.abs(now.series("chain_position") - start[: COUNT + 1]).max()
    record("chain on a slope", "20 deg, friction 0.5: drift in 10 min", 1e3 * drift, 1.0, "mm")


def test_chain_slides_down_a_slope(record):
    """tan 30 deg > 0.4: m a = w (sin - mu cos) once the stick springs have given way."""
    system, state, up = chain_on_slope(30.0, 0.4)
    now = done(fs.simulate(system, 6.0, 0.02, state=state, channels=["chain_position"]))
    down = -now.series("chain_position")[:, COUNT // 2] @ up
    t = now.time
    late = t > 2.0
    a = 2.0 * np.polyfit(t[late], down[late], 2)[0]
    exact = WET / 100.0 * (np.sin(np.radians(30.0)) - 0.4 * np.cos(np.radians(30.0)))
    record("chain on a slope", "30 deg, friction 0.4: acceleration over the closed form", a / exact, (0.99, 1.01))


@pytest.mark.parametrize("bathymetry", [False, True])
def test_tension_on_a_smooth_slope(bathymetry, record):
    """Hung from its upper end: the tension falls by w sin(alpha) per metre to nothing at the lower end; a plane given
    as a grid of heights is the same bed."""
    system, state, _ = chain_on_slope(15.0, 0.0, hung=True, bathymetry=bathymetry)
    state, _ = fs.solve_static(system, state)
    tension = sample(system, state, "chain_tension")
    exact = WET * np.sin(np.radians(15.0)) * LENGTH / COUNT * (np.arange(COUNT) + 0.5)
    name = "15 deg as a grid of heights" if bathymetry else "15 deg"
    # the last element leads from the bed to its end on the bed's surface
    record("chain on a slope", f"{name}, smooth: tension against w sin(alpha) s over the largest",
           np.abs(tension - exact)[:-1].max() / exact.max(), 1e-3)  # fmt: skip
    if bathymetry:
        plane, start, _ = chain_on_slope(15.0, 0.0, hung=True)
        other = sample(plane, fs.solve_static(plane, start)[0], "chain_tension")
        apart = np.abs(tension / other - 1.0).max()
        record("chain on a slope", "grid of heights against the plane: tension", apart, 1e-6)


def test_heights_of_a_hill(record):
    """A Gaussian hill 20 m high, 60 m wide, on grids of 20 and 10 m: heights of third order, slopes belong to them."""
    rng = np.random.default_rng(5)
    points = rng.uniform(-150.0, 150.0, (300, 2))

    def hill(x, y):
        return -100.0 + 20.0 * np.exp(-(x**2 + y**2) / (2.0 * 60.0**2))

    errors = []
    for cell in (20.0, 10.0):
        x = np.arange(-300.0, 300.0 + cell, cell)
        grid = fs.Bathymetry(x=x, y=x, z=hill(x[:, None], x[None, :]))
        seabed = fs.Seabed(bathymetry=grid)
        errors.append(max(abs(seabed.height(*p, 100.0) - hill(*p)) for p in points))
    check = "heights of a smooth hill on a grid"
    record(check, "10 m cells: largest error", errors[1], 0.05, "m")
    record(check, "order, 20 to 10 m cells", observed_order(errors), (2.7, 4.5))
    packed, heights = seabed.parameters(100.0)
    h, worst = 1e-5, 0.0
    for x, y in points:
        _, zx, zy = bed_height(packed, heights, x, y)
        dx = (seabed.height(x + h, y, 100.0) - seabed.height(x - h, y, 100.0)) / (2.0 * h)
        dy = (seabed.height(x, y + h, 100.0) - seabed.height(x, y - h, 100.0)) / (2.0 * h)
        worst = max(worst, abs(zx - dx), abs(zy - dy))
    record(check, "slope against differences of the height", worst, 1e-6)


# --- (l) elements with their own end nodes -----------------------------------------------------------------------


def test_pieces_with_ball_joints(record):
    """A line of pieces with a clump, a stiffener, a clamp and current: the form with each element's own nodes tied by
    multipliers gives the same statics and the same motion."""
    w = 2.0 * np.pi / 8.0
    swing = fs.Motion(lambda t: (60.0 + np.sin(w * t) ** 2, 0, -50.0), lambda t: (w * np.sin(2 * w * t), 0, 0),
                      lambda t: (2 * w * w * np.cos(2 * w * t), 0, 0))  # fmt: skip
    states = []
    for form in ("shared", "ball_joints"):
        cable = fs.Section(name="cable", mass_per_length=70.0, diameter=0.2, EA=1e8, EI=1e4, drag_normal=1.2,
                           added_mass_normal=1.0, axial_damping_ratio=0.3)  # fmt: skip
        buoyant = fs.Section(name="buoyant", mass_per_length=110.0, diameter=0.42, EA=1e8, EI=3e4, drag_normal=1.2,
                             added_mass_normal=1.0, axial_law=fs.Engineering())  # fmt: skip
        line = fs.Line(
            name="cable", form=form,
            pieces=[fs.Piece(section=cable, length=30.0, elements=8),
                    fs.Piece(section=buoyant, length=20.0, elements=8),
                    fs.Piece(section=cable, length=40.0, elements=10)],
            attachments=[fs.Attachment(name="clump", at=20.3, mass=80.0, volume=0.02, drag_area=0.1, added_mass=0.5)],
            stiffener_a=fs.BendStiffener(length=5.0, EI=(5e4, 1e3), mass_per_length=(20.0, 0.0)),
        )  # fmt: skip
        joints = [fs.Clamp(a="cable.end_a", b=(0, 0, -10.0), direction=(0.3, 0, -1)),
                  fs.Prescribed(a="cable.end_b", motion=swing)]  # fmt: skip
        sea = fs.Sea(depth=100.0, density=RHO, current=fs.Current(speed=0.5, heading_deg=60.0))
        system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=sea, gravity=G))
        state, _ = fs.solve_static(system)
        still = state.x[line.nodes].copy()
        run(system, state, fs.generalised_alpha(0.6), 0.05, 80)
        states.append((still, state.x[line.nodes].copy()))
    (still, moved), (other_still, other_moved) = states
    check = "line of pieces as elements tied by ball joints"
    record(check, "statics: largest difference", np.abs(still - other_still).max(), 1e-6, "m")
    record(check, "after 4 s of motion: largest difference", np.abs(moved - other_moved).max(), 1e-6, "m")
    assert np.abs(moved - still).max() > 0.3


# --- what statics may not forget ---------------------------------------------------------------------------------


@pytest.mark.parametrize("drawn", [100.0, 104.0, 108.0, 112.0])
def test_equilibrium_of_a_rope_does_not_depend_on_its_drawing(drawn, record):
    """A rope that keeps a share of its largest stretch, never loaded before: T_s(0.03) carries the weight, also where
    it was drawn longer; and the state that statics return is in balance."""
    law = rope_law(permanent_share=0.4)
    rope = fs.Section(name="rope", mass_per_length=1e-6, diameter=1e-3, EA=1e7, axial_law=law)
    line = fs.Line(name="rope", section=rope, length=100.0, elements=4, taut=True)
    load = fs.PointMass(name="load", mass=0.03 * SLOW / G, position=(0, 0, 300.0 - drawn))
    joints = [fs.Ball(a="rope.end_a", b=(0, 0, 300.0)), fs.Ball(a="rope.end_b", b="load")]
    system = fs.assemble(fs.Model(parts=[line, load], joints=joints, sea=AIR, gravity=G))
    state, _ = fs.solve_static(system)
    check = "rope that was drawn stretched"
    record(check, f"drawn {drawn:g} m long: strain over the closed form", (2.0 - state.x[4, 2] / 100.0) / 0.03,
           (1.0 - 1e-6, 1.0 + 1e-6))  # fmt: skip
    moved = done(fs.simulate(system, 5.0, 0.1, state=state)).series("load_position")
    record(check, f"drawn {drawn:g} m long: motion after it", np.ptp(moved, axis=0).max(), 1e-6, "m")


def test_statics_remember_the_largest_stretch(record):
    """Pulled to 8 % and let back to 6 %: the tension of the working curve, before and after a new equilibrium."""
    p, m, there, back = 0.4, 1.5, 0.08, 0.06
    law = rope_law(strain=[0.0, 0.1], tension=[0.0, 0.1 * SLOW], permanent_share=p, working_exponent=m,
                   relaxation_time=0.5)  # fmt: skip
    rope = fs.Section(name="rope", mass_per_length=1e-3, diameter=1e-3, EA=1e7, axial_law=law, axial_damping=1e4)
    line = fs.Line(name="rope", section=rope, length=100.0, elements=2, taut=True)
    w = np.pi / 40.0  # 1 m at rest, to 8 m at 40 s, back to 6 m at 60 s

    def way(t, n):
        if t <= 40.0:
            return (there * 50.0 * (1 - np.cos(w * t)), there * 50.0 * w * np.sin(w * t),
                    there * 50.0 * w * w * np.cos(w * t))[n]  # fmt: skip
        half, size = 2.0 * w * (t - 40.0), (there - back) * 50.0
        if t >= 60.0:
            return (100.0 * back, 0.0, 0.0)[n]
        return (100.0 * there - size * (1 - np.cos(half)), -2.0 * w * size * np.sin(half),
                -4.0 * w * w * size * np.cos(half))[n]  # fmt: skip

    motion = fs.Motion(*[lambda t, n=n: (100.0 * (n == 0) + way(t, n), 0, 200.0 * (n == 0)) for n in range(3)])
    joints = [fs.Ball(a="rope.end_a", b=(0, 0, 200.0)), fs.Prescribed(a="rope.end_b", motion=motion)]
    system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=AIR, gravity=0.0))
    pulled = done(fs.simulate(system, 80.0, 0.1)).state
    again, _ = fs.solve_static(system, pulled)
    exact = SLOW * there * ((back - p * there) / ((1.0 - p) * there)) ** m
    for name, state in (("after the run", pulled), ("after a new equilibrium", again)):
        record("rope pulled hard, then statics", f"{name}: tension over the working curve",
               sample(system, state, "rope_tension").max() / exact, (0.999, 1.001))  # fmt: skip


def test_a_broken_line_stays_broken(record):
    """Statics after a break hang both halves from their ends; a second run on the same system starts whole."""
    chain = fs.Section(name="chain", mass_per_length=50.0, diameter=0.05, EA=1e7)
    line = fs.Line(name="chain", section=chain, length=100.0, elements=20, breaks=[fs.Break(at=52.0, time=1.0)])
    joints = [fs.Ball(a="chain.end_a", b=(0, 0, 400.0)), fs.Ball(a="chain.end_b", b=(80.0, 0, 400.0))]
    system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=AIR, gravity=G))
    first = done(fs.simulate(system, 2.0, 0.05))
    state, _ = fs.solve_static(system, first.state)
    after = done(fs.simulate(system, 1.0, 0.05, state=state)).series("chain_tension")
    check = "equilibrium of a broken line"
    record(check, "largest tension of a run from it over half an element less than half the line's weight",
           after.max() / (G * 50.0 * 50.0), (1.0 - 1e-4, 1.0 + 1e-4))  # fmt: skip
    second = done(fs.simulate(system, 2.0, 0.05))
    np.testing.assert_array_equal(first.series("chain_tension"), second.series("chain_tension"))


@pytest.mark.parametrize("rows", [1, 5])
def test_a_law_may_remember_as_much_as_it_likes(rows, record):
    """A law of one's own with `memory` rows, here the number of steps: linear, it gives EA e."""

    class Counting:
        stiffness, memory = EA, rows

        def bind(self, damping):
            def evaluate(s, rate, old, new, h, out):
                out[0], out[1], out[2] = EA * (s - 1.0) + damping * rate, EA, damping
                new[:] = old + 1.0

            return evaluate

        def start(self, s):
            return np.zeros((rows, len(s)))

    rope = fs.Section(name="rope", mass_per_length=1.0, diameter=0.01, EA=1.0, axial_law=Counting())
    line = fs.Line(name="rope", section=rope, length=10.0, elements=1, taut=True)
    joints = [fs.Ball(a="rope.end_a", b=(0, 0, 20.0)), fs.Ball(a="rope.end_b", b=(10.1, 0, 20.0))]
    system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=AIR, gravity=0.0))
    now = done(fs.simulate(system, 1.0, 0.1))
    record("law of one's own", f"{rows} rows of memory: tension over EA e", now.series("rope_tension")[-1, 0] / EA,
           (0.01 - 1e-9, 0.01 + 1e-9))  # fmt: skip
    assert now.state.history[0]["laws"][0].shape == (rows, 1) and now.state.history[0]["laws"][0].min() == 11.0


# --- far from the origin -----------------------------------------------------------------------------------------


def test_a_cable_in_map_coordinates(record):
    """Drawn 20 km from the origin the end force of a cable whose top is shaken is the same to a thousandth: the
    tolerance of a step is not that of the coordinates' rounding errors."""

    def force(east, tolerance):
        cable = fs.Section(name="cable", mass_per_length=20.0, diameter=0.12, EA=7e8, EI=1e4, drag_normal=1.2,
                           added_mass_normal=1.0, axial_damping=1e6)  # fmt: skip
        line = fs.Line(name="cable", section=cable, length=150.0, elements=100)
        a, w = 2.0, 0.8
        motion = fs.Motion(lambda t: (east + 90.0 + a * (1.0 - np.cos(w * t)), 0, -5.0 + a * (1.0 - np.cos(w * t))),
                           lambda t: (a * w * np.sin(w * t), 0, a * w * np.sin(w * t)),
                           lambda t: (a * w * w * np.cos(w * t), 0, a * w * w * np.cos(w * t)))  # fmt: skip
        joints = [fs.Ball(a="cable.end_a", b=(east, 0, -80.0)), fs.Prescribed(a="cable.end_b", motion=motion)]
        system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=fs.Sea(depth=80.0), gravity=G))
        now = done(fs.simulate(system, 8.0, 0.1, tolerance=tolerance, step_control=False))
        return now.series("cable_end_b_force")

    near, far = force(0.0, 1e-8), force(2e4, 1e-5)
    record("cable 20 km from the origin", "error of its end force over the largest",
           np.abs(far - near).max() / np.abs(near).max(), 1e-4)  # fmt: skip


# --- standing upright --------------------------------------------------------------------------------------------


def test_pile_stands_on_its_clamp(record):
    """46.5 m of a heavy pipe, clamped at the bed, its top held: each end carries half its weight in water."""
    pipe = fs.Section(name="pipe", mass_per_length=500.0, diameter=0.5, EA=1e10, EI=1e8)
    line = fs.Line(name="pipe", section=pipe, length=46.5, elements=100)
    joints = [fs.Clamp(a="pipe.end_a", b=(0, 0, -50.0), direction=(0, 0, 1)), fs.Ball(a="pipe.end_b", b=(0, 0, -3.5))]
    system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=fs.Sea(depth=50.0, density=RHO), gravity=G))
    state, _ = fs.solve_static(system)
    half = 0.5 * 46.5 * (500.0 - RHO * 0.25 * np.pi * 0.25) * G
    for end in ("end_a", "end_b"):
        record("pile on its clamp", f"force at {end.replace('_', ' ')} over half the weight",
               -sample(system, state, f"pipe_{end}_force")[2] / half, (0.99, 1.01))  # fmt: skip


# --- going on from a state ---------------------------------------------------------------------------------------


def test_a_rope_feels_the_same_where_a_run_ended(record):
    """The clock of a run is rounded to its output grid, that of the rope's memory is not: a trifle of time backwards
    is no time at all, not a rope at rest for ever."""
    rope = fs.Section(name="rope", mass_per_length=10.0, diameter=0.1, EA=1e7, axial_law=rope_law())
    line = fs.Line(name="rope", section=rope, length=100.0, elements=2, taut=True)
    w = 0.8
    motion = fs.Motion(lambda t: (102.0 + 0.5 * (1.0 - np.cos(w * t)), 0, 200.0),
                       lambda t: (0.5 * w * np.sin(w * t), 0, 0),
                       lambda t: (0.5 * w * w * np.cos(w * t), 0, 0))  # fmt: skip
    joints = [fs.Ball(a="rope.end_a", b=(0, 0, 200.0)), fs.Prescribed(a="rope.end_b", motion=motion)]
    system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=AIR, gravity=0.0))
    apart = 0.0
    for n in range(10, 22):  # 1.3, 1.5 and 1.8 s are rounded down
        now = done(fs.simulate(system, 0.1 * n, 0.1, step_control=False))
        last = now.series("rope_tension")[-1]
        apart = max(apart, np.abs(sample(system, now.state, "rope_tension") / last - 1.0).max())
    record("rope, state at the end of a run", "tension apart from the run's", apart, 1e-9)


def test_a_restart_under_step_control(record):
    """A chain snapping under cut steps: a run in two halves is the run in one, to what rounding of the clock does."""
    chain = fs.Section(name="chain", mass_per_length=685.0, diameter=0.333, EA=3.27e9, drag_normal=1.1,
                       added_mass_normal=0.82, axial_damping_ratio=0.3)  # fmt: skip
    line = fs.Line(name="chain", section=chain, length=850.0, elements=30, breaks=[fs.Break(at=600.0, time=6.5)])
    a, w = 12.0, 0.8
    motion = fs.Motion(lambda t: (760.0 + a * (1.0 - np.cos(w * t)), 0, -14.0 + a * (1.0 - np.cos(w * t))),
                       lambda t: (a * w * np.sin(w * t), 0, a * w * np.sin(w * t)),
                       lambda t: (a * w * w * np.cos(w * t), 0, a * w * w * np.cos(w * t)))  # fmt: skip
    joints = [fs.Ball(a="chain.end_a", b=(0, 0, -200.0)), fs.Prescribed(a="chain.end_b", motion=motion)]
    sea = fs.Sea(depth=200.0, density=RHO, seabed=fs.Seabed(friction=0.6, slip_length=0.02))
    system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=sea, gravity=G))
    whole = done(fs.simulate(system, 8.0, 0.1))
    first = done(fs.simulate(system, 4.0, 0.1))
    assert first.state.pace[0] < 0.09  # steps are cut where the run is parted
    second = done(fs.simulate(system, 4.0, 0.1, state=first.state))
    assert first.steps + second.steps == whole.steps
    tension, again = whole.series("chain_tension"), second.series("chain_tension")
    record("run in two halves", "tension apart from that of one run over its largest",
           np.abs(tension[41:] - again[1:]).max() / tension.max(), 1e-6)  # fmt: skip


def test_no_bend_where_a_line_has_parted(record):
    """Its two halves swing apart: what is between them is no curvature. Cut at a clamp, its angle is none either."""
    cable = fs.Section(name="cable", mass_per_length=60.0, diameter=0.1, EA=1e7, EI=1e4, drag_normal=1.2,
                       added_mass_normal=1.0, axial_damping=1e6, minimum_bend_radius=2.0)  # fmt: skip
    line = fs.Line(name="cable", section=cable, length=60.0, elements=60,
                   breaks=[fs.Break(at=30.5, time=0.5), fs.Break(at=0.5, time=0.5)])  # fmt: skip
    joints = [fs.Clamp(a="cable.end_a", b=(0, 0, -10.0), direction=(0, 0, -1)),
              fs.Ball(a="cable.end_b", b=(40.0, 0, -10.0))]  # fmt: skip
    system = fs.assemble(fs.Model(parts=[line], joints=joints, sea=fs.Sea(depth=200.0, density=RHO), gravity=G))
    now = done(fs.simulate(system, 6.0, 0.1))
    apart = np.linalg.norm(np.diff(now.series("cable_position")[-1], axis=0), axis=1)
    assert apart[30] > 5.0 and apart[0] > 5.0
    record("cut cable", "curvature at the cuts", np.abs(now.series("cable_curvature")[-1, [0, 1, 30, 31]]).max(), 0.0,
           "1/m")  # fmt: skip
    assert now.series("cable_end_a_clamp_angle")[-1] == 0.0
    assert now.series("cable_curvature_utilisation")[0, 0] > 0.0
