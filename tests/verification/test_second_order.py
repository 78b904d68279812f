"""Second-order wave forces against the double sum they stand for, and closed forms of one and two waves."""

import numpy as np
import pytest
from second_order import (
    GRAVITY,
    band_variance,
    database,
    excitation,
    formula,
    mean_drift,
    series,
    slow_variance,
    sum_formula,
    synthetic,
)

from floatsim.errors import ModelError
from floatsim.hydro.drift import Newman, PairSum
from floatsim.hydro.wave_loads import WaveLoads
from floatsim.sea.spectra import Jonswap
from floatsim.sea.waves import IrregularWaves, RegularWave, WaveComponents

ROW = "second-order wave forces from a full QTF"
ROW_SLOW = "loads at the slow position"
SPECTRUM = Jonswap(hs=5.0, tp=10.0)


def irregular(seed=1, **changes):
    return IrregularWaves(spectrum=SPECTRUM, seed=seed, omega_max=2.5, **changes).realise(np.inf, GRAVITY)


def double_sum(qtf, sea, t, x=0.0, y=0.0):
    """(6,), written out with cosines and sines, both orders of every pair."""
    T = np.nan_to_num(qtf.matrix(sea.omega, 0.0))
    phase = sea.omega * t + sea.phase
    phase = phase - sea.wave_number * (x * np.cos(sea.heading) + y * np.sin(sea.heading))
    angle = phase[:, None] + (-1.0 if qtf.kind == "difference" else 1.0) * phase
    weight = sea.amplitude[:, None] * sea.amplitude
    return np.einsum("mn,mnd->d", weight * np.cos(angle), T.real) - np.einsum(
        "mn,mnd->d", weight * np.sin(angle), T.imag
    )


@pytest.mark.parametrize("kind", ["difference", "sum"])
def test_series_is_the_double_sum(kind, record):
    qtf, sea = synthetic(kind), irregular()
    at = (130.0, -40.0)
    loads = WaveLoads(database(reference_point=np.array([4.0, -3.0, 0.0])), sea, at, drift=synthetic(
        kind, reference_point=np.array([4.0, -3.0, 0.0])))  # fmt: skip
    times = (0.0, 0.37, 11.0, 812.3, 3599.0)
    exact = np.array([double_sum(qtf, sea, t, at[0] - 4.0, at[1] + 3.0) for t in times])
    got = np.array([loads.forces(t)[1] for t in times])
    scale = np.abs(exact).max(axis=0)[[0, 2, 4] if kind == "difference" else [2, 4]].min()
    record(ROW, f"{kind} frequencies, 200 waves: series against the direct double sum, relative",
           np.abs(got - exact).max() / scale, 1e-6)  # fmt: skip


def test_mean_of_the_series(record):
    """Waves at multiples of 0.01 rad/s: the mean over their common period is that over all time."""
    n = 120
    rng = np.random.default_rng(7)
    sea = WaveComponents(amplitude=tuple(rng.uniform(0.0, 0.2, n)), omega=tuple(0.01 * (30 + np.arange(n))),
                         phase_deg=tuple(rng.uniform(0.0, 360.0, n))).realise(np.inf, GRAVITY)  # fmt: skip
    force = PairSum(synthetic(), sea, 0.0)
    period = 2.0 * np.pi / 0.01
    mean = series(force, sea, np.arange(256) * period / 256).mean(axis=0)
    q = synthetic()
    diagonal = np.stack([np.interp(sea.omega, q.omega, np.diagonal(q.transfer[0, :, :, d]).real) for d in range(6)])
    exact = diagonal @ sea.amplitude**2
    assert exact[[0, 2, 4]].all()
    record(ROW, "mean of the series against the sum of a^2 T(w, w), relative",
           (np.abs(mean - exact)[[0, 2, 4]] / np.abs(exact[[0, 2, 4]])).max(), 1e-6)  # fmt: skip
    assert force.mean == pytest.approx(exact, rel=1e-12)


