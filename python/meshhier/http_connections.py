# SPDX-License-Identifier: MIT
"""Connections to hosts of the web that stay open for the next request."""

from __future__ import annotations

import base64
import http.client
import os
import ssl
import threading
import urllib.parse
import urllib.request
from typing import Optional

from .errors import NetworkError

#: Scheme, host, port.
Origin = tuple[str, str, int]


def basic_credentials(user: Optional[str], password: Optional[str]) -> str:
    """The value of Authorization, for a user and a password as they stand in an address."""
    plain = f"{urllib.parse.unquote(user or '')}:{urllib.parse.unquote(password or '')}"
    return "Basic " + base64.b64encode(plain.encode()).decode()


def _context() -> ssl.SSLContext:
    """The authorities of the system, or those of a file that CURL_CA_BUNDLE or SSL_CERT_FILE names."""
    for name in ("CURL_CA_BUNDLE", "SSL_CERT_FILE"):
        file = os.environ.get(name)
        if file:
            try:
                return ssl.create_default_context(cafile=file)
            except OSError as error:
                raise NetworkError(f"{name}: no certificates can be read from {file}: {error}") from None
    return ssl.create_default_context()


def _proxy_of(origin: Origin) -> Optional[urllib.parse.SplitResult]:
    """The proxy of `https_proxy` and the like."""
    scheme, host, port = origin
    known = {} if urllib.request.proxy_bypass(f"{host}:{port}") else urllib.request.getproxies()
    proxy = known.get(scheme) or known.get("all")
    if not proxy:
        return None
    parts = urllib.parse.urlsplit(proxy if "://" in proxy else f"http://{proxy}")
    if parts.scheme != "http":
        raise NetworkError(f"the proxy for {scheme} is a {parts.scheme} one; http ones can be used: set {scheme}_proxy or no_proxy")
    return parts


class Connections:
    """Thread-safe: who asks has a connection alone for the time. A request without an answer for `silence` seconds fails."""

    def __init__(self, silence: float) -> None:
        self._silence = silence
        self._idle: dict[Origin, list[http.client.HTTPConnection]] = {}
        self._lock = threading.Lock()
        self._tls: Optional[ssl.SSLContext] = None
        self.is_closed: bool = False

    def close(self) -> None:
        with self._lock:
            self.is_closed = True
            idle, self._idle = self._idle, {}
        for connection in (one for some in idle.values() for one in some):
            connection.close()

    def lease(self, origin: Origin) -> tuple[http.client.HTTPConnection, bool]:
        """Returns a connection, and whether it is new."""
        with self._lock:
            idle = self._idle.get(origin)
            if idle:
                return idle.pop(), False
            if origin[0] == "https" and self._tls is None:
                self._tls = _context()
        return self._connect(origin), True

    def give_back(self, origin: Origin, connection: http.client.HTTPConnection) -> None:
        """Keeps a connection whose answer has been read to the end."""
        with self._lock:
            if not self.is_closed:
                self._idle.setdefault(origin, []).append(connection)
                return
        connection.close()

    def _connect(self, origin: Origin) -> http.client.HTTPConnection:
        scheme, host, port = origin
        proxy = _proxy_of(origin)
        near = (host, port) if proxy is None else (proxy.hostname or "", proxy.port or 80)
        if scheme == "http":
            return http.client.HTTPConnection(*near, timeout=self._silence)
        connection = http.client.HTTPSConnection(*near, timeout=self._silence, context=self._tls)
        if proxy is not None:
            connection.set_tunnel(host, port, {} if proxy.username is None else {"Proxy-Authorization": basic_credentials(proxy.username, proxy.password)})
        return connection


def target_of(origin: Origin, path: str) -> tuple[str, dict[str, str]]:
    """What a request asks for: the path, or for a proxy without TLS the whole address; and headers for that proxy."""
    proxy = _proxy_of(origin) if origin[0] == "http" else None
    if proxy is None:
        return path, {}
    host = f"[{origin[1]}]" if ":" in origin[1] else origin[1]
    return f"http://{host}:{origin[2]}{path}", {} if proxy.username is None else {"Proxy-Authorization": basic_credentials(proxy.username, proxy.password)}
