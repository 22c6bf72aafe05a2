// Appends values to channels, as vertices have them.
#pragma once

#include "hierarchy/scalar_value.h"

#include <cstddef>
#include <vector>

namespace meshhier::importing {

inline void append_value(ValueType type, double value, std::vector<float>& channels) {
  const std::size_t first = channels.size();
  channels.resize(first + static_cast<std::size_t>(channels_of(type)));
  put_value(type, value, channels.data() + first);
}

}  // namespace meshhier::importing
