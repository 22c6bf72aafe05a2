// The memory that this process may use.
#pragma once

#include <cstdint>
#include <filesystem>

namespace meshhier::storage {

/// What keeps a process from using more.
enum class MemoryBound {
  machine,
  address_space,  ///< ulimit -v
  data,           ///< ulimit -d
  group           ///< a control group's
};

struct UsableMemory {
  std::uint64_t bytes = 0;
  MemoryBound bound = MemoryBound::machine;
};

/// Returns the least of these, as far as they can be read: the machine's memory; what the limit of
/// the process's address space leaves beside what it has mapped by now; the limit of its data; and
/// the limits of its control groups (versions 1 and 2) with all above them. `root`: the root of the
/// system's files, another one in tests. Thread-safe.
UsableMemory usable_memory(const std::filesystem::path& root = "/");

}  // namespace meshhier::storage
