// The method `half_edge`: vertices collapse onto existing vertices.
//
//        \   /                 \  |                 \ | /
//     --- a - b ---     ->   --- b ---      or     -- a ---      the end whose going costs less
//        /   \                 /  |                 / | \        goes
//
// Every representative is a vertex of the finer level, bit for bit: the vertices of a level are a
// subset of those of the next finer one, which progressive streams are made of (Lin & Luo,
// Progressive Display Method for Interactive Mobile 3D Graphics; Zunino et al.).
//
// The cost is that of edge_collapse.h at the place of the end that stays, or Melax's: the edge's
// length times how far the surface bends at the end that goes. Collapses are driven and measured as
// those of edge_collapse.h, and cost as much.
#pragma once

#include "cluster_simplify/attribute_seams.h"
#include "cluster_simplify/contraction.h"

#include <cstdint>
#include <span>

namespace meshhier::cluster_simplify {

/// See contract(), and edge_collapse() for what a tile does that cannot reach its count. Melax's
/// cost knows no seams.
Contraction half_edge(const BuildTile& joined, std::uint32_t target, HalfEdgeCost cost,
                      std::span<const PlaceEdge> seams = {});

}  // namespace meshhier::cluster_simplify
