"""Figures of VolturnUS-S in focused groups and of Waves4Power's absorber, for docs/make_figures.py."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from make_figures import BLACK, COLORS, panels


def volturnus_focused() -> Any:
    """Elevation, surge, heave and pitch of both groups, all variants."""
    import test_volturnus_focused as test

    import floatsim as fs

    model = test.model
    figure, axes = panels(9.0, 8.0, "AB;CD;EF;GH", sharex=True)
    labels = ("elevation [m]", "surge [m]", "heave [m]", "pitch [deg]")
    for column, (which, (tp, crest)) in enumerate(model.GROUPS.items()):
        mine = axes[column::2]
        for (name, options), color in zip(model.VARIANTS.items(), COLORS):
            run = fs.simulate(model.build(which, **options), model.DURATION, model.STEP)
            keep = (run.time > model.FOCUS - 6.0) & (run.time < model.FOCUS + 8.0)
            t = run.time[keep] - model.FOCUS
            if name == "linear":
                mine[0].plot(t, run.series("wave_elevation")[keep], color=BLACK)
            q = run.series("platform_position")[keep][:, [0, 2, 4]] * (1.0, 1.0, 180.0 / math.pi)
            for ax, y in zip(mine[1:], q.T):
                ax.plot(t, y, color=color, label=name)
        mine[0].axhline(crest, color="0.5", linestyle=":", linewidth=0.9)
        mine[0].set_title(f"Tp {tp} s, crest {crest} m, 1:70")
        mine[-1].set_xlabel("time from the focus [s]")
        if column == 0:
            for ax, label in zip(mine, labels):
                ax.set_ylabel(label)
            mine[1].legend()
    return figure


def waves4power() -> Any:
    """Heave, power and tensions in the sea of the tests."""
    import test_waves4power as test

    run = test.irregular()
    figure, (heave, power, tension) = panels(9.0, 6.0, "A;B;C", sharex=True)
    heave.plot(run.time, run.series("wave_elevation"), color="0.6", label="elevation")
    heave.plot(run.time, run.series("absorber_position")[:, 2], color=COLORS[0], label="heave of the absorber")
    heave.set(ylabel="[m]", title="Hs 3 m, Tp 9 s")
    heave.legend(loc="upper left", ncols=2)
    power.plot(run.time, run.series("pto_power") / 1e3, color=COLORS[1])
    power.set(ylabel="power [kW]")
    for k, color in ((1, COLORS[0]), (2, COLORS[1])):  # the third is the second's image
        for rope, style in (("lower", "-"), ("upper", "--")):
            tension.plot(run.time, np.max(run.series(f"{rope}_{k}_tension"), axis=1) / 1e3, style, color=color,
                         linewidth=0.9, label=f"{rope} rope {k}")  # fmt: skip
    tension.set(xlabel="time [s]", ylabel="largest tension [kN]")
    tension.legend(loc="upper left", ncols=4)
    return figure


FIGURES = {
    "volturnus_focused": (volturnus_focused, "VolturnUS-S at 1:70 in two focused groups: elevation, surge, heave "
                          "and pitch; linear, with nonlinear Froude-Krylov forces, with drag."),
    "waves4power": (waves4power, "Waves4Power's absorber in Hs 3 m, Tp 9 s: elevation and heave, power, largest "
                    "tensions in the ropes."),
}  # fmt: skip
