# SPDX-License-Identifier: MIT
"""Hierarchies on the web: archives by their parts, directories file by file. Nothing can be listed there."""

from __future__ import annotations

import os
import threading
import urllib.parse
import zipfile
from collections import OrderedDict, deque
from concurrent.futures import CancelledError, Future
from dataclasses import dataclass, field
from typing import Any, Callable, Iterable, Iterator, Optional, Sequence, Union

from .asked import is_web_address, whole
from .errors import CorruptError, NetworkError, NotAHierarchyError, ReplacedError, UsageError
from .http_client import SENT_PACKED, Address, Answer, Headers, HttpClient, unpacked, without_secrets
from .storage import Archive, Files, closed, open_files

#: Small reads fetch whole blocks, so that many of them are few requests.
BLOCK = 1 << 16
#: What is asked for when a file is opened: most tiles have less.
_START = 1 << 20
_MOST_READ = 1 << 31
_MOST_DIRECTORY = 1 << 28
#: Bytes of parts that stay in memory, if nobody says how many.
CACHE_BYTES = 64 << 20
#: Files that come at once before they are wanted, as many as a browser asks of one host; and bytes of all that come before.
_MOST_AT_ONCE = 6
_MOST_AHEAD_BYTES = 16 << 20
_LOCAL_HEADER = 30  # of a file in a zip archive, before its name


@dataclass(frozen=True)
class Web:
    """An address, perhaps with secrets, as it was given; as messages have it; and how it is read."""

    address: str = field(repr=False)
    shown: str
    headers: Optional[Headers] = field(repr=False)
    cache_bytes: int


_Key = tuple[str, int]


class Blocks:
    """Blocks of files that have come, up to a budget, of which the ones used last stay; and those on their way, which are asked for
    once, whoever wants them. Thread-safe."""

    def __init__(self, most_bytes: int) -> None:
        self._most, self._bytes = most_bytes, 0
        self._blocks: OrderedDict[_Key, bytes] = OrderedDict()
        self._coming: dict[_Key, Future[bytes]] = {}
        self._lock = threading.Lock()

    def get(self, file: str, numbers: Sequence[int], fetch: Callable[[int, int], Iterable[bytes]]) -> bytes:
        """Ascending blocks of a file, one behind the other. `fetch(first, count)` returns blocks side by side of which nobody has asked
        for any. What it raises is raised to all who wait for these blocks, but not what interrupts one thread, as Ctrl-C does."""
        wanted, own = self._claim(file, numbers)
        try:
            for first, count in _runs(own):
                for number, data in enumerate(fetch(first, count), first):
                    self.keep(file, number, data)
        except BaseException as error:
            self._give_up(file, own, error)
            raise
        try:
            return b"".join(block if isinstance(block, bytes) else block.result() for block in wanted)
        except CancelledError:  # who was to bring one was interrupted
            return self.get(file, numbers, fetch)

    def keep(self, file: str, number: int, data: bytes) -> None:
        with self._lock:
            self._bytes += len(data) - len(self._blocks.pop((file, number), b""))
            self._blocks[file, number] = data
            while self._bytes > self._most and self._blocks:
                self._bytes -= len(self._blocks.popitem(last=False)[1])
            coming = self._coming.pop((file, number), None)
        if coming is not None:
            coming.set_result(data)

    def _claim(self, file: str, numbers: Iterable[int]) -> tuple[list[Union[bytes, Future[bytes]]], list[int]]:
        """Blocks, and the numbers of those that the caller has to bring."""
        wanted: list[Union[bytes, Future[bytes]]] = []
        own = []
        with self._lock:
            for key in ((file, number) for number in numbers):
                if key in self._blocks:
                    self._blocks.move_to_end(key)
                elif key not in self._coming:
                    self._coming[key] = Future()
                    own.append(key[1])
                wanted.append(self._blocks[key] if key in self._blocks else self._coming[key])
        return wanted, own

    def _give_up(self, file: str, numbers: Iterable[int], error: BaseException) -> None:
        with self._lock:
            left = [self._coming.pop((file, number), None) for number in numbers]
        for coming in left:
            if coming is not None and isinstance(error, Exception):
                coming.set_exception(error)
            elif coming is not None:
                coming.cancel()


