"""The base of everything a user describes: frozen, checked where it is built, all problems at once.

Values are checked here rather than by pydantic's own types, whose defaults would accept NaN, the string "2" and True
as numbers. Errors come out as `ModelError`: the user's own name of the object, what was got, what is allowed.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError

from floatsim.errors import ModelError, nearest


class _Refused(ValueError):
    """Carries what is allowed; what was got is added where the message is made."""


def is_number(value: Any) -> bool:
    """Whether a value is a finite real number: of Python or NumPy, no boolean, no text."""
    value = _scalar(value)
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # a whole number beyond floating point
        return False


def _scalar(value: Any) -> Any:
    return value[()] if isinstance(value, np.ndarray) and value.ndim == 0 else value


LARGEST = 1e40  # of any number in SI units; squares and products of such still fit into floating point


def _usable(value: Any) -> bool:
    return is_number(value) and abs(float(value)) <= LARGEST


def _number(allowed: str, good: Callable[[float], bool]) -> BeforeValidator:
    def check(value: Any) -> float:
        if not is_number(value) or not good(value):
            raise _Refused(allowed)
        if abs(float(value)) > LARGEST:
            raise _Refused(f"{allowed} of at most {LARGEST:g}")
        return float(value)

    return BeforeValidator(check)


def _whole(value: Any) -> int:
    if not is_number(value) or not isinstance(_scalar(value), int | np.integer) or value < 1:
        raise _Refused("a positive whole number")
    return int(value)


def _row(value: Any) -> tuple[Any, ...] | None:
    """Lists and arrays are as good as tuples."""
    return tuple(value) if isinstance(value, list | tuple) or (isinstance(value, np.ndarray) and value.ndim) else None


def numbers(allowed: str, *lengths: int) -> BeforeValidator:
    """Validator of rows of finite numbers, of one of these lengths (any if none is given)."""

    def check(value: Any) -> tuple[float, ...]:
        row = _row(value)
        if row is None or (lengths and len(row) not in lengths) or not all(map(_usable, row)):
            raise _Refused(allowed)
        return tuple(float(y) for y in row)

    return BeforeValidator(check)


def _matrix6(value: Any) -> tuple[tuple[float, ...], ...]:
    rows = [_row(line) for line in _row(value) or ()]
    if len(rows) != 6 or not all(row is not None and len(row) == 6 and all(map(_usable, row)) for row in rows):
        raise _Refused("6 rows of 6 finite numbers")
    return tuple(tuple(float(y) for y in row or ()) for row in rows)


def _items(value: Any) -> tuple[Any, ...]:
    row = _row(value)
    if row is None:
        raise _Refused("a list")
    return row


def _target(value: Any) -> Any:
    if isinstance(value, str):
        return value
    row = _row(value)
    if row is None or len(row) != 3 or not all(map(_usable, row)):
        raise _Refused("the name of a connection point or a fixed point (x, y, z)")
    return tuple(float(y) for y in row)


def _plain_name(value: Any) -> str:
    if not isinstance(value, str) or not re.fullmatch(r"[a-z][a-z0-9_]*", value):
        raise _Refused("lower-case letters, digits and underscores, a letter first (it names netCDF variables)")
    return value


Finite = Annotated[float, _number("a finite number", lambda y: True)]
Positive = Annotated[float, _number("a positive number", lambda y: y > 0.0)]
NonNegative = Annotated[float, _number("a number that is not negative", lambda y: y >= 0.0)]
PositiveInt = Annotated[int, BeforeValidator(_whole)]
Vector3 = Annotated[tuple[float, float, float], numbers("three finite numbers (x, y, z)", 3)]
Series = Annotated[tuple[float, ...], numbers("a row of finite numbers")]
Matrix6 = Annotated[tuple[tuple[float, ...], ...], BeforeValidator(_matrix6)]
Name = Annotated[str, BeforeValidator(_plain_name)]
Target = Annotated[str | tuple[float, float, float], BeforeValidator(_target)]
Items = Annotated[tuple[Any, ...], BeforeValidator(_items)]


class Description(BaseModel):
    """Frozen description of one thing. Raises ModelError listing every problem of the object."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid", arbitrary_types_allowed=True)

    def __init__(self, /, *args: Any, **data: Any) -> None:
        if args:
            cls = type(self)
            first = next((f"{name}=..., ..." for name in cls.model_fields), "")
            raise ModelError(
                f"{cls.__name__}: got {_short(args[0])} without a name; arguments are given by name: "
                f"{cls.__name__}({first})"
            )
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise ModelError(_sentences(type(self), data, error)) from None

    def __setattr__(self, name: str, value: Any) -> None:
        label = _label(type(self), dict(self))
        raise ModelError(f"{label}: '{name}' cannot be changed; build a new {type(self).__name__}")

    def model_copy(self, *, update: Any = None, deep: bool = False) -> Any:
        """A copy with some values changed, checked like a new one."""
        return type(self)(**{**{name: getattr(self, name) for name in type(self).model_fields}, **(update or {})})


def _label(cls: type[BaseModel], data: dict[str, Any]) -> str:
    return cls.__name__ + (f" '{data['name']}'" if isinstance(data.get("name"), str) else "")


def _short(value: Any) -> str:
    try:
        text = " ".join(repr(value).split())
    except Exception:  # the value's own repr is broken
        text = f"a {type(value).__name__}"
    if isinstance(value, str) and re.match(r"\s*[-+.]?\d", value) and len(text) < 60:
        return f"the text {text}"
    return text if len(text) <= 60 else text[:57] + "..."


# what is allowed where pydantic itself refuses, by the type of its error
_ALLOWED = {
    "string_type": "text", "bool_type": "True or False", "model_type": "a {class_name}", "is_instance_of": "a {class}",
    "literal_error": "{expected}", "dict_type": "a dictionary, name: value", "int_type": "a whole number",
    "greater_than_equal": "at least {ge}", "too_short": "at least {min_length} long",
}  # fmt: skip


def _sentences(cls: type[BaseModel], data: dict[str, Any], error: ValidationError) -> list[str]:
    """One sentence for every argument that was refused."""
    label = _label(cls, data)
    lines: list[str] = []
    refused: dict[str, tuple[str, list[str]]] = {}  # argument -> what was got, what is allowed
    for item in error.errors():
        # parts of unions and keys of dictionaries are pydantic's business, not the user's
        kind, context = item["type"], item.get("ctx", {})
        branch = context.get("class_name")
        where = ".".join(str(part) for part in item["loc"] if "[" not in str(part) and part != branch)
        if kind == "extra_forbidden":
            lines.append(f"{label}: unknown argument '{where}'{nearest(where, cls.model_fields)}")
        elif kind == "missing":
            lines.append(f"{label}: '{where}' is missing")
        elif kind == "value_error" and not isinstance(context["error"], _Refused):
            lines.append(f"{label}: {where + ': ' if where else ''}{context['error']}")
        else:
            what = str(context["error"]) if kind == "value_error" else _ALLOWED.get(kind, "{msg}")
            what = what.format(**context, msg=item["msg"])
            refused.setdefault(where, (_short(item["input"]), []))[1].append(what)
    for where, (got, allowed) in refused.items():
        lines.append(f"{label}: {where}: got {got}; must be {' or '.join(dict.fromkeys(allowed))}")
    return lines
