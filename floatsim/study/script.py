"""Model scripts: Python files with a `build(**parameters) -> Model`. Whatever is wrong with one is said in a line."""

from __future__ import annotations

import ast
import hashlib
import importlib.util
import inspect
import json
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from floatsim.errors import CaseError, FloatsimError, ModelError, nearest
from floatsim.model import Model


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
        try:
            out[name] = ast.literal_eval({"true": "True", "false": "False", "none": "None"}.get(text, text))
        except (ValueError, SyntaxError):
            out[name] = text
    if problems:
        raise CaseError(problems)
    return out


def load_model(path: str | Path, parameters: dict[str, Any] | None = None) -> Model:
    """Run the script's `build` with `parameters`.

    Raises ModelError, naming script and line, if the file is missing, raises, has no build, gives no Model, or if
    build does not take a parameter (with the nearest it does).
    """
    file = Path(path)
    parameters = parameters or {}
    if not file.is_file():
        raise ModelError(f"model script '{path}': there is no such file")
    if file.suffix != ".py":
        raise ModelError(f"model script '{path}': a Python file (.py) with a build() is needed")
    spec = importlib.util.spec_from_file_location(f"floatsim_model_{file.stem}", file)
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


def _check_names(path: str | Path, build: Any, parameters: dict[str, Any]) -> None:
    known = inspect.signature(build).parameters
    if any(p.kind is p.VAR_KEYWORD for p in known.values()):
        return
    wrong = [name for name in parameters if name not in known]
    if wrong:
        raise ModelError([f"model script '{path}': build() takes no '{name}'{nearest(name, known)}" for name in wrong])
    missing = [n for n, p in known.items() if p.default is p.empty and p.kind is not p.VAR_POSITIONAL]
    missing = [n for n in missing if n not in parameters]
    if missing:
        raise ModelError(f"model script '{path}': build() needs -p {missing[0]}=...")


def _guarded(file: Path, function: Any, *args: Any, **kwargs: Any) -> Any:
    """Call user code; its own errors become one line with the script's line number."""
    try:
        return function(*args, **kwargs)
    except FloatsimError:
        raise
    except (Exception, SystemExit) as error:
        lines = [f.lineno for f in traceback.extract_tb(error.__traceback__) if Path(f.filename) == file]
        if isinstance(error, SyntaxError) and error.lineno:
            lines = [error.lineno]
        where = f", line {lines[-1]}" if lines else ""
        raise ModelError(f"model script '{file}'{where}: {type(error).__name__}: {error}") from None


def input_hash(path: str | Path, parameters: dict[str, Any], case: dict[str, Any]) -> str:
    """Hash of everything a run was made from: script, parameters, case."""
    digest = hashlib.sha256(Path(path).read_bytes())
    digest.update(json.dumps([parameters, case], sort_keys=True, default=str).encode())
    return digest.hexdigest()
