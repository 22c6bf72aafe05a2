// The division of a memory budget, so that a job stays within it.
#pragma once

#include "pipeline/plan/stage_cost.h"

#include <cstddef>
#include <cstdint>

namespace meshhier::pipeline {

/// The allocator keeps one part in so many of the budget: memory that was given back.
inline constexpr std::uint64_t kAllocatorParts = 12;

/// The budget's division. Every part is an upper bound.
struct MemoryPlan {
  std::uint64_t budget_bytes = 0;    ///< the whole
  std::uint64_t pool_bytes = 0;      ///< scratch data that may stay in memory
  std::uint64_t work_bytes = 0;      ///< for a stage at work
  std::size_t blocks_in_flight = 1;  ///< blocks of input
  std::size_t chunks_in_flight = 1;
  std::size_t tiles_in_flight = 1;
  std::size_t pictures_in_flight = 1;
  std::size_t spool_block_bytes = 0;  ///< for each of a stage's many spools
  std::uint64_t table_bytes = 0;      ///< for renumbering the triangles
};

/// Returns the memory that is held all the time: the program and the bookkeeping.
std::uint64_t fixed_bytes(const MemoryCosts& costs);

/// Returns the least budget that will do, in whole MiB; does not depend on threads.
std::uint64_t least_budget(const MemoryCosts& costs);

/// Divides `budget_bytes`. Throws Error(budget) naming the least that would do.
MemoryPlan plan_memory(std::uint64_t budget_bytes, const MemoryCosts& costs);

}  // namespace meshhier::pipeline
