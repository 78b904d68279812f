"""Members, discs and point buoys against closed forms: waves, currents, hydrostatics, free motions."""

import numpy as np
import pytest
from mechanics import free_unknowns, matrix, natural_frequencies, residual
from scipy.integrate import quad
from scipy.optimize import brentq, fsolve
from scipy.spatial.transform import Rotation

import floatsim as fs
from floatsim.frames import matrix_from_angles, quaternion_from_matrix
from floatsim.parts.member import FLAT, Disc, Member, MemberBatch, wetness
from floatsim.parts.point_buoy import PointBuoy
from floatsim.study.sheet import body_sheets

RHO, G = 1025.0, 9.81
STILL = fs.Sea(depth=200.0)

ROW_STATICS = "hydrostatics of members against closed forms"
ROW_WAVES = "Morison loads in regular waves against closed forms"
ROW_MOTION = "free motion of members and buoys against closed forms"


def body(*loads, position=(0.0, 0.0, 0.0), attitude_deg=(0.0, 0.0, 0.0), mass=1e4, name="hull", **more):
    values = dict(inertia=(8e4, 8e4, 8e4)) | more
    return fs.Body(name=name, mass=mass, position=position, attitude_deg=attitude_deg, hydro=list(loads), **values)


def evaluated(hull, sea=STILL, t=0.0, still=False, speed=None):
    """(force, moment) of the members on a body at its drawing position at time t, and the system with its scratch."""
    system = fs.assemble(fs.Model(parts=[hull], sea=sea, gravity=G))
    state = system.initial_state()
    state.t = t
    if speed is not None:
        state.v[:3] = speed
    w = system.work()
    system.load(w, state)
    w.still = still
    system.begin(w, state, t)
    system.evaluate(w)
    batch = next(b for b in system.batches if isinstance(b, MemberBatch))
    return batch.load[0, :3].copy(), batch.load[0, 3:6].copy(), system, w


def wave(height, period, sea_depth=200.0, **more):
    return fs.Sea(depth=sea_depth, waves=fs.RegularWave(height=height, period=period), wave_ramp=0.0, **more)


def wave_number(omega, depth):
    return brentq(lambda k: G * k * np.tanh(k * depth) - omega**2, 1e-6, 10.0, xtol=1e-15)


# -- hydrostatics ----------------------------------------------------------------------------------


@pytest.mark.parametrize("angles", [(0, 0, 0), (90, 0, 0), (20, -50, 30), (0, 90, 10), (180, 0, 0)])
def test_submerged_member_is_lifted_at_its_centroid(angles, record):
    """rho g V upwards at the middle of a cylinder, whatever its attitude; drawn far from its reference point."""
    a, b = np.array([1.0, -2.0, 3.0]), np.array([2.0, 4.0, -1.0])
    force, moment, _, _ = evaluated(body(Member(a=a, b=b, diameter=1.4), position=(3, 4, -50), attitude_deg=angles))
    lift = RHO * G * np.pi * 0.49 * np.linalg.norm(b - a)
    arm = matrix_from_angles(*np.radians(angles)) @ (0.5 * (a + b))
    error = np.abs(force - [0, 0, lift]).max() / lift + np.abs(moment - np.cross(arm, [0, 0, lift])).max() / lift
    record(ROW_STATICS, f"submerged cylinder at {angles} deg: lift and its place", error, 1e-12)


def test_submerged_taper(record):
    """A frustum: its volume is exact, its centroid to second order in the strip length."""
    errors = []
    for n in (5, 10, 20):
        member = Member(a=(0, 0, 0), b=(6, 0, 0), diameter=(3.0, 1.0), strips=n)
        force, moment, _, _ = evaluated(body(member, position=(0, 0, -20)))
        volume = quad(lambda x: np.pi / 4 * (3 - x / 3) ** 2, 0, 6)[0]
        centre = quad(lambda x: x * np.pi / 4 * (3 - x / 3) ** 2, 0, 6)[0] / volume
        assert force[2] == pytest.approx(RHO * G * volume, rel=1e-12)
        errors.append(abs(-moment[1] / force[2] / centre - 1.0))
    record(ROW_STATICS, "submerged frustum, 20 strips: place of the lift", errors[-1], 2e-3)
    assert errors[0] / errors[2] == pytest.approx(16.0, rel=0.05)


def wet_part(z0, tilt, r, length):
    """(volume, first moments about the middle: across and along the axis) of a cylinder under z = 0 by quadrature.

    z0: height of the middle; tilt: of the axis from the vertical, in the xz plane."""
    s, c = np.sin(tilt), np.cos(tilt)

    def over_disc(xi, weight):
        # the chord at the place xi across, in the direction (c, 0, -s), is wet where z0 - xi s + zeta c < 0
        chord = 2.0 * np.sqrt(max(r * r - xi * xi, 0.0))
        top = np.clip((xi * s - z0) / c, -0.5 * length, 0.5 * length)
        if weight == "zeta":
            return chord * 0.5 * (top**2 - 0.25 * length**2)
        return chord * (top + 0.5 * length) * (xi if weight == "xi" else 1.0)

    kinks = [y for y in ((z0 + 0.5 * length * c) / s, (z0 - 0.5 * length * c) / s) if abs(y) < r]
    return [quad(over_disc, -r, r, args=(which,), points=kinks or None, epsabs=1e-12, limit=400)[0]
            for which in ("one", "xi", "zeta")]  # fmt: skip


