"""Draw the figures of docs/verification.md into docs/figures: the models and tables are those of the tests.

python docs/make_figures.py [NAME ...]        all figures, or those named in FIGURES; a few minutes in all
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "docs" / "figures"
BLUE, ORANGE, GREEN, RED, VIOLET = COLORS = ("#1f5f8b", "#d9772b", "#3f8f5b", "#b5384a", "#7a5ba6")
BROWN, BLACK = "#8a6d3b", "0.15"
STYLE = {
    "svg.hashsalt": "floatsim", "svg.fonttype": "none", "font.family": "sans-serif", "font.size": 9.0,
    "axes.titlesize": 9.5, "axes.titlelocation": "left", "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "axes.axisbelow": True, "grid.color": "0.92", "legend.frameon": False, "legend.fontsize": 8.0,
    "lines.linewidth": 1.3, "lines.markersize": 4.0, "path.simplify": True, "path.simplify_threshold": 0.2,
}  # fmt: skip


def panels(width: float, height: float, mosaic: str, **options: Any) -> tuple[Any, list[Any]]:
    """Figure of the given size [inch] and its axes in the order of the mosaic's letters."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.subplot_mosaic(mosaic, **options)
    return figure, [axes[letter] for letter in sorted(axes)]


def magnitude(run: Any, channel: str) -> np.ndarray:
    """Length of a force [kN] at all times."""
    return np.linalg.norm(run.series(channel), axis=1) / 1e3


def cantilever() -> Any:
    import test_cantilever as test

    figure, (error, tip) = panels(9.0, 3.8, "AB")
    density = np.array([0.5, 1.0, 2.0, 4.0, 10.0])
    for (length, mass), color in zip(test.LOADS, COLORS):
        drop = test.elliptic_elastica(length, mass)[0]
        off = [test.static_tip(length=length, tip_mass=mass, elements_per_metre=n)[0] / drop - 1.0 for n in density]
        marker = "o" if length == 10.0 else "s"
        error.loglog(density, 100.0 * np.abs(off), f"{marker}-", color=color, label=f"{length:g} m, {mass / 1e3:g} t")
    bars = np.array(list(test.BARS.items())).T
    error.loglog(*bars, "_", color=BLACK, markersize=16.0, markeredgewidth=1.5, label="bar of the tests")
    error.loglog(density, 1.0 / density**2, ":", color=BLACK, label="slope 2")
    error.set(xlabel="elements per metre", ylabel="error of the tip's drop [%]", title="statics against the elastica")
    error.set_xticks(density, [f"{n:g}" for n in density])
    error.minorticks_off()
    error.legend(ncols=2, loc="lower left")
    model = test.cantilever
    for elements, color in zip((2, 4, 6, 8), COLORS):
        run = model.settling(elements)
        keep = run.time <= 6.0
        height = run.series("tip_position")[keep, 2] - model.HEIGHT
        tip.plot(run.time[keep], height, color=color, label=f"{elements} elements")
    rest = test.heavy_elastica(10.0, 1000.0 * test.G, model.SETTLING_MASS * test.G)
    tip.axhline(-rest, color=BLACK, linestyle="--", linewidth=0.9, label="elastica")
    tip.set(xlabel="time [s]", ylabel="height of the tip [m]", title="settling from undeflected, 10 m, 1 t at the tip")
    tip.legend()
    return figure


