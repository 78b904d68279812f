"""Bad input for lines: sections, pieces, laws, what hangs on a line, the bed, currents, shapes, runs.

Every message has the object's name, what was got and what is allowed.
"""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import floatsim as fs
from floatsim.description import Description

NAN, INF = math.nan, math.inf
SECTION = {"name": "wire", "mass_per_length": 50.0, "diameter": 0.05, "EA": 2e8}
CURVE = {"strain": [0.0, 0.1], "tension": [0.0, 1e6]}
TABLE = fs.MomentTable(curvature=[0.0, 1.0], moment=[0.0, 5.0])
SLEEVE = fs.BendStiffener(length=6.0, EI=(1e5, 1e4))
GRID = {"x": [0.0, 10.0], "y": [0.0, 5.0], "z": [[-9.0, -8.0], [-9.0, -7.0]]}


def section(**changes):
    return fs.Section(**{**SECTION, **changes})


def line(**changes):
    return fs.Line(**{"name": "rope", "section": section(), "length": 100.0, "elements": 10, **changes})


def piece(**changes):
    return fs.Piece(**{"section": section(), "length": 10.0, "elements": 2, **changes})


def pieced(*pieces, **changes):
    return fs.Line(name="rope", pieces=list(pieces), **changes)


def clump(**changes):
    return fs.Attachment(**{"name": "clump", "at": 3.0, "mass": 1.0, **changes})


def sleeve(**changes):
    return fs.BendStiffener(**{"length": 6.0, "EI": (1e5, 1e4), **changes})


def polyester(**changes):
    return fs.StaticDynamic(**{**CURVE, "dynamic_stiffness": 3e7, **changes})


def grid(**changes):
    return fs.Bathymetry(**{**GRID, **changes})


def current(**changes):
    return fs.Current.table(**{"depths": [0.0, 10.0], "speeds": [1.0, 0.5], **changes})


def profile(**changes):
    return fs.CurrentTable(**{"depths": [0.0, 10.0], "factors": [1.0, 0.5], **changes})


class Law:
    start = bind = None

    def __init__(self, stiffness, memory=0):
        self.stiffness, self.memory = stiffness, memory


