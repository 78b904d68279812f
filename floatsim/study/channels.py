"""Output channels of a system: what is recorded, and how a sample is taken from the solver's scratch.

Almost everything that is put out is linear in a few *sources*: positions, velocities, accelerations, multipliers,
roll-pitch-yaw, tensions, angles between elements, moments of joints. So each entry of a sample is a row of a sparse
matrix, sample = S source - offset, built once; selecting channels selects rows, and no Python loop runs over elements.

Line end forces and joint forces are multipliers. With the residual M a + f + G^T lam = 0, a `coincide` row puts
-lam on A and +lam on B: lam is the force A exerts on B. An `align` row g = a . b has G = (a x b) for turns of A and
-(a x b) for turns of B (angular velocities, world axes), so that mu (a x b) is the moment that A exerts on B.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix

from floatsim.errors import CaseError, nearest
from floatsim.frames import Array, cross, dot, rotate, vec
from floatsim.jit import kernel
from floatsim.parts.body import Body
from floatsim.parts.end_bending import EndBendingBatch
from floatsim.parts.line import Line, LineBatch
from floatsim.parts.point_mass import PointMass
from floatsim.parts.spring import SpringBatch
from floatsim.study.store import TIME_ATTRIBUTES, Channel, Coordinate
from floatsim.system.state import State, Work
from floatsim.system.system import System

Index = NDArray[np.int64]
Found = tuple[Channel, Index, Any, Any]  # a channel, its source index (rows,) or (rows, k), weight, offset
DOFS = ("surge", "sway", "heave", "roll", "pitch", "yaw")
_XYZ = np.arange(3)


@kernel
def attitudes(R, out):  # type: ignore[no-untyped-def]
    """out (3 n): roll, pitch, yaw of R_WB = Rz(yaw) Ry(pitch) Rx(roll) for every rotation matrix."""
    for k in range(R.shape[0]):
        out[3 * k] = np.arctan2(R[k, 2, 1], R[k, 2, 2])
        out[3 * k + 1] = np.arcsin(min(1.0, max(-1.0, -R[k, 2, 0])))
        out[3 * k + 2] = np.arctan2(R[k, 1, 0], R[k, 0, 0])


@kernel
def align_moments(R, where, axes, mu, out):  # type: ignore[no-untyped-def]
    """out (3 n): mu (a x b), the moment that A exerts on B, world axes. where (n, 2), axes (n, 6)."""
    for e in range(where.shape[0]):
        a = rotate(R, where[e, 0], (axes[e, 0], axes[e, 1], axes[e, 2]))
        n = cross(a, rotate(R, where[e, 1], (axes[e, 3], axes[e, 4], axes[e, 5])))
        for m in range(3):
            out[3 * e + m] = mu[e] * n[m]


@kernel
def clamp_angles(x, R, where, E, out):  # type: ignore[no-untyped-def]
    """out (n): angle between a clamp's direction and the line's first element. where (n, 4), E (n, 5)."""
    for e in range(where.shape[0]):
        a = rotate(R, where[e, 0], (E[e, 2], E[e, 3], E[e, 4]))
        p, q = vec(x, where[e, 1]), vec(x, where[e, 2])
        b = (q[0] - p[0], q[1] - p[1], q[2] - p[2])
        n = cross(a, b)
        out[e] = np.arctan2(np.sqrt(dot(n, n)), dot(a, b))


@dataclass
class _Entry:
    """A channel and its rows: triplets (row, source, weight) and the constant that is subtracted."""

    channel: Channel
    rows: Index
    sources: Index
    weights: Array
    offset: Array

    def same_as(self, other: _Entry) -> bool:
        """Whether both are the same numbers."""
        pairs = zip((self.rows, self.sources, self.weights), (other.rows, other.sources, other.weights))
        return all(np.array_equal(a, b) for a, b in pairs)


class Sampler:
    """Chosen channels of a system and their samples.

    names: 'all' or channel names; the order of the file is the system's own. `channels`, `coordinates` and `width`
    describe a sample for `store.Writer`. Raises CaseError for names that do not exist, with the nearest that does.
    """

    def __init__(self, system: System, names: str | Sequence[str] = "all") -> None:
        self.system = system
        self._sources = _Sources(system)
        entries: dict[str, _Entry] = {}
        self._coordinates: list[Coordinate] = []
        for channel, index, weight, offset in self._everything():
            entry = _entry(channel, index, weight, offset)
            # a joint named after the only line end it holds has the same force; anything else must differ in name
            if not entry.same_as(entries.setdefault(channel.name, entry)):
                raise CaseError(f"output '{channel.name}' would stand for two things; rename a part or a joint")
        chosen = [entries[name] for name in _selection(names, entries)]
        self.channels = tuple(entry.channel for entry in chosen)
        used = {dim for channel in self.channels for dim in channel.dims}
        self.coordinates = tuple(item for item in self._coordinates if item.dim in used)
        self._offset = np.concatenate([entry.offset for entry in chosen])
        self.width = len(self._offset)
        start = np.cumsum([0, *(len(entry.offset) for entry in chosen)])
        self._matrix = coo_matrix(
            (
                np.concatenate([entry.weights for entry in chosen]),
                (
                    np.concatenate([entry.rows + s for entry, s in zip(chosen, start)]),
                    np.concatenate([entry.sources for entry in chosen]),
                ),
            ),
            shape=(self.width, self._sources.size),
        ).tocsr()
        sizes = {item.dim: len(item.values) for item in self.coordinates}
        shapes = [tuple(sizes[dim] for dim in channel.dims) for channel in self.channels]
        self._columns = {
            channel.name: (slice(int(a), int(b)), shape)
            for channel, a, b, shape in zip(self.channels, start[:-1], start[1:], shapes, strict=True)
        }
        self._waves = any(channel.name == "wave_elevation" for channel in self.channels)

    # -- samples ------------------------------------------------------------------------------

    def sample(self, work: Work, iterations: int = 0, step: float = 0.0) -> Array:
        """One sample (width,), channels one after the other, of the state `work` was last evaluated at.

        That is the state after a converged step. iterations, step [s]: for the solver's channels.
        """
        self._sources.collect(work, iterations, step, self._waves)
        return self._matrix @ self._sources.values - self._offset

    def sample_state(self, state: State) -> Array:
        """One sample (width,) of any state, such as the start of a run or a static equilibrium."""
        work = self.system.work()
        self.system.load(work, state)
        self.system.begin(work, state, state.t)
        self.system.evaluate(work)
        return self.sample(work)

    def column(self, rows: Array, name: str) -> Array:
        """Channel `name` of samples (n, width): shape (n, ...). Raises CaseError for a name that is not there."""
        if name not in self._columns:
            raise CaseError(f"channels: there is no '{name}'{nearest(name, self._columns)}")
        columns, shape = self._columns[name]
        return rows[:, columns].reshape(len(rows), *shape)

    def dataset(self, time: Array, rows: Array, attributes: Mapping[str, Any] | None = None) -> Any:
        """Samples (n, width) at `time` (n,) [s] as an xarray Dataset that looks like the file."""
        import xarray

        channels = {
            c.name: (("time", *c.dims), self.column(rows, c.name).astype(np.int32 if c.dtype == "int32" else float),
                     c.attributes)
            for c in self.channels
        }  # fmt: skip
        coordinates: dict[str, Any] = {c.name: (c.dim, np.asarray(c.values), c.attributes) for c in self.coordinates}
        return xarray.Dataset(channels, {"time": ("time", time, TIME_ATTRIBUTES), **coordinates}, attributes)

    # -- what there is ------------------------------------------------------------------------

    def _everything(self) -> Iterable[Found]:
        """All channels of the system, in the order of the file."""
        num = self.system.numbering
        self._coordinates += [
            Coordinate("dof", "degree of freedom", "1", "dof", DOFS),
            Coordinate("xyz", "world axis", "1", "xyz", ("x", "y", "z")),
        ]
        for part, p, k in zip(num.parts, num.first_point, num.first_rotation, strict=True):
            if isinstance(part, Body):
                yield from self._body(part, p, k)
            elif isinstance(part, PointMass):
                yield from self._point_mass(part, p)
            elif isinstance(part, Line):
                yield from self._line(part, p)
        s = self._sources
        for spring, index in s.springs.items():
            yield Channel(f"{spring}_force", f"force in {spring}, pulling positive", "N"), index, 1.0, 0.0
        yield from self._joints()
        text = "wave elevation at the world's origin"
        yield Channel("wave_elevation", text, "m"), s.environment[:1], 1.0, 0.0
        text = "Newton iterations since the previous output"
        yield Channel("newton_iterations", text, "1", (), "int32"), s.solver[:1], 1.0, 0.0
        yield Channel("step_size", "time step before this output", "s"), s.solver[1:], 1.0, 0.0

    def _body(self, body: Body, p: int, k: int) -> Iterable[Found]:
        s, n, name = self._sources, self.system.n_point + 1, body.name
        point, rotation = 3 * p + _XYZ, 3 * n + 3 * k + _XYZ
        for kind, head, index, text, unit in (
            ("position", s.x, s.attitude[3 * k + _XYZ], "displacement of the reference point from the drawing "
             "position, and attitude: roll, pitch, yaw of Rz(yaw) Ry(pitch) Rx(roll)", "m m m rad rad rad"),
            ("velocity", s.v, s.v[rotation], "velocity of the reference point and angular velocity, world axes",
             "m/s m/s m/s rad/s rad/s rad/s"),
            ("acceleration", s.a, s.a[rotation], "acceleration of the reference point and angular acceleration, "
             "world axes", "m/s2 m/s2 m/s2 rad/s2 rad/s2 rad/s2"),
        ):  # fmt: skip
            channel = Channel(f"{name}_{kind}", f"{name}: {text}", "mixed", ("dof",), "float", unit)
            offset = np.concatenate([self.system.x0[p], np.zeros(3)]) if kind == "position" else 0.0
            yield channel, np.concatenate([head[point], index]), 1.0, offset

    def _point_mass(self, mass: PointMass, p: int) -> Iterable[Found]:
        s, index = self._sources, 3 * p + _XYZ
        for kind, head, unit in (("position", s.x, "m"), ("velocity", s.v, "m/s"), ("acceleration", s.a, "m/s2")):
            text = f"{mass.name}: {kind}, world axes"
            yield Channel(f"{mass.name}_{kind}", text, unit, ("xyz",)), head[index], 1.0, 0.0

    def _line(self, line: Line, p: int) -> Iterable[Found]:
        s, name = self._sources, line.name
        l0 = line.element_lengths
        node, element = f"{name}_node", f"{name}_element"
        self._coordinates += [
            Coordinate(f"{name}_arc_length", f"{name}: unstretched length from end a to the node", "m", node,
                       line.arc_length),
            Coordinate(f"{name}_element_arc_length", f"{name}: unstretched length from end a to the middle of the "
                       "element", "m", element, 0.5 * (line.arc_length[:-1] + line.arc_length[1:])),
        ]  # fmt: skip
        index = s.x[3 * (p + line.nodes)[:, None] + _XYZ].ravel()
        yield Channel(f"{name}_position", f"{name}: position of the nodes, world", "m", (node, "xyz")), index, 1.0, 0.0
        yield Channel(f"{name}_tension", f"{name}: effective tension", "N", (element,)), s.tension[name], 1.0, 0.0
        # at a clamp the angle is spread over half an element; a free or hinged end is straight
        angle = np.concatenate([[s.zero], s.angle[name], [s.zero]])
        weight = 2.0 / np.concatenate([l0[:1], l0[:-1] + l0[1:], l0[-1:]])
        angle[0], angle[-1] = (s.clamp.get(f"{name}.{end}", s.zero) for end in ("end_a", "end_b"))
        yield Channel(f"{name}_curvature", f"{name}: curvature", "1/m", (node,)), angle, weight, 0.0
        moment = np.concatenate([[s.zero], s.moment[name], [s.zero]])
        moment[0], moment[-1] = (s.clamp_bending.get(f"{name}.{end}", s.zero) for end in ("end_a", "end_b"))
        yield Channel(f"{name}_bending_moment", f"{name}: bending moment", "N m", (node,)), moment, 1.0, 0.0
        for end, point in (("end_a", p), ("end_b", p + line.n_points - 1)):
            text = f"{name}: force of {end.replace('_', ' ')} on what it is tied to, world axes"
            yield Channel(f"{name}_{end}_force", text, "N", ("xyz",)), *self._end_force(point), 0.0

    def _end_force(self, point: int) -> tuple[Index, Array]:
        """Multipliers of the joints at a point that has no arm: + where it is A, - where it is B."""
        rows, signs = [], []
        for joint in self.system.joint_rows.values():
            for k in joint[0]:
                w = self.system.constraints.where[k]
                if point in (w[0], w[2]):
                    rows.append(self._sources.lam[3 * k + _XYZ])
                    signs.append(1.0 if w[0] == point else -1.0)
        if not rows:
            return np.full(3, self._sources.zero), np.zeros(3)
        return np.stack(rows, axis=1), np.tile(signs, (3, 1))

    def _joints(self) -> Iterable[Found]:
        s = self._sources
        for label, (points, axes) in self.system.joint_rows.items():
            if points:
                index = np.stack([s.lam[3 * k + _XYZ] for k in points], axis=1)
                text = f"{label}: force that its side a exerts on side b, world axes"
                yield Channel(f"{label}_force", text, "N", ("xyz",)), index, 1.0, 0.0
            moment = [s.align_moment[3 * k + _XYZ] for k in axes]
            if label in s.clamp_moment:
                moment.append(s.clamp_moment[label])
            if moment:
                text = f"{label}: moment about the joint that its side a exerts on side b, world axes"
                yield Channel(f"{label}_moment", text, "N m", ("xyz",)), np.stack(moment, axis=1), 1.0, 0.0


class _Sources:
    """The vector that samples are taken from, and where in it everything stands."""

    def __init__(self, system: System) -> None:
        batches, con = system.batches, system.constraints
        self._lines = next((b for b in batches if isinstance(b, LineBatch)), None)
        self._clamps = next((b for b in batches if isinstance(b, EndBendingBatch)), None)
        self._springs = next((b for b in batches if isinstance(b, SpringBatch)), None)
        self._constraints = con
        lines: tuple[Line, ...] = self._lines.parts if self._lines else ()
        clamps = self._clamps.parts if self._clamps else ()
        springs = self._springs.parts if self._springs else ()
        self.size = 0
        self._slices: list[slice] = []
        self.zero = int(self._room(1)[0])
        self.x = self._room(3 * (system.n_point + 1))
        self.v, self.a = self._room(system.n_dof), self._room(system.n_dof)
        self.lam = self._room(system.n_con)
        self.attitude = self._room(3 * (system.n_rotation + 1))
        self.align_moment = self._room(3 * len(con.turns))
        self.solver, self.environment = self._room(2), self._room(1)
        tension, angle = self._room(sum(p.elements for p in lines)), self._room(sum(p.elements - 1 for p in lines))
        bending = self._room(len(angle))
        self.tension: dict[str, Index] = {}
        self.angle: dict[str, Index] = {}
        self.moment: dict[str, Index] = {}
        if self._lines:
            self.tension = {p.name: tension[of] for p, of in zip(lines, self._lines.elements_of)}
            self.angle = {p.name: angle[of] for p, of in zip(lines, self._lines.pairs_of)}
            self.moment = {p.name: bending[of] for p, of in zip(lines, self._lines.pairs_of)}
        clamp, moment = self._room(len(clamps)), self._room(3 * len(clamps))
        end = self._room(len(clamps))
        self.clamp_bending = {p.end: int(end[k]) for k, p in enumerate(clamps)}
        self.clamp = {p.end: int(clamp[k]) for k, p in enumerate(clamps)}
        self.clamp_moment = {p.name: moment[3 * k + _XYZ] for k, p in enumerate(clamps)}
        force = self._room(len(springs))
        self.springs = {p.name: force[k : k + 1] for k, p in enumerate(springs)}
        self.values = np.zeros(self.size)
        rooms = [self.values[part] for part in self._slices]
        (_, self._x, self._v, self._a, self._lam, self._attitude, self._align, self._solver, self._environment,
         self._tension, self._angle, self._bending, self._clamp, self._moment, self._end,
         self._force) = rooms  # fmt: skip
        self._waves, self._ramp = system.waves, system.model.sea.wave_ramp

    def _room(self, n: int) -> Index:
        first, self.size = self.size, self.size + n
        self._slices.append(slice(first, self.size))
        return np.arange(first, self.size)

    def collect(self, w: Work, iterations: int, step: float, waves: bool) -> None:
        """Fill `values` from the scratch."""
        con = self._constraints
        self._x[:] = w.x.ravel()
        self._v[:] = w.v
        self._a[:] = w.a
        self._lam[:] = w.lam
        attitudes(w.R, self._attitude)
        if len(con.turns):
            align_moments(w.R, con.turns, con.vectors, w.lam[con.n_point_rows :], self._align)
        self._solver[0], self._solver[1] = iterations, step
        if self._lines is not None:
            self._tension[:] = self._lines.tension(w)
            self._angle[:] = self._lines.angles(w)
            self._bending[:] = self._lines.moments(self._angle)
        if self._clamps is not None:
            clamp_angles(w.x, w.R, self._clamps.where, self._clamps.E, self._clamp)
            self._moment[:] = self._clamps.moment.ravel()
            self._end[:] = np.linalg.norm(self._clamps.moment, axis=1)
        if self._springs is not None:
            self._force[:] = self._springs.force
        if waves and self._waves is not None:
            self._environment[0] = self._waves.elevation(0.0, 0.0, w.t, self._ramp)


def _entry(channel: Channel, index: Index, weight: Any, offset: Any) -> _Entry:
    index = index.reshape(len(index), -1)  # (rows, sources that add up to the entry)
    weights = np.asarray(weight, dtype=float)
    weights = np.broadcast_to(weights[:, None] if weights.ndim == 1 else weights, index.shape)
    rows = np.broadcast_to(np.arange(len(index))[:, None], index.shape)
    constant = np.array(np.broadcast_to(np.asarray(offset, dtype=float), len(index)))
    return _Entry(channel, rows.ravel(), index.ravel(), weights.ravel(), constant)


def _selection(names: str | Sequence[str], known: Iterable[str]) -> list[str]:
    known = list(known)
    if isinstance(names, str):
        if names != "all":
            raise CaseError(f"channels: got {names!r}; must be 'all' or a list of names")
        return known
    if not isinstance(names, Iterable):
        raise CaseError(f"channels: got {names!r}; must be 'all' or a list of names")
    names = list(names)
    problems = [f"channels: there is no '{name}'{nearest(str(name), known)}" for name in names if name not in known]
    if not names:
        problems = ["channels: the list is empty; give names, or 'all'"]
    if problems:
        raise CaseError(problems)
    return [name for name in known if name in names]
