"""Mean drift of our own databases, computed with Capytaine (the extra `bem`); without it these tests are skipped."""

from __future__ import annotations

import math

import numpy as np
import piles
import pytest

import floatsim as fs
from floatsim.hydro import compute
from floatsim.hydro.compute import Symmetry, WetBody, compute_database
from floatsim.hydro.far_field import FreeFloating, far_field, group_speed
from floatsim.hydro.meshing import Hydrostatics, boxes, graded, images, profile, rectangle, revolve
from floatsim.sea.dispersion import wave_number
from floatsim.study.hydro_compute import compute_model_database

capytaine = pytest.importorskip("capytaine", reason="needs Capytaine: install floatsim with its extra 'bem'")

RHO, G = 1025.0, 9.81
CHECK = "mean drift of our own databases (far field, Capytaine)"
AROUND = np.radians(np.arange(-180.0, 180.0, 10.0))
BARGE = Symmetry(("xOz", "yOz"))


def barge(size=1.0):
    """One quarter, 20 m x 10 m, draught 4 m; heavier on one side, and a database point that is not on the axis."""
    x, y = graded(0.0, 10.0, size, fine_end=True), graded(0.0, 5.0, size, fine_end=True)
    z = graded(-4.0, 0.0, size, fine_start=True)
    (part,) = boxes([[((0.0, 10.0), (0.0, 5.0), (-4.0, 0.0))]], (x, y, z))
    inside = np.minimum(*(np.abs(part.vertices[part.faces, k]).max(axis=1) for k in (0, 1))) < 1e-9
    return WetBody("barge", part._replace(faces=part.faces[~inside]), (2.0, 1.0, -1.0), rectangle(x, y, -0.3))


def loaded():
    mass = RHO * 800.0
    return FreeFloating(mass, (-1.5, -1.3, 0.5), (mass * 12.0, mass * 40.0, mass * 45.0, 0.0, mass, 0.0))


def test_pile_by_havelock(record):
    """A fixed vertical cylinder through the whole depth, against the closed form."""
    R, depth = 5.0, 20.0
    hull, lid = profile([(R, -depth), (R, 0.0)], 0.8), profile([(0.0, -0.3), (R, -0.3)], 0.8)
    area = math.pi * R**2
    stiffness = np.diag([0.0, 0.0, area, 1e3, 1e3, 0.0])
    still = Hydrostatics(area * depth, np.array([0.0, 0.0, -0.5 * depth]), area, stiffness)
    pile = WetBody("pile", revolve(hull, 40, images=1), (0.0, 0.0, 0.0), revolve(lid, 40, images=1), still)
    omega, headings = np.array([0.5, 0.8, 1.1, 1.4]), np.radians([0.0, 40.0])
    db = compute_database("pile", [pile], omega, headings, depth=depth, symmetry=Symmetry(turns=40), drift="fixed")
    exact = np.array([piles.drift_by_havelock(piles.wave_number(w, depth, G), R, depth, RHO, G) for w in omega])
    along = np.stack([np.cos(headings), np.sin(headings)], axis=1)
    error = np.abs(db.mean_drift[:, :, :2] / exact[:, None, None] - along).max()
    record(CHECK, "bottom-mounted cylinder, kR 0.2 to 1.0, against Havelock (1940)", error, 0.01)
    assert np.abs(db.mean_drift[:, :, 2:]).max() < 1e-6 * exact.max()
    assert db.source["mean_drift_motions"] == "none, held fixed"


