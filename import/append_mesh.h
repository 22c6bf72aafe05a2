// Meshes and triangles that were read apart become one mesh.
#pragma once

#include "import/raw_mesh.h"

#include <cstdint>
#include <filesystem>
#include <span>

namespace meshhier::importing {

/// Returns the number of the next vertex of `mesh`. Throws Error(input) naming the file if with
/// `more` vertices of it there are 2^32 or more.
std::uint32_t next_vertex(const RawMesh& mesh, const std::filesystem::path& path,
                          std::uint64_t more);

/// Appends triangles whose vertices are numbered from `base` on. Requires that all of these numbers
/// are below 2^32, as next_vertex() checks.
void append_triangles(std::span<const Triangle<VertexId>> triangles, std::uint32_t base,
                      RawMesh& mesh);

/// Appends the vertices, triangles, objects and materials of `from`, whose layout is `from.layout`,
/// to `to`, as if its reader had appended them there. Throws Error(input) if there are 2^32
/// vertices or more, or too many materials; Error(io), Error(interrupted).
void append_mesh(RawMesh&& from, RawMesh& to, const execution::CancelToken& cancel);

}  // namespace meshhier::importing
