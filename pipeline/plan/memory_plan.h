// How a job lives within its memory budget.
#pragma once

#include "hierarchy/target_vertex_counts.h"

#include <cstddef>
#include <cstdint>

namespace meshhier::pipeline {

/// What decides the needs of a build.
struct JobSize {
  std::uint64_t vertex_count = 0;
  std::uint64_t face_count = 0;
  int channels = 0;                  ///< attribute floats per vertex
  std::uint64_t imported_bytes = 0;  ///< of the PLY that the input was imported to, if it was
  bool vertices_in_place = true;     ///< else the vertices are spooled once more
  bool wide_coordinates = false;     ///< spooled as doubles
  std::uint32_t partition_count = 0;
  std::uint32_t largest_tile = 0;  ///< vertices of the largest partition or simplified mesh
  std::size_t threads = 1;
  TargetVertexCounts target_vertex_counts;      ///< of a simplified mesh
  bool clustered = false;                       ///< simplified by the method `cluster`
  std::uint64_t published_attribute_bytes = 0;  ///< of a vertex in a published tile
  double published_ratio = 1;                   ///< of a published tile, about, to a plain one
  bool packed = false;                          ///< published files become one archive

  /// Of a vertex at work: its position and its attributes, as floats.
  std::uint32_t vertex_bytes() const { return 12 + 4 * static_cast<std::uint32_t>(channels); }
};

/// The budget's division. Every part is an upper bound.
struct MemoryPlan {
  std::uint64_t budget_bytes = 0;    ///< what was divided
  std::uint64_t pool_bytes = 0;      ///< scratch data that may stay in memory
  std::uint64_t work_bytes = 0;      ///< what a stage at work may hold
  std::size_t blocks_in_flight = 1;  ///< blocks of input
  std::size_t chunks_in_flight = 1;
  std::size_t tiles_in_flight = 1;
  std::size_t spool_block_bytes = 0;  ///< of each of a stage's many spools
  std::uint64_t table_bytes = 0;      ///< for renumbering the triangles
};

/// The least budget that will do, in whole MiB; does not depend on threads.
std::uint64_t least_budget(const JobSize& job);

/// Divides `budget_bytes`. Throws Error(budget) naming the least that would do.
MemoryPlan plan_memory(std::uint64_t budget_bytes, const JobSize& job);

}  // namespace meshhier::pipeline
