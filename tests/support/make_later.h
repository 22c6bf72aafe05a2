// Times of files for tests that change one.
#pragma once

#include <chrono>
#include <filesystem>

namespace meshhier::tests {

/// Gives a file a later time, as a change has. That of a change which comes at once may be the
/// same: many systems count the time of files in steps of up to 10 ms.
inline void make_later(const std::filesystem::path& file) {
  std::filesystem::last_write_time(file,
                                   std::filesystem::last_write_time(file) + std::chrono::hours(1));
}

}  // namespace meshhier::tests
