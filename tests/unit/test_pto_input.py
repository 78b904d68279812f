"""PTOs: what is refused and how it is said, names of outputs, mean power, what tables and hydraulics say on the way."""

import numpy as np
import pytest
from pto_joints import Loose, Pin

import floatsim as fs
from floatsim.parts.pto import PTO
from floatsim.pto_laws.coulomb import Coulomb
from floatsim.pto_laws.end_stop import EndStop
from floatsim.pto_laws.force_table import ForceTable, interpolate
from floatsim.pto_laws.hydraulic import Hydraulic
from floatsim.pto_laws.linear import Linear
from floatsim.pto_laws.one_sided import TensionOnly
from floatsim.pto_laws.polynomial import Polynomial
from floatsim.pto_laws.runge_kutta import solve
from floatsim.pto_laws.taut_mooring import TautMooring
from floatsim.pto_laws.user_law import UserLaw
from floatsim.study.power import capture_width, mean_power, wave_power

SEA = fs.Sea(depth=100.0)
LAW = Linear(damping=1.0)
OIL = dict(area=0.02, stroke=6.0, high_pressure=9e6, low_pressure=1e6, high_gas_volume=0.5, low_gas_volume=1.0,
           motor_displacement=2e-5, generator_damping=1.6, motor_inertia=2.0, valve_area=1e-3)  # fmt: skip


def table(**more):
    return ForceTable(**(dict(displacement=(0, 1), velocity=(0, 1), force=((0, 0), (0, 0))) | more))


REFUSED = [
    (lambda: Linear(damping=-1.0), "Linear: damping: got -1.0; must be a number that is not negative"),
    (lambda: Linear(stiffness="3"), "Linear: stiffness: got the text '3'"),
    (lambda: Polynomial(damping=(1.0, -2.0)), "Polynomial: damping: its coefficient of order 2 is -2; none may be"),
    (lambda: Polynomial(), "Polynomial: it has no coefficients"),
    (lambda: Coulomb(friction=1.0, speed=0.0), "Coulomb: speed: got 0.0; must be a positive number"),
    (lambda: EndStop(stiffness=1.0), "EndStop: it has neither lower nor upper"),
    (lambda: EndStop(lower=1.0, upper=-1.0, stiffness=1.0), "EndStop: lower is 1 and upper -1; lower must be below"),
    (lambda: EndStop(upper=1.0, stiffness=1.0, damping=-1.0), "EndStop: damping: got -1.0"),
    (lambda: TensionOnly(stiffness=-1.0), "TensionOnly: stiffness: got -1.0"),
    (lambda: TautMooring(pretension=-1.0, EA=1.0, length=1.0), "TautMooring: pretension: got -1.0"),
    (lambda: table(displacement=(1, 0)), "ForceTable: displacement does not increase from value 0 (1) to value 1 (0)"),
    (lambda: table(velocity=(0, 1, 1), force=((0, 0, 0),) * 2), "velocity does not increase from value 1 (1)"),
    (lambda: table(velocity=(0,)), "ForceTable: velocity has 1 values; at least 2"),
    (lambda: table(force=((0, 0), (0,))), "ForceTable: force has 2 rows of [1, 2] values; 2 rows (displacements) of 2"),
    (lambda: table(force=((0, 0), (0, np.nan))), "ForceTable: force: row 1, column 1 is nan; finite numbers"),
    (lambda: table(force=3.0), "ForceTable: force: got 3.0; rows of numbers"),
    (lambda: table(interpolation="cubic"), "ForceTable: interpolation: got 'cubic'"),
    (lambda: Hydraulic(**OIL | {"area": -1.0}), "Hydraulic: area: got -1.0; must be a positive number"),
    (lambda: Hydraulic(**OIL | {"low_pressure": 1e7}), "Hydraulic: high_pressure is 9e+06 Pa, low_pressure 1e+07 Pa"),
    (lambda: UserLaw(function=3.0), "UserLaw: function: got 3.0; a function of t, s, v"),
    (lambda: UserLaw(function=abs, states=(1.0,), names=["a", "b"]), "UserLaw: names: got 2 names for 1 states"),
    (lambda: UserLaw(function=abs, sample_time=-1.0), "UserLaw: sample_time: got -1.0"),
    (lambda: PTO(name="p", laws=[LAW]), "PTO 'p': give either joint='LABEL' or both a and b"),
    (lambda: PTO(name="p", joint="j", a="x", laws=[LAW]), "PTO 'p': give either joint='LABEL' or both a and b"),
    (lambda: PTO(name="p", a="x", laws=[LAW]), "PTO 'p': give either joint='LABEL' or both a and b"),
    (lambda: PTO(name="p", a="x", b="y", coordinate="slide", laws=[LAW]), "PTO 'p': coordinate belongs to a joint"),
    (lambda: PTO(name="p", joint="j", laws=[]), "PTO 'p': laws: got none"),
    (lambda: PTO(name="p", joint="j", laws=[3]), "PTO 'p': laws: got 3; laws such as Linear"),
    (lambda: PTO(name="p", joint="j", laws=[Linear]), "PTO 'p': laws: got <class"),
    (lambda: PTO(name="p", joint="j", laws=LAW), "PTO 'p': laws: got"),
]  # fmt: skip


