// Archives that were asked for last stay open, with the places of their files.
#pragma once

#include "storage/format/archive.h"
#include "storage/io/file.h"

#include <list>
#include <memory>
#include <mutex>
#include <string>

namespace meshhier::server {

/// Thread-safe.
class KeptArchives {
 public:
  /// Returns the archive in `file`, which lies at `path` now: a kept one, if it is of this version.
  /// Throws what storage::Archive throws.
  std::shared_ptr<const storage::Archive> get(const std::string& path,
                                              std::unique_ptr<storage::File> file);

 private:
  struct Kept {
    std::string path;
    storage::FileVersion version;
    std::shared_ptr<const storage::Archive> archive;
  };
  std::mutex mutex_;      ///< guards all below
  std::list<Kept> kept_;  ///< the one used last first
};

}  // namespace meshhier::server
