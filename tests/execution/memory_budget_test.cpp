#include "execution/memory_budget.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::execution {
namespace {

using storage::MemoryBound;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint64_t kTestMiB = std::uint64_t{1} << 20;

TEST(MemoryBudgetTest, LeavesAQuarterToWhatNoBudgetCounts) {
  EXPECT_EQ(most_budget({1024 * kTestMiB}), 768 * kTestMiB);
  EXPECT_EQ(most_budget({5 * kTestMiB + 1}), 3 * kTestMiB);
  EXPECT_EQ(most_budget({0}), kTestMiB) << "a budget is never nothing";
  EXPECT_EQ(most_budget({UINT64_MAX}) % kTestMiB, 0U);
}

TEST(MemoryBudgetTest, IsAQuarterByDefaultWithinItsLimits) {
  EXPECT_EQ(default_budget({8192 * kTestMiB}), 2048 * kTestMiB);
  EXPECT_EQ(default_budget({24107 * kTestMiB + 4095}), 6026 * kTestMiB) << "whole MiB";
  EXPECT_EQ(default_budget({1024 * kTestMiB}), 512 * kTestMiB);
  EXPECT_EQ(default_budget({600 * kTestMiB}), 450 * kTestMiB) << "three quarters of what there is";
  EXPECT_EQ(default_budget({UINT64_MAX}), 16384 * kTestMiB);
}

TEST(MemoryBudgetTest, WarnsBeyondTheLimitWithWhatToSet) {
  EXPECT_THAT(budget_warning("memory_budget", 512 * kTestMiB, {512 * kTestMiB}), IsEmpty());
  EXPECT_THAT(budget_warning("memory_budget", 512 * kTestMiB + 1,
                             {512 * kTestMiB, MemoryBound::address_space}),
              AllOf(HasSubstr("memory_budget"), HasSubstr("512"), HasSubstr("ulimit -v"),
                    HasSubstr("at most 384MiB")));
  EXPECT_THAT(budget_warning("--memory-budget", 2 * kTestMiB, {kTestMiB, MemoryBound::group}),
              AllOf(HasSubstr("--memory-budget 2MiB"), HasSubstr("control group")));
}

}  // namespace
}  // namespace meshhier::execution