@pytest.mark.parametrize("tilt", [0.02, 0.3, 0.9, 1.4, 1.55])
@pytest.mark.parametrize("strips", [1, 7])
def test_partly_wet_cylinder_is_exact(tilt, strips, record):
    """Volume and its first moments of a cylinder cut by the surface, ends included, against quadrature."""
    r, length, worst = 0.8, 5.0, 0.0
    for z0 in np.linspace(-2.4, 2.4, 9):
        volume, across, along = wet_part(z0, tilt, r, length)
        member = Member(a=(0, 0, -0.5 * length), b=(0, 0, 0.5 * length), diameter=2 * r, strips=strips)
        force, moment, _, _ = evaluated(body(member, position=(0, 0, z0), attitude_deg=(0, np.degrees(tilt), 0)))
        arm = across * np.cos(tilt) + along * np.sin(tilt)  # along x
        whole = np.pi * r * r * length
        worst = max(worst, abs(force[2] / (RHO * G) - volume) / whole, abs(moment[1] / (RHO * G) + arm) / whole)
    record(ROW_STATICS, f"cut cylinder tilted by {tilt:g} rad, {strips} strips", worst, 3e-6)


def test_wetness_is_continuous():
    """Share, lever and derivatives join where the closed forms take over from quadrature, and at both ends."""
    for e_z in (0.0, 1e-4, 0.3, 0.999, 1.0):
        z = np.linspace(-4.0, 4.0, 20001)
        phi = np.array([wetness(y, e_z, 0.5, 1.5, 1e-3)[0] for y in z])
        slope = np.array([wetness(y, e_z, 0.5, 1.5, 1e-3)[2] for y in z])
        assert phi[0] == 1.0 and phi[-1] == 0.0
        assert np.all(np.diff(phi) <= 1e-14) and np.abs(np.diff(phi)).max() < 6e-4
        assert np.abs(np.diff(phi) / np.diff(z) - 0.5 * (slope[1:] + slope[:-1])).max() < 0.02
    for half, r in ((1.0, 0.5), (0.02, 0.5), (5.0, 0.1)):
        limit = FLAT * r / np.hypot(half, FLAT * r)  # where e_z half/(r sqrt(1 - e_z^2)) = FLAT
        for z in (-0.3 * r, 0.2 * r, 0.8 * r):
            low = np.array(wetness(z, limit * (1 - 1e-9), r, half, 0.0))
            high = np.array(wetness(z, limit * (1 + 1e-9), r, half, 0.0))
            np.testing.assert_allclose(low, high, rtol=1e-7, atol=1e-9 * half)


def spar(mass, r=2.0, low=-30.0, high=15.0, z_cm=-20.0, loads=(), **more):
    """A vertical cylinder whose reference point is at its drawn waterline."""
    return body(Member(a=(0, 0, low), b=(0, 0, high), diameter=2 * r, **more), *loads, mass=mass,
                center_of_mass=(0, 0, z_cm), inertia=(1e2 * mass, 1e2 * mass, 2.0 * mass), name="spar")  # fmt: skip


@pytest.mark.parametrize("start", [(0.0, 0.0), (7.0, 8.0), (-14.0, 0.0), (40.0, 0.0)])
def test_spar_finds_its_draught(start, record):
    """m = rho A T, from a drawing at it, heeled, nearly drowned or in the air."""
    mass = RHO * np.pi * 4.0 * 26.0
    hull = spar(mass).model_copy(update=dict(position=(0, 0, start[0]), attitude_deg=(start[1], 0, 0)))
    system = fs.assemble(fs.Model(parts=[hull], sea=STILL))
    state, _ = fs.solve_static(system)
    record(ROW_STATICS, f"draught of a spar drawn at {start[0]:g} m, {start[1]:g} deg heel: error [m]",
           abs(30.0 - state.x[0, 2] - 26.0), 1e-4)  # fmt: skip
    assert abs(state.q[0, 0]) == pytest.approx(1.0, abs=1e-6)


def test_stiffness_is_that_of_the_metacentre(record):
    """rho g A in heave, rho g V (KB + I/V - KG) in roll and pitch about the centre of mass' axis."""
    r, T = 2.0, 30.0
    mass = RHO * np.pi * r**2 * T
    system = fs.assemble(fs.Model(parts=[spar(mass)], sea=STILL))
    w = system.work()
    state = system.initial_state()
    system.load(w, state)
    w.still = True
    system.begin(w, state, 0.0)
    K = matrix(system, w, (0.0, 0.0, 1.0, 0.0))[np.ix_(free_unknowns(system), free_unknowns(system))]
    GM = (-0.5 * T) + r**2 / (4.0 * T) + 20.0
    heave = abs(K[2, 2] / (RHO * G * np.pi * r**2) - 1.0)
    pitch = abs(K[4, 4] / (mass * G * GM) - 1.0)
    record(ROW_STATICS, "spar: heave and pitch stiffness", max(heave, pitch, abs(K[3, 3] / K[4, 4] - 1.0)), 1e-6)
    np.testing.assert_allclose(K, K.T, atol=1e-7 * np.abs(K).max())


