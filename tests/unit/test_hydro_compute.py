"""`floatsim hydro compute`: where floaters are meshed, the pose in the database, warnings, Nemoh folders, refusals."""

from __future__ import annotations

import json
import math
import re
import sys
from dataclasses import replace

import numpy as np
import pytest
from hulls import box, cylinder

import floatsim as fs
from floatsim.cli import main
from floatsim.errors import CaseError, ModelError
from floatsim.frames import matrix_from_angles
from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.hull import _read
from floatsim.hydro.meshing import hydrostatics, mesh_problems, profile, revolve, wetted
from floatsim.hydro.nemoh_project import read_static_position, write_nemoh
from floatsim.hydro.read import read_hydro
from floatsim.study import hydro_compute
from floatsim.study.hydro_compute import compute_model_database, nemoh_folder, steps, wet_bodies
from floatsim.study.sheet import cautions

RHO, G, DEPTH = 1025.0, 9.81, 40.0
RADIUS, LOW, HIGH, SIDES = 4.0, -6.0, 6.0, 36
AREA = 0.5 * SIDES * RADIUS**2 * math.sin(2.0 * math.pi / SIDES)  # of the polygon
MASS, STIFFNESS, FREE = 180e3, 60e3, 25.0
OMEGA = np.array([0.4, 0.8, 1.2])


def buoy(hydro, *, mass=MASS, name="buoy", **body):
    arguments = {"center_of_mass": (0.0, 0.0, -4.0), "points": {"keel": (0.0, 0.0, LOW)}, **body}
    return fs.Body(name=name, mass=mass, inertia=(10.0 * mass, 10.0 * mass, 8.0 * mass), hydro=hydro, **arguments)


def tube(n=SIDES, rings=12):
    return fs.Hull(mesh=cylinder(RADIUS, LOW, HIGH, n, rings))


def moored(body):
    """On a vertical spring from the seabed to the keel."""
    x, y, _ = body.position
    spring = fs.Spring(name="tether", a=(x, y, -DEPTH), b=f"{body.name}.keel", stiffness=STIFFNESS, free_length=FREE)
    return fs.Model(parts=[body, spring], sea=fs.Sea(depth=DEPTH, density=RHO), gravity=G)


def draught(mass=MASS):
    """rho g A T = m g + k (h - T - l0)."""
    return (mass * G + STIFFNESS * (DEPTH - FREE)) / (RHO * G * AREA + STIFFNESS)


def made_up(name, bodies, omega, headings, *, depth, density, gravity, source, report=None, **_):
    """Stands for the solver: coefficients without meaning, hydrostatics and poses of what it is given."""
    whole = [hydrostatics(body.hull, body.reference_point) for body in bodies]
    N, n, m = len(bodies), len(omega), len(headings)
    A = np.eye(6 * N) * density * np.mean([h.volume for h in whole])
    stiffness = np.zeros((6 * N, 6 * N))
    for k, h in enumerate(whole):
        stiffness[6 * k : 6 * k + 6, 6 * k : 6 * k + 6] = density * gravity * h.stiffness
    if report:
        report("1/1 frequencies, 0 s")
    return HydroDatabase(
        name=name, bodies=tuple(body.name for body in bodies), omega=omega, added_mass=np.tile(A, (n, 1, 1)),
        radiation_damping=np.zeros((n, 6 * N, 6 * N)), added_mass_inf=A, headings=headings,
        excitation=np.zeros((n, m, 6 * N), complex), froude_krylov=np.zeros((n, m, 6 * N), complex),
        hydrostatic_stiffness=stiffness, volume=np.array([h.volume for h in whole]),
        centre_of_buoyancy=np.array([h.centre for h in whole]), depth=depth, density=density, gravity=gravity,
        reference_point=np.array([body.reference_point for body in bodies]), source=source,
        hull_vertices=bodies[0].hull.vertices, hull_faces=bodies[0].hull.faces,
    )  # fmt: skip


