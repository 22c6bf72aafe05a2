#include "execution/cancel.h"
#include "import/terrain_source.h"
#include "mesh_io/terrain_frame.h"
#include "support/sample_tiff.h"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::importing {
namespace {

using meshhier::tests::MemoryFiles;
using meshhier::tests::put_tiff;
using meshhier::tests::TiffForm;
using ::testing::ElementsAre;

constexpr float kVoid = std::numeric_limits<float>::quiet_NaN();

/// A surface of heights, read in blocks and as a whole.
struct TerrainMesh {
  std::vector<Vec3d> points;
  std::vector<Triangle<VertexId>> triangles;
  std::unique_ptr<mesh_io::MeshSource> source;
};

TerrainMesh read_terrain(const TiffForm& form, std::uint32_t width,
                         const std::vector<float>& heights) {
  MemoryFiles files;
  put_tiff<float>(files, "/models/a.tif", form, width, heights);
  Terrain terrain;
  terrain.mosaic = std::make_shared<const mesh_io::Mosaic>(
      files, std::vector<std::filesystem::path>{"/models/a.tif"});
  const execution::CancelToken cancel;
  terrain.cells = std::make_shared<const TerrainCells>(
      *terrain.mosaic, [](double) {}, cancel);
  TerrainMesh mesh;
  mesh.source = open_terrain(terrain);
  mesh.source->read_vertices([&](const mesh_io::VertexBlock& block) {
    EXPECT_EQ(block.first, mesh.points.size());
    mesh.points.insert(mesh.points.end(), block.exact.begin(), block.exact.end());
  });
  const mesh_io::FaceCounts counts =
      mesh.source->read_triangles([&](std::span<const Triangle<VertexId>> triangles) {
        mesh.triangles.insert(mesh.triangles.end(), triangles.begin(), triangles.end());
      });
  EXPECT_EQ(mesh.points.size(), mesh.source->description().vertex_count);
  EXPECT_EQ(mesh.triangles.size(), mesh.source->description().face_count);
  EXPECT_EQ(counts.triangles, mesh.triangles.size());
  return mesh;
}

double doubled_area(const TerrainMesh& mesh, const Triangle<VertexId>& t) {
  const Vec3d a = mesh.points[raw(t[0])];
  const Vec3d u = mesh.points[raw(t[1])] - a, v = mesh.points[raw(t[2])] - a;
  return u.x * v.y - u.y * v.x;
}

std::vector<Triangle<VertexId>> triangles_of_ids(
    const std::vector<std::array<std::uint32_t, 3>>& all) {
  std::vector<Triangle<VertexId>> triangles;
  for (const auto& [a, b, c] : all)
    triangles.push_back({VertexId{a}, VertexId{b}, VertexId{c}});
  return triangles;
}

TEST(Terrain, ASquareAloneIsCutWhereHeightsDifferLess) {
  EXPECT_EQ(read_terrain({}, 2, {5, 0, 1, 5}).triangles, triangles_of_ids({{0, 2, 3}, {3, 1, 0}}));
  EXPECT_EQ(read_terrain({}, 2, {0, 5, 5, 1}).triangles, triangles_of_ids({{0, 2, 1}, {3, 1, 2}}));
  EXPECT_EQ(read_terrain({}, 2, {0, 5, 5, 0}).triangles, triangles_of_ids({{0, 2, 3}, {3, 1, 0}}));
}

/// A ridge goes from the lower left to the upper right, and rises: its ends differ as much as the
/// slopes beside it.
TEST(Terrain, ASquareIsCutAlongTheRidge) {
  std::vector<float> heights;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column)
      heights.push_back(static_cast<float>(20 * column - 4 * std::abs(column + row - 3)));
  }
  const TerrainMesh mesh = read_terrain({}, 4, heights);
  const auto middle = triangles_of_ids({{5, 9, 6}, {10, 6, 9}});
  EXPECT_THAT(mesh.triangles, testing::IsSupersetOf(middle));
}

TEST(Terrain, VoidsHaveNoTriangles) {
  const TerrainMesh mesh = read_terrain({}, 3,
                                        {0, 1, 2,      //
                                         3, kVoid, 5,  //
                                         6, 7, 8});
  EXPECT_EQ(mesh.points.size(), 8U);
  EXPECT_EQ(mesh.points[4], (Vec3d{500025, 5299985, 5}));
  EXPECT_EQ(mesh.triangles, triangles_of_ids({{0, 3, 1}, {1, 4, 2}, {3, 5, 6}, {4, 6, 7}}));
}

