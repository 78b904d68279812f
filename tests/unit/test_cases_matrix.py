"""Matrices of cases: what a file means, and everything that can be wrong with one."""

import json
import re
import sys
import time
from collections import Counter
from itertools import combinations
from pathlib import Path

import pytest

import floatsim as fs
from floatsim.cases.case import Case
from floatsim.cases.choice import parse_only, spread
from floatsim.cases.environment import build_case, current_of, waves_of
from floatsim.cases.listing import headline, list_cases, template, templates
from floatsim.cases.matrix import read_matrix, unit_of
from floatsim.errors import CaseError, ModelError

PENDULUM = """
import math
import floatsim as fs

def build(length=2.0, mass=10.0, angle_deg=30.0, name="rod", data=None, waves=None, damp=(0.0, 0.0)):
    if length > 90:
        raise RuntimeError("no room for a rod of %g m" % length)
    J = mass * length**2 / 12.0
    rod = fs.Body(name=name, mass=mass, inertia=(J, J, 1e-4 * J), center_of_mass=(0.0, 0.0, -length / 2.0),
                  position=(0.0, 0.0, 5.0), attitude_deg=(0.0, angle_deg, 0.0))
    return fs.Model(name="pendulum", parts=[rod], joints=[fs.Ball(a=name, b=(0.0, 0.0, 5.0), name="hinge")],
                    sea=fs.Sea(depth=30.0, waves=waves))
"""
CALM = PENDULUM.replace("waves=None, ", "").replace(", waves=waves", "")  # knows nothing of waves


@pytest.fixture
def read(tmp_path, monkeypatch):
    """read(text, **options): the matrix of a file beside two scripts."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "model.py").write_text(PENDULUM)
    (tmp_path / "calm.py").write_text(CALM)

    def of(text, check=False, **options):
        (tmp_path / "m.yaml").write_text(text)
        return read_matrix("m.yaml", check=check, **options)

    return of


def refused(read, text, *said, check=False, **options):
    with pytest.raises(CaseError) as caught:
        read(text, check=check, **options)
    problems = "\n".join(caught.value.problems)
    for words in said:
        assert words in problems, problems
    return caught.value.problems


HEAD = "model: model.py\nrun: {duration: 10, ramp: 0}\n"


# -- variables -------------------------------------------------------------------------------------


def test_product_order_values_and_expressions(read):
    matrix = read(HEAD + """
name: trial
variables:
  u: [8, 12.0, 1.6e1]
  heading_deg: {range: [0, 30], step: 15}
  share: {linspace: [0, 1, 3]}
  seed: {seeds: 2, first: 5}
  fixed: 7
  mode: {text: no}
  tp: 1.33 + 4.74 * sqrt(hs)      # before what it needs
  hs: 0.4 * u
  word: "'high' if u > 10 else 'low'"
