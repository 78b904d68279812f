"""The drawings of the report: positions in plan, results against variables, range graphs, run time."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from markupsafe import Markup

from floatsim.cases.report_data import LEAST, MARKED, Summary, Variable, number, scaled
from floatsim.cases.svg import APART, Drawing, ladder, limits, tick_texts
from floatsim.frames import Array

_DOFS = (("pitch", 4, "deg"), ("heave", 2, "m"), ("roll", 3, "deg"), ("yaw", 5, "deg"))
MATTERS = 0.01  # share of a variable in the spread of a result
_SIZE: dict[str, Any] = {"width": 270, "height": 168}


@dataclass
class Panel:
    """A drawing with what stands above and below it; legend: (text, colour)."""

    title: str
    drawing: Markup
    note: str = ""
    legend: list[tuple[str, str]] = field(default_factory=list)


@dataclass
class Row:
    """Panels of one result; minor: what the page folds away."""

    title: str
    panels: list[Panel]
    legend: list[tuple[str, str]] = field(default_factory=list)
    minor: bool = False


def colours(variable: Variable) -> list[str]:
    """One colour for every value: ordered for numbers."""
    n = len(variable.x)
    if not variable.numeric:
        return [APART[k % len(APART)] for k in range(n)]
    low, high = float(np.nanmin(variable.x)), float(np.nanmax(variable.x))
    return [ladder((x - low) / ((high - low) or 1.0)) for x in variable.x]


def plan(s: Summary) -> Iterator[tuple[str, list[Panel]]]:
    """Mean positions of every body in plan: over its outline, then by every variable."""
    for body in s.bodies:
        mean, inside = s.dof(body, "mean"), s.covariance(body)
        assert mean is not None
        xy = mean[:, :2]
        if np.nanmax(np.abs(xy)) < 1e-3 and (inside is None or np.nanmax(inside) < 1e-6):
            continue  # it does not move in plan
        yield body, [_overview(s, body, xy, inside), *(_by(s, body, v, xy, inside) for v in s.shown)]


def _overview(s: Summary, body: str, xy: Array, inside: Array | None) -> Panel:
    """All cases over the outline, with the area that the body's reference point visits."""
    outline = s.outlines.get(body, {})
    loops = [np.asarray(loop, dtype=float) for loop in outline.get("loops", []) if len(loop) > 2]
    spots = np.array(list(outline.get("points", {}).values()), dtype=float).reshape(-1, 2)
    low, high = s.dof(body, "min"), s.dof(body, "max")
    reach = [xy, *([low[:, :2], high[:, :2]] if low is not None and high is not None else []), *loops]
    reach += [spots] if not loops and len(spots) else []
    d = _axes(reach, 360, 330)
    if loops:
        d.shape(loops)
    else:
        for x, y in spots:
            d.line([0.0, x], [0.0, y], width=5, css="arm")
    text = f"{body} in plan as drawn" if loops or len(spots) else "reference point as drawn (cross)"
    if low is not None and high is not None:
        x0, y0 = np.nanmin(low[:, :2], axis=0)
        x1, y1 = np.nanmax(high[:, :2], axis=0)
        d.line([x0, x1, x1, x0, x0], [y0, y0, y1, y1, y0], width=1, dash="4 3", css="k")
        text += "; dashed: reached at any time, any case"
    good = np.isfinite(xy).all(axis=1)
    if inside is not None and good.sum() <= MARKED:
        for k in np.flatnonzero(good):
            d.ellipse(xy[k], inside[k], width=0.6, opacity=0.35)
        text += "; thin: one standard deviation of each case"
    d.cross(0.0, 0.0)
    _cases(s, d, xy, good, ["var(--accent)"] * s.n, 2.2)
    title = "All cases" + (", over the platform's outline" if loops else "")
    return Panel(
        title, d.svg(f"{body}: mean positions of all cases in plan"), f"Dots: mean position of a case; {text}."
    )


