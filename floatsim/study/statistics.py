"""Statistics of a run while it goes: nothing of the series has to be kept.

Every entry of every channel has n, mean, M2 = sum (x - mean)^2, smallest and largest value, of the whole and of the
block at hand, updated sample by sample in one kernel (Welford 1962, Technometrics 4, 419-420):

    d = x - mean,    mean <- mean + d/n,    M2 <- M2 + d (x - mean)

Nothing is lost to cancellation, missing values (nan) are left out, and the numbers do not depend on how the run was
cut into pieces: those of a saved file are the same to the last bit.

Crossings of the mean need the mean, which is known at the end, and rainflow counting needs turning points in order. For
these the samples of channels that do not lie along a line, and of those asked for in `fatigue`, are held in memory,
8 bytes each: 13 MB for the 270 such values of a platform with five lines in 6000 samples. Periods and times of extremes
are those of held channels.

Rainflow: the four-point method of `fatpack` on the turning points themselves, without classes; every range of the
residue counts as half a cycle, which makes it the count of ASTM E1049-85 (5.4.4). With ranges S_i and counts n_i the
damage-equivalent load is the constant range that does the same damage on an S-N curve of exponent m:

    DEL = (sum n_i S_i^m / N)^(1/m),    N = 1 Hz times the time that the statistics cover
"""

from __future__ import annotations

import contextlib
import io
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from floatsim.description import is_number
from floatsim.errors import CaseError, nearest
from floatsim.frames import Array
from floatsim.jit import kernel
from floatsim.study.store import Channel, Coordinate

FREQUENCY = 1.0  # Hz, of the cycles of a damage-equivalent load
N, MEAN, M2, LOW, HIGH, BLOCK_LOW, BLOCK_HIGH = range(7)  # rows of the table
_SLACK = 1e-9  # relative, in comparing times


@kernel
def accumulate(table, row):  # type: ignore[no-untyped-def]
    """One more sample (width,) into the table (7, width); a nan changes nothing."""
    for i in range(row.shape[0]):
        y = row[i]
        if y == y:
            n = table[N, i] + 1.0
            d = y - table[MEAN, i]
            mean = table[MEAN, i] + d / n
            table[N, i] = n
            table[MEAN, i] = mean
            table[M2, i] += d * (y - mean)
            table[LOW, i] = min(table[LOW, i], y)
            table[HIGH, i] = max(table[HIGH, i], y)
            table[BLOCK_LOW, i] = min(table[BLOCK_LOW, i], y)
            table[BLOCK_HIGH, i] = max(table[BLOCK_HIGH, i], y)


@dataclass(frozen=True)
class StatisticsSettings:
    """What `simulate` is to take statistics of.

    start [s]: samples at and after this simulated time count; the ramp of waves is left out so. fatigue: channel ->
    exponent m of its S-N curve, for a damage-equivalent load of each of its entries. block [s]: length of the blocks
    that extremes are taken of, the first from start; the last may be shorter. Raises CaseError with all problems.
    """

    start: float = 0.0
    fatigue: Mapping[str, float] = field(default_factory=dict)
    block: float = 600.0

    def __post_init__(self) -> None:
        problems = []
        if not is_number(self.start) or self.start < 0.0:
            problems.append(f"statistics: start: got {self.start!r}; must be a number of seconds, not negative")
        if not is_number(self.block) or self.block <= 0.0:
            problems.append(f"statistics: block: got {self.block!r}; must be a positive number of seconds")
        if not isinstance(self.fatigue, Mapping):
            problems.append(f"statistics: fatigue: got {self.fatigue!r}; must be a dictionary, channel: exponent")
        else:
            problems += [
                f"statistics: fatigue: '{name}': got {m!r}; must be the exponent of an S-N curve, from 1 to 20"
                for name, m in self.fatigue.items()
                if not is_number(m) or not 1.0 <= m <= 20.0
            ]
        if problems:
            raise CaseError(problems)

    def as_dict(self) -> dict[str, Any]:
        """For JSON: StatisticsSettings(**settings.as_dict()) are the same."""
        fatigue = {str(name): float(m) for name, m in sorted(self.fatigue.items())}
        return {"start": float(self.start), "fatigue": fatigue, "block": float(self.block)}


@dataclass(frozen=True)
class Variable:
    """A result without time: name, dimensions, values (numbers or labels), attributes."""

    name: str
    dims: tuple[str, ...]
    values: Any
    attributes: Mapping[str, Any]


