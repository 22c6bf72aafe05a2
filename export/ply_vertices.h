// Vertices of tiles as a PLY has them.
#pragma once

#include "hierarchy/tile_mesh.h"
#include "mesh_io/ply_writer.h"
#include "storage/format/hierarchy_reader.h"

#include <cstddef>
#include <string>

namespace meshhier::exporting {

/// Without counts. `what`: for its comment.
mesh_io::PlyContent ply_content(const storage::HierarchyReader& reader, const std::string& what);

/// `count` vertices from the first on: in doubles where the hierarchy has an origin, colours as
/// screens have them.
void write_vertices(mesh_io::PlyWriter& writer, const storage::HierarchyReader& reader,
                    const VertexArray& vertices, std::size_t count);

}  // namespace meshhier::exporting
