"""A copied or pickled state goes on exactly like the one it was made from."""

import pickle
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import floatsim as fs

HYDRO = Path(__file__).parents[2] / "models" / "volturnus_s_hydro.nc"


@pytest.mark.parametrize("copied", [fs.State.copy, lambda state: pickle.loads(pickle.dumps(state))])
def test_a_copy_in_the_middle_of_a_run_continues_bit_for_bit(copied: Callable[[fs.State], fs.State]) -> None:
    """The copy carries its radiation memory: a copy that lost it would feel another damping."""
    body = fs.Body(
        name="floater", mass=2.0e7, inertia=(4.4e10, 4.4e10, 2.4e10), hydro=fs.PotentialFlow(database=HYDRO)
    )
    system = fs.assemble(fs.Model(parts=[body], sea=fs.Sea(depth=200.0)))
    state = system.initial_state()
    state.x[0, 2] += 1.0
    stepper = fs.Stepper(system)
    stepper.start(state, 0.1)
    for _ in range(50):
        assert stepper.step(state, 0.1).converged
    copy = copied(state)
    for _ in range(50):
        stepper.step(state, 0.1)
    other = fs.Stepper(system)
    for _ in range(50):
        other.step(copy, 0.1)
    np.testing.assert_array_equal(state.x, copy.x)
    np.testing.assert_array_equal(state.a, copy.a)
