"""Some of a matrix's cases: those with given values, and a sample spread evenly over the variables."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np

from floatsim.cases.case import Case, Value
from floatsim.cases.matrix import Matrix
from floatsim.cases.tables import value_of
from floatsim.description import is_number
from floatsim.errors import CaseError, nearest

_BINS = 8  # into which a column with more values is parted


def parse_only(pairs: Sequence[str]) -> dict[str, list[Value]]:
    """`name=v1,v2` strings -> name: values. Raises CaseError."""
    out: dict[str, list[Value]] = {}
    problems = []
    for pair in pairs:
        name, equals, text = pair.partition("=")
        if not equals or not text.strip():
            problems.append(f"--only {pair}: write name=value,value, e.g. --only seed=1,2")
        elif name.strip() in out:
            problems.append(f"--only {name.strip()} is given twice")
        else:
            out[name.strip()] = [value_of(word) for word in text.split(",")]
    if problems:
        raise CaseError(problems)
    return out


def _same(a: Value, b: Value) -> bool:
    if is_number(a) and is_number(b):
        return math.isclose(a, b, rel_tol=1e-6, abs_tol=1e-9)  # type: ignore[arg-type]
    return a == b


def chosen(matrix: Matrix, only: Mapping[str, Sequence[Value]], sample: int | None) -> Matrix:
    """The matrix with the cases alone whose variables have one of the values in `only`, and `sample` of those.

    Numbers and ids of the cases stay those of the whole matrix. Raises CaseError as `with_values` and `spread`.
    """
    cases = with_values(matrix.cases, only)
    return replace(matrix, cases=cases if sample is None else spread(cases, sample, matrix.independent))


def with_values(cases: Sequence[Case], only: Mapping[str, Sequence[Value]]) -> tuple[Case, ...]:
    """Cases whose variables have one of the values that `only` gives for them.

    Raises CaseError for unknown variables, for values that no case has, and if nothing is left.
    """
    kept, problems = tuple(cases), []
    known = list(cases[0].variables) if cases else []
    for name, values in only.items():
        if name not in known:
            problems.append(f"only: there is no variable '{name}'{nearest(name, known)}")
            continue
        has = list(dict.fromkeys(case.variables[name] for case in cases))
        wanted: list[Any] = list(values) if isinstance(values, list | tuple | set | range) else [values]
        for y in wanted:
            if not any(_same(y, z) for z in has):
                problems.append(f"only: no case has {name} = {y!r}; there are {_shown(has)}")
        right = [z for z in has if any(_same(y, z) for y in wanted)]
        kept = tuple(case for case in kept if case.variables[name] in right)
    if problems:
        raise CaseError(problems)
    if not kept:
        raise CaseError("only: no case has all of these values together")
    return kept


def _shown(values: list[Any]) -> str:
    words = [f"{y:g}" if is_number(y) else str(y) for y in values]
    return ", ".join(words) if len(words) <= 12 else f"{', '.join(words[:11])} ... {words[-1]}"


def spread(cases: Sequence[Case], n: int, variables: Sequence[str] | None = None) -> tuple[Case, ...]:
    """n of the cases in their order, spread evenly over values and pairs of values of the variables (default: all).

    One after the other the case is taken whose values, and pairs of values, have been taken least often against what
    their number lets expect; among equals by the multiples of the golden ratio. Columns with many numbers count by
    ranges of them that are equally often. Raises CaseError if n is no number of cases.
    """
    if not isinstance(n, int) or isinstance(n, bool) or n < 1:
        raise CaseError(f"sample: got {n!r}; must be a number of cases, at least 1")
    if n >= len(cases):
        return tuple(cases)
    columns = [_bins([case.variables[name] for case in cases]) for name in variables or cases[0].variables]
    columns = [column for column in columns if column.max() > 0]
    groups = [(column, 4.0) for column in columns]  # a value by itself counts more than a pair
    groups += [(a * (b.max() + 1) + b, 1.0) for a, b in combinations(columns, 2)]
    ids = [(np.unique(group, return_inverse=True)[1].ravel(), weight) for group, weight in groups]
    counts = [np.zeros(place.max() + 1) for place, _ in ids]
    tie = np.modf(0.5 * (math.sqrt(5.0) - 1.0) * np.arange(1, len(cases) + 1))[0]
    score = 1e-6 * tie
    taken = []
    for _ in range(n):
        k = int(np.argmin(score))
        taken.append(k)
        score[k] = np.inf
        for (place, weight), count in zip(ids, counts):
            count[place[k]] += 1.0
            score[place == place[k]] += weight * len(count)
    return tuple(cases[k] for k in sorted(taken))


def _bins(values: list[Value]) -> np.ndarray:
    """Number of each value among the sorted values, or of the range it is in."""
    order = {y: k for k, y in enumerate(sorted(set(values), key=lambda y: (isinstance(y, str), y)))}  # type: ignore[type-var]
    place = np.array([order[y] for y in values], dtype=np.int64)
    return place if len(order) <= _BINS else place * _BINS // len(order)
