"""RM3: decay against WEC-Sim, regular waves against closed forms and the frequency domain, latching and end-stops.

Decay: WEC-Sim's series for the float released 0.1 m above its equilibrium, PTO damping 0, as HydroChrono publishes it
(0.06 s between samples); extrema of float and spar over the offset.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from shipped import MODELS

import floatsim as fs

sys.path.insert(0, str(MODELS))  # model scripts import their neighbours, as when they are run
import rm3  # noqa: E402

ROW = "RM3 decay"
ROW_REGULAR = "RM3 in regular waves, H 2.5 m, T 8 s, damper 1.2e6 N s/m"
ROW_TIME = "frequency domain against time domain in small waves"
ROW_CONTROL = "RM3 with latching and end-stops"

OFFSET = 0.1  # m
FLOAT = ((2.58, -0.7916), (5.10, 0.4532), (7.50, -0.2613), (9.96, 0.1623))  # s, over the offset
SPAR = ((3.72, -0.0553), (18.3, 0.0402), (37.3, -0.0402))
STEP = 0.06  # s, of the published series
FLOAT_TIMES = (2.563, 5.084, 7.524, 9.942, 12.369)  # s, of the same series' extrema by parabola
SPAR_TIME = 18.296  # s

HEIGHT, PERIOD = 2.5, 8.0  # m, s
OMEGA = 2.0 * np.pi / PERIOD
HEAVE = np.ix_([2, 8], [2, 8])


def extrema(t: np.ndarray, y: np.ndarray) -> list[tuple[float, float]]:
    """Times and values by parabolas through three samples."""
    found = []
    for k in np.flatnonzero((y[1:-1] - y[:-2]) * (y[2:] - y[1:-1]) < 0.0) + 1:
        a, b, c = np.polyfit(t[k - 1 : k + 2] - t[k], y[k - 1 : k + 2], 2)
        found.append((float(t[k] - b / (2.0 * a)), float(c - b * b / (4.0 * a))))
    return found


def released(duration: float = 40.0, dt: float = 0.05, **parameters: Any) -> fs.Run:
    """The float released from OFFSET above equilibrium, everything else at rest there."""
    system = fs.assemble(rm3.build(pto_damping=0.0, **parameters))
    state, _ = fs.solve_static(system)
    state.x[0, 2] += OFFSET
    return fs.simulate(system, duration, dt, state=state)


def heaves(run: fs.Run) -> np.ndarray:
    """Float and spar over the offset, (n, 2)."""
    return np.array([run.series(f"{name}_position")[:, 2] for name in ("float", "spar")]).T / OFFSET


@pytest.fixture(scope="module")
def db() -> fs.HydroDatabase:
    return fs.HydroDatabase.read(rm3.HYDRO)


@pytest.fixture(scope="module")
def decay() -> fs.Run:
    return released()


# --- decay ------------------------------------------------------------------------------------------


def test_decay(record, decay):
    z = heaves(decay)
    for name, wanted, y in (("float", FLOAT, z[:, 0]), ("spar", SPAR, z[:, 1])):
        got = extrema(decay.time, y)
        for n, (time, value) in enumerate(wanted):
            t, peak = got[n]
            what = f"{name}, extremum {n + 1}"
            record(ROW, f"{what}: difference of its size", 100.0 * abs(peak - value), 1.0, "% of the offset")
            late = t - time
            if name == "spar" and n == 1:
                # flat: a velocity of the spar of 30 micrometres a second moves it by that. It is the reference's
                # step that shows, see test_step_of_the_reference; the row is missed and stays
                assert 0.15 < late < 0.3  # as small steps say
                with pytest.raises(AssertionError):
                    record(ROW, f"{what} (at {time:g} s): its time", late, (-0.1, 0.1), "s")
                there = abs(float(np.interp(time, decay.time, y)) - value)
                record(ROW, f"spar at {time:g} s: difference", 100.0 * there, 1.0, "% of the offset")
            else:
                record(ROW, f"{what} (at {time:g} s): its time", late, (-0.1, 0.1), "s")


def cummins(db: fs.HydroDatabase, dt: float, duration: float, like_reference: bool) -> tuple[np.ndarray, np.ndarray]:
    """Heave of float and spar over the offset by another integration: times (n,), z (n, 2).

    Runge-Kutta of order 4; the memory is the trapezoidal rule over the velocities of all steps so far. like_reference:
    its force stays during a step what it was at its beginning, and the very first evaluation has no acceleration of the
    other body yet (accelerations that couple bodies come with a delay there, which starts from zero).
    """
    B, A = db.radiation_damping[:, *HEAVE], db.added_mass_inf[HEAVE]
    w = np.arange(0.0, db.omega[-1], 0.005)
    B = CubicSpline(np.r_[0.0, db.omega], np.concatenate([np.zeros((1, 2, 2)), B]))(w)
    lags = dt * np.arange(round(30.0 / dt))
    K = np.array([2.0 / np.pi * np.trapezoid(B * np.cos(w * s)[:, None, None], w, axis=0) for s in lags])
    weights = dt * K
    weights[0] *= 0.5
    mass = np.diag([rm3.MASS["float"], rm3.MASS["spar"]])
    coupled, alone = np.linalg.inv(mass + A), np.linalg.inv(mass + np.diag(np.diag(A)))
    C = db.hydrostatic_stiffness[HEAVE]
    n = round(duration / dt)
    z, v = np.zeros((n + 1, 2)), np.zeros((n + 1, 2))
    z[0] = 1.0, 0.0
    for k in range(n):
        m = min(k + 1, len(lags) - 1)
        now = np.einsum("tij,tj->i", weights[:m], v[k::-1][:m])
        past = np.einsum("tij,tj->i", weights[1 : m + 1], v[k::-1][:m])  # at the step's end, without its velocity

        def rate(y: np.ndarray, share: float, inverse: Any = coupled, now: Any = now, past: Any = past) -> np.ndarray:
            force = now if like_reference else (1.0 - share) * now + share * (past + weights[0] @ y[2:])
            return np.r_[y[2:], inverse @ (-C @ y[:2] - force)]

        y = np.r_[z[k], v[k]]
        k1 = rate(y, 0.0, alone if like_reference and k == 0 else coupled)
        k2 = rate(y + 0.5 * dt * k1, 0.5)
        k3 = rate(y + 0.5 * dt * k2, 0.5)
        k4 = rate(y + dt * k3, 1.0)
        y = y + dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        z[k + 1], v[k + 1] = y[:2], y[2:]
    return dt * np.arange(n + 1), z


def test_decay_by_another_integration(record, db, decay):
    """Runge-Kutta at a step of 0.02 s with the same database."""
    t, z = cummins(db, 0.02, 40.0, False)
    ours = heaves(decay)
    worst = max(float(np.abs(np.interp(decay.time, t, z[:, k]) - ours[:, k]).max()) for k in (0, 1))
    record(ROW, "whole series against another integration: largest difference", 100.0 * worst, 0.2, "% of the offset")


def test_step_of_the_reference(record, db):
    """Why the spar's second extremum is late against the reference: integrated with its step of 0.06 s and what
    `cummins` says of it, float and spar have the reference's times; in the limit of small steps the float's half
    periods are 0.02 s longer and the spar's flat extremum 0.2 s later."""
    for like, dt in ((True, STEP), (False, 0.02)):
        t, z = cummins(db, dt, 25.0, like)
        how = f"integrated like the reference, step {STEP:g} s" if like else "integrated with small steps"
        off = np.diff([time for time, _ in extrema(t, z[:, 0])[:5]]) - np.diff(FLOAT_TIMES)
        record(ROW, f"{how}: float's half periods, largest difference", np.abs(off).max(), 0.01 if like else 0.03, "s")
        late = abs(extrema(t, z[:, 1])[1][0] - SPAR_TIME)
        what = f"{how}: time of the spar's second extremum, difference"
        if like:
            record(ROW, what, late, 0.1, "s")
        else:
            record(ROW, what, late, "reported, no bar", "s", holds=True)


