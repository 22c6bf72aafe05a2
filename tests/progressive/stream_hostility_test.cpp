// Promise 7 for progressive streams: whatever happens to the files, or while they are made, what is
// told is an error that names the file, and no output is there but a complete one.
#include "base/error.h"
#include "execution/size_text.h"
#include "progressive/reconstruct.h"
#include "progressive/stream.h"
#include "progressive/stream_index.h"
#include "storage/format/layout.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/half_edge_hierarchy.h"
#include "tests/support/interrupter.h"
#include "tests/support/memory_files.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::Call;
using tests::FaultyFileSystem;
using tests::MemoryFiles;
using tests::node;
using StreamBytes = MemoryFiles::Bytes;

/// Files by path, with what they hold.
using Contents = std::vector<std::pair<std::string, std::string>>;

constexpr std::uint64_t kAlways = std::numeric_limits<std::uint32_t>::max();

/// The error of a command; none if it succeeds. Anything but an Error fails the test.
std::optional<Error> error_of(const std::function<void()>& command) {
  try {
    command();
  } catch (const Error& error) {
    return error;
  } catch (const std::exception& other) {
    ADD_FAILURE() << "not an Error: " << other.what();
  }
  return std::nullopt;
}

class StreamTest : public testing::Test {
 protected:
  static constexpr const char* kHierarchy = "/models/mesh.hier";
  static constexpr const char* kStream = "/models/mesh.prog";
  static constexpr const char* kOutput = "/models/out.ply";
  static constexpr std::uint64_t kPlenty = std::uint64_t{1} << 28;

  StreamTest() {
    build(0.05F);
    write(files_, options(), progress_, cancel_);
  }

  /// Five partitions: with early nodes.
  void build(float noise) {
    tests::build_half_edge(
        files_, tests::attributed(tests::sphere(60, noise), {false, ColourType::u8, false, false}),
        tests::half_edge_config("/models", 5, 8));
  }

  static progressive::ProgressiveOptions options() { return {{}, {}, kStream, true, kPlenty}; }

  static void write(storage::FileSystem& files, const progressive::ProgressiveOptions& options,
                    execution::Progress& progress, const execution::CancelToken& cancel) {
    progressive::write_progressive(files, kHierarchy, options, progress, cancel);
  }
  std::optional<Error> write_error(const progressive::ProgressiveOptions& options) {
    return error_of([&] { write(files_, options, progress_, cancel_); });
  }

  std::optional<Error> reconstruct_error(std::optional<std::uint32_t> details = {},
                                         std::uint64_t budget = kPlenty) {
    return error_of([&] {
      progressive::reconstruct(files_, kStream, {details, kOutput, budget, true}, progress_,
                               cancel_);
    });
  }

  Contents contents(const fs::path& directory) {
    Contents all;
    for (const fs::path& path : files_.list(directory))
      all.emplace_back(path.string(), files_.content(path));
    return all;
  }

  /// Returns the files beside the stream and its sources.
  std::vector<std::string> litter() {
    std::vector<std::string> names;
    for (const fs::path& path : files_.children("/models")) {
      const std::string name = path.filename().string();
      if (name != "mesh.ply" && name != "mesh.hier" && name != "mesh.prog" && name != "out.ply")
        names.push_back(name);
    }
    return names;
  }

  MemoryFiles files_;
  execution::NoProgress progress_;
  execution::CancelToken cancel_;
};

// ---- damaged streams -------------------------------------------------------------------------

class DamagedStreamTest : public StreamTest {
 protected:
  DamagedStreamTest() {
    paths_ = files_.list(kStream);
    const auto steps = progressive::read_progressive_index(files_, kStream).files.size();
    for (std::uint32_t details = 0; details < steps; ++details) {
      EXPECT_FALSE(reconstruct_error(details));
      meshes_.push_back(files_.content(kOutput));
    }
  }

  /// The step whose file it is; none of the index.
  std::optional<std::uint32_t> step_of(const fs::path& path) const {
    for (std::uint32_t step = 0; step < meshes_.size(); ++step) {
      if (path == storage::detail_path(kStream, step))
        return step;
    }
    return std::nullopt;
  }