TEST(Terrain, FacesLookUpWhereverRowsGo) {
  std::vector<float> heights;
  for (int i = 0; i < 300; ++i)
    heights.push_back(static_cast<float>(i * 7919 % 31));
  const TiffForm turned{.matrix = {3, 4, 0, 100, 4, -3, 0, 200, 0, 0, 0, 0, 0, 0, 0, 1}};
  const TiffForm mirrored{.matrix = {3, 4, 0, 100, -4, 3, 0, 200, 0, 0, 0, 0, 0, 0, 0, 1}};
  for (const TiffForm& form : {TiffForm{}, turned, mirrored}) {
    const TerrainMesh mesh = read_terrain(form, 20, heights);
    EXPECT_EQ(mesh.triangles.size(), 2U * 19 * 14);
    for (const Triangle<VertexId>& t : mesh.triangles)
      EXPECT_GT(doubled_area(mesh, t), 0);
  }
}

/// Wider than a run and longer than a block; one cell in seven has no height.
TEST(Terrain, BlocksAreTheWholeInOrder) {
  constexpr std::uint32_t kWide = TerrainCells::kRunCells * 2 + 77;
  std::vector<float> heights(kWide * 20);
  for (std::size_t i = 0; i < heights.size(); ++i)
    heights[i] = i * 7919 % 7 == 0 ? kVoid : static_cast<float>(i * 104729 % 97);
  const TerrainMesh mesh = read_terrain({.compression = COMPRESSION_LZW}, kWide, heights);
  mesh_io::BlockMemory memory;
  std::uint64_t vertices = 0, triangles = 0;
  for (std::uint64_t i = mesh.source->vertex_blocks(); i-- > 0;) {
    const mesh_io::VertexBlock block = mesh.source->read_vertex_block(i, memory);
    ASSERT_EQ(block.first, i * mesh_io::MeshSource::kBlockSize);
    for (std::size_t v = 0; v < block.exact.size(); ++v)
      ASSERT_EQ(block.exact[v], mesh.points[block.first + v]);
    vertices += block.exact.size();
  }
  for (std::uint64_t i = 0; i < mesh.source->triangle_blocks(); ++i) {
    const mesh_io::TriangleBlock block = mesh.source->read_triangle_block(i, memory);
    EXPECT_TRUE(block.whole);
    EXPECT_LE(block.triangles.size(), mesh_io::MeshSource::kBlockSize);
    for (const Triangle<VertexId>& t : block.triangles)
      ASSERT_EQ(t, mesh.triangles[triangles++]);
  }
  EXPECT_EQ(vertices, mesh.points.size());
  EXPECT_EQ(triangles, mesh.triangles.size());
  std::set<std::array<std::uint32_t, 3>> different;
  for (const Triangle<VertexId>& t : mesh.triangles)
    different.insert({raw(t[0]), raw(t[1]), raw(t[2])});
  EXPECT_EQ(different.size(), mesh.triangles.size());
  std::size_t from_the_middle = 0;
  mesh.source->read_triangles_from(
      1000, [&](std::span<const Triangle<VertexId>> some) { from_the_middle += some.size(); },
      mesh_io::BlockRunner{});
  EXPECT_EQ(from_the_middle, mesh.triangles.size() - 1000);
}

TEST(Terrain, DegreesStandInAFrameOnTheGlobe) {
  TiffForm form{.scale = {1, 1, 0}, .tie = {0, 0, 0, 9.5, 50.5, 0}};
  form.keys = {1, 1, 0, 2, 1024, 0, 1, 2, 2048, 0, 1, 4326};
  const TerrainMesh mesh = read_terrain(form, 1, {100, 100, 100});  // latitudes 50, 49, 48
  const Vec3d north = mesh.points[0], middle = mesh.points[1];
  EXPECT_NEAR(middle.x, 0, 1e-9);
  EXPECT_NEAR(middle.y, 0, 1e-9);
  EXPECT_NEAR(middle.z, 100, 1e-9);
  // A degree north of latitude 49: pyproj 3.4, EPSG:4979 to topocentric coordinates.
  EXPECT_NEAR(north.x, 0, 1e-9);
  EXPECT_NEAR(north.y, 111220, 30);
  EXPECT_NEAR(north.z, 100 - 970, 10);
}

}  // namespace
}  // namespace meshhier::importing
