// The smooth pieces of surface that meet at a place.
#pragma once

#include "hierarchy/tile_mesh.h"
#include "hierarchy/vec.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::shading {

/// A triangle's corner at the place.
struct FanCorner {
  std::uint32_t next = 0, previous = 0;  ///< places of the triangle's other corners
  Vec3d area;                            ///< along the triangle's normal, twice its area long
};

struct FanGroups {
  std::vector<std::uint32_t> group_of;  ///< of each corner
  std::vector<Vec3d> normals;           ///< of each group, the largest first; of any length
};

/// Triangles that share an edge of at most kCreaseAngle are one fan; fans whose normals differ by
/// no more are one group (leaders: Hartigan 1975; 32 at most). So a single sharp edge in a noisy
/// scan splits nothing: two must meet. An edge of other than two triangles is sharp. Triangles
/// without area go to the first group. At least one group. O(n log n).
FanGroups group_fans(std::span<const FanCorner> corners);

/// Whether all of them are one fan: one group then, whose normal is the sum of all areas. Cheaper
/// than the groups, for most places have one.
bool is_one_fan(std::span<const FanCorner> corners);

}  // namespace meshhier::shading
