// Finds the vertex of a place that is most like another one.
#pragma once

#include "export/tile_vertices.h"
#include "hierarchy/attribute_rules.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::exporting {

/// Returns all vertices at a place: its first one, then the copies there. `vertices` and `copies`
/// are a tile's, and must outlive the result.
std::vector<VertexAt> vertices_at(const VertexArray& vertices, const Copies& copies,
                                  std::uint32_t place);

/// Returns the index of the vertex of `all` that differs from `vertex` in the fewest values, so
/// that labels stay on their side; among equals the nearest normal decides, then the colour, the
/// texture coordinate, the order. Requires at least one.
std::size_t nearest_vertex(const AttributeRules& rules, const VertexAt& vertex,
                           std::span<const VertexAt> all);

}  // namespace meshhier::exporting
