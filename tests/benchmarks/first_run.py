"""The first run on a fresh machine, and the second: whole processes, from the shell's point of view.

    python tests/benchmarks/first_run.py

Runs `floatsim run models/volturnus_s.py --duration 0.1` (one step) with an empty kernel cache, then again. The first
compiles everything and has to say so; the second shows how long import, assembly, statics and the first step take.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

MODEL = Path(__file__).resolve().parents[2] / "models" / "volturnus_s.py"
COLD, WARM = 60.0, 3.0  # s, bars


def one_step(folder: Path) -> tuple[float, str]:
    """Wall-clock seconds of the process and what it wrote to stderr."""
    command = [sys.executable, "-c", "from floatsim.cli import main; main()", "run", str(MODEL),
               "--duration", "0.1", "-o", str(folder / "first.nc")]  # fmt: skip
    environment = {**os.environ, "FLOATSIM_CACHE_DIR": str(folder / "cache"), "OMP_NUM_THREADS": "1"}
    began = time.perf_counter()
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    seconds = time.perf_counter() - began
    if done.returncode:
        sys.exit(f"the run failed:\n{done.stdout}{done.stderr}")
    return seconds, done.stderr


def main() -> int:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        cold, said = one_step(folder)
        warm = min(one_step(folder)[0] for _ in range(3))
    compiled = "compiling" in said
    print(f"first run, empty kernel cache: {cold:.1f} s (below {COLD:g} s)")
    print(f"it {'says so' if compiled else 'DOES NOT say so'}: {said.strip() or '-'}")
    print(f"second run: {warm:.2f} s from the shell to the end of the first step (below {WARM:g} s)")
    good = cold < COLD and warm < WARM and compiled
    print("holds" if good else "missed")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
