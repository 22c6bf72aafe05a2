# SPDX-License-Identifier: MIT
"""Meshes as glTF binaries. What glTF has no number for is brought to the nearest that it has, as in tiles (docs/file_format.md, sections
4.7, 4.10 and 4.11)."""

from __future__ import annotations

import json
import re
import struct
from typing import TYPE_CHECKING, Any, Optional

import numpy as np
from numpy.typing import NDArray

from .errors import UsageError

if TYPE_CHECKING:
    from .mesh import Mesh

_Array = NDArray[Any]

_COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
_SHAPES = ("SCALAR", "VEC2", "VEC3", "VEC4")
_VERTICES, _INDICES = 34962, 34963
_NO_VALUE = np.float32(-3.4028234663852886e38)
_MOST_SHORT = 65535  # vertices that 16 bits number: the last number begins a new strip
_MOST_BYTES = 2**32 - 1
_UNIT = 0.001  # by which the length of a normal may differ from 1
_Z_UP = [1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0]  # three columns: x, y, z becomes x, z, -y
_SAMPLER = {"magFilter": 9729, "minFilter": 9987, "wrapS": 33071, "wrapT": 33071}
# The first bytes of a picture, its type, and what an extension of glTF allows it.
_PICTURES = (
    (b"\xff\xd8", "image/jpeg", None),
    (b"\x89PNG", "image/png", None),
    (b"RIFF", "image/webp", "EXT_texture_webp"),
    (b"\xabKTX", "image/ktx2", "KHR_texture_basisu"),
)


