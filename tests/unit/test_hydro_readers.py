"""Every reader against one made-up case with a known answer, written here in the other code's own convention.

Two bodies off the origin feel the wave at their place: heave C eta + D d(eta)/dt, surge and sway - m g grad(eta),
moments by lever arms. For the time factor e^{s i w t}, s = +1 or -1, and phases from a point p, the wave is
exp(- s i k (x - p)): amplitudes for any convention follow from that, not from conjugating floatsim's. Matrices are
arbitrary and not symmetric, so that rows and columns cannot be mixed up. Conventions of the codes: their manuals, as
cited in the readers.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pytest

from floatsim.errors import ModelError
from floatsim.hydro.database import DOF_NAMES, HydroDatabase
from floatsim.hydro.nemoh import read_hydrostatics
from floatsim.hydro.read import read_hydro
from floatsim.sea.dispersion import wave_number

RHO, G, DEPTH = 1000.0, 9.81, 40.0
OMEGA = np.array([0.4, 0.8, 1.2])
HEADINGS = np.radians([0.0, 30.0, 60.0, 90.0])
NAMES = ("float", "spar")
# per body: volume, centres of buoyancy and gravity, reference point, waterplane (area, x, y, Sxx, Syy, Sxy)
V = np.array([300.0, 500.0])
CB = np.array([[11.0, -4.5, -2.0], [30.5, 8.0, -9.0]])
CG = np.array([[11.5, -4.0, -1.0], [30.0, 8.5, -12.0]])
REF = np.array([[10.0, -5.0, -3.0], [30.0, 8.0, -10.0]])
PLANE = ((120.0, 10.8, -5.2, 1200.0, 1500.0, 100.0), (40.0, 30.2, 8.1, 200.0, 150.0, -20.0))
WEIGHT = RHO * G * V


def amplitudes(sign: int = 1, origin: tuple[float, float] = (0.0, 0.0), incident: bool = False) -> np.ndarray:
    """(n, m, 12) forces per metre for time factor e^{sign i w t} and a crest at `origin` at t = 0."""
    k = wave_number(OMEGA, DEPTH, G)[:, None]
    out = np.zeros((3, 4, 12), dtype=complex)
    for body in range(2):
        x, y = CB[body, :2] - origin
        eta = np.exp(-sign * 1j * k * (x * np.cos(HEADINGS) + y * np.sin(HEADINGS)))
        rate = sign * 1j * OMEGA[:, None] * eta
        slope = -sign * 1j * k * eta
        mass, lever = (1.0 if incident else 1.7) * RHO * V[body], 2.0 + body
        surge, sway = -mass * G * slope * np.cos(HEADINGS), -mass * G * slope * np.sin(HEADINGS)
        heave = RHO * G * PLANE[body][0] * eta + (0.0 if incident else 3e4) * rate
        out[:, :, 6 * body : 6 * body + 6] = np.stack(
            [surge, sway, heave, -lever * sway, lever * surge, 0.3 * sway], axis=2
        )
    return out


def stiffness(point: np.ndarray, body: int, weighed: bool) -> np.ndarray:
    """C (6, 6) about `point`, with or without the weight at the centre of gravity (WAMIT manual v7, section 3.1)."""
    S, xf, yf, sxx, syy, sxy = PLANE[body]
    x, y = xf - point[0], yf - point[1]
    b, w = CB[body] - point, CG[body] - point
    C = np.zeros((6, 6))
    C[2, 2:5] = C[2:5, 2] = RHO * G * S * np.array([1.0, y, -x])
    C[3, 3] = RHO * G * (syy + S * y * y)
    C[4, 4] = RHO * G * (sxx + S * x * x)
    C[3, 4] = C[4, 3] = -RHO * G * (sxy + S * x * y)
    for arm, load in ((b, WEIGHT[body]), (w, -WEIGHT[body] if weighed else 0.0)):
        C[3, 3] += load * arm[2]
        C[4, 4] += load * arm[2]
        C[3, 5] -= load * arm[0]
        C[4, 5] -= load * arm[1]
    return C


def both(matrix: Any) -> np.ndarray:
    out = np.zeros((12, 12))
    out[:6, :6], out[6:, 6:] = matrix(0), matrix(1)
    return out


RANDOM = np.random.default_rng(7)
MASS, MASS_INF, MASS_ZERO = (RANDOM.normal(size=shape) * 1e5 for shape in ((3, 12, 12), (12, 12), (12, 12)))
DAMPING = RANDOM.normal(size=(3, 12, 12)) * 1e4
DRIFT = RANDOM.normal(size=(3, 4, 12)) * 1e3


def truth() -> HydroDatabase:
    return HydroDatabase(
        name="truth", bodies=NAMES, omega=OMEGA, added_mass=MASS, radiation_damping=DAMPING, added_mass_inf=MASS_INF,
        added_mass_zero=MASS_ZERO, headings=HEADINGS, excitation=amplitudes(), froude_krylov=amplitudes(incident=True),
        mean_drift=DRIFT, hydrostatic_stiffness=both(lambda b: stiffness(REF[b], b, False)), volume=V,
        centre_of_buoyancy=CB, reference_point=REF, depth=DEPTH, density=RHO, gravity=G,
    )  # fmt: skip


def same(db: HydroDatabase, *left_out: str, rtol: float = 1e-6) -> None:
    wanted = truth()
    one = len(db.bodies) == 1
    for name in ("omega", "added_mass", "radiation_damping", "added_mass_inf", "added_mass_zero", "headings",
                 "excitation", "froude_krylov", "mean_drift", "hydrostatic_stiffness", "volume", "centre_of_buoyancy",
                 "reference_point"):  # fmt: skip
        want, got = getattr(wanted, name), getattr(db, name)
        if name in left_out:
            assert got is None, name
            continue
        if one and name not in ("omega", "headings"):
            want = want[:1] if name in ("volume", "centre_of_buoyancy", "reference_point") else want[..., :6]
            want = want[..., :6, :] if want.ndim > 1 and want.shape[-2] == 12 else want
        np.testing.assert_allclose(got, want, rtol=rtol, atol=rtol * np.abs(want).max(), err_msg=name)
    assert (db.depth, db.density, db.gravity) == (DEPTH, RHO, G)


def test_the_known_answer_pushes_as_the_water_does() -> None:
    """In floatsim's time: Re(X e^{i w t}) is C eta + D d(eta)/dt with eta = cos(w t - k (x cos b + y sin b))."""
    w, b, body = OMEGA[1], HEADINGS[1], 1
    k = float(wave_number(w, DEPTH, G))
    t = np.linspace(0.0, 9.0, 50)
    phase = w * t - k * (CB[body, 0] * math.cos(b) + CB[body, 1] * math.sin(b))
    X = truth().excitation[1, 1, 6:9]
    heave = RHO * G * 40.0 * np.cos(phase) - 3e4 * w * np.sin(phase)
    np.testing.assert_allclose(np.real(X[2] * np.exp(1j * w * t)), heave, atol=1e-6 * np.abs(heave).max())
    surge = -1.7 * RHO * V[body] * G * k * math.cos(b) * np.sin(phase)
    np.testing.assert_allclose(np.real(X[0] * np.exp(1j * w * t)), surge, atol=1e-6 * np.abs(surge).max())


