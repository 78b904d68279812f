"""What the report says, in numbers: a summary.nc as variables, results, shares, worst cases, run time.

Two numbers say what matters:

- share of a variable in the spread of a result: epsilon^2 = 1 - (1 - eta^2)(n - 1)/(n - k), where eta^2 is the sum of
  squares between the k values of the variable over the total of n cases: the correlation ratio, corrected for what k
  groups of pure noise would show. Source: Kelley (1935), Proc. National Academy of Sciences 21, 554-559.
- largest distance of mean positions between cases that differ in one variable only.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from floatsim.errors import CaseError
from floatsim.frames import Array

MANY_VALUES = 24  # variables with more distinct numbers are put into bins
BINS = 12
MANY_ROWS = 5000  # rows of the table of cases
MARKED = 500  # cases up to which every point tells its name
WORST = 5  # cases in a table of the worst
LEAST = 1e-3  # m or deg: motions below are none

_BOOKS = {"case", "case_id", "number", "slug", "status", "failure", "failure_message", "message", "wall_time", "steps",
          "newton_iterations", "time_reached", "study", "kind", "model", "block", "log", "decay_offset"}  # fmt: skip
_KINDS = ("mean", "std", "min", "max", "period", "del", "block_max", "block_min", "min_time", "max_time", "missing")
_BESIDE = ("_surge_sway_cov", "_utilisation")  # single numbers that have their place
_UNITS = {"hs": "m", "tp": "s", "tz": "s", "wind_speed": "m/s", "current_speed": "m/s", "depth": "m", "wind": "m/s"}
_FIRST = ("wind_heading_deg", "current_heading_deg", "wave_heading_deg", "wind_speed", "current_speed")


@dataclass
class Variable:
    """A column of the matrix over the cases; codes number its values (or bins) in order, at places x with texts."""

    name: str
    unit: str
    values: Any = field(repr=False)
    numeric: bool
    distinct: int
    codes: Any = field(repr=False)
    x: Array = field(repr=False)
    texts: list[str]
    binned: bool
    also: list[str] = field(default_factory=list)

    @property
    def label(self) -> str:
        """Name and unit for an axis."""
        return f"{self.short} [{self.unit}]" if self.unit else self.short

    @property
    def short(self) -> str:
        """Name without unit."""
        return self.name.removeprefix("case_").removesuffix("_deg").replace("_", " ")

    @property
    def range(self) -> str:
        """Its values in words."""
        if self.distinct <= MANY_VALUES:
            return ", ".join(self.texts)
        if not self.numeric:
            return f"{self.distinct} texts"
        good = np.asarray(self.values, dtype=float)
        return f"{number(np.nanmin(good))} to {number(np.nanmax(good))}"


@dataclass
class Result:
    """One number per case: label, unit as shown, values in that unit."""

    label: str
    unit: str
    values: Array = field(repr=False)
    group: str = ""


class Summary:
    """A summary.nc as the report sees it; n cases, arrays over all of them with nan where a case has no result."""

    def __init__(self, data: Any) -> None:
        self.to_do = 0  # cases that were not run are not on the page
        if "status" in data:
            there = np.flatnonzero(data["status"].values.astype(str) != "missing")
            self.to_do = int(data.sizes["case"] - len(there))
            data = data.isel(case=there) if self.to_do else data
        self.data = data
        self.n = int(data.sizes["case"])
        if self.n == 0:
            raise CaseError("the summary holds no cases that were run")
        self.attrs = {str(k): v for k, v in data.attrs.items()}
        self.ids = self._texts("case_id", [str(c) for c in data["case"].values] if "case" in data else None)
        self.status = self._texts("status", ["done"] * self.n)
        self.done = np.array([text == "done" for text in self.status])
        self.failure = self._texts("failure", [""] * self.n)
        self.message = self._texts("failure_message", self._texts("message", [""] * self.n))

    def _texts(self, name: str, default: list[str] | None) -> list[str]:
        if name not in self.data:
            return default if default is not None else [f"case {k}" for k in range(self.n)]
        return [_text(v) for v in np.asarray(self.data[name].values).ravel()]

    @property
    def title(self) -> str:
        """Name of the matrix."""
        return str(self.attrs.get("matrix") or self.attrs.get("name") or "Load cases")

    @cached_property
    def counts(self) -> list[tuple[str, int]]:
        """Status and number of its cases, most frequent first."""
        return Counter(self.status).most_common()

    @cached_property
    def facts(self) -> list[tuple[str, str]]:
        """What is the same for all cases, from the attributes."""
        names = {
            "matrix_file": "matrix", "model_script": "model", "model": "model", "parameters": "parameters",
            "study": "study", "duration": "duration after the ramp [s]", "ramp": "ramp [s]",
            "dt": "largest time step [s]", "interval": "output interval [s]", "block": "blocks of extremes [s]",
            "floatsim_version": "floatsim", "version": "floatsim", "numpy_version": "numpy",
            "python_version": "Python", "machine": "machine", "created": "made",
        }  # fmt: skip
        rows: dict[str, str] = {}
        of_decay = self.attrs.get("study") == "decay"  # neither ramp nor blocks
        for key, label in names.items():
            if of_decay and key in ("ramp", "block", "interval") or (key, self.attrs.get(key)) == ("study", "run"):
                continue
            if key in self.attrs and str(self.attrs[key]) not in ("", "{}"):
                rows.setdefault(label, _plain(self.attrs[key]))
        return list(rows.items())

    # variables

    @cached_property
    def variables(self) -> list[Variable]:
        """All columns of the matrix, in its order."""
        known = self.attrs.get("variables")
        if isinstance(known, str):
            known = json.loads(known) if known.startswith("[") else [v.strip() for v in known.split(",")]
        coords = [str(c) for c in self.data.coords if self.data[c].dims == ("case",) and c not in _BOOKS]
        names = [n for n in (known or coords) if n in self.data]
        return [_variable(n, self.data[n].values, str(self.data[n].attrs.get("units", ""))) for n in names]

    @cached_property
    def axes(self) -> list[Variable]:
        """Variables that vary; of those that split the cases in the same way the best known one, with the others."""
        classes: dict[tuple[int, ...], list[Variable]] = {}
        for variable in self.variables:
            if variable.distinct > 1:
                _, first, inverse = np.unique(variable.codes, return_index=True, return_inverse=True)
                key = tuple(np.argsort(np.argsort(first))[inverse].tolist())  # numbered by first appearance
                classes.setdefault(key, []).append(variable)
        found = []
        for same in classes.values():
            best = min(same, key=lambda v: _FIRST.index(v.name) if v.name in _FIRST else len(_FIRST))
            best.also = [v.name for v in same if v is not best]
            found.append(best)
        return sorted(found, key=lambda v: v.name == "seed")

    @cached_property
    def free(self) -> list[Variable]:
        """Axes that do not follow from those before them."""
        chosen: list[Variable] = []
        for variable in self.axes:
            keys = list(zip(*(v.codes.tolist() for v in chosen))) if chosen else [()] * self.n
            seen: dict[Any, set[int]] = {}
            for key, code in zip(keys, variable.codes.tolist()):
                seen.setdefault(key, set()).add(code)
            follows = len(seen) < self.n and all(len(codes) == 1 for codes in seen.values())
            if not follows:
                chosen.append(variable)
        return chosen

    @cached_property
    def shown(self) -> list[Variable]:
        """Axes that results are drawn against: seeds only if there is nothing else."""
        return [v for v in self.axes if v.name != "seed"] or self.axes

    # channels

    def get(self, name: str, *dims: str) -> Array | None:
        """A variable over the cases as floats, if it is there with these further dimensions and holds a number."""
        if name not in self.data or self.data[name].dims != ("case", *dims) or self.data[name].dtype.kind not in "fiub":
            return None
        values = np.array(self.data[name].values, dtype=float)
        values[~self.done] = np.nan
        return values if np.isfinite(values).any() else None

    def unit(self, name: str) -> str:
        """Unit of a variable."""
        return str(self.data[name].attrs.get("units", ""))

    @cached_property
    def bodies(self) -> list[str]:
        """Names of the bodies, moving ones: with statistics of their position."""
        end = "_position_mean"
        found = [
            str(n)[: -len(end)] for n, v in self.data.data_vars.items() if str(n).endswith(end) and "dof" in v.dims
        ]
        return [b for b in found if (x := self.dof(b, "mean")) is not None and np.nanmax(np.abs(x)) > 1e-6]

    def dof(self, body: str, kind: str) -> Array | None:
        """Statistic of a body's position (n, 6), m and rad."""
        return self.get(f"{body}_position_{kind}", "dof")

    def covariance(self, body: str) -> Array | None:
        """Covariance of surge and sway within every case (n, 2, 2) [m2]; without their covariance, axis-aligned."""
        std = self.dof(body, "std")
        if std is None:
            return None
        both = self.get(f"{body}_position_surge_sway_cov")
        mixed = np.zeros(self.n) if both is None else both
        return np.stack([std[:, 0] ** 2, mixed, mixed, std[:, 1] ** 2], axis=1).reshape(-1, 2, 2)

    def offset(self, body: str) -> tuple[Array, Array, Array, str]:
        """Horizontal distance of a body from its drawing position: least, mean and largest of every case [m], and
        what the largest is."""
        mean, low, high = self.dof(body, "mean"), self.dof(body, "min"), self.dof(body, "max")
        assert mean is not None
        middle = np.hypot(mean[:, 0], mean[:, 1])
        known = [self.get(f"{body}_offset_{kind}") for kind in ("min", "mean", "max")]
        if known[0] is not None and known[1] is not None and known[2] is not None:
            return known[0], known[1], known[2], "largest"
        if low is None or high is None:
            return middle, middle, middle, "mean"
        far = np.maximum(np.abs(low), np.abs(high))
        return middle, middle, np.hypot(far[:, 0], far[:, 1]), "bound from the extremes of surge and sway"

    @cached_property
    def lines(self) -> list[str]:
        """Names of the lines with anything along them."""
        names = []
        for dim in map(str, self.data.dims):
            for end in ("_element", "_node"):
                if dim.endswith(end) and dim[: -len(end)] not in names:
                    names.append(dim[: -len(end)])
        return names

    @cached_property
    def families(self) -> dict[str, list[str]]:
        """Lines whose names differ in a number at their end, together."""
        found: dict[str, list[str]] = {}
        for line in self.lines:
            found.setdefault(line.rstrip("0123456789").rstrip("_") or line, []).append(line)
        return found

    def along(self, line: str, quantity: str, kind: str) -> Array | None:
        """Statistic of a line's quantity over cases and its length (n, m)."""
        dim = f"{line}_element" if quantity.startswith("tension") else f"{line}_node"
        name = f"{line}_{quantity}" + (f"_{kind}" if kind else "")
        return self.get(name, dim)

    def utilisation(self, line: str, quantity: str) -> Array | None:
        """Largest over time of tension over breaking load or curvature over the allowed one (n, m)."""
        found = self.along(line, f"{quantity}_utilisation", "max")
        return found if found is not None else self.along(line, f"{quantity}_utilisation", "")

    def arc_length(self, line: str, size: int, of_elements: bool) -> tuple[Array, str]:
        """Places along a line and the label of the axis."""
        name = f"{line}_element_arc_length" if of_elements else f"{line}_arc_length"
        if name in self.data:
            s = np.asarray(self.data[name].values, dtype=float)
            s = np.nanmean(s, axis=0) if s.ndim == 2 else s
            if len(s) == size:
                return s, "arc length from end a [m]"
        return np.arange(size, dtype=float), "element" if of_elements else "node"

    @cached_property
    def scalars(self) -> list[str]:
        """Channels with one number over time, e.g. of rotors and PTOs."""
        found = [str(n)[: -len("_mean")] for n, v in self.data.data_vars.items()
                 if str(n).endswith("_mean") and v.dims == ("case",)]  # fmt: skip
        own = {f"{body}_offset" for body in self.bodies}  # shown with the motions
        return [n for n in found if self.get(f"{n}_mean") is not None and n not in own]

    @cached_property
    def rotors(self) -> dict[str, list[str]]:
        """Name of every rotor: its channels."""
        owners = [n[: -len("_thrust")].removesuffix("_rotor") for n in self.scalars if n.endswith("_thrust")]
        order = ("power", "thrust", "speed", "pitch", "torque")

        def place(channel: str) -> int:
            what = channel.rpartition("_")[2]
            return order.index(what) if what in order and "wind" not in channel else len(order)

        return {o: sorted((n for n in self.scalars if n.startswith(f"{o}_")), key=place) for o in owners}

    @cached_property
    def ptos(self) -> dict[str, list[str]]:
        """Name of every power take-off: its channels of power."""
        taken = {n for names in self.rotors.values() for n in names}
        return {n[: -len("_power")]: [n] for n in self.scalars if n.endswith("_power") and n not in taken}

    @cached_property
    def extra(self) -> list[Result]:
        """Single numbers per case that are no statistic of a channel, as of decay tests."""
        found = []
        for name, v in self.data.data_vars.items():
            text = str(name)
            channel = next((text.removesuffix(f"_{kind}") for kind in _KINDS if text.endswith(f"_{kind}")), "")
            if v.dims != ("case",) or text in _BOOKS or f"{channel}_mean" in self.data or text.endswith(_BESIDE):
                continue
            values = self.get(text)
            if values is not None:
                factor, unit = scaled(self.unit(text), values)
                if text.startswith("decay_") and unit in ("m", "deg", "1/m", "1/deg"):
                    factor, unit = 1.0, "1/m or 1/deg" if "/" in unit else "m or deg"  # as the release is
                found.append(Result(text.removeprefix("decay_").replace("_", " "), unit, values * factor, "single"))
        return found

    @cached_property
    def results(self) -> list[Result]:
        """The numbers that stand for a case in tables."""
        found: list[Result] = []
        several = len(self.bodies) > 1
        for body in self.bodies:
            own = f"{body} " if several else ""
            _, mean, high, what = self.offset(body)
            if np.nanmax(high) > LEAST:
                found.append(Result(f"{own}mean offset", "m", mean, "offset"))
                if what != "mean":
                    found.append(Result(f"{own}largest offset", "m", high, "offset"))
            low, high_dof = self.dof(body, "min"), self.dof(body, "max")
            if low is not None and high_dof is not None:
                reach = np.maximum(np.abs(low), np.abs(high_dof))
                tilt = np.degrees(reach[:, 3:5].max(axis=1))
                if np.nanmax(high) <= LEAST:
                    found.append(Result(f"{own}largest heave", "m", reach[:, 2], "offset"))
                if np.nanmax(tilt) > LEAST:
                    found.append(Result(f"{own}largest roll or pitch", "deg", tilt, "tilt"))
        for family, lines in self.families.items():
            tension = self._largest(lambda l: self.along(l, "tension", "max"), lines)
            if tension is not None:
                found.append(Result(f"{family} largest tension", "kN", 1e-3 * tension, "tension"))
            for quantity in ("tension", "curvature"):
                used = self._largest(lambda l, q=quantity: self.utilisation(l, q), lines)  # type: ignore[misc]
                if used is not None:
                    found.append(Result(f"{family} {quantity} utilisation", "%", 100.0 * used, "utilisation"))
                elif quantity == "curvature" and self.bends(lines):
                    most = self._largest(lambda l: self.along(l, "curvature", "max"), lines)
                    if most is not None:
                        found.append(Result(f"{family} largest curvature", "1/m", most, "curvature"))
        for owner, channels in {**self.rotors, **self.ptos}.items():
            for channel in channels:
                if channel.endswith(("_power", "_thrust")):
                    values = self.get(f"{channel}_mean")
                    assert values is not None
                    factor, unit = scaled(self.unit(f"{channel}_mean"), values)
                    what = channel.removeprefix(f"{owner}_").replace("_", " ")
                    found.append(Result(f"{owner} mean {what}", unit, factor * values, "power"))
        return found + self.extra

    def bends(self, lines: Sequence[str]) -> bool:
        """Whether the curvature of lines means something: they resist or limit it (or nothing is known of that)."""
        for line in lines:
            moment = self.along(line, "bending_moment", "max")
            if self.utilisation(line, "curvature") is not None or (moment is not None and np.nanmax(moment) > 0.0):
                return True
        return not any(f"{line}_bending_moment_max" in self.data for line in lines)

    @staticmethod
    def _largest(of: Callable[[str], Array | None], lines: Sequence[str]) -> Array | None:
        """The largest value of every case over all lines and all along them."""
        rows = [_most(x) for line in lines if (x := of(line)) is not None]
        return np.fmax.reduce(rows) if rows else None

    # what the sections show

    def shares(self, values: Array) -> list[float]:
        """Share of every axis in the spread of values (n,) or (n, 2); nan where it cannot be told."""
        rows = values.reshape(self.n, -1)
        good = np.isfinite(rows).all(axis=1)
        y = rows[good]
        total = float(np.sum((y - y.mean(axis=0)) ** 2)) if len(y) else 0.0
        found = []
        for axis in self.axes:
            codes = axis.codes[good]
            names = np.unique(codes)
            n, k = len(y), len(names)
            if total <= 1e-18 * max(float(np.sum(y**2)), 1e-300) or k < 2 or k > n // 2:
                found.append(math.nan)
                continue
            inner = sum(float(np.sum((y[codes == c] - y[codes == c].mean(axis=0)) ** 2)) for c in names)
            found.append(max(0.0, 1.0 - inner / total * (n - 1) / (n - k)))
        return found

    @cached_property
    def drivers(self) -> list[tuple[str, list[float]]]:
        """Results and the shares of the axes in their spread."""
        rows: list[tuple[str, list[float]]] = []
        for body in self.bodies:
            mean = self.dof(body, "mean")
            assert mean is not None
            own = f"{body} " if len(self.bodies) > 1 else ""
            rows.append((f"{own}mean position (surge, sway)", self.shares(mean[:, :2])))
        rows += [(r.label, self.shares(r.values)) for r in self.results if not r.label.endswith("mean offset")]
        return [row for row in rows if np.isfinite(row[1]).any()]

    def _alike(self, body: str, axis: Variable) -> list[list[int]]:
        """Cases with a mean position that differ in nothing but this axis, in groups."""
        mean = self.dof(body, "mean")
        assert mean is not None
        found: dict[Any, list[int]] = {}
        others = [v.codes.tolist() for v in self.free if v is not axis]
        for k in np.flatnonzero(np.isfinite(mean[:, :2]).all(axis=1)):
            found.setdefault(tuple(codes[k] for codes in others), []).append(int(k))
        return list(found.values())

    def comparable(self, body: str, axis: Variable) -> Any:
        """Cases (n,) whose means by the axis's values can be compared: of those groups that have all values. Failed
        cases would shift them otherwise. All cases if no group is complete, or the axis follows from others."""
        good = np.zeros(self.n, dtype=bool)
        if axis in self.free and not axis.binned:
            for rows in self._alike(body, axis):
                good[rows] = len(np.unique(axis.codes[rows])) == axis.distinct
        return good if good.any() else np.ones(self.n, dtype=bool)

    def apart(self, body: str, axis: Variable) -> tuple[float, float | None]:
        """Largest distances [m] of mean positions: between the means of the axis's values, and between cases that
        differ in this axis only (None where there are none)."""
        mean = self.dof(body, "mean")
        assert mean is not None
        xy = mean[:, :2]
        good = np.isfinite(xy).all(axis=1) & self.comparable(body, axis)
        centres = np.array([xy[good & (axis.codes == c)].mean(axis=0) for c in np.unique(axis.codes[good])])
        if axis not in self.free or axis.binned:
            return _diameter(centres), None
        pairs = [_diameter(xy[rows]) for rows in self._alike(body, axis) if len(rows) > 1]
        return _diameter(centres), max(pairs) if pairs else None

    def worst(self, lines: Sequence[str]) -> Iterator[tuple[str, str, list[tuple[int, float, str, float]]]]:
        """Tables of the worst cases of some lines: quantity, unit, rows of (case, value, line, arc length)."""
        for quantity in ("tension", "curvature"):
            used = {l: x for l in lines if (x := self.utilisation(l, quantity)) is not None}
            values = {l: x for l in lines if (x := self.along(l, quantity, "max")) is not None}
            if not used and (not values or quantity == "curvature" and not self.bends(lines)):
                continue
            if used:
                found, factor, what, unit = used, 100.0, f"{quantity} utilisation", "%"
            else:
                factor, unit = (1e-3, "kN") if quantity == "tension" else (1.0, "1/m")
                found, what = values, f"largest {quantity}"
            most = np.array([_most(x) for x in found.values()])
            rows = []
            for k in _largest_first(np.fmax.reduce(most))[:WORST]:
                line, x = list(found.items())[int(np.nanargmax(most[:, k]))]
                s, _ = self.arc_length(line, x.shape[1], quantity == "tension")
                j = int(np.nanargmax(x[k]))
                rows.append((k, factor * float(x[k, j]), line, float(s[j])))
            yield what, unit, rows

    def describe(self, k: int) -> str:
        """What makes case k, in words."""
        return ", ".join(f"{v.short} {_cell(v.values[k])}{f' {v.unit}' if v.unit else ''}" for v in self.axes)

    @cached_property
    def failures(self) -> list[tuple[str, list[int]]]:
        """Reasons and the cases that failed for them, most frequent first."""
        found: dict[str, list[int]] = {}
        for k in range(self.n):
            if self.status[k] == "failed":
                found.setdefault(self.failure[k] or "failed", []).append(k)
        return sorted(found.items(), key=lambda item: -len(item[1]))

    @cached_property
    def wall(self) -> Array | None:
        """Wall time of every case [s]; of failed ones too."""
        if "wall_time" not in self.data:
            return None
        wall = np.array(self.data["wall_time"].values, dtype=float)
        return wall if np.isfinite(wall).any() else None

    @cached_property
    def simulated(self) -> Array | None:
        """Simulated time of every case, ramp included [s]."""
        for name in ("simulated_time", "total"):
            if name in self.data and self.data[name].dims == ("case",):
                return np.array(self.data[name].values, dtype=float)
        try:
            ramp = 0.0 if self.attrs.get("study") == "decay" else float(self.attrs.get("ramp", 0.0))
            total = float(self.attrs["duration"]) + ramp
        except (KeyError, TypeError, ValueError):
            return None
        return np.full(self.n, total)

    @cached_property
    def cost(self) -> list[tuple[str, str, str]]:
        """Facts of the run time: what, number, unit."""
        wall = self.wall
        if wall is None:
            return []
        good = wall[np.isfinite(wall)]
        total = float(good.sum())
        rows = [
            ("total", number(total / 3600.0), "core-hours")
            if total > 360.0
            else ("total", number(total), "core-seconds"),
            ("median case", number(float(np.median(good))), "s"),
            ("slowest case", number(float(good.max())), "s"),
        ]
        took = self.done & np.isfinite(wall) & (np.nan_to_num(wall) > 0.0)
        if self.simulated is not None and took.any():
            rows.append(("speed", number(self.simulated[took].sum() / wall[took].sum(), 2), "times real time per core"))
        steps = self.get("steps")
        if steps is not None and took.any():
            rows.append(("steps", number(np.nansum(steps[took]) / wall[took].sum()), "per second and core"))
            newton = self.get("newton_iterations")
            if newton is not None:
                rows.append(("Newton iterations", number(np.nansum(newton) / np.nansum(steps)), "per step"))
        return rows

    @cached_property
    def headlines(self) -> list[tuple[str, str, str, int | None]]:
        """The most important numbers: what, number, unit, case."""
        rows: list[tuple[str, str, str, int | None]] = []
        for group in ("offset", "tilt"):
            rows += self._peak([r for r in self.results if r.group == group and "largest" in r.label])
        for group in ("utilisation", "tension", "curvature"):
            found = [r for r in self.results if r.group == group]
            if group != "utilisation":
                rows += self._peak(found)
                continue
            for quantity in ("tension", "curvature"):
                rows += self._peak([r for r in found if r.label.endswith(f"{quantity} utilisation")])
        rows += self._peak([r for r in self.results if r.group == "power"])
        return rows[:5]

    def _peak(self, results: Sequence[Result]) -> list[tuple[str, str, str, int | None]]:
        """The largest of these."""
        if not results:
            return []
        r = max(results, key=lambda r: float(np.nanmax(r.values)))
        k = int(np.nanargmax(r.values))
        return [(r.label if "largest" in r.label or "mean" in r.label else f"largest {r.label}", number(r.values[k]),
                 r.unit, k)]  # fmt: skip

    @cached_property
    def outlines(self) -> dict[str, Any]:
        """Outline and points of every body in plan, as floatsim.cases.outline makes them."""
        try:
            found = json.loads(str(self.attrs.get("outlines", "{}")))
        except ValueError:
            return {}
        return found if isinstance(found, dict) else {}

    @cached_property
    def channels(self) -> list[tuple[str, str, float, float, float, int]]:
        """Channels that no other section shows: name, unit, least, mean and largest over all cases, case of the
        largest."""
        shown = {n for names in (*self.rotors.values(), *self.ptos.values()) for n in names}
        rows = []
        for name in self.scalars:
            mean, low, high = (self.get(f"{name}_{kind}") for kind in ("mean", "min", "max"))
            if name in shown or mean is None or low is None or high is None:
                continue
            factor, unit = scaled(self.unit(f"{name}_mean"), high)
            rows.append((name, unit, factor * float(np.nanmin(low)), factor * float(np.nanmean(mean)),
                         factor * float(np.nanmax(high)), int(np.nanargmax(high))))  # fmt: skip
        return rows

    @cached_property
    def fatigue(self) -> list[tuple[str, str, str, list[tuple[int, float]]]]:
        """Damage-equivalent loads: channel, exponent, unit, the worst cases (case, value)."""
        rows = []
        for name, v in self.data.data_vars.items():
            if not str(name).endswith("_del") or v.dims[:1] != ("case",) or v.dtype.kind not in "fiu":
                continue
            x = np.array(v.values, dtype=float).reshape(self.n, -1)
            x[~self.done] = np.nan
            if not np.isfinite(x).any():
                continue
            factor, unit = scaled(str(v.attrs.get("units", "")), x)
            most = factor * _most(x)
            worst = [(k, float(most[k])) for k in _largest_first(most)[:WORST]]
            rows.append((str(name)[:-4], _plain(v.attrs.get("exponent", "")), unit, worst))
        return rows

    @property
    def table(self) -> tuple[list[tuple[str, str]], Iterator[tuple[int, list[str]]]]:
        """Heads (text, unit) of the table of cases, and its rows (case, cells)."""
        heads = [(v.name, v.unit) for v in self.variables if v.distinct > 1]
        columns: list[list[str]] = [[_cell(x) for x in v.values] for v in self.variables if v.distinct > 1]
        for r in self.results:
            heads.append((r.label, r.unit))
            columns.append([plain_number(x) for x in r.values])
        if self.wall is not None:
            heads.append(("wall time", "s"))
            columns.append([plain_number(x) for x in self.wall])
        rows = range(min(self.n, MANY_ROWS))
        return heads, ((k, [column[k] for column in columns]) for k in rows)


