# SPDX-License-Identifier: MIT
"""Parts of files over HTTP and HTTPS (RFC 9110, section 14), by Python's own library."""

from __future__ import annotations

import http.client
import netrc
import re
import ssl
import time
import urllib.parse
import zlib
from dataclasses import dataclass, field
from email.utils import parsedate_to_datetime
from typing import Mapping, Optional, Sequence, Union

from .errors import NetworkError, ReplacedError, UsageError
from .http_connections import Connections, Origin, basic_credentials, target_of
from .options import header_lines
from .storage import closed
from .version import __version__

Headers = Union[Mapping[str, str], Sequence[str]]

#: If a host sends no parts, a file is taken whole up to so many bytes.
MOST_WHOLE = 64 << 20
TRIES = 5
FIRST_WAIT = 0.5  # seconds before the second try; twice as long each time
MOST_WAIT = 60.0  # however long the host asks for
SILENCE = 30.0  # seconds without a byte: then a try is over
_MOST_REDIRECTS = 10
_LEFT = "/%:=&~+!$,;'@()*[]"  # as it is in paths
_TOO_LARGE = f"the host sends files whole, but no parts of them (HTTP ranges), and this one has more than {MOST_WHOLE} bytes"
SENT_PACKED = "the host sends it packed (Content-Encoding), and then parts of it say nothing: switch that off for these files"
_PASSING = {408, 425, 429}  # and all from 500 on but 501


@dataclass(frozen=True)
class Address:
    """The address of a file. `url` may have secrets; `shown` is for messages and has none."""

    url: str = field(repr=False)
    shown: str


@dataclass
class Answer:
    """A part of a file, or all of it.

    Attributes:
        data: bytes.
        is_whole: `data` are all of the file: the host knows no ranges, or the file is small.
        total: bytes of the file; None if the host does not tell.
        version: its ETag or Last-Modified; empty if not known.
        tag: a strong ETag, to ask for more of the same file; or empty.
        encoding: its Content-Encoding, empty if it has none.
    """

    data: bytearray = field(default_factory=bytearray)
    is_whole: bool = False
    total: Optional[int] = None
    version: str = ""
    tag: str = ""
    encoding: str = ""


class _Passing(Exception):
    """A failure that may pass. `wait`: seconds the host asks for."""

    def __init__(self, message: str, status: Optional[int] = None, wait: float = 0) -> None:
        super().__init__(message)
        self.status, self.wait = status, wait


def without_secrets(address: str) -> str:
    """An address without user, password, query and fragment."""
    parts = _split(address)
    return urllib.parse.urlunsplit((parts.scheme, parts.netloc.rpartition("@")[2], parts.path, "", ""))


def _split(address: str) -> urllib.parse.SplitResult:
    try:
        parts = urllib.parse.urlsplit(address)
        parts.port  # may raise
        (parts.hostname or "").encode("idna")  # likewise
    except ValueError:
        raise UsageError("this is no address: expected https://HOST/NAME.3tz") from None
    if parts.scheme not in ("http", "https") or not parts.hostname or re.search(r"[\0-\x20\x7f]", address):
        raise UsageError("this is no address: expected https://HOST/NAME.3tz, without blanks (%20)")
    return parts


def _origin(parts: urllib.parse.SplitResult) -> Origin:
    return parts.scheme, (parts.hostname or "").lower(), parts.port or (443 if parts.scheme == "https" else 80)


def _length(text: str) -> Optional[int]:
    return int(text) if re.fullmatch(r"[0-9]{1,18}", text.strip()) else None


def _wished_wait(answer: http.client.HTTPResponse) -> float:
    """What Retry-After says: seconds, or a date."""
    text = answer.headers.get("Retry-After", "").strip()
    if text.isdigit() and len(text) < 9:
        return float(text)
    try:
        return max(0.0, parsedate_to_datetime(text).timestamp() - time.time())
    except (TypeError, ValueError, OverflowError):
        return 0.0