def _by(s: Summary, body: str, v: Variable, xy: Array, inside: Array | None) -> Panel:
    """Mean positions coloured by a variable, with the mean and one standard deviation of each of its values."""
    shades = colours(v)
    good = np.isfinite(xy).all(axis=1)
    groups = [(int(c), good & (v.codes == c)) for c in np.unique(v.codes[good])]
    fair = s.comparable(body, v)
    centres = {c: xy[rows & fair].mean(axis=0) for c, rows in groups if (rows & fair).any()}
    spread = {c: np.nanmean(inside[v.codes == c], axis=0) for c in centres} if inside is not None else {}
    few = len(groups) <= 12 and spread
    edge = [centres[c] + sign * np.sqrt(np.diag(spread[c])) for c in centres for sign in (-1, 1)] if few else []
    d = _axes([xy, np.array(edge).reshape(-1, 2)], 300, 275)
    d.cross(0.0, 0.0)
    _cases(s, d, xy, good, [shades[c] for c in v.codes], 2.4)
    if few:
        for c, centre in centres.items():
            d.ellipse(centre, spread[c], shades[c])
    for centre in centres.values():
        d.points(centre[0], centre[1], css="halo", size=8.5, opacity=1.0)
    for c, centre in centres.items():
        d.points(centre[0], centre[1], shades[c], 6.0, 1.0)
    between, alone = s.apart(body, v)
    note = f"Means of its values are up to {number(between, 2)} m apart"
    note += f"; cases that differ in nothing else, up to {number(alone, 2)} m." if alone is not None else "."
    left_out = int(np.sum(good & ~fair))
    if left_out:
        note += f" {left_out} cases without counterparts that are done are not in the means."
    if v.also:
        note += f" It determines {', '.join(v.also)}." if len(v.also) < 4 else f" It determines {len(v.also)} others."
    every = max(1, math.ceil(len(v.texts) / 13))
    legend = [(v.texts[c], shades[c]) for k, c in enumerate(centres) if k % every == 0]
    return Panel(f"By {v.label}", d.svg(f"{body}: mean positions coloured by {v.label}"), note, legend)


def _axes(reach: list[Array], width: float, height: float) -> Drawing:
    points = np.vstack([np.reshape(r, (-1, 2)) for r in reach] + [np.zeros((1, 2))])
    x, y = limits(points[:, 0]), limits(points[:, 1])
    height = min(height, max(150.0, 42.0 + (width - 54.0) * (y[1] - y[0]) / (x[1] - x[0])))  # no more than it needs
    return Drawing(x, y, "x, downwind at heading 0 [m]", "y [m]", width, height, equal=True)


def _cases(s: Summary, d: Drawing, xy: Array, good: Any, shades: list[str], r: float) -> None:
    """Points of all cases; of not too many with their names and links."""
    if good.sum() <= MARKED:
        for k in np.flatnonzero(good).tolist():
            d.marked_points(xy[k, 0], xy[k, 1], shades[k], [f"{s.ids[k]}: {s.describe(k)}"], [f"case{k}"], r)
        return
    for shade in dict.fromkeys(shades):
        rows = good & np.array([c == shade for c in shades])
        d.points(xy[rows, 0], xy[rows, 1], shade, 1.5 * r, 0.55)


def motions(s: Summary) -> list[Row]:
    """Offset and motions of every body against every variable."""
    rows = []
    for body in s.bodies:
        own = f"{body}: " if len(s.bodies) > 1 else ""
        low, mean, high, what = s.offset(body)
        text = {"largest": "", "mean": " (means only)"}.get(what, f" (largest: {what})")
        if np.nanmax(high) > LEAST:
            rows.append(_spread(s, f"{own}offset in plan{text}", "offset [m]", low, mean, high))
        for name, k, unit in _DOFS:
            kinds = [s.dof(body, kind) for kind in ("min", "mean", "max")]
            factor = 1.0 if unit == "m" else math.degrees(1.0)
            values = [factor * x[:, k] for x in kinds if x is not None]
            if len(values) == 3 and max(float(np.nanmax(np.abs(x))) for x in values) > LEAST:
                least, middle, most = values
                label = f"{name} [{unit}]"
                rows.append(_spread(s, f"{own}{name}", label, least, middle, most, minor=name != "pitch"))
    if all(row.minor for row in rows):
        for row in rows:
            row.minor = False
    return rows


