// Arithmetic of paths; looks at no file.
#pragma once

#include <algorithm>
#include <filesystem>

namespace meshhier::storage {

/// Whether `path` is `place` or lies below it, both as they are written.
inline bool is_within(const std::filesystem::path& path, const std::filesystem::path& place) {
  return std::mismatch(place.begin(), place.end(), path.begin(), path.end()).first == place.end();
}

}  // namespace meshhier::storage
