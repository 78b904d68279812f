"""A hydrodynamic database computed with Capytaine (the extra `bem`), for one body or several that interact.

    bodies = [WetBody("float", hull, (0, 0, -0.72), lid), WetBody("spar", ...)]
    compute_database("rm3", bodies, omega, headings, depth=math.inf).write("rm3_hydro.nc")

Meshes come from `floatsim.hydro.meshing` or anywhere else: wetted surface, normals outward, the drawing position. What
is fixed here, because it was measured to matter: the direct (potential) formulation, about ten times more accurate on
the same mesh than the source formulation; lids a little below the waterline against irregular frequencies (not on it,
where the Green function is noisy; half a panel's size is good), all bodies as one mesh, so that only those with a
waterplane need one; A at infinite frequency solved, not extrapolated, and without the lids.

Capytaine's time factor is e^{-i w t}, floatsim's e^{+i w t}: forces are conjugated. Both measure phases from the
origin.
Capytaine: Ancellin and Dias, J. Open Source Softw. 4(36), 1341 (2019).
"""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from floatsim.errors import ModelError
from floatsim.hydro import meshing
from floatsim.hydro.check import check_database
from floatsim.hydro.database import DOF_NAMES, HydroDatabase
from floatsim.hydro.far_field import FarField, FreeFloating, check_motion, far_field, mean_drift, turned
from floatsim.hydro.meshing import Hydrostatics, Mesh
from floatsim.sea.dispersion import wave_number

Array = NDArray[np.float64]

_SHALLOW = 0.145  # least wave number times depth


class WetBody(NamedTuple):
    """name, hull (wetted panels; only the first sector of a symmetric one), reference point (3,) m, lid (the waterplane
    a little below z = 0, normal down) or None if the body is under water, and the hydrostatics of the exact hull where
    the panels are too coarse for them (default: those of the panels)."""

    name: str
    hull: Mesh
    reference_point: tuple[float, float, float]
    lid: Mesh | None = None
    hydrostatics: Hydrostatics | None = None


@dataclass(frozen=True)
class Symmetry:
    """Images of which the meshes given are the first: mirror planes through the z axis ("xOz" y -> -y, "yOz" x -> -x),
    and `turns` copies around it."""

    mirrors: tuple[str, ...] = ()
    turns: int = 1

    def operations(self) -> list[Array]:
        """Orthogonal matrices (3, 3), the identity first, in the order of Capytaine's symmetric meshes."""
        found = [np.eye(3)]
        for plane in self.mirrors:
            mirror = np.diag([1.0, -1.0, 1.0] if plane == "xOz" else [-1.0, 1.0, 1.0])
            found += [mirror @ q for q in found]
        angles = 2.0 * np.pi * np.arange(self.turns) / self.turns
        return [_turn(a) @ q for a in angles for q in found]