BAD = {
    # sections
    "law of text": (lambda: section(axial_law="rope"), "Section 'wire': axial_law: got 'rope'", "Engineering()"),
    "law's class": (lambda: section(axial_law=fs.Engineering), "axial_law: got <class", "Engineering()"),
    "law of moments": (lambda: section(axial_law=TABLE), "Section 'wire': axial_law: got MomentTable", "TensionTable"),
    "law without stiffness": (lambda: section(axial_law=Law(NAN)), "Law has a stiffness of nan", "a positive number"),
    "law without memory": (lambda: section(axial_law=Law(1e6, None)), "Law has a memory of None", "number of rows"),
    "law of tension": (lambda: section(bending_law=fs.TensionTable(**CURVE)), "bending_law: got", "be a MomentTable"),
    "breaking load": (lambda: section(breaking_load=0), "Section 'wire': breaking_load: got 0", "positive number"),
    "NaN load": (lambda: section(breaking_load=NAN), "breaking_load: got nan", "positive number"),
    "radius": (lambda: section(minimum_bend_radius=-1), "minimum_bend_radius: got -1", "positive number"),
    "friction": (lambda: section(seabed_friction=-0.1), "Section 'wire': seabed_friction: got -0.1", "not negative"),
    "friction of text": (lambda: section(seabed_friction="0.1"), "seabed_friction: got '0.1'", "(along, across)"),
    "one friction": (lambda: section(seabed_friction=(0.1,)), "seabed_friction: got (0.1,)", "two of them"),
    "NaN friction": (lambda: section(seabed_friction=(0.1, NAN)), "got (0.1, nan)", "not negative"),
    "no friction": (lambda: section(seabed_friction=False), "seabed_friction: got False", "a number"),
    "friction galore": (lambda: section(seabed_friction=1e300), "seabed_friction: got 1e+300"),
    # pieces
    "piece of nothing": (lambda: fs.Piece(length=1.0, elements=1), "Piece: 'section' is missing"),
    "piece's section": (lambda: piece(section="wire"), "Piece: section: got 'wire'", "must be a Section"),
    "piece's length": (lambda: piece(length=NAN), "Piece: length: got nan", "positive number"),
    "piece's elements": (lambda: piece(elements=2.5), "Piece: elements: got 2.5", "positive whole number"),
    "too short": (lambda: piece(length=1e-6), "Piece: its elements are 5e-07 m long", "1e-06 m is the least"),
    "too many": (lambda: piece(elements=10**6), "Piece: elements: got 1000000", "at most 100000"),
    # lines
    "of nothing": (lambda: fs.Line(name="rope"), "Line 'rope': it is made of nothing", "pieces=[...]"),
    "no pieces": (lambda: pieced(), "Line 'rope': pieces: got none", "at least one Piece("),
    "one piece": (lambda: fs.Line(name="rope", pieces=piece()), "Line 'rope': pieces: got Piece(", "must be a list"),
    "sections as pieces": (lambda: pieced(piece(), section()), "pieces: got Section(name='wire'", "list of Piece(...)"),
    "pieces and section": (lambda: pieced(piece(), section=section(), length=3.0), "got pieces and section, length"),
    "pieces and length": (lambda: pieced(piece(), length=10.0), "Line 'rope': got pieces and length"),
    "misspelt": (
        lambda: fs.Line(name="rope", section=section(), lenght=100.0, elements=10),
        "Line 'rope': unknown argument 'lenght' (did you mean 'length'?)",
        "Line 'rope': 'length' is missing",
    ),
    "many small pieces": (lambda: pieced(*[piece(elements=60_000)] * 2), "Line 'rope'", "120000 elements", "at most"),
    "shape": (lambda: line(shape="arc"), "Line 'rope': shape: got 'arc'", "such as Catenary()", "None"),
    "shape's class": (lambda: line(shape=fs.Catenary), "Line 'rope': shape: got <class", "Catenary()"),
    "attachment": (lambda: line(attachments=[section()]), "attachments: got Section", "a list of Attachment(...)"),
    "single attachment": (lambda: line(attachments=clump()), "attachments: got Attachment", "must be a list"),
    "attachment beyond": (
        lambda: line(attachments=[clump(at=101.0)]),
        "Line 'rope': attachment 'clump' is at 101 m",
        "the line is 100 m long",
    ),
    "attachments' name": (lambda: line(attachments=[clump()] * 2), "'clump' is used 2 times", "must differ"),
    "break": (lambda: line(breaks=[50.0]), "Line 'rope': breaks: got 50.0", "a list of Break(...)"),
    "break beyond": (lambda: line(breaks=[fs.Break(at=100.1, time=1.0)]), "a break is at 100.1 m", "is 100 m long"),
    "stiffener": (lambda: line(stiffener_a=4.0), "Line 'rope': stiffener_a: got 4.0", "must be a BendStiffener"),
    "long stiffener": (lambda: line(stiffener_b=sleeve(length=101.0)), "stiffener_b is 101 m long", "only 100 m"),
    "two long stiffeners": (
        lambda: line(stiffener_a=sleeve(length=60.0), stiffener_b=sleeve(length=50.0)),
        "Line 'rope': its stiffeners are 110 m long together",
    ),
    "stiffener over a table": (
        lambda: line(section=section(bending_law=TABLE), stiffener_a=SLEEVE),
        "Line 'rope': stiffener_a lies over section 'wire'",
        "moment table",
    ),
    "stiffener's tip over a table": (
        lambda: pieced(piece(section=section(name="slips", bending_law=TABLE)), piece(length=5.0), stiffener_b=SLEEVE),
        "stiffener_b lies over section 'slips'",
    ),
    # what hangs on it
    "nameless": (lambda: fs.Attachment(at=1.0, mass=1.0), "Attachment: 'name' is missing"),
    "before the line": (lambda: clump(at=-1.0), "Attachment 'clump': at: got -1.0", "not negative"),
    "NaN mass": (lambda: clump(mass=NAN), "Attachment 'clump': mass: got nan", "not negative"),
    "nothing": (lambda: clump(mass=0.0), "Attachment 'clump'", "all 0", "do nothing"),
    "one EI": (lambda: sleeve(EI=1e5), "BendStiffener: EI: got 100000.0", "at the root, at the tip"),
    "NaN EI": (lambda: sleeve(EI=(1e5, NAN)), "BendStiffener: EI: got (100000.0, nan)", "two numbers"),
    "negative EI": (lambda: sleeve(EI=(-1.0, 1.0)), "BendStiffener: EI: got (-1.0, 1.0)", "not be negative"),
    "no EI": (lambda: sleeve(EI=(0.0, 0.0)), "BendStiffener: EI: got (0, 0)", "does nothing"),
    "no length": (lambda: sleeve(length=0.0), "BendStiffener: length: got 0.0", "positive number"),
    "negative diameter": (lambda: sleeve(diameter=(0.4, -0.2)), "diameter: got (0.4, -0.2)", "not be negative"),
    "no cause": (lambda: fs.Break(at=1.0), "Break", "time [s] or tension [N]"),
    "two causes": (lambda: fs.Break(at=1.0, time=1.0, tension=1.0), "Break", "one and not both"),
    "NaN cause": (lambda: fs.Break(at=1.0, tension=NAN), "Break: tension: got nan", "positive number"),
    "NaN place": (lambda: fs.Break(at=NAN, time=1.0), "Break: at: got nan", "not negative"),
    "past": (lambda: fs.Break(at=1.0, time=-1.0), "Break: time: got -1.0", "not negative"),
    # laws
    "engineering EA": (lambda: fs.Engineering(EA=1e9), "Engineering: unknown argument 'EA'"),
    "one point": (lambda: fs.TensionTable(strain=[0.0], tension=[0.0]), "TensionTable", "1 values", "at least two"),
    "unlike rows": (lambda: fs.TensionTable(strain=[0, 1], tension=[0, 1, 2]), "strain has 2 values and tension 3"),
    "strain stands": (lambda: fs.TensionTable(strain=[0, 1, 1], tension=[0, 1, 2]), "strain: 1 is followed by 1"),
    "tension falls": (lambda: fs.TensionTable(strain=[0, 0.1], tension=[5, 4]), "tension: 5 is followed by 4", "fall"),
    "flat": (lambda: fs.TensionTable(strain=[0, 0.1], tension=[0, 0]), "tension: all values are 0", "rise"),
    "NaN strain": (lambda: fs.TensionTable(strain=[0, NAN], tension=[0, 1]), "TensionTable: strain: got [0, nan]"),
    "text as table": (lambda: fs.TensionTable(strain="soft", tension=[0, 1]), "strain: got 'soft'", "finite numbers"),
    "no dynamic": (lambda: fs.StaticDynamic(**CURVE), "StaticDynamic: 'dynamic_stiffness' is missing"),
    "dynamic too soft": (lambda: polyester(dynamic_stiffness=9e6), "is 9e+06 N at 0 N", "there 1e+07 N", "energy"),
    "all permanent": (lambda: polyester(permanent_share=1.0), "StaticDynamic: permanent_share is 1", "below 1"),
    "working exponent": (lambda: polyester(working_exponent=0.5), "working_exponent is 0.5", "at least 1"),
    "no relaxation": (lambda: polyester(relaxation_time=0.0), "relaxation_time: got 0.0", "positive number"),
    "NaN per tension": (lambda: polyester(per_tension=NAN), "per_tension: got nan", "not negative"),
    "curve falls": (lambda: polyester(tension=[1.0, 0.0]), "StaticDynamic: tension: 1 is followed by 0"),
    "moments not from 0": (lambda: fs.MomentTable(curvature=[0.1, 1], moment=[0, 1]), "the first value is 0.1"),
    "moments fall": (lambda: fs.MomentTable(curvature=[0, 1], moment=[0, -1]), "moment: 0 is followed by -1", "rise"),
    "NaN moment": (lambda: fs.MomentTable(curvature=[0, 1], moment=[0, NAN]), "MomentTable: moment: got [0, nan]"),
    "one moment": (lambda: fs.MomentTable(curvature=[0], moment=[0]), "MomentTable: curvature has 1 values"),
    # the bed
    "bed's stiffness": (lambda: fs.Seabed(stiffness=0.0), "Seabed: stiffness: got 0.0", "positive number"),
    "bed's friction": (lambda: fs.Seabed(friction=-0.5), "Seabed: friction: got -0.5", "not negative"),
    "two frictions": (lambda: fs.Seabed(friction=(0.5, 0.3)), "Seabed: friction: got (0.5, 0.3)", "a number"),
    "axial friction": (lambda: fs.Seabed(friction_axial=NAN), "Seabed: friction_axial: got nan", "not negative"),
    "slip": (lambda: fs.Seabed(slip_length=0.0), "Seabed: slip_length: got 0.0", "positive number"),
    "one slope": (lambda: fs.Seabed(slope=0.1), "Seabed: slope: got 0.1", "(dz/dx, dz/dy)"),
    "NaN slope": (lambda: fs.Seabed(slope=(0.1, NAN)), "Seabed: slope: got (0.1, nan)", "two finite numbers"),
    "heights as bathymetry": (lambda: fs.Seabed(bathymetry=[[1, 2], [3, 4]]), "bathymetry: got [[1, 2]", "Bathymetry"),
    "two shapes": (lambda: fs.Seabed(slope=(0.1, 0.0), bathymetry=grid()), "Seabed: give slope or bathymetry"),
    "no heights": (lambda: grid(z=-9.0), "Bathymetry: z: got an array of shape ()", "at least 2 x 2"),
    "dictionary of heights": (lambda: grid(z={}), "Bathymetry: z: got an array of shape ()", "rows of finite numbers"),
    "ragged": (lambda: grid(z=[[-9.0, -8.0], [-9.0]]), "Bathymetry: z: its rows differ in length"),
    "NaN height": (lambda: grid(z=[[-9.0, NAN], [-9.0, -9.0]]), "Bathymetry: z: not all are finite numbers"),
    "height of text": (lambda: grid(z=[["-9", "-8"], ["-9", "-8"]]), "Bathymetry: z: not all are finite numbers"),
    "complex height": (lambda: grid(z=[[1j, 0], [0, 0]]), "Bathymetry: z: not all are finite numbers"),
    "huge height": (lambda: grid(z=[[1e300, 0], [0, 0]]), "Bathymetry: z: not all are finite numbers"),
    "rows short": (lambda: grid(x=[0.0, 5.0, 10.0]), "Bathymetry: x has 3 values, z has 2"),
    "backwards": (lambda: grid(y=[5.0, 0.0]), "Bathymetry: y: got steps of -5 to -5 m", "rise in even steps"),
    "uneven": (
        lambda: grid(x=[0.0, 1.0, 3.0], z=[[0, 0]] * 3),
        "Bathymetry: x: got steps of 1 to 2 m",
        "rise in even steps",
    ),
    # water
    "exponent": (lambda: fs.PowerLaw(exponent=0.0), "PowerLaw: exponent: got 0.0", "positive number"),
    "profile": (lambda: fs.Current(speed=1.0, profile="tide"), "Current", "got 'tide'", "PowerLaw", "CurrentTable"),
    "empty profile": (lambda: profile(depths=[], factors=[]), "CurrentTable: depths: got []", "at least 1"),
    "short profile": (lambda: profile(factors=[1.0]), "CurrentTable: factors has 1 values, depths has 2"),
    "short turns": (lambda: profile(turns_deg=[1.0]), "CurrentTable: turns_deg has 1 values, depths has 2"),
    "above the sea": (lambda: profile(depths=[-1.0, 5.0]), "CurrentTable: depths has -1 m", "downwards"),
    "upwards": (lambda: profile(depths=[5.0, 1.0]), "CurrentTable: depths (5.0, 1.0)", "increase"),
    "negative factor": (lambda: profile(factors=[1.0, -1.0]), "CurrentTable: factors has -1", "turns_deg"),
    "NaN factor": (lambda: profile(factors=[1.0, NAN]), "CurrentTable: factors: got [1.0, nan]", "finite numbers"),
    "negative speeds": (lambda: current(speeds=[1.0, -1.0]), "Current.table: speeds has -1 m/s", "heading"),
    "short speeds": (lambda: current(speeds=[1.0]), "Current.table: speeds has 1 values, depths has 2"),
    "headings of text": (lambda: current(headings_deg="north"), "Current.table: headings_deg: got 'north'", "number"),
    "INF depth": (lambda: current(depths=[0.0, INF]), "Current.table: depths: got [0.0, inf]", "finite numbers"),
    "stretching": (lambda: fs.Sea(depth=9.0, stretching="none"), "Sea: stretching: got 'none'", "'wheeler'"),
    # shapes
    "no coordinates": (lambda: fs.Nodes(coordinates=3), "Nodes: coordinates: got an array of shape ()", "(x, y, z)"),
    "one node": (lambda: fs.Nodes(coordinates=[[0, 0, 0]]), "Nodes: coordinates", "(1, 3)", "two or more rows"),
    "NaN node": (lambda: fs.Nodes(coordinates=[[0, 0, 0], [0, 0, NAN]]), "Nodes: coordinates: not all are numbers"),
    "same nodes": (lambda: fs.Nodes(coordinates=[[0, 0, 1], [0, 0, 1]]), "rows 0 and 1", "the same point"),
    "crest": (lambda: fs.ThreeCircles(crest_depth=-1.0), "ThreeCircles: crest_depth: got -1.0", "positive number"),
    "circles": (lambda: fs.ThreeCircles(lengths=(1, 2)), "ThreeCircles: lengths: got (1, 2)", "three positive lengths"),
    "circles of nothing": (lambda: fs.ThreeCircles(lengths=(1, 2, -3)), "lengths: got (1.0, 2.0, -3.0)", "positive"),
    "straight": (lambda: fs.Straight(slack=3), "Straight: unknown argument 'slack'"),
}  # fmt: skip


