"""Measured elevations: reproduced sample by sample, carried by the right waves, and no longer than they are."""

import copy
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import floatsim as fs
from floatsim.errors import CaseError, ModelError
from floatsim.sea.dispersion import wave_number
from floatsim.sea.elevation_series import ElevationSeries
from floatsim.sea.focused import FocusedWave
from floatsim.sea.spectra import Jonswap
from floatsim.sea.waves import CombinedWaves, IrregularWaves, RegularWave, wave_files

G = 9.81


def samples(n, seed=1, offset=0.3):
    return offset + np.random.default_rng(seed).normal(size=n)


@pytest.mark.parametrize("n", [1200, 1201])
def test_the_gauge_sees_its_record(n, record):
    eta = samples(n)
    series = ElevationSeries(dt=0.25, elevation=eta, position=(120.0, -40.0), heading_deg=35.0)
    waves = series.realise(45.0, G)
    t = 0.25 * np.arange(n)
    worst = np.abs(waves.elevation(120.0, -40.0, t) - (eta - eta.mean())).max() / eta.std()
    record("Measured elevation", f"{n} samples at the gauge, of their standard deviation", worst, 1e-10)
    assert series.mean == pytest.approx(eta.mean(), rel=1e-12) and series.left_out == 0.0
    assert waves.duration == series.duration == pytest.approx(0.25 * (n - 1))
    assert waves.wave_number == pytest.approx(wave_number(waves.omega, 45.0, G), rel=1e-12)
    assert waves.omega.max() <= np.pi / 0.25 * (1.0 + 1e-12) and waves.omega.size == n // 2


@settings(max_examples=60, deadline=None)
@given(
    eta=st.lists(st.floats(-30.0, 30.0), min_size=4, max_size=60).filter(lambda row: max(row) - min(row) > 1e-3),
    dt=st.floats(0.01, 5.0), x=st.floats(-300.0, 300.0), heading=st.floats(-360.0, 360.0),
)  # fmt: skip
def test_any_record(eta, dt, x, heading):
    series = ElevationSeries(dt=dt, elevation=eta, position=(x, 0.5 * x), heading_deg=heading)
    waves = series.realise(math.inf, G)
    got = waves.elevation(x, 0.5 * x, dt * np.arange(len(eta)))
    # a phase k s of 1e7 rad in the shortest waves keeps nine digits
    phase = waves.wave_number.max() * abs(x) * 1.2
    assert got + series.mean == pytest.approx(np.array(eta), abs=30.0 * len(eta) * (1e-12 + 1e-15 * phase))


def test_one_wave_is_found_and_carried_on():
    """Twelve whole waves of 9 s in the record: one wave, the right one everywhere, not at the gauge alone."""
    wave = RegularWave(height=3.0, period=9.0, heading_deg=30.0, phase_deg=50.0).realise(50.0, G)
    t = 0.5 * np.arange(216)
    series = ElevationSeries.from_times(
        t + 7.0, 0.2 + wave.elevation(80.0, 25.0, t), position=(80.0, 25.0), heading_deg=30.0
    )
    waves = series.realise(50.0, G)
    assert series.mean == pytest.approx(0.2, abs=1e-12) and series.dt == pytest.approx(0.5)
    big = waves.amplitude > 1e-9
    assert waves.amplitude[big] == pytest.approx([1.5], rel=1e-12) and waves.omega[big] == pytest.approx(wave.omega)
    for x, y in ((0.0, 0.0), (-300.0, 200.0)):
        assert waves.elevation(x, y, t) == pytest.approx(wave.elevation(x, y, t), abs=1e-9)


def test_band_limits():
    t = 0.25 * np.arange(400)
    w = 2.0 * np.pi / 100.0 * np.array([1.0, 10.0, 60.0])
    eta = 0.5 * np.cos(w[0] * t) + 2.0 * np.cos(w[1] * t + 0.4) + 0.1 * np.sin(w[2] * t)
    series = ElevationSeries(dt=0.25, elevation=eta, omega_min=0.2, omega_max=3.0)
    assert series.left_out == pytest.approx((0.25 + 0.01) / (0.25 + 4.0 + 0.01), rel=1e-9)
    waves = series.realise(math.inf, G)
    assert waves.omega.min() >= 0.2 and waves.omega.max() <= 3.0
    assert waves.elevation(0.0, 0.0, t) == pytest.approx(2.0 * np.cos(w[1] * t + 0.4), abs=1e-11)


def test_an_irregular_sea_measured_and_made_again():
    """Upstream of a point: after the waves of the record have arrived there, the sea is that which was measured."""
    sea = IrregularWaves(spectrum=Jonswap(hs=3.0, tp=8.0), seed=4, omega_max=2.5).realise(40.0, G)
    t = 0.25 * np.arange(4800)
    again = ElevationSeries(dt=0.25, elevation=sea.elevation(-50.0, 0.0, t), position=(-50.0, 0.0)).realise(40.0, G)
    late = (t > 120.0) & (t < 1080.0)
    assert again.elevation(0.0, 0.0, t)[late] == pytest.approx(sea.elevation(0.0, 0.0, t)[late], abs=0.15)


