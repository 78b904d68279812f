"""The lazy wave of Verelst et al. (2024) in 82 m of water against MoorDyn 2.7.2, fully relaxed.

Weights per metre are exact (diameters follow), 1 m elements, hinged ends, no friction. Tolerances: what the spread of
the published solutions and the printed digits leave.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import floatsim as fs

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "models"))
from lazy_wave import build  # noqa: E402

SHAPES = ("straight", "arc", "catenary", "circles")
TARGETS = {  # value, tolerance, unit
    "z of the sag": (-39.82, 0.1, "m"), "z of the hog": (-15.99, 0.1, "m"),
    "arc length of the touchdown": (147.0, 1.0, "m"), "tension of the first element": (16.60, 0.166, "kN"),
    "tension on the bed": (0.97, 0.02, "kN"), "largest bending moment": (2419.0, 0.02 * 2419.0, "N m"),
}  # fmt: skip


def equilibrium(shape: str) -> tuple[np.ndarray, fs.Run]:
    system = fs.assemble(build(shape=shape))
    state, report = fs.solve_static(system)
    assert report.converged
    return state.x, fs.simulate(system, 0.1, state=state)


@pytest.mark.parametrize("shape", SHAPES)
def test_against_moordyn(shape, record):
    _, run = equilibrium(shape)
    x, T, M = (run.series(f"cable_{name}")[0] for name in ("position", "tension", "bending_moment"))
    hog = 60 + int(np.argmax(x[60:120, 2]))
    values = (x[:hog, 2].min(), x[hog, 2], run.series("cable_touchdown")[0], T[0] / 1e3, T[-1] / 1e3, M.max())
    for (name, (target, tolerance, unit)), value in zip(TARGETS.items(), values, strict=True):
        row = f"lazy wave in 82 m, first shape: {shape}"
        record(row, name, float(value), (target - tolerance, target + tolerance), unit)


def test_one_equilibrium(record):
    """Whatever it starts from, and bit for bit the same when it is done again."""
    found = [equilibrium(shape)[0] for shape in SHAPES]
    apart = max(float(np.abs(x - found[0]).max()) for x in found[1:])
    record("lazy wave in 82 m", "largest distance between the equilibria from four first shapes", apart, 1e-6, "m")
    assert np.array_equal(equilibrium("arc")[0], found[1])
