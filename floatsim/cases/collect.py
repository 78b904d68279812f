"""One data set of all cases of a matrix: summary.nc.

Along `case`, in the order of the matrix: the matrix's variables, `case_id` and `status` (done, failed, missing) as
coordinates; every statistic of every case; `failure` and `failure_message` of those that failed. What a case does not
have is nan. Lines of cases may differ in their number of elements: dimensions are as long as the longest, the rest is
nan, and arc lengths that differ from case to case have a `case` dimension.

A case is read once, some hundred of them are held in memory at a time, so neither time nor memory grows faster than
the number of cases. The dimensions of all are read before, from the first bytes of their files.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from floatsim.cases.case import Case
from floatsim.cases.classic import STRING, Classic, dimensions, read_classic
from floatsim.cases.folder import Folder
from floatsim.errors import CaseError
from floatsim.version import __version__

MEMORY = 100e6  # bytes of results held at a time
TAKEN = ("case", "case_id", "status", "failure", "failure_message", "time_reached", "wall_time", "steps",
         "newton_iterations")  # fmt: skip
_PER_CASE = {
    "wall_time": ("s", "wall time of the case"), "steps": ("1", "time steps"),
    "newton_iterations": ("1", "Newton iterations"), "time_reached": ("s", "simulated time reached"),
}  # fmt: skip
Sizes = dict[str, int]


@dataclass
class _Places:
    """A coordinate along one dimension, in all cases: what there is, each once, and which one a case has."""

    dim: str
    attributes: dict[str, Any]
    kinds: list[Any] = field(default_factory=list)
    numbers: dict[bytes, int] = field(default_factory=dict)
    of_case: dict[int, int] = field(default_factory=dict)

    def add(self, case: int, values: Any) -> None:
        """The coordinate of one more case."""
        key = repr(values.tolist()).encode() if values.dtype.kind in "OU" else values.tobytes()
        if key not in self.numbers:
            self.numbers[key] = len(self.kinds)
            self.kinds.append(values)
        self.of_case[case] = self.numbers[key]


def collect(
    folder: str | Path, output: str | Path | None = None, progress: Callable[[int, int], None] | None = None
) -> Path:
    """Write the summary of a results folder and return its path; default: FOLDER/summary.nc, replaced if it exists.

    progress(done, all) after each case. Raises CaseError if the folder holds no matrix, if cases disagree on the
    dimensions of a variable or the labels along one, and if the file cannot be written (then nothing is left behind).
    """
    place = Path(folder)
    name, script, cases, units = _matrix(place)
    target = Path(output) if output is not None else place / "summary.nc"
    _check_target(target)
    every = {k: place / "cases" / f"{case.id}.stats.nc" for k, case in enumerate(cases)}
    files = {k: path for k, path in every.items() if path.is_file()}  # more may come while we read
    sizes, broken = _sizes(files)
    part = target.with_name(f".{target.name}.{os.getpid()}")
    try:
        with _Summary(part, len(cases), sizes) as summary:
            for k, case in enumerate(cases):
                if k in files and k not in broken:
                    summary.add(k, case.id, _read(files[k]))
                if progress is not None:
                    progress(k + 1, len(cases))
            summary.flush()
            summary.coordinates()
            records = [_status(place, case, summary, k, broken) for k, case in enumerate(cases)]
            summary.cases(cases, units, records)
            summary.about({"Conventions": "CF-1.8", "title": "summary of load cases", "floatsim_version": __version__})
            summary.about({"matrix": name, "matrix_file": Path(script).name, **_settings(cases)})
        os.replace(part, target)
    except (OSError, RuntimeError) as error:
        raise CaseError(f"summary '{target}' cannot be written: {getattr(error, 'strerror', None) or error}") from None
    finally:
        part.unlink(missing_ok=True)
    return target


def _check_target(path: Path) -> None:
    """Refuse to replace a folder, or a file that holds no data set."""
    if path.is_dir():
        raise CaseError(f"output '{path}' is a folder; give a file name")
    if path.is_file():
        with path.open("rb") as file:
            if file.read(4) not in (b"", b"\x89HDF"):
                raise CaseError(f"output '{path}' exists and is no summary; choose another name")


# -- what there is --------------------------------------------------------------------------------


def _matrix(folder: Path) -> tuple[str, str, tuple[Case, ...], dict[str, str]]:
    """Name, path, cases and units of the variables."""
    try:
        data = json.loads((folder / "matrix.json").read_bytes())
        cases = tuple(Case.from_dict(item) for item in data["cases"])
        name, path, units = str(data["name"]), str(data["path"]), dict(data.get("units", {}))
    except (OSError, ValueError, KeyError, TypeError):
        raise CaseError(f"'{folder}' is no results folder of a matrix: run its cases first") from None
    if not cases:
        raise CaseError(f"'{folder}': its matrix has no cases")
    return name, path, cases, units


def _settings(cases: Sequence[Case]) -> dict[str, Any]:
    """What all cases have in common, for the head of the file."""
    own = [{"model": Path(c.model).name, "study": c.run.study, "duration": c.run.duration, "ramp": c.run.ramp,
            "dt": c.run.dt, "interval": c.run.interval, "block": c.run.block} for c in cases]  # fmt: skip
    return {name: value for name, value in own[0].items() if value is not None and all(o[name] == value for o in own)}


def _sizes(files: Mapping[int, Path]) -> tuple[Sizes, set[int]]:
    """Largest size of every dimension, and the cases whose files cannot be read."""
    sizes: Sizes = {}
    broken = set()
    for k, path in files.items():
        try:
            for dim, size in dimensions(path).items():
                if not dim.startswith(STRING):
                    sizes[dim] = max(size, sizes.get(dim, 0))
        except (OSError, ValueError):
            broken.add(k)
    return sizes, broken


def _read(path: Path) -> Classic | None:
    """The statistics of a case; None for a file that is damaged."""
    try:
        return read_classic(path)
    except (OSError, ValueError):
        return None


def _status(folder: Path, case: Case, summary: _Summary, k: int, broken: set[int]) -> dict[str, Any]:
    """Status, failure and counters of a case."""
    if k in summary.numbers:
        return {"status": "done", **summary.numbers[k]}
    if k in broken or k in summary.damaged:
        said = f"{case.id}.stats.nc cannot be read; without it the case runs again"
        return {"status": "failed", "failure": "unreadable", "failure_message": said}
    record = Folder(folder).record(case.id)
    if record is None or record.status == "done":  # it came while we read
        return {"status": "missing"}
    return {"status": "failed", "failure": record.kind, "failure_message": record.message,
            "time_reached": record.time_reached, "wall_time": record.wall_time}  # fmt: skip


# -- the file -------------------------------------------------------------------------------------


class _Summary:
    """The file as it grows: cases gather in memory, variables are made when a case first has them."""

    def __init__(self, path: Path, n: int, sizes: Sizes) -> None:
        import netCDF4

        self._n, self._sizes = n, {"case": n, **sizes}
        self._file: Any = netCDF4.Dataset(str(path), "w", format="NETCDF4")
        for dim, size in self._sizes.items():
            self._file.createDimension(dim, size)
        self._held: list[tuple[int, Classic]] = []
        self._bytes = 0
        self._dims: dict[str, tuple[str, ...]] = {}
        self._first: dict[str, str] = {}  # variable -> the case that brought it
        self._places: dict[str, _Places] = {}
        self._attributes: dict[str, dict[str, Any]] = {}
        self._named: set[str] = set()  # coordinates that variables name
        self._beside: dict[str, list[str]] = {}  # variable -> coordinates that it names
        self.numbers: dict[int, dict[str, float]] = {}
        self.damaged: set[int] = set()

    def __enter__(self) -> _Summary:
        return self

    def __exit__(self, *error: object) -> None:
        self._file.close()

    def add(self, k: int, case_id: str, read: Classic | None) -> None:
        """The statistics of case number k. Raises CaseError if a variable has other dimensions than before."""
        if read is None:
            self.damaged.add(k)
            return
        for name in read.values.keys() - self._first.keys():
            self._attributes[name] = {key: text for key, text in read.attributes[name].items() if key != "_Encoding"}
            self._named.update(self._attributes[name].get("coordinates", "").split())
        read.attributes = {}  # of the first case that has a variable: they would fill the memory
        for name in [*read.values]:
            dims = read.dims[name]
            if self._dims.setdefault(name, dims) != dims:
                raise CaseError(
                    f"collect: '{name}' is along {dims or 'nothing'} in case {case_id}, but along "
                    f"{self._dims[name] or 'nothing'} in case {self._first[name]}: they cannot stand in one data set"
                )
            self._first.setdefault(name, case_id)
            if len(dims) == 1 and (name in self._named or name == dims[0]):
                place = self._places.setdefault(name, _Places(dims[0], self._attributes[name]))
                place.add(k, read.values.pop(name))
        self.numbers[k] = {name: float(read.about[name]) for name in _PER_CASE if name in read.about}
        self._held.append((k, read))
        self._bytes += sum(values.nbytes for values in read.values.values())
        if self._bytes > MEMORY:
            self.flush()

    def flush(self) -> None:
        """Write what is held: for every variable the cases at once, from the first to the last that are held."""
        if not self._held:
            return
        first, last = self._held[0][0], self._held[-1][0]
        for name in sorted({name for _, read in self._held for name in read.values}):
            shape = [self._sizes[dim] for dim in self._dims[name]]
            rows = np.full((last - first + 1, *shape), np.nan)
            for k, read in self._held:
                values = read.values.get(name)
                if values is not None and values.shape == rows.shape[1:]:
                    rows[k - first] = values
                elif values is not None:
                    rows[(k - first, *(slice(0, size) for size in values.shape))] = values  # type: ignore[index]
            if name not in self._file.variables:
                self._make(name, dict(self._attributes[name]))
            self._file.variables[name][first : last + 1] = rows
        self._held, self._bytes = [], 0

    def _make(self, name: str, attributes: dict[str, Any]) -> None:
        self._beside[name] = str(attributes.pop("coordinates", "")).split()
        variable = self._file.createVariable(name, "f8", ("case", *self._dims[name]), fill_value=np.nan)
        variable.set_auto_mask(False)
        variable.setncatts(attributes)

    def coordinates(self) -> None:
        """Coordinates along other dimensions: once where all cases agree, else for every case. Raises CaseError for
        labels that differ."""
        for name, place in sorted(self._places.items()):
            size = self._sizes[place.dim]
            longest = max(place.kinds, key=len)
            labels = longest.dtype == object
            if labels and any(list(kind) != list(longest[: len(kind)]) for kind in place.kinds):
                raise CaseError(f"collect: cases have different labels along '{place.dim}': they cannot be joined")
            if labels or len(place.kinds) == 1 or name == place.dim or name.startswith("block"):
                variable = self._file.createVariable(name, str if labels else "f8", (place.dim,))
                variable[:] = longest
            else:
                rows = np.full((self._n, size), np.nan)
                for k, number in place.of_case.items():
                    rows[k, : len(place.kinds[number])] = place.kinds[number]
                variable = self._file.createVariable(name, "f8", ("case", place.dim), fill_value=np.nan)
                variable[:] = rows
            variable.setncatts(place.attributes)

    def cases(self, cases: Sequence[Case], units: Mapping[str, str], records: Sequence[Mapping[str, Any]]) -> None:
        """What is known of every case: variables, identity, status, failure, counters."""
        names = list(dict.fromkeys(name for case in cases for name in case.variables))
        called = {name: f"case_{name}" if name in self._file.variables or name in self._sizes or name in TAKEN else name
                  for name in names}  # fmt: skip
        self._column("case", [case.number for case in cases], "number of the case in the matrix", "1")
        self._column("case_id", [case.id for case in cases], "name of the case's files")
        self._column("status", [record["status"] for record in records], "done, failed or missing")
        for name in names:
            values = [case.variables.get(name) for case in cases]
            self._column(called[name], values, f"{name} of the matrix", units.get(name, _unit(name)))
        self._column("failure", [record.get("failure", "") for record in records], "kind of failure")
        said = [record.get("failure_message", "") for record in records]
        self._column("failure_message", said, "what was said when the case failed")
        for name, (unit, text) in _PER_CASE.items():
            self._column(name, [float(record.get(name, np.nan)) for record in records], text, unit)
        beside = " ".join(["case_id", "status", *called.values()])
        for name, variable in self._file.variables.items():
            if name != "case" and variable.dimensions[:1] == ("case",) and name not in beside.split():
                variable.coordinates = " ".join([beside, *self._beside.get(name, [])])
        counts = [record["status"] for record in records]
        self.about({f"cases_{what}": np.int32(counts.count(what)) for what in ("done", "failed", "missing")})
        self.about({"variables": json.dumps(list(called.values()))})

    def _column(self, name: str, values: Sequence[Any], long_name: str, units: str = "") -> None:
        """A value for every case: whole numbers, numbers, truth values or text, as the values are."""
        numbers = [v for v in values if v is not None]
        truth = bool(numbers) and all(isinstance(v, bool) for v in values)
        kind: Any = str
        if truth:
            kind = "i1"
        elif numbers and all(isinstance(v, int) and not isinstance(v, bool) and abs(v) < 2**63 for v in values):
            kind = "i8"
        elif numbers and all(isinstance(v, int | float) and not isinstance(v, bool) for v in numbers):
            kind = "f8"
        fill = np.nan if kind == "f8" else None
        variable = self._file.createVariable(name, kind, ("case",), fill_value=fill)
        if kind is str:
            variable[:] = np.array(["" if v is None else str(v) for v in values], dtype=object)
        else:
            variable[:] = np.array([np.nan if v is None else v for v in values])
        variable.setncatts({"long_name": long_name, **({"units": units} if units and kind is not str else {}),
                            **({"dtype": "bool"} if truth else {})})  # fmt: skip

    def about(self, attributes: Mapping[str, Any]) -> None:
        """Attributes of the whole."""
        self._file.setncatts(attributes)


def _unit(name: str) -> str:
    """Unit that a variable's name tells."""
    known = {"hs": "m", "tp": "s", "tz": "s", "depth": "m", "seed": "1"}
    ends = {"_deg": "degree", "_speed": "m/s"}
    return known.get(name) or next((unit for end, unit in ends.items() if name.endswith(end)), "")
