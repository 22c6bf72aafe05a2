// Texts that may not be UTF-8.
#pragma once

#include <string>
#include <string_view>

namespace meshhier {

/// Returns `text` in UTF-8 (RFC 3629): each byte that is part of no character becomes U+FFFD.
std::string sound_utf8(std::string_view text);
/// Returns `text` in UTF-8: each byte that is part of no character becomes that of Windows-1252, as
/// tables and names of Western Europe have them, or U+FFFD where that has none.
std::string utf8_of_windows(std::string_view text);

}  // namespace meshhier
