// Whole builds: inputs at the edge of what there is, and what is refused.
#include "pipeline/build.h"

#include "base/error.h"
#include "bench/generator.h"
#include "bench/stress.h"
#include "execution/size_text.h"
#include "hierarchy/cut.h"
#include "pipeline/estimate.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/layout.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/interrupter.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/simplify_methods.h"
#include "tests/support/sizes.h"
#include "verify/verify.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::kMiB;
using tests::TestMesh;

/// One mesh, one output.
class BuildTest : public testing::Test {
 protected:
  fs::path mesh_path() const { return directory_.path() / "mesh.ply"; }
  fs::path output_path() const { return directory_.path() / "mesh.hier"; }

  config::Config config(std::uint32_t partition_vertices = 100) const {
    config::Config config = tests::quick_config();
    config.input = mesh_path();
    config.output = output_path();
    config.threads = 2;
    config.partition.vertices = partition_vertices;
    return config;
  }

  pipeline::BuildReport build(const config::Config& config, bool force = false) {
    execution::NoProgress progress;
    return pipeline::build_hierarchy(config, {.force = force},
                                     {files_, progress, execution::CancelToken()});
  }

  pipeline::BuildReport build(const TestMesh& mesh, const config::Config& config) {
    tests::write_ply(mesh, mesh_path());
    return build(config);
  }

  /// The failure of a build that must fail; nothing may be left of it.
  Error failure(const config::Config& config, bool force = false) {
    const std::set<fs::path> before = listing();
    try {
      build(config, force);
    } catch (const Error& error) {
      EXPECT_EQ(listing(), before) << "something was left behind";
      return error;
    }
    ADD_FAILURE() << "the build did not fail";
    return {ErrorCode::internal, ""};
  }

  std::set<fs::path> listing() const {
    std::set<fs::path> all;
    for (const auto& entry : fs::recursive_directory_iterator(directory_.path()))
      all.insert(entry.path());
    return all;
  }

  std::vector<std::string> problems() {
    execution::NoProgress progress;
    return verifying::verify_hierarchy(files_, output_path(), {.input = mesh_path(), .cuts = 30},
                                       progress, execution::CancelToken())
        .problems;
  }

  /// Builds and proves it lossless and seamless, twice: in memory, and on disk.
  void expect_builds(const TestMesh& mesh, config::Config config) {
    build(mesh, config);
    EXPECT_THAT(problems(), IsEmpty());
    expect_level_table();
    fs::remove_all(output_path());
    config.memory_budget = tight_budget(config);
    config.threads = 1;
    build(config);
    EXPECT_THAT(problems(), IsEmpty());
    fs::remove_all(output_path());
  }

  /// Partitions equal +-1; simplified tiles as asked or fewer; errors decreasing.
  void expect_level_table() {
    const storage::HierarchyReader reader(files_, output_path());
    const Tree& tree = reader.tree();
    for (const TileRecord& record : reader.records()) {
      if (tree.is_partition(record.node)) {
        EXPECT_EQ(record.own_count, tree.ranks(record.node).size());
        EXPECT_EQ(record.error, 0);
        EXPECT_EQ(record.bound, 0);
      } else {
        EXPECT_LE(record.own_count, record.target_count);
        EXPECT_TRUE(std::isfinite(record.error));
        EXPECT_TRUE(std::isfinite(record.bound));
        const Tree::Children children = tree.children(record.node);
        for (const NodeId child : children.span())
          EXPECT_GT(record.error, reader.record(child).error);
      }
    }
  }

  /// Returns an estimate's words against the budget; empty if it is enough.
  std::string refusal(config::Config config) {
    config.output += ".none";
    try {
      pipeline::estimate_build(config, true, files_);
      return "";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::budget) << error.what();
      return error.what();
    }
  }

  std::uint64_t named_budget(config::Config config) {
    config.memory_budget = 1;
    const std::string message = refusal(config);
    const std::string before = "at least ";
    const std::size_t at = message.find(before);
    EXPECT_NE(at, std::string::npos) << message;
    return execution::parse_size(message.substr(at + before.size())).value_or(0);
  }

  /// Builds, is refused for want of memory, and adds what the refusal says.
  void give_what_is_told(config::Config& config) {
    std::string message;
    try {
      build(config);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::budget);
      message = error.what();
    }
    const std::string before = "larger by ";
    const std::size_t at = message.find(before);
    ASSERT_NE(at, std::string::npos) << message;
    *config.memory_budget += std::stoull(message.substr(at + before.size())) * kMiB;
  }

  /// The least budget to the byte: nothing is left for scratch data, all of it goes to the disk.
  std::uint64_t tight_budget(config::Config config) {
    std::uint64_t accepted = named_budget(config);  // rounded up
    std::uint64_t refused = accepted - kMiB;
    while (accepted - refused > 1) {
      config.memory_budget = (refused + accepted) / 2;
      (refusal(config).empty() ? accepted : refused) = *config.memory_budget;
    }
    return accepted;
  }

  tests::TemporaryDirectory directory_;
  tests::FaultyFileSystem files_;
};

