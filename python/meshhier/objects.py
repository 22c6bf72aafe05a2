# SPDX-License-Identifier: MIT
"""The things that a mesh consists of: objects.bin (docs/file_format.md, section 9)."""

from __future__ import annotations

import bisect
import operator
import zlib
from collections import OrderedDict
from dataclasses import dataclass
from typing import Any, Callable, Iterator, Optional, Sequence, Union, overload

import numpy as np
from numpy.typing import NDArray

from .checksum import checksum
from .content import ByContent
from .errors import MISREAD, CorruptError, misread
from .letter_table import LETTER_TABLE
from .words import AskedWord, Letters, fits, objects_of_row

_FILE = "objects.bin"
_TYPES = ("number", "boolean", "text", "date")
_HEAD_BYTES, _END_BYTES = 12, 24
_KEY_BYTES = 255
_MOST_BYTES = 1 << 28
_KEPT_BLOCKS = 64

Value = Union[float, bool, str, None]


@dataclass(frozen=True, eq=False)
class ObjectRow(ByContent):
    """All that is known of one object.

    Attributes:
        object: its number, which the scalar of kind "object" has at each of its vertices.
        name: "" of the faces of no object.
        values: of each property, by its name; None: it has none. A date is a text as ISO 8601 has it.
        box: (2, 3): the least and the greatest coordinates of its triangles, of the input; None: it has no triangles.
        triangles: how many there are in the input.
        area: of these, in the input's units.
    """

    object: int
    name: str
    values: dict[str, Value]
    box: Optional[NDArray[np.float64]]
    triangles: int
    area: float


def _as_array(values: list[Any], kind: str) -> NDArray[Any]:
    if kind == "count":
        return np.array(values, np.int64)
    if kind == "number":
        return np.array([np.nan if value is None else value for value in values], np.float64)
    array = np.empty(len(values), object)
    array[:] = values
    return array


class _Columns:
    """Reads one column behind the other."""

    def __init__(self, data: bytes, what: str) -> None:
        self._data, self._at, self._what = data, 0, what

    def fail(self, why: str) -> CorruptError:
        return CorruptError(f"{self._what}: {why}")

    def take(self, count: int) -> bytes:
        if count > len(self._data) - self._at:
            raise self.fail("ends within a column")
        self._at += count
        return self._data[self._at - count : self._at]

    def numbers(self, count: int, kind: str) -> list[Any]:
        width = np.dtype(kind).itemsize
        planes = np.frombuffer(self.take(count * width), np.uint8).reshape(width, count)
        numbers: list[Any] = np.ascontiguousarray(planes.T).view(kind).reshape(count).tolist()
        return numbers

    def texts(self, count: int) -> list[bytes]:
        return [self.take(length) for length in self.numbers(count, "<u4")]

    def decoded(self, text: bytes) -> str:
        try:
            return text.decode("utf-8")
        except UnicodeDecodeError:
            raise self.fail("a text is no UTF-8") from None

    def marked(self, count: int) -> list[int]:
        marks = self.take(count)
        if marks and max(marks) > 1:
            raise self.fail("a mark is neither 0 nor 1")
        return [i for i, mark in enumerate(marks) if mark]

    def finish(self) -> None:
        if self._at != len(self._data):
            raise self.fail("goes on behind its last column")


@dataclass(frozen=True)
class _Block:
    begin: int
    end: int
    unpacked: int
    checksum: int
    first: int
    count: int
    key: bytes


@dataclass(frozen=True)
class _Rows:
    names: list[bytes]
    rows: list[ObjectRow]