def channel_rows(s: Summary, owners: dict[str, list[str]]) -> Iterator[Row]:
    """Channels of rotors or PTOs against the variables that matter for their mean."""
    for channels in owners.values():
        for channel in channels:
            low, mean, high = (s.get(f"{channel}_{kind}") for kind in ("min", "mean", "max"))
            assert mean is not None
            low, high = (mean if x is None else x for x in (low, high))
            factor, unit = scaled(s.unit(f"{channel}_mean"), high)
            if s.unit(f"{channel}_mean") == "rad/s":
                factor, unit = 30.0 / math.pi, "rpm"
            title = channel.replace("_", " ").replace(" pitch", " blade pitch")
            label = f"{title.split()[-1]} [{unit}]" if unit else title.split()[-1]
            share = dict(zip((v.name for v in s.axes), s.shares(mean)))
            axes = [v for v in s.shown if share[v.name] >= MATTERS] or s.shown
            values = factor * low, factor * mean, factor * high
            yield _spread(s, title, label, *values, minor="wind" in channel, axes=axes)


def gathered(rows: list[Row]) -> list[Row]:
    """Rows of one panel each, where there are several, as one row whose panels have their titles."""
    found = []
    for minor in (False, True):
        own = [row for row in rows if row.minor == minor]
        single = [row for row in own if len(row.panels) == 1]
        if len(single) > 1:
            for row in single:
                row.panels[0].title = row.title[:1].upper() + row.title[1:]
            found.append(Row("", [row.panels[0] for row in single], minor=minor))
            own = [row for row in own if row not in single]
        found += own
    return found


def extra_rows(s: Summary) -> Iterator[Row]:
    """Single numbers per case, as of decay tests, against every variable; apart for every value of a text (the degree
    of freedom that was released)."""
    apart = next((v for v in s.shown if not v.numeric and len(v.x) <= 8), None)
    for r in s.extra:
        if r.label == "equilibrium":  # of a release: no result
            continue
        label = f"{r.label} [{r.unit}]" if r.unit else r.label
        label = label if len(label) < 26 else f"[{r.unit}]" if r.unit else ""  # the title says what it is
        for c, text in enumerate(apart.texts if apart and len(s.shown) > 1 else [""]):
            own = np.where(apart.codes == c, r.values, np.nan) if text and apart else r.values
            if np.isfinite(own).any():
                axes = [v for v in s.shown if v is not apart or not text]
                title = ", ".join(t for t in (r.label, text) if t)
                yield _spread(s, title, label, own, own, own, axes=axes)


def _spread(
    s: Summary, title: str, label: str, low: Array, mean: Array, high: Array, minor: bool = False,
    axes: list[Variable] | None = None,
) -> Row:  # fmt: skip
    """Panels of one result against every variable: mean, spread of the means and of the extremes over the others."""
    y = limits(low, mean, high, zero=True)
    panels = []
    for v in axes if axes is not None else s.shown:
        d = _against(v, y, label)
        rows = [(v.codes == c) & np.isfinite(mean) for c in range(len(v.x))]
        at = np.array([c for c, r in enumerate(rows) if r.any()], dtype=int)
        used = [rows[c] for c in at]
        x = v.x[at] if v.numeric else at.astype(float)
        wide = min(13.0, 0.55 * (d.right - d.left) / max(len(v.x), 2))
        d.bars(x, [np.nanmin(low[r]) for r in used], [np.nanmax(high[r]) for r in used], wide, 0.16, "b")
        d.bars(x, [mean[r].min() for r in used], [mean[r].max() for r in used], wide, 0.42, "b")
        middle = [mean[r].mean() for r in used]
        if v.numeric and v in s.free:
            d.line(x, middle, css="c", width=1.4)
        d.points(x, middle, css="c", size=5.0, opacity=1.0)
        panels.append(Panel("", d.svg(f"{title} against {v.label}")))
    return Row(title, panels, minor=minor)


