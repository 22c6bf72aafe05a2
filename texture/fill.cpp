#include "texture/fill.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <vector>

namespace meshhier::texture {
namespace {

/// What a pass knows: a nearest known texel, and how far it is.
struct Nearest {
  static constexpr std::uint32_t kFar = 1 << 24;
  /// The lengths of steps to neighbours beside and aslant.
  static constexpr std::uint32_t kBeside = 3, kAslant = 4;

  std::uint32_t distance = kFar;
  std::uint32_t texel = 0;

  void look(const Nearest& neighbour, std::uint32_t step) {
    const bool is_nearer = neighbour.distance + step < distance;
    distance = is_nearer ? neighbour.distance + step : distance;
    texel = is_nearer ? neighbour.texel : texel;
  }
};

/// Texels of a row side by side that are not known.
struct Gap {
  std::uint32_t y, begin, end;
};

/// Two passes, down and up, each to and fro in every row. The texels lie in a frame of texels that
/// are far from everything, so that none has to ask whether it has neighbours.
class Filler {
 public:
  Filler(images::Image& image, std::span<const std::uint8_t> is_known)
      : image_(image),
        row_(std::size_t{image.width} + 2),
        nearest_(row_ * (std::size_t{image.height} + 2)) {
    for (std::uint32_t y = 0, texel = 0; y < image.height; ++y) {
      bool was_known = true;
      for (std::uint32_t x = 0; x < image.width; ++x, ++texel) {
        const bool is = is_known[texel] != 0;
        at(x, y) = {is ? 0 : Nearest::kFar, texel};
        if (was_known && !is)
          gaps_.push_back({y, x, x});
        if (!is)
          gaps_.back().end = x + 1;
        was_known = is;
      }
    }
  }

  void operator()() {
    const auto row = static_cast<std::ptrdiff_t>(row_);
    for (const Gap& gap : gaps_) {
      forward(gap, [&](Nearest* here) { look_aside(here, -1, -row); });
      backward(gap, [](Nearest* here) { here->look(here[1], Nearest::kBeside); });
    }
    for (auto gap = gaps_.rbegin(); gap != gaps_.rend(); ++gap) {
      backward(*gap, [&](Nearest* here) { look_aside(here, 1, row); });
      forward(*gap, [](Nearest* here) { here->look(here[-1], Nearest::kBeside); });
    }
    for (const Gap& gap : gaps_) {
      for (std::uint32_t x = gap.begin; x < gap.end; ++x)
        images::copy_texel(image_.texels.data() + std::size_t{at(x, gap.y).texel} * image_.channels,
                           image_.at(x, gap.y), image_.channels);
    }
  }

 private:
  Nearest& at(std::uint32_t x, std::uint32_t y) { return nearest_[(y + 1) * row_ + x + 1]; }

  template <class Visit>
  void forward(const Gap& gap, const Visit& visit) {
    Nearest* const end = &at(gap.end, gap.y);
    for (Nearest* here = &at(gap.begin, gap.y); here != end; ++here)
      visit(here);
  }
  template <class Visit>
  void backward(const Gap& gap, const Visit& visit) {
    Nearest* const begin = &at(gap.begin, gap.y);
    for (Nearest* here = &at(gap.end, gap.y); here != begin;)
      visit(--here);
  }

  /// Looks at the neighbours that a pass has seen: the one before in the row, three in the last
  /// row.
  static void look_aside(Nearest* here, std::ptrdiff_t before, std::ptrdiff_t last_row) {
    Nearest found = *here;
    found.look(here[before], Nearest::kBeside);
    found.look(here[last_row + before], Nearest::kAslant);
    found.look(here[last_row], Nearest::kBeside);
    found.look(here[last_row - before], Nearest::kAslant);
    *here = found;
  }

  images::Image& image_;
  std::size_t row_;  ///< texels of a row, with the frame
  std::vector<Nearest> nearest_;
  std::vector<Gap> gaps_;
};

/// Looks at blocks of a picture, and fills them one by one.
class BlockFiller {
 public:
  BlockFiller(images::Image& image, std::span<const std::uint8_t> is_known)
      : image_(image),
        is_known_(is_known),
        block_(kSide, kSide, image.channels),
        blocks_(image.width / kSide, image.height / kSide, image.channels),
        is_block_known_(std::size_t{blocks_.width} * blocks_.height) {}

