#include "mesh_io/cell_places.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::mesh_io {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kLargest = std::numeric_limits<double>::max();

CellPlaces::Change bent_change(std::uint32_t columns, std::uint32_t rows) {
  const double width = columns, height = rows;
  return {.exact = [=](MapPoint cell) -> MapPoint {
            const double x = cell.x / width, y = cell.y / height;
            return {500'000 + 40'000 * x + 900 * x * y + 300 * std::sin(2 * y),
                    5'000'000 - 30'000 * y + 700 * x * x * x};
          },
          .grain = 0x1p-13,
          .tolerance = 0x1p-10,
          .least = {-kLargest, -kLargest},
          .most = {kLargest, kLargest}};
}

TEST(CellPlaces, AMapIsTakenAsItIs) {
  const GridMap map{{10.1, 20.3}, {0.3, 0.1}, {-0.1, 0.7}};
  const CellPlaces places(map);
  std::vector<MapPoint> row(7);
  places.read(5, 3, row);
  for (std::size_t i = 0; i < row.size(); ++i)
    EXPECT_EQ(row[i], map.at(3 + static_cast<double>(i), 5));
  EXPECT_FALSE(places.is_changed());
  EXPECT_EQ(places.held_bytes(), 0U);
}

TEST(CellPlaces, AnotherMapIsAsNearAsAsked) {
  constexpr std::uint32_t kColumns = 1000, kRows = 700;
  const CellPlaces::Change change = bent_change(kColumns, kRows);
  const CellPlaces places(kColumns, kRows, change);
  std::vector<MapPoint> row(kColumns);
  double largest = 0;
  for (std::uint32_t r = 0; r < kRows; r += 3) {
    places.read(r, 0, row);
    for (std::uint32_t c = 0; c < kColumns; ++c) {
      const MapPoint exact = change.exact({static_cast<double>(c), static_cast<double>(r)});
      largest = std::max({largest, std::abs(row[c].x - exact.x), std::abs(row[c].y - exact.y)});
    }
  }
  EXPECT_LE(largest, 2 * change.tolerance);
  EXPECT_GT(largest, 0);
  EXPECT_LE(places.largest_error(), change.tolerance);
}

TEST(CellPlaces, PartsOfARowAreTheRow) {
  constexpr std::uint32_t kColumns = 513, kRows = 3;
  const CellPlaces places(kColumns, kRows, bent_change(kColumns, kRows));
  std::vector<MapPoint> whole(kColumns), part(100);
  places.read(1, 0, whole);
  for (const std::uint32_t first : {0U, 1U, 200U, 413U}) {
    places.read(1, first, part);
    for (std::size_t i = 0; i < part.size(); ++i)
      ASSERT_EQ(part[i], whole[first + i]);
  }
}

TEST(CellPlaces, AGridMayBeALine) {
  for (const auto& [columns, rows] : {std::pair(1U, 50U), std::pair(50U, 1U), std::pair(1U, 1U)}) {
    const CellPlaces::Change change = bent_change(columns, rows);
    const CellPlaces places(columns, rows, change);
    const MapPoint last = places.at(columns - 1.0, rows - 1.0);
    const MapPoint exact = change.exact({columns - 1.0, rows - 1.0});
    EXPECT_NEAR(last.x, exact.x, change.tolerance);
    EXPECT_NEAR(last.y, exact.y, change.tolerance);
  }
}

/// Only a corner counts, which is far from where there are no places.
TEST(CellPlaces, PlacesThatAreNoneSpoilNoOthers) {
  CellPlaces::Change change = bent_change(1000, 1000);
  change.exact = [exact = change.exact](MapPoint cell) -> MapPoint {
    return cell.x > 800 ? MapPoint{kNone, kNone} : exact(cell);
  };
  change.most = {510'000, kLargest};
  const CellPlaces places(1000, 1000, change);
  EXPECT_LE(places.largest_error(), change.tolerance);
  EXPECT_TRUE(std::isnan(places.at(999, 500).x));
  EXPECT_NEAR(places.at(100, 500).x, change.exact({100, 500}).x, change.tolerance);
}

TEST(CellPlaces, AMapThatJumpsIsToldOf) {
  CellPlaces::Change change = bent_change(1000, 1000);
  change.exact = [exact = change.exact](MapPoint cell) -> MapPoint {
    const MapPoint at = exact(cell);
    return {cell.x > 500.1 ? at.x - 360 : at.x, at.y};
  };
  EXPECT_GT(CellPlaces(1000, 1000, change).largest_error(), 1);
}

}  // namespace
}  // namespace meshhier::mesh_io
