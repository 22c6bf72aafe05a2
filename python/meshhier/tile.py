# SPDX-License-Identifier: MIT
"""Tiles as arrays (docs/file_format.md, section 4)."""

from __future__ import annotations

import io
import json
import struct
import zlib
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Optional

import numpy as np
from numpy.typing import NDArray

from . import meshopt
from .content import ByContent
from .errors import MISREAD, CorruptError, Error, misread
from .tree import Node

if TYPE_CHECKING:
    from .manifest import Manifest

_NO_VALUE = np.float32(-3.4028234663852886e38)
_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_NUMPY = {"i8": "<i1", "u8": "<u1", "i16": "<i2", "u16": "<u2", "i32": "<i4", "u32": "<u4", "f32": "<f4", "f64": "<f8"}
_MOST_BYTES = 1 << 30  # of a tile
_WIDE = ("i32", "u32", "f64")


@dataclass(eq=False)
class Tile(ByContent):
    """One tile. Vertices 0 ... own - 1 are its own; behind them come its ghosts (own vertices of neighbours), then copies
    (further vertices at places of these, with other attributes), then splits (the same with other computed normals or texture
    coordinates). n counts all of them.

    Attributes:
        node: level and index.
        own, ghosts, copies, splits: how many vertices of each kind.
        positions: (n, 3) float32, relative to the hierarchy's origin.
        normals: (n, 3) float32 or None: the input's, or computed ones.
        colours: (n, 3 or 4) or None: as the input has them: uint8, uint16, or float32 from 0 to 1.
        texcoords: (n, 2) float32 or None: in the tile's picture, (0, 0) is its upper left corner; or the input's.
        attributes: name -> (n,) of the input's type; NaN where a float has no value.
        interior: (t, 3) int64, triangles of own vertices.
        border: (s, 3) int64, triangles with ghosts; neighbours have them too.
        copy_of: (copies,) int64, the vertex (own or ghost) where each copy lies, ascending.
        split_of: (splits,) int64, the vertex (of any kind before) that each split repeats.
        parent_map: (own,) int64, the vertex of the parent's tile that stands for each; empty of the root.
        neighbours: (m,) int64, indices of the tiles of this level that have ghosts here.
        ghost_starts: (m + 1,) int64: ghosts [ghost_starts[i], ghost_starts[i + 1]) are of neighbours[i].
        chains: one array for each neighbour, (ghosts of it, levels) int64: the vertex in that tile, in its parent, and so on.
        image_bytes: the picture's file (JPEG, PNG, WebP or KTX2), or None.
        alpha_mode: of the picture: "OPAQUE", "MASK" (it has holes) or "BLEND".
    """

    node: Node
    own: int
    ghosts: int
    copies: int
    splits: int
    positions: NDArray[np.float32]
    normals: Optional[NDArray[np.float32]]
    colours: Optional[NDArray[Any]]
    texcoords: Optional[NDArray[np.float32]]
    attributes: dict[str, NDArray[Any]]
    interior: NDArray[np.int64]
    border: NDArray[np.int64]
    copy_of: NDArray[np.int64]
    split_of: NDArray[np.int64]
    parent_map: NDArray[np.int64]
    neighbours: NDArray[np.int64]
    ghost_starts: NDArray[np.int64]
    chains: list[NDArray[np.int64]] = field(repr=False)
    image_bytes: Optional[bytes] = field(repr=False)
    alpha_mode: str = "OPAQUE"

    @property
    def triangles(self) -> NDArray[np.int64]:
        """(t + s, 3): all triangles, the border's last. Together with all vertices, this shows the tile alone."""
        return np.concatenate([self.interior, self.border])

    def image(self) -> NDArray[np.uint8]:
        """The picture as (height, width, 3 or 4) uint8. Needs Pillow. Raises Error if there is none."""
        if self.image_bytes is None:
            raise Error(f"tile {self.node} has no picture")
        return decode_image(self.image_bytes)

    def places(self) -> NDArray[np.int64]:
        """(n,): the own vertex or ghost at whose place each vertex lies."""
        first = np.arange(self.own + self.ghosts)
        unsplit = np.concatenate([first, self.copy_of])
        return np.concatenate([unsplit, unsplit[self.split_of]])


