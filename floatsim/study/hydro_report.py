"""A hydrodynamic database for people: what is in it, what the checks say, and a page of plots."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from floatsim.errors import CaseError
from floatsim.frames import Array
from floatsim.hydro.check import Finding, check_database
from floatsim.hydro.database import DOF_NAMES, HydroDatabase

Table = tuple[str, list[str], list[list[str]]]
_MEMORY = 60.0  # s of radiation memory that is drawn at most


def summary_table(db: HydroDatabase) -> Table:
    """Bodies, water, frequencies and headings."""
    rows = [
        [name, f"{V:.6g}", *(f"({p[0]:.4g}, {p[1]:.4g}, {p[2]:.4g})" for p in (B, P))]
        for name, V, B, P in zip(db.bodies, db.volume, db.centre_of_buoyancy, db.reference_point, strict=True)
    ]
    depth = "deep water" if np.isinf(db.depth) else f"{db.depth:g} m deep"
    title = (
        f"'{db.name}': {db.omega.size} frequencies {db.omega[0]:.3g} to {db.omega[-1]:.3g} rad/s, {db.headings.size} "
        f"headings {np.degrees(db.headings[0]):.4g} to {np.degrees(db.headings[-1]):.4g} deg, {depth}, "
        f"{db.density:g} kg/m3, g {db.gravity:g} m/s2"
    )
    return title, ["body", "volume [m3]", "centre of buoyancy [m]", "reference point [m]"], rows


def check_table(db: HydroDatabase, findings: tuple[Finding, ...] | None = None) -> Table:
    """What the sanity checks say; `findings` if they were made already."""
    found = check_database(db) if findings is None else findings
    rows = [[item.quantity, item.severity, item.message] for item in found]
    return "sanity checks", ["quantity", "verdict", "what was found"], rows


def verdict(findings: tuple[Finding, ...]) -> str:
    """One sentence: can it be used?"""
    wrong, odd = ([f.quantity for f in findings if f.severity == kind] for kind in ("error", "warning"))
    if wrong:
        return f"do not use it: {', '.join(wrong)}"
    if odd:
        return f"usable, with care about {', '.join(odd)}"
    return "good: every check is passed"


def plot_database(db: HydroDatabase, path: str | Path) -> None:
    """Draw added mass, damping, excitation and radiation memory of every body into `path` (PNG, PDF, SVG ...).

    Two rows per body, translations and rotations; columns are A_ii with A_inf dashed, B_ii, |X_i| in the heading with
    the largest force, and K_ii = 2/pi int B cos(w t) dw (Cummins 1962). Where bodies interact, their heave-heave
    coupling with the first other body is dotted. Raises CaseError if the picture cannot be written.
    """
    import matplotlib

    matplotlib.use("Agg", force=False)
    from matplotlib.figure import Figure

    if Path(path).is_dir():
        raise CaseError(f"picture '{path}' is a folder; give a file name")
    N = len(db.bodies)
    figure = Figure(figsize=(16.0, 5.5 * N), layout="constrained")
    axes = figure.subplots(2 * N, 4, squeeze=False)
    t = np.linspace(0.0, min(_MEMORY, np.pi / np.diff(db.omega).max()), 301)
    for row in range(2 * N):
        body, rotation = divmod(row, 2)
        _draw_row(db, axes[row], t, 6 * body + 3 * rotation)
        axes[row, 0].set_ylabel(f"{db.bodies[body]}\n{'rotations' if rotation else 'translations'}")
    figure.suptitle(f"{db.name}: added mass, damping, excitation, radiation memory")
    try:
        figure.savefig(path, dpi=110)
    except (OSError, ValueError) as error:
        raise CaseError(f"picture '{path}' cannot be written: {error}") from None


def _draw_row(db: HydroDatabase, axes: Array, t: Array, first: int) -> None:
    units = ("kg m2", "N m s", "N m/m", "N m") if first % 6 else ("kg", "N s/m", "N/m", "N/m")
    titles = ("added mass", "radiation damping", "excitation", "radiation memory")
    size = np.abs(db.excitation[:, :, first : first + 3]).sum(axis=(0, 2))
    heading = int(np.argmax(size))
    titles = (*titles[:2], f"{titles[2]}, {np.degrees(db.headings[heading]):.3g} deg", titles[3])
    for k in range(3):
        i = first + k
        label = DOF_NAMES[i % 6].lower()
        (line,) = axes[0].plot(db.omega, db.added_mass[:, i, i], label=label)
        axes[0].axhline(db.added_mass_inf[i, i], color=line.get_color(), linestyle="--", linewidth=0.7)
        axes[1].plot(db.omega, db.radiation_damping[:, i, i], label=label)
        axes[2].plot(db.omega, np.abs(db.excitation[:, heading, i]), label=label)
        axes[3].plot(t, _memory(db, i, i, t), label=label)
    if len(db.bodies) > 1 and first % 6 == 0:
        i, j = first + 2, (first // 6 + 1) % len(db.bodies) * 6 + 2
        label = f"heave with {db.bodies[j // 6]}"
        axes[0].plot(db.omega, db.added_mass[:, i, j], ":", color="0.3", label=label)
        axes[1].plot(db.omega, db.radiation_damping[:, i, j], ":", color="0.3", label=label)
        axes[3].plot(t, _memory(db, i, j, t), ":", color="0.3", label=label)
    for panel, title, unit in zip(axes, titles, units):
        panel.set_title(f"{title} [{unit}]", fontsize=10)
        panel.grid(linewidth=0.3)
    for panel in axes[:3]:
        panel.set_xlabel("rad/s")
    axes[3].set_xlabel("s")
    axes[0].legend(fontsize=8)


def _memory(db: HydroDatabase, i: int, j: int, t: Array) -> Array:
    """K_ij(t), trapezoidal rule over the frequencies, damping zero at zero."""
    w = np.concatenate([[0.0], db.omega])
    B = np.concatenate([[0.0], db.radiation_damping[:, i, j]])
    return np.asarray(2.0 / np.pi * np.trapezoid(B * np.cos(np.outer(t, w)), w, axis=1))
