// The method `edge_collapse`: quadric edge collapse with optimal placement.
//
// Each vertex has a quadric, the sum of squared distances to the planes of its triangles, weighted
// by area (vertex_quadric.h). An edge's ends meet at the point where the sum of their quadrics is
// least (meeting_point.h), and that least value is the edge's cost:
//
//           \   /                  \ | /
//      -- a ----- b --     ->     -- m --       m: least of q_a + q_b; q_m = q_a + q_b
//           /   \                  / | \        cost: the value there
//
// The order of collapses, and what is done when care runs out, is collapse_driver.h's. Coordinates
// are local to the tile (local_frame.h), so that floats suffice; quadrics are kept relative to
// their vertex for the same reason. Four edges are computed at a time.
//
// Cost: about 1.4 microseconds a collapse, a third of it for measuring (decision 034); 76 bytes a
// vertex beside CollapseMesh and attributes.
//
// Garland & Heckbert, Surface Simplification Using Quadric Error Metrics, 1997.
#pragma once

#include "cluster_simplify/attribute_seams.h"
#include "cluster_simplify/contraction.h"

#include <cstdint>
#include <span>

namespace meshhier::cluster_simplify {

/// See contract(). Border vertices of the tile collapse like all others; ghosts stay where they
/// are. Open borders of the surface, and `seams` (see attribute_seams()), are held by planes
/// upright on them. A tile that cannot reach its count with all care (collapse_driver.h) gives it
/// up step by step, and at last joins vertices across gaps; Contraction::fallbacks counts what each
/// step took.
Contraction edge_collapse(const BuildTile& joined, std::uint32_t target,
                          const AttributeRules& rules, std::span<const PlaceEdge> seams = {});

}  // namespace meshhier::cluster_simplify
