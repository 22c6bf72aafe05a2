// What separates the parts of HTTP.
#pragma once

#include <string_view>

namespace meshhier::server {

/// The end of HTTP's lines, and that of a head: its last line's with the empty one behind it.
inline constexpr std::string_view kLineEnd = "\r\n";
inline constexpr std::string_view kHeadEnd = "\r\n\r\n";

}  // namespace meshhier::server
