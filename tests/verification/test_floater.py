"""A floater against closed forms: its own frequency-domain solution, frames, hydrostatics, current, memory, company.

The frequency-domain solution is written here from the database's tables alone: no solver, no kernel and no
interpolation of floatsim's takes part in it.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import radiation_reference as smooth
from mechanics import displace, free_unknowns, matrix, observed_order, residual, run
from shipped import HYDRO, load

import floatsim as fs
from floatsim.frames import matrix_from_angles, quaternion_from_matrix, set_matrix, skew, turn_quaternion
from floatsim.hydro.radiation import RadiationKernel

RHO, GRAVITY, DEPTH = 1025.0, 9.81, 200.0
SEA = fs.Sea(depth=DEPTH, density=RHO)

# stiffness of the three chains as in the public second-order WAMIT input of VolturnUS-S [N/m, N, N m]
MOORING = np.diag([7.192e4, 7.192e4, 6.076e4, 2.587e8, 2.587e8, 2.524e8])
MOORING[0, 4] = MOORING[4, 0] = 1.145e6
MOORING[1, 3] = MOORING[3, 1] = -1.145e6

QUADRATIC = np.diag([9.23e5, 9.23e5, 2.30e6, 1.68e10, 1.68e10, 4.80e10])
QUADRATIC[0, 4] = QUADRATIC[4, 0] = -8.92e6
QUADRATIC[1, 3] = QUADRATIC[3, 1] = 8.92e6

CM = np.array([0.0, 0.0, -1.5])  # m: above the centre of buoyancy, so that the drawing position is an equilibrium
INERTIA = np.array([[4.40e10, 0.0, 1.0e9], [0.0, 4.38e10, 0.0], [1.0e9, 0.0, 2.39e10]])  # kg m2 about it

ROW_RAO = "linear floater in regular waves against its own frequency-domain solution"
ROW_TURNED = "invariance: the whole still-water system under translation and rotation about z"
ROW_STATICS = "hydrostatics and current of a linear floater"
ROW_MEMORY = "radiation memory: the same motion with other steps"
ROW_COMPANY = "several floaters in one model"


@pytest.fixture(scope="module")
def db() -> fs.HydroDatabase:
    return fs.HydroDatabase.read(HYDRO)


def floater(db: fs.HydroDatabase, name: str = "floater", cm: Any = CM, **changes: Any) -> fs.Body:
    """A rigid body of the displaced mass; keywords of Body, or of PotentialFlow."""
    own = {key: changes.pop(key) for key in ("position", "attitude_deg", "mass") if key in changes}
    J = INERTIA
    own.setdefault("mass", RHO * db.volume[0])
    return fs.Body(
        name=name, center_of_mass=cm, inertia=(J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]),
        hydro=fs.PotentialFlow(database=db, **changes), **own,
    )  # fmt: skip


def rigid_mass(mass: float, cm: np.ndarray) -> np.ndarray:
    """Mass matrix (6, 6) about the reference point."""
    S = skew(cm)
    return np.block([[mass * np.eye(3), -mass * S], [mass * S, INERTIA - mass * S @ S]])


def weight_stiffness(mass: float, cm: np.ndarray) -> np.ndarray:
    """Minus the change of the weight's moment when its arm turns: arm x (0, 0, -m g), arm = cm + phi x cm."""
    K = np.zeros((6, 6))
    for j in range(3):
        K[3:, 3 + j] = -np.cross(np.cross(np.eye(3)[j], cm), [0.0, 0.0, -mass * GRAVITY])
    return K


def about_z(psi: float) -> np.ndarray:
    c, s = np.cos(psi), np.sin(psi)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def attitude(state: fs.State, k: int = 0) -> np.ndarray:
    R = np.zeros((1, 3, 3))
    set_matrix(R, 0, tuple(state.q[k]))
    return R[0]


def pose(state: fs.State) -> np.ndarray:
    """Position and rotation vector (6,) of the first body; small angles."""
    return np.concatenate([state.x[0], 2.0 * state.q[0, 1:] * np.sign(state.q[0, 0])])


# --- waves ------------------------------------------------------------------------------------------


def between(x: float, grid: np.ndarray, table: np.ndarray) -> np.ndarray:
    """Eight-point Lagrange interpolation. (With four the surge force at 8 s, where the columns' forces all but
    cancel, is 1.7 % off: what lies between the table's frequencies is part of the coefficients.)"""
    near = slice(*(np.clip(np.searchsorted(grid, x) - 4, 0, len(grid) - 8) + np.array([0, 8])))
    nodes = grid[near]
    weights = [np.prod([(x - b) / (a - b) for b in nodes if b != a]) for a in nodes]
    return np.tensordot(weights, table[near], 1)


