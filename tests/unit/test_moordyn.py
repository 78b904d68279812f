"""MoorDyn input files: what becomes of them, what is said about the rest, and messages for bad ones.

All decks are written here. Their format is that of MoorDyn's documentation, "Input Files".
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mechanics import end_force
from shipped import load

import floatsim as fs
from floatsim.study.moordyn import MoorDynImport, read_moordyn

# the mooring of VolturnUS-S (Allen et al. 2020 and the public deck), written our own way: tabs, comments, another
# order of columns, Fortran exponents
CHAINS = """\
chains of a semi-submersible, three of them
---------------------- LINE TYPES ----------------------
TypeName  EA       Diam   Mass/m  BA/-zeta  EI   Cd   Ca    CdAx  CaAx
(name)    (N)      (m)    (kg/m)  (N-s/-)   (-)  (-)  (-)   (-)   (-)
Chain_R3  3.27D+9\t0.333  685     -1.0      0    2.0  0.82  0.4   0.27   ! studless
---------------------- POINTS ---------------------------
ID  Attachment  X       Y         Z     Mass  Volume  CdA  Ca
(#) (-)         (m)     (m)       (m)   (kg)  (m^3)   (m2) (-)
1   Vessel     -58.0    0.0      -14.0  0     0       0    0
2   Fixed      -837.6   0.0      -200.  0     0       0    0
3   Vessel      29.0    50.229   -14.0  0     0       0    0
4   Anchor      418.8   725.383  -200.  0     0       0    0
% the last pair
5   Coupled     29.0   -50.229   -14.0  0     0       0    0
6   Fixed       418.8  -725.383  -200.  0     0       0    0
---------------------- LINES ----------------------------
ID  LineType  AttachA  AttachB  UnstrLen  NumSegs  LineOutputs
(#) (name)    (#)      (#)      (m)       (-)      (-)
1   Chain_R3  2        1        850       50       p
2   chain_r3  4        Point3   850       50       -
3   Chain_R3  6        5        850       50
---------------------- OPTIONS --------------------------
200     WtrDpth   water depth (m)
1025    rho
9.81    g
3.0e6   kBot
3.0e5   cBot
0.001   dtM
0.3     FrictionCoefficient
---------------------- OUTPUTS --------------------------
FairTen1 FairTen2
END
-------------------- need this line ---------------------
"""


def read(folder: Path, text: str, **arguments: Any) -> MoorDynImport:
    path = folder / "deck.txt"
    path.write_text(text)
    return read_moordyn(path, **arguments)


def problems(folder: Path, text: str, **arguments: Any) -> str:
    with pytest.raises(fs.ModelError) as caught:
        read(folder, text, **arguments)
    return str(caught.value)


BEAM = "beam 1e-3 1e-6 1e10 0 2e6 0 0 0 0"


def beam(points: str, lines: str, rods: str = "", kind: str = BEAM, rest: str = "") -> str:
    """A deck in the air above 50 m of water; type, points, rods and lines as given."""
    rods = f"--- RODS ---\nID RodType Attachment Xa Ya Za Xb Yb Zb NumSegs Out\n{rods}" if rods else ""
    return (
        f"--- LINE TYPES ---\nName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx\n{kind}\n{rods}"
        f"--- POINTS ---\nID Type X Y Z Mass Volume CdA Ca\n{points}"
        f"--- LINES ---\nID LineType AttachA AttachB UnstrLen NumSegs Out\n{lines}{rest}"
        "--- OPTIONS ---\n50 WtrDpth\n9.80665 g\n"
    )


def solved(imported: MoorDynImport) -> tuple[fs.System, fs.State]:
    system = fs.assemble(imported.model)
    return system, fs.solve_static(system)[0]


# --- what becomes of a deck ------------------------------------------------------------------------------------


def test_volturnus_chains(tmp_path: Path) -> None:
    """2.435 MN at the fairleads: MoorPy (CableDyn 2.437, MoorDyn 2.439); and the chains of models/volturnus_s.py."""
    imported = read(tmp_path, CHAINS)
    system, state = solved(imported)
    forces = [float(np.linalg.norm(end_force(system, state, f"line_{k}_end_b"))) for k in (1, 2, 3)]
    assert forces == pytest.approx(3 * [2.435e6], rel=5e-3)
    own = load("volturnus_s").chain("chain_r3")
    line = imported.parts[0]
    assert line.pieces[0].section == own.model_copy(update={"axial_law": fs.Engineering()})
    by_hand = fs.Model(
        parts=[fs.Line(name="line_1", section=own, length=850.0, elements=50)],
        joints=[fs.Ball(a="line_1.end_a", b=(-837.6, 0.0, -200.0)), fs.Ball(a="line_1.end_b", b=(-58.0, 0.0, -14.0))],
        sea=fs.Sea(depth=200.0),
    )
    other = fs.assemble(by_hand)
    force = np.linalg.norm(end_force(other, fs.solve_static(other)[0], "line_1_end_b"))
    assert forces[0] == pytest.approx(force, rel=1e-4)  # engineering against Green strain of 7e-4
    assert (imported.sea.depth, imported.gravity, imported.sea.seabed.friction) == (200.0, 9.81, 0.3)
    assert imported.not_understood == ()
    said = "\n".join(imported.notes)
    for words in ("point 1 (line 9), point 3 (line 11), point 5 (line 14)", "damping ratio: 1 l0", "2 output channels",
                  "friction 0.3", "dtM"):  # fmt: skip
        assert words in said


def test_coupled_points_go_to_a_given_body(tmp_path: Path) -> None:
    """A turned and moved platform gets the points where the file has them."""
    platform = fs.Body(name="platform", mass=2e7, inertia=(1e10, 1e10, 1e10), position=(10.0, 0.0, -4.0),
                       attitude_deg=(0.0, 0.0, 90.0), points={"mast": (0.0, 0.0, 9.0)})  # fmt: skip
    imported = read(tmp_path, CHAINS, bodies={"vessel": platform})
    body = imported.parts[0]
    assert body.points["point_1"] == pytest.approx((0.0, 68.0, -10.0))  # x of the world is -y of the body
    assert body.points["mast"] == (0.0, 0.0, 9.0)
    assert [joint.b for joint in imported.joints] == [
        (-837.6, 0.0, -200.0), "platform.point_1", (418.8, 725.383, -200.0), "platform.point_3",
        (418.8, -725.383, -200.0), "platform.point_5",
    ]  # fmt: skip
    assert not any("held" in note for note in imported.notes)
    assert "nothing in deck.txt is held by 'body7'" in problems(tmp_path, CHAINS, bodies={7: platform})


def test_a_coupled_point_follows_a_motion(tmp_path: Path) -> None:
    motion = fs.Motion(lambda t: (-58.0, math.sin(t), -14.0), lambda t: (0.0, math.cos(t), 0.0),
                       lambda t: (0.0, -math.sin(t), 0.0))  # fmt: skip
    imported = read(tmp_path, CHAINS, motions={1: motion})
    joint = imported.joints[1]
    assert isinstance(joint, fs.Prescribed) and joint.motion is motion
    assert "no Coupled point 2" in problems(tmp_path, CHAINS, motions={2: motion})


def test_version_1(tmp_path: Path) -> None:
    """Its types have Can Cat Cdn Cdt and no EI, its lines their length before their ends."""
    text = (
        "deck\nTrue Echo\n--- LINE TYPES ---\nLineType Diam MassDenInAir EA BA/-zeta Can Cat Cdn Cdt\n"
        "(-) (m) (kg/m) (N) (Pa-s/-) (-) (-) (-) (-)\nmain 0.333 685 3.27e9 -1 0.82 0.27 2.0 0.4\n"
        "--- CONNECTION PROPERTIES ---\nNode Type X Y Z M V FX FY FZ CdA CA\n(-) (-) (m) (m) (m) (kg) (m3) (kN)\n"
        "1 Vessel -58 0 -14 0 0 0 0 0 0 0\n2 Fixed -837.6 0 -200 0 0 0 0 5 0 0\n"
        "--- LINE PROPERTIES ---\nLine LineType UnstrLen NumSegs NodeAnch NodeFair Flags/Outputs\n"
        "(-) (-) (m) (-) (-) (-) (-)\n1 main 850 50 2 1 p\n--- SOLVER OPTIONS ---\n3e6 kb\n"
    )
    imported = read(tmp_path, text)
    line = imported.parts[0]
    version_2 = read(tmp_path, CHAINS).parts[0].pieces[0].section
    assert line.pieces[0].section == version_2.model_copy(update={"name": "main"})
    assert (line.length, line.elements, imported.sea.depth) == (850.0, 50, 200.0)
    assert imported.not_understood == (
        "line 11: point 2: the steady force FZ = 5 was left out; floatsim has no constant forces",
    )
    assert any("no WtrDpth: 200 m" in note for note in imported.notes)
    assert read(tmp_path, text, depth=210.0).sea.depth == 210.0
    unnamed = text.replace("Can Cat Cdn Cdt", "c1 c2 c3 c4")
    assert read(tmp_path, unnamed).parts[0].pieces[0].section == line.pieces[0].section
    assert any("MoorDyn's own order" in line for line in read(tmp_path, unnamed).not_understood)


def test_clump_weight(tmp_path: Path) -> None:
    """A line hanging in water with 500 kg and 0.1 m3 at its end: the weights in water, by hand."""
    text = beam("1 Fixed 0 0 -5 0 0 0 0\n2 Free 0 0 -15 500 0.1 0.3 0.5\n", "1 wire 1 2 10 10 -\n",
                kind="wire 0.05 20 1e8 0 0 0 0 0 0")  # fmt: skip
    system, state = solved(read(tmp_path, text))
    weight = (500.0 - 1025.0 * 0.1 + 10.0 * (20.0 - 1025.0 * math.pi / 4.0 * 0.05**2)) * 9.80665
    assert -end_force(system, state, "line_1_end_a")[2] == pytest.approx(weight, rel=1e-6)


def test_junction_of_three_lines(tmp_path: Path) -> None:
    """A weight on two inclined lines of one angle and a slack pendant below: weight over 2 sin, weightless lines."""
    points = "1 Fixed -6 0 -2 0 0 0 0\n2 Fixed 6 0 -2 0 0 0 0\n3 Connect 0 0 -10 0 0 0 0\n4 Free 0 0 -12 1000 0 0 0\n"
    text = beam(points, "1 w 1 3 10 1 -\n2 w 3 2 10 1 -\n3 w 4 3 2 1 -\n", kind="w 1e-4 1e-6 1e9 0 0 0 0 0 0")
    imported = read(tmp_path, text)
    assert [(j.a, j.b) for j in imported.joints if isinstance(j.b, str)] == [
        ("line_2.end_a", "line_1.end_b"), ("line_3.end_b", "line_1.end_b")
    ]  # fmt: skip
    system, state = solved(imported)
    force = float(np.linalg.norm(end_force(system, state, "line_1_end_a")))
    assert force == pytest.approx(1000.0 * 9.80665 / 2.0 / 0.8, rel=1e-4)  # 3, 4, 5


# drop of a weightless cantilever of 10 m, EI 2e6 N m2, 1000 kg at its end: elliptic integrals
DROP = 1.591703


@pytest.mark.parametrize(
    "rod, end", [("0 0 80 1 0 80 0", "R1B"), ("1 0 80 0 0 80 1", "R1B"), ("0 0 80 -1 0 80 0", "R1A")]
)
@pytest.mark.parametrize("order", ["{rod} 2", "2 {rod}"])
def test_rods_clamp_lines(tmp_path: Path, rod: str, end: str, order: str) -> None:
    """Out of its end B a line leaves along the direction from A to B, out of end A against it."""
    long = rod.endswith("1")
    rod, end = ("-1 0 80 0 0 80 1", end) if long else (rod, end)
    text = beam("2 Free 10 0 80 1000 0 0 0\n", f"1 beam {order.format(rod=end)} 10 20 -\n", f"1 x Fixed {rod} -\n")
    imported = read(tmp_path, text)
    clamp = next(joint for joint in imported.joints if isinstance(joint, fs.Clamp))
    assert (clamp.b, clamp.direction) == ((0.0, 0.0, 80.0), (1.0, 0.0, 0.0))
    system, state = solved(imported)
    assert 80.0 - state.x[: imported.parts[0].n_points, 2].min() == pytest.approx(DROP, rel=2e-3)


def test_free_rods_join_lines(tmp_path: Path) -> None:
    """Three lines through free rods of no length are one line, whichever way they run."""
    rods = "1 x Fixed 0 0 80 1 0 80 0 -\n2 x Free 4 0 80 5 0 80 0 -\n3 x Free 7 0 80 8 0 80 0 -\n"
    lines = "7 beam R1B R2A 4 8 -\n8 beam R3A R2B 3 6 -\n9 beam R3B 2 3 6 -\n"
    imported = read(tmp_path, beam("2 Free 10 0 80 1000 0 0 0\n", lines, rods))
    (line,) = imported.parts
    assert (line.name, line.length, line.elements, len(line.pieces)) == ("line_7_8_9", 10.0, 20, 3)
    system, state = solved(imported)
    assert 80.0 - state.x[20, 2] == pytest.approx(DROP, rel=2e-3)


def test_pinned_rod_is_a_hinge(tmp_path: Path) -> None:
    text = beam("2 Fixed 9 0 80 0 0 0 0\n", "1 beam R1B 2 10 4 -\n", "1 x Pinned 0 0 80 1 0 80 0 -\n")
    assert [type(joint) for joint in read(tmp_path, text).joints] == [fs.Ball, fs.Ball]


def test_free_body(tmp_path: Path) -> None:
    """A body of the file hangs on its line; a rod on it holds a direction in the body's axes."""
    bodies = (
        "--- BODIES ---\nID Attachment X0 Y0 Z0 r0 p0 y0 Mass CG I Volume CdA Ca\n"
        "1 Free 0 0 60 0 0 90 2000 0|0|-1 100|200|300 0.5 0 0\n2 Coupled 5 0 70 0 0 90 0 0 0 0 0 0\n"
    )
    text = beam("1 Fixed 0 0 80 0 0 0 0\n2 Body1 0 0 1 0 0 0 0\n3 Body2 1 0 0 0 0 0 0\n",
                "1 beam 1 2 19 5 -\n2 beam R1A 3 20 5 -\n", "1 x Body1 1 0 0 2 0 0 0 -\n")  # fmt: skip
    imported = read(tmp_path, text.replace("--- RODS", bodies + "--- RODS"))
    body, *_ = imported.parts
    assert (body.mass, body.inertia, body.center_of_mass) == (2000.0, (100.0, 200.0, 300.0), (0.0, 0.0, -1.0))
    assert body.points["point_2"] == pytest.approx((0.0, 0.0, 1.0))
    clamp = next(joint for joint in imported.joints if isinstance(joint, fs.Clamp))
    assert clamp.b == "body_1.rod_1a" and clamp.direction == pytest.approx((-1.0, 0.0, 0.0))
    assert imported.joints[-1].b == pytest.approx((5.0, 1.0, 70.0))  # x of the turned body 2 is y
    assert any("Volume" in s or "volume = 0.5" in s for s in imported.not_understood)


def test_stiffness_tables(tmp_path: Path) -> None:
    (tmp_path / "rope.txt").write_text("rope\nStrain Tension\n(-) (N)\n0 0\n0.1 1e5\n0.2 4e5\n")
    (tmp_path / "bend.txt").write_text("cable\nCurv Moment\n(1/m) (Nm)\n0.0 0.0\n0.1 2e3\n0.2 3e3\n")
    text = beam("1 Fixed 0 0 80 0 0 0 0\n2 Fixed 9 0 80 0 0 0 0\n", "1 r 1 2 10 4 -\n",
                kind="r 0.1 10 rope.txt -0.5 bend.txt 0 0 0 0")  # fmt: skip
    section = read(tmp_path, text).parts[0].pieces[0].section
    assert section.axial_law == fs.TensionTable(strain=(0.0, 0.1, 0.2), tension=(0.0, 1e5, 4e5))
    assert section.bending_law == fs.MomentTable(curvature=(0.0, 0.1, 0.2), moment=(0.0, 2e3, 3e3))
    # MoorDyn's damping ratio refers to the secant to the last point: 2e6 N
    assert section.axial_damping == pytest.approx(0.5 * 2.5 * math.sqrt(2e6 * 10.0))
    assert "no such file" in problems(tmp_path, text.replace("rope.txt", "rop.txt"))
    (tmp_path / "rope.txt").write_text("a\nb\nc\n0 0\n0.1 x\n")
    assert "'rope.txt', line 5: got '0.1 x'" in problems(tmp_path, text)


@pytest.mark.parametrize("EA, B", [("1e7|4e7", 0.0), ("1e7|4e7|12.5", 12.5)])
def test_two_stiffnesses(tmp_path: Path, EA: str, B: float) -> None:
    """Hall et al. (2023): EA_d and BA_d in series with k and BA_s, EA_s together; relaxes with
    (BA_s + BA_d)/(EA_d + k)."""
    text = beam("1 Fixed 0 0 80 0 0 0 0\n2 Fixed 9 0 80 0 0 0 0\n", "1 r 1 2 10 4 -\n",
                kind=f"r 0.1 10 {EA} 3e9|2e4 0 0 0 0 0")  # fmt: skip
    section = read(tmp_path, text).parts[0].pieces[0].section
    law = section.axial_law
    k = 4e7 * 1e7 / (4e7 - 1e7)
    assert law.relaxation_time == pytest.approx((3e9 + 2e4) / (4e7 + k))
    assert (law.dynamic_stiffness, law.per_tension, section.axial_damping) == (4e7, B, 2e4)
    assert law.tension[1] / law.strain[1] == pytest.approx(1e7)


def test_failures(tmp_path: Path) -> None:
    section = "--- FAILURE ---\nFailureID Point Line(s) FailTime FailTen\n() () (,) (s) (N)\n1 1 1 20 0\n2 4 2 30 9e6\n"
    imported = read(tmp_path, CHAINS.replace("---------------------- OPTIONS", section + "--- OPTIONS"))
    assert imported.parts[0].breaks == (fs.Break(at=850.0, time=20.0),)
    assert imported.parts[1].breaks == (fs.Break(at=0.0, time=30.0), fs.Break(at=0.0, tension=9e6))
    several = section + "3 1 1,2 0 5\n"
    assert "lines that end at the point" in problems(tmp_path, CHAINS.replace("--- OPTIONS", several + "--- OPTIONS"))


def test_relative_length(tmp_path: Path) -> None:
    """A negative UnstrLen is a share of the distance between the ends."""
    text = beam("1 Fixed 0 0 80 0 0 0 0\n2 Fixed 3 4 80 0 0 0 0\n", "1 beam 1 2 -1.1 4 -\n")
    assert read(tmp_path, text).parts[0].length == pytest.approx(5.5)


def test_what_is_left_out_is_said(tmp_path: Path) -> None:
    options = "3 WaveKin\n1 Currents\n0.7 StatDynFricScale\n5 Wobble\nsea.txt SeafloorFile\n"
    text = CHAINS.replace("0.001   dtM", options)
    text += "--- CONTROL ---\nChannelID Line(s)\n() (,)\n1 1,2\n--- PAINT ---\nred\n"
    said = "\n".join(read(tmp_path, text).not_understood)
    for words in (
        "WaveKin = 3: waves left out", "Currents = 1", "StatDynFricScale = 0.7", "Wobble = 5 is not known",
        "SeafloorFile = sea.txt: bathymetry", "control channels", "section 'PAINT' is not known",
    ):  # fmt: skip
        assert words in said


HEADINGS = CHAINS[CHAINS.index("ID  LineType") : CHAINS.index("1   Chain_R3")]


# --- bad files --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "old, new, said",
    [
        ("0.333 ", "abc ", "deck.txt, line 5: d: got 'abc'; a finite number is allowed"),
        ("0.333 ", "-0.3 ", "deck.txt, line 5: Section 'chain_r3': diameter: got -0.3; must be a positive number"),
        ("0.333 ", "nan ", "line 5: d: got 'nan'"),
        ("3.27D+9", "soft.txt", "line 5: EA: got 'soft.txt'; a number or the name of a table file"),
        ("3.27D+9", "SYROPE:a.dat|1e6|3", "working curves of a SYROPE file are not read"),
        ("3.27D+9", "4e9|1e9", "EA_s|EA_d with 0 < EA_s"),
        ("-1.0 ", "x.txt ", "line 5: BA/-zeta: got 'x.txt'"),
        ("2   Fixed", "2   Fixt", "line 10: point 2: got 'Fixt'; Fixed, Coupled, Vessel, Free"),
        ("2   Fixed", "2   Body3", "point 2: got 'body3', which is not in the file"),
        ("2   Fixed", "1   Fixed", "line 10: point 1 is given twice"),
        ("2   Fixed", "2.5 Fixed", "line 10: id: got '2.5'; a whole number of at least 1 is allowed"),
        ("  2        1  ", "  9        1  ", "line 19: AttachA: got '9'; a point or an end of a rod"),
        ("1   Chain_R3", "1   Chain_R4", "line 19: there is no line type 'Chain_R4' (did you mean 'Chain_R3'?)"),
        ("850       50       p", "0         50       p", "line 1: UnstrLen: got 0"),
        ("850       50       p", "850       0        p", "line 19: segments: got '0'; a whole number of at least 1"),
        ("850       50       p", "850", "line 19: got 5 values"),
        ("200     WtrDpth", "deep    WtrDpth", "WtrDpth = deep"),
        ("200     WtrDpth", "WtrDpth 200", "the value comes first: '200 WtrDpth'"),
        ("200     WtrDpth", "100     WtrDpth", "below the seabed"),
        ("3.0e6   kBot", "-1      kBot", "Seabed: stiffness: got -1.0; must be a positive number"),
        (HEADINGS, "", "a row of column names must come first"),
    ],
)  # fmt: skip
def test_messages(tmp_path: Path, old: str, new: str, said: str) -> None:
    """Each names the file and the line, what was got and what is allowed."""
    assert old in CHAINS
    text = CHAINS.replace(old, new, 1)
    if said == "WtrDpth = deep":  # that may be a file of MoorDyn's: it is left out, not refused
        assert any(said in line for line in read(tmp_path, text).not_understood)
    else:
        assert said in problems(tmp_path, text)


def test_what_cannot_be_left_out_is_refused(tmp_path: Path) -> None:
    points, line = "2 Fixed 9 0 80 0 0 0 0\n", "1 beam R1B 2 10 4 -\n"
    assert "rods that move on their own" in problems(tmp_path, beam(points, line, "1 x Free 0 0 80 1 0 80 3 -\n"))
    assert "its two ends are the same point" in problems(tmp_path, beam(points, line, "1 x Fixed 0 0 80 0 0 80 0 -\n"))
    assert "Turbine3".lower() in problems(tmp_path, beam(points, line, "1 x Turbine3 0 0 80 1 0 80 0 -\n"))


@pytest.mark.parametrize("text", ["", "hello\n", "\x00\xff", "--- LINES ---\n", "--- OPTIONS ---\n200 WtrDpth\n"])
def test_no_deck_at_all(tmp_path: Path, text: str) -> None:
    assert "deck.txt" in problems(tmp_path, text)


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(fs.ModelError, match="cannot be read"):
        read_moordyn(tmp_path / "none.txt")
    with pytest.raises(fs.ModelError, match="cannot be read"):
        read_moordyn(tmp_path)


EVERYTHING = beam(
    "1 Fixed 0 0 -9 0 0 0 0\n2 Free 10 0 -20 500 0.1 1 1\n3 Body1 0 0 1 0 0 0 0\n4 Coupled 30 0 -5 0 0 0 0\n",
    "1 beam R1B R2A 4 3 -\n2 beam R2B 2 5 3 -\n3 rope 2 3 12 3 p\n4 rope 3 4 -1.1 2 p\n5 beam 1 2 15 4 -\n",
    "1 x Coupled 0 0 -8 1 0 -8 0 -\n2 x Free 4 0 -8 5 0 -8 0 -\n",
    kind="beam 0.1 50 1e8 -1 2e4 1 1 0 0\nrope 0.1 9 1e7|4e7 3e9|2e4 0 1 1 0.1 0",
    rest="--- FAILURE ---\nID Point Lines FailTime FailTen\n1 3 3 10 0\n",
).replace("--- RODS", "--- BODIES ---\nID Attachment X0 Y0 Z0 r0 p0 y0 Mass CG I Volume CdA Ca\n"
                      "1 Free 20 0 -9 0 0 9 2000 0|0|-1 100 0 0 0\n--- RODS")  # fmt: skip

_PIECES = st.one_of(
    st.sampled_from([
        "", " ", "\n", "|", "-", "---", "0", "-1", "1e30", "1e-30", "nan", "inf", "R1A", "Body1", "Free", "x",
        "Coupled", "Fixed", "%", "(m)", "\t", "99", "0.5", "--- LINES ---\n", "--- POINTS ---\n",
    ]),
    st.text(max_size=6),
)  # fmt: skip


def test_everything_is_read(tmp_path: Path) -> None:
    imported = read(tmp_path, EVERYTHING)
    assert [part.name for part in imported.parts] == ["body_1", "line_1_2", "line_3", "line_4", "line_5"]


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_mutated_decks_are_read_or_refused(tmp_path: Path, data: st.DataObject) -> None:
    """Whatever happens to a file, the answer is a model or a ModelError: words and lines replaced, removed, doubled."""
    words = EVERYTHING.replace("\n", " \n ").split(" ")
    for _ in range(data.draw(st.integers(1, 4))):
        k = data.draw(st.integers(0, len(words) - 1))
        change = data.draw(st.sampled_from(["replace", "remove", "double", "swap"]))
        if change == "replace":
            words[k] = data.draw(_PIECES)
        elif change == "remove" and len(words) > 2:
            del words[k]
        elif change == "double":
            words.insert(k, words[k])
        else:
            other = data.draw(st.integers(0, len(words) - 1))
            words[k], words[other] = words[other], words[k]
    (tmp_path / "deck.txt").write_bytes(" ".join(words).encode("utf-8", "surrogatepass"))
    try:
        read_moordyn(tmp_path / "deck.txt")
    except fs.ModelError as error:
        assert all("deck.txt" in line for line in error.problems), error.problems
