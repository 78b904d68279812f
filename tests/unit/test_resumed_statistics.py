"""Statistics of a run that was stopped and resumed are those of one that was not, bit for bit."""

import pytest
import xarray

import floatsim as fs
from floatsim.study.simulate import resume, simulate
from floatsim.study.statistics import StatisticsSettings


@pytest.mark.parametrize("keep", [True, False])
@pytest.mark.parametrize("first", [3.0, 13.0])
def test_resumed_and_extended(tmp_path, keep, first):
    section = fs.Section(name="chain", mass_per_length=20.0, diameter=0.05, EA=1e7, axial_damping=1e4, drag_normal=1.2)
    line = fs.Line(name="rope", section=section, length=60.0, elements=6)
    sea = fs.Sea(depth=30.0, waves=fs.RegularWave(height=3.0, period=8.0), wave_ramp=5.0)
    ends = [fs.Ball(a="rope.end_a", b=(0.0, 0.0, -30.0)), fs.Ball(a="rope.end_b", b=(45.0, 0.0, -2.0))]
    model = fs.Model(parts=[line], joints=ends, sea=sea)
    asked = StatisticsSettings(start=2.0, block=4.0, fatigue={"rope_tension": 3.0})
    whole = simulate(model, 20.0, 0.1, statistics=asked, keep_series=keep)
    part = simulate(model, first, 0.1, statistics=asked, keep_series=keep, checkpoint=tmp_path / "run.ckpt")
    assert part.statistics.samples == round(10 * first) - 19
    run = resume(tmp_path / "run.ckpt", model, 20.0)
    assert run.kept == keep
    xarray.testing.assert_identical(run.statistics.dataset(), whole.statistics.dataset())
