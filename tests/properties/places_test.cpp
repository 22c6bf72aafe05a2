// Promises 2 and 3 for meshes whose files list a place several times: the surface is one, whatever
// its attributes are.
#include "bench/generator.h"
#include "bench/split.h"
#include "bench/stress.h"
#include "config/config.h"
#include "export/cut_mesh.h"
#include "export/random_cut.h"
#include "hierarchy/cut.h"
#include "pipeline/build.h"
#include "storage/format/hierarchy_reader.h"
#include "tests/support/loaded_mesh.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/simplify_methods.h"
#include "verify/verify.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

using bench::LoadedMesh;
using testing::IsEmpty;
using tests::loaded;

using Point = std::array<float, 3>;
using PointEdge = std::array<Point, 2>;

/// Edges with exactly one triangle, told by positions alone.
class OpenEdges {
 public:
  void add(const Point& a, const Point& b, const Point& c) {
    add(a, b);
    add(b, c);
    add(c, a);
  }
  std::int64_t count() const {
    return std::ranges::count(triangles_, 1U, [](const auto& entry) { return entry.second; });
  }

 private:
  void add(const Point& a, const Point& b) { ++triangles_[{std::min(a, b), std::max(a, b)}]; }

  std::map<PointEdge, std::uint32_t> triangles_;
};

Point point(Vec3f p) {
  return {p.x + 0.0F, p.y + 0.0F, p.z + 0.0F};
}

std::int64_t open_edges(const LoadedMesh& mesh) {
  OpenEdges edges;
  const auto at = [&](std::uint32_t v) { return point(to_float(mesh.positions[v])); };
  for (const tests::MeshTriangle& t : mesh.triangles)
    edges.add(at(t[0]), at(t[1]), at(t[2]));
  return edges.count();
}

/// A hierarchy of a mesh, read back.
class BuiltMesh {
 public:
  BuiltMesh(const LoadedMesh& mesh, const config::SimplifyConfig& simplify,
            Topology topology = Topology::place) {
    config_.input = directory_.path() / "mesh.ply";
    config_.output = directory_.path() / "mesh.hier";
    bench::write_ply(*files_, {directory_.path() / "mesh.ply"}, *bench::as_generated(mesh));
    config_.partition.count = 21;
    config_.simplify = simplify;
    config_.simplify.vertices = 70;
    config_.topology = topology;
    execution::NoProgress progress;
    build_hierarchy(config_, {}, {*files_, progress, execution::CancelToken()});
    reader_ = std::make_unique<storage::HierarchyReader>(*files_, config_.output);
    for (const TileRecord& record : reader_->records())
      tiles_.emplace(record.node, reader_->read_tile(record.node));
  }

  const storage::HierarchyReader& reader() const { return *reader_; }
  const std::map<NodeId, PublishedTile>& tiles() const { return tiles_; }

  std::vector<std::string> problems() {
    execution::NoProgress progress;
    return verifying::verify_hierarchy(*files_, config_.output, {.input = config_.input, .cuts = 5},
                                       progress, execution::CancelToken())
        .problems;
  }

  /// Returns the open edges of the triangles that a random cut draws.
  std::int64_t open_edges(std::uint64_t seed) const {
    const exporting::NumberedCut shown =
        exporting::number_vertices(*reader_, exporting::random_cut(reader_->tree(), seed));
    const auto at = [&](std::uint32_t number) {
      const std::size_t position = shown.position_of_vertex(number);
      const TileMesh& mesh = tiles_.at(shown.cut[position]).mesh;
      return point(mesh.vertices.positions.at(number - shown.base(position)));
    };
    OpenEdges edges;
    for (std::size_t i = 0; i < shown.cut.size(); ++i) {
      for (const exporting::CutTriangle& t :
           exporting::draw_tile(reader_->tree(), shown, i, tiles_.at(shown.cut[i])).triangles)
        edges.add(at(t[0]), at(t[1]), at(t[2]));
    }
    return edges.count();
  }

  /// Own places of the partitions.
  std::vector<std::uint32_t> partition_sizes() const {
    std::vector<std::uint32_t> sizes;
    for (const TileRecord& record : reader_->records()) {
      if (record.node.level == reader_->tree().depth())
        sizes.push_back(record.own_count);
    }
    return sizes;
  }

 private:
  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  config::Config config_ = tests::quick_config();
  std::unique_ptr<storage::HierarchyReader> reader_;
  std::map<NodeId, PublishedTile> tiles_;
};

constexpr double kDegrees = 40;
constexpr std::uint64_t kCuts = 20;

