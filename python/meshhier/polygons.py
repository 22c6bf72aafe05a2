# SPDX-License-Identifier: MIT
"""Polygons seen from above, and which triangles lie in them on whatever height. What is decided is exact: where rounding might
tell, fractions do."""

from __future__ import annotations

import json
import os
from collections import Counter
from fractions import Fraction
from typing import Any, Iterator, Mapping, Protocol, Sequence, Union

import numpy as np
from numpy.typing import NDArray

from .errors import UsageError


class Shape(Protocol):
    """A geometry of another library."""

    @property
    def __geo_interface__(self) -> Mapping[str, Any]: ...


Ring = NDArray[np.float64]
Polygon = Union[str, "os.PathLike[str]", Mapping[str, Any], Shape, Sequence[Sequence[float]], NDArray[Any]]
"""A GeoJSON file, an object as GeoJSON has them (or with `__geo_interface__`, as shapely's), or the corners (x, y) of a ring."""

_Bools = NDArray[np.bool_]
_Floats = NDArray[np.float64]
_Point = tuple[Fraction, Fraction]
_MOST_BYTES = 64 << 20  # of a file
_FARTHEST = 1e100  # of coordinates, whose products are finite
_EPSILON = 2.0**-53
_TURN_ROUNDING = (3 + 16 * _EPSILON) * _EPSILON  # Shewchuk, Adaptive Precision Floating-Point Arithmetic, 1997, section 4.3
_SAFE = 1e6  # so many times the rounding is no rounding


def rings_of(polygon: Any) -> list[list[Ring]]:
    """Of each polygon its rings, (k, 2). Raises UsageError for what has none."""
    if isinstance(polygon, (str, os.PathLike)):
        found = _GeoJson(os.fspath(polygon)).read(_text_of(polygon))
    elif isinstance(polygon, Mapping) or hasattr(polygon, "__geo_interface__"):
        found = _GeoJson("polygon").read(getattr(polygon, "__geo_interface__", polygon))
    else:
        found = [[_GeoJson("polygon").ring(polygon if isinstance(polygon, (list, tuple)) else np.asarray(polygon).tolist())]]
    return found


def _text_of(path: str | os.PathLike[str]) -> Any:
    try:
        if os.path.getsize(path) > _MOST_BYTES:
            raise UsageError(f"{os.fspath(path)}: it has more than {_MOST_BYTES} bytes, too many for a GeoJSON")
        with open(path, encoding="utf-8-sig") as file:
            return json.load(file)
    except (OSError, ValueError, RecursionError) as error:
        raise UsageError(f"{os.fspath(path)}: no GeoJSON: {error}") from error


class _GeoJson:
    """Polygons of a geometry, a feature or a collection of these (RFC 7946); other geometries are passed over."""

    def __init__(self, what: str) -> None:
        self._what = what

    def fail(self, why: str) -> UsageError:
        return UsageError(f"{self._what}: {why}; a polygon is a GeoJSON file, an object as GeoJSON has them, or a list of corners (x, y)")

    def read(self, value: Any) -> list[list[Ring]]:
        try:
            found = [[self.ring(ring) for ring in polygon] for polygon in self._polygons(value)]
        except (AttributeError, KeyError, TypeError, RecursionError):
            raise self.fail("it is no GeoJSON") from None
        if not any(found):
            raise self.fail("it has no polygon")
        return found

    def _polygons(self, value: Any) -> Iterator[Any]:
        kind = value["type"]
        if kind in ("FeatureCollection", "GeometryCollection"):
            for member in value["features" if kind[0] == "F" else "geometries"]:
                yield from self._polygons(member)
        elif kind == "Feature" and value.get("geometry") is not None:
            yield from self._polygons(value["geometry"])
        elif kind == "Polygon":
            yield value["coordinates"]
        elif kind == "MultiPolygon":
            yield from value["coordinates"]

    def ring(self, corners: Any) -> Ring:
        try:
            ring = np.array([(float(x), float(y)) for x, y, *_ in corners], np.float64).reshape(-1, 2)
        except (TypeError, ValueError):
            raise self.fail("a position is no list of numbers") from None
        if not np.isfinite(ring).all():
            raise self.fail("a position is not finite")
        if (np.abs(ring) > _FARTHEST).any():
            raise self.fail(f"a position is farther away than {_FARTHEST}")
        if len(ring) > 1 and (ring[0] == ring[-1]).all():
            ring = ring[:-1]
        if len(ring) < 3:
            raise self.fail("a ring has fewer than three corners")
        return ring


