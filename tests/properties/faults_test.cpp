// Promises 7 and 8: a build that fails leaves nothing of itself, and what was there before as it
// was.
#include "hierarchy/error.h"
#include "pipeline/build.h"
#include "storage/file.h"
#include "storage/hash.h"
#include "tests/pipeline/sample_hierarchy.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/meshes.h"

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
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
using testing::IsEmpty;
using tests::Call;
using tests::FaultyFileSystem;

constexpr std::uint64_t kForever = std::numeric_limits<std::uint32_t>::max();

/// Files by path, with the hashes of their content; directories with 0.
using Snapshot = std::map<std::string, std::uint64_t>;

/// Sets the token when so many units of work have been done in all.
class Interrupter final : public Progress {
 public:
  Interrupter(CancelToken& token, std::uint64_t after) : token_(token), after_(after) {}
  void stage(std::string_view name, std::uint64_t, std::string_view) override {
    const std::lock_guard lock(mutex_);
    stages_.insert(std::string(name));
  }
  void advance(std::uint64_t count) override {
    if (done_.fetch_add(count) + count >= after_)
      token_.cancel();
  }
  void finish(std::string_view) override {}
  std::uint64_t done() const { return done_; }
  const std::set<std::string>& stages() const { return stages_; }

 private:
  CancelToken& token_;
  std::uint64_t after_;
  std::atomic<std::uint64_t> done_{0};
  std::mutex mutex_;
  std::set<std::string> stages_;
};

/// Sets the token at the beginning of the stage of that name.
class StageInterrupter final : public Progress {
 public:
  StageInterrupter(CancelToken& token, std::string stage)
      : token_(token), stage_(std::move(stage)) {}
  void stage(std::string_view name, std::uint64_t, std::string_view) override {
    if (name == stage_)
      token_.cancel();
  }
  void advance(std::uint64_t) override {}
  void finish(std::string_view) override {}

 private:
  CancelToken& token_;
  std::string stage_;
};

class FaultsTest : public testing::Test {
 protected:
  FaultsTest() {
    tests::write_ply(tests::sphere(3000, 0.01F), directory_.path() / "mesh.ply");
    config_.input = directory_.path() / "mesh.ply";
    config_.output = directory_.path() / "mesh.hier";
    config_.threads = 2;
    config_.partition.vertices = 150;
    config_.memory_budget = tight_budget();
  }

  /// The least budget to the byte: nothing is left for scratch data, all of it goes to the disk.
  std::uint64_t tight_budget() {
    std::uint64_t refused = 0;
    std::uint64_t accepted = std::uint64_t{1} << 30;
    CancelToken cancel;
    cancel.cancel();  // a build that is let through ends at once
    NoProgress progress;
    while (accepted - refused > 1) {
      config_.memory_budget = (refused + accepted) / 2;
      const std::optional<ErrorCode> code = run(*real_, progress, cancel);
      (code == ErrorCode::budget ? refused : accepted) = config_.memory_budget;
    }
    return accepted;
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
    NoProgress progress;
    return run(files, progress, CancelToken(), force);
  }
  std::optional<ErrorCode> run(storage::FileSystem& files, Progress& progress,
                               const CancelToken& cancel, bool force = false) {
    try {
      build_hierarchy(config_, force, {files, progress, cancel});
    } catch (const Error& error) {
      message_ = error.what();
      return error.code();
    }
    return std::nullopt;
  }

  /// Puts a finished hierarchy of other content where the output goes, and keeps a copy.
  void place_old_output() {
    config_.simplify.method = SimplifyMethod::cluster;
    FaultyFileSystem files;
    ASSERT_EQ(run(files), std::nullopt) << message_;
    config_.simplify.method = SimplifyMethod::edge_collapse;
    fs::copy(config_.output, kept_.path() / "old", fs::copy_options::recursive);
  }

