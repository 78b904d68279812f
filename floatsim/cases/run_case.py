"""One case, from its description to its files: a pure function, wherever and in whatever order it is called.

Nothing is carried from one case to the next in a process but what cannot change results (compiled kernels, databases
that were read). Statics are solved once for every distinct static condition and kept in the folder. What a condition
is, is found from the model itself: script, parameters, current and wind, and the residual of the assembled system
without waves at two positions. Waves change that residual only through their mean drift, and then the equilibrium is
another one. A case always starts from the kept file, whether it or another one has written it.

A case's own failure is a `Record`, never an exception.
"""

from __future__ import annotations

import contextlib
import faulthandler
import hashlib
import json
import os
import pickle
import socket
import sys
import time as clock
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from floatsim.cases.case import Case
from floatsim.cases.folder import RESERVE, Attempt, Folder, Kind, Record, write_whole
from floatsim.errors import SolveFailed
from floatsim.jit import cache_is_cold
from floatsim.model import Model
from floatsim.study.checkpoint import identity
from floatsim.system.state import State
from floatsim.system.system import System, assemble
from floatsim.version import __version__

COMPILING = 300.0  # s that are added to a time limit while kernels have yet to be compiled
MOST_ATTEMPTS = 3  # at a case whose process was killed each time; then it is the case that kills
TICK, NOTE = 1.0, 60.0  # s of wall clock between notes of the time reached, and between lines of the log
CHECKPOINT = 600.0  # s of simulated time between checkpoints, at least: the last good state if the process is killed
SHIFT = 1e-3  # of the model's size: how far the second position of a static condition is from the drawing


def run_case(case: Case, folder: str | Path, began: Callable[[], None] = lambda: None) -> Record:
    """Run a case and leave its files in the results folder. began() is called once steps are being made.

    A case that has come to its end, well or not, is not run again: a cluster asks twice for answers that it lost.
    Raises nothing for what is the case's own; KeyboardInterrupt passes. After its time limit the whole process ends,
    whatever it is at, and leaves its stack in the attempt's `watchdog`.
    """
    place = Folder(folder)
    if (ended := place.record(case.id)) is not None:
        return ended
    earlier = place.attempts(case.id)
    if any(attempt.barked() for attempt in earlier):
        return place.died(case.id, "timed out", "")
    if len(earlier) >= MOST_ATTEMPTS:
        return place.died(case.id, "killed", f"its process was killed {len(earlier)} times in a row")
    start = clock.perf_counter()
    attempt, failed = None, None
    try:
        attempt = place.attempt(case.id)
        log_file = place.log(case.id).open("a", buffering=1, encoding="utf-8", errors="backslashreplace")
        with log_file as log, _watched(case, attempt), _said_to(log), contextlib.chdir("."):  # and back
            _note(log, f"started: attempt {len(earlier) + 1}, {socket.gethostname()} {os.getpid()}, {__version__}")
            try:
                _run(case, place, attempt, _Progress(attempt, log, began))
                _note(log, f"done in {clock.perf_counter() - start:.2f} s")
            except KeyboardInterrupt:
                _note(log, "interrupted")
                raise
            except BaseException as error:
                failed = _reason(error, place)
                _note(log, ": ".join(failed))
                if failed[0] == "raised":
                    log.write("".join(traceback.format_exception(error)))
            record = _record(case, attempt, start, failed)
            if failed is None:
                place.finish(case.id, attempt)
            elif failed[0] != "no room":
                place.fail(record, attempt)
    except OSError as error:  # even the log or the record cannot be written
        record = _record(case, attempt, start, ("no room", str(error)))
    return record


def _record(case: Case, attempt: Attempt | None, start: float, failed: tuple[Kind, str] | None) -> Record:
    kind, message = failed or ("", "")
    message = message.encode(errors="backslashreplace").decode()  # names of files may be no text
    reached = attempt.reached() if attempt else 0.0
    return Record(case.id, "failed" if failed else "done", kind, message, reached, clock.perf_counter() - start,
                  socket.gethostname(), clock.time())  # fmt: skip


def _note(log: Any, text: str) -> None:
    log.write(f"{clock.strftime('%Y-%m-%d %H:%M:%S')} {text}\n")