@pytest.fixture
def solver(monkeypatch):
    monkeypatch.setattr(hydro_compute, "compute_database", made_up)
    monkeypatch.setattr(hydro_compute, "load_capytaine", lambda: None)


# --- where bodies are meshed ----------------------------------------------------------------------


def test_a_moored_cylinder_is_cut_at_its_static_draught(record):
    T = draught()
    (wet,), source, messages = wet_bodies(moored(buoy(tube())), OMEGA)
    (tight,), _, _ = wet_bodies(moored(buoy(tube(), position=(100.0, -20.0, 3.0))), OMEGA)
    assert messages == [] and mesh_problems(wet.hull) == []
    still = hydrostatics(wet.hull, wet.reference_point)
    record("BEM workflow", "moored cylinder: volume of the wetted mesh, relative difference",
           abs(still.volume / (AREA * T) - 1.0), 1e-6)  # fmt: skip
    assert -wet.hull.vertices[:, 2].min() == pytest.approx(T, abs=1e-6)
    assert wet.reference_point[2] == pytest.approx(-LOW - T, abs=1e-6)
    np.testing.assert_allclose(wet.reference_point[:2], 0.0)
    np.testing.assert_allclose(source["static_position"], [0.0, 0.0, -LOW - T], atol=1e-4)
    np.testing.assert_allclose(source["static_attitude_deg"], 0.0, atol=1e-2)
    np.testing.assert_allclose(source["static_draught"], [T], atol=1e-6)
    cover = hydrostatics(wet.lid)  # normals down
    assert wet.lid.vertices[:, 2].min() == wet.lid.vertices[:, 2].max() and -0.5 < wet.lid.vertices[0, 2] < 0.0
    assert cover.waterplane == pytest.approx(AREA, rel=0.05)
    # wherever it is drawn
    np.testing.assert_allclose(tight.reference_point, wet.reference_point, atol=1e-6)
    assert hydrostatics(tight.hull).volume == pytest.approx(still.volume, rel=1e-6)


def test_panels_of_four_corners_stay_whole():
    """As many panels as were given, not the triangles that the hull is cut into."""
    outline = profile([(0.0, LOW), (RADIUS, LOW), (RADIUS, HIGH), (0.0, HIGH)], 1.0)
    mesh = revolve(outline, SIDES)
    for hull in (fs.Hull(mesh=(mesh.vertices, mesh.faces)),
                 fs.Hull(mesh=(mesh.vertices, mesh.faces[:, ::-1]), inside_out=True)):  # fmt: skip
        whole = hydro_compute._panels(hull.surface)
        assert len(whole.faces) == len(mesh.faces) and len(hull.surface.faces) > 1.5 * len(mesh.faces)
        volume = math.pi * RADIUS**2 * -LOW  # `revolve` keeps the areas of circles
        assert hydrostatics(wetted(whole)).volume == pytest.approx(volume)


def test_a_heeled_barge_at_a_heading_of_its_own():
    """Weight off the middle. Righting arm of a wall-sided box: sin(t) (GM + BM tan(t)^2 / 2) = off cos(t)."""
    L, B, H, mass, off = 12.0, 8.0, 4.0, RHO * 12.0 * 8.0 * 2.0, 0.25
    hull = fs.Hull(mesh=box(L, B, H, (12, 8, 4)))
    body = fs.Body(name="barge", mass=mass, inertia=(8 * mass, 14 * mass, 20 * mass), hydro=hull,
                   center_of_mass=(0.0, off, -0.5), attitude_deg=(0.0, 0.0, 40.0), position=(7.0, 3.0, 0.5))
    model = fs.Model(parts=[body], sea=fs.Sea(depth=DEPTH, density=RHO), gravity=G)
    (wet,), source, _ = wet_bodies(model, OMEGA)
    BM = B**2 / 12.0 / 2.0
    GM = BM + (-1.0 - -0.5)  # upright the middle of the box is in the waterline, buoyancy 1 m below it
    t = np.roots([0.5 * BM, 0.0, GM, -off])
    theta = math.degrees(math.atan(float(t[np.abs(t.imag) < 1e-9].real[0])))
    roll, pitch, yaw = source["static_attitude_deg"]
    assert roll == pytest.approx(-theta, abs=1e-3) and pitch == pytest.approx(0.0, abs=1e-3)
    assert yaw == pytest.approx(0.0, abs=0.1)  # from the drawn heading, which the database counts from
    assert source["drawing_heading_deg"] == 40.0
    h = hydrostatics(wet.hull, wet.reference_point)
    assert h.volume == pytest.approx(mass / RHO, rel=1e-7)
    cm = np.array(wet.reference_point) + matrix_from_angles(*np.radians([roll, pitch, yaw])) @ [0.0, off, -0.5]
    np.testing.assert_allclose(h.centre[:2], cm[:2], atol=1e-5)  # buoyancy over weight


