// Lines of some width over the pixels of a window, with soft edges and round ends.
//
// Idea. A pixel's share is how near its middle is to the line; of several lines of one colour the
// largest share counts. So neither their order nor the windows show: lines of two tiles meet
// without a seam, and a line drawn twice is drawn once.
//
// Cost. For each line the pixels near it: rows within its box, and of each the part beside it.
#pragma once

#include "export/plan_region.h"
#include "render/plan_raster.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::drawing {

/// Lines of one colour. For one thread.
class StrokeMask {
 public:
  explicit StrokeMask(const render::PlanWindow& window) : window_(window) {}

  /// Draws a line between two places, in pixels of the whole raster: (0, 0) is its corner. Narrower
  /// than a pixel it is a pixel wide, and fainter.
  void draw(exporting::PlanPoint from, exporting::PlanPoint to, double width);

  /// Lays the lines over pixels of red, green, blue and alpha.
  void lay_on(std::span<std::uint8_t> pixels, const std::array<std::uint8_t, 3>& colour,
              double opacity = 1) const;

 private:
  render::PlanWindow window_;
  std::vector<std::uint8_t> shares_;  ///< empty: nothing is drawn
};

}  // namespace meshhier::drawing
