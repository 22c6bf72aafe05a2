# SPDX-License-Identifier: MIT
"""A hierarchy in a cell of a notebook: a frame with the viewer and the coarse tiles within it, which goes on with the kernel's files where
the browser reaches the kernel."""

from __future__ import annotations

import base64
import html
import os
import re
from typing import TYPE_CHECKING, Optional
from urllib.parse import urlsplit

from .asked import is_web_address, whole
from .cell_tiles import CellTiles, held_by, tiles_that_fit
from .errors import CorruptError, UsageError
from .kernel_files import kernel_address
from .viewer_files import viewer_file

if TYPE_CHECKING:
    from .hierarchy import Hierarchy

_MOST_TOLD = 1000
_UNSEEN = "The model is not shown, as this notebook is not trusted, or shown by what runs no scripts: trust it, or run the cell."
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


def _view_of(link: str) -> str:
    """What a link of the page says after its model; a link's part without one as it is."""
    if "#" not in link:
        return link
    return link.partition("#")[2].partition("&")[2]


def _poster(hierarchy: Hierarchy, name: str, room: int) -> str:
    try:
        picture = base64.b64encode(hierarchy._files.read("preview.webp")).decode()
    except CorruptError:
        return ""
    return "" if len(picture) * _POSTER_PART > room else f'<img alt="{html.escape(name)}" src="data:image/webp;base64,{picture}">'


def _told(hierarchy: Hierarchy, tiles: CellTiles, name: str) -> str:
    if tiles.is_exact:
        return f"{name}: all of it, {hierarchy.triangles:,} triangles"
    count = len(hierarchy._index)
    which = f"all {count} tiles, rounded" if tiles.count == count else f"{tiles.count} of {count} tiles"
    return f"{name}: {which}, within {tiles.error:.3g} {hierarchy.units or 'of the original'}"


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


def _frame(page: str, height: int, is_path: bool, told: str) -> str:
    """Of a model that somebody else made no more than its picture comes out of the frame; a path of the notebook's host needs its cookies.
    Where notebooks are shown without what might run, only the words within the frame are left."""
    sandbox = "allow-scripts allow-same-origin" if is_path else "allow-scripts"
    style = f"width: 100%; height: {height}px; border: 0"
    return f"<iframe sandbox=\"{sandbox}\" style=\"{style}\" srcdoc='{page}'>{told}. {_UNSEEN}</iframe>"


def _texts(hierarchy: Hierarchy, name: str, view: str, address: str, whence: str) -> dict[str, str]:
    return {
        "name": html.escape(name),
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
        "hierarchy": held_by(name, {}),
    }


def _address_of(hierarchy: Hierarchy) -> str:
    """Where a browser finds the hierarchy, without secrets: where it is on the web, or at the kernel."""
    return hierarchy.path if is_web_address(hierarchy.path) else kernel_address(hierarchy._place[0])


def make_cell(hierarchy: Hierarchy, *, height: int, view: str, link: Optional[str], size: int) -> Cell:
    """As Hierarchy.show() says."""
    height, size = whole(height, "height is a number of pixels"), whole(size, "size is a number of bytes")
    if height < 1:
        raise UsageError(f"height is a number of pixels, 1 or more, not {height}")
    address = _address_of(hierarchy) if link is None else link
    if re.search(r"[\s;,'\"<>]", address):
        raise UsageError(f"no address: {address}; blanks, quotes, ; , < and > are written as %20 and so on, as urllib.parse.quote() does")
    if "@" in urlsplit(address).netloc:
        raise UsageError("link has a user or a password in it, which everybody would read in the notebook: give it without")
    is_path = address != "" and not urlsplit(address).netloc
    whence = "the kernel" if link is None else "this host" if is_path else urlsplit(address).netloc
    name = os.fsencode(os.path.splitext(os.path.basename(hierarchy.path.rstrip("/")))[0]).decode("utf-8", "replace")
    texts = _texts(hierarchy, name, view, address, whence)
    frame = len(_frame(_filled(texts), height, is_path, "")) + _MOST_TOLD
    texts["poster"] = _poster(hierarchy, name, size - frame)
    tiles = tiles_that_fit(hierarchy, name, size - frame - len(texts["poster"]))
    if tiles is None:
        raise UsageError(f"{hierarchy.path}: a cell of {size} bytes has no room for the viewer and the root: give a larger size=; the viewer has {frame} bytes")
    texts["told"], texts["hierarchy"] = html.escape(_told(hierarchy, tiles, name)), tiles.element
    if tiles.is_exact:
        texts.update(link="", reached="", left="")
    elif tiles.count == len(hierarchy._index):
        texts.update({key: texts[key].replace("finer", "exact", 1) for key in ("reached", "left")})
    return Cell(_frame(_filled(texts), height, is_path, texts["told"]), texts["told"])
