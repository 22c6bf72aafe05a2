# SPDX-License-Identifier: MIT
"""The options of the program's commands as keywords: the one table of both, and what it says of them in messages."""

from __future__ import annotations

import json
import operator
import os
import re
import shlex
import tempfile
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Callable, Mapping, Optional, Sequence

import numpy as np

from .asked import path_text
from .boxes import checked_box
from .errors import UsageError
from .polygons import rings_of
from .tree import as_node

_HELD = "meshhier-python-"
_FARTHEST = 1e300  # of a box for the program, which takes no infinite ones


class Files:
    """Files for values that the program takes from a file: lists of nodes, matrices, headers. They are there within `with`, and only
    this user may read them."""

    def __init__(self) -> None:
        self._folder: Optional[tempfile.TemporaryDirectory[str]] = None

    def __enter__(self) -> Files:
        return self

    def __exit__(self, kind: Optional[type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        if self._folder is not None:
            self._folder.cleanup()

    def hold(self, name: str, text: str) -> str:
        """Writes a file, whose name begins with the keyword; returns its path."""
        self._folder = self._folder or tempfile.TemporaryDirectory(prefix=_HELD)
        path = os.path.join(self._folder.name, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path


# Values as words of a command line. A writer returns the words behind the option's name, or [] for a flag; it raises ValueError with
# what it expects.


def path_word(path: Any) -> str:
    """A path as a word of a command: no option and no "-", whatever its first letter."""
    try:
        name = path_text(path)
    except UsageError:
        raise ValueError("a path") from None
    return f"./{name}" if name.startswith("-") else name


def _number(value: Any) -> str:
    if isinstance(value, bool):
        raise ValueError("a number")
    try:
        return str(operator.index(value))
    except TypeError:
        pass
    try:
        return repr(float(value))
    except (TypeError, ValueError):
        raise ValueError("a number") from None


def _text(value: Any, _: Files) -> list[str]:
    return [value if isinstance(value, str) else os.fspath(value) if isinstance(value, os.PathLike) else _number(value)]


def _path(value: Any, _: Files) -> list[str]:
    return [path_word(value)]


def _flag(value: Any, _: Files) -> list[str]:
    if value is not True:
        raise ValueError("True or False")
    return []


def _numbers(separator: str, count: Optional[int] = None) -> Callable[[Any, Files], list[str]]:
    """Numbers in one word, (1, 2) as "1,2": so many, or one or several. A text stays what it is."""

    def write(value: Any, files: Files) -> list[str]:
        is_one = not hasattr(value, "__len__")
        if isinstance(value, str) or (is_one and count is None):
            return _text(value, files)
        if count is not None and (is_one or len(value) != count):
            raise ValueError(f"{count} numbers")
        return [separator.join(_number(one) for one in value)]

    return write


def _corner(numbers: Any) -> str:
    return ",".join(_number(one) for one in numbers)


def _box(value: Any, _: Files) -> list[str]:
    return [_corner(np.clip(corner, -_FARTHEST, _FARTHEST)) for corner in checked_box(value)]


def _ends(value: Any, _: Files) -> list[str]:
    if isinstance(value, str) or not hasattr(value, "__len__") or [getattr(one, "__len__", int)() for one in value] != [2, 2]:
        raise ValueError("two places of 2 numbers")
    return [_corner(place) for place in value]


def _node(value: Any, _: Files) -> list[str]:
    return [str(as_node(value))]


def _scale(value: Any, _: Files) -> list[str]:
    return [value if isinstance(value, str) else f"1:{_number(value)}"]


def _cut(value: Any, files: Files) -> list[str]:
    if isinstance(value, (str, os.PathLike)):
        return [path_word(value)]
    try:
        return [files.hold("cut.json", json.dumps([_node(node, files)[0] for node in value]))]
    except TypeError:
        raise ValueError("a file, or the nodes of a cut") from None


def _polygon(value: Any, files: Files) -> list[str]:
    if isinstance(value, (str, os.PathLike)):
        return [path_word(value)]
    rings = [[[*ring.tolist(), ring[0].tolist()] for ring in polygon] for polygon in rings_of(value)]
    return [files.hold("polygon.geojson", json.dumps({"type": "MultiPolygon", "coordinates": rings}))]


def _matrix(value: Any, files: Files) -> list[str]:
    if isinstance(value, (str, os.PathLike)):
        return [path_word(value)]
    if not hasattr(value, "__len__") or [getattr(row, "__len__", int)() for row in value] != [4] * 4:
        raise ValueError("a file, or 4 rows of 4 numbers")
    return [files.hold("transform.txt", "".join(" ".join(_number(one) for one in row) + "\n" for row in value))]


def _is_true_or(write: Callable[[Any, Files], list[str]]) -> Callable[[Any, Files], list[str]]:
    """An option that may have a value."""
    return lambda value, files: [] if value is True else write(value, files)


_HEADER = re.compile(r"(?!https?:)[!#$%&'*+.^_`|~0-9a-z-]+:[\t -~\x80-\xff]*", re.ASCII | re.IGNORECASE)
_HOST = re.compile(r"[!-~]*(//|\.|:[0-9])[!-~]*")  # has a scheme, a dot or a port


def _without_host(line: str) -> str:
    """The header of a line, without the word before it that names its host; a word whose first colon is its end is a header's name."""
    word, *rest = re.split("[ \t]+", line, maxsplit=1)
    is_name = word.find(":") == len(word) - 1
    return rest[0] if rest and not is_name and _HOST.fullmatch(word) else line


def header_lines(headers: Any, may_name_hosts: bool = False) -> list[str]:
    """The lines of requests that a mapping or a list of lines stands for. Raises ValueError if one is none, or names a host and may not;
    it has no secret."""
    lines = [f"{name}: {value}" for name, value in headers.items()] if isinstance(headers, Mapping) else [headers] if isinstance(headers, str) else list(headers)
    for line in lines:
        header = _without_host(line) if isinstance(line, str) else ""
        if not _HEADER.fullmatch(header) or (header != line and not may_name_hosts):
            raise ValueError('names and values of headers, {"Authorization": "Bearer ..."}')
    return lines


def _headers(value: Any, files: Files) -> list[str]:
    lines = header_lines(value, may_name_hosts=True)
    return ["@" + files.hold("headers.txt", "".join(line + "\n" for line in lines))]  # everybody can read a command line


def _plain(value: Any) -> Any:
    """A value of numpy, or a path, as JSON has them."""
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError


def _setting(value: Any, _: Files) -> list[str]:
    refusal = 'keys and values, {"partition.vertices": 4096}'
    if not isinstance(value, tuple) or len(value) != 2 or not isinstance(value[0], str):
        raise ValueError(refusal)
    key, wanted = value[0], os.fspath(value[1]) if isinstance(value[1], os.PathLike) else value[1]
    try:
        word = wanted if isinstance(wanted, str) else json.dumps(wanted, default=_plain, ensure_ascii=False)
        if word is not wanted:
            word.encode()
    except UnicodeEncodeError:
        raise ValueError("lists of texts in UTF-8, as JSON has them; a mesh with another name goes by itself, or as `mesh`") from None
    except (TypeError, ValueError):
        raise ValueError(refusal) from None
    return [f"{key}={word}"]


@dataclass(frozen=True)
class Option:
    """An option of a command.

    Attributes:
        write: makes a value the words behind the option's name.
        name: as the command line has it; empty: the keyword with dashes.
        is_list: the value is one or several, or a mapping; the option stands before each.
        is_flag: it has no value.
    """

    write: Callable[[Any, Files], list[str]]
    name: str = ""
    is_list: bool = False

    @property
    def is_flag(self) -> bool:
        return self.write is _flag


FLAG, TEXT, PATH = Option(_flag), Option(_text), Option(_path)

_WEB = {"headers": Option(_headers, "--header"), "limit_rate": TEXT}
_SETTINGS = {"settings": Option(_setting, "--set", is_list=True)}
_FORCE = {"force": FLAG}
_MEMORY = {"memory_budget": TEXT}
_PIECE = {"box": Option(_box), "polygon": Option(_polygon), "crs": TEXT, "object": Option(_text, is_list=True), "where": TEXT}
_TILES = {"level": TEXT, "cut": Option(_cut), "error": TEXT}
_FORMAT = {"format": TEXT}

#: Of each command of the program, its options by their keywords.
COMMANDS: Mapping[str, Mapping[str, Option]] = {
    "build": {
        **_SETTINGS, **_FORCE, "drape": PATH, "objects": TEXT, "object_table": PATH, "restart": FLAG, "update": FLAG, "verbose": FLAG, "no_links": FLAG,
        "within": PATH, "dry_run": FLAG, "stats": PATH, "input_note": PATH,
    },
    "inspect": {**_WEB, "level": TEXT, "node": Option(_node), "prefix": Option(_is_true_or(_text), "--objects"), "find": TEXT, "where": TEXT},
    "verify": {
        **_WEB, **_MEMORY, **_PIECE, "input": Option(_path, is_list=True), "cuts": TEXT, "seed": TEXT, "error": FLAG, "samples": TEXT, "level": TEXT,
        "cut": Option(_cut),
    },
    "compare": {
        **_WEB, **_MEMORY, **_FORCE, "level": TEXT, "error": TEXT, "tolerance": TEXT, "unsigned": FLAG, "bound": FLAG, "transform": Option(_matrix), "objects": TEXT,
    },
    "export": {
        **_WEB, **_MEMORY, **_FORCE, **_TILES, **_PIECE, "node": Option(_node), "outline": FLAG, "clip": FLAG, "gsd": TEXT, "align": Option(_numbers(",", 2)),
        "dsm": PATH,
    },
    "preview": {
        **_WEB, **_MEMORY, **_FORCE, **_TILES, **_PIECE, **_FORMAT, "size": Option(_numbers("x", 2)), "view": Option(_numbers(",", 2)), "link": TEXT, "up": TEXT,
        "background": TEXT, "attribute": TEXT, "colour_by": TEXT, "ramp": TEXT, "range": Option(_numbers(",", 2)),
    },
    "draw": {
        **_WEB, **_MEMORY, **_FORCE, **_PIECE, **_FORMAT, "level": TEXT, "error": TEXT, "plan": FLAG, "elevation": TEXT, "section": Option(_ends),
        "plane": Option(_numbers(",", 4)), "cut_height": Option(_numbers(",")), "contours": TEXT, "scale": Option(_scale), "units": TEXT, "dpi": TEXT,
        "grid": Option(_is_true_or(_text)), "no_scale_bar": FLAG, "transparent": FLAG, "world_file": FLAG, "flat": FLAG,
    },
    "view": {**_WEB, **_SETTINGS, "link": TEXT, "clear": FLAG},
    "page": {**_WEB, **_FORCE, "size": TEXT, "link": TEXT, "fetch_pictures": FLAG, "viewer": PATH},
    "progressive": {**_MEMORY, **_FORCE, "node": Option(_node), "steps": TEXT},
    "reconstruct": {**_MEMORY, **_FORCE, "details": TEXT, "stats": FLAG},
    "plan": {**_SETTINGS, **_FORCE, "work": PATH, "tasks": TEXT},
    "task": {**_MEMORY, "index": TEXT, "of": TEXT, "scratch": PATH, "threads": TEXT, "status": FLAG},
    "clean": {"remove": FLAG},
    "query": {**_MEMORY, **_PIECE, "headers": _WEB["headers"], "level": TEXT, "error": TEXT, "signed": FLAG},
}  # fmt: skip

#: Options that no keyword stands for: how the program tells what it does, which the functions settle.
SETTLED = {"--help", "--json", "--progress", "--output"}
#: The same of single commands, and what takes their place, if anything does.
LEFT_OUT: Mapping[str, Mapping[str, str]] = {
    "build": {"--help-config": "the manual", "--help-formats": "the manual", "--each": "a loop of Python", "--jobs": "a loop of Python"},
    "query": {"--points": "nearest()", "--rays": "rays()", "--format": "arrays", "--force": "arrays", "--limit-rate": "none"},
    "task": {"--stages": "task_status()", "--next": "task_status()"},
}


def option_name(keyword: str, option: Option) -> str:
    return option.name or "--" + keyword.replace("_", "-")


def option_words(command: str, given: Mapping[str, Any], files: Files) -> list[str]:
    """The keywords of a call as options. Those that are None or False are not given. Raises UsageError for a value of another kind."""
    words = []
    for keyword, option in COMMANDS[command].items():
        value = given.get(keyword)
        if value is None or value is False:
            continue
        for one in _values(value, option):
            try:
                words += _one_option(option_name(keyword, option), option.write(one, files))
            except ValueError as error:
                raise UsageError(f"{keyword}: expected {error}, found {'something else' if keyword == 'headers' else repr(value)}") from None
    return words


def _values(value: Any, option: Option) -> Sequence[Any]:
    is_one = not option.is_list or isinstance(value, (str, bytes, os.PathLike)) or not hasattr(value, "__iter__")
    return [value] if is_one else list(value.items() if isinstance(value, Mapping) else value)


def _one_option(name: str, values: list[str]) -> list[str]:
    return [f"{name}={values[0]}"] if len(values) == 1 else [name, *values]


# What the program says of options and commands, for who calls functions.


def _spoken(command: str) -> dict[str, str]:
    of_all = {option_name(keyword, option): (keyword, option) for options in COMMANDS.values() for keyword, option in options.items()}
    own = {option_name(keyword, option): (keyword, option) for keyword, option in COMMANDS.get(command, {}).items()}
    return {name: f"{keyword}=True" if option.is_flag else f"{keyword}=" for name, (keyword, option) in {**of_all, **own}.items()}


def _call(words: Sequence[str]) -> Optional[str]:
    """A command line as a call, `clean("a.hier", remove=True)`; None if it is none."""
    command, arguments = words[0], list(words[1:])
    options = {option_name(keyword, option): (keyword, option) for keyword, option in COMMANDS[command].items()}
    places: list[str] = []
    said: list[str] = []
    while arguments:
        word = arguments.pop(0)
        if not word.startswith("-"):
            places.append(_literal(word))
        elif word not in options or (not options[word][1].is_flag and not arguments):
            return None
        else:
            said.append(f"{options[word][0]}={'True' if options[word][1].is_flag else _literal(arguments.pop(0))}")
    return f"meshhier.{command}({', '.join(places + said)})"


def _literal(word: str) -> str:
    """A word as Python has it: numbers, and what stands for something else (N, FILE), as they are."""
    return word if re.fullmatch(r"[0-9]+|[A-Z]+", word) else json.dumps(word, ensure_ascii=False)


def _call_in_text(found: re.Match[str]) -> str:
    try:
        return found[1] + (_call(shlex.split(found[2])) or found[0][1:-1]) + found[3]
    except ValueError:
        return found[0]


_QUOTED_COMMAND = re.compile(rf"([(`\"])meshhier ((?:{'|'.join(COMMANDS)}) [^()`\"]+)([)`\"])")


def spoken(message: str, command: str) -> str:
    """A message of the program in the words of a caller: `restart=True` for --restart."""
    names = _spoken(command)
    held = rf"{re.escape(tempfile.gettempdir())}/{_HELD}\w+/(\w+)\.\w+"  # the caller gave what is in it
    told = _QUOTED_COMMAND.sub(_call_in_text, re.sub(held, r"\1", message))
    return re.sub(r"(?<![\w-])--[a-z][a-z-]*", lambda found: names.get(found[0], found[0]), told)
