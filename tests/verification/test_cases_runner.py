"""The runner of load cases under fire: kills, hangs, divergence, full disks, other numbers of workers, a Dask cluster.

The model is a pendulum on a hinge with a brake from a Python function, in which a case can do any mischief at t = 2 s.
"""

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from made_up_rotor import rotor
from second_order import RHO, database, synthetic

import floatsim as fs
from floatsim.cases.case import Case, RunSettings
from floatsim.cases.folder import Folder
from floatsim.cases.run_case import equilibrium, model_of, run_case, static_key
from floatsim.cases.runner import run
from floatsim.study import checkpoint
from floatsim.study.script import load_model

posix = pytest.mark.skipif(os.name != "posix", reason="needs SIGKILL")

SCRIPT = '''
import ctypes, os, signal, time
import floatsim as fs

def build(angle_deg=30.0, fault="", pause=0.0):
    if fault == "raise":
        raise ValueError("no such pendulum")
    if fault == "memory":
        raise MemoryError("no room for a pendulum")
    if fault == "input":
        input("how long is it? ")
    if fault == "elsewhere":
        os.chdir("/")
    if fault == "no text":
        raise ValueError("file " + chr(0xDCFF))
    if fault == "orphan":
        if os.fork() == 0:
            time.sleep(1000)  # holds all pipes
        os.kill(os.getpid(), signal.SIGKILL)
    def brake(t, s, v):
        if t > 2.0:
            if fault == "kill":
                os.kill(os.getpid(), signal.SIGKILL)
            if fault == "hang":
                ctypes.PyDLL(None).sleep(1000)  # holds the lock of the interpreter, as compiled code does
            if fault == "diverge":
                return 1e3 * v**3
        if pause:
            time.sleep(pause)
        return -0.2 * v
    rod = fs.Body(name="rod", mass=10.0, inertia=(3.4, 3.4, 0.01), center_of_mass=(0.0, 0.0, -1.0),
                  position=(0.0, 0.0, 5.0), attitude_deg=(0.0, 0.0, 0.0))
    hinge = fs.Hinge(name="hinge", a="rod", b=(0.0, 0.0, 5.0), axis=(0.0, 1.0, 0.0))
    push = fs.UserLaw(function=lambda t, s, v: 20.0 * angle_deg / 30.0 if t < 1.0 else 0.0)
    laws = [fs.UserLaw(function=brake), push]
    return fs.Model(name="pendulum", parts=[rod, fs.PTO(name="brake", joint="hinge", laws=laws)], joints=[hinge],
                    sea=fs.Sea(depth=10.0))
'''
RUNNER = """
import json, sys
from floatsim.cases.case import Case
from floatsim.cases.runner import run
cases = [Case.from_dict(data) for data in json.load(open(sys.argv[1]))]
sys.exit(run(cases, sys.argv[2], jobs=int(sys.argv[3])).exit_status)
"""
FAULTS = {4: "diverge", 11: "raise", 18: "kill", 30: "hang"}
REASONS = {"diverge": "diverged", "raise": "raised", "kill": "killed", "hang": "timed out"}
LIMIT = 3.0  # s, of the case that hangs


@pytest.fixture
def script(tmp_path):
    path = tmp_path / "pendulum_with_faults.py"
    path.write_text(SCRIPT)
    return path


def case(script, number, fault="", duration=8.0, pause=0.0, **settings):
    own = {"angle_deg": 5.0 + number, "fault": fault, "pause": pause}
    limit = LIMIT if fault == "hang" else None
    run = RunSettings(duration=duration, ramp=2.0, dt=0.05, keep="series", precision="float64", time_limit=limit)
    return Case(number, f"p{number:02d}", {"angle_deg": 5.0 + number}, str(script), own, {}, run, "0")


def contents(folder, cases):
    """Bytes of all numbers of finished cases: identity -> file -> variable -> bytes."""
    out = {}
    for item in cases:
        for path in (folder.series(item.id), folder.statistics(item.id)):
            with xr.open_dataset(path) as data:
                out[path.name] = {name: numbers(v.values) for name, v in data.variables.items()}
    return out


def numbers(values):
    return values.tolist() if values.dtype.kind == "O" else values.tobytes()


def said(folder, item):
    """What the log of a case says of its beginnings and ends, in order."""
    words = r"(?m)^\S+ \S+ (started|done in|diverged|raised|killed|timed out)"
    return re.findall(words, folder.log(item.id).read_text())


