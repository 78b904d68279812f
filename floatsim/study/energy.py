"""The energy ledger of a run: where energy came from, where it went, and whether the two sides agree.

At every accepted step the equations of motion hold *at* t_{n+1} (solve/scheme.py). Dotted with the velocities v they
say that powers balance. Forces with a potential are those of stores, E_k; the others do work at the powers P_i:

    sum_k R_k = sum_i P_i + lam . dg/dt - lam . (G v + dg/dt),            R_k = v . M a  or  v . grad U_k

R_k is what flows into store k, *from the forces*; lam . dg/dt what driven joints bring in; the last term vanishes where
velocities fulfil the joints, which those of the scheme do up to O(h^2). Powers are integrated by the trapezoidal rule
over accepted steps, W_i = int P_i dt; stored energies E_k are closed forms of positions and velocities. The step's
formulas make E_k grow by something else than int R_k dt. That is the integrator's own dissipation, store by store,

    D = sum_k (E_k(t) - E_k(0) - int R_k dt) - int lam . (G v + dg/dt) dt,

and goes with the square of the step where the motion is resolved: a stored energy that does not belong to its force
shows as a D that does not fall with the step. Where events (a line that parts, a lock that engages) make energy jump,
the jump of the stores is booked as such. With D measured in this way, what is left,

    error = Delta E - sum_i W_i - events - D,

is the work of forces that no account knows of, or that two know of, and of what Newton leaves of the equations. The
ledger closes if it is below 1 % of the total positive work: of all W_i > 0 and what the stores gave, or of the largest
kinetic energy if that is more (a pendulum swings without any work).

What batches offer: `ledger(w, book)` with `book.store(name, E, R)` and `book.work(name, P)` for everything that their
part of the residual does: sum R - sum P is its product with the velocities. `book.current` is the current at all
points.

Choices that are named: work of the water's motion on drag is that of drag force times water velocity, the rest of the
drag force's power is dissipation. Added mass of floaters is a store; that of lines and members turns with them without
velocity products, has no energy, and is an account of its own. Buoyancy is a store up to still water level. PTOs with
states (oil, users' functions) are accounted for at their port: what they hold counts as absorbed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from floatsim.errors import CaseError
from floatsim.frames import Array
from floatsim.parts.part import Output
from floatsim.system.state import State, Work
from floatsim.system.system import System

CLOSED = 0.01  # of the total positive work
COARSE = 0.05  # likewise: what the time steps may take before it is said that they are too long
ROUNDING = 1e-12  # of stored energies

WORKS = {  # what a positive number means
    "wave": "work of waves: excitation, water's motion and surface on lines and members",
    "current": "work of the current",
    "wind": "work of the wind through rotors (thrust, generator's reaction) and on towers",
    "pto": "work of PTOs and spring dampers (negative: absorbed)",
    "drag": "work of drag and viscous damping, relative to the water",
    "radiation": "work of radiated waves",
    "added_mass": "work of the water around lines and members: added mass",
    "structural": "work of structural damping of lines, axial and bending",
    "friction": "work of friction: seabed, joints",
    "contact": "work of contact dampers: seabed",
    "prescribed": "work of driven joints",
    "large_angles": "work of linear hydrostatics that their potential does not give back",
    "surface": "work of buoyancy of line elements across the surface that their potential does not give back",
}
STORES = {
    "kinetic": "kinetic energy, added mass of floaters included",
    "gravity": "potential energy of weight",
    "hydrostatic": "potential energy of buoyancy",
    "axial": "strain energy of lines",
    "bending": "bending energy of lines",
    "spring": "energy of springs, PTO springs included",
    "seabed": "energy of the compressed seabed",
}


class Book:
    """What one look at the system adds up to: stores (energy [J], rate [W]) and powers [W]."""

    def __init__(self) -> None:
        self.stored: dict[str, float] = {}
        self.rate: dict[str, float] = {}
        self.power: dict[str, float] = {}
        self.current = np.zeros((0, 3))
        self.memory: dict[Any, Any] = {}  # of batches whose potential is an integral over the way

    def open(self) -> None:
        """All accounts to zero."""
        for account in (self.stored, self.rate, self.power):
            for name in account:
                account[name] = 0.0

    def store(self, name: str, energy: float, rate: float) -> None:
        """Add to a stored energy [J] and to the power [W] that its forces take from the motion."""
        self.stored[name] = self.stored.get(name, 0.0) + float(energy)
        self.rate[name] = self.rate.get(name, 0.0) + float(rate)

    def work(self, name: str, power: float) -> None:
        """Add to the power [W] that a kind of force without potential brings into the system."""
        self.power[name] = self.power.get(name, 0.0) + float(power)


@dataclass(frozen=True)
class Energy:
    """The ledger of a run, J. stored: name -> (at the start, at the end); work: name -> brought in (negative: taken
    out); events: jumps of stored energy; integrator: what the time steps added (negative: dissipated), by store and of
    joints; error: what no account knows of; positive: total positive work; peak_kinetic: largest kinetic energy."""

    stored: dict[str, tuple[float, float]]
    work: dict[str, float]
    events: float
    integrator_by_store: dict[str, float]
    error: float
    peak_kinetic: float

    @property
    def change(self) -> float:
        """Change of all stored energy [J]."""
        return sum(b - a for a, b in self.stored.values())

    @property
    def integrator(self) -> float:
        """What the time steps added [J]; negative: dissipated."""
        return sum(self.integrator_by_store.values())

    @property
    def positive(self) -> float:
        """Total positive work [J]: of all accounts that brought energy in, and what the stores gave."""
        return sum(max(W, 0.0) for W in self.work.values()) + max(-self.change, 0.0)

    @property
    def scale(self) -> float:
        """What the error is compared with [J]: total positive work, or the largest kinetic energy if that is more, or
        the rounding of the stored energies if nothing moved."""
        rounding = ROUNDING * sum(abs(a) + abs(b) for a, b in self.stored.values())
        return max(self.positive, self.peak_kinetic, rounding)

    @property
    def closure(self) -> float:
        """Error over the total positive work."""
        return abs(self.error) / self.scale if self.scale > 0.0 else 0.0 if self.error == 0.0 else math.inf

    @property
    def closes(self) -> bool:
        """Whether the ledger closes within 1 %."""
        return self.closure <= CLOSED

    @property
    def verdict(self) -> str:
        """One sentence."""
        word = "closes" if self.closes else "DOES NOT CLOSE"
        share = 100.0 * self.integrator / self.scale if self.scale > 0.0 else 0.0
        way = "dissipated" if share <= 0.0 else "added"
        coarse = "; shorter ones would take less" if abs(share) > 100.0 * COARSE else ""
        return (
            f"the energy ledger {word} within {100.0 * CLOSED:g} %: its error is {100.0 * self.closure:.2g} % of "
            f"{self.scale:.4g} J; the time steps {way} {abs(share):.2g} % of it{coarse}"
        )

    def summary(self) -> str:
        """A table of all accounts."""
        rows = [(f"work: {name}", W) for name, W in self.work.items() if W != 0.0]
        rows += [("events", self.events)] if self.events else []
        rows += [("time steps", self.integrator)]
        rows += [(f"into store: {name}", b - a) for name, (a, b) in self.stored.items() if a != b]
        rows += [("sum of all stores", self.change), ("error", self.error)]
        width = max(len(name) for name, _ in rows)
        return "\n".join([*(f"{name:<{width}} {value: .6e} J" for name, value in rows), self.verdict])

    def attributes(self) -> dict[str, str | float]:
        """For the head of a result file."""
        return {"energy_closure_error": float(self.closure), "energy_positive_work": float(self.positive),
                "energy_ledger": self.verdict}  # fmt: skip


class Ledger:
    """Keeps the ledger while a run goes on; `Stepper.watch`. `outputs` and `measure` as those of a batch.

    Raises CaseError, naming them, if parts of the system do not tell their energies.
    """

    def __init__(self, system: System) -> None:
        silent = sorted({part.name for batch in system.batches if not hasattr(batch, "ledger") for part in batch.parts})
        if silent:
            raise CaseError(
                f"energy: {', '.join(repr(name) for name in silent)}: these parts do not tell their energies; "
                "run without energy=True"
            )
        self.system = system
        self.book = Book()
        self._t = self.slip = 0.0
        w, state = system.work(), system.initial_state()
        system.load(w, state)
        with np.errstate(all="ignore"):
            self._look_at(w, state)  # for the names alone
        self.book.memory.clear()
        names = list(self.book.stored), [n for n in (*WORKS, *self.book.power) if n in self.book.power]
        self.stores, self.works = names[0], list(dict.fromkeys(names[1]))
        self.energy0 = self.energy = self._numbers(self.book.stored, self.stores)
        self._R, self._P, self._slip = self.energy * 0.0, np.zeros(len(self.works)), 0.0
        self._begin()

    @staticmethod
    def _numbers(account: dict[str, float], names: list[str]) -> Array:
        return np.array([account[name] for name in names])

    def _begin(self) -> None:
        self.flowed = np.zeros(len(self.stores))  # int R dt
        self.W = np.zeros(len(self.works))
        self.slipped = self.peak = 0.0  # work of what velocities leave open of joints
        self.jumps = np.zeros(len(self.stores))

    # -- the watch --------------------------------------------------------------------------

    def look(self, w: Work) -> None:
        """Open the book anew and fill it: all batches and the joints, at what is in the scratch, evaluated and not yet
        committed. What velocities leave open of the joints goes to `slip` [W]."""
        book, system = self.book, self.system
        book.open()
        sea = system.model.sea
        if sea.current.profile is not None or len(book.current) == 0:
            book.current = sea.current.at(w.x[:, 2], sea.depth)
        tangent = w.c[6]
        w.c[6] = 0.0
        for batch in system.batches:
            batch.ledger(w, book)
        w.c[6] = tangent
        driven, self.slip = self._joints(w)
        book.work("prescribed", driven)

    def _joints(self, w: Work) -> tuple[float, float]:
        """Power [W] of driven joints, and of what the velocities leave open of all."""
        con, n = self.system.constraints, self.system.n_dof
        if con.n == 0:
            return 0.0, 0.0
        w.r.fill(0.0)
        con.add(w)
        rate, _ = con.rates(w)
        driven = float(w.lam @ rate)
        return driven, -float(w.r[:n] @ w.v) - driven

    def _look_at(self, w: Work, state: State) -> None:
        """Record a state as it stands."""
        self.system.load(w, state)
        w.still = False
        self.system.begin(w, state, state.t)
        w.c[6] = 1.0
        self.system.evaluate(w)
        self.look(w)

    def _take(self, w: Work) -> None:
        self.energy = self._numbers(self.book.stored, self.stores)
        self._R = self._numbers(self.book.rate, self.stores)
        self._P = self._numbers(self.book.power, self.works)
        self._slip = self.slip
        self._t = w.t
        self.peak = max(self.peak, self.book.stored.get("kinetic", 0.0))

    def start(self, w: Work, state: State) -> None:
        """Open the ledger of a run that goes on from `state`."""
        self._look_at(w, state)
        self._begin()
        self._take(w)
        self.energy0 = self.energy.copy()

    def afresh(self, w: Work, state: State) -> None:
        """After an event: new accelerations, perhaps velocities; stores may have jumped."""
        before = self.energy
        self._look_at(w, state)
        self._take(w)
        self.jumps += self.energy - before

    def step(self, w: Work) -> None:
        """Take in a converged step before it is committed."""
        R, P, slip, h = self._R, self._P, self._slip, w.t - self._t
        self.look(w)
        self._take(w)
        self.flowed += 0.5 * h * (R + self._R)
        self.W += 0.5 * h * (P + self._P)
        self.slipped += 0.5 * h * (slip + self._slip)

    # -- checkpoints ------------------------------------------------------------------------

    _KEPT = ("energy0", "energy", "_R", "_P", "_slip", "_t", "flowed", "W", "slipped", "peak", "jumps")

    def arrays(self) -> dict[str, Any]:
        """All that it needs to go on."""
        return {"stores": self.stores, "works": self.works, **{name: getattr(self, name) for name in self._KEPT}}

    def restore(self, arrays: dict[str, Any]) -> None:
        """Go on as the ledger that gave `arrays`. Raises ValueError if that had other accounts."""
        if (arrays["stores"], arrays["works"]) != (self.stores, self.works):
            raise ValueError(f"the ledger has accounts {arrays['stores']}, {arrays['works']}")
        for name in self._KEPT:
            setattr(self, name, arrays[name])

    # -- what it comes to -------------------------------------------------------------------

    def result(self) -> Energy:
        """The ledger until now."""
        gap = self.energy - self.energy0 - self.jumps - self.flowed
        own = {name: float(y) for name, y in zip(self.stores, gap, strict=True)} | {"joints": self.slipped}
        error = float(self.flowed.sum() - self.W.sum() - self.slipped)
        ends = zip(self.stores, self.energy0, self.energy, strict=True)
        return Energy(
            {name: (float(a), float(b)) for name, a, b in ends},
            {name: float(W) for name, W in zip(self.works, self.W, strict=True)},
            float(self.jumps.sum()), own, error, self.peak,
        )  # fmt: skip

    def outputs(self) -> list[Output]:
        """Channels `energy_...`, from the start of the run."""
        stores = [Output(f"energy_stored_{name}", f"stored: {STORES.get(name, name)}", "J") for name in self.stores]
        works = [Output(f"energy_{name}", f"until now: {WORKS.get(name, name)}", "J") for name in self.works]
        return [
            Output("energy_stored", "all stored energy; its zero is that of the stores", "J"), *stores, *works,
            Output("energy_events", "until now: jumps of stored energy by events", "J"),
            Output("energy_integrator", "until now: energy that the time steps added (negative: dissipated)", "J"),
            Output("energy_error", "until now: change of stored energy that no account explains", "J"),
        ]  # fmt: skip

    def measure(self, w: Any, out: Array) -> None:
        """Of the last accepted step."""
        n, m = len(self.stores), len(self.works)
        now = self.result()
        out[0] = self.energy.sum()
        out[1 : 1 + n] = self.energy
        out[1 + n : 1 + n + m] = self.W
        out[1 + n + m :] = now.events, now.integrator, now.error
