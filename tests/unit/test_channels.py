"""Output channels against statics that can be done by hand, and closed forms."""

from pathlib import Path

import numpy as np
import pytest

import floatsim as fs
from floatsim.errors import CaseError
from floatsim.frames import matrix_from_angles, quaternion_from_matrix
from floatsim.sea.waves import RegularWave
from floatsim.study.channels import Sampler
from floatsim.study.store import Writer

G = 9.81
ROPE = fs.Section(name="rope", mass_per_length=5.0, diameter=0.05, EA=1e7, axial_damping=1e4)
CABLE = fs.Section(name="cable", mass_per_length=20.0, diameter=0.1, EA=1e8, EI=2e5)


def model(*parts, joints=(), **sea):
    return fs.Model(parts=parts, joints=joints, sea=fs.Sea(depth=200.0, **sea), gravity=G)


def named(sampler, row):
    """Channel name -> its values, flat."""
    sizes = {c.dim: len(c.values) for c in sampler.coordinates}
    out, start = {}, 0
    for channel in sampler.channels:
        shape = tuple(sizes[d] for d in channel.dims)
        n = int(np.prod(shape, dtype=int))
        out[channel.name] = row[start : start + n].reshape(shape)
        start += n
    assert start == len(row) == sampler.width
    return out


@pytest.fixture(scope="module")
def hanging():
    """A mass of 100 kg on 40 m of rope in air, 10 elements, hung from (0, 0, 100)."""
    system = fs.assemble(
        model(
            fs.Line(name="rope", section=ROPE, length=40.0, elements=10),
            fs.PointMass(name="bob", mass=100.0, position=(0.0, 0.0, 60.5)),
            joints=[fs.Ball(a="rope.end_a", b=(0.0, 0.0, 100.0)), fs.Ball(a="bob", b="rope.end_b", name="hook")],
        )
    )
    return system, fs.solve_static(system)[0]


def test_end_forces_and_tension_of_a_hanging_line(hanging):
    system, state = hanging
    sampler = Sampler(system)
    out = named(sampler, sampler.sample_state(state))
    bob, rope = 100.0 * G, 40.0 * 5.0 * G
    # the ground is pulled down by everything, the bob up by its own weight
    assert out["rope_end_a_force"] == pytest.approx([0.0, 0.0, -(bob + rope)], rel=1e-6, abs=1e-3)
    assert out["rope_end_b_force"] == pytest.approx([0.0, 0.0, bob], rel=1e-6, abs=1e-3)
    # the joint's force is that of its side a, the bob, on the rope
    assert out["hook_force"] == pytest.approx([0.0, 0.0, -bob], rel=1e-6, abs=1e-3)
    below = np.arange(10)[::-1] + 0.5  # element lengths below the middle of each element
    assert out["rope_tension"] == pytest.approx(bob + below * 4.0 * 5.0 * G, rel=1e-6)
    assert out["rope_curvature"] == pytest.approx(0.0, abs=1e-6)
    assert out["rope_position"].shape == (11, 3)
    assert out["rope_position"][0] == pytest.approx([0.0, 0.0, 100.0], abs=1e-6)
    assert out["bob_position"] == pytest.approx(out["rope_position"][-1], abs=1e-6)


def test_ball_joint_form_gives_the_same_channels(hanging):
    system, state = hanging
    other = fs.assemble(
        model(
            fs.Line(name="rope", section=ROPE, length=40.0, elements=10, form="ball_joints"),
            fs.PointMass(name="bob", mass=100.0, position=(0.0, 0.0, 60.5)),
            joints=[fs.Ball(a="rope.end_a", b=(0.0, 0.0, 100.0)), fs.Ball(a="bob", b="rope.end_b", name="hook")],
        )
    )
    one, two = Sampler(system), Sampler(other)
    a = named(one, one.sample_state(state))
    b = named(two, two.sample_state(fs.solve_static(other)[0]))
    assert a.keys() == b.keys()
    for name in ("rope_position", "rope_tension", "rope_end_a_force", "rope_end_b_force"):
        assert b[name] == pytest.approx(a[name], rel=1e-6, abs=1e-3)


