"""The matrices that come with floatsim say what their sources say.

Numbers of the two tables of Verelst et al. 2024 are worked out by hand from the text: ranges, Hs = 0.4 U, Tp = 1.33 +
4.74 sqrt(Hs), TI = 0.14 (0.75 U + 5.6)/U (IEC 61400-1, class B).
"""

import math
from collections import Counter
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from floatsim.cases.environment import build_case
from floatsim.cases.matrix import read_matrix

LOADCASES = Path(__file__).parents[2] / "loadcases"
ANGLES = ("wind_heading_deg", "wave_heading_deg", "current_heading_deg", "cable_angle_deg")
CHECK = "Load cases of Verelst et al. 2024"


@pytest.fixture(scope="module")
def screening():
    return read_matrix(LOADCASES / "screening_82m.yaml", check=False)


@pytest.fixture(scope="module")
def operational():
    return read_matrix(LOADCASES / "operational_82m.yaml", check=False)


def test_screening(screening, record):
    record(CHECK, "screening_82m: cases", len(screening.cases), (162, 162))
    rows = [tuple(case.variables[name] for name in ("study_wind_heading_deg", "study_cable_angle_deg", "seed"))
            for case in screening.cases]  # fmt: skip
    assert rows == list(product(range(0, 121, 15), range(15, 91, 15), (1, 2, 3)))
    for case in screening.cases:
        own = case.variables
        assert (own["wind_speed"], own["hs"], own["tp"]) == (12, 12.5, 18.4)
        assert own["wave_heading_deg"] == own["wind_heading_deg"]
    spot = screening.cases[64]  # 3 x 18 + 3 x 3 + 1: heading 45, angle 60, seed 2
    assert dict(spot.variables) == {
        "wind_speed": 12, "study_wind_heading_deg": 45, "study_cable_angle_deg": 60, "seed": 2, "hs": 12.5, "tp": 18.4,
        "wind_heading_deg": -45, "wave_heading_deg": -45, "cable_angle_deg": -60,
        "turbulence_intensity": pytest.approx(0.170333, abs=1e-6),
    }  # fmt: skip
    assert spot.parameters == {"cable_angle_deg": -60}
    assert spot.environment["waves"] == {"spectrum": "jonswap", "hs": 12.5, "tp": 18.4, "heading_deg": -45, "seed": 2}
    assert spot.environment["current"]["speed"] == 0 and spot.environment["wind"]["heading_deg"] == -45
    assert (spot.run.duration, spot.run.ramp, spot.run.total) == (600.0, 100.0, 700.0)


def test_operational(operational, record):
    matrix = operational
    record(CHECK, "operational_82m: cases", len(matrix.cases), (2250, 2250))
    independent = ("wind_speed", "study_wind_heading_deg", "study_misalignment_deg", "current_speed",
                   "study_current_heading_deg", "seed")  # fmt: skip
    assert matrix.independent == independent
    rows = [tuple(case.variables[name] for name in independent) for case in matrix.cases]
    heading = (0, 30, 60, 90, 120)
    assert rows == list(product((8, 12, 16), heading, (-40, -20, 0, 20, 40), (0.15, 0.25), heading, (1, 2, 3)))
    sea = {8: (3.2, 9.80917, 0.203), 12: (4.8, 11.71482, 0.170333), 16: (6.4, 13.32136, 0.154)}
    worst = 0.0
    for case in matrix.cases:
        own = case.variables
        got = own["hs"], own["tp"], own["turbulence_intensity"]
        worst = max(worst, *(abs(y - z) for y, z in zip(got, sea[own["wind_speed"]])))
    record(CHECK, "operational_82m: Hs, Tp and TI of all rows against values by hand (5 decimals)", worst, 5e-6)
    spot = matrix.cases[1106]  # 750 + 2 x 150 + 30 + 15 + 3 x 3 + 2
    shown = {name: y for name, y in spot.variables.items() if name not in ("hs", "tp", "turbulence_intensity")}
    assert shown == {
        "wind_speed": 12, "study_wind_heading_deg": 60, "study_misalignment_deg": -20, "current_speed": 0.25,
        "study_current_heading_deg": 90, "seed": 3, "study_wave_heading_deg": 40, "wind_heading_deg": -60,
        "wave_heading_deg": -40, "current_heading_deg": -90,
    }  # fmt: skip
    assert spot.environment["waves"]["heading_deg"] == -40 and spot.environment["waves"]["seed"] == 3
    assert spot.environment["current"] == {"speed": 0.25, "heading_deg": -90}
    assert len({case.id for case in matrix.cases}) == 2250
    last = matrix.cases[-1].variables
    assert last["study_wave_heading_deg"] == 160 and last["wave_heading_deg"] == -160


