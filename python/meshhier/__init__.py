# SPDX-License-Identifier: MIT
"""Reads what `meshhier` makes of huge meshes, and makes it.

    import meshhier

    with meshhier.open("david.hier") as david:
        coarse = david.cut(error=0.5)           # no farther than half a unit from the original
        face = david.cut(box=((0, 4800, -200), (300, 5200, 300)))

Arrays are numpy's; coordinates and lengths are the input's.
"""

from __future__ import annotations

from typing import Optional

from .asked import Path
from .errors import (
    BudgetError,
    BuildWarning,
    BusyError,
    CorruptError,
    DefectError,
    Error,
    ExistsError,
    FileError,
    InputError,
    KilledError,
    NetworkError,
    NotAHierarchyError,
    ProgramError,
    ProgramNotFoundError,
    ReplacedError,
    StoppedBuildError,
    UsageError,
    VerifyError,
)
from .hierarchy import Hierarchy
from .http_client import Headers
from .manifest import Scalar
from .mesh import Conventions, Mesh
from .objects import ObjectRow, ObjectTable
from .packing import pack, unpack
from .process import Progress, find_program
from .program import build, clean, compare, draw, export, inspect, inspect_objects, page, plan, preview, progressive, reconstruct, task, task_status, verify, view
from .queries import Hits, Nearest
from .remote import CACHE_BYTES
from .results import BuildPlan, Comparison, Leftover, TaskStatus, Verification
from .tile import Tile
from .tree import Node, NodeLike, Tree
from .version import __version__


def open(path: Path, *, headers: Optional[Headers] = None, cache_bytes: int = CACHE_BYTES) -> Hierarchy:
    """Opens a hierarchy: a folder (`david.hier`), an archive (`david.3tz`), or the address of one ("https://example.org/david.3tz").

    Args:
        headers: of requests, for an address: {"Authorization": "Bearer ..."}. They, user and password in the address and those of
            ~/.netrc go to its own host alone, and are in no message; a pickle has them.
        cache_bytes: parts of an address that stay in memory. With 0 nothing is fetched before it is asked for.

    On the web little more is fetched than is asked for, and of a cut up to six tiles at once, before they are wanted. A host that sends
    parts of files (HTTP ranges) is needed for files of more than 64 MiB.

    Raises NotAHierarchyError if there is none, or one of another version; CorruptError if a file is damaged; NetworkError.
    Where a build replaces a hierarchy that is open, reading raises ReplacedError: two builds are never mixed.
    """
    return Hierarchy(path, headers=headers, cache_bytes=cache_bytes)


__all__ = [
    "BudgetError", "BuildPlan", "BuildWarning", "BusyError", "Comparison", "Conventions", "CorruptError", "DefectError", "Error", "ExistsError",
    "FileError", "Hierarchy", "Hits", "InputError", "KilledError", "Leftover", "Mesh", "Nearest", "NetworkError", "Node", "NodeLike",
    "NotAHierarchyError", "ObjectRow", "ObjectTable", "ProgramError", "ProgramNotFoundError", "Progress", "ReplacedError", "Scalar",
    "StoppedBuildError", "TaskStatus", "Tile", "Tree", "UsageError", "Verification", "VerifyError", "__version__", "build", "clean", "compare",
    "draw", "export", "find_program", "inspect", "inspect_objects", "open", "pack", "page", "plan", "preview", "progressive", "reconstruct", "task",
    "task_status", "unpack", "verify", "view",
]  # fmt: skip