def compute_database(
    name: str,
    bodies: Sequence[WetBody],
    omega: Sequence[float] | Array,
    headings: Sequence[float] | Array = (0.0,),
    *,
    depth: float,
    density: float = 1025.0,
    gravity: float = 9.81,
    symmetry: Symmetry | None = None,
    drift: FreeFloating | Literal["fixed"] | None = None,
    source: Mapping[str, Any] | None = None,
    report: Callable[[str], None] | None = None,
) -> HydroDatabase:
    """Added mass, damping, excitation and Froude-Krylov forces of the bodies in each other's presence.

    omega     (n,) rad/s, increasing; in finite depth from wave number times depth 0.145 on
    headings  (m,) rad in [-pi, pi), increasing; those that are images of others under `symmetry` are not solved again
    depth     m, inf for deep water (only there A at zero frequency is computed too)
    symmetry  of all meshes together (each body its own image)
    drift     how the body moves in the waves, for its mean drift in surge, sway and yaw by momentum far away
              (far_field.py; heave, roll and pitch are zero): FreeFloating(mass, ...), without the moorings, or "fixed".
              Of one body only; what it was computed with is kept in `source`. None: no mean drift
    source    kept in the database beside what is known here (solver, mesh hash, panels, errors of symmetry)
    report    called with a line of progress

    A and B are made symmetric (reciprocity; what the panels leave of it is in `source`) and B positive semi-definite
    (what had to be taken away likewise). Raises ModelError if Capytaine is missing, a mesh has gaps or is turned inside
    out, the frequencies are too low for the depth, or a linear system cannot be solved.
    """
    capytaine = load_capytaine()
    symmetry = symmetry or Symmetry()
    omega, headings = np.asarray(omega, dtype=float), np.asarray(headings, dtype=float)
    operations = symmetry.operations()
    hulls = [meshing.images(body.hull, operations) for body in bodies]
    _refuse(bodies, hulls, omega, depth, gravity, drift)
    run = _Run(capytaine, bodies, symmetry, depth, density, gravity)
    wanted = _orbits(headings, operations)
    mass_inf, _ = run.radiation(math.inf)
    mass_zero = run.radiation(0.0)[0] if math.isinf(depth) else None
    A, raw, total, incident, far = _sweep(run, omega, headings, wanted, drift is not None, report)
    whole = [body.hydrostatics or meshing.hydrostatics(hull, body.reference_point) for body, hull in zip(bodies, hulls)]
    length = np.array([h.volume ** (1.0 / 3.0) for h in whole])
    inertia = (density * length[:, None] ** 3 * length[:, None] ** np.array([0, 0, 0, 2, 2, 2])).reshape(-1)
    of_mass, of_damping = _scale(A, inertia), _scale(raw, inertia * np.sqrt(gravity / length.repeat(6)))
    B, clipped = _positive(_symmetric(raw), of_damping)
    errors = {
        "symmetry_error_added_mass": _asymmetry(A, of_mass),
        "symmetry_error_radiation_damping": _asymmetry(raw, of_damping),
        "negative_damping_clipped": clipped,
    }
    of_mass, of_damping = np.outer(of_mass, of_mass), np.outer(of_damping, of_damping)
    hull = Mesh(
        np.concatenate([h.vertices for h in hulls]),
        np.concatenate([h.faces + s for h, s in zip(hulls, np.cumsum([0, *(len(h.vertices) for h in hulls)]))]),
    )
    A, B, X = _tidy(_symmetric(A), of_mass), _tidy(B, of_damping), _tidy_force(np.conj(total))
    C = density * gravity * _block_diagonal([h.stiffness for h in whole])
    pushed: Array | None = None
    how: dict[str, Any] = {}
    if drift is not None:
        pushed, how = _drift(drift, far, wanted, headings, bodies[0], omega, A, B, X, C, depth, density, gravity)
    return HydroDatabase(
        name=name,
        bodies=tuple(body.name for body in bodies),
        omega=omega,
        added_mass=A,
        radiation_damping=B,
        added_mass_inf=_tidy(_symmetric(mass_inf), of_mass),
        added_mass_zero=None if mass_zero is None else _tidy(_symmetric(mass_zero), of_mass),
        headings=headings,
        excitation=X,
        froude_krylov=_tidy_force(np.conj(incident)),
        mean_drift=pushed,
        hydrostatic_stiffness=C,
        volume=np.array([h.volume for h in whole]),
        centre_of_buoyancy=np.array([h.centre for h in whole]),
        reference_point=np.array([body.reference_point for body in bodies]),
        depth=depth,
        density=density,
        gravity=gravity,
        hull_vertices=hull.vertices,
        hull_faces=hull.faces,
        hull_body=np.repeat(np.arange(len(bodies)), [len(h.faces) for h in hulls]) if len(bodies) > 1 else None,
        source={
            **(source or {}),
            "solver": f"Capytaine {capytaine.__version__}",
            "method": "direct (potential formulation), lids below the waterline",
            "panels_hull": len(hull.faces),
            "panels_lid": sum(len(b.lid.faces) for b in bodies if b.lid) * len(operations),
            "mesh_hash": meshing.mesh_hash(hull),
            "headings_solved": len({k for k, _ in wanted}),
            **errors,
            **how,
        },
    )


def write_checked(db: HydroDatabase, path: str | Path) -> None:
    """Print what made the database and what `check_database` says of it; write `path` if it finds no error.

    Raises ModelError with the errors.
    """
    for key, value in db.source.items():
        print(f"{key:34s} {value}")
    findings = check_database(db)
    for finding in findings:
        print(f"{finding.severity:8s} {finding.message}")
    errors = [finding.message for finding in findings if finding.severity == "error"]
    if errors:
        raise ModelError([f"hydrodynamic database '{db.name}' is not written: {text}" for text in errors])
    db.write(path)
    print(f"{path}: {Path(path).stat().st_size / 1e6:.3f} MB")


