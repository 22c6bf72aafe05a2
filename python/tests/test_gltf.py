# SPDX-License-Identifier: MIT
"""GLBs of meshes say what the meshes say; Khronos' validator and, where it is installed, trimesh judge them."""

from __future__ import annotations

import io
import json
import shutil
import struct
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import meshhier

VALIDATE = Path(__file__).parents[2] / "tests" / "gltf" / "validate.mjs"
TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class Glb:
    """The specification, read as far as these tests need it."""

    def __init__(self, data: bytes) -> None:
        magic, version, size, text, _ = struct.unpack_from("<4sIII4s", data)
        assert (magic, version, size, text % 4) == (b"glTF", 2, len(data), 0)
        self.json: dict[str, Any] = json.loads(data[20 : 20 + text])
        self.bin = data[28 + text :]

    def view(self, number: int) -> bytes:
        view = self.json["bufferViews"][number]
        return self.bin[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]

    def accessor(self, number: int) -> Any:
        facts = self.json["accessors"][number]
        kind, width = np.dtype(TYPES[facts["componentType"]]), WIDTHS[facts["type"]]
        stride = self.json["bufferViews"][facts["bufferView"]].get("byteStride", width * kind.itemsize)
        values = np.ndarray((facts["count"], width), kind, self.view(facts["bufferView"]), 0, (stride, kind.itemsize))
        return values / np.iinfo(kind).max if facts.get("normalized") else values[:, 0] if width == 1 else values

    @property
    def primitives(self) -> list[dict[str, Any]]:
        return self.json["meshes"][0]["primitives"]

    def attribute(self, name: str, primitive: int = 0) -> Any:
        return self.accessor(self.primitives[primitive]["attributes"][name])

    def places(self, primitive: int = 0) -> Any:
        """Positions as the node has them."""
        node = self.json["nodes"][0]
        matrix = np.array(node.get("matrix", np.eye(4).ravel())).reshape(4, 4).T
        matrix[:3, 3] += node.get("translation", [0, 0, 0])
        return self.attribute("POSITION", primitive).astype(float) @ matrix[:3, :3].T + matrix[:3, 3]

    def triangles(self, primitive: int = 0) -> Any:
        return self.accessor(self.primitives[primitive]["indices"]).reshape(-1, 3)


def checked(mesh: meshhier.Mesh, path: Path) -> Glb:
    """The GLB of a mesh, after others have judged it."""
    data = mesh.to_gltf()
    path.mkdir(exist_ok=True)
    (path / "a.glb").write_bytes(data)
    if shutil.which("node") and VALIDATE.exists():
        run = subprocess.run(["node", str(VALIDATE), str(path)], capture_output=True, text=True)
        assert run.returncode in (0, 77), run.stdout + run.stderr  # 77: the validator is not installed
    try:
        import trimesh
    except ImportError:
        return Glb(data)
    if len(mesh.triangles) == 0:
        return Glb(data)
    scene = trimesh.load(io.BytesIO(data), file_type="glb", process=False)
    assert sum(len(geometry.faces) for geometry in scene.geometry.values()) == len(mesh.triangles)
    places = Glb(data).places()
    assert np.allclose(scene.dump()[0].vertices, places, atol=1e-6 * np.ptp(places))
    return Glb(data)


def test_it_has_all_of_the_mesh(labelled: str, built: Any, tmp_path: Path) -> None:
    for level, options in (({"level": 1}, {}), ({}, {"up": "z"})):
        mesh = meshhier.open(built(labelled, f"glb{len(options)}.hier", partition__vertices=300, **options)).cut(**level)
        glb = checked(mesh, tmp_path)
        x, y, z = mesh.positions.T
        assert (glb.places() == np.stack([x, z, -y] if options else [x, y, z], 1)).all()
        assert (glb.triangles() == mesh.triangles).all()
        assert glb.json["accessors"][0]["max"] == glb.attribute("POSITION").max(axis=0).tolist()
        quality, part = glb.attribute("_QUALITY"), glb.attribute("_PART")
        is_missing = np.isnan(mesh.attributes["quality"])
        assert is_missing.any() and (quality == np.where(is_missing, np.float32(-3.4028234663852886e38), mesh.attributes["quality"])).all()
        assert part.dtype == np.float32 and (part == mesh.attributes["part"]).all()
        assert np.allclose(glb.attribute("_TIME"), mesh.attributes["time"], rtol=1e-7)


