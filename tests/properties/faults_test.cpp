// Promise 7: whatever fails, and whenever, an output is there complete or not at all, one that is
// to be replaced stays until then, and the next build goes on and makes the same bytes.
#include "base/error.h"
#include "bench/generator.h"
#include "bench/split.h"
#include "bench/stress.h"
#include "pipeline/build.h"
#include "storage/format/layout.h"
#include "storage/io/file.h"
#include "storage/io/hash.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/interrupter.h"
#include "tests/support/loaded_mesh.h"
#include "tests/support/meshes.h"
#include "tests/support/named_boxes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/share.h"
#include "tests/support/tight_budget.h"
#include "tests/support/try_build.h"

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using tests::AtStage;
using tests::Call;
using tests::FaultyFileSystem;
using tests::Interrupter;
using tests::StageInterrupter;

constexpr std::uint64_t kForever = std::numeric_limits<std::uint32_t>::max();

/// Files by path, with the hashes of their content; directories with 0.
using Snapshot = std::map<std::string, std::uint64_t>;

constexpr auto kInMemory = tests::TemporaryDirectory::Place::memory;

/// Tests builds that make a directory, and builds that make an archive.
class FaultsTest : public testing::TestWithParam<config::Container> {
 protected:
  FaultsTest() {
    tests::write_ply(tests::sphere(600, 0.01F), directory_.path() / "mesh.ply");
    config_.input = directory_.path() / "mesh.ply";
    config_.output =
        directory_.path() / (GetParam() == storage::Container::files ? "mesh.hier" : "mesh.3tz");
    config_.storage.container = GetParam();
    config_.threads = 2;
    config_.partition.vertices = 80;
    config_.memory_budget = tests::tight_budget(config_, *real_);
  }

  void use_objects() {
    tests::write_named_boxes(kept_.path() / "boxes.obj", 300);
    config_.input = kept_.path() / "boxes.obj";
    config_.objects.table = kept_.path() / "boxes.csv";
    config_.memory_budget = tests::tight_budget(config_, *real_);
  }

  Snapshot snapshot() {
    Snapshot all;
    for (const auto& entry : fs::recursive_directory_iterator(directory_.path())) {
      all[entry.path().string()] =
          entry.is_regular_file()
              ? storage::checksum(storage::read_file(*real_, entry.path(), 1U << 30))
              : 0;
    }
    return all;
  }

  /// The code a build fails with; none if it succeeds.
  std::optional<ErrorCode> run(storage::FileSystem& files, bool force = false) {
    execution::NoProgress progress;
    return run(files, progress, execution::CancelToken(), force);
  }
  std::optional<ErrorCode> run(storage::FileSystem& files, execution::Progress& progress,
                               const execution::CancelToken& cancel, bool force = false) {
    return tests::try_build(config_, force, {files, progress, cancel}, message_);
  }

  /// Returns the output that there must be.
  Snapshot expected() {
    FaultyFileSystem files;
    EXPECT_EQ(run(files), std::nullopt) << message_;
    const Snapshot result = output();
    fs::remove_all(config_.output);
    return result;
  }

  /// Returns the output's files, by their paths in it.
  Snapshot output() {
    Snapshot all;
    if (!fs::exists(config_.output))
      return all;
    std::vector<fs::path> files{config_.output};
    if (fs::is_directory(config_.output))
      files = real_->list(config_.output);
    for (const fs::path& file : files) {
      all[fs::relative(file, config_.output).string()] =
          storage::checksum(storage::read_file(*real_, file, 1U << 30));
    }
    return all;
  }

