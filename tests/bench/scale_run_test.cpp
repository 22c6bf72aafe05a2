#include "bench/scale_run.h"

#include "bench/child_process.h"
#include "hierarchy/error.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/sizes.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::bench {
namespace {

using testing::Contains;
using testing::HasSubstr;
using tests::kMiB;

class ScaleRunTest : public testing::Test {
 protected:
  ScaleOptions options() const {
    ScaleOptions options;
    options.meshhier = MESHHIER_BINARY;
    options.meshgen = MESHGEN_BINARY;
    options.work = directory_.path();
    options.smallest = 2000;
    options.largest = 10'000;
    options.threads = {1, 2};
    options.budgets = {128 * kMiB, 256 * kMiB};
    return options;
  }
  ScaleReport run(const ScaleOptions& options) {
    return run_scale(*files_, options, [this](std::string_view line) { told_.emplace_back(line); });
  }
  ErrorCode failure(const ScaleOptions& options) {
    try {
      run(options);
    } catch (const Error& error) {
      return error.code();
    }
    ADD_FAILURE() << "nothing failed";
    return ErrorCode::internal;
  }
  bool is_clean() const { return std::filesystem::is_empty(directory_.path()); }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  std::vector<std::string> told_;
};

TEST_F(ScaleRunTest, MeasuresEverySettingOnceAndRemovesAllItMade) {
  const ScaleReport report = run(options());
  EXPECT_TRUE(is_clean());
  const auto count = [&](auto&& is) { return std::ranges::count_if(report.measurements, is); };
  // Two sizes with two budgets and in random order; at the larger one also one thread and
  // `cluster`.
  EXPECT_EQ(report.measurements.size(), 8U);
  EXPECT_EQ(count([](const auto& m) { return m.setting.shuffled; }), 2);
  EXPECT_EQ(count([](const auto& m) { return m.setting.threads == 1; }), 1);
  EXPECT_EQ(count([](const auto& m) { return m.setting.method == "cluster"; }), 1);
  EXPECT_EQ(count([](const auto& m) { return m.setting.budget_bytes == 256 * kMiB; }), 2);
  for (const ScaleMeasurement& m : report.measurements) {
    EXPECT_GT(m.wall_seconds, 0);
    EXPECT_GT(m.copy_seconds, 0);
    EXPECT_GT(m.system_peak_bytes, kMiB);
    EXPECT_GT(m.output_bytes, m.setting.triangles * 12);
    EXPECT_FALSE(m.stages.empty());
  }
  ASSERT_EQ(report.compute.size(), 1U);
  EXPECT_GT(report.compute[0].gain, 0);
  EXPECT_THAT(scale_tables(report), HasSubstr("### Threads"));
}

TEST_F(ScaleRunTest, WhatTheBudgetDoesNotAllowIsLeftOut) {
  ScaleOptions small = options();
  small.threads = {1};
  small.largest = 4000;
  small.budgets = {128 * kMiB, kMiB};
  const ScaleReport report = run(small);
  for (const ScaleMeasurement& m : report.measurements)
    EXPECT_EQ(m.setting.budget_bytes, 128 * kMiB);
  EXPECT_FALSE(report.measurements.empty());
  EXPECT_THAT(told_, Contains(HasSubstr("at least")));
}

TEST_F(ScaleRunTest, FailuresEndItAndLeaveNothing) {
  ScaleOptions broken = options();
  broken.threads = {1};
  broken.meshgen = "/bin/false";
  EXPECT_EQ(failure(broken), ErrorCode::input);
  broken.meshgen = "/absent";
  EXPECT_NE(failure(broken), ErrorCode::internal);
  ScaleOptions none = options();
  none.threads = {1};
  none.largest = 10;
  EXPECT_EQ(failure(none), ErrorCode::usage);
  EXPECT_TRUE(is_clean());
}

TEST_F(ScaleRunTest, AChildIsMeasured) {
  const std::filesystem::path log = directory_.path() / "log";
  const ChildResult result = run_child({"/bin/sh", "-c", "echo said; exit 3"}, log);
  EXPECT_EQ(result.code, 3);
  EXPECT_GT(result.wall_seconds, 0);
  EXPECT_GT(result.peak_resident_bytes, 0U);
  EXPECT_EQ(std::filesystem::file_size(log), 5U);
  EXPECT_EQ(run_child({"/bin/sh", "-c", "kill -9 $$"}, log).code, 128 + 9);
}

}  // namespace
}  // namespace meshhier::bench
