# SPDX-License-Identifier: MIT
"""What a hierarchy says of itself, and what is refused."""

from __future__ import annotations

import functools
import json
import operator
import shutil
import struct
from pathlib import Path
from typing import Any, Callable, Iterator

import numpy as np
import pytest

import meshhier
from meshhier.checksum import checksum
from meshhier.manifest import read_manifest
from meshhier.tile import read_tile


def test_it_tells_what_it_is(torus: str, built: Any) -> None:
    with meshhier.open(built(torus, "plain.hier")) as hierarchy:
        assert hierarchy.levels == hierarchy.tree.depth + 1
        assert hierarchy.errors[-1] == 0 and (np.diff(hierarchy.errors) < 0).all()
        low, high = hierarchy.bounds
        assert (low < high).all()
        root = meshhier.Node(0, 0)
        assert 0 < hierarchy.error(root) <= hierarchy.bound(root)
        assert (hierarchy.tile_bounds(root)[0] >= low - 0.1).all()
        assert "20736 triangles" in repr(hierarchy)


def test_it_tells_how_it_is_shown(torus: str, built: Any) -> None:
    with meshhier.open(built(torus, "plain.hier")) as hierarchy:
        assert hierarchy.view == {}
    with meshhier.open(built(torus, "viewed.hier", view__light="raking", view__stretch=2)) as hierarchy:
        assert hierarchy.view == {"light": "raking", "stretch": 2}


def test_tiles_come_one_by_one(torus: str, built: Any) -> None:
    hierarchy = meshhier.open(built(torus, "early.hier", partition__count=11))
    for level in range(hierarchy.levels):
        tiles = list(hierarchy.iter_tiles(level))
        assert [tile.node for tile in tiles] == hierarchy.tree.level(level)
    tiles = list(hierarchy.iter_tiles())
    assert len(tiles) == 11 and sum(tile.own for tile in tiles) == hierarchy.vertices
    for tile in tiles:
        assert tile.triangles.max() < len(tile.positions)
        assert len(tile.chains) == len(tile.neighbours)


def test_the_tree_is_that_of_the_index(torus: str, built: Any) -> None:
    hierarchy = meshhier.open(built(torus, "early.hier", partition__count=11))
    assert list(hierarchy.tree.tiles()) == [meshhier.Node(int(r["level"]), int(r["index"])) for r in hierarchy._index.records]
    for node in hierarchy.tree.tiles():
        for child in hierarchy.tree.children(node):
            assert hierarchy.tree.ancestor(child, node.level) == node


@pytest.mark.parametrize("options", [{"level": -1}, {"level": 99}, {"level": 1, "error": 1.0}, {"error": -1.0}, {"error": float("nan")}, {"nodes": [(1, 0)]}, {"nodes": [(1, 0), (0, 0)]}, {"nodes": [(9, 9)]}])
def test_what_makes_no_sense_is_refused(options: Any, torus: str, built: Any) -> None:
    with pytest.raises(meshhier.UsageError):
        meshhier.open(built(torus, "plain.hier")).cut(**options)


def test_what_is_no_hierarchy_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.3tz").write_bytes(b"no archive")
    (tmp_path / "b.hier").mkdir()
    (tmp_path / "b.hier" / "hierarchy.json").write_text('{"format": "else"}')
    (tmp_path / "c.hier").mkdir()
    (tmp_path / "c.hier" / "hierarchy.json").write_text('{"format": "meshhier", "format_version": 99}')
    for name in ("none.hier", "a.3tz", "b.hier", "c.hier", "."):
        with pytest.raises(meshhier.NotAHierarchyError):
            meshhier.open(tmp_path / name)


