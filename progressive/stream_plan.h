// The division of the memory budget for making a progressive stream.
#pragma once

#include "progressive/traced_tile.h"
#include "storage/format/hierarchy_reader.h"

#include <cstddef>
#include <cstdint>

namespace meshhier::progressive {

/// The budget's division. Every part is an upper bound.
struct ProgressivePlan {
  /// The foreign corners of a level get the 12th part of the budget beyond the least one: those of
  /// three levels are there at a time, beside runs and lists.
  static constexpr std::uint64_t kForeignParts = 12;

  std::uint64_t budget_bytes = 0;  ///< the whole
  std::uint64_t pool_bytes = 0;    ///< lists that may stay in memory
  Level subtrees{};                ///< its nodes are items of work, with all below them
  std::size_t subtrees_in_flight = 1;
  std::size_t runs_in_flight = 1;
  std::uint64_t foreign_bytes = 0;  ///< for the foreign corners of one level
};

/// The block size of the lists' spools, of which each level has seven.
inline constexpr std::size_t kListBlockBytes = std::size_t{1} << 15;

/// Divides `budget_bytes`. `threads`: how many items of work are worth having at a time. Throws
/// Error(budget) naming the least that would do.
ProgressivePlan plan_progressive(const storage::HierarchyReader& reader,
                                 const progressive::Sector& sector, std::uint64_t budget_bytes,
                                 std::size_t threads);

}  // namespace meshhier::progressive
