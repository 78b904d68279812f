"""Bad input from Python: one clear message with the object's name, what was got and what is allowed."""

import dataclasses
import importlib.util
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import floatsim as fs
from floatsim.hydro.radiation import RadiationKernel
from floatsim.study.sheet import cautions

MODELS = Path(__file__).parents[2] / "models"
NAN, INF = math.nan, math.inf
SEA = fs.Sea(depth=50.0)
SECTION = {"name": "wire", "mass_per_length": 50.0, "diameter": 0.05, "EA": 2e8}
BODY = {"name": "buoy", "mass": 1.0, "inertia": (1.0, 1.0, 1.0)}
DATABASE = MODELS / "volturnus_s_hydro.nc"


def section(**changes):
    return fs.Section(**{**SECTION, **changes})


def line(**changes):
    return fs.Line(**{"name": "rope", "section": section(), "length": 100.0, "elements": 10, **changes})


def body(**changes):
    return fs.Body(**{**BODY, **changes})


def ball(a, b, **changes):
    return fs.Ball(a=a, b=b, **changes)


def hung(**changes):
    ends = [ball("rope.end_a", (0.0, 0.0, 60.0)), ball("rope.end_b", (80.0, 0.0, 60.0))]
    return fs.Model(**{"name": "hung", "parts": [line()], "joints": ends, "sea": SEA, **changes})


def one_body(joints=(), **changes):
    points = {"p": (1.0, 0.0, 0.0), "q": (2.0, 0.0, 0.0)}
    return fs.Model(parts=[body(points=points, **changes)], joints=joints, sea=SEA)


