// URIs of a glTF file: files beside it, and files that are written within it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

/// Returns the text behind "data:...;base64,"; nothing if it is no such URI.
std::optional<std::string_view> base64_of(std::string_view uri);

/// Decodes base64 (RFC 4648), with padding or without, and hands it out in pieces of at most 48
/// KiB; false at the first character that is none of it.
bool decode_base64(std::string_view text, const std::function<void(std::span<const std::byte>)>&);

/// Returns the names of a file that a URI may mean: decoded from its percent codes, and as it is.
std::vector<std::string> names_of_uri(std::string_view uri);

/// Returns the file that a relative URI names from `folder`, percent-decoded. Nothing if it has a
/// scheme or a host, is absolute, or has parts "..": such files are not opened.
std::optional<std::filesystem::path> file_of_uri(std::string_view uri,
                                                 const std::filesystem::path& folder);

}  // namespace meshhier::mesh_io
