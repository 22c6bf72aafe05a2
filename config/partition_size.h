// The most vertices of a partition.
#pragma once

#include "config/config.h"

#include <cstdint>

namespace meshhier::config {

/// Returns partition.vertices, or fewer if the input has many texels for each vertex: the picture
/// of a partition then has up to four times the texels of a simplified tile's, as much of the
/// input's pictures is not used. `source_texels`: those of all pictures of the input, 0 if it has
/// no textures. Requires places > 0.
std::uint32_t partition_vertices(const Config& config, std::uint64_t places,
                                 std::uint64_t source_texels);

}  // namespace meshhier::config
