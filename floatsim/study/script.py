"""Model scripts: Python files with a `build(**parameters) -> Model`. Whatever is wrong with one is said in a line."""

from __future__ import annotations

import ast
import hashlib
import importlib.util
import inspect
import json
import sys
import traceback
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from floatsim.errors import CaseError, FloatsimError, ModelError, nearest
from floatsim.model import Model
from floatsim.sea.waves import wave_files

_PREFIX = "floatsim_model_"  # of the module names of scripts


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


def load_model(path: str | Path, parameters: dict[str, Any] | None = None) -> Model:
    """Run the script's `build` with `parameters`.

    Raises ModelError, naming script and line, if the file is missing, raises, has no build, gives no Model, or if
    build does not take a parameter (with the nearest it does).
    """
    file = Path(path)
    parameters = parameters or {}
    if not file.is_file():
        raise ModelError(f"model script '{path}': there is no such file")
    if file.suffix.lower() in (".txt", ".dat"):
        return load_deck(file, parameters).model
    if file.suffix != ".py":
        raise ModelError(f"model script '{path}': a Python file (.py) with a build(), or a MoorDyn file, is needed")
    spec = importlib.util.spec_from_file_location(_PREFIX + file.stem, file)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.path.insert(0, str(file.parent.resolve()))  # scripts may import their neighbours
    try:
        _guarded(file, spec.loader.exec_module, module)
        build = getattr(module, "build", None)
        if not callable(build):
            raise ModelError(f"model script '{path}' has no function build(**parameters) that returns a floatsim.Model")
        _check_names(path, build, parameters)
        model = _guarded(file, build, **parameters)
    finally:
        sys.path.remove(str(file.parent.resolve()))
    if not isinstance(model, Model):
        raise ModelError(f"model script '{path}': build() returned {type(model).__name__}, a floatsim.Model is needed")
    return model


def load_deck(path: str | Path, parameters: dict[str, Any] | None = None) -> Any:
    """A MoorDyn file; of `parameters` it takes depth and name. Raises ModelError."""
    from floatsim.study.moordyn import read_moordyn

    known = ["depth", "name"]
    wrong = [name for name in parameters or {} if name not in known]
    if wrong:
        raise ModelError([f"MoorDyn file '{path}' takes no '{n}'{nearest(n, known)}" for n in wrong])
    return read_moordyn(path, **(parameters or {}))


def _check_names(path: str | Path, build: Any, parameters: dict[str, Any]) -> None:
    try:
        takes = inspect.signature(build).parameters.values()
    except (TypeError, ValueError):  # something built in: it will speak for itself
        return
    known = {p.name: p for p in takes if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)}
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
    return ", ".join(f"{name}={value!r}" for name, value in parameters.items())


def input_hash(path: str | Path, parameters: dict[str, Any], case: dict[str, Any], model: Model) -> str:
    """SHA-256 of everything a run was made from: script and the neighbours it imports, parameters, case, databases."""
    digest = hashlib.sha256(Path(path).read_bytes())
    folder = Path(path).resolve().parent
    files = {str(getattr(module, "__file__", None) or "") for module in list(sys.modules.values())}
    for file in sorted(f for f in files if f.endswith(".py") and Path(f).resolve().parent == folder):
        if Path(file).resolve() != Path(path).resolve():
            digest.update(Path(file).read_bytes())
    digest.update(json.dumps([parameters, case], sort_keys=True, default=str).encode())
    for part in model.parts:
        for load in getattr(part, "water_loads", ()):
            for file in load.files():
                digest.update(Path(file).read_bytes())
    for file in wave_files(model.sea.waves):
        digest.update(Path(file).read_bytes())
    return digest.hexdigest()
