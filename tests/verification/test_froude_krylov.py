"""Nonlinear hydrostatics and Froude-Krylov forces on meshes, against closed forms and quadrature.

What is computed here to compare with uses no kernel of floatsim's.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hulls import box, cylinder, ellipsoid
from mechanics import observed_order
from scipy.integrate import quad
from scipy.special import j1, jv

import floatsim as fs
from floatsim.frames import matrix_from_angles, quaternion_from_matrix, set_matrix
from floatsim.hydro.froude_krylov import HullBatch
from floatsim.hydro.hull import Hull

RHO, G = 1025.0, 9.81
STATIC, WAVES = "hydrostatics of a mesh", "Froude-Krylov force on a mesh"


def model(hull: Hull, waves: Any = None, mass: float = 1e5, depth: float = 100.0, density: float = RHO, **body: Any):
    body.setdefault("inertia", (mass, mass, mass))
    one = fs.Body(name="float", mass=mass, hydro=hull, **body)
    return fs.Model(parts=[one], gravity=G, sea=fs.Sea(depth=depth, density=density, waves=waves, wave_ramp=0.0))


def loads(system: fs.System, position=(0.0, 0.0, 0.0), attitude_deg=(0.0, 0.0, 0.0), t: float = 0.0, still=False):
    """Force and moment (6,) on the only hull in this pose, and their negative derivative (6, 6)."""
    (batch,) = (b for b in system.batches if isinstance(b, HullBatch))
    w, state = system.work(), system.initial_state()
    state.t = t
    state.x[0] = position
    state.q[0] = quaternion_from_matrix(matrix_from_angles(*np.radians(attitude_deg)))
    system.load(w, state)
    w.still = still
    system.begin(w, state, t)
    w.c[:4] = 0.0, 0.0, 1.0, 0.0
    w.A.fill(0.0)
    w.r.fill(0.0)
    batch.add(w)
    dofs = batch.dofs(system.n_point)[0][0]
    return -w.r[dofs], w.A[batch._slots[0]].reshape(6, 6).copy()


def attitude(state: fs.State) -> np.ndarray:
    R = np.zeros((1, 3, 3))
    set_matrix(R, 0, tuple(state.q[0]))
    return R[0]


# --- still water ------------------------------------------------------------------------------------


def test_box_in_closed_form(record):
    """Draught 1.5 m, the reference point off its middle and above the water."""
    ref, middle = np.array([0.7, -0.4, 0.3]), np.array([0.0, 0.0, 0.0])
    hull = Hull(mesh=box(6.0, 4.0, 3.0), mesh_origin=middle - ref)
    still = hull.hydrostatics(ref, density=RHO, gravity=G)
    A, V = 24.0, 36.0
    zb = -0.75 - ref[2]
    C = np.zeros((6, 6))
    x, y = -ref[0], -ref[1]
    C[2, 2:5] = C[2:5, 2] = A, A * y, -A * x
    C[3, 3] = A * (16.0 / 12.0 + y * y) + V * zb
    C[4, 4] = A * (36.0 / 12.0 + x * x) + V * zb
    C[3, 4] = C[4, 3] = -A * x * y
    C[3, 5], C[4, 5] = -V * x, -V * y
    np.testing.assert_allclose(still.centre_of_buoyancy, (0.0, 0.0, -0.75), atol=1e-12)
    np.testing.assert_allclose(still.waterplane_centre, (0.0, 0.0), atol=1e-12)
    record(STATIC, "box: volume, relative error", abs(still.volume / V - 1.0), 1e-12)
    record(STATIC, "box: stiffness, error over its largest entry",
           np.abs(still.stiffness - RHO * G * C).max() / np.abs(RHO * G * C).max(), 1e-12)  # fmt: skip


def test_cone_cylinder_and_cap(record):
    n, r = 24, 3.0
    polygon = 0.5 * n * r * r * np.sin(2.0 * np.pi / n)
    cone = Hull(mesh=cylinder(r, 0.0, 1.0, n, tip=-4.0)).hydrostatics((0.0, 0.0, 1.5))
    assert cone.volume == pytest.approx(polygon * 4.0 / 3.0 * (2.5 / 4.0) ** 3, rel=1e-12)
    assert cone.centre_of_buoyancy == pytest.approx([0.0, 0.0, -2.5 / 4.0], abs=1e-12)
    assert cone.waterplane_area == pytest.approx(polygon * (2.5 / 4.0) ** 2, rel=1e-12)
    tall = Hull(mesh=cylinder(r, -5.0, 5.0, n, 7)).hydrostatics((1.0, 2.0, 0.5))
    assert tall.volume == pytest.approx(polygon * 4.5, rel=1e-12)
    assert tall.centre_of_buoyancy == pytest.approx([1.0, 2.0, -2.25], rel=1e-12)
    second = polygon * r * r * (2.0 + np.cos(2.0 * np.pi / n)) / 12.0  # of a regular polygon
    assert tall.waterplane_inertia == pytest.approx(second * np.eye(2), abs=1e-9)
    errors = []
    for m in (8, 16, 32):
        cap = Hull(mesh=ellipsoid(r, r, r, m)).hydrostatics((0.0, 0.0, 0.8)).volume
        errors.append(1.0 - cap / (np.pi * 2.2**2 * (3.0 * r - 2.2) / 3.0))
    record(STATIC, "spherical cap: volume error of 8192 triangles", errors[-1], 0.002)
    record(STATIC, "spherical cap: order of the error", observed_order(errors), (1.9, 2.2))


@pytest.mark.parametrize("mesh", [box(4.0, 3.0, 2.0, (3, 2, 2)), ellipsoid(2.0, 1.5, 1.0, 4), cylinder(1, -2, 1, 7, 3)])
def test_kernel_is_the_polyhedron(mesh, record):
    """Loads and tangent in any pose against the surface integrals of `hydrostatics`, which do without the kernel."""
    hull = Hull(mesh=mesh, mesh_origin=(0.3, -0.2, 0.1))
    system = fs.assemble(model(hull))
    worst = 0.0
    rng = np.random.default_rng(2)
    scale = RHO * G * 20.0
    for _ in range(20):
        position, angles = rng.uniform(-1.2, 1.2, 3), rng.uniform(-180.0, 180.0, 3)
        f, K = loads(system, position, angles)
        still = hull.hydrostatics(position, angles, density=RHO, gravity=G)
        F = np.array([0.0, 0.0, RHO * G * still.volume])
        M = np.cross(still.centre_of_buoyancy - position, F)
        # the wrench turns with the body in the tangent; in world axes a yaw leaves F alone and turns M: C has that
        worst = max(worst, np.abs(f - np.concatenate([F, M])).max() / scale, np.abs(K - still.stiffness).max() / scale)
    record(STATIC, "wrench and tangent in any pose, error over rho g times 20 m3", worst, 1e-12)


def test_tilted_cube(record):
    mesh = Hull(mesh=box(5.0, 5.0, 5.0))
    mass = 95906.0
    J = (mass * 25.0 / 6.0,) * 3
    check = "floating cube of 5 m, 95.906 t, rho 1023, by nonlinear statics"
    system = fs.assemble(model(mesh, mass=mass, inertia=J, density=1023.0, center_of_mass=(0.0, 0.0, -1.0)))
    state, _ = fs.solve_static(system)
    record(check, "draught", 2.5 - state.x[0, 2], (3.749, 3.751), "m")
    for start in (-1.0, 4.0, -20.0):
        body = dict(center_of_mass=(0.5, 0.5, -1.5), position=(0.0, 0.0, start))
        system = fs.assemble(model(mesh, mass=mass, inertia=J, density=1023.0, **body))
        state, _ = fs.solve_static(system)
        tilt = np.degrees(np.arccos(attitude(state)[2, 2]))
        where = f", drawn at z = {start:g} m"
        record(check, f"tilt with the centre of mass at (0.5, 0.5, -1.5) m{where}", tilt, (25.4385, 25.5385), "deg")
        record(check, f"height of its centre{where}", state.x[0, 2], (-1.13386, -1.13186), "m")


def test_statics_see_no_waves():
    hull, wave = Hull(mesh=box(5.0, 5.0, 5.0, (4, 4, 4))), fs.RegularWave(height=2.0, period=6.0)
    state, _ = fs.solve_static(fs.assemble(model(hull, wave, center_of_mass=(0.0, 0.0, -1.0))))
    assert state.x[0, 2] == pytest.approx(2.5 - 1e5 / RHO / 25.0, abs=1e-6)


def cap(z: np.ndarray, r: float) -> np.ndarray:
    """Volume of a sphere of radius r, its centre at z, below z = 0."""
    h = np.clip(r - np.asarray(z), 0.0, 2.0 * r)
    return np.pi * h**2 * (3.0 * r - h) / 3.0


def test_sphere_dropped_from_half_its_diameter(record):
    """Buoyancy of the mesh against the spherical cap over the whole motion, which leaves the water and dives."""
    r, rho = 0.15, 998.2
    half = 2.0 / 3.0 * np.pi * r**3
    mass, errors = rho * half, []
    check = "sphere of 0.3 m dropped from half its diameter"
    for n in (6, 12, 25, 50):
        system = fs.assemble(model(Hull(mesh=ellipsoid(r, r, r, n)), mass=mass, density=rho, depth=0.9,
                                   inertia=(0.4 * mass * r * r,) * 3, center_of_mass=(0.0, 0.0, -0.0348)))  # fmt: skip
        start = system.initial_state()
        start.x[0, 2] = r
        duration = 1.6 if n == 50 else 0.8
        run = fs.simulate(system, duration, 0.01, state=start)
        assert run.status == "done", run.failure
        z = run.series("float_position")[:, 2]
        off = run.series("float_hull_force")[:, 2] / (rho * G) - cap(z, r)
        assert np.ptp(z) > 1.9 * r
        np.testing.assert_allclose(run.series("float_displaced_volume") * rho * G, run.series("float_hull_force")[:, 2],
                                   atol=1e-9 * mass * G)  # fmt: skip
        errors.append(np.abs(off).max() / half)
    record(check, "error of the buoyancy of 20000 triangles over the half-submerged displacement", errors[-1], 0.002)
    order = np.polyfit(np.log([6, 12, 25, 50]), np.log(errors), 1)[0]
    record(check, "order of the error over 288, 1152, 5000 and 20000 triangles", -order, (1.9, 2.2))


def energy(hull: Hull, states: list[Any], mass: float, J: float) -> np.ndarray:
    """Kinetic plus weight plus buoyancy, the latter rho g V |z_B| (what it takes to push the hull down)."""
    out = []
    for s in states:
        R = attitude(s)
        angles = np.degrees([np.arctan2(R[2, 1], R[2, 2]), np.arcsin(-R[2, 0]), np.arctan2(R[1, 0], R[0, 0])])
        still = hull.hydrostatics(s.x[0], angles, density=RHO, gravity=G)
        kinetic = 0.5 * mass * s.v[:3] @ s.v[:3] + 0.5 * J * s.v[6:9] @ s.v[6:9]
        out.append(kinetic + mass * G * s.x[0, 2] - RHO * G * still.volume * still.centre_of_buoyancy[2])
    return np.array(out)


def swing(hull: Hull, mass: float, z: float, h: float, duration: float) -> tuple[np.ndarray, list[int]]:
    """Energy of a free hull in still water, released tilted at z, undamped steps of h; iterations of the steps."""
    J = 0.6 * mass
    system = fs.assemble(model(hull, mass=mass, inertia=(J, J, J)))
    state = system.initial_state()
    state.x[0, 2] = z
    state.q[0] = quaternion_from_matrix(matrix_from_angles(0.4, 0.3, 0.2))
    stepper = fs.Stepper(system, fs.newmark(0.25, 0.5), 1e-10)
    stepper.start(state, h)
    states, iterations = [state.copy()], []
    for _ in range(round(duration / h)):
        report = stepper.step(state, h)
        assert report.converged, report
        iterations.append(report.iterations)
        states.append(state.copy())
    return energy(hull, states, mass, J), iterations


def test_energy_in_still_water(record):
    """The drift of the energy is the integrator's alone: it falls with h^2."""
    hull = Hull(mesh=box(3.0, 2.0, 1.0, (3, 2, 1)))
    drift = []
    for h in (0.02, 0.01, 0.005):
        E, _ = swing(hull, 3.0 * RHO, 0.3, h, 6.0)
        drift.append(np.abs(E - E[0]).max() / (3.0 * RHO * G * 0.3))
    check = "energy of a barge heaving, rolling and pitching freely in still water"
    record(check, "largest drift over m g times 0.3 m, step 0.005 s", drift[-1], 1e-4)
    record(check, "order of the drift", observed_order(drift), (1.7, 2.3))


