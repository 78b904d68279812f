"""One load case as pure data: what to build, in which environment, how to run it. Everything about cases works on this.

A case is text, numbers, booleans and lists of them, so that it goes unchanged to another process, another machine or
a file and back. Its identity is a readable slug and a hash of all that its results depend on: model script and its
data (`source`), parameters, environment, settings and the version of floatsim. Its number in the matrix, the matrix's
name and where its results lie are not part of it: a case that two matrices share is the same case.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

from floatsim.version import __version__

Value = float | int | str | bool | None


@dataclass(frozen=True)
class RunSettings:
    """How a case is run.

    study: 'run', or 'decay' (dof and offset: of the release, m or degrees). ramp [s] comes before duration [s]:
    statistics are those of the time from ramp to ramp + duration. dt [s]: largest step. interval [s] between samples,
    None: dt. channels: 'all' or names. keep: series and statistics, or statistics alone. precision: of the series.
    fatigue: channel -> exponent m of its S-N curve. block [s]: length over which extremes are taken. time_limit [s] of
    wall clock, None: none.
    """

    duration: float
    ramp: float = 100.0
    dt: float = 0.1
    interval: float | None = None
    channels: str | tuple[str, ...] = "all"
    keep: Literal["series", "statistics"] = "statistics"
    precision: Literal["float64", "float32"] = "float32"
    fatigue: Mapping[str, float] = field(default_factory=dict)
    block: float = 600.0
    time_limit: float | None = None
    study: Literal["run", "decay"] = "run"
    dof: str = ""
    offset: float = 0.0

    @property
    def total(self) -> float:
        """Simulated time [s], ramp included."""
        return self.ramp + self.duration


@dataclass(frozen=True)
class Case:
    """A case of a matrix.

    number: place in the matrix, from 0. variables: every column of the matrix, by name, in order. model: path of the
    script. parameters: of build(). environment: 'waves', 'current', 'wind' -> keyword values of their descriptions.
    source: hash of the script, of what it imports from its folder and of the data its model reads.
    """

    number: int
    slug: str
    variables: Mapping[str, Value]
    model: str
    parameters: Mapping[str, Any]
    environment: Mapping[str, Mapping[str, Any]]
    run: RunSettings
    source: str

    @property
    def id(self) -> str:
        """Slug and hash: the name of the case's files."""
        own = {
            "source": self.source, "parameters": dict(self.parameters), "version": __version__,
            "environment": {k: dict(v) for k, v in self.environment.items()}, "run": _settings(self.run),
        }  # fmt: skip
        return f"{self.slug}-{hashlib.sha256(_text(own).encode()).hexdigest()[:10]}"

    def as_dict(self) -> dict[str, Any]:
        """For JSON; `from_dict` brings it back."""
        return asdict(self)

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Case:
        """The case that `as_dict` gave."""
        run = dict(data["run"])
        if not isinstance(run["channels"], str):
            run["channels"] = tuple(run["channels"])
        return cls(**{**data, "run": RunSettings(**run)})


def _settings(run: RunSettings) -> dict[str, Any]:
    """What of the settings changes results: not the patience with them."""
    own = {**vars(run), "fatigue": dict(run.fatigue)}
    del own["time_limit"]
    return own


def _text(data: Any) -> str:
    """The same text for the same numbers."""
    return json.dumps(data, sort_keys=True, separators=(",", ":"), default=list)
