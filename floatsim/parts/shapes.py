"""First shapes of lines: where statics start from. None of them is an equilibrium; the solver finds that.

A shape answers two questions, with a and b (3,) the ends [m], s (n+1,) the unstretched arc lengths of the nodes
from a [m], depth [m] of the seabed below z = 0, and the line whose pieces say what it weighs:

    points(a, b, s, depth, line)    -> nodes (n+1, 3) [m]; the first is a and the last is b
    problems(a, b, s, depth, line)  -> why it cannot be drawn so, one sentence each; empty if it can

`points` never raises: where `problems` has something to say it draws an arc instead. All shapes lie in the vertical
plane through the ends, x towards b and z up, but for slack on the bed and given coordinates.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Protocol

import numpy as np
from pydantic import BeforeValidator, field_validator, model_validator

from floatsim.description import LARGEST, Description, Positive, numbers
from floatsim.frames import Array

SEA_WATER = 1025.0  # kg/m3; only tells what floats from what sinks
_STEEP = 1e-3  # horizontal span over length below which a line counts as vertical


class Shape(Protocol):
    """What a line asks of its first shape."""

    def points(self, a: Array, b: Array, s: Array, depth: float, line: Any = None) -> Array: ...

    def problems(self, a: Array, b: Array, s: Array, depth: float, line: Any = None) -> list[str]: ...


class Straight(Description):
    """The straight line between the ends, strained evenly: compressed if the line is slack."""

    def points(self, a: Array, b: Array, s: Array, depth: float, line: Any = None) -> Array:
        t = (s / s[-1])[:, None]
        return (1.0 - t) * a + t * b

    def problems(self, a: Array, b: Array, s: Array, depth: float, line: Any = None) -> list[str]:
        return []


class Arc(Description):
    """A circular arc of the line's length, kept above the seabed; straight if the line is taut."""

    def points(self, a: Array, b: Array, s: Array, depth: float, line: Any = None) -> Array:
        return hanging_arc(a, b, s, depth)

    def problems(self, a: Array, b: Array, s: Array, depth: float, line: Any = None) -> list[str]:
        return []


def hanging_arc(a: Array, b: Array, s: Array, depth: float) -> Array:
    """Nodes (n+1, 3) at the arc lengths s (n+1,) of a circular arc of length s[-1] from a to b, above the seabed.

    Straight if the length does not exceed the span. A slack line drawn straight would be compressed by far more than
    its weight and start by folding; an arc has no strain at all. It hangs in the vertical plane of its ends; a line so
    slack that it could not stay above the bed even as an L is turned about its chord until it does.
    """
    length = float(s[-1])
    t = (s / length)[:, None]
    chord = b - a
    span = float(np.linalg.norm(chord))
    if length <= span * (1.0 + 1e-9) or span == 0.0:
        return np.asarray((1.0 - t) * a + t * b)
    half = _half_angle(span / length)
    radius = span / (2.0 * math.sin(half))
    along = chord / span
    across = np.cross(along, (0.0, 0.0, -1.0))
    across = np.array([0.0, 1.0, 0.0]) if np.linalg.norm(across) < 1e-6 else across / np.linalg.norm(across)
    down = np.cross(across, along)
    phi = half * (2.0 * t - 1.0)

    def turned(tilt: float) -> Array:
        sag = math.cos(tilt) * down + math.sin(tilt) * across
        return np.asarray(0.5 * (a + b) + radius * (np.sin(phi) * along + (np.cos(phi) - math.cos(half)) * sag))

    slack = length > 0.99 * (abs(chord[2]) + math.hypot(chord[0], chord[1]))
    # a hair out of the vertical plane, because slack on the bed has to leave it
    tilts = np.radians(np.concatenate([[0.01], np.arange(5.0, 91.0, 5.0)])) if slack else np.array([0.0])
    shape = next((x for x in map(turned, tilts) if x[:, 2].min() >= -depth), turned(tilts[-1]))
    shape[1:-1, 2] = np.maximum(shape[1:-1, 2], -depth)  # an end below the bed is for the line to report
    shape[0], shape[-1] = a, b
    return shape


def _half_angle(ratio: float) -> float:
    """Half the angle y of an arc whose chord over length is `ratio`: sin(y)/y = ratio, 0 < ratio < 1."""
    from scipy.optimize import brentq

    return float(brentq(lambda y: math.sin(y) / y - ratio, 1e-6, math.pi, xtol=1e-15))


