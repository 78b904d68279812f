"""The report of a matrix: what it says, what it leaves out, what it refuses."""

from __future__ import annotations

import json
import math
import re
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import summaries
from shipped import MODELS, load

from floatsim.cases.outline import outlines, plan_outline
from floatsim.cases.report import page, report
from floatsim.cases.report_data import Summary, number, plain_number, scaled
from floatsim.cases.svg import Drawing, limits, tick_texts, ticks
from floatsim.errors import CaseError

LOST = {5: ("diverged", "largest residual in mooring_2"), 6: ("diverged", "step 1300"), 40: ("timed out", "3600 s")}
VOID = {"meta", "link", "input"}
OPEN_ENDED = {"tr", "td", "th", "thead", "tbody"}  # their ends may be left out


class Reader(HTMLParser):
    """What is in a page: tags with their attributes, text by element, and whether everything is closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.stack: list[str] = []
        self.texts: dict[str, list[str]] = {}
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: Any) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID | OPEN_ENDED:
            self.stack.append(tag)

    def handle_startendtag(self, tag: str, attrs: Any) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        if tag not in OPEN_ENDED:
            assert self.stack and self.stack[-1] == tag, f"</{tag}> closes {self.stack[-1:]}"
            self.stack.pop()

    def handle_data(self, data: str) -> None:
        if self.stack and data.strip():
            self.texts.setdefault(self.stack[-1], []).append(data.strip())

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.tags if name == tag]


def sections(text: str) -> list[str]:
    return re.findall(r'<section id="(\w+)">', text)


def test_page_is_whole_and_needs_nothing_else() -> None:
    text = page(Summary(summaries.screening(LOST)))
    read = Reader(text)
    assert not read.stack  # every element is closed
    assert not re.search(r"https?:|@import|url\(|\ssrc=|file:", text)
    assert [link["href"] for link in read.all("link")] == ["data:,"]
    assert len(read.all("script")) == 1
    ids = [a["id"] for _, a in read.tags if "id" in a]
    assert len(ids) == len(set(ids))
    links = {str(a["href"])[1:] for a in read.all("a")}
    assert links <= set(ids)
    assert len(read.all("svg")) > 20
    drawings = [a for a in read.all("svg") if "role" in a]
    assert all(a["role"] == "img" and a["aria-label"] for a in drawings)
    assert "width=device-width" in text
    assert [a for a in read.all("div") if a.get("id") == "filter"][0].keys() >= {"hidden"}  # no use without the script


def test_sections_are_those_with_data() -> None:
    assert sections(page(Summary(summaries.screening(LOST)))) == [
        "matrix", "plan", "drivers", "motions", "lines", "rotor", "failed", "time", "cases",
    ]  # fmt: skip
    converter = page(Summary(summaries.converter()))
    assert sections(converter) == ["matrix", "drivers", "motions", "pto", "fatigue", "channels", "time", "cases"]
    assert sections(page(Summary(summaries.decay()))) == ["matrix", "single", "drivers", "failed", "time", "cases"]
    assert "nan" not in re.sub(r"<script>.*</script>", "", converter, flags=re.DOTALL).lower().replace("finance", "")


def test_one_case_and_no_case_done() -> None:
    v = {"wind_speed": np.array([12.0])}
    one = page(Summary(summaries.platform(v)))
    assert sections(one) == ["matrix", "plan", "lines", "time", "cases"]  # nothing varies
    none = page(Summary(summaries.platform(v, {0: ("raised", "no such file")})))
    assert sections(none) == ["matrix", "failed", "time", "cases"]
    assert Reader(one) and "no such file" in none


def test_what_the_user_wrote_is_text() -> None:
    evil = '<script>alert("x")</script><img src=y onerror=z>'
    v = {"soil": np.array([evil, "clay", "sand"]), "hs": np.array([1.0, 2.0, 3.0])}
    data = summaries.platform(v, {2: (evil, evil)}, moorings=1, cables=0, name=evil, matrix_file=evil)
    data = data.rename({n: str(n).replace("rotor", "r<u>") for n in data.data_vars if "rotor" in str(n)})
    data["case_id"] = "case", np.array([f'{evil}"\'&{k}' for k in range(3)])
    text = page(Summary(data))
    read = Reader(text)
    assert not read.all("img") and not read.all("u") and len(read.all("script")) == 1
    assert not [a for _, a in read.tags if any(str(key).startswith("on") for key in a)]
    assert "&lt;script&gt;alert(" in text and not read.stack


def test_counts_failures_and_run_time() -> None:
    data = summaries.screening(LOST)
    data["wall_time"] = "case", np.full(162, 100.0)
    s = Summary(data)
    assert dict(s.counts) == {"done": 159, "failed": 3}
    assert s.failures == [("diverged", [5, 6]), ("timed out", [40])]
    text = page(s)
    assert "largest residual in mooring_2" in text
    cost = {what: value for what, value, _ in s.cost}
    assert cost["total"] == "4.5"  # 162 x 100 s = 4.5 h
    assert cost["speed"] == "8"  # 800 s of simulated time in 100 s
    assert cost["steps"] == "70"  # 7000 steps in 100 s


def test_cases_that_have_not_run() -> None:
    data = summaries.screening()
    data["status"].values[10:] = "miss"  # as long as done: the array's texts have a fixed length
    for name in data.data_vars:
        data[name].values[10:] = np.nan
    s = Summary(data)
    assert s.counts == [("miss", 152), ("done", 10)] and s.failures == []
    assert "152 miss, 10 done" in page(s)
    assert np.isfinite(s.results[0].values).sum() == 10


def test_variables_that_go_together_and_those_that_follow() -> None:
    s = Summary(summaries.operational(1))
    axes = {v.name: v.also for v in s.axes}
    assert axes["wind_speed"] == ["hs", "tp"] and "hs" not in axes
    assert "wave_heading_deg" in axes
    free = ["wind_speed", "wind_heading_deg", "misalignment_deg", "current_speed", "current_heading_deg"]
    assert [v.name for v in Summary(summaries.operational(2)).free] == [*free, "seed"]
    screening = Summary(summaries.screening())
    assert {v.name: v.also for v in screening.axes}["wind_heading_deg"] == ["study_wind_heading_deg"]


def test_variables_with_many_values_are_binned() -> None:
    n = 400
    u = np.linspace(3.0, 25.0, n) ** 1.5
    s = Summary(summaries.platform({"wind_speed": u, "soil": np.array(["sand", "clay"] * 200)}))
    wind, soil = s.variables
    assert wind.binned and wind.distinct == n and len(wind.x) == 12
    assert np.bincount(wind.codes).tolist() == pytest.approx([n / 12] * 12, abs=1.0)
    for k, x in enumerate(wind.x):
        assert x == pytest.approx(u[wind.codes == k].mean())
    assert soil.texts == ["sand", "clay"] and soil.codes[:3].tolist() == [0, 1, 0]
    assert Reader(page(s)).stack == []


def test_variables_of_any_kind() -> None:
    """Numbers that are missing in some cases, truth values, names that the report uses itself."""
    v = {"hs": np.array([1.0, np.nan, 2.0, np.nan]), "moored": np.array([True, False, True, False]),
         "model": np.array(["a", "b", "a", "c"])}  # fmt: skip
    data = summaries.platform({k: x for k, x in v.items() if k != "hs"} | {"wind_speed": np.full(4, 9.0)})
    data = data.assign_coords(hs=("case", v["hs"]))
    data.attrs["variables"] = json.dumps([*v])
    s = Summary(data)
    assert [(x.name, x.range) for x in s.variables] == [
        ("hs", "1, 2, none"), ("moored", "True, False"), ("model", "a, b, c")]  # fmt: skip
    text = page(s)
    assert Reader(text).stack == [] and "nan" not in text.partition("<script>")[0].lower()


def test_share_by_hand() -> None:
    """0, 2 and 4, 6: 16 of the sum of squares 20 between the two, epsilon^2 = 1 - 0.2 x 3/2 = 0.7."""
    v = {"a": np.array([1, 1, 2, 2]), "b": np.array([1, 2, 1, 2])}
    s = Summary(summaries.dataset(v, {"x_mean": (("case",), [0.0, 2.0, 4.0, 6.0], "m")}))
    shares = s.shares(np.array([0.0, 2.0, 4.0, 6.0]))
    assert shares[0] == pytest.approx(0.7, abs=1e-12)
    assert shares[1] == 0.0  # 4 of 20: less than chance
    both = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]])  # 1 of 2 each: 1 - 0.5 x 3/2
    assert s.shares(both) == pytest.approx([0.25, 0.25], abs=1e-12)


def test_share_of_noise_is_small() -> None:
    r = np.random.default_rng(7)
    s = Summary(summaries.dataset(summaries.product(a=list(range(10)), b=list(range(6))),
                                  {"x_mean": (("case",), np.zeros(60), "m")}))  # fmt: skip
    found = np.array([s.shares(r.normal(size=60)) for _ in range(200)])
    assert found.mean(axis=0) == pytest.approx([0.0, 0.0], abs=0.05)  # without the correction (k - 1)/(n - 1) = 0.15


def test_positions_follow_the_wind_first_then_the_current() -> None:
    """What the made-up platform is made to do."""
    s = Summary(summaries.operational())
    [shares] = [row for name, row in s.drivers if name.startswith("mean position")]
    share = dict(zip([v.name for v in s.axes], shares))
    assert share["wind_heading_deg"] > 0.8
    assert share["wind_heading_deg"] > share["current_heading_deg"] > share["current_speed"]
    assert share["seed"] < 0.01 and share["misalignment_deg"] < 0.01


def test_distances_of_mean_positions() -> None:
    """Wind heading moves by 10 m, the cable angle by 0.3 m, and only in one of the two headings."""
    v = summaries.product(wind_heading_deg=[0, 90], cable_angle_deg=[0, 45])
    data = summaries.platform(v)
    xy = np.array([[10.0, 0.0], [10.0, 0.0], [0.0, 0.0], [0.3, 0.0]])
    data["platform_position_mean"].values[:, :2] = xy
    s = Summary(data)
    wind, cable = s.axes
    assert s.apart("platform", wind) == pytest.approx((9.85, 10.0))
    assert s.apart("platform", cable) == pytest.approx((0.15, 0.3))


def test_failed_cases_do_not_shift_the_means_that_are_compared() -> None:
    """One of six cable angles failed at one heading: without that heading in all, the means would differ by metres."""
    s = Summary(summaries.screening({0: ("killed", "")}))
    cable = next(v for v in s.axes if v.name == "study_cable_angle_deg")
    assert s.comparable("platform", cable).sum() == 162 - 6  # one seed at one heading
    between, alone = s.apart("platform", cable)
    assert alone is not None and between < 0.2 and alone < 0.8  # noise of 0.1 m per coordinate


def test_ellipse_of_a_covariance() -> None:
    """Semi-axes 2 and 1 m, turned 30 degrees counter-clockwise: clockwise is positive in SVG, whose y points down."""
    turn = math.radians(30.0)
    R = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    d = Drawing((-5.0, 5.0), (-5.0, 5.0), width=300, height=300, equal=True)
    d.ellipse((1.0, 2.0), R @ np.diag([4.0, 1.0]) @ R.T, "#123456")
    found = re.search(r'rx="([\d.]+)" ry="([\d.]+)".*rotate\((-?[\d.]+)\)', d.inside[0])
    assert found
    assert float(found[1]) == pytest.approx(2.0 * d.scale, abs=0.06)
    assert float(found[2]) == pytest.approx(1.0 * d.scale, abs=0.06)
    assert float(found[3]) % 180.0 == pytest.approx(150.0)
    assert d.u(1.0) - d.u(0.0) == pytest.approx(d.v(0.0) - d.v(1.0))  # one scale


def test_ellipses_of_the_page_are_those_of_the_covariance() -> None:
    data = summaries.platform(summaries.product(wind_heading_deg=[45], seed=[1, 2]))
    C = Summary(data).covariance("platform")
    assert C is not None
    values, vectors = np.linalg.eigh(C[0])
    assert abs(vectors[:, 1]) == pytest.approx([math.sqrt(0.5)] * 2)  # along the wind, at 45 degrees
    assert np.sqrt(values) == pytest.approx([0.12 * 4.0 + 0.3, 0.35 * 4.0 + 0.4])
    assert vectors[0, 1] * vectors[1, 1] > 0.0


def test_offset_is_a_bound_unless_it_is_known() -> None:
    data = summaries.platform({"wind_speed": np.array([10.0, 12.0])})
    data["platform_position_min"].values[:, :2] = [[-3.0, -1.0], [0.0, -12.0]]
    data["platform_position_max"].values[:, :2] = [[2.0, 4.0], [5.0, 1.0]]
    _, _, high, what = Summary(data).offset("platform")
    assert high == pytest.approx([5.0, 13.0]) and "bound" in what
    for kind, values in (("min", [0.5, 1.0]), ("mean", [2.0, 7.0]), ("max", [4.5, 12.5])):
        data[f"platform_offset_{kind}"] = "case", values
    low, mean, high, what = Summary(data).offset("platform")
    assert [*low, *mean, *high] == pytest.approx([0.5, 1.0, 2.0, 7.0, 4.5, 12.5]) and what == "largest"
    assert not [n for n in Summary(data).scalars if "offset" in n]


def test_worst_cases_say_where() -> None:
    data = summaries.screening()
    data["cable_2_curvature_utilisation_max"].values[17, 11] = 1.25
    data["mooring_1_tension_utilisation_max"].values[99, 3] = 0.95
    s = Summary(data)
    [tension] = s.worst(s.families["mooring"])
    assert tension[:2] == ("tension utilisation", "%")
    k, value, line, arc = tension[2][0]
    assert (k, line) == (99, "mooring_1") and value == pytest.approx(95.0)
    assert arc == pytest.approx(3.5 * 821.0 / 30)
    _, curvature = s.worst(s.families["cable"])
    k, value, line, arc = curvature[2][0]
    assert (k, line) == (17, "cable_2") and value == pytest.approx(125.0) and arc == pytest.approx(11 * 226.0 / 30)
    values = [row[1] for row in curvature[2]]
    assert values == sorted(values, reverse=True) and len(values) == 5
    assert any(value == "125" and k == 17 for _, value, _, k in s.headlines)


def test_limits_without_utilisation() -> None:
    """Tension in kN and curvature are ranked where no limits are given; chains that do not resist bending are not."""
    data = summaries.screening()
    s = Summary(data.drop_vars([n for n in data.data_vars if "utilisation" in str(n)]))
    assert [(what, unit) for what, unit, _ in s.worst(s.families["cable"])] == [
        ("largest tension", "kN"), ("largest curvature", "1/m")]  # fmt: skip
    data["mooring_1_curvature_max"] = ("case", "mooring_1_node"), np.ones((162, 31))
    data["mooring_1_bending_moment_max"] = ("case", "mooring_1_node"), np.zeros((162, 31))
    assert [what for what, _, _ in Summary(data).worst(["mooring_1"])] == ["tension utilisation"]


def test_table_has_every_case_and_reads_back() -> None:
    data = summaries.screening(LOST)
    s = Summary(data)
    heads, rows = s.table
    cells = list(rows)
    assert [k for k, _ in cells] == list(range(162))
    column = [name for name, _ in heads].index("mean offset")
    mean = data["platform_position_mean"].values
    expected = np.hypot(mean[:, 0], mean[:, 1])
    for k, row in cells:
        assert row[column] == "" if k in LOST else float(row[column]) == pytest.approx(expected[k], rel=1e-3)
    assert page(s).count('<tr id="case') == 162


def test_numbers_for_reading() -> None:
    assert [number(x) for x in (0.012345, 1.0, 12.345, 999.4, 12345.6, 0.0, math.nan)] == [
        "0.0123", "1", "12.3", "999", "12\N{NARROW NO-BREAK SPACE}346", "0", "\N{EN DASH}"]  # fmt: skip
    assert number(-3.14159) == "\N{MINUS SIGN}3.14"
    plain = {1234.5678: "1235", -0.0001239: "-0.0001239", 100.0: "100", 2e-7: "2.000e-07"}
    assert {x: plain_number(x) for x in plain} == plain
    assert scaled("rad", 1.0) == (pytest.approx(57.29578), "deg")
    assert scaled("N", [2e3, np.nan]) == (1e-3, "kN") and scaled("W", 2e7) == (1e-6, "MW")
    assert scaled("1", 5.0) == (1.0, "")


def test_ticks_and_limits() -> None:
    assert ticks(0.0, 10.0).tolist() == [0, 2, 4, 6, 8, 10]
    assert ticks(-0.31, 0.29).tolist() == pytest.approx([-0.2, 0.0, 0.2])
    assert tick_texts(ticks(0.0, 0.25)) == ["0", "0.05", "0.10", "0.15", "0.20", "0.25"]
    assert limits([5.0, 5.0]) == pytest.approx((4.44, 5.56))
    assert limits([2.0, 10.0], zero=True)[0] == 0.0 and limits([9.0, 10.0], zero=True)[0] > 8.0
    assert limits([-90.0, 0.0], margin=0.1) == pytest.approx((-99.0, 9.0))  # 0 is a value like others
    assert limits([math.nan]) == (0.0, 1.0)


# -- outlines ---------------------------------------------------------------------------------


def area(loop: np.ndarray) -> float:
    x, y = np.asarray(loop).T
    return 0.5 * abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))))


def body(*loads: Any, points: Any = (), attitude: Any = (0.0, 0.0, 0.0)) -> Any:
    return SimpleNamespace(name="b", water_loads=loads, attitude_deg=attitude, points=dict(points))


def test_outline_of_a_stepped_box() -> None:
    """An open box of 4 x 2 m at z = -1 with a 2 x 2 m well below it: steps do not show in plan."""
    x, v, faces = [-2.0, -1.0, 1.0, 2.0], [], []
    for a, b, z in zip(x, x[1:], (-1.0, -3.0, -1.0)):
        v += [(a, -1.0, z), (a, 1.0, z), (b, 1.0, z), (b, -1.0, z)]
        faces.append([len(v) - 4, len(v) - 3, len(v) - 2, len(v) - 1])  # wound to look down
    for a in (1.0, -1.0):
        v += [(a, -1.0, -3.0), (a, 1.0, -3.0), (a, 1.0, -1.0), (a, -1.0, -1.0)]
        faces.append([len(v) - 4, len(v) - 3, len(v) - 2, len(v) - 1])
    [loop] = plan_outline(body(SimpleNamespace(surface=SimpleNamespace(vertices=np.array(v), faces=np.array(faces)))))
    assert area(loop) == pytest.approx(8.0)
    assert sorted(map(tuple, loop.tolist())) == [(-2.0, -1.0), (-2.0, 1.0), (2.0, -1.0), (2.0, 1.0)]


@pytest.mark.parametrize("ends, expected", [
    (((0.0, 0.0, -5.0), (0.0, 0.0, 5.0)), math.pi * 4.0),  # upright: a circle of 4 m
    (((-5.0, 1.0, 0.0), (5.0, 1.0, 0.0)), 40.0),  # lying: a rectangle
])  # fmt: skip
def test_outline_of_a_cylinder(ends: Any, expected: float) -> None:
    [loop] = plan_outline(body(SimpleNamespace(a=ends[0], b=ends[1], diameter=4.0)))
    assert area(loop) == pytest.approx(expected, rel=0.02)


def test_outline_of_volturnus() -> None:
    """Outer columns of 12.5 m diameter at a radius of 51.75 m (Allen et al. 2020), one of them upwind."""
    found = outlines(load("volturnus_s").build(moorings=False))["platform"]
    [loop] = found["loops"]
    x, y = np.array(loop).T
    assert x.min() == pytest.approx(-51.75 - 6.25, abs=0.1)
    assert y.max() == pytest.approx(51.75 * math.sin(math.radians(60.0)) + 6.25, abs=0.1) == -y.min()
    assert found["points"]["fairlead_1"] == [-58.0, 0.0]


# -- files ------------------------------------------------------------------------------------


def test_report_of_a_folder(tmp_path: Path) -> None:
    summaries.screening(LOST).to_netcdf(tmp_path / "summary.nc")
    made = report(tmp_path)
    assert made == tmp_path / "report.html"
    assert report(tmp_path / "summary.nc", tmp_path / "other.html").read_text() == made.read_text()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["other.html", "report.html", "summary.nc"]
    text = made.read_text(encoding="utf-8")
    assert "screening_82m" in text and 'class="fill"' in text
    data = summaries.screening(LOST)
    assert report(data, tmp_path / "third.html").read_text() == text


def test_outline_from_the_model_of_the_first_case(tmp_path: Path) -> None:
    pytest.importorskip("floatsim.cases.environment")
    data = summaries.screening()
    del data.attrs["outlines"]
    data.to_netcdf(tmp_path / "summary.nc")
    own = {"duration": 10.0, "channels": "all"}
    case: dict[str, Any] = {"number": 0, "slug": "a", "variables": {}, "parameters": {"moorings": False}, "run": own,
                            "environment": {}, "source": "", "model": str(MODELS / "volturnus_s.py")}  # fmt: skip
    (tmp_path / "matrix.json").write_text(json.dumps({"name": "m", "path": "m.yaml", "cases": [case]}))
    assert report(tmp_path).read_text().count('class="fill"') == 1
    case["model"] = "gone.py"
    (tmp_path / "matrix.json").write_text(json.dumps({"name": "m", "path": "m.yaml", "cases": [case]}))
    assert report(tmp_path).read_text().count('class="fill"') == 0


def test_damaged_outlines_are_left_out() -> None:
    data = summaries.screening()
    data.attrs["outlines"] = "{"
    assert "all cases in plan" in page(Summary(data))
    data.attrs["outlines"] = json.dumps({"platform": {"points": {"fairlead_1": [-58.0, 0.0]}}})
    assert 'class="arm"' in page(Summary(data))


def test_what_is_refused(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="there is no .*summary.nc.*collect"):
        report(tmp_path)
    with pytest.raises(CaseError, match="results folder"):
        report(3)  # type: ignore[arg-type]
    (tmp_path / "summary.nc").write_text("no netCDF")
    with pytest.raises(CaseError, match="can be read"):
        report(tmp_path)
    with pytest.raises(CaseError, match="needs the path of a file"):
        report(summaries.decay())
    with pytest.raises(CaseError, match="is a folder"):
        report(summaries.decay(), tmp_path)
    with pytest.raises(CaseError, match="cannot be written"):
        report(summaries.decay(), tmp_path / "nowhere" / "report.html")
    with pytest.raises(CaseError, match="no cases"):
        report(summaries.decay().isel(case=slice(0)), tmp_path / "r.html")
    assert [p.name for p in tmp_path.iterdir()] == ["summary.nc"]


def test_cases_that_were_not_run_are_counted_only(tmp_path):
    data = summaries.screening()
    status = np.array(["done" if k < 12 else "missing" for k in range(data.sizes["case"])], dtype=object)
    text = report(data.assign_coords(status=("case", status)), tmp_path / "page.html").read_text()
    assert "Report of 12 load cases" in text and f"{data.sizes['case'] - 12} of the matrix not run" in text
    assert str(data.case_id.values[11]) in text and str(data.case_id.values[12]) not in text
    with pytest.raises(CaseError, match="no cases that were run"):
        report(data.assign_coords(status=("case", ["missing"] * data.sizes["case"])), tmp_path / "none.html")
