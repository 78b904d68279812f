"""Lines: chains, ropes and power cables as two-node elements between points.

A line is one or several pieces in series, each with its own section and element length; bending goes on across a
change of section. The element's physics stand in parts/element.py, bending in parts/bending.py, the seabed in
sea/seabed.py, laws in floatsim/laws. This file turns the description into their arrays.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from floatsim.description import Items, Name, Vector3
from floatsim.errors import CaseError, ModelError, nearest
from floatsim.frames import Array
from floatsim.laws.engineering import Engineering
from floatsim.laws.moment_table import MomentTable, pad_tables, pair_table
from floatsim.parts.attachment import LineLoad
from floatsim.parts.bending import bending_powers, line_bending
from floatsim.parts.element import (
    CA,
    COLUMNS,
    DRY,
    E_AXIAL,
    E_GRAVITY,
    E_HYDROSTATIC,
    E_KINETIC,
    E_SEABED,
    ENGINEERING,
    GRAVITY,
    GREEN,
    L0,
    LAW,
    LIVE,
    MU_A,
    MU_N,
    P_ADDED,
    P_CONTACT,
    P_CURRENT,
    P_DRAG,
    P_FRICTION,
    P_STRUCTURAL,
    P_SURFACE,
    P_WAVE,
    POWERS,
    SPECIAL,
    WATER,
    drag_stick_points,
    exchange_tension,
    expected_tension,
    largest_turn,
    line_elements,
    line_powers,
    step_error,
    stretches,
    tensions,
)
from floatsim.parts.part import Anchor, Part
from floatsim.parts.section import MAX_ELEMENTS, Attachment, BendStiffener, Break, Piece, Section
from floatsim.parts.shapes import hanging_arc

Index = NDArray[np.int64]

STRAIN_ERROR = 0.02  # of a line's largest tension so far: local error of a step that is allowed
PRESSED = 0.01  # share of its length by which a line may be drawn too short
NO_LESS = 0.1  # of a line's weight in air: what counts as its largest tension while it lies or floats slack
_SAMPLES = (np.arange(8) + 0.5) / 8.0  # of a half element, for what a stiffener adds to it


class Line(Part):
    """A line from end_a to end_b: of one section, or of several pieces in series.

    section, length [m, unstretched], elements: a line of one piece; or pieces: a list of Piece. end_a_position,
    end_b_position [m]: where an end starts if no joint says so. attachments: clump weights, buoyancy modules.
    stiffener_a, stiffener_b: bend stiffeners of clamped ends. breaks: where and when it parts. shape: what statics
    start from (floatsim.parts.shapes; default: a circular arc). form: 'shared' (elements share their nodes: the node
    *is* the ball joint between them) or 'ball_joints' (each element owns its two end nodes, tied by multipliers).
    taut: set True for a line that is meant to be shorter than the distance it spans (pretension).
    Connection points: `NAME.end_a`, `NAME.end_b`.
    """

    name: Name
    pieces: Items
    end_a_position: Vector3 | None = None
    end_b_position: Vector3 | None = None
    attachments: Items = ()
    stiffener_a: BendStiffener | None = None
    stiffener_b: BendStiffener | None = None
    breaks: Items = ()
    shape: Any = None
    form: Literal["shared", "ball_joints"] = "shared"
    taut: bool = False

    def __init__(self, /, *args: Any, **data: Any) -> None:
        one = ("section", "length", "elements")
        label = f"Line '{data['name']}'" if isinstance(data.get("name"), str) else "Line"
        own = {name: data.pop(name) for name in one if name in data}
        strange = [name for name in data if name not in type(self).model_fields]
        problems = [f"{label}: unknown argument '{name}'{nearest(name, (*type(self).model_fields, *one))}"
                    for name in strange]  # fmt: skip
        data = {name: value for name, value in data.items() if name not in strange}
        if own and "pieces" in data:
            problems.append(f"{label}: got pieces and {', '.join(own)}; these belong to each Piece then")
        elif own:
            try:
                data["pieces"] = (Piece(**own),)
            except ModelError as error:
                problems += [label + line.removeprefix("Piece") for line in error.problems]
        elif not args and "pieces" not in data:
            problems.append(f"{label}: it is made of nothing; give section, length and elements, or pieces=[...]")
        elif isinstance(data.get("pieces"), list | tuple | np.ndarray) and len(data["pieces"]) == 0:
            problems.append(f"{label}: pieces: got none; give at least one Piece(section=, length=, elements=)")
        if problems:
            try:  # what else is wrong with it
                super().__init__(*args, **(data | {"pieces": ()}))
            except ModelError as more:
                problems += more.problems
            raise ModelError(problems)
        super().__init__(*args, **data)

    @model_validator(mode="after")
    def _of_its_kinds(self) -> Line:
        for name, kind in (("pieces", Piece), ("attachments", Attachment), ("breaks", Break)):
            for item in getattr(self, name):
                if not isinstance(item, kind):
                    raise ValueError(f"{name}: got {item!r:.60}; a list of {kind.__name__}(...) is allowed")
        if isinstance(self.shape, type) or (self.shape is not None and not hasattr(self.shape, "points")):
            raise ValueError(f"shape: got {self.shape!r:.60}; a shape such as Catenary() is allowed, or None")
        names = [item.name for item in self.attachments]
        for name in sorted({n for n in names if names.count(n) > 1}):
            raise ValueError(f"attachments: the name '{name}' is used {names.count(name)} times; names must differ")
        if not self.pieces:
            return self  # refused by __init__
        if self.elements > MAX_ELEMENTS:
            raise ValueError(f"its pieces have {self.elements} elements together; at most {MAX_ELEMENTS} are allowed")
        for item in (*self.attachments, *self.breaks):
            if item.at > self.length * (1.0 + 1e-9):
                what = f"attachment '{item.name}'" if isinstance(item, Attachment) else "a break"
                raise ValueError(f"{what} is at {item.at:g} m; the line is {self.length:g} m long, measured from end_a")
        self._check_stiffeners()
        return self

    def _check_stiffeners(self) -> None:
        """Raises ValueError for stiffeners that are too long, overlap, or lie over a moment table."""
        own = (("stiffener_a", self.stiffener_a, self.pieces), ("stiffener_b", self.stiffener_b, self.pieces[::-1]))
        for end, stiffener, pieces in own:
            if stiffener is None:
                continue
            if stiffener.length > self.length:
                raise ValueError(f"{end} is {stiffener.length:g} m long, the line only {self.length:g} m")
            start = 0.0
            for piece in pieces:
                if start < stiffener.length and piece.section.bending_law is not None:
                    raise ValueError(
                        f"{end} lies over section '{piece.section.name}', whose bending_law is a moment table; its EI "
                        "cannot be added to a table, give that stretch a section with EI"
                    )
                start += piece.length
        both = sum(stiffener.length for _, stiffener, _ in own if stiffener is not None)
        if both > self.length:
            raise ValueError(f"its stiffeners are {both:g} m long together, the line only {self.length:g} m")

    @staticmethod
    def batch() -> type[LineBatch]:
        return LineBatch

    # -- along the line -----------------------------------------------------------------------

    @cached_property
    def elements(self) -> int:
        """Number of elements of all pieces."""
        return int(sum(piece.elements for piece in self.pieces))

    @cached_property
    def length(self) -> float:
        """Unstretched length [m]."""
        return float(sum(piece.length for piece in self.pieces))

    @cached_property
    def element_lengths(self) -> Array:
        """Unstretched lengths [m], shape (elements,)."""
        return np.concatenate([np.full(p.elements, p.length / p.elements) for p in self.pieces])

    @cached_property
    def arc_length(self) -> Array:
        """Unstretched distance of the nodes from end a [m], shape (elements + 1,)."""
        return np.concatenate([[0.0], np.cumsum(self.element_lengths)])

    @cached_property
    def element_sections(self) -> tuple[Section, ...]:
        """The section of every element."""
        return tuple(piece.section for piece in self.pieces for _ in range(piece.elements))

    def element_at(self, s: float) -> int:
        """The element at arc length s [m]."""
        return int(np.clip(np.searchsorted(self.arc_length, s, side="right") - 1, 0, self.elements - 1))

    @cached_property
    def half_stiffness(self) -> Array:
        """Bending stiffness EI [N m2] of the two halves of every element, stiffeners included, shape (elements, 2).

        The harmonic mean over each half: in a row flexibilities add. A moment table counts with its first slope.
        """
        own = [s.bending_law.stiffness if s.bending_law else s.EI for s in self.element_sections]
        out = np.repeat(np.array(own)[:, None], 2, axis=1)
        for e, half, s in self._under_stiffeners():
            EI = out[e, half] + sum(st.at("EI", d) for st, d in s)
            out[e, half] = 1.0 / np.mean(1.0 / EI) if np.all(EI > 0.0) else 0.0
        return out

    def _under_stiffeners(self) -> list[tuple[int, int, list[tuple[BendStiffener, Array]]]]:
        """(element, half, [(stiffener, distances of samples from its root)]) where there is one."""
        found = []
        for e, (s0, l0) in enumerate(zip(self.arc_length, self.element_lengths)):
            for half in range(2):
                s = s0 + 0.5 * l0 * (half + _SAMPLES)
                over = [(st, d) for st, d in ((self.stiffener_a, s), (self.stiffener_b, self.length - s))
                        if st is not None and d.min() < st.length]  # fmt: skip
                if over:
                    found.append((e, half, over))
        return found

    @cached_property
    def element_sizes(self) -> Array:
        """Mass per length [kg/m], displaced area [m2] and diameter [m] of every element with its stiffeners,
        shape (elements, 3)."""
        out = np.array([(c.mass_per_length, c.area, c.diameter) for c in self.element_sections])
        for e, _, over in self._under_stiffeners():
            section = self.element_sections[e]
            for stiffener, d in over:
                out[e, 0] += 0.5 * np.mean(stiffener.at("mass_per_length", d))
                if stiffener.diameter is not None:
                    outer = np.maximum(stiffener.at("diameter", d), section.diameter)
                    out[e, 1] += 0.5 * np.mean(0.25 * np.pi * outer**2 - section.area)
                    out[e, 2] += 0.5 * np.mean(outer - section.diameter)
        return out

    def wet_weight(self, density: float, gravity: float) -> Array:
        """Weight in water per length of every element [N/m], shape (elements,)."""
        mass, area, _ = self.element_sizes.T
        return np.asarray((mass - density * area) * gravity)

    def element_parameters(self, density: float, friction: tuple[float, float]) -> Array:
        """Columns of parts/element.py, shape (elements, COLUMNS), with the bed's friction (along, across)."""
        out = np.zeros((self.elements, COLUMNS))
        for e, (l0, c) in enumerate(zip(self.element_lengths, self.element_sections, strict=True)):
            mass, area, d = self.element_sizes[e]
            half = 0.5 * l0
            water = density * area * half
            law = GREEN if c.axial_law is None else ENGINEERING if isinstance(c.axial_law, Engineering) else SPECIAL
            along, across = c.seabed_friction or friction
            out[e] = (
                l0, c.stiffness, c.damping(l0), mass * half, water, c.added_mass_normal * water,
                c.added_mass_tangential * water, 0.5 * density * d * c.drag_normal * half,
                0.5 * np.pi * density * d * c.drag_tangential * half, d, d * half, 1e-7 * c.stiffness / l0, law, 1.0,
                along, across,
            )  # fmt: skip
        return out

    # -- points -------------------------------------------------------------------------------

    @property
    def n_points(self) -> int:
        return self.elements + 1 if self.form == "shared" else 2 * self.elements

    def anchors(self) -> dict[str, Anchor]:
        """Connection points: name -> (local point, local rotation or -1, arm in the body frame)."""
        zero = (0.0, 0.0, 0.0)
        return {"end_a": (0, -1, zero), "end_b": (self.n_points - 1, -1, zero)}

    @property
    def nodes(self) -> Index:
        """Local points that stand for the line's nodes 0..elements (one per shared position)."""
        if self.form == "shared":
            return np.arange(self.elements + 1)
        return np.concatenate([[0], 2 * np.arange(self.elements) + 1])

    def element_points(self, e: int) -> tuple[int, int]:
        """Local points of element e."""
        return (e, e + 1) if self.form == "shared" else (2 * e, 2 * e + 1)

    def internal_balls(self) -> list[tuple[int, int]]:
        """Pairs of local points that ball joints tie together (form 'ball_joints')."""
        if self.form == "shared":
            return []
        return [(2 * e + 1, 2 * e + 2) for e in range(self.elements - 1)]

    def children(self) -> list[Any]:
        return [LineLoad(name=f"{self.name}_{item.name}", line=self.name, load=item) for item in self.attachments]

    def place(self, ends: dict[str, Array], sea: Any) -> tuple[Array, Array] | None:
        """The crude shape statics start from: `shape`, or an arc of the line's length (straight if it is taut).

        None while an end is unknown.
        """
        a = self.end_a_position if self.end_a_position is not None else ends.get("end_a")
        b = self.end_b_position if self.end_b_position is not None else ends.get("end_b")
        if a is None or b is None:
            return None
        a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
        s = self.arc_length
        x = self.arc(a, b, sea) if self.shape is None else self.shape.points(a, b, s, sea.depth, self)
        if self.form == "ball_joints":
            x = np.repeat(x, 2, axis=0)[1:-1]
        return x, np.empty((0, 3, 3))

    def arc(self, a: Array, b: Array, sea: Any) -> Array:
        """A hanging arc; a line that floats in water bulges upwards."""
        if max(a[2], b[2]) > 0.0 or self.wet_weight(sea.density, 1.0) @ self.element_lengths > 0.0:
            return hanging_arc(a, b, self.arc_length, sea.depth)
        mirror = np.array([1.0, 1.0, -1.0])
        return hanging_arc(a * mirror, b * mirror, self.arc_length, 0.0) * mirror

    def held_wrongly(self, joints: Any) -> list[str]:
        """A stiffener around an end that no joint clamps."""
        clamped = {joint.a for joint in joints if hasattr(joint, "direction")}
        return [
            f"Line '{self.name}': stiffener_{end} is around an end that is not clamped; hold it by "
            f"Clamp(a='{self.name}.end_{end}', b=..., direction=...) or leave the stiffener out"
            for end, stiffener in (("a", self.stiffener_a), ("b", self.stiffener_b))
            if stiffener is not None and f"{self.name}.end_{end}" not in clamped
        ]

    def problems(self, ends: dict[str, Array], sea: Any) -> list[str]:
        """What only shows once the ends are known."""
        a = self.end_a_position if self.end_a_position is not None else ends.get("end_a")
        b = self.end_b_position if self.end_b_position is not None else ends.get("end_b")
        if a is None or b is None:
            return []
        a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
        span = float(np.linalg.norm(b - a))
        found = []
        if span == 0.0:
            found.append(f"Line '{self.name}': its two ends start at the same place; give them a distance")
        if span > self.length and not self.taut:
            short = span - self.length
            EA = self.length / sum(piece.length / piece.section.stiffness for piece in self.pieces)
            pull = EA * ((span / self.length) ** 2 - 1.0) / 2.0
            found.append(
                f"Line '{self.name}': length is {self.length:g} m but its ends are {span:.6g} m apart, "
                f"{short:.6g} m too short ({100.0 * short / self.length:.3g} %, {pull / 1e3:.4g} kN if it could); "
                "lengthen it, move an end, or set taut=True if it is meant to be pretensioned"
            )
        if self.shape is not None and hasattr(self.shape, "problems"):
            wrong = self.shape.problems(a, b, self.arc_length, sea.depth, self)
            found += [f"Line '{self.name}': {line}" for line in wrong]
        for end, point in (("end_a", a), ("end_b", b)):
            bed = sea.seabed.height(point[0], point[1], sea.depth)
            if point[2] < bed - 1e-6 * sea.depth:
                found.append(f"Line '{self.name}': {end} is at z = {point[2]:.6g} m, below the seabed at {bed:.6g} m")
        return found


