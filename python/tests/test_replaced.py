# SPDX-License-Identifier: MIT
"""Hierarchies that another build takes the place of while they are read."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import meshhier
from meshhier.checksum import checksum


def grid(path: Path, side: int, colour: tuple[int, int, int]) -> str:
    """A wavy square of one colour."""
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(side), np.arange(side), indexing="ij"))
    vertices = np.zeros(side * side, [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("red", "u1"), ("green", "u1"), ("blue", "u1")])
    vertices["x"], vertices["y"], vertices["z"] = x, y, np.sin(x / 5) * np.cos(y / 7)
    vertices["red"], vertices["green"], vertices["blue"] = colour
    a = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    corners = np.concatenate([np.stack([a, a + side, a + 1], 1), np.stack([a + 1, a + side, a + side + 1], 1)])
    faces = np.zeros(len(corners), [("n", "u1"), ("corners", "<i4", 3)])
    faces["n"], faces["corners"] = 3, corners
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
    header += "".join(f"property float {axis}\n" for axis in "xyz") + "".join(f"property uchar {name}\n" for name in ("red", "green", "blue"))
    header += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    path.write_bytes(header.encode() + vertices.tobytes() + faces.tobytes())
    return str(path)


@pytest.fixture(scope="module")
def builds(tmp_path_factory: pytest.TempPathFactory, built: Any) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("grids")
    red = grid(folder / "red.ply", 60, (200, 0, 0))
    blue = grid(folder / "blue.ply", 60, (0, 0, 200))
    small = grid(folder / "small.ply", 30, (0, 0, 200))
    return {name: Path(built(mesh, f"replaced_{name}.hier", partition__vertices=200)) for name, mesh in (("red", red), ("blue", blue), ("small", small))}


def put(build: Path, place: Path) -> None:
    if place.exists():
        place.rename(place.with_suffix(".old"))
        shutil.rmtree(place.with_suffix(".old"))
    shutil.copytree(build, place)


@pytest.mark.parametrize("other", ["blue", "small"])
def test_two_builds_are_never_one_mesh(other: str, builds: dict[str, Path], tmp_path: Path) -> None:
    place = tmp_path / "a.hier"
    put(builds["red"], place)
    with meshhier.open(place) as hierarchy:
        tiles = hierarchy.iter_tiles()
        next(tiles)
        put(builds[other], place)
        with pytest.raises(meshhier.ReplacedError, match="open it again"):
            for _ in tiles:
                pass
        with pytest.raises(meshhier.ReplacedError):
            hierarchy.cut(level=1)
    mesh = meshhier.open(place).cut()
    assert len(np.unique(mesh.colours, axis=0)) == 1


def test_a_replacement_while_it_is_opened_is_told(builds: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    place = tmp_path / "a.hier"
    put(builds["red"], place)
    from meshhier.storage import Folder

    read = Folder.read

    def read_and_replace(self: Folder, name: str) -> bytes:
        data = read(self, name)
        if name == "hierarchy.json" and "done" not in vars(self):
            vars(self)["done"] = True
            put(builds["blue"], place)
        return data

    monkeypatch.setattr(Folder, "read", read_and_replace)
    with pytest.raises(meshhier.ReplacedError):
        meshhier.open(place)


def test_damage_is_something_else(builds: dict[str, Path], tmp_path: Path) -> None:
    place = tmp_path / "a.hier"
    put(builds["red"], place)
    hierarchy = meshhier.open(place)
    tile = place / "tiles" / "01" / "000000.glb"
    data = bytearray(tile.read_bytes())
    data[-5] ^= 1
    tile.write_bytes(data)
    with pytest.raises(meshhier.CorruptError, match="damaged"):
        hierarchy.read_tile(meshhier.Node(1, 0))
    index = bytearray((place / "tiles.bin").read_bytes())
    index[100] ^= 1
    (place / "tiles.bin").write_bytes(index)
    with pytest.raises(meshhier.CorruptError, match="tiles.bin"):
        meshhier.open(place)


def test_checksums_are_those_of_the_program(builds: dict[str, Path]) -> None:
    hierarchy = meshhier.open(builds["red"])
    outline = (builds["red"] / "outline.glb").read_bytes()
    assert f"{checksum(outline):016x}" == hierarchy.manifest["outline"]["checksum"]
    known = {0: "2d06800538d394c2", 3: "32dbb5c7774cc94f", 8: "90b760c9d253d0ff", 16: "372c92fa68129c98", 128: "c59e505a97d029e0", 240: "967597e635f3c527", 241: "d6afac6f8fa85b01", 1089: "b6e2a9bc2973e16a"}
    data, state = bytearray(), 1
    for _ in range(1089):
        state = (state * 1664525 + 1013904223) & 0xFFFFFFFF
        data.append(state >> 24)
    for length, expected in known.items():
        assert f"{checksum(bytes(data[:length])):016x}" == expected
