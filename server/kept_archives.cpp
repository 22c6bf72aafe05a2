#include "server/kept_archives.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace meshhier::server {
namespace {

/// A screenful of models. Each open archive holds 32 bytes a file of its own, and an open file.
constexpr std::size_t kMostKept = 16;

}  // namespace

std::shared_ptr<const storage::Archive> KeptArchives::get(const std::string& path,
                                                          std::unique_ptr<storage::File> file) {
  const storage::FileVersion version = file->version();
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(kept_, path, &Kept::path);
    if (found != kept_.end() && found->version == version) {
      kept_.splice(kept_.begin(), kept_, found);
      return found->archive;
    }
  }
  auto opened = std::make_shared<const storage::Archive>(std::move(file));
  const std::lock_guard lock(mutex_);
  kept_.remove_if([&](const Kept& kept) { return kept.path == path; });
  kept_.push_front({path, version, opened});
  if (kept_.size() > kMostKept)
    kept_.pop_back();
  return opened;
}

}  // namespace meshhier::server