def test_decay_converges(record, decay):
    fine = released(dt=0.0125)
    change = np.abs(heaves(fine)[::4] - heaves(decay)).max()
    record(ROW, "step 0.05 s against 0.0125 s: largest difference", 100.0 * change, 0.2, "% of the offset")


def test_state_space_decay(record, decay):
    change = np.abs(heaves(released(radiation="state_space")) - heaves(decay)).max()
    record(ROW, "state space against convolution: largest difference", 100.0 * change, 1.0, "% of the offset")


# --- regular waves ----------------------------------------------------------------------------------


def amplitude(run: fs.Run, channel: str, omega: float = OMEGA, periods: int = 10) -> Any:
    """Complex amplitude of a channel over the last periods."""
    n = round(periods * 2.0 * np.pi / omega / (run.time[1] - run.time[0]))
    y, t = run.series(channel)[-n:], run.time[-n:]
    return 2.0 / n * np.tensordot(np.exp(-1j * omega * t), y - y.mean(axis=0), axes=1)


def regular(radiation: str = "convolution", **parameters: Any) -> fs.Run:
    waves = fs.RegularWave(height=HEIGHT, period=PERIOD)
    return fs.simulate(rm3.build(waves=waves, radiation=radiation, **parameters), 400.0, 0.1)


