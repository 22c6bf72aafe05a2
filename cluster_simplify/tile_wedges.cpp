#include "cluster_simplify/tile_wedges.h"

#include "hierarchy/ids.h"

#include <cassert>
#include <cstddef>
#include <numeric>

namespace meshhier::cluster_simplify {
namespace {

/// Returns, for each of `place_count` places, the number of its first copy, or of the next one; the
/// copies' count at the end.
std::vector<std::uint32_t> first_copies(const Copies& copies, std::size_t place_count) {
  std::vector<std::uint32_t> firsts(place_count + 1);
  for (const std::uint32_t place : copies.places)
    ++firsts[place + 1];
  std::partial_sum(firsts.begin(), firsts.end(), firsts.begin());
  return firsts;
}

}  // namespace

TileWedges::TileWedges(const TileMesh& mesh)
    : mesh_(mesh), first_copies_(first_copies(mesh.copies, mesh.vertices.size())) {
  triangles_.reserve(mesh.interior.size() + mesh.border.size());
  add(mesh.interior, mesh.interior_wedges);
  add(mesh.border, mesh.border_wedges);
}

void TileWedges::add(std::span<const TileTriangle> triangles,
                     std::span<const CornerWedges> wedges) {
  assert(wedges.empty() || wedges.size() == triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const TileTriangle& t = triangles[i];
    const CornerWedges numbers = wedges.empty() ? CornerWedges{} : wedges[i];
    if (!is_degenerate(t))
      triangles_.push_back(
          {at(raw(t[0]), numbers[0]), at(raw(t[1]), numbers[1]), at(raw(t[2]), numbers[2])});
  }
}

}  // namespace meshhier::cluster_simplify
