// Sums of the triangles of one tile, object by object.
#pragma once

#include "base/bounds.h"
#include "base/vec.h"
#include "hierarchy/attributes.h"
#include "hierarchy/tile_mesh.h"
#include "hierarchy/tree.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace meshhier {

struct ObjectPart {
  std::uint32_t object = 0;
  std::uint32_t level = 0;        ///< the tile's
  std::uint32_t first_level = 0;  ///< cuts of the levels from here to `level` show the tile
  std::uint32_t triangles = 0;
  double area = 0;
  BoundsD box;
};
static_assert(sizeof(ObjectPart) == 72);

/// Returns a part for each object of the triangles that a tile draws in the cut of its own level,
/// ascending. `layout`: of the tile's vertices; has an object. `origin`: is added to positions.
/// O(t log t).
std::vector<ObjectPart> object_parts(const Tree& tree, NodeId node, const TileMesh& mesh,
                                     const AttributeLayout& layout, Vec3d origin);

/// Returns a triangle whose corners belong to different objects, in the order of the file; none if
/// there is none.
std::optional<TileTriangle> torn_triangle(const TileMesh& mesh, const AttributeLayout& layout);

}  // namespace meshhier
