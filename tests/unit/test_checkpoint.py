"""Checkpoints: the file, what it refuses, and the identity of a model."""

from __future__ import annotations

import dataclasses
import io
import json
import os
import zipfile

import numpy as np
import pytest
from typer.testing import CliRunner

import floatsim as fs
from floatsim.cli import app
from floatsim.study import checkpoint
from floatsim.study.checkpoint import differences, identity, pack, unpack
from floatsim.study.simulate import resume


def pendulum(stiffness=50.0, mass=2.0, waves=None, law=None, depth=50.0):
    """A bob on a spring, and a law between it and the ground if wanted."""
    bob = fs.PointMass(name="bob", mass=mass, position=(1.0, 0.0, 5.0))
    rod = fs.Spring(name="rod", a="bob", b=(0.0, 0.0, 5.0), stiffness=stiffness, free_length=1.0)
    line = fs.Line(name="rope", section=fs.Section(name="rope", mass_per_length=1.0, diameter=0.02, EA=1e5),
                   length=3.0, elements=2)  # fmt: skip
    joints = [fs.Ball(a="rope.end_a", b="bob"), fs.Ball(a="rope.end_b", b=(2.0, 0.0, 5.0))]
    return fs.Model(name="pendulum", parts=[bob, rod, line], joints=joints, sea=fs.Sea(depth=depth, waves=waves))


def ran(folder, model=None, duration=1.0, **more):
    """A short run with a checkpoint; its path."""
    path = folder / "run.ckpt"
    run = fs.simulate(model or pendulum(), duration, 0.1, checkpoint=path, **more)
    assert run.status == "done"
    return path


# -- numbers there and back -----------------------------------------------------------------------


@dataclasses.dataclass
class Thing:
    a: np.ndarray
    b: float = 0.0
    c: object = None


class Open:
    def __init__(self):
        self.count, self.sums = 0, [np.zeros(2), None]


class Restorable:
    """Its insides cannot be kept, what `arrays` tells can."""

    def __init__(self):
        self.function, self.y = print, np.zeros(3)

    def arrays(self):
        return {"y": self.y}

    def restore(self, arrays):
        self.y[:] = arrays["y"]


def through_a_file(value, like, tmp_path):
    checkpoint.write(tmp_path / "x.ckpt", {"model": {}}, {"x": value})
    return checkpoint.read(tmp_path / "x.ckpt").take("x", like)


def test_every_number_comes_back(tmp_path):
    rng = np.random.default_rng(1)
    awkward = [0.1, -0.0, np.nan, np.inf, -np.inf, 5e-324, 1.7976931348623157e308, 2**63, True, None, "text"]
    awkward.append(np.float32(0.1))
    open_, like = Open(), Open()
    open_.count, open_.sums[0] = 7, rng.normal(size=2)
    kept = Restorable()
    kept.y[:] = rng.normal(size=3)
    thing = Thing(rng.normal(size=(2, 0, 3)), 1 / 3, {1: (open_, kept), "k": [np.array(3), np.array([True])]})
    empty = Thing(np.zeros((2, 0, 3)), 0.0, {1: (like, Restorable()), "k": [None, None]})
    back = through_a_file([thing, awkward], [empty, None], tmp_path)
    assert back[0] is empty and back[0].c[1][0] is like  # the objects are those made afresh
    assert back[0].b == thing.b and like.count == 7 and like.sums[1] is None
    assert like.sums[0].tobytes() == open_.sums[0].tobytes()
    assert back[0].c[1][1].y.tobytes() == kept.y.tobytes()
    assert back[0].c["k"][0].shape == () and back[0].c["k"][1].dtype == bool
    for x, y in zip(awkward, back[1], strict=True):
        assert type(x) is type(y) and repr(x) == repr(y)


def test_random_state_comes_back(tmp_path):
    one, other = np.random.default_rng(3), np.random.Generator(np.random.PCG64(99))
    one.normal(size=5)
    through = through_a_file(one, other, tmp_path)
    assert through is other and one.normal(size=4).tobytes() == other.normal(size=4).tobytes()


