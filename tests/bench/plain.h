// Test meshes as the comparison takes them.
#pragma once

#include "bench/parts.h"
#include "tests/support/meshes.h"

#include <utility>

namespace meshhier::bench {

inline PlainMesh plain(tests::TestMesh mesh) {
  return {std::move(mesh.positions), std::move(mesh.triangles)};
}

/// Every vertex a part of its own.
inline Parts single_vertices(const PlainMesh& mesh) {
  Parts parts;
  while (parts.count < mesh.positions.size())
    parts.part_of.push_back(parts.count++);
  return parts;
}

}  // namespace meshhier::bench