  /// After something was done to the file of `path`: it is named wherever it is needed, and
  /// otherwise the mesh is what it was. What was there before stays.
  void expect_noticed(const fs::path& path) {
    const std::optional<std::uint32_t> step = step_of(path);
    for (std::uint32_t details = 0; details < meshes_.size(); ++details) {
      files_.put(kOutput, "old");
      const std::optional<Error> error = reconstruct_error(details);
      if (step && details < *step) {
        EXPECT_FALSE(error) << error->what();
        EXPECT_TRUE(files_.content(kOutput) == meshes_[details]);
        continue;
      }
      ASSERT_TRUE(error) << "not noticed";
      EXPECT_TRUE(error->code() == ErrorCode::corrupt || error->code() == ErrorCode::io);
      EXPECT_THAT(error->what(), HasSubstr(path.filename().string()));
      EXPECT_EQ(files_.content(kOutput), "old");
    }
    EXPECT_THAT(litter(), IsEmpty());
  }

  std::vector<fs::path> paths_;
  std::vector<std::string> meshes_;  ///< by details
};

TEST_F(DamagedStreamTest, SLOW_AFlippedBitAnywhereIsFoundAndNamed) {
  ASSERT_EQ(paths_.size(), 5U);
  for (const fs::path& path : paths_) {
    SCOPED_TRACE(path);
    const std::size_t size = files_.bytes(path).size();
    for (std::size_t at = 0; at < size && !HasFailure(); ++at) {
      SCOPED_TRACE(at);
      files_.bytes(path)[at] ^= std::byte{1} << static_cast<int>(at % 8);
      expect_noticed(path);
      files_.bytes(path)[at] ^= std::byte{1} << static_cast<int>(at % 8);
    }
  }
}

TEST_F(DamagedStreamTest, SLOW_AnyTruncationIsFoundAndNamed) {
  for (const fs::path& path : paths_) {
    SCOPED_TRACE(path);
    const StreamBytes whole = files_.bytes(path);
    for (std::size_t size = 0; size < whole.size() && !HasFailure(); size += 3) {
      SCOPED_TRACE(size);
      files_.bytes(path).resize(size);
      expect_noticed(path);
      files_.bytes(path) = whole;
    }
    files_.bytes(path).resize(whole.size() + 1);
    expect_noticed(path);
    files_.bytes(path) = whole;
  }
}

TEST_F(DamagedStreamTest, SLOW_AMissingFileIsNamedWhereItIsNeeded) {
  for (const fs::path& path : paths_) {
    SCOPED_TRACE(path);
    const StreamBytes whole = files_.bytes(path);
    files_.remove_all(path);
    expect_noticed(path);
    files_.make_directories(path);
    expect_noticed(path);
    files_.remove_all(path);
    storage::write_file(files_, path, whole);
  }
}

TEST_F(DamagedStreamTest, TheMessageTellsHowFarTheStreamIsSound) {
  files_.remove_all(storage::detail_path(kStream, 2));
  const std::optional<Error> error = reconstruct_error();
  ASSERT_TRUE(error);
  EXPECT_THAT(error->what(), AllOf(HasSubstr("detail_02.bin"), HasSubstr("--details 1")));
}

TEST_F(DamagedStreamTest, SwappedFilesAreNamed) {
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      std::swap(files_.bytes(paths_[i]), files_.bytes(paths_[j]));
      const std::optional<Error> error = reconstruct_error();
      ASSERT_TRUE(error);
      EXPECT_THAT(error->what(), testing::AnyOf(HasSubstr(paths_[i].filename().string()),
                                                HasSubstr(paths_[j].filename().string())));
      std::swap(files_.bytes(paths_[i]), files_.bytes(paths_[j]));
    }
  }
}

