"""kill -9 at random moments: the file opens, holds everything but the last chunk, and says it is running."""

import multiprocessing
import os
import random
import time

import numpy as np
import pytest
import xarray as xr

import floatsim as fs
from floatsim.study.simulate import simulate
from floatsim.study.store import SAMPLES, Channel, Coordinate, Writer

KILLS = 20

pytestmark = [pytest.mark.slow, pytest.mark.skipif(os.name != "posix", reason="needs fork and SIGKILL")]


def killed(target, moments, latest, *arguments):
    """Run target(*arguments) in a process of its own and kill it; returns what its counter said just before."""
    context = multiprocessing.get_context("fork")
    counter = context.Value("l", -1, lock=False)
    process = context.Process(target=target, args=(counter, *arguments))
    process.start()
    while counter.value < 0:  # the file is there from now on
        assert process.is_alive()
        time.sleep(0.001)
    time.sleep(moments.uniform(0.0, latest))
    process.kill()
    process.join()
    assert process.exitcode == -9, "it came to its end before it was killed"
    return counter.value


def held(path, appended):
    """Number of samples that must be in a file: all but the last chunk. The file opens and says running."""
    with xr.open_dataset(path) as data:
        assert data.attrs["status"] == "running"
        n = data.sizes["time"]
    whole = max(appended // SAMPLES - 1, 0) * SAMPLES
    assert n >= whole
    return whole


def write_for_ever(counter, path):
    """A system of about the size of a moored floater, at some 4000 samples a second."""
    channels = [Channel(f"line_{k}_position", "position", "m", ("node", "xyz")) for k in range(3)]
    channels += [Channel(f"line_{k}_tension", "tension", "N", ("node",)) for k in range(3)]
    channels += [Channel(f"joint_{k}_force", "force", "N", ("xyz",)) for k in range(6)]
    channels += [Channel("count", "number of the sample", "1", (), "int32")]
    coordinates = [
        Coordinate("xyz", "axis", "1", "xyz", ("x", "y", "z")),
        Coordinate("arc_length", "arc length", "m", "node", np.arange(51.0)),
    ]
    writer = Writer(path, channels, coordinates)
    row = np.zeros(writer.width)
    k = 0
    while True:
        row[:] = k
        counter.value = k
        writer.append(0.1 * k, row)
        k += 1
        if k % 32 == 0:
            time.sleep(0.008)


def test_writer_killed_at_random_moments(tmp_path):
    moments = random.Random(2)
    most = 0
    for kill in range(KILLS):
        path = tmp_path / f"out_{kill}.nc"
        n = held(path, killed(write_for_ever, moments, 0.5, path))
        most = max(most, n)
        with xr.open_dataset(path) as data:
            for name, variable in data.isel(time=slice(0, n)).variables.items():
                if "time" in variable.dims:
                    values = variable.values.reshape(n, variable.size // max(n, 1))
                    expected = np.arange(n)[:, None] * (0.1 if name == "time" else 1.0)
                    assert np.allclose(values, expected, rtol=1e-12), name
    assert most >= 2 * SAMPLES  # the test reached the interesting part


def swinging_rope():
    rope = fs.Section(name="rope", mass_per_length=5.0, diameter=0.05, EA=1e7, axial_damping_ratio=0.5)
    return fs.Model(
        parts=[
            fs.Line(name="rope", section=rope, length=40.0, elements=20, end_b_position=(20.0, 0.0, 70.0)),
        ],
        joints=[fs.Ball(a="rope.end_a", b=(0.0, 0.0, 100.0))],
        sea=fs.Sea(depth=100.0),
    )


def test_run_killed_at_random_moments(tmp_path):
    system = fs.assemble(swinging_rope())
    start = system.initial_state()  # straight and slanted: it falls and swings
    reference = simulate(system, 60.0, 0.02, state=start)
    assert reference.status == "done", reference.failure
    times, tension = reference.time, reference.series("rope_tension")

    def run(counter, path):
        append = Writer.append

        def counting(self, t, values):
            counter.value = round(t / 0.02)
            append(self, t, values)

        Writer.append = counting  # in this process only
        simulate(system, 6000.0, 0.02, state=start, output=path)

    moments = random.Random(3)
    most = 0
    for kill in range(KILLS):
        path = tmp_path / f"run_{kill}.nc"
        n = min(held(path, killed(run, moments, 0.6, path)), len(times))
        most = max(most, n)
        with xr.open_dataset(path) as data:
            assert data.time.values[:n] == pytest.approx(times[:n], abs=1e-9)
            # the same run, so the same numbers
            assert (data.rope_tension.values[:n] == tension[:n]).all()
            for name, variable in data.isel(time=slice(0, n)).variables.items():
                if variable.dtype.kind == "f" and not str(name).endswith("_touchdown"):  # nan: no contact
                    assert np.isfinite(variable.values).all()
    assert most >= 2 * SAMPLES
