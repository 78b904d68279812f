"""The picture of the README: the surge decay of VolturnUS-S, with fairlead forces and the moorings' shapes.

    python docs/make_picture.py [PICTURE.png]
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib
import numpy as np

import floatsim as fs
from floatsim.study.script import load_model

matplotlib.use("Agg")
from matplotlib.figure import Figure  # noqa: E402

ROOT = Path(__file__).resolve().parents[1]
BLUE, ORANGE, BROWN, GREY = "#1f5f8b", "#c8642b", "#8a6d3b", "0.45"
# side view, m
HULL = (
    (-58.0, -20.0), (-58.0, 15.0), (-45.5, 15.0), (-45.5, -13.0), (-5.0, -13.0), (-5.0, 15.0), (5.0, 15.0),
    (5.0, -13.0), (19.6, -13.0), (19.6, 15.0), (32.1, 15.0), (32.1, -20.0), (-58.0, -20.0),
)  # fmt: skip


def main(picture: Path) -> None:
    system = fs.assemble(load_model(ROOT / "models" / "volturnus_s.py"))
    test = fs.decay_test(system, "surge", 20.0, duration=600.0)
    run, fit = test.run, test.fit
    figure = Figure(figsize=(9.0, 5.4), layout="constrained")
    surge, force, side = (figure.add_subplot(grid) for grid in _grid(figure))
    surge.plot(run.time, run.series("platform_position")[:, 0], color=BLUE, linewidth=1.6)
    surge.plot(fit.time, fit.value + fit.equilibrium, "o", color=ORANGE, markersize=4)
    surge.axhline(fit.equilibrium, color=GREY, linewidth=0.8, linestyle="--")
    surge.set_ylabel("surge [m]")
    surge.set_title(f"VolturnUS-S, surge decay from 20 m: first cycle {fit.periods[0]:.1f} s", loc="left", fontsize=11)
    for name, color, label in (("mooring_1", BLUE, "mooring 1 (upwind)"), ("mooring_2", ORANGE, "mooring 2")):
        pull = np.linalg.norm(run.series(f"{name}_end_b_force"), axis=1) / 1e6
        force.plot(run.time, pull, color=color, linewidth=1.4, label=label)
    force.set_ylabel("fairlead force [MN]")
    for axes in (surge, force):
        axes.set_xlim(0.0, 600.0)
        axes.set_xlabel("time [s]")
        axes.grid(color="0.92")
    force.legend(frameon=False, fontsize=9, ncols=2)
    position = run.series("platform_position")
    for k, style, text in ((0, "-", "released"), (int(np.argmin(position[:, 0])), ":", "furthest back")):
        for name, color in (("mooring_1", BLUE), ("mooring_2", ORANGE)):
            line = run.series(f"{name}_position")[k]
            side.plot(line[:, 0], line[:, 2], style, color=color, linewidth=1.5)
        x, z = (np.array(HULL) + position[k, [0, 2]]).T
        side.plot(x, z, style, color="0.2", linewidth=1.2, label=text)
    side.axhline(-200.0, color=BROWN, linewidth=2.0)
    side.axhline(0.0, color="#7fb2d6", linewidth=1.0)
    side.set(xlim=(-860.0, 460.0), ylim=(-210.0, 30.0), xlabel="x [m]", ylabel="z [m]")
    side.set_aspect("equal")
    side.legend(frameon=False, fontsize=9, loc="center left", title="seen from the side", title_fontsize=9)
    for axes in (surge, force, side):
        axes.spines[["top", "right"]].set_visible(False)
    picture.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(picture, dpi=110)
    print(f"wrote {picture}, {picture.stat().st_size / 1e3:.0f} kB")


def _grid(figure: Figure) -> list:
    grid = figure.add_gridspec(2, 2, height_ratios=(1.0, 0.8))
    return [grid[0, 0], grid[0, 1], grid[1, :]]


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "images" / "volturnus_surge_decay.png")
