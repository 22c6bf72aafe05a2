# SPDX-License-Identifier: MIT
"""The commands as functions, each with the program."""

from __future__ import annotations

import copy
import io
import json
import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import threading
import warnings
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest
from ply import read_ply

import meshhier
from meshhier.errors import program_error

VIEWER = Path(__file__).parents[2] / "viewer" / "dist" / "page"


@pytest.fixture(scope="module")
def hier(torus: str, built: Any) -> str:
    return str(built(torus, "commands.hier"))


@pytest.fixture(scope="module")
def tiny_hier(tiny: str, built: Any) -> str:
    return str(built(tiny, "tiny.hier"))


@pytest.fixture(scope="module")
def large(meshgen: str, tmp_path_factory: pytest.TempPathFactory) -> str:
    """Large enough to be caught at work."""
    path = str(tmp_path_factory.mktemp("large") / "large.ply")
    subprocess.run([meshgen, "surface", "--shape", "torus", "--triangles", "250000", "-o", path], check=True, stdout=subprocess.DEVNULL)
    return path


@pytest.fixture(scope="module")
def large_hier(large: str, built: Any) -> str:
    return str(built(large, "large.hier", partition__vertices=8192))


class Stop(Exception):
    pass


def as_ply(data: bytes, tmp_path: Path) -> tuple[Any, Any]:
    (tmp_path / "bytes.ply").write_bytes(data)
    return read_ply(str(tmp_path / "bytes.ply"))


def bumped(torus: str, to: Path) -> str:
    """The torus, one of whose vertices is 0.25 higher."""
    data = bytearray(Path(torus).read_bytes())
    head = data.index(b"end_header\n") + len(b"end_header\n")
    rows, _ = read_ply(torus)
    top = int(rows["z"].argmax())
    z = np.frombuffer(data, "<f4", 1, head + top * rows.dtype.itemsize + 8) + np.float32(0.25)
    data[head + top * rows.dtype.itemsize + 8 : head + top * rows.dtype.itemsize + 12] = z.tobytes()
    to.write_bytes(data)
    return str(to)


# export, preview, draw, page, progressive, reconstruct: files and bytes.


def test_export_makes_files_and_bytes(hier: str, tmp_path: Path) -> None:
    made = meshhier.export(hier, tmp_path / "a.ply", level=1)
    assert made == tmp_path / "a.ply"
    assert meshhier.export(hier, level=1) == made.read_bytes()
    with pytest.raises(meshhier.ExistsError, match="force=True"):
        meshhier.export(hier, made, level=0)
    assert meshhier.export(hier, str(made), level=0, force=True).stat().st_size < 60_000
    assert meshhier.export(hier, tmp_path / "a.glb", node=(2, 1)).read_bytes()[:4] == b"glTF"
    with meshhier.open(hier) as hierarchy:
        rows, triangles = as_ply(meshhier.export(hierarchy, cut=hierarchy.cut_nodes(level=1)), tmp_path)
        assert len(triangles) == len(hierarchy.cut(level=1).triangles) and len(rows) > 0
    assert meshhier.export(hier, gsd=0.1)[:4] == b"II*\0"
    assert meshhier.export(hier, gsd=0.1, dsm=tmp_path / "a.tif") == b"" and (tmp_path / "a.tif").exists()


def test_export_takes_pieces(hier: str, tmp_path: Path) -> None:
    rows, _ = as_ply(meshhier.export(hier, box=((-2, -2, -2), (0, 2, 2)), clip=True, memory_budget=1 << 30), tmp_path)
    assert rows["x"].max() <= 0
    ring = [[0, 0], [2, 0], [2, 2], [0, 2], [0, 0]]
    rows, _ = as_ply(meshhier.export(hier, level=2, polygon={"type": "Polygon", "coordinates": [ring]}, clip=True), tmp_path)
    assert rows["x"].min() > -1e-6 and rows["z"].max() < 1e-6, "y is up: a polygon is of x and -z"
    corners = np.array([(0, 0), (2, 0), (2, 2)])
    assert len(as_ply(meshhier.export(hier, level=2, polygon=corners), tmp_path)[0]) > 0
    with pytest.raises(meshhier.UsageError, match="^polygon: "):
        meshhier.export(hier, level=2, polygon=corners[:2])
    with pytest.raises(meshhier.UsageError, match="^cut: not a cut"):
        meshhier.export(hier, cut=[(1, 0)])
    with pytest.raises(meshhier.UsageError, match="level= excludes node="):
        meshhier.export(hier, level=1, node=(1, 0))
    with pytest.raises(meshhier.UsageError, match="level"):
        meshhier.export(hier, level=1.5)  # type: ignore[call-overload]
    with pytest.raises(meshhier.UsageError, match="error="):
        meshhier.export(hier, error=float("nan"))


