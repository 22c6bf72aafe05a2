# SPDX-License-Identifier: MIT
"""Blender add-on: File > Import > meshhier hierarchy. It makes one object of a level, of all that is within an error, or of a box of the original,
with normals, colours, pictures and attributes. Needs Blender 3.4 or later and the Python package meshhier: docs/recipes/blender.md."""

from __future__ import annotations

import json
import os
from typing import Any, Iterable, Optional

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ImportHelper
from mathutils import Matrix

bl_info = {
    "name": "meshhier hierarchies",
    "author": "meshhier maintainers",
    "version": (1, 0, 0),
    "blender": (3, 4, 0),
    "location": "File > Import > meshhier hierarchy",
    "description": "Imports a level, or a part, of a hierarchy of a huge mesh",
    "category": "Import-Export",
}

METRES = {"mm": 0.001, "cm": 0.01, "m": 1.0, "km": 1000.0, "in": 0.0254, "ft": 0.3048, "us_ft": 1200 / 3937}
OWN_NAMES = {"position", "normal", "material_index", "sharp_face", "UVMap", "colours"}


def is_readable(picture: bytes) -> bool:
    """Whether Blender reads it: JPEG, PNG and WebP, and no KTX2."""
    return picture[:3] == b"\xff\xd8\xff" or picture[:8] == b"\x89PNG\r\n\x1a\n" or (picture[:4] == b"RIFF" and picture[8:12] == b"WEBP")


def light_of(colours: np.ndarray, is_linear: bool) -> np.ndarray:
    """(n, 4) float32: colours of 0 to 1 as Blender keeps them."""
    most = {np.dtype(np.uint8): 255, np.dtype(np.uint16): 65535}.get(colours.dtype, 1)
    light = np.ones((len(colours), 4), np.float32)
    light[:, : colours.shape[1]] = colours / most
    if not is_linear:
        shown = light[:, :3]
        light[:, :3] = np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
    return light


def make_faces(mesh: Any, positions: np.ndarray, triangles: np.ndarray) -> None:
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", positions.astype(np.float32).ravel())
    mesh.loops.add(3 * len(triangles))
    mesh.loops.foreach_set("vertex_index", triangles.astype(np.int32).ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * len(triangles), 3, dtype=np.int32))
    if bpy.app.version < (4, 1):  # later it follows from the starts
        mesh.polygons.foreach_set("loop_total", np.full(len(triangles), 3, np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(triangles), bool))
    mesh.update(calc_edges=True)


def set_normals(mesh: Any, normals: Optional[np.ndarray]) -> None:
    if normals is None:
        return
    mesh.normals_split_custom_set_from_vertices(normals.astype(np.float32))
    if bpy.app.version < (4, 1):
        mesh.use_auto_smooth = True  # without it Blender computes normals of its own


def set_attributes(mesh: Any, cut: Any) -> None:
    """Labels and other whole numbers as integers where all fit into 32 bits, all else as floats."""
    for name, values in cut.attributes.items():
        is_whole = values.dtype.kind in "iu" and (len(values) == 0 or (values.min() >= -(2**31) and values.max() < 2**31))
        attribute = mesh.attributes.new(name if name not in OWN_NAMES else f"{name}_", "INT" if is_whole else "FLOAT", "POINT")
        attribute.data.foreach_set("value", values.astype(np.int32 if is_whole else np.float32))


def set_texcoords(mesh: Any, texcoords: Optional[np.ndarray], triangles: np.ndarray, has_pictures: bool) -> None:
    if texcoords is None:
        return
    corners = texcoords[triangles.ravel()].astype(np.float32)
    if has_pictures:
        corners[:, 1] = 1 - corners[:, 1]  # Blender counts from the lower edge
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", corners.ravel())


def new_image(name: str, picture: bytes) -> Any:
    image = bpy.data.images.new(name, 1, 1)
    image.pack(data=picture, data_len=len(picture))
    image.source = "FILE"
    return image


