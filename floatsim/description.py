"""The base of everything a user describes: frozen, checked where it is built, all problems at once.

Pydantic in strict mode, because its defaults would accept NaN, the string "2" and True as numbers.
Errors come out as `ModelError` with the user's own name of the object in front.
"""

from __future__ import annotations

import re
from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from floatsim.errors import ModelError, nearest


def _number(value: Any) -> Any:
    """NumPy scalars are numbers; strict pydantic knows Python's only."""
    if isinstance(value, np.integer | np.floating):
        return value.item()
    return value


def _tuple(value: Any) -> Any:
    """Lists and arrays are as good as tuples, nested ones too."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return tuple(_tuple(_number(item)) for item in value)
    return value


def _plain_name(value: str) -> str:
    if not re.fullmatch(r"[a-z][a-z0-9_]*", value):
        raise ValueError("a name is lower-case letters, digits and underscores, a letter first (it names netCDF variables)")
    return value


Finite = Annotated[float, BeforeValidator(_number), Field(allow_inf_nan=False)]
Positive = Annotated[float, BeforeValidator(_number), Field(gt=0.0, allow_inf_nan=False)]
NonNegative = Annotated[float, BeforeValidator(_number), Field(ge=0.0, allow_inf_nan=False)]
PositiveInt = Annotated[int, BeforeValidator(_number), Field(gt=0)]
Vector3 = Annotated[tuple[Finite, Finite, Finite], BeforeValidator(_tuple)]
Series = Annotated[tuple[Finite, ...], BeforeValidator(_tuple)]
Row6 = tuple[Finite, Finite, Finite, Finite, Finite, Finite]
Matrix6 = Annotated[tuple[Row6, Row6, Row6, Row6, Row6, Row6], BeforeValidator(_tuple)]
Name = Annotated[str, AfterValidator(_plain_name)]


class Description(BaseModel):
    """Frozen description of one thing. Raises ModelError listing every problem of the object."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid", arbitrary_types_allowed=True)

    def __init__(self, /, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise ModelError(_sentences(type(self), data, error)) from None


def _sentences(cls: type[BaseModel], data: dict[str, Any], error: ValidationError) -> list[str]:
    label = cls.__name__ + (f" '{data['name']}'" if isinstance(data.get("name"), str) else "")
    lines = []
    for item in error.errors():
        where = ".".join(str(part) for part in item["loc"])
        got = repr(item.get("input"))
        got = got if len(got) <= 60 else got[:57] + "..."
        if item["type"] == "extra_forbidden":
            lines.append(f"{label}: unknown argument '{where}'{nearest(where, cls.model_fields)}")
        elif item["type"] == "missing":
            lines.append(f"{label}: '{where}' is missing")
        elif item["type"] == "value_error":
            lines.append(f"{label}: {where + ': ' if where else ''}{item['ctx']['error']}")
        else:
            lines.append(f"{label}: {where}: got {got}; {item['msg'][0].lower() + item['msg'][1:]}")
    return lines
