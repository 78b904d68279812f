"""Output channels against statics that can be done by hand, and closed forms."""

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
    assert after[:-2] == pytest.approx(sampler.sample_state(state)[:-2], rel=1e-12, abs=1e-12)


def test_selection_keeps_the_values(hanging):
    system, state = hanging
    everything = Sampler(system)
    some = Sampler(system, ["rope_tension", "bob_position", "step_size"])
    assert [c.name for c in some.channels] == ["rope_tension", "bob_position", "step_size"]
    assert {c.dim for c in some.coordinates} == {"rope_element", "xyz"}
    a, b = named(everything, everything.sample_state(state)), named(some, some.sample_state(state))
    for name, value in b.items():
        assert (value == a[name]).all()


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
