"""Section lengths, buoyancy, the sizing search, and the lazy wave itself from all first shapes."""

import math

import numpy as np
import pytest
from shipped import load

import floatsim as fs
from floatsim.study.channels import Sampler
from floatsim.study.lazy_wave import diameter_from_weights, section_lengths, sizing

chain = load("hanging_chain").build
lazy_wave = load("lazy_wave").build
LIMITS = {"max_curvature": 0.05, "breaking_load": 1.0e5}


# -- by hand -------------------------------------------------------------------------------------


def test_section_lengths_in_proportion_to_the_depth():
    assert section_lengths(82.0) == pytest.approx((56.58, 56.58, 113.16))  # Verelst et al. 2024
    assert section_lengths(100.0, 2.0, (0.5, 0.2, 0.3)) == pytest.approx((100.0, 40.0, 60.0))


def test_diameter_from_weights_of_the_source():
    """The printed 423 mm give -284 N/m, 428 mm are needed for -316 N/m."""
    assert diameter_from_weights(1129.0, -316.0) == pytest.approx(0.428, abs=5e-4)
    assert diameter_from_weights(1129.0, -284.0) == pytest.approx(0.423, abs=5e-4)
    assert diameter_from_weights(1025.0 * 9.81 * math.pi, 0.0) == pytest.approx(2.0)


@pytest.mark.parametrize(
    "make, said",
    [
        (lambda: section_lengths(-82.0), "depth: got -82.0; must be a positive number"),
        (lambda: section_lengths(82.0, math.nan), "length_per_depth: got nan"),
        (lambda: section_lengths(82.0, 2.76, (0.5, 0.6)), "together 1.1; must be together 1"),
        (lambda: section_lengths(82.0, 2.76, (1.5, -0.5)), "shares: got -0.5"),
        (lambda: diameter_from_weights(100.0, 200.0), "dry - wet: got -100.0"),
        (lambda: diameter_from_weights(-1.0, -2.0), "dry: got -1.0"),
        (lambda: diameter_from_weights(2.0, 1.0, 0.0), "density: got 0.0"),
    ],
)
def test_bad_numbers_are_refused(make, said):
    with pytest.raises(fs.CaseError) as caught:
        make()
    assert said in str(caught.value)


# -- sizing --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def found():
    grid = {"length": [100.0, 85.0, 79.0, 160.0, 95.0], "elements": [100, np.int64(60)]}
    return sizing(chain, grid, line="chain", **LIMITS)


def test_fitness_of_a_catenary(found):
    """a sinh(40/a) = length/2; largest curvature 1/a, largest tension w a cosh(40/a), an element's middle lower."""
    row = next(row for row in found.rows if row.values == {"length": 100.0, "elements": 100})
    a, w = 33.82018790853497, 50.0 * 9.81
    assert a * math.sinh(40.0 / a) == pytest.approx(50.0, rel=1e-12)
    assert row.max_curvature == pytest.approx(1.0 / a, rel=1e-3)
    assert row.max_tension == pytest.approx(math.hypot(w * a, w * 49.5), rel=1e-3)
    assert row.curvature_utilisation == pytest.approx(row.max_curvature / 0.05)
    assert row.fitness == pytest.approx(row.max_curvature / 0.05 + row.max_tension / 1.0e5)
    assert math.isnan(row.sag) and math.isnan(row.hog)


def test_best_first_then_over_a_limit_then_impossible(found):
    groups = [2 if row.reason else 0 if row.allowed else 1 for row in found.rows]
    assert groups == sorted(groups) and set(groups) == {0, 1, 2}
    for group in (0, 1):
        fitness = [row.fitness for row, own in zip(found.rows, groups) if own == group]
        assert fitness == sorted(fitness)
    assert found.best is found.rows[0]
    assert {row.values["length"] for row in found.rows if row.allowed} == {85.0, 95.0, 100.0}
    over = [row for row, group in zip(found.rows, groups) if group == 1]
    assert {row.values["length"] for row in over} == {160.0}  # hangs almost as a hairpin
    failed = [row for row, group in zip(found.rows, groups) if group == 2]
    assert [row.values for row in failed] == [{"length": 79.0, "elements": 100}, {"length": 79.0, "elements": 60}]
    assert "Line 'chain': length is 79 m but its ends are 80 m apart" in failed[0].reason
    assert math.isnan(failed[0].fitness) and not failed[0].allowed


def test_the_table_shows_every_point(found):
    lines = str(found).splitlines()
    assert "sizing of 'chain', fitness = curvature/0.05 1/m + tension/100 kN" in lines[0]
    rows = [line for line in lines if line.split() and line.split()[0] in ("79", "85", "95", "100", "160")]
    assert len(rows) == 10
    assert f"{found.best.fitness:.4f}" in rows[0]
    assert "of its limit" in rows[6] and "length is 79 m" in rows[9]


def test_a_search_repeats_itself():
    first, second = (sizing(chain, {"length": [90.0, 100.0], "elements": [20]}, "chain", **LIMITS) for _ in range(2))
    assert first == second


def test_what_cannot_be_built_or_solved_is_a_row():
    def build(kind):
        if kind == "division":
            return chain(length=1.0 / 0.0)
        if kind == "value":
            return chain(length=float("long"))
        return chain(length=-1.0) if kind == "model" else chain()

    found = sizing(build, {"kind": ["model", "value", "division", "fine"]}, "chain", **LIMITS)
    assert [row.values["kind"] for row in found.rows] == ["fine", "model", "value", "division"]
    reasons = {row.values["kind"]: row.reason for row in found.rows}
    assert reasons["fine"] == ""
    assert "length: got -1.0; must be a positive number" in reasons["model"]
    assert reasons["value"].startswith("ValueError: ") and reasons["division"].startswith("ZeroDivisionError: ")
    nothing = sizing(build, {"kind": ["value", "model"]}, "chain", **LIMITS)
    assert nothing.best is None and "ValueError" in str(nothing)


