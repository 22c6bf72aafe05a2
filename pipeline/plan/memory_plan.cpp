#include "pipeline/plan/memory_plan.h"

#include "base/error.h"
#include "execution/size_text.h"

#include <algorithm>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

// Program, libraries, stacks and allocator slack: 15 to 19 MiB were measured at rest, and up to 2
// more behind a look at all vertices by several threads.
constexpr std::uint64_t kBaseBytes = 22 * kMiB;

// The table of ranks has what the blocks and the spools leave, and this at least.
constexpr std::uint64_t kLeastTableBytes = 4 * kMiB;

/// Returns the memory that the hungriest stage holds with one item in flight.
std::uint64_t least_work_bytes(const MemoryCosts& costs) {
  std::uint64_t most = 0;
  for (const StageMemory& stage : costs.stages)
    most = std::max(most, stage.least_bytes);
  return most;
}

std::uint64_t wanted_work_bytes(const MemoryCosts& costs) {
  std::uint64_t most = least_work_bytes(costs);
  for (const StageMemory& stage : costs.stages)
    most = std::max(most, stage.wanted_bytes);
  return most;
}

std::size_t items_in_flight(std::uint64_t work_bytes, const StageMemory& stage) {
  return std::clamp<std::uint64_t>(
      work_bytes / stage.item_parts / std::max<std::uint64_t>(stage.item_bytes, 1), 1,
      stage.most_items);
}

}  // namespace

std::uint64_t fixed_bytes(const MemoryCosts& costs) {
  return kBaseBytes + costs.bookkeeping_bytes;
}

std::uint64_t least_budget(const MemoryCosts& costs) {
  return (fixed_bytes(costs) + least_work_bytes(costs) + kMiB - 1) / kMiB * kMiB;
}

MemoryPlan plan_memory(std::uint64_t budget_bytes, const MemoryCosts& costs) {
  const std::uint64_t fixed = fixed_bytes(costs);
  const std::uint64_t least_work = least_work_bytes(costs);
  if (budget_bytes < fixed + least_work) {
    throw Error(ErrorCode::budget,
                fmt::format("memory_budget {} is too small for this mesh; it needs at least {}",
                            execution::exact_size_text(budget_bytes),
                            execution::exact_size_text(least_budget(costs))));
  }
  const std::uint64_t spare = budget_bytes - fixed - least_work;
  MemoryPlan plan;
  plan.budget_bytes = budget_bytes;
  plan.work_bytes = std::min(wanted_work_bytes(costs), least_work + spare / 2);
  const std::uint64_t rest = budget_bytes - fixed - plan.work_bytes;
  plan.pool_bytes = rest - std::min(rest, budget_bytes / kAllocatorParts);
  for (const StageMemory& stage : costs.stages) {
    if (stage.in_flight != nullptr)
      plan.*stage.in_flight = items_in_flight(plan.work_bytes, stage);
  }
  plan.spool_block_bytes = costs.chunk_spools.block_bytes(plan.work_bytes);
  plan.table_bytes =
      plan.work_bytes - std::min(plan.work_bytes - kLeastTableBytes,
                                 plan.blocks_in_flight * costs.block_bytes +
                                     costs.chunk_spools.bytes(plan.spool_block_bytes));
  return plan;
}

}  // namespace meshhier::pipeline