class LineBatch:
    """All lines of a system in one batch: one compiled call evaluates every element of every line."""

    def __init__(self, parts: Sequence[Line], first_point: Sequence[int], first_rotation: Sequence[int],
                 sea: Any, gravity: float) -> None:  # fmt: skip
        self.parts = tuple(parts)
        count = np.cumsum([0, *(line.elements for line in parts)])
        self.elements_of = [slice(int(a), int(b)) for a, b in zip(count[:-1], count[1:])]
        count = np.cumsum([0, *(line.elements - 1 for line in parts)])
        self.pairs_of = [slice(int(a), int(b)) for a, b in zip(count[:-1], count[1:])]
        self.nodes_of = [p0 + line.nodes for line, p0 in zip(parts, first_point)]
        nodes = []
        for line, p0 in zip(parts, first_point, strict=True):
            start = p0 + (1 if line.form == "shared" else 2) * np.arange(line.elements)
            nodes.append(np.stack([start, start + 1], axis=1))
        self.nodes = np.ascontiguousarray(np.concatenate(nodes), dtype=np.int64)
        friction = sea.seabed.coefficients()
        self.P = np.concatenate([line.element_parameters(sea.density, friction) for line in parts])
        self._bending(nodes)
        self._laws()
        self._breaks()
        self.env = np.array([sea.density, gravity])
        self._sea = sea
        self.bed, self.grid = sea.seabed.parameters(sea.depth)
        self.runs = [(p0 + 1, line.elements - 1) for line, p0 in zip(parts, first_point, strict=True)
                     if line.form == "shared" and line.elements > 1]  # fmt: skip
        self.wet_points = np.unique(self.nodes)
        self._Ke = np.zeros((9, 6))
        n = len(self.nodes)
        self._s, self._rate, self.special = np.zeros(n), np.zeros(n), np.zeros((3, n))
        self._stick = np.zeros((2 * n, 6))
        self._tension = np.zeros(n)
        self._line_of = np.repeat(np.arange(len(parts)), [line.elements for line in parts])
        self._largest = np.zeros(len(parts))
        self._h = -1.0

    def _bending(self, nodes: list[Index]) -> None:
        """Pairs of neighbouring elements, their stiffness and damping, and tables of nonlinear moments."""
        pairs, stiffness = [], []
        tables: list[Array] = []
        for line, own in zip(self.parts, nodes, strict=True):
            l0, sections, EI = line.element_lengths, line.element_sections, line.half_stiffness
            for e in range(line.elements - 1):
                a, b = EI[e, 1], EI[e + 1, 0]
                row, k, damping = -1, 0.0, 0.0
                if a > 0.0 and b > 0.0:
                    k = 1.0 / (0.5 * l0[e] / a + 0.5 * l0[e + 1] / b)
                    damping = 0.5 * sum(sections[i].bending_damping / l0[i] for i in (e, e + 1))
                    laws = [sections[i].bending_law or y for i, y in ((e, a), (e + 1, b))]
                    if any(isinstance(law, MomentTable) for law in laws):
                        row = len(tables)
                        tables.append(pair_table((l0[e], l0[e + 1]), (laws[0], laws[1])))
                pairs.append((*own[e], *own[e + 1], row))
                stiffness.append((k, damping))
        self.pairs = np.array(pairs, dtype=np.int64).reshape(len(pairs), 5)
        self.B = np.array(stiffness, dtype=float).reshape(len(pairs), 2)
        self._whole = self.B.copy()  # B is emptied where a line breaks
        self.k = np.ascontiguousarray(self._whole[:, 0])
        self.tables = pad_tables(tables)

    def _laws(self) -> None:
        """Laws that run over their elements before the element kernel does."""
        sections = [section for line in self.parts for section in line.element_sections]
        groups: dict[int, list[int]] = {}
        for e in np.flatnonzero(self.P[:, LAW] == SPECIAL):
            groups.setdefault(id(sections[e].axial_law), []).append(int(e))
        self.laws = []
        for members in groups.values():
            index = np.array(members, dtype=np.int64)
            law = sections[members[0]].axial_law
            new = np.zeros((law.memory, len(index)))
            room = np.zeros(len(index)), np.zeros(len(index)), np.zeros((3, len(index)))
            self.laws.append((law, index, law.bind(np.ascontiguousarray(self.P[index, CA])), new, room))
        self.remembers = bool(self.laws)
        self.rough = bool(self.P[:, MU_A : MU_N + 1].any())

    def _breaks(self) -> None:
        found = [(self.elements_of[k].start + line.element_at(item.at), k, item)
                 for k, line in enumerate(self.parts) for item in line.breaks]  # fmt: skip
        self.breaks = [item for _, _, item in found]
        self.break_element = np.array([e for e, _, _ in found], dtype=np.int64)
        self.break_pairs = []
        for e, k, _ in found:
            local, first, last = e - self.elements_of[k].start, self.pairs_of[k].start, self.parts[k].elements - 1
            self.break_pairs.append([first + m for m in (local - 1, local) if 0 <= m < last])

    # -- the system's protocol ----------------------------------------------------------------

    def dofs(self, n_point: int) -> list[Index]:
        """Unknowns that each element couples, one table per kind of element."""
        xyz = np.arange(3)
        stiff = self.pairs[self.k > 0.0]
        return [(3 * self.nodes[:, :, None] + xyz).reshape(len(self.nodes), 6),
                (3 * stiff[:, :4, None] + xyz).reshape(len(stiff), 12)]  # fmt: skip

    def bind(self, slots: list[Index]) -> None:
        self._slots = slots[0]
        self._direct, self._step = _in_band(slots[0], np.arange(6))
        stiff = np.flatnonzero(self.k > 0.0)
        self._bend_slots = np.zeros((len(self.pairs) if len(stiff) else 0, 144), dtype=np.int64)
        self._bend_direct, self._bend_step = np.full(len(self.pairs), -1), 0
        if len(stiff):
            self._bend_slots[stiff] = slots[1]
            direct, self._bend_step = _in_band(slots[1], np.array([0, 1, 2, 3, 4, 5, 9, 10, 11]))
            shared = self.pairs[stiff, 1] == self.pairs[stiff, 2]
            self._bend_direct[stiff] = np.where(shared, direct, -1)

    def start(self, state: Any) -> dict[str, Any]:
        """Memories: stick points where the line is now, laws long at rest, nothing broken."""
        self._part(np.zeros(len(self.breaks), dtype=bool))
        stretches(state.x, state.v, self.nodes, self.P, self._s, self._rate)
        stick = np.zeros((2 * len(self.nodes), 6))
        stick[:, :3] = state.x[self.nodes.ravel()]
        d = np.diff(state.x[self.nodes], axis=1)[:, 0]
        stick[:, 3:] = np.repeat(d / np.linalg.norm(d, axis=1)[:, None], 2, axis=0)
        self._old, self._h = [law.start(self._s[index]) for law, index, *_ in self.laws], -1.0
        if self.laws:
            self._special(state.x, state.v)
        history = {"t": state.t, "broken": np.zeros(len(self.breaks), dtype=bool), "stick": stick, "laws": self._old}
        return history | self._tensions_at(state)

    def _tensions_at(self, state: Any) -> dict[str, Array]:
        """Memory of the step control for a line that has long been where it is."""
        tension = np.tile(self.tension(state), (3, 1))
        tension[2] = 1.0  # what was before is as good as long ago
        weight = np.bincount(self._line_of, 2.0 * self.env[GRAVITY] * self.P[:, DRY], len(self.parts))
        largest = np.asarray(NO_LESS * weight, dtype=np.float64)
        np.maximum.at(largest, self._line_of, np.abs(tension[0]))
        return {"tension": tension, "largest": largest}

    def keep(self, state: Any, before: dict[str, Any], after: dict[str, Any]) -> None:
        """What no equilibrium undoes: lines stay broken, ropes remember how far they were stretched."""
        np.copyto(after["broken"], before["broken"])
        self._part(after["broken"])
        self._old, self._h = before["laws"], -1.0
        if self.laws:
            self._special(state.x, state.v)
            for (*_, new, _), own in zip(self.laws, after["laws"], strict=True):
                np.copyto(own, new)
        after.update(self._tensions_at(state))

    def unused(self, history: dict[str, Any]) -> None:
        """Ropes that were never stretched: how they are drawn says nothing about it."""
        history["laws"] = [law.start(np.ones(len(index))) for law, index, *_ in self.laws]

    def _part(self, broken: NDArray[np.bool_]) -> None:
        """Let the elements that are broken carry nothing, all others what they did when new."""
        if self.breaks:
            self.P[self.break_element, LIVE] = 1.0
            np.copyto(self.B, self._whole)
            for k in np.flatnonzero(broken):  # after all are whole: two breaks may share an element
                self.P[self.break_element[k], LIVE] = 0.0
                self.B[self.break_pairs[k]] = 0.0

    def begin(self, w: Any, history: dict[str, Any], t: float, state: Any) -> None:
        """What is constant during the step to t: stick points, memories of laws, broken elements."""
        self._h = -1.0 if w.still else max(t - history["t"], 0.0)  # a rounded clock may be a trifle behind
        self._stick = history["stick"]
        self._old = history["laws"]
        if self.breaks:
            self._part(history["broken"])
            w.cut[self.nodes[self.break_element]] = False
            w.cut[self.nodes[self.break_element[history["broken"]]]] = True

    def add(self, w: Any) -> None:
        if self.laws:
            self._special(w.x, w.v)
        line_elements(w.x, w.v, w.a, w.u, w.du, w.eta, w.c, self.nodes, self.P, self.env, self.bed, self.grid,
                      self._stick, self.special, self._slots, self._direct, self._step, self._Ke, w.A, w.r,
                      w.s)  # fmt: skip
        if len(self._bend_slots):
            folded = line_bending(w.x, w.v, w.c, self.pairs, self.B, self.tables, self._bend_slots, self._bend_direct,
                                  self._bend_step, self._Ke, w.A, w.r, w.s)  # fmt: skip
            if folded >= 0:
                w.trouble = f"line '{self.name_at(folded)}' is folded back on itself"

    def _special(self, x: Array, v: Array) -> None:
        stretches(x, v, self.nodes, self.P, self._s, self._rate)
        for (_, index, evaluate, new, (s, rate, out)), old in zip(self.laws, self._old, strict=True):
            np.take(self._s, index, out=s)
            np.take(self._rate, index, out=rate)
            evaluate(s, rate, old, new, self._h, out)
            self.special[:, index] = out

    def error(self, history: dict[str, Any], w: Any) -> float:
        """Local error of the step in `w` over what is allowed: of axial strains, as tensions (STRAIN_ERROR).

        The error is what extrapolating the last two tensions misses: its size tells whether the step resolves how
        the tension changes, also where Newton converges happily on a step that smears a snap.
        """
        return float(step_error(w.x, w.v, self.nodes, self.P, self.special, history["tension"], STRAIN_ERROR,
                                self._line_of, w.t - history["t"], history["largest"], self._largest,
                                self._tension))  # fmt: skip

    def hold_back(self, w: Any, before: dict[str, Any], after: dict[str, Any]) -> None:
        """Stick points of an equilibrium with friction: the old ones, dragged along by halves that slid."""
        np.copyto(after["stick"], before["stick"])
        drag_stick_points(w.x, w.v, self.nodes, self.P, self.bed, self.grid, after["stick"])

    def commit(self, history: dict[str, Any], w: Any) -> None:
        """Take in the accepted step; `w.event` says that something broke."""
        if self.rough:
            drag_stick_points(w.x, w.v, self.nodes, self.P, self.bed, self.grid, history["stick"])
        if w.controlled:
            old = history["tension"]
            old[1], old[0], old[2] = old[0], self._tension, w.t - history["t"]
            np.maximum(history["largest"], self._largest, out=history["largest"])
        history["t"] = w.t
        if self.breaks and not history["broken"].all():
            stretches(w.x, w.v, self.nodes, self.P, self._s, self._rate)
            tension = np.empty(len(self.nodes))
            tensions(self.nodes, self.P, self.special, self._s, self._rate, tension)
            tension = tension[self.break_element]
            for k, item in enumerate(self.breaks):
                over = w.t >= item.time - 1e-9 if item.time is not None else tension[k] >= item.tension
                if over and not history["broken"][k]:
                    history["broken"][k] = w.event = True
        for (law, *_, new, _), old in zip(self.laws, history["laws"], strict=True):
            if law.memory:
                np.copyto(old, new)

    # -- what statics ask of slender things ----------------------------------------------------

    @property
    def lengths(self) -> Array:
        """Unstretched lengths of all elements [m]."""
        return self.P[:, L0]

    def weight_in_water(self) -> float:
        """Of all lines, what sinks and what floats alike [N]."""
        return float(2.0 * np.abs(self.P[:, DRY] - self.P[:, WATER]).sum() * self.env[GRAVITY])

    def bending_force(self) -> float:
        """Bound [N] of every EI/l0^2, largest EI/l0 over shortest l0: what is softer would shorten before it bends."""
        return float(self.k.max(initial=0.0) / self.P[:, L0].min())

    def let_out(self, state: Any) -> None:
        """Lines that are drawn shorter than they are, by PRESSED, become arcs of their length.

        Compressed like that they would buckle, and how they do decides which equilibrium they find.
        """
        for line, where in zip(self.parts, self.nodes_of, strict=True):
            x = state.x[where]
            if np.linalg.norm(np.diff(x, axis=0), axis=1).sum() < (1.0 - PRESSED) * line.length:
                state.x[where] = line.arc(x[0], x[-1], self._sea)
                if line.form == "ball_joints":
                    first = where[0]
                    state.x[first : first + line.n_points] = np.repeat(state.x[where], 2, axis=0)[1:-1]

    def largest_turn(self, w: Any, d: Array) -> float:
        """Largest angle [rad] by which the linear step d turns an element."""
        return float(largest_turn(w.x, d, self.nodes))

    def expected_tension(self, w: Any, d: Array, part: float, T: Array) -> None:
        """Into T: tensions that the linear step `part` d leads to if nothing turns."""
        expected_tension(w.x, d, part, self.nodes, self.P, self.special, w.c, T)

    def exchange_tension(self, w: Any, T: Array) -> None:
        """Let the lateral stiffness in the matrix be that of the tensions T instead of the present ones."""
        exchange_tension(w.x, self.nodes, self.P, self.special, w.c, T, self._slots, w.A)

    # -- results ------------------------------------------------------------------------------

    def name_at(self, pair: int) -> str:
        """`line, node k` of a bending pair."""
        for line, where in zip(self.parts, self.pairs_of, strict=True):
            if where.start <= pair < where.stop:
                return f"{line.name}', node '{pair - where.start + 1}"
        return "?"

    def ledger(self, w: Any, book: Any) -> None:
        """Energies and powers of all lines."""
        y, z = np.zeros(POWERS), np.zeros(3)
        line_powers(w.x, w.v, w.a, w.u, w.du, w.eta, book.current, self.nodes, self.P, self.env, self.bed, self.grid,
                    self.rough, self._stick, y)  # fmt: skip
        if self.laws:
            self._special(w.x, w.v)
        for law, index, _, new, (s, rate, out) in self.laws:
            if not hasattr(law, "energy"):
                raise CaseError(f"energy: the axial law {type(law).__name__} does not tell its energy (`energy`)")
            U, lost = law.energy(s, new)
            l0 = self.P[index, L0] * self.P[index, LIVE]
            damped = lost + out[2] * rate**2
            y[E_AXIAL] += l0 @ U
            y[E_AXIAL + 1] += l0 @ (out[0] * rate - damped)
            y[P_STRUCTURAL] -= l0 @ damped
        if len(self._bend_slots):
            bending_powers(w.x, w.v, self.pairs, self.B, self.tables, z)
        book.store("kinetic", y[E_KINETIC], y[E_KINETIC + 1])
        book.store("gravity", y[E_GRAVITY], y[E_GRAVITY + 1])
        book.store("hydrostatic", y[E_HYDROSTATIC], y[E_HYDROSTATIC + 1])
        book.store("axial", y[E_AXIAL], y[E_AXIAL + 1])
        book.store("bending", z[0], z[1])
        book.store("seabed", y[E_SEABED], y[E_SEABED + 1])
        book.work("structural", y[P_STRUCTURAL] + z[2])
        for name, at in (("wave", P_WAVE), ("current", P_CURRENT), ("drag", P_DRAG), ("added_mass", P_ADDED),
                         ("surface", P_SURFACE), ("contact", P_CONTACT), ("friction", P_FRICTION)):  # fmt: skip
            book.work(name, y[at])

    def tension(self, w: Any) -> Array:
        """Effective tension of all elements [N], shape (n_elements of all lines,), before the step is committed."""
        out = np.empty(len(self.nodes))
        stretches(w.x, w.v, self.nodes, self.P, self._s, self._rate)
        tensions(self.nodes, self.P, self.special, self._s, self._rate, out)
        return out


def _in_band(slots: Index, keep: Index) -> tuple[Index, int]:
    """Where a table's unknowns `keep` stand in one band in the order of `keep`: address of the first entry (n,), -1
    where they do not; and the step from row to row."""
    m = len(keep)
    width = int(round(np.sqrt(slots.shape[1])))
    block = slots.reshape(-1, width, width)[:, keep][:, :, keep]
    steps = block[:, 1, 0] - block[:, 0, 0]
    values, counts = np.unique(steps, return_counts=True)
    if len(values) == 0:
        return np.zeros(0, dtype=np.int64), 0
    step = int(values[counts.argmax()])
    expected = block[:, :1, :1] + step * np.arange(m)[:, None] + np.arange(m)
    return np.where((block == expected).all(axis=(1, 2)), block[:, 0, 0], -1), step
