"""Cases on a Dask cluster: the same function, submitted to workers that share the results folder.

`--scheduler ADDRESS` is a scheduler that runs already; `--cluster FILE.yaml` describes one to be started:

    kind: slurm             # or pbs, sge, lsf, htcondor, oar, moab (dask-jobqueue); local: processes of this machine
    jobs: 40                # workers; each has one core and one case at a time
    options:                # of the class of that kind, as its documentation has them
      queue: normal
      memory: 4GB
      walltime: "24:00:00"

A worker that dies takes nobody along: its case is run again elsewhere. A case whose worker died every time is recorded
as killed, one whose time was up as timed out.
"""

from __future__ import annotations

import contextlib
import os
import sys
import time as clock
from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from floatsim.cases.case import Case
from floatsim.cases.folder import Folder, Record
from floatsim.errors import CaseError, nearest
from floatsim.version import __version__

KINDS = {
    "local": "LocalCluster", "slurm": "SLURMCluster", "pbs": "PBSCluster", "sge": "SGECluster", "lsf": "LSFCluster",
    "htcondor": "HTCondorCluster", "oar": "OARCluster", "moab": "MoabCluster",
}  # fmt: skip
AHEAD = 2  # cases a worker has been given, the one it runs included
LOST = 10  # times a case may be lost with a worker before it ever began


def run_dict(data: dict[str, Any], folder: str) -> dict[str, Any]:
    """`run_case` between processes that only share plain data."""
    from floatsim.cases.run_case import run_case

    return asdict(run_case(Case.from_dict(data), folder))


def look(folder: str) -> tuple[str, bool, str]:
    """Of a worker: version of floatsim, whether it can write the folder, and threads of its linear algebra."""
    return __version__, os.access(folder, os.W_OK), os.environ.get("OMP_NUM_THREADS", "")


def read_description(path: str | Path) -> dict[str, Any]:
    """kind, jobs and options of a cluster's YAML file. Raises CaseError for one that is not like that."""
    import yaml

    try:
        data = yaml.safe_load(Path(path).read_text())
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise CaseError(f"cluster '{path}' cannot be read: {' '.join(str(error).split())}") from None
    if not isinstance(data, dict):
        raise CaseError(f"cluster '{path}': kind, jobs and options are needed")
    problems = [f"cluster '{path}': unknown key '{name}'{nearest(str(name), ('kind', 'jobs', 'options'))}"
                for name in data if name not in ("kind", "jobs", "options")]  # fmt: skip
    kind, jobs, options = data.get("kind", "slurm"), data.get("jobs"), data.get("options") or {}
    if kind not in KINDS:
        problems.append(f"cluster '{path}': kind: got {kind!r}{nearest(str(kind), KINDS)}")
    if not isinstance(jobs, int) or isinstance(jobs, bool) or jobs < 1:
        problems.append(f"cluster '{path}': jobs: got {jobs!r}; must be the number of workers, at least 1")
    if not isinstance(options, dict):
        problems.append(f"cluster '{path}': options: got {options!r}; must be names and values")
    if problems:
        raise CaseError(problems)
    return {"kind": kind, "jobs": jobs, "options": options}