def wave_damping(db: fs.HydroDatabase) -> np.ndarray:
    """5 % of critical in every degree of freedom on its own, with A at the lowest frequency."""
    stiffness = np.diag(db.hydrostatic_stiffness + weight_stiffness(RHO * db.volume[0], CM) + MOORING)
    mass = np.diag(rigid_mass(RHO * db.volume[0], CM) + db.added_mass[0])
    return np.diag(0.1 * np.sqrt(stiffness * mass))


def frequency_domain(db: fs.HydroDatabase, omega: float, heading_deg: float) -> np.ndarray:
    """Motion (6,) per metre of wave, complex: [-w^2 (M + A) + i w (B + B_5%) + C + K] xi = X."""
    A, B = between(omega, db.omega, db.added_mass), between(omega, db.omega, db.radiation_damping)
    at = int(np.argmin(np.abs(np.degrees(db.headings) - heading_deg)))
    assert np.degrees(db.headings[at]) == pytest.approx(heading_deg, abs=1e-3)
    X = between(omega, db.omega, db.excitation)[at]
    mass = RHO * db.volume[0]
    stiffness = db.hydrostatic_stiffness + weight_stiffness(mass, CM) + MOORING
    inertia = rigid_mass(mass, CM) + A
    return np.linalg.solve(-(omega**2) * inertia + 1j * omega * (B + wave_damping(db)) + stiffness, X)


def time_domain(db: fs.HydroDatabase, period: float, h: float, heading_deg: float = 30.0, duration: float = 2400.0,
                **drawn: Any) -> np.ndarray:  # fmt: skip
    """Steady motion (6,) per metre of wave from a run with a wave of 1 cm (rotations stay below 1e-6 rad)."""
    omega, a = 2.0 * np.pi / period, 0.01
    body = floater(db, linear_stiffness=MOORING, linear_damping=wave_damping(db), **drawn)
    wave = fs.RegularWave(height=2.0 * a, period=period, heading_deg=heading_deg)
    system = fs.assemble(fs.Model(parts=[body], sea=fs.Sea(depth=DEPTH, density=RHO, waves=wave)))
    state = system.initial_state()
    start = state.copy()
    seen = run(system, state, fs.generalised_alpha(), h, round(duration / h),
               lambda s: np.concatenate([s.x[0] - start.x[0], turned_by(s, start)]), tolerance=1e-9)  # fmt: skip
    t, y = h * np.arange(len(seen)), np.array(seen)
    last = t > t[-1] - 12.0 * period
    t, y = t[last], y[last]
    # what is left of the start is slow: a straight line
    basis = np.stack([np.cos(omega * t), -np.sin(omega * t), np.ones_like(t), t - t.mean()], axis=1)
    coefficients = np.linalg.lstsq(basis, y, rcond=None)[0]
    return (coefficients[0] + 1j * coefficients[1]) / a


def turned_by(state: fs.State, start: fs.State) -> np.ndarray:
    """Small rotation vector (3,) from start to state."""
    D = attitude(state) @ attitude(start).T
    return 0.5 * np.array([D[2, 1] - D[1, 2], D[0, 2] - D[2, 0], D[1, 0] - D[0, 1]])


def compare(got: np.ndarray, want: np.ndarray) -> tuple[float, float]:
    """Largest relative error of amplitude and largest of phase [deg], where above 1 % of the largest of its kind."""
    size = np.abs(want).reshape(2, 3)
    counts = (size > 0.01 * size.max(axis=1, keepdims=True)).ravel()
    ratio = (got / want)[counts]
    return float(np.abs(np.abs(ratio) - 1.0).max()), float(np.abs(np.degrees(np.angle(ratio))).max())


@pytest.mark.slow
@pytest.mark.parametrize("period", [8.0, 12.0, 25.0])
def test_regular_waves_against_the_frequency_domain(db, record, period):
    got, want = time_domain(db, period, 0.1), frequency_domain(db, 2.0 * np.pi / period, 30.0)
    amplitude, phase = compare(got, want)
    record(ROW_RAO, f"{period:g} s, heading 30 deg, dt 0.1 s: amplitude", 100.0 * amplitude, 0.5, "%")
    record(ROW_RAO, f"{period:g} s, heading 30 deg, dt 0.1 s: phase", phase, 1.0, "deg")


