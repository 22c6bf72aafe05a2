// Triangles with their normals and neighbours.
#pragma once

#include "base/vec.h"
#include "hierarchy/tile_mesh.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::texture {

inline constexpr std::uint32_t kNoFace = ~std::uint32_t{0};

/// The direction of a vector, of length 1; 0 if it has no length.
inline Vec3d direction_of(const Vec3d& vector) {
  const double size = length(vector);
  return size > 0 ? vector * (1 / size) : Vec3d{};
}

struct Faces {
  std::vector<Vec3d> normals;  ///< of length 1; 0 if there is no area
  std::vector<double> areas;
  std::vector<std::array<std::uint32_t, 3>> across;  ///< at the edge from corner k to the next one
                                                     ///< the other triangle there; kNoFace if there
                                                     ///< is none, or several
};

/// O(t log t).
Faces faces_of(std::span<const Vec3f> positions, std::span<const TileTriangle> triangles);

}  // namespace meshhier::texture
