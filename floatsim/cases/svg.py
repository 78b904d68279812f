"""Small drawings as SVG text, for a page of HTML: axes, lines, bands, points, ellipses.

Colours of axes and text are left to the page's style sheet (classes), so that one drawing serves a light and a dark
page; coordinates are rounded to a tenth of a unit and points of one colour share one path: thousands stay small.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from markupsafe import Markup, escape

from floatsim.frames import Array

LADDER = ("#4f46c8", "#8a3fb5", "#c2418f", "#e0605a", "#e88a2e", "#d3a817")  # dark to light: ordered also in grey
APART = ("#3b6fd4", "#d9712b", "#2f9e6b", "#b04fb0", "#c23b4a", "#7a7f1c", "#2f9bb3", "#8a6a4f")  # without an order


NONE = "#8a929b"


def ladder(share: float) -> str:
    """Colour of a share from 0 to 1 of an ordered quantity; grey for none."""
    if math.isnan(share):
        return NONE
    x = min(max(share, 0.0), 1.0) * (len(LADDER) - 1)
    k = min(int(x), len(LADDER) - 2)
    mix = [round(a + (x - k) * (b - a)) for a, b in zip(_rgb(LADDER[k]), _rgb(LADDER[k + 1]))]
    return "#" + "".join(f"{m:02x}" for m in mix)


def _rgb(colour: str) -> list[int]:
    return [int(colour[i : i + 2], 16) for i in (1, 3, 5)]


def ticks(low: float, high: float, most: int = 5) -> Array:
    """Round numbers (1, 2, 5 times a power of ten apart) from low to high, at most `most` + 1 of them."""
    raw = (high - low) / most
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(s for s in (power, 2 * power, 5 * power, 10 * power) if s >= raw * (1 - 1e-9))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return np.asarray(np.arange(first, last + 1) * step, dtype=np.float64)


def limits(*values: Any, zero: bool = False, margin: float = 0.06) -> tuple[float, float]:
    """Smallest and largest finite number of all arrays with a margin; zero: from or to 0 where that is not far."""
    flat = np.concatenate([np.ravel(np.asarray(v, dtype=float)) for v in values] or [np.zeros(0)])
    flat = flat[np.isfinite(flat)]
    if not len(flat):
        return 0.0, 1.0
    low, high = float(flat.min()), float(flat.max())
    if zero and low > 0.0 and low < 0.6 * high:
        low = 0.0
    if zero and high < 0.0 and high > 0.6 * low:
        high = 0.0
    span = high - low
    if span <= 1e-9 * max(abs(low), abs(high), 1e-9):  # one value: rounding is no spread
        span = 0.2 * max(abs(low), abs(high)) or 1.0
        low, high = low - 0.5 * span, high + 0.5 * span
    stay = [zero and edge == 0.0 for edge in (low, high)]
    return (low if stay[0] else low - margin * span), (high if stay[1] else high + margin * span)


class Drawing:
    """Axes of width x height units with room for labels, and what is drawn into them.

    x, y: limits in data units. equal: one scale for both axes (the shorter range is widened) and a grid in both.
    names: texts at whole numbers of x instead of ticks. x_ticks: where to have them.
    """

    def __init__(
        self, x: tuple[float, float], y: tuple[float, float], x_label: str = "", y_label: str = "", width: float = 270,
        height: float = 178, equal: bool = False, names: Sequence[str] | None = None, x_ticks: Any = None,
    ) -> None:  # fmt: skip
        self.width, self.height = width, height
        self.right, self.top, self.bottom = width - 8.0, 8.0, height - (34.0 if x_label else 20.0)
        self.left = 26.0 + 5.7 * max(map(len, tick_texts(ticks(*y, most=5))), default=3)
        if equal:
            scale = max((x[1] - x[0]) / (self.right - self.left), (y[1] - y[0]) / (self.bottom - self.top))
            x = _widened(x, scale * (self.right - self.left))
            y = _widened(y, scale * (self.bottom - self.top))
        self.x, self.y, self.equal = x, y, equal
        self.scale = (self.right - self.left) / (x[1] - x[0])
        self.body: list[str] = []
        self.inside: list[str] = []
        self._axes(x_label, y_label, names, x_ticks)

    def _axes(self, x_label: str, y_label: str, names: Sequence[str] | None, x_ticks: Any) -> None:
        y_at = ticks(*self.y, most=5)
        at: Any = ticks(*self.x, most=5) if x_ticks is None else x_ticks
        texts = list(names) if names is not None else tick_texts(at)
        if names is not None:
            at = range(len(names))
        grid = "".join(f"M{self.left:.0f} {self.v(t):.1f}H{self.right:.0f}" for t in y_at)
        grid += "".join(f"M{self.u(t):.1f} {self.top:.0f}V{self.bottom:.0f}" for t in at) if self.equal else ""
        self.body.append(f'<path class="g" d="{grid}"/>')
        for t, text in zip(y_at, tick_texts(y_at)):
            self.body.append(f'<text class="e" x="{self.left - 5:.0f}" y="{self.v(t) + 3.5:.1f}">{text}</text>')
        marks, free = "", -math.inf
        for t, text in zip(at, texts):
            u = float(self.u(t))
            if not self.left - 0.5 <= u <= self.right + 0.5:
                continue
            marks += f"M{u:.1f} {self.bottom:.0f}v4"
            half = 2.9 * len(text)
            if u - half > free:  # else it would run into its neighbour
                self.body.append(f'<text class="m" x="{u:.1f}" y="{self.bottom + 14:.0f}">{escape(text)}</text>')
                free = u + half + 3.0
        self.body.append(f'<path class="a" d="M{self.left:.0f} {self.bottom:.0f}H{self.right:.0f}{marks}"/>')
        middle = 0.5 * (self.left + self.right)
        if x_label:
            self.body.append(f'<text class="m l" x="{middle:.0f}" y="{self.height - 5:.0f}">{escape(x_label)}</text>')
        if y_label:
            up = 0.5 * (self.top + self.bottom)
            self.body.append(
                f'<text class="m l" transform="translate(10 {up:.0f})rotate(-90)">{escape(y_label)}</text>'
            )

    def u(self, x: Any) -> Any:
        """Horizontal place of x."""
        return self.left + (np.asarray(x, dtype=float) - self.x[0]) * self.scale

    def v(self, y: Any) -> Any:
        """Vertical place of y, downwards."""
        return self.bottom - (np.asarray(y, dtype=float) - self.y[0]) * (self.bottom - self.top) / (
            self.y[1] - self.y[0]
        )

    def line(self, x: Any, y: Any, colour: str = "", width: float = 1.5, dash: str = "", css: str = "") -> None:
        """A polyline, interrupted where a value is missing."""
        style = (f' stroke="{colour}"' if colour else "") + (f' stroke-dasharray="{dash}"' if dash else "")
        css = f' class="{css}"' if css else ""
        self.inside.append(f'<path{css} fill="none" stroke-width="{width:g}"{style} d="{self._path(x, y)}"/>')

    def _path(self, x: Any, y: Any) -> str:
        pieces, pen = [], "M"
        for u, v in zip(np.ravel(self.u(x)), np.ravel(self.v(y))):
            if math.isfinite(u) and math.isfinite(v):
                pieces.append(f"{pen}{u:.1f} {v:.1f}")
                pen = "L"
            else:
                pen = "M"
        return "".join(pieces)

    def band(self, x: Any, low: Any, high: Any, colour: str = "", opacity: float = 0.18, css: str = "") -> None:
        """The area between two curves over the same x."""
        x, low, high = (np.asarray(a, dtype=float) for a in (x, low, high))
        good = np.isfinite(x) & np.isfinite(low) & np.isfinite(high)
        if not good.any():
            return
        x, low, high = x[good], low[good], high[good]
        d = self._path(np.r_[x, x[::-1]], np.r_[low, high[::-1]])
        css, fill = f' class="{css}"' if css else "", f' fill="{colour}"' if colour else ""
        self.inside.append(f'<path{css}{fill} fill-opacity="{opacity:g}" d="{d}z"/>')

    def bars(self, x: Any, low: Any, high: Any, width: float, opacity: float, css: str) -> None:
        """Upright bars from low to high about every x, `width` units wide."""
        d = ""
        for u, a, b in zip(np.ravel(self.u(x)), np.ravel(self.v(low)), np.ravel(self.v(high))):
            if math.isfinite(u) and math.isfinite(a) and math.isfinite(b):
                d += f"M{u - 0.5 * width:.1f} {a:.1f}h{width:.1f}V{min(b, a - 0.8):.1f}h{-width:.1f}z"
        self.inside.append(f'<path class="{css}" fill-opacity="{opacity:g}" d="{d}"/>')

    def points(self, x: Any, y: Any, colour: str = "", size: float = 4.0, opacity: float = 0.8, css: str = "") -> None:
        """Round points, all in one path."""
        at = np.column_stack([np.ravel(self.u(x)), np.ravel(self.v(y))])
        d = "".join(f"M{u:.1f} {v:.1f}h0" for u, v in at[np.isfinite(at).all(axis=1)])
        look = (f' class="{css}"' if css else "") + (f' stroke="{colour}"' if colour else "")
        self.inside.append(
            f'<path{look} fill="none" stroke-linecap="round" stroke-width="{size:g}" stroke-opacity="{opacity:g}" '
            f'd="{d}"/>'
        )

    def marked_points(self, x: Any, y: Any, colour: str, texts: Sequence[str], links: Sequence[str], r: float) -> None:
        """Round points with a text each that shows under the pointer, and a link within the page."""
        for u, v, text, link in zip(np.ravel(self.u(x)), np.ravel(self.v(y)), texts, links):
            if math.isfinite(u) and math.isfinite(v):
                self.inside.append(
                    f'<a href="#{escape(link)}" tabindex="-1"><circle cx="{u:.1f}" cy="{v:.1f}" r="{r:g}" '
                    f'fill="{colour}" fill-opacity=".8"><title>{escape(text)}</title></circle></a>'
                )

    def ellipse(
        self, centre: Any, covariance: Array, colour: str = "", width: float = 1.4, opacity: float = 1.0
    ) -> None:
        """One standard deviation of a covariance (2, 2) about a centre; axes of equal scale."""
        if not np.isfinite(covariance).all():
            return
        values, vectors = np.linalg.eigh(covariance)
        a, b = np.sqrt(np.maximum(values[::-1], 0.0)) * self.scale
        turn = -math.degrees(math.atan2(vectors[1, 1], vectors[0, 1]))
        look = f' stroke="{colour}"' if colour else ' class="k"'
        at = f"{float(self.u(centre[0])):.1f} {float(self.v(centre[1])):.1f}"
        self.inside.append(
            f'<ellipse rx="{a:.1f}" ry="{b:.1f}" fill="none"{look} stroke-width="{width:g}" '
            f'stroke-opacity="{opacity:g}" transform="translate({at})rotate({turn:.1f})"/>'
        )

    def shape(self, loops: Sequence[Array]) -> None:
        """Closed loops (n, 2) as one filled shape: rims first, then the filling, so that only the outer rim shows."""
        d = "".join(self._path(loop[:, 0], loop[:, 1]) + "z" for loop in loops)
        self.inside.append(f'<path class="rim" d="{d}"/><path class="fill" d="{d}"/>')

    def cross(self, x: float, y: float, size: float = 5.0) -> None:
        """A small cross."""
        u, v = float(self.u(x)), float(self.v(y))
        d = f"M{u - size:.1f} {v:.1f}h{2 * size:g}M{u:.1f} {v - size:.1f}v{2 * size:g}"
        self.inside.append(f'<path class="x" d="{d}"/>')

    def svg(self, title: str) -> Markup:
        """The drawing. title: what it shows, for those who do not see it."""
        x, y, w, h = self.left - 1.0, self.top - 4.0, self.right - self.left + 7.0, self.bottom - self.top + 5.0
        box = f'x="{x:g}" y="{y:g}" width="{w:g}" height="{h:g}" viewBox="{x:g} {y:g} {w:g} {h:g}"'  # clips
        return Markup(  # every text in it has been escaped where it was put in
            f'<svg viewBox="0 0 {self.width:g} {self.height:g}" role="img" aria-label="{escape(title)}">'
            f"{''.join(self.body)}<svg {box}>{''.join(self.inside)}</svg></svg>"
        )


def _widened(range_: tuple[float, float], width: float) -> tuple[float, float]:
    middle = 0.5 * (range_[0] + range_[1])
    return middle - 0.5 * width, middle + 0.5 * width


def tick_texts(values: Any) -> list[str]:
    """Texts with as many decimals as the step between the values needs."""
    values = np.asarray(values, dtype=float)
    if not len(values):
        return []
    step = float(np.min(np.diff(np.unique(values)))) if len(np.unique(values)) > 1 else 0.0
    if np.abs(values).max() >= 1e6 or (0.0 < np.abs(values).max() < 1e-3):
        return [f"{v:.3g}".replace("-", "\N{MINUS SIGN}") for v in values]
    decimals = next((k for k in range(5) if np.allclose(values, np.round(values, k), atol=1e-3 * step, rtol=1e-9)), 5)
    return [f"{v:.{decimals}f}".replace("-", "\N{MINUS SIGN}") if abs(v) > 1e-12 else "0" for v in values]
