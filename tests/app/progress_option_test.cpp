// Progress and failures, for people and as JSON lines.
#include "tests/app/command_line.h"

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::app {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST_F(CommandLine, ProgressAsJsonLinesIsValidAndComplete) {
  write_mesh("a.ply");
  const Outcome outcome = run({"build", write_config(), "--progress", "json"});
  ASSERT_EQ(outcome.code, 0) << outcome.messages;
  std::istringstream lines(outcome.messages);
  std::string open_stage;
  std::string last_event;
  double job_done = 0;
  for (std::string line; std::getline(lines, line);) {
    const json event = json::parse(line);
    last_event = event.at("event");
    if (last_event == "stage_start") {
      EXPECT_EQ(open_stage, "");
      open_stage = event.at("stage");
    } else if (last_event != "finish") {
      EXPECT_EQ(event.at("stage"), open_stage);
      for (const char* key : {"done", "total", "unit", "rate", "seconds", "eta_seconds", "job_done",
                              "job_eta_seconds"}) {
        EXPECT_TRUE(event.contains(key)) << line;
      }
      EXPECT_GE(event.at("job_done"), job_done) << line;
      job_done = event.at("job_done");
    }
    if (last_event == "stage_end")
      open_stage = "";
  }
  EXPECT_EQ(last_event, "finish");
  EXPECT_EQ(job_done, 1);
  EXPECT_EQ(open_stage, "");
}

TEST_F(CommandLine, FailureIsAJsonLineTooIfProgressIs) {
  write_mesh("a.ply", 9999);
  const Outcome outcome = run({"build", write_config(), "--progress", "json"});
  EXPECT_EQ(outcome.code, kInput);
  std::istringstream lines(outcome.messages);
  json last;
  for (std::string line; std::getline(lines, line);)
    last = json::parse(line);
  EXPECT_EQ(last.at("event"), "error");
  EXPECT_EQ(last.at("code"), kInput);
  EXPECT_THAT(last.at("message").get<std::string>(), HasSubstr("a.ply"));
}

TEST_F(CommandLine, AMistakeInTheArgumentsIsAJsonLineToo) {
  const std::vector<std::pair<Arguments, std::string>> mistakes{
      {{"build", "a.ply", "--bogus", "--progress", "json"}, "--bogus"},
      {{"verify", "--progress=json"}, "HIERARCHY is required"},
      {{"bild", "a.ply", "--progress", "json"}, "did you mean \"build\"?"},
  };
  for (const auto& [arguments, expected] : mistakes) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, kUsage);
    const json event = json::parse(outcome.messages);
    EXPECT_EQ(event.at("event"), "error");
    EXPECT_EQ(event.at("code"), kUsage);
    EXPECT_THAT(event.at("message").get<std::string>(), HasSubstr(expected));
  }
}

TEST_F(CommandLine, ProgressIsSilentWhereThereIsNoTerminal) {
  write_mesh("a.ply");
  EXPECT_THAT(run({"build", write_config()}).messages, IsEmpty());
  EXPECT_THAT(run({"build", write_config(), "--force", "--progress", "none"}).messages, IsEmpty());
  EXPECT_THAT(run({"build", write_config(), "--force", "--progress", "bar"}).messages,
              AllOf(HasSubstr("simplify "), Not(HasSubstr("\r"))));
}

}  // namespace
}  // namespace meshhier::app
