# SPDX-License-Identifier: MIT
"""The commands of the program `meshhier` as functions. Keywords are its options (docs/command_line.md): `options.py` has the table.

What all of them have in common:

    progress: is called twice a second at most. What it raises stops the program, as Ctrl-C does.
    warning: is called with each warning, which is a BuildWarning of Python's `warnings`, too. A filter that makes it an error stops
        the program.
    account: is called once, with what the program tells of its result, a text for people.
    memory_budget, limit_rate: bytes, or "2GiB".
    headers: of requests, where a hierarchy is an address: {"Authorization": "Bearer ..."}; of two for the first one's host, or a list whose
        lines may name the other: ["https://b.org X-Key: 1"]. An open hierarchy brings its own.
    force: replaces what is there; without it that is an ExistsError.
    box, polygon, crs, object, where: a piece of the model. `box` is two corners, `polygon` a GeoJSON file, what is in one or corners (x, y), `object`
        one name or several, `where` a condition as SQL has them.

Raise InputError, ExistsError, BusyError, BudgetError, UsageError, other ProgramErrors, and ProgramNotFoundError.
"""

from __future__ import annotations

import json
import os
import pathlib
import sys
from typing import Any, Literal, Mapping, NoReturn, Optional, Sequence, Union, overload

import numpy as np
from numpy.typing import NDArray

from .asked import Names, Path
from .boxes import Box
from .calls import MadeFile, make, maker, output_words, run, several
from .errors import UsageError, VerifyError
from .hierarchy import Hierarchy, Place
from .http_client import Headers
from .objects import ObjectRow
from .polygons import Polygon
from .process import ProgressCallback, TextCallback, find_program
from .results import BuildPlan, Comparison, Leftover, TaskStage, TaskStatus, Verification, comparison, record, verification
from .tree import NodeLike

Number = Union[float, str]
Size = Union[int, str]
Nodes = Union[Path, Sequence[NodeLike]]
Vector = Union[Sequence[float], NDArray[Any]]
Rows = Union[Sequence[Vector], NDArray[Any]]


# Making hierarchies.


@overload
def build(
    mesh: Union[Path, Sequence[Path], None], output: Optional[Path] = None, *, settings: Optional[Mapping[str, Any]] = None, force: bool = False,
    restart: bool = False, update: bool = False, drape: Optional[Path] = None, objects: Optional[str] = None, object_table: Optional[Path] = None,
    within: Optional[Path] = None, no_links: bool = False, dry_run: Literal[False] = False, stats: Optional[Path] = None, input_note: Optional[Path] = None,
    verbose: bool = False, progress: Optional[ProgressCallback] = None, warning: Optional[TextCallback] = None, account: Optional[TextCallback] = None,
) -> Hierarchy: ...  # fmt: skip
@overload
def build(
    mesh: Union[Path, Sequence[Path], None], output: Optional[Path] = None, *, settings: Optional[Mapping[str, Any]] = None, force: bool = False,
    restart: bool = False, update: bool = False, drape: Optional[Path] = None, objects: Optional[str] = None, object_table: Optional[Path] = None,
    within: Optional[Path] = None, no_links: bool = False, dry_run: Literal[True], stats: Optional[Path] = None, input_note: Optional[Path] = None,
    verbose: bool = False, progress: Optional[ProgressCallback] = None, warning: Optional[TextCallback] = None, account: Optional[TextCallback] = None,
) -> BuildPlan: ...  # fmt: skip
def build(
    mesh: Union[Path, Sequence[Path], None],
    output: Optional[Path] = None,
    *,
    settings: Optional[Mapping[str, Any]] = None,
    force: bool = False,
    restart: bool = False,
    update: bool = False,
    drape: Optional[Path] = None,
    objects: Optional[str] = None,
    object_table: Optional[Path] = None,
    within: Optional[Path] = None,
    no_links: bool = False,
    dry_run: bool = False,
    stats: Optional[Path] = None,
    input_note: Optional[Path] = None,
    verbose: bool = False,
    progress: Optional[ProgressCallback] = None,
    warning: Optional[TextCallback] = None,
    account: Optional[TextCallback] = None,
) -> Union[Hierarchy, BuildPlan]:
    """Makes a hierarchy of a mesh, or of several together, and opens it. A build that was stopped goes on.

    Args:
        mesh: a file of any format that `meshhier build --help-formats` lists, or a list of such; or a config. None: `settings` say it.
        output: "david.hier", or "david.3tz" for one file. None: beside the mesh, or where the config says.
        settings: keys of the config, dotted: {"memory_budget": "2GiB", "storage.compression": "meshopt_zlib"}.
        restart: throws away what an earlier build of another config, which was stopped, has left; without it that is a
            StoppedBuildError.
        update: does nothing if the hierarchy is there already, of this input, config and version; else it is built anew.
        drape: the orthophoto that heights of a raster show.
        objects, object_table: what objects are made from ("group", "label:NAME", ...), and a table of their properties.
        within, no_links: read no input outside of a folder, or behind a link.
        dry_run: builds nothing, but returns a BuildPlan: what the build would make and take. What it would refuse is refused.
        stats, input_note: files for the account of the build, and for what was read, as JSON.
        verbose: `account` gets more.

    Raises also StoppedBuildError.
    """
    if dry_run and update:
        raise UsageError("dry_run=True tells what a build would take, and update=True whether one is due: give one of them")
    given = locals()
    result = run("build", several(mesh), given, *output_words(output), *(["--json"] if dry_run else []), prints_data=dry_run)
    if dry_run:
        told = result.json()
        return record(BuildPlan, told, json=told)
    return Hierarchy(result.summary if output is None else output)


