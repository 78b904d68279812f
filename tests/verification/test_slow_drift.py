"""Second-order forces and slow positions in runs: statics, slow resonance, outputs, restart."""

import copy
import pickle

import numpy as np
import pytest
from mechanics import run
from second_order import GRAVITY, RHO, database, formula, synthetic

import floatsim as fs
from floatsim.hydro.slow_position import CORNER, SlowPosition
from floatsim.hydro.wave_loads import WaveLoads

MASS, SOFT, DAMPING = RHO * 4500.0, 1e5, 1.2e5  # kg; N/m and N s/m of surge and sway
STIFF = np.diag([SOFT, SOFT, 0.0, 3e9, 3e9, 5e8])
DAMP = np.diag([DAMPING, DAMPING, 3e6, 5e8, 5e8, 1e8])
DEPTH = 3000.0  # m: deep for any of these waves
ROW = "second-order wave forces from a full QTF"


def system(waves, ramp=0.0, heading_deg=0.0, **flow):
    db = database(added_mass_inf=np.zeros((6, 6)), depth=DEPTH)
    body = fs.Body(
        name="hull", mass=MASS, center_of_mass=(0.0, 0.0, 0.0), inertia=(2e9, 2e9, 2e9),
        attitude_deg=(0.0, 0.0, heading_deg),
        hydro=fs.PotentialFlow(database=db, linear_stiffness=STIFF, linear_damping=DAMP, memory=10.0, **flow),
    )  # fmt: skip
    return fs.assemble(fs.Model(parts=[body], sea=fs.Sea(depth=DEPTH, density=RHO, waves=waves, wave_ramp=ramp)))


def body_pose(state):
    return state.x[0].copy()


@pytest.mark.parametrize("heading_deg", [0.0, 30.0])
def test_statics_have_the_mean_drift_and_a_run_starts_without_a_jolt(heading_deg):
    """The mean offset is F/k; with the ramp the slow surge stays there while first-order motion grows."""
    wave = fs.RegularWave(height=4.0, period=8.0, heading_deg=heading_deg)
    s = system(wave, ramp=100.0, heading_deg=heading_deg, drift=synthetic())
    state, _ = fs.solve_static(s)
    b = np.radians(heading_deg)
    drift = synthetic().transfer[0, :, :, 0].diagonal().real
    offset = 4.0 * np.interp(2.0 * np.pi / 8.0, synthetic().omega, drift) / SOFT
    assert state.x[0, :2] == pytest.approx(offset * np.array([np.cos(b), np.sin(b)]), rel=1e-6)
    seen = np.array(run(s, state, fs.generalised_alpha(), 0.1, 3000, body_pose))[:, :2] @ [np.cos(b), np.sin(b)]
    slow = np.convolve(seen, np.full(80, 1.0 / 80), mode="valid")  # means over one period of the wave
    assert np.abs(slow - offset).max() < 0.05 * offset  # of what the growth of the first-order motion leaves


def test_slow_resonance(record):
    """Two waves 0.15 rad/s apart: surge at that frequency is 2 a1 a2 T12 over k - w^2 m + i w b."""
    w, a = np.array([0.9, 0.75]), (1.0, 0.8)
    waves = fs.WaveComponents(amplitude=a, omega=tuple(w))
    s = system(waves, ramp=50.0, drift=synthetic())
    state, _ = fs.solve_static(s)
    h, n = 0.1, 12000
    x = np.array(run(s, state, fs.generalised_alpha(), h, n, body_pose))[:, 0]
    t = h * np.arange(n + 1)
    last = t > t[-1] - 12.0 * np.pi / 0.15
    columns = [f(v * t[last]) for v in (0.15, 0.9, 0.75) for f in (np.cos, np.sin)] + [np.ones(last.sum())]
    fit, *_ = np.linalg.lstsq(np.stack(columns, axis=1), x[last], rcond=None)
    got = fit[0] - 1j * fit[1]
    exact = 2.0 * a[0] * a[1] * formula(w[0], w[1])[0] / (SOFT - 0.15**2 * MASS + 0.15j * DAMPING)
    record(ROW, "two waves: slow surge against the frequency domain, relative", abs(got / exact - 1.0), 5e-3)