  /// Names beside the input.
  std::set<std::string> names() const {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(directory_.path()))
      all.insert(entry.path().filename().string());
    all.erase("mesh.ply");
    return all;
  }

  std::set<std::string> only_output() const { return {config_.output.filename().string()}; }

  /// Puts a finished hierarchy where the output goes, of the same tiles and another tileset: only
  /// care keeps the next build from taking it for what a stopped one made. Returns its content.
  Snapshot place_old_output() {
    if (!fs::exists(kept_.path() / "old")) {
      config_.licence = "of the old one";
      FaultyFileSystem files;
      EXPECT_EQ(run(files, true), std::nullopt) << message_;
      config_.licence.clear();
      fs::rename(config_.output, kept_.path() / "old");
    }
    fs::remove_all(config_.output);
    fs::copy(kept_.path() / "old", config_.output, fs::copy_options::recursive);
    return output();
  }

  struct Failures {
    std::uint64_t times = 1;   ///< so many calls, one after the other
    bool replaces = false;     ///< an output that is there
    bool can_exchange = true;  ///< else by two renames
    std::string from{};  ///< the stage whose calls are counted, and those after it; empty: all
  };

  /// Lets the n-th call fail, and `times` - 1 after it, for all n of the share that a build gets
  /// to. Every time the output must be the old one or the new one, and the next build must make the
  /// new one and leave nothing else. Returns how many builds failed, or would, were it all n. Of
  /// archives, which are made the same way but for the last calls, every fourth, unless a stage is
  /// asked for.
  int fail_every_call(const Failures& failures) {
    const auto& [times, replaces, can_exchange, from] = failures;
    const Snapshot after = expected();
    const std::uint64_t step = from.empty() ? static_cast<std::uint64_t>(stride()) : 1;
    const tests::Share& share = tests::share();
    int failed = 0;
    for (std::uint64_t n = 1 + share.index * step;; n += share.count * step) {
      SCOPED_TRACE("call " + std::to_string(n));
      const Snapshot before = replaces ? place_old_output() : Snapshot();
      FaultyFileSystem files;
      if (!can_exchange)
        files.deny_exchange();
      std::uint64_t failing = kForever;  // among all calls
      const auto begin = [&, times = times] {
        failing = files.calls(Call::any) + n;
        files.fail(Call::any, n, times);
      };
      if (from.empty())
        begin();
      AtStage progress(from, begin);
      message_.clear();
      const std::optional<ErrorCode> code =
          run(files, progress, execution::CancelToken(), replaces);
      if (code)
        EXPECT_EQ(code, ErrorCode::io) << message_;
      else
        EXPECT_EQ(output(), after);
      failed += code ? 1 : 0;
      const Snapshot found = output();
      const bool displaced =
          !can_exchange && found.empty() && fs::exists(storage::replaced_path(config_.output));
      EXPECT_TRUE(found == before || found == after || displaced) << message_;
      const bool reached = files.calls(Call::any) >= failing;
      FaultyFileSystem sound;
      EXPECT_EQ(run(sound, true), std::nullopt) << message_;
      EXPECT_EQ(output(), after);
      EXPECT_EQ(names(), only_output());
      fs::remove_all(config_.output);
      if (!reached || HasFailure())
        return failed * static_cast<int>(share.count);
    }
  }

  /// Interrupts builds at many times; each must be gone on with to the same bytes.
  void interrupt_anywhere() {
    const Snapshot after = expected();
    FaultyFileSystem files;
    execution::CancelToken never;
    Interrupter measuring(never, kForever);
    ASSERT_EQ(run(files, measuring, execution::CancelToken()), std::nullopt);
    fs::remove_all(config_.output);
    const std::uint64_t total = measuring.done();
    ASSERT_GT(total, 1000U);
    for (std::uint64_t step = 0; step < 24; ++step) {
      SCOPED_TRACE(step);
      execution::CancelToken cancel;
      Interrupter progress(cancel, 1 + total * step / 24);
      ASSERT_EQ(run(files, progress, cancel), ErrorCode::interrupted) << message_;
      EXPECT_FALSE(fs::exists(config_.output));
      ASSERT_EQ(run(files), std::nullopt) << message_;
      EXPECT_EQ(output(), after);
      EXPECT_EQ(names(), only_output());
      fs::remove_all(config_.output);
    }
  }

  static int stride() { return GetParam() == storage::Container::files ? 1 : 4; }

  tests::TemporaryDirectory directory_{kInMemory};  ///< looked at as a whole
  tests::TemporaryDirectory kept_{kInMemory};
  std::unique_ptr<storage::FileSystem> real_ = storage::make_posix_file_system();
  config::Config config_ = tests::quick_config();
  std::string message_;
};

