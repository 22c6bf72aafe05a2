#include "import/ply_texture_faces.h"

#include "import/place_lookup.h"
#include "mesh_io/input_error.h"

#include <array>

#include <fmt/format.h>

namespace meshhier::importing {

PlyTextureFaces::PlyTextureFaces(mesh_io::PlySource& source, const std::filesystem::path& path,
                                 const ImportRoom& room)
    : path_(path), corners_(room.scratch, room.sort_bytes) {
  storage::RecordSpool<std::array<float, 2>> places(room.scratch, kImportSpoolBytes);
  source.read_texture_vertices([&](std::array<float, 2> place) { places.append(place); });
  SpoolLookup lookup(places);
  source.read_texture_faces([&](const mesh_io::PlyTextureFace& face) {
    room.cancel.check();
    std::uint32_t number = 0;
    for (const std::uint32_t corner : face.corners) {
      const auto& [u, v] = lookup.at(corner);
      corners_.add({face.face, number++, face.texture, u, v});
    }
  });
  corners_.sort();
  block_ = corners_.next_block();
}

const PlyTextureFaces::Corner* PlyTextureFaces::front() {
  if (block_.empty())
    block_ = corners_.next_block();
  return block_.empty() ? nullptr : block_.data();
}

void PlyTextureFaces::complete(mesh_io::PlyFace& face) {
  face.texcoords.clear();
  face.texture = -1;
  if (!face.row)
    return;
  while (const Corner* corner = front()) {
    if (corner->face != *face.row)
      break;
    face.texture = corner->texture;
    face.texcoords.insert(face.texcoords.end(), {corner->u, corner->v});
    block_ = block_.subspan(1);
  }
  if (face.texcoords.empty() || face.texcoords.size() == 2 * face.corners.size())
    return;
  mesh_io::fail_file(path_,
                     fmt::format("expected a texture vertex for each of the {} corners of face {}, "
                                 "found {}",
                                 face.corners.size(), *face.row, face.texcoords.size() / 2));
}

}  // namespace meshhier::importing
