// Writes vertices of tiles into a PLY.
#pragma once

#include "hierarchy/tile_mesh.h"
#include "mesh_io/ply_writer.h"
#include "storage/format/hierarchy_reader.h"

#include <cstddef>
#include <string>

namespace meshhier::exporting {

/// Returns the content without counts. `what`: for its comment.
mesh_io::PlyContent ply_content(const storage::HierarchyReader& reader, const std::string& what);

/// Writes the first `count` vertices: in doubles if the hierarchy has an origin, colours as sRGB.
void write_vertices(mesh_io::PlyWriter& writer, const storage::HierarchyReader& reader,
                    const VertexArray& vertices, std::size_t count);

}  // namespace meshhier::exporting
