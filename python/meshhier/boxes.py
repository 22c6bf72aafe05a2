# SPDX-License-Identifier: MIT
"""Which triangles touch a box."""

from __future__ import annotations

from typing import Any, Sequence, Union

import numpy as np
from numpy.typing import NDArray

from .errors import UsageError

Box = Union[Sequence[Sequence[float]], Sequence[NDArray[Any]], NDArray[Any]]
Corner = NDArray[np.float64]

_ROUNDING = 2.0**-50  # of coordinates: a corner or an edge on a side is enough, as for `meshhier export`


def checked_box(box: Box) -> tuple[Corner, Corner]:
    """The lower and the upper corner. Sides may be infinitely far. Raises UsageError for what is no box."""
    refusal = "a box is ((x, y, z), (x, y, z)), the smaller coordinates first"
    try:
        kinds = {type(number) for corner in box for number in corner}
        low, high = (np.asarray(corner, np.float64) for corner in box)
        is_box = low.shape == high.shape == (3,) and not kinds & {bool, np.bool_, str}
    except (TypeError, ValueError):
        is_box = False
    if not is_box or np.isnan([low, high]).any():
        raise UsageError(f"{refusal}, not {box!r}")
    for axis, least, most in zip("xyz", low.tolist(), high.tolist()):
        if least > most:
            raise UsageError(f"{refusal}; here {axis} goes from {least} back to {most}")
        if least == np.inf or most == -np.inf:
            raise UsageError(f"{refusal}; nothing lies where {axis} is {least}")
    return low, high


def touches_box(corners: NDArray[np.float64], low: Corner, high: Corner) -> NDArray[np.bool_]:
    """For each of (m, 3, 3) triangles whether it has a point in the box: no axis separates the two (Akenine-Möller, Fast 3D
    Triangle-Box Overlap Testing, 2001)."""
    near = (corners.min(axis=1) <= high).all(axis=1) & (corners.max(axis=1) >= low).all(axis=1)
    if not near.any():
        return near
    # What is beyond the triangles that are near decides nothing, and may be infinite.
    low, high = np.maximum(low, corners[near].min(axis=(0, 1)) - 1), np.minimum(high, corners[near].max(axis=(0, 1)) + 1)
    middle, half = (low + high) / 2, (high - low) / 2
    half += _ROUNDING * np.abs([low, high]).max()
    moved = corners[near] - middle
    edges = np.roll(moved, -1, axis=1) - moved
    normals = np.cross(edges[:, 0], edges[:, 1])
    touches = np.abs((normals * moved[:, 0]).sum(axis=1)) <= (np.abs(normals) * half).sum(axis=1)
    for edge in range(3):
        for unit in np.eye(3):
            axes = np.cross(edges[:, edge], unit)
            along = (moved * axes[:, None, :]).sum(axis=2)
            radius = (np.abs(axes) * half).sum(axis=1)
            touches &= (along.min(axis=1) <= radius) & (along.max(axis=1) >= -radius)
    near[near] = touches
    return near
