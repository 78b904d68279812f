"""The reduced screening of Verelst et al. 2024 from the command line to the report: 2 wind headings, 2 cable angles,
one seed, 600 s after the ramp, run, collected and looked at in a browser."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from browser import CHROMIUM, DRIVER, WHY_NOT, Browser

MATRIX = Path(__file__).parents[2] / "loadcases" / "screening_82m.yaml"
ONLY = ("study_wind_heading_deg=0,60", "study_cable_angle_deg=15,90", "seed=1")
CHECK = "reduced screening_82m, 4 cases of 600 s"


def program(*arguments: object) -> str:
    done = subprocess.run([sys.executable, "-m", "floatsim", "cases", *map(str, arguments)], capture_output=True,
                          text=True, check=False)  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    place = tmp_path_factory.mktemp("screening") / "results"
    program("run", MATRIX, "-o", place, "--jobs", "2", *(word for item in ONLY for word in ("--only", item)))
    program("collect", place)
    program("report", place)
    yield place


@pytest.mark.slow
def test_cases_are_there(folder, record):
    with xr.open_dataset(folder / "summary.nc") as data:
        data.load()
    done = data.where(data.status == "done", drop=True)
    record(CHECK, "cases done", done.sizes["case"], (4, 4))
    assert sorted(set(done.wind_heading_deg.values)) == [-60.0, 0.0]
    plan = done.platform_position_mean.sel(dof=["surge", "sway"])
    far = 0.0
    for _, group in plan.groupby("wind_heading_deg"):
        far = max(far, float(np.linalg.norm(group.max("case") - group.min("case"))))
    record(CHECK, "mean position: difference between cable angles 15 and 90 deg (the study: none)", far, 0.5, "m")
    for heading, group in plan.groupby("wind_heading_deg"):
        x, y = group.mean("case").values
        off = np.degrees(np.arctan2(y, x)) - heading  # both are axes of symmetry of the three chains
        what = f"mean position: its direction less the wind's, wind towards {heading:g} deg"
        record(CHECK, what, abs((off + 180.0) % 360.0 - 180.0), 5.0, "deg")
    rotor = done.rotor_speed_mean.values / (2.0 * np.pi / 60.0)
    record(CHECK, "rotor speed, mean of all", float(rotor.mean()), (7.35, 7.65), "rpm")


@pytest.mark.slow
@pytest.mark.skipif(not (CHROMIUM and DRIVER), reason=WHY_NOT)
def test_report_in_a_browser(folder, record, tmp_path):
    with Browser(tmp_path) as browser:
        browser.open(folder / "report.html")
        said = browser.console()
        record(CHECK, "messages in Chromium's console", len(said), 0)
        rows = browser.run("return [...document.querySelectorAll('#all tbody tr')].filter(r => !r.hidden).length")
        assert rows == 4
