// Promise 6: the output is byte-identical for any thread count, any memory budget, and any form of
// the same input.
#include "base/error.h"
#include "bench/split.h"
#include "execution/size_text.h"
#include "mesh_io/ply_writer.h"
#include "partition/top_tree.h"
#include "pipeline/build.h"
#include "pipeline/estimate.h"
#include "storage/format/layout.h"
#include "storage/io/hash.h"
#include "tests/support/loaded_mesh.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/simplify_methods.h"
#include "tests/support/sizes.h"
#include "tests/support/tight_budget.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using tests::kGiB;
using tests::kMiB;
using tests::TestMesh;

/// A file's path in the hierarchy, and the hash of its content.
using FileHashes = std::map<std::string, std::uint64_t>;

/// A mesh with attributes of every kind.
struct RichMesh {
  TestMesh shape;
  AttributeLayout layout;
  std::vector<float> attributes;
};

RichMesh plain(TestMesh shape) {
  return {std::move(shape), {}, {}};
}

/// Several vertices at each place, as bench::split() makes them.
RichMesh split(const TestMesh& shape, std::string_view name) {
  const bench::LoadedMesh mesh = bench::split(tests::loaded(shape), name, 40);
  RichMesh result{{{}, mesh.triangles}, mesh.attributes, mesh.channels};
  for (const Vec3d& p : mesh.positions)
    result.shape.positions.push_back(to_float(p));
  return result;
}

RichMesh rich(TestMesh shape) {
  RichMesh mesh{std::move(shape), {}, {}};
  mesh.layout.normals = true;
  mesh.layout.colour = ColourType::u8;
  mesh.layout.alpha = true;
  mesh.layout.texcoords = true;
  for (std::uint64_t v = 0; v < mesh.shape.positions.size(); ++v) {
    const auto noise = [&](std::uint64_t stream) { return tests::hash_noise(v, stream); };
    const auto colour = [&](std::uint64_t stream) {
      return static_cast<float>(static_cast<int>((noise(stream) + 1) * 127.5F));
    };
    const Vec3d p = to_double(mesh.shape.positions[v]);
    const Vec3f normal = to_float(p * (1 / std::max(length(p), 1e-9)));
    mesh.attributes.insert(mesh.attributes.end(),
                           {normal.x, normal.y, normal.z, colour(1), colour(2), colour(3),
                            colour(4), noise(5), noise(6)});
  }
  return mesh;
}

/// Everything that may differ between two builds of one mesh.
struct Conditions {
  std::uint32_t threads = 1;
  std::uint64_t budget = 4 * kGiB;
};

class DeterminismTest : public testing::Test {
 protected:
  fs::path mesh_path() const { return directory_.path() / "mesh.ply"; }

  void write_binary(const RichMesh& mesh) {
    mesh_io::PlyContent content;
    content.vertex_count = mesh.shape.positions.size();
    content.triangle_count = mesh.shape.triangles.size();
    content.attributes = mesh.layout;
    mesh_io::PlyWriter writer(files_->create(mesh_path()), content);
    writer.write_vertices(std::span<const Vec3f>(mesh.shape.positions), mesh.attributes);
    writer.write_triangles(mesh.shape.triangles);
    writer.finish();
  }

  /// The same mesh as text, or with every number's bytes in the other order.
  void write_text(const RichMesh& mesh) {
    std::ofstream out(mesh_path());
    out.precision(9);
    out << header(mesh, "ascii");
    const auto channels = static_cast<std::size_t>(mesh.layout.channels());
    for (std::size_t v = 0; v < mesh.shape.positions.size(); ++v) {
      const Vec3f p = mesh.shape.positions[v];
      out << p.x << ' ' << p.y << ' ' << p.z;
      for (std::size_t k = 0; k < channels; ++k)
        out << ' ' << mesh.attributes[v * channels + k];
      out << '\n';
    }
    for (const tests::MeshTriangle& t : mesh.shape.triangles)
      out << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  }

  void write_big_endian(const RichMesh& mesh) {
    std::ofstream out(mesh_path(), std::ios::binary);
    out << header(mesh, "binary_big_endian");
    const auto put = [&](std::uint32_t bits) {
      const std::array<char, 4> bytes{static_cast<char>(bits >> 24), static_cast<char>(bits >> 16),
                                      static_cast<char>(bits >> 8), static_cast<char>(bits)};
      out.write(bytes.data(), 4);
    };
    const auto channels = static_cast<std::size_t>(mesh.layout.channels());
    for (std::size_t v = 0; v < mesh.shape.positions.size(); ++v) {
      const Vec3f p = mesh.shape.positions[v];
      for (const float x : {p.x, p.y, p.z})
        put(std::bit_cast<std::uint32_t>(x));
      for (std::size_t k = 0; k < channels; ++k) {
        const float value = mesh.attributes[v * channels + k];
        const bool is_colour = mesh.layout.colour_channels() > 0 &&
                               k >= mesh.layout.part(AttributeKind::colours).first &&
                               k < mesh.layout.part(AttributeKind::texcoords).first;
        is_colour ? void(out.put(static_cast<char>(value)))
                  : put(std::bit_cast<std::uint32_t>(value));
      }
    }
    for (const tests::MeshTriangle& t : mesh.shape.triangles) {
      out.put(3);
      for (const std::uint32_t corner : t)
        put(corner);
    }
  }

