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
    TexelPoint at;
    for (std::size_t k = 0; k < 3; ++k) {
      at.x += double{corners[k].u} * double{weights[k]};
      at.y += double{corners[k].v} * double{weights[k]};
    }
    return surface.texels->direction_at(
        {at.x * surface.texels->width(), at.y * surface.texels->height()});
  }

  std::span<const NormalSurface> surfaces_;
  const FinerSurfaces& numbers_;
  std::size_t surface_ = 0;            ///< of the last point
  std::uint32_t begin_ = 0, end_ = 0;  ///< its triangles
};

}  // namespace meshhier::texture
