"""The runner: which cases are to do, hand them out, gather their records, say how it goes. One way for one process,
many, or a cluster: what differs is who makes records out of cases (`local.Workers`, `cluster.Cluster`).

The folder is the only memory. A case that is done is not run again, one that failed only when asked for, and one that
was interrupted is as if it had never begun. When the disk is nearly full no more cases are handed out: those that
could not be written stay to do.
"""

from __future__ import annotations

import contextlib
import re
import signal
import sys
import threading
import time as clock
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

from floatsim.cases.case import Case
from floatsim.cases.folder import RESERVE, Folder, Record
from floatsim.errors import CaseError
from floatsim.jit import cache_is_cold

LINE_EVERY = 10.0  # s between plain lines of progress
SHOWN = 3  # cases named for each group of failures


class Pool(Protocol):
    """What makes records out of cases."""

    def __enter__(self) -> Any: ...
    def __exit__(self, *args: object) -> None: ...
    @property
    def width(self) -> int: ...
    def size_of(self, case: Case) -> int | None: ...
    def records(self, cases: Iterator[Case]) -> Iterator[Record]: ...


class Stopped(KeyboardInterrupt):
    """Ended by a signal, its argument."""


@dataclass(frozen=True)
class Summary:
    """How a matrix stands after a run.

    cases: all of the matrix; done: how many are; failed: records of those that failed, now or earlier; missed: how many
    of the chosen ones are not done; ran, wall_time [s]: what this run did; stopped: why it handed out no more cases,
    else ''.
    """

    cases: int
    done: int
    failed: tuple[Record, ...]
    missed: int = 0
    ran: int = 0
    wall_time: float = 0.0
    stopped: str = ""

    @property
    def to_do(self) -> int:
        """Cases that are neither done nor failed."""
        return self.cases - self.done - len(self.failed)

    @property
    def exit_status(self) -> int:
        """0: all that was asked for is done; 1: some failed or could not be run."""
        return 1 if self.missed else 0

    def lines(self) -> list[str]:
        """In words, failures in groups."""
        out = [f"{self.done} of {self.cases} cases done, {len(self.failed)} failed, {self.to_do} to do"]
        for (kind, message), records in grouped(self.failed).items():
            names = ", ".join(record.id for record in records[:SHOWN])
            more = f" and {len(records) - SHOWN} more" if len(records) > SHOWN else ""
            out += [f"  {len(records)} {kind}: {message}", f"      {names}{more}"]
        if self.failed:
            again = "`floatsim cases rerun --failed MATRIX.yaml` runs them again"
            out.append(f"  logs are in cases/, records in failed/; {again}")
        if self.stopped:
            out.append(f"stopped: {self.stopped}")
        return out


def grouped(failed: Sequence[Record]) -> dict[tuple[str, str], list[Record]]:
    """Failures that differ in numbers only, together: (kind, message of the first) -> records; the largest first."""
    groups: dict[tuple[str, str], list[Record]] = {}
    for record in failed:
        key = record.kind, re.sub(r"[-+]?\d+\.?\d*(e[-+]?\d+)?", "#", record.message)
        groups.setdefault(key, []).append(record)
    most = sorted(groups.values(), key=len, reverse=True)
    return {(records[0].kind, records[0].message): records for records in most}


def standing(cases: Sequence[Case], folder: str | Path) -> Summary:
    """How the cases stand in a folder, whoever is at work there."""
    place = Folder(folder)
    ids = {case.id for case in place.named(cases).values()}
    done = place.done() & ids
    failed = tuple(record for name, record in place.failed().items() if name in ids)
    return Summary(len(ids), len(done), failed, len(ids) - len(done))


