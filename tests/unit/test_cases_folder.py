"""The results folder: whole files, one owner, what is done and what failed; choosing, grouping, descriptions."""

import json
import os
import re
import stat
import subprocess
import sys
from dataclasses import asdict

import pytest
from typer.testing import CliRunner

import floatsim as fs
from floatsim.cases.case import Case, RunSettings
from floatsim.cases.cluster import read_description
from floatsim.cases.commands import app
from floatsim.cases.folder import Folder, Record, write_whole
from floatsim.cases.run_case import run_case
from floatsim.cases.runner import Summary, grouped, in_words, run, standing


@pytest.fixture
def folder(tmp_path):
    place = Folder(tmp_path / "results")
    place.prepare()
    return place


def case(number=0, **changes):
    own = {"number": number, "slug": f"c{number}", "variables": {"hs": 1.0 + number}, "model": "no_such.py",
           "parameters": {}, "environment": {}, "run": RunSettings(duration=10.0), "source": "0"}  # fmt: skip
    return Case(**(own | changes))


def test_a_file_is_whole_or_as_before(tmp_path, monkeypatch):
    path = tmp_path / "file"
    write_whole(path, b"old")

    def full(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        write_whole(path, b"new and long")
    assert path.read_bytes() == b"old"
    assert [item.name for item in tmp_path.iterdir()] == ["file"]


def test_one_owner_at_a_time(folder):
    program = ("import sys\nfrom floatsim.cases.folder import Folder\n"
               "with Folder(sys.argv[1]).locked():\n    print('mine', flush=True)\n    sys.stdin.read()\n")  # fmt: skip
    with subprocess.Popen([sys.executable, "-c", program, str(folder.path)], stdin=subprocess.PIPE,
                          stdout=subprocess.PIPE, text=True) as other:  # fmt: skip
        assert other.stdout.readline() == "mine\n"
        said = rf"results folder '{re.escape(str(folder.path))}' is in use by process {other.pid} of .*, since \d+"
        with pytest.raises(fs.CaseError, match=said), folder.locked():
            pass
        assert folder.owner()["pid"] == other.pid
        other.kill()
        other.wait()
    assert folder.owner() is None  # what it wrote is still there
    with folder.locked():
        assert folder.owner()["pid"] == os.getpid()
    assert folder.owner() is None


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="permissions do not bind this user")
def test_folder_that_cannot_be_written(tmp_path):
    tmp_path.chmod(stat.S_IRUSR | stat.S_IXUSR)
    try:
        with pytest.raises(fs.CaseError, match="cannot be written: Permission denied; choose another"):
            run([case()], tmp_path / "results")
    finally:
        tmp_path.chmod(stat.S_IRWXU)


def test_folder_that_is_a_file(tmp_path):
    (tmp_path / "results").write_text("")
    with pytest.raises(fs.CaseError, match="cannot be written: .*choose another with --output"):
        run([case()], tmp_path / "results")


def test_cases_done_failed_and_interrupted(folder):
    first, second, third = case(0), case(1), case(2)
    attempt = folder.attempt(first.id)
    attempt.statistics.write_bytes(b"numbers")
    attempt.clock.write_text("4.5")
    assert folder.under_way() == {first.id: 4.5} and not folder.done()
    folder.finish(first.id, attempt)
    attempt = folder.attempt(second.id)
    attempt.state.write_bytes(b"state")
    attempt.clock.write_text("2.5")
    record = folder.died(second.id, "killed", "by somebody")
    assert (record.kind, record.time_reached) == ("killed", 2.5)
    folder.attempt(third.id)
    folder.clear_running()
    assert folder.done() == {first.id}
    assert folder.failed() == {second.id: record}
    assert (folder.failures / f"{second.id}.state.pkl").read_bytes() == b"state"
    assert "killed: by somebody" in folder.log(second.id).read_text()
    summary = standing([first, second, third], folder.path)
    assert (summary.done, len(summary.failed), summary.to_do, summary.exit_status) == (1, 1, 1, 1)
    attempt = folder.attempt(second.id)
    attempt.statistics.write_bytes(b"numbers")
    folder.finish(second.id, attempt)
    assert not folder.failed() and not list(folder.failures.iterdir())


