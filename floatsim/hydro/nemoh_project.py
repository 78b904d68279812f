"""A folder for Nemoh 2 and 3 to compute the coefficients of wetted hulls, written by floatsim.

    Nemoh.cal                    water, bodies with six motions and forces about their reference points, frequencies,
                                 headings; the impulse response is asked for, because it brings A at infinity
    BODY.dat                     mesh: `2 0`, numbered corners up to a line of zeros, panels up to a line of zeros. The
                                 lid is part of it: panels at z = 0 make Nemoh 3 remove irregular frequencies
    input_solver.txt             of Nemoh 3: Gauss points, depth of the lid, linear solver
    ID.dat                       of Nemoh 2: the folder to work in
    mesh/Hydrostatics.dat, KH.dat    of the same meshes (_0, _1, ... for several bodies), as for a centre of gravity
                                 at the reference point
    static_position.json         what floatsim knows of the bodies' pose; Nemoh does not read it

Nemoh 3 runs as `preProc FOLDER`, `solver FOLDER`, `postProc FOLDER`.
Nemoh v3.0 user manual (Kurnia and Ducrozet 2022), input files; Babarit and Delhommeau, EWTEC 2015.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from floatsim.errors import CaseError, ModelError
from floatsim.frames import Array
from floatsim.hydro.compute import WetBody
from floatsim.hydro.meshing import Hydrostatics, Mesh, hydrostatics, join, mesh_problems

STATIC = "static_position.json"
_MEMORY_STEP, _MEMORY = 0.1, 60.0  # s, of the impulse response
_NAMES = ("Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw")


def write_nemoh(
    folder: str | Path,
    bodies: Sequence[WetBody],
    omega: Array,
    headings: Array,
    *,
    depth: float,
    density: float,
    gravity: float,
    source: Mapping[str, Any] | None = None,
) -> None:
    """Write the folder. omega (n,) rad/s and headings (m,) rad, evenly spaced, which is what Nemoh.cal can say.

    Raises ModelError for uneven ones and for meshes with problems, CaseError if the folder cannot be written.
    """
    problems = [f"mesh of '{body.name}': {text}" for body in bodies for text in mesh_problems(body.hull, depth)]
    for what, values in (("omega", omega), ("headings", headings)):
        gaps = np.diff(values)
        if gaps.size and np.ptp(gaps) > 1e-6 * np.abs(values).max():
            problems.append(f"{what}: Nemoh takes evenly spaced values only; give START:END:STEP")
    if problems:
        raise ModelError(problems)
    files = {f"{body.name}.dat": _mesh(_whole(body)) for body in bodies}
    files["Nemoh.cal"] = _cal(bodies, omega, headings, depth, density, gravity)
    files["input_solver.txt"] = (
        "2\t! Gauss points along a panel's side, 1 to 4\n"
        "0.001\t! depth of the lid, share of the largest horizontal distance\n"
        "1\t! linear solver: 0 Gauss elimination, 1 LU, 2 GMRES\n"
        "10 1e-5 1000\t! GMRES: restart, tolerance, iterations\n"
    )
    files["ID.dat"] = "1\n.\n"
    files[STATIC] = json.dumps(dict(source or {}), indent=2) + "\n"
    for k, body in enumerate(bodies):
        still = body.hydrostatics or hydrostatics(body.hull, body.reference_point)
        end = f"_{k}.dat" if len(bodies) > 1 else ".dat"
        files[f"mesh/Hydrostatics{end}"] = _hydrostatics(still, body.reference_point, density)
        files[f"mesh/KH{end}"] = _rows(density * gravity * still.stiffness)
    try:
        for name in ("mesh", "results"):
            (Path(folder) / name).mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            (Path(folder) / name).write_text(text, encoding="ascii")
    except OSError as error:
        raise CaseError(f"Nemoh folder '{folder}' cannot be written: {error.strerror}") from None


def read_static_position(folder: str | Path) -> dict[str, Any]:
    """What `write_nemoh` was given as `source`; empty for a folder that floatsim did not write."""
    path = Path(folder) / STATIC
    return dict(json.loads(path.read_text(encoding="ascii"))) if path.is_file() else {}


def _whole(body: WetBody) -> Mesh:
    """Hull and lid, the lid at z = 0."""
    if body.lid is None:
        return body.hull
    return join(body.hull, (body.lid.vertices * (1.0, 1.0, 0.0), body.lid.faces))


def _mesh(mesh: Mesh) -> str:
    corners = [f"{k} {x:.6f} {y:.6f} {z:.6f}" for k, (x, y, z) in enumerate(mesh.vertices + 0.0, 1)]
    panels = [" ".join(str(i + 1) for i in face) for face in mesh.faces]
    return "\n".join(["2 0", *corners, "0 0. 0. 0.", *panels, "0 0 0 0"]) + "\n"


def _cal(bodies: Sequence[WetBody], omega: Array, headings: Array, depth: float, density: float, g: float) -> str:
    lines = [
        "--- Environment ---",
        f"{density:.6g}\t! density [kg/m3]",
        f"{g:.6g}\t! gravity [m/s2]",
        f"{depth if np.isfinite(depth) else 0.0:.6g}\t! water depth [m], 0 for deep water",
        "0. 0.\t! XEFF YEFF: where wave phases are measured [m]",
        "--- Floating bodies ---",
        f"{len(bodies)}\t! number of bodies",
    ]
    for k, body in enumerate(bodies, 1):
        mesh = _whole(body)
        x, y, z = body.reference_point
        lines += [f"--- Body {k} ---", f"{body.name}.dat", f"{len(mesh.vertices)} {len(mesh.faces)}\t! corners, panels"]
        for what in ("degrees of freedom", "forces"):
            lines.append(f"6\t! {what}")
            for i, name in enumerate(_NAMES):
                axis = " ".join("1." if j == i % 3 else "0." for j in range(3))
                point = "0. 0. 0." if i < 3 else f"{x:.6f} {y:.6f} {z:.6f}"
                lines.append(f"{1 + i // 3} {axis} {point}\t! {name}")
        lines.append("0\t! additional lines")
    angles = np.degrees(headings)
    lines += [
        "--- Load cases ---",
        f"1 {omega.size} {omega[0]:.9g} {omega[-1]:.9g}\t! 1: rad/s; number, first and last",
        f"{angles.size} {angles[0]:.9g} {angles[-1]:.9g}\t! headings: number, first and last [deg]",
        "--- Post processing ---",
        f"1 {_MEMORY_STEP:g} {_MEMORY:g}\t! impulse response: yes, step and duration [s]",
        "0\t! pressures",
        "0 0. 180.\t! Kochin function",
        "0 50 400. 400.\t! free surface",
        "0\t! response amplitude operators",
        "1\t! frequencies in the output: rad/s",
        "--- QTF ---",
        "0\t! QTF",
    ]
    return "\n".join(lines) + "\n"


def _hydrostatics(still: Hydrostatics, point: tuple[float, float, float], density: float) -> str:
    centres = [f" {axis}F = {b:.9g} - {axis}G = {p:.9g}" for axis, b, p in zip("XYZ", still.centre, point, strict=True)]
    rest = [("Displacement", still.volume), ("Waterplane area", still.waterplane), ("Mass", density * still.volume)]
    return "\n".join([*centres, *(f" {name} = {value:.9g}" for name, value in rest)]) + "\n"


def _rows(matrix: Array) -> str:
    return "\n".join(" ".join(f"{y:.9e}" for y in row) for row in matrix) + "\n"
