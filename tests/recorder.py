"""Collects what the tests measure, for the verification page.

Rows go to `verification.json` at the repository root, merged by (check, quantity) with the rows of
earlier runs, so that quick and slow tests can be run apart. Sorted and rounded: the same numbers give
the same file.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

Bar = float | tuple[float, float] | str
FILE = "verification.json"


class Recorder:
    """record(check, quantity, measured, bar): adds a row and asserts that the bar holds."""

    def __init__(self) -> None:
        self.rows: dict[tuple[str, str], dict[str, Any]] = {}

    def __call__(
        self, check: str, quantity: str, measured: float, bar: Bar, unit: str = "", holds: bool | None = None
    ) -> None:
        """bar: a number (measured must not exceed it), (low, high), or words together with `holds`.

        Raises AssertionError if the bar is missed; the row is kept all the same.
        """
        if holds is None:
            if isinstance(bar, str):
                raise TypeError("a bar in words needs holds=")
            low, high = (-math.inf, bar) if isinstance(bar, int | float) else bar
            holds = bool(low <= measured <= high)
        # an error keeps two digits, a value six: beyond that compilers and processors differ
        shown = float(f"{float(measured):.{6 if isinstance(bar, tuple) else 2}g}")
        self.rows[check, quantity] = {
            "check": check, "quantity": quantity, "measured": shown,
            "bar": list(bar) if isinstance(bar, tuple) else bar, "unit": unit, "holds": bool(holds),
        }  # fmt: skip
        assert holds, f"{check}: {quantity} is {measured:.6g} {unit}, allowed is {bar}"

    def write(self, path: Path) -> None:
        """Merge the rows into the file."""
        if not self.rows:
            return
        old = json.loads(path.read_text()) if path.exists() else []
        rows = {(row["check"], row["quantity"]): row for row in old} | self.rows
        text = ",\n".join(json.dumps(rows[key], ensure_ascii=False) for key in sorted(rows))
        path.write_text(f"[\n{text}\n]\n")
