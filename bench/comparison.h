// The comparison of Kim & Lee, Interactive Rendering of Huge 3D Meshes in Cloud Computing, on any
// mesh: kd-tree against octree against k-means.
#pragma once

#include "bench/parts.h"
#include "bench/sampled_distance.h"
#include "storage/io/file.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace meshhier::bench {

struct ComparisonOptions {
  std::uint32_t parts = 128;  ///< that many the paper divides its models into
  /// Vertices a cell of the simplification has on average: the paper's Foot has 40,058 vertices,
  /// simplified 1,104.
  double cell_vertices = 36.3;
  int kmeans_iterations = 50;       ///< at most
  std::uint64_t samples = 400'000;  ///< of a distance, in each direction
};

/// One way to divide the mesh.
struct PartitionRow {
  std::string name;
  PartFigures figures;
  double cpu_seconds = 0;
};

/// One representative-vertex simplification.
struct SimplificationRow {
  std::string cells;
  std::string representative;
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  Distances forward;   ///< from the original to the simplified surface
  Distances backward;  ///< the other way
};

struct Comparison {
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  double diagonal = 0;
  int kmeans_iterations = 0;
  std::vector<PartitionRow> partitions;
  /// Those on kd cells have exactly as many vertices as those on octree cells.
  std::vector<SimplificationRow> simplifications;
};

/// Everything but the times is a pure function of mesh and options. Single thread; memory is that
/// of the mesh, 500 bytes a triangle. Throws Error(usage) if the mesh has too few vertices,
/// Error(input) if it or what it is simplified to is no surface.
Comparison compare(const PlainMesh& mesh, const ComparisonOptions& options,
                   storage::FileSystem& files);

/// Two tables in Markdown below a heading.
std::string markdown(const std::string& name, const Comparison& comparison);

}  // namespace meshhier::bench
