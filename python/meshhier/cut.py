# SPDX-License-Identifier: MIT
"""Assembles the tiles of a cut without a crack (docs/file_format.md, sections 4.5 and 4.6)."""

from __future__ import annotations

from typing import Any, Callable, Optional

import numpy as np
from numpy.typing import NDArray

from .errors import CorruptError
from .manifest import Manifest
from .mesh import Mesh
from .tile import Tile
from .tree import Node

_FINER = -1


class _Part:
    """What a tile adds to the mesh. Its vertices: own ones, their copies, and of a textured tile all others that it draws."""

    def __init__(self, tile: Tile, base: int, is_textured: bool) -> None:
        self.tile = tile
        self.base = base
        self.places = tile.places()
        self.own_copies = int(np.searchsorted(tile.copy_of, tile.own))
        self.unsplit = tile.own + tile.ghosts + tile.copies
        kept = np.zeros(self.unsplit + tile.splits, bool)
        kept[: tile.own] = True
        kept[tile.own + tile.ghosts :][: self.own_copies] = True
        if is_textured:
            kept[:] = True
        self.kept = np.flatnonzero(kept)
        self.numbers = np.full(len(kept), -1, np.int64)
        self.numbers[self.kept] = base + np.arange(len(self.kept))

    def wedges(self, place: int) -> list[int]:
        """All vertices at an own place, splits aside."""
        copies = self.tile.copy_of
        first, end = np.searchsorted(copies, [place, place + 1])
        return [place, *range(self.tile.own + self.tile.ghosts + int(first), self.tile.own + self.tile.ghosts + int(end))]