def refused(error, make, words):
    with pytest.raises(error) as caught:
        make()
    message = str(caught.value)
    for word in words:
        assert word in message, message
    for foreign in ("function-", "pydantic", "Input should", "numpy.", "Traceback"):
        assert foreign not in message, message
    return message


@pytest.mark.parametrize("case", BAD)
def test_description(case):
    make, *words = BAD[case]
    assert len(refused(fs.ModelError, make, words)) < 400


def test_all_problems_of_a_line_at_once():
    with pytest.raises(fs.ModelError) as caught:
        fs.Line(name="rope", section=section(), length=-1.0, elements=0, taut=3, color="red")
    assert len(caught.value.problems) == 4
    assert all(text.startswith("Line 'rope': ") for text in caught.value.problems)


def test_what_is_allowed():
    """Lists and arrays for rows, both ways to say friction, two breaks at one place (either cause)."""
    assert section(seabed_friction=0.3).seabed_friction == (0.3, 0.3)
    assert section(seabed_friction=np.array([0.3, 0.6])).seabed_friction == (0.3, 0.6)
    assert fs.Seabed(slope=np.array([0.1, 0.2])).slope == (0.1, 0.2)
    assert fs.Bathymetry(x=np.arange(3.0), y=[0, 1], z=np.zeros((3, 2))).z == ((0.0, 0.0),) * 3
    assert len(line(breaks=[fs.Break(at=50.0, time=1.0), fs.Break(at=50.0, tension=1e5)]).breaks) == 2
    assert line(attachments=[clump(at=100.0)]).element_at(100.0) == 9
    both = pieced(piece(), piece(section=section(bending_law=TABLE), length=90.0), stiffener_a=SLEEVE)
    assert both.length == 100.0  # the table lies beyond the sleeve
    assert line().model_copy(update={"taut": True}).taut


