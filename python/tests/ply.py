# SPDX-License-Identifier: MIT
"""PLY files as the program writes them, and meshes to be compared."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

_TYPES = {"float": "f4", "double": "f8", "uchar": "u1", "char": "i1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"}


def read_ply(path: str) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """Vertices as records, (m, 3) corners of triangles."""
    with open(path, "rb") as file:
        fields: dict[str, list[tuple[str, str]]] = {}
        counts, element = {}, ""
        while (line := file.readline().decode().strip()) != "end_header":
            words = line.split()
            if words[0] == "element":
                element, counts[words[1]] = words[1], int(words[2])
                fields[element] = []
            elif words[0] == "property" and words[1] != "list":
                fields[element].append((words[2], "<" + _TYPES[words[1]]))
        vertices = np.dtype(fields["vertex"])
        rows = np.frombuffer(file.read(vertices.itemsize * counts["vertex"]), vertices)
        faces = np.dtype([("n", "u1"), ("corners", "<i4", 3)])
        triangles = np.frombuffer(file.read(faces.itemsize * counts["face"]), faces)["corners"]
    return rows, triangles.astype(np.int64)


def triangle_set(triangles: NDArray[np.int64], *columns: Optional[NDArray[Any]]) -> NDArray[np.void]:
    """All triangles by what their corners are, wherever they begin, in one order."""
    rows = np.concatenate([np.asarray(c, np.float64).reshape(len(c), -1) for c in columns if c is not None], axis=1)
    rows = np.ascontiguousarray(np.nan_to_num(rows, nan=-7e77))
    corners = rows[triangles]
    turned = [np.ascontiguousarray(np.roll(corners, k, axis=1)).reshape(len(triangles), -1) for k in range(3)]
    as_bytes = np.stack([np.ascontiguousarray(t.astype(">f8")).view(f"V{8 * t.shape[1]}").ravel() for t in turned])
    least = [min(three, key=bytes) for three in as_bytes.T]
    return np.array(sorted(bytes(t) for t in least))
