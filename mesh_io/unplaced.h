// Vertices with coordinates that are not finite numbers, as programs write them for points of a
// grid that a scanner did not see. A mesh is whole without them, if no face uses one.
#pragma once

#include <cstdint>
#include <string>

namespace meshhier::mesh_io {

/// The unplaced vertices of a file.
struct UnplacedVertices {
  std::uint64_t count = 0;
  std::string first;  ///< for messages: file, place and what was found
};

}  // namespace meshhier::mesh_io
