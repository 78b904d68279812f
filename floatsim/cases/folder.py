"""The results folder of a matrix: what lies where, who may write, what is done.

    FOLDER/lock, owner.json             one runner at a time, and who it is
    FOLDER/matrix.json                  all cases
    FOLDER/statics/KEY.pkl              equilibria, one for every distinct static condition
    FOLDER/running/ID/ATTEMPT/          a case's files while it runs
    FOLDER/cases/ID.nc, ID.stats.nc, ID.log
    FOLDER/failed/ID.json, ID.nc        why a case failed, and its series
    FOLDER/failed/ID.ckpt               its last good state, to be looked at or resumed; of a decay test ID.state.pkl

Nothing but this folder says how far a matrix is: a case is done once its ID.stats.nc is there, and that is moved into
place last, whole. Killing anything at any moment therefore loses no finished case, and leaves no half one.
"""

from __future__ import annotations

import contextlib
import getpass
import itertools
import json
import os
import shutil
import socket
import time as clock
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Literal

from floatsim.cases.case import Case
from floatsim.errors import CaseError

Kind = Literal["", "diverged", "no equilibrium", "raised", "out of memory", "timed out", "killed", "no room"]
RESERVE = 50e6  # bytes that stay free on the disk
_ATTEMPTS = itertools.count()


@dataclass(frozen=True)
class Record:
    """How a case went. kind and message: of a failure. time_reached [s]: simulated. wall_time [s]."""

    id: str
    status: Literal["done", "failed"]
    kind: Kind = ""
    message: str = ""
    time_reached: float = 0.0
    wall_time: float = 0.0
    host: str = ""
    finished: float = 0.0


def write_whole(path: Path, data: bytes) -> None:
    """The file with this content, or as it was before: never half of it."""
    part = path.with_name(f".{path.name}.{socket.gethostname()}-{os.getpid()}")
    try:
        with part.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    except BaseException:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
        raise


def move_whole(source: Path, target: Path) -> None:
    """Rename a finished file into place; its content is on the disk before its name is."""
    descriptor = os.open(source, os.O_RDWR)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
    os.replace(source, target)


def _user() -> str:
    try:
        return getpass.getuser()
    except (KeyError, OSError):  # nobody, as in some containers
        return ""


