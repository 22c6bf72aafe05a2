#include "mesh_io/mesh_blocks.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::mesh_io {
namespace {

using Corners = std::array<std::uint32_t, 3>;

struct Collected {
  std::vector<Corners> triangles;
  FaceCounts counts;
};

template <class Fill>
Collected collect(Fill fill) {
  Collected result;
  const TriangleVisitor visit = [&](std::span<const Triangle<VertexId>> block) {
    for (const Triangle<VertexId>& t : block) {
      result.triangles.push_back({raw(t[0]), raw(t[1]), raw(t[2])});
    }
  };
  TriangleBlocks blocks(visit);
  fill(blocks);
  result.counts = blocks.finish();
  return result;
}

Collected polygon(std::initializer_list<std::uint32_t> corners) {
  return collect([&](TriangleBlocks& blocks) {
    blocks.begin_polygon();
    for (const std::uint32_t corner : corners)
      blocks.add_polygon_corner(corner);
    blocks.end_polygon();
  });
}

TEST(TriangleBlocks, PolygonsBecomeFans) {
  const Collected pentagon = polygon({5, 6, 7, 8, 9});
  EXPECT_EQ(pentagon.triangles, (std::vector<Corners>{{5, 6, 7}, {5, 7, 8}, {5, 8, 9}}));
  EXPECT_EQ(pentagon.counts.faces, 1U);
  EXPECT_EQ(pentagon.counts.triangles, 3U);
  EXPECT_EQ(pentagon.counts.degenerate_triangles, 0U);
}

TEST(TriangleBlocks, DegenerateTrianglesAreDroppedAndCounted) {
  const Collected repeated = polygon({1, 2, 2, 3});
  EXPECT_EQ(repeated.triangles, (std::vector<Corners>{{1, 2, 3}}));
  EXPECT_EQ(repeated.counts.degenerate_triangles, 1U);
  for (const auto& corners : {std::initializer_list<std::uint32_t>{}, {1}, {1, 2}, {1, 1, 2}}) {
    const Collected none = polygon(corners);
    EXPECT_TRUE(none.triangles.empty());
    EXPECT_EQ(none.counts.faces, 1U);
    EXPECT_EQ(none.counts.triangles, 0U);
    EXPECT_EQ(none.counts.degenerate_triangles, 1U);
  }
}

TEST(TriangleBlocks, StripsAlternateAndRestart) {
  const Collected strip = collect([](TriangleBlocks& blocks) {
    blocks.begin_strip();
    for (const std::uint32_t corner : {0U, 1U, 2U, 3U, 4U})
      blocks.add_strip_corner(corner);
    blocks.restart_strip();
    for (const std::uint32_t corner : {7U, 8U})
      blocks.add_strip_corner(corner);
    blocks.restart_strip();
    blocks.restart_strip();
    for (const std::uint32_t corner : {4U, 5U, 6U})
      blocks.add_strip_corner(corner);
    blocks.end_strip();
  });
  EXPECT_EQ(strip.triangles, (std::vector<Corners>{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 5, 6}}));
  EXPECT_EQ(strip.counts.faces, 1U);
  EXPECT_EQ(strip.counts.degenerate_triangles, 0U);
}

TEST(TriangleBlocks, StitchesInsideStripsKeepTheOrientationOfWhatFollows) {
  const Collected strip = collect([](TriangleBlocks& blocks) {
    blocks.begin_strip();
    for (const std::uint32_t corner : {0U, 1U, 2U, 2U, 3U, 3U, 4U, 5U}) {
      blocks.add_strip_corner(corner);
    }
    blocks.end_strip();
  });
  EXPECT_EQ(strip.triangles, (std::vector<Corners>{{0, 1, 2}, {4, 3, 5}}));
  EXPECT_EQ(strip.counts.degenerate_triangles, 4U);
}

TEST(TriangleBlocks, BlocksAreFullButTheLast) {
  std::vector<std::size_t> sizes;
  const TriangleVisitor visit = [&](std::span<const Triangle<VertexId>> block) {
    sizes.push_back(block.size());
  };
  TriangleBlocks blocks(visit);
  for (std::uint32_t i = 0; i < 2 * MeshSource::kBlockSize + 5; ++i) {
    blocks.add_triangle_face(i, i + 1, i + 2);
  }
  EXPECT_EQ(blocks.finish().triangles, 2 * MeshSource::kBlockSize + 5);
  EXPECT_EQ(sizes, (std::vector<std::size_t>{MeshSource::kBlockSize, MeshSource::kBlockSize, 5}));
}

TEST(VertexBlocks, ADefectIsFoundAndNothingTaken) {
  std::size_t seen = 0;
  const VertexVisitor visit = [&](const VertexBlock& block) { seen += block.positions.size(); };
  MeshDescription mesh;
  mesh.vertex_count = 100;
  mesh.attributes.colour = ColourType::u8;
  VertexBlocks blocks(mesh, visit);
  for (int slot = 0; slot < 6; ++slot)
    blocks.set(slot, slot);
  EXPECT_EQ(blocks.commit({.colours = true}), std::nullopt);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(), 256.0, -1.0, 0.5}) {
    for (int slot = 0; slot < 6; ++slot)
      blocks.set(slot, slot);
    blocks.set(4, bad);
    const auto defect = blocks.commit({.colours = true});
    ASSERT_TRUE(defect) << bad;
    EXPECT_EQ(defect->row, 0U);
    EXPECT_EQ(defect->slot, 4);
  }
  blocks.finish();
  EXPECT_EQ(seen, 1U);
}

}  // namespace
}  // namespace meshhier::mesh_io
