"""What readers of hydrodynamic coefficients share: the steps from another code's conventions to floatsim's.

floatsim's are those of `HydroDatabase`: time factor e^{+i w t}, phases from the world origin, headings towards which
waves travel, stiffness without weight. How the codes differ from them stands in their readers.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from floatsim.errors import ModelError
from floatsim.hydro.database import added_mass_from_damping
from floatsim.sea.dispersion import wave_number

Array = NDArray[np.float64]
Force = NDArray[np.complex128]

ESTIMATED = "from A(w) and B(w), Ogilvie's relation"  # `source["added_mass_inf"]` of what was not computed


def per_body(label: str, name: str, value: ArrayLike, N: int, width: int = 0) -> Array:
    """(N,) or (N, width) from what a user gave for N bodies; one body needs no outer brackets.

    Raises ModelError, after `label`, if it is something else.
    """
    shape = (N, width) if width else (N,)
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        array = np.full(0, np.nan)
    if N == 1 and array.shape == shape[1:]:
        array = array[None]
    if array.shape != shape or not np.all(np.isfinite(array)):
        one = "a number" if width == 0 else f"{width} numbers"
        raise ModelError(f"{label}: {name} must be {one} for each of {_bodies(N)}, got {value!r}")
    return array


def body_names(label: str, bodies: Sequence[str], N: int, name: str) -> tuple[str, ...]:
    """Names of N bodies: those given, else the database's for one and body_1, body_2 ... for several."""
    given = (bodies,) if isinstance(bodies, str) else tuple(bodies) if isinstance(bodies, Sequence) else (None,)
    if not all(isinstance(item, str) for item in given):
        raise ModelError(f"{label}: bodies must be names, got {bodies!r}")
    if given and len(given) != N:
        raise ModelError(f"{label}: bodies names {len(given)}, there are {_bodies(N)}")
    return tuple(map(str, given)) or ((name,) if N == 1 else tuple(f"body_{k + 1}" for k in range(N)))


def ordered_headings(angles: ArrayLike) -> tuple[Array, NDArray[np.intp]]:
    """Headings in [-pi, pi) rad, increasing, from `angles` in rad, and their places in it; 360 deg is 0 deg."""
    wrapped = (np.asarray(angles, dtype=np.float64) + np.pi) % (2.0 * np.pi) - np.pi
    wrapped = np.where(wrapped > np.pi - 1e-7, wrapped - 2.0 * np.pi, wrapped)
    order = np.argsort(wrapped, kind="stable")
    keep = np.append(True, np.diff(wrapped[order]) > 1e-6)
    return wrapped[order][keep], order[keep]


def from_world_origin(
    force: Force, omega: Array, headings: Array, point: Sequence[float], depth: float, gravity: float
) -> Force:
    """Force (n, m, d) for a crest at the world origin, from that for a crest at the horizontal `point` (x, y), m.

    Time factor e^{+i w t}. At the point the wave is later by k (x cos b + y sin b).
    """
    x, y = point
    lag = wave_number(omega, depth, gravity)[:, None] * (x * np.cos(headings) + y * np.sin(headings))
    return force * np.exp(-1j * lag)[:, :, None]


def without_weight(stiffness: Array, weight: Array, arm: Array) -> Array:
    """Stiffness (d, d) of the water alone, from that of a floater whose weight acts at `arm` (N, 3) m from its
    reference point; weight (N,), N.

    Weight puts - m g z_G into C44 and C55, + m g x_G and + m g y_G into C46 and C56 (WAMIT manual v7, section 3.1).
    """
    out = stiffness.copy()
    for k, (w, (x, y, z)) in enumerate(zip(weight, arm, strict=True)):
        roll, pitch, yaw = 6 * k + 3, 6 * k + 4, 6 * k + 5
        out[roll, roll] += w * z
        out[pitch, pitch] += w * z
        out[roll, yaw] -= w * x
        out[pitch, yaw] -= w * y
    return out


def infinite_added_mass(label: str, omega: Array, mass: Array, damping: Array, estimate: bool) -> Array:
    """A_inf (d, d) where the code has not computed it: mean of A(w) less what B(w) says, over w <= w_max / 2.

    Ogilvie (1964). Raises ModelError unless the user has asked for the estimate.
    """
    if not estimate:
        raise ModelError(
            f"{label}: no added mass at infinite frequency; compute it too, or accept one that follows from A(w) and "
            "B(w) with estimate_added_mass_inf=True"
        )
    low = omega <= 0.5 * omega[-1]
    if not np.any(low):
        raise ModelError(f"{label}: too few frequencies to estimate the added mass at infinite frequency from")
    return np.asarray((mass - added_mass_from_damping(omega, damping))[low].mean(axis=0))


def in_folder(folder: Path, *names: str) -> Path | None:
    """The file or folder in `folder` with the first of `names` there is, whatever its capitals."""
    if folder.is_dir():
        there = {item.name.lower(): item for item in sorted(folder.iterdir())}
        for name in names:
            if name.lower() in there:
                return there[name.lower()]
    return None


def text_lines(path: Path) -> list[str]:
    """Lines of a text file. Raises ModelError if it cannot be read."""
    try:
        return path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError as error:
        raise ModelError(f"'{path}': cannot be read: {error.strerror or error}") from None


def numbers(line: str) -> list[float]:
    """The numbers a line begins with, Fortran's D exponents too."""
    out: list[float] = []
    for word in line.replace(",", " ").split():
        try:
            out.append(float(word.upper().replace("D", "E")))
        except ValueError:
            break
    return out


def plain(value: Any) -> Any:
    """A netCDF attribute or number as Python has it."""
    return value.item() if isinstance(value, (np.generic, np.ndarray)) and np.size(value) == 1 else value


def _bodies(N: int) -> str:
    return "1 body" if N == 1 else f"{N} bodies"
