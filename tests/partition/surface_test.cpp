#include "partition/surface.h"

#include "tests/support/meshes.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace meshhier::partition {
namespace {

TEST(Surface, LiesInTheUnitCube) {
  const std::vector<Vec3f> positions{{-3, 5, 1e30F}, {1, 5, -1e30F}, {0, 6, 0}};
  const Surface surface = make_surface(positions, {});
  for (const Vec3f& p : surface.positions) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GE(p[axis], 0);
      EXPECT_LE(p[axis], 1);
    }
  }
  EXPECT_EQ(surface.positions[0].z, 1);
}

TEST(Surface, LeavesOutOtherVerticesAndPoints) {
  const std::vector<Vec3f> positions(3);
  const std::vector<Triangle<std::uint32_t>> triangles{{10, 11, 12}, {9, 10, 11},  {10, 13, 11},
                                                       {11, 11, 11}, {12, 10, 12}, {0, 1, 2}};
  const std::vector<Triangle<std::uint32_t>> expected{{0, 1, 2}, {2, 0, 2}};
  EXPECT_EQ(make_surface(positions, triangles, 10).triangles, expected);
}

TEST(Surface, IsSeparatedIntoWhatLiesWithinTheParts) {
  const tests::TestMesh mesh = tests::shuffled(tests::sphere(600, 0.02F), 3);
  const Surface surface =
      make_surface(mesh.positions, {mesh.triangles.begin(), mesh.triangles.end()});
  std::vector<std::uint32_t> part_of(surface.size());
  for (std::uint32_t v = 0; v < surface.size(); ++v)
    part_of[v] = surface.positions[v].x < 0.2F ? 2 : surface.positions[v].y < 0.3F ? 0 : 3;
  const std::vector<Surface> parts = separate(surface, part_of, 4);
  ASSERT_EQ(parts.size(), 4U);
  EXPECT_EQ(parts[1].size(), 0U);
  for (std::uint32_t part = 0; part < 4; ++part) {
    std::vector<Vec3f> positions;
    std::vector<std::array<Vec3f, 3>> expected, found;
    for (std::uint32_t v = 0; v < surface.size(); ++v) {
      if (part_of[v] == part)
        positions.push_back(surface.positions[v]);
    }
    EXPECT_EQ(parts[part].positions, positions);
    const auto corners = [](const Surface& from, const Triangle<std::uint32_t>& t) {
      return std::array{from.positions[t[0]], from.positions[t[1]], from.positions[t[2]]};
    };
    for (const Triangle<std::uint32_t>& t : surface.triangles) {
      if (std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return part_of[v] == part; }))
        expected.push_back(corners(surface, t));
    }
    for (const Triangle<std::uint32_t>& t : parts[part].triangles)
      found.push_back(corners(parts[part], t));
    EXPECT_EQ(found, expected);
  }
}

}  // namespace
}  // namespace meshhier::partition
