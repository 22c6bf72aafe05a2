#include "server/story_pictures.h"

#include "server/folder_scan.h"
#include "storage/format/layout.h"
#include "storage/format/story_pictures.h"

#include <algorithm>
#include <cstddef>
#include <optional>

namespace meshhier::server {
namespace {

/// The pictures of so many stories are remembered; others are read again.
constexpr std::size_t kMostKnown = 1000;

std::vector<std::string> read_pictures(const storage::File& story) {
  const auto bytes = storage::read_file(story, storage::kMostStoryBytes);
  return storage::pictures_beside({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace

std::vector<std::string> StoryPictures::tellers_of(std::string_view picture) {
  if (!storage::is_picture_name(picture) || !folder_->open(picture))
    return {};
  std::vector<std::string> tellers;
  for (std::size_t slash = picture.rfind('/');;) {
    const bool is_top = slash == std::string_view::npos;
    const std::string place(picture.substr(0, is_top ? 0 : slash));
    const std::string name(picture.substr(is_top ? 0 : slash + 1));
    for (const storage::FolderEntry& entry : folder_->entries(place)) {
      const auto told = storage::told_of(entry.name);
      if (told && !entry.is_directory && names(joined(place, entry.name), name))
        tellers.push_back(joined(place, std::string(*told)));
    }
    if (is_top)
      return tellers;
    slash = slash == 0 ? std::string_view::npos : picture.rfind('/', slash - 1);
  }
}

bool StoryPictures::names(const std::string& story, const std::string& picture) {
  const auto file = folder_->open(story);
  if (!file || file->size() > storage::kMostStoryBytes)
    return false;
  const storage::FileVersion version = file->version();
  {
    const std::lock_guard lock(mutex_);
    const auto found = known_.find(story);
    if (found != known_.end() && found->second.version == version)
      return std::ranges::binary_search(found->second.pictures, picture);
  }
  Known known{version, read_pictures(*file)};
  const bool is_named = std::ranges::binary_search(known.pictures, picture);
  const std::lock_guard lock(mutex_);
  if (known_.size() >= kMostKnown)
    known_.clear();
  known_[story] = std::move(known);
  return is_named;
}

}  // namespace meshhier::server