TEST_F(DamagedStreamTest, SLOW_AFileOfAnotherStreamIsNamed) {
  build(0.06F);
  progressive::ProgressiveOptions other = options();
  other.output = "/models/other.prog";
  write(files_, other, progress_, cancel_);
  for (const fs::path& path : paths_) {
    SCOPED_TRACE(path);
    if (!step_of(path))
      continue;  // an index is whole: to it the others are of another stream
    StreamBytes& theirs = files_.bytes(other.output / path.filename());
    std::swap(files_.bytes(path), theirs);
    const std::optional<Error> error = reconstruct_error();
    ASSERT_TRUE(error);
    EXPECT_THAT(error->what(), HasSubstr(path.filename().string()));
    std::swap(files_.bytes(path), theirs);
  }
  EXPECT_FALSE(reconstruct_error());
}

/// Files whose checksums are right, but whose lists contradict the index.
TEST_F(DamagedStreamTest, ListsThatContradictTheIndexAreNamed) {
  const progressive::ProgressiveIndex good = progressive::read_progressive_index(files_, kStream);
  const auto with = [&](const std::function<void(progressive::ProgressiveIndex&)>& change) {
    progressive::ProgressiveIndex changed = good;
    change(changed);
    files_.put(storage::progressive_index_path(kStream), to_json_text(changed));
    const std::optional<Error> error = reconstruct_error();
    return error ? std::string(error->what()) : std::string();
  };
  EXPECT_EQ(with([](auto&) {}), "");
  EXPECT_THAT(with([](auto& index) { --index.files[1].vertices; }),
              HasSubstr("detail_01.bin: its counts are not those of the index"));
  EXPECT_THAT(with([](auto& index) { --index.files[1].triangles; }),
              HasSubstr("detail_01.bin: its counts"));
  EXPECT_THAT(with([](auto& index) { --index.files[0].merges; }),
              HasSubstr("base.bin: its counts"));
  EXPECT_THAT(with([](auto& index) { --index.files[2].shown_vertices; }),
              HasSubstr("detail_02.bin: its counts"));
  EXPECT_THAT(with([](auto& index) { --index.files[2].shown_triangles; }),
              HasSubstr("detail_02.bin: its counts"));
  EXPECT_THAT(with([](auto& index) { std::swap(index.files[1], index.files[2]); }),
              HasSubstr("detail_01.bin"));
  EXPECT_THAT(with([](auto& index) { index.files.erase(index.files.begin()); }),
              HasSubstr("base.bin"));
  EXPECT_THAT(with([](auto& index) { index.source.attributes = {}; }), HasSubstr("base.bin"));
}

TEST_F(DamagedStreamTest, SizesThatNoMemoryHoldsAreRefused) {
  progressive::ProgressiveIndex lying = progressive::read_progressive_index(files_, kStream);
  const auto code_with = [&](std::uint64_t triangles) {
    lying.triangles = triangles;
    files_.put(storage::progressive_index_path(kStream), to_json_text(lying));
    const std::optional<Error> error = reconstruct_error();
    return error ? error->code() : ErrorCode::internal;
  };
  EXPECT_EQ(code_with(std::uint64_t{1} << 30), ErrorCode::budget);
  EXPECT_EQ(code_with(std::uint64_t{1} << 56), ErrorCode::budget);
  // Twelve bytes each: as 64 bits they would wrap around to 0.
  EXPECT_EQ(code_with(std::uint64_t{1} << 62), ErrorCode::corrupt);
}

// ---- errors ----------------------------------------------------------------------------------

TEST_F(StreamTest, AnotherMethodIsNamedWithWhatToDo) {
  for (const auto& method : config::kSimplifyMethods) {
    config::Config config = tests::half_edge_config("/models", 4, 20);
    config.simplify.method = method.value;
    tests::build_half_edge(files_, {tests::sphere(100), {}, {}, {}}, config);
    const std::optional<Error> error = write_error(options());
    if (method.value == config::SimplifyMethod::half_edge) {
      EXPECT_FALSE(error);
      continue;
    }
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::usage);
    EXPECT_THAT(error->what(), AllOf(HasSubstr("was simplified by " + std::string(method.name)),
                                     HasSubstr("\"simplify\": {\"method\": \"half_edge\"}")));
  }
}

