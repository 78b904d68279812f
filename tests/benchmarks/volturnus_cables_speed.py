"""Speed of VolturnUS-S in 82 m with three chains and two cables of 226 elements, in waves and current.

    python tests/benchmarks/volturnus_cables_speed.py [--duration 600] [--repeat 3]

Irregular waves Hs 6 m, Tp 11 s of 200 components on floater and lines, current 0.5 m/s; chains of 100 elements, step
0.1 s with control of the local error, every channel to netCDF every 0.1 s. At least 40 times real time on one core is
wanted. The speed is the median of plain runs after a short one that compiles, in processor time (which leaves out what
else the machine does) and by the clock; the shares come from one more run with timers (volturnus_speed.py).
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from pathlib import Path

from volturnus_speed import STEP, Timers, peak_memory  # sets one thread, so it comes first

import floatsim as fs  # isort: skip
from floatsim.study.script import load_model  # isort: skip

MODEL = Path(__file__).resolve().parents[2] / "models" / "volturnus_s_82m.py"


def cabled_floater() -> fs.Model:
    """The model of this benchmark."""
    waves = fs.IrregularWaves(spectrum=fs.Jonswap(hs=6.0, tp=11.0), seed=1, components=200)
    return load_model(MODEL, {"waves": waves, "current": fs.Current(speed=0.5)})


def summary(run: fs.Run) -> None:
    """What the lines and the floater did, without the ramp of the waves."""
    data = run.dataset().sel(time=slice(100.0, None))
    motion = data["platform_position"].values
    for k, (name, unit) in enumerate((("surge", "m"), ("sway", "m"), ("heave", "m"))):
        y = motion[:, k]
        print(f"  {name:10s} mean {y.mean():8.3f} {unit}, std {y.std():.3f}, {y.min():.3f} to {y.max():.3f}")
    for line in ("mooring_1", "mooring_2", "mooring_3", "cable_1", "cable_2"):
        y = data[f"{line}_tension"].values / 1e3
        top = y[:, -1] if line.startswith("mooring") else y[:, 0]
        curvature = float(abs(data[f"{line}_curvature"]).max())
        print(f"  {line:10s} first element at the floater: mean {top.mean():.1f} kN, std {top.std():.2f}, "
              f"{top.min():.1f} to {top.max():.1f}; anywhere {y.min():.2f} to {y.max():.2f}; "
              f"curvature to {curvature:.3f} 1/m")  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description="Speed of VolturnUS-S with chains and cables")
    parser.add_argument("--duration", type=float, default=600.0, help="simulated seconds")
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    system = fs.assemble(cabled_floater())
    start, statics = fs.solve_static(system)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "speed.nc"
        fs.simulate(system, 2.0, STEP, state=start, output=path)
        runs, seconds = [], []
        for _ in range(options.repeat):
            began = time.process_time()
            runs.append(fs.simulate(system, options.duration, STEP, state=start, output=path))
            seconds.append(time.process_time() - began)
        run, size = runs[-1], path.stat().st_size / 1e6
        print(f"statics: {statics.iterations} iterations, balance {statics.balance:.1e}")
        print(f"run {run.status} {run.failure}: {run.simulated_time:g} s, {run.steps} steps, {run.cut_steps} cut, "
              f"{run.newton_iterations} Newton iterations, file of {size:.0f} MB")  # fmt: skip
        summary(run)
        timers = Timers()
        timers.install()
        shared = fs.simulate(system, options.duration, STEP, state=start, output=path)
    for what, spent in (("processor time", seconds), ("clock", [r.wall_time for r in runs])):
        factors = [run.simulated_time / y for y in spent]
        shown = ", ".join(f"{f:.0f}" for f in factors)
        print(f"speed by {what}: {statistics.median(factors):.0f} x real time (runs: {shown})")
    wall = shared.wall_time
    plain = statistics.median(r.wall_time for r in runs)
    print(f"shares of an instrumented run ({wall:.2f} s, plain {plain:.2f} s):")
    rest = wall - sum(timers.seconds.values())
    rows = [*timers.seconds.items(), ("Python around them", rest)]
    for group, share in sorted(rows, key=lambda item: -item[1]):
        each = 1e6 * share / shared.newton_iterations
        print(f"  {group:42s} {100.0 * share / wall:5.1f} %   {each:7.1f} us an iteration")
    print(f"peak resident memory: {peak_memory():.0f} MB")


if __name__ == "__main__":
    main()
