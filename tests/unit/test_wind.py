"""Wind and turbulence against closed forms; bad input of wind, rotor and controller."""

from __future__ import annotations

import math
import pickle

import made_up_rotor
import numpy as np
import pytest

import floatsim as fs
from floatsim.wind.turbulence import disc_admittance

U, TI = 12.0, 0.15


def test_power_law_and_heading():
    wind = fs.Wind(speed=10.0, heading_deg=30.0, height=150.0, shear=0.14)
    assert wind.mean(150.0, 90.0) == pytest.approx(10.0)
    assert wind.mean(75.0, 90.0) == pytest.approx(10.0 * 0.5**0.14)
    assert wind.mean(0.0, 90.0) == wind.mean(-5.0, 90.0) == 0.0
    assert wind.direction == pytest.approx([math.cos(math.pi / 6), 0.5, 0.0])
    assert fs.Wind(speed=10.0, shear=0.2).mean(90.0, 90.0) == 10.0  # height left out: the hub's


def test_density_integrates_to_one():
    kaimal = fs.Kaimal(intensity=TI, seed=1)
    f = np.concatenate([[0.0], np.geomspace(1e-7, 1e8, 20001)])
    assert np.trapezoid(kaimal.density(f, U), f) == pytest.approx(1.0, abs=2e-5)


def test_variance_and_spectrum(record):
    """At a point: the variance asked for; in bands the closed form's energy, over that of the whole band."""
    kaimal = fs.Kaimal(intensity=TI, seed=1)
    packed = kaimal.realise(U, 0.0).packed
    energy = 0.5 * packed[:, 0] ** 2
    check = "Kaimal turbulence against closed forms"
    record(check, "variance at a point over (TI U)^2, less 1", abs(energy.sum() / (TI * U) ** 2 - 1.0), 1e-12)
    slope = 6.0 * kaimal.length_scale / U

    def below(f):
        return 1.0 - (1.0 + slope * f) ** (-2.0 / 3.0)

    edges = np.geomspace(1.0 / 600.0, 0.5, 8)
    worst = 0.0
    for a, b in zip(edges[:-1], edges[1:], strict=True):
        inside = (packed[:, 1] >= 2 * np.pi * a) & (packed[:, 1] < 2 * np.pi * b)
        asked = (below(b) - below(a)) / (below(0.5) - below(1.0 / 600.0))
        worst = max(worst, abs(energy[inside].sum() / energy.sum() - asked))
    record(check, "energy in seven bands, largest error over the whole", worst, 1.0 / 400)


def test_series_has_the_variance():
    """Of the sum itself over a day, in which harmonics 2e-5 Hz apart can be told from each other."""
    gust = fs.Kaimal(intensity=TI, seed=3).realise(U, 0.0)
    series = np.array([gust.at(t) for t in np.arange(0.0, 1e5, 2.1)])
    assert series.mean() == pytest.approx(0.0, abs=0.01 * TI * U)
    assert series.std() == pytest.approx(TI * U, rel=0.03)


def test_same_seed_same_wind():
    a, b, c = (fs.Kaimal(intensity=TI, seed=seed).realise(U, 120.0).packed for seed in (7, 7, 8))
    assert a.tobytes() == b.tobytes() and not np.array_equal(a[:, 2], c[:, 2])
    raw = np.random.PCG64(7).jumped().random_raw(400)
    assert a[:, 2] == pytest.approx([(int(k) >> 11) * 2 * math.pi / 2**53 for k in raw], rel=1e-15)
    assert np.array_equal(a[:, 0], c[:, 0])  # amplitudes are deterministic


def test_wind_and_sea_of_one_seed_are_independent():
    """Same phases, and all waves and gusts would start together: correlation 0.9 over seeds at the start."""
    seeds, n = range(40), 200
    wind = np.array([fs.Kaimal(intensity=TI, seed=k).realise(U, 0.0).packed[:n, 2] for k in seeds])
    sea = fs.Jonswap(hs=6.0, tp=11.0)
    for more in ({}, {"spreading": 5.0}):
        waves = np.array([fs.IrregularWaves(spectrum=sea, seed=k, **more).realise(82.0, 9.81).phase for k in seeds])
        for shift in range(n):
            assert abs(np.exp(1j * (wind - np.roll(waves, shift, axis=1))).mean()) < 4.5 / math.sqrt(waves.size)


