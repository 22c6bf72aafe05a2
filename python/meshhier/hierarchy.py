# SPDX-License-Identifier: MIT
"""A hierarchy on disk, read tile by tile."""

from __future__ import annotations

import os
from functools import partial
from typing import TYPE_CHECKING, Any, Iterable, Iterator, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .asked import Names, Path, is_web_address, length, path_text, whole
from .boxes import Box
from .checksum import checksum
from .cut import FEW_TILES, MANY_TILES, CutPieces
from .errors import CorruptError, NetworkError, NotAHierarchyError, ProgramNotFoundError, UsageError, replaced
from .http_client import Headers
from .index import Rows, TileIndex
from .manifest import Scalar, read_manifest
from .mesh import Mesh
from .objects import ObjectTable
from .polygons import Polygon
from .queries import Hits, Nearest, nearest, rays
from .region import Region
from .remote import CACHE_BYTES, open_place
from .tile import Tile, read_tile
from .tree import Node, NodeLike, Tree

if TYPE_CHECKING:
    from .cell import Cell


class Hierarchy:
    """What `meshhier build` made: many resolutions of one mesh. Open it with `meshhier.open()`.

    Reads nothing but the manifest and the index until tiles are asked for. It may be used as a context manager, and pickled: it is
    opened again elsewhere, where ReplacedError tells that another build has taken its place.

    Where a node is asked for, a Node, (level, index) and "LEVEL/INDEX" are one.
    """

    path: str

    def __init__(self, path: Path, *, headers: Optional[Headers] = None, cache_bytes: int = CACHE_BYTES) -> None:
        asked = path_text(path)
        self._place = (asked if is_web_address(asked) else os.path.abspath(asked)), headers, cache_bytes
        self.path, self._files = open_place(asked, headers, cache_bytes)
        try:
            self._read_facts()
        except BaseException:
            self._files.close()
            raise

    def _read_facts(self) -> None:
        self._manifest = read_manifest(self._files.read("hierarchy.json"), self.path)
        facts = self._manifest.json.get("objects")
        self._objects = self._open_objects(facts, "objects.bin", self._open_objects(facts.get("words"), "object_words.bin")) if facts else None
        index = self._read_sealed("tiles.bin", self._manifest.index_bytes, self._manifest.index_checksum)
        self._index = TileIndex(index, self.tree, self.path)

    def __enter__(self) -> Hierarchy:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"Hierarchy({self.path!r}: {self.vertices} vertices, {self.triangles} triangles, {self.levels} levels, {len(self._index)} tiles)"

    def __reduce__(self) -> tuple[Any, ...]:
        self._files.require_open()
        place, *how = self._place
        return _reopened, (type(self), self._manifest.build, place, *how)

    def close(self) -> None:
        """Closes it. Nothing can be read any more: UsageError. Functions that run the program still take it, as the name of its place."""
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
                raise replaced(self.path) from None
            raise

    def _open_objects(self, facts: Any, file: str, words: Optional[ObjectTable] = None) -> Optional[ObjectTable]:
        return ObjectTable(facts, partial(self._files.part, file), self.path, file, words) if facts else None

    def _is_replaced(self) -> bool:
        try:
            now = read_manifest(self._files.read("hierarchy.json"), self.path)
        except (CorruptError, NetworkError, NotAHierarchyError, OSError):
            return False  # then what failed says why
        return now.build != self._manifest.build

    # In a notebook.

    def show(self, *, height: int = 500, view: str = "", link: Optional[str] = None, size: int = 3_000_000) -> Cell:
        """What a cell of a notebook shows as its last expression, or by `display()`: the model, to be turned and approached.

        It holds the viewer and the coarse tiles that fit, and shows them without a network and without the kernel, too. Below it says how
        much of the model that is. Finer tiles come from the kernel if the browser runs on its machine.

        Args:
            height: of the cell, in pixels.
            view: a link of the page, or what it says after the model: "light=raking&colours=height".
            link: where the browser finds all of the hierarchy, instead of from the kernel: an address, or a path on the notebook's own host, as
                "/files/david.hier"; "": nowhere.
            size: bytes of the cell's output, at the most.

        Raises UsageError if not even the root fits or `link` has a password, ProgramNotFoundError if there is no viewer, ReplacedError, CorruptError.
        """
        from .cell import make_cell

        return make_cell(self, height=height, view=view, link=link, size=size)

    def _repr_html_(self) -> Optional[str]:
        try:
            return self.show().html
        except (ProgramNotFoundError, UsageError):
            return None  # then it is shown as text

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
        return self._manifest.vertices

    @property
    def triangles(self) -> int:
        """Of the input."""
        return self._manifest.triangles

    @property
    def bounds(self) -> NDArray[np.float64]:
        """(2, 3): the least and the greatest coordinates of the input."""
        return self._manifest.bounds.copy()

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
        records = self._index.records
        return np.array([records["error"][records["level"] == level].max() for level in range(self.levels)], np.float64)

    # Tiles.

    def error(self, node: NodeLike) -> float:
        """Estimated distance of a tile to the original surface, input units; 0 of partitions."""
        return float(self._index.records["error"][self._index.row(node)])

    def bound(self, node: NodeLike) -> float:
        """Certain upper bound of the Hausdorff distance to the original surface, input units."""
        return float(self._index.records["bound"][self._index.row(node)])

    def tile_bounds(self, node: NodeLike) -> NDArray[np.float64]:
        """(2, 3): the box of all vertices of a tile, input coordinates."""
        return np.concatenate(self._index.boxes(np.array([self._index.row(node)]))) + self.origin

    def read_tile(self, node: NodeLike) -> Tile:
        """One tile, with its seams. Raises UsageError if there is none, CorruptError, ReplacedError."""
        row = self._index.row(node)
        tile, record = self._index.node(row), self._index.records[row]
        data = self._read_sealed(self._manifest.tile_name(tile), int(record["bytes"]), int(record["checksum"]))
        return read_tile(data, tile, self._manifest)

    def iter_tiles(self, level: Optional[int] = None, *, error: Optional[float] = None) -> Iterator[Tile]:
        """The tiles of a level, or of the cut by an error (the finest if neither is given), one after another: memory for one at a time.

        Each vertex of the cut is an own one of one tile. Triangles are not: those at seams, `tile.border`, are in every tile
        that they touch. What is summed over triangles is summed over `iter_parts()`.
        """
        return self._each_tile(self._cut(error, level))

    def _each_tile(self, rows: Rows) -> Iterator[Tile]:
        for at, row in enumerate(rows):
            self._expect(rows[at:])
            yield self.read_tile(self._index.node(row))

    def _expect(self, rows: Rows) -> None:
        """Tells which tiles will be read next."""
        self._files.expect((self._manifest.tile_name(self._index.node(row)), int(self._index.records["bytes"][row])) for row in rows)

    # Questions.

    def nearest(
        self,
        points: ArrayLike,
        *,
        level: Optional[int] = None,
        error: Optional[float] = None,
        box: Optional[Box] = None,
        polygon: Optional[Polygon] = None,
        crs: Optional[str] = None,
        object: Optional[Names] = None,
        where: Optional[str] = None,
        signed: bool = False,
        memory_budget: Union[int, str, None] = None,
    ) -> Nearest:
        """The nearest place of the surface to each point, exactly, and its distance: millions of points are sorted, and tiles read, by
        the program within a memory budget.

        Args:
            points: (n, 3), input coordinates; or one point.
            level, error: the surface of a level, or of the coarsest tiles that are no farther than this from the original one, instead of
                this. `bound` of the result says how far it is.
            box, polygon, crs, object, where: only triangles that touch this piece, as `meshhier.export()` takes it.
            signed: distances are below 0 inside; takes longer.
            memory_budget: bytes, or "2GiB"; 1 GiB if not given.

        Of triangles that are equally near, the first one of the first tile is named. Raises UsageError, ReplacedError, ProgramError,
        ProgramNotFoundError.
        """
        piece = {"box": box, "polygon": polygon, "crs": crs, "object": object, "where": where}
        return nearest(self, points, {**self._surface(error, level), **piece, "signed": signed, "memory_budget": memory_budget})

    def rays(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        level: Optional[int] = None,
        error: Optional[float] = None,
        box: Optional[Box] = None,
        polygon: Optional[Polygon] = None,
        crs: Optional[str] = None,
        object: Optional[Names] = None,
        where: Optional[str] = None,
        memory_budget: Union[int, str, None] = None,
    ) -> Hits:
        """What each ray hits first, from either side of the surface; no ray slips through between two triangles.

        Args:
            origins, directions: (n, 3) each, input coordinates; or one of either for all rays. Directions have any length but 0.
            level, error, box, polygon, crs, object, where, memory_budget: as those of `nearest()`.
        """
        piece = {"box": box, "polygon": polygon, "crs": crs, "object": object, "where": where}
        return rays(self, origins, directions, {**self._surface(error, level), **piece, "memory_budget": memory_budget})

    # Cuts.

    def cut_nodes(
        self, *, error: Optional[float] = None, level: Optional[int] = None, box: Optional[Box] = None, polygon: Optional[Polygon] = None
    ) -> list[Node]:
        """A cut, from left to right: the tiles of a level, or the coarsest whose error is no larger than `error`; the finest if
        neither is given. With a `box` or `polygon` tiles elsewhere are as coarse as they may."""
        rows = self._cut(error, level)
        region = self._region(box, polygon)
        if region is not None:
            needed = rows[region.may_meet(*self._index.boxes(rows))]
            rows = self._index.cut(error=error, level=self._level(level), needed=needed)
        return [self._index.node(row) for row in rows]

    def iter_parts(
        self,
        *,
        error: Optional[float] = None,
        level: Optional[int] = None,
        nodes: Optional[Iterable[NodeLike]] = None,
        box: Optional[Box] = None,
        polygon: Optional[Polygon] = None,
        ids: bool = False,
    ) -> Iterator[Mesh]:
        """The mesh of `cut()`, which has the other parameters, in pieces: each triangle is in exactly one of them, those at seams too.

        A piece is what one tile draws, and has `tiles`, `images` and so on of that one; its own vertices come first. At most 16 tiles
        are in memory besides, however large the cut is.

        With `ids`, `piece.ids` are numbers of vertices: of one vertex in several pieces they are the same, and they ascend as the
        vertices of `cut()` do, though some numbers may be missing. `Mesh.join(pieces)` is the mesh of `cut()`.
        """
        pieces, region = self._pieces(nodes, error, level, box, polygon, bool(ids), FEW_TILES)
        return pieces.each(region) if ids else map(_without_ids, pieces.each(region))

    def cut(
        self,
        *,
        error: Optional[float] = None,
        level: Optional[int] = None,
        nodes: Optional[Iterable[NodeLike]] = None,
        box: Optional[Box] = None,
        polygon: Optional[Polygon] = None,
    ) -> Mesh:
        """One mesh without cracks, in input coordinates.

        Args:
            error: the coarsest tiles that are no farther than this from the original surface, input units.
            level: all tiles of one level; 0 is the coarsest. Neither: the original triangles, bit for bit.
            nodes: instead of these the tiles of a cut: each partition is one of them, or below exactly one.
            box: ((x, y, z), (x, y, z)), input coordinates, perhaps infinite: only triangles that touch it. Little is read besides.
            polygon: only triangles of which a part is in it, seen from above, whatever their height: a GeoJSON file, an object as
                GeoJSON has them (shapely's, too), or a list of corners. Coordinates are the input's: x and y where z points up
                (`manifest["up"]`), else x and -z. With a box, what meets both.

        All of the result is in memory; of a mesh that is larger, `iter_parts()` has the pieces.
        """
        pieces, region = self._pieces(nodes, error, level, box, polygon, True, MANY_TILES)
        return Mesh.join(pieces.at_least_one(region))

    def _level(self, level: Optional[int]) -> int:
        refusal = f"{self.path}: a level is a whole number from 0, the coarsest, to {self.levels - 1}, the original"
        wanted = self.tree.depth if level is None else whole(level, refusal)
        if not 0 <= wanted < self.levels:
            raise UsageError(f"{refusal}, not {level}")
        return wanted

    def _surface(self, error: Optional[float], level: Optional[int]) -> dict[str, Any]:
        """By what tiles are chosen, checked: the largest error, a level, or neither."""
        if error is not None and level is not None:
            raise UsageError("tiles are chosen by error or by level, not both")
        if error is not None:
            return {"error": length(error, "an error is a length in input units, 0 or more (of the coarsest tile, level=0)")}
        return {} if level is None else {"level": self._level(level)}

    def _cut(self, error: Optional[float], level: Optional[int]) -> Rows:
        chosen = self._surface(error, level)
        return self._index.cut(error=chosen.get("error"), level=chosen.get("level", self.tree.depth))

    def _region(self, box: Optional[Box], polygon: Optional[Polygon]) -> Optional[Region]:
        is_z_up = self._manifest.conventions.up == "z"
        return None if box is None and polygon is None else Region(box, polygon, is_z_up, self.origin)

    def _pieces(
        self,
        nodes: Optional[Iterable[NodeLike]],
        error: Optional[float],
        level: Optional[int],
        box: Optional[Box],
        polygon: Optional[Polygon],
        with_ids: bool,
        kept_tiles: int,
    ) -> tuple[CutPieces, Optional[Region]]:
        if nodes is None:
            rows = self._cut(error, level)
        elif error is not None or level is not None:
            raise UsageError("nodes say which tiles: there can be no error and no level besides")
        elif isinstance(nodes, str) or not hasattr(nodes, "__iter__"):
            raise UsageError(f"nodes are a list, as [(1, 0), (1, 1)], not {nodes!r}")
        else:
            rows = self._index.check_cut(np.array([self._index.row(node) for node in nodes], np.int64))
        return CutPieces(self._manifest, self._index, self.read_tile, self._expect, rows, with_ids, kept_tiles), self._region(box, polygon)


Place = Union[Path, Hierarchy]
"""What names a hierarchy: a path, an address, or an open one."""


def _without_ids(piece: Mesh) -> Mesh:
    piece.ids = None
    return piece


def _reopened(kind: type[Hierarchy], build: str, path: str, headers: Optional[Headers], cache_bytes: int) -> Hierarchy:
    hierarchy = kind(path, headers=headers, cache_bytes=cache_bytes)
    if hierarchy._manifest.build != build:
        hierarchy.close()
        raise replaced(hierarchy.path)
    return hierarchy
