// The first bytes of objects.bin, by which it is known.
#pragma once

#include <string_view>

namespace meshhier::storage {

inline constexpr std::string_view kObjectTableMagic = "MHTABLE\n";

}  // namespace meshhier::storage