parameters: {length: tp, angle_deg: heading_deg + share, mass: u + seed}
""")
    assert matrix.name == "trial" and len(matrix.cases) == matrix.size == 3 * 3 * 3 * 2
    assert matrix.variables == ("u", "heading_deg", "share", "seed", "fixed", "mode", "tp", "hs", "word")
    assert matrix.independent == ("u", "heading_deg", "share", "seed", "fixed", "mode")
    assert matrix.column("u") == [8] * 18 + [12] * 18 + [16] * 18  # the first is slowest
    assert matrix.column("heading_deg")[:18] == [0] * 6 + [15] * 6 + [30] * 6
    assert matrix.column("share")[:6] == [0, 0, 0.5, 0.5, 1, 1] and matrix.column("seed")[:3] == [5, 6, 5]
    case = matrix.cases[-1]
    assert case.number == 53 and case.variables["mode"] == "no" and case.variables["word"] == "high"
    assert case.variables["hs"] == pytest.approx(6.4) and case.variables["tp"] == pytest.approx(1.33 + 4.74 * 6.4**0.5)
    assert case.parameters == {"length": case.variables["tp"], "angle_deg": 31, "mass": 22}
    assert matrix.units == {"heading_deg": "deg", "tp": "s", "hs": "m"}
    assert matrix.results == matrix.path.parent / "m_results"
    assert re.fullmatch(r"u16_h30_share1_seed6-[0-9a-f]{10}", case.id)
    assert Case.from_dict(json.loads(json.dumps(case.as_dict()))).id == case.id


def test_words_and_numbers_of_yaml(read):
    """1e3 is a number; yes, no, on, off, dates and 12:30 are text, 010 is ten: the words of YAML 1.2."""
    matrix = read(HEAD + "variables: {x: [1e3, 010, -.5], word: [yes, off, 12:30, 2020-01-01, '1e3']}\n"
                         "parameters: {mass: x, data: word}")  # fmt: skip
    assert list(dict.fromkeys(matrix.column("x"))) == [1000, 10, -0.5]
    assert list(dict.fromkeys(matrix.column("word"))) == ["yes", "off", "12:30", "2020-01-01", "1e3"]
    assert read(HEAD + "variables: {mass: 1e3}\nparameters: {mass: mass}").cases[0].parameters == {"mass": 1000}
    refused(read, HEAD.replace("ramp: 0", "ramp: yes") + "variables: {mass: 1}", "'yes' refers to 'yes'", "run.ramp")


def test_ranges_are_exact_and_meet_their_end(read):
    matrix = read(HEAD + "variables: {mass: {range: [0.1, 0.7], step: 0.1}}\nparameters: {mass: mass}")
    assert matrix.column("mass") == [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]
    down = read(HEAD + "variables: {mass: {range: [3, 1], step: -1}}\nparameters: {mass: mass}")
    assert down.column("mass") == [3, 2, 1]
    refused(read, HEAD + "variables: {a: {range: [0, 100], step: 30}}", "do not meet 100; the last one below is 90")


def test_columns_that_walk_together(read):
    matrix = read(HEAD + "zip: {mass: [1, 2, 2], length: [3, 3, 4]}\nvariables: {angle_deg: [10, 20]}\n"
                         "parameters: {mass: mass, length: length, angle_deg: angle_deg}")  # fmt: skip
    rows = [tuple(case.variables.values()) for case in matrix.cases]
    assert rows == [(1, 3, 10), (1, 3, 20), (2, 3, 10), (2, 3, 20), (2, 4, 10), (2, 4, 20)]
    refused(read, HEAD + "zip: {a: [1, 2], b: [1]}", "zip: columns that walk together", "a has 2, b has 1")


def test_tables(read, tmp_path):
    (tmp_path / "sea.csv").write_text("# of a buoy\ntime;Hs;Tp\n1970-01-01;1.5;8\n1970-01-02;0.2;5\n1970-01-03;3;9.5\n")
    matrix = read(HEAD + """
table: {file: sea.csv, columns: {when: time, hs: Hs, tp: Tp}, row: line, where: hs > 1}
variables: {seed: 10 * line}
waves: {hs: hs, tp: tp, seed: seed}
""")
    assert [tuple(case.variables.values()) for case in matrix.cases] == [
        ("1970-01-01", 1.5, 8, 1, 10), ("1970-01-03", 3, 9.5, 3, 30)
    ]  # fmt: skip
    (tmp_path / "scatter.csv").write_text("hs,6,8\n1,0.1,0.2\n2,0,0.3\n")
    cells = read(HEAD + "scatter: scatter.csv\nwaves: {hs: hs, tp: tp, seed: 1}")
    assert [tuple(case.variables.values()) for case in cells.cases] == [(1, 6, 0.1), (1, 8, 0.2), (2, 8, 0.3)]
    assert [case.slug for case in cells.cases] == ["hs1_tp6", "hs1_tp8", "hs2_tp8"]
    refused(read, HEAD + "table: {file: sea.csv, columns: {hs: HS}}", "no column 'HS' (did you mean 'Hs'?)")
    refused(read, HEAD + "table: nowhere.csv", "'nowhere.csv' cannot be read")
    refused(read, HEAD + "table: {file: sea.csv, columns: {hs: Hs}, where: tp > 3}", "refers to 'tp'")
    refused(read, HEAD + "table: {file: sea.csv, columns: {hs: Hs}, where: hs > 30}", "no row of 'sea.csv'")
    (tmp_path / "short.csv").write_text("hs,tp\n1\n,3\n")
    refused(read, HEAD + "table: short.csv", "line 2: 1 cells under 2 names", "line 3: column 'hs' is empty")


def test_blocks_take_over_and_change(read):
    matrix = read("""
model: model.py
variables: {mass: [1, 2], twice: 2 * length}
parameters: {mass: mass, length: length}
run: {duration: 10, ramp: 0}
blocks:
  - name: short
    variables: {length: [3, 4]}
  - name: long
    variables: {length: 9, mass: 5}
    run: {duration: 99}
  - name: calm
    model: calm.py
    variables: {length: 4}
