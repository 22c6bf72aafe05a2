# SPDX-License-Identifier: MIT
"""Runs in Blender: imports hierarchies by examples/blender/import_meshhier.py, and compares what is there with what Blender's own importers make of
the same meshes. scripts/check_blender starts it, with a folder for files as the last argument; what is not right ends it with an error."""

import os
import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils.kdtree import KDTree

ROOT = Path(__file__).resolve().parents[2]
WORK = Path(sys.argv[-1])
sys.path[:0] = [str(ROOT / "python"), str(ROOT / "examples" / "blender")]

import import_meshhier  # noqa: E402

import meshhier  # noqa: E402


def run(*words: str) -> None:
    subprocess.run([*words], check=True, stdout=subprocess.DEVNULL)


def build(mesh: str, name: str, *settings: str) -> Path:
    words = [word for setting in settings for word in ("--set", setting)]
    run(os.environ["MESHHIER"], "build", str(WORK / mesh), "-o", str(WORK / name), "--progress", "none", *words)
    return WORK / name


def load(path: Path, **options: object):
    bpy.ops.object.select_all(action="DESELECT")
    file = path if path.suffix == ".3tz" else path / "hierarchy.json"
    assert bpy.ops.import_scene.meshhier(filepath=str(file), **options) == {"FINISHED"}
    return bpy.context.object


def load_obj(path: Path):
    """As Blender's own importer has it, in the file's axes."""
    bpy.ops.object.select_all(action="DESELECT")
    bpy.ops.wm.obj_import(filepath=str(path), forward_axis="Y", up_axis="Z")
    return bpy.context.selected_objects[0]


def vertices(thing, attribute: str = "co", width: int = 3) -> np.ndarray:
    values = np.zeros(len(thing.data.vertices) * width, np.float32)
    thing.data.vertices.foreach_get(attribute, values)
    return values.reshape(-1, width)


def faces(thing) -> np.ndarray:
    corners = np.zeros(3 * len(thing.data.polygons), np.int32)
    thing.data.loops.foreach_get("vertex_index", corners)
    return corners.reshape(-1, 3)


def values(thing, name: str, kind: str, width: int, of) -> np.ndarray:
    found = thing.data.attributes[name].data
    filled = np.zeros(len(found) * width, of)
    found.foreach_get(kind, filled)
    return filled.reshape(-1, width)


def check_shape() -> None:
    """What meshhier exports, and Blender imports, has the same triangles, each facing the same way."""
    run(os.environ["MESHGEN"], "surface", "--shape", "torus", "--triangles", "20000", "-o", str(WORK / "near.ply"))
    near = build("near.ply", "near.hier", "partition.vertices=700", "up=z")
    for wanted, options in ((["--level", "1"], {"by": "LEVEL", "level": 1}), (["--error", "0.01"], {"by": "ERROR", "error": 0.01}), (["--error", "0"], {"by": "LEVEL", "level": 99})):
        run(os.environ["MESHHIER"], "export", str(near), *wanted, "-o", str(WORK / "near.obj"), "--force", "--progress", "none")
        thing, judge = load(near, **options), load_obj(WORK / "near.obj")
        ours, theirs = (oriented(vertices(each), faces(each)) for each in (thing, judge))
        assert len(ours) == len(theirs) and np.abs(ours - theirs).max() < 1e-4, options
        print(f"ok  shape: {len(ours)} triangles {options}")


