"""State-space radiation memory against kernels whose every transform is known in closed form.

K(tau) = c exp(-a tau) (cos b tau - a/b sin b tau) is the derivative of H' = c exp(-a tau) sin(b tau)/b, and
    B + i w (A - A_inf) = c s/((s + a)^2 + b^2),   s = i w,
    H(tau) = c/b int exp(-a t) sin b t dt = c/(b (a^2 + b^2)) (b - exp(-a tau) (a sin b tau + b cos b tau)).
"""

import copy
import pickle
from types import SimpleNamespace

import numpy as np
import pytest
import radiation_reference as smooth
from shipped import HYDRO

import floatsim as fs
from floatsim.errors import ModelError
from floatsim.hydro.database import added_mass_from_damping
from floatsim.hydro.radiation import RadiationHistory, RadiationKernel, entry_scales
from floatsim.hydro.state_space import StateSpace, StateSpaceHistory

TERMS = ((0.35, 0.8, 2.0e6), (0.6, 1.7, 0.7e6))  # a, b, c
MIX, OTHER = smooth.MIX, np.diag([1.0, 0.0, 0.0, 0.0, 20.0, 10.0])


def K(tau, a, b, c):
    return c * np.exp(-a * tau) * (np.cos(b * tau) - a / b * np.sin(b * tau))


def H(tau, a, b, c):
    return c / (b * (a**2 + b**2)) * (b - np.exp(-a * tau) * (a * np.sin(b * tau) + b * np.cos(b * tau)))


def known(omega=None, noise=0.0):
    """Entries of MIX have the first term, those of OTHER the second as well (or alone)."""
    omega = np.arange(1, 61) * 0.06 if omega is None else omega
    s = 1j * omega[:, None, None]
    L = sum(c * s / ((s + a) ** 2 + b**2) * m for (a, b, c), m in zip(TERMS, (MIX, OTHER), strict=True))
    if noise:
        L = L * (1.0 + noise * np.random.default_rng(1).standard_normal(L.shape))
    db = smooth.database(omega)
    db.radiation_damping = L.real
    db.added_mass = L.imag / omega[:, None, None] + smooth.A_INF
    return db


def retardation(tau):
    tau = np.asarray(tau)[:, None, None]
    return K(tau, *TERMS[0]) * MIX + K(tau, *TERMS[1]) * OTHER


@pytest.fixture(scope="module")
def exact():
    return StateSpace.from_database(known(), error=1e-9)


def test_known_exponentials_are_found_with_as_many_states_as_they_have(exact):
    tau = np.linspace(0.0, 40.0, 401)
    assert np.abs(exact.retardation(tau) - retardation(tau)).max() < 1e-7 * np.abs(retardation(tau)).max()
    assert (exact.order == 2 * (MIX != 0.0) + 2 * (OTHER != 0.0)).all()
    assert exact.residual.added_mass.max() < 1e-9 and exact.residual.damping.max() < 1e-9
    # between the database's frequencies and far above them
    w = np.array([0.013, 0.333, 1.77, 9.0, 40.0])
    s = 1j * w[:, None, None]
    L = sum(c * s / ((s + a) ** 2 + b**2) * m for (a, b, c), m in zip(TERMS, (MIX, OTHER), strict=True))
    A, B = exact.added_mass_and_damping(w)
    assert np.abs(B - L.real).max() < 1e-7 * np.abs(L).max()
    assert np.abs(w[:, None, None] * A - L.imag).max() < 1e-7 * np.abs(L).max()


@pytest.mark.parametrize("db", [known(noise=0.05), smooth.database(), fs.HydroDatabase.read(HYDRO)])
def test_poles_are_stable_and_a_steady_drift_makes_no_force(db):
    fit = StateSpace.from_database(db)
    assert fit.poles.real.max() < 0.0 and fit.poles.imag.min() >= 0.0
    K0 = fit.retardation(np.zeros(1))[0]
    for i, j, a, b in fit.entries:
        rho = fit.residues[a:b] / fit.poles[a:b]
        assert abs(rho.real.sum()) < 1e-12 * np.abs(rho).sum()
        assert np.isfinite(K0[i, j])
    history = fit.history()
    history.commit(0.1, np.ones(6))
    start = np.abs(history.prepare(0.1)).max()
    history.commit(2000.0, np.ones(6))
    assert np.abs(history.prepare(2000.0)).max() < 1e-9 * start


