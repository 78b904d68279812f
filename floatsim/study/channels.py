"""Output channels of a system: what is recorded, and how a sample is taken from the solver's scratch.

Almost everything that is put out is linear in a few *sources*: positions, velocities, accelerations, multipliers,
roll-pitch-yaw, tensions, angles between elements, moments of joints. So each entry of a sample is a row of a sparse
matrix, sample = S source - offset, built once; selecting channels selects rows, sources that no row asks for are not
collected, and no Python loop runs over elements.

Line end forces and joint forces are multipliers. With the residual M a + f + G^T lam = 0, a `coincide` row puts
-lam on A and +lam on B: lam is the force A exerts on B. An `align` row g = a . b has G = (a x b) for turns of A and
-(a x b) for turns of B (angular velocities, world axes), so that mu (a x b) is the moment that A exerts on B. Rows of
`inline` and `separation` give forces lam e and lam d/L at A's point, about which a joint's moment is therefore meant.

Touchdown: walking down from the upper end, the first node in contact, moved to where the line's inclination against
the bed, tan = V/H, has fallen to zero. In a catenary V/H is linear in arc length, in one of lumped weights too, so two
elements above the node give the place within the element, and it moves without jumps as the line is laid.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from floatsim.errors import CaseError, nearest
from floatsim.frames import Array, at, cross, dot, minus, rotate, vec
from floatsim.jit import kernel
from floatsim.parts.bending import from_table
from floatsim.parts.body import Body
from floatsim.parts.element import L0, LIVE, axial
from floatsim.parts.end_bending import EndBendingBatch
from floatsim.parts.line import Line, LineBatch
from floatsim.parts.point_mass import PointMass
from floatsim.sea.seabed import SLOPE_X, SLOPE_Y, Z0, bed_height
from floatsim.study.store import TIME_ATTRIBUTES, Channel, Coordinate
from floatsim.system.state import State, Work
from floatsim.system.system import System

Index = NDArray[np.int64]
Found = tuple[Channel, Index, Any, Any]  # a channel, its source index (rows,) or (rows, k), weight, offset
DOFS = ("surge", "sway", "heave", "roll", "pitch", "yaw")
CONTACT = 1e-6  # of the depth: a node this close to the seabed touches it; an anchor at the bed does
_XYZ = np.arange(3)
_CLAMP = 8  # entries of a clamp among the sources: angle, size of the moment, moment, shear


@kernel
def weigh(start, index, weight, source, offset, out):  # type: ignore[no-untyped-def]
    """out = S source - offset; row i of S has entries start[i] to start[i + 1] of index and weight."""
    for i in range(out.shape[0]):
        y = -offset[i]
        for k in range(start[i], start[i + 1]):
            y += weight[k] * source[index[k]]
        out[i] = y


@kernel
def attitudes(R, out):  # type: ignore[no-untyped-def]
    """out (3 n): roll, pitch, yaw of R_WB = Rz(yaw) Ry(pitch) Rx(roll) for every rotation matrix."""
    for k in range(R.shape[0]):
        out[3 * k] = np.arctan2(R[k, 2, 1], R[k, 2, 2])
        out[3 * k + 1] = np.arcsin(min(1.0, max(-1.0, -R[k, 2, 0])))
        out[3 * k + 2] = np.arctan2(R[k, 1, 0], R[k, 0, 0])


@kernel
def clamp_values(x, R, lam, where, E, moment, ties, out):  # type: ignore[no-untyped-def]
    """out (8 n), of every clamped line end: angle between the clamp's direction and the line's outermost element, size
    of the end moment, the end moment, and the part of the end force normal to the clamp's direction.

    where (n, 4), E (n, 5), moment (n, 3): see EndBendingBatch. ties (n, 2 m): place in lam and sign of up to m forces
    at the end, which add up to the force of the line's end.
    """
    for e in range(where.shape[0]):
        a = rotate(R, where[e, 0], (E[e, 2], E[e, 3], E[e, 4]))
        b = minus(vec(x, where[e, 2]), vec(x, where[e, 1]))
        n = cross(a, b)
        o = _CLAMP * e
        out[o] = math.atan2(math.sqrt(dot(n, n)), dot(a, b)) if E[e, 0] > 0.0 else 0.0  # or the line has parted there
        M = vec(moment, e)
        out[o + 1] = math.sqrt(dot(M, M))
        for m in range(3):
            f = 0.0
            for k in range(0, ties.shape[1], 2):
                f += ties[e, k + 1] * lam[ties[e, k] + m]
            out[o + 2 + m] = M[m]
            out[o + 5 + m] = f
        along = dot(a, at(out, o + 5))
        for m in range(3):
            out[o + 5 + m] -= along * a[m]


@kernel
def line_values(x, v, nodes, P, special, pairs, B, tables, bed, grid, lines, arc, reach, out):  # type: ignore[no-untyped-def]
    """out: tensions of all elements; angles, then moments of all pairs; clearances of all nodes; touchdown of all
    lines; declinations at end a and end b of all lines.

    Elements and pairs as in LineBatch. lines (n, 3): first element, number of elements, whether end b is the upper
    one; arc (elements + lines): arc length of their nodes; reach [m]: height over the bed that counts as contact.
    """
    n_element, n_pair, n_line = nodes.shape[0], pairs.shape[0], lines.shape[0]
    for e in range(n_element):
        i, j = nodes[e, 0], nodes[e, 1]
        d = minus(vec(x, j), vec(x, i))
        l, l0 = math.sqrt(dot(d, d)), P[e, L0]
        rate = dot(d, minus(at(v, 3 * j), at(v, 3 * i))) / (l * l0)
        out[e], _, _ = axial(P, special, e, l / l0, rate, math.inf, 1.0)
    for e in range(n_pair):
        da = minus(vec(x, pairs[e, 1]), vec(x, pairs[e, 0]))
        db = minus(vec(x, pairs[e, 3]), vec(x, pairs[e, 2]))
        n = cross(da, db)
        angle = math.atan2(math.sqrt(dot(n, n)), dot(da, db))
        M = B[e, 0] * angle
        if pairs[e, 4] >= 0 and B[e, 0] > 0.0:
            M, _ = from_table(tables, pairs[e, 4], angle)
        out[n_element + e] = angle
        out[n_element + n_pair + e] = M
    first_gap = n_element + 2 * n_pair
    touch, lean = first_gap + n_element + n_line, first_gap + n_element + 2 * n_line
    for q in range(n_line):
        e0, n = lines[q, 0], lines[q, 1]
        g0 = first_gap + e0 + q
        for m in range(n - 1):  # there is no bend where the line has parted
            if P[e0 + m, LIVE] == 0.0 or P[e0 + m + 1, LIVE] == 0.0:
                out[n_element + e0 - q + m] = 0.0
        for m in range(n + 1):
            p = nodes[e0 + m, 0] if m < n else nodes[e0 + m - 1, 1]
            z = bed[Z0] + bed[SLOPE_X] * x[p, 0] + bed[SLOPE_Y] * x[p, 1]
            if grid.shape[0] > 0:
                z, _, _ = bed_height(bed, grid, x[p, 0], x[p, 1])
            out[g0 + m] = x[p, 2] - z
        out[touch + q] = _touchdown(x, nodes, e0, n, lines[q, 2] == 1, out, g0, arc, e0 + q, reach)
        for end in range(2):
            e = e0 if end == 0 else e0 + n - 1
            d = minus(vec(x, nodes[e, 1]), vec(x, nodes[e, 0]))
            out[lean + 2 * q + end] = math.atan2(math.sqrt(d[0] * d[0] + d[1] * d[1]), d[2])


@kernel
def _touchdown(x, nodes, e0, n, from_b, gap, g0, arc, s0, reach):  # type: ignore[no-untyped-def]
    """Arc length [m] of the first contact below the upper end, nan without one. Node j has gap[g0 + j], arc[s0 + j]."""
    top, way = (n, -1) if from_b else (0, 1)
    for m in range(n + 1):
        j = top + way * m
        if gap[g0 + j] > reach:
            continue
        s = arc[s0 + j]
        if m < 2:
            return s
        above, next_above = arc[s0 + j - way], arc[s0 + j - 2 * way]
        near = _climb(x, nodes, e0 + (j if from_b else j - 1), gap[g0 + j - way] - gap[g0 + j])
        far = _climb(x, nodes, e0 + (j + 1 if from_b else j - 2), gap[g0 + j - 2 * way] - gap[g0 + j - way])
        if not far > near:  # no catenary, as in a snap
            return s
        high, higher = 0.5 * (s + above), 0.5 * (above + next_above)
        low = s if m == n else 0.5 * (s + arc[s0 + j + way])
        place = high + (high - higher) * near / (far - near)
        return min(max(place, min(low, high)), max(low, high))
    return math.nan


@kernel
def _climb(x, nodes, e, rise):  # type: ignore[no-untyped-def]
    """Rise over the bed per horizontal length of element e."""
    d = minus(vec(x, nodes[e, 1]), vec(x, nodes[e, 0]))
    return rise / math.sqrt(d[0] * d[0] + d[1] * d[1])


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
    describe a sample for `store.Writer`. more: what tells outputs besides the system's batches. Raises CaseError for
    names that do not exist, with the nearest that does.
    """

    def __init__(self, system: System, names: str | Sequence[str] = "all", more: Sequence[Any] = ()) -> None:
        self.system = system
        self._sources = _Sources(system, more)
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
        rows = np.concatenate([entry.rows + s for entry, s in zip(chosen, start)])  # in rising order
        self._start = np.searchsorted(rows, np.arange(self.width + 1))
        self._index = np.concatenate([entry.sources for entry in chosen])
        self._weight = np.concatenate([entry.weights for entry in chosen])
        self._sources.want(self._index)
        sizes = {item.dim: len(item.values) for item in self.coordinates}
        shapes = [tuple(sizes[dim] for dim in channel.dims) for channel in self.channels]
        self._columns = {
            channel.name: (slice(int(a), int(b)), shape)
            for channel, a, b, shape in zip(self.channels, start[:-1], start[1:], shapes, strict=True)
        }

    # -- samples ------------------------------------------------------------------------------

    def sample(self, work: Work, iterations: int = 0, step: float = 0.0) -> Array:
        """One sample (width,), channels one after the other, of the state `work` was last evaluated at.

        That is the state after a converged step. iterations, step [s]: for the solver's channels.
        """
        self._sources.collect(work, iterations, step)
        row = np.empty(self.width)
        weigh(self._start, self._index, self._weight, self._sources.values, self._offset, row)
        return row

    def sample_state(self, state: State) -> Array:
        """One sample (width,) of any state, such as the start of a run or a static equilibrium."""
        work = self.system.work()
        self.system.load(work, state)
        self.system.begin(work, state, state.t)
        self.system.evaluate(work)
        return self.sample(work)

    def columns(self, name: str) -> slice:
        """Where a chosen channel stands in a sample."""
        return self._columns[name][0]

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
        for output, index in s.told:
            yield Channel(output.name, output.long_name, output.units, output.dims), index, 1.0, 0.0
        yield from self._joints()
        text = "wave elevation at the world's origin"
        yield Channel("wave_elevation", text, "m"), s.environment[:1], 1.0, 0.0
        if s.inflow is not None:
            text = "wind at the reference height, at a point"
            yield Channel("wind_speed", text, "m/s"), s.environment[1:], 1.0, 0.0
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
        load = np.array([c.breaking_load or np.nan for c in line.element_sections])
        if not np.isnan(load).all():
            text = f"{name}: effective tension over breaking load"
            yield Channel(f"{name}_tension_utilisation", text, "1", (element,)), s.tension[name], *_where(1.0 / load)
        # at a clamp the angle is spread over half an element; a free or hinged end is straight
        clamps = [s.clamp.get(f"{name}.{end}") for end in ("end_a", "end_b")]
        ends = [s.zero if k is None else int(k[0]) for k in clamps]
        angle = np.concatenate([ends[:1], s.angle[name], ends[1:]])
        weight = 2.0 / np.concatenate([l0[:1], l0[:-1] + l0[1:], l0[-1:]])
        yield Channel(f"{name}_curvature", f"{name}: curvature", "1/m", (node,)), angle, weight, 0.0
        radius = _bend_radius(line, weight)
        if not np.isnan(radius).all():
            text = f"{name}: curvature times minimum bend radius"
            yield Channel(f"{name}_curvature_utilisation", text, "1", (node,)), angle, *_where(radius)
        ends = [s.zero if k is None else int(k[1]) for k in clamps]
        moment = np.concatenate([ends[:1], s.moment[name], ends[1:]])
        yield Channel(f"{name}_bending_moment", f"{name}: bending moment", "N m", (node,)), moment, 1.0, 0.0
        text = f"{name}: height of the nodes over the seabed"
        yield Channel(f"{name}_clearance", text, "m", (node,)), s.clearance[name], 1.0, 0.0
        text = f"{name}: arc length from end a of the first contact with the seabed below the upper end"
        yield Channel(f"{name}_touchdown", text, "m"), s.touchdown[name], 1.0, 0.0
        for end, point, at_b in (("end_a", p, 0), ("end_b", p + line.n_points - 1, 1)):
            yield from self._line_end(f"{name}_{end}", f"{name}: ", end.replace("_", " "), point,
                                      s.declination[name][at_b :][:1], clamps[at_b])  # fmt: skip

    def _line_end(self, name: str, of: str, end: str, point: int, declination: Index,
                  clamp: Index | None) -> Iterable[Found]:  # fmt: skip
        """Force and declination of a line's end; at a clamp also angle, moment and shear."""
        text = f"{of}force of {end} on what it is tied to, world axes"
        yield Channel(f"{name}_force", text, "N", ("xyz",)), *self._end_force(point), 0.0
        text = f"{of}angle at {end} between the vertical and the line's direction from end a to end b"
        yield Channel(f"{name}_angle", text, "rad"), declination, 1.0, 0.0
        if clamp is None:
            return
        text = f"{of}angle at {end} between the clamp's direction and the outermost element"
        yield Channel(f"{name}_clamp_angle", text, "rad"), clamp[:1], 1.0, 0.0
        text = f"{of}moment of {end} on what it is clamped to, world axes"
        yield Channel(f"{name}_moment", text, "N m", ("xyz",)), clamp[2:5], 1.0, 0.0
        text = f"{of}part of the force of {end} normal to the clamp's direction, world axes"
        yield Channel(f"{name}_shear", text, "N", ("xyz",)), clamp[5:8], 1.0, 0.0

    def _end_force(self, point: int) -> tuple[Index, Array]:
        """Multipliers of the joints at a point that has no arm: + where it is A, - where it is B."""
        ties = _ties(self.system, point)
        if not ties:
            return np.full(3, self._sources.zero), np.zeros(3)
        rows = [self._sources.carried[k + _XYZ] for k, _ in ties]
        return np.stack(rows, axis=1), np.tile([float(sign) for _, sign in ties], (3, 1))

    def _joints(self) -> Iterable[Found]:
        s = self._sources
        first = _loads(self.system)
        for label, own in self.system.joint_rows.items():
            forces = [3 * k for k in own.points]
            forces += [first[1] + 3 * k for k in own.planes] + [first[2] + 3 * k for k in own.lengths]
            if forces:
                index = np.stack([s.carried[k + _XYZ] for k in forces], axis=1)
                text = f"{label}: force that its side a exerts on side b, world axes"
                yield Channel(f"{label}_force", text, "N", ("xyz",)), index, 1.0, 0.0
            moment = [s.carried[first[0] + 3 * k + _XYZ] for k in own.axes]
            if label in s.clamp_moment:
                moment.append(s.clamp_moment[label])
            if moment:
                text = f"{label}: moment about its point a that its side a exerts on side b, world axes"
                yield Channel(f"{label}_moment", text, "N m", ("xyz",)), np.stack(moment, axis=1), 1.0, 0.0


