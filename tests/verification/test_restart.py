"""Checkpoints: a resumed run is the uninterrupted one, bit for bit, wherever it was stopped and however."""

from __future__ import annotations

import os
import random
import shutil
import subprocess
import sys
import time
from pathlib import Path

import netCDF4
import numpy as np
import pytest
from restart_scenarios import SCENARIOS, snapping

import floatsim as fs
from floatsim.study import checkpoint
from floatsim.study import simulate as simulation
from floatsim.study.simulate import resume

TESTS = Path(__file__).parents[1]
CHECK = "restart from a checkpoint"


def content(path):
    """Everything in a file: attributes, and variables with theirs."""
    with netCDF4.Dataset(str(path)) as file:
        file.set_auto_mask(False)
        def told(item):
            return {name: item.getncattr(name) for name in item.ncattrs()}
        return told(file), {name: (told(v), v.dtype, np.asarray(v[:])) for name, v in file.variables.items()}


def differing(path, other):
    """Names of what is not the same in two files, to the last bit."""
    (a, mine), (b, theirs) = content(path), content(other)
    found = [name for name in {*a, *b} if a.get(name) != b.get(name)]
    for name in {*mine, *theirs}:
        if name not in mine or name not in theirs:
            found.append(name)
            continue
        (x, kind, u), (y, type_, v) = mine[name], theirs[name]
        if str(x) != str(y) or kind != type_ or u.shape != v.shape or u.tobytes() != v.tobytes():
            if kind is str and list(u) == list(v):
                continue
            found.append(name)
    return sorted(found)


def memory(path):
    """All that a checkpoint remembers, as text."""
    saved = checkpoint.read(path)
    return repr((saved.tree, [(a.dtype, a.shape, a.tobytes()) for a in saved.arrays]))


def fresh(*arguments, **more):
    """restart_scenarios.py in a process of its own."""
    env = os.environ | {"PYTHONPATH": os.pathsep.join([str(TESTS.parent), str(TESTS)])}
    return subprocess.Popen([sys.executable, str(TESTS / "restart_scenarios.py"), *arguments], env=env, **more)


@pytest.mark.parametrize("name", SCENARIOS)
def test_resumed_in_a_fresh_process(name, tmp_path, monkeypatch, record):
    """From every checkpoint of a run, against one that kept none; the file as it was then, or whole."""
    build, how = SCENARIOS[name]
    plain, kept, copies = tmp_path / "plain.nc", tmp_path / "kept.nc", tmp_path / "copies"
    copies.mkdir()
    without = fs.simulate(build(), **{k: v for k, v in how.items() if k != "checkpoint_every"}, output=plain)
    assert without.status == "done", without.failure
    write = checkpoint.write

    def copying(path, header, memory):
        write(path, header, memory)
        k = len(list(copies.glob("*.ckpt")))
        shutil.copy(path, copies / f"{k:02d}.ckpt")
        shutil.copy(kept, copies / f"{k:02d}.nc")

    monkeypatch.setattr(checkpoint, "write", copying)
    fs.simulate(build(), **how, output=kept, checkpoint=tmp_path / "run.ckpt")
    assert differing(plain, kept) == []  # keeping checkpoints changes nothing
    places = sorted(copies.glob("*.ckpt"))
    assert len(places) >= 5
    shutil.copy(kept, places[2].with_suffix(".nc"))  # samples after the checkpoint are there already
    with fresh("resume", name, str(copies)) as process:
        assert process.wait() == 0
    same = {path.stem: differing(plain, path.with_suffix(".nc")) for path in places}
    assert not any(same.values()), same
    assert len({memory(path) for path in places}) == 1  # each goes on to its end: so does all that they remember
    record(CHECK, f"{name}: resumed runs whose file differs", sum(map(bool, same.values())), 0)


def test_steps_are_cut_where_the_snapping_chain_is_stopped(tmp_path):
    """The scenario is worth its name: a checkpoint in the middle of cut steps, another after the line has parted."""
    fs.simulate(snapping(), 5.0, 0.1, checkpoint=tmp_path / "cut.ckpt")
    assert checkpoint.read(tmp_path / "cut.ckpt").take("loop", None)["level"] > 0
    run = resume(tmp_path / "cut.ckpt", snapping(), 7.0)
    assert any(isinstance(h, dict) and h["broken"].all() for h in run.state.history.values())


