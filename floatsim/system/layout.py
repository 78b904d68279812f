"""Where every matrix entry lives: sparsity pattern and slot map, built once.

Unknowns are the velocities of all points, then of all rotations, then the multipliers. Point and
rotation lists end with the *ground*, so joints and springs to the ground need no case of their own;
the ground's rows and columns go to one scratch slot.

The flat array of entries serves the structured solver directly: each line's inner nodes are a banded
chain, its end nodes with the multipliers that hold them are *fronts*, eliminated before the chain, the
few unknowns a chain then touches outside itself are its border columns, everything else is a small
border: dense, or above MAX_BORDER unknowns sparse, by rows.

    [ front 1 | columns 1 | front 2 ... | band 1 | left 1 | left^T 1 | right 1 | right^T 1 | band 2 ... | border
      | scratch ]

A front is stored by rows [ own unknowns | others ], then the others' rows of its own columns. Eliminating it
couples the others with each other; the pattern holds these entries too.
Entry (i, j) of a band, |i - j| <= 8, i and j counted from the chain's start, is at band + 17 i + j - i + 8, whatever
the chain's own half-bandwidth; what would lie outside the matrix stays zero.
`left` couples the chain's first rows, `right` its last rows. A run of points that does not fit this
picture joins the border, so that a model without any chain is a general sparse matrix.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Index = NDArray[np.int64]

WIDTH = 8  # half-bandwidth of every chain: two nodes on either side and less than one more
STRIDE = 2 * WIDTH + 1  # of a band's rows
REACH = 8  # rows of a chain next to its ends that may couple outside: two nodes and a half-bandwidth
MAX_BORDER = 400  # unknowns; above this the dense border costs more than a general sparse factorisation
MAX_OTHERS = 24  # unknowns; a line's end that couples to more stays in the border


@dataclass(frozen=True)
class Chain:
    """A banded run of unknowns and the border unknowns its two ends couple to."""

    start: int  # first unknown
    n: int
    left: Index  # border unknowns coupled to the first rows
    right: Index
    reach: int  # rows at each end that may couple outside


@dataclass(frozen=True)
class Front:
    """A line's end and its multipliers, eliminated first; `others` are the unknowns it couples to."""

    own: Index
    others: Index
    rows: int = -1  # offset of its rows, and of its columns in the others' rows
    columns: int = -1


@dataclass(frozen=True)
class Layout:
    """Pattern and slots. `rows`, `cols`: unique pattern; `slot`: where each entry lives in A."""

    n: int
    rows: Index
    cols: Index
    slot: Index
    size: int
    chains: tuple[Chain, ...]
    fronts: tuple[Front, ...]
    border: Index  # unknowns of the border, in order
    table: Index  # (n_chain, 12): start, n, WIDTH, reach, columns left and right; offsets of the band, left, left^T,
    # right, right^T; STRIDE
    border_offset: int
    border_keys: Index  # row * n_border + column of the border's entries, in order
    structured: bool  # the border is dense
    multiplier: int  # the first multiplier
    _keys: Index = field(repr=False)

    def slots(self, dofs: Index) -> Index:
        """Slots of all pairs of every row of `dofs` (k, m), shape (k, m * m)."""
        k, m = dofs.shape
        if k == 0:
            return np.zeros((0, m * m), dtype=np.int64)
        i = np.repeat(dofs, m, axis=1)
        j = np.tile(dofs, (1, m))
        position = np.minimum(np.searchsorted(self._keys, i * self.n + j), len(self._keys) - 1)
        found = self._keys[position] == i * self.n + j
        return np.ascontiguousarray(np.where(found, self.slot[position], self.size))


