// Where the label of a line stands: at its middle, along it, and so that it can be read.
#pragma once

#include "drawing/line_store.h"
#include "export/plan_region.h"

#include <cmath>
#include <optional>

namespace meshhier::drawing {

struct LineLabel {
  exporting::PlanPoint at{};
  exporting::PlanPoint along{1, 0};  ///< of length 1, to the right
};

/// Follows a line in the coordinates of whoever asks.
class LabelFinder {
 public:
  /// `half`: of the line's length, in units of the places.
  explicit LabelFinder(double half) : left_(half) {}

  void pass(exporting::PlanPoint place) {
    if (last_ && !label_) {
      const double x = place.x - last_->x, y = place.y - last_->y;
      const double step = std::sqrt(x * x + y * y);
      if (step > 0 && step >= left_) {
        const double part = left_ / step, sign = x < 0 ? -1 : 1;
        label_ = {{last_->x + part * x, last_->y + part * y}, {sign * x / step, sign * y / step}};
      }
      left_ -= step;
    }
    last_ = place;
  }
  /// Returns nothing if the line is shorter than it was said to be.
  const std::optional<LineLabel>& label() const { return label_; }

 private:
  double left_;
  std::optional<exporting::PlanPoint> last_{};
  std::optional<LineLabel> label_{};
};

}  // namespace meshhier::drawing
