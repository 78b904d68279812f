"""The report of a matrix of cases: one HTML page with everything in it, from its summary.nc.

What the summary does not hold is left out of the page. Angles are shown in degrees, forces in kN or MN; statistics are
those of the time after the ramp. The page needs no network, and no script but for sorting and filtering its table.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from floatsim.cases.report_data import MANY_ROWS, Summary, number
from floatsim.errors import CaseError, FloatsimError
from floatsim.version import __version__


def report(source: str | Path | Any, output: str | Path | None = None) -> Path:
    """Write the report of a results folder (or of a summary.nc, or of the Dataset that it opens as) and return where.

    output: default report.html in the folder. Raises CaseError if there is no summary or it cannot be read, if it has
    no cases, and if the page cannot be written.
    """
    place = _place(source)
    target = Path(output) if output is not None else place / "report.html" if place else None
    if target is None:
        raise CaseError("output: a report of a Dataset needs the path of a file")
    if target.is_dir():
        raise CaseError(f"output '{target}' is a folder; give a file name")
    with _opened(source) as data:
        summary = Summary(data)
        if not summary.outlines and place is not None:
            summary.outlines = _drawn(place)
        text = page(summary)
    part = target.with_name(f".{target.name}.{os.getpid()}")
    try:
        part.write_text(text, encoding="utf-8")
        part.replace(target)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise CaseError(f"report '{target}' cannot be written: {error.strerror}") from None
    return target


def _place(source: Any) -> Path | None:
    """The folder of a summary; None for a Dataset."""
    if hasattr(source, "data_vars"):
        return None
    if not isinstance(source, str | Path):
        raise CaseError(f"source: got {source!r}; must be a results folder, the path of its summary.nc, or a Dataset")
    return Path(source) if Path(source).is_dir() else Path(source).parent


@contextmanager
def _opened(source: Any) -> Iterator[Any]:
    """The summary, of which only what the page needs is read."""
    import xarray

    if hasattr(source, "data_vars"):
        yield source
        return
    path = Path(source) / "summary.nc" if Path(source).is_dir() else Path(source)
    if not path.is_file():
        raise CaseError(f"there is no '{path}'; `floatsim cases collect` makes it")
    try:
        data = xarray.open_dataset(path, decode_timedelta=False)
    except (OSError, ValueError, RuntimeError):
        raise CaseError(f"'{path}' is not a netCDF file that can be read") from None
    with data:
        yield data


def _drawn(folder: Path) -> dict[str, Any]:
    """Outlines of the bodies as the first case draws them; none where its model cannot be built here and now."""
    from floatsim.cases.case import Case
    from floatsim.cases.outline import outlines

    try:
        from floatsim.cases.environment import build_case

        cases = json.loads((folder / "matrix.json").read_bytes())["cases"]
        return outlines(build_case(Case.from_dict(cases[0])))
    except (ImportError, OSError, ValueError, KeyError, IndexError, TypeError, FloatsimError):
        return {}


def page(s: Summary) -> str:
    """The report as text of HTML."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    from floatsim.cases import report_panels

    env = Environment(
        loader=FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=StrictUndefined, trim_blocks=True,
        lstrip_blocks=True,
    )  # fmt: skip
    env.filters["num"] = number
    return env.get_template("report.html.jinja").render(
        s=s, panels=report_panels, version=__version__, many=MANY_ROWS
    )  # fmt: skip