@pytest.mark.parametrize("z", [4.0, -12.0])
def test_out_of_the_water_and_under_it(z, record):
    """A light hull dropped from the air, and let go far below: it dives and jumps, and keeps its energy."""
    hull = Hull(mesh=ellipsoid(2.0, 1.5, 1.0, 8))
    E, iterations = swing(hull, 3000.0, z, 0.005, 6.0)
    where = "dropped from 4 m" if z > 0.0 else "let go 12 m under water"
    check = "light ellipsoid that leaves the water and dives"
    record(check, f"{where}: largest drift of the energy over m g times 10 m", np.abs(E - E[0]).max() / (3e4 * G), 1e-3)
    record(check, f"{where}: most Newton iterations of a step", max(iterations), 8)


# --- waves ------------------------------------------------------------------------------------------


def amplitudes(hull: Hull, period: float, heading_deg: float = 0.0, depth: float = 500.0, a: float = 1e-5,
               position=(0.0, 0.0, 0.0)) -> np.ndarray:  # fmt: skip
    """X (6,) of F = Re X a e^{i w t} over rho g, for a wave so low that the surface is its mean."""
    wave = fs.RegularWave(height=2.0 * a, period=period, heading_deg=heading_deg)
    system = fs.assemble(model(hull, wave, depth=depth))
    still = loads(system, position, still=True)[0]
    cosine, sine = (loads(system, position, t=t)[0] - still for t in (0.0, 0.25 * period))
    return (cosine - 1j * sine) / (RHO * G * a)