def run(
    cases: Sequence[Case],
    folder: str | Path,
    *,
    name: str = "",
    path: str = "",
    units: Mapping[str, str] | None = None,
    jobs: int | None = None,
    scheduler: str | None = None,
    cluster: Mapping[str, Any] | None = None,
    chosen: Collection[Case] | None = None,
    again: bool = False,
    time_limit: float | None = None,
    say: Callable[[str], None] | None = None,
) -> Summary:
    """Run what is to do of a matrix into its results folder.

    cases: all; chosen: those of them to run, default all. name, path, units (of variables): of the matrix. jobs:
    worker processes on this machine, default one for each core; or scheduler, address of a Dask scheduler, or cluster,
    the description of one (`cluster.read_description`). again: those that failed earlier, and nothing else. time_limit
    [s] for each case instead of its own. say: takes lines of progress; None: a bar on a terminal, lines on stderr
    elsewhere.

    Raises CaseError if the folder cannot be written or is in use, or workers do not start; KeyboardInterrupt when
    stopped, with everything that was finished kept.
    """
    if jobs is not None and (not isinstance(jobs, int) or isinstance(jobs, bool) or jobs < 1):
        raise CaseError(f"--jobs: got {jobs!r}; must be a whole number of at least 1")
    if sum(item is not None for item in (jobs, scheduler, cluster)) > 1:
        raise CaseError("--jobs, --scheduler and --cluster exclude each other; give one")
    if time_limit is not None and not time_limit > 0.0:
        raise CaseError(f"--time-limit: got {time_limit!r}; must be a positive number of seconds")
    place = Folder(folder)
    place.prepare()
    with _signals(), place.locked():
        named = place.named(cases)
        own = {case.id: case for case in named.values()}
        wanted = own if chosen is None else {named[case.id].id: named[case.id] for case in chosen}
        place.write_matrix(list(own.values()), name, path, units or {})
        place.clear_running()
        done, failed = place.done(), place.failed()
        queue = [case for case in wanted.values() if case.id not in done and (case.id in failed) == again]
        place.own(len(queue))
        if time_limit is not None:
            queue = [replace(case, run=replace(case.run, time_limit=time_limit)) for case in queue]
        start = clock.perf_counter()
        display = _Display(len(queue), say)
        display.say(_opening(queue, wanted, done, failed, again))
        if queue and scheduler is None and cluster is None and cache_is_cold():
            display.say("floatsim: the first case compiles the kernels, once for this version on this machine")
        ran, stopped = 0, ""
        if queue:
            try:
                with display, _pool(place, min(jobs or _cores(), len(queue)), scheduler, cluster) as pool:
                    ran, stopped = _work(place, pool, queue, display)
            except OSError as error:
                raise CaseError(f"results folder '{place.path}' can no longer be used: {error.strerror or error}; see "
                                "to it, then run again, and it goes on with what is there") from None  # fmt: skip
            finally:
                if scheduler is None:  # there somebody may still be at it
                    with contextlib.suppress(OSError):
                        place.clear_running()
        after = standing(list(own.values()), place.path)
        missed = len(wanted.keys() - place.done())
    return replace(after, missed=missed, ran=ran, wall_time=clock.perf_counter() - start, stopped=stopped)


def _opening(queue: Sequence[Case], wanted: Mapping[str, Case], done: set[str], failed: Mapping[str, Record],
             again: bool) -> str:  # fmt: skip
    finished = sum(name in done for name in wanted)
    broken = sum(name in failed for name in wanted)
    hint = "" if again else " (`floatsim cases rerun --failed MATRIX.yaml`)"
    rest = f", {broken} failed earlier{hint}" if broken else ""
    return f"{len(queue)} cases to run; {finished} are done already{rest}"


def _pool(place: Folder, jobs: int, scheduler: str | None, cluster: Mapping[str, Any] | None) -> Pool:
    if scheduler is not None or cluster is not None:
        from floatsim.cases.cluster import Cluster

        return Cluster(place, scheduler, cluster)
    from floatsim.cases.local import Workers

    return Workers(place, jobs)


