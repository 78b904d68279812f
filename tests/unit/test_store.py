"""The netCDF store: what a reader finds, while the file grows and afterwards, and what is refused."""

import os
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

from floatsim.errors import CaseError
from floatsim.study import store
from floatsim.study.store import Channel, Coordinate, Writer

CHANNELS = (
    Channel("box_position", "box: displacement", "mixed", ("dof",), "float", "m m m rad rad rad"),
    Channel("rope_position", "rope: position of the nodes", "m", ("rope_node", "xyz")),
    Channel("rope_tension", "rope: effective tension", "N", ("rope_element",)),
    Channel("newton_iterations", "Newton iterations", "1", (), "int32"),
    Channel("step_size", "time step", "s"),
)
COORDINATES = (
    Coordinate("dof", "degree of freedom", "1", "dof", ("surge", "sway", "heave", "roll", "pitch", "yaw")),
    Coordinate("xyz", "world axis", "1", "xyz", ("x", "y", "z")),
    Coordinate("rope_arc_length", "arc length", "m", "rope_node", np.array([0.0, 2.5, 5.0])),
    Coordinate("rope_element_arc_length", "arc length", "m", "rope_element", np.array([1.25, 3.75])),
)
WIDTH = 6 + 9 + 2 + 1 + 1


def sample(k):
    """A sample whose every value says where it belongs."""
    row = 1000.0 * k + np.arange(WIDTH)
    row[17] = k
    return row


def write(path, n, **options):
    with Writer(path, CHANNELS, COORDINATES, {"model": "test", "seed": 7, "ramp": 1.5}, **options) as writer:
        for k in range(n):
            writer.append(0.1 * k, sample(k))
    return path


@pytest.mark.parametrize("n", [0, 1, 255, 256, 257, 600])
def test_what_goes_in_comes_out(tmp_path, n):
    with xr.open_dataset(write(tmp_path / "out.nc", n)) as data:
        assert data.sizes["time"] == n
        assert data.time.values == pytest.approx(0.1 * np.arange(n))
        rows = np.array([sample(k) for k in range(n)]).reshape(n, WIDTH)
        assert (data.box_position.values == rows[:, :6]).all()
        assert (data.rope_position.values == rows[:, 6:15].reshape(n, 3, 3)).all()
        assert (data.rope_tension.values == rows[:, 15:17]).all()
        assert (data.newton_iterations.values == np.arange(n)).all()
        assert data.newton_iterations.dtype == np.int32
        assert (data.step_size.values == rows[:, 18]).all()
        assert data.attrs["status"] == "done" and data.attrs["failure"] == ""
        assert (data.attrs["model"], data.attrs["seed"], data.attrs["ramp"]) == ("test", 7, 1.5)


def test_everything_describes_itself(tmp_path):
    with xr.open_dataset(write(tmp_path / "out.nc", 3)) as data:
        for name, variable in data.variables.items():
            assert variable.attrs["units"] and variable.attrs["long_name"], name
        assert data.box_position.dims == ("time", "dof")
        assert data.box_position.attrs["units_dof"].split() == ["m", "m", "m", "rad", "rad", "rad"]
        assert data.box_position.sel(dof="heave").values == pytest.approx([2.0, 1002.0, 2002.0])
        assert data.rope_position.sel(xyz="z").dims == ("time", "rope_node")
        assert (data.rope_tension.rope_element_arc_length == [1.25, 3.75]).all()
        assert set(data.coords) == {"time", "dof", "xyz", "rope_arc_length", "rope_element_arc_length"}
        assert data.time.dtype == np.float64  # seconds, not dates
        assert data.encoding["unlimited_dims"] == {"time"}


def test_single_precision(tmp_path):
    with xr.open_dataset(write(tmp_path / "out.nc", 3, precision="float32")) as data:
        assert data.rope_tension.dtype == np.float32
        assert data.time.dtype == np.float64
        assert data.rope_tension.values[2] == pytest.approx([2015.0, 2016.0])


def read_elsewhere(path):
    """(number of times, last time, status) as another process sees the file."""
    code = (
        "import sys, xarray\n"
        "with xarray.open_dataset(sys.argv[1]) as d:\n"
        "    assert (d.step_size.values == 1000.0 * d.newton_iterations.values + 18).all()\n"
        "    print(d.sizes['time'], float(d.time[-1]) if d.sizes['time'] else -1, d.status)\n"
    )
    environment = {k: v for k, v in os.environ.items() if k != "HDF5_USE_FILE_LOCKING"}
    result = subprocess.run(
        [sys.executable, "-c", code, str(path)], capture_output=True, text=True, env=environment, check=True
    )
    n, last, status = result.stdout.split()
    return int(n), float(last), status


def test_another_process_reads_the_file_while_it_grows(tmp_path):
    path = tmp_path / "out.nc"
    writer = Writer(path, CHANNELS, COORDINATES)
    assert read_elsewhere(path) == (0, -1.0, "running")
    for k in range(300):
        writer.append(float(k), sample(k))
    assert read_elsewhere(path) == (256, 255.0, "running")
    writer.flush()
    assert read_elsewhere(path) == (300, 299.0, "running")
    writer.close("failed", "step did not converge at t = 300 s")
    assert read_elsewhere(path) == (300, 299.0, "failed")
    with xr.open_dataset(path) as data:
        assert data.attrs["failure"] == "step did not converge at t = 300 s"


