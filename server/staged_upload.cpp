#include "server/staged_upload.h"

#include "base/error.h"
#include "storage/format/layout.h"

#include <optional>
#include <random>
#include <utility>

#include <fmt/format.h>

namespace meshhier::server {
namespace {

/// An upload's files are named as those of any output under way; by this they are known as uploads.
constexpr const char* kPrefix = "upload-";

/// Returns another name for each upload, of whatever server: it has 64 random bits.
std::string new_name() {
  std::random_device random;
  return fmt::format("{}{:08x}{:08x}", kPrefix, random(), random());
}

}  // namespace

StagedUpload::StagedUpload(storage::FileSystem& files, std::filesystem::path inbox)
    : files_(files), inbox_(std::move(inbox)) {
  const std::filesystem::path place = inbox_ / new_name();
  lock_ = files_.try_lock(storage::output_lock_path(place));
  path_ = storage::unfinished_path(place);
}

StagedUpload::~StagedUpload() {
  try {
    if (!path_.empty())
      files_.remove_all(path_);
  } catch (const Error&) {  // the next server removes it
  }
}

bool StagedUpload::publish(const std::string& name) {
  if (!files_.rename_new(path_, inbox_ / name))
    return false;
  path_.clear();
  files_.sync_directory(inbox_);
  return true;
}

void remove_stale_uploads(storage::FileSystem& files, const std::filesystem::path& inbox) {
  for (const std::filesystem::path& child : files.children(inbox)) {
    const auto left = storage::leftover_name(child.filename().string());
    if (!left || left->kind != storage::Leftover::unfinished || !left->output.starts_with(kPrefix))
      continue;
    const std::filesystem::path place = inbox / left->output;
    const auto lock = files.try_lock(storage::output_lock_path(place));
    if (lock)
      files.remove_all(storage::unfinished_path(place));
  }
}

}  // namespace meshhier::server