def test_a_free_end_has_no_force():
    system = fs.assemble(
        model(
            fs.Line(name="rope", section=ROPE, length=10.0, elements=3, end_b_position=(0.0, 0.0, 20.0)),
            joints=[fs.Ball(a="rope.end_a", b=(0.0, 0.0, 30.0))],
        )
    )
    sampler = Sampler(system, ["rope_end_a_force", "rope_end_b_force"])
    out = named(sampler, sampler.sample_state(fs.solve_static(system)[0]))
    assert out["rope_end_a_force"] == pytest.approx([0.0, 0.0, -50.0 * G], rel=1e-6, abs=1e-4)
    assert (out["rope_end_b_force"] == 0.0).all()


def test_body_channels_of_a_known_state():
    drawn = (10.0, -5.0, 3.0)
    system = fs.assemble(model(fs.Body(name="box", mass=1.0, inertia=(1.0, 1.0, 1.0), position=drawn)))
    state = system.initial_state()
    angles = (0.3, -0.7, 2.1)
    state.x[0] = np.array(drawn) + [1.0, 2.0, -0.5]
    state.q[0] = quaternion_from_matrix(matrix_from_angles(*angles))
    n = 3 * (system.n_point + 1)
    state.v[:3], state.v[n : n + 3] = (1.0, 2.0, 3.0), (4.0, 5.0, 6.0)
    state.a[:3], state.a[n : n + 3] = (-1.0, -2.0, -3.0), (-4.0, -5.0, -6.0)
    sampler = Sampler(system)
    out = named(sampler, sampler.sample_state(state))
    assert out["box_position"] == pytest.approx([1.0, 2.0, -0.5, *angles], abs=1e-12)
    assert out["box_velocity"] == pytest.approx([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    assert out["box_acceleration"] == pytest.approx([-1.0, -2.0, -3.0, -4.0, -5.0, -6.0])
    assert out["wave_elevation"] == 0.0
    position = sampler.channels[0]
    assert position.units == "mixed" and position.units_dof == "m m m rad rad rad"


@pytest.mark.parametrize("yaw", [0.0, 40.0])
def test_weld_force_and_moment(yaw):
    """A body of 2 t with its centre of mass 3 m along its own x: r x F on the ground."""
    body = fs.Body(name="arm", mass=2000.0, inertia=(1.0, 1.0, 1.0), center_of_mass=(3.0, 0.0, 0.0),
                   position=(0.0, 0.0, 50.0), attitude_deg=(0.0, 0.0, yaw))  # fmt: skip
    system = fs.assemble(model(body, joints=[fs.Weld(a="arm", b=(0.0, 0.0, 50.0), name="root")]))
    sampler = Sampler(system)
    out = named(sampler, sampler.sample_state(fs.solve_static(system)[0]))
    weight = np.array([0.0, 0.0, -2000.0 * G])
    arm = 3.0 * np.array([np.cos(np.radians(yaw)), np.sin(np.radians(yaw)), 0.0])
    assert out["root_force"] == pytest.approx(weight, rel=1e-8, abs=1e-6)
    assert out["root_moment"] == pytest.approx(np.cross(arm, weight), rel=1e-8, abs=1e-4)


def test_clamped_cable_moment_is_that_of_its_weight():
    """A cantilever of 5 m in air: the root carries the moment of all node weights in the deformed shape."""
    system = fs.assemble(
        model(
            fs.Line(name="cable", section=CABLE, length=5.0, elements=10, end_b_position=(4.99, 0.0, 50.0)),
            joints=[fs.Clamp(a="cable.end_a", b=(0.0, 0.0, 50.0), direction=(1.0, 0.0, 0.0), name="root")],
        )
    )
    sampler = Sampler(system)
    out = named(sampler, sampler.sample_state(fs.solve_static(system)[0]))
    x = out["cable_position"][:, 0]
    weights = np.full(11, 0.5 * 20.0 * G)
    weights[0] *= 0.5
    weights[-1] *= 0.5
    moments = np.array([np.sum(weights[k:] * (x[k:] - x[k])) for k in range(11)])
    assert out["root_moment"] == pytest.approx([0.0, moments[0], 0.0], rel=1e-6, abs=1e-3)
    assert out["root_force"] == pytest.approx([0.0, 0.0, -100.0 * G], rel=1e-6, abs=1e-4)
    # bending in the line: linear in the angle, so the inner nodes carry M/cos, a second-order difference
    assert out["cable_bending_moment"][0] == pytest.approx(moments[0], rel=1e-4)
    assert out["cable_bending_moment"][1:-1] == pytest.approx(moments[1:-1], rel=5e-3)
    assert out["cable_bending_moment"][-1] == 0.0
    assert out["cable_bending_moment"] == pytest.approx(CABLE.EI * out["cable_curvature"])


def cantilever(direction=(1.0, 0.0, 0.0), bob=None, load=50.0):
    """5 m of cable clamped at (0, 0, 50), a mass at its tip: named outputs at rest. bob: hung at the clamp as well."""
    tip = tuple(np.array([0.0, 0.0, 50.0]) + 4.99 * np.array(direction) / np.linalg.norm(direction))
    parts = [fs.Line(name="cable", section=CABLE, length=5.0, elements=10),
             fs.PointMass(name="load", mass=load, position=tip)]  # fmt: skip
    joints = [fs.Clamp(a="cable.end_a", b=(0.0, 0.0, 50.0), direction=direction, name="root"),
              fs.Ball(a="cable.end_b", b="load")]  # fmt: skip
    if bob is not None:
        parts.append(fs.PointMass(name="bob", mass=bob, position=(0.0, 0.0, 50.0)))
        joints.append(fs.Ball(a="bob", b="cable.end_a", name="hook"))
    system = fs.assemble(model(*parts, joints=joints))
    sampler = Sampler(system)
    return named(sampler, sampler.sample_state(fs.solve_static(system)[0]))


@pytest.mark.parametrize("bob", [None, 700.0])
@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (1.0, 1.0, -1.0)])
def test_shear_and_moment_of_a_clamped_end(direction, bob):
    """Shear is the part of load and weight across the clamp's direction; what else hangs there is not the line's."""
    out = cantilever(direction, bob)
    force = np.array([0.0, 0.0, -(50.0 + 5.0 * 20.0) * G])
    e = np.array(direction) / np.linalg.norm(direction)
    assert out["cable_end_a_force"] == pytest.approx(force, rel=1e-6, abs=1e-3)
    assert out["cable_end_a_shear"] == pytest.approx(force - e * (e @ force), rel=1e-6, abs=1e-3)
    assert out["cable_end_a_moment"] == pytest.approx(out["root_moment"])
    x = out["cable_position"] - out["cable_position"][0]
    weights = np.full(11, 0.5 * 20.0 * G)
    weights[-1] = 0.25 * 20.0 * G + 50.0 * G
    moment = np.cross(x, np.outer(weights, [0.0, 0.0, -1.0])).sum(axis=0)
    assert out["cable_end_a_moment"] == pytest.approx(moment, rel=1e-5, abs=0.1)
    # half an element of 0.5 m bends under it
    assert out["cable_end_a_clamp_angle"] == pytest.approx(np.linalg.norm(moment) * 0.25 / 2e5, rel=1e-3)
    assert "cable_end_b_shear" not in out and "cable_end_b_clamp_angle" not in out