@pytest.mark.parametrize("name", ["screening_82m", "operational_82m"])
def test_our_picture_is_the_mirror_image(name, screening, operational, record):
    """Direction of an angle of the study, clockwise: (cos a, -sin a); the mirrored one of ours, in all rows."""
    matrix = screening if name == "screening_82m" else operational
    worst = 0.0
    for case in matrix.cases:
        own = case.variables
        study = {
            "wind_heading_deg": own["study_wind_heading_deg"],
            "wave_heading_deg": own["study_wind_heading_deg"] + own.get("study_misalignment_deg", 0),
            "current_heading_deg": own.get("study_current_heading_deg"),
            "cable_angle_deg": own.get("study_cable_angle_deg"),
        }
        used = {
            "wind_heading_deg": case.environment["wind"]["heading_deg"],
            "wave_heading_deg": case.environment["waves"]["heading_deg"],
            "current_heading_deg": case.environment["current"].get("heading_deg"),
            "cable_angle_deg": case.parameters.get("cable_angle_deg"),
        }
        for angle in ANGLES:
            if study[angle] is not None:
                a, ours = math.radians(study[angle]), math.radians(own[angle])
                worst = max(worst, abs(math.cos(ours) - math.cos(a)), abs(math.sin(ours) + math.sin(a)))
                assert used[angle] == own[angle]
    rows = f"{name}: directions against the study's, mirrored, largest difference in {len(matrix.cases)} rows"
    record(CHECK, rows, worst, 1e-15)


def test_the_same_seed_is_the_same_sea_for_every_cable_angle(screening):
    seas = {}
    for case in screening.cases[:18]:  # one heading, 6 angles, 3 seeds
        calm = {name: values for name, values in case.environment.items() if name != "wind"}
        model = build_case(type(case)(**{**vars(case), "environment": calm}))
        real = model.sea.waves.realise(model.sea.depth, model.gravity)
        seas.setdefault(case.variables["seed"], []).append((case.variables["cable_angle_deg"], real.phase))
    assert {seed: [angle for angle, _ in found] for seed, found in seas.items()} == {
        seed: [-15, -30, -45, -60, -75, -90] for seed in (1, 2, 3)
    }
    for found in seas.values():
        assert all(np.array_equal(phase, found[0][1]) for _, phase in found)
    assert not np.array_equal(seas[1][0][1], seas[2][0][1])


def test_some_of_them(record):
    reduced = read_matrix(
        LOADCASES / "screening_82m.yaml", check=False,
        only={"study_wind_heading_deg": [0, 60], "study_cable_angle_deg": [15, 60], "seed": [1]},
    )  # fmt: skip
    assert [case.number for case in reduced.cases] == [0, 9, 72, 81]
    sample = read_matrix(LOADCASES / "operational_82m.yaml", check=False, sample=60)
    uneven = 0
    for name in sample.independent:
        counts = Counter(sample.column(name))
        uneven = max(uneven, max(counts.values()) - min(counts.values()))
    what = "sample of 60 of operational_82m: cases with the commonest less those with the rarest value of a variable"
    record(CHECK, what, uneven, 2)


@pytest.mark.parametrize("name", ["screening_82m", "operational_82m"])
def test_their_models_can_be_built(name):
    read_matrix(LOADCASES / f"{name}.yaml", check=True)


def test_scatter_table_of_a_wec(record):
    matrix = read_matrix(LOADCASES / "scatter_rm3.yaml", check=True)
    assert all(case.variables["occurrence"] > 0.0 for case in matrix.cases) and len(matrix.cases) == 67
    total = sum(case.variables["occurrence"] for case in matrix.cases)
    record("Load cases: scatter_rm3", "sum of the occurrences", total, (0.999, 1.0))
    spot = next(c for c in matrix.cases if (c.variables["hs"], c.variables["tp"]) == (2.5, 9))
    assert spot.variables["occurrence"] == 0.0703 and spot.variables["seed"] == 2590
    waves = build_case(spot).sea.waves
    assert (waves.spectrum.hs, waves.spectrum.tp, waves.seed, waves.omega_max) == (2.5, 9.0, 2590, 4.0)
    assert len({case.variables["seed"] for case in matrix.cases}) == 67


def test_decay_tests_of_two_depths():
    matrix = read_matrix(LOADCASES / "decay_volturnus_s.yaml", check=True)
    rows = Counter((case.variables["depth"], case.variables["motion"]) for case in matrix.cases)
    assert rows == {(d, m): 3 for d in (200, 82) for m in ("surge", "sway", "heave", "roll", "pitch")}
    for case in matrix.cases[::3]:
        model = build_case(case)
        assert model.sea.depth == case.variables["depth"] and model.sea.waves is None
        assert not any(part.name.startswith("cable") for part in model.parts)
        run = case.run
        assert (run.study, run.dof, run.offset) == ("decay", case.variables["motion"], case.variables["offset"])
        assert run.total > 3.0 * model.expected.periods_s.get(run.dof, 30.0)
