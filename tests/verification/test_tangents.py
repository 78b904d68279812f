"""Every matrix against central differences of the residual, entry by entry.

One test loops over all batches and over the constraints of systems that between them hold everything that is
registered; a new part or joint joins by standing in `SYSTEMS`, and `test_everything_registered_is_here` says
so when it does not. Each kind of stiffness is looked at alone (the others zero), because an error in bending
hides behind an axial stiffness of 1e9 N.

Left out of the matrices on purpose, and therefore not seen here, where rotations are turned by spatial vectors
from the current attitude: the tangent of the exponential map of the *step's* increment, a relative error of
half the turn of one step in the rotational stiffness (`test_cost_of_what_is_left_out`).

Kinks, where one-sided derivatives differ and random states do not lie: a node at the seabed (spring and
damper begin), a damper that would pull (the bed lets go), the end of the damper's growth, a
tension-only spring at its free length, sections just leaving the water or just drowned (second derivative
only), tangential drag at w_t = 0 and normal drag at w_n = 0 (second derivative only). The axial law has none.
"""

from __future__ import annotations

import numpy as np
import pytest
from mechanics import DRY as AIR
from mechanics import displace, free_unknowns, matrix, residual

import floatsim as fs
from floatsim.hydro.hull import Hull
from floatsim.parts.element import ADDED_N, ADDED_T, CA, DRAG_N, DRAG_T, DRY, EA, WATER
from floatsim.parts.end_bending import EndBendingBatch
from floatsim.parts.line import LineBatch
from floatsim.parts.member import Disc, Member
from floatsim.parts.point_buoy import PointBuoy
from floatsim.parts.pto import PTO
from floatsim.pto_laws.polynomial import Polynomial

STENCIL = ((1.0, 4.0 / 5.0), (2.0, -1.0 / 5.0), (3.0, 4.0 / 105.0), (4.0, -1.0 / 280.0))  # eighth order
WET = dict(drag_normal=1.2, drag_tangential=0.3, added_mass_normal=1.0, added_mass_tangential=0.2)
NEAR = fs.Sea(depth=20.0, density=1025.0, current=fs.Current(speed=0.7, heading_deg=30.0))


def section(**more):
    values = dict(name="cable", mass_per_length=20.0, diameter=0.15, EA=1e5) | more
    return fs.Section(**values)


def line(elements=4, z=(5.0, 9.0), sea=AIR, gravity=9.81, joints=(), form="shared", **more):
    """A line whose nodes the random states then move about."""
    part = fs.Line(name="line", section=section(**more), length=8.0, elements=elements, form=form, taut=True,
                   end_a_position=(0.0, 0.0, z[0]), end_b_position=(6.0, 1.0, z[1]))  # fmt: skip
    return fs.Model(parts=[part], joints=joints, sea=sea, gravity=gravity)


def on_bed(z=(-20, -19), **more):
    """A rough sloping bed that every node touches; `scale` of the random states decides what slides."""
    bed = fs.Seabed(stiffness=2e4, damping=3e3, friction=0.9, friction_axial=0.5, slip_length=0.8, **more)
    return line(z=z, sea=fs.Sea(depth=20.0, seabed=bed))


def loaded():
    """Attachments dry, half wet and wet; two sections; a stiffener."""
    pieces = [fs.Piece(section=section(EI=3e4), length=4.0, elements=3),
              fs.Piece(section=section(name="thick", diameter=0.4, EI=1e3), length=4.0, elements=2)]  # fmt: skip
    loads = [fs.Attachment(name=f"clump_{k}", at=at, mass=30.0, volume=0.5, drag_area=0.6, added_mass=0.5)
             for k, at in enumerate((1.0, 4.0, 7.7))]  # fmt: skip
    part = fs.Line(name="line", pieces=pieces, attachments=loads, taut=True, end_a_position=(0, 0, -0.6),
                   end_b_position=(6.0, 1.0, 0.6))  # fmt: skip
    return fs.Model(parts=[part], sea=NEAR)