def _against(v: Variable, y: tuple[float, float], label: str) -> Drawing:
    """Axes of a panel over a variable."""
    if not v.numeric:
        names = v.texts if max(map(len, v.texts)) <= 14 else [f"{t[:12]}\N{HORIZONTAL ELLIPSIS}" for t in v.texts]
        return Drawing((-0.6, len(v.x) - 0.4), y, v.label, label, names=names, **_SIZE)
    x, at = limits(v.x, margin=0.09), v.x[np.isfinite(v.x)]
    return Drawing(x, y, v.label, label, x_ticks=at if 1 < len(at) <= 9 else None, **_SIZE)


def tensions(s: Summary) -> Iterator[Row]:
    """Mean and largest tension of the lines of every family against every variable."""
    for family, lines in s.families.items():
        found = {}
        for line in lines:
            high, mean = s.along(line, "tension", "max"), s.along(line, "tension", "mean")
            if high is not None and mean is not None:
                at = np.arange(len(high)), np.argmax(np.nan_to_num(mean, nan=-np.inf), axis=1)
                found[line] = 1e-3 * mean[at], 1e-3 * np.fmax.reduce(high, axis=1)
        if not found:
            continue
        y = limits(*(x for pair in found.values() for x in pair), zero=True)
        legend = [(line, APART[k % len(APART)]) for k, line in enumerate(found)] if len(found) <= len(APART) else []
        panels = []
        for v in s.shown:
            d = _against(v, y, "tension [kN]")
            x = v.x if v.numeric else np.arange(len(v.x), dtype=float)
            for k, (mean, high) in enumerate(found.values()):
                shade = APART[k % len(APART)]
                rows = [(v.codes == c) & np.isfinite(mean) for c in range(len(x))]
                middle = np.array([mean[r].mean() if r.any() else np.nan for r in rows])
                most = np.array([high[r].max() if r.any() else np.nan for r in rows])
                if v.numeric and v in s.free:
                    d.line(x, middle, shade, 1.2, "3 2.5")
                    d.line(x, most, shade, 1.4)
                d.points(x, middle, shade, 3.0, 0.9)
                d.points(x, most, shade, 4.5, 1.0)
            panels.append(Panel("", d.svg(f"tension of {', '.join(found)} against {v.label}")))
        yield Row(family, panels, legend)


def ranges(s: Summary) -> Iterator[Row]:
    """Range graphs of all lines over all cases."""
    for quantity, label, factor in (("tension", "tension [kN]", 1e-3), ("curvature", "curvature [1/m]", 1.0)):
        panels = []
        for lines in s.families.values():
            if quantity == "curvature" and not s.bends(lines):
                continue
            panels += [p for line in lines if (p := _range_graph(s, line, quantity, label, factor)) is not None]
        if panels:
            yield Row(quantity, panels)


