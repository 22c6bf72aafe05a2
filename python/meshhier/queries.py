# SPDX-License-Identifier: MIT
"""Questions about many points and rays, which the program answers (`meshhier query`): arrays go through pipes, tiles stay on the disk."""

from __future__ import annotations

import ast
import json
import operator
import subprocess
import threading
from dataclasses import dataclass
from typing import IO, TYPE_CHECKING, Any, NoReturn, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ProgramNotFoundError, ReplacedError, UsageError, program_error
from .options import Files, option_words, path_word, spoken
from .process import find_program
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
        bound: the original surface is no farther from the one that was asked than this, nor is this one from that.
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


def nearest(
    hierarchy: Hierarchy,
    points: ArrayLike,
    level: Optional[int],
    error: Optional[float],
    signed: bool,
    memory_budget: Union[int, str, None],
) -> Nearest:
    words = [*_selection(level, error), *(["--signed"] if signed else [])]
    answers, told = _ask(hierarchy, "--points", _rows(points, 3, "points"), words, memory_budget)
    return Nearest(**_common(answers, told), sides=_field(answers, "side"))


def rays(
    hierarchy: Hierarchy,
    origins: ArrayLike,
    directions: ArrayLike,
    level: Optional[int],
    error: Optional[float],
    memory_budget: Union[int, str, None],
) -> Hits:
    starts, ways = _rows(origins, 3, "origins"), _rows(directions, 3, "directions")
    if len(starts) != len(ways) and 1 not in (len(starts), len(ways)):
        raise UsageError(f"there are {len(starts)} origins and {len(ways)} directions: as many, or one of either, make rays")
    both = np.concatenate(np.broadcast_arrays(starts, ways), axis=1)
    answers, told = _ask(hierarchy, "--rays", both, _selection(level, error), memory_budget)
    return Hits(**_common(answers, told), normals=answers["normal"])


def _common(answers: NDArray[Any], told: dict[str, Any]) -> dict[str, Any]:
    names = {"distances": "distance", "points": "point", "levels": "level", "indices": "index", "triangles": "triangle"}
    fields = {attribute: answers[name] for attribute, name in names.items()}
    return {**fields, "objects": _field(answers, "object"), "bound": float(told["error_bound"])}


def _field(answers: NDArray[Any], name: str) -> Optional[NDArray[Any]]:
    return answers[name] if name in (answers.dtype.names or ()) else None


def _rows(given: ArrayLike, columns: int, name: str) -> NDArray[Any]:
    """(n, columns) float64 or float32; one row may come without its list."""
    try:
        array = np.asarray(given)
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


def _selection(level: Optional[int], error: Optional[float]) -> list[str]:
    if level is not None and error is not None:
        raise UsageError("a surface is asked for by error or by level, not both")
    if level is not None:
        try:
            number = operator.index(level)
        except TypeError:
            number = -1
        if number < 0 or isinstance(level, bool):
            raise UsageError(f"a level is a number from 0 on, not {level!r}")
        return ["--level", str(number)]
    if error is not None:
        if not 0 <= error < float("inf"):
            raise UsageError(f"an error is 0 or more, in input units, not {error}")
        return ["--error", repr(float(error))]
    return []


def _ask(
    hierarchy: Hierarchy, option: str, rows: NDArray[Any], words: Sequence[str], memory_budget: Union[int, str, None]
) -> tuple[NDArray[Any], dict[str, Any]]:
    """The answers of the program, and its account."""
    place, headers, _ = hierarchy._place
    with Files() as files:
        known = option_words("query", {"headers": headers, "memory_budget": memory_budget}, files)
        command = [find_program(), "query", path_word(place), option, "-", "-o", "-", "--format", "npy", "--json", "--progress", "none", *words, *known]
        try:
            process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        except OSError as failure:
            raise ProgramNotFoundError(f"cannot start {command[0]}: {failure}") from failure
        said: list[bytes] = []
        assert process.stdin is not None and process.stdout is not None and process.stderr is not None
        threads = [
            threading.Thread(target=_send, args=(process.stdin, rows), daemon=True),
            threading.Thread(target=lambda stream: said.append(stream.read()), args=(process.stderr,), daemon=True),
        ]
        try:
            with process:
                for thread in threads:
                    thread.start()
                answers = _receive(process.stdout)
                for thread in threads:
                    thread.join()
        except BaseException:
            process.terminate()
            process.wait()
            raise
    text = said[0].decode("utf-8", "replace")
    if process.returncode != 0 or answers is None:
        _fail(text, process.returncode)
    told = json.loads(text[text.index("{") : text.rindex("}") + 1])
    if int(told["index_checksum"], 16) != int(hierarchy.manifest["index"]["checksum"], 16):
        raise ReplacedError(f"{hierarchy.path}: another hierarchy has taken its place since it was opened: open it again")
    return answers, told


def _send(stream: IO[bytes], rows: NDArray[Any]) -> None:
    """Writes an array as a .npy, and no copy of it but a block."""
    try:
        with stream:
            kind = "<f4" if rows.dtype == np.float32 else "<f8"
            head = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {rows.shape}, }}".ljust(117) + "\n"
            stream.write(b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head.encode())
            for first in range(0, len(rows), 65536):
                stream.write(np.ascontiguousarray(rows[first : first + 65536], kind).tobytes())
    except OSError:
        pass  # it ended, and says why


def _receive(stream: IO[bytes]) -> Optional[NDArray[Any]]:
    """Reads a .npy of records; None if it is not whole."""
    front = stream.read(10)
    if len(front) < 10:
        return None
    head = ast.literal_eval(stream.read(int.from_bytes(front[8:10], "little")).decode("latin-1"))
    records: NDArray[Any] = np.empty(head["shape"], np.dtype(head["descr"]))
    room, filled = records.view(np.uint8).data, 0
    while filled < len(room):
        count = stream.readinto(room[filled:])  # type: ignore[attr-defined]
        if not count:
            return None
        filled += count
    return records


def _fail(said: str, code: int) -> NoReturn:
    message = said.strip().removeprefix("meshhier: ") or f"the program ended with exit code {code}"
    raise program_error(spoken(message, "query"), code if code > 0 else 128 - code)
