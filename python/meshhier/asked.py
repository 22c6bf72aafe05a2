# SPDX-License-Identifier: MIT
"""Numbers and files that callers ask for, checked: a refusal says what would be right."""

from __future__ import annotations

import math
import numbers
import operator
import os
import secrets
from contextlib import contextmanager
from typing import BinaryIO, Iterator

import numpy as np

from .errors import ExistsError, UsageError


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
def new_file(path: str | os.PathLike[str], force: bool) -> Iterator[BinaryIO]:
    """A file to be written, which takes its place when all of it is there. Raises ExistsError if there is one and not `force`."""
    if os.path.lexists(path) and not force:
        raise ExistsError(f"{os.fspath(path)} is there already: give another name, or force=True to replace it")
    place = os.path.realpath(path)
    if os.path.exists(place) and not os.path.isfile(place):  # a pipe or a device
        with open(place, "wb") as stream:
            yield stream
        return
    made = os.path.join(os.path.dirname(place), f".{os.path.basename(place)[:200]}.{secrets.token_hex(4)}")
    try:
        file = open(made, "xb")
    except OSError as error:
        raise type(error)(error.errno, error.strerror, os.fspath(path)) from None
    try:
        with file:
            yield file
        os.replace(made, place)
    except BaseException:
        os.unlink(made)
        raise
