// Promise 5: peak resident memory stays under the budget. Measured on the real program, as the
// system counts it.
#include "bench/generator.h"
#include "bench/split.h"
#include "bench/stress.h"
#include "bench/textured_files.h"
#include "execution/size_text.h"
#include "import/import_input.h"
#include "pipeline/estimate.h"
#include "pipeline/stage_costs.h"
#include "pipeline/stages.h"
#include "storage/io/file.h"
#include "storage/io/process.h"
#include "tests/support/loaded_mesh.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/sizes.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace meshhier {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using tests::kMiB;

constexpr int kBudgetExitCode = 6;

std::uint64_t peak_bytes(const rusage& usage) {
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

struct Outcome {
  int code = -1;  ///< 1000 + n after death by signal n
  std::uint64_t peak_bytes = 0;
  std::uint64_t new_page_bytes = 0;  ///< bytes of pages that were made, again and again or once
  std::string messages;
};

class MemoryTest : public testing::Test {
 protected:
  void SetUp() override {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the sanitizer's own memory would be counted";
#endif
  }

  fs::path path(const std::string& name) const {
    return directory_.path() / name;
  }

  /// Writes a closed surface by stream: this process must stay small, because the system counts
  /// what it holds at the start of a child as the child's.
  void write_mesh(bench::SurfaceOptions options) {
    const auto files = storage::make_posix_file_system();
    bench::write_ply(*files, {path("mesh.ply"), true}, *bench::make_surface(options));
  }

  void write_mesh(bench::LoadedMesh mesh) {
    const auto files = storage::make_posix_file_system();
    bench::write_ply(*files, {path("mesh.ply"), true}, *bench::as_generated(std::move(mesh)));
  }

  /// Writes what `make` returns in another process: this one stays small.
  template <class Make>
  void write_apart(const Make& make) {
    const pid_t child = fork();
    if (child == 0) {
      write_mesh(make());
      _exit(0);
    }
    int status = -1;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_EQ(status, 0);
  }

  void write_textured(const bench::AtlasOptions& atlas) {
    const pid_t child = fork();
    if (child == 0) {
      const auto files = storage::make_posix_file_system();
      bench::TexturedOptions options;
      options.surface.triangles = 20'000;
      options.atlas = atlas;
      bench::write_textured(*files, {path("mesh.ply"), true}, bench::TexturedScan(options),
                            {.mesh = bench::MeshFileFormat::ply});
      _exit(0);
    }
    int status = -1;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_EQ(status, 0);
  }

  /// A noisy sphere with its vertices split.
  void write_split(const char* name, std::size_t triangles) {
    write_apart(
        [&] { return bench::split(tests::loaded(tests::sphere(triangles, 0.002F)), name, 40); });
  }

  /// `stats`: file for the account.
  Outcome build(const std::string& budget, const std::vector<std::string>& settings = {},
                const fs::path& stats = {}) {
    std::ofstream(path("config.json")) << R"({"input": "mesh.ply", "output": "mesh.hier"})";
    std::vector<std::string> words = {MESHHIER_BINARY,
                                      "build",
                                      path("config.json").string(),
                                      "--force",
                                      "--progress",
                                      "none",
                                      "--set",
                                      "memory_budget=" + budget,
                                      "storage.normals=smooth"};
    for (const std::string& setting : settings)
      words.insert(words.end(), {"--set", setting});
    if (!stats.empty())
      words.insert(words.end(), {"--stats", stats.string()});
    return run(words);
  }

  Outcome run(std::vector<std::string>& words) {
    std::vector<char*> arguments;
    for (std::string& word : words)
      arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const fs::path messages = path("messages");
    // The peak of a process begins with what it was forked of: not by posix_spawn(), whose child
    // has the memory of this one as it was at its largest.
    malloc_trim(0);
    const pid_t child = fork();
    if (child == 0) {
      dup2(open("/dev/null", O_WRONLY), STDOUT_FILENO);
      dup2(open(messages.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
      execv(arguments[0], arguments.data());
      _exit(127);
    }
    EXPECT_GT(child, 0);
    int status = 0;
    rusage usage{};
    while (wait4(child, &status, 0, &usage) == -1 && errno == EINTR) {
    }
    std::ifstream stream(messages);
    return {WIFSIGNALED(status) ? 1000 + WTERMSIG(status) : WEXITSTATUS(status),
            peak_bytes(usage),
            static_cast<std::uint64_t>(usage.ru_minflt) *
                static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)),
            {std::istreambuf_iterator<char>(stream), {}}};
  }

  void expect_within(const std::string& budget, const std::vector<std::string>& settings = {}) {
    const Outcome outcome = build(budget, settings);
    EXPECT_EQ(outcome.code, 0) << outcome.messages;
    expect_less(outcome.peak_bytes, budget);
  }

  void expect_less(std::uint64_t peak, const std::string& budget) {
    const std::uint64_t limit = execution::parse_size(budget).value();
    ASSERT_LT(storage::resident_bytes(), limit) << "this process is too large to measure another";
    EXPECT_LT(peak, limit) << "peak " << execution::rounded_size_text(peak) << " of " << budget;
    RecordProperty("peak_bytes_of_" + budget, std::to_string(peak));
  }

  /// The least budget, as the refusals of smaller ones name it: at the start, and later where very
  /// many vertices lie at few places. The build in it stays within.
  std::string expect_within_least_budget(const std::vector<std::string>& settings = {}) {
    constexpr int kMostRefusals = 4;
    std::string least = "1MiB";
    for (int refusals = 0; refusals <= kMostRefusals; ++refusals) {
      const Outcome outcome = build(least, settings);
      if (refusals > 0 && outcome.code == 0) {
        expect_less(outcome.peak_bytes, least);
        fs::remove_all(path("mesh.hier"));
        return least;
      }
      EXPECT_EQ(outcome.code, kBudgetExitCode) << outcome.messages;
      EXPECT_FALSE(fs::exists(path("mesh.hier")));
      least = named_by(outcome.messages, least);
    }
    ADD_FAILURE() << "refused again and again, the last time for " << least;
    return least;
  }
  static std::string named_by(const std::string& messages, const std::string& refused) {
    const auto size_behind = [&](const std::string& before) -> std::uint64_t {
      const std::size_t begin = messages.find(before);
      if (begin == std::string::npos)
        return 0;
      const std::size_t start = begin + before.size();
      return execution::parse_size(
                 messages.substr(start, messages.find_first_of(" \n", start) - start))
          .value_or(0);
    };
    const std::uint64_t more = size_behind("larger by ");
    const std::uint64_t least = size_behind("at least ");
    EXPECT_TRUE(more > 0 || least > 0) << "no budget in: " << messages;
    return execution::exact_size_text(more > 0 ? more + execution::parse_size(refused).value_or(0)
                                               : least);
  }

  /// In the least budget, no stage's peak is beyond what it and those before tell of themselves;
  /// and what all tell is not far beyond the peak.
  void expect_told(std::uint32_t partition_vertices) {
    const auto files = storage::make_posix_file_system();
    config::Config config = tests::smooth_config();
    config.input = path("mesh.ply");
    config.output = path("none.hier");
    config.partition.vertices = partition_vertices;
    const pipeline::JobSize job = pipeline::estimate_build(config, true, *files).plan.job;
    const pipeline::MemoryCosts costs = pipeline::memory_costs(job);
    const Outcome outcome =
        build(execution::exact_size_text(pipeline::least_budget(costs)),
              {"partition.vertices=" + std::to_string(partition_vertices)}, path("stats.json"));
    ASSERT_EQ(outcome.code, 0) << outcome.messages;
    const importing::ImportMemory look = importing::plan_import(pipeline::least_budget(costs));
    std::map<std::string, std::uint64_t> told = {{"import", look.pool_bytes + look.sort_bytes}};
    for (const pipeline::Stage* stage : pipeline::stages_of(job)) {
      if (stage->memory != nullptr && stage->name != "publish")  // less, but for the preview
        told.emplace(stage->name, stage->memory(job).least_bytes);
    }
    std::uint64_t most = 0;
    const auto stats = nlohmann::json::parse(std::ifstream(path("stats.json")));
    for (const auto& stage : stats.at("stages")) {
      const auto name = stage.at("name").get<std::string>();
      const auto peak = stage.at("peak_resident_bytes").get<std::uint64_t>();
      most = std::max(most, told.contains(name) ? told.at(name) : 0);
      EXPECT_LE(peak, pipeline::fixed_bytes(costs) + most) << name;
      RecordProperty("peak_bytes_of_" + name, std::to_string(peak));
    }
    EXPECT_GE(outcome.peak_bytes * 5, (pipeline::fixed_bytes(costs) + most) * 3);
  }

  void expect_each_task_within(const std::string& budget, const std::string& setting) {
    std::vector<std::string> plan = {MESHHIER_BINARY,
                                     "plan",
                                     path("mesh.ply").string(),
                                     "--work",
                                     path("work").string(),
                                     "--tasks",
                                     "3",
                                     "--force",
                                     "--set",
                                     "memory_budget=" + budget,
                                     "storage.normals=smooth",
                                     setting};
    ASSERT_EQ(run(plan).code, 0) << run(plan).messages;
    for (const std::string stage :
         {"read", "distribute", "faces", "join", "leaves", "level-1", "level-2", "level-3",
          "level-4", "level-5", "level-6", "level-7", "level-8", "level-9", "level-10", "top",
          "publish", "finish"}) {
      std::vector<std::string> task = {MESHHIER_BINARY, "task", path("work").string(), stage};
      const Outcome outcome = run(task);
      if (outcome.code == 2)
        continue;  // the tree is not so deep
      EXPECT_EQ(outcome.code, 0) << outcome.messages;
      EXPECT_LE(outcome.peak_bytes, execution::parse_size(budget).value())
          << stage << ' ' << setting;
    }
    EXPECT_TRUE(fs::exists(path("mesh.hier")));
    fs::remove_all(path("mesh.hier"));
    fs::remove_all(path("work"));
  }

  tests::TemporaryDirectory directory_;
};

bench::SurfaceOptions million_vertices() {
  bench::SurfaceOptions options;
  options.triangles = 2'000'000;
  return options;
}

// Each page of a buffer that is given back after a tile is made anew for the next: 2.3 times the
// peak was made for this mesh. Large pages are made in fewer steps, never in more.
TEST_F(MemoryTest, FreedMemoryIsUsedAgain) {
  write_apart([] {
    return bench::SurfaceOptions{.shape = bench::BaseShape::torus, .triangles = 1'000'000};
  });
  const Outcome outcome = build("512MiB", {"threads=2"});
  ASSERT_EQ(outcome.code, 0) << outcome.messages;
  EXPECT_GT(outcome.new_page_bytes, 0U);
  EXPECT_LT(static_cast<double>(outcome.new_page_bytes),
            1.4 * static_cast<double>(outcome.peak_bytes));
}

TEST_F(MemoryTest, SLOW_AMillionVerticesIn64MiB) {
  write_mesh(million_vertices());
  expect_within("64MiB");
  expect_within("64MiB", {"threads=5"});
  expect_within("64MiB", {"partition.vertices=500"});
}

TEST_F(MemoryTest, SLOW_EachTaskOfAMillionVerticesIn64MiB) {
  write_mesh(million_vertices());
  for (const char* setting : {"threads=2", "partition.vertices=500"})
    expect_each_task_within("64MiB", setting);
}

TEST_F(MemoryTest, SLOW_AMillionVerticesInMoreThanEnough) {
  write_mesh(million_vertices());
  expect_within("256MiB", {"threads=8"});
}

TEST_F(MemoryTest, SLOW_NormalMapsOfAMillionVerticesIn256MiB) {
  write_mesh(million_vertices());
  expect_within("256MiB", {"storage.normals=auto"});
  expect_within("256MiB", {"storage.normals=auto", "threads=5"});
}

TEST_F(MemoryTest, SLOW_AttributesAndDoubleCoordinatesInTheLeastBudget) {
  bench::SurfaceOptions options = million_vertices();
  options.normals = true;
  options.colours = true;
  options.alpha = true;
  options.double_coordinates = true;
  options.offset = {500123.25, 5812345.5, 100};
  write_mesh(options);
  expect_within_least_budget();
}

// Pictures of partitions have up to 4096 x 4096 texels, whatever the budget.
TEST_F(MemoryTest, SLOW_LargePicturesInTheLeastBudget) {
  write_textured({.images = 2, .side = 4096, .charts = 64});
  const std::string least = expect_within_least_budget();
  EXPECT_LE(execution::parse_size(least).value(), 128 * kMiB);
  expect_within("512MiB", {"threads=4"});
  fs::remove_all(path("mesh.hier"));
  expect_within_least_budget({"texture.format=png"});
}

// PROJ is loaded for it, and takes what the plan counts for it.
TEST_F(MemoryTest, SLOW_AModelInMapCoordinatesInTheLeastBudget) {
  write_mesh(million_vertices());
  const std::vector<std::string> settings{"up=z", "placement.crs=\"EPSG:23032+5773\"",
                                          "placement.offset=[500000,5300000,0]"};
  expect_within_least_budget(settings);
}

// Every tile is the neighbour of all others; a tile has many more triangles than the plan counts
// with.
TEST_F(MemoryTest, SLOW_TrianglesBetweenAnyVerticesIn64MiB) {
  for (const char* name : {"soup", "tangle"}) {
    write_mesh(bench::make_stress(name, 100'000));
    expect_within("64MiB");
  }
}

TEST_F(MemoryTest, SLOW_SeveralVerticesAtEachPlaceInTheLeastBudgetAndMore) {
  for (const char* name : {"soup", "charts", "mixed"}) {
    SCOPED_TRACE(name);
    write_split(name, 400'000);
    expect_within_least_budget();
    expect_within("160MiB", {"threads=8"});
    expect_within("160MiB", {"partition.vertices=500"});
    fs::remove_all(path("mesh.hier"));
  }
}

TEST_F(MemoryTest, SLOW_EachTaskWithSeveralVerticesAtEachPlace) {
  write_split("soup", 400'000);
  const std::string least = expect_within_least_budget();
  expect_each_task_within(least, "threads=2");
}

/// A smooth sphere, a vertex at each place, and beside it one with a normal for each corner.
bench::LoadedMesh partly_split(std::size_t smooth_triangles, std::size_t flat_triangles) {
  bench::LoadedMesh mesh =
      bench::split(tests::loaded(tests::sphere(smooth_triangles, 0.002F)), "hard_edges", 180);
  const bench::LoadedMesh flat =
      bench::split(tests::loaded(tests::sphere(flat_triangles, 0.002F)), "flat", 0);
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3d& p : flat.positions)
    mesh.positions.push_back(p + Vec3d{4, 0, 0});
  mesh.channels.insert(mesh.channels.end(), flat.channels.begin(), flat.channels.end());
  for (const bench::MeshTriangle& t : flat.triangles)
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  return mesh;
}

// Where the vertices lie together, chunks and tiles have many more than on average.
TEST_F(MemoryTest, SLOW_SeveralVerticesAtSomePlacesOnly) {
  write_apart([] { return partly_split(2'400'000, 250'000); });
  expect_within_least_budget();
  fs::remove_all(path("mesh.hier"));
  const std::vector<std::string> settings{"partition.vertices=32768", "threads=8"};
  expect_within_least_budget(settings);
}

// As scanners put what they could not measure. A plan counts with copies spread over the mesh: what
// one tile alone takes is known late, and may be refused then, but never taken.
TEST_F(MemoryTest, SLOW_AMillionVerticesAtOnePlaceOfALargerMesh) {
  write_apart([] {
    bench::LoadedMesh mesh = tests::loaded(tests::sphere(800'000, 0.002F));
    mesh.positions.resize(mesh.positions.size() + 1'000'000);
    return mesh;
  });
  const Outcome outcome = build("82MiB");
  EXPECT_LT(outcome.peak_bytes, 82 * kMiB);
  EXPECT_EQ(outcome.code, kBudgetExitCode);
  EXPECT_THAT(outcome.messages, HasSubstr("it needs a memory_budget larger by"));
  fs::remove_all(path(".mesh.hier.meshhier-work"));
  expect_within("160MiB", {"threads=8"});
}

// One chunk of two partitions: leaves and simplify take more than the stages before.
TEST_F(MemoryTest, SLOW_SeveralVerticesAtEachPlaceOfLargeTiles) {
  const std::vector<std::string> settings{"partition.vertices=32768"};
  for (const char* name : {"soup", "mixed"}) {
    SCOPED_TRACE(name);
    write_split(name, 200'000);
    expect_within_least_budget(settings);
    fs::remove_all(path("mesh.hier"));
  }
}

TEST_F(MemoryTest, TheLeastBudgetIsNamedAndWorks) {
  write_mesh(million_vertices());
  const std::string least = expect_within_least_budget();
  const std::uint64_t bytes = execution::parse_size(least).value_or(0);
  ASSERT_GT(bytes, kMiB) << least;
  const Outcome below = build(execution::exact_size_text(bytes - kMiB));
  EXPECT_EQ(below.code, kBudgetExitCode);
  EXPECT_THAT(below.messages, HasSubstr(least));
  EXPECT_FALSE(fs::exists(path("mesh.hier")));
}

// The first is hungriest in ingest and partition; of the second, one chunk and two tiles, leaves
// and simplify take more than the stages before.
TEST_F(MemoryTest, SLOW_NoStageHoldsMoreThanItTells) {
  write_mesh(million_vertices());
  expect_told(8192);
  bench::SurfaceOptions options;
  options.triangles = 250'000;
  write_mesh(options);
  expect_told(32768);
}

// ---- progressive streams

TEST_F(MemoryTest, SLOW_AStreamIsMadeInTheBudgetAndPutTogetherInItsArrays) {
  bench::SurfaceOptions options;
  options.triangles = 500'000;
  options.colours = true;
  write_mesh(options);
  const Outcome built = build("256MiB", {"simplify.method=half_edge"});
  ASSERT_EQ(built.code, 0) << built.messages;
  for (const char* node : {"0/0", "1/1"}) {
    std::vector<std::string> words = {MESHHIER_BINARY,
                                      "progressive",
                                      path("mesh.hier").string(),
                                      "-o",
                                      path("mesh.prog").string(),
                                      "--force",
                                      "--memory-budget",
                                      "64MiB",
                                      "--node",
                                      node};
    const Outcome made = run(words);
    ASSERT_EQ(made.code, 0) << made.messages;
    EXPECT_LT(made.peak_bytes, 64 * kMiB) << node;
    RecordProperty("peak_bytes_of_progressive", std::to_string(made.peak_bytes));

    words = {MESHHIER_BINARY,          "reconstruct", path("mesh.prog").string(), "-o",
             path("out.ply").string(), "--force"};
    const Outcome rebuilt = run(words);
    ASSERT_EQ(rebuilt.code, 0) << rebuilt.messages;
    std::uint64_t largest = 0;
    for (const auto& file : fs::directory_iterator(path("mesh.prog")))
      largest = std::max(largest, file.file_size());
    // The arrays of 260,000 vertices and 520,000 triangles; the program, and a few runs.
    const std::uint64_t arrays = 260'000 * (16 + 3 * 4) + 520'000 * 12;
    EXPECT_LT(rebuilt.peak_bytes, arrays + largest + 24 * kMiB) << node;
    RecordProperty("peak_bytes_of_reconstruct", std::to_string(rebuilt.peak_bytes));
  }
}

}  // namespace
}  // namespace meshhier
