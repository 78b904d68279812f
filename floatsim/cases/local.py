"""Cases on this machine: worker processes, one thread each, one case at a time.

A worker is a fresh interpreter (`python -m floatsim.cases.local FOLDER`) that reads cases as lines of JSON and answers
with records. Each has pipes of its own: whichever is killed, whatever it was at, it is known which case it had, and
nobody else waits for a lock it held. Workers do not outlive the runner: they end when its pipe closes, and on Linux
the kernel kills them even inside compiled code.
"""

from __future__ import annotations

import contextlib
import json
import os
import queue
import signal
import subprocess
import sys
import threading
import time as clock
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any, TextIO

from floatsim.cases.case import Case
from floatsim.cases.folder import Folder, Kind, Record
from floatsim.errors import CaseError

THREADS = ("OMP", "MKL", "OPENBLAS", "NUMBA", "NUMEXPR", "VECLIB")
GRACE, PATIENCE = 15.0, 300.0  # s: what a worker may be late with ending itself, and with its first word
LAST_WORDS = 1.0  # s for what a worker that has ended said before
FIRST = 180.0  # s until other workers are given cases although the first has not made a step
STILLBORN = 3  # workers in a row that may die before their first word


class Workers:
    """`jobs` worker processes for the cases of a results folder. Use it as a context manager: all are gone after."""

    def __init__(self, folder: Folder, jobs: int) -> None:
        self.folder, self.jobs = folder, jobs
        self.answers: queue.Queue[tuple[_Worker, str]] = queue.Queue()
        self.workers: list[_Worker] = []
        self._stillborn = 0

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, *args: object) -> None:
        for worker in self.workers:
            worker.kill()
        self.workers.clear()

    @property
    def width(self) -> int:
        """Cases at a time."""
        return self.jobs

    def size_of(self, case: Case) -> int | None:
        """Bytes that the files of a case will take; None if that cannot be found."""
        worker = self._idle()
        worker.ask("size", case)
        end = clock.monotonic() + PATIENCE
        while (left := end - clock.monotonic()) > 0.0:
            try:
                who, line = self.answers.get(timeout=left)
            except queue.Empty:
                break
            if not line:
                break
            answer = json.loads(line)
            who.hear(answer)
            if "size" in answer:
                return None if answer["size"] is None else int(answer["size"])
        worker.kill()
        self.workers.remove(worker)
        return None

    def records(self, cases: Iterator[Case]) -> Iterator[Record]:
        """The record of every case, as they come; cases are taken when there is a worker for them."""
        alone = clock.monotonic() + FIRST  # until the first has made steps: it compiles what is missing for all
        while len(self.workers) < self.jobs:
            self.workers.append(_Worker(self.folder, self.answers))
        again: list[Case] = []  # that were given to workers which never came up
        more = True
        while True:
            jobs = 1 if alone > clock.monotonic() else self.jobs
            while more and sum(worker.case is not None for worker in self.workers) < jobs:
                case = again.pop() if again else next(cases, None)
                if case is None:
                    more = False
                else:
                    self._idle().ask("run", case)
            if not any(w.case for w in self.workers):
                return
            for worker in self.workers:
                worker.check()
            try:
                worker, line = self.answers.get(timeout=0.5)
            except queue.Empty:
                continue
            if not line:
                if worker not in self.workers:  # its end was seen before
                    continue
                self.workers.remove(worker)
                case, kind, said = worker.case, *worker.buried()
                if not worker.ready:
                    self._stillborn += 1
                    if self._stillborn >= STILLBORN:
                        raise CaseError(f"worker processes do not start: {said}; what they say is above")
                    again += [case] if case is not None else []
                    more = more or bool(again)
                elif case is not None:
                    yield self.folder.died(case.id, kind, said)
                continue
            answer = json.loads(line)
            worker.hear(answer)
            self._stillborn = 0
            if "began" in answer or "record" in answer:
                alone = 0.0
            if "record" in answer:
                yield Record(**answer["record"])

    def _idle(self) -> _Worker:
        idle = [worker for worker in self.workers if worker.case is None]
        if not idle:
            idle.append(_Worker(self.folder, self.answers))
            self.workers += idle
        return next((worker for worker in idle if worker.ready), idle[0])


