"""Dispersion, spectra and realisations against closed forms, and the phases against PCG64 written out."""

import numpy as np
import pytest

from floatsim.errors import ModelError
from floatsim.sea import Bretschneider, Jonswap, PiersonMoskowitz, Torsethaugen
from floatsim.sea.dispersion import wave_number
from floatsim.sea.waves import IrregularWaves, RegularWave, WaveComponents, ramp_factor

G = 9.81


# --- dispersion ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("depth", [0.3, 20.0, 200.0, 5000.0])
def test_wave_number_solves_the_dispersion_relation(depth):
    omega = np.geomspace(1e-4, 20.0, 500)
    k = wave_number(omega, depth, G)
    # omega^2 has the relative error of k, times at most two, and a few roundings of its own
    assert np.abs(G * k * np.tanh(k * depth) / omega**2 - 1.0).max() < 2e-15


def test_wave_number_limits():
    omega = np.array([0.0, 0.5, 2.0])
    assert wave_number(omega, np.inf, G) == pytest.approx(omega**2 / G, rel=1e-15)
    assert wave_number(2.0, 1000.0, G) == pytest.approx(4.0 / G, rel=1e-15)
    # long waves: k = w/sqrt(g h) (1 + w^2 h/(6 g) + ..), from tanh x = x - x^3/3
    w, h = 1e-3, 50.0
    assert wave_number(w, h, G) == pytest.approx(w / np.sqrt(G * h) * (1.0 + w * w * h / (6.0 * G)), rel=1e-10)
    assert wave_number(0.0, 50.0, G) == 0.0


@pytest.mark.parametrize(("omega", "depth"), [(-1.0, 10.0), (1.0, 0.0), (1.0, -5.0), (np.nan, 10.0), (1.0, np.nan)])
def test_wave_number_refuses_nonsense(omega, depth):
    with pytest.raises(ValueError, match="must be"):
        wave_number(omega, depth, G)


# --- spectra ---------------------------------------------------------------------------------------------


def moment(spectrum, order):
    from scipy.integrate import quad

    peak = 2.0 * np.pi / spectrum.tp
    edges = peak * np.array([0.2, 0.8, 1.0, 1.2, 2.0, 5.0, 20.0, 100.0, 1000.0])
    return sum(
        quad(lambda w: w**order * spectrum.density(np.array([w]))[0], a, b, epsrel=1e-10, epsabs=0.0)[0]
        for a, b in zip(edges[:-1], edges[1:], strict=True)
    )


@pytest.mark.parametrize("cls", [Jonswap, PiersonMoskowitz, Bretschneider, Torsethaugen])
def test_every_spectrum_keeps_its_significant_height(cls):
    assert moment(cls(hs=5.0, tp=11.0), 0) == pytest.approx(25.0 / 16.0, rel=2e-6)


@pytest.mark.parametrize("gamma", [1.0, 2.0, 3.3, 7.0])
def test_jonswap_normalisation_and_peak(gamma):
    spectrum = Jonswap(hs=5.0, tp=11.0, gamma=gamma)
    assert moment(spectrum, 0) == pytest.approx(25.0 / 16.0, rel=2e-6)
    # IEC 61400-3-1 annex C and DNV-RP-C205 3.5.5.5: the fit 1 - 0.287 ln(gamma) of the same constant,
    # within 1 % of hs, that is 2 % of the constant
    assert spectrum.normalisation == pytest.approx(1.0 - 0.287 * np.log(gamma), rel=0.02)
    # at the peak the exponent b is one
    peak = 2.0 * np.pi / 11.0
    expected = spectrum.normalisation * 5.0 / 16.0 * 25.0 / peak * np.exp(-1.25) * gamma
    assert spectrum.density(np.array([peak]))[0] == pytest.approx(expected, rel=1e-12)
    omega = np.linspace(0.2, 3.0, 28001)
    assert omega[spectrum.density(omega).argmax()] == pytest.approx(peak, abs=2e-4)


@pytest.mark.parametrize("gamma", [1.0, 3.3, 5.0])
def test_jonswap_mean_zero_crossing_period(gamma):
    """tz/tp = 0.6673 + 0.05037 gamma - 0.006230 gamma^2 + 0.0003341 gamma^3: a fit, DNV-RP-C205 3.5.5.5."""
    spectrum = Jonswap(hs=3.0, tp=10.0, gamma=gamma)
    tz = 2.0 * np.pi * np.sqrt(moment(spectrum, 0) / moment(spectrum, 2))
    ratio = 0.6673 + 0.05037 * gamma - 0.006230 * gamma**2 + 0.0003341 * gamma**3
    assert tz / 10.0 == pytest.approx(ratio, rel=3e-3)


