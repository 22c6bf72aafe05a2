// The method `edge_collapse`: quadric edge collapse with optimal placement.
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
                          const AttributeLayout& layout, std::span<const PlaceEdge> seams = {});

}  // namespace meshhier::cluster_simplify
