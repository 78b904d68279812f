"""What would go wrong in a run of a matrix, found before anything runs.

Every distinct set of parameters is built as it will be, with every waves, every current and every wind that goes with
it (seeds left out; not every waves with every current), and the first of every structure is assembled, for its
channels. Waves are made in the model's sea, for steps, ramp and repetition.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from floatsim.cases.case import Case
from floatsim.cases.environment import build_with, wind_of
from floatsim.cases.matrix import Matrix, seedless
from floatsim.errors import CaseError, FloatsimError
from floatsim.model import Model
from floatsim.parts.body import Body
from floatsim.solve.step import TOLERANCE
from floatsim.study.channels import Sampler
from floatsim.study.script import Script, data_files
from floatsim.study.simulate import check_case, check_waves
from floatsim.study.statistics import StatisticsSettings
from floatsim.system.system import System, assemble

STATISTICS = ("mean", "std", "min", "max", "period", "block_max", "block_min", "del", "utilisation")
_MOST = 20  # problems that are told

Progress = Callable[[int, int], None]


def check_matrix(matrix: Matrix, progress: Progress | None = None) -> None:
    """Raises CaseError with what is wrong, each problem once with the first case that has it. progress(done, all)."""
    first = _distinct(matrix.cases)
    problems: dict[str, list[Case]] = {}
    scripts: dict[str, Script] = {}
    structures: dict[Any, System] = {}
    seas: set[str] = set()
    for done, case in enumerate(first, 1):
        try:
            for said in _of_case(matrix, case, scripts, structures, seas):
                problems.setdefault(said, []).append(case)
        except FloatsimError as error:
            for said in getattr(error, "problems", [str(error)]):
                problems.setdefault(said, []).append(case)
        if progress is not None:
            progress(done, len(first))
        if len(problems) >= _MOST:
            break
    if problems:
        raise CaseError([f"case {cases[0].number} ({cases[0].slug}): {said}" + _more(len(cases) - 1)
                         for said, cases in problems.items()])  # fmt: skip


def _more(n: int) -> str:
    return f" (and {n} more of those looked at)" if n else ""


def _distinct(cases: Sequence[Case]) -> list[Case]:
    """Cases that show every set of parameters and settings together with every section of the environment."""
    seen: set[str] = set()
    out = []
    for case in cases:
        run = case.run
        own = json.dumps([case.model, case.parameters, run.total, run.ramp, run.dt, run.interval, run.channels,
                          dict(run.fatigue), run.study, run.dof], sort_keys=True, default=str)  # fmt: skip
        sorts = {own} | {own + name + json.dumps(seedless(values), sort_keys=True, default=str)
                         for name, values in case.environment.items()}  # fmt: skip
        if not sorts <= seen:
            seen |= sorts
            out.append(case)
    return out


def _of_case(
    matrix: Matrix, case: Case, scripts: dict[str, Script], structures: dict[Any, System], seas: set[str]
) -> Iterator[str]:
    run = case.run
    check_case(run.total, run.dt, run.interval, None, run.precision, None, TOLERANCE, None, True)
    if run.total - run.ramp < (run.interval or run.dt) * (1.0 - 1e-9):
        yield f"run: duration is {run.duration:g} s, shorter than the interval: nothing would be kept"
    if case.model not in scripts:
        scripts[case.model] = Script(case.model)
    model = build_with(scripts[case.model], case)
    StatisticsSettings(run.ramp, run.fatigue, run.block)
    yield from _files(matrix, model, case)
    yield from _sea(model, case, seas)
    if run.study == "decay":
        bodies = [part.name for part in model.parts if isinstance(part, Body)]
        if len(bodies) != 1:
            yield f"run: study decay needs a model with one body, '{model.name}' has {len(bodies)}"
    structure = (case.model, tuple((type(item).__name__, _name(item)) for item in (*model.parts, *model.joints)),
                 model.sea.waves is not None, run.channels, tuple(run.fatigue))  # fmt: skip
    if structure not in structures:
        structures[structure] = system = assemble(model)
        yield from _outputs(matrix, system, case)


def _files(matrix: Matrix, model: Model, case: Case) -> Iterator[str]:
    """Files that the identity of the case does not cover."""
    for file in data_files(model):
        if matrix.files and file.resolve() not in matrix.files[case.source]:
            yield (
                f"model '{model.name}' reads '{file}' for these numbers and another file for others, which cases are "
                "not told apart by; let a text, or {file: ...}, among the parameters choose it"
            )


def _name(item: Any) -> str:
    return str(getattr(item, "label", None) or getattr(item, "name", ""))


def _sea(model: Model, case: Case, seas: set[str]) -> Iterator[str]:
    """Ramp, steps and repetition of waves and wind; the same sea from another side is not looked at again."""
    sea, run = model.sea, case.run
    yield from _turbulence(case, seas)
    if sea.waves is None:
        return
    if run.study == "run" and run.ramp < sea.wave_ramp:
        yield (
            f"run: ramp is {run.ramp:g} s, but the waves of model '{model.name}' grow for {sea.wave_ramp:g} s "
            "(wave_ramp); statistics would contain that: a longer ramp, or a model with a shorter one"
        )
    values = case.environment.get("waves", {})
    turned = {name: y for name, y in seedless(values).items() if name not in ("heading_deg", "kind")}
    sort = json.dumps([case.model, turned, sea.depth, model.gravity, run.total, run.dt, run.interval], default=str)
    if values and sort in seas:
        return
    seas.add(sort)
    waves = sea.waves.realise(sea.depth, model.gravity)
    check_waves(waves, run.total, min(run.dt, run.interval or run.dt))


def _turbulence(case: Case, seas: set[str]) -> Iterator[str]:
    """Repetition of the wind."""
    values = case.environment.get("wind")
    if values is None or (sort := f"wind {case.run.total} {seedless(values)}") in seas:
        return
    seas.add(sort)
    wind = wind_of(values, case.run.total)
    if wind.turbulence is not None:
        until = wind.turbulence.realise(wind.speed, 0.0).duration
        if until < case.run.total * (1.0 - 1e-9):
            yield f"wind: duration is {until:g} s, the case simulates {case.run.total:g} s"


def _outputs(matrix: Matrix, system: System, case: Case) -> Iterator[str]:
    """Names of channels, and names of variables that would stand for two things in the summary."""
    try:
        sampler = Sampler(system, case.run.channels)
        for name in case.run.fatigue:
            sampler.column(np.zeros((0, sampler.width)), name)
    except CaseError as error:
        yield from (f"run: {line}" for line in error.problems)
        return
    taken = {item.dim for item in sampler.coordinates} | {dim for c in sampler.channels for dim in c.dims}
    taken |= {f"{c.name}_{kind}" for c in sampler.channels for kind in STATISTICS}
    for name in matrix.variables:
        if name in taken:
            yield f"variables.{name}: the summary has an output of that name; rename the variable"
