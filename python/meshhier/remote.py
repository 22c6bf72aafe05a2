# SPDX-License-Identifier: MIT
"""Hierarchies on the web: archives by their parts, directories file by file. Nothing can be listed there."""

from __future__ import annotations

import os
import threading
import urllib.parse
import zipfile
from collections import OrderedDict
from dataclasses import dataclass, field
from typing import Any, Optional

from .asked import is_web_address, whole
from .errors import CorruptError, NetworkError, NotAHierarchyError, ReplacedError, UsageError
from .http_client import Address, Answer, Headers, HttpClient, unpacked, without_secrets
from .storage import Archive, Files, closed, open_files

#: Small reads fetch whole blocks, so that many of them are few requests.
BLOCK = 1 << 16
#: What is asked for when a file is opened: most tiles have less.
_START = 1 << 20
_MOST_READ = 1 << 31
_MOST_DIRECTORY = 1 << 28
#: Bytes of parts that stay in memory, if nobody says how many.
CACHE_BYTES = 64 << 20


@dataclass(frozen=True)
class Web:
    """An address, perhaps with secrets, as it was given; as messages have it; and how it is read."""

    address: str = field(repr=False)
    shown: str
    headers: Optional[Headers] = field(repr=False)
    cache_bytes: int


class Blocks:
    """Blocks of files that have come, up to a budget; the ones used last stay. Thread-safe."""

    def __init__(self, most_bytes: int) -> None:
        self._most, self._bytes = most_bytes, 0
        self._blocks: OrderedDict[tuple[str, int], bytes] = OrderedDict()
        self._lock = threading.Lock()

    def find(self, file: str, number: int) -> Optional[bytes]:
        with self._lock:
            if (file, number) in self._blocks:
                self._blocks.move_to_end((file, number))
            return self._blocks.get((file, number))

    def keep(self, file: str, number: int, data: bytes) -> None:
        with self._lock:
            self._bytes += len(data) - len(self._blocks.pop((file, number), b""))
            self._blocks[file, number] = data
            while self._bytes > self._most and self._blocks:
                self._bytes -= len(self._blocks.popitem(last=False)[1])


