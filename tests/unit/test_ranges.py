"""Range graphs against sums that can be done by hand."""

import numpy as np
import pytest

import floatsim as fs
from floatsim.errors import CaseError
from floatsim.study.ranges import BLOCK, blocks_of, range_graph
from floatsim.study.store import Channel, Coordinate, Writer

CHANNELS = (
    Channel("rope_tension", "rope: effective tension", "N", ("rope_element",)),
    Channel("rope_curvature", "rope: curvature", "1/m", ("rope_node",)),
    Channel("rope_position", "rope: position of the nodes", "m", ("rope_node", "xyz")),
)
COORDINATES = (
    Coordinate("xyz", "world axis", "1", "xyz", ("x", "y", "z")),
    Coordinate("rope_arc_length", "arc length", "m", "rope_node", 2.0 * np.arange(4.0)),
    Coordinate("rope_element_arc_length", "arc length", "m", "rope_element", 2.0 * np.arange(3.0) + 1.0),
)


def written(path, time, tension, curvature):
    with Writer(path, CHANNELS, COORDINATES) as writer:
        for t, row, bend in zip(time, tension, curvature, strict=True):
            writer.append(t, np.concatenate([row, bend, np.zeros(12)]))
    return path


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """4000 samples, ten whole periods: mean + amplitude sin; a node without a curvature."""
    time = 0.1 * np.arange(4000)
    wave = np.sin(2.0 * np.pi * time / 40.0)[:, None]
    tension = np.array([1e9, 100.0, -5.0]) + np.array([3.0, 20.0, 0.0]) * wave
    curvature = np.array([0.0, 0.1, np.nan, 0.3]) + 0.05 * wave
    return written(tmp_path_factory.mktemp("ranges") / "out.nc", time, tension, curvature)


def test_statistics_of_a_sine(results):
    graph = range_graph(results, "rope")
    assert (graph.line, graph.quantity, graph.units, graph.samples) == ("rope", "tension", "N", 4000)
    assert (graph.start, graph.end) == (0.0, pytest.approx(399.9))
    assert graph.arc_length == pytest.approx([1.0, 3.0, 5.0])
    assert graph.minimum == pytest.approx([1e9 - 3.0, 80.0, -5.0], rel=1e-12)
    assert graph.maximum == pytest.approx([1e9 + 3.0, 120.0, -5.0], rel=1e-12)
    assert graph.mean == pytest.approx([1e9, 100.0, -5.0], rel=1e-12)
    # a sum of squares would have lost it: 1e18 has room for no 4.5
    assert graph.std == pytest.approx([3.0 / np.sqrt(2.0), 20.0 / np.sqrt(2.0), 0.0], rel=1e-6, abs=1e-9)


def test_what_does_not_exist_stays_missing(results):
    graph = range_graph(results, "rope", "curvature")
    assert graph.arc_length == pytest.approx([0.0, 2.0, 4.0, 6.0])
    assert graph.mean == pytest.approx([0.0, 0.1, np.nan, 0.3], abs=1e-12, nan_ok=True)
    for row in (graph.minimum, graph.maximum, graph.std):
        assert list(np.isnan(row)) == [False, False, True, False]


@pytest.mark.parametrize(("start", "end", "first", "last"), [(100.0, 300.0, 1000, 3000), (None, 0.0, 0, 0),
                                                             (399.85, None, 3999, 3999)])  # fmt: skip
def test_part_of_a_run(results, start, end, first, last):
    graph = range_graph(results, "rope", start=start, end=end)
    assert graph.samples == last - first + 1
    assert (graph.start, graph.end) == pytest.approx((0.1 * first, 0.1 * last))
    wave = 100.0 + 20.0 * np.sin(2.0 * np.pi * 0.1 * np.arange(first, last + 1) / 40.0)
    found = (graph.minimum[1], graph.mean[1], graph.maximum[1], graph.std[1])
    assert found == pytest.approx((wave.min(), wave.mean(), wave.max(), wave.std()), abs=1e-9)