def test_heel_under_a_pull(record):
    """A spar pulled by a spring: heave and heel from the wall-sided cylinder's own equilibrium."""
    r, mass, z_cm = 2.0, RHO * np.pi * 4.0 * 30.0, -20.0
    anchor, k, free = np.array([60.0, 0.0, 4.0]), 4e4, 40.0
    hull = spar(mass).model_copy(update=dict(points={"eye": (0.0, 0.0, 8.0)}))
    spring = fs.Spring(name="tug", a="spar.eye", b=tuple(anchor), stiffness=k, free_length=free)
    back = fs.Spring(name="back", a="spar", b=(-60.0, 0.0, 0.0), stiffness=2e4, free_length=50.0)
    state, _ = fs.solve_static(fs.assemble(fs.Model(parts=[hull, spring, back], sea=STILL)))
    heel = Rotation.from_quat(state.q[0, [1, 2, 3, 0]]).as_rotvec()[1]

    def unbalance(y):
        x, z, angle = y
        e = np.array([np.sin(angle), 0.0, np.cos(angle)])  # the axis; the spar leans towards +x
        across = np.array([np.cos(angle), 0.0, -np.sin(angle)])
        ref = np.array([x, 0.0, z])
        wet = 30.0 - z / np.cos(angle)  # of the axis
        t = np.tan(angle)
        centre = ref + (-30.0 + 0.5 * wet + r * r * t * t / (8 * wet)) * e + r * r * t / (4 * wet) * across
        lift, weight = RHO * G * np.pi * r**2 * wet, mass * G
        forces = [(centre, np.array([0, 0, lift])), (ref + z_cm * e, np.array([0, 0, -weight]))]
        for here, there, stiffness, length in ((ref + 8.0 * e, anchor, k, free),
                                               (ref, np.array([-60.0, 0.0, 0.0]), 2e4, 50.0)):  # fmt: skip
            d = there - here
            l = np.linalg.norm(d)
            forces.append((here, stiffness * (l - length) * d / l))
        F = sum(f for _, f in forces)
        M = sum(np.cross(p - ref, f) for p, f in forces)
        return [F[0] / 1e5, F[2] / 1e5, M[1] / 1e6]

    x, z, angle = fsolve(unbalance, (5.0, 0.0, 0.1), xtol=1e-13)
    assert abs(angle) > np.radians(5.0)
    record(ROW_STATICS, f"heel of {np.degrees(angle):.1f} deg under a pull: error [deg]",
           abs(np.degrees(heel - angle)), 1e-5)  # fmt: skip
    record(ROW_STATICS, "the same: place of the reference point [m]",
           float(np.hypot(state.x[0, 0] - x, state.x[0, 2] - z)), 1e-5)  # fmt: skip


# -- currents and drag -----------------------------------------------------------------------------


def test_drag_in_currents(record):
    """1/2 rho D L Cd U^2; by component at 45 degrees 1/sqrt(2) of it; along the axis the skin's and the ends'."""
    D, L, U = 0.8, 6.0, 1.3
    q = 0.5 * RHO * U**2
    sea = fs.Sea(depth=50.0, current=fs.Current(speed=U, heading_deg=45.0))
    upright = dict(a=(0, 0, -8), b=(0, 0, -2), diameter=D, drag_normal=1.1, drag_tangential=0.05)
    level = dict(upright, a=(-2, -2, -5), b=(2, 2, -5), end_drag=(0.9, 0.3))
    along = np.array([1.0, 1.0, 0.0]) / np.sqrt(2.0)
    expected = {
        "across": (upright, q * 1.1 * D * L * along),
        "by component": (dict(upright, drag_form="decoupled"), q * 1.1 * D * L * 0.5 * np.array([1.0, 1.0, 0.0])),
        "along": (level, q * (0.05 * np.pi * D * 4 * np.sqrt(2) + 1.2 * np.pi / 4 * D**2) * along),
    }
    for name, (values, force) in expected.items():
        got = evaluated(body(Member(**values, buoyancy=False)), sea)[0]
        record(ROW_STATICS, f"drag of a current, {name}", np.abs(got - force).max() / np.abs(force).max(), 1e-12)
    # towed at U through still water: the same force the other way, and its power
    hull = body(Member(**upright, buoyancy=False))
    got, _, system, _ = evaluated(hull, speed=U * along)
    np.testing.assert_allclose(got, -expected["across"][1], rtol=1e-12)
    (batch,) = [b for b in system.batches if isinstance(b, MemberBatch)]
    assert batch.load[0, 6] == pytest.approx(-q * 1.1 * D * L * U, rel=1e-12)