def off(found: np.ndarray, exact: np.ndarray, lever: float) -> float:
    """Largest error of a row of amplitudes over the largest force, and that times a lever [m]."""
    scale = np.abs(exact[:3]).max() * np.repeat([1.0, lever], 3)
    return float(np.max(np.abs(found - exact) / scale))


def wall(k: float, draught: float, depth: float) -> tuple[float, float]:
    """int f dz and int z f dz over the draught, f = cosh k(z + d)/cosh(k d)."""

    def f(z: float) -> float:
        return np.exp(k * z) * (1.0 + np.exp(-2.0 * k * (z + depth))) / (1.0 + np.exp(-2.0 * k * depth))

    return quad(f, -draught, 0.0)[0], quad(lambda z: z * f(z), -draught, 0.0)[0]


def number(period: float, depth: float) -> float:
    """k of w^2 = g k tanh k d, by bisection."""
    from scipy.optimize import brentq

    w = 2.0 * np.pi / period
    return brentq(lambda k: G * k * np.tanh(k * depth) - w * w, 1e-8, 1e3, xtol=1e-14)


@pytest.mark.parametrize(("period", "depth"), [(20.0, 500.0), (20.0, 15.0), (6.0, 500.0), (3.5, 12.0)])
def test_box_in_small_waves(period, depth, record):
    L, B, T = 8.0, 5.0, 3.0
    hull = Hull(mesh=box(L, B, 6.0, (40, 2, 48)))
    k = number(period, depth)
    force, lever = wall(k, T, depth)
    low = np.cosh(k * (depth - T)) / np.cosh(k * depth) if k * depth < 300.0 else np.exp(-k * T)
    s, c = np.sin(0.5 * k * L), np.cos(0.5 * k * L)
    X = np.zeros(6, dtype=complex)
    X[0] = 2j * B * force * s
    X[2] = 2.0 * B * low * s / k
    # bottom: - int x p dA, and the sides' pressure at their heights
    X[4] = 1j * (2.0 * B * lever * s + low * B * 2.0 * (s / k - 0.5 * L * c) / k)
    worst = off(amplitudes(hull, period, 0.0, depth), X, T)
    record(WAVES, f"box, {period:g} s in {depth:g} m: error over the largest (moments by the draught)", worst, 0.001)


