"""The netCDF store: one file per run, written while it runs, readable at any moment.

Samples gather in memory and go to the file every 256 samples or 5 s of wall clock, whichever comes first: a chunk's
data, then its `time`, then `sync()`. A reader therefore never sees a time without its data, and a process that is
killed leaves a file with everything up to the last chunk and `status` = running. HDF5 file locking is off for the
writer, so that plain `xarray.open_dataset` works meanwhile.

Attributes follow the CF conventions 1.8 (`units`, `long_name`, `coordinates`); a variable whose entries along `dof`
have different units says `units` = mixed and lists them in `units_dof`.
"""

from __future__ import annotations

import contextlib
import math
import os
import re
import shutil
import time as clock
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from floatsim.errors import CaseError

# HDF5 reads it once, when the library comes up, which may be for a hydrodynamic database: so set on import
os.environ.setdefault("HDF5_USE_FILE_LOCKING", "FALSE")

SAMPLES = 256  # a chunk is written after so many samples
SECONDS = 5.0  # or so much wall clock
TIME_ATTRIBUTES = {"long_name": "simulated time", "units": "s"}
_SMALL = 65536  # bytes; variables with less in 256 samples get chunks of 1024
_NAME = re.compile(r"[a-z0-9_]+")


@dataclass(frozen=True)
class Coordinate:
    """Values along one dimension: an index coordinate if name equals dim, else an auxiliary one.

    values: numbers or labels, (n,). They also give the dimension its size.
    """

    name: str
    long_name: str
    units: str
    dim: str
    values: Sequence[Any] | NDArray[Any]

    @property
    def attributes(self) -> dict[str, str]:
        """The variable's attributes."""
        return {"long_name": self.long_name, "units": self.units}


@dataclass(frozen=True)
class Channel:
    """An output variable with dimensions (time, *dims). dtype: 'float' takes the file's precision, or 'int32'.

    units_dof: units along `dof` where they differ; units is then 'mixed'.
    """

    name: str
    long_name: str
    units: str
    dims: tuple[str, ...] = ()
    dtype: Literal["float", "int32"] = "float"
    units_dof: str = ""

    @property
    def attributes(self) -> dict[str, str]:
        """The variable's attributes."""
        own = {"long_name": self.long_name, "units": self.units}
        return {**own, "units_dof": self.units_dof} if self.units_dof else own