class Folder:
    """Paths and contents of a results folder. Making the object touches nothing."""

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self.cases, self.failures = self.path / "cases", self.path / "failed"
        self.statics, self.running = self.path / "statics", self.path / "running"

    # -- the folder itself --------------------------------------------------------------------

    def prepare(self) -> None:
        """Make it. Raises CaseError, naming it, if it cannot be written or its disk is full."""
        try:
            for item in (self.path, self.cases, self.failures, self.statics, self.running):
                item.mkdir(parents=True, exist_ok=True)
                write_whole(item / "probe", b"0" * 4096)
                (item / "probe").unlink(missing_ok=True)  # two may look at once: the lock decides later
        except OSError as error:
            raise CaseError(
                f"results folder '{self.path}' cannot be written: {error.strerror}; choose another with --output"
            ) from None
        if self.room() < RESERVE:
            raise CaseError(
                f"results folder '{self.path}': its disk has room for {self.room() / 1e6:.0f} MB only; make room (at "
                f"least {RESERVE / 1e6:.0f} MB stay free) or choose another folder with --output"
            )

    def room(self) -> int:
        """Bytes that are free on its disk."""
        return shutil.disk_usage(self.path).free

    @contextlib.contextmanager
    def locked(self) -> Iterator[None]:
        """Hold the folder for one runner. Raises CaseError saying who has it."""
        from filelock import FileLock, Timeout

        lock = FileLock(str(self.path / "lock"))
        try:
            lock.acquire(timeout=0)
        except Timeout:
            raise CaseError(
                f"results folder '{self.path}' is in use by {self._owner_in_words()}; wait for it, stop it, or choose "
                "another folder with --output"
            ) from None
        except OSError as error:
            raise CaseError(f"results folder '{self.path}' cannot be locked: {error.strerror}") from None
        try:
            self.own(0)
            yield
        finally:
            with contextlib.suppress(OSError):
                (self.path / "owner.json").unlink(missing_ok=True)
            lock.release()

    def own(self, to_do: int) -> None:
        """Say who holds it, with so many cases to do."""
        who = {"pid": os.getpid(), "host": socket.gethostname(), "user": _user(), "started": clock.time(),
               "to_do": to_do}  # fmt: skip
        write_whole(self.path / "owner.json", json.dumps(who).encode())

    def owner(self) -> dict[str, Any] | None:
        """pid, host, user, started [s since 1970] and to_do of the runner at work; None if there is none."""
        try:
            who = dict(json.loads((self.path / "owner.json").read_bytes()))
            if who["host"] == socket.gethostname():
                os.kill(who["pid"], 0)
        except PermissionError:  # it is there, and somebody else's
            return who
        except (OSError, ValueError, KeyError):  # nobody, or one that was killed
            return None
        return who

    def _owner_in_words(self) -> str:
        try:
            who = json.loads((self.path / "owner.json").read_bytes())
            since = clock.strftime("%Y-%m-%d %H:%M:%S", clock.localtime(who["started"]))
            return f"process {who['pid']} of {who['user'] or 'somebody'} on {who['host']}, since {since}"
        except (OSError, ValueError, KeyError):
            return "another runner"

    # -- the matrix ---------------------------------------------------------------------------

    def write_matrix(self, cases: Sequence[Case], name: str, path: str, units: Mapping[str, str]) -> None:
        """Keep all cases, so that the folder speaks for itself."""
        data = {"name": name, "path": path, "units": dict(units), "cases": [case.as_dict() for case in cases]}
        write_whole(self.path / "matrix.json", json.dumps(data, default=list).encode())

    def matrix(self) -> tuple[str, str, tuple[Case, ...]]:
        """Name, path and cases. Raises CaseError if there are none."""
        try:
            data = json.loads((self.path / "matrix.json").read_bytes())
            return data["name"], data["path"], tuple(Case.from_dict(item) for item in data["cases"])
        except (OSError, ValueError, KeyError, TypeError):
            raise CaseError(f"'{self.path}' is no results folder of a matrix: run its cases first") from None

    def named(self, cases: Iterable[Case]) -> dict[str, Case]:
        """Identity -> case, by the name under which its files are here. A slug says what varies in a matrix: it changes
        when a matrix grows by a variable, or stands in a folder with another one, and the case is the same."""
        own = {case.id: case for case in cases}
        here = {name.rpartition("-")[2]: name for name in (*self.failed(), *self.done()) if name not in own}

        def kept(name: str, case: Case) -> Case:
            there = here.get(name.rpartition("-")[2])
            return case if there is None or self.record(name) else replace(case, slug=there.rpartition("-")[0])

        return {name: kept(name, case) for name, case in own.items()}

    # -- cases --------------------------------------------------------------------------------

    def series(self, case_id: str) -> Path:
        """Series of a finished case."""
        return self.cases / f"{case_id}.nc"

    def statistics(self, case_id: str) -> Path:
        """Statistics of a finished case: what makes it one."""
        return self.cases / f"{case_id}.stats.nc"

    def log(self, case_id: str) -> Path:
        """What a case said, all its attempts."""
        return self.cases / f"{case_id}.log"

    def done(self) -> set[str]:
        """Identities of all finished cases."""
        if not self.cases.is_dir():
            return set()
        end = ".stats.nc"
        names = (entry.name for entry in os.scandir(self.cases))
        return {name.removesuffix(end) for name in names if name.endswith(end) and not name.startswith(".")}

    def failed(self) -> dict[str, Record]:
        """Identity -> record of the cases that failed and were not finished since."""
        names = (path.name.removesuffix(".json") for path in sorted(self.failures.glob("*.json")))
        records = {name: self.record(name) for name in names}
        return {name: record for name, record in records.items() if record is not None and record.status == "failed"}

    def record(self, case_id: str) -> Record | None:
        """How a case went, if it has come to its end."""
        if self.statistics(case_id).exists():
            return Record(case_id, "done")
        path = self.failures / f"{case_id}.json"
        try:
            return Record(**json.loads(path.read_bytes()))
        except FileNotFoundError:
            return None
        except (OSError, ValueError, TypeError):
            return Record(case_id, "failed", "raised", f"its record '{path}' cannot be read")

    def ended(self) -> list[float]:
        """When cases came to an end, well or not [s since 1970]."""
        out = []
        for path in (*self.cases.glob("*.stats.nc"), *self.failures.glob("*.json")):
            with contextlib.suppress(OSError):
                out.append(path.stat().st_mtime)
        return out

    def under_way(self) -> dict[str, float]:
        """Identity -> simulated time [s] of the cases that run now."""
        out = {}
        for path in self.running.glob("*/*"):
            out[path.parent.name] = Attempt(path).reached()
        return out

    def forget_failure(self, case_id: str) -> None:
        """Remove what a failure left, but for the log."""
        for end in (".json", ".nc", ".ckpt", ".state.pkl"):
            (self.failures / f"{case_id}{end}").unlink(missing_ok=True)

    def clear_running(self) -> None:
        """Remove what interrupted cases left."""
        shutil.rmtree(self.running, ignore_errors=True)
        self.running.mkdir(exist_ok=True)

    def attempts(self, case_id: str) -> list[Attempt]:
        """Attempts at a case that have not come to an end, the oldest first."""
        return sorted(map(Attempt, (self.running / case_id).glob("*")), key=lambda attempt: attempt.started)

    def attempt(self, case_id: str) -> Attempt:
        """A new one, with a place of its own."""
        name = f"{clock.time():.3f}-{socket.gethostname()}-{os.getpid()}-{next(_ATTEMPTS)}"
        place = self.running / case_id / name
        place.mkdir(parents=True)
        return Attempt(place)

    def _end(self, case_id: str) -> None:
        shutil.rmtree(self.running / case_id, ignore_errors=True)

    def finish(self, case_id: str, attempt: Attempt) -> None:
        """Move the files of a finished case into place."""
        if attempt.series.exists():
            move_whole(attempt.series, self.series(case_id))
        move_whole(attempt.statistics, self.statistics(case_id))
        self.forget_failure(case_id)
        self._end(case_id)

    def fail(self, record: Record, attempt: Attempt | None) -> None:
        """Keep record, series and last good state of a failed case."""
        if attempt is not None:
            kept = (attempt.series, ".nc"), (attempt.checkpoint, ".ckpt"), (attempt.state, ".state.pkl")
            for source, end in kept:
                if source.exists():
                    os.replace(source, self.failures / f"{record.id}{end}")
        write_whole(self.failures / f"{record.id}.json", json.dumps(asdict(record), indent=1).encode())
        self._end(record.id)

    def died(self, case_id: str, kind: Kind, message: str) -> Record:
        """Record a case whose process is gone; a watchdog's bark in its last attempt says that it timed out."""
        attempts = self.attempts(case_id)
        last = attempts[-1] if attempts else None
        if any(attempt.barked() for attempt in attempts):
            at = f", at t = {last.reached():.6g} s of the simulation" if last else ""
            kind, message = "timed out", f"it took longer than its time limit{at}; the log says where it was"
        wall = clock.time() - last.started if last else 0.0
        record = Record(case_id, "failed", kind, message, last.reached() if last else 0.0, wall,
                        socket.gethostname(), clock.time())  # fmt: skip
        with contextlib.suppress(OSError), self.log(case_id).open("a", encoding="utf-8") as log:
            if last is not None and last.watchdog.exists():
                log.write(last.watchdog.read_text(errors="replace"))
            log.write(f"{clock.strftime('%Y-%m-%d %H:%M:%S')} {kind}: {message}\n")
        self.fail(record, last)
        return record