@pytest.mark.parametrize("compression", ["none", "meshopt_zlib"])
def test_damage_is_an_error_of_its_own(compression: str, torus: str, built: Any, tmp_path: Path) -> None:
    """Any byte of a tile: what comes is arrays or CorruptError, and nothing else."""
    whole = Path(built(torus, f"{compression}.hier", storage__compression=compression))
    shutil.copytree(whole, tmp_path / "a.hier")
    name = tmp_path / "a.hier" / "tiles" / "01" / "000000.glb"
    data = name.read_bytes()
    random = np.random.default_rng(7)
    hierarchy = meshhier.open(tmp_path / "a.hier")
    for at in [*range(0, 40), *random.integers(0, len(data), 300).tolist()]:
        damaged = bytearray(data)
        damaged[at] ^= int(random.integers(1, 256))
        name.write_bytes(damaged)
        try:
            hierarchy.read_tile(meshhier.Node(1, 0))
        except meshhier.CorruptError:
            pass
    name.write_bytes(data[: len(data) // 2])
    with pytest.raises(meshhier.CorruptError):
        hierarchy.cut(level=1)
    name.unlink()
    with pytest.raises(meshhier.CorruptError, match="missing"):
        hierarchy.cut(level=1)


def _places(value: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Where something stands in JSON; of lists the first."""
    if place:
        yield place
    keys = list(value) if isinstance(value, dict) else range(min(len(value), 1)) if isinstance(value, list) else []
    for key in keys:
        yield from _places(value[key], (*place, key))


def _forged(text: Any) -> Iterator[bytes]:
    """JSON with something else at each place, or nothing."""
    whole = json.dumps(text)
    for *way, last in _places(text):
        for wrong in (None, 2**70, 1.5, "x" * 5000, {}, ...):
            forged = json.loads(whole)
            place = functools.reduce(operator.getitem, way, forged)
            if wrong is ...:
                del place[last]
            else:
                place[last] = wrong
            yield _sealed(forged)
    yield b"[" * 100_000


def _sealed(text: Any) -> bytes:
    """JSON as a manifest is written, with the checksum that it has; of what has none, as it is."""
    data = json.dumps(text, indent=2).encode() + b"\n"
    end = b'"\n}\n'
    if not isinstance(text.get("checksum"), str) or len(text["checksum"]) != 16 or not data.endswith(end):
        return data
    head = data[: -len(end) - 16]
    return head + b"%016x" % checksum(head + b"0" * 16 + end) + end


def _refused(read: Callable[[], object]) -> int:
    """1 if it is refused, in few words; 0 if it is read."""
    try:
        read()
    except (meshhier.CorruptError, meshhier.NotAHierarchyError) as error:
        assert len(str(error)) < 600
        return 1
    return 0


@pytest.mark.filterwarnings("ignore:invalid value")
@pytest.mark.parametrize("compression", ["none", "meshopt"])
def test_a_tile_that_lies_is_refused(compression: str, torus: str, built: Any) -> None:
    place = Path(built(torus, f"{compression}.hier", storage__compression=compression))
    manifest = read_manifest((place / "hierarchy.json").read_bytes(), "a.hier")
    data = (place / "tiles" / "01" / "000000.glb").read_bytes()
    end = 20 + int.from_bytes(data[12:16], "little")

    def glb(text: bytes) -> bytes:
        return struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(data) - end, len(text), 0x4E4F534A) + text + data[end:]

    assert read_tile(data, meshhier.Node(1, 0), manifest) == read_tile(glb(data[20:end]), meshhier.Node(1, 0), manifest)
    assert sum(_refused(lambda: read_tile(glb(text), meshhier.Node(1, 0), manifest)) for text in _forged(json.loads(data[20:end]))) > 200


def test_a_manifest_that_lies_is_refused(tiny: str, built: Any, tmp_path: Path) -> None:
    """What is opened says what it is."""
    place = tmp_path / "a.hier"
    shutil.copytree(built(tiny, "tiny.hier"), place)
    text = (place / "hierarchy.json").read_bytes()

    def tell() -> str:
        with meshhier.open(place) as hierarchy:
            return f"{hierarchy} {hierarchy.bounds} {hierarchy.origin} {hierarchy.errors} {hierarchy.scalars} {hierarchy.read_tile((0, 0))}"

    refused = 0
    for forged in _forged(json.loads(text)):
        (place / "hierarchy.json").write_bytes(forged)
        with np.printoptions(threshold=6, edgeitems=1):
            refused += _refused(tell)
    assert refused > 100


def test_a_manifest_that_was_changed_is_told(tiny: str, built: Any, tmp_path: Path) -> None:
    place = tmp_path / "a.hier"
    shutil.copytree(built(tiny, "tiny.hier"), place)
    text = (place / "hierarchy.json").read_bytes()
    assert _sealed(json.loads(text)) == text
    vertices = b'"vertices": %d' % meshhier.open(place).vertices
    for changed, said in (
        (text.replace(vertices, vertices[:-1] + b"%d" % (9 - int(vertices[-1:]))), "another checksum"),
        (text.replace(b'"\n}\n', b'"\n}\n\n'), "does not end with its checksum"),
        (json.dumps(json.loads(text)).encode(), "does not end with its checksum"),
    ):
        assert changed != text
        (place / "hierarchy.json").write_bytes(changed)
        with pytest.raises(meshhier.CorruptError, match=said):
            meshhier.open(place)


def test_what_others_call_it(torus: str, built: Any) -> None:
    mesh = meshhier.open(built(torus, "plain.hier")).cut(level=1)
    for module, convert in (("trimesh", mesh.to_trimesh), ("pyvista", mesh.to_pyvista), ("open3d", mesh.to_open3d)):
        try:
            __import__(module)
        except ImportError:
            print(f"skipped: {module} is not there")
            continue
        assert convert() is not None


def test_a_ply_of_it_is_read_back(torus: str, built: Any, tmp_path: Path) -> None:
    mesh = meshhier.open(built(torus, "plain.hier")).cut(level=1)
    mesh.write_ply(str(tmp_path / "a.ply"))
    again = meshhier.build(tmp_path / "a.ply", tmp_path / "a.hier").cut()
    assert len(again.triangles) == len(mesh.triangles)
    assert np.allclose(np.sort(again.positions, axis=0), np.sort(mesh.positions, axis=0))
