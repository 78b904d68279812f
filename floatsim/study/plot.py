"""A page of plots from a result file: motions, PTOs, joints, rotors, lines over the seabed and along their length,
solver history.

Lines are drawn in their vertical plane: that through the ends of one line, or the one that all lines lie in. Along a
line, runs show the mean and a band from the smallest to the largest value. Angles are shown in degrees, forces in kN;
the file itself stays in SI units and radians.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from floatsim.errors import CaseError, nearest
from floatsim.frames import Array
from floatsim.study.ranges import blocks_of, lines_of, open_results, range_graph, span

_MANY = 8  # legends with more entries are left out
_QUIET: dict[str, Any] = {"color": "0.35", "linewidth": 0.9}
_BED, _SURFACE = "#8a6d3b", "#3b78a8"
_FLAT = 0.01  # lines that stray less than this share of their extent from a vertical plane lie in it
_ALONG = {  # quantity along a line -> label, scale
    "tension": ("tension [kN]", 1e-3),
    "curvature": ("curvature [1/m]", 1.0),
    "bending_moment": ("bending moment [kN m]", 1e-3),
    "tension_utilisation": ("tension utilisation [-]", 1.0),
    "curvature_utilisation": ("curvature utilisation [-]", 1.0),
}
_TOLD = {  # channels of one number: ending -> label, scale
    "displacement": "displacement", "velocity": "velocity", "force": "force", "power": "power", "thrust": "thrust",
    "torque": "torque", "speed": "speed", "pitch": "blade pitch",
}  # fmt: skip
_SHOWN = {"N": ("kN", 1e-3), "N m": ("kN m", 1e-3), "W": ("kW", 1e-3), "rad": ("deg", 180.0 / np.pi)}
_OVERVIEW = ("tension", "curvature")  # what is drawn when no line is asked for


def plot_file(
    path: str | Path, out_png: str | Path, line: str | None = None, start: float | None = None, end: float | None = None
) -> None:
    """Draw the result file `path` (a finished, failed or still running one) into `out_png`.

    line: draw only this line, with all that is known along it. start, end [s]: draw this part of the run.
    What the file does not hold is left out. Raises CaseError if the file cannot be read or holds no samples (there),
    if there is no such line, or if the picture cannot be written.
    """
    import matplotlib

    matplotlib.use("Agg", force=False)
    from matplotlib.figure import Figure

    if Path(out_png).is_dir():
        raise CaseError(f"picture '{out_png}' is a folder; give a file name")
    data = whole = open_results(path)
    try:
        known = lines_of(data)
        if line is not None and line not in known:
            raise CaseError(f"line: got '{line}'; the results have no such line{nearest(line, known)}")
        first, last = span(data, start, end)
        data = data.isel(time=slice(first, last))
        if line is not None:
            panels = _line_panels(data, [line], tuple(_ALONG))
        else:
            panels = [*_motion_panels(data), *_wave_panel(data), *_told_panels(data),
                      *_line_panels(data, known, _OVERVIEW), *_solver_panels(data)]  # fmt: skip
        if not panels:
            raise CaseError(f"'{path}' holds nothing that could be plotted: {', '.join(map(str, data.data_vars))}")
        rows = (len(panels) + 1) // 2
        figure = Figure(figsize=(11.0, 0.8 + 2.2 * rows), layout="constrained")
        axes = figure.subplots(rows, 2, squeeze=False)
        for ax, draw in zip(axes.flat, panels, strict=False):
            draw(ax)
            ax.grid(True, color="0.9", linewidth=0.6)
            ax.set_axisbelow(True)
            ax.spines[["top", "right"]].set_visible(False)
            if 1 < len(ax.get_legend_handles_labels()[1]) <= _MANY:
                ax.legend(fontsize="small", frameon=False, ncols=2)
        for ax in axes.flat[len(panels) :]:
            ax.set_visible(False)
        status = data.attrs.get("status", "")
        title = str(data.attrs.get("title") or Path(path).name) + (f", {line}" if line is not None else "")
        figure.suptitle(title if status in ("done", "") else f"{title} ({status})", fontsize="large")
        try:
            figure.savefig(out_png, dpi=130)
        except (OSError, ValueError) as error:
            said = error.strerror if isinstance(error, OSError) else error
            raise CaseError(f"picture '{out_png}' cannot be written: {said}") from None
    finally:
        whole.close()


def _names(data: Any, ending: str, *dims: str) -> list[str]:
    """Names of the parts that have a channel with this ending whose dimensions end with dims."""
    found = [str(n).removesuffix(ending) for n in data.data_vars if str(n).endswith(ending)]
    return [name for name in found if data[name + ending].dims == ("time", *(d.format(name) for d in dims))]


def _curve(ax: Any, time: Any, values: Any, label: str | None = None, **style: Any) -> None:
    ax.plot(time, values, marker="o" if len(time) == 1 else None, label=label, **{"linewidth": 1.1, **style})
    ax.set_xlabel("time [s]")


def _at_least(ax: Any, span: float) -> None:
    """Widen the vertical axis to `span`: rounding errors of something at rest are no motion."""
    low, high = ax.get_ylim()
    if high - low < span:
        middle = 0.5 * (low + high)
        ax.set_ylim(middle - 0.5 * span, middle + 0.5 * span)


def _motion_panels(data: Any) -> list[Any]:
    bodies = _names(data, "_position", "dof")
    if not bodies:
        return []

    def panel(k: int, name: str) -> Any:
        def draw(ax: Any) -> None:
            for body in bodies:
                values = data[f"{body}_position"].values[:, k]
                _curve(ax, data.time.values, values if k < 3 else np.degrees(values), body)
            ax.set_ylabel(f"{name} [{'m' if k < 3 else 'deg'}]")
            _at_least(ax, 1e-3)

        return draw

    order = (0, 3, 1, 4, 2, 5)  # translations left, rotations right
    dofs = [str(d) for d in data["dof"].values]
    return [panel(k, dofs[k]) for k in order]


def _wave_panel(data: Any) -> list[Any]:
    if "wave_elevation" not in data or not data["wave_elevation"].values.any():
        return []

    def draw(ax: Any) -> None:
        _curve(ax, data.time.values, data["wave_elevation"].values, **_QUIET)
        ax.set_ylabel("wave elevation [m]")

    return [draw]


def _told_panels(data: Any) -> list[Any]:
    """What PTOs, joints and rotors tell: a panel for every quantity and unit, a curve for each of them."""
    groups: dict[tuple[str, str], list[str]] = {}
    for channel in map(str, data.data_vars):
        ending = channel.rpartition("_")[2]
        if ending in _TOLD and data[channel].dims == ("time",) and data[channel].values.any():
            groups.setdefault((ending, str(data[channel].attrs.get("units", ""))), []).append(channel)

    def panel(ending: str, unit: str, channels: list[str]) -> Any:
        shown, scale = _SHOWN.get(unit, (unit, 1.0))

        def draw(ax: Any) -> None:
            for channel in channels:
                _curve(ax, data.time.values, scale * data[channel].values, channel.removesuffix(f"_{ending}"))
            ax.set_ylabel((f"{channels[0].removesuffix(f'_{ending}')} " if len(channels) == 1 else "")
                          + f"{_TOLD[ending]} [{shown}]")  # fmt: skip

        return draw

    return [panel(*key, channels) for key, channels in groups.items()]


def _line_panels(data: Any, lines: list[str], quantities: tuple[str, ...]) -> list[Any]:
    """Largest tension over time, shapes, and quantities along the arc length that are not zero everywhere."""
    panels: list[Any] = []
    tensions = [name for name in _names(data, "_tension", "{}_element") if name in lines]
    shapes = [name for name in _names(data, "_position", "{}_node", "xyz") if name in lines]

    def tension(ax: Any) -> None:
        for name in tensions:
            _curve(ax, data.time.values, _largest(data[f"{name}_tension"]) / 1e3, name)
        ax.set_ylabel("largest tension [kN]")
        _at_least(ax, 1e-3 * max(map(abs, ax.get_ylim())))

    def along(quantity: str) -> Any | None:
        ending, dim = f"_{quantity}", "{}_element" if quantity.startswith("tension") else "{}_node"
        graphs = [range_graph(data, name, quantity) for name in _names(data, ending, dim) if name in lines]
        if not any(np.nanmax(np.abs([g.minimum, g.maximum]), initial=0.0) > 0.0 for g in graphs):
            return None
        label, scale = _ALONG[quantity]

        def draw(ax: Any) -> None:
            for g in graphs:
                (drawn,) = ax.plot(g.arc_length, scale * g.mean, linewidth=1.1, label=g.line)
                if g.samples > 1:
                    band = {"color": drawn.get_color(), "alpha": 0.2, "linewidth": 0.0}
                    ax.fill_between(g.arc_length, scale * g.minimum, scale * g.maximum, **band)
            note = " (mean; band: least to largest)" if graphs[0].samples > 1 else ""
            ax.set_xlabel("arc length from end a [m]" + note)
            ax.set_ylabel(label)

        return draw

    if tensions and (data.sizes["time"] > 1 or len(lines) > 1):
        panels.append(tension)
    if shapes:
        panels.append(lambda ax: _shapes(ax, data, shapes))
    return panels + [panel for panel in map(along, quantities) if panel is not None]


def _largest(channel: Any) -> Array:
    """Largest value along the line at every time, read block by block."""
    blocks = [channel.isel(time=slice(a, b)).values.max(axis=1) for a, b in blocks_of(0, channel.sizes["time"])]
    return np.concatenate(blocks)


def _shapes(ax: Any, data: Any, names: list[str]) -> None:
    """Side view of lines at the first and last sample, the seabed under them and the water surface."""
    moments = sorted({0, data.sizes["time"] - 1})
    nodes = {name: data[f"{name}_position"].isel(time=moments).values for name in names}
    origin, way, label = _vertical_plane([x[-1] for x in nodes.values()])
    depth = data.attrs.get("water_depth")
    for name, x in nodes.items():
        s = (x[:, :, :2] - origin) @ way
        (drawn,) = ax.plot(s[-1], x[-1, :, 2], linewidth=1.3, label=name)
        if len(moments) > 1:
            ax.plot(s[0], x[0, :, 2], linewidth=0.8, linestyle=":", color=drawn.get_color())
        if f"{name}_clearance" in data:
            bed = x[-1, :, 2] - data[f"{name}_clearance"].isel(time=-1).values
            order = np.argsort(s[-1], kind="stable")
            ax.plot(s[-1][order], bed[order], color=_BED, linewidth=1.2, zorder=1)
        elif depth is not None:
            ax.axhline(-float(depth), color=_BED, linewidth=1.2, zorder=1)
    if depth is not None:
        ax.axhline(0.0, color=_SURFACE, linewidth=0.8)
    ax.set_xlabel(f"{label} [m]" + (" (dotted: start, full: end)" if len(moments) > 1 else ""))
    ax.set_ylabel("z [m]")


def _vertical_plane(lines: list[Array]) -> tuple[Array, Array, str]:
    """(origin, horizontal unit vector, label) of the plane that nodes (n, 3) are drawn in.

    One line: through its ends. Several: the vertical plane they all lie in, else the x-z plane.
    """
    x_axis = np.array([1.0, 0.0])
    if len(lines) == 1:
        level = lines[0][:, :2]
        across = level[-1] - level[0]
        if not np.linalg.norm(across) > _FLAT * np.ptp(level, axis=0).max():  # a loop, or vertical
            across = level[np.argmax(np.linalg.norm(level - level[0], axis=1))] - level[0]
        reach = float(np.linalg.norm(across))
        return level[0], across / reach if reach > 0.0 else x_axis, "horizontal distance from end a"
    level = np.concatenate(lines)[:, :2]
    _, size, axes = np.linalg.svd(level - level.mean(axis=0), full_matrices=False)
    way = axes[0] * np.sign(axes[0][np.argmax(np.abs(axes[0]))])
    if size[1] > _FLAT * size[0] or abs(way[0]) > 1.0 - _FLAT**2:
        return np.zeros(2), x_axis, "x"
    return np.zeros(2), way, f"distance along {np.degrees(np.arctan2(way[1], way[0])):.0f} deg from x"


def _solver_panels(data: Any) -> list[Any]:
    def panel(name: str, label: str) -> Any:
        def draw(ax: Any) -> None:
            # nothing has been solved yet at the first sample
            _curve(ax, data.time.values[1:], data[name].values[1:], drawstyle="steps-pre", **_QUIET)
            ax.set_ylabel(label)
            ax.set_ylim(bottom=0)

        return draw

    wanted = (("newton_iterations", "Newton iterations [-]"), ("step_size", "time step [s]"))
    return [panel(name, label) for name, label in wanted if name in data and data.sizes["time"] > 1]
