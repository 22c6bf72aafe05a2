// Promise 7: whatever happens to the files of a finished hierarchy, verify finds it and names the
// file; inspect and export tell an error or, where they do not read what is damaged, what they
// always tell.
#include "base/error.h"
#include "bench/generator.h"
#include "config/config.h"
#include "export/export.h"
#include "inspection/inspect.h"
#include "pipeline/build.h"
#include "storage/format/layout.h"
#include "tests/support/memory_files.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/share.h"
#include "verify/verify.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
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
using testing::HasSubstr;
using testing::IsEmpty;
using Bytes = tests::MemoryFiles::Bytes;

struct Victim {
  const char* name;
  bench::SurfaceOptions surface;
};

bench::SurfaceOptions small_surface(std::uint64_t seed) {
  bench::SurfaceOptions options;
  options.triangles = 100;
  options.noise = 0.5;
  options.seed = seed;
  return options;
}

Victim with_attributes() {
  bench::SurfaceOptions options = small_surface(1);
  options.normals = options.colours = options.alpha = true;
  return {"Attributes", options};
}

Victim in_double_precision() {
  bench::SurfaceOptions options = small_surface(2);
  options.double_coordinates = true;
  options.offset = {500123.4567, 5812345.6789, 100.125};
  return {"DoublePrecision", options};
}

/// The outcome of a command: it told something, or failed with an Error. Anything else is a failure
/// of the test.
struct Outcome {
  std::optional<ErrorCode> code;
  std::string text;  ///< the output, or the error
};

Outcome outcome_of(const std::function<std::string()>& command) {
  try {
    return {std::nullopt, command()};
  } catch (const Error& error) {
    return {error.code(), error.what()};
  } catch (const std::exception& other) {
    ADD_FAILURE() << "not an Error: " << other.what();
    return {ErrorCode::internal, other.what()};
  }
}

class CorruptionTest : public testing::TestWithParam<Victim> {
 protected:
  static constexpr const char* kDirectory = "/models/mesh.hier";
  static constexpr const char* kExported = "/models/out.ply";

  void SetUp() override { begin(); }

  void begin() {
    build(GetParam().surface, kDirectory);
    paths_ = files_.list(kDirectory);
    ASSERT_GE(paths_.size(), 10U);
    ASSERT_EQ(complaint(), "");
    for (const auto& [name, command] : commands_)
      expected_[name] = outcome_of(command).text;
  }

  /// To look at a preview takes longer than all else together.
  void begin_without_preview() {
    files_.remove_all(kDirectory);
    preview_ = false;
    begin();
  }

  void TearDown() override { RecordProperty("damages", std::to_string(damages_)); }

  void build(const bench::SurfaceOptions& surface, const fs::path& to) {
    config::Config config = tests::smooth_config();
    config.input = "/models/mesh.ply";
    config.output = to;
    config.threads = 1;
    config.preview = preview_;
    config.partition.count = 5;  // with early nodes
    config.simplify.vertices = 12;
    bench::write_ply(files_, {config.input.front(), true}, *bench::make_surface(surface));
    pipeline::build_hierarchy(config, {}, {files_, progress_, cancel_});
  }

  /// Returns the problems that verify finds in the hierarchy; empty if there are none.
  std::string complaint() {
    verifying::VerifyOptions options;
    options.cuts = 0;
    std::string all;
    const Outcome outcome = outcome_of([&] {
      for (const std::string& problem :
           verifying::verify_hierarchy(files_, kDirectory, options, progress_, cancel_).problems)
        all += problem + "\n";
      return all;
    });
    return outcome.text;
  }

  std::string export_of(const exporting::ExportSelection& selection) {
    const std::string summary = exporting::export_mesh(
        files_, kDirectory, {.selection = selection, .output = kExported, .replace = true},
        progress_, cancel_);
    const Bytes& bytes = files_.bytes(kExported);
    return summary + std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }

