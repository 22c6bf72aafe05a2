// Random meshes, random configs, random faults and kills: whatever happens to a build, the next one
// makes the same bytes, and all promises hold.
//
//   MESHHIER_SOAK_ROUNDS   of each kind; 6 if it is not set
//   MESHHIER_SOAK_SEED     of the first round, 1 if it is not set; each round has the next one and
//                          tells it when it fails
#include "base/error.h"
#include "bench/stress.h"
#include "pipeline/build.h"
#include "pipeline/tasks/task_plan.h"
#include "pipeline/tasks/task_status.h"
#include "storage/format/archive_files.h"
#include "storage/format/layout.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/interrupter.h"
#include "tests/support/memory_files.h"
#include "tests/support/random_config.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/share.h"
#include "tests/support/try_build.h"
#include "verify/verify.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/wait.h>

extern char** environ;

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;
using tests::Call;
using tests::FaultyFileSystem;
using tests::Interrupter;
using tests::MemoryFiles;

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

/// The decisions of a seed.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}

  /// Returns a number of [low, high].
  std::uint64_t from(std::uint64_t low, std::uint64_t high) {
    return low + engine_() % (high - low + 1);
  }
  /// Returns a number of [1, most], each order of magnitude as likely.
  std::uint64_t of_any_size(std::uint64_t most) {
    const double bits = std::log2(static_cast<double>(most) + 1);
    const double drawn = bits * static_cast<double>(engine_() >> 11) * 0x1p-53;
    return std::clamp<std::uint64_t>(static_cast<std::uint64_t>(std::exp2(drawn)), 1, most);
  }
  bool one_in(std::uint64_t n) { return engine_() % n == 0; }

 private:
  std::mt19937_64 engine_;
};

/// One of the unreasonable ones, or a bumpy surface that may have normals and colours.
std::unique_ptr<bench::GeneratedMesh> random_mesh(Dice& dice) {
  if (dice.one_in(3)) {
    bench::SurfaceOptions options;
    options.shape = static_cast<bench::BaseShape>(dice.from(0, 3));
    options.triangles = dice.of_any_size(4000);
    options.noise = dice.one_in(2) ? 0 : 0.5;
    options.normals = dice.one_in(3);
    options.colours = dice.one_in(3);
    options.offset = dice.one_in(3) ? Vec3d{447213, 5428731, 300} : Vec3d{};
    return bench::make_surface(options);
  }
  const auto cases = bench::stress_cases();
  const bench::StressCase& chosen = cases[dice.from(0, cases.size() - 1)];
  return bench::as_generated(
      bench::make_stress(chosen.name, dice.of_any_size(4000), dice.from(1, 1000)));
}

BoundsD box_of(const bench::GeneratedMesh& mesh) {
  BoundsD box;
  mesh.visit_vertices(4096, [&](std::span<const Vec3d> positions, std::span<const float>) {
    for (const Vec3d& p : positions) {
      if (is_finite(p))
        box.add(p);
    }
  });
  return box;
}

/// Draws the settings that may change from one build to the next that goes on with it.
void draw_resources(Dice& dice, config::Config& config) {
  config.threads = static_cast<std::uint32_t>(dice.from(1, 3));
  config.memory_budget = (dice.one_in(2) ? std::uint64_t{1} << 30 : dice.from(64, 256) << 20);
}

config::Config random_config(Dice& dice, const bench::GeneratedMesh& mesh) {
  config::Config config = tests::random_config(
      [&](std::uint64_t most) { return dice.from(0, most); }, {.box = box_of(mesh)});
  draw_resources(dice, config);
  return config;
}

/// A random mesh in `input`, and how it is built to `output`.
config::Config random_build(Dice& dice, storage::FileSystem& files, const fs::path& input,
                            const fs::path& output) {
  const auto mesh = random_mesh(dice);
  bench::write_ply(files, {input, true}, *mesh);
  config::Config config = random_config(dice, *mesh);
  config.input = input;
  config.output = output;
  return config;
}

using Files = std::map<std::string, std::string>;

/// All files of the output, by their paths in it, or the archive.
Files content(storage::FileSystem& files, const config::Config& config) {
  const fs::path& output = config.output;
  const bool is_archive = config.storage.container == config::Container::archive;
  Files all;
  for (const fs::path& file : is_archive ? std::vector{output} : files.list(output)) {
    const std::vector<std::byte> bytes = storage::read_file(files, file, 1U << 30);
    all[file.lexically_relative(output).string()] = {reinterpret_cast<const char*>(bytes.data()),
                                                     bytes.size()};
  }
  return all;
}

std::vector<std::string> problems(storage::FileSystem& files, const config::Config& config) {
  verifying::VerifyOptions options;
  options.input = config.input;
  options.cuts = 3;
  execution::NoProgress progress;
  const storage::HierarchyFiles inside(files, config.output);
  return verifying::verify_hierarchy(inside.files(), config.output, options, progress,
                                     execution::CancelToken())
      .problems;
}