def test_a_clamp_named_like_its_end_has_one_moment():
    parts = [fs.Line(name="cable", section=CABLE, length=5.0, elements=4, end_b_position=(4.9, 0.0, 50.0))]
    joints = [fs.Clamp(a="cable.end_a", b=(0.0, 0.0, 50.0), direction=(1.0, 0.0, 0.0))]
    names = [c.name for c in Sampler(fs.assemble(model(*parts, joints=joints))).channels]
    assert names.count("cable_end_a_moment") == 1


CHAIN = fs.Section(name="chain", mass_per_length=200.0, diameter=0.1, EA=1e11)
WET = (200.0 - 1025.0 * np.pi * 0.01 / 4.0) * G  # N/m


def catenary(lying, upper, elements=60):
    """A chain from a fairlead at z = -50 to the bed at -200: closed form of the catenary with `lying` metres beyond.

    The suspended length over a level bed is s = sqrt(h^2 + 2 h a) for a = H/w, its span a asinh(s/a).
    """
    h, a = 150.0, 120.0
    s = np.sqrt(h * h + 2.0 * h * a)
    low, high = (a * np.arcsinh(s / a) + lying, 0.0, -200.0), (0.0, 0.0, -50.0)
    ends = (low, high) if upper == "b" else (high, low)
    line = fs.Line(name="chain", section=CHAIN, length=s + lying, elements=elements)
    joints = [fs.Ball(a="chain.end_a", b=ends[0]), fs.Ball(a="chain.end_b", b=ends[1])]
    system = fs.assemble(model(line, joints=joints))
    sampler = Sampler(system)
    return named(sampler, sampler.sample_state(fs.solve_static(system)[0])), s, a, (s + lying) / elements


