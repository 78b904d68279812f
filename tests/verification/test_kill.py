"""kill -9 at random moments: the file opens, holds everything but the last chunk, and says it is running."""

import random
import subprocess
import sys
import time

import numpy as np
import pytest
import xarray as xr

from floatsim.study.store import SAMPLES

KILLS = 20
# a system of about the size of a moored floater; some 2000 samples a second, as fast as a run comes
WRITER = """
import sys, time
import numpy as np
from floatsim.study.store import Channel, Coordinate, Writer
channels = [Channel(f"line_{k}_position", "position", "m", ("node", "xyz")) for k in range(3)]
channels += [Channel(f"line_{k}_tension", "tension", "N", ("node",)) for k in range(3)]
channels += [Channel(f"joint_{k}_force", "force", "N", ("xyz",)) for k in range(6)]
channels += [Channel("count", "number of the sample", "1", (), "int32")]
coordinates = [Coordinate("xyz", "axis", "1", "xyz", ("x", "y", "z")),
               Coordinate("arc_length", "arc length", "m", "node", np.arange(51.0))]
writer = Writer(sys.argv[1], channels, coordinates)
row = np.zeros(writer.width)
print("ready", flush=True)
k = 0
while True:
    row[:] = k
    writer.append(0.1 * k, row)
    k += 1
    if k % 64 == 0:
        print(k, flush=True)
        time.sleep(0.032)
"""


@pytest.mark.slow
def test_writer_killed_at_random_moments(tmp_path):
    moments = random.Random(2)
    held = []
    for kill in range(KILLS):
        path = tmp_path / f"out_{kill}.nc"
        process = subprocess.Popen([sys.executable, "-c", WRITER, str(path)], stdout=subprocess.PIPE, text=True)
        assert process.stdout is not None and process.stdout.readline() == "ready\n"
        time.sleep(moments.uniform(0.0, 1.0))
        process.kill()
        said = process.stdout.read().split()
        process.wait()
        appended = int(said[-1]) if said else 0  # at least so many
        with xr.open_dataset(path) as data:
            assert data.attrs["status"] == "running"
            n = data.sizes["time"]
            # a chunk may have been cut off by the kill: all before it must be there, and right
            whole = min(n, (appended // SAMPLES - 1) * SAMPLES)
            assert n >= (appended // SAMPLES) * SAMPLES - SAMPLES
            for name, variable in data.isel(time=slice(0, max(whole, 0))).variables.items():
                if "time" in variable.dims:
                    expected = np.arange(max(whole, 0)) * (0.1 if name == "time" else 1.0)
                    values = variable.values.reshape(len(expected), -1) if len(expected) else variable.values
                    assert np.allclose(values, expected.reshape(-1, *[1] * (values.ndim - 1)), rtol=1e-12), name
        held.append(n)
    assert max(held) >= 2 * SAMPLES  # the test reached the interesting part
