"""Motions and kernels of the radiation memory whose every transform is known in closed form.

The smooth one: B(w) = c w^2 exp(-s^2 w^2/2), from the Gaussian integrals
    K(tau) = c sqrt(2/pi)/s^3 (1 - x^2) exp(-x^2/2),   H(tau) = c sqrt(2/pi)/s (1 - exp(-x^2/2)),   x = tau/s,
    A(w) - A_inf = c sqrt(2/pi)/s (1 - sqrt(2) w s D(w s/sqrt(2))),   D Dawson's integral.
"""

from types import SimpleNamespace

import numpy as np
from scipy.special import dawsn

from floatsim.hydro.radiation import RadiationHistory

S, C = 1.3, 2.0e6
G = C * np.sqrt(2.0 / np.pi)
# any matrix will do: coupled, not symmetric, one row empty
MIX = np.array(
    [
        [1.0, 0.2, -0.3, 0.0, 4.0, 0.0],
        [-0.1, 1.1, 0.0, 3.0, 0.0, 0.0],
        [0.3, 0.1, 2.0, 0.0, 0.5, 0.0],
        [0.0, 2.0, 0.0, 30.0, 1.0, 0.0],
        [-3.0, 0.0, 0.4, 1.0, 25.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    ]
)
A_INF = 10.0 * C * MIX


def K(tau):
    x = tau / S
    return G / S**3 * (1.0 - x**2) * np.exp(-(x**2) / 2.0)


def H(tau):
    return G / S * (1.0 - np.exp(-((tau / S) ** 2) / 2.0))


def database(omega=None, scalar_B=None, scalar_A=None):
    omega = np.arange(1, 101) * 0.06 if omega is None else omega
    B = C * omega**2 * np.exp(-((S * omega) ** 2) / 2.0) if scalar_B is None else scalar_B
    a = S * omega
    A = G / S * (1.0 - np.sqrt(2.0) * a * dawsn(a / np.sqrt(2.0))) if scalar_A is None else scalar_A
    return SimpleNamespace(
        name="smooth",
        omega=omega,
        radiation_damping=B[:, None, None] * MIX,
        added_mass=A[:, None, None] * MIX + A_INF,
        added_mass_inf=A_INF,
    )


def velocity(t):
    """(6, ...) smooth motion with periods from 126 to 8.4 s, starting gently from rest at t = 0."""
    t = np.asarray(t, dtype=float)
    rise = np.where(t < 8.0, np.sin(np.pi * np.clip(t, 0.0, 8.0) / 16.0) ** 4, 1.0)
    w = np.array([0.05, 0.3, 0.6, 0.75, 0.7, 0.5]).reshape((6,) + (1,) * t.ndim)
    scale = np.array([1.0, 0.8, 0.5, 0.05, 0.06, 0.1]).reshape(w.shape)
    return scale * rise * np.sin(w * t + np.arange(6).reshape(w.shape))


NODES, WEIGHTS = np.polynomial.legendre.leggauss(60)


def reference(t):
    """Force by Gauss quadrature of the convolution integral with the closed-form K (gone after 10 s)."""
    panels = np.linspace(0.0, min(t, 14.0), 8)
    half = 0.5 * np.diff(panels)[:, None]
    tau = (0.5 * (panels[1:] + panels[:-1])[:, None] + half * NODES).ravel()
    weight = (half * WEIGHTS).ravel()
    return -MIX @ (velocity(t - tau) @ (weight * K(tau)))


def run(kernel, times, motion=velocity):
    """Forces (n, 6) along `times`, each step prepared, evaluated and committed."""
    history = RadiationHistory(kernel, times[0], motion(times[0]))
    forces = [np.zeros(6)]
    for t in times[1:]:
        v = motion(t)
        history.prepare(t)
        forces.append(history.force(v))
        history.commit(t, v)
    return np.array(forces)


def error(kernel, times, since=0.0):
    """Largest error of each force component over its own peak."""
    exact = np.array([reference(t) if t > 0.0 else np.zeros(6) for t in times])
    difference = np.abs(run(kernel, times) - exact)[times >= since]
    return (difference[:, :5] / np.abs(exact[:, :5]).max(axis=0)).max()
