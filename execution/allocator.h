// The allocator, set up for a memory budget.
#pragma once

#include <cstdint>

namespace meshhier::execution {

/// Sets the allocator up for a budget of resident bytes: decides how much freed memory is kept for
/// use again. It counts for the whole process: call it once, before other threads work.
void configure_allocator(std::uint64_t budget_bytes);
/// Gives free memory back to the system. Thread-safe.
void release_free_memory();
/// Does the same if more than three quarters of the budget are resident. Else free memory is used
/// again: each page that was given back would have to be made anew.
void release_free_memory(std::uint64_t budget_bytes);

}  // namespace meshhier::execution
