#include "app/worker.h"

#include "base/error.h"

#include <map>
#include <optional>
#include <string>

#include <gtest/gtest.h>

namespace meshhier::app {
namespace {

using Set = std::map<std::string, std::string>;

std::string found(const Set& variables, std::uint32_t tasks = 8, const AskedWorker& asked = {}) {
  const pipeline::Share worker =
      find_worker(asked, tasks, [&](const char* name) -> std::optional<std::string> {
        const auto set = variables.find(name);
        return set == variables.end() ? std::nullopt : std::optional(set->second);
      });
  return std::to_string(worker.index) + " of " + std::to_string(worker.of);
}

TEST(WorkerTest, WithoutASchedulerOneDoesAll) {
  EXPECT_EQ(found({}), "0 of 1");
}

TEST(WorkerTest, TheCommandLineComesFirst) {
  const Set slurm = {{"SLURM_PROCID", "3"}, {"SLURM_NTASKS", "4"}};
  EXPECT_EQ(found(slurm, 8, {5, 6}), "5 of 6");
  EXPECT_EQ(found(slurm, 8, {5, {}}), "5 of 8");
  EXPECT_EQ(found(slurm, 8, {{}, 16}), "3 of 16");
  EXPECT_THROW(found({}, 8, {8, {}}), Error);
  EXPECT_THROW(found({}, 8, {2, 2}), Error);
}

TEST(WorkerTest, ProcessesOfASlurmStepShareTheTasks) {
  EXPECT_EQ(found({{"SLURM_PROCID", "3"}, {"SLURM_NTASKS", "4"}}), "3 of 4");
  EXPECT_EQ(found({{"SLURM_PROCID", "3"},
                   {"SLURM_NTASKS", "4"},
                   {"SLURM_JOB_ID", "7"},
                   {"SLURM_STEP_ID", "0"}}),
            "3 of 4");
}

/// It has the variables of the first process of a step, which nobody starts.
TEST(WorkerTest, ASlurmBatchScriptDoesAll) {
  EXPECT_EQ(found({{"SLURM_PROCID", "0"}, {"SLURM_NTASKS", "4"}, {"SLURM_JOB_ID", "7"}}), "0 of 1");
}

TEST(WorkerTest, ASlurmArrayCountsFromItsFirst) {
  const auto array = [](const char* id, const char* least, const char* most, const char* step,
                        const char* count) {
    return Set{{"SLURM_ARRAY_TASK_ID", id},
               {"SLURM_ARRAY_TASK_MIN", least},
               {"SLURM_ARRAY_TASK_MAX", most},
               {"SLURM_ARRAY_TASK_STEP", step},
               {"SLURM_ARRAY_TASK_COUNT", count}};
  };
  EXPECT_EQ(found(array("3", "0", "7", "1", "8")), "3 of 8");
  EXPECT_EQ(found(array("8", "1", "8", "1", "8")), "7 of 8");
  EXPECT_EQ(found(array("6", "0", "8", "2", "5")), "3 of 5");
  EXPECT_EQ(found(array("7", "3", "7", "1", "2")), "7 of 8") << "some are run again";
  EXPECT_EQ(found(array("5", "5", "5", "1", "1")), "5 of 8") << "one is run again";
  EXPECT_EQ(found(array("4", "3", "5", "1", "3")), "4 of 8") << "some are";
  EXPECT_EQ(found(array("9", "9", "9", "1", "1")), "9 of 10");
  EXPECT_EQ(found({{"SLURM_ARRAY_TASK_ID", "3"}}), "3 of 8");
}

TEST(WorkerTest, StepsOfAnArrayShareItsPart) {
  EXPECT_EQ(found({{"SLURM_ARRAY_TASK_ID", "1"},
                   {"SLURM_ARRAY_TASK_MIN", "0"},
                   {"SLURM_ARRAY_TASK_MAX", "2"},
                   {"SLURM_ARRAY_TASK_COUNT", "3"},
                   {"SLURM_JOB_ID", "7"},
                   {"SLURM_STEP_ID", "0"},
                   {"SLURM_PROCID", "1"},
                   {"SLURM_NTASKS", "2"}}),
            "3 of 6");
}

TEST(WorkerTest, PodsAndBatchJobsHaveATaskEach) {
  EXPECT_EQ(found({{"JOB_COMPLETION_INDEX", "5"}}), "5 of 8");
  EXPECT_EQ(found({{"JOB_COMPLETION_INDEX", "9"}}), "9 of 10") << "which has nothing to do";
  EXPECT_EQ(found({{"JOB_COMPLETION_INDEX", "1"}}, 8, {{}, 4}), "1 of 4");
  EXPECT_EQ(found({{"AWS_BATCH_JOB_ARRAY_INDEX", "5"}}), "5 of 8");
  EXPECT_EQ(found({{"AWS_BATCH_JOB_ARRAY_INDEX", "1"}, {"AWS_BATCH_JOB_ARRAY_SIZE", "4"}}),
            "1 of 4");
}

TEST(WorkerTest, WhatCannotBeIsRefused) {
  EXPECT_THROW(found({{"SLURM_PROCID", "0"}, {"SLURM_NTASKS", "0"}}), Error);
  EXPECT_THROW(found({{"SLURM_PROCID", "4"}, {"SLURM_NTASKS", "4"}}), Error);
  EXPECT_THROW(found({{"AWS_BATCH_JOB_ARRAY_INDEX", "0"}, {"AWS_BATCH_JOB_ARRAY_SIZE", "0"}}),
               Error);
  EXPECT_THROW(
      found({{"SLURM_ARRAY_TASK_ID", "65536"}, {"SLURM_PROCID", "0"}, {"SLURM_NTASKS", "65536"}}),
      Error);
  EXPECT_THROW(found({{"JOB_COMPLETION_INDEX", "4294967295"}}), Error);
}

TEST(WorkerTest, WhatIsNoNumberIsRefused) {
  for (const char* text : {"x", "-1", "1.5", "99999999999", "1 "}) {
    EXPECT_THROW(found({{"SLURM_ARRAY_TASK_ID", text}}), Error) << text;
    EXPECT_THROW(found({{"JOB_COMPLETION_INDEX", text}}), Error) << text;
  }
  EXPECT_EQ(found({{"JOB_COMPLETION_INDEX", ""}}), "0 of 1");
}

}  // namespace
}  // namespace meshhier::app
