#include "cluster_simplify/label_borders.h"

#include "hierarchy/value_mixer.h"

#include <algorithm>
#include <cstddef>

namespace meshhier::cluster_simplify {

std::vector<PlaceEdge> label_borders(const TileWedges& wedges, const AttributeLayout& layout) {
  const ValueMixer values(layout);
  const auto are_equal = [&](std::uint32_t a, std::uint32_t b) {
    return values.have_equal_labels(wedges.attributes_of(a).data(), wedges.attributes_of(b).data());
  };
  std::vector<PlaceEdge> borders;
  for (const WedgeTriangle& t : wedges.triangles()) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3], across = t[(k + 2) % 3];
      if (wedges.is_own(a) && wedges.is_own(b) && are_equal(a, b) && !are_equal(a, across))
        borders.push_back({std::min(wedges.place_of(a), wedges.place_of(b)),
                           std::max(wedges.place_of(a), wedges.place_of(b))});
    }
  }
  std::ranges::sort(borders);
  borders.erase(std::unique(borders.begin(), borders.end()), borders.end());
  return borders;
}

}  // namespace meshhier::cluster_simplify
