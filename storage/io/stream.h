// Files that take bytes as they come: FIFOs, character devices, standard output.
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <functional>
#include <memory>

namespace meshhier::storage {

/// Does what FileSystem::open_stream() promises; counts what is written in `counters`.
std::unique_ptr<File> open_posix_stream(const std::filesystem::path& path,
                                        std::shared_ptr<IoCounters> counters,
                                        const std::function<void()>& check);

/// Whether the path leads to what is open as this process's standard output.
bool is_own_output(const std::filesystem::path& path);

}  // namespace meshhier::storage