def test_pierson_moskowitz_is_jonswap_without_enhancement_and_has_its_closed_moments():
    spectrum = PiersonMoskowitz(hs=4.0, tp=9.0)
    omega = np.linspace(0.1, 5.0, 200)
    assert Jonswap(hs=4.0, tp=9.0, gamma=1.0).density(omega) == pytest.approx(spectrum.density(omega), rel=1e-6)
    # m2 = hs^2/16 w_p^2 sqrt(5 pi/4); the tail above 1000 rad/s is 1e-6 of it
    peak = 2.0 * np.pi / 9.0
    assert moment(spectrum, 2) == pytest.approx(peak**2 * np.sqrt(1.25 * np.pi), rel=1e-5)
    assert spectrum.density(np.array([0.0, 1e-9])).tolist() == [0.0, 0.0]


@pytest.mark.parametrize("bad", [{"hs": 0.0}, {"tp": -1.0}, {"gamma": 0.0}, {"hs": "5"}, {"hs": np.nan}, {"Tp": 3.0}])
def test_spectra_refuse_bad_values(bad):
    with pytest.raises(ModelError, match="Jonswap"):
        Jonswap(**{"hs": 5.0, "tp": 11.0, **bad})


# --- realisations ----------------------------------------------------------------------------------------


def sea(**changes):
    values = {"spectrum": Jonswap(hs=6.0, tp=12.0), "seed": 12, **changes}
    return IrregularWaves(**values).realise(200.0, G)


@pytest.mark.parametrize("components", [100, 200, 500])
def test_variance_is_that_of_the_spectrum(components):
    waves = sea(components=components)
    assert waves.variance == pytest.approx(36.0 / 16.0, rel=1e-6)
    assert np.ptp(waves.amplitude) == 0.0
    assert waves.amplitude[0] == pytest.approx(6.0 / np.sqrt(8.0 * components), rel=1e-6)


def test_frequencies_halve_the_energy_of_their_bins():
    """Pierson-Moskowitz has a closed distribution: energy up to w is exp(-5/4 (w_p/w)^4)."""
    omega = sea(spectrum=PiersonMoskowitz(hs=6.0, tp=12.0)).omega
    energy = np.exp(-1.25 * (2.0 * np.pi / 12.0 / omega) ** 4)
    assert energy == pytest.approx((np.arange(200) + 0.5) / 200.0, abs=1e-6)


def pcg64_raw(seed, count):
    """Raw output of PCG64 (O'Neill 2014: PCG XSL RR 128/64) seeded by hashing as NumPy's SeedSequence does, written
    from their published descriptions with plain integers. `seed` below 2^32."""
    m32, m64, m128 = 2**32 - 1, 2**64 - 1, 2**128 - 1
    hash_const = 0x43B0D7E5

    def hashmix(value):
        nonlocal hash_const
        value = (value ^ hash_const) & m32
        hash_const = hash_const * 0x931E8875 & m32
        value = value * hash_const & m32
        return value ^ value >> 16

    def mix(x, y):
        result = (0xCA01F9DD * x - 0x4973F715 * y) & m32
        return result ^ result >> 16

    pool = [hashmix(word) for word in (seed, 0, 0, 0)]
    for source in range(4):
        for target in range(4):
            if source != target:
                pool[target] = mix(pool[target], hashmix(pool[source]))
    words, const = [], 0x8B51F9DD
    for i in range(8):
        value = pool[i % 4] ^ const
        const = const * 0x58F38DED & m32
        value = value * const & m32
        words.append(value ^ value >> 16)
    w = [words[2 * i] | words[2 * i + 1] << 32 for i in range(4)]
    multiplier = 0x2360ED051FC65DA44385DF649FCCF645
    increment = ((w[2] << 64 | w[3]) << 1 | 1) & m128
    state = ((increment + (w[0] << 64 | w[1])) * multiplier + increment) & m128
    out = []
    for _ in range(count):
        state = (state * multiplier + increment) & m128
        value, turn = (state >> 64 ^ state) & m64, state >> 122
        out.append((value >> turn | value << (64 - turn)) & m64)
    return out


