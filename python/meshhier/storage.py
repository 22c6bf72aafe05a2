# SPDX-License-Identifier: MIT
"""Where the files of a hierarchy lie: in a folder, or in an archive."""

from __future__ import annotations

import os
import zipfile
from typing import Protocol

from .errors import CorruptError, NotAHierarchyError


class Files(Protocol):
    """Files by their names within the hierarchy, such as "tiles/00/000000.glb"."""

    def read(self, name: str) -> bytes:
        """All bytes of a file. Raises CorruptError if it is not there."""
        ...

    def part(self, name: str, begin: int, end: int) -> bytes:
        """Bytes [begin, end) of a file; fewer where it ends before. Raises CorruptError if it is not there."""
        ...

    def close(self) -> None: ...


class Folder:
    """A hierarchy as a directory."""

    def __init__(self, path: str) -> None:
        self._path = path

    def read(self, name: str) -> bytes:
        return self.part(name, 0, -1)

    def part(self, name: str, begin: int, end: int) -> bytes:
        try:
            with open(os.path.join(self._path, *name.split("/")), "rb") as file:
                file.seek(begin)
                return file.read(end - begin if end >= 0 else -1)
        except FileNotFoundError as error:
            raise CorruptError(f"{self._path}: {name} is missing") from error

    def close(self) -> None:
        pass


class Archive:
    """A hierarchy as one file, a zip archive without compression (docs/file_format.md, section 8)."""

    def __init__(self, path: str) -> None:
        self._path = path
        try:
            self._zip = zipfile.ZipFile(path)
        except zipfile.BadZipFile as error:
            raise NotAHierarchyError(f"{path}: not an archive: {error}") from error

    def read(self, name: str) -> bytes:
        try:
            return self._zip.read(name)
        except KeyError as error:
            raise CorruptError(f"{self._path}: {name} is missing") from error
        except zipfile.BadZipFile as error:
            raise CorruptError(f"{self._path}: {name}: {error}") from error

    def part(self, name: str, begin: int, end: int) -> bytes:
        try:
            with self._zip.open(name) as file:
                file.seek(begin)
                return file.read(end - begin)
        except KeyError as error:
            raise CorruptError(f"{self._path}: {name} is missing") from error
        except zipfile.BadZipFile as error:
            raise CorruptError(f"{self._path}: {name}: {error}") from error

    def close(self) -> None:
        self._zip.close()


def open_files(path: str | os.PathLike[str]) -> Files:
    """The files of a hierarchy. Raises NotAHierarchyError if there is none."""
    name = os.fspath(path)
    if os.path.isdir(name):
        if not os.path.isfile(os.path.join(name, "hierarchy.json")):
            raise NotAHierarchyError(f"{name}: there is no hierarchy.json")
        return Folder(name)
    if not os.path.exists(name):
        raise NotAHierarchyError(f"{name}: there is no such file or folder")
    return Archive(name)