def oriented(positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The area vectors and middles of triangles, in one order."""
    a, b, c = (positions[triangles[:, k]].astype(float) for k in range(3))
    rows = np.concatenate([(a + b + c) / 3, np.cross(b - a, c - a)], axis=1)
    return rows[np.lexsort(np.round(rows[:, :3], 3).T)]


def check_surface() -> None:
    """Far from 0, with doubles, normals and colours: a level, and a box of the original. Blender's own importers have no such coordinates."""
    run(os.environ["MESHGEN"], "surface", "--shape", "torus", "--triangles", "20000", "--normals", "--colours", "--double", "-o", str(WORK / "torus.ply"))
    data = (WORK / "torus.ply").read_bytes()
    end = data.index(b"end_header\n") + 11
    moved = move(data[:end].decode(), data[end:], np.array([5e5, 5.5e6, 120.0]))
    (WORK / "far.ply").write_bytes(moved)
    far = build("far.ply", "far.hier", "partition.vertices=700", "up=z", "units=cm")
    thing = load(far, by="LEVEL", level=2)
    with meshhier.open(far) as hierarchy:
        cut = hierarchy.cut(level=2)
        assert list(thing["meshhier_origin"]) == list(hierarchy.origin) and abs(hierarchy.origin[1]) > 5e6
        box = ((hierarchy.bounds[0] + hierarchy.bounds[1]) / 2, hierarchy.bounds[1])
        part = hierarchy.cut(box=box)
    local = vertices(thing)
    assert np.abs(local).max() < 100, "coordinates are not local"
    assert np.abs(local.astype(float) + thing["meshhier_origin"] - cut.positions).max() < 1e-4
    assert np.array_equal(faces(thing), cut.triangles)
    assert np.allclose(thing.matrix_world.to_scale(), 0.01), "centimetres are not metres"
    shown = values(thing, "colours", "color", 4, np.float32)[:, :3]
    assert np.abs(np.where(shown <= 0.0031308, shown * 12.92, 1.055 * shown ** (1 / 2.4) - 0.055) * 255 - cut.colours[:, :3]).max() < 0.51
    thing.data.calc_normals_split()
    corners = np.zeros(3 * len(thing.data.loops), np.float32)
    thing.data.loops.foreach_get("normal", corners)
    assert np.abs(corners.reshape(-1, 3) - cut.normals[cut.triangles.ravel()]).max() < 0.01
    piece = load(far, by="ORIGINAL", use_box=True, low=tuple(box[0]), high=tuple(box[1]))
    assert 0 < abs(len(piece.data.polygons)) < 20000 and abs(len(piece.data.polygons) - len(part.triangles)) <= len(part.triangles) // 20, "32 bits of a box"
    print(f"ok  a level: {len(cut.triangles)} triangles at {cut.positions[0].round(2)}; a box: {len(piece.data.polygons)} triangles")


def move(header: str, body: bytes, by: np.ndarray) -> bytes:
    kinds = {"float": "<f4", "double": "<f8", "uchar": "u1"}
    lines = header.split("element face")[0].splitlines()
    fields = [(line.split()[2], kinds[line.split()[1]]) for line in lines if line.startswith("property")]
    count = int(next(line for line in lines if line.startswith("element vertex")).split()[2])
    rows = np.frombuffer(body, fields, count).copy()
    for axis, distance in zip("xyz", by):
        rows[axis] += distance
    return header.encode() + rows.tobytes() + body[rows.nbytes :]


def check_attributes() -> None:
    side = 60
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(side), np.arange(side), indexing="ij"))
    corners = [(i * side + j, i * side + side + j, i * side + j + 1) for i in range(side - 1) for j in range(side - 1)]
    lines = [f"{a} {b} 0 {a / 7:.6f} {(a // 10) * 100 - 200}" for a, b in zip(x, y)]
    kinds = ["float x", "float y", "float z", "float quality", "int label"]
    head = ["ply", "format ascii 1.0", f"element vertex {len(lines)}", *(f"property {kind}" for kind in kinds), f"element face {len(corners)}"]
    head += ["property list uchar int vertex_indices", "end_header", *lines, *(f"3 {a} {b} {c}" for a, b, c in corners)]
    (WORK / "grid.ply").write_text("\n".join(head) + "\n")
    thing = load(build("grid.ply", "grid.3tz"), by="ORIGINAL")
    places = vertices(thing)
    assert np.abs(values(thing, "quality", "value", 1, np.float32)[:, 0] - places[:, 0] / 7).max() < 1e-5
    assert np.array_equal(values(thing, "label", "value", 1, np.int32)[:, 0], places[:, 0].astype(int) // 10 * 100 - 200)
    assert thing.rotation_euler.to_matrix()[2][1] > 0.99, "y is not up"
    print("ok  attributes")


def colours_at(thing) -> tuple[np.ndarray, np.ndarray]:
    """The middle of each triangle, and the colour of its picture there."""
    coordinates = np.zeros(2 * len(thing.data.loops), np.float32)
    thing.data.uv_layers.active.data.foreach_get("uv", coordinates)
    at = coordinates.reshape(-1, 3, 2).mean(axis=1)
    materials = np.zeros(len(thing.data.polygons), np.int32)
    thing.data.polygons.foreach_get("material_index", materials)
    colours = np.zeros((len(at), 3))
    for number, material in enumerate(thing.data.materials):
        image = next(node.image for node in material.node_tree.nodes if node.type == "TEX_IMAGE")
        pixels = np.zeros(image.size[0] * image.size[1] * image.channels, np.float32)
        image.pixels.foreach_get(pixels)
        pixels = pixels.reshape(image.size[1], image.size[0], image.channels)
        own = materials == number
        column, row = ((at[own] % 1) * (image.size[0], image.size[1])).astype(int).T
        colours[own] = pixels[np.minimum(row, image.size[1] - 1), np.minimum(column, image.size[0] - 1), :3]
    return vertices(thing)[faces(thing)].mean(axis=1), colours


def check_pictures() -> None:
    """The colour in the middle of each triangle is that of the same triangle in Blender's own import of the input."""
    run(os.environ["MESHGEN"], "textured", "--triangles", "6000", "--images", "2", "--side", "512", "-o", str(WORK / "painted.obj"))
    thing = load(build("painted.obj", "painted.hier", "texture.format=png", "partition.vertices=800"), by="ORIGINAL")
    middles, colours = colours_at(thing)
    tree_of, expected = colours_at(load_obj(WORK / "painted.obj"))
    tree = KDTree(len(tree_of))
    for number, place in enumerate(tree_of):
        tree.insert(place, number)
    tree.balance()
    found = [tree.find(place) for place in middles]
    size = np.ptp(middles, axis=0).max()
    assert max(distance for _, _, distance in found) < 1e-4 * size
    apart = np.abs(colours - expected[[number for _, number, _ in found]]).mean()
    across = np.abs(colours - colours[np.random.default_rng(1).permutation(len(colours))]).mean()
    assert len(middles) == len(tree_of) and apart < across / 5, f"colours are {apart:.3f} apart, of chance {across:.3f}"
    print(f"ok  pictures: {len(thing.data.materials)}, colours {apart:.4f} apart, of chance {across:.4f}")
    thing = load(build("painted.obj", "blocks.hier", "texture.format=ktx2", "texture.quality=100"), by="LEVEL", level=0)
    assert all(node.type != "TEX_IMAGE" for material in thing.data.materials for node in material.node_tree.nodes)
    print("ok  pictures that Blender does not read")
    lines = (WORK / "painted.obj").read_text().splitlines()
    (WORK / "coloured.obj").write_text("\n".join(f"{line} 0.5 0.25 0" if line.startswith("v ") else line for line in lines) + "\n")
    thing = load(build("coloured.obj", "coloured.hier", "texture.format=png"), by="LEVEL", level=0)
    kinds = {node.type for material in thing.data.materials for node in material.node_tree.nodes}
    assert "colours" in thing.data.attributes and "TEX_IMAGE" in kinds and "VERTEX_COLOR" not in kinds, kinds
    print("ok  colours that do not tint pictures")


def check_errors() -> None:
    away = {"by": "ORIGINAL", "use_box": True, "low": (1e3, 1e3, 1e3), "high": (2e3, 2e3, 2e3)}
    near = WORK / "near.hier" / "hierarchy.json"
    for path, options, words in ((WORK / "none.3tz", {}, "no such file"), (WORK / "torus.ply", {}, "archive"), (near, away, "no triangle touches the box")):
        try:
            bpy.ops.import_scene.meshhier(filepath=str(path), **options)
        except RuntimeError as error:
            assert words in str(error), error
        else:
            raise AssertionError(f"{path} is imported")
    print("ok  errors")


import_meshhier.register()
for check in (check_shape, check_surface, check_attributes, check_pictures, check_errors):
    check()
import_meshhier.unregister()