def load_capytaine() -> Any:
    """The package, quiet. Raises ModelError naming the extra if it is not installed."""
    try:
        import capytaine
    except ImportError:
        raise ModelError(
            "computing a hydrodynamic database needs Capytaine 3, which is not installed: "
            "install floatsim with its extra 'bem' (pip install 'floatsim[bem]')"
        ) from None
    logging.getLogger("capytaine").setLevel(logging.ERROR)
    return capytaine


def _refuse(bodies: Sequence[WetBody], hulls: list[Mesh], omega: Array, depth: float, gravity: float,
            drift: Any) -> None:  # fmt: skip
    names = [body.name for body in bodies]
    if not names or len(set(names)) < len(names):
        raise ModelError(f"bodies are named {names}: at least one is needed, each with a name of its own")
    label = "', '".join(names)
    problems = [f"mesh of '{label}': {text}" for text in meshing.mesh_problems(meshing.join(*hulls), depth)]
    problems += check_motion(drift, names)
    for body, hull in zip(bodies, hulls):
        if body.hydrostatics is None and hull.vertices[:, 2].min() < -depth + 1e-6:
            problems.append(f"'{body.name}' stands on the seabed: its mesh does not tell its hydrostatics, give them")
    if omega.size < 2 or omega[0] <= 0.0 or np.any(np.diff(omega) <= 0.0) or not np.isfinite(omega[-1]):
        problems.append("omega must be at least two finite positive frequencies, increasing")
    elif math.isfinite(depth):
        # documented from 0.1 on; the sum of exponentials it needs is not found below 0.14 (Capytaine 3.0)
        lowest = math.sqrt(_SHALLOW * math.tanh(_SHALLOW) * gravity / depth)
        if omega[0] < lowest:
            problems.append(f"omega starts at {omega[0]:.4g} rad/s; in {depth:g} m of water Capytaine's Green function "
                            f"needs at least {lowest:.4g} rad/s (wave number times depth {_SHALLOW:g})")  # fmt: skip
    if problems:
        raise ModelError(problems)


def _sweep(
    run: _Run,
    omega: Array,
    headings: Array,
    wanted: list[tuple[int, Array]],
    far: bool,
    report: Callable[[str], None] | None,
) -> tuple[Array, Array, NDArray[np.complex128], NDArray[np.complex128], list[FarField]]:
    """A, B (n, d, d), excitation and its Froude-Krylov part (n, m, d) in Capytaine's time factor; where they are asked
    for, the waves far away, scattered from the headings that are solved, in the order of their numbers."""
    start = time.process_time()
    mass, damping, force, waves = [], [], [], []
    numbers = sorted({k for k, _ in wanted})
    for count, w in enumerate(omega, 1):
        run.potentials = [] if far else None
        a, b = run.radiation(float(w))
        solved = {k: run.excitation(float(w), float(headings[k])) for k in numbers}
        mass.append(a)
        damping.append(b)
        force.append([_image(solved[k], q, run.points) for k, q in wanted])
        if far:
            waves.append(run.far_field(float(w), headings[numbers]))
        run.forget()
        if report:
            report(f"{count}/{omega.size} frequencies, {time.process_time() - start:.0f} s")
    both = np.array(force)  # (n, m, 2, d)
    return np.array(mass), np.array(damping), both[:, :, 0], both[:, :, 1], waves


def _drift(motion: FreeFloating | Literal["fixed"], far: list[FarField], wanted: list[tuple[int, Array]],
           headings: Array, body: WetBody, omega: Array, A: Array, B: Array, X: NDArray[np.complex128], C: Array,
           depth: float, density: float, gravity: float) -> tuple[Array, dict[str, Any]]:  # fmt: skip
    """Mean drift (n, m, 6) and what is to be said of it."""
    numbers = sorted({k for k, _ in wanted})
    fields = [(one.radiated, np.array([turned(one.scattered[numbers.index(k)], q) for k, q in wanted])) for one in far]
    how: dict[str, Any] = {"mean_drift_method": "far field: surge, sway and yaw; heave, roll and pitch are zero"}
    xi, damping = np.zeros_like(X), None
    if isinstance(motion, FreeFloating):
        xi, damping = motion.motions(omega, A, B, X, C, gravity), motion.damping
        how |= motion.attributes()
    else:
        how["mean_drift_motions"] = "none, held fixed"
    pushed, how["mean_drift_energy_error"] = mean_drift(
        fields, xi, headings, body.reference_point, omega=omega, k=wave_number(omega, depth, gravity), depth=depth,
        density=density, gravity=gravity, damping=damping,
    )  # fmt: skip
    return _tidy_force(np.asarray(pushed, dtype=complex)).real, how