def test_disc_admittance(record):
    """Against the double integral over the disc, point by point, and its limits."""
    rng = np.random.default_rng(1)
    n = 1_500_000
    r, angle = np.sqrt(rng.random((2, n))), 2 * np.pi * rng.random((2, n))
    p = r * np.exp(1j * angle)
    distance = np.abs(p[0] - p[1])
    worst = max(abs(disc_admittance(q) - np.exp(-q * distance).mean()) for q in (0.1, 1.0, 3.0, 10.0))
    record("Kaimal turbulence against closed forms", "mean over a disc against drawn pairs of points", worst, 1e-3)
    # mean distance of two points in a disc is 128 R/(45 pi)
    assert (1.0 - disc_admittance(1e-6)) / 1e-6 == pytest.approx(128.0 / (45.0 * math.pi), rel=1e-5)
    assert disc_admittance(0.0) == pytest.approx(1.0, abs=1e-13)
    assert disc_admittance(80.0) == pytest.approx(8.0 / 160.0**2, rel=2e-2)


def test_rotor_average_is_weaker(record):
    """Ratio of standard deviations, disc over point, against the integral of chi^2 S over the band."""
    kaimal = fs.Kaimal(intensity=TI, seed=1)
    ratio = math.sqrt(kaimal.realise(U, 120.97).variance / kaimal.realise(U, 0.0).variance)
    f = np.geomspace(1.0 / 600.0, 0.5, 4001)
    S = kaimal.density(f, U)
    chi2 = disc_admittance(120.97 * kaimal.decay(f, U))
    asked = math.sqrt(np.trapezoid(chi2 * S, f) / np.trapezoid(S, f))
    check = "Kaimal turbulence against closed forms"
    record(check, "standard deviation, disc of 121 m over point, less that of the integral", abs(ratio - asked), 2e-3)
    assert 0.4 < ratio < 0.9


def test_ramp_raises_turbulence_not_the_mean():
    wind = fs.Wind(speed=U, turbulence=fs.Kaimal(intensity=TI, seed=1)).at_a_point()
    bare = wind.fluctuation
    assert wind.at(0.0, 100.0) == U
    assert wind.at(50.0, 100.0) == pytest.approx(U + 0.5 * bare.at(50.0))
    assert wind.at(100.0, 100.0) == pytest.approx(U + bare.at(100.0))


def test_pickles():
    wind = fs.Wind(speed=U, turbulence=fs.Kaimal(intensity=TI, seed=1))
    assert pickle.loads(pickle.dumps(wind)) == wind


def rotor(body="nacelle", **more):
    return made_up_rotor.rotor(body, **more)


def model(*parts, wind=None):
    body = fs.Body(name="nacelle", mass=1e6, inertia=(1e9, 1e9, 1e9), position=(0, 0, 90))
    return fs.Model(parts=[body, *parts], sea=fs.Sea(depth=200.0), wind=wind)


