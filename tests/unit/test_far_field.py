"""Mean drift from the waves far away, against closed forms of a vertical cylinder; nothing here needs a BEM solver."""

from __future__ import annotations

import math

import hulls
import numpy as np
import pytest
from piles import drift_by_havelock, drift_by_pressure, scattered
from scipy.special import h2vp, hankel2, jvp

import floatsim as fs
from floatsim.errors import ModelError
from floatsim.hydro.check import check_database
from floatsim.hydro.compute import WetBody, _image, compute_database
from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.far_field import (
    FarField,
    FreeFloating,
    far_field,
    mean_drift,
    momentum,
    panel_points,
    turned,
)
from floatsim.hydro.meshing import revolve
from floatsim.sea.dispersion import wave_number
from floatsim.study import hydro_compute

RHO, G, R = 1025.0, 9.81, 5.0
TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def drift_of(c: np.ndarray, heading: float, omega: float, k: float, depth: float, point=(0.0, 0.0, 0.0)) -> np.ndarray:
    fields = [(np.zeros((6, c.size), complex), c[None])] * 2
    got, error = mean_drift(fields, np.zeros((2, 1, 6), complex), np.array([heading]), point, omega=np.full(2, omega),
                            k=np.full(2, k), depth=depth, density=RHO, gravity=G)  # fmt: skip
    assert error < 1e-9  # what the wave loses forward is what is sent away all round
    return got[0, 0]


@pytest.mark.parametrize("depth", [math.inf, 30.0, 6.0])
@pytest.mark.parametrize("kR", [0.05, 0.4, 1.0, 2.3, 6.0])
def test_cylinder_by_havelock_and_by_pressure(kR, depth):
    k = kR / R
    omega = math.sqrt(G * k * math.tanh(min(k * depth, 300.0)))
    F = drift_of(scattered(kR), 0.0, omega, k, depth)
    assert F[0] == pytest.approx(drift_by_havelock(k, R, depth, RHO, G), rel=1e-10)
    assert F[0] == pytest.approx(drift_by_pressure(k, R, depth, RHO, G), rel=1e-8)
    np.testing.assert_allclose(F[1:], 0.0, atol=1e-9 * F[0])


def test_short_waves_are_reflected_and_long_ones_pass():
    """1/2 rho g a^2 int cos^2 ... along the lit side: 2/3 rho g a^2 R in short waves (Faltinsen 1990, figure 5.17);
    in long ones 5/16 pi^2 rho g a^2 R (kR)^3 (Havelock 1940)."""
    short = drift_of(scattered(200.0), 0.0, math.sqrt(G * 40.0), 40.0, math.inf)[0]
    assert short / (RHO * G * R) == pytest.approx(2.0 / 3.0, rel=0.01)
    long = drift_of(scattered(1e-3), 0.0, math.sqrt(G * 2e-4), 2e-4, math.inf)[0]
    assert long / (RHO * G * R * 1e-9) == pytest.approx(5.0 / 16.0 * np.pi**2, rel=1e-3)


def test_force_goes_with_the_waves_and_turns_a_cylinder_that_stands_off():
    k, heading, at = 0.2, math.radians(35.0), (1.6, -0.7)
    omega = math.sqrt(G * k)
    size = drift_by_havelock(k, R, math.inf, RHO, G)
    F = drift_of(scattered(k * R, heading, at), heading, omega, k, math.inf)
    np.testing.assert_allclose(F[:2], size * np.array([math.cos(heading), math.sin(heading)]), rtol=1e-8)
    assert F[5] == pytest.approx(R * (at[0] * F[1] - at[1] * F[0]), rel=1e-8)  # M = d x F about the origin
    about_it = drift_of(scattered(k * R, heading, at), heading, omega, k, math.inf, (R * at[0], R * at[1], 0.0))
    assert abs(about_it[5]) < 1e-8 * abs(F[5])


def test_images_of_a_wave():
    c = scattered(1.2, math.radians(35.0), (1.6, -0.7))
    np.testing.assert_allclose(turned(c, TURN), scattered(1.2, math.radians(125.0), (0.7, 1.6)), atol=1e-9)
    np.testing.assert_allclose(turned(c, np.diag([1.0, -1.0, 1.0])), scattered(1.2, math.radians(-35.0), (1.6, 0.7)),
                               atol=1e-9)  # fmt: skip


def test_moments_of_an_image_are_about_the_body_s_own_point():
    """A force on a point of a body, mirrored with the wave: the moment about a point off the plane that stays."""
    at, force, about = np.array([3.0, 1.0, -2.0]), np.array([1.0, -2.0, 5.0]), np.array([2.0, 1.5, -1.0])
    for q in (np.diag([1.0, -1.0, 1.0]), TURN):
        given = np.concatenate([force, np.cross(at - about, force)]) + 0j
        wanted = np.concatenate([q @ force, np.cross(q @ at - about, q @ force)])
        np.testing.assert_allclose(_image(given, q, about[None]), wanted, atol=1e-12)


