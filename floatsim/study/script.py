"""Model scripts: Python files with a `build(**parameters) -> Model`. Whatever is wrong with one is said in a line."""

from __future__ import annotations

import ast
import fnmatch
import glob
import hashlib
import importlib.util
import inspect
import json
import sys
import sysconfig
import traceback
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from floatsim.errors import CaseError, FloatsimError, ModelError, nearest
from floatsim.model import Model
from floatsim.sea.site import Sea
from floatsim.sea.spectra import Jonswap
from floatsim.sea.waves import IrregularWaves, RegularWave, wave_files

_PREFIX = "floatsim_model_"  # of the module names of scripts
_SCRIPT = "_script"
WAVES = "--waves"  # no parameter of a build() can be named like this
DECK = ("depth", "name")  # parameters of a MoorDyn file


def parse_parameters(pairs: Sequence[str]) -> dict[str, Any]:
    """`name=value` strings -> values: numbers, True, False, None, tuples; anything else stays text."""
    out: dict[str, Any] = {}
    problems = []
    for pair in pairs:
        name, equals, text = pair.partition("=")
        if not equals or not name.isidentifier():
            problems.append(f"-p {pair}: write name=value, e.g. -p depth=200")
            continue
        if name in out:
            problems.append(f"-p {name} is given twice")
        out[name] = _value({"true": "True", "false": "False", "none": "None"}.get(text, text))
    if problems:
        raise CaseError(problems)
    return out


def _value(text: str) -> Any:
    try:
        with warnings.catch_warnings():  # of text that only looks like Python, such as C:\\data
            warnings.simplefilter("ignore")
            return ast.literal_eval(text)
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        return text


