"""Speed of nonlinear Froude-Krylov and hydrostatic forces: how many times faster than real time.

    python tests/benchmarks/froude_krylov_speed.py [--duration 60] [--subdivision 16]

A free-floating sphere of 8 n^2 triangles in six degrees of freedom, step 0.05 s, all costs of the run included (one
core, every channel kept), in a regular wave and in 200 components, long- and short-crested. 5 m radius, half wet.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np  # noqa: E402
from hulls import ellipsoid  # noqa: E402

import floatsim as fs  # noqa: E402
from floatsim.hydro.hull import Hull  # noqa: E402

STEP, RHO, R = 0.05, 1025.0, 5.0
JONSWAP = fs.Jonswap(hs=2.0, tp=8.0)
SEAS = {
    "still water": None,
    "regular wave": fs.RegularWave(height=2.0, period=8.0),
    "200 components": fs.IrregularWaves(spectrum=JONSWAP, seed=1, components=200),
    "200 components, short-crested": fs.IrregularWaves(spectrum=JONSWAP, seed=1, components=200, spreading=8.0),
}


def model(n: int, waves: object) -> fs.Model:
    """The sphere in these waves."""
    mass = RHO * 2.0 / 3.0 * np.pi * R**3
    inertia = (0.4 * mass * R**2,) * 3
    body = fs.Body(name="sphere", mass=mass, inertia=inertia, center_of_mass=(0.0, 0.0, -1.0),
                   hydro=Hull(mesh=ellipsoid(R, R, R, n)))  # fmt: skip
    return fs.Model(parts=[body], sea=fs.Sea(depth=70.0, density=RHO, waves=waves, wave_ramp=10.0))


def main() -> None:
    parser = argparse.ArgumentParser(description="Speed of nonlinear Froude-Krylov forces")
    parser.add_argument("--duration", type=float, default=60.0, help="simulated seconds")
    parser.add_argument("--subdivision", type=int, default=16, help="8 n^2 triangles")
    options = parser.parse_args()
    print(f"{8 * options.subdivision**2} triangles, step {STEP} s")
    for name, waves in SEAS.items():
        system = fs.assemble(model(options.subdivision, waves))
        start, _ = fs.solve_static(system)
        fs.simulate(system, 1.0, STEP, state=start)
        began = time.process_time()
        run = fs.simulate(system, options.duration, STEP, state=start)
        cpu = time.process_time() - began
        factors = [run.simulated_time / seconds for seconds in (cpu, run.wall_time)]
        print(
            f"{name:30s} {factors[0]:4.0f} x real time in CPU time, {factors[1]:4.0f} in wall time; "
            f"{1e3 * cpu / run.steps:.3f} ms a step, {run.newton_iterations / run.steps:.2f} Newton iterations, "
            f"{run.status} {run.failure}"
        )


if __name__ == "__main__":
    main()
