# SPDX-License-Identifier: MIT
"""Archives of directories have the bytes of archives that are built."""

from __future__ import annotations

import os
import shutil
import struct
import warnings
import zipfile
from pathlib import Path
from typing import Any, Callable

import pytest
from host import Host

import meshhier
from meshhier import packing

FORMS: list[tuple[str, dict[str, object]]] = [("torus", {}), ("tiny", {"partition__vertices": 8, "preview": True}), ("torus", {"storage__compression": "meshopt_zlib"})]


def files_of(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("number", range(len(FORMS)))
def test_it_has_the_bytes_of_a_build(number: int, built: Any, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    name, settings = FORMS[number]
    mesh = request.getfixturevalue(name)
    folder, archive = (Path(built(mesh, f"packing{number}{ending}", **settings)) for ending in (".hier", ".3tz"))
    assert meshhier.pack(folder, tmp_path / "a.3tz").read_bytes() == archive.read_bytes()
    assert files_of(meshhier.unpack(archive, tmp_path / "a.hier")) == files_of(folder)
    meshhier.verify(tmp_path / "a.hier", input=mesh)
    assert sorted(os.listdir(tmp_path)) == ["a.3tz", "a.hier"]


def test_objects_come_along(tmp_path: Path) -> None:
    lines = [f"v {i} 0 0\nv {i}.5 0 0\nv {i} 1 0\ng house {i:04}\nf {3 * i + 1} {3 * i + 2} {3 * i + 3}\n" for i in range(400)]
    (tmp_path / "a.obj").write_text("".join(lines))
    for name in ("a.hier", "a.3tz"):
        meshhier.build(tmp_path / "a.obj", tmp_path / name, objects="group").close()
    assert (tmp_path / "a.hier" / "object_words.bin").exists()
    assert meshhier.pack(tmp_path / "a.hier", tmp_path / "b.3tz").read_bytes() == (tmp_path / "a.3tz").read_bytes()


def test_large_archives_have_the_records_of_zip64(torus: str, built: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As if 2 MB were 4 GiB, and 20 files 65,535."""
    monkeypatch.setattr(packing, "_FULL16", 20)
    made = meshhier.pack(built(torus, "packing0.hier"), tmp_path / "a.3tz")
    data = made.read_bytes()
    assert data[-98:-94] == b"PK\6\6" and data[-42:-38] == b"PK\6\7"
    end = bytearray(data)
    end[-14:-10] = b"\xff\xff\xff\xff"  # the numbers of files, as they are where there are so many
    made.write_bytes(end)
    with zipfile.ZipFile(made) as archive:
        assert archive.testzip() is None and len(archive.namelist()) > 20
    entry = packing._Entry(b"a", 5 << 32, 3, 7)
    assert entry.central_header()[-12:] == b"\1\0\x08\0" + (5 << 32).to_bytes(8, "little") and entry.local_header()[4] == 45


def test_nothing_is_replaced_by_chance(torus: str, built: Any, tmp_path: Path) -> None:
    folder, archive = built(torus, "packing0.hier"), built(torus, "packing0.3tz")
    meshhier.pack(folder, tmp_path / "a.3tz")
    meshhier.unpack(archive, tmp_path / "a.hier")
    with pytest.raises(meshhier.ExistsError, match="force=True"):
        meshhier.pack(folder, tmp_path / "a.3tz")
    with pytest.raises(FileExistsError):
        meshhier.unpack(archive, tmp_path / "a.hier")
    assert meshhier.pack(folder, tmp_path / "a.3tz", force=True) and meshhier.unpack(archive, tmp_path / "a.hier", force=True)
    (tmp_path / "photos").mkdir()
    with pytest.raises(meshhier.ExistsError, match="no hierarchy"):
        meshhier.unpack(archive, tmp_path / "photos", force=True)
    assert os.stat(tmp_path / "a.hier").st_mode == os.stat(tmp_path / "photos").st_mode
    assert sorted(os.listdir(tmp_path)) == ["a.3tz", "a.hier", "photos"]


def test_what_makes_no_sense(torus: str, built: Any, tmp_path: Path) -> None:
    folder, archive = built(torus, "packing0.hier"), built(torus, "packing0.3tz")
    calls: list[Callable[[], object]] = [
        lambda: meshhier.pack(archive, tmp_path / "a.3tz"),
        lambda: meshhier.pack(folder, tmp_path / "a.zip"),
        lambda: meshhier.unpack(folder, tmp_path / "a.hier"),
        lambda: meshhier.pack(None, tmp_path / "a.3tz"),  # type: ignore[arg-type]
        lambda: meshhier.pack(folder, b"a.3tz"),  # type: ignore[arg-type]
    ]
    for wrong in calls:
        with pytest.raises(meshhier.UsageError):
            wrong()
    with pytest.raises(meshhier.NotAHierarchyError):
        meshhier.pack(tmp_path / "none.hier", tmp_path / "a.3tz")
    with pytest.raises(meshhier.FileError, match="none/a.3tz: there is no folder"):
        meshhier.pack(folder, tmp_path / "none" / "a.3tz")
    with pytest.raises(meshhier.FileError, match="none/a.hier: there is no folder"):
        meshhier.unpack(archive, tmp_path / "none" / "a.hier")
    shutil.copytree(folder, tmp_path / "b.hier")
    (tmp_path / "b.hier" / "outline.glb").unlink()
    with pytest.raises(meshhier.CorruptError, match="outline.glb is missing"):
        meshhier.pack(tmp_path / "b.hier", tmp_path / "b.3tz")
    assert os.listdir(tmp_path) == ["b.hier"]


def test_what_the_system_refuses_is_an_error_of_the_package(torus: str, built: Any, tmp_path: Path) -> None:
    folder, archive = built(torus, "packing0.hier"), built(torus, "packing0.3tz")
    closed = Path("/sys")  # also to root
    mesh = meshhier.open(folder).cut(level=0)
    calls: dict[str, Callable[[Path], object]] = {
        "a.3tz": lambda path: meshhier.pack(folder, path),
        "a.hier": lambda path: meshhier.unpack(archive, path),
        "a.ply": mesh.write_ply,
    }
    for name, call in calls.items():
        with pytest.raises(meshhier.FileError) as failed:
            call(closed / name)
        number = failed.value.errno
        assert number is not None and str(failed.value) == f"/sys/{name}: {os.strerror(number)}"
        assert isinstance(failed.value, OSError) and failed.value.exit_code == 4


@pytest.mark.parametrize("name", ["../out", "/etc/x", "tiles//a", "a\\b", "C:/x y"])
def test_archives_that_want_to_write_elsewhere(name: str, torus: str, built: Any, tmp_path: Path) -> None:
    evil = tmp_path / "evil.3tz"
    shutil.copy(built(torus, "packing0.3tz"), evil)
    with zipfile.ZipFile(evil, "a") as archive:
        archive.writestr(name, b"x")
    with pytest.raises(meshhier.CorruptError, match="no name"):
        meshhier.unpack(evil, tmp_path / "a.hier")
    assert os.listdir(tmp_path) == ["evil.3tz"] and not (tmp_path.parent / "out").exists()


def _with_flag(data: bytearray, flag: int) -> None:
    """Sets a flag of the first file in the directory."""
    data[data.index(b"PK\1\2") + 8] |= flag


def _with_place(data: bytearray, _: int) -> None:
    """Lets the directory begin a byte later, so that all files would begin before."""
    end = data.rindex(b"PK\5\6") + 16
    struct.pack_into("<I", data, end, struct.unpack_from("<I", data, end)[0] + 1)


def _without_name(data: bytearray, _: int) -> None:
    """Makes the name of the first file, hierarchy.json, its extra field."""
    at = data.index(b"PK\1\2")
    data[at : at + 60] = data[at : at + 28] + bytes(2) + (14).to_bytes(2, "little") + data[at + 32 : at + 60]


@pytest.mark.parametrize("change, value", [(_with_flag, 1), (_with_flag, 32), (_with_flag, 64), (_with_place, 0), (_without_name, 0)])
def test_directories_that_lie(change: Any, value: int, torus: str, built: Any, tmp_path: Path) -> None:
    data = bytearray(Path(built(torus, "packing0.3tz")).read_bytes())
    change(data, value)
    (tmp_path / "a.3tz").write_bytes(data)
    with pytest.raises((meshhier.CorruptError, meshhier.NotAHierarchyError)):
        meshhier.unpack(tmp_path / "a.3tz", tmp_path / "a.hier")
    assert os.listdir(tmp_path) == ["a.3tz"]


@pytest.mark.parametrize("name", ["hierarchy.json", "tiles", "tiles.bin/x"])
def test_names_that_are_in_an_archive_twice(name: str, torus: str, built: Any, tmp_path: Path) -> None:
    twice = tmp_path / "a.3tz"
    shutil.copy(built(torus, "packing0.3tz"), twice)
    with zipfile.ZipFile(twice) as archive:
        data = archive.read("hierarchy.json")
    with zipfile.ZipFile(twice, "a") as archive, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        archive.writestr(name, data)
    with pytest.raises(meshhier.CorruptError, match="twice"):
        meshhier.unpack(twice, tmp_path / "a.hier")
    assert os.listdir(tmp_path) == ["a.3tz"]


def test_an_archive_on_the_web(torus: str, built: Any, tmp_path: Path) -> None:
    archive = Path(built(torus, "packing0.3tz"))
    with Host(archive.parent) as host:
        made = meshhier.unpack(f"{host.address}/{archive.name}", tmp_path / "a.hier")
    assert files_of(made) == files_of(archive.with_suffix(".hier"))


def test_open_ones_stay_open(torus: str, built: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = Path(built(torus, "packing0.hier"))
    monkeypatch.chdir(folder.parent)
    with meshhier.open(folder.name) as source:
        monkeypatch.chdir(tmp_path)
        with meshhier.open(meshhier.pack(source, "a.3tz")) as packed:
            assert files_of(meshhier.unpack(packed, "a.hier")) == files_of(folder)
            assert packed.cut(level=0) == source.cut(level=0)


def test_damage_is_found(torus: str, built: Any, tmp_path: Path) -> None:
    data = bytearray(Path(built(torus, "packing0.3tz")).read_bytes())
    data[len(data) // 2] ^= 1
    (tmp_path / "a.3tz").write_bytes(data)
    with pytest.raises(meshhier.CorruptError):
        meshhier.unpack(tmp_path / "a.3tz", tmp_path / "a.hier")
    assert os.listdir(tmp_path) == ["a.3tz"]