class Statistics:
    """Statistics of samples as they come; can be pickled and gone on with at any moment.

    layout: has `channels` and `coordinates` as a Sampler has them; samples are rows (width,), channels one after the
    other. `samples`, `first`, `last` [s] say what has come so far. `attributes` are written beside the results.

    Raises CaseError for channels in `fatigue` that are not among them.
    """

    def __init__(self, layout: Any, settings: StatisticsSettings) -> None:
        if not isinstance(settings, StatisticsSettings):
            raise CaseError(f"statistics: got {settings!r}; must be a floatsim.StatisticsSettings")
        self.settings = settings
        self.channels: tuple[Channel, ...] = tuple(layout.channels)
        self.coordinates: tuple[Coordinate, ...] = tuple(layout.coordinates)
        self.attributes: dict[str, Any] = {}
        names = [c.name for c in self.channels]
        unknown = [name for name in settings.fatigue if name not in names]
        if unknown:
            raise CaseError([f"statistics: fatigue: there is no channel '{n}'{nearest(n, names)}" for n in unknown])
        sizes = {item.dim: len(item.values) for item in self.coordinates}
        self._shapes = [tuple(sizes[dim] for dim in c.dims) for c in self.channels]
        ends = np.cumsum([0, *(int(np.prod(shape)) for shape in self._shapes)])
        self._columns = [slice(int(a), int(b)) for a, b in zip(ends[:-1], ends[1:])]
        self.width = int(ends[-1])
        held = [c.name in settings.fatigue or not _along_line(c) for c in self.channels]
        own = [np.arange(s.start, s.stop) for s, yes in zip(self._columns, held) if yes]
        self._held = np.concatenate([np.zeros(0, dtype=np.int64), *own])
        first = np.cumsum([0, *(s.stop - s.start if yes else 0 for s, yes in zip(self._columns, held))])
        self._held_at = [slice(int(a), int(b)) if yes else None for a, b, yes in zip(first[:-1], first[1:], held)]
        self._series = np.zeros((256, len(self._held)))
        self._times = np.zeros(256)
        self.samples = 0
        self._table = np.zeros((7, self.width))
        self._table[[LOW, BLOCK_LOW]], self._table[[HIGH, BLOCK_HIGH]] = np.inf, -np.inf
        self._block = 0
        self._block_extremes: list[Array] = []  # (2, width) of every finished block

    @property
    def times(self) -> Array:
        """Times of the samples that count (n,) [s]."""
        return self._times[: self.samples]

    def append(self, t: float, row: Array) -> None:
        """A sample (width,) at time t [s], later than those before; not looked at before `start`."""
        start, block = self.settings.start, self.settings.block
        if t < start - _SLACK * max(1.0, start):
            return
        at = max(0, int(np.ceil((t - start) / block - _SLACK)) - 1)  # a block holds its end, the first its start too
        while self._block < at:
            self._close_block()
        accumulate(self._table, row)
        if self.samples == len(self._times):
            more = max(256, self.samples)
            self._times = np.concatenate([self._times, np.zeros(more)])
            self._series = np.concatenate([self._series, np.zeros((more, len(self._held)))])
        self._times[self.samples] = t
        self._series[self.samples] = row[self._held]
        self.samples += 1

    def _close_block(self) -> None:
        self._block_extremes.append(self._table[BLOCK_LOW:].copy())
        self._table[BLOCK_LOW], self._table[BLOCK_HIGH] = np.inf, -np.inf
        self._block += 1

    # -- checkpoints ----------------------------------------------------------------------------

    def arrays(self) -> dict[str, Any]:
        """All that it needs to go on."""
        extremes = np.array(self._block_extremes).reshape(-1, 2, self.width)
        return {"of": self._identity(), "samples": self.samples, "block": self._block, "table": self._table,
                "extremes": extremes, "times": self.times, "series": self._series[: self.samples]}  # fmt: skip

    def restore(self, arrays: Mapping[str, Any]) -> None:
        """Go on as the statistics that gave `arrays`. Raises ValueError if those were of other channels or settings."""
        if list(arrays["of"]) != self._identity():
            raise ValueError(f"statistics are of {arrays['of']}, here of {self._identity()}")
        self.samples, self._block = int(arrays["samples"]), int(arrays["block"])
        self._table, self._block_extremes = np.array(arrays["table"]), [np.array(e) for e in arrays["extremes"]]
        self._times, self._series = np.array(arrays["times"]), np.array(arrays["series"])

    def _identity(self) -> list[str]:
        own = [repr(self.settings.as_dict())]
        return own + [f"{c.name} {shape}" for c, shape in zip(self.channels, self._shapes)]

    # -- results ------------------------------------------------------------------------------

    def dataset(self) -> Any:
        """Everything as an xarray Dataset without a time dimension. Raises CaseError if there are no samples."""
        import xarray

        every = {}
        for v in self.variables():  # which coordinates belong to it xarray knows by itself
            attributes = {name: text for name, text in v.attributes.items() if name != "coordinates"}
            every[v.name] = (v.dims, v.values, attributes)
        own = {v.name: every.pop(v.name) for v in self._coordinates()}
        return xarray.Dataset(every, own, self.all_attributes())

    def write(self, path: str | Path, attributes: Mapping[str, Any] | None = None) -> Path:
        """Write the results to a netCDF file, with attributes (text and numbers) added to its own.

        Raises CaseError if there are no samples or the file cannot be written; then nothing is left behind.
        """
        return write_variables(path, self.variables(), {**self.all_attributes(), **(attributes or {})})

    def table(self) -> tuple[list[str], list[list[str]]]:
        """Heads and rows for print: a row for every entry of a channel, of a line's the one with the largest value."""
        kinds = ["mean", "std", "min", "max", "period", "del"]
        found = {v.name: np.asarray(v.values) for v in self.variables()}
        labels = {c.dim: [str(label) for label in c.values] for c in self.coordinates if c.name == c.dim}
        rows = []
        for c, shape in zip(self.channels, self._shapes):
            units = c.units_dof.split() or [c.units]
            high = found[f"{c.name}_max"]
            entries = list(np.ndindex(shape))
            if _along_line(c):
                if len(shape) > 1:  # positions of nodes
                    continue
                entries = [np.unravel_index(np.nanargmax(high), shape)] if np.isfinite(high).any() else []
            for at in entries:
                place = [labels[dim][k] if dim in labels else f"{dim.rpartition('_')[2]} {k}"
                         for dim, k in zip(c.dims, at)]  # fmt: skip
                unit = units[at[0]] if len(units) > 1 else units[0]
                values = [found[f"{c.name}_{kind}"][at] if f"{c.name}_{kind}" in found else np.nan for kind in kinds]
                rows.append([" ".join([c.name, *place]), unit, *("" if np.isnan(y) else f"{y:.5g}" for y in values)])
        return ["channel", "unit", *kinds[:4], "period [s]", "DEL"], rows

    def all_attributes(self) -> dict[str, Any]:
        """Of the run and of the statistics."""
        self._some()
        return {
            **self.attributes, "statistics_start": float(self.times[0]), "statistics_end": float(self.times[-1]),
            "statistics_samples": self.samples, "statistics_block": float(self.settings.block),
        }  # fmt: skip

    def variables(self) -> list[Variable]:
        """Coordinates, then the statistics of every channel. Raises CaseError if there are no samples."""
        self._some()
        found = self._coordinates()
        with np.errstate(invalid="ignore", divide="ignore"):
            for k in range(len(self.channels)):
                found += self._of(k)
        return found

    def _some(self) -> None:
        if not self.samples:
            raise CaseError(f"statistics: there are no samples at or after the start, {self.settings.start:g} s")

    def _coordinates(self) -> list[Variable]:
        own = [Variable(c.name, (c.dim,), np.asarray(c.values), c.attributes) for c in self.coordinates]
        starts = self.settings.start + self.settings.block * np.arange(len(self._block_extremes) + 1)
        text = {"long_name": "simulated time at which the block starts", "units": "s"}
        return [*own, Variable("block_start", ("block",), starts, text)]

    def _of(self, k: int) -> Iterator[Variable]:
        """Statistics of channel number k."""
        c, shape, held = self.channels[k], self._shapes[k], self._held_at[k]
        table = self._table[:, self._columns[k]].reshape(7, *shape)
        gone = table[N] == 0.0
        beside = [item.name for dim in c.dims for item in self.coordinates if item.dim == dim != item.name]

        def variable(kind: str, what: str, values: Any, method: str = "", block: bool = False, **own: Any) -> Variable:
            text = {**c.attributes, "long_name": f"{c.long_name}; {what}", **own}
            if "units" in own:
                text.pop("units_dof", None)
            if method:
                text["cell_methods"] = f"time: {method}"
            names = [*beside, *(["block_start"] if block else [])]
            if names:
                text["coordinates"] = " ".join(names)
            return Variable(f"{c.name}_{kind}", (("block",) if block else ()) + c.dims, np.asarray(values), text)

        yield variable("mean", "mean", np.where(gone, np.nan, table[MEAN]), "mean")
        std = np.where(gone, np.nan, np.sqrt(table[M2] / table[N]))
        yield variable("std", "standard deviation", std, "standard_deviation")
        yield variable("min", "smallest value", np.where(gone, np.nan, table[LOW]), "minimum")
        yield variable("max", "largest value", np.where(gone, np.nan, table[HIGH]), "maximum")
        blocks = [e[:, self._columns[k]] for e in self._block_extremes] + [self._table[BLOCK_LOW:, self._columns[k]]]
        extremes = np.array(blocks).reshape(-1, 2, *shape)
        extremes = np.where(np.isinf(extremes), np.nan, extremes)
        yield variable("block_min", "smallest value of each block", extremes[:, 0], "minimum", True)
        yield variable("block_max", "largest value of each block", extremes[:, 1], "maximum", True)
        missing = self.samples - table[N]
        if (~gone & (missing > 0.0)).any() or c.name.endswith("_touchdown"):
            yield variable("missing", "number of samples without a value", missing, units="1")
        if c.name.endswith("_utilisation") and c.dims:
            text = {"long_name": f"{c.long_name}; largest along the line and in time", "units": "1"}
            yield Variable(c.name, (), np.max(table[HIGH], where=~gone, initial=-np.inf), text)
        if held is None:
            return
        x = self._series[: self.samples, held]
        for kind, what, worst in (("min_time", "smallest", np.argmin), ("max_time", "largest", np.argmax)):
            fill = np.where(np.isnan(x), np.inf if worst is np.argmin else -np.inf, x)
            when = np.where(gone, np.nan, self.times[worst(fill, axis=0)].reshape(shape))
            yield variable(kind, f"simulated time of the {what} value", when, units="s")
        period = mean_period(self.times, x).reshape(shape)
        yield variable("period", "mean period between upward crossings of the mean", period, units="s")
        if c.dims == ("dof",) and c.name.endswith("_position"):
            yield from _in_plan(c.name.removesuffix("_position"), x[:, :2])
        if c.name in self.settings.fatigue:
            m = float(self.settings.fatigue[c.name])
            cycles = FREQUENCY * float(self.times[-1] - self.times[0])
            loads = np.array([equivalent_load(column, m, cycles) for column in x.T]).reshape(shape)
            yield variable("del", f"damage-equivalent load at {FREQUENCY:g} Hz, m = {m:g}", loads,
                           exponent=m, reference_frequency=FREQUENCY)  # fmt: skip