@pytest.mark.slow
def test_regular_waves_at_a_frequency_of_the_database(db, record):
    """Nothing is interpolated: what differs is memory and time stepping."""
    worst = np.array(
        [compare(time_domain(db, 2.0 * np.pi / w, 0.1), frequency_domain(db, w, 30.0)) for w in (0.25, 0.5, 0.8)]
    )
    record(ROW_RAO, "0.25, 0.5, 0.8 rad/s of the database, dt 0.1 s: amplitude", 100.0 * worst[:, 0].max(), 0.5, "%")
    record(ROW_RAO, "0.25, 0.5, 0.8 rad/s of the database, dt 0.1 s: phase", worst[:, 1].max(), 1.0, "deg")


@pytest.mark.slow
def test_response_is_of_second_order_in_the_step(db, record):
    """Differences of successive halvings; the radiation grid stays at 0.1 s."""
    z = [time_domain(db, 2.0 * np.pi / 0.8, h, duration=1500.0) for h in (0.8, 0.4, 0.2)]
    order = np.log2(np.abs(z[0] - z[1]) / np.abs(z[1] - z[2]))[[2, 3, 4, 5]]
    record(ROW_RAO, "order in the step, heave and rotations (lowest)", order.min(), (1.8, 2.3))
    record(ROW_RAO, "order in the step, heave and rotations (highest)", order.max(), (1.8, 2.3))


@pytest.mark.slow
def test_a_floater_elsewhere_with_another_heading_answers_in_its_own_frame(db, record):
    """Drawn at (310, -190) m and turned by 37 deg, a wave of 67 deg meets it at 30 deg, later by k . x."""
    period = 12.0
    omega, psi, where = 2.0 * np.pi / period, np.radians(37.0), np.array([310.0, -190.0, 0.0])
    got = time_domain(db, period, 0.1, heading_deg=67.0, position=where, attitude_deg=(0.0, 0.0, 37.0))
    k = omega**2 / GRAVITY
    for _ in range(50):
        k = omega**2 / GRAVITY / np.tanh(k * DEPTH)
    direction = np.array([np.cos(np.radians(67.0)), np.sin(np.radians(67.0)), 0.0])
    turn = np.kron(np.eye(2), about_z(psi))
    # compared in the floater's frame, where the degrees of freedom are
    want = frequency_domain(db, omega, 30.0) * np.exp(-1j * k * (where @ direction))
    amplitude, phase = compare(turn.T @ got, want)
    record(ROW_RAO, "12 s, elsewhere and turned: amplitude", 100.0 * amplitude, 0.5, "%")
    record(ROW_RAO, "12 s, elsewhere and turned: phase", phase, 1.0, "deg")


# --- frames -----------------------------------------------------------------------------------------


def turned_model(model: fs.Model, psi: float, shift: np.ndarray) -> fs.Model:
    """The same system drawn elsewhere: every position turned about z and shifted, bodies with their heading."""
    T = about_z(psi)

    def move(point: Any) -> Any:
        return point if isinstance(point, str) else tuple(T @ np.asarray(point) + shift)

    parts = []
    for part in model.parts:
        if isinstance(part, fs.Body):
            fields = {key: getattr(part, key) for key in fs.Body.model_fields}
            heading = (0.0, 0.0, part.attitude_deg[2] + float(np.degrees(psi)))
            part = fs.Body(**{**fields, "position": move(part.position), "attitude_deg": heading})
        parts.append(part)
    joints = [type(joint)(a=move(joint.a), b=move(joint.b)) for joint in model.joints]
    return fs.Model(name=model.name, parts=parts, joints=joints, sea=model.sea, gravity=model.gravity)


def polished(system: fs.System, state: fs.State) -> fs.State:
    """The equilibrium after two more Newton iterations: what is left is round-off."""
    w, free = system.work(), free_unknowns(system)
    system.load(w, state)
    w.still = True
    system.begin(w, state, state.t)
    for _ in range(2):
        w.v[:] = w.a[:] = 0.0
        A = matrix(system, w, (0.0, 0.0, 1.0, 1.0))[np.ix_(free, free)]
        for i, by in zip(free, np.linalg.solve(A, -w.r[free]), strict=True):
            displace(system, w, int(i), float(by))
    new = state.copy()
    new.x[:], new.q[:], new.lam[:] = w.x, w.q, w.lam
    return new