  void operator()() {
    for_each_block([&](std::uint32_t x, std::uint32_t y) {
      const std::uint32_t known = known_of(x, y);
      if (known == 0)
        return;
      is_block_known_[index(x, y)] = 1;
      if (known < kSide * kSide)
        fill_rest(x, y);
      take_colour(x, y);
    });
    fill_unknown(blocks_, is_block_known_);
    for_each_block([&](std::uint32_t x, std::uint32_t y) {
      if (is_block_known_[index(x, y)] == 0)
        paint(x, y);
    });
  }

 private:
  static constexpr std::uint32_t kSide = 8;

  std::size_t index(std::uint32_t x, std::uint32_t y) const {
    return std::size_t{y} * blocks_.width + x;
  }
  template <class Visit>
  void for_each_block(const Visit& visit) const {
    for (std::uint32_t y = 0; y < blocks_.height; ++y) {
      for (std::uint32_t x = 0; x < blocks_.width; ++x)
        visit(x, y);
    }
  }
  const std::uint8_t* known_row(std::uint32_t x, std::uint32_t y, std::uint32_t row) const {
    return &is_known_[(std::size_t{y} * kSide + row) * image_.width + std::size_t{x} * kSide];
  }

  /// Returns how many texels of a block are known.
  std::uint32_t known_of(std::uint32_t x, std::uint32_t y) const {
    std::uint64_t counts = 0;  // a byte for each column
    for (std::uint32_t row = 0; row < kSide; ++row) {
      std::uint64_t known = 0;
      std::memcpy(&known, known_row(x, y, row), sizeof known);
      counts += known;
    }
    constexpr std::uint64_t kOnes = 0x0101010101010101;
    return static_cast<std::uint32_t>(counts * kOnes >> 56);
  }

  void fill_rest(std::uint32_t x, std::uint32_t y) {
    const std::size_t row_bytes = std::size_t{kSide} * image_.channels;
    std::array<std::uint8_t, std::size_t{kSide} * kSide> known;
    for (std::uint32_t row = 0; row < kSide; ++row) {
      std::memcpy(&known[std::size_t{row} * kSide], known_row(x, y, row), kSide);
      std::memcpy(block_.at(0, row), image_.at(x * kSide, y * kSide + row), row_bytes);
    }
    fill_unknown(block_, known);
    for (std::uint32_t row = 0; row < kSide; ++row)
      std::memcpy(image_.at(x * kSide, y * kSide + row), block_.at(0, row), row_bytes);
  }

  /// Takes the mean of four texels as the colour of a block.
  void take_colour(std::uint32_t x, std::uint32_t y) {
    const std::uint32_t low = kSide / 4, high = kSide - 1 - low;
    const auto at = [&](std::uint32_t i, std::uint32_t j) {
      return image_.at(x * kSide + i, y * kSide + j);
    };
    const std::array four{at(low, low), at(high, low), at(low, high), at(high, high)};
    for (std::uint32_t c = 0; c < image_.channels; ++c) {
      const int sum = four[0][c] + four[1][c] + four[2][c] + four[3][c];
      blocks_.at(x, y)[c] = static_cast<std::uint8_t>((sum + 2) / 4);
    }
  }

  void paint(std::uint32_t x, std::uint32_t y) {
    for (std::uint32_t row = 0; row < kSide; ++row) {
      std::uint8_t* texel = image_.at(x * kSide, y * kSide + row);
      for (std::uint32_t i = 0; i < kSide; ++i, texel += image_.channels)
        images::copy_texel(blocks_.at(x, y), texel, image_.channels);
    }
  }

  images::Image& image_;
  std::span<const std::uint8_t> is_known_;
  images::Image block_;   ///< one at work
  images::Image blocks_;  ///< a texel for each
  std::vector<std::uint8_t> is_block_known_;
};

}  // namespace

void fill_unknown(images::Image& image, std::span<const std::uint8_t> is_known) {
  Filler(image, is_known)();
}

void fill_blocks(images::Image& image, std::span<const std::uint8_t> is_known) {
  BlockFiller(image, is_known)();
}

}  // namespace meshhier::texture
