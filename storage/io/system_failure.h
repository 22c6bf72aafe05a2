// A system call that failed, as an exception.
#pragma once

#include <filesystem>

namespace meshhier::storage {

/// Throws Error(io): "cannot ACTION PATH: CAUSE", of an errno.
[[noreturn]] void fail_system(const char* action, const std::filesystem::path& path, int error);

}  // namespace meshhier::storage