TEST_F(StreamTest, AnOutputThatIsThereStays) {
  const Contents before = contents(kStream);
  progressive::ProgressiveOptions without_force = options();
  without_force.replace = false;
  const std::optional<Error> error = write_error(without_force);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::exists);
  EXPECT_THAT(error->what(), HasSubstr("--force"));
  EXPECT_EQ(contents(kStream), before);
}

TEST_F(StreamTest, ForceReplacesNothingButStreams) {
  files_.put("/models/mine/diary.txt", "dear diary");
  const Contents hierarchy = contents(kHierarchy);
  const auto refused = [&](const char* output, ErrorCode code, const char* message) {
    progressive::ProgressiveOptions elsewhere = options();
    elsewhere.output = output;
    const std::optional<Error> error = write_error(elsewhere);
    ASSERT_TRUE(error) << output;
    EXPECT_EQ(error->code(), code) << output;
    EXPECT_THAT(error->what(), HasSubstr(message));
  };
  refused("/models/mine", ErrorCode::exists, "is not a progressive stream");
  for (const char* output : {kHierarchy, "/models/mesh.ply"})
    refused(output, ErrorCode::usage, "a directory of its own kind");
  EXPECT_EQ(files_.content("/models/mine/diary.txt"), "dear diary");
  EXPECT_EQ(contents(kHierarchy), hierarchy);
}

TEST_F(StreamTest, StepsAreAsManyAsThereAreLevels) {
  for (const std::uint32_t steps : {0U, 4U, 1000U, 4294967295U}) {
    progressive::ProgressiveOptions wrong = options();
    wrong.steps = steps;
    const std::optional<Error> error = write_error(wrong);
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::usage);
    EXPECT_THAT(error->what(), HasSubstr(fmt::format("--steps {}: expected 1 to 3", steps)));
  }
  progressive::ProgressiveOptions leaf = options();
  leaf.steps = 1;
  leaf.node = node(3, 2);
  const std::optional<Error> error = write_error(leaf);
  ASSERT_TRUE(error);
  EXPECT_THAT(error->what(), HasSubstr("there is no level below 3/2"));
}

TEST_F(StreamTest, ANodeThatIsNotThereIsToldWithThoseThatAre) {
  progressive::ProgressiveOptions wrong = options();
  wrong.node = node(2, 4);
  const std::optional<Error> error = write_error(wrong);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::usage);
  EXPECT_THAT(error->what(), HasSubstr("the nodes of level 2 are 0 to 3"));
  wrong.node = node(9, 0);
  ASSERT_TRUE(write_error(wrong));
  EXPECT_EQ(write_error(wrong)->code(), ErrorCode::usage);
}

TEST_F(StreamTest, DetailsAreAsManyAsThereAre) {
  const std::optional<Error> error = reconstruct_error(4);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::usage);
  EXPECT_THAT(error->what(), HasSubstr("--details 4: the stream has 3"));
  EXPECT_FALSE(files_.exists(kOutput));
}

/// The size behind `before`.
std::uint64_t named_budget(const std::string& message, const std::string& before) {
  const std::size_t place = message.find(before);
  EXPECT_NE(place, std::string::npos) << message;
  const std::size_t begin = place + before.size();
  return execution::parse_size(message.substr(begin, message.find(' ', begin) - begin)).value_or(0);
}

TEST_F(StreamTest, ABudgetThatIsTooSmallNamesOneThatWouldDo) {
  const Contents before = contents(kStream);
  progressive::ProgressiveOptions small = options();
  small.memory_budget = 1000;
  std::optional<Error> error = write_error(small);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::budget);
  EXPECT_EQ(contents(kStream), before);
  small.memory_budget = named_budget(error->what(), "--memory-budget ");
  EXPECT_FALSE(write_error(small));
  EXPECT_EQ(contents(kStream), before);

  error = reconstruct_error({}, 1000);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::budget);
  EXPECT_FALSE(files_.exists(kOutput));
  EXPECT_FALSE(reconstruct_error({}, named_budget(error->what(), "--memory-budget ")));
}

