// The files that belong to a mesh in a watched folder: its buffers, material libraries, pictures.
#pragma once

#include "storage/format/input_note.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

namespace meshhier::server {

/// Of one thread. Files are looked at, never changed.
class Companions {
 public:
  /// `folder`: of the meshes. `files` must outlive this.
  Companions(storage::FileSystem& files, std::filesystem::path folder)
      : files_(files), folder_(std::move(folder)) {}

  /// One number for sizes and times of all that a note names but the mesh: as long as it stays, so
  /// do they, and nothing has appeared that was missing. 0 if there are none. Throws Error(io).
  std::uint64_t mark(const storage::InputNote& note) const;

  /// Whether they are what the note says; one that is gone counts as unchanged, as a mesh that is
  /// gone does. Those of other times are read if `may_read`, else they are others; `note` gets the
  /// times of those that were read and found the same. `check` is called before each read and may
  /// throw. Throws Error(io).
  struct Comparison {
    bool is_same = true;
    bool was_read = false;
  };
  Comparison compare(storage::InputNote& note, bool may_read,
                     const std::function<void()>& check) const;

 private:
  /// None if there is no regular file of that name.
  std::optional<storage::FileIdentity> identity(const std::filesystem::path& path) const;
  bool has_appeared(const storage::InputNote& note) const;

  storage::FileSystem& files_;
  std::filesystem::path folder_;
};

/// With the time at which name and rights last changed.
bool is_untouched(const storage::FileIdentity& a, const storage::FileIdentity& b);

}  // namespace meshhier::server
