// Memory budgets beside the limits of the process.
#pragma once

#include "storage/io/usable_memory.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace meshhier::execution {

/// Returns the budget of those who set none: a quarter of what the process may use, from 512 MiB to
/// 16 GiB, in whole MiB, and at most most_budget().
std::uint64_t default_budget(const storage::UsableMemory& usable = storage::usable_memory());

/// Returns the most that a budget should be: three quarters of what the process may use, in whole
/// MiB. The rest is for what no budget counts: stacks of threads, what the allocator keeps, the
/// program itself.
std::uint64_t most_budget(const storage::UsableMemory& usable = storage::usable_memory());

/// Returns a warning for a budget beyond a limit that was set for the process, or the machine's
/// memory; empty if it is below. `name`: how people set it, "memory_budget".
std::string budget_warning(std::string_view name, std::uint64_t budget_bytes,
                           const storage::UsableMemory& usable = storage::usable_memory());

}  // namespace meshhier::execution
