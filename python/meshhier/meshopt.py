# SPDX-License-Identifier: MIT
"""Decodes EXT_meshopt_compression (https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Vendor/EXT_meshopt_compression)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .errors import CorruptError

_GROUP = 16  # bytes of one column that share a header
_BLOCK_BYTES = 8192
_MOST_IN_BLOCK = 256
_MOST_FOLD = 4 * _GROUP  # bytes of attributes for one that is packed: a header of four groups that are all 0
_MOST_ELEMENTS = 1 << 24  # of a section of a tile


def decode(data: bytes, mode: str, filter_name: str, count: int, stride: int) -> bytes:
    """The bytes of a buffer view: `count` elements of `stride` bytes. Raises CorruptError."""
    if count > _MOST_ELEMENTS or not 0 < stride <= _MOST_IN_BLOCK:
        raise CorruptError(f"meshopt: {count} elements of {stride} bytes are more than a tile has")
    try:
        if mode == "ATTRIBUTES":
            return _filtered(_attributes(np.frombuffer(data, np.uint8), count, stride), filter_name)
        if mode == "TRIANGLES":
            numbers = _triangles(data, count)
        elif mode == "INDICES":
            numbers = _indices(data, count)
        else:
            raise CorruptError(f"meshopt: unknown mode {mode!r:.40}")
        return np.asarray(numbers, np.uint32).astype(np.uint16 if stride == 2 else np.uint32).tobytes()
    except (IndexError, OverflowError, ValueError) as error:
        raise CorruptError(f"meshopt: damaged data: {error}") from error


def _filtered(values: NDArray[np.uint8], name: str) -> bytes:
    if name in ("", "NONE"):
        return values.tobytes()
    if name != "EXPONENTIAL":
        raise CorruptError(f"meshopt: unknown filter {name!r:.40}")
    numbers = np.frombuffer(values.tobytes(), "<i4")
    exponents = numbers >> 24
    mantissas = (numbers << 8) >> 8
    return np.ldexp(mantissas.astype(np.float64), exponents).astype("<f4").tobytes()


def _attributes(data: NDArray[np.uint8], count: int, stride: int) -> NDArray[np.uint8]:
    if data[0] != 0xA0:
        raise CorruptError("meshopt: not attributes of version 0")
    if count * stride > len(data) * _MOST_FOLD:
        raise CorruptError(f"meshopt: {count} elements of {stride} bytes are not in {len(data)} bytes")
    result = np.empty((count, stride), np.uint8)
    last = data[len(data) - stride :].copy()
    block = min((_BLOCK_BYTES // stride) & ~(_GROUP - 1), _MOST_IN_BLOCK)
    packed, at = data.tobytes(), 1
    for first in range(0, count, block):
        rows = min(block, count - first)
        padded = -(-rows // _GROUP) * _GROUP
        for column in range(stride):
            deltas, at = _column(packed, at, padded)
            deltas = deltas[:rows]
            signed = (deltas >> 1) ^ (0 - (deltas & 1))
            result[first : first + rows, column] = np.cumsum(signed, dtype=np.uint8) + last[column]
        last = result[first + rows - 1]
    return result


# Of each byte the numbers of 2 bits and of 4 bits in it, the highest first.
_UNPACKED = {
    1: [bytes((byte >> 6, byte >> 4 & 3, byte >> 2 & 3, byte & 3)) for byte in range(256)],
    2: [bytes((byte >> 4, byte & 15)) for byte in range(256)],
}


def _column(data: bytes, at: int, padded: int) -> tuple[NDArray[np.uint8], int]:
    """The differences of one column of a block, and where the next begins."""
    groups, headers = padded // _GROUP, at
    at += -(-groups // 4)
    parts: list[bytes] = []
    for group in range(groups):
        kind = data[headers + group // 4] >> (2 * (group % 4)) & 3
        size = (0, 4, 8, _GROUP)[kind]
        part, at = data[at : at + size], at + size
        if kind in _UNPACKED:
            part = b"".join(map(_UNPACKED[kind].__getitem__, part))
            escape = (1 << 2 * kind) - 1
            if escape in part:
                count = part.count(escape)
                rest = iter(data[at : at + count])
                part, at = bytes(next(rest, 0) if value == escape else value for value in part), at + count
        parts.append(part or bytes(_GROUP))
    if at > len(data):
        raise CorruptError("meshopt: the data end early")
    return np.frombuffer(b"".join(parts), np.uint8), at


class _Varints:
    """Numbers of 7 bits a byte, the lowest first."""

    def __init__(self, data: bytes, at: int) -> None:
        self.data = data
        self.at = at

    def take(self) -> int:
        value = shift = 0
        while True:
            byte = self.data[self.at]
            self.at += 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value
            if shift > 28:
                raise CorruptError("meshopt: a number is too long")

    def take_after(self, last: int) -> int:
        value = self.take()
        return (last + ((value >> 1) ^ -(value & 1))) & 0xFFFFFFFF


def _triangles(data: bytes, count: int) -> list[int]:
    if data[0] & 0xF0 != 0xE0 or data[0] & 15 > 1 or count % 3 != 0:
        raise CorruptError("meshopt: not triangles of version 1")
    most_recent = 13 if data[0] & 15 >= 1 else 15
    codes = data[1 : 1 + count // 3]
    table = data[len(data) - 16 :]
    rest = _Varints(data, 1 + count // 3)
    edges = [(0, 0)] * 16
    vertices = [0] * 16
    edge_at = vertex_at = following = last = 0
    out: list[int] = []

    def push(vertex: int, is_new: bool = True) -> None:
        nonlocal vertex_at
        vertices[vertex_at] = vertex
        vertex_at = (vertex_at + is_new) & 15

    def push_edge(a: int, b: int) -> None:
        nonlocal edge_at
        edges[edge_at] = (a, b)
        edge_at = (edge_at + 1) & 15

    for code in codes:
        if code < 0xF0:
            a, b = edges[(edge_at - 1 - (code >> 4)) & 15]
            kind = code & 15
            if kind < most_recent:
                c = following if kind == 0 else vertices[(vertex_at - 1 - kind) & 15]
                following += kind == 0
                push(c, kind == 0)
            else:
                last = c = (last + (kind - (kind ^ 3))) & 0xFFFFFFFF if kind != 15 else rest.take_after(last)
                push(c)
            push_edge(c, b)
            push_edge(a, c)
        else:
            if code < 0xFE:
                kinds, first = table[code & 15], 0
            else:
                kinds, first = rest.data[rest.at], 0 if code == 0xFE else 15
                rest.at += 1
                if kinds == 0:
                    following = 0
            second, third = kinds >> 4, kinds & 15
            corners = []
            for kind in (first, second, third):
                if kind == 0:
                    corners.append(following)
                    following += 1
                else:
                    corners.append(vertices[(vertex_at - kind) & 15])
            a, b, c = corners
            if code >= 0xFE:
                if first == 15:
                    last = a = rest.take_after(last)
                if second == 15:
                    last = b = rest.take_after(last)
                if third == 15:
                    last = c = rest.take_after(last)
                push(a)
                push(b, second in (0, 15))
                push(c, third in (0, 15))
            else:
                push(a)
                push(b, second == 0)
                push(c, third == 0)
            push_edge(b, a)
            push_edge(c, b)
            push_edge(a, c)
        out += (a, b, c)
    return out


def _indices(data: bytes, count: int) -> list[int]:
    if data[0] & 0xF0 != 0xD0 or data[0] & 15 > 1:
        raise CorruptError("meshopt: not indices of version 1")
    rest = _Varints(data, 1)
    last = [0, 0]
    out = []
    for _ in range(count):
        value = rest.take()
        current = value & 1
        value >>= 1
        last[current] = (last[current] + ((value >> 1) ^ -(value & 1))) & 0xFFFFFFFF
        out.append(last[current])
    return out
