// The box of the vertices that triangles use.
#pragma once

#include "hierarchy/bounds.h"

#include <cstdint>

namespace meshhier::pipeline {

class SourceMesh;
struct StageContext;

/// Their box in input coordinates; empty if there are no triangles. Reads all faces and all
/// vertices once for each 2^27 vertices, of which a bit each is in memory: 16 MiB at most.
BoundsD used_bounds(SourceMesh& mesh, const StageContext& context);

/// Of a mesh of so many vertices.
std::uint64_t used_bounds_bytes(std::uint64_t vertex_count);

}  // namespace meshhier::pipeline