""")
    assert matrix.column("group") == ["short"] * 4 + ["long"] + ["calm"] * 2
    assert matrix.column("mass") == [1, 1, 2, 2, 5, 1, 2] and matrix.column("twice") == [6, 8, 6, 8, 18, 8, 8]
    assert [case.run.duration for case in matrix.cases] == [10] * 4 + [99] + [10] * 2
    assert [Path(case.model).name for case in matrix.cases] == ["model.py"] * 5 + ["calm.py"] * 2
    assert [case.number for case in matrix.cases] == list(range(7))
    text = "model: model.py\nrun: {duration: 9}\nblocks:\n  - {variables: {mass: 1}}\n  - {variables: {length: 1}}\n"
    refused(read, text, "'mass' is a variable of some blocks only", "line 5")


# -- what makes a case -----------------------------------------------------------------------------


def test_a_case_is_its_inputs(read, tmp_path):
    """The id follows script, neighbours, data, parameters and settings, and nothing else."""
    text = HEAD + "variables: {mass: [1, 2]}\nparameters: {mass: mass, data: {file: data.txt}}\n"
    (tmp_path / "data.txt").write_text("1")
    ids = {}

    def now(what, text=text):
        ids[what] = read(text).cases[1].id

    now("first")
    now("again")
    now("another name", "name: x\n" + text)
    now("patience", text.replace("ramp: 0", "ramp: 0, time_limit: 60"))
    now("one number, another way", text.replace("[1, 2]", "[1.0, 2.0]"))
    same = set(ids.values())
    assert len(same) == 1
    (tmp_path / "data.txt").write_text("2")
    now("data")
    (tmp_path / "neighbour.py").write_text("X = 1\n")
    (tmp_path / "model.py").write_text("def late():\n    import neighbour\n" + PENDULUM)
    now("script")
    (tmp_path / "neighbour.py").write_text("X = 2\n")
    now("neighbour")
    (tmp_path / "table.csv").write_text("1\n")
    (tmp_path / "neighbour.py").write_text("X = 2\nTABLE = 'table.csv'\n")
    now("neighbour that names a file")
    (tmp_path / "table.csv").write_text("2\n")
    now("that file")
    now("settings", text.replace("ramp: 0", "ramp: 0, dt: 0.05"))
    assert len(set(ids.values())) == 7
    unmoved = {case.id for case in read(text).cases}
    (tmp_path / "other").mkdir()
    for name in ("model.py", "neighbour.py", "table.csv", "data.txt", "m.yaml"):
        (tmp_path / "other" / name).write_text((tmp_path / name).read_text())
    assert {case.id for case in read_matrix("other/m.yaml", check=False).cases} == unmoved


def test_the_model_of_a_case(read):
    text = """