def _along_line(channel: Channel) -> bool:
    return any(dim.endswith(("_node", "_element")) for dim in channel.dims)


def _in_plan(body: str, x: Array) -> Iterator[Variable]:
    """Covariance of surge and sway (n, 2) [m], and statistics of the horizontal distance from the drawing position."""
    d, offset = x - x.mean(axis=0), np.hypot(x[:, 0], x[:, 1])
    text = f"{body}: horizontal distance of the reference point from the drawing position"
    cov = {"long_name": f"{body}_position; covariance of surge and sway", "units": "m2"}
    yield Variable(f"{body}_position_surge_sway_cov", (), np.asarray(np.mean(d[:, 0] * d[:, 1])), cov)
    for kind, what, y in (("mean", "mean", offset.mean()), ("std", "standard deviation", offset.std()),
                          ("min", "smallest value", offset.min()), ("max", "largest value", offset.max())):  # fmt: skip
        yield Variable(f"{body}_offset_{kind}", (), np.asarray(y), {"long_name": f"{text}; {what}", "units": "m"})


def mean_period(t: Array, x: Array) -> Array:
    """Mean time between upward crossings of the mean (k,) [s], of series (n, k) at times (n,), crossings by linear
    interpolation; nan for fewer than two crossings and where values are missing."""
    level = x.mean(axis=0)
    under = x < level
    up = under[:-1] & ~under[1:]
    count = up.sum(axis=0)
    if len(up) == 0:
        return np.full(x.shape[1], np.nan)
    column = np.arange(x.shape[1])

    def crossing(i: Any) -> Array:
        a, b = x[i, column], x[i + 1, column]
        return np.asarray(t[i] + (level - a) / (b - a) * (t[i + 1] - t[i]))

    with np.errstate(invalid="ignore", divide="ignore"):
        first, last = crossing(up.argmax(axis=0)), crossing(len(up) - 1 - up[::-1].argmax(axis=0))
        return np.where((count > 1) & np.isfinite(level), (last - first) / (count - 1), np.nan)


