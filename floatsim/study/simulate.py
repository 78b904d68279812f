"""The run: steps from output time to output time, cuts a step that fails and grows it back, streams results.

Output stays on the asked grid: a step is the interval between outputs divided by a whole number, and a
failed one is halved until the interval is filled in smaller steps. After four good ones it doubles
again. A run never goes on from a step that has not converged: it ends as `failed`, with the reason.
"""

from __future__ import annotations

import math
import time as clock
import warnings
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
from floatsim.solve.step import TOLERANCE, Stepper, StepReport
from floatsim.study import checkpoint as checkpoints
from floatsim.study.channels import Sampler
from floatsim.study.energy import Energy, Ledger
from floatsim.study.statistics import Statistics, StatisticsSettings
from floatsim.study.store import Writer, check_path
from floatsim.system.state import State
from floatsim.system.system import System, assemble
from floatsim.version import __version__

STEPS_PER_WAVE, FAST_SHARE = 10.0, 0.05  # steps a wave needs, and how much of the energy may have fewer
MAX_CUTS = 12  # halvings of the asked step before a run gives up
MAX_ERROR_CUTS = 7  # halvings for the sake of accuracy; a step this small is accepted whatever its error
_INSTANT = 1e-6  # of a step: events so near to its ends are met by them
_CALM = 4  # good steps before a cut step is doubled again
_EASY = 0.2  # of the allowed local error, below which a cut step may be doubled: the error falls with the square

Progress = Callable[[float, int], None]


