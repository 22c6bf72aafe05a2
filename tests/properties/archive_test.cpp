// A hierarchy in one file: the same files, to the byte, and the same promises.
#include "base/error.h"
#include "bench/generator.h"
#include "export/export.h"
#include "inspection/inspect.h"
#include "pipeline/build.h"
#include "storage/format/archive_files.h"
#include "storage/io/hash.h"
#include "tests/support/error_message.h"
#include "tests/support/memory_files.h"
#include "tests/support/quick_config.h"
#include "tests/support/share.h"
#include "verify/verify.h"
#include "verify/verify_error.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using Bytes = tests::MemoryFiles::Bytes;

class PackedTest : public testing::Test {
 protected:
  static constexpr const char* kDirectory = "/models/mesh.hier";
  static constexpr const char* kArchive = "/models/mesh.3tz";

  PackedTest() {
    bench::SurfaceOptions surface;
    surface.triangles = 100;
    surface.noise = 0.5;
    bench::write_ply(files_, {"/models/mesh.ply", true}, *bench::make_surface(surface));
    config_.input = "/models/mesh.ply";
    config_.threads = 1;
    config_.partition.count = 5;
    config_.simplify.vertices = 12;
  }

  pipeline::BuildReport build(const fs::path& output, config::Container container,
                              bool force = false) {
    config_.output = output;
    config_.storage.container = container;
    return pipeline::build_hierarchy(config_, {.force = force}, {files_, progress_, cancel_});
  }

  /// Returns the problems that verify finds in the archive; empty if there are none.
  std::string complaint(verifying::VerifyOptions options = {}) {
    std::string all;
    try {
      for (const auto& problem :
           verifying::verify_hierarchy(files_, kArchive, options, progress_, cancel_).problems)
        all += problem + '\n';
    } catch (const Error& error) {
      all += error.what();
    }
    return all;
  }

  /// The message of the error that `job` ends with.
  template <class Job>
  std::string refusal(ErrorCode code, const Job& job) {
    const std::string message = tests::error_message(code, job);
    EXPECT_NE(message, "") << "no error";
    return message;
  }

  tests::MemoryFiles files_;
  execution::NoProgress progress_;
  execution::CancelToken cancel_;
  config::Config config_ = tests::smooth_config();
};

TEST_F(PackedTest, HasTheFilesOfTheDirectory) {
  for (const config::Compression compression :
       {storage::Compression::none, storage::Compression::zlib, storage::Compression::meshopt,
        storage::Compression::meshopt_zlib}) {
    config_.storage.compression = compression;
    build(kDirectory, storage::Container::files, true);
    const pipeline::BuildReport report = build(kArchive, storage::Container::archive, true);
    EXPECT_EQ(report.stats.output_bytes, files_.bytes(kArchive).size());
    storage::ArchiveFiles inside(files_, kArchive);
    const auto found = inside.list(kArchive);
    const auto expected = files_.list(kDirectory);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].lexically_relative(kArchive), expected[i].lexically_relative(kDirectory));
      EXPECT_EQ(storage::read_file(inside, found[i], 1U << 20), files_.bytes(expected[i]));
    }
    verifying::VerifyOptions options;
    options.input = config_.input;
    EXPECT_EQ(complaint(options), "");
  }
}

TEST_F(PackedTest, IsTheSameForAnyThreadsAndBudget) {
  config_.partition.count = 20;
  build(kArchive, storage::Container::archive);
  const Bytes expected = files_.bytes(kArchive);
  for (const std::uint32_t threads : {1U, 3U}) {
    for (const std::uint64_t budget : {std::uint64_t{64} << 20, std::uint64_t{1} << 30}) {
      config_.threads = threads;
      config_.memory_budget = budget;
      build(kArchive, storage::Container::archive, true);
      EXPECT_EQ(files_.bytes(kArchive), expected) << threads << ", " << budget;
    }
  }
}

TEST_F(PackedTest, LeavesNothingBesideIt) {
  build(kArchive, storage::Container::archive);
  EXPECT_THAT(files_.list("/models"),
              testing::UnorderedElementsAre("/models/mesh.3tz", "/models/mesh.ply"));
}