model: {model}
variables: {{hs: 2, tp: 9, seed: 4}}
parameters: {{length: hs, damp: [1, hs]}}
waves: {{spectrum: torsethaugen, hs: hs, tp: tp, heading_deg: -30, seed: seed, spreading: 8}}
current: {{speed: 0.1 * hs, heading_deg: 90, exponent: 1 / 7}}
run: {{duration: 60, ramp: 100}}
"""
    expected = fs.IrregularWaves(spectrum=fs.Torsethaugen(hs=2.0, tp=9.0), seed=4, heading_deg=-30.0, spreading=8.0,
                                 duration=160.0)  # fmt: skip
    for script in ("model.py", "calm.py"):  # given to build, or put into its sea
        sea = build_case(read(text.format(model=script), check=True).cases[0]).sea
        assert sea.waves == expected and sea.depth == 30.0
        assert sea.current == fs.Current(speed=0.2, heading_deg=90.0, profile=fs.PowerLaw(exponent=1 / 7))


def test_kinds_of_waves_and_current():
    assert waves_of({"kind": "none"}, 10.0) is None
    regular = fs.RegularWave(height=2.0, period=8.0, heading_deg=45.0)
    assert waves_of({"kind": "regular", "height": 2, "period": 8, "heading_deg": 45}, 10.0) == regular
    both = waves_of({"combined": [{"hs": 2, "tp": 8, "seed": 1}, {"kind": "regular", "height": 1, "period": 15}]}, 70.0)
    assert isinstance(both, fs.CombinedWaves) and both.waves[0].duration == 70.0
    assert both.waves[0].spectrum == fs.Jonswap(hs=2.0, tp=8.0)
    assert waves_of({"spectrum": "ochi_hubble", "hs": [1, 2], "tp": [12, 7], "lam": [3, 1], "seed": 1}, 9.0).spectrum
    rows = {"depths": [0, 30], "speeds": [1, 0.5], "headings_deg": [0, 20]}
    assert current_of(rows) == fs.Current.table(depths=[0.0, 30.0], speeds=[1.0, 0.5], headings_deg=[0.0, 20.0])
    profile = fs.CurrentTable(depths=(0.0, 30.0), factors=(1.0, 0.2))
    assert current_of({"speed": 1, "depths": [0, 30], "factors": [1, 0.2]}) == fs.Current(speed=1.0, profile=profile)
    for bad, said in (
        ({"hs": 2, "tp": 8, "sed": 1}, "no 'sed' .did you mean 'seed'"), ({"kind": "wild"}, "got 'wild'"),
        ({"spectrum": "jonswop", "hs": 2}, "did you mean 'jonswap'"), ({"hs": -2, "tp": 8, "seed": 1}, "got -2"),
    ):  # fmt: skip
        with pytest.raises((CaseError, ModelError), match=said):
            waves_of(bad, 10.0)
    for bad, said in (
        ({"speed": 1, "depths": [0], "factors": [1], "exponent": 0.1}, "exclude"), ({"speeds": [1]}, "need depths"),
        ({"speed": 1, "speeds": [1], "depths": [0]}, "exclude"), ({"speed": 1, "headings_deg": [0]}, "belongs to"),
    ):  # fmt: skip
        with pytest.raises(CaseError, match=said):
            current_of(bad)


def test_wind(read, tmp_path):
    pytest.importorskip("floatsim.wind.turbulence")
    from floatsim.cases.environment import wind_of
    from floatsim.wind.inflow import Wind
    from floatsim.wind.turbulence import Kaimal

    text = HEAD + "variables: {u: [8, 12]}\nwind: {speed: u, turbulence_intensity: 0.1, seed: 3}"
    refused(read, text, "build() takes no 'wind' that it could put on a rotor", check=True)
    (tmp_path / "model.py").write_text(PENDULUM.replace("waves=None,", "waves=None, wind=None,"))
    assert len(read(text, check=True).cases) == 2
    refused(read, text.replace("seed: 3", "seed: 3, duration: 5"), "wind: duration is 5 s", check=True)
    refused(read, text.replace("seed: 3", "seed: 3, share: 5"), "no 'share'", check=True)
    values = {"speed": 8, "heading_deg": -30, "shear": 0.14, "turbulence_intensity": 0.2, "seed": 3, "components": 300}
    expected = Wind(speed=8.0, heading_deg=-30.0, shear=0.14,
                    turbulence=Kaimal(intensity=0.2, seed=3, components=300, duration=800.0))  # fmt: skip
    assert wind_of(values, 800.0) == expected
    assert wind_of({"speed": 8, "turbulence_intensity": 0, "seed": 1}, 9.0) == Wind(speed=8.0)


# -- a choice of cases -----------------------------------------------------------------------------

MANY = HEAD + """
variables: {mass: [1, 2, 3], length: [4, 5, 6, 7, 8], angle_deg: [10, 20], half: mass / 2}
parameters: {mass: mass, length: length, angle_deg: angle_deg}
"""


def test_only_some(read):
    whole = read(MANY)
    some = read(MANY, only={"mass": [1, 3.0], "half": [0.5], "length": 5})
    assert [case.number for case in some.cases] == [2, 3] and some.size == 30
    assert [case.id for case in some.cases] == [whole.cases[k].id for k in (2, 3)]
    assert parse_only(["mass=1,3", "word=a, true"]) == {"mass": [1, 3], "word": ["a", True]}
    refused(read, MANY, "no case has mass = 4; there are 1, 2, 3", "no variable 'lengt' (did you mean 'length'?)",
            only={"mass": [4], "lengt": [1]})  # fmt: skip
    refused(read, MANY, "all of these values together", only={"mass": [1], "half": [1.5]})
    with pytest.raises(CaseError, match="write name=value"):
        parse_only(["mass"])


@pytest.mark.parametrize("n", [10, 13, 15, 20, 29])
def test_a_sample_is_spread_over_values_and_pairs(read, n):
    matrix = read(MANY, sample=n)
    assert len(matrix.cases) == n and matrix.cases == read(MANY, sample=n).cases
    assert sorted(case.number for case in matrix.cases) == [case.number for case in matrix.cases]
    for name in matrix.independent:
        counts = Counter(matrix.column(name)).values()
        assert max(counts) - min(counts) <= 2, name
    for a, b in combinations(matrix.independent, 2):
        assert max(Counter(zip(matrix.column(a), matrix.column(b))).values()) <= 1.6 * n / 6 + 1


def test_sample_of_more_than_there_are_and_of_many(read):
    assert len(read(MANY, sample=99).cases) == 30
    refused(read, MANY, "sample: got 0", sample=0)
    big = read(HEAD + "variables: {mass: {range: [1, 2000], step: 1}}\nparameters: {mass: mass}")
    masses = [case.variables["mass"] for case in spread(big.cases, 16)]
    assert Counter((int(y) - 1) // 250 for y in masses) == dict.fromkeys(range(8), 2)


# -- what is wrong ---------------------------------------------------------------------------------


def test_all_problems_at_once_with_their_lines(read):
    problems = refused(read, """
