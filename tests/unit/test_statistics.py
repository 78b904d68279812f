"""Statistics while running: against closed forms, a published rainflow count, and the series themselves."""

from __future__ import annotations

import pickle
from types import SimpleNamespace

import numpy as np
import pytest
import xarray
from hypothesis import given, settings
from hypothesis import strategies as st

import floatsim as fs
from floatsim.errors import CaseError
from floatsim.study.simulate import simulate
from floatsim.study.statistics import (
    Statistics,
    StatisticsSettings,
    decay_variables,
    equivalent_load,
    mean_period,
    rainflow,
    statistics,
    turning_points,
    write_variables,
)
from floatsim.study.store import Channel, Coordinate

LAYOUT = SimpleNamespace(
    channels=(
        Channel("buoy_position", "buoy: position", "mixed", ("dof",), "float", "m m m rad rad rad"),
        Channel("rope_tension", "rope: effective tension", "N", ("rope_element",)),
        Channel("rope_tension_utilisation", "rope: effective tension over breaking load", "1", ("rope_element",)),
        Channel("rope_touchdown", "rope: first contact", "m"),
        Channel("newton_iterations", "Newton iterations", "1", (), "int32"),
    ),
    coordinates=(
        Coordinate("dof", "degree of freedom", "1", "dof", ("surge", "sway", "heave", "roll", "pitch", "yaw")),
        Coordinate("rope_element_arc_length", "arc length", "m", "rope_element", np.array([1.0, 3.0])),
    ),
)
STEP, COUNT = 0.05, 16001  # 0 to 800 s; t >= 200 s counts: ten periods of 60 s
OMEGA = 2.0 * np.pi / 60.0


def rows(t):
    """The buoy goes round an ellipse; a tension far from zero; a touchdown that is lost at times."""
    wave, zero = np.cos(OMEGA * t), np.zeros_like(t)
    buoy = np.stack([30.0 + 3.0 * wave, 2.0 * np.cos(OMEGA * t - 1.0), zero, zero, 0.1 * np.sin(OMEGA * t), zero + 0.2])
    tension = np.stack([1e9 + 3.0 * wave, 500.0 + 20.0 * np.sin(10.0 * OMEGA * t)])
    used = np.stack([tension[0] / 2e9, np.full_like(t, np.nan)])
    touchdown = np.where(t % 60.0 < 30.0, np.nan, 40.0 + wave)
    out = np.concatenate([buoy, tension, used, touchdown[None], 3.0 * np.ones_like(t)[None]]).T
    out[t < 200.0] *= 50.0  # the ramp must not be seen
    return np.ascontiguousarray(out)


TIME = STEP * np.arange(COUNT)


def taken(time=TIME, **given):
    found = Statistics(LAYOUT, StatisticsSettings(**given))
    for t, row in zip(time, rows(time)):
        found.append(float(t), row)
    return found


@pytest.fixture(scope="module")
def result():
    return taken(start=200.0, block=250.0, fatigue={"rope_tension": 4.0, "buoy_position": 3.0})


@pytest.fixture(scope="module")
def data(result):
    return result.dataset()


def test_moments_extremes_and_their_times(data):
    surge = data.sel(dof="surge")
    assert "time" not in data.dims and data.attrs["statistics_samples"] == 12001
    assert (data.attrs["statistics_start"], data.attrs["statistics_end"]) == (200.0, 800.0)
    n = 12001  # ten whole periods and the sample that closes them
    mean = 30.0 + 3.0 * np.cos(OMEGA * 200.0) / n
    assert float(surge.buoy_position_mean) == pytest.approx(mean, rel=1e-9)
    assert float(surge.buoy_position_std) == pytest.approx(3.0 / np.sqrt(2.0), rel=1e-3)
    assert (float(surge.buoy_position_min), float(surge.buoy_position_max)) == pytest.approx((27.0, 33.0), abs=1e-9)
    assert (surge.buoy_position_max_time % 60.0, surge.buoy_position_min_time % 60.0) == (
        pytest.approx(0.0, abs=1e-6), pytest.approx(30.0, abs=1e-6))  # fmt: skip
    assert float(data.newton_iterations_mean) == 3.0 and float(data.newton_iterations_std) == 0.0
    # sums of squares would have lost it: 1e18 has room for no 4.5
    kept = rows(TIME)[TIME > 199.99]
    assert data.rope_tension_std.values == pytest.approx(kept[:, 6:8].std(axis=0), rel=1e-7)