# --- WAMIT ----------------------------------------------------------------------------------------

ULEN = 2.0
ROTATION = np.tile([0, 0, 0, 1, 1, 1], 2)
ARMS = ROTATION[:, None] + ROTATION


def polar(value: complex) -> str:
    return f"{abs(value):.8e} {math.degrees(math.atan2(value.imag, value.real)):.6f} {value.real:.8e} {value.imag:.8e}"


def write_wamit(folder: Path, bodies: int = 2) -> Path:
    """Periods and degrees; e^{+i w t}, phases from the origin."""
    d = 6 * bodies
    stem = folder / "hull"
    scale = RHO * ULEN ** (3.0 + ARMS)
    rows = []
    for period, A in ((-1.0, MASS_ZERO), (0.0, MASS_INF)):
        rows += [f"{period} {i + 1} {j + 1} {A[i, j] / scale[i, j]:.8e}" for i in range(d) for j in range(d)]
    for w, A, B in zip(OMEGA, MASS, DAMPING):
        rows += [f"{2 * math.pi / w:.9f} {i + 1} {j + 1} {A[i, j] / scale[i, j]:.8e} {B[i, j] / scale[i, j] / w:.8e}"
                 for i in range(d) for j in range(d)]  # fmt: skip
    Path(f"{stem}.1").write_text("\n".join(rows))
    pressure = RHO * G * ULEN ** (2.0 + ROTATION)
    whole, incident = amplitudes() / pressure, amplitudes(incident=True) / pressure
    drift = DRIFT / pressure * ULEN
    for ending, X in ((".3", whole), (".3fk", incident), (".3sc", whole - incident), (".9", drift), (".8", drift + 1)):
        rows = []
        for n, w in enumerate(OMEGA):
            for m, b in enumerate(np.degrees(HEADINGS)):
                angle = f"{b:.4f} {b:.4f}" if ending in (".8", ".9") else f"{b:.4f}"
                modes = (0, 1, 5) if ending == ".8" else range(d)
                rows += [f"{2 * math.pi / w:.9f} {angle} {i + 1} {polar(complex(X[n, m, i]))}" for i in modes]
        Path(f"{stem}{ending}").write_text("\n".join(rows))
    C = both(lambda b: stiffness(REF[b], b, True)) / (RHO * G * ULEN ** (2.0 + ARMS))
    rows = [f"{i + 1} {j + 1} {C[i, j]:.8e}" for i in range(d) for j in range(d)]
    Path(f"{stem}.hst").write_text("\n".join(rows))
    return stem