def test_the_error_asked_for_is_kept_where_the_order_allows_it():
    db = fs.HydroDatabase.read(HYDRO)
    for error in (0.02, 0.005):
        fit = StateSpace.from_database(db, error)
        # Im G is taken from the database itself, not from what the fit says of itself
        A, B = fit.added_mass_and_damping(db.omega)
        got = (np.abs(A + db.added_mass_inf - db.added_mass) / entry_scales(db)[0]).max(axis=0)
        assert got == pytest.approx(fit.residual.added_mass, rel=1e-9, abs=1e-12)
        assert got.max() < error
        assert (np.abs(B - db.radiation_damping) / entry_scales(db)[1]).max() < error
    # port-starboard symmetry: surge, heave, pitch do not feel sway, roll, yaw
    assert not fit.order[np.ix_([0, 2, 4], [1, 3, 5])].any()
    assert (fit.order == fit.order.T).all()
    tau = np.linspace(0.0, 60.0, 50)
    K = fit.retardation(tau)
    assert (K.transpose(0, 2, 1) == K).all()
    low = StateSpace.from_database(db, 0.005, order=6)
    assert low.order.max() <= 6 and low.residual.damping.max() > 0.005
    assert "state space" in low.summary() and "surge" in low.summary()


def test_an_inconsistent_database_is_seen():
    wrong = known()
    wrong.added_mass_inf = 1.05 * smooth.A_INF
    fit = StateSpace.from_database(wrong)
    assert fit.residual.added_mass.max() > 0.02
    # and does not hide in a pole beyond the data that feeds in energy
    _, B = fit.added_mass_and_damping(np.geomspace(3.6, 100.0, 300))
    assert np.diagonal(B / entry_scales(wrong)[1], axis1=1, axis2=2).min() > -0.06


def force(times, v, t):
    """F(t) of the velocity linear between the knots (times, v (n, 6)), v(times[0]) = 0: a sum of closed forms, as
    int K v = int H' v' and v' is constant between knots."""
    out = np.zeros(6)
    for m, term in zip((MIX, OTHER), TERMS, strict=True):
        rate = np.diff(v, axis=0) / np.diff(times)[:, None]
        weight = H(t - times[:-1], *term) - H(t - times[1:], *term)
        out -= m @ (weight @ rate)
    return out


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_velocity_linear_over_steps_of_any_size_is_integrated_exactly(exact, seed):
    rng = np.random.default_rng(seed)
    times = np.concatenate([[0.0], np.cumsum(10.0 ** rng.uniform(-4.0, 0.7, 150))])
    v = np.concatenate([np.zeros((1, 6)), rng.standard_normal((150, 6))])
    history, got = exact.history(), []
    for t, velocity in zip(times[1:], v[1:], strict=True):
        history.prepare(t)
        got.append(history.force(velocity))
        history.commit(t, velocity)
    want = np.array([force(times[: n + 1], v[: n + 1], times[n]) for n in range(1, 151)])
    assert np.abs(np.array(got) - want).max() < 1e-6 * np.abs(want).max()


def test_second_order_in_the_step_and_the_step_may_change(exact):
    fine = 0.005

    def series(steps):
        history, forces = exact.history(), {}
        t = 0.0
        for h in steps:
            t += h
            v = smooth.velocity(t)
            history.prepare(t)
            forces[round(t, 6)] = history.force(v)
            history.commit(t, v)
        return forces
    reference = series([fine] * 8000)
    errors = []
    for h in (0.4, 0.2, 0.1):
        got = series([h] * round(40.0 / h))
        errors.append(max(np.abs(got[t] - reference[t]).max() for t in got))
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.1)
    mixed = series([0.1, 0.2, 0.05, 0.05] * 100)
    size = np.abs(list(reference.values())).max()
    assert max(np.abs(mixed[t] - reference[t]).max() for t in mixed) < 2e-3 * size


def test_it_agrees_with_the_convolution():
    db = fs.HydroDatabase.read(HYDRO)
    fit, kernel = StateSpace.from_database(db), RadiationKernel.from_database(db)
    one, other = StateSpaceHistory(fit), RadiationHistory(kernel)
    forces = []
    for n in range(1, 2001):
        t, v = 0.1 * n, smooth.velocity(0.1 * n)
        pair = []
        for history in (one, other):
            history.prepare(t)
            pair.append(history.force(v))
            history.commit(t, v)
        forces.append(pair)
    forces = np.array(forces)
    apart = np.abs(forces[:, 0] - forces[:, 1]).max(axis=0) / np.abs(forces[:, 1]).max(axis=0)
    assert apart.max() < 0.01


def started(kernel, until=7.0, step=0.1):
    history = kernel.history()
    for i in range(1, round(until / step) + 1):
        history.commit(i * step, smooth.velocity(i * step))
    return history


@pytest.mark.parametrize("step", [1e-5, 0.02, 0.1, 0.37, 30.0])
def test_tangent_is_the_difference_of_two_committed_velocities(exact, step):
    history = started(exact)
    t = history.time + step
    v = smooth.velocity(t)
    history.prepare(t)
    force, tangent = history.force(v), history.tangent.copy()
    want = sum(H(step, *term) / step * m for term, m in zip(TERMS, (MIX, OTHER), strict=True))
    assert tangent == pytest.approx(want, abs=1e-6 * np.abs(want).max())
    for j in range(6):
        ends = []
        for sign in (1.0, -1.0):
            other = history.copy()
            other.commit(t, v + sign * np.eye(6)[j])
            ends.append(other.prepare(t).copy())
            assert not other.tangent.any()
        assert (ends[1] - ends[0]) / 2.0 == pytest.approx(tangent[:, j], abs=1e-8 * np.abs(force).max())
        assert (ends[1] + ends[0]) / 2.0 == pytest.approx(force, rel=1e-9, abs=1e-9 * np.abs(force).max())


