# SPDX-License-Identifier: MIT
"""What makes no sense is refused in words that help; what does is taken in any form. Files stay, processes share."""

from __future__ import annotations

import copy
import multiprocessing
import os
import pickle
import shutil
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import meshhier

NAN, INF = float("nan"), float("inf")


@pytest.fixture
def plain(torus: str, built: Any) -> meshhier.Hierarchy:
    return meshhier.open(built(torus, "plain.hier"))


@pytest.mark.parametrize("level", [1.5, 1.0, True, np.True_, "1", NAN, INF, -1, 99, (1,), np.float32(1)])
def test_a_level_is_a_whole_number(level: Any, plain: meshhier.Hierarchy) -> None:
    for call in (plain.cut, plain.iter_parts, plain.cut_nodes, plain.iter_tiles):
        with pytest.raises(meshhier.UsageError, match=f"a level is a whole number from 0, the coarsest, to {plain.levels - 1}, the original, not "):
            call(level=level)


@pytest.mark.parametrize("error", [-1, -1e-9, NAN, INF, True, "0.5", 1j, [1], np.array(1.0)])
def test_an_error_is_a_length(error: Any, plain: meshhier.Hierarchy) -> None:
    for call in (plain.cut, plain.iter_parts, plain.cut_nodes, plain.iter_tiles):
        with pytest.raises(meshhier.UsageError, match=r"an error is a length in input units, 0 or more \(of the coarsest tile, level=0\), not "):
            call(error=error)


def test_numbers_are_taken_in_any_form(plain: meshhier.Hierarchy) -> None:
    for level in (1, np.int64(1), np.uint8(1)):
        assert plain.cut(level=level) == plain.cut(level=1)
    for error in (0, 0.0, np.float32(0)):
        assert plain.cut(error=error) == plain.cut()
    assert [tile.node for tile in plain.iter_tiles(error=1e30)] == [(0, 0)]
    assert [tile.node for tile in plain.iter_tiles(1)] == [tile.node for tile in plain.iter_tiles(level=1)] == [(1, 0), (1, 1)]


@pytest.mark.parametrize(
    ("box", "why"),
    [
        (((0, 5, 0), (1, 4, 1)), "y goes from 5.0 back to 4.0"),
        (((0, 0, NAN), (1, 1, 1)), "smaller coordinates first, not"),
        (((INF, 0, 0), (INF, 1, 1)), "nothing lies where x is inf"),
        (((-INF, 0, 0), (-INF, 1, 1)), "nothing lies"),
        (((True, 0, 0), (True, 1, 1)), "not "),
        ((("0", "0", "0"), ("1", "1", "1")), "not "),
        (5, "not 5"),
    ],
)
def test_a_box_has_its_smaller_corner_first(box: Any, why: str, plain: meshhier.Hierarchy) -> None:
    for call in (plain.cut, plain.iter_parts, plain.cut_nodes):
        with pytest.raises(meshhier.UsageError, match=rf"a box is \(\(x, y, z\), \(x, y, z\)\).*{why}"):
            call(box=box)
    assert plain.cut(box=plain.bounds) == plain.cut(box=plain.bounds.tolist()) == plain.cut(box=tuple(plain.bounds))


def test_a_node_has_many_names(plain: meshhier.Hierarchy) -> None:
    for name in (meshhier.Node(1, 1), (1, 1), [1, 1], "1/1", np.array([1, 1]), (np.int64(1), np.uint32(1))):
        assert plain.error(name) == plain.error("1/1") and plain.bound(name) >= plain.error(name)
        assert plain.read_tile(name).node == plain.tree.tile(name) == (1, 1)
        assert (plain.tile_bounds(name) == plain.tile_bounds("1/1")).all()
        assert plain.tree.children(name) == [(2, 2), (2, 3)] and plain.tree.ancestor(name, 0) == (0, 0)
        assert plain.cut(nodes=["1/0", name]) == plain.cut(level=1)