def _range_graph(s: Summary, line: str, quantity: str, label: str, factor: float) -> Panel | None:
    high, mean, low = (s.along(line, quantity, kind) for kind in ("max", "mean", "min"))
    if high is None:
        return None
    good = np.isfinite(high).any(axis=1)
    high = factor * high[good]
    arc, where = s.arc_length(line, high.shape[1], quantity == "tension")
    top = np.fmax.reduce(high, axis=0)
    tenth = np.nanquantile(high, 0.9, axis=0, method="higher") if len(high) > 9 else None
    limit, note = _limit(s, line, quantity, factor)
    shown = [top]
    bottom = factor * np.fmin.reduce(low[good], axis=0) if low is not None else None
    middle = factor * np.nanmean(mean[good], axis=0) if mean is not None else None
    shown += [x for x in (bottom, middle) if x is not None]
    if limit is not None and np.nanmin(limit) < 1.6 * np.nanmax(top):
        shown.append(np.where(limit < 1.6 * np.nanmax(top), limit, np.nan))
    y = limits(*shown, zero=True)
    d = Drawing(limits(arc, margin=0.02), y, where, label, **_SIZE)
    if bottom is not None:
        d.band(arc, bottom, top, css="b", opacity=0.2)
    if tenth is not None:
        d.line(arc, tenth, css="c2", width=1.1, dash="4 2.5")
    if middle is not None:
        d.line(arc, middle, css="c", width=1.5)
    d.line(arc, top, css="c", width=0.8)
    if limit is not None:
        d.line(arc, limit, css="lim", width=1.3)
    k = int(np.nanargmax(top))
    text = f"Largest {number(top[k])} {label.split('[')[1].rstrip(']')} at {number(arc[k])} m{note}"
    return Panel(line, d.svg(f"range graph of the {quantity} of {line}"), text)


def _limit(s: Summary, line: str, quantity: str, factor: float) -> tuple[Array | None, str]:
    """What is allowed along a line, from the utilisation, and the largest utilisation in words."""
    used, values = s.utilisation(line, quantity), s.along(line, quantity, "max")
    if used is None or values is None or used.shape != values.shape:
        return None, ""
    with np.errstate(divide="ignore", invalid="ignore"):
        allowed = np.where(used > 1e-9, values / used, np.nan)
    known = np.isfinite(allowed).any(axis=0)
    limit = np.full(allowed.shape[1], np.nan)
    limit[known] = factor * np.nanmedian(allowed[:, known], axis=0)
    return limit, f"; {number(100.0 * np.nanmax(used))} % of what is allowed" if known.any() else ""


def wall_times(s: Summary) -> Panel | None:
    """Histogram of the wall time of the cases."""
    if s.wall is None:
        return None
    wall = s.wall[np.isfinite(s.wall)]
    low, high = float(wall.min()), float(wall.max())
    if len(wall) < 3 or high - low < 1e-6 * high:
        return None
    count, edges = np.histogram(wall, bins=min(30, max(6, int(2 * len(wall) ** (1 / 3)))))
    d = Drawing(
        (edges[0], edges[-1]), (0.0, max(4.0, 1.08 * count.max())), "wall time of a case [s]", "cases", 360, 170
    )
    for a, b, n in zip(edges[:-1], edges[1:], count):
        d.band([a, b], [0.0, 0.0], [n, n], css="b", opacity=0.55)
    return Panel("", d.svg("histogram of the wall time of the cases"))


def power_matrix(s: Summary, channel: str) -> dict[str, Any] | None:
    """Mean of a channel over all cases of each sea state: heads of both directions and cells with a shade."""
    by = {v.name: v for v in s.variables if v.numeric and v.distinct > 1 and not v.binned}
    rows, columns = by.get("hs"), by.get("tp", by.get("te", by.get("tz")))
    mean = s.get(f"{channel}_mean")
    if rows is None or columns is None or mean is None:
        return None
    factor, unit = scaled(s.unit(f"{channel}_mean"), mean)
    cells = []
    filled = 0
    for i in range(len(rows.x)):
        line = []
        for j in range(len(columns.x)):
            own = mean[(rows.codes == i) & (columns.codes == j) & np.isfinite(mean)]
            filled += len(own) > 0
            line.append(factor * float(own.mean()) if len(own) else math.nan)
        cells.append(line)
    if filled < 0.2 * len(rows.x) * len(columns.x):
        return None
    most = float(np.nanmax(np.abs(cells))) or 1.0
    return {"rows": tick_texts(rows.x), "columns": tick_texts(columns.x), "unit": unit, "cells": cells, "most": most,
            "row_name": rows.label, "column_name": columns.label}  # fmt: skip
