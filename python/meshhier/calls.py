# SPDX-License-Identifier: MIT
"""How a call of a function becomes a run of the program: places, an output, keywords."""

from __future__ import annotations

import os
import pathlib
from typing import TYPE_CHECKING, Any, Callable, Mapping, Optional, Sequence, Union, overload

from .asked import Path, output_path, path_text
from .hierarchy import Hierarchy, Place
from .http_client import Headers, without_secrets
from .options import Files, header_lines, option_words, path_word
from .process import Listeners, Result, run_program

MadeFile = Union[pathlib.Path, bytes]

if TYPE_CHECKING:
    from typing import Protocol

    from typing_extensions import Concatenate, ParamSpec

    Options = ParamSpec("Options")

    class Maker(Protocol[Options]):
        """What makes a file: its path, or without an output its bytes."""

        @overload
        def __call__(self, hierarchy: Place, output: None = None, *args: Options.args, **options: Options.kwargs) -> bytes: ...
        @overload
        def __call__(self, hierarchy: Place, output: Path, *args: Options.args, **options: Options.kwargs) -> pathlib.Path: ...
        def __call__(self, hierarchy: Place, output: Optional[Path] = None, *args: Options.args, **options: Options.kwargs) -> Any: ...


def maker(function: Callable[Concatenate[Place, Optional[Path], Options], MadeFile]) -> Maker[Options]:
    """Lets type checkers know that the result is bytes without an output, and else its path."""
    return function  # type: ignore[return-value]


def _place_word(place: Place) -> str:
    return path_word(path_text(place._place[0] if isinstance(place, Hierarchy) else place))


def output_words(output: Optional[Path]) -> list[str]:
    return [] if output is None else [f"--output={path_word(output_path(output))}"]


def _known_headers(places: Sequence[Place]) -> Headers:
    """Those of open hierarchies, each for its own host."""
    known = [place._place[:2] for place in places if isinstance(place, Hierarchy) and place._place[1]]
    return [f"{without_secrets(address)} {line}" for address, headers in known for line in header_lines(headers)]


def _listeners(given: Mapping[str, Any]) -> Listeners:
    return Listeners(given.get("progress"), given.get("warning"), given.get("account"))


def run(command: str, places: Sequence[Place], given: Mapping[str, Any], *further: str, **how: Any) -> Result:
    """Runs a command with the keywords of a call."""
    given = {**given, "headers": given.get("headers") or _known_headers(places)}
    with Files() as files:
        words = [command, *(_place_word(place) for place in places), *further, *option_words(command, given, files)]
        return run_program(words, _listeners(given), **how)


def make(command: str, hierarchy: Place, output: Optional[Path], given: Mapping[str, Any]) -> MadeFile:
    """Makes a file: returns its path, or without an output its bytes."""
    if output is None:
        return run(command, [hierarchy], given, "--output=-", prints_data=True).output
    run(command, [hierarchy], given, *output_words(output))
    return pathlib.Path(output)


def several(paths: Union[Path, Sequence[Path], None]) -> list[Path]:
    """What is one path, several, or none, as a list."""
    return [] if paths is None else [paths] if isinstance(paths, (str, bytes, os.PathLike)) else list(paths)