/// `places`: of the mesh that was split.
void expect_sound(BuiltMesh& built, const LoadedMesh& mesh, std::size_t places) {
  EXPECT_THAT(built.problems(), IsEmpty());
  EXPECT_EQ(built.reader().manifest().source.vertices, mesh.positions.size());
  EXPECT_EQ(built.reader().manifest().source.places, places);
  const std::vector<std::uint32_t> sizes = built.partition_sizes();
  ASSERT_EQ(sizes.size(), 21U);
  const auto [least, most] = std::ranges::minmax(sizes);
  EXPECT_LE(most, least + 1);
  std::uint64_t sum = 0;
  for (const std::uint32_t size : sizes)
    sum += size;
  EXPECT_EQ(sum, places);
}

TEST(Places, NoCutOfAClosedSurfaceIsOpenHoweverItIsSplit) {
  const tests::TestMesh torus = tests::torus(3000, 0.02F);
  for (const bench::SplitCase& split : bench::split_cases()) {
    const LoadedMesh mesh = bench::split(loaded(torus), split.name, kDegrees);
    ASSERT_GT(mesh.positions.size(), torus.positions.size());
    ASSERT_EQ(open_edges(mesh), 0);
    for (const auto& [name, method] : tests::all_simplify_methods()) {
      SCOPED_TRACE(std::string(split.name) + ", " + name);
      BuiltMesh built(mesh, method);
      expect_sound(built, mesh, torus.positions.size());
      for (std::uint64_t seed = 0; seed < kCuts; ++seed)
        ASSERT_EQ(built.open_edges(seed), 0) << "cut " << seed;
    }
  }
}

TEST(Places, NoCutOfAnOpenSurfaceIsMoreOpenThanIt) {
  const tests::TestMesh grid = tests::open_grid(40, 35, 0.3F);
  for (const bench::SplitCase& split : bench::split_cases()) {
    const LoadedMesh mesh = bench::split(loaded(grid), split.name, kDegrees);
    const std::int64_t most = open_edges(mesh);
    ASSERT_EQ(most, 2 * (40 + 35));
    for (const auto& [name, method] : tests::all_simplify_methods()) {
      SCOPED_TRACE(std::string(split.name) + ", " + name);
      BuiltMesh built(mesh, method);
      expect_sound(built, mesh, grid.positions.size());
      for (std::uint64_t seed = 0; seed < kCuts; ++seed)
        ASSERT_LE(built.open_edges(seed), most) << "cut " << seed;
    }
  }
}

// Without attributes there is nothing to tell vertices of a place apart by.
TEST(Places, SoupBecomesWhatItsWeldedTwinBecomes) {
  const tests::TestMesh twin = tests::by_first_appearance(tests::sphere(3000, 0.02F));
  const LoadedMesh mesh = bench::split(loaded(twin), "soup", kDegrees);
  ASSERT_EQ(mesh.positions.size(), 3 * twin.triangles.size());
  for (const auto& [name, method] : tests::all_simplify_methods()) {
    SCOPED_TRACE(name);
    const BuiltMesh soup(mesh, method), welded(loaded(twin), method);
    const auto& records = soup.reader().records();
    ASSERT_EQ(records.size(), welded.reader().records().size());
    for (std::size_t i = 0; i < records.size(); ++i) {
      const TileRecord& record = welded.reader().records()[i];
      SCOPED_TRACE(i);
      ASSERT_EQ(records[i].node, record.node);
      EXPECT_EQ(records[i].own_count, record.own_count);
      EXPECT_EQ(records[i].interior_count, record.interior_count);
      EXPECT_EQ(records[i].border_count, record.border_count);
      EXPECT_EQ(records[i].drawn_border_count, record.drawn_border_count);
      EXPECT_EQ(records[i].error, record.error);
      EXPECT_EQ(records[i].bound, record.bound);
      EXPECT_EQ(soup.tiles().at(record.node).mesh.vertices.positions,
                welded.tiles().at(record.node).mesh.vertices.positions);
      if (soup.reader().tree().partitions(record.node).size() > 1) {  // else it is the partition's
        const TileMesh& tile = soup.tiles().at(record.node).mesh;
        EXPECT_EQ(tile.copies.first_of(tile.own_count), 0U) << "vertices that nothing tells apart";
      }
    }
  }
}

TEST(Places, EachVertexIsAPlaceIfTheTopologyIsThatOfIndices) {
  const tests::TestMesh torus = tests::torus(3000, 0.02F);
  for (const bench::SplitCase& split : bench::split_cases()) {
    SCOPED_TRACE(split.name);
    const LoadedMesh mesh = bench::split(loaded(torus), split.name, kDegrees);
    BuiltMesh built(mesh, {}, Topology::index);
    expect_sound(built, mesh, mesh.positions.size());
    for (const TileRecord& record : built.reader().records())
      EXPECT_EQ(record.copy_count, 0U);
  }
}

}  // namespace
}  // namespace meshhier::pipeline