@pytest.mark.slow
def test_the_moored_system_does_not_notice_where_it_is_drawn(record, monkeypatch):
    """Solved to round-off: what is compared are the equations, not where an iteration stops."""
    monkeypatch.setattr(fs.solve.static, "TOLERANCE", 1e-10)
    psi, shift = np.radians(37.0), np.array([120.0, -70.0, 0.0])
    T = about_z(psi)
    here = load("volturnus_s").build(elements=20)
    systems = [fs.assemble(here), fs.assemble(turned_model(here, psi, shift))]
    rest = [polished(system, fs.solve_static(system)[0]) for system in systems]

    def apart(a: fs.State, b: fs.State) -> np.ndarray:
        """Positions, rotations, velocity of the floater, joint forces: largest differences."""
        return np.array([
            np.abs((b.x[:-1] - shift) @ T - a.x[:-1]).max(),
            np.abs(T.T @ attitude(b) - attitude(a)).max(),
            np.abs(b.v[:3] @ T - a.v[:3]).max(),
            np.abs(b.lam.reshape(-1, 3) @ T - a.lam.reshape(-1, 3)).max(),
        ])  # fmt: skip

    size = np.array([systems[0].length, 1.0, 1.0, np.abs(rest[0].lam).max()])
    record(ROW_TURNED, "static", (apart(*rest) / size).max(), 1e-10)
    # a release in all six degrees of freedom at once; both runs start from the same shape of the lines. One in which a
    # node comes to bounce on the bed makes rounding grow a million times, which is no matter of frames
    a = rest[0].copy()
    a.x[0] += (4.0, 3.0, 2.0)
    a.q[0] = turn_quaternion(tuple(np.radians([2.0, 3.0, 5.0])), tuple(a.q[0]))
    a, _ = fs.solve_static(systems[0], a, hold=["platform"])
    b = rest[1].copy()
    b.x[:-1] = a.x[:-1] @ T.T + shift
    b.q[0] = turn_quaternion((0.0, 0.0, psi), tuple(a.q[0]))
    b.lam[:] = (a.lam.reshape(-1, 3) @ T.T).ravel()
    steppers = [fs.Stepper(system, tolerance=1e-11) for system in systems]
    worst, fastest = np.zeros(4), 0.0
    for stepper, state in zip(steppers, (a, b), strict=True):
        stepper.start(state, 0.1)
    for _ in range(200):
        assert all(s.step(state, 0.1).converged for s, state in zip(steppers, (a, b), strict=True))
        worst = np.maximum(worst, apart(a, b) / size)
        fastest = max(fastest, float(np.abs(a.v[:3]).max()))
    assert fastest > 0.5  # m/s: it moved; velocities are compared with 1 m/s
    for name, value in zip(("positions", "rotations", "velocity of the floater", "joint forces"), worst, strict=True):
        record(ROW_TURNED, f"20 s of decay: {name}", value, 1e-10)


# --- hydrostatics and current -----------------------------------------------------------------------


def total_load(system: fs.System, x: np.ndarray, R: np.ndarray) -> np.ndarray:
    """Force and moment (6,) on the first body at rest in still water at reference point x and attitude R."""
    state = system.initial_state()
    state.x[0], state.q[0] = x, quaternion_from_matrix(R)
    w = system.work()
    system.load(w, state)
    w.still = True
    system.begin(w, state, 0.0)
    r = residual(system, w)
    n = 3 * (system.n_point + 1)
    return -np.concatenate([r[:3], r[n : n + 3]])


def exp(phi: Any) -> np.ndarray:
    state = fs.State(0.0, *(np.zeros((1, 4)) for _ in range(6)))
    state.q = np.array([turn_quaternion(tuple(phi), (1.0, 0.0, 0.0, 0.0))])
    return attitude(state)


def test_restoring_by_differences_is_database_plus_weight(db, record):
    """All 36 entries, centre of mass off the axis; C44 is one of them."""
    mass, cm = 1.02 * RHO * db.volume[0], np.array([0.7, -0.4, -3.0])
    system = fs.assemble(fs.Model(parts=[floater(db, cm=cm, mass=mass)], sea=SEA))
    want = db.hydrostatic_stiffness + weight_stiffness(mass, cm)
    e, got = 1e-4, np.zeros((6, 6))
    for j in range(6):
        step = e * np.eye(6)[j]
        ahead, behind = (total_load(system, s * step[:3], exp(s * step[3:])) for s in (1.0, -1.0))
        got[:, j] = -(ahead - behind) / (2.0 * e)
    scale = np.sqrt(np.outer(np.diag(want)[[2, 2, 2, 3, 4, 4]], np.diag(want)[[2, 2, 2, 3, 4, 4]]))
    record(ROW_STATICS, "restoring by differences of the total load, 36 entries of their diagonal",
           np.abs((got - want) / scale).max(), 1e-7)  # fmt: skip
    # the figure of the definition's whole system: C44 + weight term
    record(ROW_STATICS, "C44 by differences against C44 - m g z_G", abs(got[3, 3] / (
        db.hydrostatic_stiffness[3, 3] - mass * GRAVITY * cm[2]) - 1.0), 1e-7)  # fmt: skip


