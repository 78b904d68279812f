"""Checkpoints: all that a run needs to go on, in one file that is whole at any moment.

The file is a NumPy archive (.npz): one array for every array of the run's memory, and a text `header` in JSON with the
version, the identity of the model, the settings and the structure the arrays stand in. There is no pickle in it:
reading it runs no code, and it holds no classes whose insides another version could have changed. The objects that
remember (batches' histories, the energy ledger, statistics) are made afresh from the model and get their numbers back;
floating point numbers pass through JSON and NumPy bit by bit.

What is kept:

- `State`: positions, velocities, accelerations, the integrator's auxiliary acceleration, multipliers, step size, pace,
  and all histories: radiation memory, slow positions, stick points of friction, memories of ropes, broken lines, locks,
  states of PTOs and of users' laws, largest tensions, turns already made;
- the Newton solver: what it learned of its convergence, the scale of the constraint rows;
- the run: place among steps and outputs, cuts in progress, counters, wall time, ledger, statistics; without an output
  file the samples so far.

Waves need no random state: phases are numbers of the seed, made again with the model. Not kept: what a user's own
Python function keeps outside its `states`.

A new file is written beside the old one under a temporary name, brought to the disk and renamed: whenever the process
or the machine stops, the old or the new one is there, whole.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import hashlib
import io
import json
import os
import types
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel

from floatsim.errors import CaseError
from floatsim.model import Model
from floatsim.version import __version__

FORMAT = 1  # of the file; a change of what stands where raises it
_ARRAY, _SCALAR, _LIST, _TUPLE, _DICT, _OBJECT, _RANDOM = "array", "scalar", "list", "tuple", "dict", "object", "random"
Arrays = list[NDArray[Any]]


# -- what an object remembers, as a tree of numbers -----------------------------------------------


def pack(value: Any, arrays: Arrays) -> Any:
    """A tree for JSON; arrays go to the list `arrays` and stand in the tree by their number.

    Objects give what `arrays()` returns if they have `arrays` and `restore`, else their attributes. Raises TypeError
    for what holds no numbers (functions, open files).
    """
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, np.ndarray | np.generic):
        if value.dtype.kind not in "biufcSU":
            raise TypeError(f"an array of type {value.dtype} cannot be kept")
        arrays.append(np.ascontiguousarray(value) if isinstance(value, np.ndarray) and value.ndim else np.array(value))
        return {_ARRAY if isinstance(value, np.ndarray) else _SCALAR: len(arrays) - 1}
    if isinstance(value, list | tuple) and not hasattr(value, "_fields"):
        return {_LIST if isinstance(value, list) else _TUPLE: [pack(item, arrays) for item in value]}
    if isinstance(value, dict):
        return {_DICT: [[pack(key, arrays), pack(item, arrays)] for key, item in value.items()]}
    if isinstance(value, np.random.Generator):
        return {_RANDOM: pack(value.bit_generator.state, arrays)}
    if callable(value) or not (_restorable(value) or hasattr(value, "__dict__")):
        raise TypeError(f"{value!r:.80} cannot be kept")
    own = value.arrays() if _restorable(value) else _attributes(value)
    if not own:  # an object of another language, such as an open file, hides what it knows
        raise TypeError(f"{value!r:.80} has no attributes that could be kept")
    return {_OBJECT: _class_of(value), "holds": pack(own, arrays)}


def unpack(tree: Any, arrays: Arrays, like: Any, where: str = "") -> Any:
    """The value of a tree. `like`: one of the same shape made afresh, whose objects take the numbers over.

    Raises ValueError, saying where, if the two do not fit.
    """
    if not isinstance(tree, dict):
        if isinstance(like, np.ndarray | list | tuple | dict):
            raise ValueError(f"{where} is {tree!r}, here it is a {type(like).__name__}")
        return tree
    kind = next(iter(tree))
    held = tree[kind]
    if kind == _ARRAY:
        value = arrays[held]
        if isinstance(like, np.ndarray) and like.shape != value.shape:
            raise ValueError(f"{where} has shape {value.shape}, here it has {like.shape}")
        return value
    if kind == _SCALAR:
        return arrays[held][()]
    if kind in (_LIST, _TUPLE):
        beside = like if isinstance(like, list | tuple) and len(like) == len(held) else [None] * len(held)
        items = [unpack(item, arrays, y, f"{where}[{k}]") for k, (item, y) in enumerate(zip(held, beside))]
        return items if kind == _LIST else tuple(items)
    if kind == _DICT:
        same = like if isinstance(like, dict) else {}
        keys = [unpack(key, arrays, None, where) for key, _ in held]
        items = [unpack(item, arrays, same.get(key), f"{where}[{key!r}]") for key, (_, item) in zip(keys, held)]
        return dict(zip(keys, items))
    if kind == _RANDOM:
        if not isinstance(like, np.random.Generator):
            raise ValueError(f"{where} is a random generator, here it is {type(like).__name__}")
        like.bit_generator.state = unpack(held, arrays, None, where)
        return like
    if held != _class_of(like):
        raise ValueError(f"{where} is a {held}, here it is a {_class_of(like)}")
    if _restorable(like):
        like.restore(unpack(tree["holds"], arrays, None, where))
        return like
    own = _attributes(like)
    numbers = unpack(tree["holds"], arrays, own, where)
    if numbers.keys() != own.keys():
        raise ValueError(f"{where} has {', '.join(numbers)}, here it has {', '.join(own)}")
    for name, number in numbers.items():
        object.__setattr__(like, name, number)
    return like


def _restorable(value: Any) -> bool:
    return hasattr(value, "arrays") and hasattr(value, "restore")


def _attributes(value: Any) -> dict[str, Any]:
    if dataclasses.is_dataclass(value):
        return {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
    return dict(vars(value))


def _class_of(value: Any) -> str:
    return f"{type(value).__module__}.{type(value).__qualname__}"


# -- the identity of a model ----------------------------------------------------------------------


def identity(model: Model) -> dict[str, str]:
    """What a model is made of: name -> hash, of every part and joint, of the sea and the rest. The same description
    gives the same hashes in every process; numbers, arrays, and the code of users' functions count."""
    whole = [name for name in type(model).model_fields if name not in ("parts", "joints", "expected")]
    out = {name: _hash(getattr(model, name)) for name in whole}
    out |= {f"part '{part.name}'": _hash(part) for part in model.parts}
    out |= {f"joint '{joint.label}'": _hash(joint) for joint in model.joints}
    return out | {"the order of parts and joints": _hash(tuple(out))}


