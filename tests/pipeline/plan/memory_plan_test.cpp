#include "pipeline/plan/memory_plan.h"

#include "base/error.h"
#include "execution/size_text.h"
#include "pipeline/stage_costs.h"
#include "tests/support/sizes.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

using testing::HasSubstr;
using tests::kGiB;
using tests::kMiB;

JobSize job_of(std::uint64_t vertices, std::uint32_t tile, int channels, std::size_t threads) {
  JobSize job;
  job.vertex_count = vertices;
  job.place_count = job.vertex_count;
  job.face_count = 2 * vertices;
  job.channels = channels;
  job.partition_count = static_cast<std::uint32_t>((vertices + tile - 1) / tile);
  job.largest_tile = tile;
  job.threads = threads;
  return job;
}

std::vector<JobSize> jobs() {
  std::vector<JobSize> result;
  for (const std::uint64_t vertices :
       {std::uint64_t{1}, std::uint64_t{1000}, std::uint64_t{1'000'000}, std::uint64_t{500'000'000},
        std::uint64_t{4'294'967'295}}) {
    for (const std::uint32_t tile : {4U, 8192U, 32768U}) {
      for (const int channels : {0, 9}) {
        for (const std::size_t threads : {1U, 2U, 64U})
          result.push_back(job_of(vertices, tile, channels, threads));
      }
    }
  }
  return result;
}

std::string text_of(const JobSize& job) {
  return std::to_string(job.vertex_count) + " vertices, tiles of " +
         std::to_string(job.largest_tile) + ", " + std::to_string(job.channels) + " channels, " +
         std::to_string(job.threads) + " threads";
}

/// Returns the message that refuses a budget, if it is refused.
std::optional<std::string> refusal(std::uint64_t budget, const JobSize& job) {
  try {
    plan_memory(budget, memory_costs(job));
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::budget);
    return error.what();
  }
  return std::nullopt;
}

/// The least budget that a refusal names.
std::uint64_t named_budget(const JobSize& job) {
  const std::string message = refusal(1, job).value_or("");
  const std::string before = "at least ";
  const std::size_t at = message.find(before);
  EXPECT_NE(at, std::string::npos) << message;
  return execution::parse_size(message.substr(at + before.size())).value_or(0);
}

TEST(MemoryPlanTest, ARefusalNamesBothTheBudgetAndTheLeast) {
  const std::string message = refusal(kMiB, job_of(1'000'000, 8192, 0, 2)).value_or("");
  EXPECT_THAT(message, HasSubstr("memory_budget 1MiB"));
  EXPECT_THAT(message, HasSubstr("at least "));
}

TEST(MemoryPlanTest, TheLeastThatIsNamedIsEnoughAndHardlyMoreThanNeeded) {
  for (const JobSize& job : jobs()) {
    const std::uint64_t least = named_budget(job);
    ASSERT_GT(least, 0U);
    EXPECT_EQ(refusal(least, job), std::nullopt) << text_of(job);
    EXPECT_NE(refusal(least - kMiB, job), std::nullopt) << text_of(job);
  }
}

TEST(MemoryPlanTest, TheLeastBudgetIsTheOneThatARefusalNames) {
  for (const JobSize& job : jobs())
    EXPECT_EQ(least_budget(memory_costs(job)), named_budget(job)) << text_of(job);
}

TEST(MemoryPlanTest, AMillionVerticesAreContentWith64MiB) {
  EXPECT_LE(named_budget(job_of(1'000'000, 8192, 0, 1)), 64 * kMiB);
  EXPECT_LE(named_budget(job_of(1'000'000'000, 8192, 0, 1)), kGiB);
}

TEST(MemoryPlanTest, TheLeastDoesNotDependOnThreads) {
  EXPECT_EQ(named_budget(job_of(3'000'000, 8192, 4, 1)),
            named_budget(job_of(3'000'000, 8192, 4, 128)));
}

TEST(MemoryPlanTest, ThePartsStayWithinTheBudget) {
  for (const JobSize& job : jobs()) {
    const std::uint64_t least = named_budget(job);
    for (const std::uint64_t budget : {least, least + 7 * kMiB, 2 * least, least + 64 * kGiB}) {
      SCOPED_TRACE(text_of(job) + ", budget " + execution::exact_size_text(budget));
      const MemoryPlan plan = plan_memory(budget, memory_costs(job));
      EXPECT_LE(plan.pool_bytes + plan.work_bytes, budget);
      EXPECT_GT(plan.work_bytes, 0U);
      EXPECT_LE(plan.table_bytes, plan.work_bytes);
      EXPECT_GE(plan.table_bytes, kMiB);
      EXPECT_GE(plan.blocks_in_flight, 1U);
      EXPECT_GE(plan.chunks_in_flight, 1U);
      EXPECT_GE(plan.tiles_in_flight, 1U);
      EXPECT_LE(plan.chunks_in_flight, job.threads + 1);
      EXPECT_LE(plan.tiles_in_flight, 2 * job.threads);
      EXPECT_GE(plan.spool_block_bytes, 1024U);
    }
  }
}

TEST(MemoryPlanTest, OpenSpoolsFitTheWorkOfTheLargestMesh) {
  const JobSize job = job_of(4'294'967'295, 32768, 9, 2);
  const MemoryPlan plan = plan_memory(named_budget(job), memory_costs(job));
  const std::uint64_t spools = 2 * (job.vertex_count / 131072 + 1);  // a chunk's two, at least
  EXPECT_LE(spools * plan.spool_block_bytes, plan.work_bytes);
}

TEST(MemoryPlanTest, TheIndexOfTheSpoolsFitsTheWorkOfALargeMesh) {
  // A spool keeps a pointer, an offset and a flag for every block, in memory or not.
  constexpr std::uint64_t kIndexBytes = 24;
  for (const std::uint64_t vertices : {std::uint64_t{10'000'000}, std::uint64_t{500'000'000}}) {
    const JobSize job = job_of(vertices, 8192, 0, 1);
    const MemoryPlan plan = plan_memory(named_budget(job), memory_costs(job));
    const std::uint64_t spooled_bytes = job.vertex_count * 12 + job.face_count * 12;
    EXPECT_LE(spooled_bytes / plan.spool_block_bytes * kIndexBytes, plan.work_bytes)
        << vertices << " vertices in blocks of " << plan.spool_block_bytes << " bytes";
  }
}

TEST(MemoryPlanTest, MoreMemoryNeverGivesLess) {
  const JobSize job = job_of(50'000'000, 8192, 4, 8);
  MemoryPlan before = plan_memory(named_budget(job), memory_costs(job));
  for (std::uint64_t budget = named_budget(job); budget < 16 * kGiB; budget += budget / 7) {
    const MemoryPlan plan = plan_memory(budget, memory_costs(job));
    EXPECT_GE(plan.pool_bytes, before.pool_bytes);
    EXPECT_GE(plan.work_bytes, before.work_bytes);
    EXPECT_GE(plan.tiles_in_flight, before.tiles_in_flight);
    EXPECT_GE(plan.chunks_in_flight, before.chunks_in_flight);
    EXPECT_GE(plan.blocks_in_flight, before.blocks_in_flight);
    before = plan;
  }
}

}  // namespace
}  // namespace meshhier::pipeline
