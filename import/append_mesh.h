// Meshes that were read apart become one.
#pragma once

#include "import/raw_mesh.h"

namespace meshhier::importing {

/// Appends the vertices, triangles, objects and materials of `from`, whose layout is `from.layout`,
/// to `to`, as if its reader had appended them there. Throws Error(input) if there are 2^32
/// vertices or more, or too many materials; Error(io), Error(interrupted).
void append_mesh(RawMesh&& from, RawMesh& to, const execution::CancelToken& cancel);

}  // namespace meshhier::importing