@pytest.mark.parametrize(("build", "said"), REFUSED)
def test_refused(build, said):
    with pytest.raises(fs.ModelError) as error:
        build()
    assert said in str(error.value)


def model(*ptos, joints=None, laws=None, **more):
    bob = fs.Body(name="bob", mass=2.0, inertia=(1, 1, 1), position=(0, 0, 5), points={"eye": (0, 0, 1)})
    if laws is not None:
        ptos = (*ptos, PTO(name="pto", joint="j", coordinate="slide", laws=laws, **more))
    return fs.Model(parts=[bob, *ptos], joints=joints or [Loose(a="bob", b=(0, 0, 5), name="j")], sea=SEA)


@pytest.mark.parametrize(
    ("pto", "said"),
    [
        (dict(joint="jj"), "PTO 'p': there is no joint 'jj'"),
        (dict(joint="ball"), "PTO 'p': joint 'ball' is a Ball, which has no coordinate to act along"),
        (dict(a="bob", b="bob.ey"), "PTO 'p': there is no connection point 'bob.ey' (did you mean 'bob.eye'?)"),
        (dict(a="bob", b="bob.eye"), "PTO 'p': both ends are of 'bob'"),
        (dict(a="bob", b=(0, 0, 5)), "PTO 'p': its two ends start at the same place"),
    ],
)
def test_refused_by_the_model(pto, said):
    joints = [Loose(a="bob", b=(0, 0, 5), name="j"), fs.Ball(a="bob.eye", b=(0, 0, 6), name="ball")]
    with pytest.raises(fs.ModelError) as error:
        model(PTO(name="p", laws=[LAW], **pto), joints=joints)
    assert said in str(error.value)


@pytest.mark.parametrize(
    ("coordinate", "said"),
    [
        (None, "none was chosen of the coordinates of joint 'j': 'slide', 'turn'"),
        ("swing", "there is no 'swing' of the coordinates of joint 'j': 'slide', 'turn'"),
    ],
)
def test_coordinate_of_a_joint(coordinate, said):
    with pytest.raises(fs.ModelError) as error:
        fs.assemble(model(PTO(name="p", joint="j", coordinate=coordinate, laws=[LAW])))
    assert said in str(error.value)


def test_outputs_and_units():
    hinge = Pin(a="bob", b=(0, 0, 5), axis=(0, 1, 0), name="hinge")
    ptos = [PTO(name="p", joint="hinge", laws=[LAW]), PTO(name="q", a="bob.eye", b=(0, 0, 9), laws=[Hydraulic(**OIL)])]
    run = fs.simulate(model(*ptos, joints=[hinge]), 0.2, 0.1)
    data = run.dataset()
    units = {name: data[name].attrs["units"] for name in data if name[:2] in ("p_", "q_", "hi")}
    assert units == {
        "p_displacement": "rad", "p_velocity": "rad/s", "p_force": "N m", "p_power": "W", "p_energy": "J",
        "q_displacement": "m", "q_velocity": "m/s", "q_force": "N", "q_power": "W", "q_energy": "J",
        "q_high_pressure": "Pa", "q_low_pressure": "Pa", "q_motor_speed": "rad/s", "q_generator_power": "W",
        "hinge_angle": "rad", "hinge_rate": "rad/s", "hinge_force": "N", "hinge_moment": "N m",
    }  # fmt: skip
    assert run.series("q_displacement")[0] == 0.0  # from the drawing


def failure(laws, v=1.0, duration=5.0, **more):
    system = fs.assemble(model(laws=laws, **more))
    state = system.initial_state()
    state.v[2] = v
    run = fs.simulate(system, duration, 0.05, state=state)
    assert run.status == "failed"
    return run.failure


def test_leaving_the_table_is_said():
    assert "PTO 'pto': its displacement is -1.0" in failure([table(displacement=(-1, 1), velocity=(-99, 99))])
    said = failure([table(displacement=(-99, 99), velocity=(-2, 2))])
    assert "PTO 'pto': its velocity is -2" in said and "outside its table from -2 to 2" in said


def test_leaving_the_cylinder_is_said():
    assert "PTO 'pto': its piston leaves the cylinder" in failure([Hydraulic(**OIL | {"stroke": 0.1, "area": 1e-6})])


def test_cavitation_is_said():
    assert "the oil would cavitate" in failure([Hydraulic(**OIL | {"valve_area": 1e-9, "area": 1e-5})], v=5.0)


def test_failing_user_function_is_said():
    def law(t, s, v):
        if t > 0.3:
            raise KeyError("gain")
        return 0.0

    said = failure([UserLaw(function=law)])
    assert "PTO 'pto': its function at t = 0.3" in said and "KeyError: 'gain'" in said
    for function, words in ((lambda t, s, v: "x", "it must return force"), (lambda t, s, v: np.nan, "returns nan")):
        with pytest.raises(fs.ModelError, match=words):
            fs.assemble(model(laws=[UserLaw(function=function)])).initial_state()
    with pytest.raises(fs.ModelError, match="returns 2 states; it has 1"):
        wrong = UserLaw(function=lambda t, s, v, y: (0.0, [1.0, 2.0]), states=(0.0,))
        fs.assemble(model(laws=[wrong])).initial_state()


