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


def triangle_set(triangles: NDArray[np.int64], *columns: Optional[NDArray[Any]]) -> NDArray[np.int64]:
    """All triangles by the bits of what their corners are, wherever they begin, in one order: a row each."""
    rows = np.concatenate([np.asarray(c, np.float64).reshape(len(c), -1) for c in columns if c is not None], axis=1)
    bits = np.ascontiguousarray(np.nan_to_num(rows, nan=-7e77)).view(np.int64)
    order = np.lexsort(bits.T)
    ranks = np.empty(len(bits), np.int64)
    ranks[order] = np.cumsum(np.append(0, (np.diff(bits[order], axis=0) != 0).any(axis=1)))
    turned = np.stack([np.roll(triangles, -k, axis=1) for k in range(3)])
    codes = (ranks[turned] * [len(bits) ** 2, len(bits), 1]).sum(axis=2)
    first = codes.argmin(axis=0)
    least = np.take_along_axis(turned, first[None, :, None], axis=0)[0]
    return bits[least[np.argsort(codes.min(axis=0), kind="stable")]].reshape(len(triangles), -1)