class Script:
    """A model script that has been read: call it with the parameters of its build().

    takes: names of build's parameters. needs: those without a default. Raises ModelError, naming script and line, if
    the file is missing, raises or has no build. A MoorDyn file takes depth and name.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = path
        self._file = file = Path(path)
        self._build: Any = None
        self.takes: tuple[str, ...] = DECK
        self.needs: tuple[str, ...] = ()
        if not file.is_file():
            raise ModelError(f"model script '{path}': there is no such file")
        if file.suffix.lower() in (".txt", ".dat"):
            return
        if file.suffix != ".py":
            raise ModelError(
                f"model script '{path}': a Python file (.py) with a build(), or a MoorDyn file, is needed"
            )
        spec = importlib.util.spec_from_file_location(_PREFIX + file.stem, file)
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        with self._neighbours():
            _guarded(file, spec.loader.exec_module, module)
        self._build = getattr(module, "build", None)
        if not callable(self._build):
            raise ModelError(f"model script '{path}' has no function build(**parameters) that returns a floatsim.Model")
        known = _named(self._build)
        self.takes = tuple(known)
        self.needs = tuple(name for name, p in known.items() if p.default is p.empty)

    def __call__(self, parameters: dict[str, Any]) -> Model:
        """The model. Raises ModelError if build raises, gives no Model or does not take a parameter."""
        if self._build is None:
            return load_deck(self._file, parameters).model
        _check_names(self.path, self._build, parameters)
        with self._neighbours():
            model = _guarded(self._file, self._build, **parameters)
        if not isinstance(model, Model):
            raise ModelError(
                f"model script '{self.path}': build() returned {type(model).__name__}, a floatsim.Model is needed"
            )
        return model

    @contextmanager
    def _neighbours(self) -> Iterator[None]:
        """Scripts may import their neighbours."""
        folder = str(self._file.parent.resolve())
        sys.path.insert(0, folder)
        try:
            yield
        finally:
            sys.path.remove(folder)


def load_model(path: str | Path, parameters: dict[str, Any] | None = None) -> Model:
    """Run the script's `build` with `parameters`.

    A parameter named WAVES holds values for `waves_of`, which then replace the model's own waves.

    Raises ModelError, naming script and line, if the file is missing, raises, has no build, gives no Model, or if
    build does not take a parameter (with the nearest it does).
    """
    given = dict(parameters or {})
    waves = given.pop(WAVES, None)
    model = Script(path)(given)
    if waves is not None:
        model = Model(**{**dict(model), "sea": Sea(**{**dict(model.sea), "waves": waves_of(**waves)})})
    # a frozen description; copies do not take it on
    model.__dict__[_SCRIPT] = (str(Path(path).resolve()), dict(parameters or {}))
    return model


def waves_of(
    duration: float, hs: float | None = None, tp: float | None = None, height: float | None = None,
    period: float | None = None, heading: float = 0.0, seed: int = 1,
) -> Any:  # fmt: skip
    """The waves that options of the command line describe, None without any: a JONSWAP sea of hs [m], tp [s] and seed
    for `duration` [s], or a regular wave of height [m] and period [s], towards heading [deg].

    Raises CaseError for halves of a description, and for both.
    """
    for (a, x), (b, y) in ((("--hs", hs), ("--tp", tp)), (("--height", height), ("--period", period))):
        if (x is None) != (y is None):
            there, lacks = (a, b) if y is None else (b, a)
            raise CaseError(f"{there} is given without {lacks}: waves need both")
    if hs is not None and height is not None:
        raise CaseError("--hs and --tp are a sea, --height and --period one regular wave: give one of them")
    if hs is not None and tp is not None:
        return IrregularWaves(spectrum=Jonswap(hs=hs, tp=tp), seed=seed, heading_deg=heading,
                              duration=max(3600.0, duration))  # fmt: skip
    if height is not None and period is not None:
        return RegularWave(height=height, period=period, heading_deg=heading)
    return None


def script_of(model: Model) -> tuple[str, dict[str, Any]] | None:
    """(path, parameters) that made a model, if load_model did."""
    return model.__dict__.get(_SCRIPT)


def load_deck(path: str | Path, parameters: dict[str, Any] | None = None) -> Any:
    """A MoorDyn file; of `parameters` it takes depth and name. Raises ModelError."""
    from floatsim.study.moordyn import read_moordyn

    wrong = [name for name in parameters or {} if name not in DECK]
    if wrong:
        raise ModelError([f"MoorDyn file '{path}' takes no '{n}'{nearest(n, DECK)}" for n in wrong])
    return read_moordyn(path, **(parameters or {}))


def _named(build: Any) -> dict[str, inspect.Parameter]:
    """Parameters of a build that have names."""
    try:
        takes = inspect.signature(build).parameters.values()
    except (TypeError, ValueError):  # something built in: it will speak for itself
        return {}
    return {p.name: p for p in takes if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)}


def _check_names(path: str | Path, build: Any, parameters: dict[str, Any]) -> None:
    try:
        takes = inspect.signature(build).parameters.values()
    except (TypeError, ValueError):
        return
    known = _named(build)
    if not any(p.kind is p.VAR_KEYWORD for p in takes):
        wrong = [name for name in parameters if name not in known]
        if wrong:
            raise ModelError([f"model script '{path}': build() takes no '{n}'{nearest(n, known)}" for n in wrong])
    missing = [n for n, p in known.items() if p.default is p.empty and n not in parameters]
    if missing:
        raise ModelError(f"model script '{path}': build() needs {' '.join(f'-p {n}=...' for n in missing)}")


def _guarded(file: Path, function: Any, *args: Any, **kwargs: Any) -> Any:
    """Call user code; its own errors become one line with the script's line number."""
    try:
        return function(*args, **kwargs)
    except FloatsimError:
        raise
    except (Exception, SystemExit) as error:
        own = file.resolve()
        lines = [f.lineno for f in traceback.extract_tb(error.__traceback__) if Path(f.filename).resolve() == own]
        if isinstance(error, SyntaxError) and error.lineno and Path(error.filename or file).resolve() == own:
            lines = [error.lineno]
        where = (f", line {lines[-1]}" if lines else "") + (f", with {_listed(kwargs)}" if kwargs else "")
        said = " ".join(str(error).split())  # some errors of other packages have many lines
        said = f"{type(error).__name__}: {said}" if said else type(error).__name__
        raise ModelError(f"model script '{file}'{where}: {said}") from None


def blamed(error: BaseException) -> str | None:
    """`model script 'x.py', line 3: ...` if an error arose in code of a model script that was called later, such as
    a spectrum of the user's own; else None."""
    frames = [(frame, line) for frame, line in traceback.walk_tb(error.__traceback__)
              if str(frame.f_globals.get("__name__")).startswith(_PREFIX)]  # fmt: skip
    if not frames:
        return None
    frame, line = frames[-1]
    said = " ".join(str(error).split())
    return f"model script '{Path(frame.f_code.co_filename).name}', line {line}: {type(error).__name__}: {said}"


