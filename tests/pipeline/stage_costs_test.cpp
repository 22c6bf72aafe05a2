// Compares the costs that stages tell with those that were measured of builds. Memory, which needs
// a process of its own, is in tests/properties/memory_test.cpp.
#include "pipeline/stage_costs.h"

#include "pipeline/build.h"
#include "pipeline/estimate.h"
#include "pipeline/ingest_stage.h"
#include "pipeline/leaves_stage.h"
#include "pipeline/pack_stage.h"
#include "pipeline/partition_stage.h"
#include "pipeline/publish_stage.h"
#include "pipeline/simplify_stage.h"
#include "storage/io/file.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

using tests::TestMesh;

/// All that a stage writes: what is noted later is the same bytes.
double bytes_written(const DiskVolumes& volumes) {
  double bytes = 0;
  for (const DiskVolume& volume : volumes)
    bytes += volume.from == DiskMoment::noted ? 0 : volume.bytes;
  return bytes;
}

class StageCostsTest : public testing::Test {
 protected:
  std::filesystem::path mesh_path() const { return directory_.path() / "mesh.ply"; }

  config::Config config(std::uint32_t partition_vertices) const {
    config::Config config = tests::smooth_config();
    config.input = mesh_path();
    config.output = directory_.path() / "mesh.hier";
    config.threads = 2;
    config.partition.vertices = partition_vertices;
    return config;
  }

  /// Writes the mesh's vertices and triangles as text.
  void write_text(const TestMesh& mesh) {
    std::ofstream stream(mesh_path());
    stream << "ply\nformat ascii 1.0\nelement vertex " << mesh.positions.size()
           << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
           << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const Vec3f& p : mesh.positions)
      stream << p.x << " " << p.y << " " << p.z << "\n";
    for (const auto& t : mesh.triangles)
      stream << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
  }

  /// The plan in the least budget: nothing of the scratch data stays in memory.
  BuildPlan plan_of(config::Config& config) {
    config.memory_budget =
        least_budget(memory_costs(estimate_build(config, true, *files_).plan.job));
    BuildPlan plan = estimate_build(config, true, *files_).plan;
    EXPECT_EQ(plan.memory.pool_bytes, 0U);
    return plan;
  }

  /// Temporary bytes by the stage that wrote them.
  std::map<std::string, double> measure(const config::Config& config) {
    execution::NoProgress progress;
    const BuildStats stats =
        build_hierarchy(config, {.force = true}, {*files_, progress, execution::CancelToken()})
            .stats;
    std::map<std::string, double> written;
    for (const StageStats& stage : stats.stages)
      written[stage.name] = static_cast<double>(stage.bytes.temporary_written);
    return written;
  }

  /// `most`: of what is told, over what was measured.
  void expect_told(config::Config config, double most) {
    const BuildPlan plan = plan_of(config);
    const TilePopulation tiles = expected_tiles(plan.job);
    std::map<std::string, double> measured = measure(config);
    const std::map<std::string, std::pair<double, double>> told = {
        // The last block of its spool stays open.
        {"ingest", {bytes_written(ingest_disk(plan.job, tiles, plan.memory)), 1.1}},
        // Triangles within a chunk take 8 bytes and are counted with 12, as those of several.
        {"partition", {bytes_written(partition_disk(plan.job, tiles, plan.memory)), 1.45}},
        {"leaves", {bytes_written(leaves_disk(plan.job, tiles, plan.memory)), most}},
        {"simplify", {bytes_written(simplify_disk(plan.job, tiles, plan.memory)), most}}};
    double all = 0;
    for (const auto& [stage, cost] : told) {
      all += measured[stage];
      EXPECT_GE(cost.first, 0.95 * measured[stage]) << stage;
      EXPECT_LE(cost.first, cost.second * measured[stage]) << stage;
    }
    // Entries of the journal.
    for (const char* stage : {"outline", "publish", "sync"})
      EXPECT_LE(measured[stage], 0.03 * all) << stage;
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

TEST_F(StageCostsTest, SLOW_EachStageWritesWhatItTells) {
  for (const TestMesh& mesh : {tests::sphere(60'000, 0.01F), tests::torus(300'000),
                               tests::shuffled(tests::sphere(60'000), 3)}) {
    tests::write_ply(mesh, mesh_path());
    for (const std::uint32_t vertices : {100U, 1000U}) {
      SCOPED_TRACE(std::to_string(mesh.triangles.size()) + " triangles, partitions of " +
                   std::to_string(vertices));
      expect_told(config(vertices), 1.2);
    }
  }
}

// Shares of CPU time, which are alike on any machine, whatever else runs on it.
TEST_F(StageCostsTest, SLOW_LittleOfAStageGoesOneStepAfterAnotherWithManyThreads) {
  tests::write_ply(tests::torus(6'000'000), mesh_path());
  config::Config with = config(4096);
  with.threads = 16;
  with.simplify.method = config::SimplifyMethod::cluster;
  with.preview = false;
  for (const std::uint64_t mebibytes : {96U, 512U}) {  // the table of ranks is spooled; it is not
    with.memory_budget = mebibytes << 20;
    execution::NoProgress progress;
    const BuildStats stats =
        build_hierarchy(with, {.force = true}, {*files_, progress, execution::CancelToken()}).stats;
    std::map<std::string, double> shares;
    for (const StageStats& stage : stats.stages)
      shares[stage.name] = stage.serial_seconds / stage.cpu_seconds();
    EXPECT_LT(shares["partition"], 0.15) << mebibytes;
    EXPECT_LT(shares["import"], 0.25) << mebibytes;
    EXPECT_LT(shares["publish"], 0.15) << mebibytes;
  }
}

TEST_F(StageCostsTest, SLOW_VerticesOfTextAreWrittenOnceMore) {
  write_text(tests::sphere(600'000));
  expect_told(config(1000), 1.2);
}

TEST_F(StageCostsTest, SLOW_ThePublishedFilesAreAsLargeAsTold) {
  tests::write_ply(tests::sphere(60'000, 0.01F), mesh_path());
  for (const auto container : {storage::Container::files, storage::Container::archive}) {
    config::Config with = config(300);
    with.storage.container = container;
    with.storage.compression = storage::Compression::none;
    with.storage.normals = config::Normals::none;  // a rough mesh has splits, told later
    const BuildPlan plan = plan_of(with);
    const TilePopulation tiles = expected_tiles(plan.job);
    execution::NoProgress progress;
    const BuildStats stats =
        build_hierarchy(with, {.force = true}, {*files_, progress, execution::CancelToken()}).stats;
    const OutputCost output = publish_output(plan.job, tiles);
    EXPECT_DOUBLE_EQ(output.bytes, output.plain_bytes);
    const bool packed = container == storage::Container::archive;
    const double told = output.bytes + (packed ? archive_overhead_bytes(tiles) : 0);
    EXPECT_GE(told, 0.95 * static_cast<double>(stats.output_bytes));
    EXPECT_LE(told, 1.1 * static_cast<double>(stats.output_bytes));
    std::filesystem::remove_all(with.output);
  }
}

}  // namespace
}  // namespace meshhier::pipeline
