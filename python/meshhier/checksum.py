# SPDX-License-Identifier: MIT
"""XXH3-64 with seed 0, the checksum of all files of a hierarchy (docs/file_format.md).

Algorithm: Yann Collet, "xxHash fast digest algorithm", the specification of XXH3. The stripes of a long input are summed by numpy, a thousand
blocks at a time; what is done once is done with Python's integers.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_SECRET = bytes.fromhex(
    "b8fe6c3923a44bbe7c01812cf721ad1cded46de9839097db7240a4a4b7b3671fcb79e64eccc0e578825ad07dccff7221b8084674f743248ee03590e6813a264c"
    "3c2852bb91c300cb88d0658b1b532ea371644897a20df94e3819ef46a9deacd8a8fa763fe39c343ff9dcbbc7c70b4f1d8a51e04bcdb45931c89f7ec9d9787364"
    "eac5ac8334d3ebc3c581a0fffa1363eb170ddd51b7f0da49d316552629d4689e2b16be587d47a1fc8ff8b8d17ad031ce45cb3a8f95160428afd7fbcabb4b407e"
)
_PRIME32 = (0x9E3779B1, 0x85EBCA77, 0xC2B2AE3D)
_PRIME64 = (0x9E3779B185EBCA87, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9, 0x85EBCA77C2B2AE63, 0x27D4EB2F165667C5)
_MIX_1 = 0x165667919E3779F9
_MIX_2 = 0x9FB21C651E98DF25
_MASK = 2**64 - 1

_STRIPE = 64
_STRIPES = 16  # of a block
_BLOCK = _STRIPE * _STRIPES
_AT_ONCE = 1024  # blocks: what numpy has in memory stays small
_SHORT = 240
_START = (_PRIME32[2], *_PRIME64[:4], _PRIME32[1], _PRIME64[4], _PRIME32[0])

_Words = NDArray[np.uint64]


def _u64(data: bytes, at: int) -> int:
    return int.from_bytes(data[at : at + 8], "little")


def _secret(at: int) -> int:
    return _u64(_SECRET, at)


def _folded(a: int, b: int) -> int:
    product = a * b
    return (product & _MASK) ^ (product >> 64)


def _avalanche(value: int) -> int:
    value = ((value ^ (value >> 37)) * _MIX_1) & _MASK
    return value ^ (value >> 32)


def _short_avalanche(value: int) -> int:
    value = ((value ^ (value >> 33)) * _PRIME64[1]) & _MASK
    value = ((value ^ (value >> 29)) * _PRIME64[2]) & _MASK
    return value ^ (value >> 32)


def _rotated(value: int, by: int) -> int:
    return ((value << by) & _MASK) | (value >> (64 - by))


def _tiny(data: bytes) -> int:
    """Of at most 16 bytes."""
    length = len(data)
    if length == 0:
        return _short_avalanche(_secret(56) ^ _secret(64))
    if length <= 3:
        combined = data[0] << 16 | data[length >> 1] << 24 | data[-1] | length << 8
        return _short_avalanche(combined ^ (_secret(0) & 0xFFFFFFFF) ^ (_secret(0) >> 32))
    if length <= 8:
        first, last = (int.from_bytes(part, "little") for part in (data[:4], data[-4:]))
        value = (last + (first << 32)) ^ _secret(8) ^ _secret(16)
        value ^= _rotated(value, 49) ^ _rotated(value, 24)
        value = (value * _MIX_2) & _MASK
        value = ((value ^ ((value >> 35) + length)) * _MIX_2) & _MASK
        return value ^ (value >> 28)
    low = _u64(data, 0) ^ _secret(24) ^ _secret(32)
    high = _u64(data, length - 8) ^ _secret(40) ^ _secret(48)
    swapped = int.from_bytes(low.to_bytes(8, "little"), "big")
    return _avalanche((length + swapped + high + _folded(low, high)) & _MASK)


def _mixed(data: bytes, at: int, secret: int) -> int:
    return _folded(_u64(data, at) ^ _secret(secret), _u64(data, at + 8) ^ _secret(secret + 8))


def _small(data: bytes) -> int:
    """Of 17 to 240 bytes."""
    length = len(data)
    total = length * _PRIME64[0]
    if length <= 128:
        for pair in range((length - 1) // 32 + 1):
            total += _mixed(data, 16 * pair, 32 * pair) + _mixed(data, length - 16 * (pair + 1), 32 * pair + 16)
        return _avalanche(total & _MASK)
    total = _avalanche((total + sum(_mixed(data, 16 * i, 16 * i) for i in range(8))) & _MASK)
    total += sum(_mixed(data, 16 * i, 16 * (i - 8) + 3) for i in range(8, length // 16))
    return _avalanche((total + _mixed(data, length - 16, 136 - 17)) & _MASK)


def _secret_words(at: int, count: int) -> _Words:
    return np.frombuffer(_SECRET, "<u8", count, at) if at % 8 == 0 else np.frombuffer(_SECRET[at : at + 8 * count], "<u8")


_STRIPE_KEYS = np.stack([_secret_words(8 * stripe, 8) for stripe in range(_STRIPES)])
_SCRAMBLE_KEY = _secret_words(len(_SECRET) - _STRIPE, 8)
_LAST_KEY = _secret_words(len(_SECRET) - _STRIPE - 7, 8)
_NEIGHBOUR = np.array([1, 0, 3, 2, 5, 4, 7, 6])
_LOW = np.uint64(0xFFFFFFFF)
_32 = np.uint64(32)


def _stripe_sums(stripes: _Words, keys: _Words) -> _Words:
    """(..., stripes, 8) words to (..., 8) sums."""
    keyed = stripes ^ keys
    return ((keyed & _LOW) * (keyed >> _32) + stripes[..., _NEIGHBOUR]).sum(axis=-2, dtype=np.uint64)


def _long(data: bytes) -> int:
    sums = np.array(_START, np.uint64)
    blocks = (len(data) - 1) // _BLOCK
    for first in range(0, blocks, _AT_ONCE):
        count = min(_AT_ONCE, blocks - first)
        words = np.frombuffer(data, "<u8", count * _BLOCK // 8, first * _BLOCK).reshape(count, _STRIPES, 8)
        for block in _stripe_sums(words, _STRIPE_KEYS):
            sums += block
            sums = ((sums ^ (sums >> np.uint64(47))) ^ _SCRAMBLE_KEY) * np.uint64(_PRIME32[0])
    rest = (len(data) - 1 - blocks * _BLOCK) // _STRIPE
    if rest > 0:
        words = np.frombuffer(data, "<u8", rest * 8, blocks * _BLOCK).reshape(rest, 8)
        sums += _stripe_sums(words, _STRIPE_KEYS[:rest])
    sums += _stripe_sums(np.frombuffer(data[-_STRIPE:], "<u8").reshape(1, 8), _LAST_KEY)
    lanes = [int(lane) for lane in sums]
    total = len(data) * _PRIME64[0]
    total += sum(_folded(lanes[2 * i] ^ _secret(11 + 16 * i), lanes[2 * i + 1] ^ _secret(19 + 16 * i)) for i in range(4))
    return _avalanche(total & _MASK)


def checksum(data: bytes) -> int:
    """XXH3-64 of bytes."""
    if len(data) > _SHORT:
        return _long(data)
    return _tiny(data) if len(data) <= 16 else _small(data)
