"""The hydrodynamic database of a model's floaters, computed where they float: `floatsim hydro compute MODEL.py`.

Statics with everything in the model (moorings, joints, current) find where the bodies with a `Hull` float. The hulls
are cut there at the waterline, lids are put under their waterplanes, and Capytaine, or a Nemoh folder to run elsewhere,
gives the coefficients. The database carries its pose:

- its frame: z = 0 at mean sea level, x along the heading at which the bodies are drawn, origin over or under the first
  body's reference point;
- `reference_point`: where the reference points are, which forces and moments are about;
- in `source`: `static_attitude_deg`, roll, pitch, yaw of each body in that frame (what readers of the file go by);
  `static_position`, its reference point in the model's world; `static_draught`; `drawing_heading_deg`.

A first run has no database yet, and statics do not need one: let `build()` give the body its Hull alone while the file
does not exist, and `PotentialFlow(database=file, hull=hull)` from then on.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from floatsim.errors import CaseError, ModelError, nearest
from floatsim.frames import Array, angles_from_matrix, matrix_from_angles
from floatsim.hydro import meshing
from floatsim.hydro.compute import WetBody, compute_database, load_capytaine
from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.far_field import FreeFloating
from floatsim.hydro.hull import Surface
from floatsim.hydro.meshing import Mesh
from floatsim.hydro.nemoh_project import write_nemoh
from floatsim.model import Model
from floatsim.parts.body import Body
from floatsim.parts.line import Line
from floatsim.sea.dispersion import wave_number
from floatsim.solve.static import solve_static
from floatsim.study.sheet import hulls, potential_flow, static_pose
from floatsim.system.system import System, assemble

PER_WAVE = 6.0  # panels along the shortest wave
LID_DEPTH = 0.5  # of a panel's size


class WetModel(NamedTuple):
    """What is handed to a solver: bodies in the database's frame, what the database says of itself, and messages."""

    bodies: list[WetBody]
    source: dict[str, Any]
    messages: list[str]


def compute_model_database(
    model: Model,
    omega: Sequence[float] | Array,
    headings_deg: Sequence[float] | Array = (0.0,),
    *,
    bodies: Sequence[str] = (),
    name: str = "",
    report: Callable[[str], None] | None = None,
) -> HydroDatabase:
    """Database of the bodies that have a Hull, interacting, at their static position. Needs Capytaine.

    omega         (n,) rad/s, increasing
    headings_deg  (m,) towards which waves travel, from the heading at which the bodies are drawn; any order
    bodies        names, default all bodies with a Hull
    name          of the database, default the model's
    report        called with lines: warnings and progress

    One body that nothing but lines and springs hold has its mean drift computed too, for the motions that it makes
    afloat without them: mass, inertia and centre of mass of the body alone, damping and stiffness those that its
    PotentialFlow adds linearly.

    Raises ModelError for bad input, SolveFailed if there is no static position.
    """
    load_capytaine()
    omega, headings = _frequencies(omega), _headings(headings_deg)
    wet = wet_bodies(model, omega, bodies)
    floaters = _floaters(model, bodies)
    driftless = _no_drift(model, floaters)
    for line in (*wet.messages, *driftless) if report else ():
        report(line)  # type: ignore[misc]
    sea = model.sea
    return compute_database(
        name or model.name, wet.bodies, omega, headings, depth=sea.depth, density=sea.density, gravity=model.gravity,
        drift=None if driftless else _afloat(floaters[0], wet.source["static_attitude_deg"]), source=wet.source,
        report=report,
    )  # fmt: skip


def nemoh_folder(
    model: Model,
    folder: str | Path,
    omega: Sequence[float] | Array,
    headings_deg: Sequence[float] | Array = (0.0,),
    *,
    bodies: Sequence[str] = (),
    report: Callable[[str], None] | None = None,
) -> None:
    """Write what `compute_model_database` would compute as a folder for Nemoh, frequencies and headings evenly spaced.

    Raises ModelError and SolveFailed likewise, and for an existing folder that holds something.
    """
    folder, omega = Path(folder), _frequencies(omega)
    _headings(headings_deg)
    _check_folder(folder)
    wet = wet_bodies(model, omega, bodies)
    for line in wet.messages if report else ():
        report(line)  # type: ignore[misc]
    sea = model.sea
    write_nemoh(
        folder, wet.bodies, omega, np.radians(headings_deg), depth=sea.depth, density=sea.density,
        gravity=model.gravity, source=wet.source,
    )  # fmt: skip


