"""WAMIT's numeric output files as a `HydroDatabase`, for one body or several that interact.

WAMIT (User Manual v7, sections 3.1 to 3.7, 5.2 and 5.6) writes, with L = ULEN, k = 3, 4, 5 for
translation-translation, mixed and rotation-rotation entries, m = 2, 3 for forces and moments:

- `.1`         PER I J A B     A rho L^k, B rho w L^k. PER < 0 is zero and PER = 0 infinite frequency, A alone.
- `.3`         PER BETA I MOD PHASE RE IM     X rho g L^m per metre of wave amplitude.
- `.3fk .3sc`  the same for the Froude-Krylov and the scattering part of X.
- `.8 .9`      PER BETA1 BETA2 I MOD PHASE RE IM     mean drift rho g L^(m - 1) per metre squared, from momentum and
               from pressure; momentum gives surge, sway and yaw.
- `.hst`       I J C           C rho g L^(k - 1), with the weight acting at WAMIT's centre of gravity.

Its time factor is e^{+i w t}, its phases refer to the crest at the global origin and its headings are
those towards which waves travel: floatsim's conventions, so that nothing changes sign. Forces and
moments refer to the body's own origin (XBODY), axes are the global ones unless a body was turned (XBODY(4)), which
cannot be read. I and J count six per body, one body after the other. Entries that are zero by symmetry are left out
of the files.
"""

from __future__ import annotations

import gzip
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from floatsim.errors import ModelError
from floatsim.hydro.conventions import Array, Force, body_names, per_body, without_weight
from floatsim.hydro.database import HydroDatabase

_ROTATION = np.array([0, 0, 0, 1, 1, 1])
_ENDINGS = (".1", ".3", ".hst", ".3fk", ".3sc", ".8", ".9")
_SAME = 1e-5  # relative difference of two periods that are one


def read_wamit(
    stem: str | Path,
    *,
    volume: float | Sequence[float],
    centre_of_buoyancy: ArrayLike,
    depth: float,
    density: float,
    gravity: float,
    length: float = 1.0,
    reference_point: ArrayLike | None = None,
    centre_of_gravity: ArrayLike | None = None,
    bodies: Sequence[str] = (),
) -> HydroDatabase:
    """Database from `stem`.1, .3 and .hst (each may be gzipped, `.1.gz`); PER is a period in s, the default.

    .3fk (or .3sc), .8 and .9 are read where they are. What the files do not contain, for N bodies N times:

    volume              m3, displaced
    centre_of_buoyancy  m, world frame
    depth               m, of the WAMIT run (inf for deep water)
    density, gravity    kg/m3, m/s2, to give the numbers their dimensions
    length              ULEN, m
    reference_point     WAMIT's body origin in the world frame (XBODY), m; the default for one body is the world's
    centre_of_gravity   of the WAMIT run, m from the reference point (default: there); its weight is taken out of `.hst`
    bodies              names; default body_1, body_2 ...

    Raises ModelError naming file and line for what cannot be read, is double, missing or of another number of bodies.
    """
    files = {ending: path for ending in _ENDINGS if (path := _optional(stem, ending)) is not None}
    for ending in (".1", ".3", ".hst"):
        if ending not in files:
            raise ModelError(f"WAMIT file '{stem}{ending}' does not exist (nor '{Path(stem).name}{ending}.gz')")
    label, N = f"WAMIT files '{stem}'", max(np.size(volume), 1)
    if reference_point is None and N > 1:
        raise ModelError(f"{label}: give reference_point, the XBODY of each of the {N} bodies")
    V = per_body(label, "volume", volume, N)
    origin = per_body(label, "reference_point", np.zeros((N, 3)) if reference_point is None else reference_point, N, 3)
    arm = per_body(label, "centre_of_gravity", np.zeros((N, 3)) if centre_of_gravity is None else centre_of_gravity,
                   N, 3)  # fmt: skip
    d = 6 * N
    rotation = np.tile(_ROTATION, N)
    arms = rotation[:, None] + rotation  # powers of length that rotations add to an entry
    omega, mass, damping, mass_inf, mass_zero = radiation(files[".1"], d)
    if mass_inf is None:
        raise ModelError(f"{files['.1']}: no added mass at infinite frequency; run WAMIT with period 0 as well")
    headings, force = forces(files[".3"], omega, d)
    stiffness = _hydrostatics(files[".hst"], d) * density * gravity * length ** (2.0 + arms)
    dimension = density * length ** (3.0 + arms)
    pressure = density * gravity * length ** (2.0 + rotation)
    froude_krylov = _froude_krylov(files, omega, headings, force)
    drift = _mean_drift(files, omega, headings, d)
    source = {"solver": "WAMIT", "file": Path(stem).name}
    if N > 1 and ".8" in files and drift is None:
        source["mean_drift"] = "not read: .8 is the sum over all bodies"
    return HydroDatabase(
        name=Path(stem).name,
        bodies=body_names(label, bodies, N, Path(stem).name),
        omega=omega,
        added_mass=mass * dimension,
        radiation_damping=damping * dimension * omega[:, None, None],
        added_mass_inf=mass_inf * dimension,
        added_mass_zero=None if mass_zero is None else mass_zero * dimension,
        headings=headings,
        excitation=force * pressure,
        froude_krylov=None if froude_krylov is None else froude_krylov * pressure,
        mean_drift=None if drift is None else drift * pressure / length,
        hydrostatic_stiffness=without_weight(stiffness, density * gravity * V, arm),
        volume=V,
        centre_of_buoyancy=per_body(label, "centre_of_buoyancy", centre_of_buoyancy, N, 3),
        reference_point=origin,
        depth=depth,
        density=density,
        gravity=gravity,
        source=source,
    )


