"""First shapes of lines: closed forms, exact chords, tangency, ends, and what is refused."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from floatsim.errors import ModelError
from floatsim.parts.shapes import (
    Arc,
    Catenary,
    Nodes,
    Straight,
    ThreeCircles,
    catenary_parameter,
    chord_radius,
    hanging_arc,
    touchdown_parameter,
)

DEPTH = 82.0
LENGTHS = (56.58, 56.58, 113.16)  # 2.76 x 82 m as 0.25, 0.25, 0.50: Verelst et al. 2024
TOP, ANCHOR = np.zeros(3), np.array([125.0, 0.0, -DEPTH])


def arc_lengths(lengths, elements):
    starts = np.concatenate([[0.0], np.cumsum(lengths)])
    parts = [start + np.linspace(0.0, length, n + 1)[1:] for start, length, n in zip(starts, lengths, elements)]
    return np.concatenate([[0.0], *parts])


NODES = arc_lengths(LENGTHS, (57, 57, 113))


def chords(x):
    return np.linalg.norm(np.diff(x, axis=0), axis=1)


def slopes(x):
    d = np.diff(x, axis=0)
    return np.arctan2(d[:, 2], np.hypot(d[:, 0], d[:, 1]))


class Section:
    def __init__(self, mass_per_length, diameter):
        self.mass_per_length, self.area = mass_per_length, 0.25 * math.pi * diameter**2


class Piece:
    def __init__(self, length, mass_per_length, diameter):
        self.length, self.section = length, Section(mass_per_length, diameter)


class Line:
    def __init__(self, *pieces):
        self.pieces = tuple(Piece(*piece) for piece in pieces)


HEAVY, LIGHT = (72.0, 0.2), (115.0, 0.428)
LAZY_WAVE = Line((LENGTHS[0], *HEAVY), (LENGTHS[1], *LIGHT), (LENGTHS[2], *HEAVY))


# -- three circles -------------------------------------------------------------------------------


def test_three_circles_have_exact_chords_and_ends():
    x = ThreeCircles(lengths=LENGTHS).points(TOP, ANCHOR, NODES, DEPTH)
    np.testing.assert_array_equal(x[[0, -1]], [TOP, ANCHOR])
    np.testing.assert_allclose(chords(x), np.diff(NODES), rtol=0.0, atol=1e-12)


def test_three_circles_turn_evenly_and_land_tangentially():
    shape = ThreeCircles(lengths=LENGTHS)
    circles = shape.circles(TOP, ANCHOR, NODES, DEPTH)
    x = shape.points(TOP, ANCHOR, NODES, DEPTH)
    turns = np.abs(np.diff(np.unwrap(np.arctan2(np.diff(x[:, 2]), np.diff(x[:, 0])))))
    c = np.diff(NODES).max()
    assert turns.max() <= c / min(circles.R1, circles.R2, circles.R3) + 1e-12  # no corner anywhere
    on_bed = circles.knots[5] <= NODES
    np.testing.assert_allclose(x[on_bed, 2], -DEPTH, atol=1e-12)
    assert on_bed.sum() == pytest.approx(circles.x32 / c, abs=1.5)
    first = int(np.argmax(on_bed))
    assert turns[first - 1] <= c / circles.R3 + 1e-12


def test_nodes_of_the_hog_lie_on_the_circle_of_the_chords():
    shape = ThreeCircles(lengths=LENGTHS)
    circles = shape.circles(TOP, ANCHOR, NODES, DEPTH)
    x = shape.points(TOP, ANCHOR, NODES, DEPTH)[58:114, ::2]  # of the section's elements, without the first
    y = np.linalg.lstsq(np.c_[2.0 * x, np.ones(len(x))], (x**2).sum(axis=1), rcond=None)[0]
    radius = math.sqrt(y[2] + y[0] ** 2 + y[1] ** 2)
    element = LENGTHS[1] / 57
    # 57 chords of 2 R' sin(l/2R) turn by 2 y in all
    assert chord_radius(element, circles.R2) == pytest.approx(0.5 * element / math.sin(circles.y / 57), rel=1e-12)
    assert radius == pytest.approx(chord_radius(element, circles.R2), rel=1e-9)
    assert radius == pytest.approx(circles.R2 * (1.0 + (element / circles.R2) ** 2 / 24.0), rel=1e-6)


def test_three_circles_are_those_of_the_source_where_straights_are_vertical():
    """h = crest + R2 + R3 + x31, l3 = x31 + x32 + R3 pi/2, l2 = R2 pi (Verelst et al. 2024, section 4.3)."""
    d, R3 = 16.0, 12.0
    R2 = LENGTHS[1] / math.pi
    x31, x11 = DEPTH - d - R2 - R3, d + R2
    x32, R1 = LENGTHS[2] - x31 - R3 * math.pi / 2.0, (LENGTHS[0] - x11) / math.pi
    fine = arc_lengths(LENGTHS, (5700, 5700, 11300))
    anchor = np.array([2.0 * R1 + 2.0 * R2 + R3 + x32, 0.0, -DEPTH])
    circles = ThreeCircles(lengths=LENGTHS, crest_depth=d, touchdown_radius=R3).circles(TOP, anchor, fine, DEPTH)
    got = (circles.y, circles.x11, circles.R1, circles.R2, circles.x31, circles.R3, circles.x32)
    np.testing.assert_allclose(got, (math.pi / 2.0, x11, R1, R2, x31, R3, x32), atol=1e-4)
    assert circles.crest == pytest.approx(d, abs=1e-4)
    assert circles.sag == pytest.approx(x11 + R1, abs=1e-4)


@pytest.mark.parametrize("x", [40.0, 80.0, 125.0, 150.0, 190.0])
def test_three_circles_reach_near_and_far(x):
    shape, anchor = ThreeCircles(lengths=LENGTHS), np.array([0.6 * x, 0.8 * x, -DEPTH])
    assert not shape.problems(TOP, anchor, NODES, DEPTH)
    points = shape.points(TOP, anchor, NODES, DEPTH)
    np.testing.assert_allclose(chords(points), np.diff(NODES), rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(np.cross(points, [0.6, 0.8, 0.0])[:, 2], 0.0, atol=1e-11)
    assert points[:, 2].min() >= -DEPTH - 1e-9 and points[1:, 2].max() < 0.0


def test_three_circles_from_the_anchor_are_the_same_upside_down():
    there = ThreeCircles(lengths=LENGTHS).points(TOP, ANCHOR, NODES, DEPTH)
    back = ThreeCircles(lengths=LENGTHS[::-1]).points(ANCHOR, TOP, NODES[-1] - NODES[::-1], DEPTH)
    np.testing.assert_allclose(back[::-1], there, atol=1e-11)


def test_three_circles_find_their_sections_on_the_line():
    given = ThreeCircles(lengths=LENGTHS).points(TOP, ANCHOR, NODES, DEPTH)
    np.testing.assert_array_equal(ThreeCircles().points(TOP, ANCHOR, NODES, DEPTH, LAZY_WAVE), given)
    halves = Line((20.0, *HEAVY), (36.58, *HEAVY), (30.0, *LIGHT), (26.58, *LIGHT), (113.16, *HEAVY))
    np.testing.assert_allclose(ThreeCircles().points(TOP, ANCHOR, NODES, DEPTH, halves), given, atol=1e-11)


@pytest.mark.parametrize(
    "shape, anchor, line, said",
    [
        (ThreeCircles(), ANCHOR, None, "do not sink, float and sink"),
        (ThreeCircles(), ANCHOR, Line((226.32, *HEAVY)), "do not sink, float and sink"),
        (ThreeCircles(lengths=(50.0, 50.0, 100.0)), ANCHOR, None, "together 200 m; the line is 226.32 m long"),
        (ThreeCircles(lengths=LENGTHS), np.array([205.0, 0.0, -DEPTH]), None, "the ends are 205 m apart"),
        (ThreeCircles(lengths=LENGTHS), np.array([125.0, 0.0, 0.0]), None, "above"),
        (ThreeCircles(lengths=LENGTHS, crest_depth=80.0), ANCHOR, None, "crest_depth of 80 m: no circles larger"),
        (ThreeCircles(lengths=LENGTHS, touchdown_radius=70.0), ANCHOR, None, "the ends are 125 m apart"),
    ],
)
def test_three_circles_that_do_not_close_are_refused_with_the_reason(shape, anchor, line, said):
    problems = shape.problems(TOP, anchor, NODES, DEPTH, line)
    assert len(problems) == 1 and problems[0].startswith("ThreeCircles: ") and said in problems[0]
    drawn = shape.points(TOP, anchor, NODES, DEPTH, line)
    np.testing.assert_array_equal(drawn, Arc().points(TOP, anchor, NODES, DEPTH))


def test_the_range_that_is_named_is_the_range_that_closes():
    shape = ThreeCircles(lengths=LENGTHS)
    text = shape.problems(TOP, np.array([205.0, 0.0, -DEPTH]), NODES, DEPTH)[0]
    most = float(text.split(" to ")[1].split(" m in")[0])
    assert not shape.problems(TOP, np.array([most - 1.0, 0.0, -DEPTH]), NODES, DEPTH)
    assert shape.problems(TOP, np.array([most + 1.0, 0.0, -DEPTH]), NODES, DEPTH)


# -- catenary ------------------------------------------------------------------------------------


def test_catenary_of_the_hanging_chain():
    """Half span 40 m, length 100 m: sinh(40/a) = 50/a."""
    a = catenary_parameter(80.0, 0.0, 100.0)
    assert math.sinh(40.0 / a) == pytest.approx(50.0 / a, rel=1e-12)
    assert a == pytest.approx(33.8202, abs=1e-4)  # by bisection of the line above
    s = np.linspace(0.0, 100.0, 41)
    x = Catenary().points(np.array([-40.0, 0.0, 60.0]), np.array([40.0, 0.0, 60.0]), s, 50.0)
    np.testing.assert_allclose(x[:, 0], a * np.arcsinh((s - 50.0) / a), atol=1e-10)
    sag = a * (np.cosh(40.0 / a) - np.cosh(x[:, 0] / a))
    np.testing.assert_allclose(x[:, 2], 60.0 - sag, atol=1e-10)


# horizontal pull [N], weight [N/m], line on the bed [m] of practically inextensible lines.
# Source: MoorPy (BSD-3), whose solver stops at 1e-6
@pytest.mark.parametrize(
    "bed, pull, weight, lying", [(0.0, 96643.42815934, 800.0, 202.81030558), (372.7, 43694.580989, 200.0, 0.0)]
)
def test_catenary_against_another_code(bed, pull, weight, lying):
    a, b, s = np.zeros(3), np.array([400.0, 0.0, 200.0]), np.linspace(0.0, 500.0, 5001)
    x = Catenary().points(a, b, s, bed)
    assert s[x[:, 2] <= 1e-9 - bed].max(initial=0.0) == pytest.approx(lying, abs=0.1)
    H = touchdown_parameter(400.0, (0.0, 200.0), 500.0) if lying else catenary_parameter(400.0, 200.0, 500.0)
    assert weight * H == pytest.approx(pull, rel=1e-6)
    steepest = (500.0 - lying) / H if lying else (500.0 - 22365.599350 / weight) / H  # V/H at the upper end
    top = (x[-1, 2] - x[-2, 2]) / (x[-1, 0] - x[-2, 0])
    assert top == pytest.approx(steepest, rel=1e-3)


def test_catenary_with_its_middle_on_the_bed():
    """Both ends h above the bed carry sqrt(h (h + 2a)) over a acosh(1 + h/a), the rest lies."""
    h, length = np.array([50.0, 30.0]), 350.0
    s = np.linspace(0.0, length, 3501)
    x = Catenary().points(np.array([0.0, 0.0, -50.0]), np.array([300.0, 0.0, -70.0]), s, 100.0)
    a = touchdown_parameter(300.0, (50.0, 30.0), length)
    off, span = np.sqrt(h * (h + 2.0 * a)), a * np.arccosh(1.0 + h / a)
    assert span.sum() + length - off.sum() == pytest.approx(300.0, abs=1e-9)
    lies = x[:, 2] <= -100.0 + 1e-9
    assert lies.sum() == pytest.approx((length - off.sum()) / 0.1, abs=1.0)
    np.testing.assert_allclose(chords(x), 0.1, rtol=1e-5)
    np.testing.assert_array_equal(x[:, 1], 0.0)


def test_slack_without_a_pull_lies_in_an_arc_on_the_bed():
    assert touchdown_parameter(100.0, (50.0, 0.0), 151.0) is None
    s = np.linspace(0.0, 200.0, 401)
    x = Catenary().points(np.array([0.0, 0.0, -50.0]), np.array([100.0, 0.0, -100.0]), s, 100.0)
    assert x[:, 2].min() >= -100.0 - 1e-9
    assert np.abs(x[:, 1]).max() > 10.0
    assert chords(x).min() > 0.4 and chords(x).max() <= 0.5 + 1e-9
    np.testing.assert_array_equal(x[[0, -1]], [(0.0, 0.0, -50.0), (100.0, 0.0, -100.0)])


def test_a_line_that_floats_is_the_catenary_upside_down():
    a, b, s = np.array([0.0, 0.0, -100.0]), np.array([80.0, 0.0, -90.0]), np.linspace(0.0, 100.0, 41)
    down = Catenary().points(a * (1, 1, -1), b * (1, 1, -1), s, 0.0, Line((100.0, *HEAVY)))
    up = Catenary().points(a, b, s, 200.0, Line((100.0, *LIGHT)))
    np.testing.assert_allclose(up * (1, 1, -1), down, atol=1e-9)
    assert up[1:-1, 2].max() > -90.0
    tight = Catenary().points(a / 10.0, b / 10.0, s, 200.0, Line((100.0, *LIGHT)))
    assert tight[:, 2].max() == pytest.approx(0.0, abs=1e-9)  # the surface holds it


def test_taut_lines_are_straight():
    a, b, s = np.zeros(3), np.array([60.0, 0.0, -80.0]), np.array([0.0, 20.0, 99.0])
    for shape in (Catenary(), Arc(), ThreeCircles(lengths=(20.0, 30.0, 49.0))):
        np.testing.assert_allclose(shape.points(a, b, s, 90.0), np.outer(s / 99.0, b), atol=1e-12)
        assert shape.problems(a, b, s, 90.0) == []


@settings(max_examples=150, deadline=None)
@given(
    st.floats(20.0, 1000.0), st.floats(-3.0, 1.0), st.floats(0.0, 1.0), st.floats(0.0, 1.0), st.floats(-8.0, 0.3),
    st.floats(0.0, 6.3), st.booleans(), st.integers(2, 120),
)  # fmt: skip
def test_catenaries_and_arcs_of_all_lines_stay_in_the_water(depth, far, za, zb, slack, heading, light, n):
    X = depth * 10.0**far
    a = np.array([10.0, -20.0, -za * depth])
    b = np.array([10.0 + X * math.cos(heading), -20.0 + X * math.sin(heading), -zb * depth])
    length = float(np.linalg.norm(b - a)) * (1.0 + 10.0**slack)
    s, line = np.linspace(0.0, length, n + 1), Line((length, *(LIGHT if light else HEAVY)))
    for shape in (Catenary(), Arc()):
        x = shape.points(a, b, s, depth, line)
        assert np.isfinite(x).all()
        np.testing.assert_array_equal(x[[0, -1]], [a, b])
        assert x[:, 2].min() >= -depth * (1.0 + 1e-9)
        assert chords(x).max() <= length / n * (1.0 + 1e-6)  # chords of a curve of the line's length
    if light:
        assert Catenary().points(a, b, s, depth, line)[:, 2].max() <= max(a[2], b[2]) + length


# -- arc and straight ----------------------------------------------------------------------------


def test_arc_has_the_length_of_the_line():
    a, b = np.array([0.0, 0.0, -10.0]), np.array([60.0, 80.0, -20.0])
    s = np.concatenate([np.linspace(0.0, 40.0, 201), np.linspace(40.0, 130.0, 101)[1:]])  # unequal elements
    x = hanging_arc(a, b, s, 1000.0)
    np.testing.assert_allclose(chords(x), np.diff(s), rtol=1e-4)
    np.testing.assert_array_equal(x[[0, -1]], [a, b])
    chord = np.linalg.norm(b - a)
    y = np.linalg.norm(x - 0.5 * (a + b), axis=1).min()  # its depth below the middle of the chord is R (1 - cos y)
    R = (chord**2 / 4.0 + y**2) / (2.0 * y)
    assert 2.0 * R * math.asin(chord / (2.0 * R)) == pytest.approx(130.0, rel=1e-3)


def test_straight_strains_evenly():
    s = np.array([0.0, 1.0, 4.0, 10.0])
    x = Straight().points(np.array([1.0, 2.0, 3.0]), np.array([21.0, 2.0, 3.0]), s, 50.0)
    np.testing.assert_allclose(chords(x), 2.0 * np.diff(s), rtol=1e-14)


# -- given nodes ---------------------------------------------------------------------------------


def test_nodes_are_taken_as_they_are():
    given = np.array([[0.0, 0.0, 0.0], [3.0, 1.0, -5.0], [10.0, 0.0, 0.0]])
    x = Nodes(coordinates=given).points(given[0], given[2], np.array([0.0, 6.0, 14.0]), 50.0)
    np.testing.assert_array_equal(x, given)


def test_another_number_of_nodes_is_interpolated_along_the_length():
    corner = [(0.0, 0.0, 0.0), (0.0, 0.0, -30.0), (10.0, 0.0, -30.0)]
    x = Nodes(coordinates=corner).points(np.zeros(3), np.array(corner[2]), np.array([0.0, 4.0, 30.0, 35.0, 40.0]), 50.0)
    np.testing.assert_allclose(x, [(0, 0, 0), (0, 0, -4), (0, 0, -30), (5, 0, -30), (10, 0, -30)], atol=1e-12)


def test_nodes_must_meet_the_ends_and_the_water():
    shape = Nodes(coordinates=[(0.0, 0.0, 0.0), (5.0, 0.0, -60.0), (10.0, 0.0, 0.0)])
    s = np.linspace(0.0, 20.0, 3)
    assert shape.problems(np.zeros(3), np.array([10.005, 0.0, 0.0]), s, 61.0) == []
    problems = shape.problems(np.array([0.0, 3.0, 4.0]), np.array([10.0, 0.0, -1.0]), s, 50.0)
    assert len(problems) == 3
    assert "first is at (0, 0, 0) m, 5 m from the line's end at (0, 3, 4) m" in problems[0]
    assert "last" in problems[1] and "at most 0.01 m" in problems[1]
    assert "row 1 (from 0) is at z = -60 m, below the bed at -50 m" in problems[2]


@pytest.mark.parametrize(
    "make, said",
    [
        (lambda: Nodes(coordinates=[(0.0, 0.0, 0.0)]), "two or more rows"),
        (lambda: Nodes(coordinates=[(0.0, 0.0), (1.0, 0.0)]), "shape (2, 2)"),
        (lambda: Nodes(coordinates=[(0.0, 0.0, 0.0), (1.0, 0.0)]), "rows differ in length"),
        (lambda: Nodes(coordinates=[(0.0, 0.0, 0.0), (1.0, 0.0, math.nan)]), "not all are numbers"),
        (lambda: Nodes(coordinates=[("0", "0", "0"), ("1", "0", "0")]), "not all are numbers"),
        (lambda: Nodes(coordinates=None), "two or more rows"),
        (lambda: Nodes(coordinates=[(1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)]), "rows 1 and 2"),
        (lambda: Nodes(coordinates=[(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)], tolerance=0.0), "tolerance"),
        (lambda: ThreeCircles(lengths=(1.0, 2.0)), "three positive lengths"),
        (lambda: ThreeCircles(lengths=(1.0, -2.0, 3.0)), "must be positive"),
        (lambda: ThreeCircles(crest_depth=-3.0), "crest_depth: got -3.0; must be a positive number"),
        (lambda: ThreeCircles(radius=3.0), "unknown argument 'radius'"),
        (lambda: Catenary(depth=3.0), "unknown argument 'depth'"),
    ],
)
def test_bad_shapes_are_refused_where_they_are_built(make, said):
    with pytest.raises(ModelError) as caught:
        make()
    assert said in str(caught.value)
