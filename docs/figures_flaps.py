"""Figures of the flaps, OSWEC and F3OF, for make_figures.py."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from make_figures import BLACK, BLUE, COLORS, ORANGE, panels


def oswec() -> Any:
    import test_oswec as test

    figure, (axes,) = panels(9.0, 3.2, "A")
    for nonlinear, style, color, label in (
        (False, "-", BLUE, "floatsim"), (True, "--", ORANGE, "floatsim, nonlinear hydrostatics"),
    ):  # fmt: skip
        time, angle = test.decay(duration=80.0, nonlinear=nonlinear)
        axes.plot(time, angle, style, color=color, label=label)
    extrema = np.array(((0.0, 10.0), *test.EXTREMA, *test.LATER))
    axes.plot(*extrema.T, "o", color=BLACK, label="WEC-Sim")
    axes.set(xlabel="time [s]", ylabel="pitch [deg]", title="flap let go at 10 deg")
    axes.legend(ncols=3, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    return figure


def f3of() -> Any:
    import test_f3of as test

    import floatsim as fs

    figure, (axes,) = panels(9.0, 3.2, "A")
    decay = fs.decay_test(test.f3of.build(), "surge", 5.0, body="base", duration=150.0)
    axes.plot(decay.run.time, decay.run.series("base_position")[:, 0], color=BLUE, label="floatsim")
    for (name, extrema), color, marker in zip(test.SERIES.items(), COLORS[1:], "osv"):
        axes.plot(*np.array(extrema).T, marker, color=color, label=name, linestyle="none")
    reach = np.array(test.SURGE)
    for k in range(1, 7):
        low, high = 0.5 * k * reach
        axes.axvspan(low, high, color="0.9", zorder=0, label="participants' periods" if k == 1 else None)
    axes.set(xlabel="time [s]", ylabel="surge [m]", title="surge decay of 5 m, flaps locked")
    axes.legend(ncols=5, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    return figure


# name: (what draws it, caption)
FIGURES: dict[str, tuple[Callable[[], Any], str]] = {
    "oswec": (oswec, "OSWEC: decay of the flap from 10 degrees, with linear and with nonlinear hydrostatics, and the "
              "extrema of WEC-Sim's series."),
    "f3of": (f3of, "F3OF, test DT1: decay of surge with locked flaps, extrema of three participants of the comparison "
             "and where the extrema of the participants' band of periods, 46.3 to 47.8 s, fall."),
}  # fmt: skip
