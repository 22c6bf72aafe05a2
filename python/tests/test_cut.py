# SPDX-License-Identifier: MIT
"""Cuts are those that `meshhier export` writes."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ply import read_ply, triangle_set

import meshhier
from meshhier.tile import decode_image

FORMS = {
    "plain.hier": {},
    "packed.hier": {"storage__compression": "meshopt_zlib"},
    "small.3tz": {"storage__compression": "meshopt", "storage__positions__bits": 16},
    "exact.3tz": {"storage__compression": "zlib", "storage__positions__bits": 21},
    "early.hier": {"partition__count": 11},
}


def exported(hierarchy: meshhier.Hierarchy, to: Path, *options: str) -> tuple[Any, Any]:
    subprocess.run(
        [meshhier.find_program(), "export", hierarchy.path, *options, "-o", str(to), "--force", "--progress", "none"],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    return read_ply(str(to))


def between(hierarchy: meshhier.Hierarchy) -> float:
    """An error that one half of the model meets at level 1, and the other half does not."""
    return float(np.mean([hierarchy.error(meshhier.Node(1, i)) for i in (0, 1)]))


def assert_same(mesh: meshhier.Mesh, rows: Any, triangles: Any) -> None:
    def columns(*names: str) -> Any:
        return np.stack([rows[name] for name in names], 1) if names[0] in rows.dtype.names else None

    attributes = list(mesh.attributes)
    theirs = [columns("x", "y", "z"), columns("nx", "ny", "nz"), columns("red", "green", "blue"), *(rows[name] for name in attributes)]
    ours = [mesh.positions, mesh.normals, mesh.colours, *(mesh.attributes[name] for name in attributes)]
    assert [one is None for one in ours] == [one is None for one in theirs]
    assert len(mesh.positions) == len(rows)
    assert (triangle_set(mesh.triangles, *ours) == triangle_set(triangles, *theirs)).all()


@pytest.mark.parametrize("name", FORMS)
def test_a_cut_is_what_export_writes(name: str, torus: str, built: Any, tmp_path: Path) -> None:
    with meshhier.open(built(torus, name, **FORMS[name])) as hierarchy:
        assert hierarchy.triangles == 20736
        for level in range(hierarchy.levels):
            assert_same(hierarchy.cut(level=level), *exported(hierarchy, tmp_path / "level.ply", "--level", str(level)))
        error = between(hierarchy)
        mixed = hierarchy.cut(error=error)
        assert len({node.level for node in mixed.tiles}) > 1
        assert_same(mixed, *exported(hierarchy, tmp_path / "error.ply", "--error", str(error)))


def test_the_finest_cut_is_the_input(torus: str, built: Any) -> None:
    rows, triangles = read_ply(torus)
    mesh = meshhier.open(built(torus, "plain.hier")).cut()
    wanted = triangle_set(triangles, np.stack([rows[axis] for axis in "xyz"], 1), np.stack([rows[c] for c in ("red", "green", "blue")], 1))
    assert (triangle_set(mesh.triangles, mesh.positions, mesh.colours) == wanted).all()
    assert mesh.colours is not None and mesh.colours.dtype == np.uint8


def test_no_cut_has_a_crack(torus: str, built: Any) -> None:
    hierarchy = meshhier.open(built(torus, "plain.hier"))
    assert hierarchy.levels > 3
    one_side = [(1, 0), (2, 2), (2, 3)]
    for mesh in (hierarchy.cut(level=0), hierarchy.cut(error=between(hierarchy)), hierarchy.cut(nodes=one_side)):
        edges = np.concatenate([mesh.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
        there = {tuple(edge) for edge in edges.tolist()}
        assert len(there) == len(edges)
        assert all((b, a) in there for a, b in there), "an edge has one side alone"


def test_labels_of_faces_stay_on_their_triangles(labelled: str, built: Any, tmp_path: Path) -> None:
    hierarchy = meshhier.open(built(labelled, "labelled.hier", partition__vertices=300))
    part = next(scalar for scalar in hierarchy.scalars if scalar.name == "part")
    assert (part.kind, part.type, sorted(part.labels)) == ("label", "i32", [-500, 500, 1500])
    for options in ({"level": 0}, {"error": between(hierarchy)}, {}):
        mesh = hierarchy.cut(**options)
        labels = mesh.attributes["part"][mesh.triangles]
        assert labels.dtype == np.int32
        assert (labels == labels[:, :1]).all()
        assert set(np.unique(labels)) <= {-500, 500, 1500}
    assert_same(hierarchy.cut(), *exported(hierarchy, tmp_path / "all.ply", "--level", str(hierarchy.levels - 1)))
    assert np.isnan(hierarchy.cut().attributes["quality"]).any()
    assert hierarchy.cut().attributes["time"].dtype == np.float64


def test_a_box_takes_what_touches_it(torus: str, built: Any) -> None:
    hierarchy = meshhier.open(built(torus, "plain.hier"))
    low, high = hierarchy.bounds
    box = (low, low + (high - low) * 0.3)
    part, whole = hierarchy.cut(box=box), hierarchy.cut()
    corners = whole.positions[whole.triangles]
    inside = ((corners >= box[0]) & (corners <= box[1])).all(axis=2).any(axis=1)
    apart = ((corners < box[0]).all(axis=1) | (corners > box[1]).all(axis=1)).any(axis=1)
    found, all_of = (set(map(bytes, triangle_set(m.triangles, m.positions))) for m in (part, whole))
    assert found < all_of
    assert inside.sum() <= len(part.triangles) <= (~apart).sum()
    assert set(map(bytes, triangle_set(whole.triangles[inside], whole.positions))) <= found
    assert len(hierarchy.cut(box=(high + 1, high + 2)).triangles) == 0
    half = (low + high) / 2
    for unbounded, bounded in (((-np.inf,) * 3, low), (low - 1e30, low)):
        far, near = hierarchy.cut(box=(unbounded, half)), hierarchy.cut(box=(bounded, half))
        assert (triangle_set(far.triangles, far.positions) == triangle_set(near.triangles, near.positions)).all()
    assert len(hierarchy.cut(box=((-np.inf,) * 3, (np.inf,) * 3)).triangles) == len(whole.triangles)


@pytest.mark.parametrize("box", [((1, 1, 1), (0, 0, 0)), ((0, 0, 0),), ((0, 0), (1, 1)), ((np.nan,) * 3, (1, 1, 1)), "box", ((0, 0, 0), None)])
def test_what_is_no_box_is_refused(box: Any, torus: str, built: Any) -> None:
    with pytest.raises(meshhier.UsageError, match="a box is"):
        meshhier.open(built(torus, "plain.hier")).cut(box=box)


def test_pictures_come_with_their_tiles(tmp_path: Path) -> None:
    (tmp_path / "a.mtl").write_text("newmtl m\nmap_Kd a.png\n")
    image = pytest.importorskip("PIL.Image")
    image.new("RGB", (64, 64), (200, 100, 50)).save(tmp_path / "a.png")
    side = 40
    lines = ["mtllib a.mtl", "usemtl m"]
    lines += [f"v {x} {y} 0\nvt {x / side} {y / side}" for x in range(side) for y in range(side)]
    for x in range(side - 1):
        for y in range(1, side):
            a = x * side + y
            lines.append(f"f {a}/{a} {a + side}/{a + side} {a + side + 1}/{a + side + 1} {a + 1}/{a + 1}")
    (tmp_path / "a.obj").write_text("\n".join(lines))
    hierarchy = meshhier.build(tmp_path / "a.obj", tmp_path / "a.hier", settings={"partition.vertices": 200})
    mesh = hierarchy.cut(error=float(hierarchy.errors[1]))
    assert mesh.texcoords is not None and (mesh.texcoords >= 0).all() and (mesh.texcoords <= 1).all()
    pictures = mesh.images_as_arrays()
    assert len(pictures) == len(mesh.tiles) > 1
    for picture in pictures:
        assert picture.dtype == np.uint8 and picture.shape[2] == 3
        assert np.abs(picture[picture.shape[0] // 2, picture.shape[1] // 2].astype(int) - [200, 100, 50]).max() < 12
    places = np.unique(mesh.positions, axis=0)
    assert len(places) < len(mesh.positions), "tiles have vertices of their own, at common places"


def test_ktx2_is_told_to_be_none_that_pillow_reads() -> None:
    with pytest.raises(meshhier.Error, match="KTX2"):
        decode_image(b"\xabKTX 20\xbb\r\n\x1a\n" + bytes(100))
