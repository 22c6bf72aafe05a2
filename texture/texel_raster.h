// Which texels a triangle covers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace meshhier::texture {

/// In texels; the middle of the first one is (0.5, 0.5).
struct TexelPoint {
  double x = 0, y = 0;
};

/// Loops over texels ask for memory that they need so many texels later.
inline constexpr std::size_t kAhead = 8;

struct TexelRange {
  std::uint32_t left = 0, top = 0, right = 0, bottom = 0;
};

/// Returns the texels of a range from `before` ahead of (x, y) to `behind` it, along both axes.
inline TexelRange texels_near(const TexelRange& range, std::uint32_t x, std::uint32_t y,
                              std::uint32_t before, std::uint32_t behind) {
  return {std::max(x, range.left + before) - before, std::max(y, range.top + before) - before,
          std::min(x + behind + 1, range.right), std::min(y + behind + 1, range.bottom)};
}

/// Returns whether visit(x, y) is true for a texel of a range, and visits none after it.
template <class Visit>
bool any_texel(const TexelRange& range, const Visit& visit) {
  for (std::uint32_t y = range.top; y < range.bottom; ++y) {
    for (std::uint32_t x = range.left; x < range.right; ++x) {
      if (visit(x, y))
        return true;
    }
  }
  return false;
}

/// Calls visit(x, y) for all texels of a range, row by row.
template <class Visit>
void for_each_texel(const TexelRange& range, const Visit& visit) {
  for (std::uint32_t y = range.top; y < range.bottom; ++y) {
    for (std::uint32_t x = range.left; x < range.right; ++x)
      visit(x, y);
  }
}

/// In 1/256 of a texel.
struct FixedTexelPoint {
  static constexpr std::int64_t kOne = 256;

  std::int64_t x = 0, y = 0;

  static FixedTexelPoint of(const TexelPoint& point) {
    return {rounded(point.x), rounded(point.y)};
  }
  static std::int64_t rounded(double at) {
    constexpr double kMost = 1 << 16;
    const double rounded = std::clamp(at, -kMost, kMost) * kOne + 0.5;
    const auto whole = static_cast<std::int64_t>(rounded);
    return whole - (static_cast<double>(whole) > rounded ? 1 : 0);
  }
};

/// A triangle in 1/256 of a texel: there whole numbers tell exactly on which side of an edge a
/// middle is, so triangles that share an edge never cover the same texel, and leave none out.
class RasterTriangle {
 public:
  using Fixed = FixedTexelPoint;

  explicit RasterTriangle(const std::array<TexelPoint, 3>& corners)
      : RasterTriangle({Fixed::of(corners[0]), Fixed::of(corners[1]), Fixed::of(corners[2])}) {}
  explicit RasterTriangle(const std::array<Fixed, 3>& corners) : corners_(corners) {
    const Fixed &a = corners_[0], &b = corners_[1], &c = corners_[2];
    twice_area_ = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
  }

  /// In squares of 1/256 texel; below 0 if the corners turn the other way.
  std::int64_t twice_area() const { return twice_area_; }

  /// Calls visit(x, y, part of the second corner, part of the third) for each of those texels whose
  /// middle is inside. O(rows + texels).
  template <class Visit>
  void for_each(const TexelRange& range, const Visit& visit) const {
    for_each_span(range, [&](std::uint32_t y, std::uint32_t begin, std::uint32_t end) {
      const double scale = 1 / static_cast<double>(std::abs(twice_area_));
      const Edge to_b = edge(2, 0), to_c = edge(0, 1);
      // Whole numbers still, far below 2^53.
      auto b = static_cast<double>(to_b.at(middle(begin), middle(y)));
      auto c = static_cast<double>(to_c.at(middle(begin), middle(y)));
      const auto step_b = static_cast<double>(to_b.dx * kOne);
      const auto step_c = static_cast<double>(to_c.dx * kOne);
      for (std::uint32_t x = begin; x < end; ++x, b += step_b, c += step_c)
        visit(x, y, b * scale, c * scale);
    });
  }

  /// Likewise in a picture of that size.
  template <class Visit>
  void for_each(std::uint32_t width, std::uint32_t height, const Visit& visit) const {
    for_each(TexelRange{0, 0, width, height}, visit);
  }

