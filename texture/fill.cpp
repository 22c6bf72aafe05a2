#include "texture/fill.h"

#include <algorithm>
#include <cstddef>
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

}  // namespace

void fill_unknown(images::Image& image, std::span<const std::uint8_t> is_known) {
  Filler(image, is_known)();
}

}  // namespace meshhier::texture