def test_period_between_upward_crossings_of_the_mean(data):
    assert float(data.buoy_position_period.sel(dof="surge")) == pytest.approx(60.0, rel=1e-4)
    assert float(data.rope_tension_period[1]) == pytest.approx(6.0, rel=1e-4)  # asked for by fatigue
    assert np.isnan(data.buoy_position_period.sel(dof="yaw"))  # it does not move
    assert np.isnan(data.rope_touchdown_period)  # its values are missing at times
    assert "rope_tension_utilisation_period" not in data
    t = np.linspace(0.0, 10.0, 1001)
    two = np.stack([np.sin(2.0 * np.pi * t + 0.3), t], axis=1)
    assert mean_period(t, two) == pytest.approx([1.0, np.nan], rel=1e-4, nan_ok=True)
    assert np.isnan(mean_period(t[:1], two[:1])).all()


def test_ellipse_in_plan(data):
    """Covariance of 3 cos and 2 cos(. - 1): half of 6 cos 1."""
    assert float(data.buoy_position_surge_sway_cov) == pytest.approx(3.0 * np.cos(1.0), rel=2e-3)
    x, y = rows(TIME)[TIME > 199.99, :2].T
    r = np.hypot(x, y)
    found = [float(data[f"buoy_offset_{kind}"]) for kind in ("mean", "std", "min", "max")]
    assert found == pytest.approx([r.mean(), r.std(), r.min(), r.max()], rel=1e-12)


def test_missing_values_are_counted_and_left_out(data):
    t = TIME[TIME > 199.99]
    there = t % 60.0 >= 30.0
    assert int(data.rope_touchdown_missing) == np.count_nonzero(~there)
    assert float(data.rope_touchdown_mean) == pytest.approx(np.mean(40.0 + np.cos(OMEGA * t[there])), rel=1e-12)
    assert np.isnan(data.rope_tension_utilisation_max[1]) and "rope_tension_utilisation_missing" not in data
    assert float(data.rope_tension_utilisation) == pytest.approx((1e9 + 3.0) / 2e9, rel=1e-12)


def test_extremes_of_blocks(data):
    """Blocks of 250 s from 200 s: to 450, 700 and, shorter, 800 s; one whole period is in each."""
    assert list(data.block_start.values) == [200.0, 450.0, 700.0]
    surge = data.buoy_position_block_max.sel(dof="surge")
    assert surge.dims == ("block",) and surge.values == pytest.approx([33.0, 33.0, 33.0], abs=1e-9)
    short = taken(TIME[:8001], start=200.0, block=100.0).dataset()  # to 400 s; a sample on the border is the earlier's
    t = TIME[:8001]
    x = rows(t)[:, 4]
    first, second = (t > 199.99) & (t < 300.01), (t > 300.01) & (t < 400.01)
    found = short.buoy_position_block_min.sel(dof="pitch")
    assert found.values == pytest.approx([x[first].min(), x[second].min()], abs=1e-15)


def test_long_gaps_leave_empty_blocks():
    found = Statistics(LAYOUT, StatisticsSettings(block=1.0))
    for t in (0.0, 3.5):
        found.append(t, rows(np.array([t]))[0])
    high = found.dataset().rope_tension_block_max
    assert high.shape == (4, 2) and list(np.isnan(high[:, 0])) == [False, True, True, False]


# -- fatigue --------------------------------------------------------------------------------------


def test_rainflow_of_the_example_of_astm_e1049(record):
    """ASTM E1049-85 (2017), Figure 6: ranges 3, 4, 6, 8 and 9 are counted 0.5, 1.5, 0.5, 1 and 0.5 times."""
    ranges, counts = rainflow(np.array([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0]))
    table = {float(size): float(counts[ranges == size].sum()) for size in np.unique(ranges)}
    published = {3.0: 0.5, 4.0: 1.5, 6.0: 0.5, 8.0: 1.0, 9.0: 0.5}
    worst = max(abs(table.get(s, 0.0) - published.get(s, 0.0)) for s in {*table, *published})
    record("Rainflow count of ASTM E1049-85, Figure 6", "largest difference of a count", worst, 0.0, "cycles")


