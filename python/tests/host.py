# SPDX-License-Identifier: MIT
"""A host of files for the tests, with the habits and faults of real ones."""

from __future__ import annotations

import gzip
import hashlib
import itertools
import re
import ssl
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any, Callable, Optional

Reply = Callable[["_Handler"], bool]


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server: "Host"

    def log_message(self, format: str, *args: object) -> None:
        pass

    def setup(self) -> None:
        super().setup()
        self.server.connections += 1

    def do_GET(self) -> None:
        host = self.server
        with host.lock:
            host.requests.append((self.path, dict(self.headers)))
        if host.reply is not None and host.reply(self):
            return
        self.send_file()

    def send_file(self, **changed: Any) -> None:
        """The part that is asked for. `changed`: headers by their names with _ for -; None leaves one out."""
        path = self.server.root / self.path.partition("?")[0].lstrip("/")
        if not path.is_file():
            return self.send(404, b"no such file")
        data = path.read_bytes()
        tag = f'"{hashlib.md5(data).hexdigest()}"'
        asked = re.fullmatch(r"bytes=(\d+)-(\d+)", self.headers.get("Range", ""))
        is_same = self.headers.get("If-Range", tag) == tag
        if asked is None or not self.server.has_ranges or not is_same:
            return self.send(200, data, **{"ETag": tag, **changed})
        first, last = int(asked[1]), min(int(asked[2]), len(data) - 1)
        if first >= len(data):
            return self.send(416, b"", **{"Content_Range": f"bytes */{len(data)}", "ETag": tag, **changed})
        self.send(206, data[first : last + 1], **{"Content_Range": f"bytes {first}-{last}/{len(data)}", "ETag": tag, **changed})

    def send(self, status: int, body: bytes, **headers: Any) -> None:
        self.send_response(status)
        for name, value in {"Content_Length": str(len(body)), **headers}.items():
            if value is not None:
                self.send_header(name.replace("_", "-"), str(value))
        self.end_headers()
        try:
            self.wfile.write(body)
        except OSError:
            self.close_connection = True

    def send_gzip(self) -> None:
        """As hosts that pack on the way, whatever was asked for."""
        path = self.server.root / self.path.lstrip("/")
        self.send(200, gzip.compress(path.read_bytes()), Content_Encoding="gzip")

    def send_half(self) -> None:
        """Half of what is promised; then the connection ends."""
        path = self.server.root / self.path.lstrip("/")
        data = path.read_bytes()
        first, last = (int(one) for one in re.findall(r"\d+", self.headers["Range"]))
        part = data[first : last + 1]
        self.send_response(206)
        self.send_header("Content-Length", str(len(part)))
        self.send_header("Content-Range", f"bytes {first}-{first + len(part) - 1}/{len(data)}")
        self.send_header("ETag", f'"{hashlib.md5(data).hexdigest()}"')
        self.end_headers()
        self.wfile.write(part[: max(1, len(part) // 2)])
        self.close_connection = True


class Host(ThreadingHTTPServer):
    """Serves a folder at `address`. `reply(handler)` may answer a request in its own way and return True."""

    daemon_threads = True

    def __init__(self, root: Path, certificate: Optional[Path] = None) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        self.root = root
        self.has_ranges = True
        self.reply: Optional[Reply] = None
        self.requests: list[tuple[str, dict[str, str]]] = []
        self.connections = 0
        self.lock = threading.Lock()
        scheme = "http"
        if certificate is not None:
            context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
            context.load_cert_chain(certificate)
            self.socket = context.wrap_socket(self.socket, server_side=True, do_handshake_on_connect=False)
            scheme = "https"
        self.address = f"{scheme}://127.0.0.1:{self.server_address[1]}"
        self._thread = threading.Thread(target=self.serve_forever, args=(0.05,), daemon=True)

    def handle_error(self, request: object, client_address: object) -> None:
        pass

    def __enter__(self) -> Host:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.shutdown()
        self.server_close()

    def bytes_asked(self) -> int:
        return sum(int(b) - int(a) + 1 for _, headers in self.requests for a, b in re.findall(r"bytes=(\d+)-(\d+)", headers.get("Range", "")))


def times(count: int, reply: Reply) -> Reply:
    """Does so with the first requests alone."""
    numbers = itertools.count()  # one step of it is whole, whatever threads answer

    def answer(handler: _Handler) -> bool:
        return next(numbers) < count and reply(handler)

    return answer


def status(code: int, **headers: Any) -> Reply:
    def answer(handler: _Handler) -> bool:
        handler.send(code, b"<html>sorry</html>", **headers)
        return True

    return answer


def slow(seconds: float) -> Reply:
    def answer(handler: _Handler) -> bool:
        time.sleep(seconds)
        return False

    return answer


def silent(until: threading.Event) -> Reply:
    def answer(handler: _Handler) -> bool:
        until.wait()
        return False

    return answer


def with_headers(**headers: Any) -> Reply:
    """Sends what is asked for, with other headers."""

    def answer(handler: _Handler) -> bool:
        handler.send_file(**headers)
        return True

    return answer


def half(handler: _Handler) -> bool:
    """Breaks off in the middle."""
    handler.send_half()
    return True


def redirect(before: str, code: int = 302) -> Reply:
    """Leads to the same path behind `before`."""
    return lambda handler: status(code, Location=before + handler.path)(handler)