def test_energy_that_damping_takes_pushes_along_the_wave():
    """A body that absorbs in its two lowest harmonics: E = int |S|^2 + absorbed, found from the forward shadow."""
    c = 0.5 * scattered(1.0)  # S/2: the shadow is half, the waves sent away a quarter
    lost = 2.0 * np.pi * np.sum(np.abs(c) ** 2)
    taken, E, shadow = momentum(c, 0.0, 0.2, absorbed=lost)
    assert shadow == pytest.approx(2.0 * lost, rel=1e-9) and pytest.approx(E) == shadow
    alone = momentum(c, 0.0, 0.2)[0]
    np.testing.assert_allclose(taken - alone, [lost, 0.0, 0.0], atol=1e-12)


# --- from potentials on panels ------------------------------------------------------------------------


def wall(depth: float, around: int = 90) -> np.ndarray:
    z = np.linspace(-depth, 0.0, round(depth / 0.4) + 1)
    mesh = revolve(np.column_stack([np.full(z.size, R), z]), around)
    return mesh.vertices[mesh.faces]


def test_panels_integrate_the_normal():
    x, n = panel_points(wall(8.0))
    assert np.einsum("qgi,qgi->", x[..., :2], n[..., :2]) / 2.0 == pytest.approx(np.pi * R**2 * 8.0, rel=1e-9)


@pytest.mark.parametrize("depth", [8.0, 24.0])
def test_waves_scattered_by_a_cylinder_of_panels(depth):
    k, headings = 0.25, np.radians([-120.0, 0.0])
    omega = math.sqrt(G * k * math.tanh(k * depth))
    corners = wall(depth)
    x = corners.mean(axis=1)
    theta, r = np.arctan2(x[:, 1], x[:, 0]), R
    m = np.arange(-25, 26)
    radial = -jvp(np.abs(m), k * R) / h2vp(np.abs(m), k * R) * hankel2(np.abs(m), k * r) * (-1j) ** np.abs(m)
    fade = np.cosh(k * (x[:, 2] + depth)) / math.cosh(k * depth)
    phi = np.array([1j * G / omega * fade * (np.exp(1j * np.outer(theta - b, m)) @ radial) for b in headings])
    still = np.zeros((6, len(x)), complex)
    field = far_field(corners, np.concatenate([still, phi]), headings, (0.0, 0.0, 0.0), omega=omega, k=k, depth=depth,
                      gravity=G)  # fmt: skip
    assert isinstance(field, FarField)
    for got, b in zip(field.scattered, headings, strict=True):
        exact = scattered(k * R, b)
        exact = exact[(exact.size - got.size) // 2 : (exact.size + got.size) // 2]
        np.testing.assert_allclose(got, exact, atol=0.004 * np.abs(exact).max())


def test_waves_radiated_by_a_cylinder_that_shakes():
    """Wave maker through the whole depth in surge: only the propagating mode reaches far. Dean and Dalrymple (1991),
    Water Wave Mechanics, 6.5: phi_n = i w cos theta projected on cosh k(z + h)."""
    k, depth = 0.25, 8.0
    omega = math.sqrt(G * k * math.tanh(k * depth))
    kh = k * depth
    N = (0.5 * depth + math.sinh(2.0 * kh) / (4.0 * k)) / math.cosh(kh) ** 2  # int of the profile squared
    share = math.tanh(kh) / k / N  # of a uniform velocity
    corners = wall(depth)
    x = corners.mean(axis=1)
    theta = np.arctan2(x[:, 1], x[:, 0])
    fade = np.cosh(k * (x[:, 2] + depth)) / math.cosh(kh)
    # evanescent modes are left out of the potential: their integral with the progressive wave is nothing
    phi = 1j * omega * share / (k * h2vp(1, k * R)) * hankel2(1, k * R) * fade * np.cos(theta)
    potential = np.zeros((6, len(x)), complex)
    potential[0] = phi
    field = far_field(corners, potential, np.zeros(0), (0.0, 0.0, 0.0), omega=omega, k=k, depth=depth, gravity=G)
    # far away H_1 -> i sqrt(2/(pi k r)) e^{-i(kr - pi/4)}, and phi = i g/w times what the elevation is
    amplitude = omega / (1j * G) * 1j * omega * share / (k * h2vp(1, k * R)) * 1j
    middle = field.radiated.shape[1] // 2
    np.testing.assert_allclose(field.radiated[0, [middle - 1, middle + 1]], 0.5 * amplitude, rtol=0.004)
    rest = np.delete(field.radiated[0], [middle - 1, middle + 1])
    assert np.abs(rest).max() < 1e-6 * abs(amplitude)


# --- motions, and what is refused -------------------------------------------------------------------


def test_motions_of_a_free_body():
    """A slack body that pitches about its centre of mass below the reference point: textbook one by one."""
    m, z, J = 2e6, -4.0, (3e7, 4e7, 5e7)
    free = FreeFloating(m, (0.0, 0.0, z), J)
    M = free.matrix
    assert M[0, 4] == pytest.approx(m * z) and M[1, 3] == pytest.approx(-m * z)
    assert M[4, 4] == pytest.approx(J[1] + m * z**2)
    omega, zero = np.array([0.7, 0.9]), np.zeros((2, 6, 6))
    C = np.diag([0.0, 0.0, 5e6, 1e8, 1e8, 0.0])
    X = np.zeros((2, 1, 6), complex)
    X[:, 0, 2], X[:, 0, 4] = 1e6, 1e7  # heave, and a couple in pitch
    xi = free.motions(omega, zero, zero, X, C, G)[:, 0]
    np.testing.assert_allclose(xi[:, 2], 1e6 / (5e6 - omega**2 * m), rtol=1e-12)
    pitch = 1e7 / (1e8 - m * G * z - omega**2 * J[1])  # a couple turns a body with free surge about its centre
    np.testing.assert_allclose(xi[:, 4], pitch, rtol=1e-12)
    np.testing.assert_allclose(xi[:, 0], -z * pitch, rtol=1e-12)


def test_a_damped_body_and_what_the_database_says_of_it():
    damped = FreeFloating(2.0, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), damping=np.diag([0.0, 0.0, 3.0, 0.0, 0.0, 0.0]))
    zero, X = np.zeros((2, 6, 6)), np.zeros((2, 1, 6), complex)
    X[:, 0, 2] = 6.0
    xi = damped.motions(np.array([1.0, 2.0]), zero, zero, X, np.diag([0.0, 0.0, 5.0, 50.0, 50.0, 0.0]), G)
    np.testing.assert_allclose(xi[:, 0, 2], [6.0 / (3.0 + 3.0j), 6.0 / (-3.0 + 6.0j)], rtol=1e-12)
    said = damped.attributes()
    assert said["mean_drift_motions"] == "free floating, without moorings, damped" and said["mean_drift_mass"] == 2.0
    assert said["mean_drift_damping"][14] == 3.0 and said["mean_drift_inertia"] == [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]


