"""summary.nc: from the files of a results folder to one data set."""

from __future__ import annotations

import dataclasses
import json
import resource
import sys
import time
from types import SimpleNamespace

import numpy as np
import pytest
import xarray
from scipy.io import netcdf_file

from floatsim.cases.case import Case, RunSettings
from floatsim.cases.classic import dimensions, read_classic
from floatsim.cases.collect import collect
from floatsim.errors import CaseError
from floatsim.study.statistics import Statistics, StatisticsSettings, Variable, write_variables
from floatsim.study.store import Channel, Coordinate


def layout(elements, more=()):
    arc = np.arange(elements) + 0.5
    return SimpleNamespace(
        channels=(
            Channel("buoy_position", "buoy: position", "mixed", ("dof",), "float", "m m m rad rad rad"),
            Channel("rope_tension", "rope: effective tension", "N", ("rope_element",)),
            *(Channel(name, name, "1") for name in more),
        ),
        coordinates=(
            Coordinate("dof", "degree of freedom", "1", "dof", ("surge", "sway", "heave", "roll", "pitch", "yaw")),
            Coordinate("rope_element_arc_length", "arc length", "m", "rope_element", arc),
        ),
    )


def case(number, **variables):
    return Case(number, f"c{number}", variables, "models/buoy.py", {"number": number}, {},
                RunSettings(duration=100.0, ramp=20.0), "abc")  # fmt: skip


def finish(folder, one, elements=4, more=(), samples=11):
    """Statistics of a case: x = number + t of everything, t = 0, 1, ... 10 s."""
    found = Statistics(layout(elements, more), StatisticsSettings(block=5.0))
    for t in range(samples):
        found.append(float(t), np.full(found.width, one.number + float(t)))
    found.attributes = {"status": "done", "steps": 10 + one.number, "newton_iterations": 30}
    return found.write(folder / "cases" / f"{one.id}.stats.nc", {"wall_time": 2.5})


def fail(folder, one, kind="diverged", message="a step of 1e-05 s still fails"):
    record = {"id": one.id, "status": "failed", "kind": kind, "message": message, "time_reached": 3.5,
              "wall_time": 1.5, "host": "here", "finished": 0.0}  # fmt: skip
    (folder / "failed" / f"{one.id}.json").write_text(json.dumps(record))


def matrix(folder, cases):
    for name in ("cases", "failed"):
        (folder / name).mkdir(exist_ok=True)
    data = {"name": "screening", "path": "loadcases/screening.yaml", "cases": [c.as_dict() for c in cases]}
    (folder / "matrix.json").write_text(json.dumps(data))


CASES = [
    case(0, hs=1.0, wind_heading_deg=0, sea="calm", storm=False, tp=None),
    case(1, hs=2.5, wind_heading_deg=30, sea="rough", storm=True, tp=9.0),
    case(2, hs=2.5, wind_heading_deg=60, sea="rough", storm=True, tp=9.5),
    case(3, hs=4.0, wind_heading_deg=30, sea="high", storm=True, tp=12.0),
]


@pytest.fixture
def folder(tmp_path):
    """Two finished cases, the one with a longer rope and a channel of its own; one failed, one not run."""
    matrix(tmp_path, CASES)
    finish(tmp_path, CASES[0])
    finish(tmp_path, CASES[1], elements=6, more=("pto_power",))
    fail(tmp_path, CASES[2])
    return tmp_path


def test_variables_status_and_failures(folder):
    with xarray.open_dataset(collect(folder)) as data:
        assert data.sizes["case"] == 4 and list(data.case.values) == [0, 1, 2, 3]
        assert {"hs", "wind_heading_deg", "sea", "storm", "tp", "case_id", "status"} <= set(data.coords)
        assert data.hs.dtype == float and data.wind_heading_deg.dtype == np.int64 and data.storm.dtype == bool
        assert list(data.sea.values) == ["calm", "rough", "rough", "high"]
        np.testing.assert_array_equal(data.tp, [np.nan, 9.0, 9.5, 12.0])
        assert list(data.case_id.values) == [c.id for c in CASES]
        assert list(data.status.values) == ["done", "done", "failed", "missing"]
        assert list(data.failure.values) == ["", "", "diverged", ""]
        assert data.failure_message.values[2] == "a step of 1e-05 s still fails"
        np.testing.assert_array_equal(data.wall_time, [2.5, 2.5, 1.5, np.nan])
        np.testing.assert_array_equal(data.time_reached, [np.nan, np.nan, 3.5, np.nan])
        np.testing.assert_array_equal(data.steps, [10, 11, np.nan, np.nan])
        assert (data.attrs["cases_done"], data.attrs["cases_failed"], data.attrs["cases_missing"]) == (2, 1, 1)
        assert json.loads(data.attrs["variables"]) == ["hs", "wind_heading_deg", "sea", "storm", "tp"]
        assert data.attrs["matrix"] == "screening" and data.attrs["ramp"] == 20.0
        assert data.hs.attrs["units"] == "m" and data.wind_heading_deg.attrs["units"] == "degree"


