"""`State`: all that is saved and restarted. `Work`: the scratch of one evaluation."""

from __future__ import annotations

import copy
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from floatsim.frames import Array


@dataclass
class State:
    """State of a system at time t.

    x (n_point + 1, 3) [m] and q (n_rotation + 1, 4) unit quaternions, both ending with the ground;
    v, a: velocities and accelerations of points, then angular ones of rotations, world axes; aux: the
    integrator's auxiliary acceleration; lam: multipliers; step: the step size aux belongs to [s];
    history: memory of the parts that have one (radiation), by batch; pace: the step a run would take next [s]
    and how many went well in a row, so that a restart cuts steps where the run did.
    """

    t: float
    x: Array
    q: Array
    v: Array
    a: Array
    aux: Array
    lam: Array
    step: float = 0.0
    history: dict[int, Any] = field(default_factory=dict)
    pace: tuple[float, int] = (0.0, 0)

    def copy(self) -> State:
        """Independent copy, histories included."""
        return copy.deepcopy(self)


class Work:
    """What one evaluation reads and writes; allocated once.

    Reads: t, still (statics: no waves, no memory), x, R, v, a, lam, u (fluid velocity at points),
    du (its acceleration), eta (height of the water surface over points), cut (whether a line has parted at a point),
    c = (cM, cC, cK, cG, push, cap, tangent, friction, rounding): weights of mass, damping, stiffness and constraints in
    the matrix; the share of a line's axial stiffness that acts in compression and the most it may be [N]: 1 and inf
    outside statics; whether the matrix is asked for (0: residual alone); whether the seabed has friction;
    the share of the rounding errors in s (1 for a tolerance of 1e-8, less for a coarser one).
    Writes: A (entries by slot), r (residual), s (size of the forces at each point and rotation),
    trouble (what went wrong, by name), event (set by a commit after which accelerations jump), controlled (whether
    local errors are looked at).
    """

    def __init__(self, n_point: int, n_rotation: int, n: int, n_con: int, size: int) -> None:
        self.t = 0.0
        self.still = False
        self.trouble: str | None = None
        self.event = False
        self.controlled = False
        self.water: Any = None  # fluid kinematics at the wet points, with waves and without
        self.still_water: Any = None
        self.x = np.zeros((n_point + 1, 3))
        self.q = np.zeros((n_rotation + 1, 4))
        self.q[:, 0] = 1.0
        self.R = np.zeros((n_rotation + 1, 3, 3))
        self.R[:] = np.eye(3)
        self.v = np.zeros(n - n_con)
        self.a = np.zeros(n - n_con)
        self.aux = np.zeros(n - n_con)
        self.lam = np.zeros(n_con)
        self.u = np.zeros((n_point + 1, 3))
        self.du = np.zeros((n_point + 1, 3))
        self.eta = np.zeros(n_point + 1)
        self.cut = np.zeros(n_point + 1, dtype=bool)
        self.c = np.array([0.0, 0.0, 0.0, 0.0, 1.0, np.inf, 1.0, 1.0, 1.0])
        self.A = np.zeros(size + 1)
        self.r = np.zeros(n)
        self.s = np.zeros(n_point + n_rotation + 2)