@contextlib.contextmanager
def _watched(case: Case, attempt: Attempt) -> Iterator[None]:
    """Let the process end when the time is up, compiled code or not, and leave its stack, as after a crash."""
    with attempt.watchdog.open("w") as file:
        faulthandler.enable(file)
        if case.run.time_limit is not None:
            limit = case.run.time_limit + (COMPILING if cache_is_cold() else 0.0)
            faulthandler.dump_traceback_later(limit, exit=True, file=file)
        try:
            yield
        finally:
            faulthandler.cancel_dump_traceback_later()
            faulthandler.disable()


@contextlib.contextmanager
def _said_to(log: Any) -> Iterator[None]:
    """What scripts print goes to the log."""
    with contextlib.redirect_stdout(log), contextlib.redirect_stderr(log):
        yield


class _Progress:
    """Called by the run: notes the time reached for whoever watches."""

    def __init__(self, attempt: Attempt, log: Any, began: Callable[[], None]) -> None:
        self.attempt, self.log = attempt, log
        self.tick, self.line = clock.monotonic(), clock.monotonic() + NOTE
        self._began: Callable[[], None] | None = began

    def __call__(self, t: float, iterations: int) -> None:
        if self._began is not None:
            self._began()
            self._began = None
        now = clock.monotonic()
        if now >= self.tick:
            self.tick = now + TICK
            self.reached(t)
        if now >= self.line:
            self.line = now + NOTE
            _note(self.log, f"t = {t:.6g} s, {iterations} Newton iterations")

    def reached(self, t: float) -> None:
        """Note the time [s]."""
        self.attempt.clock.write_text(repr(float(t)))


def _reason(error: BaseException, place: Folder) -> tuple[Kind, str]:
    """Kind of failure and what to say about it."""
    said = " ".join(str(error).split())
    if isinstance(error, _Diverged):
        return "diverged", said
    if isinstance(error, SolveFailed):
        return "no equilibrium", said
    if isinstance(error, MemoryError) or isinstance(error.__context__, MemoryError):  # this was in a script
        return "out of memory", said or "no memory was left"
    try:  # whatever it was that failed: can the folder still be written?
        if place.room() < RESERVE:
            return "no room", said
        probe = place.running / f"probe-{os.getpid()}"
        write_whole(probe, b"0" * 65536)
        probe.unlink(missing_ok=True)
    except OSError as full:
        return "no room", f"{said} ({full.strerror})"
    from floatsim.errors import FloatsimError
    from floatsim.study.script import blamed

    return "raised", blamed(error) or (said if isinstance(error, FloatsimError) else f"{type(error).__name__}: {said}")


class _Diverged(Exception):
    """A run that did not arrive."""


def model_of(case: Case) -> Model:
    """The model of a case, from a script that remembers nothing of another one."""
    from floatsim.cases.environment import build_with
    from floatsim.study.script import Script

    folder = Path(case.model).resolve().parent
    for name, module in list(sys.modules.items()):
        if name != "__main__" and (file := getattr(module, "__file__", None)) and Path(file).parent == folder:
            del sys.modules[name]
    return build_with(Script(case.model), case)


def _run(case: Case, place: Folder, attempt: Attempt, progress: _Progress) -> None:
    system = assemble(model_of(case))
    if case.run.study == "decay":
        _decay(case, system, attempt, progress)
    else:
        _simulate(case, place, system, attempt, progress)


def attributes(case: Case) -> dict[str, Any]:
    """Of a case's files."""
    own = {"case_id": case.id, "case_number": case.number, "model_script": Path(case.model).name,
           "model_parameters": json.dumps(dict(case.parameters), default=list), "input_hash": case.source,
           "environment": json.dumps({k: dict(v) for k, v in case.environment.items()}, default=list)}  # fmt: skip
    return own | {f"case_{name}": _plain(value) for name, value in case.variables.items()}


def _plain(value: Any) -> str | int | float:
    return int(value) if isinstance(value, bool) else "" if value is None else value


# -- statics --------------------------------------------------------------------------------------