def wamit_options(bodies: int = 2) -> dict[str, Any]:
    return {"volume": V[:bodies].tolist(), "centre_of_buoyancy": CB[:bodies].tolist(), "depth": DEPTH, "density": RHO,
            "gravity": G, "length": ULEN, "reference_point": REF[:bodies].tolist(),
            "centre_of_gravity": (CG - REF)[:bodies].tolist()}  # fmt: skip


def test_wamit_two_bodies(tmp_path: Path) -> None:
    stem = write_wamit(tmp_path)
    db = read_hydro(stem, **wamit_options(), bodies=NAMES)
    same(db)
    assert db.bodies == NAMES
    assert read_hydro(f"{stem}.hst", **wamit_options()).bodies == ("body_1", "body_2")
    Path(f"{stem}.3fk").unlink()
    same(read_hydro(stem, **wamit_options()), rtol=2e-6)  # what the scattered wave leaves
    Path(f"{stem}.9").unlink()
    db = read_hydro(stem, **wamit_options())
    assert db.mean_drift is None and "sum over all bodies" in db.source["mean_drift"]


def test_wamit_mean_drift_of_one_body(tmp_path: Path) -> None:
    """Momentum (`.8`) in surge, sway, yaw over pressure (`.9`); rho g L for forces, rho g L^2 for moments."""
    stem = write_wamit(tmp_path, bodies=1)
    drift = read_hydro(stem, **wamit_options(1)).mean_drift
    assert drift is not None
    added = RHO * G * ULEN * np.array([1.0, 1.0, 0.0, 0.0, 0.0, ULEN])
    np.testing.assert_allclose(drift, DRIFT[:, :, :6] + added, rtol=1e-6)
    Path(f"{stem}.8").unlink()
    same(read_hydro(stem, **wamit_options(1)))


def test_wamit_wrong_number_of_bodies(tmp_path: Path) -> None:
    stem = write_wamit(tmp_path)
    with pytest.raises(ModelError, match=r"\.1, line 7: degree of freedom 7, must be 1 to 6: volume is .* for 1 body"):
        read_hydro(stem, **wamit_options(1))
    stem = write_wamit(tmp_path, bodies=1)
    with pytest.raises(ModelError, match=r"\.1: volume is given for 2 bodies, the file has fewer"):
        read_hydro(stem, **wamit_options())
    with pytest.raises(ModelError, match="give reference_point, the XBODY of each of the 2 bodies"):
        read_hydro(stem, **{key: value for key, value in wamit_options().items() if key != "reference_point"})
    with pytest.raises(ModelError, match="centre_of_buoyancy must be 3 numbers for each of 2 bodies"):
        read_hydro(write_wamit(tmp_path), **wamit_options() | {"centre_of_buoyancy": (0.0, 0.0, -1.0)})


# --- Nemoh ----------------------------------------------------------------------------------------

EFF = (5.0, -2.0)
CAL_BODY = """--- Body {n} ---
mesh\\{name}.dat ! Name of mesh file
400 300 ! Number of points and number of panels
6 ! Number of degrees of freedom
1 1. 0. 0. 0. 0. 0. ! Surge
1 0. 1. 0. 0. 0. 0. ! Sway
1 0. 0. 1. 0. 0. 0. ! Heave
2 1. 0. 0. {x} {y} {z} ! Roll about a point
2 0. 1. 0. {x} {y} {z} ! Pitch about a point
2 0. 0. 1. {x} {y} {z} ! Yaw about a point
6 ! Number of resulting generalised forces
1 1. 0. 0. 0. 0. 0. ! Force in x direction
1 0. 1. 0. 0. 0. 0. ! Force in y direction
1 0. 0. 1. 0. 0. 0. ! Force in z direction
2 1. 0. 0. {x} {y} {z} ! Moment about a point
2 0. 1. 0. {x} {y} {z} ! Moment about a point
2 0. 0. 1. {x} {y} {z} ! Moment about a point
0 ! Number of lines of additional information
"""


def tec(path: Path, first: str, column: np.ndarray, blocks: list[np.ndarray], title: str) -> None:
    """blocks of (n, d, 2): pairs of columns."""
    lines = [f'VARIABLES="{first}"', *(f'"a {k}" "b {k}"' for k in range(blocks[0].shape[1]))]
    for k, block in enumerate(blocks):
        lines.append(f'Zone t="{title} {k + 1}",I={len(column)},F=POINT')
        lines += ["  ".join(f"{x:.9E}" for x in (w, *row.ravel())) for w, row in zip(column, block)]
    path.write_text("\n".join(lines) + "\n")


