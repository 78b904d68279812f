"""`assemble`: from names to numbers. A `System` holds no state, but its batches carry
scratch: two runs on one System must not interleave.

What a batch offers the system (the protocol; a part's description names its batch class):

    runs                        candidate chains: (first point, number of points)
    connect(numbering)          optional: resolve names of other parts' connection points; numbering.wind is the model's
    dofs(n_point) -> tables     unknowns that each element couples
    bind(slots)                 slots of those tables, in the same order
    add(work)                   add matrix entries, residual, force sizes
    begin(work, history, t, state)  optional: what is constant during the step from `state` to time t
    nodes, lengths, weight_in_water, bending_force, let_out, largest_turn, expected_tension, exchange_tension
                                optional, of lines: how statics keep slender things from folding (parts/line.py)
    frequency_terms(omega, n_point), wave_force(omega, heading, n_point), frequencies()
                                optional, of floaters: added mass, damping and excitation at one frequency, and the
                                frequencies they are known at
    water                       optional, of those that find the water's motion themselves: places, velocity,
                                acceleration and surface there
    set_waves(waves, ramp)      optional, of hulls: other waves from now on
    remembers                   whether commits or outputs need the evaluation of the accepted state itself
    error(history, work)        optional: local error of the step just made over what is allowed
    start(state) -> history     optional: its memory, committed by commit(history, work) only when a
                                step is accepted
    keep(state, before, after)  optional: what of the memory `before` outlives a new equilibrium
    hold_back(work, before, after)  optional: what friction holds in a new equilibrium
    wet_points, arms            optional: points where the water's motion is wanted; arms [m], for the size of the model
    outputs() -> [Output]       optional: what it has to tell, written for every sample by measure(work, out)
    ledger(work, book)          optional: energies and powers of the accepted step in `work`, not yet committed
                                (study/energy.py)
    unused(history)             optional: before the first equilibrium nothing was ever loaded, however it is drawn
    rows(coordinates) -> {name: [row]}, hold(constraints, joint_rows), engage_all(history), switch(state, history),
    next_event(state, history), struck(history, lost)
                                optional, of locks (joints/lock.py): constraint rows of their own; which they are; all
                                on, to check their rank; whether one engages or releases before a step; when the next
                                will; what it cost by constraint row [J]
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from floatsim.errors import CaseError, ModelError, nearest
from floatsim.frames import Array, quaternion_from_matrix, set_matrix
from floatsim.jit import kernel
from floatsim.joints.constraints import Coincide, Constraints, Drawing, JointRows, Place
from floatsim.model import Model
from floatsim.sea.kinematics import Kinematics
from floatsim.system.layout import build_layout
from floatsim.system.state import State, Work


class Numbering:
    """Points and rotations of every part, where they are drawn, connection points and joints by name."""

    def __init__(self, model: Model, parts: list[Any]) -> None:
        self.parts = parts
        self.first_point: list[int] = []
        self.first_rotation: list[int] = []
        self.n_point = self.n_rotation = 0
        for part in parts:
            self.first_point.append(self.n_point)
            self.first_rotation.append(self.n_rotation)
            self.n_point += part.n_points
            self.n_rotation += part.n_rotations
        self._index = {part.name: k for k, part in enumerate(parts)}
        self._targets = model.targets()
        self._joints = {joint.label: joint for joint in model.joints}
        self.x0 = np.zeros((self.n_point + 1, 3))
        self.R0 = np.tile(np.eye(3), (self.n_rotation + 1, 1, 1))
        placed = model.placement()
        for part, p, k in zip(parts, self.first_point, self.first_rotation, strict=True):
            if part.name in placed and part.n_points:
                x, R = placed[part.name]
                self.x0[p : p + len(x)] = x
                self.R0[k : k + len(R)] = R
        self.attitude = Drawing(self.x0, self.R0)
        self.wind = model.wind

    def index(self, name: str) -> int:
        """Position of the part `name`."""
        return self._index[name]

    def part(self, target: str) -> tuple[Any, int]:
        """(part, its first point) of a connection point's name."""
        k = self._index[self._targets[target][0].name]
        return self.parts[k], self.first_point[k]

    def place(self, target: Any) -> Place:
        """Point, rotation and arm of a connection point's name or of fixed coordinates."""
        if not isinstance(target, str):
            return Place(self.n_point, self.n_rotation, tuple(target))
        part, anchor = self._targets[target]
        k = self._index[part.name]
        point, rotation, arm = part.anchors()[anchor]
        turn = self.first_rotation[k] + rotation if rotation >= 0 else self.n_rotation
        return Place(self.first_point[k] + point, turn, arm)

    def coordinates(self, joint: str) -> dict[str, Any]:
        """The coordinates of the joint with this label: name -> Slide or Turn."""
        return dict(self._joints[joint].coordinates(self.place, self.attitude))


