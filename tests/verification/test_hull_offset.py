"""A floater that floats far from where it was drawn: waves that meet it where it is do not know where it was drawn."""

import sys

import numpy as np
import pytest
from shipped import MODELS, load

import floatsim as fs


def moored(x: float, hull: bool, slow: bool | None) -> fs.Model:
    """The flat ellipsoid on three springs that pull it to x = 0, drawn at x [m]."""
    sys.path.insert(0, str(MODELS))
    e, sphere = load("ellipsoid"), load("sphere")
    mesh = fs.Hull(mesh=sphere.mesh(e.SEMI_AXES, 36, 30), mesh_origin=(0.0, 0.0, 2.0)) if hull else None
    flow = fs.PotentialFlow(database=e.HYDRO, hull=mesh, memory=30.0, memory_grid=0.05, slow_position=slow)
    body = fs.Body(name="e", mass=e.MASS, inertia=(1e6, 1e6, 1.4e6), position=(x, 0.0, -2.0), hydro=flow)
    springs = [
        fs.Spring(name=f"s{k}", a="e", b=(30.0 * np.cos(q), 30.0 * np.sin(q), -2.0), stiffness=2e4, free_length=20.0)
        for k, q in enumerate(2.0 * np.pi / 3.0 * np.arange(3))
    ]
    return fs.Model(name="e", parts=[body, *springs], sea=fs.Sea(depth=70.0, density=1000.0), gravity=9.81)


@pytest.mark.parametrize(("hull", "slow"), [(False, True), (True, True), (True, None)])
def test_the_response_does_not_depend_on_the_drawing(hull, slow):
    here, there = (
        fs.frequency_response(moored(x, hull, slow), [1.0, 1.6]).rao("e_position")[:, [0, 2, 4]] for x in (0.0, 15.0)
    )
    assert np.all(np.abs(there - here).max(axis=0) < 1e-3 * np.abs(here).max(axis=0))