/// Calls round(seed) for each round; stops at the first that fails.
template <class Round>
void run_rounds(const Round& round) {
  const std::uint64_t seed = from_environment("MESHHIER_SOAK_SEED", 1);
  const std::uint64_t rounds = from_environment("MESHHIER_SOAK_ROUNDS", 6);
  const tests::Share share = tests::share().of(rounds);
  for (std::uint64_t i = seed + share.index; i < seed + rounds; i += share.count) {
    SCOPED_TRACE("seed " + std::to_string(i));
    round(i);
    ASSERT_FALSE(::testing::Test::HasFailure()) << "seed " << i;
  }
}

/// One round in memory: a build that is disturbed up to a dozen times.
class DisturbedBuild {
 public:
  explicit DisturbedBuild(std::uint64_t seed)
      : dice_(seed),
        config_(random_build(dice_, *files_, "/models/mesh.ply", "/models/mesh.hier")) {}

  void run() {
    const std::optional<ErrorCode> refused = build(*files_);
    if (refused) {  // a reason that the input or the config has, and nothing is left of it
      EXPECT_TRUE(refused == ErrorCode::input || refused == ErrorCode::usage ||
                  refused == ErrorCode::budget)
          << message_;
      return;
    }
    EXPECT_THAT(problems(*files_, config_), IsEmpty());
    expected_ = content(*files_, config_);
    files_->remove_all(config_.output);
    for (std::uint64_t left = dice_.from(1, 12); left > 0 && !::testing::Test::HasFailure(); --left)
      disturb();
    draw_resources(dice_, config_);
    config_.memory_budget = std::uint64_t{1} << 30;
    EXPECT_EQ(build(*files_), std::nullopt) << message_;
    EXPECT_EQ(content(*files_, config_), expected_);
    EXPECT_EQ(files_->children("/models").size(), 2U) << "something else was left";
  }

 private:
  std::optional<ErrorCode> build(storage::FileSystem& files, execution::Progress& progress,
                                 const execution::CancelToken& cancel) {
    return tests::try_build(config_, true, {files, progress, cancel}, message_);
  }
  std::optional<ErrorCode> build(storage::FileSystem& files) {
    execution::NoProgress progress;
    return build(files, progress, execution::CancelToken());
  }

  void disturb() {
    constexpr std::uint64_t kForever = std::numeric_limits<std::uint32_t>::max();
    draw_resources(dice_, config_);
    FaultyFileSystem files(files_);
    execution::CancelToken cancel;
    Interrupter progress(cancel, dice_.one_in(4) ? dice_.of_any_size(20000) : kForever);
    if (dice_.one_in(2))
      files.fail(Call::any, dice_.of_any_size(3000), dice_.one_in(2) ? 1 : kForever);
    else
      files.limit_writes(dice_.of_any_size(4 << 20));
    const std::optional<ErrorCode> code = build(files, progress, cancel);
    if (!code || files_->exists(config_.output))
      EXPECT_EQ(content(*files_, config_), expected_);
    else
      EXPECT_TRUE(code == ErrorCode::io || code == ErrorCode::interrupted ||
                  code == ErrorCode::budget)
          << message_;
    if (files_->exists(config_.output) && dice_.one_in(2))
      files_->remove_all(config_.output);  // else it is replaced
  }

  std::shared_ptr<MemoryFiles> files_ = std::make_shared<MemoryFiles>();
  Dice dice_;
  config::Config config_;
  Files expected_;
  std::string message_;
};

TEST(Soak, DisturbedBuildsEndTheSame) {
  run_rounds([](std::uint64_t seed) { DisturbedBuild(seed).run(); });
}

/// Runs the program; kills it after `microseconds` if that is not 0. Returns its wait status.
int run_program(const std::vector<std::string>& arguments, std::uint64_t microseconds = 0) {
  std::vector<char*> words{const_cast<char*>(MESHHIER_BINARY)};
  for (const std::string& argument : arguments)
    words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int descriptor : {1, 2})
    posix_spawn_file_actions_addopen(&actions, descriptor, "/dev/null", O_WRONLY, 0);
  pid_t process = -1;
  const int error =
      posix_spawn(&process, MESHHIER_BINARY, &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0)  // a signal to "process -1" would reach every process there is
    throw std::runtime_error("cannot start " MESHHIER_BINARY);
  if (microseconds > 0) {
    std::this_thread::sleep_for(std::chrono::microseconds(microseconds));
    kill(process, SIGKILL);
  }
  int status = 0;
  while (waitpid(process, &status, 0) == -1 && errno == EINTR) {
  }
  return status;
}

