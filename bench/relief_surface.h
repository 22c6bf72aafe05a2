// The vertices of a generated surface: a base shape, cut into a grid, displaced by fractal relief
// and by noise.
#pragma once

#include "base/vec.h"
#include "bench/base_surface.h"
#include "bench/generator.h"
#include "bench/noise.h"
#include "bench/patch_grid.h"

#include <array>
#include <cstdint>
#include <functional>
#include <string>

namespace meshhier::bench {

struct ReliefVertex {
  SurfacePoint base;  ///< on the shape below the relief
  Vec3d slope;        ///< the relief's gradient
  Vec3d moved;        ///< where the vertex is, before the offset
};

/// The two triangles of a grid's cell; each triangle's corners turn counter-clockwise seen from
/// outside.
using CellTriangles = std::array<std::array<PatchPoint, 3>, 2>;

/// Returns whether a cell is cut from (column, row) to (column + 1, row + 1), else from (column +
/// 1, row) to (column, row + 1). Cuts alternate, as a checkerboard: no direction is preferred.
constexpr bool is_cut_upwards(PatchPoint cell) {
  return (cell.column + cell.row) % 2 == 0;
}

/// Requires that `cell`, the lowest point of a cell, is no last one of its row or column.
CellTriangles triangles_of(PatchPoint cell);

/// Tells how a surface was made, for a comment in its file.
std::string description_of(const SurfaceOptions& options);

/// A pure function of the options; immutable, thread-safe.
class ReliefSurface {
 public:
  /// Throws Error(usage) as make_surface().
  explicit ReliefSurface(const SurfaceOptions& options);

  const BaseSurface& base() const { return base_; }
  const PatchGrid& grid() const { return grid_; }
  /// Returns the mean distance of neighbouring grid points, roughly.
  double step() const { return step_; }

  ReliefVertex vertex(PatchPoint at) const { return vertex(at, grid_.index(at)); }
  /// Returns its position as a file holds it.
  Vec3d stored(const ReliefVertex& vertex) const;
  /// Visits every vertex once, by ascending number.
  void visit_vertices(const std::function<void(const ReliefVertex&)>& visit) const;

 private:
  ReliefVertex vertex(PatchPoint at, std::uint64_t index) const;

  SurfaceOptions options_;
  BaseSurface base_;
  PatchGrid grid_;
  double step_;
  FractalNoise relief_;
};

}  // namespace meshhier::bench
