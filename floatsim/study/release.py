"""Decay tests: displace a body in one degree of freedom, let everything else find its equilibrium, let go.

The release pose is the static equilibrium plus the offset (`release='equilibrium'`), or the drawing
position plus the offset with all else zero (`release='absolute'`, what OpenFAST does). Lines start in
static equilibrium with the displaced body.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from floatsim.description import is_number
from floatsim.errors import CaseError, nearest
from floatsim.frames import Array, angles_from_matrix, matrix_from_angles, quaternion_from_matrix, set_matrix
from floatsim.model import Model
from floatsim.parts.body import Body
from floatsim.solve.modes import natural_modes
from floatsim.solve.scheme import Scheme
from floatsim.solve.static import solve_static
from floatsim.study.decay import DecayFit, fit_decay
from floatsim.study.simulate import Progress, Run, as_system, positive_seconds, run_or_raise, simulate
from floatsim.study.store import check_path
from floatsim.system.state import State
from floatsim.system.system import System

DOFS = ("surge", "sway", "heave", "roll", "pitch", "yaw")
DEFAULT_PERIODS = 8.0  # duration in natural periods of the mode


@dataclass(frozen=True)
class DecayTest:
    """Result of a decay test.

    body, dof; offset in metres (surge, sway, heave) or degrees (roll, pitch, yaw), as `equilibrium`, the value of
    the degree of freedom at rest; fit: periods and damping in the same unit; run: where the results are.
    expected_period [s]: what the model's source states, or None.
    """

    body: str
    dof: str
    offset: float
    equilibrium: float
    fit: DecayFit
    run: Run
    expected_period: float | None


def decay_test(
    model: Model | System,
    dof: str,
    offset: float,
    *,
    body: str | None = None,
    release: Literal["equilibrium", "absolute"] = "equilibrium",
    duration: float | None = None,
    dt: float = 0.1,
    output: str | Path | None = None,
    channels: str | Sequence[str] = "all",
    scheme: Scheme | None = None,
    attributes: dict[str, Any] | None = None,
    progress: Progress | None = None,
) -> DecayTest:
    """Release `body` (default: the only one) from `offset` (m, or degrees for rotations) in `dof`.

    duration [s]: default eight periods of the mode. Raises CaseError for an unknown degree of freedom, body or
    release, SolveFailed if there is no equilibrium or the run does not arrive.
    """
    if dof not in DOFS:
        raise CaseError(f"decay: there is no degree of freedom '{dof}'{nearest(str(dof), DOFS)}")
    if not is_number(offset) or offset == 0.0:
        raise CaseError(f"decay: offset: got {offset!r}; must be a number other than zero, m or (rotations) degrees")
    if DOFS.index(dof) >= 3 and abs(offset) >= 90.0:
        raise CaseError(f"decay: offset: got {offset:g} degrees of {dof}; must be less than 90 degrees either way")
    if release not in ("equilibrium", "absolute"):
        raise CaseError(f"decay: release: got {release!r}; must be 'equilibrium' or 'absolute'")
    dt = positive_seconds("dt", dt)
    if duration is not None:
        duration = positive_seconds("duration", duration)
    if output is not None:
        check_path(output)
    system = as_system(model)
    name = _body(system, body)
    index = DOFS.index(dof)
    rest, _ = solve_static(system)
    at_rest = pose(system, rest, name)
    drawn = np.radians(system.numbering.parts[system.numbering.index(name)].attitude_deg)
    start = at_rest.copy() if release == "equilibrium" else np.concatenate([np.zeros(3), drawn])
    start[index] += offset if index < 3 else np.radians(offset)
    released = displace(system, rest, name, start)
    _check_joints(system, released, name)
    if duration is None:
        duration = DEFAULT_PERIODS * _period(system, rest, f"{name} {dof}")
    displaced, _ = solve_static(system, released, hold=[name])
    _check_held(system, displaced, name, start)
    settings: dict[str, Any] = {
        "decay_body": name, "decay_dof": dof, "decay_offset": float(offset), "decay_release": release,
    }  # fmt: skip
    run = run_or_raise(simulate(
        system, duration, dt, state=displaced, output=output, channels=channels, scheme=scheme,
        attributes={**(attributes or {}), **settings}, progress=progress,
    ))  # fmt: skip
    unit = 1.0 if index < 3 else 180.0 / np.pi
    series = unit * run.series(f"{name}_position")[:, index]
    fit = fit_decay(run.time, series, equilibrium=unit * at_rest[index])
    expected = system.model.expected.periods_s.get(dof)
    return DecayTest(name, dof, float(offset), float(unit * at_rest[index]), fit, run, expected)


def pose(system: System, state: State, body: str) -> Array:
    """Displacement from the drawing position [m] and roll, pitch, yaw [rad] of a body, (6,)."""
    p, k = _indices(system, body)
    R = np.zeros((1, 3, 3))
    set_matrix(R, 0, tuple(state.q[k]))
    return np.concatenate([state.x[p] - system.x0[p], angles_from_matrix(R[0])])


def displace(system: System, state: State, body: str, where: Array) -> State:
    """Copy of a state with one body at another pose (6,): see `pose`. Everything else stays."""
    p, k = _indices(system, body)
    new = state.copy()
    new.x[p] = system.x0[p] + where[:3]
    new.q[k] = quaternion_from_matrix(matrix_from_angles(*where[3:]))
    return new


def _check_joints(system: System, state: State, body: str) -> None:
    """Raises CaseError if a joint is opened by the pose of `body` and no other part could close it again."""
    if system.n_con == 0:
        return
    w = system.work()
    system.load(w, state)
    system.constraints.move(state.t)
    G = system.jacobian(w)
    gap = np.abs(w.r[system.n_dof :])
    others = abs(G[:, np.setdiff1d(np.arange(system.n_dof), system.unknowns_of([body]))]).sum(axis=1)
    stuck = np.flatnonzero((gap > 1e-6 * system.length) & (np.asarray(others).ravel() == 0.0))
    if len(stuck):
        worst = int(stuck[np.argmax(gap[stuck])])
        raise CaseError(
            f"decay: '{body}' cannot be released from this offset: joint '{system.row_name(worst)}' would be open by "
            f"{gap[worst]:.4g} m (or rad); choose a degree of freedom that the joint leaves free"
        )


def _check_held(system: System, state: State, body: str, where: Array) -> None:
    """Raises CaseError if joints have moved `body` away from the pose it was put at."""
    off = np.abs(pose(system, state, body) - where)
    if off[:3].max() > 1e-6 * system.length or off[3:].max() > 1e-6:
        raise CaseError(
            f"decay: '{body}' cannot be released from this offset: its joints do not let it be there and move it by "
            f"{off[:3].max():.4g} m and {np.degrees(off[3:].max()):.4g} deg; a body on a hinge turns about the hinge, "
            "not about its reference point: start simulate() from such a state, as `swung` of models/oswec.py makes it"
        )


def _indices(system: System, body: str) -> tuple[int, int]:
    num = system.numbering
    k = num.index(body)
    return num.first_point[k], num.first_rotation[k]


def _body(system: System, body: str | None) -> str:
    names = [part.name for part in system.model.parts if isinstance(part, Body)]
    if body is None:
        if len(names) == 1:
            return names[0]
        if not names:
            raise CaseError(f"decay: the model '{system.model.name}' has no body that could be released")
        raise CaseError(f"decay: the model has {len(names)} bodies ({', '.join(names)}); say which one to release")
    if body not in names:
        raise CaseError(f"decay: there is no body '{body}'{nearest(str(body), names)}")
    return body


def _period(system: System, rest: State, name: str) -> float:
    """Natural period of the mode in which `name` moves most."""
    modes = natural_modes(system, rest)
    best = max(modes, key=lambda mode: mode.shares.get(name, 0.0))
    if not np.isfinite(best.period) or best.shares.get(name, 0.0) < 0.2:
        raise CaseError(f"decay: no natural period was found in which '{name}' moves; give a duration")
    return best.period
