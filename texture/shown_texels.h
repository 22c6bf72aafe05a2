// Which texels of a picture triangles show.
#pragma once

#include "texture/corners.h"
#include "texture/texel_raster.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::texture {

/// In a picture of that size.
std::array<TexelPoint, 3> in_texels(const CornerTexcoords& corners, std::uint32_t width,
                                    std::uint32_t height);

/// Tells of each texel whether its middle is in a triangle. A triangle that has no such middle has
/// the texel where its own middle is. O(texels + rows of all triangles) time, a bit a texel, and at
/// work some megabytes more.
class ShownTexels {
 public:
  ShownTexels(std::uint32_t width, std::uint32_t height, std::span<const CornerTexcoords> corners);

  bool operator()(std::uint32_t x, std::uint32_t y) const {
    return is_shown_[std::size_t{y} * width_ + x];
  }

 private:
  class Marker;

  std::uint32_t width_;
  std::vector<bool> is_shown_;
};

}  // namespace meshhier::texture
