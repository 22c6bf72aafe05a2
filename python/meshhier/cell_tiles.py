# SPDX-License-Identifier: MIT
"""The tiles of a hierarchy that a cell of a notebook holds: packed by the program, and rounded where more is seen that way; without the
program as they are stored."""

from __future__ import annotations

import base64
import gzip
import json
import os
import tempfile
from dataclasses import dataclass
from heapq import heappop, heappush
from typing import TYPE_CHECKING, Any, Mapping, Optional

from .asked import is_web_address
from .errors import ProgramError, ProgramNotFoundError, UsageError, replaced
from .options import Files, option_words, path_word
from .process import run_program
from .tree import Node

if TYPE_CHECKING:
    from .hierarchy import Hierarchy

_INDEX_HEADER, _RECORD, _PAGE_RECORDS = 32, 120, 545  # docs/file_format.md, section 3; the viewer reads the index by such pages
_INDEX_ENTRY = 50  # besides its bytes
_MARK = "<!-- meshhier: hierarchy -->"  # which the program replaces


@dataclass(frozen=True)
class CellTiles:
    """What a cell holds of a hierarchy.

    Attributes:
        element: for the page.
        count: of tiles.
        error: how far they are from the original at the most, input units.
        is_exact: they are all, and nothing is rounded.
    """

    element: str
    count: int
    error: float
    is_exact: bool


def held_by(name: str, files: Mapping[str, str]) -> str:
    """The element of a page that holds these files, in base64."""
    held = json.dumps({"name": name, "files": files}, separators=(",", ":")).replace("<", "\\u003c")
    return f'<script type="application/json" id="meshhier-hierarchy">{held}</script>'


def tiles_that_fit(hierarchy: Hierarchy, name: str, room: int) -> Optional[CellTiles]:
    """None: not even the root does. Raises CorruptError, ReplacedError."""
    if room <= 0:
        return None
    return _packed(hierarchy, name, room) or _stored(hierarchy, name, room)


def _packed(hierarchy: Hierarchy, name: str, room: int) -> Optional[CellTiles]:
    """None where the program is not there, or cannot do it; why is told by reading without it."""
    with tempfile.TemporaryDirectory(prefix="meshhier-cell-") as folder:
        for file in ("index.html", "single.html"):  # a viewer that is nothing but the place of the hierarchy
            with open(os.path.join(folder, file), "w") as stream:
                stream.write(_MARK)
        try:
            made = _page(hierarchy, folder, room)
        except (ProgramError, ProgramNotFoundError, UsageError):
            return None
    if hierarchy._is_replaced():
        raise replaced(hierarchy.path)
    files = json.loads(made[made.index("{") : made.rindex("}") + 1])["files"]
    rounding = _rounding(_unpacked(files["hierarchy.json"])) - _rounding(hierarchy.manifest)
    return _cell_tiles(hierarchy, name, files, rounding)


def _page(hierarchy: Hierarchy, viewer: str, size: int) -> str:
    place, headers, _ = hierarchy._place
    with Files() as files:
        known = option_words("page", {"size": size, "viewer": viewer, "headers": headers}, files)
        return run_program(["page", path_word(_other_name(place, viewer)), "--output=-", *known], prints_data=True).text


def _other_name(place: str, folder: str) -> str:
    """A name of a hierarchy beside which no story lies: a cell tells none, and has no room for the pictures."""
    if is_web_address(place):
        return place
    link = os.path.join(folder, "model" + os.path.splitext(place)[1])
    os.symlink(place, link)
    return link


def _cell_tiles(hierarchy: Hierarchy, name: str, files: Mapping[str, str], rounding: float) -> CellTiles:
    tiles = [_node_of(file) for file in files if file.startswith("tiles/")]
    is_exact = len(tiles) == len(hierarchy._index) and rounding == 0
    return CellTiles(held_by(name, files), len(tiles), _error(hierarchy, tiles) + rounding, is_exact)


def _node_of(file: str) -> Node:
    """The node of "tiles/02/000003.glb"."""
    parts = file.split("/")
    return Node(int(parts[1]), int(parts[-1].partition(".")[0]))


def _error(hierarchy: Hierarchy, tiles: list[Node]) -> float:
    """That of the cut that they make: the largest of those below which there are none."""
    are_there = set(tiles)
    return max((hierarchy.error(node) for node in tiles if not are_there.issuperset(hierarchy.tree.children(node))), default=0.0)


def _rounding(manifest: Any) -> float:
    return float((manifest["storage"]["positions"] or {}).get("worst_rounding", 0))


def _entry(data: bytes) -> str:
    packed = gzip.compress(data, 6, mtime=0)
    return base64.b64encode(min(data, packed, key=len)).decode()


def _unpacked(entry: str) -> Any:
    data = base64.b64decode(entry)
    return json.loads(gzip.decompress(data) if data[:2] == b"\x1f\x8b" else data)


def _stored(hierarchy: Hierarchy, name: str, room: int) -> Optional[CellTiles]:
    filling = _Filling(hierarchy, room)
    if not filling.fill():
        return None
    return _cell_tiles(hierarchy, name, filling.files(), 0.0)


class _Filling:
    """Files as they are stored that fit into a room of bytes: the root, then always the tiles below the one with the largest error."""

    def __init__(self, hierarchy: Hierarchy, room: int) -> None:
        self._hierarchy = hierarchy
        self._entries = {"hierarchy.json": _entry(hierarchy._files.read("hierarchy.json"))}
        self._index = hierarchy._read_sealed("tiles.bin", hierarchy._manifest.index_bytes, hierarchy._manifest.index_checksum)
        self._last_record = 0
        self._room = room - len(held_by("", self._entries)) - _INDEX_ENTRY
        if hierarchy._is_replaced():
            raise replaced(hierarchy.path)

    def _index_bytes(self, record: int) -> int:
        return min(len(self._index), _INDEX_HEADER + (record // _PAGE_RECORDS + 1) * _PAGE_RECORDS * _RECORD)

    def _take(self, nodes: list[Node]) -> bool:
        """All of these tiles, or none."""
        last, entries = self._last_record, {}
        for node in nodes:
            row = self._hierarchy._index.row(node)
            record = self._hierarchy._index.records[row]
            name = self._hierarchy._manifest.tile_name(node)
            entries[name] = _entry(self._hierarchy._read_sealed(name, int(record["bytes"]), int(record["checksum"])))
            last = max(last, row)
        taken = sum(len(name) + len(entry) + len('"":"",') for name, entry in entries.items())
        if taken + self._index_bytes(last) * 4 // 3 > self._room:
            return False
        self._entries.update(entries)
        self._room -= taken
        self._last_record = last
        return True

    def fill(self) -> bool:
        """False: not even the root fits."""
        tree = self._hierarchy.tree
        root = tree.tile(Node(0, 0))
        if not self._take([root]):
            return False
        coarse = [(-self._hierarchy.error(root), root)]
        while coarse and self._take(tree.children(coarse[0][1])):
            for node in tree.children(heappop(coarse)[1]):
                if tree.children(node):
                    heappush(coarse, (-self._hierarchy.error(node), node))
        return True

    def files(self) -> dict[str, str]:
        return {**self._entries, "tiles.bin": _entry(self._index[: self._index_bytes(self._last_record)])}
