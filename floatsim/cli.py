"""The command line: thin. Exit status 0 done, 1 a run failed, 2 bad input; a traceback is a bug."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

import floatsim
from floatsim.cases.commands import app as cases
from floatsim.errors import CaseError, FloatsimError, ModelError, SolveFailed

app = typer.Typer(
    name="floatsim", no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False,
    help="Dynamics of floating wind turbines, wave-energy converters and their moorings and power cables.",
)  # fmt: skip

hydro = typer.Typer(
    no_args_is_help=True,
    help="Hydrodynamic databases of floaters: compute, check, draw, convert. FILE is netCDF of floatsim or Capytaine, "
    "HDF5 of BEMIO, a folder of Nemoh or HAMS, or name.1 of WAMIT.",
)  # fmt: skip
app.add_typer(hydro, name="hydro")
app.add_typer(cases, name="cases")

Script = Annotated[
    str, typer.Argument(metavar="MODEL.py", help="Python file with build(**parameters), or a MoorDyn file.")
]
Parameters = Annotated[list[str], typer.Option("-p", metavar="NAME=VALUE", help="Parameter of build(); repeatable.")]
MODES_LIMIT = 2000  # unknowns up to which `static` looks at stability: dense eigenvalues
OUTPUT_HELP = "netCDF file to write."
Coefficients = Annotated[str, typer.Argument(metavar="FILE", help="File or folder; the format is recognised.")]
Lacking = Annotated[
    list[str],
    typer.Option("-p", metavar="NAME=VALUE", help="What the format does not contain, as depth=200; repeatable."),
]


def _console() -> Any:
    from rich.console import Console

    return Console(highlight=False, markup=False, soft_wrap=not sys.stdout.isatty())


def _table(title: str, columns: list[str], rows: list[list[str]], prose: bool = False) -> Any:
    from rich.box import SIMPLE
    from rich.table import Table
    from rich.text import Text

    # plain text: [m] is a unit, not markup
    table = Table(title=Text(title), title_justify="left", box=SIMPLE, pad_edge=False)
    for k, column in enumerate(columns):
        table.add_column(Text(column), justify="left" if k == 0 or prose else "right", overflow="fold")
    for row in rows:
        table.add_row(*map(Text, row))
    return table


def _load(script: str, parameters: list[str] | dict[str, Any], **case: Any) -> tuple[Any, dict[str, Any]]:
    """(system, attributes for the output file); warnings go to stderr. case: what else a result depends on."""
    from floatsim.jit import cache_is_cold
    from floatsim.study.script import input_hash, load_model, parse_parameters
    from floatsim.study.sheet import cautions

    values = parameters if isinstance(parameters, dict) else parse_parameters(parameters)
    cold = cache_is_cold()  # building a model may compile a kernel or two
    model = load_model(script, values)
    if cold:
        said = "floatsim: compiling its kernels, once for this version on this machine (up to a minute) ..."
        typer.echo(said, err=True)
    system = floatsim.assemble(model)
    for line in cautions(system):
        typer.echo(f"warning: {line}", err=True)
    attributes = {
        "model_script": Path(script).name,
        "model_parameters": repr(values),
        "floatsim_version": floatsim.__version__,
        "input_hash": input_hash(script, values, case, model),
    }
    return system, attributes


def _writable(output: str | None) -> None:
    """An output file that cannot be written is said before anything is computed."""
    if output is not None:
        from floatsim.study.store import check_path

        check_path(output)


class _Bar:
    """Progress on a terminal: simulated time, real-time factor, Newton iterations. Nothing elsewhere."""

    def __init__(self, duration: float | None) -> None:
        from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

        self.duration = duration
        self.bar = Progress(
            TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[note]}"), TimeRemainingColumn(),
            disable=not sys.stderr.isatty(), transient=True, console=_stderr(),
        )  # fmt: skip

    def __enter__(self) -> Callable[[float, int], None]:
        import time

        self.bar.start()
        task = self.bar.add_task("running", total=self.duration, note="")
        began = time.perf_counter()

        def show(t: float, iterations: int) -> None:
            factor = t / max(time.perf_counter() - began, 1e-9)
            whole = "" if self.duration is None else f" of {self.duration:g}"
            note = f"{t:.1f}{whole} s, {factor:.0f} x real time, {iterations} Newton iterations"
            self.bar.update(task, completed=t, note=note)

        return show

    def __exit__(self, *args: object) -> None:
        self.bar.stop()


def _stderr() -> Any:
    from rich.console import Console

    return Console(stderr=True)


def _version(value: bool) -> None:
    if value:
        typer.echo(f"floatsim {floatsim.__version__}")
        raise typer.Exit()


@app.callback()
def common(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    """Dynamics of floating wind turbines, wave-energy converters and their moorings and power cables."""


@app.command()
def check(script: Script, p: Parameters = []) -> None:  # noqa: B006
    """Problems, equilibrium sheet, hydrodynamic checks and the table of unknowns."""
    from floatsim.study.script import load_deck, parse_parameters
    from floatsim.study.sheet import body_sheets, database_findings, dof_table, line_notes, memory_notes

    system, _ = _load(script, p)
    model, console = system.model, _console()
    console.print(f"model '{model.name}': no problems in {len(model.parts)} parts and {len(model.joints)} joints")
    if Path(script).suffix != ".py":
        deck = load_deck(script, parse_parameters(p))
        for title, sentences in (("not understood", deck.not_understood), ("converted", deck.notes)):
            console.print(f"{title}:" if sentences else f"{title}: nothing")
            for sentence in sentences:
                console.print(f"  {sentence}")
    for sheet in body_sheets(system):
        f, m, a = sheet.net_force, sheet.net_moment, sheet.attached
        rows = [
            ["weight [kN]", "", "", f"{-sheet.weight / 1e3:.2f}"],
            ["buoyancy [kN]", "", "", f"{sheet.buoyancy / 1e3:.2f}"],
            ["lines, joints, springs, current, wind [kN]", *(f"{y / 1e3:.2f}" for y in a)],
            ["net force [kN]", *(f"{y / 1e3:.2f}" for y in f)],
            ["net moment [kN m]", *(f"{y / 1e3:.2f}" for y in m)],
        ]
        console.print(_table(f"equilibrium sheet of '{sheet.name}' at its drawing position", ["", "x", "y", "z"], rows))
        if sheet.heave == sheet.heave:
            console.print(
                f"expected heave {sheet.heave:+.3f} m (draught {-sheet.heave:+.3f} m); stiffness with weight: roll "
                f"{sheet.stiffness_roll:.4g}, pitch {sheet.stiffness_pitch:.4g} N m/rad"
            )
    findings = database_findings(model)
    if findings:
        rows = [[f"{body}: {f.quantity}", f.severity, f.message] for body, f in findings]
        console.print(_table("hydrodynamic database", ["quantity", "verdict", "what was found"], rows))
    for note in [*memory_notes(system), *line_notes(model)]:
        console.print(note)
    rows = [[name, kind, str(a), str(b)] for name, kind, a, b in dof_table(system)]
    console.print(_table("unknowns", ["name", "kind", "points or rows", "rotations"], rows))
    console.print(f"{3 * (system.n_point + system.n_rotation)} degrees of freedom, {system.n_con} constraint rows")
    if any(f.severity == "error" for _, f in findings):
        raise ModelError("the hydrodynamic database has errors, see above")


@app.command()
def static(
    script: Script, p: Parameters = [], output: Annotated[str | None, typer.Option("-o", help=OUTPUT_HELP)] = None  # noqa: B006
) -> None:
    """Static equilibrium: positions, end forces, unbalanced forces."""
    from floatsim.study.report import static_tables, write_state

    _writable(output)
    system, attributes = _load(script, p, command="static")
    state, report = floatsim.solve_static(system)
    attributes = {"title": system.model.name, "water_depth": system.model.sea.depth, **attributes}
    if output is not None:
        write_state(system, state, output, attributes)
    console = _console()
    for title, columns, rows in static_tables(system, state):
        console.print(_table(title, columns, rows))
    console.print(
        f"converged in {report.iterations} iterations; largest unbalanced force {report.residual_force:.2g} N "
        f"({report.worst}), moment {report.residual_moment:.2g} N m"
    )
    if system.n_dof > MODES_LIMIT:
        console.print(f"stability not looked at: more than {MODES_LIMIT} unknowns")
        return
    try:
        floatsim.natural_modes(system, state, count=1)
    except SolveFailed as error:
        typer.echo(f"warning: {error}", err=True)


@app.command()
def modes(
    script: Script, p: Parameters = [], count: Annotated[int, typer.Option(help="How many, slowest first.")] = 12  # noqa: B006
) -> None:
    """Natural periods, radiation damping and shapes of the moored system about its equilibrium."""
    system, _ = _load(script, p)
    found = floatsim.natural_modes(system, count=count)
    rows = [[mode.label, f"{mode.period:.3f}", f"{100.0 * mode.damping_ratio:.3f}"] for mode in found]
    _console().print(_table("natural modes", ["shape (share of kinetic energy)", "period [s]", "radiation [%]"], rows))
    _console().print("damping is that of radiation alone: drag, PTOs and a rotor's wind and controller are left out")


@app.command()
def decay(
    script: Script,
    dof: Annotated[str, typer.Option(help="surge, sway, heave, roll, pitch or yaw.")],
    offset: Annotated[
        float, typer.Option(help="From equilibrium: METRES for surge, sway, heave; DEGREES for roll, pitch, yaw.")
    ],
    p: Parameters = [],  # noqa: B006
    output: Annotated[str | None, typer.Option("-o", help=OUTPUT_HELP)] = None,
    body: Annotated[str | None, typer.Option(help="Body to release, if there are several.")] = None,
    release: Annotated[
        str, typer.Option(help="'equilibrium' plus the offset, or 'absolute': drawing position plus it.")
    ] = "equilibrium",
    duration: Annotated[float | None, typer.Option(help="Seconds; default eight natural periods.")] = None,
    dt: Annotated[float, typer.Option(help="Time step, seconds.")] = 0.1,
) -> None:
    """Decay test: natural period, linear and quadratic damping.

    The body is released at rest from its equilibrium plus OFFSET in one degree of freedom, everything else in static
    equilibrium with it. OFFSET is in metres for surge, sway, heave and in degrees for roll, pitch, yaw.
    """
    from floatsim.study.report import decay_tables

    _writable(output)
    system, attributes = _load(script, p, command="decay", dof=dof, offset=offset, body=body, release=release,
                               duration=duration, dt=dt)  # fmt: skip
    with _Bar(duration) as show:
        result = floatsim.decay_test(
            system, dof, offset, body=body, release=release, duration=duration, dt=dt, output=output,  # type: ignore[arg-type]
            attributes=attributes, progress=show,
        )  # fmt: skip
    console = _console()
    for title, columns, rows in decay_tables(result):
        console.print(_table(title, columns, rows))
    _say_run(console, result.run)


@app.command()
def run(
    script: Script,
    duration: Annotated[float, typer.Option(help="Seconds to simulate.")],
    p: Parameters = [],  # noqa: B006
    output: Annotated[str, typer.Option("-o", help=OUTPUT_HELP)] = "out.nc",
    dt: Annotated[float, typer.Option(help="Largest time step, seconds.")] = 0.1,
    interval: Annotated[float | None, typer.Option(help="Seconds between outputs; default dt.")] = None,
    channel: Annotated[list[str], typer.Option(help="Keep this channel only; repeatable.")] = [],  # noqa: B006
    precision: Annotated[str, typer.Option(help="float64 or float32.")] = "float64",
    energy: Annotated[bool, typer.Option("--energy", help="Keep books of all work and stored energy.")] = False,
    hs: Annotated[float | None, typer.Option(help="Significant height of a JONSWAP sea, with --tp.")] = None,
    tp: Annotated[float | None, typer.Option(help="Its peak period, seconds.")] = None,
    height: Annotated[float | None, typer.Option(help="Height of a regular wave, metres, with --period.")] = None,
    period: Annotated[float | None, typer.Option(help="Its period, seconds.")] = None,
    heading: Annotated[float, typer.Option(help="Direction these waves travel towards, DEGREES from x.")] = 0.0,
    seed: Annotated[int, typer.Option(help="Of the sea's phases.")] = 1,
    checkpoint: Annotated[
        str | None, typer.Option(metavar="FILE", help="Keep a checkpoint in FILE, for `floatsim resume`.")
    ] = None,
    checkpoint_every: Annotated[float, typer.Option(help="Simulated seconds between checkpoints.")] = 600.0,
) -> None:
    """Simulate from the static equilibrium and write a netCDF file.

    Waves given here replace those of the model.
    """
    from floatsim.study.script import WAVES, parse_parameters, waves_of

    _writable(output)
    values = parse_parameters(p)
    waves: dict[str, Any] = {"hs": hs, "tp": tp, "height": height, "period": period, "heading": heading, "seed": seed,
                             "duration": duration}  # fmt: skip
    if waves_of(**waves) is not None:
        values[WAVES] = waves
    system, attributes = _load(script, values, command="run", duration=duration, dt=dt, interval=interval,
                               channels=channel, precision=precision, energy=energy)  # fmt: skip
    with _Bar(duration) as show:
        result = floatsim.simulate(
            system, duration, dt, output=output, interval=interval, channels=channel or "all",
            precision=precision, attributes=attributes, progress=show, energy=energy,  # type: ignore[arg-type]
            checkpoint=checkpoint, checkpoint_every=checkpoint_every,
        )  # fmt: skip
    _say_end(result)


@app.command()
def resume(
    file: Annotated[str, typer.Argument(metavar="FILE", help="Checkpoint of `floatsim run --checkpoint FILE`.")],
    duration: Annotated[
        float | None, typer.Option(help="Seconds from the start of the run; more than before extends it.")
    ] = None,
    model: Annotated[str | None, typer.Option(metavar="MODEL.py", help="Where its script is now, if moved.")] = None,
    p: Parameters = [],  # noqa: B006
    dt: Annotated[float | None, typer.Option(help="Another largest time step from here on, seconds.")] = None,
    output: Annotated[str | None, typer.Option("-o", help="Where its netCDF file is now, if moved.")] = None,
) -> None:
    """Go on from a checkpoint: the results are those of a run that was never interrupted."""
    from floatsim.study.checkpoint import read
    from floatsim.study.script import parse_parameters
    from floatsim.study.simulate import resume as go_on
    from floatsim.study.simulate import script_parameters

    saved = read(file)
    path, values = script_parameters(saved, model)
    head = saved.header
    given = {**head["given"]} | {k: v for k, v in (("duration", duration), ("dt", dt)) if v is not None}
    channels = [] if given["channels"] == "all" else given["channels"]
    values = {**values, **parse_parameters(p)}
    system, attributes = _load(path, values, command="run", **{**given, "channels": channels},
                               precision=head["precision"], energy=head["energy"])  # fmt: skip
    with _Bar(given["duration"]) as show:
        result = go_on(file, system, duration, dt=dt, output=output, progress=show,
                       attributes=attributes if "input_hash" in head["case"] else None)  # fmt: skip
    _say_end(result)


def _say_end(result: Any) -> None:
    """How a run went. SolveFailed if it failed."""
    from floatsim.study.report import pto_tables

    _say_run(_console(), result)
    for title, columns, rows in pto_tables(result):
        _console().print(_table(title, columns, rows))
    if result.energy is not None:
        _console().print(result.energy.summary())
    if result.status == "failed":
        raise SolveFailed(f"run failed {result.failure}")


def _numbers(option: str, text: str | None) -> list[float]:
    """The numbers of a list such as 1,2.5,4."""
    try:
        return [] if text is None else [float(word) for word in text.split(",")]
    except ValueError:
        raise CaseError(f"{option}: got '{text}'; must be numbers with commas between them, e.g. 1,2.5,4") from None


def _write(data: Any, path: str, attributes: dict[str, Any]) -> None:
    """A dataset with the attributes of its input as a netCDF file."""
    data.attrs.update(attributes)
    try:
        data.to_netcdf(path)
    except OSError as error:
        raise CaseError(f"output file '{path}' cannot be written: {error}") from None
    typer.echo(f"wrote {path}")


@app.command()
def rao(
    script: Script,
    p: Parameters = [],  # noqa: B006
    heading: Annotated[float, typer.Option(help="Direction waves travel towards, DEGREES from x.")] = 0.0,
    hs: Annotated[float | None, typer.Option(help="Significant height of a JONSWAP sea, with --tp.")] = None,
    tp: Annotated[float | None, typer.Option(help="Its peak period, seconds.")] = None,
    omega: Annotated[
        str | None, typer.Option(metavar="W1,W2,...", help="Frequencies, rad/s; default those of the database.")
    ] = None,
    output: Annotated[str | None, typer.Option("-o", help=OUTPUT_HELP)] = None,
) -> None:
    """Responses to small waves about the equilibrium, in the frequency domain.

    With a sea (--hs, --tp) drag is linearised in it, and standard deviations are shown. The file has amplitude and
    phase of every output of a run.
    """
    from floatsim.study.report import rao_tables

    _writable(output)
    if (hs is None) != (tp is None):
        raise CaseError("--hs and --tp describe a sea together; give both or none")
    sea = None if hs is None or tp is None else floatsim.Jonswap(hs=hs, tp=tp)
    system, attributes = _load(script, p, command="rao", heading=heading, hs=hs, tp=tp, omega=omega)
    response = floatsim.frequency_response(
        system, _numbers("--omega", omega) or None, heading_deg=heading, spectrum=sea
    )
    console = _console()
    for title, columns, rows in rao_tables(response):
        console.print(_table(title, columns, rows))
    if output is not None:
        _write(response.dataset(), output, attributes)


@app.command()
def power(
    script: Script,
    p: Parameters = [],  # noqa: B006
    hs: Annotated[str | None, typer.Option(metavar="H1,H2,...", help="Significant wave heights, metres.")] = None,
    tp: Annotated[str | None, typer.Option(metavar="T1,T2,...", help="Peak periods, seconds.")] = None,
    occurrence: Annotated[
        str | None, typer.Option(metavar="FILE.csv", help="Scatter table: a first line with every tp, then lines of hs "
                                 "and shares of the year. Gives the annual energy, and hs and tp unless said.")
    ] = None,
    duration: Annotated[float, typer.Option(help="Seconds over which power is averaged.")] = 1800.0,
    start: Annotated[float, typer.Option(help="Seconds before that: ramp and transients.")] = 200.0,
    dt: Annotated[float, typer.Option(help="Time step, seconds.")] = 0.1,
    seed: Annotated[int, typer.Option(help="Of the first cell; each has its own.")] = 1,
    heading: Annotated[float, typer.Option(help="Direction waves travel towards, DEGREES from x.")] = 0.0,
    output: Annotated[str | None, typer.Option("-o", help=OUTPUT_HELP)] = None,
) -> None:
    """Power matrix: mean absorbed power of all PTOs in every sea state (JONSWAP), one run a cell, and annual energy."""
    from floatsim.study.power_matrix import power_matrix, read_occurrence
    from floatsim.study.report import power_tables

    _writable(output)
    heights, periods, share = _numbers("--hs", hs), _numbers("--tp", tp), None
    if occurrence is not None:
        rows, columns, share = read_occurrence(occurrence)
        heights, periods = heights or rows.tolist(), periods or columns.tolist()
        if heights != rows.tolist() or periods != columns.tolist():
            raise CaseError(f"--hs and --tp are not those of '{occurrence}'; leave them out")
    if not heights or not periods:
        raise CaseError("power: give --hs and --tp, or --occurrence")
    case = {"hs": heights, "tp": periods, "duration": duration, "start": start, "dt": dt, "seed": seed,
            "heading": heading, "occurrence": None if share is None else share.tolist()}  # fmt: skip
    system, attributes = _load(script, p, command="power", **case)
    with _Bar(None) as show:
        matrix = power_matrix(
            system.model, heights, periods, occurrence=share, duration=duration, start=start, dt=dt, seed=seed,
            heading_deg=heading, progress=lambda done, of: show(done * (start + duration), 0),
        )  # fmt: skip
    console = _console()
    for title, names, cells in power_tables(matrix):
        console.print(_table(title, names, cells))
    if share is not None and not matrix.failures:
        console.print(f"energy of a year: {matrix.annual_energy / 3.6e9:.4g} MWh")
    if output is not None:
        _write(matrix.dataset(), output, attributes)
    if matrix.failures:
        (h, t), reason = next(iter(matrix.failures.items()))
        raise SolveFailed(f"{len(matrix.failures)} sea states, the first is hs {h:g} m, tp {t:g} s: {reason}")


@app.command()
def stats(
    file: Annotated[str, typer.Argument(metavar="OUT.nc", help="Result file.")],
    start: Annotated[float, typer.Option(help="Leave out what is before this simulated time [s].")] = 0.0,
    fatigue: Annotated[
        list[str], typer.Option(metavar="CHANNEL=M", help="Damage-equivalent load, exponent M; repeatable.")
    ] = [],  # noqa: B006
    block: Annotated[float, typer.Option(help="Length of the blocks of which extremes are taken [s].")] = 600.0,
    output: Annotated[str | None, typer.Option("-o", help=OUTPUT_HELP)] = None,
) -> None:
    """Mean, standard deviation, extremes and periods of the channels of a result file, and fatigue loads."""
    from floatsim.study.script import parse_parameters
    from floatsim.study.statistics import statistics

    result = statistics(file, start, parse_parameters(fatigue), block)
    if output is not None:
        typer.echo(f"wrote {result.write(output)}")
        return
    _console().print(_table(f"{file}, {result.samples} samples", *result.table()))


@app.command()
def plot(
    file: Annotated[str, typer.Argument(metavar="OUT.nc", help="Result file.")],
    output: Annotated[str | None, typer.Option("-o", help="PNG file; default: beside the results.")] = None,
    line: Annotated[str | None, typer.Option(help="Draw this line only, with all that is known along it.")] = None,
    between: Annotated[
        tuple[float, float] | None, typer.Option("--range", help="Draw the run between START and END [s].",
                                                 metavar="START END")
    ] = None,
) -> None:
    """Draw motions, lines and solver history of a result file.

    Lines are drawn over the seabed and along their length; runs show the mean with a band from the smallest to the
    largest value.
    """
    from floatsim.study.plot import plot_file

    target = output or str(Path(file).with_suffix(".png"))
    start, end = between or (None, None)
    plot_file(file, target, line, start, end)
    typer.echo(f"wrote {target}")


def _hydro(file: str, p: list[str]) -> Any:
    from floatsim.hydro.read import read_hydro
    from floatsim.study.script import parse_parameters

    return read_hydro(file, **parse_parameters(p))


@hydro.command("check")
def hydro_check(file: Coefficients, p: Lacking = []) -> None:  # noqa: B006
    """Does a database make sense? Symmetry, energy, long waves, Kramers-Kronig, frequencies and headings."""
    from floatsim.hydro.check import check_database
    from floatsim.study.hydro_report import check_table, summary_table, verdict

    db, console = _hydro(file, p), _console()
    findings = check_database(db)
    for title, columns, rows in (summary_table(db), check_table(db, findings)):
        console.print(_table(title, columns, rows, prose=True))
    console.print(verdict(findings))
    if any(finding.severity == "error" for finding in findings):
        raise ModelError(f"'{file}' has errors, see above")


@hydro.command("plot")
def hydro_plot(
    file: Coefficients, p: Lacking = [],  # noqa: B006
    output: Annotated[str | None, typer.Option("-o", help="Picture; default: FILE.png.")] = None,
) -> None:  # fmt: skip
    """Draw added mass, damping, excitation and radiation memory of every body."""
    from floatsim.study.hydro_report import plot_database

    target = output or f"{str(file).rstrip('/')}.png"
    plot_database(_hydro(file, p), target)
    typer.echo(f"wrote {target}")


@hydro.command("convert")
def hydro_convert(
    file: Coefficients, output: Annotated[str, typer.Option("-o", help=OUTPUT_HELP)], p: Lacking = []  # noqa: B006
) -> None:
    """Write a database as floatsim's netCDF, in its conventions. What the checks find is said, but does not stop it."""
    from floatsim.hydro.check import check_database

    _writable(output)
    db = _hydro(file, p)
    for finding in check_database(db):
        if finding.severity != "ok":
            typer.echo(f"warning: {finding.quantity}: {finding.message}", err=True)
    db.write(output)
    typer.echo(f"wrote {output}")


