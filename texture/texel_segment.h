// Texels along a line.
#pragma once

#include "texture/texel_raster.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace meshhier::texture {

class TexelSegment {
 public:
  TexelSegment(const TexelPoint& from, const TexelPoint& to)
      : from_(from), dx_(to.x - from.x), dy_(to.y - from.y), squared_(dx_ * dx_ + dy_ * dy_) {}

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
    const auto [top, bottom] = rounded(from_.y + std::min(dy_, 0.0), from_.y + std::max(dy_, 0.0),
                                       range.top, range.bottom);
    for (std::uint32_t y = top; y < bottom; ++y) {
      const auto [left, right] = columns(y, range);
      for (std::uint32_t x = left; x < right; ++x) {
        if (!is_asked(x, y))
          continue;
        if (const Foot at = foot(x, y); at.distance <= kFarthest)
          visit(x, y, at);
      }
    }
  }

 private:
  static constexpr double kFarthest = 2;  // squared

  struct Ends {
    std::uint32_t begin, end;
  };
  /// The texels whose middles are less than one off from [low, high].
  static Ends rounded(double low, double high, std::uint32_t least, std::uint32_t end) {
    return {static_cast<std::uint32_t>(std::clamp<double>(std::floor(low - 0.5), least, end)),
            static_cast<std::uint32_t>(std::clamp<double>(std::ceil(high + 0.5), least, end))};
  }
  /// The columns of the part of the line that is near a row.
  Ends columns(std::uint32_t y, const TexelRange& range) const {
    double first = 0, last = 1;
    if (dy_ != 0) {
      const double a = (y - 0.5 - from_.y) / dy_, b = (y + 1.5 - from_.y) / dy_;
      first = std::clamp(std::min(a, b), 0.0, 1.0);
      last = std::clamp(std::max(a, b), 0.0, 1.0);
    }
    const double x = from_.x + dx_ * first, other = from_.x + dx_ * last;
    return rounded(std::min(x, other), std::max(x, other), range.left, range.right);
  }
  Foot foot(std::uint32_t x, std::uint32_t y) const {
    const double to_x = x + 0.5 - from_.x, to_y = y + 0.5 - from_.y;
    const double along = to_x * dx_ + to_y * dy_;
    Foot result;
    result.part = along > 0 ? std::min(along / squared_, 1.0) : 0;
    result.off_x = to_x - result.part * dx_;
    result.off_y = to_y - result.part * dy_;
    result.distance = result.off_x * result.off_x + result.off_y * result.off_y;
    return result;
  }

  TexelPoint from_;
  double dx_, dy_, squared_;
};

}  // namespace meshhier::texture