def test_statics_says_what_is_wrong():
    with pytest.raises(fs.SolveFailed, match="outside its table from -1 to 1") as error:
        fs.solve_static(fs.assemble(model(laws=[table(displacement=(-1, 1), velocity=(-1, 1)),
                                                Linear(stiffness=1.0)])))  # fmt: skip
    assert "bend" not in str(error.value)


def test_static_position_on_a_spring():
    """m g = k (z - free): from a stop below too."""
    laws = [Linear(stiffness=10.0, preload=4.0, free_position=0.5)]
    turn = PTO(name="turn", joint="j", coordinate="turn", laws=[Linear(stiffness=1.0)])
    system = fs.assemble(model(turn, joints=[Ring(a="bob", b=(0, 0, 5), name="j")], laws=laws))
    state, _ = fs.solve_static(system)
    assert np.isclose(state.x[0, 2] - 5.0, 0.5 + (4.0 - 2.0 * 9.81) / 10.0, atol=1e-5)


class Ring(Loose):
    """A slide that really is one: no sideways motion, no turning but about the axis."""

    def rows(self, place, attitude):
        from floatsim.joints.constraints import Align

        a, b = place(self.a), place(self.b)
        x, y, z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
        return [Align(a.rotation, z, b.rotation, x), Align(a.rotation, z, b.rotation, y)]


def test_smooth_table_goes_through_its_nodes_and_is_smooth():
    """Values at nodes; slopes continuous over the edges of cells; bilinear data are reproduced exactly."""
    rng = np.random.default_rng(0)
    x, y = np.array([-2.0, -0.5, 0.1, 2.0]), np.array([-1.0, 0.3, 1.0])
    law = ForceTable(displacement=x, velocity=y, force=rng.uniform(-1, 1, (4, 3)))
    T, out, near = law.nodes(), np.zeros(3), np.zeros(3)
    for i, s in enumerate(x):
        for j, v in enumerate(y):
            interpolate(x, y, T, True, s, v, out)
            assert np.isclose(out[0], law.force[i][j])
    for s, v in ((-0.5, 0.7), (0.1, -0.2), (1.3, 0.3)):
        interpolate(x, y, T, True, s - 1e-9, v - 1e-9, out)
        interpolate(x, y, T, True, s + 1e-9, v + 1e-9, near)
        assert np.allclose(out, near, atol=1e-7)
    plane = ForceTable(displacement=x, velocity=y, force=2.0 * x[:, None] - 3.0 * y[None, :])
    for smooth, nodes in ((True, plane.nodes()), (False, plane.model_copy(update={"interpolation": "linear"}).nodes())):
        interpolate(x, y, nodes, smooth, 0.7, -0.4, out)
        assert np.allclose(out, (2.6, 2.0, -3.0))


def test_small_solve():
    rng = np.random.default_rng(3)
    A, b = rng.normal(size=(5, 5)), rng.normal(size=(5, 2))
    A[1] *= 1e9
    x = b.copy()
    assert solve(A.copy(), x)
    assert np.allclose(A @ x, b)
    assert not solve(np.zeros((2, 2)), np.zeros((2, 1)))


def test_mean_power_and_capture_width():
    """A damper driven at a steady speed: P = c v^2; flux of a regular wave in deep water: rho g^2 H^2 T/(32 pi)."""
    sea = fs.Sea(depth=3000.0, density=1025.0, waves=fs.RegularWave(height=2.0, period=8.0))
    motion = fs.Motion.at_speed((0, 0, 5), (0, 0, 25), 2.0, ramp=1.0)
    bob = fs.PointMass(name="bob", mass=1.0, position=(0, 0, 5))
    joints = [fs.Prescribed(a="bob", motion=motion), Loose(a="bob", b=(0, 0, 5), name="j", turns=False)]
    ptos = [PTO(name=name, joint="j", laws=[Linear(damping=30.0)]) for name in ("one", "two")]
    run = fs.simulate(fs.Model(parts=[bob, *ptos], joints=joints, sea=sea), 6.0, 0.1)
    assert np.isclose(mean_power(run, "one", since=2.0), 30.0 * 4.0, rtol=1e-4)
    assert np.isclose(mean_power(run, ["one", "two"], since=2.0), 240.0, rtol=1e-4)
    flux = 1025.0 * 9.81**2 * 4.0 * 8.0 / (32.0 * np.pi)
    assert np.isclose(wave_power(run), flux, rtol=1e-4)
    assert np.isclose(capture_width(run, "one", since=2.0), 120.0 / flux, rtol=1e-3)
    with pytest.raises(fs.CaseError, match="since is 99 s"):
        mean_power(run, "one", since=99.0)
    with pytest.raises(fs.CaseError, match="there is no 'three_energy'"):
        mean_power(run, "three")
