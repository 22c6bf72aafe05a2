// Which vertex of a place is most like another one.
#pragma once

#include "hierarchy/attributes.h"
#include "inspection/tile_vertices.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::inspection {

/// All vertices at a place: its first one, then the copies there. `vertices`, `copies`: of a tile,
/// which must outlive them.
std::vector<VertexAt> vertices_at(const VertexArray& vertices, const Copies& copies,
                                  std::uint32_t place);

/// The one of `all` whose normal is nearest to that of `vertex`; among equals the colour decides,
/// then the texture coordinate, then the order. Requires at least one.
std::size_t nearest_vertex(const AttributeLayout& layout, const VertexAt& vertex,
                           std::span<const VertexAt> all);

}  // namespace meshhier::inspection