def model_script(name):
    spec = importlib.util.spec_from_file_location(f"bad_input_{name}", MODELS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def motion(position, velocity=(0.0, 0.0, 0.0), acceleration=(0.0, 0.0, 0.0)):
    def function(values):
        return values if callable(values) else lambda t: values

    return fs.Motion(function(position), function(velocity), function(acceleration))


DESCRIPTIONS = {
    # one argument
    "unknown key": (
        lambda: section(axial_dampin=3.0),
        "Section 'wire'",
        "axial_dampin",
        "did you mean 'axial_damping'",
    ),
    "missing": (
        lambda: fs.Section(name="wire", diameter=0.1, EA=1.0),
        "Section 'wire'",
        "'mass_per_length' is missing",
    ),
    "no names": (lambda: fs.Section("wire"), "Section: got 'wire' without a name", "Section(name=..., ...)"),
    "text": (lambda: section(EA="2e8"), "Section 'wire': EA: got the text '2e8'", "must be a positive number"),
    "decimal comma": (lambda: section(EA="2,5"), "got the text '2,5'", "must be a positive number"),
    "thousands": (lambda: section(EA="1 000"), "got the text '1 000'", "must be a positive number"),
    "boolean": (lambda: section(EA=True), "EA: got True", "must be a positive number"),
    "NumPy boolean": (lambda: section(EA=np.True_), "EA: got np.True_", "must be a positive number"),
    "none": (lambda: section(EA=None), "EA: got None", "must be a positive number"),
    "complex": (lambda: section(EA=1.0 + 1.0j), "EA: got (1+1j)", "must be a positive number"),
    "array": (lambda: section(EA=np.array([1.0, 2.0])), "EA: got array([1., 2.])", "must be a positive number"),
    "NaN": (lambda: section(EA=NAN), "EA: got nan", "must be a positive number"),
    "infinity": (lambda: section(EA=INF), "EA: got inf", "must be a positive number"),
    "huge": (lambda: section(EA=10**400), "EA: got 1000", "must be a positive number"),
    "overflowing": (lambda: section(EA=1e300), "EA: got 1e+300", "a positive number of at most 1e+40"),
    "negative": (lambda: section(EA=-1.0), "EA: got -1.0", "must be a positive number"),
    "zero": (lambda: section(diameter=0), "diameter: got 0", "must be a positive number"),
    "negative EI": (lambda: section(EI=-1.0), "EI: got -1.0", "must be a number that is not negative"),
    "two dampings": (lambda: section(axial_damping=1.0, axial_damping_ratio=1.0), "Section 'wire'", "not both"),
    "damping of no EI": (lambda: section(bending_damping=1.0), "Section 'wire'", "EI is 0"),
    "name": (lambda: section(name="Chain 1"), "Section 'Chain 1': name: got 'Chain 1'", "lower-case letters"),
    "no name": (lambda: section(name=3), "Section: name: got 3", "lower-case letters"),
    "frozen": (lambda: setattr(section(), "EA", 3.0), "Section 'wire': 'EA' cannot be changed"),
    "copy": (lambda: section().model_copy(update={"EA": -1.0}), "Section 'wire': EA: got -1.0"),
    "section": (lambda: line(section="wire"), "Line 'rope': section: got 'wire'", "must be a Section"),
    "length": (lambda: line(length=-850.0), "Line 'rope': length: got -850.0", "must be a positive number"),
    "elements": (lambda: line(elements=10.0), "Line 'rope': elements: got 10.0", "must be a positive whole number"),
    "no elements": (lambda: line(elements=0), "elements: got 0", "must be a positive whole number"),
    "true elements": (lambda: line(elements=True), "elements: got True", "must be a positive whole number"),
    "elements galore": (lambda: line(elements=10**9), "Line 'rope': elements: got 1000000000", "at most 100000"),
    "form": (lambda: line(form="Shared"), "form: got 'Shared'", "must be 'shared' or 'ball_joints'"),
    "flag": (lambda: line(taut=1), "taut: got 1", "must be True or False"),
    "two coordinates": (
        lambda: line(end_a_position=(0.0, 1.0)),
        "end_a_position: got (0.0, 1.0)",
        "three finite numbers",
    ),
    "NaN coordinate": (lambda: line(end_a_position=(0.0, 1.0, NAN)), "got (0.0, 1.0, nan)", "three finite numbers"),
    "mass": (lambda: body(mass=0.0), "Body 'buoy': mass: got 0.0", "must be a positive number"),
    "inertia": (lambda: body(inertia=(1.0, 1.0)), "inertia: got (1.0, 1.0)", "3 finite numbers (xx, yy, zz) or 6"),
    "inertia matrix": (lambda: body(inertia=np.eye(3)), "Body 'buoy': inertia: got array", "3 finite numbers"),
    "negative inertia": (lambda: body(inertia=(1.0, -1.0, 1.0)), "Body 'buoy': inertia", "all must be positive"),
    "triangle": (
        lambda: body(inertia=(1.0, 1.0, 3.0)),
        "Body 'buoy': inertia",
        "cannot exceed the sum of the other two",
    ),
    "point's name": (
        lambda: body(points={"Fair lead": (0, 0, 0)}),
        "Body 'buoy': points.Fair lead",
        "lower-case letters",
    ),
    "points": (lambda: body(points=[(0, 0, 0)]), "Body 'buoy': points: got [(0, 0, 0)]", "must be a dictionary"),
    "hydro": (lambda: body(hydro="hull.nc"), "Body 'buoy': hydro: got 'hull.nc'", "PotentialFlow(database=...)"),
    "spring": (
        lambda: fs.Spring(name="k", a="x", b=(0, 0), stiffness=-1, free_length=1),
        "Spring 'k': b: got (0, 0)",
        "the name of a connection point or a fixed point",
        "Spring 'k': stiffness: got -1",
    ),
    "joint": (lambda: ball("rope.end_a", 3), "Ball: b: got 3", "the name of a connection point or a fixed point"),
    "direction": (
        lambda: fs.Clamp(a="rope.end_a", b="buoy", direction=(0, 0, 0)),
        "Clamp: direction",
        "needs a length",
    ),
    "no motion": (lambda: fs.Prescribed(a="buoy", motion=3), "Prescribed: motion: got 3", "must be a Motion"),
    "depth": (lambda: fs.Sea(depth=-50.0), "Sea: depth: got -50.0", "must be a positive number"),
    "current": (lambda: fs.Sea(depth=50.0, current=1.0), "Sea: current: got 1.0", "must be a Current"),
    "seed": (
        lambda: fs.IrregularWaves(spectrum=fs.Jonswap(hs=1, tp=9), seed="1"),
        "seed: got the text '1'",
        "whole number",
    ),
    "spectrum": (lambda: fs.IrregularWaves(spectrum=3, seed=1), "IrregularWaves: spectrum: got 3", "density(omega)"),
    "no waves": (lambda: fs.WaveComponents(amplitude=[], period=[]), "amplitude: got []", "at least 1"),
    "expected": (lambda: fs.Expected(periods_s={"serge": 3.0}), "'serge'", "did you mean 'surge'"),
    "matrix": (
        lambda: fs.PotentialFlow(database=DATABASE, quadratic_damping=np.zeros((3, 3))),
        "PotentialFlow: quadratic_damping: got array",
        "6 rows of 6 finite numbers",
    ),
    "database": (lambda: fs.PotentialFlow(database=3), "PotentialFlow: database: got 3", "path of a file"),
    "no database": (lambda: fs.PotentialFlow(database="hull.nc"), "hydrodynamic database 'hull.nc'", "No such file"),
    "memory": (
        lambda: fs.PotentialFlow(database=DATABASE, memory_grid=1e-9),
        "PotentialFlow: memory",
        "more than 100000",
    ),
    # motions
    "no function": (
        lambda: fs.Motion((0, 0, 0), (0, 0, 0), (0, 0, 0)),
        "Motion: position: got (0, 0, 0)",
        "function of time",
    ),
    "motion raises": (lambda: motion(lambda t: 1 / 0), "Motion: position(0) fails: ZeroDivisionError"),
    "motion of text": (lambda: motion(("a", "b", "c")), "Motion: position(0) fails: ValueError"),
    "motion of NaN": (lambda: motion((NAN, 0.0, 0.0)), "Motion: position(0) is [nan, 0.0, 0.0]", "finite"),
    "motion of four": (
        lambda: motion((0.0, 0.0, 0.0, 0.0)),
        "Motion: position(0) has shape (4,)",
        "3 (point) or 6 (body)",
    ),
    "other velocity": (
        lambda: motion(lambda t: (t, 0.0, 0.0), (2.0, 0.0, 0.0)),
        "Motion: velocity(0.37) is [2.0, 0.0, 0.0]",
        "must belong together",
    ),
    "other acceleration": (
        lambda: motion(lambda t: (t * t, 0, 0), lambda t: (2 * t, 0, 0), (1.0, 0.0, 0.0)),
        "Motion: acceleration(0.37)",
        "must belong together",
    ),
    "series of text": (lambda: fs.Motion.from_series(["a"] * 4, np.zeros((4, 3))), "Motion.from_series", "numbers"),
    "short series": (lambda: fs.Motion.from_series([0, 1, 2], np.zeros((3, 3))), "Motion.from_series", "n >= 4"),
    "time stands": (lambda: fs.Motion.from_series([0, 1, 1, 2], np.zeros((4, 3))), "does not increase after sample 1"),
}

MODEL_PROBLEMS = {
    "no parts": (lambda: hung(parts=[], joints=[]), "Model 'hung': there are no parts"),
    "no list": (lambda: hung(parts=line()), "Model 'hung': parts", "must be a list"),
    "a class": (lambda: hung(parts=[fs.Line]), "parts: got the class Line itself"),
    "joint among parts": (lambda: hung(parts=[line(), ball("rope.end_a", (0, 0, 0))]), "Ball 'rope_end_a'", "a joint"),
    "part among joints": (lambda: hung(joints=[line()]), "joints: got Line 'rope'", "a part"),
    "section as part": (lambda: hung(parts=[section()]), "parts: got Section 'wire'", "not one of floatsim's parts"),
    "sea": (lambda: hung(sea=None), "Model 'hung': sea: got None", "must be a Sea"),
    "gravity": (lambda: hung(gravity=-9.81), "Model 'hung': gravity: got -9.81"),
    "waves": (lambda: hung(sea=fs.Sea(depth=9.0, waves="jonswap")), "waves: got 'jonswap'", "IrregularWaves"),
    "twice": (lambda: hung(parts=[line(), line()]), "the name 'rope' is used 2 times"),
    "part and joint": (lambda: one_body([ball("buoy", (0, 0, 0), name="buoy")]), "the name 'buoy' is used 2 times"),
    "unknown end": (lambda: hung(joints=[ball("rope.end_A", (0, 0, 60))]), "'rope.end_A'", "did you mean 'rope.end_a'"),
    "unknown part": (
        lambda: one_body([ball("buoi", (0, 0, 0))]),
        "joint 'buoi_joint'",
        "'buoi'",
        "did you mean 'buoy'",
    ),
    "spring's end": (
        lambda: fs.Model(parts=[body(), fs.Spring(name="k", a="boy", b="buoy", stiffness=1, free_length=1)], sea=SEA),
        "Spring 'k'",
        "'boy'",
        "did you mean 'buoy'",
    ),
    "too short": (
        lambda: hung(joints=[ball("rope.end_a", (0, 0, 60)), ball("rope.end_b", (120, 0, 60))]),
        "Line 'rope'",
        "length is 100 m",
        "120 m apart",
        "20 m too short",
        "taut=True",
    ),
    "no span": (
        lambda: hung(joints=[ball("rope.end_a", (0, 0, 60)), ball("rope.end_b", (0, 0, 60))]),
        "Line 'rope'",
        "start at the same place",
    ),
    "one end": (lambda: hung(joints=[ball("rope.end_a", (0, 0, 60))]), "Line 'rope': where it starts is unknown"),
    "below the bed": (
        lambda: hung(joints=[ball("rope.end_a", (0, 0, -60)), ball("rope.end_b", (0, 0, -20))]),
        "Line 'rope': end_a is at z = -60 m",
        "below the seabed at -50 m",
    ),
    "to itself": (lambda: one_body([ball("buoy", "buoy.p")]), "joint 'buoy_joint'", "both ends are of 'buoy'"),
    "ring": (lambda: hung(joints=[ball("rope.end_a", "rope.end_b")]), "joint 'rope_end_a'", "both ends are of 'rope'"),
    "spring without length": (
        lambda: fs.Model(
            parts=[body(), fs.Spring(name="k", a="buoy", b=(0, 0, 0), stiffness=1, free_length=1)], sea=SEA
        ),
        "Spring 'k'",
        "start at the same place",
    ),
    "spring at rest": (
        lambda: fs.Model(
            parts=[body(), fs.Spring(name="k", a=(1, 0, 0), b=(0, 0, 0), stiffness=1, free_length=1)], sea=SEA
        ),
        "Spring 'k'",
        "both ends are fixed",
    ),
}

ASSEMBLY = {
    "redundant": (
        lambda: one_body([ball("buoy", (0, 0, 0)), ball("buoy.p", (1, 0, 0)), ball("buoy.q", (2, 0, 0))]),
        "joints are redundant",
        "'buoy_q'",
    ),
    "contradictory": (
        lambda: one_body([ball("buoy", (0, 0, 0)), ball("buoy.p", (1.5, 0, 0))]),
        "joint 'buoy_p' is open by 0.5 m",
    ),
    "open": (lambda: one_body([ball("buoy", (1, 0, 0))]), "joint 'buoy_joint' is open by 1 m"),
    "weld of a line": (
        lambda: hung(joints=[fs.Weld(a="rope.end_a", b=(0, 0, 60)), ball("rope.end_b", (80, 0, 60))]),
        "Weld 'rope_end_a'",
        "no rotation",
        "Clamp",
    ),
    "clamp without EI": (
        lambda: hung(
            joints=[fs.Clamp(a="rope.end_a", b=(0, 0, 60), direction=(1, 0, 0)), ball("rope.end_b", (80, 0, 60))]
        ),
        "Clamp 'rope_end_a'",
        "EI = 0",
    ),
    "clamp of a body": (
        lambda: one_body([fs.Clamp(a="buoy", b=(0, 0, 0), direction=(1, 0, 0))]),
        "Clamp 'buoy_joint'",
        "not the end of a line",
    ),
    "clamp to a line": (
        lambda: hung(
            joints=[ball("rope.end_a", (0, 0, 60)), fs.Clamp(a="rope.end_b", b="bob", direction=(1, 0, 0))],
            parts=[line(section=section(EI=10.0)), fs.PointMass(name="bob", mass=1.0, position=(80, 0, 60))],
        ),
        "Clamp 'rope_end_b'",
        "'bob' has no rotation",
    ),
    "motion that starts turned": (
        lambda: one_body(
            [fs.Prescribed(a="buoy", motion=motion((0.0,) * 6, (0.0,) * 6, (0.0,) * 6))], attitude_deg=(0, 0, 180)
        ),
        "Prescribed 'buoy_joint'",
        "attitude_deg",
    ),
    "motion of a line's end": (
        lambda: hung(
            joints=[
                fs.Prescribed(a="rope.end_a", motion=motion((0.0,) * 6, (0.0,) * 6, (0.0,) * 6)),
                ball("rope.end_b", (80, 0, 0)),
            ]
        ),
        "Prescribed 'rope_end_a'",
        "no rotation",
    ),
}


def refused(error, make, words):
    with pytest.raises(error) as caught:
        make()
    message = str(caught.value)
    for word in words:
        assert word in message, message
    assert "function-" not in message and "pydantic" not in message, message
    return message


@pytest.mark.parametrize("case", DESCRIPTIONS)
def test_description(case):
    make, *words = DESCRIPTIONS[case]
    message = refused(fs.ModelError, make, words)
    assert len(message) < 400


@pytest.mark.parametrize("case", MODEL_PROBLEMS)
def test_model(case):
    make, *words = MODEL_PROBLEMS[case]
    refused(fs.ModelError, make, words)


@pytest.mark.parametrize("case", ASSEMBLY)
def test_assembly(case):
    make, *words = ASSEMBLY[case]
    refused(fs.ModelError, lambda: fs.assemble(make()), words)


def test_all_problems_at_once():
    with pytest.raises(fs.ModelError) as caught:
        section(EA=-1.0, diameter="0.1", colour="red")
    assert len(caught.value.problems) == 3


def test_numpy_is_accepted():
    wire = section(EA=np.float32(2e8), EI=np.int64(3), diameter=np.array(0.05))
    assert (wire.EA, wire.EI) == (2e8, 3.0)
    rope = line(section=wire, elements=np.int32(7), end_a_position=np.array([1.0, 2.0, 3.0]), end_b_position=[1, 2, 9])
    assert rope.end_a_position == (1.0, 2.0, 3.0) and rope.elements == 7
    assert body(inertia=np.ones(3), points={"p": np.zeros(3)}).inertia == (1.0, 1.0, 1.0)
    assert isinstance(wire.EA, float) and type(rope.elements) is int


ANYTHING = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=20), st.lists(st.floats(), max_size=4),
    st.builds(np.float64, st.floats()), st.builds(np.array, st.lists(st.floats(), max_size=4)), st.binary(max_size=4),
)  # fmt: skip


