"""Figures of the heaving spheres and of the ellipsoid in steep waves; see make_figures.py.

python docs/figures_spheres.py [NAME ...]
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import make_figures
import numpy as np
from make_figures import BLACK, BLUE, GREEN, ORANGE, panels

KINDS = ((False, "linear", BLUE), (True, "nonlinear", ORANGE))


def sphere_oes() -> Any:
    import test_sphere as test

    figure, (small, off, large) = panels(9.0, 4.2, "AC;BC", height_ratios=(2, 1))
    when, low, high = test.BAND_STEP * np.arange(1, 1 + len(test.BAND[0])), *np.array(test.BAND)
    small.fill_between(when, low, high, color="0.75", linewidth=0.0, label="participants")
    off.fill_between(when, 0.5 * (low - high), 0.5 * (high - low), color="0.75", linewidth=0.0)
    for nonlinear, label, color in KINDS:
        time, z = test.drop("oes", 1.0, nonlinear)
        small.plot(time, z, color=color, label=label)
        off.plot(when, np.interp(when, time, z) - 0.5 * (low + high), color=color)
        time, z = test.drop("oes", 5.0, nonlinear)
        large.plot(time, 5.0 * z, color=color, label=label)
    small.set(ylabel="heave [m]", xlim=(0.0, 10.0), title="released from 1 m")
    off.set(xlabel="time [s]", ylabel="less mid-band [m]", xlim=(0.0, 10.0))
    large.set(xlabel="time [s]", ylabel="heave [m]", xlim=(0.0, 20.0), title="released from 5 m")
    small.legend()
    large.legend()
    return figure


def sphere_kramer() -> Any:
    import test_sphere as test

    figure, (heave, off) = panels(9.0, 4.6, "A;B", sharex=True, height_ratios=(2, 1))
    when = test.MEASURED_STEP * np.arange(len(test.MEASURED))
    heave.plot(when, test.MEASURED, "o", color=BLACK, markersize=3.0, label="measured")
    for nonlinear, label, color in KINDS:
        time, z = test.drop("kramer", 0.03, nonlinear)
        heave.plot(time, z, color=color, label=label)
        off.plot(when, np.interp(when, time, z) - test.MEASURED, color=color)
    heave.set(ylabel="heave over 30 mm", xlim=(0.0, 1.9))
    heave.legend(ncols=3)
    off.set(xlabel="time [s]", ylabel="less the measured")
    return figure


def sphere_drops() -> Any:
    import test_sphere as test

    figure, axes = panels(9.0, 3.4, "ABC", sharey=True)
    for share, ax in zip((0.1, 0.3, 0.5), axes, strict=True):
        for nonlinear, label, color in KINDS:
            ax.plot(*test.drop("kramer", 0.3 * share, nonlinear), color=color, label=label)
        ax.set(xlabel="time [s]", xlim=(0.0, 2.4), title=f"released from {share:g} D")
    axes[0].set_ylabel("heave over the drop's height")
    axes[0].legend()
    return figure


def ellipsoid() -> Any:
    import test_ellipsoid as test

    height, period = test.ellipsoid.HEIGHT, test.ellipsoid.PERIOD
    figure, (heave, force) = panels(9.0, 4.6, "A;B", sharex=True)
    for nonlinear, label, color in KINDS:
        run = test.run(nonlinear, height)
        water = test.ellipsoid.MASS * run.series("ellipsoid_acceleration")[:, 2] - run.series("pto_force")
        heave.plot(run.time, run.series("ellipsoid_position")[:, 2], color=color, label=label)
        force.plot(run.time, water / 1e3, color=color)
    start = run.time[-1] - 4.0 * period
    wave = 0.5 * height * np.cos(2.0 * np.pi / period * run.time)
    heave.plot(run.time, wave, ":", color=GREEN, linewidth=1.0, label="undisturbed wave")
    heave.set(ylabel="heave [m]", xlim=(start, run.time[-1]))
    heave.legend(ncols=3)
    force.set(xlabel="time [s]", ylabel="force of the water less weight [kN]")
    return figure


FIGURES: dict[str, tuple[Callable[[], Any], str]] = {
    "sphere_oes": (sphere_oes, "Sphere of the OES Task 10 released from 1 m, beside the range of six participants, and "
                   "from 5 m."),
    "sphere_kramer": (sphere_kramer, "Sphere of Kramer et al. dropped from 30 mm: linear and nonlinear against the "
                      "mean of the measurements, and their differences from it."),
    "sphere_drops": (sphere_drops, "The same sphere dropped from 0.1, 0.3 and 0.5 diameters, linear and nonlinear."),
    "ellipsoid": (ellipsoid, "Flat ellipsoid with a damper in a regular wave of 2 m and 6 s: heave and total force of "
                  "the water, linear and nonlinear."),
}  # fmt: skip

if __name__ == "__main__":
    make_figures.FIGURES.update(FIGURES)
    make_figures.main(sys.argv[1:] or list(FIGURES))