@pytest.mark.parametrize("heading", [0.0, 37.0])
@pytest.mark.parametrize("period", [15.0, 5.0, 3.0])
def test_cylinder_in_small_waves(period, heading, record):
    """Vertical circular cylinder in deep water, its axis away from the origin."""
    r, T = 4.0, 5.0
    k = number(period, 500.0)
    hull = Hull(mesh=polar(r, T, 90, 24))
    force, lever = wall(k, T, 500.0)
    b = np.radians(heading)
    sway = 2j * np.pi * r * j1(k * r)
    heave = 2.0 * np.pi * r * np.exp(-k * T) * j1(k * r) / k
    turn = sway * lever + 2j * np.pi * r * r * np.exp(-k * T) * jv(2, k * r) / k
    X = np.array([sway * force * np.cos(b), sway * force * np.sin(b), heave, -turn * np.sin(b), turn * np.cos(b), 0.0])
    x, y = 3.0, -2.0
    X = X * np.exp(-1j * k * (x * np.cos(b) + y * np.sin(b)))
    found = amplitudes(hull, period, heading, position=(x, y, 0.0))
    what = f"cylinder, {period:g} s towards {heading:g} deg: error over the largest (moments by the draught)"
    record(WAVES, what, off(found, X, T), 0.005)


@pytest.mark.parametrize("up", [0.0, 0.0625, 0.125, 0.1875])
def test_small_waves_between_rows_of_vertices(up, record):
    """The cylinder lifted, so that the water is in the triangles between two rows 0.25 m apart, their upper corners far
    above a crest of 0.01 mm: where these triangles are cut follows the wave as well."""
    r, T, period = 4.0, 5.0 - up, 5.0
    k = number(period, 500.0)
    force, lever = wall(k, T, 500.0)
    sway = 2j * np.pi * r * j1(k * r)
    turn = sway * lever + 2j * np.pi * r * r * np.exp(-k * T) * jv(2, k * r) / k  # about the water's surface
    heave = 2.0 * np.pi * r * np.exp(-k * T) * j1(k * r) / k
    X = np.array([sway * force, 0.0, heave, 0.0, turn - up * sway * force, 0.0])
    found = amplitudes(Hull(mesh=polar(r, 5.0, 90, 24)), period, position=(0.0, 0.0, up))
    what = f"cylinder {up:g} m over a row of vertices: error over the largest (moments by the draught)"
    record(WAVES, what, off(found, X, T), 0.001)