def wet_bodies(model: Model, omega: Array, names: Sequence[str] = ()) -> WetModel:
    """The bodies cut at the waterline of their static position, and what is to be said of their meshes.

    Raises ModelError naming bodies without a hull, drawn at different headings, out of the water or meshed too coarsely
    to see the shortest wave at all; SolveFailed if there is no static position.
    """
    floaters = _floaters(model, names)
    system = _assembled(model)
    state, _ = solve_static(system)
    heading = floaters[0].attitude_deg[2]
    poses = [static_pose(system, state, body) for body in floaters]
    origin = np.array([*poses[0].position[:2], 0.0])
    turn = matrix_from_angles(0.0, 0.0, -math.radians(heading))
    wet, messages, problems = [], _left_out(model, floaters), []
    for body, pose in zip(floaters, poses, strict=True):
        R, (x, y, z) = turn @ pose.R, turn @ (pose.position - origin)
        mesh = meshing.join(*(_panels(hull.surface) for hull in hulls(body)))
        standing = Mesh(mesh.vertices @ R.T + (x, y, z), mesh.faces)
        if standing.vertices[:, 2].min() >= 0.0:
            problems.append(f"body '{body.name}' hangs above the water in static equilibrium: there is nothing to mesh")
            continue
        hull = meshing.wetted(meshing.to_waterline(standing))
        wet.append(WetBody(_name(body), hull, (float(x), float(y), float(z)), _lid(standing, hull)))
        rough, hopeless = _coarse(hull, float(omega[-1]), model)
        (problems if hopeless else messages).extend(f"body '{body.name}': {text}" for text in rough)
    if problems:
        raise ModelError(problems)
    angles = np.degrees([angles_from_matrix(turn @ pose.R) for pose in poses])
    source = {
        "static_attitude_deg": _listed(angles),
        "static_position": _listed([pose.position for pose in poses]),
        "static_draught": _listed([-body.hull.vertices[:, 2].min() for body in wet]),
        "drawing_heading_deg": float(heading),
    }
    return WetModel(wet, source, messages)


def _assembled(model: Model) -> System:
    """The system; a present database that does not fit any more is no reason to keep it."""
    try:
        return assemble(model)
    except ModelError as error:
        if not any(potential_flow(part) for part in model.parts if isinstance(part, Body)):
            raise
        hint = (
            "this is before anything is computed: if it is the present database that does not fit, let build() give "
            "the body its Hull alone (hydro=Hull(...)) and compute again"
        )
        raise ModelError([*error.problems, hint]) from None


def _listed(values: Any) -> list[float]:
    """Flat, as attributes of a file can be."""
    return [float(y) for y in np.round(values, 6).ravel() + 0.0]


def _coarse(hull: Mesh, omega: float, model: Model) -> tuple[list[str], bool]:
    """What is to be said of a mesh too coarse for the wave of `omega` [rad/s], and whether it cannot see it at all."""
    wave = float(2.0 * math.pi / wave_number(omega, model.sea.depth, model.gravity))
    side = _longest_side(hull, 0.5 * wave)
    if side <= wave / PER_WAVE * (1.0 + 1e-9):
        return [], False
    text = (
        f"panels up to {side:.3g} m long; a sixth of the shortest wave, {wave:.3g} m at omega {omega:.3g} rad/s, is "
        f"{wave / PER_WAVE:.3g} m: mesh the hull finer, or end omega at {_highest(side, model):.3g} rad/s"
    )
    return [text], side > 0.5 * wave


