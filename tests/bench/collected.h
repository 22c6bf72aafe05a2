// A generated mesh in memory, and the questions the generator's tests ask of it.
#pragma once

#include "bench/generator.h"
#include "storage/io/hash.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::bench {

struct Collected {
  std::vector<Vec3d> positions;
  std::vector<float> attributes;
  std::vector<MeshTriangle> triangles;
  friend bool operator==(const Collected&, const Collected&) = default;
};

inline Collected collect(const GeneratedMesh& mesh, std::size_t block_size = 1000) {
  Collected all;
  const auto channels = static_cast<std::size_t>(mesh.content().attributes.channels());
  mesh.visit_vertices(block_size, [&](std::span<const Vec3d> p, std::span<const float> a) {
    EXPECT_GE(p.size(), 1u);
    EXPECT_LE(p.size(), block_size);
    EXPECT_EQ(a.size(), p.size() * channels);
    all.positions.insert(all.positions.end(), p.begin(), p.end());
    all.attributes.insert(all.attributes.end(), a.begin(), a.end());
  });
  mesh.visit_triangles(block_size, [&](std::span<const MeshTriangle> t) {
    EXPECT_GE(t.size(), 1u);
    EXPECT_LE(t.size(), block_size);
    all.triangles.insert(all.triangles.end(), t.begin(), t.end());
  });
  EXPECT_EQ(all.positions.size(), mesh.content().vertex_count);
  EXPECT_EQ(all.triangles.size(), mesh.content().triangle_count);
  return all;
}

template <class T>
std::uint64_t hash_of(const std::vector<T>& values) {
  return storage::checksum(std::as_bytes(std::span<const T>(values)));
}

inline std::tuple<double, double, double> key(Vec3d p) {
  return {p.x, p.y, p.z};
}

inline bool has_repeated_position(const std::vector<Vec3d>& positions) {
  std::set<std::tuple<double, double, double>> seen;
  for (const Vec3d p : positions) {
    if (!seen.insert(key(p)).second)
      return true;
  }
  return false;
}

/// Every vertex's triangles form one ring: following them edge by edge comes back after all of
/// them.
inline bool has_one_ring_everywhere(const Collected& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>
      next;  // (v, a) -> b of (v, a, b)
  std::vector<std::size_t> valence(mesh.positions.size());
  for (const MeshTriangle& t : mesh.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      next[{t[c], t[(c + 1) % 3]}] = t[(c + 2) % 3];
      ++valence[t[c]];
    }
  }
  std::vector<bool> checked(mesh.positions.size());
  for (const auto& [from, first_next] : next) {
    const auto [v, start] = from;
    if (checked[v])
      continue;
    checked[v] = true;
    std::size_t steps = 1;
    for (std::uint32_t at = first_next; at != start; ++steps) {
      const auto found = next.find({v, at});
      if (found == next.end() || steps > valence[v])
        return false;
      at = found->second;
    }
    if (steps != valence[v])
      return false;
  }
  return std::all_of(checked.begin(), checked.end(), [](bool c) { return c; });
}

inline double signed_volume(const Collected& mesh) {
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    volume += dot(mesh.positions[a], cross(mesh.positions[b], mesh.positions[c])) / 6;
  return volume;
}

inline double area(const Collected& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sum += length(cross(mesh.positions[b] - mesh.positions[a],
                        mesh.positions[c] - mesh.positions[a])) /
           2;
  }
  return sum;
}

inline std::size_t components(const Collected& mesh) {
  tests::TestMesh narrow;
  for (const Vec3d p : mesh.positions)
    narrow.positions.push_back(to_float(p));
  narrow.triangles = mesh.triangles;
  return tests::component_count(narrow);
}

inline LoadedMesh loaded(const tests::TestMesh& mesh) {
  LoadedMesh result;
  for (const Vec3f p : mesh.positions)
    result.positions.push_back(to_double(p));
  result.triangles = mesh.triangles;
  return result;
}

}  // namespace meshhier::bench
