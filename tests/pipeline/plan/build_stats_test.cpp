#include "pipeline/plan/build_stats.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Json = nlohmann::ordered_json;

/// Hears what a shown progress hears.
class Ear final : public execution::Progress {
 public:
  void stage(std::string_view name, std::uint64_t total, std::string_view unit) override {
    heard.push_back(std::string(name) + " " + std::to_string(total) + " " + std::string(unit));
  }
  void advance(std::uint64_t count) override { heard.push_back(std::to_string(count)); }
  void finish(std::string_view summary) override { heard.emplace_back(summary); }
  std::vector<std::string> heard;
};

/// A machine whose figures the test sets.
class StageMeterTest : public testing::Test {
 protected:
  StageMeter make_meter() {
    return StageMeter({.shown = ear_,
                       .io = io_,
                       .scratch = scratch_,
                       .usage = [this] { return usage_; },
                       .clock = [this] { return clock_; }});
  }
  /// `wall` seconds pass, with half of them spent in user code and a quarter in the system.
  void pass(double wall) {
    clock_ += wall;
    usage_.user_seconds += wall / 2;
    usage_.system_seconds += wall / 4;
  }

  Ear ear_;
  storage::IoCounters io_;
  storage::ScratchUse scratch_;
  storage::ProcessUsage usage_{100, 10, 1000};
  double clock_ = 5;
};

TEST_F(StageMeterTest, EachStageHasItsTimeAndTheTotalAll) {
  StageMeter meter = make_meter();
  pass(1);
  meter.stage("ingest", 0, "vertices");
  pass(2);
  meter.stage("leaves", 0, "partitions");
  pass(4);
  meter.end();
  pass(8);
  meter.begin("sync");
  pass(16);
  meter.end();
  ASSERT_EQ(meter.stages().size(), 3U);
  EXPECT_EQ(meter.stages()[0].name, "ingest");
  EXPECT_DOUBLE_EQ(meter.stages()[0].wall_seconds, 2);
  EXPECT_DOUBLE_EQ(meter.stages()[0].user_seconds, 1);
  EXPECT_DOUBLE_EQ(meter.stages()[0].system_seconds, 0.5);
  EXPECT_DOUBLE_EQ(meter.stages()[1].wall_seconds, 4);
  EXPECT_DOUBLE_EQ(meter.stages()[2].wall_seconds, 16);
  EXPECT_DOUBLE_EQ(meter.total().wall_seconds, 31);
  EXPECT_DOUBLE_EQ(meter.total().cpu_seconds(), 31 * 0.75);
}

TEST_F(StageMeterTest, AStageThatComesAgainGoesOn) {
  StageMeter meter = make_meter();
  for (const char* name : {"partition", "other", "partition"}) {
    meter.stage(name, 0, "vertices");
    pass(1);
    usage_.peak_resident_bytes += 50;
  }
  meter.end();
  ASSERT_EQ(meter.stages().size(), 2U);
  EXPECT_DOUBLE_EQ(meter.stages()[0].wall_seconds, 2);
  EXPECT_EQ(meter.stages()[0].peak_resident_bytes, 1150U);
  EXPECT_EQ(meter.stages()[1].peak_resident_bytes, 1100U);
}

TEST_F(StageMeterTest, APeakNeverFalls) {
  StageMeter meter = make_meter();
  meter.begin("partition");
  usage_.peak_resident_bytes = 2000;
  meter.begin("leaves");
  usage_.peak_resident_bytes = 1900;
  meter.end();
  EXPECT_EQ(meter.stages()[0].peak_resident_bytes, 2000U);
  EXPECT_EQ(meter.stages()[1].peak_resident_bytes, 2000U);
  EXPECT_EQ(meter.total().peak_resident_bytes, 2000U);
}

