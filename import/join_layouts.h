// Files of a list that have textures beside files that have none.
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
};

/// Throws Error(input) if the last file has other normals or colours than the first one.
void require_joinable(std::span<const JoinedFile> files);

/// Gives all vertices of `mesh`, which have the channels of their own files, those of all files
/// together: if one file is textured, vertices of files that are not have the coordinates 0 0 and
/// a white material, one for all of them. Returns how many such files there are; 0 unless there is
/// a textured one. Throws Error(input) if no file is textured and not all have texture coordinates
/// or none.
std::uint64_t join_layouts(std::span<const JoinedFile> files, RawMesh& mesh,
                           const ImportRoom& room);

}  // namespace meshhier::importing
