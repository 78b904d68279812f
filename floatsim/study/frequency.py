"""Frequency domain: the small motions of the same system about its static equilibrium in waves of one frequency.

    (-w^2 (M + A(w)) + i w (C + B(w)) + K) xi + G^T lam = X(w),        G xi = 0

M, C, K and G are those of the time domain at the equilibrium, moorings, cables, joints and PTOs included, with A, B
and X of whatever part has them; X of lines, members (up to the moving surface) and hulls is their force differentiated
by the amplitude of each wave. Amplitudes are complex, per metre of wave, time factor e^{+i w t}, phases about a
crest at the world's origin. Any channel of a run has a response: the channel is differentiated along the solution.

In a sea (a spectrum) drag and whatever else depends on velocities in a nonlinear way is linearised stochastically:
C = E[df/dv] over the Gaussian velocities of the response (and of the water at lines and members), which for one
component with B |v| v is sqrt(8/pi) sigma B v (Roberts & Spanos 1990, Random Vibration and Statistical Linearization,
section 5.3). The expectation is a mean over SAMPLES quasi-random states; the force of waves on lines and members is
E[df/da] likewise, over WAVE_SAMPLES of them; the response is found by repetition until its velocities stay. Without a
spectrum C is that of the state at rest, and drag does not damp.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from floatsim.errors import CaseError, SolveFailed
from floatsim.frames import Array, turn_quaternion
from floatsim.model import Model
from floatsim.sea.dispersion import wave_number
from floatsim.sea.kinematics import exact
from floatsim.sea.waves import Realisation
from floatsim.solve.linear import LinearSolver
from floatsim.solve.static import solve_static
from floatsim.study.channels import Sampler
from floatsim.study.simulate import as_system
from floatsim.system.state import State, Work
from floatsim.system.system import System

Complex = NDArray[np.complex128]

SAMPLES = 1024  # states the damping is averaged over, at least; a power of two
WAVE_SAMPLES = 256  # the same for the drag of waves on lines and members: good to about 1 % of that force
MAX_ROUNDS = 50
_SETTLED = 1e-3  # of the largest standard deviation of velocities, its change from round to round
_QUADRATIC = ("W", "J")  # units of channels without a linear response
_SMALL = 1e-4  # m, amplitude of the wave that channels are differentiated with
_RANGE = (0.05, 3.0, 0.05)  # rad/s, where no database says better


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """Responses to waves of one heading. Make it with `frequency_response`.

    omega (n,) rad/s; heading_deg; density (n,) m2 s/rad of the sea, or None; motion (n, n_dof) complex: displacements
    in the system's velocity unknowns (rotations as small turns), per metre; multipliers (n, n_con) N/m; state: the
    equilibrium.
    """

    omega: Array
    heading_deg: float
    density: Array | None
    motion: Complex
    multipliers: Complex
    state: State
    sampler: Sampler = field(repr=False)
    linear: Linear = field(repr=False)
    rounds: int = 0

    def rao(self, channel: str) -> Complex:
        """Response of an output channel (n, ...) per metre of wave amplitude, as a run would show it in small waves.

        Raises CaseError for a channel that is not there, and for powers and energies, which go with the square.
        """
        for c in self.sampler.channels:
            if c.name == channel and c.units in _QUADRATIC:
                raise CaseError(
                    f"frequency_response: '{channel}' [{c.units}] goes with the square of the waves and has no linear "
                    "response; find it from force and velocity, or from a run"
                )
        rows = self._rows
        return self.sampler.column(rows.real, channel) + 1j * self.sampler.column(rows.imag, channel)

    def spectrum(self, channel: str) -> Array:
        """One-sided spectrum (n, ...) of a channel in the sea, its unit squared s/rad. CaseError without a sea."""
        if self.density is None:
            raise CaseError("frequency_response: spectra need a sea; give spectrum=Jonswap(hs=..., tp=...)")
        rao = self.rao(channel)
        return np.abs(rao) ** 2 * self.density.reshape(-1, *[1] * (rao.ndim - 1))

    def std(self, channel: str) -> Any:
        """Standard deviation of a channel in the sea, its shape without the frequencies. CaseError without a sea."""
        return np.sqrt(np.trapezoid(self.spectrum(channel), self.omega, axis=0))

    @cached_property
    def _rows(self) -> Complex:
        """Every channel's response, differentiated along the solution."""
        rows = np.zeros((len(self.omega), self.sampler.width), dtype=complex)
        for k in range(len(self.omega)):
            # a quarter of a period earlier the real part of the motion is the imaginary part of the amplitude
            for turn, part in ((1.0, 1.0), (-1j, 1j)):
                ahead, back = (self._sample(sign * _SMALL * turn, k) for sign in (1.0, -1.0))
                rows[k] += part * (ahead - back) / (2.0 * _SMALL)
        self.linear.calm()
        for channel in self.sampler.channels:
            if channel.name == "wave_elevation":
                rows[:, self.sampler.columns(channel.name)] = 1.0
        return rows

    def _sample(self, z: complex, k: int) -> Array:
        """All channels in wave k of complex amplitude z [m], at its phase zero."""
        system, state, w, omega = self.sampler.system, self.state, self.linear.work, self.omega[k]
        xi = z * self.motion[k]
        system.load(w, state)
        _displace(system, w, xi.real)
        w.v[:] = (1j * omega * xi).real
        w.a[:] = (-(omega**2) * xi).real
        w.lam += (z * self.multipliers[k]).real
        w.still = True
        w.c[6] = 0.0
        system.begin(w, state, state.t)
        self.linear.wave(z, k)
        system.evaluate(w)
        return self.sampler.sample(w)

    def dataset(self) -> Any:
        """All responses as an xarray Dataset: amplitude and phase [rad] over omega, standard deviations with a sea."""
        import xarray

        coordinates: dict[str, Any] = {"omega": ("omega", self.omega, {"units": "rad/s", "long_name": "frequency"})}
        coordinates |= {c.name: (c.dim, np.asarray(c.values), c.attributes) for c in self.sampler.coordinates}
        data: dict[str, Any] = {}
        rows = self._rows
        for c in self.sampler.channels:
            if c.dtype != "float" or c.name == "step_size" or c.units in _QUADRATIC:
                continue
            part = self.sampler.column(rows.real, c.name) + 1j * self.sampler.column(rows.imag, c.name)
            unit = {"units": f"({c.units})/m", **({"units_dof": c.units_dof} if c.units_dof else {})}
            text = c.long_name
            for kind, value, units in (("amplitude", np.abs(part), unit), ("phase", np.angle(part), {"units": "rad"})):
                data[f"{c.name}_{kind}"] = (("omega", *c.dims), value, {**units, "long_name": f"{kind}, {text}"})
            if self.density is not None:
                weight = self.density.reshape(-1, *[1] * (part.ndim - 1))
                value = np.sqrt(np.trapezoid(np.abs(part) ** 2 * weight, self.omega, axis=0))
                data[f"{c.name}_std"] = (c.dims, value, {**c.attributes, "long_name": f"standard deviation, {text}"})
        return xarray.Dataset(data, coordinates, {"heading_deg": self.heading_deg})


