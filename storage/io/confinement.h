// A process that reads what nobody trusts gives up what it has no need of. A fault in a library
// then ends this process, and nothing else.
#pragma once

#include <cstdint>

namespace meshhier::storage {

/// From here on this process opens no file, writes none, makes no other process and leaves no core
/// behind; files that are open stay so. To be called once, when all libraries are loaded. Throws
/// Error(io).
void confine_process();

/// Limits what this process takes until the next call: memory beyond that of confine_process(),
/// where an allocation fails, and seconds of processor time, after which the process ends. Throws
/// Error(io).
void limit_work(std::uint64_t memory_bytes, std::uint64_t seconds);

}  // namespace meshhier::storage
