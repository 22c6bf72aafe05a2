#include "partition/compactness.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <vector>

namespace meshhier::partition {
namespace {

/// The line of a border triangle around its own corners: from the midpoints of the edges that leave
/// the tile to the centroid.
double border_length(const std::array<Vec3d, 3>& corners, const std::array<bool, 3>& own) {
  const Vec3d centroid = (corners[0] + corners[1] + corners[2]) * (1.0 / 3);
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    if (own[k] != own[next])
      sum += length((corners[k] + corners[next]) * 0.5 - centroid);
  }
  return sum;
}

double double_area_of(Vec3d a, Vec3d b, Vec3d c) {
  return length(cross(b - a, c - a));
}

}  // namespace

double compactness(const TileMesh& tile) {
  const std::vector<Vec3f>& positions = tile.vertices.positions;
  double perimeter = 0;
  double double_area = 0;
  for (const TileTriangle& t : tile.interior) {
    double_area += double_area_of(to_double(positions[raw(t[0])]), to_double(positions[raw(t[1])]),
                                  to_double(positions[raw(t[2])]));
  }
  for (const TileTriangle& t : tile.border) {
    std::array<Vec3d, 3> corners;
    std::array<bool, 3> own;
    for (int k = 0; k < 3; ++k) {
      corners[k] = to_double(positions[raw(t[k])]);
      own[k] = tile.is_own(t[k]);
    }
    double_area +=
        double_area_of(corners[0], corners[1], corners[2]) * (own[0] + own[1] + own[2]) / 3;
    perimeter += border_length(corners, own);
  }
  return double_area > 0 ? perimeter * perimeter / (2 * std::numbers::pi * double_area) : 0;
}

float published_compactness(const TileMesh& tile) {
  constexpr double kMost = std::numeric_limits<float>::max();
  return static_cast<float>(std::min(compactness(tile), kMost));
}

}  // namespace meshhier::partition
