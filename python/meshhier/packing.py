# SPDX-License-Identifier: MIT
"""Directories of hierarchies as archives, and back (docs/file_format.md, section 8). No tile is made anew: files keep their bytes."""

from __future__ import annotations

import hashlib
import os
import pathlib
import re
import shutil
import struct
import zlib
from contextlib import nullcontext
from dataclasses import dataclass
from typing import BinaryIO, ContextManager, Iterator

from .asked import Path, beside, exists, new_file, output_path, require_folder
from .errors import CorruptError, ExistsError, ReplacedError, UsageError, file_errors
from .hierarchy import Hierarchy, Place
from .storage import Archive, Folder

_INDEX = "@3dtilesIndex1@"
_DATE = 0x0021  # 1980-01-01
_FULL16, _FULL32 = 0xFFFF, 0xFFFFFFFF


@dataclass(frozen=True)
class _Entry:
    name: bytes
    offset: int
    size: int
    crc: int

    @property
    def _facts(self) -> bytes:
        """What both headers have."""
        version = 45 if self.offset >= _FULL32 else 10
        return struct.pack("<5H3I2H", version, 0, 0, 0, _DATE, self.crc, self.size, self.size, len(self.name), 0)

    def local_header(self) -> bytes:
        return b"PK\3\4" + self._facts + self.name

    def central_header(self) -> bytes:
        extra = struct.pack("<2HQ", 1, 8, self.offset) if self.offset >= _FULL32 else b""
        facts = self._facts[:-2] + struct.pack("<H", len(extra))
        return b"PK\1\2" + struct.pack("<H", 45) + facts + struct.pack("<3HII", 0, 0, 0, 0, min(self.offset, _FULL32)) + self.name + extra


