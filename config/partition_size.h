// How many vertices a partition has at most.
#pragma once

#include "config/config.h"

#include <cstdint>

namespace meshhier::config {

/// partition.vertices, or fewer where the input has many texels for each vertex: the picture of a
/// partition then has up to four times the texels of a simplified tile's, as much of the input's
/// pictures is not used. `source_texels`: of all pictures of the input, 0 if it has no textures.
/// Requires places > 0.
std::uint32_t partition_vertices(const Config& config, std::uint64_t places,
                                 std::uint64_t source_texels);

}  // namespace meshhier::config
