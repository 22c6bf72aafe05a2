# SPDX-License-Identifier: MIT
"""Which modules of the package need which."""

from __future__ import annotations

import ast
from graphlib import TopologicalSorter
from pathlib import Path
from typing import Iterator

import meshhier


def _imports(node: ast.AST) -> Iterator[str]:
    """Modules of the package that are imported when it runs, also within functions."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.ImportFrom) and child.level == 1:
            yield from [child.module] if child.module else [alias.name for alias in child.names]
        elif not (isinstance(child, ast.If) and ast.unparse(child.test) == "TYPE_CHECKING"):
            yield from _imports(child)


def test_no_module_needs_one_that_needs_it() -> None:
    folder = Path(meshhier.__file__).parent
    needed = {file.stem: set(_imports(ast.parse(file.read_text("utf-8")))) for file in folder.glob("*.py")}
    assert "storage" in needed["remote"] and "hierarchy" in needed["__init__"]
    assert len(list(TopologicalSorter(needed).static_order())) == len(needed)
