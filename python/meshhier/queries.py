# SPDX-License-Identifier: MIT
"""Questions about many points and rays, which the program answers (`meshhier query`): arrays go through pipes, tiles stay on the disk."""

from __future__ import annotations

import ast
import json
from dataclasses import dataclass
from functools import partial
from typing import IO, TYPE_CHECKING, Any, Mapping, Optional, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ProgramError, UsageError, replaced
from .options import Files, option_words, path_word
from .process import run_program
from .tree import Node

if TYPE_CHECKING:
    from .hierarchy import Hierarchy


@dataclass(frozen=True, repr=False)
class _Answers:
    bound: float
    distances: NDArray[np.float64]
    points: NDArray[np.float64]
    levels: NDArray[np.int32]
    indices: NDArray[np.int64]
    triangles: NDArray[np.int64]
    objects: Optional[NDArray[np.int64]]

    def __len__(self) -> int:
        return len(self.distances)

    def node(self, row: int) -> Optional[Node]:
        """The tile that has the triangle of a row, for `Hierarchy.read_tile()`; None where there is none."""
        return Node(int(self.levels[row]), int(self.indices[row])) if self.triangles[row] >= 0 else None


@dataclass(frozen=True, repr=False)
class Nearest(_Answers):
    """The nearest places of the surface to n points, in their order. Where a point has a NaN or an infinite coordinate, floats are
    NaN and numbers are -1.

    Attributes:
        distances: (n,); below 0 inside, if sides were asked for.
        points: (n, 3), the places on the surface, input coordinates.
        levels, indices: (n,), the tiles: `node(i)`.
        triangles: (n,), numbers among `Tile.triangles`.
        objects: (n,), the triangles' objects; None if the mesh has none.
        sides: (n,), 1 outside, -1 inside, 0 where that is not known: at borders; None if nobody asked.
        bound: the original surface is no farther from the one that was asked than this, nor is this one from that. At the borders of a
            piece, where whole triangles end, distances may differ by more.
    """

    sides: Optional[NDArray[np.int8]]

    def __repr__(self) -> str:
        return f"Nearest({len(self)} points)"


@dataclass(frozen=True, repr=False)
class Hits(_Answers):
    """What n rays hit first, in their order. Where a ray hits nothing its distance is infinite, and where it is none (a NaN, a direction
    of zeros) that is NaN; then other floats are NaN and numbers are -1.

    Attributes:
        distances: (n,), along the ray, input units, however long its direction is.
        points: (n, 3), input coordinates.
        normals: (n, 3), of the triangles, of unit length, by the order of their corners: they may look away.
        levels, indices, triangles, objects, bound: as those of Nearest.
    """

    normals: NDArray[np.float64]

    @property
    def is_hit(self) -> NDArray[np.bool_]:
        """(n,): whether there is one."""
        return self.triangles >= 0

    def __repr__(self) -> str:
        return f"Hits({int(self.is_hit.sum())} of {len(self)} rays)"


def nearest(hierarchy: Hierarchy, points: ArrayLike, options: Mapping[str, Any]) -> Nearest:
    """`options`: keywords of the command."""
    answers, told = _ask(hierarchy, "--points", _rows(points, 3, "points"), options)
    return Nearest(**_common(answers, told), sides=_field(answers, "side"))


def rays(hierarchy: Hierarchy, origins: ArrayLike, directions: ArrayLike, options: Mapping[str, Any]) -> Hits:
    starts, ways = _rows(origins, 3, "origins"), _rows(directions, 3, "directions")
    if len(starts) != len(ways) and 1 not in (len(starts), len(ways)):
        raise UsageError(f"there are {len(starts)} origins and {len(ways)} directions: as many, or one of either, make rays")
    both = np.concatenate(np.broadcast_arrays(starts, ways), axis=1)
    answers, told = _ask(hierarchy, "--rays", both, options)
    return Hits(**_common(answers, told), normals=answers["normal"])