def turning_points(x: Array) -> Array:
    """First and last value of a series and all its peaks and valleys in between."""
    x = x[np.concatenate([[True], x[1:] != x[:-1]])]
    rising = x[1:] > x[:-1]
    return x[np.concatenate([[True], rising[1:] != rising[:-1], [True]])] if len(x) > 1 else x


def rainflow(x: Array) -> tuple[Array, Array]:
    """Ranges and their counts, 1 or 0.5, by rainflow counting of a series; ASTM E1049-85, 5.4.4."""
    import fatpack

    cycles, residue = fatpack.find_rainflow_cycles(turning_points(np.asarray(x, dtype=float)).tolist())
    whole, half = np.abs(np.diff(cycles.reshape(-1, 2), axis=1)).ravel(), np.abs(np.diff(residue))
    return np.concatenate([whole, half]), np.repeat([1.0, 0.5], [len(whole), len(half)])


def equivalent_load(x: Array, m: float, cycles: float) -> float:
    """Range that does in `cycles` cycles the damage of series x (n,) on an S-N curve of exponent m; nan if values are
    missing or there are no cycles."""
    if np.isnan(x).any() or cycles <= 0.0:
        return float("nan")
    ranges, counts = rainflow(x)
    largest = ranges.max(initial=0.0)
    if largest == 0.0:
        return 0.0
    return float(largest * (np.sum(counts * (ranges / largest) ** m) / cycles) ** (1.0 / m))


