# SPDX-License-Identifier: MIT
"""What a cell of a notebook shows: how much of a model is in it, and what the kernel gives of the rest. That it is seen: tests/web/notebook.mjs."""

from __future__ import annotations

import base64
import gzip
import html
import json
import os
import re
import shutil
import urllib.error
import urllib.request
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import meshhier
from meshhier.kernel_files import kernel_address
from meshhier.viewer_files import viewer_file

from conftest import Build


@pytest.fixture(autouse=True)
def viewer() -> str:
    try:
        return viewer_file("meshhier-viewer.js.gz")
    except meshhier.ProgramNotFoundError:
        pytest.skip("the viewer is not built: npm ci && npm run build in viewer/")


@pytest.fixture
def model(built: Build, torus: str) -> str:
    return built(torus, "shown.hier")


@pytest.fixture
def without_program(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MESHHIER", "/nowhere/meshhier")


def page_of(cell: Any) -> str:
    """What the frame holds, as a browser reads it."""
    return html.unescape(re.search("srcdoc='([^']*)'", cell.html)[1])  # type: ignore[index]


def embedded(cell: Any) -> dict[str, bytes]:
    text = re.search(r'id="meshhier-hierarchy"[^>]*>(.*?)</script>', page_of(cell), re.S)
    files = json.loads(text[1])["files"]  # type: ignore[index]
    decoded = {name: base64.b64decode(content) for name, content in files.items()}
    return {name: gzip.decompress(data) if data[:2] == b"\x1f\x8b" else data for name, data in decoded.items()}


def stored(data: bytes) -> bytes:
    return gzip.decompress(data) if data[:2] == b"\x1f\x8b" else data


def fetch(address: str, **headers: str) -> tuple[int, bytes]:
    with urllib.request.urlopen(urllib.request.Request(address, headers=headers)) as answer:
        return answer.status, answer.read()


def test_a_small_model_is_there_as_a_whole(model: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with meshhier.open(model) as hierarchy:
        cells = [hierarchy.show()]
        monkeypatch.setenv("MESHHIER", "/nowhere/meshhier")
        cells.append(hierarchy.show())
        for cell in cells:
            assert "all of it, " in repr(cell) and f"{hierarchy.triangles:,} triangles" in page_of(cell)
            assert len([name for name in embedded(cell) if name.startswith("tiles/")]) == len(list(hierarchy.tree.tiles()))
            assert 'data-link=""' in page_of(cell)  # there is nothing to fetch
    for name, data in embedded(cells[1]).items():
        assert data == stored((Path(model) / name).read_bytes()), name


def test_the_program_rounds_what_does_not_fit(built: Build, torus: str, viewer: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """More of it is there, it is a hierarchy, and as near to the original as the cell says."""
    with meshhier.open(built(torus, "fine.hier", partition__vertices=500, storage__normals="smooth")) as hierarchy:
        size = len(viewer) + 450_000
        rounded = hierarchy.show(size=size)
        monkeypatch.setenv("MESHHIER", "/nowhere/meshhier")
        plain = hierarchy.show(size=size)
        counts, errors = zip(*(map(float, re.search(r": (\d+) of \d+ tiles, within (\S+) of", repr(cell)).groups()) for cell in (rounded, plain)))  # type: ignore[union-attr]
        assert counts[0] > counts[1] and errors[0] < errors[1] and max(len(rounded.html), len(plain.html)) <= size
        files = embedded(rounded)
        there = {name for name in files if name.startswith("tiles/")}
        manifest = json.loads(files["hierarchy.json"])
        for name in ("tiles.bin", "hierarchy.json", *there):
            (tmp_path / "a.hier" / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / "a.hier" / name).write_bytes(files[name])
        with meshhier.open(tmp_path / "a.hier") as held:
            nodes = [held.tree.tile((0, 0))]
            while any(held._manifest.tile_name(child) in there for node in nodes for child in held.tree.children(node)):
                nodes = [leaf for node in nodes for leaf in _below(held, node, there)]
            cut = held.cut(nodes=nodes)
        monkeypatch.undo()
        found = hierarchy.nearest(cut.positions)
        rounding = manifest["storage"]["positions"]["worst_rounding"]
        assert 0 < rounding < errors[0] and np.abs(found.distances).max() < 4 * errors[0]
        assert len(cut.triangles) > hierarchy.triangles / 4


def test_tiles_that_are_all_there_but_rounded_have_no_finer_ones(built: Build, torus: str) -> None:
    with meshhier.open(built(torus, "plain.hier")) as hierarchy:
        whole = hierarchy.show()
        cell = hierarchy.show(size=len(whole.html) - 1)
        count = len(hierarchy._index)
    assert re.search(rf"plain: all {count} tiles, rounded, within \S+ of the original", repr(cell)), repr(cell)
    assert 'data-left="; exact ones are not in this notebook"' in page_of(cell) and "finer" not in page_of(cell).partition("<script")[0]


def _below(hierarchy: meshhier.Hierarchy, node: meshhier.Node, there: set[str]) -> list[meshhier.Node]:
    children = hierarchy.tree.children(node)
    return children if children and all(hierarchy._manifest.tile_name(child) in there for child in children) else [node]


@pytest.mark.parametrize("program", [True, False])
def test_a_flat_model_is_not_all_there_because_it_is_exact(program: bool, viewer: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Coarse tiles of a plane are nowhere off."""
    side = 60
    lines = [f"{x} {y} 0" for y in range(side) for x in range(side)]
    quads = [f"4 {i} {i + 1} {i + side + 1} {i + side}" for i in range(side * (side - 1)) if i % side < side - 1]
    head = f"ply\nformat ascii 1.0\nelement vertex {len(lines)}\nproperty float x\nproperty float y\nproperty float z\nelement face {len(quads)}\n"
    (tmp_path / "a.ply").write_text("\n".join([head + "property list uchar int vertex_indices\nend_header", *lines, *quads, ""]))
    with meshhier.build(tmp_path / "a.ply", settings={"partition.vertices": 200, "preview": False}) as hierarchy:
        if not program:
            monkeypatch.setenv("MESHHIER", "/nowhere/meshhier")
        cell = hierarchy.show(size=len(viewer) + 35_000)
    assert re.search(r"a: \d+ of \d+ tiles, within \S+ of the original", repr(cell)) and 'data-link="http' in page_of(cell)


def test_a_story_takes_no_room(model: str, tmp_path: Path) -> None:
    shutil.copytree(model, tmp_path / "a.hier")
    with meshhier.open(tmp_path / "a.hier") as hierarchy:
        plain = hierarchy.show()
        (tmp_path / "a.hier.story.json").write_text(json.dumps({"words": "x" * 2_000_000}))
        told = hierarchy.show()
    assert embedded(told) == embedded(plain) and "xxxxx" not in told.html


def test_what_shows_no_frame_shows_words(model: str) -> None:
    """As Jupyter of a notebook that is not trusted: what is within the element is shown in its place."""
    with meshhier.open(model) as hierarchy:
        cell = hierarchy.show()
    left = re.sub("<[^>]*>", "", re.sub("srcdoc='[^']*'", "", cell.html))
    assert left.startswith("shown: all of it, ") and "trust it" in left


@pytest.mark.usefixtures("without_program")
def test_a_cell_holds_the_coarse_tiles_that_fit(model: str, viewer: str) -> None:
    with meshhier.open(model) as hierarchy:
        size = len(viewer) + sum(file.stat().st_size for file in Path(model).glob("tiles/**/*.glb")) // 2
        cell = hierarchy.show(size=size)
        files = embedded(cell)
        tiles = {name for name in files if name.startswith("tiles/")}
        assert len(cell.html) <= size
        assert 1 < len(tiles) < len(list(hierarchy.tree.tiles()))
        assert "tiles/00/000000.glb" in tiles
        assert f"{len(tiles)} of {len(list(hierarchy.tree.tiles()))} tiles, within " in repr(cell)
        names = [hierarchy._manifest.tile_name(node) for node in hierarchy.tree.tiles()]
        assert len(files["tiles.bin"]) >= 32 + 120 * (1 + max(names.index(name) for name in tiles))
        for node in hierarchy.tree.tiles():  # both children or none: what is there is a cut
            there = [hierarchy._manifest.tile_name(child) in tiles for child in hierarchy.tree.children(node)]
            assert len(set(there)) <= 1
        with pytest.raises(meshhier.UsageError, match="no room for the viewer and the root"):
            hierarchy.show(size=len(viewer))
        with pytest.raises(meshhier.UsageError, match="height is a number of pixels, 1 or more, not 0"):
            hierarchy.show(height=0)


def test_the_kernel_gives_what_is_asked_by_its_address_alone(model: str) -> None:
    address = kernel_address(model)
    assert re.fullmatch(r"http://127\.0\.0\.1:\d+/[\w-]{22}", address) and address == kernel_address(model)
    data = (Path(model) / "tiles.bin").read_bytes()
    assert fetch(address + "/tiles.bin?build=1") == (200, data)
    assert fetch(address + "/tiles.bin", Range="bytes=8-40") == (206, data[8:41])
    for path in ("/no.bin", "/../x.bin", "/..%2f..%2fetc/passwd", "/tiles/../hierarchy.json", "", "/"):
        with pytest.raises(urllib.error.HTTPError, match="404"):
            fetch(address + path)
    with pytest.raises(urllib.error.HTTPError, match="404"):
        fetch(address[:-1] + ("a" if address[-1] != "a" else "b") + "/tiles.bin")
    with pytest.raises(urllib.error.HTTPError, match="416"):
        fetch(address + "/tiles.bin", Range="bytes=99999999-100000000")


def test_the_kernel_gives_files_of_an_archive_that_was_closed(built: Build, torus: str) -> None:
    archive = built(torus, "shown.3tz")
    with meshhier.open(archive) as hierarchy:
        assert "all of it" in repr(hierarchy.show())
        expected = hierarchy._files.read("hierarchy.json")
    assert fetch(kernel_address(archive) + "/hierarchy.json") == (200, expected)


def test_the_kernel_has_what_was_built_last(built: Build, torus: str, tmp_path: Path) -> None:
    shutil.copy(built(torus, "first.3tz"), tmp_path / "a.3tz")
    first = kernel_address(str(tmp_path / "a.3tz"))
    shutil.copy(built(torus, "second.3tz", partition__vertices=900), tmp_path / "b.3tz")
    os.replace(tmp_path / "b.3tz", tmp_path / "a.3tz")
    with meshhier.open(tmp_path / "a.3tz") as now:
        assert json.loads(fetch(kernel_address(str(tmp_path / "a.3tz")) + "/hierarchy.json")[1]) == now.manifest
    assert fetch(first + "/hierarchy.json")[0] == 200, "cells of the first one still have it"
    with pytest.raises(meshhier.NotAHierarchyError):
        kernel_address(str(tmp_path / "none.3tz"))


def test_the_kernel_finds_it_from_another_folder(model: str, viewer: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(Path(model).parent)
    with meshhier.open(Path(model).name) as hierarchy:
        monkeypatch.chdir(tmp_path)
        found = re.search('data-link="([^"]+)"', page_of(hierarchy.show(size=len(viewer) + 150_000)))
    assert found and fetch(found[1] + "/tiles.bin") == (200, (Path(model) / "tiles.bin").read_bytes())


def test_no_name_ends_the_frame(model: str, tmp_path: Path) -> None:
    path = tmp_path / "a'\"&<b>{{files}}<!--.hier"
    shutil.copytree(model, path)
    with meshhier.open(path) as hierarchy:
        cell = hierarchy.show(view="'><script>", link="")
    assert cell.html.count("'") == 2 and cell.html.endswith("</iframe>")
    page = page_of(cell)
    assert "<b>" not in page and "<script>" not in page and len(embedded(cell)) > 3


@pytest.mark.skipif(os.name == "nt", reason="names are Unicode there")
def test_a_name_that_is_no_text_is_shown(model: str, tmp_path: Path) -> None:
    path = os.fsdecode(os.fsencode(tmp_path) + b"/caf\xe9.hier")
    shutil.copytree(model, path)
    with meshhier.open(path) as hierarchy:
        cell = hierarchy.show()
    assert "caf\ufffd: all of it" in cell.html and cell.html.encode("utf-8")


@pytest.mark.parametrize("view", ["light=raking", "#shown.hier&light=raking", "http://localhost:8080/?x=1#a/b.hier&light=raking"])
def test_a_view_is_a_link_or_its_end(model: str, view: str) -> None:
    with meshhier.open(model) as hierarchy:
        assert 'view="light=raking"' in page_of(hierarchy.show(view=view))


def test_a_link_is_all_that_is_asked(model: str, viewer: str) -> None:
    with meshhier.open(model) as hierarchy:
        size = len(viewer) + 150_000
        page = page_of(hierarchy.show(link="https://example.org/a.3tz", size=size))
        assert "connect-src data: blob: https://example.org\"" in page and 'data-asked="https://example.org/a.3tz"' in page
        assert "allow-same-origin" not in hierarchy.show(size=size).html
        assert "allow-same-origin" in hierarchy.show(link="/files/a.hier", size=size).html
        for address in ("https://a b", "x'y", "http://a;script-src *"):
            with pytest.raises(meshhier.UsageError, match="no address: .*%20"):
                hierarchy.show(link=address)
        with pytest.raises(meshhier.UsageError, match="a user or a password in it") as refusal:
            hierarchy.show(link="https://me:word@example.org/a.3tz")
        assert "word@" not in str(refusal.value)


def test_a_hierarchy_that_was_replaced_is_not_shown(built: Build, torus: str, model: str, tmp_path: Path) -> None:
    path = tmp_path / "shown.hier"
    shutil.copytree(model, path)
    with meshhier.open(path) as hierarchy:
        shutil.rmtree(path)
        shutil.copytree(built(torus, "other.hier", partition__vertices=500), path)
        with pytest.raises(meshhier.ReplacedError):
            hierarchy.show()


def test_without_a_viewer_it_is_text(model: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("meshhier.viewer_files._folders", lambda: iter([]))
    with meshhier.open(model) as hierarchy:
        assert hierarchy._repr_html_() is None
        with pytest.raises(meshhier.ProgramNotFoundError, match="meshhier-viewer.js.gz"):
            hierarchy.show()