TABLE = fs.TensionTable(strain=(0.0, 0.1, 0.4), tension=(0.0, 1e4, 9e4))
POLYESTER = fs.StaticDynamic(strain=(0.0, 0.2, 0.6), tension=(0.0, 1e4, 9e4), dynamic_stiffness=2e5, per_tension=3.0,
                             relaxation_time=2.0, permanent_share=0.3)  # fmt: skip
LAW = Polynomial(stiffness=(400.0, -20.0, 30.0), damping=(30.0,))
MOMENTS = fs.MomentTable(curvature=(0.0, 0.2, 0.5, 0.9), moment=(0.0, 6e3, 9e3, 2e4))


def two_bodies():
    inertia = (4.0, 6.0, 7.0, 0.3, -0.2, 0.4)
    body = dict(mass=3.0, inertia=inertia, points={"p": (0.4, -0.3, 0.6), "o": (0.0, 0.0, 0.0)})
    return [fs.Body(name="one", position=(0, 0, 5), center_of_mass=(0.2, 0.1, -0.3), **body),
            fs.Body(name="two", position=(0.4, -0.3, 5.6), attitude_deg=(20, -30, 40), **body)]  # fmt: skip


def bodies(joints=(), parts=()):
    return fs.Model(parts=[*two_bodies(), *parts], joints=joints, sea=AIR)


def clamped(to, **more):
    part = fs.Line(name="line", section=section(**more), length=4.0, elements=2)
    other = [] if isinstance(to, tuple) else [two_bodies()[0]]
    b = (0.4, -0.3, 5.6) if isinstance(to, tuple) else to
    joints = [fs.Clamp(a="line.end_a", b=b, direction=(1.0, 0.2, -0.3)), fs.Ball(a="line.end_b", b=(3, 0, 6))]
    return fs.Model(parts=[*other, part], joints=joints, sea=AIR, gravity=0.0)


def prescribed():
    rate = np.array([0.3, -0.2, 0.1, 0.5, 0.4, -0.3])
    motion = fs.Motion(lambda t: np.array([0, 0, 5, 0, 0, 0]) + rate * np.sin(t), lambda t: rate * np.cos(t),
                       lambda t: -rate * np.sin(t))  # fmt: skip
    return fs.Model(parts=[two_bodies()[0]], joints=[fs.Prescribed(a="one", motion=motion)], sea=AIR)


def floater():
    """A floater with made-up coefficients in every entry."""
    from pathlib import Path

    database = Path(__file__).parents[2] / "models" / "volturnus_s_hydro.nc"
    rows = 1e7 * np.random.default_rng(3).uniform(-1.0, 1.0, (3, 6, 6))
    flow = fs.PotentialFlow(
        database=database, linear_damping=rows[0], quadratic_damping=rows[1], linear_stiffness=rows[2]
    )
    body = fs.Body(name="hull", mass=2e7, inertia=(4e10, 4e10, 2e10), center_of_mass=(1.0, 2.0, -3.0), hydro=flow)
    return fs.Model(parts=[body], sea=fs.Sea(depth=200.0, current=fs.Current(speed=0.4, heading_deg=20.0)))


def hull(waves=None):
    """A coarse rough hull, its reference point off its middle."""
    from hulls import ellipsoid

    mesh = ellipsoid(3.0, 2.0, 1.5, 3)
    body = fs.Body(name="hull", mass=2e4, inertia=(4e4, 4e4, 5e4), hydro=Hull(mesh=mesh, mesh_origin=(0.4, 0.3, -0.2)))
    return fs.Model(parts=[body], sea=fs.Sea(depth=30.0, waves=waves, wave_ramp=0.0))


WAVY = fs.Sea(depth=40.0, current=fs.Current(speed=0.7, heading_deg=30.0), wave_ramp=0.0,
              waves=fs.RegularWave(height=2.0, period=6.0, heading_deg=50.0))  # fmt: skip


