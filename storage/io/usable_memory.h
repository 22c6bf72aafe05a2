// How much memory this process may use.
#pragma once

#include <cstdint>
#include <filesystem>

namespace meshhier::storage {

/// The least of the machine's memory, the limit of the process's address space, and the limits of
/// its control groups (versions 1 and 2) with all above them, as far as they can be read. `root`:
/// of the system's files, for tests. Thread-safe.
std::uint64_t usable_memory(const std::filesystem::path& root = "/");

}  // namespace meshhier::storage
