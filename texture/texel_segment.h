// Texels along a line.
#pragma once

#include "texture/texel_raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace meshhier::texture {

/// The texels of [least, end) whose middles are less than one off from [low, high].
struct NearTexels {
  std::uint32_t begin, end;

  NearTexels(double low, double high, std::uint32_t least, std::uint32_t most)
      : begin(static_cast<std::uint32_t>(std::clamp<double>(low - 0.5, least, most))) {
    const double last = std::clamp<double>(high + 0.5, least, most);
    end = static_cast<std::uint32_t>(last);
    end += end < last ? 1 : 0;
  }
};

/// The part of a range in which TexelSegment::for_each_near() looks for the edges of a triangle.
inline TexelRange near_texels(const std::array<TexelPoint, 3>& at, const TexelRange& range) {
  const NearTexels x(std::min({at[0].x, at[1].x, at[2].x}), std::max({at[0].x, at[1].x, at[2].x}),
                     range.left, range.right);
  const NearTexels y(std::min({at[0].y, at[1].y, at[2].y}), std::max({at[0].y, at[1].y, at[2].y}),
                     range.top, range.bottom);
  return {x.begin, y.begin, x.end, y.end};
}

class TexelSegment {
 public:
  TexelSegment(const TexelPoint& from, const TexelPoint& to)
      : from_(from), dx_(to.x - from.x), dy_(to.y - from.y) {
    const double squared = dx_ * dx_ + dy_ * dy_;
    part_ = squared > 0 ? 1 / squared : 0;
    row_part_ = std::abs(dy_) > kLevel ? 1 / dy_ : 0;
  }

  /// The nearest point of the line to the middle of a texel.
  struct Foot {
    double part = 0;              ///< of the line up to there
    double off_x = 0, off_y = 0;  ///< from there to the middle
    double distance = 0;          ///< squared
  };

  /// Calls visit(x, y, foot) for the texels of the range that is_asked(x, y), and that show at a
  /// point of the line if they are filtered: not farther than a texel on both axes. O(their number
  /// + rows).
  template <class IsAsked, class Visit>
  void for_each_near(const TexelRange& range, const IsAsked& is_asked, const Visit& visit) const {
    const NearTexels rows(from_.y + std::min(dy_, 0.0), from_.y + std::max(dy_, 0.0), range.top,
                          range.bottom);
    for (std::uint32_t y = rows.begin; y < rows.end; ++y) {
      const NearTexels row = columns(y, range);
      for (std::uint32_t x = row.begin; x < row.end; ++x) {
        if (!is_asked(x, y))
          continue;
        if (const Foot at = foot(x, y); at.distance <= kFarthest)
          visit(x, y, at);
      }
    }
  }

 private:
  static constexpr double kFarthest = 2;  // squared
  static constexpr double kLevel = 1e-9;  // texels

  /// The columns of the part of the line that is near a row.
  NearTexels columns(std::uint32_t y, const TexelRange& range) const {
    double first = 0, last = 1;
    if (row_part_ != 0) {
      const double a = (y - 0.5 - from_.y) * row_part_, b = (y + 1.5 - from_.y) * row_part_;
      first = std::clamp(std::min(a, b), 0.0, 1.0);
      last = std::clamp(std::max(a, b), 0.0, 1.0);
    }
    const double x = from_.x + dx_ * first, other = from_.x + dx_ * last;
    return {std::min(x, other), std::max(x, other), range.left, range.right};
  }
  Foot foot(std::uint32_t x, std::uint32_t y) const {
    const double to_x = x + 0.5 - from_.x, to_y = y + 0.5 - from_.y;
    const double along = to_x * dx_ + to_y * dy_;
    Foot result;
    result.part = along > 0 ? std::min(along * part_, 1.0) : 0;
    result.off_x = to_x - result.part * dx_;
    result.off_y = to_y - result.part * dy_;
    result.distance = result.off_x * result.off_x + result.off_y * result.off_y;
    return result;
  }

  TexelPoint from_;
  double dx_, dy_;
  double part_;      ///< of the line for each square unit along it; 0 if it has no length
  double row_part_;  ///< of the line for each row; 0 if it is level
};

}  // namespace meshhier::texture
