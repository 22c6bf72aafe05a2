// Other processes of this machine that work on the same file system.
#pragma once

#include "storage/io/descriptor.h"

#include <filesystem>
#include <string_view>
#include <vector>

namespace meshhier::storage {

/// Returns the topmost directory, above a directory that is there, on the same file system; an
/// empty path if it is not there.
std::filesystem::path file_system_root(const std::filesystem::path& directory);

/// A file system that knows who else uses it: that of this machine.
class SharedFileSystem {
 public:
  virtual ~SharedFileSystem() = default;
  /// As the function below.
  virtual std::vector<std::filesystem::path> locked_files(const std::filesystem::path& directory,
                                                          std::string_view ending) const = 0;
};

/// Returns the files on the file system of `directory` that end in `ending` and that processes of
/// this user have open while they hold a lock; those of this one, too. Each
/// once, ascending, without links. Files of processes in another root or mount are missing. What
/// cannot be looked at counts as if it were not there; never throws.
std::vector<std::filesystem::path> locked_files(const std::filesystem::path& directory,
                                                std::string_view ending);

/// As long as it lives, no other process of this machine has the turn on that file system: for
/// things that take no time. Waits up to 3 s for it, then goes on without, and so it does where a
/// file system has no locks, or its topmost directory may not be read; never throws.
class DeviceTurn {
 public:
  /// `directory`: any on the file system.
  explicit DeviceTurn(const std::filesystem::path& directory);

 private:
  Descriptor root_;
};

}  // namespace meshhier::storage