def test_colours_are_light(torus: str, built: Any, tmp_path: Path) -> None:
    mesh = meshhier.open(built(torus, "plain.hier")).cut(level=1)
    glb = checked(mesh, tmp_path)
    assert mesh.colours is not None and mesh.normals is not None
    screen = mesh.colours / 255
    light = np.where(screen <= 0.04045, screen / 12.92, ((screen + 0.055) / 1.055) ** 2.4)
    assert np.abs(glb.attribute("COLOR_0") - light).max() < 1e-5
    assert np.abs(glb.attribute("NORMAL") - mesh.normals).max() < 1e-3
    mesh.conventions = meshhier.Conventions(linear_colours=True)
    assert np.abs(Glb(mesh.to_gltf()).attribute("COLOR_0") - screen).max() == 0


def test_pictures_have_materials(meshgen: str, built: Any, tmp_path: Path) -> None:
    subprocess.run([meshgen, "textured", "--triangles", "5000", "--side", "256", "--charts", "16", "-o", str(tmp_path / "t.obj")], check=True, stdout=subprocess.DEVNULL)
    for form in ("jpeg", "webp"):
        mesh = meshhier.open(built(str(tmp_path / "t.obj"), f"glb_{form}.hier", partition__vertices=700, texture__format=form)).cut()
        glb = checked(mesh, tmp_path / form)
        assert len(glb.primitives) == len(mesh.images) > 2 and mesh.texcoords is not None
        for number, primitive in enumerate(glb.primitives):
            material = glb.json["materials"][primitive["material"]]
            texture = glb.json["textures"][material["pbrMetallicRoughness"]["baseColorTexture"]["index"]]
            source = texture["source"] if form == "jpeg" else texture["extensions"]["EXT_texture_webp"]["source"]
            image = glb.json["images"][source]
            data = mesh.images[number]
            assert image["mimeType"] == f"image/{form}" and glb.view(image["bufferView"]) == data
            corners = mesh.triangles[mesh.triangle_tiles == number]
            assert np.allclose(glb.places(number)[glb.triangles(number)], mesh.positions[corners], atol=1e-6)
            assert (glb.attribute("TEXCOORD_0", number)[glb.triangles(number)] == mesh.texcoords[corners]).all()
        assert ("KHR_materials_unlit" in glb.json["extensionsUsed"]) == mesh.conventions.unlit


def test_far_away_it_is_as_fine(tmp_path: Path) -> None:
    positions = np.array([[3.5e6 + 0.001, 5.4e6, 0], [3.5e6 + 0.002, 5.4e6, 0], [3.5e6, 5.4e6 + 0.001, 7]])
    for up in ("y", "z"):
        mesh = meshhier.Mesh(positions, np.array([[0, 1, 2]]), conventions=meshhier.Conventions(up=up))
        x, y, z = positions.T
        assert np.abs(checked(mesh, tmp_path).places() - np.stack([x, z, -y] if up == "z" else [x, y, z], 1)).max() < 1e-7


def test_what_gltf_does_not_allow(tmp_path: Path) -> None:
    bad = np.array([[0, 0, 0], [np.nan, 0, 1], [0, 0, 5]], np.float32)
    mesh = meshhier.Mesh(
        np.eye(3),
        np.array([[0, 1, 2]]),
        normals=bad,
        colours=np.array([[2, -1, np.nan]] * 3, np.float32),
        texcoords=np.array([[np.inf, 0]] * 3, np.float32),
        attributes={"a b": np.array([1, 2, 300], np.uint16), "A/B": np.array([1e300, -np.inf, 0]), "color_0": np.array([-1, 0, 1], np.int8), "_x": np.arange(3)},
    )
    glb = checked(mesh, tmp_path)
    assert glb.attribute("NORMAL").tolist() == [[0, 0, 1]] * 3 and glb.attribute("COLOR_0")[:, 0].tolist() == [1, 1, 1]
    assert glb.attribute("TEXCOORD_0").tolist() == [[0, 0]] * 3
    assert glb.attribute("_A_B").tolist() == [1, 2, 300] and (np.abs(glb.attribute("_A_B_2")[:2]) > 3e38).all()
    assert glb.attribute("_COLOR_0_2").tolist() == [-1, 0, 1] and glb.attribute("_X").tolist() == [0, 1, 2]
    mesh.positions[0, 0] = np.nan
    with pytest.raises(meshhier.UsageError, match="not finite"):
        mesh.to_gltf()
    checked(meshhier.Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int64)), tmp_path)
    points = checked(meshhier.Mesh(np.eye(3), np.zeros((0, 3), np.int64)), tmp_path)
    assert points.primitives[0]["mode"] == 0