TEST_F(PackedTest, IsReadByEveryCommandAsADirectoryIs) {
  build(kDirectory, storage::Container::files);
  build(kArchive, storage::Container::archive);
  const auto exported = [&](const fs::path& from, const exporting::ExportSelection& selection) {
    exporting::export_mesh(files_, from,
                           {.selection = selection, .output = "/models/out.ply", .replace = true},
                           progress_, cancel_);
    return files_.content("/models/out.ply");
  };
  files_.put("/models/cut.txt", "1/0\n3/3\n3/4\n");
  for (const exporting::ExportSelection& selection :
       {exporting::ExportSelection(Level{1}), exporting::ExportSelection(NodeId{Level{2}, 1}),
        exporting::ExportSelection(fs::path("/models/cut.txt")),
        exporting::ExportSelection(exporting::OutlineSelection{})})
    EXPECT_EQ(exported(kArchive, selection), exported(kDirectory, selection));

  auto inside = inspection::inspect_json(files_, kArchive, {});
  auto outside = inspection::inspect_json(files_, kDirectory, {});
  EXPECT_EQ(inside["total_bytes"], files_.bytes(kArchive).size());
  inside["total_bytes"] = outside["total_bytes"] = 0;
  EXPECT_EQ(inside, outside);
  EXPECT_THAT(inspection::inspect_text(files_, kArchive, {}), HasSubstr("mesh.3tz"));

  verifying::ErrorOptions options;
  options.samples = 1000;
  const auto a = verifying::measure_errors(files_, kArchive, options, progress_, cancel_);
  const auto b = verifying::measure_errors(files_, kDirectory, options, progress_, cancel_);
  EXPECT_EQ(to_json(a.front()), to_json(b.front()));
}

TEST_F(PackedTest, AFlippedBitAtAnyByteIsFoundByVerify) {
  config_.partition.count = 2;
  config_.preview = false;  // to look at it takes longer than all else together
  build(kArchive, storage::Container::archive);
  Bytes& bytes = files_.bytes(kArchive);
  verifying::VerifyOptions options;
  options.cuts = 0;
  ASSERT_EQ(complaint(options), "");
  for (std::size_t at = tests::share().index; at < bytes.size(); at += tests::share().count) {
    const std::byte bit = std::byte{1} << (at % 8);
    bytes[at] ^= bit;
    EXPECT_THAT(complaint(options), HasSubstr(kArchive)) << "at byte " << at;
    bytes[at] ^= bit;
  }
}

TEST_F(PackedTest, SANITIZED_ATruncatedOneIsOneErrorForEveryCommand) {
  build(kArchive, storage::Container::archive);
  const Bytes whole = files_.bytes(kArchive);
  for (std::size_t size = 4; size < whole.size(); size += 97) {
    files_.bytes(kArchive).resize(size);
    EXPECT_THAT(complaint(), HasSubstr("the file is cut or damaged")) << size;
    refusal(ErrorCode::corrupt, [&] { inspection::inspect_text(files_, kArchive, {}); });
    refusal(ErrorCode::corrupt, [&] {
      exporting::export_mesh(files_, kArchive,
                             {.selection = Level{0}, .output = "/models/out.ply", .replace = true},
                             progress_, cancel_);
    });
    EXPECT_FALSE(files_.exists("/models/out.ply"));
    files_.bytes(kArchive) = whole;
  }
}

TEST_F(PackedTest, AFileThatIsNoArchiveIsNoHierarchy) {
  const char* const said = "/models/mesh.ply: not a hierarchy: neither a directory nor a 3tz";
  EXPECT_THAT(
      refusal(ErrorCode::io, [&] { inspection::inspect_text(files_, "/models/mesh.ply", {}); }),
      HasSubstr(said));
  EXPECT_THAT(
      refusal(
          ErrorCode::io,
          [&] { verifying::verify_hierarchy(files_, "/models/mesh.ply", {}, progress_, cancel_); }),
      HasSubstr(said));
}

TEST_F(PackedTest, ReplacesAnArchiveOfAHierarchyAndNothingElse) {
  build(kArchive, storage::Container::archive);
  const Bytes first = files_.bytes(kArchive);
  EXPECT_THAT(refusal(ErrorCode::exists, [&] { build(kArchive, storage::Container::archive); }),
              HasSubstr("is already there; --force replaces it"));
  EXPECT_THAT(refusal(ErrorCode::exists, [&] { build(kArchive, storage::Container::files, true); }),
              HasSubstr("is a file, and a directory is to be made"));
  config_.simplify.vertices = 10;
  build(kArchive, storage::Container::archive, true);
  EXPECT_NE(files_.bytes(kArchive), first);

  build(kDirectory, storage::Container::files);
  EXPECT_THAT(
      refusal(ErrorCode::exists, [&] { build(kDirectory, storage::Container::archive, true); }),
      HasSubstr("is a directory, and one file is to be made"));
  files_.put("/models/notes.txt", "mine");
  EXPECT_THAT(refusal(ErrorCode::exists,
                      [&] { build("/models/notes.txt", storage::Container::archive, true); }),
              HasSubstr("is not the archive of a hierarchy, and is never replaced: move it away"));
  EXPECT_EQ(files_.content("/models/notes.txt"), "mine");
}

}  // namespace
}  // namespace meshhier::pipeline
