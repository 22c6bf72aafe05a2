// A drawing on paper: its scale, its margins, the grid of coordinates and the scale bar.
//
//     +--------------------------------+
//     |  margin                        |      all in millimetres from the top left corner
//     |   +------------------------+   |
//     |   |   what is drawn        |   |
//     |   |     |       |          |   |
//     | 20|-----+-------+----------|   |
//     |   |     |       |          |   |
//     |   +------------------------+   |
//     |        100     120             |
//     |   |===|   |===|   5 m  1:50    |
//     +--------------------------------+
#pragma once

#include "base/bounds.h"
#include "export/plan_region.h"
#include "hierarchy/length.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::drawing {

using exporting::PlanPoint;

/// What is asked for of the paper.
struct PaperRequest {
  std::optional<double> scale{};  ///< N of 1:N; none: the largest round one that fits on A4
  bool has_grid = false;
  std::optional<Length> grid{};  ///< between its lines, units of the sheet; none: a round length
  bool has_bar = true;
};

/// The unit of a sheet's coordinates.
struct SheetUnit {
  double metres = 0;        ///< 0: not known
  std::string_view name{};  ///< "m"
};

struct PaperLine {
  PlanPoint from{}, to{};
  double width = 0;
};
struct PaperText {
  enum class Anchor { start, middle, end };
  PlanPoint at{};  ///< of its base line
  std::string text{};
  Anchor anchor = Anchor::start;
};
inline constexpr double kTextHeight = 2.5;

/// What is drawn besides the model.
struct PaperMarks {
  std::vector<PaperLine> grid{}, bar{};
  std::vector<PaperText> texts{};
};

struct Paper {
  double scale = 1;              ///< N of 1:N
  double mm_per_unit = 1;        ///< of the sheet's coordinates
  double left = 0, top = 0;      ///< in the sheet's coordinates, where the margin ends
  double width = 0, height = 0;  ///< with margins
  double inner_width = 0, inner_height = 0;
  double margin = 0;
  PaperMarks marks{};

  /// Returns the place on the paper of coordinates of the sheet.
  PlanPoint on_paper(double u, double v) const {
    return {margin + (u - left) * mm_per_unit, margin + (top - v) * mm_per_unit};
  }
};

/// Returns the paper for what lies in the box; z does not count. Throws Error(usage) if the unit is
/// not known, if the drawing would be smaller than a millimetre or larger than a kilometre, with
/// scales that would do, or if the grid would have too many lines.
Paper paper_for(const BoundsD& box, const SheetUnit& unit, const PaperRequest& request);

/// Returns the greatest of 1, 2 and 5 times a power of ten that is at most `most`, which is above
/// 0.
double round_length(double most);
/// Returns the least of these that is at least `least`, which is above 0.
double least_round_length(double least);

/// Returns "1:50", or "2:1" of 0.5.
std::string scale_text(double scale);

/// Returns a multiple of `step`, a round length, with the digits that it needs.
std::string coordinate_text(double value, double step);

}  // namespace meshhier::drawing
