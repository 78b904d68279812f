"""Reader of small files in the classic netCDF format, all at once.

A file of statistics holds half a thousand variables of a few hundred numbers: what takes time is its header. Read in
one go by a parser that makes no objects for variables, one takes milliseconds; a matrix has thousands of them.

Source of the format: The NetCDF Classic Format Specification, NASA ESDS-RFC-011v2.0 (2011): magic, number of records,
lists of dimensions, attributes and variables, each with a tag and a count, everything big-endian and padded to 4 bytes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from struct import error as StructError
from struct import unpack_from
from typing import Any

import numpy as np

_TYPES = {1: "i1", 2: "S1", 3: ">i2", 4: ">i4", 5: ">f4", 6: ">f8"}
_CHAR = 2
STRING = "string"  # dimensions of letters begin with it


@dataclass
class Classic:
    """Contents of a file: values (float64, or labels) and dimensions of variables, their attributes, global ones."""

    values: dict[str, Any]
    dims: dict[str, tuple[str, ...]]
    attributes: dict[str, dict[str, Any]]
    about: dict[str, Any]


def dimensions(path: Path) -> dict[str, int]:
    """Sizes of the dimensions, from the beginning of the file. Raises ValueError for what is no such file."""
    with path.open("rb") as file:
        return dict(_dimensions(file.read(16384))[0])


def read_classic(path: Path) -> Classic:
    """Everything in a file. Raises ValueError if it is damaged or no such file."""
    data = path.read_bytes()
    sizes, i = _dimensions(data)
    try:
        about, i = _attributes(data, i)
        _, count = unpack_from(">ii", data, i)
        i += 8
        found = Classic({}, {}, {}, about)
        for _ in range(count):
            name, i = _name(data, i)
            (n,) = unpack_from(">i", data, i)
            own = [sizes[k] for k in unpack_from(f">{n}i", data, i + 4)]
            attributes, i = _attributes(data, i + 4 + 4 * n)
            kind, _, begin = unpack_from(">iiq", data, i)
            i += 16
            dims, shape = tuple(dim for dim, _ in own), [size for _, size in own]
            raw = np.frombuffer(data, _TYPES[kind], math.prod(shape), begin).reshape(shape)
            if kind == _CHAR and dims and dims[-1].startswith(STRING):
                dims = dims[:-1]
                words = [row.tobytes().rstrip(b"\0").decode() for row in raw.reshape(-1, shape[-1])]
                found.values[name] = np.array(words, dtype=object).reshape(shape[:-1])
            else:
                found.values[name] = raw.astype(float)
            found.dims[name], found.attributes[name] = dims, attributes
    except (StructError, KeyError, IndexError, UnicodeDecodeError) as error:
        raise ValueError(f"'{path}' is damaged: {error}") from None
    return found


def _dimensions(data: bytes) -> tuple[list[tuple[str, int]], int]:
    if data[:4] != b"CDF\2":
        raise ValueError("no file in the classic format with 64-bit offsets")
    try:
        _, count = unpack_from(">ii", data, 8)
        i, sizes = 16, []
        for _ in range(count):
            name, i = _name(data, i)
            sizes.append((name, unpack_from(">i", data, i)[0]))
            i += 4
    except (StructError, UnicodeDecodeError) as error:
        raise ValueError(f"damaged: {error}") from None
    return sizes, i


def _name(data: bytes, i: int) -> tuple[str, int]:
    (n,) = unpack_from(">i", data, i)
    return data[i + 4 : i + 4 + n].decode(), i + 4 + n + -n % 4


def _attributes(data: bytes, i: int) -> tuple[dict[str, Any], int]:
    _, count = unpack_from(">ii", data, i)
    i += 8
    found: dict[str, Any] = {}
    for _ in range(count):
        name, i = _name(data, i)
        kind, n = unpack_from(">ii", data, i)
        i += 8
        if kind == _CHAR:
            found[name] = data[i : i + n].rstrip(b"\0").decode()
            size = n
        else:
            values = np.frombuffer(data, _TYPES[kind], n, i)
            found[name] = values[0].item() if n == 1 else values.tolist()
            size = values.nbytes
        i += size + -size % 4
    return found, i
