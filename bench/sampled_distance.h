// How far two surfaces are apart, by samples (Cignoni, Rocchini & Scopigno, Metro: measuring error
// on simplified surfaces, 1998).
#pragma once

#include "bench/parts.h"
#include "inspection/triangle_search.h"

#include <cstdint>

namespace meshhier::bench {

/// In input units.
struct Distances {
  double mean = 0;
  double rms = 0;
  double max = 0;
};

/// The surface of a mesh, to measure distances to.
class SearchableSurface {
 public:
  /// Throws Error(input) if there are no triangles. O(n log n).
  explicit SearchableSurface(const PlainMesh& mesh);

  /// Of `samples` >= 1 points on `from` to this surface. The points are spread evenly over the
  /// area: one at a hashed place in each of `samples` equal shares. Throws Error(input) if `from`
  /// has no area.
  Distances distances_from(const PlainMesh& from, std::uint64_t samples) const;

 private:
  inspection::TriangleSearch search_;
};

}  // namespace meshhier::bench
