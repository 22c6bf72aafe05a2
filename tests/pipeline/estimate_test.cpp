#include "pipeline/estimate.h"

#include "base/error.h"
#include "pipeline/build.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"

#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class EstimateTest : public testing::Test {
 protected:
  config::Config config(std::uint32_t partition_vertices = 200) const {
    config::Config config = tests::smooth_config();
    config.input = directory_.path() / "mesh.ply";
    config.output = directory_.path() / "deep" / "mesh.hier";
    config.threads = 2;
    config.partition.vertices = partition_vertices;
    return config;
  }
  void write_mesh(const tests::TestMesh& mesh) { tests::write_ply(mesh, config().input.front()); }

  pipeline::BuildReport build(const config::Config& config, bool force = false) {
    execution::NoProgress progress;
    return pipeline::build_hierarchy(config, {.force = force},
                                     {files_, progress, execution::CancelToken()});
  }

  std::set<fs::path> listing() const {
    std::set<fs::path> all;
    for (const auto& entry : fs::recursive_directory_iterator(directory_.path()))
      all.insert(entry.path());
    return all;
  }

  static std::pair<ErrorCode, std::string> failure(const std::function<void()>& action) {
    try {
      action();
    } catch (const Error& error) {
      return {error.code(), error.what()};
    }
    ADD_FAILURE() << "nothing was refused";
    return {ErrorCode::internal, ""};
  }

  void expect_refused_alike(const config::Config& config, ErrorCode code) {
    const auto from_build = failure([&] { build(config); });
    const auto from_estimate = failure([&] { pipeline::estimate_build(config, false, files_); });
    EXPECT_EQ(from_estimate.first, code);
    EXPECT_EQ(from_estimate, from_build);
  }

  tests::TemporaryDirectory directory_;
  tests::FaultyFileSystem files_;
};

