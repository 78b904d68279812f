"""The equilibrium sheet: what pulls and pushes on every floating body at its drawing position."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from floatsim.errors import SolveFailed
from floatsim.frames import Array, angles_from_matrix, matrix_from_angles
from floatsim.hydro.check import Finding, check_database
from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.floater import FloaterBatch, PotentialFlow, shared_by
from floatsim.hydro.hull import Hull
from floatsim.model import Model
from floatsim.parts.body import Body
from floatsim.parts.line import Line
from floatsim.solve.static import solve_static
from floatsim.system.system import System

_DRAUGHT, _ANGLE = 0.02, 1.0  # share of the draught and degrees by which a pose may differ from its database's


class Pose(NamedTuple):
    """position (3,) m of the reference point and attitude R (3, 3), world axes."""

    position: Array
    R: Array


@dataclass(frozen=True)
class BodySheet:
    """Forces (3,) [N] and moments (3,) [N m] about the reference point, world axes, at the drawing position.

    attached: by lines, joints and springs, in static equilibrium with the body held, and by the current on the body.
    net: of everything.
    heave: expected change of draught [m], net lift over the waterplane stiffness (nan without hydrodynamics).
    stiffness_roll, stiffness_pitch: hydrostatic, weight included [N m/rad].
    """

    name: str
    weight: float
    buoyancy: float
    attached: Array
    net_force: Array
    net_moment: Array
    heave: float
    stiffness_roll: float
    stiffness_pitch: float
    warnings: tuple[str, ...]


def body_sheets(system: System) -> list[BodySheet]:
    """One sheet for every body, with the other parts in static equilibrium around it.

    Raises SolveFailed if they find none.
    """
    model = system.model
    bodies = [part for part in model.parts if isinstance(part, Body)]
    state, _ = solve_static(system, hold=[body.name for body in bodies])
    w = system.work()
    system.load(w, state)
    w.still = True
    system.begin(w, state, 0.0)
    system.evaluate(w)
    return [_sheet(system, model, body, w.r) for body in bodies]


def _sheet(system: System, model: Model, body: Body, r: Array) -> BodySheet:
    unknowns = system.unknowns_of([body.name])
    net = -r[unknowns]
    weight = body.mass * model.gravity
    flow = potential_flow(body)
    rho_g = model.sea.density * model.gravity
    still = [hull.hydrostatics(body.position, body.attitude_deg, density=model.sea.density, gravity=model.gravity)
             for hull in hulls(body)]  # fmt: skip
    buoyancy = rho_g * sum(part.volume for part in still) if still or flow is None else rho_g * flow.volume
    buoyancy += sum(batch.buoyancy(body.name) for batch in system.batches if hasattr(batch, "buoyancy"))
    attached = net[:3] - np.array([0.0, 0.0, buoyancy - weight])
    heave = roll = pitch = float("nan")
    warnings: list[str] = []
    if still:  # statics find where it floats, if it does
        most = rho_g * sum(hull.enclosed_volume for hull in hulls(body))
        if (missing := buoyancy - net[2] - most) > 0.0:
            warnings.append(
                f"sinks: {missing / 1e3:.4g} kN of lift are missing even with its whole hull of {most / rho_g:.4g} m3 "
                "under water (is its scale right?)"
            )
        C = np.sum([part.stiffness for part in still], axis=0)
        roll, pitch = (float(C[k, k] - weight * body.center_of_mass[2]) for k in (3, 4))
        heave = float(net[2] / C[2, 2]) if C[2, 2] > 0.0 else float("nan")
    elif flow is not None:
        C = flow.hydrostatic_stiffness
        roll = float(C[3, 3] - weight * body.center_of_mass[2])
        pitch = float(C[4, 4] - weight * body.center_of_mass[2])
        heave = float(net[2] / C[2, 2]) if C[2, 2] > 0.0 else float("nan")
        hull = _own_vertices(flow)
        draught = buoyancy / C[2, 2] if C[2, 2] > 0.0 else 0.0
        if hull is not None:
            draught = -float(hull[:, 2].min())
        if _jointed(model, body):
            pass  # what is missing alone, a hinge may carry or hold: `cautions` looks at the equilibrium of them all
        elif net[2] < 0.0 and not heave > -draught:
            why = "there is no waterplane to carry them"
            if heave < 0.0:
                why = f"it would float {-heave:.3g} m deeper, more than its draught of {draught:.3g} m"
            warnings.append(
                f"sinks: {-net[2] / 1e3:.4g} kN of lift are missing, {-100.0 * net[2] / buoyancy:.3g} % of the "
                f"buoyancy; {why}"
            )
        elif abs(net[2]) > 0.02 * buoyancy and not C[2, 2] > 0.0:
            warnings.append(f"rises: {net[2] / 1e3:.4g} kN of lift too much, and there is no waterplane to lose it")
        elif abs(net[2]) > 0.02 * buoyancy or abs(heave) > _DRAUGHT * draught:
            way = "deeper" if net[2] < 0.0 else "higher"
            warnings.append(
                f"floats {abs(heave):.3g} m {way} than drawn, at a draught of {draught - heave:.4g} m instead of "
                f"{draught:.4g} m: net lift {net[2] / 1e3:.4g} kN is {100.0 * abs(net[2]) / buoyancy:.2g} % of the "
                "buoyancy; coefficients belong to the drawing position"
            )
        for name, value in (("roll", roll), ("pitch", pitch)):
            if value < 0.0 and not _jointed(model, body):
                warnings.append(f"has negative metacentric stiffness in {name}: {value:.4g} N m/rad; alone it capsizes")
    return BodySheet(body.name, weight, buoyancy, attached, net[:3], net[3:], heave, roll, pitch, tuple(warnings))


def _jointed(model: Model, body: Body) -> bool:
    """Whether a joint ties the body to the ground or to another body."""
    targets = model.targets()
    for joint in model.joints:
        parts = [None if not isinstance(t, str) else targets[t][0] for t in joint.targets()]
        if body in parts and any(p is None or (isinstance(p, Body) and p is not body) for p in parts):
            return True
    return False


def _jointed_warnings(system: System) -> list[str]:
    """Jointed bodies that float elsewhere than drawn, where their coefficients belong."""
    bodies = [part for part in system.model.parts if isinstance(part, Body) and _jointed(system.model, part)]
    found = [(b, flow) for b in bodies if (flow := potential_flow(b)) is not None and flow.hull is None]
    if not found:
        return []
    state, _ = solve_static(system)
    lines = []
    for body, flow in found:
        vertices = _own_vertices(flow)
        rise = float(static_pose(system, state, body).position[2]) - body.position[2]
        if vertices is not None and abs(rise) > _DRAUGHT * -float(vertices[:, 2].min()):
            way = "higher" if rise > 0.0 else "deeper"
            lines.append(
                f"body '{body.name}' floats {abs(rise):.3g} m {way} than drawn, together with what it is jointed to; "
                "coefficients belong to the drawing position"
            )
    return lines


def cautions(system: System) -> list[str]:
    """What a user should hear before any result: floaters that sink or capsize, databases with errors, parts that
    nothing holds."""
    model = system.model
    lines = []
    if model.gravity > 0.0:
        for name in model.loose():
            lines.append(f"'{name}' is tied to nothing that is fixed or floats: it falls and has no static equilibrium")
    floaters = [part for part in model.parts if isinstance(part, Body) and part.water_loads]
    if model.sea.waves is not None and not floaters and not len(system.wet_points):
        lines.append("the sea has waves, but there is no line and no body with hydrodynamics: they act on nothing")
    lines += [line for batch in system.batches if isinstance(batch, FloaterBatch) for line in batch.cautions()]
    if floaters:
        with contextlib.suppress(SolveFailed):  # whoever needs the equilibrium will say so
            lines += [f"body '{sheet.name}' {line}" for sheet in body_sheets(system) for line in sheet.warnings]
            lines += pose_warnings(system) + _jointed_warnings(system)
        for name, finding in database_findings(model):
            if finding.severity == "error":
                lines.append(f"hydrodynamic database of '{name}', {finding.quantity}: {finding.message}")
    return lines


def static_pose(system: System, state: Any, body: Body) -> Pose:
    """Where a body is in a state."""
    w = system.work()
    system.load(w, state)
    place = system.numbering.place(body.name)
    return Pose(w.x[place.point].copy(), w.R[place.rotation].copy())


def pose_warnings(system: System) -> list[str]:
    """Bodies on a hull that float elsewhere than where their database was computed, with both figures.

    Their hydrostatics follow the hull, added mass, damping and diffraction do not. The database's pose is the static
    one that it carries or, if it carries none, the drawing position. Allowed: 2 % of the draught, 1 deg of roll and
    pitch, and between bodies that interact 2 % of the draught. Raises SolveFailed if there is no static position.
    """
    bodies = [part for part in system.model.parts if isinstance(part, Body)]
    found = [(body, flow) for body in bodies if (flow := potential_flow(body)) is not None and flow.hull is not None]
    if not found:
        return []
    state, _ = solve_static(system)
    lines = []
    first: dict[object, tuple[Body, PotentialFlow, Pose]] = {}
    for k, (body, flow) in enumerate(found):
        pose, db = static_pose(system, state, body), flow.data
        angles = db.static_attitude_deg
        drawn = body.attitude_deg if angles is None else angles[flow.index]
        height = float(db.reference_point[flow.index, 2])
        was = Pose(np.array([0.0, 0.0, height]), matrix_from_angles(*np.radians(drawn)))
        now, then = _figures(body, pose), _figures(body, was)
        off = np.abs(now[1:] - then[1:]) > [_DRAUGHT * then[0], _ANGLE, _ANGLE]
        name = f"hydrodynamic database '{db.name}'"
        if off.any():
            lines.append(
                f"body '{body.name}' floats at {_said(now)}; its {name} was computed at {_said(then)}: added mass, "
                "damping and diffraction are those of another wetted hull (compute them anew: floatsim hydro compute)"
            )
        start, other, start_pose = first.setdefault(shared_by(flow, k), (body, flow, pose))
        psi = np.radians(start.attitude_deg[2])
        want = matrix_from_angles(0.0, 0.0, psi) @ (db.reference_point[flow.index] - db.reference_point[other.index])
        got = pose.position - start_pose.position
        if np.linalg.norm((got - want)[:2]) > max(_DRAUGHT * then[0], 0.01):
            lines.append(
                f"body '{body.name}' floats ({got[0]:.4g}, {got[1]:.4g}) m from '{start.name}', horizontally; in "
                f"{name} it is ({want[0]:.4g}, {want[1]:.4g}) m: their interaction is that of another layout"
            )
    return lines


def _figures(body: Body, pose: Pose) -> Array:
    """Draught and height of the reference point [m], roll and pitch [deg]."""
    low = min(float((hull.surface.vertices @ pose.R[2]).min()) for hull in hulls(body)) + pose.position[2]
    roll, pitch, _ = np.degrees(angles_from_matrix(pose.R))
    return np.array([-low, pose.position[2], roll, pitch])


def _said(figures: Array) -> str:
    roll, pitch = np.round(figures[2:], 2) + 0.0  # no minus zero
    return (
        f"a draught of {figures[0]:.4g} m (reference point at z = {figures[1]:.4g} m, roll {roll:.2f}, pitch "
        f"{pitch:.2f} deg)"
    )


def dof_table(system: System) -> list[tuple[str, str, int, int]]:
    """(name, kind, points, rotations) of every part, and (name, kind, constraint rows, 0) of every joint."""
    rows = [(p.name, type(p).__name__, p.n_points, p.n_rotations) for p in system.model.parts]
    for joint in system.model.joints:
        rows.append((joint.label, type(joint).__name__, system.joint_rows[joint.label].n, 0))
    return rows


def potential_flow(body: Body) -> PotentialFlow | None:
    """The body's linear hydrodynamics, if it has any."""
    return next((load for load in body.water_loads if isinstance(load, PotentialFlow)), None)


