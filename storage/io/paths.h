// Arithmetic of paths: no function here looks at a file.
#pragma once

#include "base/small_letters.h"

#include <algorithm>
#include <filesystem>
#include <string>

namespace meshhier::storage {

/// Whether `path` is `place` or lies below it, both as they are written.
inline bool is_within(const std::filesystem::path& path, const std::filesystem::path& place) {
  return std::mismatch(place.begin(), place.end(), path.begin(), path.end()).first == place.end();
}

/// Returns the ending of a path's name, with letters of ASCII small: ".glb" for "a.GLB".
inline std::string lower_extension(const std::filesystem::path& path) {
  return small_letters(path.extension().string());
}

/// Returns "a/b" for "a/b/", which names the same place.
inline std::filesystem::path without_last_slash(const std::filesystem::path& path) {
  return path.has_filename() ? path : path.parent_path();
}

}  // namespace meshhier::storage
