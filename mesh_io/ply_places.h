// Where the vertices of a PLY file lie, one by one: for its polygons.
#pragma once

#include "mesh_io/input_stream.h"
#include "mesh_io/ply_body.h"
#include "mesh_io/ply_fixed_rows.h"
#include "mesh_io/ply_plan.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::mesh_io {

/// Reads runs of rows again, and keeps some: quick where polygons that follow one another lie near.
/// Rows without a fixed size are found by an index of at most 1 MiB, which takes one more reading
/// of them. Memory: 2 MiB. Refers to its arguments.
class PlyPlaces {
 public:
  /// `start`: of the vertices.
  PlyPlaces(const InputFile& input, const PlyPlan& plan, const MeshDescription& mesh,
            PlyPosition start);

  /// Requires vertex < the count of vertices, all of which have been read once. Throws Error(io).
  Vec3d at(std::uint32_t vertex);

 private:
  struct Run {
    std::uint64_t first = 0;
    std::vector<Vec3d> places;
  };

  std::vector<PlyPosition> make_index() const;
  void load(Run& run, std::uint64_t first);
  std::vector<Vec3d> fixed_places(std::uint64_t first, std::size_t count);
  std::vector<Vec3d> indexed_places(std::uint64_t first, std::size_t count);

  static constexpr std::size_t kRuns = 256;

  InputFile input_;
  const PlyPlan& plan_;
  const MeshDescription& mesh_;
  PlyPosition start_;
  bool is_fixed_;
  std::uint64_t run_vertices_;
  std::vector<PlyPosition> index_;  ///< of each run, and the end; empty until it is needed
  std::array<Run, kRuns> runs_;
  BlockMemory memory_;
};

}  // namespace meshhier::mesh_io
