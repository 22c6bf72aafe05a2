# SPDX-License-Identifier: MIT
"""The objects of a hierarchy: their names and properties."""

from __future__ import annotations

import gzip
import json
import struct
import subprocess
from pathlib import Path
from typing import Any, Callable, Optional

import numpy as np
import pytest

import meshhier
from meshhier.checksum import checksum
from meshhier.letter_table import LETTER_TABLE
from meshhier.objects import ObjectTable
from meshhier.words import AskedWord, Letters, fits

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


def test_an_object_of_more_triangles_than_64_bits_count_is_refused() -> None:
    with pytest.raises(meshhier.CorruptError, match="more triangles than"):
        table([{**row(0), "triangles": 2**63}])[0]


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

def words_of(names: list[str], letters: str, change: Callable[[str], str] = lambda text: text) -> ObjectTable:
    """Names with a table of words, as docs/file_format.md describes it (section 9.1); `change`: what is done to the objects of each word."""
    found: dict[str, list[int]] = {}
    for number, name in enumerate(names):
        for word in set(Letters(letters, ValueError).words(name)):
            found.setdefault(word, []).append(number)
    rows = [("", letters)] + sorted((f"{word} {all[0]:06x}", change("".join(number_text(b - a - 1) for a, b in zip(all, all[1:])))) for word, all in found.items())
    words = small_table([(name, text) for name, text in rows], [("objects", "text")], "object_words.bin")
    return small_table([(name, None) for name in names], [], "objects.bin", words)


def number_text(number: int) -> str:
    return chr(number) if number < 64 else chr(64 + number % 64) + number_text(number // 64)


def small_table(rows: list[tuple[str, Optional[str]]], properties: list[tuple[str, str]], file: str, words: Optional[ObjectTable] = None) -> ObjectTable:
    """A table of one block, with at most one property."""
    count = len(rows)
    plain = texts([name for name, _ in rows]) + bytes(17 * count)
    if properties:
        there = [text for _, text in rows if text is not None]
        plain += bytes(text is not None for _, text in rows) + texts(there)
    packed = gzip.compress(plain)
    directory = struct.pack("<II", len(properties), 1) + bytes(TYPES.index(kind) for _, kind in properties) + texts([name for name, _ in properties])
    directory += struct.pack("<IIIQ", count, len(packed), len(plain), checksum(packed)) + texts([rows[0][0]])
    end = gzip.compress(directory)
    data = b"MHTABLE\n\1\0\0\0" + packed + end + struct.pack("<QQQ", len(end), len(directory), checksum(end))
    facts = {"bytes": len(data), "count": count, "directory": {"bytes": len(end), "checksum": f"{checksum(end):016x}"}, "properties": [{"name": name, "type": kind} for name, kind in properties]}
    return ObjectTable(facts, lambda begin, end: data[begin:end], "town.hier", file, words)


LETTERS = "0 30 1 0 20\n3a 7 1 0 20\n41 1a 1 1 61\n5b 6 1 0 20\ndf 1 1 0 73 73\ne9 1 1 0 65\n3040 c0 1 2\n4e00 5200 1 2\n"
STREETS = sorted(["", "St. Mary's Church", "bldg_7 church of St Mark", "Churchyard", "Große Straße", "東京都庁", "서울"], key=str.encode)


@pytest.mark.parametrize(
    "text, expected",
    [("church", ["Churchyard", "St. Mary's Church", "bldg_7 church of St Mark"]), ("mar CHURCH", []), ("church mar", ["St. Mary's Church", "bldg_7 church of St Mark"]),
     ("strasse", ["Große Straße"]), ("東京都", ["東京都庁"]), ("京", ["東京都庁"]), ("서", ["서울"]), ("x", []), (" -", [])],
)
def test_names_are_found_by_their_words(text: str, expected: list[str]) -> None:
    table = words_of(STREETS, LETTERS)
    assert [STREETS[number] for number in table.search(text)] == expected


def test_few_names_are_read_whole() -> None:
    table = small_table([(name, None) for name in STREETS], [], "objects.bin")
    assert [STREETS[number] for number in table.search("church mar")] == ["St. Mary's Church", "bldg_7 church of St Mark"]
    assert [STREETS[number] for number in table.search("strasse")] == ["Große Straße"]


FOLDED = json.loads((Path(__file__).resolve().parents[2] / "tests/data/folded_words.json").read_text(encoding="utf-8"))


def test_names_and_texts_have_the_words_that_all_programs_give_them() -> None:
    letters = Letters(LETTER_TABLE, ValueError)
    assert [(each["name"], letters.words(each["name"])) for each in FOLDED["names"]] == [(each["name"], each["words"]) for each in FOLDED["names"]]
    for each in FOLDED["texts"]:
        assert letters.asked(each["text"]) == [AskedWord(asked["word"], asked["is_beginning"]) for asked in each["asked"]], each["text"]


def test_names_are_found_by_the_same_words_with_a_table_of_words_or_without() -> None:
    words = {each["name"]: each["words"] for each in FOLDED["names"]}
    names = sorted(words, key=str.encode)
    tables = small_table([(name, None) for name in names], [], "objects.bin"), words_of(names, LETTER_TABLE)
    for each in FOLDED["texts"]:
        asked = [AskedWord(one["word"], one["is_beginning"]) for one in each["asked"]]
        expected = [i for i, name in enumerate(names) if asked and fits(words[name], asked)]
        assert [table.search(each["text"]) for table in tables] == [expected, expected], each["text"]


def test_the_program_finds_the_same_among_few_names(built: Callable[..., str], tmp_path: Path) -> None:
    mesh = tmp_path / "names.obj"
    lines = [f"o {each['name']}\nv {2 * i} 0 0\nv {2 * i + 1} 0 0\nv {2 * i} 1 0\nf -3 -2 -1\n" for i, each in enumerate(FOLDED["names"])]
    mesh.write_text("".join(lines), encoding="utf-8")
    hierarchy = built(str(mesh), "names.hier")
    with meshhier.open(hierarchy) as model:
        assert model.objects is not None
        for text in (each["text"] for each in FOLDED["texts"] if each["asked"]):
            told = subprocess.run([meshhier.find_program(), "inspect", hierarchy, f"--find={text}", "--json"], check=True, capture_output=True).stdout
            assert model.objects.search(text) == [json.loads(line)["object"] for line in told.splitlines()], text


@pytest.mark.parametrize("letters", ["x\n", "41 1\n", "41 0 1 0\n", "61 1 1 0\n41 1 1 0\n", "41 1 1 1\n", "110000 1 1 0\n"])
def test_a_wrong_table_of_letters_is_refused(letters: str) -> None:
    words = small_table([("", letters)], [("objects", "text")], "object_words.bin")
    with pytest.raises(meshhier.CorruptError, match="object_words.bin"):
        small_table([("a", None)], [], "objects.bin", words).search("a")


@pytest.mark.parametrize("text", ["A", "\x07", "\u00e9", "AAAAAA"])
def test_wrong_objects_of_a_word_are_refused(text: str) -> None:
    with pytest.raises(meshhier.CorruptError, match="object_words.bin"):
        words_of(["a", "b"], LETTERS, lambda _: text).search("b")