def hulls(body: Body) -> list[Hull]:
    """The meshes that nonlinear hydrostatics of the body work on, its own or its potential flow's."""
    loads = (getattr(load, "hull", None) or load for load in body.water_loads)
    return [load for load in loads if isinstance(load, Hull)]


def _own_vertices(flow: PotentialFlow) -> Array | None:
    """Vertices (p, 3) of the body's own panels, if the database has them."""
    db = flow.data
    if db.hull_vertices is None or db.hull_faces is None or len(db.bodies) == 1:
        return db.hull_vertices
    return None if db.hull_body is None else db.hull_vertices[np.unique(db.hull_faces[db.hull_body == flow.index])]


def database_findings(model: Model) -> list[tuple[str, Finding]]:
    """What the sanity checks say of every hydrodynamic database: names of the bodies that share it, finding."""
    flows = [(body.name, flow) for body in model.parts
             if isinstance(body, Body) and (flow := potential_flow(body)) is not None]  # fmt: skip
    shared: dict[object, tuple[list[str], HydroDatabase]] = {}
    for k, (name, flow) in enumerate(flows):
        shared.setdefault(shared_by(flow, k), ([], flow.data))[0].append(name)
    return [(", ".join(names), finding) for names, db in shared.values() for finding in check_database(db)]


def memory_notes(system: System) -> list[str]:
    """Per floater how well its radiation memory gives back the database it was made from."""
    return [note for batch in system.batches if isinstance(batch, FloaterBatch) for note in batch.notes()]


def line_notes(model: Model) -> list[str]:
    """Per line what was resolved at build: element length, axial damping, wet weight."""
    rho, g = model.sea.density, model.gravity
    notes = []
    for line in model.parts:
        if isinstance(line, Line):
            for piece in line.pieces:
                sec, l0 = piece.section, piece.length / piece.elements
                notes.append(
                    f"{line.name}: {piece.elements} elements of {l0:.4g} m of '{sec.name}', axial damping "
                    f"{sec.damping(l0):.4g} N s, weight in water {sec.wet_weight(rho, g):.4g} N/m"
                )
    return notes
