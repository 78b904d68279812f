"""Power umbilical of models/umbilical_rm3.py under its benchmark motion, against other codes and against itself.

The reference is CableDyn 0.3.0 (cubic elements with bending, generalised-alpha) with the same sections, motion, drag
and seabed stiffness, one-metre elements, step 0.005 s: force on the support over 60..120 s, sampled every 0.1 s.
MoorDyn 2.7.2 (midpoint scheme, step 1 ms) gives 24.129, 1.434, 26.535, 21.451 kN and 0.1360 1/m, so the two differ by
0.02 % and, in curvature, by 0.5 %. The tolerances are those of codes that place mass, bending and contact differently.
"""

from functools import cache

import numpy as np
import pytest
from shipped import load

import floatsim as fs

umbilical = load("umbilical_rm3")

# kN, kN, kN, kN, 1/m; with the share that is allowed
REFERENCE = {
    "mean": (24.132, 0.01), "standard deviation": (1.435, 0.03), "maximum": (26.536, 0.01), "minimum": (21.455, 0.01),
    "largest curvature": (0.1367, 0.03),
}  # fmt: skip
STATIC = 24.517  # kN
# The same with the irregular sea of the model, 200 components: CableDyn (exact sum) and MoorDyn (on its grid) fed with
# the components of that sea; CableDyn at 0.0125 s. MoorDyn: 24.206, 1.675, 27.799, 20.578 kN, 0.1542 1/m.
IN_WAVES = {
    "mean": (24.205, 0.01), "standard deviation": (1.678, 0.03), "maximum": (27.802, 0.01), "minimum": (20.598, 0.01),
    "largest curvature": (0.1562, 0.03),
}  # fmt: skip
DURATION, FIRST = 120.0, 600  # s, sample at 60 s

ROW = "umbilical, benchmark motion"
ROW_WAVES = "umbilical, benchmark motion in irregular waves"
CHANNELS = ["hang_off_force", "umbilical_curvature"]


def run_of(model: fs.Model, dt: float, duration: float = DURATION, control: bool = True) -> fs.Run:
    run = fs.simulate(model, duration, dt, interval=0.1, channels=CHANNELS, step_control=control)
    assert run.status == "done", run.failure
    return run


