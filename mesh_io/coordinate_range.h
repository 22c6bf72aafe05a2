// The range of coordinates that are read.
#pragma once

#include <cmath>

namespace meshhier::mesh_io {

/// 2^126, about 8.5e37: a box between such coordinates has a diagonal that is a float, so distances
/// on the mesh are floats, too.
inline constexpr double kMostCoordinate = 0x1p126;

/// The words for an expected coordinate in messages.
inline constexpr const char* kCoordinateRange = "a coordinate from -8.5e37 to 8.5e37 (2^126)";

/// Returns whether a value is a number, finite and within the range.
inline bool is_coordinate(double value) {
  return std::abs(value) <= kMostCoordinate;
}

}  // namespace meshhier::mesh_io
