// A loop over parts of a range, by all threads.
#pragma once

#include <cstdint>
#include <functional>

namespace meshhier::partition {

/// Calls work(first, count) for parts of [0, count) of `part` or fewer, in any order, in parallel
/// on the caller's TBB arena. `part` > 0.
void for_each_part(std::uint64_t count, std::uint64_t part,
                   const std::function<void(std::uint64_t first, std::uint64_t count)>& work);

}  // namespace meshhier::partition
