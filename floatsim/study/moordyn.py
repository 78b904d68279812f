"""MoorDyn input files become floatsim models.

What has a counterpart is converted, what has none is listed in plain sentences with its line number, and what cannot
be left out without making another system (a floating rod, an unknown stiffness) is refused. Line types: see
moordyn_types.py; the rest:

    rod           of no length (NumSegs 0): clamps a line. The line leaves its end B along the direction from A to B,
                  its end A against it. A free one with a line at each end is one line of several pieces.
    seabed        kBot and cBot on d l; the damper grows with the penetration here (sea/seabed.py)

Sources: MoorDyn documentation, "Input Files"; Hall, Sirnivas & Yu (2021), IOWTC2021-3565, for rods as clamps.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from floatsim.description import is_number
from floatsim.errors import ModelError, nearest
from floatsim.frames import Array, matrix_from_angles
from floatsim.joints.ball import Ball
from floatsim.joints.clamp import Clamp
from floatsim.joints.prescribed import Motion, Prescribed
from floatsim.model import Model
from floatsim.parts.body import Body
from floatsim.parts.line import Line
from floatsim.parts.section import Attachment, Break, Piece
from floatsim.sea.seabed import Seabed
from floatsim.sea.site import Sea
from floatsim.study.moordyn_deck import Deck, Row, number, read_deck
from floatsim.study.moordyn_types import LineTypes, plain_name

LONGEST = 1e6  # m of line

FIXED = ("fixed", "fix", "anchor", "ground")
COUPLED = ("coupled", "cpld", "vessel", "ves", "fairlead")
FREE = ("free", "connect", "con", "point", "pnt")

# options of MoorDyn's own solver and output, which mean nothing here
_ITS_OWN = {
    "writelog", "dtm", "cfl", "tscheme", "dtic", "tmaxic", "cdscaleic", "icdfac", "threshic", "icthresh", "ictmax",
    "icgendynamic", "fileic", "dtout", "writeunits", "disableoutput", "disableouttime", "outswitch", "dtwave",
    "inertialf", "inertialf_rampt", "unifycurrentgrid", "wavekin_rampt", "echo", "maxiter", "tolerance", "icdt",
}  # fmt: skip
_OPTIONS = {
    "depth": ("wtrdpth", "depth", "wtrdepth"), "density": ("wtrdnsty", "rho", "rhow", "wtrdens"),
    "gravity": ("g", "gravity"), "stiffness": ("kbot", "kb"), "damping": ("cbot", "cb"),
    "friction": ("frictioncoefficient", "mu_kt"), "friction_axial": ("mu_ka",),
    "static friction": ("statdynfricscale", "mc"), "friction damping": ("fricdamp", "cv"),
}  # fmt: skip


@dataclass(frozen=True)
class MoorDynImport:
    """What was read. parts and joints can go into a model of your own, beside other parts; `model` is theirs alone.

    sea: water, depth and seabed of the file, still. gravity [m/s2]. not_understood: what was left out and why, with
    line numbers. notes: what was converted, and how.
    """

    parts: tuple[Any, ...]
    joints: tuple[Any, ...]
    sea: Sea
    gravity: float
    model: Model
    not_understood: tuple[str, ...]
    notes: tuple[str, ...]


@dataclass(frozen=True)
class _Place:
    """Where a line end goes. target: connection point or coordinates, None for a free junction `free`."""

    position: Array
    target: Any = None
    direction: tuple[float, float, float] | None = None
    motion: Motion | None = None
    free: str = ""


@dataclass(frozen=True)
class _LineRow:
    id: int
    line: int
    type: str
    ends: tuple[str, str]
    length: float
    segments: int


def read_moordyn(
    path: str | Path,
    bodies: Mapping[int | str, Body] | None = None,
    motions: Mapping[int, Motion] | None = None,
    depth: float | None = None,
    name: str | None = None,
) -> MoorDynImport:
    """Read a MoorDyn input file, version 1 or 2.

    bodies: what the file only names: 'coupled' -> the platform of its Coupled or Vessel points, rods and bodies; 1 or
    'body1' -> body 1; 'turbine2' -> turbine 2. Each gets the connection points point_N, rod_Na, rod_Nb at the places
    of the file's coordinates and comes back in `parts`. motions: number of a Coupled point -> its motion; a point
    without a body or a motion is held where it is. depth [m]: of the water where the file has none, or instead
    of its own. name: of the model, default from the file's.

    Raises ModelError with all problems found, each with file, line, what was got and what is allowed.
    """
    deck = read_deck(path)
    reader = _Reader(deck, _known_bodies(bodies or {}), _known_motions(motions or {}))
    if depth is not None and (not is_number(depth) or depth <= 0.0):
        raise ModelError(f"depth: got {depth!r}; a positive number of metres is allowed")
    return reader.read(depth, name or plain_name(deck.path.stem, "moordyn"))


def _known_bodies(bodies: Mapping[int | str, Body]) -> dict[str, Body]:
    known = {}
    for key, body in bodies.items():
        if not isinstance(body, Body):
            raise ModelError(f"bodies: {key!r}: got {body!r}; a floatsim.Body is allowed")
        text = f"body{key}" if isinstance(key, int) else str(key).lower()
        known["coupled" if text in COUPLED else text] = body
    return known


def _known_motions(motions: Mapping[int, Motion]) -> dict[int, Motion]:
    for key, motion in motions.items():
        if not isinstance(key, int) or not isinstance(motion, Motion) or motion.columns != 3:
            raise ModelError(f"motions: {key!r}: the number of a Coupled point -> a Motion of 3 columns is allowed")
    return dict(motions)


@dataclass
class _Reader:
    deck: Deck
    bodies: dict[str, Body]
    motions: dict[int, Motion]
    notes: list[str] = field(default_factory=list)
    points: dict[str, dict[str, tuple[float, float, float]]] = field(default_factory=dict)  # new ones, of each body
    own: dict[int, Body] = field(default_factory=dict)  # free bodies of the file
    poses: dict[int, tuple[Array, Array, str, int]] = field(default_factory=dict)  # of bodies: p, R, attachment, line
    places: dict[str, _Place] = field(default_factory=dict)  # '3' point 3, '2a' end A of rod 2
    loads: dict[str, tuple[int, dict[str, float]]] = field(default_factory=dict)  # of free points, with their line
    used: set[str] = field(default_factory=set)
    held: list[str] = field(default_factory=list)
    joints: list[Any] = field(default_factory=list)

    def read(self, depth: float | None, name: str) -> MoorDynImport:
        deck = self.deck
        for row in deck.rows("bodies"):
            self._body(row)
        for row in deck.rows("points"):
            self._point(row)
        joining: dict[str, Row] = {}
        for row in deck.rows("rods"):
            self._rod(row, joining)
        rows = self._line_rows()
        self._sections_left_out()
        sea, gravity = self._sea(depth)
        types = LineTypes(deck, self.notes)
        self._unused()
        deck.done()
        lines = self._lines(rows, joining, types)
        deck.done()
        assert sea is not None
        parts = (*self._all_bodies(), *lines)
        deck.done()
        self._say()
        try:
            model = Model(name=name, parts=parts, joints=tuple(self.joints), sea=sea, gravity=gravity)
        except ModelError as error:
            raise ModelError([f"{deck.path.name}: {line}" for line in error.problems]) from None
        return MoorDynImport(parts, tuple(self.joints), sea, gravity, model, tuple(deck.not_understood),
                             tuple(self.notes))  # fmt: skip

    # bodies

    def _body(self, row: Row) -> None:
        deck = self.deck
        key, kind = deck.whole(row, "id", 1), row.values["attachment"].lower()
        x, y, z, roll, pitch, yaw = (deck.number(row, c) for c in ("x", "y", "z", "roll", "pitch", "yaw"))
        if key in self.poses:
            deck.refuse(row.line, f"body {key} is given twice; numbers must differ")
        if sum(angle != 0.0 for angle in (roll, pitch, yaw)) > 1:
            deck.leave_out(
                row.line,
                f"body {key}: several angles at once are taken as roll, then pitch, then yaw about the world's "
                "axes; check its attitude",
            )
        p, R = np.array([x, y, z]), matrix_from_angles(*np.radians([roll, pitch, yaw]))
        pinned = kind.endswith(("pinned", "pin"))
        plain = re.sub(r"(pinned|pin)$", "", kind)
        self.poses[key] = (p, R, plain, row.line)
        if f"body{key}" in self.bodies or (plain in COUPLED and "coupled" in self.bodies) or plain in FIXED:
            return
        if plain in COUPLED and not pinned:
            self.held.append(f"body {key} (line {row.line})")
            return
        if plain not in (*COUPLED, *FREE):
            allowed = "Free, Fixed, Coupled, Vessel or CoupledPinned is allowed"
            deck.refuse(row.line, f"body {key}: attachment: got '{row.values['attachment']}'; {allowed}")
            return
        mass = deck.number(row, "mass")
        center, inertia = self.deck.bar(row, "CG", (1, 3)), self.deck.bar(row, "I", (1, 3))
        if center is None or inertia is None:
            return
        if mass <= 0.0 or min(inertia) <= 0.0:
            deck.refuse(
                row.line,
                f"body {key}: got mass {mass:g} and I {row.values['I']}; a body that moves needs a positive mass "
                f"and inertia, or give bodies={{{key}: floatsim.Body(...)}}",
            )
            return
        for column, what in (("volume", "buoyancy"), ("CdA", "drag"), ("Ca", "added mass")):
            text = row.values.get(column, "0")
            if any(number(y) != 0.0 for y in text.split("|")):
                deck.leave_out(
                    row.line,
                    f"body {key}: {column} = {text}: its {what} was left out; give "
                    f"bodies={{{key}: floatsim.Body(..., hydro=...)}}",
                )
        body = self.deck.made(
            row.line, Body, name=f"body_{key}", mass=mass, position=tuple(p), attitude_deg=(roll, pitch, yaw),
            center_of_mass=center if len(center) == 3 else (0.0, 0.0, center[0]),
            inertia=inertia if len(inertia) == 3 else inertia * 3,
        )  # fmt: skip
        if body is not None:
            self.own[key] = body
            if pinned:
                self.joints.append(Ball(a=f"body_{key}", b=tuple(p)))

    def _all_bodies(self) -> list[Body]:
        found: list[Body] = []
        for body in {b.name: b for b in (*self.bodies.values(), *self.own.values())}.values():
            new = self.points.get(body.name, {})
            clash = [n for n in new if n in body.points and body.points[n] != new[n]]
            if clash:
                self.deck.problems.append(
                    f"Body '{body.name}' already has a point '{clash[0]}' elsewhere; that name is needed for the "
                    "file's"
                )
            found.append(body.model_copy(update={"points": {**body.points, **new}}))
        return found

    def _unused(self) -> None:
        for key in self.bodies:
            if key not in self.used:
                known = sorted({"coupled", *(f"body{k}" for k in self.poses)})
                self.deck.problems.append(
                    f"bodies: nothing in {self.deck.path.name} is held by "
                    f"'{key}'{nearest(key, [k for k in known if k != key])}"
                )
        for point in self.motions:
            place = self.places.get(str(point))
            if place is None or place.motion is None:
                self.deck.problems.append(f"motions: {self.deck.path.name} has no Coupled point {point}")

    # points and rods

    def _onto(self, body: Body, point: str, where: Array, along: Array | None = None) -> _Place:
        """A new connection point of a body at `where`, world axes; along: a direction there."""
        R = matrix_from_angles(*np.radians(body.attitude_deg))
        arm = R.T @ (where - np.asarray(body.position))
        self.points.setdefault(body.name, {})[point] = (float(arm[0]), float(arm[1]), float(arm[2]))
        return _Place(where, f"{body.name}.{point}", None if along is None else _triple(R.T @ along))

    def _place(self, row: Row, what: str, kind: str, point: str, where: Array, along: Array | None = None,
               motion: Motion | None = None) -> _Place | None:  # fmt: skip
        """Where something stands that is fixed, coupled or on a body; None if it is none of these."""
        direction = None if along is None else _triple(along)
        if kind in FIXED:
            return _Place(where, _triple(where), direction)
        if kind in COUPLED:
            if motion is not None:
                return _Place(where, None, None, motion)
            if "coupled" in self.bodies:
                self.used.add("coupled")
                return self._onto(self.bodies["coupled"], point, where, along)
            self.held.append(f"{what} (line {row.line})")
            return _Place(where, _triple(where), direction)
        return self._on_named(row, what, kind, point, where, along)

    def _on_named(self, row: Row, what: str, kind: str, point: str, where: Array, along: Array | None) -> _Place | None:
        match = re.fullmatch(r"(body|turbine)(\d{1,9})", kind)
        if not match:
            return None
        key, index = f"{match[1]}{int(match[2])}", int(match[2])
        given = self.bodies.get(key)
        if match[1] == "turbine" or index not in self.poses:
            if given is None:
                self.deck.refuse(
                    row.line,
                    f"{what}: got '{kind}', which is not in the file; give bodies={{'{key}': ...}} or one of its "
                    f"bodies: {sorted(self.poses) or 'none'}",
                )
                return _Place(where, _triple(where))
            R, p = matrix_from_angles(*np.radians(given.attitude_deg)), np.asarray(given.position)
            self.used.add(key)
            return self._onto(given, point, p + R @ where, None if along is None else R @ along)
        p, R, plain, _ = self.poses[index]
        where, along = p + R @ where, None if along is None else R @ along
        direction = None if along is None else _triple(along)
        if given is None and plain in COUPLED and "coupled" in self.bodies:
            key, given = "coupled", self.bodies["coupled"]
        self.used.add(key)
        body = given or self.own.get(index)
        return _Place(where, _triple(where), direction) if body is None else self._onto(body, point, where, along)

    def _point(self, row: Row) -> None:
        deck = self.deck
        key, kind = deck.whole(row, "id", 1), row.values["attachment"].lower()
        where = np.array([deck.number(row, c) for c in ("x", "y", "z")])
        loads = {c: deck.number(row, c) for c in ("mass", "volume", "CdA", "Ca")}
        if str(key) in self.places:
            deck.refuse(row.line, f"point {key} is given twice; numbers must differ")
        for column in ("fx", "fy", "fz"):
            if deck.number(row, column) != 0.0:
                deck.leave_out(
                    row.line,
                    f"point {key}: the steady force {column.upper()} = {row.values[column]} was left out; floatsim "
                    "has no constant forces",
                )
        for column, value in loads.items():
            if value < 0.0:
                deck.refuse(row.line, f"point {key}: {column}: got {value:g}; a number that is not negative is allowed")
        if kind in FREE:
            self.places[str(key)] = _Place(where, free=f"point_{key}")
            self.loads[str(key)] = (row.line, loads)
            return
        place = self._place(row, f"point {key}", kind, f"point_{key}", where, motion=self.motions.get(key))
        if place is None:
            deck.refuse(
                row.line,
                f"point {key}: got '{row.values['attachment']}'; Fixed, Coupled, Vessel, Free, Connect, BodyN or "
                "TurbineN is allowed",
            )
            place = _Place(where, _triple(where))
        elif isinstance(place.target, str) and any(loads.values()):
            given = ", ".join(f"{c} {v:g}" for c, v in loads.items() if v)
            deck.leave_out(
                row.line,
                f"point {key}: {given}: loads of a point on a body were left out; put them into the body",
            )
        self.places[str(key)] = place

    def _rod(self, row: Row, joining: dict[str, Row]) -> None:
        """Rods hold line ends: both ends get a place."""
        deck = self.deck
        key, kind = deck.whole(row, "id", 1), row.values["attachment"].lower()
        a = np.array([deck.number(row, c) for c in ("xa", "ya", "za")])
        b = np.array([deck.number(row, c) for c in ("xb", "yb", "zb")])
        segments = deck.whole(row, "segments")
        if f"{key}a" in self.places:
            deck.refuse(row.line, f"rod {key} is given twice; numbers must differ")
        span = float(np.linalg.norm(b - a))
        if span == 0.0:
            deck.refuse(
                row.line,
                f"rod {key}: its two ends are the same point; they give its direction, also for a rod of no length "
                "(NumSegs 0)",
            )
            span = 1.0
        q = (b - a) / span
        if segments == 0:
            b = a  # a rod of no length stands at its end A
        hinged = kind.endswith(("pinned", "pin"))
        plain = re.sub(r"(pinned|pin)$", "", kind) or "fixed"
        if plain in FREE or (hinged and segments > 0):
            if segments > 0:
                deck.refuse(
                    row.line,
                    f"rod {key}: got a {row.values['attachment']} rod {span:.4g} m long; rods that move on their "
                    "own are not known: model it as a Body, or as a rod with NumSegs 0",
                )
            for end in "ab":
                self.places[f"{key}{end}"] = _Place(a, free=f"rod_{key}")
            joining[str(key)] = row
            return
        if segments > 0:
            self._rod_loads(row, key, plain)
        for end, where, along in (("a", a, -q), ("b", b, q)):
            place = self._place(row, f"rod {key}", plain, f"rod_{key}{end}", where, None if hinged else along)
            if place is None:
                deck.refuse(
                    row.line,
                    f"rod {key}: attachment: got '{row.values['attachment']}'; Fixed, Coupled, Vessel, Pinned, "
                    "CoupledPinned, Free, BodyN, BodyNPinned or TurbineN is allowed",
                )
                place = _Place(where, _triple(where))
            self.places[f"{key}{end}"] = place

    def _rod_loads(self, row: Row, key: int, plain: str) -> None:
        if plain not in FIXED and (plain not in COUPLED or "coupled" in self.bodies):
            self.deck.leave_out(
                row.line,
                f"rod {key}: its own mass, buoyancy and drag were left out; only the line ends that it clamps were "
                "taken; put the rest into the body",
            )

    # lines

    def _line_rows(self) -> list[_LineRow]:
        deck, rows = self.deck, list[_LineRow]()
        for row in deck.rows("lines"):
            ends = []
            for column in "ab":
                text = row.values[column].lower()
                match = re.fullmatch(r"(?:point|connection|connect|con|node|p|c|n)?0*(\d{1,9})", text) or re.fullmatch(
                    r"r(?:od)?0*(\d{1,9}[ab])", text
                )
                if not match or match[1] not in self.places:
                    known = ", ".join([k if k[-1].isdigit() else f"R{k.upper()}" for k in self.places][:20]) or "none"
                    deck.refuse(
                        row.line,
                        f"Attach{column.upper()}: got '{row.values[column]}'; a point or an end of a rod is "
                        f"allowed (known: {known})",
                    )
                ends.append(match[1] if match else "")
            line = _LineRow(deck.whole(row, "id", 1), row.line, row.values["type"], (ends[0], ends[1]),
                            deck.number(row, "length"), deck.whole(row, "segments", 1))  # fmt: skip
            if line.id in [other.id for other in rows]:
                deck.refuse(row.line, f"line {line.id} is given twice; numbers must differ")
            rows.append(line)
        if not rows:
            deck.problems.append(f"{deck.path.name}: there are no lines; a section '--- LINES ---' must list them")
        return rows

    def _lines(self, rows: list[_LineRow], joining: dict[str, Row], types: LineTypes) -> list[Any]:
        sections: dict[int, Any] = {}
        lengths: dict[int, float] = {}
        for row in rows:
            a, b = (self.places[end].position for end in row.ends)
            length = row.length if row.length >= 0.0 else -row.length * float(np.linalg.norm(b - a))
            if row.length < 0.0:
                self.notes.append(
                    f"line {row.id}: UnstrLen {row.length:g} is a share of the distance between its ends: "
                    f"{length:.6g} m"
                )
            if not 0.0 < length <= LONGEST:
                self.deck.refuse(
                    row.line,
                    f"line {row.id}: UnstrLen: got {row.length:g}; a length above 0 and up to {LONGEST:g} m is "
                    "allowed",
                )
                continue
            lengths[row.id] = length
            sections[row.id] = types.section(row.line, row.type, length / row.segments)
        if self.deck.problems:
            return []
        chains = self._chains(rows, joining)
        where = {}  # (line, end 0 or 1) -> (name of the floatsim line, which end or None inside, arc length)
        built = []
        for chain in chains:
            at, name = 0.0, "line_" + "_".join(str(row.id) for row, _ in chain)
            pieces = []
            for k, (row, turned) in enumerate(chain):
                where[row.id, int(turned)] = (name, "end_a" if k == 0 else "", at)
                where[row.id, 1 - int(turned)] = (name, "end_b" if k == len(chain) - 1 else "", at + lengths[row.id])
                pieces.append((row, sections[row.id], lengths[row.id]))
                at += lengths[row.id]
            built.append((name, chain, pieces, at))
        owners, attachments = self._junctions(rows, where)
        breaks = self._breaks(rows, where)
        lines = []
        for name, chain, pieces, length in built:
            line = self._line(name, chain, pieces, length, attachments.get(name, []), breaks.get(name, []))
            if line is not None:
                lines.append(line)
                self._tie(name, chain, owners, types)
        return lines

    def _chains(self, rows: list[_LineRow], joining: dict[str, Row]) -> list[list[tuple[_LineRow, bool]]]:
        """Lines in series through free rods of no length, each with whether it runs from its end B to its end A."""
        at: dict[str, list[tuple[_LineRow, int]]] = {}
        for row in rows:
            for end in (0, 1):
                at.setdefault(row.ends[end], []).append((row, end))
        partner: dict[tuple[int, int], tuple[_LineRow, int]] = {}
        for key, rod in joining.items():
            a, b = at.get(f"{key}a", []), at.get(f"{key}b", [])
            if len(a) == len(b) == 1 and a[0][0] is not b[0][0]:
                partner[a[0][0].id, a[0][1]], partner[b[0][0].id, b[0][1]] = b[0], a[0]
            elif len(a) + len(b) > 1:
                self.deck.leave_out(
                    rod.line,
                    f"rod {key}: {len(a)} lines at its end A and {len(b)} at B meet at a hinge here; the bending "
                    "moment between them was left out",
                )
        chains, seen = [], set()
        for row in [r for r in rows if any((r.id, e) not in partner for e in (0, 1))] + rows:
            if row.id in seen:
                continue
            enter = 0 if (row.id, 0) not in partner or (row.id, 1) in partner else 1
            chain, now, end = [], row, enter
            while now.id not in seen:
                seen.add(now.id)
                chain.append((now, end == 1))
                if (now.id, 1 - end) not in partner:
                    break
                now, end = partner[now.id, 1 - end]
            if len(chain) > 1:
                ids = ", ".join(str(r.id) for r, _ in chain)
                self.notes.append(
                    f"lines {ids} are joined by free rods of no length: one line of {len(chain)} pieces, bending "
                    "continuous"
                )
            chains.append(chain)
        return chains

    def _ends(self, chain: list[tuple[_LineRow, bool]]) -> tuple[str, str]:
        """Where a chain of lines starts and ends."""
        (first, turned_first), (last, turned_last) = chain[0], chain[-1]
        return first.ends[int(turned_first)], last.ends[1 - int(turned_last)]

    def _line(self, name: str, chain: list[tuple[_LineRow, bool]], pieces: list[Any], length: float,
              attachments: list[Any], breaks: list[Any]) -> Any:  # fmt: skip
        ends = [self.places[end] for end in self._ends(chain)]
        given: dict[str, Any] = {}
        for place, end in zip(ends, ("end_a_position", "end_b_position"), strict=True):
            if place.free:
                given[end] = _triple(place.position)
        span = float(np.linalg.norm(ends[1].position - ends[0].position))
        if span > length:
            given["taut"] = True
            self.notes.append(
                f"{name}: its ends start {span:.6g} m apart, more than its {length:.6g} m: it starts stretched"
            )
        row = chain[0][0]
        if len(pieces) == 1:
            given |= {"section": pieces[0][1], "length": length, "elements": row.segments}
        else:
            made = [self.deck.made(r.line, Piece, section=s, length=l, elements=r.segments) for r, s, l in pieces]
            if any(piece is None for piece in made):
                return None
            given["pieces"] = made
        if attachments:
            given["attachments"] = attachments
        if breaks:
            given["breaks"] = breaks
        return self.deck.made(row.line, Line, name=name, **given)

    def _tie(self, name: str, chain: list[tuple[_LineRow, bool]], owners: dict[str, str], types: LineTypes) -> None:
        for key, end, k in zip(self._ends(chain), ("end_a", "end_b"), (0, -1), strict=True):
            place, me = self.places[key], f"{name}.{end}"
            bends = chain[k][0].type.lower() in types.bending
            if place.motion is not None:
                shift = place.motion.start - place.position
                if np.linalg.norm(shift) > 1e-6:
                    self.notes.append(f"point {key}: the motion starts {_triple(shift)} m from the file's coordinates")
                self.joints.append(Prescribed(a=me, motion=place.motion))
            elif place.free:
                if owners[place.free] != me:
                    self.joints.append(Ball(a=me, b=owners[place.free]))
            elif place.direction is not None and bends:
                self.joints.append(Clamp(a=me, b=place.target, direction=place.direction))
            else:
                self.joints.append(Ball(a=me, b=place.target))

    def _junctions(self, rows: list[_LineRow], where: Any) -> tuple[dict[str, str], dict[str, list[Any]]]:
        """The line end that stands for each free point, and what is attached there."""
        owners: dict[str, str] = {}
        attachments: dict[str, list[Any]] = {}
        for row in rows:
            for end in (0, 1):
                key = row.ends[end]
                place = self.places[key]
                name, outer, at = where[row.id, end]
                if not place.free or place.free in owners or not outer:
                    continue
                owners[place.free] = f"{name}.{outer}"
                _, loads = self.loads.get(key, (0, {}))
                if any(loads.get(c, 0.0) for c in ("mass", "volume", "CdA")):
                    attachments.setdefault(name, []).append(self.deck.made(
                        row.line, Attachment, name=place.free, at=at, mass=loads["mass"], volume=loads["volume"],
                        drag_area=loads["CdA"], added_mass=loads["Ca"],
                    ))  # fmt: skip
        for key, (line, _) in self.loads.items():
            if f"point_{key}" not in owners:
                self.deck.leave_out(line, f"free point {key} holds no line and was left out")
        return owners, attachments

    def _breaks(self, rows: list[_LineRow], where: Any) -> dict[str, list[Any]]:
        breaks: dict[str, list[Any]] = {}
        ids = {row.id: row for row in rows}
        for row in self.deck.rows("failure"):
            match = re.fullmatch(r"(?:point|con|p|c)?0*(\d{1,9})|r(?:od)?0*(\d{1,9}[ab])", row.values["point"].lower())
            point = (match[1] or match[2]) if match else ""
            words = [word for word in row.values["lines"].split(",") if word]
            lines = [ids.get(int(word)) if re.fullmatch(r"\d{1,9}", word) else None for word in words]
            time, tension = self.deck.number(row, "time"), self.deck.number(row, "tension")
            ends = [[e for e in (0, 1) if line.ends[e] == point] for line in lines if line is not None]
            if not lines or None in lines or not all(ends) or time < 0.0 or tension < 0.0:
                self.deck.refuse(
                    row.line,
                    f"failure: got point '{row.values['point']}', lines '{row.values['lines']}', time {time:g}, "
                    f"tension {tension:g}; lines that end at the point and numbers that are not negative are "
                    "allowed",
                )
            elif len(lines) > 1:
                self.deck.leave_out(
                    row.line,
                    f"failure at {row.values['point']} of lines {row.values['lines']}, which would stay tied to "
                    "each other: left out; floatsim parts one line at a time",
                )
            else:
                assert lines[0] is not None
                name, _, at = where[lines[0].id, ends[0][0]]
                for cause, value in (("time", time), ("tension", tension)):
                    if value > 0.0:
                        breaks.setdefault(name, []).append(self.deck.made(row.line, Break, at=at, **{cause: value}))
                self.notes.append(
                    f"line {lines[0].id} parts at its end at {row.values['point']} (failure, line {row.line}): its "
                    "last element is cut in the middle"
                )
        return breaks

    # the sea, options and the rest

    def _option(self, what: str, default: float) -> float:
        for key in _OPTIONS[what]:
            if key in self.deck.options:
                line, text, written = self.deck.options[key]
                value = number(text)
                if value is None and what == "depth":
                    self.deck.leave_out(line, f"{written} = {text}: bathymetry files are not read; the bed is flat")
                elif value is None:
                    self.deck.refuse(line, f"{written}: got '{text}'; a number is allowed")
                else:
                    return value
        return default

    def _sea(self, depth: float | None) -> tuple[Any, float]:
        own = self._option("depth", 0.0)
        deepest = -min((p.position[2] for p in self.places.values() if p.target is not None), default=0.0)
        if depth is not None:
            if own and own != depth:
                self.notes.append(f"depth: {depth:g} m as asked for, instead of the file's {own:g} m")
        elif own:
            depth = own
        elif deepest > 0.0:
            depth = float(deepest)
            self.notes.append(f"depth: the file has no WtrDpth: {depth:g} m, the depth of its deepest fixed point")
        else:
            self.deck.problems.append(
                f"{self.deck.path.name}: there is no WtrDpth and no anchor below the surface; give depth=..."
            )
            return None, 0.0
        friction, axial = self._option("friction", 0.0), self._option("friction_axial", -1.0)
        axial = axial if "mu_ka" in self.deck.options else friction
        line = max((entry[0] for entry in self.deck.options.values()), default=0)
        seabed = self.deck.made(
            line, Seabed, stiffness=self._option("stiffness", 3.0e6), damping=self._option("damping", 3.0e5),
            friction=friction, friction_axial=axial,
        )  # fmt: skip
        if friction or axial:
            self.notes.append(
                f"seabed friction {friction:g} across and {axial:g} along the line, elastic over the bed's slip "
                "length instead of MoorDyn's growth with velocity (FricDamp, CV)"
            )
        if self._option("static friction", 1.0) != 1.0:
            self._left_out("static friction", "static and sliding friction are the same here")
        if seabed is None:
            return None, 0.0
        gravity = self._option("gravity", 9.80665 if "kb" in self.deck.options else 9.81)
        if gravity < 0.0:
            self.deck.refuse(line, f"g: got {gravity:g}; a number that is not negative is allowed")
        return self.deck.made(line, Sea, depth=depth, density=self._option("density", 1025.0), seabed=seabed), gravity

    def _left_out(self, what: str, why: str) -> None:
        line, text, key = next(self.deck.options[k] for k in _OPTIONS[what] if k in self.deck.options)
        self.deck.leave_out(line, f"{key} = {text}: {why}")

    def _sections_left_out(self) -> None:
        deck = self.deck
        why = {
            "control": "line control channels were left out: lengths do not change during a run",
            "loads": "external forces and dampings were left out",
            "syrope": "initial states of SYROPE lines were left out",
        }
        for section, what in why.items():
            for row in deck.rows(section)[:1]:
                deck.leave_out(row.line, f"{what} ({len(deck.rows(section))} lines of text)")
        waves = {"wavekin": "waves", "waterkin": "waves and current", "currents": "a current", "current": "a current",
                 "seafloorfile": "bathymetry", "bathfile": "bathymetry", "bathymetry": "bathymetry"}  # fmt: skip
        known = {key for keys in _OPTIONS.values() for key in keys}
        for key, (line, text, written) in deck.options.items():
            if key in waves:
                if text.lower() not in ("0", "", "none", "-", "0.0", "unused", "false"):
                    deck.leave_out(
                        line,
                        f"{written} = {text}: {waves[key]} left out; that belongs to the model's sea: "
                        "floatsim.Sea(waves=..., current=..., seabed=...)",
                    )
            elif key not in known | _ITS_OWN:
                deck.leave_out(
                    line,
                    f"option {written} = {text} is not known and was left "
                    f"out{nearest(written, [k for k in known if len(k) > 2])}",
                )

    def _say(self) -> None:
        """The notes on what was converted, in words."""
        deck = self.deck
        if self.held:
            self.notes.append(
                f"held where they are, since no body or motion was given for them: {', '.join(self.held)}"
            )
        for row in deck.rows("line_types"):
            value = number(row.values["BA"])
            if value is not None and value < 0.0 and number(row.values["EA"]) is not None:
                self.notes.append(
                    f"line type '{row.values['name']}': BA/-zeta {value:g} is a damping ratio: {-value:g} l0 "
                    "sqrt(EA m) per element"
                )
        self.notes.append(
            "drag: Cd on diameter times length, CdAx on pi times diameter times length, as here; tension is EA "
            "times engineering strain, here also in compression"
        )
        self.notes.append(
            "seabed: kBot and cBot act on diameter times length; here the damper is reached at a penetration of "
            "0.05 m and proportional to it"
        )
        own = [written for key, (_, _, written) in deck.options.items() if key in _ITS_OWN]
        if own:
            self.notes.append(f"options of MoorDyn's own solver and files, not needed here: {', '.join(own)}")
        if deck.outputs:
            self.notes.append(
                f"the {len(deck.outputs)} output channels listed are not needed: floatsim writes positions, "
                "tensions and end forces of all lines"
            )


def _triple(values: Any) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return x, y, z
