"""Results of Nemoh 2 and 3, a folder, as a `HydroDatabase`; and the hydrostatics files that Capytaine writes too.

A folder holds (capitals do not matter, nor whether files lie in `mesh` and `results` or beside `Nemoh.cal`)

- `Nemoh.cal`                    water, bodies with their degrees of freedom, frequencies and headings,
- `RadiationCoefficients.tec`    a block per motion j: frequency, then A_ij and B_ij of every force i,
- `ExcitationForce.tec`, `FKForce.tec`    a block per heading: frequency, then modulus and phase (rad) of every force,
- `IRF.tec`                      where asked for: time, then A_inf and memory of every force, a block per motion,
- `Hydrostatics.dat`, `KH.dat`   of one body, `Hydrostatics_0.dat`, `KH_0.dat` and so on of several; in version 3 `Kh`
                                 may lie in `Mechanics`.

Nemoh's time factor is e^{-i w t} (its incident wave is e^{i (k x - w t)}, Babarit and Delhommeau 2015), so that phases
change sign; they refer to the wave at (XEFF, YEFF). Headings are those towards which waves travel, in degrees.
Coefficients are in SI units, moments about the point of the rotation in `Nemoh.cal`. `KH` is stiffness about the
centre of gravity with a weight of rho g V there; depth 0 means deep water. Version 3 can write frequencies in Hz or
periods in s, which the first line of a `.tec` file tells.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from floatsim.errors import ModelError
from floatsim.hydro.conventions import (
    ESTIMATED,
    Array,
    Force,
    body_names,
    from_world_origin,
    in_folder,
    infinite_added_mass,
    numbers,
    ordered_headings,
    text_lines,
    without_weight,
)
from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.nemoh_project import read_static_position

_STANDARD = np.array([(kind, *axis) for kind in (1, 2) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))])


@dataclass(frozen=True)
class Hydrostatics:
    """Of N bodies: volume (N,) m3, centres of buoyancy and gravity (N, 3) m, stiffness (N, 6, 6) as `KH` has it."""

    volume: Array
    centre_of_buoyancy: Array
    centre_of_gravity: Array
    stiffness: Array

    def about(self, reference: Array, weight_density: float) -> Array:
        """Stiffness (6N, 6N) of the water alone about the points `reference` (N, 3); weight_density = rho g, N/m3.

        About the centre of gravity weight does nothing, so that `KH` is the water's. A turn about another point
        moves the waterplane up and down; the arms of buoyancy become those from that point.
        """
        N = len(self.volume)
        out = np.zeros((6 * N, 6 * N))
        for k, (V, G, K) in enumerate(zip(self.volume, self.centre_of_gravity, self.stiffness, strict=True)):
            arm = G - reference[k]
            turn = np.eye(6)
            turn[2, 3:5] = arm[1], -arm[0]  # heave of the centre of gravity per roll and pitch
            block = slice(6 * k, 6 * k + 6)
            out[block, block] = without_weight(turn.T @ K @ turn, np.array([weight_density * V]), arm[None])
        return out


def read_nemoh(
    folder: str | Path, *, bodies: Sequence[str] = (), estimate_added_mass_inf: bool = False
) -> HydroDatabase:
    """Database from a Nemoh folder (or its `Nemoh.cal`), every body with the six rigid motions.

    bodies                   names; default those of the mesh files
    estimate_added_mass_inf  take what A(w) and B(w) imply where there is no `IRF.tec`

    Raises ModelError naming the file for what is missing, cannot be read or does not fit.
    """
    folder = Path(folder).parent if Path(folder).suffix.lower() == ".cal" else Path(folder)
    label = f"Nemoh folder '{folder}'"
    cal = _Cal.read(_need(label, folder, "Nemoh.cal"))
    N = len(cal.points)
    d = 6 * N
    results = in_folder(folder, "results") or folder
    omega, radiation = _table(_need(label, results, "RadiationCoefficients.tec"), d, d)
    mass = radiation[..., 0].transpose(1, 2, 0)  # motion, frequency, force -> frequency, force, motion
    damping = radiation[..., 1].transpose(1, 2, 0)
    headings, take = ordered_headings(cal.headings)
    force = _waves(label, _need(label, results, "ExcitationForce.tec"), omega, cal, d)
    path = in_folder(results, "FKForce.tec")
    froude_krylov = None if path is None else _waves(label, path, omega, cal, d)
    source: dict[str, Any] = {"solver": "Nemoh", "file": folder.name}
    irf = in_folder(results, "IRF.tec")
    if irf is not None:
        mass_inf = _table(irf, d, d)[1][:, 0, :, 0].T
        source["added_mass_inf"] = "IRF.tec of Nemoh"
    else:
        mass_inf = infinite_added_mass(label, omega, mass, damping, estimate_added_mass_inf)
        source["added_mass_inf"] = ESTIMATED
    source |= read_static_position(folder)
    statics = read_hydrostatics(in_folder(folder, "mesh") or folder, N)
    depth = cal.depth or np.inf

    def turned(X: Force) -> Force:
        return from_world_origin(X[:, take].conj(), omega, headings, cal.origin, depth, cal.gravity)

    return HydroDatabase(
        name=folder.resolve().name,
        bodies=body_names(label, bodies or cal.names, N, folder.resolve().name),
        omega=omega,
        added_mass=mass,
        radiation_damping=damping,
        added_mass_inf=mass_inf,
        headings=headings,
        excitation=turned(force),
        froude_krylov=None if froude_krylov is None else turned(froude_krylov),
        hydrostatic_stiffness=statics.about(cal.points, cal.density * cal.gravity),
        volume=statics.volume,
        centre_of_buoyancy=statics.centre_of_buoyancy,
        reference_point=cal.points,
        depth=depth,
        density=cal.density,
        gravity=cal.gravity,
        source=source,
    )


def read_hydrostatics(folder: str | Path, N: int) -> Hydrostatics:
    """`Hydrostatics.dat` and `KH.dat` of one body, or `Hydrostatics_0.dat` ... of N, as Nemoh and Capytaine write them.

    Raises ModelError naming the file for what is missing or cannot be read.
    """
    folder, label = Path(folder), f"hydrostatics in '{folder}'"
    volume, buoyancy, gravity, stiffness = [], [], [], []
    for k in range(N):
        endings = [f"_{k}.dat"] + ([".dat"] if N == 1 else [])
        path = _need(label, folder, *(f"Hydrostatics{ending}" for ending in endings))
        text = "\n".join(text_lines(path))
        centres = re.findall(r"[XYZ]F\s*=\s*(\S+)\s*-\s*[XYZ]G\s*=\s*(\S+)", text)
        displaced = re.search(r"Displacement\s*=\s*(\S+)", text)
        try:
            B, G = np.array(centres, dtype=np.float64).reshape(3, 2).T
            volume.append(float(displaced[1]))  # type: ignore[index]
        except (TypeError, ValueError):
            wanted = "three lines XF = .. - XG = .. and a line Displacement = .."
            raise ModelError(f"'{path}': must have {wanted}") from None
        buoyancy.append(B)
        gravity.append(G)
        names = [f"KH{ending}" for ending in endings]
        mechanics = in_folder(folder.parent, "Mechanics")  # of version 3
        path = (in_folder(mechanics, *names) if mechanics else None) or _need(label, folder, *names)
        rows = [row for row in map(numbers, text_lines(path)) if row]
        if [len(row) for row in rows] != [6] * 6:
            raise ModelError(f"'{path}': must be six rows of six numbers")
        stiffness.append(rows)
    return Hydrostatics(*(np.array(item) for item in (volume, buoyancy, gravity, stiffness)))


# --- the files ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Cal:
    """What `Nemoh.cal` says. headings (m,) rad, points (N, 3) m of the rotations, origin (2,) m of the phases."""

    density: float
    gravity: float
    depth: float
    origin: tuple[float, float]
    names: tuple[str, ...]
    points: Array
    headings: Array

    @classmethod
    def read(cls, path: Path) -> _Cal:
        lines = iter(enumerate(text_lines(path), 1))

        def values(count: int, what: str) -> list[float]:
            number, line = next(lines)
            found = numbers(line.split("!")[0])
            if len(found) < count:
                raise ModelError(f"'{path}', line {number}: {what} expected, found '{line.strip()[:60]}'")
            return found

        try:
            next(lines)
            density, gravity, depth = [values(1, what)[0] for what in ("water density", "gravity", "water depth")]
            x, y = values(2, "XEFF and YEFF")[:2]
            if not (0.0 < density < np.inf and 0.0 < gravity < np.inf and 0.0 <= depth < np.inf):
                raise ModelError(f"'{path}': density and gravity must be positive, depth positive or 0 for deep water")
            next(lines)
            names, points = [], []
            for k in range(int(values(1, "number of bodies")[0])):
                next(lines)
                names.append(Path(next(lines)[1].split("!")[0].strip().replace("\\", "/")).stem)
                next(lines)
                motions, forces = [
                    [values(7, what) for _ in range(int(values(1, f"number of {what}s")[0]))]
                    for what in ("degree of freedom", "force")
                ]
                points.append(_standard(path, k, motions, forces))
                for _ in range(int(values(1, "number of additional lines")[0])):
                    next(lines)
            next(lines)
            values(3, "frequencies")
            count, first, last = values(3, "wave directions")[:3]
            headings = np.radians(np.linspace(first, last, int(count)))
        except StopIteration:
            raise ModelError(f"'{path}': ends too early") from None
        except (OverflowError, ValueError) as error:  # a count that is none
            raise ModelError(f"'{path}': {error}") from None
        unique = tuple(names) if len(set(names)) == len(names) else ()
        return cls(density, gravity, depth, (x, y), unique, np.array(points), headings)


def _standard(path: Path, body: int, motions: list[list[float]], forces: list[list[float]]) -> list[float]:
    """The point all rotations of a body are about; refuses anything but the six rigid motions and their forces."""
    for what, rows in (("degrees of freedom", motions), ("forces", forces)):
        table = np.array([row[:7] for row in rows])
        if table.shape != (6, 7) or not np.array_equal(table[:, :4], _STANDARD):
            raise ModelError(
                f"'{path}': {what} of body {body + 1} must be surge, sway, heave, roll, pitch and yaw, in this order"
            )
        if not np.all(table[3:, 4:] == np.array(motions)[3, 4:7]):
            raise ModelError(f"'{path}': rotations and moments of body {body + 1} must all be about one point")
    return motions[3][4:7]


def _need(label: str, folder: Path, *names: str) -> Path:
    path = in_folder(folder, *names)
    if path is None:
        raise ModelError(f"{label}: there is no '{names[0]}' in '{folder}'")
    return path


def _table(path: Path, d: int, blocks: int) -> tuple[Array, Array]:
    """First column (n,), as rad/s and increasing where it is a frequency, and pairs (blocks, n, d, 2) of a `.tec`."""
    lines = text_lines(path)
    zones: list[list[float]] = []
    for line in lines:
        row = numbers(line)
        if not row:
            zones.append([])
        elif zones:
            zones[-1] += row
    zones = [zone for zone in zones if zone]
    width = 1 + 2 * d
    sizes = {len(zone) for zone in zones}
    if len(zones) != blocks or len(sizes) != 1 or sizes.pop() % width:
        raise ModelError(
            f"'{path}': {blocks} blocks of {width} columns expected ({d // 6} bodies in Nemoh.cal), found "
            f"{len(zones)} blocks of {', '.join(str(len(zone)) for zone in zones[:3])} numbers"
        )
    table = np.array(zones).reshape(blocks, -1, width)
    if not np.all(table[:, :, 0] == table[0, :, 0]):
        raise ModelError(f"'{path}': blocks differ in their first column")
    first = table[0, :, 0]
    unit = re.search(r'"\s*(\w+)', lines[0])
    if unit is not None and unit[1] in ("f", "T"):
        first = 2.0 * np.pi * (first if unit[1] == "f" else 1.0 / first)
    order = np.argsort(first)
    return first[order], table[:, order, 1:].reshape(blocks, -1, d, 2)


def _waves(label: str, path: Path, omega: Array, cal: _Cal, d: int) -> Force:
    """(n, m, d) as Nemoh has them, headings in the order of `Nemoh.cal`."""
    frequencies, table = _table(path, d, len(cal.headings))
    if frequencies.shape != omega.shape or not np.allclose(frequencies, omega, rtol=1e-5):
        raise ModelError(f"{label}: frequencies of '{path.name}' are not those of 'RadiationCoefficients.tec'")
    return np.asarray((table[..., 0] * np.exp(1j * table[..., 1])).swapaxes(0, 1))