def three_points(x):
    """Rainflow counting as ASTM E1049-85, 5.4.4, words it, on turning points: ranges and counts, sorted."""
    found, stack = [], []
    for y in x:
        stack.append(y)
        while len(stack) >= 3:
            X, Y = abs(stack[-1] - stack[-2]), abs(stack[-2] - stack[-3])
            if X < Y:
                break
            if len(stack) == 3:  # Y contains the starting point
                found.append((Y, 0.5))
                stack.pop(0)
            else:
                found.append((Y, 1.0))
                del stack[-3:-1]
    found += [(abs(b - a), 0.5) for a, b in zip(stack, stack[1:])]
    return found


@settings(max_examples=200, deadline=None)
@given(st.lists(st.integers(-50, 50), min_size=2, max_size=60))
def test_rainflow_does_the_damage_of_the_standard(values):
    """Equal neighbours may be paired differently (a cycle or two halves): the damage is what counts."""
    x = turning_points(np.array(values, dtype=float))
    ranges, counts = rainflow(np.array(values, dtype=float))
    expected = three_points(x)
    for m in (1.0, 3.0, 7.0):
        assert np.sum(counts * ranges**m) == pytest.approx(sum(n * s**m for s, n in expected), rel=1e-12)


def test_turning_points():
    x = np.array([1.0, 1.0, 2.0, 3.0, 3.0, 3.0, 1.0, 1.5, 1.5, 0.0, 0.0])
    assert turning_points(x).tolist() == [1.0, 3.0, 1.0, 1.5, 0.0]
    assert turning_points(np.ones(5)).tolist() == [1.0]


def test_damage_equivalent_load_of_a_sine(data, record):
    """k cycles of range S in T seconds: DEL = S (k/T)^(1/m) at 1 Hz."""
    t = np.arange(0.0, 600.001, 0.05)
    found = equivalent_load(7.0 * np.cos(2.0 * np.pi * t / 12.0), 4.0, 600.0)
    record("Damage-equivalent load of a sine", "relative error", abs(found / (14.0 * (1 / 12.0) ** 0.25) - 1), 1e-9)
    assert float(data.rope_tension_del[1]) == pytest.approx(40.0 * (1.0 / 6.0) ** 0.25, rel=1e-3)
    assert data.rope_tension_del.attrs["exponent"] == 4.0 and data.rope_tension_del.attrs["units"] == "N"
    assert float(data.buoy_position_del.sel(dof="yaw")) == 0.0
    assert np.isnan(equivalent_load(np.array([1.0, np.nan, 2.0]), 3.0, 10.0))
    assert np.isnan(equivalent_load(np.array([1.0]), 3.0, 0.0))


# -- in a run, from a file, in pieces -------------------------------------------------------------


@pytest.fixture(scope="module")
def chain():
    section = fs.Section(name="chain", mass_per_length=20.0, diameter=0.05, EA=1e7, axial_damping=1e4,
                         drag_normal=1.2, breaking_load=1e6)  # fmt: skip
    line = fs.Line(name="rope", section=section, length=60.0, elements=6)
    sea = fs.Sea(depth=30.0, waves=fs.RegularWave(height=3.0, period=8.0), wave_ramp=5.0)
    ends = [fs.Ball(a="rope.end_a", b=(0.0, 0.0, -30.0)), fs.Ball(a="rope.end_b", b=(45.0, 0.0, -2.0))]
    return fs.assemble(fs.Model(parts=[line], joints=ends, sea=sea))


ASKED = StatisticsSettings(start=10.0, block=8.0, fatigue={"rope_tension": 3.0})


@pytest.fixture(scope="module")
def run(chain, tmp_path_factory):
    path = tmp_path_factory.mktemp("run") / "run.nc"
    return simulate(chain, 30.0, 0.1, output=path, interval=0.2, statistics=ASKED)


def same(a, b):
    """Equal to the last bit, attributes of variables too."""
    xarray.testing.assert_identical(a.drop_attrs(deep=False), b.drop_attrs(deep=False))