class Catenary(Description):
    """The inextensible catenary of the line's length between its ends, with the seabed (no friction).

    All pieces are smeared into one weight, of which only the sign matters: what floats in sea water is drawn upside
    down, below the surface instead of above the bed. A taut line is straight. A line too slack for any horizontal
    pull hangs almost vertically and lies in an arc on the bed; one whose ends are above each other is drawn as `Arc`.
    """

    def points(self, a: Array, b: Array, s: Array, depth: float, line: Any = None) -> Array:
        length, chord = float(s[-1]), b - a
        span = math.hypot(chord[0], chord[1])
        if length <= float(np.linalg.norm(chord)) * (1.0 + 1e-9):
            return Straight().points(a, b, s, depth)
        if span < _STEEP * length:
            return hanging_arc(a, b, s, depth)
        along = np.array([chord[0], chord[1], 0.0]) / span
        up, bed = np.array([0.0, 0.0, 1.0]), float(depth)
        if _floats(line):  # the same picture upside down, the surface being the bed
            up, bed = -up, 0.0 if max(a[2], b[2]) <= 0.0 else math.inf
        height = (float(a @ up) + bed, float(b @ up) + bed)
        x, y, z = _catenary_with_bed(span, float(chord @ up), height, s)
        points = a + np.outer(x, along) + np.outer(y, np.cross(up, along)) + np.outer(z, up)
        points[0], points[-1] = a, b
        return points

    def problems(self, a: Array, b: Array, s: Array, depth: float, line: Any = None) -> list[str]:
        return []


def catenary_parameter(span: float, rise: float, length: float) -> float:
    """a = H/w [m] of an inextensible catenary over `span` and `rise` [m]; length [m] > hypot(span, rise).

    sqrt(length^2 - rise^2) = 2 a sinh(span/2a) (Irvine, Cable Structures, 1981, chapter 1).
    """
    from scipy.optimize import brentq

    ratio = math.sqrt((length - rise) * (length + rise)) / span
    most = 2.0 * math.log(2.0 * ratio) + 3.0  # sinh(u)/u > ratio there
    u = brentq(lambda u: math.sinh(u) / u - ratio, 1e-9, most, xtol=1e-15)
    return span / (2.0 * float(u))


def _catenary_with_bed(span: float, rise: float, height: tuple[float, float], s: Array) -> tuple[Array, Array, Array]:
    """Coordinates along, across and up from the first end; `height` of both ends above the bed."""
    length = float(s[-1])
    a = catenary_parameter(span, rise, length)
    low = 0.5 * span - a * math.atanh(rise / length)  # x of the lowest point
    s_low = a * math.sinh(low / a)
    if not 0.0 < s_low < length or math.hypot(a, s_low) - a <= height[0]:
        return low + a * np.arcsinh((s - s_low) / a), 0.0 * s, np.hypot(a, s - s_low) - math.hypot(a, s_low)
    h1, h2 = (max(h, 0.0) for h in height)
    # without a pull the line would turn a corner at the bed; it gets a bend of an element or so
    a = touchdown_parameter(span, (h1, h2), length) or min(float(s[1]), 0.05 * min(span, h1 + h2))
    s1, s2 = (math.sqrt(h * (h + 2.0 * a)) for h in (h1, h2))  # arc lengths off the bed
    x1, x2 = (a * math.asinh(q / a) if q > 0.0 else 0.0 for q in (s1, s2))
    lying, chord = length - s1 - s2, span - x1 - x2
    q = s - s1
    x, y = _bow(np.clip(q / lying, 0.0, 1.0), chord, lying)
    off1, off2 = np.maximum(-q, 0.0), np.maximum(q - lying, 0.0)  # arc lengths from the touchdown points
    if a > 0.0:
        x += a * (np.arcsinh(off2 / a) - np.arcsinh(off1 / a))
    return x1 + x, y, np.hypot(a, off1 + off2) - a - h1


