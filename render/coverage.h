// Which samples of a grid a triangle covers, decided in integers (Pineda, A parallel algorithm for
// polygon rasterization, 1988).
//
// Corners are snapped to 1/256 of a sample. A sample on an edge belongs to the triangle to its
// right or below: of two triangles that share an edge exactly one covers it.
#pragma once

#include "base/vec.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace meshhier::render {

/// A place within a triangle as shares of its corners: their sum is 1.
using Weights = std::array<double, 3>;

/// In steps, of which a sample has kSteps.
struct GridPoint {
  std::int64_t x = 0, y = 0;
};
inline constexpr std::int64_t kSteps = 256;

/// A place on the grid of samples, x to the right and y down; z does not count. What is off by more
/// than 2^20 samples is moved there: products of two distances stay below 2^60. Requires numbers.
inline GridPoint snapped(Vec3d place) {
  constexpr double kFarthest = 1 << 20;
  const auto steps = [&](double samples) {
    const double step = std::clamp(samples, -kFarthest, kFarthest) * kSteps + 0.5;
    const auto towards_zero = static_cast<std::int64_t>(step);
    return towards_zero - (static_cast<double>(towards_zero) > step ? 1 : 0);
  };
  return {steps(place.x), steps(place.y)};
}

/// The middle of sample 0, 1, ... along an axis.
constexpr std::int64_t middle_of(std::int64_t sample) {
  return sample * kSteps + kSteps / 2;
}

/// Samples [begin, end) of an axis.
struct SampleSpan {
  std::int64_t begin = 0, end = 0;
};

/// A row's samples are looked at by runs of so many: run i is [i * kRunSamples, ...).
inline constexpr std::int64_t kRunSamples = 64;

/// Those of [0, count) whose middles lie from step `least` to step `most`.
constexpr SampleSpan samples_between(std::int64_t least, std::int64_t most, std::int64_t count) {
  // The first sample whose middle is at `step` or behind it; before sample 0 any negative one.
  const auto first_from = [](std::int64_t step) {
    const std::int64_t raised = step + kSteps / 2 - 1;
    return raised >= 0 ? raised / kSteps : -1;
  };
  return {std::max<std::int64_t>(first_from(least), 0), std::min(first_from(most + 1), count)};
}

/// Columns and rows of samples.
struct SampleBox {
  SampleSpan across, down;

  constexpr bool empty() const { return across.begin >= across.end || down.begin >= down.end; }
};

/// Around the samples that a triangle may cover.
inline SampleBox box_of(const std::array<GridPoint, 3>& corners, std::int64_t columns,
                        std::int64_t rows) {
  const auto& [a, b, c] = corners;
  const auto [left, right] = std::minmax({a.x, b.x, c.x});
  const auto [top, bottom] = std::minmax({a.y, b.y, c.y});
  return {samples_between(left, right, columns), samples_between(top, bottom, rows)};
}

/// The line from a to b: positive to its right, as y goes down.
struct EdgeFunction {
  GridPoint a, b;

  constexpr std::int64_t operator()(GridPoint p) const {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
  }
  /// Its growth from one sample to the next.
  constexpr std::int64_t step_right() const { return -(b.y - a.y) * kSteps; }
  /// The same from one row to the next.
  constexpr std::int64_t step_down() const { return (b.x - a.x) * kSteps; }
  /// Its least value inside: points on the line are inside where the line goes up, or right.
  constexpr std::int64_t least() const { return b.y < a.y || (b.y == a.y && b.x > a.x) ? 0 : 1; }
};

/// Which samples on its edges a triangle covers.
enum class EdgeRule {
  one_owner,  ///< as above: none belongs to two triangles
  closed      ///< all, its corners too
};

/// Turned so that its inside is to the right of its edges.
class GridTriangle {
 public:
  explicit GridTriangle(std::array<GridPoint, 3> corners) : corners_(corners) {
    area_ = EdgeFunction{corners_[0], corners_[1]}(corners_[2]);
    mirrored_ = area_ < 0;
    if (mirrored_) {
      std::swap(corners_[1], corners_[2]);
      area_ = -area_;
    }
    share_ = 1 / static_cast<double>(area_);
  }