def test_a_body_under_water_needs_no_lid_and_one_above_is_refused():
    ball = fs.Hull(mesh=box(2.0, 2.0, 2.0, (4, 4, 4)))

    def held(mass, end, free):
        body = fs.Body(name="ball", mass=mass, inertia=(mass,) * 3, hydro=ball, position=(0.0, 0.0, end[2] + free))
        line = fs.Spring(name="line", a=end, b="ball", stiffness=1e6, free_length=abs(free))
        return fs.Model(parts=[body, line], sea=fs.Sea(depth=DEPTH, density=RHO), gravity=G)

    (wet,), _, _ = wet_bodies(held(2000.0, (0.0, 0.0, -DEPTH), 30.0), OMEGA)
    assert wet.lid is None and hydrostatics(wet.hull).volume == pytest.approx(8.0)
    with pytest.raises(ModelError, match="'ball' hangs above the water"):
        wet_bodies(held(2000.0, (0.0, 0.0, 20.0), -10.0), OMEGA)


def test_coarse_panels_are_told_and_hopeless_ones_refused():
    """Deep water: 2 pi g / w^2 is 15.4 m at 2 rad/s; the sides of a prism with 12 are 2.07 m, its rings 4 m."""
    body = buoy(tube(12, 3))
    (line,) = wet_bodies(moored(body), np.array([0.5, 2.0])).messages
    assert "body 'buoy'" in line and "15.4 m" in line and "2.57 m" in line
    limit = float(re.search(r"end omega at (\S+) rad/s", line)[1])
    assert wet_bodies(moored(body), np.array([0.5, 0.999 * limit])).messages == []
    with pytest.raises(ModelError, match="panels up to"):
        wet_bodies(moored(body), np.array([0.5, 4.0]))


# --- the pose in the database ---------------------------------------------------------------------


def test_a_database_carries_its_pose_through_the_file(solver, tmp_path):
    lines = []
    db = compute_model_database(moored(buoy(tube())), OMEGA, [270.0, 0.0, 90.0], report=lines.append)
    db.write(tmp_path / "buoy.nc")
    for one in (db, HydroDatabase.read(tmp_path / "buoy.nc")):
        assert one.bodies == ("buoy",) and one.reference_point[0, 2] == pytest.approx(-LOW - draught(), abs=1e-6)
        np.testing.assert_allclose(np.degrees(one.headings), [-90.0, 0.0, 90.0])
        np.testing.assert_allclose(one.static_attitude_deg, [[0.0, 0.0, 0.0]], atol=1e-2)
        np.testing.assert_allclose(one.source["static_position"], [0.0, 0.0, -LOW - draught()], atol=1e-4)
    assert lines == ["1/1 frequencies, 0 s"]
    assert replace(db, source={}).static_attitude_deg is None