def test_regular_wave():
    """Difference: a^2 T(w, w), constant. Sum: Re a^2 T(w, w) e^{2 i w t}."""
    w = 0.75
    sea = RegularWave(height=3.0, period=2.0 * np.pi / w, phase_deg=40.0).realise(np.inf, GRAVITY)
    slow, fast = PairSum(synthetic(), sea, 0.0), PairSum(synthetic("sum"), sea, 0.0)
    times = np.array([0.0, 1.3, 2.6, 900.0])
    exact = 1.5**2 * formula(w, w)
    assert exact.imag == pytest.approx(np.zeros(6))
    assert series(slow, sea, times) == pytest.approx(np.tile(exact.real, (4, 1)), rel=1e-9)
    assert slow.mean == pytest.approx(exact.real, rel=1e-9)
    turn = np.exp(2j * (w * times + np.radians(40.0)))
    assert series(fast, sea, times) == pytest.approx((1.5**2 * sum_formula(w, w) * turn[:, None]).real, rel=1e-9)
    assert not fast.mean.any()


def test_two_waves():
    """a1^2 T11 + a2^2 T22 + 2 Re T12 a1 a2 e^{i (w1 - w2) t}: the pair counts twice, w1 > w2 positive."""
    w, a, phase = np.array([0.9, 0.75]), np.array([1.2, 0.7]), np.radians([10.0, 75.0])
    sea = WaveComponents(amplitude=tuple(a), omega=tuple(w), phase_deg=(10.0, 75.0)).realise(np.inf, GRAVITY)
    times = np.linspace(0.0, 50.0, 11)
    slow = a[0] ** 2 * formula(w[0], w[0]).real + a[1] ** 2 * formula(w[1], w[1]).real
    beat = np.exp(1j * ((w[0] - w[1]) * times + phase[0] - phase[1]))[:, None]
    slow = slow + 2.0 * a[0] * a[1] * (formula(w[0], w[1]) * beat).real
    assert series(PairSum(synthetic(), sea, 0.0), sea, times) == pytest.approx(slow, rel=1e-9, abs=1e-6)
    fast = sum(
        count * a[m] * a[n] * sum_formula(w[m], w[n])
        * np.exp(1j * ((w[m] + w[n]) * times + phase[m] + phase[n]))[:, None]
        for m, n, count in ((0, 0, 1.0), (1, 1, 1.0), (0, 1, 2.0))
    ).real  # fmt: skip
    assert series(PairSum(synthetic("sum"), sea, 0.0), sea, times) == pytest.approx(fast, rel=1e-9, abs=1e-6)


def test_order_of_the_waves_does_not_matter():
    sea = WaveComponents(amplitude=(0.7, 1.2), omega=(0.75, 0.9), phase_deg=(75.0, 10.0)).realise(np.inf, GRAVITY)
    other = WaveComponents(amplitude=(1.2, 0.7), omega=(0.9, 0.75), phase_deg=(10.0, 75.0)).realise(np.inf, GRAVITY)
    t = np.array([3.0])
    for kind in ("difference", "sum"):
        one, two = (series(PairSum(synthetic(kind), s, 0.0), s, t) for s in (sea, other))
        assert one == pytest.approx(two, rel=1e-12)


def test_outside_the_range_it_is_zero_and_said():
    sea = WaveComponents(amplitude=(1.0, 0.8, 0.5), omega=(0.8, 0.9, 1.7)).realise(np.inf, GRAVITY)
    narrow, inside = synthetic(top=1.5), WaveComponents(amplitude=(1.0, 0.8), omega=(0.8, 0.9))
    loads = WaveLoads(database(), sea, drift=narrow)
    only = inside.realise(np.inf, GRAVITY)
    assert loads.forces(7.0)[1] == pytest.approx(double_sum(narrow, only, 7.0), rel=1e-9, abs=1e-6)
    share = 1.0 - (1.0 + 0.64) ** 2 / (1.0 + 0.64 + 0.25) ** 2
    assert PairSum(narrow, sea, 0.0).left_out == pytest.approx(share)
    (message,) = loads.messages
    assert "'formula' is known from 0.2 to 1.5 rad/s: 25 % of the products" in message
    assert WaveLoads(database(), only, drift=narrow).messages == ()