def number(value: Any, digits: int = 3) -> str:
    """A number for reading: significant digits, whole from 1000 on with thin spaces; an en dash if there is none."""
    x = float(value)
    if not math.isfinite(x):
        return "\N{EN DASH}"
    if abs(x) >= 10.0**digits:
        return f"{x:,.0f}".replace(",", "\N{NARROW NO-BREAK SPACE}").replace("-", "\N{MINUS SIGN}")
    return plain_number(x, digits).replace("-", "\N{MINUS SIGN}")


def plain_number(value: Any, digits: int = 4) -> str:
    """A number that a program can read back; empty if there is none."""
    x = float(value)
    if not math.isfinite(x):
        return ""
    if x == 0.0 or abs(x) < 1e-12:
        return "0"
    if not 1e-4 <= abs(x) < 1e9:
        return f"{x:.{digits - 1}e}"
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(x))))
    text = f"{x:.{decimals}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def scaled(unit: str, values: Any) -> tuple[float, str]:
    """Factor and unit in which values are shown."""
    unit = unit.replace("degree", "deg", 1)
    if unit.startswith("rad"):
        return 180.0 / math.pi, unit.replace("rad", "deg", 1)
    finite = np.abs(np.asarray(values, dtype=float))
    most = float(np.nanmax(finite)) if np.isfinite(finite).any() else 0.0
    if unit in ("N", "N m", "W", "J", "Pa"):
        if most >= 1e7 or unit == "Pa" and most >= 1e6:
            return 1e-6, f"M{unit}"
        if most >= 1e3:
            return 1e-3, f"k{unit}"
    return 1.0, "" if unit == "1" else unit