def static_key(case: Case, system: System) -> str:
    """Name of the static condition of a case: the same for all cases with the same equilibrium, whatever their waves.

    Script, parameters, current, wind but for its seed, what the model is made of but for waves, turbulence and name,
    and the system's residual without waves at the drawing position and near it: mean drift and mean wind are in that.
    """
    environment = {name: {k: v for k, v in values.items() if k != "seed"} for name, values in case.environment.items()
                   if name != "waves"}  # fmt: skip
    model = system.model
    sea = model.sea.model_copy(update={"waves": None})
    wind = model.wind and model.wind.model_copy(update={"turbulence": None})
    made_of = identity(model.model_copy(update={"sea": sea, "wind": wind, "name": "model"}))
    own = [case.source, dict(case.parameters), environment, __version__, made_of]
    digest = hashlib.sha256(json.dumps(own, sort_keys=True, default=list).encode())
    w, state = system.work(), system.initial_state()
    draw = np.random.default_rng(0)
    for share in (0.0, SHIFT):
        state.x[: system.n_point] += share * system.length * draw.uniform(-1.0, 1.0, (system.n_point, 3))
        q = state.q[: system.n_rotation]
        q += share * draw.uniform(-1.0, 1.0, q.shape)
        q /= np.linalg.norm(q, axis=1)[:, None]
        system.load(w, state)
        w.still = True
        w.c[6] = 0.0
        with np.errstate(all="ignore"):
            system.begin(w, state, state.t)
            system.flow(w, w.x, w.t)
            system.evaluate(w)
        digest.update(np.ascontiguousarray(w.r).tobytes())
    return digest.hexdigest()[:20]


def equilibrium(case: Case, place: Folder, system: System) -> State:
    """Static equilibrium of the system, from the folder, or solved and put there. Raises SolveFailed."""
    from floatsim.solve.static import solve_static

    path = place.statics / f"{static_key(case, system)}.pkl"
    try:
        kept = pickle.loads(path.read_bytes())
    except Exception:  # it is not there, or damaged, which shows in many ways
        solved, _ = solve_static(assemble(system.model))  # one of its own: this one comes to a run as after a hit
        data = pickle.dumps(solved)
        write_whole(path, data)  # by two at once: either file is as good
        kept = pickle.loads(data)
    state = system.initial_state()  # with memories of these waves
    for name in ("x", "q", "lam"):
        np.copyto(getattr(state, name), getattr(kept, name))
    for k, batch in enumerate(system.batches):
        if hasattr(batch, "start"):
            state.history[k] = kept.history[k] if hasattr(batch, "keep") else batch.start(state)
    return state


# -- runs -----------------------------------------------------------------------------------------


def _simulate(case: Case, place: Folder, system: System, attempt: Attempt, progress: _Progress) -> None:
    from floatsim.study.simulate import simulate
    from floatsim.study.statistics import StatisticsSettings

    settings, series = case.run, case.run.keep == "series"
    run = simulate(
        system, settings.total, settings.dt, state=equilibrium(case, place, system),
        output=attempt.series if series else None, interval=settings.interval, channels=settings.channels,
        precision=settings.precision, attributes=attributes(case), progress=progress, keep_series=series,
        statistics=StatisticsSettings(settings.ramp, dict(settings.fatigue), settings.block),
        checkpoint=attempt.checkpoint, checkpoint_every=max(CHECKPOINT, settings.total / 4.0),
    )  # fmt: skip
    progress.reached(run.state.t)
    if run.status == "failed":
        raise _Diverged(run.failure)
    assert run.statistics is not None
    run.statistics.write(attempt.statistics, {"wall_time": run.wall_time})


def _decay(case: Case, system: System, attempt: Attempt, progress: _Progress) -> None:
    from floatsim.study.release import decay_test
    from floatsim.study.statistics import decay_variables, write_variables

    settings, series = case.run, case.run.keep == "series"
    try:
        test = decay_test(
            system, settings.dof, settings.offset, duration=settings.duration, dt=settings.dt,
            output=attempt.series if series else None, channels=settings.channels, attributes=attributes(case),
            progress=progress,
        )  # fmt: skip
    except SolveFailed as error:
        if error.state is None:
            raise
        progress.reached(error.state.t)
        attempt.state.write_bytes(pickle.dumps(error.state))
        raise _Diverged(str(error)) from None
    run = test.run
    progress.reached(run.state.t)
    counts = {"steps": run.steps, "cut_steps": run.cut_steps, "newton_iterations": run.newton_iterations,
              "status": "done", "wall_time": run.wall_time}  # fmt: skip
    write_variables(attempt.statistics, decay_variables(test), {**run.attributes, **attributes(case), **counts})


def size_of(case: Case) -> int:
    """Bytes that the files of a case will take, nearly."""
    from floatsim.study.channels import Sampler

    settings = case.run
    if settings.keep != "series":
        return 0
    samples = settings.total / (settings.interval or settings.dt)
    width = Sampler(assemble(model_of(case)), settings.channels, []).width
    return int(samples * (8 + width * np.dtype(settings.precision).itemsize))