// ---- what must build -----------------------------------------------------------------------

TEST_F(BuildTest, OneVertex) {
  expect_builds({{{1, 2, 3}}, {}}, config());
}

TEST_F(BuildTest, OneFace) {
  expect_builds({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}, config());
}

TEST_F(BuildTest, OneFaceInThreePartitions) {
  config::Config three = config();
  three.partition.count = 3;
  expect_builds({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}, three);
}

TEST_F(BuildTest, NoFaces) {
  expect_builds(tests::points(1000), config());
}

TEST_F(BuildTest, OnlyDegenerateFaces) {
  TestMesh mesh = tests::points(300);
  for (std::uint32_t i = 0; i < 300; ++i)
    mesh.triangles.push_back({i, (i * 7) % 300, i});
  expect_builds(mesh, config());
  const std::string text = build(config()).text;
  EXPECT_THAT(text, HasSubstr("dropped 300 degenerate triangles"));
  EXPECT_THAT(text, HasSubstr("kept 300 vertices that no triangle uses"));
}

TEST_F(BuildTest, AllVerticesEqual) {
  TestMesh mesh;
  mesh.positions.assign(1000, Vec3f{3, -4, 5});
  for (std::uint32_t i = 0; i + 2 < 1000; ++i)
    mesh.triangles.push_back({i, i + 1, i + 2});
  expect_builds(mesh, config());
}

TEST_F(BuildTest, AllVerticesOnALine) {
  TestMesh mesh;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    mesh.positions.push_back({static_cast<float>(i % 500), 0, 0});
    if (i >= 2)
      mesh.triangles.push_back({i - 2, i - 1, i});
  }
  expect_builds(mesh, config());
}

TEST_F(BuildTest, AsManyPartitionsAsVertices) {
  config::Config each = config();
  each.partition.count = 66;
  expect_builds(tests::sphere(128), each);
}

TEST_F(BuildTest, TheSmallestTiles) {
  expect_builds(tests::torus(3000, 0.01F), config(4));
}

TEST_F(BuildTest, TilesOfUnequalAsking) {
  config::Config coarse = config(500);
  coarse.simplify.vertices = 4;
  expect_builds(tests::sphere(5000), coarse);
  config::Config fine = config(20);
  fine.simplify.vertices = 32768;
  expect_builds(tests::sphere(5000), fine);
  config::Config uneven = config(200);
  uneven.simplify.vertices = TargetVertexCounts({32768, 4, 300, 20});
  expect_builds(tests::sphere(5000), uneven);
}

TEST_F(BuildTest, AMeshSmallerThanAPartition) {
  build(tests::sphere(500), config(32768));
  EXPECT_THAT(problems(), IsEmpty());
  const storage::HierarchyReader reader(files_, output_path());
  ASSERT_EQ(reader.records().size(), 1U);
  EXPECT_EQ(reader.records()[0].border_count, 0U);
}

TEST_F(BuildTest, TwoVerticesInTwoPartitions) {
  config::Config two = config();
  two.partition.count = 2;
  expect_builds({{{0, 0, 0}, {1, 0, 0}}, {}}, two);
}