@dataclass(frozen=True)
class Attempt:
    """The files of one attempt at a case, in a folder of their own."""

    path: Path

    @property
    def started(self) -> float:
        """When [s since 1970]."""
        return float(self.path.name.partition("-")[0])

    @property
    def series(self) -> Path:
        """Series so far."""
        return self.path / "series.nc"

    @property
    def statistics(self) -> Path:
        """Statistics, once it is over."""
        return self.path / "stats.nc"

    @property
    def checkpoint(self) -> Path:
        """Checkpoint of a run: its last good state, or the last one written before its process was killed."""
        return self.path / "checkpoint"

    @property
    def state(self) -> Path:
        """Last good state of a decay test."""
        return self.path / "state.pkl"

    @property
    def watchdog(self) -> Path:
        """What was going on when the time was up, or the process crashed."""
        return self.path / "watchdog"

    @property
    def clock(self) -> Path:
        """Simulated time so far."""
        return self.path / "clock"

    def reached(self) -> float:
        """Simulated time so far [s]."""
        try:
            return float(self.clock.read_text())
        except (OSError, ValueError):
            return 0.0

    def barked(self) -> bool:
        """Whether its time was up."""
        try:
            return "Timeout (" in self.watchdog.read_text(errors="replace")
        except OSError:
            return False
