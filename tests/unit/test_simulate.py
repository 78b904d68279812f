"""The run loop: cut steps, growing back, the output grid, failure with a reason."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

import floatsim as fs


@pytest.fixture
def pendulum() -> fs.Model:
    bob = fs.PointMass(name="bob", mass=3.0, position=(1.0, 0.0, 4.0))
    spring = fs.Spring(name="spring", a="bob", b=(0.0, 0.0, 5.0), stiffness=900.0, damping=1.0, free_length=1.4)
    return fs.Model(parts=[bob, spring], sea=fs.Sea(depth=10.0))


def displaced(model: fs.Model) -> tuple[fs.System, fs.State]:
    system = fs.assemble(model)
    return system, system.initial_state()


def refusing(monkeypatch: pytest.MonkeyPatch, refuse) -> None:  # type: ignore[no-untyped-def]
    """Make steps fail where refuse(t, h) says so, leaving the state untouched as a failed step does."""
    honest = fs.Stepper.step

    def step(self, state, h, control=None):  # type: ignore[no-untyped-def]
        if refuse(state.t, h):
            return fs.StepReport(False, 12, h, 1.0, "refused by the test")
        return honest(self, state, h)

    monkeypatch.setattr(fs.Stepper, "step", step)


def test_a_failed_step_is_cut_and_grown_back_and_output_stays_on_the_grid(pendulum, monkeypatch) -> None:
    system, state = displaced(pendulum)
    plain = fs.simulate(system, 4.0, 0.02, state=state)
    refusing(monkeypatch, lambda t, h: 1.0 < t < 1.5 and h > 0.006)
    cut = fs.simulate(system, 4.0, 0.02, state=state)
    assert cut.status == "done" and cut.cut_steps > 0
    np.testing.assert_allclose(cut.time, 0.02 * np.arange(201), rtol=0.0, atol=1e-12)
    size = cut.series("step_size")
    inside, after = (cut.time > 1.05) & (cut.time < 1.5), cut.time > 1.7
    assert size[inside].max() <= 0.006  # 0.02/4 = 0.005
    assert np.all(size[after] == 0.02)
    # finer steps are more accurate, so the two differ by the error of the coarse one
    z, y = plain.series("bob_position"), cut.series("bob_position")
    fine = fs.simulate(system, 4.0, 0.001, interval=0.02, state=state)
    error = np.abs(z - fine.series("bob_position")).max()
    assert np.abs(y - fine.series("bob_position")).max() < 1.2 * error


def test_a_run_that_cannot_go_on_ends_as_failed_with_the_reason(pendulum, monkeypatch, tmp_path) -> None:
    import xarray

    system, state = displaced(pendulum)
    refusing(monkeypatch, lambda t, h: t > 1.01)
    run = fs.simulate(system, 4.0, 0.02, state=state, output=tmp_path / "run.nc")
    assert run.status == "failed" and "refused by the test" in run.failure and "t = 1.02" in run.failure
    with xarray.open_dataset(tmp_path / "run.nc") as file:
        assert file.attrs["status"] == "failed" and "refused by the test" in file.attrs["failure"]
        assert file.time.values[-1] == pytest.approx(1.02)
        assert all(np.isfinite(file[name].values).all() for name in ("bob_position", "bob_velocity"))


def test_steps_by_hand_are_the_steps_of_a_run(pendulum) -> None:
    system, state = displaced(pendulum)
    run = fs.simulate(system, 1.0, 0.05, state=state)
    for _ in range(20):
        state, report = fs.step(system, state, 0.05)
        assert report.converged
    np.testing.assert_allclose(state.x, run.state.x, rtol=0.0, atol=1e-12)
    assert dataclasses.asdict(report)["step"] == 0.05


def test_the_step_is_made_a_whole_fraction_of_the_output_interval(pendulum) -> None:
    system, state = displaced(pendulum)
    run = fs.simulate(system, 1.0, 0.03, interval=0.1, state=state)
    assert run.series("step_size")[-1] == pytest.approx(0.025)
    np.testing.assert_allclose(run.time, 0.1 * np.arange(11), atol=1e-12)


def test_steps_too_long_for_the_waves_are_refused() -> None:
    """Waves of 8 s at a step of 1 s: eight steps a period."""
    body = fs.Body(name="buoy", mass=10.0, inertia=(1.0, 1.0, 1.0))
    sea = fs.Sea(depth=50.0, waves=fs.RegularWave(height=1.0, period=8.0))
    model = fs.Model(parts=[body], joints=[fs.Weld(a="buoy", b=(0.0, 0.0, 0.0))], sea=sea)
    assert fs.simulate(model, 8.0, 0.8).status == "done"
    with pytest.raises(fs.CaseError, match=r"dt is 1 s, but 100 % of the waves' energy has periods below 10 steps"):
        fs.simulate(model, 8.0, 1.0)


def test_a_run_beyond_a_recording_that_ends_in_motion_fails_with_the_reason() -> None:
    t = np.linspace(0.0, 2.0, 81)
    bob = fs.PointMass(name="bob", mass=3.0, position=(0.0, 0.0, 4.0))

    def runs(z: np.ndarray, duration: float) -> fs.Run:
        motion = fs.Motion.from_series(t, np.stack([0.0 * t, 0.0 * t, 4.0 + z], axis=1))
        model = fs.Model(parts=[bob], joints=[fs.Prescribed(a="bob", motion=motion)], sea=fs.Sea(depth=10.0))
        return fs.simulate(model, duration, 0.02)

    moving, resting = 1.0 - np.cos(t), 1.0 - np.cos(np.pi * t)  # sine of 2 rad/s is not zero, sine of 2 pi is
    assert runs(moving, 2.0).status == "done"
    run = runs(moving, 3.0)
    assert run.status == "failed" and "the recording ends at 2 s while still moving" in run.failure
    assert runs(resting, 3.0).status == "done"


def test_an_absolute_release_keeps_the_heading_the_body_is_drawn_with() -> None:
    """Offset from the drawing position, all else as drawn: a body drawn at 37 degrees starts at 37 degrees."""
    database = Path(__file__).parents[2] / "models" / "volturnus_s_hydro.nc"
    body = fs.Body(
        name="hull", mass=1025.0 * 20206.35, inertia=(4.4e10, 4.4e10, 2.4e10), center_of_mass=(0.0, 0.0, -3.0),
        attitude_deg=(0.0, 0.0, 37.0), hydro=fs.PotentialFlow(database=database),
    )  # fmt: skip
    model = fs.Model(parts=[body], sea=fs.Sea(depth=200.0))
    test = fs.decay_test(model, "heave", 1.0, release="absolute", duration=50.0)
    start = test.run.series("hull_position")[0]
    np.testing.assert_allclose(start, [0.0, 0.0, 1.0, 0.0, 0.0, np.radians(37.0)], atol=1e-12)
