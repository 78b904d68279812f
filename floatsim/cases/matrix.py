"""The matrix: a YAML file of variables and what they mean for model, sea, wind and run, as a tuple of cases.

Variables with several values span a product, the first one slowest; `zip` walks columns together, `table` and `scatter`
read rows from a file, each one more factor of the product. Variables that are expressions follow from others. `blocks`
are matrices one after the other that take over what stands at the top and change or add to it. A text in `parameters`,
`waves`, `current`, `wind` and `run` is an expression of variables. docs/howto_cases.md is the guide.
"""

from __future__ import annotations

import keyword
import os
import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from itertools import product
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, model_validator

from floatsim.cases.case import Case, RunSettings, Value
from floatsim.cases.document import Document, Key, dotted
from floatsim.cases.environment import KEYS, current_of, waves_of
from floatsim.cases.expressions import CONSTANTS, FUNCTIONS, Expression, in_order, parse, plain, strangers
from floatsim.cases.tables import read_columns, read_scatter
from floatsim.description import Description, Finite, NonNegative, Positive, is_number
from floatsim.errors import CaseError, FloatsimError, ModelError, nearest
from floatsim.study.release import DOFS
from floatsim.study.script import Script, content_hash, data_files, script_files

SECTIONS = ("waves", "current", "wind")
_BLOCK = ("name", "model", "variables", "zip", "table", "scatter", "parameters", *SECTIONS, "run")
_TOP = (*_BLOCK, "blocks", "units")
_WORDS = {  # keys whose texts are words
    "run": ("study", "keep", "precision", "dof", "channels"), "waves": ("spectrum", "kind"),
}  # fmt: skip
RESERVED = ("case", "case_id", "status", "failure", "wall_time", "steps", "newton_iterations", "time", "block",
            "group", "xyz", "dof")  # fmt: skip
MOST = 1_000_000  # cases
_SLUG = 72  # characters

Progress = Callable[[int, int], None]


def _channels(value: Any) -> Any:
    if value == "all":
        return value
    if not isinstance(value, list | tuple) or not value or not all(isinstance(name, str) for name in value):
        raise ValueError(f"got {value!r}; must be all, or a list of names")
    return tuple(value)


class _Run(Description):
    """The values of `run`, as RunSettings has them."""

    duration: Positive
    ramp: NonNegative = 100.0
    dt: Positive = 0.1
    interval: Positive | None = None
    channels: Annotated[Any, BeforeValidator(_channels)] = "all"
    keep: Literal["series", "statistics"] = "statistics"
    precision: Literal["float64", "float32"] = "float32"
    fatigue: dict[str, Positive] = {}
    block: Positive = 600.0
    time_limit: Positive | None = None
    study: Literal["run", "decay"] = "run"
    dof: Literal["", "surge", "sway", "heave", "roll", "pitch", "yaw"] = ""
    offset: Finite = 0.0

    @model_validator(mode="after")
    def _consistent(self) -> _Run:
        if self.study == "decay" and (not self.dof or self.offset == 0.0):
            raise ValueError(f"a decay test needs dof ({', '.join(DOFS)}) and an offset other than zero")
        if self.study == "run" and (self.dof or self.offset):
            raise ValueError("dof and offset belong to study: decay")
        return self


_Run.__name__ = "run"  # the name its problems are reported under


@dataclass(frozen=True)
class Matrix:
    """A matrix that has been read.

    name; path of the YAML file; variables: names of the columns, in order; independent: those of them that are not
    expressions of others; units: name -> unit, where it is known; cases: in order, each with its number in the whole
    matrix; size: of the whole matrix, before `only` and `sample`; files: a case's source -> files it is the hash of.
    """

    name: str
    path: Path
    variables: tuple[str, ...]
    independent: tuple[str, ...]
    units: Mapping[str, str]
    cases: tuple[Case, ...] = field(repr=False)
    size: int
    files: Mapping[str, frozenset[Path]] = field(default_factory=dict, repr=False)

    @property
    def results(self) -> Path:
        """Default folder of the results, beside the file."""
        return self.path.parent / f"{self.path.stem}_results"

    def column(self, name: str) -> list[Value]:
        """One variable of all cases. Raises CaseError for a name that is not there."""
        if name not in self.variables:
            raise CaseError(f"matrix '{self.name}' has no variable '{name}'{nearest(name, self.variables)}")
        return [case.variables[name] for case in self.cases]


