# SPDX-License-Identifier: MIT
"""Runs the program `meshhier`, and hands on what it tells while it works."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import warnings
from dataclasses import dataclass, field
from typing import IO, Any, Callable, Mapping, Optional, Sequence, Union
from urllib.parse import unquote_to_bytes

from .errors import BuildWarning, ProgramNotFoundError, program_error
from .options import spoken


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


_WARNING = "warning: "  # of commands without --progress

ProgressCallback = Callable[[Progress], None]
TextCallback = Callable[[str], None]


@dataclass(frozen=True)
class Listeners:
    """Callbacks of a call; what one raises stops the program. `account` gets what the program tells of its result, for people."""

    progress: Optional[ProgressCallback] = None
    warning: Optional[TextCallback] = None
    account: Optional[TextCallback] = None


@dataclass
class Result:
    """What a run of the program has left.

    Attributes:
        code: its exit code.
        output: its standard output.
        said: lines of its standard error that are for people.
        failure: why it failed, by --progress json.
        summary: the result, by the same: of a build its output.
    """

    code: int = 0
    output: bytes = b""
    said: list[str] = field(default_factory=list)
    failure: str = ""
    summary: str = ""

    @property
    def text(self) -> str:
        return self.output.decode("utf-8", "replace")

    def json(self) -> Any:
        return read_json(self.output)


def read_json(text: Union[str, bytes]) -> Any:
    """JSON of the program: names of files that are not UTF-8 are as os.fsdecode() has them."""
    return json.loads(text, object_hook=_with_names)


def _with_names(values: dict[str, Any]) -> dict[str, Any]:
    """Puts what is in a key KEY_escaped in the place of KEY, but for messages, which are to be printed."""
    end = "_escaped"
    for key in [key for key in values if key.endswith(end) and isinstance(values[key], str)]:
        name = unquote_to_bytes(values.pop(key))
        if key != "message" + end:
            values[key[: -len(end)]] = os.fsdecode(name)
    return values


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


class Warnings:
    """Tells each warning once, as a BuildWarning where the package was called, and to a callback."""

    def __init__(self, command: str, callback: Optional[TextCallback]) -> None:
        self._command = command
        self._callback = callback
        self._told: set[str] = set()

    def tell(self, message: str) -> None:
        text = spoken(message, self._command)
        if text in self._told:
            return
        self._told.add(text)
        if self._callback is not None:
            self._callback(text)
        warnings.warn(text, BuildWarning, stacklevel=_caller_level())


def _caller_level() -> int:
    """How many frames above its own caller the first one is that is not of this package."""
    own = os.path.dirname(__file__) + os.sep
    frame, level = sys._getframe(1), 1
    while frame.f_back is not None and frame.f_code.co_filename.startswith(own):
        frame, level = frame.f_back, level + 1
    return level


def run_program(
    words: Sequence[str],
    listeners: Listeners = Listeners(),
    *,
    tells_progress: bool = True,
    prints_data: bool = False,
    expected: Sequence[int] = (0,),
    send: Optional[Callable[[IO[bytes]], None]] = None,
    receive: Callable[[IO[bytes]], bytes] = lambda stream: stream.read(),
) -> Result:
    """Runs a command to its end; a callback that raises, and Ctrl-C, stop it first.

    `tells_progress`: the command has --progress. `prints_data`: what it prints is for programs, not for `listeners.account`.
    `send` writes its standard input, `receive` reads its standard output, each in a thread; what is returned is the result's output.
    Raises what its exit code means if that is none of `expected`; ProgramNotFoundError.
    """
    command = [find_program(), *words, *(["--progress=json"] if tells_progress else [])]
    source = subprocess.PIPE if send else subprocess.DEVNULL
    try:
        process = subprocess.Popen(command, stdin=source, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    except (OSError, ValueError) as error:  # ValueError: a zero byte in a word
        raise ProgramNotFoundError(f"cannot start {command[0]}: {error}") from error
    flows = [_Flow(receive, process.stdout), *([_Flow(send, process.stdin)] if send else [])]
    result = _listen(process, flows, listeners, Warnings(words[0], listeners.warning))
    if result.code not in expected:
        raise program_error(spoken(_why(result), words[0]), result.code if result.code > 0 else 128 - result.code)
    account = ("" if prints_data else result.text) + "".join(result.said)
    if listeners.account is not None and account:
        listeners.account(account)
    return result


class _Flow(threading.Thread):
    """What goes through a pipe while the program runs. A pipe that is not read or written to its end is closed, which ends the program."""

    def __init__(self, pass_on: Callable[[IO[bytes]], Any], stream: Optional[IO[bytes]]) -> None:
        super().__init__(daemon=True)
        assert stream is not None
        self._pass_on, self._stream = pass_on, stream
        self._failure: Optional[BaseException] = None
        self._got: Any = None
        self.start()

    def run(self) -> None:
        try:
            with self._stream:
                self._got = self._pass_on(self._stream)
        except BrokenPipeError:
            pass  # the program has ended, and says why
        except BaseException as failure:
            self._failure = failure

    def result(self) -> Any:
        """What came through. Raises what `pass_on` raised."""
        self.join()
        if self._failure is not None:
            raise self._failure
        return self._got


def _listen(process: subprocess.Popen[bytes], flows: Sequence[_Flow], listeners: Listeners, told: Warnings) -> Result:
    """`flows`: the first one has the output."""
    assert process.stderr is not None
    result = Result()
    try:
        for line in process.stderr:
            _hear(line.decode("utf-8", "replace"), result, listeners, told)
        result.code = process.wait()
        result.output, *_ = [flow.result() for flow in flows]
    except BaseException:
        _stop(process)
        raise
    finally:
        process.stderr.close()
        for flow in flows:
            flow.join()
    return result


def _stop(process: subprocess.Popen[bytes]) -> None:
    """Lets the program end as at Ctrl-C, and waits for that; at a second Ctrl-C kills it.

    Ctrl-C in a terminal reaches the program, too. A second SIGINT or SIGTERM would end it before it has cleaned up; SIGHUP says the
    same as often as one likes, but programs that are to outlive their terminal do not hear it.
    """
    is_deaf = signal.getsignal(signal.SIGHUP) == signal.SIG_IGN
    try:
        process.send_signal(signal.SIGTERM if is_deaf else signal.SIGHUP)
        assert process.stderr is not None
        while process.stderr.read(1 << 16):
            pass
        process.wait()
    except BaseException:
        process.kill()
        process.wait()
        raise


def _hear(line: str, result: Result, listeners: Listeners, told: Warnings) -> None:
    """Takes one line of what the program tells while it runs."""
    event = _event(line)
    kind = "" if event is None else event["event"]
    if line.startswith(_WARNING):
        told.tell(line[len(_WARNING) :].rstrip("\n"))
    elif event is None:
        result.said.append(line)
    elif kind == "error":
        result.failure = str(event["message"])
    elif kind == "warning":
        told.tell(str(event["message"]))
    elif kind == "finish":
        result.summary = str(event.get("summary", ""))
    elif kind in ("up_to_date", "outdated"):
        message = str(event["message"])
        result.said.append(message + "\n")
        result.summary = str(event.get("output", message.removesuffix(" is up to date"))) if kind == "up_to_date" else ""
    elif listeners.progress is not None and "stage" in event:
        listeners.progress(_progress(event))


def _why(result: Result) -> str:
    if result.failure:
        return result.failure
    said = "".join(line for line in result.said if not line.startswith("Run with --help")).strip()
    name = "meshhier: "
    return said[len(name) :] if said.startswith(name) else said or result.text.strip() or f"the program ended with exit code {result.code}"


def _event(line: str) -> Optional[dict[str, Any]]:
    """A line of --progress json; None if it is none."""
    try:
        event = read_json(line) if line.startswith("{") else None
    except ValueError:
        return None
    return event if isinstance(event, dict) and "event" in event else None


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
