#include "export/pixel_grid.h"

#include "base/error.h"
#include "render/plan_raster.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace meshhier::exporting {
namespace {

/// Pixels of one axis, counted from the corner.
struct PixelSpan {
  double first = 0, end = 0;

  double count() const { return end - first; }
};

PixelSpan pixels_over(double least, double most, double size, double corner) {
  constexpr double kRounding = 1.0 / 512;
  const double first = std::floor((least - corner) / size + kRounding);
  const double end = std::ceil((most - corner) / size - kRounding);
  return {first, std::max(end, first + 1)};
}

}  // namespace

PixelGrid grid_over(const BoundsD& box, double size, PlanPoint corner) {
  const PixelSpan across = pixels_over(box.min.x, box.max.x, size, corner.x);
  const PixelSpan upward = pixels_over(box.min.y, box.max.y, size, corner.y);
  const double most = std::max(across.count(), upward.count());
  if (!(most <= render::kMostPlanSide)) {
    const double least = size * most / render::kMostPlanSide;
    throw Error(
        ErrorCode::usage,
        fmt::format("pixels of {:.6g} would be {:.6g} x {:.6g}, and a side has at most {}; give "
                    "--gsd {:.2g} or more, or a smaller --box",
                    size, across.count(), upward.count(), render::kMostPlanSide, 1.05 * least));
  }
  return {corner.x + across.first * size, corner.y + upward.end * size, size,
          static_cast<std::uint32_t>(across.count()), static_cast<std::uint32_t>(upward.count())};
}

}  // namespace meshhier::exporting