def _floaters(model: Model, names: Sequence[str]) -> list[Body]:
    """The bodies to mesh."""
    known = {part.name: part for part in model.parts if isinstance(part, Body)}
    problems = [f"model '{model.name}' has no body '{name}'{nearest(name, known)}" for name in names
                if name not in known]  # fmt: skip
    chosen = [known[name] for name in names if name in known] or list(known.values())
    bare = [body.name for body in chosen if not hulls(body)]
    if names:
        problems += [f"body '{name}' has no Hull: give it Body(hydro=Hull(mesh=...))" for name in bare]
    found = [body for body in chosen if hulls(body)]
    if not found and not problems:
        problems.append(
            f"model '{model.name}' has no body with a Hull, which is what is meshed: give the floater "
            "Body(hydro=Hull(mesh=...)), or PotentialFlow(database=..., hull=Hull(mesh=...))"
        )
    for body in found[1:]:
        psi, other = found[0].attitude_deg[2], body.attitude_deg[2]
        if abs((other - psi + 180.0) % 360.0 - 180.0) > 0.01:
            problems.append(
                f"'{found[0].name}' is drawn at a heading of {psi:g} deg, '{body.name}' at {other:g} deg; the bodies "
                "of one database must be drawn at the same (or compute them one by one)"
            )
    if problems:
        raise ModelError(problems)
    return found


def _left_out(model: Model, floaters: list[Body]) -> list[str]:
    """Bodies that feel waves but have no mesh."""
    others = [part for part in model.parts if isinstance(part, Body) and part not in floaters]
    return [f"body '{body.name}' is not among those computed: it is as if it were not there"
            for body in others if potential_flow(body) or hulls(body)]  # fmt: skip


def _no_drift(model: Model, floaters: list[Body]) -> list[str]:
    """Why the mean drift is left out; empty if it is not."""
    if len(floaters) > 1:
        return ["no mean drift is computed: the waves far away tell that of all bodies together, not of each"]
    body = floaters[0]
    free = {part.name for part in model.parts if isinstance(part, Line)}
    for joint in model.joints:
        tied = {target.split(".")[0] if isinstance(target, str) else "ground" for target in joint.targets()}
        if body.name in tied and tied - {body.name} - free:
            return [f"no mean drift is computed: it is that of a body afloat, and joint '{joint.label}' ties "
                    f"'{body.name}' to something else than a line"]  # fmt: skip
    return []


def _afloat(body: Body, attitude_deg: Sequence[float]) -> FreeFloating:
    """The body's motions without its moorings, in the database's frame."""
    R = matrix_from_angles(*np.radians(attitude_deg))
    flow = potential_flow(body)
    added = [] if flow is None else [np.asarray(flow.linear_damping), np.asarray(flow.linear_stiffness)]
    center = tuple(float(y) for y in R @ body.center_of_mass)
    return FreeFloating(body.mass, center, R @ body.inertia_tensor @ R.T, *(m if m.any() else None for m in added))


def _name(body: Body) -> str:
    """What the database calls the body: as in the one it has, if several share that."""
    flow = potential_flow(body)
    return flow.data.bodies[flow.index] if flow is not None and len(flow.data.bodies) > 1 else body.name


def _panels(surface: Surface) -> Mesh:
    """Faces of four corners: what was given as such and cut in two, put together again; triangles with one twice."""
    f, number = surface.faces, surface.number
    faces = f[:, [0, 1, 2, 2]].copy()
    p, q, same = f[:-1], f[1:], number[1:] == number[:-1]
    ahead = same & (p[:, 0] == q[:, 0]) & (p[:, 2] == q[:, 1])
    back = same & (p[:, 2] == q[:, 2]) & (p[:, 0] == q[:, 1])  # of a mirrored or turned panel
    faces[:-1][ahead, 3] = q[ahead, 2]
    faces[:-1][back] = np.column_stack([q[back, 0], p[back]])
    keep = np.ones(len(f), dtype=bool)
    keep[1:] = ~(ahead | back)
    return Mesh(surface.vertices, faces[keep])


def _lid(standing: Mesh, hull: Mesh) -> Mesh | None:
    """Lid a little below the waterplane, inside the section of the hull at its height; None under water."""
    if standing.vertices[:, 2].max() <= 0.0:
        return None
    size = _size(hull)
    depth = min(LID_DEPTH * size, -0.25 * float(hull.vertices[:, 2].min()))
    section = meshing.wetted(Mesh(standing.vertices + (0.0, 0.0, depth), standing.faces))
    cover = meshing.lid(section, size, 0.0)
    return Mesh(cover.vertices - (0.0, 0.0, depth), cover.faces) if len(cover.faces) else None


def _size(mesh: Mesh) -> float:
    """Mean side of the panels, m."""
    tri = meshing.triangles(mesh)
    area = 0.5 * np.linalg.norm(np.cross(tri[:, 1] - tri[:, 0], tri[:, 2] - tri[:, 0]), axis=1).sum()
    return float(np.sqrt(area / len(mesh.faces)))