def test_times_and_files(tmp_path):
    t, eta = 0.04 * np.arange(50), samples(50)
    rounded = ElevationSeries.from_times(np.round(t, 4), eta)
    assert rounded.dt == pytest.approx(0.04) and rounded.elevation == tuple(eta)
    path = tmp_path / "gauge.csv"
    rows = [f"{1e3 * a!r}, 99, {1e3 * b!r}" for a, b in zip(t.tolist(), eta.tolist(), strict=True)]
    path.write_text("# tank 3\ntime [ms]; none; gauge [mm]\n\n" + "\n".join(rows) + "\n")
    read = ElevationSeries.read(path, elevation_column=2, time_unit=1e-3, elevation_unit=1e-3, heading_deg=90.0)
    assert read.elevation == pytest.approx(tuple(eta)) and read.dt == pytest.approx(0.04) and read.heading_deg == 90.0
    both = CombinedWaves(waves=[RegularWave(height=1.0, period=5.0), read])
    assert wave_files(both) == (str(path),) and wave_files(None) == () and copy.deepcopy(read) == read
    assert repr(read) == "ElevationSeries(50 samples, 0.04 s apart)"
    with pytest.raises(ModelError, match="line 4: no numbers in columns 0 and 3"):
        ElevationSeries.read(path, elevation_column=3)
    path.write_text("nothing\n")
    with pytest.raises(ModelError, match="has no rows of numbers"):
        ElevationSeries.read(path)
    with pytest.raises(ModelError, match=r"none\.csv cannot be read: No such file"):
        ElevationSeries.read(tmp_path / "none.csv")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"dt": 0.0}, "dt: got 0.0"),
        ({"elevation": [1.0, 2.0, 1.0]}, "at least 4 long"),
        ({"elevation": [1.0, np.nan, 1.0, 2.0]}, "elevation: .* a row of finite numbers"),
        ({"elevation": [1.5] * 9}, "ElevationSeries 'g': the elevation is 1.5 m all the time"),
        ({"omega_min": 2.0, "omega_max": 1.0}, "no wave of the record, 0.0314 to 6.28 rad/s in steps of 0.0314"),
        ({"omega_max": -1.0}, "omega_max"),
        ({"position": 3.0}, "position"),
    ],
)
def test_refused(arguments, words):
    with pytest.raises(ModelError, match=words):
        ElevationSeries(**{"dt": 0.5, "elevation": samples(400), "name": "g", **arguments})


@pytest.mark.parametrize(
    ("time", "words"),
    [
        (
            [0.0, 1.0, 2.0, 3.5, 4.0],
            "5 samples from 0 to 4 s are 1 s apart .*, sample 3 is at 3.5 s and not at 3 s",
        ),
        ([4.0, 3.0, 2.0, 1.0, 0.0], "evenly spaced"),
        ([0.0, 0.0, 0.0, 0.0, 0.0], "evenly spaced"),
        ([0.0, 1.0, 2.0, 3.0], "from_times: elevation has 5 values, time has 4"),
        (["a", "b"], "from_times: time"),
    ],
)
def test_times_refused(time, words):
    with pytest.raises(ModelError, match=words):
        ElevationSeries.from_times(time, samples(5))


# --- in a run --------------------------------------------------------------------------------------------


def run(waves, duration, **sea):
    bob = fs.PointMass(name="bob", mass=3.0, position=(0.0, 0.0, 4.0))
    spring = fs.Spring(name="spring", a="bob", b=(0.0, 0.0, 5.0), stiffness=900.0, damping=1.0, free_length=1.0)
    system = fs.assemble(fs.Model(parts=[bob, spring], sea=fs.Sea(depth=30.0, waves=waves, **sea)))
    return fs.simulate(system, duration, 0.1, state=system.initial_state())


def test_runs_see_the_record_and_the_crest():
    eta = samples(301)
    series = ElevationSeries(dt=0.1, elevation=eta, omega_max=3.0, heading_deg=40.0)
    done = run(series, 30.0, wave_ramp=0.0)
    expected = series.realise(30.0, G).elevation(0.0, 0.0, done.time)
    assert np.ravel(done.series("wave_elevation")) == pytest.approx(expected, abs=1e-9)
    with pytest.raises(CaseError, match=r"the run ends at 31 s, but the waves are only known .* until 30 s"):
        run(series, 31.0)
    group = FocusedWave(spectrum=Jonswap(hs=1.0, tp=6.0), crest=1.2, time=20.0, duration=35.0, omega_max=4.0)
    both = CombinedWaves(waves=[RegularWave(height=0.2, period=5.0), group])
    done = run(both, 30.0, wave_ramp=10.0)
    got = float(np.ravel(done.series("wave_elevation"))[np.argmin(np.abs(done.time - 20.0))])
    assert got == pytest.approx(1.2 + 0.1, rel=1e-6)  # four whole periods of the regular wave