  static std::string relative(const fs::path& path) {
    return path.lexically_relative(kDirectory).string();
  }

  /// After something was done to the files: one of `names` is named, and no command tells anything
  /// wrong.
  void expect_noticed(const std::vector<std::string>& names, bool with_commands = true) {
    ++damages_;
    const std::string found = complaint();
    EXPECT_TRUE(std::any_of(names.begin(), names.end(),
                            [&](const auto& name) { return found.find(name) != found.npos; }))
        << "verify told: " << (found.empty() ? "nothing" : found);
    if (!with_commands)
      return;
    for (const auto& [name, command] : commands_) {
      files_.remove_all(kExported);
      const Outcome outcome = outcome_of(command);
      if (outcome.code) {
        EXPECT_TRUE(outcome.code == ErrorCode::corrupt || outcome.code == ErrorCode::io)
            << name << ": " << outcome.text;
        EXPECT_FALSE(files_.exists(kExported)) << name;
      } else {
        EXPECT_EQ(outcome.text, expected_[name]) << name;
      }
    }
  }

  /// How far apart the damages to a file are.
  struct Strides {
    std::size_t small = 1;  ///< manifest, index, outline
    std::size_t close = 1;  ///< the root, a tile between, a partition
    std::size_t rest = 1;
  };

  /// Calls damage(bytes, at) for positions of each file.
  template <class Damage>
  void damage_each(const Strides& strides, const Damage& damage) {
    for (const fs::path& path : paths_)
      damage_file(path, stride_of(path, strides), damage);
    EXPECT_EQ(complaint(), "");
  }

  template <class Damage>
  void damage_file(const fs::path& path, std::size_t stride, const Damage& damage) {
    SCOPED_TRACE(relative(path));
    const Bytes whole = files_.bytes(path);
    ASSERT_FALSE(whole.empty());
    const tests::Share share = tests::share().of((whole.size() + stride - 1) / stride);
    for (std::size_t at = share.index * stride; at < whole.size() && !HasFailure();
         at += share.count * stride) {
      SCOPED_TRACE(fmt::format("at byte {} of {}", at, whole.size()));
      damage(files_.bytes(path), at);
      expect_noticed({relative(path)}, at / stride / share.count % 64 == 0);
      files_.bytes(path) = whole;
    }
  }

  static std::size_t stride_of(const fs::path& path, const Strides& strides) {
    const std::string name = relative(path);
    if (!name.starts_with("tiles/"))
      return strides.small;
    const bool is_close = name == "tiles/00/000000.glb" || name == "tiles/01/000000.glb" ||
                          name == "tiles/03/000004.glb";
    return is_close ? strides.close : strides.rest;
  }

  bool preview_ = true;
  tests::MemoryFiles files_;
  execution::NoProgress progress_;
  execution::CancelToken cancel_;
  std::vector<fs::path> paths_;
  std::map<std::string, std::function<std::string()>> commands_ = {
      {"inspect", [this] { return inspection::inspect_text(files_, kDirectory, {}); }},
      {"inspect --json",
       [this] { return inspection::inspect_json(files_, kDirectory, {}).dump(); }},
      {"inspect --level 3",
       [this] {
         return inspection::inspect_text(files_, kDirectory, {static_cast<Level>(3), std::nullopt});
       }},
      {"export --level 0", [this] { return export_of(static_cast<Level>(0)); }},
      {"export --level 1", [this] { return export_of(static_cast<Level>(1)); }},
      {"export --level 2", [this] { return export_of(static_cast<Level>(2)); }},
      {"export --level 3", [this] { return export_of(static_cast<Level>(3)); }},
      {"export --node 2/1", [this] { return export_of(tests::node(2, 1)); }},
      {"export --outline", [this] { return export_of(exporting::OutlineSelection{}); }}};
  std::map<std::string, std::string> expected_;
  std::uint64_t damages_ = 0;
};

void flip_bit(Bytes& bytes, std::size_t at) {
  bytes[at] ^= std::byte{1} << (at % 8);
}

