"""`floatsim rao` and `floatsim power`."""

import re
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from floatsim.cli import main

MODELS = Path(__file__).parents[2] / "models"
RM3, PENDULUM = str(MODELS / "rm3.py"), str(MODELS / "pendulum.py")


@pytest.fixture
def floatsim(capsys, monkeypatch, tmp_path):
    """Calls the program in an empty folder: (exit status, standard output, standard error)."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments):
        monkeypatch.setattr(sys, "argv", ["floatsim", *map(str, arguments)])
        with pytest.raises(SystemExit) as left:
            main()
        said = capsys.readouterr()
        assert "Traceback" not in said.err and not re.search(r"(?<!no )\bnan\b", said.out, re.IGNORECASE)
        return left.value.code or 0, said.out, said.err

    return call


def test_rao(floatsim):
    status, said, error = floatsim("rao", RM3, "-o", "rao.nc", "--hs", "1.5", "--tp", "8")
    assert status == 0, error
    assert "motions of 'float'" in said and "motions of 'spar'" in said and "standard deviations" in said
    table = said[said.index("motions of 'float'") : said.index("standard deviations")]
    rows = [line.split() for line in table.splitlines() if re.match(r"\s*\d", line)]
    assert len(rows) == 12
    with xr.open_dataset("rao.nc") as data:
        heave = data["float_position_amplitude"].sel(dof="heave")
        for row in rows:
            there = float(heave.sel(omega=float(row[0]), method="nearest"))
            assert float(row[4]) == pytest.approx(there, rel=6e-3, abs=6e-4)
        assert float(data["pto_velocity_std"]) > 0.0 and data.attrs["model_script"] == "rm3.py"
        assert abs(float(data["wave_elevation_std"]) - 1.5 / 4.0) < 0.01


def test_rao_at_frequencies(floatsim):
    status, said, _ = floatsim("rao", RM3, "--omega", "0.5,0.785398,1", "--heading", "90")
    assert status == 0 and "0.785" in said and "towards 90 deg" in said


def test_power(floatsim, tmp_path):
    Path("scatter.csv").write_text("hs,7,9\n0.5,0.25,0.5\n1,0.0,0.25\n")
    arguments = ["power", RM3, "-p", "wave_ramp=20", "--duration", "20", "--start", "40"]
    status, said, error = floatsim(*arguments, "--occurrence", "scatter.csv", "-o", "matrix.nc")
    assert status == 0, error
    assert "energy of a year" in said and "MWh" in said
    with xr.open_dataset("matrix.nc") as data:
        assert data.power.shape == (2, 2) and np.isnan(data.power.values[1, 0])
        energy = 8766.0 * float((data.power * data.occurrence).sum()) / 1e6
    assert float(re.search(r"year: ([\d.e+]+) MWh", said)[1]) == pytest.approx(energy, rel=1e-3)
    status, said, _ = floatsim(*arguments, "--hs", "0.5", "--tp", "7,9")
    assert status == 0 and "energy" not in said and not (tmp_path / "out.nc").exists()


def test_failed_cells_are_said(floatsim):
    Path("script.py").write_text(
        f"import sys; sys.path.insert(0, {str(MODELS)!r})\n"
        "import floatsim as fs, rm3\n"
        "def build():\n"
        "    force = ((1., 1.), (0., 0.), (-1., -1.))\n"
        "    table = fs.ForceTable(displacement=(-.3, 0., .3), velocity=(-9., 9.), force=force)\n"
        "    return rm3.build(laws=[table], wave_ramp=5.0)\n"
    )
    seas = ["--hs", "0.1,6", "--tp", "8", "--duration", "30", "--start", "10"]
    status, said, error = floatsim("power", "script.py", *seas)
    assert status == 1 and "failed" in said
    assert "failed: 1 sea states, the first is hs 6 m, tp 8 s" in error


@pytest.mark.parametrize(
    "arguments, words",
    [
        (["power", RM3], ["give --hs and --tp, or --occurrence"]),
        (["power", RM3, "--hs", "1"], ["give --hs and --tp"]),
        (["power", RM3, "--hs", "1;2", "--tp", "8"], ["--hs: got '1;2'", "numbers with commas"]),
        (["power", RM3, "--hs", "-1", "--tp", "8"], ["hs: got [-1.0]", "positive numbers"]),
        (["power", RM3, "--hs", "1", "--tp", "8", "--start", "50"], ["start is 50 s", "grow for 100 s"]),
        (["power", RM3, "--occurrence", "nothing.csv"], ["'nothing.csv'"]),
        (["power", PENDULUM, "--hs", "1", "--tp", "8"], ["has no PTO"]),
        (["power", RM3, "--hs", "1", "--tp", "8", "-o", "nowhere/x.nc"], ["no folder 'nowhere'"]),
        (["rao", RM3, "--hs", "1"], ["--hs and --tp", "together"]),
        (["rao", RM3, "--omega", "1"], ["at least two"]),
        (["rao", RM3, "--omega", "a,b"], ["--omega: got 'a,b'"]),
        (["rao", RM3, "--hs", "-1", "--tp", "8"], ["hs: got -1"]),
        (["rao", RM3, "-o", "nowhere/x.nc"], ["no folder 'nowhere'"]),
    ],
)
def test_requests(floatsim, tmp_path, arguments, words):
    status, _, said = floatsim(*arguments)
    assert status == 2, said
    for word in words:
        assert word in said, said
    assert list(tmp_path.iterdir()) == []


def test_occurrence_and_axes_must_agree(floatsim):
    Path("scatter.csv").write_text("hs,7\n0.5,0.25\n")
    status, _, said = floatsim("power", RM3, "--hs", "1", "--occurrence", "scatter.csv")
    assert status == 2 and "are not those of 'scatter.csv'" in said


def test_waves_of_a_run(floatsim):
    """A regular wave of 1.2 m is in the file and named in it, and the PTO's mean power is shown: F s' of the file."""
    status, said, error = floatsim("run", RM3, "--duration", "160", "-o", "run.nc", "--height", "1.2", "--period", "8")
    assert status == 0, error
    with xr.open_dataset("run.nc") as data:
        assert float(abs(data.wave_elevation[1000:]).max()) == pytest.approx(0.6, rel=0.01)
        late = data.sel(time=slice(100.0, None))
        power = float(-(late.pto_force * late.pto_velocity).integrate("time") / 60.0)
    row = next(line.split() for line in said.splitlines() if line.split()[:1] == ["pto"])
    assert float(row[1]) == pytest.approx(abs(power) / 1e3, rel=0.01)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [(["--hs", "2"], "--hs is given without --tp"), (["--period", "8"], "--period is given without --height"),
     (["--hs", "2", "--tp", "8", "--height", "1", "--period", "8"], "give one of them"),
     (["--hs", "-2", "--tp", "8"], "must be a positive number")],
)  # fmt: skip
def test_waves_that_cannot_be(floatsim, arguments, words):
    status, _, error = floatsim("run", RM3, "--duration", "10", *arguments)
    assert status == 2 and words in error


def test_a_run_in_waves_goes_on_from_its_checkpoint(floatsim):
    """The waves of the command line are those of the checkpoint, too: one run of 30 s and one of 20 s that is extended
    have the same samples."""
    waves = ["--hs", "2", "--tp", "8", "--seed", "7", "--interval", "1"]
    assert floatsim("run", RM3, "--duration", "30", *waves, "-o", "whole.nc")[0] == 0
    assert floatsim("run", RM3, "--duration", "20", *waves, "-o", "parts.nc", "--checkpoint", "parts.ckpt")[0] == 0
    status, _, error = floatsim("resume", "parts.ckpt", "--duration", "30")
    assert status == 0, error
    with xr.open_dataset("whole.nc") as whole, xr.open_dataset("parts.nc") as parts:
        xr.testing.assert_equal(whole, parts)
        assert float(abs(whole.wave_elevation).max()) > 0.0