@pytest.mark.parametrize("upper", ["a", "b"])
@pytest.mark.parametrize("lying", [100.0, 101.4, 102.8, 104.2])
def test_touchdown_and_declination_of_a_catenary(lying, upper):
    out, s, a, l0 = catenary(lying, upper)
    assert out["chain_touchdown"] == pytest.approx(lying if upper == "b" else s, abs=0.05 * l0)
    # the outermost element: V there is the weight below its middle; declinations are of the way from a to b
    lean = np.arctan(a / (s - 0.5 * l0))
    assert out[f"chain_end_{upper}_angle"] == pytest.approx(lean if upper == "b" else np.pi - lean, abs=2e-4)
    other = "a" if upper == "b" else "b"
    sunk = WET / (3.0e6 * 0.1)  # into the default seabed, from its surface at the anchor
    slant = np.arctan(sunk / l0) if other == "a" else -np.arctan(sunk / l0)
    assert out[f"chain_end_{other}_angle"] == pytest.approx(0.5 * np.pi + slant, abs=5e-5)
    # and with the forces: end force less half an element
    f = np.abs(out[f"chain_end_{upper}_force"])
    assert np.tan(lean) == pytest.approx(f[0] / (f[2] - 0.5 * WET * l0), rel=1e-3)


def test_touchdown_moves_evenly_as_a_line_is_laid():
    """Closed form to a twentieth of an element all the way through one, without steps."""
    gone = [catenary(lying, "b", elements=40)[0]["chain_touchdown"] - lying for lying in np.arange(100.0, 109.0, 0.9)]
    assert np.ptp(gone) < 0.05 * 8.5


def test_touchdown_of_lines_that_hang_stand_and_lie(hanging):
    system, state = hanging
    sampler = Sampler(system, ["rope_touchdown", "rope_end_a_angle"])
    touchdown, angle = sampler.sample_state(state)
    assert np.isnan(touchdown) and angle == pytest.approx(np.pi)  # straight down
    # held down by an anchor at the bed, and lying on it all along
    for end, where in (((0.0, 0.0, -151.0), 50.0), ((49.9, 0.0, -200.0), 0.0)):
        line = fs.Line(name="chain", section=CHAIN, length=50.0, elements=10, taut=True)
        lower = (0.0, 0.0, -200.0)
        joints = [fs.Ball(a="chain.end_a", b=end), fs.Ball(a="chain.end_b", b=lower)]
        system = fs.assemble(model(line, joints=joints))
        state, _ = fs.solve_static(system)
        if where:  # straight from end to end
            state.x[:11] = np.linspace(end, lower, 11)
        assert Sampler(system, ["chain_touchdown"]).sample_state(state) == pytest.approx(where)


def test_clearance_over_a_slope_and_a_grid():
    line = fs.Line(name="chain", section=CHAIN, length=50.0, elements=2, end_a_position=(-10.0, 5.0, -20.0),
                   end_b_position=(30.0, 15.0, -30.0), taut=True)  # fmt: skip
    beds = [
        fs.Seabed(slope=(0.1, -0.2)),
        fs.Seabed(bathymetry=fs.Bathymetry(x=(-100.0, 0.0, 100.0), y=(-100.0, 0.0, 100.0),
                                           z=[[-200.0 + 0.1 * x - 0.2 * y for y in (-100.0, 0.0, 100.0)]
                                              for x in (-100.0, 0.0, 100.0)])),
    ]  # fmt: skip
    for bed in beds:
        system = fs.assemble(model(line, seabed=bed))
        state = system.initial_state()
        x, y, z = state.x[:3].T
        out = Sampler(system, ["chain_clearance"]).sample_state(state)
        assert out == pytest.approx(z - (-200.0 + 0.1 * x - 0.2 * y), rel=1e-12)


def test_utilisation_of_the_pieces_that_have_limits():
    strong = fs.Section(name="strong", mass_per_length=5.0, diameter=0.05, EA=1e7, breaking_load=2e4)
    line = fs.Line(name="rope", pieces=[fs.Piece(section=ROPE, length=20.0, elements=2),
                                        fs.Piece(section=strong, length=20.0, elements=2)])  # fmt: skip
    bob = fs.PointMass(name="bob", mass=100.0, position=(0.0, 0.0, 60.5))
    joints = [fs.Ball(a="rope.end_a", b=(0.0, 0.0, 100.0)), fs.Ball(a="bob", b="rope.end_b")]
    system = fs.assemble(model(line, bob, joints=joints))
    sampler = Sampler(system)
    out = named(sampler, sampler.sample_state(fs.solve_static(system)[0]))["rope_tension_utilisation"]
    assert np.isnan(out[:2]).all()
    assert out[2:] == pytest.approx([(100.0 + 75.0) * G / 2e4, (100.0 + 25.0) * G / 2e4], rel=1e-6)
    assert "rope_curvature_utilisation" not in {c.name for c in sampler.channels}


