// Files that take bytes as they come: FIFOs, character devices, standard output; and standard
// input.
#pragma once

#include "storage/io/file.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>

namespace meshhier::storage {

/// Does what FileSystem::open_stream() promises; counts what is written in `counters`.
std::unique_ptr<File> open_posix_stream(const std::filesystem::path& path,
                                        std::shared_ptr<IoCounters> counters,
                                        const std::function<void()>& check);

/// Reads what comes next on standard input, up to to.size() bytes; returns how many, 0 at its end.
/// Calls `check` at least every 50 ms of waiting; it may throw. Throws Error(io).
std::size_t read_standard_input(std::span<std::byte> to, const std::function<void()>& check);

/// Whether the path leads to what is open as this process's standard output.
bool is_own_output(const std::filesystem::path& path);

}  // namespace meshhier::storage
