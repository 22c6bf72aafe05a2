// Files of a list that have textures or colours of materials beside files that have none.
#pragma once

#include "import/raw_mesh.h"

#include <cstdint>
#include <filesystem>
#include <span>

namespace meshhier::importing {

/// A file of a list, whose vertices come behind those of the files before.
struct JoinedFile {
  std::filesystem::path path;
  AttributeLayout layout;
  std::uint64_t vertices = 0;
  bool is_painted = false;  ///< its colours are those of its materials
};

/// Throws Error(input) if the last file has other normals or colours than the first one; those of
/// materials do not count.
void require_joinable(std::span<const JoinedFile> files);

/// Gives all vertices of `mesh`, which have the channels of their own files, those of all files
/// together. If one file is textured, vertices of files that are not have the coordinates 0 0 and
/// a material of their material's colour, else a white one, one for each colour. If one is painted
/// and none textured, vertices of files that are neither are white. Returns how many untextured
/// files there are beside textured ones. Throws Error(input) if no file is textured and not all
/// have texture coordinates or none.
std::uint64_t join_layouts(std::span<const JoinedFile> files, RawMesh& mesh,
                           const ImportRoom& room);

}  // namespace meshhier::importing