TEST_F(BuildTest, SLOW_AHundredThousandSeparateTriangles) {
  expect_builds(tests::soup(100'000), config(8192));
}

TEST_F(BuildTest, SLOW_AVertexOfAHundredThousandTriangles) {
  TestMesh fan;
  fan.positions.push_back({0, 0, 1});
  for (std::uint32_t i = 0; i < 100'000; ++i) {
    const double angle = 2 * 3.141592653589793 * i / 100'000;
    fan.positions.push_back(
        {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0});
    fan.triangles.push_back({0, 1 + i, 1 + (i + 1) % 100'000});
  }
  build(fan, config(4096));
  EXPECT_THAT(problems(), IsEmpty());
  fs::remove_all(output_path());
  // No plan knows from the header that one tile has all triangles: what would do is told then.
  config::Config tight = config(4096);
  tight.memory_budget = tight_budget(tight);
  tight.threads = 1;
  ASSERT_NO_FATAL_FAILURE(give_what_is_told(tight));
  const std::string report = build(tight).text;
  EXPECT_THAT(report, HasSubstr("went on")) << "with more memory it is the same build";
  EXPECT_THAT(problems(), IsEmpty());
}

/// Its triangles reach across it: nearly all are in each tile of every level.
TEST_F(BuildTest, SLOW_ASoupIsToldOnceWhatDoes) {
  constexpr std::uint32_t kVertices = 12'000, kTriangles = 80'000;
  TestMesh soup = tests::points(kVertices);
  const auto corner = [](std::uint32_t i, std::uint64_t stream) {
    return static_cast<std::uint32_t>((tests::hash_noise(i, stream) / 2 + 0.5F) * kVertices) %
           kVertices;
  };
  for (std::uint32_t i = 0; i < kTriangles; ++i)
    soup.triangles.push_back({corner(i, 1), corner(i, 2), corner(i, 3)});
  tests::write_ply(soup, mesh_path());
  config::Config tight = config(1000);
  tight.memory_budget = tight_budget(tight);
  tight.threads = 1;
  ASSERT_NO_FATAL_FAILURE(give_what_is_told(tight));
  EXPECT_THAT(build(tight).text, HasSubstr("went on"));
}

TEST_F(BuildTest, HugeAndTinyCoordinates) {
  for (const float unit : {1e30F, 1e-30F, 1e-40F}) {
    SCOPED_TRACE(unit);
    TestMesh mesh = tests::sphere(2000, 0.02F);
    for (Vec3f& p : mesh.positions)
      p = p * unit;
    expect_builds(mesh, config());
  }
}

TEST_F(BuildTest, CoordinatesOfAllMagnitudesAtOnce) {
  TestMesh mesh = tests::points(2000);
  for (std::uint32_t i = 0; i < 2000; ++i) {
    Vec3f& p = mesh.positions[i];
    p = p * std::pow(10.0F, 30 * tests::hash_noise(i, 99));
    mesh.triangles.push_back({i, (i + 1) % 2000, (i + 7) % 2000});
  }
  expect_builds(mesh, config());
}

TEST_F(BuildTest, TheLargestCoordinates) {
  TestMesh mesh = tests::sphere(2000, 0.02F);
  for (Vec3f& p : mesh.positions)
    p = p * 0x1.fp125F;
  expect_builds(mesh, config());
}

TEST_F(BuildTest, SLOW_ShapesOfAllKinds) {
  const std::vector<std::pair<std::string, TestMesh>> meshes = {
      {"sphere", tests::sphere(4000, 0.01F)},
      {"genus 5", tests::genus_n(5, 4000, 0.01F)},
      {"nested shells", tests::nested_shells(4000)},
      {"open grid", tests::open_grid(40, 50, 0.2F)},
      {"moebius", tests::moebius(3000)},
      {"non-manifold", tests::non_manifold(3000, 0.01F)},
      {"duplicates", tests::duplicates(3000)},
      {"shuffled", tests::shuffled(tests::torus(4000, 0.01F), 5)}};
  for (const auto& [name, mesh] : meshes) {
    for (const auto& [method_name, method] : tests::all_simplify_methods()) {
      SCOPED_TRACE(name + ", " + method_name);
      config::Config with = config(150);
      with.simplify = method;
      with.partition.axis = method.method == config::SimplifyMethod::half_edge
                                ? config::AxisRule::longest
                                : config::AxisRule::compactness;
      expect_builds(mesh, with);
    }
  }
}

// ---- what a result is ----------------------------------------------------------------------

TEST_F(BuildTest, CompressionChangesNothingButTheFiles) {
  build(tests::torus(3000, 0.1F), config());
  std::vector<PublishedTile> plain;
  {
    const storage::HierarchyReader reader(files_, output_path());
    for (const TileRecord& record : reader.records())
      plain.push_back(reader.read_tile(record.node));
  }
  for (const storage::CompressionRow& row : config::kCompressions) {
    config::Config packed = config();
    packed.storage.compression = row.value;
    build(packed, true);
    EXPECT_THAT(problems(), IsEmpty()) << row.name;
    const storage::HierarchyReader reader(files_, output_path());
    EXPECT_EQ(reader.manifest().compression, row.value);
    ASSERT_EQ(reader.records().size(), plain.size());
    for (const PublishedTile& tile : plain) {
      const PublishedTile back = reader.read_tile(tile.node);
      EXPECT_EQ(back.mesh.vertices.positions, tile.mesh.vertices.positions);
      EXPECT_EQ(back.mesh.interior, tile.mesh.interior);
      EXPECT_EQ(back.mesh.border, tile.mesh.border);
      EXPECT_EQ(back.parent_map, tile.parent_map);
      EXPECT_EQ(back.chains, tile.chains);
    }
  }
}

TEST_F(BuildTest, QuantizedPositionsLieOnTheLatticeAndBoundsSaySo) {
  build(tests::torus(3000, 0.1F), config());
  const storage::HierarchyReader exact(files_, output_path());
  const std::vector<TileRecord> before = exact.records();
  for (const std::uint32_t bits : {8U, 16U, 20U}) {
    for (const config::Compression compression :
         {storage::Compression::none, storage::Compression::meshopt}) {
      config::Config coarse = config();
      coarse.storage = {storage::Container::files, compression, bits};
      build(coarse, true);
      EXPECT_THAT(problems(), IsEmpty()) << bits;
      const storage::HierarchyReader reader(files_, output_path());
      ASSERT_TRUE(reader.manifest().quantization.has_value());
      const auto& [lattice, worst] = *reader.manifest().quantization;
      EXPECT_EQ(lattice.bits, static_cast<int>(bits));
      EXPECT_GT(worst, 0);
      EXPECT_LE(worst, lattice.step);  // the root of 3 halves, as far as nothing lies outside
      for (std::size_t i = 0; i < before.size(); ++i) {
        const TileRecord& record = reader.records()[i];
        EXPECT_GE(record.bound, before[i].bound + worst);
        EXPECT_EQ(record.error, before[i].error);
        if (record.node == NodeId{})
          continue;
        EXPECT_LT(record.bound, reader.record(reader.tree().parent_tile(record.node)).bound);
        for (const Vec3f& p : reader.read_tile(record.node).mesh.vertices.positions)
          ASSERT_EQ(lattice.nearest(p), p);
      }
    }
  }
}

TEST_F(BuildTest, AQuantizedHierarchyIsHeldAgainstItsInput) {
  config::Config coarse = config();
  coarse.storage.position_bits = 10;
  TestMesh mesh = tests::torus(1000, 0.1F);
  build(mesh, coarse);
  EXPECT_THAT(problems(), IsEmpty());
  mesh.positions[17].x += 0.25F;
  tests::write_ply(mesh, mesh_path());
  EXPECT_THAT(problems(), Contains(HasSubstr("vertices, but some are not the same")));
}

TEST_F(BuildTest, PartitionSizesAreEqualForAnyCount) {
  tests::write_ply(tests::torus(3000), mesh_path());
  for (const std::uint32_t count : {1U, 2U, 3U, 5U, 7U, 100U, 128U, 1000U}) {
    config::Config with = config();
    with.partition.count = count;
    build(with, true);
    const storage::HierarchyReader reader(files_, output_path());
    std::uint32_t least = std::numeric_limits<std::uint32_t>::max();
    std::uint32_t most = 0;
    std::uint32_t partitions = 0;
    for (const TileRecord& record : reader.records()) {
      if (!reader.tree().is_partition(record.node))
        continue;
      ++partitions;
      least = std::min(least, record.own_count);
      most = std::max(most, record.own_count);
    }
    EXPECT_EQ(partitions, count);
    EXPECT_LE(most - least, 1U) << count << " partitions";
  }
}

TEST_F(BuildTest, SLOW_SimplifiedTilesHaveTheVertexCountAskedFor) {
  build(tests::sphere(20'000, 0.01F), config(300));
  const storage::HierarchyReader reader(files_, output_path());
  for (const TileRecord& record : reader.records()) {
    if (reader.tree().is_partition(record.node))
      continue;
    EXPECT_EQ(record.target_count, 300U);
    EXPECT_EQ(record.own_count, 300U);
  }
}

TEST_F(BuildTest, SLOW_SimplifiedTilesHaveTheVertexCountsAskedForByLevel) {
  // Half a tile's children, more, fewer; the last one holds for all deeper levels.
  const TargetVertexCounts asked({250, 330, 120, 230, 200});
  tests::write_ply(tests::sphere(20'000, 0.01F), mesh_path());
  for (const auto& [name, method] : tests::all_simplify_methods()) {
    SCOPED_TRACE(name);
    config::Config with = config(150);
    with.simplify = method;
    with.simplify.vertices = asked;
    build(with, true);
    EXPECT_THAT(problems(), IsEmpty());
    const storage::HierarchyReader reader(files_, output_path());
    ASSERT_EQ(reader.tree().depth(), Level{7});
    EXPECT_EQ(reader.manifest().config["simplify"]["vertices"].dump(), "[250,330,120,230,200]");
    for (const TileRecord& record : reader.records()) {
      if (reader.tree().is_partition(record.node))
        continue;
      // Level 1 is made of two tiles of 120 vertices: a sixteenth fewer.
      const bool is_short = record.node.level == Level{1};
      EXPECT_EQ(record.target_count, asked.of(record.node.level));
      EXPECT_EQ(record.own_count, is_short ? 225U : asked.of(record.node.level))
          << to_text(record.node);
    }
  }
}

TEST_F(BuildTest, LevelsThatAreNotThereAreAskedInVain) {
  tests::write_ply(tests::sphere(5000), mesh_path());
  const auto hashes = [&](const TargetVertexCounts& vertices) {
    config::Config with = config(300);  // levels 0 to 3 are simplified
    with.simplify.vertices = vertices;
    build(with, true);
    const storage::HierarchyReader reader(files_, output_path());
    EXPECT_EQ(reader.tree().depth(), Level{4});
    return reader.manifest().index_checksum;
  };
  const std::uint64_t expected = hashes(TargetVertexCounts({200, 210, 220, 230}));
  EXPECT_EQ(hashes(TargetVertexCounts({200, 210, 220, 230, 4, 32768})), expected);
  EXPECT_NE(hashes(TargetVertexCounts({200, 210, 220})), expected);
  EXPECT_EQ(hashes(TargetVertexCounts({200, 200})), hashes(200));
}

TEST_F(BuildTest, TheReportTellsWhatWasDone) {
  const std::string text = build(tests::sphere(5000), config()).text;
  EXPECT_THAT(text, HasSubstr("vertices"));
  EXPECT_THAT(text, HasSubstr("partitions"));
  EXPECT_THAT(text, HasSubstr("levels"));
}

TEST_F(BuildTest, TheReportWarnsOnlyWhereCareWasGivenUp) {
  EXPECT_THAT(build(tests::sphere(5000), config()).text, testing::Not(HasSubstr("warning")));
  fs::remove_all(output_path());
  const std::string text = build(tests::soup(2000), config()).text;
  EXPECT_THAT(
      text, testing::ContainsRegex("warning: [0-9]+ vertices \\([0-9.]+ % of the input's\\) went"));
}

TEST_F(BuildTest, TheAccountAddsUp) {
  tests::write_ply(tests::sphere(60'000), mesh_path());
  config::Config tight = config(500);
  tight.memory_budget = tight_budget(tight);
  const pipeline::BuildStats stats = build(tight).stats;
  EXPECT_EQ(stats.input_bytes, fs::file_size(mesh_path()));
  std::uint64_t published = 0;
  for (const auto& entry : fs::recursive_directory_iterator(output_path()))
    published += entry.is_regular_file() ? entry.file_size() : 0;
  EXPECT_EQ(stats.output_bytes, published);
  EXPECT_EQ(stats.total.bytes.output_written, published);
  EXPECT_GE(stats.total.bytes.input_read, stats.input_bytes);
  EXPECT_GT(stats.peak_temporary_bytes, 0U);
  EXPECT_LE(stats.peak_temporary_bytes, stats.total.bytes.temporary_written);
  Traffic sum;
  for (const StageStats& stage : stats.stages) {
    sum.temporary_written += stage.bytes.temporary_written;
    sum.temporary_read += stage.bytes.temporary_read;
    EXPECT_LE(stage.peak_resident_bytes, stats.total.peak_resident_bytes);
  }
  EXPECT_EQ(sum.temporary_written, stats.total.bytes.temporary_written);
  EXPECT_EQ(sum.temporary_read, stats.total.bytes.temporary_read);
  EXPECT_EQ(stats.config["partition"]["vertices"], 500);
}

TEST_F(BuildTest, WhatIsInMemoryIsReadFromThere) {
  const pipeline::BuildStats stats = build(tests::sphere(5000), config()).stats;
  const auto chunks = std::ranges::find(stats.stages, "leaves", &StageStats::name);
  ASSERT_NE(chunks, stats.stages.end());
  EXPECT_GT(stats.total.bytes.temporary_written, 0U);
  EXPECT_EQ(stats.total.bytes.temporary_read, chunks->bytes.temporary_read);
}

TEST_F(BuildTest, NothingButTheOutputIsLeft) {
  tests::write_ply(tests::sphere(5000), mesh_path());
  build(config());
  std::set<fs::path> names;
  for (const auto& entry : fs::directory_iterator(directory_.path()))
    names.insert(entry.path());
  EXPECT_EQ(names, (std::set<fs::path>{mesh_path(), output_path()}));
  EXPECT_FALSE(fs::exists(storage::work_path(output_path())));
}

// ---- what is refused -----------------------------------------------------------------------

TEST_F(BuildTest, WorkOfAStoppedBuildOutlivesOneThatDoesNotBegin) {
  tests::write_ply(tests::sphere(500), mesh_path());
  const fs::path journal = storage::journal_path(storage::work_path(output_path()));
  fs::create_directories(journal.parent_path());
  std::ofstream(journal) << "what is done";
  execution::NoProgress progress;
  const auto begin = [&](Restart restart, std::function<bool()> is_due) {
    BuildOptions options{.restart = restart};
    options.is_due = std::move(is_due);
    return build_if_due(config(), options, {files_, progress, execution::CancelToken()});
  };
  EXPECT_FALSE(begin(Restart::never, [] { return false; }));
  EXPECT_TRUE(fs::exists(journal)) << "it was not due";
  EXPECT_THROW(begin(Restart::always, []() -> bool { throw Error(ErrorCode::interrupted, ""); }),
               Error);
  EXPECT_TRUE(fs::exists(journal)) << "it was interrupted when it asked";
  EXPECT_TRUE(begin(Restart::always, [] { return true; }));
  EXPECT_FALSE(fs::exists(journal.parent_path()));
}

TEST_F(BuildTest, AMeshWithoutVerticesIsRefused) {
  tests::write_ply({}, mesh_path());
  const Error error = failure(config());
  EXPECT_EQ(error.code(), ErrorCode::input);
  EXPECT_THAT(error.what(), HasSubstr("no vertices"));
}

TEST_F(BuildTest, MorePartitionsThanVerticesAreRefused) {
  tests::write_ply(tests::points(99), mesh_path());
  config::Config with = config();
  with.partition.count = 100;
  const Error error = failure(with);
  EXPECT_EQ(error.code(), ErrorCode::usage);
  EXPECT_THAT(error.what(), HasSubstr("partition.count is 100"));
  EXPECT_THAT(error.what(), HasSubstr("99 vertices"));
}

TEST_F(BuildTest, SLOW_TooFewPartitionsAreRefusedNamingTheLeastCount) {
  tests::write_ply(tests::points(70'000), mesh_path());
  config::Config with = config();
  with.partition.count = 2;
  const Error error = failure(with);
  EXPECT_EQ(error.code(), ErrorCode::usage);
  EXPECT_THAT(error.what(), HasSubstr("at least 3"));
  with.partition.count = 3;
  EXPECT_NO_THROW(build(with));
}

TEST_F(BuildTest, ABudgetBelowTheLeastIsRefusedAndTheLeastWorks) {
  tests::write_ply(tests::sphere(20'000), mesh_path());
  config::Config with = config(1000);
  const std::uint64_t least = named_budget(with);
  with.memory_budget = least - kMiB;
  EXPECT_EQ(failure(with).code(), ErrorCode::budget);
  with.memory_budget = least;
  EXPECT_NO_THROW(build(with));
}

TEST_F(BuildTest, AnExistingOutputIsRefusedUnlessForced) {
  build(tests::sphere(1000), config());
  const std::uintmax_t before = fs::file_size(storage::manifest_path(output_path()));
  EXPECT_EQ(failure(config()).code(), ErrorCode::exists);
  EXPECT_EQ(fs::file_size(storage::manifest_path(output_path())), before);
  tests::write_ply(tests::torus(3000), mesh_path());
  EXPECT_NO_THROW(build(config(), true));
  EXPECT_THAT(problems(), IsEmpty());
}

TEST_F(BuildTest, ADirectoryThatIsNoHierarchyIsNeverReplaced) {
  tests::write_ply(tests::sphere(1000), mesh_path());
  fs::create_directory(output_path());
  std::ofstream(output_path() / "diary.txt") << "precious";
  EXPECT_EQ(failure(config(), true).code(), ErrorCode::exists);
  EXPECT_TRUE(fs::exists(output_path() / "diary.txt"));
}

TEST_F(BuildTest, AMissingInputIsRefused) {
  const Error error = failure(config());
  EXPECT_EQ(error.code(), ErrorCode::io);
  EXPECT_THAT(error.what(), HasSubstr("mesh.ply"));
}

TEST_F(BuildTest, ABrokenMeshLeavesNothing) {
  std::ofstream(mesh_path()) << "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                                "property float y\nproperty float z\nelement face 1\n"
                                "property list uchar int vertex_indices\nend_header\n"
                                "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n";
  const Error error = failure(config());
  EXPECT_EQ(error.code(), ErrorCode::input);
  EXPECT_THAT(error.what(), HasSubstr("line 13"));
}

TEST_F(BuildTest, AFailureLeavesNoParentDirectoryBehind) {
  std::ofstream(mesh_path()) << "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                                "property float y\nproperty float z\nend_header\n0 0 nan\n";
  config::Config with = config();
  with.output = directory_.path() / "not" / "yet" / "there.hier";
  EXPECT_EQ(failure(with).code(), ErrorCode::input);
}

// ---- the disk ------------------------------------------------------------------------------

/// Watches how much lies in a directory while a build runs.
class DiskWatch final : public execution::Progress {
 public:
  explicit DiskWatch(fs::path directory) : directory_(std::move(directory)) {}
  void stage(std::string_view, std::uint64_t, std::string_view) override { look(); }
  void advance(std::uint64_t) override {
    constexpr int kSeldom = 64;  // listing the files of every tile for every tile takes minutes
    if (++advances_ % kSeldom == 0)
      look();
  }
  void finish(std::string_view) override {}
  std::uint64_t most_bytes() {
    look();
    return most_bytes_;
  }

 private:
  void look() {
    const std::lock_guard lock(mutex_);
    std::uint64_t bytes = 0;
    std::error_code gone;  // files come and go meanwhile
    for (fs::recursive_directory_iterator at(directory_, gone), end; at != end;
         at.increment(gone)) {
      const std::uintmax_t size = at->is_regular_file(gone) ? at->file_size(gone) : 0;
      bytes += gone ? 0 : size;
    }
    most_bytes_ = std::max(most_bytes_, bytes);
  }

  fs::path directory_;
  std::mutex mutex_;
  std::uint64_t most_bytes_ = 0;
  std::atomic<int> advances_{0};
};

class DiskTest : public BuildTest {
 protected:
  /// Returns whether a disk with that much room is let through.
  bool is_accepted(const config::Config& config, std::uint64_t room) {
    execution::CancelToken cancel;
    tests::StageInterrupter progress(cancel, "ingest");  // the first one that a plan is needed for
    tests::FaultyFileSystem files;
    files.limit_room(room);
    try {
      pipeline::build_hierarchy(config, {}, {files, progress, cancel});
    } catch (const Error& error) {
      EXPECT_THAT(error.code(), testing::AnyOf(ErrorCode::budget, ErrorCode::interrupted));
      return error.code() == ErrorCode::interrupted;
    }
    ADD_FAILURE() << "a cancelled build ran to its end";
    return false;
  }

  std::uint64_t least_room(const config::Config& config) {
    std::uint64_t refused = 0;
    std::uint64_t accepted = std::uint64_t{1} << 34;
    EXPECT_TRUE(is_accepted(config, accepted));
    while (accepted - refused > 1024) {
      const std::uint64_t middle = (refused + accepted) / 2;
      (is_accepted(config, middle) ? accepted : refused) = middle;
    }
    return accepted;
  }
};

TEST_F(DiskTest, TooLittleRoomIsRefusedBeforeAnythingIsRead) {
  tests::write_ply(tests::sphere(20'000), mesh_path());
  files_.limit_room(100'000);
  const Error error = failure(config(1000));
  EXPECT_EQ(error.code(), ErrorCode::budget);
  EXPECT_THAT(error.what(), HasSubstr("free"));
}

void expect_near(std::uint64_t predicted, std::uint64_t real) {
  const double ratio = static_cast<double>(predicted) / static_cast<double>(real);
  EXPECT_GT(ratio, 0.95);
  EXPECT_LT(ratio, 1.2);
}

TEST_F(DiskTest, SLOW_ThePredictionKnowsWhatIsAskedOfEachLevel) {
  tests::write_ply(tests::sphere(60'000, 0.01F), mesh_path());
  const std::vector<std::vector<std::uint32_t>> lists = {{937, 573, 364, 260, 198},
                                                         {50, 100, 200, 400, 800},
                                                         {4000, 2000, 1000, 500, 250},
                                                         {1000, 100, 1000, 100, 1000, 100},
                                                         {4, 4, 4, 4, 4, 2000}};
  for (const std::vector<std::uint32_t>& list : lists) {
    for (const std::uint32_t vertices : {150U, 1000U}) {
      config::Config with = config(vertices);
      with.simplify.vertices = TargetVertexCounts(list);
      with.memory_budget = tight_budget(with);
      const pipeline::BuildStats stats = build(with, true).stats;
      SCOPED_TRACE(fmt::format("{}, partitions of {}", fmt::join(list, ", "), vertices));
      expect_near(stats.predicted_temporary_bytes, stats.peak_temporary_bytes);
      expect_near(stats.predicted_output_bytes, stats.output_bytes);
    }
  }
}

TEST_F(DiskTest, SLOW_AWholeBuildTakesNoMoreRoomThanPredicted) {
  const std::vector<std::pair<std::string, TestMesh>> meshes = {
      {"sphere", tests::sphere(60'000, 0.01F)},
      {"scattered sphere", tests::shuffled(tests::sphere(60'000), 3)},
      {"soup", tests::soup(20'000)},
      {"points", tests::points(30'000)}};
  for (const auto& [name, mesh] : meshes) {
    tests::write_ply(mesh, mesh_path());
    const std::uint64_t before = fs::file_size(mesh_path());
    for (const auto& [vertices, container] : {std::pair{50U, storage::Container::files},
                                              {50U, storage::Container::archive},
                                              {300U, storage::Container::files},
                                              {300U, storage::Container::archive},
                                              {8192U, storage::Container::files}}) {
      config::Config with = config(vertices);
      with.storage.container = container;
      with.memory_budget = tight_budget(with);
      const std::uint64_t predicted = least_room(with);
      DiskWatch watch(directory_.path());
      pipeline::build_hierarchy(with, {}, {files_, watch, execution::CancelToken()});
      EXPECT_LE(watch.most_bytes() - before, predicted)
          << name << ", partitions of " << vertices << " vertices, container "
          << static_cast<int>(container);
      fs::remove_all(output_path());
    }
  }
}

TEST_F(DiskTest, SLOW_ThePredictionIsNearWhatASurfaceTakes) {
  const std::vector<std::pair<std::string, TestMesh>> meshes = {
      {"sphere", tests::sphere(60'000, 0.01F)},
      {"torus", tests::torus(60'000)},
      {"scattered sphere", tests::shuffled(tests::sphere(60'000), 3)}};
  for (const auto& [name, mesh] : meshes) {
    tests::write_ply(mesh, mesh_path());
    for (const auto method :
         {config::SimplifyMethod::edge_collapse, config::SimplifyMethod::cluster}) {
      for (const std::uint32_t vertices : {100U, 1000U}) {
        config::Config with = config(vertices);
        with.simplify.method = method;
        with.storage.container =
            vertices == 100 ? storage::Container::archive : storage::Container::files;
        with.memory_budget = tight_budget(with);
        fs::remove_all(output_path());
        const pipeline::BuildStats stats = build(with, true).stats;
        SCOPED_TRACE(fmt::format("{}, method {}, partitions of {} vertices", name,
                                 static_cast<int>(method), vertices));
        expect_near(stats.predicted_temporary_bytes, stats.peak_temporary_bytes);
        expect_near(stats.predicted_output_bytes, stats.output_bytes);
      }
    }
  }
}

// A header does not tell of a vertex that all triangles share.
TEST_F(DiskTest, SLOW_ThePredictionIsRefinedWhenThePartitionsAreKnown) {
  bench::write_ply(files_, {mesh_path(), true},
                   *bench::as_generated(bench::make_stress("hub", 100'000)));
  const config::Config with = config(1000);
  const std::uint64_t room = least_room(with);
  files_.limit_room(room + room / 8);
  try {
    build(with);
    FAIL() << "the disk was large enough";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::budget);
    EXPECT_THAT(error.what(), HasSubstr("the hierarchy will take about"));
    EXPECT_THAT(error.what(), HasSubstr("the same build goes on with it"));
  }
  files_.limit_room(16 * room);
  const pipeline::BuildStats stats = build(with).stats;
  // The header alone tells less than half.
  EXPECT_GE(stats.predicted_output_bytes * 10, stats.output_bytes * 9);
  EXPECT_LE(stats.predicted_output_bytes * 10, stats.output_bytes * 12);
  EXPECT_GE(stats.predicted_temporary_bytes * 10, stats.peak_temporary_bytes * 9);
  EXPECT_LE(stats.predicted_temporary_bytes * 10, stats.peak_temporary_bytes * 12);
}

}  // namespace
}  // namespace meshhier::pipeline