class _Glb:
    """A file in the making: its JSON, and its bytes one buffer view behind the other."""

    def __init__(self) -> None:
        self.json: dict[str, list[Any]] = {name: [] for name in ("accessors", "bufferViews", "images", "textures", "materials")}
        self.extensions: set[str] = set()
        self.required: set[str] = set()
        self._chunks: list[bytes] = []
        self._size = 0

    def view(self, data: bytes, **facts: int) -> int:
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": self._size, "byteLength": len(data), **facts})
        padded = data + bytes(-len(data) % 4)
        self._chunks.append(padded)
        self._size += len(padded)
        return len(self.json["bufferViews"]) - 1

    def vertices(self, values: _Array, *, normalized: bool = False, with_range: bool = False) -> int:
        """An accessor of (n, w) numbers, each row at a multiple of 4 bytes."""
        width = values.shape[1] * values.itemsize
        stride = -(-width // 4) * 4
        rows = np.zeros((len(values), stride), np.uint8)
        rows[:, :width] = np.ascontiguousarray(values).view(np.uint8).reshape(len(values), width)
        facts: dict[str, Any] = {"normalized": True} if normalized else {}
        if with_range:
            facts |= {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}
        return self._accessor(self.view(rows.tobytes(), byteStride=stride, target=_VERTICES), values, **facts)

    def indices(self, triangles: _Array, vertices: int) -> int:
        corners = triangles.reshape(-1, 1).astype("<u2" if vertices <= _MOST_SHORT else "<u4")
        return self._accessor(self.view(corners.tobytes(), target=_INDICES), corners)

    def _accessor(self, view: int, values: _Array, **facts: Any) -> int:
        kind = {"componentType": _COMPONENTS[values.dtype.str[1:]], "type": _SHAPES[values.shape[1] - 1]}
        self.json["accessors"].append({"bufferView": view, "count": len(values), **kind, **facts})
        return len(self.json["accessors"]) - 1

    def material(self, image: bytes, alpha_mode: str, unlit: bool) -> int:
        look: dict[str, Any] = {"metallicFactor": 0, "roughnessFactor": 1}
        material: dict[str, Any] = {"pbrMetallicRoughness": look, "doubleSided": True}
        if image:
            look["baseColorTexture"] = {"index": self._texture(image)}
            if alpha_mode != "OPAQUE":
                material["alphaMode"] = alpha_mode
            if unlit:
                material["extensions"] = {"KHR_materials_unlit": {}}
                self.extensions.add("KHR_materials_unlit")
        self.json["materials"].append(material)
        return len(self.json["materials"]) - 1

    def _texture(self, image: bytes) -> int:
        media_type, extension = next(((kind, needs) for start, kind, needs in _PICTURES if image.startswith(start)), (None, None))
        if media_type is None:
            raise UsageError("a picture is neither JPEG, PNG, WebP nor KTX2")
        source = {"source": len(self.json["images"])}
        self.json["images"].append({"bufferView": self.view(image), "mimeType": media_type})
        self.json["textures"].append({"sampler": 0, **({"extensions": {extension: source}} if extension else source)})
        self.required |= {extension} if extension else set()
        return len(self.json["textures"]) - 1

    def whole(self, head: dict[str, Any]) -> bytes:
        facts = head | {name: values for name, values in self.json.items() if values}
        if self.json["textures"]:
            facts["samplers"] = [_SAMPLER]
        if self.extensions | self.required:
            facts["extensionsUsed"] = sorted(self.extensions | self.required)
        if self.required:
            facts["extensionsRequired"] = sorted(self.required)
        if self._size:
            facts["buffers"] = [{"byteLength": self._size}]
        text = json.dumps(facts, separators=(",", ":"), allow_nan=False).encode("ascii")
        text += b" " * (-len(text) % 4)
        whole = 20 + len(text) + (8 + self._size if self._size else 0)
        if whole > _MOST_BYTES:
            raise UsageError(f"a glTF binary has at most {_MOST_BYTES} bytes, this mesh would have {whole}: take pieces, iter_parts()")
        chunks = [struct.pack("<4sIII4s", b"glTF", 2, whole, len(text), b"JSON"), text]
        if self._size:
            chunks += [struct.pack("<I4s", self._size, b"BIN\0"), *self._chunks]
        return b"".join(chunks)


def glb_of(mesh: Mesh) -> bytes:
    """The mesh as `Mesh.to_gltf()` describes it."""
    glb = _Glb()
    head: dict[str, Any] = {"asset": {"version": "2.0", "generator": "meshhier"}, "scene": 0, "scenes": [{}]}
    if len(mesh.positions) == 0:
        return glb.whole(head)
    if not np.isfinite(mesh.positions).all():
        raise UsageError("a position is not finite")
    offset = _offset_of(mesh.positions)
    primitives = [_primitive(glb, mesh, part, offset) for part in _parts_of(mesh)]
    head["scenes"] = [{"nodes": [0]}]
    head["nodes"] = [{"mesh": 0, **_placed(offset, mesh.conventions.up)}]
    head["meshes"] = [{"primitives": primitives}]
    return glb.whole(head)


def _offset_of(positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """What the node adds to positions: nothing where floats have them exactly, else their middle."""
    is_exact = (positions.astype(np.float32) == positions).all(axis=0)
    return np.where(is_exact, 0.0, (positions.min(axis=0) + positions.max(axis=0)) / 2)


def _placed(offset: NDArray[np.float64], up: str) -> dict[str, Any]:
    x, y, z = offset.tolist()
    if up == "z":
        return {"matrix": [*_Z_UP, x, z, -y, 1]}
    return {"translation": [x, y, z]} if offset.any() else {}


def _parts_of(mesh: Mesh) -> list[Optional[int]]:
    """The tiles that have a primitive of their own, as each has a picture; None: all in one."""
    return [int(tile) for tile in np.unique(mesh.triangle_tiles)] if any(mesh.images) else [None]


def _primitive(glb: _Glb, mesh: Mesh, tile: Optional[int], offset: NDArray[np.float64]) -> dict[str, Any]:
    triangles, vertices = mesh.triangles, np.arange(len(mesh.positions))
    image, alpha_mode = b"", "OPAQUE"
    if tile is not None:
        vertices, numbers = np.unique(triangles[mesh.triangle_tiles == tile], return_inverse=True)
        triangles, image = numbers.reshape(-1, 3), mesh.images[tile]
        alpha_mode = mesh.alpha_modes[tile] if tile < len(mesh.alpha_modes) else alpha_mode
    attributes = {"POSITION": glb.vertices((mesh.positions[vertices] - offset).astype("<f4"), with_range=True)}
    if mesh.normals is not None:
        attributes["NORMAL"] = glb.vertices(_unit(mesh.normals[vertices]))
    if mesh.colours is not None:
        colours = _light(mesh.colours[vertices], mesh.conventions.linear_colours)
        name = "_COLOR_0" if image and not mesh.conventions.tints else "COLOR_0"
        attributes[name] = glb.vertices(colours, normalized=colours.dtype.kind == "u")
    if mesh.texcoords is not None:
        attributes["TEXCOORD_0"] = glb.vertices(np.nan_to_num(mesh.texcoords[vertices], nan=0, posinf=0, neginf=0).astype("<f4"))
    for name, values in mesh.attributes.items():
        attributes[_name_of(name, attributes)] = glb.vertices(_storable(values[vertices])[:, None])
    primitive: dict[str, Any] = {"attributes": attributes, "material": glb.material(image, alpha_mode, mesh.conventions.unlit)}
    if len(triangles) == 0:
        return primitive | {"mode": 0}
    return primitive | {"indices": glb.indices(triangles, len(vertices))}


def _unit(normals: NDArray[np.float32]) -> _Array:
    """Normals of length 1: (0, 0, 1) of those that have no direction."""
    wide = np.where(np.isfinite(normals).all(axis=1, keepdims=True), normals.astype(np.float64), 0)
    lengths = np.linalg.norm(wide, axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        unit = np.where(lengths > 0, wide / lengths, [0.0, 0.0, 1.0])
    return np.where(np.abs(lengths - 1) <= _UNIT, wide, unit).astype("<f4")


def _light(colours: _Array, is_linear: bool) -> _Array:
    """Colours as glTF has them, light: of a screen's bytes 16 bits, of a screen's other numbers floats."""
    if colours.dtype.kind == "f":
        colours = np.clip(np.nan_to_num(colours, nan=0), 0, 1)
    if is_linear:
        return colours.astype(colours.dtype.newbyteorder("<"))
    most = 1.0 if colours.dtype.kind == "f" else float(np.iinfo(colours.dtype).max)
    light = colours.astype(np.float64) / most
    screen = light[:, :3]
    light[:, :3] = np.where(screen <= 0.04045, screen / 12.92, ((screen + 0.055) / 1.055) ** 2.4)
    return np.rint(light * 65535).astype("<u2") if colours.dtype == np.uint8 else light.astype("<f4")


def _name_of(name: str, taken: dict[str, int]) -> str:
    """The name of an attribute: in capitals, behind an underscore."""
    base = "_" + re.sub(r"[^A-Z0-9]", "_", name.upper()).lstrip("_")
    names = (base if number == 1 else f"{base}_{number}" for number in range(1, len(taken) + 3))
    return next(each for each in names if each not in taken and each != "_COLOR_0")


def _storable(values: _Array) -> _Array:
    """Numbers of a type that attributes of glTF may have: of wide ones the nearest float, of what is not finite the least one."""
    if values.dtype.kind in "iu" and values.itemsize <= 2:
        return values.astype(values.dtype.newbyteorder("<"))
    wide = values.astype(np.float64)
    return np.where(np.isfinite(wide), np.clip(wide, -np.finfo(np.float32).max, np.finfo(np.float32).max), _NO_VALUE).astype("<f4")
