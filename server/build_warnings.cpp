#include "server/build_warnings.h"

#include "base/error.h"
#include "storage/format/input_note.h"
#include "storage/format/layout.h"
#include "storage/io/system_failure.h"

#include <cstddef>

namespace meshhier::server {
namespace {

constexpr std::size_t kMostNotes = 1000;

}  // namespace

std::vector<std::string> BuildWarnings::of(const Model& model) {
  try {
    Noted found = noted(model);
    return found.content == model.source_checksum ? std::move(found.warnings)
                                                  : std::vector<std::string>();
  } catch (const storage::Busy&) {
    throw;
  } catch (const Error&) {
    return {};
  }
}

/// Returns what the note says; nothing if there is none: only watched folders write them.
BuildWarnings::Noted BuildWarnings::noted(const Model& model) {
  const std::string name = storage::input_note_path(model.path).generic_string();
  const auto file = model.path.empty() ? nullptr : folder_->open(name);
  if (!file)
    return {};
  const storage::FileVersion version = file->version();
  {
    const std::lock_guard lock(mutex_);
    const auto found = noted_.find(model.path);
    if (found != noted_.end() && found->second.version == version)
      return found->second;
  }
  storage::InputNote read = storage::read_input_note(*file, name);
  const std::lock_guard lock(mutex_);
  if (noted_.size() >= kMostNotes)
    noted_.clear();
  return noted_[model.path] = {version, read.content, std::move(read.warnings)};
}

}  // namespace meshhier::server
