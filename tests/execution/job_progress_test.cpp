#include "execution/job_progress.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace meshhier::execution {
namespace {

std::vector<ExpectedStage> build_of(double scale) {
  return {{"ingest", "vertices", 1000, scale},
          {"partition", "vertices", 1000, scale},
          {"partition", "vertices", 1000, scale},
          {"partition", "triangles", 2000, scale},
          {"simplify", "tiles", 100, 96 * scale}};
}

TEST(JobProgressTest, WeighsStagesByWhatTheyAreExpectedToTake) {
  JobProgress job;
  job.expect(build_of(1));
  job.begin("ingest", "vertices", 1000, 0);
  EXPECT_EQ(job.part(0), 0);
  EXPECT_EQ(job.seconds_left(0, 0), 100);
  EXPECT_DOUBLE_EQ(*job.part(500), 0.005);
  job.begin("partition", "vertices", 1000, 1);
  EXPECT_DOUBLE_EQ(*job.part(0), 0.01);
  job.begin("simplify", "tiles", 100, 2);
  EXPECT_DOUBLE_EQ(*job.part(0), 0.04) << "what did not come is behind";
  EXPECT_DOUBLE_EQ(*job.part(50), 0.52);
  job.end(50);
  EXPECT_DOUBLE_EQ(*job.part(0), 1);
}

TEST(JobProgressTest, TheTimeLeftFollowsThePaceAndDoesNotJump) {
  for (const double scale : {0.0001, 1.0, 1000.0}) {
    for (const double slowness : {0.2, 1.0, 5.0}) {
      JobProgress job;
      job.expect(build_of(scale));
      double now = 0;
      double last = *job.seconds_left(0, now) + now;
      double part = 0;
      for (const ExpectedStage& stage : build_of(scale)) {
        job.begin(stage.name, stage.unit, stage.units, now);
        for (std::uint64_t step = 1; step <= 100; ++step) {
          now += stage.seconds / 100 * slowness;
          const std::uint64_t done = stage.units * step / 100;
          const double end = now + *job.seconds_left(done, now);
          EXPECT_LE(std::abs(end - last), 0.1 * std::max(end, last));
          EXPECT_GE(*job.part(done), part);
          part = *job.part(done);
          last = end;
        }
      }
      EXPECT_NEAR(last, now, 1e-9 * now);
      EXPECT_NEAR(part, 1, 1e-9);
    }
  }
}

TEST(JobProgressTest, AStageThatIsSlowerThanTheOthersIsLearnt) {
  JobProgress job;
  job.expect(build_of(1));
  job.begin("simplify", "tiles", 100, 0);
  EXPECT_NEAR(*job.seconds_left(50, 480), 480, 50);
}

TEST(JobProgressTest, WhatAnEarlierRunDidCountsForThePartOnly) {
  JobProgress job;
  job.expect(build_of(1));
  job.begin("simplify", "tiles", 25, 0);
  EXPECT_NEAR(*job.part(0), 0.76, 1e-12);
  EXPECT_NEAR(*job.seconds_left(0, 0), 24, 1e-12);
  EXPECT_NEAR(*job.seconds_left(0, 0.5), 24, 3) << "the pace is that of this run";
}

TEST(JobProgressTest, StagesThatWereNotExpectedAddNothing) {
  JobProgress job;
  job.expect({{"outline", "sectors", 0, 1}, {"publish", "tiles", 10, 1}});
  job.begin("resume", "entries", 5, 0);
  EXPECT_EQ(job.part(5), 0);
  job.begin("outline", "sectors", 8, 1);
  job.begin("outline", "sectors", 4, 2);
  EXPECT_EQ(job.part(4), 0.5);
  job.begin("publish", "tiles", 10, 3);
  EXPECT_EQ(job.part(5), 0.75);
}

TEST(JobProgressTest, NewExpectationsAreAboutTheRest) {
  JobProgress job;
  job.expect({{"import", "bytes", 100, 1}, {"", "", 0, 3}});
  job.begin("import", "bytes", 100, 0);
  EXPECT_EQ(job.part(100), 0.25);
  job.end(1);
  EXPECT_EQ(job.part(0), 0.25);
  job.expect({{"ingest", "vertices", 10, 100}});
  job.begin("ingest", "vertices", 10, 1);
  EXPECT_EQ(job.part(0), 0.25);
  EXPECT_EQ(job.part(5), 0.625);
  EXPECT_EQ(job.part(10), 1);
}

TEST(JobProgressTest, WithoutExpectationsEachStageIsAJob) {
  JobProgress job;
  job.begin("read", "tiles", 0, 0);
  EXPECT_EQ(job.part(3), std::nullopt);
  EXPECT_EQ(job.seconds_left(3, 1), std::nullopt);
  job.begin("export", "tiles", 4, 1);
  EXPECT_EQ(job.part(1), 0.25);
  EXPECT_EQ(job.seconds_left(1, 3), 6);
  job.begin("write", "tiles", 4, 4);
  EXPECT_EQ(job.part(0), 0);
}

}  // namespace
}  // namespace meshhier::execution