class Writer:
    """Streams samples to a netCDF file. Use it as a context manager: an exception closes the file as failed.

    path: an existing file is replaced. channels: what each sample holds. coordinates: at least one for every dimension
    that channels use. attributes: global ones (text and numbers). precision: of the 'float' channels; time is always
    float64. samples: how many will come, if known: room on the disk is then checked first. `width` is the number of
    values in a sample.

    Raises CaseError, naming the path, if the file cannot be written; nothing is left behind then.
    """

    def __init__(
        self,
        path: str | Path,
        channels: Sequence[Channel],
        coordinates: Sequence[Coordinate] = (),
        attributes: Mapping[str, str | int | float] | None = None,
        precision: Literal["float64", "float32"] = "float64",
        samples: int | None = None,
    ) -> None:
        self.path = Path(path)
        self.channels = tuple(channels)
        sizes = _checked_sizes(self.channels, coordinates, precision)
        for name, value in (attributes or {}).items():
            if not isinstance(name, str) or not isinstance(value, str | int | float | np.integer | np.floating):
                raise CaseError(f"attribute {name!r}: got {value!r}; must be text or a number")
        shapes = [tuple(sizes[d] for d in c.dims) for c in self.channels]
        ends = np.cumsum([0, *(math.prod(s) for s in shapes)])
        self.width = int(ends[-1])
        check_path(self.path)
        if samples is not None:
            _check_room(self.path, samples * (8 + self.width * np.dtype(precision).itemsize))
        self._shapes = shapes
        self._columns = [slice(int(a), int(b)) for a, b in zip(ends, ends[1:])]
        self._rows = np.zeros((SAMPLES, self.width))
        self._times = np.zeros(SAMPLES)
        self._held = 0  # samples in memory
        self._written = 0  # samples in the file
        self._due = clock.monotonic() + SECONDS
        self._create(sizes, coordinates, dict(attributes or {}), precision)

    @classmethod
    def continued(
        cls, path: str | Path, channels: Sequence[Channel], coordinates: Sequence[Coordinate],
        attributes: Mapping[str, str | int | float], precision: Literal["float64", "float32"], samples: int,
        kept: int, until: float,
    ) -> Writer:  # fmt: skip
        """A writer that goes on after the first `kept` samples of an existing file, the last of them at `until` [s].

        netCDF cannot cut a dimension, and a file whose writer was killed is better not opened for writing: the samples
        are copied to a new file beside it, which takes the name when it is whole. Raises CaseError if the file is
        missing, unreadable, or does not hold these channels and samples.
        """
        path = Path(path)
        check_path(path)
        temporary = path.with_name(f".{path.name}.part")
        writer: Writer | None = None
        import netCDF4

        try:
            with netCDF4.Dataset(str(path)) as old:
                old.set_auto_mask(False)
                writer = cls(temporary, channels, coordinates, attributes, precision, samples)
                writer._copy(old, path, kept, until)
            os.replace(temporary, path)
        except (OSError, RuntimeError) as error:
            _discard(writer, temporary)
            raise CaseError(f"output file '{path}' cannot be continued: {error}") from None
        except CaseError:
            _discard(writer, temporary)
            raise
        writer.path = path
        return writer

    def _copy(self, old: Any, path: Path, kept: int, until: float) -> None:
        """Take the first samples of another file over."""
        mine = {"time": self._time, **{c.name: v for c, v in zip(self.channels, self._variables, strict=True)}}
        for name, variable in mine.items():
            there = old.variables.get(name)
            if there is None or there.shape[1:] != variable.shape[1:] or there.dtype != variable.dtype:
                raise CaseError(f"output file '{path}' cannot be continued: it has another '{name}'")
        times = old.variables["time"]
        if len(times) < kept or (kept and float(times[kept - 1]) != until):
            raise CaseError(
                f"output file '{path}' cannot be continued: the checkpoint was made with {kept} samples until "
                f"t = {until:g} s, the file holds {len(times)}"
                + (f" until {float(times[-1]):g} s" if len(times) else "")
            )
        self._file.set_auto_mask(False)
        for start in range(0, kept, SAMPLES):
            end = min(start + SAMPLES, kept)
            for name, variable in mine.items():
                variable[start:end] = old.variables[name][start:end]
        self._written = kept
        self._file.sync()

    # -- the file -----------------------------------------------------------------------------

    def _create(
        self, sizes: dict[str, int], coordinates: Sequence[Coordinate], attributes: dict[str, Any], precision: str
    ) -> None:
        import netCDF4

        with self._naming_path("cannot be written"):
            self._file: Any = netCDF4.Dataset(str(self.path), "w", format="NETCDF4")
        try:
            with self._naming_path("cannot be written"):
                self._file.setncatts({"Conventions": "CF-1.8", **attributes, "status": "running", "failure": ""})
                self._define(sizes, coordinates, precision)
                self._file.sync()
        except CaseError:
            with contextlib.suppress(OSError, RuntimeError):
                self._file.close()
            self.path.unlink(missing_ok=True)
            raise

    def _define(self, sizes: dict[str, int], coordinates: Sequence[Coordinate], precision: str) -> None:
        file = self._file
        file.createDimension("time", None)
        for name, size in sizes.items():
            file.createDimension(name, size)
        self._time = self._variable("time", "f8", ("time",), (1024,))
        self._time.setncatts(TIME_ATTRIBUTES)
        for item in coordinates:
            values = np.asarray(item.values)
            kind: Any = values.dtype if values.dtype.kind in "fiu" else str
            variable = file.createVariable(item.name, kind, (item.dim,))
            variable.setncatts(item.attributes)
            variable[:] = values if kind is not str else values.astype(object)
        self._variables = []
        for channel, shape in zip(self.channels, self._shapes):
            kind = channel.dtype if channel.dtype != "float" else precision
            size = math.prod(shape) * np.dtype(kind).itemsize
            steps = 1024 if SAMPLES * size < _SMALL else SAMPLES
            variable = self._variable(channel.name, kind, ("time", *channel.dims), (steps, *shape))
            variable.setncatts(channel.attributes)
            beside = [c.name for d in channel.dims for c in coordinates if c.dim == d != c.name]
            if beside:
                variable.setncattr("coordinates", " ".join(beside))
            self._variables.append(variable)

    def _variable(self, name: str, kind: str, dims: tuple[str, ...], chunks: tuple[int, ...]) -> Any:
        fill = np.nan if kind != "int32" and name != "time" else None  # a chunk cut off by a kill reads as missing
        variable = self._file.createVariable(name, kind, dims, chunksizes=chunks, fill_value=fill)
        # the library's own cache, tens of megabytes a variable, would grow with the length of the run
        size = math.prod(chunks) * np.dtype(kind).itemsize
        variable.set_var_chunk_cache(size=2 * size + 1, nelems=11, preemption=1.0)
        return variable

    @contextlib.contextmanager
    def _naming_path(self, what: str) -> Iterator[None]:
        try:
            yield
        except (OSError, RuntimeError) as error:
            raise CaseError(f"output file '{self.path}' {what}: {error}; choose a writable place with room") from None

    # -- samples ------------------------------------------------------------------------------

    def append(self, time: float, values: ArrayLike) -> None:
        """One sample at `time` [s]. values (width,): all channels one after the other, each in C order.

        Raises CaseError, naming the path, if a chunk that is due cannot be written.
        """
        k = self._held
        self._times[k] = time
        self._rows[k] = values
        self._held = k + 1
        if k + 1 == SAMPLES or clock.monotonic() >= self._due:
            self.flush()

    def flush(self) -> None:
        """Bring all samples to the file, so that readers see them."""
        n, start = self._held, self._written
        if n:
            with self._naming_path(f"could not be continued after {start} samples"):
                for variable, columns, shape in zip(self._variables, self._columns, self._shapes):
                    variable[start : start + n] = self._rows[:n, columns].reshape(n, *shape)
                self._time[start : start + n] = self._times[:n]
                self._file.sync()
            self._held, self._written = 0, start + n
        self._due = clock.monotonic() + SECONDS

    def secure(self) -> None:
        """Bring all samples to the disk itself: what a checkpoint counts on."""
        self.flush()
        with self._naming_path(f"could not be continued after {self._written} samples"):
            file = os.open(self.path, os.O_RDONLY)
            try:
                os.fsync(file)
            finally:
                os.close(file)

    def close(
        self, status: Literal["done", "failed"], failure: str = "",
        attributes: Mapping[str, str | float] | None = None,
    ) -> None:  # fmt: skip
        """Write what is left, state how the run ended and close. Does nothing on a closed file."""
        if not self._file.isopen():
            return
        try:
            self.flush()
            with self._naming_path("could not be finished"):
                self._file.setncatts({"status": status, "failure": failure, **(attributes or {})})
        finally:
            with self._naming_path("could not be finished"):
                self._file.close()

    def __enter__(self) -> Writer:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error is None:
            self.close("done")
        else:
            with contextlib.suppress(CaseError):  # the first error is the one to tell
                self.close("failed", f"{type(error).__name__}: {error}")