@given(value=ANYTHING)
def test_a_number_is_positive_or_refused(value):
    try:
        accepted = section(EA=value).EA
    except fs.ModelError as error:
        assert str(error).startswith("Section 'wire': EA: got ")
        assert "\n" not in str(error)
        assert isinstance(value, bool | str) or not (isinstance(value, int | float) and 0.0 < value <= 1e40)
    else:
        assert type(accepted) is float and 0.0 < accepted < INF and accepted == value


@given(value=ANYTHING, key=st.sampled_from(["position", "attitude_deg", "center_of_mass", "inertia", "mass", "points"]))
def test_a_body_is_made_of_finite_numbers_or_refused(value, key):
    try:
        made = body(**{key: value})
    except fs.ModelError as error:
        assert str(error).startswith("Body 'buoy': ")
    else:
        numbers = np.concatenate([made.position, made.attitude_deg, made.center_of_mass, made.inertia, [made.mass]])
        assert np.isfinite(numbers).all()


@given(st.dictionaries(st.text(min_size=1, max_size=12), ANYTHING, min_size=1, max_size=3))
def test_unknown_arguments(arguments):
    known = set(fs.PointMass.model_fields)
    with pytest.raises(fs.ModelError):
        fs.PointMass(**{"name": "m", "mass": 1.0, "position": (0, 0, 0)}, **{k + "?": v for k, v in arguments.items()})
    assert not known & {k + "?" for k in arguments}


