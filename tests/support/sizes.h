// Units of memory, for tests of budgets.
#pragma once

#include <cstdint>

namespace meshhier::tests {

inline constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
inline constexpr std::uint64_t kGiB = std::uint64_t{1} << 30;

}  // namespace meshhier::tests
