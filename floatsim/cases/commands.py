"""`floatsim cases ...`: list, run, rerun, status, collect, report, template. Thin; exit status as everywhere: 0 all
done, 1 some cases failed, 2 bad input."""

from __future__ import annotations

import sys
import time as clock
from pathlib import Path
from typing import Annotated, Any

import typer

from floatsim.errors import CaseError

app = typer.Typer(
    no_args_is_help=True,
    help="Matrices of load cases: list what a YAML file describes, run it on all cores or a cluster, stop and go on, "
    "collect one data set, report. Templates to start from: floatsim cases template.",
)

Matrix = Annotated[str, typer.Argument(metavar="MATRIX.yaml", help="Description of the cases.")]
Place = Annotated[
    str, typer.Argument(metavar="MATRIX.yaml", help="Description of the cases, or their results folder itself.")
]
Output = Annotated[
    str | None, typer.Option("--output", "-o", metavar="FOLDER", help="Results folder; default: beside MATRIX.yaml, "
                             "named by it.")
]  # fmt: skip
Only = Annotated[
    list[str], typer.Option("--only", metavar="NAME=VALUE,...", help="Cases in which a variable has one of these "
                            "values; repeatable.")
]  # fmt: skip
Sample = Annotated[int | None, typer.Option(help="So many cases only, spread evenly over the variables.")]
Jobs = Annotated[int | None, typer.Option("--jobs", "-j", help="Processes on this machine; default one for each core.")]
Scheduler = Annotated[str | None, typer.Option(metavar="ADDRESS", help="Of a Dask scheduler to run on, tcp://...:8786.")]
ClusterFile = Annotated[
    str | None, typer.Option("--cluster", metavar="CLUSTER.yaml", help="Dask cluster to start and run on: kind (slurm, "
                             "pbs, ...), jobs, options.")
]  # fmt: skip
TimeLimit = Annotated[
    float | None, typer.Option(help="Seconds of wall clock for each case, instead of the matrix's own.")
]
NONE: list[str] = []


def _folder(place: str, output: str | None) -> Path:
    """The results folder that is meant."""
    if output is not None:
        return Path(output)
    if Path(place).is_dir():
        return Path(place)
    from floatsim.cases.matrix import read_matrix

    return read_matrix(place, check=False).results


def _building() -> Any:
    """Says on a terminal how far the check of a matrix is."""

    def show(done: int, of: int) -> None:
        if sys.stderr.isatty():
            typer.echo(f"\rchecking {done} of {of} distinct cases{chr(10) if done == of else ''}", err=True, nl=False)

    return show


@app.command("list")
def list_cases(
    matrix: Matrix, only: Only = NONE, sample: Sample = None,
    csv: Annotated[str | None, typer.Option(metavar="FILE.csv", help="Write all cases with all variables.")] = None,
    check: Annotated[bool, typer.Option(help="Build every distinct model and look for problems.")] = True,
) -> None:  # fmt: skip
    """What a matrix contains, and what is wrong with it, before anything runs."""
    from floatsim.cases import listing

    listing.list_cases(matrix, only=only, sample=sample, csv=csv, check=check, progress=_building())


def _run(matrix: str, output: str | None, only: list[str], sample: int | None, jobs: int | None, scheduler: str | None,
         cluster: str | None, time_limit: float | None, again: bool) -> None:  # fmt: skip
    from floatsim.cases.check import check_matrix
    from floatsim.cases.choice import chosen, parse_only
    from floatsim.cases.cluster import read_description
    from floatsim.cases.matrix import read_matrix
    from floatsim.cases.runner import in_words, run, standing

    description = None if cluster is None else read_description(cluster)
    read = read_matrix(matrix, check=False)
    part = chosen(read, parse_only(only), sample)
    check_matrix(part, _building())
    folder = Path(output) if output is not None else read.results
    try:
        summary = run(
            read.cases, folder, name=read.name, path=str(read.path.resolve()), units=read.units, jobs=jobs,
            scheduler=scheduler, cluster=description, chosen=part.cases, again=again, time_limit=time_limit,
        )  # fmt: skip
    except KeyboardInterrupt:
        left = standing(read.cases, folder)
        typer.echo(f"stopped; {left.done} of {left.cases} cases are done and kept, the same command goes on", err=True)
        raise
    for line in summary.lines():
        typer.echo(line)
    typer.echo(f"{summary.ran} cases in {in_words(summary.wall_time)}, results in {folder}")
    if summary.exit_status:
        raise typer.Exit(summary.exit_status)


