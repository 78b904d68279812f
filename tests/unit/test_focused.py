"""Focused groups: the crest where and when it was asked for, the shape by closed forms, and no second group."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from floatsim.errors import ModelError
from floatsim.sea import Jonswap, OchiHubble, PiersonMoskowitz, SpectrumTable, Torsethaugen, WhiteNoise
from floatsim.sea.dispersion import wave_number
from floatsim.sea.focused import FocusedWave
from floatsim.sea.kinematics import Kinematics, exact
from floatsim.sea.site import Current, Sea
from floatsim.sea.waves import CombinedWaves, IrregularWaves, RegularWave, seeds

G = 9.81


def group(**more):
    return FocusedWave(**{"spectrum": Jonswap(hs=6.0, tp=10.0), "crest": 7.0, "time": 150.0, **more})


@pytest.mark.parametrize(
    ("name", "tp", "crest", "where"),
    [("Tp 1.383 s, crest 0.064 m", 1.383, 0.064, (0.0, 0.0)), ("Tp 1.938 s, crest 0.127 m", 1.938, 0.127, (3.0, -2.0))],
)
def test_crest_at_the_given_place_and_time(name, tp, crest, where, record):
    """Pierson-Moskowitz groups at model scale 1:70, in 200/70 m: by the plain sum and by the fast kinematics."""
    spectrum = PiersonMoskowitz(hs=0.1, tp=tp)
    waves = group(spectrum=spectrum, crest=crest, time=30.0, position=where, heading_deg=20.0).realise(200.0 / 70.0, G)
    here = np.array([[*where, 0.0]])
    plain = exact(waves, here, 30.0)[2][0]
    u, du, eta = np.zeros((1, 3)), np.zeros((1, 3)), np.zeros(1)
    still = Current(speed=0.0)
    Kinematics(waves, still, 200.0 / 70.0, 10.0, "vertical", [0]).move(here, 30.0, u, du, eta)
    apart = 100.0 * max(abs(value / crest - 1.0) for value in (plain, eta[0], waves.elevation(*where, 30.0)))
    record("Focused wave", f"{name}: crest at the given place and time", apart, 0.5, "%")
    # and that is the highest of all, nearby and at any time
    t = np.linspace(0.0, 60.0, 2401)
    assert waves.elevation(*where, t).max() <= crest * (1.0 + 1e-12)
    x = np.linspace(-10.0, 10.0, 401)
    assert waves.elevation(where[0] + x, where[1], 30.0).max() <= crest * (1.0 + 1e-12)


spectra = st.sampled_from(
    [
        Jonswap(hs=2.0, tp=8.0), PiersonMoskowitz(hs=1.0, tp=12.0), Torsethaugen(hs=3.0, tp=15.0),
        OchiHubble.most_probable(3.0), WhiteNoise(hs=1.0, omega_min=0.5, omega_max=1.5),
        SpectrumTable(omega=[0.70, 0.71], S=[1.0, 1.0]),
    ]
)  # fmt: skip


@settings(max_examples=60, deadline=None)
@given(
    spectrum=spectra, crest=st.floats(-20.0, 20.0).filter(lambda a: abs(a) > 0.01), time=st.floats(20.0, 300.0),
    x=st.floats(-500.0, 500.0), y=st.floats(-500.0, 500.0), heading=st.floats(-360.0, 360.0),
    depth=st.one_of(st.floats(10.0, 500.0), st.just(math.inf)),
)  # fmt: skip
def test_any_group_has_its_crest(spectrum, crest, time, x, y, heading, depth):
    wave = FocusedWave(spectrum=spectrum, crest=crest, time=time, position=(x, y), heading_deg=heading)
    waves = wave.realise(depth, G)
    assert waves.elevation(x, y, time) == pytest.approx(crest, rel=1e-9)
    assert waves.amplitude.min() > 0.0 and waves.duration == 2.0 * time
    assert waves.wave_number == pytest.approx(wave_number(waves.omega, depth, G), rel=1e-12)


def test_white_noise_makes_a_dirichlet_kernel():
    """n equal waves with frequencies a to b steps: A sin(n y)/(n sin y) cos((a + b) y), y = step tau/2; close to the
    focus that is A (sin w2 tau - sin w1 tau)/((w2 - w1) tau), the transform of the spectrum itself."""
    step = 2.0 * np.pi / 400.0
    spectrum = WhiteNoise(hs=2.0, omega_min=29.5 * step, omega_max=109.5 * step)
    waves = group(spectrum=spectrum, crest=3.0, time=200.0).realise(80.0, G)
    assert waves.omega == pytest.approx(step * np.arange(30, 110), rel=1e-12)
    assert waves.amplitude == pytest.approx(np.full(80, 3.0 / 80.0), rel=1e-9)
    tau = np.linspace(-150.0, 150.0, 1000)
    y = 0.5 * step * tau
    closed = 3.0 * np.sin(80.0 * y) / (80.0 * np.sin(y)) * np.cos(139.0 * y)
    assert waves.elevation(0.0, 0.0, 200.0 + tau) == pytest.approx(closed, abs=1e-9)
    near = tau[np.abs(tau) < 30.0]
    w1, w2 = 29.5 * step, 109.5 * step
    shape = 3.0 * (np.sin(w2 * near) - np.sin(w1 * near)) / ((w2 - w1) * near)
    assert waves.elevation(0.0, 0.0, 200.0 + near) == pytest.approx(shape, abs=0.01)


def test_shape_is_the_autocorrelation(record):
    """In time at the place of focus and in space at its time: A/m0 int S cos(w tau) dw and the same with k s."""
    spectrum = Jonswap(hs=6.0, tp=10.0)
    waves = group(position=(40.0, 30.0), heading_deg=90.0).realise(60.0, G)
    omega = np.linspace(1e-3, 60.0, 400001)
    S = spectrum.density(omega)
    k = wave_number(omega, 60.0, G)

    def shape(argument):
        return 7.0 * np.trapezoid(S * np.cos(argument), omega) / np.trapezoid(S, omega)

    apart = [waves.elevation(40.0, 30.0, 150.0 + t) - shape(omega * t) for t in (0.0, 1.3, 4.0, 5.0, 9.7, 23.0, -5.0)]
    apart += [waves.elevation(0.0, 30.0 + s, 150.0) - shape(k * s) for s in (10.0, 70.0, -120.0)]
    worst = 100.0 * np.abs(apart).max() / 7.0
    name = "JONSWAP: shape in time and space against the autocorrelation, of the crest"
    record("Focused wave", name, worst, 0.5, "%")


def test_it_is_what_high_crests_look_like():
    """The mean of a random sea around its crests above two standard deviations, each by its own height (Lindgren)."""
    spectrum = Jonswap(hs=4.0, tp=10.0)
    t = np.arange(0.0, 3600.0, 0.25)
    tau = np.arange(-60, 61)
    pieces = []
    for seed in range(8):
        eta = IrregularWaves(spectrum=spectrum, seed=seed).realise(np.inf, G).elevation(0.0, 0.0, t)
        high = np.flatnonzero((eta[1:-1] > eta[:-2]) & (eta[1:-1] >= eta[2:]) & (eta[1:-1] > 2.0)) + 1
        pieces += [eta[i + tau] / eta[i] for i in high if 60 <= i < t.size - 60]
    assert len(pieces) > 150
    wave = group(spectrum=spectrum, crest=1.0).realise(np.inf, G)
    assert np.mean(pieces, axis=0) == pytest.approx(wave.elevation(0.0, 0.0, 150.0 + 0.25 * tau), abs=0.08)


def test_trough_and_symmetry():
    crest, trough = group().realise(60.0, G), group(crest=-7.0).realise(60.0, G)
    t = np.linspace(0.0, 300.0, 700)
    assert trough.elevation(12.0, 5.0, t) == pytest.approx(-crest.elevation(12.0, 5.0, t), abs=1e-9)
    assert crest.elevation(0.0, 0.0, 300.0 - t) == pytest.approx(crest.elevation(0.0, 0.0, t), abs=1e-9)


def test_the_group_comes_once_in_the_run():
    wave = group(duration=400.0)
    assert wave.repeats_after == 500.0 and group().repeats_after == 300.0
    waves = wave.realise(60.0, G)
    assert waves.duration == 400.0
    t = np.linspace(0.0, 400.0, 8001)
    eta = waves.elevation(0.0, 0.0, t)
    assert np.abs(eta[np.abs(t - 150.0) > 60.0]).max() < 0.1 * 7.0
    # the repetition, after the run, is where it was said
    assert waves.elevation(0.0, 0.0, 650.0) == pytest.approx(7.0, rel=1e-9)
    # a cut at the end of a database is kept: between two frequencies, nearer to that above
    step = 2.0 * np.pi / 300.0
    noise = WhiteNoise(hs=1.0, omega_min=0.5, omega_max=3.0)
    cut = group(spectrum=noise, omega_max=70.7 * step).realise(60.0, G)
    assert cut.omega.max() == pytest.approx(70.0 * step, rel=1e-12)


@pytest.mark.parametrize(
    ("bad", "words"),
    [
        ({"crest": 0.0}, "FocusedWave: crest is 0 m"),
        ({"crest": np.nan}, "crest"),
        ({"time": 0.0}, "time: got 0.0; must be a positive number"),
        ({"duration": 120.0}, r"duration \(120 s\) must be longer than the time of focus \(150 s\)"),
        ({"position": (0.0, 0.0, 0.0)}, "two finite numbers"),
        ({"spectrum": "jonswap"}, "density"),
        ({"seed": 3}, "unknown argument 'seed'"),
    ],
)
def test_refused(bad, words):
    with pytest.raises(ModelError, match=words):
        group(**bad)


def test_refused_when_realised():
    with pytest.raises(ModelError, match="'g': a group that does not repeat within 2000000 s.*omega_max"):
        group(duration=1e6 + 150.0, name="g").realise(60.0, G)
    with pytest.raises(ModelError, match="'g': the spectrum .* has no energy up to 0.1 rad/s"):
        group(omega_max=0.1, name="g", spectrum=WhiteNoise(hs=1.0, omega_min=0.5, omega_max=1.0)).realise(60.0, G)
    with pytest.raises(
        ModelError, match="'g': 100 % of the energy is in waves longer than 80 s.*a later time of focus"
    ):
        group(time=20.0, name="g", spectrum=WhiteNoise(hs=1.0, omega_min=0.01, omega_max=0.02)).realise(60.0, G)


def test_a_ramp_over_the_focus_is_refused():
    with pytest.raises(ModelError, match="wave_ramp is 100 s, but the waves focus at 60 s"):
        Sea(depth=60.0, waves=group(time=60.0))
    Sea(depth=60.0, waves=group(time=60.0), wave_ramp=40.0)
    both = CombinedWaves(waves=[RegularWave(height=1.0, period=8.0), group(time=60.0)])
    with pytest.raises(ModelError, match="focus at 60 s"):
        Sea(depth=60.0, waves=both)


# --- several at once -------------------------------------------------------------------------------------


def wind(**more):
    return IrregularWaves(**{"spectrum": Jonswap(hs=3.0, tp=7.0), "seed": 1, "heading_deg": 20.0, **more})


def test_combined_waves_add_up():
    swell = IrregularWaves(spectrum=Jonswap(hs=2.0, tp=14.0, gamma=6.0), seed=2, heading_deg=-70.0, duration=1800.0)
    items = [wind(spreading=8.0), swell, group(), CombinedWaves(waves=[RegularWave(height=1.0, period=9.0)])]
    waves = CombinedWaves(waves=items).realise(60.0, G)
    x = np.random.default_rng(1).uniform(-200.0, 0.0, (20, 3))
    parts = [item.realise(60.0, G) for item in items]
    for t in (0.0, 77.7):
        together = exact(waves, x, t)
        for got, each in zip(together, zip(*[exact(part, x, t) for part in parts], strict=True), strict=True):
            assert got == pytest.approx(sum(each), abs=1e-12)
    assert waves.variance == pytest.approx(sum(part.variance for part in parts), rel=1e-12)
    assert waves.duration == 300.0  # of the group, the shortest
    assert seeds(CombinedWaves(waves=items)) == (1, 2)


@pytest.mark.parametrize(
    ("bad", "words"),
    [
        ([], "at least 1 long"),
        (3, "must be a list"),
        ([wind(), "swell"], "got 'swell'; RegularWave"),
        ([wind(), wind()], "the seed 1 is used twice"),
        ([wind(), CombinedWaves(waves=[wind()])], "the seed 1 is used twice"),
    ],
)
def test_combinations_refused(bad, words):
    with pytest.raises(ModelError, match=words):
        CombinedWaves(waves=bad)
