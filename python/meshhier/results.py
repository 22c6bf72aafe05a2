# SPDX-License-Identifier: MIT
"""What the program tells with --json, as types. `json` has all of it, with what later programs add."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any, Mapping, Optional, TypeVar

from .errors import ProgramError

_T = TypeVar("_T")


def record(kind: type[_T], values: Any, /, **others: Any) -> _T:
    """A dataclass from the keys of its fields' names. Raises ProgramError if one that has no default is not there."""
    names = [one.name for one in fields(kind) if one.init and one.name not in others]
    try:
        return kind(**{name: values[name] for name in names if name in values}, **others)
    except TypeError as error:
        raise ProgramError(f"the program told something else than a {kind.__name__}: it is of another version ({error})", 0) from error


def _parts(values: Mapping[str, float]) -> dict[float, float]:
    return {float(part): value for part, value in values.items()}


@dataclass(frozen=True)
class ComparedSurface:
    """One side of a comparison: its name, what was taken of it, and how far that is from its original at the most."""

    name: str
    tiles: int
    vertices: int
    triangles: int
    error_bound: float


@dataclass(frozen=True)
class Distances:
    """Distances of FROM to TO by area, negative inside of TO; all are 0 of nothing.

    Attributes:
        mean, rms, least, largest: with signs.
        mean_size: without.
        percentiles, size_percentiles: 50 -> the median, with signs and without.
        histogram_range, histogram: the areas of equal intervals; the first and the last have what is beyond, too.
    """

    mean: float = 0
    rms: float = 0
    least: float = 0
    largest: float = 0
    mean_size: float = 0
    percentiles: dict[float, float] = field(default_factory=dict)
    size_percentiles: dict[float, float] = field(default_factory=dict)
    histogram_range: tuple[float, float] = (0, 0)
    histogram: list[float] = field(default_factory=list)


@dataclass(frozen=True)
class ComparedObject:
    """How far an object of FROM is from TO. `other_area` and `moved`, the way between the middles of the boxes, are None if TO has no
    object of that name."""

    object: int
    name: str
    area: float
    mean: float
    mean_size: float
    rms: float
    least: float
    largest: float
    farthest: float
    other_area: Optional[float] = None
    moved: Optional[float] = None


@dataclass(frozen=True)
class LoneObjects:
    """How many objects a side has, how many of these the other has not, and the first of their names."""

    objects: int
    lone: int
    lone_names: list[str]


@dataclass(frozen=True)
class ComparedObjects:
    """Attributes: how many were compared; the farthest first; of each side those that it has alone, `to` is None without objects."""

    compared: int
    farthest: list[ComparedObject]
    from_: LoneObjects
    to: Optional[LoneObjects]


@dataclass(frozen=True)
class Comparison:
    """What compare() measures, in the coordinates of the inputs.

    Attributes:
        from_, to: the two surfaces.
        tiles_read: of TO.
        signed: distances have signs.
        area: of FROM, or the number of its vertices if it has no triangles.
        distance: of FROM to TO, by area.
        lone_vertices: of FROM, that no triangle has: they are left out.
        unknown_sides: vertices nearest to a border of TO, which count as outside.
        farthest: the farthest vertex.
        no_farther_than: a bound for all points of the original surface of FROM.
        within: no vertex is farther than the tolerance; None without one.
        tolerance, area_within: None without a tolerance.
        objects: None if FROM has none.
        warnings: the same as are told as warnings.
    """

    from_: ComparedSurface
    to: ComparedSurface
    tiles_read: int
    signed: bool
    area: float
    distance: Distances
    lone_vertices: int
    unknown_sides: int
    farthest: float
    no_farther_than: float
    objects: Optional[ComparedObjects]
    json: Mapping[str, Any] = field(repr=False)
    within: Optional[bool] = None
    tolerance: Optional[float] = None
    area_within: Optional[float] = None
    warnings: list[str] = field(default_factory=list)