def test_previews_and_drawings(hier: str, tmp_path: Path) -> None:
    data = meshhier.preview(hier, size=(64, 48), view=(-20, 10), background="white")
    image = pytest.importorskip("PIL.Image").open(io.BytesIO(data))
    assert image.size == (64, 48) and image.format == "PNG"
    assert meshhier.preview(hier, format="webp", size=(16, 16))[8:12] == b"WEBP"
    assert meshhier.preview(hier, tmp_path / "a.webp", size="16x16").read_bytes()[8:12] == b"WEBP"
    told: list[str] = []
    drawn = meshhier.draw(hier, tmp_path / "a.svg", cut_height=[-0.1, 0], grid=0.5, units="m", scale=20, account=told.append)
    assert b"<svg" in drawn.read_bytes() and "1:20" in told[0]
    assert b"SECTION" in meshhier.draw(hier, section=((-1, 0), (1, 0)), units="m", format="dxf")
    with pytest.raises(meshhier.UsageError, match="units="):
        meshhier.draw(hier)


@pytest.mark.skipif(not VIEWER.exists(), reason="the viewer is not built")
def test_pages(hier: str, tmp_path: Path) -> None:
    html = meshhier.page(hier, viewer=VIEWER)
    assert html.startswith(b"<!doctype html>")
    assert meshhier.page(hier, tmp_path / "a.html", viewer=VIEWER, size="2MB").stat().st_size <= 2_000_000
    shutil.copytree(hier, tmp_path / "models" / "a.hier")
    site = meshhier.page(tmp_path / "models", tmp_path / "site", viewer=VIEWER)
    assert (site / "index.html").exists()


def test_streams_come_back(tiny: str, tmp_path: Path) -> None:
    settings = {"simplify.method": "half_edge", "topology": "index", "partition.vertices": 70}
    stream = meshhier.progressive(meshhier.build(tiny, tmp_path / "a.hier", settings=settings), tmp_path / "a.prog", steps=2)
    told: list[str] = []
    whole = meshhier.reconstruct(stream, stats=True, account=told.append)
    assert len(as_ply(whole, tmp_path)[1]) == 2304 and "detail_02.bin" in told[0]
    assert len(as_ply(meshhier.reconstruct(stream, details=0), tmp_path)[1]) < 2304 / 2
    assert meshhier.reconstruct(stream, tmp_path / "b.ply", details=2).read_bytes() == whole


# Facts.


def test_compare_gives_figures(tiny: str, tiny_hier: str, tmp_path: Path) -> None:
    same = meshhier.compare(tiny_hier, tiny)
    assert same.distance.largest == 0 and same.within is None and same.from_.triangles == 2304
    moved = bumped(tiny, tmp_path / "moved.ply")
    far = meshhier.compare(moved, tiny_hier, tmp_path / "d.ply", tolerance=0.1)
    assert far.within is False and far.farthest == pytest.approx(0.25, rel=0.1) and far.distance.percentiles[50] == 0
    assert far.farthest <= far.no_farther_than and far.objects is None and far.to.name.endswith("tiny.hier")
    assert len(far.distance.histogram) == far.json["distance"]["histogram"]["areas"].__len__() > 10
    assert sum(far.distance.histogram) == pytest.approx(far.area, rel=1e-6)
    assert "distance" in str(read_ply(str(tmp_path / "d.ply"))[0].dtype)
    assert meshhier.compare(moved, tiny_hier, tolerance=1).within is True
    assert not meshhier.compare(moved, tiny_hier, unsigned=True, level=0).signed


