// The allocator, set up for a memory budget.
#pragma once

#include <cstdint>

namespace meshhier::execution {

/// Sets the allocator up so that freed memory goes back to the system: the budget is about what is
/// resident.
void configure_allocator(std::uint64_t budget_bytes);
/// Gives free memory back, between stages.
void release_free_memory();

}  // namespace meshhier::execution