  static std::string header(const RichMesh& mesh, const std::string& format) {
    std::ostringstream text;
    text << "ply\nformat " << format << " 1.0\nelement vertex " << mesh.shape.positions.size()
         << "\nproperty float x\nproperty float y\nproperty float z\n";
    if (mesh.layout.normals)
      text << "property float nx\nproperty float ny\nproperty float nz\n";
    if (mesh.layout.colour == ColourType::u8)
      text << "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    if (mesh.layout.alpha)
      text << "property uchar alpha\n";
    if (mesh.layout.texcoords)
      text << "property float s\nproperty float t\n";
    text << "element face " << mesh.shape.triangles.size()
         << "\nproperty list uchar int vertex_indices\nend_header\n";
    return text.str();
  }

  config::Config config() const {
    config::Config config = tests::smooth_config();
    config.input = mesh_path();
    config.output = directory_.path() / "mesh.hier";
    return config;
  }

  FileHashes build(config::Config config, const Conditions& conditions) {
    config.threads = conditions.threads;
    config.memory_budget = conditions.budget;
    execution::NoProgress progress;
    pipeline::build_hierarchy(config, {.force = true},
                              {*files_, progress, execution::CancelToken()});
    FileHashes hashes;
    for (const auto& entry : fs::recursive_directory_iterator(config.output)) {
      if (entry.is_regular_file()) {
        hashes[entry.path().lexically_relative(config.output).string()] =
            storage::checksum(storage::read_file(*files_, entry.path(), kGiB));
      }
    }
    return hashes;
  }

  /// Bytes that a build of two threads reads; its result must be as expected.
  std::uint64_t read_by(const config::Config& config, std::uint64_t budget,
                        const FileHashes& expected) {
    const std::uint64_t before = files_->counters().bytes_read;
    EXPECT_EQ(build(config, {2, budget}), expected)
        << "2 threads, " << execution::exact_size_text(budget);
    return files_->counters().bytes_read - before;
  }

  /// Builds under all conditions, each once, and expects one result.
  void expect_one_result(const config::Config& config,
                         const std::vector<std::uint32_t>& threads = {1, 2, 5}) {
    const std::uint64_t tight = tests::tight_budget(config, *files_);
    const FileHashes expected = build(config, {1, 4 * kGiB});
    EXPECT_GE(expected.size(), 4U);
    const std::uint64_t in_memory = read_by(config, 4 * kGiB, expected);
    const std::uint64_t on_disk = read_by(config, tight, expected);
    EXPECT_GT(on_disk, in_memory * 6 / 5) << "the least budget did not use the disk";
    const std::uint64_t middle = std::max(64 * kMiB, tight + tight / 2);
    for (const std::uint64_t budget : {4 * kGiB, middle, tight}) {
      for (const std::uint32_t count : threads) {
        const bool is_done = budget != middle && (count == 2 || (count == 1 && budget != tight));
        if (is_done)
          continue;
        EXPECT_EQ(build(config, {count, budget}), expected)
            << count << " threads, " << execution::exact_size_text(budget);
      }
    }
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

struct Case {
  const char* name;
  std::function<RichMesh()> make;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"sphere", [] { return plain(tests::sphere(6000, 0.01F)); }},
      {"sphere, shuffled", [] { return plain(tests::shuffled(tests::sphere(6000, 0.01F), 3)); }},
      {"open grid", [] { return plain(tests::open_grid(50, 60, 0.2F)); }},
      {"non-manifold", [] { return plain(tests::non_manifold(5000)); }},
      {"duplicates", [] { return plain(tests::duplicates(5000)); }},
      {"soup", [] { return plain(tests::soup(1500)); }},
      {"points", [] { return plain(tests::points(3000)); }},
      {"torus with attributes", [] { return rich(tests::torus(6000, 0.01F)); }},
      {"points with attributes", [] { return rich(tests::points(3000)); }},
      {"split, without attributes", [] { return split(tests::sphere(4000, 0.01F), "soup"); }},
      {"split by all attributes", [] { return split(tests::torus(6000, 0.02F), "mixed"); }},
  };
  return all;
}

TEST_F(DeterminismTest, SLOW_ThreadsAndMemoryDoNotMatter) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    write_binary(c.make());
    config::Config with = config();
    with.partition.vertices = 200;
    expect_one_result(with);
  }
}

TEST_F(DeterminismTest, ThreadsAndMemoryDoNotMatterForAnyPartitionCount) {
  write_binary(rich(tests::torus(5000, 0.01F)));
  for (const std::uint32_t count : {1U, 2U, 3U, 5U, 100U, 128U}) {
    SCOPED_TRACE(count);
    config::Config with = config();
    with.partition.count = count;
    with.preview = false;  // methods and counts change the tiles only
    expect_one_result(with, {1, 5});
  }
}