def test_blocks_cover_all_samples_once():
    for first, last in ((0, 4000), (1000, 3000), (5, 6), (BLOCK, 2 * BLOCK)):
        pieces = list(blocks_of(first, last))
        assert [k for a, b in pieces for k in range(a, b)] == list(range(first, last))
        assert all(a // BLOCK == (b - 1) // BLOCK for a, b in pieces)


def test_missing_at_times(tmp_path):
    """A value that is missing in whole blocks counts only where it is."""
    n = 2 * BLOCK
    tension = np.tile([1.0, 2.0, 3.0], (n, 1))
    tension[:BLOCK, 0] = np.nan
    tension[-1, 0] = 3.0
    graph = range_graph(written(tmp_path / "out.nc", np.arange(n), tension, np.zeros((n, 4))), "rope")
    mean = 1.0 + 2.0 / BLOCK
    assert (graph.minimum[0], graph.maximum[0], graph.mean[0]) == pytest.approx((1.0, 3.0, mean))
    assert graph.std[0] == pytest.approx(np.sqrt((1.0 + 8.0 / BLOCK) - mean**2))


def test_table_and_dataset(results):
    graph = range_graph(results, "rope")
    lines = str(graph).splitlines()
    assert lines[0] == "rope: tension [N], 4000 samples, 0 to 399.9 s"
    assert lines[1].split() == ["arc", "length", "[m]", "min", "mean", "max", "std"]
    assert lines[3].split() == ["3.000", "80", "100", "120", "14.1421"] and len(lines) == 5
    data = graph.to_dataset()
    assert data["max"].sel(arc_length=3.0) == pytest.approx(120.0)
    assert data["std"].attrs["units"] == "N" and data.attrs["line"] == "rope" and data.attrs["samples"] == 4000


def test_run_in_memory_and_in_a_file_and_open(tmp_path):
    import xarray

    rope = fs.Section(name="rope", mass_per_length=5.0, diameter=0.05, EA=1e7, breaking_load=1e4)
    line = fs.Line(name="rope", section=rope, length=10.0, elements=4, end_b_position=(0.0, 0.0, 20.0))
    model = fs.Model(parts=[line], joints=[fs.Ball(a="rope.end_a", b=(0.0, 0.0, 30.0))], sea=fs.Sea(depth=50.0),
                     gravity=9.81)  # fmt: skip
    memory = fs.simulate(model, 1.0, 0.1)
    file = fs.simulate(model, 1.0, 0.1, output=tmp_path / "out.nc")
    with xarray.open_dataset(tmp_path / "out.nc") as data:
        graphs = [range_graph(source, "rope", "tension_utilisation") for source in (memory, file, file.path, data)]
    for graph in graphs:
        # at rest: the weight below the middle of each element
        assert graph.mean == pytest.approx(5.0 * 9.81 * (10.0 - graph.arc_length) / 1e4, rel=1e-5)
        assert graph.std == pytest.approx(0.0, abs=1e-6) and graph.samples == 11


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("rop",), "line: got 'rop'.*did you mean 'rope'"),
        ((3,), "line: got 3"),
        (("rope", "tenson"), "quantity: got 'tenson'.*did you mean 'tension'"),
        (("rope", "position"), "quantity: got 'position'"),
        (("rope", ["tension"]), "quantity: got "),
        (("rope", "tension", 500.0), "no samples from 500 s to the end; there are samples from 0 to 399.9 s"),
        (("rope", "tension", 20.0, 10.0), "start: got 20 s, after the end at 10 s"),
        (("rope", "tension", "now"), "start: got 'now'; must be a number"),
        (("rope", "tension", None, np.nan), "end: got nan"),
    ],
)
def test_refusals(results, arguments, message):
    with pytest.raises(CaseError, match=message):
        range_graph(results, *arguments)


def test_files_that_are_none(tmp_path):
    with pytest.raises(CaseError, match="no result file"):
        range_graph(tmp_path / "none.nc", "rope")
    with pytest.raises(CaseError, match="results: got 5"):
        range_graph(5, "rope")
    with pytest.raises(CaseError, match="holds no samples"):
        range_graph(written(tmp_path / "out.nc", [], [], []), "rope")
