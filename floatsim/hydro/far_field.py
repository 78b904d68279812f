"""Mean drift of one body from the waves it sends away: momentum and energy on a cylinder far off.

Far away the wave that the body adds to an incident wave of amplitude a towards b, e^{i(w t - k(x cos b + y sin b))}, is

    eta = a S(theta) sqrt(2/(pi k r)) e^{i(w t - k r + pi/4)},      S = s_D + sum_j xi_j s_j = sum_m c_m e^{i m theta},

s_D of the body held fixed, s_j of its motions per metre or radian, xi its motions per metre of wave. A wave carries
1/c of its power as momentum along it, and m/w of it as moment about the z axis in its harmonic e^{-i m theta} (mean
second-order pressures are the same all round and leave no force). With Q = rho g c_g / (pi w), per a squared,

    F_x + i F_y = Q (e^{i b} E - int |S|^2 e^{i theta} dtheta),       M_z = 2 pi Q/k (sum_m m |c_m|^2 + Im S'(b)),
    E = -2 pi Re S(b) = int |S|^2 dtheta + pi k P/(rho g c_g),

E what the incident wave loses, P the power that damping of other kinds than radiation takes. Of the two forms of E the
second is used, because nothing cancels in it in long waves; how far the first is from it tells how good the panels are.
Horizontal forces: Maruo (1960), The drift of a body floating on waves; the moment: Newman (1967), The drift force and
moment on ships in waves; Faltinsen (1990), Sea Loads on Ships and Offshore Structures, chapter 5. Mean heave, roll and
pitch are not told by waves far away.

The amplitudes come from Green's theorem with the wave psi = cosh k(z + h)/cosh k h e^{i k(x cos theta + y sin theta)}
on the wetted surface, n into the water:

    s(theta) = - k/(4 c_g) int (phi psi_n - psi phi_n) dA.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from floatsim.errors import ModelError
from floatsim.frames import skew

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

_BLOCK = 400  # panels at a time: some 10 MB


class FreeFloating(NamedTuple):
    """A body that floats freely in the waves: what its motions depend on beside the water.

    mass [kg]; center_of_mass (3,) m from the reference point; inertia [kg m2] about the centre of mass, (3, 3) or
    (xx, yy, zz) or (xx, yy, zz, xy, xz, yz) with the tensor's own entries; axes of the database. damping, stiffness:
    (6, 6) about the reference point, beside radiation and beside hydrostatics and weight (a linearised drag, moorings);
    N s/m, N s, N m s and N/m, N, N m.
    """

    mass: float
    center_of_mass: Sequence[float]
    inertia: Any
    damping: Any = None
    stiffness: Any = None

    def problems(self) -> list[str]:
        """What is wrong with the numbers, in words."""
        found = []
        for label, value, shapes in (
            ("mass", self.mass, [()]), ("center_of_mass", self.center_of_mass, [(3,)]),
            ("inertia", self.inertia, [(3,), (6,), (3, 3)]), ("damping", self.damping, [(6, 6)]),
            ("stiffness", self.stiffness, [(6, 6)]),
        ):  # fmt: skip
            if value is None and label in ("damping", "stiffness"):
                continue
            array = np.asarray(value, dtype=float)
            if array.shape not in shapes or not np.all(np.isfinite(array)):
                allowed = " or ".join(str(shape) if shape else "one" for shape in shapes)
                found.append(f"drift: {label}: got {value!r}; must be finite numbers, {allowed}")
        if not found and not self.mass > 0.0:
            found.append(f"drift: mass: got {self.mass!r}; must be positive")
        if not found and np.linalg.eigvalsh(self.tensor)[0] <= 0.0:
            found.append("drift: inertia: principal moments must be positive")
        if not found:
            rates = np.linalg.eigvalsh(_symmetric(self.damping))
            if rates[0] < -1e-9 * rates[-1]:
                found.append("drift: damping: feeds energy in; it must be positive semi-definite")
        return found

    @property
    def tensor(self) -> Array:
        """Inertia about the centre of mass, (3, 3)."""
        J = np.asarray(self.inertia, dtype=float)
        if J.shape == (3, 3):
            return J
        xx, yy, zz, xy, xz, yz = [*J, 0.0, 0.0, 0.0][:6]
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    @property
    def matrix(self) -> Array:
        """Inertia about the reference point, (6, 6)."""
        S = skew(np.asarray(self.center_of_mass, dtype=float))
        return np.block([[self.mass * np.eye(3), -self.mass * S], [self.mass * S, self.tensor - self.mass * S @ S]])

    def motions(self, omega: Array, A: Array, B: Array, X: Complex, hydrostatic: Array, gravity: float) -> Complex:
        """xi (n, m, 6) per metre of wave: A, B (n, 6, 6), X (n, m, 6), hydrostatic stiffness without weight (6, 6)."""
        weight = np.zeros((6, 6))  # of a body that rolls and pitches about its reference point, yawed to first order
        x, y, z = self.mass * gravity * np.asarray(self.center_of_mass, dtype=float)
        weight[3, 3] = weight[4, 4] = -z
        weight[3, 5], weight[4, 5] = x, y
        w = omega[:, None, None]
        matrix = -(w**2) * (self.matrix + A) + 1j * w * (_full(self.damping) + B) + hydrostatic + weight
        return np.asarray(np.linalg.solve(matrix + _full(self.stiffness), X.swapaxes(1, 2)).swapaxes(1, 2))


    def attributes(self) -> dict[str, Any]:
        """What a database says of the motions its mean drift belongs to."""
        J = self.tensor
        found: dict[str, Any] = {
            "mean_drift_motions": "free floating, without moorings" + (", damped" if self.damping is not None else ""),
            "mean_drift_mass": float(self.mass),
            "mean_drift_center_of_mass": [float(y) for y in self.center_of_mass],
            "mean_drift_inertia": [float(J[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))],
        }
        for name in ("damping", "stiffness"):
            if getattr(self, name) is not None:
                found[f"mean_drift_{name}"] = np.ravel(getattr(self, name)).astype(float).tolist()
        return found


def _full(matrix: Any) -> Array:
    return np.zeros((6, 6)) if matrix is None else np.asarray(matrix, dtype=float)


def _symmetric(matrix: Any) -> Array:
    return 0.5 * (_full(matrix) + _full(matrix).T)


class FarField(NamedTuple):
    """Harmonics m = -M..M of waves at one frequency: radiated (6, 2 M + 1), scattered (headings, 2 M + 1)."""

    radiated: Complex
    scattered: Complex


def far_field(
    corners: Array,
    potential: Complex,
    headings: Array,
    reference_point: Sequence[float] | Array,
    *,
    omega: float,
    k: float,
    depth: float,
    gravity: float,
) -> FarField:
    """Harmonics about the z axis of what a body radiates (per metre and radian) and scatters (per metre of wave).

    corners (q, 4, 3) of the wetted panels, normal outwards; potential (6 + m, q) on them, m2/s, time factor e^{+i w t},
    phases from the origin: of six motions about the reference point, then of the waves scattered at headings (m,) rad.
    """
    x, n = panel_points(corners)
    count = harmonics(k * float(np.hypot(corners[..., 0], corners[..., 1]).max()))
    theta = 2.0 * np.pi * np.arange(2 * count + 1) / (2 * count + 1)
    direction = np.stack([np.cos(theta), np.sin(theta)])
    total = np.zeros((theta.size, len(potential)), dtype=complex)
    for first in range(0, len(x), _BLOCK):
        at = slice(first, first + _BLOCK)
        total += _green(x[at], n[at], potential[:, at], direction, headings, reference_point, omega, k, depth, gravity)
    s = -k / (4.0 * group_speed(omega, k, depth)) * total.T
    c = np.fft.fftshift(np.fft.fft(s, axis=1), axes=1) / theta.size
    return FarField(c[:6], c[6:])


def _green(x: Array, n: Array, potential: Complex, direction: Array, headings: Array, point: Sequence[float] | Array,
           omega: float, k: float, depth: float, gravity: float) -> Complex:  # fmt: skip
    """int (phi psi_n - psi phi_n) dA (directions, 6 + m) over panels with Gauss points x and n dA there (q, 4, 3)."""
    fade, slope = _profile(x[..., 2], k, depth)
    plane = np.exp(1j * k * np.einsum("qgi,it->tqg", x[..., :2], direction))
    along = np.einsum("tqg,qgi->tiq", plane, fade[..., None] * n[..., :2])
    psi_n = 1j * k * np.einsum("it,tiq->tq", direction, along) + np.einsum("tqg,qg->tq", plane, slope * n[..., 2])
    moving = 1j * omega * np.concatenate([n, np.cross(x - np.asarray(point), n)], axis=2)
    b = np.stack([np.cos(headings), np.sin(headings)])
    incident = 1j * gravity / omega * np.exp(-1j * k * np.einsum("qgi,im->qgm", x[..., :2], b))
    rate = -1j * k * fade[..., None] * np.einsum("qgi,im->qgm", n[..., :2], b) + (slope * n[..., 2])[..., None]
    velocity = np.concatenate([moving, -incident * rate], axis=2).reshape(-1, 6 + headings.size)
    return psi_n @ potential.T - (plane * fade).reshape(len(plane), -1) @ velocity


def _profile(z: Array, k: float, depth: float) -> tuple[Array, Array]:
    """cosh k(z + h)/cosh k h and its derivative."""
    below = np.exp(-2.0 * k * (z + depth))
    fade = np.exp(k * z) / (1.0 + math.exp(-2.0 * k * depth))
    return fade * (1.0 + below), k * fade * (1.0 - below)


def panel_points(corners: Array) -> tuple[Array, Array]:
    """Gauss points and n dA there, (q, 4, 3) each, of bilinear panels (q, 4, 3)."""
    a, b, c, d = (corners[:, i, None] for i in range(4))
    g = 0.5 + np.array([-0.5, 0.5]) / math.sqrt(3.0)
    u, v = (part.reshape(1, 4, 1) for part in np.meshgrid(g, g, indexing="ij"))
    x = (1.0 - u) * (1.0 - v) * a + u * (1.0 - v) * b + u * v * c + (1.0 - u) * v * d
    return x, 0.25 * np.cross((1.0 - v) * (b - a) + v * (c - d), (1.0 - u) * (d - a) + u * (c - b))


def harmonics(reach: float) -> int:
    """How many a body has whose farthest point is `reach` = k r from the axis: J_m(reach) is 1e-10 beyond."""
    return math.ceil(reach + 6.0 * reach ** (1.0 / 3.0)) + 8


def group_speed(omega: float, k: float, depth: float) -> float:
    """m/s."""
    kh = min(k * depth, 300.0)
    return 0.5 * omega / k * (1.0 + 2.0 * kh / math.sinh(2.0 * kh))


def turned(c: Complex, q: Array) -> Complex:
    """Harmonics of S seen after the operation q, a turn about the z axis or a mirror plane through it."""
    m = np.arange(c.shape[-1]) - c.shape[-1] // 2
    flipped = c if np.linalg.det(q) > 0.0 else c[..., ::-1]
    return np.asarray(flipped * np.exp(-1j * m * math.atan2(q[1, 0], q[0, 0])))


def momentum(c: Complex, heading: float, k: float, absorbed: float = 0.0) -> tuple[Array, float, float]:
    """What waves with harmonics c (2 M + 1,) leave behind: F_x/Q, F_y/Q and k M_z/Q about the origin (3,); E by energy;
    E by the shadow, -2 pi Re S(b). absorbed: pi k P/(rho g c_g)."""
    m = np.arange(c.size) - c.size // 2
    turn = np.exp(1j * m * heading)
    lost = 2.0 * np.pi * float(np.sum(np.abs(c) ** 2)) + absorbed
    force = np.exp(1j * heading) * lost - 2.0 * np.pi * np.sum(c[:-1] * c[1:].conj())
    yaw = 2.0 * np.pi * float(np.sum(m * np.abs(c) ** 2) + np.sum(1j * m * c * turn).imag)
    return np.array([force.real, force.imag, yaw]), lost, float(-2.0 * np.pi * np.sum(c * turn).real)


def mean_drift(
    fields: Sequence[tuple[Complex, Complex]],
    xi: Complex,
    headings: Array,
    reference_point: Sequence[float] | Array,
    *,
    omega: Array,
    k: Array,
    depth: float,
    density: float,
    gravity: float,
    damping: Any = None,
) -> tuple[Array, float]:
    """Mean drift (n, m, 6) as in `HydroDatabase.mean_drift`, heave, roll and pitch zero; and how far the energies are
    apart that the wave loses and the body sends off, the largest share of it (or of a tenth of the largest there is).

    fields  per frequency: harmonics radiated (6, .) and scattered at each heading (m, .), about the z axis
    xi      (n, m, 6) motions per metre of wave, zero for a body held fixed; damping (6, 6) beside radiation
    """
    n, m = omega.size, headings.size
    drift, lost, shadow = np.zeros((n, m, 6)), np.zeros((n, m)), np.zeros((n, m))
    D = _symmetric(damping)
    for i, (radiated, scattered) in enumerate(fields):
        speed = group_speed(omega[i], k[i], depth)
        Q = density * gravity * speed / (np.pi * omega[i])
        for j in range(m):
            power = 0.5 * omega[i] ** 2 * float((xi[i, j].conj() @ D @ xi[i, j]).real)
            absorbed = np.pi * k[i] * power / (density * gravity * speed)
            taken, lost[i, j], shadow[i, j] = momentum(scattered[j] + xi[i, j] @ radiated, headings[j], k[i], absorbed)
            drift[i, j, [0, 1, 5]] = Q * taken / (1.0, 1.0, k[i])
    x, y = reference_point[0], reference_point[1]
    drift[:, :, 5] -= x * drift[:, :, 1] - y * drift[:, :, 0]
    error = np.abs(shadow - lost) / np.maximum(lost, 0.1 * max(float(lost.max()), np.finfo(float).tiny))
    return drift, float(error.max())


def check_motion(motion: Any, bodies: Sequence[str]) -> list[str]:
    """Problems with what `compute_database` was given as `drift`."""
    if motion is None:
        return []
    if len(bodies) > 1:
        return [f"drift: the waves far away tell that of all {len(bodies)} bodies together, not of each; leave it out, "
                "or compute them one by one"]  # fmt: skip
    if isinstance(motion, FreeFloating):
        try:
            return motion.problems()
        except (TypeError, ValueError) as error:
            raise ModelError(f"drift: {motion!r}: {error}") from None
    return [] if motion == "fixed" else [f"drift: got {motion!r}; FreeFloating(...), 'fixed' or None is allowed"]
