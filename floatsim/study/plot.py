"""A page of plots from a result file: motions, line tensions, line shapes over the seabed, solver history.

Angles are shown in degrees, forces in kN; the file itself stays in SI units and radians.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from floatsim.errors import CaseError

_MANY = 8  # legends with more entries are left out
_QUIET: dict[str, Any] = {"color": "0.35", "linewidth": 0.9}


def plot_file(path: str | Path, out_png: str | Path) -> None:
    """Draw the result file `path` (a finished, failed or still running one) into `out_png`.

    What the file does not hold is left out. Raises CaseError if the file cannot be read or holds no samples, or if
    the picture cannot be written.
    """
    import matplotlib

    matplotlib.use("Agg", force=False)
    from matplotlib.figure import Figure

    if Path(out_png).is_dir():
        raise CaseError(f"picture '{out_png}' is a folder; give a file name")
    data = _opened(Path(path))
    try:
        panels = [*_motion_panels(data), *_wave_panel(data), *_line_panels(data), *_solver_panels(data)]
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
        title = str(data.attrs.get("title") or Path(path).name)
        figure.suptitle(title if status in ("done", "") else f"{title} ({status})", fontsize="large")
        try:
            figure.savefig(out_png, dpi=130)
        except (OSError, ValueError) as error:
            said = error.strerror if isinstance(error, OSError) else error
            raise CaseError(f"picture '{out_png}' cannot be written: {said}") from None
    finally:
        data.close()


def _opened(path: Path) -> Any:
    import xarray

    if not path.is_file():
        raise CaseError(f"there is no result file '{path}'")
    try:
        data = xarray.open_dataset(path)
    except (OSError, ValueError, RuntimeError):
        raise CaseError(f"'{path}' is not a netCDF file that can be read") from None
    if data.sizes.get("time", 0) == 0:
        data.close()
        raise CaseError(f"'{path}' holds no samples (yet)")
    return data


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


def _line_panels(data: Any) -> list[Any]:
    panels: list[Any] = []
    tensions = _names(data, "_tension", "{}_element")
    shapes = _names(data, "_position", "{}_node", "xyz")

    def tension(ax: Any) -> None:
        for name in tensions:
            _curve(ax, data.time.values, data[f"{name}_tension"].values.max(axis=1) / 1e3, name)
        ax.set_ylabel("largest tension [kN]")
        _at_least(ax, 1e-3 * max(map(abs, ax.get_ylim())))

    def shape(ax: Any) -> None:
        for name in shapes:
            x = data[f"{name}_position"].values[[0, -1]]
            (drawn,) = ax.plot(x[-1, :, 0], x[-1, :, 2], linewidth=1.3, label=name)
            if data.sizes["time"] > 1:
                ax.plot(x[0, :, 0], x[0, :, 2], linewidth=0.8, linestyle=":", color=drawn.get_color())
        depth = data.attrs.get("water_depth")
        if depth is not None:
            ax.axhline(-float(depth), color="#8a6d3b", linewidth=1.2)
            ax.axhline(0.0, color="#3b78a8", linewidth=0.8)
        ax.set_xlabel("x [m] (dotted: start, full: end)" if data.sizes["time"] > 1 else "x [m]")
        ax.set_ylabel("z [m]")

    if tensions:
        panels.append(tension)
    if shapes:
        panels.append(shape)
    return panels


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
