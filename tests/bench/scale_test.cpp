// The benchmark `scale` and the tables that its scale.jq makes of what it measured.
#include "tests/support/sample_hierarchy.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

namespace meshhier {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

struct Outcome {
  int code = 0;
  std::string out;
};

Outcome run(const std::string& command) {
  FILE* pipe = popen(command.c_str(), "r");
  Outcome outcome;
  std::array<char, 4096> buffer;
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    outcome.out.append(buffer.data(), count);
  outcome.code = WEXITSTATUS(pclose(pipe));
  return outcome;
}

std::string script(const char* name) {
  return fmt::format("'{}/scripts/benchmarks/{}'", MESHHIER_SOURCE_DIR, name);
}

// ---- the script

class ScaleScript : public testing::Test {
 protected:
  Outcome scale(const std::string& options) const {
    return run(fmt::format("{} --work '{}' --programs '{}' --smallest 2000 {} 2>&1",
                           script("scale"), directory_.path().string(),
                           fs::path(MESHHIER_BINARY).parent_path().string(), options));
  }
  bool is_clean() const { return fs::is_empty(directory_.path()); }

  tests::TemporaryDirectory directory_;
};

TEST_F(ScaleScript, SLOW_MeasuresEverySettingAndRemovesAllItMade) {
  const Outcome outcome = scale("--largest 10k --threads 1,2 --budgets 128MiB,256MiB");
  EXPECT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_TRUE(is_clean());
  EXPECT_THAT(
      outcome.out,
      AllOf(HasSubstr("### Sizes (edge_collapse, 128MiB, 2 threads)\n"),
            HasSubstr("| 0.002 M | 256MiB | "), HasSubstr("| 0.009 M | 256MiB | "),
            HasSubstr("### Threads (0.009 M triangles, 128MiB)\n"), HasSubstr("| simplify | "),
            HasSubstr("\n| cluster | "), HasSubstr("| 0.009 M | random | ")));
}

TEST_F(ScaleScript, SLOW_WhatTheBudgetDoesNotAllowIsLeftOut) {
  const Outcome outcome = scale("--largest 4k --threads 1 --budgets 128MiB,1MiB");
  EXPECT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("at least"), HasSubstr("### Sizes"), Not(HasSubstr("### Budgets"))));
}

TEST_F(ScaleScript, SLOW_FailuresEndItAndLeaveNothing) {
  EXPECT_EQ(scale("--threads 1 --programs /absent").code, 3);
  EXPECT_EQ(scale("--threads 1 --largest 10").code, 2);
  EXPECT_EQ(scale("--lagrest 10").code, 2);
  EXPECT_EQ(scale("--largest").code, 2);
  EXPECT_TRUE(is_clean());
}

// ---- the tables

/// A build as it is measured: a million triangles, two threads, 128 MiB.
Json usual() {
  return Json::parse(R"({
    "input_bytes": 20000000, "output_bytes": 30000000, "floor_bytes": 50000000,
    "predicted_output_bytes": 33000000, "peak_temporary_bytes": 40000000,
    "predicted_temporary_bytes": 44000000, "moved_bytes": 150000000,
    "stages": [{"name": "ingest", "wall_seconds": 0.5, "cpu_seconds": 0.75},
               {"name": "simplify", "wall_seconds": 1.5, "cpu_seconds": 2.25}],
    "total": {"wall_seconds": 2.0, "cpu_seconds": 3.0, "peak_resident_bytes": 67108864},
    "setting": {"triangles": 1000000, "shuffled": false, "method": "edge_collapse", "threads": 2,
                "budget": 134217728},
    "copy_seconds": 0.25})");
}

Json with(const char* key, const Json& value) {
  Json build = usual();
  build["setting"][key] = value;
  return build;
}

