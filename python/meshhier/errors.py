# SPDX-License-Identifier: MIT
"""What can go wrong, as types."""


class Error(Exception):
    """The base of all errors of this package."""


class NotAHierarchyError(Error):
    """There is no hierarchy at that place, or one of a version that this package does not know."""


class CorruptError(Error):
    """A file of a hierarchy is not what the format says."""


class ReplacedError(Error):
    """Another build has taken the place of the hierarchy since it was opened: what is left of the two is never put together. Open it again."""


class UsageError(Error):
    """The call makes no sense for this hierarchy: a level that it does not have, a key that no config has."""


class ExistsError(UsageError, FileExistsError):
    """There is a file of that name already, and nobody said `force=True`. It is a FileExistsError, too."""


class ProgramError(Error):
    """The program ended with a failure.

    Attributes:
        exit_code: as docs/command_line.md tells them, 128 + n after signal n.
        message: what the program said, without its progress.
    """

    def __init__(self, message: str, exit_code: int) -> None:
        super().__init__(message, exit_code)  # both, so that it can be pickled
        self.message = message
        self.exit_code = exit_code

    def __str__(self) -> str:
        return self.message


class InputError(ProgramError):
    """The mesh cannot be read, or holds what no hierarchy can."""


class BudgetError(ProgramError):
    """Memory or disk do not suffice."""


class VerifyError(ProgramError):
    """The hierarchy is not what it should be; the message tells all problems."""


class ProgramNotFoundError(Error):
    """The program `meshhier` is not there."""


class BuildWarning(UserWarning):
    """What the program repaired, left out or could not use, and what else is to be known of a result."""
