#include "texture/chart_layout.h"

#include "texture/rect_packing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

namespace meshhier::texture {
namespace {

/// Rectangles of charts, in units of the alignment.
class Fitter {
 public:
  Fitter(std::vector<ChartPlane> planes, const BakeSize& size)
      : planes_(std::move(planes)), units_(size.side / kBakeAlignment) {
    choose_points();
    for (const ChartPlane& plane : planes_) {
      longest_ = std::max({longest_, plane.width, plane.height});
      area_ += plane.width * plane.height;
    }
    const double room = size.side - 2 * kBakeGutter;
    most_density_ = longest_ > 0 ? room / longest_ : 1;
    if (size.least_texel > 0)
      most_density_ = std::min(most_density_, 1 / double(size.least_texel));
  }

  ChartLayout operator()() && {
    double density = most_density_;
    std::optional<RectPacking> packing = pack_tightly(sizes(density), units_);
    if (!packing)
      std::tie(density, packing) = search();
    return placed(density, *packing);
  }

 private:
  /// The smallest charts are points if the others would have no room else. Points beyond a part of
  /// the picture share a place.
  void choose_points() {
    const double cells = double(units_) * units_;
    const double count = static_cast<double>(planes_.size());
    if (kCellsOfChart * count <= kCells * cells)
      return;
    const double left = (kCells * cells - count) / (kCellsOfChart - 1);
    const auto charts = static_cast<std::size_t>(std::max(left, cells / 16));
    std::vector<std::uint32_t> order(planes_.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto size = [&](std::uint32_t c) {
      return std::pair(planes_[c].width * planes_[c].height, planes_[c].width);
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return size(a) > size(b); });
    const std::size_t places = charts + static_cast<std::size_t>(kCells * cells);
    for (std::size_t i = charts; i < order.size(); ++i) {
      ChartPlane& plane = planes_[order[i]];
      plane.is_point = true;
      plane.width = plane.height = 0;
      if (i >= places)
        shared_.push_back(order[i]);
    }
    std::sort(shared_.begin(), shared_.end());
  }

  std::uint32_t units(double length, double density) const {
    const double texels = std::ceil(length * density) + 2 * kBakeGutter;
    return static_cast<std::uint32_t>(std::ceil(texels / kBakeAlignment));
  }
  std::vector<RectSize> sizes(double density) const {
    std::vector<RectSize> sizes;
    sizes.reserve(planes_.size());
    for (const ChartPlane& plane : planes_)
      sizes.push_back({units(plane.width, density), units(plane.height, density)});
    for (const std::uint32_t chart : shared_)
      sizes[chart] = {0, 0};
    return sizes;
  }

  /// Between a density at which all fit and one at which they do not. At the lowest one no chart
  /// has more than 2 * 2 units.
  std::pair<double, RectPacking> search() const {
    constexpr double kClose = 1.01, kFull = 0.75;
    const double side = units_ * kBakeAlignment;
    double low = kBakeAlignment / longest_, high = most_density_;
    RectPacking best = pack_into({units_, units_}, sizes(low)).value();
    double next = area_ > 0 ? side * std::sqrt(kFull / area_) : 0;
    while (high > low * kClose) {
      if (!(next > low && next < high))
        next = std::sqrt(low * high);
      if (std::optional<RectPacking> packing = pack_into({units_, units_}, sizes(next))) {
        low = next;
        best = *std::move(packing);
      } else {
        high = next;
      }
    }
    return {low, std::move(best)};
  }

  ChartLayout placed(double density, const RectPacking& packing) {
    ChartLayout layout{
        packing.width * kBakeAlignment, packing.height * kBakeAlignment, density, {}};
    for (std::size_t c = 0; c < planes_.size(); ++c) {
      ChartPlane& plane = planes_[c];
      plane.left = packing.places[c].x * kBakeAlignment;
      plane.top = packing.places[c].y * kBakeAlignment;
      plane.right = plane.left + units(plane.width, density) * kBakeAlignment;
      plane.bottom = plane.top + units(plane.height, density) * kBakeAlignment;
    }
    const auto first = std::ranges::find(planes_, true, &ChartPlane::is_point);
    for (const std::uint32_t chart : shared_) {
      planes_[chart].left = first->left;
      planes_[chart].top = first->top;
      planes_[chart].right = first->right;
      planes_[chart].bottom = first->bottom;
    }
    layout.planes = std::move(planes_);
    return layout;
  }

  /// The smallest charts have at most this part of the picture's cells, units squared.
  static constexpr double kCells = 0.6;
  static constexpr double kCellsOfChart = 4;

  std::vector<ChartPlane> planes_;
  std::uint32_t units_;
  std::vector<std::uint32_t> shared_;  ///< points without a place of their own
  double longest_ = 0, area_ = 0, most_density_ = 1;
};

}  // namespace

TexelPoint ChartLayout::texel_of(const ChartPlane& plane, const Vec3d& position) const {
  if (plane.is_point)
    return {plane.left + kBakeAlignment / 2.0, plane.top + kBakeAlignment / 2.0};
  return {plane.left + kBakeGutter + density * (dot(position, plane.x) - plane.low_x),
          plane.top + kBakeGutter + density * (dot(position, plane.y) - plane.low_y)};
}

ChartLayout lay_out(std::vector<ChartPlane> planes, const BakeSize& size) {
  return Fitter(std::move(planes), size)();
}

}  // namespace meshhier::texture
