// The program that runs: where it is, and how to start it again.
//
// In the portable archive (packaging/portable/launcher.cpp) what runs is the loader that came with
// it: the launcher says by MESHHIER_PROGRAM where it lies itself. Without /proc the path counts by
// which the process was started.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace meshhier::storage {

/// Returns a path that starts the program again, even if its file is not there any more.
std::string own_program();
/// Returns the directory that its file lies in. Throws Error(io) if that cannot be known.
std::string own_directory();
/// Returns the path of the file with its code, for reading: it differs between versions.
std::string own_code();

/// A folder with files that come with the program.
class CompanionFolder {
 public:
  /// Takes the folder that the environment variable names, else the first of `places`, seen from
  /// own_directory(), that has `file`, else the last of them. Throws as own_directory().
  CompanionFolder(const char* variable, std::span<const char* const> places, const char* file);

  const std::filesystem::path& path() const { return path_; }
  bool has(const char* file) const;

 private:
  std::filesystem::path path_;
};

}  // namespace meshhier::storage
