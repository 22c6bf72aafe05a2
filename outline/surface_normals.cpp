#include "outline/surface_normals.h"

#include "outline/tile_triangles.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace meshhier::outline {
namespace {

template <class Visit>
void for_each_own_side(const TileMesh& tile, const Visit& visit) {
  for_each_triangle(tile, [&](const TileTriangle& t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = raw(t[i]), b = raw(t[(i + 1) % 3]);
      if (a != b && a < tile.own_count && b < tile.own_count)
        visit(a, b);
    }
  });
}

/// Floats, held as doubles: each is added six times for once that it is made.
Vec3d rounded_to_length_one(Vec3d v) {
  return to_double(of_length_one(v));
}

std::vector<Vec3d> normals_by_area(const TileMesh& tile) {
  std::vector<Vec3d> normals(tile.own_count);
  for_each_triangle(tile, [&](const TileTriangle& t) {
    const auto at = [&](std::size_t i) { return to_double(tile.vertices.positions[raw(t[i])]); };
    const Vec3d normal = cross(at(1) - at(0), at(2) - at(0));
    for (const TileVertex v : t) {
      if (raw(v) < tile.own_count)
        normals[raw(v)] = normals[raw(v)] + normal;
    }
  });
  std::ranges::transform(normals, normals.begin(), rounded_to_length_one);
  return normals;
}

}  // namespace

Neighbours::Neighbours(const TileMesh& tile) : first_(tile.own_count + 1, 0) {
  for_each_own_side(tile, [&](std::uint32_t a, std::uint32_t) { ++first_[a + 1]; });
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  all_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for_each_own_side(tile, [&](std::uint32_t a, std::uint32_t b) { all_[next[a]++] = b; });
}

Vec3f of_length_one(Vec3d v) {
  const double size = length(v);
  return size > 0 && std::isfinite(size) ? to_float(v * (1 / size)) : Vec3f{};
}

std::vector<Vec3f> smooth_normals(const TileMesh& tile, const Neighbours& neighbours, int rounds) {
  std::vector<Vec3d> normals = normals_by_area(tile);
  std::vector<Vec3d> next(normals.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::uint32_t v = 0; v < normals.size(); ++v) {
      Vec3d sum = normals[v];
      for (const std::uint32_t other : neighbours[v])
        sum = sum + normals[other];
      next[v] = rounded_to_length_one(sum);
    }
    normals.swap(next);
  }
  std::vector<Vec3f> result(normals.size());
  std::ranges::transform(normals, result.begin(), to_float);
  return result;
}

}  // namespace meshhier::outline
