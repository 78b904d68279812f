"""WAMIT's numeric output files `.1`, `.3` and `.hst` as a `HydroDatabase`.

WAMIT (User Manual v7, sections 3.1, 5.2 and 5.6) writes, with L = ULEN, k = 3, 4, 5 for
translation-translation, mixed and rotation-rotation entries, m = 2, 3 for forces and moments:

- `.1`   PER I J A B     A rho L^k, B rho w L^k. PER < 0 is zero and PER = 0 infinite frequency, A alone.
- `.3`   PER BETA I MOD PHASE RE IM     X rho g L^m per metre of wave amplitude.
- `.hst` I J C           C rho g L^(k - 1), with the weight acting at WAMIT's centre of gravity.

Its time factor is e^{+i w t}, its phases refer to the crest at the global origin and its headings are
those towards which waves travel: floatsim's conventions, so that nothing changes sign. Forces and
moments refer to the body's own origin (XBODY). Entries that are zero by symmetry are left out of the files.
"""

from __future__ import annotations

import gzip
import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from floatsim.errors import ModelError
from floatsim.hydro.database import HydroDatabase

_ROTATION = np.array([0, 0, 0, 1, 1, 1])
_MOMENT_ARMS = _ROTATION[:, None] + _ROTATION  # powers of length that rotations add to an entry


