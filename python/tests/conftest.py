# SPDX-License-Identifier: MIT
"""Hierarchies for the tests, made by the program that MESHHIER names; MESHGEN names the mesh generator."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from typing import Callable

import numpy as np
import pytest

import meshhier

Build = Callable[..., str]


@pytest.fixture(scope="session")
def meshgen() -> str:
    path = os.environ.get("MESHGEN", str(Path(meshhier.find_program()).with_name("meshgen")))
    assert os.path.exists(path), f"{path}: name the mesh generator by MESHGEN"
    return path


def _make_torus(meshgen: str, folder: Path, triangles: int) -> str:
    path = str(folder / "torus.ply")
    command = [meshgen, "surface", "--shape", "torus", "--triangles", str(triangles), "--normals", "--colours", "-o", path]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return path


@pytest.fixture(scope="session")
def torus(meshgen: str, tmp_path_factory: pytest.TempPathFactory) -> str:
    """A PLY of 20,736 triangles with normals and colours."""
    return _make_torus(meshgen, tmp_path_factory.mktemp("mesh"), 20000)


@pytest.fixture(scope="session")
def tiny(meshgen: str, tmp_path_factory: pytest.TempPathFactory) -> str:
    """The same of 2,304 triangles, for what looks at no tiles."""
    return _make_torus(meshgen, tmp_path_factory.mktemp("tiny"), 2000)


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> Build:
    """Builds a mesh once for each set of settings: built(mesh, name, key=value, ...) -> path. Names have copies of their own."""
    folder = tmp_path_factory.mktemp("built")
    known: dict[tuple[str, ...], str] = {}
    names: dict[str, tuple[str, ...]] = {}

    def build(mesh: str, name: str, **settings: object) -> str:
        path = str(folder / name)
        keys = {key.replace("__", "."): value for key, value in settings.items()}
        if "partition.count" not in keys:
            keys.setdefault("partition.vertices", 700)
        keys.setdefault("preview", False)  # half of the time that such a build takes
        content = (mesh, Path(name).suffix, repr(sorted(keys.items())))
        assert names.setdefault(path, content) == content, f"{name} is another hierarchy in another test"
        made = known.setdefault(content, path)
        if not os.path.exists(path):
            if made == path:
                meshhier.build(mesh, path, settings=keys).close()
            elif os.path.isdir(made):
                shutil.copytree(made, path)
            else:
                shutil.copy(made, path)
        return path

    return build


@pytest.fixture(scope="session")
def labelled(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A grid with heights, whose faces have a label and whose vertices have a quality, with NaN, and a time."""
    path = tmp_path_factory.mktemp("labelled") / "grid.ply"
    side = 60
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(side), np.arange(side), indexing="ij"))
    vertices = np.zeros(side * side, [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("quality", "<f4"), ("time", "<f8")])
    vertices["x"], vertices["y"], vertices["z"] = x, y, np.sin(x / 5) * np.cos(y / 7)
    vertices["quality"] = np.where(x % 7 == 3, np.nan, x / 10)
    vertices["time"] = 1.7e9 + x * 1e-3
    a = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    corners = np.concatenate([np.stack([a, a + side, a + 1], 1), np.stack([a + 1, a + side, a + side + 1], 1)])
    faces = np.zeros(len(corners), [("n", "u1"), ("corners", "<i4", 3), ("part", "<i4")])
    faces["n"], faces["corners"], faces["part"] = 3, corners, corners[:, 0] // side // 20 * 1000 - 500
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
    header += "".join(f"property {kind} {name}\n" for kind, name in zip(["float"] * 4 + ["double"], vertices.dtype.names))
    header += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nproperty int part\nend_header\n"
    path.write_bytes(header.encode() + vertices.tobytes() + faces.tobytes())
    return str(path)