class _Sources:
    """The vector that samples are taken from, and where in it everything stands."""

    def __init__(self, system: System, more: Sequence[Any]) -> None:
        batches, con = system.batches, system.constraints
        self._lines = next((b for b in batches if isinstance(b, LineBatch)), None)
        self._clamps = next((b for b in batches if isinstance(b, EndBendingBatch)), None)
        self._tell = [*(b for b in batches if hasattr(b, "outputs")), *more]
        self._constraints = con
        lines: tuple[Line, ...] = self._lines.parts if self._lines else ()
        clamps = self._clamps.parts if self._clamps else ()
        self.size = 0
        self._slices: list[slice] = []
        self.zero = int(self._room(1)[0])
        self.x = self._room(3 * (system.n_point + 1))
        self.v, self.a = self._room(system.n_dof), self._room(system.n_dof)
        # multipliers, then moments and forces of the rows that have one: see `_loads`
        self.carried = self._room(_loads(system)[3])
        self.attitude = self._room(3 * (system.n_rotation + 1))
        self.solver, self.environment = self._room(2), self._room(2)
        ne, nn = sum(p.elements for p in lines), sum(p.elements + 1 for p in lines)
        line = self._room(ne + 2 * (ne - len(lines)) + nn + 3 * len(lines))
        sizes = [ne, ne - len(lines), ne - len(lines), nn, len(lines)]
        tension, angle, moment, gap, touchdown, lean = np.split(line, np.cumsum(sizes))
        first = np.cumsum([0, *(p.elements for p in lines)])
        # where a line stands among elements, pairs and nodes of all lines
        self.tension = {p.name: tension[a:][: p.elements] for p, a in zip(lines, first)}
        self.angle = {p.name: angle[a - q :][: p.elements - 1] for q, (p, a) in enumerate(zip(lines, first))}
        self.moment = {p.name: moment[a - q :][: p.elements - 1] for q, (p, a) in enumerate(zip(lines, first))}
        self.clearance = {p.name: gap[a + q :][: p.elements + 1] for q, (p, a) in enumerate(zip(lines, first))}
        self.touchdown = {p.name: touchdown[q : q + 1] for q, p in enumerate(lines)}
        self.declination = {p.name: lean[2 * q : 2 * q + 2] for q, p in enumerate(lines)}
        rows = [[a, p.elements, _b_is_upper(system, p)] for p, a in zip(lines, first)]
        self._lines_at = np.array(rows, dtype=np.int64)
        self._arc = np.concatenate([np.zeros(0), *(p.arc_length for p in lines)])
        clamp = self._room(_CLAMP * len(clamps)).reshape(-1, _CLAMP)
        self.clamp = {p.end: clamp[k] for k, p in enumerate(clamps)}
        self.clamp_moment = {p.name: clamp[k, 2:5] for k, p in enumerate(clamps)}
        points: list[int] = list(self._clamps.where[:, 1]) if self._clamps else []
        ties = [[y for tie in _ties(system, point) for y in tie] for point in points]
        self._ties = np.zeros((len(ties), max(map(len, ties), default=0)), dtype=np.int64)
        for row, own in zip(self._ties, ties):
            row[: len(own)] = own
        said = [batch.outputs() for batch in self._tell]
        items = [item for outputs in said for item in outputs]
        told = self._room(sum(item.size for item in items))
        start = np.cumsum([0, *(item.size for item in items)])
        self.told = [(item, told[a:b]) for item, a, b in zip(items, start, start[1:])]
        ends = np.cumsum([0, *(sum(item.size for item in outputs) for outputs in said)])
        self._shares = [slice(a, b) for a, b in zip(ends, ends[1:])]
        self.values = np.zeros(self.size)
        rooms = [self.values[part] for part in self._slices]
        (_, self._x, self._v, self._a, self._carried, self._attitude, self._solver, self._environment, self._line,
         self._clamp, self._told) = rooms  # fmt: skip
        self._waves, self._ramp = system.waves, system.model.sea.wave_ramp
        wind = system.model.wind
        self.inflow = None if wind is None else wind.at_a_point()
        self._reach = CONTACT * system.model.sea.depth
        self.want(np.arange(self.size))

    def want(self, index: Index) -> None:
        """Which sources are asked for: `collect` leaves out kinds of which there are none."""
        asked = np.zeros(self.size, dtype=bool)
        asked[index] = True
        (_, self._want_x, self._want_v, self._want_a, self._want_carried, self._want_attitude, _,
         self._want_environment, self._want_lines, self._want_clamps,
         self._want_told) = [bool(asked[part].any()) for part in self._slices]  # fmt: skip

    def _room(self, n: int) -> Index:
        first, self.size = self.size, self.size + n
        self._slices.append(slice(first, self.size))
        return np.arange(first, self.size)

    def collect(self, w: Work, iterations: int, step: float) -> None:
        """Fill `values` from the scratch."""
        self._solver[0], self._solver[1] = iterations, step
        if self._want_x:
            self._x[:] = w.x.ravel()
        if self._want_v:
            self._v[:] = w.v
        if self._want_a:
            self._a[:] = w.a
        if self._want_carried or self._want_clamps:
            n = len(w.lam)
            self._carried[:n] = w.lam
            self._constraints.loads(w, self._carried[n:])
        if self._want_attitude:
            attitudes(w.R, self._attitude)
        if self._want_lines and (b := self._lines) is not None:
            line_values(w.x, w.v, b.nodes, b.P, b.special, b.pairs, b.B, b.tables, b.bed, b.grid, self._lines_at,
                        self._arc, self._reach, self._line)  # fmt: skip
        if self._want_clamps and (c := self._clamps) is not None:
            clamp_values(w.x, w.R, self._carried, c.where, c.E, c.moment, self._ties, self._clamp)
        if self._want_told:
            for batch, share in zip(self._tell, self._shares):
                batch.measure(w, self._told[share])
        if self._want_environment and self._waves is not None:
            self._environment[0] = self._waves.elevation(0.0, 0.0, w.t, self._ramp)
        if self._want_environment and self.inflow is not None:
            self._environment[1] = self.inflow.at(w.t, self._ramp)


