// How much disk a build will take, known from the header of its input.
//
// What is written when, and how long it stays:
//
//   data                    written in     stays until
//   the input as a PLY      import         partition is done   if it is imported
//   its vertices once more  ingest         partition is done   only if they cannot be read in place
//   windows of the medians  partition      the splits are found
//   ranks, triangles that   partition      partition is done
//   wait for a rank
//   vertices, triangles     partition      leaves is done
//   of chunks
//   partition tiles         leaves         the end
//   simplified tiles, maps  simplify       the end
//   seam strips             simplify       the end
//   published files         publish        for good            if they are the output
//                                          the end             if they are packed, the data above
//                                          being gone
//   the archive             pack           for good
//
// What the journal names, chunks and all that is made of them, is on disk whatever the budget. Of
// the rest, what the memory pool holds is not.
#pragma once

#include "pipeline/plan/memory_plan.h"

#include <cstdint>

namespace meshhier::pipeline {

/// Bytes on disk. Expected ones for a surface, whose tiles have borders as scans have them: a few
/// per cent above what was measured. How triangles refer to vertices, in order or at random, makes
/// no difference that counts.
struct DiskNeed {
  std::uint64_t temporary_bytes = 0;  ///< the most that lies in temporary files at once
  std::uint64_t output_bytes = 0;     ///< of the published files
  std::uint64_t room_bytes = 0;       ///< the most that lies on disk at once, both kinds together
};

DiskNeed predict_disk(const JobSize& job, const MemoryPlan& plan);

/// Tiles of a hierarchy, by arithmetic alone.
struct TileCounts {
  int levels = 0;
  std::uint64_t partitions = 0;
  std::uint64_t simplified = 0;  ///< published ones
  std::uint64_t tiles() const { return partitions + simplified; }
};

TileCounts count_tiles(const JobSize& job);

}  // namespace meshhier::pipeline
