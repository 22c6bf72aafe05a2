// The triangles between the cells of a grid.
//
//      . . . .      A square is cut along the diagonal whose middle lies nearer to the surface. The
//      . a b .      surface's height in the middle of a b d e comes from the sixteen cells around:
//      . d e .      the cubic with the weights -1 9 9 -1 (over 16) along each axis.
//      . . . .
#pragma once

#include "hierarchy/ids.h"
#include "hierarchy/triangle.h"
#include "import/terrain_cells.h"
#include "mesh_io/mosaic.h"

#include <array>
#include <cstdint>
#include <vector>

namespace meshhier::importing {

/// Thread-safe.
class TerrainSquares {
 public:
  /// `is_mirrored`: rows follow each other to the other side, so that corners turn the other way.
  TerrainSquares(const mesh_io::Mosaic& mosaic, const TerrainCells& cells, bool is_mirrored)
      : mosaic_(mosaic), cells_(cells), is_mirrored_(is_mirrored) {}

  /// The rows around a run, from the one above it to the second one below, and one cell more at its
  /// left, two at its right; NaN: no height. Used again for the next run.
  struct Rows {
    std::array<std::vector<double>, 4> heights;
    std::uint64_t run = ~std::uint64_t{0};
  };

  /// Appends the triangles of a run, as vertices are numbered.
  void triangulate(std::uint64_t run, Rows& rows, std::vector<Triangle<VertexId>>& to) const;

 private:
  void read(std::uint64_t run, Rows& rows) const;
  void read_row(const TerrainCells::Run& run, std::int64_t row, std::vector<double>& to) const;

  const mesh_io::Mosaic& mosaic_;
  const TerrainCells& cells_;
  bool is_mirrored_;
};

}  // namespace meshhier::importing