def test_curvature_utilisation_is_that_of_the_stricter_side():
    """Two halves of 0.5 m with one moment: angle = M (0.5/EI_1 + 0.5/EI_2), so the soft one bends by M/EI_2."""
    def section(name, EI, radius):
        return fs.Section(name=name, mass_per_length=5.0, diameter=0.05, EA=1e7, EI=EI, minimum_bend_radius=radius)

    for stiff, soft, expected in ((2.0, 3.0, 3.0 / 2e4), (50.0, 3.0, 50.0 / 2e5), (2.0, None, 2.0 / 2e5)):
        pieces = [fs.Piece(section=section("stiff", 2e5, stiff), length=3.0, elements=3),
                  fs.Piece(section=section("soft", 2e4, soft), length=3.0, elements=3)]  # fmt: skip
        line = fs.Line(name="cable", pieces=pieces, end_a_position=(0.0, 0.0, 0.0), end_b_position=(6.0, 0.0, 0.0))
        system = fs.assemble(model(line))
        state = system.initial_state()
        turn = 0.1
        steps = np.cumsum(np.stack([np.cos(turn * np.arange(6)), 0.0 * np.arange(6), np.sin(turn * np.arange(6))]), 1)
        state.x[1:7] = state.x[0] + steps.T
        row = Sampler(system, ["cable_curvature_utilisation"]).sample_state(state)
        M = turn / (0.5 / 2e5 + 0.5 / 2e4)
        assert row[3] == pytest.approx(M * expected)
        assert row[:3] == pytest.approx([0.0, turn * stiff, turn * stiff], abs=1e-9)
        assert np.isnan(row[4:]).all() if soft is None else row[4:] == pytest.approx([turn * soft, turn * soft, 0.0])


def test_curvature_of_an_arc():
    """Nodes on a circle of 20 m: neighbouring chords of one length turn by 2 asin(l/2R)."""
    line = fs.Line(name="cable", section=CABLE, length=8.0, elements=8, end_a_position=(0.0, 0.0, 0.0),
                   end_b_position=(8.0, 0.0, 0.0))  # fmt: skip
    system = fs.assemble(model(line))
    state = system.initial_state()
    turn = 2.0 * np.arcsin(1.0 / 40.0)
    phi = turn * np.arange(9)
    state.x[:9] = 20.0 * np.stack([np.sin(phi), 0.0 * phi, np.cos(phi)], axis=1)
    sampler = Sampler(system, ["cable_curvature"])
    row = sampler.sample_state(state)
    assert row[1:-1] == pytest.approx(turn / 1.0)
    assert row[1:-1] == pytest.approx(1.0 / 20.0, rel=1e-3)
    assert row[0] == row[-1] == 0.0


def test_spring_force_and_wave_elevation():
    wave = RegularWave(height=4.0, period=8.0)
    system = fs.assemble(
        model(
            fs.PointMass(name="bob", mass=10.0, position=(0.0, 0.0, 10.0)),
            fs.Spring(name="spring", a="bob", b=(0.0, 0.0, 15.0), stiffness=100.0, free_length=3.0),
            waves=wave, wave_ramp=0.0,
        )
    )  # fmt: skip
    sampler = Sampler(system)
    state = system.initial_state()
    state.t = 1.3
    out = named(sampler, sampler.sample_state(state))
    assert out["spring_force"] == pytest.approx(200.0)
    assert out["wave_elevation"] == pytest.approx(2.0 * np.cos(2.0 * np.pi * 1.3 / 8.0))


def test_sample_after_a_step_is_that_of_its_state(hanging):
    system, state = hanging
    state = state.copy()
    state.v[3:6] = 0.1
    stepper = fs.Stepper(system)
    stepper.start(state, 0.01)
    report = stepper.step(state, 0.01)
    assert report.converged
    sampler = Sampler(system)
    after = sampler.sample(stepper.work, report.iterations, report.step)
    assert after[-2:] == pytest.approx([report.iterations, 0.01])
    assert after[:-2] == pytest.approx(sampler.sample_state(state)[:-2], rel=1e-12, abs=1e-12, nan_ok=True)