def touchdown_parameter(span: float, height: tuple[float, float], length: float) -> float | None:
    """a = H/w [m] of a line whose middle lies on a frictionless bed `height` [m] below its two ends; None if it is so
    slack that no horizontal pull is left.

    An end h above the bed carries sqrt(h (h + 2a)) of line over a acosh(1 + h/a) of span; what is left of both lies.
    """
    from scipy.optimize import brentq

    def excess(log_a: float) -> float:
        a = math.exp(log_a)
        missing = 0.0
        for h in height:
            s = math.sqrt(h * (h + 2.0 * a))
            missing += s - a * math.asinh(s / a)
        return missing - (length - span)

    if sum(height) <= (length - span) * (1.0 + 1e-3):
        return None
    least, most = math.log(1e-9 * sum(height)), math.log(1e12 * length)
    return math.exp(brentq(excess, least, most, xtol=1e-13)) if excess(least) > 0.0 > excess(most) else None


def _bow(t: Array, chord: float, length: float) -> tuple[Array, Array]:
    """Points at the shares t of an arc of the given length over a chord along x (either way), bulging to +y."""
    span = abs(chord)
    if length <= span * (1.0 + 1e-9):
        return chord * t, 0.0 * t
    half = _half_angle(max(span / length, 1e-9))
    phi, radius = half * (2.0 * t - 1.0), 0.5 * length / half
    return 0.5 * chord + math.copysign(radius, chord) * np.sin(phi), radius * (np.cos(phi) - math.cos(half))


@dataclass(frozen=True)
class Circles:
    """Dimensions of a lazy wave of three circles (see `ThreeCircles`), in m, along the line from its upper end.

    y [rad]: slope of the straights. x11, x31, x32: straights down from the upper end, down behind the hog, and on the
    bed. R1, R2, R3: radii of sag, hog and landing.
    """

    y: float
    x11: float
    R1: float
    R2: float
    x31: float
    R3: float
    x32: float

    @property
    def knots(self) -> Array:
        """Arc lengths (7,) between which the slope changes evenly, from `-y -y y -y -y 0 0`."""
        y = self.y
        return np.cumsum([0.0, self.x11, 2.0 * y * self.R1, 2.0 * y * self.R2, self.x31, y * self.R3, self.x32])

    @property
    def sag(self) -> float:
        """Depth of the lowest point of the sag below the upper end."""
        return self.x11 * math.sin(self.y) + self.R1 * (1.0 - math.cos(self.y))

    @property
    def crest(self) -> float:
        """Depth of the highest point of the hog below the upper end."""
        return self.x11 * math.sin(self.y) - self.R2 * (1.0 - math.cos(self.y))

    def polyline(self, s: Array) -> tuple[Array, Array]:
        """Coordinates across and up of the nodes at arc lengths s (n+1,): every chord as long as its element."""
        knots, y = self.knots, self.y
        knots[-1] = max(knots[-1], s[-1])
        slopes = y * np.array([-1.0, -1.0, 1.0, -1.0, -1.0, 0.0, 0.0])
        # the integral of the slope, a parabola between knots; its difference over an element is the mean slope
        pieces = np.diff(knots)
        whole = np.concatenate([[0.0], np.cumsum(0.5 * (slopes[1:] + slopes[:-1]) * pieces)])
        k = np.clip(np.searchsorted(knots, s, side="right") - 1, 0, 5)
        q = s - knots[k]
        bend = np.diff(slopes) / np.where(pieces > 0.0, pieces, 1.0)
        c = np.diff(s)
        mean = np.diff(whole[k] + slopes[k] * q + 0.5 * bend[k] * q * q) / c
        mean[s[:-1] >= knots[5]] = 0.0
        return (
            np.concatenate([[0.0], np.cumsum(c * np.cos(mean))]),
            np.concatenate([[0.0], np.cumsum(c * np.sin(mean))]),
        )


def chord_radius(element: float, radius: float) -> float:
    """Radius [m] of the circle through the nodes of a polyline whose elements turn like a curve of `radius` [m].

    Each turns by 2 asin(l/2R') = l/R, so that the chord 2 R' sin(l/2R) is the element's length l.
    """
    return 0.5 * element / math.sin(0.5 * element / radius)