def _ties(system: System, point: int) -> list[tuple[int, int]]:
    """(place among the carried loads, sign) of the joints at a point: what adds up to the force it exerts on them."""
    con, first = system.constraints, _loads(system)
    found = []
    for kind, start in ((con.coincide, 0), (con.inline, first[1]), (con.separation, first[2])):
        where = kind.where
        for k in np.flatnonzero((where[:, 0] == point) | (where[:, 2] == point)):
            found.append((start + 3 * int(k), 1 if where[k, 0] == point else -1))
    return found


def _loads(system: System) -> list[int]:
    """Where, after the multipliers, moments of `align` and forces of `inline` and `separation` rows begin, and end."""
    con = system.constraints
    sizes = (3 * con.align.n, 3 * con.inline.n, 3 * con.separation.n)
    return [int(k) for k in np.cumsum([con.n, *sizes])]


def _b_is_upper(system: System, line: Line) -> bool:
    """Whether end b is drawn higher over the seabed than end a: touchdown is looked for from there."""
    num, sea = system.numbering, system.model.sea
    p = num.first_point[num.index(line.name)]
    a, b = system.x0[p], system.x0[p + line.n_points - 1]
    gaps = [z - sea.seabed.height(x, y, sea.depth) for x, y, z in (a, b)]
    return bool(gaps[1] > gaps[0])