def write_statics(folder: Path, bodies: int) -> None:
    """KH about the centre of gravity, with the weight of the displaced water there."""
    folder.mkdir(exist_ok=True)
    for b in range(bodies):
        tag = "" if bodies == 1 else f"_{b}"
        lines = [f" {a}F = {p:.4f} - {a}G = {q:.4f}" for a, p, q in zip("XYZ", CB[b], CG[b])]
        (folder / f"Hydrostatics{tag}.dat").write_text("\n".join([*lines, f" Displacement = {V[b]:.7E}", " Mass = 1"]))
        np.savetxt(folder / f"KH{tag}.dat", stiffness(CG[b], b, True), fmt="%.9E")


def write_nemoh(folder: Path, version: int, irf: bool = True) -> Path:
    """e^{-i w t}, phases from (XEFF, YEFF), a block per motion; version 3 with periods in the results."""
    folder.mkdir()
    results, mesh = ("Results", "Mesh") if version == 2 else ("results", "mesh")
    (folder / results).mkdir()
    frequencies = "3 0.4 1.2 ! Number of wave frequencies, Min, and Max (rad/s)"
    if version == 3:
        frequencies = "1 3 0.4 1.2 ! Freq type 1,2,3=[rad/s,Hz,s], Number, Min, and Max"
    cal = f"--- Environment ---\n{RHO} ! RHO\n{G} ! G\n{DEPTH} ! DEPTH\n{EFF[0]} {EFF[1]} ! XEFF YEFF\n"
    cal += "--- Bodies ---\n2 ! Number of bodies\n"
    cal += "".join(
        CAL_BODY.format(n=b + 1, name=NAMES[b], x=REF[b, 0], y=REF[b, 1], z=REF[b, 2]) for b in range(2)
    )
    cal += f"--- Load cases ---\n{frequencies}\n4 0. 90. ! Number of wave directions, Min and Max (degrees)\n---\n"
    (folder / "Nemoh.cal").write_text(cal)
    first, column = ("w (rad/s)", OMEGA) if version == 2 else ("T (s)", 2 * np.pi / OMEGA)
    radiation = [np.stack([MASS[:, :, j], DAMPING[:, :, j]], axis=2) for j in range(12)]
    tec(folder / results / "RadiationCoefficients.tec", first, column, radiation, "Motion of body in DoF")
    for name, part in (("ExcitationForce", False), ("FKForce", True)):
        X = amplitudes(-1, EFF, part)
        polar = np.stack([np.abs(X), np.angle(X)], axis=3)
        tec(folder / results / f"{name}.tec", first, column, list(polar.swapaxes(0, 1)), "Diffraction force - beta")
    if irf:
        time = np.array([0.1, 0.2])
        memory = [np.stack([np.tile(MASS_INF[:, j], (2, 1)), np.ones((2, 12))], axis=2) for j in range(12)]
        tec(folder / results / "IRF.tec", "Time (s)", time, memory, "DoF")
    write_statics(folder / mesh, 2)
    return folder


@pytest.mark.parametrize("version", [2, 3])
def test_nemoh(tmp_path: Path, version: int) -> None:
    folder = write_nemoh(tmp_path / "case", version)
    db = read_hydro(folder)
    same(db, "added_mass_zero", "mean_drift")
    assert db.bodies == NAMES
    mechanics = folder / "Mechanics"
    mechanics.mkdir()
    for path in list((folder / ("Mesh" if version == 2 else "mesh")).glob("KH_*.dat")):
        path.rename(mechanics / path.name.replace("KH", "Kh"))
    again = read_hydro(folder / "Nemoh.cal")
    assert again.name == "case" and np.array_equal(again.hydrostatic_stiffness, db.hydrostatic_stiffness)


def test_nemoh_folders_that_cannot_be_used(tmp_path: Path) -> None:
    folder = write_nemoh(tmp_path / "case", 2, irf=False)
    with pytest.raises(ModelError, match=r"no added mass at infinite frequency.*estimate_added_mass_inf=True"):
        read_hydro(folder)
    assert read_hydro(folder, estimate_added_mass_inf=True).source["added_mass_inf"].startswith("from A(w)")
    cal = (folder / "Nemoh.cal").read_text()
    for old, new, message in (
        ("2 0. 1. 0. 30.0 8.0 -10.0 ! Pitch", "2 0. 1. 0. 30.0 8.0 0. ! Pitch", "body 2 must all be about one point"),
        ("1 0. 1. 0. 0. 0. 0. ! Sway", "1 0. 1. 1. 0. 0. 0. ! Sway", "degrees of freedom of body 1 must be surge"),
        ("4 0. 90.", "5 0. 90.", "ExcitationForce.tec': 5 blocks of 25 columns expected"),
        (f"{G} ! G", "gravity", "line 3: gravity expected, found 'gravity'"),
        (cal[cal.index("--- Load") :], "", "Nemoh.cal': ends too early"),
    ):  # fmt: skip
        (folder / "Nemoh.cal").write_text(cal.replace(old, new))
        with pytest.raises(ModelError, match=message):
            read_hydro(folder, estimate_added_mass_inf=True)
    (folder / "Nemoh.cal").write_text(cal)
    (folder / "Mesh" / "KH_1.dat").write_text("1 2 3")
    with pytest.raises(ModelError, match=r"KH_1\.dat': must be six rows of six numbers"):
        read_hydro(folder, estimate_added_mass_inf=True)
    (folder / "Mesh" / "Hydrostatics_0.dat").write_text("XF = a")
    with pytest.raises(ModelError, match=r"Hydrostatics_0\.dat': must have three lines XF"):
        read_hydro(folder, estimate_added_mass_inf=True)
    (folder / "Results" / "ExcitationForce.tec").unlink()
    with pytest.raises(ModelError, match=r"there is no 'ExcitationForce\.tec' in '.*Results'"):
        read_hydro(folder, estimate_added_mass_inf=True)


