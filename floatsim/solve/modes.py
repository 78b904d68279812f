"""Natural modes of the constrained, linearised system about an equilibrium.

    [K - w^2 (M + A(w) - A_inf)] phi = 0   on the null space of G,

with the added mass of every mode at its own frequency (iterated), and the damping ratio of the waves it
makes, zeta = phi^T B(w) phi / (2 w phi^T M(w) phi). K is the tangent at the equilibrium, multipliers
included; there its skew part vanishes for conservative loads and the symmetric part is used. Drag and
other damping do not enter. Shapes are labelled by their share of kinetic energy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from floatsim.errors import CaseError, SolveFailed
from floatsim.frames import Array
from floatsim.model import Model
from floatsim.solve.linear import LinearSolver
from floatsim.solve.static import solve_static
from floatsim.system.state import State
from floatsim.system.system import System, assemble

_ITERATIONS = 30
_NAMES = ("surge", "sway", "heave", "roll", "pitch", "yaw")


@dataclass(frozen=True)
class Mode:
    """One natural mode: period [s] (inf: free to drift), omega [rad/s], damping ratio from radiation [-],
    shape (n_dof,) in the system's velocity unknowns, shares of kinetic energy by name, largest first."""

    period: float
    omega: float
    damping_ratio: float
    shape: Array
    shares: dict[str, float]

    @property
    def label(self) -> str:
        """The largest shares in words, down to 5 %."""
        return ", ".join(f"{name} {100.0 * share:.0f} %" for name, share in self.shares.items() if share >= 0.05)


def natural_modes(model: Model | System, state: State | None = None, count: int = 12) -> tuple[Mode, ...]:
    """The `count` slowest natural modes about `state` (default: the static equilibrium).

    Raises SolveFailed if there is no equilibrium or if it is unstable (with the direction that is),
    CaseError if count is not positive.
    """
    if isinstance(count, bool) or not isinstance(count, int) or count < 1:
        raise CaseError(f"natural_modes: count is {count!r}; a positive whole number is allowed")
    from scipy.linalg import eigh, null_space

    system = model if isinstance(model, System) else assemble(model)
    if state is None:
        state, _ = solve_static(system)
    M, K, G = _matrices(system, state)
    Z = null_space(G) if len(G) else np.eye(system.n_dof)
    ground = _ground(system)
    Z = Z[:, np.abs(Z[ground]).max(axis=0) < 0.5] if not len(G) else _without(Z, ground)
    Kz = Z.T @ K @ Z
    Kz = 0.5 * (Kz + Kz.T)
    top = min(count + 4, Z.shape[1]) - 1

    def solve(omega: float) -> tuple[Array, Array, Array]:
        dM, _ = _frequency_terms(system, omega)
        Mz = Z.T @ (M + dM) @ Z
        values, vectors = eigh(Kz, 0.5 * (Mz + Mz.T), subset_by_index=[0, top])
        return values, vectors, Mz

    values, vectors, Mz = solve(0.0)
    modes = []
    for k in range(min(count, top + 1)):
        modes.append(_own_frequency(system, solve, Z, M, values[k], vectors[:, k], Mz))
    return tuple(sorted(modes, key=lambda mode: -mode.period))


def _own_frequency(system, solve, Z, M, value, vector, Mz) -> Mode:  # type: ignore[no-untyped-def]
    """Follow one mode until its added mass belongs to its own frequency."""
    scale = abs(value)
    for _ in range(_ITERATIONS):
        if value < -1e-6:
            shares = _shares(system, Z @ vector, M)
            raise SolveFailed(
                f"the equilibrium is unstable: {next(iter(shares))} has negative stiffness (e-folding time "
                f"{1.0 / np.sqrt(-value):.3g} s)"
            )
        omega = float(np.sqrt(max(value, 0.0)))
        values, vectors, new_Mz = solve(omega)
        likeness = np.abs(vectors.T @ (new_Mz @ vector)) / np.sqrt(vector @ new_Mz @ vector)
        k = int(np.argmax(likeness))
        change = abs(values[k] - value)
        value, vector, Mz = values[k], vectors[:, k], new_Mz
        if change <= 1e-10 * max(scale, abs(value)):
            break
    omega = float(np.sqrt(max(value, 0.0)))
    _, B = _frequency_terms(system, omega)
    shape = Z @ vector
    drifting = omega < 1e-6
    zeta = 0.0 if drifting else max(0.0, float(shape @ B @ shape / (2.0 * omega * (vector @ Mz @ vector))))
    return Mode(np.inf if drifting else 2.0 * np.pi / omega, omega, zeta, shape, _shares(system, shape, M))


def _matrices(system: System, state: State) -> tuple[Array, Array, Array]:
    """Dense M, K (multipliers included) and G at a state at rest, (n_dof, n_dof) and (n_con, n_dof)."""
    w = system.work()
    system.load(w, state)
    w.v[:] = 0.0
    w.a[:] = 0.0
    w.still = True
    system.begin(w, state, state.t)
    linear = LinearSolver(system.layout)
    n = system.n_dof
    out = []
    for c in ((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 1.0, 1.0)):
        w.c[:4] = c
        system.evaluate(w)
        out.append(linear.matrix(w.A).toarray())
    return out[0][:n, :n], out[1][:n, :n], out[1][n:, :n]


def _ground(system: System) -> Array:
    xyz = np.arange(3)
    return np.concatenate([3 * system.n_point + xyz, 3 * (system.n_point + 1 + system.n_rotation) + xyz])


def _without(Z: Array, ground: Array) -> Array:
    """Columns of Z rotated so that the ground's six stand alone, and those six left out."""
    _, _, vt = np.linalg.svd(Z[ground], full_matrices=True)
    return Z @ vt[6:].T


def _frequency_terms(system: System, omega: float) -> tuple[Array, Array]:
    """A(w) - A_inf and B(w) of everything that has them, in the velocity unknowns."""
    dM, B = np.zeros((system.n_dof, system.n_dof)), np.zeros((system.n_dof, system.n_dof))
    for batch in system.batches:
        if hasattr(batch, "frequency_terms"):
            for dofs, mass, damping in zip(*batch.frequency_terms(omega, system.n_point), strict=True):
                dM[np.ix_(dofs, dofs)] += mass
                B[np.ix_(dofs, dofs)] += damping
    return dM, B


def _shares(system: System, shape: Array, M: Array) -> dict[str, float]:
    """Share of kinetic energy by body degree of freedom and by part without rotation."""
    energy = shape * (M @ shape)
    total = energy.sum()
    num = system.numbering
    shares: dict[str, float] = {}
    for part, p, k in zip(num.parts, num.first_point, num.first_rotation, strict=True):
        if part.n_rotations:
            r = 3 * (system.n_point + 1 + k)
            for name, value in zip(_NAMES, (*energy[3 * p : 3 * p + 3], *energy[r : r + 3]), strict=True):
                shares[f"{part.name} {name}"] = float(value / total)
        elif part.n_points:
            shares[part.name] = float(energy[3 * p : 3 * (p + part.n_points)].sum() / total)
    return dict(sorted(shares.items(), key=lambda item: -item[1]))
