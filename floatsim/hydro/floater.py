"""Linear potential-flow loads on a floater, and the quadratic damping that goes with them.

In the horizontal frame at the body's mean heading (the drawing heading), origin at the displaced
reference point, with nu = (v, w), xi = (displacement, tilt and yaw) and u the current:

    F = (0, 0, rho g V0, rho g V0 y_B0, -rho g V0 x_B0, 0)        constant buoyancy wrench
      - (C + K_add) xi                                           C = waterplane + rho g V z_B, no weight
      - A_inf nu' - B_add nu - B_quad |nu - u| (nu - u)          row i: sum_j B_ij |nu_j| nu_j
      - int K(tau) nu(t - tau) dtau + Re sum X a e^{i(w t + ...)}

(Cummins 1962; hydrostatics: the buoyancy wrench stays at the displaced reference point and V z_B stands
in C, so that a surge changes no moment and nothing is counted twice.) Simplifications that are the
field's habit: excitation and coefficients at the drawing position, no velocity-product terms of the
added mass, C xi linear in tilt and yaw. Weight acts on the body's mass, at any angle.

Tilt and yaw: the body yaws first, then tilts by an angle about one horizontal axis, the tilt vector. For small angles
that is the rotation vector; but the rotation vector of a body yawed by psi and tilted lies psi/2 off the axis of the
tilt. A restoring moment along it drives roll by pitch and pitch by minus roll: a damping ratio of -psi/4 for a body
as stiff in roll as in pitch, where the moment along the tilt has a potential.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from floatsim.description import Description, Matrix6, Positive
from floatsim.errors import ModelError
from floatsim.frames import Array, cross, turn_quaternion, unit
from floatsim.hydro.database import HydroDatabase, require_match
from floatsim.hydro.excitation import Excitation
from floatsim.hydro.radiation import RadiationHistory, RadiationKernel
from floatsim.jit import kernel
from floatsim.laws.angle import half_angle_squared
from floatsim.parts.part import Part

Index = NDArray[np.int64]

MAX_MEMORY = 100_000  # intervals of the radiation memory; more is a slip of the pen
ZERO6: tuple[tuple[float, ...], ...] = tuple((0.0,) * 6 for _ in range(6))


class PotentialFlow(Description):
    """First-order hydrodynamics of a body. Give it to `Body(hydro=...)`.

    database: a HydroDatabase or the path of its netCDF file, about the body's reference point.
    displaced_volume [m3]: at the drawing position, default the database's. linear_damping,
    quadratic_damping, linear_stiffness: 6 x 6, rows surge..yaw, added to the potential-flow terms.
    memory [s] and memory_grid [s] of the radiation convolution.
    """

    database: Any
    displaced_volume: Positive | None = None
    linear_damping: Matrix6 = ZERO6  # type: ignore[assignment]
    quadratic_damping: Matrix6 = ZERO6  # type: ignore[assignment]
    linear_stiffness: Matrix6 = ZERO6  # type: ignore[assignment]
    memory: Positive = 60.0
    memory_grid: Positive = 0.1

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
        if self.memory / self.memory_grid > MAX_MEMORY:
            raise ModelError(
                f"PotentialFlow: memory of {self.memory:g} s on a grid of {self.memory_grid:g} s has more than "
                f"{MAX_MEMORY} intervals; 60 s and 0.1 to 0.2 s are usual"
            )

    @cached_property
    def data(self) -> HydroDatabase:
        """The database itself."""
        return self.database if isinstance(self.database, HydroDatabase) else HydroDatabase.read(self.database)

    def files(self) -> list[str | Path]:
        """Files its numbers come from."""
        return [] if isinstance(self.database, HydroDatabase) else [self.database]

    @property
    def volume(self) -> float:
        """Displaced volume at the drawing position [m3]."""
        return self.displaced_volume if self.displaced_volume is not None else float(self.data.volume[0])

    def attached_to(self, body: Any) -> list[Part]:
        """The parts that carry these loads."""
        return [Floater(name=f"{body.name}.hydro", body=body, flow=self)]


class Floater(Part):
    """The hydrodynamic loads of one body."""

    name: str
    body: Any
    flow: PotentialFlow

    @staticmethod
    def batch() -> type[FloaterBatch]:
        return FloaterBatch


@kernel
def floater_loads(x, q, v, a, u, c, where, P, matrices, external, nu_out, slots, Y, L, K, A, r, s):  # type: ignore[no-untyped-def]
    """Loads of every floater.

    where (n, 2): point, rotation. P (n, 12): cos and sin of the mean heading, drawing position (3),
    drawing quaternion (4), buoyancy [N], its moments (2). matrices (n, 5, 6, 6): C + K_add, A_inf,
    B_add, B_quad, memory tangent. external (n, 6): wave force plus the past's share of the memory.
    Scratch: Y (5, 6), L (3, 3), K (6, 6).
    """
    base = 3 * x.shape[0]
    xi, nu, acc, rel, f = Y[0], Y[1], Y[2], Y[3], Y[4]
    for b in range(where.shape[0]):
        p, k = where[b, 0], where[b, 1]
        co, si = P[b, 0], P[b, 1]
        dp, dr = 3 * p, base + 3 * k
        back = (P[b, 5], -P[b, 6], -P[b, 7], -P[b, 8])
        phi = _tilt_and_yaw(_product((q[k, 0], q[k, 1], q[k, 2], q[k, 3]), back), L)
        d = (x[p, 0] - P[b, 2], x[p, 1] - P[b, 3], x[p, 2] - P[b, 4])
        _to_heading(co, si, d, phi, xi)
        _to_heading(co, si, (v[dp], v[dp + 1], v[dp + 2]), (v[dr], v[dr + 1], v[dr + 2]), nu)
        _to_heading(co, si, (a[dp], a[dp + 1], a[dp + 2]), (a[dr], a[dr + 1], a[dr + 2]), acc)
        _to_heading(co, si, (u[p, 0], u[p, 1], u[p, 2]), (0.0, 0.0, 0.0), rel)
        for m in range(6):
            rel[m] = nu[m] - rel[m]
            nu_out[b, m] = nu[m]
        size = 0.0
        turning = 0.0
        for m in range(6):
            y = external[b, m]
            for n in range(6):
                y -= matrices[b, 0, m, n] * xi[n] + matrices[b, 1, m, n] * acc[n]
                y -= (matrices[b, 2, m, n] + matrices[b, 4, m, n]) * nu[n]
                y -= matrices[b, 3, m, n] * abs(rel[n]) * rel[n]
            f[m] = y
            if m < 3:
                size += abs(y)
            else:
                turning += abs(y)
        f[2] += P[b, 9]
        f[3] += P[b, 10]
        f[4] += P[b, 11]
        s[p] += size + P[b, 9]
        s[x.shape[0] + k] += turning + abs(P[b, 10]) + abs(P[b, 11])
        for h in range(2):
            o = dp if h == 0 else dr
            r[o] -= co * f[3 * h] - si * f[3 * h + 1]
            r[o + 1] -= si * f[3 * h] + co * f[3 * h + 1]
            r[o + 2] -= f[3 * h + 2]
        # columns: a unit change of world coordinate j, its rate and its acceleration, seen in the heading frame
        for j in range(6):
            e = unit(j % 3)
            h = 3 * (j // 3)
            t0, t1, t2 = co * e[0] + si * e[1], -si * e[0] + co * e[1], e[2]
            g = e if j < 3 else (L[0, j - 3], L[1, j - 3], L[2, j - 3])
            g0, g1, g2 = co * g[0] + si * g[1], -si * g[0] + co * g[1], g[2]
            for m in range(6):
                CM, BM, QM = matrices[b, 0, m], matrices[b, 2, m], matrices[b, 3, m]
                y = c[2] * (CM[h] * g0 + CM[h + 1] * g1 + CM[h + 2] * g2)
                AM, WM = matrices[b, 1, m], matrices[b, 4, m]
                y += c[0] * (AM[h] * t0 + AM[h + 1] * t1 + AM[h + 2] * t2)
                y += c[1] * (
                    (BM[h] + WM[h] + 2.0 * QM[h] * abs(rel[h])) * t0
                    + (BM[h + 1] + WM[h + 1] + 2.0 * QM[h + 1] * abs(rel[h + 1])) * t1
                    + (BM[h + 2] + WM[h + 2] + 2.0 * QM[h + 2] * abs(rel[h + 2])) * t2
                )
                f[m] = y
            for h2 in range(2):
                K[3 * h2, j] = co * f[3 * h2] - si * f[3 * h2 + 1]
                K[3 * h2 + 1, j] = si * f[3 * h2] + co * f[3 * h2 + 1]
                K[3 * h2 + 2, j] = f[3 * h2 + 2]
        for m in range(6):
            for n in range(6):
                A[slots[b, 6 * m + n]] += K[m, n]


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


class FloaterBatch:
    """Hydrodynamic loads of all floaters, with their radiation memories."""

    runs: ClassVar[list[tuple[int, int]]] = []
    remembers: ClassVar[bool] = True

    def __init__(self, parts: Sequence[Floater], first_point: Sequence[int], first_rotation: Sequence[int],
                 sea: Any, gravity: float) -> None:  # fmt: skip
        self.parts = tuple(parts)
        n = len(self.parts)
        self.matrices = np.zeros((n, 5, 6, 6))
        self.P = np.zeros((n, 12))
        self.external = np.zeros((n, 6))
        self.nu = np.zeros((n, 6))
        self.kernels: list[RadiationKernel] = []
        self.excitations: list[Excitation | None] = []
        for b, part in enumerate(self.parts):
            body, flow = part.body, part.flow
            db = flow.data
            waves = sea.waves
            heading = math.radians(body.attitude_deg[2])
            try:
                point = (*db.reference_point[0, :2], body.position[2])  # still water is the same everywhere
                require_match(db, depth=sea.depth, reference_point=point, density=sea.density, gravity=gravity)
                self.kernels.append(RadiationKernel.from_database(db, flow.memory, flow.memory_grid))
                self.excitations.append(
                    None if waves is None else Excitation.from_database(
                        db, waves.realise(sea.depth, gravity), body.position[:2], heading, sea.wave_ramp)
                )  # fmt: skip
            except ModelError as error:
                raise ModelError([f"Body '{body.name}': {line}" for line in error.problems]) from None
            weight = sea.density * gravity * flow.volume
            self.matrices[b, 0] = db.hydrostatic_stiffness + np.array(flow.linear_stiffness)
            self.matrices[b, 1] = db.added_mass_inf
            self.matrices[b, 2] = flow.linear_damping
            self.matrices[b, 3] = flow.quadratic_damping
            xb, yb = (db.centre_of_buoyancy - db.reference_point)[0, :2]
            turn = turn_quaternion((0.0, 0.0, heading), (1.0, 0.0, 0.0, 0.0))
            self.P[b] = (math.cos(heading), math.sin(heading), *body.position, *turn, weight, weight * yb, -weight * xb)
        self._Y, self._L, self._K = np.zeros((5, 6)), np.zeros((3, 3)), np.zeros((6, 6))

    def connect(self, numbering: Any) -> None:
        """Find the bodies' points and rotations."""
        places = [numbering.place(part.body.name) for part in self.parts]
        self.where = np.array([[p.point, p.rotation] for p in places], dtype=np.int64)

    def dofs(self, n_point: int) -> list[Index]:
        xyz, w = np.arange(3), self.where
        return [np.concatenate([3 * w[:, :1] + xyz, 3 * (n_point + 1) + 3 * w[:, 1:] + xyz], axis=1)]

    def bind(self, slots: list[Index]) -> None:
        (self._slots,) = slots

    def start(self, state: Any) -> list[RadiationHistory]:
        """Memories of floaters that have always been at rest."""
        return [RadiationHistory(kernel, t0=state.t) for kernel in self.kernels]

    def begin(self, w: Any, history: list[RadiationHistory], t: float, state: Any) -> None:
        """What is constant during the step to t: wave forces and the past's share of the memory."""
        for b, excitation in enumerate(self.excitations):
            if w.still:
                self.external[b] = 0.0
                self.matrices[b, 4] = 0.0
                continue
            memory = history[b]
            self.external[b] = memory.prepare(t)
            self.matrices[b, 4] = memory.tangent
            if excitation is not None:
                self.external[b] += excitation.force(t)

    def add(self, w: Any) -> None:
        floater_loads(w.x, w.q, w.v, w.a, w.u, w.c, self.where, self.P, self.matrices, self.external, self.nu,
                      self._slots, self._Y, self._L, self._K, w.A, w.r, w.s)  # fmt: skip

    def frequency_terms(self, omega: float, n_point: int) -> tuple[Index, Array, Array]:
        """Unknowns (n, 6), A(w) - A_inf and B(w) (n, 6, 6) in world axes at omega [rad/s]."""
        masses, dampings = [], []
        for b, part in enumerate(self.parts):
            db = part.flow.data
            turn = np.zeros((6, 6))
            co, si = self.P[b, :2]
            turn[:3, :3] = turn[3:, 3:] = [[co, -si, 0.0], [si, co, 0.0], [0.0, 0.0, 1.0]]
            A, B = db.at(omega)
            masses.append(turn @ (A - db.added_mass_inf) @ turn.T)
            dampings.append(turn @ B @ turn.T)
        return self.dofs(n_point)[0], np.array(masses), np.array(dampings)

    def commit(self, history: list[RadiationHistory], w: Any) -> None:
        """Take the accepted velocities into the memories."""
        for b, memory in enumerate(history):
            memory.commit(w.t, self.nu[b])
