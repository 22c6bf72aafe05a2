// Pictures in a folder that is served: those that a story beside them names, and no others.
#pragma once

#include "storage/io/file.h"
#include "storage/io/folder.h"

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::server {

/// Finds the stories that name a picture. Remembers the names as long as the stories' files stay
/// the same. Thread-safe.
class StoryPictures {
 public:
  explicit StoryPictures(std::shared_ptr<const storage::Folder> folder)
      : folder_(std::move(folder)) {}

  /// Returns the hierarchies, by their paths, whose stories name that picture, which is there.
  /// Throws Error(io).
  std::vector<std::string> tellers_of(std::string_view picture);

 private:
  struct Known {
    storage::FileVersion version;
    std::vector<std::string> pictures;  ///< from the story's folder, ascending
  };

  bool names(const std::string& story, const std::string& picture);

  std::shared_ptr<const storage::Folder> folder_;
  std::mutex mutex_;  ///< guards known_
  std::map<std::string, Known> known_;
};

}  // namespace meshhier::server
