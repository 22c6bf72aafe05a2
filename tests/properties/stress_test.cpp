// Meshes that are legal and unreasonable: each is built by every method and keeps all promises, or
// is refused with a reason.
#include "bench/stress.h"

#include "base/error.h"
#include "config/config.h"
#include "inspection/inspect.h"
#include "pipeline/build.h"
#include "storage/format/hierarchy_reader.h"
#include "tests/support/memory_files.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/simplify_methods.h"
#include "tests/support/sizes.h"
#include "verify/verify.h"
#include "verify/verify_error.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

class StressTest : public testing::Test {
 protected:
  StressTest() {
    config_.input = "/models/mesh.ply";
    config_.output = "/models/mesh.hier";
    config_.threads = 2;
  }

  void write(bench::LoadedMesh mesh) {
    bench::write_ply(files_, {config_.input.front(), true}, *bench::as_generated(std::move(mesh)));
  }

  void use_tiles_of(std::uint32_t vertices) {
    config_.partition.vertices = vertices;
    config_.simplify.vertices = vertices;
  }

  void use_method(config::SimplifyConfig method) {
    method.vertices = config_.simplify.vertices;
    config_.simplify = method;
  }

  void build() {
    pipeline::build_hierarchy(config_, {.force = true}, {files_, progress_, cancel_});
  }

  std::vector<std::string> problems() {
    verifying::VerifyOptions options;
    options.input = config_.input;
    options.cuts = 5;
    return verifying::verify_hierarchy(files_, config_.output, options, progress_, cancel_)
        .problems;
  }

  void expect_sound() {
    ASSERT_NO_THROW(build());
    EXPECT_THAT(problems(), IsEmpty());
    EXPECT_NO_THROW(inspection::inspect_text(files_, config_.output, {}));
  }

  /// The error that a build is refused with.
  std::optional<Error> refusal() {
    try {
      build();
    } catch (const Error& error) {
      return error;
    }
    return std::nullopt;
  }

  tests::MemoryFiles files_;
  execution::NoProgress progress_;
  execution::CancelToken cancel_;
  config::Config config_ = tests::quick_config();
};

/// Every case there is.
class StressCaseTest : public StressTest, public testing::WithParamInterface<bench::StressCase> {
 protected:
  bench::LoadedMesh mesh(std::uint64_t size) const {
    return bench::make_stress(GetParam().name, size);
  }
};

TEST_P(StressCaseTest, IsSoundWhateverTheMethod) {
  write(mesh(2000));
  use_tiles_of(120);
  for (const auto& [name, method] : tests::all_simplify_methods()) {
    SCOPED_TRACE(name);
    use_method(method);
    expect_sound();
  }
}

TEST_P(StressCaseTest, SLOW_IsSoundInPartitionsOfFourVertices) {
  write(mesh(300));
  use_tiles_of(4);
  for (const auto& [name, method] : tests::all_simplify_methods()) {
    SCOPED_TRACE(name);
    use_method(method);
    expect_sound();
  }
}

TEST_P(StressCaseTest, SLOW_IsSoundInOnePartitionLargerThanTheMesh) {
  write(mesh(1000));
  use_tiles_of(32768);
  config_.memory_budget = 128 * tests::kMiB;  // tiles so large would take more
  config_.preview = true;
  expect_sound();
}

TEST_P(StressCaseTest, IsSoundHoweverSmall) {
  for (const std::uint64_t size : {0U, 1U, 2U, 3U, 5U, 8U}) {
    SCOPED_TRACE("size " + std::to_string(size));
    bench::LoadedMesh small = mesh(size);
    if (small.positions.empty())
      continue;
    write(std::move(small));
    use_tiles_of(4);
    expect_sound();
  }
}