def _cores() -> int:
    import os

    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _work(place: Folder, pool: Pool, queue: list[Case], display: _Display) -> tuple[int, str]:
    """Hand out all cases; how many came to an end, and why no more were handed out."""
    kept = next((case for case in queue if case.run.keep == "series"), None)
    size = pool.size_of(kept) if kept is not None else 0
    if size:
        _check_room(place, size, sum(case.run.keep == "series" for case in queue), display)
    stopped: list[str] = []
    least = pool.width  # cases that must still fit: those under way

    def hand_out() -> Iterator[Case]:
        for case in queue:
            if not stopped and (room := place.room()) < RESERVE + least * (size or 0):
                stopped.append(f"the disk of '{place.path}' is nearly full ({room / 1e6:.0f} MB left): make room, then "
                               "run again, and it goes on where it stopped")  # fmt: skip
            if stopped:
                return
            place.forget_failure(case.id)
            yield case

    ran = 0
    for record in pool.records(hand_out()):
        if record.kind == "no room":
            stopped[:] = stopped or [f"case {record.id} could not be written: {record.message}; see to it, then run "
                                     "again, and it goes on where it stopped"]  # fmt: skip
            continue
        ran += 1
        display.add(record)
    return ran, stopped[0] if stopped else ""


def _check_room(place: Folder, size: int, cases: int, display: _Display) -> None:
    """Say at once what will not fit; refuse if nothing will."""
    room = place.room() - RESERVE
    if size > room:
        raise CaseError(
            f"a case takes {_bytes(size)}, and there is room for {_bytes(max(room, 0.0))} on the disk of "
            f"'{place.path}'; keep statistics only, fewer channels or a longer interval, or choose another --output"
        )
    if size * cases > room:
        display.say(
            f"warning: {cases} cases take {_bytes(size * cases)}, there is room for {_bytes(room)}: it will "
            f"stop after some {room // size:.0f} cases; keep statistics only, fewer channels or a longer interval"
        )


def _bytes(size: float) -> str:
    return f"{size / 1e6:.3g} MB" if size < 1e9 else f"{size / 1e9:.3g} GB"


@contextlib.contextmanager
def _signals() -> Iterator[None]:
    """SIGTERM and SIGHUP end a run as Ctrl-C does: workers stopped, folder consistent."""

    def stop(number: int, frame: Any) -> None:
        raise Stopped(number)

    if threading.current_thread() is not threading.main_thread():
        yield
        return
    numbers = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]
    before = {number: signal.signal(number, stop) for number in numbers}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


class _Display:
    """Progress over cases with the time that remains: a bar on a terminal, a line now and then elsewhere."""

    def __init__(self, total: int, say: Callable[[str], None] | None) -> None:
        self.total, self.done, self.failed = total, 0, 0
        self.start = self.shown = clock.monotonic()
        self._bar: Any = None
        self._say = say
        if say is None and sys.stderr.isatty():
            from rich.console import Console
            from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

            console = Console(stderr=True, highlight=False, markup=False)
            columns = TextColumn("cases"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[note]}")
            self._bar = Progress(*columns, TimeElapsedColumn(), console=console, transient=True)
            self._task = self._bar.add_task("", total=total, note="")

    def __enter__(self) -> _Display:
        if self._bar is not None:
            self._bar.start()
        return self

    def __exit__(self, *args: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def say(self, line: str) -> None:
        """A line of its own."""
        if self._bar is not None:
            self._bar.console.print(line, soft_wrap=True)
        elif self._say is not None:
            self._say(line)
        else:
            print(line, file=sys.stderr, flush=True)

    def add(self, record: Record) -> None:
        """One case has come to its end."""
        self.done += 1
        if record.status == "failed":
            self.failed += 1
            self.say(f"failed: {record.id}: {record.kind}: {record.message.splitlines()[0] if record.message else ''}")
        elapsed = clock.monotonic() - self.start
        left = in_words(elapsed / self.done * (self.total - self.done))
        note = f"{self.failed} failed, " if self.failed else ""
        note += f"{left} left" if self.done < self.total else "done"
        if self._bar is not None:
            self._bar.update(self._task, completed=self.done, note=note)
        elif clock.monotonic() - self.shown >= LINE_EVERY or self.done == self.total:
            self.shown = clock.monotonic()
            self.say(f"{self.done} of {self.total} cases, {in_words(elapsed)} gone, {note}")


def in_words(seconds: float) -> str:
    """A time in two units at most."""
    s = round(seconds)
    if s < 60:
        return f"{s} s"
    if s < 3600:
        return f"{s // 60} min {s % 60} s"
    if s < 48 * 3600:
        return f"{s // 3600} h {s % 3600 // 60} min"
    return f"{s / 86400.0:.1f} days"