def read_matrix(
    path: str | Path,
    check: bool = True,
    only: Mapping[str, Sequence[Value]] | None = None,
    sample: int | None = None,
    progress: Progress | None = None,
) -> Matrix:
    """The matrix of a YAML file.

    check: build every distinct model, and look for what would go wrong in a run (cases/check.py); progress(done, all)
    then tells how far it is. only: variable -> values, keeps the cases that have one of them. sample: keep so many of
    those, spread evenly over the variables, the same at every call.

    Raises CaseError with every problem: file, line, key, what was got, the nearest known name.
    """
    document = Document(Path(path))
    reader = _Reader(document)
    matrix = reader.matrix()
    if only or sample is not None:
        from floatsim.cases.choice import chosen

        matrix = chosen(matrix, only or {}, sample)
    if check:
        from floatsim.cases.check import check_matrix

        check_matrix(matrix, progress)
    return matrix


def unit_of(name: str) -> str:
    """Unit of a variable by the habits of names, '' if they do not tell."""
    for pattern, unit in (
        (r".*_deg", "deg"), (r"(.*_)?(hs|depth|height|elevation)", "m"), (r"(.*_)?(tp|tz|te|period|duration)", "s"),
        (r"(.*_)?speed", "m/s"), (r"(.*_)?(ti|occurrence|probability|gamma|turbulence_intensity)", "1"),
    ):  # fmt: skip
        if re.fullmatch(pattern, name):
            return unit
    return ""


# -- values ----------------------------------------------------------------------------------------


@dataclass
class _Axis:
    """Names that walk together, and their rows. told: how many of the names tell rows apart, None: all."""

    names: tuple[str, ...]
    rows: list[tuple[Value, ...]]
    told: int | None = None


def _steps(first: Any, last: Any, step: Any) -> list[Value]:
    """first, first + step, ... last, exact in decimals. Raises CaseError if the last is not met."""
    if not all(map(is_number, (first, last, step))) or step == 0:
        raise CaseError(f"got a range from {first!r} to {last!r} in steps of {step!r}; three numbers, no step of 0")
    a, b, h = (Decimal(str(y)) for y in (first, last, step))
    n = (b - a) / h
    if n < 0 or n > MOST:
        raise CaseError(f"a range from {first} to {last} in steps of {step} has no end; steps lead from first to last")
    if n != int(n):
        raise CaseError(f"steps of {step} from {first} do not meet {last}; the last one below is {a + int(n) * h}")
    return [plain(float(a + k * h)) for k in range(int(n) + 1)]


def _spaced(row: Any) -> list[Value]:
    """n values from the first to the last of (first, last, n)."""
    if not isinstance(row, list) or len(row) != 3 or not all(map(is_number, row)):
        raise CaseError(f"got {row!r}; linspace takes [first, last, number of values]")
    first, last, n = row
    if not isinstance(n, int) or not 2 <= n <= MOST:
        raise CaseError(f"got {n!r} values; linspace takes a whole number of at least 2")
    return [plain(first + (last - first) * k / (n - 1)) for k in range(n)]


def _seeds(spec: Mapping[str, Any]) -> list[Value]:
    n, first = spec["seeds"], spec.get("first", 1)
    if not isinstance(n, int) or isinstance(n, bool) or not 1 <= n <= MOST:
        raise CaseError(f"got seeds: {n!r}; a number of seeds, at least 1")
    if not isinstance(first, int) or isinstance(first, bool) or first < 0:
        raise CaseError(f"got first: {first!r}; a seed is a whole number, not negative")
    return [first + k for k in range(n)]


# the key that tells the kind -> all keys of it
_SPECS = {"range": ("range", "step"), "linspace": ("linspace",), "seeds": ("seeds", "first"), "text": ("text",)}


