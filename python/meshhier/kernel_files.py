# SPDX-License-Identifier: MIT
"""Files of hierarchies for browsers on this machine, while Python runs: at 127.0.0.1, by addresses that nobody can guess."""

from __future__ import annotations

import os
import re
import secrets
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Optional

from .errors import Error
from .storage import Files, open_files

_ADDRESS = re.compile(r"/([\w-]+)/((?:tiles/\d+/(?:\d+/)?\d+\.glb)|(?:[a-z_]+\.[a-z]+))(?:\?.*)?")
_RANGE = re.compile(r"bytes=(\d{1,18})-(\d{1,18})")


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server: _Server

    def log_message(self, format: str, *args: object) -> None:
        """Says nothing: what it would write to is the notebook's."""

    def do_OPTIONS(self) -> None:
        self._answer(204, b"", {"Access-Control-Allow-Methods": "GET, HEAD", "Access-Control-Allow-Headers": "Range", "Access-Control-Allow-Private-Network": "true"})

    def do_HEAD(self) -> None:
        self.do_GET()

    def do_GET(self) -> None:
        match = _ADDRESS.fullmatch(self.path)
        files = self.server.files.get(match[1]) if match else None
        if match is None or files is None:
            return self._answer(404, b"", {})
        wanted = _RANGE.fullmatch(self.headers.get("Range", ""))
        try:
            if wanted is None:
                return self._answer(200, files.read(match[2]), {})
            first = int(wanted[1])
            part = files.part(match[2], first, int(wanted[2]) + 1)
        except (Error, OSError):
            return self._answer(404, b"", {})
        if not part:
            return self._answer(416, b"", {})
        self._answer(206, part, {"Content-Range": f"bytes {first}-{first + len(part) - 1}/*"})

    def _answer(self, status: int, content: bytes, headers: dict[str, str]) -> None:
        self.send_response(status)
        for name, value in {
            "Content-Length": str(len(content)),
            "Content-Type": "application/octet-stream",
            "X-Content-Type-Options": "nosniff",
            "Access-Control-Allow-Origin": "*",
            "Access-Control-Expose-Headers": "Content-Range",
            **headers,
        }.items():
            if status != 204 or name != "Content-Length":
                self.send_header(name, value)
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(content)


class _Server(ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        self.files: dict[str, Files] = {}
        self.tokens: dict[tuple[object, ...], str] = {}
        self.process = os.getpid()
        threading.Thread(target=self.serve_forever, name="meshhier", daemon=True).start()

    def handle_error(self, request: object, client_address: object) -> None:
        """Says nothing: a browser has gone."""


_lock = threading.Lock()
_server: Optional[_Server] = None


def _facts(path: str) -> tuple[int, ...]:
    """By what a file is told from one that takes its place; of none nothing."""
    try:
        facts = os.stat(path)
    except FileNotFoundError:
        return ()
    return facts.st_ino, facts.st_mtime_ns


def kernel_address(path: str) -> str:
    """Where a browser on this machine finds the hierarchy that is at an absolute path now, until Python ends. Another one that takes its
    place has another address."""
    global _server
    key = path, *_facts(path)
    with _lock:
        if _server is None or _server.process != os.getpid():  # a fork has no threads
            _server = _Server()
        if key not in _server.tokens:
            token = secrets.token_urlsafe(16)
            _server.files[token] = open_files(path)
            _server.tokens[key] = token
        return f"http://127.0.0.1:{_server.server_address[1]}/{_server.tokens[key]}"