def _longest_side(hull: Mesh, depth: float) -> float:
    """Of the panels that reach up to z > -depth; half a wave length down a wave has decayed to e^-pi = 4 %."""
    quad = hull.vertices[hull.faces]
    near = quad[:, :, 2].max(axis=1) > -depth
    sides = np.linalg.norm(np.roll(quad, -1, axis=1) - quad, axis=2)
    return float(sides[near].max()) if near.any() else 0.0


def _highest(side: float, model: Model) -> float:
    """Frequency of the wave that is PER_WAVE sides long, rad/s."""
    k = 2.0 * math.pi / (PER_WAVE * max(side, 1e-9))
    return math.sqrt(model.gravity * k * math.tanh(min(k * model.sea.depth, 50.0)))


def _frequencies(omega: Sequence[float] | Array) -> Array:
    """What `compute_database` says of frequencies, before statics."""
    w = np.asarray(omega, dtype=np.float64).reshape(-1)
    if w.size < 2 or not np.all(np.isfinite(w)) or w[0] <= 0.0 or np.any(np.diff(w) <= 0.0):
        raise ModelError("omega must be at least two finite positive frequencies [rad/s], increasing")
    return w


def _headings(headings_deg: Sequence[float] | Array) -> Array:
    """Radians in [-pi, pi), increasing."""
    h = np.asarray(headings_deg, dtype=np.float64).reshape(-1)
    if h.size < 1 or not np.all(np.isfinite(h)):
        raise ModelError("headings must be at least one finite angle [deg]")
    around = np.unique(np.round((h + 180.0) % 360.0 - 180.0, 9))
    if around.size < h.size:
        raise ModelError("headings: some are the same direction twice (0 and 360 deg are)")
    return np.asarray(np.radians(around))


# --- the command ----------------------------------------------------------------------------------


def steps(text: str, what: str) -> Array:
    """START:END:STEP, both ends included, or values parted by commas. Raises CaseError naming `what`."""
    try:
        if ":" in text:
            start, end, step = (float(word) for word in text.split(":"))
            n = (end - start) / step
            if not (step > 0.0 and 0.0 <= n < 10_000.0):
                raise ValueError
            return np.asarray(start + step * np.arange(math.floor(n + 1e-6) + 1))
        return np.array([float(word) for word in text.split(",")])
    except (ValueError, ZeroDivisionError):
        raise CaseError(
            f"{what}: got '{text}'; write START:END:STEP, as 0.05:3:0.05, or values parted by commas"
        ) from None


def check_target(path: str | Path) -> None:
    """Raises CaseError if a database could not be written there; an older database is replaced."""
    from floatsim.study.store import check_path

    if not _is_database(Path(path)) or not os.access(path, os.W_OK):
        check_path(path)


def _is_database(path: Path) -> bool:
    import netCDF4

    try:
        with netCDF4.Dataset(str(path)) as file:
            return "added_mass" in file.variables
    except (OSError, RuntimeError, ValueError):
        return False


def _check_folder(folder: Path) -> None:
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise CaseError(f"Nemoh folder '{folder}' exists and is not empty; choose another name")
    if not folder.resolve().parent.is_dir():
        raise CaseError(f"Nemoh folder '{folder}': there is no folder '{folder.resolve().parent}'; make it first")


def compute_command(
    load: Callable[[], Model],
    omega: str,
    headings: str,
    output: str | None,
    nemoh: str | None,
    bodies: Sequence[str],
    report: Callable[[str], None],
) -> None:
    """The verb: everything about the request is checked before the model is loaded and solved."""
    from floatsim.hydro.compute import write_checked

    if (output is None) == (nemoh is None):
        raise CaseError("give either -o FILE.nc for a database or --nemoh FOLDER")
    w, angles = _frequencies(steps(omega, "--omega")), steps(headings, "--headings")
    _headings(angles)
    if nemoh is not None:
        _check_folder(Path(nemoh))
        nemoh_folder(load(), nemoh, w, angles, bodies=bodies, report=report)
    elif output is not None:
        check_target(output)
        load_capytaine()
        name = Path(output).stem
        write_checked(compute_model_database(load(), w, angles, bodies=bodies, name=name, report=report), output)
