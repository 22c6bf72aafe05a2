#include "mesh_io/terrain_frame.h"

#include "base/wgs84.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace meshhier::mesh_io {
namespace {

constexpr double kRound = 360;

double rounded_degrees(double degrees) {
  constexpr double kGrain = 0x1p20;
  return std::floor(degrees * kGrain + 0.5) / kGrain;
}

/// Returns a longitude from -180 to 180.
double wound(double longitude) {
  return longitude - kRound * std::floor((longitude + kRound / 2) / kRound);
}

}  // namespace

GlobePlace rounded(GlobePlace place) {
  return {rounded_degrees(wound(place.longitude)), rounded_degrees(place.latitude)};
}

std::optional<GlobePlace> middle_of(const Mosaic& mosaic) {
  if (mosaic.keys().kind != geodesy::MapKind::degrees)
    return std::nullopt;
  const MapPoint middle = mosaic.map().at((mosaic.columns() - 1.0) / 2, (mosaic.rows() - 1.0) / 2);
  const double unit = mosaic.keys().unit;
  return rounded({middle.x * unit, middle.y * unit});
}

TerrainFrame::TerrainFrame(const Mosaic& mosaic, std::shared_ptr<const CellPlaces> map)
    : map_(mosaic.map()),
      unit_(mosaic.keys().unit),
      is_mirrored_(map_.determinant() > 0),
      other_map_(std::move(map)),
      middle_(other_map_ ? std::nullopt : middle_of(mosaic)) {
  if (!middle_)
    return;
  latitude_ = turn_of(middle_->latitude);
  base_ = wgs84::geocentric({}, latitude_, 0);
  is_upright_ = map_.column.y == 0 && map_.row.x == 0;
  if (!is_upright_)
    return;
  turns_.reserve(mosaic.columns());
  for (std::uint32_t column = 0; column < mosaic.columns(); ++column)
    turns_.push_back(turn_of(wound(map_.at(column, 0).x * unit_ - middle_->longitude)));
}

UnitTurn TerrainFrame::turn_of(double degrees) const {
  return turn_by(degrees * (std::numbers::pi / 180));
}

Vec3d TerrainFrame::on_globe(UnitTurn longitude, UnitTurn latitude, double height) const {
  const Vec3d away = wgs84::geocentric(longitude, latitude, height) - base_;
  return {away.y, latitude_.cosine * away.z - latitude_.sine * away.x,
          latitude_.cosine * away.x + latitude_.sine * away.z};
}

void TerrainFrame::place(std::uint32_t row, std::uint32_t first, std::span<const double> heights,
                         std::vector<Vec3d>& points) const {
  if (other_map_ != nullptr)
    return place_on_map(row, first, heights, points);
  const UnitTurn parallel = is_upright_ ? turn_of(map_.at(0, row).y * unit_) : UnitTurn{};
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const double height = heights[i];
    if (std::isnan(height))
      continue;
    const std::size_t column = first + i;
    if (is_upright_) {
      points.push_back(on_globe(turns_[column], parallel, height));
      continue;
    }
    const MapPoint at = map_.at(static_cast<double>(column), row);
    if (middle_) {
      points.push_back(on_globe(turn_of(wound(at.x * unit_ - middle_->longitude)),
                                turn_of(at.y * unit_), height));
    } else {
      points.push_back({at.x * unit_, at.y * unit_, height});
    }
  }
}

void TerrainFrame::place_on_map(std::uint32_t row, std::uint32_t first,
                                std::span<const double> heights, std::vector<Vec3d>& points) const {
  std::vector<MapPoint> places(heights.size());
  other_map_->read(row, first, places);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (!std::isnan(heights[i]))
      points.push_back({places[i].x, places[i].y, heights[i]});
  }
}

}  // namespace meshhier::mesh_io
