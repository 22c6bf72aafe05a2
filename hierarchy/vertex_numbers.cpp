#include "hierarchy/vertex_numbers.h"

#include <algorithm>
#include <cassert>

namespace meshhier {

std::vector<Wedge> wedges_of(std::span<const std::uint32_t> copy_places) {
  std::vector<Wedge> wedges;
  wedges.reserve(copy_places.size());
  for (const std::uint32_t place : copy_places) {
    const bool first = wedges.empty() || wedges.back().place != place;
    wedges.push_back({place, first ? 1 : wedges.back().wedge + 1});
  }
  return wedges;
}

VertexNumbers::VertexNumbers(std::uint32_t place_count, std::span<const std::uint32_t> copy_places)
    : VertexNumbers(place_count, wedges_of(copy_places)) {}

std::uint32_t VertexNumbers::number_of(const Wedge& wedge) const {
  if (wedge.wedge == 0)
    return wedge.place;
  const auto found = std::lower_bound(copies_.begin(), copies_.end(), wedge);
  assert(found != copies_.end() && *found == wedge);
  return place_count_ + static_cast<std::uint32_t>(found - copies_.begin());
}

std::vector<TileTriangle> VertexNumbers::numbered(std::span<const TileTriangle> triangles,
                                                  std::span<const CornerWedges> wedges) const {
  assert(wedges.empty() || wedges.size() == triangles.size());
  std::vector<TileTriangle> numbered(triangles.begin(), triangles.end());
  for (std::size_t t = 0; t < wedges.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      TileVertex& corner = numbered[t][c];
      corner = static_cast<TileVertex>(number_of({raw(corner), wedges[t][c]}));
    }
  }
  return numbered;
}

std::vector<CornerWedges> VertexNumbers::split(std::span<TileTriangle> triangles) const {
  std::vector<CornerWedges> wedges(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      const Wedge wedge = (*this)[raw(triangles[t][c])];
      triangles[t][c] = static_cast<TileVertex>(wedge.place);
      wedges[t][c] = wedge.wedge;
    }
  }
  return wedges;
}

}  // namespace meshhier