def _turns(a: _Floats, b: _Floats, p: _Floats) -> tuple[_Floats, _Floats]:
    """Of (..., 2) points: above 0 where p lies left of the line from a to b; and by how much this may be off."""
    left = (b[..., 0] - a[..., 0]) * (p[..., 1] - a[..., 1])
    right = (b[..., 1] - a[..., 1]) * (p[..., 0] - a[..., 0])
    return left - right, _TURN_ROUNDING * (np.abs(left) + np.abs(right))


def _fractions(point: _Floats) -> _Point:
    return Fraction(float(point[0])), Fraction(float(point[1]))


def _turn(a: _Point, b: _Point, p: _Point) -> Fraction:
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])


class Polygons:
    """The points that lie in any of some polygons: around which an odd number of a polygon's rings runs."""

    def __init__(self, polygons: list[list[Ring]], is_z_up: bool, origin: _Floats) -> None:
        """`origin`: of the coordinates that are asked for, in those of the polygons."""
        self._is_z_up = is_z_up
        moved = [[ring - self._plan(origin) for ring in polygon] for polygon in polygons]
        self._borders = [_borders_of(polygon) for polygon in moved]
        self._known: dict[tuple[int, int], list[_Point]] = {}
        self._all = np.concatenate(self._borders)
        self._low, self._high = self._all.min(axis=1, initial=np.inf), self._all.max(axis=1, initial=-np.inf)

    def _plan(self, points: _Floats) -> _Floats:
        """(..., 3) points seen from above: to the east, to the north."""
        return points[..., [0, 1]] if self._is_z_up else points[..., [0, 2]] * np.array([1.0, -1.0])

    def may_meet(self, low: _Floats, high: _Floats) -> bool:
        """False only if no point of the box lies in it."""
        ends = self._plan(np.stack([low, high]))
        return bool(self._near(ends).any() or self._contains(ends[:1])[0])

    def contains(self, points: _Floats) -> _Bools:
        """For each of (..., 3) points whether it lies within."""
        plan = self._plan(points)
        if plan.size == 0:
            return np.zeros(plan.shape[:-1], bool)
        return self._contains(plan.reshape(-1, 2)).reshape(plan.shape[:-1])

    def touches(self, corners: _Floats) -> _Bools:
        """For each of (m, 3, 3) triangles whether a corner or a part of it lies within."""
        touches = np.zeros(len(corners), bool)
        if len(corners) > 0 and not self._near(self._plan(corners).reshape(-1, 2)).any():
            touches[:] = self.contains(corners[0, 0])
            return touches
        touches = self.contains(corners).any(axis=1)
        touches[~touches] = self.has_part(corners[~touches])
        return touches

    def has_part(self, corners: _Floats) -> _Bools:
        """For each of (m, 3, 3) triangles whether a part of it lies within that is as large as it is from above: an area, a line or a point."""
        plan = self._plan(corners)
        if len(plan) == 0:
            return np.zeros(0, bool)
        borders = self._all[self._near(plan.reshape(-1, 2))]
        turn, rounding = _turns(plan[:, 0], plan[:, 1], plan[:, 2])
        is_upright = np.abs(turn) <= rounding
        for number in np.flatnonzero(is_upright):
            is_upright[number] = _turn(*map(_fractions, plan[number])) == 0
        plan[turn < 0] = plan[turn < 0][:, ::-1]
        low, high = plan.min(axis=1), plan.max(axis=1)
        has_part = np.zeros(len(plan), bool)
        for border in borders:
            asked = ~has_part & ~is_upright & (low <= border.max(axis=0)).all(axis=1) & (high >= border.min(axis=0)).all(axis=1)
            rows = np.flatnonzero(asked)
            has_part[rows] = _crosses(plan[rows], border)
        # No border runs through what is left: it is within or without.
        rest = np.flatnonzero(~has_part & ~is_upright)
        has_part[rest] = self._has_middle(plan[rest])
        for number in np.flatnonzero(is_upright):
            has_part[number] = self._has_line(plan[number], borders)
        return has_part

    def _near(self, points: _Floats) -> _Bools:
        """The borders whose boxes meet that of the points."""
        return (self._low <= points.max(axis=0)).all(axis=1) & (self._high >= points.min(axis=0)).all(axis=1)

    def _contains(self, points: _Floats) -> _Bools:
        """For each of (n, 2) points whether it lies within: by the borders that a ray to the east crosses."""
        order = np.argsort(points[:, 1], kind="stable")
        ascending = points[order]
        west = points[:, 0].min()
        within = np.zeros(len(points), bool)
        for borders in self._borders:
            if len(borders) == 0 or borders[..., 0].max() < west:
                continue
            is_odd = np.zeros(len(points), bool)
            firsts, ends = (np.searchsorted(ascending[:, 1], border) for border in (borders[..., 1].min(axis=1), borders[..., 1].max(axis=1)))
            for at in np.flatnonzero((firsts < ends) & (borders[..., 0].max(axis=1) >= west)):
                a, b = borders[at]
                asked = ascending[firsts[at] : ends[at]]
                if b[1] < a[1]:
                    a, b = b, a
                turn, rounding = _turns(a, b, asked)
                is_left = turn > 0
                for number in np.flatnonzero(np.abs(turn) <= rounding):
                    is_left[number] = _turn(*map(_fractions, (a, b, asked[number]))) > 0
                is_odd[firsts[at] : ends[at]] ^= is_left
            within |= is_odd
        result = np.zeros(len(points), bool)
        result[order] = within
        return result

    def _has(self, point: _Point) -> bool:
        """The same of one exact point."""
        north, south = np.nextafter(float(point[1]), [np.inf, -np.inf])
        for polygon, borders in enumerate(self._borders):
            is_odd = False
            for at in np.flatnonzero((borders[..., 1].min(axis=1) <= north) & (borders[..., 1].max(axis=1) >= south)):
                a, b = self._exact(polygon, at)
                is_odd ^= a[1] <= point[1] < b[1] and _turn(a, b, point) > 0
            if is_odd:
                return True
        return False

    def _exact(self, polygon: int, border: int) -> list[_Point]:
        """A border from its southern end."""
        if (polygon, border) not in self._known:
            self._known[polygon, border] = sorted(map(_fractions, self._borders[polygon][border]), key=lambda end: end[1])
        return self._known[polygon, border]

    def _has_middle(self, triangles: _Floats) -> _Bools:
        """For each of (m, 3, 2) triangles that turn left whether its middle lies within."""
        middles = triangles.mean(axis=1)
        if len(middles) == 0:
            return np.zeros(0, bool)
        within = self._contains(middles)
        is_inside = np.ones(len(middles), bool)
        for k in range(3):
            turn, rounding = _turns(triangles[:, k], triangles[:, (k + 1) % 3], middles)
            is_inside &= turn > rounding
        for number in np.flatnonzero(~is_inside):  # thinner than rounding
            a, b, c = map(_fractions, triangles[number])
            within[number] = self._has(((a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3))
        return within

    def _has_line(self, triangle: _Floats, borders: _Floats) -> bool:
        """Whether a part of an upright triangle, a line or a point from above, lies within."""
        a, *_, b = sorted(map(_fractions, triangle))
        stops = {Fraction(0), Fraction(1)}
        low, high = triangle.min(axis=0), triangle.max(axis=0)
        for border in borders[(borders.min(axis=1) <= high).all(axis=1) & (borders.max(axis=1) >= low).all(axis=1)]:
            stops.update(stop for stop in _stops(a, b, *map(_fractions, border)) if 0 < stop < 1)
        ordered = sorted(stops)
        middles = [(one + other) / 2 for one, other in zip(ordered, ordered[1:])]
        return self._has(a) if a == b else any(self._has((a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]))) for t in middles)


