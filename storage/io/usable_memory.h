// The memory that this process may use.
#pragma once

#include <cstdint>
#include <filesystem>

namespace meshhier::storage {

/// Returns, in bytes, the least of the machine's memory, the limit of the process's address space,
/// and the limits of its control groups (versions 1 and 2) with all above them, as far as they can
/// be read. `root`: the root of the system's files, another one in tests. Thread-safe.
std::uint64_t usable_memory(const std::filesystem::path& root = "/");

}  // namespace meshhier::storage
