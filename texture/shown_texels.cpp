#include "texture/shown_texels.h"

#include "texture/texel_light.h"

#include <algorithm>
#include <numeric>

namespace meshhier::texture {
namespace {

/// Texels that are looked at together.
constexpr std::uint32_t kBandTexels = std::uint32_t{1} << 20;

}  // namespace

std::array<TexelPoint, 3> in_texels(const CornerTexcoords& corners, std::uint32_t width,
                                    std::uint32_t height) {
  std::array<TexelPoint, 3> points;
  for (std::size_t k = 0; k < 3; ++k)
    points[k] = {double(corners[k].u) * width, double(corners[k].v) * height};
  return points;
}

/// Marks texels, band by band of rows. Those that are marked are passed over at once, however many
/// triangles show them.
class ShownTexels::Marker {
 public:
  Marker(ShownTexels& shown, std::uint32_t height, std::span<const CornerTexcoords> corners)
      : shown_(shown),
        corners_(corners),
        height_(height),
        band_rows_(std::max(kBandTexels / shown.width_, 1U)),
        is_seen_(corners.size()) {
    order_.resize(corners.size());
    std::iota(order_.begin(), order_.end(), 0U);
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return top(a) < top(b); });
  }

  void operator()() {
    for (std::uint32_t begin = 0; begin < height_; begin += band_rows_)
      mark_band({begin, std::min(begin + band_rows_, height_)});
    for (std::uint32_t t = 0; t < corners_.size(); ++t) {
      if (!is_seen_[t])
        shown_.is_shown_[texel_at(middle_of(points(t)), shown_.width_, height_)] = true;
    }
  }

 private:
  std::array<TexelPoint, 3> points(std::uint32_t t) const {
    return in_texels(corners_[t], shown_.width_, height_);
  }
  /// In rows; what is no number begins above all.
  double top(std::uint32_t t) const {
    const float v = std::min({corners_[t][0].v, corners_[t][1].v, corners_[t][2].v});
    return v == v ? double(v) * height_ : 0;
  }
  double bottom(std::uint32_t t) const {
    return double(std::max({corners_[t][0].v, corners_[t][1].v, corners_[t][2].v})) * height_;
  }

  /// Marks what triangles that reach into the band show of it. Bands come in order.
  void mark_band(const RowRange& rows) {
    first_ = std::size_t{rows.begin} * shown_.width_;
    next_.resize(std::size_t{rows.end - rows.begin} * shown_.width_ + 1);
    std::iota(next_.begin(), next_.end(), 0U);
    for (; begun_ < order_.size() && top(order_[begun_]) <= rows.end; ++begun_)
      open_.push_back(order_[begun_]);
    std::erase_if(open_, [&](std::uint32_t t) { return bottom(t) < rows.begin; });
    for (const std::uint32_t t : open_)
      mark(t, rows);
  }

  void mark(std::uint32_t t, const RowRange& rows) {
    RasterTriangle(points(t)).for_each_span(
        shown_.width_, rows, [&](std::uint32_t y, std::uint32_t begin, std::uint32_t end) {
          is_seen_[t] = true;
          const std::size_t row = std::size_t{y} * shown_.width_ - first_;
          for (std::size_t at = find_next(row + begin); at < row + end; at = find_next(at)) {
            shown_.is_shown_[first_ + at] = true;
            next_[at] = static_cast<std::uint32_t>(at + 1);
          }
        });
  }
  /// The next texel of the band from `at` on that is not marked.
  std::size_t find_next(std::size_t at) {
    while (next_[at] != at) {
      next_[at] = next_[next_[at]];
      at = next_[at];
    }
    return at;
  }

  ShownTexels& shown_;
  std::span<const CornerTexcoords> corners_;
  std::uint32_t height_, band_rows_;
  std::vector<bool> is_seen_;  ///< of triangles: one that has texels
  std::vector<std::uint32_t> order_, open_, next_;
  std::size_t begun_ = 0, first_ = 0;
};

ShownTexels::ShownTexels(std::uint32_t width, std::uint32_t height,
                         std::span<const CornerTexcoords> corners)
    : width_(width), is_shown_(std::size_t{width} * height) {
  Marker(*this, height, corners)();
}

}  // namespace meshhier::texture