@hydro.command("compute")
def hydro_compute(
    script: Script,
    p: Parameters = [],  # noqa: B006
    output: Annotated[str | None, typer.Option("-o", help="Database (netCDF) to write.")] = None,
    omega: Annotated[
        str, typer.Option(metavar="START:END:STEP", help="Frequencies in rad/s; or values parted by commas.")
    ] = "0.05:3:0.05",
    headings: Annotated[
        str, typer.Option(metavar="START:END:STEP", help="Towards which waves travel: DEGREES from the drawn heading.")
    ] = "0:350:10",
    nemoh: Annotated[str | None, typer.Option(help="Folder to write for Nemoh, to be run elsewhere, instead.")] = None,
    body: Annotated[list[str], typer.Option(help="Body to compute; repeatable. Default: all that have a Hull.")] = [],  # noqa: B006
) -> None:
    """Compute the database of the bodies that have a Hull, with Capytaine, at their static position.

    Statics with everything in the model find where the bodies float; their meshes are cut at the waterline and covered
    by lids. The database carries its pose.
    """
    from floatsim.study.hydro_compute import compute_command
    from floatsim.study.script import load_model, parse_parameters

    values, live = parse_parameters(p), sys.stderr.isatty()

    def report(line: str) -> None:
        progress = line[:1].isdigit()
        typer.echo(f"\r{line}   " if progress and live else line if progress else f"warning: {line}",
                   nl=not (progress and live), err=True)  # fmt: skip

    compute_command(lambda: load_model(script, values), omega, headings, output, nemoh, body, report)
    if nemoh is not None:
        typer.echo(f"wrote {nemoh}: run Nemoh there, then read its results with 'floatsim hydro convert {nemoh}'")


