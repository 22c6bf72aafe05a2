// The costs of a build's stages, as values: each stage tells them beside its code (*_memory(),
// *_disk(), *_time()), its row in pipeline/stages.cpp names these functions, pipeline/stage_costs
// walks the rows, and the plan adds up.
#pragma once

#include "execution/job_progress.h"
#include "pipeline/tiles/chunks.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::pipeline {

struct MemoryPlan;

/// Memory of a stage at work: upper bounds for tiles as they are on average (TileRoom has the
/// others).
struct StageMemory {
  std::uint64_t item_bytes = 0;    ///< an item in flight: a block of input, a chunk, a tile
  std::size_t most_items = 1;      ///< more in flight gain nothing
  std::uint64_t least_bytes = 0;   ///< all of the stage, with one item in flight
  std::uint64_t wanted_bytes = 0;  ///< all of the stage; more gains nothing
  /// The field of the plan that says how many items are in flight; null: the stage does not ask.
  std::size_t MemoryPlan::*in_flight = nullptr;
  std::uint64_t item_parts = 1;  ///< one part in so many of the stage's memory is for items
};

struct MemoryCosts {
  std::uint64_t bookkeeping_bytes = 0;  ///< held all the time
  std::vector<StageMemory> stages{};
  ChunkSpools chunk_spools;
  std::uint64_t block_bytes = 0;  ///< a block of input
};

/// The CPU seconds of a stage on the machine of kRateMachine, as `scripts/benchmark scale` measured
/// them, disk to disk; an entry for each pass that it tells progress of.
using StageTime = execution::ExpectedStage;
using StageTimes = std::vector<StageTime>;

/// A disk on its own, a cloud volume or a laptop's SSD when its cache is full.
inline constexpr double kDiskBytesPerSecond = 500e6;

/// The moments at which the most may lie on disk, in the order of a build.
enum class DiskMoment {
  splits,     ///< partition: the medians are being settled
  triangles,  ///< partition: triangles are being distributed
  noted,      ///< partition: the chunks are on disk, named by the journal
  leaves,     ///< the end of leaves
  simplify    ///< the end of simplify, and what comes behind it
};

/// Temporary bytes and how long they stay. They are expected ones, a few per cent above measured
/// ones.
struct DiskVolume {
  double bytes = 0;
  DiskMoment from{}, until{};  ///< there from the first moment to the last, both included
  bool pooled = false;         ///< bytes that the memory pool holds are not on disk
};
using DiskVolumes = std::vector<DiskVolume>;

/// The published files.
struct OutputCost {
  double plain_bytes = 0;  ///< if no tile compresses
  double bytes = 0;        ///< about, as they are compressed
  double slack_bytes = 0;  ///< the empty part of each file's last disk block, and splits
};

struct DiskCosts {
  DiskVolumes volumes;
  OutputCost output;
  bool packed = false;                ///< the published files become one archive
  double archive_overhead_bytes = 0;  ///< the archive's, beside the files in it
};

}  // namespace meshhier::pipeline
