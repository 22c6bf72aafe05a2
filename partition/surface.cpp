#include "partition/surface.h"

#include "base/bounds.h"

#include <algorithm>

namespace meshhier::partition {
namespace {

constexpr std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 32)) * 0xd6e8feb86659fd93ULL;
  return x ^ (x >> 32);
}

constexpr std::uint64_t hash(const Triangle<std::uint32_t>& t) {
  return mix(mix(mix(t[0] + 1) + t[1]) + t[2]);
}

/// Leaves no more than `most` distinct ones, chosen by their corners alone.
void choose(std::vector<Triangle<std::uint32_t>>& triangles, std::size_t most) {
  for (Triangle<std::uint32_t>& t : triangles)
    t = canonical(t);
  std::sort(triangles.begin(), triangles.end(),
            [](const Triangle<std::uint32_t>& a, const Triangle<std::uint32_t>& b) {
              const std::uint64_t hash_a = hash(a), hash_b = hash(b);
              return hash_a != hash_b ? hash_a < hash_b : a < b;
            });
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  triangles.resize(std::min(triangles.size(), most));
  triangles.shrink_to_fit();
}

std::vector<Vec3f> in_unit_cube(std::span<const Vec3f> positions) {
  const Bounds bounds = bounds_of(positions);
  const double size = diagonal(bounds);
  const double scale = size > 0 ? 1 / size : 0;
  const Vec3d low = to_double(bounds.min);
  std::vector<Vec3f> unit;
  unit.reserve(positions.size());
  for (const Vec3f& p : positions)
    unit.push_back(to_float((to_double(p) - low) * scale));
  return unit;
}

}  // namespace

Surface make_surface(std::span<const Vec3f> positions,
                     std::span<const Triangle<std::uint32_t>> triangles, std::uint32_t first) {
  Surface surface{in_unit_cube(positions), {}};
  surface.triangles.reserve(triangles.size());
  const std::uint32_t count = surface.size();
  for (const Triangle<std::uint32_t>& t : triangles) {
    const Triangle<std::uint32_t> local{t[0] - first, t[1] - first,
                                        t[2] - first};  // wraps around below it
    if (local[0] < count && local[1] < count && local[2] < count &&
        (local[0] != local[1] || local[1] != local[2]))
      surface.triangles.push_back(local);
  }
  if (surface.triangles.size() > kMostTriangles * positions.size())
    choose(surface.triangles, kMostTriangles * positions.size());
  return surface;
}

std::vector<Surface> separate(const Surface& surface, std::span<const std::uint32_t> part_of,
                              std::uint32_t count) {
  std::vector<Surface> parts(count);
  std::vector<std::uint32_t> place(surface.size());
  for (std::uint32_t v = 0; v < surface.size(); ++v) {
    std::vector<Vec3f>& positions = parts[part_of[v]].positions;
    place[v] = static_cast<std::uint32_t>(positions.size());
    positions.push_back(surface.positions[v]);
  }
  for (const Triangle<std::uint32_t>& t : surface.triangles) {
    const std::uint32_t part = part_of[t[0]];
    if (part_of[t[1]] == part && part_of[t[2]] == part)
      parts[part].triangles.push_back({place[t[0]], place[t[1]], place[t[2]]});
  }
  return parts;
}

}  // namespace meshhier::partition
