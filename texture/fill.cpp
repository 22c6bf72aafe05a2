#include "texture/fill.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace meshhier::texture {
namespace {

/// Steps to neighbours that a pass has seen already, with their lengths.
struct Step {
  int x, y;
  std::uint32_t length;
};
constexpr std::array<Step, 4> kSteps = {{{-1, 0, 3}, {-1, -1, 4}, {0, -1, 3}, {1, -1, 4}}};

class Filler {
 public:
  Filler(images::Image& image, std::span<const std::uint8_t> is_known)
      : image_(image), nearest_(is_known.size()), distance_(is_known.size()) {
    for (std::size_t i = 0; i < is_known.size(); ++i) {
      nearest_[i] = static_cast<std::uint32_t>(i);
      distance_[i] = is_known[i] != 0 ? 0 : kFar;
    }
  }

  void operator()() {
    const int width = static_cast<int>(image_.width), height = static_cast<int>(image_.height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x)
        look(x, y, 1);
      for (int x = width - 1; x >= 0; --x)
        look_at(x, y, {1, 0, 3});
    }
    for (int y = height - 1; y >= 0; --y) {
      for (int x = width - 1; x >= 0; --x)
        look(x, y, -1);
      for (int x = 0; x < width; ++x)
        look_at(x, y, {-1, 0, 3});
    }
    for (std::size_t i = 0; i < nearest_.size(); ++i) {
      if (nearest_[i] != i)
        images::copy_texel(image_.texels.data() + std::size_t{nearest_[i]} * image_.channels,
                           image_.texels.data() + i * image_.channels, image_.channels);
    }
  }

 private:
  static constexpr std::uint32_t kFar = 1 << 24;

  void look(int x, int y, int direction) {
    if (is_known(x, y))
      return;
    for (const Step& step : kSteps)
      look_at(x, y, {step.x * direction, step.y * direction, step.length});
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * image_.width + static_cast<std::size_t>(x);
  }
  bool is_known(int x, int y) const { return distance_[index(x, y)] == 0; }
  void look_at(int x, int y, const Step& step) {
    const int width = static_cast<int>(image_.width), height = static_cast<int>(image_.height);
    const std::size_t here = index(x, y);
    if (is_known(x, y) || x + step.x < 0 || x + step.x >= width || y + step.y < 0 ||
        y + step.y >= height)
      return;
    const std::size_t there = here + static_cast<std::size_t>(step.y * width + step.x);
    if (distance_[there] + step.length < distance_[here]) {
      distance_[here] = distance_[there] + step.length;
      nearest_[here] = nearest_[there];
    }
  }

  images::Image& image_;
  std::vector<std::uint32_t> nearest_, distance_;
};

}  // namespace

void fill_unknown(images::Image& image, std::span<const std::uint8_t> is_known) {
  Filler(image, is_known)();
}

}  // namespace meshhier::texture
