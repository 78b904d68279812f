"""Cost against size: CPU time per step and memory of one cable of 50 to 5000 elements.

    python tests/benchmarks/cable_size.py [--steps 300] [--repeat 3]

A cable of one-metre elements (section of models/umbilical_rm3.py) hangs between two points at 0.8 of its length, in
water so deep that it does not touch the bed; its end moves as in the benchmark of that model. Step 0.1 s. Each size is
run `repeat` times after a run that compiles, in turns, and the best counts. CPU time of a run of one step is taken
off. Memory is the peak of what Python and numpy allocate from assembly to the end of the run. Exit status 1 if time or
memory grows with an exponent of 1.1 or more.
"""

from __future__ import annotations

import argparse
import math
import os
import sys
import time
import tracemalloc
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np  # noqa: E402

import floatsim as fs  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "models"))

import umbilical_rm3 as umbilical  # noqa: E402

SIZES = (50, 100, 200, 500, 1000, 2000, 5000)
STEP, LIMIT = 0.1, 1.1  # s, exponent


def hanging_cable(elements: int) -> fs.Model:
    """A cable of `elements` metres between two points at the same depth."""
    length = float(elements)
    line = fs.Line(name="cable", section=umbilical.section("cable", 77.3, 0.176), length=length, elements=elements)
    far = (0.8 * length, 0.0, umbilical.HANG_OFF[2])
    return fs.Model(
        name="hanging_cable",
        parts=[line],
        joints=[
            fs.Prescribed(a="cable.end_a", motion=umbilical.benchmark_motion(), name="top"),
            fs.Ball(a="cable.end_b", b=far),
        ],
        sea=fs.Sea(depth=100.0 + length),
    )


class Size:
    """One size: its system at rest, and the best times so far."""

    def __init__(self, elements: int) -> None:
        self.elements, self.per_step, self.iterations = elements, math.inf, 0.0
        tracemalloc.start()
        self.system = fs.assemble(hanging_cable(elements))
        self.state, _ = fs.solve_static(self.system)
        self.run(1)
        self.memory = tracemalloc.get_traced_memory()[1] / 1e6
        tracemalloc.stop()

    def run(self, steps: int) -> fs.Run:
        run = fs.simulate(self.system, steps * STEP, STEP, state=self.state, interval=steps * STEP,
                          channels=["top_force"])  # fmt: skip
        if run.status != "done":
            raise SystemExit(f"{self.elements} elements: {run.failure}")
        return run

    def measure(self, steps: int) -> None:
        began = time.process_time()
        self.run(1)
        middle = time.process_time()
        run = self.run(steps)
        cost = time.process_time() - middle - (middle - began)
        self.per_step = min(self.per_step, cost / (steps - 1))
        self.iterations = run.newton_iterations / run.steps


def exponent(x: list[float], y: list[float]) -> float:
    """Slope of log y over log x."""
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def main() -> int:
    parser = argparse.ArgumentParser(description="Cost of a cable against its number of elements")
    parser.add_argument("--steps", type=int, default=300)
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    Size(SIZES[0])  # compiles
    sizes = [Size(n) for n in SIZES]
    for _ in range(options.repeat):
        for size in sizes:
            size.measure(options.steps)
    print(f"{'elements':>9s}{'us/step':>10s}{'us/step/element':>17s}{'iterations':>12s}{'MB':>8s}{'kB/element':>12s}")
    for s in sizes:
        per = 1e6 * s.per_step
        print(f"{s.elements:9d}{per:10.1f}{per / s.elements:17.3f}{s.iterations:12.2f}"
              f"{s.memory:8.1f}{1e3 * s.memory / s.elements:12.1f}")  # fmt: skip
    n = [float(s.elements) for s in sizes]
    slopes = {
        "time per step": exponent(n, [s.per_step for s in sizes]),
        "time per iteration": exponent(n, [s.per_step / s.iterations for s in sizes]),
        "memory": exponent(n, [s.memory for s in sizes]),
    }
    for name, slope in slopes.items():
        print(f"exponent of {name}: {slope:.3f} (below {LIMIT:g})")
    # the largest by themselves: fixed costs of small cables must not hide a higher order
    last = exponent(n[-3:], [s.per_step for s in sizes[-3:]])
    print(f"exponent of time per step from {SIZES[-3]} to {SIZES[-1]} elements: {last:.3f} (below {LIMIT:g})")
    good = max(*slopes.values(), last) < LIMIT
    print("holds" if good else "missed")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
