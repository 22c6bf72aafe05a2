// Whether the files that a hierarchy was made of are still what its note says.
#pragma once

#include "storage/format/input_note.h"
#include "storage/io/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <utility>

namespace meshhier::storage {

/// For one thread. Files are looked at, never changed.
class NotedFiles {
 public:
  /// `folder`: that of the first file of the notes, where their paths start. `files` must outlive
  /// this.
  NotedFiles(FileSystem& files, std::filesystem::path folder)
      : files_(files), folder_(std::move(folder)) {}

  /// Returns one number for sizes and times of all that a note names but the first file, the mesh:
  /// as long as it stays, so do they, and nothing has appeared that was missing. 0 if there are
  /// none. Throws Error(io).
  std::uint64_t mark(const InputNote& note) const;

  /// Says whether a file that has gone counts as unchanged.
  enum class Gone { is_same, is_another };
  struct Question {
    std::size_t from = 0;  ///< the first file that is compared
    bool may_read = true;  ///< files of other times; else these are others
    Gone gone = Gone::is_another;
  };
  /// The result of compare().
  struct Comparison {
    std::optional<std::filesystem::path> other{};  ///< the first that is not what it was
    bool was_read = false;                         ///< files of other times were the same
  };
  /// Compares the files with the note, and looks whether one has appeared that was missing. `note`
  /// gets the times of those that were read and found the same. `check` is called before each read
  /// and may throw. Throws Error(io).
  Comparison compare(InputNote& note, const Question& question,
                     const std::function<void()>& check) const;

 private:
  /// Returns nothing if there is no regular file of that name.
  std::optional<FileIdentity> identity(const std::filesystem::path& path) const;
  std::optional<std::filesystem::path> appeared(const InputNote& note) const;
  bool has_content(const NotedFile& noted, const std::function<void()>& check) const;

  FileSystem& files_;
  std::filesystem::path folder_;
};

/// Compares also the times at which name and rights last changed.
bool is_untouched(const FileIdentity& a, const FileIdentity& b);

}  // namespace meshhier::storage
