# SPDX-License-Identifier: MIT
"""A hierarchy on disk, read tile by tile."""

from __future__ import annotations

import os
from typing import Any, Iterator, Optional, Sequence

import numpy as np
from numpy.typing import NDArray

from .boxes import checked_box, touches_box
from .checksum import checksum
from .cut import CutAssembly
from .errors import CorruptError, NotAHierarchyError, ReplacedError, UsageError
from .manifest import Scalar, read_manifest
from .mesh import Mesh
from .objects import ObjectTable
from .storage import open_files
from .tile import Tile, read_tile
from .tree import Node, Tree

_RECORD = np.dtype(
    {
        "names": ["level", "index", "own", "ghosts", "copies", "interior", "border", "error", "bound", "low", "high", "splits", "width", "height", "bytes", "checksum"],
        "formats": ["<u4", "<u4", "<u4", "<u4", "<u4", "<u4", "<u4", "<f4", "<f4", ("<f4", 3), ("<f4", 3), "<u4", "<u4", "<u4", "<u8", "<u8"],
        "offsets": [0, 4, 8, 16, 20, 24, 28, 48, 52, 60, 72, 84, 88, 92, 104, 112],
        "itemsize": 120,
    }
)

Box = tuple[Sequence[float], Sequence[float]]


class Hierarchy:
    """What `meshhier build` made: many resolutions of one mesh. Open it with `meshhier.open()`.

    Reads nothing but the manifest and the index until tiles are asked for. It may be used as a context manager.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = os.fspath(path)
        self._files = open_files(path)
        self._manifest = read_manifest(self._files.read("hierarchy.json"), self.path)
        facts = self._manifest.json.get("objects")
        self._objects = self._open_objects(facts, "objects.bin", self._open_objects(facts.get("words"), "object_words.bin")) if facts else None
        self._index = self._read_index()
        self._keys = self._index["level"].astype(np.uint64) << np.uint64(32) | self._index["index"]

    def __enter__(self) -> Hierarchy:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"Hierarchy({self.path!r}: {self.vertices} vertices, {self.triangles} triangles, {self.levels} levels, {len(self._index)} tiles)"

    def close(self) -> None:
        """Closes an archive. Nothing can be read any more."""
        self._files.close()

    def _read_sealed(self, name: str, size: int, expected: int) -> bytes:
        """A file whose size and checksum another one tells. Raises ReplacedError where another build has taken its place."""
        try:
            data = self._files.read(name)
            if len(data) != size or checksum(data) != expected:
                raise CorruptError(f"{self.path}: {name} has another size or checksum than it was made with: it is damaged")
            return data
        except (CorruptError, OSError):
            if self._is_replaced():
                raise ReplacedError(f"{self.path}: another hierarchy has taken its place since it was opened: open it again") from None
            raise

    def _open_objects(self, facts: Any, file: str, words: Optional[ObjectTable] = None) -> Optional[ObjectTable]:
        return ObjectTable(facts, lambda begin, end: self._files.part(file, begin, end), self.path, file, words) if facts else None

    def _is_replaced(self) -> bool:
        try:
            now = read_manifest(self._files.read("hierarchy.json"), self.path)
        except (CorruptError, NotAHierarchyError, OSError):
            return False  # then what failed says why
        return now.build != self._manifest.build

    def _read_index(self) -> NDArray[Any]:
        data = self._read_sealed("tiles.bin", self._manifest.index_bytes, self._manifest.index_checksum)
        header = 32
        count = 2 * self.tree.partitions - 1
        if data[:8] != b"MHTILES\n" or len(data) != header + count * _RECORD.itemsize:
            raise CorruptError(f"{self.path}: tiles.bin is not the index of {count} tiles")
        return np.frombuffer(data, _RECORD, count, header)

    # What it is.

    @property
    def manifest(self) -> dict[str, Any]:
        """All of `hierarchy.json` (docs/file_format.md, section 2)."""
        return self._manifest.json

    @property
    def tree(self) -> Tree:
        return self._manifest.tree

    @property
    def levels(self) -> int:
        """How many there are: level 0 is one tile, level `levels - 1` has the original triangles."""
        return self.tree.depth + 1

    @property
    def vertices(self) -> int:
        """Of the input."""
        return int(self.manifest["source"]["vertices"])

    @property
    def triangles(self) -> int:
        """Of the input."""
        return int(self.manifest["source"]["triangles"])

    @property
    def bounds(self) -> NDArray[np.float64]:
        """(2, 3): the least and the greatest coordinates of the input."""
        bounds = self.manifest["source"]["bounds"]
        return np.array([bounds["min"], bounds["max"]], np.float64)

    @property
    def origin(self) -> NDArray[np.float64]:
        """(3,): what is added to positions of tiles for input coordinates."""
        return self._manifest.origin

    @property
    def units(self) -> Optional[str]:
        """What lengths are in: "mm", "m", ...; None if nobody said it."""
        return self.manifest.get("units")

    @property
    def view(self) -> dict[str, Any]:
        """How it is shown first (docs/file_format.md, section 2.2); empty if nobody said it."""
        view = self.manifest.get("view", {})
        if not isinstance(view, dict):
            raise CorruptError('hierarchy.json: "view" is wrong, expected an object')
        return dict(view)

    @property
    def scalars(self) -> list[Scalar]:
        """The further numbers of vertices: quality, label, ..."""
        return list(self._manifest.scalars)

    @property
    def objects(self) -> Optional[ObjectTable]:
        """Names and properties of the things that the mesh consists of; None if it has none."""
        return self._objects

    @property
    def errors(self) -> NDArray[np.float64]:
        """(levels,): the largest estimated distance of each level to the original surface, input units."""
        return np.array([self._index["error"][self._index["level"] == level].max() for level in range(self.levels)], np.float64)

    # Tiles.

    def _record(self, node: Node) -> Any:
        key = np.uint64(node.level << 32 | node.index)
        at = int(np.searchsorted(self._keys, key))
        if at == len(self._keys) or self._keys[at] != key:
            raise UsageError(f"{self.path}: there is no tile {node}")
        return self._index[at]

    def error(self, node: Node) -> float:
        """Estimated distance of a tile to the original surface, input units; 0 of partitions."""
        return float(self._record(node)["error"])

    def bound(self, node: Node) -> float:
        """Certain upper bound of the Hausdorff distance to the original surface, input units."""
        return float(self._record(node)["bound"])

    def tile_bounds(self, node: Node) -> NDArray[np.float64]:
        """(2, 3): the box of all vertices of a tile, input coordinates."""
        record = self._record(node)
        return np.stack([record["low"], record["high"]]).astype(np.float64) + self.origin

    def read_tile(self, node: Node) -> Tile:
        """One tile, with its seams. Raises UsageError if there is none, CorruptError, ReplacedError."""
        record = self._record(node)
        data = self._read_sealed(self._manifest.tile_name(node), int(record["bytes"]), int(record["checksum"]))
        return read_tile(data, node, self._manifest)

    def iter_tiles(self, level: Optional[int] = None) -> Iterator[Tile]:
        """The tiles of a level (the finest if none is given), one after another: memory for one at a time.

        Each vertex of the level is an own one of one tile. Triangles are not: those at seams, `tile.border`, are in every tile
        that they touch; what is summed over triangles is summed over those of `cut()`.
        """
        for node in self.tree.level(self._level(level)):
            yield self.read_tile(node)

    def _level(self, level: Optional[int]) -> int:
        wanted = self.tree.depth if level is None else level
        if not 0 <= wanted < self.levels:
            raise UsageError(f"{self.path}: there is no level {wanted}; it has 0 to {self.levels - 1}")
        return wanted

    # Cuts.

    def cut_nodes(self, *, error: Optional[float] = None, level: Optional[int] = None, box: Optional[Box] = None) -> list[Node]:
        """The tiles that `cut()` takes: those of a level, or the coarsest whose error is no larger than `error`; the finest if
        neither is given. With a `box` those outside of it are as coarse as they may."""
        if error is not None and level is not None:
            raise UsageError("a cut is by error or by level, not both")
        if error is not None and not error >= 0:
            raise UsageError(f"an error is 0 or more, in input units, not {error}")
        wanted = self._level(level) if error is None else self.tree.depth
        low, high = (None, None) if box is None else checked_box(box)
        nodes: list[Node] = []
        pending = [self.tree.tile(Node(0, 0))]
        while pending:
            node = pending.pop()
            is_fine = node.level >= wanted or (error is not None and self.error(node) <= error)
            bounds = self.tile_bounds(node)
            is_outside = low is not None and bool((bounds[0] > high).any() or (bounds[1] < low).any())
            children = self.tree.children(node)
            if is_fine or is_outside or not children:
                nodes.append(node)
            else:
                pending += reversed(children)
        return nodes

    def cut(
        self,
        *,
        error: Optional[float] = None,
        level: Optional[int] = None,
        box: Optional[Box] = None,
        nodes: Optional[Sequence[tuple[int, int]]] = None,
    ) -> Mesh:
        """One mesh without cracks, in input coordinates.

        Args:
            error: the coarsest tiles that are no farther than this from the original surface, input units.
            level: all tiles of one level; 0 is the coarsest. Neither: the original triangles, bit for bit.
            box: ((x, y, z), (x, y, z)), input coordinates: only triangles that touch it. Little is read besides.
            nodes: instead of these the tiles of a cut: each partition is one of them, or below exactly one.

        All of the result is in memory; for a mesh that is larger, use `iter_tiles()` or boxes.
        """
        if nodes is not None:
            if error is not None or level is not None:
                raise UsageError("nodes say which tiles: there can be no error and no level besides")
            chosen = self._checked([Node(*node) for node in nodes])
        else:
            chosen = self.cut_nodes(error=error, level=level, box=box)
        corners = None if box is None else checked_box(box)
        mesh = CutAssembly(self._manifest, self.read_tile).mesh(chosen)
        labels = [mesh.attributes[scalar.name] for scalar in self._manifest.scalars if scalar.kind == "object"]
        if labels:
            mesh.triangle_objects = labels[0][mesh.triangles[:, 0]].astype(np.int64)
        return mesh if corners is None else mesh.take(touches_box(mesh.positions[mesh.triangles], *corners))

    def _checked(self, nodes: list[Node]) -> list[Node]:
        for node in nodes:
            self._record(node)
        ordered = sorted(nodes, key=self.tree.range)
        covered = 0
        for node in ordered:
            first, end = self.tree.range(node)
            if first != covered:
                raise UsageError(f"{self.path}: no cut: partition {min(first, covered)} is in {'two nodes' if first < covered else 'none'}")
            covered = end
        if covered != self.tree.partitions:
            raise UsageError(f"{self.path}: no cut: partition {covered} is in none")
        return ordered