class Cluster:
    """A client of a Dask cluster. Use it as a context manager: what it started is stopped after."""

    def __init__(self, folder: Folder, scheduler: str | None, description: Mapping[str, Any] | None) -> None:
        self.folder, self.scheduler, self.description = folder, scheduler, description
        self.client: Any = None
        self._stack = contextlib.ExitStack()

    def __enter__(self) -> Cluster:
        try:
            from distributed import Client
        except ImportError:
            raise CaseError("a cluster needs Dask: install floatsim[cluster]") from None
        try:
            address: Any = self.scheduler
            if self.description is not None:
                address = self._stack.enter_context(self._start())
            try:
                self.client = self._stack.enter_context(Client(address, timeout=20, set_as_default=False))
            except (OSError, ValueError) as error:
                raise CaseError(f"there is no Dask scheduler at '{address}': {error}") from None
            self._check()
        except BaseException:
            self._stack.close()
            raise
        return self

    def __exit__(self, *args: object) -> None:
        self._stack.close()

    def _start(self) -> Any:
        assert self.description is not None
        kind, jobs, options = (self.description[name] for name in ("kind", "jobs", "options"))
        try:
            if kind == "local":
                from distributed import LocalCluster

                own = {"threads_per_worker": 1, "dashboard_address": None, **options}
                return LocalCluster(n_workers=jobs, processes=True, **own)
            import dask_jobqueue

            cluster = getattr(dask_jobqueue, KINDS[kind])(**{"cores": 1, "processes": 1, **options})
            cluster.scale(jobs)
            return cluster
        except ImportError:
            raise CaseError(f"a cluster of kind '{kind}' needs dask-jobqueue: install floatsim[cluster]") from None
        except (TypeError, ValueError, RuntimeError, OSError) as error:
            raise CaseError(f"cluster of kind '{kind}' could not be started: {error}") from None

    def _check(self) -> None:
        """Wait for a worker; refuse workers that would spoil results."""
        if not self.client.scheduler_info(n_workers=-1)["workers"]:
            print("waiting for the first worker of the cluster ...", file=sys.stderr)
            self.client.wait_for_workers(1)
        workers = self.client.scheduler_info(n_workers=-1)["workers"]
        problems = [f"worker '{name}' has {w['nthreads']} threads; start workers with --nthreads 1: a case needs a "
                    "process of its own" for name, w in workers.items() if w["nthreads"] != 1]  # fmt: skip
        try:
            looks = self.client.run(look, str(self.folder.path.resolve()))
        except Exception as error:
            raise CaseError(f"workers of the cluster cannot import floatsim {__version__}: {error}") from None
        for name, (version, writable, threads) in looks.items():
            if version != __version__:
                problems.append(f"worker '{name}' has floatsim {version}, this is {__version__}")
            if not writable:
                problems.append(f"worker '{name}' cannot write '{self.folder.path.resolve()}': a folder that all share "
                                "is needed")  # fmt: skip
            if threads != "1":
                problems.append(f"worker '{name}' has OMP_NUM_THREADS={threads!r}; start it with 1 (its nanny does)")
        if problems:
            raise CaseError(problems)

    @property
    def width(self) -> int:
        """Cases at a time."""
        return max(len(self.client.scheduler_info(n_workers=-1)["workers"]), 1)

    def size_of(self, case: Case) -> int | None:
        """Bytes that the files of a case will take; None if that cannot be found."""
        try:
            return int(self.client.submit(_size, case.as_dict(), pure=False).result(timeout=300))
        except Exception:  # the case itself will say it
            return None

    def records(self, cases: Iterator[Case]) -> Iterator[Record]:
        """The record of every case, as they come; a few are ahead of the workers."""
        import queue

        from distributed.scheduler import KilledWorker

        ready: queue.Queue[Any] = queue.Queue()
        under_way: dict[Any, tuple[Case, int]] = {}
        again: deque[tuple[Case, int]] = deque()
        more, width, asked = True, self.width, clock.monotonic()

        def submit(case: Case, lost: int) -> None:
            future = self.client.submit(run_dict, case.as_dict(), str(self.folder.path.resolve()), pure=False,
                                        key=f"{case.id}-{lost}-{clock.time_ns()}")  # fmt: skip
            under_way[future] = case, lost
            future.add_done_callback(ready.put)

        try:
            while True:
                if clock.monotonic() - asked > 10.0:
                    width, asked = self.width, clock.monotonic()
                while again:
                    submit(*again.popleft())
                while more and len(under_way) < AHEAD * width:
                    case = next(cases, None)
                    if case is None:
                        more = False
                    else:
                        submit(case, 0)
                if not under_way:
                    return
                try:
                    future = ready.get(timeout=0.5)
                except queue.Empty:
                    continue
                case, lost = under_way.pop(future)
                error = future.exception() if future.status == "error" else None
                if future.status == "finished":
                    yield Record(**future.result())
                elif isinstance(error, KilledWorker) and lost < LOST:
                    again.append((case, lost + 1))  # it says itself when it has had enough attempts
                else:
                    yield self.folder.died(case.id, "killed", " ".join(str(error or future.status).split()))
        finally:
            for future in under_way:
                with contextlib.suppress(Exception):
                    future.cancel()


def _size(data: dict[str, Any]) -> int:
    from floatsim.cases.run_case import size_of

    return size_of(Case.from_dict(data))