@pytest.mark.parametrize("name", ["snapping", "converter"])
def test_extended_beyond_its_end(name, tmp_path, record):
    """Half a run, then the whole: the file is that of the whole run, twice extended; and without a file."""
    build, how = SCENARIOS[name]
    how = {k: v for k, v in how.items() if k != "checkpoint_every"}
    whole = fs.simulate(build(), **how, output=tmp_path / "whole.nc")
    total = how.pop("duration")
    fs.simulate(build(), 0.43 * total, **how, output=tmp_path / "part.nc", checkpoint=tmp_path / "part.ckpt")
    resume(tmp_path / "part.ckpt", build(), 0.71 * total)
    last = resume(tmp_path / "part.ckpt", build(), total)
    record(CHECK, f"{name}: entries of a twice extended file that differ from one run's",
           len(differing(tmp_path / "whole.nc", tmp_path / "part.nc")), 0)  # fmt: skip
    for counter in ("steps", "cut_steps", "newton_iterations"):
        assert getattr(last, counter) == getattr(whole, counter)
    fs.simulate(build(), 0.43 * total, **how, checkpoint=tmp_path / "memory.ckpt")
    kept = resume(tmp_path / "memory.ckpt", build(), total)
    assert kept.path is None and kept.time.tobytes() == whole.time.tobytes()
    channel = kept.sampler.channels[0].name
    assert kept.series(channel).tobytes() == whole.series(channel).tobytes()
    again = resume(tmp_path / "memory.ckpt", build())  # a run that is done is done
    assert again.status == "done" and again.rows.tobytes() == kept.rows.tobytes() and again.steps == kept.steps


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="needs SIGKILL")
@pytest.mark.parametrize("name", ["snapping, energy, uneven", "latched, float32, few channels"])
def test_killed_at_random_moments(name, tmp_path, record):
    """kill -9 again and again, each time resumed from what is there: the file at the end is that of one run."""
    build, how = SCENARIOS[name]
    fs.simulate(build(), **{k: v for k, v in how.items() if k != "checkpoint_every"}, output=tmp_path / "plain.nc")
    (tmp_path / "killed").mkdir()
    folder, moments = str(tmp_path / "killed"), random.Random(7)
    path, part = tmp_path / "killed" / "run.ckpt", tmp_path / "killed" / ".run.nc.part"
    kills, what = 0, "run"
    while kills < 10:
        before = path.stat().st_mtime_ns if path.exists() else 0
        with fresh(what, name, folder) as process:
            while process.poll() is None and (path.stat().st_mtime_ns if path.exists() else 0) == before:
                if kills % 3 == 2 and part.exists():  # while the output file is cut back
                    break
                time.sleep(0.001)
            time.sleep(moments.uniform(0.0, 0.1))
            done = process.poll() is not None
            process.kill()
        assert not done or process.returncode == 0
        kills += not done
        what = "run" if done else "go_on"
    with fresh("go_on", name, folder) as process:
        assert process.wait() == 0
    different = differing(tmp_path / "plain.nc", tmp_path / "killed" / "run.nc")
    record(CHECK, f"{name}: entries that differ after 10 kills", len(different), 0)


def test_failed_run_goes_on_with_shorter_steps(tmp_path, monkeypatch):
    """The checkpoint of a failed run is its last good state, which need not be on an output; what failed there fails
    again, shorter steps get through, and the samples stay on their grid."""
    step = fs.Stepper.step

    def stubborn(self, state, h, control=None):
        if h > 0.003 and 3.03 < state.t + h < 3.2:
            return fs.StepReport(False, 1, h, 1.0, "does not want to")
        return step(self, state, h, control)

    monkeypatch.setattr(fs.Stepper, "step", stubborn)
    monkeypatch.setattr(simulation, "MAX_CUTS", 3)
    path, nc = tmp_path / "run.ckpt", tmp_path / "run.nc"
    failed = fs.simulate(snapping(), 6.0, 0.1, interval=0.4, step_control=False, output=nc, checkpoint=path)
    assert failed.status == "failed" and failed.state.t == pytest.approx(3.025)  # outputs at 2.8, 3.2
    assert checkpoint.read(path).header["failure"] == failed.failure
    again = resume(path, snapping())
    assert again.status == "failed" and again.state.t < 3.03
    assert content(nc)[0]["status"] == "failed"
    through = resume(path, snapping(), dt=0.02)
    assert through.status == "done", through.failure
    attributes, variables = content(nc)
    assert attributes["status"] == "done" and attributes["failure"] == ""
    np.testing.assert_array_equal(variables["time"][2], 0.4 * np.arange(16))
    monkeypatch.undo()
    fine = fs.simulate(snapping(), 6.0, 0.02, interval=0.4, step_control=False)
    apart = np.abs(variables["chain_position"][2] - fine.series("chain_position"))
    assert apart.mean() < 0.05 and apart.max() < 3.0  # m; 0.1 s does not resolve the snaps before