def test_drag_in_a_sheared_current(record):
    """A power law of exponent 1/7 integrated from the bed to the surface: 1/2 rho D Cd U^2 d 7/9."""
    sea = fs.Sea(depth=30.0, current=fs.Current(speed=1.0, profile=fs.PowerLaw()))
    got = evaluated(body(Member(a=(0, 0, -30), b=(0, 0, 0), diameter=0.5, drag_normal=1.0, strips=400)), sea)[0]
    record(ROW_STATICS, "drag of a power-law current", abs(got[0] / (0.25 * RHO * 30.0 * 7 / 9) - 1.0), 1e-3)


@pytest.mark.parametrize("profile", [None, fs.PowerLaw()])
def test_statics_with_a_current(profile, record):
    """A level cylinder, moored far above its drawing, drifts until four springs balance the drag at its new depth."""
    D, L, m = 1.0, 8.0, RHO * np.pi / 4 * 8.0
    cylinder = Member(a="port", b="starboard", diameter=D, drag_normal=1.0)
    hull = body(cylinder, position=(0, 0, -30), mass=m, inertia=(50 * m, m, 50 * m),
                points={"port": (0, 0.5 * L, 0), "starboard": (0, -0.5 * L, 0)})  # fmt: skip
    sea = fs.Sea(depth=60.0, current=fs.Current(speed=1.5, profile=profile))
    springs = [fs.Spring(name=f"{side}_{k}", a=f"hull.{side}", b=(0, y, z), stiffness=1e3, free_length=0.0)
               for side, y in (("port", 4.0), ("starboard", -4.0)) for k, z in enumerate((0, -20))]  # fmt: skip
    state, _ = fs.solve_static(fs.assemble(fs.Model(parts=[hull, *springs], sea=sea)))
    U = 1.5 * ((1.0 - 10.0 / 60.0) ** (1.0 / 7.0) if profile else 1.0)
    assert state.x[0, 2] == pytest.approx(-10.0, abs=1e-4)
    drift = abs(state.x[0, 0] / (0.5 * RHO * D * L * U**2 / 4e3) - 1.0)
    record(ROW_STATICS, f"drift in a {'sheared' if profile else 'uniform'} current", drift, 1e-4)


# -- waves -----------------------------------------------------------------------------------------


def test_inertia_of_a_column_in_a_regular_wave(record):
    """Fixed from bed to mean surface, at the zero-crossing (no drag, no elevation).

    F = rho A CM a g tanh(kd); M about the bed = rho A CM a w^2/sinh(kd) (d sinh(kd)/k - (cosh(kd) - 1)/k^2).
    """
    d, D, period, height = 40.0, 1.2, 8.0, 0.5
    w = 2 * np.pi / period
    k, a, A = wave_number(w, d), 0.5 * height, np.pi / 4 * D**2
    column = body(Member(a=(0, 0, 0), b=(0, 0, d), diameter=D, added_mass_normal=0.8, drag_normal=1.0, strips=80),
                  position=(0, 0, -d))  # fmt: skip
    force, moment, _, _ = evaluated(column, wave(height, period, d), t=-0.25 * period)
    F = RHO * A * 1.8 * a * G * np.tanh(k * d)
    M = RHO * A * 1.8 * a * w**2 / np.sinh(k * d) * (d * np.sinh(k * d) / k - (np.cosh(k * d) - 1) / k**2)
    record(ROW_WAVES, "inertia force of a column", abs(abs(force[0]) / F - 1.0), 1e-3)
    record(ROW_WAVES, "inertia moment of a column about the bed", abs(abs(moment[1]) / M - 1.0), 1e-3)
    assert force[0] > 0.0  # before the crest comes from -x the water accelerates towards +x


def test_drag_of_a_column_in_a_regular_wave(record):
    """At the crest, to the mean surface: 1/2 rho Cd D (a w/sinh kd)^2 (sinh(2kd)/(4k) + d/2)."""
    d, D, period, height = 40.0, 1.2, 8.0, 2.0
    w = 2 * np.pi / period
    k, a = wave_number(w, d), 0.5 * height
    column = body(Member(a=(0, 0, 0), b=(0, 0, d), diameter=D, drag_normal=1.1, added_mass_normal=1.0, strips=80),
                  position=(0, 0, -d))  # fmt: skip
    force = evaluated(column, wave(height, period, d))[0]
    F = 0.5 * RHO * 1.1 * D * (a * w / np.sinh(k * d)) ** 2 * (np.sinh(2 * k * d) / (4 * k) + 0.5 * d)
    record(ROW_WAVES, "drag force of a column", abs(force[0] / F - 1.0), 1e-3)


@pytest.mark.parametrize("strips", [40, 80])
def test_heave_force_on_a_spar(strips, record):
    """Froude-Krylov force on the foot of a column, rho g A a e^(-kT): from water accelerations and the surface."""
    period, height, T, D = 7.0, 0.02, 20.0, 2.0
    k = (2 * np.pi / period) ** 2 / G
    column = body(Member(a=(0, 0, -T), b=(0, 0, 5), diameter=D, strips=strips))
    crest, rest = (evaluated(column, wave(height, period, 2000.0), t)[0][2] for t in (0.0, 0.25 * period))
    F = RHO * G * np.pi / 4 * D**2 * 0.5 * height * np.exp(-k * T)
    record(ROW_WAVES, f"heave force on the foot of a column, {strips} strips", abs((crest - rest) / F - 1.0), 0.02)


