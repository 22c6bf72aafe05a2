// Samples what a textured surface shows around a point of it.
#pragma once

#include "images/image.h"
#include "texture/bake.h"
#include "texture/finer_points.h"
#include "texture/texel_light.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::texture {

/// The triangles of several surfaces, numbered through.
class TexelSampler {
 public:
  /// `texel`: the size, on the surface, of what is asked for.
  TexelSampler(std::span<const TexturedSurface> surfaces, double texel);

  /// A mean around a point, weighted by a tent that ends a texel of the larger of both sizes away.
  TexelLight around(const FinerPoint& at) const { return mean(at, &Spot::radius); }
  /// The mean of a pixel around it that is as large as a texel: a tent of as much spread, about.
  TexelLight pixel(const FinerPoint& at) const { return mean(at, &Spot::pixel_radius); }
  /// Says that a point will be asked about after a few others, or none.
  void prefetch(const FinerPoint& at) const {
    if (at.triangle < spots_.size())
      __builtin_prefetch(&spots_[at.triangle]);
  }

 private:
  struct Spot {
    float x, y, bx, by, cx, cy;  ///< texels of corner a, and from it to b and c
    float radius, pixel_radius;  ///< of what is asked for, texels
    std::uint32_t picture;
  };

  TexelLight mean(const FinerPoint& at, float Spot::*radius) const;

  std::vector<Spot> spots_;
  std::vector<images::Image> smaller_;
  std::vector<const images::Image*> pictures_;
};

}  // namespace meshhier::texture
