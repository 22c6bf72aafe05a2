// Names of columns that are ids of things.
#pragma once

#include <array>
#include <string_view>

namespace meshhier::importing {

/// In small letters; the first one counts that tells all rows apart.
inline constexpr std::array<std::string_view, 10> kIdColumns{
    "gml:id", "gml_id", "gmlid", "globalid", "guid", "uuid", "id", "objectid", "fid", "batchid"};

}  // namespace meshhier::importing