def levels(spec: Any) -> list[Value] | Expression:
    """Values of a variable as the file describes it, or its expression. Raises CaseError."""
    if isinstance(spec, str):
        return parse(spec)
    if isinstance(spec, bool) or is_number(spec):
        return [plain(spec)]
    if isinstance(spec, list):
        wrong = [y for y in spec if not (isinstance(y, str | bool) or is_number(y))]
        if wrong:
            raise CaseError(f"got {wrong[0]!r} in the list; values are finite numbers or text")
        values = [plain(y) for y in spec]
        twice = [y for y, n in Counter(values).items() if n > 1]
        if twice or not values:
            raise CaseError(f"{twice[0]!r} is in the list twice" if twice else "the list is empty")
        return values
    if isinstance(spec, dict):
        kind = next((key for key in _SPECS if key in spec), None)
        wrong_keys = [key for key in spec if key not in _SPECS.get(kind or "", _SPECS)]
        if wrong_keys:
            raise CaseError(f"there is no '{wrong_keys[0]}'{nearest(wrong_keys[0], _SPECS.get(kind or '', _SPECS))}")
        if kind == "range":
            ends = spec["range"]
            if not isinstance(ends, list) or len(ends) != 2 or "step" not in spec:
                raise CaseError(f"got {spec!r}; a range is {{range: [first, last], step: ...}}")
            return _steps(ends[0], ends[1], spec["step"])
        if kind == "linspace":
            return _spaced(spec["linspace"])
        if kind == "seeds":
            return _seeds(spec)
        if kind == "text":
            return [str(spec["text"])]
    raise CaseError(
        f"got {spec!r}; a number, a list, {{range: [first, last], step: ...}}, {{linspace: [first, last, n]}}, "
        "{seeds: n}, {text: word} or an expression"
    )


class _Template:
    """A section whose texts are expressions of variables: called with a case's variables it gives its values."""

    def __init__(self, section: Any, key: Key, known: Iterable[str], base: Path, problem: Callable[[Key, Any], None]):
        self._known, self._base, self._problem = tuple(known), base, problem
        self.needs: set[str] = set()
        self._tree = self._read(section, key)
        self._names = tuple(sorted(self.needs))
        self._memory: dict[tuple[Value, ...], Any] = {}

    def _read(self, item: Any, key: Key) -> Any:
        if isinstance(item, dict):
            if item.keys() == {"text"} and len(key) > 1:
                return str(item["text"])
            if item.keys() == {"file"} and len(key) > 1:
                if key[0] != "parameters":
                    self._problem(key, "files can be given in parameters only")
                file = self._base / str(item["file"])
                if not file.exists():
                    self._problem(key, f"there is no file '{file}'")
                return {"file": file}
            return {name: self._read(value, (*key, name)) for name, value in item.items()}
        if isinstance(item, list):
            return [self._read(value, (*key, k)) for k, value in enumerate(item)]
        if not isinstance(item, str):
            return plain(item)
        word = next((part for part in reversed(key) if isinstance(part, str)), "")
        if word in _WORDS.get(str(key[0]), ()) and item not in self._known:
            return item
        try:
            expression = parse(item)
        except CaseError as error:
            self._problem(key, error)
            return None
        for sentence in strangers(expression, self._known):
            self._problem(key, sentence)
        self.needs |= expression.names
        return expression

    def __call__(self, values: Mapping[str, Value]) -> Any:
        """Raises CaseError for an expression without a value."""
        at = tuple(values[name] for name in self._names)
        if at not in self._memory:
            self._memory[at] = self._resolved(self._tree, values)
        return self._memory[at]

    def _resolved(self, item: Any, values: Mapping[str, Value]) -> Any:
        if isinstance(item, Expression):
            return item(values)
        if isinstance(item, dict):
            return {name: self._resolved(value, values) for name, value in item.items()}
        return [self._resolved(value, values) for value in item] if isinstance(item, list) else item


# -- reading ---------------------------------------------------------------------------------------