class CutAssembly:
    """Makes one mesh of the tiles of a cut."""

    def __init__(self, manifest: Manifest, read: Callable[[Node], Tile]) -> None:
        self._manifest = manifest
        self._read = read
        self._has_given_normals: bool = manifest.attributes["normals"]

    def mesh(self, nodes: list[Node]) -> Mesh:
        is_textured = self._manifest.is_textured
        parts: dict[Node, _Part] = {}
        base = 0
        for node in nodes:
            part = parts[node] = _Part(self._read(node), base, is_textured)
            base += len(part.kept)
        self._parts = parts
        triangles, owners = [], []
        for number, part in enumerate(parts.values()):
            drawn = self._drawn(part)
            triangles.append(drawn)
            owners.append(np.full(len(drawn), number, np.int64))
        return self._joined(nodes, np.concatenate(triangles), np.concatenate(owners))

    def _drawn(self, part: _Part) -> NDArray[np.int64]:
        tile = part.tile
        unsplit = np.concatenate([np.arange(part.unsplit), tile.split_of])
        corners_of = np.arange(len(unsplit)) if self._manifest.is_textured else unsplit
        interior = part.numbers[corners_of[tile.interior]]
        if len(tile.border) == 0:
            return interior
        is_ours, places, vertices = self._ghosts(part)
        border = corners_of[tile.border]
        before = part.places[border]
        at = places[before]
        shown = is_ours[before].all(axis=1)
        # A triangle of the input may have two corners at one place; one whose corners meet here vanishes.
        shown &= ((at != np.roll(at, 1, axis=1)) | (before == np.roll(before, 1, axis=1))).all(axis=1)
        return np.concatenate([interior, vertices[border[shown]]])

    def _ghosts(self, part: _Part) -> tuple[NDArray[np.bool_], NDArray[np.int64], NDArray[np.int64]]:
        """Tells of each place whether its tile leaves border triangles to this one, and its number in the whole cut; and the
        number of each vertex in the mesh."""
        tile, manifest = part.tile, self._manifest
        is_ours = np.ones(tile.own + tile.ghosts, bool)
        places = np.concatenate([part.base + np.arange(tile.own), np.full(tile.ghosts, -1)])
        vertices = part.numbers.copy()
        for i, neighbour in enumerate(tile.neighbours):
            node = Node(tile.node.level, int(neighbour))
            coarser, other = self._find(node, tile.chains[i].shape[1])
            first, end = (tile.own + int(g) for g in tile.ghost_starts[i : i + 2])
            if other is None or (coarser == 0 and node.index < tile.node.index):
                is_ours[first:end] = False
                continue
            targets = tile.chains[i][:, coarser]
            if len(targets) > 0 and targets.max() >= other.tile.own:
                raise CorruptError(f"{manifest.tile_name(tile.node)}: a ghost is no vertex of its tile")
            places[first:end] = other.base + targets
            self._move(part, first, end, other, targets, coarser > 0, vertices)
        return is_ours, places, vertices

    def _find(self, node: Node, levels: int) -> tuple[int, Optional[_Part]]:
        """How many levels up a neighbour is shown, and that tile."""
        tree = self._manifest.tree
        for up in range(levels):
            part = self._parts.get(tree.ancestor(node, node.level - up))
            if part is not None:
                return up, part
        return _FINER, None

    def _move(
        self,
        part: _Part,
        first: int,
        end: int,
        other: _Part,
        targets: NDArray[np.int64],
        is_coarser: bool,
        vertices: NDArray[np.int64],
    ) -> None:
        """Finds the vertices of `other` that ghosts [first, end) and their copies are."""
        tile = part.tile
        copies = np.arange(*np.searchsorted(tile.copy_of, [first, end]))
        ghosts = np.concatenate([np.arange(first, end), tile.own + tile.ghosts + copies])
        targets = np.concatenate([targets, targets[tile.copy_of[copies] - first]])
        if self._manifest.is_textured:
            self._move_textured(part, ghosts, targets, other, is_coarser)
            return
        vertices[ghosts] = other.base + targets
        counts = np.diff(np.searchsorted(other.tile.copy_of, np.stack([targets, targets + 1])), axis=0)[0]
        for ghost, target in zip(ghosts[counts > 0], targets[counts > 0]):
            vertices[ghost] = other.numbers[_nearest(tile, int(ghost), other.tile, other.wedges(int(target)), self._has_given_normals)]

    def _move_textured(self, part: _Part, ghosts: NDArray[np.int64], targets: NDArray[np.int64], other: _Part, is_coarser: bool) -> None:
        """Vertices of a textured tile stay its own, with its texture coordinates, and take the place and look of the target."""
        tile = part.tile
        for ghost, target in zip(ghosts, targets):
            same = np.concatenate([[ghost], part.unsplit + np.flatnonzero(tile.split_of == ghost)])
            tile.positions[same] = other.tile.positions[target]
            if not is_coarser:
                continue
            wedge = _nearest(tile, int(ghost), other.tile, other.wedges(int(target)), self._has_given_normals)
            if tile.normals is not None and other.tile.normals is not None:
                tile.normals[same] = other.tile.normals[wedge]
            if tile.colours is not None and other.tile.colours is not None:
                tile.colours[same] = other.tile.colours[wedge]
            for name, values in tile.attributes.items():
                values[same] = other.tile.attributes[name][wedge]

    def _joined(self, nodes: list[Node], triangles: NDArray[np.int64], owners: NDArray[np.int64]) -> Mesh:
        parts = list(self._parts.values())
        manifest = self._manifest

        def join(values: Callable[[Tile], Any]) -> Optional[NDArray[Any]]:
            if any(values(part.tile) is None for part in parts):
                return None
            return np.concatenate([values(part.tile)[part.kept] for part in parts])

        relative = join(lambda tile: tile.positions)
        assert relative is not None
        positions = relative.astype(np.float64)
        for axis in np.flatnonzero(manifest.origin):  # -0 stays -0 where nothing is added
            positions[:, axis] += manifest.origin[axis]
        has_normals = manifest.attributes["normals"] or manifest.is_textured
        attributes = {name: join(lambda tile: tile.attributes[name]) for name in (scalar.name for scalar in manifest.scalars)}
        mesh = Mesh(
            positions=positions,
            triangles=triangles,
            normals=join(lambda tile: tile.normals) if has_normals else None,
            colours=join(lambda tile: tile.colours),
            texcoords=join(lambda tile: tile.texcoords),
            attributes={name: values for name, values in attributes.items() if values is not None},
            tiles=nodes,
            triangle_tiles=owners,
            images=[part.tile.image_bytes or b"" for part in parts] if manifest.is_textured else [],
        )
        if manifest.is_textured:
            return mesh.take(np.ones(len(triangles), bool))  # without the ghosts that nothing draws
        return mesh


def _nearest(tile: Tile, vertex: int, other: Tile, candidates: list[int], has_given_normals: bool) -> int:
    """The one that differs in the fewest values, then by the nearest normal, colour and, without pictures, texture coordinate."""
    if len(candidates) == 1:
        return candidates[0]

    def distance(mine: Optional[NDArray[Any]], others: Optional[NDArray[Any]], wedge: int) -> float:
        if mine is None or others is None:
            return 0.0
        return float(((mine[vertex].astype(np.float64) - others[wedge].astype(np.float64)) ** 2).sum())

    def differing(wedge: int) -> int:
        return sum(bool(values[vertex] != other.attributes[name][wedge]) for name, values in tile.attributes.items())

    texcoords = tile.texcoords if tile.image_bytes is None else None
    return min(
        candidates,
        key=lambda wedge: (
            differing(wedge),
            distance(tile.normals, other.normals, wedge) if has_given_normals else 0.0,
            distance(tile.colours, other.colours, wedge),
            distance(texcoords, other.texcoords, wedge),
        ),
    )
