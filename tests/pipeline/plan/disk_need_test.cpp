#include "pipeline/plan/disk_need.h"

#include "hierarchy/tree.h"
#include "partition/top_tree.h"
#include "pipeline/stage_costs.h"
#include "tests/support/sizes.h"

#include <cstdint>

#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

using tests::kGiB;
using tests::kMiB;

/// A closed surface.
JobSize job_of(std::uint64_t vertices, std::uint32_t tile) {
  JobSize job;
  job.vertex_count = vertices;
  job.place_count = job.vertex_count;
  job.face_count = 2 * vertices;
  job.partition_count = static_cast<std::uint32_t>((vertices + tile - 1) / tile);
  job.largest_tile = tile;
  job.target_vertex_counts = tile;
  return job;
}

std::uint64_t least_of(const JobSize& job) {
  return least_budget(memory_costs(job));
}

DiskNeed need_of(const JobSize& job, std::uint64_t budget) {
  const MemoryPlan plan = plan_memory(budget, memory_costs(job));
  return predict_disk(disk_costs(job, plan, expected_tiles(job)), plan.pool_bytes);
}

TEST(DiskNeedTest, WhatABuildGoesOnWithIsOnDiskWhateverTheMemory) {
  const JobSize job = job_of(100'000, 8192);
  EXPECT_GT(need_of(job, 4 * kGiB).temporary_bytes, job.vertex_count * 12 + job.face_count * 6);
  EXPECT_GE(need_of(job, least_of(job)).temporary_bytes, need_of(job, 4 * kGiB).temporary_bytes);
  EXPECT_GT(need_of(job, 4 * kGiB).output_bytes, job.vertex_count * 12 + job.face_count * 12);
}

TEST(DiskNeedTest, GrowsWithWhatAVertexHolds) {
  const JobSize bare = job_of(10'000'000, 8192);
  JobSize full = bare;
  full.channels = 9;
  full.published_attribute_bytes = 24;
  EXPECT_GE(need_of(full, kGiB).output_bytes,
            need_of(bare, kGiB).output_bytes + bare.vertex_count * 24);
  EXPECT_GT(need_of(full, kGiB).temporary_bytes, need_of(bare, kGiB).temporary_bytes);
}

TEST(DiskNeedTest, MoreMemoryNeedsNoMoreDisk) {
  const JobSize job = job_of(30'000'000, 8192);
  std::uint64_t before = ~std::uint64_t{0};
  for (std::uint64_t budget = 128 * kMiB; budget < 8 * kGiB; budget *= 2) {
    const DiskNeed need = need_of(job, budget);
    EXPECT_LE(need.temporary_bytes, before);
    before = need.temporary_bytes;
  }
}

TEST(DiskNeedTest, TheRoomHoldsTheOutputAndEachStagesFiles) {
  for (const std::uint32_t tile : {16U, 512U, 8192U, 32768U}) {
    for (const std::uint64_t budget : {128 * kMiB, kGiB}) {
      JobSize job = job_of(3'000'000, tile);
      const DiskNeed need = need_of(job, std::max(budget, least_of(job)));
      EXPECT_GE(need.room_bytes, need.temporary_bytes);
      EXPECT_GE(need.room_bytes, need.output_bytes);
      EXPECT_LE(need.room_bytes, need.temporary_bytes + need.output_bytes +
                                     2 * 4096 * std::uint64_t{job.partition_count} + 65536);
    }
  }
}

TEST(DiskNeedTest, AnArchiveIsThereBesideWhatItIsMadeOf) {
  for (const std::uint32_t tile : {16U, 512U, 8192U}) {
    JobSize job = job_of(3'000'000, tile);
    const DiskNeed files = need_of(job, kGiB);
    job.packed = true;
    const DiskNeed packed = need_of(job, kGiB);
    EXPECT_GT(packed.output_bytes, files.output_bytes);
    EXPECT_GE(packed.temporary_bytes, files.output_bytes);
    EXPECT_GE(packed.room_bytes, files.output_bytes + packed.output_bytes);
    EXPECT_GE(packed.room_bytes, files.room_bytes);
  }
}

TEST(DiskNeedTest, TemporaryFilesStayBelowOneAndAHalfTimesInputAndOutput) {
  // The input takes 12 bytes a vertex and 13 a triangle.
  for (const std::uint64_t vertices : {7'000'000U, 28'000'000U, 250'000'000U}) {
    const JobSize job = job_of(vertices, 8192);
    const DiskNeed need = need_of(job, std::max(64 * kMiB, least_of(job)));
    const std::uint64_t floor = vertices * 12 + job.face_count * 13 + need.output_bytes;
    EXPECT_LE(2 * need.temporary_bytes, 3 * floor) << vertices;
  }
}

TEST(DiskNeedTest, ASecondCopyOfTheVerticesCounts) {
  JobSize text = job_of(30'000'000, 8192);
  text.vertices_in_place = false;
  JobSize wide = text;
  wide.wide_coordinates = true;
  const std::uint64_t budget = 256 * kMiB;
  EXPECT_GE(need_of(text, budget).temporary_bytes,
            need_of(job_of(30'000'000, 8192), budget).temporary_bytes);
  EXPECT_GT(need_of(wide, budget).temporary_bytes, need_of(text, budget).temporary_bytes);
}

TEST(DiskNeedTest, ClusteringLeavesMoreTriangles) {
  const JobSize usual = job_of(5'000'000, 8192);
  JobSize clustered = usual;
  clustered.clustered = true;
  EXPECT_GT(need_of(clustered, kGiB).output_bytes, need_of(usual, kGiB).output_bytes);
}

TEST(DiskNeedTest, TilesAreCountedAsTheTreeHasThem) {
  for (const std::uint32_t partitions : {1U, 2U, 3U, 4U, 5U, 7U, 8U, 100U, 128U, 1000U, 4097U}) {
    JobSize job = job_of(1'000'000, 8192);
    job.partition_count = partitions;
    const Tree tree(job.vertex_count, partitions);
    std::uint64_t simplified = 0;
    for (int l = 0; l < raw(tree.depth()); ++l) {
      const auto level = static_cast<Level>(l);
      for (std::uint32_t i = 0; i < tree.node_count(level); ++i)
        simplified += tree.is_early({level, i}) ? 0 : 1;
    }
    const TileCounts counts = count_tiles(expected_tiles(job));
    EXPECT_EQ(counts.levels, raw(tree.depth()) + 1) << partitions;
    EXPECT_EQ(counts.simplified, simplified) << partitions;
    EXPECT_EQ(counts.tiles(), simplified + partitions);
  }
}

}  // namespace
}  // namespace meshhier::pipeline
