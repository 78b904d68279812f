"""`floatsim cases list`: what a matrix contains, in one look or as a file with all columns; and the templates."""

from __future__ import annotations

import csv as text_table
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from floatsim.cases.case import Value
from floatsim.cases.choice import parse_only
from floatsim.cases.matrix import Matrix, Progress, read_matrix
from floatsim.description import is_number
from floatsim.errors import CaseError, nearest

_ENDS = 4  # cases shown from either end
_TEMPLATES = Path(__file__).with_name("templates")


def list_cases(
    path: str | Path,
    only: Sequence[str] | Mapping[str, Sequence[Value]] = (),
    sample: int | None = None,
    csv: str | Path | None = None,
    check: bool = True,
    console: Any = None,
    progress: Progress | None = None,
) -> Matrix:
    """Print the variables with their values, the first and last cases, and how many there are; the matrix.

    only: variable -> values, or words `name=v1,v2`. csv: file for all cases with all variables. check, sample,
    progress: see `read_matrix`, which also says what is wrong. Raises CaseError.
    """
    given = only if isinstance(only, Mapping) else parse_only(only)
    matrix = read_matrix(path, check=check, only=given, sample=sample, progress=progress)
    if console is None:
        from rich.console import Console

        console = Console(highlight=False, markup=False)
    for title, heads, rows in tables(matrix):
        console.print(_rich(title, heads, rows))
    console.print(summary(matrix))
    if csv is not None:
        write_csv(matrix, csv)
        console.print(f"wrote {csv}")
    return matrix


def tables(matrix: Matrix) -> list[tuple[str, list[str], list[list[str]]]]:
    """(title, heads, rows) of the variables, and of the first and last cases."""
    rows = []
    for name in matrix.variables:
        values = list(dict.fromkeys(matrix.column(name)))
        rows.append([name, matrix.units.get(name, ""), str(len(values)), _span(values)])
    cases = list(matrix.cases)
    ends = cases if len(cases) <= 2 * _ENDS + 1 else [*cases[:_ENDS], None, *cases[-_ENDS:]]
    heads = ["number", "id"]
    lines = [["...", "..."] if case is None else [str(case.number), case.id] for case in ends]
    return [
        (f"variables of '{matrix.name}'", ["variable", "unit", "values", "which"], rows),
        ("cases", heads, lines),
    ]


def summary(matrix: Matrix) -> str:
    """How many cases, of how many, and how much time they simulate."""
    time = sum(case.run.total for case in matrix.cases)
    of = "" if len(matrix.cases) == matrix.size else f" of {matrix.size}"
    return f"{len(matrix.cases)}{of} cases, {_time(time)} to simulate, results in {matrix.results}"


def write_csv(matrix: Matrix, path: str | Path) -> None:
    """All cases with all variables. Raises CaseError for a file that cannot be written."""
    try:
        with Path(path).open("w", newline="", encoding="utf-8") as file:
            writer = text_table.writer(file)
            writer.writerow(["number", "case_id", *matrix.variables])
            writer.writerows([case.number, case.id, *case.variables.values()] for case in matrix.cases)
    except OSError as error:
        raise CaseError(f"'{path}' cannot be written: {error.strerror or error}") from None


def templates() -> list[str]:
    """Names of the matrices to start from."""
    return sorted(path.stem for path in _TEMPLATES.glob("*.yaml"))


def template(name: str) -> str:
    """Text of a matrix to start from: fill in what stands in `<...>`. Raises CaseError for an unknown name."""
    if name not in templates():
        raise CaseError(f"there is no template '{name}'{nearest(str(name), templates())}")
    return (_TEMPLATES / f"{name}.yaml").read_text(encoding="utf-8")


def headline(name: str) -> str:
    """The first line of a template: what it is."""
    return template(name).splitlines()[0].lstrip("# ")


def _span(values: list[Any]) -> str:
    if all(map(is_number, values)):
        values = sorted(values)
    words = [f"{y:.6g}" if is_number(y) else str(y) for y in values]
    if len(words) <= 10:
        return ", ".join(words)
    if all(map(is_number, values)):
        return f"{values[0]:.6g} to {values[-1]:.6g}"
    return f"{', '.join(words[:6])} ... {words[-1]}"


def _time(seconds: float) -> str:
    if not math.isfinite(seconds) or seconds < 7200.0:
        return f"{seconds:g} s"
    return f"{seconds / 3600.0:.4g} h"


def _rich(title: str, heads: list[str], rows: list[list[str]]) -> Any:
    from rich.box import SIMPLE
    from rich.table import Table
    from rich.text import Text

    table = Table(title=Text(title), title_justify="left", box=SIMPLE, pad_edge=False)
    for head in heads:
        table.add_column(Text(head), justify="right" if head in ("number", "values") else "left", overflow="fold")
    for row in rows:
        table.add_row(*map(Text, row))
    return table
