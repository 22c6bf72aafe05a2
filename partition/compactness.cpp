#include "partition/compactness.h"

#include <array>
#include <numbers>

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

}  // namespace

double compactness(const TileMesh& tile) {
  double perimeter = 0;
  double area = 0;
  const auto add = [&](const Triangle& t) {
    std::array<Vec3d, 3> corners;
    std::array<bool, 3> own;
    for (int k = 0; k < 3; ++k) {
      corners[k] = to_double(tile.vertices.positions[raw(t[k])]);
      own[k] = tile.is_own(t[k]);
    }
    area += length(cross(corners[1] - corners[0], corners[2] - corners[0])) / 2 *
            (own[0] + own[1] + own[2]) / 3;
    perimeter += border_length(corners, own);
  };
  for (const Triangle& t : tile.interior)
    add(t);
  for (const Triangle& t : tile.border)
    add(t);
  return area > 0 ? perimeter * perimeter / (4 * std::numbers::pi * area) : 0;
}

}  // namespace meshhier::partition