# -- what is asked of a model -----------------------------------------------------------------


@pytest.fixture(scope="module")
def pendulum():
    return fs.assemble(model_script("pendulum").build())


REQUESTS = {
    "text": ({"duration": "10"}, "duration: got '10'", "positive number of seconds"),
    "no time": ({"duration": 0.0}, "duration: got 0.0", "positive number of seconds"),
    "NaN": ({"duration": NAN}, "duration: got nan", "positive number of seconds"),
    "boolean": ({"dt": True}, "dt: got True", "positive number of seconds"),
    "negative step": ({"dt": -0.1}, "dt: got -0.1", "positive number of seconds"),
    "step too small": ({"dt": 1e-300}, "more than 1e+12 steps"),
    "step too long": ({"dt": 2.0}, "dt is 2 s", "longer than the duration of 1 s"),
    "interval": ({"interval": INF}, "interval: got inf", "positive number of seconds"),
    "interval too long": ({"interval": 2.0}, "interval is 2 s", "longer than the duration of 1 s"),
    "too much": ({"duration": 1e9, "dt": 0.01}, "do not fit into memory", "give an output file"),
    "precision": ({"precision": "f4"}, "precision: got 'f4'", "'float64' or 'float32'"),
    "scheme": ({"scheme": "hht"}, "scheme: got 'hht'", "generalised_alpha"),
    "undamped": ({"scheme": fs.newmark()}, "newmark", "has joints", "generalised_alpha(0.9)"),
    "tolerance": ({"tolerance": NAN}, "tolerance: got nan", "between 0 and 1"),
    "state": ({"state": 3}, "state: got 3", "solve_static"),
    "channel": ({"channels": ["rod_positon"]}, "'rod_positon'", "did you mean 'rod_position'"),
    "channels": ({"channels": 3}, "channels: got 3", "a list of names"),
    "one channel": ({"channels": "rod_position"}, "channels: got 'rod_position'", "a list of names"),
    "number as channel": ({"channels": [3]}, "there is no '3'"),
    "folder": ({"output": "nowhere/x.nc"}, "'nowhere/x.nc'", "no folder 'nowhere'"),
    "no path": ({"output": 3}, "output file: got 3", "path"),
    "null": ({"output": "a\0b"}, "output file: got 'a\\x00b'", "path"),
    "long name": ({"output": 300 * "a"}, "cannot be written", "choose another name"),
}


