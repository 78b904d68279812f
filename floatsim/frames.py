"""Rotations, and the frame conventions of the whole package.

World W: right-handed, origin at mean sea level, x downwind, z up. Body B: fixed in the body, origin
at its reference point, axes parallel to W at heading 0 of the drawing position.

    p_WB   position of B from W, in W          v_WB, w_WB   linear and angular velocity, in W
    R_WB   rotation matrix, v_W = R_WB v_B     rotation vector: axis times angle, in W

Rotations in the state are unit quaternions (w, x, y, z). Increments are *spatial* rotation vectors,
R_new = exp(phi) R_old, so angular velocity, hydrodynamic coefficients and joint moments share the
world's axes. (The body-fixed increment gives the same order, but needs R on both sides of every
hydrodynamic matrix.) Output angles: R_WB = Rz(yaw) Ry(pitch) Rx(roll).

Kernels work on tuples of three floats: no allocation, and the formulas read as in the textbook.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from floatsim.jit import kernel

Array = NDArray[np.float64]


@kernel
def cross(a, b):  # type: ignore[no-untyped-def]
    """a x b of two 3-tuples."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@kernel
def dot(a, b):  # type: ignore[no-untyped-def]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def plus(a, b):  # type: ignore[no-untyped-def]
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@kernel
def minus(a, b):  # type: ignore[no-untyped-def]
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@kernel
def times(s, a):  # type: ignore[no-untyped-def]
    return (s * a[0], s * a[1], s * a[2])


@kernel
def vec(m, i):  # type: ignore[no-untyped-def]
    """Row i of a 2-D array as a tuple."""
    return (m[i, 0], m[i, 1], m[i, 2])


@kernel
def at(v, i):  # type: ignore[no-untyped-def]
    """Three entries of a 1-D array from index i as a tuple."""
    return (v[i], v[i + 1], v[i + 2])


@kernel
def unit(j):  # type: ignore[no-untyped-def]
    """Unit vector of axis j."""
    return (1.0 if j == 0 else 0.0, 1.0 if j == 1 else 0.0, 1.0 if j == 2 else 0.0)


@kernel
def rotate(R, i, a):  # type: ignore[no-untyped-def]
    """R[i] a."""
    return (
        R[i, 0, 0] * a[0] + R[i, 0, 1] * a[1] + R[i, 0, 2] * a[2],
        R[i, 1, 0] * a[0] + R[i, 1, 1] * a[1] + R[i, 1, 2] * a[2],
        R[i, 2, 0] * a[0] + R[i, 2, 1] * a[1] + R[i, 2, 2] * a[2],
    )


@kernel
def unrotate(R, i, a):  # type: ignore[no-untyped-def]
    """R[i]^T a."""
    return (
        R[i, 0, 0] * a[0] + R[i, 1, 0] * a[1] + R[i, 2, 0] * a[2],
        R[i, 0, 1] * a[0] + R[i, 1, 1] * a[1] + R[i, 2, 1] * a[2],
        R[i, 0, 2] * a[0] + R[i, 1, 2] * a[1] + R[i, 2, 2] * a[2],
    )


@kernel
def turn_quaternion(phi, q):  # type: ignore[no-untyped-def]
    """Quaternion of exp(phi) R(q), normalised. phi: rotation vector (3-tuple), q: 4-tuple."""
    angle2 = dot(phi, phi)
    half = 0.5 * math.sqrt(angle2)
    # sin(half)/angle by series near zero: the next term is 1e-18 relative
    s = 0.5 - angle2 / 48.0 if half < 1e-4 else math.sin(half) / (2.0 * half)
    w, x, y, z = math.cos(half), s * phi[0], s * phi[1], s * phi[2]
    a = w * q[0] - x * q[1] - y * q[2] - z * q[3]
    b = w * q[1] + x * q[0] + y * q[3] - z * q[2]
    c = w * q[2] - x * q[3] + y * q[0] + z * q[1]
    d = w * q[3] + x * q[2] - y * q[1] + z * q[0]
    n = 1.0 / math.sqrt(a * a + b * b + c * c + d * d)
    return (a * n, b * n, c * n, d * n)


@kernel
def set_matrix(R, i, q):  # type: ignore[no-untyped-def]
    """R[i] = rotation matrix of the unit quaternion q."""
    w, x, y, z = q
    R[i, 0, 0] = 1.0 - 2.0 * (y * y + z * z)
    R[i, 0, 1] = 2.0 * (x * y - w * z)
    R[i, 0, 2] = 2.0 * (x * z + w * y)
    R[i, 1, 0] = 2.0 * (x * y + w * z)
    R[i, 1, 1] = 1.0 - 2.0 * (x * x + z * z)
    R[i, 1, 2] = 2.0 * (y * z - w * x)
    R[i, 2, 0] = 2.0 * (x * z - w * y)
    R[i, 2, 1] = 2.0 * (y * z + w * x)
    R[i, 2, 2] = 1.0 - 2.0 * (x * x + y * y)


def matrix_from_angles(roll: float, pitch: float, yaw: float) -> Array:
    """R_WB = Rz(yaw) Ry(pitch) Rx(roll), angles in rad. Shape (3, 3)."""
    cr, sr, cp, sp, cy, sy = (
        math.cos(roll), math.sin(roll), math.cos(pitch), math.sin(pitch), math.cos(yaw), math.sin(yaw)
    )  # fmt: skip
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def angles_from_matrix(R: Array) -> Array:
    """(roll, pitch, yaw) [rad] of R_WB = Rz(yaw) Ry(pitch) Rx(roll); shapes (..., 3, 3) -> (..., 3).

    At pitch = +-90 deg roll and yaw are not separable; yaw then carries what arctan2 gives. The
    state itself has no such point: it is a quaternion.
    """
    roll = np.arctan2(R[..., 2, 1], R[..., 2, 2])
    pitch = np.arcsin(np.clip(-R[..., 2, 0], -1.0, 1.0))
    yaw = np.arctan2(R[..., 1, 0], R[..., 0, 0])
    return np.stack([roll, pitch, yaw], axis=-1)


def quaternion_from_matrix(R: Array) -> Array:
    """Unit quaternion (w, x, y, z) of a rotation matrix (3, 3), w >= 0."""
    from scipy.spatial.transform import Rotation

    x, y, z, w = Rotation.from_matrix(R).as_quat()
    q = np.array([w, x, y, z])
    return -q if w < 0.0 else q


def skew(a: Array) -> Array:
    """[a]x with [a]x b = a x b. Shape (3, 3)."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