def build_layout(tables: Sequence[Index], runs: Sequence[tuple[int, int]], ground: Sequence[int], n: int) -> Layout:
    """Pattern of all element tables; runs: (first unknown, number) of candidate chains; ground: unknowns
    that are no unknowns, of its point and then of its rotation, after which multipliers follow."""
    fixed = np.zeros(n, dtype=bool)
    fixed[list(ground)] = True
    keys = np.unique(np.concatenate([_pairs(t, n) for t in tables if len(t)]))
    rows, cols = keys // n, keys % n
    free = ~(fixed[rows] | fixed[cols])
    keys = keys[free]
    chains, chain_of = _chains(runs, keys, n)
    plain = keys
    fronts = _fronts(chains, chain_of, keys, n, ground)
    if fronts:
        others = [f.others for f in fronts]
        keys = np.unique(np.concatenate([keys, *(np.repeat(o, len(o)) * n + np.tile(o, len(o)) for o in others)]))
        before = len(chains)
        kept = np.ones(n, dtype=bool)
        kept[np.concatenate([f.own for f in fronts])] = False
        chains, chain_of = _chains([(c.start, c.n) for c in chains], keys[kept[keys % n]], n)
        if len(chains) < before:  # an end's elimination has coupled more than a chain can take
            fronts, keys = [], plain
            chains, chain_of = _chains(runs, keys, n)
    rest = (chain_of < 0) & ~fixed
    for f in fronts:
        rest[f.own] = False
    # a chain's border columns must not lie in another chain
    if any((chain_of[u] >= 0).any() for c in chains for u in (c.left, c.right)):
        chains, fronts, keys = [], [], plain
        chain_of[:], rest = -1, ~fixed
    border = np.flatnonzero(rest)
    return _placed(n, keys, chains, chain_of, fronts, border, max(ground) + 1)


def _pairs(dofs: Index, n: int) -> Index:
    m = dofs.shape[1]
    return np.unique(np.repeat(dofs, m, axis=1) * n + np.tile(dofs, (1, m)))


def _chains(runs: Sequence[tuple[int, int]], keys: Index, n: int) -> tuple[list[Chain], Index]:
    """Those of the runs that are chains, and the chain of every unknown, -1 for none."""
    rows, cols = keys // n, keys % n
    chain_of = np.full(n, -1)
    chains: list[Chain] = []
    for start, number in runs:
        first, last = np.searchsorted(keys, (start * n, (start + number) * n))
        chain = _chain(start, number, rows[first:last], cols[first:last])
        if chain is not None:
            chain_of[start : start + number] = len(chains)
            chains.append(chain)
    return chains, chain_of


def _chain(start: int, number: int, rows: Index, cols: Index) -> Chain | None:
    """rows, cols: the pattern of the run's rows."""
    both = (cols >= start) & (cols < start + number)
    if int(np.max(np.abs(rows[both] - cols[both]), initial=0)) > WIDTH:
        return None
    out_rows, out_cols = rows[~both] - start, cols[~both]
    reach = min(REACH + 1, number)
    if ((out_rows >= reach) & (out_rows < number - reach)).any():
        return None
    near = out_rows < reach
    return Chain(start, number, np.unique(out_cols[near]), np.unique(out_cols[~near]), reach)


def _fronts(chains: list[Chain], chain_of: Index, keys: Index, n: int, ground: Sequence[int]) -> list[Front]:
    """Ends of chains that can go first: the end node's unknowns, if no other chain knows them, and as many
    multipliers on them. A joint holds a node by rows of unit vectors, so that their block is regular."""
    rows, cols = keys // n, keys % n
    outside = chain_of[rows] < 0
    near: dict[int, set[int]] = {}
    for i, j in zip(rows[outside].tolist(), cols[outside].tolist(), strict=True):
        near.setdefault(i, set()).add(j)
    points, multipliers = min(ground), max(ground)  # the ground's unknowns are the last of points and of rotations
    fronts = []
    for k, c in enumerate(chains):
        tied = {*c.left.tolist(), *c.right.tolist()}
        for first in (c.start - 3, c.start + c.n):  # the points before and after the inner ones
            node = [first, first + 1, first + 2]
            if any(u not in near or u not in tied or u >= points for u in node):
                continue
            touched = set().union(*(near[u] for u in node))
            held = sorted(u for u in touched if u > multipliers and all(chain_of[v] < 0 for v in near[u]))
            own = {*node, *held[: len(node)]}
            others = sorted(set().union(*(near[u] for u in own)) - own)
            inside = [u for u in others if chain_of[u] >= 0]
            mine = all(chain_of[u] == k for u in inside) and inside[-1] - inside[0] <= WIDTH
            if not mine or len(others) > MAX_OTHERS:
                continue
            for u in own:
                del near[u]
            for u in others:
                if u in near:
                    near[u] = (near[u] | set(others)) - own
            fronts.append(Front(np.array(sorted(own), np.int64), np.array(others, np.int64)))
    return fronts