# --- Newman ----------------------------------------------------------------------------------------


def test_newman_mean_and_regular_wave():
    sea = irregular(heading_deg=35.0)
    loads = WaveLoads(database(), sea, drift="newman")
    b = np.radians(35.0)
    exact = sum(a**2 * mean_drift(w, b) for a, w in zip(sea.amplitude, sea.omega, strict=True))
    assert loads.mean_force() == pytest.approx(exact, rel=1e-2)  # the database is linear between 0.05 rad/s
    regular = RegularWave(height=3.0, period=2.0 * np.pi / 0.8, heading_deg=35.0).realise(np.inf, GRAVITY)
    one = WaveLoads(database(), regular, drift="newman")
    for t in (0.0, 2.2):
        assert one.forces(t)[1] == pytest.approx(1.5**2 * mean_drift(0.8, b), rel=1e-9)


def test_newman_is_the_double_sum_of_geometric_means():
    sea = irregular()
    D = np.array([mean_drift(w, 0.0) for w in sea.omega])
    assert (D[:, 4] > 0.0).any() and (D[:, 4] < 0.0).any()
    same = D[:, None] * D > 0.0
    T = np.where(same, np.sign(D)[:, None] * np.sqrt(np.abs(D[:, None] * D)), 0.0)
    t = 77.0
    y = sea.amplitude * np.exp(1j * (sea.omega * t + sea.phase))
    exact = np.einsum("m,n,mnd->d", y, y.conj(), T).real
    assert series(Newman(D, sea), sea, [t])[0] == pytest.approx(exact, rel=1e-9, abs=1e-6)


def test_newman_of_spread_waves_has_their_mean():
    sea = irregular(spreading=6.0)
    loads = WaveLoads(database(), sea, drift="newman")
    pairs = zip(sea.amplitude, sea.omega, sea.heading, strict=True)
    exact = sum(a**2 * mean_drift(w, b) for a, w, b in pairs)
    assert loads.mean_force()[[0, 2, 4]] == pytest.approx(exact[[0, 2, 4]], rel=1e-2)


# --- ramp, place, heading ------------------------------------------------------------------------------


def test_ramp_works_on_what_oscillates():
    """The mean is there from the start, as it is in statics."""
    plain = WaveLoads(database(), irregular(), drift=synthetic())
    ramped = WaveLoads(database(), irregular(), ramp=80.0, drift=synthetic())
    r = 0.5 - np.sqrt(0.125)
    (f1, f2), (g1, g2) = plain.forces(20.0), ramped.forces(20.0)
    mean = plain.mean_force()
    assert g1 == pytest.approx(r * f1)
    assert g2 == pytest.approx(mean + r**2 * (f2 - mean))
    assert ramped.force(0.0) == pytest.approx(mean)
    assert ramped.force(90.0) == pytest.approx(plain.force(90.0))
    assert plain.force(20.0) == pytest.approx(f1 + f2)


def test_phase_at_a_constant_offset(record):
    """50 m along the waves: the excitation lags by 50 k, a beat by 50 (k1 - k2)."""
    w = 0.7
    regular = RegularWave(height=2.0, period=2.0 * np.pi / w).realise(np.inf, GRAVITY)
    loads, k = WaveLoads(database(), regular, slow_position=True), w**2 / GRAVITY
    drawn = WaveLoads(database(), regular)
    X = []
    for item, slow in ((drawn, None), (loads, np.array([50.0, 7.0, 0.0]))):
        f = [item.force(t, slow)[2] for t in (0.0, 0.5 * np.pi / w)]
        X.append(f[0] - 1j * f[1])
    turn = np.angle(X[1] / X[0] * np.exp(50j * k))
    record(ROW_SLOW, "constant offset of 50 m: excitation phase against -50 k", abs(turn), 1e-9, "rad")
    assert abs(X[1]) == pytest.approx(abs(X[0]))
    sea = WaveComponents(amplitude=(1.0, 0.8), omega=(0.9, 0.75)).realise(np.inf, GRAVITY)
    here = WaveLoads(database(), sea, drift=synthetic(), slow_position=True)
    lag = 50.0 * (0.9**2 - 0.75**2) / GRAVITY / 0.15
    there = here.forces(40.0 + lag, np.array([50.0, 0.0, 0.0]))[1]
    assert there == pytest.approx(here.forces(40.0)[1], rel=1e-9, abs=1e-6)