TEST_F(StreamTest, NoOutputGoesIntoWhatIsRead) {
  const Contents stream = contents(kStream), hierarchy = contents(kHierarchy);
  progressive::ProgressiveOptions inside = options();
  inside.output = fs::path(kHierarchy) / "tiles" / "mesh.prog";
  const std::optional<Error> refused = write_error(inside);
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code(), ErrorCode::usage);
  for (const char* name : {"base.bin", "out.ply"}) {
    const std::optional<Error> error = error_of([&] {
      progressive::reconstruct(files_, kStream,
                               {.output = fs::path(kStream) / name, .replace = true}, progress_,
                               cancel_);
    });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::usage);
  }
  EXPECT_EQ(contents(kStream), stream);
  EXPECT_EQ(contents(kHierarchy), hierarchy);
}

TEST_F(StreamTest, APathThatIsNoStreamIsTold) {
  for (const char* path : {"/models/none", kHierarchy, "/models/mesh.ply"}) {
    const std::optional<Error> error = error_of([&] {
      progressive::reconstruct(files_, path, {.output = kOutput, .replace = true}, progress_,
                               cancel_);
    });
    ASSERT_TRUE(error) << path;
    EXPECT_EQ(error->code(), ErrorCode::io);
    EXPECT_THAT(error->what(), HasSubstr("progressive.json"));
  }
  EXPECT_FALSE(files_.exists(kOutput));
}

TEST_F(StreamTest, AMistypedDirectoryOfTheMeshIsNotMade) {
  for (const char* output : {"/models/none/out.ply", "", ".", "/models/.."}) {
    EXPECT_TRUE(error_of([&] {
      progressive::reconstruct(files_, kStream, {.output = output, .replace = true}, progress_,
                               cancel_);
    })) << output;
  }
  EXPECT_FALSE(files_.exists("/models/none"));
  EXPECT_THAT(litter(), IsEmpty());
}

TEST_F(StreamTest, ADamagedTileIsNamedAndNoStreamMade) {
  files_.remove_all(kStream);
  for (const fs::path& path : files_.list(fs::path(kHierarchy) / "tiles")) {
    SCOPED_TRACE(path);
    const StreamBytes whole = files_.bytes(path);
    files_.bytes(path).back() ^= std::byte{1};
    const std::optional<Error> error = write_error(options());
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::corrupt);
    EXPECT_THAT(error->what(), HasSubstr(path.filename().string()));
    EXPECT_FALSE(files_.exists(kStream));
    EXPECT_THAT(litter(), IsEmpty());
    files_.bytes(path) = whole;
  }
}

TEST_F(StreamTest, WhatAStoppedBuildHasDoneStays) {
  const fs::path journal = storage::journal_path(storage::work_path("/models/other"));
  files_.put(journal, "done");
  progressive::ProgressiveOptions there = options();
  there.output = "/models/other";
  const std::optional<Error> error = write_error(there);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::other_work);
  EXPECT_THAT(error->what(), HasSubstr("stopped build"));
  EXPECT_EQ(files_.content(journal), "done");
}

// ---- faults ----------------------------------------------------------------------------------

class StreamFaultsTest : public StreamTest {
 protected:
  /// The files of the test, for a FaultyFileSystem to make calls of go wrong.
  std::shared_ptr<storage::FileSystem> borrowed() {
    return {&files_, [](auto*) {}};
  }

  using Job = std::function<void(storage::FileSystem&, execution::Progress&,
                                 const execution::CancelToken&)>;

  static void writing(storage::FileSystem& files, execution::Progress& progress,
                      const execution::CancelToken& cancel) {
    write(files, options(), progress, cancel);
  }
  static void reconstructing(storage::FileSystem& files, execution::Progress& progress,
                             const execution::CancelToken& cancel) {
    progressive::reconstruct(files, kStream, {.output = kOutput, .replace = true}, progress,
                             cancel);
  }

  /// Returns the files that jobs make: the stream and the mesh.
  Contents made() {
    Contents all = files_.exists(kStream) ? contents(kStream) : Contents();
    if (files_.exists(kOutput))
      all.emplace_back(kOutput, files_.content(kOutput));
    return all;
  }

