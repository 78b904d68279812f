"""The frequency domain against a floater's own solution, closed forms and the time domain."""

import numpy as np
import pytest
from shipped import HYDRO, load
from test_floater import DEPTH, MOORING, RHO, floater, frequency_domain, wave_damping

import floatsim as fs
from floatsim.hydro import meshing
from floatsim.sea.dispersion import wave_number

ROW = "frequency domain: linear floater against its own solution"
ROW_TIME = "frequency domain against time domain in small waves"
ROW_DRAG = "frequency domain: stochastic linearisation"


@pytest.fixture(scope="module")
def db() -> fs.HydroDatabase:
    return fs.HydroDatabase.read(HYDRO)


def moored(db, **flow):  # type: ignore[no-untyped-def]
    body = floater(db, linear_stiffness=MOORING, linear_damping=wave_damping(db), **flow)
    return fs.Model(parts=[body], sea=fs.Sea(depth=DEPTH, density=RHO))


def test_linear_floater(db, record):
    """6 x 6 by hand from the tables, at the database's own frequencies, in oblique waves."""
    omega = np.array([0.2, 0.35, 0.6, 0.9, 1.2])
    response = fs.frequency_response(moored(db), omega, heading_deg=30.0)
    got = response.rao("floater_position")
    want = np.array([frequency_domain(db, w, 30.0) for w in omega])
    record(ROW, "largest error of a RAO over the largest of its kind", _error(got, want), 1e-6)
    velocity = response.rao("floater_velocity")
    np.testing.assert_allclose(velocity, 1j * omega[:, None] * want, rtol=1e-4, atol=1e-6 * np.abs(velocity).max())
    assert response.rao("wave_elevation") == pytest.approx(np.ones(5))


def _error(got, want):  # type: ignore[no-untyped-def]
    worst = 0.0
    for kind in (slice(0, 3), slice(3, 6)):
        worst = max(worst, float(np.abs(got[:, kind] - want[:, kind]).max() / np.abs(want[:, kind]).max()))
    return worst


def test_quadratic_damping_of_heave(db, record):
    """B |v| v is sqrt(8/pi) sigma B v in Gaussian motion, sigma the response's own: the fixed point by hand."""
    omega, B = np.arange(0.1, 2.01, 0.05), 3e7
    spectrum = fs.Jonswap(hs=8.0, tp=20.0)
    S, dw = spectrum.density(omega), 0.05
    model = moored(db, quadratic_damping=np.diag([0.0, 0.0, B, 0.0, 0.0, 0.0]).tolist())
    response = fs.frequency_response(model, omega, spectrum=spectrum)
    A, b, X = db.added_mass[1:40, 2, 2], db.radiation_damping[1:40, 2, 2], db.excitation[1:40, :, 2]
    X = X[:, int(np.argmin(np.abs(db.headings)))]
    C, own = db.hydrostatic_stiffness[2, 2] + MOORING[2, 2], wave_damping(db)[2, 2]
    sigma = 0.0
    for _ in range(200):
        damping = b + own + np.sqrt(8.0 / np.pi) * sigma * B
        z = X / (-(omega**2) * (RHO * db.volume[0] + A) + 1j * omega * damping + C)
        sigma = float(np.sqrt(np.sum(S * np.abs(omega * z) ** 2) * dw))
    undamped = fs.frequency_response(moored(db), omega, spectrum=spectrum).std("floater_velocity")[2]
    assert sigma < 0.8 * undamped  # the drag matters
    got = float(np.sqrt(np.sum(S * np.abs(response.rao("floater_velocity")[:, 2]) ** 2) * dw))
    error = 100.0 * abs(got / sigma - 1.0)
    record(ROW_DRAG, "heave velocity with B|v|v against the fixed point by hand: error", error, 1.0, "%")


def test_standard_deviation_is_the_integral(db):
    omega = np.arange(0.1, 2.01, 0.1)
    sea = fs.Jonswap(hs=2.0, tp=10.0)
    response = fs.frequency_response(moored(db), omega, spectrum=sea, channels=["floater_position", "wave_elevation"])
    S = sea.density(omega)
    assert response.std("wave_elevation") == pytest.approx(np.sqrt(np.trapezoid(S, omega)), rel=1e-12)
    heave = np.abs(response.rao("floater_position")[:, 2]) ** 2 * S
    assert response.std("floater_position")[2] == pytest.approx(np.sqrt(np.trapezoid(heave, omega)), rel=1e-12)
    data = response.dataset()
    assert data.floater_position_amplitude.dims == ("omega", "dof")
    assert data.floater_position_std.values[2] == pytest.approx(response.std("floater_position")[2])