@pytest.mark.parametrize("drift", ["newman", "two headings"])
def test_turned_by_whole_degrees_it_is_as_if_drawn_so(drift):
    qtf = synthetic()
    both = synthetic(headings=np.radians([-10.0, 15.0]), transfer=np.concatenate([qtf.transfer, 2.0 * qtf.transfer]))
    sea = irregular()
    given = drift if drift == "newman" else both
    drawn = WaveLoads(database(), sea, (3.0, 4.0), np.radians(6.0), drift=given)
    loads = WaveLoads(database(), sea, (0.0, 0.0), np.radians(2.0), drift=given, slow_position=True)
    turn = np.eye(6)
    c, s = np.cos(np.radians(4.0)), np.sin(np.radians(4.0))
    for h in (0, 3):
        turn[h : h + 2, h : h + 2] = [[c, -s], [s, c]]
    slow = np.array([3.0, 4.0, np.radians(4.0)])
    for got, exact in zip(loads.forces(55.0, slow), drawn.forces(55.0), strict=True):
        assert got == pytest.approx(turn @ exact, rel=1e-6, abs=1e-6 * np.abs(exact).max())
    assert loads.mean_force(slow[2]) == pytest.approx(turn @ drawn.mean_force(), rel=1e-6, abs=1.0)


def test_between_degrees_there_are_no_jumps():
    """Linear between whole degrees: second-order error, and continuous where one table follows another."""
    sea = RegularWave(height=2.0, period=7.0, heading_deg=20.0).realise(np.inf, GRAVITY)  # 20 m are 1.6/k
    loads = WaveLoads(database(), sea, drift="newman", slow_position=True)
    half = np.radians(0.5)
    exact = WaveLoads(database(), sea, (0.0, 0.0), half)
    X = loads.forces(31.0, np.array([0.0, 0.0, half]))[0]
    Y = exact.force(31.0)
    c, s = np.cos(half), np.sin(half)
    Y = np.array([c * Y[0] - s * Y[1], s * Y[0] + c * Y[1], Y[2], c * Y[3] - s * Y[4], s * Y[3] + c * Y[4], Y[5]])
    assert np.abs((X - Y)[:3]).max() < 5e-4 * np.abs(Y[:3]).max()
    assert np.abs((X - Y)[3:]).max() < 5e-4 * np.abs(Y[3:]).max()
    for degree in (-1.0, 0.0, 1.0):
        sides = [loads.force(31.0, np.array([0.0, 0.0, np.radians(degree) + side])) for side in (-1e-9, 0.0, 1e-9)]
        assert np.abs(np.diff(sides, axis=0)).max() < 1e-6 * np.abs(sides[0]).max()


def test_a_qtf_of_one_heading_stays_with_the_waves():
    loads = WaveLoads(database(), irregular(), drift=synthetic(), slow_position=True)
    slow = np.array([0.0, 0.0, np.radians(7.3)])
    assert loads.forces(31.0, slow)[1] == pytest.approx(loads.forces(31.0)[1])


# --- parts of the database --------------------------------------------------------------------------------


