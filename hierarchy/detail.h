// The files of a progressive stream, and the entries that they hold.
//
// A progressive stream is a mesh as a base file and a series of detail files (Lin & Luo,
// "Progressive Display Method for Interactive Mobile 3D Graphics"). Vertices and triangles keep the
// indices that they have in the original mesh. Each file has three lists, in this order, each
// ascending:
//
//   1  vertices that appear: their places and attributes
//   2  triangles that appear: their three vertices in the original mesh
//   3  merges: vertices that stand where another one does until they appear themselves
//
// A run is a piece of a list of at most kRunEntries entries.
#pragma once

#include "hierarchy/attributes.h"
#include "hierarchy/triangle.h"

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

namespace meshhier {

/// Enough for deflate to learn from, and a megabyte at most in memory.
inline constexpr std::size_t kRunEntries = 65536;

/// How many values a vertex has: x, y, z, then the attributes' channels.
inline int vertex_values(const AttributeLayout& layout) {
  return 3 + layout.channels();
}

/// Bytes that value number `value` of a vertex is kept in.
inline int value_bytes(const AttributeLayout& layout, int value) {
  const auto channel = static_cast<std::size_t>(value - 3);  // huge of places
  return layout.part(AttributeKind::colours).has(channel) ? row_of(layout.colour).bytes : 4;
}

struct VertexRun {
  std::vector<std::uint32_t> indices;    ///< ascending
  std::vector<std::uint32_t> residuals;  ///< vertex_values() each, see progressive/residual.h
};

struct TriangleRun {
  std::vector<std::uint64_t> indices;  ///< ascending
  std::vector<Triangle<std::uint32_t>> corners;
};

struct MergeRun {
  std::vector<std::uint32_t> indices;  ///< of vertices, ascending
  std::vector<std::uint32_t> targets;  ///< whose slot each of them takes over
};

using DetailRun = std::variant<VertexRun, TriangleRun, MergeRun>;

}  // namespace meshhier