TEST_P(StressCaseTest, SLOW_IsWithinItsBounds) {
  write(mesh(1000));
  use_tiles_of(100);
  for (const auto& [name, method] : tests::all_simplify_methods()) {
    SCOPED_TRACE(name);
    use_method(method);
    ASSERT_NO_THROW(build());
    const verifying::ErrorOptions options{verifying::AllLevels{}, 2000, memory_budget(config_)};
    for (const verifying::ErrorMeasurement& level :
         verifying::measure_errors(files_, config_.output, options, progress_, cancel_)) {
      if (level.triangles == 0)
        continue;  // cells that hold the edge of the book close it
      EXPECT_THAT(level.problems, IsEmpty()) << level.name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, StressCaseTest, testing::ValuesIn(bench::stress_cases()),
                         [](const auto& stress) {
                           std::string name(stress.param.name);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

bench::LoadedMesh loose_vertices(std::size_t count) {
  bench::LoadedMesh mesh;
  for (std::size_t i = 0; i < count; ++i)
    mesh.positions.push_back({static_cast<double>(i), static_cast<double>(i * i), 1});
  return mesh;
}

TEST_F(StressTest, NoVerticesAreRefusedAsAnInputError) {
  write(loose_vertices(0));
  const auto error = refusal();
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::input);
  EXPECT_THAT(error->what(), HasSubstr("has no vertices"));
  EXPECT_FALSE(files_.exists(config_.output));
}

TEST_F(StressTest, OneTwoAndThreeVerticesAreSound) {
  for (const std::size_t count : {1U, 2U, 3U}) {
    for (const std::uint32_t partitions : {1U, 2U, 3U}) {
      if (partitions > count)
        continue;
      SCOPED_TRACE(std::to_string(count) + " vertices, " + std::to_string(partitions));
      config_.partition.count = partitions;
      bench::LoadedMesh mesh = loose_vertices(count);
      write(mesh);
      expect_sound();
      const auto last = static_cast<std::uint32_t>(count - 1);
      mesh.triangles = {{0, last / 2, last}};  // degenerate with one or two vertices
      write(mesh);
      expect_sound();
    }
  }
}

TEST_F(StressTest, MorePartitionsThanVerticesAreRefusedAsAUsageError) {
  write(loose_vertices(3));
  config_.partition.count = 4;
  const auto error = refusal();
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::usage);
  EXPECT_THAT(error->what(), HasSubstr("has only 3 vertices"));
}

TEST_F(StressTest, DistancesBeyondSinglePrecisionAreRefusedAsAnInputError) {
  bench::LoadedMesh mesh = bench::make_stress("huge", 300);
  for (Vec3d& p : mesh.positions)
    p = p * 1.5e8;
  write(mesh);
  use_tiles_of(4);
  const auto error = refusal();
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::input);
  EXPECT_THAT(error->what(), HasSubstr("expected a coordinate from -8.5e37 to 8.5e37 (2^126)"));
  EXPECT_FALSE(files_.exists(config_.output));
  for (Vec3d& p : mesh.positions)
    p = Vec3d{0x1p126, -0x1p126, 0x1p126};
  write(mesh);
  expect_sound();
}

TEST_F(StressTest, AnOutlierFarBeyondSinglePrecisionIsRefusedAsAnInputError) {
  bench::LoadedMesh mesh = loose_vertices(20);
  mesh.double_coordinates = true;
  mesh.positions[7].y = -1e300;
  write(mesh);
  const auto error = refusal();
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::input);
  EXPECT_THAT(error->what(), HasSubstr("in row 7 of 20 of element 'vertex', found -1e+300"));
}

/// All positions of all tiles, times a factor.
std::vector<Vec3d> scaled_positions(storage::FileSystem& files, const fs::path& directory,
                                    double factor) {
  const storage::HierarchyReader reader(files, directory);
  std::vector<Vec3d> positions;
  for (const TileRecord& record : reader.records()) {
    for (const Vec3f p : reader.read_tile(record.node).mesh.vertices.positions)
      positions.push_back(to_double(p) * factor);
  }
  return positions;
}

TEST_F(StressTest, TheUnitOfLengthDoesNotMatter) {
  const bench::LoadedMesh mesh = bench::make_stress("mirrored", 3000);
  use_tiles_of(120);
  for (const auto& [name, method] : tests::all_simplify_methods()) {
    SCOPED_TRACE(name);
    use_method(method);
    write(mesh);
    build();
    const std::vector<Vec3d> expected = scaled_positions(files_, config_.output, 1);
    for (const int exponent : {-99, 99}) {
      SCOPED_TRACE("times 2^" + std::to_string(exponent));
      bench::LoadedMesh scaled = mesh;
      for (Vec3d& p : scaled.positions)
        p = p * std::ldexp(1.0, exponent);
      write(scaled);
      build();
      EXPECT_EQ(scaled_positions(files_, config_.output, std::ldexp(1.0, -exponent)), expected);
    }
  }
}

}  // namespace
}  // namespace meshhier::pipeline
