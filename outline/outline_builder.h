// The shape-outline: the simplified lines along which sectors meet, and the mesh's own borders.
//
// Sectors are the nodes of one level. Where two meet, the line runs through the border triangles: from the midpoint
// of one crossing edge (corners in different sectors) over the triangle's centroid to the midpoint of the other; a
// triangle with corners in three sectors is a junction. Lines between junctions are simplified once, so both sectors
// share them (Douglas & Peucker 1973).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

#include "hierarchy/ids.h"
#include "hierarchy/outline.h"
#include "hierarchy/tile_mesh.h"

namespace meshhier::outline {

struct OutlineOptions {
  double tolerance = 0.002;        ///< of Douglas-Peucker, as a part of `diagonal`; > 0
  double diagonal = 1;             ///< of the model's bounding box, input units
  std::size_t max_bytes = 32768;   ///< the file may be so large
  /// Size of the file for so many vertices and line segments.
  std::function<std::size_t(std::size_t vertices, std::size_t segments)> file_bytes;
};

struct OutlineResult {
  Outline outline;
  double tolerance = 0;                 ///< used: options.tolerance, doubled until the result fits
  std::uint64_t polylines_found = 0;
  std::uint64_t polylines_dropped = 0;  ///< the shortest, if even a coarse tolerance did not fit
};

/// Collects sectors one by one, then makes the outline. Pure: no I/O, no threads; the result does not
/// depend on the order of add().
class OutlineBuilder {
 public:
  OutlineBuilder();
  ~OutlineBuilder();

  /// Adds the tile of one sector; `index` is its NodeId::index, ghosts refer to others by theirs. All
  /// sectors must be of one level. O(triangles).
  void add(std::uint32_t index, const TileMesh& tile);

  /// O(s log s) in the number of line segments.
  OutlineResult finish(const OutlineOptions& options) const;

 private:
  struct Segments;
  std::unique_ptr<Segments> segments_;
};

}  // namespace meshhier::outline