  /// Calls of a kind that a whole build makes; the output is as before then.
  std::uint64_t calls(Call call, bool force) {
    FaultyFileSystem files;
    EXPECT_EQ(run(files, force), std::nullopt) << message_;
    fs::remove_all(config_.output);
    if (force)
      fs::copy(kept_.path() / "old", config_.output, fs::copy_options::recursive);
    return files.calls(call);
  }

  /// Lets calls of a kind fail, the n-th and perhaps more after it: 1, 2, 3, 5, 8, ... and the last
  /// few. Every time the build must fail and leave everything as it is now.
  void expect_nothing_changed(Call call, std::uint64_t times, bool force) {
    const std::uint64_t count = calls(call, force);
    ASSERT_GT(count, 0U);
    const Snapshot before = snapshot();
    std::set<std::uint64_t> places;
    for (std::uint64_t a = 1, b = 2; a <= count; b += a, a = b - a)
      places.insert(a);
    for (std::uint64_t last = 0; last < 4 && last < count; ++last)
      places.insert(count - last);
    for (const std::uint64_t n : places) {
      SCOPED_TRACE("call " + std::to_string(n) + " of " + std::to_string(count));
      FaultyFileSystem files;
      files.fail(call, n, times);
      message_.clear();
      EXPECT_EQ(run(files, force), ErrorCode::io) << message_;
      ASSERT_EQ(snapshot(), before) << message_;
    }
  }

  /// First without an output, then with one that is to be replaced.
  void expect_nothing_changed(Call call, std::uint64_t times = 1) {
    {
      SCOPED_TRACE("new output");
      expect_nothing_changed(call, times, false);
    }
    SCOPED_TRACE("replaced output");
    fs::remove_all(config_.output);
    place_old_output();
    expect_nothing_changed(call, times, true);
  }

  tests::TemporaryDirectory directory_;  ///< looked at as a whole
  tests::TemporaryDirectory kept_;
  std::unique_ptr<storage::FileSystem> real_ = storage::make_posix_file_system();
  Config config_;
  std::string message_;
};

TEST_F(FaultsTest, ScratchDataGoesToTheDisk) {
  // Else the faults below would only meet what is published.
  FaultyFileSystem files;
  ASSERT_EQ(run(files), std::nullopt) << message_;
  std::uint64_t output_bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(config_.output))
    output_bytes += entry.is_regular_file() ? entry.file_size() : 0;
  EXPECT_GT(files.counters().bytes_written, output_bytes * 5 / 4);
}

TEST_F(FaultsTest, AFailedWrite) {
  expect_nothing_changed(Call::write);
}

TEST_F(FaultsTest, ADiskThatStaysFull) {
  expect_nothing_changed(Call::write, kForever);
}

TEST_F(FaultsTest, AFailedRead) {
  expect_nothing_changed(Call::read);
}

TEST_F(FaultsTest, AFileThatCannotBeMade) {
  expect_nothing_changed(Call::create);
}

TEST_F(FaultsTest, AFileThatCannotBeOpened) {
  expect_nothing_changed(Call::open);
}

TEST_F(FaultsTest, ADirectoryThatCannotBeMade) {
  expect_nothing_changed(Call::make_directories);
}

TEST_F(FaultsTest, AFailedSync) {
  expect_nothing_changed(Call::sync_tree);
}

TEST_F(FaultsTest, AFailedRename) {
  expect_nothing_changed(Call::rename);
}

TEST_F(FaultsTest, FreeSpaceThatCannotBeAskedFor) {
  expect_nothing_changed(Call::free_bytes);
}

TEST_F(FaultsTest, TheMessageNamesTheFile) {
  FaultyFileSystem files;
  files.fail(Call::write, 3, kForever);
  EXPECT_EQ(run(files), ErrorCode::io);
  EXPECT_THAT(message_, HasSubstr(directory_.path().string()));
}

