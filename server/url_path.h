// Turns the path of a request into names of files, and back. Paths that could be a trick end here.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace meshhier::server {

/// Decodes the path of `target`, the word behind GET, without its query: relative, "" for "/",
/// parts joined by '/'. Returns nothing if it could mean anything but plain names downwards: it
/// does not begin with '/', a part is empty or begins with a dot, an escape is broken, a part holds
/// (escaped or not) a slash, a backslash, or a control character; or it is longer than file systems
/// allow. It is decoded once: a name that is escaped twice has a '%' in it.
std::optional<std::string> decode_path(std::string_view target);

/// Returns the value of `key` in a target's query, as it was sent: "1f" for build in
/// "/a?build=1f&x=1". Nothing if the query does not have the key.
std::optional<std::string_view> query_value(std::string_view target, std::string_view key);

/// Whether `name` is a file's name that a path may have as a part.
bool is_plain_name(std::string_view name);

/// Encodes one or several parts: bytes other than letters, digits, "-._~/" become %XX.
std::string encode_path(std::string_view path);

}  // namespace meshhier::server
