// The normal map of one chart, from the directions that its texels show.
//
// Problem. Each texel has a frame of its own, mixed from three corners, and the map is sharpened by
// what lies around: hundreds of operations a texel.
//
// Idea. Texels side by side in a triangle are worked on four at a time, their numbers in planes:
//
//        triangle t   . . [b c][b c][b c][b c] . .    shares of corners, one lane a texel
//                             |
//        x  ....,  y  ....,  z  ....,  known  1111    what the map says in their frames
//
// Cost. O(texels of the chart's rectangle); 30 ns a texel that shows something.
#pragma once

#include "base/four_floats.h"
#include "base/vec.h"
#include "images/image.h"
#include "texture/corner_frames.h"
#include "texture/normal_texels.h"
#include "texture/texel_samples.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::texture {

/// Draws charts, one after another. For one thread.
class ChartMap {
 public:
  /// `directions`: of the picture's texels, row by row. All three must outlive it.
  ChartMap(const TexelSamples& samples, const CornerFrames& frames,
           std::span<const NormalTexel> directions)
      : samples_(samples), frames_(frames), directions_(directions) {}

  /// Draws the texels of a chart that show something, a little sharper than they are, because
  /// viewers mix four of them. Directions that look away from the tile's own normal are turned to
  /// its side.
  void draw(const ChartPlane& plane, images::Image& map);

 private:
  using FourVectors = Vec3<FourFloats>;
  /// Texels in one triangle; lanes beyond `count` have any numbers.
  struct Four {
    std::uint32_t triangle = 0;
    std::size_t count = 0;
    std::array<FourFloats, 3> weights{FourFloats{1, 1, 1, 1}, FourFloats{}, FourFloats{}};
    FourVectors direction{};
  };
  static constexpr std::size_t kPlanes = 4;  ///< x, y, z, and 1 where that is known

  void find_row(const ChartPlane& plane, std::uint32_t y);
  void put(const Four& four, std::size_t place);
  FourVectors coefficients(const Four& four) const;
  void mix_rows();
  FourVectors sharpened(std::size_t place) const;
  void draw_row(const ChartPlane& plane, std::uint32_t y, images::Image& map) const;
  std::size_t place(const ChartPlane& plane, std::uint32_t x, std::uint32_t y) const {
    return (y - plane.top + std::size_t{1}) * stride_ + (x - plane.left + std::size_t{1});
  }

  const TexelSamples& samples_;
  const CornerFrames& frames_;
  std::span<const NormalTexel> directions_;
  std::size_t stride_ = 0;  ///< of rows, which have an empty texel on both sides
  std::array<std::vector<float>, kPlanes> own_, mixed_;
};

}  // namespace meshhier::texture
