"""The riser of Low & Langley (2006) against OrcaFlex.

Curves: OrcaFlex as digitised in MoorDyn's repository (BSD-3, tests/Mooring/lowe_and_langley_2006), thinned to every
1.5 or 0.5 s from 5.5 s on; the first 5 s hold the start-up of that run. Bars: static 0.5 %, dynamic rms 0.5 kN and
largest difference 1 kN, which is how wide the published codes spread (MoorDyn's own rms is 0.12 to 0.37 kN). The
tension of the first element lacks half an element's weight, 0.2 kN with elements of 1 m, against the end's force.
"""

from __future__ import annotations

import numpy as np
import pytest
from shipped import load

import floatsim as fs
from floatsim.study.channels import Sampler

riser = load("riser_low_langley")

TOP, BOTTOM = 47.11, 26.60  # kN, forces of the ends at rest

# case: (time that stands for t = 0 of the curve [s], step of the curve [s], tension at the top [kN] from 5.5 s on)
CURVES = {
    1: (riser.LEAD, 1.5, (
        41.52, 41.90, 42.97, 44.45, 46.02, 46.99, 46.86, 46.37, 46.48, 47.25, 49.02, 50.76, 52.08, 52.14,
        50.95, 48.18, 45.12, 42.61, 41.58, 41.87, 42.90, 44.45, 46.09, 47.02, 46.86, 46.39, 46.35, 47.31,
        48.95, 50.82, 52.05, 52.21, 50.82, 48.21, 45.09, 42.71, 41.58, 41.87, 42.87, 44.48, 46.09, 47.02,
        46.89, 46.38, 46.35, 47.28, 49.02, 50.82, 52.01, 52.21,
    )),
    4: (2.0 * riser.WAVE_PERIOD, 0.5, (
        53.11, 52.69, 51.47, 49.68, 47.71, 46.45, 45.71, 45.41, 44.83, 43.75, 42.98, 42.49, 42.41, 42.32,
        42.89, 44.57, 47.54, 50.63, 52.31, 52.67, 52.83, 52.62, 51.45, 49.81, 48.04, 46.51, 45.82, 45.35,
        44.72, 43.65, 42.87, 42.47, 42.47, 42.43, 42.96, 44.49, 47.81, 50.61, 52.22, 52.62, 52.84, 52.67,
        51.72, 49.95, 48.02, 46.61, 45.81, 45.35, 44.64,
    )),
}  # fmt: skip


def test_at_rest(record):
    system = fs.assemble(riser.build())
    state, _ = fs.solve_static(system)
    sampler = Sampler(system, ["riser_tension", "riser_end_a_force", "riser_end_b_force"])
    row = sampler.sample_state(state)[None]
    check = "riser of Low & Langley against OrcaFlex"
    for end, name, force in (("b", "top", TOP), ("a", "bottom", BOTTOM)):
        pull = np.linalg.norm(sampler.column(row, f"riser_end_{end}_force")) / 1e3
        record(check, f"at rest: force at the {name}", pull, (0.995 * force, 1.005 * force), "kN")
    tension = sampler.column(row, "riser_tension")[0, -1] / 1e3
    record(check, "at rest: tension of the first element at the top", tension, (0.995 * TOP, 1.005 * TOP), "kN")


@pytest.mark.parametrize("case", CURVES)
def test_moving(case, record):
    lead, step, curve = CURVES[case]
    times = 5.5 + step * np.arange(len(curve))
    run = fs.simulate(riser.build(case), lead + times[-1] + 0.5, 0.1, channels=["riser_tension", "riser_end_b_force"])
    assert run.status == "done", run.failure
    check = f"riser of Low & Langley against OrcaFlex, case {case}"
    for name, force in (
        ("force at the top", np.linalg.norm(run.series("riser_end_b_force"), axis=1)),
        ("tension of the first element", run.series("riser_tension")[:, -1]),
    ):
        apart = np.interp(times + lead, run.time, force) / 1e3 - curve
        record(check, f"{name}: rms of the difference", np.sqrt(np.mean(apart**2)), 0.5, "kN")
        record(check, f"{name}: largest difference", np.abs(apart).max(), 1.0, "kN")