class _Reader:
    """Makes a matrix of a document, collecting every problem."""

    def __init__(self, document: Document) -> None:
        self._document, self._problems = document, list[str]()
        self._sources: dict[Any, str] = {}
        self._files: dict[str, frozenset[Path]] = {}
        self._base = document.path.parent

    def problem(self, key: Key, said: Any) -> None:
        lines = said.problems if isinstance(said, CaseError | ModelError) else [str(said)]
        for line in lines:
            text = f"{self._document.at(key)}: {line}"
            if text not in self._problems:
                self._problems.append(text)

    def stop_if_wrong(self) -> None:
        if self._problems:
            raise CaseError(self._problems)

    def matrix(self) -> Matrix:
        data = self._document.data
        if not isinstance(data, dict):
            raise CaseError(f"{self._document.path.name}: a matrix has keys: {', '.join(_TOP)}")
        self._keys(data, (), _TOP)
        units = self._units(data.get("units"))
        blocks = self._blocks(data)
        made = [_Block(self, block, keys) for block, keys in blocks]
        if not made:
            self.stop_if_wrong()
        variables = made[0].variables
        for block in made[1:]:
            for name in set(variables) ^ set(block.variables):
                self.problem(block.key, f"'{name}' is a variable of some blocks only; give it a value in all")
        for name in units:
            if name not in variables:
                self.problem(("units", name), f"there is no variable '{name}'{nearest(name, variables)}")
        self.stop_if_wrong()
        axes = [axis for block in made for axis in block.axes if len(axis.rows) > 1]
        varying = {name for axis in axes for name in axis.names[: axis.told]}
        if len(made) > 1:
            values: dict[str, set[Any]] = defaultdict(set)
            for block in made:
                for name in block.independent:
                    values[name].update(y for axis in block.axes if name in axis.names
                                        for y in (row[axis.names.index(name)] for row in axis.rows))  # fmt: skip
            varying |= {name for name, ys in values.items() if len(ys) > 1}
        short = _abbreviations([name for name in variables if name in varying])
        cases: list[Case] = []
        for block in made:
            cases += block.cases(len(cases), short)
            if len(self._problems) > 50 or len(cases) > MOST:
                break
        if len(cases) > MOST:
            self.problem((), f"more than {MOST} cases")
        self.stop_if_wrong()
        self._twice(cases)
        self.stop_if_wrong()
        name = data.get("name", self._document.path.stem)
        guessed = {v: unit_of(v) for v in variables if unit_of(v)}
        independent = tuple(v for v in variables if any(v in block.independent for block in made))
        return Matrix(name, self._document.path.absolute(), variables, independent, {**guessed, **units},
                      tuple(cases), len(cases), self._files)  # fmt: skip

    def _keys(self, data: dict[str, Any], key: Key, known: Sequence[str]) -> None:
        for name in data:
            if name not in known:
                self.problem((*key, name), f"there is no key '{name}'{nearest(name, known)}")
        if "name" in data and not (isinstance(data["name"], str) and re.fullmatch(r"[\w .-]+", data["name"])):
            self.problem((*key, "name"), f"got {data['name']!r}; must be a word")
        for name in ("variables", "parameters", *SECTIONS, "run", "units"):
            if not isinstance(data.get(name, {}), dict | None):
                self.problem((*key, name), f"got {data[name]!r}; must be keys with values")
                data[name] = {}

    def _units(self, units: Any) -> dict[str, str]:
        out = {}
        for name, unit in (units or {}).items():
            out[name] = str(unit)
            if not isinstance(unit, str | int):
                self.problem(("units", name), f"got {unit!r}; must be text")
        return out

    def _blocks(self, data: dict[str, Any]) -> Iterator[tuple[dict[str, Any], dict[str, Key]]]:
        """Every block with what it takes over from the top, and where each of its sections stands."""
        blocks = data.get("blocks")
        if blocks is None:
            return iter([(data, {})])
        if not isinstance(blocks, list) or not blocks or not all(isinstance(block, dict) for block in blocks):
            self.problem(("blocks",), "must be a list of blocks, each with keys such as variables, parameters, run")
            return iter(())
        out = []
        named = [block.get("name") for block in blocks]
        if any(named) and (None in named or len(set(map(str, named))) < len(named)):
            self.problem(("blocks",), "either all blocks have names, and no two the same, or none has")
        for k, block in enumerate(blocks):
            key: Key = ("blocks", k)
            self._keys(block, key, _BLOCK)
            joined: dict[str, Any] = {name: y for name, y in data.items() if name not in ("blocks", "name", "units")}
            keys: dict[str, Key] = {"": key}
            for name, item in block.items():
                if name in ("variables", "parameters", "run"):
                    joined[name] = {**(data.get(name) or {}), **(item or {})}
                    keys |= {f"{name}.{own}": (*key, name, own) for own in item or {}}
                elif name in ("zip", "table", "scatter"):
                    joined[name] = [*_listed(data.get(name)), *_listed(item)]
                    keys[name] = (*key, name)
                else:
                    joined[name] = item
                    keys[name] = (*key, name)
            out.append((joined, keys))
        return iter(out)

    def source(self, model: str, parameters: dict[str, Any], key: Key) -> str:
        """Hash of a script, of what it imports from its folder and of the data its model reads.

        The model is built once for the first of all parameters that differ in numbers only: numbers choose no files,
        as the check of the matrix makes sure.
        """
        from floatsim.cases.environment import parameters_of

        words = {name: y for name, y in parameters.items() if not is_number(y)}
        sort = (model, repr(sorted(words.items())))
        if sort not in self._sources:
            case = Case(0, "", {}, model, parameters, {}, RunSettings(1.0), "")
            real = parameters_of(case)
            self._sources[sort] = ""
            try:
                script = Script(model)
                given = {name: None for name in SECTIONS if name in script.needs}
                files = data_files(script({**given, **real}))
                named = [Path(y) for y in _files(parameters, Path(model).parent)]
                own = [*script_files(model), *files, *named]
                self._sources[sort] = content_hash(own)
                self._files[self._sources[sort]] = frozenset(file.resolve() for file in own)
            except (FloatsimError, OSError) as error:
                self.problem(key, error if isinstance(error, CaseError | ModelError) else f"{error}")
        return self._sources[sort]

    def _twice(self, cases: list[Case]) -> None:
        """Cases that are the same: results would overwrite each other, or be computed twice."""
        first: dict[str, Case] = {}
        pairs: dict[tuple[str, ...], list[tuple[int, int]]] = defaultdict(list)
        for case in cases:
            same = first.setdefault(case.id.rpartition("-")[2], case)
            if same is not case:
                differ = tuple(n for n in case.variables if case.variables[n] != same.variables[n])
                pairs[differ].append((same.number, case.number))
        for differ, found in pairs.items():
            why = (
                f"what differs, {', '.join(differ)}, changes neither parameters nor environment nor run"
                if differ else "all of their variables are equal"
            )  # fmt: skip
            more = f" (and {len(found) - 1} more pairs)" if len(found) > 1 else ""
            self.problem((), f"cases {found[0][0]} and {found[0][1]} are the same case{more}: {why}")


