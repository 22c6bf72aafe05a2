// The mesh files of a build: what they are, and whether they can be read where they lie.
#pragma once

#include "execution/cancel.h"
#include "hierarchy/published.h"
#include "mesh_io/input_paths.h"
#include "mesh_io/mesh_format.h"
#include "mesh_io/mesh_source.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace meshhier::importing {

/// Whether textures that a mesh names are used, or passed over as if there were none.
enum class Textures : std::uint8_t { use, ignore };

/// A file that another one is not whole without: a buffer of a glTF.
struct CompanionFile {
  std::filesystem::path path;
  storage::FileIdentity identity;
};

struct InputFileFacts {
  std::filesystem::path path;
  mesh_io::MeshFormat format;
  storage::FileIdentity identity;
  std::vector<CompanionFile> companions{};  ///< those that are there
  bool names_textures = false;              ///< a PLY that is read with its pictures

  bool is_plain_ply() const { return format.kind == mesh_io::MeshKind::ply && !format.is_gzip; }
  /// What its content is called in messages when it is no longer packed.
  std::string unpacked_name() const { return path.string() + " (unpacked)"; }
};

class InputFiles {
 public:
  /// Looks at what each file is. Throws as mesh_io::detect_format.
  InputFiles(storage::FileSystem& files, const mesh_io::InputPaths& paths, bool weld,
             Textures textures = Textures::use);

  const std::vector<InputFileFacts>& all() const { return all_; }
  bool weld() const { return weld_; }
  Textures textures() const { return textures_; }
  /// Not one PLY that is read in place as it is.
  bool needs_import() const {
    return weld_ || all_.size() != 1 || !all_[0].is_plain_ply() || all_[0].names_textures;
  }

  /// One packed PLY, to be unpacked and nothing else.
  bool is_unpacked_only() const {
    return !weld_ && all_.size() == 1 && all_[0].format.kind == mesh_io::MeshKind::ply &&
           !all_[0].names_textures;
  }

  /// File names, with ", " between them.
  std::string name() const;
  /// What the mesh that they are imported to is called in messages.
  std::string imported_name() const;
  /// Of all files, companions among them.
  std::uint64_t bytes() const;
  /// One number for the times of all files: as long as it stays, so does what is in them.
  std::int64_t times() const;
  /// Throws Error(input) if a file is not what it was any more.
  void check_unchanged() const;
  /// As SourceSummary's. Reads all files.
  std::uint64_t checksum(const execution::CancelToken& cancel) const;

 private:
  void find_companions(InputFileFacts& file, const storage::File& content) const;
  /// Calls `visit(path, identity)` for each file, its companions behind it.
  template <class Visit>
  void for_each_file(const Visit& visit) const {
    for (const InputFileFacts& file : all_) {
      visit(file.path, file.identity);
      for (const CompanionFile& companion : file.companions)
        visit(companion.path, companion.identity);
    }
  }

  storage::FileSystem& files_;
  std::vector<InputFileFacts> all_;
  bool weld_;
  Textures textures_;
};

/// Of several files from their checksums; of one it is its own.
std::uint64_t joined_checksum(const std::vector<std::uint64_t>& checksums);

}  // namespace meshhier::importing