def _discard(writer: Writer | None, path: Path) -> None:
    if writer is not None:
        with contextlib.suppress(CaseError, OSError, RuntimeError):
            writer._file.close()
    path.unlink(missing_ok=True)


def _checked_sizes(channels: Sequence[Channel], coordinates: Sequence[Coordinate], precision: str) -> dict[str, int]:
    """Dimension sizes. CaseError with all problems of names, dimensions and precision."""
    sizes: dict[str, int] = {}
    problems = []
    if precision not in ("float64", "float32"):
        problems.append(f"precision: got {precision!r}; must be 'float64' or 'float32'")
    for item in coordinates:
        size = len(np.asarray(item.values))
        if sizes.setdefault(item.dim, size) != size:
            problems.append(f"output '{item.name}' has {size} values, dimension '{item.dim}' has {sizes[item.dim]}")
    names = ["time", *(item.name for item in coordinates), *(c.name for c in channels)]
    for name in sorted({n for n in names if names.count(n) > 1}):
        problems.append(f"output '{name}' exists {names.count(name)} times; rename a part or a joint")
    for name in dict.fromkeys([*names, *sizes]):
        if not _NAME.fullmatch(name):
            problems.append(f"output '{name}': lower-case letters, digits and underscores are allowed")
    for channel in channels:
        for dim in channel.dims:
            if dim not in sizes:
                problems.append(f"output '{channel.name}': dimension '{dim}' has no coordinate")
    if problems:
        raise CaseError(problems)
    return sizes


def check_path(path: str | Path) -> None:
    """Raises CaseError, naming the path, if a result file could not be written there.

    An existing file is replaced if it holds results; other people's files and a model's inputs are not.
    """
    if not isinstance(path, str | Path) or not str(path).strip() or "\0" in str(path):
        raise CaseError(f"output file: got {path!r}; must be the path of the file to write")
    path = Path(path)
    folder = path.parent
    try:
        if not folder.is_dir():
            raise CaseError(f"output file '{path}': there is no folder '{folder}'; make it or choose another place")
        if path.is_dir():
            raise CaseError(f"output file '{path}' is a folder; give a file name")
        if not os.access(path if path.exists() else folder, os.W_OK):
            raise CaseError(f"output file '{path}' cannot be written: no permission; choose another place")
        if path.exists() and not path.is_file():
            raise CaseError(f"output file '{path}' is no ordinary file; choose another place")
        if path.exists() and not _replaceable(path):
            raise CaseError(f"output file '{path}' exists and holds no results of a run; choose another name")
    except OSError as error:  # a name that is too long
        raise CaseError(f"output file '{path}' cannot be written: {error.strerror}; choose another name") from None


def _replaceable(path: Path) -> bool:
    """Whether an existing file is empty, a result file, or the torso of one."""
    with path.open("rb") as file:
        start = file.read(4)
    if start not in (b"\x89HDF", b""):
        return False
    import netCDF4

    try:
        with netCDF4.Dataset(str(path)) as data:
            return "status" in data.ncattrs()
    except (OSError, RuntimeError):
        return True  # killed before its first sync


def _check_room(path: Path, size: int) -> None:
    free = shutil.disk_usage(path.parent).free
    if size > free:
        raise CaseError(
            f"output file '{path}' would take {size / 1e6:.0f} MB, there is room for {free / 1e6:.0f} MB; "
            "choose fewer channels, a longer interval, float32 or another place"
        )