TEST_F(DeterminismTest, ThreadsAndMemoryDoNotMatterForAnyMethod) {
  write_binary(rich(tests::genus_n(3, 5000, 0.01F)));
  for (const auto& [name, method] : tests::all_simplify_methods()) {
    SCOPED_TRACE(name);
    for (const config::AxisRule axis : {config::AxisRule::longest, config::AxisRule::compactness}) {
      config::Config with = config();
      with.partition.vertices = 150;
      with.partition.axis = axis;
      with.preview = false;
      with.simplify = method;
      with.simplify.vertices = TargetVertexCounts({140, 90, 120, 100});
      expect_one_result(with, {5});
    }
  }
}

TEST_F(DeterminismTest, TheFormOfTheFileDoesNotMatter) {
  for (const RichMesh& mesh :
       {plain(tests::sphere(5000, 0.01F)), rich(tests::torus(5000, 0.01F))}) {
    config::Config with = config();
    with.partition.vertices = 200;
    write_binary(mesh);
    FileHashes expected = build(with, {});
    expected.erase("hierarchy.json");  // it tells of the source, and its checksum
    EXPECT_GE(expected.size(), 4U);
    for (const bool is_text : {true, false}) {
      is_text ? write_text(mesh) : write_big_endian(mesh);
      for (const std::uint64_t budget : {4 * kGiB, tests::tight_budget(with, *files_)}) {
        FileHashes found = build(with, {2, budget});
        EXPECT_EQ(found.erase("hierarchy.json"), 1U);
        EXPECT_EQ(found, expected) << (is_text ? "text" : "big endian");
      }
    }
  }
}

TEST_F(DeterminismTest, TheOrderOfTheTrianglesDoesNotMatter) {
  for (RichMesh mesh :
       {plain(tests::sphere(6000, 0.01F)), split(tests::torus(6000, 0.02F), "mixed")}) {
    config::Config with = config();
    with.partition.vertices = 200;
    write_binary(mesh);
    FileHashes expected = build(with, {});
    std::ranges::reverse(mesh.shape.triangles);
    for (std::size_t i = 0; i < mesh.shape.triangles.size(); i += 2)
      std::ranges::rotate(mesh.shape.triangles[i], mesh.shape.triangles[i].begin() + 1);
    write_binary(mesh);
    FileHashes found = build(with, {});
    expected.erase("hierarchy.json");
    found.erase("hierarchy.json");
    EXPECT_EQ(found, expected);
  }
}

TEST_F(DeterminismTest, AnotherConfigGivesAnotherResult) {
  // Else the comparisons above would prove nothing.
  write_binary(plain(tests::sphere(5000, 0.01F)));
  config::Config with = config();
  with.partition.vertices = 200;
  const FileHashes expected = build(with, {});
  with.simplify.method = config::SimplifyMethod::half_edge;
  EXPECT_NE(build(with, {}), expected);
  with.simplify.method = config::SimplifyMethod::edge_collapse;
  EXPECT_EQ(build(with, {}), expected);
  with.partition.axis = config::AxisRule::longest;
  EXPECT_NE(build(with, {}), expected);
}

/// So large that the upper part of the tree is settled by streaming, and planned with a sample.
using LargeDeterminismTest = DeterminismTest;

TEST_F(LargeDeterminismTest, SLOW_AMeshOfSeveralChunks) {
  const RichMesh mesh = rich(tests::shuffled(tests::sphere(500'000, 0.002F), 9));
  ASSERT_GT(mesh.shape.positions.size(), partition::kChunkVertices);
  write_binary(mesh);
  expect_one_result(config(), {1, 5});
}

TEST_F(LargeDeterminismTest, SLOW_AMeshOfSeveralChunksWithSeveralVerticesAtEachPlace) {
  const TestMesh sphere = tests::shuffled(tests::sphere(500'000, 0.002F), 9);
  ASSERT_GT(sphere.positions.size(), partition::kChunkVertices);
  write_binary(split(sphere, "charts"));
  expect_one_result(config(), {5});
  write_binary(split(sphere, "soup"));
  expect_one_result(config(), {5});
}

TEST_F(LargeDeterminismTest, SLOW_AMeshOfManyEqualCoordinates) {
  const TestMesh grid = tests::open_grid(500, 500);  // every median falls into a tie
  ASSERT_GT(grid.positions.size(), partition::kChunkVertices);
  write_binary(plain(grid));
  config::Config with = config();
  with.partition.axis = config::AxisRule::longest;
  expect_one_result(with, {2});
}

TEST_F(LargeDeterminismTest, SLOW_AMeshThatIsSampled) {
  const RichMesh mesh = plain(tests::shuffled(tests::torus(1'200'000, 0.001F), 9));
  ASSERT_GT(mesh.shape.positions.size(), partition::kSampleVertices);
  write_binary(mesh);
  expect_one_result(config(), {1, 5});
}

}  // namespace
}  // namespace meshhier::pipeline
