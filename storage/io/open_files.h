// How many files this process may have open.
#pragma once

#include <cstdint>

namespace meshhier::storage {

/// As the system lets it now (ulimit -n); the largest number where there is no limit.
std::uint64_t most_open_files();

}  // namespace meshhier::storage
