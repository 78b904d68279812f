"""Range graphs: smallest, mean and largest value and standard deviation over time, along a line.

Means and deviations of blocks of samples are merged as they are read, with M2 = sum (x - mean)^2:

    mean = mean_a + d n_b/n,   M2 = M2_a + M2_b + d^2 n_a n_b/n,   d = mean_b - mean_a,   n = n_a + n_b

so a file of any length takes the memory of one block, and nothing is lost to cancellation. Source: Chan, Golub &
LeVeque (1983), The American Statistician 37, 242-247.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from floatsim.description import is_number
from floatsim.errors import CaseError, nearest
from floatsim.frames import Array
from floatsim.study.simulate import Run

BLOCK = 1024  # samples read at a time: whole chunks of the file


@dataclass(frozen=True)
class RangeGraph:
    """Statistics over time of one quantity of one line, along its arc length; arrays (n,).

    arc_length [m]: unstretched, from end a, of nodes or of the middles of elements. minimum, mean, maximum, std in
    `units`; nan where the quantity does not exist. start, end [s]: first and last sample; samples: how many.
    """

    line: str
    quantity: str
    units: str
    start: float
    end: float
    samples: int
    arc_length: Array = field(repr=False)
    minimum: Array = field(repr=False)
    mean: Array = field(repr=False)
    maximum: Array = field(repr=False)
    std: Array = field(repr=False)

    def __str__(self) -> str:
        """A table, one row for every node or element."""
        rows = zip(self.arc_length, self.minimum, self.mean, self.maximum, self.std)
        head = f"{'arc length [m]':>14}" + "".join(f"{name:>14}" for name in ("min", "mean", "max", "std"))
        title = f"{self.line}: {self.quantity} [{self.units}], {self.samples} samples, {self.start:g} to {self.end:g} s"
        return "\n".join([title, head, *(f"{s:14.3f}" + "".join(f"{y:14.6g}" for y in row) for s, *row in rows)])

    def to_dataset(self) -> Any:
        """An xarray Dataset with variables min, mean, max and std along arc_length."""
        import xarray

        own = {"units": self.units}
        values = {"min": self.minimum, "mean": self.mean, "max": self.maximum, "std": self.std}
        about = {"line": self.line, "quantity": self.quantity, "start": self.start, "end": self.end,
                 "samples": self.samples}  # fmt: skip
        text = {"units": "m", "long_name": "unstretched length from end a"}
        return xarray.Dataset(
            {name: ("arc_length", row, own) for name, row in values.items()},
            {"arc_length": ("arc_length", self.arc_length, text)}, about,
        )  # fmt: skip


def range_graph(
    source: Run | str | Path | Any, line: str, quantity: str = "tension", start: float | None = None,
    end: float | None = None,
) -> RangeGraph:  # fmt: skip
    """Range graph of `quantity` of `line` between `start` and `end` [s] (default: all there is).

    source: a Run, a result file or an open xarray Dataset; files are read block by block. quantity: a channel along
    the line: tension, curvature, bending_moment, clearance, and where the line's sections have limits
    tension_utilisation, curvature_utilisation.

    Raises CaseError for a line, quantity or span of time that is not there, and for a file that cannot be read.
    """
    with _opened(source) as data:
        name = _channel(data, line, quantity)
        first, last = span(data, start, end)
        blocks = (data[name].isel(time=slice(a, b)).values for a, b in blocks_of(first, last))
        values = _merged(blocks)
        where = [str(c) for c in data.coords if str(c).endswith("arc_length") and data[c].dims == data[name].dims[1:]]
        time = data.time.values
        return RangeGraph(line, quantity, str(data[name].attrs.get("units", "")), float(time[first]),
                          float(time[last - 1]), last - first, np.asarray(data[where[0]].values, dtype=float),
                          *values)  # fmt: skip


def quantities(data: Any, line: str) -> list[str]:
    """Quantities along `line` that a dataset holds."""
    along = (("time", f"{line}_node"), ("time", f"{line}_element"))
    return [str(n).removeprefix(f"{line}_") for n, v in data.data_vars.items() if v.dims in along]


def lines_of(data: Any) -> list[str]:
    """Names of the lines in a dataset."""
    return [str(n).removesuffix("_node") for n in data.dims if str(n).endswith("_node")] or [
        str(n).removesuffix("_element") for n in data.dims if str(n).endswith("_element")
    ]


def open_results(path: str | Path) -> Any:
    """A result file as an xarray Dataset, read when needed. Raises CaseError if it cannot be read or is empty."""
    import xarray

    if not isinstance(path, str | Path):
        raise CaseError(f"results: got {path!r}; must be a Run or the path of a result file")
    if not Path(path).is_file():
        raise CaseError(f"there is no result file '{path}'")
    try:
        data = xarray.open_dataset(path)
    except (OSError, ValueError, RuntimeError):
        raise CaseError(f"'{path}' is not a netCDF file that can be read") from None
    if data.sizes.get("time", 0) == 0:
        data.close()
        raise CaseError(f"'{path}' holds no samples (yet)")
    return data


def span(data: Any, start: float | None, end: float | None) -> tuple[int, int]:
    """First sample at or after `start` and one past the last at or before `end`. Raises CaseError if there is none,
    or if start and end are no numbers or in the wrong order."""
    for what, value in (("start", start), ("end", end)):
        if value is not None and not is_number(value):
            raise CaseError(f"{what}: got {value!r}; must be a number of seconds, or None")
    if start is not None and end is not None and start > end:
        raise CaseError(f"start: got {start:g} s, after the end at {end:g} s")
    time = data.time.values
    slack = 1e-9 * max(abs(float(time[0])), abs(float(time[-1])))
    first = 0 if start is None else int(np.searchsorted(time, start - slack))
    last = len(time) if end is None else int(np.searchsorted(time, end + slack, side="right"))
    if first >= last:
        asked = f"{'the start' if start is None else f'{start:g} s'} to {'the end' if end is None else f'{end:g} s'}"
        raise CaseError(f"no samples from {asked}; there are samples from {time[0]:g} to {time[-1]:g} s")
    return first, last


def blocks_of(first: int, last: int) -> Iterator[tuple[int, int]]:
    """Pieces of samples first to last - 1 that do not cut chunks of the file in two."""
    for a in range(first - first % BLOCK, last, BLOCK):
        yield max(a, first), min(a + BLOCK, last)


@contextmanager
def _opened(source: Any) -> Iterator[Any]:
    if isinstance(source, Run) and source.path is None:
        yield source.dataset()
    elif hasattr(source, "data_vars"):
        if source.sizes.get("time", 0) == 0:
            raise CaseError("results: the dataset holds no samples")
        yield source
    else:
        data = open_results(source.path if isinstance(source, Run) and source.path is not None else source)
        try:
            yield data
        finally:
            data.close()


def _channel(data: Any, line: Any, quantity: Any) -> str:
    known = lines_of(data)
    if line not in known:
        raise CaseError(f"line: got {line!r}; the results have no such line{nearest(str(line), known)}")
    along = quantities(data, line)
    if quantity not in along:
        raise CaseError(f"quantity: got {quantity!r}; along '{line}' there is no such{nearest(str(quantity), along)}")
    return f"{line}_{quantity}"


def _merged(blocks: Iterator[Array]) -> tuple[Array, Array, Array, Array]:
    """(min, mean, max, std) over the first axis of all blocks; nan where all is nan."""
    n: Any = 0.0
    low: Any = np.inf
    high: Any = -np.inf
    mean: Any = 0.0
    m2: Any = 0.0
    for block in blocks:
        x = np.asarray(block, dtype=float)
        with warnings.catch_warnings():  # columns without a single number stay nan
            warnings.simplefilter("ignore", RuntimeWarning)
            count = np.sum(~np.isnan(x), axis=0)
            own = np.where(count > 0, np.nanmean(x, axis=0), 0.0)
            low, high = np.fmin(low, np.nanmin(x, axis=0)), np.fmax(high, np.nanmax(x, axis=0))
        total = n + count
        d = own - mean
        share = count / np.maximum(total, 1)
        m2 = m2 + np.nansum((x - own) ** 2, axis=0) + d**2 * n * share
        mean = mean + d * share
        n = total
    gone = n == 0
    rows = (low, mean, high, np.sqrt(m2 / np.maximum(n, 1)))
    low, mean, high, std = (np.where(gone, np.nan, row) for row in rows)
    return low, mean, high, std
