#include "hierarchy/rounded_tile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meshhier {

double round_to(const Lattice& lattice, TileMesh& mesh) {
  return std::max(round_to(lattice, mesh.vertices.positions),
                  round_to(lattice, mesh.copies.vertices.positions));
}

float bound_with_rounding(float bound, double rounding, int levels_below) {
  float sum = float_above(bound + rounding);
  for (int i = 0; i < levels_below; ++i)
    sum = std::nextafter(sum, std::numeric_limits<float>::infinity());
  return sum;
}

}  // namespace meshhier