def test_tension_of_a_rope_with_memory_is_that_of_the_step():
    """It carries the mass: memory that has taken in the step already must not count twice."""
    law = fs.StaticDynamic(strain=(0.0, 0.1), tension=(0.0, 1e5), dynamic_stiffness=3e6, relaxation_time=0.2)
    light = fs.Section(name="light", mass_per_length=1e-4, diameter=0.001, EA=1e6, axial_law=law)
    system = fs.assemble(
        model(
            fs.Line(name="rope", section=light, length=10.0, elements=1),
            fs.PointMass(name="bob", mass=100.0, position=(0.0, 0.0, 20.0)),
            joints=[fs.Ball(a="rope.end_a", b=(0.0, 0.0, 30.0)), fs.Ball(a="bob", b="rope.end_b")],
        )
    )
    state = fs.solve_static(system)[0]
    state.v[[5, 8]] = -0.5  # end b and the bob
    stepper = fs.Stepper(system)
    stepper.start(state, 0.02)
    sampler = Sampler(system)
    for _ in range(5):
        assert stepper.step(state, 0.02).converged
        out = named(sampler, sampler.sample(stepper.work))
        assert out["rope_tension"] == pytest.approx(out["rope_end_b_force"][2], rel=1e-4)


def test_selection_keeps_the_values(hanging):
    system, state = hanging
    everything = Sampler(system)
    some = Sampler(system, ["rope_tension", "bob_position", "step_size"])
    assert [c.name for c in some.channels] == ["rope_tension", "bob_position", "step_size"]
    assert {c.dim for c in some.coordinates} == {"rope_element", "xyz"}
    a, b = named(everything, everything.sample_state(state)), named(some, some.sample_state(state))
    for name, value in b.items():
        assert (value == a[name]).all()
    for name in ("rope_end_a_angle", "rope_end_b_force", "rope_clearance", "newton_iterations"):
        one = Sampler(system, [name])
        assert one.sample_state(state) == pytest.approx(np.ravel(a[name]), abs=0.0)


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["rope_tensoin"], "there is no 'rope_tensoin' .did you mean 'rope_tension'"),
        ("rope_tension", "'all' or a list of names"),
        ([], "empty"),
    ],
)
def test_selection_errors(hanging, names, message):
    with pytest.raises(CaseError, match=message):
        Sampler(hanging[0], names)


def test_columns_and_dataset_are_like_the_file(hanging, tmp_path):
    import xarray as xr

    system, state = hanging
    sampler = Sampler(system)
    rows = np.stack([sampler.sample_state(state)] * 3) * np.array([[1.0], [2.0], [3.0]])
    time = np.array([0.0, 0.1, 0.2])
    with Writer(tmp_path / "out.nc", sampler.channels, sampler.coordinates, {"case": "a"}) as writer:
        for t, row in zip(time, rows, strict=True):
            writer.append(t, row)
    assert sampler.column(rows, "rope_position").shape == (3, 11, 3)
    memory = sampler.dataset(time, rows, {"Conventions": "CF-1.8", "case": "a", "failure": "", "status": "done"})
    with xr.open_dataset(tmp_path / "out.nc") as file:
        xr.testing.assert_identical(memory, file)
    with pytest.raises(CaseError, match="did you mean 'rope_tension'"):
        sampler.column(rows, "rope_tenson")


def test_every_channel_of_a_line_is_in_the_documentation():
    section = fs.Section(name="cable", mass_per_length=20.0, diameter=0.1, EA=1e8, EI=2e5, breaking_load=1e5,
                         minimum_bend_radius=2.0)  # fmt: skip
    line = fs.Line(name="cable", section=section, length=5.0, elements=2)
    ends = [("a", (0.0, 0.0, -10.0)), ("b", (4.9, 0.0, -10.0))]
    joints = [fs.Clamp(a=f"cable.end_{e}", b=b, direction=(1.0, 0.0, 0.0), name=f"j_{e}") for e, b in ends]
    names = {c.name for c in Sampler(fs.assemble(model(line, joints=joints))).channels}
    page = (Path(__file__).resolve().parents[2] / "docs" / "output.md").read_text(encoding="utf-8")
    mine = {name.replace("cable_", "L_") for name in names if name.startswith("cable_")}
    assert len(mine) == 18
    assert not [name for name in mine if f"`{name}`" not in page]
