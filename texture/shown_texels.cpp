#include "texture/shown_texels.h"

#include "texture/texel_light.h"

#include <cstddef>

namespace meshhier::texture {

std::array<TexelPoint, 3> in_texels(const CornerTexcoords& corners, std::uint32_t width,
                                    std::uint32_t height) {
  std::array<TexelPoint, 3> points;
  for (std::size_t k = 0; k < 3; ++k)
    points[k] = {double(corners[k].u) * width, double(corners[k].v) * height};
  return points;
}

TexelBits shown_texels(std::uint32_t width, std::uint32_t height,
                       std::span<const CornerTexcoords> corners) {
  TexelBits shown(width, height);
  for (const CornerTexcoords& triangle : corners) {
    const std::array<TexelPoint, 3> points = in_texels(triangle, width, height);
    bool is_seen = false;
    RasterTriangle(points).for_each_span(
        TexelRange{0, 0, width, height},
        [&](std::uint32_t y, std::uint32_t begin, std::uint32_t end) {
          is_seen = true;
          shown.set_run(y, begin, end);
        });
    if (!is_seen) {
      const std::size_t middle = texel_at(middle_of(points), width, height);
      shown.set(static_cast<std::uint32_t>(middle % width),
                static_cast<std::uint32_t>(middle / width));
    }
  }
  return shown;
}

}  // namespace meshhier::texture
