// Which coordinates are read.
#pragma once

#include <cmath>

namespace meshhier::mesh_io {

/// 2^126, about 8.5e37: a box between such coordinates has a diagonal that is a float, so distances
/// on the mesh are floats, too.
inline constexpr double kMostCoordinate = 0x1p126;

/// What a message says was expected.
inline constexpr const char* kCoordinateRange = "a coordinate from -8.5e37 to 8.5e37 (2^126)";

/// Neither too far away, nor infinite, nor no number.
inline bool is_coordinate(double value) {
  return std::abs(value) <= kMostCoordinate;
}

}  // namespace meshhier::mesh_io
