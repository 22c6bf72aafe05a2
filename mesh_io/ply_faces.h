// Faces of a PLY file with what they show of the pictures that it names.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace meshhier::mesh_io {

struct PlyFace {
  /// A face is held in memory, so it may not be of any size.
  static constexpr std::size_t kMostCorners = std::size_t{1} << 16;

  std::vector<std::uint32_t> corners;  ///< as the file has them
  std::vector<float> texcoords;        ///< u v of each corner, v from the bottom row; or empty
  std::int32_t texture = 0;            ///< number of its picture; -1: none

  void clear() {
    corners.clear();
    texcoords.clear();
    texture = 0;
  }
};

/// Valid during the visit only.
using PlyFaceVisitor = std::function<void(const PlyFace&)>;

}  // namespace meshhier::mesh_io