def test_phases_are_those_of_pcg64():
    # the first of NumPy's published test vector for this generator (seed 0xdeadbeaf)
    assert pcg64_raw(0xDEADBEAF, 2) == [0x60D24054E17A0698, 0xD5E79D89856E4F12]
    expected = [2.0 * np.pi * (raw >> 11) / 2**53 for raw in pcg64_raw(12, 200)]
    waves = sea(seed=12)
    assert waves.phase == pytest.approx(expected, abs=1e-15)
    # the published vector again, by hand: 0x60d24054e17a0698/2^64 = 0.378208
    assert sea(seed=0xDEADBEAF).phase[0] == pytest.approx(2.0 * np.pi * 0x60D24054E17A0698 / 2**64, abs=1e-14)
    assert waves.phase.min() >= 0.0 and waves.phase.max() < 2.0 * np.pi


def test_same_seed_same_sea_other_seed_other_phases_only():
    one, same, other = sea(seed=4), sea(seed=np.int64(4)), sea(seed=5)
    for name in ("amplitude", "omega", "wave_number", "heading", "phase"):
        assert getattr(one, name).tobytes() == getattr(same, name).tobytes()
    assert (one.omega == other.omega).all() and not np.isclose(one.phase, other.phase).any()
    assert not one.phase.flags.writeable


def test_elevation_has_the_variance_and_does_not_repeat():
    waves = sea(duration=10800.0)
    t = np.arange(0.0, 10800.0, 0.5)
    eta = waves.elevation(0.0, 0.0, t)
    # one realisation of 3 h: 4 std within some 3 % of hs
    assert 4.0 * eta.std() == pytest.approx(6.0, rel=0.03)
    spectrum = np.abs(np.fft.rfft(eta, 2 * t.size)) ** 2
    correlation = np.fft.irfft(spectrum)[: t.size] / np.arange(t.size, 0, -1)
    later = (t > 200.0) & (t < 7200.0)
    assert np.abs(correlation[later]).max() < 0.5 * correlation[0]


def test_a_sea_that_would_repeat_is_refused():
    class Comb:
        """All energy in a narrow, even band: n bins are evenly spaced, and repeat after n 2 pi/(width)."""

        def density(self, omega):
            return np.where(np.abs(omega - 0.6) < 0.05, 1.0, 0.0)

    # 20 bins 0.005 rad/s wide come back after 2 pi/0.005 = 1257 s; the envelope |sin(20 x)/(20 sin x)|,
    # x = 0.005 tau/2, is above one half from 20 x = 20 pi - 1.8955 on: 1219 s (and 3 s from sample to sample)
    with pytest.raises(ModelError, match=r"'swell': 20 components repeat after 12(19|2\d) s, the sea must last 3600 s"):
        IrregularWaves(spectrum=Comb(), seed=1, components=20, name="swell").realise(100.0, G)
    waves = IrregularWaves(spectrum=Comb(), seed=1, components=20, duration=1000.0).realise(100.0, G)
    assert waves.duration == 1000.0
    with pytest.raises(ModelError, match="repeat after"):
        IrregularWaves(spectrum=Comb(), seed=1, components=1).realise(100.0, G)


def test_a_spectrum_of_the_users_own():
    class Box:
        def density(self, omega):
            return np.where((omega > 0.4) & (omega < 1.0), 2.0, 0.0)

    waves = IrregularWaves(spectrum=Box(), seed=1, duration=1800.0).realise(np.inf, G)
    # 2 m2 s/rad over 0.6 rad/s, even spacing; the edges fall between the points of the grid (3.5e-4 apart in ln w)
    assert waves.variance == pytest.approx(1.2, rel=1e-3)
    assert waves.omega == pytest.approx(0.4 + 0.6 * (np.arange(200) + 0.5) / 200.0, abs=4e-4)

    class Negative:
        def density(self, omega):
            return np.sin(omega)

    class Nothing:
        def density(self, omega):
            return 0.0 * omega

    for bad, message in ((Negative(), "not negative"), (Nothing(), "no energy")):
        with pytest.raises(ModelError, match=message):
            IrregularWaves(spectrum=bad, seed=1).realise(np.inf, G)
    with pytest.raises(ModelError, match="density"):
        IrregularWaves(spectrum="jonswap", seed=1)


def test_a_cut_leaves_the_rest_as_it_was():
    """Energy of Pierson-Moskowitz below w is hs^2/16 exp(-5/4 (w_p/w)^4)."""
    spectrum = PiersonMoskowitz(hs=6.0, tp=12.0)
    waves = sea(spectrum=spectrum, omega_max=1.0)
    assert waves.omega.max() < 1.0
    assert waves.variance == pytest.approx(36.0 / 16.0 * np.exp(-1.25 * (2.0 * np.pi / 12.0) ** 4), rel=1e-6)