def plan(
    mesh: Union[Path, Sequence[Path], None],
    output: Optional[Path] = None,
    *,
    work: Path,
    tasks: int,
    settings: Optional[Mapping[str, Any]] = None,
    force: bool = False,
    account: Optional[TextCallback] = None,
) -> TaskStatus:
    """Cuts a build into tasks for many machines (docs/cluster.md): stages of up to `tasks` tasks, planned in the folder `work`."""
    given = locals()
    run("plan", several(mesh), given, *output_words(output), tells_progress=False)
    return task_status(work)


def task(
    work: Path,
    stage: str,
    *,
    index: Optional[int] = None,
    of: Optional[int] = None,
    scratch: Optional[Path] = None,
    threads: Optional[int] = None,
    memory_budget: Optional[Size] = None,
    progress: Optional[ProgressCallback] = None,
    warning: Optional[TextCallback] = None,
    account: Optional[TextCallback] = None,
) -> None:
    """Does tasks of a stage of a planned build: task `index`, with `of` also each of-th one after it. Without both those that the
    scheduler's variables name, or all. Tasks that are done end at once."""
    run("task", [work, stage], locals())


def task_status(work: Path) -> TaskStatus:
    """How far a planned build is: its stages, with their tasks, and the next one."""
    told = run("task", [work], {"status": True}, "--json", prints_data=True).json()
    return record(TaskStatus, told, stages=[record(TaskStage, one) for one in told["stages"]], json=told)


def clean(path: Path = ".", *, remove: bool = False) -> list[Leftover]:
    """Lists what stopped builds and killed commands left in a folder, or beside a hierarchy; with `remove` it is gone then. Builds at
    work are left alone."""
    told = run("clean", [path], {"remove": remove}, "--json", tells_progress=False, prints_data=True).json()
    return [record(Leftover, one) for one in told["leftovers"]]


# Looking at hierarchies.


def inspect(
    hierarchy: Place,
    *,
    level: Optional[int] = None,
    node: Optional[NodeLike] = None,
    headers: Optional[Headers] = None,
    limit_rate: Optional[Size] = None,
) -> dict[str, Any]:
    """What a hierarchy holds, as docs/command_line.md has it: source, parameters, totals, levels; with `level` or `node` its tiles."""
    return dict(run("inspect", [hierarchy], locals(), "--json", tells_progress=False, prints_data=True).json())