def frequency_response(
    model: Model | System,
    omega: Sequence[float] | Array | None = None,
    *,
    heading_deg: float = 0.0,
    spectrum: Any = None,
    channels: str | Sequence[str] = "all",
    state: State | None = None,
) -> FrequencyResponse:
    """Responses at the frequencies `omega` [rad/s] (default: those of the hydrodynamic database, from 0.05 rad/s) to
    waves towards `heading_deg`, about the static equilibrium or `state`.

    spectrum: a sea (any object with density(omega)), for stochastic linearisation, spectra and standard deviations.
    The waves of the model's own sea are not looked at.

    Raises CaseError for bad input, SolveFailed if there is no equilibrium, if the system is singular at a frequency,
    or if the linearisation does not settle.
    """
    system = as_system(model)
    if system.model.wind is not None:
        raise CaseError(
            "frequency_response: the model has a wind; the controllers of rotors are left out in the frequency domain, "
            "and with them their damping: build the model without a wind"
        )
    w0 = _frequencies(system, omega)
    if not math.isfinite(heading_deg):
        raise CaseError(f"frequency_response: heading_deg is {heading_deg!r}; must be a finite number")
    density = None
    if spectrum is not None:
        if not callable(getattr(spectrum, "density", None)):
            raise CaseError(f"frequency_response: spectrum: got {spectrum!r}; must have density(omega)")
        density = np.asarray(spectrum.density(w0), dtype=float)
        if density.shape != w0.shape or not np.all(np.isfinite(density)) or density.min() < 0.0:
            raise CaseError(f"frequency_response: density(omega) of {spectrum!r} must be finite and not negative")
    sampler = Sampler(system, channels)
    if state is None:
        state, _ = solve_static(system)
    linear = Linear(system, state, w0, math.radians(heading_deg))
    motion, lam, rounds = _settle(linear, density)
    return FrequencyResponse(w0, float(heading_deg), density, motion, lam, state, sampler, linear, rounds)


