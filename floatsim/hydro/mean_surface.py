"""Linear Froude-Krylov force on the panels of a database: what the undisturbed wave does to the hull at rest.

    X_i(w, b) = - rho g int cosh k(z + h)/cosh(k h) e^{-i k(x cos b + y sin b)} n_i dA,

n out of the body, n_4..6 = (r - r_ref) x n, over the wetted surface at the drawing position (Newman, Marine
Hydrodynamics, 1977, 6.17). Each panel is the bilinear patch of its four corners (of three, if two coincide), with 2 x 2
Gauss points: exact for cubic pressures on a flat panel.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from floatsim.errors import ModelError
from floatsim.frames import Array
from floatsim.hydro.database import HydroDatabase
from floatsim.jit import kernel
from floatsim.sea.dispersion import wave_number


def with_froude_krylov(db: HydroDatabase) -> HydroDatabase:
    """The same database with `froude_krylov` from its panels; itself if it has one. Raises ModelError as below."""
    return db if db.froude_krylov is not None else replace(db, froude_krylov=froude_krylov_of(db))


def froude_krylov_of(db: HydroDatabase) -> np.ndarray:
    """Froude-Krylov force per wave amplitude (n, m, 6 N), N/m and N, as in `HydroDatabase.froude_krylov`.

    Raises ModelError if the database has no panels, or if they are not the closed wetted surface: what they enclose
    must be its displaced volume within 2 %.
    """
    if db.hull_vertices is None or db.hull_faces is None:
        raise ModelError(
            f"hydrodynamic database '{db.name}': has no panels (hull_vertices, hull_faces) to integrate pressure over"
        )
    owner = np.zeros(len(db.hull_faces), dtype=np.int64) if db.hull_body is None else db.hull_body
    k = wave_number(db.omega, db.depth, db.gravity)
    X = np.zeros((2, db.omega.size, db.headings.size, 6 * len(db.bodies)))
    for body, volume in enumerate(db.volume):
        x, n = _points(db.hull_vertices[db.hull_faces[owner == body]])
        enclosed = float(x[:, 2] @ n[:, 2])  # the lid at z = 0 adds nothing
        if not abs(enclosed / volume - 1.0) <= 0.02:
            raise ModelError(
                f"hydrodynamic database '{db.name}': the panels of '{db.bodies[body]}' enclose {enclosed:.5g} m3 below "
                f"the waterline, it displaces {volume:.5g} m3 (2 % are allowed); are they the wetted hull, outward?"
            )
        w = np.concatenate([n, np.cross(x - db.reference_point[body], n)], axis=1)
        part = np.zeros((2, db.omega.size, db.headings.size, 6))
        _integrate(x, -db.density * db.gravity * w, k, np.stack([np.cos(db.headings), np.sin(db.headings)]),
                   min(db.depth, 1e6), part)  # fmt: skip
        X[..., 6 * body : 6 * body + 6] = part
    return np.asarray(X[0] + 1j * X[1])


def _points(corners: Array) -> tuple[Array, Array]:
    """Gauss points (4 q, 3) and n dA there (4 q, 3) of panels (q, 4, 3)."""
    a, b, c, d = corners.swapaxes(0, 1)
    x, n = [], []
    for u in 0.5 + np.array([-0.5, 0.5]) / math.sqrt(3.0):
        for v in 0.5 + np.array([-0.5, 0.5]) / math.sqrt(3.0):
            x.append((1.0 - u) * (1.0 - v) * a + u * (1.0 - v) * b + u * v * c + (1.0 - u) * v * d)
            n.append(0.25 * np.cross((1.0 - v) * (b - a) + v * (c - d), (1.0 - u) * (d - a) + u * (c - b)))
    return np.concatenate(x), np.concatenate(n)


@kernel
def _integrate(x, w, k, heading, depth, X):  # type: ignore[no-untyped-def]
    """X (2, n, m, 6) += sum over points of w times the decay and e^{-i k s}; heading (2, m): cos, sin."""
    for i in range(k.shape[0]):
        for p in range(x.shape[0]):
            decay = math.exp(k[i] * x[p, 2])  # cosh k(z + h)/cosh(k h)
            decay *= (1.0 + math.exp(-2.0 * k[i] * (x[p, 2] + depth))) / (1.0 + math.exp(-2.0 * k[i] * depth))
            for m in range(heading.shape[1]):
                theta = k[i] * (x[p, 0] * heading[0, m] + x[p, 1] * heading[1, m])
                c, s = decay * math.cos(theta), -decay * math.sin(theta)
                for d in range(6):
                    X[0, i, m, d] += c * w[p, d]
                    X[1, i, m, d] += s * w[p, d]