def inspect_objects(
    hierarchy: Place,
    *,
    prefix: Optional[str] = None,
    find: Optional[str] = None,
    where: Optional[str] = None,
    headers: Optional[Headers] = None,
    limit_rate: Optional[Size] = None,
) -> list[ObjectRow]:
    """Objects, ascending by name: all, those whose names begin with `prefix` or have the words of `find`, and that meet the condition
    `where`, as SQL has them."""
    given = {**locals(), "prefix": prefix or (True if find is None else None)}
    told = run("inspect", [hierarchy], given, "--json", tells_progress=False, prints_data=True)
    return [_object_row(json.loads(line)) for line in told.output.splitlines()]


def _object_row(told: Mapping[str, Any]) -> ObjectRow:
    box = told.get("box")
    corners = None if not box else np.array([box["min"], box["max"]] if isinstance(box, dict) else box, np.float64).reshape(2, 3)
    return record(ObjectRow, told, values=told["properties"], box=corners)


def verify(
    hierarchy: Place,
    *,
    input: Union[Path, Sequence[Path], None] = None,
    cuts: Optional[int] = None,
    seed: Optional[int] = None,
    error: bool = False,
    samples: Optional[int] = None,
    level: Optional[Union[int, Literal["all"]]] = None,
    cut: Optional[Nodes] = None,
    box: Optional[Box] = None,
    polygon: Optional[Polygon] = None,
    crs: Optional[str] = None,
    object: Optional[Names] = None,
    where: Optional[str] = None,
    memory_budget: Optional[Size] = None,
    headers: Optional[Headers] = None,
    limit_rate: Optional[Size] = None,
    progress: Optional[ProgressCallback] = None,
    warning: Optional[TextCallback] = None,
    account: Optional[TextCallback] = None,
) -> Verification:
    """Checks everything: checksums, structure, seams of random cuts.

    Args:
        input: also checks that the partitions are that mesh, or these meshes, bit for bit.
        cuts, seed: how many random cuts, and which.
        error: instead of all that measures how far a level (0), all ("all") or a cut is from the original, by so many samples in each
            direction, and holds it against what the tiles say.

    Raises VerifyError with all problems.
    """
    result = run("verify", [hierarchy], locals(), "--json", prints_data=True, expected=(0, 7))
    found = verification(result.json() if result.output else {"problems": [result.failure]})
    if result.code == 7:
        raise VerifyError("\n".join(found.problems), 7, tuple(found.problems))
    return found


def compare(
    from_: Place,
    to: Place,
    output: Optional[Path] = None,
    *,
    level: Optional[int] = None,
    error: Optional[float] = None,
    tolerance: Optional[Number] = None,
    unsigned: bool = False,
    bound: bool = False,
    transform: Union[Path, Rows, None] = None,
    objects: Optional[int] = None,
    force: bool = False,
    memory_budget: Optional[Size] = None,
    headers: Optional[Headers] = None,
    limit_rate: Optional[Size] = None,
    progress: Optional[ProgressCallback] = None,
    warning: Optional[TextCallback] = None,
    account: Optional[TextCallback] = None,
) -> Comparison:
    """Measures how far each vertex of FROM, a hierarchy or a mesh, is from the surface of TO; negative inside of it.

    Args:
        output: FROM with its distances: a PLY, or a hierarchy if it ends in .hier or .3tz.
        level, error: of both this level, or the coarsest tiles that are no farther than this from their originals.
        tolerance: a length, or with a unit "0.5mm": the result's `within` says whether a vertex is farther.
        unsigned: does not look for sides.
        bound: bounds tightly what lies between vertices; takes up to three times as long.
        transform: moves FROM first: a 4 x 4 matrix, rows first, or a file with one.
        objects: how many objects of FROM are listed, the farthest first; 20 if not given.
    """
    return comparison(run("compare", [from_, to], locals(), "--json", *output_words(output), prints_data=True, expected=(0, 1)).json())