TEST_P(FaultsTest, SANITIZED_AnyCallMayFail) {
  EXPECT_GT(fail_every_call({}) * stride(), 200);
}

TEST_P(FaultsTest, AnyCallMayFailWhileAnOutputIsReplaced) {
  EXPECT_GT(fail_every_call({.replaces = true}) * stride(), 200);
}

TEST_P(FaultsTest, AnyCallOfTheStageThatMakesThePreviewMayFail) {
  config_.preview = true;
  config_.partition.vertices = 1000;  // one tile: few calls besides
  EXPECT_GT(fail_every_call({.from = "publish"}), 10);
  EXPECT_GT(fail_every_call({.times = kForever, .from = "publish"}), 10);
}

TEST_P(FaultsTest, AnyCallWhileObjectsAreBroughtToTilesMayFail) {
  use_objects();
  config_.partition.vertices = 1000;
  EXPECT_GT(fail_every_call({.from = "publish"}), 10);
  EXPECT_GT(fail_every_call({.times = kForever, .from = "publish"}), 10);
}

// Nothing is tidied up then: it is as if the process had been killed.
TEST_P(FaultsTest, AnyCallMayBeTheLast) {
  EXPECT_GT(fail_every_call({.times = kForever}) * stride(), 200);
}

TEST_P(FaultsTest, AnyCallMayBeTheLastWhileAnOutputIsReplaced) {
  EXPECT_GT(fail_every_call({.times = kForever, .replaces = true}) * stride(), 200);
}

TEST_P(FaultsTest, AnyCallMayBeTheLastWhileAnOutputIsReplacedByTwoRenames) {
  EXPECT_GT(
      fail_every_call({.times = kForever, .replaces = true, .can_exchange = false}) * stride(),
      200);
}

TEST_P(FaultsTest, SANITIZED_TheMessageNamesTheFile) {
  FaultyFileSystem files;
  files.fail(Call::write, 3, kForever);
  EXPECT_EQ(run(files), ErrorCode::io);
  EXPECT_THAT(message_, HasSubstr(directory_.path().string()));
}

TEST_P(FaultsTest, ADiskOfAnySizeIsRefusedOrFilledAndGoneOnWithWhenThereIsRoom) {
  const Snapshot after = expected();
  FaultyFileSystem measuring;
  ASSERT_EQ(run(measuring), std::nullopt);
  fs::remove_all(config_.output);
  const std::uint64_t written = measuring.counters().bytes_written;
  for (std::uint64_t room = 1; room < written; room = room * 2 + 1000) {
    SCOPED_TRACE(room);
    FaultyFileSystem files;
    files.limit_room(room);
    const std::optional<ErrorCode> code = run(files);
    EXPECT_TRUE(code == ErrorCode::budget || code == ErrorCode::io);
    EXPECT_FALSE(fs::exists(config_.output));
  }
  FaultyFileSystem sound;
  ASSERT_EQ(run(sound), std::nullopt) << message_;
  EXPECT_EQ(output(), after);
}

// The figure of free space is only a figure: here it lies, and the disk is full in the middle of a
// write.
TEST_P(FaultsTest, ADiskThatIsFullAtAnyByte) {
  const Snapshot after = expected();
  FaultyFileSystem measuring;
  ASSERT_EQ(run(measuring), std::nullopt);
  fs::remove_all(config_.output);
  const std::uint64_t written = measuring.counters().bytes_written;
  const tests::Share share = tests::share().of(60);
  const std::uint64_t step = written / 60 + 7;
  for (std::uint64_t room = 1 + share.index * step; room < written; room += share.count * step) {
    SCOPED_TRACE(room);
    FaultyFileSystem files;
    files.limit_writes(room);
    EXPECT_EQ(run(files), ErrorCode::io);
    EXPECT_FALSE(fs::exists(config_.output));
    FaultyFileSystem sound;
    ASSERT_EQ(run(sound), std::nullopt) << message_;
    EXPECT_EQ(output(), after);
    EXPECT_EQ(names(), only_output());
    fs::remove_all(config_.output);
  }
}