HANG = [fs.Ball(a="rope.end_a", b=(0.0, 0.0, 60.0)), fs.Ball(a="rope.end_b", b=(80.0, 0.0, 60.0))]


def model(*joints, **changes):
    return fs.Model(parts=[line(section=section(EI=1e3), **changes)], joints=joints or HANG, sea=fs.Sea(depth=50.0))


def test_a_shape_that_does_not_fit_is_named():
    nodes = fs.Nodes(coordinates=[[0.0, 0.0, 60.0], [70.0, 0.0, 60.0]])
    refused(fs.ModelError, lambda: model(shape=nodes), ["Line 'rope': Nodes: the last", "(70, 0, 60) m", "10 m from"])
    refused(fs.ModelError, lambda: model(shape=fs.ThreeCircles()), ["Line 'rope': ThreeCircles", "sink", "lengths="])


def test_an_end_below_a_slope():
    sea = fs.Sea(depth=50.0, seabed=fs.Seabed(slope=(0.2, 0.0)))  # at x = 80 m the bed is 16 m higher
    ends = [fs.Ball(a="rope.end_a", b=(0.0, 0.0, 0.0)), fs.Ball(a="rope.end_b", b=(80.0, 0.0, -40.0))]
    refused(
        fs.ModelError,
        lambda: fs.Model(parts=[line()], joints=ends, sea=sea),
        ["Line 'rope': end_b is at z = -40 m", "below the seabed at -34 m"],
    )


