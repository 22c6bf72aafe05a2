# SPDX-License-Identifier: MIT
"""The programs of examples/ draw the cuts that this package reads."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ply import read_ply, triangle_set

import meshhier

EXAMPLES = Path(__file__).parents[2] / "examples"
FORMS = {"plain.hier": {}, "early.hier": {"partition__count": 11}, "rounded.hier": {"storage__positions__bits": 14}}


def errors_of(hierarchy: meshhier.Hierarchy) -> list[float]:
    """Of the finest cut, one that mixes levels, and the root."""
    return [0.0, float(np.mean([hierarchy.error(meshhier.Node(1, i)) for i in (0, 1)])), 1e30]


@pytest.fixture(scope="session")
def read_cut(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The C++ example, built outside of the tree by its own CMakeLists.txt."""
    if shutil.which("cmake") is None:
        pytest.skip("cmake is not there")
    folder = tmp_path_factory.mktemp("read_cut")
    for command in (["cmake", "-S", str(EXAMPLES / "cpp"), "-B", str(folder), "-DCMAKE_BUILD_TYPE=None"], ["cmake", "--build", str(folder)]):
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return str(folder / "read_cut")


@pytest.mark.parametrize("name", FORMS)
def test_the_cpp_example(name: str, read_cut: str, torus: str, built: Any, tmp_path: Path) -> None:
    hierarchy = meshhier.open(built(torus, name, **FORMS[name]))
    for error in errors_of(hierarchy):
        subprocess.run([read_cut, hierarchy.path, repr(error), str(tmp_path / "cut.ply")], check=True, stdout=subprocess.DEVNULL)
        rows, triangles = read_ply(str(tmp_path / "cut.ply"))
        mesh = hierarchy.cut(error=error)
        theirs = triangle_set(triangles, np.stack([rows[axis] for axis in "xyz"], 1))
        assert len(theirs) == len(mesh.triangles)
        assert (theirs == triangle_set(mesh.triangles, mesh.positions)).all()


def test_the_cpp_example_refuses_what_it_cannot_read(read_cut: str, torus: str, built: Any, tmp_path: Path) -> None:
    packed = built(torus, "packed.hier", storage__compression="meshopt_zlib")
    for path in (packed, str(tmp_path)):
        run = subprocess.run([read_cut, path, "0", str(tmp_path / "cut.ply")], capture_output=True, text=True)
        assert run.returncode == 1 and run.stderr.startswith("read_cut: ")


@pytest.mark.skipif(shutil.which("node") is None, reason="node is not there")
@pytest.mark.parametrize("name", FORMS)
def test_the_example_for_browsers(name: str, torus: str, built: Any, tmp_path: Path) -> None:
    hierarchy = meshhier.open(built(torus, name, **FORMS[name]))
    for error in errors_of(hierarchy):
        subprocess.run(["node", str(EXAMPLES / "cut.mjs"), hierarchy.path, repr(error), str(tmp_path / "cut")], check=True, stdout=subprocess.DEVNULL)
        corners = np.fromfile(tmp_path / "cut", "<f4").reshape(-1, 3).astype(np.float64) + hierarchy.origin
        mesh = hierarchy.cut(error=error)
        theirs = triangle_set(np.arange(len(corners)).reshape(-1, 3), corners)
        assert len(theirs) == len(mesh.triangles)
        assert (theirs == triangle_set(mesh.triangles, mesh.positions)).all()


def test_they_are_as_short_as_they_say() -> None:
    """Lines that are neither blank nor a comment."""
    lines = [line.strip() for name in ("engine.html", "seams.js") for line in (EXAMPLES / name).read_text().splitlines()]
    assert sum(bool(line) and not line.startswith("//") for line in lines) < 200
