# SPDX-License-Identifier: MIT
"""Reads what `meshhier` makes of huge meshes, and makes it.

    import meshhier

    with meshhier.open("david.hier") as david:
        coarse = david.cut(error=0.5)           # no farther than half a unit from the original
        face = david.cut(box=((0, 4800, -200), (300, 5200, 300)))

Arrays are numpy's; coordinates and lengths are the input's.
"""

from __future__ import annotations

import os

from .errors import (
    BudgetError,
    BuildWarning,
    CorruptError,
    Error,
    ExistsError,
    InputError,
    NotAHierarchyError,
    ProgramError,
    ProgramNotFoundError,
    ReplacedError,
    UsageError,
    VerifyError,
)
from .hierarchy import Hierarchy
from .manifest import Scalar
from .mesh import Conventions, Mesh
from .objects import ObjectRow, ObjectTable
from .program import Progress, build, find_program, verify
from .tile import Tile
from .tree import Node, NodeLike, Tree
from .version import __version__


def open(path: str | os.PathLike[str]) -> Hierarchy:
    """Opens a hierarchy: a folder (`david.hier`) or an archive (`david.3tz`).

    Raises NotAHierarchyError if there is none, or one of another version; CorruptError if a file is damaged.
    Where a build replaces a hierarchy that is open, reading raises ReplacedError: two builds are never mixed.
    """
    return Hierarchy(path)


__all__ = [
    "BudgetError", "BuildWarning", "Conventions", "CorruptError", "Error", "ExistsError", "Hierarchy", "InputError", "Mesh", "Node", "NodeLike", "NotAHierarchyError", "ObjectRow", "ObjectTable", "ProgramError",
    "ProgramNotFoundError", "Progress", "ReplacedError", "Scalar", "Tile", "Tree", "UsageError", "VerifyError", "__version__", "build", "find_program", "open", "verify",
]  # fmt: skip
