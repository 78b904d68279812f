"""The Newmark family in the Arnold-Bruls form.

    dq      = h v_n + h^2 [(1/2 - beta) a_n + beta a_{n+1}],     q_{n+1} = q_n o exp(dq)
    v_{n+1} = v_n + h [(1 - gamma) a_n + gamma a_{n+1}]
    (1 - am) a_{n+1} + am a_n = (1 - af) v'_{n+1} + af v'_n

with the equations of motion satisfied *at* t_{n+1} by the true acceleration v'; a is an auxiliary
acceleration. Second order in positions, velocities and multipliers when gamma = 1/2 + af - am
(Arnold & Bruls 2007, Multibody System Dynamics 18; Bruls, Cardona & Arnold 2012, Mechanism and
Machine Theory 48, for rotations). Other gammas are first order.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from floatsim.description import is_number
from floatsim.errors import CaseError


class Scheme(NamedTuple):
    """Coefficients of one member of the family, and its spectral radius at infinite frequency."""

    name: str
    beta: float
    gamma: float
    alpha_m: float
    alpha_f: float
    rho_inf: float


def generalised_alpha(rho_inf: float = 0.6) -> Scheme:
    """Chung & Hulbert's optimum for a given high-frequency spectral radius 0 <= rho_inf <= 1."""
    if not (is_number(rho_inf) and 0.0 <= rho_inf <= 1.0):
        raise CaseError(f"generalised_alpha: rho_inf is {rho_inf!r}; 0 to 1 is allowed")
    am, af = (2.0 * rho_inf - 1.0) / (rho_inf + 1.0), rho_inf / (rho_inf + 1.0)
    gamma = 0.5 + af - am
    return Scheme(f"generalised_alpha(rho_inf={rho_inf:g})", 0.25 * (gamma + 0.5) ** 2, gamma, am, af, rho_inf)


def hht(alpha: float = 0.05) -> Scheme:
    """Hilber, Hughes & Taylor with 0 <= alpha <= 1/3 (their alpha with the sign turned)."""
    if not (is_number(alpha) and 0.0 <= alpha <= 1.0 / 3.0):
        raise CaseError(f"hht: alpha is {alpha!r}; 0 to 1/3 is allowed")
    return Scheme(f"hht(alpha={alpha:g})", 0.25 * (1.0 + alpha) ** 2, 0.5 + alpha, 0.0, alpha,
                  (1.0 - alpha) / (1.0 + alpha))  # fmt: skip


def newmark(beta: float = 0.25, gamma: float = 0.5) -> Scheme:
    """Classical Newmark; second order only for gamma = 1/2, unconditionally stable for 2 beta >= gamma >= 1/2."""
    if not (is_number(beta) and is_number(gamma) and gamma >= 0.5 and 2.0 * beta >= gamma):
        raise CaseError(f"newmark: got beta {beta!r}, gamma {gamma!r}; 2 beta >= gamma >= 1/2 is allowed")
    roots = np.roots([beta, gamma + 0.5 - 2.0 * beta, 0.5 - gamma + beta])
    return Scheme(f"newmark(beta={beta:g}, gamma={gamma:g})", beta, gamma, 0.0, 0.0, float(np.abs(roots).max()))
