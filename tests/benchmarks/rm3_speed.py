"""Speed of RM3 in an irregular sea: how many times faster than real time, with both kinds of radiation memory.

    python tests/benchmarks/rm3_speed.py [--duration 600] [--repeat 3]

Two interacting bodies, slider and damper, 200 wave components, step 0.05 s, every channel to netCDF at every step. CPU
time of this process, the median of some runs after a short one that compiles. Bar: 100 times real time.
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import floatsim as fs  # noqa: E402
from floatsim.study.script import load_model  # noqa: E402

MODEL = Path(__file__).resolve().parents[2] / "models" / "rm3.py"
STEP, BAR = 0.05, 100.0  # s, times real time


def factors(radiation: str, duration: float, repeat: int) -> list[float]:
    """Simulated over CPU seconds of every run."""
    waves = fs.IrregularWaves(spectrum=fs.Jonswap(hs=2.5, tp=8.0), seed=1, components=200)
    system = fs.assemble(load_model(MODEL, {"waves": waves, "radiation": radiation}))
    start, _ = fs.solve_static(system)
    found = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "speed.nc"
        fs.simulate(system, 2.0, STEP, state=start, output=path)
        for _ in range(repeat):
            began = time.process_time()
            run = fs.simulate(system, duration, STEP, state=start, output=path)
            found.append(run.simulated_time / (time.process_time() - began))
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description="Speed of RM3")
    parser.add_argument("--duration", type=float, default=600.0, help="simulated seconds")
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    slow = False
    for radiation in ("convolution", "state_space"):
        found = factors(radiation, options.duration, options.repeat)
        median = statistics.median(found)
        slow |= median < BAR
        print(f"{radiation}: {median:.0f} x real time (runs: {', '.join(f'{f:.0f}' for f in found)}), bar {BAR:g}")
    sys.exit(1 if slow else 0)


if __name__ == "__main__":
    main()