def _borders_of(polygon: list[Ring]) -> _Floats:
    """(n, 2, 2): from corner to corner of its rings. Where two run over each other, as a slit to a hole does, there is none."""
    borders = np.concatenate([np.stack([ring, np.roll(ring, -1, axis=0)], axis=1) for ring in polygon] or [np.zeros((0, 2, 2))]) + 0.0
    borders = borders[(borders[:, 0] != borders[:, 1]).any(axis=1)]
    is_turned = (borders[:, 0, 0] > borders[:, 1, 0]) | ((borders[:, 0, 0] == borders[:, 1, 0]) & (borders[:, 0, 1] > borders[:, 1, 1]))
    borders[is_turned] = borders[is_turned][:, ::-1]
    lines: dict[Any, list[_Floats]] = {}
    alone: list[_Floats] = []
    for border, has_parallel in zip(borders, _have_parallels(borders)):
        if has_parallel:
            lines.setdefault(_line_of(*map(_fractions, border)), []).append(border)
        else:
            alone.append(border)
    return np.array([*alone, *(part for line in lines.values() for part in _odd_parts(line))]).reshape(-1, 2, 2)


def _have_parallels(borders: _Floats) -> _Bools:
    """False only of borders to which no other one is parallel."""
    way = borders[:, 1] - borders[:, 0]
    angles = np.arctan2(way[:, 1], way[:, 0])
    order = np.argsort(angles)
    is_close = np.diff(angles[order]) < 1e-9
    found = np.zeros(len(borders), bool)
    found[order[1:]] |= is_close
    found[order[:-1]] |= is_close
    return found


