"""The heaving chain of models/chain_orcaflex.py against OrcaFlex.

Curves: tension at the fairlead every 0.4 s over two periods, from MoorDyn's repository (BSD-3, tests/Mooring/
QuasiStatic), static forces from its test. Bars: static 2.5 and 2 % (spread of the quasi-static codes and of friction in
statics), rms of the difference 15 % of the range in 50 m, where the chain goes slack and taut, and 7 % in 200 m.
"""

from __future__ import annotations

import numpy as np
import pytest
from shipped import load

import floatsim as fs
from floatsim.study.channels import Sampler

chain = load("chain_orcaflex")

LEAD = 2.0 * chain.PERIOD  # s, a whole number of periods, then the motion's phase is that of the curve

# depth: (static force [kN], its bar, bar of the rms over the range [%], tension at the fairlead [kN])
CASES = {
    50: (991.6, 0.025, 15.0, (
        1091.1, 1087.0, 1075.8, 1049.1, 1024.8, 990.1, 973.8, 976.3, 968.0, 950.2, 928.7, 909.2, 902.5, 902.7,
        915.6, 925.5, 956.1, 975.7, 983.3, 993.0, 987.2, 1001.3, 1035.3, 1057.9, 1081.8, 1092.1, 1084.5, 1073.2,
        1047.0, 1024.5, 992.1, 977.3, 977.2, 964.9, 947.4, 928.4, 909.4, 902.7, 904.0, 916.3, 925.2, 955.9,
        975.5, 982.9, 993.5, 987.9, 1001.0, 1034.8, 1058.0, 1081.8, 1091.9,
    )),
    200: (2065.4, 0.02, 7.0, (
        2270.3, 2216.4, 2170.1, 2083.5, 2010.8, 1933.9, 1884.1, 1870.0, 1838.7, 1847.6, 1832.4, 1828.5, 1848.2, 1875.0,
        1930.3, 1993.5, 2068.9, 2151.5, 2195.2, 2259.8, 2275.0, 2297.2, 2303.1, 2283.0, 2277.8, 2258.1, 2223.4, 2172.7,
        2086.9, 2010.6, 1937.9, 1893.6, 1875.4, 1842.1, 1842.3, 1831.1, 1828.5, 1849.1, 1873.4, 1925.5, 1992.0, 2066.2,
        2150.9, 2193.5, 2259.0, 2276.3, 2298.4, 2305.0, 2282.6, 2277.8, 2258.3,
    )),
}  # fmt: skip


@pytest.mark.parametrize("depth", CASES)
def test_chain(depth, record):
    static, static_bar, rms_bar, curve = CASES[depth]
    check = f"chain against OrcaFlex, {depth} m"
    system = fs.assemble(chain.build(depth, moving=False))
    state, _ = fs.solve_static(system)
    sampler = Sampler(system, ["chain_tension", "chain_end_b_force"])
    row = sampler.sample_state(state)[None]
    for name, force in (("force at the fairlead", np.linalg.norm(sampler.column(row, "chain_end_b_force"))),
                        ("tension of the last element", sampler.column(row, "chain_tension")[0, -1])):  # fmt: skip
        bounds = ((1.0 - static_bar) * static, (1.0 + static_bar) * static)
        record(check, f"at rest: {name}", force / 1e3, bounds, "kN")
    times = 0.4 * np.arange(len(curve))
    run = fs.simulate(chain.build(depth), LEAD + times[-1], 0.1, channels=["chain_tension", "chain_end_b_force"])
    assert run.status == "done", run.failure
    for name, force in (("force at the fairlead", np.linalg.norm(run.series("chain_end_b_force"), axis=1)),
                        ("tension of the last element", run.series("chain_tension")[:, -1])):  # fmt: skip
        apart = np.interp(times + LEAD, run.time, force) / 1e3 - curve
        share = np.sqrt(np.mean(apart**2)) / np.ptp(curve)
        record(check, f"heave, {name}: rms of the difference over the range", 100.0 * share, rms_bar, "%")
