// Renumbers triangles of a primitive to the vertices that they use.
#pragma once

#include "import/raw_mesh.h"

#include <cstdint>
#include <memory>

namespace meshhier::importing {

/// Appends `triangles`, whose corners are below `vertex_count`, to `mesh.triangles`: vertices that
/// they use have numbers from mesh.vertex_count() on, in their order. These vertices go to `used`.
/// `turned`: with the last two corners swapped. Works through the vertices in parts whose table
/// fits into room.sort_bytes; the result does not depend on it. Throws Error(input) if the mesh had
/// 2^32 - 1 vertices or more.
void append_used(std::unique_ptr<storage::RecordSpool<Triangle<std::uint32_t>>> triangles,
                 std::uint64_t vertex_count, bool turned, RawMesh& mesh,
                 storage::RecordSpool<std::uint32_t>& used, const ImportRoom& room);

}  // namespace meshhier::importing
