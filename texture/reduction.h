// A picture with 1 / factor of the sides of another one, which comes by bands of rows.
#pragma once

#include "images/image.h"
#include "texture/corners.h"
#include "texture/texel_bits.h"

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
  /// a power of two up to 8.
  Reduction(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
            std::span<const CornerTexcoords> corners, std::uint32_t factor);

  /// The next rows from the top; their number is a multiple of `factor`.
  void add(const images::Image& band);
  /// Requires all rows.
  images::Image operator()() &&;

  /// The bytes that it holds at most, its result included.
  static std::uint64_t bytes(std::uint64_t texels, std::uint64_t reduced_texels);

 private:
  /// A texel beside a triangle.
  struct Copy {
    std::uint32_t from = 0, to = 0;  ///< in the picture, in the result
  };

  std::vector<std::uint32_t> nearest_texels(std::span<const CornerTexcoords> corners) const;
  void take_copies(const std::vector<std::uint32_t>& nearest);
  template <std::uint32_t kChannels>
  void average(const images::Image& band, std::uint32_t x, std::uint32_t y);

  std::uint32_t width_, height_, factor_;
  TexelBits is_shown_;
  TexelBits is_mean_;  ///< of the result's texels: a part of them is shown
  TexelBits is_full_;  ///< all of them are
  images::Image result_;
  std::vector<Copy> copies_;  ///< in the order of the rows that they are from
  std::size_t copied_ = 0;
  std::uint32_t row_ = 0;  ///< of the picture: the first one that is not there yet
};

}  // namespace meshhier::texture