def test_statistics_are_stacked_and_what_a_case_lacks_is_nan(folder):
    with xarray.open_dataset(collect(folder)) as data:
        assert data.buoy_position_mean.dims == ("case", "dof") and data.buoy_position_mean.dtype == np.float64
        surge = data.buoy_position_mean.sel(dof="surge")
        np.testing.assert_array_equal(surge, [5.0, 6.0, np.nan, np.nan])
        assert data.buoy_position_mean.attrs["units_dof"] == "m m m rad rad rad"
        np.testing.assert_allclose(data.buoy_offset_max, np.sqrt(2.0) * np.array([10.0, 11.0, np.nan, np.nan]), 1e-15)
        np.testing.assert_array_equal(data.rope_tension_max[0], [10.0] * 4 + [np.nan] * 2)  # the shorter rope
        np.testing.assert_array_equal(data.rope_tension_max[1], [11.0] * 6)
        np.testing.assert_array_equal(data.rope_tension_block_max[1, :, 0], [6.0, 11.0])
        np.testing.assert_array_equal(data.block_start, [0.0, 5.0])
        np.testing.assert_array_equal(data.pto_power_mean, [np.nan, 6.0, np.nan, np.nan])
        arc = data.rope_element_arc_length  # differs from case to case
        assert arc.dims == ("case", "rope_element") and "rope_element_arc_length" in data.coords
        np.testing.assert_array_equal(arc[0], [0.5, 1.5, 2.5, 3.5, np.nan, np.nan])
        assert "rope_element_arc_length" in data.rope_tension_max.coords and "hs" in data.rope_tension_max.coords


def test_selecting_by_variables(folder):
    finish(folder, CASES[2])
    finish(folder, CASES[3])  # all cases are done, with 4 or 6 elements
    with xarray.open_dataset(collect(folder)) as data:
        assert list(data.status.values) == ["done"] * 4  # a failure before that is forgotten
        assert list(data.where(data.hs > 2.0, drop=True).case.values) == [1, 2, 3]
        assert list(data.sel(case=data.wind_heading_deg == 30).case.values) == [1, 3]
        assert float(data.sel(case=3).buoy_position_max.sel(dof="heave")) == 13.0
        assert data.set_xindex("hs").sel(hs=2.5).sizes["case"] == 2
        one = data.set_index(case=["hs", "wind_heading_deg"]).sel(case=(2.5, 60))
        assert float(one.buoy_position_mean.sel(dof="surge")) == 7.0
        assert float(data.set_xindex("case_id").sel(case_id=CASES[1].id).hs) == 2.5
        table = data.buoy_position_max.sel(dof="surge").set_index(case=["hs", "wind_heading_deg"]).unstack("case")
        assert table.sizes == {"hs": 3, "wind_heading_deg": 3}
        means = data.buoy_position_mean.sel(dof="surge").groupby("wind_heading_deg").mean()
        np.testing.assert_array_equal(means, [5.0, 7.0, 7.0])


def test_same_lines_have_one_arc_length(tmp_path):
    matrix(tmp_path, CASES)
    for one in CASES:
        finish(tmp_path, one)
    with xarray.open_dataset(collect(tmp_path)) as data:
        assert data.rope_element_arc_length.dims == ("rope_element",)
        assert list(data.rope_element_arc_length.values) == [0.5, 1.5, 2.5, 3.5]


def test_blocks_of_different_number(tmp_path):
    matrix(tmp_path, CASES)
    finish(tmp_path, CASES[0], samples=6)
    finish(tmp_path, CASES[1], samples=16)
    with xarray.open_dataset(collect(tmp_path)) as data:
        assert list(data.block_start.values) == [0.0, 5.0, 10.0]
        np.testing.assert_array_equal(data.buoy_position_block_max.isel(dof=0)[0], [5.0, np.nan, np.nan])