def test_a_saved_file_gives_the_same_numbers_as_the_run(run, chain):
    from_file = statistics(run.path, ASKED.start, ASKED.fatigue, ASKED.block)
    same(run.statistics.dataset(), from_file.dataset())
    in_memory = simulate(chain, 30.0, 0.1, interval=0.2)
    same(run.statistics.dataset(), statistics(in_memory, ASKED.start, ASKED.fatigue, ASKED.block).dataset())
    own, there = run.statistics.all_attributes(), from_file.all_attributes()
    assert {name: own[name] for name in there if name != "Conventions"} == {
        name: value for name, value in there.items() if name != "Conventions"
    }
    assert own["status"] == "done" and own["steps"] == run.steps and own["newton_iterations"] == run.newton_iterations


def test_nothing_else_is_kept_if_so_asked(run, chain):
    bare = simulate(chain, 30.0, 0.1, interval=0.2, statistics=ASKED, keep_series=False)
    same(run.statistics.dataset(), bare.statistics.dataset())
    assert bare.path is None and bare.rows.size == 0 and bare.simulated_time == pytest.approx(30.0)
    for ask in (lambda: bare.series("rope_tension"), bare.dataset, lambda: statistics(bare)):
        with pytest.raises(CaseError, match="keep_series=False"):
            ask()


def test_against_the_series(run):
    found, tension = run.statistics.dataset(), run.series("rope_tension")[50:]
    assert found.attrs["statistics_samples"] == len(tension) == 101
    for kind, of in (("mean", np.mean), ("std", np.std), ("min", np.min), ("max", np.max)):
        np.testing.assert_allclose(found[f"rope_tension_{kind}"], of(tension, axis=0), rtol=1e-10)
    assert found.rope_tension_max.dims == ("rope_element",) and found.rope_tension_max.attrs["units"] == "N"
    assert float(found.rope_tension_utilisation) == pytest.approx(tension.max() / 1e6, rel=1e-12)
    assert float(found.rope_end_b_force_period.sel(xyz="z")) == pytest.approx(8.0, abs=0.1)
    assert "rope_position_period" not in found


def test_going_on_from_a_pickle_or_a_checkpoint_changes_nothing():
    """A checkpoint holds arrays and plain values only."""
    given = {"start": 200.0, "block": 100.0, "fatigue": {"rope_tension": 4.0}}
    whole = taken(TIME[:10001], **given)
    samples = rows(TIME[:10001])
    for cut in (0, 4000, 4001, 7777):
        first = Statistics(LAYOUT, StatisticsSettings(**given))
        for t, row in zip(TIME[:cut], samples):
            first.append(float(t), row)
        second = Statistics(LAYOUT, StatisticsSettings(**given))
        second.restore({name: np.array(v) if isinstance(v, np.ndarray) else v for name, v in first.arrays().items()})
        for third in (second, pickle.loads(pickle.dumps(first))):
            for t, row in zip(TIME[cut:10001], samples[cut:]):
                third.append(float(t), row)
            same(third.dataset(), whole.dataset())
    with pytest.raises(ValueError, match="block"):
        Statistics(LAYOUT, StatisticsSettings(**{**given, "block": 50.0})).restore(first.arrays())


def test_the_file_is_the_dataset_and_the_same_bytes(result, tmp_path):
    path = result.write(tmp_path / "a.nc", {"case_hs": 2.5, "case_name": "größte", "failure": "", "seed": 2**40})
    result.write(tmp_path / "b.nc", {"case_hs": 2.5, "case_name": "größte", "failure": "", "seed": 2**40})
    assert path.read_bytes() == (tmp_path / "b.nc").read_bytes()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.nc", "b.nc"]
    with xarray.open_dataset(path) as file:
        same(file.load(), result.dataset())
        assert (file.attrs["case_hs"], file.attrs["case_name"], file.attrs["failure"]) == (2.5, "größte", "")
        assert file.attrs["seed"] == 2**40 and file.attrs["statistics_samples"] == 12001
        for variable in file.variables.values():
            assert variable.attrs["long_name"] and ("units" in variable.attrs)
        assert file.buoy_position_std.attrs["units_dof"] == "m m m rad rad rad"
        assert file.buoy_position_period.attrs["units"] == "s" and "units_dof" not in file.buoy_position_period.attrs


