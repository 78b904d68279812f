"""The run: steps from output time to output time, cuts a step that fails and grows it back, streams results.

Output stays on the asked grid: a step is the interval between outputs divided by a whole number, and a
failed one is halved until the interval is filled in smaller steps. After four good ones it doubles
again. A run never goes on from a step that has not converged: it ends as `failed`, with the reason.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np

from floatsim.description import is_number
from floatsim.errors import CaseError, ModelError, SolveFailed
from floatsim.frames import Array
from floatsim.model import Model
from floatsim.sea.waves import Realisation
from floatsim.solve.scheme import Scheme
from floatsim.solve.static import solve_static
from floatsim.solve.step import TOLERANCE, Stepper
from floatsim.study.channels import Sampler
from floatsim.study.energy import Energy, Ledger
from floatsim.study.store import Writer, check_path
from floatsim.system.state import State
from floatsim.system.system import System, assemble
from floatsim.version import __version__

STEPS_PER_WAVE, FAST_SHARE = 10.0, 0.05  # steps a wave needs, and how much of the energy may have fewer
MAX_CUTS = 12  # halvings of the asked step before a run gives up
MAX_ERROR_CUTS = 7  # halvings for the sake of accuracy; a step this small is accepted whatever its error
_CALM = 4  # good steps before a cut step is doubled again
_EASY = 0.2  # of the allowed local error, below which a cut step may be doubled: the error falls with the square

Progress = Callable[[float, int], None]


@dataclass(frozen=True)
class Run:
    """How a run went and where its results are.

    status: 'done' or 'failed' (then `failure` says why). state: the last good one. time (n,) [s] and
    rows (n, width) hold the results of a run without a file; `series(name)` gives one channel of either. energy: the
    ledger of a run with energy=True; `print(run.energy.summary())`.
    """

    status: Literal["done", "failed"]
    failure: str
    state: State = field(repr=False)
    steps: int
    cut_steps: int
    newton_iterations: int
    wall_time: float
    path: Path | None
    time: Array = field(repr=False)
    rows: Array = field(repr=False)
    sampler: Sampler = field(repr=False)
    energy: Energy | None = None

    @property
    def simulated_time(self) -> float:
        """Simulated time of the results [s]."""
        return float(self.time[-1] - self.time[0]) if len(self.time) else 0.0

    def series(self, name: str) -> Array:
        """Channel `name`, shape (n, ...). Raises CaseError for a name that is not there."""
        if self.path is None:
            return self.sampler.column(self.rows, name)
        import xarray

        with xarray.open_dataset(self.path) as file:
            if name not in file:
                self.sampler.column(np.zeros((0, self.sampler.width)), name)
            return np.asarray(file[name].values)

    def dataset(self) -> Any:
        """Everything as an xarray Dataset."""
        import xarray

        if self.path is not None:
            return xarray.load_dataset(self.path)
        return self.sampler.dataset(self.time, self.rows, self.energy.attributes() if self.energy else None)


MAX_STEPS = 1e12  # in a run; more is a slip of the pen


def positive_seconds(what: str, value: Any) -> float:
    """The value if it is a positive, finite number. Raises CaseError naming it."""
    if not is_number(value) or value <= 0.0:
        raise CaseError(f"{what}: got {value!r}; must be a positive number of seconds")
    return float(value)


def as_system(model: Any) -> System:
    """The assembled system of a model or of itself. Raises CaseError for anything else."""
    if isinstance(model, System):
        return model
    if not isinstance(model, Model):
        raise CaseError(f"model: got {model!r}; must be a floatsim.Model or a System made by assemble()")
    return assemble(model)


def _check_case(duration: float, dt: float, interval: float | None, output: Any, precision: Any, scheme: Any,
                tolerance: Any, state: Any, step_control: Any) -> tuple[float, float, float]:  # fmt: skip
    """(duration, dt, interval) [s]. Raises CaseError for what makes no sense, before anything is computed."""
    duration, dt = positive_seconds("duration", duration), positive_seconds("dt", dt)
    what, step = ("dt", dt) if interval is None else ("interval", positive_seconds("interval", interval))
    if step > duration * (1.0 + 1e-9):
        raise CaseError(f"{what} is {step:g} s, longer than the duration of {duration:g} s: nothing would be kept")
    if not duration / min(dt, step) < MAX_STEPS:
        raise CaseError(f"duration is {duration:g} s and dt {min(dt, step):g} s: more than {MAX_STEPS:.0e} steps")
    if precision not in ("float64", "float32"):
        raise CaseError(f"precision: got {precision!r}; must be 'float64' or 'float32'")
    if scheme is not None and not isinstance(scheme, Scheme):
        raise CaseError(f"scheme: got {scheme!r}; must be generalised_alpha(...), hht(...) or newmark(...)")
    if not is_number(tolerance) or not 0.0 < tolerance < 1.0:
        raise CaseError(f"tolerance: got {tolerance!r}; must be a number between 0 and 1")
    if not isinstance(step_control, bool | np.bool_):
        raise CaseError(f"step_control: got {step_control!r}; must be True or False")
    if state is not None and not isinstance(state, State):
        raise CaseError(f"state: got {state!r}; must be a State, e.g. of solve_static")
    if output is not None:
        check_path(output)
    return duration, dt, step


def simulate(
    model: Model | System,
    duration: float,
    dt: float = 0.1,
    *,
    output: str | Path | None = None,
    interval: float | None = None,
    channels: str | Sequence[str] = "all",
    precision: Literal["float64", "float32"] = "float64",
    step_control: bool = True,
    scheme: Scheme | None = None,
    tolerance: float = TOLERANCE,
    state: State | None = None,
    attributes: Mapping[str, str | int | float] | None = None,
    progress: Progress | None = None,
    energy: bool = False,
) -> Run:
    """Integrate from the static equilibrium, or from `state`, for `duration` [s].

    dt [s]: largest step; it is made a whole fraction of `interval`, the time between outputs (default: dt).
    step_control: halve steps whose local error of axial strain in a line is too large (2 % of the line's largest
    tension so far), not only those that fail to converge; without lines it has nothing to look at.
    output: netCDF file to stream to; without one the results stay in memory. channels, precision: what is kept and
    how. progress(t, newton_iterations) is called about ten times a second.
    energy: keep the energy ledger (study/energy.py), as channels energy_... [J], in the file's attributes and as
    `run.energy`.

    Raises CaseError for bad input (before anything is written) and SolveFailed if there is no equilibrium to start
    from. A run that cannot go on returns with status 'failed'.
    """
    duration, dt, interval = _check_case(
        duration, dt, interval, output, precision, scheme, tolerance, state, step_control
    )
    system = as_system(model)
    sea = system.model.sea
    if system.waves is not None:
        end = duration + (0.0 if state is None else state.t)
        _check_waves(system.waves, end, min(dt, interval))
    if state is not None and (state.x.shape != system.x0.shape or len(state.lam) != system.n_con):
        raise CaseError(f"state: it belongs to another system than '{system.model.name}'")
    stepper = Stepper(system, scheme, tolerance)
    if not isinstance(energy, bool | np.bool_):
        raise CaseError(f"energy: got {energy!r}; must be True or False")
    ledger = Ledger(system) if energy else None
    sampler = Sampler(system, channels, [ledger] if ledger else [])
    if state is None:
        now, _ = solve_static(system)
    else:
        now = state.copy()
    per_output = max(1, math.ceil(interval / dt * (1.0 - 1e-9)))
    outputs = int(math.floor(duration / interval * (1.0 + 1e-9)))
    h = interval / per_output
    first = now
    if now.step == 0.0:
        # what `start` adds to velocities for the scheme's sake goes with h^2 and is no velocity of a sample: through
        # the axial damping of a stiff line it would be a tension
        first = now.copy()
        stepper.start(first, 1e-6 * h)
        stepper.start(now, h)
    if ledger is not None:
        ledger.start(stepper.work, now)
        stepper.watch = ledger
    case: dict[str, str | int | float] = {
        "title": system.model.name, "water_depth": sea.depth, "floatsim_version": __version__,
        **seed_of(sea.waves), **(attributes or {}),
        "scheme": stepper.scheme.name, "step_control": int(step_control),
        "step": h, "output_interval": interval, "duration": duration,
    }  # fmt: skip
    store: _Memory | Writer
    if output is None:
        store = _Memory(sampler.width, outputs + 1)
    else:
        store = Writer(output, sampler.channels, sampler.coordinates, case, precision, samples=outputs + 1)
    loop = _Loop(stepper, now, h, step_control)
    began = clock.perf_counter()
    shown = began
    failure = ""
    try:
        store.append(now.t, sampler.sample_state(first))
        t0 = now.t
        for k in range(1, outputs + 1):
            try:
                failure = loop.advance(per_output, t0 + (k - 1) * interval)
            except ModelError as error:  # a motion that fails on its way
                failure = f"at t = {now.t:.6g} s: {error}"
            if failure:
                break
            now.t = t0 + k * interval
            store.append(now.t, sampler.sample(stepper.work, loop.iterations_of_last, loop.last_step))
            if progress is not None and clock.perf_counter() - shown > 0.1:
                shown = clock.perf_counter()
                progress(now.t - t0, loop.iterations)
        store.close("failed" if failure else "done", failure, ledger.result().attributes() if ledger else None)
    except BaseException as error:
        said = "interrupted" if isinstance(error, KeyboardInterrupt) else f"{type(error).__name__}: {error}"
        store.close("failed", f"at t = {now.t:.6g} s: {said}")
        raise
    wall = clock.perf_counter() - began
    path: Path | None = None
    times: Array
    if isinstance(store, _Memory):
        times, rows = store.times[: store.count], store.rows[: store.count]
    else:
        path, rows = store.path, np.zeros((0, sampler.width))
        times = np.asarray(t0 + interval * np.arange(loop.outputs + 1), dtype=np.float64)
    return Run("failed" if failure else "done", failure, now, loop.steps, loop.cuts, loop.iterations, wall, path,
               times, rows, sampler, ledger.result() if ledger else None)  # fmt: skip


def _check_waves(waves: Realisation, duration: float, h: float) -> None:
    """Refuse a run longer than its waves, and steps that cannot follow them."""
    if duration > waves.duration * (1.0 + 1e-9):
        raise CaseError(
            f"the run ends at {duration:g} s, but the waves are only known (or known not to repeat) "
            f"until {waves.duration:g} s; irregular waves and groups take a longer duration, "
            "measured ones a longer record"
        )
    fast = 2.0 * np.pi / waves.omega < STEPS_PER_WAVE * h
    share = float(0.5 * np.sum(waves.amplitude[fast] ** 2) / max(waves.variance, np.finfo(float).tiny))
    if share > FAST_SHARE:
        raise CaseError(
            f"dt is {h:g} s, but {100.0 * share:.3g} % of the waves' energy has periods below "
            f"{STEPS_PER_WAVE:g} steps, which the integrator would distort ({100.0 * FAST_SHARE:g} % is allowed); "
            "0.1 s is usual"
        )


def seed_of(waves: Any) -> dict[str, int]:
    """The seed of the waves as an attribute of the output, if they have one."""
    seed = getattr(waves, "seed", None)
    return {} if seed is None else {"seed": int(seed)}


class _Memory:
    """Results in memory, with the face of a Writer."""

    def __init__(self, width: int, n: int) -> None:
        self.count = 0
        try:
            self.times, self.rows = np.zeros(n), np.zeros((n, width))
        except (MemoryError, ValueError):
            raise CaseError(
                f"{n} samples of {width} values do not fit into memory; give an output file, a longer interval or "
                "fewer channels"
            ) from None

    def append(self, time: float, values: Array) -> None:
        self.times[self.count], self.rows[self.count] = time, values
        self.count += 1

    def close(self, status: str, failure: str = "", attributes: Mapping[str, str | float] | None = None) -> None:
        """Nothing to close."""


class _Loop:
    """Steps with cutting and growing back."""

    def __init__(self, stepper: Stepper, state: State, h: float, control: bool) -> None:
        self.stepper, self.state, self.h, self.control = stepper, state, h, control
        self.level = 0  # the step is h / 2^level
        self.calm = 0
        paced, calm = state.pace
        if 0.0 < paced < h:
            level = min(round(math.log2(h / paced)), MAX_CUTS)
            if abs(h / 2**level - paced) < 1e-9 * paced:
                self.level, self.calm = level, calm
        self.steps = self.cuts = self.iterations = self.outputs = 0
        self.iterations_of_last = 0
        self.last_step = h

    def advance(self, count: int, t: float) -> str:
        """`count` steps of h from time t; the reason if it fails, else ''."""
        self.iterations_of_last = 0
        for k in range(count):
            reason = self._fill()
            if reason:
                return f"at t = {self.state.t:.6g} s: {reason}"
            self.state.t = t + (k + 1) * self.h
            self.state.pace = self.h / 2**self.level, self.calm
        self.outputs += 1
        return ""

    def _fill(self) -> str:
        """One step of h, in pieces if need be."""
        done = 0  # pieces of h / 2^level
        while done < 2**self.level:
            allowed = (1.0 if self.level < MAX_ERROR_CUTS else math.inf) if self.control else None
            report = self.stepper.step(self.state, self.h / 2**self.level, allowed)
            self.iterations += report.iterations
            self.iterations_of_last += report.iterations
            self.last_step = report.step
            if report.converged:
                self.steps += 1
                self.calm = self.calm + 1 if report.error < _EASY else 0
                done += 1
                while self.level and self.calm >= _CALM and done % 2 == 0:
                    self.level, done, self.calm = self.level - 1, done // 2, 0
            else:
                self.cuts += 1
                self.calm = 0
                if self.level == MAX_CUTS:
                    return f"a step of {self.h / 2**self.level:.3g} s still fails: {report.reason}"
                self.level, done = self.level + 1, 2 * done
        return ""


def run_or_raise(run: Run) -> Run:
    """The run if it is done. Raises SolveFailed with its reason and last good state otherwise."""
    if run.status == "failed":
        raise SolveFailed(run.failure, run, run.state)
    return run