  /// Calls visit(y, begin, end) for each row of the range that has texels, x in [begin, end).
  template <class Visit>
  void for_each_span(const TexelRange& all, const Visit& visit) const {
    const std::array<std::int64_t, 2> columns = range(all.left, all.right, &Fixed::x);
    const std::array<std::int64_t, 2> lines = range(all.top, all.bottom, &Fixed::y);
    if (twice_area_ == 0 || columns[0] > columns[1] || lines[0] > lines[1])
      return;
    const std::array<Edge, 3> edges = {edge(1, 2), edge(2, 0), edge(0, 1)};
    for (std::int64_t y = lines[0]; y <= lines[1]; ++y) {
      std::array<std::int64_t, 2> inside = columns;
      for (const Edge& side : edges)
        side.cut(y, inside);
      if (inside[0] <= inside[1])
        visit(static_cast<std::uint32_t>(y), static_cast<std::uint32_t>(inside[0]),
              static_cast<std::uint32_t>(inside[1] + 1));
    }
  }

 private:
  static constexpr std::int64_t kOne = Fixed::kOne;
  /// dx * x + dy * y + offset is twice the area on it: >= least on its inner side.
  struct Edge {
    std::int64_t dx, dy, offset, least;
    double texels;  ///< of a row, for each 1 of twice the area: 1 / (|dx| * kOne), or infinite
    std::int64_t at(std::int64_t x, std::int64_t y) const { return dx * x + dy * y + offset; }
    /// Takes the texels of a row from `columns`, first and last, that are beyond.
    void cut(std::int64_t row, std::array<std::int64_t, 2>& columns) const {
      const std::int64_t missing = least - at(kOne / 2, middle(row));
      if (dx > 0)
        columns[0] = std::max(columns[0], -floor_divided(-missing, dx * kOne, texels));
      else if (dx < 0)
        columns[1] = std::min(columns[1], floor_divided(-missing, -dx * kOne, texels));
      else if (missing > 0)
        columns[1] = columns[0] - 1;
    }
  };

  /// `by` > 0.
  static std::int64_t floor_divided(std::int64_t what, std::int64_t by) {
    return what >= 0 ? what / by : -((by - 1 - what) / by);
  }
  /// Without a division; `inverse`: 1 / by, about. Requires |what / by| < 2^50.
  static std::int64_t floor_divided(std::int64_t what, std::int64_t by, double inverse) {
    auto quotient = static_cast<std::int64_t>(static_cast<double>(what) * inverse);
    const std::int64_t rest = what - quotient * by;
    quotient += std::int64_t{rest >= by} - std::int64_t{rest < 0};
    return quotient;
  }
  static std::int64_t middle(std::int64_t texel) { return texel * kOne + kOne / 2; }

  /// The texels whose middles are not left of all corners, nor right of all.
  std::array<std::int64_t, 2> range(std::uint32_t begin, std::uint32_t end,
                                    std::int64_t Fixed::*axis) const {
    const auto [low, high] = std::minmax({corners_[0].*axis, corners_[1].*axis, corners_[2].*axis});
    return {std::max<std::int64_t>(floor_divided(low + kOne / 2 - 1, kOne), begin),
            std::min<std::int64_t>(floor_divided(high - kOne / 2, kOne), std::int64_t{end} - 1)};
  }

  /// Middles on it belong to the triangle that it is the upper or the left edge of.
  Edge edge(std::size_t from, std::size_t to) const {
    const std::int64_t turn = twice_area_ < 0 ? -1 : 1;
    const Fixed &a = corners_[from], &b = corners_[to];
    const std::int64_t dx = (a.y - b.y) * turn, dy = (b.x - a.x) * turn;
    const bool is_own = dx > 0 || (dx == 0 && dy > 0);
    return {dx, dy, -(dx * a.x + dy * a.y), is_own ? 0 : 1,
            1 / static_cast<double>(std::abs(dx) * kOne)};
  }

  std::array<Fixed, 3> corners_;
  std::int64_t twice_area_ = 0;
};

}  // namespace meshhier::texture