def view(
    hierarchy: Place,
    *,
    settings: Optional[Mapping[str, Any]] = None,
    link: Optional[str] = None,
    clear: bool = False,
    headers: Optional[Headers] = None,
    limit_rate: Optional[Size] = None,
) -> dict[str, Any]:
    """How a hierarchy is shown first, {} if nobody said it; the keywords change it: `clear` forgets what is there, `link` takes what a
    link of the page says, `settings` change keys: {"view.attribute": "quality"}."""
    return dict(run("view", [hierarchy], locals(), tells_progress=False, prints_data=True).json())


# Making files of hierarchies. Without an output they return its bytes, else its path.


@maker
def export(
    hierarchy: Place,
    output: Optional[Path] = None,
    *,
    level: Optional[int] = None,
    node: Optional[NodeLike] = None,
    cut: Optional[Nodes] = None,
    error: Optional[float] = None,
    outline: bool = False,
    box: Optional[Box] = None,
    polygon: Optional[Polygon] = None,
    crs: Optional[str] = None,
    object: Optional[Names] = None,
    where: Optional[str] = None,
    clip: bool = False,
    gsd: Optional[float] = None,
    align: Optional[Union[str, Vector]] = None,
    dsm: Optional[Path] = None,
    force: bool = False,
    memory_budget: Optional[Size] = None,
    headers: Optional[Headers] = None,
    limit_rate: Optional[Size] = None,
    progress: Optional[ProgressCallback] = None,
    warning: Optional[TextCallback] = None,
    account: Optional[TextCallback] = None,
) -> MadeFile:
    """Writes a part of a hierarchy: a level, a node, a cut, the coarsest tiles within `error`, or the outline.

    Args:
        output: by its ending a GLB, OBJ, GeoTIFF (from above), hierarchy (.hier, .3tz) or else a PLY. None: bytes of a PLY, or of a
            GeoTIFF with `gsd`; with `dsm` alone that file is made, and there are no bytes.
        cut: a list of nodes, or a file with one.
        clip: cuts triangles where box or polygon end.
        gsd, align, dsm: of GeoTIFFs: a pixel's side, a place where pixels have a corner, and a file for the heights.
    """
    given = locals()
    if output is None and dsm is not None:
        run("export", [hierarchy], given)
        return b""
    return make("export", hierarchy, output, given)


@maker
def preview(
    hierarchy: Place,
    output: Optional[Path] = None,
    *,
    level: Optional[int] = None,
    cut: Optional[Nodes] = None,
    error: Optional[float] = None,
    view: Optional[Union[str, Vector]] = None,
    link: Optional[str] = None,
    up: Optional[str] = None,
    size: Optional[Union[str, Sequence[int]]] = None,
    background: Optional[str] = None,
    format: Optional[str] = None,
    attribute: Optional[str] = None,
    colour_by: Optional[str] = None,
    ramp: Optional[str] = None,
    range: Optional[Union[str, Vector]] = None,
    box: Optional[Box] = None,
    polygon: Optional[Polygon] = None,
    crs: Optional[str] = None,
    object: Optional[Names] = None,
    where: Optional[str] = None,
    force: bool = False,
    memory_budget: Optional[Size] = None,
    headers: Optional[Headers] = None,
    limit_rate: Optional[Size] = None,
    progress: Optional[ProgressCallback] = None,
    warning: Optional[TextCallback] = None,
    account: Optional[TextCallback] = None,
) -> MadeFile:
    """Draws a picture, PNG or WebP.

    Args:
        level, cut, error: which tiles; without all three such as are a quarter of a pixel off.
        view: "front", "top", "iso", ... or (azimuth, elevation) in degrees.
        link: what the page shows from that link.
        size: (width, height) in pixels.
        attribute, colour_by: what the colours show: an attribute, or a property of objects; `ramp` and `range` are how.
        format: "png" (without an output also if it is not given) or "webp".
    """
    given = {**locals(), "format": format or ("png" if output is None else None)}
    return make("preview", hierarchy, output, given)


