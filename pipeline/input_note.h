// The note on the files that a hierarchy was made of, and on the build that made it.
#pragma once

#include "config/config.h"
#include "import/input_record.h"
#include "storage/format/input_note.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <functional>

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

/// Paths as notes have them: they start at the folder of the first mesh, as that may move.
class NotePaths {
 public:
  /// `first`: the first mesh. `files` must outlive this.
  NotePaths(const std::filesystem::path& first, storage::FileSystem& files);

  const std::filesystem::path& folder() const { return folder_; }
  /// Returns a file's path in notes; that of the archive that it lies in, if it does.
  std::filesystem::path operator()(const std::filesystem::path& path) const;

 private:
  storage::FileSystem& files_;
  std::filesystem::path folder_;
};

/// Returns an object that is another one for each program, config of another result, and list of
/// files that the config names. Equal to itself once it was written and read.
nlohmann::ordered_json build_key(const config::Config& config, const NotePaths& paths);

/// Returns the note on an input; archives are read once more, for their checksums. `content`: the
/// hierarchy's `source.checksum`. `check` is called before each read and may throw. Throws
/// Error(io).
storage::InputNote note_of(const importing::InputRecord& input, std::uint64_t content,
                           const config::Config& config, storage::FileSystem& files,
                           const std::function<void()>& check);

}  // namespace meshhier::pipeline
