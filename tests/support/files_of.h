// The files in a directory.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

namespace meshhier::tests {

/// The content of each file below it, by its path from there.
inline std::map<std::string, std::string> files_of(const std::filesystem::path& directory) {
  std::map<std::string, std::string> contents;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(directory)) {
    if (entry.is_regular_file()) {
      std::ifstream stream(entry.path(), std::ios::binary);
      contents[entry.path().lexically_relative(directory).string()] =
          std::string(std::istreambuf_iterator<char>(stream), {});
    }
  }
  return contents;
}

}  // namespace meshhier::tests