def test_a_rejected_step_leaves_the_history_bit_identical(exact):
    history = started(exact)
    before = (history.states.tobytes(), history.last.tobytes())
    for step in (0.1, 0.03, 0.5, 100.0, 0.0):
        history.prepare(history.time + step)
        history.force(np.ones(6))
    assert (history.states.tobytes(), history.last.tobytes()) == before
    first = history.prepare(history.time + 0.1).copy()
    assert (first == started(exact).prepare(history.time + 0.1)).all()


@pytest.mark.parametrize("again", [copy.deepcopy, lambda h: pickle.loads(pickle.dumps(h)), StateSpaceHistory.copy])
def test_copies_go_on_where_it_was(exact, again):
    history = started(exact)
    twin = again(history)
    saved = history.arrays()
    for n in range(1, 30):
        for h in (history, twin):
            h.prepare(7.0 + 0.1 * n)
        assert (history.constant == twin.constant).all() and (history.tangent == twin.tangent).all()
        for h in (history, twin):
            h.commit(7.0 + 0.1 * n, smooth.velocity(7.0 + 0.1 * n))
    fresh = StateSpaceHistory(exact, t0=3.0)
    fresh.restore(saved)
    assert fresh.time == pytest.approx(7.0)
    short = StateSpace.from_database(smooth.database(), order=2).history()
    with pytest.raises(ValueError, match="shape"):
        short.restore(saved)


def test_it_refuses_the_past_and_nonsense(exact):
    history = started(exact)
    with pytest.raises(ValueError, match="already ends at"):
        history.prepare(6.9)
    with pytest.raises(ValueError, match="already ends at"):
        history.commit(6.9, np.zeros(6))
    for error, order in ((0.0, 20), (-1.0, 20), (np.nan, 20), (0.01, 0), (0.01, 1), (0.01, 1000)):
        with pytest.raises(ModelError, match="radiation state space of 'smooth'"):
            StateSpace.from_database(known(), error, order)


def test_a_body_that_makes_no_waves_has_no_states():
    db = known()
    db.added_mass, db.radiation_damping = db.added_mass * 0.0 + smooth.A_INF, 0.0 * db.radiation_damping
    fit = StateSpace.from_database(db)
    assert fit.poles.size == 0
    history = fit.history()
    assert not history.prepare(0.1).any() and not history.tangent.any()
    history.commit(0.1, np.ones(6))
    assert not history.prepare(0.1).any()


def test_rotations_that_make_no_waves_are_not_fitted():
    """A sphere about its centre: what its rotations have is rounding, and nothing to be relative to."""
    db = known()
    noise = 1e-7 * np.random.default_rng(2).standard_normal(db.added_mass.shape) * db.radiation_damping.max()
    noise[:, :3, :3] = 0.0
    for name in ("added_mass", "radiation_damping"):
        values = getattr(db, name).copy()
        values[:, 3:] = values[:, :, 3:] = 0.0
        setattr(db, name, values + noise)
    db.added_mass_inf = db.added_mass_inf.copy()
    db.added_mass_inf[3:] = db.added_mass_inf[:, 3:] = 0.0
    db.volume = np.array([500.0])
    fit = StateSpace.from_database(db)
    assert not fit.order[3:].any() and not fit.order[:, 3:].any() and fit.order[:3, :3].any()
    for residual in (fit.residual, RadiationKernel.from_database(db).residual):
        assert residual.damping[3:].max() < 1e-3 and residual.added_mass[3:].max() < 1e-3


def test_water_that_rings_between_bodies_is_refused() -> None:
    """Three bodies whose every entry has a dozen sharp peaks cannot be fitted with a few states."""
    omega = np.linspace(0.05, 4.0, 160)
    peaks = np.linspace(0.6, 3.4, 24)
    B = 1e5 * np.sum(np.exp(-(((omega[:, None] - peaks) / 0.03) ** 2)), axis=1)
    A = 1e6 + added_mass_from_damping(omega, B[:, None, None])[:, 0, 0]
    full = np.ones((18, 18))
    db = SimpleNamespace(name="moonpools", omega=omega, added_mass=A[:, None, None] * full,
                         radiation_damping=B[:, None, None] * full, added_mass_inf=1e6 * full,
                         volume=np.full(3, 1e3), bodies=("a", "b", "c"))  # fmt: skip
    with pytest.raises(ModelError, match="'moonpools': with 8 states more than 24 entries miss.*convolution"):
        StateSpace.from_database(db, order=8)
