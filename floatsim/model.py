"""`Model`: the frozen description a user builds, and the checks across its parts.

A part refuses bad values where it is built; the model reports all cross-part problems at once: names
that do not resolve, duplicates, lines that cannot span their ends, ends whose start nobody knows.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np
from pydantic import field_validator

from floatsim.description import Description, Items, Name, NonNegative, Positive
from floatsim.errors import ModelError, nearest
from floatsim.frames import Array
from floatsim.sea.site import Sea

DOFS = ("surge", "sway", "heave", "roll", "pitch", "yaw")


class Expected(Description):
    """What a model's source publishes, for comparison: `decay` prints it beside the measured value.

    periods_s: degree of freedom -> natural period [s]. source: where the numbers come from.
    """

    periods_s: dict[str, Positive] = {}
    source: str = ""

    @field_validator("periods_s")
    @classmethod
    def _of_degrees_of_freedom(cls, value: dict[str, float]) -> dict[str, float]:
        for name in value:
            if name not in DOFS:
                raise ValueError(f"there is no degree of freedom '{name}'{nearest(name, DOFS)}")
        return value


class Model(Description):
    """A floating system: parts (bodies, lines, masses, springs) and joints that tie their names.

    gravity [m/s2] acts on every mass. wind: None or floatsim.Wind(...), for rotors. Connection points are named `part`
    or `part.point` (`mooring_1.end_a`, `platform.fairlead_1`), fixed points are coordinates (x, y, z) [m].
    Raises ModelError with every cross-part problem.
    """

    name: Name = "model"
    parts: Items
    joints: Items = ()
    sea: Sea
    wind: Any = None
    gravity: NonNegative = 9.81
    expected: Expected = Expected()

    def model_post_init(self, context: Any) -> None:
        problems = list(self._problems())
        if problems:
            raise ModelError([f"Model '{self.name}': {line}" for line in problems])

    def everything(self) -> list[Any]:
        """Parts with the parts that come with them and with joints."""
        own = [child for item in (*self.parts, *self.joints) for child in item.children()]
        return [*self.parts, *own]

    def targets(self) -> dict[str, tuple[Any, str]]:
        """Every connection point's name -> (part, anchor)."""
        return {
            f"{part.name}.{anchor}" if anchor else part.name: (part, anchor)
            for part in self.parts
            for anchor in part.anchors()
        }

    def placement(self) -> dict[str, tuple[Array, Array]]:
        """Part name -> its points (n, 3) and rotation matrices (m, 3, 3) at the drawing position.

        Parts that know where they are come first, then those that learn it from what they are tied to.
        """
        placed: dict[str, tuple[Array, Array]] = {}
        targets = self.targets()
        ties: dict[str, list[tuple[str, Any]]] = {}  # part -> (its connection point, what that is tied to)
        for joint in self.joints:
            for a, b in joint.ties():
                for mine, other in ((a, b), (b, a)):
                    if isinstance(mine, str):
                        part, _, point = mine.partition(".")
                        ties.setdefault(part, []).append((point, other))

        def where(target: Any) -> Array | None:
            return self._where(target, targets, placed)

        while True:
            before = len(placed)
            for item in self.parts:
                if item.name not in placed:
                    found = ((point, where(other)) for point, other in ties.get(item.name, ()))
                    result = item.place({point: x for point, x in found if x is not None}, self.sea)
                    if result is not None:
                        placed[item.name] = result
            if len(placed) == before:
                return placed

    @staticmethod
    def _where(
        target: Any, targets: dict[str, tuple[Any, str]], placed: dict[str, tuple[Array, Array]]
    ) -> Array | None:
        """Drawing position (3,) of a connection point's name or of fixed coordinates; None while it is unknown."""
        if not isinstance(target, str):
            return np.asarray(target, dtype=float)
        part, anchor = targets[target]
        if part.name not in placed:
            return None
        point, rotation, arm = part.anchors()[anchor]
        x, R = placed[part.name]
        return np.asarray(x[point] + (R[rotation] @ np.asarray(arm) if rotation >= 0 else 0.0))

    def loose(self) -> list[str]:
        """Parts with mass that are tied, directly or through others, to nothing that is fixed or floats: bodies and
        masses do not touch the seabed, so they have no equilibrium unless a line on the bed carries them."""
        ties = [pair for joint in self.joints for pair in joint.ties() or [joint.targets()]]  # a rod's ends are apart
        ties += [part.between for part in self.parts if part.between]
        names = [{end.partition(".")[0] if isinstance(end, str) else "" for end in pair} for pair in ties]
        held = {""} | {part.name for part in self.parts if getattr(part, "hydro", None) is not None}
        rho = self.sea.density
        held |= {part.name for part in self.parts if hasattr(part, "held_by_water") and part.held_by_water(rho)}
        while True:
            more = {name for pair in names if pair & held for name in pair} - held
            if not more:
                break
            held |= more
        return [part.name for part in self.parts if hasattr(part, "mass") and part.name not in held]

    def _problems(self) -> Iterator[str]:
        strangers = [*self._strangers("parts", "anchors", self.parts), *self._strangers("joints", "ties", self.joints)]
        if strangers:
            yield from strangers
            return
        if not self.parts:
            yield "there are no parts"
        names = [part.name for part in self.parts] + [joint.label for joint in self.joints]
        for name, times in sorted(Counter(names).items()):
            if times > 1:
                yield f"the name '{name}' is used {times} times; names must differ"
        waves = self.sea.waves
        if isinstance(waves, type):
            yield f"Sea: waves: got the class {waves.__name__} itself; give an object, {waves.__name__}(...)"
        elif waves is not None and not hasattr(waves, "realise"):
            yield (
                f"Sea: waves: got {waves!r}; RegularWave, IrregularWaves(spectrum=..., seed=...), WaveComponents, "
                "FocusedWave, ElevationSeries, or CombinedWaves(waves=[...]) of several is allowed"
            )
        yield from self._windless()
        targets = self.targets()
        ends = [(f"joint '{joint.label}'", joint.targets()) for joint in self.joints]
        ends += [(_label(part), part.between) for part in self.parts if part.between]
        unknown = [(who, t) for who, pair in ends for t in pair if isinstance(t, str) and t not in targets]
        for who, t in unknown:
            yield f"{who}: there is no connection point '{t}'{nearest(t, targets)}"
        if unknown:
            return
        for part in self.parts:
            yield from part.held_wrongly(self.joints)
        to_itself = [*self._to_itself(ends, targets)]
        yield from to_itself or self._misplaced(targets)

    def _windless(self) -> Iterator[str]:
        """A wind that is none, that nothing takes, or that is missing."""
        taking = [_label(part) for part in self.everything() if getattr(part, "needs_wind", False)]
        if self.wind is not None and (isinstance(self.wind, type) or not hasattr(self.wind, "direction")):
            yield f"wind: got {self.wind!r:.60}; Wind(speed=...) or None is allowed"
        elif self.wind is not None and not taking:
            yield "wind: nothing in the model takes it; add a Rotor"
        elif self.wind is None and taking:
            yield f"{taking[0]}: the model has no wind; give Model(wind=Wind(speed=...))"

    def _to_itself(self, ends: list[tuple[str, Any]], targets: dict[str, tuple[Any, str]]) -> Iterator[str]:
        for who, pair in ends:
            parts = {targets[t][0].name if isinstance(t, str) else "" for t in pair}
            if len(pair) == 2 and len(parts) == 1:
                own = f"of '{parts.pop()}'" if "" not in parts else "fixed"
                yield f"{who}: both ends are {own} ({pair[0]} and {pair[1]}); tie two things that can move apart"

    def _strangers(self, field: str, needed: str, items: tuple[Any, ...]) -> Iterator[str]:
        for item in items:
            if isinstance(item, type):
                yield f"{field}: got the class {item.__name__} itself; give an object, {item.__name__}(...)"
            elif not hasattr(item, needed):
                own = {"parts": ("a joint, put it into joints=[...]", "ties"), "joints": ("a part", "anchors")}[field]
                what = own[0] if hasattr(item, own[1]) else f"not one of floatsim's {field}"
                yield f"{field}: got {_label(item)}; this is {what}"

    def _misplaced(self, targets: dict[str, tuple[Any, str]]) -> Iterator[str]:
        """What is wrong with where things start."""
        placed = self.placement()
        for part in self.parts:
            if part.name not in placed:
                yield (
                    f"{_label(part)}: where it starts is unknown; tie both ends with joints to "
                    "something that has a position, or give end_a_position and end_b_position"
                )
                continue
            x, _ = placed[part.name]
            ends = {anchor: x[point] for anchor, (point, rotation, _) in part.anchors().items() if rotation < 0}
            if part.between:
                ends = {end: self._where(at, targets, placed) for end, at in zip("ab", part.between, strict=False)}
            yield from part.problems(ends, self.sea)


def _label(item: Any) -> str:
    name = getattr(item, "name", None) or getattr(item, "label", None)
    return f"{type(item).__name__} '{name}'" if name else repr(item)