def _optional(stem: str | Path, ending: str) -> Path | None:
    return next((p for p in (Path(f"{stem}{ending}"), Path(f"{stem}{ending}.gz")) if p.is_file()), None)


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


def _dof(path: Path, number: int, value: float, d: int) -> int:
    """Index 0..d-1 from WAMIT's 1..d."""
    if value not in range(1, d + 1):
        raise ModelError(
            f"{path}, line {number}: degree of freedom {value:g}, must be 1 to {d}: volume is given for "
            f"{_count(d)}, six each; give it for every body of the run (generalised modes cannot be read)"
        )
    return int(value) - 1


def _count(d: int) -> str:
    return "1 body" if d == 6 else f"{d // 6} bodies"


def _once(path: Path, number: int, seen: set[tuple[float, ...]], key: tuple[float, ...]) -> None:
    if key in seen:
        raise ModelError(f"{path}, line {number}: this entry was given before")
    seen.add(key)


def _from_period(period: Array) -> Array:
    return 2.0 * np.pi / period


def radiation(
    path: Path, d: int, as_omega: Callable[[Array], Array] = _from_period, zero_first: bool = False
) -> tuple[Array, Array, Array, Array | None, Array | None]:
    """omega (n,) rad/s increasing, then WAMIT's numbers: A, B (n, d, d), A_inf or None, A(0) or None.

    as_omega: of the first column, a period unless another code wrote the file; zero_first: there 0 is zero frequency
    and a negative number infinity, as with a column of frequencies.
    """
    table: dict[float, Array] = {}
    seen: set[tuple[float, ...]] = set()
    for number, values in _rows(path, (4, 5)):
        period = -1.0 if values[0] < 0.0 else values[0]
        i, j = _dof(path, number, values[1], d), _dof(path, number, values[2], d)
        _once(path, number, seen, (period, i, j))
        if period > 0.0 and len(values) != 5:
            raise ModelError(f"{path}, line {number}: 4 numbers, must be 5 at a finite period")
        entry = table.setdefault(period, np.zeros((2, d, d)))
        entry[0, i, j] = values[3]
        entry[1, i, j] = values[4] if len(values) == 5 else 0.0
    if seen and 6 * (max(int(i) for _, i, _ in seen) // 6 + 1) < d:
        raise ModelError(f"{path}: volume is given for {_count(d)}, the file has fewer")
    periods = np.array([period for period in table if period > 0.0])
    if len(periods) < 2:
        raise ModelError(f"{path}: {len(periods)} finite periods, at least two are needed")
    omega = as_omega(periods)
    order = np.argsort(omega)
    finite = np.array([table[period] for period in periods[order]])
    infinite, zero = (table[key][0] if key in table else None for key in (0.0, -1.0))
    if zero_first:
        infinite, zero = zero, infinite
    return omega[order], finite[:, 0], finite[:, 1], infinite, zero


def forces(
    path: Path, omega: Array, d: int, as_omega: Callable[[Array], Array] = _from_period
) -> tuple[Array, Force]:
    """Headings (m,) rad increasing in [-pi, pi) and WAMIT's X (n, m, d) at the frequencies of `.1`."""
    entries: dict[tuple[float, float], Force] = {}
    seen: set[tuple[float, ...]] = set()
    for number, values in _rows(path, (7,)):
        if values[0] <= 0.0:
            raise ModelError(f"{path}, line {number}: period {values[0]:g} s, must be positive")
        i = _dof(path, number, values[2], d)
        _once(path, number, seen, (values[0], values[1], i))
        entries.setdefault((values[0], _wrap(values[1])), np.zeros(d, dtype=np.complex128))[i] = complex(*values[5:])
    return _on_grid(path, entries, omega, as_omega)


def _wrap(heading: float) -> float:
    return (heading + 180.0) % 360.0 - 180.0  # 180 and -180 deg are the same wave


def _on_grid(
    path: Path,
    entries: dict[tuple[float, float], Force],
    omega: Array,
    as_omega: Callable[[Array], Array] = _from_period,
) -> tuple[Array, Force]:
    given = np.array(sorted({period for period, _ in entries}))
    headings = sorted({heading for _, heading in entries})
    found = as_omega(given)
    order = np.argsort(found)
    if given.size != omega.size or not np.allclose(found[order], omega, rtol=_SAME):
        raise ModelError(f"{path}: its {given.size} periods are not the {omega.size} finite ones of the .1 file")
    periods = given[order]
    missing = [(w, h) for p, w in zip(periods, omega) for h in headings if (p, h) not in entries]
    if missing:
        raise ModelError(
            f"{path}: {len(missing)} combinations of period and heading are missing, the first is "
            f"period {2.0 * np.pi / missing[0][0]:g} s, heading {missing[0][1]:g} deg"
        )
    force = np.array([[entries[period, heading] for heading in headings] for period in periods])
    return np.radians(headings), force


def _froude_krylov(files: dict[str, Path], omega: Array, headings: Array, force: Force) -> Force | None:
    """From `.3fk`, or as what `.3sc` leaves of `.3`."""
    for ending in (".3fk", ".3sc"):
        path = files.get(ending)
        if path is not None:
            known, part = forces(path, omega, force.shape[2])
            if known.shape != headings.shape or not np.allclose(known, headings, atol=1e-6):
                raise ModelError(f"{path}: its headings are not those of the .3 file")
            return part if ending == ".3fk" else force - part
    return None


def _mean_drift(files: dict[str, Path], omega: Array, headings: Array, d: int) -> Array | None:
    """(n, m, d): `.9` where there is one, `.8` over it for one body, whose surge, sway and yaw are better."""
    drift = None
    for ending in (".9", ".8"):
        path = files.get(ending)
        if path is None or (ending == ".8" and d > 6):
            continue
        entries: dict[tuple[float, float], Force] = {}
        given: set[int] = set()
        for number, values in _rows(path, (8,)):
            if abs(_wrap(values[1] - values[2])) > 1e-6:  # two waves that cross
                continue
            i = _dof(path, number, values[3], d)
            given.add(i)
            key = (values[0], _wrap(values[1]))
            entries.setdefault(key, np.zeros(d, dtype=np.complex128))[i] = complex(*values[6:])
        known, part = _on_grid(path, entries, omega)
        if known.shape != headings.shape or not np.allclose(known, headings, atol=1e-6):
            raise ModelError(f"{path}: its headings are not those of the .3 file")
        drift = np.zeros(part.shape) if drift is None else drift
        drift[:, :, sorted(given)] = part.real[:, :, sorted(given)]
    return drift


def _hydrostatics(path: Path, d: int) -> Array:
    """WAMIT's C (d, d)."""
    stiffness = np.zeros((d, d))
    seen: set[tuple[float, ...]] = set()
    for number, (row, column, value) in _rows(path, (3,)):
        i, j = _dof(path, number, row, d), _dof(path, number, column, d)
        _once(path, number, seen, (i, j))
        stiffness[i, j] = value
    if not seen:
        raise ModelError(f"{path}: is empty")
    return stiffness
