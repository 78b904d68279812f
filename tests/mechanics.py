"""Ways to look into an assembled system that several tests share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import floatsim as fs
from floatsim.frames import turn_quaternion

DRY = fs.Sea(depth=500.0)  # tests of plain mechanics stand above the water, z > 0


def residual(system: fs.System, w: Any) -> np.ndarray:
    """A copy of the residual of what is in the scratch."""
    system.evaluate(w)
    return w.r.copy()


def matrix(system: fs.System, w: Any, c: Sequence[float]) -> np.ndarray:
    """cM M + cC C + cK K (and cG G) as a dense matrix of all unknowns, c = (cM, cC, cK, cG)."""
    w.c[:4] = c
    system.evaluate(w)
    lay = system.layout
    A = np.zeros((system.n, system.n))
    A[lay.rows, lay.cols] = w.A[lay.slot]
    return A


def free_unknowns(system: fs.System) -> np.ndarray:
    """All unknowns but the ground's."""
    ground = [3 * system.n_point + m for m in range(3)] + [system.n_dof - 3 + m for m in range(3)]
    return np.setdiff1d(np.arange(system.n), ground)


def displace(system: fs.System, w: Any, i: int, by: float) -> None:
    """Move unknown i of the configuration in w; rotations by a spatial rotation vector."""
    from floatsim.frames import set_matrix

    if i < 3 * system.n_point:
        w.x[i // 3, i % 3] += by
    elif i < system.n_dof:
        k = i // 3 - system.n_point - 1
        phi = [0.0, 0.0, 0.0]
        phi[i % 3] = by
        w.q[k] = turn_quaternion(tuple(phi), tuple(w.q[k]))
        set_matrix(w.R, k, tuple(w.q[k]))
    else:
        w.lam[i - system.n_dof] += by


def natural_frequencies(system: fs.System, state: fs.State) -> np.ndarray:
    """Angular frequencies [rad/s] of the constrained linearised system about `state`, undamped, ascending."""
    from scipy.linalg import eigh, null_space

    w = system.work()
    system.load(w, state)
    w.still = True
    system.begin(w, state, state.t)
    free = free_unknowns(system)
    free = free[free < system.n_dof]
    M = matrix(system, w, (1.0, 0.0, 0.0, 1.0))
    K = matrix(system, w, (0.0, 0.0, 1.0, 1.0))[np.ix_(free, free)]
    G, M = M[system.n_dof :][:, free], M[np.ix_(free, free)]
    Z = null_space(G) if len(G) else np.eye(len(free))
    squares = eigh(Z.T @ (0.5 * (K + K.T)) @ Z, Z.T @ M @ Z, eigvals_only=True)
    return np.sqrt(np.maximum(squares, 0.0))


def run(
    system: fs.System, state: fs.State, scheme: fs.Scheme, h: float, steps: int,
    watch: Callable[[fs.State], Any] | None = None, tolerance: float = 1e-10, start: bool = True,
) -> list[Any]:  # fmt: skip
    """Step `state` in place from consistent accelerations; what `watch` sees at the start and after each step."""
    stepper = fs.Stepper(system, scheme, tolerance)
    if start:
        stepper.start(state, h)
    seen = [watch(state)] if watch else []
    for _ in range(steps):
        report = stepper.step(state, h)
        assert report.converged, report
        if watch:
            seen.append(watch(state))
    return seen


def end_force(system: fs.System, state: fs.State, joint: str) -> np.ndarray:
    """Force (3,) that the joint's side a exerts on side b."""
    row = system.joint_rows[joint][0][0]
    return state.lam[3 * row : 3 * row + 3].copy()


def observed_order(errors: Sequence[float], ratio: float = 2.0) -> float:
    """Order from the two finest of errors whose steps shrink by `ratio`."""
    return float(np.log(errors[-2] / errors[-1]) / np.log(ratio))