@pytest.mark.parametrize("name", ["1", "1/", "/1", "1/1/1", " 1/1", "a/b", "-1/0", (1,), (1, 2, 3), (1.0, 1), (True, 1), (-1, 0), (0, -1), None, 7, {}, "1/99999999999"])
def test_what_names_no_node_is_refused(name: Any, plain: meshhier.Hierarchy) -> None:
    for call in (plain.error, plain.bound, plain.tile_bounds, plain.read_tile, plain.tree.children, plain.tree.range, lambda each: plain.cut(nodes=[each])):
        with pytest.raises(meshhier.UsageError, match='a node is .level, index., "LEVEL/INDEX" or a Node'):
            call(name)


def test_nodes_that_are_not_there(torus: str, built: Any) -> None:
    early = meshhier.open(built(torus, "early.hier", partition__count=11))
    node = next(node for node in (meshhier.Node(3, index) for index in range(8)) if early.tree.is_early(node))
    with pytest.raises(meshhier.UsageError, match=f"there is no tile {node}: {early.tree.tile(node)} stands"):
        early.read_tile(node)
    for name in ("9/0", "2/4", "4/11"):
        with pytest.raises(meshhier.UsageError, match=f"there is no node {name}"):
            early.error(name)
    for nodes in ("1/0", 5, None, [], ["1/0"], ["1/0", "1/0", "1/1"]):
        if nodes is not None:
            with pytest.raises(meshhier.UsageError, match="nodes are a list|no cut"):
                early.cut(nodes=nodes)  # type: ignore[arg-type]


def test_meshes_are_equal_by_content(plain: meshhier.Hierarchy, labelled: str, built: Any) -> None:
    mesh, again = plain.cut(level=1), plain.cut(level=1)
    assert mesh == again and mesh != plain.cut(level=2) and mesh != "mesh" and mesh == copy.deepcopy(mesh) == pickle.loads(pickle.dumps(mesh))
    again.positions[0, 0] += 1
    assert mesh != again
    with_nan = meshhier.open(built(labelled, "labelled.hier", partition__vertices=300))
    assert np.isnan(with_nan.cut().attributes["quality"]).any() and with_nan.cut() == with_nan.cut()
    assert with_nan.read_tile("1/0") == with_nan.read_tile((1, 0)) != with_nan.read_tile("1/1")
    with pytest.raises(TypeError, match="unhashable"):
        hash(mesh)


@pytest.mark.parametrize("name", ["plain.hier", "closed.3tz"])
def test_what_is_closed_says_so(name: str, torus: str, built: Any) -> None:
    hierarchy = meshhier.open(built(torus, name))
    with hierarchy:
        parts = hierarchy.iter_parts()
        next(parts)
    for call in (hierarchy.cut, lambda: hierarchy.nearest((0, 0, 0)), lambda: hierarchy.read_tile("0/0"), lambda: next(parts), lambda: pickle.dumps(hierarchy)):
        with pytest.raises(meshhier.UsageError, match=f"{name}: it is closed: open it again"):
            call()
    hierarchy.close()
    assert hierarchy.levels > 3, "what is known is known"


def area(task: tuple[meshhier.Hierarchy, int]) -> tuple[int, int]:
    hierarchy, level = task
    return os.getpid(), len(hierarchy.cut(level=level).triangles)