modell: x
model: nowhere.py
variables:
  hs: 0.4 * wind_sped
  wind_speed: [8, 8]
  Wrong: 1
  a: b
  b: a
  sqrt: 3
  status: 1
  tp: sqr(hs)
  range: {range: [0, 10]}
parameters: {length: sqrt(wnd_speed), kind: state_space}
waves: {hs: hs, heading: 3}
run: {durations: 3}
units: {hs: [1]}
""")
    text = "\n".join(problems)
    for said in (
        "m.yaml, line 2, modell: there is no key 'modell' (did you mean 'model'?)",
        "line 5, variables.hs: '0.4 * wind_sped' refers to 'wind_sped', which is no variable (did you mean 'wind_sp",
        "line 6, variables.wind_speed: 8 is in the list twice", "line 7, variables.Wrong: 'Wrong' cannot be a name",
        "line 4, variables: these variables need each other: ", "line 10, variables.sqrt: 'sqrt' is a function",
        "line 11, variables.status: 'status' has its own meaning", "line 12, variables.tp", "did you mean 'sqrt'",
        "line 13, variables.range: got {'range'", "line 14, parameters.length", "'wnd_speed'",
        "if it is text, write {text: state_space}", "run: 'duration' is missing",
        "line 16, run.durations: run: there is no 'durations' (did you mean 'duration'?)",
        "line 15, waves.heading: waves: there is no 'heading' (did you mean 'heading_deg'?)", "line 17, units.hs",
    ):  # fmt: skip
        assert said in text, f"{said}\n{text}"
    assert len(problems) >= 15


@pytest.mark.parametrize(
    "text, said",
    [
        ("model: model.py\nmodel: x.py\nrun: {duration: 1}", "line 2, model: the key is there twice, first in line 1"),
        (HEAD + "variables: {a: [1,\n  2}", "this is no YAML"), ("- 1\n", "a matrix has keys"),
        ("", "a matrix has keys"),
        (HEAD + "variables: {a: 1, a: 2}", "variables.a: the key is there twice"),
        (HEAD + "variables: {a: !!python/object/apply:os.system ['true']}", "apply:os.system is not understood"),
        (HEAD + "variables: {a: !!binary aGk=}", "not understood"),
        (HEAD + "variables: &a\n  b: *a\n", "aliases that unfold without end"),
        (HEAD + "variables: {a: <site's hs>}", "line 3, variables.a: to be filled in: site's hs"),
        (HEAD + "variables: {a: [1, .nan]}", "finite numbers"), (HEAD + "variables: {a: []}", "the list is empty"),
        (HEAD + "variables: {a: [[1]]}", "values are finite numbers or text"),
        (HEAD + "variables: {a: null}", "got None"),
        (HEAD + "variables: {a: {seeds: 0}}", "a number of seeds"), (HEAD + "variables: {a: {seed: 3}}", "'seeds'"),
        (HEAD + "variables: {a: {seeds: 2, start: 3}}", "there is no 'start'"),
        (HEAD + "variables: {a: {linspace: [0, 1]}}", "linspace takes"), (HEAD + "variables: 3", "keys with values"),
        (HEAD + "variables: {a: {range: [0, 1], step: 0}}", "no step of 0"),
        (HEAD + "variables: {a: 1}\nzip: {a: [1]}", "the variable 'a' is given twice"),
        (HEAD + "blocks: 3", "must be a list of blocks"),
        (HEAD + "blocks: [{run: {}}, {blocks: []}]", "no key 'blocks'"),
        (HEAD + "blocks: [{name: a}, {name: a}]", "no two the same"),
        (HEAD + "units: {hs: m}", "there is no variable 'hs'"),
        ("model: model.py\nrun: {duration: -1}", "run.duration: run: duration: got -1; must be a positive number"),
        ("model: model.py\nrun: {duration: 1, drmp: 3}", "run.drmp: run: there is no 'drmp' (did you mean 'ramp'?)"),
        ("model: model.py\nrun: {duration: 1, keep: all}", "keep: got 'all'"),
        ("model: model.py\nrun: {duration: 1, study: decay}", "a decay test needs dof"),
        ("model: model.py\nrun: {duration: 1, dof: heave}", "belong to study: decay"),
        ("model: model.py\nrun: {duration: 1, channels: 3}", "must be all, or a list of names"),
        ("run: {duration: 1}", "the path of a model script is missing"),
        (HEAD + "variables: {x: [1, 4]}\nparameters: {mass: sqrt(2 - x)}",
         "has no value with x = 4: math domain error"),
        (HEAD + "variables: {x: [0, 1]}\nparameters: {mass: y}", "no variable"),
        (HEAD + "waves: {hs: 2, tp: 8, seed: 1, gama: 2}", "line 3, waves.gama: waves: there is no 'gama'"),
        (HEAD + "waves: {hs: -2, tp: 8, seed: 1}", "line 3, waves.hs: Jonswap: hs: got -2"),
        (HEAD + "waves: {hs: 2, tp: 8}", "'seed' is missing"),
        (HEAD + "current: {speed: -1}", "Current: speed: got -1"),
        (HEAD + "current: {speed: {file: m.yaml}}", "files can be given in parameters only"),
        (HEAD + "parameters: {data: {file: nowhere.nc}}", "there is no file"),
        (HEAD + "parameters: {data: {file: 3}}", "there is no file '3'"),
        (HEAD + "parameters: {text: q}", "'q' refers to 'q'"),
        (HEAD + "waves: {combined: 3}", "must be a list of waves"),
        (HEAD + "waves: {combined: [1]}", "must be keys with values"),
        (HEAD + "waves: {spectrum: [], hs: 1}", "there is no spectrum '[]'"),
        (HEAD + "table: {file: m.yaml, columns: {hs: [1]}}", "our name: name in the file"),
        (HEAD + "parameters: {lenght: 3}", "build() takes no 'lenght' (did you mean 'length'?)"),
        (HEAD + "parameters: {length: 91}", "line 7, with length=91: RuntimeError: no room for a rod of 91 m"),
        (HEAD + "variables: {x: {range: [1, 2000], step: 1}, y: {range: [1, 2000], step: 1}}",
         "more than 1000000 cases"),
    ],
)  # fmt: skip
def test_bad_files(read, text, said):
    refused(read, text, said)


def test_a_file_that_is_not_there_or_no_text(tmp_path):
    with pytest.raises(CaseError, match="cannot be read"):
        read_matrix(tmp_path / "m.yaml")
    (tmp_path / "m.yaml").write_bytes(b"\xff\xfe\x00name")
    with pytest.raises(CaseError, match="no text in UTF-8"):
        read_matrix(tmp_path / "m.yaml")


def test_the_same_case_twice(read):
    text = HEAD + "variables: {mass: [1, 2], depth: [10, 20, 30]}\nparameters: {mass: mass}"
    (said,) = refused(read, text, "cases 0 and 1 are the same case (and 3 more pairs)", "what differs, depth, changes")
    text = HEAD + "zip: {mass: [1, 2, 1]}\nparameters: {mass: mass}"
    refused(read, text, "cases 0 and 2 are the same case: all of their variables are equal")


SEA = "waves: {hs: 2, tp: 9, seed: seed}\nvariables: {seed: {seeds: 3}}\nmodel: model.py\n"


@pytest.mark.parametrize(
    "text, said",
    [
        (HEAD.replace("ramp: 0",
         "ramp: 0, channels: [rod_positon]"), "no 'rod_positon' (did you mean 'rod_position'?)"),
        (HEAD.replace("ramp: 0", "ramp: 0, fatigue: {hing_force: 3}"), "there is no 'hing_force' (did you mean"),
        (HEAD.replace("ramp: 0", "ramp: 0, interval: 20"), "longer than the duration"),
        (HEAD.replace("ramp: 0", "ramp: 30, interval: 15"), "shorter than the interval: nothing would be kept"),
        (SEA + "run: {duration: 60, ramp: 50}", "ramp is 50 s, but the waves of model 'pendulum' grow for 100 s"),
        (SEA + "run: {duration: 60, dt: 1}", "which the integrator would distort"),
        (SEA.replace("seed: seed", "seed: seed, components: 20") + "run: {duration: 3000}",
         "20 components repeat after"),
        (SEA.replace("seed: seed", "seed: seed, duration: 100") + "run: {duration: 60}", "until 100 s"),
        (HEAD + "variables: {length: [2, 95]}\nparameters: {length: length}", "case 1 (l95): model script"),
        (HEAD + "variables: {rod_position_mean: 2}", "the summary has an output of that name; rename the variable"),
        (HEAD + "variables: {wave: 2}\nwaves: {kind: none}\nparameters: {waves: null}", "'waves' is given twice"),
    ],
)  # fmt: skip
def test_what_a_check_finds_before_anything_runs(read, text, said):
    refused(read, text, said, check=True)


def test_a_check_looks_at_every_structure(read):
    """The name of the body is a parameter: its channels are there in one case and not in the other."""
    text = HEAD.replace("ramp: 0", "ramp: 0, channels: [rod_position]")
    text += "variables: {who: [rod, stick]}\nparameters: {name: who}"
    refused(read, text, "case 1 (whostick): run: channels: there is no 'rod_position'", check=True)


def test_a_check_builds_each_model_once(read, tmp_path):
    (tmp_path / "model.py").write_text(PENDULUM + "\n_build = build\ndef build(length, waves=None):\n"
                                       "    open('built', 'a').write('x')\n    return _build(length, waves=waves)\n")
    shown = []
    text = ("model: model.py\nvariables: {length: [1, 2], hs: [1, 2, 3], seed: {seeds: 10}}\nrun: {duration: 60}\n"
            "parameters: {length: length}\nwaves: {hs: hs, tp: 9, seed: seed}")  # fmt: skip
    matrix = read(text, check=True, progress=lambda done, of: shown.append((done, of)))
    assert len(matrix.cases) == 60 and shown == [(k, 6) for k in range(1, 7)]
    assert len((tmp_path / "built").read_text()) == 6 + 1  # and once for the files it reads


# -- listing and templates -------------------------------------------------------------------------


def test_list(read, tmp_path, capsys):
    read(MANY)
    matrix = list_cases("m.yaml", ["mass=1,2"], 10, "all.csv")
    said = capsys.readouterr().out
    assert "10 of 30 cases, 100 s to simulate" in " ".join(said.split())
    assert "4, 5, 6, 7, 8" in said and matrix.cases[-1].id in said
    rows = (tmp_path / "all.csv").read_text().splitlines()
    assert rows[0] == "number,case_id,mass,length,angle_deg,half" and len(rows) == 11
    with pytest.raises(CaseError, match="cannot be written"):
        list_cases("m.yaml", csv="nowhere/all.csv", check=False)


def test_units_by_name():
    names = {"wind_heading_deg": "deg", "hs": "m", "swell_tp": "s", "current_speed": "m/s", "ti": "1", "seed": ""}
    assert {name: unit_of(name) for name in names} == names


FILLED = {
    "dlc_1_2": 2 * 6, "dlc_1_3": 2 * 2 * 6, "dlc_1_6": 2 * 3 * 2 * 6, "dlc_6_1": 3 * 12 * 3 * 3 * 6,
}  # fmt: skip


@pytest.mark.parametrize("name", templates())
def test_templates(read, tmp_path, name):
    """Refused until filled in; then every DLC has the cases that it says."""
    assert "IEC 61400-3-2" in headline(name)
    problems = refused(read, template(name), "to be filled in: path of your model script")
    assert len(problems) == len(re.findall(r"<.*?>", template(name)))
    (tmp_path / "states.csv").write_text("u,d,h,t,w,p\n8,0,1.2,7,10,0.4\n14,30,3,9,40,0.6\n")
    (tmp_path / "rotor.py").write_text(PENDULUM.replace("waves=None", "waves=None, parked=False, wind=None"))
    text, columns = template(name), iter("udhtwp")
    for what, value in (
        ("<path of your model script[^>]*>", "rotor.py"), ("<CSV[^>]*>", "states.csv"), ("<reference[^>]*>", "0.14"),
        ("<list[^>]*(together|speed|height|period|current|cut-out|speeds)[^>]*>", "[8, 14]"), ("<channels[^>]*>", "{}"),
        ("<what parks[^>]*>", "{parked: true, angle_deg: yaw_error_deg}"), ("<annual[^>]*>", "10"),
        ("<(mean|significant|surface)[^>]*>", "9"),
    ):  # fmt: skip
        text = re.sub(what, value, text)
    text = re.sub("<column[^>]*>", lambda match: next(columns), text)
    began = time.perf_counter()
    assert len(read(text).cases) == FILLED[name]
    assert time.perf_counter() - began < 10.0


def test_no_such_template():
    with pytest.raises(CaseError, match="no template 'dlc_1_7' .did you mean"):
        template("dlc_1_7")


def test_a_case_is_the_files_its_script_names(read, tmp_path):
    """In folders beside it, by names that numbers complete, and what stands in which of two files."""
    text = HEAD + "variables: {mass: [1, 2]}\nparameters: {mass: mass}\n"
    (tmp_path / "data").mkdir()
    names = ("data/a.csv", "data/b.csv", "table_10.csv", "table_20.csv")
    named = "Path(__file__).parent / 'data' / 'a.csv', 'data/b.csv', lambda x: f'table_{x:g}.csv'"
    (tmp_path / "model.py").write_text("from pathlib import Path\n" + PENDULUM + "NAMES = " + named + "\n")
    for name in names:
        (tmp_path / name).write_text("1\n2\n")
    ids = {read(text).cases[0].id}
    for name in names:
        (tmp_path / name).write_text("1\n")
        ids.add(read(text).cases[0].id)
    for name, row in (("data/a.csv", "0\n"), ("data/b.csv", "")):
        (tmp_path / name).write_text("1\n" + row)
        ids.add(read(text).cases[0].id)
    (tmp_path / "data/a.csv").write_text("1\n")  # the row goes from the end of one to the beginning of the next
    (tmp_path / "data/b.csv").write_text("0\n1\n")
    ids.add(read(text).cases[0].id)
    assert len(ids) == 7
    (tmp_path / "table.csv").write_text("no part of it")
    assert read(text).cases[0].id in ids


def test_numbers_that_choose_a_database_are_refused(read, tmp_path):
    """The source is looked for once for all numbers: results for the second file would outlive a change of it."""
    folder = Path(__file__).parents[2] / "models"
    script = f"""