def _common(answers: NDArray[Any], told: dict[str, Any]) -> dict[str, Any]:
    names = {"distances": "distance", "points": "point", "levels": "level", "indices": "index", "triangles": "triangle"}
    fields = {attribute: answers[name] for attribute, name in names.items()}
    return {**fields, "objects": _field(answers, "object"), "bound": float(told["error_bound"])}


def _field(answers: NDArray[Any], name: str) -> Optional[NDArray[Any]]:
    return answers[name] if name in (answers.dtype.names or ()) else None


def _rows(given: Any, columns: int, name: str) -> NDArray[Any]:
    """(n, columns) float64 or float32; one row may come without its list. What is masked is NaN, which nothing is near to."""
    try:
        if isinstance(given, np.ma.MaskedArray):
            given = np.where(np.ma.getmaskarray(given), np.nan, np.ma.getdata(given))  # type: ignore[no-untyped-call]
        array = np.asarray(given)
        if array.dtype.kind == "O":  # as pandas' own types come: numbers, each by itself
            array = np.asarray(array.tolist())
        if array.dtype.kind == "b":
            raise TypeError
        if array.dtype != np.float32:
            array = array.astype(np.float64, casting="same_kind" if array.dtype.kind not in "iu" else "unsafe", copy=False)
    except (TypeError, ValueError):
        raise UsageError(f"{name} are an array of numbers, (n, {columns})") from None
    if array.ndim == 1 and array.size == columns:
        array = array.reshape(1, columns)
    if array.ndim == 1 and array.size == 0:
        array = array.reshape(0, columns)
    if array.ndim != 2 or array.shape[1] != columns:
        raise UsageError(f"{name} are an array of (n, {columns}), not {array.shape}")
    return array


def _ask(hierarchy: Hierarchy, kind: str, rows: NDArray[Any], options: Mapping[str, Any]) -> tuple[NDArray[Any], dict[str, Any]]:
    """The answers of the program, and its account. `kind`: of the questions, --points or --rays."""
    hierarchy._files.require_open()
    place, headers, _ = hierarchy._place
    answers: list[NDArray[Any]] = []

    def receive(stream: IO[bytes]) -> bytes:
        answers.extend(_receive(stream))
        return b""

    with Files() as files:
        known = option_words("query", {**options, "headers": headers}, files)
        words = ["query", path_word(place), kind, "-", "--output=-", "--format=npy", "--json", *known]
        result = run_program(words, prints_data=True, send=partial(_send, rows), receive=receive)
    told = _account(result.said)
    if not answers or told is None:
        raise ProgramError("the program told something else than answers: it is of another version", 0)
    if int(told["index_checksum"], 16) != int(hierarchy.manifest["index"]["checksum"], 16):
        raise replaced(hierarchy.path)
    return answers[0], told


def _account(said: Sequence[str]) -> Optional[dict[str, Any]]:
    """What the program tells by --json beside what it writes to its output."""
    text = "".join(said)
    return json.loads(text[text.index("{") : text.rindex("}") + 1]) if "{" in text else None


def _send(rows: NDArray[Any], stream: IO[bytes]) -> None:
    """Writes an array as a .npy, and no copy of it but a block."""
    kind = "<f4" if rows.dtype == np.float32 else "<f8"
    head = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {rows.shape}, }}".ljust(117) + "\n"
    stream.write(b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head.encode())
    for first in range(0, len(rows), 65536):
        stream.write(np.ascontiguousarray(rows[first : first + 65536], kind).tobytes())


def _receive(stream: IO[bytes]) -> list[NDArray[Any]]:
    """Reads a .npy of records; none if it is not whole."""
    front = stream.read(10)
    if len(front) < 10:
        return []
    head = ast.literal_eval(stream.read(int.from_bytes(front[8:10], "little")).decode("latin-1"))
    records: NDArray[Any] = np.empty(head["shape"], np.dtype(head["descr"]))
    room, filled = records.view(np.uint8).data, 0
    while filled < len(room):
        count = stream.readinto(room[filled:])  # type: ignore[attr-defined]
        if not count:
            return []
        filled += count
    return [records]