def read_wamit(
    stem: str | Path,
    *,
    volume: float,
    centre_of_buoyancy: tuple[float, float, float],
    depth: float,
    density: float,
    gravity: float,
    length: float = 1.0,
    reference_point: tuple[float, float, float] = (0.0, 0.0, 0.0),
    centre_of_gravity: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> HydroDatabase:
    """Database from `stem`.1, .3 and .hst (each may be gzipped, `.1.gz`); PER is a period in s, the default.

    volume              m3, displaced; the files do not contain it
    centre_of_buoyancy  m, world frame
    depth               m, of the WAMIT run (inf for deep water)
    density, gravity    kg/m3, m/s2, to give the numbers their dimensions
    length              ULEN, m
    reference_point     WAMIT's body origin in the world frame (XBODY), m
    centre_of_gravity   of the WAMIT run, m from the reference point; its weight is taken out of `.hst`

    Raises ModelError naming file and line for what cannot be read, is double, missing or of several bodies.
    """
    omega, mass, damping, mass_inf, mass_zero = _radiation(_find(stem, ".1"))
    headings, force = _excitation(_find(stem, ".3"), omega)
    stiffness = _hydrostatics(_find(stem, ".hst"))
    weight = density * gravity * volume
    stiffness *= density * gravity * length ** (2.0 + _MOMENT_ARMS)
    # WAMIT: C44, C55 contain - m g z_G, C46 and C56 + m g x_G and + m g y_G, with m = rho V
    x, y, z = centre_of_gravity
    stiffness += weight * np.diag([0.0, 0.0, 0.0, z, z, 0.0])
    stiffness[3, 5] -= weight * x
    stiffness[4, 5] -= weight * y
    dimension = density * length ** (3.0 + _MOMENT_ARMS)
    return HydroDatabase(
        name=Path(stem).name,
        omega=omega,
        added_mass=mass * dimension,
        radiation_damping=damping * dimension * omega[:, None, None],
        added_mass_inf=mass_inf * dimension,
        added_mass_zero=None if mass_zero is None else mass_zero * dimension,
        headings=headings,
        excitation=force * density * gravity * length ** (2.0 + _ROTATION),
        hydrostatic_stiffness=stiffness,
        volume=np.array(volume),
        centre_of_buoyancy=np.array(centre_of_buoyancy),
        reference_point=np.array(reference_point),
        depth=depth,
        density=density,
        gravity=gravity,
        source={"solver": "WAMIT", "file": Path(stem).name},
    )


def _find(stem: str | Path, ending: str) -> Path:
    candidates = [Path(f"{stem}{ending}"), Path(f"{stem}{ending}.gz")]
    for path in candidates:
        if path.is_file():
            return path
    raise ModelError(f"WAMIT file '{candidates[0]}' does not exist (nor '{candidates[1].name}')")


def _rows(path: Path, widths: tuple[int, ...]) -> Iterator[tuple[int, list[float]]]:
    """(line number, numbers) of the non-empty lines; a header (NUMHDR = 1) may stand in the first line."""
    opener = gzip.open if path.suffix == ".gz" else open
    try:
        with opener(path, "rt", encoding="ascii", errors="replace") as file:
            for number, line in enumerate(file, 1):
                words = line.upper().replace("D", "E").split()
                try:
                    values = [float(word) for word in words]
                except ValueError:
                    if number == 1:
                        continue
                    raise ModelError(f"{path}, line {number}: not numbers: '{line.strip()[:60]}'") from None
                if not values:
                    continue
                if len(values) not in widths:
                    allowed = " or ".join(str(width) for width in widths)
                    raise ModelError(f"{path}, line {number}: {len(values)} numbers, must be {allowed}")
                if not all(map(math.isfinite, values)):
                    raise ModelError(f"{path}, line {number}: '{line.strip()[:60]}' is not finite")
                yield number, values
    except (OSError, EOFError) as error:
        raise ModelError(f"{path}: cannot be read: {error}") from None


def _dof(path: Path, number: int, value: float) -> int:
    """Index 0..5 from WAMIT's 1..6."""
    if value not in (1, 2, 3, 4, 5, 6):
        raise ModelError(
            f"{path}, line {number}: degree of freedom {value:g}, must be 1 to 6 (one body; "
            "files of several bodies or with generalised modes cannot be read)"
        )
    return int(value) - 1


def _once(path: Path, number: int, seen: set[tuple[float, ...]], key: tuple[float, ...]) -> None:
    if key in seen:
        raise ModelError(f"{path}, line {number}: this entry was given before")
    seen.add(key)


Radiation = tuple[
    NDArray[np.float64],
    NDArray[np.float64],
    NDArray[np.float64],
    NDArray[np.float64],
    NDArray[np.float64] | None,
]


def _radiation(path: Path) -> Radiation:
    """omega (n,) rad/s increasing, then WAMIT's numbers: A, B (n, 6, 6), A_inf, A(0) or None."""
    table: dict[float, NDArray[np.float64]] = {}
    seen: set[tuple[float, ...]] = set()
    for number, values in _rows(path, (4, 5)):
        period = -1.0 if values[0] < 0.0 else values[0]
        i, j = _dof(path, number, values[1]), _dof(path, number, values[2])
        _once(path, number, seen, (period, i, j))
        if period > 0.0 and len(values) != 5:
            raise ModelError(f"{path}, line {number}: 4 numbers, must be 5 at a finite period")
        entry = table.setdefault(period, np.zeros((2, 6, 6)))
        entry[0, i, j] = values[3]
        entry[1, i, j] = values[4] if len(values) == 5 else 0.0
    if 0.0 not in table:
        raise ModelError(f"{path}: no added mass at infinite frequency; run WAMIT with period 0 as well")
    periods = sorted((period for period in table if period > 0.0), reverse=True)
    if len(periods) < 2:
        raise ModelError(f"{path}: {len(periods)} finite periods, at least two are needed")
    finite = np.array([table[period] for period in periods])
    omega = 2.0 * np.pi / np.array(periods)
    zero = table[-1.0][0] if -1.0 in table else None
    return omega, finite[:, 0], finite[:, 1], table[0.0][0], zero


def _excitation(path: Path, omega: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
    """Headings (m,) rad increasing in [-pi, pi) and WAMIT's X (n, m, 6) at the frequencies of `.1`."""
    entries: dict[tuple[float, float], NDArray[np.complex128]] = {}
    seen: set[tuple[float, ...]] = set()
    for number, values in _rows(path, (7,)):
        if values[0] <= 0.0:
            raise ModelError(f"{path}, line {number}: period {values[0]:g} s, must be positive")
        i = _dof(path, number, values[2])
        _once(path, number, seen, (values[0], values[1], i))
        heading = (values[1] + 180.0) % 360.0 - 180.0  # 180 and -180 deg are the same wave
        entries.setdefault((values[0], heading), np.zeros(6, dtype=np.complex128))[i] = complex(*values[5:])
    periods = sorted({period for period, _ in entries}, reverse=True)
    headings = sorted({heading for _, heading in entries})
    if len(periods) != omega.size or not np.allclose(2.0 * np.pi / np.array(periods), omega, rtol=1e-5):
        raise ModelError(
            f"{path}: its {len(periods)} periods are not the {omega.size} finite ones of the .1 file"
        )
    missing = [(p, h) for p in periods for h in headings if (p, h) not in entries]
    if missing:
        raise ModelError(
            f"{path}: {len(missing)} combinations of period and heading are missing, the first is "
            f"period {missing[0][0]:g} s, heading {missing[0][1]:g} deg"
        )
    force = np.array([[entries[period, heading] for heading in headings] for period in periods])
    return np.radians(headings), force


def _hydrostatics(path: Path) -> NDArray[np.float64]:
    """WAMIT's C (6, 6)."""
    stiffness = np.zeros((6, 6))
    seen: set[tuple[float, ...]] = set()
    for number, (row, column, value) in _rows(path, (3,)):
        i, j = _dof(path, number, row), _dof(path, number, column)
        _once(path, number, seen, (i, j))
        stiffness[i, j] = value
    if not seen:
        raise ModelError(f"{path}: is empty")
    return stiffness
