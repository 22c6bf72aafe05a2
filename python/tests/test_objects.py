# SPDX-License-Identifier: MIT
"""The objects of a hierarchy: their names and properties."""

from __future__ import annotations

import gzip
import struct
import subprocess
from pathlib import Path
from typing import Any, Callable, Optional

import numpy as np
import pytest

import meshhier
from meshhier.checksum import checksum
from meshhier.objects import ObjectTable

PROPERTIES = [("height", "number"), ("listed", "boolean"), ("use", "text"), ("built", "date")]
TYPES = ["number", "boolean", "text", "date"]
FORMS = {"number": "d", "boolean": "B"}


def planes(form: str, numbers: list[Any]) -> bytes:
    """Little endian numbers: the lowest byte of each, then the next one of each."""
    packed = [struct.pack("<" + form, number) for number in numbers]
    return b"".join(bytes(number[plane] for number in packed) for plane in range(struct.calcsize("<" + form)))


def texts(values: list[str]) -> bytes:
    coded = [value.encode() for value in values]
    return planes("I", [len(value) for value in coded]) + b"".join(coded)


def block(rows: list[dict[str, Any]]) -> bytes:
    boxes = [row["box"] for row in rows if row["box"]]
    data = texts([row["name"] for row in rows]) + bytes(1 if row["box"] else 0 for row in rows)
    data += b"".join(planes("d", [box[k] for box in boxes]) for k in range(6))
    data += planes("Q", [row["triangles"] for row in rows]) + planes("d", [row["area"] for row in rows])
    for name, kind in PROPERTIES:
        there = [row[name] for row in rows if row[name] is not None]
        data += bytes(row[name] is not None for row in rows) + (planes(FORMS[kind], there) if kind in FORMS else texts(there))
    return data


def table(rows: list[dict[str, Any]], change: Callable[[bytes], bytes] = lambda data: data) -> ObjectTable:
    """A table as docs/file_format.md describes it, with right checksums; `change`: what is done to each block before."""
    groups = [rows[i : i + 256] for i in range(0, len(rows), 256)]
    plain = [change(block(group)) for group in groups]
    packed = [gzip.compress(data) for data in plain]
    directory = struct.pack("<II", len(PROPERTIES), len(groups)) + bytes(TYPES.index(kind) for _, kind in PROPERTIES) + texts([name for name, _ in PROPERTIES])
    for numbers in ([len(group) for group in groups], [len(data) for data in packed], [len(data) for data in plain]):
        directory += planes("I", numbers)
    directory += planes("Q", [checksum(data) for data in packed])
    keys = [group[0]["name"].encode()[:255] for group in groups]
    directory += planes("I", [len(key) for key in keys]) + b"".join(keys)
    end = gzip.compress(directory)
    data = b"MHTABLE\n\1\0\0\0" + b"".join(packed) + end + struct.pack("<QQQ", len(end), len(directory), checksum(end))
    facts = {
        "bytes": len(data),
        "count": len(rows),
        "directory": {"bytes": len(end), "checksum": f"{checksum(end):016x}"},
        "properties": [{"name": name, "type": kind} for name, kind in PROPERTIES],
    }
    return ObjectTable(facts, lambda begin, stop: data[begin:stop], "a.hier")


def row(i: int, name: Optional[str] = None) -> dict[str, Any]:
    return {
        "name": f"Straße {i // 100}/{i:04}" if name is None else name,
        "box": None if i % 10 == 0 else (i, -2.0, 0.0, i + 1.0, 2.0, i / 8),
        "triangles": 12,
        "area": i / 2,
        "height": i / 8 if i % 3 else None,
        "listed": i % 2 == 0 if i % 5 else None,
        "use": "café" if i % 4 else None,
        "built": "1999-12-31" if i % 7 else None,
    }


