// A survey of the vertices that the triangles of a mesh use: where they are, and how long edges
// are.
#pragma once

#include "base/bounds.h"
#include "base/vec.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::pipeline {

class SourceMesh;
struct StageContext;

/// A survey, in input coordinates. Vertices that no triangle uses count for nothing.
struct Survey {
  BoundsD bounds;             ///< box of all vertices; empty if there are no triangles
  std::vector<Vec3d> sample;  ///< some of the vertices
  double median_edge = 0;     ///< among the edges of some thousand triangles; 0 if there are none
};

/// Surveys a mesh. `sample`: the positions that partition::SampleIds names, in their order. Reads
/// all faces and all vertices once for each 2^27 vertices, which take a bit each of memory: 16 MiB
/// at most, and 4 MiB for the samples. Deterministic. Throws as SourceMesh.
Survey survey(SourceMesh& mesh, std::span<const Vec3d> sample, const StageContext& context);

/// Vertices that triangles use and that lie outside of a box.
struct FarVertices {
  std::uint64_t count = 0;
  Vec3d first;  ///< the first one in the order of the file
};

/// Counts them; reads as survey() does.
FarVertices used_outside(SourceMesh& mesh, const BoundsD& box, const StageContext& context);

/// Returns the memory that a survey of so many vertices takes.
std::uint64_t survey_bytes(std::uint64_t vertex_count);

}  // namespace meshhier::pipeline