def test_compare_moves_first(tiny: str, tiny_hier: str) -> None:
    up = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 10], [0, 0, 0, 1]]
    with pytest.warns(meshhier.BuildWarning, match="transform="):
        far = meshhier.compare(tiny_hier, tiny, transform=up, level=0)
    assert far.distance.mean > 8
    with pytest.warns(meshhier.BuildWarning):
        assert meshhier.compare(tiny_hier, tiny, transform=np.array(up), level=0).distance == far.distance


def test_compare_by_object(tmp_path: Path) -> None:
    squares = "g {0}\nf 1 2 3\ng {1}\nf 4 5 6\n"
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\n" + squares.format("left", "right"))
    (tmp_path / "b.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 2\nv 6 0 2\nv 5 1 2\n" + squares.format("left", "other"))
    one, other = (meshhier.build(tmp_path / f"{name}.obj", tmp_path / f"{name}.hier", objects="group") for name in "ab")
    found = meshhier.compare(one, other).objects
    assert found is not None and found.compared == 2 and found.from_.lone_names == ["right"]
    assert [row.name for row in found.farthest] == ["right", "left"] and found.farthest[0].farthest == pytest.approx(2)
    rows = meshhier.inspect_objects(one)
    assert [row.name for row in rows] == ["left", "right"] and rows[1].triangles == 1
    assert rows[1].box is not None and rows[1].box.tolist() == [[5, 0, 0], [6, 1, 0]]
    assert one.objects is not None and one.objects[1].area == rows[1].area
    assert [row.name for row in meshhier.inspect_objects(one, prefix="le")] == ["left"]
    assert [row.name for row in meshhier.inspect_objects(one, find="right", where="area < 9")] == ["right"]
    with pytest.raises(meshhier.UsageError, match="storeys"):
        meshhier.inspect_objects(one, where="storeys = 3")


def test_inspect_and_view(torus: str, hier: str, tmp_path: Path) -> None:
    assert meshhier.inspect(hier)["source"]["triangles"] == 20736
    assert "tiles" in json.dumps(meshhier.inspect(hier, level=1))
    hierarchy = meshhier.build(torus, tmp_path / "a.hier")
    assert meshhier.view(hierarchy) == {}
    assert meshhier.view(hierarchy, settings={"view.stretch": 2}) == meshhier.open(hierarchy.path).view != {}
    assert meshhier.view(hierarchy, clear=True) == {}
    with pytest.raises(meshhier.UsageError, match="no_such"):
        meshhier.view(hierarchy, settings={"view.no_such": 1})


def test_verify_measures(hier: str) -> None:
    assert any("seams: 3 random cuts from seed 7" in check for check in meshhier.verify(hier, cuts=3, seed=7).checks)
    levels = meshhier.verify(hier, error=True, level="all", samples=2000).levels
    assert [level.level for level in levels] == list(range(meshhier.open(hier).levels - 1))
    assert 0 < levels[-1].forward.mean < levels[0].forward.mean <= 2 * levels[0].error
    (cut,) = meshhier.verify(hier, error=True, cut=[(0, 0)], samples=2000).levels
    assert cut.level is None and cut.triangles == levels[0].triangles
    assert meshhier.verify(hier, box=((0, 0, 0), (1, 1, 1))).problems == []


def test_verify_tells_each_problem(tiny: str, tmp_path: Path) -> None:
    hierarchy = meshhier.build(tiny, tmp_path / "a.hier", settings={"partition.vertices": 70})
    for name in ("00/000000.glb", "01/000001.glb"):
        tile = tmp_path / "a.hier" / "tiles" / name
        tile.write_bytes(tile.read_bytes()[:-1] + b"x")
    with pytest.raises(meshhier.VerifyError) as found:
        meshhier.verify(hierarchy)
    assert len(found.value.problems) >= 2 and str(found.value) == "\n".join(found.value.problems)
    (tmp_path / "a.hier" / "tiles.bin").write_bytes(b"")
    with pytest.raises(meshhier.VerifyError, match="tiles.bin"):
        meshhier.verify(hierarchy.path)


# Builds.


