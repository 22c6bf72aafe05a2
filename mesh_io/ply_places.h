// Places of single vertices of a PLY file, for its polygons.
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

/// Reads runs of rows again, and keeps some: quick where polygons that follow one another have
/// vertices that stand near each other in the file. Rows without a fixed size are found by an index
/// of at most 1 MiB, which takes one more reading of them. Memory: 2 MiB. Refers to its arguments.
class PlyPlaces {
 public:
  /// `start`: where the vertices begin.
  PlyPlaces(const InputFile& input, const PlyPlan& plan, const MeshDescription& mesh,
            PlyPosition start);

  /// Returns where a vertex lies. Requires vertex < the count of vertices, all of which have been
  /// read once. Throws Error(io).
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
  /// Starts of the runs, and their end; empty until they are needed.
  std::vector<PlyPosition> index_;
  std::array<Run, kRuns> runs_;
  BlockMemory memory_;
};

}  // namespace meshhier::mesh_io
