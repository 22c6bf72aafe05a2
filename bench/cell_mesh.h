// Representative-vertex simplification: every cell of vertices becomes one vertex.
#pragma once

#include "bench/parts.h"
#include "cluster_simplify/contraction.h"

namespace meshhier::bench {

/// Cells hold at most so many vertices: what a contraction takes.
inline constexpr std::uint64_t kMostCellVertices = 65536;

/// One vertex a part, as cluster_simplify::contract() places it for a tile that is that part; the
/// triangles whose corners are in three parts, repeats dropped. Throws Error(usage) if a part has
/// more than kMostCellVertices vertices.
PlainMesh cell_mesh(const PlainMesh& mesh, const Parts& cells,
                    cluster_simplify::Representative representative);

}  // namespace meshhier::bench
