#include "mesh_io/mesh_source.h"

#include "mesh_io/ply_source.h"

namespace meshhier::mesh_io {

std::unique_ptr<MeshSource> open_mesh(storage::FileSystem& files,
                                      const std::filesystem::path& path) {
  return make_ply_source(files.open(path));
}

}  // namespace meshhier::mesh_io