def test_the_tangent_is_the_same_restoring(db, record):
    """What statics and modes use."""
    mass, cm = 1.02 * RHO * db.volume[0], np.array([0.7, -0.4, -3.0])
    system = fs.assemble(fs.Model(parts=[floater(db, cm=cm, mass=mass)], sea=SEA))
    state = system.initial_state()
    w = system.work()
    system.load(w, state)
    w.still = True
    system.begin(w, state, 0.0)
    index = np.r_[0:3, 6:9]
    got = matrix(system, w, (0.0, 0.0, 1.0, 1.0))[np.ix_(index, index)]
    want = db.hydrostatic_stiffness + weight_stiffness(mass, cm)
    record(ROW_STATICS, "stiffness of modes and statics", np.abs(got - want).max() / np.abs(want).max(), 1e-12)


def test_surge_changes_no_hydrostatic_moment(db, record):
    """20 m of surge, upright and heeled: buoyancy goes with the floater."""
    system = fs.assemble(fs.Model(parts=[floater(db, mass=0.9 * RHO * db.volume[0])], sea=SEA))
    worst = 0.0
    for R in (np.eye(3), matrix_from_angles(0.05, 0.1, 0.0)):
        moved, there = total_load(system, np.array([20.0, -7.0, 0.0]), R), total_load(system, np.zeros(3), R)
        worst = max(worst, float(np.abs(moved - there).max() / (RHO * GRAVITY * db.volume[0])))
    record(ROW_STATICS, "20 m of surge: change of load over the weight", worst, 1e-14)


def test_moment_at_a_large_angle_in_closed_form(db, record):
    """-C55 theta + m g z_G sin(theta): waterplane linear in the tilt, weight at any angle."""
    mass = RHO * db.volume[0]
    theta = np.radians(20.0)
    worst = 0.0
    for psi in (0.0, 37.0):
        body = floater(db, attitude_deg=(0.0, 0.0, psi))
        system = fs.assemble(fs.Model(parts=[body], sea=SEA))
        T = about_z(np.radians(psi))
        moment = T.T @ total_load(system, np.zeros(3), T @ exp((0.0, theta, 0.0)))[3:]
        want = -db.hydrostatic_stiffness[4, 4] * theta + mass * GRAVITY * CM[2] * np.sin(theta)
        worst = max(worst, abs(moment[1] / want - 1.0), abs(moment[0] / want), abs(moment[2] / want))
    record(ROW_STATICS, "pitch moment at 20 deg, any heading", worst, 1e-12)


def isotropic(db: fs.HydroDatabase) -> fs.HydroDatabase:
    """As stiff and as heavy in roll as in pitch, making no waves: such a floater has no heading."""
    C, A = np.diag(np.diag(db.hydrostatic_stiffness)), np.diag(np.diag(db.added_mass_inf))
    C[3, 3], A[1, 1], A[3, 3] = C[4, 4], A[0, 0], A[4, 4]
    return replace(db, hydrostatic_stiffness=C, added_mass_inf=A, radiation_damping=np.zeros_like(db.radiation_damping),
                   added_mass=np.broadcast_to(A, db.added_mass.shape))  # fmt: skip


@pytest.mark.parametrize("psi", [10.0, 60.0, -120.0, 179.0])
def test_a_yawed_floater_rights_itself_about_the_axis_of_its_tilt(db, record, psi):
    """-C55 theta + m g z_G sin(theta) about the axis of the tilt and nothing across it, however the body is yawed."""
    db = isotropic(db)
    system = fs.assemble(fs.Model(parts=[floater(db)], sea=SEA))
    theta = np.radians(6.0)
    axis = np.array([np.cos(0.3), np.sin(0.3), 0.0])
    moment = total_load(system, np.zeros(3), exp(theta * axis) @ about_z(np.radians(psi)))[3:]
    want = -db.hydrostatic_stiffness[4, 4] * theta + RHO * db.volume[0] * GRAVITY * CM[2] * np.sin(theta)
    record(ROW_STATICS, f"moment of a tilted floater, yawed by {psi:g} deg", np.abs(moment / want - axis).max(), 1e-9)


