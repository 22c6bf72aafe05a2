# SPDX-License-Identifier: MIT
"""The program, as functions."""

from __future__ import annotations

import subprocess
import warnings
from pathlib import Path

import pytest

import meshhier


def test_its_version_is_that_of_the_package() -> None:
    said = subprocess.run([meshhier.find_program(), "--version"], check=True, capture_output=True, text=True).stdout
    assert said.split()[1] == meshhier.__version__


def test_a_build_tells_how_far_it_is(torus: str, tmp_path: Path) -> None:
    told: list[meshhier.Progress] = []
    hierarchy = meshhier.build(torus, tmp_path / "a.hier", settings={"memory_budget": "256MiB", "threads": 1}, progress=told.append)
    assert hierarchy.triangles == 20736
    assert {"ingest", "simplify"} <= {one.stage for one in told}
    assert told[-1].job_done == pytest.approx(1, abs=0.1)
    meshhier.verify(hierarchy.path, input=torus)


def test_a_callback_stops_it_and_it_goes_on(torus: str, tmp_path: Path) -> None:
    def stop(progress: meshhier.Progress) -> None:
        raise KeyboardInterrupt

    settings = {"threads": 1, "partition.vertices": 200}  # the end is far
    with pytest.raises(KeyboardInterrupt):
        meshhier.build(torus, tmp_path / "a.hier", progress=stop, settings=settings)
    assert not (tmp_path / "a.hier").exists()
    assert meshhier.build(torus, tmp_path / "a.hier", settings=settings).triangles == 20736


def test_failures_have_types(tiny: str, tmp_path: Path) -> None:
    (tmp_path / "broken.ply").write_text("ply\nformat ascii 1.0\nelement vertex 1\n")
    with pytest.raises(meshhier.InputError, match="broken.ply") as broken:
        meshhier.build(tmp_path / "broken.ply", tmp_path / "a.hier")
    assert broken.value.exit_code == 3
    with pytest.raises(meshhier.InputError):
        meshhier.build(tmp_path / "broken.ply", tmp_path / "a.hier", progress=lambda _: None)
    with pytest.raises(meshhier.UsageError, match="no_such_key"):
        meshhier.build(tiny, tmp_path / "a.hier", settings={"no_such_key": 1})
    with pytest.raises(meshhier.BudgetError):
        meshhier.build(tiny, tmp_path / "a.hier", settings={"memory_budget": "1MiB"})
    hierarchy = meshhier.build(tiny, tmp_path / "a.hier")
    with pytest.raises(meshhier.ProgramError) as there:
        meshhier.build(tiny, tmp_path / "a.hier")
    assert there.value.exit_code == 5
    tile = tmp_path / "a.hier" / "tiles" / "00" / "000000.glb"
    tile.write_bytes(tile.read_bytes()[:-1] + b"x")
    with pytest.raises(meshhier.VerifyError, match="000000.glb"):
        meshhier.verify(hierarchy.path)


def test_a_program_that_is_not_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MESHHIER", "/nonexistent/meshhier")
    with pytest.raises(meshhier.ProgramNotFoundError):
        meshhier.verify("a.hier")
    monkeypatch.delenv("MESHHIER")
    monkeypatch.setenv("PATH", "/nonexistent")
    with pytest.raises(meshhier.ProgramNotFoundError, match="MESHHIER"):
        meshhier.find_program()


@pytest.fixture
def without_materials(tmp_path: Path) -> Path:
    """An OBJ whose library of materials is missing, most of whose triangles are degenerate."""
    path = tmp_path / "a.obj"
    path.write_text("mtllib none.mtl\nusemtl stone\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1 2 3\nf 2 4 3\nf 1 1 2\nf 1 1 3\nf 1 1 4\n")
    return path


def test_warnings_are_warnings_and_reach_a_callback(without_materials: Path, tmp_path: Path) -> None:
    told: list[str] = []
    with pytest.warns(meshhier.BuildWarning, match="none.mtl") as warned:
        meshhier.build(without_materials, tmp_path / "a.hier", warning=told.append).close()
    assert [str(one.message) for one in warned] == told and len(set(told)) == len(told)
    assert any("none.mtl" in one for one in told) and any("degenerate" in one for one in told)
    assert all(one.filename == __file__ for one in warned), "they point at who called build()"


def test_a_warning_that_is_an_error_stops_the_build(without_materials: Path, tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error", meshhier.BuildWarning)
        with pytest.raises(meshhier.BuildWarning, match="none.mtl"):
            meshhier.build(without_materials, tmp_path / "a.hier")
    with pytest.warns(meshhier.BuildWarning):
        assert meshhier.build(without_materials, tmp_path / "a.hier", force=True).triangles == 2


def test_a_build_without_a_fault_warns_of_nothing(tiny: str, tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        meshhier.build(tiny, tmp_path / "a.hier").close()


def test_names_that_begin_like_options_are_names(tiny: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "-o.ply").write_bytes(Path(tiny).read_bytes())
    meshhier.build("-o.ply", "--force.hier").close()
    meshhier.verify("--force.hier", input="-o.ply")