def test_a_build_can_be_told_before(tiny: str, tmp_path: Path) -> None:
    plan = meshhier.build(tiny, tmp_path / "a.hier", dry_run=True, settings={"partition.vertices": 70})
    assert not (tmp_path / "a.hier").exists()
    hierarchy = meshhier.build(tiny, tmp_path / "a.hier", settings={"partition.vertices": 70})
    assert (plan.partitions, plan.levels, plan.tiles) == (hierarchy.tree.partitions, hierarchy.levels, len(list(hierarchy.tree.tiles())))
    assert plan.memory["least_budget_bytes"] < plan.memory["budget_bytes"] and plan.output.endswith("a.hier")
    with pytest.raises(meshhier.BudgetError):
        meshhier.build(tiny, tmp_path / "b.hier", dry_run=True, settings={"memory_budget": "1MiB"})


def test_a_build_finds_its_output(tiny: str, tmp_path: Path) -> None:
    mesh = tmp_path / "scan.ply"
    mesh.write_bytes(Path(tiny).read_bytes())
    assert Path(meshhier.build(mesh).path) == tmp_path / "scan.hier"
    (tmp_path / "job.json").write_text('{"input": "scan.ply", "output": "by config.hier"}')
    assert meshhier.build(tmp_path / "job.json").triangles == 2304
    assert (tmp_path / "by config.hier").exists()
    assert meshhier.build(None, settings={"input": str(mesh), "output": str(tmp_path / "c.3tz"), "storage.container": "3tz"}).triangles == 2304


def test_a_build_writes_notes_and_keeps_within(tiny: str, tmp_path: Path) -> None:
    told: list[str] = []
    meshhier.build(tiny, tmp_path / "a.hier", stats=tmp_path / "s.json", input_note=tmp_path / "n.json", verbose=True, account=told.append)
    assert json.loads((tmp_path / "s.json").read_text())["triangles"] == 2304
    assert "torus.ply" in (tmp_path / "n.json").read_text() and "simplify" in told[0]
    (tmp_path / "link.ply").symlink_to(tiny)
    with pytest.raises(meshhier.Error, match="link"):
        meshhier.build(tmp_path / "link.ply", tmp_path / "b.hier", no_links=True)
    with pytest.raises(meshhier.Error, match="link|outside"):
        meshhier.build(tmp_path / "link.ply", tmp_path / "b.hier", within=tmp_path)


def test_a_build_that_is_there_already_is_done(tiny: str, tmp_path: Path) -> None:
    first = meshhier.build(tiny, tmp_path / "a.hier", update=True)
    before = os.stat(tmp_path / "a.hier" / "hierarchy.json").st_ino
    assert meshhier.build(tiny, tmp_path / "a.hier", update=True).triangles == first.triangles
    assert os.stat(tmp_path / "a.hier" / "hierarchy.json").st_ino == before
    told: list[str] = []
    meshhier.build(tiny, tmp_path / "a.hier", update=True, settings={"partition.vertices": 70}, account=told.append)
    assert "partition.vertices" in told[0] and "made " in told[0]
    assert os.stat(tmp_path / "a.hier" / "hierarchy.json").st_ino != before
    shutil.copy(tiny, tmp_path / "scan.ply")
    assert [meshhier.build(tmp_path / "scan.ply", update=True).path for _ in range(2)] == [str(tmp_path / "scan.hier")] * 2


def test_a_build_is_told_before_or_done_if_due_but_not_both(tiny: str, tmp_path: Path) -> None:
    with pytest.raises(meshhier.UsageError, match="dry_run=True .* update=True"):
        meshhier.build(tiny, tmp_path / "a.hier", dry_run=True, update=True)


def test_an_export_of_nothing_says_what_to_do(hier: str) -> None:
    with pytest.raises(meshhier.UsageError, match=r"say what to export, by error= \(0: the original\), level=, node=, cut= or outline=True"):
        meshhier.export(hier)