@pytest.mark.parametrize("psi", [15.0, 60.0])
def test_a_yawed_floater_does_not_feed_on_its_pitch(db, record, psi):
    """Pitch of an undamped floater without a heading, yawed away from its drawing: it stays pitch, of the same size.

    A restoring moment along the rotation vector would be psi/2 off the axis: roll and pitch would grow as
    exp(w psi t/4), 2.3 times in 100 s for 15 degrees.
    """
    body = floater(isotropic(db), cm=(0.0, 0.0, CM[2]))
    body = body.model_copy(update={"inertia": (4.4e10, 4.4e10, 2.4e10)})
    system = fs.assemble(fs.Model(parts=[body], sea=SEA))
    state = system.initial_state()
    state.q[0] = quaternion_from_matrix(exp((0.0, np.radians(5.0), 0.0)) @ about_z(np.radians(psi)))
    tilts = run(system, state, fs.newmark(), 0.1, 3000, lambda s: attitude(s)[:, 2].copy())
    n = np.degrees(np.array(tilts))
    record(ROW_STATICS, f"roll in 300 s of pitch from 5 deg, yawed by {psi:g} deg", np.abs(n[:, 1]).max(), 1e-6, "deg")
    growth = np.abs(n[:, 0]).max() / np.abs(n[0, 0]) - 1.0
    record(ROW_STATICS, f"growth of the pitch, yawed by {psi:g} deg", growth, 1e-3)


def test_a_free_floater_drifts_and_does_not_capsize(db):
    """Off-axis weight tilts it; surge, sway and yaw have no stiffness at all, and no mode is unstable."""
    system = fs.assemble(fs.Model(parts=[floater(db, cm=(-0.3, 0.0, -1.5))], sea=SEA))
    periods = [mode.period for mode in fs.natural_modes(system)]
    assert np.isinf(periods[:3]).all() and np.isfinite(periods[3:]).all()


def test_quadratic_damping_is_relative_to_the_current(db, record):
    """Drifting with the current it feels nothing; held in it, B |u| u in its own frame."""
    u = np.array([0.9, -0.4, 0.0])
    speed, toward = float(np.hypot(*u[:2])), float(np.degrees(np.arctan2(u[1], u[0])))
    sea = fs.Sea(depth=DEPTH, density=RHO, current=fs.Current(speed=speed, heading_deg=toward))
    body = floater(db, quadratic_damping=QUADRATIC, attitude_deg=(0.0, 0.0, 37.0))
    wet, still = fs.assemble(fs.Model(parts=[body], sea=sea)), fs.assemble(fs.Model(parts=[body], sea=SEA))
    T = about_z(np.radians(37.0))

    def force(system: fs.System, v: np.ndarray) -> np.ndarray:
        state = system.initial_state()
        state.v[:3] = v
        w = system.work()
        system.load(w, state)
        w.still = True
        system.begin(w, state, 0.0)
        r = residual(system, w)
        return -np.concatenate([r[:3], r[6:9]])

    own = np.concatenate([T.T @ u, np.zeros(3)])
    want = np.kron(np.eye(2), T) @ (QUADRATIC @ (np.abs(own) * own))
    rest = force(still, np.zeros(3))
    size = np.abs(want).reshape(2, 3).max(axis=1).repeat(3)
    for what, drag, expected in (
        ("held in a current: B times the square of its speed", force(wet, np.zeros(3)) - rest, want),
        ("drifting with the current: no drag", force(wet, u) - rest, 0.0 * want),
        ("moving in still water: the opposite", force(still, u) - rest, -want),
    ):
        record(ROW_STATICS, what, np.abs((drag - expected) / size).max(), 1e-6)


@pytest.mark.parametrize("psi", [0.0, 37.0])
def test_offset_in_a_current_in_closed_form(db, record, psi):
    """(C + K + weight) xi = B |u| u, with u in the floater's frame; the angles are 0.3 deg."""
    speed, toward = 0.6, 25.0 + psi
    body = floater(db, quadratic_damping=QUADRATIC, linear_stiffness=MOORING, attitude_deg=(0.0, 0.0, psi))
    sea = fs.Sea(depth=DEPTH, density=RHO, current=fs.Current(speed=speed, heading_deg=toward))
    system = fs.assemble(fs.Model(parts=[body], sea=sea))
    state, _ = fs.solve_static(system)
    T = about_z(np.radians(psi))
    got = np.concatenate([T.T @ state.x[0], T.T @ turned_by(state, system.initial_state())])
    u = np.zeros(6)
    u[:2] = speed * np.cos(np.radians(25.0)), speed * np.sin(np.radians(25.0))
    stiffness = db.hydrostatic_stiffness + weight_stiffness(RHO * db.volume[0], CM) + MOORING
    want = np.linalg.solve(stiffness, QUADRATIC @ (np.abs(u) * u))
    size = np.abs(want).reshape(2, 3).max(axis=1).repeat(3)
    # second-order terms of the rotations: half their square
    record(ROW_STATICS, f"static offset in a current, drawn at {psi:g} deg", np.abs((got - want) / size).max(), 1e-4)


