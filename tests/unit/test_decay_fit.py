"""The decay fit against oscillators whose period and damping are known."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from floatsim.errors import CaseError
from floatsim.study.decay import extrema, fit_decay


def linear(zeta, period, duration, dt, offset=0.0, amplitude=1.0):
    """x'' + 2 zeta w x' + w^2 x = 0 from rest at `amplitude`: closed form, damped period `period`."""
    wd = 2.0 * np.pi / period
    w = wd / math.sqrt(1.0 - zeta**2)
    t = np.arange(0.0, duration, dt)
    x = np.exp(-zeta * w * t) * (np.cos(wd * t) + zeta * w / wd * np.sin(wd * t))
    return t, offset + amplitude * x


def quadratic(zeta, b, w, amplitude, duration, dt):
    """x'' + 2 zeta w x' + b |x'| x' + w^2 x = 0 from rest, integrated to 1e-11."""
    t = np.arange(0.0, duration, dt)
    result = solve_ivp(
        lambda _, y: (y[1], -2.0 * zeta * w * y[1] - b * abs(y[1]) * y[1] - w * w * y[0]),
        (0.0, t[-1]), (amplitude, 0.0), "DOP853", t, rtol=1e-11, atol=1e-13,
    )  # fmt: skip
    return t, result.y[0]


@pytest.mark.parametrize("amplitude", [5.0, -5.0])
def test_linear_damping_is_exact(amplitude):
    t, x = linear(zeta=0.05, period=20.0, duration=170.0, dt=0.1, offset=3.0, amplitude=amplitude)
    fit = fit_decay(t, x, equilibrium=3.0)
    # parabola through samples 0.1 s apart: error of the extremum about (w dt)^4/128
    assert fit.period == pytest.approx(20.0, rel=1e-4)
    assert fit.periods == pytest.approx(20.0, rel=2e-3)
    assert fit.damping_ratio == pytest.approx(0.05, rel=1e-3)
    assert abs(fit.quadratic_damping) < 1e-4
    decrement = math.pi * 0.05 / math.sqrt(1.0 - 0.05**2)
    assert fit.value == pytest.approx(amplitude * (-np.exp(-decrement)) ** np.arange(len(fit.value)), rel=1e-4)
    assert fit.time[:4] == pytest.approx([0.0, 10.0, 20.0, 30.0], abs=0.002)


def test_quadratic_damping():
    b = 0.03
    t, x = quadratic(zeta=0.0, b=b, w=0.3, amplitude=5.0, duration=8 * 2 * np.pi / 0.3, dt=0.1)
    fit = fit_decay(t, x, 0.0)
    assert fit.quadratic_damping == pytest.approx(b, rel=0.03)
    assert abs(fit.damping_ratio) < 0.002
    assert fit.period == pytest.approx(2 * np.pi / 0.3, rel=2e-3)


def test_strong_quadratic_damping_within_what_is_stated():
    t, x = quadratic(zeta=0.0, b=0.08, w=0.3, amplitude=5.0, duration=8 * 2 * np.pi / 0.3, dt=0.1)
    fit = fit_decay(t, x, 0.0)
    assert 0.3 < fit.decrement[0] < 0.6
    assert fit.quadratic_damping == pytest.approx(0.08, rel=0.04)
    assert abs(fit.damping_ratio) < 0.0015


def test_linear_and_quadratic_damping_together():
    t, x = quadratic(zeta=0.03, b=0.02, w=0.22, amplitude=3.0, duration=8 * 2 * np.pi / 0.22, dt=0.1)
    fit = fit_decay(t, x, 0.0)
    assert fit.damping_ratio == pytest.approx(0.03, rel=0.03)
    assert fit.quadratic_damping == pytest.approx(0.02, rel=0.03)
    # equivalent linearisation of b |x'| x' over a cycle: 8/(3 pi) b w A, that is zeta_eq = 4 b A/(3 pi)
    assert fit.equivalent_ratio(2.0) == pytest.approx(0.03 + 4 * 0.02 * 2.0 / (3 * np.pi), rel=0.02)
    assert fit.residual < 2e-3
    low, high = fit.amplitudes
    assert 0.0 < low < 1.0 < 2.5 < high < 3.0


def test_error_of_the_equilibrium_does_not_matter_much():
    t, x = linear(zeta=0.04, period=100.0, duration=620.0, dt=0.1, amplitude=20.0)
    fit = fit_decay(t, x, equilibrium=0.2)
    assert fit.damping_ratio == pytest.approx(0.04, rel=1e-3)
    assert fit.period == pytest.approx(100.0, rel=1e-4)


def test_ripple_of_another_mode_makes_no_extrema_of_its_own():
    t, x = linear(zeta=0.05, period=140.0, duration=900.0, dt=0.1, amplitude=20.0)
    fit = fit_decay(t, x + 0.15 * np.sin(2 * np.pi * t / 28.0), 0.0)
    # the slow motion has an extremum every 70 s until it is below 2 % of the first
    assert np.diff(fit.time) == pytest.approx(70.0, abs=8.0)
    assert (fit.value[1:] * fit.value[:-1] < 0.0).all()


def test_record_that_starts_in_the_middle_of_a_swing():
    t, x = linear(zeta=0.02, period=10.0, duration=100.0, dt=0.05)
    late = t >= 1.5
    at, _ = extrema(t[late], x[late], 0.0)
    assert at[:3] == pytest.approx([5.0, 10.0, 15.0], abs=0.01)


def test_three_extrema_give_a_period_and_linear_damping_only():
    t, x = linear(zeta=0.05, period=20.0, duration=27.0, dt=0.1)
    fit = fit_decay(t, x, 0.0)
    assert len(fit.time) == 3 and len(fit.periods) == 1
    assert fit.period == pytest.approx(20.0, rel=1e-4)
    assert fit.quadratic_damping is None
    assert fit.damping_ratio == pytest.approx(0.05, rel=1e-3)


@pytest.mark.parametrize("duration", [4.0, 16.0])
def test_too_short_records_say_what_to_do(duration):
    t, x = linear(zeta=0.05, period=20.0, duration=duration, dt=0.1)
    with pytest.raises(CaseError, match="three: make the duration longer"):
        fit_decay(t, x, 0.0)


@pytest.mark.parametrize(
    ("t", "x"),
    [
        (np.arange(10.0), np.arange(9.0)),
        (np.arange(10.0), np.full(10, np.nan)),
        (np.zeros(10), np.cos(np.arange(10.0))),
        (np.arange(3.0), np.arange(3.0)),
    ],
)
def test_bad_records(t, x):
    with pytest.raises(CaseError, match="decay"):
        fit_decay(t, x, 0.0)


def test_a_flat_record_has_no_extrema():
    with pytest.raises(CaseError, match="0 extrema"):
        fit_decay(np.arange(100.0), np.zeros(100), 0.0)
