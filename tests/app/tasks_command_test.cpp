// `meshhier plan`, `task` and `finish`.
#include "tests/app/command_line.h"

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::app {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class Tasks : public CommandLine {
 protected:
  std::string shared() const { return (work() / "shared").string(); }

  Outcome plan(const std::string& tasks = "3") const {
    return run({"plan", write_config(), "--work", shared(), "--tasks", tasks});
  }

  /// The stages as scripts read them.
  std::vector<std::string> stages() const {
    std::istringstream lines(run({"task", shared(), "--stages"}).out);
    std::vector<std::string> names;
    std::string name;
    int tasks = 0;
    while (lines >> name >> tasks) {
      EXPECT_TRUE(tasks == 1 || tasks == 3) << name;
      names.push_back(name);
    }
    return names;
  }
};

TEST_F(Tasks, MakeTheBytesOfABuild) {
  build();
  const auto whole = contents(hierarchy());
  std::filesystem::remove_all(hierarchy());
  const Outcome planned = plan();
  ASSERT_EQ(planned.code, 0) << planned.messages;
  EXPECT_THAT(planned.out, HasSubstr("leaves --index I      for I from 0 to 2"));
  Outcome last;
  for (const std::string& stage : stages()) {
    last = run({"task", shared(), stage});
    ASSERT_EQ(last.code, 0) << stage << last.messages;
  }
  EXPECT_EQ(contents(hierarchy()), whole);
  EXPECT_THAT(last.out, HasSubstr("made "));
  EXPECT_EQ(json::parse(run({"task", shared(), "--status", "--json"}).out).at("finished"), true);
}

TEST_F(Tasks, TakeTheirIndexFromTheScheduler) {
  write_mesh("a.ply");
  ASSERT_EQ(plan().code, 0);
  for (const char* stage : {"read", "distribute", "faces", "join"})
    ASSERT_EQ(run({"task", shared(), stage}).code, 0) << stage;
  ::setenv("JOB_COMPLETION_INDEX", "1", 1);
  const Outcome pod = run({"task", shared(), "leaves"});
  ::unsetenv("JOB_COMPLETION_INDEX");
  EXPECT_EQ(pod.out, "leaves: 1 task done\n");
  ::setenv("SLURM_PROCID", "0", 1);
  ::setenv("SLURM_NTASKS", "2", 1);
  const Outcome step = run({"task", shared(), "leaves"});
  ::unsetenv("SLURM_PROCID");
  ::unsetenv("SLURM_NTASKS");
  EXPECT_EQ(step.out, "leaves: 2 tasks done\n");
  EXPECT_EQ(run({"task", shared(), "leaves"}).out, "leaves: 0 tasks done, 3 before\n");
}

TEST_F(Tasks, SayWhatIsWrong) {
  write_mesh("a.ply");
  EXPECT_EQ(run({"task", shared(), "read"}).code, 2);
  ASSERT_EQ(plan().code, 0);
  EXPECT_EQ(plan().code, 0) << "the same plan";
  EXPECT_EQ(plan("4").code, kOtherWork);
  const Outcome unknown = run({"task", shared(), "leave"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.messages, HasSubstr("its stages are: read, distribute, faces, join, leaves"));
  EXPECT_EQ(run({"task", shared()}).code, 2);
  const Outcome early = run({"task", shared(), "leaves"});
  EXPECT_EQ(early.code, 4) << "worth another try";
  EXPECT_THAT(early.messages, HasSubstr("task 0 of stage read is not done"));
  EXPECT_EQ(run({"task", shared(), "leaves", "--index", "3", "--of", "3"}).code, 2);
  EXPECT_THAT(run({"task", shared(), "--status"}).out, HasSubstr("next: stage read"));
  write_text(Path(shared()) / "plan.json", "{}");
  EXPECT_EQ(run({"task", shared(), "read"}).code, 7);
}

}  // namespace
}  // namespace meshhier::app