@kernel
def _configure(q, R):  # type: ignore[no-untyped-def]
    for k in range(q.shape[0]):
        set_matrix(R, k, (q[k, 0], q[k, 1], q[k, 2], q[k, 3]))


class System:
    """The assembled model: numbering, batches, constraints, layout. Build it with `assemble`."""

    def __init__(self, model: Model) -> None:
        self.model = model
        parts = model.everything()
        self.numbering = num = Numbering(model, parts)
        self.n_point, self.n_rotation = num.n_point, num.n_rotation
        self.x0, self.R0 = num.x0, num.R0
        groups: dict[type, list[int]] = {}
        for k, part in enumerate(parts):
            groups.setdefault(part.batch(), []).append(k)
        self.batches = [
            cls([parts[k] for k in ks], [num.first_point[k] for k in ks], [num.first_rotation[k] for k in ks],
                model.sea, model.gravity)
            for cls, ks in groups.items()
        ]  # fmt: skip
        for batch in self.batches:
            if hasattr(batch, "connect"):
                batch.connect(num)
        self.constraints = self._constraints(model, num)
        self.n_dof = 3 * (self.n_point + 1 + self.n_rotation + 1)
        self.n_con = self.constraints.n
        self.n = self.n_dof + self.n_con
        self.layout = self._layout()
        sea = model.sea
        self.waves = None if sea.waves is None else sea.waves.realise(sea.depth, model.gravity)
        wet = [batch.wet_points for batch in self.batches if hasattr(batch, "wet_points")]
        self.wet_points = np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *wet]))
        self.remembers = any(batch.remembers for batch in self.batches)
        self._ahead = np.zeros((self.n_point + 1, 3))
        self.length = self._extent()
        rank_check(self)

    def _constraints(self, model: Model, num: Numbering) -> Constraints:
        out = Constraints()
        self.joint_rows: dict[str, JointRows] = {}
        for joint in model.joints:
            self.joint_rows[joint.label] = out.append(joint.label, joint.rows(num.place, num.attitude))
        zero = (0.0, 0.0, 0.0)
        for part, p in zip(num.parts, num.first_point, strict=True):
            for a, b in part.internal_balls():
                ends = Place(p + a, self.n_rotation, zero), Place(p + b, self.n_rotation, zero)
                out.append(part.name, [Coincide(*ends)])
        locks = [batch for batch in self.batches if hasattr(batch, "hold")]
        for batch in locks:
            for label, rows in batch.rows(num.coordinates).items():
                self.joint_rows[label] = out.append(label, rows)
        out.close()
        for batch in locks:
            batch.hold(out, self.joint_rows)
        return out

    def _layout(self):  # type: ignore[no-untyped-def]
        xyz = np.arange(3)
        ground = np.concatenate([3 * self.n_point + xyz, 3 * (self.n_point + 1 + self.n_rotation) + xyz])
        tables, owner = [], []
        for batch in self.batches:
            new = batch.dofs(self.n_point)
            tables += new
            owner.append(len(new))
        joint_tables = self.constraints.dofs(self.n_point, self.n_dof)
        diagonal = np.arange(self.n)[:, None]
        runs = [(3 * p, 3 * n) for batch in self.batches for p, n in batch.runs]
        layout = build_layout([*tables, *joint_tables, diagonal], runs, list(ground), self.n)
        k = 0
        for batch, count in zip(self.batches, owner, strict=True):
            batch.bind([layout.slots(t) for t in tables[k : k + count]])
            k += count
        self.constraints.bind([layout.slots(t) for t in joint_tables])
        return layout

    def _extent(self) -> float:
        """A length of the whole model [m], for tolerances: its points, arms, fixed points and bodies' own sizes."""
        arms = [self.constraints.arms]
        arms += [batch.arms.ravel() for batch in self.batches if hasattr(batch, "arms")]
        spread = np.ptp(self.x0[: self.n_point], axis=0) if self.n_point else np.zeros(3)
        own = [part.extent for part in self.numbering.parts if hasattr(part, "extent")]
        return float(max(spread.max(), np.abs(np.concatenate(arms)).max(initial=0.0), *own, 1e-3))

    def free_points(self) -> NDArray[np.bool_]:
        """Which entries of `Work.s` are points of parts that have no rotation."""
        out = np.zeros(self.n_point + self.n_rotation + 2, dtype=bool)
        for part, p in zip(self.numbering.parts, self.numbering.first_point, strict=True):
            out[p : p + part.n_points] = part.n_rotations == 0
        return out

    def work(self) -> Work:
        """Fresh scratch for evaluations."""
        w = Work(self.n_point, self.n_rotation, self.n, self.n_con, self.layout.size)
        sea, points = self.model.sea, self.wet_points
        # a uniform current stands in w.u from the start; bodies keep that of the depth they are drawn at
        w.u[: self.n_point] = sea.current.at(self.x0[: self.n_point, 2], sea.depth)
        if len(points) and sea.current.profile is not None:
            w.still_water = Kinematics(None, sea.current, sea.depth, 0.0, sea.stretching, points)
        w.water = w.still_water
        if len(points) and self.waves is not None:
            w.water = Kinematics(self.waves, sea.current, sea.depth, sea.wave_ramp, sea.stretching, points)
        return w

    def initial_state(self) -> State:
        """Drawing position, lines straight from end to end, at rest, t = 0."""
        q = np.array([quaternion_from_matrix(R) for R in self.R0])
        zero = np.zeros(self.n_dof)
        state = State(0.0, self.x0.copy(), q, zero.copy(), zero.copy(), zero.copy(), np.zeros(self.n_con))
        self.forget(state)
        return state

    def forget(self, state: State, before: dict[int, Any] | None = None) -> None:
        """Start all memories afresh from the state: it has always been at rest there. Of the memories `before`, if
        given, only what cannot be undone is kept: broken lines, ropes that were stretched further."""
        state.history = {k: b.start(state) for k, b in enumerate(self.batches) if hasattr(b, "start")}
        for k, batch in enumerate(self.batches):
            if before is not None and hasattr(batch, "keep"):
                batch.keep(state, before[k], state.history[k])

    def hold_back(self, w: Work, before: dict[int, Any], after: dict[int, Any]) -> None:
        """Statics with friction: what stuck before goes on sticking where it did, dragged along where it slid."""
        for k, batch in enumerate(self.batches):
            if hasattr(batch, "hold_back"):
                batch.hold_back(w, before[k], after[k])

    def load(self, w: Work, state: State) -> None:
        """Copy a state into the scratch."""
        w.t = state.t
        np.copyto(w.x, state.x)
        np.copyto(w.q, state.q)
        np.copyto(w.v, state.v)
        np.copyto(w.a, state.a)
        np.copyto(w.aux, state.aux)
        np.copyto(w.lam, state.lam)
        self.orient(w)

    def orient(self, w: Work) -> None:
        """Rotation matrices in the scratch from its quaternions."""
        _configure(w.q, w.R)

    def begin(self, w: Work, state: State, t: float) -> None:
        """Prepare everything that is constant during a step from `state` to time t.

        The water's motion at the wet points too: it is taken where they will be if their accelerations stay, which
        is off by less than h^3, and saves the kinematics from the Newton iterations.
        """
        if (w.still_water if w.still else w.water) is not None:
            s = t - state.t
            ahead = self._ahead
            np.multiply(state.v[: ahead.size] + 0.5 * s * state.a[: ahead.size], s, out=ahead.reshape(-1))
            ahead += state.x
            self.flow(w, ahead, t)
        w.t = t
        self.constraints.move(t)
        for k, batch in enumerate(self.batches):
            if hasattr(batch, "begin"):
                batch.begin(w, state.history.get(k), t, state)

    def flow(self, w: Work, x: Array, t: float) -> None:
        """Velocity and acceleration of the water and its surface at the wet points, at positions x (n_point + 1, 3)."""
        water = w.still_water if w.still else w.water
        if water is not None:
            water.move(x, t, w.u, w.du, w.eta)

    def evaluate(self, w: Work) -> None:
        """Residual r = M a + f_int - f_ext + G^T lam (and cG g), and cM M + cC C + cK K with cG G into A."""
        if w.c[6] != 0.0:
            w.A.fill(0.0)
        w.r.fill(0.0)
        w.s.fill(0.0)
        w.trouble = None
        for batch in self.batches:
            batch.add(w)
        self.constraints.add(w)

    def switch(self, state: State) -> bool:
        """Let locks engage and release at the state, before a step; whether one did."""
        return any([b.switch(state, state.history[k]) for k, b in enumerate(self.batches) if hasattr(b, "switch")])

    def next_event(self, state: State) -> float:
        """The next time [s] after that of the state at which a lock is foreseen to engage or release; inf if none."""
        found = [b.next_event(state, state.history[k]) for k, b in enumerate(self.batches) if hasattr(b, "next_event")]
        return min(found, default=math.inf)

    def struck(self, state: State, lost: Array) -> None:
        """Tell locks what energy each constraint row took [J] (n_con,) when velocities were made consistent."""
        for k, batch in enumerate(self.batches):
            if hasattr(batch, "struck"):
                batch.struck(state.history[k], lost)

    def error(self, w: Work, state: State) -> float:
        """Local error of the step in `w` from `state`, over what is allowed: above 1 it should be made smaller."""
        worst = 0.0
        for k, batch in enumerate(self.batches):
            if hasattr(batch, "error"):
                worst = max(worst, batch.error(state.history[k], w))
        return worst

    def commit(self, w: Work, state: State) -> None:
        """Let memories take in the accepted step."""
        for k, batch in enumerate(self.batches):
            if hasattr(batch, "commit"):
                batch.commit(state.history[k], w)

    def unknowns_of(self, names: Sequence[str]) -> NDArray[np.int64]:
        """Velocity unknowns of whole parts, by name."""
        out: list[int] = []
        num = self.numbering
        known = {part.name for part in num.parts}
        for name in names:
            if name not in known:
                raise CaseError(f"there is no part '{name}'{nearest(name, known)}")
            k = num.index(name)
            part, p, r = num.parts[k], num.first_point[k], self.n_point + 1 + num.first_rotation[k]
            out += range(3 * p, 3 * (p + part.n_points))
            out += range(3 * r, 3 * (r + part.n_rotations))
        return np.array(out, dtype=np.int64)

    def unknown_name(self, i: int) -> str:
        """What unknown i belongs to, in the user's words."""
        axis = "xyz"[i % 3]
        if i >= self.n_dof:
            return f"joint '{self.constraints.names[i - self.n_dof]}'"
        if i >= 3 * (self.n_point + 1):
            k = i // 3 - self.n_point - 1
            for part, first in zip(self.numbering.parts, self.numbering.first_rotation, strict=True):
                if first <= k < first + part.n_rotations:
                    return f"rotation about {axis} of '{part.name}'"
            return "ground"
        k = i // 3
        for part, first in zip(self.numbering.parts, self.numbering.first_point, strict=True):
            if first <= k < first + part.n_points:
                where = f" at point {k - first} of {part.n_points}" if part.n_points > 1 else ""
                return f"{axis} of '{part.name}'{where}"
        return "ground"

    def jacobian(self, w: Work) -> Any:
        """G (n_con, n_dof) at the configuration in w, as a scipy CSR matrix."""
        from scipy.sparse import csr_matrix

        saved = w.c.copy()
        w.c[:4] = (0.0, 0.0, 0.0, 1.0)
        w.A.fill(0.0)
        w.r.fill(0.0)
        self.constraints.add(w)
        lay = self.layout
        own = (lay.rows >= self.n_dof) & (lay.cols < self.n_dof)
        entries = w.A[lay.slot[own]], (lay.rows[own] - self.n_dof, lay.cols[own])
        w.c[:] = saved
        return csr_matrix(entries, shape=(self.n_con, self.n_dof))

    def row_name(self, k: int | np.integer) -> str:
        """Joint of constraint row k."""
        return self.constraints.names[k]


