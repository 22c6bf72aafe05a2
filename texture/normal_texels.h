// Directions of a surface on the texels of a picture, as exact as the next coarser one needs them.
#pragma once

#include "base/lane_vector.h"
#include "texture/corners.h"
#include "texture/texel_raster.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::texture {

/// 32767 times a direction of length 1, rounded; all 0 of a texel that shows nothing.
using NormalTexel = std::array<std::int16_t, 3>;

inline bool shows(const NormalTexel& texel) {
  return (texel[0] | texel[1] | texel[2]) != 0;
}

/// The texel of a direction of length 1.
NormalTexel normal_texel(FourFloats direction);
/// A texel's direction, 32767 times as long.
FourFloats direction_of_texel(const NormalTexel& texel);

/// A picture of them that holds only what is shown: charts leave half of it free. Immutable.
class NormalTexels {
 public:
  NormalTexels() = default;
  /// `all`: row by row from the top.
  NormalTexels(std::uint32_t width, std::uint32_t height, std::span<const NormalTexel> all);
  /// As words() and known() gave them. Requires as many bits as there are known ones.
  NormalTexels(std::uint32_t width, std::uint32_t height, std::vector<std::uint64_t> words,
               std::vector<NormalTexel> known);

  std::uint32_t width() const { return width_; }
  std::uint32_t height() const { return height_; }
  /// A bit for each texel, row by row, the lowest first.
  std::span<const std::uint64_t> words() const& { return words_; }
  std::span<const NormalTexel> known() const& { return known_; }
  std::uint64_t bytes() const {
    return words_.size() * sizeof(std::uint64_t) + before_.size() * sizeof(std::uint32_t) +
           known_.size() * sizeof(NormalTexel);
  }
  static std::size_t word_count(std::uint32_t width, std::uint32_t height) {
    return (std::size_t{width} * height + 63) / 64;
  }

  NormalTexel at(std::uint32_t x, std::uint32_t y) const;

  /// Those that triangles of these corners look up, alone.
  NormalTexels around(std::span<const CornerTexcoords> triangles) const;

  /// The direction at a place of the picture, in texels, of any length; 0 if no texel around it is
  /// known. Texels are points of a smooth function (Catmull & Rom 1974, over 16 texels): means of
  /// four would be blurred again on each level. Where not all 16 are known, it is the mean of those
  /// of the four nearest that are.
  FourFloats direction_at(const TexelPoint& at) const;

 private:
  struct CubicTaps;
  void count();
  std::size_t rank(std::size_t texel) const;
  /// Four in a row from there on, if all are known.
  const NormalTexel* four_at(std::size_t texel) const;
  /// False if not all are known.
  bool mix_cubic(const CubicTaps& columns, const CubicTaps& rows, FourFloats& mix) const;

  std::uint32_t width_ = 0, height_ = 0;
  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> before_;  ///< of each eight texels: known ones before them
  std::vector<NormalTexel> known_;
};

}  // namespace meshhier::texture