def start_runner(cases, folder, tmp_path, jobs=2):
    listed = tmp_path / "cases.json"
    listed.write_text(json.dumps([item.as_dict() for item in cases]))
    return subprocess.Popen([sys.executable, "-c", RUNNER, str(listed), str(folder.path), str(jobs)],
                            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)  # fmt: skip


def wait_for(condition, process=None, limit=120.0):
    end = time.monotonic() + limit
    while not condition():
        assert time.monotonic() < end, "waited too long"
        if process is not None and process.poll() is not None:
            raise AssertionError(process.stderr.read())
        time.sleep(0.02)


def children(pid):
    """Processes started by `pid` that live."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[1]) == pid and fields[0] != "Z":
            found.append(int(path.parent.name))
    return found


def alive(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@posix
@pytest.mark.slow
def test_fault_drill(script, tmp_path, record):
    cases = [case(script, k, FAULTS.get(k, "")) for k in range(40)]
    good = [item for k, item in enumerate(cases) if k not in FAULTS]
    calm = Folder(tmp_path / "calm")
    summary = run(good[::-1], calm.path, jobs=1, say=lambda line: None)
    assert (summary.done, summary.exit_status) == (36, 0), summary.lines()

    folder = Folder(tmp_path / "drill")
    with start_runner(cases, folder, tmp_path) as runner:
        wait_for(lambda: len(folder.done()) >= 12, runner)
        workers = children(runner.pid)
        runner.kill()
    finished = folder.done()
    if sys.platform == "linux":
        assert workers
        wait_for(lambda: not any(map(alive, workers)), limit=10.0)
    with start_runner(cases, folder, tmp_path) as runner:
        said_last = runner.stderr.read()
    assert runner.returncode == 1, said_last

    check = "load cases: fault drill of 40"
    record(check, "cases done of those without a fault", len(folder.done()), (36, 36))
    disturbed, undisturbed = contents(folder, good), contents(calm, good)
    same = sum(disturbed[name] == undisturbed[name] for name in undisturbed)
    record(check, "files bit for bit those of an undisturbed run by one worker in reverse order", same, (72, 72))
    failed = folder.failed()
    right = sum(failed[cases[k].id].kind == REASONS[fault] for k, fault in FAULTS.items())
    record(check, "failures recorded with the right reason", right, (4, 4))
    assert len(failed) == 4
    again = sum("started" in said(folder, item)[2:] for item in cases if item.id in finished)
    twice = sum(said(folder, item).count("started") > 1 for item in cases)
    ends = sum(len([word for word in said(folder, item) if word != "started"]) for item in cases)
    record(check, "finished cases that ran again after the runner was killed", again, 0)
    record(check, "cases begun twice (those under way when it was killed)", twice, 2)
    assert ends == 40
    assert 1.5 <= failed[cases[18].id].time_reached + 2.0 <= 4.5  # noted once a second of wall clock
    assert "SIGKILL" in failed[cases[18].id].message
    assert "brake" in folder.log(cases[30].id).read_text()  # the stack: where it hung
    assert "no such pendulum" in failed[cases[11].id].message
    assert "Traceback" in folder.log(cases[11].id).read_text()
    for k in (4, 18, 30):  # diverged; killed; hung
        assert checkpoint.read(folder.failures / f"{cases[k].id}.ckpt").header["output"]
    with xr.open_dataset(folder.failures / f"{cases[4].id}.nc") as data:
        assert data.sizes["time"] > 35 and data.attrs["status"] == "failed"
    assert not any(folder.running.iterdir())


@posix
def test_stopped_by_a_signal_and_resumed(script, tmp_path):
    cases = [case(script, k, pause=0.0003) for k in range(4)]
    folder = Folder(tmp_path / "results")
    with start_runner(cases, folder, tmp_path) as runner:
        wait_for(lambda: len(folder.under_way()) == 2 and folder.done(), runner)
        workers = children(runner.pid) if sys.platform == "linux" else []
        with pytest.raises(fs.CaseError, match=rf"in use by process {runner.pid} of .* on "):
            run(cases, folder.path)
        assert folder.owner()["pid"] == runner.pid
        runner.send_signal(signal.SIGTERM)
        runner.wait(timeout=20.0)
    assert runner.returncode != 0
    assert not any(map(alive, workers))
    assert folder.owner() is None
    before = {name: folder.statistics(name).stat().st_mtime_ns for name in folder.done()}
    summary = run(cases, folder.path, jobs=2, say=lambda line: None)
    assert (summary.done, summary.ran, summary.exit_status) == (4, 4 - len(before), 0)
    assert all(folder.statistics(name).stat().st_mtime_ns == t for name, t in before.items())


def test_failed_cases_are_run_again_when_asked(script, tmp_path):
    cases = [case(script, 1), case(script, 2, "raise")]
    folder = Folder(tmp_path / "results")
    first = run(cases, folder.path, jobs=1, say=lambda line: None)
    assert (first.done, len(first.failed), first.exit_status) == (1, 1, 1)
    second = run(cases, folder.path, jobs=1, say=lambda line: None)
    assert (second.ran, second.exit_status) == (0, 1)
    script.write_text(SCRIPT.replace('raise ValueError("no such pendulum")', "pass"))
    third = run(cases, folder.path, jobs=1, again=True, say=lambda line: None)
    assert (third.ran, third.done, third.exit_status) == (1, 2, 0)
    assert not list(folder.failures.iterdir())


def test_case_is_the_run_that_its_model_gives(script, tmp_path, record):
    folder = Folder(tmp_path / "results")
    folder.prepare()
    item = case(script, 7)
    assert run_case(item, folder.path).status == "done"
    plain = fs.simulate(load_model(script, dict(item.parameters)), 10.0, 0.05)
    with xr.open_dataset(folder.series(item.id)) as data:
        channels = [c.name for c in plain.sampler.channels if c.dtype == "float"]
        same = all(data[name].values.tobytes() == plain.series(name).tobytes() for name in channels)
        assert data.attrs["case_id"] == item.id and data.attrs["case_angle_deg"] == 12.0
    record("load cases", "a case's series are those of a plain run, bit for bit", same, "yes", holds=same)


def test_full_disk_stops_the_runner_and_fails_no_case(script, tmp_path, monkeypatch):
    folder = Folder(tmp_path / "results")
    cases = [case(script, k) for k in range(4)]
    room = iter([1e9] * 4)  # the folder's check, that of all sizes, two cases
    monkeypatch.setattr(Folder, "room", lambda self: next(room, 1e6))
    summary = run(cases, folder.path, jobs=1, say=lambda line: None)
    assert 1 <= summary.done < 4 and not summary.failed and summary.exit_status == 1
    assert "nearly full" in summary.stopped and "run again" in summary.stopped
    with pytest.raises(fs.CaseError, match="room for 1 MB only"):
        run(cases, folder.path, jobs=1)
    monkeypatch.undo()
    assert run(cases, folder.path, jobs=1, say=lambda line: None).done == 4


def test_what_will_not_fit_is_said_first(script, tmp_path, monkeypatch):
    cases = [case(script, k) for k in range(4)]
    heard = []
    monkeypatch.setattr(Folder, "room", lambda self: 50e6 + 100e3)
    run(cases, tmp_path / "results", jobs=1, say=heard.append)
    assert any("4 cases take" in line and "will stop after some" in line for line in heard)
    monkeypatch.setattr(Folder, "room", lambda self: 50e6 + 1e3)
    with pytest.raises(fs.CaseError, match=r"a case takes 0\.\d+ MB, and there is room"):
        run([case(script, 9)], tmp_path / "results", jobs=1, say=heard.append)


@posix
def test_scripts_that_take_liberties(script, tmp_path, monkeypatch):
    """With memory, standard input, the working directory, names that are no text, and processes of their own."""
    monkeypatch.chdir(tmp_path)
    faults = ("memory", "input", "elsewhere", "no text", "orphan", "")
    cases = [case(script, k, fault, duration=2.0) for k, fault in enumerate(faults)]
    begin = time.monotonic()
    summary = run(cases, "results", jobs=1, say=lambda line: None)
    assert time.monotonic() - begin < 100.0  # the orphan is not waited for
    kinds = {int(record.id[1:3]): record.kind for record in summary.failed}
    assert kinds == {0: "out of memory", 1: "raised", 3: "raised", 4: "killed"}, summary.lines()
    said = {int(record.id[1:3]): record.message for record in summary.failed}
    assert "EOFError" in said[1] and "\\udcff" in said[3] and "SIGKILL" in said[4]
    assert Folder("results").done() == {cases[2].id, cases[5].id}
    mine = str(tmp_path / "results").encode()
    sleepers = [path for path in Path("/proc").glob("[0-9]*/cmdline") if mine in read(path)]
    assert not sleepers


def read(path):
    try:
        return path.read_bytes()
    except OSError:
        return b""


@posix
def test_worker_that_dies_before_its_first_word(script, tmp_path, monkeypatch):
    """Killed while it starts: its case is given to another one. None that comes up is no matter of cases."""
    python = tmp_path / "python"
    count = tmp_path / "count"
    python.write_text(f'#!/bin/sh\necho x >> {count}\n[ $(wc -l < {count}) -le 2 ] && kill -9 $$\n'
                      f'exec {sys.executable} "$@"\n')  # fmt: skip
    python.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(python))
    summary = run([case(script, 0, duration=2.0)], tmp_path / "results", jobs=1, say=lambda line: None)
    assert (summary.done, len(summary.failed)) == (1, 0)
    python.write_text("#!/bin/sh\nexit 3\n")
    with pytest.raises(fs.CaseError, match="worker processes do not start: its process left with exit status 3"):
        run([case(script, 1)], tmp_path / "results", jobs=1, say=lambda line: None)


def test_results_folder_that_disappears(script, tmp_path, monkeypatch):
    def room(self):
        if seen:
            raise FileNotFoundError(2, "No such file or directory")
        seen.append(self)
        return 1e9

    seen = []
    cases = [case(script, k, duration=2.0, keep="statistics") for k in range(2)]
    monkeypatch.setattr(Folder, "room", room)
    with pytest.raises(fs.CaseError, match="can no longer be used: No such file or directory; see to it"):
        run(cases, tmp_path / "results", jobs=1, say=lambda line: None)


# -- statics --------------------------------------------------------------------------------------

CHAIN = '''
import floatsim as fs

def build(top=20.0):
    chain = fs.Section(name="chain", mass_per_length=50.0, diameter=0.1, EA=1e8)
    line = fs.Line(name="chain", section=chain, length=60.0, elements=12, end_a_position=(0.0, 0.0, -10.0),
                   end_b_position=(40.0, 0.0, -top))
    return fs.Model(name="chain", parts=[line], joints=[fs.Ball(a="chain.end_a", b=(0.0, 0.0, -10.0)),
                    fs.Ball(a="chain.end_b", b=(40.0, 0.0, -top))], sea=fs.Sea(depth=100.0))
'''


def chain_case(path, number, top=20.0, speed=0.5, seed=1):
    environment = {"waves": {"spectrum": "jonswap", "hs": 2.0, "tp": 8.0, "seed": seed},
                   "current": {"speed": speed, "heading_deg": 0.0}}  # fmt: skip
    run = RunSettings(duration=4.0, ramp=2.0, dt=0.1, keep="series", precision="float64")
    return Case(number, f"c{number}", {"seed": seed}, str(path), {"top": top}, environment, run, "0")


def test_statics_are_solved_once_for_all_seeds(tmp_path, record):
    path = tmp_path / "chain.py"
    path.write_text(CHAIN)
    folder, alone = Folder(tmp_path / "results"), Folder(tmp_path / "alone")
    for item in (folder, alone):
        item.prepare()
    others = chain_case(path, 1, seed=2), chain_case(path, 2, speed=0.6), chain_case(path, 3, top=21.0)
    cases = [chain_case(path, 0), *others]
    for item in cases:
        assert run_case(item, folder.path).status == "done", folder.log(item.id).read_text()
    assert len(list(folder.statics.glob("*.pkl"))) == 3  # two seeds share theirs; current and top have their own
    assert run_case(cases[1], alone.path).status == "done"
    kept, afresh = contents(folder, cases[1:2]), contents(alone, cases[1:2])
    record("load cases", "series from a kept static solution are those from one computed afresh, bit for bit",
           kept == afresh, "yes", holds=kept == afresh)  # fmt: skip
    model = load_model(path, {"top": 20.0})
    sea = model.sea.model_copy(update={
        "current": fs.Current(speed=0.5),
        "waves": fs.IrregularWaves(spectrum=fs.Jonswap(hs=2.0, tp=8.0), seed=2, duration=6.0),
    })  # fmt: skip
    plain = fs.simulate(model.model_copy(update={"sea": sea}), 6.0, 0.1)
    with xr.open_dataset(folder.series(cases[1].id)) as data:
        assert data.chain_tension.values.tobytes() == plain.series("chain_tension").tobytes()


def test_mean_drift_is_part_of_the_static_condition(tmp_path):
    """Seeds share the equilibrium of their sea, memories of the slow position are each one's own."""
    folder = Folder(tmp_path)
    folder.prepare()
    item = Case(0, "hull", {}, "", {}, {}, RunSettings(duration=100.0), "0")

    def system(hs, seed, drift=True):
        flow = {"drift": synthetic(), "slow_position": True} if drift else {}
        stiffness = np.diag([1e5, 1e5, 0.0, 3e9, 3e9, 5e8])
        body = fs.Body(
            name="hull", mass=RHO * 4500.0, center_of_mass=(0.0, 0.0, 0.0), inertia=(2e9, 2e9, 2e9),
            hydro=fs.PotentialFlow(database=database(added_mass_inf=np.zeros((6, 6)), depth=3000.0),
                                   linear_stiffness=stiffness, memory=10.0, **flow),
        )  # fmt: skip
        waves = fs.IrregularWaves(spectrum=fs.Jonswap(hs=hs, tp=10.0), seed=seed, omega_max=2.5)
        sea = fs.Sea(depth=3000.0, density=RHO, waves=waves, wave_ramp=0.0)
        return fs.assemble(fs.Model(parts=[body], sea=sea))

    assert static_key(item, system(2.0, 1)) == static_key(item, system(2.0, 2))
    assert len({static_key(item, system(hs, 1)) for hs in (2.0, 3.0)}) == 2
    assert len({static_key(item, system(hs, 1, drift=False)) for hs in (2.0, 3.0)}) == 1
    equilibrium(item, folder, system(2.0, 1))
    other = system(2.0, 2)
    run = fs.simulate(other, 5.0, 0.1, state=equilibrium(item, folder, other))
    plain = fs.simulate(system(2.0, 2), 5.0, 0.1)
    assert len(list(folder.statics.iterdir())) == 1
    assert abs(plain.series("hull_position")[0, 0]) > 0.1
    assert run.rows.tobytes() == plain.rows.tobytes()