def test_same_bytes_whatever_is_held_in_memory(folder, monkeypatch):
    first = collect(folder).read_bytes()
    assert collect(folder, folder / "again.nc").read_bytes() == first
    monkeypatch.setattr("floatsim.cases.collect.MEMORY", 1.0)  # every case by itself
    with xarray.open_dataset(collect(folder, folder / "bit.nc")) as a, xarray.open_dataset(folder / "again.nc") as b:
        xarray.testing.assert_identical(a.load(), b.load())
    assert not list(folder.glob(".*"))


def test_nothing_has_run_yet(tmp_path):
    matrix(tmp_path, CASES)
    calls = []
    with xarray.open_dataset(collect(tmp_path, progress=lambda *n: calls.append(n))) as data:
        assert list(data.status.values) == ["missing"] * 4 and data.sizes["case"] == 4
    assert calls == [(1, 4), (2, 4), (3, 4), (4, 4)]


def test_variables_with_names_that_are_taken(tmp_path):
    cases = [case(0, status="x", buoy_position_mean=3.0, dof="heave")]
    matrix(tmp_path, cases)
    finish(tmp_path, cases[0])
    with xarray.open_dataset(collect(tmp_path)) as data:
        assert data.case_status.values == ["x"] and data.status.values == ["done"] and data.case_dof.values == ["heave"]
        assert float(data.case_buoy_position_mean[0]) == 3.0
        assert json.loads(data.attrs["variables"]) == ["case_status", "case_buoy_position_mean", "case_dof"]


def test_a_damaged_file_is_a_failed_case(folder):
    for one, cut in ((CASES[0], 3000), (CASES[1], 2)):
        path = folder / "cases" / f"{one.id}.stats.nc"
        path.write_bytes(path.read_bytes()[:cut])
    fail(folder, CASES[3], kind="timed out")
    record = folder / "failed" / f"{CASES[2].id}.json"
    record.write_text("[1]")
    with xarray.open_dataset(collect(folder)) as data:
        assert data.failure.values[2] == "raised" and record.name in data.failure_message.values[2]
    record.write_text("{")
    with xarray.open_dataset(collect(folder)) as data:
        assert list(data.status.values) == ["failed"] * 4
        assert list(data.failure.values) == ["unreadable", "unreadable", "raised", "timed out"]
        assert CASES[0].id in data.failure_message.values[0]


def test_cases_that_cannot_stand_in_one_data_set(folder, tmp_path):
    path = folder / "cases" / f"{CASES[3].id}.stats.nc"
    write_variables(path, [Variable("buoy_position_mean", (), np.array(1.0), {})], {})
    with pytest.raises(CaseError, match=f"'buoy_position_mean' is along nothing in case {CASES[3].id}"):
        collect(folder)
    write_variables(path, [Variable("dof", ("dof",), np.array(["x", "y"]), {})], {})
    with pytest.raises(CaseError, match="different labels along 'dof'"):
        collect(folder)
    assert not (folder / "summary.nc").exists() and not list(folder.glob(".*"))


def test_bad_folders_and_targets(folder, tmp_path):
    with pytest.raises(CaseError, match="no results folder of a matrix"):
        collect(tmp_path / "nowhere")
    with pytest.raises(CaseError, match="is a folder"):
        collect(folder, folder)
    (folder / "notes.txt").write_text("mine")
    with pytest.raises(CaseError, match="is no summary"):
        collect(folder, folder / "notes.txt")
    with pytest.raises(CaseError, match="cannot be written"):
        collect(folder, folder / "nowhere" / "summary.nc")
    matrix(folder, [])
    with pytest.raises(CaseError, match="no cases"):
        collect(folder)
    assert (folder / "notes.txt").read_text() == "mine"