def test_a_stopped_build_of_another_config(large: str, tmp_path: Path) -> None:
    def stop(progress: meshhier.Progress) -> None:
        if progress.stage == "simplify":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        meshhier.build(large, tmp_path / "a.hier", progress=stop, settings={"partition.vertices": 4096, "threads": 1})
    (left,) = meshhier.clean(tmp_path)
    assert not left.in_use and left.bytes > 0 and left.output.endswith("a.hier")
    with pytest.raises(meshhier.StoppedBuildError, match="restart=True"):
        meshhier.build(large, tmp_path / "a.hier")
    assert meshhier.build(large, tmp_path / "a.hier", restart=True).triangles > 250_000
    assert meshhier.clean(tmp_path, remove=True) == meshhier.clean(tmp_path) == []


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Processes, as they come."""
    processes: list[Any] = []

    class Watched(subprocess.Popen):  # type: ignore[type-arg]
        def __init__(self, *words: Any, **how: Any) -> None:
            super().__init__(*words, **how)
            processes.append(self)

    monkeypatch.setattr(subprocess, "Popen", Watched)
    return processes


def test_two_builds_of_one_output(large: str, tmp_path: Path, started: list[Any]) -> None:
    def meet(_: meshhier.Progress) -> None:
        started[0].send_signal(signal.SIGSTOP)
        try:
            with pytest.raises(meshhier.BusyError, match="at work"):
                meshhier.build(large, tmp_path / "a.hier")
        finally:
            started[0].send_signal(signal.SIGCONT)
        raise Stop

    with pytest.raises(Stop):
        meshhier.build(large, tmp_path / "a.hier", progress=meet, settings={"threads": 1})


def test_what_is_there_is_an_error_of_files_too(torus: str, hier: str) -> None:
    with pytest.raises(FileExistsError) as there:
        meshhier.build(torus, hier)
    assert isinstance(there.value, meshhier.ExistsError) and there.value.exit_code == 5 and str(there.value) == there.value.message
    assert "force=True" in there.value.message and "--force" not in there.value.message


@pytest.mark.parametrize(
    "code, message, kind",
    [
        (3, "x", meshhier.InputError), (5, "x", meshhier.ExistsError), (6, "x", meshhier.BudgetError), (7, "x", meshhier.VerifyError),
        (8, "x", meshhier.BusyError), (9, "x", meshhier.StoppedBuildError), (4, "x", meshhier.FileError), (70, "x", meshhier.DefectError),
        (130, "x", meshhier.KilledError), (137, "x", meshhier.KilledError), (10, "x", meshhier.ProgramError),
    ],
)  # fmt: skip
def test_exit_codes_are_types(code: int, message: str, kind: type[meshhier.ProgramError]) -> None:
    error = program_error(message, code)
    assert type(error) is kind and str(error) == message
    for again in (pickle.loads(pickle.dumps(error)), copy.copy(error)):
        assert type(again) is kind and str(again) == message and again.exit_code == code


def test_each_exit_code_of_the_manual_has_a_type() -> None:
    manual = subprocess.run([meshhier.find_program(), "manual"], check=True, capture_output=True, text=True).stdout
    told = {int(code): why for code, why in re.findall(r"^  (\d+) +(.+)", manual[manual.index("Exit codes:") :].partition(".fi")[0], re.MULTILINE)}
    assert {2, 3, 130} < set(told)
    for code, why in {0: "done", 1: "compare: a vertex is farther", 10: "build --each, serve --once: several"}.items():  # no function fails so
        assert told.pop(code).replace("\\", "").startswith(why)
    kinds = {code: type(program_error("x", code)) for code in told}
    assert meshhier.ProgramError not in kinds.values() and len(set(kinds.values())) == len(told), kinds


def test_a_file_that_cannot_be_written_is_an_error_of_files_too(hier: str, tmp_path: Path) -> None:
    with pytest.raises(OSError, match="nowhere") as failed:
        meshhier.export(hier, tmp_path / "nowhere" / "a.ply", level=0)
    assert type(failed.value) is meshhier.FileError and failed.value.exit_code == 4


def test_a_build_that_somebody_kills_can_go_on(large: str, tmp_path: Path, started: list[Any]) -> None:
    with pytest.raises(meshhier.KilledError) as killed:
        meshhier.build(large, tmp_path / "a.hier", progress=lambda _: started[0].terminate())
    assert killed.value.exit_code in (130, 143)


def test_a_build_in_tasks(tiny: str, tmp_path: Path) -> None:
    status = meshhier.plan(tiny, tmp_path / "a.hier", work=tmp_path / "work", tasks=2, settings={"partition.vertices": 300})
    assert status.next == "read" and not status.finished
    while status.next is not None:
        meshhier.task(tmp_path / "work", status.next)
        status = meshhier.task_status(tmp_path / "work")
        assert status.stages[0].done == status.stages[0].tasks or status.finished
    assert status.finished
    meshhier.verify(tmp_path / "a.hier", input=tiny)


# Stopping.


def test_a_callback_that_raises_stops_an_export_without_a_trace(large: str, large_hier: str, tmp_path: Path) -> None:
    def stop(progress: meshhier.Progress) -> None:
        raise Stop

    out = tmp_path / "out"
    out.mkdir()
    calls: list[Callable[[], object]] = [
        lambda: meshhier.export(large_hier, out / "a.ply", error=0, progress=stop),
        lambda: meshhier.preview(large_hier, out / "a.png", progress=stop),
        lambda: meshhier.verify(large_hier, progress=stop),
        lambda: meshhier.compare(large_hier, large, out / "b.ply", progress=stop),
    ]
    for call in calls:
        with pytest.raises(Stop):
            call()
        assert os.listdir(out) == []


def test_a_callback_that_raises_stops_a_build_at_once(large: str, tmp_path: Path) -> None:
    """An error other than KeyboardInterrupt, in the middle: the program does not go on to its end first."""

    def stop(progress: meshhier.Progress) -> None:
        if progress.stage in ("leaves", "simplify"):
            raise Stop

    with pytest.raises(Stop):
        meshhier.build(large, tmp_path / "a.hier", progress=stop, settings={"threads": 1})
    assert not (tmp_path / "a.hier").exists()
    (left,) = meshhier.clean(tmp_path)
    assert not left.in_use, "the program has ended"


CTRL_C = """
import signal, sys, meshhier
signal.signal(signal.SIGINT, signal.default_int_handler)  # who runs these tests in the background has it ignored
def tell(progress):
    print(progress.stage, flush=True)