class ThreeCircles(Description):
    """Lazy wave of three circles and straights: sag, hog over the buoyant section, and landing on the bed.

    lengths (l1, l2, l3) [m]: upper, buoyant and lower section from end_a to end_b; if left out, those of the line,
    whose pieces must sink, float and sink. crest_depth [m]: of the hog below the upper end. touchdown_radius [m]: R3.
    What is left out is chosen so that the shape closes, beginning with a fifth of the height and with R2.

    Verelst et al. 2024, section 4.3, draw a wave of partial circles with h >= R2 + R3 + x31 and
    l3 = x31 + x32 + R3 pi/2: all straights vertical. For ends too far apart for that, let all straights have one
    slope y instead. From the upper end the slope is

        -y over x11, then rising to +y over the sag         R1, angle 2 y    l1 = x11 + 2 y R1
        falling from +y to -y over the hog                  R2, angle 2 y    l2 = 2 y R2
        -y over x31, then rising to 0, level over x32       R3, angle y      l3 = x31 + y R3 + x32

    so that tangents are continuous and the line lands tangentially. With h and X the height and the horizontal
    distance of the ends and d the depth of the crest below the upper end

        d = x11 sin y - R2 (1 - cos y)
        h = d + (R2 + R3)(1 - cos y) + x31 sin y
        X = (x11 + x31) cos y + (2 R1 + 2 R2 + R3) sin y + x32.

    With y = pi/2 and d >= 0 these are the relations of Verelst et al. R1, R2, x11 and x32 follow from the lengths and
    d; y and x31 close h and X.

    The polyline is exact: its element of length c points along the mean slope over its arc length, so all chords are as
    long as their elements, and chords on a circle of radius R turn by c/R each: their nodes lie on a circle of radius
    c/(2 sin(c/2R)) (`chord_radius`). y and x31 are those that bring the last node of this polyline to the end. The
    sums over chords then hold to rounding, d and the radii up to (c/R)^2/24 of themselves.
    """

    lengths: Annotated[tuple[float, float, float], numbers("three positive lengths (l1, l2, l3)", 3)] | None = None
    crest_depth: Positive | None = None
    touchdown_radius: Positive | None = None

    @field_validator("lengths")
    @classmethod
    def _positive(cls, value: tuple[float, float, float] | None) -> tuple[float, float, float] | None:
        if value is not None and min(value) <= 0.0:
            raise ValueError(f"got {value}; all three lengths must be positive")
        return value

    def points(self, a: Array, b: Array, s: Array, depth: float, line: Any = None) -> Array:
        found = self._solve(a, b, s, depth, line)
        if isinstance(found, str):
            return hanging_arc(a, b, s, depth)
        if a[2] < b[2]:
            return self._draw(found, b, a, s[-1] - s[::-1])[::-1].copy()
        return self._draw(found, a, b, s)

    def problems(self, a: Array, b: Array, s: Array, depth: float, line: Any = None) -> list[str]:
        if s[-1] <= np.linalg.norm(b - a):  # taut, and drawn straight: if that is not meant the line says so
            return []
        found = self._solve(a, b, s, depth, line)
        return [f"ThreeCircles: {found} (Arc() takes any ends)"] if isinstance(found, str) else []

    def circles(self, a: Array, b: Array, s: Array, depth: float, line: Any = None) -> Circles | None:
        """The dimensions, or None where `problems` says why there are none."""
        found = self._solve(a, b, s, depth, line)
        return None if isinstance(found, str) else found

    def _draw(self, circles: Circles, a: Array, b: Array, s: Array) -> Array:
        chord = b - a
        along = np.array([chord[0], chord[1], 0.0]) / math.hypot(chord[0], chord[1])
        x, z = circles.polyline(s)
        points = a + np.outer(x, along) + np.outer(z, (0.0, 0.0, 1.0))
        points[-1] = b
        return points

    def _solve(self, a: Array, b: Array, s: Array, depth: float, line: Any) -> Circles | str:
        """The dimensions, or why there are none."""
        lengths = self.lengths or _sink_float_sink(line)
        if lengths is None:
            return "the line's pieces do not sink, float and sink in this order; give lengths=(l1, l2, l3)"
        if abs(sum(lengths) - s[-1]) > 1e-6 * s[-1]:
            return f"lengths: got {lengths}, together {sum(lengths):.6g} m; the line is {s[-1]:.6g} m long"
        if a[2] < b[2]:
            a, b, s, lengths = b, a, s[-1] - s[::-1], lengths[::-1]
        h, X = float(a[2] - b[2]), math.hypot(b[0] - a[0], b[1] - a[1])
        if h <= 0.0 or X <= 0.0:
            return f"one end must be above and beside the other; it is {h:.4g} m above and {X:.4g} m beside it"
        floor, coarse = float(a[2]) + depth, float(np.diff(s).max())
        y = np.linspace(0.05, 0.75 * math.pi, 300)
        reached: list[float] = []
        for d in [self.crest_depth] if self.crest_depth else [q * h for q in (0.2, 0.3, 0.1, 0.4, 0.5, 0.02)]:
            for share in (1.0,) if self.touchdown_radius else (1.0, 0.5, 0.25):
                family = _Family(lengths, h, d, share, self.touchdown_radius)
                reach, good = family.reach(y), family.good(y, floor, coarse)
                reached.extend(reach[good & np.greater(reach, 0.0)])
                crossing = np.flatnonzero((np.diff(np.sign(reach - X)) != 0) & good[1:] & good[:-1])
                for k in sorted(crossing, key=lambda k: abs(y[k] - 0.5 * math.pi)):
                    closed = family.close(float(y[k]), X, s)
                    if closed is not None:
                        return closed
        chosen = [(name, getattr(self, name)) for name in ("crest_depth", "touchdown_radius")]
        given = "".join(f", a {name} of {value:g} m" for name, value in chosen if value is not None)
        what = f"sections of {lengths[0]:.4g}, {lengths[1]:.4g} and {lengths[2]:.4g} m, a height of {h:.4g} m{given}"
        if not reached:
            return f"{what}: no circles larger than the elements ({coarse:.4g} m) fit with the sag above the bed"
        least, most = min(reached), max(reached)
        if least < X < most:
            return f"{what}: elements of {coarse:.4g} m are too long to close a distance of {X:.4g} m in plan"
        return f"{what}: these reach {least:.4g} to {most:.4g} m in plan, the ends are {X:.4g} m apart"