def test_end_discs_in_a_wave(record):
    """A level disc on its own: 8/3 rho r^3 of the water's vertical acceleration, 1/2 rho Cd A of its speed."""
    period, height, z, r = 9.0, 1.0, -12.0, 3.0
    w = 2 * np.pi / period
    k, sea = w**2 / G, wave(height, period, 2000.0)
    hull = body(Disc(at=(0, 0, z), diameter=2 * r, drag=2.0, added_mass=1.0))
    crest = evaluated(hull, sea, 0.0)[0][2]
    rise = evaluated(hull, sea, -0.25 * period)[0][2]
    speed = 0.5 * height * w * np.exp(k * z)
    record(ROW_WAVES, "added mass of a disc", abs(-crest / (8 / 3 * RHO * r**3 * w * speed) - 1.0), 1e-6)
    record(ROW_WAVES, "drag of a disc", abs(rise / (RHO * np.pi * r**2 * speed**2) - 1.0), 1e-6)


# -- free motion -----------------------------------------------------------------------------------


def stepped(model, duration, h, speed=(0.0, 0.0, 0.0), state=None):
    """(times, positions, velocities) of the first point of a run from the drawing position."""
    system = fs.assemble(model)
    stepper = fs.Stepper(system, tolerance=1e-9)
    state = state or system.initial_state()
    state.v[:3] = speed
    stepper.start(state, h)
    rows = [(state.t, *state.x[0], *state.v[:3])]
    for _ in range(round(duration / h)):
        report = stepper.step(state, h)
        assert report.converged, report
        rows.append((state.t, *state.x[0], *state.v[:3]))
    rows = np.array(rows)
    return rows[:, 0], rows[:, 1:4], rows[:, 4:], state


def test_terminal_speed_of_a_sinking_cylinder(record):
    """(m - rho V) g = 1/2 rho D L Cd v^2, and with M = m + Ca rho V on the way v = v_end tanh(t g'/v_end)."""
    D, L = 0.5, 4.0
    V = np.pi / 4 * D**2 * L
    m = 1.4 * RHO * V
    hull = body(Member(a=(-0.5 * L, 0, 0), b=(0.5 * L, 0, 0), diameter=D, drag_normal=1.0, added_mass_normal=1.0),
                position=(0, 0, -20), mass=m, inertia=(m, 9 * m, 9 * m))  # fmt: skip
    t, _, v, _ = stepped(fs.Model(parts=[hull], sea=STILL), 12.0, 0.02)
    end = np.sqrt(0.4 * RHO * V * G / (0.5 * RHO * D * L))
    exact = end * np.tanh(t * 0.4 * RHO * V * G / (m + RHO * V) / end)
    record(ROW_MOTION, "sinking cylinder: terminal speed", abs(-v[-1, 2] / end - 1.0), 1e-6)
    record(ROW_MOTION, "sinking cylinder: speed on the way", np.abs(v[:, 2] + exact).max() / end, 1e-3)


def test_heave_of_a_spar(record):
    """w^2 = rho g A/(m + added mass of the plate), and rocking about its own modes leaves heave alone."""
    m, r = RHO * np.pi * 4.0 * 30.0, 5.0
    plate = Disc(at=(0, 0, -30), diameter=2 * r, added_mass=1.0)
    system = fs.assemble(fs.Model(parts=[spar(m, loads=[plate])], sea=STILL))
    omega = np.sqrt(RHO * G * np.pi * 4.0 / (m + 8 / 3 * RHO * r**3))
    found = natural_frequencies(system, system.initial_state())
    record(ROW_MOTION, "heave frequency of a spar with a plate", np.abs(found / omega - 1.0).min(), 1e-9)
    hull = spar(m, loads=[plate]).model_copy(update=dict(position=(0, 0, 0.5)))
    t, x, _, _ = stepped(fs.Model(parts=[hull], sea=STILL), 60.0, 0.05)
    record(ROW_MOTION, "heave of the spar in time over its amplitude",
           np.abs(x[:, 2] - 0.5 * np.cos(omega * t)).max() / 0.5, 2e-3)  # fmt: skip