def test_without_froude_krylov_and_the_second_of_two_bodies():
    """The second body is the columns 100 m further on, its moments about its own point."""
    w = 0.8
    sea = RegularWave(height=2.0, period=2.0 * np.pi / w).realise(np.inf, GRAVITY)
    one = database()
    shift = np.exp(-100j * one.omega**2 / GRAVITY)[:, None] ** np.cos(one.headings)
    X = np.concatenate([np.zeros_like(one.excitation), shift[..., None] * one.excitation], axis=2)
    D = np.concatenate([np.zeros_like(one.mean_drift), one.mean_drift], axis=2)
    zero, C = np.zeros((60, 12, 12)), np.zeros((12, 12))
    C[6:, 6:] = one.hydrostatic_stiffness
    two = database(bodies=("a", "b"), excitation=X, froude_krylov=0.6 * X, mean_drift=D, hydrostatic_stiffness=C,
                   added_mass=zero, radiation_damping=zero, added_mass_inf=np.eye(12), volume=np.ones(2),
                   centre_of_buoyancy=np.zeros((2, 3)),
                   reference_point=np.array([[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]]))  # fmt: skip
    t = 3.0
    far = np.exp(1j * w * t - 100j * w**2 / GRAVITY)
    second = WaveLoads(two, sea, (100.0, 0.0), body=1, drift="newman")
    first, drift = second.forces(t)
    exact = (excitation(w, 0.0) * far).real
    assert first == pytest.approx(exact, rel=1e-4, abs=1e-4 * np.abs(exact).max())
    assert drift == pytest.approx(mean_drift(w, 0.0), rel=1e-9)
    rest = WaveLoads(two, sea, (100.0, 0.0), body=1, froude_krylov=False).force(t)
    assert rest == pytest.approx(0.4 * first, rel=1e-4, abs=1e-4 * np.abs(exact).max())
    (message,) = WaveLoads(two, sea, (100.0, 0.0), body=1, froude_krylov=False, drift="newman").messages
    assert "counts part of the second-order force twice" in message
    assert WaveLoads(two, sea, body=0).force(t) == pytest.approx(np.zeros(6))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"drift": "Newman"}, "drift: got 'Newman'; must be 'newman', a QTF"),
        ({"drift": 3.0}, "drift: got 3.0"),
        ({"drift": ("newman", synthetic())}, "kinds difference, difference; at most one of each"),
        ({"drift": synthetic(reference_point=np.array([0.0, 0.0, 1.0]))}, r"moments are about \[0.0, 0.0, 1.0\] m"),
        ({"drift": synthetic(), "heading": 0.1}, "'formula': waves at -5.73 deg relative to the body, .* at 0 deg"),
        ({"drift": synthetic(), "sea": irregular(spreading=8.0)}, "'formula': the waves differ in heading by up to"),
        ({"drift": synthetic(), "sea": irregular(components=2001)}, "the sea has 2001 waves, at most 2000"),
        ({"drift": "newman", "db": database(mean_drift=None)}, "'columns': it has no mean drift"),
        ({"froude_krylov": False, "db": database(froude_krylov=None)}, "which part of the excitation is Froude-Krylov"),
        (
            {"slow_position": True, "db": database(headings=np.zeros(1), **{
                key: getattr(database(), key)[:, 36:37] for key in ("excitation", "froude_krylov", "mean_drift")})},
            "a wave at 1 deg relative to the body needs headings spread evenly",
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_done(changes, message):
    values = {"db": database(), "sea": irregular()} | changes
    with pytest.raises(ModelError, match=message):
        WaveLoads(values.pop("db"), values.pop("sea"), **values)


# --- statistics -------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_variance_of_the_slow_force(record):
    """Every 2 s: the highest differences, folded back, stay above the band. The average over 100 seeds has a standard
    error of 1.2 to 1.4 %, over 200 of 0.9 %. tests/validation/compare_qtf.py does the same with a published QTF."""
    low, high, top, dt = 0.02, 0.3, 2.4, 2.0
    exact = slow_variance(SPECTRUM, lambda w: formula(w[:, None], w), low, high, top, 0.01)
    total, force = np.zeros(6), None
    for seed in range(200):
        sea = irregular(seed)
        force = force or PairSum(synthetic(step=0.025), sea, 0.0)  # the seed changes nothing but the phases
        total += band_variance(series(force, sea, dt * np.arange(1800)), dt, low, high)
    for d, name in ((0, "surge"), (2, "heave"), (4, "pitch")):
        ratio = total[d] / 200.0 / exact[d]
        record(ROW, f"variance of {name} over 0.02..0.3 rad/s, mean of 200 one-hour seeds, over 8 int int S S |T|^2",
               ratio, (0.98, 1.02))  # fmt: skip