def rank_check(system: System) -> None:
    """Redundant joints are found by rank and named; joints open at the drawing position too.

    Rows that share no unknown cannot depend on each other, so that the rank is found island by island.
    """
    if system.n_con == 0:
        return
    from scipy.sparse.csgraph import connected_components

    w = system.work()
    state = system.initial_state()
    system.load(w, state)
    system.constraints.move(0.0)
    for k, batch in enumerate(system.batches):
        if hasattr(batch, "engage_all"):
            batch.engage_all(state.history[k])
    G = system.jacobian(w)
    gap = w.r[system.n_dof :]
    G.eliminate_zeros()
    size = np.sqrt(np.asarray(G.multiply(G).sum(axis=1)).ravel())
    # rows that constrain nothing but the ground
    problems = []
    dead = sorted({system.row_name(k) for k in np.flatnonzero(size < 1e-12)})
    if dead:
        raise ModelError([f"joint '{name}' ties nothing that can move" for name in dead])
    _, island = connected_components(G @ G.T, directed=False)
    order = np.argsort(island, kind="stable")
    redundant: list[int] = []
    for rows in np.split(order, np.flatnonzero(np.diff(island[order])) + 1):
        redundant += [int(k) for k in rows[_dependent(G, rows, size[rows])]]
    if redundant:
        rank = system.n_con - len(redundant)
        names = sorted({system.row_name(k) for k in redundant})
        problems.append(
            f"joints are redundant: {system.n_con} constraint rows, of which only {rank} are independent; "
            f"remove or loosen: {', '.join(repr(n) for n in names)}"
        )
    open_rows = np.flatnonzero(np.abs(gap) > 1e-6 * system.length)
    for name in sorted({system.row_name(k) for k in open_rows}):
        worst = max(abs(float(gap[k])) for k in open_rows if system.row_name(k) == name)
        problems.append(
            f"joint '{name}' is open by {worst:.6g} m (or rad) at the drawing position; the two sides must start at "
            "the same place"
        )
    if problems:
        raise ModelError([f"Model '{system.model.name}': {p}" for p in problems])


def _dependent(G: Any, rows: NDArray[np.int64], size: Array) -> NDArray[np.int64]:
    """Which of `rows` of the CSR matrix G, of norms `size`, depend on the others."""
    from scipy.linalg import qr

    if len(rows) == 1:
        return np.zeros(0, dtype=np.int64)
    first, last = G.indptr[rows], G.indptr[rows + 1]
    where = np.concatenate([np.arange(a, b) for a, b in zip(first, last, strict=True)])
    columns, place = np.unique(G.indices[where], return_inverse=True)
    block = np.zeros((len(columns), len(rows)))
    block[place, np.repeat(np.arange(len(rows)), last - first)] = G.data[where]
    _, triangle, order = qr(block / size, mode="economic", pivoting=True)
    diagonal = np.abs(np.diag(triangle))
    return np.asarray(order[np.sum(diagonal > 1e-9 * diagonal[0]) :], dtype=np.int64)


def assemble(model: Model) -> System:
    """Assemble a model. Raises ModelError for redundant, contradictory or open joints."""
    if not isinstance(model, Model):
        raise ModelError(f"assemble: got {model!r}; a floatsim.Model is needed")
    return System(model)