  /// Lets each call in turn fail, and `times` - 1 after it. `prepare` makes what is there before.
  /// Returns how many jobs failed.
  int fail_every_call(const Job& job, const std::function<void()>& prepare, std::uint64_t times) {
    prepare();
    job(files_, progress_, cancel_);
    const Contents after = made();
    int failures = 0;
    for (std::uint64_t n = 1;; ++n) {
      SCOPED_TRACE("call " + std::to_string(n));
      prepare();
      const Contents before = made();
      FaultyFileSystem faulty(borrowed());
      faulty.fail(Call::any, n, times);
      const std::optional<Error> error = error_of([&] { job(faulty, progress_, cancel_); });
      failures += error ? 1 : 0;
      EXPECT_TRUE(!error || error->code() == ErrorCode::io) << error->what();
      const bool displaced = files_.exists(storage::replaced_path(kStream));
      const Contents found = made();
      EXPECT_TRUE(found == after || (error && (found == before || displaced)));
      leftovers_ += litter().empty() ? 0 : 1;
      job(files_, progress_, cancel_);
      EXPECT_TRUE(made() == after);
      EXPECT_THAT(litter(), IsEmpty());
      if (faulty.calls(Call::any) < n || HasFailure())
        return failures;
    }
  }

  void without_stream() { files_.remove_all(kStream); }
  void with_old_stream() {
    progressive::ProgressiveOptions other = options();
    other.steps = 1;
    write(files_, other, progress_, cancel_);
  }
  void with_old_mesh() { files_.put(kOutput, "old"); }
  void without_mesh() { files_.remove_all(kOutput); }

  int leftovers_ = 0;  ///< how often there was more than before
};

/// So large that lists go to the disk where memory is short.
TEST_F(StreamFaultsTest, SLOW_ListsOnTheDiskMayFailToo) {
  tests::build_half_edge(files_, {tests::sphere(40000, 0.002F), {}, {}, {}},
                         tests::half_edge_config("/models", 300, 60));
  progressive::ProgressiveOptions tight = options();
  tight.memory_budget = 1;
  const std::optional<Error> refused = error_of([&] { write(files_, tight, progress_, cancel_); });
  ASSERT_TRUE(refused);
  tight.memory_budget = named_budget(refused->what(), "--memory-budget ");
  const Job job = [&](storage::FileSystem& files, execution::Progress& progress,
                      const execution::CancelToken& cancel) {
    write(files, tight, progress, cancel);
  };
  write(files_, options(), progress_, cancel_);
  const Contents expected = contents(kStream);
  FaultyFileSystem measuring(borrowed());
  job(measuring, progress_, cancel_);
  EXPECT_TRUE(contents(kStream) == expected);
  std::uint64_t stream_bytes = 0;
  for (const auto& [path, content] : expected)
    stream_bytes += content.size();
  EXPECT_GT(measuring.counters().bytes_written, 2 * stream_bytes) << "the disk was not used";
  for (const Call call : {Call::read, Call::write}) {
    const std::uint64_t calls = measuring.calls(call);
    for (std::uint64_t n = 1; n <= calls; n += 1 + calls / 12) {
      FaultyFileSystem faulty(borrowed());
      faulty.fail(call, n);
      const std::optional<Error> error = error_of([&] { job(faulty, progress_, cancel_); });
      ASSERT_TRUE(error) << n;
      EXPECT_EQ(error->code(), ErrorCode::io);
      EXPECT_TRUE(contents(kStream) == expected);
      EXPECT_THAT(litter(), IsEmpty());
    }
  }
}

TEST_F(StreamFaultsTest, AnyCallMayFailWhileAStreamIsMade) {
  EXPECT_GT(fail_every_call(
                writing, [this] { without_stream(); }, 1),
            20);
  // The call that failed may have been one that tidies up.
  EXPECT_LE(leftovers_, 3);
}

TEST_F(StreamFaultsTest, AnyCallMayBeTheLastWhileAStreamIsMade) {
  EXPECT_GT(fail_every_call(
                writing, [this] { without_stream(); }, kAlways),
            20);
}

TEST_F(StreamFaultsTest, SLOW_AnyCallMayFailWhileAStreamIsReplaced) {
  EXPECT_GT(fail_every_call(
                writing, [this] { with_old_stream(); }, 1),
            20);
}