TEST_F(StageMeterTest, ScratchBytesAreToldApartFromInputAndOutput) {
  StageMeter meter = make_meter();
  meter.stage("leaves", 0, "partitions");
  io_.bytes_read += 700;
  io_.bytes_written += 90;
  scratch_.add_read(200);
  scratch_.add_written(50);
  meter.stage("publish", 0, "tiles");
  io_.bytes_written += 1000;
  meter.end();
  const Traffic& leaves = meter.stages()[0].bytes;
  EXPECT_EQ(leaves.input_read, 500U);
  EXPECT_EQ(leaves.temporary_read, 200U);
  EXPECT_EQ(leaves.output_written, 40U);
  EXPECT_EQ(leaves.temporary_written, 50U);
  EXPECT_EQ(meter.stages()[1].bytes.output_written, 1000U);
  EXPECT_EQ(meter.total().bytes.moved(), 1790U);
}

TEST_F(StageMeterTest, WhatIsShownHearsEverythingButHiddenStages) {
  StageMeter meter = make_meter();
  meter.stage("ingest", 7, "vertices");
  meter.advance(3);
  meter.begin("checksum");
  meter.finish("done");
  EXPECT_THAT(ear_.heard, ElementsAre("ingest 7 vertices", "3", "done"));
}

pipeline::BuildStats sample() {
  pipeline::BuildStats stats;
  stats.config = {{"input", "a.ply"}};
  stats.threads = 2;
  stats.memory_budget_bytes = 64 << 20;
  stats.vertices = 1'000'000;
  stats.triangles = 2'000'000;
  stats.partitions = 123;
  stats.levels = 8;
  stats.tiles = 245;
  stats.input_bytes = 1000;
  stats.output_bytes = 3000;
  stats.peak_temporary_bytes = 500;
  stats.predicted_temporary_bytes = 600;
  stats.predicted_output_bytes = 3500;
  stats.stages = {
      {"leaves", 4, 1.5, 0.5, 0.25, {.input_read = 1000, .temporary_written = 2048}, 4096},
      {"publish", 1, 0.5, 0.25, 0.125, {.output_written = 3000}, 8192}};
  stats.total = {"total", 5, 2, 0.75, 0.375, {1000, 3000, 2048, 2048}, 8192};
  return stats;
}

TEST(BuildStatsTest, TheJsonHasEveryFigureInBytesAndSeconds) {
  const Json json = to_json(sample());
  EXPECT_EQ(json["config"]["input"], "a.ply");
  EXPECT_EQ(json["triangles"], 2'000'000);
  EXPECT_EQ(json["floor_bytes"], 4000);
  EXPECT_EQ(json["moved_bytes"], 8096);
  EXPECT_DOUBLE_EQ(json["moved_per_floor"], 2.024);
  EXPECT_EQ(json["predicted_temporary_bytes"], 600);
  ASSERT_EQ(json["stages"].size(), 2U);
  EXPECT_EQ(json["stages"][0]["name"], "leaves");
  EXPECT_DOUBLE_EQ(json["stages"][0]["cpu_seconds"], 2);
  EXPECT_DOUBLE_EQ(json["stages"][0]["serial_seconds"], 0.25);
  EXPECT_EQ(json["stages"][0]["temporary_written_bytes"], 2048);
  EXPECT_EQ(json["stages"][0]["triangles_per_second"], 500'000);
  EXPECT_EQ(json["stages"][1]["peak_resident_bytes"], 8192);
  EXPECT_EQ(json["total"]["wall_seconds"], 5);
}

TEST(BuildStatsTest, TheTableIsAligned) {
  const std::string text = pipeline::stats_text(sample());
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  ASSERT_EQ(lines.size(), 6U);
  for (std::size_t i = 1; i < 4; ++i)
    EXPECT_EQ(lines[i].size(), lines[0].size()) << lines[i];
  EXPECT_THAT(lines[1], HasSubstr("2.00 KiB"));
  EXPECT_THAT(lines[3], testing::StartsWith("total"));
  EXPECT_THAT(lines[4], HasSubstr("500 B at most, 600 B predicted"));
  EXPECT_THAT(lines[5], HasSubstr("moved 2.02 times"));
}

TEST(BuildStatsTest, NothingDoneIsNoDivisionByZero) {
  const Json json = to_json(pipeline::BuildStats{});
  EXPECT_EQ(json["moved_per_floor"], 0);
  EXPECT_EQ(json["total"]["triangles_per_second"], 0);
}

}  // namespace
}  // namespace meshhier::pipeline
