# SPDX-License-Identifier: MIT
"""The README's examples run as they stand there, and their numbers are those of the mesh."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any
from unittest.mock import MagicMock

import numpy as np
import pytest
from ply import read_ply

import meshhier

README = Path(__file__).parents[1] / "README.md"


def area_of(positions: Any, triangles: Any) -> float:
    a, b, c = (positions[triangles[:, k]].astype(float) for k in range(3))
    return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def make_david(path: Path) -> None:
    """Moves and scales a mesh to where the README's David is: x and z about 0, y from 0 to 5200."""
    rows = read_ply(str(path))[0]
    low, high = rows["y"].min(), rows["y"].max()
    moved = rows.copy()
    for axis in "xyz":
        moved[axis] = (rows[axis] - (low if axis == "y" else 0)) * (5200 / (high - low))
    path.write_bytes(path.read_bytes().replace(rows.tobytes(), moved.tobytes()))


def test_its_examples_run_and_are_right(meshgen: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    make = [meshgen, "surface", "--shape", "torus", "--triangles", "135000", "--normals", "--colours", "-o", "david.ply"]
    subprocess.run(make, check=True, stdout=subprocess.DEVNULL)
    make_david(tmp_path / "david.ply")
    meshhier.build("david.ply", "scan.3tz", settings={"preview": False}).close()
    subprocess.run([meshgen, "city", "--buildings", "300", "-o", "city.obj"], check=True, stdout=subprocess.DEVNULL)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", meshhier.BuildWarning)
        meshhier.build("city.obj", "city.hier", settings={"objects.table": "city.csv", "partition.vertices": 400, "preview": False}).close()
    for module in ("trimesh", "pyvista", "open3d"):
        if importlib.util.find_spec(module) is None:
            monkeypatch.setitem(sys.modules, module, MagicMock())
    names: dict[str, Any] = {}
    for code in re.findall(r"```python\n(.*?)```", README.read_text(), re.DOTALL):
        exec(compile(code, str(README), "exec"), names)
    assert len(names) > 10 and "vertices" in capsys.readouterr().out
    rows, triangles = read_ply("david.ply")
    positions = np.stack([rows[axis] for axis in "xyz"], 1)
    assert names["area"] == pytest.approx(area_of(positions, triangles), rel=1e-9)
    assert names["mean_height"] == pytest.approx(positions[:, 2].mean(dtype=float), rel=1e-5, abs=1e-3)
    assert len(names["whole"].triangles) < len(triangles)
    assert all(0 < len(names[piece].triangles) < len(triangles) for piece in ("face", "garden"))
    assert names["coarse"] == names["david"].cut(error=0.5)
    assert meshhier.open("scan.3tz").read_tile("0/0").own > 0 and names["glb"][:4] == b"glTF"
    assert 0 < len(names["towers"].triangles) < len(names["mesh"].triangles)
    with pytest.raises(FileExistsError, match="force=True"):
        names["coarse"].write_ply(Path("coarse.ply"))