TEST_F(StreamFaultsTest, SLOW_AnyCallMayBeTheLastWhileAStreamIsReplaced) {
  EXPECT_GT(fail_every_call(
                writing, [this] { with_old_stream(); }, kAlways),
            20);
}

TEST_F(StreamFaultsTest, AnyCallMayFailWhileAMeshIsReconstructed) {
  EXPECT_GT(fail_every_call(
                reconstructing, [this] { with_old_mesh(); }, 1),
            15);
  EXPECT_GT(fail_every_call(
                reconstructing, [this] { without_mesh(); }, 1),
            15);
  EXPECT_EQ(leftovers_, 0);
}

TEST_F(StreamFaultsTest, AnyCallMayBeTheLastWhileAMeshIsReconstructed) {
  EXPECT_GT(fail_every_call(
                reconstructing, [this] { with_old_mesh(); }, kAlways),
            15);
}

TEST_F(StreamFaultsTest, ShortTransfersChangeNothing) {
  const Contents before = contents(kStream);
  FaultyFileSystem slow(borrowed());
  slow.limit_transfers(7);
  writing(slow, progress_, cancel_);
  EXPECT_EQ(contents(kStream), before);
  reconstructing(slow, progress_, cancel_);
  const std::string mesh = files_.content(kOutput);
  reconstructing(files_, progress_, cancel_);
  EXPECT_TRUE(files_.content(kOutput) == mesh);
}

TEST_F(StreamFaultsTest, AFullDiskLeavesNothing) {
  const Contents stream = contents(kStream);
  for (const Job& job : {Job(writing), Job(reconstructing)}) {
    FaultyFileSystem measuring(borrowed());
    job(measuring, progress_, cancel_);
    const std::uint64_t written = measuring.counters().bytes_written;
    ASSERT_GT(written, 500U);
    files_.put(kOutput, "old");
    for (std::uint64_t room = 0; room < written; room += 1 + written / 40) {
      for (const bool is_told : {false, true}) {
        SCOPED_TRACE(room);
        FaultyFileSystem full(borrowed());
        is_told ? full.limit_room(room) : full.limit_writes(room);
        const std::optional<Error> error = error_of([&] { job(full, progress_, cancel_); });
        ASSERT_TRUE(error);
        EXPECT_TRUE(error->code() == ErrorCode::io ||
                    (is_told && error->code() == ErrorCode::budget));
        EXPECT_TRUE(contents(kStream) == stream);
        EXPECT_EQ(files_.content(kOutput), "old");
        EXPECT_THAT(litter(), IsEmpty());
      }
    }
  }
}

TEST_F(StreamFaultsTest, AnInterruptionAtAnyTimeLeavesNothing) {
  const Contents stream = contents(kStream);
  for (const Job& job : {Job(writing), Job(reconstructing)}) {
    int interruptions = 0;
    for (std::uint64_t after = 1; after < 200; ++after) {
      files_.put(kOutput, "old");
      execution::CancelToken cancel;
      tests::Interrupter interrupter(cancel, after);
      const std::optional<Error> error = error_of([&] { job(files_, interrupter, cancel); });
      if (!error)
        continue;  // it was done by then
      ++interruptions;
      EXPECT_EQ(error->code(), ErrorCode::interrupted);
      EXPECT_TRUE(contents(kStream) == stream);
      EXPECT_EQ(files_.content(kOutput), "old");
      EXPECT_THAT(litter(), IsEmpty());
    }
    EXPECT_GE(interruptions, 2);
  }
}

TEST_F(StreamFaultsTest, WhatAKilledRunLeftIsCleared) {
  const Contents stream = contents(kStream);
  const fs::path work = storage::work_path(kStream);
  files_.put(work / "lists", "half a list");
  files_.put(storage::built_path(work) / "detail_07.bin", "old");
  writing(files_, progress_, cancel_);
  EXPECT_EQ(contents(kStream), stream);
  EXPECT_THAT(litter(), IsEmpty());
}

}  // namespace
}  // namespace meshhier::pipeline
