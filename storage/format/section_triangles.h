// Reads the triangles of a tile from its sections.
#pragma once

#include "hierarchy/tile_mesh.h"
#include "hierarchy/vertex_numbers.h"
#include "storage/format/section_reader.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::storage {

/// Three lists with an element for each triangle: its places, the wedges there if there are copies,
/// and its corners with splits if there are any.
struct TriangleLists {
  std::vector<TileTriangle>& places;
  std::vector<CornerWedges>& wedges;
  std::vector<TileTriangle>& shaded;

  CornerWedges wedges_at(std::size_t t) const {
    return wedges.empty() ? CornerWedges{} : wedges[t];
  }
  Wedge corner(std::size_t t, std::size_t c) const { return {raw(places[t][c]), wedges_at(t)[c]}; }
  std::pair<TileTriangle, CornerWedges> key(std::size_t t) const {
    return {places[t], wedges_at(t)};
  }
};

/// Reads the interior or border triangles into `lists`, where they begin with their smallest corner
/// and ascend, by place and wedge. They must be so in the file, unless it is packed. `split_of`:
/// the vertex of each split. Throws Error(corrupt), also for corners that no triangle of the part
/// has.
void read_triangles(const SectionReader& sections, TilePart part, const VertexNumbers& numbers,
                    std::span<const std::uint32_t> split_of, const TriangleLists& lists);

}  // namespace meshhier::storage
