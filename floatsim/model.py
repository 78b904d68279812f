"""`Model`: the frozen description a user builds, and the checks across its parts.

A part refuses bad values where it is built; the model reports all cross-part problems at once: names
that do not resolve, duplicates, lines that cannot span their ends, ends whose start nobody knows.
"""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator

from floatsim.description import Description, Name, NonNegative, _tuple
from floatsim.errors import ModelError, nearest
from floatsim.frames import Array
from floatsim.sea.site import Sea

Parts = Annotated[tuple[Any, ...], BeforeValidator(_tuple)]


class Expected(Description):
    """What a model's source publishes, for comparison: `decay` prints it beside the measured value.

    periods_s: degree of freedom -> natural period [s]. source: where the numbers come from.
    """

    periods_s: dict[str, NonNegative] = {}
    source: str = ""


class Model(Description):
    """A floating system: parts (bodies, lines, masses, springs) and joints that tie their names.

    gravity [m/s2] acts on every mass. Connection points are named `part` or `part.point`
    (`mooring_1.end_a`, `platform.fairlead_1`), fixed points are coordinates (x, y, z) [m].
    Raises ModelError with every cross-part problem.
    """

    name: Name = "model"
    parts: Parts
    joints: Parts = ()
    sea: Sea
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

        def where(target: Any) -> Array | None:
            if not isinstance(target, str):
                return np.asarray(target, dtype=float)
            part, anchor = targets[target]
            if part.name not in placed:
                return None
            point, rotation, arm = part.anchors()[anchor]
            x, R = placed[part.name]
            return x[point] + (R[rotation] @ np.asarray(arm) if rotation >= 0 else 0.0)

        while True:
            before = len(placed)
            for part in self.parts:
                if part.name not in placed:
                    result = part.place(self._ends(part, where))
                    if result is not None:
                        placed[part.name] = result
            if len(placed) == before:
                return placed

    def _ends(self, part: Any, where: Any) -> dict[str, Array]:
        ends: dict[str, Array] = {}
        for joint in self.joints:
            for a, b in joint.ties():
                for mine, other in ((a, b), (b, a)):
                    if isinstance(mine, str) and mine.partition(".")[0] == part.name:
                        point = where(other)
                        if point is not None:
                            ends[mine.partition(".")[2]] = point
        return ends

    def _problems(self) -> Any:
        good = True
        for kind, items in (("parts", self.parts), ("joints", self.joints)):
            for item in items:
                if not hasattr(item, "children"):
                    good = False
                    yield f"{kind}: got {item!r}; this is not one of floatsim's {kind}"
        if not good:
            return
        names = [part.name for part in self.parts] + [joint.label for joint in self.joints]
        for name in sorted({n for n in names if names.count(n) > 1}):
            yield f"the name '{name}' is used {names.count(name)} times; names must differ"
        if not self.parts:
            yield "there are no parts"
        targets = self.targets()
        wanted = [(f"joint '{j.label}'", t) for j in self.joints for t in j.targets()]
        wanted += [(f"{type(p).__name__} '{p.name}'", t) for p in self.parts
                   for t in (getattr(p, "a", None), getattr(p, "b", None)) if t is not None]  # fmt: skip
        unknown = [(who, t) for who, t in wanted if isinstance(t, str) and t not in targets]
        for who, t in unknown:
            yield f"{who}: there is no connection point '{t}'{nearest(t, targets)}"
        if unknown:
            return
        placed = self.placement()
        for part in self.parts:
            if part.name not in placed:
                yield (
                    f"{type(part).__name__} '{part.name}': where it starts is unknown; tie both ends with joints to "
                    "something that has a position, or give end_a_position and end_b_position"
                )
                continue
            ends = {}
            x, _ = placed[part.name]
            for anchor, (point, rotation, _) in part.anchors().items():
                if rotation < 0:
                    ends[anchor] = x[point]
            yield from part.problems(ends, self.sea.depth)
