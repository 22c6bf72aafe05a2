// The files that belong to a mesh in a watched folder: its buffers, material libraries, pictures.
#pragma once

#include "storage/format/input_note.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

namespace meshhier::server {

/// For one thread. Files are looked at, never changed.
class Companions {
 public:
  /// `folder`: the meshes'. `files` must outlive this.
  Companions(storage::FileSystem& files, std::filesystem::path folder)
      : files_(files), folder_(std::move(folder)) {}

  /// Returns one number for sizes and times of all that a note names but the mesh: as long as it
  /// stays, so do they, and nothing has appeared that was missing. 0 if there are none. Throws
  /// Error(io).
  std::uint64_t mark(const storage::InputNote& note) const;

  /// The result of compare().
  struct Comparison {
    bool is_same = true;
    bool was_read = false;
  };
  /// Compares the files with the note; one that is gone counts as unchanged, as a mesh that is gone
  /// does. Files of other times are read if `may_read`, else they are others; `note` gets the times
  /// of those that were read and found the same. `check` is called before each read and may throw.
  /// Throws Error(io).
  Comparison compare(storage::InputNote& note, bool may_read,
                     const std::function<void()>& check) const;

 private:
  /// Returns nothing if there is no regular file of that name.
  std::optional<storage::FileIdentity> identity(const std::filesystem::path& path) const;
  bool has_appeared(const storage::InputNote& note) const;

  storage::FileSystem& files_;
  std::filesystem::path folder_;
};

/// Compares also the times at which name and rights last changed.
bool is_untouched(const storage::FileIdentity& a, const storage::FileIdentity& b);

}  // namespace meshhier::server