class _Run:
    """The bodies as one Capytaine body with 6 N rigid degrees of freedom, and its solver."""

    def __init__(self, capytaine: Any, bodies: Sequence[WetBody], symmetry: Symmetry, depth: float, density: float,
                 gravity: float) -> None:  # fmt: skip
        self.capytaine = capytaine
        self.sea = {"water_depth": depth, "rho": density, "g": gravity}
        hull = self._mesh(meshing.join(*(body.hull for body in bodies)), symmetry)
        lids = [body.lid for body in bodies if body.lid is not None]
        owner = np.tile(np.repeat(np.arange(len(bodies)), [len(body.hull.faces) for body in bodies]),
                        len(symmetry.operations()))  # fmt: skip
        dofs = {}
        for k, body in enumerate(bodies):
            arm = (hull.faces_centers - np.array(body.reference_point)) * (owner == k)[:, None]
            for i, dof in enumerate(DOF_NAMES):
                axis = np.eye(3)[i % 3]
                dofs[f"{body.name}__{dof}"] = (
                    np.outer(owner == k, axis) if i < 3 else np.cross(np.broadcast_to(axis, arm.shape), arm)
                ).astype(float)
        self.dofs = tuple(dofs)
        lid = self._mesh(meshing.join(*lids), symmetry) if lids else None
        self.body = capytaine.FloatingBody(mesh=hull, lid_mesh=lid, dofs=dofs, name="bodies")
        # without waves there are no irregular frequencies; in finite depth a lid spoils A_inf by several percent
        self.bare = capytaine.FloatingBody(mesh=hull, dofs=dofs, name="bodies") if lids else self.body
        self.solver = capytaine.BEMSolver(method="direct")
        self.points = np.array([body.reference_point for body in bodies])
        corners = meshing.images(meshing.join(*(body.hull for body in bodies)), symmetry.operations())
        self.corners = corners.vertices[corners.faces]
        self.potentials: list[NDArray[np.complex128]] | None = None  # on the hull, of what is solved, if a list

    def _mesh(self, sector: Mesh, symmetry: Symmetry) -> Any:
        mesh = self.capytaine.Mesh(vertices=sector.vertices, faces=sector.faces)
        for plane in symmetry.mirrors:
            mesh = self.capytaine.ReflectionSymmetricMesh(mesh, plane=plane)
        return self.capytaine.RotationSymmetricMesh(mesh, n=symmetry.turns) if symmetry.turns > 1 else mesh

    def _solve(self, problem: Any, label: str) -> Any:
        from capytaine.green_functions.abstract_green_function import GreenFunctionEvaluationError

        try:
            result = self.solver.solve(problem, keep_details=self.potentials is not None)
        except (GreenFunctionEvaluationError, NotImplementedError, ValueError, ArithmeticError) as error:
            raise ModelError(f"Capytaine could not solve {label}: {error}") from error
        if self.potentials is not None:
            self.potentials.append(np.conj(result.potential[problem.body.hull_mask]))
        return result

    def radiation(self, omega: float) -> tuple[Array, Array]:
        """A and B, (d, d)."""
        mass, damping = np.zeros((2, len(self.dofs), len(self.dofs)))
        body = self.body if 0.0 < omega < math.inf else self.bare
        for j, dof in enumerate(self.dofs):
            problem = self.capytaine.RadiationProblem(body=body, radiating_dof=dof, omega=omega, **self.sea)
            result = self._solve(problem, f"radiation by {dof} at {omega:g} rad/s")
            mass[:, j] = [float(result.added_masses[other]) for other in self.dofs]
            if 0.0 < omega < math.inf:
                damping[:, j] = [float(result.radiation_dampings[other]) for other in self.dofs]
        return mass, damping

    def excitation(self, omega: float, heading: float) -> NDArray[np.complex128]:
        """(2, d): all of it, and the incident wave's (Froude-Krylov) part; e^{-i w t}."""
        problem = self.capytaine.DiffractionProblem(body=self.body, wave_direction=heading, omega=omega, **self.sea)
        scattered = self._solve(problem, f"diffraction at {omega:g} rad/s, heading {heading:g} rad").forces
        incident = self.capytaine.bem.airy_waves.froude_krylov_force(problem)
        return np.array([[scattered[dof] + incident[dof] for dof in self.dofs], [incident[dof] for dof in self.dofs]])

    def far_field(self, omega: float, headings: Array) -> FarField:
        """Waves far away of the potentials kept: radiation first, then diffraction at `headings`."""
        depth, gravity = self.sea["water_depth"], self.sea["g"]
        return far_field(
            self.corners, np.array(self.potentials), headings, self.points[0], omega=omega,
            k=float(wave_number(omega, depth, gravity)), depth=depth, gravity=gravity,
        )  # fmt: skip

    def forget(self) -> None:
        """A cache of Capytaine 3.0 keeps every matrix of a mesh with dihedral symmetry that it has ever seen."""
        from capytaine.tools.block_circulant_matrices import NestedBlockCirculantMatrix

        cached: Any = getattr(NestedBlockCirculantMatrix, "to_BlockCirculantMatrix", None)
        if hasattr(cached, "cache_clear"):
            cached.cache_clear()


