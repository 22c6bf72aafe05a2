# SPDX-License-Identifier: MIT
"""Meshes as arrays, and what other libraries call them."""

from __future__ import annotations

import pathlib
from collections import deque
from dataclasses import dataclass, field
from operator import attrgetter
from typing import Any, Callable, Iterable, Optional

import numpy as np
from numpy.typing import NDArray

from .asked import Path, new_file
from .content import ByContent
from .errors import UsageError
from .gltf import glb_of
from .tile import decode_image
from .tree import Node


@dataclass(frozen=True)
class Conventions:
    """How a mesh's numbers are meant.

    Attributes:
        up: the axis that points up, "y" or "z".
        linear_colours: colours are light, as glTF has them; else those of a screen (sRGB).
        tints: pictures are multiplied by the colours.
        unlit: pictures have their light already.
    """

    up: str = "y"
    linear_colours: bool = False
    tints: bool = False
    unlit: bool = False


@dataclass(eq=False)
class Mesh(ByContent):
    """A triangle mesh in the coordinates of the input.

    Attributes:
        positions: (n, 3) float64, in the input's units.
        triangles: (m, 3) int64, each counted as the input has it: counter-clockwise seen from outside, if the input does so.
        normals: (n, 3) float32 or None: those of the input; of a textured mesh also computed ones.
        colours: (n, 3 or 4) uint8, uint16 or float32, or None: as the input has them.
        texcoords: (n, 2) float32 or None: (0, 0) is the upper left corner of the tile's picture, if there are pictures.
        attributes: name -> (n,): quality, label, ... in the input's types.
        tiles: the tiles that the triangles come from.
        triangle_tiles: (m,) int64, for each triangle the number of its tile in `tiles`.
        triangle_objects: (m,) int64, for each triangle the number of its object in `Hierarchy.objects`; None if there are none.
        images: of a textured mesh the file of the picture of each tile (JPEG, PNG, WebP or KTX2); else empty.
        ids: (n,) int64 or None: of pieces the number of each vertex among those of all pieces, see `Hierarchy.iter_parts()`.
        alpha_modes: of each picture whether it is "OPAQUE", has holes ("MASK") or lets light through ("BLEND").
        conventions: how colours, pictures and axes are meant.

    Two are equal if all of this is.
    """

    positions: NDArray[np.float64]
    triangles: NDArray[np.int64]
    normals: Optional[NDArray[np.float32]] = None
    colours: Optional[NDArray[Any]] = None
    texcoords: Optional[NDArray[np.float32]] = None
    attributes: dict[str, NDArray[Any]] = field(default_factory=dict)
    tiles: list[Node] = field(default_factory=list)
    triangle_tiles: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    images: list[bytes] = field(default_factory=list, repr=False)
    triangle_objects: Optional[NDArray[np.int64]] = None
    ids: Optional[NDArray[np.int64]] = None
    alpha_modes: list[str] = field(default_factory=list)
    conventions: Conventions = Conventions()

    def __repr__(self) -> str:
        return f"Mesh({len(self.positions)} vertices, {len(self.triangles)} triangles, {len(self.tiles)} tiles)"

    def images_as_arrays(self) -> list[NDArray[np.uint8]]:
        """The picture of each tile, (height, width, 3 or 4) uint8. Needs Pillow."""
        return [decode_image(image) for image in self.images]

    def take(self, chosen: NDArray[np.bool_]) -> Mesh:
        """The triangles for which `chosen`, (m,) bool, is true, and the vertices that they use, in their order."""
        triangles = self.triangles[chosen]
        used, numbers = np.unique(triangles, return_inverse=True)

        def part(values: Optional[NDArray[Any]]) -> Optional[NDArray[Any]]:
            return None if values is None else values[used]

        def part_of_triangles(values: Optional[NDArray[Any]]) -> Optional[NDArray[Any]]:
            return None if values is None else values[chosen]

        return Mesh(
            positions=self.positions[used],
            triangles=numbers.reshape(-1, 3).astype(np.int64),
            normals=part(self.normals),
            colours=part(self.colours),
            texcoords=part(self.texcoords),
            attributes={name: values[used] for name, values in self.attributes.items()},
            tiles=self.tiles,
            triangle_tiles=self.triangle_tiles[chosen],
            images=self.images,
            triangle_objects=part_of_triangles(self.triangle_objects),
            ids=part(self.ids),
            alpha_modes=self.alpha_modes,
            conventions=self.conventions,
        )

    @staticmethod
    def join(pieces: Iterable[Mesh]) -> Mesh:
        """One mesh of pieces with `ids`, one or more: vertices of one number become one, and come in the order of their numbers."""
        each = deque(pieces)
        if not each or any(piece.ids is None for piece in each):
            raise UsageError("pieces that can be joined have ids: iter_parts(..., ids=True)" if each else "there is no piece to be joined")
        ids = np.unique(np.concatenate([_ids_of(piece) for piece in each]))
        joined = _room_for(each, len(ids), sum(len(piece.triangles) for piece in each))
        at = 0
        while each:  # a piece goes when it has been copied
            at = joined._add(each.popleft(), ids, at)
        return joined

    def _add(self, piece: Mesh, ids: NDArray[np.int64], at: int) -> int:
        """Copies a piece, its triangles to place `at`, and returns where they end."""
        numbers = np.searchsorted(ids, _ids_of(piece))
        end = at + len(piece.triangles)
        for name in _OF_VERTICES:
            if getattr(self, name) is not None:
                getattr(self, name)[numbers] = getattr(piece, name)
        for name, values in self.attributes.items():
            values[numbers] = piece.attributes[name]
        self.triangles[at:end] = numbers[piece.triangles]
        self.triangle_tiles[at:end] = piece.triangle_tiles + len(self.tiles)
        if self.triangle_objects is not None:
            self.triangle_objects[at:end] = piece.triangle_objects
        self.tiles += piece.tiles
        self.images += piece.images
        self.alpha_modes += piece.alpha_modes
        return end

    def colours_as_bytes(self) -> Optional[NDArray[np.uint8]]:
        """(n, 3 or 4) uint8, whatever the input's type; None if there are none."""
        if self.colours is None or self.colours.dtype == np.uint8:
            return self.colours
        most = 1.0 if self.colours.dtype == np.float32 else 65535.0
        return np.rint(np.clip(self.colours / most, 0, 1) * 255).astype(np.uint8)

    def to_trimesh(self, *, picture: bool = True) -> Any:
        """A `trimesh.Trimesh`, with colours and attributes of vertices; needs trimesh.

        A mesh of one tile, as a piece is, has its `picture`, too, by Pillow. All of a cut come with the scene that trimesh makes of a GLB:
        `trimesh.load(io.BytesIO(mesh.to_gltf()), file_type="glb")`.
        """
        import trimesh

        mesh = trimesh.Trimesh(
            vertices=self.positions,
            faces=self.triangles,
            vertex_normals=self.normals,
            vertex_colors=self.colours_as_bytes(),
            vertex_attributes=dict(self.attributes),
            process=False,
        )
        if picture and len(self.images) == 1 and self.images[0] and self.texcoords is not None:
            from PIL import Image

            from_below = self.texcoords * [1, -1] + [0, 1]
            mesh.visual = trimesh.visual.TextureVisuals(uv=from_below, image=Image.fromarray(self.images_as_arrays()[0]))
        return mesh

    def to_pyvista(self) -> Any:
        """A `pyvista.PolyData`, with point data "normals", "colours", "texcoords" and the attributes; needs PyVista."""
        import pyvista

        faces = np.column_stack([np.full(len(self.triangles), 3), self.triangles])
        mesh = pyvista.PolyData(self.positions, faces.ravel())
        for name, values in (
            ("normals", self.normals),
            ("colours", self.colours_as_bytes()),
            ("texcoords", self.texcoords),
            *self.attributes.items(),
        ):
            if values is not None:
                mesh.point_data[name] = values
        return mesh

    def to_open3d(self) -> Any:
        """An `open3d.geometry.TriangleMesh` with normals and colours; needs Open3D."""
        import open3d

        mesh = open3d.geometry.TriangleMesh(
            open3d.utility.Vector3dVector(self.positions), open3d.utility.Vector3iVector(self.triangles.astype(np.int32))
        )
        if self.normals is not None:
            mesh.vertex_normals = open3d.utility.Vector3dVector(self.normals.astype(np.float64))
        colours = self.colours_as_bytes()
        if colours is not None:
            mesh.vertex_colors = open3d.utility.Vector3dVector(colours[:, :3] / 255.0)
        return mesh

    def to_gltf(self) -> bytes:
        """A glTF binary (GLB): positions, normals, colours, texture coordinates with pictures, and attributes as `_NAME`.

        It stands upright, in float positions about a place that its node has, where floats do not have the coordinates themselves.
        Colours are light there, as glTF has them. Attributes of 32 bits and double ones are the nearest floats,
        -3.4028234663852886e38 where there is none. A picture is a primitive with a material. Raises UsageError from 4 GiB on.
        """
        return glb_of(self)

    def write_ply(self, path: Path, *, force: bool = False) -> pathlib.Path:
        """Makes a binary PLY with everything but pictures, and returns its path. Raises ExistsError, which is a FileExistsError, too, if there is a file of that
        name, unless `force` replaces it; the file is there when all of it is."""
        columns: list[tuple[str, NDArray[Any]]] = [(axis, self.positions[:, k]) for k, axis in enumerate("xyz")]
        if self.normals is not None:
            columns += [(f"n{axis}", self.normals[:, k]) for k, axis in enumerate("xyz")]
        if self.colours is not None:
            columns += [(name, self.colours[:, k]) for k, name in enumerate(("red", "green", "blue", "alpha")[: self.colours.shape[1]])]
        if self.texcoords is not None:
            columns += [(name, self.texcoords[:, k]) for k, name in enumerate("st")]
        columns += list(self.attributes.items())
        names = {"i1": "char", "u1": "uchar", "i2": "short", "u2": "ushort", "i4": "int", "u4": "uint", "f4": "float", "f8": "double"}
        if len({name for name, _ in columns}) != len(columns):
            raise UsageError("an attribute has the name of a coordinate, normal or colour")
        unknown = [name for name, values in columns if values.dtype.str[1:] not in names]
        if unknown or len(self.positions) > 2**31:
            raise UsageError(f"PLY has no such type as that of {unknown[0]}" if unknown else "PLY has at most 2^31 vertices")
        rows = np.zeros(len(self.positions), [(name, values.dtype.newbyteorder("<")) for name, values in columns])
        for name, values in columns:
            rows[name] = values
        faces = np.zeros(len(self.triangles), [("count", "u1"), ("corners", "<i4", 3)])
        faces["count"], faces["corners"] = 3, self.triangles
        header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(rows)}"]
        header += [f"property {names[values.dtype.str[1:]]} {name}" for name, values in columns]
        header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header", ""]
        with new_file(path, force) as file:
            file.write("\n".join(header).encode("ascii"))
            file.write(rows.tobytes())
            file.write(faces.tobytes())
        return pathlib.Path(path)


_OF_VERTICES = ("positions", "normals", "colours", "texcoords")


def _ids_of(piece: Mesh) -> NDArray[np.int64]:
    assert piece.ids is not None
    return piece.ids


def _room_for(pieces: Iterable[Mesh], vertices: int, triangles: int) -> Mesh:
    """A mesh with all that each of the pieces has, still without numbers."""
    each = list(pieces)

    def room(values: Callable[[Mesh], Optional[NDArray[Any]]], count: int) -> Any:
        there = [values(piece) for piece in each]
        first = there[0]
        return None if first is None or any(one is None for one in there) else np.empty((count, *first.shape[1:]), first.dtype)

    return Mesh(
        **{name: room(attrgetter(name), vertices) for name in _OF_VERTICES},
        triangles=room(attrgetter("triangles"), triangles),
        attributes={name: room(lambda piece: piece.attributes[name], vertices) for name in each[0].attributes},
        triangle_tiles=np.empty(triangles, np.int64),
        triangle_objects=room(attrgetter("triangle_objects"), triangles),
        conventions=each[0].conventions,
    )
