// The check of an option's value.
#pragma once

#include "base/error.h"

#include <type_traits>

#include <fmt/format.h>

namespace meshhier::bench {

/// Throws Error(usage) that names the option unless low <= value <= high.
template <class T>
void require_range(const char* option, T value, std::type_identity_t<T> low,
                   std::type_identity_t<T> high) {
  if (!(value >= low && value <= high)) {
    throw Error(ErrorCode::usage,
                fmt::format("{} must be from {} to {}, found {}", option, low, high, value));
  }
}

}  // namespace meshhier::bench