@dataclass(frozen=True)
class _Family:
    """All waves with the same section lengths, height h and crest depth d; R3 given, or a share of R2."""

    lengths: tuple[float, float, float]
    h: float
    d: float
    share: float
    R3: float | None

    def dimensions(self, y: Any) -> tuple[Any, ...]:
        """x11, R1, R2, x31, R3, x32 of the smooth curve at the slope y (any shape)."""
        l1, l2, l3 = self.lengths
        rise = 1.0 - np.cos(y)
        R2 = 0.5 * l2 / y
        R3 = self.share * R2 if self.R3 is None else self.R3
        x11 = (self.d + R2 * rise) / np.sin(y)
        x31 = (self.h - self.d - (R2 + R3) * rise) / np.sin(y)
        return x11, 0.5 * (l1 - x11) / y, R2, x31, R3, l3 - x31 - y * R3

    def reach(self, y: Array) -> Array:
        """Horizontal distance of the ends [m]."""
        x11, R1, R2, x31, R3, x32 = self.dimensions(y)
        return np.asarray((x11 + x31) * np.cos(y) + (2.0 * R1 + 2.0 * R2 + R3) * np.sin(y) + x32)

    def good(self, y: Array, floor: float, coarse: float) -> Array:
        """Whether nothing is negative, the sag stays above `floor` and circles are larger than the elements."""
        x11, R1, R2, x31, R3, x32 = self.dimensions(y)
        sag = x11 * np.sin(y) + R1 * (1.0 - np.cos(y))
        smallest = np.minimum(np.minimum(R1, R2), R3)
        return np.asarray((x31 >= 0.0) & (x32 >= 0.0) & (smallest >= coarse) & (sag <= floor))

    def close(self, y: float, X: float, s: Array) -> Circles | None:
        """Newton in y and x31 until the polyline ends X across and h below its beginning."""

        def wave(y: float, x31: float) -> Circles:
            x11, R1, R2, _, R3, _ = self.dimensions(y)
            x32 = self.lengths[2] - x31 - y * R3
            return Circles(*map(float, (y, x11, R1, R2, x31, R3, x32)))

        def gap(u: Array) -> Array:
            across, up = wave(*u).polyline(s)
            return np.array([across[-1] - X, up[-1] + self.h])

        u = np.array([y, self.dimensions(y)[3]])
        best, least = u, math.inf
        for _ in range(30):
            r = gap(u)
            size = float(np.abs(r).max())
            if size < least:
                best, least = u, size
            elif least < 1e-11 * s[-1] or not np.isfinite(size):
                break
            J = np.stack([(gap(u + e) - gap(u - e)) / (2.0 * e.sum()) for e in np.diag((1e-6, 1e-5 * s[-1]))], axis=1)
            u = u - np.linalg.solve(J, r)
        found = wave(*best)
        fits = min(found.x11, found.R1, found.x31, found.x32) >= 0.0 and least < 1e-11 * s[-1]
        return found if fits else None


