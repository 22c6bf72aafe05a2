// A picture with 1 / factor of the sides of another one, which comes by bands of rows.
#pragma once

#include "images/image.h"
#include "texture/corners.h"
#include "texture/shown_texels.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::texture {

/// Makes what reduced() gives, without the whole picture in memory. Which texels are means of
/// which, and which ones are copies, follows from the triangles alone.
class Reduction {
 public:
  /// The picture's size and its triangles' corners. Requires sides that are multiples of `factor`,
  /// a power of two.
  Reduction(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
            std::span<const CornerTexcoords> corners, std::uint32_t factor);

  /// The next rows from the top; their number is a multiple of `factor`.
  void add(const images::Image& band);
  /// Requires all rows.
  images::Image operator()() &&;

  /// The bytes that it holds at most, its result included, besides the few megabytes that
  /// ShownTexels takes first.
  static std::uint64_t bytes(std::uint64_t texels, std::uint64_t reduced_texels);

 private:
  /// A texel beside a triangle.
  struct Copy {
    std::uint32_t from = 0, to = 0;  ///< in the picture, in the result
  };

  void find_means();
  void find_copies(std::span<const CornerTexcoords> corners);
  void average(const images::Image& band, std::uint32_t x, std::uint32_t y);

  std::uint32_t width_, height_, factor_;
  ShownTexels is_shown_;
  images::Image result_;
  std::vector<float>
      distance_;              ///< of the result's texels from the triangle that they show, squared
  std::vector<Copy> copies_;  ///< in their order in the picture
  std::size_t copied_ = 0;
  std::uint32_t row_ = 0;  ///< of the picture: the first one that is not there yet
};

}  // namespace meshhier::texture
