"""Bottom-hinged flap in 10.9 m of water: the oscillating surge converter (OSWEC) of WEC-Sim's examples.

Sources: [W] WEC-Sim's example OSWEC (Apache-2.0), the same in HydroChrono's decay demo (MIT): masses, hinge, surface;
[B] oswec_bem.py: the database. The flap is lighter than the water it displaces, so buoyancy raises it and it swings
about upright; the base is fixed to the seabed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np

import floatsim as fs
from floatsim.hydro.meshing import Mesh, grid, join

DEPTH, DENSITY, GRAVITY = 10.9, 1000.0, 9.81  # m, kg/m3, m/s2 [W]
MASS, PITCH_INERTIA = 127e3, 1.85e6  # kg; kg m2 about the centre of mass; [W] gives the same about all axes
CENTRE, HINGE = -3.9, -8.9  # m, z of the centre of mass and of the hinge [W]
BASE_CENTRE, BASE_MASS = -10.15, 999.0  # m; kg: it does not move [W]
WIDTH, THICKNESS, ROUND_CENTRE, TOP = 18.0, 1.8, -8.5, 2.1  # m: a box up to TOP on a half cylinder [W, surface]
STOP_STIFFNESS, STOP_DAMPING = 2e9, 2e9  # N m/rad, N m s/rad2: ours

HYDRO = Path(__file__).with_name("oswec_hydro.nc")  # made by oswec_bem.py


def flap_mesh(size: float = 0.6) -> Mesh:
    """Closed surface of the flap in panels of about `size` [m], from its centre of mass."""
    r, half = 0.5 * THICKNESS, 0.5 * WIDTH
    arc = np.radians(np.linspace(0.0, 90.0, 8))
    z = np.linspace(ROUND_CENTRE, TOP, 1 + round((TOP - ROUND_CENTRE) / size))
    level = np.concatenate([ROUND_CENTRE - r * np.cos(arc), z[1:]])[:, None] - CENTRE
    breadth = np.concatenate([r * np.sin(arc), np.full(len(z) - 1, r)])[:, None]
    y, s = np.linspace(-half, half, 1 + round(WIDTH / size)), np.linspace(-1.0, 1.0, 1 + round(THICKNESS / size))

    def sheet(x: np.ndarray, y: np.ndarray | float, z: np.ndarray | float, turned: bool) -> Mesh:
        points = np.stack(np.broadcast_arrays(x, y, z), axis=-1)
        return grid(points.swapaxes(0, 1) if turned else points)

    return join(
        sheet(breadth, y, level, True), sheet(-breadth, y, level, False), sheet(breadth * s, -half, level, True),
        sheet(breadth * s, half, level, False), sheet(r * s[:, None], y, TOP - CENTRE, False),
    )  # fmt: skip


def build(
    damping: float = 0.0,
    end_stop_deg: float | None = None,
    laws: Sequence[object] = (),
    nonlinear: bool = False,
    radiation: Literal["convolution", "state_space"] = "convolution",
    hydro: str | Path | object = HYDRO,
    waves: object = None,
    wave_ramp: float = 100.0,
) -> fs.Model:
    """The flap on its hinge, pitch 0 upright.

    damping [N m s/rad]: of a linear PTO on the hinge (its case file has 12e6, its decay none). end_stop_deg:
    stops at this angle either way. laws: more of them. nonlinear: hydrostatics and Froude-Krylov forces on the flap's
    instantaneous wet surface. hydro: database or its path. waves, wave_ramp: see floatsim.Sea.
    """
    inertia = (PITCH_INERTIA,) * 3
    hull = fs.Hull(mesh=flap_mesh()) if nonlinear else None
    flap = fs.Body(
        name="flap", mass=MASS, inertia=inertia, position=(0.0, 0.0, CENTRE),
        points={"hinge": (0.0, 0.0, HINGE - CENTRE)},
        hydro=fs.PotentialFlow(database=hydro, body="flap", hull=hull, radiation=radiation),
    )  # fmt: skip
    base = fs.Body(
        name="base", mass=BASE_MASS, inertia=(BASE_MASS,) * 3, position=(0.0, 0.0, BASE_CENTRE),
        points={"hinge": (0.0, 0.0, HINGE - BASE_CENTRE)},
        hydro=fs.PotentialFlow(
            database=hydro, body="base", radiation=radiation,
            displaced_volume=BASE_MASS / DENSITY,  # it stands on the seabed, with no water under it that would lift it
        ),
    )  # fmt: skip
    parts: list[object] = [flap, base]
    every = [fs.Linear(damping=damping)] if damping else []
    if end_stop_deg is not None:
        stop = math.radians(end_stop_deg)
        every.append(fs.EndStop(lower=-stop, upper=stop, stiffness=STOP_STIFFNESS, damping=STOP_DAMPING))
    every += laws
    if every:
        parts.append(fs.PTO(name="pto", joint="hinge", laws=every))
    return fs.Model(
        name="oswec",
        parts=parts,
        joints=[
            fs.Hinge(a="flap.hinge", b="base.hinge", axis=(0.0, 1.0, 0.0), name="hinge"),
            fs.Weld(a="base", b=(0.0, 0.0, BASE_CENTRE), name="foundation"),
        ],
        sea=fs.Sea(depth=DEPTH, density=DENSITY, waves=waves, wave_ramp=wave_ramp),
        gravity=GRAVITY,
    )


def swung(system: fs.System, pitch_deg: float) -> fs.State:
    """At rest with the flap swung about its hinge."""
    state = system.initial_state()
    k, angle = system.numbering.index("flap"), math.radians(pitch_deg)
    point, rotation = system.numbering.first_point[k], system.numbering.first_rotation[k]
    arm = CENTRE - HINGE
    state.x[point] = arm * math.sin(angle), 0.0, HINGE + arm * math.cos(angle)
    state.q[rotation] = math.cos(0.5 * angle), 0.0, math.sin(0.5 * angle), 0.0
    return state