# --- Capytaine ------------------------------------------------------------------------------------


def write_capytaine(path: Path, version: int = 3, axis: str = "omega", bodies: int = 2, broken: bool = False) -> Path:
    """e^{-i w t}; version 2 has the motions first and neither volume nor centres; frequencies 0 and infinity too."""
    d = 6 * bodies
    omega = np.array([np.inf, 1.2, 0.0, 0.4, 0.8])  # as an unsorted axis of periods would have them
    place = [None, 2, None, 0, 1]
    words = [f"{name}__{dof}" for name in NAMES for dof in DOF_NAMES] if bodies == 2 else list(DOF_NAMES)
    order = np.random.default_rng(1).permutation(d)  # of the motions along radiating_dof
    with netCDF4.Dataset(path, "w") as file:
        sizes = {axis: 5, "wave_direction": 4, "influenced_dof": d, "radiating_dof": d, "complex": 2}
        for name, size in (sizes | {"body": bodies, "space_coordinate": 3}).items():
            file.createDimension(name, size)

        def put(name: str, dims: tuple[str, ...], values: Any) -> None:
            file.createVariable(name, "f8", dims)[...] = values

        for name, labels in (("complex", ("re", "im")), ("influenced_dof", words),
                             ("radiating_dof", [words[k] for k in order])):  # fmt: skip
            file.createVariable(name, str, (name,))[:] = np.array(labels, dtype=object)
        put("omega", (axis,), omega)
        put("wave_direction", ("wave_direction",), HEADINGS)
        for name, value in (("rho", RHO), ("g", G), ("water_depth", DEPTH), ("forward_speed", 0.0)):
            put(name, (), value)
        A = np.stack([MASS_INF, MASS[2], MASS_ZERO, MASS[0], MASS[1]])[:, :d, :d][:, :, order]
        B = np.stack([0 * MASS_INF if n is None else DAMPING[n] for n in place])[:, :d, :d][:, :, order]
        pair = ("influenced_dof", "radiating_dof")
        for name, value in (("added_mass", A), ("radiation_damping", B)):
            if version == 2:
                put(name, (axis, *pair[::-1]), value.swapaxes(1, 2))
            else:
                put(name, (axis, *pair), value)
        for name, part in (("Froude_Krylov_force", True), ("diffraction_force", False)):
            X = amplitudes(-1, incident=part) - (0 if part else amplitudes(-1, incident=True))
            X = np.stack([np.full((4, d), np.nan) if n is None else X[n, :, :d] for n in place])
            X[1] = np.nan if broken else X[1]
            put(name, ("complex", axis, "wave_direction", "influenced_dof"), np.stack([X.real, X.imag]))
        C = both(lambda b: stiffness(REF[b], b, True))[:d, :d]
        put("hydrostatic_stiffness", pair, C[:, order])
        M = np.diag(np.repeat(RHO * V, 6))[:d, :d]
        put("inertia_matrix", pair, M[:, order])
        if version == 3:
            for name, points in (("center_of_buoyancy", CB), ("center_of_mass", CG), ("rotation_center", REF)):
                put(name, ("body", "space_coordinate"), points[:bodies])
            put("disp_mass", ("body",), RHO * V[:bodies])
        else:
            file.createVariable("body_name", str, ())[...] = "+".join(NAMES[:bodies])
    return path


@pytest.mark.parametrize("axis", ["omega", "period"])
def test_capytaine(tmp_path: Path, axis: str) -> None:
    db = read_hydro(write_capytaine(tmp_path / "case.nc", axis=axis))
    same(db, "mean_drift")
    assert db.bodies == NAMES


