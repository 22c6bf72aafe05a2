#include "images/uastc_picture.h"

#include "images/pyramid.h"
#include "images/uastc_encoder.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace meshhier::images {
namespace {

std::uint32_t half_of(std::uint32_t side) {
  return std::max(side / 2, 1U);
}

/// Takes the rows of a picture, from the top, and makes blocks of all levels.
class LevelBlocks {
 public:
  LevelBlocks(const Ktx2Picture& picture, std::uint32_t channels)
      : meaning_(picture.meaning), channels_(channels) {
    const UastcEffort& effort =
        meaning_ == Ktx2Meaning::directions ? kDirectionEffort : kColourEffort;
    for (TexelSize size = picture.size;; size = {half_of(size.width), half_of(size.height)}) {
      const std::size_t row = std::size_t{size.width} * channels;
      levels_.push_back({size, 0, UastcEncoder(effort), std::vector<std::uint8_t>(kBlockSide * row),
                         std::vector<std::uint8_t>(half_of(size.width) * channels)});
      blocks_.emplace_back().reserve(std::size_t{blocks_of(size.width)} * blocks_of(size.height));
      if (size.width == 1 && size.height == 1)
        break;
    }
  }

  void put_row(const std::uint8_t* row) { put_row(0, row); }
  const std::vector<std::vector<UastcBytes>>& blocks() const { return blocks_; }

 private:
  struct OpenLevel {
    TexelSize size;
    std::uint32_t rows = 0;  ///< rows that it has so far
    UastcEncoder encoder;
    std::vector<std::uint8_t> strip;   ///< the rows of a row of blocks
    std::vector<std::uint8_t> halved;  ///< a row of the next level
  };

  static std::uint32_t blocks_of(std::uint32_t side) {
    return (side + kBlockSide - 1) / kBlockSide;
  }
  std::uint8_t* strip_row(OpenLevel& level, std::uint32_t row) const {
    return level.strip.data() + std::size_t{row} * level.size.width * channels_;
  }
  void put_row(std::uint32_t number, const std::uint8_t* row);
  void halve(std::uint32_t number, std::uint32_t above, std::uint32_t below);
  void encode_strip(std::uint32_t number, std::uint32_t rows);
  std::array<Rgba, kBlockTexels> texels_at(OpenLevel& level, std::uint32_t x,
                                           std::uint32_t rows) const;

  Ktx2Meaning meaning_;
  std::uint32_t channels_;
  std::vector<OpenLevel> levels_;
  std::vector<std::vector<UastcBytes>> blocks_;
};

void LevelBlocks::put_row(std::uint32_t number, const std::uint8_t* row) {
  OpenLevel& level = levels_[number];
  const std::uint32_t at = level.rows % kBlockSide;
  std::memcpy(strip_row(level, at), row, std::size_t{level.size.width} * channels_);
  ++level.rows;
  const bool is_last = level.rows == level.size.height;
  if (number + 1 < levels_.size() && (at % 2 == 1 || level.size.height == 1))
    halve(number, at / 2 * 2, at);
  if (is_last || at + 1 == kBlockSide)
    encode_strip(number, at + 1);
}

/// Makes a row of the next level of two rows of the strip.
void LevelBlocks::halve(std::uint32_t number, std::uint32_t above, std::uint32_t below) {
  OpenLevel& level = levels_[number];
  const std::uint32_t even = std::max(level.size.width / 2 * 2, 1U);
  auto* const halve_two = meaning_ == Ktx2Meaning::directions ? halve_directions : halve_rows;
  halve_two(strip_row(level, above), strip_row(level, below), even, channels_, level.halved.data());
  put_row(number + 1, level.halved.data());
}

void LevelBlocks::encode_strip(std::uint32_t number, std::uint32_t rows) {
  OpenLevel& level = levels_[number];
  for (std::uint32_t x = 0; x < level.size.width; x += kBlockSide)
    blocks_[number].push_back(pack_block(level.encoder.encode(texels_at(level, x, rows))));
}

std::array<Rgba, kBlockTexels> LevelBlocks::texels_at(OpenLevel& level, std::uint32_t x,
                                                      std::uint32_t rows) const {
  std::array<Rgba, kBlockTexels> texels;
  for (std::uint32_t i = 0; i < kBlockTexels; ++i) {
    const std::uint32_t row = std::min(i / kBlockSide, rows - 1);
    const std::uint32_t column = std::min(x + i % kBlockSide, level.size.width - 1);
    texels[i][3] = 255;
    images::copy_texel(strip_row(level, row) + std::size_t{column} * channels_, texels[i].data(),
                       channels_);
  }
  return texels;
}

}  // namespace

std::vector<std::byte> encode_uastc(const Image& image, Ktx2Meaning meaning) {
  const Ktx2Picture picture{{image.width, image.height}, image.channels == 4, meaning};
  LevelBlocks levels(picture, image.channels);
  for (std::uint32_t y = 0; y < image.height; ++y)
    levels.put_row(image.at(0, y));
  return ktx2_file(picture, levels.blocks());
}

std::uint64_t uastc_encoder_bytes(std::uint64_t texels) {
  constexpr std::uint64_t kStrips = std::uint64_t{1} << 18;  // 14 bytes a column, all levels
  return kStrips + texels * 4 / 3 + ktx2_packing_bytes(texels);
}

}  // namespace meshhier::images
