// The places in pictures of faces of a PLY file that has them in elements of their own, as Artec
// Studio writes them.
#pragma once

#include "import/raw_mesh.h"
#include "mesh_io/ply_source.h"
#include "partition/external_sort.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>

namespace meshhier::importing {

/// Brings places to faces, out of core: texture vertices are looked up in the order of texture
/// faces, which are sorted by the face that they belong to. For one thread.
class PlyTextureFaces {
 public:
  /// Reads both lists. `path` is for messages. Throws as PlySource.
  PlyTextureFaces(mesh_io::PlySource& source, const std::filesystem::path& path,
                  const ImportRoom& room);

  /// Gives `face` its texture and texture coordinates; faces that are not listed show no texture.
  /// Faces come in the order of the file. Throws Error(input) unless each corner has one place.
  void complete(mesh_io::PlyFace& face);

 private:
  struct Corner {
    std::uint64_t face;
    std::uint32_t corner;
    std::int32_t texture;
    float u, v;
  };
  struct CornerKey {
    std::pair<std::uint64_t, std::uint32_t> operator()(const Corner& c) const {
      return {c.face, c.corner};
    }
  };
  const Corner* front();

  const std::filesystem::path& path_;
  partition::ExternalSort<Corner, CornerKey> corners_;
  std::span<const Corner> block_;
};

}  // namespace meshhier::importing
