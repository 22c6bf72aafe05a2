# SPDX-License-Identifier: MIT
"""Where the files of a hierarchy lie: in a folder, or in an archive."""

from __future__ import annotations

import os
import struct
import zipfile
from typing import Any, Iterable, Protocol

from .errors import CorruptError, NotAHierarchyError, UsageError, file_errors


#: What `zipfile` raises of archives that are none.
_BROKEN = (zipfile.BadZipFile, NotImplementedError, ValueError, EOFError, struct.error)
_MOST_BYTES = 1 << 63
_PACKED = 1 << 0 | 1 << 5 | 1 << 6  # flags of a file: encrypted, patched, strongly encrypted


class Files(Protocol):
    """Files by their names within the hierarchy, such as "tiles/00/000000.glb"."""

    def read(self, name: str) -> bytes:
        """All bytes of a file. Raises CorruptError if it is not there."""
        ...

    def part(self, name: str, begin: int, end: int) -> bytes:
        """Bytes [begin, end) of a file; fewer where it ends before. Raises CorruptError if it is not there."""
        ...

    def expect(self, files: Iterable[tuple[str, int]]) -> None:
        """Names and sizes of files that will be read soon: from afar they begin to come."""
        ...

    def require_open(self) -> None:
        """Raises UsageError if it is closed."""
        ...

    def close(self) -> None: ...


def closed(path: str) -> UsageError:
    """What is raised where a hierarchy that is closed is read."""
    return UsageError(f"{path}: it is closed: open it again with meshhier.open()")


class Folder:
    """A hierarchy as a directory."""

    def __init__(self, path: str) -> None:
        self._path = path
        self._place = os.path.abspath(path)
        self._is_closed = False

    def read(self, name: str) -> bytes:
        return self.part(name, 0, -1)

    def part(self, name: str, begin: int, end: int) -> bytes:
        self.require_open()
        with file_errors(self._path):
            try:
                with open(os.path.join(self._place, *name.split("/")), "rb") as file:
                    file.seek(begin)
                    return file.read(end - begin if end >= 0 else -1)
            except FileNotFoundError as error:
                raise CorruptError(f"{self._path}: {name} is missing") from error

    def expect(self, files: Iterable[tuple[str, int]]) -> None:
        """Files are near."""

    def require_open(self) -> None:
        if self._is_closed:
            raise closed(self._path)

    def close(self) -> None:
        self._is_closed = True


class Archive:
    """A hierarchy as one file, a zip archive without compression (docs/file_format.md, section 8). Each process opens it by itself,
    as processes that share an open file move each other's place in it."""

    def __init__(self, path: str) -> None:
        self._path = path
        self._place = os.path.abspath(path)
        self._is_closed = False
        self._open()
        if "hierarchy.json" not in self._zip.NameToInfo:
            self.close()
            raise NotAHierarchyError(f"{path}: there is no hierarchy.json in this archive")

    def _open(self) -> None:
        try:
            with file_errors(self._path):
                self._zip = self._read_directory()
            if not all(facts.filename and 0 <= facts.header_offset < _MOST_BYTES for facts in self._zip.infolist()):
                raise zipfile.BadZipFile("a file in it has no name, or a place that no file has")
        except _BROKEN as error:
            raise NotAHierarchyError(f"{self._path}: not an archive: {error}; a hierarchy is a folder NAME.hier or an archive NAME.3tz") from error
        self._process = os.getpid()

    def _read_directory(self) -> zipfile.ZipFile:
        return zipfile.ZipFile(self._place)

    def __reduce__(self) -> tuple[Any, ...]:
        self.require_open()
        return Archive, (self._place,)

    def read(self, name: str) -> bytes:
        return self.part(name, 0, -1)

    def part(self, name: str, begin: int, end: int) -> bytes:
        self.require_open()
        try:
            facts = self._zip.getinfo(name)
            if facts.compress_type != zipfile.ZIP_STORED or facts.flag_bits & _PACKED:
                raise CorruptError(f"{self._path}: {name} is packed or encrypted; in a 3tz nothing is")
            with self._zip.open(facts) as file:
                file.seek(begin)
                return file.read(end - begin if end >= 0 else -1)
        except KeyError as error:
            raise CorruptError(f"{self._path}: {name} is missing") from error
        except _BROKEN as error:
            raise CorruptError(f"{self._path}: {name}: {error}") from error

    def expect(self, files: Iterable[tuple[str, int]]) -> None:
        """Files are near."""

    def names(self) -> list[str]:
        """Of all files, in their order."""
        self.require_open()
        return [facts.filename for facts in self._zip.infolist() if not facts.is_dir()]

    def require_open(self) -> None:
        if self._is_closed:
            raise closed(self._path)
        if self._process != os.getpid():
            self._open()

    def close(self) -> None:
        self._is_closed = True
        self._zip.close()


def open_files(name: str) -> Files:
    """The files of a hierarchy. Raises NotAHierarchyError if there is none."""
    if os.path.isdir(name):
        if not os.path.isfile(os.path.join(name, "hierarchy.json")):
            raise NotAHierarchyError(f"{name}: there is no hierarchy.json")
        return Folder(name)
    if not os.path.exists(name):
        hint = "; addresses are https:// and http://, files are named by their paths" if "://" in name else ""
        raise NotAHierarchyError(f"{name}: there is no such file or folder{hint}")
    return Archive(name)