  /// Calls visit(column, row, weights) for each sample that it covers, row by row, but for the runs
  /// of which is_wanted(run, row) is false; it is asked of runs that the triangle may cover only.
  /// `box`: box_of() its corners.
  template <class IsWanted, class Visit>
  void visit(const SampleBox& box, const IsWanted& is_wanted, const Visit& visit,
             EdgeRule rule = EdgeRule::one_owner) const {
    if (area_ == 0)
      return;
    // Each edge is that opposite to a corner, and its value that corner's share of the area.
    const auto& [a, b, c] = corners_;
    const std::array<EdgeFunction, 3> edges{EdgeFunction{b, c}, EdgeFunction{c, a},
                                            EdgeFunction{a, b}};
    const GridPoint start{middle_of(box.across.begin), middle_of(box.down.begin)};
    Values values{edges[0](start), edges[1](start), edges[2](start)};
    const Values right{edges[0].step_right(), edges[1].step_right(), edges[2].step_right()};
    const Values down{edges[0].step_down(), edges[1].step_down(), edges[2].step_down()};
    const Values least = rule == EdgeRule::closed
                             ? Values{}
                             : Values{edges[0].least(), edges[1].least(), edges[2].least()};
    for (std::int64_t row = box.down.begin; row < box.down.end; ++row) {
      visit_row(row, box.across, values, right, least, is_wanted, visit);
      for (std::size_t i = 0; i < 3; ++i)
        values[i] += down[i];
    }
  }

 private:
  using Values = std::array<std::int64_t, 3>;

  /// `values`: of the first sample of `across`.
  template <class IsWanted, class Visit>
  void visit_row(std::int64_t row, SampleSpan across, const Values& values, const Values& right,
                 const Values& least, const IsWanted& is_wanted, const Visit& visit) const {
    for (std::int64_t begin = across.begin; begin < across.end;) {
      const std::int64_t run = begin / kRunSamples;
      const std::int64_t end = std::min(across.end, (run + 1) * kRunSamples);
      Values first;
      for (std::size_t i = 0; i < 3; ++i)
        first[i] = values[i] + (begin - across.begin) * right[i];
      visit_run(
          row, {begin, end}, first, right, least, [&] { return is_wanted(run, row); }, visit);
      begin = end;
    }
  }

  template <class IsWanted, class Visit>
  void visit_run(std::int64_t row, SampleSpan run, Values values, const Values& right,
                 const Values& least, const IsWanted& is_wanted, const Visit& visit) const {
    const std::int64_t steps = run.end - 1 - run.begin;
    const auto is_beyond = [&](std::size_t i) {
      return std::max(values[i], values[i] + steps * right[i]) < least[i];
    };
    if (is_beyond(0) || is_beyond(1) || is_beyond(2))
      return;
    if (!is_wanted())
      return;
    // Not a loop over the three: they stay in registers. A sign bit is set beyond an edge.
    std::int64_t first = values[0] - least[0], second = values[1] - least[1],
                 third = values[2] - least[2];
    for (std::int64_t column = run.begin; column < run.end; ++column) {
      if ((first | second | third) >= 0)
        visit(column, row, weights({first + least[0], second + least[1], third + least[2]}));
      first += right[0];
      second += right[1];
      third += right[2];
    }
  }

  Weights weights(const Values& values) const {
    const auto of = [&](std::size_t i) { return static_cast<double>(values[i]) * share_; };
    return mirrored_ ? Weights{of(0), of(2), of(1)} : Weights{of(0), of(1), of(2)};
  }

  std::array<GridPoint, 3> corners_;
  std::int64_t area_ = 0;  ///< twice that, in steps squared
  double share_ = 0;       ///< 1 / area_
  bool mirrored_ = false;
};

}  // namespace meshhier::render
