"""Rigid bodies with six degrees of freedom and finite rotations.

Degrees of freedom: velocity of the reference point and angular velocity w, both in world axes. With
the centre of mass at r = R c from the reference point and the inertia J = R J_B R^T about it,

    a_c = a + alpha x r + w x (w x r)
    F   = m a_c - m g                    M = r x (m a_c - m g) + J alpha + w x (J w)

(Newton-Euler; e.g. Featherstone, Rigid Body Dynamics Algorithms, section 2.13). Tangents are exact:
turning the body by the spatial vector e changes r by e x r and J y by e x (J y) - J (e x y).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import field_validator, model_validator

from floatsim.description import Name, Positive, Vector3, numbers
from floatsim.frames import Array, at, cross, dot, matrix_from_angles, minus, plus, rotate, skew, times, unit, unrotate
from floatsim.jit import kernel
from floatsim.parts.part import Anchor, Part

Index = NDArray[np.int64]

Inertia = Annotated[tuple[float, ...], numbers("3 finite numbers (xx, yy, zz) or 6 (xx, yy, zz, xy, xz, yz)", 3, 6)]


class Body(Part):
    """A rigid body.

    mass [kg]; inertia [kg m2] about the centre of mass in body axes: (xx, yy, zz) or (xx, yy, zz, xy,
    xz, yz) with the tensor's own entries (J_xy = -integral x y dm). center_of_mass [m] from the
    reference point, body axes. position [m]: drawing position of the reference point. attitude_deg:
    roll, pitch, yaw of the drawing position. points: named connection points, body axes [m]. hydro:
    what the water does to it (`floatsim.PotentialFlow`), a list of such descriptions, or None.
    Connection points: `NAME` (the reference point) and `NAME.POINT`.
    """

    name: Name
    mass: Positive
    inertia: Inertia
    center_of_mass: Vector3 = (0.0, 0.0, 0.0)
    position: Vector3 = (0.0, 0.0, 0.0)
    attitude_deg: Vector3 = (0.0, 0.0, 0.0)
    points: dict[Name, Vector3] = {}
    hydro: Any = None

    n_rotations: ClassVar[int] = 1

    @field_validator("hydro")
    @classmethod
    def _is_hydrodynamics(cls, value: Any) -> Any:
        several = isinstance(value, list | tuple)
        for item in value if several else (value,):
            if (item is not None or several) and (isinstance(item, type) or not hasattr(item, "attached_to")):
                raise ValueError(
                    f"got {item!r}; floatsim.PotentialFlow(database=...), a list of such descriptions, or None is "
                    "allowed"
                )
        return tuple(value) if several else value

    @model_validator(mode="after")
    def _physical(self) -> Body:
        principal = np.linalg.eigvalsh(self.inertia_tensor)
        if principal[0] <= 0.0:
            raise ValueError(
                f"inertia: got principal moments {principal.round(6).tolist()} kg m2; all must be positive"
            )
        if principal[2] > (principal[0] + principal[1]) * (1.0 + 1e-9):
            raise ValueError(
                f"inertia: got principal moments {principal.round(6).tolist()} kg m2; the largest cannot exceed the "
                "sum of the other two (is it about another point than the centre of mass?)"
            )
        return self

    @property
    def inertia_tensor(self) -> Array:
        """Inertia about the centre of mass, body axes, (3, 3) [kg m2]."""
        J = (*self.inertia, 0.0, 0.0, 0.0)[:6]
        return np.array([[J[0], J[3], J[4]], [J[3], J[1], J[5]], [J[4], J[5], J[2]]])

    @property
    def water_loads(self) -> tuple[Any, ...]:
        """Descriptions of what the water does to the body, none, one or several."""
        return self.hydro if isinstance(self.hydro, tuple) else () if self.hydro is None else (self.hydro,)

    @property
    def extent(self) -> float:
        """A length of the body [m]: its largest radius of gyration about the reference point, for tolerances."""
        lever = float(np.dot(self.center_of_mass, self.center_of_mass))
        return math.sqrt(float(np.linalg.eigvalsh(self.inertia_tensor)[2]) / self.mass + lever)

    @property
    def n_points(self) -> int:
        return 1

    @staticmethod
    def batch() -> type[BodyBatch]:
        return BodyBatch

    def anchors(self) -> dict[str, Anchor]:
        """Connection points: name -> (local point, local rotation, arm in the body frame)."""
        return {"": (0, 0, (0.0, 0.0, 0.0)), **{name: (0, 0, arm) for name, arm in self.points.items()}}

    def children(self) -> list[Any]:
        """Parts that come with this one."""
        return [part for load in self.water_loads for part in load.attached_to(self)]

    def place(self, ends: dict[str, Array], sea: Any) -> tuple[Array, Array]:
        """Drawing position: point (1, 3) and rotation matrix (1, 3, 3)."""
        R = matrix_from_angles(*np.radians(self.attitude_deg))
        return np.array([self.position]), R[None]


@kernel
def rigid_bodies(x, R, v, a, c, points, rots, P, slots, K, A, r, s):  # type: ignore[no-untyped-def]
    """Inertia and weight of every body.

    P (n, 14): mass, centre of mass (3), inertia row-wise (9), g; points, rots (n,) their indices into
    x and R. x and R end with the ground, so angular velocities stand in v from 3 len(x) on.
    """
    for b in range(points.shape[0]):
        m, g = P[b, 0], P[b, 13]
        i, k = points[b], rots[b]
        dp, dr = 3 * i, 3 * x.shape[0] + 3 * k
        rc = rotate(R, k, (P[b, 1], P[b, 2], P[b, 3]))
        w, al, acc = at(v, dr), at(a, dr), at(a, dp)
        wr = cross(w, rc)
        ac = plus(acc, plus(cross(al, rc), cross(w, wr)))
        lin = times(m, (ac[0], ac[1], ac[2] + g))
        Jw, Ja = _inertia(P, b, R, k, w), _inertia(P, b, R, k, al)
        mom = plus(cross(rc, lin), plus(Ja, cross(w, Jw)))
        for n in range(3):
            r[dp + n] += lin[n]
            r[dr + n] += mom[n]
        s[i] += m * (abs(g) + abs(ac[0]) + abs(ac[1]) + abs(ac[2]))
        s[x.shape[0] + k] += (
            abs(mom[0]) + abs(mom[1]) + abs(mom[2])
            + m * abs(g) * (abs(rc[0]) + abs(rc[1]) + abs(rc[2]))
            + abs(Ja[0]) + abs(Ja[1]) + abs(Ja[2])
            + 1e-3 * math.sqrt(dot(w, w) * dot(Jw, Jw))  # a free steady spin has no moments at all
        )  # fmt: skip
        for n in range(3):
            e = unit(n)
            # by acceleration
            er = cross(e, rc)
            f_al = times(m, er)
            m_al = plus(cross(rc, f_al), _inertia(P, b, R, k, e))
            m_a = times(m, cross(rc, e))
            # by angular velocity
            f_w = times(m, plus(cross(e, wr), cross(w, er)))
            m_w = plus(cross(rc, f_w), plus(cross(e, Jw), cross(w, _inertia(P, b, R, k, e))))
            # by turning: dr = e x r, d(J y) = e x J y - J (e x y)
            f_q = times(m, plus(cross(al, er), cross(w, cross(w, er))))
            dJa = minus(cross(e, Ja), _inertia(P, b, R, k, cross(e, al)))
            dJw = minus(cross(e, Jw), _inertia(P, b, R, k, cross(e, w)))
            m_q = plus(plus(cross(er, lin), cross(rc, f_q)), plus(dJa, cross(w, dJw)))
            for q in range(3):
                K[q, n] = c[0] * m if q == n else 0.0
                K[q, 3 + n] = c[0] * f_al[q] + c[1] * f_w[q] + c[2] * f_q[q]
                K[3 + q, n] = c[0] * m_a[q]
                K[3 + q, 3 + n] = c[0] * m_al[q] + c[1] * m_w[q] + c[2] * m_q[q]
        for p in range(6):
            for q in range(6):
                A[slots[b, 6 * p + q]] += K[p, q]


@kernel
def _inertia(P, b, R, k, y):  # type: ignore[no-untyped-def]
    """R J_B R^T y."""
    z = unrotate(R, k, y)
    return rotate(
        R,
        k,
        (
            P[b, 4] * z[0] + P[b, 5] * z[1] + P[b, 6] * z[2],
            P[b, 7] * z[0] + P[b, 8] * z[1] + P[b, 9] * z[2],
            P[b, 10] * z[0] + P[b, 11] * z[1] + P[b, 12] * z[2],
        ),
    )


class BodyBatch:
    """Inertia and weight of all rigid bodies. Their hydrodynamics are batches of their own."""

    runs: ClassVar[list[tuple[int, int]]] = []
    remembers: ClassVar[bool] = False

    def __init__(self, parts: Sequence[Body], first_point: Sequence[int], first_rotation: Sequence[int],
                 sea: Any, gravity: float) -> None:  # fmt: skip
        self.parts = tuple(parts)
        self.points = np.array(first_point, dtype=np.int64)
        self.rots = np.array(first_rotation, dtype=np.int64)
        self.P = np.array(
            [[b.mass, *b.center_of_mass, *b.inertia_tensor.ravel(), gravity] for b in parts], dtype=float
        )
        self._K = np.zeros((6, 6))

    def dofs(self, n_point: int) -> list[Index]:
        xyz, base = np.arange(3), 3 * (n_point + 1)
        return [np.concatenate([3 * self.points[:, None] + xyz, base + 3 * self.rots[:, None] + xyz], axis=1)]

    def bind(self, slots: list[Index]) -> None:
        (self._slots,) = slots

    def add(self, w: Any) -> None:
        rigid_bodies(w.x, w.R, w.v, w.a, w.c, self.points, self.rots, self.P, self._slots, self._K, w.A, w.r, w.s)

    def ledger(self, w: Any, book: Any) -> None:
        """T = m v_c^2/2 + w . J w/2 and U = m g z_c of every body; their rates from forces."""
        n = len(w.x)
        for P, i, k in zip(self.P, self.points, self.rots, strict=True):
            m, g, R = P[0], P[13], w.R[k]
            J = R @ P[4:13].reshape(3, 3) @ R.T
            c = R @ P[1:4]
            v, a = w.v[3 * i : 3 * i + 3], w.a[3 * i : 3 * i + 3]
            omega, alpha = w.v[3 * (n + k) : 3 * (n + k) + 3], w.a[3 * (n + k) : 3 * (n + k) + 3]
            arm, spin = skew(c), skew(omega)
            vc = v + spin @ c
            F = m * (a - arm @ alpha + spin @ (spin @ c))
            M = arm @ F + J @ alpha + spin @ (J @ omega)
            book.store("kinetic", 0.5 * (m * vc @ vc + omega @ J @ omega), F @ v + M @ omega)
            book.store("gravity", m * g * (w.x[i, 2] + c[2]), m * g * vc[2])
