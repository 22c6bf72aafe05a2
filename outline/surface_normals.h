// Normals of a tile's own vertices, and which of them are neighbours.
#pragma once

#include "base/vec.h"
#include "hierarchy/tile_mesh.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::outline {

/// The neighbours of own vertices, without those in other tiles. O(t) for t triangles.
class Neighbours {
 public:
  explicit Neighbours(const TileMesh& tile);

  /// Those behind it on the sides of its triangles: inside an oriented surface each one once.
  std::span<const std::uint32_t> operator[](std::uint32_t vertex) const {
    return std::span(all_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
  }

 private:
  std::vector<std::uint32_t> first_, all_;
};

/// Zero where there is no direction.
Vec3f of_length_one(Vec3d v);

/// Returns the own vertices' normals, of length one or zero: the sum over the triangles weighted by
/// area, then `rounds` times the mean with the neighbours. Roughness goes; the form of what is
/// wider than about the root of `rounds` edges stays. O(t + rounds * n).
std::vector<Vec3f> smooth_normals(const TileMesh& tile, const Neighbours& neighbours, int rounds);

}  // namespace meshhier::outline