@pytest.mark.parametrize("value", [print, lambda: 0, np.array([object()]), io.StringIO()])
def test_what_is_no_number_is_refused(value, tmp_path):
    with pytest.raises((fs.CaseError, TypeError), match="checkpoint|kept|number"):
        checkpoint.write(tmp_path / "x.ckpt", {}, {"x": {"deep": [value]}})
    assert os.listdir(tmp_path) == []


def test_memory_of_another_shape_is_refused():
    arrays = []
    tree = pack({"a": np.zeros(3), "b": Open(), "c": 1.0}, arrays)
    for like, said in (
        ({"a": np.zeros(4), "b": Open()}, r"m\['a'\] has shape \(3,\), here it has \(4,\)"),
        ({"a": np.zeros(3), "b": Restorable()}, r"m\['b'\] is a .*Open, here it is a .*Restorable"),
        ({"a": np.zeros(3), "b": Open(), "c": [1]}, r"m\['c'\] is 1.0, here it is a list"),
    ):
        with pytest.raises(ValueError, match=said):
            unpack(tree, arrays, like, "m")


# -- the file -------------------------------------------------------------------------------------


def test_the_old_file_stays_if_the_new_one_cannot_be_written(tmp_path, monkeypatch):
    """No room, or killed before the renaming: the one before is whole, and nothing is left beside it."""
    path = ran(tmp_path)
    before = path.read_bytes()

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.warns(UserWarning, match="could not be written at t = .*No space left.*still valid"):
        run = resume(path, pendulum(), 2.0)
    assert run.status == "done" and len(run.time) == 21
    assert path.read_bytes() == before and os.listdir(tmp_path) == ["run.ckpt"]


def test_it_runs_no_code(tmp_path):
    """There is no pickle in the file: NumPy reads all of it with pickles forbidden."""
    path = ran(tmp_path)
    with np.load(path, allow_pickle=False) as file:
        assert all(file[name].dtype != object for name in file.files)


