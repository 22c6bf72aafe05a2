# SPDX-License-Identifier: MIT
"""Pieces of cuts are together what `meshhier export` writes, each triangle once, with few tiles in memory."""

from __future__ import annotations

import json
import subprocess
import weakref
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ply import triangle_set
from test_cut import between, exported

import meshhier
from meshhier.polygons import Polygons, rings_of
from meshhier.region import Region

FORMS = {
    "plain.hier": {},
    "small.3tz": {"storage__compression": "meshopt", "storage__positions__bits": 16},
    "early.hier": {"partition__count": 11},
    "upright.hier": {"up": "z"},
}


@pytest.fixture(scope="session")
def split(meshgen: str, torus: str, tmp_path_factory: pytest.TempPathFactory) -> str:
    """The torus with texture coordinates, hard edges and patches of colours: many vertices at one place."""
    path = str(tmp_path_factory.mktemp("split") / "split.ply")
    subprocess.run([meshgen, "split", torus, "--by", "mixed", "-o", path], check=True, stdout=subprocess.DEVNULL)
    return path


@pytest.fixture(params=["torus", "split"])
def hierarchy(request: pytest.FixtureRequest, built: Any) -> meshhier.Hierarchy:
    return meshhier.open(built(request.getfixturevalue(request.param), f"{request.param}_parts.hier", partition__count=11))


def corners(meshes: list[meshhier.Mesh]) -> Any:
    return np.concatenate([mesh.positions[mesh.triangles] for mesh in meshes])


def area_of(triangles: Any) -> float:
    return float(0.5 * np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1).sum())


def options(hierarchy: meshhier.Hierarchy) -> list[dict[str, Any]]:
    return [{}, {"level": 0}, {"level": 2}, {"error": between(hierarchy)}, {"nodes": ["1/0", (2, 2), meshhier.Node(2, 3)]}]


def test_each_triangle_is_in_one_piece(hierarchy: meshhier.Hierarchy, tmp_path: Path) -> None:
    for asked in options(hierarchy):
        pieces = list(hierarchy.iter_parts(**asked))
        assert all(len(piece.tiles) == 1 and piece.ids is None and piece.triangles.max() < len(piece.positions) for piece in pieces)
        cut = hierarchy.cut(**asked)
        assert (corners(pieces) == corners([cut])).all()
        if "nodes" in asked:
            (tmp_path / "cut.txt").write_text("\n".join(map(str, cut.tiles)))
            asked = {"cut": tmp_path / "cut.txt"}
        if not asked:
            asked = {"level": hierarchy.levels - 1}
        rows, triangles = exported(hierarchy, tmp_path / "cut.ply", *(str(part) for name, value in asked.items() for part in ("--" + name, value)))
        positions = np.stack([rows[axis] for axis in "xyz"], 1)
        assert len(corners(pieces)) == len(triangles)
        assert area_of(corners(pieces)) == pytest.approx(area_of(positions[triangles].astype(float)), rel=1e-6)


def test_ids_put_pieces_together(hierarchy: meshhier.Hierarchy, tmp_path: Path) -> None:
    for asked in options(hierarchy):
        pieces = list(hierarchy.iter_parts(**asked, ids=True))
        cut = hierarchy.cut(**asked)
        assert meshhier.Mesh.join(pieces) == cut
        ids = np.concatenate([piece.ids for piece in pieces if piece.ids is not None])
        numbers, firsts, same = np.unique(ids, return_index=True, return_inverse=True)
        assert len(numbers) == len(cut.positions) and (len(numbers) < len(ids)) == (len(pieces) > 1)
        for values in ("positions", "normals", "colours", "texcoords"):
            each = [getattr(piece, values) for piece in pieces]
            if each[0] is not None:
                together = np.concatenate(each)
                assert (together == together[firsts][same]).all(), f"{values} of one vertex differ between pieces"
    with pytest.raises(meshhier.UsageError, match="ids=True"):
        meshhier.Mesh.join(hierarchy.iter_parts())
    with pytest.raises(meshhier.UsageError, match="no piece"):
        meshhier.Mesh.join([])