TEST_P(FaultsTest, ShortTransfersChangeNothing) {
  FaultyFileSystem files;
  ASSERT_EQ(run(files), std::nullopt);
  const Snapshot expected = snapshot();
  files.limit_transfers(1000);
  ASSERT_EQ(run(files, true), std::nullopt) << message_;
  EXPECT_EQ(snapshot(), expected);
}

// ---- interruption --------------------------------------------------------------------------

TEST_P(FaultsTest, AnInterruptionAtAnyTimeIsGoneOnFrom) {
  interrupt_anywhere();
}

TEST_P(FaultsTest, AnInterruptionIsGoneOnFromWithSeveralVerticesAtAPlace) {
  const bench::LoadedMesh mesh =
      bench::split(tests::loaded(tests::sphere(600, 0.01F)), "mixed", 20);
  bench::write_ply(*real_, {directory_.path() / "mesh.ply", true}, *bench::as_generated(mesh));
  config_.memory_budget = tests::tight_budget(config_, *real_);
  interrupt_anywhere();
}

TEST_P(FaultsTest, AnInterruptionIsGoneOnFromWithObjects) {
  use_objects();
  interrupt_anywhere();
}

// One build, interrupted again and again, always goes on where it was.
TEST_P(FaultsTest, SANITIZED_InterruptionsAddUp) {
  config_.partition.vertices = 20;
  config_.memory_budget = std::uint64_t{1} << 28;
  const Snapshot after = expected();
  FaultyFileSystem files;
  {
    execution::CancelToken cancel;
    StageInterrupter progress(cancel, "leaves");
    ASSERT_EQ(run(files, progress, cancel), ErrorCode::interrupted);
  }
  int interruptions = 0;
  for (std::optional<ErrorCode> code = ErrorCode::interrupted; code; ++interruptions) {
    ASSERT_LT(interruptions, 200);
    execution::CancelToken cancel;
    Interrupter progress(cancel, 3, {"outline", "pack"});  // they are made at one go
    code = run(files, progress, cancel);
    ASSERT_TRUE(!code || code == ErrorCode::interrupted) << message_;
  }
  EXPECT_GT(interruptions, 5);
  EXPECT_EQ(output(), after);
}

TEST_P(FaultsTest, AnInterruptionInAnyStageLeavesTheOutput) {
  FaultyFileSystem files;
  execution::CancelToken never;
  Interrupter measuring(never, kForever);
  ASSERT_EQ(run(files, measuring, execution::CancelToken()), std::nullopt);
  const Snapshot before = output();
  ASSERT_GE(measuring.stages().size(), 6U);
  for (const std::string& stage : measuring.stages()) {
    execution::CancelToken cancel;
    StageInterrupter progress(cancel, stage);
    EXPECT_EQ(run(files, progress, cancel, true), ErrorCode::interrupted) << stage;
    ASSERT_EQ(output(), before) << stage;
    fs::remove_all(storage::work_path(config_.output));
  }
}

TEST_P(FaultsTest, ABuildThatWasInterruptedBeforeItBeganDoesNothing) {
  FaultyFileSystem files;
  execution::CancelToken cancel;
  cancel.cancel();
  execution::NoProgress progress;
  const Snapshot before = snapshot();
  EXPECT_EQ(run(files, progress, cancel), ErrorCode::interrupted);
  EXPECT_EQ(snapshot(), before);
}

INSTANTIATE_TEST_SUITE_P(Containers, FaultsTest,
                         testing::Values(storage::Container::files, storage::Container::archive),
                         [](const auto& test) {
                           return test.param == storage::Container::files ? "Files" : "Archive";
                         });

}  // namespace
}  // namespace meshhier::pipeline