@pytest.mark.parametrize("case", REQUESTS)
def test_run(case, pendulum):
    arguments, *words = REQUESTS[case]
    refused(fs.CaseError, lambda: fs.simulate(pendulum, **{"duration": 1.0, **arguments}), words)


def test_what_is_no_model():
    refused(
        fs.CaseError, lambda: fs.simulate("pendulum.py", 1.0), ["model: got 'pendulum.py'", "must be a floatsim.Model"]
    )


def test_state_of_another_system(pendulum):
    other = fs.assemble(model_script("hanging_chain").build()).initial_state()
    refused(fs.CaseError, lambda: fs.simulate(pendulum, 1.0, state=other), ["another system than 'pendulum'"])


def test_state_with_an_open_joint(pendulum):
    state = pendulum.initial_state()
    state.x[0, 0] += 0.5
    refused(fs.CaseError, lambda: fs.simulate(pendulum, 1.0, state=state), ["joint 'hinge' is open by 0.5 m"])
    refused(fs.CaseError, lambda: fs.step(pendulum, state, 0.1), ["joint 'hinge' is open by 0.5 m"])


def test_an_output_name_stands_for_one_thing():
    """A ball between two other things that is named as the rope's end force is."""
    rope = line(end_a_position=(0, 0, 60), end_b_position=(80, 0, 60))
    joints = [
        ball("rope.end_b", (80, 0, 60)),
        ball("buoy", "rope.end_a", name="rope_end_a"),
        ball("buoy", (0, 0, 60), name="x"),
    ]
    model = fs.Model(parts=[rope, body(position=(0, 0, 60))], joints=joints, sea=SEA)
    refused(fs.CaseError, lambda: fs.simulate(model, 1.0), ["'rope_end_a_force'", "two things", "rename"])