def test_kept_statics_of_a_rotor_in_wind_and_waves_with_mean_drift(tmp_path, record):
    """One equilibrium for all seeds of waves and of turbulence, another one for another wind or sea."""
    folder = Folder(tmp_path)
    folder.prepare()

    def of(seed, speed=12.0, hs=2.0):
        springs = np.diag([1e5, 1e5, 1e6, 3e9, 3e9, 5e8])
        flow = fs.PotentialFlow(database=database(added_mass_inf=np.zeros((6, 6)), depth=3000.0), memory=10.0,
                                linear_stiffness=springs, drift=synthetic(), slow_position=True)  # fmt: skip
        body = fs.Body(name="hull", mass=RHO * 4500.0, center_of_mass=(0.0, 0.0, 0.0), inertia=(2e9, 2e9, 2e9),
                       hydro=flow)  # fmt: skip
        waves = fs.IrregularWaves(spectrum=fs.Jonswap(hs=hs, tp=10.0), seed=seed, omega_max=2.5)
        gusts = fs.Kaimal(intensity=0.1, seed=seed, components=100, duration=600.0)
        sea = fs.Sea(depth=3000.0, density=RHO, waves=waves, wave_ramp=0.0)
        parts = [body, rotor("hull", tower_top=(0.0, 0.0, 90.0))]
        model = fs.Model(parts=parts, wind=fs.Wind(speed=speed, turbulence=gusts), sea=sea)
        wind = {"speed": speed, "turbulence_intensity": 0.1, "seed": seed}
        item = Case(seed, "c", {}, "", {}, {"waves": {"hs": hs, "seed": seed}, "wind": wind}, RunSettings(60.0), "0")
        return item, fs.assemble(model)

    assert static_key(*of(1)) == static_key(*of(2))
    assert len({static_key(*of(1)), static_key(*of(1, speed=13.0)), static_key(*of(1, hs=3.0))}) == 3
    first, system = of(1)
    equilibrium(first, folder, system)
    other, system = of(2)
    run = fs.simulate(system, 5.0, 0.1, state=equilibrium(other, folder, system))
    plain = fs.simulate(of(2)[1], 5.0, 0.1)
    assert len(list(folder.statics.iterdir())) == 1 and plain.series("hull_position")[0, 0] > 0.1
    same = run.rows.tobytes() == plain.rows.tobytes()
    record("load cases", "the same for a rotor in turbulent wind and waves with mean drift", same, "yes", holds=same)


