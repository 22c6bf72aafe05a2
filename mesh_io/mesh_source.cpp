#include "mesh_io/mesh_source.h"

#include "mesh_io/ply_source.h"

#include <algorithm>

namespace meshhier::mesh_io {

bool VertexBlock::fits_float() const {
  return std::ranges::all_of(exact,
                             [](Vec3d p) { return meshhier::fits_float(p) || !is_finite(p); });
}

std::unique_ptr<MeshSource> open_mesh(storage::FileSystem& files, const std::filesystem::path& path,
                                      const AttributeChoice& attributes) {
  return make_ply_source(files.open(path), {.attributes = attributes});
}

}  // namespace meshhier::mesh_io