@pytest.mark.parametrize("period", [8.0, 20.0])
def test_heave_of_a_spar_in_waves(period, record):
    """From its steady state on: Z = a e^(-kT) (rho g A - m_a w^2)/(rho g A - (m + m_a) w^2), m_a of its plate."""
    m, r, a, T = RHO * np.pi * 4.0 * 30.0, 5.0, 5e-4, 30.0  # small: what is left out is of second order
    w = 2 * np.pi / period
    C, m_a = RHO * G * np.pi * 4.0, 8 / 3 * RHO * r**3
    Z = a * np.exp(-(w**2) / G * T) * (C - m_a * w**2) / (C - (m + m_a) * w**2)
    plate = Disc(at=(0, 0, -T), diameter=2 * r, added_mass=1.0)
    hull = spar(m, loads=[plate], strips=90).model_copy(update=dict(position=(0, 0, Z)))
    t, x, _, _ = stepped(fs.Model(parts=[hull], sea=wave(2 * a, period, 3000.0)), 2 * period, 0.05)
    error = np.abs(x[:, 2] - Z * np.cos(w * t)).max() / abs(Z)
    record(ROW_WAVES, f"heave of a spar with a plate, period {period:g} s, over its amplitude", error, 0.02)


def test_quadratic_decay(record):
    """Extrema of x'' + mu |x'| x' + w^2 x = 0: (1 - 2 mu y) exp(2 mu y) = (1 + 2 mu x) exp(-2 mu x), x to y."""
    m, r, Cd = RHO * np.pi * 4.0 * 30.0, 4.0, 5.0
    plate = Disc(at=(0, 0, -30), diameter=2 * r, drag=Cd, added_mass=1.0)
    hull = spar(m, loads=[plate]).model_copy(update=dict(position=(0, 0, 3.0)))
    _, x, _, _ = stepped(fs.Model(parts=[hull], sea=STILL), 60.0, 0.05)
    z = x[:, 2]
    inner = np.flatnonzero((z[1:-1] - z[:-2]) * (z[2:] - z[1:-1]) <= 0.0) + 1
    tops = [z[i] - (z[i + 1] - z[i - 1]) ** 2 / (8 * (z[i + 1] - 2 * z[i] + z[i - 1])) for i in inner]
    mu = 0.5 * RHO * Cd * np.pi * r**2 / (m + 8 / 3 * RHO * r**3)
    amplitude, expected = 3.0, []
    for _ in tops:
        left = (1 + 2 * mu * amplitude) * np.exp(-2 * mu * amplitude)
        amplitude = brentq(lambda y, left=left: (1 - 2 * mu * y) * np.exp(2 * mu * y) - left, 0.0, amplitude)
        expected.append(amplitude)
    assert len(tops) >= 5 and expected[0] < 0.9 * 3.0
    record(ROW_MOTION, f"quadratic decay of a spar, {len(tops)} extrema, over the first amplitude",
           np.abs(np.abs(tops) - expected).max() / 3.0, 2e-4)  # fmt: skip


@pytest.mark.parametrize("attitude", [(0, 0, 0), (0, 90, 0), (0, 40, 30)])
def test_neutral_cylinder_goes_with_long_waves(attitude, record):
    """m = rho V, CM = 2: wherever it points it moves as the water does, ends' pressure included.

    In a small wave: convective accelerations, which are left out, are of second order."""
    D, L, period, height, z = 0.5, 2.0, 12.0, 0.01, -15.0
    m = RHO * np.pi / 4 * D**2 * L
    w = 2 * np.pi / period
    k = w**2 / G
    hull = body(Member(a=(0, 0, -1), b=(0, 0, 1), diameter=D, added_mass_normal=1.0, added_mass_tangential=0.1),
                position=(0, 0, z), attitude_deg=attitude, mass=m, inertia=(m, m, 0.1 * m))  # fmt: skip
    a = 0.5 * height * np.exp(k * z)
    t, x, _, _ = stepped(fs.Model(parts=[hull], sea=wave(height, period, 3000.0)), 36.0, 0.1, speed=(a * w, 0, 0))
    orbit = np.column_stack([a * np.sin(w * t), 0 * t, z + a * (np.cos(w * t) - 1.0)])
    record(ROW_MOTION, f"neutral cylinder at {attitude} deg in a long wave: distance from the water, of its orbit",
           np.abs(x - orbit).max() / a, 0.03)  # fmt: skip


def test_it_survives_leaving_and_entering(record):
    """A level cylinder thrown out of the water falls back, dives and comes to rest afloat."""
    D, L = 1.0, 5.0
    m = 0.5 * RHO * np.pi / 4 * D**2 * L
    hull = body(Member(a=(-2.5, 0, 0), b=(2.5, 0, 0), diameter=D, drag_normal=1.0, added_mass_normal=1.0,
                       end_drag=1.0, end_added_mass=0.5), position=(0, 0, 2.0), mass=m, center_of_mass=(0, 0, -0.1),
                inertia=(m, 4 * m, 4 * m))  # fmt: skip
    t, x, _, _ = stepped(fs.Model(parts=[hull], sea=STILL), 60.0, 0.05, speed=(0, 0, 3.0))
    assert x[:, 2].max() > 2.3 and x[:, 2].min() < -0.5
    record(ROW_MOTION, "cylinder thrown out of the water: draught at last [m]", abs(x[-100:, 2]).max(), 0.1)


# -- invariance ------------------------------------------------------------------------------------


