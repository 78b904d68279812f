"""The low-pass filter of the slow position against closed forms."""

import copy
import pickle

import numpy as np
import pytest

from floatsim.hydro.slow_position import CORNER, SlowPosition, peak_frequency
from floatsim.sea.spectra import Jonswap, PiersonMoskowitz
from floatsim.sea.waves import IrregularWaves, RegularWave, WaveComponents

C = 0.13


def follow(motion, steps, corner=C):
    f = SlowPosition.at_rest(corner, 0.0, motion(0.0))
    t, out = 0.0, []
    for h in steps:
        t += h
        ahead = f.prepare(t, motion(t))
        f.commit(t, motion(t))
        assert np.array_equal(ahead, f.y)
        out.append(f.y.copy())
    return np.array(out), f


def test_a_step_away_from_rest():
    """y = 1 - exp(-c t/sqrt2) (cos + sin)(c t/sqrt2) after a jump, which a very short first step makes."""
    f = SlowPosition.at_rest(C, 0.0, np.zeros(3))
    f.commit(1e-6, np.array([2.0, -1.0, 0.3]))
    for h in (0.1, 3.0, 0.7, 40.0):
        t = f.t + h
        f.commit(t, np.array([2.0, -1.0, 0.3]))
        x = C * t / np.sqrt(2.0)
        share = 1.0 - np.exp(-x) * (np.cos(x) + np.sin(x))
        assert f.y == pytest.approx(share * np.array([2.0, -1.0, 0.3]), abs=1e-6)


def test_a_drift_at_constant_speed_is_followed_late():
    y, f = follow(lambda t: np.array([0.5 * t, -0.2 * t, 0.01 * t]), [7.0] * 100)
    assert y[-1] == pytest.approx(np.array([0.5, -0.2, 0.01]) * (700.0 - np.sqrt(2.0) / C), rel=1e-6)
    assert f.dy == pytest.approx([0.5, -0.2, 0.01], rel=1e-6)


def test_steps_of_any_length_are_exact_for_motions_linear_in_between():
    corners = np.array([0.0, 10.0, 25.0, 60.0])
    way = np.array([[0.0, 0.0, 0.0], [3.0, -1.0, 0.1], [1.0, 4.0, -0.2], [2.0, 2.0, 0.0]])

    def motion(t):
        return np.array([np.interp(t, corners, way[:, k]) for k in range(3)])

    coarse, _ = follow(motion, [10.0, 15.0, 35.0])
    fine, _ = follow(motion, [0.1] * 600)
    assert coarse[-1] == pytest.approx(fine[-1], rel=1e-10)


@pytest.mark.parametrize("ratio", [0.2, 1.0, 5.0])
def test_response_to_a_harmonic_motion(ratio):
    """|H|^2 = 1/(1 + (w/c)^4) of a second-order Butterworth filter; 0.04 at five times the corner."""
    w, h = ratio * C, 0.02 / (ratio * C)
    n = round((60.0 / C + 4.0 * np.pi / w) / h)
    y, _ = follow(lambda t: np.array([np.cos(w * t), 0.0, 0.0]), [h] * n)
    t = h * np.arange(1, n + 1)
    last = t > t[-1] - 4.0 * np.pi / w
    fit, *_ = np.linalg.lstsq(np.stack([np.cos(w * t), np.sin(w * t)], axis=1)[last], y[last, 0], rcond=None)
    H = 1.0 / (1.0 + np.sqrt(2.0) * 1j * ratio - ratio**2)
    assert fit[0] - 1j * fit[1] == pytest.approx(H, abs=2e-4)
    assert abs(H) == pytest.approx(1.0 / np.sqrt(1.0 + ratio**4))


def test_turning_round_and_round():
    """The yaw comes as an angle between -pi and pi; the slow heading goes on."""

    def motion(t):
        return np.array([0.0, 0.0, (0.1 * t + np.pi) % (2.0 * np.pi) - np.pi])

    y, _ = follow(motion, [0.5] * 400)
    assert y[-1, 2] == pytest.approx(0.1 * (200.0 - np.sqrt(2.0) / C), rel=1e-6)


def test_prepare_changes_nothing_and_a_copy_goes_its_own_way():
    f = SlowPosition.at_rest(C, 5.0, np.array([1.0, 2.0, 0.0]))
    f.commit(6.0, np.array([3.0, 2.0, 0.1]))
    twin, stored = copy.deepcopy(f), pickle.loads(pickle.dumps(f))
    before = f.y.copy()
    f.prepare(7.0, np.array([9.0, 9.0, 1.0]))
    assert np.array_equal(f.y, before)
    for other in (f, twin, stored):
        other.commit(7.0, np.array([4.0, 2.0, 0.1]))
    assert np.array_equal(f.y, twin.y) and np.array_equal(f.y, stored.y) and np.array_equal(f.dy, stored.dy)
    twin.commit(8.0, np.array([40.0, 2.0, 0.1]))
    assert f.y[0] < 5.0


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("spectrum", [Jonswap(hs=4.0, tp=9.0), PiersonMoskowitz(hs=2.0, tp=14.0)])
def test_peak_of_a_realisation(spectrum, seed):
    sea = IrregularWaves(spectrum=spectrum, seed=seed).realise(200.0, 9.81)
    assert peak_frequency(sea) == pytest.approx(2.0 * np.pi / spectrum.tp, rel=0.03)


def test_peak_of_few_waves():
    assert peak_frequency(RegularWave(height=2.0, period=8.0).realise(100.0, 9.81)) == pytest.approx(np.pi / 4.0)
    two = WaveComponents(amplitude=(1.0, 2.0), omega=(0.9, 0.5)).realise(100.0, 9.81)
    assert peak_frequency(two) == pytest.approx(0.5, rel=1e-2)
    flat = WaveComponents(amplitude=(0.0,), omega=(0.9,)).realise(100.0, 9.81)
    assert peak_frequency(flat) > 0.0
    assert CORNER == 0.2