def test_decay_case(tmp_path):
    """The sphere of Kramer et al.: period of the drop and damping, in place of statistics of channels."""
    sphere = Path(__file__).parents[2] / "models" / "sphere.py"
    settings = RunSettings(duration=4.0, dt=0.01, study="decay", dof="heave", offset=0.03, keep="series")
    item = Case(0, "drop", {"offset": 0.03}, str(sphere), {"size": "kramer"}, {}, settings, "0")
    folder = Folder(tmp_path)
    folder.prepare()
    assert run_case(item, folder.path).status == "done", folder.log(item.id).read_text()
    plain = fs.decay_test(load_model(sphere, {"size": "kramer"}), "heave", 0.03, duration=4.0, dt=0.01)
    with xr.open_dataset(folder.statistics(item.id)) as data:
        assert float(data.decay_period) == plain.fit.period == pytest.approx(0.76, rel=0.03)
        assert data.attrs["case_id"] == item.id and data.attrs["status"] == "done"
    assert folder.series(item.id).exists()


STOP = '''
import floatsim as fs

def build(waves=None):
    """A weight above a soft or a stiff stop: the script chooses it by the waves."""
    stiffness = 1e4 if waves.spectrum.hs > 3.0 else 1e3
    rod = fs.Body(name="rod", mass=10.0, inertia=(3.4, 3.4, 0.01), center_of_mass=(0.0, 0.0, -1.0),
                  position=(0.0, 0.0, 5.0))
    push = fs.UserLaw(function=lambda t, s, v: 40.0 - max(s - 0.2, 0.0) * stiffness)
    return fs.Model(name="rod", parts=[rod, fs.PTO(name="push", joint="hinge", laws=[push])], joints=[
        fs.Hinge(name="hinge", a="rod", b=(0.0, 0.0, 5.0), axis=(0.0, 1.0, 0.0))],
        sea=fs.Sea(depth=50.0, waves=waves))
'''