def differences(old: Mapping[str, str], new: Mapping[str, str]) -> list[str]:
    """Names of what is not the same in two identities."""
    named = [f"{name} is missing" for name in old if name not in new]
    named += [f"{name} is new" for name in new if name not in old]
    changed = [f"{name} differs" for name in old if name in new and old[name] != new[name]]
    if len(named) + len(changed) > 1:  # the order differs wherever a name does
        changed = [text for text in changed if not text.startswith("the order")]
    return named + changed


def _hash(value: Any) -> str:
    digest = hashlib.sha256()
    _feed(digest.update, value, [])
    return digest.hexdigest()[:16]


def _feed(update: Callable[[bytes], None], value: Any, above: list[int]) -> None:
    """Give a value's content to a digest."""
    if isinstance(value, np.ndarray) and value.dtype.kind != "O":
        update(f"{value.dtype}{value.shape}".encode())
        update(np.ascontiguousarray(value).tobytes())
        return
    if isinstance(value, Path):
        update(value.name.encode())
        update(value.read_bytes() if value.is_file() else b"")
        return
    if value is None or isinstance(value, bool | int | float | complex | str | bytes | np.generic):
        update(f"{type(value).__name__}:{value!r};".encode())
        return
    if id(value) in above or isinstance(value, type | types.ModuleType | types.BuiltinFunctionType | np.ufunc):
        update(f"{getattr(value, '__qualname__', getattr(value, '__name__', ''))};".encode())
        return
    update(f"<{type(value).__qualname__}".encode())
    for item in _content(value):
        _feed(update, item, [*above, id(value)])
    update(b">")


def _content(value: Any) -> list[Any]:
    """What a value consists of."""
    if hasattr(value, "identity"):
        return [value.identity()]
    if isinstance(value, BaseModel):
        return [(name, getattr(value, name)) for name in type(value).model_fields]
    if isinstance(value, dict):
        return list(value.items())
    if isinstance(value, list | tuple | np.ndarray):
        return list(value)
    if isinstance(value, set | frozenset):
        return sorted(value, key=repr)
    if isinstance(value, functools.partial):
        return [value.func, value.args, value.keywords]
    if isinstance(value, types.MethodType):
        return [value.__func__, value.__self__]
    if isinstance(value, types.FunctionType):
        cells = []
        for cell in value.__closure__ or ():
            with contextlib.suppress(ValueError):  # a name not bound yet
                cells.append(cell.cell_contents)
        # numbers and text of the module that it reads: what else stands there is too much to follow
        read = [value.__globals__.get(name) for name in value.__code__.co_names]
        plain = [y for y in read if isinstance(y, bool | int | float | str | tuple)]
        return [value.__qualname__, value.__code__, value.__defaults__, value.__kwdefaults__, cells, plain]
    if isinstance(value, types.CodeType):
        return [value.co_code, value.co_names, value.co_consts]
    if hasattr(value, "py_func"):  # compiled by numba
        return [value.py_func]
    if dataclasses.is_dataclass(value):
        return list(_attributes(value).items())
    return sorted(vars(value).items()) if hasattr(value, "__dict__") else []


# -- the file -------------------------------------------------------------------------------------


