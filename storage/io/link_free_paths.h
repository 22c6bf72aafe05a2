// Paths on which no link is followed, whoever makes one at whatever moment.
#pragma once

#include "storage/io/descriptor.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::storage {

/// Opens `name` from the directory `start` as openat(2) does, part by part; empty parts count as
/// none. If it fails, there is no descriptor, and errno says why: ELOOP if a part is a link, unless
/// it is the last and `flags` have O_PATH.
Descriptor open_parts(int start, const std::filesystem::path& name, int flags);

/// Returns the names in a directory that was opened for reading, in no order; without "." and "..".
/// Throws Error(io), which names `path`.
std::vector<std::string> names_in(Descriptor directory, const std::filesystem::path& path);

/// Opens paths by the rule of InputRule; ".." takes back the part before it. Thread-safe.
class LinkFreePaths {
 public:
  explicit LinkFreePaths(const std::optional<std::filesystem::path>& within);

  /// Opens as open_parts() does; errno is EXDEV for what lies elsewhere. A link gets no descriptor,
  /// whatever `flags` are.
  Descriptor open(const std::filesystem::path& path, int flags) const;
  /// Throws Error(io) for a path that open() has failed for with `error`.
  [[noreturn]] void fail(const char* action, const std::filesystem::path& path, int error) const;

 private:
  std::filesystem::path within_;  ///< absolute; empty: anywhere
};

}  // namespace meshhier::storage