def test_what_a_script_makes_of_waves_is_part_of_the_static_condition(tmp_path):
    """Far from the drawing position too, where no residual shows it."""
    path = tmp_path / "stop.py"
    path.write_text(STOP)

    def of(hs, seed=1):
        waves = {"spectrum": "jonswap", "hs": hs, "tp": 8.0, "seed": seed}
        item = Case(0, "c", {}, str(path), {}, {"waves": waves}, RunSettings(duration=20.0, ramp=0.0), "0")
        return static_key(item, fs.assemble(model_of(item)))

    assert of(2.0) == of(2.0, seed=2) == of(2.5) != of(4.0)


def test_damaged_static_solution_is_solved_anew(tmp_path):
    path = tmp_path / "chain.py"
    path.write_text(CHAIN)
    item, folder = chain_case(path, 0), Folder(tmp_path / "results")
    folder.prepare()
    whole = equilibrium(item, folder, fs.assemble(model_of(item)))
    (kept,) = folder.statics.glob("*.pkl")
    data = kept.read_bytes()
    for damaged in (b"", data[:100], b"\0" * len(data), data.replace(b"numpy", b"nunpy"), b"I1\nI2\nd."):
        kept.write_bytes(damaged)
        again = equilibrium(item, folder, fs.assemble(model_of(item)))
        assert again.x.tobytes() == whole.x.tobytes() and kept.read_bytes() == data