class HttpClient:
    """Asks hosts for parts of files. Thread-safe; connections stay open for the next request.

    What fails by the line or by a busy host is tried again, five times in all with growing waits or as long as the host asks for;
    bytes that have come are not asked for again. `headers`, user and password of an address and ~/.netrc go to its own host alone.
    """

    def __init__(self, headers: Optional[Headers] = None) -> None:
        try:
            lines = header_lines(headers or [])
        except ValueError as error:
            raise UsageError(f"headers: expected {error}") from None
        self._headers = [(name, value.strip()) for name, _, value in (line.partition(":") for line in lines)]
        self._connections = Connections(SILENCE)

    def close(self) -> None:
        self._connections.close()

    def get(self, address: Address, first: int, count: int, known: Optional[Answer] = None) -> Optional[Answer]:
        """The bytes [first, first + count) of a file, fewer only at its end, or all of it; None if there is no such file.

        `known`: an earlier answer of the same file. Raises ReplacedError if it is another file by now; NetworkError.
        """
        answer = Answer(version=known.version, tag=known.tag, total=known.total) if known else Answer()
        wait = FIRST_WAIT
        for tries in range(1, TRIES + 1):
            if answer.is_whole:  # and broke off: it may come as a whole again, or in parts
                answer = Answer(version=answer.version, tag=answer.tag)
            try:
                return answer if self._fetch(address, first, count, answer, known is not None) else None
            except _Passing as failure:
                if tries == TRIES:
                    raise NetworkError(f"{address.shown}: {failure}, {TRIES} times", failure.status) from None
                time.sleep(min(max(wait, failure.wait), MOST_WAIT))
                wait *= 2
        raise AssertionError

    def _fetch(self, address: Address, first: int, count: int, answer: Answer, is_known: bool) -> bool:
        """Adds to `answer` what is missing of the part, or fills it with the whole. Returns False if there is no such file."""
        at = first + len(answer.data)
        response, connection, origin = self._ask(address, at, first + count, answer.tag)
        is_kept = False
        try:
            if response.status in (404, 410):
                return False
            if response.status != 416 or answer.data:
                _check_head(address, answer, response, at, is_known)
                self._receive(address, response, answer, MOST_WHOLE if answer.is_whole else count)
                _check_length(address, response, answer, first, count)
            else:  # the file ends before
                _note(address, answer, response, _length(response.headers.get("Content-Range", "").rpartition("/")[2]), is_known)
            is_kept = response.isclosed() and not response.will_close
            return True
        finally:
            if is_kept:
                self._connections.give_back(origin, connection)
            else:
                response.close()
                connection.close()

    def _receive(self, address: Address, response: http.client.HTTPResponse, answer: Answer, most: int) -> None:
        """Appends the body. Bytes that have come stay where it breaks off."""
        try:
            while chunk := _next_bytes(response):
                if len(answer.data) + len(chunk) > most:
                    raise NetworkError(f"{address.shown}: {_TOO_LARGE if answer.is_whole else 'the host sent more than the part that was asked for'}")
                answer.data += chunk
        except (OSError, OverflowError, http.client.HTTPException) as error:
            raise _Passing(_reason(error)) from None

    # One request.

    def _ask(self, address: Address, begin: int, end: int, tag: str) -> tuple[http.client.HTTPResponse, http.client.HTTPConnection, Origin]:
        """Sends a request and follows redirects."""
        url, own = address.url, _origin(_split(address.url))
        for _ in range(_MOST_REDIRECTS + 1):
            parts = _split(url)
            origin = _origin(parts)
            headers = {"Range": f"bytes={begin}-{end - 1}", "User-Agent": f"meshhier-python/{__version__}", **({"If-Range": tag} if tag else {})}
            headers.update(self._secrets(address, parts, origin == own))
            response, connection = self._send(address, parts, origin, headers)
            target = response.headers.get("Location")
            if response.status not in (301, 302, 303, 307, 308) or not target:
                return response, connection, origin
            response.close()
            connection.close()
            url = _led_to(address, url, target)
        raise NetworkError(f"{address.shown}: the host leads on and on, {_MOST_REDIRECTS} times")

    def _secrets(self, address: Address, parts: urllib.parse.SplitResult, is_own: bool) -> dict[str, str]:
        """Headers that the address's own host alone gets, and the user of this very address."""
        headers = dict(self._headers) if is_own else {}
        if "authorization" in (name.lower() for name in headers):
            return headers
        if parts.username is not None:
            headers["Authorization"] = basic_credentials(parts.username, parts.password)
        elif is_own and (known := _user_in_netrc(address, parts.hostname or "")):
            headers["Authorization"] = basic_credentials(*(urllib.parse.quote(word) for word in known))
        return headers

    def _send(
        self, address: Address, parts: urllib.parse.SplitResult, origin: Origin, headers: Mapping[str, str]
    ) -> tuple[http.client.HTTPResponse, http.client.HTTPConnection]:
        path = urllib.parse.quote(parts.path or "/", safe=_LEFT) + (f"?{urllib.parse.quote(parts.query, safe=_LEFT + '?')}" if parts.query else "")
        target, of_proxy = target_of(origin, path)
        while True:
            if self._connections.is_closed:
                raise closed(address.shown)
            connection, is_new = self._connections.lease(origin)
            try:
                # No Accept-Encoding: tiles that are stored as gzip come as they are.
                connection.putrequest("GET", target, skip_accept_encoding=True)
                for name, value in {**headers, **of_proxy}.items():
                    connection.putheader(name, value)
                connection.endheaders()
                return connection.getresponse(), connection
            except BaseException as error:
                connection.close()
                if not isinstance(error, (OSError, http.client.HTTPException)):
                    raise
                if is_new:
                    raise _failure(address, error) from None
                # else the host had closed a connection that was kept: the next one is new, or kept as well


