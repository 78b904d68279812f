"""Speed of the moored VolturnUS-S in an irregular sea: how many times faster than real time, and where the time goes.

    python tests/benchmarks/volturnus_speed.py [--duration 600] [--repeat 3]

600 s, three chains of 50 elements, 200 wave components on the body, step 0.1 s, every channel to netCDF every
0.1 s. The speed is the median of three plain runs after a short one that compiles; the shares come from one more run
in which compiled kernels, linear solver and output are wrapped with timers (the outermost counts, so a kernel
called for output is output), which makes that run a little slower.
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np  # noqa: E402
from numba.core.dispatcher import Dispatcher  # noqa: E402

import floatsim as fs  # noqa: E402
from floatsim.solve.linear import LinearSolver, _factor_dense, _solve_dense  # noqa: E402
from floatsim.study.channels import Sampler  # noqa: E402
from floatsim.study.script import load_model  # noqa: E402
from floatsim.study.store import Writer  # noqa: E402

MODEL = Path(__file__).resolve().parents[2] / "models" / "volturnus_s.py"
STEP = 0.1  # s


def moored_floater() -> fs.Model:
    """The model of this benchmark."""
    sea = fs.IrregularWaves(spectrum=fs.Jonswap(hs=6.0, tp=12.0), seed=1, components=200)
    return load_model(MODEL, {"waves": sea})


def peak_memory() -> float:
    """Largest resident memory of this process so far, MB."""
    unit = 1.0 if sys.platform == "darwin" else 1024.0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e6


class Timers:
    """Seconds spent in wrapped functions, by group; only the outermost wrapped call counts."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = defaultdict(float)
        self.calls: dict[str, int] = defaultdict(int)
        self._busy = False

    def wrap(self, function: Any, group: str) -> Any:
        """`function` with its time added to `group`."""

        def timed(*args: Any, **kwargs: Any) -> Any:
            if self._busy:
                return function(*args, **kwargs)
            self._busy = True
            began = time.perf_counter()
            try:
                return function(*args, **kwargs)
            finally:
                self.seconds[group] += time.perf_counter() - began
                self.calls[group] += 1
                self._busy = False

        return timed

    def install(self) -> None:
        """Wrap linear solver, output and every kernel that Python can call. Everything must be compiled by now."""
        for owner, name, group in (
            (LinearSolver, "solve", "linear solve (bands and border)"),
            (Sampler, "sample", "output: samples"),
            (Writer, "append", "output: netCDF"),
        ):
            setattr(owner, name, self.wrap(getattr(owner, name), group))
        for module in [m for n, m in sys.modules.items() if n.startswith("floatsim.")]:
            for name, value in list(vars(module).items()):
                if isinstance(value, Dispatcher):
                    setattr(module, name, self.wrap(value, "kernels (elements, loads, norms, memory)"))


def border_time(n: int) -> float:
    """Seconds for the elimination of a dense border of n unknowns, which is a part of the linear solve."""
    best = np.inf
    matrix = np.random.default_rng(1).normal(size=n * n)
    for _ in range(200):
        work, x, swaps = matrix.copy(), np.ones(n), np.zeros(n, np.int64)
        began = time.perf_counter()
        _factor_dense(work, 0, n, swaps, 0)
        _solve_dense(work, 0, n, swaps, 0, x)
        best = min(best, time.perf_counter() - began)
    return best


def main() -> None:
    parser = argparse.ArgumentParser(description="Speed of the moored VolturnUS-S")
    parser.add_argument("--duration", type=float, default=600.0, help="simulated seconds")
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    system = fs.assemble(moored_floater())
    start, _ = fs.solve_static(system)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "speed.nc"
        fs.simulate(system, 2.0, STEP, state=start, output=path)
        runs = [fs.simulate(system, options.duration, STEP, state=start, output=path) for _ in range(options.repeat)]
        size = path.stat().st_size / 1e6
        timers = Timers()
        timers.install()
        shared = fs.simulate(system, options.duration, STEP, state=start, output=path)
    run = runs[0]
    factors = [r.simulated_time / r.wall_time for r in runs]
    print(f"{run.simulated_time:g} s, {run.steps} steps, {run.cut_steps} cut, file of {size:.0f} MB")
    print(f"{run.newton_iterations} Newton iterations")
    print(f"speed: {statistics.median(factors):.0f} x real time (runs: {', '.join(f'{f:.0f}' for f in factors)})")
    wall = shared.wall_time
    plain = statistics.median(r.wall_time for r in runs)
    print(f"shares of an instrumented run ({wall:.2f} s, plain {plain:.2f} s):")
    rest = wall - sum(timers.seconds.values())
    for group, seconds in sorted(timers.seconds.items(), key=lambda item: -item[1]):
        print(f"  {group:42s} {100.0 * seconds / wall:5.1f} %   {1e6 * seconds / timers.calls[group]:7.1f} us a call")
    each = 1e6 * rest / run.newton_iterations
    print(f"  {'Python around them':42s} {100.0 * rest / wall:5.1f} %   {each:7.1f} us an iteration")
    n = len(system.layout.border)
    print(f"of the linear solve, the dense border of {n} unknowns takes {1e6 * border_time(n):.1f} us a call")
    print(f"peak resident memory: {peak_memory():.0f} MB")


if __name__ == "__main__":
    main()