def test_radiated_waves_are_those_that_excite(monkeypatch, record):
    """Haskind: s_j(theta) = - k/(4 c_g) i w/(rho g) X_j(theta + pi): potentials on one side, forces on the other."""
    kept = []

    def keep(*a, **k):
        kept.append(far_field(*a, **k))
        return kept[-1]

    monkeypatch.setattr(compute, "far_field", keep)
    omega, depth = np.array([0.5, 0.8, 1.1]), 30.0
    db = compute_database("barge", [barge(0.7)], omega, AROUND, depth=depth, symmetry=BARGE, drift=loaded())
    worst = 0.0
    for w, field, X in zip(omega, kept, db.excitation, strict=True):
        k = float(wave_number(w, depth, G))
        m = np.arange(field.radiated.shape[1]) - field.radiated.shape[1] // 2
        s = field.radiated @ np.exp(1j * np.outer(m, AROUND))
        haskind = -k / (4.0 * group_speed(w, k, depth)) * 1j * w / (RHO * G) * np.roll(X, -AROUND.size // 2, axis=0).T
        worst = max(worst, float((np.abs(s - haskind).max(axis=1) / np.abs(haskind).max(axis=1)).max()))
    record(CHECK, "waves radiated by a barge against its excitation (Haskind), 6 motions", worst, 0.03)
    error = db.source["mean_drift_energy_error"]
    record(CHECK, "energy that a barge takes from the wave against energy sent off", error, 0.05)


def test_symmetry_of_the_hull_with_a_load_that_has_none():
    headings = np.radians([-150.0, -30.0, 30.0, 90.0])
    quarter = compute_database("barge", [barge(1.7)], [0.7, 1.1], headings, depth=30.0, symmetry=BARGE, drift=loaded())
    part, turns = barge(1.7), BARGE.operations()
    whole = part._replace(hull=images(part.hull, turns), lid=images(part.lid, turns))
    full = compute_database("barge", [whole], [0.7, 1.1], headings, depth=30.0, drift=loaded())
    assert quarter.source["headings_solved"] == 2
    for dof in (0, 1, 5):
        scale = np.abs(full.mean_drift[..., dof]).max()
        np.testing.assert_allclose(quarter.mean_drift[..., dof], full.mean_drift[..., dof], atol=1e-3 * scale)


def test_capytaine_s_own_far_field(record):
    """Its Kochin functions of source densities (indirect method) with the motions of its own solution, same formula in
    another form: an oblique wave on a barge loaded on one side; in deep water."""
    from capytaine.post_pro.kochin import compute_kochin
    from capytaine.post_pro.mean_drift_force import far_field_mean_drift_force

    heading, omega = math.radians(30.0), np.array([0.8, 1.1])
    part, turns = barge(), BARGE.operations()
    db = compute_database("barge", [part], omega, [heading], depth=math.inf, symmetry=BARGE, drift=loaded())
    xi = loaded().motions(omega, db.added_mass, db.radiation_damping, db.excitation, db.hydrostatic_stiffness, G)[:, 0]
    mesh = images(part.hull, turns)
    lid = images(part.lid, turns)
    cpt = capytaine
    body = cpt.FloatingBody(mesh=cpt.Mesh(mesh.vertices, mesh.faces), lid_mesh=cpt.Mesh(lid.vertices, lid.faces),
                            dofs=cpt.rigid_body_dofs(rotation_center=part.reference_point))  # fmt: skip
    solver = cpt.BEMSolver(method="indirect")
    theta = np.linspace(0.0, 2.0 * np.pi, 721)
    import xarray as xr

    names = ("Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw")
    waves = np.zeros((2, 7, theta.size), complex)
    for i, w in enumerate(omega):
        sea = {"body": body, "omega": w, "rho": RHO, "g": G, "water_depth": np.inf}
        problems = [cpt.RadiationProblem(radiating_dof=name, **sea) for name in names]
        for j, problem in enumerate([*problems, cpt.DiffractionProblem(wave_direction=heading, **sea)]):
            waves[i, j] = compute_kochin(solver.solve(problem), theta)
    data = xr.Dataset(
        {"kochin_radiation": (("omega", "radiating_dof", "theta"), waves[:, :6]),
         "kochin_diffraction": (("omega", "wave_direction", "theta"), waves[:, 6:]),
         "wavenumber": ("omega", omega**2 / G), "water_depth": np.inf, "rho": RHO, "g": G},
        coords={"omega": omega, "radiating_dof": list(names), "wave_direction": [heading], "theta": theta},
    )  # fmt: skip
    X = xr.DataArray(xi.conj()[:, None, :], dims=("omega", "wave_direction", "radiating_dof"),
                     coords={"omega": omega, "wave_direction": [heading], "radiating_dof": list(names)})  # fmt: skip
    theirs = far_field_mean_drift_force(X, data)
    F = np.stack([theirs[f"drift_force_{name}"].values[:, 0, 0].real for name in ("surge", "sway", "yaw")], axis=1)
    F[:, 2] -= part.reference_point[0] * F[:, 1] - part.reference_point[1] * F[:, 0]
    ours = db.mean_drift[:, 0][:, [0, 1, 5]]
    error = np.abs(ours - F) / np.abs(F).max(axis=0)
    record(CHECK, "barge in an oblique wave: surge, sway against Capytaine's", error[:, :2].max(), 0.05)
    record(CHECK, "barge in an oblique wave: yaw against Capytaine's", error[:, 2].max(), 0.1)


def test_a_model_s_database_carries_it_and_statics_feel_it():
    """`hydro compute` of a moored buoy: without moorings in the motions, with its linear damping; then Newman's."""
    outline = profile([(0.0, -6.0), (4.0, -6.0), (4.0, 3.0), (0.0, 3.0)], 1.3, sharp=[1])
    mesh = revolve(outline, 20)
    hull = fs.Hull(mesh=(mesh.vertices, mesh.faces))
    mass, soft = 240e3, 2e4

    def model(hydro, waves=None):
        body = fs.Body(name="buoy", mass=mass, inertia=(9e6, 9e6, 2e6), center_of_mass=(0.0, 0.0, -4.0), hydro=hydro,
                       points={"side": (0.0, 0.0, -1.0)})  # fmt: skip
        spring = fs.Spring(name="spring", a=(-60.0, 0.0, -1.0), b="buoy.side", stiffness=soft, free_length=10.0)
        return fs.Model(parts=[body, spring], sea=fs.Sea(depth=40.0, waves=waves))

    omega = np.array([0.8, 1.2, 1.6])
    db = compute_model_database(model(hull), omega, [0.0])
    assert db.mean_drift is not None and np.all(db.mean_drift[:, 0, 0] > 0.0)
    assert db.source["mean_drift_mass"] == mass and "without moorings" in db.source["mean_drift_motions"]
    wave = fs.RegularWave(height=2.0, period=2.0 * np.pi / 1.2)
    flows = [fs.PotentialFlow(database=db, hull=hull, drift=drift) for drift in (None, "newman")]
    still, pushed = (fs.solve_static(fs.assemble(model(flow, wave)))[0].x[0, 0] for flow in flows)
    assert soft * (pushed - still) == pytest.approx(db.mean_drift[1, 0, 0], rel=0.02)