COUNT, LAST = np.array([16, 20, 24, 34, 44]), 200.0  # periods that divide 200 s
PHASE = np.array([0.0, 100.0, 200.0, 300.0, 50.0])  # deg


def amplitudes(name: str, a: float, tolerance: float) -> np.ndarray:
    """Complex response (5, ...) of a channel per metre of wave, from a run in five waves of amplitude a [m], after a
    ramp so long that nothing rings."""
    omega = 2.0 * np.pi * COUNT / LAST
    waves = fs.WaveComponents(amplitude=[a] * 5, omega=omega.tolist(), phase_deg=PHASE.tolist())
    model = load("volturnus_s").build(waves=waves)
    sea = model.sea.model_copy(update={"wave_ramp": 500.0})
    run = fs.simulate(model.model_copy(update={"sea": sea}), 900.0, 0.1, channels=[name], tolerance=tolerance)
    kept = run.time > 900.0 - LAST + 1e-6
    y = run.series(name)[kept]
    basis = np.exp(-1j * (np.outer(omega, run.time[kept]) + np.radians(PHASE)[:, None]))
    return np.asarray(2.0 / len(y) * basis @ (y - y.mean(axis=0)) / a)


@pytest.mark.slow
def test_volturnus_in_small_waves(record):
    """The waves keep clear of 0.81 rad/s, where a mode of the chains resonates that only drag damps.

    Drag is not linear however small the wave: what it does to the fairlead force falls with the amplitude, 1.5 % of
    the first wave's at 1 cm and 0.2 % at 1 mm, so that forces are compared at 1 mm."""
    omega = 2.0 * np.pi * COUNT / LAST
    names = ["platform_position", "mooring_1_end_b_force"]
    response = fs.frequency_response(load("volturnus_s").build(), omega, channels=names)
    got, want = amplitudes(names[0], 0.01, 1e-9), response.rao(names[0])
    for kind, of in ((slice(0, 3), "translations"), (slice(3, 6), "rotations")):
        significant = np.abs(want[:, kind]) > 0.05 * np.abs(want[:, kind]).max()
        error = np.abs(got[:, kind] / want[:, kind] - 1.0)[significant].max()
        record(ROW_TIME, f"VolturnUS-S, {of}, complex amplitude: largest error", 100.0 * error, 1.0, "%")
    got, want = amplitudes(names[1], 0.001, 1e-10), response.rao(names[1])
    error = (np.linalg.norm(got - want, axis=1) / np.linalg.norm(want, axis=1)).max()
    record(ROW_TIME, "VolturnUS-S, fairlead force, complex vector: largest error", 100.0 * error, 2.0, "%")


SPAR = dict(mass=1025.0 * np.pi * 9.0 * 20.0, inertia=(3e8, 3e8, 3e6), center_of_mass=(0.0, 0.0, -12.0))


def spar(kind: str) -> fs.Body:
    """A cylinder of 3 m radius and 20 m draught, its water by a mesh or by Morison's formula; 5 m freeboard."""
    if kind == "hull":
        profile = meshing.profile([(0.0, -20.0), (3.0, -20.0), (3.0, 5.0), (0.0, 5.0)], 1.0)
        mesh = meshing.revolve(profile, 24)
        load: object = fs.Hull(mesh=(mesh.vertices, mesh.faces))
    else:
        load = fs.Member(a=(0.0, 0.0, -20.0), b=(0.0, 0.0, 5.0), diameter=6.0, drag_normal=1.0, added_mass_normal=1.0,
                         end_drag=(2.0, 0.0), end_added_mass=(1.0, 0.0), buoyancy=True, strips=25)  # fmt: skip
    return fs.Body(name="spar", hydro=load, points={"fairlead": (0.0, 0.0, -18.0)}, **SPAR)