def _variable(name: str, values: Any, unit: str) -> Variable:
    """What a column of the matrix holds. Numbers that differ by rounding only are the same."""
    values = np.asarray(values).ravel()
    unit = (
        ""
        if unit == "1"
        else unit.replace("degree", "deg", 1) or ("deg" if name.endswith("_deg") else _UNITS.get(name, ""))
    )
    numeric = values.dtype.kind in "fiu"
    if not numeric:
        texts = [_text(v) or "none" for v in values]
        names = list(dict.fromkeys(texts))  # in the order of the matrix
        number_of = {text: k for k, text in enumerate(names)}
        codes, x = np.array([number_of[text] for text in texts]), np.arange(len(names), dtype=float)
        return Variable(name, unit, np.array(texts), False, len(names), codes, x, names, False)
    size = float(np.nanmax(np.abs(values.astype(float)))) if np.isfinite(values.astype(float)).any() else 1.0
    rounded = np.round(values.astype(float) / (size or 1.0), 9)
    x, codes = np.unique(rounded, return_inverse=True)
    x, codes, distinct, binned = x * (size or 1.0), codes.ravel(), len(x), False
    if distinct > MANY_VALUES:
        edges = np.unique(np.nanquantile(values.astype(float), np.linspace(0.0, 1.0, BINS + 1)))
        codes = np.clip(np.searchsorted(edges, values.astype(float), side="right") - 1, 0, len(edges) - 2)
        used, codes = np.unique(codes, return_inverse=True)
        codes = codes.ravel()
        x = np.array([values[codes == k].astype(float).mean() for k in range(len(used))])
        binned = True
    return Variable(name, unit, values, True, distinct, codes, x, [_cell(v) or "none" for v in x], binned)