@pytest.fixture(scope="module")
def runs() -> dict[str, fs.Run]:
    return {kind: regular(kind) for kind in ("convolution", "state_space")}


@pytest.fixture(scope="module")
def response() -> fs.FrequencyResponse:
    return fs.frequency_response(rm3.build(), [OMEGA, 1.5])


QUANTITIES = (("float heave", "float_position", 2), ("float surge", "float_position", 0),
              ("spar heave", "spar_position", 2), ("pitch", "spar_position", 4),
              ("PTO velocity", "pto_velocity", ...), ("PTO force", "pto_force", ...))  # fmt: skip


def test_regular_waves(record, runs, response):
    """400 s: steady to the end, both memories alike, and as the frequency domain has it."""
    first, second = runs["convolution"], runs["state_space"]
    late = first.time > 300.0
    for run in (first, second):
        assert run.status == "done" and run.cut_steps == 0
    peaks = [np.abs(first.series("pto_displacement")[k]).max() for k in (late & (first.time < 350.0), first.time > 350)]
    record(ROW_REGULAR, "peak displacement of the slider, last 50 s over the 50 s before", peaks[1] / peaks[0],
           (0.99, 1.01))  # fmt: skip
    for name, channel, k in QUANTITIES:
        a, b, linear = (np.abs(y[k]) for y in (amplitude(first, channel), amplitude(second, channel),
                                               0.5 * HEIGHT * response.rao(channel)[0]))  # fmt: skip
        record(ROW_REGULAR, f"{name}, state space over convolution", 100.0 * abs(b / a - 1.0), 1.0, "%")
        record(ROW_REGULAR, f"{name}, time over frequency domain", 100.0 * abs(a / linear - 1.0), 1.0, "%")
    power = [fs.mean_power(run, "pto", since=400.0 - 10.0 * PERIOD) for run in (first, second)]
    record(ROW_REGULAR, "mean power, state space over convolution", 100.0 * abs(power[1] / power[0] - 1.0), 1.0, "%")


def linear_powers(run: fs.Run, db: fs.HydroDatabase) -> tuple[float, float]:
    """Mean work of excitation, 1/2 Re X* v, and of radiation, 1/2 v* B v: X and B from the tables, v from the run."""
    v = np.concatenate([amplitude(run, f"{name}_velocity") for name in ("float", "spar")])
    ahead = int(np.argmin(np.abs(db.headings)))
    X = 0.5 * HEIGHT * CubicSpline(db.omega, db.excitation[:, ahead])(OMEGA)
    B = CubicSpline(db.omega, db.radiation_damping)(OMEGA)
    return 0.5 * float((X.conj() @ v).real), 0.5 * float((v.conj() @ B @ v).real)


