// Vertices that are equal become one, out of core.
//
// Items (corners of a soup, or vertices) are sorted by what they hold; of equal ones the first
// stands for all. A second sort, by who stands for whom, numbers those that stay in the order in
// which they first appear; a third one brings the numbers back into the order of the items.
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
/// coordinates, and of equal colours if each triangle has one, which vertices have then, are one
/// vertex (-0 equals 0; the first one's bits stay); vertices are numbered by
/// first appearance. Deterministic. Throws Error(input) if there are 2^32 vertices or more.
template <class Scalar>
WeldCounts weld_soup(const storage::RecordSpool<Vec3<Scalar>>& corners,
                     const storage::RecordSpool<FacetColour>* colours, RawMesh& mesh,
                     const ImportRoom& room);

/// Fills `welded` with `mesh`, whose spools are cleared: vertices of equal position and equal
/// attributes are one, the first; those that no triangle uses as well. The order of vertices and
/// triangles stays, but triangles that wait for a part of a large table may come later.
WeldCounts weld_vertices(RawMesh& mesh, RawMesh& welded, const ImportRoom& room);

}  // namespace meshhier::importing
