"""A fixed vertical cylinder of radius R through the whole depth in a wave: closed forms. Nothing here uses floatsim."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq
from scipy.special import h2vp, jvp


def wave_number(omega: float, depth: float, g: float) -> float:
    """w^2 = g k tanh k h, 1/m."""
    deep = omega**2 / g
    if math.isinf(depth):
        return deep
    return brentq(lambda k: k * math.tanh(k * depth) - deep, deep, 10.0 * deep + 10.0 / depth, xtol=1e-14)


def terms(kR: float) -> int:
    """Harmonics beyond which nothing is left."""
    return math.ceil(kR + 6.0 * kR ** (1.0 / 3.0)) + 10


def scattered(kR: float, heading: float = 0.0, at: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """Harmonics -M..M over theta of S, eta = a S sqrt(2/(pi k r)) e^{i(w t - k r + pi/4)}: MacCamy and Fuchs (1954),
    c_m = - J_m'(kR)/H_m^(2)'(kR) e^{-i m b}; of a cylinder that stands `at` (x, y)/R from the origin."""
    M = terms(kR * (1.0 + math.hypot(*at)))
    m = np.arange(-M, M + 1)
    theta = 2.0 * np.pi * np.arange(4 * M) / (4 * M)
    S = np.exp(1j * np.outer(theta - heading, m)) @ (-jvp(np.abs(m), kR) / h2vp(np.abs(m), kR))
    along = np.stack([np.cos(theta) - math.cos(heading), np.sin(theta) - math.sin(heading)], axis=1) @ at
    return np.exp(-1j * np.outer(m, theta)) @ (S * np.exp(1j * kR * along)) / theta.size


def drift_by_havelock(k: float, R: float, depth: float, rho: float, g: float) -> float:
    """Mean force, N/m2, per amplitude squared: Havelock (1940), The pressure of water waves upon a fixed obstacle, in
    deep water; in finite depth 1 + 2 kh/sinh 2kh times that (the momentum of a wave, Longuet-Higgins 1977)."""
    n = np.arange(terms(k * R))
    moduli = np.abs(h2vp(n, k * R) * h2vp(n + 1, k * R)) ** 2
    total = np.sum((1.0 - n * (n + 1) / (k * R) ** 2) ** 2 / moduli)
    kh = min(k * depth, 300.0)
    return float(4.0 * rho * g / (np.pi**2 * k * (k * R) ** 2) * total * (1.0 + 2.0 * kh / math.sinh(2.0 * kh)))


def drift_by_pressure(k: float, R: float, depth: float, rho: float, g: float) -> float:
    """The same on the cylinder itself: what the wave adds along the waterline, and -1/2 rho u^2 on the wall."""
    theta = 2.0 * np.pi * np.arange(256) / 256
    m = np.arange(terms(k * R))
    # J - J'/H' H on the wall is - 2i/(pi kR H') (Wronskian)
    term = np.where(m == 0, 1.0, 2.0) * (-1j) ** m * -2j / (np.pi * k * R * h2vp(m, k * R))
    eta = np.cos(np.outer(theta, m)) @ term
    slope = -np.sin(np.outer(theta, m)) @ (m * term) / R
    kh = k * depth
    cosh2, sinh2 = (  # integrals of the profile squared
        (0.5 / k, 0.5 / k) if math.isinf(depth) else
        ((math.sinh(2.0 * kh) / (4.0 * k) + sign * 0.5 * depth) / math.cosh(kh) ** 2 for sign in (1.0, -1.0))
    )  # fmt: skip
    omega2 = g * k * math.tanh(min(kh, 300.0))
    speed2 = g**2 / omega2 * (np.abs(slope) ** 2 * cosh2 + np.abs(k * eta) ** 2 * sinh2)
    pressure = 0.25 * rho * speed2 - 0.25 * rho * g * np.abs(eta) ** 2
    return float(np.sum(pressure * np.cos(theta)) * R * 2.0 * np.pi / theta.size)