def test_samples_go_out_after_five_seconds(tmp_path, monkeypatch):
    now = [100.0]
    monkeypatch.setattr(store.clock, "monotonic", lambda: now[0])
    with Writer(tmp_path / "out.nc", CHANNELS, COORDINATES) as writer:
        writer.append(0.0, sample(0))
        now[0] += 4.9
        writer.append(1.0, sample(1))
        assert writer._written == 0
        now[0] += 0.2
        writer.append(2.0, sample(2))
        assert writer._written == 3


def test_an_exception_closes_the_file_as_failed(tmp_path):
    with pytest.raises(ValueError), Writer(tmp_path / "out.nc", CHANNELS, COORDINATES) as writer:
        writer.append(0.0, sample(0))
        raise ValueError("no")
    with xr.open_dataset(tmp_path / "out.nc") as data:
        assert data.sizes["time"] == 1
        assert data.attrs["status"] == "failed" and data.attrs["failure"] == "ValueError: no"
    writer.close("done")  # once closed, closed


@pytest.mark.parametrize(
    ("channels", "coordinates", "message"),
    [
        ([Channel("Box", "", "m")], (), "'Box': lower-case letters, digits and underscores"),
        ([Channel("a b", "", "m")], (), "'a b': lower-case"),
        ([Channel("a", "", "m"), Channel("a", "", "m")], (), "'a' exists 2 times"),
        ([Channel("time", "", "s")], (), "'time' exists 2 times"),
        ([Channel("a", "", "m", ("node",))], (), "'a': dimension 'node' has no coordinate"),
        ([], [Coordinate("a", "", "m", "n", [1.0]), Coordinate("b", "", "m", "n", [1.0, 2.0])], "'b' has 2 values"),
    ],
)
def test_bad_descriptions_leave_no_file(tmp_path, channels, coordinates, message):
    with pytest.raises(CaseError, match=message):
        Writer(tmp_path / "out.nc", channels, coordinates)
    assert list(tmp_path.iterdir()) == []


def test_bad_precision(tmp_path):
    with pytest.raises(CaseError, match="'float64' or 'float32'"):
        Writer(tmp_path / "out.nc", CHANNELS, COORDINATES, precision="float16")  # type: ignore[arg-type]


def test_paths_that_cannot_be_written(tmp_path):
    with pytest.raises(CaseError, match=r"missing/out.nc.*there is no folder"):
        Writer(tmp_path / "missing" / "out.nc", CHANNELS, COORDINATES)
    with pytest.raises(CaseError, match="is a folder"):
        Writer(tmp_path, CHANNELS, COORDINATES)
    (tmp_path / "file").write_text("")
    with pytest.raises(CaseError, match="there is no folder"):
        Writer(tmp_path / "file" / "out.nc", CHANNELS, COORDINATES)


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="permissions do not bind this user")
def test_read_only_folder(tmp_path):
    tmp_path.chmod(0o500)
    try:
        with pytest.raises(CaseError, match=r"out.nc.*no permission"):
            Writer(tmp_path / "out.nc", CHANNELS, COORDINATES)
    finally:
        tmp_path.chmod(0o700)


def test_no_permission_is_said_before_an_old_file_is_touched(tmp_path, monkeypatch):
    old = tmp_path / "out.nc"
    old.write_text("precious")
    monkeypatch.setattr(store.os, "access", lambda path, mode: False)
    with pytest.raises(CaseError, match=r"out.nc.*no permission"):
        Writer(old, CHANNELS, COORDINATES)
    assert old.read_text() == "precious"


def test_no_room_for_the_samples_that_will_come(tmp_path):
    with pytest.raises(CaseError, match=r"out.nc' would take .* MB, there is room for"):
        Writer(tmp_path / "out.nc", CHANNELS, COORDINATES, samples=10**15)
    assert list(tmp_path.iterdir()) == []


LIMITED = """
import resource, signal, sys
sys.path[:0] = [sys.argv[2]]
from test_store import CHANNELS, COORDINATES, CaseError, Writer, sample
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[3]), int(sys.argv[3])))
try:
    with Writer(sys.argv[1], CHANNELS, COORDINATES) as writer:
        for k in range(20000):
            writer.append(0.1 * k, sample(k))
except CaseError as error:
    print(error)
"""


@pytest.mark.skipif(os.name != "posix", reason="needs a limit on the size of files")
@pytest.mark.parametrize(("limit", "message"), [(1000, "cannot be written"), (500_000, "could not be continued after")])
def test_a_full_disk_is_an_error_with_the_path(tmp_path, limit, message):
    path = tmp_path / "out.nc"
    here = os.path.dirname(__file__)
    result = subprocess.run(
        [sys.executable, "-c", LIMITED, str(path), here, str(limit)], capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stderr
    assert f"output file '{path}' {message}" in result.stdout
    assert path.exists() == (limit > 1000)
