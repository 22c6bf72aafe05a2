# SPDX-License-Identifier: MIT
"""A hierarchy in a cell of a notebook: a frame with the viewer and the coarse tiles within it, which goes on with the kernel's files where
the browser reaches the kernel."""

from __future__ import annotations

import base64
import gzip
import html
import json
import os
import re
from heapq import heappop, heappush
from typing import TYPE_CHECKING, Optional
from urllib.parse import urlsplit

from .asked import is_web_address, whole
from .errors import CorruptError, UsageError, replaced
from .kernel_files import kernel_address
from .tree import Node
from .viewer_files import viewer_file

if TYPE_CHECKING:
    from .hierarchy import Hierarchy

_INDEX_HEADER, _RECORD, _PAGE_RECORDS = 32, 120, 545  # docs/file_format.md, section 3; the viewer reads the index by such pages
_MOST_TOLD = 500
_POSTER_PART = 8  # of the room: a picture that is seen until scripts run may take no more


class Cell:
    """What a notebook shows. `html`: the frame's code, which needs nothing else."""

    def __init__(self, frame: str, told: str) -> None:
        self.html = frame
        self._told = told

    def _repr_html_(self) -> str:
        return self.html

    def __repr__(self) -> str:
        return f"Cell({self._told}; {len(self.html)} bytes)"


def _entry(name: str, data: bytes) -> str:
    packed = gzip.compress(data, 6, mtime=0)
    return f'"{name}":"{base64.b64encode(min(data, packed, key=len)).decode()}"'


