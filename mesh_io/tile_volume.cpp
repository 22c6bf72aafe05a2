#include "mesh_io/tile_volume.h"

#include "base/angle.h"
#include "base/wgs84.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

namespace meshhier::mesh_io {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// Returns the radius of the longest parallel between two latitudes.
double longest_parallel(double south, double north) {
  if (south * north <= 0)
    return wgs84::kEquator;
  return wgs84::kEquator * std::max(turn_by(south).cosine, turn_by(north).cosine);
}

/// Returns east, which is less than west where the region crosses the antimeridian, behind west.
double east_of(const std::vector<double>& region) {
  return region[2] + (region[2] < region[0] ? kTurn : 0);
}

/// Returns the volume of west, south, east, north in radians, least and largest height; nothing if
/// there is no such region.
std::optional<TileVolume> ball_of_region(const std::vector<double>& region) {
  if (!std::ranges::all_of(std::span(region).first(4),
                           [](double angle) { return std::abs(angle) <= std::numbers::pi; }))
    return std::nullopt;
  const double east = east_of(region);
  const double width = (east - region[0]) * longest_parallel(region[1], region[3]);
  const double height = std::abs(region[3] - region[1]) * wgs84::kEquator;
  const UnitTurn longitude = turn_by((region[0] + east) / 2);
  const UnitTurn latitude = turn_by((region[1] + region[3]) / 2);
  return TileVolume{.middle = wgs84::geocentric(longitude, latitude, (region[4] + region[5]) / 2),
                    .radius = (width + height + std::abs(region[5] - region[4])) / 2,
                    .is_geocentric = true};
}

TileVolume ball_of_box(const std::vector<double>& box) {
  double square = 0;
  for (std::size_t i = 3; i < box.size(); ++i)
    square += box[i] * box[i];
  return {.middle = {box[0], box[1], box[2]}, .radius = std::sqrt(square)};
}

/// Halves [low, high] once a level and leaves the cell's part.
void leave_part(double& low, double& high, std::uint64_t at, std::uint32_t level) {
  const double step = std::ldexp(high - low, -static_cast<int>(level));
  low += static_cast<double>(at) * step;
  high = low + step;
}

double within_half_a_turn(double angle) {
  return angle > std::numbers::pi ? angle - kTurn : angle;
}

void leave_part_of_region(std::vector<double>& region, const TileCell& cell, bool is_octree) {
  double west = region[0], east = east_of(region);
  leave_part(west, east, cell.at[0], cell.level);
  region[0] = within_half_a_turn(west);
  region[2] = within_half_a_turn(east);
  leave_part(region[1], region[3], cell.at[1], cell.level);
  if (is_octree)
    leave_part(region[4], region[5], cell.at[2], cell.level);
}

/// A box is its middle and three half axes.
void leave_part_of_box(std::vector<double>& box, const TileCell& cell, bool is_octree) {
  const double size = std::ldexp(1.0, -static_cast<int>(cell.level));
  for (std::size_t axis = 0; axis < (is_octree ? 3U : 2U); ++axis) {
    const double along = (2 * static_cast<double>(cell.at[axis]) + 1) * size - 1;
    for (std::size_t i = 0; i < 3; ++i) {
      double& half = box[3 + 3 * axis + i];
      box[i] += along * half;
      half *= size;
    }
  }
}

}  // namespace

std::optional<VolumeNumbers> VolumeNumbers::of(const GltfObject& tile) {
  const auto volume = tile.object("boundingVolume");
  if (!volume)
    return std::nullopt;
  if (auto region = volume->numbers("region", 6)) {
    VolumeNumbers found(Kind::region, *std::move(region));
    if (!found.ball())
      volume->fail("has a region beyond half a turn");
    return found;
  }
  if (auto box = volume->numbers("box", 12))
    return VolumeNumbers(Kind::box, *std::move(box));
  if (auto sphere = volume->numbers("sphere", 4))
    return VolumeNumbers(Kind::sphere, *std::move(sphere));
  return std::nullopt;
}

std::optional<TileVolume> VolumeNumbers::ball() const {
  switch (kind_) {
    case Kind::region:
      return ball_of_region(n_);
    case Kind::box:
      return ball_of_box(n_);
    case Kind::sphere:
      return TileVolume{.middle = {n_[0], n_[1], n_[2]}, .radius = std::abs(n_[3])};
  }
  return std::nullopt;
}

VolumeNumbers VolumeNumbers::part(const TileCell& cell, bool is_octree) const {
  VolumeNumbers part = *this;
  if (kind_ == Kind::region)
    leave_part_of_region(part.n_, cell, is_octree);
  else if (kind_ == Kind::box)
    leave_part_of_box(part.n_, cell, is_octree);
  return part;
}

}  // namespace meshhier::mesh_io
