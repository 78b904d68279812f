"""What is done by hand before a dynamic cable is analysed: section lengths, buoyancy, and the search for a good size.

The fitness of a configuration is that of Rentschler et al. 2019,

    max curvature / largest allowed curvature + max tension / breaking load,

less is better. `sizing` evaluates it in static equilibrium at every point of a grid. The search knows nothing of lazy
waves: it takes any model and any of its lines.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from floatsim.description import is_number
from floatsim.errors import CaseError, FloatsimError, nearest
from floatsim.frames import Array
from floatsim.model import Model
from floatsim.parts.line import Line
from floatsim.solve.static import solve_static
from floatsim.study.channels import Sampler
from floatsim.system.system import assemble

LENGTH_PER_DEPTH = 2.76  # Verelst et al. 2024, their lazy wave in 82 m of water
SHARES = (0.25, 0.25, 0.50)  # of upper, buoyant and lower section, same source


def section_lengths(
    depth: float, length_per_depth: float = LENGTH_PER_DEPTH, shares: Sequence[float] = SHARES
) -> tuple[float, ...]:
    """Lengths [m] of the sections of a lazy wave, in proportion to the depth [m] of the water.

    shares: of the sections from the upper end, together 1. The defaults are those of Verelst et al. 2024 in 82 m.
    Raises CaseError if a number is not positive or the shares are not together 1.
    """
    if not isinstance(shares, list | tuple | np.ndarray):
        raise CaseError(f"section lengths: shares: got {shares!r}; must be a list of numbers")
    for name, value in (("depth", depth), ("length_per_depth", length_per_depth), *(("shares", y) for y in shares)):
        if not is_number(value) or value <= 0.0:
            raise CaseError(f"section lengths: {name}: got {value!r}; must be a positive number")
    if not abs(sum(shares) - 1.0) < 1e-9:
        raise CaseError(f"section lengths: shares: got {tuple(shares)}, together {sum(shares):g}; must be together 1")
    return tuple(float(share * length_per_depth * depth) for share in shares)


def diameter_from_weights(dry: float, wet: float, density: float = 1025.0, gravity: float = 9.81) -> float:
    """Diameter [m] of a section that weighs `dry` in air and `wet` in water [N/m], negative if it floats.

    rho g pi d^2/4 = dry - wet. Raises CaseError unless dry > wet, dry > 0, density > 0 and gravity > 0.
    """
    given: list[tuple[str, Any]] = [("dry", dry), ("density", density), ("gravity", gravity)]
    if is_number(dry) and is_number(wet):
        given.append(("dry - wet", dry - wet))
    for name, value in given:
        if not is_number(value) or value <= 0.0:
            raise CaseError(f"diameter from weights: {name}: got {value!r}; must be a positive number")
    if not is_number(wet):
        raise CaseError(f"diameter from weights: wet: got {wet!r}; must be a number")
    return math.sqrt(4.0 * (dry - wet) / (math.pi * density * gravity))


@dataclass(frozen=True)
class SizingRow:
    """One point of the grid. values: parameter -> value. In static equilibrium: max_curvature [1/m], max_tension [N],
    heights z of the sag and the hog [m] (nan where the line has no wave); curvature_utilisation, tension_utilisation
    and their sum, fitness [-]. reason: why there is no equilibrium (the numbers are nan then), else ''.
    """

    values: Mapping[str, Any]
    max_curvature: float = math.nan
    max_tension: float = math.nan
    sag: float = math.nan
    hog: float = math.nan
    curvature_utilisation: float = math.nan
    tension_utilisation: float = math.nan
    reason: str = ""

    @property
    def fitness(self) -> float:
        return self.curvature_utilisation + self.tension_utilisation

    @property
    def allowed(self) -> bool:
        """Whether neither limit is exceeded (False where there is no equilibrium)."""
        return self.curvature_utilisation <= 1.0 and self.tension_utilisation <= 1.0


@dataclass(frozen=True)
class Sizing:
    """Result of a search: rows, best first. What exceeds a limit comes after all that do not, what has no equilibrium
    last, in the order of the grid. `print` shows the table.
    """

    line: str
    parameters: tuple[str, ...]
    max_curvature: float
    breaking_load: float
    rows: tuple[SizingRow, ...]

    @property
    def best(self) -> SizingRow | None:
        """The best row that exceeds no limit, or None."""
        return self.rows[0] if self.rows and self.rows[0].allowed else None

    def table(self) -> tuple[str, list[str], list[list[str]]]:
        """Title, column heads and rows of text."""
        limits = f"curvature/{self.max_curvature:.4g} 1/m + tension/{self.breaking_load / 1e3:.4g} kN"
        title = f"sizing of '{self.line}', fitness = {limits}"
        heads = [*self.parameters, "curvature [1/m]", "tension [kN]", "sag z [m]", "hog z [m]", "fitness", ""]
        return title, heads, [self._cells(row) for row in self.rows]

    def _cells(self, row: SizingRow) -> list[str]:
        values = [f"{y:.6g}" if is_number(y) else str(y) for y in row.values.values()]
        if row.reason:
            first = row.reason.partition("; ")[0]
            return [*values, "", "", "", "", "", first if len(first) <= 80 else f"{first[:77]}..."]
        over = [f"{name} {share:.0%} of its limit"
                for name, share in (("curvature", row.curvature_utilisation), ("tension", row.tension_utilisation))
                if not share <= 1.0]  # fmt: skip
        wave = ["" if math.isnan(z) else f"{z:.2f}" for z in (row.sag, row.hog)]
        return [*values, f"{row.max_curvature:.4f}", f"{row.max_tension / 1e3:.3f}", *wave, f"{row.fitness:.4f}",
                ", ".join(over)]  # fmt: skip

    def __rich__(self) -> Any:
        from rich.box import SIMPLE
        from rich.table import Table
        from rich.text import Text

        title, heads, rows = self.table()
        table = Table(title=title, box=SIMPLE, title_justify="left")
        for head in heads:
            table.add_column(Text(head), justify="right" if head else "left", overflow="fold")
        for cells in rows:
            table.add_row(*map(Text, cells))
        return table

    def __str__(self) -> str:
        from io import StringIO

        from rich.console import Console

        text = StringIO()
        Console(file=text, width=1000).print(self)
        return "\n".join(part.rstrip() for part in text.getvalue().splitlines())


def sizing(
    build: Callable[..., Model],
    grid: Mapping[str, Sequence[Any]],
    line: str,
    max_curvature: float | None = None,
    breaking_load: float | None = None,
) -> Sizing:
    """Fitness of `line` in the static equilibrium of build(**values), for all combinations of the grid's values.

    max_curvature [1/m], breaking_load [N]: the limits; if left out, the strictest of the sections of the line
    (1/minimum_bend_radius, breaking_load). Points that cannot be built or find no equilibrium are rows with a reason.
    Raises CaseError for a grid without values, parameters that `build` does not take, an unknown line, or limits
    that are not positive or known from nowhere.
    """
    if not callable(build):
        raise CaseError(f"sizing: build: got {build!r:.60}; must be a function that returns a Model")
    if not isinstance(grid, Mapping):
        raise CaseError(f"sizing: grid: got {grid!r:.60}; must be a dictionary, parameter: list of values")
    for name, limit in (("max_curvature", max_curvature), ("breaking_load", breaking_load)):
        if limit is not None and (not is_number(limit) or limit <= 0.0):
            raise CaseError(f"sizing: {name}: got {limit!r}; must be a positive number")
    points = _points(build, grid)
    limits: tuple[float, float] | None = None
    rows = []
    for values in points:
        try:
            model = build(**values)
            if not isinstance(model, Model):
                raise TypeError(f"build returned {type(model).__name__}, not a Model")
        except (FloatsimError, ValueError, ArithmeticError) as error:
            rows.append(SizingRow(values, reason=_reason(error)))
            continue
        found = _line(model, line)
        own = _limits(found, max_curvature, breaking_load)
        limits = own if limits is None else (min(limits[0], own[0]), min(limits[1], own[1]))
        try:
            rows.append(_evaluate(model, found, values, own))
        except (FloatsimError, ArithmeticError, np.linalg.LinAlgError) as error:
            rows.append(SizingRow(values, reason=_reason(error)))
    curvature, load = limits or (max_curvature or math.nan, breaking_load or math.nan)
    rows.sort(key=lambda row: (bool(row.reason), not row.allowed, 0.0 if row.reason else row.fitness))
    return Sizing(line, tuple(grid), curvature, load, tuple(rows))


def _points(build: Callable[..., Model], grid: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    """All combinations, the last parameter changing fastest."""
    import inspect

    accepted = inspect.signature(build).parameters
    anything = any(p.kind is p.VAR_KEYWORD for p in accepted.values())
    columns = {}
    for name, values in grid.items():
        if name not in accepted and not anything:
            raise CaseError(f"sizing: build takes no parameter '{name}'{nearest(str(name), accepted)}")
        if isinstance(values, str) or not np.iterable(values):
            raise CaseError(f"sizing: grid: '{name}': got {values!r}; must be a list of values")
        columns[name] = [y.item() if isinstance(y, np.generic) else y for y in values]
        if not columns[name]:
            raise CaseError(f"sizing: grid: '{name}' has no values")
    if not columns:
        raise CaseError("sizing: the grid is empty; give at least one parameter with its values")
    return [dict(zip(columns, point)) for point in itertools.product(*columns.values())]


def _line(model: Model, name: str) -> Line:
    lines = {part.name: part for part in model.parts if isinstance(part, Line)}
    if name not in lines:
        raise CaseError(f"sizing: there is no line '{name}'{nearest(str(name), lines)}")
    return lines[name]


def _limits(line: Line, max_curvature: float | None, breaking_load: float | None) -> tuple[float, float]:
    """The largest allowed curvature [1/m] and the breaking load [N]."""
    sections = [piece.section for piece in line.pieces]
    if max_curvature is None:
        radii = [s.minimum_bend_radius for s in sections if s.minimum_bend_radius is not None]
        if not radii:
            raise CaseError(f"sizing: no section of '{line.name}' has a minimum_bend_radius; give max_curvature [1/m]")
        max_curvature = 1.0 / max(radii)
    if breaking_load is None:
        loads = [s.breaking_load for s in sections if s.breaking_load is not None]
        if not loads:
            raise CaseError(f"sizing: no section of '{line.name}' has a breaking_load; give breaking_load [N]")
        breaking_load = min(loads)
    return float(max_curvature), float(breaking_load)


def _evaluate(model: Model, line: Line, values: dict[str, Any], limits: tuple[float, float]) -> SizingRow:
    system = assemble(model)
    state, _ = solve_static(system)
    sampler = Sampler(system, [f"{line.name}_{what}" for what in ("position", "tension", "curvature")])
    row = sampler.sample_state(state)[None]
    curvature = float(np.nanmax(sampler.column(row, f"{line.name}_curvature")))
    tension = float(sampler.column(row, f"{line.name}_tension").max())
    sag, hog = _sag_and_hog(sampler.column(row, f"{line.name}_position")[0][:, 2])
    return SizingRow(values, curvature, tension, sag, hog, curvature / limits[0], tension / limits[1])


def _sag_and_hog(z: Array) -> tuple[float, float]:
    """Height where the line first rises again, seen from its higher end, and the highest it gets after that.

    nan without a wave: ripples on the bed are none.
    """
    if z[0] < z[-1]:
        z = z[::-1]
    rising = np.flatnonzero(np.diff(z) > 0.0)
    if len(rising) == 0:
        return math.nan, math.nan
    top = int(rising[0] + np.argmax(z[rising[0] :]))
    sag, hog = float(z[:top].min()), float(z[top])
    return (sag, hog) if hog - sag > 1e-3 * (z[0] - z.min()) and hog > z[-1] else (math.nan, math.nan)


def _reason(error: Exception) -> str:
    """What went wrong, on one line."""
    text = re.sub(r"Model '\w+': ", "", "; ".join(str(error).splitlines()))
    return text if isinstance(error, FloatsimError) else f"{type(error).__name__}: {text}"
