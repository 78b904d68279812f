"""Power matrix of a wave-energy converter: mean absorbed power over a table of sea states, and the energy of a year.

    P(hs, tp) = mean of the PTOs' power after the start,        E = 8766 h sum P(hs, tp) p(hs, tp)

p is the share of the year a sea state lasts (IEC TS 62600-100:2012, sections 8 and 9, for the table and its use; its
measured matrices are binned by energy period, this one by the peak period of the spectrum it is run with). Every cell
is one run of the model with irregular waves of its own seed. A cell whose run fails is nan, with the reason kept.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from floatsim.description import is_number
from floatsim.errors import CaseError, FloatsimError, ModelError, nearest
from floatsim.model import Model
from floatsim.parts.pto import PTO
from floatsim.sea.spectra import Jonswap
from floatsim.sea.waves import IrregularWaves
from floatsim.study.power import mean_power
from floatsim.study.simulate import positive_seconds, simulate
from floatsim.system.system import assemble

Array = NDArray[np.float64]

HOURS = 8766.0  # of a mean year


@dataclass(frozen=True, eq=False)
class PowerMatrix:
    """Mean power [W] of every cell.

    hs (n,) m; tp (m,) s; power (n, m) W, all PTOs together, nan where the run failed or the sea cannot be; pto: name ->
    (n, m) W of each; occurrence (n, m) shares of a year, or None; failures: (hs, tp) -> reason.
    """

    hs: Array
    tp: Array
    power: Array
    pto: dict[str, Array] = field(repr=False)
    occurrence: Array | None = None
    failures: dict[tuple[float, float], str] = field(default_factory=dict)

    @property
    def annual_energy(self) -> float:
        """Energy of a year [J]. Raises CaseError without occurrences, or if a cell that occurs has no power."""
        if self.occurrence is None:
            raise CaseError("power_matrix: the energy of a year needs occurrence=..., shares of the year per cell")
        happens = self.occurrence > 0.0
        missing = happens & ~np.isfinite(self.power)
        if missing.any():
            i, j = np.argwhere(missing)[0]
            raise CaseError(
                f"power_matrix: {missing.sum()} sea states that occur have no power, the first is hs {self.hs[i]:g} m, "
                f"tp {self.tp[j]:g} s: {self.failures.get((float(self.hs[i]), float(self.tp[j])), 'not run')}"
            )
        return float(3600.0 * HOURS * np.sum(self.power[happens] * self.occurrence[happens]))

    def dataset(self) -> Any:
        """As an xarray Dataset with dimensions hs and tp."""
        import xarray

        dims, data = ("hs", "tp"), {}
        data["power"] = (dims, self.power, {"units": "W", "long_name": "mean absorbed power"})
        for name, values in self.pto.items():
            data[f"{name}_power"] = (dims, values, {"units": "W", "long_name": f"mean absorbed power of {name}"})
        if self.occurrence is not None:
            data["occurrence"] = (dims, self.occurrence, {"units": "1", "long_name": "share of the year"})
        hs = ("hs", self.hs, {"units": "m", "long_name": "significant wave height"})
        tp = ("tp", self.tp, {"units": "s", "long_name": "peak period"})
        out = xarray.Dataset(data, {"hs": hs, "tp": tp})
        for (h, t), reason in self.failures.items():
            out.attrs[f"failure_hs_{h:g}_tp_{t:g}"] = reason
        return out


def power_matrix(
    model: Model,
    hs: Sequence[float],
    tp: Sequence[float],
    *,
    ptos: Sequence[str] | None = None,
    occurrence: Any = None,
    duration: float = 1800.0,
    start: float = 200.0,
    dt: float = 0.1,
    seed: int = 1,
    spectrum: Callable[[float, float], Any] = lambda hs, tp: Jonswap(hs=hs, tp=tp),
    heading_deg: float = 0.0,
    components: int = 200,
    progress: Callable[[int, int], None] | None = None,
) -> PowerMatrix:
    """Run `model` in every sea state of the table hs [m] x tp [s].

    ptos: names of the PTOs that count, default all. occurrence (n, m): shares of the year, their sum at most 1; cells
    of 0 are not run (nan). duration [s] over which power is averaged, after `start` [s] (the ramp and what follows it).
    seed: the cell in row i and column j has seed + i m + j. spectrum(hs, tp): the sea, default JONSWAP with gamma 3.3.
    components: of each sea. The waves of the model's own sea are not looked at. progress(done, all) after each cell.

    Raises CaseError for bad input, ModelError for a model without a PTO.
    """
    rows, columns = (_axis(name, values) for name, values in (("hs", hs), ("tp", tp)))
    duration, start = positive_seconds("duration", duration), positive_seconds("start", start)
    if not isinstance(model, Model):
        raise CaseError(f"power_matrix: model: got {model!r}; must be a floatsim.Model")
    if start < model.sea.wave_ramp:
        raise CaseError(
            f"power_matrix: start is {start:g} s, the waves of model '{model.name}' grow for {model.sea.wave_ramp:g} s "
            "(wave_ramp); start no earlier than that"
        )
    known = [part.name for part in model.parts if isinstance(part, PTO)]
    if not known:
        raise ModelError(f"power_matrix: model '{model.name}' has no PTO that could absorb power")
    names = known if ptos is None else [str(name) for name in ptos]
    for name in names:
        if name not in known:
            raise CaseError(f"power_matrix: there is no PTO '{name}'{nearest(name, known)}")
    share = None if occurrence is None else np.array(occurrence, dtype=float)
    if share is not None and (share.shape != (len(rows), len(columns)) or not np.all(share >= 0.0)
                              or share.sum() > 1.0 + 1e-6):  # fmt: skip
        raise CaseError(
            f"power_matrix: occurrence has shape {share.shape} and sum {share.sum():g}; must be ({len(rows)}, "
            f"{len(columns)}), none negative, at most 1 together"
        )
    power = {name: np.full((len(rows), len(columns)), np.nan) for name in names}
    failures: dict[tuple[float, float], str] = {}
    cells = [(i, j) for i in range(len(rows)) for j in range(len(columns)) if share is None or share[i, j] > 0.0]
    for done, (i, j) in enumerate(cells, 1):
        try:
            waves = IrregularWaves(
                spectrum=spectrum(float(rows[i]), float(columns[j])), seed=seed + i * len(columns) + j,
                heading_deg=heading_deg, components=components, duration=max(3600.0, start + duration),
            )  # fmt: skip
            sea = model.sea.model_copy(update={"waves": waves})
            run = simulate(assemble(model.model_copy(update={"sea": sea})), start + duration, dt,
                           channels=[f"{name}_energy" for name in names])  # fmt: skip
            if run.status == "failed":
                failures[float(rows[i]), float(columns[j])] = run.failure or "run failed"
            else:
                for name in names:
                    power[name][i, j] = mean_power(run, name, start)
        except FloatsimError as error:  # a sea or an equilibrium that cannot be: this cell's, not the table's
            failures[float(rows[i]), float(columns[j])] = str(error)
        if progress is not None:
            progress(done, len(cells))
    total = np.sum(list(power.values()), axis=0)
    return PowerMatrix(rows, columns, total, power, share, failures)


def _axis(name: str, values: Any) -> Array:
    row = np.atleast_1d(np.asarray(values, dtype=object))
    if row.ndim != 1 or not len(row) or not all(is_number(y) and y > 0.0 for y in row):
        raise CaseError(f"power_matrix: {name}: got {values!r:.80}; must be positive numbers")
    if len(set(row)) < len(row):
        raise CaseError(f"power_matrix: {name}: got {values!r:.80}; each value once")
    return row.astype(float)


def read_occurrence(path: str | Path) -> tuple[Array, Array, Array]:
    """A scatter table: hs (n,) m, tp (m,) s, and shares of the year (n, m).

    A text file, columns separated by commas, semicolons or blanks: the first line has a word (or nothing), then every
    tp; the others hs, then the shares. Raises CaseError for a file that is not like that.
    """
    try:
        lines = [line.replace(",", " ").replace(";", " ").split() for line in Path(path).read_text().splitlines()]
        head, *body = [line for line in lines if line]
        if body and len(head) < len(body[0]):  # a spreadsheet's corner without a word
            head = ["hs", *head]
        tp = np.array([float(word) for word in head[1:]])
        table = np.array([[float(word) for word in line] for line in body]).reshape(len(body), -1)
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise CaseError(f"occurrence: '{path}' cannot be read as a scatter table: {error}") from None
    if not len(tp) or table.shape != (len(body), len(tp) + 1) or not len(body):
        raise CaseError(
            f"occurrence: '{path}' has {len(body)} lines of {table.shape[1] if len(body) else 0} numbers under "
            f"{len(tp)} periods; each line has hs, then a share of the year for every period"
        )
    return table[:, 0], tp, table[:, 1:]