def test_capytaine_2(tmp_path: Path) -> None:
    path = write_capytaine(tmp_path / "case.nc", version=2)
    with pytest.raises(ModelError, match="does not hold volume, centre_of_buoyancy, centre_of_gravity, reference"):
        read_hydro(path)
    given = {"volume": V.tolist(), "centre_of_buoyancy": CB.tolist(), "centre_of_gravity": CG.tolist()}
    same(read_hydro(path, **given, reference_point=REF.tolist()), "mean_drift")
    write_statics(tmp_path / "statics", 2)
    same(read_hydro(path, hydrostatics=tmp_path / "statics", reference_point=REF.tolist()), "mean_drift")
    one = write_capytaine(tmp_path / "one.nc", version=2, bodies=1)
    given = {"volume": 300.0, "centre_of_buoyancy": CB[0], "centre_of_gravity": CG[0], "reference_point": REF[0]}
    db = read_hydro(one, **given)
    same(db, "mean_drift")
    assert db.bodies == ("float",)
    write_statics(tmp_path / "single", 1)
    assert read_hydrostatics(tmp_path / "single", 1).volume.tolist() == [300.0]


def test_capytaine_files_that_cannot_be_used(tmp_path: Path) -> None:
    path = write_capytaine(tmp_path / "case.nc", broken=True)
    with pytest.raises(ModelError, match=r"missing at 1 frequencies, the first 1\.2 rad/s; .* drop_incomplete=True"):
        read_hydro(path)
    assert read_hydro(path, drop_incomplete=True).omega.tolist() == [0.4, 0.8]
    for change, message in (
        (lambda file: file.renameVariable("diffraction_force", "other"), "does not hold diffraction_force and"),
        (lambda file: file["forward_speed"].assignValue(1.0), "was computed with forward speed"),
        (lambda file: file["influenced_dof"].__setitem__(3, "float__Flap"),
         "influenced_dof must be Surge.*missing: float__Roll; unknown: float__Flap"),
        (lambda file: file.renameVariable("rho", "other"), "does not hold rho; is it a dataset of Capytaine"),
    ):  # fmt: skip
        path = write_capytaine(tmp_path / "case.nc")
        with netCDF4.Dataset(path, "a") as file:
            change(file)
        with pytest.raises(ModelError, match=message):
            read_hydro(path)


# --- BEMIO ----------------------------------------------------------------------------------------


def write_bemio(path: Path, depth: Any = DEPTH, scaled: float = 0.0, buoyancy: str = "cb") -> Path:
    """HDF5, normalised, degrees, e^{+i w t}, about the centres of gravity: REF here; frequencies falling."""
    with netCDF4.Dataset(path, "w") as file:
        def put(place: str, values: Any) -> None:
            if isinstance(values, str):
                file.createVariable(place, str, ())[...] = values
                return
            values = np.asarray(values, dtype=float)
            dims = []
            for size in values.shape:
                dims.append(f"n{size}")
                if dims[-1] not in file.dimensions:
                    file.createDimension(dims[-1], size)
            file.createVariable(place, "f8", dims)[...] = values

        water = "simulation_parameters"
        for name, value in (("scaled", [[scaled]]), ("g", [[G]]), ("rho", [[RHO]]), ("w", OMEGA[::-1, None]),
                            ("wave_dir", np.degrees(HEADINGS)[:, None]),
                            ("water_depth", depth if isinstance(depth, str) else [[depth]])):  # fmt: skip
            put(f"{water}/{name}", value)
        put("bem_data/code", "WAMIT")
        X, F = amplitudes()[::-1] / (RHO * G), amplitudes(incident=True)[::-1] / (RHO * G)
        for b in range(2):
            mine = slice(6 * b, 6 * b + 6)
            body, coeffs = f"body{b + 1}/properties", f"body{b + 1}/hydro_coeffs"
            put(f"{body}/name", NAMES[b])
            put(f"{body}/disp_vol", [[V[b]]])
            put(f"{body}/{buoyancy}", CB[b][:, None])
            put(f"{body}/cg", REF[b][:, None])
            C = stiffness(REF[b], b, False)  # a weight at the reference point does nothing
            put(f"{coeffs}/linear_restoring_stiffness", C / (RHO * G))
            put(f"{coeffs}/added_mass/all", MASS[::-1, mine].transpose(1, 2, 0) / RHO)
            put(f"{coeffs}/added_mass/inf_freq", MASS_INF[mine] / RHO)
            normalised = DAMPING / OMEGA[:, None, None] / RHO
            put(f"{coeffs}/radiation_damping/all", normalised[::-1, mine].transpose(1, 2, 0))
            for part, force in (("", X), ("/froude-krylov", F)):
                put(f"{coeffs}/excitation{part}/re", force[:, :, mine].real.transpose(2, 1, 0))
                put(f"{coeffs}/excitation{part}/im", force[:, :, mine].imag.transpose(2, 1, 0))
            drift = DRIFT[::-1, :, mine].transpose(2, 1, 0) / (RHO * G)
            put(f"{coeffs}/mean_drift/control_surface/val", drift)
            put(f"{coeffs}/mean_drift/momentum_conservation/val", drift + 1.0)
    return path