def test_surge_force_of_low_waves_does_not_feel_small_motions(record):
    """To first order the horizontal force is that on the hull at rest: a heave and a pitch that lift vertices of the
    waterline over the crests, or drown them, change it in the second order only."""
    hull, a, period = Hull(mesh=cylinder(3.0, -20.0, 5.0, 24, 25)), 1e-5, 8.0
    system = fs.assemble(model(hull, fs.RegularWave(height=2.0 * a, period=period)))
    times, worst = np.linspace(0.0, period, 8, endpoint=False), 0.0
    rest = np.array([loads(system, t=t)[0][0] for t in times])
    for heave, pitch in ((1.5 * a, 0.0), (-1.5 * a, 0.0), (0.0, a), (0.5 * a, -a)):
        moved = np.array([loads(system, (0.0, 0.0, heave), (0.0, np.degrees(pitch), 0.0), t)[0][0] for t in times])
        worst = max(worst, float(np.abs(moved - rest).max() / np.abs(rest).max()))
    record(WAVES, "cylinder: change of surge force by motions of the waves' size", worst, 1e-4)


def polar(r: float, T: float, n: int, rings: int) -> tuple[np.ndarray, np.ndarray]:
    """Cylinder of radius r from z = -T to 5 whose flat bottom is divided in rings."""
    v, f = cylinder(r, -T, 5.0, n, 40)
    f = f[(f != len(v) - 2).all(axis=1)]
    phi = 2.0 * np.pi * np.arange(n) / n
    disc = [[q * np.cos(p), q * np.sin(p), -T] for q in r * np.arange(1, rings + 1) / rings for p in phi]
    first, more = len(v), []
    for i in range(n):
        j = (i + 1) % n
        more.append([len(v) - 2, first + j, first + i])
        for m in range(rings - 1):
            a, b, c, d = (first + m * n + i, first + m * n + j, first + (m + 1) * n + j, first + (m + 1) * n + i)
            more += [[a, b, c], [a, c, d]]
    return np.vstack([v, disc]), np.vstack([f, more])