from pathlib import Path
import floatsim as fs
def build(depth):
    name = "sphere_kramer_hydro.nc" if depth < 50 else "sphere_oes_hydro.nc"
    hydro = fs.PotentialFlow(database=Path({str(folder)!r}) / name)
    body = fs.Body(name="sphere", mass=7.056, inertia=(0.1, 0.1, 0.1), hydro=hydro)
    return fs.Model(name="sphere", parts=[body], sea=fs.Sea(depth=depth))
"""
    (tmp_path / "model.py").write_text(script)
    text = HEAD + "variables: {depth: [30, 300]}\nparameters: {depth: depth}\n"
    assert len(set(read(text).files.values())) == 1
    refused(read, text, "reads", "sphere_oes_hydro.nc' for these numbers and another file for others", check=True)


def test_exponents_are_checked_before_a_run(read):
    text = HEAD.replace("ramp: 0", "ramp: 0, channels: [rod_position], fatigue: {rod_position: 30}")
    refused(read, text + "variables: {mass: 1}", "fatigue: 'rod_position': got 30", "from 1 to 20", check=True)


def test_modules_of_other_folders_are_part_of_a_case(tmp_path, monkeypatch):
    """A script of one's own that takes a model from elsewhere: when that changes, so does the case."""
    monkeypatch.setattr(sys, "path", list(sys.path))
    (tmp_path / "models").mkdir()
    (tmp_path / "study").mkdir()
    shared = tmp_path / "models" / "shared_pendulum_model.py"
    shared.write_text("LENGTH = 1.0\n" + PENDULUM)
    (tmp_path / "study" / "own.py").write_text(
        f"import sys\nsys.path.insert(0, {str(shared.parent)!r})\nfrom shared_pendulum_model import build\n"
    )
    (tmp_path / "study" / "m.yaml").write_text(
        "model: own.py\nvariables: {seed: {seeds: 1}}\nrun: {duration: 2, ramp: 0}\n"
    )
    before = read_matrix(tmp_path / "study" / "m.yaml", check=False).cases[0].id
    shared.write_text("LENGTH = 2.0\n" + PENDULUM)
    assert read_matrix(tmp_path / "study" / "m.yaml", check=False).cases[0].id != before


def test_fatigue_of_a_channel_that_is_not_kept(tmp_path):
    (tmp_path / "model.py").write_text(PENDULUM)
    (tmp_path / "m.yaml").write_text(
        "model: model.py\nvariables: {seed: {seeds: 1}}\n"
        "run: {duration: 2, ramp: 0, channels: [newton_iterations], fatigue: {wave_elevation: 3}}\n"
    )
    with pytest.raises(CaseError, match="run: channels: there is no 'wave_elevation'"):
        read_matrix(tmp_path / "m.yaml")
