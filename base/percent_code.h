// Parts of addresses, in which %2F stands for a character (RFC 3986, section 2.1).
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace meshhier {

/// The bytes that a part of an address stands for; nothing if a % is not followed by two
/// hexadecimal digits. What they are is for the caller to check.
std::optional<std::string> percent_decoded(std::string_view part);

/// Returns the text as a part of a query: bytes other than letters, digits and "-_.!~*'()" become
/// %XX, as those of encodeURIComponent() of JavaScript.
std::string percent_encoded(std::string_view text);

}  // namespace meshhier