# --- radiation memory -------------------------------------------------------------------------------


def test_memory_force_with_any_steps(record):
    kernel = RadiationKernel.from_database(smooth.database(), memory=30.0, grid=0.1)
    for step in (0.1, 0.03, 0.07, 0.15, 0.2):
        error = smooth.error(kernel, np.arange(0.0, 70.0, step))
        record(ROW_MEMORY, f"steps of {step:g} s, kernel grid 0.1 s: error over the peak", 100.0 * error, 0.2, "%")
    worst = 0.0
    for seed in (1, 2, 3):
        rng = np.random.Generator(np.random.PCG64(seed))
        worst = max(worst, smooth.error(kernel, np.concatenate([[0.0], np.cumsum(rng.uniform(0.01, 0.2, 600))])))
    record(ROW_MEMORY, "random steps of 0.01 to 0.2 s: error over the peak", 100.0 * worst, 0.2, "%")


def test_memory_force_is_of_second_order(record):
    fine = RadiationKernel.from_database(smooth.database(), memory=30.0, grid=0.025)
    errors = [smooth.error(fine, np.arange(0.0, 40.0, step)) for step in (0.8, 0.4, 0.2)]
    record(ROW_MEMORY, "order in the step", observed_order(errors), (1.9, 2.1))
    errors = []
    for grid in (0.4, 0.2, 0.1):
        kernel = RadiationKernel.from_database(smooth.database(), memory=30.0, grid=grid)
        errors.append(smooth.error(kernel, np.arange(0.0, 40.0, 0.7 * grid)))
    record(ROW_MEMORY, "order in grid and step together", observed_order(errors), (1.85, 2.15))


def contents(state: fs.State) -> bytes:
    """Every bit of a state, memories included."""
    arrays = [state.x, state.q, state.v, state.a, state.aux, state.lam]
    for histories in state.history.values():
        for history in histories:
            arrays += history.arrays().values()
    return b"".join(a.tobytes() for a in arrays) + np.array([state.t, state.step]).tobytes()


@pytest.mark.parametrize("size", [0.1, 0.037, 1.7])
def test_a_rejected_step_leaves_everything_bit_identical(db, record, size):
    """A tolerance of zero cannot be met; afterwards the run goes on as if nothing had been tried."""
    wave = fs.RegularWave(height=3.0, period=11.0)
    body = floater(db, linear_stiffness=MOORING, quadratic_damping=QUADRATIC)
    system = fs.assemble(fs.Model(parts=[body], sea=fs.Sea(depth=DEPTH, density=RHO, waves=wave, wave_ramp=0.0)))
    state = system.initial_state()
    run(system, state, fs.generalised_alpha(), 0.1, 200)
    twin, before = state.copy(), contents(state)
    stepper = fs.Stepper(system, tolerance=0.0)
    report = stepper.step(state, size)
    assert not report.converged
    same = contents(state) == before
    record(ROW_MEMORY, f"rejected step of {size:g} s: bits that changed", 0.0 if same else 1.0, "none", holds=same)
    stepper.tolerance = 1e-9
    other = fs.Stepper(system, tolerance=1e-9)
    for _ in range(30):
        assert stepper.step(state, 0.1).converged and other.step(twin, 0.1).converged
    assert contents(state) == contents(twin)
    assert contents(state) != before


def test_a_step_may_be_cut_where_time_was_rounded_another_way():
    """A run puts its clock on the output grid, k dt, which may lie one unit in the last place before the sum of the
    steps that the memory has seen. Cutting the step there looks at the memory at that very time."""
    system = fs.assemble(load("volturnus_s").build(elements=20))
    state, _ = fs.solve_static(system)
    state.v[2] = 0.1
    stepper = fs.Stepper(system)
    stepper.start(state, 0.1)
    earlier = 0
    for k in range(1, 120):
        assert stepper.step(state, 0.1).converged
        earlier += k * 0.1 < state.t
        state.t = k * 0.1
        assert stepper.step(state.copy(), 0.05).converged
    assert earlier > 5


# --- company ----------------------------------------------------------------------------------------


