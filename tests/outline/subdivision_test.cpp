#include "outline/subdivision.h"

#include "tests/outline/one_tile.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::outline {
namespace {

std::vector<std::size_t> counts(const std::vector<std::uint16_t>& part_of, std::uint32_t parts) {
  std::vector<std::size_t> counts(parts);
  for (const std::uint16_t part : part_of)
    ++counts.at(part);
  return counts;
}

TEST(Subdivision, PartsAreAboutEqual) {
  const TileMesh tile = tests::one_tile(tests::torus(20'000, 0.01F));
  for (const std::uint32_t parts : {1U, 2U, 3U, 18U, 128U}) {
    const auto found = counts(divide(tile, parts), parts);
    const std::size_t mean = tile.own_count / parts;
    EXPECT_GE(*std::min_element(found.begin(), found.end()), mean / 2) << parts;
    EXPECT_LE(*std::max_element(found.begin(), found.end()), 2 * mean) << parts;
  }
}

TEST(Subdivision, MorePartsThanVerticesAreNoObstacle) {
  for (const tests::TestMesh& mesh :
       {tests::sphere(8), tests::points(3), tests::points(0), tests::soup(20)}) {
    const TileMesh tile = tests::one_tile(mesh);
    const std::vector<std::uint16_t> part_of = divide(tile, 65536);
    EXPECT_EQ(part_of.size(), tile.own_count);
  }
}

/// Rings alone would leave a limb without lines along it: nobody would see how thick it is.
TEST(Subdivision, ALimbIsDividedAlongItToo) {
  // A cylinder of length 40 and radius 1.
  constexpr std::uint32_t kAround = 24, kAlong = 120;
  TileMesh tile;
  for (std::uint32_t i = 0; i < kAlong; ++i) {
    for (std::uint32_t j = 0; j < kAround; ++j) {
      const double angle = 6.283185307179586 * j / kAround;
      tile.vertices.positions.push_back({static_cast<float>(i) / 3,
                                         static_cast<float>(std::cos(angle)),
                                         static_cast<float>(std::sin(angle))});
      if (i + 1 == kAlong)
        continue;
      const TileVertex a{i * kAround + j}, b{i * kAround + (j + 1) % kAround};
      const TileVertex c{raw(a) + kAround}, d{raw(b) + kAround};
      tile.interior.push_back({a, b, c});
      tile.interior.push_back({b, d, c});
    }
  }
  tile.own_count = kAround * kAlong;
  const std::vector<std::uint16_t> part_of = divide(tile, 64);
  std::uint32_t changes_along = 0, changes_around = 0;
  for (std::uint32_t i = 0; i + 1 < kAlong; ++i) {
    for (std::uint32_t j = 0; j < kAround; ++j) {
      const std::uint32_t v = i * kAround + j;
      changes_along += part_of[v] != part_of[v + kAround] ? 1 : 0;
      changes_around += part_of[v] != part_of[i * kAround + (j + 1) % kAround] ? 1 : 0;
    }
  }
  EXPECT_GT(changes_along, 5 * kAround);
  EXPECT_GT(changes_around, 3 * kAlong / 2);
}

TEST(Subdivision, LinesAreEven) {
  const tests::TestMesh mesh = tests::sphere(20'000, 0.02F);
  const TileMesh tile = tests::one_tile(mesh);
  const std::vector<std::uint16_t> part_of = divide(tile, 16);
  std::size_t lonely = 0;
  std::vector<bool> has_like(part_of.size());
  for (const tests::MeshTriangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (part_of[t[i]] == part_of[t[(i + 1) % 3]])
        has_like[t[i]] = has_like[t[(i + 1) % 3]] = true;
    }
  }
  for (const bool has : has_like)
    lonely += has ? 0 : 1;
  EXPECT_LE(lonely, part_of.size() / 500);
}

}  // namespace
}  // namespace meshhier::outline
