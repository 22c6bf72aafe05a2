// A folder as it may be served: hierarchies of all kinds, a stream, and what is nobody's business.
#pragma once

#include "config/config.h"
#include "storage/io/file.h"
#include "tests/support/sample_hierarchy.h"

#include <filesystem>
#include <string>

namespace meshhier::tests {

/// Writes a small mesh of its own to `path` and builds a hierarchy from it.
void build_small(const std::filesystem::path& mesh, const std::filesystem::path& output,
                 storage::Compression compression = storage::Compression::none,
                 std::size_t triangles = 600);

/// clang-format off
///   models/plain.hier            the source is plain.ply
///   models/sub dir/zipped.hier   tiles are gzip members
///   models/packed.3tz            an archive of such tiles
///   models/stream.prog           a progressive stream
///   models/broken.hier           its manifest is none
///   models/notes.txt
///   secret.txt                   beside what is served
///   viewer/index.html, viewer/assets/page-1a2b.js
/// clang-format on
/// Made anew for each object; hierarchies are built once a process.
class ServedFolder {
 public:
  ServedFolder();
  std::filesystem::path path() const { return directory_.path(); }
  std::filesystem::path models() const { return path() / "models"; }
  std::filesystem::path viewer() const { return path() / "viewer"; }

 private:
  TemporaryDirectory directory_;
};

std::string text_of(const std::filesystem::path& path);
void write_text(const std::filesystem::path& path, const std::string& text);

/// The content of a file that lies in an archive.
std::string text_in_archive(const std::filesystem::path& archive, const std::string& name);

}  // namespace meshhier::tests