def test_files_that_are_no_checkpoints(tmp_path):
    path = ran(tmp_path)
    whole = path.read_bytes()
    for name, content, said in (
        ("text", b"hello", "no checkpoint of floatsim, or a damaged one"),
        ("short", whole[: len(whole) // 2], "no checkpoint of floatsim, or a damaged one"),
        ("empty", b"", "no checkpoint of floatsim, or a damaged one"),
        ("flipped", whole[:1000] + bytes([whole[1000] ^ 255]) + whole[1001:], "damaged"),
    ):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(fs.CaseError, match=said):
            resume(tmp_path / name, pendulum())
    with pytest.raises(fs.CaseError, match="there is no such file"):
        resume(tmp_path / "nowhere.ckpt", pendulum())
    for wrong in (None, "", 3):
        with pytest.raises(fs.CaseError, match="must be the path"):
            resume(wrong, pendulum())


def changed(path, **head):
    """The file with another header."""
    with zipfile.ZipFile(path) as file:
        arrays = {name[:-4]: np.load(io.BytesIO(file.read(name))) for name in file.namelist()}
    header = json.loads(arrays["header"].tobytes().decode()) | head
    arrays["header"] = np.frombuffer(json.dumps(header).encode(), dtype=np.uint8)
    with path.open("wb") as file:
        np.savez(file, **arrays)


def test_another_version_is_refused(tmp_path):
    path = ran(tmp_path)
    changed(path, floatsim_version="0.0.1")
    with pytest.raises(fs.CaseError, match="was written by floatsim 0.0.1, this is"):
        resume(path, pendulum())
    changed(path, format=99)
    with pytest.raises(fs.CaseError, match="has format 99, this floatsim .* reads 1"):
        resume(path, pendulum())


def test_where_a_checkpoint_may_be_written(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    for path, said in (
        (tmp_path, "is a folder"), (tmp_path / "no" / "x.ckpt", "there is no folder"), ("", "must be the path"),
        (tmp_path / "notes.txt", "exists and is no checkpoint"), (tmp_path / "out.nc", "is the output file too"),
    ):  # fmt: skip
        with pytest.raises(fs.CaseError, match=said):
            fs.simulate(pendulum(), 1.0, checkpoint=path, output=tmp_path / "out.nc")
    for every in (0.0, -1.0, np.nan, "often"):
        with pytest.raises(fs.CaseError, match="checkpoint_every"):
            fs.simulate(pendulum(), 1.0, checkpoint=tmp_path / "x.ckpt", checkpoint_every=every)
    assert sorted(os.listdir(tmp_path)) == ["notes.txt"] and (tmp_path / "notes.txt").read_text() == "mine"


# -- the model ------------------------------------------------------------------------------------


def test_identity():
    """The same description is the same model; every change is named."""
    assert identity(pendulum()) == identity(pendulum())
    for change, said in (
        ({"stiffness": 51.0}, ["part 'rod' differs"]), ({"mass": 2.5}, ["part 'bob' differs"]),
        ({"depth": 60.0}, ["sea differs"]), ({"waves": fs.RegularWave(height=1.0, period=8.0)}, ["sea differs"]),
    ):  # fmt: skip
        assert differences(identity(pendulum()), identity(pendulum(**change))) == said
    model = pendulum()
    fewer = fs.Model(name="pendulum", parts=model.parts[:2], sea=model.sea)
    assert "part 'rope' is missing" in differences(identity(model), identity(fewer))
    other = model.model_copy(update={"parts": model.parts[::-1]})
    assert differences(identity(model), identity(other)) == ["the order of parts and joints differs"]


def law(k):
    return fs.UserLaw(function=lambda t, s, v: -k * s)


def test_code_of_functions_counts():
    assert checkpoint._hash(law(2.0)) == checkpoint._hash(law(2.0)) != checkpoint._hash(law(3.0))
    one, other = fs.UserLaw(function=lambda t, s, v: -s), fs.UserLaw(function=lambda t, s, v: -v)
    assert checkpoint._hash(one) != checkpoint._hash(other)


def test_a_motion_is_the_same_before_and_after_use():
    motion = fs.Motion.at_speed((0.0, 0.0, 0.0), (10.0, 0.0, 0.0), 1.0)
    before = checkpoint._hash(motion)
    motion.translation(3.0)
    assert checkpoint._hash(motion) == before


def test_another_model_is_refused(tmp_path):
    path = ran(tmp_path)
    with pytest.raises(fs.CaseError, match="belongs to another model than 'pendulum': part 'rod' differs"):
        resume(path, pendulum(stiffness=51.0))
    with pytest.raises(fs.CaseError, match="made by no script alone"):
        resume(path)
    with pytest.raises(fs.CaseError, match="must be a floatsim.Model"):
        resume(path, "model.py")


# -- going on -------------------------------------------------------------------------------------


def test_durations(tmp_path):
    waves = fs.IrregularWaves(spectrum=fs.Jonswap(hs=1.0, tp=8.0), seed=1, omega_max=2.0, duration=3.0)
    path = ran(tmp_path, pendulum(waves=waves))
    with pytest.raises(fs.CaseError, match="is at 1 s, beyond the duration of 0.5 s"):
        resume(path, pendulum(waves=waves), 0.5)
    with pytest.raises(fs.CaseError, match="ends at 5 s, but the waves"):
        resume(path, pendulum(waves=waves), 5.0)
    with pytest.raises(fs.CaseError, match="duration: got -1"):
        resume(path, pendulum(waves=waves), -1.0)
    with pytest.raises(fs.CaseError, match="dt: got 0"):
        resume(path, pendulum(waves=waves), dt=0)
    assert resume(path, pendulum(waves=waves), 2.5).simulated_time == pytest.approx(2.5)


def test_output_files_that_do_not_belong(tmp_path):
    out, other = tmp_path / "out.nc", tmp_path / "other.nc"
    path = ran(tmp_path, output=out)
    fs.simulate(pendulum(), 0.5, 0.1, output=other)
    with pytest.raises(fs.CaseError, match="made with 11 samples until t = 1 s, the file holds 6 until 0.5 s"):
        resume(path, pendulum(), output=other)
    fs.simulate(pendulum(), 1.0, 0.1, output=other, channels=["bob_position"])
    with pytest.raises(fs.CaseError, match="cannot be continued: it has another"):
        resume(path, pendulum(), output=other)
    out.unlink()
    with pytest.raises(fs.CaseError, match="out.nc' cannot be continued"):
        resume(path, pendulum())
    assert sorted(os.listdir(tmp_path)) == ["other.nc", "run.ckpt"]


def test_a_new_run_does_away_with_the_old_checkpoint(tmp_path, monkeypatch):
    """Killed before its first checkpoint, a run must not be continued from another run's."""
    path = ran(tmp_path)

    def no(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(checkpoint, "write", no)
    with pytest.raises(KeyboardInterrupt):
        fs.simulate(pendulum(), 1.0, 0.1, checkpoint=path)
    assert not path.exists()


SCRIPT = """
import floatsim as fs

def build(stiffness=50.0):
    bob = fs.PointMass(name="bob", mass=2.0, position=(1.0, 0.0, 5.0))
    rod = fs.Spring(name="rod", a="bob", b=(0.0, 0.0, 5.0), stiffness=stiffness, free_length=1.0)
    return fs.Model(name="bob", parts=[bob, rod], sea=fs.Sea(depth=50.0))
"""


def test_command_line(tmp_path, monkeypatch):
    """run --checkpoint, resume, extended, with the model made by its script; attributes are those of one run."""
    import netCDF4

    monkeypatch.chdir(tmp_path)
    (tmp_path / "bob.py").write_text(SCRIPT)
    given = ["bob.py", "-p", "stiffness=60", "--dt", "0.05", "--interval", "0.1"]

    def call(*arguments):
        return CliRunner().invoke(app, list(arguments), catch_exceptions=False)

    assert call("run", *given, "--duration", "3", "-o", "whole.nc").exit_code == 0
    kept = ("--checkpoint", "run.ckpt", "--checkpoint-every", "0.5")
    assert call("run", *given, "--duration", "2", "-o", "part.nc", *kept).exit_code == 0
    monkeypatch.chdir(tmp_path.parent)  # paths are kept whole
    result = call("resume", str(tmp_path / "run.ckpt"), "--duration", "3")
    assert result.exit_code == 0, result.output
    with netCDF4.Dataset(tmp_path / "whole.nc") as a, netCDF4.Dataset(tmp_path / "part.nc") as b:
        assert {n: a.getncattr(n) for n in a.ncattrs()} == {n: b.getncattr(n) for n in b.ncattrs()}
        assert a.duration == 3.0
        for name in a.variables:
            np.testing.assert_array_equal(a[name][:], b[name][:])
    (tmp_path / "bob.py").write_text(SCRIPT.replace("mass=2.0", "mass=2.1"))
    with pytest.raises(fs.CaseError, match="another model than 'bob': part 'bob' differs"):
        call("resume", str(tmp_path / "run.ckpt"), "--duration", "4")
    (tmp_path / "bob.py").rename(tmp_path / "moved.py")
    with pytest.raises(fs.CaseError, match="no longer there"):
        call("resume", str(tmp_path / "run.ckpt"), "--duration", "4")
    (tmp_path / "moved.py").write_text(SCRIPT)
    moved = call("resume", str(tmp_path / "run.ckpt"), "--duration", "4", "--model", str(tmp_path / "moved.py"))
    assert moved.exit_code == 0, moved.output


def test_a_run_that_began_from_a_state(tmp_path):
    """Time goes on from the state's; the duration is counted from there."""
    begun = fs.simulate(pendulum(), 2.3, 0.1).state
    whole = fs.simulate(pendulum(), 3.0, 0.1, state=begun, energy=True)
    path = ran(tmp_path, duration=1.7, state=begun, energy=True)
    run = resume(path, pendulum(), 3.0)
    assert run.time.tobytes() == whole.time.tobytes() and run.rows.tobytes() == whole.rows.tobytes()
    assert run.energy == whole.energy and run.time[0] == begun.t