def decode_image(data: bytes) -> NDArray[np.uint8]:
    """A JPEG, PNG or WebP as (height, width, 3 or 4) uint8. Needs Pillow."""
    if data[:7] == b"\xabKTX 20":
        raise Error("the picture is KTX2, which Pillow does not read: meshhier export NAME.obj writes it as PNG")
    try:
        from PIL import Image
    except ImportError as error:
        raise Error("pictures need Pillow: pip install pillow, or Debian's python3-pil") from error
    with Image.open(io.BytesIO(data)) as image:
        return np.asarray(image if image.mode in ("RGB", "RGBA") else image.convert("RGBA"))


class _Glb:
    """The parts of a glTF binary."""

    def __init__(self, data: bytes, name: str) -> None:
        self.name = name
        if data[:2] == b"\x1f\x8b":
            unpacking = zlib.decompressobj(wbits=31)
            try:
                data = unpacking.decompress(data, _MOST_BYTES)
            except zlib.error as error:
                raise CorruptError(f"{name}: {error}") from error
            if not unpacking.eof:
                raise CorruptError(f"{name}: it is cut off, or has more than {_MOST_BYTES} bytes")
        try:
            magic, version, length, json_bytes, kind = struct.unpack_from("<4sIII4s", data)
            if magic != b"glTF" or version != 2 or length != len(data) or kind != b"JSON":
                raise CorruptError(f"{name}: not a glTF binary")
            self.json: dict[str, Any] = json.loads(data[20 : 20 + json_bytes])
            bin_bytes, kind = struct.unpack_from("<I4s", data, 20 + json_bytes)
            if kind != b"BIN\0":
                raise CorruptError(f"{name}: not a glTF binary")
        except struct.error as error:
            raise CorruptError(f"{name}: {error}") from error
        self.bin = data[28 + json_bytes : 28 + json_bytes + bin_bytes]

    def view(self, number: int) -> tuple[bytes, int]:
        """The bytes of a buffer view, and its stride, 0 if it says none."""
        view = self.json["bufferViews"][number]
        packed = view.get("extensions", {}).get("EXT_meshopt_compression")
        if packed is None:
            first = view.get("byteOffset", 0)
            data = self.bin[first : first + view["byteLength"]]
            if len(data) != view["byteLength"]:
                raise CorruptError(f"{self.name}: it is cut off")
            return data, view.get("byteStride", 0)
        first = packed.get("byteOffset", 0)
        stride = packed["byteStride"]
        data = meshopt.decode(
            self.bin[first : first + packed["byteLength"]], packed["mode"], packed.get("filter", ""), packed["count"], stride
        )
        return data, view.get("byteStride", stride)


