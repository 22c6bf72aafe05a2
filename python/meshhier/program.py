# SPDX-License-Identifier: MIT
"""Runs the program `meshhier`."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import warnings
from dataclasses import dataclass
from typing import Any, Callable, Mapping, NoReturn, Optional, Sequence, Union

from .errors import BudgetError, BuildWarning, InputError, ProgramError, ProgramNotFoundError, UsageError, VerifyError
from .hierarchy import Hierarchy

Path = Union[str, "os.PathLike[str]"]


@dataclass(frozen=True)
class Progress:
    """How far the work is.

    Attributes:
        stage: "ingest", "simplify", ...
        done, total: of this stage, in `unit`s, as "vertices"; total is 0 if it is not known.
        job_done: the part of the whole job that is done, 0 to 1, or None.
        seconds_left: of the whole job, or None.
        json: the whole line, as docs/command_line.md tells it.
    """

    stage: str
    done: int
    total: int
    unit: str
    job_done: Optional[float]
    seconds_left: Optional[float]
    json: Mapping[str, Any]


ProgressCallback = Callable[[Progress], None]
WarningCallback = Callable[[str], None]

_ERRORS = {3: InputError, 6: BudgetError, 7: VerifyError}


def _name(path: Path) -> str:
    """A path as a word of a command: no option, whatever its first letter."""
    name = os.fspath(path)
    return f"./{name}" if name.startswith("-") else name


def find_program() -> str:
    """The program's path: what MESHHIER names, the one that came in this package, or that of the PATH.

    Raises ProgramNotFoundError.
    """
    packed = os.path.join(os.path.dirname(__file__), "program", "bin", "meshhier")
    named = os.environ.get("MESHHIER")
    found = named or (packed if os.path.exists(packed) else shutil.which("meshhier"))
    if found is None:
        raise ProgramNotFoundError(
            "the program meshhier is not on the PATH: install it, or name it by the environment variable MESHHIER"
        )
    return found


def _fail(message: str, code: int) -> NoReturn:
    if code == 2:
        raise UsageError(message)
    raise _ERRORS.get(code, ProgramError)(message, code)


class _Warnings:
    """Tells each warning once, as a BuildWarning where build() or verify() was called, and to a callback."""

    def __init__(self, callback: Optional[WarningCallback]) -> None:
        self._callback = callback
        self._told: set[str] = set()

    def tell(self, message: str) -> None:
        if message in self._told:
            return
        self._told.add(message)
        if self._callback is not None:
            self._callback(message)
        warnings.warn(message, BuildWarning, stacklevel=5)  # in whoever called build() or verify()


def _run(words: Sequence[str], progress: Optional[ProgressCallback], warning: Optional[WarningCallback]) -> None:
    """Runs the program; a callback that raises, and Ctrl-C, stop it first."""
    command = [find_program(), *words, "--progress", "json"]
    try:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace")
    except OSError as error:
        raise ProgramNotFoundError(f"cannot start {command[0]}: {error}") from error
    told = _Warnings(warning)
    try:
        with process:
            said = _read_messages(process, progress, told)
            assert process.stdout is not None
            found = process.stdout.read()
    except BaseException:
        process.send_signal(signal.SIGTERM)
        process.wait()
        raise
    if process.returncode != 0:
        message = "".join(said).strip() or found.strip() or f"ended with exit code {process.returncode}"
        code = process.returncode if process.returncode > 0 else 128 - process.returncode
        _fail(message if code != 7 else (found + "".join(said)).strip(), code)
    _read_account(found, told)


def _read_messages(process: subprocess.Popen[str], progress: Optional[ProgressCallback], told: _Warnings) -> list[str]:
    """Hands on what the program tells while it runs; returns what is left, its errors."""
    said = []
    assert process.stderr is not None
    for line in process.stderr:
        event = _event(line)
        if event is None:
            said.append(line)
        elif event["event"] == "error":
            said.append(event["message"])
        elif event["event"] == "warning":
            told.tell(event["message"])
        elif progress is not None and "stage" in event:
            progress(_progress(event))
    return said


def _read_account(account: str, told: _Warnings) -> None:
    """Hands on the warnings that the program tells of what it has made."""
    mark = "warning: "
    for line in account.splitlines():
        if line.startswith(mark):
            told.tell(line[len(mark) :])


def _event(line: str) -> Optional[dict[str, Any]]:
    """A line of --progress json; None if it is none."""
    try:
        told = json.loads(line) if line.startswith("{") else None
    except ValueError:
        return None
    return told if isinstance(told, dict) and "event" in told else None


def _progress(event: Mapping[str, Any]) -> Progress:
    return Progress(
        stage=event["stage"],
        done=event["done"],
        total=event["total"] or 0,
        unit=event["unit"],
        job_done=event["job_done"],
        seconds_left=event["job_eta_seconds"],
        json=event,
    )


def build(
    mesh: Union[Path, Sequence[Path]],
    output: Path,
    *,
    settings: Optional[Mapping[str, Any]] = None,
    force: bool = False,
    progress: Optional[ProgressCallback] = None,
    warning: Optional[WarningCallback] = None,
) -> Hierarchy:
    """Makes a hierarchy of a mesh, or of several together, and opens it. A build that was stopped goes on.

    Args:
        mesh: a file of any format that `meshhier build --help-formats` lists, or a list of such.
        output: "david.hier", or "david.3tz" for one file.
        settings: keys of the config, dotted: {"memory_budget": "2GiB", "storage.compression": "meshopt_zlib"}.
        force: replaces a hierarchy that is there.
        progress: is called twice a second at most. What it raises stops the build.
        warning: is called with each thing that was repaired, left out or could not be used. Each is a BuildWarning of the module
            `warnings`, too; a filter that makes it an error stops the build.

    Raises InputError, BudgetError, UsageError, ProgramError, ProgramNotFoundError.
    """
    meshes = [mesh] if isinstance(mesh, (str, os.PathLike)) else list(mesh)
    words = ["build", *(_name(one) for one in meshes), "-o", _name(output)]
    for key, value in (settings or {}).items():
        words += ["--set", f"{key}={value if isinstance(value, str) else json.dumps(value)}"]
    if force:
        words.append("--force")
    _run(words, progress, warning)
    return Hierarchy(output)


def verify(
    hierarchy: Path,
    *,
    input: Optional[Union[Path, Sequence[Path]]] = None,
    progress: Optional[ProgressCallback] = None,
    warning: Optional[WarningCallback] = None,
) -> None:
    """Checks everything: checksums, structure, seams; with `input` also that the partitions are that mesh, bit for bit. `progress`
    and `warning` are as those of build().

    Raises VerifyError with all problems; ProgramError, ProgramNotFoundError.
    """
    words = ["verify", _name(hierarchy)]
    inputs = [] if input is None else [input] if isinstance(input, (str, os.PathLike)) else list(input)
    for one in inputs:
        words += ["--input", _name(one)]
    _run(words, progress, warning)


def main() -> NoReturn:
    """The command `meshhier` of a wheel that carries the program."""
    program = find_program()
    os.execv(program, [program, *sys.argv[1:]])
