"""Radiation memory against kernels whose every transform is known in closed form.

The smooth one is that of tests/radiation_reference.py. The one with an ordinary differential equation:
K(tau) = c exp(-a tau) (cos b tau - a/b sin b tau), so
    F = -c z',   z'' + 2 a z' + (a^2 + b^2) z = v,   B(w) = 2 a c w^2 / ((a^2 + b^2 - w^2)^2 + 4 a^2 w^2).
"""

import numpy as np
import pytest
from radiation_reference import A_INF, MIX, C, H, K, database, error, run, velocity
from scipy.integrate import solve_ivp

from floatsim.errors import ModelError
from floatsim.hydro.radiation import RadiationHistory, RadiationKernel


@pytest.fixture(scope="module")
def smooth():
    return RadiationKernel.from_database(database(), memory=30.0, grid=0.1)


def test_tables_are_the_closed_forms(smooth):
    lag = smooth.grid * np.arange(smooth.K.shape[0])
    before_fade = lag < 25.0
    # what is left is the cubic spline of B over the database's spacing of 0.06 rad per s
    assert np.abs(smooth.K - K(lag)[:, None, None] * MIX).max() < 1e-5 * K(0.0) * 30.0
    assert np.abs(smooth.H - H(lag)[:, None, None] * MIX)[before_fade].max() < 1e-4 * H(30.0) * 30.0
    assert smooth.memory == pytest.approx(30.0)
    assert not smooth.K.flags.writeable and not smooth.weights.flags.writeable


def test_residual_is_small_for_a_consistent_database_and_sees_an_inconsistent_one(smooth):
    assert smooth.residual.damping.max() < 1e-4
    assert smooth.residual.added_mass.max() < 1e-4
    assert np.abs(smooth.residual.added_mass_inf).max() < 1e-3
    wrong = database()
    wrong.added_mass_inf = 1.05 * A_INF
    residual = RadiationKernel.from_database(wrong, memory=30.0).residual
    # A(w) is at most 1.107 A_inf here (its value at w = 0 is A_inf + G/S), so 5 % of A_inf is at least 4.5 % of it
    assert 0.045 < residual.added_mass.max() < 0.055
    assert residual.added_mass_inf.min() == pytest.approx(-0.05, abs=0.005)
    assert "A_inf" in residual.summary()


def test_velocity_linear_between_knots_is_integrated_exactly(smooth):
    """Random velocities on the grid; the reference is the weight formula with the closed-form H."""
    rng = np.random.Generator(np.random.PCG64(5))
    knots = rng.standard_normal((121, 6))
    knots[0] = 0.0
    times = 0.1 * np.arange(121)
    lag = 0.1 * np.arange(122)
    table = H(lag)
    weights = np.concatenate([[table[1] / 0.1], (table[2:] - 2.0 * table[1:-1] + table[:-2]) / 0.1])
    forces = run(smooth, times, motion=lambda t: knots[round(t / 0.1)])
    for n in (1, 2, 60, 120):
        exact = -MIX @ (knots[n::-1].T @ weights[: n + 1])
        assert forces[n] == pytest.approx(exact, abs=1e-3 * np.abs(forces).max())


@pytest.mark.parametrize("step", [0.1, 0.05, 0.07, 0.03, 0.15, 0.2])
def test_any_step_gives_the_force(smooth, step):
    assert error(smooth, np.arange(0.0, 70.0, step)) < 2e-3


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_random_steps_give_the_force(smooth, seed):
    rng = np.random.Generator(np.random.PCG64(seed))
    times = np.concatenate([[0.0], np.cumsum(rng.uniform(0.01, 0.2, 600))])
    assert error(smooth, times) < 2e-3


def test_second_order_in_the_step():
    """Steps larger than the kernel's interval, so that the step makes the error, and then both together."""
    kernel = RadiationKernel.from_database(database(), memory=30.0, grid=0.025)
    errors = [error(kernel, np.arange(0.0, 40.0, step)) for step in (0.8, 0.4, 0.2)]
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.1)
    errors = [
        error(RadiationKernel.from_database(database(), memory=30.0, grid=grid), np.arange(0.0, 40.0, 0.7 * grid))
        for grid in (0.4, 0.2, 0.1)
    ]
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.15)


def test_against_the_differential_equation():
    """A kernel with a kink at zero lag: B falls off with 1/w^2 only, so the range must be wide."""
    a, b = 0.35, 0.8
    omega = np.arange(1, 801) * 0.05
    s = 1j * omega
    transfer = C * s / ((s + a) ** 2 + b**2)  # B + i w (A - A_inf)
    kernel = RadiationKernel.from_database(database(omega, transfer.real, transfer.imag / omega), memory=30.0)
    times = np.arange(0.0, 50.0, 0.1)
    answer = solve_ivp(
        lambda t, y: np.concatenate([y[6:], velocity(t) - 2.0 * a * y[6:] - (a**2 + b**2) * y[:6]]),
        (0.0, times[-1]),
        np.zeros(12),
        t_eval=times,
        rtol=1e-9,
        atol=1e-12,
    )
    exact = -C * (MIX @ answer.y[6:]).T
    difference = np.abs(run(kernel, times) - exact)[:, :5]
    assert (difference / np.abs(exact[:, :5]).max(axis=0)).max() < 2e-3
    assert kernel.residual.added_mass.max() < 5e-3


