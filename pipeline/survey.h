// What the triangles of a mesh use: where its vertices are, and how long its edges.
#pragma once

#include "hierarchy/bounds.h"
#include "hierarchy/vec.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::pipeline {

class SourceMesh;
struct StageContext;

/// In input coordinates. What no triangle uses counts for nothing.
struct Survey {
  BoundsD bounds;             ///< of all vertices; empty if there are no triangles
  std::vector<Vec3d> sample;  ///< of the vertices
  double median_edge = 0;     ///< of the edges of some thousand triangles; 0 if there are none
};

/// `sample`: the positions that partition::SampleIds names, in their order. Reads all faces and all
/// vertices once for each 2^27 vertices, of which a bit each is in memory: 16 MiB at most, and 4
/// MiB for the samples. Deterministic.
Survey survey(SourceMesh& mesh, std::span<const Vec3d> sample, const StageContext& context);

/// Vertices that triangles use and that lie outside of a box.
struct FarVertices {
  std::uint64_t count = 0;
  Vec3d first;  ///< in the order of the file
};

/// Reads as survey().
FarVertices used_outside(SourceMesh& mesh, const BoundsD& box, const StageContext& context);

/// Of a mesh of so many vertices.
std::uint64_t survey_bytes(std::uint64_t vertex_count);

}  // namespace meshhier::pipeline
