#include "bench/scale_tables.h"

#include "hierarchy/error.h"
#include "tests/support/sizes.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::bench {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using tests::kMiB;

constexpr const char* kStats = R"({
  "triangles": 1000000, "input_bytes": 20000000, "output_bytes": 30000000,
  "predicted_output_bytes": 33000000, "peak_temporary_bytes": 40000000,
  "predicted_temporary_bytes": 44000000, "moved_bytes": 150000000,
  "stages": [{"name": "ingest", "wall_seconds": 0.5, "cpu_seconds": 0.75},
             {"name": "simplify", "wall_seconds": 1.5, "cpu_seconds": 2.25}],
  "total": {"wall_seconds": 2.0, "cpu_seconds": 3.0, "peak_resident_bytes": 67108864}
})";

ScaleSetting usual() {
  return {1'000'000, false, "edge_collapse", 2, 128 * kMiB};
}

ScaleReport report_of(const std::vector<ScaleSetting>& settings) {
  ScaleReport report{"a torus", {}, {{2, 1.9}}, usual()};
  for (const ScaleSetting& setting : settings)
    report.measurements.push_back(parse_stats(kStats, setting));
  return report;
}

TEST(ScaleTablesTest, AnAccountIsReadWhole) {
  const ScaleMeasurement m = parse_stats(kStats, usual());
  EXPECT_EQ(m.setting, usual());
  EXPECT_EQ(m.wall_seconds, 2);
  EXPECT_EQ(m.cpu_seconds, 3);
  EXPECT_EQ(m.floor_bytes(), 50'000'000U);
  EXPECT_EQ(m.peak_bytes, 64 * kMiB);
  ASSERT_EQ(m.stages.size(), 2U);
  EXPECT_EQ(m.stages[1].name, "simplify");
  EXPECT_EQ(m.stages[1].cpu_seconds, 2.25);
}

TEST(ScaleTablesTest, WhatIsNoAccountIsRefused) {
  for (const char* text : {"", "[]", "{}", R"({"triangles": "many"})"}) {
    try {
      parse_stats(text, usual());
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
    }
  }
}

TEST(ScaleTablesTest, SizesAreInOrderWithTheirFigures) {
  ScaleSetting larger = usual();
  larger.triangles = 4'000'000;
  const std::string text = scale_tables(report_of({larger, usual()}));
  EXPECT_THAT(text, HasSubstr("### Sizes (edge_collapse, 128MiB, 2 threads)"));
  EXPECT_THAT(text, HasSubstr("| 1.00 M | 2.00 | 3.00 | 3.000 | 0.50 | 64.0 MiB | 0.50 | 3.00 |"));
  EXPECT_THAT(text, HasSubstr("| 4.00 M | 2.00 | 3.00 | 0.750 | 2.00 |"));
  EXPECT_LT(text.find("| 1.00 M"), text.find("| 4.00 M"));
  EXPECT_THAT(text, AllOf(Not(HasSubstr("### Budgets")), Not(HasSubstr("### Threads")),
                          Not(HasSubstr("### Methods")), Not(HasSubstr("### Order"))));
}

TEST(ScaleTablesTest, TheLargerOfTwoPeaksIsShown) {
  ScaleReport report = report_of({usual()});
  report.measurements[0].system_peak_bytes = 96 * kMiB;
  EXPECT_THAT(scale_tables(report), HasSubstr("| 96.0 MiB | 0.75 |"));
}

TEST(ScaleTablesTest, BudgetsShowTheDiskAndItsPrediction) {
  ScaleSetting more = usual();
  more.budget_bytes = 256 * kMiB;
  const std::string text = scale_tables(report_of({usual(), more}));
  EXPECT_THAT(text, HasSubstr("| 1.00 M | 128MiB | 2.00 | 3.00 | 64.0 MiB | 0.50 | 3.00 | 38.1 MiB "
                              "| 0.80 | 1.10 |"));
  EXPECT_THAT(text, HasSubstr("| 1.00 M | 256MiB | 2.00 | 3.00 | 64.0 MiB | 0.25 |"));
}

TEST(ScaleTablesTest, ThreadsShowTheGainOfEachStageAndOfTheLoop) {
  ScaleSetting one = usual();
  one.threads = 1;
  ScaleReport report = report_of({usual(), one});
  report.measurements[1].wall_seconds = 3.6;
  report.measurements[1].stages[1].wall_seconds = 3;
  const std::string text = scale_tables(report);
  EXPECT_THAT(text, HasSubstr("| simplify | 3.00 | 1.50 | 2.00 |"));
  EXPECT_THAT(text, HasSubstr("| **whole build** | 3.60 | 2.00 | 1.80 |"));
  EXPECT_THAT(text, HasSubstr("| a loop that only computes | | | 1.90 |"));
}

TEST(ScaleTablesTest, MethodsAndOrdersAreComparedAtTheSameSize) {
  ScaleSetting clustered = usual();
  clustered.method = "cluster";
  ScaleSetting shuffled = usual();
  shuffled.shuffled = true;
  ScaleSetting alone = shuffled;
  alone.triangles = 4'000'000;
  ScaleReport report = report_of({usual(), clustered, shuffled, alone});
  report.measurements[1].wall_seconds = 0.5;
  report.measurements[2].wall_seconds = 2.5;
  const std::string text = scale_tables(report);
  EXPECT_THAT(text, HasSubstr("| cluster | 0.50 | 3.00 | 3.000 | 2.00 | 0.25 |"));
  EXPECT_THAT(text, HasSubstr("| 1.00 M | random | 2.50 | 3.00 | 3.000 | 0.50 | 3.00 | 1.25 |"));
  EXPECT_THAT(text, HasSubstr("| 4.00 M | random | 2.00 | 3.00 | 0.750 | 0.50 | 3.00 | - |"));
}

}  // namespace
}  // namespace meshhier::bench
