"""A law given by the user's own Python function of time, displacement and rate, with states of its own if it has any.

    force = function(t, s, v)                              without states
    force, rates = function(t, s, v, states)               continuous states, d(states)/dt = rates
    force, new_states = function(t, s, v, states)          sampled: called every `sample_time`, force and states held;
                                                           in statics like a continuous one, with its first states

Continuous states move with the step (runge_kutta.py). Derivatives are taken by central differences of the function. A
sampled function (a digital controller) is called with what the accepted step ended with, at the first step that
reaches the sampling time, and its force acts from there on: choose a step that divides the sampling time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from pydantic import field_validator, model_validator

from floatsim.description import Description, Name, Positive, Series
from floatsim.errors import ModelError
from floatsim.frames import Array
from floatsim.pto_laws.law import Index, Now
from floatsim.pto_laws.runge_kutta import GAMMA

_STEP = 1e-6  # of differences
_ITERATIONS = 30


class UserLaw(Description):
    """A law by a Python function; the signatures stand at the top of the file.

    function(t, s, v[, states]): t [s], s [m or rad], v [m/s or rad/s], states (k,); force [N or N m] on a, positive
    along the coordinate. states: their values at the start; names: what they are called in the outputs (default
    state_1, ...). sample_time [s]: for sampled functions; their force is an output too, as any PTO's.
    """

    function: Any
    states: Series = ()
    names: tuple[Name, ...] = ()
    sample_time: Positive | None = None

    @field_validator("function")
    @classmethod
    def _can_be_called(cls, value: Any) -> Any:
        if not callable(value):
            raise ValueError(f"got {value!r:.60}; a function of t, s, v (and states) is allowed")
        return value

    @field_validator("names", mode="before")
    @classmethod
    def _as_tuple(cls, value: Any) -> Any:
        return tuple(value) if isinstance(value, list) else value

    @model_validator(mode="after")
    def _named(self) -> UserLaw:
        if self.names and len(self.names) != len(self.states):
            raise ValueError(f"names: got {len(self.names)} names for {len(self.states)} states")
        return self

    @staticmethod
    def group() -> type[Any]:
        return UserLaws

    def call(self, label: str, t: float, s: float, v: float, y: Array) -> tuple[float, Array]:
        """(force, rates or new states). ModelError if the function raises or gives anything else."""
        where = f"PTO '{label}': its function at t = {t:g} s, s = {s:g}, v = {v:g}"
        with_states = bool(self.states) or self.sample_time is not None
        try:
            result = self.function(t, s, v, y.copy()) if with_states else self.function(t, s, v)
            force, rates = result if with_states else (result, ())
            force, rates = float(force), np.array(rates, dtype=float).reshape(-1)
        except Exception as error:  # the user's own code
            needs = "force, states" if with_states else "force"
            raise ModelError(f"{where} fails: {type(error).__name__}: {error} (it must return {needs})") from None
        if rates.shape != y.shape:
            raise ModelError(f"{where} returns {rates.size} states; it has {y.size}")
        if not (math.isfinite(force) and all(map(math.isfinite, rates))):
            raise ModelError(f"{where} returns {force:g}, {rates.tolist()}; finite numbers are needed")
        return force, rates


class _Law:
    """One law: its states over a step. What it keeps: next sampling time, held force, states."""

    def __init__(self, law: UserLaw, label: str) -> None:
        self.law, self.label = law, label
        self.k = len(law.states)
        self.new = np.zeros(2 + self.k)
        self._J: Array | None = None

    def _call(self, t: float, u: Array) -> Array:
        """(force, rates) as one array of (s, v, states)."""
        out = np.empty(1 + self.k)
        out[0], out[1:] = self.law.call(self.label, t, float(u[0]), float(u[1]), u[2:])
        return out

    def slopes(self, t: float, u: Array) -> tuple[Array, Array]:
        """(force, rates) (1 + k,), and its derivatives by (s, v, states) (1 + k, 2 + k)."""
        f = self._call(t, u)
        J = np.empty((1 + self.k, 2 + self.k))
        for i in range(2 + self.k):
            d = _STEP * (1.0 + abs(u[i]))
            up, down = u.copy(), u.copy()
            up[i] += d
            down[i] -= d
            J[:, i] = (self._call(t, up) - self._call(t, down)) / (2.0 * d)
        return f, J

    def stage(self, t: float, h: float, s: float, v: float, base: Array, y: Array) -> tuple[Array, Array, Array]:
        """States y = base + h g f(y), then (force, rates) there and their derivatives. y: the first guess."""
        u = np.concatenate([[s, v], y])
        for i in range(_ITERATIONS):
            if self._J is None or i % 5 == 4:  # those of the last stage are good for a start
                _, self._J = self.slopes(t, u)
            gap = base + h * GAMMA * self._call(t, u)[1:] - u[2:]
            d = np.linalg.solve(np.eye(self.k) - h * GAMMA * self._J[1:, 2:], gap)
            u[2:] += d
            if np.all(np.abs(d) <= 1e-10 * (np.abs(u[2:]) + 1e-6)):
                f, self._J = self.slopes(t, u)
                return u[2:], f, self._J
        self._J = None
        raise ModelError(f"PTO '{self.label}': its states find no value at t = {t:g} s")

    def evaluate(self, now: Now, e: int, old: Array) -> tuple[float, float, float]:
        """(F, F_s, F_v) at the end of the step."""
        s, v, h, y0 = float(now.s[e]), float(now.v[e]), now.h, old[2:]
        self.new[:] = old
        if self.law.sample_time is not None and not now.still:
            return float(old[1]), 0.0, 0.0
        if now.still or h <= 0.0 or self.k == 0:
            f, J = self.slopes(now.t, np.concatenate([[s, v], y0]))
            return float(f[0]), float(J[0, 0]), float(J[0, 1])
        s0, v0, I = now.s0[e], now.v0[e], np.eye(self.k)
        y1, _, J = self.stage(now.t - (1.0 - GAMMA) * h, h, s0 + GAMMA * (s - s0), v0 + GAMMA * (v - v0), y0, y0)
        D = np.linalg.solve(I - h * GAMMA * J[1:, 2:], h * GAMMA * GAMMA * J[1:, :2])
        share = (1.0 - GAMMA) / GAMMA
        y, f, J = self.stage(now.t, h, s, v, y0 + share * (y1 - y0), y1)
        D = np.linalg.solve(I - h * GAMMA * J[1:, 2:], share * D + h * GAMMA * J[1:, :2])
        self.new[2:] = y
        slope = J[0, :2] + J[0, 2:] @ D
        return float(f[0]), float(slope[0]), float(slope[1])

    def commit(self, now: Now, e: int, old: Array) -> bool:
        """Take over the states; sample if it is time. Whether the held force changed."""
        T = self.law.sample_time
        self._J = None  # a step does not depend on the guesses of the last one: a checkpoint need not know them
        if T is None:
            old[:] = self.new
            return False
        if now.t < old[0] - 1e-6 * T:
            return False
        before = old[1]
        old[1], old[2:] = self.law.call(self.label, now.t, float(now.s[e]), float(now.v[e]), old[2:])
        old[0] += T * (1.0 + math.floor((now.t - old[0]) / T + 1e-6))
        return bool(old[1] != before)


class UserLaws:
    """All user laws. Memory: one array (2 + k,) each."""

    def __init__(self, laws: Sequence[UserLaw], which: Index, labels: Sequence[str]) -> None:
        self.which = which
        self.items = [_Law(law, label) for law, label in zip(laws, labels, strict=True)]

    def start(self, t: float, s: Array) -> list[Array]:
        """Memory at displacements s at rest: sampled functions are called for the first time."""
        memory = []
        for item, e in zip(self.items, self.which, strict=True):
            y = np.array(item.law.states)
            force, then = item.law.call(item.label, t, float(s[e]), 0.0, y)
            T = item.law.sample_time
            memory.append(np.array([0.0, 0.0, *y]) if T is None else np.array([t + T, force, *then]))
        return memory

    def add(self, now: Now, F: Array) -> str | None:
        """Add forces and derivatives to F (3, n)."""
        trouble = None
        for item, e, old in zip(self.items, self.which, now.memory, strict=True):
            try:
                f = item.evaluate(now, int(e), old)
            except (ModelError, np.linalg.LinAlgError) as error:
                trouble = str(error)
                continue
            for i in range(3):
                F[i, e] += f[i]
        return trouble

    def commit(self, now: Now) -> bool:
        jumps = [item.commit(now, int(e), old) for item, e, old in zip(self.items, self.which, now.memory, strict=True)]
        return any(jumps)

    def signals(self) -> list[tuple[int, str, str, str]]:
        """(law, suffix, long name, units)."""
        return [(j, name, f"state {name}", "1") for j, item in enumerate(self.items)
                for name in item.law.names or [f"state_{i + 1}" for i in range(item.k)]]  # fmt: skip

    def tell(self, now: Now) -> list[float]:
        """Values of the signals."""
        return [float(y) for item, old in zip(self.items, now.memory, strict=True)
                for y in (old if item.law.sample_time else item.new)[2:]]  # fmt: skip