def test_a_watchdog_that_barked_means_that_the_time_was_up(folder):
    attempt = folder.attempt("c0")
    attempt.watchdog.write_text("Timeout (0:00:03)!\nThread 0x1 (most recent call first):\n  File x\n")
    record = folder.died("c0", "killed", "left with exit status 1")
    assert record.kind == "timed out"
    assert "most recent call first" in folder.log("c0").read_text()


def test_matrix_comes_back(folder):
    cases = [case(k) for k in range(3)]
    folder.write_matrix(cases, "name", "file.yaml", {"hs": "m"})
    name, path, back = folder.matrix()
    assert (name, path, back) == ("name", "file.yaml", tuple(cases))
    assert [item.id for item in back] == [item.id for item in cases]
    (folder.path / "matrix.json").write_text("{}")
    with pytest.raises(fs.CaseError, match="is no results folder of a matrix"):
        folder.matrix()


def test_a_case_keeps_its_files_when_its_slug_changes(folder):
    """A matrix that grows by a variable gives its cases longer slugs: those that are done are not run again."""
    old, new, other = case(0, slug="m10"), case(0, slug="m10_n3"), case(1, slug="m10_n4", source="1")
    for ended in (old, other):
        attempt = folder.attempt(ended.id)
        attempt.statistics.write_bytes(b"numbers")
        folder.finish(ended.id, attempt)
    third = case(2, source="2")
    named = folder.named([new, other, third])
    assert {name: item.id for name, item in named.items()} == {new.id: old.id, other.id: other.id, third.id: third.id}
    summary = run([new, other], folder.path, jobs=1, say=lambda line: None)
    assert (summary.ran, summary.done, summary.exit_status) == (0, 2, 0)
    assert [item.id for item in folder.matrix()[2]] == [old.id, other.id]  # as collect will look for them
    assert standing([new, other], folder.path).done == 2


def test_a_case_never_raises(folder):
    record = run_case(case(), folder.path)
    assert (record.status, record.kind) == ("failed", "raised")
    assert "there is no such file" in record.message
    assert json.loads((folder.failures / f"{case().id}.json").read_text()) == asdict(record)
    log = folder.log(case().id).read_text()
    assert run_case(case(), folder.path) == record  # asked again, it is not run again
    assert folder.log(case().id).read_text() == log


def test_case_that_kills_its_process_each_time_is_given_up(folder):
    for _ in range(3):
        folder.attempt(case().id)
    record = run_case(case(), folder.path)
    assert (record.kind, record.message) == ("killed", "its process was killed 3 times in a row")


def test_time_limit_is_no_part_of_the_identity():
    patient = case(run=RunSettings(duration=10.0, time_limit=1.0))
    assert patient.id == case().id != case(run=RunSettings(duration=11.0)).id


def test_failures_that_differ_in_numbers_only_are_one_group():
    records = [Record(f"c{k}", "failed", "diverged", f"at t = {k}.5e-3 s: a step fails") for k in range(5)]
    records.append(Record("x", "failed", "killed", "by SIGKILL"))
    groups = grouped(records)
    assert [len(group) for group in groups.values()] == [5, 1]
    lines = Summary(10, 4, tuple(records), missed=6).lines()
    assert lines[0] == "4 of 10 cases done, 6 failed, 0 to do"
    assert lines[1:3] == ["  5 diverged: at t = 0.5e-3 s: a step fails", "      c0, c1, c2 and 2 more"]
    assert any("rerun --failed" in line for line in lines)


@pytest.mark.parametrize(
    "seconds, words", [(3.4, "3 s"), (75.0, "1 min 15 s"), (7260.0, "2 h 1 min"), (5e5, "5.8 days")]
)
def test_times_in_words(seconds, words):
    assert in_words(seconds) == words


@pytest.mark.parametrize(
    "options, said",
    [
        ({"jobs": 0}, "--jobs: got 0"),
        ({"jobs": 2, "scheduler": "tcp://x:1"}, "exclude each other"),
        ({"time_limit": 0.0}, "--time-limit: got 0.0"),
    ],
)
def test_bad_requests(tmp_path, options, said):
    with pytest.raises(fs.CaseError, match=said):
        run([case()], tmp_path / "results", **options)
    assert not (tmp_path / "results").exists()


