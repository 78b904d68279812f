"""Heaving spheres: OES Task 10 against its participants, Kramer et al. against their measurement, and the cap.

OES: Wendt et al., IEA OES Task 10 WEC modeling verification and validation, EWTEC 2017 (participants' time series,
MIT and Apache-2.0). BAND is what six of them span (five potential-flow codes, linear or with nonlinear hydrostatics,
and one RANS solution) after a release from 1 m; RAO is what they span without PTO in waves of steepness 0.0005.

Kramer et al., Highly accurate experimental heave decay tests with a floating sphere: a public benchmark dataset for
model validation of fluid-structure interaction, Energies 14 (2021) 269, CC BY 4.0: mean of the repeated drops from
30 mm, every second sample; the 95 % confidence bounds are within 0.008 of it. A first period there is twice the time
between the first two passes through the equilibrium (0.786 s in the measurement). Twice the time to the first trough
is 2 % less, in the measurement as in theory, because a damped motion from rest comes to its trough early.
"""

from __future__ import annotations

import sys
from functools import lru_cache

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from shipped import MODELS

import floatsim as fs
from floatsim.hydro.database import HydroDatabase
from floatsim.study.decay import extrema

sys.path.insert(0, str(MODELS))  # model scripts import their neighbours, as when they are run
import sphere  # noqa: E402

OES = "OES Task 10 sphere against its participants"
KRAMER = "sphere of Kramer et al., dropped from 30 mm"

# every 0.2 s from 0.2 s on: lowest and highest heave [m]
BAND_STEP, BAND = 0.2, ((
    0.959, 0.844, 0.663, 0.433, 0.173, -0.095, -0.350, -0.572, -0.743, -0.851, -0.892, -0.863, -0.771, -0.624,
    -0.439, -0.232, -0.018, 0.185, 0.363, 0.501, 0.592, 0.630, 0.612, 0.530, 0.405, 0.252, 0.086, -0.080,
    -0.230, -0.354, -0.442, -0.488, -0.492, -0.469, -0.415, -0.332, -0.227, -0.113, 0.005, 0.115, 0.209, 0.281,
    0.326, 0.341, 0.324, 0.266, 0.186, 0.095, -0.000, -0.090,
), (
    0.965, 0.856, 0.682, 0.457, 0.202, -0.063, -0.316, -0.537, -0.710, -0.823, -0.868, -0.839, -0.742, -0.588,
    -0.394, -0.177, 0.043, 0.249, 0.423, 0.553, 0.630, 0.650, 0.621, 0.558, 0.454, 0.319, 0.165, 0.007,
    -0.144, -0.275, -0.377, -0.443, -0.466, -0.445, -0.381, -0.280, -0.161, -0.034, 0.088, 0.197, 0.284, 0.342,
    0.369, 0.363, 0.336, 0.297, 0.236, 0.159, 0.073, -0.014,
))  # fmt: skip
MARKS = {  # of the participants, lowest and highest
    "mean of the first two periods": (4.328, 4.407, "s"),
    "first trough": (-0.892, -0.868, "m"),
    "time of the first trough": (2.21, 2.23, "s"),
    "first crest": (0.631, 0.651, "m"),
    "time of the first crest": (4.37, 4.45, "s"),
}
STEEPNESS = 0.0005  # H/(g T^2)
RAO = {3.0: (0.115, 0.118), 4.0: (0.99, 1.18), 4.4: (1.77, 1.88), 5.0: (1.42, 1.53), 6.0: (1.12, 1.16)}  # m/m

# every 0.04 s from 0 on: heave over 30 mm
MEASURED_STEP, MEASURED = 0.04, (
    0.9999, 0.9432, 0.7893, 0.5595, 0.2791, -0.0206, -0.3083, -0.5540, -0.7350, -0.8343, -0.8482, -0.7763, -0.6290,
    -0.4242, -0.1859, 0.0580, 0.2814, 0.4611, 0.5797, 0.6284, 0.6072, 0.5247, 0.3919, 0.2275, 0.0499, -0.1198, -0.2663,
    -0.3761, -0.4399, -0.4535, -0.4183, -0.3408, -0.2308, -0.1037, 0.0277, 0.1471, 0.2425, 0.3059, 0.3324, 0.3209,
    0.2753, 0.2033, 0.1145, 0.0196, -0.0708, -0.1486, -0.2055, -0.2380,
)  # fmt: skip
# s, numerical solutions of the drop by linear potential flow (Cummins) and with nonlinear hydrostatics, for the case of
# Kramer et al. 2021, Energies 14(2), 269
FIRST_PERIOD = {False: 0.7781, True: 0.7813}