@pytest.mark.parametrize("memory", [3.0, 8.0, 30.0])
@pytest.mark.parametrize("step", [0.1, 0.06])
def test_a_steady_drift_makes_no_force_however_short_the_memory(memory, step):
    kernel = RadiationKernel.from_database(database(), memory=memory)
    times = np.arange(0.0, memory + 2.0, step)
    forces = run(kernel, times, motion=lambda t: np.ones(6))
    # the first force is that of the sudden start; 1e-5 of it is the interpolation between lags
    assert np.abs(forces[-1]).max() < 1e-5 * np.abs(forces).max()


def started(kernel, until=7.0, step=0.1):
    history = RadiationHistory(kernel)
    for i in range(1, round(until / step) + 1):
        history.commit(i * step, velocity(i * step))
    return history


@pytest.mark.parametrize("step", [0.02, 0.1, 0.13, 0.37])
def test_tangent_is_the_difference_of_two_committed_velocities(smooth, step):
    """After committing, `prepare` at the same time gives the force without a trial: another route to the number."""
    history = started(smooth)
    t = history.time + step
    v = velocity(t)
    history.prepare(t)
    force, tangent = history.force(v), history.tangent.copy()
    assert tangent == pytest.approx(H(step) / step * MIX, abs=2e-3 * H(step) / step * 30.0)
    for j in range(6):
        ends = []
        for sign in (1.0, -1.0):
            other = history.copy()
            other.commit(t, v + sign * np.eye(6)[j])
            ends.append(other.prepare(t).copy())
            assert not other.tangent.any()
        assert (ends[1] - ends[0]) / 2.0 == pytest.approx(tangent[:, j], abs=2e-4 * np.abs(tangent).max())
        assert (ends[1] + ends[0]) / 2.0 == pytest.approx(force, abs=2e-4 * np.abs(force).max())


def test_a_rejected_step_leaves_the_history_bit_identical(smooth):
    history = started(smooth)
    before = (history.ring.tobytes(), history.last.tobytes())
    for step in (0.1, 0.03, 0.5, 100.0, 0.0):
        history.prepare(history.time + step)
        history.force(np.ones(6))
    assert (history.ring.tobytes(), history.last.tobytes()) == before
    first = history.prepare(history.time + 0.1).copy()
    assert (first == started(smooth).prepare(history.time + 0.1)).all()


def test_saved_arrays_go_on_where_they_were(smooth):
    history = started(smooth)
    saved = history.arrays()
    twin = history.copy()
    history.commit(history.time + 0.1, np.ones(6))
    assert (twin.ring == saved["ring"]).all() and (twin.last == saved["last"]).all()
    fresh = RadiationHistory(smooth, t0=3.0)
    fresh.restore(saved)
    t = twin.time + 0.17
    assert (fresh.prepare(t) == twin.prepare(t)).all()
    short = RadiationHistory(RadiationKernel.from_database(database(), memory=10.0))
    with pytest.raises(ValueError, match="shape"):
        short.restore(saved)


def test_sums_of_steps_stay_on_the_grid(smooth):
    """t += 0.1 is not a multiple of 0.1 after a while; the force must not notice."""
    history, t = RadiationHistory(smooth), 0.0
    exact = RadiationHistory(smooth)
    for i in range(1, 3000):
        t += 0.1
        a, b = history.prepare(t).copy(), exact.prepare(i * 0.1).copy()
        assert a == pytest.approx(b, rel=1e-9, abs=1e-3)
        history.commit(t, velocity(t))
        exact.commit(i * 0.1, velocity(i * 0.1))


def test_a_step_longer_than_the_memory_and_long_ones_after_it(smooth):
    history = started(smooth)
    v = np.ones(6)
    history.prepare(1000.0)
    assert np.isfinite(history.force(v)).all()
    # a ramp over so long a time is a constant acceleration as the memory sees it: F = -H(inf) dv/dt
    acceleration = (v - velocity(7.0)) / 993.0
    # (the start of the ramp is beyond the memory)
    assert history.force(v) == pytest.approx(-H(30.0) * MIX @ acceleration, abs=1e-3 * H(30.0) * 30 / 993.0)
    history.commit(1000.0, v)
    assert history.prepare(1000.0) == pytest.approx(-H(30.0) * MIX @ acceleration, abs=1e-3 * H(30.0) * 30 / 993.0)


def test_it_refuses_the_past_and_nonsense(smooth):
    history = started(smooth)
    with pytest.raises(ValueError, match="already ends at"):
        history.prepare(6.9)
    with pytest.raises(ValueError, match="already ends at"):
        history.commit(6.9, np.zeros(6))
    for memory, grid in ((60.0, 0.0), (-1.0, 0.1), (1.0, 0.1), (np.nan, 0.1), (np.inf, 0.1)):
        with pytest.raises(ModelError, match="radiation memory of 'smooth'"):
            RadiationKernel.from_database(database(), memory=memory, grid=grid)
