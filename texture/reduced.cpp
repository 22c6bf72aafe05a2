#include "texture/bake.h"
#include "texture/fill.h"
#include "texture/light.h"
#include "texture/texel_light.h"
#include "texture/texel_raster.h"
#include "texture/texel_segment.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <utility>

namespace meshhier::texture {
namespace {

std::array<TexelPoint, 3> in_texels(const CornerTexcoords& corners, const images::Image& image) {
  std::array<TexelPoint, 3> points;
  for (std::size_t k = 0; k < 3; ++k)
    points[k] = {double(corners[k].u) * image.width, double(corners[k].v) * image.height};
  return points;
}

/// Of each texel whether its middle is in a triangle. A triangle that has no middle has the texel
/// where its own middle is. Texels that are marked are passed over at once, however many triangles
/// show them. O(texels + rows of all triangles).
class ShownTexels {
 public:
  ShownTexels(const images::Image& image, std::span<const CornerTexcoords> corners)
      : width_(image.width),
        is_shown_(std::size_t{image.width} * image.height),
        next_(is_shown_.size() + 1) {
    std::iota(next_.begin(), next_.end(), 0U);
    for (const CornerTexcoords& triangle : corners)
      mark(in_texels(triangle, image), image.height);
  }
  bool operator()(std::uint32_t x, std::uint32_t y) const {
    return is_shown_[std::size_t{y} * width_ + x];
  }

 private:
  void mark(const std::array<TexelPoint, 3>& points, std::uint32_t height) {
    bool has_any = false;
    RasterTriangle(points).for_each_span(
        width_, height, [&](std::uint32_t y, std::uint32_t begin, std::uint32_t end) {
          has_any = true;
          const std::size_t row = std::size_t{y} * width_;
          for (std::size_t at = find_next(row + begin); at < row + end; at = find_next(at))
            mark(at);
        });
    if (const std::size_t at = texel_at(middle_of(points), width_, height);
        !has_any && !is_shown_[at])
      mark(at);
  }
  void mark(std::size_t at) {
    is_shown_[at] = true;
    next_[at] = static_cast<std::uint32_t>(at + 1);
  }
  /// The next texel from `at` on that is not marked.
  std::size_t find_next(std::size_t at) {
    while (next_[at] != at) {
      next_[at] = next_[next_[at]];
      at = next_[at];
    }
    return at;
  }

  std::uint32_t width_;
  std::vector<bool> is_shown_;
  std::vector<std::uint32_t> next_;
};

/// A picture with 1 / factor of the sides of another one.
class Reduction {
 public:
  Reduction(const images::Image& image, std::span<const CornerTexcoords> corners,
            std::uint32_t factor)
      : image_(image),
        corners_(corners),
        factor_(factor),
        result_(image.width / factor, image.height / factor, image.channels),
        distance_(std::size_t{result_.width} * result_.height, kUnknown) {}

  images::Image operator()() && {
    average();
    cover_borders();
    std::vector<std::uint8_t> is_known(distance_.size());
    std::ranges::transform(distance_, is_known.begin(), [](float d) { return d < kUnknown; });
    fill_unknown(result_, is_known);
    return std::move(result_);
  }

 private:
  static constexpr float kUnknown = 1e9f;

  float& distance(std::uint32_t x, std::uint32_t y) {
    return distance_[std::size_t{y} * result_.width + x];
  }

  void average() {
    const ShownTexels is_shown(image_, corners_);
    for (std::uint32_t y = 0; y < result_.height; ++y) {
      for (std::uint32_t x = 0; x < result_.width; ++x) {
        Light sum{};
        float count = 0;
        for (std::uint32_t j = y * factor_; j < (y + 1) * factor_; ++j) {
          for (std::uint32_t i = x * factor_; i < (x + 1) * factor_; ++i) {
            if (!is_shown(i, j))
              continue;
            add_texel(sum, image_.at(i, j), image_.channels, 1);
            ++count;
          }
        }
        if (count == 0)
          continue;
        for (float& channel : sum)
          channel /= count;
        store_texel(sum, result_.at(x, y), image_.channels);
        distance(x, y) = 0;
      }
    }
  }

  /// Texels beside a triangle, which filters see, have the colour of its nearest texel, although
  /// one of another chart may be nearer.
  void cover_borders() {
    const TexelRange all{0, 0, result_.width, result_.height};
    for (const CornerTexcoords& triangle : corners_) {
      const std::array<TexelPoint, 3> at = in_texels(triangle, result_);
      for (std::size_t k = 0; k < 3; ++k) {
        const TexelPoint &from = at[k], &to = at[(k + 1) % 3];
        TexelSegment(from, to).for_each_near(
            all, [&](std::uint32_t x, std::uint32_t y, const TexelSegment::Foot& foot) {
              if (foot.distance >= distance(x, y))
                return;
              distance(x, y) = static_cast<float>(foot.distance);
              const TexelPoint nearest{(x + 0.5 - foot.off_x) * factor_,
                                       (y + 0.5 - foot.off_y) * factor_};
              const std::size_t texel = texel_at(nearest, image_.width, image_.height);
              std::copy_n(image_.texels.data() + texel * image_.channels, image_.channels,
                          result_.at(x, y));
            });
      }
    }
  }

  const images::Image& image_;
  std::span<const CornerTexcoords> corners_;
  std::uint32_t factor_;
  images::Image result_;
  std::vector<float> distance_;  ///< from the triangle that it shows, squared
};

}  // namespace

images::Image reduced(const images::Image& image, std::span<const CornerTexcoords> corners,
                      std::uint32_t factor) {
  return Reduction(image, corners, factor)();
}

}  // namespace meshhier::texture
