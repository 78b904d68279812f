"""Locks: a coordinate of a joint that is held and released during a run (latching).

A lock is one row of `inline` or `align` that is switched: off, its multiplier is zero; on, it holds the coordinate at
the value it had when the lock engaged. Engaging is a plastic impact: velocities change by the least, in the mass norm,
that makes them fulfil the row,

    M dv + G^T p = 0,     G (v + dv) = 0,     lost energy = 1/2 dv^T M dv

(Carnot; e.g. Brogliato, Nonsmooth Mechanics, chapter 4), accelerations and multipliers start afresh from there, and so
they do at a release. Both happen at the beginning of a step, and a run divides its steps where one is foreseen.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import field_validator, model_validator

from floatsim.description import Name, Positive, Series
from floatsim.errors import ModelError, nearest
from floatsim.frames import Array, set_matrix
from floatsim.joints.axis import triple, turned
from floatsim.joints.constraints import Align, Constraints, Inline, JointRows, Kind, Row
from floatsim.joints.coordinates import Slide, Turn
from floatsim.parts.part import Output, Part

_SOON = 0.05  # of the last step


class Lock(Part):
    """Holds a coordinate of `joint` while engaged. It is a part: it stands in the model's list of parts.

    joint: name of a Hinge, Slider, Universal, Cylindrical or PointOnLine; coordinate: which of its coordinates, if it
    has more than one (`first`, `second`; `slide`, `turn`). engaged: whether it is to begin with, at the value the
    coordinate has there; statics respect that. Then one of

    engage, release   times [s] at which it engages and releases
    controller        function (t, s, ds) -> bool of time [s], coordinate [m or rad] and its rate: whether it should be
                      engaged
    latch_for         latching: engages whenever the coordinate's rate changes its sign, for so long [s]

    All are looked at at the beginning of every step. Runs divide a step at times given and where the rate changes its
    sign; `step` by hand does not, and a controller is not foreseen: times that are no multiples of the step are then
    met up to one step late. Outputs: `NAME_engaged` (0 or 1), `NAME_energy_lost` [J] by engaging
    so far, and the force or moment by which side a of the joint acts on side b through the lock.
    """

    name: Name
    joint: str
    coordinate: str = ""
    engaged: bool = False
    engage: Series = ()
    release: Series = ()
    controller: Any = None
    latch_for: Positive | None = None

    @field_validator("controller")
    @classmethod
    def _callable(cls, value: Any) -> Any:
        if value is not None and not callable(value):
            raise ValueError(f"got {value!r}; must be a function (t, s, ds) -> True or False")
        return value

    @model_validator(mode="after")
    def _one_rule(self) -> Lock:
        rules = [bool(self.engage or self.release), self.controller is not None, self.latch_for is not None]
        if sum(rules) > 1:
            raise ValueError("engage and release times, controller and latch_for exclude each other; give one of them")
        both = sorted(set(self.engage) & set(self.release))
        if both:
            raise ValueError(f"it cannot engage and release at the same time, t = {both[0]:g} s")
        return self

    @staticmethod
    def batch() -> type[LockBatch]:
        return LockBatch

    def held_wrongly(self, joints: Any) -> list[str]:
        """A joint that does not exist."""
        known = [joint.label for joint in joints if hasattr(joint, "coordinates")]
        if self.joint in known:
            return []
        return [f"Lock '{self.name}': there is no joint '{self.joint}' with a coordinate{nearest(self.joint, known)}"]


@dataclass
class Latch:
    """Memory of a lock: whether it is engaged, the value held [m or rad], when it engaged [s], the coordinate's rate a
    step before (0 if unknown), the time it was last looked at [s], energy lost [J], whether the impact is to come."""

    engaged: bool
    held: float
    since: float
    rate: float = 0.0
    looked: float = -math.inf
    lost: float = 0.0
    striking: bool = False


class LockBatch:
    """All locks of a system."""

    runs: ClassVar[list[tuple[int, int]]] = []
    remembers: ClassVar[bool] = False

    def __init__(self, parts: Sequence[Lock], first_point: Sequence[int], first_rotation: Sequence[int],
                 sea: Any, gravity: float) -> None:  # fmt: skip
        self.parts = tuple(parts)
        self._coordinates: list[Slide | Turn] = []
        self._round: list[bool] = []  # whether the coordinate is that of side b against side a of the joint
        self._held = np.full(len(self.parts), np.nan)  # what the rows hold
        self._now = np.zeros((len(self.parts), 2))

    def dofs(self, n_point: int) -> list[NDArray[np.int64]]:
        return []

    def bind(self, slots: list[NDArray[np.int64]]) -> None:
        """Its rows belong to the constraints."""

    def add(self, w: Any) -> None:
        """Its rows belong to the constraints."""

    def ledger(self, w: Any, book: Any) -> None:
        """What a lock takes when it engages is a jump of the stores; while engaged it does no work."""

    def rows(self, coordinates: Callable[[str], dict[str, Any]]) -> dict[str, list[Row]]:
        """One row for every lock; coordinates(joint): what it may hold.

        Raises ModelError for a coordinate that does not exist.
        """
        for part in self.parts:
            known = coordinates(part.joint)
            if part.coordinate not in known:
                names = ", ".join(repr(name) for name in known) if "" not in known else "only one, without a name"
                raise ModelError(
                    f"Lock '{part.name}': joint '{part.joint}' has no coordinate '{part.coordinate}'; it has {names}"
                )
            mine = known[part.coordinate]
            self._coordinates.append(mine)
            self._round.append(mine.a != next(iter(known.values())).a)
        return {part.name: [self._row(k)] for k, part in enumerate(self.parts)}

    def _row(self, k: int, held: float = 0.0) -> Row:
        """The row that holds the coordinate of lock k at a value."""
        c = self._coordinates[k]
        if isinstance(c, Slide):
            return Inline(c.a, c.b, c.axis, held)
        # g = n_A . (e x n_B turned by s) = sin(angle - s): its multiplier is the moment about the axis
        e = np.asarray(c.axis)
        across = triple(np.cross(e, turned(np.asarray(c.normal_b), e, held)))
        if self._round[k]:
            return Align(c.b.rotation, across, c.a.rotation, c.normal_a)
        return Align(c.a.rotation, c.normal_a, c.b.rotation, across)

    def hold(self, constraints: Constraints, joint_rows: dict[str, JointRows]) -> None:
        """Where the rows are: for every lock its kind, its place there and its multiplier."""
        self._at: list[tuple[Kind, int, int]] = []
        for part in self.parts:
            mine = joint_rows[part.name]
            kind: Kind = constraints.inline if mine.planes else constraints.align
            e = (mine.planes or mine.axes)[0]
            self._at.append((kind, e, kind.first + e))

    def start(self, state: Any) -> list[Latch]:
        """As they are to begin with, held where they are."""
        return [Latch(part.engaged, value(c, state)[0], state.t)
                for part, c in zip(self.parts, self._coordinates, strict=True)]  # fmt: skip

    def keep(self, state: Any, before: list[Latch], after: list[Latch]) -> None:
        """A new equilibrium is one with the locks as they were."""
        for old, new in zip(before, after, strict=True):
            new.engaged, new.held, new.since = old.engaged, old.held, old.since

    def begin(self, w: Any, history: list[Latch], t: float, state: Any) -> None:
        """Switch the rows."""
        for k, latch in enumerate(history):
            self._set(k, latch, latch.engaged)
            self._now[k] = latch.engaged, latch.lost

    def engage_all(self, history: list[Latch]) -> None:
        """Switch on all rows, for the check of their rank."""
        for k, latch in enumerate(history):
            self._set(k, latch, True)

    def _set(self, k: int, latch: Latch, on: bool) -> None:
        kind, e, _ = self._at[k]
        kind.on[e] = on
        if self._held[k] != latch.held:
            self._held[k], kind.numbers[e] = latch.held, kind.numbers_of(self._row(k, latch.held))

    def switch(self, state: Any, history: list[Latch]) -> bool:
        """Let locks engage or release before a step from `state`; whether one did."""
        changed = False
        due = [each for each in zip(self.parts, self._coordinates, history, strict=True)
               if each[2].looked != state.t]  # or a step is tried again  # fmt: skip
        wants = [_wanted(part, latch, c, state) for part, c, latch in due]  # before any changes: a controller may fail
        for (_, c, latch), want in zip(due, wants, strict=True):
            latch.looked = state.t
            if want != latch.engaged:
                latch.engaged, latch.held, latch.since, latch.rate = want, value(c, state)[0], state.t, 0.0
                latch.striking = want
                changed = True
        return changed

    def next_event(self, state: Any, history: list[Latch]) -> float:
        """The next time [s] at which a lock is foreseen to engage or release; inf if none. Latching engages where the
        rate, a straight line through this step's beginning and the last one's, is zero: off by O(h^2)."""
        found = [_foreseen(part, latch, c, state)
                 for part, c, latch in zip(self.parts, self._coordinates, history, strict=True)]  # fmt: skip
        return min(found, default=math.inf)

    def struck(self, history: list[Latch], lost: Array) -> None:
        """Energy lost by row [J] when velocities were made consistent."""
        for latch, (_, _, row) in zip(history, self._at, strict=True):
            if latch.striking:
                latch.lost += float(lost[row])
                latch.striking = False

    def outputs(self) -> list[Output]:
        return [
            item for part in self.parts for item in (
                Output(f"{part.name}_engaged", f"whether {part.name} is engaged", "1"),
                Output(f"{part.name}_energy_lost", f"energy lost so far when {part.name} engaged", "J"),
            )
        ]  # fmt: skip

    def measure(self, w: Any, out: Array) -> None:
        """As during the last step."""
        out[:] = self._now.ravel()


def _wanted(part: Lock, latch: Latch, coordinate: Slide | Turn, state: Any) -> bool:
    """Whether the lock should be engaged now."""
    t = state.t
    now = t + 1e-9 * max(1.0, abs(t))  # times on the grid of steps, up to rounding
    if part.controller is not None:
        try:
            want = part.controller(t, *value(coordinate, state))
        except Exception as error:  # the user's own code
            raise ModelError(f"Lock '{part.name}': controller fails: {type(error).__name__}: {error}") from None
        if not isinstance(want, bool | np.bool_):
            raise ModelError(f"Lock '{part.name}': controller({t:g}, ...) is {want!r}; must be True or False")
        return bool(want)
    if part.latch_for is not None:
        if latch.engaged:
            return now < latch.since + part.latch_for
        # where the sign has changed, or is about to: a step that was divided there ends a little before or after.
        # Rounding errors of a rest are no rate
        before, latch.rate = latch.rate, value(coordinate, state)[1]
        ahead = latch.rate + _SOON * (latch.rate - before)
        return before * ahead < 0.0 and abs(before) > 1e-6 * abs(ahead)
    events = [(time, True) for time in part.engage] + [(time, False) for time in part.release]
    past = [event for event in events if event[0] <= now]
    return max(past)[1] if past else latch.engaged


def _foreseen(part: Lock, latch: Latch, coordinate: Slide | Turn, state: Any) -> float:
    """When the lock will engage or release next, after the state's time; inf if that is not known."""
    t = state.t
    if part.latch_for is None:
        return min((time for time in (*part.engage, *part.release) if time > t), default=math.inf)
    if latch.engaged:
        release = latch.since + part.latch_for
        return release if release > t else math.inf
    rate = value(coordinate, state)[1]
    if not (latch.looked < t and latch.rate * rate > 0.0 and abs(rate) < abs(latch.rate)):
        return math.inf
    return float(t + (t - latch.looked) * rate / (latch.rate - rate))


def value(coordinate: Slide | Turn, state: Any) -> tuple[float, float]:
    """(s, ds/dt) of a coordinate in a state; angles within -pi..pi."""
    c, n = coordinate, len(state.x)
    R = np.zeros((2, 3, 3))
    for k, place in enumerate((c.a, c.b)):
        set_matrix(R, k, tuple(state.q[place.rotation]))
    w = [state.v[3 * (n + place.rotation) :][:3] for place in (c.a, c.b)]
    e = R[1] @ c.axis
    if isinstance(c, Turn):
        n_a, n_b = R[0] @ c.normal_a, R[1] @ c.normal_b
        return math.atan2(float(np.cross(n_b, n_a) @ e), float(n_a @ n_b)), float(e @ (w[0] - w[1]))
    arm_a, arm_b = R[0] @ c.a.arm, R[1] @ c.b.arm
    d = state.x[c.a.point] + arm_a - state.x[c.b.point] - arm_b
    u, v = (state.v[3 * place.point :][:3] for place in (c.a, c.b))
    rate = u + np.cross(w[0], arm_a) - v - np.cross(w[1], arm_b)
    return float(e @ d), float(e @ rate + np.cross(w[1], e) @ d)