def _files(item: Any, folder: Path) -> list[Path]:
    """Files named by {file: ...} anywhere in the parameters."""
    if isinstance(item, dict):
        if item.keys() == {"file"}:
            return [folder / item["file"]]
        return [file for _, value in sorted(item.items()) for file in _files(value, folder)]
    return [file for value in item for file in _files(value, folder)] if isinstance(item, list) else []


def _listed(item: Any) -> list[Any]:
    return [] if item is None else item if isinstance(item, list) else [item]


class _Block:
    """One product of axes and what follows from it."""

    def __init__(self, reader: _Reader, data: dict[str, Any], keys: dict[str, Key]) -> None:
        self._reader, self._data, self._keys = reader, data, keys
        self.key: Key = keys.get("", ())
        self.axes: list[_Axis] = []
        self._expressions: dict[str, Expression] = {}
        self._at: dict[str, Key] = {}  # where a variable is described
        if self.key and "name" in data:
            self._add_axis(_Axis(("group",), [(str(data["name"]),)]), (*self.key, "name"))
        order: list[str] = [*(["group"] if self._at else [])]
        for kind in data:  # factors in the order of the file
            if kind == "variables":
                order += self._variables(data[kind] or {})
            elif kind in ("zip", "table", "scatter"):
                for item in _listed(data[kind]):
                    order += self._rows(kind, item, keys.get(kind, (kind,)))
        self.variables = tuple(dict.fromkeys(order))
        self.independent = tuple(name for axis in self.axes for name in axis.names[: axis.told])
        self._arrange()
        self._sections()

    def _variables(self, described: Mapping[str, Any]) -> list[str]:
        """Add the axes and expressions of variables; their names."""
        for name, spec in described.items():
            key = self._keys.get(f"variables.{name}", ("variables", name))
            self._name(name, key)
            try:
                values = levels(spec)
            except CaseError as error:
                self._reader.problem(key, error)
                continue
            if isinstance(values, Expression):
                if name in self._at:
                    self._reader.problem(key, f"the variable '{name}' is given twice")
                self._expressions[name] = values
                self._at[name] = key
            else:
                self._add_axis(_Axis((name,), [(y,) for y in values]), key)
        return list(described)

    def _name(self, name: str, key: Key) -> None:
        if not re.fullmatch(r"[a-z][a-z0-9_]*", name) or keyword.iskeyword(name):
            self._reader.problem(key, f"'{name}' cannot be a name; lower-case letters, digits and underscores, a "
                                      "letter first")  # fmt: skip
        elif name in FUNCTIONS or name in CONSTANTS:
            self._reader.problem(key, f"'{name}' is a function or constant of expressions; take another name")
        elif name in RESERVED:
            self._reader.problem(key, f"'{name}' has its own meaning in the summary of results; take another name")

    def _add_axis(self, axis: _Axis, key: Key) -> None:
        for name in axis.names:
            if name in self._at:
                self._reader.problem(key, f"the variable '{name}' is given twice")
            self._at[name] = key
        self.axes.append(axis)

    def _rows(self, kind: str, item: Any, key: Key) -> list[str]:
        """Add the axis of a zip, table or scatter; its names."""
        try:
            axis = {"zip": self._zip, "table": self._table, "scatter": self._scatter}[kind](item)
        except CaseError as error:
            self._reader.problem(key, error)
            return []
        for name in axis.names:
            self._name(name, key)
        self._add_axis(axis, key)
        return list(axis.names)

    def _zip(self, item: Any) -> _Axis:
        if not isinstance(item, dict) or not item:
            raise CaseError(f"got {item!r}; a zip has variables with lists of equal length")
        columns = {}
        for name, spec in item.items():
            if isinstance(spec, list):  # values of a column may repeat
                wrong = [y for y in spec if not (isinstance(y, str | bool) or is_number(y))]
                if wrong:
                    raise CaseError(f"{name}: got {wrong[0]!r} in the list; values are finite numbers or text")
                columns[name] = [plain(y) for y in spec]
            else:
                values = levels(spec)
                if isinstance(values, Expression):
                    raise CaseError(f"{name}: an expression belongs to variables")
                columns[name] = values
        lengths = {name: len(values) for name, values in columns.items()}
        if len(set(lengths.values())) > 1 or not min(lengths.values()):
            said = ", ".join(f"{name} has {n}" for name, n in lengths.items())
            raise CaseError(f"columns that walk together must be equally long: {said}")
        return _Axis(tuple(columns), list(zip(*columns.values())))

    def _spec(self, kind: str, item: Any, known: Sequence[str]) -> dict[str, Any]:
        spec = {"file": item} if isinstance(item, str) else item
        if not isinstance(spec, dict) or not isinstance(spec.get("file"), str):
            raise CaseError(f"got {item!r}; a {kind} has the key file and may have {', '.join(known[1:])}")
        wrong = [name for name in spec if name not in known]
        if wrong:
            raise CaseError([f"there is no '{name}'{nearest(name, known)}" for name in wrong])
        return spec

    def _table(self, item: Any) -> _Axis:
        spec = self._spec("table", item, ("file", "columns", "row", "where"))
        names = spec.get("columns")
        if names is not None and not (isinstance(names, dict) and names
                                      and all(isinstance(name, str) for name in names.values())):  # fmt: skip
            raise CaseError(f"columns: got {names!r}; our name: name in the file, or leave it out for all")
        columns = read_columns(self._reader._base / spec["file"], names)
        if "row" in spec:
            columns[str(spec["row"])] = [k + 1 for k in range(len(next(iter(columns.values()))))]
        rows = list(zip(*columns.values()))
        if "where" in spec:
            condition = parse(str(spec["where"]))
            unknown = strangers(condition, columns)
            if unknown:
                raise CaseError([f"where: {line}" for line in unknown])
            rows = [row for row in rows if condition(dict(zip(columns, row)))]
            if not rows:
                raise CaseError(f"where: no row of '{spec['file']}' has {condition.text}")
        return _Axis(tuple(columns), rows)

    def _scatter(self, item: Any) -> _Axis:
        spec = self._spec("scatter", item, ("file", "names"))
        names = spec.get("names", ["hs", "tp", "occurrence"])
        if not isinstance(names, list) or len(names) != 3 or not all(isinstance(name, str) for name in names):
            raise CaseError(f"names: got {names!r}; three names, of height, period and occurrence")
        return _Axis(tuple(names), list(read_scatter(self._reader._base / spec["file"])), told=2)

    def _arrange(self) -> None:
        """Order of the expressions. What refers to nothing, or in a circle, is a problem."""
        for name, expression in self._expressions.items():
            for sentence in strangers(expression, self.variables):
                self._reader.problem(self._at[name], sentence)
        try:
            order = in_order(self._expressions)
        except CaseError as error:
            self._reader.problem(("variables",), error)
            order = []
        self._order = [(name, self._expressions[name], sorted(self._expressions[name].names)) for name in order]

    def _sections(self) -> None:
        data, reader, known = self._data, self._reader, self.variables
        model = data.get("model")
        self._model = ""
        if not isinstance(model, str):
            reader.problem(self._keys.get("model", self.key), "model: the path of a model script is missing")
        else:
            self._model = str((reader._base / model).resolve())
            if not Path(self._model).is_file():
                reader.problem(self._keys.get("model", ("model",)), f"there is no model script '{self._model}'")

        def template(name: str) -> _Template:
            def problem(key: Key, said: Any) -> None:
                own = self._keys.get(f"{name}.{key[1]}") if len(key) > 1 else None
                place = (*own, *key[2:]) if own else (*self._keys[name], *key[1:]) if name in self._keys else key
                reader.problem(place, said)

            return _Template(data.get(name) or {}, (name,), known, reader._base, problem)

        self._parameters, self._run = template("parameters"), template("run")
        self._environment = {name: template(name) for name in SECTIONS if data.get(name) is not None}
        for section, allowed in {**KEYS, "run": tuple(_Run.model_fields)}.items():
            for name in data.get(section) or {}:
                if name not in allowed:
                    own = self._keys.get(f"{section}.{name}", (*self._keys.get(section, (section,)), name))
                    reader.problem(own, f"{section}: there is no '{name}'{nearest(name, allowed)}")
        if "duration" not in (data.get("run") or {}):
            reader.problem(self._keys.get("run", ("run",)), "run: 'duration' is missing, seconds after the ramp")

    def cases(self, first: int, short: Mapping[str, str]) -> Iterator[Case]:
        """The block's cases, the first axis slowest."""
        names = [name for axis in self.axes for name in axis.names]
        known: dict[tuple[str, tuple[Value, ...]], Value] = {}
        settings: dict[int, RunSettings | None] = {}
        seen: set[str] = set()
        if np.prod([float(len(axis.rows)) for axis in self.axes]) > MOST:
            self._reader.problem(self.key, f"more than {MOST} cases")
            return
        for number, rows in enumerate(product(*(axis.rows for axis in self.axes)), first):
            values: dict[str, Value] = dict(zip(names, (y for row in rows for y in row)))
            try:
                for name, expression, needs in self._order:
                    at = name, tuple(values[need] for need in needs)
                    if at not in known:
                        known[at] = self._value(name, expression, values)
                    values[name] = known[at]
                parameters = self._relative(self._parameters(values))
                run = self._settings(self._run(values), settings)
                environment = {name: section(values) for name, section in self._environment.items()}
            except CaseError as error:
                self._reader.problem(self.key, error)
                if len(self._reader._problems) > 50:
                    return
                continue
            if run is None:
                continue
            self._describe(environment, run.total, seen)
            source = self._reader.source(self._model, parameters, self._keys.get("model", ("model",)))
            ordered = {name: values[name] for name in self.variables}
            slug = _slug({short[name]: ordered[name] for name in ordered if name in short}) or "case"
            yield Case(number, slug, ordered, self._model, parameters, environment, run, source)

    def _value(self, name: str, expression: Expression, values: Mapping[str, Value]) -> Value:
        try:
            return expression(values)
        except CaseError as error:
            raise CaseError([f"{dotted(('variables', name))}: {line}" for line in error.problems]) from None

    def _relative(self, parameters: Any) -> Any:
        """Files as seen from the script: a case means the same wherever the folders lie."""
        folder = Path(self._model).parent

        def seen(item: Any) -> Any:
            if isinstance(item, Path):
                return Path(os.path.relpath(item.resolve(), folder)).as_posix()
            if isinstance(item, dict):
                return {name: seen(value) for name, value in item.items()}
            return [seen(value) for value in item] if isinstance(item, list) else item

        return seen(parameters)

    def _settings(self, values: Any, known: dict[int, RunSettings | None]) -> RunSettings | None:
        at = id(values)  # the template gives the same object for the same values
        if at not in known:
            try:
                known[at] = RunSettings(**dict(_Run(**values)))
            except ModelError as error:
                known[at] = None
                self._problems_of("run", error)
        return known[at]

    def _describe(self, environment: Mapping[str, Any], total: float, seen: set[str]) -> None:
        """Values of waves and current that cannot be are found here; of wind where the model is built."""
        for name, values in environment.items():
            if name == "wind" or (sort := f"{name} {total} {seedless(values)}") in seen:
                continue
            seen.add(sort)
            try:
                if name == "waves":
                    waves_of(values, total)
                else:
                    current_of(values)
            except (CaseError, ModelError) as error:
                self._problems_of(name, error)

    def _problems_of(self, section: str, error: CaseError | ModelError) -> None:
        for line in error.problems:
            key = next((name for name in self._data[section] if re.search(rf"\b{re.escape(name)}\b", line)), None)
            place = self._keys.get(section, (section,))
            own = self._keys.get(f"{section}.{key}", (*place, key) if key else place)
            self._reader.problem(own, line)


def seedless(item: Any) -> Any:
    """Values without their seeds."""
    if isinstance(item, Mapping):
        return {name: seedless(value) for name, value in item.items() if name != "seed"}
    return [seedless(value) for value in item] if isinstance(item, list | tuple) else item


# -- readable names of cases -----------------------------------------------------------------------


def _abbreviations(names: Sequence[str]) -> dict[str, str]:
    """wind_heading_deg -> wh, while they differ: short names keep their own."""
    short = {}
    for name in names:
        words = [word for word in name.split("_") if word != "deg"] or [name]
        short[name] = words[0] if len(words) == 1 and len(words[0]) <= 5 else "".join(word[0] for word in words)
    taken = list(short.values())
    return {name: own if taken.count(own) == 1 else name.removesuffix("_deg") for name, own in short.items()}


def _slug(values: Mapping[str, Value]) -> str:
    """hs3p2_tp10_seed1: fit for a file's name on any system."""
    parts = [name + (f"{y:.6g}" if is_number(y) else str(y)) for name, y in values.items()]
    text = re.sub(r"[^A-Za-z0-9_-]+", "", "_".join(parts).replace(".", "p").replace("+", ""))
    return text[:_SLUG].rstrip("_-")
