"""Databases to another scale, and the Froude-Krylov part of excitation from their panels, against closed forms."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest
from hulls import box
from scipy.integrate import quad
from shipped import HYDRO

import floatsim as fs
from floatsim.hydro.mean_surface import froude_krylov_of, with_froude_krylov
from floatsim.sea.dispersion import wave_number

RHO, G, L = 1025.0, 9.81, 1.0 / 70.0
SCALED, PANELS = "database to scale 1:70", "Froude-Krylov force from a database's panels"
ARRAYS = ("omega", "added_mass", "radiation_damping", "added_mass_inf", "excitation", "hydrostatic_stiffness", "volume",
          "centre_of_buoyancy", "reference_point", "hull_vertices", "headings")  # fmt: skip


@lru_cache(maxsize=1)
def volturnus() -> fs.HydroDatabase:
    return with_froude_krylov(fs.HydroDatabase.read(HYDRO))


def body(db: fs.HydroDatabase, scale: float = 1.0) -> fs.Body:
    """VolturnUS-S with the mass it displaces, its centre of mass 12 m under the water."""
    mass = db.density * float(db.volume[0])
    time = np.sqrt(scale)
    return fs.Body(name="b", mass=mass, inertia=(mass * (25.0 * scale) ** 2,) * 3,
                   center_of_mass=(0.0, 0.0, -12.0 * scale),
                   hydro=fs.PotentialFlow(database=db, memory=60.0 * time, memory_grid=0.2 * time))  # fmt: skip


def motion(db: fs.HydroDatabase, w: float, k: int) -> np.ndarray:
    """Motion per amplitude (6,) of that body at its frequency number k."""
    m = db.density * float(db.volume[0])
    z, r = db.centre_of_buoyancy[0, 2] * 12.0 / 13.6, 25.0 * db.volume[0] ** (1 / 3) / 27.23
    M = np.diag([m] * 3 + [m * r * r + m * z * z] * 2 + [m * r * r])
    M[0, 4] = M[4, 0] = m * z
    M[1, 3] = M[3, 1] = -m * z
    C = db.hydrostatic_stiffness - np.diag([0, 0, 0, m * G * z, m * G * z, 0])
    C = C + np.diag([1e-3 * m * w * w] * 2 + [0, 0, 0, 1e-3 * m * w * w * r * r])
    return np.linalg.solve(C - w * w * (M + db.added_mass[k]) + 1j * w * db.radiation_damping[k], db.excitation[k, 36])


def test_there_and_back():
    db = volturnus()
    back = db.scaled(L, 1000.0).scaled(1.0 / L, RHO)
    for name in (*ARRAYS, "froude_krylov"):
        np.testing.assert_allclose(getattr(back, name), getattr(db, name), rtol=1e-12, err_msg=name)
    assert back.depth == pytest.approx(db.depth, rel=1e-14) and back.density == RHO and back.gravity == db.gravity
    model = db.scaled(L)
    assert model.density == RHO and model.source["froude_scale"] == pytest.approx(L)
    assert model.depth == pytest.approx(200.0 / 70.0)
    assert float(model.volume[0]) == pytest.approx(20206.35 / 70.0**3, rel=1e-6)


def test_same_response_and_periods_times_root_of_scale(record):
    db = volturnus()
    model = db.scaled(L, 1000.0)
    turn = np.array([1.0] * 3 + [1.0 / L] * 3)
    off = []
    for k in (1, 5, 12, 30):
        a, b = motion(db, db.omega[k], k), motion(model, model.omega[k], k)
        off.append(np.abs(b / turn - a).max() / np.abs(a).max())
    record(SCALED, "motions per wave amplitude at four frequencies, largest difference", max(off), 1e-12)
    periods = []
    for each in (db, model):
        m = each.density * float(each.volume[0])
        periods.append(2.0 * np.pi * np.sqrt((m + each.added_mass_inf[2, 2]) / each.hydrostatic_stiffness[2, 2]))
    record(SCALED, "heave period over the root of the scale, error",
           abs(periods[1] / periods[0] / np.sqrt(L) - 1.0), 1e-12)  # fmt: skip


def test_same_run_in_the_time_domain(record):
    """Both scales in a regular wave, all times scaled: the same motion, step by step."""
    runs = []
    for db, scale in ((volturnus(), 1.0), (volturnus().scaled(L, 1000.0), L)):
        time = np.sqrt(scale)
        wave = fs.RegularWave(height=4.0 * scale, period=10.0 * time, heading_deg=20.0)
        sea = fs.Sea(depth=db.depth, density=db.density, waves=wave, wave_ramp=10.0 * time)
        run = fs.simulate(fs.Model(parts=[body(db, scale)], sea=sea), 40.0 * time, 0.2 * time)
        runs.append(run.series("b_position") / np.array([scale] * 3 + [1.0] * 3))
    record(SCALED, "run in a regular wave, difference over the largest motion",
           np.abs(runs[1] - runs[0]).max() / np.abs(runs[0]).max(), 1e-6)  # fmt: skip


def test_bad_scales():
    for length, density, text in ((0.0, None, "length is 0.0"), (-1.0, None, "length is -1.0"),
                                  (np.nan, None, "length is nan"), (L, 0.0, "density is 0.0")):  # fmt: skip
        with pytest.raises(fs.ModelError, match=text):
            volturnus().scaled(length, density)


# --- from panels ----------------------------------------------------------------------------------------

SIDES, DEPTH = (30.0, 20.0, 8.0), 40.0  # m; the last: draught
OMEGA, HEADINGS = np.linspace(0.1, 1.2, 8), np.radians([-135.0, 0.0, 30.0, 90.0])


def boxes(places: list[tuple[float, float]], n: int, depth: float = DEPTH, **changes) -> fs.HydroDatabase:
    """Database of boxes with these middles; only what panels and volume say is right in it."""
    x, y, z = SIDES
    vertices, faces, owner = [], [], []
    corners, panels = box(x, y, 2.0 * z, (3 * n, 2 * n, 2 * n))
    wet = panels[(corners[panels, 2] <= 1e-9).all(axis=1)]
    for k, place in enumerate(places):
        faces.append(np.column_stack([wet, wet[:, 2]]) + k * len(corners))
        vertices.append(corners + (*place, 0.0))
        owner.append(np.full(len(wet), k))
    N, d = len(places), 6 * len(places)
    values = {
        "name": "boxes", "bodies": [f"box_{k}" for k in range(N)], "omega": OMEGA, "headings": HEADINGS,
        "added_mass": np.zeros((8, d, d)), "radiation_damping": np.zeros((8, d, d)), "added_mass_inf": np.zeros((d, d)),
        "excitation": np.zeros((8, 4, d)), "hydrostatic_stiffness": np.zeros((d, d)), "volume": [x * y * z] * N,
        "centre_of_buoyancy": [(*place, -0.5 * z) for place in places], "depth": depth, "density": RHO, "gravity": G,
        "reference_point": [(*place, 0.5) for place in places], "hull_vertices": np.concatenate(vertices),
        "hull_faces": np.concatenate(faces), "hull_body": np.concatenate(owner),
    }  # fmt: skip
    return fs.HydroDatabase(**values | changes)


def box_force(w: float, heading: float, depth: float) -> np.ndarray:
    """X (6,) of the box about (0, 0, 0.5): pressure integrated over its sides in closed form, over z by quadrature."""
    x, y, draught = SIDES
    k = float(wave_number(np.array([w]), depth, G)[0])
    kx, ky = k * np.cos(heading), k * np.sin(heading)

    def decay(z: float) -> float:
        return np.exp(k * z) if np.isinf(depth) else np.cosh(k * (z + depth)) / np.cosh(k * depth)

    def even(q: float, side: float) -> float:  # int e^{-i q s} ds
        return side * np.sinc(q * side / (2.0 * np.pi))

    def odd(q: float, side: float) -> complex:  # int s e^{-i q s} ds
        a = 0.5 * side
        return 0.0 if abs(q) < 1e-12 else -2j * (np.sin(q * a) / q**2 - a * np.cos(q * a) / q)

    F, S = (quad(lambda z, p=p: decay(z) * (z - 0.5) ** p, -draught, 0.0, epsabs=1e-12)[0] for p in (0, 1))
    bottom, side_x, side_y = decay(-draught), 2j * np.sin(0.5 * kx * x), 2j * np.sin(0.5 * ky * y)
    force = [
        side_x * even(ky, y) * F, side_y * even(kx, x) * F, bottom * even(kx, x) * even(ky, y),
        bottom * even(kx, x) * odd(ky, y) - side_y * even(kx, x) * S,
        side_x * even(ky, y) * S - bottom * odd(kx, x) * even(ky, y),
        F * (side_y * odd(kx, x) - side_x * odd(ky, y)),
    ]  # fmt: skip
    return RHO * G * np.array(force)


@pytest.mark.parametrize("depth", [DEPTH, np.inf])
def test_box_in_closed_form(record, depth):
    want = np.array([[box_force(w, b, depth) for b in HEADINGS] for w in OMEGA])
    scale = np.abs(want).max(axis=(0, 1))
    errors = [np.abs((froude_krylov_of(boxes([(0.0, 0.0)], n, depth)) - want) / scale).max() for n in (2, 4)]
    assert errors[1] < errors[0] / 8.0  # fourth order of the panels' size
    record(PANELS, f"box of 512 triangles against the closed form, depth {depth:g} m, error over the peak",
           errors[1], 1e-3)  # fmt: skip


def test_second_body_has_its_own_phase_and_reference_point():
    place = (70.0, -25.0)
    X = froude_krylov_of(boxes([(0.0, 0.0), place], 1))
    k = wave_number(OMEGA, DEPTH, G)[:, None]
    phase = np.exp(-1j * k * (place[0] * np.cos(HEADINGS) + place[1] * np.sin(HEADINGS)))
    np.testing.assert_allclose(X[..., 6:], X[..., :6] * phase[..., None], atol=1e-9 * np.abs(X).max())


def test_volturnus_in_long_waves(record):
    """At 0.05 rad/s pressure changes evenly over the hull: waterplane and volume say all of heave and surge."""
    db = volturnus()
    k = float(wave_number(db.omega[:1], db.depth, G)[0])
    z, h, V = db.centre_of_buoyancy[0, 2], db.depth, float(db.volume[0])
    heave = db.hydrostatic_stiffness[2, 2] - RHO * G * V * k * np.sinh(k * (z + h)) / np.cosh(k * h)
    surge = 1j * RHO * G * V * k * np.cosh(k * (z + h)) / np.cosh(k * h)
    X = db.froude_krylov[0, np.argmin(np.abs(db.headings))]
    record(PANELS, "VolturnUS-S, 0.05 rad/s: heave against waterplane and volume", abs(X[2] / heave - 1.0), 2e-3)
    record(PANELS, "VolturnUS-S, 0.05 rad/s: surge against the volume", abs(X[0] / surge - 1.0), 2e-3)


def test_against_capytaine(record):
    """The absorber's database has Capytaine's, one point a panel."""
    db = fs.HydroDatabase.read(HYDRO.with_name("waves4power_hydro.nc"))
    some = slice(None, 60)  # up to 3 rad/s: panels of 0.6 m are short against waves
    off = np.abs(froude_krylov_of(db) - db.froude_krylov)[some].max(axis=(0, 1))[:5]
    record(PANELS, "absorber of 4608 panels against Capytaine, largest difference over the peak",
           float((off / np.abs(db.froude_krylov)[..., :5].max(axis=(0, 1))).max()), 0.01)  # fmt: skip


def test_a_hull_finds_the_part_it_replaces():
    db = boxes([(0.0, 0.0)], 1, reference_point=[(0.0, 0.0, 0.0)])
    flow = fs.PotentialFlow(database=db, hull=fs.Hull(mesh=box(*SIDES[:2], 16.0, (2, 2, 2))))
    np.testing.assert_allclose(flow.data.froude_krylov, froude_krylov_of(db))
    assert fs.PotentialFlow(database=db).data is db and with_froude_krylov(flow.data) is flow.data
    with pytest.raises(fs.ModelError, match="does not have the Froude-Krylov part"):
        fs.PotentialFlow(database=boxes([(0.0, 0.0)], 1, hull_faces=None), hull=flow.hull)


def test_panels_that_are_not_the_hull():
    with pytest.raises(fs.ModelError, match="has no panels"):
        froude_krylov_of(boxes([(0.0, 0.0)], 1, hull_vertices=None))
    faces = boxes([(0.0, 0.0)], 1).hull_faces
    with pytest.raises(fs.ModelError, match=r"enclose -4800 m3 below the waterline, it displaces 4800 m3"):
        froude_krylov_of(boxes([(0.0, 0.0)], 1, hull_faces=faces[:, ::-1]))