@maker
def draw(
    hierarchy: Place,
    output: Optional[Path] = None,
    *,
    plan: bool = False,
    elevation: Optional[str] = None,
    section: Optional[Rows] = None,
    plane: Optional[Union[str, Vector]] = None,
    cut_height: Optional[Union[Number, Vector]] = None,
    contours: Optional[float] = None,
    scale: Optional[Number] = None,
    units: Optional[str] = None,
    dpi: Optional[float] = None,
    grid: Union[bool, float] = False,
    no_scale_bar: bool = False,
    transparent: bool = False,
    world_file: bool = False,
    flat: bool = False,
    format: Optional[str] = None,
    level: Optional[int] = None,
    error: Optional[float] = None,
    box: Optional[Box] = None,
    polygon: Optional[Polygon] = None,
    crs: Optional[str] = None,
    object: Optional[Names] = None,
    where: Optional[str] = None,
    force: bool = False,
    memory_budget: Optional[Size] = None,
    headers: Optional[Headers] = None,
    limit_rate: Optional[Size] = None,
    progress: Optional[ProgressCallback] = None,
    warning: Optional[TextCallback] = None,
    account: Optional[TextCallback] = None,
) -> MadeFile:
    """Draws at a scale, by the output's ending, or `format`: PNG, SVG, DXF, GeoJSON; without both PNG.

    Args:
        plan, elevation, section, plane: what is looked at: from above (so it is if none is given), "front", "right", "back" or "left",
            an upright section through two places ((x, y), (x, y)), or a section by a plane (nx, ny, nz, d).
        cut_height, contours: cuts a plan at a height, or at several; contour lines at multiples.
        scale: 50, or "1:50".
        grid: True, or how far its lines are apart.
        level, error: lines or a picture of these tiles, not of the original.
    """
    given = {**locals(), "format": format or ("png" if output is None else None)}
    return make("draw", hierarchy, output, given)


@maker
def page(
    hierarchy: Place,
    output: Optional[Path] = None,
    *,
    size: Optional[Size] = None,
    link: Optional[str] = None,
    fetch_pictures: bool = False,
    viewer: Optional[Path] = None,
    force: bool = False,
    headers: Optional[Headers] = None,
    limit_rate: Optional[Size] = None,
    progress: Optional[ProgressCallback] = None,
    warning: Optional[TextCallback] = None,
    account: Optional[TextCallback] = None,
) -> MadeFile:
    """Makes one HTML file of a hierarchy, which opens by a double click, or of a folder a site (then there is an output).

    Args:
        size: of the HTML file: at most so many bytes, 15MB if not given.
        link: where all of the hierarchy is on the web: the page goes on from there.
        fetch_pictures: embeds the pictures of a story that lie on other hosts, too.
        viewer: the folder of the page, if not as installed.
    """
    return make("page", hierarchy, output, locals())


def progressive(
    hierarchy: Place,
    output: Path,
    *,
    node: Optional[NodeLike] = None,
    steps: Optional[int] = None,
    force: bool = False,
    memory_budget: Optional[Size] = None,
    progress: Optional[ProgressCallback] = None,
    warning: Optional[TextCallback] = None,
    account: Optional[TextCallback] = None,
) -> pathlib.Path:
    """Makes a folder with a base and its details for weak clients: of all, or of one sector; one detail a level, or `steps`."""
    run("progressive", [hierarchy], locals(), *output_words(output))
    return pathlib.Path(output)


@maker
def reconstruct(
    hierarchy: Place,
    output: Optional[Path] = None,
    *,
    details: Optional[int] = None,
    stats: bool = False,
    force: bool = False,
    memory_budget: Optional[Size] = None,
    progress: Optional[ProgressCallback] = None,
    warning: Optional[TextCallback] = None,
    account: Optional[TextCallback] = None,
) -> MadeFile:
    """Rebuilds a PLY from what progressive() made, by so many details in their order, or all. With `stats` `account` gets what each
    file took."""
    return make("reconstruct", hierarchy, output, locals())


def main() -> NoReturn:
    """The command `meshhier` of a wheel that carries the program."""
    program = find_program()
    os.execv(program, [program, *sys.argv[1:]])