def test_a_body_with_a_hull_may_be_drawn_anywhere_and_one_without_may_not(solver):
    db = compute_model_database(moored(buoy(tube())), OMEGA)
    flow = fs.PotentialFlow(database=db, hull=tube())
    for height in (0.0, 2.5):
        system = fs.assemble(moored(buoy(flow, position=(0.0, 0.0, height))))
        state, _ = fs.solve_static(system)
        assert state.x[0, 2] == pytest.approx(-LOW - draught(), abs=1e-6)
        assert not [line for line in cautions(system) if "draught" in line]
    with pytest.raises(ModelError, match="let its hull find it"):
        fs.assemble(moored(buoy(fs.PotentialFlow(database=db))))
    unknown = fs.PotentialFlow(database=replace(db, source={}), hull=tube())
    with pytest.raises(ModelError, match="reference point"):
        fs.assemble(moored(buoy(unknown)))


def test_a_present_database_of_another_site_is_told_apart(solver):
    db = replace(compute_model_database(moored(buoy(tube())), OMEGA), depth=90.0)
    with pytest.raises(ModelError) as refused:
        compute_model_database(moored(buoy(fs.PotentialFlow(database=db, hull=tube()))), OMEGA)
    assert "water depth is 90 m" in refused.value.problems[0] and "Hull alone" in refused.value.problems[-1]


def test_a_run_at_another_draught_warns_with_both_figures(solver):
    db = compute_model_database(moored(buoy(tube())), OMEGA)
    flow = fs.PotentialFlow(database=db, hull=tube())

    def said(mass):
        return [line for line in cautions(fs.assemble(moored(buoy(flow, mass=mass)))) if "draught" in line]

    heavier = MASS + 0.03 * draught() * (RHO * G * AREA + STIFFNESS) / G  # 3 % deeper
    (line,) = said(heavier)
    figures = [float(y) for y in re.findall(r"draught of (\S+) m", line)]
    np.testing.assert_allclose(figures, [draught(heavier), draught()], rtol=1e-3)
    assert "'buoy'" in line and "floatsim hydro compute" in line
    assert said(MASS + (heavier - MASS) / 2.0) == []  # 1.5 %


def test_a_run_at_another_trim_warns(solver):
    db = compute_model_database(moored(buoy(tube())), OMEGA)
    flow = fs.PotentialFlow(database=db, hull=tube())
    lines = cautions(fs.assemble(moored(buoy(flow, center_of_mass=(0.3, 0.0, -4.0)))))
    (line,) = [line for line in lines if "draught" in line]
    now, then = (float(y) for y in re.findall(r"pitch (\S+) deg", line))
    assert now > 1.0 and then == pytest.approx(0.0, abs=1e-2)


def test_a_linear_floater_drawn_at_another_draught_warns_with_both_figures(solver):
    db = replace(compute_model_database(moored(buoy(tube())), OMEGA), source={})
    body = buoy(fs.PotentialFlow(database=db), mass=1.2 * MASS, position=(0.0, 0.0, -LOW - draught()))
    (line,) = [line for line in cautions(fs.assemble(moored(body))) if "drawn" in line]
    heave = 0.2 * MASS * G / (RHO * G * AREA)  # with the spring where it is
    assert f"at a draught of {draught() + heave:.4g} m instead of {draught():.4g} m" in line