@pytest.mark.parametrize("value", ["yes", None, 1, NAN])
def test_step_control(value):
    system = fs.assemble(model())
    words = [f"step_control: got {value!r}", "True or False"]
    refused(fs.CaseError, lambda: fs.simulate(system, 1.0, step_control=value), words)


ANYTHING = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=20), st.binary(max_size=4),
    st.lists(st.floats(), max_size=4), st.lists(st.lists(st.floats(), max_size=3), max_size=3),
    st.builds(np.float64, st.floats()), st.builds(np.array, st.lists(st.floats(), max_size=4)),
    st.sampled_from([section(), piece(), SLEEVE, TABLE, clump(), grid(), fs.Engineering(), fs.Arc, object()]),
)  # fmt: skip
CLASSES = [fs.Section, fs.Piece, fs.Line, fs.Attachment, fs.BendStiffener, fs.Break, fs.TensionTable, fs.StaticDynamic,
           fs.MomentTable, fs.Seabed, fs.Bathymetry, fs.CurrentTable, fs.PowerLaw, fs.Current, fs.Nodes,
           fs.ThreeCircles]  # fmt: skip
GOOD = {
    fs.Section: SECTION, fs.Piece: {"section": section(), "length": 1.0, "elements": 1},
    fs.Line: {"name": "rope", "section": section(), "length": 100.0, "elements": 10},
    fs.Attachment: {"name": "clump", "at": 3.0, "mass": 1.0}, fs.BendStiffener: {"length": 1.0, "EI": (1.0, 1.0)},
    fs.Break: {"at": 1.0, "time": 1.0}, fs.TensionTable: CURVE, fs.StaticDynamic: {**CURVE, "dynamic_stiffness": 3e7},
    fs.MomentTable: {"curvature": (0.0, 1.0), "moment": (0.0, 1.0)}, fs.Seabed: {}, fs.Bathymetry: GRID,
    fs.CurrentTable: {"depths": (0.0,), "factors": (1.0,)}, fs.PowerLaw: {}, fs.Current: {"speed": 1.0},
    fs.Nodes: {"coordinates": ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))}, fs.ThreeCircles: {},
}  # fmt: skip


