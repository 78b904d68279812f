"""Tables for the terminal, as (title, columns, rows) of plain text, and the file of a static solution."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from floatsim.parts.body import Body
from floatsim.parts.line import Line
from floatsim.parts.pto import PTO
from floatsim.parts.rotor import Rotor
from floatsim.study.channels import Sampler
from floatsim.study.frequency import FrequencyResponse
from floatsim.study.power import mean_power
from floatsim.study.power_matrix import PowerMatrix
from floatsim.study.release import DOFS, DecayTest, pose
from floatsim.study.simulate import Run
from floatsim.study.store import Writer
from floatsim.system.state import State
from floatsim.system.system import System

Table = tuple[str, list[str], list[list[str]]]


def write_state(system: System, state: State, path: str | Path, attributes: Mapping[str, str | int | float]) -> None:
    """One state as a result file with a single sample. Raises CaseError if it cannot be written."""
    sampler = Sampler(system, "all")
    with Writer(path, sampler.channels, sampler.coordinates, attributes, samples=1) as file:
        file.append(state.t, sampler.sample_state(state))


def static_tables(system: System, state: State) -> list[Table]:
    """Positions of bodies and end forces of lines."""
    bodies = [part for part in system.model.parts if isinstance(part, Body)]
    lines = [part for part in system.model.parts if isinstance(part, Line)]
    tables: list[Table] = []
    if bodies:
        rows = []
        for body in bodies:
            xi = pose(system, state, body.name)
            rows.append([body.name, *(f"{y:.4f}" for y in (*xi[:3], *np.degrees(xi[3:])))])
        columns = ["body", *(f"{d} [{'m' if k < 3 else 'deg'}]" for k, d in enumerate(DOFS))]
        tables.append(("displacement from the drawing position", columns, rows))
    sampler = Sampler(system, "all")
    row = sampler.sample_state(state)[None]
    rotors = [part.name for part in system.model.parts if isinstance(part, Rotor)]
    if rotors:
        scales = {"relative_wind": 1.0, "speed": 30.0 / np.pi, "pitch": 180.0 / np.pi, "thrust": 1e-3, "power": 1e-6}
        rows = [[name, *(f"{scale * sampler.column(row, f'{name}_{what}')[0]:.3f}" for what, scale in scales.items())]
                for name in rotors]  # fmt: skip
        columns = ["rotor", "wind along the shaft [m/s]", "speed [rpm]", "pitch [deg]", "thrust [kN]", "power [MW]"]
        tables.append(("rotors in the mean wind (no speed: parked)", columns, rows))
    if lines:
        rows = []
        for line in lines:
            ends = [sampler.column(row, f"{line.name}_end_{e}_force")[0] / 1e3 for e in "ab"]
            tension = sampler.column(row, f"{line.name}_tension")[0] / 1e3
            rows.append([line.name, *(f"{y:.3f}" for y in (np.linalg.norm(ends[0]), np.linalg.norm(ends[1]),
                                                           tension[0], tension[-1], tension.max()))])  # fmt: skip
        columns = ["line", "|force| at end a [kN]", "at end b [kN]", "tension first", "last element", "largest [kN]"]
        tables.append(("lines (force of the line on what its end is attached to)", columns, rows))
    return tables


def decay_tables(result: DecayTest) -> list[Table]:
    """Extrema, cycles and the fit of a decay test."""
    fit = result.fit
    unit = "m" if result.dof in DOFS[:3] else "deg"
    extrema = [[f"{t:.2f}", f"{x:+.4f}"] for t, x in zip(fit.time, fit.value)]
    cycles = [[str(k + 1), f"{period:.3f}"] for k, period in enumerate(fit.periods)]
    summary = [["mean period of the first three cycles", f"{fit.period:.3f} s"]]
    if result.expected_period is not None:
        off = 100.0 * (fit.periods[0] / result.expected_period - 1.0)
        summary.append(["expected by the model's source", f"{result.expected_period:.3f} s"])
        summary.append(["first cycle against it", f"{off:+.2f} %"])
    low, high = fit.amplitudes
    quadratic = "" if fit.quadratic_damping is None else f"{fit.quadratic_damping:.5g} 1/{unit}"
    summary += [
        ["linear damping ratio", f"{100.0 * fit.damping_ratio:.3f} %"],
        ["quadratic damping, b of b |x'| x'", quadratic],
        ["fitted over amplitudes", f"{low:.3g} to {high:.3g} {unit}, {len(fit.decrement)} half cycles"],
    ]
    title = f"{result.dof} decay of '{result.body}' from {result.offset:g} {unit} about {result.equilibrium:.4f} {unit}"
    return [
        (title, ["extremum at [s]", f"about equilibrium [{unit}]"], extrema),
        ("cycles, maximum to maximum", ["cycle", "period [s]"], cycles),
        ("result", ["", ""], summary),
    ]


RAO_ROWS = 12  # frequencies shown in the terminal; the file has them all


def rao_tables(response: FrequencyResponse) -> list[Table]:
    """Amplitudes of every body's motions at a dozen frequencies, and their standard deviations in the sea."""
    shown = np.unique(np.linspace(0, len(response.omega) - 1, min(RAO_ROWS, len(response.omega))).round().astype(int))
    scale = np.array([1.0, 1.0, 1.0, *3 * [180.0 / np.pi]])
    tables: list[Table] = []
    for body in (part for part in response.sampler.system.model.parts if isinstance(part, Body)):
        size = np.abs(response.rao(f"{body.name}_position")) * scale
        rows = [[f"{w:.3f}", f"{2.0 * np.pi / w:.2f}", *map(_short, size[k])]
                for k, w in zip(shown, response.omega[shown], strict=True)]  # fmt: skip
        title = (f"motions of '{body.name}' [m/m, deg/m] per metre of wave amplitude, waves towards "
                 f"{response.heading_deg:g} deg")  # fmt: skip
        tables.append((title, ["rad/s", "s", *DOFS], rows))
        if response.density is not None:
            sigma = response.std(f"{body.name}_position") * scale
            row = [body.name, *map(_short, sigma)]
            tables.append(("standard deviations in the sea [m, deg]", ["body", *DOFS], [row]))
    for pto in (part for part in response.sampler.system.model.parts if isinstance(part, PTO)):
        kinds = ("displacement", "velocity", "force")
        size = np.abs([response.rao(f"{pto.name}_{kind}") for kind in kinds]).T
        turn = any(c.name == f"{pto.name}_displacement" and c.units == "rad" for c in response.sampler.channels)
        title = (f"PTO '{pto.name}' " + ("[rad/m, rad/s/m, N m/m]" if turn else "[m/m, m/s/m, N/m]")
                 + " per metre of wave amplitude")  # fmt: skip
        rows = [[f"{w:.3f}", f"{2.0 * np.pi / w:.2f}", *map(_short, size[k])]
                for k, w in zip(shown, response.omega[shown], strict=True)]  # fmt: skip
        tables.append((title, ["rad/s", "s", *kinds], rows))
        if response.density is not None:
            row = [pto.name, *(_short(float(response.std(f"{pto.name}_{kind}"))) for kind in kinds)]
            tables.append(("standard deviations in the sea", ["PTO", *kinds], [row]))
    return tables