def test_turned_moved_and_reversed(record):
    """Everything turned about z and moved along the crests, and members with their ends exchanged, in a wave."""
    rng = np.random.default_rng(5)
    wet = dict(drag_normal=1.1, drag_tangential=0.2, added_mass_normal=0.9, added_mass_tangential=0.3)
    a, b = (-2.0, 1.0, -4.0), (1.0, -1.5, 3.0)
    speed = rng.uniform(-1, 1, 3)

    def loads(turn, at, reverse, drag):
        R = Rotation.from_euler("z", turn, degrees=True).as_matrix()
        ends = (b, a) if reverse else (a, b)
        d, Cd, Ca = ((y[::-1] if reverse else y) for y in ((1.0, 2.0), (0.5, 0.8), (0.5, 1.0)))
        member = Member(a=ends[0], b=ends[1], diameter=d, end_drag=Cd, end_added_mass=Ca, drag_form=drag, **wet)
        sea = fs.Sea(depth=60.0, wave_ramp=0.0, current=fs.Current(speed=0.6, heading_deg=20.0 + turn),
                     waves=fs.RegularWave(height=2.0, period=7.0, heading_deg=turn))  # fmt: skip
        hull = body(member, position=R @ np.add((1.0, 2.0, -0.5), (0.0, at, 0.0)), attitude_deg=(0, 0, turn))
        force, moment, _, _ = evaluated(hull, sea, 1.3, speed=R @ speed)
        return np.concatenate([R.T @ force, R.T @ moment])

    for drag in ("coupled", "decoupled"):
        plain = loads(0.0, 0.0, False, drag)
        for name, other in (("turned and moved", (70.0, 40.0, False)), ("reversed", (0.0, 0.0, True))):
            error = np.abs(loads(*other, drag) - plain).max() / np.abs(plain).max()
            record("invariance of Morison loads", f"{name}, {drag}", error, 1e-9)


def test_forces_are_rates_of_an_energy():
    """Buoyancy of a partly wet member does no work around a closed path of heave and roll."""
    hull = body(Member(a=(0, -3, 0), b=(0, 3, 1.0), diameter=1.5, strips=3))
    _, _, system, w = evaluated(hull, still=True)
    angle = np.linspace(0.0, 2 * np.pi, 721)
    work, last = 0.0, None
    for s in angle:
        w.x[0, 2], roll = 0.6 * np.sin(s), 0.7 * np.cos(s)
        w.R[0] = matrix_from_angles(roll, 0.0, 0.0)
        w.q[0] = quaternion_from_matrix(w.R[0])
        r = residual(system, w)[free_unknowns(system)]
        here = (r[2] - 1e4 * G, r[3], w.x[0, 2], roll)
        if last is not None:
            work += 0.5 * (here[0] + last[0]) * (here[2] - last[2]) + 0.5 * (here[1] + last[1]) * (here[3] - last[3])
        last = here
    assert abs(work) < 1e-4 * RHO * G * np.pi / 4 * 1.5**2 * 6 * 1.2


def test_water_is_taken_where_strips_will_be():
    """x + h v + h^2/2 a of the body, turned by h w + h^2/2 alpha."""
    hull = body(Member(a=(3, 0, -2), b=(3, 0, 2), diameter=1.0, strips=2), position=(0, 0, -20))
    system = fs.assemble(fs.Model(parts=[hull], sea=STILL))
    state, rng, h = system.initial_state(), np.random.default_rng(2), 0.4
    velocity, acceleration = rng.uniform(-1, 1, (2, 6))
    state.v[[0, 1, 2, 6, 7, 8]], state.a[[0, 1, 2, 6, 7, 8]] = velocity, acceleration
    w = system.work()
    system.load(w, state)
    system.begin(w, state, state.t + h)
    move = h * velocity + 0.5 * h * h * acceleration
    arms = np.array([[3.0, 0.0, -1.0], [3.0, 0.0, 1.0]])
    expected = np.array([0, 0, -20]) + move[:3] + Rotation.from_rotvec(move[3:]).apply(arms)
    (batch,) = [b for b in system.batches if isinstance(b, MemberBatch)]
    np.testing.assert_allclose(batch.x, expected, atol=1e-12)


# -- strips for linearisation, output --------------------------------------------------------------


def test_output(tmp_path):
    """A moored spar at rest: the channel holds its weight."""
    m = RHO * np.pi * 4.0 * 30.0
    model = fs.Model(parts=[spar(m)], sea=STILL)
    fs.simulate(model, duration=0.5, dt=0.1, output=tmp_path / "run.nc")
    import xarray

    with xarray.open_dataset(tmp_path / "run.nc") as out:
        assert out.spar_member_force.dims == ("time", "xyz") and out.spar_member_force.units == "N"
        assert out.spar_member_moment.units == "N m"
        np.testing.assert_allclose(out.spar_member_force[-1], [0, 0, m * G], atol=1e-4 * m * G)


def test_equilibrium_sheet():
    """Buoyancy of members is told as such: at its draught nothing else pulls on a spar."""
    m = RHO * np.pi * 4.0 * 30.0
    (sheet,) = body_sheets(fs.assemble(fs.Model(parts=[spar(m)], sea=STILL)))
    assert sheet.buoyancy == pytest.approx(m * G, rel=1e-6) and sheet.warnings == ()
    np.testing.assert_allclose(sheet.attached, 0.0, atol=1e-6 * m * G)