@lru_cache
def drop(size: str, height: float, nonlinear: bool) -> tuple[np.ndarray, np.ndarray]:
    """Time [s] and heave over the height of the drop [m]."""
    run = sphere.drop(size, height, nonlinear)
    return run.time, run.series("sphere_position")[:, 2] / height


@pytest.mark.parametrize("nonlinear", [False, True])
def test_oes_decay(nonlinear, record):
    time, z = drop("oes", 1.0, nonlinear)
    when, top = extrema(time, z, 0.0)
    measured = (0.5 * when[4], top[1], when[1], top[2], when[2])
    check = f"{OES}, released from 1 m, {'nonlinear' if nonlinear else 'linear'}"
    for (what, (low, high, unit)), value in zip(MARKS.items(), measured, strict=True):
        record(check, what, value, (low - 0.01 * abs(low), high + 0.01 * abs(high)), unit)
    here = np.interp(BAND_STEP * np.arange(1, 1 + len(BAND[0])), time, z)
    out = np.maximum(np.array(BAND[0]) - here, here - np.array(BAND[1]))
    record(check, "furthest outside their band in the first 10 s", max(out.max(), 0.0), 0.01, "m")


def in_waves(period: float, nonlinear: bool = False) -> fs.Model:
    """The OES sphere in a regular wave of small steepness."""
    height = STEEPNESS * sphere.SIZES["oes"].gravity * period**2
    return sphere.build("oes", nonlinear, waves=fs.RegularWave(height=height, period=period), wave_ramp=20.0)


def heave_response(period: float, nonlinear: bool = False) -> float:
    """Steady heave over the wave's amplitude [m/m], from the time domain."""
    run = fs.simulate(in_waves(period, nonlinear), 20.0 + 14.0 * period, period / 200.0, channels=["sphere_position"])
    assert run.status == "done", run.failure
    last = run.time > run.time[-1] - 4.0 * period + 1e-9
    turns = np.exp(-2j * np.pi * run.time[last] / period)
    height = STEEPNESS * sphere.SIZES["oes"].gravity * period**2
    return 4.0 * abs(np.mean(run.series("sphere_position")[last, 2] * turns)) / height


def from_coefficients(period: float) -> float:
    """The same from A, B, X and C by hand."""
    s = sphere.SIZES["oes"]
    db, w = HydroDatabase.read(s.hydro), 2.0 * np.pi / period
    A, B = (CubicSpline(db.omega, values[:, 2, 2])(w) for values in (db.added_mass, db.radiation_damping))
    X = CubicSpline(db.omega, db.excitation[:, np.argmin(np.abs(db.headings)), 2])(w)
    return float(abs(X / (s.density * s.gravity * np.pi * s.radius**2 - w * w * (s.mass + A) + 1j * w * B)))


@pytest.mark.parametrize("period", RAO)
def test_oes_response(period, record):
    low, high = RAO[period]
    response = heave_response(period)
    record(OES, f"heave response at {period:g} s, no PTO", response, (0.97 * low, 1.03 * high), "m/m")
    off = abs(response / from_coefficients(period) - 1.0)
    record("linear floater: time domain against A, B, C and X", f"OES sphere, {period:g} s", 100.0 * off, 0.5, "%")


@pytest.mark.parametrize("nonlinear", [False, True])
def test_oes_response_in_the_frequency_domain(nonlinear, record):
    """Within the same bands, and as runs in small waves, also for a hull (Froude-Krylov force from the mesh)."""
    periods = sorted(RAO, reverse=True)
    response = fs.frequency_response(sphere.build("oes", nonlinear), 2.0 * np.pi / np.array(periods))
    rao = dict(zip(periods, np.abs(response.rao("sphere_position")[:, 2]), strict=True))
    for period, (low, high) in RAO.items():
        assert 0.97 * low < rao[period] < 1.03 * high
    for period in (4.4, 6.0):
        off = 100.0 * abs(heave_response(period, nonlinear) / rao[period] - 1.0)
        label = "hull" if nonlinear else "linear"
        record("frequency domain against runs in small waves", f"OES sphere ({label}), {period:g} s", off, 1.0, "%")


