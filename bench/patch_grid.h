// Numbers the vertices of a mesh of square patches, each cut into n x n cells, by arithmetic alone.
#pragma once

#include "bench/base_surface.h"

#include <array>
#include <cstdint>
#include <vector>

namespace meshhier::bench {

/// Grid point (column, row) of a patch, both in [0, n]; corners 0, 1, 2, 3 of the patch are at
/// (0, 0), (n, 0), (n, n), (0, n).
struct PatchPoint {
  std::uint32_t patch = 0;
  std::uint32_t column = 0;
  std::uint32_t row = 0;
};

/// A point on a side or corner that several patches share belongs to the lowest of them. Vertices
/// are numbered patch by patch and row by row, as a scanner would deliver them; memory is
/// O(patches).
class PatchGrid {
 public:
  /// `mesh`: closed and manifold; no patch twice at one of its own sides. `cells`: n >= 1.
  PatchGrid(const QuadMesh& mesh, std::uint32_t cells);

  std::uint32_t patch_count() const { return static_cast<std::uint32_t>(faces_.size()); }
  std::uint32_t cells() const { return cells_; }
  std::uint64_t vertex_count() const { return first_.back(); }
  std::uint64_t triangle_count() const { return 2 * cell_count(); }

  bool is_owned(PatchPoint point) const;
  /// The vertex's number, in [0, vertex_count()): the same for every patch that holds the point.
  std::uint64_t index(PatchPoint point) const;

 private:
  /// The parts of a row that belong to its own patch.
  struct RowParts {
    bool left = false;
    bool middle = false;
    bool right = false;
  };

  std::uint64_t cell_count() const { return std::uint64_t{patch_count()} * cells_ * cells_; }
  RowParts parts(std::uint32_t patch, std::uint32_t row) const;
  std::uint64_t size(const RowParts& row) const;
  PatchPoint owner_of(PatchPoint point) const;

  std::uint32_t cells_;
  std::vector<std::array<std::uint32_t, 4>> faces_;
  std::vector<std::array<PatchSide, 4>> opposite_;  ///< side of the neighbour, by side
  std::vector<PatchSide> corner_owner_;             ///< by vertex of the mesh: patch and corner
  std::vector<std::uint64_t> first_;  ///< number of a patch's first vertex; then the total
};

}  // namespace meshhier::bench