CONTROL = dict(rated_speed=1.0, rated_torque=2e7, torque_gain=1e7)
SURFACE = dict(radius=50.0, tip_speed_ratio=(2, 4, 6, 8), pitch_deg=(0, 5, 10, 20), power=np.ones((4, 4)),
               thrust=np.ones((4, 4)))  # fmt: skip


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: fs.Wind(speed=-1.0), "speed: got -1.0; must be a number that is not negative"),
        (lambda: fs.Wind(speed=8.0, heading=3.0), "unknown argument 'heading' (did you mean 'heading_deg'?)"),
        (lambda: fs.Wind(speed=8.0, turbulence=0.14), "Kaimal(intensity=..., seed=...) or None"),
        (lambda: fs.Wind(speed=8.0, turbulence=fs.Kaimal), "Kaimal(intensity=..., seed=...) or None"),
        (lambda: fs.Kaimal(intensity=0.1, seed=-1), "seed"),
        (lambda: fs.Kaimal(intensity=0.1, seed=1, highest_frequency=1e-3), "nothing is left between them"),
        (lambda: fs.Kaimal(intensity=0.1, seed=1, components=20).realise(12.0, 0.0), "20 components repeat after"),
        (lambda: fs.Kaimal(intensity=0.1, seed=1).realise(0.0, 0.0), "turbulence needs a wind"),
        (lambda: model(wind=fs.Wind(speed=8.0)), "nothing in the model takes it; add a Rotor"),
        (lambda: model(rotor(), wind=8.0), "wind: got 8.0; Wind(speed=...)"),
        (lambda: model(rotor()), "Rotor 'rotor': the model has no wind"),
        (lambda: model(rotor(body="nacele"), wind=fs.Wind(speed=8.0)), "no connection point 'nacele'"),
        (lambda: rotor(tilt_deg=50.0), "tilt_deg: got 50; must be less than 45"),
        (lambda: rotor(generator_efficiency=95.0), "must not exceed 1"),
        (lambda: rotor(cut_in=30.0), "cut_in is 30 m/s, cut_out 25 m/s"),
        (lambda: fs.Controller(**CONTROL | {"minimum_speed": 1.0}), "must be well below rated_speed"),
        (lambda: fs.Controller(**CONTROL | {"torque_gain": 3e7}), "more than rated_torque"),
        (lambda: fs.Controller(**CONTROL, fine_pitch_deg=(1.0, 2.0)), "fine_pitch_torque has 1 values"),
        (lambda: fs.Controller(**CONTROL, maximum_pitch_deg=3.0), "maximum_pitch_deg is 3"),
        (lambda: fs.PerformanceSurface(**SURFACE | {"pitch_deg": (0, 5, 5, 20)}), "pitch_deg must increase"),
        (lambda: fs.PerformanceSurface(**SURFACE | {"power": np.ones((4, 3))}), "power has 4 rows of [3] values"),
        (lambda: fs.PerformanceSurface(**SURFACE | {"thrust": [[math.nan] * 4] * 4}), "rows of finite numbers"),
        (lambda: fs.Tower(base=(0, 0, 1), top=(0, 0, 1), diameter=(5, 5)), "base and top are the same place"),
        (lambda: fs.Tower(base=(0, 0, 1), top=(0, 0, 9), diameter=(5, 0)), "both must be positive"),
    ],
)
def test_bad_input(make, words):
    with pytest.raises(fs.ModelError) as error:
        make()
    assert words in str(error.value)


def test_rotor_needs_a_body():
    mass = fs.PointMass(name="nacelle", mass=1e6, position=(0, 0, 90))
    with pytest.raises(fs.ModelError, match="'nacelle' has no attitude; a body is needed"):
        fs.assemble(fs.Model(parts=[mass, rotor()], sea=fs.Sea(depth=200.0), wind=fs.Wind(speed=8.0)))


def test_surface_without_power():
    with pytest.raises(fs.ModelError, match="makes rated_torque at rated_speed at no pitch"):
        fs.assemble(model(rotor(control={"rated_torque": 1e12}), wind=fs.Wind(speed=8.0)))


def test_run_longer_than_the_turbulence():
    wind = fs.Wind(speed=8.0, turbulence=fs.Kaimal(intensity=0.1, seed=1, duration=600.0))
    body = fs.Weld(a="nacelle", b=(0, 0, 90))
    held = fs.Model(parts=model(rotor(), wind=wind).parts, joints=[body], sea=fs.Sea(depth=200.0), wind=wind)
    with pytest.raises(fs.CaseError, match="only known not to repeat until 600 s"):
        fs.simulate(held, 700.0)


def test_wind_too_strong_for_the_pitch():
    with pytest.raises(fs.ModelError, match="at 24 m/s it has .* more than rated_torque; give a lower cut_out"):
        fs.assemble(model(rotor(control={"maximum_pitch_deg": 6.0}), wind=fs.Wind(speed=24.0)))


def test_frequency_domain_is_refused():
    weld = fs.Weld(a="nacelle", b=(0, 0, 90))
    wind = fs.Wind(speed=8.0)
    held = fs.Model(parts=model(rotor(), wind=wind).parts, joints=[weld], sea=fs.Sea(depth=200.0), wind=wind)
    with pytest.raises(fs.CaseError, match="the model has a wind"):
        fs.frequency_response(held, [0.1, 0.2])


def test_a_sea_of_the_same_seed_has_other_phases():
    waves = fs.IrregularWaves(spectrum=fs.Jonswap(hs=2.0, tp=8.0), seed=5, components=100).realise(100.0, 9.81)
    wind = fs.Kaimal(intensity=0.1, seed=5, components=400).realise(10.0, 0.0)
    assert not set(np.round(waves.phase % (2.0 * np.pi), 9)) & set(np.round(wind.packed[:, 2], 9))


def test_an_intensity_in_per_cent_is_refused():
    with pytest.raises(fs.ModelError, match="0.14 for 14 %"):
        fs.Kaimal(intensity=14.0, seed=1)