std::string tables(const std::vector<Json>& builds) {
  const tests::TemporaryDirectory directory;
  const fs::path rows = directory.path() / "rows";
  std::ofstream stream(rows);
  for (const Json& build : builds)
    stream << build << '\n';
  stream.close();
  const Outcome outcome =
      run(fmt::format("jq -rs --arg meshes 'a torus' --argjson gains '{{\"2\": 1.9}}' "
                      "--argjson triangles 1000000 --arg method edge_collapse --argjson threads 2 "
                      "-f {} '{}'",
                      script("scale.jq"), rows.string()));
  EXPECT_EQ(outcome.code, 0);
  return outcome.out;
}

TEST(ScaleTables, SizesAreInOrderWithTheirFigures) {
  const std::string text = tables({usual(), with("triangles", 4'000'000)});
  EXPECT_THAT(text, HasSubstr("### Sizes (edge_collapse, 128MiB, 2 threads)"));
  EXPECT_THAT(text, HasSubstr("| 1.00 M | 2.00 | 3.00 | 3.000 | 0.50 | 64.0 MiB | 0.50 | 3.00 | "
                              "28.6 MiB | 1.10 | 0.25 | 8.0 |"));
  EXPECT_THAT(text, HasSubstr("| 4.00 M | 2.00 | 3.00 | 0.750 | 2.00 |"));
  EXPECT_LT(text.find("| 1.00 M"), text.find("| 4.00 M"));
  EXPECT_THAT(text, AllOf(Not(HasSubstr("### Budgets")), Not(HasSubstr("### Threads")),
                          Not(HasSubstr("### Methods")), Not(HasSubstr("### Order"))));
}

TEST(ScaleTables, BudgetsShowTheDiskAndItsPrediction) {
  const std::string text = tables({usual(), with("budget", 268'435'456)});
  EXPECT_THAT(text, HasSubstr("| 1.00 M | 128MiB | 2.00 | 3.00 | 64.0 MiB | 0.50 | 3.00 | 38.1 MiB "
                              "| 0.80 | 1.10 |"));
  EXPECT_THAT(text, HasSubstr("| 1.00 M | 256MiB | 2.00 | 3.00 | 64.0 MiB | 0.25 |"));
}

TEST(ScaleTables, ThreadsShowTheGainOfEachStageAndOfTheLoop) {
  Json one = with("threads", 1);
  one["total"]["wall_seconds"] = 3.6;
  one["stages"][1]["wall_seconds"] = 3;
  const std::string text = tables({usual(), one});
  EXPECT_THAT(text, HasSubstr("| simplify | 3.00 | 1.50 | 2.00 |"));
  EXPECT_THAT(text, HasSubstr("| **whole build** | 3.60 | 2.00 | 1.80 |"));
  EXPECT_THAT(text, HasSubstr("| a loop that only computes |  |  | 1.90 |"));
}

TEST(ScaleTables, MethodsAndOrdersAreComparedAtTheSameSize) {
  Json clustered = with("method", "cluster");
  clustered["total"]["wall_seconds"] = 0.5;
  Json shuffled = with("shuffled", true);
  Json alone = shuffled;
  shuffled["total"]["wall_seconds"] = 2.5;
  alone["setting"]["triangles"] = 4'000'000;
  const std::string text = tables({usual(), clustered, shuffled, alone});
  EXPECT_THAT(text, HasSubstr("| cluster | 0.50 | 3.00 | 3.000 | 2.00 | 0.25 |"));
  EXPECT_THAT(text, HasSubstr("| 1.00 M | random | 2.50 | 3.00 | 3.000 | 0.50 | 3.00 | 1.25 |"));
  EXPECT_THAT(text, HasSubstr("| 4.00 M | random | 2.00 | 3.00 | 0.750 | 0.50 | 3.00 | - |"));
}

TEST(ScaleTables, WithoutBuildsThereAreNone) {
  EXPECT_THAT(tables({}), Not(HasSubstr("###")));
}

}  // namespace
}  // namespace meshhier
