#include "texture/chart_overlap.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace meshhier::texture {
namespace {

/// A whole number of parts that advances by the same number of parts again and again.
class Quotient {
 public:
  Quotient(std::int64_t value, std::int64_t step, std::int64_t by)
      : by_(by), whole_(floored(value, by)), rest_(value - whole_ * by) {
    step_whole_ = floored(step, by);
    step_rest_ = step - step_whole_ * by;
  }
  std::int64_t whole() const { return whole_; }
  void advance() {
    whole_ += step_whole_;
    rest_ += step_rest_;
    if (rest_ >= by_) {
      rest_ -= by_;
      ++whole_;
    }
  }

 private:
  static std::int64_t floored(std::int64_t what, std::int64_t by) {
    return what / by - (what % by < 0 ? 1 : 0);
  }

  std::int64_t by_, whole_, rest_, step_whole_ = 0, step_rest_ = 0;
};

/// A chart of more is drawn: 2 MB.
constexpr std::size_t kMostCrossings = std::size_t{1} << 18;

/// The first row or column whose middle is not before it.
std::int64_t first_middle(std::int64_t at) {
  constexpr std::int64_t kOne = FixedTexelPoint::kOne;
  return (at + kOne / 2 - 1) >> 8;
}

}  // namespace

/// The chart begins at edges that go up, and ends at those that go down.
void ChartOverlap::add_crossings(const FixedTexelPoint& from, const FixedTexelPoint& to,
                                 const TexelRange& all) {
  constexpr std::int64_t kOne = FixedTexelPoint::kOne;
  const bool begins = from.y > to.y;
  const FixedTexelPoint &top = begins ? to : from, &bottom = begins ? from : to;
  const std::int64_t first = std::max<std::int64_t>(first_middle(top.y), all.top);
  const std::int64_t end = std::min<std::int64_t>(first_middle(bottom.y), all.bottom);
  if (first >= end)
    return;
  const std::int64_t height = bottom.y - top.y, by = kOne * height;
  const std::int64_t down = first * kOne + kOne / 2 - top.y;
  const std::int64_t at = (top.x - kOne / 2) * height + down * (bottom.x - top.x);
  Quotient column(at + by - 1, kOne * (bottom.x - top.x), by);
  for (std::int64_t row = first; row < end; ++row, column.advance()) {
    const auto shown = std::clamp<std::int64_t>(column.whole(), all.left, all.right);
    crossings_.push_back(static_cast<std::uint64_t>(row) << 32 |
                         static_cast<std::uint64_t>(shown) << 1 | (begins ? 1U : 0U));
  }
}

TexelRange ChartOverlap::twice_wound() {
  constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
  TexelRange found{kMost, kMost, 0, 0};
  std::sort(crossings_.begin(), crossings_.end());
  int winding = 0;
  for (std::size_t i = 0; i + 1 < crossings_.size(); ++i) {
    winding += (crossings_[i] & 1) != 0 ? 1 : -1;
    if (winding < 2 || crossings_[i] >> 1 == crossings_[i + 1] >> 1)
      continue;
    const auto row = static_cast<std::uint32_t>(crossings_[i] >> 32);
    const auto column = [&](std::size_t at) {
      return static_cast<std::uint32_t>(crossings_[at]) >> 1;
    };
    found = {std::min(found.left, column(i)), std::min(found.top, row),
             std::max(found.right, column(i + 1)), std::max(found.bottom, row + 1)};
  }
  return found.left < found.right ? found : TexelRange{};
}

TexelRange ChartOverlap::operator()(std::span<const std::uint32_t> chart,
                                    std::span<const FixedTexelPoint> places,
                                    const TexelRange& all) {
  ++chart_;
  crossings_.clear();
  for (const std::uint32_t t : chart)
    chart_of_[t] = chart_;
  for (const std::uint32_t t : chart) {
    const std::array<FixedTexelPoint, 3> at = {places[raw(triangles_[t][0])],
                                               places[raw(triangles_[t][1])],
                                               places[raw(triangles_[t][2])]};
    if (RasterTriangle(at).twice_area() < 0 || crossings_.size() > kMostCrossings)
      return all;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t other = faces_.across[t][k];
      if (other == kNoFace || chart_of_[other] != chart_)
        add_crossings(at[k], at[(k + 1) % 3], all);
    }
  }
  return twice_wound();
}

}  // namespace meshhier::texture
