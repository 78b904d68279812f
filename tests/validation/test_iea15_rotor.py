"""The IEA 15 MW rotor against its steady table, and the VolturnUS-S with it: pitch damping in steady wind."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest
from shipped import MODELS, load

import floatsim as fs
from floatsim.parts.rotor import RotorBatch
from floatsim.rotor.operation import PITCH, SPEED
from floatsim.rotor.surface import loads
from floatsim.study.release import displace, pose

# WISDEM's ideal steady states, without peak shaving: wind m/s, pitch deg, electrical power MW, rotor speed rpm, thrust
# MN, torque MN m. Tabular workbook of IEAWindTask37/IEA-15-240-RWT, sheet "Rotor Performance", rows of 6 to 20 m/s
TABLE = np.array([
    (6.15301, 1.38709, 2.82325, 5, 0.833654, 5.63516), (6.46194, 0.891713, 3.30226, 5, 0.918175, 6.59125),
    (6.96547, 0.000469162, 4.17814, 5, 1.06328, 8.3395), (7.50087, 0, 5.24819, 5.32902, 1.22224, 9.7794),
    (7.97022, 0, 6.3148, 5.66248, 1.37999, 11.0415), (8.42215, 0, 7.46247, 5.98355, 1.54092, 12.3292),
    (9.02728, 0, 9.1675, 6.41347, 1.77031, 14.1646), (9.78004, 0, 11.6166, 6.94827, 2.07786, 16.6253),
    (10.2096, 0, 13.1937, 7.25349, 2.26442, 18.118), (10.6584, 0, 15, 7.49924, 2.44734, 19.947),
    (10.6735, 0.511974, 15, 7.49924, 2.37431, 19.947), (11.1704, 3.72373, 15, 7.49924, 1.9569, 19.947),
    (11.6993, 5.39649, 15, 7.49924, 1.76914, 19.947), (12.2589, 6.76669, 15, 7.49924, 1.6306, 19.947),
    (13.4652, 9.12429, 14.9999, 7.49924, 1.42307, 19.947), (14.7781, 11.2337, 15.0001, 7.49924, 1.26774, 19.9471),
    (16.1854, 13.2121, 15, 7.49924, 1.14495, 19.9471), (17.6743, 15.1057, 15, 7.49924, 1.04541, 19.9471),
    (20.0299, 17.8267, 15, 7.49924, 0.928218, 19.947),
])  # fmt: skip
sys.path.insert(0, str(MODELS))  # model scripts import their neighbours, as when they are run

RPM = math.pi / 30.0
SHEAR = 0.14


def rotor_of(system):
    """The batch of rotors."""
    return next(batch for batch in system.batches if isinstance(batch, RotorBatch))


def test_steady_table(record):
    """Hub held: speed, thrust, torque, power and pitch of the steady operating points.

    Pitch is compared to 2 % or 0.15 deg: it leaves zero at rated wind with an infinite slope.
    """
    iea15 = load("iea15")
    worst = dict.fromkeys(("speed", "thrust", "torque", "power", "pitch"), 0.0)
    nacelle = fs.Body(name="nacelle", mass=1e6, inertia=(4e8, 3e8, 3e8), position=(0, 0, 144.386))
    parts, joints = [nacelle, iea15.rotor("nacelle", (0, 0, 0))], [fs.Weld(a="nacelle", b=(0, 0, 144.386))]
    for U, pitch, P, rpm, T, Q in TABLE:
        model = fs.Model(parts=parts, joints=joints, sea=fs.Sea(depth=200.0), wind=fs.Wind(speed=U))
        run = fs.simulate(model, 30.0, 0.5)
        found = {name: run.series(f"rotor_{name}") for name in worst}
        for name, value in (("speed", rpm * RPM), ("thrust", 1e6 * T), ("torque", 1e6 * Q), ("power", 1e6 * P)):
            worst[name] = max(worst[name], np.abs(found[name] / value - 1.0).max())
        gap = np.degrees(np.abs(found["pitch"] - math.radians(pitch)).max())
        worst["pitch"] = max(worst["pitch"], gap / max(pitch, 7.5))
    for name, value in worst.items():
        least = ", of 7.5 deg at least" if name == "pitch" else ""
        quantity = f"steady {name}, 6 to 20 m/s, largest deviation{least}"
        record("IEA 15 MW rotor against WISDEM's steady table", quantity, 100.0 * value, 2.0, "%")


@pytest.fixture(scope="module")
def volturnus():
    return load("volturnus_s")


@pytest.mark.parametrize("U", [8.0, 12.0, 16.0, 20.0])
def test_pitch_decay_in_steady_wind(U, volturnus, record):
    """Still water, released at 5 degrees from the equilibrium in the wind: it settles there."""
    system = fs.assemble(volturnus.build(wind=fs.Wind(speed=U, shear=SHEAR), elements=25))
    test = fs.decay_test(system, "pitch", 5.0, duration=1500.0, dt=0.2, channels=["platform_position", "rotor_speed"])
    check = "VolturnUS-S with rotor, steady wind, released at 5 deg of pitch"
    record(check, f"{U:g} m/s: pitch damping ratio", test.fit.damping_ratio, (0.01, 1.0))
    pitch = np.degrees(test.run.series("platform_position")[:, 4]) - test.equilibrium
    late = test.run.time > 1200.0
    record(check, f"{U:g} m/s: largest departure of pitch after 1200 s", np.abs(pitch[late]).max(), 0.05, "deg")
    speed = test.run.series("rotor_speed")[late]
    record(check, f"{U:g} m/s: range of rotor speed after 1200 s", 100.0 * np.ptp(speed) / speed.mean(), 1.0, "%")


def without_drag(model):
    """The model with its tower's drag left out and springs in surge and sway instead of moorings."""
    parts = [
        part.model_copy(update={"tower": None}) if isinstance(part, fs.Rotor) else part for part in model.parts
    ]
    parts += [fs.Spring(name=f"spring_{axis}", a="platform", b=at, stiffness=7e4, free_length=1e5)
              for axis, at in (("x", (1e5, 0, 0)), ("y", (0, 1e5, 0)))]  # fmt: skip
    parts.append(fs.Spring(name="yaw", a="platform.fairlead_1", b=(-58.0, 1e5, -14.0), stiffness=1e5, free_length=1e5))
    return fs.Model(parts=parts, joints=model.joints, sea=model.sea, wind=model.wind)


