#include "bench/comparison.h"

#include "hierarchy/error.h"
#include "tests/bench/plain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::bench {
namespace {

using testing::HasSubstr;

ComparisonOptions quick() {
  return {.parts = 16, .cell_vertices = 10, .kmeans_iterations = 20, .samples = 2000};
}

const Comparison& torus_comparison() {
  static const Comparison comparison = [] {
    const auto files = storage::make_posix_file_system();
    return compare(plain(tests::torus(8000, 0.01F)), quick(), *files);
  }();
  return comparison;
}

TEST(ComparisonTest, EveryWayIsMeasured) {
  const Comparison& result = torus_comparison();
  ASSERT_EQ(result.partitions.size(), 4U);
  for (const PartitionRow& row : result.partitions) {
    EXPECT_GE(row.figures.count, 15U) << row.name;
    EXPECT_LE(row.figures.count, 22U) << row.name;
    EXPECT_GT(row.figures.mean_compactness, 1) << row.name;
    EXPECT_LT(row.figures.mean_compactness, 20) << row.name;
    EXPECT_GE(row.cpu_seconds, 0) << row.name;
  }
  EXPECT_LE(result.partitions[0].figures.most_vertices,
            result.partitions[0].figures.least_vertices + 1);
  EXPECT_GT(result.partitions[2].figures.most_vertices,
            result.partitions[2].figures.least_vertices + 1);
}

TEST(ComparisonTest, SimplificationsHaveEquallyManyVertices) {
  const Comparison& result = torus_comparison();
  ASSERT_EQ(result.simplifications.size(), 6U);
  for (const SimplificationRow& row : result.simplifications) {
    EXPECT_EQ(row.vertices, result.simplifications[0].vertices);
    EXPECT_NEAR(static_cast<double>(row.vertices), static_cast<double>(result.vertices) / 10, 7);
    for (const Distances& d : {row.forward, row.backward}) {
      EXPECT_GT(d.mean, 0);
      EXPECT_LE(d.mean, d.rms);
      EXPECT_LE(d.rms, d.max);
      EXPECT_LT(d.max, result.diagonal / 10);
    }
  }
}

TEST(ComparisonTest, TheLeastQuadricErrorIsNearerToTheSurface) {
  const auto& rows = torus_comparison().simplifications;
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_EQ(rows[i].cells, rows[i + 3].cells);
    EXPECT_LT(rows[i + 3].forward.mean, rows[i].forward.mean) << rows[i].cells;
  }
}

TEST(ComparisonTest, TablesAreMarkdown) {
  const std::string text = markdown("torus", torus_comparison());
  EXPECT_THAT(text, HasSubstr("### torus: 4,107 vertices, 8,214 triangles\n"));
  EXPECT_THAT(text, HasSubstr("\n| octree | "));
  EXPECT_THAT(text, HasSubstr("\n| kd-tree, longest axis | least quadric error | "));
  // Rows of one table have equally many columns.
  std::size_t columns = 0;
  for (std::size_t begin = 0, end = 0; begin < text.size(); begin = end + 1) {
    end = text.find('\n', begin);
    const std::string line = text.substr(begin, end - begin);
    const auto bars = static_cast<std::size_t>(std::ranges::count(line, '|'));
    if (bars > 0 && columns > 0) {
      EXPECT_EQ(bars, columns) << line;
    }
    columns = bars;
  }
}

TEST(ComparisonTest, AMeshThatIsTooSmallIsRefused) {
  const auto files = storage::make_posix_file_system();
  ComparisonOptions options = quick();
  const auto code_for = [&](const PlainMesh& mesh) {
    try {
      compare(mesh, options, *files);
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode::internal;
  };
  EXPECT_EQ(code_for(plain(tests::points(10))), ErrorCode::usage);
  EXPECT_EQ(code_for(plain(tests::points(1000))), ErrorCode::input);
  options.cell_vertices = 1000;  // one cell, no triangle
  EXPECT_EQ(code_for(plain(tests::open_grid(9, 9))), ErrorCode::input);
}

}  // namespace
}  // namespace meshhier::bench
