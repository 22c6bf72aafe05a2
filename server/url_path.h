// The path of a request as names of files, and back. Where a trick would be played, it ends here.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace meshhier::server {

/// The path of `target` (what stands behind GET; a query is dropped) decoded: relative, "" for "/",
/// parts joined by '/'. Nothing if it could mean anything but plain names downwards: it does not
/// begin with '/', a part is empty or begins with a dot, an escape is broken, a part holds (escaped
/// or not) a slash, a backslash, or a control character; or it is longer than file systems allow.
/// It is decoded once: what is escaped twice is a name with a '%' in it.
std::optional<std::string> decode_path(std::string_view target);

/// What a target's query says of `key`, as it was sent: "1f" of "/a?build=1f&x=1". Nothing if it
/// says nothing of it.
std::optional<std::string_view> query_value(std::string_view target, std::string_view key);

/// Whether `name` is a file's name that a path may have as a part.
bool is_plain_name(std::string_view name);

/// The inverse of one or several parts: bytes other than letters, digits, "-._~/" become %XX.
std::string encode_path(std::string_view path);

}  // namespace meshhier::server