def _led_to(address: Address, url: str, target: str) -> str:
    """Where a redirect leads."""
    try:
        led = urllib.parse.urljoin(url, target)
        _split(led)
        return led
    except (UsageError, ValueError):
        raise NetworkError(f"{address.shown}: the host leads to something that is not on the web") from None


def _user_in_netrc(address: Address, host: str) -> Optional[tuple[str, str]]:
    try:
        known = netrc.netrc().authenticators(host)
    except OSError:
        return None
    except netrc.NetrcParseError as error:  # its text may be a secret
        raise NetworkError(f"{address.shown}: ~/.netrc cannot be read, line {error.lineno}") from None
    return (known[0] or "", known[2] or "") if known else None


def _failure(address: Address, error: Exception) -> Exception:
    """Why a request has no answer."""
    if isinstance(error, ssl.SSLCertVerificationError):
        return NetworkError(
            f"{address.shown}: its certificate is not valid, so nobody knows who answers ({error.verify_message}); CURL_CA_BUNDLE, else SSL_CERT_FILE, can name a file of other authorities"
        )
    if isinstance(error, http.client.LineTooLong) or "headers" in str(error):
        return NetworkError(f"{address.shown}: the header of the host's answer is too large")
    return _Passing(_reason(error))


def _next_bytes(response: http.client.HTTPResponse) -> bytes:
    """Bytes that have come, after a wait for the first of them; none at the end. A read of more would lose all of it if that breaks off."""
    return response.read(0 if response.length == 0 else max(1, len(response.peek())))


def _reason(error: Exception) -> str:
    if isinstance(error, TimeoutError):
        return f"the host was silent for {SILENCE:g} s"
    if isinstance(error, http.client.IncompleteRead):
        return "the answer broke off"
    if isinstance(error, (OverflowError, http.client.BadStatusLine, http.client.UnknownProtocol)) and not isinstance(error, ConnectionError):
        return "what answers does not speak HTTP"
    return getattr(error, "strerror", None) or str(error) or type(error).__name__


