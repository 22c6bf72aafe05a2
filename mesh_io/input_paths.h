// The mesh files of a job: one, or several that are joined in their order.
#pragma once

#include <algorithm>
#include <concepts>
#include <filesystem>
#include <string>
#include <vector>

namespace meshhier::mesh_io {

struct InputPaths : std::vector<std::filesystem::path> {
  InputPaths() = default;
  template <class Path>
  requires std::convertible_to<Path, std::filesystem::path> InputPaths(const Path& path)
      : vector{std::filesystem::path(path)} {}

  /// Returns the paths with ", " between them, for messages.
  std::string string() const {
    std::string text;
    for (const std::filesystem::path& path : *this)
      text += (text.empty() ? "" : ", ") + path.string();
    return text;
  }
  friend bool operator==(const InputPaths& a, const InputPaths& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  }
};

}  // namespace meshhier::mesh_io
