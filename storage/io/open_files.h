// The number of files that this process may have open.
#pragma once

#include <cstdint>

namespace meshhier::storage {

/// Returns how many the system allows now (ulimit -n); UINT64_MAX where there is no limit.
std::uint64_t most_open_files();

}  // namespace meshhier::storage