def test_rows_are_those_of_the_file() -> None:
    rows = [row(i) for i in range(600)]
    objects = table(rows)
    assert len(objects) == 600 and list(objects.properties.items()) == PROPERTIES
    for i, (found, wanted) in enumerate(zip(objects, rows)):
        assert (found.object, found.name, found.triangles, found.area) == (i, wanted["name"], 12, i / 2)
        assert found.values == {name: wanted[name] for name, _ in PROPERTIES}
        assert (found.box is None) == (wanted["box"] is None) and (found.box is None or found.box.ravel().tolist() == list(wanted["box"]))
    assert objects[-1].name == rows[-1]["name"] and [each.object for each in objects[254:258]] == [254, 255, 256, 257]
    assert objects.names() == [each["name"] for each in rows] and objects.column("use")[:5] == [None, "café", "café", "café", None]
    with pytest.raises(IndexError):
        objects[600]
    with pytest.raises(KeyError):
        objects.column("width")


def test_names_are_found() -> None:
    objects = table([row(i) for i in range(600)])
    for i in (0, 255, 256, 257, 511, 599):
        found = objects.find(f"Straße {i // 100}/{i:04}")
        assert found is not None and found.object == i
    assert objects.find("Straße") is None and objects.find("") is None and objects.find("z") is None
    assert objects.range("Straße 2/") == range(200, 300) and objects.range("") == range(600) and objects.range("x") == range(600, 600)


def test_names_that_begin_alike_are_found() -> None:
    start = "b" * 300
    objects = table([row(1, "a")] + [row(i, f"{start}{i:03}") for i in range(600)])
    assert objects.range(start + "1") == range(101, 201)
    found = objects.find(start + "599")
    assert found is not None and found.object == 600


@pytest.mark.parametrize("change", [lambda data: data + b"\0", lambda data: data[:-1], lambda data: b"\xff\xff\xff\xff" + data[4:]])
def test_damaged_blocks_are_refused(change: Callable[[bytes], bytes]) -> None:
    with pytest.raises(meshhier.CorruptError):
        table([row(i) for i in range(5)], change)[0]


def test_a_hierarchy_without_objects_has_none(torus: str, built: Callable[..., str]) -> None:
    with meshhier.open(built(torus, "plain.hier")) as plain:
        assert plain.objects is None


def test_columns_are_arrays() -> None:
    objects = table([row(i) for i in range(600)])
    columns = objects.columns()
    assert list(columns) == ["name", "area", "triangles", "height", "listed", "use", "built"]
    assert columns["name"].tolist() == objects.names() and columns["triangles"].dtype == np.int64
    assert np.array_equal(columns["area"], np.arange(600) / 2)
    assert np.isnan(columns["height"][::3]).all() and columns["height"][1] == 0.125
    assert columns["listed"][:6].tolist() == [None, False, True, False, True, None]
    assert int(((columns["height"] > 10) & (columns["use"] == "café")).sum()) == sum(1 for i in range(81, 600) if i % 3 and i % 4)


def test_triangles_have_objects(meshgen: str, built: Callable[..., str], tmp_path: Path) -> None:
    mesh = str(tmp_path / "city.obj")
    subprocess.run([meshgen, "city", "--buildings", "300", "-o", mesh], check=True, stdout=subprocess.DEVNULL)
    with meshhier.open(built(mesh, "city.hier", objects__table=str(tmp_path / "city.csv"))) as city:
        assert city.objects is not None
        table = city.objects.columns()
        whole = city.cut()
        assert whole.triangle_objects is not None
        assert np.array_equal(np.bincount(whole.triangle_objects, minlength=len(city.objects)), table["triangles"])
        a, b, c = (whole.positions[whole.triangles[:, k]] for k in range(3))
        areas = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
        assert np.allclose(np.bincount(whole.triangle_objects, areas, len(city.objects)), table["area"])
        high = (table["height"] > 20) & (table["area"] > 500)
        towers = whole.take(high[whole.triangle_objects])
        assert towers.triangle_objects is not None and 0 < len(towers.triangles) == table["triangles"][high].sum()
        assert set(towers.triangle_objects.tolist()) == set(np.flatnonzero(high).tolist())
        for values in city.cut(level=0).attributes.values():
            assert values.max() < len(city.objects)