def test_check_says_what_the_drift_is_and_finds_one_against_the_waves():
    def judged(D):
        unit = np.tile(np.eye(6), (2, 1, 1))
        db = HydroDatabase(
            name="hull", omega=np.array([0.5, 1.0]), headings=np.zeros(1), added_mass=unit, radiation_damping=unit,
            added_mass_inf=np.eye(6), excitation=np.zeros((2, 1, 6), complex), mean_drift=D, volume=1.0,
            hydrostatic_stiffness=np.eye(6), centre_of_buoyancy=np.zeros(3), reference_point=np.zeros(3), depth=40.0,
            density=RHO, gravity=G, source={"mean_drift_motions": "free floating"},
        )  # fmt: skip
        return [f for f in check_database(db) if f.quantity == "mean drift"]

    D = np.zeros((2, 1, 6))
    D[:, 0, 0] = 10.0, 500.0
    (good,) = judged(D)
    assert good.severity == "ok" and "500" in good.message and "free floating" in good.message
    (bad,) = judged(-D)
    assert bad.severity == "warning" and "against the waves" in bad.message and "1 rad/s" in bad.message
    assert judged(None) == []


def one_buoy(*joints, more=()):
    hull = fs.Hull(mesh=hulls.cylinder(4.0, -6.0, 6.0, 12, 3))
    body = fs.Body(name="buoy", mass=2e5, inertia=(2e6, 3e6, 1e6), center_of_mass=(1.0, 0.0, -4.0), hydro=hull,
                   points={"keel": (0.0, 0.0, -6.0)})  # fmt: skip
    return fs.Model(parts=[body, *more], joints=joints, sea=fs.Sea(depth=40.0)), body