def test_two_bodies_in_the_layout_in_which_they_float(solver):
    """Two buoys that a spring pulls together: drawn 30 m apart they float nearer, which the database knows."""

    def pair(hydro, names=("one", "two"), apart=30.0):
        bodies = [buoy(hydro(name), name=name, position=(x, 0.0, 0.0)) for name, x in zip(names, (-15.0, apart - 15.0))]
        springs = [
            fs.Spring(name=f"{b.name}_line", a=(b.position[0], 0.0, -DEPTH), b=f"{b.name}.keel", stiffness=STIFFNESS,
                      free_length=FREE) for b in bodies
        ]  # fmt: skip
        springs.append(fs.Spring(name="rope", a="one", b="two", stiffness=2e4, free_length=20.0))
        return fs.Model(parts=[*bodies, *springs], sea=fs.Sea(depth=DEPTH, density=RHO), gravity=G)

    db = compute_model_database(pair(lambda name: tube()), OMEGA)
    distance = db.reference_point[1] - db.reference_point[0]
    assert db.bodies == ("one", "two") and 15.0 < distance[0] < 29.0 and abs(distance[1]) < 1e-3
    tilt = db.static_attitude_deg[:, 1]
    assert abs(tilt[0]) > 0.5 and tilt[0] == pytest.approx(-tilt[1], abs=1e-3)

    def flow(name):
        return fs.PotentialFlow(database=db, body=name, hull=tube())

    assert not [line for line in cautions(fs.assemble(pair(flow))) if "floats" in line]
    lines = cautions(fs.assemble(pair(flow, apart=34.0)))
    assert any("'two' floats" in line and "another layout" in line for line in lines)
    # computed anew, names of the database stay; one alone leaves the other out and says so
    assert compute_model_database(pair(flow), OMEGA).bodies == ("one", "two")
    alone = wet_bodies(pair(flow), OMEGA, ["two"])
    assert [body.name for body in alone.bodies] == ["two"] and "'one' is not among those computed" in alone.messages[0]


@pytest.mark.parametrize(("change", "words"), [
    ({"omega": [1.0]}, "omega must be at least two"),
    ({"omega": [0.0, 1.0]}, "omega must be at least two"),
    ({"headings_deg": [0.0, 360.0]}, "the same direction twice"),
    ({"headings_deg": [math.nan]}, "finite angle"),
    ({"bodies": ["bouy"]}, "did you mean 'buoy'"),
    ({"model": moored(buoy(None))}, "no body with a Hull"),
    ({"model": moored(buoy(None)), "bodies": ["buoy"]}, "body 'buoy' has no Hull"),
])  # fmt: skip
def test_refusals(solver, change, words):
    arguments = {"model": moored(buoy(tube())), "omega": OMEGA, "headings_deg": [0.0]} | change
    with pytest.raises(ModelError, match=words):
        compute_model_database(**arguments)


# --- Nemoh ------------------------------------------------------------------------------------------


def numbers(line):
    return [float(word) for word in line.split("!")[0].split()]


def test_a_nemoh_folder_says_what_the_model_is(tmp_path):
    """Line by line as the manual of Nemoh 3.0 orders them; the mesh read back by the reader of Nemoh meshes."""
    model = moored(buoy(tube()))
    (wet,), source, _ = wet_bodies(model, OMEGA)
    nemoh_folder(model, tmp_path / "run", OMEGA, np.arange(0.0, 360.0, 45.0))
    lines = (tmp_path / "run" / "Nemoh.cal").read_text().splitlines()
    assert [numbers(line)[0] for line in lines[1:4]] == [RHO, G, DEPTH] and numbers(lines[4]) == [0.0, 0.0]
    assert numbers(lines[6]) == [1.0] and lines[8].split()[0] == "buoy.dat"
    corners, panels = numbers(lines[9])
    z = pytest.approx(wet.reference_point[2], abs=1e-6)
    for first in (10, 17):  # motions, forces
        assert numbers(lines[first]) == [6.0]
        for i in range(6):
            kind, *axis = numbers(lines[first + 1 + i])
            assert kind == 1 + i // 3 and axis[:3] == list(np.eye(3)[i % 3])
            assert axis[5] == (0.0 if i < 3 else z)
    assert numbers(lines[24]) == [0.0]
    assert numbers(lines[26]) == [1.0, 3.0, 0.4, 1.2] and numbers(lines[27]) == [8.0, 0.0, 315.0]
    assert numbers(lines[29])[0] == 1.0  # impulse response: A at infinity
    assert [numbers(line)[0] for line in lines[30:35]] == [0.0, 0.0, 0.0, 0.0, 1.0]
    assert lines[35].startswith("---") and numbers(lines[36]) == [0.0]
    text = (tmp_path / "run" / "buoy.dat").read_text().splitlines()
    assert text[0] == "2 0" and numbers(text[int(corners) + 1]) == [0.0] * 4
    assert len(text) == 1 + corners + 1 + panels + 1 and numbers(text[-1]) == [0.0] * 4
    surface = _read(tmp_path / "run" / "buoy.dat")
    a, b, c = surface.corners.swapaxes(0, 1)
    up = 0.5 * np.cross(b - a, c - a)[:, 2]
    flat = np.all(surface.corners[:, :, 2] == 0.0, axis=1)
    assert -up[flat].sum() == pytest.approx(hydrostatics(wet.lid).waterplane, rel=1e-6)
    volume = float(up[~flat] @ surface.corners[~flat, :, 2].mean(axis=1))
    assert volume == pytest.approx(AREA * draught(), rel=1e-5)
    assert (tmp_path / "run" / "results").is_dir()
    known = read_static_position(tmp_path / "run")
    assert known["static_draught"] == source["static_draught"] and known == json.loads(json.dumps(known))
    assert read_static_position(tmp_path) == {}