def test_high_wave_on_a_wall(record):
    """A box in a steep wave: pressure with Wheeler's stretching up to the surface, by quadrature; second order."""
    L, B, T, depth, a, period = 10.0, 4.0, 6.0, 20.0, 1.5, 7.0
    k = number(period, depth)
    wave = fs.RegularWave(height=2.0 * a, period=period)
    w = 2.0 * np.pi / period

    def pressure(x: float, z: float, t: float) -> float:
        eta = a * np.cos(w * t - k * x)
        z1 = depth * (z - eta) / (depth + eta)
        return -z + a * np.cosh(k * (z1 + depth)) / np.cosh(k * depth) * np.cos(w * t - k * x)

    def exact(t: float) -> np.ndarray:
        push = 0.0
        for side in (-1.0, 1.0):
            x = 0.5 * side * L
            push -= side * B * quad(lambda z, x=x: pressure(x, z, t), -T, a * np.cos(w * t - k * x))[0]
        return np.array([push, B * quad(lambda x: pressure(x, -T, t), -0.5 * L, 0.5 * L)[0]])

    times = np.linspace(0.0, period, 9)[:-1]
    wanted = np.array([exact(t) for t in times])
    errors = []
    for n in (4, 8, 16):  # coarser ones have the whole surface in one row of panels
        system = fs.assemble(model(Hull(mesh=box(L, B, 12.0, (5 * n, n, 6 * n))), wave, depth=depth))
        found = np.array([loads(system, t=t)[0][[0, 2]] for t in times]) / (RHO * G)
        errors.append(np.abs(found - wanted).max() / np.abs(wanted[:, 0]).max())
    record(WAVES, "box in a wave of 3 m, 7 s in 20 m: error of the finest over the largest surge", errors[-1], 1e-4)
    record(WAVES, "box in a wave of 3 m: order of the error", observed_order(errors), (1.9, 2.1))


def test_pressure_of_many_waves_vanishes_at_the_surface():
    """Short-crested: a plate's vertices at the surface have no pressure, those above none either, below more."""
    sea = fs.IrregularWaves(spectrum=fs.Jonswap(hs=3.0, tp=8.0), seed=2, components=50, spreading=4.0, duration=100.0)
    system = fs.assemble(model(Hull(mesh=box(20.0, 20.0, 8.0, (6, 6, 20))), sea, depth=40.0))
    loads(system, t=3.0)
    (batch,) = (b for b in system.batches if isinstance(b, HullBatch))
    V, S = batch.hulls[0].V, batch.hulls[0].S
    eta = system.waves.elevation(V[:, 0], V[:, 1], 3.0)
    np.testing.assert_allclose(S[:, 0], V[:, 2] - eta, atol=1e-6)
    above = S[:, 0] >= 0.0
    np.testing.assert_allclose(S[above, 1], -RHO * G * S[above, 0], atol=1e-2)
    # wave by wave
    k, a, phase = system.waves.wave_number, system.waves.amplitude, system.waves.phase
    i = np.flatnonzero(~above)[::7]
    z = 40.0 * S[i, 0] / (40.0 + eta[i])
    along = V[i, 0, None] * np.cos(system.waves.heading) + V[i, 1, None] * np.sin(system.waves.heading)
    p = np.cosh(k * (z[:, None] + 40.0)) / np.cosh(k * 40.0) * a * np.cos(system.waves.omega * 3.0 - k * along + phase)
    np.testing.assert_allclose(S[i, 1], RHO * G * (p.sum(axis=1) - V[i, 2]), atol=1e-5 * RHO * G)


def test_invariance(record):
    """Body, waves and current frame turned about z and moved: the loads turn with them."""
    hull = Hull(mesh=ellipsoid(3.0, 2.0, 1.5, 6), mesh_origin=(0.4, 0.1, -0.2))
    period, psi, move = 5.0, 40.0, np.array([12.0, -7.0, 0.0])
    turn = matrix_from_angles(0.0, 0.0, np.radians(psi))
    k = number(period, 100.0)
    shift = np.degrees(k * (move @ turn[:, 0]))
    here = fs.assemble(model(hull, fs.RegularWave(height=1.0, period=period)))
    there = fs.assemble(model(hull, fs.RegularWave(height=1.0, period=period, heading_deg=psi, phase_deg=shift)))
    place = np.array([0.3, 0.2, 0.1])
    worst = 0.0
    for t in (0.0, 1.3, 2.9):
        f, K = loads(here, place, (10.0, -5.0, 0.0), t)
        g, L = loads(there, turn @ place + move, (10.0, -5.0, psi), t)
        both = np.kron(np.eye(2), turn)
        worst = max(worst, np.abs(both @ f - g).max() / np.abs(f).max())
        worst = max(worst, np.abs(both @ K @ both.T - L).max() / np.abs(K).max())
    record("invariance: a hull in waves under translation and rotation about z", "loads and tangent, error over the "
           "largest", worst, 1e-6)  # fmt: skip


