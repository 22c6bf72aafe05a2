// Vertices that are equal become one, out of core.
//
// Problem. A soup of a billion triangles has no table of places that fits into memory, and vertices
// must keep the order in which they first appear.
//
// Idea. Items (corners of a soup, or vertices) are sorted three times:
//
//    items                0 A   1 B   2 A   3 C   4 B
//    1. by their bits     A: 0 2      B: 1 4      C: 3       the first stands for equal ones
//    2. by that first     0: 0 2      1: 1 4      3: 3
//                         number 0    number 1    number 2   numbers by first appearance
//    3. by item           0 1 0 2 1                          numbers in the items' order
//
// Invariant. Items are compared themselves; the key that sorts them only decides their order. Of
// equal items the first one's bits stay (-0 equals 0).
//
// Cost. Three external sorts, O(n log n); nothing is held in memory but room.sort_bytes, twice.
#pragma once

#include "import/raw_mesh.h"

#include <array>
#include <cstdint>

namespace meshhier::importing {

struct WeldCounts {
  std::uint64_t merged = 0;                ///< items that another one stands for
  std::uint64_t degenerate_triangles = 0;  ///< dropped: two corners became one
};

/// Red, green and blue, from 0 to 255.
using FacetColour = std::array<std::uint8_t, 3>;

/// Appends the triangles of a soup to `mesh`: `corners` are three a triangle. Corners of equal
/// coordinates are one vertex; if each triangle has a colour, only those of equal colours are, and
/// vertices have it (-0 equals 0; the first one's bits stay); vertices are numbered by first
/// appearance. Deterministic. Throws Error(input) if there are 2^32 vertices or more.
template <class Scalar>
WeldCounts weld_soup(const storage::RecordSpool<Vec3<Scalar>>& corners,
                     const storage::RecordSpool<FacetColour>* colours, RawMesh& mesh,
                     const ImportRoom& room);

/// Fills `welded` with `mesh`, whose spools are cleared: vertices of equal position and equal
/// attributes become one, the first; also those that no triangle uses. The order of vertices and
/// triangles stays, but triangles that wait for a part of a large table may come later.
WeldCounts weld_vertices(RawMesh& mesh, RawMesh& welded, const ImportRoom& room);

}  // namespace meshhier::importing
