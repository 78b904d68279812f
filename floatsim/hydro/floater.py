"""Linear potential-flow loads on floaters, and the quadratic damping that goes with them.

In the horizontal frame at the body's mean heading (the drawing heading), origin at the displaced
reference point, with nu = (v, w), xi = (displacement, tilt and yaw) and u the current:

    F = (0, 0, rho g V0, rho g V0 y_B0, -rho g V0 x_B0, 0)        constant buoyancy wrench
      - (C + K_add) xi                                           C = waterplane + rho g V z_B, no weight
      - A_inf nu' - B_add nu - B_quad |nu - u| (nu - u)          row i: sum_j B_ij |nu_j| nu_j
      - int K(tau) nu(t - tau) dtau + Re sum X a e^{i(w t + ...)} + drift

(Cummins 1962; hydrostatics: the buoyancy wrench stays at the displaced reference point and V z_B stands
in C, so that a surge changes no moment and nothing is counted twice.) Simplifications that are the
field's habit: coefficients at the drawing position, excitation and drift there too or at the slow position
(wave_loads.py), no velocity-product terms of the added mass, C xi linear in tilt and yaw. Weight acts on the body's
mass, at any angle.

Floaters whose descriptions share one database of N bodies feel each other's waves: A_inf and K are then (6N, 6N), nu
and F those of all of them, one after the other, in the frame of their common heading. They must be drawn as far from
each other as in the database; as they move, the coefficients stay those of the drawing positions.

With `hull` the buoyancy wrench, C and the Froude-Krylov part of X are left out: the mesh brings them, nonlinear. The
database may then be one computed where the body floats (it carries its pose): A, B and diffraction are about the
displaced reference point, wherever it was drawn.

Tilt and yaw: the body yaws first, then tilts by an angle about one horizontal axis, the tilt vector. For small angles
that is the rotation vector; but the rotation vector of a body yawed by psi and tilted lies psi/2 off the axis of the
tilt. A restoring moment along it drives roll by pitch and pitch by minus roll: a damping ratio of -psi/4 for a body
as stiff in roll as in pitch, where the moment along the tilt has a potential.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from floatsim.description import Description, Matrix6, Positive
from floatsim.errors import ModelError, nearest
from floatsim.frames import Array, cross, turn_quaternion, unit
from floatsim.hydro.database import HydroDatabase, require_match
from floatsim.hydro.excitation import Excitation
from floatsim.hydro.mean_surface import with_froude_krylov
from floatsim.hydro.qtf import QTF
from floatsim.hydro.radiation import RadiationKernel
from floatsim.hydro.state_space import StateSpace
from floatsim.hydro.wave_loads import WaveLoads
from floatsim.jit import kernel
from floatsim.laws.angle import half_angle_squared
from floatsim.parts.part import Output, Part
from floatsim.sea.dispersion import wave_number
from floatsim.sea.waves import Realisation

Index = NDArray[np.int64]

MAX_MEMORY = 100_000  # intervals of the radiation memory; more is a slip of the pen
ZERO6: tuple[tuple[float, ...], ...] = tuple((0.0,) * 6 for _ in range(6))


class PotentialFlow(Description):
    """First-order hydrodynamics of a body. Give it to `Body(hydro=...)`.

    database: a HydroDatabase or the path of its netCDF file, about the body's reference point. body: name or index of
    this body in it, needed if it holds several; those share the database in the model as well, and interact.
    displaced_volume [m3]: at the drawing position, default the database's. linear_damping,
    quadratic_damping, linear_stiffness: 6 x 6, rows surge..yaw, added to the potential-flow terms.
    radiation: "convolution" with `memory` [s] of past on a grid of `memory_grid` [s], or "state_space", exponentials
    fitted to the database. The default grid is 0.1 s or, if that is finer, a sixteenth of sqrt(V^(1/3)/g) of the
    database's smallest body, the memory 60 s or 1200 such intervals: waves that a small body makes are short.
    hull: a mesh whose nonlinear Froude-Krylov and hydrostatic pressure replaces the linear ones (`floatsim.Hull`).
    drift: second-order wave forces, "newman" (from the database's mean drift), a QTF (`read_wamit_qtf`), or a tuple of
    a difference and a sum. slow_position: wave loads at the body's low-passed horizontal position and heading instead
    of the drawing position. With a hull, whose Froude-Krylov forces go with the body, the default is to follow the
    position, not the heading: diffraction that stayed behind would have another phase.
    """

    database: Any
    body: Any = None
    displaced_volume: Positive | None = None
    linear_damping: Matrix6 = ZERO6  # type: ignore[assignment]
    quadratic_damping: Matrix6 = ZERO6  # type: ignore[assignment]
    linear_stiffness: Matrix6 = ZERO6  # type: ignore[assignment]
    radiation: Literal["convolution", "state_space"] = "convolution"
    memory: Positive | None = None
    memory_grid: Positive | None = None
    hull: Any = None
    drift: Any = None
    slow_position: bool | None = None

    def model_post_init(self, context: Any) -> None:
        if not isinstance(self.database, HydroDatabase | str | Path):
            raise ModelError(
                f"PotentialFlow: database: got {self.database!r}; must be a HydroDatabase or the path of a file"
            )
        # a file that cannot be read is reported where it is named, nonsense in it as well
        broken = [name for name, value in vars(self.data).items()
                  if isinstance(value, np.ndarray) and not np.isfinite(value).all()]  # fmt: skip
        if broken:
            raise ModelError(f"hydrodynamic database '{self.data.name}': NaN or infinity in {', '.join(broken)}")
        if self.body is None and len(self.data.bodies) > 1:
            raise ModelError(
                f"PotentialFlow: hydrodynamic database '{self.data.name}' holds {len(self.data.bodies)} bodies, "
                f"{_quoted(self.data.bodies)}; say which one this is: body=\"{self.data.bodies[0]}\""
            )
        _ = self.index  # refuses what the database does not have
        if self.radiation == "state_space" and (self.memory is not None or self.memory_grid is not None):
            raise ModelError("PotentialFlow: memory and memory_grid belong to radiation='convolution'; leave them out")
        if self.hull is not None and self.displaced_volume is not None:
            raise ModelError("PotentialFlow: displaced_volume: with a hull its mesh displaces the water; leave it out")
        past, grid = self.remembered
        if past / grid > MAX_MEMORY:
            raise ModelError(
                f"PotentialFlow: memory of {past:g} s on a grid of {grid:g} s has more than "
                f"{MAX_MEMORY} intervals; 60 s and 0.1 to 0.2 s are usual"
            )
        for item in self.drifts:
            if not (isinstance(item, QTF) or isinstance(item, str) and item == "newman"):
                raise ModelError(
                    f"PotentialFlow: drift: got {item!r}; 'newman', a QTF (read_wamit_qtf), a tuple of a difference "
                    "and a sum, or None is allowed"
                )
        if self.hull is not None and not hasattr(self.hull, "attached_to"):
            raise ModelError(f"PotentialFlow: hull: got {self.hull!r}; a floatsim.Hull or None is allowed")
        if self.hull is not None and self.data.froude_krylov is None:
            raise ModelError(
                f"PotentialFlow: hull: hydrodynamic database '{self.data.name}' does not have the Froude-Krylov part "
                "of its excitation by itself, which the pressure on the hull replaces; take a database with "
                "froude_krylov or with the panels of its hull, or leave hull out"
            )

    @cached_property
    def data(self) -> HydroDatabase:
        """The database itself; for a hull with the Froude-Krylov part, from its panels if it lacks it."""
        db = self.database if isinstance(self.database, HydroDatabase) else HydroDatabase.read(self.database)
        return with_froude_krylov(db) if self.hull is not None and db.hull_faces is not None else db

    @property
    def remembered(self) -> tuple[float, float]:
        """Length of the radiation memory and its grid [s]."""
        small = math.sqrt(float(self.data.volume.min()) ** (1.0 / 3.0) / self.data.gravity)
        grid = min(0.1, small / 16.0)
        return self.memory or min(60.0, 1200.0 * grid), self.memory_grid or grid

    @property
    def drifts(self) -> tuple[Any, ...]:
        """Second-order forces, none, one or several."""
        if isinstance(self.drift, tuple | list):
            return tuple(self.drift)
        return () if self.drift is None else (self.drift,)

    @cached_property
    def index(self) -> int:
        """Which of the database's bodies this is."""
        known = self.data.bodies
        if self.body is None:
            return 0
        if isinstance(self.body, str) and self.body not in known:
            raise ModelError(
                f"PotentialFlow: hydrodynamic database '{self.data.name}' has no body '{self.body}'"
                f"{nearest(self.body, known)}"
            )
        return self.data.index(self.body)

    @property
    def followed(self) -> bool:
        """Whether waves meet the body at its slow position."""
        return self.hull is not None if self.slow_position is None else self.slow_position

    @property
    def turns(self) -> bool:
        """Whether they meet it at its slow heading, too."""
        return bool(self.slow_position)

    @property
    def finds_pose(self) -> bool:
        """Whether statics on a hull find the position that the database was computed at, however the body is drawn."""
        return self.hull is not None and self.data.static_attitude_deg is not None

    def files(self) -> list[str | Path]:
        """Files its numbers come from."""
        own = [] if isinstance(self.database, HydroDatabase) else [self.database]
        own += [item.file for item in self.drifts if isinstance(item, QTF) and item.file is not None]
        return own + (list(self.hull.files()) if self.hull is not None else [])

    @property
    def volume(self) -> float:
        """Displaced volume at the drawing position [m3]."""
        return self.displaced_volume if self.displaced_volume is not None else float(self.data.volume[self.index])

    @property
    def hydrostatic_stiffness(self) -> Array:
        """The database's for this body, (6, 6): waterplane + rho g V z_B, without weight."""
        return self.data.hydrostatic_stiffness[self.rows, self.rows]

    @property
    def rows(self) -> slice:
        """This body's six degrees of freedom in the database."""
        return slice(6 * self.index, 6 * self.index + 6)

    def attached_to(self, body: Any) -> list[Part]:
        """The parts that carry these loads."""
        own: list[Part] = [Floater(name=f"{body.name}.hydro", body=body, flow=self)]
        return own + (list(self.hull.attached_to(body)) if self.hull is not None else [])


def _quoted(names: Iterable[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)


class Floater(Part):
    """The hydrodynamic loads of one body."""

    name: str
    body: Any
    flow: PotentialFlow

    @staticmethod
    def batch() -> type[FloaterBatch]:
        return FloaterBatch


@kernel
def floater_loads(x, q, v, a, u, c, where, P, matrices, pairs, coupling, external, slots, Y, L, K, A, r, s):  # type: ignore[no-untyped-def]
    """Loads of every floater.

    where (n, 2): point, rotation. P (n, 12): cos and sin of the mean heading, drawing position (3),
    drawing quaternion (4), buoyancy [N], its moments (2). matrices (n, 3, 6, 6): C + K_add, B_add, B_quad.
    pairs (k, 2): floater that feels, floater that moves; coupling (k, 2, 6, 6): A_inf, memory tangent; slots (k, 36).
    external (n, 6): wave force plus the past's share of the memory.
    Scratch: Y (5, n, 6): displacement, velocity, acceleration, velocity through the water, force;
    L (n, 3, 3), K (6, 6).
    """
    n_point = x.shape[0]
    base = 3 * n_point
    for b in range(where.shape[0]):
        p, k = where[b, 0], where[b, 1]
        co, si = P[b, 0], P[b, 1]
        dp, dr = 3 * p, base + 3 * k
        xi, nu, rel, f = Y[0, b], Y[1, b], Y[3, b], Y[4, b]
        back = (P[b, 5], -P[b, 6], -P[b, 7], -P[b, 8])
        phi = _tilt_and_yaw(_product((q[k, 0], q[k, 1], q[k, 2], q[k, 3]), back), L[b])
        d = (x[p, 0] - P[b, 2], x[p, 1] - P[b, 3], x[p, 2] - P[b, 4])
        _to_heading(co, si, d, phi, xi)
        _to_heading(co, si, (v[dp], v[dp + 1], v[dp + 2]), (v[dr], v[dr + 1], v[dr + 2]), nu)
        _to_heading(co, si, (a[dp], a[dp + 1], a[dp + 2]), (a[dr], a[dr + 1], a[dr + 2]), Y[2, b])
        _to_heading(co, si, (u[p, 0], u[p, 1], u[p, 2]), (0.0, 0.0, 0.0), rel)
        for m in range(6):
            rel[m] = nu[m] - rel[m]
        for m in range(6):
            y = external[b, m]
            for n in range(6):
                y -= matrices[b, 0, m, n] * xi[n] + matrices[b, 1, m, n] * nu[n]
                y -= matrices[b, 2, m, n] * abs(rel[n]) * rel[n]
            f[m] = y
    for i in range(pairs.shape[0]):
        f, nu, acc = Y[4, pairs[i, 0]], Y[1, pairs[i, 1]], Y[2, pairs[i, 1]]
        for m in range(6):
            y = 0.0
            for n in range(6):
                y += coupling[i, 0, m, n] * acc[n] + coupling[i, 1, m, n] * nu[n]
            f[m] -= y
    for b in range(where.shape[0]):
        p, k = where[b, 0], where[b, 1]
        co, si = P[b, 0], P[b, 1]
        f = Y[4, b]
        s[p] += abs(f[0]) + abs(f[1]) + abs(f[2]) + P[b, 9]
        s[n_point + k] += abs(f[3]) + abs(f[4]) + abs(f[5]) + abs(P[b, 10]) + abs(P[b, 11])
        f[2] += P[b, 9]
        f[3] += P[b, 10]
        f[4] += P[b, 11]
        for h in range(2):
            o = 3 * p if h == 0 else base + 3 * k
            r[o] -= co * f[3 * h] - si * f[3 * h + 1]
            r[o + 1] -= si * f[3 * h] + co * f[3 * h + 1]
            r[o + 2] -= f[3 * h + 2]
    if c[6] != 0.0:
        for i in range(pairs.shape[0]):
            _tangent(pairs[i, 0], pairs[i, 1], c, P, matrices, coupling[i], Y[3], Y[4, 0], L, K)
            for m in range(6):
                for n in range(6):
                    A[slots[i, 6 * m + n]] += K[m, n]


@kernel
def _tangent(b, o, c, P, matrices, coupling, rel, f, L, K):  # type: ignore[no-untyped-def]
    """K (6, 6): force on floater b by a unit change of floater o's world coordinates, their rates, accelerations."""
    AM, WM, CM, BM, QM = coupling[0], coupling[1], matrices[b, 0], matrices[b, 1], matrices[b, 2]
    co, si = P[b, 0], P[b, 1]
    for j in range(6):
        e = unit(j % 3)
        h = 3 * (j // 3)
        # as seen in the heading frame
        t0, t1, t2 = P[o, 0] * e[0] + P[o, 1] * e[1], -P[o, 1] * e[0] + P[o, 0] * e[1], e[2]
        for m in range(6):
            f[m] = (
                (c[0] * AM[m, h] + c[1] * WM[m, h]) * t0
                + (c[0] * AM[m, h + 1] + c[1] * WM[m, h + 1]) * t1
                + (c[0] * AM[m, h + 2] + c[1] * WM[m, h + 2]) * t2
            )
        if b == o:
            g = e if j < 3 else (L[b, 0, j - 3], L[b, 1, j - 3], L[b, 2, j - 3])
            g0, g1, g2 = co * g[0] + si * g[1], -si * g[0] + co * g[1], g[2]
            for m in range(6):
                f[m] += c[2] * (CM[m, h] * g0 + CM[m, h + 1] * g1 + CM[m, h + 2] * g2) + c[1] * (
                    (BM[m, h] + 2.0 * QM[m, h] * abs(rel[b, h])) * t0
                    + (BM[m, h + 1] + 2.0 * QM[m, h + 1] * abs(rel[b, h + 1])) * t1
                    + (BM[m, h + 2] + 2.0 * QM[m, h + 2] * abs(rel[b, h + 2])) * t2
                )
        for h2 in range(2):
            K[3 * h2, j] = co * f[3 * h2] - si * f[3 * h2 + 1]
            K[3 * h2 + 1, j] = si * f[3 * h2] + co * f[3 * h2 + 1]
            K[3 * h2 + 2, j] = f[3 * h2 + 2]


@kernel
def _tilt_and_yaw(q, rates):  # type: ignore[no-untyped-def]
    """(tilt x, tilt y, yaw) of a rotation (unit quaternion, 4-tuple): a yaw, then a tilt about a horizontal axis.

    rates (3, 3): column j is their change when the rotation is turned about world axis j. With n = R e_z at the angle
    theta to e_z, tilt = theta/sin(theta) e_z x n; turning by e changes n by e x n, yaw by e . (e_z + n)/(1 + n_z).
    """
    w, x, y, z = q
    if w < 0.0:
        w, x, y, z = -w, -x, -y, -z
    n = (2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y))
    sine = max(math.sqrt(n[0] * n[0] + n[1] * n[1]), 1e-9)  # upside down there is no axis of the tilt
    f, slope = half_angle_squared(n[2], sine * sine)  # f = -theta/sin(theta), slope = df/dn_z
    for j in range(3):
        d = cross(unit(j), n)
        rates[0, j] = f * d[1] + slope * d[2] * n[1]
        rates[1, j] = -f * d[0] - slope * d[2] * n[0]
        rates[2, j] = (n[j] + (1.0 if j == 2 else 0.0)) / max(1.0 + n[2], 1e-9)
    return (f * n[1], -f * n[0], 2.0 * math.atan2(z, w))


@kernel
def _horizontal(x, q, where, P, b, L, out):  # type: ignore[no-untyped-def]
    """out (3,): world x, y and yaw from the drawing heading of floater b; L (3, 3): scratch."""
    p, k = where[b, 0], where[b, 1]
    back = (P[b, 5], -P[b, 6], -P[b, 7], -P[b, 8])
    out[0], out[1] = x[p, 0], x[p, 1]
    out[2] = _tilt_and_yaw(_product((q[k, 0], q[k, 1], q[k, 2], q[k, 3]), back), L)[2]


@kernel
def _product(a, b):  # type: ignore[no-untyped-def]
    """Quaternion product a b."""
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    )


@kernel
def _to_heading(co, si, p, w, out):  # type: ignore[no-untyped-def]
    """Linear and angular part from world axes into the heading frame."""
    out[0], out[1], out[2] = co * p[0] + si * p[1], -si * p[0] + co * p[1], p[2]
    out[3], out[4], out[5] = co * w[0] + si * w[1], -si * w[0] + co * w[1], w[2]


class Group(NamedTuple):
    """Floaters that interact, in the order of their database; places of the first of them among all floaters, and of
    the first of their pairs among all pairs."""

    parts: tuple[Floater, ...]
    first: int
    pair: int

    @property
    def db(self) -> HydroDatabase:
        return self.parts[0].flow.data

    @property
    def members(self) -> slice:
        return slice(self.first, self.first + len(self.parts))

    @property
    def names(self) -> str:
        return ", ".join(part.body.name for part in self.parts)


def shared_by(flow: PotentialFlow, number: int) -> object:
    """What is equal for descriptions whose bodies interact; `number` if this one's does not with any other."""
    if len(flow.data.bodies) == 1:
        return number
    source = flow.database
    return (id(source),) if isinstance(source, HydroDatabase) else str(Path(source).resolve())


def interacting(parts: Sequence[Floater]) -> list[Group]:
    """Floaters by shared database; a database of one body stands for itself wherever it is used.

    Raises ModelError if bodies of a database are missing or used twice, if they are drawn otherwise than in the
    database, or if their memories differ.
    """
    found: dict[Any, list[Floater]] = {}
    for k, part in enumerate(parts):
        found.setdefault(shared_by(part.flow, k), []).append(part)
    problems: list[str] = []
    groups, first, pair = [], 0, 0
    for members in found.values():
        problems += _misfits(members)
        groups.append(Group(tuple(sorted(members, key=lambda part: part.flow.index)), first, pair))
        first += len(members)
        pair += len(members) ** 2
    if problems:
        raise ModelError(problems)
    return groups


def _misfits(members: list[Floater]) -> list[str]:
    """Why these floaters are not the bodies of their database."""
    db = members[0].flow.data
    label = f"hydrodynamic database '{db.name}'"
    problems = []
    for k, name in enumerate(db.bodies):
        users = [part.body.name for part in members if part.flow.index == k]
        if not users:
            problems.append(
                f"{label}: no body of the model is its '{name}'; its {len(db.bodies)} bodies, {_quoted(db.bodies)}, "
                "interact and must all be there, with the same database, one path or one object (with this one the "
                f"model has {_quoted(part.body.name for part in members)})"
            )
        elif len(users) > 1:
            problems.append(
                f"{label}: {_quoted(users)} are all its body '{name}'; each of its bodies is one body of the model "
                "(for another set of the same bodies read the file again as a HydroDatabase)"
            )
    start = members[0]
    for part in members[1:]:
        mine, its = (
            (p.flow.radiation, *(p.flow.remembered if p.flow.radiation == "convolution" else ()))
            for p in (start, part)
        )
        if mine != its:
            problems.append(
                f"{label}: '{start.body.name}' has radiation (method, memory, memory_grid) {mine}, "
                f"'{part.body.name}' {its}; bodies that interact have one memory, so they must be the same"
            )
        problems += _misplaced(label, db, start, part)
    return problems


def _misplaced(label: str, db: HydroDatabase, start: Floater, part: Floater) -> list[str]:
    """What is wrong with where `part` is drawn, seen from `start`."""
    psi, other = start.body.attitude_deg[2], part.body.attitude_deg[2]
    if abs((other - psi + 180.0) % 360.0 - 180.0) > 0.01:
        return [
            f"{label}: '{start.body.name}' is drawn at a heading of {psi:g} deg, '{part.body.name}' at {other:g} deg; "
            "the bodies of one database must be drawn at the same"
        ]
    i, k = start.flow.index, part.flow.index
    co, si = math.cos(math.radians(psi)), math.sin(math.radians(psi))
    x, y = (db.reference_point[k] - db.reference_point[i])[:2]
    want = np.array([co * x - si * y, si * x + co * y])
    got = np.subtract(part.body.position, start.body.position)[:2]
    if i == k or np.linalg.norm(got - want) <= 0.01 or start.flow.finds_pose and part.flow.finds_pose:
        return []
    return [
        f"{label}: '{part.body.name}' is drawn ({got[0]:.6g}, {got[1]:.6g}) m from '{start.body.name}', horizontally; "
        f"in the database its reference point, {_point(db.reference_point[k])} m, is ({want[0]:.6g}, {want[1]:.6g}) m "
        f"from the other's, {_point(db.reference_point[i])} m"
        + (f", turned by {psi:g} deg" if psi else "")
        + " (allowed difference 0.01 m); draw them so, or compute a database for this layout"
    ]


def _point(p: Array) -> str:
    return "(" + ", ".join(f"{y:.6g}" for y in p) + ")"


class FloaterBatch:
    """Hydrodynamic loads of all floaters, with their radiation memories."""

    runs: ClassVar[list[tuple[int, int]]] = []
    remembers: ClassVar[bool] = True

    def __init__(self, parts: Sequence[Floater], first_point: Sequence[int], first_rotation: Sequence[int],
                 sea: Any, gravity: float) -> None:  # fmt: skip
        self.groups = interacting(parts)
        self.parts = tuple(part for group in self.groups for part in group.parts)
        n = len(self.parts)
        self._sea, self._gravity = sea, gravity
        self.matrices = np.zeros((n, 3, 6, 6))
        self.P = np.zeros((n, 12))
        self.external = np.zeros((n, 6))
        self.past = np.zeros((n, 6))  # the past's share of the memory in it
        self.pairs = np.array(
            [(b, o) for group in self.groups for b in _range(group) for o in _range(group)], dtype=np.int64
        )
        self.coupling = np.zeros((len(self.pairs), 2, 6, 6))
        self.waves: list[WaveLoads | None] = []
        self.drift = np.zeros((n, 6))  # second-order forces during the step
        waves = None if sea.waves is None else sea.waves.realise(sea.depth, gravity)
        for b, part in enumerate(self.parts):
            body, flow = part.body, part.flow
            db, k = flow.data, flow.index
            heading = math.radians(body.attitude_deg[2])
            try:
                point = db.reference_point[k].copy()  # still water is the same everywhere
                if not flow.finds_pose:
                    point[2] = body.position[2]
                require_match(
                    db, depth=sea.depth, reference_point=point, density=sea.density, gravity=gravity, body=k
                )
                self.waves.append(None if waves is None else WaveLoads(
                    db, waves, body.position, heading, sea.wave_ramp, body=k, froude_krylov=flow.hull is None,
                    drift=flow.drifts, slow_position=flow.followed, turns=flow.turns))  # fmt: skip
            except ModelError as error:
                raise ModelError([f"Body '{body.name}': {line}" for line in error.problems]) from None
            self.matrices[b, 0] = flow.linear_stiffness
            self.matrices[b, 1] = flow.linear_damping
            self.matrices[b, 2] = flow.quadratic_damping
            weight = 0.0
            if flow.hull is None:
                self.matrices[b, 0] += flow.hydrostatic_stiffness
                weight = sea.density * gravity * flow.volume
            xb, yb = (db.centre_of_buoyancy - db.reference_point)[k, :2]
            turn = turn_quaternion((0.0, 0.0, heading), (1.0, 0.0, 0.0, 0.0))
            self.P[b] = (math.cos(heading), math.sin(heading), *body.position, *turn, weight, weight * yb, -weight * xb)
        self.kernels: list[RadiationKernel | StateSpace] = []
        for group in self.groups:
            flow = group.parts[0].flow
            try:
                self.kernels.append(
                    StateSpace.from_database(flow.data) if flow.radiation == "state_space"
                    else RadiationKernel.from_database(flow.data, *flow.remembered)
                )  # fmt: skip
            except ModelError as error:
                raise ModelError([f"Body '{group.names}': {line}" for line in error.problems]) from None
            self._couple(group, 0, flow.data.added_mass_inf)
        self._Y, self._L, self._K = np.zeros((5, n, 6)), np.zeros((n, 3, 3)), np.zeros((6, 6))
        self._rest: dict[int, Array] = {}  # where floaters that are followed stood when last evaluated in statics

    def _at_rest(self, b: int) -> tuple[tuple[float, float], float]:
        """Where the waves meet floater b on average: world (x, y) [m] and heading [rad]."""
        body = self.parts[b].body
        x, y, yaw = self._rest.get(b, (*body.position[:2], 0.0))
        return (float(x), float(y)), math.radians(body.attitude_deg[2]) + float(yaw)

    def _couple(self, group: Group, which: int, matrix: Array) -> None:
        """Spread a matrix (6N, 6N) of a group over its pairs."""
        N = len(group.parts)
        blocks = matrix.reshape(N, 6, N, 6).swapaxes(1, 2)
        self.coupling[group.pair : group.pair + N * N, which] = blocks.reshape(-1, 6, 6)

    def connect(self, numbering: Any) -> None:
        """Find the bodies' points and rotations."""
        places = [numbering.place(part.body.name) for part in self.parts]
        self.where = np.array([[p.point, p.rotation] for p in places], dtype=np.int64)

    def _unknowns(self, n_point: int) -> Index:
        """Unknowns (n, 6) of every floater."""
        xyz, w = np.arange(3), self.where
        return np.concatenate([3 * w[:, :1] + xyz, 3 * (n_point + 1) + 3 * w[:, 1:] + xyz], axis=1)

    def dofs(self, n_point: int) -> list[Index]:
        u = self._unknowns(n_point)
        return [u[group.members].reshape(1, -1) for group in self.groups]

    def bind(self, slots: list[Index]) -> None:
        pieces = []
        for group, table in zip(self.groups, slots, strict=True):
            N = len(group.parts)
            pieces.append(table.reshape(N, 6, N, 6).swapaxes(1, 2).reshape(N * N, 36))
        self._slots = np.ascontiguousarray(np.concatenate(pieces), dtype=np.int64)

    def start(self, state: Any) -> list[Any]:
        """Memories of floaters that have always been at rest: one for every group, then the slow positions."""
        return [kernel.history(state.t) for kernel in self.kernels] + [
            waves.filter(state.t, self._pose(b, state.x, state.q)) for b, waves in self._slow()
        ]

    def _slow(self) -> list[tuple[int, WaveLoads]]:
        """Floaters whose waves are felt at their slow position."""
        return [(b, waves) for b, waves in enumerate(self.waves) if waves is not None and waves.slow_position]

    def _pose(self, b: int, x: Array, q: Array) -> Array:
        """World x, y [m] and yaw from the drawing heading [rad] of a floater, (3,)."""
        out = np.empty(3)
        _horizontal(x, q, self.where, self.P, b, self._L[b], out)
        if not self.parts[b].flow.turns:
            out[2] = 0.0
        return out

    def _ahead(self, b: int, t: float, state: Any) -> Array:
        """The pose (3,) at time t if accelerations stay; yaw by the turn about the vertical, for small tilts."""
        p, k = self.where[b]
        s, i = t - state.t, (3 * p, 3 * p + 1, 3 * (len(state.x) + k) + 2)
        out = self._pose(b, state.x, state.q)
        for n in range(3 if self.parts[b].flow.turns else 2):
            out[n] += s * (state.v[i[n]] + 0.5 * s * state.a[i[n]])
        return out

    def begin(self, w: Any, history: list[Any], t: float, state: Any) -> None:
        """What is constant during the step to t: wave forces and the past's share of the memory. In statics the mean
        drift, at the heading of the floater if that is followed."""
        if w.still:
            self.coupling[:, 1] = 0.0
            self._rest = {b: self._pose(b, state.x, state.q) for b, part in enumerate(self.parts)
                          if part.flow.followed}  # fmt: skip
            for b, waves in enumerate(self.waves):
                yaw = self._rest[b][2] if waves is not None and waves.slow_position else 0.0
                self.external[b] = 0.0 if waves is None else waves.mean_force(yaw)
            return
        for group, memory in zip(self.groups, history, strict=False):
            self.external[group.members] = memory.prepare(t).reshape(-1, 6)
            self._couple(group, 1, memory.tangent)
        np.copyto(self.past, self.external)
        slow = {b: memory.prepare(t, self._ahead(b, t, state))
                for (b, _), memory in zip(self._slow(), history[len(self.groups) :], strict=True)}  # fmt: skip
        for b, waves in enumerate(self.waves):
            if waves is not None and waves.linear:
                self.external[b] += waves.force(t)
            elif waves is not None:
                first, self.drift[b] = waves.forces(t, slow.get(b))
                self.external[b] += first + self.drift[b]

    def add(self, w: Any) -> None:
        floater_loads(w.x, w.q, w.v, w.a, w.u, w.c, self.where, self.P, self.matrices, self.pairs, self.coupling,
                      self.external, self._slots, self._Y, self._L, self._K, w.A, w.r, w.s)  # fmt: skip

    def _turn(self, group: Group) -> Array:
        """From the heading frame into world axes, (6N, 6N)."""
        co, si = self.P[group.first, :2]
        return np.kron(np.eye(2 * len(group.parts)), [[co, -si, 0.0], [si, co, 0.0], [0.0, 0.0, 1.0]])

    def frequencies(self) -> Array:
        """Frequencies of the first database [rad/s]."""
        return self.groups[0].db.omega

    def frequency_terms(self, omega: float, n_point: int) -> tuple[list[Index], list[Array], list[Array]]:
        """For every group of N floaters its unknowns (6N,), A(w) - A_inf and B(w) (6N, 6N) in world axes, at omega
        [rad/s]."""
        masses, dampings = [], []
        for group in self.groups:
            turn = self._turn(group)
            A, B = group.db.at(omega)
            masses.append(turn @ (A - group.db.added_mass_inf) @ turn.T)
            dampings.append(turn @ B @ turn.T)
        return [table[0] for table in self.dofs(n_point)], masses, dampings

    def wave_force(self, omega: float, heading: float, n_point: int) -> tuple[Index, NDArray[np.complex128]]:
        """Unknowns (n, 6) and complex forces F (n, 6), N/m and N m/m, world axes, of a regular wave of unit amplitude.

        F e^{i w t} is the force of eta = Re e^{i(w t - k (x cos b + y sin b))}: a crest passes the world's origin at
        t = 0. omega [rad/s]; heading b [rad], towards which the wave travels. Floaters with a hull: diffraction only.
        Raises ModelError as Excitation.from_database does (heading or frequency not in the database).
        """
        one, w = np.ones(1), np.array([omega])
        k = wave_number(w, self._sea.depth, self._gravity)
        wave = Realisation(one, w, k, np.array([heading]), 0.0 * one, self._sea.depth, math.inf)
        F = np.zeros((len(self.parts), 6), dtype=np.complex128)
        for group in self.groups:
            for b, part in zip(_range(group), group.parts, strict=True):
                flow, (place, psi) = part.flow, self._at_rest(b)
                co, si = math.cos(psi), math.sin(psi)
                turn = np.kron(np.eye(2), [[co, -si, 0.0], [si, co, 0.0], [0.0, 0.0, 1.0]])
                try:
                    F[b] = turn @ Excitation.from_database(
                        flow.data, wave, place, psi, body=flow.index, froude_krylov=flow.hull is None
                    ).coefficients[0]
                except ModelError as error:
                    raise ModelError([f"Body '{part.body.name}': {line}" for line in error.problems]) from None
        return self._unknowns(n_point), F

    def commit(self, history: list[Any], w: Any) -> None:
        """Take the accepted velocities and positions into the memories."""
        for group, memory in zip(self.groups, history, strict=False):
            memory.commit(w.t, self._Y[1, group.members].reshape(-1))
        for (b, _), memory in zip(self._slow(), history[len(self.groups) :], strict=True):
            memory.commit(w.t, self._pose(b, w.x, w.q))

    def outputs(self) -> list[Output]:
        """Second-order forces of the floaters that have them."""
        return [
            Output(f"{name}_drift_{what}", f"second-order wave {what} on {name}", unit, ("xyz",))
            for name in (part.body.name for part, waves in zip(self.parts, self.waves, strict=True)
                         if waves is not None and part.flow.drifts)
            for what, unit in (("force", "N"), ("moment", "N m"))
        ]  # fmt: skip

    def measure(self, w: Any, out: Array) -> None:
        """Of the step last begun."""
        at = 0
        for part, waves, f, (co, si) in zip(self.parts, self.waves, self.drift, self.P[:, :2], strict=True):
            if waves is not None and part.flow.drifts:
                for h in (0, 3):
                    out[at : at + 3] = co * f[h] - si * f[h + 1], si * f[h] + co * f[h + 1], f[h + 2]
                    at += 3

    def cautions(self) -> list[str]:
        """What the second-order forces leave out."""
        return [f"Body '{part.body.name}': {line}" for part, waves in zip(self.parts, self.waves, strict=True)
                if waves is not None for line in waves.messages]  # fmt: skip

    def ledger(self, w: Any, book: Any) -> None:
        """Of the state last evaluated, in the heading frame.

        U = xi . C xi/2 - W z - M . phi with the buoyancy W and its moments M. Forces -C xi + (W, M) act on nu instead
        of xi', whose angular part is L w: what is of second order in the angles goes to the account `large_angles`.
        """
        n = len(w.x)
        for b, (_, k) in enumerate(self.where):
            xi, nu, rel = self._Y[0, b], self._Y[1, b], self._Y[3, b]
            C, B, Q = self.matrices[b]
            co, si, W, M = *self.P[b, :2], self.P[b, 9], self.P[b, 10:]
            turned = self._L[b] @ w.v[3 * (n + k) : 3 * (n + k) + 3]
            turned[0], turned[1] = co * turned[0] + si * turned[1], co * turned[1] - si * turned[0]
            rate = np.concatenate([nu[:3], turned])
            S = 0.5 * (C + C.T)
            flow = rate @ S @ xi - W * rate[2] - M @ rate[3:5]
            book.store("hydrostatic", 0.5 * xi @ S @ xi - W * w.x[self.where[b, 0], 2] - M @ xi[3:5], flow)
            book.work("large_angles", flow - nu @ C @ xi + W * nu[2] + M @ nu[3:5])
            viscous, drag = -nu @ B @ nu, -Q @ (np.abs(rel) * rel)
            book.work("drag", viscous + rel @ drag)
            book.work("current", (nu - rel) @ drag)
            book.work("wave", nu @ (self.external[b] - self.past[b]))
            book.work("radiation", nu @ self.past[b])
        for group in self.groups:
            A, nu, acc = group.db.added_mass_inf, self._Y[1, group.members].ravel(), self._Y[2, group.members].ravel()
            S = 0.5 * (A + A.T)
            book.store("kinetic", 0.5 * nu @ S @ nu, nu @ S @ acc)
            book.work("radiation", nu @ (S - A) @ acc)
        for (b, o), (_, memory) in zip(self.pairs, self.coupling, strict=True):
            book.work("radiation", -self._Y[1, b] @ memory @ self._Y[1, o])

    def notes(self) -> list[str]:
        """Per group how well its radiation memory gives back the database, and a database of deep water in less."""
        notes = [f"{group.names}: {kernel.summary()}" for group, kernel in zip(self.groups, self.kernels, strict=True)]
        depth = self._sea.depth
        deep = [group.names for group in self.groups if group.db.depth == math.inf]
        return notes + [f"{names}: the database is for deep water, the sea has {depth:g} m" for names in deep]


def _range(group: Group) -> range:
    return range(group.members.start, group.members.stop)