def test_files_of_others_are_not_overwritten(tmp_path, pendulum):
    for name, content in (("notes.txt", b"mine"), ("data.nc", b"\x89HDF, but no results")):
        (tmp_path / name).write_bytes(content)
    refused(fs.CaseError, lambda: fs.simulate(pendulum, 1.0, output=tmp_path / "notes.txt"), ["holds no results"])
    assert (tmp_path / "notes.txt").read_bytes() == b"mine"
    refused(fs.CaseError, lambda: fs.simulate(pendulum, 1.0, output=DATABASE), ["holds no results"])
    assert fs.HydroDatabase.read(DATABASE).omega.size > 2
    for _ in range(2):  # a torso, then a result file
        assert fs.simulate(pendulum, 1.0, output=tmp_path / "data.nc").status == "done"


DECAYS = {
    "dof": ({"dof": "Surge"}, "'Surge'", "did you mean 'surge'"),
    "no dof": ({"dof": None}, "'None'", "known: heave"),
    "no offset": ({"offset": 0.0}, "offset: got 0.0", "other than zero"),
    "NaN": ({"offset": NAN}, "offset: got nan"),
    "text": ({"offset": "5"}, "offset: got '5'"),
    "radians?": ({"offset": 120.0}, "offset: got 120 degrees of pitch", "less than 90"),
    "release": ({"release": "abs"}, "release: got 'abs'", "'equilibrium' or 'absolute'"),
    "body": ({"body": "rodd"}, "'rodd'", "did you mean 'rod'"),
    "duration": ({"duration": -1.0}, "duration: got -1.0"),
    "dt": ({"dt": "x"}, "dt: got 'x'"),
    "jointed": ({"dof": "surge"}, "'rod' cannot be released", "joint 'hinge' would be open by 5 m"),
    "too short": ({"duration": 0.5}, "a period needs three", "longer"),
    "folder": ({"output": "nowhere/x.nc"}, "no folder 'nowhere'"),
}