class Look:
    """Makes materials: of pictures, of colours, of both where colours tint pictures, or plain."""

    def __init__(self, cut: Any) -> None:
        self.is_unlit = cut.conventions.unlit
        self.has_colours = cut.colours is not None
        self.tints = cut.conventions.tints

    def material(self, name: str, picture: bytes) -> Any:
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        nodes, links = material.node_tree.nodes, material.node_tree.links
        sources = []
        if picture:
            node = nodes.new("ShaderNodeTexImage")
            node.image = new_image(name, picture)
            sources.append(node.outputs["Color"])
        if self.has_colours and (self.tints or not picture):
            node = nodes.new("ShaderNodeVertexColor")
            node.layer_name = "colours"
            sources.append(node.outputs["Color"])
        if sources:
            links.new(self.product(nodes, links, sources), self.target(nodes, links, self.is_unlit and bool(picture)))
        return material

    def product(self, nodes: Any, links: Any, sources: list[Any]) -> Any:
        if len(sources) == 1:
            return sources[0]
        node = nodes.new("ShaderNodeMixRGB")
        node.blend_type = "MULTIPLY"
        node.inputs["Fac"].default_value = 1
        links.new(sources[0], node.inputs["Color1"])
        links.new(sources[1], node.inputs["Color2"])
        return node.outputs["Color"]

    def target(self, nodes: Any, links: Any, is_unlit: bool) -> Any:
        """Pictures that have their light already shine by themselves."""
        if not is_unlit:
            return nodes["Principled BSDF"].inputs["Base Color"]
        node = nodes.new("ShaderNodeEmission")
        links.new(node.outputs["Emission"], nodes["Material Output"].inputs["Surface"])
        nodes.remove(nodes["Principled BSDF"])
        return node.inputs["Color"]


def set_materials(mesh: Any, cut: Any, look: Look, name: str) -> int:
    """Returns how many pictures Blender does not read."""
    pictures = [picture if is_readable(picture) else b"" for picture in cut.images]
    if not pictures:
        mesh.materials.append(look.material(name, b""))
        return 0
    used = np.unique(cut.triangle_tiles)
    for number in used:
        mesh.materials.append(look.material(f"{name} {cut.tiles[number]}", pictures[number]))
    mesh.polygons.foreach_set("material_index", np.searchsorted(used, cut.triangle_tiles).astype(np.int32))
    return sum(bool(cut.images[number]) and not pictures[number] for number in used)


def placement(hierarchy: Any, is_upright: bool, is_metric: bool) -> Matrix:
    scale = METRES.get(hierarchy.units, 1.0) if is_metric else 1.0
    matrix = Matrix.Scale(scale, 4)
    if is_upright and hierarchy.manifest.get("up") == "y":
        matrix = Matrix.Rotation(np.pi / 2, 4, "X") @ matrix
    return matrix


def set_facts(thing: Any, hierarchy: Any, path: str) -> None:
    """What leads back from local coordinates: input = local + meshhier_origin; what puts the model on the globe, and the build."""
    thing["meshhier_path"] = path
    thing["meshhier_build"] = str(hierarchy.manifest["checksum"])
    thing["meshhier_origin"] = [float(number) for number in hierarchy.origin]
    thing["meshhier_up"] = str(hierarchy.manifest.get("up"))
    thing["meshhier_units"] = hierarchy.units or ""
    thing["meshhier_transform"] = json.dumps(hierarchy.manifest.get("transform"))


def make_object(hierarchy: Any, cut: Any, name: str) -> tuple[Any, int]:
    """Local coordinates are the input's less the hierarchy's origin: those of all parts of a hierarchy fit together, and 32 bits are enough."""
    mesh = bpy.data.meshes.new(name)
    make_faces(mesh, cut.positions - hierarchy.origin, cut.triangles)
    if cut.colours is not None:
        colours = mesh.color_attributes.new("colours", "FLOAT_COLOR", "POINT")
        colours.data.foreach_set("color", light_of(cut.colours, cut.conventions.linear_colours).ravel())
        mesh.color_attributes.active_color = colours
    set_texcoords(mesh, cut.texcoords, cut.triangles, bool(cut.images))
    set_attributes(mesh, cut)
    unread = set_materials(mesh, cut, Look(cut), name)
    mesh.validate(clean_customdata=False)  # as Blender's own importers: simplified surfaces may have two faces of the same corners
    set_normals(mesh, cut.normals)
    return bpy.data.objects.new(name, mesh), unread


