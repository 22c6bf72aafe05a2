# SPDX-License-Identifier: MIT
"""The viewer's scripts, which browsers run."""

from __future__ import annotations

import base64
import os
import shutil
from pathlib import Path
from typing import Iterator

from .errors import ProgramNotFoundError


def _folders() -> Iterator[Path]:
    package = Path(__file__).resolve().parent
    yield package / "viewer"  # of a package that was built beside the viewer
    yield package / "program" / "share" / "meshhier" / "viewer"  # of a wheel with the program
    yield package.parents[1] / "viewer" / "dist" / "page"  # of the source tree
    program = os.environ.get("MESHHIER") or shutil.which("meshhier")
    if program is not None:
        yield Path(program).resolve().parents[1] / "share" / "meshhier" / "viewer"


def viewer_file(name: str) -> str:
    """A file of the viewer in base64. Raises ProgramNotFoundError if there is none."""
    for folder in _folders():
        if (folder / name).is_file():
            return base64.b64encode((folder / name).read_bytes()).decode()
    raise ProgramNotFoundError(f"the viewer's {name} is neither in this package nor beside the program meshhier: install a wheel that has it, or the program")