def _say_run(console: Any, result: Any) -> None:
    factor = result.simulated_time / result.wall_time if result.wall_time > 0.0 else float("inf")
    console.print(
        f"{result.status}: {result.simulated_time:g} s in {result.wall_time:.2f} s ({factor:.0f} x real time), "
        f"{result.steps} steps, {result.cut_steps} cut, {result.newton_iterations} Newton iterations"
        + (f", results in {result.path}" if result.path else "")
    )


def main() -> None:
    """Entry point: floatsim's own errors become one message each and an exit status."""
    try:
        status = app(standalone_mode=False)
        if status == 130:  # the option parser's own answer to an interrupt
            raise KeyboardInterrupt
    except (ModelError, CaseError) as error:
        for line in error.problems:
            typer.echo(f"error: {line}", err=True)
        sys.exit(2)
    except FloatsimError as error:
        typer.echo(f"failed: {error}", err=True)
        sys.exit(1)
    except (KeyboardInterrupt, typer.Abort):
        typer.echo("interrupted", err=True)
        sys.exit(130)
    except BrokenPipeError:  # the reader of our output has gone, as in `floatsim check ... | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except Exception as error:
        if hasattr(error, "format_message") and hasattr(error, "exit_code"):  # usage errors of the option parser
            said = error.format_message()  # empty when the help has been shown instead
            if said:
                typer.echo(f"error: {said}", err=True)
            sys.exit(2)
        from floatsim.study.script import blamed

        said = blamed(error)
        if said is None:
            raise
        typer.echo(f"error: {said}", err=True)
        sys.exit(2)
    sys.exit(status if isinstance(status, int) else 0)