def test_power_balance(record, runs, db):
    """What the waves put in, 1/2 Re X* v, less what is radiated, 1/2 v* B v, is what the PTO takes: X and B from the
    tables, all twelve velocities from the run. And no more than the waves carry: (1 + 2) lambda/2 pi of crest in heave
    and in surge with pitch (Evans 1981, Annual Review of Fluid Mechanics 13)."""
    run = runs["convolution"]
    wave, radiated = linear_powers(run, db)
    power = fs.mean_power(run, "pto", since=400.0 - 10.0 * PERIOD)
    record(ROW_REGULAR, "work of excitation less radiation over PTO work: difference",
           100.0 * abs((wave - radiated) / power - 1.0), 1.0, "%")  # fmt: skip
    width = fs.capture_width(run, "pto", since=400.0 - 10.0 * PERIOD)
    limit = 3.0 * 2.0 * np.pi * rm3.GRAVITY / OMEGA**2 / (2.0 * np.pi)
    assert 0.0 < width < limit
    record(ROW_REGULAR, "mean power", power / 1e3, "reported, no bar", "kW", holds=True)
    record(ROW_REGULAR, "capture width", width, "reported, no bar", "m", holds=True)


@pytest.mark.parametrize("kind", ["convolution", "state_space"])
def test_energy_ledger(record, db, kind):
    """The ledger of the 400 s closes; over the last periods its waves' work and radiation are those of the tables."""
    waves = fs.RegularWave(height=HEIGHT, period=PERIOD)
    run = fs.simulate(rm3.build(waves=waves, radiation=kind), 400.0, 0.1, energy=True)
    ledger = run.energy
    assert ledger is not None and ledger.closes, ledger.summary()
    error = 100.0 * abs(ledger.error) / ledger.positive
    record(ROW_REGULAR, f"energy ledger, {kind}: error over total positive work", error, 1.0, "%")
    share = 100.0 * abs(ledger.integrator) / ledger.positive
    record(ROW_REGULAR, f"energy ledger, {kind}: loss of the time steps over total positive work", share, 1.0, "%")
    n = round(10.0 * PERIOD / 0.1)
    work = {name: float(np.ptp(run.series(f"energy_{name}")[[-1 - n, -1]])) / (10.0 * PERIOD)
            for name in ("wave", "radiation")}  # fmt: skip
    wave, radiated = linear_powers(run, db)
    for name, by_hand in (("wave", wave), ("radiation", radiated)):
        off = 100.0 * abs(work[name] - by_hand) / wave
        record(ROW_REGULAR, f"energy ledger, {kind}: {name} against the tables, over the waves' work", off, 1.0, "%")


def slider(db: fs.HydroDatabase, c: float) -> complex:
    """Displacement of the PTO per metre of wave with a damper c, by hand: heave alone, 2 x 2."""
    A, B, X = (CubicSpline(db.omega, y)(OMEGA) for y in (
        db.added_mass[:, *HEAVE], db.radiation_damping[:, *HEAVE],
        db.excitation[:, int(np.argmin(np.abs(db.headings)))][:, [2, 8]]))  # fmt: skip
    m = np.diag([rm3.MASS["float"], rm3.MASS["spar"]])
    damper = c * np.array([[1.0, -1.0], [-1.0, 1.0]])
    z = np.linalg.solve(-(OMEGA**2) * (m + A) + 1j * OMEGA * (B + damper) + db.hydrostatic_stiffness[HEAVE], X)
    return complex(z[0] - z[1])


def test_power_by_hand(record, db, response):
    """P = 1/2 c |i w s|^2. Seen from the PTO the device is a velocity V without damper behind a mobility Y,
    v = V/(1 + c Y), which takes most at c = 1/|Y|."""
    for c in (rm3.PTO_DAMPING,):
        got = 0.5 * c * abs(response.rao("pto_velocity")[0]) ** 2
        want = 0.5 * c * abs(1j * OMEGA * slider(db, c)) ** 2
        record(ROW_REGULAR, "power from the frequency domain against two heaves by hand", 100.0 * abs(got / want - 1.0),
               0.1, "%")  # fmt: skip
    free, damped = (1j * OMEGA * slider(db, c) for c in (0.0, 1e6))
    Y = (free / damped - 1.0) / 1e6
    best = 1.0 / abs(Y)
    most = 0.5 * best * abs(free / (1.0 + best * Y)) ** 2
    around = [0.5 * c * abs(OMEGA * slider(db, c)) ** 2 for c in (0.9 * best, best, 1.1 * best)]
    assert around[1] == pytest.approx(most, rel=1e-6) and most > max(around[0], around[2])
    run = regular(pto_damping=best, mooring=rm3.MOORING_STIFFNESS)  # see test_pitch_is_excited_parametrically
    power = fs.mean_power(run, "pto", since=400.0 - 10.0 * PERIOD)
    record(ROW_REGULAR, f"power with the best damper, {best / 1e6:.2f}e6 N s/m, against 1/2 c |V/(1 + c Y)|^2",
           100.0 * abs(power / (most * (0.5 * HEIGHT) ** 2) - 1.0), 1.0, "%")  # fmt: skip