# -- of what is there already -----------------------------------------------------------------


@dataclass(frozen=True)
class _Layout:
    channels: tuple[Channel, ...]
    coordinates: tuple[Coordinate, ...]


def statistics(
    source: Any, start: float = 0.0, fatigue: Mapping[str, float] | None = None, block: float = 600.0
) -> Statistics:
    """Statistics of a finished run or a result file, the same that a run takes itself; see StatisticsSettings.

    source: a Run, or the path of a file, which is read block by block. Numbers of float32 files are those of rounded
    samples. Raises CaseError for a file that cannot be read, unknown channels, and a start after the last sample.
    """
    from floatsim.study.ranges import open_results, span
    from floatsim.study.simulate import Run

    settings = StatisticsSettings(start, fatigue or {}, block)
    if isinstance(source, Run):
        source.check_kept()
    if isinstance(source, Run) and source.path is None:
        result = Statistics(source.sampler, settings)
        result.attributes = dict(source.attributes)
        for t, row in zip(source.time, source.rows):
            result.append(float(t), row)
    else:
        path: Any = source.path if isinstance(source, Run) else source
        with open_results(path) as data:
            result = Statistics(_layout(data), settings)
            result.attributes = dict(data.attrs)
            first, last = span(data, start, None)
            time = data.time.values
            for a, rows in _rows(data, result, first, last):
                for k, row in enumerate(rows):
                    result.append(float(time[a + k]), row)
    result.all_attributes()
    return result


def _layout(data: Any) -> _Layout:
    """Channels and coordinates of a result file."""
    def text(v: Any) -> tuple[str, str]:
        return str(v.attrs.get("long_name", v.name)), str(v.attrs.get("units", "1"))

    channels = [
        Channel(str(name), *text(v), tuple(map(str, v.dims[1:])), "float", str(v.attrs.get("units_dof", "")))
        for name, v in data.data_vars.items()
        if v.dims[:1] == ("time",) and v.dtype.kind in "fiu"
    ]
    coordinates = [
        Coordinate(str(name), *text(v), str(v.dims[0]), v.values)
        for name, v in data.coords.items()
        if name != "time" and len(v.dims) == 1
    ]
    return _Layout(tuple(channels), tuple(coordinates))


def _rows(data: Any, layout: Statistics, first: int, last: int) -> Iterator[tuple[int, Array]]:
    """(number of the first sample, samples (n, width)) in pieces that suit the file."""
    from floatsim.study.ranges import blocks_of

    for a, b in blocks_of(first, last):
        parts = [np.asarray(data[c.name][a:b].values, dtype=float).reshape(b - a, -1) for c in layout.channels]
        yield a, np.ascontiguousarray(np.concatenate(parts, axis=1))