_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class _Reader:
    def __init__(self, data: bytes, node: Node, manifest: Manifest) -> None:
        self.glb = _Glb(data, manifest.tile_name(node))
        self.node = node
        self.manifest = manifest
        self.tile = self.glb.json["extensions"]["MESHHIER_tile"]
        self.own, self.ghosts, self.copies = (self.tile[key] for key in ("ownCount", "ghostCount", "copyCount"))
        self.splits = self.tile.get("splitCount", 0)
        self.unsplit = self.own + self.ghosts + self.copies
        self.count = self.unsplit + self.splits
        primitives = self.glb.json["meshes"][0]["primitives"]
        self.accessors: dict[str, int] = primitives[0]["attributes"]

    def fail(self, what: str) -> None:
        raise CorruptError(f"{self.glb.name}: {what}")

    def accessor(self, number: int) -> NDArray[Any]:
        accessor = self.glb.json["accessors"][number]
        data, stride = self.glb.view(accessor["bufferView"])
        kind = np.dtype(_TYPES[accessor["componentType"]])
        width = _WIDTHS[accessor["type"]]
        return np.ndarray(
            (accessor["count"], width), kind, data, accessor.get("byteOffset", 0), (stride or width * kind.itemsize, kind.itemsize)
        )

    def section(self, name: str, kind: str, count: int) -> NDArray[Any]:
        """A section that is no accessor; empty if it is not there."""
        number = self.tile.get(name, -1)
        if number < 0:
            return np.zeros(0, kind)
        data, _ = self.glb.view(number)
        if len(data) < np.dtype(kind).itemsize * count:
            self.fail(f"{name} is too short")
        return np.frombuffer(data, kind, count)

    def indices(self, name: str, count: int, below: int, narrow: bool) -> NDArray[np.int64]:
        values = self.section(name, "<u2" if narrow else "<u4", count).astype(np.int64)
        if len(values) > 0 and values.max() >= below:
            self.fail(f"{name} has a number that is too large")
        return values

    def triangles(self, kind: str) -> NDArray[np.int64]:
        """Of the primitive "interior" or "border"."""
        number = self.tile[kind + "Primitive"]
        if number < 0:
            return np.zeros((0, 3), np.int64)
        corners = self.accessor(self.glb.json["meshes"][0]["primitives"][number]["indices"])[:, 0].astype(np.int64)
        if len(corners) != 3 * self.tile[kind + "Count"] or (len(corners) > 0 and corners.max() >= self.count):
            self.fail(f"its {kind} triangles are not what it says")
        return corners.reshape(-1, 3)

    def positions(self) -> NDArray[np.float32]:
        positions = self.accessor(self.accessors["POSITION"])
        if positions.dtype != np.float32:
            lattice = self.manifest.lattice
            if lattice is None:
                self.fail("positions are integers, but the manifest has no lattice")
            return (positions * lattice.step + lattice.corner).astype(np.float32)  # type: ignore[union-attr]
        return positions.copy()

    def spread(self, raw: NDArray[Any]) -> NDArray[Any]:
        """What is of vertices alone: splits have that of theirs."""
        return np.concatenate([raw, raw[self.split_of()]])

    def split_of(self) -> NDArray[np.int64]:
        return self.indices("splitOf", self.splits, self.unsplit, self.unsplit <= 65535)

    def normals(self) -> Optional[NDArray[np.float32]]:
        if self.tile.get("rawNormals", -1) >= 0:
            return self.spread(self.section("rawNormals", "<f4", 3 * self.unsplit).reshape(-1, 3))
        if "NORMAL" not in self.accessors:
            return None
        normals = self.accessor(self.accessors["NORMAL"])
        return normals.astype(np.float32) / (127 if normals.dtype == np.int8 else 1)

    def colours(self) -> Optional[NDArray[Any]]:
        attributes = self.manifest.attributes
        kind = attributes["colours"]
        if kind == "none":
            return None
        width = 4 if attributes["alpha"] else 3
        most = {"u8": 255, "u16": 65535, "f32": 1}[kind]
        if self.tile.get("rawColours", -1) >= 0:
            raw = self.spread(self.section("rawColours", "<f4", width * self.unsplit).reshape(-1, width))
            return raw.astype(_NUMPY[kind])
        name = "COLOR_0" if "COLOR_0" in self.accessors else "_COLOR_0"
        stored = self.accessor(self.accessors[name])
        is_screen = not attributes.get("linear_colours", False) and self.tile["version"] > 3
        if stored.dtype == np.dtype(_NUMPY[kind]) and not is_screen:
            return stored.copy()
        scale = 1 if stored.dtype == np.float32 else np.iinfo(stored.dtype).max
        light = stored.astype(np.float64) / scale
        if is_screen:
            low = light <= 0.0031308
            light[:, :3] = np.where(low, 12.92 * light, 1.055 * np.maximum(light, 0) ** (1 / 2.4) - 0.055)[:, :3]
        return np.rint(light * most).astype(_NUMPY[kind]) if kind != "f32" else light.astype(np.float32)

    def texcoords(self) -> Optional[NDArray[np.float32]]:
        if self.tile.get("rawTexcoords", -1) >= 0:
            return self.spread(self.section("rawTexcoords", "<f4", 2 * self.unsplit).reshape(-1, 2))
        has_map_alone = self.tile.get("normalMapWidth", 0) > 0 and self.tile.get("imageWidth", 0) == 0
        is_of_normal_map = has_map_alone and "TEXCOORD_1" not in self.accessors
        if is_of_normal_map or "TEXCOORD_0" not in self.accessors:
            return None
        return self.accessor(self.accessors["TEXCOORD_0"]).copy()

    def values(self) -> dict[str, NDArray[Any]]:
        scalars = self.manifest.scalars
        if not scalars:
            return {}
        if self.tile.get("rawValues", -1) >= 0:
            row = np.dtype([(s.name, "<f8" if s.type in _WIDE else "<f4") for s in scalars])
            rows = self.section("rawValues", "u1", row.itemsize * self.unsplit).view(row)
            return {s.name: self.spread(rows[s.name]).astype(_NUMPY[s.type]) for s in scalars}
        section = self.tile["values"]
        found = [i for i, accessor in enumerate(self.glb.json["accessors"]) if accessor.get("bufferView") == section]
        if len(found) != len(scalars):
            self.fail("it has other values than the manifest says")
        return {s.name: self.value(number, s.type) for s, number in zip(scalars, found)}

    def value(self, number: int, kind: str) -> NDArray[Any]:
        stored = self.accessor(number)[:, 0]
        if kind in ("f32", "f64"):
            return np.where(stored == _NO_VALUE, np.nan, stored).astype(_NUMPY[kind])
        return stored.astype(_NUMPY[kind])

    def chains(self, neighbours: NDArray[np.int64], starts: NDArray[np.int64]) -> list[NDArray[np.int64]]:
        tree = self.manifest.tree
        levels = [self.node.level - tree.common_level(self.node, Node(self.node.level, int(i))) for i in neighbours]
        entries = self.indices("ghostChains", self.tile["chainEntryCount"], 32768, True)
        found, at = [], 0
        for i, count in enumerate(levels):
            end = at + count * int(starts[i + 1] - starts[i])
            found.append(entries[at:end].reshape(-1, count))
            at = end
        if at != len(entries):
            self.fail("its chains are not all there")
        return found

    def read(self) -> Tile:
        tree = self.manifest.tree
        nodes = tree.partitions if self.node.level == tree.depth else 2**self.node.level
        neighbours = self.indices("neighbours", self.tile["neighbourCount"], nodes, False)
        starts = self.indices("ghostStarts", len(neighbours) + 1, self.ghosts + 1, False) if len(neighbours) else np.zeros(1, np.int64)
        image = self.tile.get("image", -1)
        return Tile(
            node=self.node,
            own=self.own,
            ghosts=self.ghosts,
            copies=self.copies,
            splits=self.splits,
            positions=self.positions(),
            normals=self.normals(),
            colours=self.colours(),
            texcoords=self.texcoords(),
            attributes=self.values(),
            interior=self.triangles("interior"),
            border=self.triangles("border"),
            copy_of=self.indices("copyOf", self.copies, self.own + self.ghosts, self.own + self.ghosts <= 65535),
            split_of=self.split_of(),
            parent_map=self.indices("parentMap", self.own if self.node.level > 0 else 0, 32768, True),
            neighbours=neighbours,
            ghost_starts=starts,
            chains=self.chains(neighbours, starts),
            image_bytes=self.glb.view(image)[0] if image >= 0 else None,
            alpha_mode=str(self.glb.json["materials"][0].get("alphaMode", "OPAQUE")),
        )


def read_tile(data: bytes, node: Node, manifest: Manifest) -> Tile:
    """Decodes the file of a tile. Raises CorruptError."""
    try:
        return _Reader(data, node, manifest).read()
    except MISREAD as error:
        raise misread(manifest.tile_name(node), error) from error
