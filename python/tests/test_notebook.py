# SPDX-License-Identifier: MIT
"""The notebook runs from its first cell to its last."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

NOTEBOOK = Path(__file__).parent.parent / "examples" / "cut.ipynb"


def test_the_notebook_runs(meshgen: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    monkeypatch.setenv("MESHGEN", meshgen)
    names: dict[str, object] = {}
    for cell in json.loads(NOTEBOOK.read_text())["cells"]:
        if cell["cell_type"] == "code":
            exec(compile("".join(cell["source"]), str(NOTEBOOK), "exec"), names)
    assert "of levels [" in capsys.readouterr().out
    figure = names["figure"]
    figure.canvas.draw()  # type: ignore[attr-defined]
    import numpy as np

    picture = np.asarray(figure.canvas.buffer_rgba())  # type: ignore[attr-defined]
    assert (picture[..., :3] < 250).any(axis=2).mean() > 0.05, "nothing is drawn"
    assert "Mesh(" in repr(names["part"])