/// One round on the disk, with the real program and SIGKILL. When a kill strikes is the machine's
/// to say; all else is the seed's.
void kill_builds(std::uint64_t seed) {
  Dice dice(seed);
  const tests::TemporaryDirectory directory;
  const auto files = storage::make_posix_file_system();
  const config::Config config =
      random_build(dice, *files, directory.path() / "mesh.ply", directory.path() / "mesh.hier");
  const fs::path json = directory.path() / "config.json";
  const std::string text = config::complete_text(config, "/");
  storage::write_file(*files, json, std::as_bytes(std::span(text)));

  const auto begin = std::chrono::steady_clock::now();
  const int status = run_program({"build", json});
  const auto taken = std::chrono::duration_cast<std::chrono::microseconds>(
      std::chrono::steady_clock::now() - begin);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    EXPECT_TRUE(WIFEXITED(status)) << "died of signal " << WTERMSIG(status);
    EXPECT_THAT(WEXITSTATUS(status), testing::AnyOf(2, 3, 6));
    return;
  }
  const Files expected = content(*files, config);
  fs::remove_all(config.output);
  for (std::uint64_t left = dice.from(1, 10); left > 0; --left) {
    run_program({"build", json},
                dice.of_any_size(static_cast<std::uint64_t>(taken.count()) * 3 / 2));
    if (fs::exists(config.output)) {
      EXPECT_EQ(content(*files, config), expected);
      fs::remove_all(config.output);
    }
  }
  EXPECT_EQ(run_program({"build", json}), 0);
  EXPECT_EQ(content(*files, config), expected);
  EXPECT_THAT(problems(*files, config), IsEmpty());
  EXPECT_EQ(files->children(directory.path()).size(), 3U) << "something else was left";
}

TEST(Soak, KilledBuildsEndTheSame) {
  run_rounds(kill_builds);
}

/// One round of a build in tasks, with the real program: tasks of any stage are run, killed, run
/// twice at once, and what they have sealed is torn or lost.
class KilledTasks {
 public:
  explicit KilledTasks(std::uint64_t seed)
      : dice_(seed),
        config_(random_build(dice_, *files_, directory_.path() / "mesh.ply",
                             directory_.path() / "mesh.hier")) {
    const std::string text = config::complete_text(config_, "/");
    storage::write_file(*files_, json(), std::as_bytes(std::span(text)));
  }

  void run() {
    if (run_program({"build", json()}) != 0)
      return;  // refused, as KilledBuilds has it
    const Files expected = output();
    fs::remove_all(config_.output);
    ASSERT_EQ(run_program({"plan", json(), "--work", work(), "--tasks",
                           std::to_string(dice_.of_any_size(9))}),
              0);
    for (std::uint64_t left = dice_.from(1, 15); left > 0; --left)
      disturb();
    for (int tries = 0; tries < 200 && !next().empty(); ++tries)
      run_program({"task", work(), next()});
    EXPECT_EQ(run_program({"task", work(), "finish"}), 0);
    EXPECT_EQ(output(), expected);
    EXPECT_EQ(files_->children(work()).size(), 2U) << "something else was left";
    EXPECT_EQ(files_->children(storage::segments_path(work())).size(), 1U);
  }

 private:
  std::string json() const { return directory_.path() / "config.json"; }
  std::string work() const { return directory_.path() / "work"; }

  Files output() { return content(*files_, config_); }

  TaskPlan plan() {
    const std::vector<std::byte> bytes =
        storage::read_file(*files_, storage::task_plan_path(work()), 1U << 20);
    const auto* const first = reinterpret_cast<const char*>(bytes.data());
    const auto text = nlohmann::json::parse(first, first + bytes.size());
    return read_task_plan(*files_, work(), text.at("program"));
  }

  std::string next() {
    const TaskStatus status = task_status(plan(), work(), *files_);
    const StageStatus* const stage = next_stage(status);
    return stage == nullptr ? "" : stage->name;
  }

  /// Runs some tasks, mostly of the first stage that is not complete, and may kill them.
  void disturb() {
    const std::vector<TaskStage> stages = stages_of(plan());
    std::string stage = next();
    if (stage.empty() || dice_.one_in(6))
      stage = stages[dice_.from(0, stages.size() - 1)].name;
    const std::uint64_t of = dice_.from(1, 3);
    const std::vector<std::string> words{"task",
                                         work(),
                                         stage,
                                         "--index",
                                         std::to_string(dice_.from(0, of - 1)),
                                         "--of",
                                         std::to_string(of),
                                         "--threads",
                                         std::to_string(dice_.from(1, 3))};
    const std::uint64_t time = dice_.one_in(2) ? 0 : dice_.of_any_size(60000);
    std::thread twin;
    if (dice_.one_in(3))
      twin = std::thread([&] { run_program(words); });
    run_program(words, time);
    if (twin.joinable())
      twin.join();
    if (dice_.one_in(4))
      damage();
  }

  /// Tears or removes a segment, if there is one.
  void damage() {
    const auto segments = files_->children(storage::segments_path(work()));
    if (segments.empty() || fs::exists(config_.output))
      return;
    const fs::path& segment = segments[dice_.from(0, segments.size() - 1)];
    const std::uint64_t bytes = fs::file_size(segment);
    if (bytes == 0 || dice_.one_in(2))
      fs::remove(segment);
    else
      fs::resize_file(segment, dice_.from(0, bytes - 1));
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  Dice dice_;
  config::Config config_;
};

TEST(Soak, KilledTasksEndTheSame) {
  run_rounds([](std::uint64_t seed) { KilledTasks(seed).run(); });
}

}  // namespace
}  // namespace meshhier::pipeline