def test_outputs():
    wave = fs.RegularWave(height=4.0, period=8.0, heading_deg=90.0)
    s = system(wave, heading_deg=90.0, drift=(synthetic(), synthetic("sum")))
    out = fs.simulate(s, duration=5.0, dt=0.1)
    sea = wave.realise(DEPTH, GRAVITY)
    loads = WaveLoads(database(), sea, heading=np.pi / 2.0, drift=(synthetic(), synthetic("sum")))
    for t, force, moment in zip(out.time, out.series("hull_drift_force"), out.series("hull_drift_moment"), strict=True):
        f = loads.forces(t)[1]
        assert force == pytest.approx([-f[1], f[0], f[2]], rel=1e-9, abs=1e-3)
        assert moment == pytest.approx([-f[4], f[3], f[5]], rel=1e-9, abs=1e-3)


def slow(state):
    (found,) = [h for history in state.history.values() for h in history if isinstance(h, SlowPosition)]
    return found


def test_slow_position_of_a_run():
    """It starts where the floater is at rest, and follows the filter's differential equation."""
    waves = fs.IrregularWaves(spectrum=fs.Jonswap(hs=4.0, tp=9.0), seed=3, omega_max=2.4, duration=600.0)
    s = system(waves, drift="newman", slow_position=True)
    state, _ = fs.solve_static(s)
    assert slow(state).y[:2] == pytest.approx(state.x[0, :2])
    assert slow(state).corner == pytest.approx(CORNER * 2.0 * np.pi / 9.0, rel=0.03)
    h, c = 0.1, slow(state).corner
    seen = run(s, state, fs.generalised_alpha(), h, 1500, lambda st: (st.x[0, 0], slow(st).y[0], slow(st).dy[0]))
    u, y, dy = np.array(seen).T
    assert y[-1] != pytest.approx(u[-1], abs=1e-3)
    middle = (dy[2:] - dy[:-2]) / (2 * h) + np.sqrt(2.0) * c * dy[1:-1] + c**2 * (y[1:-1] - u[1:-1])
    assert np.abs(middle).max() < 2e-3 * c**2 * np.abs(u - y).max()


def test_at_the_slow_position_the_wave_meets_it_later():
    """Released 50 m downwave and held there by almost nothing: the excitation's phase is -50 k."""
    w = 0.7
    wave = fs.RegularWave(height=2.0, period=2.0 * np.pi / w)
    lag = {}
    for follow in (False, True):
        s = system(wave, slow_position=follow)
        state = s.initial_state()
        state.x[0, 0] += 50.0
        s.forget(state)
        stepper = fs.Stepper(s)
        stepper.start(state, 0.1)
        work = s.work()
        s.load(work, state)
        heave = []
        for t in (0.0, 0.5 * np.pi / w):
            s.begin(work, state, t)
            heave.append(s.batches[-1].external[0, 2])
        lag[follow] = heave[0] - 1j * heave[1]
    k = w**2 / GRAVITY
    # the body, let go, moves 1 m in these 2 s, of which the filter lets through a hundredth
    assert np.angle(lag[True] / lag[False]) == pytest.approx(np.angle(np.exp(-50j * k)), abs=0.02)


def test_restart_and_rejected_steps():
    waves = fs.IrregularWaves(spectrum=fs.Jonswap(hs=4.0, tp=9.0), seed=3, omega_max=2.4, duration=600.0)
    s = system(waves, drift="newman", slow_position=True)
    state, _ = fs.solve_static(s)
    run(s, state, fs.generalised_alpha(), 0.1, 100)
    stored = pickle.loads(pickle.dumps(state))
    before = copy.deepcopy(slow(state).arrays())
    assert not fs.Stepper(s, tolerance=0.0).step(state, 0.1).converged
    assert all(np.array_equal(before[key], value) for key, value in slow(state).arrays().items())
    one, two = fs.Stepper(s), fs.Stepper(s)
    for _ in range(50):
        assert one.step(state, 0.1).converged and two.step(stored, 0.1).converged
    assert np.array_equal(state.x, stored.x) and np.array_equal(slow(state).y, slow(stored).y)


@pytest.mark.parametrize("drift", ["full", 3, ("newman", "qtf")])
def test_drifts_that_there_are_not(drift):
    with pytest.raises(fs.ModelError, match="drift: got .* 'newman', a QTF"):
        fs.PotentialFlow(database=database(), drift=drift)


def test_what_the_qtf_lacks_names_the_body():
    wave = fs.RegularWave(height=4.0, period=8.0, heading_deg=20.0)
    with pytest.raises(fs.ModelError, match="Body 'hull': QTF 'formula': waves at 20 deg"):
        system(wave, drift=synthetic())
