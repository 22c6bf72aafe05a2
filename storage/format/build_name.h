// The name of a build tells the files of one build of a hierarchy from those of another: it is the
// manifest's checksum, which covers that of the index, which covers those of all tiles.
#pragma once

#include "base/error.h"
#include "storage/format/manifest.h"
#include "storage/io/file.h"

#include <filesystem>
#include <string>

namespace meshhier::storage {

/// Returns the name of a build, sixteen digits. `manifest_text`: one that parse_manifest() has
/// taken.
std::string build_name(const std::string& manifest_text);

/// An Error(io) that says nothing about a hierarchy: another build took its place while it was
/// read.
class Replaced final : public Error {
 public:
  explicit Replaced(const std::filesystem::path& hierarchy);
};

/// Throws Replaced if the manifest that is there now belongs to another build than `opened`, which
/// was read there before: files of the two do not fit together. Returns if it is the same, or if
/// none can be read: then it was not another build that did the harm.
void require_same_build(FileSystem& files, const std::filesystem::path& hierarchy,
                        const Manifest& opened);

/// Returns what `read` does. Where a file is missing or is not what it should be because another
/// build has taken its place, that is said instead (Replaced).
template <class Read>
auto of_one_build(FileSystem& files, const std::filesystem::path& hierarchy, const Manifest& opened,
                  const Read& read) {
  try {
    return read();
  } catch (const Error& error) {
    if (error.code() == ErrorCode::corrupt || error.code() == ErrorCode::io)
      require_same_build(files, hierarchy, opened);
    throw;
  }
}

}  // namespace meshhier::storage