def _settle(linear: Linear, density: Array | None) -> tuple[Complex, Complex, int]:
    """Motions and multipliers with the damping that belongs to them, and how many rounds that took."""
    motion, lam = linear.solve(linear.damping())
    if density is None:
        return motion, lam, 0
    omega = linear.omega
    weight = np.sqrt(0.5 * (np.diff(omega, prepend=omega[0]) + np.diff(omega, append=omega[-1])) * density)
    sea = _gaussian(len(omega), SAMPLES) * weight
    few = _gaussian(len(omega), WAVE_SAMPLES) * weight
    before = np.zeros(0)
    still = 1e-6 * float(np.linalg.norm(weight * omega))  # of the surface's own velocity: what moves less stands still
    for rounds in range(1, MAX_ROUNDS + 1):
        velocity = 1j * omega[:, None] * motion
        sigma = np.sqrt(np.sum((weight[:, None] * np.abs(velocity)) ** 2, axis=0))
        if rounds > 1 and np.abs(sigma - before).max() <= _SETTLED * max(sigma.max(), still):
            return motion, lam, rounds
        before = sigma
        linear.wave_drag(few, (few @ velocity).real)
        motion, lam = linear.solve(linear.mean_damping(sea, (sea @ velocity).real))
    raise SolveFailed(f"frequency_response: the linearised drag has not settled in {MAX_ROUNDS} rounds")


def _frequencies(system: System, omega: Any) -> Array:
    if omega is None:
        found = [batch.frequencies() for batch in system.batches if hasattr(batch, "frequencies")]
        low, high, step = _RANGE
        omega = found[0] if found else np.arange(low, high + 0.5 * step, step)
    w0 = np.atleast_1d(np.asarray(omega, dtype=float))
    if w0.ndim != 1 or len(w0) < 2 or not np.all(np.isfinite(w0)) or w0.min() <= 0.0 or np.diff(w0).min() <= 0.0:
        raise CaseError("frequency_response: omega must be at least two positive frequencies [rad/s], increasing")
    return w0


