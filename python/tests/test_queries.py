# SPDX-License-Identifier: MIT
"""Nearest places and hits, against numpy trying all triangles."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import meshhier

from ply import read_ply

Build = Callable[..., str]
Array = NDArray[np.float64]


def corners_of(mesh: meshhier.Mesh) -> tuple[Array, Array, Array]:
    a, b, c = (mesh.positions[mesh.triangles[:, k]] for k in range(3))
    return a, b, c


def squared(v: Array) -> Array:
    return np.einsum("...i,...i", v, v)


def least_distance(point: Array, a: Array, b: Array, c: Array) -> float:
    """By the foot on each plane, where that is within the triangle, and the three edges."""

    def to_edge(p: Array, q: Array) -> Array:
        way = q - p
        t = np.clip(np.einsum("ij,ij->i", point - p, way) / squared(way), 0, 1)
        return squared(point - p - way * t[:, None])

    from_a = np.sqrt(squared(point - a))
    longest = np.sqrt(max(squared(b - a).max(), squared(c - b).max(), squared(a - c).max()))
    may_be = from_a <= from_a.min() + longest * (1 + 1e-9)
    a, b, c = a[may_be], b[may_be], c[may_be]
    normal = np.cross(b - a, c - a)
    height = np.einsum("ij,ij->i", point - a, normal) / squared(normal)
    foot = point - normal * height[:, None]
    sides = [np.einsum("ij,ij->i", np.cross(q - p, foot - p), normal) for p, q in ((a, b), (b, c), (c, a))]
    within = np.all(np.array(sides) >= 0, axis=0)
    plane = np.where(within, squared(foot - point), np.inf)
    return float(np.sqrt(np.min([plane, to_edge(a, b), to_edge(b, c), to_edge(c, a)])))


def first_hit(origin: Array, direction: Array, a: Array, b: Array, c: Array) -> float:
    """Möller & Trumbore 1997."""
    direction = direction / np.linalg.norm(direction)
    p = np.cross(direction, c - a)
    determinant = np.einsum("ij,ij->i", b - a, p)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = np.einsum("ij,ij->i", origin - a, p) / determinant
        q = np.cross(origin - a, b - a)
        v = q @ direction / determinant
        t = np.einsum("ij,ij->i", c - a, q) / determinant
    hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0)
    return float(np.min(t[hit], initial=np.inf))


def triangle_of(hierarchy: meshhier.Hierarchy, answers: Any, row: int) -> Array:
    node = answers.node(row)
    tile = hierarchy.read_tile(node)
    return tile.positions[tile.triangles[answers.triangles[row]]].astype(np.float64) + hierarchy.origin


@pytest.mark.parametrize("level", [None, 1])
def test_nearest_places_are_those_of_trying_all(torus: str, built: Build, level: int | None) -> None:
    hierarchy = meshhier.open(built(torus, "torus.hier"))
    a, b, c = corners_of(hierarchy.cut(level=level))
    low, high = hierarchy.bounds
    points = np.random.default_rng(1).uniform(low - 1, high + 1, (300, 3))
    near = hierarchy.nearest(points, level=level)
    assert len(near) == 300 and near.sides is None and near.objects is None
    assert near.bound == 0 if level is None else near.bound > 0
    for i, point in enumerate(points):
        assert near.distances[i] == pytest.approx(least_distance(point, a, b, c), rel=1e-12, abs=1e-12)
        assert np.linalg.norm(near.points[i] - point) == pytest.approx(near.distances[i], rel=1e-12)
        if level is None:
            corners = triangle_of(hierarchy, near, i)
            parts = np.linalg.lstsq(np.vstack([corners.T, np.ones(3)]), np.append(near.points[i], 1), rcond=None)[0]
            assert (parts > -1e-6).all() and np.allclose(parts @ corners, near.points[i])


def test_hits_are_those_of_trying_all(torus: str, built: Build) -> None:
    hierarchy = meshhier.open(built(torus, "torus.hier"))
    a, b, c = corners_of(hierarchy.cut())
    low, high = hierarchy.bounds
    random = np.random.default_rng(2)
    origins = random.uniform(low - 1, high + 1, (300, 3))
    directions = random.uniform(low, high, (300, 3)) - origins
    hits = hierarchy.rays(origins, directions)
    assert 50 < hits.is_hit.sum() < 300
    for i in range(300):
        assert hits.distances[i] == pytest.approx(first_hit(origins[i], directions[i], a, b, c), rel=1e-9)
        if hits.is_hit[i]:
            along = origins[i] + directions[i] / np.linalg.norm(directions[i]) * hits.distances[i]
            assert np.allclose(hits.points[i], along)
            p, q, r = triangle_of(hierarchy, hits, i)
            normal = np.cross(q - p, r - p)
            assert np.allclose(hits.normals[i], normal / np.linalg.norm(normal))
        else:
            assert hits.node(i) is None
    one = hierarchy.rays(origins[:1], directions[:1] * 1e-9)
    assert one.distances[0] == hits.distances[0]
    fan = hierarchy.rays(origins[0], directions)
    assert fan.distances[0] == hits.distances[0] and len(fan) == 300


def test_sides_are_those_of_a_closed_surface(torus: str, built: Build) -> None:
    hierarchy = meshhier.open(built(torus, "torus.hier"))
    mesh = hierarchy.cut()
    assert mesh.normals is not None
    out = hierarchy.nearest(mesh.positions[::50] + mesh.normals[::50] * 1e-4, signed=True)
    within = hierarchy.nearest(mesh.positions[::50] - mesh.normals[::50] * 1e-4, signed=True)
    assert out.sides is not None and within.sides is not None
    assert (out.sides == 1).all() and (out.distances > 0).all()
    assert (within.sides == -1).all() and (within.distances < 0).all()


def test_coarse_answers_are_within_the_bound(torus: str, built: Build) -> None:
    hierarchy = meshhier.open(built(torus, "torus.hier"))
    points = np.random.default_rng(3).normal(size=(2000, 3))
    exact = hierarchy.nearest(points)
    coarse = hierarchy.nearest(points, error=float(hierarchy.errors[1]))
    assert coarse.bound > 0 and (np.abs(coarse.distances - exact.distances) <= coarse.bound * (1 + 1e-9)).all()


def test_objects_are_those_of_the_triangles(labelled: str, built: Build) -> None:
    hierarchy = meshhier.open(built(labelled, "things.hier", objects__from="label:part"))
    assert hierarchy.objects is not None
    points = np.array([[5.2, 30.3, 1], [25.2, 30.3, 1], [45.2, 30.3, 1]])
    near, hits = hierarchy.nearest(points), hierarchy.rays(points + [0, 0, 9], (0, 0, -1))
    assert near.objects is not None and hits.objects is not None
    assert [hierarchy.objects[int(i)].name for i in near.objects] == [hierarchy.objects[int(i)].name for i in hits.objects]
    assert len(set(near.objects)) == 3


def test_a_piece_has_the_triangles_that_export_writes(labelled: str, built: Build, tmp_path: Path) -> None:
    hierarchy = meshhier.open(built(labelled, "things.hier", objects__from="label:part"))
    assert hierarchy.objects is not None
    points = np.random.default_rng(6).uniform((0, 0, -3), (59, 59, 3), (60, 3))
    name = hierarchy.objects[1].name
    wedge = [[9.5, -2], [50, 0], [9.5, 2]]  # x and -z: y points up
    pieces: list[dict[str, Any]] = [
        {"box": ((10.5, 20, -9), (30, np.inf, 0.5))},
        {"box": ((10.5, 20, -9), (50, 45, 9)), "object": name, "level": 1},
        {"polygon": wedge, "where": f"name <> '{name}'"},
    ]
    for piece in pieces:
        vertices, triangles = read_ply(meshhier.export(hierarchy, str(tmp_path / "piece.ply"), force=True, **piece))
        places = np.stack([vertices[axis] for axis in "xyz"], 1).astype(np.float64)
        a, b, c = (places[triangles[:, k]] for k in range(3))
        near, hits = hierarchy.nearest(points, **piece), hierarchy.rays(points + [0, 0, 9], (0.1, 0.2, -1), **piece)
        assert near.distances == pytest.approx([least_distance(point, a, b, c) for point in points], rel=1e-9)
        assert hits.distances == pytest.approx([first_hit(point + [0, 0, 9], np.array([0.1, 0.2, -1]), a, b, c) for point in points], rel=1e-9)
        assert 0 < hits.is_hit.sum() < len(points) and (near.distances >= hierarchy.nearest(points, level=piece.get("level")).distances).all()
        if "object" in piece:
            assert near.objects is not None and set(near.objects) == {1}
    with pytest.raises(meshhier.UsageError, match="no triangle lies in the box"):
        hierarchy.nearest(points, box=((99, 99, 99), (100, 100, 100)))
    with pytest.raises(meshhier.UsageError, match="box"):
        hierarchy.rays(points, points, box=((1, 1, 1), (0, 0, 0)))


def test_rows_of_any_kind(torus: str, built: Build) -> None:
    hierarchy = meshhier.open(built(torus, "torus.hier"))
    exact = hierarchy.nearest([[1.5, 0.25, 0], [0, 0, 3]]).distances
    assert (hierarchy.nearest(np.array([[1.5, 0.25, 0], [0, 0, 3]], np.float32)).distances == exact).all()
    assert (hierarchy.nearest(np.asfortranarray([[1.5, 0.25, 0], [0, 0, 3]])).distances == exact).all()
    wide = np.array([[9, 1.5, 9, 0.25, 9, 0], [9, 0, 9, 0, 9, 3]])
    for others in (wide[:, 1::2], wide[::-1, 5::-2][::-1, ::-1], wide[:, 1::2].astype(">f8"), wide[:, 1::2].astype(">f2"), wide[:, 1::2].tolist(), wide[:, 1::2].astype(object)):
        assert (hierarchy.nearest(others).distances == exact).all()
    assert hierarchy.nearest((0, 0, 3)).distances[0] == exact[1]
    assert hierarchy.nearest(np.array([[0, 0, 3]])).distances[0] == exact[1]
    assert len(hierarchy.nearest([])) == len(hierarchy.nearest(np.empty((0, 3), ">f4"))) == 0
    odd = hierarchy.nearest([[np.nan, 0, 0], [0, 0, 3], [np.inf, 0, 0]])
    assert np.isnan(odd.distances).tolist() == [True, False, True] and odd.triangles[0] == -1 and odd.node(0) is None
    assert np.isnan(hierarchy.rays((0, 0, 9), (0, 0, 0)).distances[0])
    masked = np.ma.masked_array([[1.5, 0.25, 0], [0, 0, 3]], mask=[[True, False, False], [False] * 3])
    assert np.isnan(hierarchy.nearest(masked).distances).tolist() == [True, False], "what is masked is no number"
    many = np.random.default_rng(4).normal(size=(100000, 3))
    answers = hierarchy.nearest(many, memory_budget="100MiB")
    assert (answers.distances[::1000] == hierarchy.nearest(many[::1000]).distances).all()


def test_what_makes_no_sense_is_told(torus: str, built: Build, tmp_path: Path) -> None:
    hierarchy = meshhier.open(built(torus, "torus.hier"))
    for points in ([[1, 2]], [1, 2, 3, 4], "here", [["a", "b", "c"]], np.zeros((2, 3, 3)), [[1j, 0, 0]], [[True, False, True]], None, np.array([[1, 2, "3"]], object), np.array([[1, 2, None]])):
        with pytest.raises(meshhier.UsageError, match="points are an array"):
            hierarchy.nearest(points)  # type: ignore[arg-type]
    with pytest.raises(meshhier.UsageError, match="2 origins and 3 directions"):
        hierarchy.rays(np.zeros((2, 3)), np.ones((3, 3)))
    for level in (1.5, -1, 99, True):
        with pytest.raises(meshhier.UsageError, match="level"):
            hierarchy.nearest((0, 0, 0), level=level)  # type: ignore[arg-type]
    for error in (-1, float("nan"), float("inf")):
        with pytest.raises(meshhier.UsageError, match="error"):
            hierarchy.nearest((0, 0, 0), error=error)
    with pytest.raises(meshhier.UsageError, match="not both"):
        hierarchy.nearest((0, 0, 0), error=1, level=1)
    with pytest.raises(meshhier.UsageError):
        hierarchy.nearest((0, 0, 0), memory_budget="lots")

    copy = str(tmp_path / "copy.hier")
    shutil.copytree(hierarchy.path, copy)
    replaced = meshhier.open(copy)
    meshhier.build(torus, copy, settings={"partition.vertices": 300}, force=True)
    with pytest.raises(meshhier.ReplacedError):
        replaced.nearest((0, 0, 0))
    shutil.rmtree(copy)
    with pytest.raises(meshhier.ProgramError) as gone:
        replaced.nearest(np.zeros((200000, 3)))
    assert gone.value.exit_code == 4