# -- Dask -----------------------------------------------------------------------------------------


@posix
@pytest.mark.slow
def test_dask_cluster_with_a_worker_killed(script, tmp_path, record):
    pytest.importorskip("distributed", reason="needs floatsim[cluster]")
    cases = [case(script, k, duration=4.0, pause=0.0002) for k in range(10)]
    calm, folder = Folder(tmp_path / "calm"), Folder(tmp_path / "dask")
    assert run(cases, calm.path, jobs=2, say=lambda line: None).done == 10
    killed = []

    def kill():  # as soon as both workers are at it
        wait_for(lambda: len(folder.under_way()) == 2 and len(folder.done()) >= 2)
        attempt = next(iter(folder.running.glob("*/*")))
        killed.append(int(attempt.name.split("-")[-2]))
        os.kill(killed[0], signal.SIGKILL)

    thread = threading.Thread(target=kill)
    thread.start()
    summary = run(cases, folder.path, cluster={"kind": "local", "jobs": 2, "options": {}}, say=lambda line: None)
    thread.join()
    assert len(killed) == 1
    assert summary.done == 10 and summary.exit_status == 0, summary.lines()
    assert sum(said(folder, item).count("started") for item in cases) >= 11
    assert not any("started" in said(folder, item)[said(folder, item).index("done in") :] for item in cases)
    disturbed, undisturbed = contents(folder, cases), contents(calm, cases)
    same = sum(disturbed[name] == undisturbed[name] for name in undisturbed)
    record("load cases: Dask, 2 workers, one killed", "files bit for bit those of local workers", same, (20, 20))
