"""Current profiles: closed forms, what is between the rows of a table, bad input."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import floatsim as fs
from floatsim.errors import ModelError
from floatsim.sea.site import Current, CurrentTable, PowerLaw


def test_uniform():
    current = Current(speed=2.0, heading_deg=30.0)
    expected = [np.sqrt(3.0), 1.0, 0.0]
    assert current.velocity == pytest.approx(expected)
    assert current.at([3.0, 0.0, -10.0, -99.0], 50.0) == pytest.approx(np.tile(expected, (4, 1)))
    assert Current(speed=0.0).at([-3.0], 50.0).tolist() == [[0.0, 0.0, 0.0]]


def test_power_law():
    current = Current(speed=1.5, heading_deg=180.0, profile=PowerLaw())
    z = [5.0, 0.0, -25.0, -50.0, -60.0]
    assert current.at(z, 50.0)[:, 0] == pytest.approx([-1.5, -1.5, -1.5 * 0.5 ** (1.0 / 7.0), 0.0, 0.0], abs=1e-15)
    assert current.velocity == pytest.approx([-1.5, 0.0, 0.0], abs=1e-15)
    # the mean over the depth is 1/(1 + exponent)
    y = 50.0 * ((np.arange(100000) + 0.5) / 100000 - 1.0)
    for exponent in (1.0 / 7.0, 1.0, 0.5):
        profile = Current(speed=1.0, profile=PowerLaw(exponent=exponent))
        assert profile.at(y, 50.0)[:, 0].mean() == pytest.approx(1.0 / (1.0 + exponent), rel=1e-5)


def test_table():
    current = Current.table(depths=[0, 10, 30], speeds=[1.0, 0.6, 0.2], headings_deg=[0.0, 90.0, 120.0])
    z = [4.0, 0.0, -5.0, -10.0, -20.0, -30.0, -80.0]
    at = current.at(z, 100.0)
    assert at.shape == (7, 3)
    assert np.hypot(at[:, 0], at[:, 1]) == pytest.approx([1.0, 1.0, 0.8, 0.6, 0.4, 0.2, 0.2])
    assert np.degrees(np.arctan2(at[:, 1], at[:, 0])) == pytest.approx([0.0, 0.0, 45.0, 90.0, 105.0, 120.0, 120.0])
    assert current.velocity == pytest.approx([1.0, 0.0, 0.0])


@pytest.mark.parametrize("headings", [(350.0, 10.0), (-10.0, 10.0), (10.0, 350.0), (350.0, 370.0)])
def test_a_table_turns_the_shorter_way(headings):
    middle = Current.table(depths=[0, 20], speeds=[1.0, 1.0], headings_deg=headings).at([-10.0], 50.0)[0]
    assert middle == pytest.approx([1.0, 0.0, 0.0], abs=1e-12)


def test_a_jet_below_the_surface():
    """Nothing at the surface, the fastest at 40 m; one heading for all rows; the first row below the surface."""
    current = Current.table(depths=[5, 40, 60], speeds=[0.0, 0.8, 0.0], headings_deg=90.0)
    assert current.velocity == pytest.approx([0.0, 0.0, 0.0], abs=1e-15)
    assert current.at([-1.0, -22.5, -40.0, -50.0], 100.0)[:, 1] == pytest.approx([0.0, 0.4, 0.8, 0.4], abs=1e-15)
    calm = Current.table(depths=[0, 9], speeds=[0.0, 0.0])
    assert not calm.at([-4.0], 10.0).any()


def test_a_relative_table_scales_and_turns_with_its_current():
    profile = CurrentTable(depths=[0, 100], factors=[1.0, 0.5], turns_deg=[0.0, 30.0])
    assert Current(speed=2.0, heading_deg=60.0, profile=profile).at([-100.0], 100.0)[0] == pytest.approx(
        [0.0, 1.0, 0.0], abs=1e-12
    )
    straight = CurrentTable(depths=[0, 100], factors=[1.0, 0.5])
    assert Current(speed=2.0, profile=straight).at([-50.0], 100.0)[0] == pytest.approx([1.5, 0.0, 0.0])


@given(
    rows=st.lists(
        st.tuples(st.floats(0.0, 500.0), st.floats(0.0, 3.0), st.floats(-360.0, 360.0)),
        min_size=1, max_size=6, unique_by=lambda row: round(row[0], 3),
    ),
    z=st.floats(-600.0, 20.0),
)  # fmt: skip
def test_speeds_stay_between_those_of_the_rows(rows, z):
    rows.sort()
    depths, speeds, headings = zip(*rows)
    current = Current.table(depths=depths, speeds=speeds, headings_deg=headings)
    speed = np.hypot(*current.at([z], 300.0)[0, :2])
    assert min(speeds) - 1e-12 <= speed <= max(speeds) + 1e-12
    for depth, expected, heading in rows:
        b = np.radians(heading)
        got = current.at([-depth], 300.0)[0]
        assert got == pytest.approx([expected * np.cos(b), expected * np.sin(b), 0.0], abs=1e-9)


@pytest.mark.parametrize(("z", "expected"), [(0.0, [0.0, 0.7, 0.0]), (10.0, [0.0, 0.7, 0.0]), (-50.0, [0.1, 0.0, 0.0])])
def test_bodies_feel_the_current_of_the_depth_they_are_drawn_at(z, expected):
    body = fs.Body(name="buoy", mass=1.0, inertia=(1.0, 1.0, 1.0), position=(0.0, 0.0, z))
    current = Current.table(depths=[0, 50], speeds=[0.7, 0.1], headings_deg=[90.0, 0.0])
    system = fs.assemble(fs.Model(parts=[body], sea=fs.Sea(depth=50.0, current=current)))
    assert system.work().u[0] == pytest.approx(expected, abs=1e-15)


ROWS = {"depths": [0, 10], "speeds": [1.0, 0.5], "headings_deg": [0.0, 20.0]}
TABLE = {"depths": [0, 10], "factors": [1.0, 0.5], "turns_deg": [0.0, 20.0]}
BAD = {
    "speed": (lambda: Current(speed=-1.0), "Current: speed: got -1.0", "not negative"),
    "profile": (lambda: Current(speed=1.0, profile="power"), "Current: profile: got 'power'", "PowerLaw", "Table"),
    "exponent": (lambda: PowerLaw(exponent=0.0), "PowerLaw: exponent: got 0.0", "must be a positive number"),
    "too few speeds": (lambda: Current.table(**{**ROWS, "speeds": [1.0]}), "Current.table: speeds has 1 values"),
    "headings": (lambda: Current.table(**{**ROWS, "headings_deg": [1.0, 2.0, 3.0]}), "headings_deg has 3 values"),
    "negative speed": (lambda: Current.table(**{**ROWS, "speeds": [1.0, -0.2]}), "speeds has -0.2 m/s", "heading"),
    "no rows": (lambda: Current.table(depths=[], speeds=[]), "Current.table: depths"),
    "NaN": (lambda: Current.table(**{**ROWS, "depths": [0, np.nan]}), "Current.table: depths: got", "finite numbers"),
    "upwards": (lambda: Current.table(**{**ROWS, "depths": [0, -10]}), "depths has -10 m", "positive, downwards"),
    "order": (lambda: Current.table(**{**ROWS, "depths": [10, 10]}), "depths (10.0, 10.0)", "must increase"),
    "factors": (lambda: CurrentTable(**{**TABLE, "factors": [1.0]}), "CurrentTable: factors has 1 values"),
    "turns": (lambda: CurrentTable(**{**TABLE, "turns_deg": [1.0]}), "CurrentTable: turns_deg has 1 values"),
    "negative factor": (lambda: CurrentTable(**{**TABLE, "factors": [1.0, -1.0]}), "factors has -1", "turns_deg = 180"),
    "text": (lambda: CurrentTable(**{**TABLE, "depths": "0 10"}), "CurrentTable: depths: got", "finite numbers"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_bad_input(case):
    build, *words = BAD[case]
    with pytest.raises(ModelError) as error:
        build()
    for word in words:
        assert word in str(error.value)