def numbers_of(thing):
    """Every number a description holds."""
    for value in dict(thing).values():
        if isinstance(value, Description):
            yield from numbers_of(value)
        elif isinstance(value, int | float):
            yield value
        elif isinstance(value, tuple) and all(isinstance(y, int | float | tuple) for y in value):
            yield from np.ravel(np.array(value, dtype=float))


@given(data=st.data(), kind=st.sampled_from(CLASSES))
def test_anything_is_refused_by_name_or_leaves_finite_numbers(data, kind):
    """One or two arguments of junk: a ModelError that begins with the class, or a sound object."""
    names = [*kind.model_fields, *(("section", "length", "elements") if kind is fs.Line else ())]
    junk = data.draw(st.dictionaries(st.sampled_from(names), ANYTHING, min_size=1, max_size=2))
    try:
        made = kind(**{**GOOD[kind], **junk})
    except fs.ModelError as error:
        for text in error.problems:
            assert text.startswith(kind.__name__)
            assert "Input should" not in text and "pydantic" not in text, text
    else:
        assert all(math.isfinite(value) for value in numbers_of(made))


@given(data=st.data())
def test_a_line_of_anything_is_refused_or_has_nodes(data):
    """What passes as a line has rising arc lengths and positive parameters."""
    names = ["section", "pieces", "length", "elements", "attachments", "stiffener_a", "stiffener_b", "breaks", "shape"]
    junk = data.draw(st.dictionaries(st.sampled_from(names), ANYTHING, min_size=1, max_size=3))
    base = {"name": "rope"} if "pieces" in junk else GOOD[fs.Line]
    try:
        made = fs.Line(**{**base, **junk})
    except fs.ModelError as error:
        assert all(text.startswith("Line 'rope': ") for text in error.problems)
    else:
        if made.elements <= 1000:
            assert np.all(np.diff(made.arc_length) > 0.0)
            assert np.isfinite(made.element_parameters(1025.0, (0.0, 0.0))).all()


