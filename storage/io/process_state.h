// What this process holds of the machine at this moment.
#pragma once

#include <cstdint>
#include <string_view>

namespace meshhier::storage {

/// Returns the number behind a key of /proc/self/status, "VmRSS:"; sizes there are in units of
/// kStatusUnit bytes. 0 if there is none. Thread-safe; takes some 20 microseconds.
std::uint64_t status_number(std::string_view key);
inline constexpr std::uint64_t kStatusUnit = 1024;

/// A figure that the system does not tell is 0.
struct ProcessState {
  std::uint64_t resident_bytes = 0;
  std::uint64_t virtual_bytes = 0;
  std::uint64_t threads = 0;
  std::uint64_t open_files = 0;
};

/// Thread-safe.
ProcessState process_state();

}  // namespace meshhier::storage
