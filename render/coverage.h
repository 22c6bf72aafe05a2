// Which samples of a grid a triangle covers, decided in integers (Pineda, A parallel algorithm for
// polygon rasterization, 1988).
//
// Corners are snapped to 1/256 of a sample. A sample on an edge belongs to the triangle to its
// right or below: of two triangles that share an edge exactly one covers it.
#pragma once

#include "hierarchy/vec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace meshhier::render {

/// Of the corners of a triangle, at a place within it: their sum is 1.
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
    const double near = std::clamp(samples, -kFarthest, kFarthest);
    return static_cast<std::int64_t>(std::floor(near * kSteps + 0.5));
  };
  return {steps(place.x), steps(place.y)};
}

/// Of sample 0, 1, ... along an axis.
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

/// The line from a to b: positive to its right, as y goes down.
struct EdgeFunction {
  GridPoint a, b;

  constexpr std::int64_t operator()(GridPoint p) const {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
  }
  /// What it grows by from one sample to the next.
  constexpr std::int64_t step_right() const { return -(b.y - a.y) * kSteps; }
  /// What it must be at least: points on the line are inside where it goes up, or right.
  constexpr std::int64_t least() const { return b.y < a.y || (b.y == a.y && b.x > a.x) ? 0 : 1; }
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
  }

  /// Calls visit(column, row, weights) for each sample that it covers, row by row, but for the runs
  /// of which is_wanted(run, row) is false; it is asked of runs that the triangle may cover only.
  template <class IsWanted, class Visit>
  void visit(std::int64_t columns, std::int64_t rows, const IsWanted& is_wanted,
             const Visit& visit) const {
    if (area_ == 0)
      return;
    const auto& [a, b, c] = corners_;
    const auto [left, right] = std::minmax({a.x, b.x, c.x});
    const auto [top, bottom] = std::minmax({a.y, b.y, c.y});
    const SampleSpan across = samples_between(left, right, columns);
    const SampleSpan down = samples_between(top, bottom, rows);
    if (across.begin >= across.end)
      return;
    for (std::int64_t row = down.begin; row < down.end; ++row)
      visit_row(row, across, is_wanted, visit);
  }

 private:
  using Values = std::array<std::int64_t, 3>;

  template <class IsWanted, class Visit>
  void visit_row(std::int64_t row, SampleSpan across, const IsWanted& is_wanted,
                 const Visit& visit) const {
    for (std::int64_t begin = across.begin; begin < across.end;) {
      const std::int64_t run = begin / kRunSamples;
      const std::int64_t end = std::min(across.end, (run + 1) * kRunSamples);
      visit_run(
          row, {begin, end}, [&] { return is_wanted(run, row); }, visit);
      begin = end;
    }
  }

  template <class IsWanted, class Visit>
  void visit_run(std::int64_t row, SampleSpan run, const IsWanted& is_wanted,
                 const Visit& visit) const {
    // Each edge is that opposite to a corner, and its value that corner's share of the area.
    const auto& [a, b, c] = corners_;
    const std::array<EdgeFunction, 3> edges{EdgeFunction{b, c}, EdgeFunction{c, a},
                                            EdgeFunction{a, b}};
    const GridPoint start{middle_of(run.begin), middle_of(row)};
    Values values{edges[0](start), edges[1](start), edges[2](start)};
    const Values least{edges[0].least(), edges[1].least(), edges[2].least()};
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int64_t last = values[i] + (run.end - 1 - run.begin) * edges[i].step_right();
      if (values[i] < least[i] && last < least[i])
        return;  // all beyond one edge
    }
    if (!is_wanted())
      return;
    for (std::int64_t column = run.begin; column < run.end; ++column) {
      if (values[0] >= least[0] && values[1] >= least[1] && values[2] >= least[2])
        visit(column, row, weights(values));
      for (std::size_t i = 0; i < 3; ++i)
        values[i] += edges[i].step_right();
    }
  }

  Weights weights(const Values& values) const {
    const double share = 1 / static_cast<double>(area_);
    const auto of = [&](std::size_t i) { return static_cast<double>(values[i]) * share; };
    return mirrored_ ? Weights{of(0), of(2), of(1)} : Weights{of(0), of(1), of(2)};
  }

  std::array<GridPoint, 3> corners_;
  std::int64_t area_ = 0;  ///< twice that, in steps squared
  bool mirrored_ = false;
};

}  // namespace meshhier::render