@pytest.mark.parametrize("nonlinear", [False, True])
def test_kramer_drop(nonlinear, record):
    time, z = drop("kramer", 0.03, nonlinear)
    zero = CubicSpline(time, z).roots(extrapolate=False)
    label, wanted = "nonlinear" if nonlinear else "linear", FIRST_PERIOD[nonlinear]
    record(KRAMER, f"first period, {label}", 2.0 * (zero[1] - zero[0]), (0.99 * wanted, 1.01 * wanted), "s")
    off = np.interp(MEASURED_STEP * np.arange(len(MEASURED)), time, z) - MEASURED
    rms = float(np.sqrt(np.mean(off**2)))
    if nonlinear:
        record(KRAMER, "rms of z/H0 less the measured one over 0..1.9 s, nonlinear", rms, 0.02)
    else:
        assert rms > float(np.sqrt(np.mean((np.interp(MEASURED_STEP * np.arange(len(MEASURED)), *drop(
            "kramer", 0.03, True)) - MEASURED) ** 2)))  # fmt: skip


def test_kramer_drop_is_slower_with_nonlinear_hydrostatics(record):
    """Each period lies within the other's 1 %: what tells them apart is their ratio."""
    T = {}
    for nonlinear in (False, True):
        zero = CubicSpline(*drop("kramer", 0.03, nonlinear)).roots(extrapolate=False)
        T[nonlinear] = zero[1] - zero[0]
    wanted = FIRST_PERIOD[True] / FIRST_PERIOD[False]
    record(KRAMER, "first period, nonlinear over linear", T[True] / T[False], (wanted - 0.0015, wanted + 0.0015))


@pytest.mark.parametrize("share", [0.3, 0.5])
def test_higher_drops_are_slower(share):
    """A sphere that dives is the softer, the higher it comes from; the linear one does not know."""
    times = {}
    for nonlinear in (False, True):
        time, z = drop("kramer", 0.3 * share, nonlinear)
        zero = CubicSpline(time, z).roots(extrapolate=False)
        times[nonlinear] = 2.0 * (zero[1] - zero[0])
    small = FIRST_PERIOD[True] / FIRST_PERIOD[False]
    assert times[True] / times[False] > 1.0 + 5.0 * (small - 1.0)


def test_buoyancy_is_that_of_the_cap(record):
    """Released from half its diameter, just out of the water, with added mass, radiation and 20000 triangles."""
    s = sphere.SIZES["kramer"]
    run = sphere.drop("kramer", s.radius, True, around=100, rings=102)
    z, force = run.series("sphere_position")[:, 2], run.series("sphere_hull_force")[:, 2]
    h = np.clip(s.radius - z, 0.0, 2.0 * s.radius)
    cap = s.density * s.gravity * np.pi * h**2 * (s.radius - h / 3.0)
    half = s.density * s.gravity * 2.0 / 3.0 * np.pi * s.radius**3
    assert np.ptp(z) > 1.75 * s.radius
    check = "sphere dropped from half its diameter, with radiation"
    record(check, "largest error of the buoyancy over the half-submerged displacement",
           100.0 * np.abs(force - cap).max() / half, 0.2, "%")  # fmt: skip


def test_memory_and_step_are_fine_enough(record):
    """Half the grid and step, twice the memory: nothing moves."""
    coarse = drop("kramer", 0.03, False)
    s = sphere.SIZES["kramer"]
    fine = fs.decay_test(
        sphere.build("kramer", memory=2.0 * sphere.MEMORY * s.time, memory_grid=0.5 * sphere.GRID * s.time),
        "heave", 0.03, dt=0.5 * sphere.STEP * s.time, duration=1.9,
    ).run  # fmt: skip
    off = np.interp(fine.time, *coarse) - fine.series("sphere_position")[:, 2] / 0.03
    record(KRAMER, "change of z/H0 with half the memory grid and step, twice the memory", np.abs(off).max(), 1e-3)