def pto_tables(run: Run) -> list[Table]:
    """What the PTOs of a run absorbed after the waves' ramp (in all, if it is shorter), how far and hard they went."""
    model = run.sampler.system.model
    kept = {c.name for c in run.sampler.channels}
    ramp = model.sea.wave_ramp if model.sea.waves is not None else 0.0
    since = run.time[0] + (ramp if ramp < run.simulated_time - 1.0 else 0.0)
    rows = []
    for pto in (part for part in model.parts if isinstance(part, PTO)):
        kinds = ("displacement", "force")
        if {f"{pto.name}_{kind}" for kind in (*kinds, "energy")} <= kept and len(run.time) > 2:
            s, f = (run.series(f"{pto.name}_{kind}") for kind in kinds)
            rows.append([pto.name, _short(mean_power(run, pto.name, since) / 1e3), _short(s.min()), _short(s.max()),
                         _short(f.min() / 1e3), _short(f.max() / 1e3)])  # fmt: skip
    heads = ["PTO", "mean power [kW]", "least stroke [m, rad]", "largest", "least force [kN, kN m]", "largest"]
    return [(f"PTOs, power from {since:g} s on", heads, rows)] if rows else []


def _short(y: float) -> str:
    return f"{y:.3g}" if abs(y) >= 5e-4 else "0"


def power_tables(matrix: PowerMatrix) -> list[Table]:
    """Mean power over the sea states."""
    rows = []
    for i, hs in enumerate(matrix.hs):
        cells = []
        for j, tp in enumerate(matrix.tp):
            failed = (float(hs), float(tp)) in matrix.failures
            y = matrix.power[i, j]
            cells.append("failed" if failed else "-" if not np.isfinite(y) else f"{y / 1e3:.4g}")
        rows.append([f"{hs:g}", *cells])
    return [("mean absorbed power [kW], rows hs [m], columns tp [s]", ["hs", *(f"{tp:g}" for tp in matrix.tp)], rows)]
