#include "render/occlusion.h"

#include "hierarchy/angle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace meshhier::render {
namespace {

constexpr std::size_t kDirections = 12;
/// Of the shorter side of the picture: wide enough for the hollows of a body, and fine ones are in
/// the nearer steps.
constexpr double kReach = 0.12;
/// Each step is so much farther than the one before; the first is one and a half samples.
constexpr double kStep = 1.7, kFirstStep = 1.5;
/// How dark full shadow is made: more than the light that it takes away shows where things touch.
constexpr double kStrength = 1.5;
/// Surfaces that are seen from the side have no more slope than this.
constexpr double kLeastFacing = 0.08;

/// Where a horizon is looked for, from a sample.
struct Step {
  std::int64_t across = 0, down = 0;  ///< samples
  double squared = 0;                 ///< the distance's square
  std::int64_t ahead = 0;             ///< in the rows of samples
};

/// The nearest first.
using Direction = std::vector<Step>;

std::array<Direction, kDirections> directions(double reach, std::int64_t columns) {
  constexpr double kFullTurn = 6.283185307179586;
  std::array<Direction, kDirections> all;
  for (std::size_t i = 0; i < kDirections; ++i) {
    const UnitTurn turn = turn_by(kFullTurn * (static_cast<double>(i) + 0.5) / kDirections);
    for (double far = kFirstStep; far < reach; far *= kStep) {
      const double across = std::floor(far * turn.cosine + 0.5);
      const double down = std::floor(far * turn.sine + 0.5);
      const auto right = static_cast<std::int64_t>(across), below = static_cast<std::int64_t>(down);
      all[i].push_back({right, below, across * across + down * down, below * columns + right});
    }
  }
  return all;
}

/// Of the angle at which something rises so far, at a distance whose square is `squared`.
double sine(double rise, double squared) {
  return rise / std::sqrt(squared + rise * rise);
}

class Horizons {
 public:
  Horizons(const Raster& raster, double relief)
      : depths_(raster.samples().size()),
        samples_(raster.samples()),
        columns_(raster.columns()),
        rows_(raster.rows()),
        relief_(relief),
        reach_(kReach * std::min(raster.columns(), raster.rows())),
        squared_reach_(reach_ * reach_),
        directions_(directions(reach_, columns_)) {
    for (std::size_t i = 0; i < depths_.size(); ++i)
      depths_[i] = samples_[i].depth;
  }

  float sky_from(std::int64_t column, std::int64_t row) const {
    const std::int64_t index = row * columns_ + column;
    const Sample& here = samples_[static_cast<std::size_t>(index)];
    if (!here.covered())
      return 1;
    const double facing = std::max<double>(here.normal.z, kLeastFacing);
    const Place place{
        column, row, index, here.depth, -here.normal.x / facing, here.normal.y / facing};
    double hidden = 0;
    for (const Direction& direction : directions_)
      hidden += hidden_towards(place, direction);
    return static_cast<float>(std::max(0.0, 1 - kStrength * hidden / kDirections));
  }

 private:
  struct Place {
    std::int64_t column = 0, row = 0, index = 0;
    double depth = 0;
    double rise_across = 0, rise_down = 0;  ///< of the surface, for each sample
  };

  /// How far the horizon stands above the surface itself; what is farther counts less.
  double hidden_towards(const Place& place, const Direction& direction) const {
    double highest = 0, hidden = 0;
    for (const Step& step : direction) {
      const std::int64_t x = place.column + step.across, y = place.row + step.down;
      if (x < 0 || y < 0 || x >= columns_ || y >= rows_)
        break;
      // Where nothing is, the depth is infinite and nothing rises.
      const double depth = depths_[static_cast<std::size_t>(place.index + step.ahead)];
      const auto across = static_cast<double>(step.across), down = static_cast<double>(step.down);
      const double own = relief_ * (place.rise_across * across + place.rise_down * down);
      const double rise = relief_ * (place.depth - depth);
      if (!(rise > own))
        continue;
      const double share = 1 - (step.squared + rise * rise) / squared_reach_;
      if (share <= 0)
        continue;
      const double above = sine(rise, step.squared) - sine(own, step.squared);
      if (above > highest) {
        hidden += (above - highest) * share;
        highest = above;
      }
    }
    return hidden;
  }

  std::vector<float> depths_;
  std::span<const Sample> samples_;
  std::int64_t columns_, rows_;
  double relief_, reach_, squared_reach_;
  std::array<Direction, kDirections> directions_;
};

/// The sample before a place of an axis, and the share of the one behind it.
struct Between {
  std::size_t first = 0, second = 0;
  double share = 0;
};

Between between(double place, std::uint32_t count) {
  const double at = std::clamp(place * count - 0.5, 0.0, count - 1.0);
  const auto first = static_cast<std::size_t>(at);
  return {first, std::min<std::size_t>(first + 1, count - 1), at - static_cast<double>(first)};
}

}  // namespace

Occlusion::Occlusion(const Raster& raster, double relief)
    : columns_(raster.columns()), rows_(raster.rows()) {
  const Horizons horizons(raster, relief);
  sky_.reserve(raster.samples().size());
  for (std::uint32_t row = 0; row < rows_; ++row) {
    for (std::uint32_t column = 0; column < columns_; ++column)
      sky_.push_back(horizons.sky_from(column, row));
  }
}

double Occlusion::sky_at(double across, double down) const {
  const Between x = between(across, columns_), y = between(down, rows_);
  const auto row = [&](std::size_t r) {
    const double first = sky_[r * columns_ + x.first], second = sky_[r * columns_ + x.second];
    return first + (second - first) * x.share;
  };
  const double above = row(y.first), below = row(y.second);
  return above + (below - above) * y.share;
}

}  // namespace meshhier::render
