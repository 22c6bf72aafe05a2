// A piece of a mesh: the triangles that touch a box, whole, with the vertices that they use.
#pragma once

#include "base/bounds.h"
#include "import/raw_mesh.h"
#include "mesh_io/mesh_source.h"

#include <cstdint>
#include <functional>

namespace meshhier::importing {

/// Appends the part of a source that may touch the box: triangles whose corners are not all beyond
/// one of its sides, and their vertices, in the order of the file. Reads vertices twice and
/// triangles once: memory holds a byte a vertex, the disk the part that is kept; where
/// room.sort_bytes are fewer, the disk also holds triangles that wait. Returns the counts of all
/// triangles; `visit` gets each block of vertices once. Throws as MeshSource.
mesh_io::FaceCounts append_near(mesh_io::MeshSource& source, const BoundsD& box, RawMesh& mesh,
                                const mesh_io::VertexVisitor& visit, const ImportRoom& room);

/// Fills `cropped` with the piece of `mesh`, whose spools are cleared. Vertices stay in their
/// order, and triangles, but for those that wait for a part of a large table. If the mesh has no
/// triangles, the vertices in the box stay. Returns how many triangles went. O(n), with sorts where
/// the positions exceed room.sort_bytes.
std::uint64_t crop_mesh(RawMesh& mesh, RawMesh& cropped, const BoundsD& box,
                        const ImportRoom& room);

}  // namespace meshhier::importing
