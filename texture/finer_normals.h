// The directions of the surfaces that a tile was made of.
#pragma once

#include "base/lane_vector.h"
#include "texture/finer_points.h"
#include "texture/normal_bake.h"
#include "texture/normal_texels.h"
#include "texture/texel_samples.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace meshhier::texture {

class FinerNormals {
 public:
  /// Both must outlive it, and be of the same surfaces.
  FinerNormals(std::span<const NormalSurface> surfaces, const FinerSurfaces& numbers)
      : surfaces_(surfaces), numbers_(numbers) {}

  /// At a point, of length 1; 0 if there is none. For one thread.
  FourFloats direction(const FinerPoint& at) {
    if (at.triangle == FinerPoint::kNone)
      return FourFloats{};
    if (at.triangle < begin_ || at.triangle >= end_)
      turn_to(numbers_.surface_of(at.triangle));
    const CornerWeights weights{1 - at.on_b - at.on_c, at.on_b, at.on_c};
    return unit_of(shown_at(surfaces_[surface_], at.triangle - begin_, weights));
  }

 private:
  void turn_to(std::size_t surface) {
    surface_ = surface;
    begin_ = numbers_.first_of(surface);
    end_ = numbers_.first_of(surface + 1);
  }

  static FourFloats shown_at(const NormalSurface& surface, std::uint32_t t,
                             const CornerWeights& weights) {
    if (!surface.normals.empty()) {
      const CornerNormals& normals = surface.normals[t];
      return lanes_of(normals[0]) * weights[0] + lanes_of(normals[1]) * weights[1] +
             lanes_of(normals[2]) * weights[2];
    }
    const CornerTexcoords& corners = surface.corners[t];
    const float u =
        corners[0].u * weights[0] + corners[1].u * weights[1] + corners[2].u * weights[2];
    const float v =
        corners[0].v * weights[0] + corners[1].v * weights[1] + corners[2].v * weights[2];
    return surface.texels->direction_at(
        {double{u} * surface.texels->width(), double{v} * surface.texels->height()});
  }

  std::span<const NormalSurface> surfaces_;
  const FinerSurfaces& numbers_;
  std::size_t surface_ = 0;            ///< of the last point
  std::uint32_t begin_ = 0, end_ = 0;  ///< its triangles
};

}  // namespace meshhier::texture
