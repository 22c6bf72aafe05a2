#include "server/job.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

TEST(JobTest, ProgressIsTakenFromTheBuildsLines) {
  Job job{.name = "a.ply", .state = JobState::building};
  take_line(job,
            R"({"event":"progress","stage":"partition","done":30,"total":120,"unit":"vertices",)"
            R"("rate":1,"seconds":2,"eta_seconds":6.5})");
  EXPECT_EQ(
      to_json(job).dump(),
      R"({"name":"a.ply","state":"building","stage":"partition","progress":0.25,"seconds_left":6.5})");
  take_line(
      job, R"({"event":"stage_start","stage":"outline","done":0,"total":null,"eta_seconds":null})");
  EXPECT_EQ(to_json(job).dump(), R"({"name":"a.ply","state":"building","stage":"outline"})");
}

TEST(JobTest, MoreThanAllIsAll) {
  Job job;
  take_line(job, R"({"stage":"x","done":7,"total":5})");
  EXPECT_EQ(job.progress, 1.0);
}

TEST(JobTest, ErrorsAreMessages) {
  Job job{.name = "a.ply", .state = JobState::failed};
  take_line(job, R"({"event":"error","code":3,"message":"a.ply: line 7:\nno number"})");
  EXPECT_EQ(to_json(job).dump(),
            R"({"name":"a.ply","state":"failed","message":"a.ply: line 7:?no number"})");
  take_line(job, "meshhier: something else");
  EXPECT_EQ(job.message, "meshhier: something else");
}

TEST(JobTest, WarningsAreKeptBesideTheMessage) {
  Job job{.name = "a.obj", .state = JobState::building, .message = "before"};
  take_line(job, R"({"event":"warning","message":"wall.mtl: missing"})");
  take_line(job, R"({"event":"warning","message":"wall.mtl: missing"})");
  take_line(job, R"({"event":"warning","message":"two\nlines"})");
  EXPECT_EQ(job.message, "before");
  EXPECT_EQ(job.warnings, (std::vector<std::string>{"wall.mtl: missing", "two?lines"}));
  for (int i = 0; i < 1000; ++i)
    take_line(job, R"({"event":"warning","message":")" + std::to_string(i) + "\"}");
  EXPECT_EQ(job.warnings.size(), 100U);
}

TEST(JobTest, LinesThatNobodyExpectsDoNoHarm) {
  Job job;
  for (const char* line :
       {"", "{", "[]", "1", "{}", R"({"stage":7})", R"({"stage":"s","done":"x","total":[]})",
        R"({"stage":"s","done":1,"total":-4})", R"({"message":{}})", "\xff\xfe"})
    take_line(job, line);
  EXPECT_FALSE(job.progress);
  take_line(job, std::string(100'000, 'x'));
  EXPECT_EQ(job.message.size(), 1003U) << "its beginning, and ...";
}

}  // namespace
}  // namespace meshhier::server
