"""`floatsim hydro check | plot | convert`: what is printed and written, and exit statuses."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from floatsim.cli import main
from floatsim.errors import CaseError
from floatsim.hydro.database import HydroDatabase
from floatsim.study.hydro_report import plot_database

MODELS = Path(__file__).parents[2] / "models"
SHIPPED = MODELS / "volturnus_s_hydro.nc"
Call = Callable[..., tuple[int, str, str]]


@pytest.fixture
def hydro(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Call:
    """Calls `floatsim hydro` in an empty folder: (exit status, standard output, standard error)."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["floatsim", "hydro", *map(str, arguments)])
        with pytest.raises(SystemExit) as left:
            main()
        said = capsys.readouterr()
        assert "Traceback" not in said.err
        return int(left.value.code or 0), re.sub(r"\s+", " ", said.out), said.err

    return call


@pytest.fixture(scope="module")
def small() -> HydroDatabase:
    """The shipped database at a few frequencies and headings."""
    db = HydroDatabase.read(SHIPPED)
    n, m = slice(0, 60, 2), slice(0, 72, 18)
    return replace(
        db, name="small", omega=db.omega[n], added_mass=db.added_mass[n], radiation_damping=db.radiation_damping[n],
        headings=db.headings[m], excitation=db.excitation[n, m], mean_drift=db.mean_drift[n, m], hull_vertices=None,
        hull_faces=None,
    )  # fmt: skip


def pair(db: HydroDatabase) -> HydroDatabase:
    twice = np.eye(2)
    return replace(
        db, name="pair", bodies=("left", "right"), added_mass=np.kron(twice, db.added_mass),
        radiation_damping=np.kron(twice, db.radiation_damping), added_mass_inf=np.kron(twice, db.added_mass_inf),
        excitation=np.tile(db.excitation, (1, 1, 2)), mean_drift=None,
        hydrostatic_stiffness=np.kron(twice, db.hydrostatic_stiffness),
        volume=np.tile(db.volume, 2), centre_of_buoyancy=np.tile(db.centre_of_buoyancy, (2, 1)),
        reference_point=np.tile(db.reference_point, (2, 1)), added_mass_zero=None,
    )  # fmt: skip


def test_check_of_the_shipped_database(hydro: Call) -> None:
    status, said, errors = hydro("check", SHIPPED)
    assert (status, errors) == (0, "")
    assert "60 frequencies 0.05 to 3 rad/s, 72 headings -180 to 175 deg, 200 m deep, 1025 kg/m3" in said
    for quantity in ("symmetry of added mass", "long-wave surge and sway", "radiated energy", "irregular frequencies"):
        assert quantity in said
    assert "good: every check is passed" in said and " warning" not in said


def test_check_says_what_to_be_careful_about(hydro: Call, small: HydroDatabase) -> None:
    small.write("coarse.nc")
    status, said, errors = hydro("check", "coarse.nc")
    assert status == 0
    assert "usable, with care about" in said and "heading step" in said and "frequency step" in said
    replace(small, excitation=small.excitation.conj()).write("turned.nc")
    status, said, errors = hydro("check", "turned.nc")
    assert status == 2 and "do not use it: long-wave surge and sway excitation" in said
    assert "check the depth, the time sign" in said
    assert errors == "error: 'turned.nc' has errors, see above\n"


def test_convert_and_options(hydro: Call, tmp_path: Path) -> None:
    """WAMIT's files lack nearly everything; -p gives it, and what is found is said."""
    for ending, text in (
        (".1", "-1 1 1 3.0\n0 1 1 1.0\n20.0 1 1 1.0 0.1\n10.0 1 1 1.0 0.1\n"),
        (".3", "20.0 0.0 1 1.0 90.0 0.0 1.0\n10.0 0.0 1 1.0 90.0 0.0 1.0\n"),
        (".hst", "3 3 4.0\n"),
    ):
        (tmp_path / f"box{ending}").write_text(text)
    status, _, errors = hydro("convert", "box.1", "-o", "box.nc")
    assert status == 2 and not Path("box.nc").exists()
    assert errors.startswith("error: 'box.1' is WAMIT's numeric output, which does not contain volume, centre_of_buoy")
    options = [word for item in ("volume=6", "centre_of_buoyancy=(0,0,-1)", "depth=inf", "density=1000", "gravity=9.81")
               for word in ("-p", item)]  # fmt: skip
    status, said, errors = hydro("convert", "box.1", "-o", "box.nc", *options)
    assert (status, said) == (0, "wrote box.nc ")
    assert "warning: heading step: only heading 0 deg is there" in errors
    db = HydroDatabase.read("box.nc")
    assert db.added_mass_inf[0, 0] == 1000.0 and db.depth == np.inf
    assert hydro("check", "box.nc")[0] == hydro("check", "box.hst", *options)[0]


@pytest.mark.parametrize("two", [False, True])
def test_plot(hydro: Call, small: HydroDatabase, two: bool) -> None:
    (pair(small) if two else small).write("some.nc")
    assert hydro("plot", "some.nc") == (0, "wrote some.nc.png ", "")
    assert Path("some.nc.png").read_bytes()[:4] == b"\x89PNG"
    assert hydro("plot", "some.nc", "-o", "page.pdf")[0] == 0 and Path("page.pdf").stat().st_size > 1000
    with pytest.raises(CaseError, match=r"picture 'page\.xyz' cannot be written"):
        plot_database(small, "page.xyz")
    assert hydro("plot", "some.nc", "-o", ".") == (2, "", "error: picture '.' is a folder; give a file name\n")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("check", "nobody.nc"), "error: 'nobody.nc': there is no such file or folder"),
        (("check", "."), "neither Nemoh.cal nor Input/ControlFile.in"),
        (("check", SHIPPED, "-p", "depth=100"), "whose reader has no option 'depth'; the file holds everything"),
        (("check", SHIPPED, "-p", "depth"), "write name=value"),
        (("convert", SHIPPED, "-o", "no/where.nc"), "no/where.nc"),
        (("convert", SHIPPED), "-o"),
        (("draw", SHIPPED), "draw"),
    ],
)
def test_bad_input(hydro: Call, arguments: tuple[object, ...], message: str) -> None:
    status, _, errors = hydro(*arguments)
    assert status == 2 and message in errors, errors


def test_help(hydro: Call) -> None:
    for verb in ("check", "plot", "convert"):
        status, said, _ = hydro(verb, "--help")
        assert status == 0 and "FILE" in said and "-p" in said
