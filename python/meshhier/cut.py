# SPDX-License-Identifier: MIT
"""The pieces of a cut, a tile each, which together have no crack (docs/file_format.md, sections 4.5 and 4.6)."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, Callable, Iterator, Optional

import numpy as np
from numpy.typing import NDArray

from .errors import CorruptError
from .index import Rows, TileIndex
from .manifest import Manifest
from .mesh import Mesh
from .region import Region
from .tile import Tile
from .tree import Node

# Tiles in memory. Where neighbours are read, 205 tiles took 581 reads with 4, 350 with 12, 320 with 16 and 298 with 24 of them.
FEW_TILES = 16
MANY_TILES = 256

_Numbers = NDArray[np.int64]
_Bools = NDArray[np.bool_]


class CutPieces:
    """Makes the pieces of a cut one by one. Besides a piece's own tile, those neighbours are read that are coarser, and, for the
    numbers of vertices, those that have copies.

    The number of a vertex is that in the whole cut, if each tile had all of its vertices that the index counts: own ones, and
    copies; of a textured mesh all kinds, as its tiles share none.
    """

    def __init__(
        self, manifest: Manifest, index: TileIndex, read: Callable[[Node], Tile], expect: Callable[[Rows], None], rows: Rows, with_ids: bool, kept_tiles: int
    ) -> None:
        """`expect`: is told which tiles will be read next; `rows`: the tiles of the cut from left to right; `kept_tiles`: how many are in
        memory."""
        self._manifest = manifest
        self._index = index
        self._rows = rows
        self._expect = expect
        self._read = lru_cache(maxsize=kept_tiles)(lambda row: read(index.node(row)))
        self._with_ids = with_ids
        self._is_textured = manifest.is_textured
        self._places = np.full(len(index), -1)  # of each tile its place in the cut
        self._places[rows] = np.arange(len(rows))
        counted = ("own", "copies", "ghosts", "splits") if self._is_textured else ("own", "copies")
        sizes = np.sum([index.records[kind][rows].astype(np.int64) for kind in counted], axis=0)
        self._bases = np.cumsum(sizes) - sizes

    def each(self, region: Optional[Region]) -> Iterator[Mesh]:
        """What each tile draws; with a region what touches it, of those tiles that have something there. Pieces have `ids`; those of
        other tiles' vertices are below 0, and known to this piece alone, if they were not asked for."""
        places = np.arange(len(self._rows)) if region is None else self._reaching(region)
        for at, place in enumerate(places):
            self._expect(self._rows[places[at : at + MANY_TILES]])  # no more are fetched ahead
            try:
                piece = self._piece(int(place), region)
            except (IndexError, ValueError) as error:
                raise CorruptError(f"{self._manifest.tile_name(self._index.node(self._rows[place]))}: {error}") from error
            if region is None or len(piece.triangles) > 0:
                yield piece

    def at_least_one(self, region: Optional[Region]) -> Iterator[Mesh]:
        """The same, and if there is none a piece without vertices."""
        is_empty = True
        for piece in self.each(region):
            is_empty = False
            yield piece
        if is_empty:
            piece = self._piece(0, None)
            nothing = piece.take(np.zeros(len(piece.triangles), bool))
            nothing.tiles, nothing.images, nothing.alpha_modes = [], [], []
            yield nothing

    def _reaching(self, region: Region) -> _Numbers:
        """The places in the cut of tiles that may have triangles in the region: whose box meets it, or that are beside a coarser
        one of these, as a corner moves to the place that a coarser neighbour has for it."""
        low, high = self._index.boxes(self._rows)
        levels, bounds = self._index.records["level"][self._rows], self._index.records["bound"][self._rows].astype(np.float64)
        reaches = region.may_meet(low, high)
        low, high = low - bounds[:, None], high + bounds[:, None]
        for at in np.flatnonzero(reaches & (levels < levels.max())):
            reaches |= (levels > levels[at]) & (low <= high[at]).all(axis=1) & (high >= low[at]).all(axis=1)
        return np.flatnonzero(reaches)

    def _piece(self, place: int, region: Optional[Region]) -> Mesh:
        row = int(self._rows[place])
        tile = self._read(row)
        numbers = self._numbers(tile, row)
        triangles, ids = self._drawn(tile, int(self._bases[place]), numbers)
        if region is not None:
            triangles = triangles[region.touches(tile.positions[triangles].astype(np.float64))]
        used = np.zeros(len(numbers), bool)
        used[triangles] = True
        is_own = numbers >= 0
        if self._is_textured or region is not None:
            is_own &= used
        own, others = np.flatnonzero(is_own), np.flatnonzero(used & ~is_own)
        ids_of_others, firsts, same = np.unique(ids[others], return_index=True, return_inverse=True)
        local = np.zeros(len(numbers), np.int64)
        local[own] = np.arange(len(own))
        local[others] = len(own) + same
        return self._mesh(tile, np.concatenate([own, others[firsts]]), local[triangles], np.concatenate([ids[own], ids_of_others]))

    def _numbers(self, tile: Tile, row: int) -> _Numbers:
        """The number of each vertex within its tile's share of the cut; -1 of ghosts, their copies, and splits."""
        count = len(tile.positions)
        if self._is_textured:
            return np.arange(count)
        numbers = np.full(count, -1)
        own_copies = int(np.searchsorted(tile.copy_of, tile.own))
        numbers[: tile.own] = np.arange(tile.own)
        numbers[tile.own + tile.ghosts :][:own_copies] = tile.own + np.arange(own_copies)
        return numbers

    def _drawn(self, tile: Tile, base: int, numbers: _Numbers) -> tuple[_Numbers, _Numbers]:
        """The triangles that a tile draws, and the number of each of its vertices in the cut. Its ghosts move where they are shown."""
        unsplit = np.concatenate([np.arange(len(tile.positions) - tile.splits), tile.split_of])
        ids = np.where(numbers >= 0, base + numbers, -1 - np.arange(len(numbers)))
        is_ours, places = self._move_ghosts(tile, base, unsplit, ids)
        corners = np.arange(len(unsplit)) if self._is_textured else unsplit
        border = corners[tile.border]
        before = tile.places()[border]
        now = places[before]
        # A triangle of the input may have two corners at one place; one whose corners meet here vanishes.
        has_met = (now == np.roll(now, 1, axis=1)) & (before != np.roll(before, 1, axis=1))
        is_shown = is_ours[before].all(axis=1) & ~has_met.any(axis=1)
        return np.concatenate([corners[tile.interior], border[is_shown]]), ids

    def _move_ghosts(self, tile: Tile, base: int, unsplit: _Numbers, ids: _Numbers) -> tuple[_Bools, _Numbers]:
        """Tells of each place whether its tile leaves border triangles to this one, and its number in the cut. Ghosts get the
        numbers and, of coarser neighbours, the looks of the vertices that they are there."""
        is_ours = np.ones(tile.own + tile.ghosts, bool)
        places = np.concatenate([base + np.arange(tile.own), np.full(tile.ghosts, -1)])
        shown = [self._find(tile.node, int(neighbour), chain.shape[1]) for neighbour, chain in zip(tile.neighbours, tile.chains)]
        self._expect(np.array([row for up, row in shown if row >= 0 and self._is_looked_up(row, up > 0)], np.int64))
        for (up, row), chain, first, end in zip(shown, tile.chains, tile.own + tile.ghost_starts, tile.own + tile.ghost_starts[1:]):
            if row < 0:
                is_ours[first:end] = False
                continue
            targets = chain[:, up]
            if len(targets) > 0 and targets.max() >= self._index.records["own"][row]:
                raise CorruptError(f"{self._manifest.tile_name(tile.node)}: a ghost is no vertex of its tile")
            places[first:end] = self._bases[self._places[row]] + targets
            copies = np.arange(*np.searchsorted(tile.copy_of, [first, end]))
            ghosts = np.concatenate([np.arange(first, end), tile.own + tile.ghosts + copies])
            self._move(tile, ghosts, np.concatenate([targets, targets[tile.copy_of[copies] - first]]), row, up > 0, unsplit, ids)
        return is_ours, places

    def _find(self, node: Node, neighbour: int, levels: int) -> tuple[int, int]:
        """How many levels up a neighbour of a tile is shown, and the row of that tile; -1 if it, or what is finer, draws what is between."""
        for up in range(levels):
            row = self._index.find(self._manifest.tree.ancestor(Node(node.level, neighbour), node.level - up))
            if row >= 0 and self._places[row] >= 0:
                return up, -1 if up == 0 and neighbour < node.index else row
        return 0, -1

    def _is_looked_up(self, row: int, is_coarser: bool) -> bool:
        """Whether ghosts get numbers or looks that their tile alone knows."""
        return is_coarser or bool(self._with_ids and not self._is_textured and self._index.records["copies"][row] > 0)

    def _move(self, tile: Tile, ghosts: _Numbers, targets: _Numbers, row: int, is_coarser: bool, unsplit: _Numbers, ids: _Numbers) -> None:
        """Gives ghosts and their copies what the places `targets` of another tile have; at the same level they have it."""
        record = self._index.records[row]
        if not is_coarser and (self._is_textured or not self._with_ids):
            return
        vertices = targets
        if self._is_looked_up(row, is_coarser):
            vertices = _nearest(tile, ghosts, self._read(row), targets, self._manifest.attributes["normals"])
        if not self._is_textured:
            ids[ghosts] = self._bases[self._places[row]] + np.where(vertices < record["own"], vertices, vertices - int(record["ghosts"]))
        if is_coarser:
            _take_looks(tile, ghosts, self._read(row), vertices, unsplit, not self._is_textured)

    def _mesh(self, tile: Tile, vertices: _Numbers, triangles: _Numbers, ids: _Numbers) -> Mesh:
        manifest = self._manifest

        def of(values: Optional[NDArray[Any]]) -> Optional[NDArray[Any]]:
            return None if values is None else values[vertices]

        positions = tile.positions[vertices].astype(np.float64)
        for axis in np.flatnonzero(manifest.origin):  # -0 stays -0 where nothing is added
            positions[:, axis] += manifest.origin[axis]
        attributes = {name: values[vertices] for name, values in tile.attributes.items()}
        labels = [attributes[scalar.name] for scalar in manifest.scalars if scalar.kind == "object"]
        return Mesh(
            positions=positions,
            triangles=triangles,
            normals=of(tile.normals) if manifest.attributes["normals"] or self._is_textured else None,
            colours=of(tile.colours),
            texcoords=of(tile.texcoords),
            attributes=attributes,
            tiles=[tile.node],
            triangle_tiles=np.zeros(len(triangles), np.int64),
            images=[tile.image_bytes or b""] if self._is_textured else [],
            alpha_modes=[tile.alpha_mode] if self._is_textured else [],
            triangle_objects=labels[0][triangles[:, 0]].astype(np.int64) if labels else None,
            ids=ids,
            conventions=manifest.conventions,
        )