def members(z, drag="coupled"):
    """Members and discs of a body whose reference point is drawn at z."""
    wet = dict(drag_normal=1.1, drag_tangential=0.1, added_mass_normal=0.9, added_mass_tangential=0.2, drag_form=drag)
    ends = dict(end_drag=0.7, end_added_mass=0.5)
    loads = [Member(a=(0, 0, -3), b=(0.5, 0.3, 4), diameter=(2.0, 1.2), strips=7, **ends, **wet),
             Member(a=(-4, 1, 0), b=(3, 2, 0.5), diameter=0.9, strips=3, **wet),
             Disc(at=(0, 0, -3), axis=(0.1, 0, 1), diameter=3.0, drag=2.0, added_mass=1.0)]  # fmt: skip
    hull = fs.Body(name="hull", mass=9e3, inertia=(4e4, 4e4, 2e4), center_of_mass=(0.1, 0.2, -1), position=(0, 0, z),
                   hydro=loads)  # fmt: skip
    return fs.Model(parts=[hull], sea=WAVY)


def buoys():
    """Point floaters dry, half wet and wet."""
    more = dict(mass=90.0, volume=0.4, drag_area=0.5, added_mass=0.5)
    parts = [PointBuoy(name=f"buoy_{k}", position=(0, 0, z), height=2.0, **more) for k, z in enumerate((4, 0.2, -4))]
    return fs.Model(parts=parts, sea=WAVY)


def sinkers():
    """On a rough sloping bed; `scale` of the random states decides what slides."""
    bed = fs.Seabed(stiffness=2e4, damping=6e2, friction=0.7, slip_length=0.8, slope=(0.3, -0.2))
    parts = [PointBuoy(name=f"sinker_{k}", position=(0, 0, -20), mass=90.0, volume=0.02, bed_area=0.5) for k in (0, 1)]
    return fs.Model(parts=parts, sea=fs.Sea(depth=20.0, seabed=bed))


def turbine(speed, **more):
    """A rotor with its tower on a body; `moving`: its states move with the step, else it is at its steady point."""
    import made_up_rotor

    tower = fs.Tower(base=(1, 0, -60), top=(0, 0, 20), diameter=(7.0, 5.0), strips=3)
    part = made_up_rotor.rotor("hull", tower_top=(0, 0, 20), overhang=6.0, tilt_deg=5.0, tower=tower,
                               control=dict(velocity_feedback=0.02, maximum_pitch_deg=29.0), **more)  # fmt: skip
    hull = fs.Body(name="hull", mass=1e5, inertia=(1e8, 1e8, 1e8), position=(0, 0, 80))
    return fs.Model(parts=[hull, part], sea=AIR, gravity=0.0, wind=fs.Wind(speed=speed, shear=0.1))