@dataclass(frozen=True)
class Run:
    """How a run went and where its results are.

    status: 'done' or 'failed' (then `failure` says why). state: the last good one. time (n,) [s] and
    rows (n, width) hold the results of a run without a file; `series(name)` gives one channel of either. energy: the
    ledger of a run with energy=True; `print(run.energy.summary())`. statistics: of a run that was asked for them;
    `run.statistics.dataset()`. attributes: what the file says about the run. kept: whether there are series at all.
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
    statistics: Statistics | None = None
    attributes: Mapping[str, str | int | float] = field(default_factory=dict, repr=False)
    kept: bool = True

    @property
    def simulated_time(self) -> float:
        """Simulated time of the results [s]."""
        return float(self.time[-1] - self.time[0]) if len(self.time) else 0.0

    def series(self, name: str) -> Array:
        """Channel `name`, shape (n, ...). Raises CaseError for a name that is not there."""
        self.check_kept()
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

        self.check_kept()
        if self.path is not None:
            return xarray.load_dataset(self.path)
        return self.sampler.dataset(self.time, self.rows, self.energy.attributes() if self.energy else None)

    def check_kept(self) -> None:
        """Raises CaseError if the run kept no series."""
        if not self.kept:
            raise CaseError("the run has no series: it was made with keep_series=False; see its `statistics`")


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


def check_case(duration: float, dt: float, interval: float | None, output: Any, precision: Any, scheme: Any,
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
    statistics: StatisticsSettings | None = None,
    keep_series: bool = True,
    checkpoint: str | Path | None = None,
    checkpoint_every: float = 600.0,
) -> Run:
    """Integrate from the static equilibrium, or from `state`, for `duration` [s].

    dt [s]: largest step; it is made a whole fraction of `interval`, the time between outputs (default: dt).
    step_control: halve steps whose local error of axial strain in a line is too large (2 % of the line's largest
    tension so far), not only those that fail to converge; without lines it has nothing to look at.
    output: netCDF file to stream to; without one the results stay in memory. channels, precision: what is kept and
    how. progress(t, newton_iterations) is called about ten times a second.
    energy: keep the energy ledger (study/energy.py), as channels energy_... [J], in the file's attributes and as
    `run.energy`.
    statistics: what to take statistics of while running, as `run.statistics` (study/statistics.py); keep_series=False
    then keeps nothing else, in memory or in a file.
    checkpoint: file to keep what `resume` needs to go on, bit for bit as if nothing had happened: written at the start,
    every `checkpoint_every` simulated seconds, at the end, and at the last good state of a run that fails. It does not
    change the run.

    Raises CaseError for bad input (before anything is written) and SolveFailed if there is no equilibrium to start
    from. A run that cannot go on returns with status 'failed'.
    """
    given = {"duration": duration, "dt": dt, "interval": interval, "channels": channels}
    duration, dt, interval = check_case(
        duration, dt, interval, output, precision, scheme, tolerance, state, step_control
    )
    checkpoint_every = positive_seconds("checkpoint_every", checkpoint_every)
    if checkpoint is not None:
        checkpoint = checkpoints.check_path(checkpoint, output)
    system = as_system(model)
    sea = system.model.sea
    end = duration + (0.0 if state is None else state.t)
    if system.waves is not None:
        check_waves(system.waves, end, min(dt, interval))
    _check_wind(system.model.wind, end)
    if state is not None and (state.x.shape != system.x0.shape or len(state.lam) != system.n_con):
        raise CaseError(f"state: it belongs to another system than '{system.model.name}'")
    stepper = Stepper(system, scheme, tolerance)
    if not isinstance(energy, bool | np.bool_):
        raise CaseError(f"energy: got {energy!r}; must be True or False")
    ledger = Ledger(system) if energy else None
    sampler = Sampler(system, channels, [ledger] if ledger else [])
    _check_kept(keep_series, output)
    tally = None if statistics is None else Statistics(sampler, statistics)
    if statistics is not None and statistics.start > end:
        raise CaseError(f"statistics: start is {statistics.start:g} s, but the run ends at {end:g} s")
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
        **seed_of(sea.waves), **wind_of(system.model.wind), **(attributes or {}),
        "scheme": stepper.scheme.name, "step_control": int(step_control),
        "step": h, "output_interval": interval, "duration": duration,
    }  # fmt: skip
    case = {name: value.item() if isinstance(value, np.generic) else value for name, value in case.items()}
    row = sampler.sample_state(first)
    saver = None
    if checkpoint is not None:
        header = {
            "model": checkpoints.identity(system.model), "script": _script(system.model), "given": _plain(given),
            "case": case, "output": None if output is None else str(Path(output).resolve()), "precision": precision,
            "step_control": bool(step_control), "scheme": list(stepper.scheme), "tolerance": float(tolerance),
            "energy": ledger is not None, "checkpoint_every": checkpoint_every,
            "t0": now.t, "interval": interval, "per_output": per_output, "keep_series": bool(keep_series),
            "statistics": None if statistics is None else statistics.as_dict(),
        }  # fmt: skip
        saver = _Saver(checkpoint, checkpoint_every, header, now.t)
        checkpoint.unlink(missing_ok=True)  # that of an older run does not belong to the file that begins now
    store: _Memory | _Nowhere | Writer
    if not keep_series:
        store = _Nowhere()
    elif output is None:
        store = _Memory(sampler.width, outputs + 1)
    else:
        store = Writer(output, sampler.channels, sampler.coordinates, case, precision, samples=outputs + 1)
    loop = _Loop(stepper, now, h, step_control)
    course = _Course(loop, sampler, ledger, tally, store, case, now.t, interval, per_output, saver)
    return course.run(outputs, progress, first=row)


def resume(
    checkpoint: str | Path,
    model: Model | System | None = None,
    duration: float | None = None,
    *,
    dt: float | None = None,
    output: str | Path | None = None,
    attributes: Mapping[str, str | int | float] | None = None,
    progress: Progress | None = None,
) -> Run:
    """Go on from a checkpoint of `simulate(..., checkpoint=...)` until `duration` [s] after the start of the run.

    The results, the output file among them, are those of a run that was never interrupted, bit for bit; samples after
    the checkpoint are cut off and made again. model: the one the run began with; None: it is made again by its script
    if a model script (load_model, command line) made it. duration: default that of the run; a longer one extends it.
    dt [s]: another largest step from here on, e.g. a shorter one after a failure: then nothing is bit for bit. output:
    where the output file is now, if it was moved. attributes: global ones of the file that are to change. The
    checkpoint is kept up to date as before.

    Raises CaseError for files that are missing, damaged or do not belong together, for another model or version than
    the run's (naming what differs), for a duration that is already exceeded, and for waves that do not last so long.
    """
    saved = checkpoints.read(checkpoint)
    head = saved.header
    duration = positive_seconds("duration", head["given"]["duration"] if duration is None else duration)
    system = as_system(_model_of(saved) if model is None else model)
    checkpoints.require_model(saved, system.model)
    t0, interval, per_output = head["t0"], head["interval"], head["per_output"]
    if dt is not None:
        per_output = max(1, math.ceil(interval / positive_seconds("dt", dt) * (1.0 - 1e-9)))
    h = interval / per_output
    now = saved.take("state", system.initial_state())
    made = saved.take("loop", None)
    if now.x.shape != system.x0.shape or len(now.lam) != system.n_con:
        raise CaseError(f"checkpoint '{saved.path}' belongs to another system than '{system.model.name}'")
    outputs = int(math.floor(duration / interval * (1.0 + 1e-9)))
    if now.t - t0 > duration * (1.0 + 1e-9) or outputs < made["outputs"]:
        raise CaseError(
            f"checkpoint '{saved.path}' is at {now.t - t0:g} s, beyond the duration of {duration:g} s; give a longer "
            "one"
        )
    if system.waves is not None:
        check_waves(system.waves, t0 + duration, h)
    _check_wind(system.model.wind, t0 + duration)
    stepper = Stepper(system, Scheme(*head["scheme"]), head["tolerance"])
    saved.take("stepper", stepper)
    ledger = saved.take("ledger", Ledger(system)) if head["energy"] else None
    stepper.watch = ledger
    channels = head["given"]["channels"]
    sampler = Sampler(system, channels, [ledger] if ledger else [])
    case = {**head["case"], **(attributes or {}), "step": h, "duration": duration}
    asked = head["statistics"]
    tally = saved.take("statistics", Statistics(sampler, StatisticsSettings(**asked))) if asked else None
    place, count = head["output"], made["outputs"] + 1
    store: _Memory | _Nowhere | Writer
    if place is None and output is not None:
        raise CaseError(f"output: the run of checkpoint '{saved.path}' has no output file")
    if not head["keep_series"]:
        store = _Nowhere()
    elif place is None:
        times, rows = saved.take("samples", None)
        if rows.shape[1] != sampler.width:
            raise CaseError(f"checkpoint '{saved.path}' has samples of {rows.shape[1]} values, not {sampler.width}")
        store = _Memory(sampler.width, outputs + 1)
        store.times[:count], store.rows[:count], store.count = times, rows, count
    else:
        place = Path(place) if output is None else Path(output)
        store = Writer.continued(place, sampler.channels, sampler.coordinates, case, head["precision"], outputs + 1,
                                 count, t0 + made["outputs"] * interval)  # fmt: skip
    given = {**head["given"], "duration": duration} | ({} if dt is None else {"dt": float(dt)})
    where = None if place is None else str(place.resolve())
    header = {**head, "case": case, "per_output": per_output, "output": where, "given": given}
    saver = _Saver(saved.path, head["checkpoint_every"], header, now.t)
    loop = _Loop(stepper, now, h, head["step_control"])
    same = h == made["h"] and not head["failure"]
    loop.restore({**made, "h": h} if same else {**made, "h": h, "level": 0, "calm": 0, "made": 0})
    course = _Course(loop, sampler, ledger, tally, store, case, t0, interval, per_output, saver, wall=head["wall_time"])
    return course.run(outputs, progress, bridge=not same and (made["made"] > 0 or bool(head["failure"])))


def _model_of(saved: checkpoints.Saved) -> Model:
    """The model by the script that made it."""
    from floatsim.study.script import load_model

    return load_model(*script_parameters(saved))


def script_parameters(saved: checkpoints.Saved, path: str | None = None) -> tuple[str, dict[str, Any]]:
    """The script that made the model of a checkpoint, or `path`, and its parameters. CaseError if it is not known."""
    script, parameters = saved.header["script"] or ("", {"dict": []})
    if not (path or script):
        raise CaseError(
            f"checkpoint '{saved.path}': its model was made by no script alone; give it as at the start, "
            "from Python: floatsim.resume(checkpoint, model)"
        )
    if not path and not Path(script).is_file():
        raise CaseError(f"checkpoint '{saved.path}': the model script '{script}' is no longer there; say where it is")
    return path or script, checkpoints.unpack(parameters, [], None)


def _script(model: Model) -> Any:
    """Path and parameters of the script that made the model, for JSON; None if there is none, or they are no values."""
    from floatsim.study.script import script_of

    found = script_of(model)
    if found is None:
        return None
    arrays: list[Any] = []
    try:
        packed = checkpoints.pack(found[1], arrays)
    except TypeError:
        return None
    return None if arrays or "holds" in repr(packed) else (found[0], packed)


def _plain(given: Mapping[str, Any]) -> dict[str, Any]:
    """Numbers of NumPy as those of Python, rows as lists."""
    return {
        name: float(value) if is_number(value) else value if value is None or isinstance(value, str) else list(value)
        for name, value in given.items()
    }


class _Saver:
    """Writes checkpoints when they are due: on a grid of `every` seconds from `start` on."""

    def __init__(self, path: Path, every: float, header: dict[str, Any], start: float) -> None:
        self.path, self.every, self.header = path, every, header
        self._start = header["t0"]
        self._count = self._due(start)

    def _due(self, t: float) -> int:
        return int((t - self._start) / self.every * (1.0 + 1e-12) + 1e-9)

    def look(self, course: _Course) -> None:
        """Write one if it is due."""
        count = self._due(course.loop.state.t)
        if count > self._count:
            self._count = count
            self.write(course)

    def write(self, course: _Course, failure: str = "") -> None:
        """One now. A run is not lost for want of room: it is warned of, and the last checkpoint stays."""
        store, loop = course.store, course.loop
        memory: dict[str, Any] = {"state": loop.state, "loop": loop.arrays(), "stepper": course.loop.stepper}
        memory |= {name: item for name, item in course.keeps.items() if item is not None}
        if isinstance(store, Writer):
            store.secure()
        elif isinstance(store, _Memory):
            memory["samples"] = (store.times[: store.count], store.rows[: store.count])
        try:
            checkpoints.write(self.path, {**self.header, "failure": failure, "wall_time": course.wall}, memory)
        except OSError as error:
            text = f"checkpoint '{self.path}' could not be written at t = {loop.state.t:g} s: {error}"
            warnings.warn(f"{text}; the run goes on, the checkpoint before is still valid", stacklevel=2)


class _Course:
    """A run from output to output, begun or resumed. wall [s]: wall time spent before."""

    def __init__(
        self, loop: _Loop, sampler: Sampler, ledger: Ledger | None, tally: Statistics | None,
        store: _Memory | _Nowhere | Writer, case: dict[str, str | int | float], t0: float, interval: float,
        per_output: int, saver: _Saver | None, wall: float = 0.0,
    ) -> None:  # fmt: skip
        self.case, self.tally = case, tally
        self.loop, self.sampler, self.ledger, self.store, self.saver = loop, sampler, ledger, store, saver
        self.t0, self.interval, self.per_output = t0, interval, per_output
        self.keeps = {"ledger": ledger, "statistics": tally}  # what else has a memory that checkpoints keep
        self._wall, self._began = wall, clock.perf_counter()

    @property
    def wall(self) -> float:
        """Wall time until now [s]."""
        return self._wall + clock.perf_counter() - self._began

    def take(self, row: Array) -> None:
        """A sample of now."""
        self.store.append(self.loop.state.t, row)
        if self.tally is not None:
            self.tally.append(self.loop.state.t, row)

    def run(self, outputs: int, progress: Progress | None, first: Array | None = None, bridge: bool = False) -> Run:
        """Go on until `outputs` outputs are made. first: the sample to begin with. bridge: reach the next output from
        where the state stands, in equal steps of h at most."""
        loop, ledger, store, sampler, saver = self.loop, self.ledger, self.store, self.sampler, self.saver
        now, t0, interval = loop.state, self.t0, self.interval
        shown = clock.perf_counter()
        failure = ""
        if saver is not None:
            loop.pause = lambda: saver.look(self)
        try:
            if first is not None:
                self.take(first)
                if saver is not None:
                    saver.write(self)
            while loop.outputs < outputs:
                end = t0 + (loop.outputs + 1) * interval
                try:
                    if bridge:
                        failure, bridge = loop.bridge(end), False
                    else:
                        failure = loop.advance(self.per_output, t0 + loop.outputs * interval)
                except ModelError as error:  # a motion that fails on its way
                    failure = f"at t = {now.t:.6g} s: {error}"
                if failure:
                    break
                now.t = end
                self.take(sampler.sample(loop.stepper.work, loop.iterations_of_last, loop.last_step))
                if saver is not None:
                    saver.look(self)
                if progress is not None and clock.perf_counter() - shown > 0.1:
                    shown = clock.perf_counter()
                    progress(now.t - t0, loop.iterations)
            if saver is not None:
                saver.write(self, failure)
            store.close("failed" if failure else "done", failure, ledger.result().attributes() if ledger else None)
        except BaseException as error:
            said = "interrupted" if isinstance(error, KeyboardInterrupt) else f"{type(error).__name__}: {error}"
            store.close("failed", f"at t = {now.t:.6g} s: {said}")
            raise
        path: Path | None = None
        times: Array
        if isinstance(store, _Memory):
            times, rows = store.times[: store.count], store.rows[: store.count]
        else:
            path, rows = getattr(store, "path", None), np.zeros((0, sampler.width))
            times = np.asarray(t0 + interval * np.arange(loop.outputs + 1), dtype=np.float64)
        status: Literal["done", "failed"] = "failed" if failure else "done"
        about = {**self.case, "status": status, "failure": failure, **(ledger.result().attributes() if ledger else {})}
        if self.tally is not None:
            counts = {"steps": loop.steps, "cut_steps": loop.cuts, "newton_iterations": loop.iterations}
            self.tally.attributes = {**about, **counts}
        return Run(status, failure, now, loop.steps, loop.cuts, loop.iterations, self.wall, path, times, rows, sampler,
                   ledger.result() if ledger else None, self.tally, about, not isinstance(store, _Nowhere))  # fmt: skip


def _check_kept(keep_series: Any, output: Any) -> None:
    """Refuse a file that nothing would be written to."""
    if not isinstance(keep_series, bool | np.bool_):
        raise CaseError(f"keep_series: got {keep_series!r}; must be True or False")
    if not keep_series and output is not None:
        raise CaseError(f"output: got '{output}', but keep_series=False keeps nothing to write there; leave one out")


def check_waves(waves: Realisation, duration: float, h: float) -> None:
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


def _check_wind(wind: Any, duration: float) -> None:
    """Refuse a run longer than its turbulence."""
    if wind is not None and duration > wind.duration * (1.0 + 1e-9):
        raise CaseError(
            f"the run ends at {duration:g} s, but the turbulence of the wind is only known not to repeat until "
            f"{wind.duration:g} s; Kaimal takes a longer duration"
        )


def seed_of(waves: Any) -> dict[str, int]:
    """The seed of the waves as an attribute of the output, if they have one."""
    seed = getattr(waves, "seed", None)
    return {} if seed is None else {"seed": int(seed)}


def wind_of(wind: Any) -> dict[str, int | float]:
    """What the head of the output says of the wind, if there is one."""
    if wind is None:
        return {}
    seed = {f"wind_{name}": value for name, value in seed_of(wind.turbulence).items()}
    return {"mean_wind_speed": wind.speed, "wind_heading_deg": wind.heading_deg, **seed}


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


class _Nowhere:
    """Results that are not kept, with the face of a Writer."""

    def append(self, time: float, values: Array) -> None:
        """Not kept."""

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
        self.made = 0  # steps of h since the last output
        self.iterations_of_last = 0
        self.last_step = h
        self.pause: Callable[[], None] | None = None  # called between steps, where no output is

    _KEPT = ("h", "level", "calm", "steps", "cuts", "iterations", "outputs", "made", "iterations_of_last", "last_step")

    def arrays(self) -> dict[str, Any]:
        """Its place and counters, for a checkpoint."""
        return {name: getattr(self, name) for name in self._KEPT}

    def restore(self, arrays: Mapping[str, Any]) -> None:
        """Go on at the place of `arrays`."""
        for name in self._KEPT:
            setattr(self, name, arrays[name])

    def advance(self, count: int, t: float) -> str:
        """What is left of `count` steps of h from time t; the reason if it fails, else ''."""
        if self.made == 0:
            self.iterations_of_last = 0
        for k in range(self.made, count):
            reason = self._fill()
            if reason:
                return f"at t = {self.state.t:.6g} s: {reason}"
            self.state.t = t + (k + 1) * self.h
            self.state.pace = self.h / 2**self.level, self.calm
            self.made = k + 1
            if self.pause is not None and self.made < count:
                self.pause()
        self.made = 0
        self.outputs += 1
        return ""

    def bridge(self, end: float) -> str:
        """From anywhere to the next output at `end` [s], in equal steps of at most h; the reason if it fails."""
        h, pause, start = self.h, self.pause, self.state.t
        count = max(1, math.ceil((end - start) / h * (1.0 - 1e-9)))
        self.h, self.pause, self.made = (end - start) / count, None, 0
        try:
            return self.advance(count, start)
        finally:
            self.h, self.pause = h, pause

    def _fill(self) -> str:
        """One step of h, in pieces if need be."""
        done = 0  # pieces of h / 2^level
        while done < 2**self.level:
            piece = self.h / 2**self.level
            until = self.stepper.system.next_event(self.state) - self.state.t
            if _INSTANT * piece < until < (1.0 - _INSTANT) * piece:
                reason = self._through(until, piece - until)
                if reason:
                    return reason
                done += 1
                continue
            report = self._step(piece, (1.0 if self.level < MAX_ERROR_CUTS else math.inf) if self.control else None)
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

    def _through(self, *parts: float) -> str:
        """Steps that meet at an event, each in pieces if need be. What comes next starts afresh: after steps that may
        be as short as one likes, accelerations are not what they were extrapolated to."""
        for part in parts:
            count, done = 1, 0
            while done < count:
                report = self._step(part / count, math.inf if self.control else None)
                if report.converged:
                    self.steps, done = self.steps + 1, done + 1
                elif count < 2**MAX_CUTS:
                    self.cuts, count, done = self.cuts + 1, 2 * count, 2 * done
                else:
                    return f"a step of {part / count:.3g} s still fails: {report.reason}"
            self.state.step = 0.0
        return ""

    def _step(self, h: float, allowed: float | None) -> StepReport:
        report = self.stepper.step(self.state, h, allowed)
        self.iterations += report.iterations
        self.iterations_of_last += report.iterations
        self.last_step = report.step
        return report


def run_or_raise(run: Run) -> Run:
    """The run if it is done. Raises SolveFailed with its reason and last good state otherwise."""
    if run.status == "failed":
        raise SolveFailed(run.failure, run, run.state)
    return run