class _Worker:
    """A worker process, seen from the runner."""

    def __init__(self, folder: Folder, answers: queue.Queue[tuple[_Worker, str]]) -> None:
        environment = os.environ | {f"{name}_NUM_THREADS": "1" for name in THREADS}
        environment["PYTHONPATH"] = os.pathsep.join(filter(None, [str(Path(__file__).parents[2]),
                                                                 os.environ.get("PYTHONPATH")]))  # fmt: skip
        command = [sys.executable, "-m", "floatsim.cases.local", str(folder.path.resolve()), str(os.getpid())]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                                        env=environment, start_new_session=True)  # fmt: skip
        self.case: Case | None = None
        self.ready, self.late, self._gone = False, False, 0.0
        self._answers = answers
        self.deadline = clock.monotonic() + PATIENCE
        self._killings = _killings()
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            if line.startswith("{") and line.endswith("}\n"):  # else it was killed in the middle of a word
                self._answers.put((self, line))
        self._answers.put((self, ""))

    def ask(self, what: str, case: Case) -> None:
        """Give it a case."""
        from floatsim.cases.run_case import COMPILING
        from floatsim.jit import cache_is_cold

        self.case = case
        if what == "run" and case.run.time_limit is not None:
            limit = case.run.time_limit + (COMPILING if cache_is_cold() else 0.0)
            self.deadline = clock.monotonic() + limit + GRACE + (0.0 if self.ready else PATIENCE)
        elif self.ready:
            self.deadline = float("inf")
        assert self.process.stdin is not None
        with contextlib.suppress(OSError):  # it is gone, as its other pipe will say
            self.process.stdin.write(json.dumps({what: case.as_dict()}, default=list) + "\n")
            self.process.stdin.flush()

    def hear(self, answer: dict[str, Any]) -> None:
        """Take note of what it says."""
        if "ready" in answer:
            self.ready = True
            limit = self.case.run.time_limit if self.case else None
            if limit is None:
                self.deadline = float("inf")
        elif "record" in answer or "size" in answer:
            self.case, self.deadline = None, float("inf")

    def check(self) -> None:
        """Kill it if it is too late: stopped, or stuck in the kernel. Do not wait for the end of its pipe if it is
        gone and what a script has forked holds that."""
        now = clock.monotonic()
        if now > self.deadline:
            self.late = True
            self._kill_all()
        if self.process.poll() is not None:
            self._gone = self._gone or now
            if now > self._gone + LAST_WORDS:
                self._answers.put((self, ""))

    def buried(self) -> tuple[Kind, str]:
        """What it died of."""
        with contextlib.suppress(subprocess.TimeoutExpired):  # its pipe closes before it has ended
            self.process.wait(LAST_WORDS)
        self._kill_all()
        status = self.process.wait()
        if self.late:
            return "timed out", "it took longer than its time limit and did not end itself"
        if status == -signal.SIGKILL and _killings() > self._killings:
            return "out of memory", f"its process was {_left(status)} when the machine ran out of memory"
        return "killed", f"its process {'was ' if status < 0 else ''}{_left(status)}"

    def kill(self) -> None:
        """End it now."""
        self._kill_all()
        self.process.wait()
        assert self.process.stdin is not None
        with contextlib.suppress(OSError):
            self.process.stdin.close()

    def _kill_all(self) -> None:
        """It, and on POSIX what its scripts have started: it leads a process group. One that has ended keeps its
        status."""
        if os.name == "posix":
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self.process.pid, signal.SIGKILL)
        else:
            self.process.kill()


def _left(status: int) -> str:
    return f"killed by {signal.Signals(-status).name}" if status < 0 else f"left with exit status {status}"


def _killings() -> int:
    """How many processes Linux has killed for want of memory."""
    try:
        lines = Path("/proc/vmstat").read_text().splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) for line in lines if line.startswith("oom_kill ")), 0)


# -- in the worker --------------------------------------------------------------------------------


def _die_with(parent: int) -> None:
    """On Linux: be killed when the parent is gone."""
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None).prctl(1, signal.SIGKILL, 0, 0, 0)  # PR_SET_PDEATHSIG
    if os.name == "posix" and os.getppid() != parent:
        os._exit(1)


def _read(stream: TextIO, orders: queue.Queue[dict[str, Any]]) -> None:
    for line in stream:
        orders.put(json.loads(line))
    os._exit(0)  # the runner is gone, or needs no more


def work(folder: str, parent: int) -> None:
    """Answer cases from standard input until it closes."""
    _die_with(parent)
    given, answers = os.fdopen(os.dup(0)), os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)  # what others print on standard output is no answer
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)  # and our orders are none of their input
    os.close(nothing)
    orders: queue.Queue[dict[str, Any]] = queue.Queue()
    threading.Thread(target=_read, args=(given, orders), daemon=True).start()
    from floatsim.cases.run_case import run_case, size_of

    def answer(**what: Any) -> None:
        try:
            answers.write(json.dumps(what) + "\n")
        except OSError:
            os._exit(0)  # the runner is gone

    answer(ready=True)
    while True:
        (what, data), = orders.get().items()  # fmt: skip
        case = Case.from_dict(data)
        if what == "size":
            try:
                answer(size=size_of(case))
            except BaseException:  # the case itself will say it
                answer(size=None)
        else:
            answer(record=asdict(run_case(case, folder, lambda: answer(began=True))))


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    work(sys.argv[1], int(sys.argv[2]))