def _runs(numbers: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Ascending numbers as runs: the first one, and how many."""
    at = 0
    while at < len(numbers):
        count = next((i for i in range(1, len(numbers) - at) if numbers[at + i] != numbers[at] + i), len(numbers) - at)
        yield numbers[at], count
        at += count


class Ahead:
    """Begins to fetch files that will be wanted, a few at once, each in a thread that does not keep Python from ending. What fails is
    tried again by who wants it."""

    def __init__(self, fetch: Callable[[str], object], cache_bytes: int) -> None:
        self._fetch = fetch
        self._most_bytes = min(cache_bytes // 2, _MOST_AHEAD_BYTES)
        self._begun: deque[str] = deque(maxlen=_MOST_AHEAD_BYTES >> 16)
        self._free = threading.BoundedSemaphore(_MOST_AT_ONCE)

    def begin(self, files: Iterable[tuple[str, int]]) -> None:
        left = self._most_bytes
        for name, size in files:
            left -= size
            if left < 0:
                return
            if name not in self._begun:
                if not self._free.acquire(blocking=False):
                    return
                try:
                    threading.Thread(target=self._bring, args=(name,), name="meshhier", daemon=True).start()
                except RuntimeError:  # no threads are left: it comes when it is wanted
                    self._free.release()
                    return
                self._begun.append(name)

    def _bring(self, name: str) -> None:
        try:
            self._fetch(name)
        except Exception:
            pass
        finally:
            self._free.release()


class RemoteFile:
    """A file on the web, as far as `zipfile` reads files. Thread-safe but for the place that seek() sets."""

    size: int

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
            raise NetworkError(f"{address.shown}: {SENT_PACKED}")
        if start.total is None:
            raise NetworkError(f"{address.shown}: the host does not tell how long it is (Content-Range)")
        self.size = start.total
        for number, block in enumerate(_cut(bytes(start.data))):
            if len(block) == BLOCK or number * BLOCK + len(block) == self.size:
                blocks.keep(address.shown, number, block)

    def part(self, begin: int, end: int) -> bytes:
        """Bytes [begin, end), fewer at the end of the file. Raises NetworkError, ReplacedError."""
        end = min(end, self.size)
        if end <= begin:
            return b""
        if self._whole is not None:
            return self._whole[begin:end]
        self._require_small(end - begin)
        numbers = range(begin // BLOCK, (end - 1) // BLOCK + 1)
        data = self._blocks.get(self._address.shown, numbers, self._fetch_blocks)
        skipped = begin - numbers[0] * BLOCK
        return data[skipped : skipped + end - begin]

    def _fetch_blocks(self, first: int, count: int) -> list[bytes]:
        return _cut(self.fetch(first * BLOCK, min((first + count) * BLOCK, self.size)))

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


def _cut(data: bytes) -> list[bytes]:
    return [data[at : at + BLOCK] for at in range(0, len(data), BLOCK)]


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
        self._file, self._ahead = file, Ahead(self._bring, self._web.cache_bytes)
        return archive

    def expect(self, files: Iterable[tuple[str, int]]) -> None:
        self.require_open()
        self._ahead.begin(files)

    def _bring(self, name: str) -> None:
        facts = self._zip.getinfo(name)
        self._file.part(facts.header_offset, facts.header_offset + _LOCAL_HEADER + len(facts.filename) + facts.compress_size)

    def __reduce__(self) -> tuple[Any, ...]:
        self.require_open()
        return RemoteArchive, (self._web,)

    def close(self) -> None:
        super().close()
        if self._process == os.getpid():  # else another thread may have its lock for ever
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
        self._ahead = Ahead(self.read, self._web.cache_bytes)
        self._known: dict[str, RemoteFile] = {}

    def __reduce__(self) -> tuple[Any, ...]:
        self.require_open()
        return RemoteFolder, (self._web,)

    def read(self, name: str) -> bytes:
        self.require_open()
        if name != "hierarchy.json":
            return self._blocks.get(name, [0], lambda *_: [self._fetch(name)])
        manifest, self._manifest = self._manifest, None
        return manifest or self._fetch(name)  # later it is asked for anew: it tells whether another build is there

    def _fetch(self, name: str) -> bytes:
        """All of a file."""
        address, start = self._start(name, _START)
        if start.is_whole:
            return bytes(start.data) if name.endswith(".glb") else unpacked(address, start)
        file = RemoteFile(self._client, address, start, Blocks(0), is_packed_itself=name.endswith(".glb"))
        return bytes(start.data) + file.fetch(len(start.data), file.size)

    def expect(self, files: Iterable[tuple[str, int]]) -> None:
        self.require_open()
        self._ahead.begin(files)

    def part(self, name: str, begin: int, end: int) -> bytes:
        self.require_open()
        if name not in self._known:
            address, start = self._start(name, BLOCK)
            self._known[name] = RemoteFile(self._client, address, start, self._blocks)
        return self._known[name].part(begin, end if end >= 0 else self._known[name].size)

    def require_open(self) -> None:
        if self._is_closed:
            raise closed(self._path)
        if self._process != os.getpid():  # processes that share a connection get each other's answers
            self._connect()

    def close(self) -> None:
        self._is_closed = True
        if self._process == os.getpid():  # else another thread may have its lock for ever
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