CLAMPED = fs.Clamp(a="rope.end_a", b=(0.0, 0.0, 60.0), direction=(1.0, 0.0, -1.0))


def test_a_stiffener_needs_a_clamp():
    words = ["Line 'rope': stiffener_a", "not clamped", "Clamp(a='rope.end_a'"]
    refused(fs.ModelError, lambda: model(stiffener_a=SLEEVE), words)
    refused(fs.ModelError, lambda: model(CLAMPED, HANG[1], stiffener_b=SLEEVE), ["stiffener_b", "rope.end_b"])
    assert model(CLAMPED, HANG[1], stiffener_a=SLEEVE).parts[0].stiffener_a is SLEEVE


@pytest.mark.parametrize(
    "arguments, word",
    [({"friction": "yes"}, "friction: got 'yes'"), ({"friction": 0.5}, "friction: got 0.5"),
     ({"friction": NAN}, "friction: got nan"), ({"state": 3}, "state: got 3"), ({"hold": "rope"}, "hold: got 'rope'"),
     ({"hold": ["rop"]}, "did you mean 'rope'")],
)  # fmt: skip
def test_requests_to_statics(arguments, word):
    system = fs.assemble(model())
    refused(fs.CaseError, lambda: fs.solve_static(system, **arguments), [word])


HELPERS = {
    "statics of a model": (fs.CaseError, lambda: fs.solve_static(model()), "system: got Model(", "assemble(model)"),
    "shares": (fs.CaseError, lambda: fs.section_lengths(82.0, shares=3), "shares: got 3", "a list"),
    "weights": (fs.CaseError, lambda: fs.diameter_from_weights("1", 2.0), "dry: got '1'", "positive number"),
    "wet": (fs.CaseError, lambda: fs.diameter_from_weights(3.0, None), "wet: got None", "a number"),
    "build": (fs.CaseError, lambda: fs.sizing(3, {"a": [1]}, "rope"), "build: got 3", "a function"),
    "grid": (fs.CaseError, lambda: fs.sizing(model, 3, "rope"), "grid: got 3", "a dictionary"),
    "speed": (fs.ModelError, lambda: fs.Motion.at_speed("a", "b", 1.0), "Motion.at_speed: got start 'a'", "two points"),
    "shape's name": (fs.ModelError, lambda: fs.Catenary("steep"), "Catenary: got 'steep'", "Catenary()"),
    "profile": (fs.ModelError, lambda: fs.Current(speed=1.0, profile=3), "profile: got 3; must be a PowerLaw or"),
    "far nodes": (fs.ModelError, lambda: fs.Nodes(coordinates=[[0, 0, 0], [0, 0, 1e300]]), "not all are numbers"),
}


@pytest.mark.parametrize("case", HELPERS)
def test_helpers(case):
    error, make, *words = HELPERS[case]
    refused(error, make, words)
