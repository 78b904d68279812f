"""Closed forms and independent small solutions that the tests compare with. Nothing here uses floatsim."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_bvp, solve_ivp
from scipy.optimize import fsolve


def physical_pendulum(omega0_squared: float, angle: float, times: np.ndarray) -> np.ndarray:
    """theta'' = -omega0^2 sin(theta) from rest at `angle`: rows theta, theta', theta'' at `times`."""
    sol = solve_ivp(
        lambda t, y: (y[1], -omega0_squared * np.sin(y[0])), (0.0, times[-1]), (angle, 0.0),
        method="DOP853", t_eval=times, rtol=1e-13, atol=1e-14,
    )  # fmt: skip
    return np.array([sol.y[0], sol.y[1], -omega0_squared * np.sin(sol.y[0])])


def elastic_catenary(
    x: float, z: float, length: float, EA: float, w: float, seabed: bool
) -> tuple[float, float, float, float]:
    """(H, V_A, V_B, contact length) of a line from A = (0, 0) to B = (x, z), w per unstretched length > 0.

    H pulls B back towards A, V_B is the vertical force that holds B up, V_A = V_B - w length that with which
    the line pulls A up (negative: A carries line). With `seabed` A lies on a frictionless bed at its level.
    Source: Irvine, Cable Structures (1981), chapter 1; Jonkman (2007) NREL/TP-500-41958, eqs. 2-35 to 2-38.
    """

    def suspended(H: float, V: float) -> tuple[float, float]:
        a = V - w * length
        dx = H / w * (np.arcsinh(V / H) - np.arcsinh(a / H)) + H * length / EA
        dz = (np.hypot(H, V) - np.hypot(H, a)) / w + (V**2 - a**2) / (2.0 * EA * w)
        return dx, dz

    def lying(H: float, V: float) -> tuple[float, float]:
        dx = length - V / w + H / w * np.arcsinh(V / H) + H * length / EA
        return dx, (np.hypot(H, V) - H) / w + V**2 / (2.0 * EA * w)

    @np.errstate(all="ignore")  # far starting points overflow and are thrown away
    def solve(form, V0: float) -> np.ndarray:  # type: ignore[no-untyped-def]
        best, found = np.inf, np.zeros(2)
        for H0 in np.geomspace(1e-3, 1e5, 33) * w * length:
            y, info, ok, _ = fsolve(
                lambda y: np.subtract(form(np.exp(y[0]), y[1] * w * length), (x, z)) / length,
                (np.log(H0), V0 / (w * length) + H0 * z / (x * w * length) * (not seabed)),
                full_output=True, xtol=1e-13,
            )  # fmt: skip
            gap = np.abs(info["fvec"]).max()
            if gap < best:
                best, found = gap, np.array([np.exp(y[0]), y[1] * w * length])
        if best > 1e-9:
            raise ValueError(f"the catenary does not close: {best:g}")
        return found

    if seabed:
        H, V = solve(lying, 0.5 * w * length)
        if 0.0 < V < w * length:
            return H, 0.0, V, length - V / w
    H, V = solve(suspended, w * length * (0.5 + 0.5 * z / x))
    return H, V - w * length, V, 0.0


def elastica(EI: float, length: float, load: float) -> tuple[float, float, float]:
    """(drop, x of the tip, curvature at the root) of a clamped inextensible beam, dead load downwards at the tip.

    EI phi'' = -load cos(phi), phi(0) = 0 at the root, phi'(L) = 0; phi is the slope below the horizontal
    (Euler's elastica, e.g. Bisshopp & Drucker 1945).
    """
    k = load * length**2 / EI
    s = np.linspace(0.0, 1.0, 101)
    sol = solve_bvp(
        lambda s, y: np.array([y[1], -k * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])]),
        lambda a, b: np.array([a[0], b[1], a[2], a[3]]),
        s, np.array([k * (s - s**2 / 2), k * (1 - s), s, 0 * s]) / np.array([[1 + k], [1 + k], [1], [1]]),
        tol=1e-10, max_nodes=100000,
    )  # fmt: skip
    if not sol.success:
        raise ValueError(sol.message)
    tip = sol.sol(1.0)
    return length * tip[3], length * tip[2], float(sol.sol(0.0)[1]) / length