def test_gradients_of_the_field(record):
    """The tangent with which a step begins against differences of loads whose waves are evaluated anew each time."""
    sea = fs.IrregularWaves(spectrum=fs.Jonswap(hs=2.0, tp=5.0), seed=3, components=40, spreading=5.0, duration=100.0)
    hull = Hull(mesh=ellipsoid(3.0, 2.0, 1.5, 8), mesh_origin=(0.4, 0.1, -0.2))
    system = fs.assemble(model(hull, sea, depth=12.0))
    place, angles, t, h = np.array([1.0, 2.0, 0.3]), (12.0, -8.0, 20.0), 4.0, 2e-3
    _, K = loads(system, place, angles, t)
    R, worst = matrix_from_angles(*np.radians(angles)), 0.0
    for j in range(6):
        ends = []
        for sign in (1.0, -1.0):
            step = np.eye(6)[j] * sign * h
            turned = matrix_from_angles(*step[3:]) @ R  # about one axis
            turned = np.degrees([np.arctan2(turned[2, 1], turned[2, 2]), np.arcsin(-turned[2, 0]),
                                 np.arctan2(turned[1, 0], turned[0, 0])])  # fmt: skip
            ends.append(loads(system, place + step[:3], turned, t)[0])
        near = (ends[1] - ends[0]) / (2.0 * h)
        worst = max(worst, np.abs(near - K[:, j]).max() / np.abs(K).max())
    what = "tangent against differences of loads whose waves are evaluated anew, over its largest entry"
    record(WAVES, what, worst, 1e-4)


# WAMIT's mean-surface Froude-Krylov amplitudes over rho g (file wamit_ellipsoid.3fk of WEC-Sim's nonlinear-hydro
# example, Apache-2.0): period [s], surge, heave and pitch about the origin, phases 90, 0 and 90 degrees. The file's
# ellipsoid, by its own volume (76.214 m3), waterplane (63.575 m2) and centre of buoyancy (-0.6745 m), has half axes of
# 4.5, 4.5 and 1.8 m and stands half wet in deep water; the example's STL file has 5, 5 and 2.5 m.
WAMIT = (
    (20.944, 0.6947791, 62.86676, 2.454821),
    (10.472, 2.721308, 60.63754, 9.544042),
    (6.98132, 5.873214, 56.61230, 20.36744),
    (5.23599, 9.710525, 50.46358, 33.22551),
    (4.18879, 13.47005, 42.01661, 45.49534),
    (3.49066, 16.06317, 31.51928, 53.80632),
    (2.99200, 16.28572, 19.89347, 54.78789),
)
ELLIPSOID = "ellipsoid of WEC-Sim's example against WAMIT"


def test_larger_ellipsoid_against_wamit(record):
    """The example's own hull, of its STL file, half wet: as the head of wamit_ellipsoid.out has it, about z = -2 m."""
    hull = Hull(mesh=ellipsoid(5.0, 5.0, 2.5, 25), mesh_origin=(0.0, 0.0, 2.0))
    still = hull.hydrostatics((0.0, 0.0, -2.0), density=1.0, gravity=1.0)
    lever = still.centre_of_buoyancy[2] + 2.0
    for name, found, wanted in (
        ("volume", still.volume, 130.652), ("centre of buoyancy over z = -2 m", lever, 1.063039),
        ("stiffness 33", still.stiffness[2, 2], 78.520), ("stiffness 44", still.stiffness[3, 3], 629.26),
    ):  # fmt: skip
        record(ELLIPSOID, f"half axes 5, 5, 2.5 m: {name}, relative difference", abs(found / wanted - 1.0), 0.01)