@dataclasses.dataclass
class Saved:
    """The content of a checkpoint: header (see `write`), tree of what is remembered, its arrays."""

    path: Path
    header: dict[str, Any]
    tree: dict[str, Any]
    arrays: Arrays

    def take(self, name: str, like: Any) -> Any:
        """The memory `name`, in an object `like` it. Raises CaseError if they do not fit."""
        try:
            if name not in self.tree:
                raise ValueError(f"there is no '{name}' in it")
            return unpack(self.tree[name], self.arrays, like, name)
        except (ValueError, KeyError, IndexError) as error:
            raise CaseError(f"checkpoint '{self.path}' does not fit the run that would go on: {error}") from None


def check_path(path: Any, output: Any = None) -> Path:
    """The path of a checkpoint to be written. Raises CaseError if it cannot be, or is somebody else's file."""
    if not isinstance(path, str | Path) or not str(path).strip() or "\0" in str(path):
        raise CaseError(f"checkpoint: got {path!r}; must be the path of the file to write")
    path = Path(path)
    try:
        if not path.parent.is_dir():
            raise CaseError(f"checkpoint '{path}': there is no folder '{path.parent}'; make it or choose another place")
        if path.is_dir():
            raise CaseError(f"checkpoint '{path}' is a folder; give a file name")
        if output is not None and path.resolve() == Path(output).resolve():
            raise CaseError(f"checkpoint '{path}' is the output file too; give it a name of its own")
        if not os.access(path.parent, os.W_OK):
            raise CaseError(f"checkpoint '{path}' cannot be written: no permission; choose another place")
        if path.exists() and path.stat().st_size and not _is_one(path):
            raise CaseError(f"checkpoint '{path}' exists and is no checkpoint; choose another name")
    except OSError as error:  # a name that is too long
        raise CaseError(f"checkpoint '{path}' cannot be written: {error.strerror}; choose another name") from None
    return path


def _is_one(path: Path) -> bool:
    try:
        with zipfile.ZipFile(path) as file:
            return "header.npy" in file.namelist()
    except (zipfile.BadZipFile, OSError):
        return False


def write(path: Path, header: Mapping[str, Any], memory: Mapping[str, Any]) -> None:
    """Write `memory` (name -> object, see `pack`) and a header for JSON to the file, all or nothing.

    Raises OSError if there is no room, CaseError for what cannot be kept; the old file is still there then.
    """
    arrays: Arrays = []
    tree = {}
    for name, value in memory.items():
        try:
            tree[name] = pack(value, arrays)
        except TypeError as error:
            raise CaseError(f"checkpoint: '{name}' of the run remembers what is no number: {error}") from None
    text = json.dumps({"format": FORMAT, "floatsim_version": __version__, **header, "tree": tree})
    named = {f"a{k}": array for k, array in enumerate(arrays)}
    # in memory first, to write the file in one go: an archive is patched at its beginning when it is closed
    buffer = io.BytesIO()
    np.savez(buffer, header=np.frombuffer(text.encode(), dtype=np.uint8), **named)  # type: ignore[arg-type]
    temporary = path.with_name(f".{path.name}.part")
    try:
        with temporary.open("wb") as file:
            file.write(buffer.getbuffer())
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except OSError:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)
        raise
    _secure_name(path)


def _secure_name(path: Path) -> None:
    """The renaming is on the disk too (where folders can be opened)."""
    with contextlib.suppress(OSError):
        folder = os.open(path.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def read(path: Any) -> Saved:
    """The checkpoint in a file. Raises CaseError for a file that is missing, damaged, or of another version."""
    if not isinstance(path, str | Path) or not str(path).strip() or "\0" in str(path):
        raise CaseError(f"checkpoint: got {path!r}; must be the path of a checkpoint")
    path = Path(path)
    if not path.is_file():
        raise CaseError(f"checkpoint '{path}': there is no such file")
    if not _is_one(path):
        raise CaseError(f"'{path}' is no checkpoint of floatsim, or a damaged one")
    try:
        with np.load(path, allow_pickle=False) as file:
            header = json.loads(file["header"].tobytes().decode())
            if header["format"] == FORMAT:
                arrays = [file[f"a{k}"] for k in range(len(file.files) - 1)]
    except (zipfile.BadZipFile, OSError, ValueError, KeyError, EOFError) as error:
        raise CaseError(f"checkpoint '{path}' is damaged: {error}") from None
    if header["format"] != FORMAT:
        raise CaseError(
            f"checkpoint '{path}' has format {header['format']}, this floatsim {__version__} reads {FORMAT}; resume it "
            f"with floatsim {header['floatsim_version']}"
        )
    if header["floatsim_version"] != __version__:
        raise CaseError(
            f"checkpoint '{path}' was written by floatsim {header['floatsim_version']}, this is {__version__}: results "
            "would not go on as they began; resume it with that version, or run anew"
        )
    return Saved(path, header, header.pop("tree"), arrays)


def require_model(saved: Saved, model: Model) -> None:
    """Raises CaseError, naming what differs, if the model is not the one the run began with."""
    found = differences(saved.header["model"], identity(model))
    if found:
        raise CaseError(f"checkpoint '{saved.path}' belongs to another model than '{model.name}': {'; '.join(found)}")