def test_the_reader_reads_what_another_library_wrote(tmp_path):
    """Own reader of the classic format against scipy's writer: every type, padding, labels."""
    with netcdf_file(tmp_path / "a.nc", "w", version=2) as file:
        file.title, file.number, file.several = "abcde", np.int32(7), np.array([1.5, 2.5])
        for dim, size in (("x", 3), ("string5", 5), ("long_name_of_a_dimension", 2)):
            file.createDimension(dim, size)
        file.createVariable("a", "d", ("x",))[:] = [1.0, 2.0, np.nan]
        file.createVariable("b", "i", ("x", "long_name_of_a_dimension"))[:] = [[1, 2], [3, 4], [5, -6]]
        file.createVariable("c", "f", ()).data[...] = 0.5
        file.variables["c"].units = "m/s"
        file.createVariable("d", "h", ("x",))[:] = [1, -2, 3]
        file.createVariable("e", "c", ("x", "string5"))[:] = np.array([list("abc\0\0"), list("abcde"), list("\0" * 5)])
    found = read_classic(tmp_path / "a.nc")
    assert dimensions(tmp_path / "a.nc") == {"x": 3, "string5": 5, "long_name_of_a_dimension": 2}
    assert found.about == {"title": "abcde", "number": 7, "several": [1.5, 2.5]}
    np.testing.assert_array_equal(found.values["a"], [1.0, 2.0, np.nan])
    np.testing.assert_array_equal(found.values["b"], [[1, 2], [3, 4], [5, -6]])
    np.testing.assert_array_equal(found.values["d"], [1, -2, 3])
    assert found.values["c"].shape == () and found.values["c"] == 0.5 and found.attributes["c"] == {"units": "m/s"}
    assert list(found.values["e"]) == ["abc", "abcde", ""] and found.dims["e"] == ("x",)
    whole = (tmp_path / "a.nc").read_bytes()
    for size in range(0, len(whole) - 3, 7):
        (tmp_path / "b.nc").write_bytes(whole[:size])
        with pytest.raises(ValueError):
            read_classic(tmp_path / "b.nc")


@pytest.mark.slow
def test_2250_cases(tmp_path, record):
    """As many cases as the operational table of Verelst et al. (2024), five lines of 452 elements in all with tension,
    curvature and their utilisations, platform and end forces: 10 000 numbers a case."""
    n, names = 2250, [*((f"mooring_{k}", 100) for k in (1, 2, 3)), *((f"cable_{k}", 76) for k in (1, 2))]
    channels = [Channel("platform_position", "platform: position", "mixed", ("dof",), "float", "m m m rad rad rad")]
    coordinates = [layout(1).coordinates[0], Coordinate("xyz", "axis", "1", "xyz", ("x", "y", "z"))]
    for name, elements in names:
        for end in ("a", "b"):
            channels.append(Channel(f"{name}_end_{end}_force", f"{name}: force of an end", "N", ("xyz",)))
        for what, size in (("element", elements), ("node", elements + 1)):
            quantity = "tension" if what == "element" else "curvature"
            dim, label = f"{name}_{what}", f"{name}_{what}_arc_length"
            coordinates.append(Coordinate(label, "arc length", "m", dim, np.arange(size, dtype=float)))
            for kind in (quantity, f"{quantity}_utilisation"):
                channels.append(Channel(f"{name}_{kind}", f"{name}: {kind}", "N", (dim,)))
    found = Statistics(SimpleNamespace(channels=channels, coordinates=coordinates), StatisticsSettings())
    draw = np.random.default_rng(1)
    for t in range(10):
        found.append(float(t), draw.normal(size=found.width))
    cases = [dataclasses.replace(case(k, hs=0.5 * (k % 9), seed=k % 3), slug=f"case_{k:04}") for k in range(n)]
    matrix(tmp_path, cases)
    whole = found.write(tmp_path / "one.nc", {"wall_time": 1.0}).read_bytes()
    for one in cases:
        (tmp_path / "cases" / f"{one.id}.stats.nc").write_bytes(whole)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    began = time.perf_counter()
    path = collect(tmp_path)
    spent = time.perf_counter() - began
    unit = 1.0 if sys.platform == "darwin" else 1024.0
    peak = unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(f"{found.width} values a sample, {len(whole)} bytes a case, {spent:.1f} s, peak {peak / 1e6:.0f} MB, "
          f"{unit * before / 1e6:.0f} MB before")  # fmt: skip
    # the time is told, not asserted: another process on the machine is no error
    record("Summary of 2250 cases", "wall time", spent, "goal 60 s", "s", holds=True)
    record("Summary of 2250 cases", "memory of the process", peak / 1e9, 2.0, "GB")
    with xarray.open_dataset(path) as data:
        assert data.sizes["case"] == n and (data.status == "done").all()
        one = data.mooring_2_tension_max.isel(case=[0, n - 1]).values
        np.testing.assert_array_equal(one, [found.dataset().mooring_2_tension_max.values] * 2)