@pytest.mark.parametrize("case", DECAYS)
def test_decay(case, pendulum):
    arguments, *words = DECAYS[case]
    refused(fs.CaseError, lambda: fs.decay_test(pendulum, **{"dof": "pitch", "offset": 5.0, **arguments}), words)


def test_decay_of_no_body_or_of_two():
    chain = model_script("hanging_chain").build()
    refused(fs.CaseError, lambda: fs.decay_test(chain, "surge", 1.0), ["'hanging_chain' has no body"])
    two = fs.Model(parts=[body(), body(name="other")], sea=SEA)
    refused(fs.CaseError, lambda: fs.decay_test(two, "surge", 1.0), ["2 bodies (buoy, other)"])


def test_held_by_nothing():
    falling = fs.Model(parts=[body()], sea=SEA)
    system = fs.assemble(falling)
    refused(fs.SolveFailed, lambda: fs.solve_static(system), ["z of 'buoy'"])
    assert ["'buoy' is tied to nothing" in text for text in cautions(system)] == [True]
    assert cautions(fs.assemble(model_script("pendulum").build())) == []


def test_a_folded_line_is_named():
    stiff = section(EI=10.0, EA=1e6)
    ends = [ball("rope.end_a", (0, 0, 20)), ball("rope.end_b", (0.001, 0, 20))]
    folded = fs.Model(parts=[line(section=stiff, length=10.0, elements=2)], joints=ends, sea=SEA)
    refused(fs.SolveFailed, lambda: fs.solve_static(fs.assemble(folded)), ["line 'rope'", "folded back"])


