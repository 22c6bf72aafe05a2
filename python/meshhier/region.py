# SPDX-License-Identifier: MIT
"""The part of space that a piece of a mesh is taken from."""

from __future__ import annotations

from typing import Optional

import numpy as np
from numpy.typing import NDArray

from .boxes import Box, checked_box, touches_box
from .polygons import Polygon, Polygons, rings_of

_Floats = NDArray[np.float64]


class Region:
    """What lies in a box, in polygons seen from above, or in both; asked in coordinates relative to an origin."""

    def __init__(self, box: Optional[Box], polygon: Optional[Polygon], is_z_up: bool, origin: _Floats) -> None:
        self._polygons = None if polygon is None else Polygons(rings_of(polygon), is_z_up, origin)
        low, high = (np.full(3, -np.inf), np.full(3, np.inf)) if box is None else checked_box(box)
        self._low, self._high = low - origin, high - origin
        self._has_box = box is not None

    def may_meet(self, low: _Floats, high: _Floats) -> NDArray[np.bool_]:
        """For each of n boxes, (n, 3) and (n, 3): False only if no point of it lies in the region."""
        meets = ((low <= self._high) & (high >= self._low)).all(axis=1)
        if self._polygons is not None:
            rows = np.flatnonzero(meets)
            meets[rows] = [self._polygons.may_meet(low[row], high[row]) for row in rows]
        return meets

    def touches(self, corners: _Floats) -> NDArray[np.bool_]:
        """For each of (m, 3, 3) triangles whether it has a point in the box, and a part in the polygons there."""
        touches = touches_box(corners, self._low, self._high) if self._has_box else np.ones(len(corners), bool)
        if self._polygons is not None:
            touches[touches] = self._polygons.touches(corners[touches])
            if self._has_box:
                touches[touches] = self._touches_both(corners[touches], self._polygons)
        return touches

    def _touches_both(self, corners: _Floats, polygons: Polygons) -> NDArray[np.bool_]:
        """The same of triangles that have a point in each of the two."""
        is_within = ((corners >= self._low) & (corners <= self._high)).all(axis=2)
        both = is_within.all(axis=1) | (is_within & polygons.contains(corners)).any(axis=1)
        for number in np.flatnonzero(~both):
            part = _within(corners[number], self._low, self._high)
            fans = np.stack([np.broadcast_to(part[0], part[1:-1].shape), part[1:-1], part[2:]], axis=1) if len(part) > 2 else np.zeros((0, 3, 3))
            both[number] = bool(polygons.has_part(fans).any())
        return both


def _within(polygon: _Floats, low: _Floats, high: _Floats) -> _Floats:
    """(k, 3): the part of a polygon in a box."""
    for axis in range(3):
        for side, sign in ((low[axis], 1), (high[axis], -1)):
            if len(polygon) == 0 or not np.isfinite(side):
                continue
            inside = (polygon[:, axis] - side) * sign
            following, beyond = np.roll(polygon, -1, axis=0), np.roll(inside, -1)
            made = []
            for corner, other, here, there in zip(polygon, following, inside, beyond):
                if here >= 0:
                    made.append(corner)
                if here < 0 < there or there < 0 < here:
                    cut = corner + (other - corner) * (here / (here - there))
                    cut[axis] = side
                    made.append(cut)
            polygon = np.array(made).reshape(-1, 3)
    return polygon