@pytest.mark.parametrize(
    "changes, said",
    [
        ({"grid": {}}, "the grid is empty"),
        ({"grid": {"lenght": [90.0]}}, "build takes no parameter 'lenght' (did you mean 'length'?)"),
        ({"grid": {"length": []}}, "'length' has no values"),
        ({"grid": {"length": 90.0}}, "'length': got 90.0; must be a list of values"),
        ({"grid": {"length": "90"}}, "'length': got '90'; must be a list of values"),
        ({"line": "chian"}, "there is no line 'chian' (did you mean 'chain'?)"),
        ({"max_curvature": 0.0}, "max_curvature: got 0.0; must be a positive number"),
        ({"breaking_load": math.inf}, "breaking_load: got inf"),
        ({"max_curvature": None}, "no section of 'chain' has a minimum_bend_radius"),
        ({"breaking_load": None}, "no section of 'chain' has a breaking_load"),
    ],
)
def test_bad_searches_are_refused(changes, said):
    with pytest.raises(fs.CaseError) as caught:
        sizing(chain, **{"grid": {"length": [90.0]}, "line": "chain", **LIMITS, **changes})
    assert said in str(caught.value)


def test_limits_of_the_sections_are_the_default():
    def build(length):
        wire = fs.Section(name="wire", mass_per_length=50.0, diameter=0.05, EA=2e8, minimum_bend_radius=20.0,
                          breaking_load=1.0e5)  # fmt: skip
        weak = wire.model_copy(update={"name": "weak", "minimum_bend_radius": 25.0, "breaking_load": 5.0e4})
        pieces = [fs.Piece(section=part, length=length / 2.0, elements=20) for part in (wire, weak)]
        ends = [fs.Ball(a="rope.end_a", b=(0.0, 0.0, 60.0)), fs.Ball(a="rope.end_b", b=(80.0, 0.0, 60.0))]
        return fs.Model(parts=[fs.Line(name="rope", pieces=pieces)], joints=ends, sea=fs.Sea(depth=50.0))

    found = sizing(build, {"length": [100.0]}, "rope")
    assert found.max_curvature == pytest.approx(1.0 / 25.0) and found.breaking_load == 5.0e4
    assert found.rows[0].curvature_utilisation == pytest.approx(25.0 * found.rows[0].max_curvature)


# -- the lazy wave -------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def waves():
    """First shape -> (nodes, tension, bending moment, arc length) in equilibrium."""
    found = {}
    for shape in ("circles", "catenary", "arc", "straight"):
        model = lazy_wave(shape=shape)
        system = fs.assemble(model)
        state, report = fs.solve_static(system)
        assert report.converged and report.balance < 1e-6
        sampler = Sampler(system, [f"cable_{what}" for what in ("position", "tension", "bending_moment")])
        row = sampler.sample_state(state)[None]
        found[shape] = (*(sampler.column(row, channel.name)[0] for channel in sampler.channels),
                        model.parts[0].arc_length)  # fmt: skip
    return found


@pytest.mark.parametrize("shape", ["circles", "catenary", "arc", "straight"])
def test_lazy_wave_of_the_source(waves, shape):
    """MoorDyn 2.7.2, fully relaxed: sag, hog, touchdown, tension at the top and on the bed, largest moment."""
    x, tension, moment, s = waves[shape]
    hog = 60 + int(np.argmax(x[60:120, 2]))
    assert x[:hog, 2].min() == pytest.approx(-39.82, abs=0.1)
    assert x[hog, 2] == pytest.approx(-15.99, abs=0.1)
    assert s[np.argmax(x[:, 2] <= -82.0)] == pytest.approx(147.0, abs=1.0)
    assert tension[0] == pytest.approx(16.60e3, rel=0.01)
    assert tension[-1] == pytest.approx(0.97e3, abs=20.0)
    assert moment.max() == pytest.approx(2419.0, rel=0.02)


def test_one_equilibrium_from_all_first_shapes(waves):
    x = waves["circles"][0]
    for shape in ("catenary", "arc", "straight"):
        np.testing.assert_allclose(waves[shape][0], x, rtol=0.0, atol=1e-6)


def test_sizing_sees_sag_and_hog_of_a_lazy_wave():
    found = sizing(lazy_wave, {"wet_buoyant": [-316.0]}, "cable", max_curvature=0.3, breaking_load=1.0e5)
    row = found.rows[0]
    assert row.sag == pytest.approx(-39.82, abs=0.1) and row.hog == pytest.approx(-15.99, abs=0.1)
    assert row.fitness == pytest.approx(2419.0 / 10e3 / 0.3 + 16.60e3 / 1.0e5, rel=0.02)


def test_an_unknown_shape_is_refused():
    with pytest.raises(fs.ModelError, match="shape: got 'circle'; must be one of circles, catenary, arc, straight"):
        lazy_wave(shape="circle")


def test_a_wave_too_short_for_its_circles_is_refused_by_name():
    with pytest.raises(fs.ModelError) as caught:
        lazy_wave(x_anchor=205.0)
    assert "cable" in str(caught.value) and "ThreeCircles" in str(caught.value)
    assert "the ends are 205 m apart" in str(caught.value)
