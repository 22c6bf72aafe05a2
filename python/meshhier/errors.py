# SPDX-License-Identifier: MIT
"""What can go wrong, as types."""

from __future__ import annotations

from contextlib import contextmanager
from typing import Any, Iterator, Optional


class Error(Exception):
    """The base of all errors of this package."""


class NotAHierarchyError(Error):
    """There is no hierarchy at that place, or one of a version that this package does not know."""


class CorruptError(Error):
    """A file of a hierarchy is not what the format says."""


class ReplacedError(Error):
    """Another build has taken the place of the hierarchy since it was opened: what is left of the two is never put together. Open it again."""


#: What comes of bytes and JSON that are not what their reader takes them for.
MISREAD = (AttributeError, LookupError, OverflowError, RecursionError, TypeError, ValueError)
_MOST_TOLD = 200  # letters of what a file has where something else belongs


def misread(what: str, error: Exception) -> CorruptError:
    """What is raised where one of MISREAD was."""
    return CorruptError(f"{what}: {repr(error)[:_MOST_TOLD]}")


def replaced(path: str) -> ReplacedError:
    """What is raised where a hierarchy that is open is another one by now."""
    return ReplacedError(f"{path}: another hierarchy has taken its place since it was opened: open it again")


class UsageError(Error):
    """The call makes no sense for this hierarchy: a level that it does not have, a key that no config has."""


class ProgramError(Error):
    """The program ended with a failure.

    Attributes:
        exit_code: as docs/command_line.md tells them, 128 + n after signal n.
        message: what the program said, without its progress.
    """

    def __init__(self, message: str, exit_code: int) -> None:
        super().__init__(message)
        self.message = message
        self.exit_code = exit_code

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.message, self.exit_code)


class InputError(ProgramError):
    """The mesh cannot be read, or holds what no hierarchy can."""


class FileError(ProgramError, OSError):
    """A file, or an address, could not be read or written: it is not there, or the disk is full. It is an OSError, too."""

    def __init__(self, message: str, exit_code: int = 4) -> None:
        super().__init__(message, exit_code)


@contextmanager
def file_errors(path: str, made: str = "") -> Iterator[None]:
    """Lets what the system says against a file be a FileError that names it, or `path`: of `made`, which takes that place later, too."""
    try:
        yield
    except Error:
        raise
    except OSError as error:
        is_made = made and str(error.filename).startswith(made)
        name = path if is_made or error.filename is None else error.filename
        failure = FileError(f"{name}: {error.strerror or error}")
        failure.errno = error.errno
        raise failure from error


class BudgetError(ProgramError):
    """Memory or disk do not suffice."""


class ExistsError(ProgramError, FileExistsError):
    """The output is there already, of the program or of this package, and nobody said `force=True`. It is a FileExistsError, too."""

    def __init__(self, message: str, exit_code: int = 5) -> None:
        super().__init__(message, exit_code)


class BusyError(ProgramError):
    """Another build, or another command, is at work on this output."""


class StoppedBuildError(ProgramError):
    """A build of another config was stopped and left its work beside the output. `restart=True` throws that away."""


class KilledError(ProgramError):
    """The program was stopped from outside, by SIGTERM (130) or another signal (128 + n): SIGKILL, 137, may say that the system lacked memory.
    The same build goes on where it was."""


class DefectError(ProgramError):
    """A defect in meshhier: please report it."""


class VerifyError(ProgramError):
    """The hierarchy is not what it should be; the message tells all problems.

    Attributes:
        problems: one text each; empty if it is so damaged that it could not be opened.
    """

    def __init__(self, message: str, exit_code: int = 7, problems: tuple[str, ...] = ()) -> None:
        super().__init__(message, exit_code)
        self.problems = problems

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.message, self.exit_code, self.problems)


class NetworkError(Error):
    """An address could not be read: the message says why, and what may help. It has no secret.

    Attributes:
        status: what the host answered, as 403; None if it did not.
    """

    def __init__(self, message: str, status: Optional[int] = None) -> None:
        super().__init__(message)
        self.status = status

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.args[0], self.status)


class ProgramNotFoundError(Error):
    """The program `meshhier` is not there."""


class BuildWarning(UserWarning):
    """What the program repaired, left out or could not use, and what else is to be known of a result."""


_KINDS: dict[int, type[ProgramError]] = {
    3: InputError, 4: FileError, 5: ExistsError, 6: BudgetError, 7: VerifyError, 8: BusyError, 9: StoppedBuildError, 70: DefectError,
}  # fmt: skip


def program_error(message: str, exit_code: int) -> Error:
    """The error of a program that has ended so."""
    if exit_code == 2:
        return UsageError(message)
    return _KINDS.get(exit_code, KilledError if exit_code > 128 else ProgramError)(message, exit_code)
