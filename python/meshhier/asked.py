# SPDX-License-Identifier: MIT
"""Numbers and files that callers ask for, checked: a refusal says what would be right."""

from __future__ import annotations

import errno
import math
import numbers
import operator
import os
import re
import secrets
from contextlib import contextmanager
from typing import BinaryIO, Iterator, Sequence, Union

import numpy as np

from .errors import ExistsError, FileError, UsageError, file_errors

Path = Union[str, "os.PathLike[str]"]
Names = Union[str, Sequence[str]]


def path_text(value: object) -> str:
    """A path, or an address, as text. Raises UsageError for what is none; bytes are none."""
    name = os.fspath(value) if isinstance(value, (str, bytes, os.PathLike)) else None
    if isinstance(name, bytes):
        raise UsageError(f"expected a path, found {value!r}: os.fsdecode() makes one of bytes, whatever they are")
    if not isinstance(name, str) or not _can_be_a_word(name):
        is_address = isinstance(name, str) and is_web_address(name)  # perhaps with secrets
        raise UsageError(f"expected a path, found {'an address that is none' if is_address else repr(value)}")
    return name


def _can_be_a_word(path: str) -> bool:
    try:
        return b"\0" not in os.fsencode(path)
    except UnicodeEncodeError:
        return False


def is_web_address(text: str) -> bool:
    return re.match(r"https?://", text, re.IGNORECASE) is not None


def output_path(value: object) -> str:
    """The path of what is to be made, as text. Raises UsageError for what is none, and for an address."""
    name = path_text(value)
    if is_web_address(name):
        raise UsageError(f"expected a path on this machine to write to, found {name.partition('?')[0].rpartition('@')[2]!r}")
    return name


def exists(path: str) -> ExistsError:
    """What is raised where nobody said that a file may be replaced."""
    return ExistsError(f"{path} is already there; force=True replaces it")


def beside(place: str) -> str:
    """A free name for what takes that place later."""
    return os.path.join(os.path.dirname(place), f".{os.path.basename(place)[:200]}.{secrets.token_hex(4)}")


def require_folder(path: str) -> None:
    """Raises FileError unless there is a folder for what is to be made."""
    if not os.path.isdir(os.path.dirname(os.path.abspath(path))):
        failure = FileError(f"{path}: there is no folder for it")
        failure.errno = errno.ENOENT
        raise failure


def whole(value: object, what: str) -> int:
    """A whole number, of Python or numpy. Raises UsageError that begins with `what`, as "a level is a whole number"."""
    try:
        if not isinstance(value, (bool, np.bool_)):
            return operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        pass
    raise UsageError(f"{what}, not {value!r}")


def length(value: object, what: str) -> float:
    """A finite number, 0 or more. Raises UsageError that begins with `what`."""
    if isinstance(value, numbers.Real) and not isinstance(value, bool) and 0 <= float(value) < math.inf:
        return float(value)
    raise UsageError(f"{what}, not {value!r}")


@contextmanager
def new_file(path: Path, force: bool) -> Iterator[BinaryIO]:
    """A file to be written, which takes its place when all of it is there. Raises ExistsError if there is one and not `force`, FileError."""
    name = output_path(path)
    if os.path.lexists(name) and not force:
        raise exists(name)
    require_folder(name)
    place = os.path.realpath(name)
    made = beside(place)
    if os.path.exists(place) and not os.path.isfile(place):  # a pipe or a device
        with file_errors(name), open(place, "wb") as stream:
            yield stream
        return
    with file_errors(name, made):
        file = open(made, "xb")
        try:
            with file:
                yield file
            os.replace(made, place)
        except BaseException:
            os.unlink(made)
            raise