def _refusal(address: Address, response: http.client.HTTPResponse) -> Exception:
    status = response.status
    if status in (401, 403):
        return NetworkError(f"{address.shown}: the host does not let everybody read it ({status}); give credentials in ~/.netrc or with headers={{...}}", status)
    if status in _PASSING or (status >= 500 and status != 501):
        return _Passing(f"the host answered {status}", status, _wished_wait(response))
    return NetworkError(f"{address.shown}: the host answered {status}", status)


def _check_head(address: Address, answer: Answer, response: http.client.HTTPResponse, at: int, is_known: bool) -> None:
    """Takes what the header says; `answer` is ready for the body then."""
    if response.status not in (200, 206):
        raise _refusal(address, response)
    if response.status == 206:
        said = re.fullmatch(r"bytes (\d{1,18})-(\d{1,18})/(\d{1,18}|\*)", response.headers.get("Content-Range", "").strip())
        if said is None:
            raise NetworkError(f"{address.shown}: the host does not tell which part it sends (Content-Range)")
        if int(said[1]) != at:
            raise NetworkError(f"{address.shown}: the host sent another part than was asked for")
        _note(address, answer, response, _length(said[3]), is_known)
        return
    total = _length(response.headers.get("Content-Length", ""))
    _note(address, answer, response, total, is_known)
    if is_known:
        raise NetworkError(f"{address.shown}: the host sends files whole now, but no parts of them (HTTP ranges)")
    if (total or 0) > MOST_WHOLE:
        raise NetworkError(f"{address.shown}: {_TOO_LARGE}")
    answer.data.clear()
    answer.is_whole, answer.total = True, total


def _note(address: Address, answer: Answer, response: http.client.HTTPResponse, total: Optional[int], is_known: bool) -> None:
    """Takes the file's version and length, which must not change."""
    tag = response.headers.get("ETag", "").strip()
    version = tag[2:] if tag.startswith("W/") else tag or response.headers.get("Last-Modified", "").strip()
    is_later = is_known or answer.version != "" or len(answer.data) > 0
    if is_later and (version != answer.version or (None not in (total, answer.total) and total != answer.total)):
        raise ReplacedError(f"{address.shown}: it has become another file on the host since it was opened: open it again")
    answer.version, answer.tag = version, tag if tag.startswith('"') else ""
    answer.total = answer.total if total is None else total
    answer.encoding = response.headers.get("Content-Encoding", "").strip().lower().replace("identity", "")


def _check_length(address: Address, response: http.client.HTTPResponse, answer: Answer, first: int, count: int) -> None:
    """Raises _Passing if the answer has ended too early."""
    end = None if answer.total is None else answer.total if answer.is_whole else min(count, answer.total - first)
    if response.length or (end is not None and len(answer.data) < end):
        if answer.encoding and not answer.is_whole and not response.length:
            raise NetworkError(f"{address.shown}: {SENT_PACKED}")
        raise _Passing("the answer broke off")


def unpacked(address: Address, answer: Answer) -> bytes:
    """All bytes of a file that the host has perhaps packed on its way. Raises NetworkError."""
    if answer.encoding not in ("", "gzip", "x-gzip"):
        raise NetworkError(f"{address.shown}: the host sends it packed, as {answer.encoding}; switch Content-Encoding off for these files")
    if not answer.encoding:
        return bytes(answer.data)
    unpacking = zlib.decompressobj(31)
    try:
        data = unpacking.decompress(bytes(answer.data), MOST_WHOLE)
    except zlib.error as error:
        raise NetworkError(f"{address.shown}: what the host sends packed cannot be unpacked: {error}") from None
    if not unpacking.eof:
        raise NetworkError(f"{address.shown}: what the host sends packed ends too early, or has more than {MOST_WHOLE} bytes")
    return data