class ImportHierarchy(bpy.types.Operator, ImportHelper):
    """Imports a level, or a part, of a hierarchy: choose an archive, or the hierarchy.json of a folder"""

    bl_idname = "import_scene.meshhier"
    bl_label = "Import meshhier hierarchy"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".3tz"
    filter_glob: StringProperty(default="*.3tz;hierarchy.json", options={"HIDDEN"})  # type: ignore[valid-type]
    by: EnumProperty(  # type: ignore[valid-type]
        name="By",
        items=[
            ("LEVEL", "Level", "All tiles of a level"),
            ("ERROR", "Error", "The coarsest tiles that are near enough to the original"),
            ("ORIGINAL", "Original", "The original triangles"),
        ],
        default="LEVEL",
    )
    level: IntProperty(name="Level", description="0 is the coarsest; each one has twice the triangles of the one before", default=3, min=0)  # type: ignore[valid-type]
    error: FloatProperty(name="Error", description="Largest distance to the original, in the units of the input", default=0.01, min=0, precision=6)  # type: ignore[valid-type]
    use_box: BoolProperty(name="Box", description="Only triangles that touch a box", default=False)  # type: ignore[valid-type]
    low: FloatVectorProperty(name="From", description="In coordinates of the input", size=3, precision=3)  # type: ignore[valid-type]
    high: FloatVectorProperty(name="To", description="In coordinates of the input", size=3, precision=3)  # type: ignore[valid-type]
    is_upright: BoolProperty(name="Stand it upright", description="Turn models whose y axis is up", default=True)  # type: ignore[valid-type]
    is_metric: BoolProperty(name="Scale to metres", description="Where the hierarchy says its units", default=True)  # type: ignore[valid-type]

    def execute(self, context: Any) -> set[str]:
        try:
            import meshhier
        except ImportError as error:
            self.report({"ERROR"}, f"Blender's Python has no package meshhier ({error}): docs/recipes/blender.md tells how to install it")
            return {"CANCELLED"}
        path = os.path.dirname(self.filepath) if os.path.basename(self.filepath) == "hierarchy.json" else self.filepath
        try:
            with meshhier.open(path) as hierarchy:
                self.add(context, hierarchy, hierarchy.cut(**self.wanted(hierarchy)), path)
        except (meshhier.Error, OSError, ValueError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}

    def wanted(self, hierarchy: Any) -> dict[str, Any]:
        box = {"box": (tuple(self.low), tuple(self.high))} if self.use_box else {}
        if self.by == "LEVEL":
            return {"level": min(self.level, hierarchy.levels - 1), **box}
        return {"error": self.error, **box} if self.by == "ERROR" else box

    def add(self, context: Any, hierarchy: Any, cut: Any, path: str) -> None:
        if self.use_box and len(cut.triangles) == 0:
            raise ValueError(f"{path}: no triangle touches the box; the model is from {hierarchy.bounds[0]} to {hierarchy.bounds[1]}")
        name = os.path.splitext(os.path.basename(path.rstrip("/")))[0]
        made, unread = make_object(hierarchy, cut, name)
        set_facts(made, hierarchy, os.path.abspath(path))
        made.matrix_world = placement(hierarchy, self.is_upright, self.is_metric)
        context.collection.objects.link(made)
        context.view_layer.objects.active = made
        made.select_set(True)
        self.report({"INFO"}, f"{name}: {len(made.data.polygons)} triangles of {len(cut.tiles)} tiles")
        if unread:
            self.report({"WARNING"}, f"{unread} pictures are in KTX2, which Blender does not read: build the hierarchy with texture.format jpeg, png or webp")


def add_to_menu(menu: Any, context: Any) -> None:
    menu.layout.operator(ImportHierarchy.bl_idname, text="meshhier hierarchy (.3tz, hierarchy.json)")


def register() -> None:
    bpy.utils.register_class(ImportHierarchy)
    bpy.types.TOPBAR_MT_file_import.append(add_to_menu)


def unregister() -> None:
    bpy.types.TOPBAR_MT_file_import.remove(add_to_menu)
    bpy.utils.unregister_class(ImportHierarchy)


if __name__ == "__main__":
    register()
