# SPDX-License-Identifier: MIT
"""Meshes as arrays, and what other libraries call them."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Iterable, Optional

import numpy as np
from numpy.typing import NDArray

from .asked import new_file
from .content import ByContent
from .errors import UsageError
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
    conventions: Conventions = Conventions()

    def __repr__(self) -> str:
        return f"Mesh({len(self.positions)} vertices, {len(self.triangles)} triangles, {len(self.tiles)} tiles)"

    def images_as_arrays(self) -> list[NDArray[np.uint8]]:
        """The picture of each tile, (height, width, 3 or 4) uint8. Needs Pillow."""
        from .tile import decode_image

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
            conventions=self.conventions,
        )

    @staticmethod
    def join(pieces: Iterable[Mesh]) -> Mesh:
        """One mesh of pieces with `ids`, one or more: vertices of one number become one, and come in the order of their numbers."""
        each = list(pieces)
        if not each or any(piece.ids is None for piece in each):
            raise UsageError("pieces that can be joined have ids: iter_parts(..., ids=True)" if each else "there is no piece to be joined")
        ids = np.concatenate([piece.ids for piece in each if piece.ids is not None])
        _, chosen, numbers = np.unique(ids, return_index=True, return_inverse=True)
        starts = np.cumsum([0] + [len(piece.positions) for piece in each])
        first_tiles = np.cumsum([0] + [len(piece.tiles) for piece in each])

        def all_of(values: list[Optional[NDArray[Any]]]) -> Optional[NDArray[Any]]:
            there = [one for one in values if one is not None]
            return np.concatenate(there) if len(there) == len(each) else None

        def vertices(values: list[Optional[NDArray[Any]]]) -> Optional[NDArray[Any]]:
            together = all_of(values)
            return None if together is None else together[chosen]

        return Mesh(
            positions=np.concatenate([piece.positions for piece in each])[chosen],
            triangles=numbers[np.concatenate([piece.triangles + start for piece, start in zip(each, starts)])].astype(np.int64),
            normals=vertices([piece.normals for piece in each]),
            colours=vertices([piece.colours for piece in each]),
            texcoords=vertices([piece.texcoords for piece in each]),
            attributes={name: np.concatenate([piece.attributes[name] for piece in each])[chosen] for name in each[0].attributes},
            tiles=[tile for piece in each for tile in piece.tiles],
            triangle_tiles=np.concatenate([piece.triangle_tiles + first for piece, first in zip(each, first_tiles)]),
            images=[image for piece in each for image in piece.images],
            triangle_objects=all_of([piece.triangle_objects for piece in each]),
            conventions=each[0].conventions,
        )

    def colours_as_bytes(self) -> Optional[NDArray[np.uint8]]:
        """(n, 3 or 4) uint8, whatever the input's type; None if there are none."""
        if self.colours is None or self.colours.dtype == np.uint8:
            return self.colours
        most = 1.0 if self.colours.dtype == np.float32 else 65535.0
        return np.rint(np.clip(self.colours / most, 0, 1) * 255).astype(np.uint8)

    def to_trimesh(self) -> Any:
        """A `trimesh.Trimesh`, with colours and attributes of vertices; needs trimesh."""
        import trimesh

        return trimesh.Trimesh(
            vertices=self.positions,
            faces=self.triangles,
            vertex_normals=self.normals,
            vertex_colors=self.colours_as_bytes(),
            vertex_attributes=dict(self.attributes),
            process=False,
        )

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

    def write_ply(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """A binary PLY with everything but pictures. Raises ExistsError, which is a FileExistsError, too, if there is a file of that
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