class ObjectTable(Sequence[ObjectRow]):
    """Names and properties of a hierarchy's objects, ascending by name: `table[i]`, `len(table)`, `for row in table`.

    Reads the directory when it is first asked for something, then a block of at most 256 objects a question.
    """

    def __init__(self, facts: dict[str, Any], read: Callable[[int, int], bytes], path: str, file: str = _FILE, words: Optional["ObjectTable"] = None) -> None:
        self._what = f"{path}: {file}"
        self._read = read
        self._words = words
        self._letters: Optional[Letters] = None
        self._blocks: Optional[list[_Block]] = None
        self._firsts: list[int] = []
        self._kept: OrderedDict[int, _Rows] = OrderedDict()
        try:
            self._count, self._bytes = int(facts["count"]), int(facts["bytes"])
            directory = facts["directory"]
            self._directory = int(directory["bytes"]), int(directory["checksum"], 16)
            self.properties: dict[str, str] = {entry["name"]: entry["type"] for entry in facts["properties"]}
        except MISREAD as error:
            raise misread(f"{path}: hierarchy.json: objects", error) from error
        if any(kind not in _TYPES for kind in self.properties.values()):
            raise CorruptError(f"{path}: hierarchy.json: objects: a property has an unknown type")

    def __len__(self) -> int:
        return self._count

    def __repr__(self) -> str:
        return f"ObjectTable({self._count} objects, properties: {', '.join(self.properties) or 'none'})"

    @overload
    def __getitem__(self, key: int) -> ObjectRow: ...

    @overload
    def __getitem__(self, key: slice) -> list[ObjectRow]: ...

    def __getitem__(self, key: int | slice) -> ObjectRow | list[ObjectRow]:
        if isinstance(key, slice):
            return [self[i] for i in range(*key.indices(self._count))]
        number = operator.index(key) + (self._count if key < 0 else 0)
        if not 0 <= number < self._count:
            raise IndexError(f"there is no object {key}; there are {self._count}")
        places = self._places
        at = bisect.bisect_right(self._firsts, number) - 1
        return self._rows(at).rows[number - places[at].first]

    def __iter__(self) -> Iterator[ObjectRow]:
        for at in range(len(self._places)):
            yield from self._rows(at).rows

    def find(self, name: str) -> Optional[ObjectRow]:
        """The object of that name; None if there is none."""
        wanted = name.encode("utf-8")
        number = self._first_not(lambda other: other < wanted)
        row = self[number] if number < self._count else None
        return row if row is not None and row.name == name else None

    def range(self, prefix: str) -> range:
        """The numbers of the objects whose names begin with `prefix`."""
        start = prefix.encode("utf-8")
        begin = self._first_not(lambda name: name < start)
        return range(begin, self._first_not(lambda name: name < start or name.startswith(start)))

    def search(self, text: str) -> list[int]:
        """The numbers of the objects whose names have all words of `text`, in any order; the last one may be the beginning of a word.

        Case and accents make no difference. Reads the rows of these words, or all names of a hierarchy without a table of words, as one of up to 256 objects.
        """
        if self._letters is None:
            self._letters = Letters(LETTER_TABLE, self._corrupt) if self._words is None else self._words._own_letters()
        asked = self._letters.asked(text)
        if not asked:
            return []
        if self._words is None:
            return [row.object for row in self if fits(self._letters.words(row.name), asked)]
        found = set.intersection(*(self._words._objects_with(word) for word in asked))
        if found and max(found) >= self._count:
            raise self._words._corrupt("has an object that there is not")
        return sorted(found)

    def names(self) -> list[str]:
        """The names of all objects, in their order."""
        return [row.name for row in self]

    def column(self, name: str) -> list[Value]:
        """The values of a property, one of each object. Raises KeyError if there is no such property."""
        if name not in self.properties:
            raise KeyError(name)
        return [row.values[name] for row in self]

    def columns(self) -> dict[str, NDArray[Any]]:
        """All of the table as arrays, one value of each object, in their order: name -> (n,).

        Properties, and the facts `name`, `area` and `triangles` (`object.name` and so on where a property has that name).
        Numbers are float64, NaN where there is none; texts, dates and booleans are Python's, None where there is none.
        """
        facts: dict[str, list[Any]] = {"name": [], "area": [], "triangles": []}
        values: dict[str, list[Any]] = {name: [] for name in self.properties}
        for row in self:
            for name, column in facts.items():
                column.append(getattr(row, name))
            for name, column in values.items():
                column.append(row.values[name])
        kinds = {"area": "number", "triangles": "count"}
        columns = {f"object.{name}" if name in values else name: _as_array(column, kinds.get(name, "text")) for name, column in facts.items()}
        return columns | {name: _as_array(column, self.properties[name]) for name, column in values.items()}

    def to_pandas(self) -> Any:
        """The columns as a `pandas.DataFrame`, a row an object, in their order; needs pandas."""
        import pandas

        return pandas.DataFrame(self.columns()).rename_axis("object")

    # A table of words.

    def _corrupt(self, why: str) -> CorruptError:
        return CorruptError(f"{self._what}: {why}")

    def _own_letters(self) -> Letters:
        text = self[0].values.get("objects") if self._count and self[0].name == "" else None
        if not isinstance(text, str):
            raise self._corrupt("lacks the table of letters")
        return Letters(text, self._corrupt)

    def _objects_with(self, asked: AskedWord) -> set[int]:
        rows = self.range(asked.word if asked.is_beginning else asked.word + " ")
        return {number for row in (self[i] for i in rows) for number in objects_of_row(row.name, str(row.values["objects"] or ""), self._corrupt)}

    # The file.

    @property
    def _places(self) -> list[_Block]:
        if self._blocks is None:
            self._blocks = self._read_directory()
            self._firsts = [block.first for block in self._blocks]
        return self._blocks

    def _first_not(self, is_before: Callable[[bytes], bool]) -> int:
        places = self._places
        low, high = 0, len(places)
        while low < high:
            middle = (low + high) // 2
            key = places[middle].key
            name = key if len(key) < _KEY_BYTES else self._rows(middle).names[0]
            low, high = (middle + 1, high) if is_before(name) else (low, middle)
        if low == 0:
            return 0
        names = self._rows(low - 1).names
        return places[low - 1].first + next((i for i, name in enumerate(names) if not is_before(name)), len(names))

    def _unpacked(self, begin: int, end: int, expected: int, size: int) -> bytes:
        data = self._read(begin, end)
        if len(data) != end - begin or checksum(data) != expected:
            raise CorruptError(f"{self._what}: a part of it has another checksum than it was made with: it is damaged")
        try:
            return zlib.decompressobj(31).decompress(data, size)
        except zlib.error as error:
            raise CorruptError(f"{self._what}: {error}") from error

    def _read_directory(self) -> list[_Block]:
        size, expected = self._directory
        end = self._bytes - _END_BYTES - size
        if end < _HEAD_BYTES:
            raise CorruptError(f"{self._what}: its directory does not fit")
        columns = _Columns(self._unpacked(end, end + size, expected, _MOST_BYTES), f"{self._what}: directory")
        properties, count = columns.numbers(1, "<u4")[0], columns.numbers(1, "<u4")[0]
        kinds = [_TYPES[kind] if kind < len(_TYPES) else "" for kind in columns.take(properties)]
        if list(zip((columns.decoded(name) for name in columns.texts(properties)), kinds)) != list(self.properties.items()):
            raise columns.fail("its properties are not those of the manifest")
        counts, sizes, unpacked = (columns.numbers(count, "<u4") for _ in range(3))
        sums, keys = columns.numbers(count, "<u8"), columns.texts(count)
        columns.finish()
        blocks: list[_Block] = []
        first, begin = 0, _HEAD_BYTES
        for objects, size, plain, expected, key in zip(counts, sizes, unpacked, sums, keys):
            blocks.append(_Block(begin, begin + size, min(plain, _MOST_BYTES), expected, first, objects, key))
            first, begin = first + objects, begin + size
        if first != self._count or begin != end or 0 in counts:
            raise columns.fail("its blocks are not all of the file")
        return blocks

    def _rows(self, at: int) -> _Rows:
        if at in self._kept:
            self._kept.move_to_end(at)
            return self._kept[at]
        rows = self._kept[at] = self._read_block(self._places[at])
        if len(self._kept) > _KEPT_BLOCKS:
            self._kept.popitem(last=False)
        return rows

    def _read_block(self, block: _Block) -> _Rows:
        columns = _Columns(self._unpacked(block.begin, block.end, block.checksum, block.unpacked), f"{self._what}: block of object {block.first}")
        count = block.count
        names = columns.texts(count)
        if names[0][:_KEY_BYTES] != block.key or any(a >= b for a, b in zip(names, names[1:])):
            raise columns.fail("its names do not ascend")
        with_box = columns.marked(count)
        corners = np.array([columns.numbers(len(with_box), "<f8") for _ in range(6)]).T.reshape(-1, 2, 3)
        boxes = dict(zip(with_box, corners))
        triangles, areas = columns.numbers(count, "<u8"), columns.numbers(count, "<f8")
        if max(triangles) >= 1 << 63:  # columns() has them as int64
            raise columns.fail("an object has more triangles than a mesh can have")
        values = {name: self._read_values(columns, kind, count) for name, kind in self.properties.items()}
        columns.finish()
        return _Rows(names, [
            ObjectRow(block.first + i, columns.decoded(names[i]), {name: column[i] for name, column in values.items()}, boxes.get(i), triangles[i], areas[i])
            for i in range(count)
        ])

    @staticmethod
    def _read_values(columns: _Columns, kind: str, count: int) -> list[Value]:
        marked = columns.marked(count)
        there: Sequence[Value]
        if kind == "number":
            there = columns.numbers(len(marked), "<f8")
        elif kind == "boolean":
            flags = set(columns.marked(len(marked)))
            there = [i in flags for i in range(len(marked))]
        else:
            there = [columns.decoded(text) for text in columns.texts(len(marked))]
        values: list[Value] = [None] * count
        for row, value in zip(marked, there):
            values[row] = value
        return values