def released(db: fs.HydroDatabase, bodies: list[fs.Body], waves: Any, offsets: dict[str, np.ndarray],
             joints: Any = (), steps: int = 600) -> dict[str, np.ndarray]:  # fmt: skip
    """Poses (steps + 1, 7) of every body, released with offsets (6,) from the drawing position."""
    sea = fs.Sea(depth=DEPTH, density=RHO, waves=waves, wave_ramp=20.0)
    system = fs.assemble(fs.Model(parts=bodies, joints=joints, sea=sea))
    state = system.initial_state()
    for k, body in enumerate(bodies):
        offset = offsets[body.name]
        state.x[k] += offset[:3]
        state.q[k] = turn_quaternion(tuple(offset[3:]), tuple(state.q[k]))
    seen = run(system, state, fs.generalised_alpha(), 0.1, steps,
               lambda s: np.concatenate([s.x[:-1], s.q[:-1]], axis=1).copy(), tolerance=1e-9)  # fmt: skip
    return {body.name: np.array(seen)[:, k] for k, body in enumerate(bodies)}


def test_two_floaters_in_one_model_move_like_one_each(db, record):
    """Different headings, positions, damping and releases, in waves: nothing of one leaks into the other."""
    first = floater(db, "first", linear_stiffness=MOORING, quadratic_damping=QUADRATIC)
    second = floater(
        db, "second", cm=(0.3, 0.0, -2.0), linear_stiffness=2.0 * MOORING,
        position=(900.0, 400.0, 0.0), attitude_deg=(0.0, 0.0, 50.0),
    )  # fmt: skip
    offsets = {
        "first": np.array([3.0, 0.0, 1.0, 0.0, 0.03, 0.0]),
        "second": np.array([0.0, -2.0, 0.5, 0.02, 0.0, 0.1]),
    }
    waves = fs.WaveComponents(
        amplitude=(1.0, 0.6), period=(12.0, 8.5), heading_deg=(20.0, -40.0), phase_deg=(0.0, 80.0)
    )
    both = released(db, [first, second], waves, offsets)
    worst = max(
        np.abs(both[body.name] - released(db, [body], waves, offsets)[body.name]).max() for body in (first, second)
    )
    record(ROW_COMPANY, "two together against each alone, 60 s in waves: positions", worst, 1e-7, "m")
    assert np.ptp(both["second"][:, 1]) > 0.5


def halves(whole: fs.Body, arm: np.ndarray) -> list[fs.Body]:
    """A body as two: 60 % of the mass with the water, the rest dry with its reference point at `arm`."""
    cm, J, m = np.array(whole.center_of_mass), whole.inertia_tensor, whole.mass
    d = np.array([4.0, -3.0, 6.0])  # between the centres of mass
    ma, mb = 0.6 * m, 0.4 * m
    ca, cb = cm - 0.4 * d, cm + 0.6 * d
    rest = J - ma * mb / m * (d @ d * np.eye(3) - np.outer(d, d))

    K = 0.5 * rest
    half = (K[0, 0], K[1, 1], K[2, 2], K[0, 1], K[0, 2], K[1, 2])
    return [
        fs.Body(name="wet", mass=ma, center_of_mass=ca, inertia=half, hydro=whole.hydro, points={"joint": arm}),
        fs.Body(name="dry", mass=mb, center_of_mass=cb - arm, inertia=half, position=arm),
    ]


@pytest.mark.parametrize("arm", [(0.0, 0.0, 0.0), (20.0, -8.0, 12.0)])
def test_two_halves_welded_move_like_one_body(db, record, arm):
    """With both reference points at one place the discrete motion is the same, too: equal to solver precision.
    Elsewhere the weld is kept at the ends of the steps and the two answers differ by O(h^2)."""
    whole = floater(db, linear_stiffness=MOORING, quadratic_damping=QUADRATIC)
    offset = np.array([3.0, -2.0, 1.0, 0.03, 0.06, 0.05])
    arm = np.array(arm)
    parts = halves(whole, arm)
    R = exp(offset[3:])
    offsets = {"wet": offset, "dry": np.concatenate([offset[:3] + R @ arm - arm, offset[3:]])}
    waves = fs.RegularWave(height=4.0, period=10.0, heading_deg=20.0)
    weld = [fs.Weld(a="wet.joint", b="dry")]
    one = released(db, [whole], waves, {"floater": offset})["floater"]
    two = released(db, parts, waves, offsets, weld)["wet"]
    worst = np.abs(one - two).max()
    at, bar = ("25 m apart", 2e-3) if arm.any() else ("at one reference point", 1e-6)
    record(ROW_COMPANY, f"two welded halves against one body, {at}: positions over 60 s", worst, bar, "m")