@pytest.mark.parametrize("kind", ["member", "hull"])
def test_waves_on_hulls_and_members(kind, record):
    """One wave of 2 mm on a spar moored by soft springs, with dampers so that the start dies away: the run's steady
    amplitude is the RAO, of the water's load as well, part of which is the waves' own."""
    soft = dict(stiffness=2e4, free_length=45.0, damping=6e4)
    springs = [fs.Spring(name=f"spring_{k}", a="spar.fairlead", b=(50.0 * x, 50.0 * y, -18.0), **soft)
               for k, (x, y) in enumerate(((1, 0), (-0.5, 0.9), (-0.5, -0.9)))]  # fmt: skip
    springs.append(fs.Spring(name="foot", a="spar", b=(0.0, 0.0, -90.0), stiffness=0.0, damping=4e4, free_length=90.0))
    period, a = 8.0, 1e-3
    wave = fs.RegularWave(height=2.0 * a, period=period)
    still = fs.Model(parts=[spar(kind), *springs], sea=fs.Sea(depth=100.0))
    model = fs.Model(parts=[spar(kind), *springs], sea=fs.Sea(depth=100.0, waves=wave, wave_ramp=400.0))
    omega = 2.0 * np.pi / period
    names = ["spar_position", f"spar_{kind}_force"]
    response = fs.frequency_response(still, [0.9 * omega, omega], channels=names)
    run = fs.simulate(model, 1200.0, 0.05, channels=names, tolerance=1e-10, interval=0.1)
    t = run.time[-800:]
    basis = np.stack([np.cos(omega * t), -np.sin(omega * t), np.ones_like(t), t - t.mean()], axis=1)
    for name, which, what in zip(names, ([0, 2, 4], [0, 2]), ("surge, heave and pitch", "load"), strict=True):
        c = np.linalg.lstsq(basis, run.series(name)[-800:, which], rcond=None)[0]
        got, want = (c[0] + 1j * c[1]) / a, response.rao(name)[1, which]
        error = 100.0 * np.abs(got / want - 1.0).max()
        record(ROW_TIME, f"spar by {kind}, {what}: largest error", error, 0.3, "%")  # of the step: falls with h^2


def test_drag_of_members_in_a_sea(record):
    """A spar that waves do not move: the force of their drag is that of the linearised formula, sqrt(8/pi) sigma_u a
    strip (Borgman 1967), integrated over the depth. The waves are low: the formula ends at z = 0, the member at the
    surface, which is a part of order (k sigma)^2 more, 6 % of it with Hs 6 m."""
    omega = np.arange(0.3, 1.51, 0.05)
    sea = fs.Jonswap(hs=1.0, tp=10.0)
    load = fs.Member(a=(0.0, 0.0, -20.0), b=(0.0, 0.0, 5.0), diameter=0.1, drag_normal=1.0, buoyancy=True, strips=25)
    body = fs.Body(name="pile", mass=1e4, inertia=(1e5, 1e5, 1e4), hydro=load)
    model = fs.Model(parts=[body], joints=[fs.Weld(a="pile", b=(0.0, 0.0, 0.0), name="foot")], sea=fs.Sea(depth=100.0))
    response = fs.frequency_response(model, omega, spectrum=sea, channels=["foot_force"])
    S, k = sea.density(omega), wave_number(omega, 100.0, 9.81)
    z = -np.arange(0.25, 20.0, 0.5)
    shape = np.cosh(k * (z[:, None] + 100.0)) / np.sinh(k * 100.0)
    sigma = np.sqrt(np.sum(S * (omega * shape) ** 2, axis=1) * 0.05)
    drag = 0.5 * 1025.0 * 0.1 * np.sqrt(8.0 / np.pi) * 0.5 * (sigma[:, None] * omega * shape).sum(axis=0)
    inertia = 1025.0 * np.pi * 0.0025 * 0.5 * (omega**2 * shape).sum(axis=0)
    got = np.abs(response.rao("foot_force")[:, 0])
    error = 100.0 * np.abs(got / np.abs(drag + 1j * inertia) - 1.0).max()
    record(ROW_DRAG, "force on a pile: largest error over the frequencies", error, 2.0, "%")


BAD = {
    "one frequency": (lambda m: fs.frequency_response(m, [0.3]), "at least two positive frequencies"),
    "falling": (lambda m: fs.frequency_response(m, [0.3, 0.2]), "increasing"),
    "heading": (lambda m: fs.frequency_response(m, [0.3, 0.4], heading_deg=np.nan), "heading_deg is nan"),
    "spectrum": (lambda m: fs.frequency_response(m, [0.3, 0.4], spectrum=3.0), "must have density"),
    "model": (lambda m: fs.frequency_response(3), "must be a floatsim.Model"),
    "channel": (lambda m: fs.frequency_response(m, [0.3, 0.4]).rao("heave"), "there is no 'heave'"),
    "no sea": (lambda m: fs.frequency_response(m, [0.3, 0.4]).std("floater_position"), "spectra need a sea"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input(db, case):
    call, message = BAD[case]
    with pytest.raises(fs.CaseError, match=message):
        call(moored(db))


def test_powers_have_no_linear_response():
    import sys

    from shipped import MODELS

    sys.path.insert(0, str(MODELS))
    import rm3

    response = fs.frequency_response(rm3.build(), [0.5, 0.8])
    with pytest.raises(fs.CaseError, match="goes with the square"):
        response.rao("pto_power")
    assert "pto_power_amplitude" not in response.dataset()