def _line_of(a: _Point, b: _Point) -> tuple[Fraction, ...]:
    """What borders on one line have in common: slope, and where it meets an axis."""
    if a[0] == b[0]:
        return (a[0],)
    slope = (b[1] - a[1]) / (b[0] - a[0])
    return slope, a[1] - slope * a[0]


def _odd_parts(line: list[_Floats]) -> list[_Floats]:
    """The parts of a line over which an odd number of these borders runs, all in one direction."""
    if len(line) == 1:
        return line
    counts = Counter((float(x), float(y)) for border in line for x, y in border)
    ends = sorted(counts)
    parts, is_odd = [], False
    for end, following in zip(ends, ends[1:]):
        is_odd ^= counts[end] % 2 == 1
        if is_odd:
            parts.append(np.array([end, following]))
    return parts


def _stops(a: _Point, b: _Point, c: _Point, d: _Point) -> list[Fraction]:
    """Which parts of the way from a to b the line from c to d meets it at: its ends, if it runs along it."""
    axis = 0 if a[0] != b[0] else 1
    from_c, from_d = _turn(a, b, c), _turn(a, b, d)
    if a == b or from_c * from_d > 0:
        return []
    if from_c == from_d:
        places = [c[axis], d[axis]]
    else:
        places = [c[axis] + from_c / (from_c - from_d) * (d[axis] - c[axis])]
    return [(place - a[axis]) / (b[axis] - a[axis]) for place in places]


def _crosses(triangles: _Floats, border: _Floats) -> _Bools:
    """For each of (m, 3, 2) triangles that turn left whether a border runs through its inside."""
    first, last = np.zeros(len(triangles)), np.ones(len(triangles))  # the part of the border that is left of all sides
    is_sure = np.ones(len(triangles), bool)
    for k in range(3):
        a, b = triangles[:, k], triangles[:, (k + 1) % 3]
        (start, start_off), (end, end_off) = _turns(a, b, border[0]), _turns(a, b, border[1])
        is_sure &= np.maximum(np.abs(start), np.abs(end)) > _SAFE * np.maximum(start_off, end_off)
        with np.errstate(divide="ignore", invalid="ignore"):
            at_side = start / (start - end)
        first = np.where(end > start, np.maximum(first, at_side), first)
        last = np.where(end < start, np.minimum(last, at_side), last)
        last = np.where((start == end) & (start <= 0), -1, last)
    crosses = first < last
    is_sure &= np.abs(first - last) > 1 / _SAFE
    for number in np.flatnonzero(~is_sure):
        crosses[number] = _crosses_exactly([_fractions(corner) for corner in triangles[number]], *map(_fractions, border))
    return crosses


def _crosses_exactly(triangle: list[_Point], start: _Point, end: _Point) -> bool:
    first, last = Fraction(0), Fraction(1)
    for a, b in zip(triangle, triangle[1:] + triangle[:1]):
        from_start, from_end = _turn(a, b, start), _turn(a, b, end)
        if from_end > from_start:
            first = max(first, from_start / (from_start - from_end))
        elif from_end < from_start:
            last = min(last, from_start / (from_start - from_end))
        elif from_start <= 0:
            return False
    return first < last
