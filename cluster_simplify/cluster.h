// The method `cluster`: kd cells of equal vertex count, one representative each.
//
// Kim & Lee, Interactive Rendering of Huge 3D Meshes in Cloud Computing; representative points
// after Lindstrom, Out-of-Core Simplification of Large Polygonal Models, 2000.
#pragma once

#include "cluster_simplify/contraction.h"

#include <cstdint>

namespace meshhier::cluster_simplify {

/// See contract(). A `quadric` representative never leaves the sphere around the cell's mean that
/// holds its vertices.
Contraction cluster(const BuildTile& joined, std::uint32_t target, const AttributeRules& rules,
                    Representative representative);

}  // namespace meshhier::cluster_simplify
