"""kill -9 at random moments of `floatsim run`: the file opens, holds all but the last chunk, says it is running."""

import os
import random
import struct
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from floatsim.study.store import SAMPLES

KILLS = 20
MODEL = Path(__file__).parents[2] / "models" / "hanging_chain.py"
# the program itself, with a counter of samples on the side that outlives it
PROGRAM = """
import os, struct, sys
from floatsim.cli import main
from floatsim.study.store import Writer
counter, append = os.open(sys.argv.pop(1), os.O_WRONLY), Writer.append
def counting(self, t, values):
    append(self, t, values)
    self.count = getattr(self, "count", 0) + 1
    os.pwrite(counter, struct.pack("q", self.count), 0)
Writer.append = counting
main()
"""


def samples(counter):
    return struct.unpack("q", counter.read_bytes())[0]


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="needs SIGKILL")
def test_run_command_killed_at_random_moments(tmp_path, record):
    moments = random.Random(5)
    good, most = 0, 0
    for kill in range(KILLS):
        path, counter = tmp_path / f"run_{kill}.nc", tmp_path / f"count_{kill}"
        counter.write_bytes(struct.pack("q", 0))
        command = [
            sys.executable,
            "-c",
            PROGRAM,
            str(counter),
            "run",
            str(MODEL),
            "--duration",
            "100000",
            "-o",
            str(path),
        ]
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            while samples(counter) == 0:
                assert process.poll() is None
                time.sleep(0.005)
            time.sleep(moments.uniform(0.0, 1.0))
            assert process.poll() is None
            process.kill()
        appended = samples(counter)
        with xr.open_dataset(path) as data:
            n = data.sizes["time"]
            whole = appended // SAMPLES * SAMPLES
            held = n >= whole and np.allclose(data.time.values[:whole], 0.1 * np.arange(whole))
            solid = [v for name, v in data.data_vars.items() if not str(name).endswith("_touchdown")]  # nan: no contact
            finite = all(np.isfinite(v.values[:whole]).all() for v in solid)
            good += held and finite and data.attrs["status"] == "running" and data.attrs["failure"] == ""
        most = max(most, n)
        path.unlink()
    assert most >= 2 * SAMPLES  # the test reached the interesting part
    record("kill -9", "runs killed at random moments whose file holds all but the last chunk", good, (KILLS, KILLS))
