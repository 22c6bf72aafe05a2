// The division of a picture's pyramid into blocks, which lie in strips.
//
// A strip is a row of blocks, from left to right; strips are numbered from the top, those of the
// picture itself first, then those of each coarser level. Blocks at the right and at the bottom are
// as small as the picture leaves them:
//
//        level 0, 150 x 100                level 1, 75 x 50       level 2, 38 x 25
//       +--------+--------+---+            +--------+--+          +-----+
//       | 64x64  | 64x64  |22 |  strip 0   | 64x50  |11|  strip 2 |38x25|  strip 3   ...
//       +--------+--------+---+            +--------+--+          +-----+
//       | 64x36  | 64x36  |22 |  strip 1
//       +--------+--------+---+
#pragma once

#include "images/pyramid.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace meshhier::images {

class BlockGrid {
 public:
  static constexpr std::uint32_t kBlockSide = 64;

  BlockGrid(TexelSize picture, std::uint32_t channels) : picture_(picture), channels_(channels) {}

  std::uint32_t channels() const { return channels_; }
  std::uint32_t levels() const { return level_count(picture_); }
  TexelSize size(std::uint32_t level) const { return level_size(picture_, level); }

  /// Returns the number of a level's first strip.
  std::uint32_t first_strip(std::uint32_t level) const;
  std::uint32_t strips() const { return first_strip(levels()); }
  std::uint64_t strip_bytes(std::uint32_t level, std::uint32_t row) const {
    return std::uint64_t{size(level).width} * rows(level, row) * channels_;
  }

  /// Return the texels that blocks in a column of blocks are wide, in a row of blocks high.
  std::uint32_t columns(std::uint32_t level, std::uint32_t column) const {
    return part(size(level).width, column);
  }
  std::uint32_t rows(std::uint32_t level, std::uint32_t row) const {
    return part(size(level).height, row);
  }
  /// Returns a block's offset in its strip, in bytes.
  std::size_t offset(std::uint32_t level, std::uint32_t column, std::uint32_t row) const {
    return std::size_t{column} * kBlockSide * rows(level, row) * channels_;
  }

 private:
  static std::uint32_t part(std::uint32_t side, std::uint32_t number) {
    return std::min(kBlockSide, side - number * kBlockSide);
  }

  TexelSize picture_;
  std::uint32_t channels_;
};

}  // namespace meshhier::images