def test_hydrostatics_for_nemoh(tmp_path):
    nemoh_folder(moored(buoy(tube())), tmp_path / "run", OMEGA)
    text = (tmp_path / "run" / "mesh" / "Hydrostatics.dat").read_text()
    assert float(re.search(r"Displacement = (\S+)", text)[1]) == pytest.approx(AREA * draught(), rel=1e-6)
    assert float(re.search(r"ZF = (\S+) - ZG", text)[1]) == pytest.approx(-0.5 * draught(), rel=1e-6)
    KH = np.loadtxt(tmp_path / "run" / "mesh" / "KH.dat")
    assert KH.shape == (6, 6) and KH[2, 2] == pytest.approx(RHO * G * AREA, rel=1e-6)


def tec(width, blocks, rows):
    """A result file of Nemoh: titles of the columns, then a zone per block."""
    lines = ['VARIABLES="w (rad/s)"', *['"a" "b"'] * (width // 2)]
    for block in range(blocks):
        lines += [f'Zone t="{block + 1}",I= {len(rows)},F=POINT', *(" ".join(f"{y:.7E}" for y in row) for row in rows)]
    return "\n".join(lines) + "\n"


def test_what_nemoh_makes_of_the_folder_has_the_pose(tmp_path):
    """Results of a run that found nothing (zeros) read back: names, reference point, hydrostatics and pose are ours."""
    (wet,), source, _ = wet_bodies(moored(buoy(tube())), OMEGA)
    headings = np.arange(0.0, 360.0, 45.0)
    nemoh_folder(moored(buoy(tube())), tmp_path / "run", OMEGA, headings)
    results = tmp_path / "run" / "results"
    zeros = [[w, *[0.0] * 12] for w in OMEGA]
    (results / "RadiationCoefficients.tec").write_text(tec(12, 6, zeros))
    (results / "IRF.tec").write_text(tec(12, 6, [[0.1 * k, *[0.0] * 12] for k in range(3)]))
    for name in ("ExcitationForce.tec", "FKForce.tec"):
        (results / name).write_text(tec(12, headings.size, zeros))
    db = read_hydro(tmp_path / "run")
    still = hydrostatics(wet.hull, wet.reference_point)
    assert db.bodies == ("buoy",) and db.depth == DEPTH and db.density == RHO
    np.testing.assert_allclose(db.reference_point, [wet.reference_point], atol=1e-6)
    np.testing.assert_allclose(np.degrees(db.headings), np.arange(-180.0, 180.0, 45.0))
    np.testing.assert_allclose(db.omega, OMEGA)
    assert db.volume == pytest.approx([still.volume])
    scale = np.abs(still.stiffness).max()
    np.testing.assert_allclose(db.hydrostatic_stiffness / (RHO * G), still.stiffness, atol=1e-6 * scale)
    np.testing.assert_allclose(db.static_attitude_deg, [source["static_attitude_deg"]])
    flow = fs.PotentialFlow(database=db, hull=tube())
    fs.assemble(moored(buoy(flow)))  # drawn elsewhere


def test_what_nemoh_cannot_be_told(tmp_path):
    model = moored(buoy(tube()))
    with pytest.raises(ModelError, match="evenly spaced"):
        nemoh_folder(model, tmp_path / "run", [0.4, 0.5, 0.9])
    assert not (tmp_path / "run").exists()
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "file").write_text("")
    with pytest.raises(CaseError, match="not empty"):
        nemoh_folder(model, tmp_path / "full", OMEGA)
    with pytest.raises(CaseError, match="there is no folder"):
        nemoh_folder(model, tmp_path / "no" / "run", OMEGA)
    (wet,), _, _ = wet_bodies(model, OMEGA)
    holed = wet._replace(hull=wet.hull._replace(faces=wet.hull.faces[1:]))
    with pytest.raises(ModelError, match="mesh of 'buoy'"):
        write_nemoh(tmp_path / "run", [holed], OMEGA, np.zeros(1), depth=DEPTH, density=RHO, gravity=G)


# --- the command ------------------------------------------------------------------------------------

SCRIPT = """
from pathlib import Path
import sys
sys.path.insert(0, {tests!r})
import floatsim as fs
from hulls import cylinder

def build(mass=180e3, hull=True):
    hydro = fs.Hull(mesh=cylinder(4.0, -6.0, 6.0, 36, 12)) if hull else None
    if hull and Path("buoy.nc").exists():
        hydro = fs.PotentialFlow(database="buoy.nc", hull=hydro)
    body = fs.Body(name="buoy", mass=mass, inertia=(1.8e6, 1.8e6, 1.4e6), center_of_mass=(0, 0, -4.0), hydro=hydro,
                   points=dict(keel=(0, 0, -6.0)))
    tether = fs.Spring(name="tether", a=(0, 0, -40.0), b="buoy.keel", stiffness=60e3, free_length=25.0)
    return fs.Model(parts=[body, tether], sea=fs.Sea(depth=40.0))
"""


@pytest.fixture
def command(capsys, monkeypatch, tmp_path):
    from pathlib import Path

    monkeypatch.chdir(tmp_path)
    (tmp_path / "buoy.py").write_text(SCRIPT.format(tests=str(Path(__file__).parents[1])))

    def call(*arguments):
        monkeypatch.setattr(sys, "argv", ["floatsim", "hydro", "compute", "buoy.py", *map(str, arguments)])
        with pytest.raises(SystemExit) as left:
            main()
        said = capsys.readouterr()
        assert "Traceback" not in said.err
        return left.value.code or 0, said.out, said.err

    return call


def test_command_computes_and_a_second_time_replaces(command, solver, tmp_path, monkeypatch):
    monkeypatch.setattr("floatsim.hydro.compute.check_database", lambda db: ())
    status, out, err = command("-o", "buoy.nc", "--omega", "0.2:1:0.2", "--headings", "0:315:45")
    assert status == 0, err
    assert "static_draught" in out and "buoy.nc" in out and "1/1 frequencies" in err
    db = HydroDatabase.read(tmp_path / "buoy.nc")
    assert db.omega.size == 5 and db.headings.size == 8
    status, out, err = command("-o", "buoy.nc", "--omega", "0.2:1:0.2", "-p", "mass=200e3")
    assert status == 0, err
    again = HydroDatabase.read(tmp_path / "buoy.nc")
    assert again.source["static_draught"] == pytest.approx(draught(200e3), rel=1e-5)


def test_command_writes_a_nemoh_folder_without_capytaine(command, monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "capytaine", None)
    status, out, err = command("--nemoh", "run", "--omega", "0.2:1:0.2")
    assert status == 0 and "run" in out and (tmp_path / "run" / "Nemoh.cal").is_file(), err


@pytest.mark.parametrize(("arguments", "words"), [
    ([], ["-o FILE.nc", "--nemoh"]),
    (["-o", "a.nc", "--nemoh", "run"], ["either"]),
    (["-o", "a.nc", "--omega", "0.1:2"], ["--omega", "'0.1:2'", "START:END:STEP"]),
    (["-o", "a.nc", "--omega", "1:2:-1"], ["--omega"]),
    (["-o", "a.nc", "--headings", "east"], ["--headings"]),
    (["-o", "no/a.nc"], ["no folder"]),
    (["-o", "buoy.py"], ["buoy.py"]),
    (["-o", "a.nc", "-p", "hull=False"], ["no body with a Hull"]),
    (["-o", "a.nc", "--body", "bouy"], ["did you mean 'buoy'"]),
])  # fmt: skip
def test_command_refuses_before_it_computes(command, solver, monkeypatch, arguments, words):
    monkeypatch.setattr(hydro_compute, "solve_static", lambda *a: pytest.fail("computed"))
    status, _, err = command(*arguments)
    assert status == 2 and all(line.startswith("error: ") for line in err.splitlines())
    for word in words:
        assert word in err


def test_command_names_the_extra(command, monkeypatch):
    monkeypatch.setitem(sys.modules, "capytaine", None)
    monkeypatch.setattr(hydro_compute, "solve_static", lambda *a: pytest.fail("computed"))
    status, _, err = command("-o", "a.nc")
    assert status == 2 and "'bem'" in err


def test_steps():
    np.testing.assert_allclose(steps("0.05:3:0.05", "x"), 0.05 * np.arange(1, 61))
    np.testing.assert_allclose(steps("0:350:10", "x"), 10.0 * np.arange(36))
    np.testing.assert_allclose(steps("0.1,0.4", "x"), [0.1, 0.4])
    for text in ("", "1:2:0", "a:b:c", "1:2:3:4", "2:1:0.1"):
        with pytest.raises(CaseError, match="START:END:STEP"):
            steps(text, "x")


# --- with Capytaine ---------------------------------------------------------------------------------


def test_a_model_gives_the_database_of_a_mesh_by_hand():
    """The moored cylinder against `compute_database` on a mesh drawn at the draught of the closed form, with a lid that
    follows the waterline."""
    pytest.importorskip("capytaine")
    from floatsim.hydro.compute import WetBody, compute_database

    outline = profile([(0.0, LOW), (RADIUS, LOW), (RADIUS, HIGH), (0.0, HIGH)], 0.8, sharp=[1])
    mesh = revolve(outline, SIDES)
    T = (MASS * G + STIFFNESS * (DEPTH - FREE)) / (RHO * G * math.pi * RADIUS**2 + STIFFNESS)
    omega = [0.6, 1.2, 1.8]
    db = compute_model_database(moored(buoy(fs.Hull(mesh=(mesh.vertices, mesh.faces)))), omega)
    hull = revolve(profile([(0.0, -T), (RADIUS, -T), (RADIUS, 0.0)], 0.8, sharp=[1]), SIDES)
    lid = revolve(profile([(0.0, -0.35), (RADIUS, -0.35)], 0.8), SIDES)
    by_hand = compute_database("hand", [WetBody("buoy", hull, (0.0, 0.0, -LOW - T), lid)], omega, depth=DEPTH)
    for name in ("added_mass", "radiation_damping", "added_mass_inf", "excitation", "hydrostatic_stiffness"):
        a, b = getattr(db, name), getattr(by_hand, name)
        for i in (0, 2, 4):
            x, y = (c[..., i] if name == "excitation" else c[..., i, i] for c in (a, b))
            np.testing.assert_allclose(x, y, atol=0.03 * np.abs(y).max() + 1e-6, err_msg=f"{name} {i}")
    assert db.source["static_draught"] == pytest.approx([T], rel=1e-5)