def test_table_for_print(result):
    heads, lines = result.table()
    rows = {line[0]: dict(zip(heads, line, strict=True)) for line in lines}
    assert rows["buoy_position surge"]["max"] == "33" and rows["buoy_position pitch"]["unit"] == "rad"
    assert "rope_tension element 0" in rows and "rope_tension element 1" not in rows  # the one with the largest value
    assert rows["newton_iterations"]["mean"] == "3" and rows["newton_iterations"]["period [s]"] == ""


def test_decay_tests_have_results_of_their_own(tmp_path):
    from floatsim.study.decay import fit_decay

    t = np.arange(0.0, 60.0, 0.05)
    fit = fit_decay(t, 5.0 * np.exp(-0.02 * t) * np.cos(0.6 * t), 0.0)
    test = SimpleNamespace(body="buoy", dof="pitch", offset=5.0, fit=fit)
    path = write_variables(tmp_path / "decay.nc", decay_variables(test), {"status": "done"})
    with xarray.open_dataset(path) as file:
        assert float(file.decay_period) == pytest.approx(2.0 * np.pi / 0.6, rel=1e-3)
        assert float(file.decay_damping_ratio) == pytest.approx(0.02 / np.hypot(0.02, 0.6), rel=0.02)
        assert file.decay_extremum.dims == ("decay_extremum",) or file.decay_extremum.shape == fit.value.shape
        assert file.decay_extremum.attrs["units"] == "degree" and np.array_equal(file.decay_extremum, fit.value)


# -- bad input ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"start": -1.0}, "start: got -1.0"), ({"start": "1"}, "start: got '1'"), ({"block": 0.0}, "block: got 0.0"),
        ({"block": float("nan")}, "block: got nan"), ({"fatigue": ["a"]}, "fatigue: got"),
        ({"fatigue": {"rope_tension": 0.5}}, "'rope_tension': got 0.5"),
        ({"fatigue": {"rope_tension": True}}, "'rope_tension': got True"),
    ],
)  # fmt: skip
def test_settings_that_make_no_sense(given, said):
    with pytest.raises(CaseError) as error:
        StatisticsSettings(**given)
    assert said in str(error.value)


def test_all_problems_of_settings_at_once():
    with pytest.raises(CaseError) as error:
        StatisticsSettings(start=-1.0, block=-1.0, fatigue={"a": 0.0})
    assert len(error.value.problems) == 3


def test_refused_before_anything_runs(chain, tmp_path, monkeypatch):
    monkeypatch.setattr("floatsim.study.simulate.solve_static", lambda *a: pytest.fail("it ran"))
    out = tmp_path / "run.nc"
    for asked, said in (
        ({"statistics": StatisticsSettings(fatigue={"rope_tensoin": 3.0})}, "did you mean 'rope_tension'"),
        ({"statistics": StatisticsSettings(start=11.0)}, "start is 11 s, but the run ends at 10 s"),
        ({"statistics": {"start": 1.0}}, "must be a floatsim.StatisticsSettings"),
        ({"keep_series": "no"}, "keep_series: got 'no'"),
        ({"keep_series": False, "output": out}, "keeps nothing to write there"),
    ):
        with pytest.raises(CaseError, match=said):
            simulate(chain, 10.0, 0.1, **asked)
    assert not out.exists()


def test_bad_sources_and_targets(run, tmp_path):
    with pytest.raises(CaseError, match="no result file"):
        statistics(tmp_path / "none.nc")
    with pytest.raises(CaseError, match="there are samples from 0 to 30"):
        statistics(run.path, start=31.0)
    with pytest.raises(CaseError, match="did you mean 'rope_tension'"):
        statistics(run.path, fatigue={"rope_tensio": 3.0})
    with pytest.raises(CaseError, match="cannot be written"):
        run.statistics.write(tmp_path / "nowhere" / "a.nc")
    with pytest.raises(CaseError, match="no samples at or after the start, 0 s"):
        Statistics(LAYOUT, StatisticsSettings()).dataset()
    with pytest.raises(CaseError, match="attribute 'a'"):
        run.statistics.write(tmp_path / "a.nc", {"a": [1]})
    assert not list(tmp_path.iterdir())