def test_bemio(tmp_path: Path) -> None:
    db = read_hydro(write_bemio(tmp_path / "case.h5"))
    same(db, "added_mass_zero")
    assert (db.bodies, db.source["solver"]) == (NAMES, "WAMIT, by BEMIO")
    assert read_hydro(write_bemio(tmp_path / "deep.h5", depth="infinite")).depth == math.inf
    moved = read_hydro(tmp_path / "case.h5", reference_point=(REF + [0.0, 0.0, 1.0]).tolist())
    assert moved.reference_point[:, 2].tolist() == [-2.0, -9.0]
    with pytest.raises(ModelError, match="is scaled already"):
        read_hydro(write_bemio(tmp_path / "scaled.h5", scaled=1.0))
    write_bemio(tmp_path / "case.h5", buoyancy="other")
    with pytest.raises(ModelError, match="does not hold 'body1/properties/cb'"):
        read_hydro(tmp_path / "case.h5")


# --- HAMS -----------------------------------------------------------------------------------------

CONTROL = """   --------------HAMS Control file---------------

   Waterdepth  {depth}D0

   #Start Definition of Wave Frequencies
    Input_frequency_type        3
   #End Definition of Wave Frequencies
    Reference_body_center   {x}   {y}   {z}
    Reference_body_length   7.D0
"""


def write_hams(folder: Path, sign: int = 1, early: bool = False, output: int | None = None) -> Path:
    """WAMIT-style files with ULEN = 1; some versions write the conjugate phases. The first column is of kind `output`,
    a period where ControlFile.in says nothing; early versions lack infinite frequency and have other names."""
    k = wave_number(OMEGA, DEPTH, G)
    columns = {1: OMEGA**2 / G, 2: k, 3: OMEGA, 5: 2 * np.pi / k}
    column = columns.get(output or 4, 2 * np.pi / OMEGA)
    limits = (-1.0, 0.0) if output in (None, 4, 5) else (0.0, -1.0)
    (folder / "Input").mkdir(parents=True)
    results = folder / "Output" / "Wamit_format"
    results.mkdir(parents=True)
    (folder / "Settings.ctrl").write_text(f"{G}\n{RHO}\n.\\mesh.gdf\n")
    text = CONTROL.format(depth=DEPTH, x=REF[0, 0], y=REF[0, 1], z=REF[0, 2])
    text += "" if output is None else f"    Output_frequency_type       {output}\n"
    (folder / "Input" / "ControlFile.in").write_text(text)
    m, (x, y, z) = RHO * V[0], CG[0] - REF[0]
    M = np.zeros((6, 6))
    M[:3, :3] = m * np.eye(3)
    M[:3, 3:] = m * np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])  # force per angular acceleration
    M[3:, :3] = M[:3, 3:].T
    blocks = {"Body Mass Matrix": M, "External Damping Matrix": np.zeros((6, 6)),
              "Hydrostatic Restoring Matrix": stiffness(REF[0], 0, True),
              "External Restoring Matrix": np.zeros((6, 6))}  # fmt: skip
    text = " Center of Gravity:\n 0. 0. 0.\n"
    for name, matrix in blocks.items():
        text += f" {name}:\n" + "".join(" ".join(f"{v:.8E}" for v in row) + "\n" for row in matrix)
    (folder / "Input" / "Hydrostatic.in").write_text(text)
    rows = []
    for period, A in () if early else zip(limits, (MASS_ZERO, MASS_INF)):
        rows += [f"{period} {i + 1} {j + 1} {A[i, j] / RHO:.8e}" for i in range(6) for j in range(6)]
    for first, w, A, B in zip(column, OMEGA, MASS, DAMPING):
        rows += [f"{first:.9f} {i + 1} {j + 1} {A[i, j] / RHO:.8e} {B[i, j] / RHO / w:.8e}"
                 for i in range(6) for j in range(6)]  # fmt: skip
    (results / ("AmssDamp.1" if early else "Buoy.1")).write_text("\n".join(rows))
    X = amplitudes(sign) / (RHO * G)
    rows = [f"{first:.9f} {b:.4f} {i + 1} {polar(complex(X[n, m, i]))}" for n, first in enumerate(column)
            for m, b in enumerate(np.degrees(HEADINGS)) for i in range(6)]  # fmt: skip
    (results / ("ExcForce.3" if early else "Buoy.3")).write_text("\n".join(rows))
    return folder


def test_hams(tmp_path: Path) -> None:
    water = {"volume": 300.0, "centre_of_buoyancy": CB[0].tolist()}
    folder = write_hams(tmp_path / "case")
    same(read_hydro(folder, **water), "froude_krylov", "mean_drift")
    same(read_hydro(folder / "Input" / "ControlFile.in", **water), "froude_krylov", "mean_drift")
    control = folder / "Input" / "ControlFile.in"
    control.write_text(control.read_text().replace("40.0D0", "-1.D0"))
    assert read_hydro(folder, **water).depth == math.inf
    (folder / "Settings.ctrl").unlink()
    with pytest.raises(ModelError, match=r"no Settings\.ctrl; give density=\.\.\. and gravity=\.\.\."):
        read_hydro(folder, **water)
    same(replace(read_hydro(folder, **water, density=RHO, gravity=G), depth=DEPTH), "froude_krylov", "mean_drift")
    control.write_text(control.read_text() + "   Number_of_bodies 2\n")
    with pytest.raises(ModelError, match="several bodies; the WAMIT-style files of HAMS-MREL do not tell them apart"):
        read_hydro(folder, **water)