def test_a_model_s_body_is_afloat_without_moorings():
    rope = fs.Section(name="rope", mass_per_length=10.0, diameter=0.1, EA=1e7)
    line = fs.Line(name="line", section=rope, length=60.0, elements=4)
    ends = (fs.Ball(a="line.end_a", b=(40.0, 0.0, -40.0)), fs.Ball(a="line.end_b", b="buoy.keel"))
    model, body = one_buoy(*ends, more=[line])
    assert hydro_compute._no_drift(model, [body]) == []
    afloat = hydro_compute._afloat(body, [0.0, 10.0, 0.0])
    c, s = math.cos(math.radians(10.0)), math.sin(math.radians(10.0))
    np.testing.assert_allclose(afloat.center_of_mass, [c - 4.0 * s, 0.0, -s - 4.0 * c], rtol=1e-12)
    assert afloat.mass == 2e5 and afloat.tensor[0, 0] == pytest.approx(2e6 * c**2 + 1e6 * s**2)
    assert afloat.problems() == []


def test_what_holds_a_body_leaves_the_drift_out():
    model, body = one_buoy(fs.Hinge(a="buoy.keel", b=(0.0, 0.0, -6.0), axis=(0.0, 1.0, 0.0), name="pin"))
    (text,) = hydro_compute._no_drift(model, [body])
    assert "'pin'" in text and "no mean drift" in text
    (text,) = hydro_compute._no_drift(model, [body, body])
    assert "all bodies together" in text


def made_of(drift, **more):
    ball = WetBody("ball", revolve(np.array([[0.0, -1.0], [1.0, -1.0], [1.0, 0.0]]), 12), (0.0, 0.0, 0.0))
    bodies = more.pop("bodies", [ball])
    return compute_database("ball", bodies, [1.0, 2.0], depth=math.inf, drift=drift)


@pytest.mark.parametrize(("drift", "message"), [
    ("free", "'free'"),
    (FreeFloating(-1.0, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), "mass"),
    (FreeFloating(1.0, (0.0, 0.0), (1.0, 1.0, 1.0)), "center_of_mass"),
    (FreeFloating(1.0, (0.0, 0.0, 0.0), (1.0, 1.0, -1.0)), "inertia"),
    (FreeFloating(1.0, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), damping=np.eye(3)), "damping"),
    (FreeFloating(1.0, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), damping=-np.eye(6)), "feeds energy in"),
    (FreeFloating(1.0, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), stiffness=np.full((6, 6), np.nan)), "stiffness"),
    (FreeFloating("heavy", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), "heavy"),
])  # fmt: skip
def test_refusals(monkeypatch, drift, message):
    monkeypatch.setattr("floatsim.hydro.compute.load_capytaine", lambda: None)
    with pytest.raises(ModelError, match=message):
        made_of(drift)


def test_two_bodies_are_refused(monkeypatch):
    monkeypatch.setattr("floatsim.hydro.compute.load_capytaine", lambda: None)
    one = WetBody("one", revolve(np.array([[0.0, -1.0], [1.0, -1.0], [1.0, 0.0]]), 12), (0.0, 0.0, 0.0))
    two = one._replace(name="two", hull=one.hull._replace(vertices=one.hull.vertices + (4.0, 0.0, 0.0)))
    with pytest.raises(ModelError, match="all 2 bodies together"):
        made_of("fixed", bodies=[one, two])


def test_a_database_of_a_cylinder_has_the_drift(tmp_path):
    """Written, read and used: shapes, units and axes are those that Newman's approximation takes."""
    omega, headings, depth = np.array([0.8, 1.2]), np.radians([-90.0, 0.0]), 40.0
    k = wave_number(omega, depth, G)
    waves = [np.array([scattered(q * R, b) for b in headings]) for q in k]
    fields = [(np.zeros((6, c.shape[1]), complex), c) for c in waves]
    D, _ = mean_drift(fields, np.zeros((2, 2, 6), complex), headings, (0.0, 0.0, 0.0), omega=omega, k=k, depth=depth,
                      density=RHO, gravity=G)  # fmt: skip
    unit = np.tile(np.eye(6), (2, 1, 1))
    db = HydroDatabase(
        name="pile", omega=omega, headings=headings, added_mass=unit, radiation_damping=unit, added_mass_inf=np.eye(6),
        excitation=np.zeros((2, 2, 6), complex), mean_drift=D, hydrostatic_stiffness=np.eye(6), volume=1.0,
        centre_of_buoyancy=np.zeros(3), reference_point=np.zeros(3), depth=depth, density=RHO, gravity=G,
    )  # fmt: skip
    db.write(tmp_path / "pile.nc")
    back = HydroDatabase.read(tmp_path / "pile.nc").mean_drift
    F = [drift_by_havelock(q, R, depth, RHO, G) for q in k]
    np.testing.assert_allclose(back[:, 0, 1], -np.array(F), rtol=1e-6)
    np.testing.assert_allclose(back[:, 1, 0], F, rtol=1e-6)
    assert np.abs(back[:, 1, 1:]).max() < 1e-6 * F[0]
