# SPDX-License-Identifier: MIT
"""The index of all tiles (docs/file_format.md, section 3), and which of them make a cut."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from .errors import CorruptError, UsageError
from .tree import Node, NodeLike, Tree, as_node

_HEADER = 32
_RECORD = np.dtype(
    {
        "names": ["level", "index", "own", "ghosts", "copies", "interior", "border", "error", "bound", "low", "high", "splits", "width", "height", "bytes", "checksum"],
        "formats": ["<u4", "<u4", "<u4", "<u4", "<u4", "<u4", "<u4", "<f4", "<f4", ("<f4", 3), ("<f4", 3), "<u4", "<u4", "<u4", "<u8", "<u8"],
        "offsets": [0, 4, 8, 16, 20, 24, 28, 48, 52, 60, 72, 84, 88, 92, 104, 112],
        "itemsize": 120,
    }
)

Rows = NDArray[np.int64]


class TileIndex:
    """One record a tile, ascending by level, then by index. A row is a record's number."""

    def __init__(self, data: bytes, tree: Tree, path: str) -> None:
        count = 2 * tree.partitions - 1
        if data[:8] != b"MHTILES\n" or len(data) != _HEADER + count * _RECORD.itemsize:
            raise CorruptError(f"{path}: tiles.bin is not the index of {count} tiles")
        self.records: NDArray[Any] = np.frombuffer(data, _RECORD, count, _HEADER)
        self._tree = tree
        self._path = path
        self._keys = self.records["level"].astype(np.uint64) << np.uint64(32) | self.records["index"]
        keys, self._parents, self._firsts, self._ends = _rows_of(tree)
        if not np.array_equal(keys, self._keys):
            raise CorruptError(f"{path}: tiles.bin has other tiles than a tree of {tree.partitions} partitions")

    def __len__(self) -> int:
        return len(self.records)

    def find(self, node: Node) -> int:
        """The row of a tile; -1 if there is none."""
        key = np.uint64(node.level << 32 | node.index)
        row = int(np.searchsorted(self._keys, key))
        return row if row < len(self) and self._keys[row] == key else -1

    def row(self, name: NodeLike) -> int:
        """The row of a tile. Raises UsageError if there is none."""
        node = as_node(name)
        row = self.find(self._tree.node(node))
        if row < 0:
            raise UsageError(f"{self._path}: there is no tile {node}: {self._tree.tile(node)} stands for this node")
        return row

    def node(self, row: int) -> Node:
        record = self.records[row]
        return Node(int(record["level"]), int(record["index"]))

    def boxes(self, rows: Rows) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(n, 3) and (n, 3): the least and the greatest coordinates of tiles, relative to the origin."""
        return self.records["low"][rows].astype(np.float64), self.records["high"][rows].astype(np.float64)

    def cut(self, *, error: Optional[float], level: int, needed: Optional[Rows] = None) -> Rows:
        """The tiles of a level, or above it the coarsest whose error is no larger than `error`, from left to right. With `needed`,
        tiles of that cut, those where none of them is are as coarse as they may be."""
        levels = self.records["level"]
        stops = levels >= level
        if error is not None:
            stops |= self.records["error"].astype(np.float64) <= error
        if needed is not None:
            before = np.zeros(self._tree.partitions + 1, np.int64)
            before[self._firsts[needed] + 1] = 1
            before = np.cumsum(before)
            stops |= before[self._ends] == before[self._firsts]
        is_reached = np.ones(len(self), bool)
        starts = np.searchsorted(levels, np.arange(1, self._tree.depth + 2))
        for first, end in zip(starts, starts[1:]):
            parents = self._parents[first:end]
            is_reached[first:end] = is_reached[parents] & ~stops[parents]
        return self.from_left(np.flatnonzero(is_reached & (stops | (levels == self._tree.depth))))

    def from_left(self, rows: Rows) -> Rows:
        """The tiles in the order of their partitions."""
        return rows[np.argsort(self._firsts[rows], kind="stable")]

    def check_cut(self, rows: Rows) -> Rows:
        """The tiles from left to right. Raises UsageError unless each partition is one of them, or below exactly one."""
        ordered = self.from_left(rows)
        firsts, ends = self._firsts[ordered], self._ends[ordered]
        wanted = np.append(0, ends)
        wrong = np.flatnonzero(np.append(firsts, self._tree.partitions) != wanted)
        if len(wrong):
            first, expected = int(np.append(firsts, self._tree.partitions)[wrong[0]]), int(wanted[wrong[0]])
            raise UsageError(f"{self._path}: no cut: partition {min(first, expected)} is in {'two nodes' if first < expected else 'none'}")
        return ordered


def _rows_of(tree: Tree) -> tuple[NDArray[np.uint64], Rows, Rows, Rows]:
    """Of each tile its key, the row of its parent's tile (-1 of the root), and its partitions [first, end)."""
    firsts, ends, above = np.array([0]), np.array([tree.partitions]), np.array([-1])
    parts = []
    count = 0
    for level in range(tree.depth + 1):
        has_tile = (ends - firsts > 1) | (level == tree.depth)
        indices = np.flatnonzero(has_tile)
        keys = np.uint64(level << 32) | indices.astype(np.uint64)
        parts.append((keys, above[has_tile], firsts[has_tile], ends[has_tile]))
        nearest = np.where(has_tile, count + np.cumsum(has_tile) - 1, above)
        count += len(indices)
        middles = firsts + (ends - firsts + 1) // 2
        firsts, ends = np.stack([firsts, middles], 1).ravel(), np.stack([middles, ends], 1).ravel()
        above = np.repeat(nearest, 2)
        if level == tree.depth - 1:  # an early node has one child
            is_there = ends > firsts
            firsts, ends, above = firsts[is_there], ends[is_there], above[is_there]
    keys, parents, starts, stops = (np.concatenate(columns) for columns in zip(*parts))
    return keys, parents, starts, stops
