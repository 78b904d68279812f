"""Where every matrix entry lives: sparsity pattern and slot map, built once.

Unknowns are the velocities of all points, then of all rotations, then the multipliers. Point and
rotation lists end with the *ground*, so joints and springs to the ground need no case of their own;
the ground's rows and columns go to one scratch slot.

The flat array of entries serves the structured solver directly: each line's inner nodes are a banded
chain, the few unknowns a chain touches outside itself are its border columns, everything else is a
small dense border.

    [ band 1 | left 1 | left^T 1 | right 1 | right^T 1 | band 2 ... | border, dense | scratch ]

`left` couples the chain's first rows, `right` its last rows. A run of points that does not fit this
picture joins the border; a border that grows too large makes the whole system general sparse.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Index = NDArray[np.int64]

REACH = 8  # rows of a chain next to its ends that may couple outside: two nodes and a half-bandwidth
MAX_BORDER = 400  # unknowns; above this the dense border costs more than a general sparse factorisation


@dataclass(frozen=True)
class Chain:
    """A banded run of unknowns and the border unknowns its two ends couple to."""

    start: int  # first unknown
    n: int
    width: int  # half-bandwidth
    left: Index  # border unknowns coupled to the first rows
    right: Index
    reach: int  # rows at each end that may couple outside


@dataclass(frozen=True)
class Layout:
    """Pattern and slots. `rows`, `cols`: unique pattern; `slot`: where each entry lives in A."""

    n: int
    rows: Index
    cols: Index
    slot: Index
    size: int
    chains: tuple[Chain, ...]
    border: Index  # unknowns of the border, in order
    table: Index  # (n_chain, 11) offsets for the structured solver
    border_offset: int
    _keys: Index = field(repr=False)

    @property
    def structured(self) -> bool:
        return self.border_offset >= 0

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
    that are no unknowns."""
    fixed = np.zeros(n, dtype=bool)
    fixed[list(ground)] = True
    keys = np.unique(np.concatenate([_pairs(t, n) for t in tables if len(t)]))
    rows, cols = keys // n, keys % n
    free = ~(fixed[rows] | fixed[cols])
    keys, rows, cols = keys[free], rows[free], cols[free]
    chain_of = np.full(n, -1)
    chains: list[Chain] = []
    for start, number in runs:
        chain = _chain(start, number, rows, cols)
        if chain is not None:
            chain_of[start : start + number] = len(chains)
            chains.append(chain)
    border = np.flatnonzero((chain_of < 0) & ~fixed)
    # a chain's border columns must not lie in another chain
    if any((chain_of[c.left] >= 0).any() or (chain_of[c.right] >= 0).any() for c in chains):
        chains, border = [], np.flatnonzero(~fixed)
        chain_of[:] = -1
    if len(border) > MAX_BORDER:
        slot = np.arange(len(keys))
        return Layout(n, rows, cols, slot, len(keys), (), border, np.zeros((0, 11), np.int64), -1, keys)
    return _structured(n, keys, rows, cols, chains, chain_of, border)


def _pairs(dofs: Index, n: int) -> Index:
    m = dofs.shape[1]
    return np.unique(np.repeat(dofs, m, axis=1) * n + np.tile(dofs, (1, m)))


def _chain(start: int, number: int, rows: Index, cols: Index) -> Chain | None:
    inside = (rows >= start) & (rows < start + number)
    both = inside & (cols >= start) & (cols < start + number)
    width = int(np.max(np.abs(rows[both] - cols[both]), initial=0))
    out_rows, out_cols = rows[inside & ~both] - start, cols[inside & ~both]
    if width > 11:
        return None
    reach = min(REACH + 1, number)
    outside = np.unique(out_cols)
    left, right = [], []
    for u in outside:
        touched = out_rows[out_cols == u]
        if touched.max() < reach:
            left.append(u)
        elif touched.min() >= number - reach:
            right.append(u)
        else:
            return None
    return Chain(start, number, width, np.array(left, np.int64), np.array(right, np.int64), reach)


def _structured(n: int, keys: Index, rows: Index, cols: Index, chains: list[Chain], chain_of: Index,
                border: Index) -> Layout:  # fmt: skip
    slot = np.full(len(keys), -1)
    place = np.full(n, -1)
    place[border] = np.arange(len(border))
    offset = 0
    table = np.zeros((len(chains), 11), dtype=np.int64)
    for k, c in enumerate(chains):
        w = 2 * c.width + 1
        li, lj = rows - c.start, cols - c.start
        ri, rj = chain_of[rows] == k, chain_of[cols] == k
        both = ri & rj
        slot[both] = offset + li[both] * w + (lj - li + c.width)[both]
        sizes = (c.n * w, c.reach * len(c.left), c.reach * len(c.left), c.reach * len(c.right), c.reach * len(c.right))
        o = offset + np.concatenate([[0], np.cumsum(sizes)])
        for columns, o1, o2, shift in ((c.left, o[1], o[2], 0), (c.right, o[3], o[4], c.n - c.reach)):
            index = np.full(n, -1)
            index[columns] = np.arange(len(columns))
            m = ri & ~rj & (index[cols] >= 0)
            slot[m] = o1 + (li[m] - shift) * len(columns) + index[cols[m]]
            m = rj & ~ri & (index[rows] >= 0)
            slot[m] = o2 + (lj[m] - shift) * len(columns) + index[rows[m]]
        table[k] = (c.start, c.n, c.width, c.reach, len(c.left), len(c.right), *o[:5])
        offset = int(o[5])
    inner = (place[rows] >= 0) & (place[cols] >= 0)
    slot[inner] = offset + place[rows[inner]] * len(border) + place[cols[inner]]
    size = offset + len(border) ** 2
    return Layout(n, rows, cols, slot, size, tuple(chains), border, table, offset, keys)