class _Filling:
    """The entries of files that fit into a room of bytes: the root, then always the tiles below the one with the largest error."""

    def __init__(self, hierarchy: Hierarchy, room: int) -> None:
        self.hierarchy = hierarchy
        self.room = room
        self.tiles = 0
        self.error = 0.0
        self._entries = [_entry("hierarchy.json", hierarchy._files.read("hierarchy.json"))]
        self._index = hierarchy._read_sealed("tiles.bin", hierarchy._manifest.index_bytes, hierarchy._manifest.index_checksum)
        self._last_record = 0
        self.room -= len(self._entries[0])
        if hierarchy._is_replaced():
            raise replaced(hierarchy.path)

    def _index_bytes(self, record: int) -> int:
        return min(len(self._index), _INDEX_HEADER + (record // _PAGE_RECORDS + 1) * _PAGE_RECORDS * _RECORD)

    def _take(self, nodes: list[Node]) -> bool:
        """All of these tiles, or none."""
        last, entries = self._last_record, []
        for node in nodes:
            row = self.hierarchy._index.row(node)
            record = self.hierarchy._index.records[row]
            name = self.hierarchy._manifest.tile_name(node)
            entries.append(_entry(name, self.hierarchy._read_sealed(name, int(record["bytes"]), int(record["checksum"]))))
            last = max(last, row)
        taken = sum(len(entry) + 1 for entry in entries)
        if taken + self._index_bytes(last) * 4 // 3 + 100 > self.room:
            return False
        self._entries += entries
        self.room -= taken
        self.tiles += len(nodes)
        self._last_record = last
        return True

    def fill(self) -> bool:
        """False: not even the root fits."""
        tree = self.hierarchy.tree
        root = tree.tile(Node(0, 0))
        if not self._take([root]):
            return False
        coarse = [(-self.hierarchy.error(root), root)]
        while coarse:
            children = tree.children(coarse[0][1])
            if not self._take(children):
                break
            heappop(coarse)
            for node in children:
                if tree.children(node):
                    heappush(coarse, (-self.hierarchy.error(node), node))
        self.error = -coarse[0][0] if coarse else 0.0
        return True

    @property
    def is_whole(self) -> bool:
        return self.tiles == len(self.hierarchy._index)

    def files(self) -> str:
        return ",".join([*self._entries, _entry("tiles.bin", self._index[: self._index_bytes(self._last_record)])])


def _told(filling: _Filling, name: str) -> str:
    hierarchy = filling.hierarchy
    if filling.is_whole:
        return f"{name}: all of it, {hierarchy.triangles:,} triangles"
    return f"{name}: {filling.tiles} of {len(hierarchy._index)} tiles, within {filling.error:.3g} {hierarchy.units or 'of the original'}"


def _view_of(link: str) -> str:
    """What a link of the page says after its model; a link's part without one as it is."""
    if "#" not in link:
        return link
    return link.partition("#")[2].partition("&")[2]


def _poster(filling: _Filling, name: str) -> str:
    try:
        picture = base64.b64encode(filling.hierarchy._files.read("preview.webp")).decode()
    except CorruptError:
        return ""
    if len(picture) * _POSTER_PART > filling.room:
        return ""
    filling.room -= len(picture)
    return f'<img alt="{html.escape(name)}" src="data:image/webp;base64,{picture}">'


def _origin(link: str) -> str:
    """Whom the cell may ask, as a policy has it; a path is of the page around it."""
    parts = urlsplit(link)
    return f"{parts.scheme}://{parts.netloc}" if parts.netloc else "'self'" if link else ""


def _uses_ktx2(hierarchy: Hierarchy) -> bool:
    storage = hierarchy.manifest["storage"]
    return any((storage.get(kind) or {}).get("format") == "ktx2" for kind in ("texture", "normal_map"))


def _filled(values: dict[str, str]) -> str:
    with open(os.path.join(os.path.dirname(__file__), "cell.html"), encoding="utf-8") as file:
        page = re.sub(r"\{\{(\w+)\}\}", lambda match: values[match[1]], file.read())
    return page.replace("&", "&amp;").replace("'", "&#39;")


def _frame(page: str, height: int, is_path: bool) -> str:
    """Of a model that somebody else made no more than its picture comes out of the frame; a path of the notebook's host needs its cookies."""
    sandbox = "allow-scripts allow-same-origin" if is_path else "allow-scripts"
    return f"<iframe sandbox=\"{sandbox}\" style=\"width: 100%; height: {height}px; border: 0\" srcdoc='{page}'></iframe>"


def _texts(hierarchy: Hierarchy, name: str, view: str, address: str, whence: str) -> dict[str, str]:
    return {
        "name": html.escape(name),
        "json_name": json.dumps(name).replace("<", "\\u003c"),
        "view": html.escape(_view_of(view)),
        "link": html.escape(address),
        "asked": html.escape(address if address.endswith(".3tz") else f"{address.rstrip('/')}/hierarchy.json"),
        "origin": html.escape(_origin(address)),
        "reached": html.escape(f"; finer ones come from {whence}"),
        "left": "; finer ones are not in this notebook",
        "viewer": viewer_file("meshhier-viewer.js.gz"),
        "ktx2": viewer_file("meshhier-ktx2.js.gz") if _uses_ktx2(hierarchy) else "",
        "poster": "",
        "told": "",
        "files": "",
    }


def _address_of(hierarchy: Hierarchy) -> str:
    """Where a browser finds the hierarchy, without secrets: where it is on the web, or at the kernel."""
    return hierarchy.path if is_web_address(hierarchy.path) else kernel_address(hierarchy._place[0])


def make_cell(hierarchy: Hierarchy, *, height: int, view: str, link: Optional[str], size: int) -> Cell:
    """As Hierarchy.show() says."""
    height, size = whole(height, "height is a number of pixels"), whole(size, "size is a number of bytes")
    address = _address_of(hierarchy) if link is None else link
    if re.search(r"[\s;,'\"<>]", address):
        raise UsageError(f"no address: {address}")
    is_path = address != "" and not urlsplit(address).netloc
    whence = "the kernel" if link is None else "this host" if is_path else urlsplit(address).netloc
    name = os.path.splitext(os.path.basename(hierarchy.path.rstrip("/")))[0]
    texts = _texts(hierarchy, name, view, address, whence)
    frame = len(_frame(_filled(texts), height, is_path)) + _MOST_TOLD
    filling = _Filling(hierarchy, size - frame)
    texts["poster"] = _poster(filling, name)
    if not filling.fill():
        raise UsageError(f"{hierarchy.path}: a cell of {size} bytes has no room for the viewer and the root: give a larger size=; the viewer has {frame} bytes")
    texts["told"] = html.escape(_told(filling, name))
    if filling.is_whole:
        texts.update(link="", reached="", left="")
    texts["files"] = filling.files()
    return Cell(_frame(_filled(texts), height, is_path), texts["told"])