def _listed(parameters: dict[str, Any]) -> str:
    """Plain values as they are, objects such as a sea by what they are: their many values would hide the message."""
    plain = (int, float, str, tuple, list, type(None))
    return ", ".join(f"{name}={value!r}" if isinstance(value, plain) else f"{name}={type(value).__name__}(...)"
                     for name, value in parameters.items())  # fmt: skip


def script_files(path: str | Path) -> list[Path]:
    """The script and what it needs: files that it imports, directly or through others, from its folder or from other
    places that hold no installed packages, and files whose names stand in them as text, such as a table that is read.
    """
    script = Path(path).resolve()
    found: set[Path] = set()
    waiting = {script}
    while waiting:
        file = waiting.pop()
        found.add(file)
        if file.suffix == ".py":
            waiting |= set().union(*(_needed_by(file, folder) for folder in {script.parent, file.parent})) - found
    return [script, *sorted(found - {script})]


def _needed_by(file: Path, folder: Path) -> set[Path]:
    """Files that a Python file imports from `folder`, in functions too (of a package all), or names as seen from it."""
    imported, named, patterns = set(), set(), list[str]()
    for node in ast.walk(ast.parse(file.read_bytes())):
        if isinstance(node, ast.Import):
            imported |= {item.name.partition(".")[0] for item in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            imported.add(node.module.partition(".")[0])
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            named.add(node.value)
        elif isinstance(node, ast.JoinedStr):  # f"table_{depth:g}.csv": all that it may become
            parts = [glob.escape(str(y.value)) if isinstance(y, ast.Constant) else "*" for y in node.values]
            if parts[0] != "*" and Path(f"x{parts[-1]}").suffix:
                patterns.append("".join(parts))
    own = list(folder.iterdir())
    there = {item.name: item for item in own if item.is_file()}
    names = named | {f"{name}.py" for name in imported}
    out = {there[name] for name in names if name in there}
    out |= {item for name, item in there.items() if any(fnmatch.fnmatch(name, pattern) for pattern in patterns)}
    paths = {name for name in named if "/" in name and "\0" not in name and len(name) < 256}
    paths |= {f"{item.name}/{name}" for item in own if item.name in named and item.is_dir()  # folder / "data" / "x.csv"
              for name in named if "/" not in name and Path(name).suffix}  # fmt: skip
    out |= {(folder / name).resolve() for name in paths if (folder / name).is_file()}
    out |= {found for name in imported if name not in sys.stdlib_module_names and (found := _elsewhere(name))}
    return out.union(*((folder / name).rglob("*.py") for name in imported))


def _elsewhere(name: str) -> Path | None:
    """The file of a module that is not part of an installed package, wherever the script found it."""
    try:
        spec = importlib.util.find_spec(name)
    except (ImportError, ValueError, AttributeError):
        return None
    if spec is None or not str(spec.origin).endswith(".py"):
        return None
    file = Path(str(spec.origin)).resolve()
    installed = [Path(p).resolve() for p in sysconfig.get_paths().values()] + [Path(__file__).resolve().parents[1]]
    return None if any(file.is_relative_to(place) for place in installed) else file


def data_files(model: Model) -> list[Path]:
    """Files that a model was read from: hydrodynamic databases, measured waves."""
    loads = (load for part in model.parts for load in getattr(part, "water_loads", ()))
    return [Path(file) for load in loads for file in load.files()] + [Path(f) for f in wave_files(model.sea.waves)]


def content_hash(files: Sequence[Path], *more: Any) -> str:
    """SHA-256 of what is in the files (of a folder: in all of its files) and of plain data."""
    digest = hashlib.sha256()
    for file in files:
        for one in sorted(f for f in file.rglob("*") if f.is_file()) if file.is_dir() else [file]:
            content = one.read_bytes()
            digest.update(b"%d:" % len(content) + content)  # where one ends and the next begins
    for item in more:
        digest.update(json.dumps(item, sort_keys=True, default=str).encode())
    return digest.hexdigest()


def input_hash(path: str | Path, parameters: dict[str, Any], case: dict[str, Any], model: Model) -> str:
    """SHA-256 of everything a run was made from: script and the neighbours it imports, parameters, case, databases."""
    return content_hash([*script_files(path), *data_files(model)], [parameters, case])
