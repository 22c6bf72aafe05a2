#include "server/input_notes.h"

#include "storage/format/layout.h"

#include <utility>

namespace meshhier::server {

InputNotes::InputNotes(storage::FileSystem& files, std::shared_ptr<const storage::Folder> folder)
    : files_(files), folder_(std::move(folder)) {}

std::filesystem::path InputNotes::path(const std::string& hierarchy) const {
  return folder_->path() / storage::input_note_path(hierarchy);
}

std::optional<storage::InputNote> InputNotes::find(const std::string& hierarchy) const {
  return storage::find_input_note(files_, path(hierarchy));
}

void InputNotes::write(const std::string& hierarchy, const storage::InputNote& note) const {
  storage::write_input_note(files_, path(hierarchy), note);
}

}  // namespace meshhier::server