def test_ellipsoid_against_wamit(record):
    hull = Hull(mesh=ellipsoid(4.5, 4.5, 1.8, 25))
    still = hull.hydrostatics(density=1.0, gravity=1.0)
    record(ELLIPSOID, "volume of 5000 triangles, relative difference", abs(still.volume / 76.2136 - 1.0), 0.01)
    centre = abs(still.centre_of_buoyancy[2] / -0.674509 - 1.0)
    record(ELLIPSOID, "centre of buoyancy, relative difference", centre, 0.01)
    for i, wanted in ((2, 63.57515), (3, 270.0116), (4, 270.0117)):
        off = abs(still.stiffness[i, i] / wanted - 1.0)
        record(ELLIPSOID, f"stiffness {i + 1}{i + 1}, relative difference", off, 0.01)
    sizes, angles = [], []
    for period, *wanted in WAMIT:
        X = amplitudes(hull, period)[[0, 2, 4]]
        sizes.append(np.abs(np.abs(X) / wanted - 1.0))
        angles.append(np.abs(np.degrees(np.angle(X)) - (90.0, 0.0, 90.0)))
    for i, name in enumerate(("surge", "heave", "pitch")):
        largest = np.max(np.array(sizes)[:, i])
        record(ELLIPSOID, f"mean-surface Froude-Krylov, {name}, 3 to 21 s: largest difference", largest, 0.02)
        record(ELLIPSOID, f"mean-surface Froude-Krylov, {name}: phase", np.max(np.array(angles)[:, i]), 3.0, "deg")


def test_small_wave_is_linear(record):
    """The ellipsoid held fast in a wave of 0.05 m: Froude-Krylov force against that over the mean surface."""
    hull, period = Hull(mesh=ellipsoid(4.5, 4.5, 1.8, 25)), 6.0
    X = amplitudes(hull, period)
    system = fs.assemble(model(hull, fs.RegularWave(height=0.05, period=period), depth=500.0))
    still = loads(system, still=True)[0]
    times = np.linspace(0.0, period, 25)
    found = np.array([loads(system, t=t)[0] - still for t in times])[:, [0, 2, 4]]
    linear = RHO * G * 0.025 * (X[[0, 2, 4]] * np.exp(2j * np.pi * times[:, None] / period)).real
    worst = np.max(np.abs(found - linear) / np.abs(linear).max(axis=0))
    record("ellipsoid in a wave of 0.05 m, 6 s", "Froude-Krylov force against linear, over its amplitude", worst, 0.01)


def test_motion_in_a_small_wave(record):
    """A barge alone on hydrostatics and Froude-Krylov in a long low wave follows the linear oscillator.

    Heave, undamped: zeta = X a/(C - w^2 m); released on the particular solution, so that no transient has to die.
    """
    L, T, period, a = 6.0, 2.0, 9.0, 0.01
    hull = Hull(mesh=box(L, L, 4.0, (6, 6, 8)))
    mass = RHO * L * L * T
    w, k = 2.0 * np.pi / period, number(period, 500.0)
    C = RHO * G * L * L
    X = RHO * G * L * 2.0 * np.sin(0.5 * k * L) / k * np.exp(-k * T)
    z = X * a / (C - w * w * mass)
    wave = fs.RegularWave(height=2.0 * a, period=period)
    system = fs.assemble(model(hull, wave, mass=mass, depth=500.0, inertia=(mass * 6.0,) * 3,
                               center_of_mass=(0.0, 0.0, -1.0)))  # fmt: skip
    start = system.initial_state()
    start.x[0, 2] = z
    run = fs.simulate(system, 2.0 * period, 0.05, state=start)
    found = run.series("float_position")[:, 2]
    worst = np.abs(found - z * np.cos(w * run.time)).max() / z
    record("barge on hydrostatics and Froude-Krylov alone", "heave in a wave of 0.02 m against the oscillator", worst,
           0.02)  # fmt: skip


def test_steep_irregular_sea_does_not_stop_it(record):
    """A light hull that waves throw out of the water: every step converges, within eight iterations."""
    sea = fs.IrregularWaves(spectrum=fs.Jonswap(hs=4.0, tp=6.0), seed=4, components=60, duration=60.0)
    system = fs.assemble(model(Hull(mesh=ellipsoid(2.0, 1.5, 1.0, 8)), sea, mass=2000.0))
    state = system.initial_state()
    stepper = fs.Stepper(system)
    stepper.start(state, 0.05)
    most = 0
    for _ in range(1000):
        report = stepper.step(state, 0.05)
        assert report.converged, (state.t, report)
        most = max(most, report.iterations)
    record("light ellipsoid that leaves the water and dives", "most Newton iterations in waves of Hs 4 m", most, 8)