class _ArchiveWriter:
    """Writes files one behind the other, then the index and the directory."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self._entries: list[_Entry] = []
        self._end = 0

    def add(self, name: str, data: bytes) -> None:
        if len(data) >= _FULL32:
            raise UsageError(f"{name} has {len(data)} bytes; a file in an archive has at most {_FULL32 - 1}")
        entry = _Entry(name.encode("ascii"), self._end, len(data), zlib.crc32(data))
        self._entries.append(entry)
        self._write(entry.local_header() + data)

    def finish(self) -> None:
        places = [(*struct.unpack("<2Q", hashlib.md5(entry.name, usedforsecurity=False).digest()), entry.offset) for entry in self._entries]
        self.add(_INDEX, b"".join(struct.pack("<3Q", *place) for place in sorted(places)))
        begin = self._end
        for entry in self._entries:
            self._write(entry.central_header())
        self._write(self._end_records(begin, self._end - begin))

    def _end_records(self, begin: int, size: int) -> bytes:
        count, at = len(self._entries), self._end
        end = struct.pack("<4s4H2IH", b"PK\5\6", 0, 0, min(count, _FULL16), min(count, _FULL16), min(size, _FULL32), min(begin, _FULL32), 0)
        if count < _FULL16 and begin < _FULL32 and size < _FULL32:
            return end
        end64 = struct.pack("<4sQ2H2I4Q", b"PK\6\6", 44, 45, 45, 0, 0, count, count, size, begin)
        return end64 + struct.pack("<4sIQI", b"PK\6\7", 0, at, 1) + end

    def _write(self, data: bytes) -> None:
        self._file.write(data)
        self._end += len(data)


def _names(hierarchy: Hierarchy) -> Iterator[str]:
    """All files of a directory, in the order of an archive."""
    manifest = hierarchy.manifest
    first, *tiles = (hierarchy._manifest.tile_name(node) for node in hierarchy.tree.tiles())
    objects = manifest.get("objects")
    yield from ("hierarchy.json", first, "tiles.bin", "outline.glb")
    yield from ["preview.webp"] if manifest.get("preview") else []
    yield from ["objects.bin"] if objects else []
    yield from tiles
    yield from _tilesets(hierarchy)
    yield from ["object_words.bin"] if objects and objects.get("words") else []


def _tilesets(hierarchy: Hierarchy) -> list[str]:
    folder = os.path.join(hierarchy._place[0], "tilesets")
    found = [f"tilesets/{level}/{name}" for level in (os.listdir(folder) if os.path.isdir(folder) else []) for name in os.listdir(os.path.join(folder, level))]
    names = ["tileset.json", *sorted(found, key=lambda name: (name.split("/")[1], len(name), name))]
    if len(names) != hierarchy.manifest.get("tileset", {}).get("files", len(names)):
        raise CorruptError(f"{hierarchy.path}: tilesets has not as many files as the manifest says")
    return names


def _opened(place: Place) -> ContextManager[Hierarchy]:
    """A hierarchy, which stays open behind the block if it was before."""
    if isinstance(place, Hierarchy):
        return nullcontext(place)
    return Hierarchy(place)


def pack(hierarchy: Place, output: Path, *, force: bool = False) -> pathlib.Path:
    """Makes one file, NAME.3tz, of a directory, NAME.hier: with the bytes that a build of an archive has. Returns its path.

    Raises ExistsError if it is there already; CorruptError if the directory is not whole; ReplacedError if another build takes its
    place meanwhile; FileError if the system refuses to read or write a file.
    """
    if not output_path(output).lower().endswith(".3tz"):
        raise UsageError(f"{output_path(output)}: the name of an archive ends in .3tz")
    with _opened(hierarchy) as source:
        if not isinstance(source._files, Folder):
            raise UsageError(f"{source.path}: expected a directory NAME.hier of this machine; unpack() makes one of an archive")
        _pack(source, output, force)
    return pathlib.Path(output)


def _pack(source: Hierarchy, output: Path, force: bool) -> None:
    with new_file(output, force) as file:
        writer = _ArchiveWriter(file)
        for name in _names(source):
            writer.add(name, source._files.read(name))
        writer.finish()
        if source._is_replaced():
            raise ReplacedError(f"{source.path}: another hierarchy has taken its place meanwhile: pack it again")


def unpack(archive: Place, output: Path, *, force: bool = False) -> pathlib.Path:
    """Makes a directory, NAME.hier, of an archive, NAME.3tz, also of one at an address: an open one, if that needs headers. It is there
    complete or not at all. Returns its path.

    Raises ExistsError if it is there already (`force` replaces a hierarchy, and nothing else); CorruptError, ReplacedError, FileError.
    """
    place = os.path.abspath(output_path(output))
    with _opened(archive) as source:
        if not isinstance(source._files, Archive):
            raise UsageError(f"{source.path}: expected an archive NAME.3tz; pack() makes one of a directory")
        _require_free(place, force)
        _unpack(source._files, place)
    return pathlib.Path(output)


def _unpack(files: Archive, place: str) -> None:
    made = beside(place)
    with file_errors(place, made):
        os.mkdir(made)
        try:
            for name in files.names():
                _unpack_file(files, name, made)
            _put(made, place)
        except BaseException:
            shutil.rmtree(made, ignore_errors=True)
            raise


def _require_free(place: str, force: bool) -> None:
    if not os.path.lexists(place):
        return require_folder(place)
    if not force:
        raise exists(place)
    if not os.path.isfile(os.path.join(place, "hierarchy.json")):
        raise ExistsError(f"{place} is no hierarchy, so force=True does not replace it")


def _unpack_file(files: Archive, name: str, folder: str) -> None:
    if name == _INDEX:
        return
    if not re.fullmatch(r"[!-\[\]-~]{1,255}", name) or {"", ".", ".."} & set(name.split("/")):
        raise CorruptError(f"{name!r} is no name of a file in an archive")
    path = os.path.join(folder, *name.split("/"))
    try:
        os.makedirs(os.path.dirname(path), exist_ok=True)
        file = open(path, "xb")
    except (FileExistsError, NotADirectoryError):
        raise CorruptError(f"{name!r} is twice in the archive, or a file and a folder") from None
    with file:
        file.write(files.read(name))


def _put(made: str, place: str) -> None:
    """Gives a directory its name; one that has it already is removed then."""
    if not os.path.lexists(place):
        os.rename(made, place)
        return
    old = beside(place)
    os.rename(place, old)
    os.rename(made, place)
    shutil.rmtree(old)
