# SPDX-License-Identifier: MIT
"""Hierarchies on the web: hosts with ranges and without, slow, busy, lying ones, and such that replace them in between."""

from __future__ import annotations

import base64
import http.client
import io
import itertools
import os
import pickle
import shutil
import signal
import subprocess
import threading
import time
from pathlib import Path
from typing import Any, Iterator, Optional

import numpy as np
import pytest
from host import Host, half, redirect, silent, slow, status, times, with_headers

import meshhier
from meshhier import http_client, remote
from meshhier.http_client import Headers


@pytest.fixture(autouse=True)
def own_surroundings(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """No netrc and no proxy of this machine; short waits."""
    monkeypatch.setenv("HOME", str(tmp_path))
    for name in ("http_proxy", "https_proxy", "no_proxy", "HTTP_PROXY", "HTTPS_PROXY", "all_proxy", "CURL_CA_BUNDLE", "SSL_CERT_FILE"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(http_client, "FIRST_WAIT", 0.01)


@pytest.fixture(scope="module")
def root(torus: str, built: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("host")
    shutil.copytree(built(torus, "web.hier"), folder / "a.hier")
    shutil.copy(built(torus, "web.3tz"), folder / "a.3tz")
    shutil.copytree(built(torus, "web_gzip.hier", storage__compression="meshopt_zlib"), folder / "gzip.hier")
    shutil.copy(built(torus, "web_other.3tz", partition__vertices=900), folder / "other.3tz")
    shutil.copytree(built(torus, "web_other.hier", partition__vertices=900), folder / "other.hier")
    return folder


@pytest.fixture
def host(root: Path) -> Iterator[Host]:
    with Host(root) as one:
        yield one


@pytest.fixture
def own(root: Path, tmp_path: Path) -> Iterator[Host]:
    """A host whose files may be replaced."""
    shutil.copytree(root, tmp_path / "own")
    with Host(tmp_path / "own") as one:
        yield one


def same(one: meshhier.Mesh, other: meshhier.Mesh) -> bool:
    return np.array_equal(one.positions, other.positions) and np.array_equal(one.triangles, other.triangles)


@pytest.mark.parametrize("name", ["a.hier", "a.3tz", "gzip.hier"])
def test_they_are_what_lies_on_the_disk(name: str, host: Host, root: Path) -> None:
    with meshhier.open(f"{host.address}/{name}") as web, meshhier.open(root / name) as disk:
        assert web.path == f"{host.address}/{name}" and web.manifest == disk.manifest
        assert same(web.cut(level=1), disk.cut(level=1)) and same(web.cut(), disk.cut())
        assert [tile.own for tile in web.iter_tiles(2)] == [tile.own for tile in disk.iter_tiles(2)]
    with pytest.raises(meshhier.UsageError, match="closed"):
        web.cut(level=0)


def test_little_is_fetched_on_few_connections(host: Host, root: Path) -> None:
    with meshhier.open(f"{host.address}/a.3tz") as web:
        web.read_tile((0, 0))
        assert host.bytes_asked() < (root / "a.3tz").stat().st_size / 3
        for _ in range(3):
            web.cut()
        assert host.bytes_asked() < (root / "a.3tz").stat().st_size + 2 * remote.BLOCK, "each byte once"
    assert host.connections <= 7, "connections stay open"


class Busy:
    """Lets a host's requests for tiles wait until so many are there together."""

    def __init__(self, together: int) -> None:
        self._barrier = threading.Barrier(together)
        self._lock = threading.Lock()
        self._now = self.most = 0

    def __call__(self, handler: Any) -> bool:
        with self._lock:
            self._now += 1
            self.most = max(self.most, self._now)
        try:
            self._barrier.wait(25)
            self._barrier.abort()  # they have been together; those that come later need not wait
        except threading.BrokenBarrierError:
            pass
        with self._lock:
            self._now -= 1
        return False


@pytest.mark.parametrize("name", ["a.hier", "a.3tz"])
def test_tiles_that_are_wanted_next_come_at_once(name: str, host: Host, root: Path) -> None:
    with meshhier.open(f"{host.address}/{name}") as web, meshhier.open(root / name) as disk:
        tiles = list(web.tree.level(web.levels - 1))
        host.reply = busy = Busy(together=4)
        host.requests.clear()
        parts = list(web.iter_parts())
        assert parts == list(disk.iter_parts()) and len(parts) == len(tiles)
        assert 4 <= busy.most <= remote._MOST_AT_ONCE + 1
        assert len(host.requests) <= len(tiles), "what is on its way is not asked for twice"


def test_what_fails_ahead_is_told_by_who_wants_it(host: Host) -> None:
    with meshhier.open(f"{host.address}/a.hier") as web:
        last = web._manifest.tile_name(web.tree.level(web.levels - 1)[3])
        host.reply = lambda handler: last in handler.path and status(403)(handler)
        parts = web.iter_parts()
        assert [next(parts).tiles for _ in range(3)] == [[node] for node in web.tree.level(web.levels - 1)[:3]]
        with pytest.raises(meshhier.NetworkError, match=f"{last}: .*403"):
            next(parts)


@pytest.mark.parametrize("name", ["a.hier", "a.3tz"])
def test_what_was_kept_is_closed_too(name: str, host: Host) -> None:
    with meshhier.open(f"{host.address}/{name}") as web:
        web.read_tile((0, 0))
    with pytest.raises(meshhier.UsageError, match="closed"):
        web.read_tile((0, 0))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
@pytest.mark.parametrize("name", ["a.hier", "a.3tz"])
def test_a_forked_process_waits_for_no_thread_of_its_parent(name: str, host: Host) -> None:
    with meshhier.open(f"{host.address}/{name}") as web:
        asked = len(host.requests)
        host.reply = slow(1)
        finest = web.tree.level(web.levels - 1)
        web._expect(np.array([web._index.row(node) for node in finest[1:3]]))
        while len(host.requests) == asked:  # now they are on their way
            time.sleep(0.01)
        child = os.fork()
        if child == 0:
            signal.alarm(120)
            os._exit(0 if [web.read_tile(node).node for node in finest[1:3]] == finest[1:3] else 1)
        assert os.waitpid(child, 0)[1] == 0


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
@pytest.mark.parametrize("name", ["a.hier", "a.3tz"])
def test_a_forked_process_can_close_while_its_parent_is_busy(name: str, host: Host) -> None:
    with meshhier.open(f"{host.address}/{name}") as web:
        with web._files._client._connections._lock:  # type: ignore[attr-defined]
            child = os.fork()
            if child == 0:
                signal.alarm(120)
                web.close()
                os._exit(0)
        assert os.waitpid(child, 0)[1] == 0
        web.read_tile((0, 0))


def test_nothing_comes_ahead_that_nobody_can_keep(host: Host, root: Path) -> None:
    with meshhier.open(f"{host.address}/a.hier", cache_bytes=0) as web, meshhier.open(root / "a.hier") as disk:
        assert list(web.iter_parts()) == list(disk.iter_parts())
    tiles = [path for path, _ in host.requests if path.endswith(".glb")]
    assert len(tiles) == len(set(tiles)) and host.connections == 1


@pytest.mark.parametrize("most", [0, 3 * remote.BLOCK])
def test_the_cache_keeps_its_budget(most: int, host: Host, root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept: list[remote.Blocks] = []
    make = remote.Blocks.__init__

    def watched(self: remote.Blocks, most_bytes: int) -> None:
        make(self, most_bytes)
        kept.append(self)

    monkeypatch.setattr(remote.Blocks, "__init__", watched)
    with meshhier.open(f"{host.address}/a.3tz", cache_bytes=most) as web, meshhier.open(root / "a.3tz") as disk:
        assert same(web.cut(), disk.cut())
        assert sum(map(len, kept[0]._blocks.values())) == kept[0]._bytes <= most


@pytest.mark.parametrize("name", ["a.hier", "a.3tz"])
def test_a_host_without_ranges_sends_files_whole(name: str, host: Host, root: Path) -> None:
    host.has_ranges = False
    with meshhier.open(f"{host.address}/{name}") as web, meshhier.open(root / name) as disk:
        assert same(web.cut(level=2), disk.cut(level=2))


def test_files_that_are_too_large_without_ranges(host: Host, monkeypatch: pytest.MonkeyPatch) -> None:
    host.has_ranges = False
    monkeypatch.setattr(http_client, "MOST_WHOLE", 100_000)
    with pytest.raises(meshhier.NetworkError, match="HTTP ranges"):
        meshhier.open(f"{host.address}/a.3tz")

    def endless(handler: Any) -> bool:
        handler.send_response(200)
        handler.send_header("Connection", "close")
        handler.end_headers()
        handler.close_connection = True
        try:
            while True:
                handler.wfile.write(bytes(65536))
        except OSError:
            return True

    host.reply = endless
    with pytest.raises(meshhier.NetworkError, match="HTTP ranges"):
        meshhier.open(f"{host.address}/a.3tz")


def test_tiles_in_gzip_come_as_they_are(host: Host, root: Path) -> None:
    def say_gzip(handler: Any) -> bool:
        if handler.path.endswith(".glb") and "/tiles/" in handler.path:
            handler.send_file(Content_Encoding="gzip")
            return True
        return False

    host.reply = say_gzip
    with meshhier.open(f"{host.address}/gzip.hier") as web, meshhier.open(root / "gzip.hier") as disk:
        assert same(web.cut(), disk.cut())


def test_what_the_host_packs_on_the_way_is_unpacked_or_told(host: Host, root: Path) -> None:
    def pack(handler: Any) -> bool:
        if handler.path.endswith((".json", ".bin")):
            handler.send_gzip()
            return True
        return False

    host.reply = pack
    with meshhier.open(f"{host.address}/a.hier") as web, meshhier.open(root / "a.hier") as disk:
        assert same(web.cut(level=1), disk.cut(level=1))
    host.reply = with_headers(Content_Encoding="gzip")
    with pytest.raises(meshhier.NetworkError, match="Content-Encoding"):
        meshhier.open(f"{host.address}/a.3tz")
    host.reply = lambda handler: handler.send(206, b"few", Content_Range="bytes 0-65535/100000", Content_Encoding="gzip") or True
    with pytest.raises(meshhier.NetworkError, match="parts of it say nothing"):
        meshhier.open(f"{host.address}/a.3tz")
    host.has_ranges, host.reply = False, with_headers(Content_Encoding="br")
    with pytest.raises(meshhier.NetworkError, match="as br"):
        meshhier.open(f"{host.address}/a.hier")
    host.reply = with_headers(Content_Encoding="gzip")
    with pytest.raises(meshhier.NetworkError, match="cannot be unpacked"):
        meshhier.open(f"{host.address}/a.hier")


# Failures that pass, and such that do not.


@pytest.mark.parametrize("code", [408, 429, 500, 503])
def test_busy_hosts_are_asked_again(code: int, host: Host) -> None:
    host.reply = times(2, status(code))
    meshhier.open(f"{host.address}/a.3tz").cut(level=0)
    host.requests.clear()
    host.reply = status(code)
    with pytest.raises(meshhier.NetworkError, match=f"answered {code}, 5 times") as failed:
        meshhier.open(f"{host.address}/a.3tz")
    assert failed.value.status == code and len(host.requests) == 5


def test_waits_grow_and_the_host_may_ask_for_more(host: Host, monkeypatch: pytest.MonkeyPatch) -> None:
    waits: list[float] = []
    monkeypatch.setattr("meshhier.http_client.time.sleep", waits.append)
    monkeypatch.setattr(http_client, "FIRST_WAIT", 0.5)
    host.reply = status(503)
    with pytest.raises(meshhier.NetworkError):
        meshhier.open(f"{host.address}/a.3tz")
    assert waits == [0.5, 1, 2, 4]
    waits.clear()
    host.reply = times(3, lambda handler: status(503, Retry_After=["7", "Fri, 01 Jan 2100 00:00:00 GMT", "-1"][len(waits)])(handler))
    meshhier.open(f"{host.address}/a.3tz")
    assert waits == [7, 60, 2]


@pytest.mark.parametrize(
    "code, match", [(401, "headers="), (403, "headers="), (400, "answered 400"), (501, "answered 501"), (406, "answered 406")]
)
def test_refusals_are_told_at_once(code: int, match: str, host: Host) -> None:
    host.reply = status(code)
    for name in ("a.hier", "a.3tz"):
        host.requests.clear()
        with pytest.raises(meshhier.NetworkError, match=match) as failed:
            meshhier.open(f"{host.address}/{name}")
        assert failed.value.status == code and len(host.requests) == 1
        assert pickle.loads(pickle.dumps(failed.value)).status == code


@pytest.mark.parametrize("name", ["none.hier", "none.3tz", "", "a.hier/tiles"])
def test_where_there_is_none(name: str, host: Host) -> None:
    with pytest.raises(meshhier.NotAHierarchyError, match=f"{host.address}/{name}.*on the host"):
        meshhier.open(f"{host.address}/{name}")


@pytest.mark.parametrize("name", ["a.hier", "a.3tz"])
def test_nothing_stays_open_where_opening_fails(name: str, own: Host, monkeypatch: pytest.MonkeyPatch) -> None:
    closed: list[http_client.HttpClient] = []
    monkeypatch.setattr(http_client.HttpClient, "close", lambda self: closed.append(self))
    (own.root / "a.3tz").write_bytes(bytes(100_000))
    (own.root / "a.hier" / "tiles.bin").write_bytes(b"")
    with pytest.raises(meshhier.Error):
        meshhier.open(f"{own.address}/{name}")
    assert closed


def test_pages_for_everything_are_no_hierarchies(host: Host) -> None:
    host.reply = status(200)
    with pytest.raises(meshhier.NotAHierarchyError, match="something else"):
        meshhier.open(f"{host.address}/a.hier")
    with pytest.raises(meshhier.NotAHierarchyError, match="not an archive"):
        meshhier.open(f"{host.address}/a.3tz")


def test_a_tile_that_is_missing(own: Host) -> None:
    web = meshhier.open(f"{own.address}/a.hier")
    shutil.rmtree(own.root / "a.hier" / "tiles" / "01")
    with pytest.raises(meshhier.CorruptError, match="tiles/01/000000.glb is missing on the host"):
        web.cut(level=1)


def test_what_breaks_off_goes_on(host: Host, root: Path) -> None:
    host.reply = times(3, half)
    with meshhier.open(f"{host.address}/a.3tz") as web, meshhier.open(root / "a.3tz") as disk:
        web.cut(level=0)
        host.requests.clear()
        host.reply = times(2, half)
        assert web.read_tile((1, 1)) == disk.read_tile((1, 1))
        firsts = [int(headers["Range"][6:].partition("-")[0]) for _, headers in host.requests[:3]]
        assert firsts[0] < firsts[1] < firsts[2], "bytes that have come are not asked for again"
        host.reply = times(4, half)
        assert same(web.cut(), disk.cut())
    host.reply = half
    with pytest.raises(meshhier.NetworkError, match="broke off, 5 times"):
        meshhier.open(f"{host.address}/a.hier/").read_tile((0, 0))


class _Line(io.RawIOBase):
    """A socket on which these pieces come, and then a failure."""

    def __init__(self, *pieces: bytes) -> None:
        self._pieces = list(pieces)

    def makefile(self, mode: str) -> io.BufferedReader:
        return io.BufferedReader(self)

    def readable(self) -> bool:
        return True

    def readinto(self, room: Any) -> int:
        if not self._pieces:
            raise ConnectionResetError("reset")
        piece = self._pieces.pop(0)
        room[: len(piece)] = piece
        return len(piece)


@pytest.mark.parametrize(
    "head, body",
    [("Content-Length: 60000", (b"a" * 1500, b"b" * 700)), ("Transfer-Encoding: chunked", (b"8000\r\n" + b"a" * 1500, b"b" * 700))],
)
def test_what_came_before_a_line_breaks_is_kept(head: str, body: tuple[bytes, ...]) -> None:
    response = http.client.HTTPResponse(_Line(f"HTTP/1.1 206 Part\r\n{head}\r\n\r\n".encode(), *body))  # type: ignore[arg-type]
    response.begin()
    answer = http_client.Answer()
    with pytest.raises(http_client._Passing):
        http_client.HttpClient()._receive(http_client.Address("http://a", "a"), response, answer, 60000)
    assert answer.data == b"a" * 1500 + b"b" * 700


def test_who_waits_is_not_interrupted_with_who_fetches() -> None:
    class Claimed(list[int]):
        def __iter__(self) -> Iterator[int]:
            claimed.set()
            return super().__iter__()

    def interrupted(first: int, count: int) -> list[bytes]:
        other.start()
        claimed.wait()
        raise KeyboardInterrupt

    claimed = threading.Event()
    found: list[bytes] = []
    blocks = remote.Blocks(1000)
    other = threading.Thread(target=lambda: found.append(blocks.get("a", Claimed([0]), lambda first, count: [b"bytes"])))
    with pytest.raises(KeyboardInterrupt):
        blocks.get("a", [0], interrupted)
    other.join()
    assert found == [b"bytes"]


def test_silent_hosts(host: Host, monkeypatch: pytest.MonkeyPatch) -> None:
    over = threading.Event()
    limits = iter([0.3, 0.3])  # of the first connections; the others have time
    monkeypatch.setattr(http_client.Connections, "_silence", property(lambda self: next(limits, 120), lambda self, limit: None), raising=False)
    monkeypatch.setattr(http_client, "SILENCE", 0.3)
    host.reply = times(2, silent(over))
    meshhier.open(f"{host.address}/a.3tz").cut(level=0)
    limits = itertools.repeat(0.3)
    monkeypatch.setattr(http_client, "TRIES", 2)
    host.reply = silent(over)
    with pytest.raises(meshhier.NetworkError, match="silent for 0.3 s, 2 times"):
        meshhier.open(f"{host.address}/a.3tz")
    over.set()


def test_nobody_is_there(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(meshhier.NetworkError, match="refused"):
        meshhier.open("http://127.0.0.1:1/a.3tz")
    with pytest.raises(meshhier.NetworkError, match="no-such-host"):
        meshhier.open("http://no-such-host.invalid/a.3tz")


@pytest.mark.parametrize(
    "headers, match",
    [
        ({"Content_Range": None}, "which part"), ({"Content_Range": "bytes 7-9/100"}, "another part"), ({"Content_Range": "bytes 0-65535/*"}, "how long"),
        ({"Content_Range": "bytes 0-65535/99999999999999999999999"}, "which part"), ({"X": "x" * 70000}, "header"), ({"Content_Length": "10"}, "broke off"),
    ],
)  # fmt: skip
def test_wrong_lengths_and_places(headers: dict[str, Any], match: str, host: Host) -> None:
    host.reply = with_headers(**headers)
    with pytest.raises((meshhier.NetworkError, meshhier.NotAHierarchyError), match=match):
        meshhier.open(f"{host.address}/a.3tz")


@pytest.mark.parametrize("total, match", [(70_000, "not an archive"), (900_000_000_000_000, "sent less than")])
def test_a_length_that_is_a_lie(total: int, match: str, host: Host) -> None:
    def lie(handler: Any) -> bool:
        first, last = handler.headers["Range"][6:].split("-")
        handler.send_file(Content_Range=f"bytes {first}-{last}/{total}")
        return True

    host.reply = lie
    with pytest.raises((meshhier.NetworkError, meshhier.NotAHierarchyError), match=match):
        meshhier.open(f"{host.address}/a.3tz")


def test_more_than_was_asked_for(host: Host, root: Path) -> None:
    def all_of_it(handler: Any) -> bool:
        data = (root / "a.3tz").read_bytes()
        handler.send(206, data, Content_Range=f"bytes 0-{len(data) - 1}/{len(data)}")
        return True

    host.reply = all_of_it
    with pytest.raises(meshhier.NetworkError, match="more than the part"):
        meshhier.open(f"{host.address}/a.3tz")


@pytest.mark.parametrize("line", [b"\0\1\2 no HTTP", b"\x1b[31mred", b"HTTP/\x1b[31m 200 OK", b"HTTP/1.1 206 Part\r\nContent-Range: bytes 0-9/10\r\nTransfer-Encoding: chunked"])
def test_garbage_is_no_answer(line: bytes, host: Host) -> None:
    def garbage(handler: Any) -> bool:
        handler.wfile.write(line + b"\r\n\r\nfffffffffffffffff\r\nx")
        handler.close_connection = True
        return True

    host.reply = garbage
    with pytest.raises(meshhier.NetworkError, match="does not speak HTTP, 5 times"):
        meshhier.open(f"{host.address}/a.3tz")


def test_connections_that_the_host_has_closed(host: Host) -> None:
    """A kept connection that is no more is no failure."""

    def close(handler: Any) -> bool:
        handler.close_connection = True
        return False

    host.reply = close
    with meshhier.open(f"{host.address}/a.3tz") as web:
        web.cut(level=1)
        web.cut()
    assert host.connections > 2


# Builds that replace each other.


@pytest.mark.parametrize("tags", [True, False])
def test_two_archives_are_never_one(tags: bool, own: Host) -> None:
    own.reply = None if tags else with_headers(ETag=None)
    web = meshhier.open(f"{own.address}/a.3tz")
    web.read_tile((0, 0))
    os.replace(own.root / "other.3tz", own.root / "a.3tz")
    with pytest.raises(meshhier.ReplacedError, match="open it again"):
        web.cut()
    if tags:
        assert own.requests[-1][1]["If-Range"].startswith('"')
    assert meshhier.open(f"{own.address}/a.3tz").cut().triangles.shape == (20736, 3)


def test_two_directories_are_never_one(own: Host) -> None:
    web = meshhier.open(f"{own.address}/a.hier")
    web.read_tile((0, 0))
    shutil.rmtree(own.root / "a.hier")
    os.replace(own.root / "other.hier", own.root / "a.hier")
    with pytest.raises(meshhier.ReplacedError, match="open it again"):
        web.cut(level=1)


def test_a_file_that_changes_between_two_tries(own: Host) -> None:
    web = meshhier.open(f"{own.address}/a.3tz")

    def break_and_replace(handler: Any) -> bool:
        handler.send_half()
        os.replace(own.root / "other.3tz", own.root / "a.3tz")
        return True

    own.reply = times(1, break_and_replace)
    with pytest.raises(meshhier.ReplacedError):
        web.cut()


def test_a_host_that_forgets_ranges(own: Host) -> None:
    web = meshhier.open(f"{own.address}/a.3tz")
    web.read_tile((0, 0))
    own.has_ranges = False
    with pytest.raises(meshhier.NetworkError, match="HTTP ranges"):
        web.cut()


def test_damage_is_something_else(own: Host) -> None:
    web = meshhier.open(f"{own.address}/a.hier")
    tile = own.root / "a.hier" / "tiles" / "01" / "000000.glb"
    data = bytearray(tile.read_bytes())
    data[-5] ^= 1
    tile.write_bytes(data)
    with pytest.raises(meshhier.CorruptError, match="damaged"):
        web.cut(level=1)


# Secrets.


def keys_of(host: Host) -> set[Optional[str]]:
    """Those of all requests so far."""
    keys = {headers.get("X-Key") for _, headers in host.requests}
    host.requests.clear()
    return keys


def test_headers_of_a_hierarchy_go_to_no_other_host(host: Host, root: Path) -> None:
    with Host(root) as other, meshhier.open(f"{host.address}/a.hier", headers={"X-Key": "1"}) as web:
        there = f"{other.address}/a.hier"
        orders: list[tuple[Any, Any]] = [(web, there), (there, web)]
        for places in orders:
            assert meshhier.compare(*places).farthest == 0
            assert (keys_of(host), keys_of(other)) == ({"1"}, {None})
        with meshhier.open(there, headers=["X-Key: 2"]) as second:
            assert meshhier.compare(web, second).farthest == 0
        assert (keys_of(host), keys_of(other)) == ({"1"}, {"2"})
        assert meshhier.compare(web, root / "a.hier").farthest == 0


def test_headers_of_a_comparison_go_to_the_first_host_or_the_one_they_name(host: Host, root: Path) -> None:
    here = f"{host.address}/a.hier"
    with Host(root) as other:
        there = f"{other.address}/a.hier"
        cases: list[tuple[Headers, object]] = [
            ({"X-Key": "1"}, ({"1"}, {None})),
            ([f"{other.address}/ X-Key: 2"], ({None}, {"2"})),
            ([f"{there} X-Key: 2", "X-Key: 1"], ({"1"}, {"2"})),
            ([other.address.removeprefix("http://") + " X-Key: 2"], ({None}, {"2"})),
        ]
        for headers, keys in cases:
            meshhier.compare(here, there, headers=headers)
            assert (keys_of(host), keys_of(other)) == keys
        meshhier.compare(root / "a.hier", there, headers={"X-Key": "3"})
        assert keys_of(other) == {"3"}
        for line in ("b.org\r\nX:5 C: d", "b.org C: d\r\nX: 5", "b.org"):
            with pytest.raises(meshhier.UsageError, match="names and values of headers"):
                meshhier.compare(here, there, headers=[line])
        with pytest.raises(meshhier.UsageError, match="for a host that no address here names"):
            meshhier.compare(here, there, headers=["https://example.org X-Key: 3"])
        assert keys_of(host) == keys_of(other) == set()


def test_headers_users_and_queries(host: Host, root: Path, tmp_path: Path) -> None:
    with meshhier.open(f"{host.address}/a.hier?sig=s3cret&x=1", headers={"Authorization": "Bearer t0ken", "X-Key": "k"}) as web:
        web.cut(level=0)
        assert web.path == f"{host.address}/a.hier" and "s3cret" not in repr(web)
    assert all(path.endswith("?sig=s3cret&x=1") and headers["Authorization"] == "Bearer t0ken" and headers["X-Key"] == "k" for path, headers in host.requests)
    host.requests.clear()
    with_user = host.address.replace("//", "//me:p%20w@")
    meshhier.open(f"{with_user}/a.3tz").cut(level=0)
    basic = "Basic " + base64.b64encode(b"me:p w").decode()
    assert host.requests and all(headers["Authorization"] == basic for _, headers in host.requests)
    host.requests.clear()
    (tmp_path / ".netrc").write_text("machine 127.0.0.1 login me password word\n")
    (tmp_path / ".netrc").chmod(0o600)
    meshhier.open(f"{host.address}/a.3tz")
    assert host.requests[0][1]["Authorization"] == "Basic " + base64.b64encode(b"me:word").decode()


def test_secrets_are_in_no_message(host: Host) -> None:
    address = host.address.replace("//", "//me:passw0rd@")
    for reply in (status(403), status(500), status(404), None):
        host.reply = reply
        with pytest.raises(meshhier.Error) as failed:
            meshhier.open(f"{address}/none.3tz?sig=s3cret#frag", headers={"X-Token": "t0ken"})
        assert not any(secret in str(failed.value) for secret in ("passw0rd", "s3cret", "t0ken", "me:", "frag"))


def test_redirects_take_no_secret_to_another_host(host: Host, root: Path, tmp_path: Path) -> None:
    (tmp_path / ".netrc").write_text("machine 127.0.0.1 login me password word\n")
    (tmp_path / ".netrc").chmod(0o600)
    with Host(root) as other:
        host.reply = redirect(other.address)
        with meshhier.open(f"{host.address}/a.3tz", headers={"Authorization": "Bearer t0ken", "X-Key": "k"}) as web, meshhier.open(root / "a.3tz") as disk:
            assert same(web.cut(level=1), disk.cut(level=1))
        assert all(headers["X-Key"] == "k" for _, headers in host.requests)
        assert other.requests and not any({"Authorization", "X-Key"} & set(headers) for _, headers in other.requests)
    host.reply = lambda handler: not handler.path.startswith("/b/") and redirect("/b", 307)(handler)
    (root / "b").mkdir(exist_ok=True)
    shutil.copy(root / "a.3tz", root / "b" / "a.3tz")
    host.requests.clear()
    meshhier.open(f"{host.address}/a.3tz", headers={"X-Key": "k"})
    assert [path for path, _ in host.requests][:2] == ["/a.3tz", "/b/a.3tz"] and all(headers["X-Key"] == "k" for _, headers in host.requests)


@pytest.mark.parametrize("target", ["/a.3tz", "file:///etc/passwd", "ftp://127.0.0.1/a.3tz", "http://[", "http://a..b/"])
def test_redirects_that_lead_nowhere(target: str, host: Host) -> None:
    host.reply = status(302, Location=target)
    with pytest.raises(meshhier.NetworkError, match="on and on" if target.startswith("/") else "not on the web"):
        meshhier.open(f"{host.address}/a.3tz")


@pytest.mark.parametrize(
    "address",
    ["http://", "https:///a.3tz", "http://host:99999/a.3tz", "http://ho st/a.3tz", "http://[::1/a", "http://host/a\r\nX: y", "http://a..b/c"],
)
def test_addresses_that_are_none(address: str) -> None:
    with pytest.raises(meshhier.UsageError, match="address"):
        meshhier.open(address)


def test_headers_that_are_none(host: Host, root: Path) -> None:
    for headers in ({"A": "b\r\nC: d"}, {"A b": "c"}, ["b.org\r\nX:5 C: d"], ["none"], {"": "x"}, {"A": "\u20ac"}):
        with pytest.raises(meshhier.UsageError, match="headers"):
            meshhier.open(f"{host.address}/a.3tz", headers=headers)  # type: ignore[arg-type]
    with pytest.raises(meshhier.UsageError, match="addresses"):
        meshhier.open(root / "a.3tz", headers={"A": "b"})


def test_a_line_for_another_host_is_no_header(host: Host) -> None:
    for line in ("https://example.org X-Key: 1", "HTTP://example.org X-Key: 1", "http:/example.org X-Key: 1", "localhost:80 X-Key: 1"):
        with pytest.raises(meshhier.UsageError, match="headers"):
            meshhier.open(f"{host.address}/a.3tz", headers=[line])
    with pytest.raises(meshhier.UsageError, match="headers"):
        meshhier.compare(f"{host.address}/a.3tz", "http://localhost:1/a.3tz", headers=["http:/localhost:1 X-Key: 1"])
    assert not host.requests


def test_certificates(root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if shutil.which("openssl") is None:
        pytest.skip("openssl is not there")
    made = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=x", "-addext", "subjectAltName=IP:127.0.0.1"]
    subprocess.run([*made, "-keyout", tmp_path / "key.pem", "-out", tmp_path / "cert.pem"], check=True, capture_output=True)
    both = tmp_path / "both.pem"
    both.write_bytes((tmp_path / "key.pem").read_bytes() + (tmp_path / "cert.pem").read_bytes())
    with Host(root, both) as host:
        with pytest.raises(meshhier.NetworkError, match="certificate is not valid"):
            meshhier.open(f"{host.address}/a.3tz")
        monkeypatch.setenv("SSL_CERT_FILE", str(tmp_path / "cert.pem"))
        with meshhier.open(f"{host.address}/a.3tz") as web:
            assert len(web.cut().triangles) == 20736
        subprocess.run([*made, "-keyout", tmp_path / "other_key.pem", "-out", tmp_path / "other.pem"], check=True, capture_output=True)
        monkeypatch.setenv("CURL_CA_BUNDLE", str(tmp_path / "other.pem"))
        with pytest.raises(meshhier.NetworkError, match="CURL_CA_BUNDLE, else SSL_CERT_FILE"):
            meshhier.open(f"{host.address}/a.3tz")
        monkeypatch.setenv("CURL_CA_BUNDLE", str(tmp_path / "none.pem"))
        with pytest.raises(meshhier.NetworkError, match="CURL_CA_BUNDLE"):
            meshhier.open(f"{host.address}/a.3tz")


def test_proxies(host: Host, root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A request by a proxy names the whole address; the host of the tests takes both."""
    monkeypatch.setenv("http_proxy", host.address.replace("//", "//proxy:word@"))

    def as_proxy(handler: Any) -> bool:
        assert handler.path.startswith("http://models.invalid:80/")
        handler.path = handler.path[len("http://models.invalid:80") :]
        return False

    host.reply = as_proxy
    with meshhier.open("http://models.invalid/a.hier") as web, meshhier.open(root / "a.hier") as disk:
        assert same(web.cut(level=1), disk.cut(level=1))
    assert host.requests[0][1]["Host"].startswith("models.invalid") and host.requests[0][1]["Proxy-Authorization"].startswith("Basic ")


def test_proxies_of_other_kinds(host: Host, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("all_proxy", "socks5://127.0.0.1:1")
    with pytest.raises(meshhier.NetworkError, match="socks5.*no_proxy"):
        meshhier.open(f"{host.address}/a.3tz")
    monkeypatch.setenv("no_proxy", "127.0.0.1")
    meshhier.open(f"{host.address}/a.3tz")


# Uses.


@pytest.mark.parametrize("name", ["a.hier", "gzip.hier"])
def test_files_that_are_larger_than_the_first_part(name: str, host: Host, root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(remote, "_START", 1000)
    with meshhier.open(f"{host.address}/{name}") as web, meshhier.open(root / name) as disk:
        assert same(web.cut(level=1), disk.cut(level=1))


def test_they_can_be_pickled(host: Host, own: Host) -> None:
    with meshhier.open(f"{host.address}/a.3tz", headers={"X-Key": "k"}) as web:
        again = pickle.loads(pickle.dumps(web))
        assert same(again.cut(level=1), web.cut(level=1)) and host.requests[-1][1]["X-Key"] == "k"
    web = meshhier.open(f"{own.address}/a.hier")
    data = pickle.dumps(web)
    shutil.rmtree(own.root / "a.hier")
    os.replace(own.root / "other.hier", own.root / "a.hier")
    with pytest.raises(meshhier.ReplacedError):
        pickle.loads(data)


@pytest.mark.parametrize("name", ["a.hier", "a.3tz"])
def test_many_threads_read_one(name: str, host: Host, root: Path) -> None:
    host.reply = None
    with meshhier.open(f"{host.address}/{name}") as web, meshhier.open(root / name) as disk:
        nodes = disk.cut_nodes()
        found: dict[Any, int] = {}
        threads = [threading.Thread(target=lambda part: found.update({node: web.read_tile(node).own for node in part}), args=(nodes[i::4],)) for i in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert found == {node: disk.read_tile(node).own for node in nodes}


@pytest.mark.parametrize("name", ["a.hier", "a.3tz"])
def test_forked_processes_have_their_own_connections(name: str, host: Host) -> None:
    import multiprocessing

    with meshhier.open(f"{host.address}/{name}") as web:
        web.cut(level=0)
        with multiprocessing.get_context("fork").Pool(3) as pool:
            counts = pool.map(_own_of, [(web, node) for node in web.cut_nodes(level=2)])
        assert counts == [web.read_tile(node).own for node in web.cut_nodes(level=2)]


def _own_of(asked: tuple[meshhier.Hierarchy, meshhier.Node]) -> int:
    return asked[0].read_tile(asked[1]).own


def test_the_program_reads_them_with_the_same_secrets(host: Host, tmp_path: Path) -> None:
    with meshhier.open(f"{host.address}/a.3tz?sig=s", headers={"X-Key": "k"}) as web:
        host.requests.clear()
        assert meshhier.export(web, level=0) and meshhier.inspect(web)["source"]["triangles"] == 20736
        assert web.nearest([(0, 0, 0)]).distances[0] > 0
        assert len(host.requests) > 1 and all(path.endswith("?sig=s") and headers["X-Key"] == "k" for path, headers in host.requests)


def test_objects_are_read_by_the_block(tmp_path: Path) -> None:
    lines = [f"v {i} 0 0\nv {i}.5 0 0\nv {i} 1 0\ng house {i:04}\nf {3 * i + 1} {3 * i + 2} {3 * i + 3}\n" for i in range(600)]
    (tmp_path / "a.obj").write_text("".join(lines))
    for name in ("a.hier", "a.3tz"):
        meshhier.build(tmp_path / "a.obj", tmp_path / name, objects="group").close()
        with Host(tmp_path) as host, meshhier.open(f"{host.address}/{name}") as web:
            assert web.objects is not None and len(web.objects) == 600
            row = web.objects.find("house 0321")
            assert row is not None and row.box is not None and row.box[0].tolist() == [321, 0, 0]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
@pytest.mark.parametrize("name", ["a.hier", "a.3tz"])
def test_a_forked_process_reads_objects_as_its_parent_did(name: str, tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text("".join(f"v {i} 0 0\nv {i}.5 0 0\nv {i} 1 0\ng house {i:04}\nf -3 -2 -1\n" for i in range(600)))
    meshhier.build(tmp_path / "a.obj", tmp_path / name, objects="group").close()
    with Host(tmp_path) as host, meshhier.open(f"{host.address}/{name}") as web:
        assert web.objects is not None and web.objects[0].name == "house 0000"
        child = os.fork()
        if child == 0:
            signal.alarm(120)
            os._exit(0 if web.objects[599].name == "house 0599" else 1)
        assert os.waitpid(child, 0)[1] == 0