@pytest.mark.parametrize("output", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("sign", [1, -1])
def test_hams_of_other_versions(tmp_path: Path, output: int, sign: int) -> None:
    """Frequencies as wave number (1, 2), rad/s (3), period (4) or length (5); either time factor."""
    folder = write_hams(tmp_path / "case", sign=sign, output=output)
    db = read_hydro(folder, volume=300.0, centre_of_buoyancy=CB[0].tolist())
    same(db, "froude_krylov", "mean_drift")
    assert db.source["phases_conjugated"] == (sign < 0)


def test_hams_files_that_cannot_be_used(tmp_path: Path) -> None:
    water = {"volume": 300.0, "centre_of_buoyancy": CB[0].tolist(), "estimate_added_mass_inf": True}
    folder = write_hams(tmp_path / "case", early=True)
    db = read_hydro(folder, **water)
    np.testing.assert_allclose(db.excitation, amplitudes()[:, :, :6], rtol=1e-6, atol=1.0)
    np.testing.assert_allclose(read_hydro(folder, **water, conjugate=True).excitation, db.excitation.conj())
    with pytest.raises(ModelError, match=r"cannot be told at 0\.4 rad/s; compute longer waves, or say it with conj"):
        read_hydro(folder, **water | {"centre_of_buoyancy": (200.0, -5.0, -2.0)})  # not where it was computed
    (folder / "Input" / "Hydrostatic.in").write_text("Body Mass Matrix:\n1 2 3\n")
    with pytest.raises(ModelError, match="six rows of six numbers below 'Body Mass Matrix:'"):
        read_hydro(folder, **water)
    control = folder / "Input" / "ControlFile.in"
    control.write_text(control.read_text() + "Output_frequency_type 6\n")
    with pytest.raises(ModelError, match="Output_frequency_type is 6, must be 1 to 5"):
        read_hydro(folder, **water)


# --- recognising ----------------------------------------------------------------------------------


def test_own_file_and_unknown_ones(tmp_path: Path) -> None:
    truth().write(tmp_path / "own.nc")
    same(read_hydro(tmp_path / "own.nc"), rtol=2e-6)
    with pytest.raises(ModelError, match="a database of floatsim, whose reader has no option 'depth'; the file holds"):
        read_hydro(tmp_path / "own.nc", depth=3.0)
    with pytest.raises(ModelError, match="there is no such file or folder"):
        read_hydro(tmp_path / "nobody")
    with pytest.raises(ModelError, match="neither Nemoh.cal nor Input/ControlFile.in"):
        read_hydro(tmp_path)
    (tmp_path / "text.nc").write_text("hello")
    with pytest.raises(ModelError, match="not a format that can be read. Known are"):
        read_hydro(tmp_path / "text.nc")
    (tmp_path / "packed.nc.gz").write_bytes(b"\x1f\x8b\x08")
    with pytest.raises(ModelError, match="unpack it first"):
        read_hydro(tmp_path / "packed.nc.gz")
    (tmp_path / "torn.nc").write_bytes(b"CDF\x01\x00")
    with pytest.raises(ModelError, match=r"torn\.nc': cannot be read"):
        read_hydro(tmp_path / "torn.nc")
    with netCDF4.Dataset(tmp_path / "other.nc", "w") as file:
        file.createDimension("x", 1)
    with pytest.raises(ModelError, match="neither a database of floatsim, nor of Capytaine, nor of BEMIO"):
        read_hydro(tmp_path / "other.nc")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"volume": None}, "is WAMIT's numeric output, which does not contain volume: give volume=..."),
        ({"depht": 40.0}, r"whose reader has no option 'depht' \(did you mean 'depth'\?\)"),
        ({"depth": "deep"}, "depth must be a positive number"),
        ({"density": -1.0}, "density must be a positive number"),
        ({"volume": "much"}, "volume must be a number for each of 1 body, got 'much'"),
        ({"bodies": 3}, "bodies must be names, got 3"),
        ({"bodies": ("a", "b", "c")}, "bodies names 3, there are 2 bodies"),
    ],
)
def test_options(tmp_path: Path, changes: dict[str, Any], message: str) -> None:
    options = {key: value for key, value in (wamit_options() | changes).items() if value is not None}
    with pytest.raises(ModelError, match=message):
        read_hydro(write_wamit(tmp_path), **options)


def test_depth_may_be_infinite(tmp_path: Path) -> None:
    assert read_hydro(write_wamit(tmp_path), **wamit_options() | {"depth": "inf"}).depth == math.inf