def _take_looks(tile: Tile, ghosts: _Numbers, other: Tile, vertices: _Numbers, unsplit: _Numbers, with_texcoords: bool) -> None:
    """Gives ghosts, their copies and the splits of both all that vertices of another tile have."""
    sources = np.full(len(unsplit), -1)
    sources[ghosts] = vertices
    sources = sources[unsplit]
    moved = np.flatnonzero(sources >= 0)
    pairs: list[tuple[Optional[NDArray[Any]], Optional[NDArray[Any]]]] = [
        (tile.positions, other.positions), (tile.normals, other.normals), (tile.colours, other.colours)
    ]  # fmt: skip
    pairs += [(values, other.attributes[name]) for name, values in tile.attributes.items()]
    if with_texcoords:
        pairs.append((tile.texcoords, other.texcoords))
    for mine, theirs in pairs:
        if mine is not None and theirs is not None:
            mine[moved] = theirs[sources[moved]]


def _nearest(tile: Tile, vertices: _Numbers, other: Tile, places: _Numbers, has_given_normals: bool) -> _Numbers:
    """For each vertex of a tile that one at a place of another tile that differs in the fewest values, then by the nearest
    normal, colour and, without pictures, texture coordinate."""
    firsts, ends = np.searchsorted(other.copy_of, places), np.searchsorted(other.copy_of, places, side="right")
    if (firsts == ends).all():
        return places
    counts = 1 + ends - firsts
    asked = np.repeat(np.arange(len(places)), counts)
    number = np.arange(len(asked)) - np.repeat(np.cumsum(counts) - counts, counts)  # 0: the first vertex; then copies
    candidates = np.where(number == 0, places[asked], other.own + other.ghosts + firsts[asked] + number - 1)

    def distance(mine: Optional[NDArray[Any]], theirs: Optional[NDArray[Any]]) -> NDArray[np.float64]:
        if mine is None or theirs is None:
            return np.zeros(len(asked))
        return ((mine[vertices[asked]].astype(np.float64) - theirs[candidates].astype(np.float64)) ** 2).sum(axis=1)

    differing = np.zeros(len(asked), np.int64)
    for name, values in tile.attributes.items():
        differing += values[vertices[asked]] != other.attributes[name][candidates]
    normals = distance(tile.normals, other.normals) if has_given_normals else np.zeros(len(asked))
    texcoords = np.zeros(len(asked)) if tile.image_bytes else distance(tile.texcoords, other.texcoords)
    order = np.lexsort((number, texcoords, distance(tile.colours, other.colours), normals, differing, asked))
    return candidates[order[np.cumsum(counts) - counts]]
