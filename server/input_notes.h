// Notes of the files that the hierarchies of a watched folder were made of: kept beside them, so
// that a restart need not read the files. A build writes a note when it is done.
#pragma once

#include "storage/format/input_note.h"
#include "storage/io/file.h"
#include "storage/io/folder.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace meshhier::server {

class InputNotes {
 public:
  /// Notes are beside the hierarchies in `folder`. `files` must outlive this.
  InputNotes(storage::FileSystem& files, std::shared_ptr<const storage::Folder> folder);

  std::filesystem::path path(const std::string& hierarchy) const;
  /// Returns nothing if there is no note, or it is damaged.
  std::optional<storage::InputNote> find(const std::string& hierarchy) const;
  /// Writes a note, which is there complete or not at all. Throws as storage::OutputFile.
  void write(const std::string& hierarchy, const storage::InputNote& note) const;

 private:
  storage::FileSystem& files_;
  std::shared_ptr<const storage::Folder> folder_;
};

}  // namespace meshhier::server
