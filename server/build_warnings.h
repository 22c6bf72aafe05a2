// What the builds of a watched folder warned of, as the notes beside the hierarchies say.
#pragma once

#include "server/model.h"
#include "storage/io/file.h"
#include "storage/io/folder.h"

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace meshhier::server {

/// Remembers notes as long as their files stay the same. Thread-safe.
class BuildWarnings {
 public:
  explicit BuildWarnings(std::shared_ptr<const storage::Folder> folder)
      : folder_(std::move(folder)) {}

  /// Returns the warnings of a model's build. A note that cannot be read, is damaged or is of
  /// another build tells nothing. Throws storage::Busy.
  std::vector<std::string> of(const Model& model);

 private:
  struct Noted {
    storage::FileVersion version;
    std::uint64_t content = 0;  ///< identifies the hierarchy that it is about
    std::vector<std::string> warnings;
  };
  Noted noted(const Model& model);

  std::shared_ptr<const storage::Folder> folder_;
  std::mutex mutex_;  ///< guards all below
  std::map<std::string, Noted> noted_;
};

}  // namespace meshhier::server
