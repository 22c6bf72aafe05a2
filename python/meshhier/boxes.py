# SPDX-License-Identifier: MIT
"""Which triangles touch a box."""

from __future__ import annotations

from typing import Sequence

import numpy as np
from numpy.typing import NDArray


def touches_box(corners: NDArray[np.float64], low: Sequence[float], high: Sequence[float]) -> NDArray[np.bool_]:
    """For each of (m, 3, 3) triangles whether it has a point in the box: no axis separates the two (Akenine-Möller, Fast 3D
    Triangle-Box Overlap Testing, 2001)."""
    low_corner, high_corner = np.asarray(low, np.float64), np.asarray(high, np.float64)
    middle, half = (low_corner + high_corner) / 2, (high_corner - low_corner) / 2
    near = (corners.min(axis=1) <= high_corner).all(axis=1) & (corners.max(axis=1) >= low_corner).all(axis=1)
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