@pytest.mark.parametrize("ids", [False, True])
def test_few_tiles_are_in_memory(ids: bool, torus: str, split: str, built: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    for mesh in (torus, split):
        hierarchy = meshhier.open(built(mesh, f"many_{Path(mesh).stem}.hier", partition__vertices=120))
        tiles: list[weakref.ref[meshhier.Tile]] = []
        read = hierarchy.read_tile

        def read_and_watch(node: meshhier.NodeLike) -> meshhier.Tile:
            tile = read(node)
            tiles.append(weakref.ref(tile))
            return tile

        monkeypatch.setattr(hierarchy, "read_tile", read_and_watch)
        most, count = 0, 0
        for _ in hierarchy.iter_parts(ids=ids):
            most, count = max(most, sum(tile() is not None for tile in tiles)), count + 1
        assert count == hierarchy.tree.partitions > 60 and most <= 16 + 1
        assert len(tiles) == count if mesh == torus else len(tiles) < 3 * count, "tiles are read again and again"


def polygons(hierarchy: meshhier.Hierarchy) -> list[Any]:
    low, high = hierarchy.bounds
    is_z_up = hierarchy.manifest["up"] == "z"
    (west, east), (south, north) = (low[0], high[0]), (low[1], high[1]) if is_z_up else (-high[2], -low[2])

    def ring(*places: tuple[float, float]) -> list[list[float]]:
        return [[west + x * (east - west), south + y * (north - south)] for x, y in places]

    outer, hole = ring((0.1, 0.2), (0.9, 0.3), (0.7, 0.8), (0.3, 0.9)), ring((0.3, 0.4), (0.5, 0.4), (0.5, 0.6))
    slit = [*outer, outer[0], *hole, hole[0], outer[0]]
    square = ring((0.5, 0.5), (2, 0.5), (2, 2), (0.5, 2))
    return [
        {"type": "Polygon", "coordinates": [outer, hole]},
        {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [slit]}},
        {"type": "GeometryCollection", "geometries": [{"type": "Point", "coordinates": [0, 0]}, {"type": "MultiPolygon", "coordinates": [[hole], [square]]}]},
    ]


@pytest.mark.parametrize("name", FORMS)
def test_boxes_and_polygons_are_those_of_export(name: str, torus: str, built: Any, tmp_path: Path) -> None:
    with meshhier.open(built(torus, name, **FORMS[name])) as hierarchy:
        positions = hierarchy.cut(level=1).positions
        boxes = [np.quantile(positions, ends, axis=0, method="nearest") for ends in ((0.2, 0.9), (0, 0.7), (0.3, 1))]  # sides at vertices
        cuts: list[dict[str, Any]] = [{"level": 1}, {"error": between(hierarchy)}, {}]
        file = tmp_path / "a.geojson"
        for number, polygon in enumerate(polygons(hierarchy)):
            file.write_text(json.dumps(polygon))
            for box, cut in ((None, cuts[number]), (boxes[number], cuts[number - 1])):
                where = ["--polygon", str(file)] + ([] if box is None else ["--box", *(",".join(map(repr, corner.tolist())) for corner in box)])
                rows, triangles = exported(hierarchy, tmp_path / "a.ply", *(str(part) for key, value in cut.items() for part in ("--" + key, value)), *where)
                mesh = hierarchy.cut(**cut, polygon=file if number else polygon, box=box)
                theirs = triangle_set(triangles, np.stack([rows[axis] for axis in "xyz"], 1))
                assert len(theirs) == len(mesh.triangles) > 0
                assert (theirs == triangle_set(mesh.triangles, mesh.positions)).all()
                assert (corners(list(hierarchy.iter_parts(**cut, polygon=polygon, box=box))) == corners([mesh])).all()


