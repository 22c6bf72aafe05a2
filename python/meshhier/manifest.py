# SPDX-License-Identifier: MIT
"""What a hierarchy says of itself (docs/file_format.md, section 2)."""

from __future__ import annotations

import json
import operator
from dataclasses import dataclass, field
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from .checksum import checksum
from .errors import MISREAD, CorruptError, NotAHierarchyError, misread
from .mesh import Conventions
from .tree import Node, Tree

_VERSIONS = range(7, 15)
_BEFORE_SEAL, _AFTER_SEAL = b',\n  "checksum": "', b'"\n}\n'
_DIGITS = 16


@dataclass(frozen=True)
class Scalar:
    """A number that vertices have besides normal, colour and texture coordinates.

    Attributes:
        name: the input's.
        type: "i8", "u8", "i16", "u16", "i32", "u32", "f32" or "f64".
        kind: "quantity", of which simplified tiles have means, "label", or "object": a label that is the same at all corners of a triangle.
        min, max: of all vertices of the input that have a value.
        labels: number -> name ("" if the input has none); of labels, if there are at most 256.
    """

    name: str
    type: str
    kind: str
    min: float
    max: float
    labels: dict[int, str]


@dataclass(frozen=True)
class Lattice:
    """Where quantized positions lie: corner + step * n, relative to the origin."""

    corner: NDArray[np.float64]
    step: float


@dataclass(frozen=True)
class Manifest:
    """Attributes:
    json: all of it, as the file has it.
    vertices, triangles: of the input.
    bounds: (2, 3): the least and the greatest coordinates of the input.
    origin: (3,) float64, to be added to positions of tiles for input coordinates.
    tree: of its partitions.
    attributes: "normals", "alpha", "texcoords", "colours", ...: what the input has.
    scalars: its further numbers, in the order of tiles.
    lattice: of quantized positions, or None.
    is_textured: tiles have pictures.
    conventions: how colours, pictures and axes are meant.
    index_bytes, index_checksum: of tiles.bin.
    build: the name of the build: the manifest's own checksum, which covers all others.
    """

    json: dict[str, Any] = field(repr=False)
    vertices: int
    triangles: int
    bounds: NDArray[np.float64]
    origin: NDArray[np.float64]
    tree: Tree
    attributes: dict[str, Any]
    scalars: list[Scalar]
    lattice: Optional[Lattice]
    is_textured: bool
    conventions: Conventions
    index_bytes: int
    index_checksum: int
    build: str

    def tile_name(self, node: Node) -> str:
        """The name of a tile's file within the hierarchy."""
        group = node.index // 10000 * 10000 if self.json["format_version"] > 6 else 0
        folder = f"tiles/{node.level:02}/" + (f"{group:06}/" if group else "")
        return f"{folder}{node.index:06}.glb"


def _point(value: Any) -> NDArray[np.float64]:
    """Three numbers."""
    return np.array(value, np.float64).reshape(3)


def _attributes(said: dict[str, Any]) -> dict[str, Any]:
    """What the input has; four of its keys are always there."""
    return {**said, **{name: said[name] for name in ("normals", "colours", "alpha", "texcoords")}}


def _scalar(value: dict[str, Any]) -> Scalar:
    labels = [int(label) for label in value.get("labels", [])]
    names = value.get("label_names", [""] * len(labels))
    return Scalar(value["name"], value["type"], value["kind"], value["min"], value["max"], dict(zip(labels, names)))


def _conventions(text: dict[str, Any]) -> Conventions:
    if text["up"] not in ("y", "z"):
        raise ValueError("up is neither y nor z")
    attributes, texture = text["source"]["attributes"], text["storage"].get("texture", {})
    return Conventions(text["up"], attributes.get("linear_colours", False), attributes.get("tints", False), texture.get("unlit", False))


def _require_seal(data: bytes, path: str) -> None:
    """Raises CorruptError unless the text ends with its own checksum, which is made with zeros in its place."""
    text, digits = data[: -_DIGITS - len(_AFTER_SEAL)], data[-_DIGITS - len(_AFTER_SEAL) : -len(_AFTER_SEAL)]
    if not text.endswith(_BEFORE_SEAL) or not data.endswith(_AFTER_SEAL):
        raise CorruptError(f"{path}: hierarchy.json does not end with its checksum: the file was changed")
    if digits != b"%016x" % checksum(text + b"0" * _DIGITS + _AFTER_SEAL):
        raise CorruptError(f"{path}: hierarchy.json has another checksum than it says: the file was changed")


def read_manifest(data: bytes, path: str) -> Manifest:
    """Of `hierarchy.json`. Raises NotAHierarchyError, CorruptError."""
    try:
        text = json.loads(data)
    except (RecursionError, ValueError) as error:
        raise CorruptError(f"{path}: hierarchy.json: {error}") from error
    if not isinstance(text, dict) or text.get("format") != "meshhier":
        raise NotAHierarchyError(f"{path}: hierarchy.json is of something else")
    if text.get("format_version") not in _VERSIONS:
        raise NotAHierarchyError(
            f"{path}: format version {str(text.get('format_version'))[:20]}; this package reads {_VERSIONS[0]} to {_VERSIONS[-1]}"
        )
    _require_seal(data, path)
    try:
        source = text["source"]
        lattice = text["storage"]["positions"]
        return Manifest(
            json=text,
            vertices=int(source["vertices"]),
            triangles=int(source["triangles"]),
            bounds=np.array([_point(source["bounds"][end]) for end in ("min", "max")]),
            origin=_point(text["origin"]),
            tree=Tree(operator.index(text["partitions"])),
            attributes=_attributes(source["attributes"]),
            scalars=[_scalar(value) for value in source.get("values", [])],
            lattice=Lattice(_point(lattice["corner"]), float(lattice["step"])) if lattice else None,
            is_textured="textures" in source,
            conventions=_conventions(text),
            index_bytes=int(text["index"]["bytes"]),
            index_checksum=int(text["index"]["checksum"], 16),
            build=str(text["checksum"]),
        )
    except MISREAD as error:
        raise misread(f"{path}: hierarchy.json", error) from error
