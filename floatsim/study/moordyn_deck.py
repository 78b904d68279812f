"""The text of a MoorDyn input file, version 1 or 2, as tables of named columns with line numbers.

Sections start at lines of dashes with a key phrase. A table has a row of column names, a row of units, and its rows;
`!`, `#` and `%` start comments. Columns are taken by their names; where the names are not known, MoorDyn's own order
holds, since MoorDyn itself reads by position. Source: MoorDyn documentation, "Input Files" (versions 1 and 2).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from floatsim.description import LARGEST
from floatsim.errors import ModelError

# key phrases of section headings, first match counts
SECTIONS = (
    ("line_types", r"LINE (TYPE|DICTIONARY)"), ("rod_types", r"ROD (TYPE|DICTIONARY)"),
    ("bodies", r"BOD(IES|Y)"), ("failure", r"FAILURE"), ("control", r"CONTROL"), ("loads", r"EXTERNAL LOAD"),
    ("syrope", r"SYROPE"), ("options", r"OPTIONS?"), ("outputs", r"OUTPUTS?"), ("rods", r"RODS?"),
    ("points", r"(POINT|CONNECTION|NODE)S?"), ("end", r"NEED THIS LINE|END"), ("lines", r"LINES?"),
)  # fmt: skip

# column -> names it goes by (lower case, letters and digits only), in MoorDyn's order
COLUMNS: dict[str, dict[str, str]] = {
    "line_types": {
        "name": "name typename linetype type", "d": "diam diameter dia d",
        "m": "massm massden massdeninair massdenair mass m", "EA": "ea", "BA": "bazeta ba bain zeta", "EI": "ei",
        "Cd": "cd cdn", "Ca": "ca can", "CdAx": "cdax cdt", "CaAx": "caax cat", "Cl": "cl", "dF": "df", "cF": "cf",
    },
    "rod_types": {
        "name": "name typename rodtype type", "d": "diam diameter dia d", "m": "massm massden mass m",
        "Cd": "cd cdn", "Ca": "ca can", "CdEnd": "cdend cdt cdax", "CaEnd": "caend cat caax",
    },
    "bodies": {
        "id": "id body num", "attachment": "attachment type", "x": "x0 x", "y": "y0 y", "z": "z0 z",
        "roll": "r0 roll", "pitch": "p0 pitch", "yaw": "y0 yaw", "mass": "mass m", "CG": "cg", "I": "i inertia",
        "volume": "volume v vol", "CdA": "cda", "Ca": "ca",
    },
    "points": {
        "id": "id node point num", "attachment": "attachment type attach", "x": "x", "y": "y", "z": "z",
        "mass": "mass m", "volume": "volume v vol", "fx": "fx", "fy": "fy", "fz": "fz", "CdA": "cda", "Ca": "ca",
    },
    "rods": {
        "id": "id rod num", "type": "rodtype type typename", "attachment": "attachment attach", "xa": "xa", "ya": "ya",
        "za": "za", "xb": "xb", "yb": "yb", "zb": "zb", "segments": "numsegs nsegs segments",
        "outputs": "outputs rodoutputs flagsoutputs flags",
    },
    "lines": {
        "id": "id line num", "type": "linetype type typename", "a": "attacha nodeanch enda nodea anchor",
        "b": "attachb nodefair endb nodeb fairlead", "length": "unstrlen length",
        "segments": "numsegs nsegs segments", "outputs": "outputs lineoutputs flagsoutputs flags",
    },
    "failure": {
        "id": "failureid id failure", "point": "point node attachment", "lines": "line lines",
        "time": "failtime time", "tension": "failten tension ten",
    },
}  # fmt: skip

# columns by position where the names are not known: all of COLUMNS but these, unless the table is that wide
_WIDE = {"points": ("fx", "fy", "fz"), "lines": (), "line_types": ("Cl", "dF", "cF")}
_OLD_TYPES = ("name", "d", "m", "EA", "BA", "Ca", "CaAx", "Cd", "CdAx")  # version 1, nine columns
_OPTIONAL = {
    "line_types": {"EI", "Cl", "dF", "cF"}, "rod_types": {"Cd", "Ca", "CdEnd", "CaEnd"},
    "points": {"mass", "volume", "fx", "fy", "fz", "CdA", "Ca"}, "rods": {"outputs"}, "lines": {"outputs"},
    "bodies": {"volume", "CdA", "Ca"}, "failure": {"id"},
}  # fmt: skip
_VALUE = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eEdD][-+]?\d{1,3})?")


def number(text: str) -> float | None:
    """A finite number as Fortran or C write it, or None."""
    if not _VALUE.fullmatch(text):
        return None
    value = float(re.sub("[dD]", "e", text))
    return value if abs(value) <= LARGEST else None


@dataclass(frozen=True)
class Row:
    """One row of a table: its line number in the file and the text of its columns."""

    line: int
    values: dict[str, str]


@dataclass
class Deck:
    """What a file contains. tables: section -> rows; options: lower-case key -> (line, value, key as written).

    problems: what makes the file unusable, each with file and line. not_understood: what was left out.
    """

    path: Path
    tables: dict[str, list[Row]] = field(default_factory=dict)
    options: dict[str, tuple[int, str, str]] = field(default_factory=dict)
    outputs: list[str] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)
    not_understood: list[str] = field(default_factory=list)

    def at(self, line: int) -> str:
        """Where a message points."""
        return f"{self.path.name}, line {line}"

    def rows(self, section: str) -> list[Row]:
        return self.tables.get(section, [])

    def refuse(self, line: int, what: str) -> None:
        self.problems.append(f"{self.at(line)}: {what}")

    def leave_out(self, line: int, what: str) -> None:
        self.not_understood.append(f"line {line}: {what}")

    def number(self, row: Row, column: str, default: float = 0.0) -> float:
        """The number in a column; a missing optional one is its default."""
        text = row.values.get(column)
        if text is None:
            return default
        value = number(text)
        if value is None:
            self.refuse(row.line, f"{column}: got '{text}'; a finite number is allowed")
            return default
        return value

    def whole(self, row: Row, column: str, low: int = 0) -> int:
        """The whole number in a column, at least `low`."""
        text = row.values[column]
        value = number(text)
        if value is None or value != int(value) or not low <= value < 1e9:
            self.refuse(row.line, f"{column}: got '{text}'; a whole number of at least {low} is allowed")
            return low
        return int(value)

    def made(self, line: int, make: Callable[..., Any], **arguments: Any) -> Any:
        """The object, or None and a problem at this line of the file."""
        try:
            return make(**arguments)
        except ModelError as error:
            for problem in error.problems:
                self.refuse(line, problem)
            return None

    def bar(self, row: Row, column: str, lengths: tuple[int, ...]) -> tuple[float, ...] | None:
        """Numbers separated by bars."""
        values = [number(word) for word in row.values[column].split("|")]
        if len(values) not in lengths or any(value is None for value in values):
            allowed = " or ".join(map(str, lengths))
            self.refuse(
                row.line,
                f"{column}: got '{row.values[column]}'; {allowed} numbers, as a|b|c, are allowed",
            )
            return None
        return tuple(float(value) for value in values if value is not None)

    def done(self) -> None:
        """Raises ModelError with every problem found so far."""
        if self.problems:
            raise ModelError(self.problems)


def read_deck(path: str | Path) -> Deck:
    """Raises ModelError if the file cannot be read or a table has no usable row of column names."""
    file = Path(path)
    try:
        text = file.read_text(encoding="utf-8-sig", errors="replace")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise ModelError(f"MoorDyn file '{path}': cannot be read: {reason}; a text file is needed") from None
    deck = Deck(file)
    section, header, found = "", None, False
    for line, raw in enumerate(text.split("\n"), 1):
        if re.match(r"\s*-{3,}", raw):
            section, header = _section(deck, line, raw), None
            found |= section in COLUMNS
            continue
        raw = raw.replace("\r", "").strip()
        if not raw or raw[0] in "!#%" or section in ("", "end"):
            continue
        if section == "options":
            _option(deck, line, raw)
        elif section == "outputs":
            deck.outputs += [word for word in _words(raw) if word.upper() != "END"]
        elif section not in COLUMNS:
            if not raw.startswith("(") and section != "unknown":
                deck.tables.setdefault(section, []).append(Row(line, {"text": raw}))
        elif header is None:
            header = _header(deck, section, line, raw)
        elif not raw.startswith("("):
            _row(deck, section, header, line, raw)
    if not found:
        raise ModelError(
            f"MoorDyn file '{path}': no section was found; lines such as '--- LINE TYPES ---', '--- POINTS ---' and "
            "'--- LINES ---' start them"
        )
    return deck


def _section(deck: Deck, line: int, raw: str) -> str:
    title = re.sub(r"[-=\s]+", " ", raw).strip().upper()
    if not title or re.search(r"MOORDYN|INPUT FILE", title):
        return ""
    for section, phrase in SECTIONS:
        if re.search(rf"\b({phrase})", title):
            return section
    deck.leave_out(line, f"section '{title}' is not known; everything in it was left out")
    return "unknown"


def _words(raw: str) -> list[str]:
    """Words before a comment."""
    return re.split(r"[!#%]", raw, maxsplit=1)[0].replace("\t", " ").split()


def _plain(word: str) -> str:
    return re.sub(r"[^a-z0-9]", "", re.sub(r"\(.*?\)", "", word.lower()))


def _header(deck: Deck, section: str, line: int, raw: str) -> list[str]:
    """Column for every position; '' for one that is not known."""
    words = raw.split()
    columns, taken = [], set()
    for word in words:
        fits = [c for c, names in COLUMNS[section].items() if c not in taken and _plain(word) in names.split()]
        columns.append(fits[0] if fits else "")
        taken.update(fits[:1])
    missing = [c for c in COLUMNS[section] if c not in taken | _OPTIONAL[section]]
    if not missing:
        return columns
    if any(number(word) is not None for word in words[:2]):
        deck.refuse(line, f"got '{raw}'; a row of column names must come first, such as {_usual(section)}")
        return []
    order = _by_position(section, len(words))
    deck.leave_out(
        line, f"column names {', '.join(w for w, c in zip(words, columns, strict=True) if not c) or '(too few)'} are "
        f"not known; the columns were taken in MoorDyn's own order: {', '.join(order)}"
    )  # fmt: skip
    return order


def _by_position(section: str, width: int) -> list[str]:
    every = list(COLUMNS[section])
    if section == "line_types" and width == len(_OLD_TYPES):
        return list(_OLD_TYPES)
    if width >= len(every) and section != "line_types":
        return every
    if section == "line_types":
        return every[: max(width, 10)]
    return [c for c in every if c not in _WIDE.get(section, ())]


def _usual(section: str) -> str:
    return " ".join(c for c in COLUMNS[section] if c not in _WIDE.get(section, ()))


def _row(deck: Deck, section: str, header: list[str], line: int, raw: str) -> None:
    if not header:  # its header was refused
        return
    words = _words(raw)
    if not words:
        return
    values = {c: w for c, w in zip(header, words, strict=False) if c}
    missing = [c for c in header[len(words) :] if c and c not in _OPTIONAL[section]]
    if missing:
        deck.refuse(line, f"got {len(words)} values '{' '.join(words)}'; {', '.join(missing)} must follow")
        return
    needed = [c for c in COLUMNS[section] if c not in _OPTIONAL[section] and c not in values]
    if needed:
        deck.refuse(line, f"there is no column {', '.join(needed)}; the columns are {_usual(section)}")
        return
    for column, word in zip(header, words, strict=False):
        if not column and number(word) not in (None, 0.0):
            deck.leave_out(line, f"'{word}' stands in a column that is not known and was left out")
    if len(words) > len(header):
        deck.leave_out(line, f"'{' '.join(words[len(header) :])}' after the last column was left out")
    deck.tables.setdefault(section, []).append(Row(line, values))


def _option(deck: Deck, line: int, raw: str) -> None:
    words = _words(raw)
    if not words:
        return
    if len(words) < 2:
        deck.refuse(line, f"got '{raw}'; an option is a value and then its name, such as '200 WtrDpth'")
        return
    value, key = words[0].strip("'\""), words[1].strip("'\",")
    if number(key) is not None and number(value) is None:
        deck.refuse(line, f"got '{value} {key}'; the value comes first: '{key} {value}'")
        return
    if key.lower() in deck.options:
        deck.leave_out(line, f"option {key} was given before, on line {deck.options[key.lower()][0]}; this one counts")
    deck.options[key.lower()] = (line, value, key)
