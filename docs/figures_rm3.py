"""Figures of RM3: decay against WEC-Sim, response and power in regular waves, power matrix. See make_figures.py."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from make_figures import BLACK, BLUE, GREEN, ORANGE, RED, panels


def rm3_decay() -> Any:
    import test_rm3 as test

    figure, (buoy, spar) = panels(9.0, 3.6, "AB")
    run = test.released()
    z = test.heaves(run)
    for axes, y, points, name, color in (
        (buoy, z[:, 0], test.FLOAT, "float", BLUE), (spar, z[:, 1], test.SPAR, "spar", ORANGE)
    ):  # fmt: skip
        axes.plot(run.time, y, color=color, label="floatsim")
        axes.plot(*np.array(points).T, "o", color=BLACK, fillstyle="none", label="WEC-Sim, extrema")
        axes.set(xlabel="time [s]", ylabel="heave over the offset of 0.1 m [-]", title=f"{name}, no damper")
        axes.legend()
    buoy.set(xlim=(0.0, 20.0))
    return figure


def rm3_regular() -> Any:
    import test_rm3 as test

    import floatsim as fs

    rm3 = test.rm3
    figure, (motion, response, power) = panels(9.0, 6.0, "AA;BC")
    run = test.regular()
    late = run.time >= 360.0
    for name, color in (("float", BLUE), ("spar", ORANGE)):
        motion.plot(run.time[late], run.series(f"{name}_position")[late, 2], color=color, label=f"{name}, heave")
    motion.plot(run.time[late], run.series("pto_displacement")[late], color=GREEN, label="slider")
    motion.plot(run.time[late], run.series("wave_elevation")[late], ":", color=BLACK, label="wave")
    motion.set(xlabel="time [s]", ylabel="[m]", title="H 2.5 m, T 8 s, damper 1.2e6 N s/m")
    motion.set_ylim(-1.4, 1.9)
    motion.legend(ncols=4, loc="upper center")
    omega = np.arange(0.3, 2.01, 0.025)
    for c, color in ((6e5, RED), (1.2e6, BLUE), (2.4e6, GREEN)):
        found = fs.frequency_response(rm3.build(pto_damping=c), omega)
        velocity = np.abs(found.rao("pto_velocity"))
        response.plot(omega, np.abs(found.rao("pto_displacement")), color=color, label=f"{c / 1e6:g}e6 N s/m")
        power.plot(omega, 0.5e-3 * c * velocity**2, color=color)
    a = 0.5 * test.HEIGHT
    stroke = abs(test.amplitude(run, "pto_displacement"))
    response.plot(test.OMEGA, stroke / a, "o", color=BLACK, fillstyle="none", label="run of 400 s")
    mean = fs.mean_power(run, "pto", since=320.0)
    power.plot(test.OMEGA, mean / a**2 / 1e3, "o", color=BLACK, fillstyle="none")
    response.set(xlabel="frequency [rad/s]", ylabel="slider [m/m]", title="slider's stroke")
    power.set(xlabel="frequency [rad/s]", ylabel="[kW/m²]", title="mean power per wave amplitude squared")
    response.legend()
    return figure


def rm3_power() -> Any:
    import test_rm3 as test

    import floatsim as fs

    rm3 = test.rm3
    figure, (time, frequency) = panels(9.0, 3.2, "AB")
    hs, tp = np.array([1.0, 2.0, 3.0]), np.array([6.0, 7.0, 8.0, 10.0, 12.0])
    model = rm3.build(mooring=rm3.MOORING_STIFFNESS, wave_ramp=60.0)
    matrix = fs.power_matrix(model, hs, tp, duration=900.0, start=120.0)
    linear = np.array([[
        rm3.PTO_DAMPING * fs.frequency_response(
            model, np.linspace(0.2, 2.9, 80), spectrum=fs.Jonswap(hs=h, tp=t), channels=["pto_velocity"]
        ).std("pto_velocity") ** 2 for t in tp] for h in hs])  # fmt: skip
    for axes, values, title in (
        (time, matrix.power, "runs of 15 minutes"), (frequency, linear, "frequency domain, c σ²")
    ):  # fmt: skip
        axes.pcolormesh(values, cmap="Blues", vmin=0.0, vmax=1.3 * linear.max())
        for (i, j), y in np.ndenumerate(values):
            axes.text(j + 0.5, i + 0.5, f"{y / 1e3:.0f}", ha="center", va="center")
        axes.set_xticks(np.arange(len(tp)) + 0.5, [f"{t:g}" for t in tp])
        axes.set_yticks(np.arange(len(hs)) + 0.5, [f"{h:g}" for h in hs])
        axes.set(xlabel="peak period [s]", ylabel="significant height [m]", title=f"mean power [kW], {title}")
        axes.grid(False)
    return figure


FIGURES: dict[str, tuple[Callable[[], Any], str]] = {
    "rm3_decay": (rm3_decay, "RM3: heave of float and spar after the float is released 0.1 m too high, against the "
                  "extrema of WEC-Sim's series."),
    "rm3_regular": (rm3_regular, "RM3 in a regular wave, and stroke and power over the frequency for three dampers, "
                    "with the run marked."),
    "rm3_power": (rm3_power, "RM3: power matrix from 15 minutes of irregular waves a cell, with a random error of "
                  "about 15 %, beside that of the frequency domain."),
}  # fmt: skip