def _bend_radius(line: Line, weight: Array) -> Array:
    """Curvature times minimum bend radius per angle at every node [1/rad], nan where none is given.

    weight [1/m]: curvature per angle. Where stiffness changes at a node both sides have the same moment, so the
    softer bends more: k/EI times its radius counts on either side, the larger of both is taken.
    """
    l0, EI = line.element_lengths, line.half_stiffness
    R = np.array([c.minimum_bend_radius or np.nan for c in line.element_sections])
    table = np.array([c.bending_law is not None for c in line.element_sections])
    a, b = EI[:-1, 1], EI[1:, 0]
    bent = (a > 0.0) & (b > 0.0) & ~table[:-1] & ~table[1:]
    a, b = np.where(bent, a, 1.0), np.where(bent, b, 1.0)
    k = 2.0 / (l0[:-1] / a + l0[1:] / b)
    inner = np.fmax(np.where(bent, k / a, weight[1:-1]) * R[:-1], np.where(bent, k / b, weight[1:-1]) * R[1:])
    return np.concatenate([weight[:1] * R[:1], inner, weight[-1:] * R[-1:]])


def _where(weight: Array) -> tuple[Array, Array]:
    """(weight, offset) that give nan where the weight is nan."""
    missing = np.isnan(weight)
    return np.where(missing, 0.0, weight), np.where(missing, np.nan, 0.0)


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