TEST_F(FaultsTest, ADiskOfAnySizeIsRefusedOrFilledWithoutATrace) {
  FaultyFileSystem measuring;
  ASSERT_EQ(run(measuring), std::nullopt);
  fs::remove_all(config_.output);
  const std::uint64_t written = measuring.counters().bytes_written;
  const Snapshot before = snapshot();
  for (std::uint64_t room = 1; room < written; room = room * 2 + 1000) {
    FaultyFileSystem files;
    files.limit_room(room);
    const std::optional<ErrorCode> code = run(files);
    EXPECT_TRUE(code == ErrorCode::budget || code == ErrorCode::io) << room << " bytes";
    ASSERT_EQ(snapshot(), before) << room << " bytes";
  }
}

TEST_F(FaultsTest, ShortTransfersChangeNothing) {
  FaultyFileSystem files;
  ASSERT_EQ(run(files), std::nullopt);
  const Snapshot expected = snapshot();
  files.limit_transfers(1000);
  ASSERT_EQ(run(files, true), std::nullopt) << message_;
  EXPECT_EQ(snapshot(), expected);
}

TEST_F(FaultsTest, ABuildAfterAFailureIsAsIfNothingHadHappened) {
  FaultyFileSystem files;
  ASSERT_EQ(run(files), std::nullopt);
  const Snapshot expected = snapshot();
  fs::remove_all(config_.output);
  files.fail(Call::write, 20, kForever);
  ASSERT_EQ(run(files), ErrorCode::io);
  files.fail(Call::write, 1, 0);
  ASSERT_EQ(run(files), std::nullopt) << message_;
  EXPECT_EQ(snapshot(), expected);
}

TEST_F(FaultsTest, WhatAKilledBuildLeftIsReplaced) {
  FaultyFileSystem files;
  ASSERT_EQ(run(files), std::nullopt);
  const Snapshot expected = snapshot();
  // As if killed: the work directory was never tidied up.
  fs::rename(config_.output, directory_.path() / ".mesh.hier.meshhier-work");
  ASSERT_EQ(run(files), std::nullopt) << message_;
  EXPECT_EQ(snapshot(), expected);
}

// ---- interruption --------------------------------------------------------------------------

TEST_F(FaultsTest, AnInterruptionAtAnyTimeLeavesNothing) {
  FaultyFileSystem files;
  CancelToken never;
  Interrupter measuring(never, kForever);
  ASSERT_EQ(run(files, measuring, CancelToken()), std::nullopt);
  fs::remove_all(config_.output);
  const std::uint64_t total = measuring.done();
  ASSERT_GT(total, 1000U);
  const Snapshot before = snapshot();
  int interrupted = 0;
  for (int step = 0; step < 24; ++step) {
    CancelToken cancel;
    Interrupter progress(cancel, 1 + total * static_cast<std::uint64_t>(step) / 24);
    const std::optional<ErrorCode> code = run(files, progress, cancel);
    ASSERT_EQ(code, ErrorCode::interrupted) << "at " << step << "/24: " << message_;
    ASSERT_EQ(snapshot(), before) << "at " << step << "/24";
    ++interrupted;
  }
  EXPECT_EQ(interrupted, 24);
}

TEST_F(FaultsTest, AnInterruptionInAnyStageLeavesNothing) {
  FaultyFileSystem files;
  CancelToken never;
  Interrupter measuring(never, kForever);
  ASSERT_EQ(run(files, measuring, CancelToken()), std::nullopt);
  const Snapshot before = snapshot();  // with an output, which must stay as it is
  ASSERT_GE(measuring.stages().size(), 6U);
  for (const std::string& stage : measuring.stages()) {
    CancelToken cancel;
    StageInterrupter progress(cancel, stage);
    EXPECT_EQ(run(files, progress, cancel, true), ErrorCode::interrupted) << stage;
    ASSERT_EQ(snapshot(), before) << stage;
  }
}

TEST_F(FaultsTest, ABuildThatWasInterruptedBeforeItBeganDoesNothing) {
  FaultyFileSystem files;
  CancelToken cancel;
  cancel.cancel();
  NoProgress progress;
  const Snapshot before = snapshot();
  EXPECT_EQ(run(files, progress, cancel), ErrorCode::interrupted);
  EXPECT_EQ(snapshot(), before);
}

}  // namespace
}  // namespace meshhier::pipeline