try:
    meshhier.build(sys.argv[1], sys.argv[2], progress=tell, settings={"threads": 1})
except KeyboardInterrupt:
    (left,) = meshhier.clean(sys.argv[3])
    print("stopped", left.in_use, left.what, flush=True)
"""


@pytest.mark.parametrize("to_all", [True, False], ids=["terminal", "notebook"])
def test_ctrl_c_stops_a_build(to_all: bool, large: str, tmp_path: Path) -> None:
    """In a terminal the program gets the signal, too."""
    command = [sys.executable, "-c", CTRL_C, large, str(tmp_path / "a.hier"), str(tmp_path)]
    environment = {**os.environ, "PYTHONPATH": str(Path(meshhier.__file__).parents[1])}
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True, env=environment) as process:
        assert process.stdout is not None and process.stderr is not None
        for line in process.stdout:
            if line == "leaves\n":
                (os.killpg if to_all else os.kill)(process.pid, signal.SIGINT)
                break
        assert process.stdout.read().splitlines()[-1].startswith("stopped False"), process.stderr.read()
    assert meshhier.build(large, tmp_path / "a.hier").levels > 1
    assert meshhier.clean(tmp_path) == []


def test_results_that_fill_a_pipe_do_not_stop_it(hier: str) -> None:
    """An export writes its bytes while it tells its progress: both are read at once."""
    got: list[bytes] = []
    thread = threading.Thread(target=lambda: got.append(meshhier.export(hier, error=0, progress=lambda _: None)), daemon=True)
    thread.start()
    thread.join(300)
    assert got and len(got[0]) > 1 << 18


def test_warnings_point_at_the_caller_and_can_be_errors(torus: str, hier: str, tmp_path: Path) -> None:
    up = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 10], [0, 0, 0, 1]]
    told: list[str] = []
    with pytest.warns(meshhier.BuildWarning) as warned:
        meshhier.compare(hier, hier, transform=up, level=0, warning=told.append)
    assert [str(one.message) for one in warned] == told and {one.filename for one in warned} == {__file__}
    with warnings.catch_warnings():
        warnings.simplefilter("error", meshhier.BuildWarning)
        with pytest.raises(meshhier.BuildWarning):
            meshhier.compare(hier, hier, tmp_path / "a.ply", transform=up, level=0)
    assert os.listdir(tmp_path) == []


def test_names_that_are_no_utf8(tiny: str, tmp_path: Path) -> None:
    """They are as os.fsdecode() has them, in what is given and in what comes back."""
    mesh = os.path.join(tmp_path, os.fsdecode(b"caf\xe9.ply"))
    os.link(tiny, mesh)
    settings = {"preview": False}
    output = os.fsdecode(os.fsencode(mesh)[:-3] + b"hier")
    assert meshhier.build(mesh, settings=settings, dry_run=True).output == output
    for given in ({}, {"update": True}, {"force": True, "settings": {"input": mesh, "output": output, **settings}}):
        with meshhier.build(None if "force" in given else mesh, **{"settings": settings, **given}) as hierarchy:  # type: ignore[call-overload]
            assert hierarchy.path == output and os.path.isdir(output)
    assert meshhier.inspect(output) and meshhier.verify(output, input=mesh).checks
    assert meshhier.unpack(meshhier.pack(output, output + ".3tz"), output + ".hier").is_dir()
    stopped = tmp_path / os.fsdecode(b".caf\xe9.hier.meshhier-work")
    stopped.mkdir()
    (stopped / "journal").touch()
    assert {one.path for one in meshhier.clean(tmp_path)} <= {str(stopped)}
    with pytest.raises(meshhier.UsageError, match="in UTF-8, as JSON has them"):
        meshhier.build(None, tmp_path / "a.hier", settings={"input": [mesh, mesh]})
    with pytest.raises(meshhier.UsageError, match=r"os\.fsdecode\(\) makes one"):
        meshhier.build(os.fsencode(mesh))  # type: ignore[call-overload]
    with pytest.raises(meshhier.UsageError, match=r"os\.fsdecode\(\) makes one"):
        meshhier.build([mesh, os.fsencode(mesh)], tmp_path / "a.hier")  # type: ignore[list-item]


def test_odd_arguments(hier: str, tmp_path: Path) -> None:
    with pytest.raises(meshhier.UsageError, match="expected a path"):
        meshhier.inspect(3)  # type: ignore[arg-type]
    for place in (None, 3, b"a.hier"):
        with pytest.raises(meshhier.UsageError, match="expected a path, found"):
            meshhier.open(place)  # type: ignore[arg-type]
    for mesh in (b"a.ply", ["a.ply", b"a.ply"]):
        with pytest.raises(meshhier.UsageError, match=r"found b'a.ply': os\.fsdecode\(\) makes one"):
            meshhier.build(mesh, tmp_path / "a.hier")  # type: ignore[call-overload]
    with pytest.raises(meshhier.UsageError, match="in UTF-8, as JSON has them"):
        meshhier.build(None, tmp_path / "a.hier", settings={"input": [os.fsdecode(b"a\xff.ply")]})
    for name in ("a\0.hier", "\ud800.hier", "https://user:s3cret@h/a\0.3tz"):
        with pytest.raises(meshhier.UsageError, match="expected a path, found") as refusal:
            meshhier.compare(name, hier)
        assert "s3cret" not in str(refusal.value)
    for make in (meshhier.build, meshhier.export, meshhier.pack, meshhier.progressive):
        with pytest.raises(meshhier.UsageError, match="on this machine to write to, found 'h/a.3tz'"):
            make(hier, "https://user:s3cret@h/a.3tz?sig=s3cret")
    with pytest.raises(meshhier.UsageError, match="size: expected 2 numbers, found 64"):
        meshhier.preview(hier, size=64)  # type: ignore[call-overload]
    with pytest.raises(TypeError, match="lvel"):
        meshhier.export(hier, lvel=3)  # type: ignore[call-overload]
    with pytest.raises(meshhier.Error):
        meshhier.inspect("a\0b")
    with pytest.raises(meshhier.ProgramError, match="no such|No such|there is no"):
        meshhier.inspect(tmp_path / "none.hier")
    with pytest.raises(meshhier.UsageError):
        meshhier.build([], tmp_path / "a.hier")