def _most(x: Array) -> Array:
    """Largest of every row, nan where it holds nothing."""
    return np.asarray(np.fmax.reduce(x.reshape(len(x), -1), axis=1))


def _largest_first(x: Array) -> list[int]:
    """Indices of the finite numbers, largest first."""
    return [int(k) for k in np.argsort(-x, kind="stable") if math.isfinite(x[k])]


def _diameter(points: Array) -> float:
    """Largest distance between two of the points (n, 2); of many points that of their extremes in 16 directions."""
    if len(points) < 2:
        return 0.0
    if len(points) > 64:
        turn = np.linspace(0.0, math.pi, 16, endpoint=False)
        return float(np.ptp(points @ np.array([np.cos(turn), np.sin(turn)]), axis=0).max())
    return float(np.max(np.linalg.norm(points[:, None] - points[None], axis=2)))


def _text(value: Any) -> str:
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    return "" if value is None or value != value else str(value)


def _cell(value: Any) -> str:
    """A value of a variable as the user would write it."""
    if isinstance(value, str):
        return value
    if isinstance(value, int | np.integer | bool | np.bool_):
        return str(value)
    return "" if not math.isfinite(value) else f"{float(value):.5g}"


def _plain(value: Any) -> str:
    return _cell(value) if isinstance(value, int | float | np.number) else str(value)