# name: (model, what of a line is kept (None: all), how the random states are drawn)
SYSTEMS = {
    "axial": (line, "EA", {}),
    "axial, slack": (line, "EA", {"scale": 0.5}),
    "axial damping": (lambda: line(axial_damping=3e3), "CA", {}),
    "bending": (lambda: line(EI=3e4), "EI", {}),
    "bending, 170 degrees": (lambda: line(2, EI=3e4), "EI", {"fold": 170.0}),
    "bending, 0.5 degrees": (lambda: line(2, EI=3e4), "EI", {"fold": 0.5, "step": 5e-4}),
    "bending damping": (lambda: line(EI=1.0, bending_damping=3e3), "CB", {}),
    "bending, ball_joints": (lambda: line(form="ball_joints", EI=3e4), "EI", {}),
    "weight and mass, dry": (line, "MASS", {}),
    "wet": (lambda: line(z=(-5, -9), sea=NEAR, **WET), "HYDRO", {}),
    "wet, across the surface": (lambda: line(z=(-3, 3), sea=NEAR, **WET), "HYDRO", {"scale": 0.2}),
    "half wet": (lambda: line(z=(-0.03, 0.02), diameter=2.0, sea=NEAR, **WET), "HYDRO", {"scale": 0.3}),
    "half wet, level": (lambda: line(z=(0.01, 0.01), diameter=2.0, sea=NEAR, **WET), "HYDRO", {"scale": 0.0}),
    "seabed": (lambda: line(z=(-20, -20), sea=NEAR), "", {"scale": 0.3}),
    "seabed, damper's ramp": (lambda: line(z=(-20, -20), sea=NEAR), "",
                              {"scale": 0.002, "speed": 0.001, "step": 1e-4, "sink": 0.005}),
    "seabed, sticking": (on_bed, "", {"scale": 0.1, "sink": 1.0}),
    "seabed, sliding": (on_bed, "", {"scale": 0.9, "sink": 2.0}),
    "seabed, sliding on a slope": (lambda: on_bed(z=(-20, -18), slope=(0.3, -0.2)), "", {"scale": 0.9, "sink": 3.0}),
    "engineering strain": (lambda: line(axial_law=fs.Engineering(), axial_damping=3e3), "EA+CA", {}),
    "table of tensions": (lambda: line(axial_law=TABLE, axial_damping=3e3), "EA+CA", {}),
    "polyester": (lambda: line(axial_law=POLYESTER, axial_damping=3e3), "EA+CA", {"moving": True}),
    "table of moments": (lambda: line(bending_law=MOMENTS), "EI", {"scale": 0.5, "step": 2e-4}),
    "clamp, table of moments": (lambda: clamped("one.p", bending_law=MOMENTS), "EI", {}),
    "attachments": (loaded, None, {"scale": 0.3, "flow": True}),
    "wet, in waves": (lambda: line(z=(-5, -9), sea=NEAR, **WET), "HYDRO", {"flow": True}),
    "line, all of it": (lambda: line(z=(-20, 1), sea=NEAR, EI=1e3, bending_damping=1e2, axial_damping=1e3, **WET),
                        None, {}),
    "bodies": (bodies, None, {}),
    "point mass": (lambda: fs.Model(parts=[fs.PointMass(name="bob", mass=3.0, position=(0, 0, 5))], sea=AIR), None, {}),
    "spring": (lambda: bodies(parts=[fs.Spring(name="spring", a="one.p", b="two.p", stiffness=400.0, damping=30.0,
                                               free_length=0.7)]), None, {}),
    "spring to the ground": (lambda: bodies(parts=[fs.Spring(name="spring", a="one.p", b=(1, 2, 3), stiffness=400.0,
                                                             damping=30.0, free_length=0.7, tension_only=True)]),
                             None, {}),
    "PTO": (lambda: bodies(parts=[PTO(name="pto", a="one.p", b=(1, 2, 3), laws=[LAW])]), None, {}),
    "clamp on a body": (lambda: clamped("one.p", EI=3e4), "EI", {}),
    "clamp on the ground": (lambda: clamped((0, 0, 6), EI=3e4), "EI", {}),
    "clamp's damping": (lambda: clamped("one.p", EI=1.0, bending_damping=3e3), "CB", {}),
    "ball": (lambda: bodies([fs.Ball(a="one.p", b="two.o")]), None, {}),
    "ball to the ground": (lambda: bodies([fs.Ball(a="one.p", b=(0.4, -0.3, 5.6))]), None, {}),
    "weld": (lambda: bodies([fs.Weld(a="one.p", b="two.o")]), None, {}),
    "prescribed": (prescribed, None, {}),
    "floater": (floater, None, {"big": True}),
    "hull": (hull, None, {}),
    "hull in waves": (lambda: hull(fs.RegularWave(height=1.5, period=4.0)), None, {"moving": True, "step": 1e-3}),
    "members, across the surface": (lambda: members(0.0), None, {"moving": True}),
    "members, decoupled drag": (lambda: members(-1.0, drag="decoupled"), None, {"moving": True, "step": 1e-3}),
    "members, under water": (lambda: members(-9.0), None, {"moving": True}),
    "sinkers, sticking": (sinkers, None, {"scale": 0.1, "sink": 1.0}),
    "sinkers, sliding": (sinkers, None, {"scale": 0.9, "sink": 2.0}),
    "rotor, steady": (lambda: turbine(8.0), None, {}),
    "rotor below rated": (lambda: turbine(8.0), None, {"moving": True}),
    "rotor above rated": (lambda: turbine(17.0), None, {"moving": True}),
    "parked rotor": (lambda: turbine(17.0, cut_out=12.0, parked_drag_area=80.0), None, {}),
    "point buoys": (buoys, None, {"flow": True, "scale": 0.3}),
}  # fmt: skip
ROWS = {"EA": EA, "CA": CA, "MASS": DRY}
HYDRO = (WATER, DRAG_N, DRAG_T, ADDED_N, ADDED_T)


