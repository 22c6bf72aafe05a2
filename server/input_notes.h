// Which checksum a watched file had: kept beside its hierarchy, so that a restart need not read it.
#pragma once

#include "storage/io/file.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace meshhier::server {

/// A note counts as long as the file is the very one it was written for: its inode, size and both
/// times. Its device does not count: that has another number after the machine was started anew.
class InputNotes {
 public:
  /// Beside the hierarchies in `folder`. `files` must outlive this.
  InputNotes(storage::FileSystem& files, std::shared_ptr<const storage::Folder> folder);

  /// The checksum of the file of that version. Nothing if there is no note, or it is damaged.
  std::optional<std::uint64_t> find(const std::string& hierarchy,
                                    const storage::FileVersion& version) const;
  /// Requires that the file had this checksum while it was of that version. Throws Error(io).
  void write(const std::string& hierarchy, const storage::FileVersion& version,
             std::uint64_t checksum) const;

 private:
  storage::FileSystem& files_;
  std::shared_ptr<const storage::Folder> folder_;
};

}  // namespace meshhier::server