class RemoteFile:
    """A file on the web, as far as `zipfile` reads files. Thread-safe but for the place that seek() sets."""

    def __init__(self, client: HttpClient, address: Address, start: Answer, blocks: Blocks, *, is_packed_itself: bool = False) -> None:
        """`start`: its first bytes, or all. `is_packed_itself`: what the host calls its Content-Encoding is the file."""
        self._client, self._address, self._start, self._blocks = client, address, start, blocks
        self.most_bytes = _MOST_READ  # of a part
        self._at = 0
        self._whole = unpacked(address, start) if start.is_whole else None
        if self._whole is not None:
            self.size = len(self._whole)
            return
        if start.encoding and not is_packed_itself:
            raise NetworkError(f"{address.shown}: the host sends it packed (Content-Encoding), and then parts of it say nothing: switch that off for these files")
        if start.total is None:
            raise NetworkError(f"{address.shown}: the host does not tell how long it is (Content-Range)")
        self.size = start.total
        self._keep(0, bytes(start.data))

    def part(self, begin: int, end: int) -> bytes:
        """Bytes [begin, end), fewer at the end of the file. Raises NetworkError, ReplacedError."""
        end = min(end, self.size)
        if end <= begin:
            return b""
        if self._whole is not None:
            return self._whole[begin:end]
        self._require_small(end - begin)
        numbers = range(begin // BLOCK, (end - 1) // BLOCK + 1)
        known = {number: self._blocks.find(self._address.shown, number) for number in numbers}
        self._fetch_missing(known)
        data = b"".join(known[number] or b"" for number in numbers)
        skipped = begin - numbers[0] * BLOCK
        return data[skipped : skipped + end - begin]

    def _fetch_missing(self, known: dict[int, Optional[bytes]]) -> None:
        """Fetches the blocks that are None, those side by side at once."""
        missing = [number for number, data in known.items() if data is None]
        while missing:
            count = next((i for i in range(1, len(missing)) if missing[i] != missing[0] + i), len(missing))
            first, missing = missing[0], missing[count:]
            known.update(self._keep(first, self.fetch(first * BLOCK, min((first + count) * BLOCK, self.size))))

    def fetch(self, begin: int, end: int) -> bytes:
        """Bytes [begin, end) from the host."""
        self._require_small(end - begin)
        answer = None if end <= begin else self._client.get(self._address, begin, end - begin, self._start)
        if answer is None and end > begin:
            raise ReplacedError(f"{self._address.shown}: it is no longer on the host: open it again")
        if answer is not None and len(answer.data) != end - begin:
            raise NetworkError(f"{self._address.shown}: the host sent less than the part that was asked for")
        return bytes(answer.data) if answer else b""

    def _require_small(self, count: int) -> None:
        if count > self.most_bytes:
            raise NetworkError(f"{self._address.shown}: {count} bytes at once are more than any part of a hierarchy has")

    def _keep(self, first: int, data: bytes) -> dict[int, bytes]:
        """Keeps the whole blocks among bytes that begin with block `first`, and the last one of the file."""
        whole = len(data) if first * BLOCK + len(data) == self.size else len(data) // BLOCK * BLOCK
        blocks = {first + at // BLOCK: data[at : at + BLOCK] for at in range(0, whole, BLOCK)}
        for number, block in blocks.items():
            self._blocks.keep(self._address.shown, number, block)
        return blocks

    # What `zipfile` asks of a file.

    def seekable(self) -> bool:
        return True

    def tell(self) -> int:
        return self._at

    def seek(self, offset: int, whence: int = 0) -> int:
        at = offset + (0, self._at, self.size)[whence]
        if at < 0:
            raise OSError("a place before the file")
        self._at = at
        return at

    def read(self, count: int = -1) -> bytes:
        data = self.part(self._at, self.size if count < 0 else self._at + count)
        self._at += len(data)
        return data

    def close(self) -> None:
        pass


class RemoteArchive(Archive):
    """A hierarchy as one file on the web."""

    def __init__(self, place: Web) -> None:
        self._web = place
        super().__init__(place.shown)

    def _read_directory(self) -> zipfile.ZipFile:
        self._client = HttpClient(self._web.headers)
        try:
            return self._archive_on_host()
        except BaseException:
            self._client.close()
            raise

    def _archive_on_host(self) -> zipfile.ZipFile:
        address = Address(self._web.address, self._web.shown)
        start = self._client.get(address, 0, BLOCK)
        if start is None:
            raise NotAHierarchyError(f"{self._path}: there is no such file on the host")
        file = RemoteFile(self._client, address, start, Blocks(self._web.cache_bytes))
        file.most_bytes = _MOST_DIRECTORY
        archive = zipfile.ZipFile(file)  # type: ignore[call-overload]  # it reads, and no more
        file.most_bytes = _MOST_READ
        return archive

    def __reduce__(self) -> tuple[Any, ...]:
        self.require_open()
        return RemoteArchive, (self._web,)

    def close(self) -> None:
        super().close()
        self._client.close()


class RemoteFolder:
    """A hierarchy as a directory on the web."""

    def __init__(self, place: Web) -> None:
        self._web, self._path = place, place.shown
        self._is_closed = False
        self._connect()
        self._manifest: Optional[bytes] = None
        try:
            self._manifest = self._first_manifest()
        except BaseException:
            self._client.close()
            raise

    def _first_manifest(self) -> bytes:
        try:
            manifest = self.read("hierarchy.json")
        except CorruptError:
            raise NotAHierarchyError(f"{self._path}: there is no hierarchy.json on the host; `meshhier serve` has models below /models/") from None
        if manifest.lstrip()[:1] != b"{":
            raise NotAHierarchyError(f"{self._path}: the host sends something else than a hierarchy.json; is this the address of the directory NAME.hier?")
        return manifest

    def _connect(self) -> None:
        self._client, self._blocks, self._process = HttpClient(self._web.headers), Blocks(self._web.cache_bytes), os.getpid()
        self._known: dict[str, RemoteFile] = {}

    def __reduce__(self) -> tuple[Any, ...]:
        self.require_open()
        return RemoteFolder, (self._web,)

    def read(self, name: str) -> bytes:
        manifest, self._manifest = self._manifest, None
        if name == "hierarchy.json" and manifest is not None:
            return manifest  # later it is asked for anew: it tells whether another build is there
        address, start = self._start(name, _START)
        if start.is_whole:
            return bytes(start.data) if name.endswith(".glb") else unpacked(address, start)
        file = RemoteFile(self._client, address, start, Blocks(0), is_packed_itself=name.endswith(".glb"))
        return bytes(start.data) + file.fetch(len(start.data), file.size)

    def part(self, name: str, begin: int, end: int) -> bytes:
        if name not in self._known:
            address, start = self._start(name, BLOCK)
            self._known[name] = RemoteFile(self._client, address, start, self._blocks)
        self.require_open()
        return self._known[name].part(begin, end if end >= 0 else self._known[name].size)

    def require_open(self) -> None:
        if self._is_closed:
            raise closed(self._path)
        if self._process != os.getpid():  # processes that share a connection get each other's answers
            self._connect()

    def close(self) -> None:
        self._is_closed = True
        self._client.close()

    def _start(self, name: str, count: int) -> tuple[Address, Answer]:
        """The first bytes of a file."""
        self.require_open()
        parts = urllib.parse.urlsplit(self._web.address)
        url = urllib.parse.urlunsplit(parts._replace(path=f"{parts.path.rstrip('/')}/{name}", fragment=""))
        address = Address(url, f"{self._path.rstrip('/')}/{name}")
        start = self._client.get(address, 0, count)
        if start is None:
            raise CorruptError(f"{self._path}: {name} is missing on the host")
        return address, start


def open_place(place: str, headers: Optional[Headers], cache_bytes: int) -> tuple[str, Files]:
    """A hierarchy's path as messages have it, and its files: on the disk, or at an address. Raises NotAHierarchyError if there is
    none; NetworkError, UsageError."""
    if not is_web_address(place):
        if headers:
            raise UsageError(f"{place}: headers are for addresses, https://...")
        return place, open_files(place)
    web = Web(place, without_secrets(place), headers, whole(cache_bytes, "cache_bytes are a whole number"))
    is_archive = urllib.parse.urlsplit(place).path.lower().endswith(".3tz")
    if is_archive:
        return web.shown, RemoteArchive(web)
    return web.shown, RemoteFolder(web)