def test_description_of_a_cluster(tmp_path):
    path = tmp_path / "slurm.yaml"
    path.write_text("kind: slurm\njobs: 40\noptions: {queue: normal, memory: 4GB}\n")
    assert read_description(path) == {"kind": "slurm", "jobs": 40, "options": {"queue": "normal", "memory": "4GB"}}
    path.write_text("kind: slurrm\njobs: many\nworkers: 3\n")
    with pytest.raises(fs.CaseError) as caught:
        read_description(path)
    assert len(caught.value.problems) == 3
    assert "did you mean 'slurm'" in str(caught.value)
    with pytest.raises(fs.CaseError, match="cannot be read"):
        read_description(tmp_path / "none.yaml")


def test_scheduler_that_is_not_there(tmp_path):
    pytest.importorskip("distributed", reason="needs floatsim[cluster]")
    with pytest.raises(fs.CaseError, match="there is no Dask scheduler at 'nonsense://x'"):
        run([case()], tmp_path / "results", scheduler="nonsense://x", say=lambda line: None)


# -- commands -------------------------------------------------------------------------------------

MATRIX = """
name: pendulums
model: pendulum.py
variables:
  moment: [10, 20, 30]
parameters: {moment: moment}
run: {duration: 2, ramp: 0, dt: 0.02, channels: [rod_position]}
"""
SCRIPT = """
import floatsim as fs
def build(moment):
    rod = fs.Body(name="rod", mass=10.0, inertia=(3.4, 3.4, 0.01), center_of_mass=(0.0, 0.0, -1.0),
                  position=(0.0, 0.0, 5.0))
    push = fs.UserLaw(function=lambda t, s, v: moment if moment != 20 else 300.0 * (t > 0.0) + 1e3 * v**3)
    return fs.Model(name="pendulum", parts=[rod, fs.PTO(name="push", joint="hinge", laws=[push])], joints=[
        fs.Hinge(name="hinge", a="rod", b=(0.0, 0.0, 5.0), axis=(0.0, 1.0, 0.0))], sea=fs.Sea(depth=10.0))
"""


@pytest.mark.slow
def test_commands(tmp_path):
    (tmp_path / "m.yaml").write_text(MATRIX)
    script = tmp_path / "pendulum.py"
    matrix, results = str(tmp_path / "m.yaml"), tmp_path / "m_results"

    def call(*words):
        return CliRunner().invoke(app, [str(word) for word in words])

    script.write_text(SCRIPT.replace("hinge\"", "hing\"", 1))
    wrong = call("run", matrix)
    assert isinstance(wrong.exception, fs.CaseError) and "did you mean 'hinge'" in str(wrong.exception)
    assert not results.exists()  # found before anything ran
    script.write_text(SCRIPT)
    assert isinstance(call("status", matrix).exception, fs.CaseError)
    some = call("run", matrix, "--only", "moment=10,30", "--jobs", 1)
    assert some.exit_code == 0 and "2 of 3 cases done, 0 failed, 1 to do" in some.output, some.output
    assert "nobody is running it; 1 cases wait" in call("status", matrix).output
    rest = call("run", matrix, "--jobs", 1)
    assert rest.exit_code == 1 and "1 diverged: " in rest.output and "1 cases in " in rest.output, rest.output
    assert "0 cases in" in call("run", matrix, "--jobs", 1).output
    again = call("rerun", matrix, "--failed", "--jobs", 1)
    assert again.exit_code == 1 and "1 cases in " in again.output, again.output
    assert isinstance(call("rerun", matrix).exception, fs.CaseError)
    for place in (matrix, results):
        status = call("status", place)
        assert status.exit_code == 0
        assert "pendulums: 2 of 3 cases done, 1 failed, 0 to do" in status.output and "1 diverged" in status.output


def test_templates(tmp_path):
    listed = CliRunner().invoke(app, ["template"])
    name = listed.output.split()[0]
    path = tmp_path / "new.yaml"
    assert CliRunner().invoke(app, ["template", name, "-o", str(path)]).exit_code == 0
    assert path.read_text() == CliRunner().invoke(app, ["template", name]).output
    assert isinstance(CliRunner().invoke(app, ["template", name, "-o", str(path)]).exception, fs.CaseError)
