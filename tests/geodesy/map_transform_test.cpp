#include "geodesy/map_transform.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::geodesy {
namespace {

constexpr double kEarthRadius = 6.371e6;

Vec3d apply(const Transform& m, Vec3d p) {
  return {m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12],
          m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13],
          m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]};
}

Vec3d column(const Transform& m, int axis) {
  return {m[4 * axis], m[4 * axis + 1], m[4 * axis + 2]};
}

struct Place {
  std::string crs;
  Vec3d map;
};

// The last two are at the edge of a zone and far from a map's own meridian: the convergence is 2
// degrees and more.
const std::vector<Place>& places() {
  static const std::vector<Place> all = {
      {"EPSG:32633", {500000, 5300000, 300}}, {"EPSG:25832", {650000, 5250000, 900}},
      {"EPSG:2056", {2683000, 1247000, 410}}, {"EPSG:27700", {530000, 180000, 20}},
      {"EPSG:32633", {720000, 5300000, 300}}, {"EPSG:27700", {100000, 900000, 20}}};
  return all;
}

BoundsD box_around(Vec3d centre, double half) {
  BoundsD box;
  box.add(centre - Vec3d{half, half, 50});
  box.add(centre + Vec3d{half, half, 50});
  return box;
}

MapProjection settled(const Place& place) {
  MapProjection projection(place.crs);
  projection.settle_at(place.map);
  return projection;
}

TEST(MapTransform, IsExactAtTheAnchorAndOffByTheEarthsCurvatureBeyond) {
  for (const Place& place : places()) {
    SCOPED_TRACE(place.crs);
    const MapProjection projection = settled(place);
    const MappedModel model{place.map, {}};
    const Transform m = map_transform(projection, model);
    EXPECT_LT(length(apply(m, {}) - projection.to_geocentric(place.map)), 2e-4);
    for (const double half : {100.0, 500.0, 1000.0, 5000.0}) {
      const double distance = half * std::sqrt(2);
      const double bound = distance * distance / (2 * kEarthRadius);
      const double off = largest_error(projection, model, m, box_around({}, half));
      EXPECT_LT(off, bound * 1.08 + 1e-3) << half;
      EXPECT_GT(off, bound * 0.9) << half;
    }
  }
}

TEST(MapTransform, TheLargestErrorIsThatOfTheWorstCorner) {
  const Place place = places()[2];
  const MapProjection projection = settled(place);
  const MappedModel model{place.map, {300, -200, 10}};
  const Transform m = map_transform(projection, model);
  const BoundsD box = box_around({}, 1000);
  const Vec3d worst{-1000, 1000, -50};
  EXPECT_NEAR(largest_error(projection, model, m, box),
              length(apply(m, worst) - projection.to_geocentric(worst + place.map)), 1e-4);
}

// A placement by longitude and latitude does not turn: at the zone's edge it is 39 m off at 1 km.
TEST(MapTransform, TurnsByTheConvergenceAndScales) {
  const Place middle = places()[0], edge = places()[4];
  const auto east_of = [](const MapProjection& projection, Vec3d map) {
    const double lambda =
        projection.to_geodetic(projection.to_geocentric(map)).longitude * 3.14159265358979 / 180;
    return Vec3d{-std::sin(lambda), std::cos(lambda), 0};
  };
  const MapProjection projection = settled(middle);
  const Transform at_middle = map_transform(projection, {middle.map, {}});
  const Transform at_edge = map_transform(projection, {edge.map, {}});
  // The meridian in the middle of a zone has the scale 0.9996; 300 m up everything is longer.
  const double middle_scale = (1 + 300 / 6.385e6) / 0.9996;
  EXPECT_NEAR(length(column(at_middle, 0)), middle_scale, 1e-6);
  EXPECT_NEAR(length(column(at_middle, 1)), middle_scale, 1e-6);
  EXPECT_NEAR(length(column(at_middle, 2)), 1, 1e-8);
  EXPECT_NEAR(dot(column(at_middle, 0), east_of(projection, middle.map)), middle_scale, 1e-6);
  const double cosine =
      dot(column(at_edge, 0), east_of(projection, edge.map)) / length(column(at_edge, 0));
  EXPECT_NEAR(std::acos(cosine) * 180 / 3.14159265358979, 2.18, 0.05);
}

TEST(MapTransform, TheOffsetChangesNothingButTheModelsCoordinates) {
  const Place place = places()[1];
  const MapProjection projection = settled(place);
  const Transform shifted = map_transform(projection, {place.map, {}});
  const Transform whole = map_transform(projection, {{}, place.map});
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_EQ(column(shifted, axis), column(whole, axis));
  EXPECT_LT(length(apply(shifted, {10, 20, 30}) - apply(whole, place.map + Vec3d{10, 20, 30})),
            1e-7);
}

TEST(MapTransform, ItsDirectionsAreRounded) {
  const Transform m = map_transform(settled(places()[3]), {places()[3].map, {}});
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < 3; ++i) {
      const double steps = std::ldexp(m[4 * axis + i], 27);
      EXPECT_EQ(steps, std::round(steps));
    }
  }
  for (int i = 12; i < 15; ++i)
    EXPECT_EQ(std::ldexp(m[i], 13), std::round(std::ldexp(m[i], 13)));
}

}  // namespace
}  // namespace meshhier::geodesy