# -- point buoys -----------------------------------------------------------------------------------


def test_point_buoy_floats_and_a_sinker_hangs(record):
    """Draught m/(rho V) of its height; a sinker on a spring stretches it by its weight in water."""
    buoy = PointBuoy(name="buoy", mass=300.0, volume=0.9, height=1.5, position=(0, 0, 3.0))
    sinker = PointBuoy(name="sinker", mass=500.0, volume=0.1, position=(5, 0, -12))
    spring = fs.Spring(name="rope", a="sinker", b=(5, 0, -10), stiffness=1e4, free_length=1.0)
    model = fs.Model(parts=[buoy, sinker, spring], sea=STILL)
    assert model.loose() == []
    state, _ = fs.solve_static(fs.assemble(model))
    draught = 300.0 / (RHO * 0.9) * 1.5
    record(ROW_STATICS, "point buoy: draught [m]", abs(0.75 - state.x[0, 2] - draught), 1e-5)
    stretch = (500.0 - 102.5) * G / 1e4
    record(ROW_STATICS, "sinker on a spring: depth [m]", abs(state.x[1, 2] + 11.0 + stretch), 1e-5)


def test_point_sinker_falls_at_its_terminal_speed(record):
    """(m - rho V) g = 1/2 rho CdA v^2."""
    buoy = PointBuoy(name="sinker", mass=500.0, volume=0.1, drag_area=0.4, added_mass=0.5, position=(0, 0, -5))
    _, _, v, _ = stepped(fs.Model(parts=[buoy], sea=STILL), 10.0, 0.05)
    end = np.sqrt(2 * (500.0 - 102.5) * G / (RHO * 0.4))
    record(ROW_MOTION, "point sinker: terminal speed", abs(-v[-1, 2] / end - 1.0), 1e-6)


def test_point_buoy_goes_with_the_water(record):
    """Neutral, in a long wave: its orbit is the water's."""
    a0, period, z = 0.005, 10.0, -10.0
    w = 2 * np.pi / period
    a = a0 * np.exp(w**2 / G * z)
    buoy = PointBuoy(name="buoy", mass=RHO * 0.5, volume=0.5, added_mass=0.5, position=(0, 0, z))
    t, x, _, _ = stepped(fs.Model(parts=[buoy], sea=wave(2 * a0, period, 3000.0)), 20.0, 0.1, speed=(a * w, 0, 0))
    orbit = np.column_stack([a * np.sin(w * t), 0 * t, z + a * (np.cos(w * t) - 1.0)])
    record(ROW_MOTION, "neutral point buoy in a wave: distance from the water, of its orbit",
           np.abs(x - orbit).max() / a, 0.03)  # fmt: skip


def test_sinker_on_the_bed(record):
    """It lies where the bed's pressure carries its weight in water, and holds a horizontal pull up to mu N."""
    weight, mu = (500.0 - 102.5) * G, 0.6
    bed = fs.Seabed(stiffness=1e5, friction=mu, slip_length=0.02)
    sea = fs.Sea(depth=30.0, seabed=bed)

    def pulled(k, duration, h):
        """x of a sinker that lies at rest and is pulled along the bed by a spring of 1 m of stretch."""
        z = -30.0 - weight / 5e4
        sinker = PointBuoy(name="sinker", mass=500.0, volume=0.1, bed_area=0.5, position=(0, 0, z))
        spring = fs.Spring(name="pull", a="sinker", b=(11, 0, z), stiffness=k, free_length=10.0)
        return stepped(fs.Model(parts=[sinker, spring], sea=sea), duration, h)[1][:, 0]

    free = PointBuoy(name="sinker", mass=500.0, volume=0.1, bed_area=0.5, position=(0, 0, -25))
    assert fs.Model(parts=[free], sea=sea).loose() == []
    state, _ = fs.solve_static(fs.assemble(fs.Model(parts=[free], sea=sea)))
    record(ROW_STATICS, "sinker on the bed: penetration over its own",
           abs((-30.0 - state.x[0, 2]) / (weight / 5e4) - 1.0), 1e-6)  # fmt: skip
    # a quarter of what it holds: it sticks, and moves by as much of the slip length
    held = 0.25 * 0.02 / (1 + 0.25 * 0.02)
    shift = pulled(0.25 * mu * weight, 60.0, 0.05)[-600:].mean()
    record(ROW_STATICS, "sinker held by friction: shift [m]", abs(shift - held), 1e-4)
    # twice of it: it slides until the spring's energy is spent, k (x - x^2/2) = mu N (x - slip/2)
    furthest = 0.5 * (1.0 + np.sqrt(1.0 + 2.0 * 0.02))
    error = abs(pulled(2.0 * mu * weight, 3.0, 0.01).max() / furthest - 1.0)
    record(ROW_MOTION, "sinker pulled over the bed: how far it slides", error, 2e-3)
