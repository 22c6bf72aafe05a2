#include "drawing/strokes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace meshhier::drawing {
namespace {

using exporting::PlanPoint;

/// A line around whose middle pixels are covered.
struct Stroke {
  PlanPoint from, to;
  double reach;  ///< beyond it no pixel has a share
  double across, down, size;

  Stroke(PlanPoint a, PlanPoint b, double half)
      : from(a), to(b), reach(half + 0.5), across(b.x - a.x), down(b.y - a.y) {
    size = std::sqrt(across * across + down * down);
  }

  double distance(PlanPoint p) const {
    const double x = p.x - from.x, y = p.y - from.y;
    const double part =
        size > 0 ? std::clamp((x * across + y * down) / (size * size), 0.0, 1.0) : 0.0;
    const double dx = x - part * across, dy = y - part * down;
    return std::sqrt(dx * dx + dy * dy);
  }

  /// Returns the least and greatest x that may be near the line in a row whose middle is at y.
  std::pair<double, double> span_at(double y) const {
    double left = std::min(from.x, to.x) - reach, right = std::max(from.x, to.x) + reach;
    if (std::abs(down) > 1e-9 * size) {
      const double middle = from.x + (y - from.y) * across / down;
      const double half = reach * size / std::abs(down);
      left = std::max(left, middle - half);
      right = std::min(right, middle + half);
    }
    return {left, right};
  }
};

/// Pixels [first, end) of a window's axis whose middles lie between two places.
std::pair<std::int64_t, std::int64_t> pixels_between(double least, double most, std::uint32_t begin,
                                                     std::uint32_t count) {
  const double low = std::clamp(least - 0.5 - begin, -1.0, double{1} * count);
  const double high = std::clamp(most - 0.5 - begin, -1.0, double{1} * count);
  return {std::max<std::int64_t>(static_cast<std::int64_t>(std::ceil(low)), 0),
          std::min<std::int64_t>(static_cast<std::int64_t>(std::floor(high)) + 1, count)};
}

}  // namespace

void StrokeMask::draw(PlanPoint from, PlanPoint to, double width) {
  const double half = std::max(width, 1.0) / 2, strength = 255 * std::min(width, 1.0);
  const Stroke stroke(from, to, half);
  const auto [top, bottom] =
      pixels_between(std::min(from.y, to.y) - stroke.reach, std::max(from.y, to.y) + stroke.reach,
                     window_.row, window_.height);
  for (std::int64_t row = top; row < bottom; ++row) {
    const double y = static_cast<double>(row + window_.row) + 0.5;
    const auto [left, right] = stroke.span_at(y);
    const auto [first, end] = pixels_between(left, right, window_.column, window_.width);
    for (std::int64_t column = first; column < end; ++column) {
      const double x = static_cast<double>(column + window_.column) + 0.5;
      const double share = std::clamp(stroke.reach - stroke.distance({x, y}), 0.0, 1.0);
      if (!(share > 0))
        continue;
      if (shares_.empty())
        shares_.resize(std::size_t{window_.width} * window_.height);
      std::uint8_t& pixel = shares_[static_cast<std::size_t>(row * window_.width + column)];
      pixel = std::max(pixel, static_cast<std::uint8_t>(share * strength + 0.5));
    }
  }
}

void StrokeMask::lay_on(std::span<std::uint8_t> pixels, const std::array<std::uint8_t, 3>& colour,
                        double opacity) const {
  const auto most = static_cast<std::uint32_t>(opacity * 255 + 0.5);
  for (std::size_t i = 0; i < shares_.size(); ++i) {
    const std::uint32_t over = shares_[i] * most / 255;
    if (over == 0)
      continue;
    std::uint8_t* pixel = &pixels[4 * i];
    const std::uint32_t under = pixel[3] * (255 - over) / 255, alpha = over + under;
    for (std::size_t c = 0; c < 3; ++c) {
      pixel[c] =
          static_cast<std::uint8_t>((colour[c] * over + pixel[c] * under + alpha / 2) / alpha);
    }
    pixel[3] = static_cast<std::uint8_t>(alpha);
  }
}

}  // namespace meshhier::drawing
