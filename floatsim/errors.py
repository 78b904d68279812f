"""What floatsim raises. Every message names the user's object, what was got and what is allowed.

`ModelError`   the description is wrong: found before anything is computed.
`CaseError`    the request is wrong: a time step, an output path, a degree of freedom.
`SolveFailed`  the description was accepted but no solution was found; carries the report and the
               last good state, so that a caller can look at both.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Any


class FloatsimError(Exception):
    """Base of everything that floatsim raises on purpose."""


class _Problems(FloatsimError):
    """Several problems reported at once, one line each."""

    def __init__(self, problems: str | Iterable[str]) -> None:
        self.problems: tuple[str, ...] = (problems,) if isinstance(problems, str) else tuple(problems)
        super().__init__("\n".join(self.problems))


class ModelError(_Problems):
    """The model cannot be built as described."""


class CaseError(_Problems):
    """The model is fine, what is asked of it is not."""


class SolveFailed(FloatsimError):
    """No solution was found. `report` says why, `state` is the last good state (or None)."""

    def __init__(self, message: str, report: Any = None, state: Any = None) -> None:
        super().__init__(message)
        self.report = report
        self.state = state


def nearest(name: str, known: Iterable[str]) -> str:
    """` (did you mean 'x'?)` or `` (known: a, b, c)`` for a name that does not resolve."""
    names = list(known)
    close = [other for other in names if other.lower() == name.lower()] or difflib.get_close_matches(name, names, n=1)
    if close:
        return f" (did you mean '{close[0]}'?)"
    return f" (known: {', '.join(sorted(names)[:12]) or 'none'})"