@pytest.mark.slow
def test_small_waves(record):
    """Six waves of 2 cm between 25 and 4.4 s, after a ramp of 500 s: every significant complex amplitude against the
    frequency domain. The pitch mode, which next to nothing damps, still rings; least squares take it out, and the drift
    of a device without mooring, beside the six waves."""
    count, last, a = np.array([8, 12, 20, 31, 38, 45]), 200.0, 0.01
    omega, phase = 2.0 * np.pi * count / last, np.radians([0.0, 100.0, 200.0, 300.0, 50.0, 150.0])
    waves = fs.WaveComponents(amplitude=[a] * 6, omega=omega.tolist(), phase_deg=np.degrees(phase).tolist())
    names = ["float_position", "spar_position", "pto_displacement", "pto_velocity", "slider_force"]
    run = fs.simulate(rm3.build(waves=waves, wave_ramp=500.0), 800.0, 0.05, channels=names, tolerance=1e-9)
    response = fs.frequency_response(rm3.build(), omega, channels=names)
    pitch = next(m for m in fs.natural_modes(rm3.build(), count=8) if "pitch" in m.label)
    kept = run.time > 800.0 - last + 1e-6
    t = run.time[kept]
    angle = np.outer(t, np.r_[omega, 2.0 * np.pi / pitch.period])
    columns = np.hstack([np.cos(angle), np.sin(angle), np.ones((len(t), 1)), t[:, None] - t[0]])
    for name in names:
        found = np.linalg.lstsq(columns, run.series(name)[kept].reshape(len(t), -1), rcond=None)[0]
        got = (found[:6] - 1j * found[7:13]) * np.exp(-1j * phase)[:, None] / a
        want = response.rao(name).reshape(6, -1)
        for kind in [slice(0, 3), slice(3, 6)][: max(1, want.shape[1] // 3)]:
            large = np.abs(want[:, kind]).max()
            of = "" if want.shape[1] < 6 else (", x y z", ", rotations")[kind.start // 3]
            what = f"RM3, {name.replace('_', ' ')}{of}"
            if name == "slider_force":  # near 10 s the float's surge needs none: what is left there is a difference
                error = np.abs(got - want)[:, kind].max() / large
                record(ROW_TIME, f"{what}, complex amplitude: largest error over the largest", 100.0 * error, 1.0, "%")
                continue
            significant = np.abs(want[:, kind]) > 0.05 * large
            error = np.abs(got[:, kind] / want[:, kind] - 1.0)[significant].max()
            record(ROW_TIME, f"{what}, complex amplitude: largest error", 100.0 * error, 1.0, "%")


@pytest.mark.slow
def test_pitch_is_excited_parametrically(record):
    """Without mooring, waves of nearly half the pitch period make it grow although nothing in them has its period;
    with a mooring, which moves and couples it, they do not. The sizes are our own and have no bar."""
    waves = fs.RegularWave(height=HEIGHT, period=PERIOD)
    sizes = []
    for mooring in (0.0, rm3.MOORING_STIFFNESS):
        run = fs.simulate(rm3.build(waves=waves, pto_damping=2.74e6, mooring=mooring), 700.0, 0.1)
        assert run.status == "done"
        pitch = run.series("spar_position")[run.time > 600.0, 4]
        what = f"damper 2.74e6 N s/m, mooring {mooring:g} N/m: amplitude of pitch after 600 s"
        sizes.append(0.5 * np.ptp(pitch))
        record(ROW_REGULAR, what, sizes[-1], "reported, no bar", "rad", holds=True)
    assert sizes[0] > 5.0 * sizes[1]


# --- control, stops, umbilical ----------------------------------------------------------------------


def test_latching(record):
    """A lock that holds the slider after each standstill: nothing moves while it is engaged, energy is lost by engaging
    only within a step of the standstill. In long waves, slower than the float's own 5 s, it takes more than the damper
    alone."""
    period, power, lost = 11.0, {}, 0.0
    waves = fs.RegularWave(height=1.0, period=period)
    for hold in (None, 2.5):
        run = fs.simulate(rm3.build(waves=waves, pto_damping=3e5, latch_for=hold, wave_ramp=40.0), 210.0, 0.05)
        assert run.status == "done"
        power[hold] = fs.mean_power(run, "pto", since=100.0)
        if hold is not None:
            engaged = run.series("latch_engaged") > 0.5
            both = engaged[1:] & engaged[:-1]
            slip = np.abs(np.diff(run.series("pto_displacement"))[both]).max()
            record(ROW_CONTROL, "latching: movement of the held slider in a step", slip, 1e-6, "m")
            share = engaged[run.time > 100.0].mean()
            record(ROW_CONTROL, "latching: share of the time it holds", share, (0.3, 0.6))
            lost = float(run.series("latch_energy_lost")[-1]) / (power[hold] * 110.0)
    record(ROW_CONTROL, "latching: energy lost by engaging over energy of the PTO", 100.0 * lost, 1.0, "%")
    record(ROW_CONTROL, "latching: power over that of the damper alone", power[2.5] / power[None], (1.2, 10.0))


def test_end_stops_survive_a_slam(record):
    """Waves that throw the float 1.7 m along the spar, and stops at half a metre."""
    waves = fs.RegularWave(height=4.0, period=6.0)
    run = fs.simulate(rm3.build(waves=waves, pto_damping=1e5, stops=(-0.5, 0.5), wave_ramp=20.0), 100.0, 0.05)
    assert run.status == "done"
    free = fs.simulate(rm3.build(waves=waves, pto_damping=1e5, wave_ramp=20.0), 100.0, 0.05)
    s = run.series("pto_displacement")
    assert np.abs(free.series("pto_displacement")).max() > 1.0
    record(ROW_CONTROL, "end-stops at 0.5 m: largest displacement", np.abs(s).max(), (0.5, 0.75), "m")
    hardest = np.abs(run.series("pto_force")).max()
    deepest = np.abs(s).max() - 0.5
    stiff = rm3.STOP_STIFFNESS
    assert hardest > 0.5 * stiff * deepest


def test_umbilical_hangs_from_the_float(record):
    """Static: the cable's weight in water less what the bed bears pulls on float and bed; the run goes on in waves."""
    waves = fs.RegularWave(height=2.5, period=8.0)
    system = fs.assemble(rm3.build(umbilical=True, waves=waves, wave_ramp=20.0))
    state, _ = fs.solve_static(system)
    run = fs.simulate(system, 40.0, 0.1, state=state)
    assert run.status == "done"
    pull = run.series("umbilical_end_a_force")[0]
    surge = run.series("spar_position")[0, 0]
    record(ROW_CONTROL, "umbilical: its pull over what the mooring holds: difference",
           100.0 * abs(pull[0] / (rm3.MOORING_STIFFNESS * surge) - 1.0), 0.1, "%")  # fmt: skip
    place = run.series("umbilical_position")
    low = np.abs(place[0, :, 2] + 29.0).argmin()
    gap = np.hypot(place[0, low, 0], place[0, low, 1]) - 0.5 * rm3.SHAPE["spar"][3]
    record(ROW_CONTROL, "umbilical: clearance from the heave plate at rest", gap, (1.0, 10.0), "m")


def test_jointed_bodies_are_judged_together():
    """A float 100 t too heavy drags nothing along: it floats 100e3/(1000 * 263 m2) m = 0.37 m deeper alone, and is told
    so; the spar on its own slider stays. What a hinge carries is no warning (OSWEC, whose flap would rise alone)."""
    from floatsim.study.sheet import cautions

    model = rm3.build()
    heavy = [
        fs.Body(**{**dict(part), "mass": part.mass + 1e5}) if part.name == "float" else part for part in model.parts
    ]
    lines = cautions(fs.assemble(fs.Model(**{**dict(model), "parts": heavy})))
    assert [line for line in lines if "float" in line and "deeper than drawn, together with" in line]
    assert not [line for line in lines if "'spar'" in line and "drawn" in line]
    assert not [line for line in cautions(fs.assemble(model)) if "drawn" in line]