@app.command()
def run(
    matrix: Matrix, jobs: Jobs = None, output: Output = None, only: Only = NONE, sample: Sample = None,
    scheduler: Scheduler = None, cluster: ClusterFile = None, time_limit: TimeLimit = None,
) -> None:  # fmt: skip
    """Run what is not done yet. Stop it as you like: the same command goes on."""
    _run(matrix, output, only, sample, jobs, scheduler, cluster, time_limit, again=False)


@app.command()
def rerun(
    matrix: Matrix,
    failed: Annotated[bool, typer.Option("--failed", help="All cases that failed.")] = False,
    jobs: Jobs = None, output: Output = None, only: Only = NONE, sample: Sample = None,
    scheduler: Scheduler = None, cluster: ClusterFile = None, time_limit: TimeLimit = None,
) -> None:  # fmt: skip
    """Run cases that failed again: all (--failed), or some of them (--only)."""
    if not failed and not only:
        raise CaseError("rerun: say --failed for all cases that failed, or --only NAME=VALUE for some of them")
    _run(matrix, output, only, sample, jobs, scheduler, cluster, time_limit, again=True)


@app.command()
def status(place: Place, output: Output = None) -> None:
    """How far a matrix is, also while it runs: done, failed by reason, rate, remaining time."""
    from floatsim.cases.folder import Folder
    from floatsim.cases.runner import in_words, standing

    folder = Folder(_folder(place, output))
    name, _, cases = folder.matrix()
    summary, owner = standing(cases, folder.path), folder.owner()
    typer.echo(f"{name or folder.path}: {summary.lines()[0]}")
    for line in summary.lines()[1:]:
        typer.echo(line)
    if owner is None:
        typer.echo("nobody is running it" + (f"; {summary.to_do} cases wait" if summary.to_do else ""))
        return
    since = clock.time() - owner["started"]
    typer.echo(f"running: process {owner['pid']} on {owner['host']}, for {in_words(since)}")
    ended = [t for t in folder.ended() if t >= owner["started"]]
    wall = {case.id: case for case in cases}
    for case_id, reached in sorted(folder.under_way().items()):
        if case_id in wall:
            typer.echo(f"  {case_id}: {reached:.0f} of {wall[case_id].run.total:g} s")
    if ended and since > 0.0:
        rate = len(ended) / since
        left = max(owner["to_do"] - len(ended), 0)
        typer.echo(f"{3600.0 * rate:.3g} cases an hour; {left} left, {in_words(left / rate)}")


@app.command()
def collect(place: Place, output: Output = None) -> None:
    """One file of all statistics, summary.nc, with the variables of the matrix as coordinates."""
    from floatsim.cases.collect import collect as gather

    typer.echo(f"wrote {gather(_folder(place, output))}")


@app.command()
def report(place: Place, output: Output = None) -> None:
    """A page to look at, report.html, from summary.nc."""
    from floatsim.cases.report import report as write

    typer.echo(f"wrote {write(_folder(place, output))}")


@app.command()
def template(
    name: Annotated[str | None, typer.Argument(help="Of a template; without one, all are listed.")] = None,
    output: Annotated[str | None, typer.Option("-o", metavar="FILE.yaml", help="File to write, else print.")] = None,
) -> None:
    """Matrices to start from, such as the groups of IEC 61400-3-2: fill in the numbers of your site."""
    from floatsim.cases import listing

    if name is None:
        for known in listing.templates():
            typer.echo(f"{known:16} {listing.headline(known)}")
        return
    text = listing.template(name)
    if output is None:
        typer.echo(text, nl=False)
        return
    try:
        with Path(output).open("x", encoding="utf-8") as file:
            file.write(text)
    except OSError as error:
        raise CaseError(f"template: '{output}' cannot be written: {error.strerror}") from None
    typer.echo(f"wrote {output}")