def _pieces(line: Any) -> list[tuple[float, float]]:
    """Length [m] and mass in sea water [kg/m] of every piece of a line."""
    return [(p.length, p.section.mass_per_length - SEA_WATER * p.section.area) for p in line.pieces]


def _floats(line: Any) -> bool:
    """Whether a line as a whole is lighter than the sea water it displaces."""
    return line is not None and sum(length * mass for length, mass in _pieces(line)) < 0.0


def _sink_float_sink(line: Any) -> tuple[float, float, float] | None:
    """Lengths of the three stretches of a line that sinks, floats and sinks; None if it does not."""
    lengths: list[float] = []
    signs: list[bool] = []
    for length, mass in _pieces(line) if line is not None else []:
        if signs and signs[-1] == (mass < 0.0):
            lengths[-1] += length
        else:
            lengths.append(length)
            signs.append(mass < 0.0)
    return (lengths[0], lengths[1], lengths[2]) if signs == [False, True, False] else None


def _coordinates(value: Any) -> tuple[tuple[float, ...], ...]:
    allowed = "must be two or more rows of three finite numbers (x, y, z)"
    try:
        x = np.asarray(value)
    except ValueError:  # rows of different lengths
        raise ValueError(f"its rows differ in length; {allowed}") from None
    if x.ndim != 2 or x.shape[1] != 3 or len(x) < 2:
        raise ValueError(f"got an array of shape {x.shape}; {allowed}")
    if x.dtype.kind not in "iuf" or not np.all(np.abs(x) <= LARGEST):
        raise ValueError(f"not all are numbers; {allowed}")
    return tuple(tuple(map(float, row)) for row in x)


class Nodes(Description):
    """Given coordinates of the nodes, from end_a to end_b, such as those of an earlier result.

    coordinates (m, 3) [m]: if m is not the line's number of nodes they are joined by straights, and the nodes stand on
    these at the same shares of the length. tolerance [m]: by which the first and the last may miss the line's ends.
    """

    coordinates: Annotated[tuple[tuple[float, ...], ...], BeforeValidator(_coordinates)]
    tolerance: Positive = 0.01

    @model_validator(mode="after")
    def _distinct(self) -> Nodes:
        x = np.array(self.coordinates)
        same = np.flatnonzero(np.linalg.norm(np.diff(x, axis=0), axis=1) == 0.0)
        if len(same):
            raise ValueError(f"coordinates: rows {same[0]} and {same[0] + 1} (from 0) are the same point")
        return self

    def points(self, a: Array, b: Array, s: Array, depth: float, line: Any = None) -> Array:
        x = np.array(self.coordinates)
        if len(x) != len(s):
            along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(x, axis=0), axis=1))])
            x = np.stack([np.interp(s / s[-1], along / along[-1], column) for column in x.T], axis=1)
        x[0], x[-1] = a, b
        return x

    def problems(self, a: Array, b: Array, s: Array, depth: float, line: Any = None) -> list[str]:
        found = []
        for end, given, true in (("first", self.coordinates[0], a), ("last", self.coordinates[-1], b)):
            miss = float(np.linalg.norm(np.array(given) - true))
            if miss > self.tolerance:
                found.append(
                    f"Nodes: the {end} is at {_point(given)} m, {miss:.4g} m from the line's end at {_point(true)} m; "
                    f"at most {self.tolerance:g} m is allowed"
                )
        z = np.array(self.coordinates)[:, 2]
        if z.min() < -depth - self.tolerance:
            found.append(f"Nodes: row {z.argmin()} (from 0) is at z = {z.min():.6g} m, below the bed at {-depth:g} m")
        return found


def _point(x: Sequence[float] | Array) -> str:
    return "(" + ", ".join(f"{y:.6g}" for y in x) + ")"
