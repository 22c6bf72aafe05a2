// What this process holds of the machine at this moment.
#pragma once

#include <cstdint>

namespace meshhier::storage {

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
