// Test meshes as the generator takes them.
#pragma once

#include "bench/generator.h"
#include "tests/support/meshes.h"

namespace meshhier::tests {

/// Without attributes.
inline bench::LoadedMesh loaded(const TestMesh& mesh) {
  bench::LoadedMesh result;
  for (const Vec3f& p : mesh.positions)
    result.positions.push_back(to_double(p));
  result.triangles = mesh.triangles;
  return result;
}

}  // namespace meshhier::tests