@pytest.mark.parametrize(
    "bad",
    [
        {"seed": -1},
        {"seed": 1.5},
        {"seed": True},
        {"components": 0},
        {"duration": 0.0},
        {"hs": 3.0},
        {"heading_deg": np.inf},
    ],
)
def test_irregular_waves_refuse_bad_values(bad):
    with pytest.raises(ModelError, match=f"IrregularWaves.*{next(iter(bad))}"):
        sea(**bad)


# --- regular waves and components ------------------------------------------------------------------------


def test_regular_wave_travels_where_it_says():
    wave = RegularWave(height=3.0, period=9.0, heading_deg=30.0, phase_deg=40.0).realise(50.0, G)
    omega, k = 2.0 * np.pi / 9.0, float(wave_number(2.0 * np.pi / 9.0, 50.0, G))
    x, y, t = 12.0, -7.0, 4.0
    along = x * np.cos(np.pi / 6.0) + y * np.sin(np.pi / 6.0)
    assert wave.elevation(x, y, t) == pytest.approx(1.5 * np.cos(omega * t - k * along + np.radians(40.0)), abs=1e-12)
    # a crest moves towards the heading with w/k
    c = omega / k
    ahead = (x + c * 2.0 * np.cos(np.pi / 6.0), y + c * 2.0 * np.sin(np.pi / 6.0))
    assert wave.elevation(*ahead, t + 2.0) == pytest.approx(wave.elevation(x, y, t), abs=1e-12)
    assert np.isinf(wave.duration)


def test_components_add_up_and_broadcast():
    both = WaveComponents(amplitude=(1.0, 0.5), omega=(0.5, 1.1), heading_deg=(0.0, 90.0), phase_deg=10.0).realise(
        80.0, G
    )
    one = RegularWave(height=2.0, period=2.0 * np.pi / 0.5, phase_deg=10.0).realise(80.0, G)
    two = WaveComponents(amplitude=[0.5], period=[2.0 * np.pi / 1.1], heading_deg=90.0, phase_deg=[10.0]).realise(
        80.0, G
    )
    x = np.linspace(-50.0, 50.0, 4)[:, None]
    t = np.linspace(0.0, 30.0, 5)
    total = both.elevation(x, 3.0, t)
    assert total.shape == (4, 5)
    assert total == pytest.approx(one.elevation(x, 3.0, t) + two.elevation(x, 3.0, t), abs=1e-12)
    assert both.variance == pytest.approx(0.5 + 0.125)


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        ({"omega": None}, "either period or omega"),
        ({"period": (3.0, 4.0)}, "either period or omega"),
        ({"omega": (1.0,)}, "omega has 1 values, amplitude has 2"),
        ({"phase_deg": (1.0, 2.0, 3.0)}, "phase_deg has 3 values"),
        ({"amplitude": (1.0, -1.0)}, "negative"),
        ({"omega": (1.0, 0.0)}, "positive"),
        ({"amplitude": ()}, "amplitude"),
        ({"omega": (1.0, np.nan)}, "omega"),
    ],
)
def test_components_refuse_bad_values(bad, message):
    with pytest.raises(ModelError, match=message):
        WaveComponents(**{"amplitude": (1.0, 2.0), "omega": (1.0, 1.5), **bad})


def test_cosine_ramp():
    assert [ramp_factor(t, 100.0) for t in (-1.0, 0.0, 50.0, 100.0, 1e9)] == pytest.approx([0.0, 0.0, 0.5, 1.0, 1.0])
    assert ramp_factor(25.0, 100.0) == pytest.approx(0.5 - np.sqrt(0.125))
    assert ramp_factor(-5.0, 0.0) == ramp_factor(0.0, 0.0) == 1.0
    wave = RegularWave(height=2.0, period=8.0).realise(50.0, G)
    t = np.array([10.0, 60.0])
    assert wave.elevation(0.0, 0.0, t, ramp=40.0) == pytest.approx(
        wave.elevation(0.0, 0.0, t) * [0.5 - np.sqrt(0.125), 1.0]
    )


def test_a_sea_cut_below_its_peak_is_refused():
    """0.3 Hz taken for rad/s: nothing of a sea of 8 s (0.785 rad/s) would be left."""
    waves = IrregularWaves(spectrum=Jonswap(hs=3.0, tp=8.0), seed=1, omega_max=0.3)
    with pytest.raises(ModelError, match=r"omega_max 0.3 rad/s cuts off 100 % of the sea's energy"):
        waves.realise(100.0, G)
    assert IrregularWaves(spectrum=Jonswap(hs=3.0, tp=8.0), seed=1, omega_max=1.6).realise(100.0, G).variance < 0.5625