def _distances(told: Mapping[str, Any]) -> Distances:
    histogram = told.get("histogram") or {"from": 0, "to": 0, "areas": []}
    return record(
        Distances,
        told,
        percentiles=_parts(told.get("percentiles", {})),
        size_percentiles=_parts(told.get("size_percentiles", {})),
        histogram_range=(histogram["from"], histogram["to"]),
        histogram=histogram["areas"],
    )


def _objects(told: Optional[Mapping[str, Any]]) -> Optional[ComparedObjects]:
    if told is None:
        return None
    return ComparedObjects(
        compared=told["compared"],
        farthest=[record(ComparedObject, one) for one in told["farthest"]],
        from_=record(LoneObjects, told["from"]),
        to=record(LoneObjects, told["to"]) if told.get("to") else None,
    )


def comparison(told: Mapping[str, Any]) -> Comparison:
    return record(
        Comparison,
        told,
        from_=record(ComparedSurface, told["from"]),
        to=record(ComparedSurface, told["to"]),
        distance=_distances(told["distance"]),
        objects=_objects(told.get("objects")),
        json=told,
    )


@dataclass(frozen=True)
class Spread:
    """Distances of samples in one direction, input units."""

    mean: float
    rms: float
    max: float


@dataclass(frozen=True)
class MeasuredLevel:
    """How far a level, or a cut, is from the original.

    Attributes:
        level: None of a cut.
        tiles, triangles, samples: how many.
        diagonal: of the bounding box, input units.
        forward, backward: from what is shown to the original, and from the original to what is shown.
        error, bound: the largest of its tiles, which are held against these.
        problems: empty if all is as the tiles say.
    """

    level: Optional[int]
    name: str
    tiles: int
    triangles: int
    samples: int
    diagonal: float
    forward: Spread
    backward: Spread
    error: float
    bound: float
    problems: list[str]


@dataclass(frozen=True)
class Verification:
    """What verify() has found in order.

    Attributes:
        checks: a line for each kind of check, with numbers.
        levels: with `error=True`: what was measured.
        problems: empty, as verify() raises them.
    """

    checks: list[str]
    levels: list[MeasuredLevel]
    json: Mapping[str, Any] = field(repr=False)
    problems: list[str]


def verification(told: Mapping[str, Any]) -> Verification:
    measured = told.get("levels", [told] if "forward" in told else [])
    levels = [record(MeasuredLevel, one, forward=record(Spread, one["forward"]), backward=record(Spread, one["backward"])) for one in measured]
    problems = [f"{level.name}: {problem}" for level in levels for problem in level.problems] if levels else list(told.get("problems", []))
    return Verification(list(told.get("checks", [])), levels, told, problems)


@dataclass(frozen=True)
class BuildPlan:
    """What a build would make and take. Bytes and seconds; `memory` is by docs/command_line.md."""

    output: str
    input_bytes: int
    vertices: int
    places: int
    faces: int
    partitions: int
    levels: int
    tiles: int
    predicted_output_bytes: int
    predicted_temporary_bytes: int
    predicted_room_bytes: int
    free_bytes: int
    memory: Mapping[str, int]
    threads: int
    estimated_cpu_seconds: float
    estimated_wall_seconds: float
    json: Mapping[str, Any] = field(repr=False)


@dataclass(frozen=True)
class Leftover:
    """What a stopped command has left: where, of which output, in words, its size, and whether it is at work."""

    path: str
    output: str
    what: str
    bytes: int
    in_use: bool


@dataclass(frozen=True)
class TaskStage:
    """A stage of a build in tasks, and how far it is. Times are those of its tasks together, `longest_seconds` that of one."""

    name: str
    tasks: int
    done: int
    damaged: list[int]
    wall_seconds: float
    longest_seconds: float
    cpu_seconds: float


@dataclass(frozen=True)
class TaskStatus:
    """How far a build in tasks is. `next`: the first stage that is not complete; None if all is done."""

    output: str
    finished: bool
    next: Optional[str]
    cpu_seconds_left: Optional[float]
    attempts: int
    stages: list[TaskStage]
    json: Mapping[str, Any] = field(repr=False)
