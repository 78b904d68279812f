"""PTOs and other force components along a coordinate of a joint or between two points.

Laws (floatsim/pto_laws) add up to one generalised force F on the displacement s, v = ds/dt:

    F = sum F_law(s, v, t, states)      P = -F v: power the PTO takes out of the system, not negative for dampers

Positive F drives s up (signs: pto_laws/__init__.py). Energy is the integral of P by the trapezoidal rule over accepted
steps. How a force on a coordinate loads the two sides, with exact tangents: joints/coordinates.py.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from floatsim.description import Finite, Items, Name, Target
from floatsim.errors import ModelError, nearest
from floatsim.frames import Array, set_matrix
from floatsim.jit import kernel
from floatsim.joints.coordinates import Coordinates, Distance, push
from floatsim.parts.part import Output, Part
from floatsim.pto_laws.law import Now

Index = NDArray[np.int64]


class PTO(Part):
    """Force laws along a coordinate.

    Either joint: label of a joint, and coordinate: which of its coordinates, if it has several; or a and b: two
    connection points (or fixed points), for the distance between them. laws: what acts there; their forces add up.
    zero [m or rad]: value of the coordinate at which the displacement is zero; default 0 for joints, the distance at
    the drawing position for two points.

    Outputs: NAME_displacement [m] (rad along a turn), NAME_velocity, NAME_force [N] (N m), NAME_power [W],
    NAME_energy [J], and what its laws tell. A positive force drives the displacement up: along a joint it pushes a in
    the positive sense, between two points it pushes them apart (a tight spring has a negative force). Power is
    absorbed power, -force times velocity.
    """

    name: Name
    joint: str | None = None
    coordinate: str | None = None
    a: Target | None = None
    b: Target | None = None
    laws: Items
    zero: Finite | None = None

    @model_validator(mode="after")
    def _complete(self) -> PTO:
        ends = [end for end in (self.a, self.b) if end is not None]
        if (self.joint is None) == (not ends) or len(ends) == 1:
            raise ValueError("give either joint='LABEL' or both a and b")
        if self.coordinate is not None and self.joint is None:
            raise ValueError("coordinate belongs to a joint; between two points there is only the distance")
        if not self.laws:
            raise ValueError("laws: got none; give at least one, e.g. Linear(damping=...)")
        for law in self.laws:
            if isinstance(law, type) or not hasattr(law, "group"):
                raise ValueError(f"laws: got {law!r:.60}; laws such as Linear(...) are allowed")
        return self

    @staticmethod
    def batch() -> type[PTOBatch]:
        return PTOBatch

    @property
    def between(self) -> tuple[Any, ...]:
        return () if self.joint is not None else (self.a, self.b)

    def held_wrongly(self, joints: Any) -> list[str]:
        """Whether its joint is there and has coordinates."""
        if self.joint is None:
            return []
        found = {joint.label: joint for joint in joints}
        if self.joint not in found:
            return [f"PTO '{self.name}': there is no joint '{self.joint}'{nearest(self.joint, found)}"]
        if not hasattr(found[self.joint], "coordinates"):
            kind = type(found[self.joint]).__name__
            return [f"PTO '{self.name}': joint '{self.joint}' is a {kind}, which has no coordinate to act along"]
        return []

    def problems(self, ends: dict[str, Array], sea: Any) -> list[str]:
        """What only shows once the ends are known."""
        a, b = ends.get("a"), ends.get("b")
        if a is None or b is None or np.linalg.norm(b - a) > 0.0:
            return []
        return [f"PTO '{self.name}': its two ends start at the same place; its direction would be undefined"]

    def geometry(self, numbering: Any) -> Any:
        """The resolved coordinate. Raises ModelError if the joint has no such one, or several to choose from."""
        if self.joint is None:
            return Distance(numbering.place(self.a), numbering.place(self.b))
        there = numbering.coordinates(self.joint)
        if self.coordinate is None and len(there) == 1:
            return next(iter(there.values()))
        if self.coordinate in there:
            return there[self.coordinate]
        got = "none was chosen" if self.coordinate is None else f"there is no '{self.coordinate}'"
        allowed = ", ".join(repr(name) for name in there if name) or "only one, leave coordinate out"
        raise ModelError(f"PTO '{self.name}': {got} of the coordinates of joint '{self.joint}': {allowed}")


@kernel
def matrices(q, R):  # type: ignore[no-untyped-def]
    """Rotation matrices of unit quaternions."""
    for k in range(q.shape[0]):
        set_matrix(R, k, (q[k, 0], q[k, 1], q[k, 2], q[k, 3]))


@dataclass
class Memory:
    """What PTOs remember of accepted steps: coordinates (turns go on from there), energy [J], memory of each group."""

    s: Array
    energy: Array
    laws: list[Any]


class PTOBatch:
    """All PTOs of a system; their laws in groups of a kind."""

    runs: ClassVar[list[tuple[int, int]]] = []
    remembers: ClassVar[bool] = True

    def __init__(self, parts: Sequence[PTO], first_point: Sequence[int], first_rotation: Sequence[int],
                 sea: Any, gravity: float) -> None:  # fmt: skip
        self.parts = tuple(parts)
        n = len(self.parts)
        kinds: dict[tuple[Any, Any], list[tuple[Any, int]]] = {}
        for e, part in enumerate(self.parts):
            for law in part.laws:
                kernel = law.kernel() if hasattr(law, "kernel") else None
                kinds.setdefault((law.group(), kernel), []).append((law, e))
        self.groups = []
        for (group, _), items in kinds.items():
            laws, which = zip(*items, strict=True)
            labels = [self.parts[e].name for e in which]
            self.groups.append(group(laws, np.array(which, dtype=np.int64), labels))
        self._checked = [group for group in self.groups if hasattr(group, "error")]
        self.now = Now(n)
        self.F, self._F0 = np.zeros((3, n)), np.zeros((3, n))
        self._power0 = np.zeros(n)
        self._memory: Memory | None = None

    def connect(self, numbering: Any) -> None:
        """Find the coordinates, and where their displacements are zero."""
        self.table = Coordinates([part.geometry(numbering) for part in self.parts])
        drawn = self.table.at(numbering.x0, numbering.R0)
        self.zero = np.array([
            part.zero if part.zero is not None else drawn[e] if part.joint is None else 0.0
            for e, part in enumerate(self.parts)
        ])  # fmt: skip
        self._R = np.zeros_like(numbering.R0)

    def dofs(self, n_point: int) -> list[Index]:
        return [self.table.dofs(n_point)]

    def bind(self, slots: list[Index]) -> None:
        (self._slots,) = slots

    # -- evaluation ---------------------------------------------------------------------------

    def _forces(self, F: Array) -> str | None:
        """Forces of all laws at what stands in `now`, into F; what is wrong with them."""
        F.fill(0.0)
        trouble = None
        for k, group in enumerate(self.groups):
            self.now.memory = self._memory.laws[k] if self._memory is not None else None
            trouble = group.add(self.now, F) or trouble
        return trouble

    def begin(self, w: Any, history: Memory, t: float, state: Any) -> None:
        """Displacements, rates, accelerations and power at the step's start."""
        now, table = self.now, self.table
        self._memory, now.t, now.h, now.still = history, state.t, 0.0, w.still
        table.last[:] = history.s
        matrices(state.q, self._R)
        table.move(state.x, self._R, state.v)
        np.subtract(table.s, self.zero, out=now.s)
        now.v[:] = table.rate
        now.s0[:], now.v0[:] = now.s, now.v
        if self._checked:
            table.move(state.x, self._R, state.a)
            now.a0[:] = table.rate
        self._forces(self._F0)
        np.multiply(self._F0[0], -now.v, out=self._power0)
        now.t, now.h = t, t - state.t

    def add(self, w: Any) -> None:
        now, table = self.now, self.table
        table.move(w.x, w.R, w.v)
        np.subtract(table.s, self.zero, out=now.s)
        now.v[:] = table.rate
        w.trouble = self._forces(self.F) or w.trouble
        push(w.x, w.R, w.v, w.c, table.kind, table.where, table.G, self.F, self._slots, w.A, w.r, w.s)

    def error(self, history: Memory, w: Any) -> float:
        """Local error of the step just made over what is allowed: of contacts that it does not resolve."""
        if not self._checked:
            return 0.0
        self.table.move(w.x, w.R, w.a)
        self.now.a[:] = self.table.rate
        return max(group.error(self.now) for group in self._checked)

    def _energy(self) -> Array:
        """Energy absorbed until now [J]."""
        before = self._memory.energy if self._memory is not None else 0.0
        return np.asarray(before + 0.5 * self.now.h * (self._power0 - self.F[0] * self.now.v))

    # -- memory -------------------------------------------------------------------------------

    def start(self, state: Any) -> Memory:
        """Fresh memory of a state at rest."""
        s = self.table.of_state(state)
        return self._fresh(state, s)

    def _fresh(self, state: Any, s: Array) -> Memory:
        laws = [group.start(state.t, s - self.zero) if hasattr(group, "start") else None for group in self.groups]
        return Memory(s, np.zeros(len(s)), laws)

    def keep(self, state: Any, before: Memory, after: Memory) -> None:
        """Turns already made still count."""
        new = self._fresh(state, self.table.of_state(state, before.s))
        after.s, after.laws = new.s, new.laws

    def commit(self, history: Memory, w: Any) -> None:
        history.s[:] = self.table.s
        history.energy[:] = self._energy()
        for k, group in enumerate(self.groups):
            if hasattr(group, "commit"):
                self.now.memory = history.laws[k]
                w.event = group.commit(self.now) or w.event
        self.now.h = 0.0  # what is measured from here on is of the committed state

    # -- outputs ------------------------------------------------------------------------------

    def outputs(self) -> list[Output]:
        """Displacement, velocity, force, power and energy of every PTO, then what laws tell."""
        out = []
        for part, turns in zip(self.parts, self.table.turning, strict=True):
            unit, force = ("rad", "N m") if turns else ("m", "N")
            of = f"of PTO {part.name}"
            out += [
                Output(f"{part.name}_displacement", f"displacement {of}", unit),
                Output(f"{part.name}_velocity", f"velocity {of}", f"{unit}/s"),
                Output(f"{part.name}_force", f"{'moment' if turns else 'force'} {of}, driving displacement up", force),
                Output(f"{part.name}_power", f"power absorbed by PTO {part.name}", "W"),
                Output(f"{part.name}_energy", f"energy absorbed by PTO {part.name}", "J"),
            ]
        for group in self.groups:
            if hasattr(group, "signals"):
                for j, suffix, text, unit in group.signals():
                    name = self.parts[group.which[j]].name
                    out.append(Output(f"{name}_{suffix}", f"{text} of PTO {name}", unit))
        return out

    def measure(self, w: Any, out: Array) -> None:
        """Of the state last evaluated."""
        now, n = self.now, 5 * len(self.parts)
        out[0:n:5], out[1:n:5], out[2:n:5] = now.s, now.v, self.F[0]
        out[3:n:5] = -self.F[0] * now.v
        out[4:n:5] = self._energy()
        for k, group in enumerate(self.groups):
            if hasattr(group, "signals"):
                now.memory = self._memory.laws[k] if self._memory is not None else None
                values = group.tell(now)
                out[n : n + len(values)] = values
                n += len(values)

    def ledger(self, w: Any, book: Any) -> None:
        """Of the state last evaluated. Springs are stores where laws know their potential, dry friction is friction;
        all other laws, and what they hold in states of their own, are accounted for at the port."""
        for part, s, v, F in zip(self.parts, self.now.s, self.now.v, self.F[0], strict=True):
            for law in part.laws:
                if hasattr(law, "potential"):
                    U, spring = law.potential(float(s))
                    book.store("spring", U, -spring * v)
                    F -= spring
                if hasattr(law, "dry"):
                    rubbing = law.dry(float(v))
                    book.work("friction", rubbing * v)
                    F -= rubbing
            book.work("pto", F * v)