def _border_keys(rows: Index, cols: Index, place: Index, chains: list[Chain], nb: int) -> Index:
    """All entries of a dense border; or what is there, and what eliminating the chains adds."""
    if nb <= MAX_BORDER:
        return np.arange(nb * nb)
    inner = (place[rows] >= 0) & (place[cols] >= 0)
    found = [place[rows[inner]] * nb + place[cols[inner]]]
    for c in chains:
        u = place[np.concatenate([c.left, c.right])]
        found.append(np.repeat(u, len(u)) * nb + np.tile(u, len(u)))
    return np.unique(np.concatenate(found))


def _placed(n: int, keys: Index, chains: list[Chain], chain_of: Index, fronts: list[Front], border: Index,
            multiplier: int) -> Layout:  # fmt: skip
    rows, cols = keys // n, keys % n
    slot = np.full(len(keys), -1)
    place = np.full(n, -1)
    place[border] = np.arange(len(border))
    offset = 0
    placed = []
    for f in fronts:
        k, m = len(f.own), len(f.others)
        i, j = np.repeat(f.own, k + m), np.tile(np.concatenate([f.own, f.others]), k)
        _put(slot, keys, i * n + j, offset + np.arange(k * (k + m)))
        i, j = np.repeat(f.others, k), np.tile(f.own, m)
        _put(slot, keys, i * n + j, offset + k * (k + m) + np.arange(m * k))
        placed.append(Front(f.own, f.others, offset, offset + k * (k + m)))
        offset += k * (k + m) + m * k
    table = np.zeros((len(chains), 12), dtype=np.int64)
    for k, c in enumerate(chains):
        first, last = np.searchsorted(keys, (c.start * n, (c.start + c.n) * n))
        i, u = rows[first:last] - c.start, cols[first:last]
        both = chain_of[u] == k
        slot[first:last][both] = offset + i[both] * STRIDE + (u - c.start - i + WIDTH)[both]
        sizes = (c.n * STRIDE, *(c.reach * len(v) for v in (c.left, c.left, c.right, c.right)))
        o = offset + np.concatenate([[0], np.cumsum(sizes)])
        tied = ~both & (place[u] >= 0)
        for columns, o1, o2, left in ((c.left, o[1], o[2], True), (c.right, o[3], o[4], False)):
            m = tied & ((i < c.reach) == left)
            at = (i[m] - (0 if left else c.n - c.reach)) * len(columns) + np.searchsorted(columns, u[m])
            slot[first:last][m] = o1 + at
            slot[np.searchsorted(keys, u[m] * n + i[m] + c.start)] = o2 + at  # the pattern is symmetric
        table[k] = (c.start, c.n, WIDTH, c.reach, len(c.left), len(c.right), *o[:5], STRIDE)
        offset = int(o[5])
    inner = (place[rows] >= 0) & (place[cols] >= 0)
    nb = len(border)
    entries = _border_keys(rows, cols, place, chains, nb)
    slot[inner] = offset + np.searchsorted(entries, place[rows[inner]] * nb + place[cols[inner]])
    return Layout(n, rows, cols, slot, offset + len(entries), tuple(chains), tuple(placed), border, table, offset,
                  entries, nb <= MAX_BORDER, multiplier, keys)  # fmt: skip


def _put(slot: Index, keys: Index, wanted: Index, value: Index) -> None:
    """Write the slots of those wanted entries that the pattern holds and that have none yet."""
    at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    found = keys[at] == wanted
    at, value = at[found], value[found]
    new = slot[at] < 0
    slot[at[new]] = value[new]
