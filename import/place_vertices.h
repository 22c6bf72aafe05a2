// Vertices without a place: their coordinates are not finite.
#pragma once

#include "import/raw_mesh.h"
#include "mesh_io/mesh_source.h"
#include "mesh_io/unplaced.h"

#include <cstdint>
#include <filesystem>

namespace meshhier::importing {

/// Counts the unplaced vertices of a block of a PLY file.
void count_unplaced(const mesh_io::VertexBlock& block, const std::filesystem::path& path,
                    mesh_io::UnplacedVertices& unplaced);

struct DroppedUnplaced {
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;  ///< triangles that use one of them
};

/// Fills `placed` with `mesh`, whose spools are cleared, without the vertices that have no place
/// and the triangles that use one. The order of vertices stays, and that of triangles but for those
/// that wait for a part of a large table. Throws Error(input) if most triangles go; `first`:
/// UnplacedVertices::first, for the message. O(n).
DroppedUnplaced drop_unplaced(RawMesh& mesh, RawMesh& placed, const std::string& first,
                              const ImportRoom& room);

}  // namespace meshhier::importing