def _gaussian(n: int, least: int) -> Complex:
    """Complex numbers (count, n), real and imaginary parts standard normal: quasi-random, always the same.

    Each comes with those a quarter, a half and three quarters of a cycle later, so that odd functions have no mean.
    They are made uncorrelated with variance two in the sample itself (the nearest such set, by the polar
    decomposition): then every velocity has its exact standard deviation, and what is left of the sampling error of
    E|v| falls to a third, for |v| goes with v^2 (correlation 0.94). That takes count >= 4 n.
    """
    from scipy.special import ndtri
    from scipy.stats import qmc

    share = qmc.Sobol(2 * n, scramble=True, seed=1).random(max(least // 4, 1 << (n - 1).bit_length()))
    normal = ndtri(np.clip(share, 1e-12, 1.0 - 1e-12))
    z = normal[:, :n] + 1j * normal[:, n:]
    left, _, right = np.linalg.svd(z, full_matrices=False)
    z = math.sqrt(2.0 * len(z)) * (left @ right)
    return np.concatenate((z, 1j * z, -z, -1j * z))


def _displace(system: System, w: Work, d: Array) -> None:
    """Move the configuration in w by small displacements d (n_dof,)."""
    n = 3 * (system.n_point + 1)
    w.x += d[:n].reshape(-1, 3)
    for k, phi in enumerate(d[n:].reshape(-1, 3)):
        w.q[k] = turn_quaternion(tuple(phi), tuple(w.q[k]))
    system.orient(w)


class Linear:
    """The linear system at an equilibrium, solved frequency by frequency."""

    def __init__(self, system: System, state: State, omega: Array, heading: float) -> None:
        self.system, self.state, self.omega, self.heading = system, state, omega, heading
        self.linear = LinearSolver(system.layout)
        self.rest = state.copy()
        self.rest.v[:] = self.rest.a[:] = 0.0
        self.work = w = system.work()
        self._rest(w)
        self.M = self._matrix((1.0, 0.0, 0.0, 0.0))
        stiff = self._matrix((0.0, 0.0, 1.0, 0.0))
        scale = np.abs(stiff.diagonal()[: system.n_dof])
        self.cG = float(np.median(scale[scale > 0.0])) if (scale > 0.0).any() else 1.0
        self.K = self._matrix((0.0, 0.0, 1.0, self.cG))
        self.n_dof = system.n_dof
        # the ground's rows are empty: they are left out
        used = np.zeros(system.n, dtype=bool)
        used[np.unique(system.layout.rows)] = True
        self.free = np.flatnonzero(used)
        self.k = wave_number(omega, system.model.sea.depth, system.model.gravity)
        wet = system.wet_points
        places = [(w.x, w.u, w.du, w.eta, wet)] if len(wet) else []
        own = [batch.water for batch in system.batches if hasattr(batch, "water")]
        places += [(*item, np.arange(len(item[0]))) for item in own]
        # unit waves (n, points) there, and what is there without waves
        self.water = [(u, du, eta, at, u.copy(), *_unit_waves(self, x[at])) for x, u, du, eta, at in places]
        self.hulls = [batch for batch in system.batches if hasattr(batch, "set_waves")]
        self.hull_load = self._hull_loads()
        self.load = self.hull_load + self._wave_loads(np.zeros(len(omega), dtype=np.complex128))

    def _rest(self, w: Work) -> None:
        """The equilibrium in the scratch, without waves."""
        self.system.load(w, self.state)
        w.v[:] = 0.0
        w.a[:] = 0.0
        w.still = True
        self.system.begin(w, self.state, self.state.t)

    def _matrix(self, c: tuple[float, float, float, float]) -> Any:
        w = self.work
        w.c[:4] = c
        w.c[6] = 1.0
        self.system.evaluate(w)
        return self.linear.matrix(w.A)

    def damping(self) -> Any:
        """C at the equilibrium, at rest."""
        self._water(np.zeros(len(self.omega), dtype=np.complex128))
        return self._matrix((0.0, 1.0, 0.0, 0.0))

    def mean_damping(self, sea: Complex, V: Array) -> Any:
        """E[C] over velocities V (samples, n_dof) in waves of amplitudes sea (samples, n), which go with them."""
        w = self.work
        total = np.zeros_like(w.A)
        w.c[:4] = (0.0, 1.0, 0.0, 0.0)
        w.c[6] = 1.0
        for z, v in zip(sea, V, strict=True):
            w.v[:] = v
            self._water(z)
            self.system.evaluate(w)
            total += w.A
        w.v[:] = 0.0
        return self.linear.matrix(total / len(V))

    def wave_drag(self, sea: Complex, V: Array) -> None:
        """Let the force of the waves be E[df/d(amplitude)] over the same."""
        if not self.water:
            return
        w, total = self.work, np.zeros_like(self.load)
        for z, v in zip(sea, V, strict=True):
            w.v[:] = v
            total += self._wave_loads(z)
        w.v[:] = 0.0
        self.load = self.hull_load + total / len(V)

    def _wave_loads(self, sea: Complex) -> Complex:
        """Forces (n, n_dof) of unit waves on lines and members, -dr/d(amplitude), in waves of amplitudes sea."""

        def move(z: complex, k: int) -> None:
            both = sea.copy()
            both[k] += z
            self._water(both)

        zero = np.zeros((len(self.omega), self.n_dof), dtype=np.complex128)
        return self._differences(move) if self.water else zero

    def _hull_loads(self) -> Complex:
        """The same of hulls, in waves alone."""
        if not self.hulls:
            return np.zeros((len(self.omega), self.n_dof), dtype=np.complex128)
        force = self._differences(self._hull_wave)
        self.calm()
        self._rest(self.work)
        return force

    def _hull_wave(self, z: complex, k: int) -> None:
        """Wave k of complex amplitude z [m] on hulls at rest."""
        one, a, b, t = slice(k, k + 1), np.array([abs(z)]), np.array([self.heading]), self.state.t
        phase = np.array([np.angle(z)]) - self.omega[one] * t
        waves = Realisation(a, self.omega[one], self.k[one], b, phase, self.system.model.sea.depth, math.inf)
        self.work.still = False
        for batch in self.hulls:
            batch.set_waves(waves)
            batch.begin(self.work, None, t, self.rest)

    def wave(self, z: complex, k: int) -> None:
        """Let wave k of complex amplitude z [m] be the water's motion at lines, members and hulls."""
        sea = np.zeros(len(self.omega), dtype=np.complex128)
        sea[k] = z
        self._water(sea)
        self._hull_wave(z, k)

    def calm(self) -> None:
        """Give the hulls the system's own waves back."""
        for batch in self.hulls:
            batch.set_waves(self.system.waves, self.system.model.sea.wave_ramp)

    def _differences(self, move: Callable[[complex, int], None]) -> Complex:
        """-dr/d(amplitude) (n, n_dof) when move(z, k) adds wave k with the complex amplitude z."""
        w, force = self.work, np.zeros((len(self.omega), self.n_dof), dtype=np.complex128)
        w.c[6] = 0.0
        for k in range(len(self.omega)):
            for turn, part in ((1.0, 1.0), (-1j, 1j)):
                sides = []
                for sign in (_SMALL, -_SMALL):
                    move(sign * turn, k)
                    self.system.evaluate(w)
                    sides.append(w.r[: self.n_dof].copy())
                force[k] -= part * (sides[0] - sides[1]) / (2.0 * _SMALL)
        return force

    def _water(self, sea: Complex) -> None:
        """The water's motion at lines and members at rest in waves of complex amplitudes sea (n,), m."""
        self.work.still = False  # or members would find their still water anew
        for u, du, eta, at, u0, U, dU, E in self.water:
            u[at] = u0[at] + (sea @ U).real.reshape(-1, 3)
            du[at] = (sea @ dU).real.reshape(-1, 3)
            eta[at] = (sea @ E).real

    def solve(self, C: Any) -> tuple[Complex, Complex]:
        """Motions (n, n_dof) and multipliers (n, n_con) per metre at all frequencies."""
        from scipy.sparse import coo_matrix
        from scipy.sparse.linalg import splu

        system, n = self.system, self.system.n
        out: Complex = np.zeros((len(self.omega), n), dtype=np.complex128)
        for k, omega in enumerate(self.omega):
            rows, cols, values = [], [], []
            force = np.zeros(n, dtype=complex)
            force[: self.n_dof] = self.load[k]
            for batch in system.batches:
                if hasattr(batch, "frequency_terms"):
                    for dofs, mass, damping in zip(*batch.frequency_terms(omega, system.n_point), strict=True):
                        block = -(omega**2) * mass + 1j * omega * damping
                        rows.append(np.repeat(dofs, len(dofs)))
                        cols.append(np.tile(dofs, len(dofs)))
                        values.append(block.ravel())
                if hasattr(batch, "wave_force"):
                    for dofs, load in zip(*batch.wave_force(omega, self.heading, system.n_point), strict=True):
                        np.add.at(force, dofs, load)
            S = (self.K - omega**2 * self.M + 1j * omega * C).tocsc()
            if rows:
                S = S + coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(cols))), (n, n))
            S = S.tocsc()[self.free][:, self.free]
            try:
                out[k, self.free] = splu(S.tocsc()).solve(force[self.free])
            except RuntimeError:
                raise SolveFailed(
                    f"frequency_response: the system is singular at {omega:g} rad/s: something moves freely without "
                    "inertia or damping there"
                ) from None
        return out[:, : self.n_dof], np.asarray(self.cG * out[:, self.n_dof :], dtype=np.complex128)


def _unit_waves(linear: Linear, x: Array) -> tuple[Complex, Complex, Complex]:
    """Water's velocity, acceleration (n, 3 p) and surface (n, p) at places x (p, 3), complex, per metre of waves."""
    depth, one, parts = linear.system.model.sea.depth, np.ones(1), []
    for omega, k in zip(linear.omega, linear.k, strict=True):
        wave = Realisation(one, omega * one, k * one, linear.heading * one, 0.0 * one, depth, math.inf)
        now, earlier = exact(wave, x, 0.0), exact(wave, x, -0.5 * math.pi / omega)
        parts.append([(a + 1j * b).ravel() for a, b in zip(now, earlier, strict=True)])
    U, dU, E = (np.array(part, dtype=np.complex128) for part in zip(*parts, strict=True))
    return U, dU, E
