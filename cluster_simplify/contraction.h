// Contraction methods: a joined tile and a vertex count in, a parent map and representatives out.
//
// This function is all that differs between methods; joining, seams, levels and errors are common
// to them.
#pragma once

#include "cluster_simplify/seams.h"
#include "cluster_simplify/wedge_options.h"
#include "hierarchy/attribute_rules.h"

#include <cstdint>

namespace meshhier::cluster_simplify {

enum class Method {
  cluster,        ///< kd cells of equal vertex count, one representative each (Kim & Lee)
  edge_collapse,  ///< edges collapse to the point of least quadric error (Garland & Heckbert)
  half_edge,      ///< vertices collapse onto others: coarse vertices are a subset of fine ones
};

/// Where a cell's representative lies.
enum class Representative {
  mean,     ///< mean of the original vertices it stands for
  quadric,  ///< point of least squared distance to the planes of the cell's triangles (Lindstrom
            ///< 2000)
  vertex,   ///< the cell's vertex of least such distance
};

/// The cost of a half-edge collapse.
enum class HalfEdgeCost {
  quadric,  ///< squared distance to the planes of both vertices
  melax,    ///< length times how far the surface bends (Melax 1998)
};

/// A choice that the method has no use for is ignored.
struct ContractionOptions {
  Method method = Method::edge_collapse;
  Representative representative = Representative::quadric;  ///< of `cluster`
  HalfEdgeCost cost = HalfEdgeCost::quadric;                ///< of `half_edge`
  WedgeOptions wedges = {};                                 ///< which seams to hold
};

/// Contracts the own vertices of `joined` to `target` representatives, 1 <= target <= own_count <=
/// 65536; never more or fewer. Attributes: `cluster` takes means over the original vertices a
/// representative stands for, `edge_collapse` interpolates along the edges (normals made unit
/// length by both; labels by the surface they cover), `half_edge` keeps them; of places with
/// copies those of the first wedge, see contract_wedges() for all. Pure, deterministic; O(n log n).
Contraction contract(const BuildTile& joined, std::uint32_t target, const AttributeRules& rules,
                     const ContractionOptions& options);

}  // namespace meshhier::cluster_simplify
