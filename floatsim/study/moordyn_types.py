"""Line types of a MoorDyn file as sections of lines.

    Diam, Mass/m, EI, Cd, Ca, CdAx, CaAx are the same quantities: Cd on d l, CdAx on pi d l, added mass on the displaced
    mass. T = EA (l/l0 - 1): engineering strain. BA < 0 is a share of l0 sqrt(EA m) per element; where EA is a table, of
    the secant to its last point.

    EA_s|EA_d: a spring EA_d with a damper BA_d in series with a spring k and a damper BA_s, where
    k = EA_d EA_s/(EA_d - EA_s), so that both together have EA_s when slow. The inner point relaxes with
    (BA_s + BA_d)/(EA_d + k): the law of laws/static_dynamic.py with A = EA_d and

        tau = (BA_s + BA_d) (EA_d - EA_s)/EA_d^2,

    exactly so for a light BA_d, which here acts beside the whole. EA_s|A|B adds B times the mean tension to A.

Sources: MoorDyn documentation, "Input Files"; Hall, Duong & Lozon (2023), IOWTC2023-119524, for the two stiffnesses.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from typing import Any

from floatsim.errors import nearest
from floatsim.laws.engineering import Engineering
from floatsim.laws.moment_table import MomentTable
from floatsim.laws.static_dynamic import StaticDynamic
from floatsim.laws.tension_table import TensionTable
from floatsim.parts.section import Section
from floatsim.study.moordyn_deck import Deck, Row, number

ROPE_STRAIN = 0.1  # the static line of a two-stiffness rope is drawn up to this strain; its slope goes on


def plain_name(text: str, prefix: str) -> str:
    """A name as floatsim allows it."""
    plain = re.sub(r"[^a-z0-9]+", "_", text.lower()).strip("_")
    return plain if plain[:1].isalpha() else f"{prefix}_{plain}".strip("_")


@dataclass
class LineTypes:
    """The line types of a file. notes: what was converted; bending: the types with bending stiffness."""

    deck: Deck
    notes: list[str]
    rows: dict[str, Row] = field(default_factory=dict)
    bending: set[str] = field(default_factory=set)
    sections: dict[tuple[Any, ...], Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for row in self.deck.rows("line_types"):
            if row.values["name"].lower() in self.rows:
                self.deck.refuse(row.line, f"line type '{row.values['name']}' is given twice; names must differ")
            self.rows[row.values["name"].lower()] = row
            if self.deck.number(row, "Cl") != 0.0:
                self.deck.leave_out(
                    row.line,
                    f"line type '{row.values['name']}': Cl = {row.values['Cl']}: vortex-induced vibration was left "
                    "out",
                )

    def section(self, line: int, name: str, element: float) -> Any:
        """Section of the line type of that name for elements of this length; None and a problem if there is none."""
        row = self.rows.get(name.lower())
        if row is None:
            names = [other.values["name"] for other in self.rows.values()]
            self.deck.refuse(line, f"there is no line type '{name}'{nearest(name, names)}")
            return None
        return self._section(row, element)

    def _section(self, row: Row, element: float) -> Any:
        """Section of a line type for elements of this length; None and a problem if it is not understood."""
        deck, text = self.deck, row.values["name"]
        d, m = deck.number(row, "d"), deck.number(row, "m")
        before = len(deck.problems)
        EA, law, slow = self._axial(row, element, m)
        EI, bending = self._bending_law(row)
        damping = self._damping(row, element, EA, m, law is None or isinstance(law, Engineering))
        if len(deck.problems) > before:
            return None
        tag = (text.lower(), slow, *damping.values())
        if tag in self.sections:
            return self.sections[tag]
        name = plain_name(text, "type")
        taken = [section.name for section in self.sections.values() if section is not None]
        if name in taken:
            name = f"{name}_{len(taken) + 1}"
        if EI > 0.0 or bending is not None:
            self.bending.add(text.lower())
        self.sections[tag] = self.deck.made(
            row.line, Section, name=name, mass_per_length=m, diameter=d, EA=EA, EI=EI, axial_law=law,
            bending_law=bending, drag_normal=deck.number(row, "Cd"), drag_tangential=deck.number(row, "CdAx"),
            added_mass_normal=deck.number(row, "Ca"), added_mass_tangential=deck.number(row, "CaAx"), **damping,
        )  # fmt: skip
        return self.sections[tag]

    def _axial(self, row: Row, element: float, m: float) -> tuple[float, Any, float]:
        """(EA, law, relaxation time or 0) of the column EA."""
        text, deck = row.values["EA"], self.deck
        if text.upper().startswith("SYROPE:"):
            deck.refuse(
                row.line,
                f"EA: got '{text}'; working curves of a SYROPE file are not read: give a number, a table file or "
                "EA_s|EA_d, and a StaticDynamic law with permanent_share by hand",
            )
            return 1.0, None, 0.0
        if "|" in text:
            return self._two_stiffnesses(row, element, m)
        EA = number(text)
        if EA is not None:
            return EA, Engineering(), 0.0
        x, y = self._table(row, "EA", text)
        law = None if len(x) < 2 else self.deck.made(row.line, TensionTable, strain=x, tension=y)
        if law is None or x[-1] <= 0.0 or y[-1] <= 0.0:
            if law is not None:
                deck.refuse(
                    row.line,
                    f"EA: the table '{text}' ends at strain {x[-1]:g}, tension {y[-1]:g} N; positive values are "
                    "allowed",
                )
            return 1.0, None, 0.0
        self._once(
            f"line type '{row.values['name']}': EA from the table '{text}', {len(x)} points, straight between them"
        )
        return y[-1] / x[-1], law, 0.0  # the secant, which a damping ratio refers to in MoorDyn

    def _two_stiffnesses(self, row: Row, element: float, m: float) -> tuple[float, Any, float]:
        EA, BA = self.deck.bar(row, "EA", (2, 3)), self.deck.bar(row, "BA", (1, 2))
        if EA is None or BA is None:
            return 1.0, None, 0.0
        slow = BA[0] if BA[0] >= 0.0 else -BA[0] * element * math.sqrt(max(EA[0] * m, 0.0))
        if not 0.0 < EA[0] < EA[1] or min(EA) < 0.0 or slow <= 0.0:
            self.deck.refuse(
                row.line,
                f"EA: got '{row.values['EA']}' with BA '{row.values['BA']}'; EA_s|EA_d with 0 < EA_s < EA_d and a "
                "static damping that is not 0 is allowed",
            )
            return 1.0, None, 0.0
        tau = (slow + (max(BA[1], 0.0) if len(BA) == 2 else 0.0)) / EA[1] * (1.0 - EA[0] / EA[1])
        law = self.deck.made(
            row.line, StaticDynamic, strain=(0.0, ROPE_STRAIN), tension=(0.0, EA[0] * ROPE_STRAIN),
            dynamic_stiffness=EA[1], per_tension=EA[2] if len(EA) == 3 else 0.0, relaxation_time=tau,
        )  # fmt: skip
        self._once(
            f"line type '{row.values['name']}': EA {row.values['EA']} is a StaticDynamic law with relaxation time "
            f"(BA_s + BA_d) (EA_d - EA_s)/EA_d^2 = {tau:.4g} s"
        )
        return EA[0], law, tau

    def _damping(self, row: Row, element: float, EA: float, m: float, linear: bool) -> dict[str, float]:
        """axial_damping or axial_damping_ratio of the column BA: number, or of a pair the dynamic one."""
        text, pair = row.values["BA"], "|" in row.values["EA"]
        value = number(text.split("|")[-1 if pair else 0])
        if value is None or len(text.split("|")) > 2:
            allowed = "damping [N s], minus the damping ratio, or BA_s|BA_d; tables of damping are not read"
            self.deck.refuse(row.line, f"BA/-zeta: got '{text}'; {allowed}")
            return {}
        if pair and "|" not in text:
            return {"axial_damping": 0.0}  # it went into the slow branch
        if value >= 0.0:
            return {"axial_damping": value}
        if linear:
            return {"axial_damping_ratio": -value}
        return {"axial_damping": -value * element * math.sqrt(max(EA * m, 0.0))}

    def _bending_law(self, row: Row) -> tuple[float, Any]:
        text = row.values.get("EI", "0")
        EI = number(text)
        if EI is not None:
            return EI, None
        x, y = self._table(row, "EI", text)
        law = self.deck.made(row.line, MomentTable, curvature=x, moment=y) if len(x) >= 2 else None
        if law is not None:
            self._once(f"line type '{row.values['name']}': EI from the table '{text}': moment over curvature")
        return 0.0, law

    def _table(self, row: Row, column: str, text: str) -> tuple[list[float], list[float]]:
        """Two columns of a file beside the deck; lines before the first two numbers are headings."""
        allowed = f"a number or the name of a table file beside {self.deck.path.name} is allowed"
        try:
            lines = (self.deck.path.parent / text).read_text(encoding="utf-8-sig", errors="replace").split("\n")
        except (OSError, ValueError):
            self.deck.refuse(row.line, f"{column}: got '{text}'; {allowed}, and there is no such file that can be read")
            return [], []
        x, y = [], []
        for k, line in enumerate(lines, 1):
            values = [number(word) for word in line.split()[:2]]
            if len(values) == 2 and values[0] is not None and values[1] is not None:
                x.append(values[0])
                y.append(values[1])
            elif x and line.strip() and not line.strip().startswith("-"):
                self.deck.refuse(
                    row.line,
                    f"{column}: '{text}', line {k}: got '{line.strip()[:60]}'; two numbers are needed",
                )
                return [], []
        if len(x) < 2:
            self.deck.refuse(row.line, f"{column}: '{text}' has {len(x)} rows of two numbers; at least two are needed")
        return x, y

    def _once(self, note: str) -> None:
        if note not in self.notes:
            self.notes.append(note)
