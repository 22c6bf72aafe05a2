// The result of small builds, as one number each: says that something changed, not what is right.
#include "mesh_io/ply_writer.h"
#include "pipeline/build.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/io/file.h"
#include "storage/io/hash.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/sizes.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using tests::kMiB;

/// Hashes what the files say, not how: positions, attributes, triangles, maps.
class ContentHash {
 public:
  template <class T>
  void add(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add_count(values.size());
    sum_.add(std::as_bytes(std::span(values)));
  }
  void add_count(std::uint64_t count) { sum_.add(std::as_bytes(std::span(&count, 1))); }
  void add(const PublishedTile& tile) {
    const TileMesh& mesh = tile.mesh;
    add_count(raw(tile.node.level));
    add_count(tile.node.index);
    add_count(mesh.own_count);
    add_count(mesh.boundary_count);
    add(mesh.vertices.positions);
    add(mesh.vertices.attributes);
    add(mesh.ghosts);
    add(mesh.interior);
    add(mesh.border);
    add(tile.parent_map);
    for (std::size_t i = 0; i < tile.chains.size(); ++i)
      add(std::vector(tile.chains[i].begin(), tile.chains[i].end()));
  }
  std::uint64_t value() const { return sum_.value(); }

 private:
  storage::Checksum sum_;
};

/// A rough terrain with repeated, mirrored and missing triangles, and coloured. Made without
/// functions that differ between mathematical libraries.
tests::TestMesh terrain() {
  tests::TestMesh mesh = tests::open_grid(70, 60, 0.3F);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    mesh.positions[v].z = 4 * tests::hash_noise(v / 97, 7) + tests::hash_noise(v, 8);
  const std::size_t count = mesh.triangles.size();
  for (std::size_t t = 0; t < count; t += 41) {
    const tests::MeshTriangle again = mesh.triangles[t];
    mesh.triangles.push_back(again);
    mesh.triangles.push_back({again[1], again[0], again[2]});
  }
  mesh.triangles.erase(mesh.triangles.begin() + 300, mesh.triangles.begin() + 340);
  return mesh;
}

config::SimplifyConfig with(config::SimplifyMethod method) {
  config::SimplifyConfig config;
  config.method = method;
  return config;
}

config::SimplifyConfig half_edge(config::HalfEdgeCost cost) {
  config::SimplifyConfig config = with(config::SimplifyMethod::half_edge);
  config.cost = cost;
  return config;
}

config::SimplifyConfig cluster(config::Representative representative) {
  config::SimplifyConfig config = with(config::SimplifyMethod::cluster);
  config.representative = representative;
  return config;
}

struct Golden {
  const char* name;
  config::SimplifyConfig simplify;
  config::AxisRule axis;
  std::uint32_t partitions;
  std::uint64_t hash;
};

/// After a change that is meant to change results: see that the property tests pass, put the
/// numbers of the failure's message here, and say in CHANGELOG.md what changed and why.
const Golden kGolden[] = {
    {"edge_collapse", with(config::SimplifyMethod::edge_collapse), config::AxisRule::compactness,
     29, 0xbef3d7070ae645fa},
    {"SLOW_half_edge_quadric", half_edge(config::HalfEdgeCost::quadric), config::AxisRule::longest,
     16, 0xe03d5fe3bd5fb995},
    {"SLOW_half_edge_melax", half_edge(config::HalfEdgeCost::melax), config::AxisRule::compactness,
     7, 0x636cf00c980a4227},
    {"SLOW_cluster_quadric", cluster(config::Representative::quadric),
     config::AxisRule::compactness, 29, 0x790b7a85eeb09b68},
    {"SLOW_cluster_mean", cluster(config::Representative::mean), config::AxisRule::longest, 16,
     0x572df83ec8d9d7ac},
    {"SLOW_cluster_vertex", cluster(config::Representative::vertex), config::AxisRule::compactness,
     7, 0x34c9206c848a23f6},
};

class GoldenTest : public testing::TestWithParam<Golden> {
 protected:
  std::uint64_t build(std::uint32_t threads, std::uint64_t budget) {
    const Golden& golden = GetParam();
    config::Config config = tests::smooth_config();
    config.input = directory_.path() / "terrain.ply";
    config.output = directory_.path() / "terrain.hier";
    config.threads = threads;
    config.memory_budget = budget;
    config.partition.count = golden.partitions;
    config.partition.axis = golden.axis;
    config.simplify = golden.simplify;
    execution::NoProgress progress;
    pipeline::build_hierarchy(config, {.force = true},
                              {*files_, progress, execution::CancelToken()});
    const storage::HierarchyReader reader(*files_, config.output);
    ContentHash hash;
    for (const TileRecord& record : reader.records())
      hash.add(reader.read_tile(record.node));
    const Outline outline = reader.read_outline();
    hash.add(outline.vertices);
    hash.add(outline.starts);
    return hash.value();
  }

  void write_mesh() {
    const tests::TestMesh mesh = terrain();
    mesh_io::PlyContent content;
    content.vertex_count = mesh.positions.size();
    content.triangle_count = mesh.triangles.size();
    content.attributes.colour = ColourType::u8;
    std::vector<float> colours;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      for (std::size_t k = 0; k < 3; ++k)
        colours.push_back(static_cast<float>((v * (k + 3)) % 256));
    }
    mesh_io::PlyWriter writer(files_->create(directory_.path() / "terrain.ply"), content);
    writer.write_vertices(std::span<const Vec3f>(mesh.positions), colours);
    writer.write_triangles(mesh.triangles);
    writer.finish();
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

TEST_P(GoldenTest, ContentIsAsRecorded) {
  write_mesh();
  for (const std::uint32_t threads : {1U, 0U}) {
    for (const std::uint64_t budget : {64 * kMiB, 4096 * kMiB}) {
      const std::uint64_t found = build(threads, budget);
      EXPECT_EQ(found, GetParam().hash) << fmt::format(
          "with {} threads (0: all) and {} MiB the result is {:#018x}. If it is meant to differ, "
          "and is the same in all four cases, update kGolden[\"{}\"] in this file.",
          threads, budget / kMiB, found, GetParam().name);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, GoldenTest, testing::ValuesIn(kGolden),
                         [](const auto& golden) { return std::string(golden.param.name); });

}  // namespace
}  // namespace meshhier::pipeline