@pytest.fixture(scope="module")
def steps(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Flat squares of whole coordinates on different heights, with walls between: from above and from the side most triangles are lines."""
    path, side = tmp_path_factory.mktemp("steps") / "steps.obj", 12
    heights = np.random.default_rng(5).integers(0, 4, (side + 1, side + 1))
    places: dict[tuple[int, ...], int] = {}
    faces: list[str] = []

    def add(*corners: tuple[int, ...]) -> None:
        numbers = [places.setdefault(corner, len(places) + 1) for corner in corners]
        faces.append("f " + " ".join(map(str, numbers)))

    for x, y in np.ndindex(side, side):
        z, east, north = (int(heights[at]) for at in ((x, y), (x + 1, y), (x, y + 1)))
        add((x, y, z), (x + 1, y, z), (x + 1, y + 1, z), (x, y + 1, z))
        if east != z:
            add((x + 1, y, z), (x + 1, y, east), (x + 1, y + 1, east), (x + 1, y + 1, z))
        if north != z:
            add((x, y + 1, z), (x, y + 1, north), (x + 1, y + 1, north), (x + 1, y + 1, z))
    path.write_text("\n".join([f"v {x} {y} {z}" for x, y, z in places] + faces))
    return str(path)


@pytest.mark.parametrize("up", ["y", "z"])
def test_borders_through_corners_and_along_edges(up: str, steps: str, built: Any, tmp_path: Path) -> None:
    hierarchy = meshhier.open(built(steps, f"steps_{up}.hier", up=up, partition__vertices=150))
    random, least = np.random.default_rng(9), 0 if up == "z" else -4
    taken = 0
    for number in range(16):
        x, y = random.integers(0, 25, (2, 2, 6)) / 2, random.integers(2 * least, 2 * (least + (12 if up == "z" else 4)) + 1, (2, 6)) / 2
        rings = [np.stack([x[0, ring], y[ring]], 1).tolist() for ring in range(2)]
        (tmp_path / "a.geojson").write_text(json.dumps({"type": "Polygon", "coordinates": [rings[0], rings[1][: 3 + number % 4]]}))
        where = ["--polygon", str(tmp_path / "a.geojson"), "--level", str(hierarchy.levels - 1)]
        box = np.sort(random.integers(0, 5, (2, 3)) * [3, 3, 1], axis=0) if number % 2 else None
        if box is not None:
            where += ["--box", *(",".join(map(str, corner)) for corner in box)]
        mesh = hierarchy.cut(polygon=tmp_path / "a.geojson", box=box)
        taken += len(mesh.triangles) > 0
        try:
            rows, triangles = exported(hierarchy, tmp_path / "a.ply", *where)
        except subprocess.CalledProcessError as error:
            assert error.returncode == 2 and len(mesh.triangles) == 0  # there is nothing
            continue
        theirs = triangle_set(triangles, np.stack([rows[axis] for axis in "xyz"], 1))
        assert len(theirs) == len(mesh.triangles) and (theirs == triangle_set(mesh.triangles, mesh.positions)).all()
    assert taken > 8


def test_what_is_near_is_as_fine_as_asked(torus: str, built: Any) -> None:
    hierarchy = meshhier.open(built(torus, "plain.hier"))
    low, high = hierarchy.bounds
    box = (low, low + (high - low) * 0.3)
    nodes = hierarchy.cut_nodes(box=box)
    assert len({node.level for node in nodes}) > 1
    near, whole = hierarchy.cut(nodes=nodes, box=box), hierarchy.cut(box=box)
    assert (triangle_set(near.triangles, near.positions) == triangle_set(whole.triangles, whole.positions)).all()
    assert len(whole.tiles) < hierarchy.tree.partitions, "tiles far away are not read"


def test_polygons_are_decided_exactly() -> None:
    """Triangles that a border runs along, touch at a corner, or are lines from above."""
    square = Polygons(rings_of([(0, 0), (1, 0), (1, 1), (0, 1)]), True, np.zeros(3))
    tiny = 2.0**-60
    triangles = {
        ((0, 0), (1, 0), (1, 1)): True,  # a half of it
        ((0, 0), (0, 1), (-1, 0)): True,  # beside it; a corner counts as within, as the south-west is
        ((1, 1), (2, 1), (1, 2)): False,
        ((1, 0), (2, 0), (2, 1)): False,
        ((1 - 2**-52, 2), (2, 0.5), (3, 3)): False,
        ((0.5, -1), (1.5, -1), (1, tiny)): True,  # its corner reaches in
        ((-1, -1), (3, -1), (1, 3)): True,  # around it
        ((0.5, 0.5), (0.5, 0.5), (0.5, 0.5)): True,
        ((-1, 0.5), (0.2, 0.5), (2, 0.5)): True,  # lines
        ((-1, 1), (0.2, 1), (2, 1)): False,
        ((1.5, -1), (1.5, 2), (1.5, 1)): False,
        ((-1, 2), (0.5, 0.5), (2, -1)): True,
    }
    folded = Polygons(rings_of([(0, 0), (1, 0), (1, 1), (1, 0.5), (2, 0.5), (5, 0.5), (3, 0.5), (1, 0.5), (1, 1), (0, 1)]), True, np.zeros(3))
    assert folded.touches(np.array([[[3.5, 0, 0], [4, 0, 0], [3.5, 1, 0]], [[0.5, 0.4, 0], [4, 0, 0], [4, 1, 0]]], float)).tolist() == [False, True]
    for plan, is_within in triangles.items():
        corners = np.array([[(x, y, height) for height, (x, y) in enumerate(plan)]], float)
        for turned in (corners, corners[:, ::-1], np.roll(corners, 1, axis=1)):
            assert square.touches(turned).tolist() == [is_within], plan


class Shape:
    """What has `__geo_interface__`, as shapely's geometries."""

    __geo_interface__ = {"type": "Polygon", "coordinates": (((0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.0, 0.0)),)}


def test_polygons_come_in_many_forms(tmp_path: Path) -> None:
    (tmp_path / "a.geojson").write_text("\ufeff" + json.dumps(Shape.__geo_interface__))
    ring = [(0, 0), (1, 0), (0, 1)]
    for polygon in (ring, np.array(ring), [*ring, ring[0]], Shape(), Shape.__geo_interface__, tmp_path / "a.geojson", str(tmp_path / "a.geojson")):
        region = Region(None, polygon, False, np.array([0.0, 0.0, 0.0]))
        assert region.touches(np.array([[[0.2, 5, -0.2], [0.3, 6, -0.2], [0.2, 7, -0.3]], [[0.2, 5, 0.2], [0.3, 6, 0.2], [0.2, 7, 0.3]]])).tolist() == [True, False]


@pytest.mark.parametrize(
    "polygon",
    [[(0, 0), (1, 1)], [(0, 0), (1, 0), (0, float("nan"))], [(0, 0), (1e308, 0), (0, 1e308)], [1, 2, 3], 5, "nowhere.geojson", {"type": "Point", "coordinates": [0, 0]}, {"a": 1}, {"type": "Polygon", "coordinates": 7}, b"x", [(0, 0), (1, 0), ("a", 1)]],
)  # fmt: skip
def test_what_is_no_polygon_is_refused(polygon: Any, torus: str, built: Any) -> None:
    with pytest.raises(meshhier.UsageError, match="polygon|GeoJSON|geojson"):
        meshhier.open(built(torus, "plain.hier")).iter_parts(polygon=polygon)


@pytest.mark.parametrize("text", ["", "[" * 100000, "{", "[1]", '{"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [NaN, 1]]]}', '{"type": "FeatureCollection"}'])
def test_a_broken_geojson_is_refused(text: str, torus: str, built: Any, tmp_path: Path) -> None:
    (tmp_path / "a.geojson").write_text(text)
    with pytest.raises(meshhier.UsageError, match="a.geojson"):
        meshhier.open(built(torus, "plain.hier")).cut(polygon=tmp_path / "a.geojson")


@pytest.mark.parametrize("section", ["copy_of", "border", "chains"])
def test_tiles_that_contradict_each_other_are_damage(section: str, split: str, built: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    hierarchy = meshhier.open(built(split, "split_parts.hier", partition__count=11))
    read = hierarchy.read_tile

    def read_damaged(node: meshhier.NodeLike) -> meshhier.Tile:
        tile = read(node)
        for values in tile.chains if section == "chains" else [getattr(tile, section)]:
            values[...] = 1 << 40
        return tile

    monkeypatch.setattr(hierarchy, "read_tile", read_damaged)
    with pytest.raises(meshhier.CorruptError, match=r"tiles/.*glb"):
        hierarchy.cut(error=between(hierarchy))
