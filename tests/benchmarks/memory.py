"""Resident memory over a long run: it must not grow with the simulated time.

    python tests/benchmarks/memory.py [--duration 10800]

VolturnUS-S in an irregular sea, 3 h, step 0.1 s, every channel to netCDF every 0.5 s. Memory is read at 0.5 h, when
all buffers have been used, and at the end. Exit status 1 if it grows by more than 10 MB or exceeds 400 MB.
Linux only (it reads /proc).
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import floatsim as fs  # noqa: E402
from floatsim.study.script import load_model  # noqa: E402

MODEL = Path(__file__).resolve().parents[2] / "models" / "volturnus_s.py"
EARLY = 1800.0  # s: everything has been allocated and used by then
LIMIT, GROWTH = 400.0, 10.0  # MB


def resident() -> float:
    """Resident memory of this process now, MB."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def main() -> int:
    parser = argparse.ArgumentParser(description="Resident memory over a long run")
    parser.add_argument("--duration", type=float, default=10800.0, help="simulated seconds")
    duration = parser.parse_args().duration
    sea = fs.IrregularWaves(
        spectrum=fs.Jonswap(hs=6.0, tp=12.0), seed=1, components=200, duration=max(duration, 3600.0)
    )
    seen: list[tuple[float, float]] = []
    with tempfile.TemporaryDirectory() as folder:
        run = fs.simulate(
            load_model(MODEL, {"waves": sea}), duration, 0.1, output=Path(folder) / "memory.nc", interval=0.5,
            progress=lambda t, _: seen.append((t, resident())),
        )  # fmt: skip
    end = resident()
    early = next(m for t, m in seen if t >= min(EARLY, 0.5 * duration))
    largest = max(m for _, m in seen)
    factor = run.simulated_time / run.wall_time
    print(f"{run.status}: {run.simulated_time:g} s in {run.wall_time:.1f} s ({factor:.0f} x real time)")
    first, last = min(EARLY, 0.5 * duration), seen[-1]
    print(f"resident memory: {early:.0f} MB at {first:g} s, {last[1]:.0f} MB at {last[0]:.0f} s")
    print(f"{end:.0f} MB after the file was closed, largest {largest:.0f} MB")
    good = run.status == "done" and largest < LIMIT and seen[-1][1] - early < GROWTH
    print("holds" if good else f"missed: at most {LIMIT:g} MB and {GROWTH:g} MB of growth are allowed")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
