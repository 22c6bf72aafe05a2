// What a textured surface shows around a point of it.
#pragma once

#include "images/image.h"
#include "texture/bake.h"
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

  /// A mean around a + on_b * (b - a) + on_c * (c - a), weighted by a tent as wide as a texel of
  /// the larger of both sizes.
  Light operator()(std::uint32_t triangle, double on_b, double on_c) const;

 private:
  struct Spot {
    float x, y, bx, by, cx, cy;  ///< texels of corner a, and from it to b and c
    float radius;                ///< of the tent, texels
    std::uint32_t picture;
  };

  std::vector<Spot> spots_;
  std::vector<images::Image> smaller_;
  std::vector<const images::Image*> pictures_;
};

}  // namespace meshhier::texture