# -- floaters ---------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def volturnus():
    return model_script("volturnus_s")


@pytest.fixture(scope="module")
def database():
    return fs.HydroDatabase.read(DATABASE)


@pytest.mark.parametrize(
    "change, words",
    [
        ({"reference_point": (0, 0, -10)}, ["Body 'platform'", "reference point is (0, 0, -10) m", "(0, 0, 0) m"]),
        ({"depth": 100.0}, ["Body 'platform'", "water depth is 100 m", "200 m"]),
        ({"density": 1000.0}, ["Body 'platform'", "water density is 1000", "1025"]),
        ({"added_mass_inf": np.full((6, 6), NAN)}, ["hydrodynamic database 'volturnus_s'", "NaN", "added_mass_inf"]),
    ],
)
def test_database_of_another_case(volturnus, database, change, words):
    other = dataclasses.replace(database, **change)
    refused(fs.ModelError, lambda: fs.assemble(volturnus.build(hydro=other)), words)


def test_waves_beyond_the_database(volturnus, database):
    waves = fs.IrregularWaves(spectrum=fs.Jonswap(hs=1.0, tp=1.5), seed=1)
    model = volturnus.build(hydro=database, waves=waves)
    refused(fs.ModelError, lambda: fs.assemble(model), ["Body 'platform'", "0.05 to 3 rad/s", "waves' energy"])


def altered(volturnus, mass_factor, cm_z=None):
    model = volturnus.build()
    platform = model.parts[0]
    changes = {"mass": mass_factor * platform.mass}
    if cm_z is not None:
        changes["center_of_mass"] = (0.0, 0.0, cm_z)
    return model.model_copy(update={"parts": [platform.model_copy(update=changes), *model.parts[1:]]})


def test_a_floater_that_sinks(volturnus):
    """Twice the mass: what is missing is about the weight once more, 20 207 t g = 198 MN."""
    (line,) = cautions(fs.assemble(altered(volturnus, 2.0)))
    assert "body 'platform' sinks" in line and "draught of 20 m" in line
    missing = float(line.split("sinks: ")[1].split(" kN")[0]) * 1e3
    assert missing == pytest.approx(2.0e8, rel=0.03)
    (line,) = cautions(fs.assemble(altered(volturnus, 1.1)))
    assert "floats" in line and "deeper than drawn" in line
    assert cautions(fs.assemble(volturnus.build())) == []


def test_a_floater_that_capsizes(volturnus, database):
    """Centre of mass at +20 m: C44 = C - m g z_G < 0."""
    model = altered(volturnus, 1.0, 20.0)
    lines = cautions(fs.assemble(model))
    assert len(lines) == 2 and all("body 'platform' has negative metacentric stiffness" in text for text in lines)
    expected = database.hydrostatic_stiffness[3, 3] - model.parts[0].mass * 9.81 * 20.0
    assert float(lines[0].split("roll: ")[1].split(" N")[0]) == pytest.approx(expected, rel=1e-3)


def test_classes_instead_of_objects():
    """The class itself has the methods, too: it is refused where it is given."""
    buoy = body(name="buoy")
    sea = fs.Sea(depth=10.0, waves=fs.RegularWave)
    refused(fs.ModelError, lambda: fs.Model(parts=[buoy], sea=sea), ["got the class RegularWave itself"])
    refused(fs.ModelError, lambda: fs.CombinedWaves(waves=[fs.RegularWave]), ["CombinedWaves: waves: got"])
    refused(fs.ModelError, lambda: fs.IrregularWaves(spectrum=fs.Jonswap, seed=1), ["IrregularWaves: spectrum: got"])
    refused(fs.ModelError, lambda: body(hydro=fs.Hull), ["hydro: got"])


def test_long_memories_fit_into_memory(database):
    """An hour of lags is worked out in blocks."""
    long = RadiationKernel.from_database(database, memory=600.0, grid=0.5)
    short = RadiationKernel.from_database(database, memory=60.0, grid=0.5)
    assert np.abs(long.K[:80] - short.K[:80]).max() < 0.02 * np.abs(short.K).max()