@pytest.mark.parametrize("method", ["spawn", "fork"])
def test_processes_share_it(method: str, torus: str, built: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, packed = (Path(built(torus, name)) for name in ("plain.hier", "pickled.3tz"))
    monkeypatch.chdir(folder.parent)
    with meshhier.open(folder.name) as one, meshhier.open(packed.name) as other, multiprocessing.get_context(method).Pool(2) as pool:
        for hierarchy in (one, other):
            counts = [len(hierarchy.cut(level=level).triangles) for level in range(hierarchy.levels)]
            found = pool.map(area, [(hierarchy, level) for level in range(hierarchy.levels)] * 3, chunksize=1)
            assert [count for _, count in found] == counts * 3 and os.getpid() not in {process for process, _ in found}


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_a_forked_process_reads_an_archive_by_itself(torus: str, built: Any) -> None:
    """It is inherited, not pickled: both read the same open file."""
    hierarchy = meshhier.open(built(torus, "forked.3tz"))
    expected = hierarchy.cut()
    children = []
    for _ in range(4):
        child = os.fork()
        if child == 0:
            os._exit(0 if all(hierarchy.cut() == expected for _ in range(5)) else 1)
        children.append(child)
    assert all(hierarchy.cut() == expected for _ in range(5))
    assert [os.waitpid(child, 0)[1] for child in children] == [0] * 4


def test_what_was_replaced_is_not_opened_by_a_pickle(torus: str, built: Any, tmp_path: Path) -> None:
    shutil.copytree(built(torus, "plain.hier"), tmp_path / "a.hier")
    pickled = pickle.dumps(meshhier.open(tmp_path / "a.hier"))
    assert pickle.loads(pickled).cut(level=0) == meshhier.open(tmp_path / "a.hier").cut(level=0)
    shutil.rmtree(tmp_path / "a.hier")
    shutil.copytree(built(torus, "early.hier", partition__count=11), tmp_path / "a.hier")
    with pytest.raises(meshhier.ReplacedError, match="open it again"):
        pickle.loads(pickled)


def test_failures_of_the_program_go_to_other_processes() -> None:
    again = pickle.loads(pickle.dumps(meshhier.VerifyError("it is broken", 4)))
    assert (type(again), str(again), again.message, again.exit_code) == (meshhier.VerifyError, "it is broken", "it is broken", 4)


def test_a_zip_of_other_things_is_no_hierarchy(torus: str, built: Any, tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.3tz", "w") as archive:
        archive.writestr("a.txt", "a")
    with pytest.raises(meshhier.NotAHierarchyError, match="no hierarchy.json"):
        meshhier.open(tmp_path / "a.3tz")
    whole = Path(built(torus, "plain.hier"))
    with zipfile.ZipFile(tmp_path / "b.3tz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.write(whole / "hierarchy.json", "hierarchy.json")
    with pytest.raises(meshhier.CorruptError, match="packed"):
        meshhier.open(tmp_path / "b.3tz")


@pytest.mark.parametrize("name", ["file:///tmp/a.hier", "s3://bucket/a.3tz"])
def test_addresses_of_other_kinds_are_named(name: str) -> None:
    with pytest.raises(meshhier.NotAHierarchyError, match=f"{name}: there is no such file or folder; addresses are https:// and http://"):
        meshhier.open(name)


def test_nothing_is_replaced_in_silence(plain: meshhier.Hierarchy, tmp_path: Path) -> None:
    mesh, path = plain.cut(level=0), tmp_path / "a.ply"
    mesh.write_ply(path)
    before = path.read_bytes()
    for kind in (FileExistsError, meshhier.ProgramError, meshhier.ExistsError):
        with pytest.raises(kind, match="a.ply is already there; force=True"):
            plain.cut(level=1).write_ply(str(path))
    assert path.read_bytes() == before
    (tmp_path / "link.ply").symlink_to(path)
    plain.cut(level=1).write_ply(tmp_path / "link.ply", force=True)
    assert path.read_bytes() != before and (tmp_path / "link.ply").is_symlink()
    mesh.attributes["x"] = np.zeros(len(mesh.positions))
    with pytest.raises(meshhier.UsageError, match="name of a coordinate"):
        mesh.write_ply(tmp_path / "b.ply")
    mesh.attributes = {"long": np.zeros(len(mesh.positions), np.int64)}
    with pytest.raises(meshhier.UsageError, match="long"):
        mesh.write_ply(path, force=True)
    assert {entry.name for entry in tmp_path.iterdir()} == {"a.ply", "link.ply"}, "nothing is left beside"
    with pytest.raises(meshhier.FileError, match="nowhere/a.ply: there is no folder"):
        plain.cut(level=0).write_ply(tmp_path / "nowhere" / "a.ply")
    plain.cut(level=0).write_ply(os.devnull, force=True)
    assert not os.path.isfile(os.devnull)