def riser() -> Any:
    import test_riser as test

    import floatsim as fs

    figure, both = panels(9.0, 5.0, "A;B")
    titles = {1: "case 1: upper end swings by 10 m in 27 s", 4: "case 4: wave of 10 m height and 10 s"}
    for axes, (case, (lead, step, curve)) in zip(both, test.CURVES.items()):
        times = 5.5 + step * np.arange(len(curve))  # the curves start there
        run = fs.simulate(test.riser.build(case), lead + times[-1] + 0.5, 0.1, channels=["riser_end_b_force"])
        keep = run.time >= lead + 5.0
        axes.plot(run.time[keep] - lead, magnitude(run, "riser_end_b_force")[keep], color=BLUE, label="floatsim")
        axes.plot(times, curve, "o", color=ORANGE, label="OrcaFlex")
        axes.set(ylabel="force at the top [kN]", title=titles[case])
    both[1].set_xlabel("time [s]")
    both[0].legend(ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    return figure


def chain() -> Any:
    import test_chain_orcaflex as test

    import floatsim as fs

    figure, both = panels(9.0, 5.0, "A;B")
    for axes, (depth, (static, _, _, curve)) in zip(both, test.CASES.items()):
        times = 0.4 * np.arange(len(curve))
        run = fs.simulate(test.chain.build(depth), test.LEAD + times[-1], 0.1, channels=["chain_end_b_force"])
        keep = run.time >= test.LEAD - 1e-6
        axes.plot(run.time[keep] - test.LEAD, magnitude(run, "chain_end_b_force")[keep], color=BLUE, label="floatsim")
        axes.plot(times, curve, "o", color=ORANGE, label="OrcaFlex")
        axes.axhline(static, color=BLACK, linestyle="--", linewidth=0.9, label="at rest, quasi-static codes")
        axes.set(ylabel="force at the fairlead [kN]", title=f"{depth} m deep, heave of +-2 m in 10 s")
    both[1].set_xlabel("time [s]")
    both[0].legend(ncols=3, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    return figure


def lazy_wave_targets() -> dict[str, float]:
    """Numbers of the equilibrium by MoorDyn as the model's docstring states them: m, m, m, kN, kN, N m."""
    from shipped import load

    text = " ".join((load("lazy_wave").__doc__ or "").split())
    patterns = {
        "sag": r"sag at z (\S+) m", "hog": r"hog at (\S+) m", "touchdown": r"touchdown at (\S+) m",
        "top": r"(\S+) kN in the first element", "bed": r"(\S+) kN on the bed", "moment": r"largest moment (\S+) N m",
    }  # fmt: skip
    return {name: float(re.search(pattern, text)[1]) for name, pattern in patterns.items()}  # type: ignore[index]


def lazy_wave() -> Any:
    from shipped import load

    import floatsim as fs
    from floatsim.study.channels import Sampler

    module, target = load("lazy_wave"), lazy_wave_targets()
    model = module.build()
    system = fs.assemble(model)
    sampler = Sampler(system, ["cable_position", "cable_tension", "cable_bending_moment"])
    row = sampler.sample_state(fs.solve_static(system)[0])[None]
    x, tension, moment = (sampler.column(row, channel.name)[0] for channel in sampler.channels)
    s, depth = model.parts[0].arc_length, model.sea.depth
    ends = np.cumsum([piece.length for piece in model.parts[0].pieces])
    buoyant = (s >= ends[0] - 1e-6) & (s <= ends[1] + 1e-6)
    figure, (shape, force, bent) = panels(9.0, 6.4, "AA;BC", height_ratios=(1.25, 1.0))
    shape.plot(x[:, 0], x[:, 2], color=BLUE, label="cable")
    shape.plot(x[buoyant, 0], x[buoyant, 2], color=BLUE, linewidth=4.0, solid_capstyle="butt", label="buoyant section")
    shape.axhline(-depth, color=BROWN, linewidth=2.5, zorder=1, label="seabed")
    hog = np.flatnonzero(buoyant)[np.argmax(x[buoyant, 2])]
    sag = np.argmin(x[:hog, 2])
    middle = 0.5 * (s[1:] + s[:-1])
    touch = np.interp(target["touchdown"], s, x[:, 0])
    marks = {"marker": "o", "linestyle": "none", "color": ORANGE, "markersize": 6.0, "zorder": 5}
    shape.plot((x[sag, 0], x[hog, 0], touch), (target["sag"], target["hog"], -depth), label="MoorDyn", **marks)
    for place, name, up in ((x[sag, 0], "sag", -11.0), (x[hog, 0], "hog", 6.0)):
        z = target[name]
        shape.text(place, z + up, f"{name} at {z:g} m", ha="center", va="center", fontsize=8.0)
    shape.text(touch + 4.0, 6.0 - depth, f"touchdown at s = {target['touchdown']:g} m", fontsize=8.0)
    shape.set(xlabel="x [m]", ylabel="z [m]", title="shape at rest", ylim=(-depth - 5.0, 3.0))
    shape.set_aspect("equal")
    shape.legend(loc="center left", bbox_to_anchor=(1.02, 0.5))
    force.plot(middle, tension / 1e3, color=BLUE)
    force.plot((middle[0], middle[-1]), (target["top"], target["bed"]), **marks)
    force.text(8.0, target["top"], f"{target['top']:.2f} kN", fontsize=8.0, va="center")
    force.text(s[-1], target["bed"] + 0.8, f"{target['bed']:.2f} kN", fontsize=8.0, ha="right")
    force.set(ylabel="effective tension [kN]")
    bent.plot(s, moment / 1e3, color=BLUE)
    bent.axhline(target["moment"] / 1e3, color=ORANGE, linestyle="--")
    largest = f"largest: {target['moment'] / 1e3:.3f} kN m"
    bent.text(s[-1], 1.02 * target["moment"] / 1e3, largest, fontsize=8.0, ha="right", va="bottom")
    bent.set(ylabel="bending moment [kN m]", ylim=(0.0, 1.15 * target["moment"] / 1e3))
    for axes in (force, bent):
        axes.axvspan(ends[0], ends[1], color="0.95", zorder=0)
        axes.set(xlabel="arc length from the hang-off s [m]", xlim=(-3.0, s[-1] + 3.0))
    return figure


def umbilical() -> Any:
    import test_umbilical as test

    import floatsim as fs

    model = test.umbilical
    figure, (force, bent, moment) = panels(9.0, 6.0, "AA;BC")
    time = 0.1 * (test.FIRST + np.arange(601))
    fine, coarse = (test.signals(dt)[0][1:] for dt in (0.0125, 0.1))
    force.plot(time, fine, color=BLUE, label="step 0.0125 s")
    force.plot(time[::5], coarse[::5], "o", color=ORANGE, markersize=3.0, label="step 0.1 s, every fifth value")
    for name in ("maximum", "mean", "minimum"):
        label = "CableDyn: maximum, mean, minimum" if name == "mean" else None
        force.axhline(test.REFERENCE[name][0], color=BLACK, linestyle="--", linewidth=0.8, label=label)
    force.set(xlabel="time [s]", ylabel="force at the hang-off [kN]", xlim=(time[0], time[-1]),
              title="benchmark motion, hinged hang-off")  # fmt: skip
    force.legend(ncols=3, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    for ends, style, color in zip(("hinged", "clamped", "stiffener"), ("-", "--", "-."), COLORS):
        channels = ["umbilical_curvature", "umbilical_bending_moment"]
        cable = model.build(elements_per_metre=2.0, ends=ends)
        run = fs.simulate(cable, test.DURATION, 0.1, interval=0.1, channels=channels)
        s = next(part for part in cable.parts if isinstance(part, fs.Line)).arc_length
        bends, moments = (run.series(channel)[test.FIRST :].max(axis=0) for channel in channels)
        bent.plot(s, bends, style, color=color, label=ends)
        near = s <= 3.0 * model.STIFFENED_LENGTH
        moment.plot(s[near], moments[near] / 1e3, style, color=color, label=ends)
    arc = "arc length from the hang-off [m]"
    bent.set(xlabel=arc, ylabel="curvature [1/m]", title="largest of 60 to 120 s, three hang-offs")
    moment.set(xlabel=arc, ylabel="bending moment [kN m]", title="the same near the hang-off")
    moment.axvspan(0.0, model.STIFFENED_LENGTH, color="0.95", zorder=0, label="stiffened length")
    for axes in (bent, moment):
        axes.set_ylim(bottom=0.0)
        axes.legend()
    return figure


def snap_load() -> Any:
    import test_step_control as test

    figure, (whole, impact) = panels(9.0, 3.8, "AB", width_ratios=(1.4, 1.0))
    runs = (
        (test.snapped(1e-3, False), "-", BLACK, "step 1 ms"),
        (test.snapped(0.1, False), "^--", RED, "step 0.1 s, no step control"),
        (test.snapped(0.1, True), "o", BLUE, "step 0.1 s, step control"),
    )
    for run, style, color, label in runs:
        pull = magnitude(run, "top_force") / 1e3
        first, dots = run.time <= 2.0, style == "o"
        whole.plot(run.time, pull, style.replace("^", ""), color=color, linewidth=1.0, markersize=2.0, label=label)
        impact.plot(run.time[first], pull[first], style, color=color, linewidth=1.0,
                    markersize=4.5 if dots else 3.5)  # fmt: skip
    whole.set(xlabel="time [s]", ylabel="force at the pulled end [MN]", title="chain of 850 m, pulled at 2 m/s")
    impact.set(xlabel="time [s]", ylabel="force at the pulled end [MN]", title="impact")
    whole.legend(loc="upper left")
    return figure


# name: (what draws it, caption)
FIGURES: dict[str, tuple[Callable[[], Any], str]] = {
    "cantilever": (cantilever, "Cantilever: error of the drop over the elements per metre, and settling of a beam that "
                   "is let go undeflected, against the elastica."),
    "riser": (riser, "Riser of Low & Langley (2006): force at the top in cases 1 and 4 against OrcaFlex."),
    "chain": (chain, "Heaving chain in 50 m and in 200 m: force at the fairlead against OrcaFlex."),
    "lazy_wave": (lazy_wave, "Lazy wave in 82 m: shape, effective tension and bending moment at rest, with the numbers "
                  "of MoorDyn marked; the buoyant section is shaded."),
    "umbilical": (umbilical, "Umbilical under the benchmark motion: force at the hang-off with two steps, largest "
                  "curvature and bending moment with three hang-offs."),
    "snap_load": (snap_load, "Snap load of a chain: output every 0.1 s with and without step control, beside a step of "
                  "1 ms."),
}  # fmt: skip


def every() -> dict[str, tuple[Callable[[], Any], str]]:
    """All figures, those of the pages beside this one too."""
    pages = ("figures_spheres", "figures_rm3", "figures_flaps", "figures_focused")
    return FIGURES | {name: item for page in pages for name, item in import_module(page).FIGURES.items()}


def main(names: list[str]) -> None:
    """Draw the named figures; bytes do not depend on the day or the machine's fonts."""
    import matplotlib

    sys.path[:0] = [str(ROOT / "tests" / kind) for kind in ("", "validation", "verification")]
    sys.path.append(str(ROOT / "models"))
    figures = every()
    FOLDER.mkdir(exist_ok=True)
    for name in names:
        path = FOLDER / f"{name}.svg"
        with matplotlib.rc_context(STYLE):
            figures[name][0]().savefig(path, metadata={"Date": None, "Creator": None})
        path.write_text("\n".join(line.rstrip() for line in path.read_text().splitlines()) + "\n")
        print(f"{path.relative_to(ROOT)}, {path.stat().st_size / 1e3:.0f} kB", flush=True)


if __name__ == "__main__":
    unknown = [name for name in sys.argv[1:] if name not in every()]
    if unknown:
        sys.exit(f"no figure {', '.join(unknown)}; there are {', '.join(every())}")
    main(sys.argv[1:] or list(every()))