TEST_P(CorruptionTest, SANITIZED_AFlippedBitAtAnyByteIsFoundAndNamed) {
  begin_without_preview();
  damage_each({1, 1, 101}, flip_bit);
}

TEST_P(CorruptionTest, AnInvertedByteIsFoundAndNamed) {
  begin_without_preview();
  damage_each({5, 5, 103}, [](Bytes& bytes, std::size_t at) { bytes[at] = ~bytes[at]; });
}

TEST_P(CorruptionTest, SANITIZED_AnyTruncationIsFoundAndNamed) {
  begin_without_preview();
  damage_each({1, 7, 107}, [](Bytes& bytes, std::size_t at) { bytes.resize(at); });
}

TEST_P(CorruptionTest, ADamagedPreviewIsFoundAndNamed) {
  const fs::path preview = storage::preview_path(kDirectory);
  damage_file(preview, 17, flip_bit);
  damage_file(preview, 19, [](Bytes& bytes, std::size_t at) { bytes.resize(at); });
}

TEST_P(CorruptionTest, MoreBytesAreFoundAndNamed) {
  std::size_t number = 0;
  for (const fs::path& path : paths_) {
    SCOPED_TRACE(relative(path));
    const Bytes whole = files_.bytes(path);
    for (const std::size_t more : {1U, 4U, 1000U, 2U << 20}) {
      for (const std::byte value : {std::byte{0}, std::byte{' '}, std::byte{'\n'}}) {
        if (!tests::share().has(number++))
          continue;
        files_.bytes(path).resize(whole.size() + more, value);
        expect_noticed({relative(path)});
        files_.bytes(path) = whole;
      }
    }
  }
}

TEST_P(CorruptionTest, AMissingFileIsNamed) {
  for (const fs::path& path : paths_) {
    SCOPED_TRACE(relative(path));
    const Bytes whole = files_.bytes(path);
    files_.remove_all(path);
    expect_noticed({relative(path)});
    storage::write_file(files_, path, whole);
  }
}

TEST_P(CorruptionTest, ADirectoryInPlaceOfAFileIsNamed) {
  for (const fs::path& path : paths_) {
    SCOPED_TRACE(relative(path));
    const Bytes whole = files_.bytes(path);
    files_.remove_all(path);
    files_.make_directories(path);
    expect_noticed({relative(path)});
    files_.remove_all(path);
    storage::write_file(files_, path, whole);
  }
}

TEST_P(CorruptionTest, SwappedFilesAreNamed) {
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      Bytes &a = files_.bytes(paths_[i]), &b = files_.bytes(paths_[j]);
      if (a == b)
        continue;
      SCOPED_TRACE(relative(paths_[i]) + " and " + relative(paths_[j]));
      std::swap(a, b);
      expect_noticed({relative(paths_[i]), relative(paths_[j])});
      std::swap(a, b);
    }
  }
}

TEST_P(CorruptionTest, AFileOfAnotherHierarchyIsNamed) {
  bench::SurfaceOptions other = GetParam().surface;
  other.seed += 100;
  build(other, "/models/other.hier");
  for (const fs::path& path : paths_) {
    SCOPED_TRACE(relative(path));
    Bytes& ours = files_.bytes(path);
    Bytes& theirs = files_.bytes(fs::path("/models/other.hier") / relative(path));
    ASSERT_NE(ours, theirs);
    std::swap(ours, theirs);
    // A whole manifest is not damaged: it says that the index is another one.
    const bool is_manifest = path == storage::manifest_path(kDirectory);
    expect_noticed({is_manifest ? "tiles.bin" : relative(path)});
    std::swap(ours, theirs);
  }
}

INSTANTIATE_TEST_SUITE_P(Hierarchies, CorruptionTest,
                         testing::Values(with_attributes(), in_double_precision()),
                         [](const auto& victim) { return victim.param.name; });

}  // namespace
}  // namespace meshhier::pipeline
