"""Bodies that interact through the water: against single bodies, closed forms in the frequency domain, invariances.

The made-up pair of floaters has a radiation memory of which everything is known,
    K(tau) = sum over two terms of M_q c exp(-a tau) (cos b tau - a/b sin b tau),
    B + i w (A - A_inf) = sum M_q c s/((s + a)^2 + b^2),   s = i w,
with full positive semi-definite matrices M_q (12, 12), so that no two of its 144 entries are alike by chance.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from mechanics import displace, free_unknowns, matrix, residual, run
from shipped import HYDRO

import floatsim as fs
from floatsim.errors import ModelError
from floatsim.frames import turn_quaternion
from floatsim.hydro.floater import FloaterBatch
from floatsim.hydro.radiation import entry_scales
from floatsim.parts.part import Part

RHO, GRAVITY, DEPTH = 1025.0, 9.81, 200.0
SEA = fs.Sea(depth=DEPTH, density=RHO)
ROW = "two bodies interacting through the water"
ROW_STATE = "state-space radiation"

TERMS = ((0.35, 0.8, 1.0), (0.6, 1.4, 0.5))
APART = np.array([40.0, 15.0, 0.0])
SIZE = np.array([1.0, 1.0, 1.0, 8.0, 8.0, 8.0] * 2)  # m: lever of rotations
OMEGA = np.arange(1, 401) * 0.05


def definite(seed: int) -> np.ndarray:
    """Positive semi-definite (12, 12), diagonal 1, scaled."""
    Q = np.random.default_rng(seed).standard_normal((12, 12)) + 2.0 * np.eye(12)
    M = Q @ Q.T
    d = np.sqrt(np.diag(M))
    return M / np.outer(d, d) * np.outer(SIZE, SIZE)


MIXES = (definite(1), definite(2))
VOLUME = 1000.0


def transfer(omega: np.ndarray) -> np.ndarray:
    s = 1j * np.asarray(omega)[:, None, None]
    return 3e5 * sum(c * s / ((s + a) ** 2 + b**2) * M for (a, b, c), M in zip(TERMS, MIXES, strict=True))


def wave_number(omega: float) -> float:
    k = omega**2 / GRAVITY
    for _ in range(200):
        k = omega**2 / GRAVITY / np.tanh(k * DEPTH)
    return k


def pair(**changes: Any) -> fs.HydroDatabase:
    """The made-up database: bodies 'float' and 'spar', the second one APART from the first."""
    L = transfer(OMEGA)
    A_inf = 4e5 * definite(3)
    headings = np.radians(np.arange(-180.0, 180.0, 30.0))
    rng = np.random.default_rng(4)
    amplitude = 2e5 * SIZE * (rng.standard_normal((headings.size, 12)) + 1j * rng.standard_normal((headings.size, 12)))
    C = np.diag([0.0, 0.0, 1.2e6, 6e7, 7e7, 0.0, 0.0, 0.0, 0.8e6, 5e7, 6e7, 0.0])
    k = np.array([wave_number(w) for w in OMEGA])
    along = np.cos(headings) * APART[0] + np.sin(headings) * APART[1]
    X = amplitude * np.exp(-OMEGA / 2.0)[:, None, None]
    X[..., 6:] *= np.exp(-1j * k[:, None] * along)[..., None]
    values = dict(
        name="pair", bodies=("float", "spar"), omega=OMEGA, added_mass=A_inf + L.imag / OMEGA[:, None, None],
        radiation_damping=L.real, added_mass_inf=A_inf, headings=headings, excitation=X, hydrostatic_stiffness=C,
        volume=[VOLUME, VOLUME], centre_of_buoyancy=[[0.0, 0.0, -3.0], APART + [0.0, 0.0, -3.0]],
        reference_point=[np.zeros(3), APART], depth=DEPTH, density=RHO, gravity=GRAVITY,
    )  # fmt: skip
    return fs.HydroDatabase(**{**values, **changes})


STIFF = np.diag([3e5, 3e5, 0.0, 0.0, 0.0, 3e7])
DAMP = np.diag([4e5, 4e5, 4e5, 2e7, 2e7, 2e7])
INERTIA = (3e7, 3.5e7, 4e7)


def two(db: Any, psi: float = 0.0, shift: Any = (0.0, 0.0, 0.0), names: Any = ("float", "spar"), apart: Any = APART,
        **flow: Any) -> list[fs.Body]:  # fmt: skip
    """The two bodies, drawn at `shift` and turned by psi deg."""
    c, s = np.cos(np.radians(psi)), np.sin(np.radians(psi))
    T = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    flow = {"linear_stiffness": STIFF, "linear_damping": DAMP, **flow}
    return [
        fs.Body(name=f"body_{k}", mass=RHO * VOLUME, inertia=INERTIA, position=T @ (k * np.asarray(apart)) + shift,
                attitude_deg=(0.0, 0.0, psi), hydro=fs.PotentialFlow(database=db, body=name, **flow))
        for k, name in enumerate(names)
    ]  # fmt: skip


@pytest.fixture(scope="module")
def db() -> fs.HydroDatabase:
    return pair()


def poses(state: fs.State) -> np.ndarray:
    """Positions and rotation vectors (n, 6) of all bodies; small angles."""
    sign = np.sign(state.q[:-1, :1])
    return np.concatenate([state.x[:-1], 2.0 * state.q[:-1, 1:] * sign], axis=1)


# --- two that do not feel each other ------------------------------------------------------------------


@pytest.mark.parametrize("radiation", ["convolution", "state_space"])
def test_a_pair_without_interaction_is_two_single_bodies(record, radiation):
    """VolturnUS-S twice, 500 m apart, coupling blocks zero; regular wave at a frequency and heading of the database,
    so that interpolation of the second one's phases plays no part."""
    one = fs.HydroDatabase.read(HYDRO)
    away = np.array([500.0, 120.0, 0.0])
    k = np.array([wave_number(w) for w in one.omega])
    phase = np.exp(-1j * k[:, None] * (np.cos(one.headings) * away[0] + np.sin(one.headings) * away[1]))

    def twice(M: np.ndarray) -> np.ndarray:
        out = np.zeros(M.shape[:-2] + (12, 12))
        out[..., :6, :6] = out[..., 6:, 6:] = M
        return out

    both = replace(
        one, name="both", bodies=("one", "other"), added_mass=twice(one.added_mass), added_mass_zero=None,
        radiation_damping=twice(one.radiation_damping), added_mass_inf=twice(one.added_mass_inf),
        excitation=np.concatenate([one.excitation, one.excitation * phase[..., None]], axis=-1),
        froude_krylov=None, mean_drift=None, hydrostatic_stiffness=twice(one.hydrostatic_stiffness),
        volume=np.tile(one.volume, 2),
        centre_of_buoyancy=one.centre_of_buoyancy + [np.zeros(3), away],
        reference_point=one.reference_point + [np.zeros(3), away], hull_vertices=None, hull_faces=None, hull_body=None,
    )  # fmt: skip
    at = int(np.argmin(np.abs(one.omega - 0.6)))
    heading = float(np.degrees(one.headings[one.headings.size // 3]))
    wave = fs.RegularWave(height=2.0, period=2.0 * np.pi / one.omega[at], heading_deg=heading)
    sea = fs.Sea(depth=DEPTH, density=RHO, waves=wave, wave_ramp=10.0)
    stiffness = np.diag([7e4, 7e4, 0.0, 3e9, 3e9, 2.5e8])

    def motion(flows: list[fs.PotentialFlow]) -> np.ndarray:
        bodies = [fs.Body(name=f"b{n}", mass=RHO * one.volume[0], inertia=(4.4e10, 4.4e10, 2.4e10),
                          center_of_mass=(0.0, 0.0, -1.5), position=n * away, hydro=flow)
                  for n, flow in enumerate(flows)]  # fmt: skip
        system = fs.assemble(fs.Model(parts=bodies, sea=sea))
        state = system.initial_state()
        state.x[0, 2] += 1.0
        state.x[1, 0] += 2.0
        return np.array(run(system, state, fs.generalised_alpha(), 0.1, 400, poses, tolerance=1e-11))

    more = {"linear_stiffness": stiffness, "radiation": radiation}
    single = motion([fs.PotentialFlow(database=one, **more) for _ in range(2)])
    group = motion([fs.PotentialFlow(database=both, body=name, **more) for name in both.bodies])
    scale = np.abs(single - single[0]).max(axis=0)
    scale = np.maximum(scale, 1e-3 * scale.max())
    apart = np.abs(group - single).max(axis=0) / scale
    record(ROW, f"coupling blocks zero, {radiation}: apart from two single bodies", apart.max(), 1e-8)


# --- the pair that does ------------------------------------------------------------------------------


def impedance(db: fs.HydroDatabase, omega: float) -> np.ndarray:
    """-w^2 (M + A) + i w (B + B_add) + C + K, (12, 12), from the closed forms."""
    L = transfer(np.array([omega]))[0]
    M = np.diag([RHO * VOLUME] * 3 + list(INERTIA) + [RHO * VOLUME] * 3 + list(INERTIA)) + db.added_mass_inf
    stiffness = db.hydrostatic_stiffness + np.kron(np.eye(2), STIFF)
    return -(omega**2) * M + 1j * omega * (L + np.kron(np.eye(2), DAMP)) + stiffness


@pytest.mark.parametrize("radiation", ["convolution", "state_space"])
def test_regular_waves_against_the_frequency_domain(db, record, radiation):
    omega, heading, a, h = 0.9, 7, 0.01, 0.05
    toward = float(np.degrees(db.headings[heading]))
    wave = fs.RegularWave(height=2.0 * a, period=2.0 * np.pi / omega, heading_deg=toward)
    sea = fs.Sea(depth=DEPTH, density=RHO, waves=wave, wave_ramp=20.0)
    system = fs.assemble(fs.Model(parts=two(db, radiation=radiation), sea=sea))
    state = system.initial_state()
    drawn = poses(state)
    y = np.array(run(system, state, fs.generalised_alpha(), h, 4000, lambda s: (poses(s) - drawn).ravel(),
                     tolerance=1e-9))  # fmt: skip
    t = h * np.arange(len(y))
    last = t > 120.0
    basis = np.stack([np.cos(omega * t), -np.sin(omega * t), np.ones_like(t)], axis=1)[last]
    fit = np.linalg.lstsq(basis, y[last], rcond=None)[0]
    got = (fit[0] + 1j * fit[1]) / a
    want = np.linalg.solve(impedance(db, omega), db.excitation[np.argmin(np.abs(db.omega - omega)), heading])
    size = np.abs(want * SIZE).max() / SIZE
    error = 100.0 * np.abs((got - want) / size).max()
    what = "regular wave 0.9 rad/s, dt 0.05 s: 12 motions against the frequency domain"
    record(ROW, f"{radiation}: {what}", error, 0.5, "%")
    # they do interact: without the coupling blocks the answer is another
    Z = impedance(db, omega)
    Z[:6, 6:] = Z[6:, :6] = 0.0
    alone = np.linalg.solve(Z, db.excitation[np.argmin(np.abs(db.omega - omega)), heading])
    assert np.abs((alone - want) / size).max() > 0.1


def test_second_order_in_the_step(db, record):
    """Free decay with state space, differences of successive halvings."""
    ends = []
    for h in (0.4, 0.2, 0.1):
        system = fs.assemble(fs.Model(parts=two(db, radiation="state_space"), sea=SEA))
        state = system.initial_state()
        state.x[0, 2] += 0.5
        state.x[1, 0] += 0.3
        seen = run(system, state, fs.generalised_alpha(), h, round(16.0 / h), poses, tolerance=1e-10)
        ends.append(np.array(seen)[:: round(0.4 / h)])
    order = np.log2(np.abs(ends[0] - ends[1]).max() / np.abs(ends[1] - ends[2]).max())
    record(ROW_STATE, "decay of two bodies: order in the step", order, (1.8, 2.2))


def forces(system: fs.System, motion: Any, h: float, n: int) -> np.ndarray:
    """Memory force (n, 12) of a prescribed velocity (12,), through the batch's own histories."""
    batch = next(b for b in system.batches if isinstance(b, FloaterBatch))
    (history,) = batch.start(system.initial_state())
    out = []
    for k in range(1, n + 1):
        history.prepare(k * h)
        out.append(history.force(motion(k * h)))
        history.commit(k * h, motion(k * h))
    return np.array(out)


@pytest.mark.parametrize("radiation", ["convolution", "state_space"])
def test_reciprocity_and_energy(db, record, radiation):
    """What one body's motion does to the other, the other's does to the one; and waves take energy away."""
    system = fs.assemble(fs.Model(parts=two(db, radiation=radiation), sea=SEA))
    e = np.eye(12)

    def gust(t: float) -> float:
        return float(np.sin(0.9 * t) * np.exp(-(((t - 12.0) / 6.0) ** 2)))

    F = np.array([forces(system, lambda t, j=j: gust(t) * e[j], 0.1, 400) for j in range(12)])  # moved, time, felt
    scaled = F / np.outer(SIZE, SIZE)[:, None, :]
    uneven = np.abs(scaled - scaled.transpose(2, 1, 0)).max() / np.abs(scaled).max()
    record(ROW, f"{radiation}: force i by motion j against force j by motion i", uneven, 1e-9)
    rng = np.random.default_rng(6)
    least = np.inf
    for _ in range(5):
        phase, size = rng.uniform(0.0, 6.0, 12), rng.standard_normal(12) / SIZE

        def v(t: float, phase: Any = phase, size: Any = size) -> np.ndarray:
            return size * np.sin(np.linspace(0.3, 1.4, 12) * t + phase) * np.exp(-(((t - 15.0) / 6.0) ** 2))

        power = np.sum(forces(system, v, 0.1, 500) * [v(0.1 * k) for k in range(1, 501)], axis=1)
        least = min(least, -power.sum() / np.abs(power).sum())
    record(ROW, f"{radiation}: energy radiated over all work done, least", least, (0.01, 1.0))


@pytest.mark.parametrize("radiation", ["convolution", "state_space"])
def test_memory_force_is_the_closed_form(db, record, radiation):
    """Velocity linear between knots: int K v = int H' v', H = int int K known."""

    def H(tau: np.ndarray) -> np.ndarray:
        parts = [3e5 * c / (b * (a**2 + b**2)) * (b - np.exp(-a * tau) * (a * np.sin(b * tau) + b * np.cos(b * tau)))
                 for a, b, c in TERMS]  # fmt: skip
        return np.tensordot(parts[0], MIXES[0], 0) + np.tensordot(parts[1], MIXES[1], 0)

    system = fs.assemble(fs.Model(parts=two(db, radiation=radiation), sea=SEA))
    t = 0.1 * np.arange(301)
    v = np.sin(np.outer(t, np.linspace(0.3, 1.2, 12))) / SIZE
    got = forces(system, lambda s: v[round(s / 0.1)], 0.1, 300)
    rate = np.diff(v, axis=0) / 0.1
    table = H(0.1 * np.arange(301))
    weight = np.diff(table, axis=0)
    want = np.array([-np.einsum("kij,kj->i", weight[:n][::-1], rate[:n]) for n in range(1, 301)])
    error = 100.0 * (np.abs(got - want).max(axis=0) / np.abs(want).max(axis=0)).max()
    record(ROW, f"{radiation}: memory force against the closed form", error, 0.5, "%")


def test_convolution_against_state_space_over_a_decay(record):
    one = fs.HydroDatabase.read(HYDRO)
    mooring = np.diag([7.192e4, 7.192e4, 6.076e4, 2.587e8, 2.587e8, 2.524e8])
    seen = {}
    for radiation in ("convolution", "state_space"):
        flow = fs.PotentialFlow(database=one, linear_stiffness=mooring, radiation=radiation)
        body = fs.Body(name="hull", mass=RHO * one.volume[0], inertia=(4.4e10, 4.4e10, 2.4e10),
                       center_of_mass=(0.0, 0.0, -1.5), hydro=flow)  # fmt: skip
        system = fs.assemble(fs.Model(parts=[body], sea=SEA))
        for name, dof, size in (("surge", 0, 10.0), ("heave", 2, 3.0), ("pitch", 4, 0.1)):
            state = system.initial_state()
            if dof < 3:
                state.x[0, dof] += size
            else:
                state.q[0] = turn_quaternion((0.0, size, 0.0), tuple(state.q[0]))
            watch = run(system, state, fs.generalised_alpha(), 0.1, 3000, lambda s: poses(s)[0], tolerance=1e-9)
            seen[name, radiation] = np.array(watch)[:, dof] / size
    for name in ("surge", "heave", "pitch"):
        apart = 100.0 * np.abs(seen[name, "convolution"] - seen[name, "state_space"]).max()
        what = f"VolturnUS-S, 300 s of {name} decay: apart from the convolution, of the offset"
        record(ROW_STATE, what, apart, 1.0, "%")


def test_what_the_fit_leaves_of_volturnus(record):
    one = fs.HydroDatabase.read(HYDRO)
    system = fs.assemble(fs.Model(parts=[fs.Body(
        name="hull", mass=1e7, inertia=(1e10,) * 3, hydro=fs.PotentialFlow(database=one, radiation="state_space"))],
        sea=SEA))  # fmt: skip
    batch = next(b for b in system.batches if isinstance(b, FloaterBatch))
    (fit,) = batch.kernels
    A, B = fit.added_mass_and_damping(one.omega)
    a = np.abs(A + one.added_mass_inf - one.added_mass) / entry_scales(one)[0]
    b = np.abs(B - one.radiation_damping) / entry_scales(one)[1]
    record(ROW_STATE, "VolturnUS-S: worst A(w) of the fit", 100.0 * a.max(), 0.5, "%")
    record(ROW_STATE, "VolturnUS-S: worst B(w) of the fit", 100.0 * b.max(), 0.5, "%")
    record(ROW_STATE, "VolturnUS-S: states", float(fit.order.sum()), 400.0)
    assert "hull: radiation memory" in batch.notes()[0] and "states" in batch.notes()[0]


# --- frames and matrices ----------------------------------------------------------------------------


@pytest.mark.parametrize("radiation", ["convolution", "state_space"])
def test_the_pair_drawn_elsewhere_and_turned(db, record, radiation):
    psi, shift = 37.0, np.array([310.0, -190.0, 0.0])
    c, s = np.cos(np.radians(psi)), np.sin(np.radians(psi))
    T = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    seen = []
    for turn, where in ((0.0, np.zeros(3)), (psi, shift)):
        phase = np.degrees(wave_number(0.9) * (np.cos(np.radians(60.0 + turn)) * where[0]
                                               + np.sin(np.radians(60.0 + turn)) * where[1]))  # fmt: skip
        wave = fs.RegularWave(height=1.0, period=2.0 * np.pi / 0.9, heading_deg=60.0 + turn, phase_deg=phase)
        sea = fs.Sea(depth=DEPTH, density=RHO, waves=wave, wave_ramp=10.0)
        model = fs.Model(parts=two(db, psi=turn, shift=where, radiation=radiation), sea=sea)
        system = fs.assemble(model)
        state = system.initial_state()
        drawn = state.x[:2].copy()
        y = np.array(run(system, state, fs.generalised_alpha(), 0.1, 300, lambda s, d=drawn: s.x[:2] - d,
                         tolerance=1e-10))  # fmt: skip
        seen.append(y if turn == 0.0 else y @ T)
    size = np.abs(seen[0]).max()
    record(ROW, f"{radiation}: drawn elsewhere and turned by 37 deg", np.abs(seen[0] - seen[1]).max() / size, 1e-7)


@pytest.mark.parametrize("radiation", ["convolution", "state_space"])
def test_matrices_are_the_differences_of_the_residual(db, record, radiation):
    rows = 1e5 * np.random.default_rng(3).uniform(-1.0, 1.0, (3, 6, 6))
    bodies = two(db, psi=25.0, radiation=radiation, linear_damping=rows[0], quadratic_damping=rows[1],
                 linear_stiffness=rows[2])  # fmt: skip
    alone = fs.Body(name="alone", mass=1e6, inertia=INERTIA, position=(0.0, 300.0, 0.0),
                    hydro=fs.PotentialFlow(database=HYDRO))  # fmt: skip
    sea = fs.Sea(depth=DEPTH, density=RHO, current=fs.Current(speed=0.4, heading_deg=20.0))
    # the second of the pair first, a third body that does not interact between them
    system = fs.assemble(fs.Model(parts=[bodies[1], alone, bodies[0]], sea=sea))
    state = system.initial_state()
    rng = np.random.default_rng(5)
    state.x[:-1] += rng.uniform(-1.0, 1.0, (3, 3))
    for k in range(3):
        state.q[k] = turn_quaternion(tuple(rng.uniform(-0.2, 0.2, 3)), tuple(state.q[k]))
    free = free_unknowns(system)
    state.v[free] = rng.uniform(-0.5, 0.5, free.size)
    state.a[free] = rng.uniform(-0.5, 0.5, free.size)
    w = system.work()
    system.begin(w, state, 0.1)
    system.load(w, state)
    worst = 0.0
    for n, (name, step) in enumerate((("a", 1.0), ("v", 1e-4), ("x", 1e-4))):
        want = matrix(system, w, np.eye(4)[n])[np.ix_(free, free)]
        got = np.zeros_like(want)
        for m, i in enumerate(free):
            for weight, by in ((8.0, 1.0), (-8.0, -1.0), (-1.0, 2.0), (1.0, -2.0)):
                system.load(w, state)
                if name == "x":
                    displace(system, w, i, by * step)
                else:
                    getattr(w, name)[i] += by * step
                got[:, m] += weight / (12.0 * step) * residual(system, w)[free]
        system.load(w, state)
        lever = np.where(free < 3 * (system.n_point + 1), 1.0, 20.0)
        size = np.outer(lever, lever)
        worst = max(worst, np.abs((got - want) / size).max() / np.abs(want / size).max())
    record(ROW, f"{radiation}: matrices of two interacting and one other body against differences", worst, 1e-7)
    batch = next(b for b in system.batches if isinstance(b, FloaterBatch))
    assert [len(group.parts) for group in batch.groups] == [2, 1]
    assert np.abs(batch.coupling[1, 1]).max() > 0.0  # the memory's tangent couples the two


@pytest.mark.parametrize("radiation", ["convolution", "state_space"])
def test_a_copied_state_goes_on_bit_for_bit(db, radiation):
    import pickle

    system = fs.assemble(fs.Model(parts=two(db, radiation=radiation), sea=SEA))
    state = system.initial_state()
    state.x[0, 2] += 0.5
    run(system, state, fs.generalised_alpha(), 0.1, 50)
    twins = [state.copy(), pickle.loads(pickle.dumps(state))]
    for s in (state, *twins):
        run(system, s, fs.generalised_alpha(), 0.07, 30, start=False)
    for twin in twins:
        assert (twin.x == state.x).all() and (twin.q == state.q).all() and (twin.v == state.v).all()


# --- frequency domain --------------------------------------------------------------------------------


def test_frequency_terms_and_wave_force(db, record):
    psi, shift = 30.0, np.array([100.0, -50.0, 0.0])
    system = fs.assemble(fs.Model(parts=two(db, psi=psi, shift=shift)[::-1], sea=SEA))
    batch = next(b for b in system.batches if isinstance(b, FloaterBatch))
    at = 20
    omega = float(OMEGA[at])
    c, s = np.cos(np.radians(psi)), np.sin(np.radians(psi))
    T = np.kron(np.eye(4), np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))
    dofs, mass, damping = batch.frequency_terms(omega, system.n_point)
    assert len(dofs) == 1 and dofs[0].shape == (12,)
    # the model names the spar first: body 'float' is the second, points 1 and rotation 1
    want = [*range(3, 6), *range(3 * 3 + 3, 3 * 3 + 6), *range(3), *range(9, 12)]
    assert list(dofs[0]) == want
    L = transfer(np.array([omega]))[0]
    error = max(np.abs(T.T @ damping[0] @ T - L.real).max(), omega * np.abs(T.T @ mass[0] @ T - L.imag / omega).max())
    record(ROW, "A(w) - A_inf and B(w) of the group, turned by 30 deg", error / np.abs(L).max(), 1e-9)
    heading = 4
    b = db.headings[heading] + np.radians(psi)
    dofs, F = batch.wave_force(omega, b, system.n_point)
    assert [list(row) for row in dofs] == [want[:6], want[6:]]
    k = wave_number(omega)
    X = (T @ db.excitation[at, heading]) * np.exp(-1j * k * (np.cos(b) * shift[0] + np.sin(b) * shift[1]))
    record(ROW, "regular wave's force, drawn elsewhere and turned", np.abs(F.ravel() - X).max() / np.abs(X).max(), 1e-7)
    with pytest.raises(ModelError, match="Body 'body_0'.*leave out"):
        batch.wave_force(30.0, 0.0, system.n_point)


def test_natural_periods_of_the_pair(db, record):
    """Heave coupled to all else: eigenvalues of [C + K - w^2 (M + A(w))] at its own frequency."""
    modes = fs.natural_modes(fs.Model(parts=two(db), sea=SEA), count=12)
    M = np.diag([RHO * VOLUME] * 3 + list(INERTIA) + [RHO * VOLUME] * 3 + list(INERTIA)) + db.added_mass_inf
    C = db.hydrostatic_stiffness + np.kron(np.eye(2), STIFF)
    worst = 0.0
    for mode in modes:
        A = transfer(np.array([mode.omega]))[0].imag / mode.omega
        squares = np.linalg.eigvals(np.linalg.solve(M + A, C)).real
        worst = max(worst, np.abs(np.sqrt(np.maximum(squares, 0.0)) / mode.omega - 1.0).min())
    record(ROW, "natural periods against the eigenvalues of the (12, 12) matrices", worst, 1e-3)


# --- a mesh in place of the linear Froude-Krylov part ---------------------------------------------------


class _Nothing:
    """A hull that brings no loads."""

    def attached_to(self, body: Any) -> list[Part]:
        return []

    def files(self) -> list[str]:
        return ["mesh.stl"]


def test_a_hull_takes_buoyancy_stiffness_and_froude_krylov_away(db):
    part = 0.4 * db.excitation * np.exp(0.3j)
    whole = pair(froude_krylov=part)
    bodies = two(whole, hull=_Nothing())
    assert bodies[0].hydro.files() == ["mesh.stl"]
    wave = fs.RegularWave(height=2.0, period=2.0 * np.pi / OMEGA[19])
    system = fs.assemble(fs.Model(parts=bodies, sea=fs.Sea(depth=DEPTH, density=RHO, waves=wave, wave_ramp=0.0)))
    batch = next(b for b in system.batches if isinstance(b, FloaterBatch))
    _, F = batch.wave_force(float(OMEGA[19]), 0.0, system.n_point)
    want = (db.excitation - part)[19, 6]
    assert np.degrees(db.headings[6]) == pytest.approx(0.0)
    assert F.ravel() == pytest.approx(want, abs=1e-9 * np.abs(want).max())
    # without water loads but linear stiffness: at rest nothing but weight and what was asked for
    w = system.work()
    state = system.initial_state()
    state.x[0] += [1.0, 2.0, 3.0]
    system.load(w, state)
    w.still = True
    system.begin(w, state, 0.0)
    r = residual(system, w)
    assert r[:3] == pytest.approx([3e5, 6e5, RHO * VOLUME * GRAVITY], rel=1e-12)
    with pytest.raises(ModelError, match="does not have the Froude-Krylov part"):
        two(db, hull=_Nothing())
    with pytest.raises(ModelError, match="hull: got 'mesh.stl'"):
        two(whole, hull="mesh.stl")


# --- bad input ----------------------------------------------------------------------------------------


def build(bodies: list[fs.Body]) -> fs.System:
    return fs.assemble(fs.Model(parts=bodies, sea=SEA))


def test_bad_input(db):
    def refused(message: str, make: Any) -> None:
        with pytest.raises(ModelError, match=message):
            make()

    refused("holds 2 bodies, 'float', 'spar'; say which", lambda: fs.PotentialFlow(database=db))
    refused(r"has no body 'sparr' \(did you mean 'spar'\?\)", lambda: fs.PotentialFlow(database=db, body="sparr"))
    refused("there is no body 2; it has 'float', 'spar'", lambda: fs.PotentialFlow(database=db, body=2))
    refused("there is no body True", lambda: fs.PotentialFlow(database=db, body=True))
    refused("there is no body 1.5", lambda: fs.PotentialFlow(database=db, body=1.5))
    refused("radiation: got 'statespace'; must be 'convolution' or 'state_space'",
            lambda: fs.PotentialFlow(database=db, body=0, radiation="statespace"))  # fmt: skip
    refused("no body of the model is its 'spar'; its 2 bodies", lambda: build(two(db)[:1]))
    refused("'body_0', 'body_1' are all its body 'float'", lambda: build(two(db, names=("float", "float"))))
    refused(r"'body_1' is drawn \(41, 15\) m from 'body_0'.*\(40, 15, 0\) m, is \(40, 15\) m from the other's, "
            r"\(0, 0, 0\) m", lambda: build(two(db, apart=APART + [1.0, 0.0, 0.0])))  # fmt: skip
    turned = [two(db)[0], two(db, psi=10.0, shift=APART - two(db, psi=10.0)[1].position)[1]]
    refused("'body_0' is drawn at a heading of 0 deg, 'body_1' at 10 deg", lambda: build(turned))
    refused(r"one memory, so they must be the same", lambda: build([two(db)[0], two(db, radiation="state_space")[1]]))
    refused("one memory, so they must be the same", lambda: build([two(db)[0], two(db, memory=40.0)[1]]))
    refused("Body 'body_0': .*reference point of 'float'", lambda: build(two(db, shift=(0.0, 0.0, 1.0))))
    for names in ((0, 1), ("float", 1), (0, "spar")):
        assert build(two(db, names=names)).n_dof == 3 * 6


def test_databases_by_path_are_one(db, tmp_path):
    path = tmp_path / "pair.nc"
    db.write(path)
    bodies = [two(str(path))[0], two(tmp_path / "." / "pair.nc")[1]]
    system = build(bodies)
    batch = next(b for b in system.batches if isinstance(b, FloaterBatch))
    assert [group.names for group in batch.groups] == ["body_0, body_1"]
    from floatsim.study.sheet import body_sheets, database_findings, memory_notes

    (note,) = memory_notes(system)
    assert note.startswith("body_0, body_1: radiation memory") and "float " in note
    assert {names for names, _ in database_findings(system.model)} == {"body_0, body_1"}
    sheets = body_sheets(system)
    assert [sheet.stiffness_roll for sheet in sheets] == pytest.approx([6e7, 5e7])
    assert sheets[0].buoyancy == pytest.approx(RHO * GRAVITY * VOLUME)
