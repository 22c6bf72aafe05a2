#include "bench/split.h"

#include "base/error.h"
#include "tests/support/loaded_mesh.h"
#include "tests/support/meshes.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::bench {
namespace {

LoadedMesh noisy_torus() {
  return tests::loaded(tests::torus(3000, 0.02F));
}

using Channels = std::vector<float>;

Channels channels_of(const LoadedMesh& mesh, std::uint32_t vertex) {
  const auto width = static_cast<std::ptrdiff_t>(mesh.attributes.channels());
  const auto begin = mesh.channels.begin() + vertex * width;
  return {begin, begin + width};
}

TEST(SplitTest, EveryTriangleKeepsItsPositions) {
  const LoadedMesh mesh = noisy_torus();
  for (const SplitCase& listed : split_cases()) {
    SCOPED_TRACE(listed.name);
    const LoadedMesh result = split(mesh, listed.name, 40);
    ASSERT_EQ(result.triangles.size(), mesh.triangles.size());
    EXPECT_EQ(result.channels.size(),
              result.positions.size() * static_cast<std::size_t>(result.attributes.channels()));
    std::set<std::uint32_t> used;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t corner = result.triangles[i][k];
        ASSERT_LT(corner, result.positions.size());
        ASSERT_EQ(result.positions[corner], mesh.positions[mesh.triangles[i][k]]);
        used.insert(corner);
      }
    }
    EXPECT_EQ(used.size(), result.positions.size()) << "each vertex is a corner";
    EXPECT_GT(result.positions.size(), mesh.positions.size());
  }
}

TEST(SplitTest, VerticesOfOnePlaceDifferUnlessItIsSoup) {
  for (const SplitCase& listed : split_cases()) {
    SCOPED_TRACE(listed.name);
    const LoadedMesh result = split(noisy_torus(), listed.name, 40);
    std::set<std::pair<std::array<double, 3>, Channels>> known;
    for (std::uint32_t v = 0; v < result.positions.size(); ++v) {
      const Vec3d p = result.positions[v];
      known.insert({{p.x, p.y, p.z}, channels_of(result, v)});
    }
    if (listed.name == "soup")
      EXPECT_EQ(result.positions.size(), 3 * result.triangles.size());
    else
      EXPECT_EQ(known.size(), result.positions.size());
  }
}

TEST(SplitTest, HasTheAttributesOfItsName) {
  const auto layout = [](std::string_view name) {
    return split(noisy_torus(), name, 40).attributes;
  };
  EXPECT_EQ(layout("charts").channels(), 2);
  EXPECT_TRUE(layout("charts").texcoords);
  EXPECT_EQ(layout("hard_edges").channels(), 3);
  EXPECT_TRUE(layout("hard_edges").normals);
  EXPECT_EQ(layout("flat").channels(), 3);
  EXPECT_TRUE(layout("flat").normals);
  EXPECT_EQ(layout("face_colours").channels(), 3);
  EXPECT_EQ(layout("face_colours").colour, ColourType::u8);
  EXPECT_EQ(layout("soup").channels(), 0);
  EXPECT_EQ(layout("mixed").channels(), 8);
}

TEST(SplitTest, NoTriangleIsInTwoCharts) {
  const LoadedMesh result = split(noisy_torus(), "charts", 40);
  const auto side_of = [](float u, float v) {
    return std::pair(static_cast<int>(std::floor(u * 3)), static_cast<int>(std::floor(v * 2)));
  };
  std::set<std::pair<int, int>> sides;
  for (const MeshTriangle& t : result.triangles) {
    std::set<std::pair<int, int>> own;
    for (const std::uint32_t corner : t) {
      const Channels c = channels_of(result, corner);
      ASSERT_TRUE(c[0] > 0 && c[0] < 1 && c[1] > 0 && c[1] < 1);
      own.insert(side_of(c[0], c[1]));
    }
    ASSERT_EQ(own.size(), 1U);
    sides.insert(*own.begin());
  }
  EXPECT_EQ(sides.size(), 6U);
}

TEST(SplitTest, FlatNormalsAreUnitAndEqualOnAFace) {
  const LoadedMesh result = split(noisy_torus(), "flat", 40);
  for (const MeshTriangle& t : result.triangles) {
    const Channels normal = channels_of(result, t[0]);
    EXPECT_EQ(channels_of(result, t[1]), normal);
    EXPECT_EQ(channels_of(result, t[2]), normal);
    const Vec3d n{normal[0], normal[1], normal[2]};
    EXPECT_NEAR(length(n), 1, 1e-6);
    const Vec3d a = result.positions[t[0]];
    const Vec3d edge = result.positions[t[1]] - a, other = result.positions[t[2]] - a;
    EXPECT_GT(dot(n, cross(edge, other)), 0);
    EXPECT_NEAR(dot(n, edge), 0, 1e-6);
    EXPECT_NEAR(dot(n, other), 0, 1e-6);
  }
}

TEST(SplitTest, SmoothNormalsStayTogetherWhereTheSurfaceBendsLittle) {
  // Each half of a roof is flat; it bends by 90 degrees at the ridge, x = 0.
  LoadedMesh roof;
  for (const double x : {-1.0, 0.0, 1.0}) {
    for (int y = 0; y < 4; ++y)
      roof.positions.push_back({x, static_cast<double>(y), -std::abs(x)});
  }
  for (std::uint32_t column = 0; column < 2; ++column) {
    for (std::uint32_t y = 0; y < 3; ++y) {
      const std::uint32_t a = column * 4 + y, b = a + 4;
      roof.triangles.push_back({a, b, a + 1});
      roof.triangles.push_back({b, b + 1, a + 1});
    }
  }
  EXPECT_EQ(split(roof, "hard_edges", 80).positions.size(), 12 + 4U) << "the ridge is there twice";
  EXPECT_EQ(split(roof, "hard_edges", 100).positions.size(), 12U);
}

TEST(SplitTest, ColoursAreOneOfEightOnAFace) {
  const LoadedMesh result = split(noisy_torus(), "face_colours", 40);
  std::set<Channels> colours;
  for (const MeshTriangle& t : result.triangles) {
    const Channels colour = channels_of(result, t[0]);
    EXPECT_EQ(channels_of(result, t[1]), colour);
    EXPECT_EQ(channels_of(result, t[2]), colour);
    colours.insert(colour);
  }
  EXPECT_EQ(colours.size(), 8U);
}

TEST(SplitTest, AnUnknownCaseIsRefused) {
  for (const char* name : {"", "chart", "Soup"}) {
    try {
      (void)split(noisy_torus(), name, 40);
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
    }
  }
}

}  // namespace
}  // namespace meshhier::bench