@cache
def signals(dt: float, elements_per_metre: float = 1.0, waves: str | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Force on the support [kN], largest curvature [1/m], every 0.1 s from 60 s on; the value at rest comes first."""
    # no ramp: the waves of the peers have none, and 60 s are enough to forget the start
    run = run_of(umbilical.build(elements_per_metre=elements_per_metre, waves=waves, wave_ramp=0.0), dt)
    force = np.linalg.norm(run.series("hang_off_force"), axis=1) / 1e3
    curvature = run.series("umbilical_curvature").max(axis=1)
    keep = np.r_[0, FIRST : len(force)]
    return force[keep], curvature[keep]


def test_motion_is_smooth_where_the_ramp_ends():
    """Velocity and acceleration are the derivatives of the position on both sides of 20 s."""
    motion = umbilical.benchmark_motion()
    h = 1e-5
    for t in (0.1, 7.3, 19.9, 20.1, 63.2):
        (before, v0, _), (after, v1, _) = motion.translation(t - h), motion.translation(t + h)
        _, v, a = motion.translation(t)
        np.testing.assert_allclose((after - before) / (2.0 * h), v, atol=1e-7)
        np.testing.assert_allclose((v1 - v0) / (2.0 * h), a, atol=1e-7)
    jump = motion.translation(20.0 + 1e-9)[1] - motion.translation(20.0 - 1e-9)[1]
    np.testing.assert_allclose(jump, 0.0, atol=1e-8)


def test_at_rest(record):
    force = signals(0.1)[0][0]
    record(ROW, f"force on the support at rest (CableDyn {STATIC:g} kN): difference",
           100.0 * abs(force / STATIC - 1.0), 0.5, "%")  # fmt: skip


@pytest.mark.parametrize("quantity", list(REFERENCE))
@pytest.mark.parametrize("waves", [None, "storm"])
def test_against_cabledyn(record, quantity, waves):
    force, curvature = (signal[1:] for signal in signals(0.1, waves=waves))
    got = {
        "mean": force.mean(), "standard deviation": force.std(), "maximum": force.max(), "minimum": force.min(),
        "largest curvature": curvature.max(),
    }[quantity]  # fmt: skip
    reference, share = (REFERENCE if waves is None else IN_WAVES)[quantity]
    unit = "1/m" if "curvature" in quantity else "kN"
    title = f"{quantity} (CableDyn {reference:g} {unit}): difference"
    record(ROW if waves is None else ROW_WAVES, title, 100.0 * abs(got / reference - 1.0), 100.0 * share, "%")


def test_step(record):
    """0.1 s against a converged step, and against half of it."""
    force, half, fine = (signals(dt)[0][1:] for dt in (0.1, 0.05, 0.0125))
    rms = float(np.sqrt(np.mean((force - fine) ** 2)) / fine.mean())
    record(ROW, "step 0.1 s against 0.0125 s: rms of the force, share of its mean", 100.0 * rms, 0.1, "%")
    change = float(np.abs(force - half).max() / np.ptp(half))
    record(ROW, "step halved from 0.1 s: largest change of the force, share of its range", 100.0 * change, 0.2, "%")


def test_elements(record):
    (force, curvature), (fine, sharper) = ([s[1:] for s in signals(0.05, density)] for density in (1.0, 2.0))
    change = float(np.abs(force - fine).max() / np.ptp(fine))
    record(ROW, "elements halved from 1 m: largest change of the force, share of its range", 100.0 * change, 1.0, "%")
    peak = abs(float(curvature.max() / sharper.max()) - 1.0)
    record(ROW, "elements halved from 1 m: change of the largest curvature", 100.0 * peak, 2.0, "%")


def test_recorded_motion_is_the_benchmark_motion(record, tmp_path):
    """A recording of the same motion, 0.1 s between samples and 9 digits, gives the same force.

    Without step control: one step more or less after the end of the ramp, where the acceleration jumps, is 0.2 %."""
    motion = umbilical.benchmark_motion((0.0, 0.0, 0.0), 6)
    time = np.arange(0.0, 40.05, 0.1)
    rows = np.column_stack([time, [np.concatenate([motion.translation(t)[0], np.zeros(3)]) for t in time]])
    path = tmp_path / "recorded.txt"
    np.savetxt(path, rows, fmt="%.9f", header="time [s], x, y, z [m], roll, pitch, yaw [deg]", delimiter=", ")
    force = [
        run_of(umbilical.build(motion=name), 0.1, 38.0, False).series("hang_off_force")
        for name in ("benchmark", str(path))
    ]
    apart = np.linalg.norm(force[0] - force[1], axis=1)[10:].max() / np.linalg.norm(force[0], axis=1).mean()
    record(ROW, "recorded motion against the functions: largest difference of the force", 100.0 * apart, 0.01, "%")


@pytest.mark.parametrize("rows", ["1 2 3\n2 3 4\n", "one two\n", None])
def test_a_recording_that_is_none_is_refused(tmp_path, rows):
    path = tmp_path / "recorded.txt"
    if rows is not None:
        path.write_text(rows)
    with pytest.raises(fs.ModelError, match="recorded.txt"):
        umbilical.build(motion=str(path))


def test_pitching_device_turns_the_clamp(tmp_path):
    """A device that pitches by 5 deg about its reference point moves hang-off and clamp with it."""
    turn, time = np.radians(5.0), np.arange(0.0, 60.05, 0.5)
    pitch = 5.0 * 0.5 * (1.0 - np.cos(np.pi * np.clip(time / 20.0, 0.0, 1.0)))
    zero = np.zeros_like(time)
    path = tmp_path / "pitch.txt"
    np.savetxt(path, np.column_stack([time, zero, zero, zero, zero, pitch, zero]))
    model = umbilical.build(motion=str(path), ends="clamped")
    run = fs.simulate(model, 60.0, 0.1, interval=1.0, channels=["umbilical_position"])
    assert run.status == "done", run.failure
    top = run.series("umbilical_position")[-1]
    depth = umbilical.HANG_OFF[2]
    np.testing.assert_allclose(top[0], [depth * np.sin(turn), 0.0, depth * np.cos(turn)], atol=1e-3)
    # rotation about +y turns the downward direction towards -x
    direction = np.array(umbilical.HANG_OFF_DIRECTION)
    c, s = np.cos(turn), np.sin(turn)
    turned = np.array([c * direction[0] + s * direction[2], 0.0, -s * direction[0] + c * direction[2]])
    leaves = (top[1] - top[0]) / np.linalg.norm(top[1] - top[0])
    apart = np.degrees(np.arccos(leaves @ turned / np.linalg.norm(turned)))
    assert apart < 2.0  # half an element bends between clamp and its middle; without the turn it would be 5 deg more


def test_stiffener_hangs_with_its_weight_and_buoyancy(record):
    """The hang-off carries the cone's wet weight more than that of the clamped cable without it (closed form)."""
    down = {}
    for ends in ("clamped", "stiffener"):
        run = fs.simulate(umbilical.build(motion="still", ends=ends), 0.1, 0.1, channels=["hang_off_force"])
        down[ends] = -run.series("hang_off_force")[0, 2]
    (root, tip), inner, length = umbilical.STIFFENER_DIAMETER, 0.176, umbilical.STIFFENED_LENGTH
    # mass per length is straight from root to tip, the displaced area is that of a straight cone
    ends_mass = [umbilical.STIFFENER_DENSITY * np.pi / 4.0 * (D**2 - inner**2) for D in (root, tip)]
    displaced = np.pi / 4.0 * ((root**2 + root * tip + tip**2) / 3.0 - inner**2)
    weight = umbilical.GRAVITY * length * (sum(ends_mass) / 2.0 - umbilical.DENSITY * displaced)
    added = down["stiffener"] - down["clamped"]
    record("umbilical, bend stiffener", "wet weight of the cone in the support's force: difference",
           100.0 * abs(added / weight - 1.0), 2.0, "%")  # fmt: skip


def test_first_sample_does_not_depend_on_the_step(record):
    """At t = 0 the moving end has velocity zero and the acceleration of the ramp: all elements pull as at rest."""
    tension = [
        fs.simulate(umbilical.build(), 3.0 * dt, dt, step_control=False).series("umbilical_tension")[0]
        for dt in (0.01, 2.0)
    ]
    apart = float(np.abs(tension[0] - tension[1]).max() / tension[0].max())
    record(ROW, "first sample of the tension, step 2 s against 0.01 s", 100.0 * apart, 0.1, "%")