TEST_F(EstimateTest, SLOW_TellsWhatABuildMakes) {
  write_mesh(tests::sphere(20'000));
  for (const std::uint32_t vertices : {60U, 1000U, 32768U}) {
    const pipeline::BuildEstimate estimate =
        pipeline::estimate_build(config(vertices), true, files_);
    const pipeline::BuildStats stats = build(config(vertices), true).stats;
    EXPECT_EQ(estimate.plan.tree.partition_count(), stats.partitions);
    EXPECT_EQ(estimate.tiles.levels, stats.levels);
    EXPECT_EQ(estimate.tiles.tiles(), stats.tiles);
    EXPECT_EQ(estimate.mesh.vertex_count, stats.vertices);
    EXPECT_EQ(estimate.plan.disk.output_bytes, stats.predicted_output_bytes);
    EXPECT_EQ(estimate.plan.disk.temporary_bytes, stats.predicted_temporary_bytes);
  }
}

TEST_F(EstimateTest, SLOW_TellsThePlaceAsTheBuildDoes) {
  write_mesh(tests::sphere(2000));
  EXPECT_EQ(pipeline::estimate_build(config(), true, files_).placement, "");
  for (const Topology topology : {Topology::place, Topology::index}) {
    config::Config placed = config();
    placed.topology = topology;
    placed.placement.longitude = 7;
    placed.placement.latitude = 46;
    placed.placement.height = -20'000;
    const pipeline::BuildEstimate estimate = pipeline::estimate_build(placed, true, files_);
    EXPECT_THAT(estimate.placement, HasSubstr("warning: that is 20 km below the ground"));
    EXPECT_THAT(build(placed, true).text, HasSubstr(estimate.placement));
    EXPECT_THAT(pipeline::estimate_text(estimate), HasSubstr(estimate.placement));
    EXPECT_EQ(pipeline::to_json(estimate)["placement"], estimate.placement);
  }
}

TEST_F(EstimateTest, KnowsWhatIsAskedOfEachLevel) {
  write_mesh(tests::sphere(20'000));
  const auto estimate = [&](const TargetVertexCounts& vertices) {
    config::Config with = config(300);  // levels 0 to 5 are simplified
    with.simplify.vertices = vertices;
    return pipeline::estimate_build(with, true, files_);
  };
  config::Config with = config(300);
  with.simplify.vertices = TargetVertexCounts({300, 250, 200, 150, 100});
  const pipeline::BuildStats stats = build(with, true).stats;
  const pipeline::BuildEstimate falling = estimate(*with.simplify.vertices);
  EXPECT_EQ(falling.plan.disk.output_bytes, stats.predicted_output_bytes);
  EXPECT_EQ(falling.plan.disk.temporary_bytes, stats.predicted_temporary_bytes);
  EXPECT_LT(falling.plan.disk.output_bytes, estimate(300).plan.disk.output_bytes);
  EXPECT_GT(falling.plan.disk.output_bytes, estimate(100).plan.disk.output_bytes);
  EXPECT_EQ(
      falling.plan.disk.output_bytes,
      estimate(TargetVertexCounts({300, 250, 200, 150, 100, 100, 9000})).plan.disk.output_bytes);
}

TEST_F(EstimateTest, TheLargestTileOfAnyLevelDecidesTheMemory) {
  write_mesh(tests::sphere(20'000));
  const auto largest = [&](const TargetVertexCounts& vertices) {
    config::Config with = config(300);  // levels 0 to 5 are simplified
    with.simplify.vertices = vertices;
    return pipeline::estimate_build(with, true, files_).plan.job.largest_tile;
  };
  EXPECT_EQ(largest(TargetVertexCounts({100, 200, 4000, 300})), 4000U);
  EXPECT_EQ(largest(TargetVertexCounts({100, 200, 200, 200, 200, 4000})), 4000U);
  EXPECT_LE(largest(TargetVertexCounts({100, 200, 200, 200, 200, 200, 4000})), 300U);
  EXPECT_EQ(largest(4000), 4000U);
}

TEST_F(EstimateTest, ReadsTheHeaderAndWritesNothing) {
  write_mesh(tests::sphere(60'000));
  const std::set<fs::path> before = listing();
  config::Config by_index = config();
  by_index.topology = Topology::index;
  pipeline::estimate_build(by_index, false, files_);
  EXPECT_EQ(listing(), before);
  EXPECT_LT(files_.counters().bytes_read, fs::file_size(config().input.front()) / 2);
  EXPECT_EQ(files_.counters().bytes_written, 0U);
}

TEST_F(EstimateTest, CountsPlacesWithoutTheFaces) {
  write_mesh(tests::duplicates(60'000));
  const std::set<fs::path> before = listing();
  const BuildEstimate estimate = pipeline::estimate_build(config(), false, files_);
  EXPECT_EQ(listing(), before);
  EXPECT_LT(files_.counters().bytes_read, fs::file_size(config().input.front()) * 3 / 4);
  EXPECT_EQ(files_.counters().bytes_written, 0U);
  EXPECT_LT(estimate.mesh.places(), estimate.mesh.vertex_count);
  EXPECT_EQ(estimate.plan.tree.vertex_count(), estimate.mesh.places());
}

TEST_F(EstimateTest, RefusesWhatABuildRefusesInTheSameWords) {
  write_mesh({});
  expect_refused_alike(config(), ErrorCode::input);
  write_mesh(tests::sphere(20'000));
  config::Config many = config();
  many.partition.count = 1'000'000;
  expect_refused_alike(many, ErrorCode::usage);
  config::Config small = config();
  small.memory_budget = 1 << 20;
  expect_refused_alike(small, ErrorCode::budget);
  config::Config inside = config();
  inside.output = directory_.path();
  expect_refused_alike(inside, ErrorCode::usage);
  files_.limit_room(100'000);
  fs::create_directories(config().output.parent_path());  // both name it
  expect_refused_alike(config(), ErrorCode::budget);
}

TEST_F(EstimateTest, AnOutputThatIsThereIsRefusedUnlessForced) {
  write_mesh(tests::sphere(2000));
  build(config());
  expect_refused_alike(config(), ErrorCode::exists);
  EXPECT_NO_THROW(pipeline::estimate_build(config(), true, files_));
}

TEST_F(EstimateTest, TheBudgetIsDividedWholly) {
  write_mesh(tests::sphere(20'000));
  const pipeline::BuildEstimate estimate = pipeline::estimate_build(config(), false, files_);
  const nlohmann::ordered_json memory = to_json(estimate)["memory"];
  EXPECT_EQ(memory["fixed_bytes"].get<std::uint64_t>() + memory["work_bytes"].get<std::uint64_t>() +
                memory["pool_bytes"].get<std::uint64_t>(),
            memory_budget(config()));
  EXPECT_LE(estimate.least_budget_bytes, memory_budget(config()));
  config::Config least = config();
  least.memory_budget = estimate.least_budget_bytes;
  EXPECT_NO_THROW(pipeline::estimate_build(least, false, files_));
}

TEST_F(EstimateTest, TimeFallsWithThreadsAndDependsOnTheMethod) {
  write_mesh(tests::sphere(20'000));
  config::Config one = config();
  one.threads = 1;
  const TimeEstimate alone = pipeline::estimate_build(one, false, files_).time;
  const TimeEstimate both = pipeline::estimate_build(config(), false, files_).time;
  EXPECT_LT(both.wall_seconds, alone.wall_seconds);
  EXPECT_DOUBLE_EQ(both.cpu_seconds, alone.cpu_seconds);
  config::Config clustered = config();
  clustered.simplify.method = config::SimplifyMethod::cluster;
  EXPECT_LT(pipeline::estimate_build(clustered, false, files_).time.cpu_seconds, both.cpu_seconds);
}

TEST_F(EstimateTest, TheTextNamesTheLeastBudgetAndTheFreeDisk) {
  write_mesh(tests::sphere(20'000));
  config::Config job = config();
  job.memory_budget = std::uint64_t{1} << 30;
  const pipeline::BuildEstimate estimate = pipeline::estimate_build(job, false, files_);
  const std::string text = pipeline::estimate_text(estimate);
  EXPECT_THAT(text, HasSubstr("1GiB at most"));
  EXPECT_THAT(text, HasSubstr("free in " + directory_.path().string()));
  EXPECT_THAT(text, HasSubstr("an estimate"));
  EXPECT_THAT(text, HasSubstr("51 partitions of at most 197 vertices, 7 levels"));
}

}  // namespace
}  // namespace meshhier::pipeline