def keep_alone(system, what):
    """Set every property of the lines but `what` to zero."""
    for batch in system.batches:
        if isinstance(batch, LineBatch):
            for row in (EA, CA, DRY, *HYDRO):
                kept = {"HYDRO": HYDRO, "EA+CA": (EA, CA)}.get(what, (ROWS.get(what),))
                if row not in kept:
                    batch.P[:, row] = 0.0
            batch.B[:, 0] *= what == "EI"
            batch.B[:, 1] *= what == "CB"
        if isinstance(batch, EndBendingBatch):
            batch.E[:, 0] *= what == "EI"
            batch.E[:, 1] *= what == "CB"


def random_state(system, rng, scale=1.0, speed=1.0, fold=None, big=False, sink=0.0, step=None, flow=False,
                 moving=False):  # fmt: skip
    """Scratch with a random configuration, velocity, acceleration and multipliers around the drawing position."""
    w = system.work()
    system.load(w, system.initial_state())
    w.still = not moving  # no waves, no memory: what is left is a function of q, v and a
    system.begin(w, system.initial_state(), 0.4)
    if flow:
        w.u[:], w.du[:], w.eta[:] = rng.uniform(-1, 1, w.u.shape), rng.uniform(-1, 1, w.u.shape), 0.1
    for i in free_unknowns(system):
        turn = i >= 3 * system.n_point
        displace(system, w, i, rng.uniform(-1, 1) * (0.8 if turn else scale * (5.0 if big else 1.0)))
    if fold is not None:
        angle, d = np.radians(fold), w.x[1] - w.x[0]
        n = np.cross(d, rng.uniform(-1, 1, 3))
        n /= np.linalg.norm(n)
        w.x[2] = w.x[1] + 0.9 * (np.cos(angle) * d + np.sin(angle) * np.cross(n, d))
    w.x[: system.n_point, 2] -= sink
    free = free_unknowns(system)
    free = free[free < system.n_dof]
    w.v[free] = speed * rng.uniform(-1, 1, len(free))
    w.a[free] = rng.uniform(-1, 1, len(free))
    w.lam[:] = 10.0 * rng.uniform(-1, 1, system.n_con)
    return w


def differences(system, w, kind, step):
    """The matrix of one kind (0: M, 1: C, 2: K with G) by central differences of the residual."""
    free = free_unknowns(system)
    out = np.zeros((system.n, system.n))
    w.c[3] = 1.0
    for i in free:
        if i >= system.n_dof and kind < 2:
            continue
        saved = [y.copy() for y in (w.x, w.q, w.R, w.v, w.a, w.lam)]
        for factor, weight in STENCIL:
            for sign in (1.0, -1.0):
                by = sign * factor * step
                if kind == 2:
                    displace(system, w, i, by)
                else:
                    (w.a, w.v)[kind][i] += by
                out[:, i] += sign * weight * residual(system, w) / step
                for y, old in zip((w.x, w.q, w.R, w.v, w.a, w.lam), saved, strict=True):
                    np.copyto(y, old)
    return out


# a floater at rest is left out: differences see the kink of its |nu| nu there
CASES = [(name, moving) for name in SYSTEMS for moving in (True, False) if moving or name != "floater"]