def pole(system):
    """Complex frequency of the pitch's free decay, from a matrix pencil (Hua & Sarkar 1990) of the first 150 s after
    a small offset; the largest about the platform's pitch."""
    rest, _ = fs.solve_static(system)
    where = pose(system, rest, "platform")
    equilibrium = where[4]
    where[4] += math.radians(0.5)
    start = displace(system, rest, "platform", where)
    system.forget(start)
    run = fs.simulate(system, 150.0, 0.1, interval=0.5, state=start, tolerance=1e-9, channels=["platform_position"])
    y = run.series("platform_position")[:, 4] - equilibrium
    n, order = len(y), 8
    L = n // 3
    H = np.array([y[i : i + L + 1] for i in range(n - L)])
    V = np.linalg.svd(H, full_matrices=False)[2][:order].T
    z = np.linalg.eigvals(np.linalg.pinv(V[:-1]) @ V[1:])
    size = np.abs(np.linalg.lstsq(np.vander(z, n, increasing=True).T, y.astype(complex), rcond=None)[0])
    s = np.log(z.astype(complex)) / 0.5
    band = (s.imag > 0.15) & (s.imag < 0.35)
    return s[band][np.argmax(size[band])], rest


def test_aerodynamic_damping_is_the_surfaces(volturnus, record):
    """At 8 m/s: the pitch's pole with the rotor, against that with a spring and a dashpot at the hub that do what the
    surface's derivatives say.

    The rotor's speed is free and its torque k O^2: an axial wind u of complex frequency s gives a thrust Z(s) u with
    Z = T_u + T_O Q_u/(J s + Q_g' - Q_O), derivatives at constant pitch. At the platform's pitch frequency the speed
    follows by half, so neither of the limits holds. A spring k and a dashpot c do the same at s if c + k/s = Z.
    """
    settings = dict(moorings=False, quadratic_damping=False)
    with_rotor = without_drag(volturnus.build(wind=fs.Wind(speed=8.0), **settings))
    system = fs.assemble(with_rotor)
    s, rest = pole(system)
    batch = rotor_of(system)
    P, *surface, _, _ = batch.data[0]
    k = system.batches.index(batch)
    speed, pitch = rest.history[k][0, [SPEED, PITCH]]
    w = system.work()
    system.load(w, rest)
    system.begin(w, rest, 0.0)
    system.evaluate(w)
    u = batch.told[0, 4]
    _, Qu, Qo, _, _, Tu, To, _ = loads(*surface, P[0], P[1], u, speed, pitch)
    Z = Tu + To * Qu / (P[2] * s + 2.0 * P[5] * speed - Qo)
    spring = Z.imag / (1.0 / s).imag
    dashpot = Z.real - spring * (1.0 / s).real
    # the same force on a model without wind, of a point far away in the shaft's direction
    bare = volturnus.build(**settings)
    hub, n = batch.mounted[0].arm, w.R[0] @ batch.mounted[0].axis
    platform = bare.parts[0].model_copy(update={"points": {**bare.parts[0].points, "hub": tuple(hub)}})
    far = tuple(float(y) for y in hub + 1e5 * n)
    like = fs.Spring(name="like", a="platform.hub", b=far, stiffness=max(spring, 0.0), damping=dashpot, free_length=1e5)
    still, _ = pole(fs.assemble(without_drag(bare)))
    model = bare.model_copy(update={"parts": (platform, like)})
    as_spring, _ = pole(fs.assemble(without_drag(model)))
    got, asked = s.real - still.real, as_spring.real - still.real
    check = "VolturnUS-S with rotor, aerodynamic pitch damping at 8 m/s"
    record(check, "decay rate over that of the surface's derivatives", got / asked, (0.9, 1.1))
    record(check, "aerodynamic damping ratio", -got / abs(s), (0.05, 0.4))


def test_turned_by_120_degrees(volturnus, record):
    """Platform, moorings and nacelle look the same from 0, 120 and 240 degrees: so do mean offset and thrust."""
    found = []
    for heading in (0.0, 120.0, 240.0):
        system = fs.assemble(volturnus.build(elements=25, wind=fs.Wind(speed=12.0, heading_deg=heading, shear=SHEAR)))
        state, _ = fs.solve_static(system)
        x, y, z = state.x[0] - system.x0[0]
        c, s = math.cos(math.radians(heading)), math.sin(math.radians(heading))
        found.append((c * x + s * y, -s * x + c * y, z))
    worst = np.abs(np.array(found) - found[0]).max()
    check = "VolturnUS-S with rotor, wind turned by 120 deg"
    record(check, "change of the mean offset along the wind", worst, 0.01, "m")
