"""Step control by local error, where a step that converges happily would smear what happens within it."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import floatsim as fs

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "models"))
from volturnus_s import chain  # noqa: E402

ANCHOR, FAIRLEAD = (-837.6, 0.0, -200.0), (-58.0, 0.0, -14.0)
SPEED = 2.0  # m/s


def snapped(dt: float, control: bool) -> fs.Run:
    """The mooring chain of VolturnUS-S, its fairlead 5 m slack, pulled out at 2 m/s from one instant to the next."""
    line = fs.Line(name="chain", section=chain(), length=850.0, elements=50)
    start, way = np.array(FAIRLEAD) - (5.0, 0.0, 0.0), np.array([1.0, 0.0, 0.0])
    jerk = 0.02  # s, in which the end takes on its speed

    def position(t: float) -> np.ndarray:
        return start + SPEED * way * (0.5 * t * t / jerk if t < jerk else t - 0.5 * jerk)

    motion = fs.Motion(
        position, lambda t: SPEED * way * min(t / jerk, 1.0), lambda t: SPEED * way * (1.0 / jerk if t < jerk else 0.0)
    )
    model = fs.Model(
        name="snap", parts=[line], sea=fs.Sea(depth=200.0),
        joints=[fs.Ball(a="chain.end_a", b=ANCHOR), fs.Prescribed(a="chain.end_b", motion=motion, name="top")],
    )  # fmt: skip
    return fs.simulate(model, 25.0, dt, interval=0.1, step_control=control)


def test_snap_load_of_a_chain(record):
    """Output every 0.1 s: step control finds the peaks of a run at 1 ms, a plain run at 0.1 s does not.

    For the impact an elastic bar gives T0 + v sqrt(EA m) at most (d'Alembert, m with the tangential added mass); the
    sag takes some of it up.
    """
    fine, controlled, plain = snapped(1e-3, False), snapped(0.1, True), snapped(0.1, False)
    force = [np.linalg.norm(run.series("top_force"), axis=1) for run in (fine, controlled, plain)]
    assert controlled.status == "done" and controlled.cut_steps > 0 and controlled.steps < 1500
    impact = fine.time < 2.0
    check = "snap load of an 850 m chain pulled at 2 m/s, against a step of 1 ms"
    for name, part in (("impact", impact), ("taut, after 25 s", ~impact)):
        peak = [float(f[part].max()) for f in force]
        record(check, f"{name}: peak force, step control", 100.0 * abs(peak[1] / peak[0] - 1.0), 5.0, "%")
    assert abs(force[2][impact].max() / force[0][impact].max() - 1.0) > 0.2  # what it is there for
    water = 1025.0 * chain().area * chain().added_mass_tangential
    bar = force[0][0] + SPEED * np.sqrt(chain().EA * (chain().mass_per_length + water))
    record(check, "impact: peak over T0 + v sqrt(EA m)", float(force[0][impact].max() / bar), 1.0)
    whole = np.sqrt(np.mean((force[1] - force[0]) ** 2)) / np.ptp(force[0])
    record(check, "whole run: rms difference over the range", 100.0 * whole, 1.0, "%")


def test_without_lines_there_is_nothing_to_control():
    """A pendulum steps as asked, and its results do not depend on the switch."""
    mass = fs.PointMass(name="bob", mass=2.0, position=(1.0, 0.0, 5.0))
    rod = fs.Spring(name="rod", a="bob", b=(0.0, 0.0, 5.0), stiffness=1e4, free_length=1.0)
    model = fs.Model(parts=[mass, rod], sea=fs.Sea(depth=50.0))
    state = fs.assemble(model).initial_state()
    runs = [fs.simulate(model, 2.0, 0.01, state=state, step_control=on) for on in (True, False)]
    assert runs[0].steps == runs[1].steps == 200
    np.testing.assert_array_equal(runs[0].series("bob_position"), runs[1].series("bob_position"))


def test_motion_at_constant_speed():
    """Two ramps of 10 s and 40 m at 0.5 m/s: 70 s + 10 s in all; the speed is kept in between."""
    motion = fs.Motion.at_speed((0.0, 0.0, -20.0), (24.0, 0.0, -52.0), 0.5)
    way = np.array([0.6, 0.0, -0.8])
    p, v, a = motion.translation(45.0)
    np.testing.assert_allclose(p, np.array([0, 0, -20.0]) + 0.5 * (45.0 - 5.0) * way, atol=1e-12)
    np.testing.assert_allclose(v, 0.5 * way, atol=1e-15)
    assert not a.any()
    for t in (90.0, 500.0):
        np.testing.assert_allclose(motion.translation(t)[0], (24.0, 0.0, -52.0), atol=1e-12)
        assert not motion.translation(t)[1].any()
    short = fs.Motion.at_speed((0, 0, 0), (1.0, 0, 0), 0.5)  # ramps of 2 s each
    np.testing.assert_allclose(short.translation(2.0)[0][0], 0.5, atol=1e-12)
    np.testing.assert_allclose(short.translation(2.0)[1][0], 0.5, atol=1e-12)


@pytest.mark.parametrize("bad", [{"speed": 0.0}, {"speed": float("nan")}, {"ramp": -1.0}, {"end": (1.0, 2.0)}])
def test_motion_at_constant_speed_refuses(bad):
    with pytest.raises(fs.ModelError, match="Motion.at_speed: got start"):
        fs.Motion.at_speed(**({"start": (0.0, 0.0, 0.0), "end": (1.0, 0.0, 0.0), "speed": 1.0} | bad))


def test_a_line_laid_by_its_moving_end_finds_the_static_shape(record):
    """The end goes from where the cable hangs steeply to its place at 2 m/s, as Verelst et al. (2024) initialise
    HAWC2. What is left of the swing dies of quadratic drag, as 1/t: twice the time, half the distance to the
    equilibrium that statics find at once."""
    from lazy_wave import build

    still = build()
    system = fs.assemble(still)
    there, _ = fs.solve_static(system)
    anchor = there.x[system.n_point - 1]
    top = there.x[0]
    line = still.parts[0]
    motion = fs.Motion.at_speed(top + (30.0, 0.0, 0.0), top, 2.0)
    joints = [fs.Prescribed(a="cable.end_a", motion=motion, name="top"), fs.Ball(a="cable.end_b", b=tuple(anchor))]
    run = fs.simulate(fs.Model(parts=[line], joints=joints, sea=still.sea), 820.0, 0.1, interval=5.0)
    gap = np.abs(run.series("cable_position") - there.x[: len(line.arc_length)]).max(axis=(1, 2))
    check = "shape found by a moving end"
    early, late = gap[(run.time > 150) & (run.time < 220)].max(), gap[run.time > 750].max()
    record(check, "distance from the static shape after 800 s over that after 200 s (drag: 1/4)", late / early, 0.3)
    record(check, "largest distance from the static shape after 800 s, a twentieth of an element", late, 0.05, "m")