@pytest.mark.parametrize(("name", "moving"), CASES)
def test_matrix_is_derivative_of_residual(name, moving, record):
    model, what, how = SYSTEMS[name]
    system = fs.assemble(model())
    if what is not None:
        keep_alone(system, what)
    free = free_unknowns(system)
    how = dict(how) if moving else dict(how) | {"speed": 0.0}
    step = how.get("step", 4e-3)
    worst, kinks, entries = 0.0, 0, 0
    for seed in range(4):
        w = random_state(system, np.random.default_rng(seed), **how)
        size = np.abs(residual(system, w)).max()
        for kind, c in enumerate(((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 1.0))):
            exact = matrix(system, w, c)[np.ix_(free, free)]
            largest = np.abs(exact).max()
            found = []
            for h in (step, step / 20.0):
                near = differences(system, w, kind, h)[np.ix_(free, free)]
                noise = 1e-15 * size / h  # rounding of the residual, seen through the step
                gap = np.maximum(np.abs(exact - near) - noise, 0.0)
                found.append((near, gap / np.maximum(np.abs(exact), 1e-6 * largest + 1e-300)))
            error = np.minimum(found[0][1], found[1][1])
            # a kink within the stencil makes the two differences disagree: such an entry has no derivative to compare
            kink = np.abs(found[0][0] - found[1][0]) > 1e-5 * largest
            error[kink] = 0.0
            kinks, entries = kinks + int(kink.sum()), entries + error.size
            i, j = np.unravel_index(error.argmax(), error.shape)
            if error[i, j] > 1e-6:
                print(
                    f"{'MCK'[kind]}[{i}, {j}] = {exact[i, j]:.9e}, by differences {near[i, j]:.9e}, max {largest:.2e}"
                )
            worst = max(worst, float(error[i, j]))
    assert kinks <= 0.005 * entries
    record("tangents against central differences", f"{name}, {'moving' if moving else 'at rest'}", worst, 1e-6)


def test_everything_registered_is_here():
    """Every batch class of the package appears in a system above, and both kinds of constraint rows."""
    import inspect
    import pkgutil

    import floatsim

    here = set()
    rows = set()
    for model, _, _ in SYSTEMS.values():
        system = fs.assemble(model())
        here |= {type(batch) for batch in system.batches}
        rows |= {"points"} if system.constraints.points else set()
        rows |= {"axes"} if system.constraints.axes else set()
    registered = set()
    for folder in ("parts", "hydro"):
        for item in pkgutil.iter_modules([str(next(iter(floatsim.__path__))) + "/" + folder]):
            module = __import__(f"floatsim.{folder}.{item.name}", fromlist=["*"])
            registered |= {
                cls for _, cls in inspect.getmembers(module, inspect.isclass)
                if cls.__module__ == module.__name__ and hasattr(cls, "add") and hasattr(cls, "dofs")
            }  # fmt: skip
    assert registered <= here, f"no tangent test for {registered - here}"
    assert rows == {"points", "axes"}


@pytest.mark.parametrize(("turn", "sprung"), [(0.05, True), (0.15, True), (0.3, False)])
def test_cost_of_what_is_left_out(turn, sprung, record):
    """Newton iterations of a fast top that turns by up to 0.1, 0.4 and 0.3 rad a step, two of them against a spring."""
    body = fs.Body(name="top", mass=15.0, inertia=(2.0, 3.0, 4.0), position=(0, 1, 5),
                   points={"pivot": (0, -1, 0), "eye": (0, 1, 0)})  # fmt: skip
    spring = fs.Spring(name="spring", a="top.eye", b=(3, 3, 9), stiffness=2e3, free_length=1.0)
    parts = [body, spring] if sprung else [body]
    system = fs.assemble(fs.Model(parts=parts, joints=[fs.Ball(a="top.pivot", b=(0, 0, 5))], sea=AIR))
    state = system.initial_state()
    state.v[6:9] = (6.0, 3.0, 9.0)
    state.v[:3] = np.cross(state.v[6:9], (0, 1, 0))
    h = turn / np.linalg.norm(state.v[6:9])
    stepper = fs.Stepper(system)
    stepper.start(state, h)
    iterations, turns = [], []
    for _ in range(100):
        report = stepper.step(state, h)
        assert report.converged, report
        iterations.append(report.iterations)
        turns.append(h * np.linalg.norm(state.v[6:9]))
    check = "Newton iterations without the exponential map's tangent"
    record(
        check,
        f"top turning by up to {max(turns):.1f} rad a step, {'sprung' if sprung else 'free'}: most",
        max(iterations),
        8,
    )
