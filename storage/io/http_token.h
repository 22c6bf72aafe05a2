// The words that HTTP's methods and names of headers are.
#pragma once

#include <algorithm>
#include <string_view>

namespace meshhier::storage {

/// Returns whether a text is a token of RFC 9110, section 5.6.2.
inline bool is_http_token(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
  });
}

}  // namespace meshhier::storage
