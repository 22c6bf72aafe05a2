// The directions of the surfaces that a tile was made of.
#pragma once

#include "base/vec.h"
#include "texture/faces.h"
#include "texture/nearest_triangle.h"
#include "texture/normal_bake.h"
#include "texture/normal_texels.h"
#include "texture/sample_blocks.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::texture {

/// A point of a triangle as shares of its corners.
using CornerWeights = std::array<double, 3>;

/// The triangles of several surfaces, numbered through.
class FinerNormals {
 public:
  FinerNormals(std::span<const NormalSurface> surfaces, std::span<const Vec3f> tile)
      : surfaces_(surfaces), nearest_(nearest_among(surfaces, tile)) {
    std::uint32_t begin = 0;
    for (const NormalSurface& surface : surfaces) {
      begins_.push_back(begin);
      begin += static_cast<std::uint32_t>(surface.triangles.size());
    }
  }

  NearestTriangle& nearest() { return nearest_; }

  /// At the nearest point, of length 1; `facing` if there is nothing.
  Vec3d direction(const Vec3d& point, const Vec3d& facing, double reach) {
    const NearestTriangle::Found found = nearest_(point, facing, reach);
    if (found.triangle == NearestTriangle::kNone)
      return facing;
    const auto behind = std::upper_bound(begins_.begin(), begins_.end(), found.triangle);
    const auto number = static_cast<std::size_t>(behind - begins_.begin()) - 1;
    const CornerWeights weights{1 - found.on_b - found.on_c, found.on_b, found.on_c};
    const Vec3d there =
        direction_of(shown_at(surfaces_[number], found.triangle - begins_[number], weights));
    return there == Vec3d{} ? facing : there;
  }

 private:
  static Vec3d shown_at(const NormalSurface& surface, std::uint32_t t,
                        const CornerWeights& weights) {
    if (!surface.normals.empty()) {
      Vec3d sum;
      for (std::size_t k = 0; k < 3; ++k)
        sum = sum + to_double(surface.normals[t][k]) * weights[k];
      return sum;
    }
    TexelPoint at;
    for (std::size_t k = 0; k < 3; ++k) {
      at.x += double{surface.corners[t][k].u} * weights[k];
      at.y += double{surface.corners[t][k].v} * weights[k];
    }
    return surface.texels->direction_at(
        {at.x * surface.texels->width(), at.y * surface.texels->height()});
  }

  std::span<const NormalSurface> surfaces_;
  std::vector<std::uint32_t> begins_;  ///< of each surface its first triangle
  NearestTriangle nearest_;
};

}  // namespace meshhier::texture