def decay_variables(test: Any) -> list[Variable]:
    """What a `DecayTest` shows, as variables: extrema, periods, damping; in metres or degrees as the test has it."""
    unit = "m" if test.dof in ("surge", "sway", "heave") else "degree"
    of, fit = f"{test.body} {test.dof}", test.fit
    scalars = [
        ("offset", test.offset, unit, "release, from the equilibrium"),
        ("equilibrium", fit.equilibrium, unit, "value at rest"),
        ("period", fit.period, "s", "mean of the first three periods"),
        ("damping_ratio", fit.damping_ratio, "1", "damping ratio of the linear part"),
        ("quadratic_damping", np.nan if fit.quadratic_damping is None else fit.quadratic_damping, f"1/{unit}",
         "quadratic damping b"),
    ]  # fmt: skip
    rows = [
        ("extremum_time", "extremum", fit.time, "s", "time of the extrema"),
        ("extremum", "extremum", fit.value, unit, "extrema, from the equilibrium"),
        ("periods", "cycle", fit.periods, "s", "time between successive extrema on one side"),
        ("amplitude", "half_cycle", fit.amplitude, unit, "mean amplitude of each half cycle"),
        ("decrement", "half_cycle", fit.decrement, "1", "logarithmic decrement of each half cycle"),
    ]
    found = [Variable(f"decay_{n}", (), np.asarray(y), {"long_name": f"{of}: {t}", "units": u})
             for n, y, u, t in scalars]  # fmt: skip
    return found + [Variable(f"decay_{n}", (f"decay_{d}",), np.asarray(y), {"long_name": f"{of}: {t}", "units": u})
                    for n, d, y, u, t in rows]  # fmt: skip


# -- the file -----------------------------------------------------------------------------------


def write_variables(path: str | Path, variables: Sequence[Variable], attributes: Mapping[str, Any]) -> Path:
    """Write variables to a netCDF file in the classic format (64-bit offsets): the same bytes for the same results.

    With half a thousand small variables that format is read eight times faster than netCDF-4, and a matrix has
    thousands of such files. attributes: text and numbers. The file comes into being when it is complete. Raises
    CaseError if it cannot be written.
    """
    from scipy.io import netcdf_file

    path = Path(path)
    for name, value in attributes.items():
        if not isinstance(name, str) or not isinstance(value, str | int | float | np.integer | np.floating):
            raise CaseError(f"attribute {name!r}: got {value!r}; must be text or a number")
    memory = io.BytesIO()
    file = netcdf_file(memory, "w", version=2)
    _attach(file, {"Conventions": "CF-1.8", **attributes})
    for item in variables:
        _define(file, item)
    file.flush()
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        temporary.write_bytes(memory.getbuffer())
        os.replace(temporary, path)
    except OSError as error:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)
        raise CaseError(f"statistics file '{path}' cannot be written: {error.strerror or error}") from None
    return path


def _define(file: Any, item: Variable) -> None:
    values, dims, attributes = np.asarray(item.values), item.dims, dict(item.attributes)
    if values.dtype.kind in "OUS":  # labels: rows of characters, which readers put together again
        words = [str(word).encode() for word in values.ravel()]
        size = max(map(len, words), default=1)
        values = np.array([list(word.ljust(size, b"\0")) for word in words], dtype=np.uint8).view("S1")
        dims = (*dims, f"string{size}")
        attributes["_Encoding"] = "utf-8"
    for dim, size in zip(dims, values.shape, strict=True):
        if dim not in file.dimensions:
            file.createDimension(dim, size)
    kind = "c" if values.dtype.kind == "S" else "i" if values.dtype.kind in "iu" else "d"
    variable = file.createVariable(item.name, kind, dims)
    _attach(variable, attributes)
    if values.size:
        variable.data[...] = values


def _attach(what: Any, attributes: Mapping[str, Any]) -> None:
    """Attributes of a file or a variable, past their own names: a plain Python float would become a float32."""
    for name, value in attributes.items():
        if isinstance(value, str):
            value = value.encode()
        elif isinstance(value, int | np.integer) and abs(int(value)) < 2**31:
            value = np.int32(value)
        else:
            value = np.float64(value)
        what._attributes[name] = value