def _turn(angle: float) -> Array:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _orbits(headings: Array, operations: list[Array]) -> list[tuple[int, Array]]:
    """For each heading the index of the one that is solved and the operation that turns that into it."""
    direction = np.column_stack([np.cos(headings), np.sin(headings), np.zeros(headings.size)])
    found: dict[int, tuple[int, Array]] = {}
    for k in (int(k) for k in np.argsort(np.abs(headings), kind="stable")):  # nearest to +x first
        solved = (
            (j, q)
            for j in sorted({j for j, _ in found.values()})
            for q in operations
            if np.linalg.norm(q @ direction[j] - direction[k]) < 1e-9
        )
        found[k] = next(solved, (k, np.eye(3)))
    return [found[k] for k in range(headings.size)]


def _image(force: NDArray[np.complex128], q: Array, points: Array | None = None) -> NDArray[np.complex128]:
    """Forces (..., d) under the operation q; moments, about points (N, 3) or the origin, are axial vectors."""
    parts = force.reshape(*force.shape[:-1], -1, 2, 3).copy()
    arms = np.zeros(3) if points is None else points
    parts[..., 1, :] += np.cross(arms, parts[..., 0, :])  # about the origin, which stays
    parts = parts @ q.T
    parts[..., 1, :] *= round(float(np.linalg.det(q)))
    parts[..., 1, :] -= np.cross(arms, parts[..., 0, :])
    return parts.reshape(force.shape)


def _block_diagonal(blocks: list[Array]) -> Array:
    whole = np.zeros((6 * len(blocks), 6 * len(blocks)))
    for k, block in enumerate(blocks):
        whole[6 * k : 6 * k + 6, 6 * k : 6 * k + 6] = block
    return whole


def _symmetric(c: Array) -> Array:
    return 0.5 * (c + np.swapaxes(c, -1, -2))


def _scale(c: Array, floor: Array) -> Array:
    """(d,) roots of the largest diagonal entries, at least of 1 % of `floor` (yaw of a body of revolution has none)."""
    return np.sqrt(np.maximum(np.abs(np.diagonal(c, axis1=1, axis2=2)).max(axis=0), 0.01 * floor))


def _asymmetry(c: Array, s: Array) -> float:
    """Largest difference from the transpose as a share of the diagonal."""
    return float(np.max(np.abs(c - np.swapaxes(c, -1, -2)) / np.outer(s, s)))


def _positive(damping: Array, s: Array) -> tuple[Array, float]:
    """B without negative eigenvalues (in units of its diagonal), and the largest that was taken away."""
    values, vectors = np.linalg.eigh(damping / np.outer(s, s))
    kept = np.einsum("nij,nj,nkj->nik", vectors, np.maximum(values, 0.0), vectors) * np.outer(s, s)
    negative = values[:, 0] < 0.0
    return np.where(negative[:, None, None], kept, damping), float(max(0.0, -values.min()))


def _tidy(c: Array, scale: Array) -> Array:
    """Rounding noise where symmetry says zero becomes zero (and the file smaller)."""
    return np.where(np.abs(c) < 1e-6 * scale, 0.0, c)


def _tidy_force(force: NDArray[np.complex128]) -> NDArray[np.complex128]:
    size = np.abs(force).max(axis=(0, 1)).reshape(-1, 2, 3).max(axis=2).repeat(3)
    parts = [np.where(np.abs(part) < 1e-6 * size, 0.0, part) for part in (force.real, force.imag)]
    return parts[0] + 1j * parts[1]
