"""Tables for a matrix: columns of a metocean record, and scatter tables."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from pathlib import Path

from floatsim.cases.case import Value
from floatsim.cases.expressions import plain
from floatsim.errors import CaseError, nearest
from floatsim.study.power_matrix import read_occurrence


def value_of(text: str) -> Value:
    """What a cell or a word of a command line says: a finite number, true or false, or text."""
    text = text.strip()
    if text in ("true", "True", "false", "False"):
        return text in ("true", "True")
    try:
        number = float(text)
    except ValueError:
        return text
    return plain(number) if math.isfinite(number) else text


def read_columns(path: Path, columns: Mapping[str, str] | None = None) -> dict[str, list[Value]]:
    """Columns of a CSV file by name: numbers, text where a cell is none.

    columns: our name -> name in the first line of the file; without it all columns under their own names. Cells are
    parted by commas, semicolons or tabs; lines that start with # are left out. Raises CaseError for a file that cannot
    be read, for columns that are not there (with the nearest that is), for short lines and empty cells.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except OSError as error:
        raise CaseError(f"table '{path}' cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise CaseError(f"table '{path}' is no text in UTF-8") from None
    numbered = [(n, line) for n, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    if len(numbered) < 2:
        raise CaseError(f"table '{path}' has no rows; a line with names of columns and lines of values are needed")
    first = numbered[0][1]
    mark = max(",;\t", key=first.count)
    head, *rows = ([cell.strip() for cell in row] for row in csv.reader((line for _, line in numbered), delimiter=mark))
    wanted = dict(columns) if columns else {name: name for name in head}
    problems = [
        f"table '{path}' has no column '{theirs}'{nearest(str(theirs), head)}"
        for theirs in wanted.values() if theirs not in head
    ]  # fmt: skip
    problems += [f"table '{path}' has two columns '{name}'" for name in {*wanted.values()} if head.count(name) > 1]
    places = {ours: head.index(theirs) for ours, theirs in wanted.items() if theirs in head}
    out: dict[str, list[Value]] = {ours: [] for ours in wanted}
    for (n, _), row in zip(numbered[1:], rows):
        if len(row) != len(head):
            problems.append(f"table '{path}', line {n}: {len(row)} cells under {len(head)} names")
            continue
        for ours, k in places.items():
            if not row[k]:
                problems.append(f"table '{path}', line {n}: column '{head[k]}' is empty")
            out[ours].append(value_of(row[k]))
    if problems:
        raise CaseError(problems)
    return out


def read_scatter(path: Path) -> list[tuple[Value, Value, Value]]:
    """Cells (hs [m], tp [s], occurrence) of a scatter table that occur, row by row. Raises CaseError."""
    hs, tp, share = read_occurrence(path)
    if (share < 0.0).any():
        raise CaseError(f"table '{path}': an occurrence is negative")
    cells = [
        (plain(float(h)), plain(float(t)), plain(float(p)))
        for h, row in zip(hs, share) for t, p in zip(tp, row) if p > 0.0
    ]  # fmt: skip
    if not cells:
        raise CaseError(f"table '{path}': no sea state occurs")
    return cells
