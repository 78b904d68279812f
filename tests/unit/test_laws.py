"""Laws of a user's own: any number of rows of memory."""

import numpy as np
import pytest

import floatsim as fs

EA = 1e7


class Remembering:
    """The law of Engineering(), which also keeps its last strains without using them."""

    stiffness = EA

    def __init__(self, memory):
        self.memory = memory

    def start(self, s):
        return np.tile(s - 1.0, (self.memory, 1))

    def bind(self, damping):
        def evaluate(s, rate, old, new, h, out):
            new[:] = np.vstack([s - 1.0, old])[: self.memory]
            out[0], out[1], out[2] = EA * (s - 1.0) + damping * rate, EA, damping

        return evaluate


def tensions(law):
    rope = fs.Section(name="rope", mass_per_length=5.0, diameter=0.08, EA=EA, axial_damping=1e4, axial_law=law)
    line = fs.Line(name="rope", section=rope, length=100.0, elements=10)
    ends = [fs.Ball(a="rope.end_a", b=(0.0, 0.0, 50.0)), fs.Ball(a="rope.end_b", b=(90.0, 0.0, 50.0))]
    sea = fs.Sea(depth=50.0, waves=fs.RegularWave(height=2.0, period=5.0), wave_ramp=0.0)
    return fs.simulate(fs.Model(parts=[line], joints=ends, sea=sea), duration=1.0).series("rope_tension")


@pytest.mark.parametrize("memory", [0, 1, 2, 5])
def test_memory_of_any_size(memory):
    assert np.array_equal(tensions(Remembering(memory)), tensions(fs.Engineering()))
