"""A quadratic transfer function known by formula, at every pair of frequencies, of the kind a semi-submersible has:
a surge force that grows where waves are reflected, heave and pitch whose mean drift is small beside what a
finite difference of frequencies adds. And the statistics of a slow force, from the spectrum and from a series.
"""

import numpy as np

from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.qtf import QTF


def formula(first, second):
    """T (..., 6) of difference frequencies, N/m2 and N m/m2: T(w2, w1) is the conjugate of T(w1, w2)."""
    mean, mu = 0.5 * (first + second), first - second
    s = [np.tanh(2.0 * w**2) for w in (first, second)]
    out = np.zeros((*np.broadcast(first, second).shape, 6), complex)
    out[..., 0] = 4e4 * s[0] * s[1] * (1.0 + 1.5j * mu)
    out[..., 2] = 2e4 * np.exp(-mean) * np.exp(-0.8j * mu) * (1.0 + 4.0 * mu**2)
    out[..., 4] = (2e5 * s[0] * s[1] + 4e6 * mu**2) * np.exp(1.2j * mu) + 8e5j * mu
    return out


def sum_formula(first, second):
    """T (..., 6) of sum frequencies: T(w2, w1) is T(w1, w2)."""
    out = np.zeros((*np.broadcast(first, second).shape, 6), complex)
    out[..., 2] = 1e4 * (first * second - 0.5j * (first + second))
    out[..., 4] = 3e5 * np.exp(0.7j * (first + second))
    return out


def synthetic(kind="difference", step=0.05, top=2.5, **changes):
    omega = np.arange(round(0.2 / step), round(top / step) + 1) * step
    T = (formula if kind == "difference" else sum_formula)(omega[:, None], omega)
    values = {"name": "formula", "kind": kind, "omega": omega, "headings": np.zeros(1), "transfer": T[None],
              "reference_point": np.zeros(3)}  # fmt: skip
    return QTF(**(values | changes))


def slow_variance(spectrum, transfer, low, high, top, step):
    """8 int int S(w) S(w + mu) |T(w + mu, w)|^2 dw dmu (6,) over low < mu < high, rad/s, by trapezoids of width step;
    transfer(w) gives T (n, n, 6) of the frequencies w (n,), all pairs; S counts up to top."""
    w = np.arange(round(0.25 / step), round(top / step) + 1) * step
    S, T2 = spectrum.density(w), np.abs(transfer(w)) ** 2
    rows = []
    for j in range(round(low / step), round(high / step) + 1):
        i = np.arange(w.size - j)
        rows.append(np.trapezoid((S[i] * S[i + j])[:, None] * T2[i + j, i], dx=step, axis=0))
    return 8.0 * np.trapezoid(rows, dx=step, axis=0)


def band_variance(series, dt, low, high):
    """Variance (6,) of the series (n, 6) between the frequencies low and high, rad/s, by its Fourier series."""
    n = len(series)
    omega = 2.0 * np.pi * np.fft.rfftfreq(n, dt)
    energy = 2.0 * np.abs(np.fft.rfft(series, axis=0) / n) ** 2
    return energy[(omega >= low) & (omega <= high)].sum(axis=0)


def series(force, sea, times):
    """F (len(times), 6) of a SecondOrder at the origin, without a ramp."""
    out = np.zeros((len(times), 6))
    y = np.empty((2, sea.omega.size))
    for row, t in zip(out, times, strict=True):
        angle = sea.omega * t + sea.phase
        np.multiply(sea.amplitude, np.cos(angle), out=y[0])
        np.multiply(sea.amplitude, np.sin(angle), out=y[1])
        force.add(y, row)
    return out


# --- a floater known by formula ---------------------------------------------------------------------

RHO, GRAVITY, AREA, DRAUGHT = 1025.0, 9.81, 100.0, 15.0
COLUMNS = ((-20.0, 0.0), (12.0, 18.0), (10.0, -20.0))


def excitation(omega, heading):
    """Long-wave force (6,) per amplitude on slender columns in deep water, about the origin (see test_excitation)."""
    k, direction = omega**2 / GRAVITY, np.array([np.cos(heading), np.sin(heading)])
    out = np.zeros(6, complex)
    for x, y in COLUMNS:
        factor = np.exp(-1j * k * (direction @ [x, y]))
        heave = RHO * GRAVITY * AREA * np.exp(-k * DRAUGHT) * factor
        fx, fy = 1j * RHO * omega**2 * AREA * DRAUGHT * factor * direction
        arm = -0.5 * DRAUGHT
        out += [fx, fy, heave, y * heave - arm * fy, arm * fx - x * heave, x * fy - y * fx]
    return out


def mean_drift(omega, heading):
    """(6,) N/m2 and N m/m2: along the waves, with a pitch moment that changes sign."""
    D = 4e4 * np.tanh(2.0 * omega**2) ** 2
    along = np.array([np.cos(heading), np.sin(heading)])
    turning = 2e5 * np.tanh(3.0 * (omega - 0.7))
    return np.array([*(D * along), -5e3 * omega, -turning * along[1], turning * along[0], 1e4 * np.sin(heading)])


def database(step_deg=5.0, **changes):
    omega, headings = 0.05 * np.arange(1, 61), np.radians(np.arange(-180.0, 180.0, step_deg))
    C = np.zeros((6, 6))
    for x, y in COLUMNS:
        C[2, 2:5] += RHO * GRAVITY * AREA * np.array([1.0, y, -x])
    C[3:5, 2] = C[2, 3:5]
    X = np.array([[excitation(w, b) for b in headings] for w in omega])
    D = np.array([[mean_drift(w, b) for b in headings] for w in omega])
    values = {"name": "columns", "omega": omega, "headings": headings, "excitation": X, "mean_drift": D,
              "froude_krylov": 0.6 * X, "hydrostatic_stiffness": C, "added_mass": np.zeros((60, 6, 6)),
              "radiation_damping": np.zeros((60, 6, 6)), "added_mass_inf": np.eye(6), "volume": 4500.0,
              "centre_of_buoyancy": np.zeros(3), "reference_point": np.zeros(3), "depth": np.inf, "density": RHO,
              "gravity": GRAVITY}  # fmt: skip
    return HydroDatabase(**(values | changes))
